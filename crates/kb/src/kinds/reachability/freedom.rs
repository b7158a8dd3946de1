//! Values for the free joints of a redundant arm.

/// Values of the free joints: a row for each try. An arm without free joints has one row of no values.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeValues {
    width: usize,
    rows: usize,
    values: Vec<f64>,
}

impl FreeValues {
    /// All combinations of `samples` evenly spaced values of each range.
    pub(super) fn evenly(ranges: &[(f64, f64)], samples: usize) -> Self {
        let (width, rows) = (ranges.len(), samples.pow(ranges.len() as u32));
        let mut values = Vec::with_capacity(rows * width);
        for row in 0..rows {
            // The last joint runs fastest.
            let mut stride = rows;
            for &(low, high) in ranges {
                stride /= samples;
                let k = row / stride % samples;
                values.push(low + (high - low) * (k as f64 + 0.5) / samples as f64);
            }
        }
        Self { width, rows, values }
    }

    /// As many rows: these values first, and then all but the farthest in the order of their distance from them, in shares of
    /// the ranges.
    pub(super) fn from(self, first: &[f64], ranges: &[(f64, f64)]) -> Self {
        let away = |row: &[f64]| -> f64 {
            let axes = row.iter().zip(first).zip(ranges);
            axes.map(|((a, b), (low, high))| ((a - b) / (high - low)).abs()).sum()
        };
        let mut order: Vec<(f64, usize)> = (0..self.rows).map(|i| (away(self.row(i)), i)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        order.pop();
        let mut values = Vec::with_capacity(self.values.len());
        values.extend_from_slice(first);
        order.iter().for_each(|&(_, i)| values.extend(self.row(i)));
        Self { width: self.width, rows: self.rows, values }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows
    }

    /// Whether there is nothing to try.
    pub fn is_empty(&self) -> bool {
        self.rows == 0
    }

    /// Number of free joints.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The values of one try.
    pub fn row(&self, index: usize) -> &[f64] {
        &self.values[index * self.width..][..self.width]
    }
}

/// Number of bins of each free joint, so that a byte tells them all.
fn bins(joints: usize) -> usize {
    (1..=256).rev().find(|bins: &usize| bins.saturating_pow(joints as u32) <= 256).unwrap_or(1)
}

/// A byte for values of the free joints.
#[cfg(feature = "build")]
pub(super) fn byte_of(values: &[f64], ranges: &[(f64, f64)]) -> u8 {
    let bins = bins(ranges.len());
    let bin = |(value, (low, high)): (&f64, &(f64, f64))| {
        let share = (value - low) / (high - low);
        ((share * bins as f64) as usize).min(bins - 1)
    };
    values.iter().zip(ranges).map(bin).fold(0, |byte, bin| byte * bins + bin) as u8
}

/// The values in the middle of what a byte stands for.
pub(super) fn values_of(byte: u8, ranges: &[(f64, f64)]) -> Vec<f64> {
    let bins = bins(ranges.len());
    let mut rest = usize::from(byte);
    let mut values = vec![0.0; ranges.len()];
    for (value, (low, high)) in values.iter_mut().zip(ranges).rev() {
        *value = low + (high - low) * ((rest % bins) as f64 + 0.5) / bins as f64;
        rest /= bins;
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_all_combinations_and_come_by_distance() {
        let ranges = [(0.0, 4.0), (10.0, 14.0)];
        let rows = FreeValues::evenly(&ranges, 2);
        assert_eq!((rows.len(), rows.width()), (4, 2));
        assert_eq!((rows.row(0), rows.row(3)), (&[1.0, 11.0][..], &[3.0, 13.0][..]));
        let rows = rows.from(&[2.5, 12.9], &ranges);
        let all: Vec<&[f64]> = (0..rows.len()).map(|i| rows.row(i)).collect();
        assert_eq!(all, [[2.5, 12.9], [3.0, 13.0], [1.0, 13.0], [3.0, 11.0]]);
        let none = FreeValues::evenly(&[], 8);
        assert_eq!((none.len(), none.row(0)), (1, &[][..]));
    }

    #[test]
    fn a_byte_keeps_values_to_half_a_bin() {
        let all = [(-1.0, 2.0), (3.0, 3.5), (0.0, 10.0)];
        for joints in 0..=3 {
            let (ranges, width) = (&all[..joints], 0.5 / bins(joints) as f64);
            for k in 0..=100 {
                let share = f64::from(k) / 100.0;
                let values: Vec<f64> = ranges.iter().map(|(low, high)| low + (high - low) * share).collect();
                let found = values_of(byte_of(&values, ranges), ranges);
                for ((a, b), (low, high)) in found.iter().zip(&values).zip(ranges) {
                    assert!((a - b).abs() <= (width + 1e-9) * (high - low), "{a} {b}");
                }
            }
        }
    }
}
