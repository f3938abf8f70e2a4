use super::row::{Entry, Row};
use crate::Ending;
use crate::film::student::{NORMAL_QUANTILE_975, quantile_975};
use rayon::prelude::*;

/// Where a ray from a patch arrives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Target {
    /// The radiating side of this patch.
    Patch(u32),
    /// No triangle.
    Surroundings,
    /// The back of a triangle that radiates from its front only.
    Back,
}

/// A view factor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Factor {
    /// The rays that were counted for it.
    pub hits: u64,
    /// The view factor, in `[0, 1]`; 0 before the first pass. Of both directions together
    /// ([`Reciprocity`](super::Reciprocity)) it may be above 1 by chance.
    pub value: f64,
    /// Its standard error; infinite before there are two passes.
    pub std_err: f64,
}

/// How well the view factors of at least some value are known.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FactorAccuracy {
    /// The number of these factors, of all rows and targets.
    pub count: u64,
    /// The root of the mean of their squared standard errors over their mean; infinite if there are none, and
    /// before there are two passes.
    pub relative_rmse: f64,
    /// The root of the mean square of their relative standard errors, infinite like `relative_rmse`. Dominated by the
    /// smallest of them.
    pub rms_of_relative: f64,
    /// The largest standard error; 0 if there are none.
    pub largest_std_err: f64,
}

/// The view factors between patches, and to the surroundings, as counts of rays.
///
/// All rows have the same number of rays. The factors of a row add up to 1 exactly, since each ray is counted once.
///
/// Rays of a pass are stratified, and passes are independent of each other: errors are estimated from their spread.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewFactors {
    pub(super) areas: Vec<f64>,
    pub(super) rows: Vec<Row>,
    pub(super) passes: u32,
    pub(super) pass_rays: u32,
    pub(super) key: u64,
    pub(super) ending: Ending,
}

impl ViewFactors {
    pub(super) fn new(areas: Vec<f64>, pass_rays: u32, key: u64) -> Self {
        let rows = vec![Row::default(); areas.len()];
        Self { areas, rows, passes: 0, pass_rays, key, ending: Ending::Open }
    }

    pub(super) fn add_pass(&mut self, rows: &[Row]) {
        self.rows.par_iter_mut().zip(rows).for_each(|(row, added)| *row = row.merged(added));
        self.passes += 1;
    }

    /// The number of patches.
    pub fn patches(&self) -> u32 {
        self.areas.len() as u32
    }

    /// The radiating area of a patch, in squared units of length.
    ///
    /// # Panics
    /// If `patch` is not below [`ViewFactors::patches`].
    pub fn area(&self, patch: u32) -> f64 {
        self.areas[patch as usize]
    }

    /// The number of passes.
    pub fn passes(&self) -> u32 {
        self.passes
    }

    /// Rays of each patch.
    pub fn rays(&self) -> u64 {
        u64::from(self.passes) * u64::from(self.pass_rays)
    }

    /// A hash of what determines the factors but for the number of passes: triangles, patches, settings and the sources of
    /// the library, as [`Render::key`](crate::Render::key) of a picture.
    pub fn key(&self) -> u64 {
        self.key
    }

    /// Memory of the counts in bytes, which is about the length of a checkpoint.
    pub fn bytes(&self) -> usize {
        self.rows.iter().map(|row| row.bytes().len() + size_of::<Row>()).sum()
    }

    /// Why no more rays were traced.
    pub fn ending(&self) -> Ending {
        self.ending
    }

    /// The view factors of a patch to all targets that a ray has hit, in ascending order.
    ///
    /// # Panics
    /// If `patch` is not below [`ViewFactors::patches`].
    pub fn row(&self, patch: u32) -> impl Iterator<Item = (Target, Factor)> + '_ {
        self.rows[patch as usize].entries().map(|entry| (self.target(entry.column), self.factor_of(entry)))
    }

    /// The view factor of a patch to `target`; 0 if no ray has hit it. Takes time in proportion to the row.
    ///
    /// # Panics
    /// If `patch`, or the patch of `target`, is not below [`ViewFactors::patches`].
    pub fn factor(&self, patch: u32, target: Target) -> Factor {
        self.factor_of(self.entry(patch, target))
    }

    /// The interval that holds the view factor with a probability of 95 %.
    ///
    /// It is that of Student's distribution. Where less than one ray of a pass hits the target, or misses it, in the
    /// mean, it is that of independent rays (Wilson 1927; Brown, Cai and DasGupta 2001), which few hits nearly are,
    /// and which has an upper end for none.
    ///
    /// # Panics
    /// If `patch`, or the patch of `target`, is not below [`ViewFactors::patches`].
    pub fn interval_95(&self, patch: u32, target: Target) -> [f64; 2] {
        self.interval_of(self.entry(patch, target))
    }

    fn interval_of(&self, entry: Entry) -> [f64; 2] {
        let (value, rays) = (self.value(entry.hits), self.rays() as f64);
        let [center, margin] = if self.is_rare(entry.hits) {
            /// The squared normal quantile.
            const Z_SQ: f64 = NORMAL_QUANTILE_975 * NORMAL_QUANTILE_975;
            let scale = 1.0 / (rays + Z_SQ);
            let spread = Z_SQ * (rays * value * (1.0 - value) + Z_SQ / 4.0);
            [(rays * value + Z_SQ / 2.0) * scale, spread.sqrt() * scale]
        } else {
            [value, quantile_975(u64::from(self.passes.saturating_sub(1))) * self.variance(entry).sqrt()]
        };
        [(center - margin).max(0.0), (center + margin).min(1.0)]
    }

    /// The largest upper end of the intervals of all factors, that of a target without hits among them.
    pub(super) fn largest_upper_end(&self) -> f64 {
        let upper_end = |entry| self.interval_of(entry)[1];
        let none = upper_end(Entry { column: 0, hits: 0, squares: 0 });
        let of_row = |row: &Row| row.entries().map(upper_end).fold(none, f64::max);
        self.rows.par_iter().map(of_row).reduce(|| none, f64::max)
    }

    /// The accuracy of the factors of at least `least`, in all rows, to patches, their backs and the surroundings.
    pub fn accuracy(&self, least: f64) -> FactorAccuracy {
        // Rows are summed in parallel, but put together in order, so that no bit depends on the threads.
        let sums = |row: &Row| {
            let factors = row.entries().map(|entry| self.factor_of(entry)).filter(|f| f.value >= least);
            factors.fold([0.0; 5], |sums, Factor { value, std_err, .. }| {
                let variance = std_err * std_err;
                let added = [1.0, value, variance, variance / (value * value)];
                let [count, mean, squared, relative] = std::array::from_fn(|i| sums[i] + added[i]);
                [count, mean, squared, relative, f64::max(sums[4], std_err)]
            })
        };
        let rows: Vec<[f64; 5]> = self.rows.par_iter().map(sums).collect();
        let [count, mean, squared, relative, largest_std_err] = rows.into_iter().fold([0.0; 5], |a, b| {
            [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], f64::max(a[4], b[4])]
        });
        let or_infinite = |x: f64| if count > 0.0 { x } else { f64::INFINITY };
        FactorAccuracy {
            count: count as u64,
            relative_rmse: or_infinite((squared * count).sqrt() / mean),
            rms_of_relative: or_infinite((relative / count).sqrt()),
            largest_std_err,
        }
    }

    pub(super) fn target(&self, column: u32) -> Target {
        match column.checked_sub(self.patches()) {
            None => Target::Patch(column),
            Some(0) => Target::Surroundings,
            Some(_) => Target::Back,
        }
    }

    fn entry(&self, patch: u32, target: Target) -> Entry {
        let column = match target {
            Target::Patch(patch) => {
                assert!(patch < self.patches(), "patch {patch} of {}", self.patches());
                patch
            }
            Target::Surroundings => self.patches(),
            Target::Back => self.patches() + 1,
        };
        let found = self.rows[patch as usize].entries().find(|entry| entry.column == column);
        found.unwrap_or(Entry { column, hits: 0, squares: 0 })
    }

    fn factor_of(&self, entry: Entry) -> Factor {
        Factor { hits: entry.hits, value: self.value(entry.hits), std_err: self.variance(entry).sqrt() }
    }

    pub(super) fn value(&self, hits: u64) -> f64 {
        // No ray was counted before the first pass.
        hits as f64 / self.rays().max(1) as f64
    }

    /// Whether passes have too few hits, or misses, for their spread to say much.
    pub(super) fn is_rare(&self, hits: u64) -> bool {
        hits.min(self.rays() - hits) < u64::from(self.passes)
    }

    /// The squared standard error, from the spread of the passes; infinite for fewer than two.
    pub(super) fn variance(&self, entry: Entry) -> f64 {
        let (passes, hits) = (u128::from(self.passes), u128::from(entry.hits));
        if passes < 2 {
            return f64::INFINITY;
        }
        let spread = passes * u128::from(entry.squares) - hits * hits;
        spread as f64 / (passes - 1) as f64 / (self.rays() as f64).powi(2)
    }
}
