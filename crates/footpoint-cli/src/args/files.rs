//! Which files a verb reads and writes, for dry runs.

use super::Verb;
use footpoint_jobs::Files;
use std::path::PathBuf;

impl Verb {
    /// The job's name, and the files of it: the one that defines the surface first.
    pub(crate) fn files(&self) -> Result<(&'static str, Files), String> {
        let point_file = |reads: Vec<&PathBuf>, cloud: &PathBuf| Files {
            reads: reads.into_iter().cloned().collect(),
            clouds: vec![cloud.clone()],
            ..Files::default()
        };
        Ok(match self {
            Self::Demo(a) => {
                let is_picture =
                    |file: &PathBuf| file.extension().is_some_and(|extension| extension == "png");
                let (pictures, clouds) = a.plan().files().into_iter().partition(is_picture);
                ("demo", Files { reads: Vec::new(), clouds, pictures, makes_folder: true })
            }
            Self::Info(a) => ("info", Files { reads: vec![a.input.clone()], ..Files::default() }),
            Self::Evaluate(a) => ("evaluate", point_file(vec![&a.cloud, &a.at], &a.output)),
            Self::Normals(a) => ("normals", point_file(vec![&a.input], &a.output)),
            Self::Orient(a) => {
                ("orient", point_file([&a.input].into_iter().chain(&a.trajectory).collect(), &a.output))
            }
            Self::Project(a) => ("project", point_file(a.onto.iter().chain([&a.input]).collect(), &a.output)),
            Self::Distance(a) => ("distance", point_file(vec![&a.to, &a.input], &a.output)),
            Self::Figure(a) => {
                let plan = a.plan();
                let reads = plan.input.iter().cloned().collect();
                ("figure", Files { reads, clouds: Vec::new(), pictures: plan.files(), makes_folder: true })
            }
            Self::Render(a) => {
                let pictures = a.plan()?.files(&a.input, a.output.as_deref());
                ("render", Files { reads: a.files_read(), pictures, ..Files::default() })
            }
        })
    }
}
