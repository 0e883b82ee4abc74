//! Curvatures, noise and uncertainties are reachable from the command, with the numbers of the library.

mod common;

use common::{Folder, bits, csv_of};
use footpoint::samples::{self, Random};
use footpoint::{Cloud, Definition, Noise, Queries, Support, Surface, Uncertainty, Want};

fn noisy_sphere(folder: &Folder) -> Vec<[f64; 3]> {
    let sphere = samples::sphere(1.0, 4000, 2).with_noise(0.01, 3);
    let mut random = Random::new(4);
    let rows = sphere.points.iter().map(|p| [&p[..], &[0.005 + 0.01 * random.uniform()]].concat());
    folder.write("cloud.csv", csv_of("x,y,z,accuracy", rows));
    sphere.points
}

#[test]
fn curvatures_have_names_and_the_librarys_bits() {
    let folder = Folder::new();
    let sphere = samples::sphere(1.0, 2000, 1).points;
    folder.write("cloud.csv", csv_of("x,y,z", sphere.iter().map(|p| p.to_vec())));
    folder.done("normals cloud.csv -o n.csv --curvature --radius 0.3");
    folder.done(
        "evaluate cloud.csv --at cloud.csv -o e.csv --with curvature,hessian,eccentricity --radius 0.3",
    );
    let points = folder.csv("cloud.csv").points::<3>();
    let definition = Definition::new().with_support(Support::Uniform(0.3));
    let surface = Surface::new(Cloud::new(points), definition).unwrap();
    let expected = surface.evaluate(Queries::Samples, Want::CURVATURE | Want::HESSIAN | Want::ECCENTRICITY);
    for file in ["n.csv", "e.csv"] {
        let csv = folder.csv(file);
        assert_eq!(bits(&csv.numbers("mean_curvature")), bits(&expected.curvature.mean), "{file}");
        assert_eq!(bits(&csv.numbers("gaussian_curvature")), bits(&expected.curvature.gaussian), "{file}");
        let second: Vec<f64> = expected.curvature.principal.iter().map(|k| k[1]).collect();
        assert_eq!(bits(&csv.numbers("principal_curvature_2")), bits(&second), "{file}");
        assert_eq!(csv.vectors::<3>("principal_direction_1").len(), 2000, "{file}");
    }
    let csv = folder.csv("e.csv");
    let mixed: Vec<f64> = expected.hessian.iter().map(|h| h[0][2]).collect();
    assert_eq!(bits(&csv.numbers("hessian_xz")), bits(&mixed));
    assert_eq!(bits(&csv.numbers("eccentricity")), bits(&expected.eccentricity));
    folder.write("circle.csv", csv_of("x,y", samples::circle(1.0, 200, 1).points.iter().map(|p| p.to_vec())));
    folder.done("normals circle.csv -o c.csv --curvature");
    let mut bent: Vec<f64> = folder.csv("c.csv").numbers("curvature").iter().map(|k| k.abs()).collect();
    bent.sort_by(f64::total_cmp);
    assert!((0.8..1.25).contains(&bent[100]), "{}", bent[100]);
}

#[test]
fn noise_gives_every_distance_its_deviation_and_bias() {
    let folder = Folder::new();
    let points = noisy_sphere(&folder);
    folder
        .write("query.csv", csv_of("x,y,z", [[0.0, 0.0, 1.1], [0.0, 1.05, 0.0]].iter().map(|p| p.to_vec())));
    let surface = |noise| {
        let definition = Definition::new().with_support(Support::Uniform(0.25));
        Surface::new(Cloud::new(points.clone()).with_noise(noise).unwrap(), definition).unwrap()
    };
    let uniform = surface(Noise::Uniform(0.01));
    folder.done("project query.csv --onto cloud.csv -o plain.csv --radius 0.25");
    assert!(!folder.text("plain.csv").contains("sigma"));
    folder.done("project query.csv --onto cloud.csv -o q.csv --radius 0.25 --noise 0.01 --query-noise 0.03");
    let at = [[0.0, 0.0, 1.1], [0.0, 1.05, 0.0]];
    let how = Uncertainty::new().with_query_noise(Noise::Uniform(0.03));
    let expected = uniform.uncertainty(&at, &how).unwrap();
    let csv = folder.csv("q.csv");
    assert_eq!(bits(&csv.numbers("distance_sigma")), bits(&expected.sigma));
    assert_eq!(bits(&csv.numbers("distance_bias")), bits(&expected.bias));
    assert!(expected.sigma[0] > 0.03);

    // A column of the queries, each row its own.
    folder.write(
        "each.csv",
        csv_of("x,y,z,own", at.iter().zip([0.03, 0.001]).map(|(p, s)| [&p[..], &[s]].concat())),
    );
    folder.done("project each.csv --onto cloud.csv -o w.csv --radius 0.25 --noise 0.01 --query-noise own");
    let each = folder.csv("w.csv").numbers("distance_sigma");
    assert_eq!(each[0].to_bits(), expected.sigma[0].to_bits());
    assert!(each[1] < 0.01, "{each:?}");

    folder.done("project cloud.csv -o s.csv --radius 0.25 --noise 0.01");
    let own = uniform.uncertainty(Queries::Samples, &Uncertainty::new()).unwrap();
    assert_eq!(bits(&folder.csv("s.csv").numbers("distance_sigma")), bits(&own.sigma));

    folder.done("evaluate cloud.csv --at query.csv -o e.csv --radius 0.25 --noise accuracy --with sigma");
    let each = surface(Noise::Each(folder.csv("cloud.csv").numbers("accuracy")));
    let sigma = each.evaluate(&at, Want::SIGMA).sigma;
    assert_eq!(bits(&folder.csv("e.csv").numbers("sigma")), bits(&sigma));

    let report = folder.report("project cloud.csv -o a.csv --radius 0.25 --noise auto");
    let found = report["surface"]["noise_sigma"].as_f64().unwrap();
    assert!((found - 0.01).abs() < 0.001, "{found}");
    assert_eq!(report["noise"], "estimated");
    let said = folder.done("project cloud.csv -o a.csv --radius 0.25 --noise auto --force").stderr;
    assert!(said.contains("noise of the samples 0.0"), "{said}");
}

#[test]
fn covariances_come_in_columns() {
    let folder = Folder::new();
    let points = samples::sphere(1.0, 2000, 2).points;
    let mut random = Random::new(4);
    // Long along one direction each: the sensor's range is the noisy part.
    let covariances: Vec<[[f64; 3]; 3]> = points
        .iter()
        .map(|p| {
            let scale = 1e-4 * (1.0 + random.uniform());
            std::array::from_fn(|i| {
                std::array::from_fn(|k| scale * (p[i] * p[k] + if i == k { 0.1 } else { 0.0 }))
            })
        })
        .collect();
    let rows = points
        .iter()
        .zip(&covariances)
        .map(|(p, c)| [&p[..], &[c[0][0], c[0][1], c[0][2], c[1][1], c[1][2], c[2][2]]].concat());
    folder.write("cloud.csv", csv_of("x,y,z,c_xx,c_xy,c_xz,c_yy,c_yz,c_zz", rows));
    folder.done("project cloud.csv -o o.csv --radius 0.3 --noise c");
    let definition = Definition::new().with_support(Support::Uniform(0.3));
    let cloud = Cloud::new(points).with_noise(Noise::Covariances(covariances)).unwrap();
    let surface = Surface::new(cloud, definition).unwrap();
    let expected = surface.uncertainty(Queries::Samples, &Uncertainty::new()).unwrap();
    assert_eq!(bits(&folder.csv("o.csv").numbers("distance_sigma")), bits(&expected.sigma));
    let ran = folder.run("project cloud.csv -o p.csv --noise c_x");
    assert!(ran.code == 2 && ran.stderr.contains("`c_x`"), "{}", ran.stderr);
}

#[test]
fn wrong_noise_is_named() {
    let folder = Folder::new();
    noisy_sphere(&folder);
    for (words, problem) in [
        ("evaluate cloud.csv --at cloud.csv -o o.csv --with sigma", "sigma needs the noise"),
        ("project cloud.csv -o o.csv --noise nothing", "no column of numbers named `nothing`"),
        ("project cloud.csv -o o.csv --noise -0.1", "finite and not negative"),
        ("project cloud.csv -o o.csv --noise nan", "finite and not negative"),
        ("project cloud.csv -o o.csv --query-noise 0.1", "--noise"),
    ] {
        let ran = folder.run(words);
        assert_eq!(ran.code, 2, "{words}");
        assert!(ran.stderr.contains(problem), "{words}: {}", ran.stderr);
        assert!(!folder.path("o.csv").exists(), "{words}");
    }
}
