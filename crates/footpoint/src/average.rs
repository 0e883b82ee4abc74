//! Weighted averages of what the samples carry: colours, temperatures, times (the a(x) of SPEC § 1, of any column).

use crate::neighbours::Neighbours;
use crate::run::{Cancelled, Run};
use crate::surface::{Running, Surface};
use crate::weight::{Kernel, with_kernel};

impl<const D: usize> Surface<D> {
    /// Σθ_i v_i/Σθ_i at every point, with the weights of the surface (factors included); `values` has a row for each sample.
    ///
    /// Rows that are not finite, or missing at the end, do not take part. NaN where no other sample has weight.
    pub fn average<const N: usize>(&self, points: &[[f64; D]], values: &[[f64; N]]) -> Vec<[f64; N]> {
        let run = Run::new();
        // A run without a flag is never cancelled.
        self.with(&run).average(points, values).unwrap_or_default()
    }
}

impl<const D: usize> Running<'_, D> {
    /// [`Surface::average`].
    pub fn average<const N: usize>(
        &self,
        points: &[[f64; D]],
        values: &[[f64; N]],
    ) -> Result<Vec<[f64; N]>, Cancelled> {
        let Surface { cloud, definition, grid, .. } = self.surface;
        let weight = definition.weight();
        let reach = weight.reach();
        let near = Neighbours::new(cloud, grid, reach);
        let inverse = 1.0 / grid.unit;
        self.run.map(points.len(), |i| {
            let at = points[i].map(|c| c * inverse);
            let (mut sum, mut total, mut found) = ([0.0; N], 0.0, Vec::new());
            if grid.holds(at) {
                near.gather(at, at, &mut found);
            }
            for sample in found {
                let row = grid.original()[sample.place] as usize;
                let Some(value) = values.get(row).filter(|v| v.iter().all(|c| c.is_finite())) else {
                    continue;
                };
                let h = sample.reach / reach;
                let squared: f64 = (0..D).map(|k| (sample.point[k] - at[k]).powi(2)).sum();
                let closeness = squared / (h * h);
                let theta = with_kernel!(weight, kernel => kernel.theta(kernel.closeness(closeness)))
                    * cloud.factors().map_or(1.0, |factors| factors[row]);
                total += theta;
                for k in 0..N {
                    sum[k] += theta * value[k];
                }
            }
            if total > 0.0 { sum.map(|s| s / total) } else { [f64::NAN; N] }
        })
    }
}
