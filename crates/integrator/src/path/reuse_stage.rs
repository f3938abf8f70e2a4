//! How a path is divided into the prefix and the suffix of path reuse.

use super::emission_rays::MAX_REFLECTIONS;

/// How far a path has been divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ReuseStage {
    /// The prefix has not ended.
    Prefix,
    /// The prefix has ended at the last vertex, and others may reuse what follows.
    PrefixEnded,
    /// Of the vertices since the end of the prefix, all were mirrors, of this number. Others may share what the path finds
    /// of lights ([`SharedCaustics`](super::caustics::SharedCaustics)), or the suffix that begins beyond the first mirror.
    Reflected(u8),
    /// The suffix has begun, or the prefix has ended and none begins: paths are not reused, or a diffuse vertex followed two
    /// mirrors or more, or there were more mirrors than are shared.
    Settled,
}

/// What a ray of a path has met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Met {
    /// It has left the scene.
    Environment,
    Mirror,
    Diffuse,
}

/// What path reuse has to record of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ReuseEvent {
    None,
    /// The prefix ends at this vertex.
    PrefixEnds,
    /// The next vertex after the prefix is on a mirror.
    FirstMirror,
    /// The suffix begins at this vertex.
    SuffixBegins,
    /// The suffix is the environment.
    SuffixIsEnvironment,
}

impl ReuseStage {
    /// The stage after a ray has met something.
    #[inline(always)]
    pub(super) fn meet(self, met: Met) -> (Self, ReuseEvent) {
        match (self, met) {
            (Self::PrefixEnded, Met::Environment) => (Self::Settled, ReuseEvent::SuffixIsEnvironment),
            (Self::PrefixEnded, Met::Mirror) => (Self::Reflected(1), ReuseEvent::FirstMirror),
            (Self::PrefixEnded | Self::Reflected(1), Met::Diffuse) => {
                (Self::Settled, ReuseEvent::SuffixBegins)
            }
            (Self::Reflected(mirrors), Met::Mirror) if u32::from(mirrors) < MAX_REFLECTIONS => {
                (Self::Reflected(mirrors + 1), ReuseEvent::None)
            }
            (Self::Reflected(_), _) => (Self::Settled, ReuseEvent::None),
            (Self::Prefix | Self::Settled, _) => (self, ReuseEvent::None),
        }
    }

    /// The stage after a diffuse vertex has scattered the path; others may reuse the prefix that ends there, or not.
    #[inline(always)]
    pub(super) fn scatter(self, may_reuse: bool) -> (Self, ReuseEvent) {
        match self {
            Self::Prefix if may_reuse => (Self::PrefixEnded, ReuseEvent::PrefixEnds),
            Self::Prefix => (Self::Settled, ReuseEvent::None),
            _ => (self, ReuseEvent::None),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The events of a path from its first diffuse vertex on. It meets `mirrors` mirrors before that vertex, and `then` the
    /// rest.
    fn events(mirrors: usize, then: &[Met]) -> Vec<ReuseEvent> {
        let mut stage = ReuseStage::Prefix;
        let before = std::iter::repeat_n(Met::Mirror, mirrors).chain([Met::Diffuse]);
        for met in before {
            assert_eq!(stage.meet(met), (ReuseStage::Prefix, ReuseEvent::None));
        }
        let mut events = vec![stage.scatter(true).1];
        stage = stage.scatter(true).0;
        for &met in then {
            let event;
            (stage, event) = stage.meet(met);
            events.push(event);
        }
        events
    }

    #[test]
    fn suffixes_begin_after_one_mirror_at_most() {
        use Met::{Diffuse, Environment, Mirror};
        use ReuseEvent::{FirstMirror, None, PrefixEnds, SuffixBegins, SuffixIsEnvironment};
        for before in [0, 3] {
            assert_eq!(events(before, &[Diffuse, Diffuse]), [PrefixEnds, SuffixBegins, None]);
            assert_eq!(events(before, &[Environment]), [PrefixEnds, SuffixIsEnvironment]);
            assert_eq!(
                events(before, &[Mirror, Diffuse, Mirror]),
                [PrefixEnds, FirstMirror, SuffixBegins, None]
            );
            assert_eq!(
                events(before, &[Mirror, Mirror, Diffuse, Diffuse]),
                [PrefixEnds, FirstMirror, None, None, None]
            );
            assert_eq!(events(before, &[Mirror, Environment]), [PrefixEnds, FirstMirror, None]);
        }
    }

    #[test]
    fn mirrors_are_shared_up_to_the_limit() {
        let mut stage = ReuseStage::PrefixEnded;
        for mirror in 1..=MAX_REFLECTIONS {
            stage = stage.meet(Met::Mirror).0;
            assert_eq!(stage, ReuseStage::Reflected(mirror as u8));
        }
        assert_eq!(stage.meet(Met::Mirror), (ReuseStage::Settled, ReuseEvent::None));
    }

    #[test]
    fn without_reuse_the_prefix_ends_unrecorded() {
        assert_eq!(ReuseStage::Prefix.scatter(false), (ReuseStage::Settled, ReuseEvent::None));
        assert_eq!(ReuseStage::Settled.scatter(true), (ReuseStage::Settled, ReuseEvent::None));
    }
}
