//! The mirrors by way of which area lights are sampled.

mod facet;
mod facets;
mod large_mirrors;
mod light_bounds;
mod light_clusters;
mod mirror_tree;
mod small_mirrors;
#[cfg(test)]
mod tests;
mod triangle_map;

pub(crate) use facet::reflection;
pub(crate) use large_mirrors::LargeMirrors;
pub(crate) use small_mirrors::{ChosenMirror, MirrorPoint, SmallMirrors};

use crate::light::lights::Lights;
use crate::light::triangle_part::TrianglePart;
use facet::Facet;
use facets::Facets;
use globillum_geom::{Aabb, Triangles};
use light_bounds::LightBounds;
use light_clusters::LightClusters;
use mirror_tree::MirrorBounds;
use small_mirrors::SmallMirror;

/// The mirrors of a scene, by way of which area lights are sampled. Delta lights are not: BSDF sampling finds them in a
/// mirror with probability zero, so the mean would depend on whether mirrors are sampled.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mirrors {
    /// `None` if there are no large facets.
    pub(crate) large: Option<LargeMirrors>,
    /// `None` if there are no small facets.
    pub(crate) small: Option<SmallMirrors>,
}

impl Mirrors {
    /// The least area of a large facet, over the mean apparent area of a light cluster: both look about as large from the
    /// middle between them.
    const MIN_LARGE_AREA: f64 = 0.25;

    /// The most parts into which the triangles of small facets are cut. None is cut where there are more triangles than a
    /// third of that.
    const MAX_PARTS: usize = 1 << 16;

    /// The least length of a triangle that is cut, over the longest side of the scene's bounds: parts are large beside the
    /// rounding of their place in the mirror tree.
    const MIN_LENGTH: f64 = 1.0 / (1 << 16) as f64;

    /// The triangles for which `is_mirror` holds.
    pub(crate) fn of(triangles: &Triangles, is_mirror: impl Fn(u32) -> bool, lights: &Lights) -> Self {
        let has_area_lights = lights.triangles().next().is_some();
        let mirrors = triangles.live().iter().copied().filter(|&index| has_area_lights && is_mirror(index));
        let mirrors: Vec<_> = mirrors.collect();
        if mirrors.is_empty() {
            return Self::default();
        }
        let Facets { facets, bodies } = Facets::of(triangles, &mirrors);
        let clusters = LightClusters::of(triangles, lights);
        let least = Self::MIN_LARGE_AREA * apparent_area(triangles, lights) / clusters.len() as f64;
        let (large, small): (Vec<_>, Vec<_>) =
            facets.into_iter().partition(|facet| facet.area(triangles) >= least);
        let most = Self::MAX_PARTS / small.iter().map(|facet| facet.triangles.len()).sum::<usize>().max(1);
        let least_length = Self::MIN_LENGTH * triangles.bounds().extent().max_element();
        let parts = |facet: &Facet, index: u32| {
            let (triangle, normal, body) = (triangles.get(index), facet.normal, facet.body);
            let is_tiny = triangle.bounds().extent().max_element() < least_length;
            TrianglePart::of(triangle, if is_tiny { 1 } else { most }).map(move |part| {
                let (bounds, area) = (part.bounds(triangle), part.area_share() * triangle.area());
                (SmallMirror { triangle: index, part }, MirrorBounds { bounds, normal, area, body })
            })
        };
        let small: Vec<_> = small
            .iter()
            .flat_map(|facet| facet.triangles.iter().flat_map(move |&index| parts(facet, index)))
            .collect();
        let all_lights = LightBounds::around(triangles, lights.triangles());
        let of_large = || LargeMirrors::new(triangles, &large, bodies.clone(), all_lights);
        let of_small = || SmallMirrors::new(triangles, &small, bodies.clone(), clusters);
        Self { large: (!large.is_empty()).then(of_large), small: (!small.is_empty()).then(of_small) }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.large.is_none() && self.small.is_none()
    }
}

/// The area of all triangles that emit. One that is farther than the diagonal of all other triangles' bounds from their
/// middle counts with the area that looks as large from there, at the distance of the diagonal: a sun is no larger for
/// being far away.
fn apparent_area(triangles: &Triangles, lights: &Lights) -> f64 {
    let mut emits = vec![false; triangles.len()];
    lights.triangles().for_each(|index| emits[index as usize] = true);
    let others = triangles.live().iter().filter(|&&index| !emits[index as usize]);
    let bounds = Aabb::around(others.flat_map(|&index| triangles.get(index).vertices));
    let (middle, diagonal) = (bounds.center(), bounds.extent().length());
    let area = |index: u32| {
        let triangle = triangles.get(index);
        let distance = triangle.bounds().center().distance(middle);
        let scale = if distance > diagonal { diagonal / distance } else { 1.0 };
        triangle.area() * (scale * scale)
    };
    lights.triangles().map(area).sum()
}
