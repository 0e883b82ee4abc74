//! The contestants: the stages of a case, timed, and the answers they leave behind.

use crate::baseline::{Answers, Baseline};
use crate::case::{Case, Engine, Stage};
use crate::clock::{Seconds, timed};
use crate::cloud::{Sampled, Supports, mean_count};
use footpoint::{Cloud, Definition, Evaluations, Project, Projections, Queries, Run, Surface, Want};
use nalgebra::Vector3;

/// f, n and ∇f at one sample.
pub(crate) struct Row {
    pub(crate) value: f64,
    pub(crate) normal: Vector3<f64>,
    pub(crate) gradient: Vector3<f64>,
}

/// Who takes part: it does a stage and keeps the answers of the last time.
pub(crate) trait Contestant {
    fn time(&mut self, stage: Stage) -> Result<Seconds, String>;
    fn mean_neighbours(&self) -> f64;
    fn row(&self, sample: usize) -> Row;
    /// Surface normals of the stage of that name.
    fn normals(&self) -> &[[f64; 3]];
    /// Where samples were projected.
    fn projections(&self) -> Option<&Projections<3>>;
    /// The gap of the frame at every sample, where the contestant reports it.
    fn gaps(&self) -> Option<Vec<f64>>;
}

/// The contestant of a case, with its index built and one evaluation done.
pub(crate) fn contestant(
    case: &Case,
    sampled: &Sampled,
    supports: &Supports,
) -> Result<Box<dyn Contestant>, String> {
    let mut contestant: Box<dyn Contestant> = match case.engine {
        Engine::Footpoint => Box::new(Footpoint::new(case, sampled, supports)?),
        Engine::Baseline => Box::new(Rival::new(sampled, supports)?),
    };
    contestant.time(Stage::Evaluate)?;
    Ok(contestant)
}

/// This library.
pub(crate) struct Footpoint {
    cloud: Cloud<3>,
    definition: Definition,
    run: Run<'static>,
    surface: Surface<3>,
    columns: Evaluations<3>,
    normals: Vec<[f64; 3]>,
    projections: Option<Projections<3>>,
}

impl Footpoint {
    pub(crate) fn new(case: &Case, sampled: &Sampled, supports: &Supports) -> Result<Self, String> {
        let mut cloud = sampled.cloud(supports)?;
        if case.field.needs_normals() {
            cloud = cloud.with_normals(sampled.normals.clone()).map_err(|e| e.to_string())?;
        }
        let definition = Definition::new()
            .with_field(case.field)
            .with_degree(case.degree)
            .with_weight(case.weight)
            .with_precision(case.precision)
            .with_support(supports.rule());
        let run = Run::new().threads(case.threads).instructions(case.instructions.into());
        let surface = Surface::build(cloud.clone(), definition, &run).map_err(|e| e.to_string())?;
        let (columns, normals, projections) = (Evaluations::default(), Vec::new(), None);
        Ok(Self { cloud, definition, run, surface, columns, normals, projections })
    }
}

impl Contestant for Footpoint {
    fn time(&mut self, stage: Stage) -> Result<Seconds, String> {
        let cloud = || self.cloud.clone();
        let build = |cloud| Surface::build(cloud, self.definition, &self.run);
        match stage {
            Stage::Index => {
                let cloud = cloud();
                let (surface, seconds) = timed(|| build(cloud));
                self.surface = surface.map_err(|e| e.to_string())?;
                Ok(seconds)
            }
            Stage::Evaluate => {
                let want = Want::VALUE | Want::FRAME_NORMAL | Want::GRADIENT;
                let running = self.surface.with(&self.run);
                let work = || running.evaluate_into(Queries::Samples, want, &mut self.columns);
                let (done, seconds) = timed(work);
                done.map_err(|e| e.to_string())?;
                Ok(seconds)
            }
            Stage::Normals => {
                let cloud = cloud();
                let (evaluations, seconds) = timed(|| {
                    build(cloud).map(|surface| {
                        surface.with(&self.run).evaluate(Queries::Samples, Want::SURFACE_NORMAL)
                    })
                });
                let evaluations = evaluations.map_err(|e| e.to_string())?.map_err(|e| e.to_string())?;
                self.normals = evaluations.surface_normal;
                Ok(seconds)
            }
            Stage::Project => {
                let cloud = cloud();
                let how = Project::new();
                let (projections, seconds) = timed(|| {
                    build(cloud).map(|surface| surface.with(&self.run).project(Queries::Samples, &how))
                });
                let projections = projections.map_err(|e| e.to_string())?.map_err(|e| e.to_string())?;
                self.projections = Some(projections);
                Ok(seconds)
            }
        }
    }

    fn mean_neighbours(&self) -> f64 {
        mean_count(&self.surface)
    }

    fn row(&self, sample: usize) -> Row {
        Row {
            value: self.columns.value[sample],
            normal: self.columns.frame_normal[sample].into(),
            gradient: self.columns.gradient[sample].into(),
        }
    }

    fn normals(&self) -> &[[f64; 3]] {
        &self.normals
    }

    fn projections(&self) -> Option<&Projections<3>> {
        self.projections.as_ref()
    }

    fn gaps(&self) -> Option<Vec<f64>> {
        self.surface.with(&self.run).evaluate(Queries::Samples, Want::GAP).ok().map(|all| all.gap)
    }
}

/// The scalar rival.
struct Rival {
    points: Vec<[f64; 3]>,
    radius: f64,
    index: Baseline,
    answers: Answers,
    normals: Vec<[f64; 3]>,
}

const NO_INDEX: &str = "the rival cannot index these points";

impl Rival {
    fn new(sampled: &Sampled, supports: &Supports) -> Result<Self, String> {
        if supports.each.is_some() {
            return Err("the rival has one radius for all".to_owned());
        }
        let points = sampled.points.clone();
        let index = Baseline::build(&points).ok_or(NO_INDEX)?;
        let (answers, normals) = (Answers::default(), Vec::new());
        Ok(Self { points, radius: supports.radius, index, answers, normals })
    }
}

impl Contestant for Rival {
    fn time(&mut self, stage: Stage) -> Result<Seconds, String> {
        match stage {
            Stage::Index => {
                let (index, seconds) = timed(|| Baseline::build(&self.points));
                self.index = index.ok_or(NO_INDEX)?;
                Ok(seconds)
            }
            Stage::Evaluate => Ok(timed(|| self.index.evaluate(self.radius, &mut self.answers)).1),
            Stage::Normals => {
                let (normals, seconds) = timed(|| {
                    let index = Baseline::build(&self.points)?;
                    index.evaluate(self.radius, &mut self.answers);
                    let unit = |g: [f64; 3]| Vector3::from(g).normalize().into();
                    Some(self.answers.rows.iter().map(|row| unit(row.gradient)).collect())
                });
                self.normals = normals.ok_or(NO_INDEX)?;
                Ok(seconds)
            }
            Stage::Project => Err("the rival does not project".to_owned()),
        }
    }

    fn mean_neighbours(&self) -> f64 {
        self.answers.pairs as f64 / self.points.len() as f64
    }

    fn row(&self, sample: usize) -> Row {
        let local = self.answers.rows[sample];
        Row { value: local.value, normal: local.normal.into(), gradient: local.gradient.into() }
    }

    fn normals(&self) -> &[[f64; 3]] {
        &self.normals
    }

    fn projections(&self) -> Option<&Projections<3>> {
        None
    }

    fn gaps(&self) -> Option<Vec<f64>> {
        None
    }
}
