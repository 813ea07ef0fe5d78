//! Models in OBJ files with MTL materials, as they really are.
//!
//! The file is read by a reader of its own, in one pass over the bytes, rather than by `tobj` behind a cleaning pass:
//! what has to be cleaned (byte-order marks, continuations, comments, encodings, number spellings) takes a full
//! tokenizer, and what has to be known afterwards (the line of every face, smoothing groups, normals that are missing
//! face by face) does not survive `tobj`. `benches/load.rs` measures both.

mod build;
mod closed;
mod cut;
mod error;
mod faces;
pub(crate) mod files;
mod lists;
mod materials;
mod mtl;
mod normals;
mod parts;
mod report;
mod statement;
mod vertices;
pub(super) mod weld;

use std::path::{Path, PathBuf};

pub use self::{
    error::ModelError,
    report::{ModelReport, OpenEdge, TextureReport},
};
use super::{
    text::{self, Lines, Tokens, decode::LARGEST_FILE, float},
    warning::Warning,
};
use crate::{geometry::Mesh, material::Material};

/// A model, repaired and ready to be placed in a scene.
#[derive(Debug)]
pub struct Model {
    /// The triangles.
    pub mesh: Mesh,
    /// The materials.
    pub materials: Vec<Material>,
    /// The material of each triangle, as a place in `materials`.
    pub material_of: Vec<u32>,
    /// What was odd about the file.
    pub warnings: Vec<Warning>,
    /// The files that were read: its own, those of its materials and of their pictures.
    pub files: Vec<PathBuf>,
}

/// Whether a text that is of no file begins as an OBJ does.
pub(super) fn is_obj(text: &[u8]) -> bool {
    let mut lines = Lines::new(text);
    while let Some((_, line)) = lines.next_line() {
        let mut tokens = Tokens::new(line);
        match tokens.next_word() {
            None => {}
            Some(b"mtllib" | b"usemtl" | b"o" | b"g" | b"vn" | b"vt") => {
                return tokens.next_word() != Some(b"=");
            }
            Some(b"v") => return tokens.next_number().and_then(float).is_some(),
            Some(_) => return false,
        }
    }
    false
}

/// Reads the model of an OBJ file, its material libraries and their pictures.
///
/// # Errors
/// The file cannot be read, is no text, holds no face, or has a statement that cannot be right.
pub fn load_model(path: &Path) -> Result<Model, ModelError> {
    let (obj, library) = read(path)?;
    let shown = path.display().to_string();
    let mut model = build::Builder::new(&shown, obj, library)?.model()?;
    model.files.push(path.to_owned());
    Ok(model)
}

/// As [`load_model`], and counts what the file holds.
///
/// # Errors
/// Those of [`load_model`].
pub fn inspect_model(path: &Path) -> Result<ModelReport, ModelError> {
    let (obj, library) = read(path)?;
    let shown = path.display().to_string();
    let builder = build::Builder::new(&shown, obj, library)?;
    let mut report = builder.report();
    let model = builder.model()?;
    report.kept_triangles = model.mesh.triangles().len();
    report.warnings = model.warnings;
    Ok(report)
}

/// The model in the bytes of an OBJ file, with the materials in those of its library; no other file is looked at.
///
/// # Errors
/// Those of [`load_model`].
pub fn parse_model(name: &str, obj: &[u8], mtl: &[u8]) -> Result<Model, ModelError> {
    let not_read = |source| ModelError::Text { path: name.to_owned(), source };
    let text = text::decode(obj).map_err(not_read)?;
    let obj = lists::Obj::parse(name, &text)?;
    let library = text::decode(mtl).map(|text| materials::Library::parse(name, &text));
    build::Builder::new(name, obj, library.map_err(not_read)?)?.model()
}

/// The statements of a file; its materials and pictures are read meanwhile.
fn read(path: &Path) -> Result<(lists::Obj, materials::Library), ModelError> {
    let shown = path.display().to_string();
    let not_read = |source| ModelError::Text { path: shown.clone(), source };
    let bytes = text::read_limited(path, LARGEST_FILE).map_err(not_read)?;
    let text = text::decode(&bytes).map_err(not_read)?;
    let (parts, library) = rayon::join(
        || parts::Parts::read(&shown, &text, parts::PART),
        || materials::Library::read(path, &libraries(&text)),
    );
    drop(text);
    drop(bytes);
    Ok((lists::Obj::join(&shown, parts?)?, library))
}

/// The `mtllib` statements of a text, found without reading the rest.
fn libraries(text: &[u8]) -> Vec<(String, u32)> {
    let (mut found, mut counted, mut line) = (Vec::new(), 0, 1_u32);
    for at in memchr::memmem::find_iter(text, b"mtllib") {
        let start = memchr::memrchr2(b'\n', b'\r', &text[..at]).map_or(0, |end| end + 1);
        if !text[start..at].trim_ascii().is_empty() {
            continue;
        }
        line = line.saturating_add(text::line_ends(&text[counted..start]));
        counted = start;
        let mut lines = text::Lines::new(&text[start..]);
        if let Some((_, statement)) = lines.next_line() {
            let mut tokens = text::Tokens::new(statement);
            if tokens.next_word() == Some(b"mtllib") {
                found.push((text::name_of(tokens.rest_as_name()), line));
            }
        }
    }
    found
}
