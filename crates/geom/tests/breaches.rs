//! Accelerators that break the contract, each of which the conformance suite must refuse.

use globillum_geom::conformance::{Regime, Seeded, Suite, Violation};
use globillum_geom::{Aabb, Accel, BruteForce, GeomError, Hit, Ray, Triangles};
use globillum_testkit::accelerators;

/// What an accelerator does wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    /// `intersect_batch` adds to its output.
    AppendsHits,
    /// `occluded_batch` adds to its output.
    AppendsOccluded,
    /// `intersect_batch` leaves out the last ray.
    DropsLast,
    /// `intersect_batch` finds no hit.
    FindsNoHits,
    /// `intersect` finds no hit.
    FindsNoHit,
    /// `occluded` finds nothing.
    FindsNoOccluder,
    /// `occluded_batch` finds nothing.
    FindsNoOccluders,
    /// `intersect` returns the last of several hits at one distance.
    LastOfTies,
    /// `intersect` finds hits at the ends of the range.
    ClosedRange,
    /// `intersect` finds excluded triangles.
    IgnoresExcluded,
    /// `intersect` finds nothing along directions whose squared length overflows.
    SquaresDirection,
    /// `bounds` is too large by one unit in the last place.
    WideBounds,
}

/// Brute force with a fault.
#[derive(Debug)]
struct Broken {
    sound: BruteForce,
    /// Of the triangles in reverse order.
    reversed: BruteForce,
    triangles: u32,
    fault: Fault,
}

impl Broken {
    fn new(triangles: &Triangles, fault: Fault) -> Result<Self, GeomError> {
        let all = (0..triangles.len() as u32).rev().map(|index| *triangles.get(index));
        let reversed = BruteForce::build(&Triangles::new(all.collect())?);
        Ok(Self { sound: BruteForce::build(triangles), reversed, triangles: triangles.len() as u32, fault })
    }

    /// The last of several hits at one distance.
    fn last_hit(&self, ray: &Ray) -> Option<Hit> {
        let reverse = |index| match index {
            Ray::NO_TRIANGLE => index,
            index => self.triangles.wrapping_sub(index).wrapping_sub(1),
        };
        let hit = self.reversed.intersect(&Ray { excluded: ray.excluded.map(reverse), ..*ray })?;
        Some(Hit { triangle: reverse(hit.triangle), ..hit })
    }
}

impl Accel for Broken {
    fn intersect(&self, ray: &Ray) -> Option<Hit> {
        match self.fault {
            Fault::FindsNoHit => None,
            Fault::LastOfTies => self.last_hit(ray),
            Fault::ClosedRange => {
                self.sound.intersect(&ray.with_range(ray.t_min.next_down(), ray.t_max.next_up()))
            }
            Fault::IgnoresExcluded => self.sound.intersect(&Ray { excluded: [Ray::NO_TRIANGLE; 2], ..*ray }),
            Fault::SquaresDirection if ray.direction.length_squared().is_infinite() => None,
            _ => self.sound.intersect(ray),
        }
    }

    fn occluded(&self, ray: &Ray) -> bool {
        self.fault != Fault::FindsNoOccluder && self.sound.occluded(ray)
    }

    fn intersect_batch(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        if self.fault != Fault::AppendsHits {
            hits.clear();
        }
        hits.extend(
            rays.iter().map(|ray| self.sound.intersect(ray).filter(|_| self.fault != Fault::FindsNoHits)),
        );
        if self.fault == Fault::DropsLast {
            hits.pop();
        }
    }

    fn occluded_batch(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        if self.fault != Fault::AppendsOccluded {
            occluded.clear();
        }
        let finds = self.fault != Fault::FindsNoOccluders;
        occluded.extend(rays.iter().map(|ray| finds && self.sound.occluded(ray)));
    }

    fn bounds(&self) -> Aabb {
        let mut bounds = self.sound.bounds();
        if self.fault == Fault::WideBounds {
            bounds.max.x = bounds.max.x.next_up();
        }
        bounds
    }

    fn bytes(&self) -> usize {
        self.sound.bytes()
    }
}

/// What the named cases find of brute force with `fault`.
fn violation_of(fault: Fault) -> Option<Violation> {
    let suite = Suite::default();
    suite.check_cases(|triangles| Broken::new(triangles, fault)).err()
}

/// The number at the start of `text`.
fn number(text: &str) -> usize {
    text.split(' ').next().and_then(|word| word.parse().ok()).expect("it starts with a number")
}

#[test]
fn brute_force_without_a_fault_is_accepted() {
    assert!(violation_of(Fault::None).is_none());
}

#[test]
fn a_batch_of_another_length_is_refused() {
    let faults = [
        (Fault::AppendsHits, "intersect_batch", 3),
        (Fault::AppendsOccluded, "occluded_batch", 3),
        (Fault::DropsLast, "intersect_batch", -1),
    ];
    for (fault, query, excess) in faults {
        let found = violation_of(fault).unwrap_or_else(|| panic!("{fault:?} is accepted"));
        assert!(found.what.ends_with(query) && found.ray.is_none(), "{fault:?}: {found}");
        let (expected, actual) = (number(&found.expected), number(&found.actual));
        assert_eq!(expected.checked_add_signed(excess), Some(actual), "{fault:?}: {found}");
        let message = format!("{query}: expected {expected} entries, got {actual};");
        assert!(found.to_string().contains(&message), "{found}");
    }
}

#[test]
fn a_wrong_answer_is_refused() {
    let faults = [
        (Fault::FindsNoHit, "intersect"),
        (Fault::FindsNoHits, "intersect_batch"),
        (Fault::FindsNoOccluder, "occluded"),
        (Fault::FindsNoOccluders, "occluded_batch"),
        (Fault::LastOfTies, "intersect"),
        (Fault::ClosedRange, "intersect"),
        (Fault::IgnoresExcluded, "intersect"),
        (Fault::SquaresDirection, "scaled"),
    ];
    for (fault, query) in faults {
        let found = violation_of(fault).unwrap_or_else(|| panic!("{fault:?} is accepted"));
        assert!(found.what.ends_with(&format!(", {query}")) && found.ray.is_some(), "{fault:?}: {found}");
    }
}

#[test]
fn other_bounds_are_refused() {
    let found = violation_of(Fault::WideBounds).expect("the bounds are wrong");
    assert!(found.what.ends_with("bounds") && found.ray.is_none(), "{found}");
    assert_ne!(found.expected, found.actual);
}

#[test]
fn a_violation_shows_hits_as_such() {
    let found = violation_of(Fault::FindsNoHits).expect("hits are lost");
    assert!(found.what.ends_with("intersect_batch") && found.ray.is_some(), "{found}");
    assert!(found.expected.starts_with("Hit {"), "{found}");
    assert_eq!(found.actual, "no hit");
}

/// Each by itself: a wrapper around several would hide what they leave in its output.
#[test]
fn every_accelerator_clears_its_output_and_knows_its_bounds() {
    for (name, build) in accelerators::all() {
        let tally = Regime::Uniform.check(&mut Seeded::new(3), 64, build);
        assert!(tally.is_ok(), "{name}: {}", tally.unwrap_err());
    }
}
