use super::oracle;
use crate::{Accel, Hit, Ray, Triangle};
use std::fmt;

/// Where an accelerator broke its contract.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Violation {
    /// What was asked for.
    pub what: String,
    /// The scene.
    pub triangles: Vec<Triangle>,
    /// The ray, if there is one to blame.
    pub ray: Option<Box<Ray>>,
    /// What the contract asks for.
    pub expected: String,
    /// What came instead.
    pub actual: String,
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { what, triangles, ray, expected, actual } = self;
        write!(f, "{what}: expected {expected}, got {actual}")?;
        if let Some(ray) = ray {
            write!(f, "; {ray:?}")?;
        }
        write!(f, "; {} triangles", triangles.len())?;
        // A small scene is worth seeing whole.
        if triangles.len() <= 32 { write!(f, ": {triangles:?}") } else { Ok(()) }
    }
}

impl std::error::Error for Violation {}

/// What a suite tried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Tally {
    /// Rays compared.
    pub rays: u64,
    /// How many of them hit something.
    pub hits: u64,
}

impl std::ops::AddAssign for Tally {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.hits += other.hits;
    }
}

/// A hit as its bits, in which equal means equal.
fn bits(hit: Option<Hit>) -> Option<([u64; 3], u32)> {
    hit.map(|h| ([h.t, h.u, h.v].map(f64::to_bits), h.triangle))
}

/// Compares every answer of `accel`, single and in batches, with the oracle's over `triangles`.
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

/// Scaling a direction by a power of two scales `t` by its inverse and changes nothing else.
fn check_scaling(accel: &dyn Accel, ray: &Ray, expected: Option<Hit>) -> Result<(), (Ray, String)> {
    let components = ray.direction.to_array();
    // Where scaling itself would round, nothing is promised.
    let exact = |x: f64| x == 0.0 || (2.0_f64.powi(-80)..2.0_f64.powi(80)).contains(&x.abs());
    let whole_range = ray.t_min == 0.0 && ray.t_max == f64::INFINITY;
    if !whole_range || !components.into_iter().all(exact) {
        return Ok(());
    }
    for k in [-500, -1, 37, 500] {
        let factor = 2.0_f64.powi(k);
        let scaled = Ray::new(ray.origin, ray.direction * factor);
        let actual = accel.intersect(&scaled);
        let back = actual.map(|h| Hit { t: h.t * factor, ..h });
        if bits(back) != bits(expected) {
            return Err((scaled, format!("{actual:?}")));
        }
    }
    Ok(())
}
