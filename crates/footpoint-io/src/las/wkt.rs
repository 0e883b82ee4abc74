//! The unit of `x` and `y` in a coordinate reference system written as WKT, of either version.

use crate::Unit;

/// Systems whose coordinates are lengths.
const LENGTHS: [&str; 7] =
    ["PROJCS", "PROJCRS", "PROJECTEDCRS", "LOCAL_CS", "ENGCRS", "ENGINEERINGCRS", "GEOCCS"];
/// Systems of longitude and latitude; those below a projected system are its base.
const ANGLES: [&str; 5] = ["GEOGCS", "GEOGCRS", "GEOGRAPHICCRS", "GEODCRS", "GEODETICCRS"];
const FOOT: f64 = 0.3048;
const US_FOOT: f64 = 1200.0 / 3937.0;

/// A keyword with what stands in its brackets.
#[derive(Default)]
struct Node {
    keyword: String,
    arguments: Vec<String>,
}

/// The unit of the first system that has one; `None` if it is another one, or the text is not WKT.
pub(super) fn unit(wkt: &str) -> Option<Unit> {
    let mut open: Vec<Node> = Vec::new();
    let mut word = String::new();
    let mut is_quoted = false;
    for c in wkt.chars() {
        match c {
            '"' => is_quoted = !is_quoted,
            _ if is_quoted => word.push(c),
            '[' | '(' => {
                open.push(Node { keyword: word.trim().to_ascii_uppercase(), arguments: Vec::new() });
                word.clear();
            }
            ',' | ']' | ')' => {
                if let Some(node) = open.last_mut() {
                    node.arguments.push(word.trim().to_owned());
                }
                word.clear();
                if c != ','
                    && let Some(found) = open.pop().and_then(|node| meaning(&node, &open))
                {
                    return found;
                }
            }
            _ => word.push(c),
        }
    }
    None
}

/// What a node that has been closed says of the unit, if it is one: a unit of a system or of its axes.
fn meaning(node: &Node, open: &[Node]) -> Option<Option<Unit>> {
    if !matches!(node.keyword.as_str(), "UNIT" | "LENGTHUNIT" | "ANGLEUNIT") {
        return None;
    }
    let mut above = open.iter().rev().map(|node| node.keyword.as_str());
    let mut system = above.next()?;
    if system == "AXIS" {
        system = above.next()?;
    }
    let is_length = LENGTHS.contains(&system) || ANGLES.contains(&system) && node.keyword == "LENGTHUNIT";
    let is_base = above.any(|keyword| LENGTHS.contains(&keyword));
    if !is_length && (is_base || !ANGLES.contains(&system)) {
        return None;
    }
    if !is_length {
        return Some(Some(Unit::Degree));
    }
    let metres: f64 = node.arguments.get(1)?.parse().ok()?;
    // The two feet differ by two millionths; files round them to seven digits and more.
    let is = |length: f64| (metres / length - 1.0).abs() < 5e-7;
    let units = [(1.0, Unit::Metre), (FOOT, Unit::Foot), (US_FOOT, Unit::UsSurveyFoot)];
    Some(units.into_iter().find(|(length, _)| is(*length)).map(|(_, unit)| unit))
}
