//! How much of a surface a ray stands for: its place on the film, and what is around it, seen from there.
//!
//! Source: Akenine-Möller et al., "Texture Level of Detail Strategies for Real-Time Ray Tracing", *Ray Tracing Gems*
//! (2019), ch. 20. Here a cone gets wider with the length of the way alone, as if all surfaces on it were flat.

use glam::{DVec2, DVec3};

/// How much surface coordinates with these gradients change across a square of a side of `width` at right angles to the unit
/// vector `dir`, seen on a surface with this unit normal: the mean square of both directions, in which it is the same
/// whichever these are.
///
/// What is seen in the direction a is at a − d (a·n)/(d·n) on the surface. So a coordinate whose gradient there is g has the
/// gradient g − n (g·d)/(n·d) on the square.
#[inline(always)]
pub(super) fn on_surface(width: f64, dir: DVec3, normal: DVec3, gradients: [DVec3; 2]) -> DVec2 {
    let aslant = normal / normal.dot(dir);
    let seen = |g: DVec3| (g - aslant * g.dot(dir)).length_squared();
    DVec2::from_array(gradients.map(seen)) * (0.5 * width * width)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Vec2;

    use super::*;
    use crate::{
        camera::Camera,
        geometry::{Mesh, Quad, Shape, Sphere, mesh::Attributes},
        math::random::SplitMix64,
    };

    /// Oracle: the surface coordinates that rays a hundredth of a pixel apart meet. Off the axis of the view pixels are no
    /// squares, but as large as the ones they are taken for.
    #[test]
    fn footprints_are_what_is_between_neighbouring_rays() {
        const APART: f64 = 0.01;
        let quad = Quad::try_new(
            DVec3::new(-9.0, -2.0, -9.0),
            DVec3::X * 18.0,
            DVec3::new(0.0, 1.0, 15.0),
        );
        let uvs = [[0.1, 0.3], [2.0, 0.2], [0.4, 5.0]].map(Vec2::from_array).to_vec();
        let corners =
            [[-8.0, -2.0, -5.0], [9.0, -3.0, -4.0], [0.0, 7.0, -9.0]].map(DVec3::from_array);
        let attributes = Attributes { uvs, ..Attributes::default() };
        let mesh = Mesh::try_new(corners.to_vec(), vec![[0, 1, 2]], attributes).expect("a mesh");
        let shapes: [Shape; 3] = [
            quad.expect("a quad").into(),
            Sphere::try_new(DVec3::ZERO, 3.0).expect("a sphere").into(),
            Arc::new(mesh).faces().next().expect("a face").into(),
        ];
        let camera = Camera::try_new(DVec3::new(1.0, 2.0, 8.0), DVec3::ZERO, DVec3::Y, 70.0);
        let view = camera.expect("a camera").view(20, 20);
        let mut random = SplitMix64::new(4);
        for shape in shapes {
            let mut met = 0;
            while met < 100 {
                let place = DVec2::new(random.uniform(), random.uniform()) * 20.0;
                let hit = |place: DVec2| shape.first_hit(0, &view.ray(place));
                let [x, y] = [DVec2::X, DVec2::Y].map(|axis| hit(place + axis * APART));
                let (Some((hit, surface)), Some((_, x)), Some((_, y))) = (hit(place), x, y) else {
                    continue;
                };
                let dir = view.direction(place);
                if surface.normal.dot(dir).abs() < 0.1 {
                    continue;
                }
                let width = f64::from(view.cone(1.0).width_along(dir)) * hit.t;
                let gradients = shape.uv_gradients();
                let across = on_surface(width, dir, surface.normal, gradients);
                let [x, y] = [x, y].map(|s| (s.uv - surface.uv) / APART);
                let expected = (x * x + y * y) * 0.5;
                let ratio = across / expected;
                assert!((0.7..1.4).contains(&ratio.x) && (0.7..1.4).contains(&ratio.y), "{ratio}");
                met += 1;
            }
        }
    }
}
