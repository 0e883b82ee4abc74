//! Coordinates and normals are found by name, whatever their spelling and order.

mod common;

use common::f64_table;
use footpoint_io::roles::Roles;
use footpoint_io::{Column, Data, Table};

fn table(names: &[&str]) -> Table {
    let columns = names.iter().enumerate().map(|(i, name)| Column::new(*name, Data::I16(vec![i as i16, -1])));
    Table { columns: columns.collect(), ..Table::default() }
}

#[test]
fn coordinates_in_any_case_and_order() {
    let table = table(&["time", "Z", "X", "Y"]);
    let roles = Roles::find(&table).unwrap();
    assert_eq!((roles.dimension(), roles.coordinates.as_slice()), (3, &[2, 3, 1][..]));
    assert_eq!(roles.points::<3>(&table).unwrap(), [[2.0, 3.0, 1.0], [-1.0; 3]]);
    assert_eq!(roles.points::<2>(&table), None);
    assert_eq!(roles.normals, None);
}

#[test]
fn without_z_points_are_flat() {
    let table = table(&["x", "y", "nx", "ny"]);
    let roles = Roles::find(&table).unwrap();
    assert_eq!(roles.dimension(), 2);
    assert_eq!(roles.normals::<2>(&table).unwrap(), [[2.0, 3.0], [-1.0; 2]]);
}

#[test]
fn normals_have_several_names() {
    for family in
        [["nx", "ny", "nz"], ["Normal_X", "normal_y", "NORMAL_Z"], ["NormalX", "NormalY", "NormalZ"]]
    {
        let names = [&["x", "y", "z"][..], &family].concat();
        assert_eq!(Roles::find(&table(&names)).unwrap().normals, Some(vec![3, 4, 5]));
    }
    let incomplete = table(&["x", "y", "z", "nx", "ny"]);
    assert_eq!(Roles::find(&incomplete).unwrap().normals, None);
}

#[test]
fn our_own_normals_come_last() {
    let ours = ["surface_normal_x", "surface_normal_y", "surface_normal_z"];
    let names = [&["x", "y", "z"][..], &ours].concat();
    assert_eq!(Roles::find(&table(&names)).unwrap().normals, Some(vec![3, 4, 5]));
    let names = [&names[..], &["nx", "ny", "nz"]].concat();
    assert_eq!(Roles::find(&table(&names)).unwrap().normals, Some(vec![6, 7, 8]));
}

#[test]
fn the_exact_name_goes_before_its_capital() {
    assert_eq!(Roles::find(&table(&["X", "x", "y"])).unwrap().coordinates, [1, 2]);
}

#[test]
fn missing_coordinates_are_named() {
    let message = Roles::find(&table(&["a", "y"])).unwrap_err().to_string();
    assert_eq!(message, "no column `x`; a point needs x y (and z); columns found: a, y");
    let message = Roles::find(&Table::default()).unwrap_err().to_string();
    assert!(message.ends_with("columns found: none"), "{message}");
}

#[test]
fn coordinates_of_text_are_refused() {
    let mut table = f64_table(&[("x", &[1.0])]);
    table.set(Column::new("y", Data::Text(vec!["a".into()])));
    assert_eq!(
        Roles::find(&table).unwrap_err().to_string(),
        "column `y` holds text; coordinates are numbers"
    );
}

#[test]
fn set_replaces_in_place_or_appends() {
    let mut table = f64_table(&[("x", &[1.0]), ("y", &[2.0])]);
    table.set(Column::new("x", Data::U8(vec![9])));
    table.set(Column::new("z", Data::U8(vec![8])));
    assert_eq!(common::names(&table), ["x", "y", "z"]);
    assert_eq!(table.column("x").unwrap().data, Data::U8(vec![9]));
}
