//! The pinhole camera: from a place on the film to a ray.

use glam::{DVec2, DVec3};
use thiserror::Error;

use crate::{
    geometry::{Ray, Similarity},
    math::scale,
};

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: DVec3,
    /// Unit vectors at right angles.
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    /// Half the height of the picture at distance 1.
    slope: f64,
}

/// Why a camera sees nothing.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A coordinate is infinite or not a number.
    #[error("the camera's `{name}` is ({value}), but must be finite")]
    NotFinite {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: DVec3,
    },
    /// The camera looks at the point it stands in.
    #[error("the camera's `eye` and `look_at` are both ({eye}), but must be apart")]
    NoDirection {
        /// Where both are.
        eye: DVec3,
    },
    /// The up vector does not tell which way is up.
    #[error("the camera's `up` ({up}) must not be zero or along the line of sight")]
    NoUp {
        /// The vector.
        up: DVec3,
    },
    /// The field of view is no angle that a pinhole can have.
    #[error("the camera's `vertical_fov` is {degrees} degrees, but must be between 0 and 180")]
    FieldOfView {
        /// The angle.
        degrees: f64,
    },
}

impl Camera {
    /// A camera at `eye` that looks at `look_at`, with a vertical field of view in degrees; `up` need not be at right
    /// angles to the line of sight.
    ///
    /// # Errors
    /// Parameters that are not finite or give no picture.
    pub fn try_new(
        eye: DVec3,
        look_at: DVec3,
        up: DVec3,
        vertical_fov: f64,
    ) -> Result<Self, CameraError> {
        for (name, value) in [("eye", eye), ("look_at", look_at), ("up", up)] {
            if !value.is_finite() {
                return Err(CameraError::NotFinite { name, value });
            }
        }
        let (sight, _) = scale::normalized(look_at * 0.5 - eye * 0.5);
        let forward = sight.try_normalize().ok_or(CameraError::NoDirection { eye })?;
        let (side, _) = scale::normalized(forward.cross(scale::normalized(up).0));
        let right = side.try_normalize().ok_or(CameraError::NoUp { up })?;
        if !(vertical_fov > 0.0 && vertical_fov < 180.0) {
            return Err(CameraError::FieldOfView { degrees: vertical_fov });
        }
        let slope = (vertical_fov.to_radians() / 2.0).tan();
        Ok(Self { eye, forward, right, up: right.cross(forward), slope })
    }

    /// The same camera in a scene whose coordinates were changed by `map`.
    #[must_use]
    pub fn mapped(self, map: &Similarity) -> Self {
        Self { eye: map.point(self.eye), ..self }
    }

    /// The camera with a film of so many pixels. Pixels are square; the field of view is that of the height.
    pub fn view(&self, width: u32, height: u32) -> View {
        let pixel = 2.0 * self.slope / f64::from(height);
        let (right, down) = (self.right * pixel, self.up * -pixel);
        let corner =
            self.forward - right * (f64::from(width) / 2.0) - down * (f64::from(height) / 2.0);
        View { eye: self.eye, corner, right, down, forward: self.forward }
    }
}

/// A camera with its film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    eye: DVec3,
    /// The direction through the upper left corner.
    corner: DVec3,
    /// The change of direction from a pixel to the next.
    right: DVec3,
    down: DVec3,
    /// The unit direction of the view's axis.
    forward: DVec3,
}

impl View {
    /// Where a point in front of the camera is on the film, in pixels as for [`View::ray`], and the length that a pixel
    /// covers there.
    pub fn place(&self, point: DVec3) -> Option<(DVec2, f64)> {
        let (pixel, to, depth) = (self.pixel(), point - self.eye, self.depth(point));
        if !(depth > 0.0) {
            return None;
        }
        let off = to / depth - self.corner;
        let place = DVec2::new(off.dot(self.right), off.dot(self.down)) / (pixel * pixel);
        Some((place, pixel * depth))
    }

    /// How far in front of the eye a point is, along the axis of the view; negative behind it.
    pub fn depth(&self, point: DVec3) -> f64 {
        (point - self.eye).dot(self.forward)
    }

    /// The length that a pixel covers at depth 1.
    pub fn pixel(&self) -> f64 {
        self.right.length()
    }

    /// What a ray stands for if that is a square of so many pixels a side.
    pub(crate) fn cone(&self, side: f64) -> Cone {
        Cone { axis: self.forward, width: self.pixel() * side }
    }

    /// The ray, of unit direction, through a place on the film in pixels from its upper left corner: the centre of the first
    /// pixel is (0.5, 0.5).
    pub fn ray(&self, position: DVec2) -> Ray {
        Ray::new(self.eye, self.direction(position))
    }

    /// The unit direction of that ray.
    #[inline(always)]
    pub fn direction(&self, position: DVec2) -> DVec3 {
        (self.corner + self.right * position.x + self.down * position.y).normalize()
    }

    /// Where all rays start.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }
}

/// What camera rays stand for: squares on the film around their places.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cone {
    /// The unit direction of the view's axis.
    axis: DVec3,
    /// The side of the squares at depth 1.
    width: f64,
}

impl Cone {
    /// The side of a square as large as what the ray along the unit vector `dir` stands for, at distance 1 and right angles
    /// to the ray: a square of the film with side w subtends w² cos³θ at the angle θ from the axis, where it is 1/cos θ away
    /// and seen aslant.
    #[inline(always)]
    pub(crate) fn width_along(&self, dir: DVec3) -> f32 {
        let cosine = dir.dot(self.axis);
        (self.width * cosine * cosine.abs().sqrt()) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assignment() -> Camera {
        let fov = 2.0 * (10.0_f64 / 40.0).atan().to_degrees();
        Camera::try_new(DVec3::ZERO, DVec3::NEG_Z, DVec3::Y, fov).expect("a camera")
    }

    /// Oracle: the direction that the scene's description gives, at corner pixels and others.
    #[test]
    fn rays_are_those_of_the_assignment() {
        let view = assignment().view(600, 600);
        for (i, j) in [(0, 0), (599, 0), (0, 599), (599, 599), (17, 402)] {
            let (x, y) = (f64::from(i) + 0.5, f64::from(j) + 0.5);
            let expected =
                DVec3::new(-10.0 + 20.0 * x / 600.0, 10.0 - 20.0 * y / 600.0, -40.0).normalize();
            let ray = view.ray(DVec2::new(x, y));
            assert!(
                (ray.dir - expected).length() < 4e-16 && ray.origin == DVec3::ZERO,
                "{i}, {j}: {}",
                ray.dir
            );
        }
    }

    /// Oracle: a ray through a place, and a point on it.
    #[test]
    fn points_are_found_at_their_places() {
        let camera =
            Camera::try_new(DVec3::new(3.0, 1.0, -2.0), DVec3::new(-5.0, 4.0, 9.0), DVec3::Y, 50.0);
        let view = camera.expect("a camera").view(320, 200);
        for (x, y, t) in
            [(0.5, 0.5, 1.0), (160.0, 100.0, 30.0), (319.0, 3.25, 7.5), (-40.0, 250.0, 2.0)]
        {
            let ray = view.ray(DVec2::new(x, y));
            let (place, pixel) = view.place(ray.at(t)).expect("in front");
            assert!((place - DVec2::new(x, y)).length() < 1e-9, "{place}");
            let beside = view.ray(DVec2::new(x + 1e-3, y));
            let forward = view.ray(DVec2::new(160.0, 100.0)).dir;
            let reach = t * ray.dir.dot(forward) / beside.dir.dot(forward);
            assert!(((beside.at(reach) - ray.at(t)).length() / 1e-3 / pixel - 1.0).abs() < 1e-6);
            assert!(view.place(ray.at(-t)).is_none());
        }
    }

    #[test]
    fn a_wide_film_sees_more_at_the_sides_only() {
        let (square, wide) = (assignment().view(100, 100), assignment().view(200, 100));
        let difference =
            square.ray(DVec2::new(30.5, 7.5)).dir - wide.ray(DVec2::new(80.5, 7.5)).dir;
        assert!(difference.length() < 4e-16);
    }

    #[test]
    fn cameras_that_see_nothing_are_refused() {
        let camera = |look_at, up, fov| Camera::try_new(DVec3::ZERO, look_at, up, fov).map(|_| ());
        assert!(matches!(
            camera(DVec3::ZERO, DVec3::Y, 40.0),
            Err(CameraError::NoDirection { .. })
        ));
        assert!(matches!(camera(DVec3::Y * 3.0, DVec3::Y, 40.0), Err(CameraError::NoUp { .. })));
        assert!(matches!(camera(DVec3::Z, DVec3::ZERO, 40.0), Err(CameraError::NoUp { .. })));
        assert!(matches!(camera(DVec3::Z, DVec3::Y, 180.0), Err(CameraError::FieldOfView { .. })));
        assert!(matches!(
            camera(DVec3::Z, DVec3::Y, f64::NAN),
            Err(CameraError::FieldOfView { .. })
        ));
        assert!(matches!(camera(DVec3::NAN, DVec3::Y, 40.0), Err(CameraError::NotFinite { .. })));
    }
}
