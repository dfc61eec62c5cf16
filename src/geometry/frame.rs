//! An orthonormal frame around a direction.

use glam::DVec3;

/// Right-handed orthonormal frame `(tangent, bitangent, normal)`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub tangent: DVec3,
    pub bitangent: DVec3,
    pub normal: DVec3,
}

impl Frame {
    /// A frame around the unit vector `normal`, continuous except at -z (Duff et al., JCGT 6(1), 2017).
    pub fn around(normal: DVec3) -> Self {
        let sign = 1.0_f64.copysign(normal.z);
        let a = -1.0 / (sign + normal.z);
        let b = normal.x * normal.y * a;
        Self {
            tangent: DVec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
            bitangent: DVec3::new(b, sign + normal.y * normal.y * a, -normal.y),
            normal,
        }
    }

    /// The direction with coordinates `local` in this frame.
    pub fn to_world(self, local: DVec3) -> DVec3 {
        self.tangent * local.x + self.bitangent * local.y + self.normal * local.z
    }
}
