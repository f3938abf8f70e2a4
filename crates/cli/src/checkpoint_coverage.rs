//! Which passes of which rows a checkpoint holds.

use globillum::integrator::{CheckpointHeader, CheckpointStrip};
use std::ops::Range;

/// The share of these passes of these rows that a checkpoint holds, from 0 to 1.
pub(crate) fn share(header: &CheckpointHeader, passes: &Range<u32>, rows: &Range<u32>) -> f64 {
    let strips = header.strips.iter().map(|strip| {
        let held: u64 = strip.passes().iter().map(|range| common(range, passes)).sum();
        held * common(&strip.rows(), rows)
    });
    strips.sum::<u64>() as f64 / (passes.len() as f64 * rows.len() as f64)
}

/// Whether `header` holds all passes, rows and samples that `other` holds, a checkpoint of the same picture.
pub(crate) fn is_all_of(header: &CheckpointHeader, other: &CheckpointHeader) -> bool {
    other.strips.iter().all(|strip| {
        let held = |passes: Range<u32>| share(header, &passes, &strip.rows()) == 1.0;
        // A last pass that is cut short has fewer samples.
        let meet = header.strips.iter().filter(|own| common(&own.rows(), &strip.rows()) > 0);
        strip.passes().into_iter().all(held) && meet.into_iter().all(|own| own.samples() >= strip.samples())
    })
}

/// What a checkpoint holds, as messages say it.
pub(crate) fn describe(header: &CheckpointHeader) -> String {
    let strip = |strip: &CheckpointStrip| describe_strip(strip, header.height);
    match header.strips.as_slice() {
        [] => "no pass".into(),
        [one] => strip(one),
        [first, .., last] => format!("{} to {}", strip(first), strip(last)),
    }
}

/// The passes of a strip, and its rows unless they are all of a picture of this height.
pub(crate) fn describe_strip(strip: &CheckpointStrip, height: u32) -> String {
    let passes: Vec<String> = strip.passes().iter().map(format_range).collect();
    let of = match strip.rows() {
        rows if rows == (0..height) => String::new(),
        rows => format!(" of rows {}", format_range(&rows)),
    };
    format!("passes {}{of}", passes.join(", "))
}

/// `A..B`.
pub(crate) fn format_range(range: &Range<u32>) -> String {
    format!("{}..{}", range.start, range.end)
}

/// How many numbers both ranges hold.
fn common(a: &Range<u32>, b: &Range<u32>) -> u64 {
    a.end.min(b.end).saturating_sub(a.start.max(b.start)).into()
}
