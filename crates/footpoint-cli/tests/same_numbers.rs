//! The numbers in the files, PLY and text, are bit for bit those that the library gives.

mod common;

use common::{Folder, bits, csv_of, numbers_of};
use footpoint::samples::{Random, torus};
use footpoint::{
    Cloud, Definition, Evaluations, NormalField, Operator, Project, Projections, Queries, Support, Surface,
    Want, Weight,
};

/// A noisy torus with normals, supports and factors, and points around it.
struct Setting {
    folder: Folder,
    surface: Surface<3>,
    queries: Vec<[f64; 3]>,
}

const OPTIONS: &str = "--support-column reach --factor-column area --weight wendland --field averaged";

fn setting() -> Setting {
    let samples = torus(1.0, 0.4, 1500, 11).with_noise(0.01, 5);
    let mut random = Random::new(9);
    let mut column = |low: f64, high: f64| -> Vec<f64> {
        samples.points.iter().map(|_| low + (high - low) * random.uniform()).collect()
    };
    let (supports, factors) = (column(0.25, 0.4), column(0.5, 1.5));
    let rows = (0..samples.points.len())
        .map(|i| [&samples.points[i][..], &samples.normals[i], &[supports[i], factors[i]]].concat());
    let folder = Folder::new();
    folder.write("cloud.csv", csv_of("x,y,z,nx,ny,nz,reach,area", rows));
    let mut queries: Vec<[f64; 3]> =
        samples.points.iter().step_by(7).map(|p| p.map(|c| c + 0.1 * random.normal())).collect();
    // Far outside nothing exists: nan in both.
    queries.push([5.0, 0.0, 0.0]);
    folder.write("queries.csv", csv_of("x,y,z", queries.iter().map(|q| q.to_vec())));

    let cloud = Cloud::new(samples.points).with_normals(samples.normals).unwrap();
    let cloud = cloud.with_supports(supports).unwrap().with_factors(factors).unwrap();
    let definition = Definition::new()
        .with_support(Support::FromSamples)
        .with_weight(Weight::Wendland)
        .with_field(NormalField::AveragedNormals);
    Setting { folder, surface: Surface::new(cloud, definition).unwrap(), queries }
}

/// Compares columns of two files, one of each format, with what the library gives.
struct Columns {
    ply: footpoint_io::Table,
    csv: common::Csv,
}

impl Columns {
    fn read(folder: &Folder, name: &str) -> Self {
        Self { ply: folder.table(&format!("{name}.ply")), csv: folder.csv(&format!("{name}.csv")) }
    }

    fn equal(&self, in_ply: &str, in_csv: &str, expected: impl Iterator<Item = f64>) {
        let expected: Vec<f64> = expected.collect();
        assert!(expected.iter().any(|v| v.is_finite() && *v != 0.0), "{in_csv}: nothing to compare");
        let same = |found: &[f64]| {
            let both = found.iter().zip(&expected);
            found.len() == expected.len()
                && both.into_iter().all(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan())
        };
        assert!(same(&numbers_of(&self.ply, in_ply)), "{in_ply} in PLY");
        assert!(same(&self.csv.numbers(in_csv)), "{in_csv} in csv");
    }

    fn vectors(&self, in_ply: [&str; 3], in_csv: &str, expected: &[[f64; 3]]) {
        for (k, axis) in ["x", "y", "z"].iter().enumerate() {
            self.equal(in_ply[k], &format!("{in_csv}_{axis}"), expected.iter().map(|v| v[k]));
        }
    }
}

#[test]
fn evaluate() {
    let s = setting();
    for output in ["out.ply", "out.csv"] {
        let with = "--with weight_sum,eigenvalues,squared_sensitivity,support";
        s.folder.done(&format!("evaluate cloud.csv --at queries.csv -o {output} {with} {OPTIONS}"));
    }
    let e: Evaluations<3> = s.surface.evaluate(&s.queries, Want::ALL);
    let c = Columns::read(&s.folder, "out");
    c.equal("x", "x", s.queries.iter().map(|q| q[0]));
    c.equal("value", "value", e.value.iter().copied());
    c.vectors(["average_x", "average_y", "average_z"], "average", &e.average);
    c.vectors(["frame_nx", "frame_ny", "frame_nz"], "frame_normal", &e.frame_normal);
    c.vectors(["nx", "ny", "nz"], "surface_normal", &e.surface_normal);
    c.vectors(["gradient_x", "gradient_y", "gradient_z"], "gradient", &e.gradient);
    c.equal("gap", "gap", e.gap.iter().copied());
    c.equal("neighbours", "neighbours", e.neighbours.iter().map(|&n| f64::from(n)));
    let effective = "effective_neighbours";
    c.equal(effective, effective, e.effective_neighbours.iter().copied());
    c.equal("weight_sum", "weight_sum", e.weight_sum.iter().copied());
    c.equal("support", "support", e.support.iter().copied());
    let sensitivity = "squared_sensitivity";
    c.equal(sensitivity, sensitivity, e.squared_sensitivity.iter().copied());
    let words: Vec<&str> = e.status.iter().map(|s| s.name()).collect();
    assert_eq!(c.csv.words("status"), words);
    let numbers: Vec<f64> = e.status.iter().map(|s| f64::from(*s as u8)).collect();
    assert_eq!(numbers_of(&c.ply, "status"), numbers);
    assert!(e.status.iter().any(|s| !s.is_ok()), "no nan was compared");
}

#[test]
fn normals() {
    let s = setting();
    for output in ["out.ply", "out.csv"] {
        s.folder.done(&format!("normals cloud.csv --normal both -o {output} {OPTIONS}"));
    }
    let e = s.surface.evaluate(Queries::Samples, Want::ALL);
    let c = Columns::read(&s.folder, "out");
    c.vectors(["nx", "ny", "nz"], "surface_normal", &e.surface_normal);
    c.vectors(["frame_nx", "frame_ny", "frame_nz"], "frame_normal", &e.frame_normal);
    assert_eq!(bits(&numbers_of(&c.ply, "reach")), bits(s.surface.cloud().supports().unwrap()));
}

#[test]
fn project() {
    let s = setting();
    for output in ["out.ply", "out.csv"] {
        let how = "--operator almost --tolerance 1e-9";
        s.folder.done(&format!("project queries.csv --onto cloud.csv -o {output} {how} {OPTIONS}"));
    }
    let how = Project::new().with_operator(Operator::AlmostOrthogonal).with_tolerance(1e-9);
    let p: Projections<3> = s.surface.project(&s.queries, &how);
    let c = Columns::read(&s.folder, "out");
    for (k, axis) in ["x", "y", "z"].iter().enumerate() {
        c.equal(axis, axis, p.point.iter().map(|v| v[k]));
    }
    c.vectors(["nx", "ny", "nz"], "surface_normal", &p.surface_normal);
    c.equal("distance", "distance", p.distance.iter().copied());
    c.equal("residual", "residual", p.residual.iter().copied());
    c.equal("evaluations", "evaluations", p.evaluations.iter().map(|&e| f64::from(e)));
    let numbers: Vec<f64> = p.status.iter().map(|s| f64::from(*s as u8)).collect();
    assert_eq!(numbers_of(&c.ply, "status"), numbers);
}
