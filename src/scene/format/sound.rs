//! What can be read of a scene whose text has faults, so that what is wrong with the rest is told in the same run.

use serde::de::DeserializeOwned;
use toml::de::ValueDeserializer;

use super::{
    Place,
    check::{Value, Walk, find},
    keys::{CAMERA, Kind, LIGHT, MATERIAL, MODEL, SHAPE, TEXTURE},
};
use crate::scene::desc::{
    CameraDesc, LightDesc, MaterialDesc, ModelDesc, ObjectDesc, SceneDesc, ShapeDesc, TextureDesc,
};

/// The name of a material that stands in for one that is faulty.
const STAND_IN: &str = "";

/// A description without what is faulty.
#[derive(Debug)]
pub(super) struct Sound {
    pub(super) desc: SceneDesc,
    /// Where in the text's list the models stand.
    models: Vec<usize>,
}

impl Sound {
    /// All of a description.
    pub(super) fn all(desc: SceneDesc) -> Self {
        let models = (0..desc.model.len()).collect();
        Self { desc, models }
    }

    /// The place in the text of a place in the description.
    pub(super) fn in_text(&self, place: Place) -> Place {
        match place {
            Place::Model(k) => Place::Model(self.models[k]),
            place => place,
        }
    }

    /// The sound part of the text that `walk` goes through; what is faulty is replaced by something harmless, so that
    /// names and numbers stay what they are, and models by nothing.
    pub(super) fn read(walk: &Walk) -> Self {
        let mut models = Vec::new();
        let mut desc = harmless();
        for (name, text) in entries(walk, "texture") {
            let texture = sound(walk, text, Kind::OneOf(TEXTURE)).unwrap_or_else(plain_texture);
            desc.texture.insert(name, texture);
        }
        desc.material.insert(STAND_IN.to_owned(), MaterialDesc::default());
        for (name, text) in entries(walk, "material") {
            let material = sound(walk, text, Kind::Table(MATERIAL)).unwrap_or_default();
            desc.material.insert(name, material);
        }
        for (_, text) in items(walk, "light") {
            let dark = LightDesc { position: [0.0; 3], intensity: 0.0 };
            desc.light.push(sound(walk, text, Kind::Table(LIGHT)).unwrap_or(dark));
        }
        for (_, text) in items(walk, "object") {
            let of = |key: &str| find(text.get_ref().as_table()?, key);
            let shape = of("shape").and_then(|s| sound::<ShapeDesc>(walk, s, Kind::OneOf(SHAPE)));
            let material = of("material").and_then(|m| sound(walk, m, Kind::Name("material")));
            let material = material.unwrap_or_else(|| STAND_IN.to_owned());
            let shape = shape.unwrap_or(ShapeDesc::Sphere { center: [0.0; 3], radius: 1.0 });
            desc.object.push(ObjectDesc { material, shape });
        }
        for (k, text) in items(walk, "model") {
            if let Some(model) = sound::<ModelDesc>(walk, text, Kind::Table(MODEL)) {
                desc.model.push(model);
                models.push(k);
            }
        }
        let of_scene = |key: &str| find(walk.root, key);
        if let Some(camera) = of_scene("camera").and_then(|c| sound(walk, c, Kind::Table(CAMERA))) {
            desc.camera = camera;
        }
        desc.aa = of_scene("aa").and_then(|aa| sound(walk, aa, Kind::Text));
        Self { desc, models }
    }
}

/// A scene of nothing that nothing is wrong with.
fn harmless() -> SceneDesc {
    SceneDesc {
        resolution: [1, 1],
        depth: 1,
        cutoff: 0.0,
        background: [0.0; 3],
        aa: None,
        color_space: crate::scene::desc::ColorSpace::default(),
        camera: CameraDesc {
            eye: [0.0; 3],
            look_at: [0.0, 0.0, -1.0],
            up: [0.0, 1.0, 0.0],
            vertical_fov: 45.0,
        },
        light: Vec::new(),
        texture: std::collections::BTreeMap::new(),
        material: std::collections::BTreeMap::new(),
        object: Vec::new(),
        model: Vec::new(),
    }
}

fn plain_texture() -> TextureDesc {
    TextureDesc::Checker { even: [1.0; 3], odd: [1.0; 3], origin: [0.0; 3], size: 1.0 }
}

fn entries<'t>(walk: &'t Walk, key: &str) -> impl Iterator<Item = (String, &'t Value<'t>)> {
    let table = find(walk.root, key).and_then(|value| value.get_ref().as_table());
    table.into_iter().flatten().map(|(name, value)| (name.get_ref().clone().into_owned(), value))
}

fn items<'t>(walk: &'t Walk, key: &str) -> impl Iterator<Item = (usize, &'t Value<'t>)> {
    let list = find(walk.root, key).and_then(|value| value.get_ref().as_array());
    list.into_iter().flat_map(|list| list.iter().enumerate())
}

/// What a value says, if nothing is wrong with it.
fn sound<T: DeserializeOwned>(walk: &Walk, value: &Value, kind: Kind) -> Option<T> {
    let mut found = Vec::new();
    walk.value(value, kind, "", &mut found);
    if found.is_empty() {
        T::deserialize(ValueDeserializer::from(value.clone())).ok()
    } else {
        None
    }
}
