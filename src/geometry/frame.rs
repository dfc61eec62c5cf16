//! An orthonormal frame around a direction.

use std::f64::consts::TAU;

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

    /// A direction by the cosine to the normal, for `u` and `v` uniform in [0, 1).
    pub fn sampled_by_cosine(self, u: f64, v: f64) -> DVec3 {
        let (radius, (sin, cos)) = (u.sqrt(), (TAU * v).sin_cos());
        self.to_world(DVec3::new(radius * cos, radius * sin, (1.0 - u).sqrt()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_right_handed_and_orthonormal_also_at_the_poles() {
        let tilted = [1e-3, 1e-8, 1e-12, 1e-16, 1e-300].map(|t| DVec3::new(t, -t, -1.0).normalize());
        let others = [DVec3::Z, -DVec3::Z, DVec3::new(0.0, 0.0, -1.0), DVec3::X, -DVec3::Y, DVec3::new(1.0, 1.0, -0.0).normalize()];
        for normal in tilted.into_iter().chain(others) {
            let frame = Frame::around(normal);
            for (a, b, dot) in [
                (frame.tangent, frame.tangent, 1.0),
                (frame.bitangent, frame.bitangent, 1.0),
                (frame.tangent, frame.bitangent, 0.0),
                (frame.tangent, frame.normal, 0.0),
                (frame.bitangent, frame.normal, 0.0),
            ] {
                assert!((a.dot(b) - dot).abs() < 1e-15, "{normal}: {a}.{b}");
            }
            assert!(frame.tangent.cross(frame.bitangent).distance(normal) < 1e-15);
            assert_eq!(frame.to_world(DVec3::Z), normal);
        }
    }
}
