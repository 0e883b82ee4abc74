//! From a file to a cloud: which columns hold what.

use crate::clock::timed;
use crate::describe::{format_name, missing_points, notes, origin_of, unit_name};
use crate::output::drop_own_status;
use crate::report::{InputReport, NoiseSource, Recipe, Report, SurfaceReport};
use crate::{Context, JobError, Stage};
use footpoint::{
    Cloud, Definition, Error, Noise, NoiseError, OrientError, Support, Surface, UncertaintyError,
};
use footpoint_io::roles::Roles;
use footpoint_io::{Input, Unit, check_table};
use footpoint_render::Origin;
use std::path::Path;

const AXES: [&str; 3] = ["x", "y", "z"];

/// A file with the meaning of its columns.
pub(crate) struct Loaded {
    pub(crate) input: Input,
    pub(crate) roles: Roles,
    path: String,
}

impl Loaded {
    /// Reads a file, leaves out what the recipe drops, and finds coordinates and normals.
    pub(crate) fn read(path: &Path, context: &Context<'_>, report: &mut Report) -> Result<Self, JobError> {
        let mut input = timed(&mut report.times.read, || context.read(path))?;
        check_unit(&input, path)?;
        let find = |input: &Input| {
            Roles::find(&input.table).map_err(|problem| JobError::Roles { path: path.to_owned(), problem })
        };
        let mut roles = find(&input)?;
        if !report.recipe.drop.is_empty() {
            drop_columns(&mut input, &roles, &report.recipe.drop);
            roles = find(&input)?;
        }
        Ok(Self { input, roles, path: path.display().to_string() })
    }

    /// Reads a file whose rows, with what the job adds, become `output`; fails where that format cannot hold them.
    pub(crate) fn read_for(
        output: &Path,
        path: &Path,
        context: &Context<'_>,
        report: &mut Report,
    ) -> Result<Self, JobError> {
        let mut loaded = Self::read(path, context, report)?;
        report.inputs.push(loaded.report());
        loaded.drop_own_status();
        check_table(output, &loaded.input.table)?;
        Ok(loaded)
    }

    pub(crate) fn points<const D: usize>(&self) -> Vec<[f64; D]> {
        self.roles.points(&self.input.table).unwrap_or_default()
    }

    /// Fails if the points of both files do not have the same dimension.
    pub(crate) fn check_dimension(&self, other: &Self) -> Result<(), JobError> {
        if self.roles.dimension() == other.roles.dimension() {
            return Ok(());
        }
        Err(JobError::Dimensions {
            first: self.path.clone(),
            first_dimension: self.roles.dimension(),
            second: other.path.clone(),
            second_dimension: other.roles.dimension(),
        })
    }

    /// Drops the statuses that an earlier job wrote as words.
    fn drop_own_status(&mut self) {
        drop_own_status(&mut self.input.table);
        // Columns may have moved up. A table that had coordinates has them still.
        if let Ok(roles) = Roles::find(&self.input.table) {
            self.roles = roles;
        }
    }

    /// What the report says of the file.
    pub(crate) fn report(&self) -> InputReport {
        let table = &self.input.table;
        let numbers = |indices: &[usize]| -> Vec<Vec<f64>> {
            indices.iter().filter_map(|&i| table.columns[i].data.to_f64()).collect()
        };
        let coordinates = numbers(&self.roles.coordinates);
        let normals = self.roles.normals.as_deref().map(numbers).unwrap_or_default();
        let rows = |columns: &[Vec<f64>], bad: &dyn Fn(&[f64]) -> bool| {
            let row = |i: usize| columns.iter().map(|c| c[i]).collect::<Vec<_>>();
            if columns.is_empty() { 0 } else { (0..table.rows()).filter(|&i| bad(&row(i))).count() }
        };
        let not_finite = |row: &[f64]| row.iter().any(|c| !c.is_finite());
        InputReport {
            path: self.path.clone(),
            format: format_name(self.input.format),
            points: table.rows(),
            missing_points: missing_points(&self.input),
            crs: table.frame.crs.clone(),
            unit: table.frame.unit.map(unit_name),
            dimension: self.roles.dimension(),
            not_finite: rows(&coordinates, &not_finite),
            normals: !normals.is_empty(),
            unusable_normals: rows(&normals, &|row| not_finite(row) || row.iter().all(|&c| c == 0.0)),
            notes: notes(&self.input.report),
        }
    }

    /// Fails if a column that the recipe asks for is not there.
    pub(crate) fn check_columns(&self, recipe: &Recipe) -> Result<(), JobError> {
        match self.roles.dimension() {
            2 => self.cloud::<2>(recipe).map(drop),
            _ => self.cloud::<3>(recipe).map(drop),
        }
    }

    /// The cloud with the columns that the recipe asks for.
    pub(crate) fn cloud<const D: usize>(&self, recipe: &Recipe) -> Result<Cloud<D>, JobError> {
        let table = &self.input.table;
        let misfit = |problem| JobError::Cloud { path: self.path.clone(), problem };
        let mut cloud = Cloud::new(self.points::<D>());
        if let Some(normals) = self.roles.normals(table) {
            cloud = cloud.with_normals(normals).map_err(misfit)?;
        }
        if let Some(name) = &recipe.support_column {
            cloud = cloud.with_supports(self.column(name)?).map_err(misfit)?;
        }
        if let Some(name) = &recipe.factor_column {
            cloud = cloud.with_factors(self.column(name)?).map_err(misfit)?;
        }
        let wrong = |problem| self.noise_error(problem);
        match &recipe.noise {
            Some(NoiseSource::Uniform(sigma)) => cloud.with_noise(Noise::Uniform(*sigma)).map_err(wrong),
            Some(NoiseSource::Column(name)) => cloud.with_noise(self.noise(name)?).map_err(wrong),
            Some(NoiseSource::Estimated) | None => Ok(cloud),
        }
    }

    /// The cloud as the later of two, with those of the recipe's columns that it has: no noise, no normals.
    pub(crate) fn later_cloud<const D: usize>(&self, recipe: &Recipe) -> Result<Cloud<D>, JobError> {
        let has = |name: &String| self.input.table.column(name).is_some();
        let cloud = Recipe {
            support_column: recipe.support_column.clone().filter(has),
            factor_column: recipe.factor_column.clone().filter(has),
            ..Recipe::default()
        };
        self.cloud(&cloud)
    }

    /// Why these points, as the cloud, have no surface.
    pub(crate) fn surface_error(&self, problem: Error) -> JobError {
        match problem {
            Error::Cancelled(_) => JobError::Cancelled,
            _ if self.input.table.rows() == 0 => JobError::NoPoints(self.path.clone()),
            problem => JobError::Surface { path: self.path.clone(), problem },
        }
    }

    /// The noise of these points as foreign queries, where the recipe gives them some.
    pub(crate) fn query_noise<const D: usize>(&self, recipe: &Recipe) -> Result<Option<Noise<D>>, JobError> {
        match (&recipe.query_noise_column, recipe.query_noise) {
            (Some(name), _) => self.noise(name).map(Some),
            (None, sigma) => Ok(sigma.map(Noise::Uniform)),
        }
    }

    /// The same where it is to be estimated, from the residuals of the points about their own surface.
    pub(crate) fn estimated_query_noise<const D: usize>(
        &self,
        context: &Context<'_>,
    ) -> Result<Option<f64>, JobError> {
        if !context.recipe.query_noise_estimated {
            return Ok(None);
        }
        let cloud = self.later_cloud::<D>(&context.recipe)?;
        estimated_noise(cloud, &self.path, context).map(Some)
    }

    /// What is wrong with noise that belongs to this file.
    pub(crate) fn noise_error(&self, problem: NoiseError) -> JobError {
        JobError::Noise { path: self.path.clone(), problem }
    }

    /// Why there are no uncertainties of distances from these points.
    pub(crate) fn uncertainty_error(&self, problem: UncertaintyError) -> JobError {
        match problem {
            UncertaintyError::QueryNoise(problem) => self.noise_error(problem),
            other => other.into(),
        }
    }

    /// A column of standard deviations or, where there is none of this name, columns of covariances that begin with it.
    fn noise<const D: usize>(&self, name: &str) -> Result<Noise<D>, JobError> {
        let entry = |i: usize, k: usize| format!("{name}_{}{}", AXES[i], AXES[k]);
        let has = |name: &str| self.input.table.column(name).is_some();
        if has(name) || !has(&entry(0, 0)) {
            return Ok(Noise::Each(self.column(name)?));
        }
        let mut covariances = vec![[[0.0; D]; D]; self.input.table.rows()];
        for i in 0..D {
            for k in i..D {
                for (matrix, value) in covariances.iter_mut().zip(self.column(&entry(i, k))?) {
                    (matrix[i][k], matrix[k][i]) = (value, value);
                }
            }
        }
        Ok(Noise::Covariances(covariances))
    }

    /// The numbers of a column.
    pub(crate) fn column(&self, name: &str) -> Result<Vec<f64>, JobError> {
        let table = &self.input.table;
        table.column(name).and_then(|c| c.data.to_f64()).ok_or_else(|| JobError::Column {
            path: self.path.clone(),
            name: name.to_owned(),
            found: table.columns.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(" "),
        })
    }

    /// Fails if the points make a curve in the plane.
    pub(crate) fn check_space(&self) -> Result<(), JobError> {
        if self.roles.dimension() == 3 { Ok(()) } else { Err(JobError::OnlyPlane(self.path.clone())) }
    }

    /// Where the points come from, as far as that says what is up.
    pub(crate) fn origin(&self) -> Origin {
        origin_of(Some(format_name(self.input.format)), self.input.table.frame.crs.is_some())
    }

    /// Why there is no picture of this file.
    pub(crate) fn render_error(&self, problem: footpoint_render::RenderError) -> JobError {
        JobError::of_render(&self.path, problem)
    }

    /// Why this file cannot be oriented.
    pub(crate) fn orient_error(&self, problem: OrientError) -> JobError {
        JobError::Orient { path: self.path.clone(), problem }
    }

    /// The surface that the file's points define.
    pub(crate) fn surface<const D: usize>(
        &self,
        context: &Context<'_>,
        report: &mut Report,
    ) -> Result<Surface<D>, JobError> {
        let cloud = self.cloud::<D>(&context.recipe)?;
        surface_of_cloud(cloud, &self.path, context, report).map_err(|error| match error {
            JobError::Surface { .. } if self.input.table.rows() == 0 => JobError::NoPoints(self.path.clone()),
            other => other,
        })
    }
}

/// Indexes a cloud by the context's definition, and finds what the recipe leaves to be found: degree and noise. Errors name the
/// cloud as `path`; the recipe's columns are not looked at, the cloud has them.
pub fn surface_of_cloud<const D: usize>(
    cloud: Cloud<D>,
    path: &str,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<Surface<D>, JobError> {
    context.begin(Stage::Index);
    let run = context.run.silent();
    let wrong = |problem: Error| match problem {
        Error::Cancelled(_) => JobError::Cancelled,
        problem => JobError::Surface { path: path.to_owned(), problem },
    };
    let built = timed(&mut report.times.index, || Surface::build(cloud, context.definition(), &run));
    let mut surface = built.map_err(wrong)?;
    let mut degree_choice = None;
    if let Some(aim) = context.recipe.choose_degree {
        let choice = timed(&mut report.times.compute, || surface.with(&run).choose_degree(aim))?;
        surface = surface.with_degree(choice.degree).map_err(|problem| wrong(problem.into()))?;
        report.recipe.definition = report.recipe.definition.with_degree(choice.degree);
        degree_choice = Some(choice);
    }
    if context.recipe.noise == Some(NoiseSource::Estimated) {
        let estimate = timed(&mut report.times.compute, || surface.with(&run).estimate_noise())?;
        surface = surface
            .with_uniform_noise(estimate.sigma)
            .map_err(|problem| JobError::Noise { path: path.to_owned(), problem })?;
    }
    report.surface = Some(SurfaceReport { degree_choice, ..SurfaceReport::of(&surface) });
    context.begin(Stage::Compute);
    Ok(surface)
}

/// The noise of a cloud along the normals of its own surface, by the context's definition.
pub fn estimated_noise<const D: usize>(
    cloud: Cloud<D>,
    path: &str,
    context: &Context<'_>,
) -> Result<f64, JobError> {
    let run = context.run.silent();
    let built = Surface::build(cloud, context.definition(), &run);
    let surface = built.map_err(|problem| match problem {
        Error::Cancelled(_) => JobError::Cancelled,
        problem => JobError::Surface { path: path.to_owned(), problem },
    })?;
    Ok(surface.with(&run).estimate_noise()?.sigma)
}

/// Fails where coordinates are angles: distances, supports and normals would mean nothing.
fn check_unit(input: &Input, path: &Path) -> Result<(), JobError> {
    match input.table.frame.unit {
        Some(Unit::Degree) => Err(JobError::Degrees(path.display().to_string())),
        _ => Ok(()),
    }
}

/// Leaves out columns by name, and the normals, whatever they are called, by `normals`.
fn drop_columns(input: &mut Input, roles: &Roles, names: &[String]) {
    let table = &mut input.table;
    let mut dropped: Vec<usize> = Vec::new();
    for name in names {
        let before = dropped.len();
        dropped.extend((0..table.columns.len()).filter(|&i| table.columns[i].name == *name));
        if name == NORMALS {
            dropped.extend(roles.normals.iter().flatten());
        }
        if dropped.len() == before {
            input.report.notes.push(format!("nothing named `{name}` to drop"));
        }
    }
    let mut place = 0;
    table.columns.retain(|_| {
        place += 1;
        !dropped.contains(&(place - 1))
    });
}

/// The name of a sample's normal, whatever its columns are called.
const NORMALS: &str = "normals";

impl Context<'_> {
    /// The definition; a column of supports, where one is named, overrides its rule.
    pub(crate) fn definition(&self) -> Definition {
        let definition = self.recipe.definition;
        match self.recipe.support_column {
            Some(_) => definition.with_support(Support::FromSamples),
            None => definition,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use footpoint_io::{Column, Data, Encoding, Format, Frame, ReadReport, Table};

    #[test]
    fn degrees_are_no_lengths() {
        let with = |unit| Input {
            table: Table {
                columns: vec![Column::new("x", Data::F64(vec![8.5]))],
                frame: Frame { unit, ..Frame::default() },
                ..Table::default()
            },
            format: Format::Ply(Encoding::Ascii),
            report: ReadReport::default(),
        };
        for unit in [None, Some(Unit::Metre), Some(Unit::Foot), Some(Unit::UsSurveyFoot)] {
            assert!(check_unit(&with(unit), Path::new("a.las")).is_ok(), "{unit:?}");
        }
        let error = check_unit(&with(Some(Unit::Degree)), Path::new("a.las")).unwrap_err().to_string();
        assert!(error.starts_with("a.las: ") && error.contains("reproject"), "{error}");
    }
}
