//! The radiance of a path in a furnace: a closed room whose walls emit.

/// The radiance of a path of `bounces` bounces in a furnace of radiance 1 and albedo `rho`, summed in the order
/// of the path tracer, to the bit.
pub fn truncated_series(rho: f64, bounces: u32) -> f64 {
    let (mut radiance, mut throughput) = (0.0, 1.0);
    for _ in 0..=bounces {
        radiance += throughput;
        throughput *= rho;
    }
    radiance
}
