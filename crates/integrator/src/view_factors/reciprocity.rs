use super::factors::{Factor, Target, ViewFactors};
use super::row::{Entry, Row, pairs};
use rayon::prelude::*;

/// View factors estimated from both directions, by the reciprocity relation `A_i F_ij = A_j F_ji`.
///
/// Of patches with the same number of rays, `A_j / (A_i + A_j) (F_ij + F_ji)` is the combination of least variance
/// where factors are small. It keeps reciprocity up to rounding, and halves the variance between equal areas. **Row
/// sums are no longer 1**, but 1 with an error ([`Reciprocity::row_sum`]): the factors to the surroundings and to
/// backs, which have no opposite direction, stay as they are.
#[derive(Clone, Debug)]
pub struct Reciprocity<'a> {
    factors: &'a ViewFactors,
    /// In row `j` and column `i`, what the factors have in row `i` and column `j`.
    transposed: Vec<Row>,
}

impl<'a> Reciprocity<'a> {
    /// `factors` together with those of the opposite direction.
    pub fn of(factors: &'a ViewFactors) -> Self {
        let mut columns = vec![(Row::default(), 0); factors.rows.len()];
        for (row, column) in factors.rows.iter().zip(0..) {
            for entry in row.entries() {
                if let Some((transposed, next)) = columns.get_mut(entry.column as usize) {
                    transposed.push(next, Entry { column, ..entry });
                }
            }
        }
        Self { factors, transposed: columns.into_iter().map(|(row, _)| row).collect() }
    }

    /// The combined view factors of a patch to all targets between which a ray was counted in either direction, in
    /// ascending order; `hits` are those of both. Values may be above 1 by chance.
    ///
    /// # Panics
    /// If `patch` is not below [`ViewFactors::patches`].
    pub fn row(&self, patch: u32) -> impl Iterator<Item = (Target, Factor)> + '_ {
        let factors = self.factors;
        self.pairs(patch).map(move |(column, [there, back])| {
            let target = factors.target(column);
            let (weight, hits, variance) = match target {
                // Both directions of a patch to itself are the same rays.
                Target::Patch(other) if other != patch => {
                    let [own, other] = [patch, other].map(|patch| factors.area(patch));
                    let variance = factors.variance(there) + factors.variance(back);
                    (other / (own + other), there.hits + back.hits, variance)
                }
                _ => (1.0, there.hits, factors.variance(there)),
            };
            (target, Factor { hits, value: weight * factors.value(hits), std_err: weight * variance.sqrt() })
        })
    }

    /// The sum of a row; its distance from 1 is an error of the factors.
    ///
    /// # Panics
    /// If `patch` is not below [`ViewFactors::patches`].
    pub fn row_sum(&self, patch: u32) -> f64 {
        self.row(patch).map(|(_, factor)| factor.value).sum()
    }

    /// The largest distance of a row sum from 1.
    pub fn largest_row_error(&self) -> f64 {
        let error = |patch| (self.row_sum(patch) - 1.0).abs();
        (0..self.factors.patches()).into_par_iter().map(error).reduce(|| 0.0, f64::max)
    }

    /// The largest `|A_i F_ij - A_j F_ji|` of all pairs, in the standard errors that the difference would have if
    /// rays were independent and both sides had the combined view factor; 0 if all are equal.
    ///
    /// Stratified rays have smaller errors, the more so the larger the factor. For a pair of few hits this is the
    /// score test, which holds for any number of them.
    pub fn largest_z(&self) -> f64 {
        let of_row = |patch| self.pairs(patch).map(|pair| self.z(patch, pair)).fold(0.0, f64::max);
        (0..self.factors.patches()).into_par_iter().map(of_row).reduce(|| 0.0, f64::max)
    }

    fn pairs(&self, patch: u32) -> impl Iterator<Item = (u32, [Entry; 2])> + '_ {
        pairs(&self.factors.rows[patch as usize], &self.transposed[patch as usize])
    }

    fn z(&self, patch: u32, (column, pair): (u32, [Entry; 2])) -> f64 {
        let factors = self.factors;
        if column >= factors.patches() {
            return 0.0;
        }
        let areas = [patch, column].map(|patch| factors.area(patch));
        let [own, other] = [0, 1].map(|i| areas[i] * factors.value(pair[i].hits));
        let rays = factors.rays() as f64;
        let combined = factors.value(pair[0].hits + pair[1].hits) / (1.0 / areas[0] + 1.0 / areas[1]);
        let variance = |area: f64| {
            let value = (combined / area).min(1.0);
            area * area * value * (1.0 - value) / rays
        };
        let difference = (own - other).abs();
        if difference == 0.0 { 0.0 } else { difference / (variance(areas[0]) + variance(areas[1])).sqrt() }
    }
}
