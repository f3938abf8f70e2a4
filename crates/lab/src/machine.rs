//! The processor, command and date that are printed with figures, so that they can be reproduced.

/// The processor's model name; `None` where it is unknown.
pub(crate) fn cpu_model() -> Option<String> {
    let info = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = info.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// The command that runs `program` of this package with the current options.
pub(crate) fn command(program: &str) -> String {
    let options: Vec<_> = std::env::args().skip(1).collect();
    let separator = if options.is_empty() { "" } else { " -- " };
    format!("cargo run --release -p globillum-lab --bin {program}{separator}{}", options.join(" "))
}

/// Today's date in UTC, as `YYYY-MM-DD` (Hinnant, "chrono-compatible low-level date algorithms", 2013).
pub(crate) fn date() -> String {
    let since_1970 = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
    // Days since 1 March of the year 0. Leap days are the last days of such years; 400 years have 146097 days.
    let days = since_1970.as_secs() / 86_400 + 719_468;
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = (month_from_march + 2) % 12 + 1;
    let year = 400 * era + year_of_era + u64::from(month <= 2);
    format!("{year}-{month:02}-{day:02}")
}
