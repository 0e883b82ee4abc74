//! Small dense least squares in plain doubles: reflections (Householder's) with exchange of columns.

/// A column of unit length of which the others leave less than this is not determined: squared, the bound of SPEC § 12 on
/// the condition of the normal equations.
const LEAST_REST: f64 = 3.2e-4;

/// The x that makes |Σ_j x_j columns_j − right| smallest; `None` where the columns, brought to unit length, are nearly
/// dependent or more than the rows, and where a number is not finite.
pub(crate) fn least_squares(mut columns: Vec<Vec<f64>>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let terms = columns.len();
    if right.len() < terms {
        return None;
    }
    let lengths: Vec<f64> = columns.iter().map(|column| product(column, column).sqrt()).collect();
    for (column, length) in columns.iter_mut().zip(&lengths) {
        column.iter_mut().for_each(|entry| *entry /= length);
    }
    let mut order: Vec<usize> = (0..terms).collect();
    let mut diagonal = vec![0.0; terms];
    for k in 0..terms {
        // Of the columns that are left, the one with most beside the earlier ones; the first of equals.
        let rests: Vec<f64> = columns[k..].iter().map(|column| product(&column[k..], &column[k..])).collect();
        let longest = (0..rests.len()).fold(0, |best, j| if rests[j] > rests[best] { j } else { best });
        let rest = rests[longest].sqrt();
        if rest.is_nan() || rest < LEAST_REST {
            return None;
        }
        columns.swap(k, k + longest);
        order.swap(k, k + longest);
        let (done, left) = columns.split_at_mut(k + 1);
        let mirror = &mut done[k][k..];
        diagonal[k] = if mirror[0] > 0.0 { -rest } else { rest };
        mirror[0] -= diagonal[k];
        let square = product(mirror, mirror);
        for other in left.iter_mut().chain(std::iter::once(&mut right)) {
            let other = &mut other[k..];
            let along = 2.0 * product(mirror, other) / square;
            other.iter_mut().zip(mirror.iter()).for_each(|(entry, part)| *entry -= along * part);
        }
    }
    let mut solution = vec![0.0; terms];
    for k in (0..terms).rev() {
        let known: f64 = (k + 1..terms).map(|j| columns[j][k] * solution[order[j]] * lengths[order[j]]).sum();
        solution[order[k]] = (right[k] - known) / (diagonal[k] * lengths[order[k]]);
    }
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::Random;

    fn random_columns(rows: usize, terms: usize, random: &mut Random) -> Vec<Vec<f64>> {
        (0..terms).map(|_| (0..rows).map(|_| random.normal()).collect()).collect()
    }

    #[test]
    fn exact_data_give_their_coefficients_whatever_the_columns_scales() {
        let mut random = Random::new(1);
        for terms in 1..=15 {
            let mut columns = random_columns(40, terms, &mut random);
            for (j, column) in columns.iter_mut().enumerate() {
                column.iter_mut().for_each(|entry| *entry *= 10.0_f64.powi(3 * j as i32 - 20));
            }
            let truth: Vec<f64> = (0..terms).map(|_| random.normal()).collect();
            let right = (0..40).map(|i| (0..terms).map(|j| columns[j][i] * truth[j]).sum()).collect();
            let lengths: Vec<f64> = columns.iter().map(|c| product(c, c).sqrt()).collect();
            let found = least_squares(columns, right).unwrap();
            let size = lengths.iter().zip(&truth).fold(0.0_f64, |m, (l, t)| m.max((l * t).abs()));
            for j in 0..terms {
                assert!(((found[j] - truth[j]) * lengths[j]).abs() < 1e-13 * size, "{terms} {j}");
            }
        }
    }

    #[test]
    fn the_residual_stands_across_every_column() {
        let mut random = Random::new(2);
        let columns = random_columns(30, 6, &mut random);
        let right: Vec<f64> = (0..30).map(|_| random.normal()).collect();
        let found = least_squares(columns.clone(), right.clone()).unwrap();
        let residual: Vec<f64> =
            (0..30).map(|i| right[i] - (0..6).map(|j| columns[j][i] * found[j]).sum::<f64>()).collect();
        assert!(product(&residual, &residual) > 1.0);
        assert!(columns.iter().all(|column| product(column, &residual).abs() < 1e-13));
    }

    #[test]
    fn what_is_not_determined_is_refused() {
        let mut random = Random::new(3);
        let right = vec![1.0; 10];
        let columns = random_columns(10, 3, &mut random);
        assert!(least_squares(columns.clone(), right.clone()).is_some());
        assert!(least_squares(random_columns(10, 11, &mut random), right.clone()).is_none());
        for nearness in [0.0, 1e-6] {
            let near =
                (0..10).map(|i| columns[0][i] - 2.0 * columns[1][i] + nearness * columns[2][i]).collect();
            let dependent = vec![columns[0].clone(), columns[1].clone(), near];
            assert!(least_squares(dependent, right.clone()).is_none(), "{nearness}");
        }
        assert!(least_squares(vec![vec![0.0; 10]], right.clone()).is_none());
        assert!(least_squares(vec![vec![f64::NAN; 10]], right.clone()).is_none());
        assert!(least_squares(columns, vec![f64::INFINITY; 10]).is_none());
    }
}
