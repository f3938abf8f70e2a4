use anyhow::Result;
use serde::Serialize;

/// The JSON of a file: indented, and ended by a line break.
pub(crate) fn to_json(value: &impl Serialize) -> Result<String> {
    Ok(serde_json::to_string_pretty(value)? + "\n")
}
