//! From a scene's description to what can be traced: every number checked, every name resolved.

use std::{
    collections::{BTreeMap, HashMap},
    sync::Arc,
};

use glam::DVec3;

use super::{
    desc::{EndsDesc, MaterialDesc, SceneDesc, ShapeDesc, TextureDesc},
    error::SceneError,
    parts::{CameraPlan, Parts},
};
use crate::{
    color::{Rgb, from_srgb},
    geometry::{
        Cone, Cylinder, Ends, Polygon, Quad, Shape, ShapeError, Sphere, Triangle,
        tetrahedron::tetrahedron,
    },
    light::Light,
    material::Material,
    texture::{Checker, Image, Plaid, Texture},
};

/// How the picture of a texture is found by its name.
pub type ImageSource<'a> = dyn FnMut(&str) -> Result<Image, SceneError> + 'a;

impl Parts {
    /// The parts of a description; `images` finds the pictures of its textures.
    ///
    /// # Errors
    /// What is wrong with the description.
    pub fn try_new(desc: &SceneDesc, images: &mut ImageSource) -> Result<Self, SceneError> {
        for (name, value) in
            [("resolution", desc.resolution[0].min(desc.resolution[1])), ("depth", desc.depth)]
        {
            let range = "at least 1";
            check("scene", name, f64::from(value), range, value >= 1)?;
        }
        let textures = textures(&desc.texture, images)?;
        let mut materials = Vec::new();
        let mut number_of = HashMap::new();
        for (name, material) in &desc.material {
            number_of.insert(name.as_str(), materials.len());
            materials.push(self::material(name, material, &textures)?);
        }
        let (mut shapes, mut material_of) = (Vec::new(), Vec::new());
        for (object, index) in desc.object.iter().zip(1..) {
            let Some(&number) = number_of.get(object.material.as_str()) else {
                let material = object.material.clone();
                return Err(SceneError::UnknownMaterial {
                    object: index,
                    material,
                    known: names(&desc.material),
                });
            };
            let (kind, made) = make_shapes(&object.shape);
            let made = made.map_err(|source| SceneError::Shape { object: index, kind, source })?;
            if materials[number].texture.needs_uv() && !made.iter().all(Shape::has_uv) {
                let material = object.material.clone();
                return Err(SceneError::NoSurfaceCoordinates { object: index, material });
            }
            material_of.extend(std::iter::repeat_n(number as u32, made.len()));
            shapes.extend(made);
        }
        let background = color("scene", "background", desc.background)?;
        Ok(Self {
            resolution: desc.resolution,
            depth: desc.depth,
            camera: CameraPlan {
                eye: DVec3::from_array(desc.camera.eye),
                look_at: DVec3::from_array(desc.camera.look_at),
                up: DVec3::from_array(desc.camera.up),
                vertical_fov: desc.camera.vertical_fov,
            },
            shapes,
            material_of,
            meshes: Vec::new(),
            materials,
            lights: lights(desc)?,
            background,
        })
    }
}

fn names<T>(map: &BTreeMap<String, T>) -> String {
    let names: Vec<&str> = map.keys().map(String::as_str).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

fn lights(desc: &SceneDesc) -> Result<Vec<Light>, SceneError> {
    let light = |(light, index): (&super::desc::LightDesc, usize)| {
        let place = format!("light {index}");
        for x in light.position {
            check(&place, "position", x, "finite", x.is_finite())?;
        }
        at_least_zero(&place, "intensity", light.intensity)?;
        let intensity = Rgb::splat(light.intensity as f32);
        Ok(Light { position: DVec3::from_array(light.position), intensity })
    };
    desc.light.iter().zip(1..).map(light).collect()
}

fn textures(
    descs: &BTreeMap<String, TextureDesc>,
    images: &mut ImageSource,
) -> Result<HashMap<String, Texture>, SceneError> {
    let mut textures = HashMap::new();
    for (name, desc) in descs {
        let place = format!("texture `{name}`");
        textures.insert(name.clone(), texture(&place, desc, images)?);
    }
    Ok(textures)
}

fn texture(
    place: &str,
    desc: &TextureDesc,
    images: &mut ImageSource,
) -> Result<Texture, SceneError> {
    let pattern = |origin: &[f64; 3], size: f64| {
        for &x in origin {
            check(place, "origin", x, "finite", x.is_finite())?;
        }
        check(place, "size", size, "positive and finite", size > 0.0 && size.is_finite())?;
        Ok::<_, SceneError>(DVec3::from_array(*origin))
    };
    Ok(match desc {
        TextureDesc::Checker { even, odd, origin, size } => Texture::Checker(Checker {
            even: color(place, "even", *even)?,
            odd: color(place, "odd", *odd)?,
            origin: pattern(origin, *size)?,
            size: *size,
        }),
        TextureDesc::Plaid { ground, stripe, origin, size } => {
            let mixed = std::array::from_fn(|k| f64::midpoint(ground[k], stripe[k]));
            Texture::Plaid(Plaid {
                ground: color(place, "ground", *ground)?,
                mixed: color(place, "stripe", mixed)?,
                stripe: color(place, "stripe", *stripe)?,
                origin: pattern(origin, *size)?,
                size: *size,
            })
        }
        TextureDesc::Image(name) => Texture::Image(Arc::new(images(name)?)),
    })
}

fn material(
    name: &str,
    desc: &MaterialDesc,
    textures: &HashMap<String, Texture>,
) -> Result<Material, SceneError> {
    let place = format!("material `{name}`");
    let texture = match &desc.texture {
        None => Texture::Solid(color(&place, "color", desc.color)?),
        Some(texture) => textures.get(texture).cloned().ok_or_else(|| {
            let mut known: Vec<&str> = textures.keys().map(String::as_str).collect();
            known.sort_unstable();
            SceneError::UnknownTexture {
                material: name.to_owned(),
                texture: texture.clone(),
                known: if known.is_empty() { "none".to_owned() } else { known.join(", ") },
            }
        })?,
    };
    for (parameter, weight) in [
        ("ambient", desc.ambient),
        ("diffuse", desc.diffuse),
        ("specular", desc.specular),
        ("reflection", desc.reflection),
        ("opacity", desc.opacity),
        ("transmission", desc.transmission),
    ] {
        at_least_zero(&place, parameter, f64::from(weight))?;
    }
    at_least_zero(&place, "shininess", desc.shininess)?;
    check(&place, "ior", desc.ior, "positive and finite", desc.ior > 0.0 && desc.ior.is_finite())?;
    let filter = color(&place, "transmission_color", desc.transmission_color)?;
    Ok(Material {
        texture,
        ambient: desc.ambient,
        diffuse: desc.diffuse,
        specular: desc.specular,
        shininess: desc.shininess,
        reflection: desc.reflection,
        opacity: desc.opacity,
        transmission: filter * desc.transmission,
        ior: desc.ior,
    })
}

/// The shapes that one object is made of, and what the object is called.
fn make_shapes(desc: &ShapeDesc) -> (&'static str, Result<Vec<Shape>, ShapeError>) {
    let v = DVec3::from_array;
    let one = |shape: Result<Shape, ShapeError>| shape.map(|shape| vec![shape]);
    let ends = |ends| match ends {
        EndsDesc::Open => Ends::Open,
        EndsDesc::Closed => Ends::Closed,
    };
    match desc {
        ShapeDesc::Sphere { center, radius } => {
            ("sphere", one(Sphere::try_new(v(*center), *radius).map(Shape::from)))
        }
        ShapeDesc::Cylinder { base, top, radius, ends: e } => (
            "cylinder",
            one(Cylinder::try_new(v(*base), v(*top), *radius, ends(*e)).map(Shape::from)),
        ),
        ShapeDesc::Cone { base, apex, radius, ends: e } => {
            ("cone", one(Cone::try_new(v(*base), v(*apex), *radius, ends(*e)).map(Shape::from)))
        }
        ShapeDesc::Quad { corner, edges: [edge1, edge2] } => {
            ("quad", one(Quad::try_new(v(*corner), v(*edge1), v(*edge2)).map(Shape::from)))
        }
        ShapeDesc::Triangle { vertices } => {
            ("triangle", one(Triangle::try_new(vertices.map(v)).map(Shape::from)))
        }
        ShapeDesc::Polygon { vertices } => (
            "polygon",
            one(Polygon::try_new(vertices.iter().copied().map(v).collect()).map(Shape::from)),
        ),
        ShapeDesc::Tetrahedron { base_center, edge, turn } => {
            let planes = tetrahedron(v(*base_center), *edge, turn.to_radians());
            ("tetrahedron", planes.map(|planes| planes.map(Shape::from).into()))
        }
    }
}

fn color(place: &str, name: &'static str, display: [f64; 3]) -> Result<Rgb, SceneError> {
    for value in display {
        check(place, name, value, "from 0 to 1 in each channel", (0.0..=1.0).contains(&value))?;
    }
    Ok(from_srgb(display))
}

fn at_least_zero(place: &str, name: &'static str, value: f64) -> Result<(), SceneError> {
    check(place, name, value, "zero or positive, and finite", value >= 0.0 && value.is_finite())
}

fn check(
    place: &str,
    name: &'static str,
    value: f64,
    range: &'static str,
    is_in: bool,
) -> Result<(), SceneError> {
    if is_in {
        Ok(())
    } else {
        Err(SceneError::Value { place: place.to_owned(), name, value, range })
    }
}
