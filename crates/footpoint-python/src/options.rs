//! Keyword arguments as what the library takes; a wrong one is named.

use crate::errors::wrong;
use footpoint::{
    Cast, Contour, Definition, Kind, NonOrientable, NormalField, NormalSource, Operator, Precision, Project,
    Sought, Support, Want, Weight,
};
use footpoint_jobs::{DegreeAim, NoiseSource, Recipe};
use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyString};

/// Keyword arguments by name; those that are `None` count as absent.
pub(crate) struct Options<'a, 'py>(pub(crate) &'a Bound<'py, PyDict>);

impl<'py> Options<'_, 'py> {
    /// The argument, where it is given.
    pub(crate) fn get<T: FromPyObjectOwned<'py>>(&self, name: &str, wanted: &str) -> PyResult<Option<T>> {
        let Some(value) = self.0.get_item(name)?.filter(|value| !value.is_none()) else { return Ok(None) };
        let problem = || -> PyErr {
            let shown = value.repr().map_or_else(|_| "it".to_owned(), |text| text.to_string());
            PyTypeError::new_err(format!("{name}: {shown} is not {wanted}"))
        };
        value.extract().map(Some).map_err(|_| problem())
    }

    pub(crate) fn number(&self, name: &str) -> PyResult<Option<f64>> {
        self.float(name, "a number")
    }

    /// A whole number; True and False are none.
    pub(crate) fn whole(&self, name: &str, wanted: &str) -> PyResult<Option<usize>> {
        self.no_truth(name, wanted)?;
        self.get(name, wanted)
    }

    /// A number; True and False are none.
    fn float(&self, name: &str, wanted: &str) -> PyResult<Option<f64>> {
        self.no_truth(name, wanted)?;
        self.get(name, wanted)
    }

    fn no_truth(&self, name: &str, wanted: &str) -> PyResult<()> {
        match self.0.get_item(name)? {
            Some(value) if value.is_instance_of::<PyBool>() => {
                Err(PyTypeError::new_err(format!("{name}: {value} is not {wanted}")))
            }
            _ => Ok(()),
        }
    }

    pub(crate) fn vector(&self, name: &str) -> PyResult<Option<[f64; 3]>> {
        self.get(name, "three numbers")
    }

    pub(crate) fn is_set(&self, name: &str) -> PyResult<bool> {
        Ok(self.get(name, "True or False")?.unwrap_or(false))
    }

    fn is_given(&self, name: &str) -> PyResult<bool> {
        Ok(self.0.get_item(name)?.is_some_and(|value| !value.is_none()))
    }

    /// One of these words.
    pub(crate) fn choice<T: Copy>(&self, name: &str, words: &[(&str, T)]) -> PyResult<Option<T>> {
        let Some(word) = self.get::<String>(name, "a word")? else { return Ok(None) };
        one_of(name, &word, words).map(Some)
    }

    /// A number of effective neighbours, or `best`.
    fn aim(&self, name: &str) -> PyResult<Option<Aim>> {
        match self.0.get_item(name)? {
            Some(word) if word.is_instance_of::<PyString>() => {
                self.choice(name, &[("best", Aim::LeastError)])
            }
            _ => Ok(self.float(name, "a number or \"best\"")?.map(Aim::EffectiveNeighbours)),
        }
    }
}

#[derive(Clone, Copy)]
enum Aim {
    EffectiveNeighbours(f64),
    LeastError,
}

fn one_of<T: Copy>(name: &str, word: &str, words: &[(&str, T)]) -> PyResult<T> {
    let found = words.iter().find(|(known, _)| *known == word).map(|(_, meaning)| *meaning);
    found.ok_or_else(|| {
        let known: Vec<&str> = words.iter().map(|(known, _)| *known).collect();
        wrong(name, format!("\"{word}\" is none of {}", known.join(", ")))
    })
}

/// What the surface is: the options of the command of the same names.
pub(crate) fn recipe(options: &Options<'_, '_>) -> PyResult<Recipe> {
    let mut recipe = Recipe::default();
    let mut definition = Definition::new().with_support(support(options)?);
    if let Some(weight) = weight(options)? {
        definition = definition.with_weight(weight);
    }
    let levin = options.choice("surface", &[("pss", false), ("levin", true)])? == Some(true);
    if levin {
        definition = definition.with_kind(Kind::Levin);
    }
    let fields = [
        ("centred", NormalField::CentredCovariance),
        ("covariance", NormalField::Covariance),
        ("averaged", NormalField::AveragedNormals),
        ("axes", NormalField::AveragedAxes),
    ];
    match options.choice("field", &fields)? {
        Some(_) if levin => return Err(wrong("field", "it belongs to surface=\"pss\"")),
        Some(field) => definition = definition.with_field(field),
        None => {}
    }
    match degree(options)? {
        Some(_) if levin => return Err(wrong("degree", "it belongs to surface=\"pss\"")),
        Some(Degree::Fixed(degree)) => definition = definition.with_degree(degree),
        Some(Degree::Auto) => recipe.choose_degree = Some(degree_aim(options)?),
        None => {}
    }
    definition = definition.with_degree_fallback(options.is_set("degree_fallback")?);
    let precisions = [("double", Precision::Double), ("single", Precision::Single)];
    if let Some(precision) = options.choice("precision", &precisions)? {
        definition = definition.with_precision(precision);
    }
    if let Some(ratio) = options.number("domain_ratio")? {
        definition = definition.with_domain_ratio(ratio);
    }
    let mut acceptance = definition.acceptance();
    acceptance.alignment = options.number("accept_alignment")?.unwrap_or(acceptance.alignment);
    acceptance.gap = options.number("accept_gap")?.unwrap_or(acceptance.gap);
    acceptance.boundary = options.number("accept_boundary")?.or(acceptance.boundary);
    recipe.definition = definition.with_acceptance(acceptance);
    if options.is_set("estimate_noise")? {
        recipe.noise = Some(NoiseSource::Estimated);
    }
    Ok(recipe)
}

fn support(options: &Options<'_, '_>) -> PyResult<Support> {
    let mut given = Vec::new();
    for name in ["radius", "auto", "per_sample", "supports"] {
        if options.is_given(name)? {
            given.push(name);
        }
    }
    if let [_, _, ..] = given[..] {
        let problem = format!("{}: give one of these", given.join(", "));
        return Err(PyValueError::new_err(problem));
    }
    Ok(match (options.number("radius")?, options.aim("auto")?, options.aim("per_sample")?) {
        (Some(radius), ..) => Support::Uniform(radius),
        (_, Some(Aim::EffectiveNeighbours(effective_neighbours)), _) => {
            Support::Auto { effective_neighbours }
        }
        (_, Some(Aim::LeastError), _) => Support::LeastError,
        (.., Some(Aim::EffectiveNeighbours(effective_neighbours))) => {
            Support::AutoPerSample { effective_neighbours }
        }
        (.., Some(Aim::LeastError)) => Support::LeastErrorPerSample,
        _ if given == ["supports"] => Support::FromSamples,
        _ => Support::default(),
    })
}

fn weight(options: &Options<'_, '_>) -> PyResult<Option<Weight>> {
    let weights = [
        ("poly2", Weight::Poly2),
        ("poly3", Weight::Poly3),
        ("poly4", Weight::Poly4),
        ("wendland", Weight::Wendland),
        ("gaussian", Weight::GAUSSIAN),
    ];
    match (options.choice("weight", &weights)?, options.number("cut")?) {
        (Some(Weight::Gaussian { .. }), Some(cut)) => Ok(Some(Weight::Gaussian { cut })),
        (_, Some(_)) => Err(wrong("cut", "it belongs to weight=\"gaussian\"")),
        (weight, None) => Ok(weight),
    }
}

#[derive(Clone, Copy)]
enum Degree {
    Fixed(u8),
    Auto,
}

fn degree(options: &Options<'_, '_>) -> PyResult<Option<Degree>> {
    match options.0.get_item("degree")? {
        Some(word) if word.is_instance_of::<PyString>() => {
            options.choice("degree", &[("auto", Degree::Auto)])
        }
        _ => {
            let wanted = "0, 1, 2, 3 or \"auto\"";
            options.no_truth("degree", wanted)?;
            Ok(options.get("degree", wanted)?.map(Degree::Fixed))
        }
    }
}

/// What an automatic degree is chosen for.
fn degree_aim(options: &Options<'_, '_>) -> PyResult<DegreeAim> {
    let aims = [("position", DegreeAim::Position), ("normal", DegreeAim::Normal)];
    Ok(options.choice("degree_aim", &aims)?.unwrap_or(DegreeAim::Position))
}

/// The columns that are computed, by the names of their fields.
pub(crate) const COLUMNS: [(&str, Want); 17] = [
    ("value", Want::VALUE),
    ("average", Want::AVERAGE),
    ("frame_normal", Want::FRAME_NORMAL),
    ("gradient", Want::GRADIENT),
    ("surface_normal", Want::SURFACE_NORMAL),
    ("gap", Want::GAP),
    ("neighbours", Want::NEIGHBOURS),
    ("effective_neighbours", Want::EFFECTIVE_NEIGHBOURS),
    ("weight_sum", Want::WEIGHT_SUM),
    ("eigenvalues", Want::EIGENVALUES),
    ("squared_sensitivity", Want::SQUARED_SENSITIVITY),
    ("support", Want::SUPPORT),
    ("eccentricity", Want::ECCENTRICITY),
    ("hessian", Want::HESSIAN),
    ("curvature", Want::CURVATURE),
    ("sigma", Want::SIGMA),
    ("degree", Want::DEGREE),
];

/// The set of these columns.
pub(crate) fn want(names: &[String]) -> PyResult<Want> {
    let mut wanted = None;
    for name in names {
        let column = one_of("want", name, &COLUMNS)?;
        wanted = Some(wanted.map_or(column, |before| before | column));
    }
    wanted.ok_or_else(|| wrong("want", "no column is named"))
}

/// How to project.
pub(crate) fn project(options: &Options<'_, '_>) -> PyResult<Project> {
    let operators = [
        ("basic", Operator::Basic),
        ("almost", Operator::AlmostOrthogonal),
        ("orthogonal", Operator::Orthogonal),
        ("levin", Operator::Levin { degree: None }),
    ];
    let mut how = Project::new();
    let operator = options.choice("operator", &operators)?.unwrap_or_default();
    how = match (options.get::<u8>("levin_degree", "a degree from 0 to 4")?, operator) {
        (None, operator) => how.with_operator(operator),
        (Some(5..), _) => return Err(wrong("levin_degree", "it must be 0, 1, 2, 3 or 4")),
        (degree, Operator::Levin { .. }) => how.with_operator(Operator::Levin { degree }),
        (Some(_), _) => return Err(wrong("levin_degree", "it belongs to operator=\"levin\"")),
    };
    match tolerance(options)? {
        Some(tolerance) => Ok(how.with_tolerance(tolerance)),
        None => Ok(how),
    }
}

fn tolerance(options: &Options<'_, '_>) -> PyResult<Option<f64>> {
    match options.number("tolerance")? {
        Some(tolerance) if tolerance.is_nan() || tolerance <= 0.0 => {
            Err(wrong("tolerance", format!("it is {tolerance}, but must be above 0")))
        }
        tolerance => Ok(tolerance),
    }
}

/// How to cast rays.
pub(crate) fn cast(options: &Options<'_, '_>) -> PyResult<Cast> {
    let mut how = Cast::new();
    if let Some(sought) = options.choice("sought", &[("first", Sought::First), ("any", Sought::Any)])? {
        how = how.with_sought(sought);
    }
    if let Some(tolerance) = tolerance(options)? {
        how = how.with_tolerance(tolerance);
    }
    match options.get::<[f64; 2]>("between", "two numbers")? {
        Some([from, to]) if from < to => Ok(how.with_range(from..to)),
        Some([from, to]) => Err(wrong("between", format!("{from} is not below {to}"))),
        None => Ok(how),
    }
}

/// How finely a curve is followed.
pub(crate) fn contour(options: &Options<'_, '_>) -> PyResult<Contour> {
    let mut how = Contour::new();
    match options.number("cell")? {
        Some(cell) if !(0.001..=0.5).contains(&cell) => {
            return Err(wrong("cell", format!("it is {cell}, but must be from 0.001 to 0.5 supports")));
        }
        Some(cell) => how = how.with_cell(cell),
        None => {}
    }
    match tolerance(options)? {
        Some(tolerance) => Ok(how.with_tolerance(tolerance)),
        None => Ok(how),
    }
}

/// Which normals are oriented.
pub(crate) fn normal_source(options: &Options<'_, '_>) -> PyResult<NormalSource> {
    let sources = [("surface", NormalSource::Surface), ("given", NormalSource::Given)];
    Ok(options.choice("normal", &sources)?.unwrap_or_default())
}

/// What becomes of a surface without sides.
pub(crate) fn non_orientable(options: &Options<'_, '_>) -> PyResult<NonOrientable> {
    Ok(if options.is_set("force_orientation")? { NonOrientable::Force } else { NonOrientable::Leave })
}
