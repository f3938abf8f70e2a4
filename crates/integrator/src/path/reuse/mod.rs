//! Path reuse: [groups of pixels](pixel_groups) [share](suffix_sharing) the suffixes of their paths.

mod connection;
mod pixel_groups;
mod prefixes;
mod reuse_vertex;
mod suffix_sharing;

pub(super) use connection::Connection;
pub(super) use pixel_groups::Groups;
pub(super) use prefixes::{Prefix, Prefixes};
pub(super) use reuse_vertex::{ReuseVertex, Suffix};
pub(super) use suffix_sharing::SuffixSharing;
