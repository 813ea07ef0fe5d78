//! From a scene's description to what can be traced: every number checked, every name resolved.

use glam::{DMat3, DVec3};

use super::{
    desc::{LightDesc, ModelDesc, SceneDesc},
    error::SceneError,
    format::Place,
    obj::Model,
    parts::{CameraPlan, MeshPart, Parts, Placement},
    shapes::make_shapes,
    surfaces::Materials,
    values::{Found, at_least_zero, check, color, note},
};
use crate::{aa::AntiAliasing, color::Rgb, geometry::Shape, light::Light, texture::Image};

/// How the picture of a texture is found by its name.
pub type ImageSource<'a> = dyn FnMut(&str) -> Result<Image, SceneError> + 'a;

/// How the model of a file is found by the file's name.
pub type ModelSource<'a> = dyn FnMut(&str) -> Result<Model, SceneError> + 'a;

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
        let mut parts = empty_parts(desc, &mut found);
        parts.lights = lights(desc, &mut found);
        let materials = Materials::new(desc, images, &mut found);
        (parts.shapes, parts.material_of) = objects(desc, &materials, &mut found);
        let placed = placed_models(desc, &materials, models, &mut found);
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

/// What the scene's own keys say: how it is seen, but nothing to be seen yet.
fn empty_parts(desc: &SceneDesc, found: &mut Found) -> Parts {
    for (name, value) in
        [("resolution", desc.resolution[0].min(desc.resolution[1])), ("depth", desc.depth)]
    {
        let is_in = check("scene", name, value.into(), "at least 1", value >= 1);
        note(found, || Place::Scene(name), is_in);
    }
    let cutoff = at_least_zero("scene", "cutoff", f64::from(desc.cutoff));
    note(found, || Place::Scene("cutoff"), cutoff);
    let camera = CameraPlan {
        eye: DVec3::from_array(desc.camera.eye),
        look_at: DVec3::from_array(desc.camera.look_at),
        up: DVec3::from_array(desc.camera.up),
        vertical_fov: desc.camera.vertical_fov,
    };
    let seeing = camera.camera().map_err(SceneError::from);
    note(found, || Place::Scene("camera"), seeing);
    let background = color("scene", "background", desc.background, desc.color_space);
    let background = note(found, || Place::Scene("background"), background);
    let aa = desc.aa.as_ref().map(|mode| {
        mode.parse::<AntiAliasing>()
            .map_err(|reason| SceneError::Aa { mode: mode.clone(), reason: reason.to_string() })
    });
    let aa = aa.and_then(|aa| note(found, || Place::Scene("aa"), aa));
    Parts {
        resolution: desc.resolution,
        depth: desc.depth,
        cutoff: desc.cutoff,
        aa,
        camera,
        background: background.unwrap_or_default(),
        shapes: Vec::new(),
        material_of: Vec::new(),
        meshes: Vec::new(),
        materials: Vec::new(),
        lights: Vec::new(),
    }
}

fn objects(desc: &SceneDesc, materials: &Materials, found: &mut Found) -> (Vec<Shape>, Vec<u32>) {
    let (mut shapes, mut material_of) = (Vec::new(), Vec::new());
    for (k, object) in desc.object.iter().enumerate() {
        let index = k + 1;
        let mut make = || {
            let number = materials.number(&object.material, || format!("object {index}"))?;
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

/// A model, where it goes, and the material that it wears in place of its own.
type Placed = (Model, Placement, Option<u32>);

fn placed_models(
    desc: &SceneDesc,
    materials: &Materials,
    models: &mut ModelSource,
    found: &mut Found,
) -> Vec<Placed> {
    let mut placed = Vec::new();
    for (k, model) in desc.model.iter().enumerate() {
        let made = placed_model(model, k + 1, materials, models);
        placed.extend(note(found, || Place::Model(k), made));
    }
    placed
}

fn placed_model(
    desc: &ModelDesc,
    index: usize,
    materials: &Materials,
    models: &mut ModelSource,
) -> Result<Placed, SceneError> {
    let place = || format!("model {index}");
    let material =
        desc.material.as_deref().map(|name| materials.number(name, place)).transpose()?;
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

fn lights(desc: &SceneDesc, found: &mut Found) -> Vec<Light> {
    let light = |light: &LightDesc, index: usize| {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    /// A description that is not read from a text has no lines to point to.
    #[test]
    fn a_material_that_is_not_defined_is_said_to_be_that_of_an_object_or_a_model() {
        const SCENE: &str = "resolution = [1, 1]\ndepth = 1\nbackground = [0, 0, 0]\n\
            camera = { eye = [0, 0, 5], look_at = [0, 0, 0], up = [0, 1, 0], vertical_fov = 40 }\n";
        let message = |parts: &str| {
            let desc = toml::from_str(&format!("{SCENE}{parts}")).expect("a description");
            Parts::try_new(&desc, &mut builtin::picture).expect_err("no such material").to_string()
        };
        let reason = "uses material `red`, which is not defined (known: none)";
        let object =
            "[[object]]\nmaterial = \"red\"\nshape.sphere = { center = [0, 0, 0], radius = 1 }";
        assert_eq!(message(object), format!("object 1 {reason}"));
        let model = "[[model]]\nfile = \"a.obj\"\nmaterial = \"red\"";
        assert_eq!(message(model), format!("model 1 {reason}"));
    }
}
