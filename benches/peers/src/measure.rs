//! Checks the answers of peers, and times them.

use crate::peer::{Answer, Entry, Trial};
use crate::rays::RaySet;
use serde::Serialize;
use std::time::Instant;

/// Speed and differences of one entry for one kind of rays.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Outcome {
    /// Million rays per second in the best round.
    pub(crate) best: f64,
    /// Million rays per second in the median round.
    pub(crate) median: f64,
    pub(crate) differences: Differences,
}

/// The numbers of rays whose answers differ from this library's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub(crate) struct Differences {
    /// The peer misses a hit.
    pub(crate) missed: usize,
    /// The peer reports a hit where there is none.
    pub(crate) invented: usize,
    /// The peer hits another triangle, at a different `t`.
    pub(crate) elsewhere: usize,
}

/// Largest relative difference in `t` of hits that count as equal.
const TOLERANCE: f64 = 1e-4;

impl Differences {
    fn between(expected: &[Answer], answers: &[Answer]) -> Self {
        assert_eq!(expected.len(), answers.len(), "every ray is answered");
        let mut differences = Self::default();
        for pair in expected.iter().zip(answers) {
            match pair {
                (Answer::Miss, Answer::Miss) => {}
                (_, Answer::Miss) => differences.missed += 1,
                (Answer::Miss, _) => differences.invented += 1,
                (Answer::At { t, triangle }, Answer::At { t: other_t, triangle: other }) => {
                    let apart = (t - other_t).abs() > TOLERANCE * t;
                    differences.elsewhere += usize::from(triangle != other && apart);
                }
                _ => {}
            }
        }
        differences
    }
}

/// Traces `rays` with every entry: once for the answers, then `rounds` timed rounds. The entries take turns,
/// so that other load on the machine affects all equally.
///
/// # Panics
/// If two of this library's structures differ by a bit.
pub(crate) fn measure(entries: &[Entry], rays: &RaySet, rounds: usize, tick: impl Fn()) -> Vec<Outcome> {
    let mut trials: Vec<_> = entries.iter().map(|entry| prepare(entry, rays)).collect();
    let differences = check(entries, &mut trials, &rays.name);
    let mut seconds = vec![Vec::with_capacity(rounds); trials.len()];
    for _ in 0..rounds {
        for (trial, seconds) in trials.iter_mut().zip(&mut seconds) {
            seconds.push(timed(|| trial.trace()).1);
            tick();
        }
    }
    let million = rays.len() as f64 / 1e6;
    let outcome = |(mut seconds, differences): (Vec<f64>, _)| {
        seconds.sort_by(f64::total_cmp);
        Outcome { best: million / seconds[0], median: million / seconds[seconds.len() / 2], differences }
    };
    seconds.into_iter().zip(differences).map(outcome).collect()
}

fn prepare<'a>(entry: &'a Entry, rays: &RaySet) -> Box<dyn Trial + 'a> {
    if rays.is_any_hit { entry.peer.any(rays) } else { entry.peer.closest(rays) }
}

/// The differences of each entry's answers from the first entry's.
fn check(entries: &[Entry], trials: &mut [Box<dyn Trial + '_>], set: &str) -> Vec<Differences> {
    let mut expected = None;
    let compare = |(entry, trial): (&Entry, &mut Box<dyn Trial + '_>)| {
        trial.trace();
        let answers = trial.answers();
        let expected = expected.get_or_insert_with(|| answers.clone());
        let equal = !entry.family.is_ours() || *expected == answers;
        assert!(
            equal,
            "{}, {}: the answers to {set} rays differ from the first structure's",
            entry.structure, entry.mode
        );
        Differences::between(expected, &answers)
    };
    entries.iter().zip(trials).map(compare).collect()
}

/// The result of `work`, and its duration in seconds.
pub(crate) fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = work();
    (result, start.elapsed().as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_counted_by_kind_and_ties_are_not_counted() {
        let at = |triangle, t| Answer::At { t, triangle };
        let expected = [Answer::Miss, at(1, 2.0), at(1, 2.0), at(1, 2.0), at(1, 2.0), Answer::Miss];
        let answers = [Answer::Miss, at(2, 2.0001), at(1, 2.1), at(2, 2.1), Answer::Miss, at(1, 1.0)];
        let differences = Differences { missed: 1, invented: 1, elsewhere: 1 };
        assert_eq!(Differences::between(&expected, &answers), differences);
    }
}
