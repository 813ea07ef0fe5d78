//! A camera that is moved by hand.

use glam::{DQuat, DVec2, DVec3};

use super::parts::CameraPlan;

/// The steepest look up or down, in degrees from the horizon: beyond it up would be undefined.
const STEEPEST: f64 = 89.0;
/// How much nearer or farther than at the start the camera may come.
const REACH: f64 = 1e6;

/// A camera that turns about a point which stays in the middle of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    start: CameraPlan,
    now: CameraPlan,
    /// From the eye to the point, at the start.
    distance: f64,
}

impl Orbit {
    /// A camera that starts as `plan`, which sees something, and turns about the point on its line of sight at
    /// `distance`, such as that of the nearest surface; about the one it looks at if the distance is not positive and
    /// finite.
    pub fn new(plan: CameraPlan, distance: Option<f64>) -> Self {
        let own = (plan.look_at - plan.eye).length();
        let distance = distance.filter(|d| *d > 0.0 && d.is_finite()).unwrap_or(own);
        Self { start: plan, now: plan, distance }
    }

    /// The camera as it is now; the one at the start, bit for bit, until it is moved.
    pub fn plan(&self) -> &CameraPlan {
        &self.now
    }

    /// Back to the start.
    pub fn reset(&mut self) {
        self.now = self.start;
    }

    /// From the point in the middle to the eye.
    fn back(&self) -> DVec3 {
        let away = self.now.eye - self.now.look_at;
        if self.now == self.start { away.normalize_or_zero() * self.distance } else { away }
    }

    /// Unit vectors to the right and up in the picture.
    fn sides(&self) -> [DVec3; 2] {
        let back = self.back();
        let right =
            self.now.up.cross(back).normalize_or(back.any_orthogonal_vector().normalize_or_zero());
        [right, back.cross(right).normalize_or_zero()]
    }

    fn go(&mut self, pivot: DVec3, back: DVec3) {
        let plan = CameraPlan { eye: pivot + back, look_at: pivot, ..self.now };
        if plan.camera().is_ok() {
            self.now = plan;
        }
    }

    /// Turns about the point in the middle: to the side about the up direction, and upwards, in degrees; no further up
    /// or down than almost along the up direction.
    pub fn turn(&mut self, aside: f64, upwards: f64) {
        let (back, up) = (self.back(), self.now.up.normalize_or(DVec3::Y));
        let pivot = self.now.eye - back;
        let length = back.length();
        let [right, picture_up] = self.sides();
        let level = right.cross(up).normalize_or(picture_up);
        let sine = (back.dot(up) / length).clamp(-1.0, 1.0);
        let height = (sine.asin().to_degrees() + upwards).clamp(-STEEPEST, STEEPEST).to_radians();
        let level = DQuat::from_axis_angle(up, aside.to_radians()) * level;
        self.go(pivot, (level * height.cos() + up * height.sin()) * length);
    }

    /// Multiplies the distance from the point in the middle by `factor`, within bounds.
    pub fn zoom(&mut self, factor: f64) {
        let back = self.back();
        let pivot = self.now.eye - back;
        let length = (back.length() * factor).clamp(self.distance / REACH, self.distance * REACH);
        self.go(pivot, back.normalize_or_zero() * length);
    }

    /// Moves eye and point alike, so that what is in the middle is displaced on the picture by `by`, in picture
    /// heights, to the right and up.
    pub fn pan(&mut self, by: DVec2) {
        let back = self.back();
        let [right, up] = self.sides();
        let height = 2.0 * back.length() * (self.now.vertical_fov.to_radians() / 2.0).tan();
        let pivot = self.now.eye - back - (right * by.x + up * by.y) * height;
        self.go(pivot, back);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(up: DVec3) -> CameraPlan {
        let (eye, look_at) = (DVec3::new(3.0, 2.0, 8.0), DVec3::new(2.5, 2.0, 7.0));
        CameraPlan { eye, look_at, up, vertical_fov: 40.0 }
    }

    /// The point that stays in the middle.
    fn pivot(plan: &CameraPlan, distance: f64) -> DVec3 {
        plan.eye + (plan.look_at - plan.eye).normalize() * distance
    }

    /// Oracle: what turning is: same distance, same point in the middle, and four right angles are none.
    #[test]
    fn turns_keep_the_point_and_the_distance() {
        for up in [DVec3::Y, DVec3::Z * 7.0, DVec3::new(1.0, 2.0, -0.5)] {
            let mut orbit = Orbit::new(plan(up), Some(5.0));
            let point = pivot(&plan(up), 5.0);
            assert_eq!(*orbit.plan(), plan(up));
            for (aside, upwards) in
                [(90.0, 0.0), (33.0, 50.0), (-123.0, 1000.0), (0.0, -1e4), (10.0, 30.0)]
            {
                orbit.turn(aside, upwards);
                assert!((orbit.plan().look_at - point).length() < 1e-9);
                assert!((orbit.plan().eye.distance(point) - 5.0).abs() < 1e-9);
                assert!(orbit.plan().camera().is_ok());
            }
            orbit.reset();
            let eye = orbit.plan().eye;
            for _ in 0..4 {
                let before = orbit.plan().eye;
                orbit.turn(90.0, 0.0);
                assert!(before.distance(orbit.plan().eye) > 0.5, "{up}");
            }
            assert!(eye.distance(orbit.plan().eye) < 1e-9, "{up}: {}", orbit.plan().eye);
        }
    }

    /// Oracle: where the camera itself puts a point that does not move.
    #[test]
    fn what_is_turned_moved_or_neared_shows_it_on_the_picture() {
        let start = Orbit::new(plan(DVec3::Y), Some(5.0));
        let point = pivot(&plan(DVec3::Y), 5.0);
        let place = |orbit: &Orbit, p: DVec3| {
            orbit.plan().camera().expect("a camera").view(100, 100).place(p).expect("in front")
        };
        let mut moved = start;
        moved.pan(DVec2::new(0.25, 0.1));
        assert!((place(&moved, point).0 - DVec2::new(75.0, 40.0)).length() < 1e-6);
        let mut near = start;
        near.zoom(0.5);
        assert!((place(&near, point).1 / place(&start, point).1 - 0.5).abs() < 1e-9);
        // A point in front of the middle goes to the left, and down, when the eye goes to the right, and up.
        let front = point + (start.plan().eye - point) * 0.2;
        let mut turned = start;
        turned.turn(10.0, 5.0);
        let by = place(&turned, front).0 - place(&start, front).0;
        assert!(by.x < -1.0 && by.y > 0.5, "{by}");
        near.zoom(0.0);
        near.zoom(f64::NAN);
        assert!(near.plan().camera().is_ok());
    }

    #[test]
    fn a_camera_that_looks_straight_down_can_be_turned() {
        let plan = CameraPlan {
            eye: DVec3::Y * 10.0,
            look_at: DVec3::ZERO,
            up: DVec3::new(1e-4, 1.0, 0.0),
            vertical_fov: 40.0,
        };
        let mut orbit = Orbit::new(plan, None);
        orbit.turn(20.0, -30.0);
        assert!((orbit.plan().eye.length() - 10.0).abs() < 1e-9 && orbit.plan().eye.y < 9.0);
    }
}
