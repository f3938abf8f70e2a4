use std::panic::{AssertUnwindSafe, catch_unwind};

/// What `task` returns, or what it said when it panicked.
///
/// What a panic leaves behind half done, the caller must not rely on.
pub(crate) fn caught<T>(task: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(task)).map_err(|payload| {
        let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
        text.unwrap_or_else(|| "a panic without a message".to_owned())
    })
}
