//! Deviates of differences.

use super::normal;
use super::side::Cell;
use crate::pixel_rect::PixelRect;
use globillum_material::Rgb;

/// The deviates of the differences of two sides, of `width` cells in each row.
pub(super) fn deviates([a, b]: [&[Cell]; 2], width: u32) -> Vec<Rgb> {
    let cells = PixelRect::whole([width, (a.len() / width as usize) as u32]);
    let of_cell = |at: (u32, u32)| {
        let near = PixelRect::pixels_near(at, cells.width, cells.height).filter(|&other| other != at);
        let mut around = [Rgb::BLACK; 2];
        for place in near.map(|(x, y)| cells.index(x, y)) {
            around = [around[0] + a[place].variance, around[1] + b[place].variance];
        }
        let place = cells.index(at.0, at.1);
        of_difference([&a[place], &b[place]], around)
    };
    cells.pixels().map(of_cell).collect()
}

/// The deviate of the difference of two cells, component by component, given the variances around them.
fn of_difference([a, b]: [&Cell; 2], around: [Rgb; 2]) -> Rgb {
    let apart = (a.mean - b.mean).to_array();
    let [v, w] = [a, b].map(|cell| cell.variance.to_array());
    let [around_a, around_b] = around.map(Rgb::to_array);
    let [red, green, blue] = std::array::from_fn(|c| {
        let (own, around) = ([v[c], w[c]], [around_a[c], around_b[c]]);
        let variance = own[0] + own[1];
        match apart[c] {
            _ if !variance.is_finite() => f64::NAN,
            0.0 => 0.0,
            apart => normal::of_student(apart / variance.sqrt(), joint_dof(own, around, [a.dof, b.dof])),
        }
    });
    Rgb::new(red, green, blue)
}

/// The degrees of freedom of the sum of two variances, given those of each: the fewer of what Welch (1947) has for
/// the variances themselves and for those around them.
///
/// Of few seeds, some cell has a variance near 0 by chance. Its own variance then says that the other side decides, and
/// hides that it is the one that is not known; those around do not depend on that chance. Where they say nothing of a
/// side, the fewer of both (Mickey and Brown 1966).
fn joint_dof(own: [f64; 2], around: [f64; 2], dof: [f64; 2]) -> f64 {
    let varies = |side: &usize| own[*side] > 0.0;
    let least = (0..2).filter(varies).map(|side| dof[side]).fold(f64::INFINITY, f64::min);
    let are_known = around.iter().all(|variance| variance.is_finite());
    if are_known && (0..2).filter(varies).all(|side| around[side] > 0.0) {
        welch(own, dof).min(welch(around, dof))
    } else {
        least
    }
}

/// Degrees of freedom of the sum of two variances.
fn welch(variances: [f64; 2], dof: [f64; 2]) -> f64 {
    // Shares, since squares of variances may underflow.
    let share = |side: usize| variances[side] / (variances[0] + variances[1]);
    1.0 / (share(0).powi(2) / dof[0] + share(1).powi(2) / dof[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn a_variance_that_is_small_by_chance_does_not_decide() {
        let dof = [3.0, 1000.0];
        assert_relative_eq!(joint_dof([1e-9, 0.01], [1.0, 0.01], dof), 3.06, max_relative = 1e-3);
        assert_relative_eq!(joint_dof([1.0, 0.01], [1e-9, 0.01], dof), 3.06, max_relative = 1e-3);
        assert_relative_eq!(joint_dof([1.0, 1.0], [2.0, 2.0], [3.0, 3.0]), 6.0, max_relative = 1e-14);
    }

    #[test]
    fn without_variances_around_the_fewer_degrees_of_freedom_count() {
        for around in [[0.0, 0.0], [0.0, 1.0], [f64::INFINITY, 1.0]] {
            assert_eq!(joint_dof([1e-9, 1.0], around, [3.0, 1000.0]), 3.0, "{around:?}");
        }
        assert_relative_eq!(joint_dof([0.0, 1.0], [0.0, 1.0], [3.0, 1000.0]), 1000.0, max_relative = 1e-14);
    }
}
