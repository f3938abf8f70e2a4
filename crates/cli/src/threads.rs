use anyhow::Result;
use globillum::integrator::RenderError;
use rayon::ThreadPoolBuilder;

/// Starts the threads that build scenes and merge parts: this many, or one for each processor if `count` is 0. To be called
/// once, before such work. Renders have threads of their own.
pub(crate) fn start(count: usize) -> Result<()> {
    let started = ThreadPoolBuilder::new().num_threads(count).build_global();
    started.map_err(|error| RenderError::Threads(error.to_string()).into())
}
