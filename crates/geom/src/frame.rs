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
