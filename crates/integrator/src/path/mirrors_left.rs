//! How many mirrors a path may follow to a light.

use crate::Settings;

/// The most mirrors by way of which rays find lights, and paths their first diffuse vertex, where that is looked for.
pub(super) const MAX_MIRRORS: u32 = 8;

/// The most mirrors by way of which a path finds a light after this number of bounces: [`MAX_MIRRORS`], or fewer if the
/// settings limit bounces.
pub(super) fn mirrors_left(settings: &Settings, bounces: u32) -> u32 {
    settings.max_bounces.map_or(MAX_MIRRORS, |max| MAX_MIRRORS.min(max.saturating_sub(bounces)))
}
