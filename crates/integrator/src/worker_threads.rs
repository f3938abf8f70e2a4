use rayon::ThreadPoolBuilder;
use std::panic::resume_unwind;
use std::thread;

/// Runs `work` in this many worker threads, or one for each processor if `count` is 0, and waits for it. Fails with what
/// the operating system says.
pub(crate) fn run_in_threads<R: Send>(count: usize, work: impl FnOnce() -> R + Send) -> Result<R, String> {
    let pool = ThreadPoolBuilder::new().num_threads(count).build().map_err(|error| error.to_string())?;
    if rayon::current_thread_index().is_none() {
        return Ok(pool.install(work));
    }
    // A worker of the caller's pool would not wait: it would take up other jobs of that pool, on the same stack, each of
    // which may come here. So another thread waits for the work, and the worker for this thread.
    thread::scope(|scope| {
        let waiting = thread::Builder::new().spawn_scoped(scope, || pool.install(work));
        let waiting = waiting.map_err(|error| error.to_string())?;
        Ok(waiting.join().unwrap_or_else(|panic| resume_unwind(panic)))
    })
}
