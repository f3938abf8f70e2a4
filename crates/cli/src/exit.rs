//! Exit codes.

use crate::failures::Failures;
use globillum::integrator::view_factors::FactorError;
use globillum::integrator::{CheckpointError, RenderError};
use std::io::{self, ErrorKind};
use thiserror::Error;

/// What the exit codes mean, for `--help`.
pub(crate) const CODES: &str = "\
Exit codes:
  0   done
  1   permanent error: bad input, another picture
  3   incomplete: a part is missing or damaged
  4   different: `diff` found a difference
  5   undecided: `diff` cannot tell
  75  temporary error (EX_TEMPFAIL): the disk is full, a server does not answer, no more threads or
  memory are allowed; `task` after a signal
  141 the reader of standard output closed it before all data was written
  129, 130, 143  ended by SIGHUP (the terminal closed), SIGINT (Ctrl-C) or SIGTERM, except `task`";

/// What signals do to the commands that work in passes, for `--help`.
pub(crate) const SIGNALS: &str = "\
Ctrl-C (SIGINT), SIGTERM and a terminal that closes (SIGHUP) end the work after the passes that are complete: what was \
asked for is written of these, and the exit code is 130, 143 or 129. If no pass is complete, no file is written. A second \
SIGINT or SIGTERM ends the program at once. `nohup` keeps it going when the terminal closes.";

/// A temporary error: the program may succeed if it is run again (`EX_TEMPFAIL` of sysexits.h).
pub(crate) const TEMPORARY_FAILURE: u8 = 75;

/// Data went to a pipe whose reader has gone away: 128 and the number of SIGPIPE, as shells say it.
pub(crate) const CLOSED_PIPE: u8 = 141;

const PERMANENT_FAILURE: u8 = 1;
const INCOMPLETE: u8 = 3;
const DIFFERENT: u8 = 4;
const UNDECIDED: u8 = 5;

/// Something is missing, and nothing is written.
#[derive(Debug, Error)]
#[error("incomplete: {0}")]
pub(crate) struct Incomplete(pub(crate) String);

/// Pictures differ.
#[derive(Debug, Error)]
#[error("different: {0}")]
pub(crate) struct Differs(pub(crate) String);

/// Whether pictures differ cannot be told.
#[derive(Debug, Error)]
#[error("undecided: {0}")]
pub(crate) struct Undecided(pub(crate) String);

/// The exit code of an error other than a signal.
pub(crate) fn code_of(error: &anyhow::Error) -> u8 {
    if error.is::<Incomplete>() {
        return INCOMPLETE;
    }
    if error.is::<Differs>() {
        return DIFFERENT;
    }
    if error.is::<Undecided>() {
        return UNDECIDED;
    }
    if causes(error).any(|kind| kind == ErrorKind::BrokenPipe) {
        return CLOSED_PIPE;
    }
    if is_temporary(error) { TEMPORARY_FAILURE } else { PERMANENT_FAILURE }
}

/// The errors of the operating system that led to an error.
fn causes(error: &anyhow::Error) -> impl Iterator<Item = ErrorKind> {
    error.chain().filter_map(|cause| match cause.downcast_ref() {
        Some(CheckpointError::Read(kind)) => Some(*kind),
        _ => cause.downcast_ref::<io::Error>().map(io::Error::kind),
    })
}

/// Whether an error is temporary; of several errors, whether all are.
fn is_temporary(error: &anyhow::Error) -> bool {
    if let Some(failures) = error.downcast_ref::<Failures>() {
        return failures.errors().iter().all(is_temporary);
    }
    causes(error).any(is_temporary_kind) || lacks_threads(error) || lacks_memory(error)
}

/// Whether threads could not be started.
fn lacks_threads(error: &anyhow::Error) -> bool {
    let of_render = matches!(error.downcast_ref(), Some(RenderError::Threads(_)));
    of_render || matches!(error.downcast_ref(), Some(FactorError::Threads(_)))
}

/// Whether the memory of a picture is refused, which other machines may have.
fn lacks_memory(error: &anyhow::Error) -> bool {
    matches!(error.downcast_ref(), Some(RenderError::Memory { .. }))
}

/// Whether an error of the operating system is temporary.
fn is_temporary_kind(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::StorageFull
            | ErrorKind::QuotaExceeded
            | ErrorKind::StaleNetworkFileHandle
            | ErrorKind::HostUnreachable
            | ErrorKind::NetworkUnreachable
            | ErrorKind::NetworkDown
            | ErrorKind::TimedOut
            | ErrorKind::ResourceBusy
            | ErrorKind::Interrupted
            | ErrorKind::WouldBlock
            | ErrorKind::OutOfMemory
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context;
    use globillum::io::IoError;

    #[test]
    fn temporary_errors_are_found_below_others() {
        let write = |kind: ErrorKind| IoError::Write { path: "a".into(), source: kind.into() };
        let code = |kind| code_of(&Err::<(), _>(write(kind)).context("b").expect_err("it is one"));
        assert_eq!(code(ErrorKind::StorageFull), TEMPORARY_FAILURE);
        assert_eq!(code(ErrorKind::PermissionDenied), PERMANENT_FAILURE);
        assert_eq!(code(ErrorKind::BrokenPipe), CLOSED_PIPE);
        let read = |kind| anyhow::Error::from(CheckpointError::Read(kind)).context("a");
        let code = |kind| code_of(&read(kind));
        assert_eq!(code(ErrorKind::StaleNetworkFileHandle), TEMPORARY_FAILURE);
        assert_eq!(code(ErrorKind::UnexpectedEof), PERMANENT_FAILURE);
        let incomplete = anyhow::Error::from(Incomplete("a".into()));
        assert_eq!(code_of(&incomplete), INCOMPLETE);
    }

    #[test]
    fn several_errors_are_temporary_if_all_are() {
        use ErrorKind::{PermissionDenied, QuotaExceeded, StorageFull};
        for (kinds, code) in [
            ([StorageFull, QuotaExceeded], TEMPORARY_FAILURE),
            ([StorageFull, PermissionDenied], PERMANENT_FAILURE),
        ] {
            let mut failures = Failures::default();
            for kind in kinds {
                failures.keep::<(), _>(Err(io::Error::from(kind)));
            }
            let error = failures.into_result().expect_err("there are two");
            assert_eq!(code_of(&error), code);
        }
    }
}
