//! Round numbers along a logarithmic axis.

use std::ops::Range;

/// The largest number of ticks.
const MAX_TICKS: usize = 10;

/// 1, 2 and 5 times powers of ten within `range`, or fewer per decade if the range is wide.
pub(crate) fn ticks(range: &Range<f64>) -> Vec<f64> {
    let decades = range.start.log10().floor() as i32..=range.end.log10().ceil() as i32;
    let of = |steps: &[f64], every: i32| -> Vec<f64> {
        let decades = decades.clone().filter(|decade| decade % every == 0);
        let ticks = decades.flat_map(|decade| steps.iter().map(move |step| step * 10_f64.powi(decade)));
        ticks.filter(|tick| range.contains(tick)).collect()
    };
    let coarser = (1..).map(|every| of(&[1.0], every));
    let all = [of(&[1.0, 2.0, 5.0], 1), of(&[1.0, 3.0], 1)].into_iter().chain(coarser);
    all.into_iter().find(|ticks| ticks.len() <= MAX_TICKS).unwrap_or_default()
}

/// A number without trailing zeros, rounded to integers from 1 on and to six decimals below.
pub(crate) fn short(x: f64) -> String {
    if x >= 0.999 { format!("{x:.0}") } else { format!("{x:.6}").trim_end_matches('0').to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_several_ticks_but_not_many() {
        for (range, expected) in [
            (0.003..0.6, &["0.005", "0.01", "0.02", "0.05", "0.1", "0.2", "0.5"][..]),
            (1.0..40.0, &["1", "2", "5", "10", "20"]),
            (0.001..30.0, &["0.001", "0.003", "0.01", "0.03", "0.1", "0.3", "1", "3", "10"]),
        ] {
            let found: Vec<String> = ticks(&range).into_iter().map(short).collect();
            assert_eq!(found, expected, "{range:?}");
        }
        assert!((3..=MAX_TICKS).contains(&ticks(&(1e-12..1e12)).len()));
    }
}
