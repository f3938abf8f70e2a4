//! Form factors of rectangles in closed form.

use std::f64::consts::TAU;

/// The form factor of a rectangle of sides `a` and `b` that is parallel to the receiver and has one corner at
/// height 1 above it. It is odd in each side, so that any rectangle is a sum of four.
pub fn corner(a: f64, b: f64) -> f64 {
    let part = |a: f64, b: f64| a / a.hypot(1.0) * (b / a.hypot(1.0)).atan();
    (part(a, b) + part(b, a)) / TAU
}

/// A span of a coordinate, from its lower to its upper end.
pub type Span = [f64; 2];

/// The form factor from the rectangle `from`, spans of x and y, to the parallel rectangle `to` at a distance of
/// `height` (Ehlert and Smith, "View factors for perpendicular and parallel rectangular plates", 1993; Howell's
/// C-13).
pub fn parallel(from: [Span; 2], to: [Span; 2], height: f64) -> f64 {
    let term = |[x, y]: [f64; 2]| {
        let part = |a: f64, b: f64| {
            let root = b.hypot(height);
            a * root * (a / root).atan()
        };
        part(x, y) + part(y, x) - 0.5 * height * height * (x * x + y * y + height * height).ln()
    };
    let mut sum = 0.0;
    for corner in 0..16 {
        let end = |bit: usize| corner >> bit & 1;
        let offset = [0, 1].map(|axis| from[axis][end(axis)] - to[axis][end(axis + 2)]);
        sum += sign(corner) * term(offset);
    }
    sum / (TAU * area(from))
}

/// The form factor from the rectangle `from` to the rectangle `to` in a perpendicular plane. Both have the same axis
/// along the line where their planes meet, which the first spans are of; the second are distances from that line
/// (Ehlert and Smith 1993; Howell's C-16).
pub fn perpendicular(from: [Span; 2], to: [Span; 2]) -> f64 {
    let term = |along: f64, x: f64, z: f64| {
        let sq = x * x + z * z;
        // Both vanish with their arguments.
        let first = if sq > 0.0 { along * sq.sqrt() * (along / sq.sqrt()).atan() } else { 0.0 };
        let all = sq + along * along;
        let second = if all > 0.0 { 0.25 * (sq - along * along) * all.ln() } else { 0.0 };
        first - second
    };
    let mut sum = 0.0;
    for corner in 0..16 {
        let end = |bit: usize| corner >> bit & 1;
        let along = from[0][end(0)] - to[0][end(2)];
        sum += sign(corner) * term(along, from[1][end(1)], to[1][end(3)]);
    }
    sum / (TAU * area(from))
}

/// -1 for an odd number of ends that are upper ones.
fn sign(corner: usize) -> f64 {
    if corner.count_ones().is_multiple_of(2) { 1.0 } else { -1.0 }
}

fn area(spans: [Span; 2]) -> f64 {
    spans.iter().map(|[lower, upper]| upper - lower).product()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_of_howells_catalogue() {
        let unit = [[0.0, 1.0]; 2];
        assert!((parallel(unit, unit, 1.0) - 0.199_824_896).abs() < 1e-9);
        assert!((perpendicular(unit, unit) - 0.200_043_776).abs() < 1e-9);
        // A small rectangle is a point.
        let small = [[0.0, 1e-3]; 2];
        assert!((parallel(small, unit, 1.0) - corner(1.0, 1.0)).abs() < 2e-4);
        // The four sides and the top of a cube add up to 1, in pieces too.
        let pieces = [[[0.0, 0.3], [0.0, 1.0]], [[0.3, 1.0], [0.0, 1.0]]];
        let walls = 4.0 * pieces.map(|piece| perpendicular(unit, piece)).iter().sum::<f64>();
        let top: f64 = pieces.map(|piece| parallel(unit, piece, 1.0)).iter().sum();
        assert!((walls + top - 1.0).abs() < 1e-12, "{walls} + {top}");
    }
}
