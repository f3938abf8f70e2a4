/// The sRGB encoding of a linear component, both in `[0, 1]` (IEC 61966-2-1).
pub(crate) fn encode(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        let known = [
            (0.0, 0.0),
            (0.001, 0.01292),
            (0.003_130_8, 0.040_449_94),
            (0.18, 0.461_356),
            (0.214_041_14, 0.5),
            (0.5, 0.735_357),
            (1.0, 1.0),
        ];
        for (linear, encoded) in known {
            assert!((encode(linear) - encoded).abs() < 1e-6, "{linear}");
        }
    }

    #[test]
    fn the_two_pieces_meet() {
        let joint = 0.003_130_8_f64;
        assert!((encode(joint.next_up()) - encode(joint)).abs() < 1e-7);
    }
}
