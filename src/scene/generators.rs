//! Scenes of any number of objects, the same on every machine.

use glam::DVec3;

use super::{SceneError, builtin, parts::Parts};
use crate::{
    geometry::{Shape, Sphere},
    math::random::SplitMix64,
};

/// How many objects a generated scene has unless one asks for another number.
pub const DEFAULT_OBJECTS: u32 = 1000;

/// The most objects a generated scene may have: 4 GB of spheres and their tree, and 11.5 GB while that is built.
pub const MOST_OBJECTS: u32 = 50_000_000;

/// A sphere of the stress scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StressSphere {
    /// Its centre; single-precision numbers.
    pub center: [f32; 3],
    /// 0 to 15 is matte in a colour of the palette, 16 mirror, 17 glass.
    pub material: u8,
}

/// The radius that all of `count` spheres have: 1.35 √(1000/count), rounded to single precision.
///
/// The spheres' projected area together is the same for any number of them.
pub fn stress_radius(count: u32) -> f32 {
    (1.35 * (1000.0 / f64::from(count)).sqrt()) as f32
}

/// The spheres of the stress scene, of which a shorter list is the beginning of a longer one.
///
/// They are uniform in the box [−40, 40] × [−14, 40] × [−190, −60]; 80 % are matte, 15 % mirrors, 5 % glass.
pub fn stress_spheres(count: u32) -> impl Iterator<Item = StressSphere> {
    let mut random = SplitMix64::new(1);
    (0..count).map(move |_| {
        let x = -40.0 + 80.0 * random.uniform();
        let y = -14.0 + 54.0 * random.uniform();
        let z = -190.0 + 130.0 * random.uniform();
        let material = match (100.0 * random.uniform()) as u8 {
            k @ 0..80 => k % 16,
            80..95 => 16,
            _ => 17,
        };
        StressSphere { center: [x as f32, y as f32, z as f32], material }
    })
}

/// The stress scene `spheres`: a floor and `count` spheres of one radius, at least one.
///
/// # Errors
/// The number of spheres is zero or above [`MOST_OBJECTS`].
pub fn spheres(count: u32) -> Result<Parts, SceneError> {
    if !(1..=MOST_OBJECTS).contains(&count) {
        return Err(SceneError::Value {
            place: "scene `spheres`".to_owned(),
            name: "objects",
            value: f64::from(count),
            range: "from 1 to 50000000",
        });
    }
    let desc = builtin::SPHERES.desc()?;
    let mut parts = Parts::try_new(&desc, &mut builtin::picture)?;
    // The description's materials are in the order of their names.
    let numbers: Vec<u32> = (0..18)
        .map(|material| match material {
            16 => "mirror".to_owned(),
            17 => "glass".to_owned(),
            matte => format!("matte{matte:02}"),
        })
        .map(|name| desc.material.keys().take_while(|known| **known < name).count() as u32)
        .collect();
    let radius = f64::from(stress_radius(count));
    parts.shapes.reserve_exact(count as usize);
    parts.material_of.reserve_exact(count as usize);
    for (sphere, object) in stress_spheres(count).zip(1..) {
        let center = DVec3::from_array(sphere.center.map(f64::from));
        let shape = Sphere::try_new(center, radius).map_err(|source| SceneError::Shape {
            object,
            kind: "sphere",
            source,
        })?;
        parts.shapes.push(Shape::from(shape));
        parts.material_of.push(numbers[usize::from(sphere.material)]);
    }
    Ok(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// CRC-32 as in zlib and PNG, bit by bit.
    fn crc32(bytes: impl Iterator<Item = u8>) -> u32 {
        !bytes.fold(!0_u32, |crc, byte| {
            (0..8).fold(crc ^ u32::from(byte), |crc, _| {
                (crc >> 1) ^ if crc & 1 == 1 { 0xEDB8_8320 } else { 0 }
            })
        })
    }

    /// Oracle: the published check value of the CRC, and the checksums and counts published with the scene.
    #[test]
    fn spheres_have_the_published_checksums() {
        assert_eq!(crc32(b"123456789".iter().copied()), 0xCBF4_3926);
        for (count, radius, kinds, positions, materials) in [
            (1_000, 1.35, [802, 152, 46], 0x9fd5_86fe, 0xa2e5_d86f),
            (10_000, 0.426_907_48, [8053, 1461, 486], 0x0831_7295, 0x3c9c_2fb7),
            (100_000, 0.135, [79846, 15099, 5055], 0x68a0_ef8f, 0xa581_ece6),
            (1_000_000, 0.042_690_75, [800_030, 149_909, 50061], 0x189b_7460_u32, 0x00f8_0ebf_u32),
        ] {
            assert_eq!(stress_radius(count), radius, "{count}");
            let spheres: Vec<StressSphere> = stress_spheres(count).collect();
            let matte = spheres.iter().filter(|s| s.material < 16).count();
            let mirror = spheres.iter().filter(|s| s.material == 16).count();
            assert_eq!([matte, mirror, spheres.len() - matte - mirror], kinds, "{count}");
            let floats = spheres.iter().flat_map(|s| s.center).flat_map(f32::to_le_bytes);
            assert_eq!(crc32(floats), positions, "{count}");
            assert_eq!(crc32(spheres.iter().map(|s| s.material)), materials, "{count}");
        }
    }

    /// Oracle: the first two spheres as published, and weights that only their material has.
    #[test]
    fn a_scene_holds_the_floor_and_the_spheres_in_order() {
        let scene = crate::scene::load_builtin_of("spheres", Some(100)).expect("a scene");
        assert_eq!(
            (scene.name(), scene.primitive_count(), scene.light_count()),
            ("spheres", 101, 2)
        );
        let first: Vec<StressSphere> = stress_spheres(2).collect();
        assert_eq!(first[0].center, [5.324_926, 26.272_215, -63.769_64]);
        assert_eq!(first[1].center, [-4.458_824, 27.196_297, -75.944_67]);
        assert_eq!((first[0].material, first[1].material), (12, 4));
        for (sphere, primitive) in stress_spheres(100).zip(1..) {
            let material = scene.material(primitive);
            assert_eq!(material.is_transmissive(), sphere.material == 17, "{primitive}");
            assert_eq!(scene.is_opaque(primitive), sphere.material != 17, "{primitive}");
            assert_eq!(material.reflection == 0.8, sphere.material == 16, "{primitive}");
        }
    }

    #[test]
    fn no_spheres_and_too_many_are_refused() {
        for count in [0, MOST_OBJECTS + 1] {
            let error = spheres(count).expect_err("out of range").to_string();
            assert!(error.contains("from 1 to 50000000"), "{error}");
        }
    }
}
