//! The layout of query arguments in Embree 4's public headers, for a library built with one instance level, the
//! default.
//!
//! A single ray is a packet of one. The headers align packets to at most 64 bytes, which never leaves a gap
//! between the rays and the hits.

use std::ffi::{c_int, c_void};
use std::ptr::null_mut;

/// `RTCIntersectArguments` and `RTCOccludedArguments`, which have the same layout.
#[repr(C)]
pub(crate) struct Arguments {
    flags: c_int,
    feature_mask: c_int,
    context: *mut c_void,
    filter: *mut c_void,
    callback: *mut c_void,
    /// Used only by a library built with minimal curve widths.
    min_width_distance_factor: f32,
}

/// The coherence flag of the rays of one call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub(crate) enum Coherence {
    Incoherent = 0,
    Coherent = 1 << 16,
}

impl Arguments {
    pub(crate) fn new(coherence: Coherence) -> Self {
        const ALL_FEATURES: c_int = -1;
        Self {
            flags: coherence as c_int,
            feature_mask: ALL_FEATURES,
            context: null_mut(),
            filter: null_mut(),
            callback: null_mut(),
            min_width_distance_factor: 0.0,
        }
    }
}

/// The alignment of packets of any width.
#[repr(C, align(64))]
pub(crate) struct Aligned<T>(pub(crate) T);

/// `N` rays, component by component.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Rays<const N: usize> {
    pub(crate) origin: [[f32; N]; 3],
    pub(crate) t_near: [f32; N],
    pub(crate) direction: [[f32; N]; 3],
    pub(crate) time: [f32; N],
    /// Set to the `t` of the closest hit. Any-hit queries set it to minus infinity if there is a hit.
    pub(crate) t_far: [f32; N],
    pub(crate) mask: [u32; N],
    pub(crate) id: [u32; N],
    pub(crate) flags: [u32; N],
}

impl<const N: usize> Rays<N> {
    /// Rays with an empty range.
    pub(crate) const INACTIVE: Self = Self {
        origin: [[0.0; N]; 3],
        t_near: [0.0; N],
        direction: [[1.0; N]; 3],
        time: [0.0; N],
        t_far: [-1.0; N],
        mask: [u32::MAX; N],
        id: [0; N],
        flags: [0; N],
    };
}

/// The hits of `N` rays.
#[repr(C)]
pub(crate) struct Hits<const N: usize> {
    normal: [[f32; N]; 3],
    u: [f32; N],
    v: [f32; N],
    pub(crate) triangle: [u32; N],
    pub(crate) geometry: [u32; N],
    instance: [u32; N],
    instance_primitive: [u32; N],
}

/// Marks a hit record without a hit, or without an instance.
pub(crate) const INVALID: u32 = u32::MAX;

impl<const N: usize> Hits<N> {
    pub(crate) const NONE: Self = Self {
        normal: [[0.0; N]; 3],
        u: [0.0; N],
        v: [0.0; N],
        triangle: [INVALID; N],
        geometry: [INVALID; N],
        instance: [INVALID; N],
        instance_primitive: [INVALID; N],
    };
}

/// `RTCRayHit` or one of its packets.
#[repr(C)]
pub(crate) struct RayHits<const N: usize> {
    pub(crate) rays: Rays<N>,
    pub(crate) hits: Hits<N>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::offset_of;

    #[test]
    fn hits_follow_the_rays_without_a_gap() {
        assert_eq!(offset_of!(RayHits<1>, hits), 48);
        assert_eq!(offset_of!(RayHits<4>, hits), 192);
        assert_eq!(offset_of!(RayHits<8>, hits), 384);
        assert_eq!(offset_of!(RayHits<16>, hits), 768);
    }
}
