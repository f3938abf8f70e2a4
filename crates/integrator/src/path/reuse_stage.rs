//! How a path is divided into the prefix and the suffix of path reuse.

use super::mirrors_left::MAX_MIRRORS;

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
    /// Goes on to the stage after a ray has met something.
    #[inline(always)]
    pub(super) fn meet(&mut self, met: Met) -> Option<ReuseEvent> {
        let (stage, event) = match (*self, met) {
            (Self::PrefixEnded, Met::Environment) => (Self::Settled, Some(ReuseEvent::SuffixIsEnvironment)),
            (Self::PrefixEnded, Met::Mirror) => (Self::Reflected(1), Some(ReuseEvent::FirstMirror)),
            (Self::PrefixEnded | Self::Reflected(1), Met::Diffuse) => {
                (Self::Settled, Some(ReuseEvent::SuffixBegins))
            }
            (Self::Reflected(mirrors), Met::Mirror) if u32::from(mirrors) < MAX_MIRRORS => {
                (Self::Reflected(mirrors + 1), None)
            }
            (Self::Reflected(_), _) => (Self::Settled, None),
            (Self::Prefix | Self::Settled, _) => return None,
        };
        *self = stage;
        event
    }

    /// Goes on to the stage after a diffuse vertex has scattered the path; others may reuse the prefix that ends there, or
    /// not.
    #[inline(always)]
    pub(super) fn scatter(&mut self, may_reuse: bool) -> Option<ReuseEvent> {
        if *self != Self::Prefix {
            return None;
        }
        *self = if may_reuse { Self::PrefixEnded } else { Self::Settled };
        may_reuse.then_some(ReuseEvent::PrefixEnds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The events of a path from its first diffuse vertex on. It meets `mirrors` mirrors before that vertex, and `then` the
    /// rest.
    fn events(mirrors: usize, then: &[Met]) -> Vec<Option<ReuseEvent>> {
        let mut stage = ReuseStage::Prefix;
        let before = std::iter::repeat_n(Met::Mirror, mirrors).chain([Met::Diffuse]);
        for met in before {
            assert_eq!((stage.meet(met), stage), (None, ReuseStage::Prefix));
        }
        let scattered = stage.scatter(true);
        std::iter::once(scattered).chain(then.iter().map(|&met| stage.meet(met))).collect()
    }

    #[test]
    fn suffixes_begin_after_one_mirror_at_most() {
        use Met::{Diffuse, Environment, Mirror};
        let [ends, first_mirror, begins, is_environment] = [
            ReuseEvent::PrefixEnds,
            ReuseEvent::FirstMirror,
            ReuseEvent::SuffixBegins,
            ReuseEvent::SuffixIsEnvironment,
        ]
        .map(Some);
        for before in [0, 3] {
            assert_eq!(events(before, &[Diffuse, Diffuse]), [ends, begins, None]);
            assert_eq!(events(before, &[Environment]), [ends, is_environment]);
            assert_eq!(events(before, &[Mirror, Diffuse, Mirror]), [ends, first_mirror, begins, None]);
            let after_two = events(before, &[Mirror, Mirror, Diffuse, Diffuse]);
            assert_eq!(after_two, [ends, first_mirror, None, None, None]);
            assert_eq!(events(before, &[Mirror, Environment]), [ends, first_mirror, None]);
        }
    }

    #[test]
    fn mirrors_are_shared_up_to_the_limit() {
        let mut stage = ReuseStage::PrefixEnded;
        for mirror in 1..=MAX_MIRRORS {
            stage.meet(Met::Mirror);
            assert_eq!(stage, ReuseStage::Reflected(mirror as u8));
        }
        assert_eq!((stage.meet(Met::Mirror), stage), (None, ReuseStage::Settled));
    }

    #[test]
    fn without_reuse_the_prefix_ends_unrecorded() {
        let mut stage = ReuseStage::Prefix;
        assert_eq!((stage.scatter(false), stage), (None, ReuseStage::Settled));
        assert_eq!((stage.scatter(true), stage), (None, ReuseStage::Settled));
    }
}
