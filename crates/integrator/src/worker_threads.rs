use rayon::{ThreadPool, ThreadPoolBuilder};

/// This many worker threads, or one for each processor if `count` is 0. Fails with what the operating system says.
pub(crate) fn worker_threads(count: usize) -> Result<ThreadPool, String> {
    ThreadPoolBuilder::new().num_threads(count).build().map_err(|error| error.to_string())
}
