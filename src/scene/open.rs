//! From what the user names to a scene: built-in scenes, model files, models added to either.

use std::path::{Path, PathBuf};

use glam::DVec3;

use super::{
    Scene,
    builtin::{self, builtins},
    desc::{SceneDesc, TextureDesc},
    error::SceneError,
    format::SceneText,
    nff::{self, NffCounts, NffScene},
    obj::{self, Model, files},
    parts::{CameraPlan, Parts, Placement},
    report::Names,
    stage,
    text::{self, TextError},
    warning::Warning,
};
use crate::texture::Image;

/// What the user may change about a scene before it is built.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadOptions {
    /// Models to add.
    pub models: Vec<ModelPlace>,
    /// Where the camera is, instead of where the scene has it.
    pub eye: Option<DVec3>,
    /// What is in the middle of the picture.
    pub look_at: Option<DVec3>,
    /// The number of objects of a generated scene.
    pub objects: Option<u32>,
    /// Which direction is up: in the picture, and for a model that comes alone also in its own space.
    pub up: Option<DVec3>,
    /// The vertical field of view in degrees.
    pub fov: Option<f64>,
    /// The number of pixel rows, where a file gives its field of view between the outermost ones; the file's own number
    /// if not given.
    pub rows: Option<u32>,
}

/// A model to add to a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelPlace {
    /// The OBJ file.
    pub path: PathBuf,
    /// Where the middle of its lowest side stands; on the floor in front of the scene's middle if not given.
    pub at: Option<DVec3>,
    /// The length of its largest side; a fitting one if not given.
    pub size: Option<f64>,
}

/// A scene, and what was odd about its files.
#[derive(Debug)]
pub struct Loaded {
    /// The scene.
    pub scene: Scene,
    /// What was odd.
    pub warnings: Vec<Warning>,
    /// The files that were read: the scene's, and those of its models, materials and pictures.
    pub files: Vec<PathBuf>,
}

/// The files that were read so far, and what was odd about them.
#[derive(Default)]
pub(super) struct Sources {
    pub(super) warnings: Vec<Warning>,
    files: Vec<PathBuf>,
}

impl Sources {
    /// Moves what a model says to the rest.
    fn take_from(&mut self, model: &mut Model) {
        self.warnings.append(&mut model.warnings);
        self.files.append(&mut model.files);
    }
}

/// A scene that is not yet built, and what its files say besides.
pub(super) struct Gathered {
    /// That of the scene, after which its picture is named.
    pub(super) name: String,
    pub(super) parts: Parts,
    pub(super) names: Names,
    /// The entities of an NFF file.
    pub(super) entities: Option<NffCounts>,
    pub(super) sources: Sources,
}

/// The name that stands for standard input.
pub const STANDARD_INPUT: &str = "-";

/// The scene that `name` means: the built-in one of that name, the file, or for [`STANDARD_INPUT`] the scene that
/// comes from there, as TOML or NFF, with what it names in the current folder.
///
/// # Errors
/// There is no such scene, or what is wrong with it.
pub fn load(name: &str, options: &LoadOptions) -> Result<Loaded, SceneError> {
    let Gathered { name, parts, sources: Sources { warnings, files }, .. } = gather(name, options)?;
    Ok(Loaded { scene: Scene::assemble(&name, parts)?, warnings, files })
}

/// The parts of the scene that `name` means, changed as the user likes.
pub(super) fn gather(name: &str, options: &LoadOptions) -> Result<Gathered, SceneError> {
    let mut found = found(name, options)?;
    for place in &options.models {
        add(&mut found.parts, place, &mut found.sources)?;
    }
    let CameraPlan { eye, look_at, up, vertical_fov } = &mut found.parts.camera;
    for (ours, users) in [(eye, options.eye), (look_at, options.look_at), (up, options.up)] {
        if let Some(value) = users {
            *ours = value;
        }
    }
    if let Some(fov) = options.fov {
        *vertical_fov = fov;
    }
    Ok(found)
}

/// The parts of the scene that `name` means, as they are.
fn found(name: &str, options: &LoadOptions) -> Result<Gathered, SceneError> {
    let (mut sources, mut entities) = (Sources::default(), None);
    if let Some(found) = builtins().iter().find(|b| b.name == name) {
        let parts = found.parts(options.objects)?;
        let names = found.desc().map_or_else(|_| Names::default(), |desc| names(&desc));
        return Ok(Gathered { name: name.to_owned(), parts, names, entities, sources });
    }
    let path = Path::new(name);
    let kind = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let is_described =
        name == STANDARD_INPUT || matches!(kind.as_deref(), Some("obj" | "toml" | "nff"));
    if is_described && options.objects.is_some() {
        return Err(builtin::not_generated(name));
    }
    let (parts, names) = match kind.as_deref() {
        _ if name == STANDARD_INPUT => {
            let text = read_text("standard input", || text::read_stdin(LARGEST_SCENE))?;
            if obj::is_obj(&text) {
                return Err(SceneError::ModelFromStdin);
            }
            if nff::is_nff(&text) {
                let scene = nff::parse_nff("standard input", &text, options.rows)?;
                (nff_parts(scene, &mut entities, &mut sources), Names::default())
            } else {
                toml_parts("standard input", &text, Path::new(""), &mut sources)?
            }
        }
        Some("obj") => (model_alone(path, options, &mut sources)?, Names::default()),
        Some("toml") => {
            let shown = path.display().to_string();
            let text = read_text(&shown, || text::read_limited(path, LARGEST_SCENE))?;
            sources.files.push(path.to_owned());
            let base = path.parent().unwrap_or(Path::new(""));
            toml_parts(&shown, &text, base, &mut sources)?
        }
        Some("nff") => {
            let scene = nff::load_nff(path, options.rows)?;
            sources.files.push(path.to_owned());
            (nff_parts(scene, &mut entities, &mut sources), Names::default())
        }
        _ => {
            let known = builtins().iter().map(|b| b.name).collect::<Vec<_>>().join(", ");
            return Err(SceneError::UnknownFile { name: name.to_owned(), known });
        }
    };
    let stem = match name {
        STANDARD_INPUT => "stdin".to_owned(),
        _ => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
    };
    Ok(Gathered { name: stem, parts, names, entities, sources })
}

/// What a description calls its parts.
fn names(desc: &SceneDesc) -> Names {
    let picture = |(name, texture): (&String, &TextureDesc)| match texture {
        TextureDesc::Image(file) => Some((name.clone(), file.clone())),
        TextureDesc::Checker { .. } | TextureDesc::Plaid { .. } => None,
    };
    Names {
        materials: desc.material.keys().cloned().collect(),
        pictures: desc.texture.iter().filter_map(picture).collect(),
        models: desc.model.iter().map(|model| model.file.clone()).collect(),
    }
}

fn model_alone(
    path: &Path,
    options: &LoadOptions,
    sources: &mut Sources,
) -> Result<Parts, SceneError> {
    let mut model = obj::load_model(path)?;
    sources.take_from(&mut model);
    let up = options.up.filter(|up| up.is_finite()).unwrap_or(DVec3::Y);
    stage::stage(model, up, options.fov)
        .map_err(|source| SceneError::Floor { path: path.display().to_string(), source })
}

/// The parts of an NFF scene.
fn nff_parts(scene: NffScene, entities: &mut Option<NffCounts>, sources: &mut Sources) -> Parts {
    sources.warnings.extend(scene.warnings);
    *entities = Some(scene.counts);
    scene.parts
}

/// The parts of a scene in TOML that messages call `shown`; what it names is looked for in `base`.
fn toml_parts(
    shown: &str,
    text: &[u8],
    base: &Path,
    sources: &mut Sources,
) -> Result<(Parts, Names), SceneError> {
    let text = String::from_utf8_lossy(text);
    let scene = SceneText::parse(shown, &text, &|file| {
        file.starts_with(builtin::PREFIX) || files::find(base, file).is_some()
    })?;
    let mut pictures = Vec::new();
    let mut images = |name: &str| picture(base, name, &mut pictures);
    let mut models = |name: &str| {
        let Some(file) = files::find(base, name) else {
            return Err(no_file("model", name, base));
        };
        let mut model = obj::load_model(&file)?;
        sources.take_from(&mut model);
        Ok(model)
    };
    let names = names(scene.desc());
    let parts = scene.parts(&mut images, &mut models)?;
    sources.files.append(&mut pictures);
    Ok((parts, names))
}

/// The text of a scene that messages call `shown`.
fn read_text(
    shown: &str,
    read: impl FnOnce() -> Result<Vec<u8>, TextError>,
) -> Result<Vec<u8>, SceneError> {
    let not_read = |source| SceneError::Text { path: shown.to_owned(), source };
    let bytes = read().map_err(not_read)?;
    Ok(text::decode(&bytes).map_err(not_read)?.into_owned())
}

/// The largest scene file that is read, in bytes.
const LARGEST_SCENE: u64 = 1 << 28;

/// The picture that `name` means; its file is added to `read`.
fn picture(base: &Path, name: &str, read: &mut Vec<PathBuf>) -> Result<Image, SceneError> {
    if name.starts_with(builtin::PREFIX) {
        return builtin::picture(name);
    }
    let Some(file) = files::find(base, name) else {
        return Err(no_file("texture", name, base));
    };
    let bytes = text::read_limited(&file, files::LARGEST_PICTURE)
        .map_err(|source| SceneError::Text { path: file.display().to_string(), source })?;
    read.push(file);
    Ok(Image::decode(name, &bytes)?)
}

fn no_file(what: &'static str, name: &str, base: &Path) -> SceneError {
    let folder = if base.as_os_str().is_empty() { Path::new(".") } else { base };
    SceneError::NoFile { what, name: name.to_owned(), folder: folder.display().to_string() }
}

fn add(parts: &mut Parts, place: &ModelPlace, sources: &mut Sources) -> Result<(), SceneError> {
    let mut model = obj::load_model(&place.path)?;
    sources.take_from(&mut model);
    let bounds = model.mesh.bounds();
    let (free, scale) = stage::free_place(parts, bounds.extent(), place.size);
    let at = place.at.unwrap_or(free);
    let shift = at - stage::foot(&bounds) * scale;
    let placement = Placement { scale, shift, ..Placement::NONE };
    placement.check(&place.path.display().to_string(), &model)?;
    parts.add_model(model, &placement);
    Ok(())
}
