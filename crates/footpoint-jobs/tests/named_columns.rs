//! A column of supports that a recipe names decides, whatever support rule stands in its definition.

mod common;

use common::{numbers, table, with_support};
use footpoint_jobs::{Bending, Context, NormalChoice, Recipe, Support, normals, recipe_of};

#[test]
fn over_any_rule() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let mut cloud = "x,y,z,reach\n".to_owned();
    for i in 0..400 {
        let (u, v) = (f64::from(i % 20), f64::from(i / 20));
        cloud += &format!("{u},{v},{},{}\n", (0.3 * u).sin() + (0.2 * v).cos(), 2.5 + 0.01 * u);
    }
    std::fs::write(path("cloud.csv"), cloud).unwrap();
    let run = |output: &str, recipe: Recipe| {
        let context = Context { recipe, ..Context::default() };
        normals(&path("cloud.csv"), &path(output), (NormalChoice::Surface, Bending::Omit), &context).unwrap()
    };
    let named = |support| Recipe { support_column: Some("reach".to_owned()), ..with_support(support) };
    let first = run("first.ply", named(Support::FromSamples));
    run("second.ply", named(Support::Uniform(4.0)));
    run("plain.ply", with_support(Support::Uniform(4.0)));
    let normal = |name: &str| numbers(&table(folder.path(), name), "nx");
    assert_eq!(normal("first.ply"), normal("second.ply"));
    assert_ne!(normal("first.ply"), normal("plain.ply"));
    assert_eq!(first.surface.as_ref().unwrap().support.largest, 2.5 + 0.01 * 19.0);

    // And the report carries the name to the next run.
    let recipe = recipe_of(&serde_json::to_string(&first).unwrap()).unwrap();
    assert_eq!(recipe.support_column.as_deref(), Some("reach"));
}
