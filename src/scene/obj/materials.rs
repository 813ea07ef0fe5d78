//! Materials and pictures of a model, found, read and turned into Whitted's weights.
//!
//! | MTL | becomes |
//! | --- | --- |
//! | `Kd`, `map_Kd` | the colour; a picture takes the place of `Kd`, which many exporters leave at a default beside it |
//! | `Ka` | nothing: the ambient weight is 0.2 and the diffuse 0.8 |
//! | `Ks`, `Ns` | the weight of the highlight (the mean of the linear channels; white) and Phong's exponent, for `illum` 2 and up |
//! | `illum` 0 | the colour by itself, without light: ambient 1, diffuse 0 |
//! | `illum` 3, 4, 5, 6, 7, 8, 9 | a mirror image with the weight of `Ks` |
//! | `d` (or 1 − `Tr`; `d` wins) | the opacity; 1 − `d` is the weight of what passes, straight on, filtered by `Tf` |
//! | `illum` 4, 6, 7, 9 | glass: what passes is bent by `Ni`; where `d` is 1 or missing as much passes as `Tf` says, and the opacity is 0.15 |
//!
//! Fresnel's terms of `illum` 5 and 7 are not Whitted's and left out. Colours are sRGB display values.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use rayon::prelude::*;

use super::{
    files,
    mtl::{self, Mtl, PictureRef},
    report::TextureReport,
};
use crate::{
    color::{Rgb, from_srgb},
    material::Material,
    scene::{
        text::{self, decode},
        warning::Warning,
    },
    texture::{Image, Texture, UvMap},
};

/// The largest material library that is read, in bytes.
const LARGEST_LIBRARY: u64 = 1 << 28;

/// The materials of the libraries of a model.
#[derive(Debug, Default)]
pub(super) struct Library {
    materials: HashMap<String, Entry>,
    pub(super) textures: Vec<TextureReport>,
    pub(super) warnings: Vec<Warning>,
    /// The files of the libraries and the pictures.
    pub(super) files: Vec<PathBuf>,
    /// Whether a library was named at all.
    pub(super) is_named: bool,
}

/// A material, and the picture it wears.
#[derive(Debug)]
struct Entry {
    mtl: Mtl,
    image: Option<Arc<Image>>,
    /// What is wrong with the picture, for the user to know if a face uses the material.
    missing: Option<Warning>,
}

impl Library {
    /// Reads the libraries that the model `path` names, with their lines, and the pictures they name.
    pub(super) fn read(path: &Path, libraries: &[(String, u32)]) -> Self {
        let shown = path.display().to_string();
        let base = path.parent().unwrap_or(Path::new(""));
        let mut library = Self { is_named: !libraries.is_empty(), ..Self::default() };
        let mut materials = Vec::new();
        let mut seen = Vec::new();
        for (names, line) in libraries {
            let warn = |message: String| Warning { file: shown.clone(), line: *line, message };
            if names.is_empty() {
                library.warnings.push(warn("`mtllib` names no file".to_owned()));
            }
            for name in library_names(base, names) {
                if seen.contains(&name) {
                    continue;
                }
                seen.push(name.clone());
                let Some(file) = files::find(base, &name) else {
                    let message = format!("material library `{name}` is missing");
                    library.warnings.push(warn(message));
                    continue;
                };
                let mtl_path = file.display().to_string();
                library.files.push(file.clone());
                match text::read_limited(&file, LARGEST_LIBRARY) {
                    Ok(bytes) => match decode(&bytes) {
                        Ok(text) => {
                            let found = mtl::parse(&mtl_path, &text, &mut library.warnings);
                            if found.is_empty() {
                                let message =
                                    format!("material library `{name}` defines no material");
                                library.warnings.push(warn(message));
                            }
                            materials.extend(found.into_iter().map(|m| (mtl_path.clone(), m)));
                        }
                        Err(error) => {
                            let message = format!("material library `{name}` {error}");
                            library.warnings.push(warn(message));
                        }
                    },
                    Err(error) => {
                        let message = format!("material library `{name}` {error}");
                        library.warnings.push(warn(message));
                    }
                }
            }
        }
        library.take_in(base, materials);
        library
    }

    /// The materials in the text of one library, without pictures.
    pub(super) fn parse(path: &str, text: &[u8]) -> Self {
        let mut library = Self { is_named: true, ..Self::default() };
        for material in mtl::parse(path, text, &mut library.warnings) {
            let entry = library.materials.entry(material.name.clone());
            entry.or_insert(Entry { mtl: material, image: None, missing: None });
        }
        library
    }

    /// Reads the pictures, each file once, all at a time.
    fn take_in(&mut self, base: &Path, materials: Vec<(String, Mtl)>) {
        let mut names: Vec<&str> = Vec::new();
        for (_, material) in &materials {
            if let Some(picture) = &material.picture
                && !names.contains(&picture.name.as_str())
            {
                names.push(&picture.name);
            }
        }
        self.files.extend(names.iter().filter_map(|name| files::find(base, name)));
        let pictures: Vec<Result<Arc<Image>, String>> =
            names.par_iter().map(|name| read_picture(base, name).map(Arc::new)).collect();
        let pictures: HashMap<String, Result<Arc<Image>, String>> =
            names.iter().map(|name| (*name).to_owned()).zip(pictures).collect();
        for (file, material) in materials {
            let (mut image, mut missing) = (None, None);
            if let Some(PictureRef { name, line, .. }) = &material.picture {
                let found = pictures.get(name);
                self.textures.push(TextureReport {
                    name: name.clone(),
                    material: material.name.clone(),
                    found: matches!(found, Some(Ok(_))),
                });
                match found {
                    Some(Ok(picture)) => image = Some(Arc::clone(picture)),
                    Some(Err(reason)) => {
                        let message = format!("{reason}; the colour `Kd` is used");
                        missing = Some(Warning { file, line: *line, message });
                    }
                    None => {}
                }
            }
            // The first of a name wins, as in other readers.
            let entry = self.materials.entry(material.name.clone());
            entry.or_insert(Entry { mtl: material, image, missing });
        }
    }

    /// The material of this name, and the one for faces without surface coordinates if that is another.
    pub(super) fn material(&self, name: &str) -> Option<(Material, Option<Material>)> {
        let Entry { mtl, image, .. } = self.materials.get(name)?;
        let plain = whitted(mtl);
        let (Some(image), Some(picture)) = (image, &mtl.picture) else {
            return Some((plain, None));
        };
        let map = UvMap { scale: picture.scale, offset: picture.offset, clamp: picture.clamp };
        let texture = Texture::Repeated(Arc::clone(image), map);
        Some((Material { texture, ..plain.clone() }, Some(plain)))
    }

    /// What is wrong with the picture of the material of this name.
    pub(super) fn missing_picture(&self, name: &str) -> Option<&Warning> {
        self.materials.get(name)?.missing.as_ref()
    }

    /// Whether any material was found.
    pub(super) fn is_empty(&self) -> bool {
        self.materials.is_empty()
    }
}

/// The libraries that one statement names: one whose name has blanks, or several.
fn library_names(base: &Path, names: &str) -> Vec<String> {
    if !names.contains([' ', '\t']) || files::find(base, names).is_some() {
        return if names.is_empty() { Vec::new() } else { vec![names.to_owned()] };
    }
    let parts: Vec<String> = names.split_ascii_whitespace().map(str::to_owned).collect();
    let any_found = parts.iter().any(|part| files::find(base, part).is_some());
    if any_found || parts.iter().all(|p| p.to_ascii_lowercase().ends_with(".mtl")) {
        parts
    } else {
        vec![names.to_owned()]
    }
}

fn read_picture(base: &Path, name: &str) -> Result<Image, String> {
    let Some(file) = files::find(base, name) else {
        return Err(format!("texture `{name}` is missing"));
    };
    let bytes = text::read_limited(&file, files::LARGEST_PICTURE)
        .map_err(|error| format!("texture `{name}` {error}"))?;
    Image::decode(name, &bytes).map_err(|error| error.to_string())
}

/// The material for faces that have none: light grey, or what their own colours say.
pub(super) fn default_material(has_colors: bool) -> Material {
    let grey = if has_colors { 1.0 } else { 0.8 };
    Material {
        texture: Texture::Solid(from_srgb([grey; 3])),
        ambient: 0.2,
        diffuse: 0.8,
        specular: 0.3,
        shininess: 40.0,
        ..Material::none()
    }
}

/// The colour of what may be out of range in a file.
fn display(color: [f64; 3]) -> Rgb {
    from_srgb(color.map(|c| c.clamp(0.0, 1.0)))
}

fn whitted(mtl: &Mtl) -> Material {
    let illum = mtl.illum.unwrap_or(2);
    let specular = mtl.specular.map_or(0.0, |color| display(color).element_sum() / 3.0);
    let is_glass = matches!(illum, 4 | 6 | 7 | 9);
    let opacity =
        mtl.dissolve.or(mtl.transparency.map(|t| 1.0 - t)).unwrap_or(1.0).clamp(0.0, 1.0) as f32;
    let passing = Rgb::splat(1.0 - opacity);
    let transmission = match mtl.filter {
        Some(filter) if is_glass && opacity == 1.0 => display(filter),
        Some(filter) => passing * display(filter),
        None => passing,
    };
    let ior = mtl.ior.filter(|ior| is_glass && *ior > 0.0).unwrap_or(1.0);
    let is_bare = illum == 0;
    Material {
        texture: Texture::Solid(display(mtl.diffuse.unwrap_or([0.8; 3]))),
        ambient: if is_bare { 1.0 } else { 0.2 },
        diffuse: if is_bare { 0.0 } else { 0.8 },
        specular: if illum >= 2 { specular } else { 0.0 },
        shininess: mtl.shininess.unwrap_or(10.0).clamp(0.0, 1e6),
        reflection: if (3..=9).contains(&illum) { specular } else { 0.0 },
        // Glass by its filter alone says nothing of its own colour; the assignment's has this weight.
        opacity: if opacity == 1.0 && transmission != Rgb::ZERO { 0.15 } else { opacity },
        transmission,
        ior,
    }
}
