//! From the entities of an NFF file to the parts of a scene.

use glam::DVec3;

use super::{NffCounts, NffError, NffScene, read::Reader, soup::Soup};
use crate::{
    color::{Rgb, from_srgb},
    geometry::{Cone, Cylinder, Ends, Inward, Polygon, Shape, Sphere, triangulate::Triangulator},
    light::Light,
    material::Material,
    scene::{
        parts::{CameraPlan, Parts},
        warning::Warning,
    },
    texture::Texture,
};

/// What a file may hold.
pub(super) const ENTITIES: [&str; 8] = ["v", "b", "l", "f", "s", "c", "p", "pp"];

/// The most corners of a polygon.
const MOST_CORNERS: u32 = 10_000;

/// The longest side of the picture that a file may ask for.
const LARGEST_SIDE: u32 = 1 << 16;

/// Radii of a cone that differ by less, relatively, make a cylinder.
const CYLINDER_TOLERANCE: f64 = 1e-9;

/// Levels of recursion, as in the package's own figures: rays of level 5 spawn none.
const DEPTH: u32 = 5;

#[derive(Clone, Copy, Debug)]
struct View {
    plan: CameraPlan,
    angle: f64,
    resolution: [u32; 2],
}

/// What was read so far.
#[derive(Debug, Default)]
pub(super) struct Builder {
    view: Option<View>,
    background: Rgb,
    lights: Vec<(DVec3, Option<Rgb>)>,
    materials: Vec<Material>,
    shapes: Vec<Shape>,
    material_of: Vec<u32>,
    flat: Soup,
    smooth: Soup,
    counts: NffCounts,
    /// How many shapes without size, and where the first is.
    dropped: Option<(u32, u32)>,
    triangulator: Triangulator,
}

impl Builder {
    /// Takes in the entity that `keyword` begins.
    pub(super) fn entity(&mut self, reader: &mut Reader, keyword: &str) -> Result<(), String> {
        match keyword {
            "v" => self.view(reader),
            "b" => {
                self.background = color(reader, "background")?;
                Ok(())
            }
            "l" => self.light(reader),
            "f" => self.surface(reader),
            "s" => self.sphere(reader),
            "c" => self.cone(reader),
            "p" => self.polygon(reader, false),
            "pp" => self.polygon(reader, true),
            _ => Err(format!("unknown entity `{keyword}`, must be v, b, l, f, s, c, p or pp")),
        }
    }

    fn view(&mut self, r: &mut Reader) -> Result<(), String> {
        if self.view.is_some() {
            return Err("a second view, but a file may have only one".to_owned());
        }
        r.expect("from")?;
        let eye = r.vector("from")?;
        r.expect("at")?;
        let look_at = r.vector("at")?;
        r.expect("up")?;
        let up = r.vector("up")?;
        r.expect("angle")?;
        let angle = r.number("angle")?;
        if !(angle > 0.0 && angle < 180.0) {
            return Err(format!("`angle` is {angle}, but must be between 0 and 180"));
        }
        r.expect("hither")?;
        r.number("hither")?; // for hidden-surface programs
        r.expect("resolution")?;
        let width = r.count("resolution", 1, LARGEST_SIDE)?;
        let height = r.count("resolution", 1, LARGEST_SIDE)?;
        let plan = CameraPlan { eye, look_at, up, vertical_fov: angle };
        plan.camera().map_err(|error| error.to_string())?;
        self.view = Some(View { plan, angle, resolution: [width, height] });
        Ok(())
    }

    fn light(&mut self, r: &mut Reader) -> Result<(), String> {
        let position = r.vector("position")?;
        let intensity = if r.number_follows() { Some(color(r, "intensity")?) } else { None };
        self.lights.push((position, intensity));
        self.counts.lights += 1;
        Ok(())
    }

    fn surface(&mut self, r: &mut Reader) -> Result<(), String> {
        let color = color(r, "color")?;
        let mut weight = |name: &str| match r.number(name)? {
            value if value >= 0.0 => Ok(value),
            value => Err(format!("`{name}` is {value}, but must be zero or positive")),
        };
        let (diffuse, specular) = (weight("Kd")? as f32, weight("Ks")? as f32);
        let (shininess, transmission) = (weight("shine")?, weight("T")? as f32);
        let ior = weight("index of refraction")?;
        if transmission > 0.0 && ior == 0.0 {
            return Err("the index of refraction is 0, but must be positive where T is".to_owned());
        }
        self.materials.push(Material {
            texture: Texture::Solid(color),
            diffuse,
            specular,
            shininess,
            reflection: specular,
            transmission: Rgb::splat(transmission),
            ior: if ior > 0.0 { ior } else { 1.0 },
            ..Material::none()
        });
        self.counts.surfaces += 1;
        Ok(())
    }

    /// The surface of the next shape: white until one is given.
    fn material(&mut self) -> u32 {
        if self.materials.is_empty() {
            self.materials.push(Material { diffuse: 1.0, ..Material::none() });
        }
        self.materials.len() as u32 - 1
    }

    fn push(&mut self, shape: Shape) {
        let material = self.material();
        self.shapes.push(shape);
        self.material_of.push(material);
    }

    fn drop_at(&mut self, line: u32) {
        self.dropped.get_or_insert((0, line)).0 += 1;
    }

    fn sphere(&mut self, r: &mut Reader) -> Result<(), String> {
        let (center, radius) = (r.vector("center")?, r.number("radius")?);
        self.counts.spheres += 1;
        if radius == 0.0 {
            self.drop_at(r.line());
            return Ok(());
        }
        let sphere = Sphere::try_new(center, radius.abs()).map_err(|e| e.to_string())?;
        self.push(seen(radius < 0.0, sphere.into()));
        Ok(())
    }

    fn cone(&mut self, r: &mut Reader) -> Result<(), String> {
        let (base, base_radius) = (r.vector("base")?, r.number("base radius")?);
        let (top, top_radius) = (r.vector("apex")?, r.number("apex radius")?);
        if base_radius * top_radius < 0.0 {
            return Err(format!(
                "the radii are {base_radius} and {top_radius}, but must be of the same sign"
            ));
        }
        let is_inward = base_radius < 0.0 || top_radius < 0.0;
        let (a, b) = (base_radius.abs(), top_radius.abs());
        let (wide, narrow) = (a.max(b), a.min(b));
        if wide == 0.0 || base == top {
            self.counts.cones += 1;
            self.drop_at(r.line());
            return Ok(());
        }
        let shape = if wide - narrow <= CYLINDER_TOLERANCE * wide {
            self.counts.cylinders += 1;
            Cylinder::try_new(base, top, wide, Ends::Open).map(Shape::from)
        } else {
            self.counts.cones += 1;
            match (a == 0.0, b == 0.0) {
                (false, true) => Cone::try_new(base, top, a, Ends::Open),
                (true, _) => Cone::try_new(top, base, b, Ends::Open),
                (false, false) => Cone::truncated(base, top, a, b),
            }
            .map(Shape::from)
        };
        let shape = shape.map_err(|error| error.to_string())?;
        self.push(seen(is_inward, shape));
        Ok(())
    }

    fn polygon(&mut self, r: &mut Reader, is_patch: bool) -> Result<(), String> {
        let count = r.count("corners", 3, MOST_CORNERS)?;
        let line = r.line();
        let (mut corners, mut normals) = (Vec::new(), Vec::new());
        for _ in 0..count {
            corners.push(r.vector("corner")?);
            if is_patch {
                normals.push(r.vector("normal")?);
            }
        }
        self.counts.max_corners = self.counts.max_corners.max(count);
        *(if is_patch { &mut self.counts.patches } else { &mut self.counts.polygons }) += 1;
        if !is_patch
            && count > 3
            && let Ok(polygon) = Polygon::try_new(corners.clone())
        {
            self.push(polygon.into());
            return Ok(());
        }
        let material = self.material();
        let soup = if is_patch { &mut self.smooth } else { &mut self.flat };
        if !soup.add(corners, &normals, material, &mut self.triangulator) {
            self.drop_at(line);
        }
        Ok(())
    }

    /// The scene, if nothing is missing.
    pub(super) fn finish(mut self, path: &str, rows: Option<u32>) -> Result<NffScene, NffError> {
        let missing =
            |reason: &str| NffError::Missing { path: path.to_owned(), reason: reason.to_owned() };
        let Some(view) = self.view else {
            return Err(missing("has no view (`v`)"));
        };
        let meshes = [std::mem::take(&mut self.flat), std::mem::take(&mut self.smooth)]
            .into_iter()
            .filter(|soup| !soup.is_empty())
            .map(Soup::mesh)
            .collect::<Result<Vec<_>, _>>()
            .map_err(|error| missing(&error.to_string()))?;
        if self.shapes.is_empty() && meshes.is_empty() {
            return Err(missing("contains nothing to render"));
        }
        let n = self.lights.len().max(1) as f32;
        let usual = n.sqrt() / (2.0 * n);
        for material in &mut self.materials {
            material.ambient = usual * material.diffuse;
        }
        let light = |(position, intensity): &(DVec3, Option<Rgb>)| Light {
            position: *position,
            intensity: intensity.unwrap_or(Rgb::splat(usual)),
        };
        let mut camera = view.plan;
        camera.vertical_fov = edge_to_edge(view.angle, rows.unwrap_or(view.resolution[1]));
        let dropped = self.dropped.map(|(count, line)| Warning {
            file: path.to_owned(),
            line,
            message: match count {
                1 => "dropped 1 shape without size".to_owned(),
                _ => format!("dropped {count} shapes without size (the first is here)"),
            },
        });
        Ok(NffScene {
            counts: self.counts,
            warnings: dropped.into_iter().collect(),
            parts: Parts {
                resolution: view.resolution,
                depth: DEPTH,
                cutoff: 0.0,
                aa: None,
                camera,
                lights: self.lights.iter().map(light).collect(),
                background: self.background,
                shapes: self.shapes,
                material_of: self.material_of,
                meshes,
                materials: self.materials,
            },
        })
    }
}

/// The shape, from inside only if that is how it is to be seen.
fn seen(is_inward: bool, shape: Shape) -> Shape {
    if is_inward { Inward::new(shape).into() } else { shape }
}

/// The angle from edge to edge, in degrees, if `angle` is the one between the centres of the outermost of `rows` rows.
fn edge_to_edge(angle: f64, rows: u32) -> f64 {
    let pitches = f64::from(rows.max(2)) - 1.0;
    let slope = (angle.to_radians() / 2.0).tan() * f64::from(rows.max(2)) / pitches;
    2.0 * slope.atan().to_degrees()
}

/// An sRGB colour; what is brighter than white goes on along the same curve.
fn color(r: &mut Reader, name: &str) -> Result<Rgb, String> {
    let display = r.vector(name)?;
    if display.min_element() < 0.0 {
        return Err(format!("`{name}` is ({display}), but no channel may be negative"));
    }
    Ok(from_srgb(display.to_array()))
}
