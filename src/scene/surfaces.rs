//! Materials and textures of a description, by name.

use std::{
    collections::{BTreeMap, HashMap},
    sync::Arc,
};

use glam::DVec3;

use super::{
    desc::{ColorSpace, MaterialDesc, SceneDesc, TextureDesc},
    error::SceneError,
    format::Place,
    load::ImageSource,
    values::{Found, at_least_zero, check, color, note},
};
use crate::{
    color::Rgb,
    material::Material,
    texture::{Checker, Plaid, Texture},
};

/// The materials of a description by name; one that is wrong still has its number.
pub(super) struct Materials<'a> {
    /// In the order of their names.
    pub(super) list: Vec<Material>,
    number_of: HashMap<&'a str, u32>,
    known: String,
}

impl<'a> Materials<'a> {
    /// The materials of `desc`; what is wrong with them and with the textures they wear is added to `found`.
    pub(super) fn new(desc: &'a SceneDesc, images: &mut ImageSource, found: &mut Found) -> Self {
        let textures = textures(desc, images, found);
        let (mut list, mut number_of) = (Vec::new(), HashMap::new());
        for (name, material) in &desc.material {
            number_of.insert(name.as_str(), list.len() as u32);
            let made = self::material(name, material, &textures, desc);
            let made = note(found, || Place::Material(name.clone()), made);
            list.push(made.unwrap_or_else(Material::none));
        }
        Self { list, number_of, known: names(&desc.material) }
    }

    /// The number in the list of the material that is named at `place`.
    pub(super) fn number(
        &self,
        material: &str,
        place: impl FnOnce() -> String,
    ) -> Result<u32, SceneError> {
        self.number_of.get(material).copied().ok_or_else(|| SceneError::UnknownMaterial {
            place: place(),
            material: material.to_owned(),
            known: self.known.clone(),
        })
    }
}

fn names<T>(map: &BTreeMap<String, T>) -> String {
    let names: Vec<&str> = map.keys().map(String::as_str).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
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
