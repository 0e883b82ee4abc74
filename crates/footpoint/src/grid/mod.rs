//! The index: samples in canonical order, in cells of global grids, one grid per power of two of the support.

mod build;
mod cells;
mod group;

use crate::algebra::exponent;
use crate::lane::Precision;
use cells::Cells;
pub(crate) use cells::Stretch;
pub(crate) use group::{Groups, group};

/// Samples whose scaled coordinates are larger than this cannot be told apart within a support: doubles are too
/// coarse there. They count as absent.
const LARGEST_COORDINATE: f64 = (1_u64 << 50) as f64;
/// The same where coordinates lie on the lattice: `snapped` rounds correctly up to twice that.
const LARGEST_ON_LATTICE: f64 = (1_u64 << 29) as f64;

/// Spacing of the lattice that single precision rounds samples and positions to, in units of the grid: differences of
/// less than eight units are then exact in 24 bits.
pub(crate) const LATTICE: f64 = 1.0 / (1_u64 << 21) as f64;

/// The nearest point of the lattice: doubles of the size of this number are just so far apart.
#[inline(always)]
pub(crate) fn snapped<const D: usize>(point: [f64; D]) -> [f64; D] {
    const ROUNDER: f64 = 1.5 * LATTICE * (1_u64 << 52) as f64;
    point.map(|c| (c + ROUNDER) - ROUNDER)
}

/// Samples in canonical order, in units of `unit`: a power of two with unit ≤ largest support < 2 unit.
///
/// The order depends on the samples alone: level by level (finest first), in each level cell by cell (row-major on a
/// grid that is fixed in space), in each cell by content. Every list of candidates keeps it, so every sum
/// adds in the same order whatever the input order, the batch or the number of threads.
///
/// Beside the coordinates a sample takes some 10 bytes (its place in the input and in the groups, its share of a cell), and
/// 8 for each support or factor of its own.
#[derive(Debug)]
pub(crate) struct Grid<const D: usize> {
    pub(crate) unit: f64,
    pub(crate) store: Store<D>,
    /// h_i in units of `unit`; empty if all are `uniform_scale`.
    pub(crate) scales: Vec<f64>,
    pub(crate) uniform_scale: f64,
    /// Empty if every factor is one.
    pub(crate) factors: Vec<f64>,
    /// One column an axis, zero where absent; empty if the cloud has none.
    pub(crate) normals: [Vec<f64>; D],
    /// Variances or covariances of positions, in squares of `unit`; empty where one figure or none holds for all.
    pub(crate) noise: Vec<Vec<f64>>,
    /// Which sample of the cloud each one is.
    original: Vec<u32>,
    /// The samples as queries: no second search.
    groups: Groups,
    levels: Vec<Level<D>>,
}

/// Coordinates, one column an axis.
#[derive(Debug)]
pub(crate) enum Store<const D: usize> {
    /// As they are.
    Double([Vec<f64>; D]),
    /// Relative to the corner of the sample's cell, on the lattice, so that single precision holds them exactly.
    Single([Vec<f32>; D]),
}

/// The samples whose support lies in one power of two.
#[derive(Debug)]
struct Level<const D: usize> {
    /// Cell side: twice the power of two, so a support reaches into neighbouring cells only.
    side: f64,
    /// Largest support radius here.
    reach: f64,
    cells: Cells<D>,
}

/// The cells of one level, each with those of its 4^D voxels that hold samples.
#[derive(Debug)]
pub(crate) struct Occupied<const D: usize> {
    /// Side of the cells, in units of the grid: between one and two reaches.
    pub(crate) side: f64,
    /// Largest radius of a support.
    pub(crate) reach: f64,
    /// Row by row.
    pub(crate) cells: Vec<([i64; D], u64)>,
}

/// Whether a grid of this precision tells positions here apart within a support. NaN is not.
fn is_held<const D: usize>(point: [f64; D], precision: Precision) -> bool {
    let largest = match precision {
        Precision::Double => LARGEST_COORDINATE,
        Precision::Single => LARGEST_ON_LATTICE,
    };
    point.iter().all(|c| c.abs() < largest)
}

fn cell_of<const D: usize>(point: [f64; D], side: f64) -> [i64; D] {
    // Clamped, so that differences of cells stay in range where a support is tiny and a coordinate huge.
    const FARTHEST: f64 = (1_u64 << 61) as f64;
    // Sides are powers of two: the product is exact.
    let inverse = 1.0 / side;
    point.map(|c| {
        let along = (c * inverse).clamp(-FARTHEST, FARTHEST);
        // Rounded down; the library's own is a call on processors' baseline.
        let toward_zero = along as i64;
        toward_zero - i64::from(toward_zero as f64 > along)
    })
}

/// Row-major: the last axis counts most.
fn compare_cells<const D: usize>(a: [i64; D], b: [i64; D]) -> std::cmp::Ordering {
    a.iter().rev().cmp(b.iter().rev())
}

/// Side of the cells for supports between 2^level and 2^(level + 1).
fn side_of(level: i32) -> f64 {
    2.0_f64.powi(level + 1)
}

/// Side of the cells of the grid for one support radius, in the same unit.
pub(crate) fn cell_side(radius: f64) -> f64 {
    side_of(exponent(radius))
}

impl<const D: usize> Grid<D> {
    /// Number of samples.
    pub(crate) fn len(&self) -> usize {
        self.original.len()
    }

    /// Cell side of the level with most samples, in units of `unit`: queries are grouped by it.
    pub(crate) fn typical_side(&self) -> f64 {
        let count = |level: &&Level<D>| level.cells.samples().len();
        self.levels.iter().max_by_key(count).map_or(2.0, |level| level.side)
    }

    /// What is visited beyond a box: the largest support and a cell.
    pub(crate) fn overhang(&self) -> f64 {
        self.levels.iter().fold(0.0, |m: f64, level| m.max(level.reach + 2.0 * level.side))
    }

    /// Whether positions here, in units of the grid, are told apart within a support. NaN is not.
    pub(crate) fn holds(&self, point: [f64; D]) -> bool {
        let precision = match self.store {
            Store::Double(_) => Precision::Double,
            Store::Single(_) => Precision::Single,
        };
        is_held(point, precision)
    }

    /// The sample at a place, if the grid has it as given.
    #[inline(always)]
    pub(crate) fn sample(&self, place: usize) -> Option<[f64; D]> {
        match &self.store {
            Store::Double(columns) => Some(std::array::from_fn(|k| columns[k][place])),
            Store::Single(_) => None,
        }
    }

    /// Where each sample of the cloud stands; none where it does not take part.
    pub(crate) fn places(&self, cloud: usize) -> Vec<Option<u32>> {
        let mut places = vec![None; cloud];
        for (place, &sample) in self.original.iter().enumerate() {
            places[sample as usize] = Some(place as u32);
        }
        places
    }

    /// The samples as queries.
    pub(crate) fn groups(&self) -> &Groups {
        &self.groups
    }

    /// Which sample of the cloud each one is.
    pub(crate) fn original(&self) -> &[u32] {
        &self.original
    }

    /// The voxels that hold samples, level by level.
    pub(crate) fn occupied(&self) -> impl Iterator<Item = Occupied<D>> {
        self.levels.iter().map(|level| {
            let mut cells = Vec::new();
            level.cells.visit([i64::MIN; D], [i64::MAX; D], level.side, |stretch| {
                for (cell, samples) in stretch.indexed() {
                    let mut voxels = 0;
                    for place in samples {
                        let mut bit = 0;
                        for k in (0..D).rev() {
                            let along = match &self.store {
                                Store::Double(columns) => columns[k][place] - cell[k] as f64 * level.side,
                                Store::Single(columns) => f64::from(columns[k][place]),
                            };
                            let voxel = (along * (4.0 / level.side)) as u64;
                            bit = 4 * bit + voxel.min(3);
                        }
                        voxels |= 1 << bit;
                    }
                    cells.push((cell, voxels));
                }
            });
            Occupied { side: level.side, reach: level.reach, cells }
        })
    }

    /// Calls `visit` with stretches of cells, in canonical order, that contain every sample whose support meets the
    /// box between `low` and `high`.
    pub(crate) fn visit(&self, low: [f64; D], high: [f64; D], mut visit: impl FnMut(Stretch<'_, D>)) {
        // Corners of a box at large coordinates are rounded; one unit in the last place more loses nothing.
        let largest = low.iter().chain(&high).fold(0.0_f64, |m, c| m.max(c.abs()));
        let slack = 4.0 * f64::EPSILON * largest;
        for level in &self.levels {
            let margin = level.reach * (1.0 + 1e-12) + slack;
            let first = cell_of(low.map(|c| c - margin), level.side);
            let last = cell_of(high.map(|c| c + margin), level.side);
            level.cells.visit(first, last, level.side, &mut visit);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::Cloud;
    use crate::run::Run;
    use crate::samples::Random;
    use crate::support::Radii;

    fn random_cloud<const D: usize>(count: usize, extent: f64, seed: u64) -> Vec<[f64; D]> {
        let mut random = Random::new(seed);
        (0..count).map(|_| std::array::from_fn(|_| extent * (random.uniform() - 0.5))).collect()
    }

    fn grid<const D: usize>(points: Vec<[f64; D]>, radii: &Radii, largest: f64) -> Grid<D> {
        Grid::new(&Cloud::new(points), radii, largest, 1.0, Precision::Double, &Run::new())
    }

    fn points<const D: usize>(grid: &Grid<D>) -> Vec<[f64; D]> {
        let Store::Double(columns) = &grid.store else { panic!("not in double precision") };
        (0..grid.len()).map(|i| std::array::from_fn(|k| columns[k][i])).collect()
    }

    /// Every sample in reach of the box is visited once, in canonical order.
    fn check<const D: usize>(cloud: Vec<[f64; D]>, radii: Radii, largest: f64) {
        let grid = grid(cloud, &radii, largest);
        let points = points(&grid);
        let mut random = Random::new(9);
        for _ in 0..200 {
            let centre = points[(random.uniform() * points.len() as f64) as usize];
            let low = centre.map(|c| c - random.uniform());
            let high = centre.map(|c| c + random.uniform());
            let mut seen = vec![0; points.len()];
            let mut last = 0;
            grid.visit(low, high, |stretch| {
                assert!(stretch.samples().start >= last);
                last = stretch.samples().end;
                let mut end = stretch.samples().start;
                for (corner, range) in stretch.cells() {
                    assert_eq!(range.start, end);
                    end = range.end;
                    for i in range {
                        seen[i] += 1;
                        assert!((0..D).all(|k| points[i][k] >= corner[k]));
                    }
                }
                assert_eq!(end, last);
            });
            for (i, p) in points.iter().enumerate() {
                let scale = grid.scales.get(i).copied().unwrap_or(grid.uniform_scale);
                let near = (0..D).all(|k| p[k] >= low[k] - scale && p[k] <= high[k] + scale);
                assert!(seen[i] == 1 || (seen[i] == 0 && !near));
            }
        }
    }

    #[test]
    fn no_sample_in_reach_is_missed() {
        check(random_cloud::<2>(3000, 40.0, 1), Radii::Uniform(1.3), 1.3);
        check(random_cloud::<3>(3000, 12.0, 2), Radii::Uniform(0.9), 0.9);
        let mut outliers = random_cloud::<3>(500, 6.0, 3);
        outliers.extend([[1e12, 0.0, 3.0], [-1e9, 1e9, 5e11], [1e300, 0.0, 0.0]]);
        check(outliers, Radii::Uniform(1.0), 1.0);
        let mut random = Random::new(4);
        let radii: Vec<f64> = (0..3000).map(|_| 2.0 * (-9.0 * random.uniform()).exp()).collect();
        let largest = radii.iter().fold(0.0, |m: f64, &h| m.max(h));
        check(random_cloud::<3>(3000, 12.0, 5), Radii::PerSample(radii), largest);
    }

    #[test]
    fn the_order_does_not_depend_on_the_input_order() {
        for far in [None, Some([1e12, -3e11, 7e13])] {
            let mut cloud = random_cloud::<3>(2000, 10.0, 7);
            cloud.extend(cloud.clone());
            cloud.extend(far);
            let reversed: Vec<_> = cloud.iter().rev().copied().collect();
            let order = |p| points(&grid(p, &Radii::Uniform(1.1), 1.1));
            assert_eq!(order(cloud), order(reversed));
        }
    }

    #[test]
    fn an_outlier_leaves_the_order_of_the_others() {
        let cloud = random_cloud::<3>(2000, 10.0, 7);
        let mut with_outliers = cloud.clone();
        with_outliers.extend([[1e12, 1e14, 2e14], [-1e14, 3e13, -1e14]]);
        let mut order = points(&grid(with_outliers, &Radii::Uniform(1.1), 1.1));
        order.retain(|p| p[0].abs() < 100.0);
        assert_eq!(order, points(&grid(cloud, &Radii::Uniform(1.1), 1.1)));
    }

    #[test]
    fn the_lattice_takes_the_nearest_point() {
        let mut random = Random::new(10);
        for size in [1e-6, 1.0, 1e3, LARGEST_ON_LATTICE] {
            for _ in 0..1000 {
                let x = size * (2.0 * random.uniform() - 1.0);
                assert_eq!(snapped([x]), [(x / LATTICE).round_ties_even() * LATTICE]);
            }
        }
    }

    #[test]
    fn samples_are_all_in_the_groups() {
        let grid = grid(random_cloud::<3>(5000, 10.0, 8), &Radii::Uniform(0.7), 0.7);
        let mut order = grid.groups().order.clone();
        order.sort_unstable();
        assert!(order.len() == 5000 && order.iter().enumerate().all(|(i, &o)| i == o as usize));
    }
}
