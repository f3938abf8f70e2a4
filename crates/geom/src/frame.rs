use glam::DVec3;

/// A right-handed orthonormal frame whose local `+z` axis is a surface normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The unit tangent, the local x axis.
    pub tangent: DVec3,
    /// The unit bitangent, the local y axis.
    pub bitangent: DVec3,
    /// The unit normal, the local z axis.
    pub normal: DVec3,
}

impl Frame {
    /// A frame around the unit vector `normal`, orthonormal to a few ulps; continuous in `normal` except
    /// where its z component changes sign (Duff et al., "Building an Orthonormal Basis, Revisited", JCGT
    /// 6(1), 2017).
    #[inline(always)]
    pub fn around(normal: DVec3) -> Self {
        let DVec3 { x, y, z } = normal;
        let sign = 1.0_f64.copysign(z);
        let a = -1.0 / (sign + z);
        let b = x * y * a;
        Self {
            tangent: DVec3::new(1.0 + sign * x * x * a, sign * b, -sign * x),
            bitangent: DVec3::new(b, sign + y * y * a, -y),
            normal,
        }
    }

    /// The local coordinates of the world-space vector `world`.
    #[inline(always)]
    pub fn to_local(&self, world: DVec3) -> DVec3 {
        DVec3::new(world.dot(self.tangent), world.dot(self.bitangent), world.dot(self.normal))
    }

    /// The world-space vector with the coordinates `local` in this frame.
    #[inline(always)]
    pub fn to_world(&self, local: DVec3) -> DVec3 {
        local.x * self.tangent + local.y * self.bitangent + local.z * self.normal
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn frames_are_orthonormal_and_right_handed(z in -1.0..=1.0f64, phi in 0.0..6.3f64) {
            let r = (1.0 - z * z).max(0.0).sqrt();
            let normal = DVec3::new(r * phi.cos(), r * phi.sin(), z);
            let f = Frame::around(normal);
            prop_assert!((f.tangent.cross(f.bitangent) - normal).length() < 1e-14);
            prop_assert!((f.tangent.length() - 1.0).abs() < 1e-14);
            let w = DVec3::new(0.3, -0.5, 0.7);
            prop_assert!((f.to_world(f.to_local(w)) - w).length() < 1e-14);
        }
    }

    #[test]
    fn the_poles_are_ordinary() {
        for normal in [DVec3::Z, -DVec3::Z, DVec3::new(0.0, 0.0, -1.0)] {
            let f = Frame::around(normal);
            assert_eq!(f.tangent.cross(f.bitangent), normal);
        }
    }
}
