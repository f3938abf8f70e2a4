//! Deviates of differences.

use super::normal;
use super::side::Cell;
use crate::pixel_rect::PixelRect;
use globillum_material::Rgb;

/// Which variance of a side a cell has.
#[derive(Clone, Copy, Debug)]
pub(super) enum CellVariance {
    /// Its own.
    Own,
    /// At least the mean of those around it: where few samples find much of the light, a cell that none of them has met does
    /// not know its error.
    AtLeastAround,
}

/// The deviates of the differences of two sides, of `width` cells in each row.
pub(super) fn deviates([a, b]: [&[Cell]; 2], width: u32, of: CellVariance) -> Vec<Rgb> {
    let cells = PixelRect::whole([width, (a.len() / width as usize) as u32]);
    let of_cell = |at: (u32, u32)| {
        let near = PixelRect::pixels_near(at, [cells.width, cells.height]).filter(|&other| other != at);
        let (mut around, mut count) = ([Rgb::BLACK; 2], 0.0);
        for place in near.map(|(x, y)| cells.index(x, y)) {
            around = [around[0] + a[place].variance, around[1] + b[place].variance];
            count += 1.0;
        }
        let place = cells.index(at.0, at.1);
        of_difference([&a[place], &b[place]], around.map(|sum| sum / f64::max(count, 1.0)), of)
    };
    cells.pixels().map(of_cell).collect()
}

/// The deviate of the difference of two cells, component by component, given the mean variances around them.
fn of_difference([a, b]: [&Cell; 2], around: [Rgb; 2], of: CellVariance) -> Rgb {
    let apart = (a.mean - b.mean).to_array();
    let [v, w] = [a, b].map(|cell| cell.variance.to_array());
    let [around_a, around_b] = around.map(Rgb::to_array);
    let [red, green, blue] = std::array::from_fn(|c| {
        let (own, around) = ([v[c], w[c]], [around_a[c], around_b[c]]);
        let variance = match of {
            CellVariance::AtLeastAround if around.iter().all(|around| around.is_finite()) => {
                own[0].max(around[0]) + own[1].max(around[1])
            }
            _ => own[0] + own[1],
        };
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

    /// The cell in the middle has missed the rare samples of those around it, on one side or on both.
    #[test]
    fn a_cell_without_rare_samples_has_the_variance_around_it() {
        let cell = |mean: f64, variance: f64| Cell {
            mean: Rgb::splat(mean),
            variance: Rgb::splat(variance),
            dof: 1e9,
        };
        let around_middle = |middle: Cell| {
            let mut cells = vec![cell(1.0, 0.01); 9];
            cells[4] = middle;
            cells
        };
        let exact = vec![cell(1.0, 0.0); 9];
        let missed = around_middle(cell(0.7, 1e-9));
        let of_middle = |b: &[Cell]| deviates([&missed, b], 3, CellVariance::AtLeastAround)[4].g;
        assert_relative_eq!(of_middle(&exact), -3.0, max_relative = 1e-6);
        assert_relative_eq!(
            of_middle(&around_middle(cell(1.0, 1e-9))),
            -0.3 / 0.02_f64.sqrt(),
            max_relative = 1e-6
        );
        let unknown = around_middle(cell(1.0, 1e-9)).into_iter().enumerate();
        let unknown: Vec<_> =
            unknown.map(|(i, c)| if i == 0 { cell(1.0, f64::INFINITY) } else { c }).collect();
        assert!(of_middle(&unknown) < -1e3, "what is not known around a cell does not hide its difference");
        assert!(deviates([&missed, &exact], 3, CellVariance::Own)[4].g < -1e3);
    }

    #[test]
    fn without_variances_around_the_fewer_degrees_of_freedom_count() {
        for around in [[0.0, 0.0], [0.0, 1.0], [f64::INFINITY, 1.0]] {
            assert_eq!(joint_dof([1e-9, 1.0], around, [3.0, 1000.0]), 3.0, "{around:?}");
        }
        assert_relative_eq!(joint_dof([0.0, 1.0], [0.0, 1.0], [3.0, 1000.0]), 1000.0, max_relative = 1e-14);
    }
}
