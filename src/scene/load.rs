//! From a scene's description to what can be traced: every number checked, every name resolved.

use std::{
    collections::{BTreeMap, HashMap},
    sync::Arc,
};

use glam::{DMat3, DVec3};

use super::{
    desc::{ColorSpace, MaterialDesc, ModelDesc, SceneDesc, TextureDesc},
    error::SceneError,
    format::Place,
    obj::Model,
    parts::{CameraPlan, MeshPart, Parts, Placement},
    shapes::make_shapes,
};
use crate::{
    aa::AntiAliasing,
    color::{Rgb, from_srgb},
    geometry::Shape,
    light::Light,
    material::Material,
    texture::{Checker, Image, Plaid, Texture},
};

/// How the picture of a texture is found by its name.
pub type ImageSource<'a> = dyn FnMut(&str) -> Result<Image, SceneError> + 'a;

/// How the model of a file is found by the file's name.
pub type ModelSource<'a> = dyn FnMut(&str) -> Result<Model, SceneError> + 'a;

/// What was found wrong with a description, and where.
type Found = Vec<(Place, SceneError)>;

impl Parts {
    /// The parts of a description without models; `images` finds the pictures of its textures.
    ///
    /// # Errors
    /// The first thing that is wrong with the description.
    pub fn try_new(desc: &SceneDesc, images: &mut ImageSource) -> Result<Self, SceneError> {
        let mut no_models =
            |name: &str| Err(SceneError::ModelWithoutFile { name: name.to_owned() });
        match Self::gather(desc, images, &mut no_models) {
            Ok(parts) => Ok(parts),
            Err(found) => Err(found.into_iter().next().map_or(SceneError::Empty, |(_, e)| e)),
        }
    }

    /// The parts of a description; `images` and `models` find what it names.
    ///
    /// # Errors
    /// All that is wrong with the description, and where.
    pub fn gather(
        desc: &SceneDesc,
        images: &mut ImageSource,
        models: &mut ModelSource,
    ) -> Result<Self, Vec<(Place, SceneError)>> {
        let mut found = Vec::new();
        for (name, value) in
            [("resolution", desc.resolution[0].min(desc.resolution[1])), ("depth", desc.depth)]
        {
            let range = "at least 1";
            note(
                &mut found,
                || Place::Scene(name),
                check("scene", name, value.into(), range, value >= 1),
            );
        }
        let cutoff = at_least_zero("scene", "cutoff", f64::from(desc.cutoff));
        note(&mut found, || Place::Scene("cutoff"), cutoff);
        let camera = CameraPlan {
            eye: DVec3::from_array(desc.camera.eye),
            look_at: DVec3::from_array(desc.camera.look_at),
            up: DVec3::from_array(desc.camera.up),
            vertical_fov: desc.camera.vertical_fov,
        };
        let seeing = camera.camera().map_err(SceneError::from);
        note(&mut found, || Place::Scene("camera"), seeing);
        let background = color("scene", "background", desc.background, desc.color_space);
        let background = note(&mut found, || Place::Scene("background"), background);
        let aa = desc.aa.as_ref().map(|mode| {
            mode.parse::<AntiAliasing>()
                .map_err(|reason| SceneError::Aa { mode: mode.clone(), reason: reason.to_string() })
        });
        let aa = aa.and_then(|aa| note(&mut found, || Place::Scene("aa"), aa));
        let lights = lights(desc, &mut found);
        let textures = textures(desc, images, &mut found);
        let materials = Materials::new(desc, &textures, &mut found);
        let (shapes, material_of) = objects(desc, &materials, &mut found);
        let mut parts = Self {
            resolution: desc.resolution,
            depth: desc.depth,
            cutoff: desc.cutoff,
            aa,
            camera,
            shapes,
            material_of,
            meshes: Vec::new(),
            materials: Vec::new(),
            lights,
            background: background.unwrap_or_default(),
        };
        let placed: Vec<_> = desc
            .model
            .iter()
            .enumerate()
            .filter_map(|(k, model)| {
                let made = self::model(model, &materials, models);
                note(&mut found, || Place::Model(k), made)
            })
            .collect();
        if !found.is_empty() {
            return Err(found);
        }
        parts.materials = materials.list;
        for (model, placement, material) in placed {
            match material {
                None => parts.add_model(model, &placement),
                Some(material) => {
                    let mesh = placement.placed(model.mesh);
                    let material_of = vec![material; mesh.triangles().len()];
                    parts.meshes.push(MeshPart { mesh, material_of });
                }
            }
        }
        Ok(parts)
    }
}

/// The value, or a note of why there is none.
fn note<T>(
    found: &mut Found,
    place: impl Fn() -> Place,
    result: Result<T, SceneError>,
) -> Option<T> {
    result.map_err(|error| found.push((place(), error))).ok()
}

/// The materials of a description by name; one that is wrong still has its number.
struct Materials<'a> {
    list: Vec<Material>,
    number_of: HashMap<&'a str, u32>,
    known: String,
}

impl<'a> Materials<'a> {
    fn new(desc: &'a SceneDesc, textures: &HashMap<String, Texture>, found: &mut Found) -> Self {
        let (mut list, mut number_of) = (Vec::new(), HashMap::new());
        for (name, material) in &desc.material {
            number_of.insert(name.as_str(), list.len() as u32);
            let made = self::material(name, material, textures, desc);
            let made = note(found, || Place::Material(name.clone()), made);
            list.push(made.unwrap_or_else(Material::none));
        }
        Self { list, number_of, known: names(&desc.material) }
    }

    fn number(&self, material: &str, object: usize) -> Result<u32, SceneError> {
        self.number_of.get(material).copied().ok_or_else(|| SceneError::UnknownMaterial {
            object,
            material: material.to_owned(),
            known: self.known.clone(),
        })
    }
}

fn objects(desc: &SceneDesc, materials: &Materials, found: &mut Found) -> (Vec<Shape>, Vec<u32>) {
    let (mut shapes, mut material_of) = (Vec::new(), Vec::new());
    for (k, object) in desc.object.iter().enumerate() {
        let index = k + 1;
        let mut make = || {
            let number = materials.number(&object.material, index)?;
            let (kind, made) = make_shapes(&object.shape);
            let made = made.map_err(|source| SceneError::Shape { object: index, kind, source })?;
            let needs_uv = materials.list[number as usize].texture.needs_uv();
            if needs_uv && !made.iter().all(Shape::has_uv) {
                let material = object.material.clone();
                return Err(SceneError::NoSurfaceCoordinates { object: index, material });
            }
            material_of.extend(std::iter::repeat_n(number, made.len()));
            shapes.extend(made);
            Ok(())
        };
        let made = make();
        note(found, || Place::Object(k), made);
    }
    (shapes, material_of)
}

fn model(
    desc: &ModelDesc,
    materials: &Materials,
    models: &mut ModelSource,
) -> Result<(Model, Placement, Option<u32>), SceneError> {
    let material = desc.material.as_deref().map(|name| materials.number(name, 0)).transpose()?;
    let [x, y, z] = desc.rotate.map(f64::to_radians);
    let turn = if desc.rotate == [0.0; 3] {
        DMat3::IDENTITY
    } else {
        DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x)
    };
    let placement = Placement { scale: desc.scale, turn, shift: DVec3::from_array(desc.translate) };
    let model = models(&desc.file)?;
    placement.check(&desc.file, &model)?;
    Ok((model, placement, material))
}

fn names<T>(map: &BTreeMap<String, T>) -> String {
    let names: Vec<&str> = map.keys().map(String::as_str).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

fn lights(desc: &SceneDesc, found: &mut Found) -> Vec<Light> {
    let light = |light: &super::desc::LightDesc, index: usize| {
        let place = format!("light {index}");
        for x in light.position {
            check(&place, "position", x, "finite", x.is_finite())?;
        }
        at_least_zero(&place, "intensity", light.intensity)?;
        let intensity = Rgb::splat(light.intensity as f32);
        Ok(Light { position: DVec3::from_array(light.position), intensity })
    };
    let lights = desc.light.iter().enumerate();
    lights.filter_map(|(k, l)| note(found, || Place::Light(k), light(l, k + 1))).collect()
}

fn textures(
    desc: &SceneDesc,
    images: &mut ImageSource,
    found: &mut Found,
) -> HashMap<String, Texture> {
    let mut textures = HashMap::new();
    for (name, texture) in &desc.texture {
        let place = format!("texture `{name}`");
        let made = self::texture(&place, texture, desc.color_space, images);
        let made = note(found, || Place::Texture(name.clone()), made);
        textures.insert(name.clone(), made.unwrap_or(Texture::Solid(Rgb::ONE)));
    }
    textures
}

fn texture(
    place: &str,
    desc: &TextureDesc,
    space: ColorSpace,
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
            even: color(place, "even", *even, space)?,
            odd: color(place, "odd", *odd, space)?,
            origin: pattern(origin, *size)?,
            size: *size,
        }),
        TextureDesc::Plaid { ground, stripe, origin, size } => {
            let mixed = std::array::from_fn(|k| f64::midpoint(ground[k], stripe[k]));
            Texture::Plaid(Plaid {
                ground: color(place, "ground", *ground, space)?,
                mixed: color(place, "stripe", mixed, space)?,
                stripe: color(place, "stripe", *stripe, space)?,
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
    scene: &SceneDesc,
) -> Result<Material, SceneError> {
    let place = format!("material `{name}`");
    let texture = match &desc.texture {
        None => Texture::Solid(color(&place, "color", desc.color, scene.color_space)?),
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
    let filter = desc.transmission_color;
    let filter = color(&place, "transmission_color", filter, scene.color_space)?;
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

fn color(
    place: &str,
    name: &'static str,
    channels: [f64; 3],
    space: ColorSpace,
) -> Result<Rgb, SceneError> {
    for value in channels {
        check(place, name, value, "from 0 to 1 in each channel", (0.0..=1.0).contains(&value))?;
    }
    Ok(match space {
        ColorSpace::Srgb => from_srgb(channels),
        ColorSpace::Linear => Rgb::from_array(channels.map(|c| c as f32)),
    })
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
