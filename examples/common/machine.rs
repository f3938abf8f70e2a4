//! Where figures come from: what those who repeat them need to know.

/// What the machine calls its processor, where that is known.
pub(crate) fn cpu_model() -> Option<String> {
    let info = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = info.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// The command that runs this example once more.
pub(crate) fn command(example: &str) -> String {
    let options: Vec<_> = std::env::args().skip(1).collect();
    let separator = if options.is_empty() { "" } else { " -- " };
    format!("cargo run --release --example {example}{separator}{}", options.join(" "))
}
