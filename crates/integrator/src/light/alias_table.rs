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
        let scaled = u * self.columns.len() as f64;
        // The product may round up to the number of columns.
        let index = (scaled as usize).min(self.columns.len().checked_sub(1)?);
        let Column { threshold, alias } = self.columns[index];
        Some(if scaled - (index as f64) < threshold { index } else { alias as usize })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_the_interval_are_ordinary() {
        let table = AliasTable::new(&[1.0, 3.0]);
        assert!(table.sample(0.0).is_some() && table.sample(1.0_f64.next_down()).is_some());
        assert_eq!(AliasTable::new(&[]).sample(0.5), None);
    }
}
