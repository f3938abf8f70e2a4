//! The interface of measured structures.

use crate::rays::RaySet;
use globillum::geom::{Hit, Ray};
use serde::Serialize;

/// A group of rows for ratios.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Family {
    OursSingle,
    OursBatch,
    RustCrate,
    EmbreeRobust,
    EmbreeFast,
}

impl Family {
    pub(crate) fn is_ours(self) -> bool {
        matches!(self, Self::OursSingle | Self::OursBatch)
    }

    pub(crate) fn is_embree(self) -> bool {
        matches!(self, Self::EmbreeRobust | Self::EmbreeFast)
    }
}

/// A structure over a mesh, with one mode of queries.
pub(crate) struct Entry {
    pub(crate) family: Family,
    pub(crate) structure: &'static str,
    /// The mode of queries; empty if there is only one.
    pub(crate) mode: String,
    pub(crate) build: Build,
    pub(crate) peer: Box<dyn Peer>,
}

/// Build time and memory of a structure.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Build {
    /// On one thread.
    pub(crate) seconds: f64,
    /// Memory of the built structure, including the triangles; `None` if the peer does not report it.
    pub(crate) bytes: Option<usize>,
}

/// A structure that answers queries. Both methods convert the rays to the peer's own layout, which is not
/// timed.
pub(crate) trait Peer {
    /// Prepares closest-hit queries.
    fn closest<'a>(&'a self, rays: &RaySet) -> Box<dyn Trial + 'a>;

    /// Prepares any-hit queries.
    fn any<'a>(&'a self, rays: &RaySet) -> Box<dyn Trial + 'a>;
}

/// Rays in a peer's own layout.
pub(crate) trait Trial {
    /// Traces all rays. This is timed.
    fn trace(&mut self);

    /// The answers of the last [`Trial::trace`], one per ray.
    fn answers(&self) -> Vec<Answer>;
}

/// The answer to a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Answer {
    Miss,
    /// There is a hit.
    Blocked,
    /// The closest hit.
    At {
        t: f64,
        triangle: u32,
    },
}

impl From<bool> for Answer {
    fn from(blocked: bool) -> Self {
        if blocked { Self::Blocked } else { Self::Miss }
    }
}

impl From<Option<Hit>> for Answer {
    fn from(hit: Option<Hit>) -> Self {
        hit.map_or(Self::Miss, |Hit { t, triangle, .. }| Self::At { t, triangle })
    }
}

/// The closest hit of a peer that works in `f32`.
pub(crate) type Found = Option<(u32, f32)>;

impl From<Found> for Answer {
    fn from(found: Found) -> Self {
        found.map_or(Self::Miss, |(triangle, t)| Self::At { t: f64::from(t), triangle })
    }
}

/// Answers packets of `N` rays, one after the other.
pub(crate) struct Packets<P, A, F, const N: usize> {
    packets: Vec<P>,
    /// The number of rays; the rest of the last packet is padding.
    count: usize,
    query: F,
    answers: Vec<A>,
}

impl<P, A, F: Fn(&P) -> [A; N], const N: usize> Packets<P, A, F, N> {
    pub(crate) fn new(packets: Vec<P>, count: usize, query: F) -> Self {
        let answers = Vec::with_capacity(packets.len() * N);
        Self { packets, count, query, answers }
    }
}

impl<P, A: Copy + Into<Answer>, F: Fn(&P) -> [A; N], const N: usize> Trial for Packets<P, A, F, N> {
    fn trace(&mut self) {
        self.answers.clear();
        self.answers.extend(self.packets.iter().flat_map(&self.query));
    }

    fn answers(&self) -> Vec<Answer> {
        self.answers.iter().take(self.count).map(|&answer| answer.into()).collect()
    }
}

/// Answers rays one by one, each converted by `layout`.
pub(crate) fn one_by_one<'a, R: 'a, A: Copy + Into<Answer> + 'a>(
    rays: &[Ray],
    layout: impl Fn(&Ray) -> R,
    query: impl Fn(&R) -> A + 'a,
) -> Box<dyn Trial + 'a> {
    Box::new(Packets::new(rays.iter().map(layout).collect(), rays.len(), move |ray| [query(ray)]))
}
