//! Occupied cells of one level: rows along the first axis, found through a table or by bisection.

use std::ops::Range;

/// The occupied cells.
#[derive(Debug)]
pub(super) struct Cells<const D: usize> {
    /// Position along the first axis, and where the cell's samples begin; one more entry ends the last.
    along: Vec<i64>,
    begins: Vec<u32>,
    rows: Rows,
    /// Range of rows in each of the other axes (the third is 0 in two dimensions).
    first_row: [i64; 2],
    last_row: [i64; 2],
}

/// Where each row's cells begin in `along`.
#[derive(Debug)]
enum Rows {
    /// One entry for every row of the bounding rectangle.
    Dense(Vec<u32>),
    /// Occupied rows only, in order: outliers can make the rectangle huge.
    Sparse { rows: Vec<[i64; 2]>, begins: Vec<u32> },
}

/// A table of rows may be this many times longer than the list of cells.
const DENSE_SHARE: usize = 4;

fn row_of<const D: usize>(cell: [i64; D]) -> [i64; 2] {
    // From the slowest axis to the faster one, so that rows compare as arrays.
    if D == 3 { [cell[D - 1], cell[1]] } else { [0, cell[1]] }
}

impl<const D: usize> Cells<D> {
    /// From the first sample of every occupied cell, in canonical order, where the last ends, and the cell of each sample.
    pub(super) fn new(mut begins: Vec<u32>, end: usize, cell: impl Fn(usize) -> [i64; D]) -> Self {
        let mut along = Vec::with_capacity(begins.len());
        let (mut rows, mut row_begins) = (Vec::new(), Vec::new());
        for &begin in &begins {
            let cell = cell(begin as usize);
            let row = row_of(cell);
            if rows.last() != Some(&row) {
                rows.push(row);
                row_begins.push(along.len() as u32);
            }
            along.push(cell[0]);
        }
        begins.push(end as u32);
        row_begins.push(along.len() as u32);

        let bound = |axis: usize| {
            let axis = rows.iter().map(|row| row[axis]);
            axis.fold((i64::MAX, i64::MIN), |(low, high), r| (low.min(r), high.max(r)))
        };
        let ((first0, last0), (first1, last1)) = (bound(0), bound(1));
        let width = (last1 - first1 + 1) as usize;
        let area = width.saturating_mul((last0 - first0 + 1) as usize);
        let rows = if area <= DENSE_SHARE * along.len() + 1024 {
            let mut table = vec![0; area + 1];
            let mut next = 0;
            for (row, &cells_begin) in rows.iter().zip(&row_begins) {
                let place = (row[0] - first0) as usize * width + (row[1] - first1) as usize;
                table[next..=place].fill(cells_begin);
                next = place + 1;
            }
            table[next..].fill(along.len() as u32);
            Rows::Dense(table)
        } else {
            Rows::Sparse { rows, begins: row_begins }
        };
        Self { along, begins, rows, first_row: [first0, first1], last_row: [last0, last1] }
    }

    /// The samples of all cells.
    pub(super) fn samples(&self) -> Range<usize> {
        self.begins[0] as usize..self.begins[self.begins.len() - 1] as usize
    }

    /// Where the samples of each cell begin, and where the last end.
    pub(super) fn begins(&self) -> &[u32] {
        &self.begins
    }

    /// Stretches of the cells between two corners, in canonical order.
    pub(super) fn visit(
        &self,
        first: [i64; D],
        last: [i64; D],
        side: f64,
        mut visit: impl FnMut(Stretch<'_, D>),
    ) {
        let (low, high) = (row_of(first), row_of(last));
        let low = [low[0].max(self.first_row[0]), low[1].max(self.first_row[1])];
        let high = [high[0].min(self.last_row[0]), high[1].min(self.last_row[1])];
        let mut in_row = |row: [i64; 2], cells: Range<u32>| {
            let cells = cells.start as usize..cells.end as usize;
            let along = &self.along[cells.clone()];
            let from = cells.start + along.partition_point(|&x| x < first[0]);
            let to = from + self.along[from..cells.end].partition_point(|&x| x <= last[0]);
            if from < to {
                visit(Stretch { along: &self.along[from..to], begins: &self.begins[from..=to], row, side });
            }
        };
        match &self.rows {
            Rows::Dense(table) => {
                let width = self.last_row[1] - self.first_row[1] + 1;
                for slow in low[0]..=high[0] {
                    for fast in low[1]..=high[1] {
                        let place =
                            ((slow - self.first_row[0]) * width + (fast - self.first_row[1])) as usize;
                        in_row([slow, fast], table[place]..table[place + 1]);
                    }
                }
            }
            Rows::Sparse { rows, begins } => {
                let mut at = rows.partition_point(|row| *row < low);
                while at < rows.len() && rows[at] <= high {
                    let row = rows[at];
                    if row[1] < low[1] {
                        at += rows[at..].partition_point(|other| *other < [row[0], low[1]]);
                    } else if row[1] > high[1] {
                        at += rows[at..].partition_point(|other| *other < [row[0] + 1, low[1]]);
                    } else {
                        in_row(row, begins[at]..begins[at + 1]);
                        at += 1;
                    }
                }
            }
        }
    }
}

/// Consecutive cells of one row.
pub(crate) struct Stretch<'c, const D: usize> {
    along: &'c [i64],
    /// One more entry than cells.
    begins: &'c [u32],
    row: [i64; 2],
    side: f64,
}

impl<const D: usize> Stretch<'_, D> {
    /// The samples of all its cells.
    pub(crate) fn samples(&self) -> Range<usize> {
        self.begins[0] as usize..self.begins[self.begins.len() - 1] as usize
    }

    /// Each cell and its samples.
    pub(super) fn indexed(&self) -> impl Iterator<Item = ([i64; D], Range<usize>)> {
        self.along.iter().zip(self.begins.windows(2)).map(|(&along, ends)| {
            let cell = std::array::from_fn(|k| [along, self.row[1], self.row[0]][k]);
            (cell, ends[0] as usize..ends[1] as usize)
        })
    }

    /// Each cell's lower corner and samples.
    pub(crate) fn cells(&self) -> impl Iterator<Item = ([f64; D], Range<usize>)> {
        self.indexed().map(|(cell, samples)| (cell.map(|c| c as f64 * self.side), samples))
    }
}
