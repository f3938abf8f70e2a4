//! What a structure must offer to be measured.

use globillum::geom::{Hit, Ray};
use serde::Serialize;

/// Which rows are compared with which.
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

/// A structure over a mesh, with one way to ask it.
pub(crate) struct Entry {
    pub(crate) family: Family,
    pub(crate) structure: &'static str,
    /// How it is asked, where there are several ways; else empty.
    pub(crate) mode: String,
    pub(crate) build: Build,
    pub(crate) peer: Box<dyn Peer>,
}

/// What a structure costs before the first ray.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Build {
    /// On one thread.
    pub(crate) seconds: f64,
    /// Held afterwards, the triangles included; `None` if the peer does not tell.
    pub(crate) bytes: Option<usize>,
}

/// Answers rays. Both queries take the rays into the peer's own layout at once, so that this is
/// not timed.
pub(crate) trait Peer {
    /// Prepares the search for the closest hit.
    fn closest<'a>(&'a self, rays: &[Ray]) -> Box<dyn Trial + 'a>;

    /// Prepares the search for any hit.
    fn any<'a>(&'a self, rays: &[Ray]) -> Box<dyn Trial + 'a>;
}

/// Rays in a peer's own layout.
pub(crate) trait Trial {
    /// Traces all of them: what is timed.
    fn trace(&mut self);

    /// What the last [`Trial::trace`] found, a ray each.
    fn answers(&self) -> Vec<Answer>;
}

/// What a peer says of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Answer {
    Miss,
    /// Something is in the way.
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
    /// How many rays there are; the rest of the last packet is padding.
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

/// Answers rays one by one, each taken into the peer's layout by `layout`.
pub(crate) fn one_by_one<'a, R: 'a, A: Copy + Into<Answer> + 'a>(
    rays: &[Ray],
    layout: impl Fn(&Ray) -> R,
    query: impl Fn(&R) -> A + 'a,
) -> Box<dyn Trial + 'a> {
    Box::new(Packets::new(rays.iter().map(layout).collect(), rays.len(), move |ray| [query(ray)]))
}
