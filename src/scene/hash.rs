//! A hash of all of a scene that a picture depends on.

use std::{fmt::Write as _, sync::Arc};

use glam::DVec3;

use super::Scene;
use crate::{
    camera::Camera,
    geometry::{Mesh, Shape},
    material::Material,
    texture::{Image, Texture, UvMap},
};

/// Bytes that are hashed at a time.
const AT_ONCE: usize = 1 << 16;

/// Shapes that are asked for before the first of them is hashed.
const AT_HAND: u32 = 64;

impl Scene {
    /// A hash of shapes, materials, textures, lights, background, camera and cutoff, in hexadecimal digits: scenes that
    /// hash alike look alike, whatever their files are called and however they are written.
    ///
    /// What a user may choose for a picture, such as its size and the depth of recursion, is not in it.
    pub fn hash(&self) -> String {
        self.hash_seen_by(&self.camera)
    }

    /// The hash of the scene as another camera sees it, which is given in the coordinates of the description.
    pub fn hash_from(&self, camera: Camera) -> String {
        self.hash_seen_by(&self.own_camera(camera))
    }

    fn hash_seen_by(&self, camera: &Camera) -> String {
        let mut hash = Hash { hasher: blake3::Hasher::new(), bytes: Vec::with_capacity(AT_ONCE) };
        hash.text(&format_args!("{:?} {:?} {:?}", camera, self.background, self.cutoff));
        hash.count(self.lights.len());
        self.lights.iter().for_each(|light| hash.text(&format_args!("{light:?}")));
        hash.count(self.materials.len());
        self.materials.iter().for_each(|material| hash.material(material));
        hash.count(self.accel.len());
        let mut last_mesh = None;
        let count = self.accel.len() as u32;
        for first in (0..count).step_by(AT_HAND as usize) {
            let some = first..count.min(first.saturating_add(AT_HAND));
            // In memory they are in the order of the tree.
            self.accel.prefetch(some.clone().map(|primitive| self.shape(primitive)));
            for primitive in some {
                hash.number(self.material_of[primitive as usize]);
                hash.shape(self.shape(primitive), &mut last_mesh);
            }
        }
        hash.finish()
    }
}

struct Hash {
    hasher: blake3::Hasher,
    bytes: Vec<u8>,
}

impl Hash {
    fn put(&mut self, bytes: &[u8]) {
        if self.bytes.len() + bytes.len() > AT_ONCE {
            self.hasher.update(&self.bytes);
            self.bytes.clear();
        }
        if bytes.len() > AT_ONCE {
            self.hasher.update(bytes);
        } else {
            self.bytes.extend_from_slice(bytes);
        }
    }

    fn finish(mut self) -> String {
        self.hasher.update(&self.bytes);
        self.hasher.finalize().to_hex().to_string()
    }

    fn number(&mut self, number: u32) {
        self.put(&number.to_le_bytes());
    }

    fn count(&mut self, count: usize) {
        self.put(&(count as u64).to_le_bytes());
    }

    fn float(&mut self, x: f64) {
        self.put(&x.to_le_bytes());
    }

    fn point(&mut self, p: DVec3) {
        p.to_array().into_iter().for_each(|x| self.float(x));
    }

    /// Few things are hashed as they print, with all their digits and whatever fields they have.
    fn text(&mut self, text: &std::fmt::Arguments) {
        let mut line = String::new();
        let _ = write!(line, "{text}"); // a string takes all
        self.count(line.len());
        self.put(line.as_bytes());
    }

    fn shape<'s>(&mut self, shape: &'s Shape, last_mesh: &mut Option<&'s Arc<Mesh>>) {
        match shape {
            Shape::Sphere(sphere) => {
                self.put(b"s");
                self.point(sphere.center());
                self.float(sphere.radius());
            }
            Shape::Face(face) => {
                if last_mesh.is_none_or(|last| !Arc::ptr_eq(last, face.mesh())) {
                    *last_mesh = Some(face.mesh());
                    self.mesh(face.mesh());
                }
                self.put(b"f");
                self.number(face.index());
            }
            // Their normals and gradients follow from the corners.
            Shape::Triangle(_) | Shape::Quad(_) | Shape::Polygon(_) => {
                self.put(b"p");
                let mut corners = 0;
                shape.for_each_point(|p| {
                    self.point(p);
                    corners += 1;
                });
                self.count(corners);
            }
            Shape::Inward(inward) => {
                self.put(b"i");
                self.shape(inward.shape(), last_mesh);
            }
            Shape::Cylinder(_) | Shape::Cone(_) => self.text(&format_args!("{shape:?}")),
        }
    }

    fn mesh(&mut self, mesh: &Mesh) {
        let attributes = mesh.attributes();
        let lists = [attributes.normals.len(), attributes.uvs.len(), attributes.tints.len()];
        self.put(b"m");
        self.count(mesh.vertices().len());
        for length in lists {
            self.count(length);
        }
        self.count(mesh.triangles().len());
        mesh.vertices().iter().for_each(|v| self.point(*v));
        mesh.triangles().iter().flatten().for_each(|k| self.number(*k));
        for vector in attributes.normals.iter().chain(&attributes.tints) {
            vector.to_array().into_iter().for_each(|x| self.put(&x.to_le_bytes()));
        }
        for uv in &attributes.uvs {
            uv.to_array().into_iter().for_each(|x| self.put(&x.to_le_bytes()));
        }
    }

    fn material(&mut self, material: &Material) {
        let Material { texture, ambient, diffuse, specular, shininess, .. } = material;
        let Material { reflection, opacity, transmission, ior, .. } = material;
        self.text(&format_args!("{ambient:?} {diffuse:?} {specular:?} {shininess:?}"));
        self.text(&format_args!("{reflection:?} {opacity:?} {transmission:?} {ior:?}"));
        match texture {
            Texture::Solid(color) => self.text(&format_args!("solid {color:?}")),
            Texture::Checker(pattern) => self.text(&format_args!("{pattern:?}")),
            Texture::Plaid(pattern) => self.text(&format_args!("{pattern:?}")),
            Texture::Image(image) => self.image(image, None),
            Texture::Repeated(image, map) => self.image(image, Some(map)),
        }
    }

    fn image(&mut self, image: &Image, map: Option<&UvMap>) {
        self.text(&format_args!("{map:?}"));
        image.size().into_iter().for_each(|length| self.count(length));
        self.put(image.bytes());
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::{Scene, SceneDesc, builtin, load_builtin, load_builtin_of};

    /// The hash of the assignment scene after one replacement in its text, and with another picture on its sphere.
    fn changed(from: &str, to: &str, flower: &str) -> String {
        let text = include_str!("builtin/assignment.toml");
        assert!(text.contains(from), "{from}");
        let desc: SceneDesc = toml::from_str(&text.replacen(from, to, 1)).expect("a scene");
        let mut images =
            |name: &str| builtin::picture(if name.contains("flower") { flower } else { name });
        Scene::try_new("any", &desc, &mut images).expect("a scene").hash()
    }

    /// Oracle: what is changed is seen or not.
    #[test]
    fn a_hash_is_that_of_what_is_seen_and_not_of_the_text() {
        let flower = "builtin:flower.png";
        let original = load_builtin("assignment").expect("built in").hash();
        assert_eq!(original.len(), 64);
        assert_eq!(changed("# The", "# A comment: the", flower), original);
        assert_eq!(changed("resolution = [600, 600]", "resolution = [60, 60]", flower), original);
        assert_eq!(changed("intensity = 0.45", "intensity = 0.450", flower), original);
        let others = [
            changed("intensity = 0.45", "intensity = 0.46", flower),
            changed("shininess = 80", "shininess = 81", flower),
            changed("reflection = 0.8", "reflection = 0.81", flower),
            changed("eye = [0, 0, 0]", "eye = [0, 0, 1e-9]", flower),
            changed("size = 5", "size = 5.001", flower),
            changed("[0.62, 0.76, 0.92]", "[0.62, 0.76, 0.93]", flower),
            changed("depth = 6", "depth = 6", "builtin:cat.png"),
            load_builtin("spheres").expect("built in").hash(),
            load_builtin_of("spheres", Some(999)).expect("built in").hash(),
        ];
        for (k, other) in others.iter().enumerate() {
            assert_ne!(*other, original, "{k}");
            assert!(!others[..k].contains(other), "{k}");
        }
    }
}
