use super::prefixes::Prefixes;
use super::reuse_vertex::Suffix;
use crate::path::render_context::RenderContext;
use globillum_geom::Ray;
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

    /// Connects prefixes to `suffix`, which the path of `sample` has found: its own, and those of `samples` that may share
    /// it. Passes each to `add`, its own first, with how many rays must be unoccluded. It adds these to `rays`; its own
    /// connection has none. Where `suffix` is `None`, or the own prefix has no density there, no others are connected.
    #[inline(always)]
    pub(in crate::path) fn connect(
        context: &RenderContext<'_>,
        prefixes: &Prefixes,
        sample: u32,
        suffix: Option<&Suffix>,
        samples: impl Iterator<Item = u32>,
        rays: &mut Vec<Ray>,
        mut add: impl FnMut(Self, usize),
    ) {
        let Some(own) = prefixes.of(sample) else { return };
        let found = suffix.and_then(|suffix| Some((suffix, own.end.density_at(suffix)?)));
        let density = found.map_or(1.0, |(_, (density, _))| density);
        add(Self::new(sample, density, own.guide_ratio), 0);
        let Some((suffix, _)) = found else { return };
        for (sample, prefix) in prefixes.others_like(sample, samples) {
            let Some((density, direction)) = prefix.end.density_at(suffix) else { continue };
            let added = prefix.end.push_rays(context.scene.triangles(), suffix, direction, rays);
            if added > 0 {
                let guide_ratio = prefix.end.guide_ratio(context.guide, direction);
                add(Self::new(sample, density, guide_ratio), added);
            }
        }
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
