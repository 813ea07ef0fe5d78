//! Whole pictures at extreme scales and places: every length of the scene times a power of two, or shifted.

use glam::{DVec2, DVec3};
use whitted::{
    Rgb,
    camera::Camera,
    geometry::{Ray, tetrahedron::tetrahedron},
    render::RenderOptions,
    scene::{
        Scene, builtin, builtins,
        desc::{ObjectDesc, SceneDesc, ShapeDesc, TextureDesc},
    },
};

use super::support::rendering;

fn assignment() -> SceneDesc {
    builtins()[0].desc().expect("a built-in scene")
}

fn ready(desc: &SceneDesc) -> Scene {
    Scene::try_new("assignment", desc, &mut builtin::picture).expect("a valid scene")
}

/// The scene with every point and every length changed: camera, lights and patterns too.
fn changed(
    mut desc: SceneDesc,
    point: impl Fn(f64, usize) -> f64,
    length: impl Fn(f64) -> f64,
) -> SceneDesc {
    let points = |p: &mut [f64; 3]| *p = [0, 1, 2].map(|k| point(p[k], k));
    let vector = |v: &mut [f64; 3]| *v = v.map(&length);
    points(&mut desc.camera.eye);
    points(&mut desc.camera.look_at);
    for light in &mut desc.light {
        points(&mut light.position);
    }
    for texture in desc.texture.values_mut() {
        match texture {
            TextureDesc::Checker { origin, size, .. } | TextureDesc::Plaid { origin, size, .. } => {
                points(origin);
                *size = length(*size);
            }
            TextureDesc::Image(_) => {}
        }
    }
    for object in &mut desc.object {
        match &mut object.shape {
            ShapeDesc::Sphere { center, radius } => {
                points(center);
                *radius = length(*radius);
            }
            ShapeDesc::Cylinder { base: a, top: b, radius, .. }
            | ShapeDesc::Cone { base: a, apex: b, radius, .. } => {
                points(a);
                points(b);
                *radius = length(*radius);
            }
            ShapeDesc::Frustum { .. } => panic!("the assignment has none"),
            ShapeDesc::Quad { corner, edges } => {
                points(corner);
                edges.iter_mut().for_each(vector);
            }
            ShapeDesc::Triangle { vertices } => vertices.iter_mut().for_each(points),
            ShapeDesc::Polygon { vertices } => vertices.iter_mut().for_each(points),
            ShapeDesc::Tetrahedron { base_center, edge, .. } => {
                points(base_center);
                *edge = length(*edge);
            }
        }
    }
    desc
}

/// Oracle: symmetry. Nothing but the unit of length has changed, by a power of two, so no rounding may change either.
#[test]
fn a_scaled_scene_is_the_same_picture() {
    let picture = |exponent: i32| {
        let unit = 2.0_f64.powi(exponent);
        let desc = changed(assignment(), |x, _| x * unit, |x| x * unit);
        let options = RenderOptions { size: Some([200, 200]), ..Default::default() };
        rendering(&ready(&desc), &options)
    };
    let unscaled = picture(0);
    let bits = |colors: &[Rgb]| -> Vec<[u32; 3]> {
        colors.iter().map(|c| c.to_array().map(f32::to_bits)).collect()
    };
    for exponent in [-498, -300, -20, 20, 300, 498] {
        let scaled = picture(exponent);
        assert_eq!(scaled.rays, unscaled.rays, "2^{exponent}");
        assert!(
            bits(scaled.film.pixels()) == bits(unscaled.film.pixels()),
            "2^{exponent}: other pixels"
        );
    }
}

/// Which object a pixel shows, and which lights reach it.
type Mask = Option<(u32, u8, [bool; 2])>;

/// The masks of a picture 100 pixels wide, the film shifted by `nudge` pixels.
fn masks(desc: &SceneDesc, nudge: DVec2) -> Vec<Mask> {
    let scene = ready(desc);
    let [eye, look_at] = [desc.camera.eye, desc.camera.look_at].map(DVec3::from_array);
    let camera =
        Camera::try_new(eye, look_at, DVec3::Y, desc.camera.vertical_fov).expect("a camera");
    let view = camera.view(100, 100);
    let centers =
        (0..100).flat_map(|y| (0..100).map(move |x| DVec2::new(f64::from(x), f64::from(y)) + 0.5));
    let mask = |place: DVec2| {
        let ray: Ray = view.ray(place + nudge);
        let (hit, surface) = scene.nearest(&ray)?;
        let inward = surface.normal.dot(ray.dir) > 0.0;
        let lit = [0, 1].map(|k| {
            let to_light = DVec3::from_array(desc.light[k].position) - surface.point;
            !scene.is_occluded(&surface.leave(&hit, to_light, inward), 1.0)
        });
        Some((hit.primitive, hit.face, lit))
    };
    centers.map(mask).collect()
}

/// The scene with the tetrahedron's planes as objects of their own, so that every coordinate stands in the description.
fn with_planes(mut desc: SceneDesc) -> SceneDesc {
    let last = desc.object.pop().expect("the tetrahedron comes last");
    let ShapeDesc::Tetrahedron { base_center, edge, turn } = last.shape else {
        panic!("the tetrahedron comes last");
    };
    let planes = tetrahedron(DVec3::from_array(base_center), edge, turn.to_radians())
        .expect("a tetrahedron");
    desc.object.extend(planes.map(|plane| ObjectDesc {
        material: last.material.clone(),
        shape: ShapeDesc::Triangle { vertices: plane.vertices().map(|v| v.to_array()) },
    }));
    desc
}

/// Oracle: symmetry. All coordinates are multiples of 2⁻¹⁴, so a shift by up to 2³⁸ rounds none of them; a pixel
/// is decided if its mask is the same a millionth of a pixel to each side.
#[test]
fn a_shifted_scene_has_the_same_objects_and_shadows() {
    let grid = 2.0_f64.powi(-14);
    let quantised = |x: f64| (x / grid).round() * grid;
    let desc = changed(with_planes(assignment()), |x, _| quantised(x), quantised);
    let still = masks(&desc, DVec2::ZERO);
    let around = [DVec2::X, -DVec2::X, DVec2::Y, -DVec2::Y].map(|step| masks(&desc, step * 1e-6));
    let decided: Vec<usize> =
        (0..still.len()).filter(|&i| around.iter().all(|masks| masks[i] == still[i])).collect();
    assert!(decided.len() > still.len() * 99 / 100, "only {} pixels are decided", decided.len());
    // The scene is about 2^8 long, so the shifts go up to 2^30 sizes.
    for exponent in [8, 18, 28, 38] {
        let shift = [1.0, -1.0, 1.0].map(|sign| sign * 2.0_f64.powi(exponent));
        let shifted = masks(&changed(desc.clone(), |x, k| x + shift[k], |x| x), DVec2::ZERO);
        for &i in &decided {
            assert_eq!(
                shifted[i],
                still[i],
                "pixel {}, {} shifted by 2^{exponent}",
                i % 100,
                i / 100
            );
        }
    }
}
