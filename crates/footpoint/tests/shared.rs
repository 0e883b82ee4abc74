//! A surface is shared freely between threads, and what defines it can be written down and read again.
#![allow(clippy::unwrap_used)]

mod common;

use footpoint::{
    Cloud, Definition, Error, Evaluations, Orientation, Project, Projections, Queries, Run, Running, Support,
    Surface, Trace, Want, samples,
};

fn shared<T: Send + Sync>() {}

#[test]
fn everything_public_is_send_and_sync() {
    shared::<Cloud<2>>();
    shared::<Surface<2>>();
    shared::<Surface<3>>();
    shared::<Evaluations<3>>();
    shared::<Projections<3>>();
    shared::<Trace<3>>();
    shared::<Orientation<3>>();
    shared::<Queries<'_, 3>>();
    shared::<Running<'_, 3>>();
    shared::<Run<'_>>();
    shared::<Definition>();
    shared::<Project>();
    shared::<Error>();
}

#[test]
fn many_threads_ask_one_surface_at_once_and_get_the_same() {
    let shape = samples::sphere(1.0, 1500, 1);
    let definition = Definition::new().with_support(Support::Uniform(0.3));
    let surface = Surface::new(Cloud::new(shape.points), definition).unwrap();
    let expected = common::evaluation_rows(&surface.evaluate(Queries::Samples, Want::ALL));
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..4)
            .map(|k| {
                let surface = &surface;
                // Threads that ask for different numbers of threads displace each other's pool.
                scope.spawn(move || {
                    let run = Run::new().threads(1 + k % 3);
                    let each = || surface.with(&run).evaluate(Queries::Samples, Want::ALL).unwrap();
                    (0..5).map(|_| common::evaluation_rows(&each())).collect::<Vec<_>>()
                })
            })
            .collect();
        for worker in workers {
            for rows in worker.join().unwrap() {
                common::same_rows(&rows, &expected, "asked at once");
            }
        }
    });
}

#[cfg(feature = "serde")]
mod written {
    use super::common::{FIELDS, OPERATORS, WEIGHTS};
    use footpoint::{Acceptance, Definition, Project, Support, Weight};

    #[track_caller]
    fn round_trip<T>(value: T)
    where
        T: serde::Serialize + serde::de::DeserializeOwned + PartialEq + std::fmt::Debug,
    {
        let text = serde_json::to_string(&value).unwrap();
        let back: T = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{e} in {text}"));
        assert_eq!(back, value, "{text}");
    }

    #[test]
    fn definitions_and_projections_read_back_as_they_were() {
        let supports = [
            Support::Uniform(0.1),
            Support::FromSamples,
            Support::default(),
            Support::AutoPerSample { effective_neighbours: 12.5 },
        ];
        for field in FIELDS {
            for weight in WEIGHTS.map(|w| w.0).into_iter().chain([Weight::GAUSSIAN]) {
                for support in supports {
                    let acceptance =
                        Acceptance { gap: 0.1 + 0.2, boundary: Some(1.0 / 3.0), ..Acceptance::default() };
                    let definition = Definition::new()
                        .with_field(field)
                        .with_weight(weight)
                        .with_support(support)
                        .with_domain_ratio(0.7)
                        .with_acceptance(acceptance);
                    round_trip(definition);
                }
            }
        }
        round_trip(Definition::default());
        for operator in OPERATORS {
            round_trip(Project::new().with_operator(operator).with_tolerance(1e-9).with_most_evaluations(77));
        }
        assert_eq!(serde_json::from_str::<Definition>("{}").unwrap(), Definition::default());
    }

    #[test]
    fn a_definition_that_accepts_every_zero_reads_back_as_it_was() {
        // JSON has no infinity.
        round_trip(Definition::new().with_acceptance(Acceptance::EVERY_ZERO));
    }
}
