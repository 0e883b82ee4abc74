//! What a dry run would compute, in words.

use footpoint_jobs::{Compare, Kind, Precision, Recipe, Support, Weight};

/// The surface that a job would compute with; all of the recipe is in the report.
pub(super) fn surface(recipe: &Recipe) -> String {
    let definition = &recipe.definition;
    let kind = match definition.kind() {
        Kind::Levin => "Levin's surface".to_owned(),
        _ => format!("point set surface of {}, degree {}", definition.field(), definition.degree()),
    };
    let weight = match definition.weight() {
        Weight::Gaussian { cut } => format!("gaussian down to {cut:e}"),
        weight => format!("{weight:?}").to_lowercase(),
    };
    let tried = match &recipe.compare {
        Some(Compare::Surfaces { effective_neighbours }) => effective_neighbours.as_slice(),
        _ => &[],
    };
    let support = match definition.support() {
        _ if !tried.is_empty() => {
            let numbers: Vec<String> = tried.iter().map(f64::to_string).collect();
            format!("the best of the supports for {} effective neighbours", numbers.join(", "))
        }
        Support::Uniform(radius) => format!("support radius {radius}"),
        Support::FromSamples => "supports of the file".to_owned(),
        Support::Auto { effective_neighbours } => {
            format!("one support for {effective_neighbours} effective neighbours")
        }
        Support::AutoPerSample { effective_neighbours } => {
            format!("a support per sample for {effective_neighbours} effective neighbours")
        }
        Support::LeastError => "the one support of the least estimated error".to_owned(),
        Support::LeastErrorPerSample => "supports per sample of the least estimated error".to_owned(),
        _ => "another rule of supports".to_owned(),
    };
    let precision = match definition.precision() {
        Precision::Single => "single",
        _ => "double",
    };
    format!("{kind}; weight {weight}; {support}; {precision} precision")
}

#[cfg(test)]
mod tests {
    use footpoint_jobs::{Compare, Definition, Kind, NormalField, Precision, Recipe, Support, Weight};

    fn surface(definition: &Definition) -> String {
        super::surface(&Recipe { definition: *definition, ..Recipe::default() })
    }

    #[test]
    fn every_part_is_named() {
        let usual = Definition::default();
        assert_eq!(
            surface(&usual),
            "point set surface of centred covariance, degree 0; weight poly3; one support for 16 effective neighbours; \
             double precision"
        );
        let other = usual
            .with_field(NormalField::AveragedNormals)
            .with_degree(2)
            .with_weight(Weight::GAUSSIAN)
            .with_support(Support::Uniform(0.5))
            .with_precision(Precision::Single);
        assert_eq!(
            surface(&other),
            "point set surface of averaged normals, degree 2; weight gaussian down to 1e-9; support radius 0.5; single \
             precision"
        );
        assert!(surface(&usual.with_kind(Kind::Levin)).starts_with("Levin's surface; "));
        let compared = Recipe { compare: Some(Compare::default()), ..Recipe::default() };
        assert!(
            super::surface(&compared).contains("the best of the supports for 8, 16, 32 effective neighbours")
        );
    }
}
