//! A wrong definition or cloud is refused with the offending value in the message; nothing else is.
#![allow(clippy::unwrap_used)]

use footpoint::samples;
use footpoint::{Acceptance, Cloud, Definition, NormalField, Support, Surface, Weight};

fn cloud() -> Cloud<3> {
    Cloud::new(samples::sphere(1.0, 100, 1).points)
}

#[track_caller]
fn refused<const D: usize>(cloud: Cloud<D>, definition: Definition, parts: &[&str]) {
    let message = Surface::new(cloud, definition).unwrap_err().to_string();
    for part in parts {
        assert!(message.contains(part), "{message:?} does not say {part:?}");
    }
}

#[test]
fn radii_that_are_not_positive_and_finite() {
    for (radius, said) in [
        (0.0, "radius 0"),
        (-0.0, "radius -0"),
        (-2.5, "-2.5"),
        (f64::NAN, "NaN"),
        (f64::INFINITY, "inf"),
        (f64::NEG_INFINITY, "-inf"),
    ] {
        let definition = Definition::new().with_support(Support::Uniform(radius));
        refused(cloud(), definition, &[said, "positive"]);
        refused(Cloud::<2>::new([[0.0, 1.0]]), definition, &[said]);
    }
    for extreme in [f64::MIN_POSITIVE, 5e-324, 1e300, f64::MAX] {
        let definition = Definition::new().with_support(Support::Uniform(extreme));
        // Nothing is wrong with these, whether or not they can hold such a cloud.
        if let Err(error) = Surface::new(cloud(), definition) {
            assert!(error.to_string().contains("no usable sample"), "{extreme:e}: {error}");
        }
    }
}

#[test]
fn numbers_of_effective_neighbours() {
    for (count, said) in
        [(0.0, "0 effective"), (0.99, "0.99"), (-3.0, "-3"), (f64::NAN, "NaN"), (1e7, "10000000")]
    {
        let auto = Support::Auto { effective_neighbours: count };
        refused(cloud(), Definition::new().with_support(auto), &[said]);
        let each = Support::AutoPerSample { effective_neighbours: count };
        refused(cloud(), Definition::new().with_support(each), &[said]);
    }
}

#[test]
fn cuts_of_the_gaussian() {
    for (cut, said) in [
        (0.0, "cut 0"),
        (1.0, "cut 1"),
        (1.5, "1.5"),
        (-1e-9, "-0.000000001"),
        (f64::NAN, "NaN"),
        (f64::INFINITY, "inf"),
    ] {
        let definition = Definition::new().with_weight(Weight::Gaussian { cut });
        refused(cloud(), definition.with_support(Support::Uniform(0.3)), &["cut", said]);
        refused(cloud(), definition, &["cut", said]);
    }
}

#[test]
fn domain_ratios() {
    for (ratio, said) in
        [(0.0, "ratio 0"), (1.1, "1.1"), (-0.5, "-0.5"), (f64::NAN, "NaN"), (f64::INFINITY, "inf")]
    {
        refused(cloud(), Definition::new().with_domain_ratio(ratio), &["domain ratio", said]);
    }
    assert!(Surface::new(cloud(), Definition::new().with_domain_ratio(1e-6)).is_ok());
}

#[test]
fn limits_of_the_acceptance_rule() {
    let usual = Acceptance::default();
    for wrong in [
        Acceptance { alignment: f64::NAN, ..usual },
        Acceptance { gap: f64::NAN, ..usual },
        Acceptance { boundary: Some(f64::NAN), ..usual },
    ] {
        refused(cloud(), Definition::new().with_acceptance(wrong), &["acceptance", "NaN"]);
    }
    assert!(Surface::new(cloud(), Definition::new().with_acceptance(Acceptance::EVERY_ZERO)).is_ok());
}

#[test]
fn supports_too_different_for_single_precision() {
    let radii: Vec<f64> = (0..cloud().len()).map(|i| if i == 0 { 1e-4 } else { 1.0 }).collect();
    let cloud = cloud().with_supports(radii).unwrap();
    let definition = Definition::new().with_support(Support::FromSamples);
    assert!(Surface::new(cloud.clone(), definition).is_ok());
    refused(cloud, definition.with_precision(footpoint::Precision::Single), &["1e-4", "single", "double"]);
}

#[test]
fn fields_that_need_normals() {
    for (field, said) in
        [(NormalField::AveragedNormals, "averaged normals"), (NormalField::AveragedAxes, "averaged axes")]
    {
        let definition = Definition::new().with_field(field);
        assert!(field.needs_normals());
        refused(cloud(), definition, &[said, "normals"]);
        let unusable = vec![[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0]];
        let unusable: Vec<_> = unusable.into_iter().cycle().take(100).collect();
        let with = cloud().with_normals(unusable.clone()).unwrap();
        assert_eq!(with.absent_normals(), 100);
        refused(with, definition, &[said, "normals"]);
        // One usable normal suffices: where it does not reach the points are degenerate, one by one.
        let mut one = unusable;
        one[0] = [0.0, 0.0, 2.0];
        assert!(Surface::new(cloud().with_normals(one).unwrap(), definition).is_ok());
    }
    for field in [NormalField::Covariance, NormalField::CentredCovariance] {
        assert!(!field.needs_normals() && Surface::new(cloud(), Definition::new().with_field(field)).is_ok());
    }
}

#[test]
fn supports_from_samples_without_a_column() {
    let definition = Definition::new().with_support(Support::FromSamples);
    refused(cloud(), definition, &["column of supports"]);
    assert!(Surface::new(cloud().with_supports(vec![0.5; 100]).unwrap(), definition).is_ok());
    let wide: Vec<f64> = (0..100).map(|i| if i == 0 { 1e-70 } else { 0.5 }).collect();
    refused(cloud().with_supports(wide).unwrap(), definition, &["1e-70", "5e-1"]);
}

#[test]
fn clouds_without_a_usable_sample() {
    let uniform = Definition::new().with_support(Support::Uniform(0.5));
    for definition in [uniform, Definition::new(), uniform.with_field(NormalField::AveragedNormals)] {
        refused(Cloud::<3>::default(), definition, &["no usable sample", "0"]);
        refused(Cloud::<2>::new([]), definition, &["no usable sample", "0"]);
    }
    for definition in [uniform, Definition::new()] {
        refused(Cloud::new([[f64::NAN, 0.0]; 5]), definition, &["no usable sample among 5"]);
        let worthless = cloud().with_factors(vec![0.0; 100]).unwrap();
        refused(worthless, definition, &["no usable sample among 100"]);
    }
    let from = Definition::new().with_support(Support::FromSamples);
    refused(cloud().with_supports(vec![f64::NAN; 100]).unwrap(), from, &["no usable sample among 100"]);
    refused(Cloud::new([[1e300, 0.0]; 4]), uniform, &["no usable sample among 4"]);
}

#[test]
fn an_automatic_support_where_all_samples_coincide() {
    for support in [Support::default(), Support::AutoPerSample { effective_neighbours: 4.0 }] {
        let definition = Definition::new().with_support(support);
        refused(Cloud::new([[1.0, 2.0]; 9]), definition, &["all 9", "coincide"]);
        refused(Cloud::new([[1.0, 2.0, 3.0]]), definition, &["all 1", "coincide"]);
        assert!(Surface::new(Cloud::new([[1.0, 2.0], [1.0, 2.5]]), definition).is_ok());
    }
    assert!(
        Surface::new(Cloud::new([[1.0, 2.0]; 9]), Definition::new().with_support(Support::Uniform(1.0)))
            .is_ok()
    );
}

#[test]
fn an_automatic_support_on_clouds_that_are_hard_on_trees() {
    // Lattices, lines and planes have many equal coordinates; the tiniest distances have no half.
    let lattice: Vec<[f64; 3]> =
        (0..8000).map(|i| [f64::from(i % 20), f64::from(i / 20 % 20), f64::from(i / 400)]).collect();
    let line: Vec<[f64; 3]> = (0..5000).map(|i| [0.0, f64::from(i), 0.0]).collect();
    let plane: Vec<[f64; 3]> = (0..5000).map(|i| [f64::from(i % 50), f64::from(i / 50), 7.0]).collect();
    for (points, spacing) in [(lattice, 1.0), (line, 1.0), (plane, 1.0)] {
        let cloud = Cloud::new(points);
        assert_eq!(footpoint::spacing(&cloud, &footpoint::Run::new()), Some(spacing));
        assert!(Surface::new(cloud, Definition::new()).is_ok());
    }
    for tiny in [1e-300, f64::MIN_POSITIVE, 5e-324] {
        assert!(Surface::new(Cloud::new([[0.0, 0.0], [tiny, 0.0], [0.0, tiny]]), Definition::new()).is_ok());
    }
}

#[test]
fn columns_of_another_length_and_negative_values() {
    let message = |error: footpoint::CloudError| error.to_string();
    let short = message(cloud().with_normals(vec![[1.0, 0.0, 0.0]; 99]).unwrap_err());
    assert!(short.contains("99") && short.contains("100") && short.contains("normals"), "{short}");
    let long = message(cloud().with_supports(vec![1.0; 101]).unwrap_err());
    assert!(long.contains("101") && long.contains("support"), "{long}");
    let none = message(cloud().with_factors(vec![]).unwrap_err());
    assert!(none.contains("factor") && none.contains('0'), "{none}");
    let mut values = vec![1.0; 100];
    values[42] = -0.25;
    let negative = message(cloud().with_supports(values.clone()).unwrap_err());
    assert!(negative.contains("42") && negative.contains("-0.25"), "{negative}");
    let negative = message(cloud().with_factors(values).unwrap_err());
    assert!(negative.contains("42") && negative.contains("-0.25"), "{negative}");
}
