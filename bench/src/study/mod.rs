//! The accuracy study: errors of position and normals against support, noise, field and operator, where the truth is known.

mod degrees;
mod page;
mod shapes;

use footpoint::{
    Cloud, Definition, Error, NormalField, Operator, Project, Projections, Queries, Support, Surface,
};
pub(crate) use page::{compact, written};
use serde::Serialize;
use serde_json::{Value, json};
use shapes::{CURVES, SURFACES, Shape};

/// How much to measure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    /// Samples of a surface; a curve has half as many.
    pub(crate) samples: usize,
    pub(crate) effective_neighbours: &'static [f64],
}

impl Plan {
    /// A few minutes.
    pub(crate) const FULL: Self =
        Self { samples: 10_000, effective_neighbours: &[8.0, 16.0, 32.0, 64.0, 128.0, 256.0] };
}

/// Standard deviations in spacings.
const NOISES: [f64; 3] = [0.0, 0.5, 1.0];

const FIELDS: [NormalField; 4] = [
    NormalField::CentredCovariance,
    NormalField::Covariance,
    NormalField::AveragedNormals,
    NormalField::AveragedAxes,
];

const OPERATORS: [(&str, Operator); 3] = [
    ("orthogonal", Operator::Orthogonal),
    ("almost orthogonal", Operator::AlmostOrthogonal),
    ("basic", Operator::Basic),
];

/// One measurement: the samples' own projections against the truth.
#[derive(Clone, Debug, Serialize)]
struct Row {
    shape: &'static str,
    noise_in_spacings: f64,
    /// What the support aimed at, or was chosen for.
    effective_neighbours: f64,
    automatic: bool,
    support_in_spacings: f64,
    field: String,
    operator: &'static str,
    ok_share: f64,
    /// Root mean square distance to the true surface.
    position_in_spacings: f64,
    /// κ_H h²/10 (curves κ h²/18), root mean square over the same points.
    bias_expected_in_spacings: f64,
    /// The rule's own estimate.
    #[serde(skip_serializing_if = "Option::is_none")]
    expected_in_spacings: Option<f64>,
    /// Mean angles to the true normal, and between the two.
    surface_normal_degrees: f64,
    frame_normal_degrees: f64,
    between_degrees: f64,
    mean_evaluations: f64,
}

/// Measures everything, and gives the record.
pub(crate) fn study(plan: Plan) -> Result<Value, Error> {
    let mut rows = Vec::new();
    for shape in &SURFACES {
        shape_rows(shape, plan.samples, plan, &mut rows)?;
    }
    for shape in &CURVES {
        shape_rows(shape, plan.samples / 2, plan, &mut rows)?;
    }
    let mut degrees = Vec::new();
    for shape in &SURFACES {
        degrees::rows(shape, plan.samples, plan, &mut degrees)?;
    }
    for shape in &CURVES {
        degrees::rows(shape, plan.samples / 2, plan, &mut degrees)?;
    }
    let unknown = rows.iter().filter(|row| !row.position_in_spacings.is_finite());
    let failures: Vec<String> =
        unknown.map(|row| format!("{}: no projection at {}", row.shape, row.effective_neighbours)).collect();
    Ok(json!({
        "study": "accuracy where the truth is known",
        "what": "orthogonal, almost orthogonal and basic projections of the samples, poly3, double, uniform support",
        "version": env!("CARGO_PKG_VERSION"),
        "samples": plan.samples,
        "failures": failures,
        "rows": rows,
        "degrees": degrees,
    }))
}

fn shape_rows<const D: usize>(
    shape: &Shape<D>,
    count: usize,
    plan: Plan,
    rows: &mut Vec<Row>,
) -> Result<(), Error> {
    for noise in NOISES {
        eprintln!("{}, noise {noise}", shape.name);
        let samples = shape.samples(count, noise);
        let cloud = Cloud::new(samples.points).with_normals(samples.normals)?;
        let spacing = shape.spacing(count);
        let auto = plan.effective_neighbours.iter().map(|&n| Support::Auto { effective_neighbours: n });
        for support in auto.chain([Support::LeastError]) {
            // The choice does not depend on the field.
            let fields = if support == Support::LeastError { &FIELDS[..1] } else { &FIELDS[..] };
            for &field in fields {
                let definition = Definition::new().with_field(field).with_support(support);
                let surface = Surface::new(cloud.clone(), definition)?;
                for (name, operator) in OPERATORS {
                    let p = surface.project(Queries::Samples, &Project::new().with_operator(operator));
                    let row =
                        Row { operator: name, noise_in_spacings: noise, ..row(shape, &surface, &p, spacing) };
                    rows.push(row);
                }
            }
        }
    }
    Ok(())
}

fn row<const D: usize>(shape: &Shape<D>, surface: &Surface<D>, p: &Projections<D>, spacing: f64) -> Row {
    let support = surface.support().median;
    let choice = surface.support_choice();
    let aim = match surface.definition().support() {
        Support::Auto { effective_neighbours } => effective_neighbours,
        _ => choice.map_or(f64::NAN, |choice| choice.effective_neighbours),
    };
    let ok: Vec<usize> = (0..p.status.len()).filter(|&i| p.status[i].is_ok()).collect();
    let mean = |of: &dyn Fn(usize) -> f64| ok.iter().map(|&i| of(i)).sum::<f64>() / ok.len() as f64;
    let truth = |i: usize| (shape.truth)(p.point[i]);
    let off = |i: usize| (0..D).map(|k| (p.point[i][k] - truth(i).foot[k]).powi(2)).sum::<f64>();
    let share = support * support / if D == 2 { 18.0 } else { 10.0 };
    Row {
        shape: shape.name,
        noise_in_spacings: f64::NAN,
        effective_neighbours: rounded(aim),
        automatic: choice.is_some(),
        support_in_spacings: rounded(support / spacing),
        field: surface.definition().field().to_string(),
        operator: "",
        ok_share: rounded(ok.len() as f64 / p.status.len() as f64),
        position_in_spacings: rounded(mean(&off).sqrt() / spacing),
        bias_expected_in_spacings: rounded(mean(&|i| (truth(i).curvature * share).powi(2)).sqrt() / spacing),
        expected_in_spacings: choice.map(|choice| rounded(choice.error() / spacing)),
        surface_normal_degrees: rounded(mean(&|i| degrees(p.surface_normal[i], truth(i).normal))),
        frame_normal_degrees: rounded(mean(&|i| degrees(p.frame_normal[i], truth(i).normal))),
        between_degrees: rounded(mean(&|i| degrees(p.surface_normal[i], p.frame_normal[i]))),
        mean_evaluations: rounded(
            p.evaluations.iter().map(|&e| f64::from(e)).sum::<f64>() / p.status.len() as f64,
        ),
    }
}

/// Angle between two axes, whatever their signs; exact for small ones.
fn degrees<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    let along: f64 = (0..D).map(|k| a[k] * b[k]).sum();
    let across = (0..D).map(|k| (a[k] - along * b[k]).powi(2)).sum::<f64>().sqrt();
    across.atan2(along.abs()).to_degrees()
}

/// Four significant digits: the record should not change with the last bits of another processor.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of the rows that agree with all of these.
    fn numbers(record: &Value, of: &str, wanted: &[(&str, Value)]) -> Vec<f64> {
        let rows = record["rows"].as_array().unwrap();
        let agrees = |row: &&Value| wanted.iter().all(|(key, value)| row[key] == *value);
        rows.iter().filter(agrees).map(|row| row[of].as_f64().unwrap()).collect()
    }

    #[test]
    fn a_tiny_study_moves_as_expected() {
        let plan = Plan { samples: 2000, effective_neighbours: &[16.0, 64.0] };
        let record = study(plan).unwrap();
        assert_eq!(record["failures"], json!([]));
        let position = |shape: &str, noise: f64, field: &str| {
            let wanted = [
                ("shape", json!(shape)),
                ("noise_in_spacings", json!(noise)),
                ("field", json!(field)),
                ("operator", json!("orthogonal")),
                ("automatic", json!(false)),
            ];
            numbers(&record, "position_in_spacings", &wanted)
        };
        for field in FIELDS.map(|field| field.to_string()) {
            // Bias: four times the neighbours are four times the square of the support.
            let torus = position("torus", 0.0, &field);
            assert!((3.0..5.0).contains(&(torus[1] / torus[0])), "{field}: {torus:?}");
            // Noise: four times the neighbours halve the error where nothing bends.
            let plane = position("plane", 0.5, &field);
            assert!((1.6..2.6).contains(&(plane[0] / plane[1])), "{field}: {plane:?}");
            // Without either there is no error.
            assert!(position("plane", 0.0, &field).iter().all(|&e| e < 1e-9), "{field}");
        }
        let chosen = |noise: f64| {
            let wanted =
                [("shape", json!("torus")), ("noise_in_spacings", json!(noise)), ("automatic", json!(true))];
            numbers(&record, "effective_neighbours", &wanted)[0]
        };
        assert!(chosen(0.0) < chosen(0.5) && chosen(0.5) < chosen(1.0));
    }
}
