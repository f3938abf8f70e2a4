/// Samples an index with probability proportional to its weight, in constant time (Walker 1974, built
/// by the method of Vose 1991).
#[derive(Clone, Debug)]
pub(crate) struct AliasTable {
    columns: Vec<Column>,
}

/// One of `n` equally likely columns: its own index below `threshold`, and `alias` above.
#[derive(Clone, Copy, Debug)]
struct Column {
    threshold: f64,
    alias: u32,
}

impl AliasTable {
    /// A table of `weights`, which are finite and above zero.
    pub(crate) fn new(weights: &[f64]) -> Self {
        let scale = weights.len() as f64 / weights.iter().sum::<f64>();
        let mut columns: Vec<Column> =
            (0..).zip(weights).map(|(alias, weight)| Column { threshold: weight * scale, alias }).collect();
        let indices = 0..weights.len();
        let (mut small, mut large): (Vec<_>, Vec<_>) = indices.partition(|&i| columns[i].threshold < 1.0);
        while let (Some(poor), Some(&rich)) = (small.pop(), large.last()) {
            columns[poor].alias = rich as u32;
            // The rich column fills up the poor one.
            columns[rich].threshold -= 1.0 - columns[poor].threshold;
            if columns[rich].threshold < 1.0 {
                large.pop();
                small.push(rich);
            }
        }
        Self { columns }
    }

    /// The index for `u` in `[0, 1)`; `None` for an empty table.
    #[inline(always)]
    pub(crate) fn sample(&self, u: f64) -> Option<usize> {
        let (index, in_column) = self.column(u)?;
        let Column { threshold, alias } = self.columns[index];
        Some(if in_column < threshold { index } else { alias as usize })
    }

    /// The same index, and `u` remapped to another number uniform in `[0, 1)`.
    pub(crate) fn sample_remapped(&self, u: f64) -> Option<(usize, f64)> {
        let (sampled, (index, in_column)) = (self.sample(u)?, self.column(u)?);
        let threshold = self.columns[index].threshold.min(1.0);
        let rest = match in_column < threshold {
            true => in_column / threshold,
            false => (in_column - threshold) / (1.0 - threshold),
        };
        // Where the product rounds up to the number of columns, it may be 1, or NaN if the last one is full.
        Some((sampled, rest.min(1.0_f64.next_down())))
    }

    /// The column for `u`, and where in it.
    #[inline(always)]
    fn column(&self, u: f64) -> Option<(usize, f64)> {
        let scaled = u * self.columns.len() as f64;
        // The product may round up to the number of columns.
        let index = (scaled as usize).min(self.columns.len().checked_sub(1)?);
        Some((index, scaled - index as f64))
    }
}

/// The least weight that [`raised`] leaves, in units of the mean of all weights.
const MIN_SHARE: f64 = 1.0 / 64.0;

/// The weights with those far below the mean raised to [`MIN_SHARE`] of it, and all others unchanged.
///
/// A weight that says nothing of visibility may be as good as zero for the only light of a room. What is raised takes
/// less than `MIN_SHARE` of all samples. Probabilities are then far above the spacing of random numbers, so a table draws
/// each index with its weight over the sum of all, to rounding.
pub(super) fn raised(weights: Vec<f64>) -> Vec<f64> {
    let least = MIN_SHARE * weights.iter().sum::<f64>() / weights.len() as f64;
    weights.into_iter().map(|weight| weight.max(least)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of evenly spaced numbers, those that sample one index leave evenly spaced numbers.
    #[test]
    fn what_is_left_of_a_number_is_uniform() {
        let table = AliasTable::new(&[1.0, 3.0, 0.5, 3.5]);
        let mut rests = [const { Vec::new() }; 4];
        for i in 0..4096 {
            let u = (f64::from(i) + 0.5) / 4096.0;
            let (index, rest) = table.sample_remapped(u).unwrap();
            assert_eq!(table.sample(u), Some(index));
            rests[index].push(rest);
        }
        for rests in &mut rests {
            rests.sort_by(f64::total_cmp);
            let n = rests.len() as f64;
            // An index may have several columns, each with evenly spaced numbers of its own.
            assert!(rests.iter().zip(0..).all(|(rest, i)| (rest - (f64::from(i) + 0.5) / n).abs() < 4.0 / n));
        }
    }

    /// The probability that a table draws each index, exactly: the lengths of its intervals.
    fn drawn(table: &AliasTable) -> Vec<f64> {
        let mut probs = vec![0.0; table.columns.len()];
        for (index, column) in table.columns.iter().enumerate() {
            let own = column.threshold.min(1.0);
            probs[index] += own / table.columns.len() as f64;
            probs[column.alias as usize] += (1.0 - own) / table.columns.len() as f64;
        }
        probs
    }

    /// Over thirty orders of magnitude. A weight of at least a 64th of the mean stays as it is.
    #[test]
    fn raised_weights_are_drawn_as_often_as_they_say() {
        for n in [1, 2, 5, 7, 100] {
            let weights: Vec<_> = (0..n).map(|i| 10.0_f64.powi(30 * i / n - 15)).collect();
            let mean = weights.iter().sum::<f64>() / f64::from(n);
            let raised = raised(weights.clone());
            let total: f64 = raised.iter().sum();
            assert!(total < mean * f64::from(n) * (1.0 + MIN_SHARE), "{n}: {total}");
            for (i, drawn) in drawn(&AliasTable::new(&raised)).into_iter().enumerate() {
                assert_eq!(
                    raised[i],
                    if weights[i] < mean / 64.0 { mean / 64.0 } else { weights[i] },
                    "{n}: {i}"
                );
                assert!((drawn / (raised[i] / total) - 1.0).abs() < 1e-11, "{n}: {i}, {drawn}");
                assert!(drawn * f64::from(n) > 0.015, "{n}: {i}, {drawn}");
            }
        }
        assert!(raised(Vec::new()).is_empty());
    }

    #[test]
    fn the_ends_of_the_interval_are_ordinary() {
        let table = AliasTable::new(&[1.0, 3.0]);
        for (u, expected) in [(0.0, 0.0..0.1), (1.0_f64.next_down(), 0.9..1.0)] {
            assert!(table.sample(u).is_some());
            assert!(expected.contains(&table.sample_remapped(u).unwrap().1));
        }
        assert_eq!(AliasTable::new(&[]).sample(0.5), None);
    }
}
