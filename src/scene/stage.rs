//! A stage for a model that comes alone: a floor, two lights, and a camera that sees all of it.

use glam::DVec3;

use super::{
    obj::Model,
    parts::{CameraPlan, Parts, Placement},
};
use crate::{
    color::{Rgb, from_srgb},
    geometry::{Bounds, Quad, Shape, ShapeError},
    light::Light,
    material::Material,
    texture::Texture,
};

/// The angle between the lower and upper edge of the picture, in degrees.
const FIELD_OF_VIEW: f64 = 30.0;

/// The picture, the depth of recursion and the background are those of the assignment scene.
const RESOLUTION: [u32; 2] = [600, 600];
const DEPTH: u32 = 6;
const BACKGROUND: [f64; 3] = [0.62, 0.76, 0.92];

/// The scene of `model` on a floor square to `up`, seen by a camera with `fov` degrees if that is given.
///
/// # Errors
/// The model is too small or too large for a floor beneath it.
pub(super) fn stage(model: Model, up: DVec3, fov: Option<f64>) -> Result<Parts, ShapeError> {
    let bounds = model.mesh.bounds();
    let vertical_fov = fov.unwrap_or(FIELD_OF_VIEW);
    let camera = fitted(&bounds, up, vertical_fov);
    let [right, up, front] = axes(up);
    let center = bounds.center();
    let radius = bounds.extent().length() / 2.0;

    let mut parts = Parts {
        resolution: RESOLUTION,
        depth: DEPTH,
        cutoff: 0.0,
        aa: None,
        camera,
        shapes: Vec::new(),
        material_of: Vec::new(),
        meshes: Vec::new(),
        materials: vec![floor_material()],
        lights: Vec::new(),
        background: from_srgb(BACKGROUND),
    };
    // Just below the model, whose own lowest faces would flicker in the same plane.
    let height = corners(&bounds).map(|p| (p - center).dot(up)).fold(0.0, f64::min);
    let middle = center + up * (height - radius / 1000.0);
    let half = radius * 30.0;
    let corner = middle + (front - right) * half;
    let floor = Quad::try_new(corner, right * (2.0 * half), front * (-2.0 * half))?;
    parts.shapes.push(Shape::from(floor));
    parts.material_of.push(0);
    for (direction, intensity) in [((-3.0, 5.0, 4.0), 0.75), ((5.0, 4.0, 2.0), 0.45)] {
        let (x, y, z) = direction;
        let position = center + (right * x + up * y + front * z) * radius;
        parts.lights.push(Light { position, intensity: Rgb::splat(intensity) });
    }
    parts.add_model(model, &Placement::NONE);
    Ok(parts)
}

fn floor_material() -> Material {
    Material {
        texture: Texture::Solid(from_srgb([0.82, 0.80, 0.76])),
        ambient: 0.2,
        diffuse: 0.8,
        ..Material::none()
    }
}

/// Right, up and the side from which a model is usually seen: +z if up is y, −y if up is z.
fn axes(up: DVec3) -> [DVec3; 3] {
    let up = up.normalize_or(DVec3::Y);
    let front = if up.z.abs() < 0.8 { DVec3::Z } else { DVec3::NEG_Y };
    let right = up.cross(front).normalize_or(DVec3::X);
    [right, up, right.cross(up)]
}

fn corners(bounds: &Bounds) -> impl Iterator<Item = DVec3> + use<> {
    let Bounds { min, max } = *bounds;
    let pick = move |bit: u32, low: f64, high: f64| if bit == 0 { low } else { high };
    (0..8_u32).map(move |k| {
        let [x, y, z] = [k & 1, k >> 1 & 1, k >> 2];
        DVec3::new(pick(x, min.x, max.x), pick(y, min.y, max.y), pick(z, min.z, max.z))
    })
}

/// A camera in front of the box, a little to the right and above, in whose picture all of it fits.
fn fitted(bounds: &Bounds, up: DVec3, vertical_fov: f64) -> CameraPlan {
    let [right, up, front] = axes(up);
    let back = (right * 0.45 + up * 0.4 + front).normalize();
    let side = up.cross(back).normalize();
    let top = back.cross(side);
    let center = bounds.center();
    let slope = (vertical_fov.to_radians() / 2.0).tan().abs().max(1e-3) * 0.9; // a margin
    let distance = corners(bounds)
        .map(|p| {
            let q = p - center;
            q.dot(back) + q.dot(side).abs().max(q.dot(top).abs()) / slope
        })
        .fold(0.0, f64::max);
    CameraPlan { eye: center + back * distance, look_at: center, up, vertical_fov }
}

/// A place for a model in a scene: on the floor in front of the middle of the picture, where nothing else
/// stands; at the origin, as large as it is, where there is nothing at all.
pub(super) fn free_place(parts: &Parts, size_of_model: DVec3, size: Option<f64>) -> (DVec3, f64) {
    let bounds = parts.bounds();
    let largest = size_of_model.max_element();
    if bounds.is_empty() {
        return (DVec3::ZERO, size.map_or(1.0, |size| size / largest));
    }
    let extent = bounds.extent().max_element();
    let scale = size.unwrap_or(extent / 16.0) / largest;
    let size = size_of_model * scale;
    let CameraPlan { eye, look_at, vertical_fov, .. } = parts.camera;
    let forward = DVec3::new(look_at.x - eye.x, 0.0, look_at.z - eye.z).normalize_or(DVec3::NEG_Z);
    let side = DVec3::new(-forward.z, 0.0, forward.x);
    let sight = (look_at - eye).normalize_or(forward);
    let top = side.cross(sight);
    let slope = (vertical_fov.to_radians() / 2.0).tan() * 0.95;
    let floor = bounds.min.y;
    // What spans most of the scene is the floor or a wall, not something that stands in the way.
    let obstacles: Vec<Bounds> = parts
        .shapes
        .iter()
        .map(Shape::bounds)
        .chain(parts.meshes.iter().map(|part| part.mesh.bounds()))
        .filter(|b| b.size() < extent / 2.0)
        .collect();
    let middle = obstacles.iter().fold(Bounds::EMPTY, |all, b| all.union(*b));
    let middle = if middle.is_empty() { bounds.center() } else { middle.center() };
    let base = DVec3::new(middle.x, floor, middle.z);
    let mut best = (f64::INFINITY, base);
    for step in 0..24 {
        for lane in -12..=12 {
            let along = f64::from(step) / 24.0;
            let reach = (middle - eye).dot(forward).max(extent / 8.0);
            let at = base - forward * (reach * along) + side * (extent * f64::from(lane) / 40.0);
            let half = DVec3::new(size.x, 0.0, size.z) / 2.0;
            let room = Bounds { min: at - half * 1.2, max: at + half * 1.2 + DVec3::Y * size.y };
            let overlaps = |b: &Bounds| b.min.cmplt(room.max).all() && room.min.cmplt(b.max).all();
            let is_seen = |p: DVec3| {
                let q = p - eye;
                let depth = q.dot(sight);
                q.dot(side).abs() < slope * depth && q.dot(top).abs() < slope * depth
            };
            if !corners(&room).all(is_seen) || obstacles.iter().any(overlaps) {
                continue;
            }
            // In front of the things, but not so near that it hides them.
            let cost = (along - 0.35).abs() * 4.0 + f64::from(lane).abs() / 12.0;
            if cost < best.0 {
                best = (cost, at);
            }
        }
    }
    (best.1, scale)
}

/// The lowest middle of a box, by which a model stands.
pub(super) fn foot(bounds: &Bounds) -> DVec3 {
    let center = bounds.center();
    DVec3::new(center.x, bounds.min.y, center.z)
}
