use super::prefixes::Prefixes;
use globillum_material::Rgb;

/// A prefix that could have been continued to a place that a path has found: one of the techniques of the balance heuristic
/// (Veach and Guibas 1995).
#[derive(Clone, Copy, Debug)]
pub(in crate::path) struct Connection {
    /// The sample of the prefix.
    pub(in crate::path) sample: u32,
    /// The density, times pi, with which the prefix would have been continued to the place by its BSDF alone: per area of the
    /// place, or per solid angle to the environment.
    density: f64,
    /// The same by the guide, if there is one.
    guided_density: f64,
}

impl Connection {
    /// A connection of this density by the BSDF. A guide makes its direction `guide_ratio` times as dense.
    #[inline(always)]
    pub(in crate::path) fn new(sample: u32, density: f64, guide_ratio: f64) -> Self {
        Self { sample, density, guided_density: density * guide_ratio }
    }

    /// The same if the place is occluded.
    #[inline(always)]
    pub(super) fn occluded(self) -> Self {
        Self { density: 0.0, guided_density: 0.0, ..self }
    }

    /// Divides what arrives from a place among the prefixes connected to it, by the balance heuristic. Each comes with the
    /// radiance that it receives from there. Adds its share to the radiance of its sample.
    #[inline(always)]
    pub(in crate::path) fn divide<'a>(
        connections: impl Iterator<Item = (&'a Self, Rgb)> + Clone,
        prefixes: &Prefixes,
        samples: &mut [Rgb],
    ) {
        let sum: f64 = connections.clone().map(|(connection, _)| connection.guided_density).sum();
        for (&Self { sample, density, .. }, radiance) in connections {
            let throughput = prefixes.of(sample).map_or(Rgb::WHITE, |prefix| prefix.throughput);
            samples[sample as usize] += throughput * radiance * (density / sum);
        }
    }
}
