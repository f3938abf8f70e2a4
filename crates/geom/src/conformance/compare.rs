use super::oracle;
use crate::{Aabb, Accel, GeomError, Hit, Ray, Triangle};
use std::fmt;

/// A violation of the contract of [`Accel`], with the input that reproduces it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Violation {
    /// The case or regime, and the query.
    pub what: String,
    /// The scene.
    pub triangles: Vec<Triangle>,
    /// The ray; `None` if the accelerator was not built, or if the violation is not of a single ray.
    pub ray: Option<Box<Ray>>,
    /// The answer that the contract requires.
    pub expected: String,
    /// The actual answer.
    pub actual: String,
}

impl Violation {
    /// The failure to build an accelerator over `triangles`.
    pub(super) fn of_building(what: &str, triangles: &[Triangle], error: &GeomError) -> Self {
        Self {
            what: format!("{what}, building"),
            triangles: triangles.to_vec(),
            ray: None,
            expected: "an accelerator".to_owned(),
            actual: error.to_string(),
        }
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, triangles, ray, expected, actual } = self;
        write!(f, "{what}: expected {expected}, got {actual}")?;
        if let Some(ray) = ray {
            write!(f, "; {ray:?}")?;
        }
        write!(f, "; {} triangles", triangles.len())?;
        // Small scenes are printed in full.
        if triangles.len() <= 32 { write!(f, ": {triangles:?}") } else { Ok(()) }
    }
}

impl std::error::Error for Violation {}

/// The number of rays that a suite has compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Tally {
    /// Rays compared.
    pub rays: u64,
    /// Rays with a hit.
    pub hits: u64,
}

impl std::ops::AddAssign for Tally {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.hits += other.hits;
    }
}

/// The bits of a hit, so that a comparison distinguishes zeros of different sign.
fn bits(hit: Option<Hit>) -> Option<([u64; 3], u32)> {
    hit.map(|h| ([h.t, h.u, h.v].map(f64::to_bits), h.triangle))
}

/// A wrong answer, without the scene.
struct Breach {
    query: &'static str,
    ray: Option<Box<Ray>>,
    expected: String,
    actual: String,
}

impl Breach {
    /// A wrong hit of `ray`.
    fn of_hit(query: &'static str, ray: &Ray, expected: Option<Hit>, actual: Option<Hit>) -> Self {
        let shown = |hit: Option<Hit>| hit.map_or_else(|| "no hit".to_owned(), |hit| format!("{hit:?}"));
        Self { query, ray: Some(Box::new(*ray)), expected: shown(expected), actual: shown(actual) }
    }

    /// A batch of `expected` rays that leaves `actual` entries.
    fn of_length(query: &'static str, expected: usize, actual: usize) -> Self {
        Self { query, ray: None, expected: format!("{expected} entries"), actual: actual.to_string() }
    }
}

/// Compares all answers of `accel` for `rays`, to single rays and to batches, with those of the
/// [oracle](super::oracle) over `triangles`, to the bit, and its bounds with those of the triangles that are not
/// degenerate. The outputs of both batches hold other entries before the call.
///
/// Returns the number of rays compared. `what` names the scene in a violation.
///
/// # Errors
/// The first [`Violation`] found.
pub fn compare(
    what: &str,
    accel: &dyn Accel,
    triangles: &[Triangle],
    rays: &[Ray],
) -> Result<Tally, Violation> {
    find_breach(accel, triangles, rays).map_err(|Breach { query, ray, expected, actual }| Violation {
        what: format!("{what}, {query}"),
        triangles: triangles.to_vec(),
        ray,
        expected,
        actual,
    })
}

fn find_breach(accel: &dyn Accel, triangles: &[Triangle], rays: &[Ray]) -> Result<Tally, Breach> {
    check_bounds(accel, triangles)?;
    let (hits, occluded) = ask_batches(accel, rays)?;
    let mut tally = Tally::default();
    for ((ray, hit), is_occluded) in rays.iter().zip(hits).zip(occluded) {
        let expected = oracle::closest(triangles, ray);
        for (query, actual) in [("intersect", accel.intersect(ray)), ("intersect_batch", hit)] {
            if bits(actual) != bits(expected) {
                return Err(Breach::of_hit(query, ray, expected, actual));
            }
        }
        for (query, actual) in [("occluded", accel.occluded(ray)), ("occluded_batch", is_occluded)] {
            if actual != expected.is_some() {
                let (expected, actual) = (expected.is_some().to_string(), actual.to_string());
                return Err(Breach { query, ray: Some(Box::new(*ray)), expected, actual });
            }
        }
        check_scaling(accel, ray, expected)?;
        tally.rays += 1;
        tally.hits += u64::from(expected.is_some());
    }
    Ok(tally)
}

/// Checks that the bounds are those of the triangles that are not degenerate. All empty boxes are equal.
fn check_bounds(accel: &dyn Accel, triangles: &[Triangle]) -> Result<(), Breach> {
    let live = triangles.iter().filter(|triangle| !triangle.is_degenerate());
    let expected = Aabb::around(live.flat_map(|triangle| triangle.vertices));
    let actual = accel.bounds();
    if actual == expected || (actual.is_empty() && expected.is_empty()) {
        return Ok(());
    }
    let (expected, actual) = (format!("{expected:?}"), format!("{actual:?}"));
    Err(Breach { query: "bounds", ray: None, expected, actual })
}

/// The answers of both batch methods, one for each ray. Their outputs hold made-up entries before the call, which
/// the methods must remove.
fn ask_batches(accel: &dyn Accel, rays: &[Ray]) -> Result<(Vec<Option<Hit>>, Vec<bool>), Breach> {
    let made_up = Hit { t: -1.0, u: 2.0, v: 2.0, triangle: Ray::NO_TRIANGLE };
    let (mut hits, mut occluded) = (vec![Some(made_up); 3], vec![true, false, true]);
    accel.intersect_batch(rays, &mut hits);
    accel.occluded_batch(rays, &mut occluded);
    for (query, length) in [("intersect_batch", hits.len()), ("occluded_batch", occluded.len())] {
        if length != rays.len() {
            return Err(Breach::of_length(query, rays.len(), length));
        }
    }
    Ok((hits, occluded))
}

/// Checks that scaling the direction by a power of two scales `t` by its inverse and changes nothing else.
fn check_scaling(accel: &dyn Accel, ray: &Ray, expected: Option<Hit>) -> Result<(), Breach> {
    let components = ray.direction.to_array();
    // The contract holds only where scaling does not round.
    let exact = |x: f64| x == 0.0 || (2.0_f64.powi(-80)..2.0_f64.powi(80)).contains(&x.abs());
    let whole_range = ray.t_min == 0.0 && ray.t_max == f64::INFINITY;
    if !whole_range || !components.into_iter().all(exact) {
        return Ok(());
    }
    for k in [-500, -1, 37, 500] {
        let factor = 2.0_f64.powi(k);
        let scaled = Ray { direction: ray.direction * factor, ..*ray };
        let actual = accel.intersect(&scaled);
        let back = actual.map(|h| Hit { t: h.t * factor, ..h });
        if bits(back) != bits(expected) {
            return Err(Breach::of_hit("scaled", &scaled, expected, actual));
        }
    }
    Ok(())
}
