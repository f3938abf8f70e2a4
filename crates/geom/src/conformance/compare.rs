use super::oracle;
use crate::{Accel, GeomError, Hit, Ray, Triangle};
use std::fmt;

/// A violation of the contract of [`Accel`], with the input that reproduces it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Violation {
    /// The case or regime, and the query.
    pub what: String,
    /// The scene.
    pub triangles: Vec<Triangle>,
    /// The ray; `None` if the accelerator was not built.
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

/// Compares all answers of `accel` for `rays`, to single rays and to batches, with those of the
/// [oracle](super::oracle) over `triangles`, to the bit.
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
    let violation = |query: &str, ray: &Ray, expected: String, actual: String| Violation {
        what: format!("{what}, {query}"),
        triangles: triangles.to_vec(),
        ray: Some(Box::new(*ray)),
        expected,
        actual,
    };
    let (mut hits, mut occluded) = (Vec::new(), Vec::new());
    accel.intersect_batch(rays, &mut hits);
    accel.occluded_batch(rays, &mut occluded);
    let mut tally = Tally::default();
    for (i, ray) in rays.iter().enumerate() {
        let expected = oracle::closest(triangles, ray);
        let answers = [("intersect", Some(accel.intersect(ray))), ("intersect_batch", hits.get(i).copied())];
        for (query, actual) in answers {
            if actual.map(bits) != Some(bits(expected)) {
                return Err(violation(query, ray, format!("{expected:?}"), format!("{actual:?}")));
            }
        }
        let answers = [("occluded", Some(accel.occluded(ray))), ("occluded_batch", occluded.get(i).copied())];
        for (query, actual) in answers {
            if actual != Some(expected.is_some()) {
                return Err(violation(query, ray, expected.is_some().to_string(), format!("{actual:?}")));
            }
        }
        check_scaling(accel, ray, expected)
            .map_err(|(scaled, actual)| violation("scaled", &scaled, format!("{expected:?}"), actual))?;
        tally.rays += 1;
        tally.hits += u64::from(expected.is_some());
    }
    Ok(tally)
}

/// Checks that scaling the direction by a power of two scales `t` by its inverse and changes nothing else.
fn check_scaling(accel: &dyn Accel, ray: &Ray, expected: Option<Hit>) -> Result<(), (Ray, String)> {
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
            return Err((scaled, format!("{actual:?}")));
        }
    }
    Ok(())
}
