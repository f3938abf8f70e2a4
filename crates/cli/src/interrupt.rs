//! Signals that ask the program to end.

use crate::exit::TEMPORARY_FAILURE;
use globillum::integrator::Ending;
use globillum::io::LoadMonitor;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use thiserror::Error;

/// Whether the program was asked to end, by SIGINT (Ctrl-C), SIGTERM or [SIGHUP](hangup). The second SIGINT or SIGTERM ends
/// it at once.
#[derive(Debug)]
pub(crate) struct Interrupt {
    /// The last signal's number; 0 before the first.
    signal: Arc<AtomicUsize>,
    /// SIGHUP, if it is caught.
    hangup: Option<i32>,
    code: fn(i32) -> i32,
}

impl Interrupt {
    /// Catches signals from now on, in the whole process, which ends with 128 and the signal's number, as shells
    /// have it.
    pub(crate) fn catch() -> std::io::Result<Self> {
        Self::catch_with(|signal| 128 + signal)
    }

    /// Catches signals, after which the process ends with [`TEMPORARY_FAILURE`].
    pub(crate) fn catch_to_run_again() -> std::io::Result<Self> {
        Self::catch_with(|_| TEMPORARY_FAILURE.into())
    }

    fn catch_with(code: fn(i32) -> i32) -> std::io::Result<Self> {
        let (signal, caught) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicBool::new(false)));
        for number in [SIGINT, SIGTERM] {
            // They run in this order: what the first signal notes, the second finds.
            flag::register_conditional_shutdown(number, code(number), Arc::clone(&caught))?;
            flag::register(number, Arc::clone(&caught))?;
            flag::register_usize(number, Arc::clone(&signal), number as usize)?;
        }
        // By default, a write beyond the limit on a file's size ends the program. If its signal is caught, the write fails.
        #[cfg(unix)]
        flag::register(signal_hook::consts::SIGXFSZ, Arc::default())?;
        // A terminal that closes and its shell both send it: the second does not end the program at once.
        let hangup = hangup();
        if let Some(number) = hangup {
            flag::register_usize(number, Arc::clone(&signal), number as usize)?;
        }
        Ok(Self { signal, hangup, code })
    }

    /// Whether there was a signal.
    pub(crate) fn is_asked(&self) -> bool {
        self.signal.load(Ordering::Relaxed) != 0
    }

    /// The result of showing something: after SIGHUP nobody is left to see it, so a failure is no error.
    pub(crate) fn ignore_after_hangup(&self, result: anyhow::Result<()>) -> anyhow::Result<()> {
        let signal = self.signal.load(Ordering::Relaxed);
        if self.hangup.is_some_and(|number| number as usize == signal) { Ok(()) } else { result }
    }

    /// What cancelled a render: a signal, or else a checkpoint that could not be saved.
    pub(crate) fn canceller(&self) -> &'static str {
        if self.is_asked() { "a signal" } else { "a failed checkpoint" }
    }

    /// The error that ends the program after a signal; `kept` says what is left of its work.
    pub(crate) fn error(&self, kept: impl Into<String>) -> Interrupted {
        let signal = self.signal.load(Ordering::Relaxed) as i32;
        Interrupted { code: (self.code)(signal) as u8, kept: kept.into() }
    }

    /// Fails if a computation was cancelled; `kept` says what is left of its work.
    pub(crate) fn check_ending(&self, ending: Ending, kept: impl Into<String>) -> anyhow::Result<()> {
        match ending {
            Ending::Cancelled => Err(self.error(kept).into()),
            _ => Ok(()),
        }
    }

    /// Fails if there was a signal. To be asked while there is nothing yet to keep.
    pub(crate) fn check(&self) -> Result<(), Interrupted> {
        if self.is_asked() { Err(self.error(NOTHING)) } else { Ok(()) }
    }
}

/// SIGHUP, which a terminal sends that closes; `None` if it is ignored, as below `nohup`. Only Linux tells.
fn hangup() -> Option<i32> {
    #[cfg(target_os = "linux")]
    {
        use signal_hook::consts::SIGHUP;
        let status = std::fs::read_to_string("/proc/self/status").ok()?;
        let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"))?;
        let ignored = u64::from_str_radix(ignored.trim(), 16).ok()?;
        // Signals count from 1.
        (ignored >> (SIGHUP - 1) & 1 == 0).then_some(SIGHUP)
    }
    #[cfg(not(target_os = "linux"))]
    None
}

/// What is kept if nothing is complete.
pub(crate) const NOTHING: &str = "nothing is complete, so no file is written";

impl LoadMonitor for Interrupt {
    fn cancelled(&self) -> bool {
        self.is_asked()
    }
}

/// The program ends because a signal asked it to.
#[derive(Debug, Error)]
#[error("interrupted: {kept}")]
pub(crate) struct Interrupted {
    code: u8,
    kept: String,
}

impl Interrupted {
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(self.code)
    }
}
