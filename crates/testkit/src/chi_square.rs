//! Whether counts agree with their expectations, at the suite's risk of false alarm.

use crate::stats::Z_LIMIT;

/// Counts in cells, beside what is expected of them.
#[derive(Clone, Debug, Default)]
pub struct ChiSquare {
    statistic: f64,
    cells: f64,
}

impl ChiSquare {
    /// Counts over cells of equal probability.
    pub fn of_equal_cells(counts: &[u64]) -> Self {
        let share = counts.iter().sum::<u64>() as f64 / counts.len() as f64;
        Self::of(counts.iter().map(|&count| (count, share)))
    }

    /// Pairs of a count and its expectation; cells are pooled, in order, until at least 5 are
    /// expected in each.
    pub fn of(cells: impl IntoIterator<Item = (u64, f64)>) -> Self {
        let (mut this, mut pool) = (Self::default(), (0.0, 0.0));
        for (count, expected) in cells {
            pool = (pool.0 + count as f64, pool.1 + expected);
            if pool.1 >= 5.0 {
                this.statistic += (pool.0 - pool.1).powi(2) / pool.1;
                this.cells += 1.0;
                pool = (0.0, 0.0);
            }
        }
        this
    }

    /// The standard normal equivalent (Wilson and Hilferty 1931).
    pub fn z(&self) -> f64 {
        let dof = self.cells - 1.0;
        let spread = 2.0 / (9.0 * dof);
        ((self.statistic / dof).cbrt() - (1.0 - spread)) / spread.sqrt()
    }

    /// Asserts that the counts are neither too far from their expectations nor too near.
    ///
    /// # Panics
    /// If they are, naming `what`.
    pub fn assert_fits(&self, what: &str) {
        assert!(self.cells >= 2.0, "{what}: fewer than two cells");
        assert!(self.z().abs() < Z_LIMIT, "{what}: {self:?}, z = {}", self.z());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // 95 % quantiles for 63 and 255 degrees of freedom.
        for (statistic, cells) in [(82.529, 64.0), (293.248, 256.0)] {
            let z = ChiSquare { statistic, cells }.z();
            assert!((z - 1.645).abs() < 0.005, "{z}");
        }
    }

    #[test]
    fn rare_cells_are_pooled() {
        let pooled = ChiSquare::of([(1, 2.0), (4, 3.0), (9, 10.0), (1, 1.0)]);
        assert_eq!((pooled.cells, pooled.statistic), (2.0, 0.1));
    }
}
