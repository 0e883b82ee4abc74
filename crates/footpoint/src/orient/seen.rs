//! Signs from where the samples were seen: a viewpoint, an axis, sensor positions, a trajectory.

use super::{Orient, OrientError, Orientation};
use crate::algebra::{direction, dot, sub};
use crate::status::Status;

/// A normal within 6 degrees of a right angle to the line of sight has a doubtful sign.
const GRAZING: f64 = 0.1;

/// Fails where columns do not fit or a direction makes no sense.
pub(super) fn check<const D: usize>(how: &Orient<'_, D>, expected: usize) -> Result<(), OrientError> {
    let finite = |v: &[f64]| v.iter().all(|c| c.is_finite());
    let fits = |column, found| {
        if found == expected { Ok(()) } else { Err(OrientError::Length { column, expected, found }) }
    };
    match how {
        Orient::Towards(point) if !finite(point) => Err(OrientError::NotFinite("viewpoint")),
        Orient::Along(axis) if direction(*axis)[0].is_nan() => Err(OrientError::NotFinite("axis")),
        Orient::Sensors(positions) => fits("sensor positions", positions.len()),
        Orient::Trajectory { times, path } => {
            fits("times", times.len())?;
            if path.is_empty() {
                return Err(OrientError::NoPath);
            }
            let broken = |i: usize| {
                let (time, at) = path[i];
                !time.is_finite() || !finite(&at) || (i > 0 && time < path[i - 1].0)
            };
            (0..path.len()).find(|&i| broken(i)).map_or(Ok(()), |i| Err(OrientError::Path(i)))
        }
        _ => Ok(()),
    }
}

/// Reverses the normals that point away from where their sample was seen. Where that is unknown there is no sign.
pub(super) fn face<const D: usize>(how: &Orient<'_, D>, points: &[[f64; D]], found: &mut Orientation<D>) {
    for (i, normal) in found.normal.iter_mut().enumerate() {
        if normal[0].is_nan() {
            continue;
        }
        let sight = match how {
            Orient::Along(axis) => Some(*axis),
            Orient::Towards(from) => Some(sub(*from, points[i])),
            Orient::Sensors(from) => Some(sub(from[i], points[i])),
            Orient::Trajectory { times, path } => position(path, times[i]).map(|from| sub(from, points[i])),
            Orient::Propagated(_) => None,
        };
        let cosine = sight.map(|sight| dot(*normal, direction(sight)));
        match cosine {
            Some(cosine) if !cosine.is_nan() => {
                found.oriented += 1;
                found.doubtful += usize::from(cosine.abs() < GRAZING);
                if cosine < 0.0 {
                    *normal = normal.map(|c| -c);
                    found.reversed += 1;
                }
            }
            unseen => {
                *normal = [f64::NAN; D];
                found.status[i] = if unseen.is_none() { Status::Outside } else { Status::Degenerate };
            }
        }
    }
}

/// Where the path is at this time, by linear interpolation; `None` before its begin and after its end.
fn position<const D: usize>(path: &[(f64, [f64; D])], time: f64) -> Option<[f64; D]> {
    let next = path.partition_point(|entry| entry.0 <= time);
    let (before, from) = *path.get(next.checked_sub(1)?)?;
    match path.get(next) {
        Some(&(after, to)) => {
            let share = (time - before) / (after - before);
            Some(std::array::from_fn(|k| from[k] + share * (to[k] - from[k])))
        }
        None => (time == before).then_some(from),
    }
}

#[cfg(test)]
mod tests {
    use super::position;

    #[test]
    fn positions_lie_on_the_path_and_nowhere_else() {
        let path = [(1.0, [0.0, 0.0]), (2.0, [4.0, 2.0]), (2.0, [8.0, 0.0]), (3.0, [9.0, 0.0])];
        assert_eq!(position(&path, 1.0), Some([0.0, 0.0]));
        assert_eq!(position(&path, 1.25), Some([1.0, 0.5]));
        assert_eq!(position(&path, 2.0), Some([8.0, 0.0]));
        assert_eq!(position(&path, 3.0), Some([9.0, 0.0]));
        assert_eq!(position(&path, 0.999), None);
        assert_eq!(position(&path, 3.001), None);
        assert_eq!(position(&path, f64::NAN), None);
    }
}
