//! Right-handed orthonormal frames about an axis.

use glam::DVec3;

use super::compensated::fused_dot;

/// Three unit vectors at right angles; `y` is the axis of a cylinder or cone.
///
/// An axis along a coordinate axis gives a frame of coordinate axes, so that changing to it is exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    x: DVec3,
    y: DVec3,
    z: DVec3,
}

impl Frame {
    /// The frame whose `y` is the unit vector `axis`.
    pub fn around(axis: DVec3) -> Self {
        let magnitude = axis.abs();
        // The coordinate axis that is furthest from `axis`, in an order that leaves the world's y axis unturned.
        let helper = if magnitude.x <= magnitude.y && magnitude.x <= magnitude.z {
            DVec3::X
        } else if magnitude.z <= magnitude.y {
            DVec3::Z
        } else {
            DVec3::Y
        };
        let z = helper.cross(axis).normalize();
        Self { x: axis.cross(z), y: axis, z }
    }

    /// The vector `v` of the surrounding space in this frame.
    #[inline(always)]
    pub fn to_local(self, v: DVec3) -> DVec3 {
        DVec3::new(fused_dot(self.x, v), fused_dot(self.y, v), fused_dot(self.z, v))
    }

    /// The vector of the surrounding space that is `v` in this frame.
    #[inline(always)]
    pub fn to_world(self, v: DVec3) -> DVec3 {
        DVec3::new(
            self.x.x.mul_add(v.x, self.y.x.mul_add(v.y, self.z.x * v.z)),
            self.x.y.mul_add(v.x, self.y.y.mul_add(v.y, self.z.y * v.z)),
            self.x.z.mul_add(v.x, self.y.z.mul_add(v.y, self.z.z * v.z)),
        )
    }

    /// The axis.
    pub fn axis(self) -> DVec3 {
        self.y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinate_axes_give_exact_frames() {
        for axis in [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z] {
            let frame = Frame::around(axis);
            for v in [frame.x, frame.y, frame.z] {
                assert!(
                    (v.abs().max_element() - 1.0).abs() == 0.0 && v.abs().element_sum() == 1.0,
                    "{axis}: {v}"
                );
            }
            let v = DVec3::new(0.1, -2.7, 31.4);
            assert_eq!(frame.to_world(frame.to_local(v)), v, "{axis}");
        }
    }

    #[test]
    fn frames_are_right_handed_and_orthonormal() {
        for axis in
            [DVec3::new(1.0, 2.0, 3.0), DVec3::new(-5.0, 0.1, 0.0), DVec3::new(1e-9, -1.0, 1e-9)]
        {
            let axis = axis.normalize();
            let Frame { x, y, z } = Frame::around(axis);
            assert!(
                (x.cross(y) - z).length() < 1e-15 && (y.cross(z) - x).length() < 1e-15,
                "{axis}"
            );
            assert_eq!(y, axis);
        }
    }
}
