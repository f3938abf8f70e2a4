use super::aim::{point_of, ray_at, with_some_excluded, with_some_range};
use super::compare::{Tally, Violation, compare};
use super::source::Source;
use crate::{Accel, GeomError, Ray, Triangle, Triangles};
use glam::{DVec3, Vec3};

/// A family of random scenes and rays, each with its own numerical difficulty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regime {
    /// Coordinates uniform in `[-1, 1]`.
    Uniform,
    /// Integer coordinates from 0 to 4: many coplanar triangles, axis-aligned edges and shared vertices.
    Lattice,
    /// Coordinates of either sign, log-uniform in magnitude from `1e-15` to `1e15`.
    LogUniform,
    /// Details of size 0.01 at a distance of 10,000 from the origin along each axis.
    Offset,
    /// Copies and permutations of triangles, and triangles that share edges and vertices.
    Copies,
    /// Random bit patterns: three scenes of four are mapped to numbers within the domain.
    RawBits,
}

/// Rays per pencil: the size of a packet of the wide BVH.
pub(super) const PENCIL: usize = 64;

impl Regime {
    /// All regimes.
    pub const ALL: [Self; 6] =
        [Self::Uniform, Self::Lattice, Self::LogUniform, Self::Offset, Self::Copies, Self::RawBits];

    /// A random scene of 0 to 24 triangles, not validated.
    pub fn triangles(self, source: &mut impl Source) -> Vec<Triangle> {
        let count = source.below(25);
        let untamed = self == Self::RawBits && source.one_in(4);
        let mut triangles: Vec<Triangle> = Vec::with_capacity(count);
        for _ in 0..count {
            let mut vertices =
                [0; 3].map(|_| if untamed { untamed_vertex(source) } else { self.vertex(source) });
            let earlier = if triangles.is_empty() { None } else { Some(source.pick(&triangles)) };
            if let Some(Triangle { vertices: old }) = earlier {
                // Some triangles share a vertex or an edge with an earlier one; those of `Copies` share more.
                let shared = if self == Self::Copies { source.below(4) } else { source.below(6) / 2 };
                let turn = source.below(3);
                for i in 0..shared.min(3) {
                    vertices[i] = old[(i + turn) % 3];
                }
            }
            triangles.push(Triangle { vertices });
        }
        triangles
    }

    /// A random ray for a scene of this regime, usually aimed at one of `triangles`.
    pub fn ray(self, triangles: &[Triangle], source: &mut impl Source) -> Ray {
        let ray = self.ray_to_all(triangles, source);
        with_some_excluded(ray, triangles, source)
    }

    fn ray_to_all(self, triangles: &[Triangle], source: &mut impl Source) -> Ray {
        let elsewhere = self.point(source);
        match self {
            Self::RawBits if source.one_in(8) => {
                let mut number = || f64::from_bits(source.bits());
                let origin = DVec3::new(number(), number(), number());
                let direction = DVec3::new(number(), number(), number());
                Ray::new(origin, direction).with_range(number(), number())
            }
            Self::Lattice if source.one_in(2) => {
                let mut step = || source.pick(&[-1.0, -0.0, 0.0, 1.0, 2.0]);
                Ray::new(elsewhere, DVec3::new(step(), step(), step()))
            }
            _ if source.one_in(4) => {
                let direction = DVec3::new(source.signed(), source.signed(), source.signed());
                Ray::new(elsewhere, direction)
            }
            _ => ray_at(triangles, elsewhere, source),
        }
    }

    /// Checks the accelerator that `build` makes of one random scene, with a pencil of 64 coherent rays and
    /// `rays` other rays. Returns the number of rays compared.
    ///
    /// # Errors
    /// The first [`Violation`] found.
    pub fn check<A: Accel>(
        self,
        source: &mut impl Source,
        rays: usize,
        build: impl Fn(&Triangles) -> Result<A, GeomError>,
    ) -> Result<Tally, Violation> {
        let (name, triangles) = (format!("{self:?}"), self.triangles(source));
        let refused = |error: &GeomError| Violation::of_building(&name, &triangles, error);
        let checked = match Triangles::new(triangles.clone()) {
            Ok(checked) => checked,
            // Raw bits outside the domain are rejected as documented.
            Err(_) if self == Self::RawBits => return Ok(Tally::default()),
            Err(error) => return Err(refused(&error)),
        };
        let accel = build(&checked).map_err(|error| refused(&error))?;
        let mut all_rays = pencil(&triangles, self.ray(&triangles, source), source);
        all_rays.extend((0..rays).map(|_| self.ray(&triangles, source)));
        compare(&name, &accel, &triangles, &all_rays)
    }

    fn vertex(self, source: &mut impl Source) -> Vec3 {
        let mut number = || self.coordinate(source) as f32;
        Vec3::new(number(), number(), number())
    }

    fn point(self, source: &mut impl Source) -> DVec3 {
        let mut number = || match self {
            // Multiples of one half: on and between the lattice's points, and outside.
            Self::Lattice => source.below(15) as f64 / 2.0 - 1.5,
            _ => 2.0 * self.coordinate(source),
        };
        DVec3::new(number(), number(), number())
    }

    fn coordinate(self, source: &mut impl Source) -> f64 {
        match self {
            Self::Uniform | Self::Copies => source.signed(),
            Self::Lattice => source.below(5) as f64,
            Self::LogUniform => libm::pow(10.0, 15.0 * source.signed()).copysign(source.signed()),
            Self::Offset => 1e4 + 0.01 * source.signed(),
            Self::RawBits => f64::from(in_domain(source.bits() as u32)),
        }
    }
}

/// Coherent rays: parallel to `ray`, from its origin, or from a distant origin toward one point. Each has its
/// own range. Half the pencils contain a few rays that are not traceable, and some that exclude triangles.
fn pencil(triangles: &[Triangle], ray: Ray, source: &mut impl Source) -> Vec<Ray> {
    let vertices = triangles.iter().flat_map(|triangle| triangle.vertices);
    let reach = f64::from(vertices.map(|v| v.abs().max_element()).fold(1e-6, f32::max));
    let spread = libm::pow(10.0, -9.0 * source.unit());
    let speed = ray.direction.abs().max_element();
    let target = if triangles.is_empty() { DVec3::ZERO } else { point_of(&source.pick(triangles), source) };
    let away = ray.direction / speed * reach * 2.0_f64.powi(source.below(46) as i32);
    let kind = source.below(4);
    // Like camera rays: all traceable, with ranges that start at the origin or after it.
    let is_plain = source.one_in(2);
    let member = |i: usize| {
        let offset = spread * DVec3::new(source.signed(), source.signed(), source.signed());
        let ray = match kind {
            0 => Ray { origin: ray.origin + reach * offset, ..ray },
            1 => Ray { direction: ray.direction + speed * offset, ..ray },
            _ => Ray::new(target - away, away + reach * offset),
        };
        // An accelerator may detect a packet by these rays, so they stay traceable.
        if !is_plain && !i.is_multiple_of(21) && source.one_in(32) {
            return Ray { direction: DVec3::splat(source.pick(&[f64::NAN, 0.0])), ..ray };
        }
        let ranged = with_some_range(ray, source);
        if is_plain {
            return Ray { t_min: ranged.t_min.max(0.0), ..ranged };
        }
        with_some_excluded(ranged, triangles, source)
    };
    (0..PENCIL).map(member).collect()
}

/// The number with the sign and mantissa of `bits`, and its exponent mapped to -60 to 59.
fn in_domain(bits: u32) -> f32 {
    let exponent = 127 - 60 + (bits >> 23 & 0xff) * 119 / 255;
    f32::from_bits(bits & 0x807f_ffff | exponent << 23)
}

fn untamed_vertex(source: &mut impl Source) -> Vec3 {
    let mut number = || f32::from_bits(source.bits() as u32);
    Vec3::new(number(), number(), number())
}
