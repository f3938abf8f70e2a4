//! What a path gathers in a furnace: a closed room whose walls shine.

/// What a path of a furnace of radiance 1 and albedo `rho` gathers in `bounces` bounces, added up as
/// a path does it, to the bit.
pub fn truncated_series(rho: f64, bounces: u32) -> f64 {
    let (mut radiance, mut throughput) = (0.0, 1.0);
    for _ in 0..=bounces {
        radiance += throughput;
        throughput *= rho;
    }
    radiance
}
