//! One small picture for each object of the assignment, its colours known in closed form.

use whitted::Rgb;

use super::support::{assert_color, linear, only_pixel, picture, scene};

/// A camera at the origin that looks along −z through one pixel, and what follows.
fn looking_ahead(rest: &str) -> String {
    format!(
        "resolution = [1, 1]\ndepth = 6\nbackground = [0.62, 0.76, 0.92]\n\
         camera = {{ eye = [0, 0, 0], look_at = [0, 0, -1], up = [0, 1, 0], vertical_fov = 1 }}\n{rest}"
    )
}

const BACKGROUND: [f64; 3] = [0.62, 0.76, 0.92];

/// Oracle: ambient + diffuse + specular written out. The normal faces the camera, the light stands at 45 degrees: the
/// mirror direction is +z, and so are cos θ = cos φ = 1/√2.
#[test]
fn a_lit_sphere_has_the_colour_of_the_formula() {
    let color = only_pixel(&looking_ahead(
        r#"
        light = [{ position = [9, 0, 0], intensity = 0.45 }]
        [material.yellow]
        color = [0.95, 0.75, 0.15]
        ambient = 0.2
        diffuse = 0.8
        specular = 1
        shininess = 40
        [[object]]
        material = "yellow"
        shape.sphere = { center = [0, 0, -11], radius = 2 }
        "#,
    ));
    let half = 0.5_f64.sqrt();
    let expected =
        [0.95, 0.75, 0.15].map(|c| linear(c) * (0.2 + 0.8 * half * 0.45) + half.powi(40) * 0.45);
    assert_color(color, expected, "sphere");
}

/// Oracle: a light behind the sphere leaves the ambient term alone.
#[test]
fn a_light_behind_leaves_ambient_light() {
    let color = only_pixel(&looking_ahead(
        r#"
        light = [{ position = [0, 0, -50], intensity = 0.45 }]
        [material.red]
        color = [0.85, 0.18, 0.15]
        ambient = 0.2
        diffuse = 0.8
        [[object]]
        material = "red"
        shape.sphere = { center = [0, 0, -11], radius = 2 }
        "#,
    ));
    assert_color(color, [0.85, 0.18, 0.15].map(|c| 0.2 * linear(c)), "sphere");
}

/// Oracle: the mirror at 45 degrees shows the background above, weighted by 0.8; no light is there.
#[test]
fn a_mirror_shows_its_weight_of_the_background() {
    let mirror = |shape: &str| {
        only_pixel(&looking_ahead(&format!(
            "material.mirror = {{ reflection = 0.8 }}\n[[object]]\nmaterial = \"mirror\"\nshape.{shape}"
        )))
    };
    let expected = BACKGROUND.map(|c| 0.8 * linear(c));
    assert_color(mirror("sphere = { center = [0, 0, -9], radius = 3 }"), expected, "sphere");
    assert_color(
        mirror("quad = { corner = [-5, -5, 0], edges = [[10, 0, 0], [0, 10, -10]] }"),
        expected,
        "quad",
    );
}

/// The floor's colour below a body that hangs between it and the light, as a part of that without the body.
fn tint(material: &str, shape: &str) -> Rgb {
    let floor = |object: &str| {
        only_pixel(&format!(
            r#"
            resolution = [1, 1]
            depth = 6
            background = [0, 0, 0]
            camera = {{ eye = [20, 5, 0], look_at = [0, 0, 0], up = [0, 1, 0], vertical_fov = 0.001 }}
            light = [{{ position = [0, 40, 0], intensity = 0.9 }}]
            material.floor = {{ diffuse = 1 }}
            material.body = {{ {material} }}
            [[object]]
            material = "floor"
            shape.quad = {{ corner = [-50, 0, -50], edges = [[0, 0, 100], [100, 0, 0]] }}
            {object}
            "#
        ))
    };
    floor(&format!("[[object]]\nmaterial = \"body\"\nshape.{shape}")) / floor("")
}

/// Oracle: two surfaces at 0.85 keep 0.7225; two at 0.95 times the decoded colour keep the figures of the description; anything
/// opaque keeps nothing, a body beside the light's way all of it.
#[test]
fn shadows_are_tinted() {
    let sphere = "sphere = { center = [0, 10, 0], radius = 2 }";
    assert_color(tint("transmission = 0.85, ior = 1.5", sphere), [0.7225; 3], "glass");
    let hollow = tint("transmission = 0.95, transmission_color = [1, 0.86, 0.92]", sphere);
    assert_color(hollow, [1.0, 0.86, 0.92].map(|c| (0.95 * linear(c)).powi(2)), "hollow");
    for (value, figure) in hollow.to_array().into_iter().zip([0.9025, 0.4557, 0.6181]) {
        assert!((value - figure).abs() < 6e-5, "{hollow}");
    }
    assert_color(tint("diffuse = 1", sphere), [0.0; 3], "opaque");
    let beside = "sphere = { center = [0, 10, 2.5], radius = 2 }";
    assert_color(tint("diffuse = 1", beside), [1.0; 3], "beside");
    let pane = "quad = { corner = [-1, 10, -1], edges = [[0, 0, 2], [2, 0, 0]] }";
    assert_color(tint("transmission = 0.85", pane), [0.85; 3], "pane");
    let tin = "cylinder = { base = [0, 9, 0], top = [0, 11, 0], radius = 1, ends = \"closed\" }";
    assert_color(tint("transmission = 0.85", tin), [0.7225; 3], "closed cylinder, along its axis");
    let hat = "cone = { base = [0, 9, 0], apex = [0, 11, 0], radius = 1, ends = \"closed\" }";
    assert_color(tint("transmission = 0.85", hat), [0.7225; 3], "cone, through its apex");
}

/// Oracle: straight through both surfaces of a hollow body: T² of what is behind it, and nothing of its inner surface.
#[test]
fn a_hollow_sphere_filters_what_is_behind() {
    let color = only_pixel(&looking_ahead(
        r#"
        [material.hollow]
        transmission = 0.95
        transmission_color = [1, 0.86, 0.92]
        opacity = 0.05
        ambient = 0.2
        [[object]]
        material = "hollow"
        shape.sphere = { center = [0.3, 0, -9], radius = 4 }
        "#,
    ));
    let filter = [1.0, 0.86, 0.92].map(|c| 0.95 * linear(c));
    let expected = [0, 1, 2].map(|k| filter[k].powi(2) * linear(BACKGROUND[k]) + 0.05 * 0.2);
    assert_color(color, expected, "hollow sphere");
}

/// Oracle: a ball of glass is a strong lens. A wall that is white above and black below is seen upside down in it, and
/// upright past it.
#[test]
fn the_picture_in_the_glass_sphere_is_upside_down() {
    let film = picture(&scene(
        r#"
        resolution = [60, 60]
        depth = 6
        background = [0, 0, 0]
        camera = { eye = [0, 0, 0], look_at = [0, 0, -1], up = [0, 1, 0], vertical_fov = 28 }
        material.white = { ambient = 1 }
        material.glass = { transmission = 1, ior = 1.5 }
        [[object]]
        material = "white"
        shape.quad = { corner = [-100, 0, -200], edges = [[200, 0, 0], [0, 100, 0]] }
        [[object]]
        material = "glass"
        shape.sphere = { center = [0, 0, -71], radius = 8 }
        "#,
    ));
    for (x, y, color, what) in [
        (2, 20, Rgb::ONE, "beside the sphere, above"),
        (2, 40, Rgb::ZERO, "beside the sphere, below"),
        (30, 24, Rgb::ZERO, "in the sphere, above"),
        (30, 36, Rgb::ONE, "in the sphere, below"),
    ] {
        assert_eq!(film.pixel(x, y), color, "{what}");
    }
}

/// Oracle: the assignment's coordinates u = n.x/2 + 0.5, v = n.y/2 + 0.5: the middle of the sphere shows the middle of the
/// picture, whose colour is decoded here by another library call.
#[test]
fn pictures_stand_upright_on_sphere_and_quad() {
    let flower = image::open(concat!(env!("CARGO_MANIFEST_DIR"), "/textures/flower.png"))
        .expect("a picture")
        .to_rgb8();
    let texel_mean = |x: u32, y: u32| {
        let corner =
            |dx, dy| flower.get_pixel(x + dx, y + dy).0.map(|byte| linear(f64::from(byte) / 255.0));
        let corners = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
        [0, 1, 2].map(|k| corners.iter().map(|c| c[k]).sum::<f64>() / 4.0)
    };
    let wear = |shape: &str| {
        only_pixel(&looking_ahead(&format!(
            "texture.flower.image = \"flower.png\"\nmaterial.flower = {{ texture = \"flower\", ambient = 1 }}\n\
             [[object]]\nmaterial = \"flower\"\nshape.{shape}"
        )))
    };
    assert_color(
        wear("sphere = { center = [0, 0, -10], radius = 3 }"),
        texel_mean(149, 149),
        "sphere",
    );
    // n = (0.6, 0, 0.8) lies at u = 0.8: column 240, between texels 239 and 240.
    assert_color(
        wear("sphere = { center = [-3, 0, -10], radius = 5 }"),
        texel_mean(239, 149),
        "sphere, right",
    );
    // n = (0, 0.6, 0.8) lies at v = 0.8: row 60 from the top.
    assert_color(
        wear("sphere = { center = [0, -3, -10], radius = 5 }"),
        texel_mean(149, 59),
        "sphere, top",
    );
    let quad = |x: f64, y: f64| {
        wear(&format!("quad = {{ corner = [{x}, {y}, -5], edges = [[10, 0, 0], [0, 10, 0]] }}"))
    };
    assert_color(quad(-5.0, -5.0), texel_mean(149, 149), "quad");
    assert_color(quad(-9.0, -1.0), texel_mean(269, 269), "quad, lower right");
}

/// Oracle: docs/scene.md's normals in closed form, seen through the diffuse term of a light at the camera's side.
#[test]
fn cylinder_and_cone_are_lit_by_their_normals() {
    let lit = |shape: &str| {
        only_pixel(&looking_ahead(&format!(
            "light = [{{ position = [0, 1e9, 0], intensity = 1 }}, {{ position = [0, 0, 1e9], intensity = 0.25 }}]\n\
             material.white = {{ diffuse = 1 }}\n[[object]]\nmaterial = \"white\"\nshape.{shape}"
        )))
    };
    // Side of the cone at z > 0: n = (0, R, h)/√(R² + h²), tan t = R/h = 3/4.
    let cone =
        lit("cone = { base = [0, -2, -10], apex = [0, 2, -10], radius = 3, ends = \"closed\" }");
    assert_color(cone, [0.6 + 0.25 * 0.8; 3], "cone");
    let cylinder =
        lit("cylinder = { base = [0, -2, -10], top = [0, 2, -10], radius = 3, ends = \"open\" }");
    assert_color(cylinder, [0.25; 3], "cylinder");
    // An axis along the line of sight: the disc of a closed one faces the camera, an open one lets the ray pass.
    let drum =
        lit("cylinder = { base = [0, 0, -10], top = [0, 0, -8], radius = 3, ends = \"closed\" }");
    assert_color(drum, [0.25; 3], "drum");
    let pipe =
        lit("cylinder = { base = [0, 0, -10], top = [0, 0, -8], radius = 3, ends = \"open\" }");
    assert_color(pipe, BACKGROUND.map(linear), "pipe");
    // Lying on its side with the axis along x, the front is still at z > 0; off the middle the normal is tilted by
    // asin(1/2) towards +y.
    let lying = lit(
        "cylinder = { base = [-5, -1.5, -10], top = [5, -1.5, -10], radius = 3, ends = \"open\" }",
    );
    assert_color(lying, [0.5 + 0.25 * 0.75_f64.sqrt(); 3], "lying cylinder");
}

/// Oracle: the planes' normals: a side of a regular tetrahedron leans back by asin(1/3) from the vertical; the base faces down.
#[test]
fn the_tetrahedron_is_flat_shaded() {
    let lit = |camera: &str| {
        only_pixel(&format!(
            "resolution = [1, 1]\ndepth = 1\nbackground = [0, 0, 0]\n\
             camera = {{ {camera}, vertical_fov = 0.001 }}\n\
             light = [{{ position = [0, 1e9, 0], intensity = 0.5 }}, {{ position = [0, -1e9, 0], intensity = 0.75 }}]\n\
             material.white = {{ diffuse = 1 }}\n[[object]]\nmaterial = \"white\"\n\
             shape.tetrahedron = {{ base_center = [0, 0, 0], edge = 2, turn = 60 }}"
        ))
    };
    let side = lit("eye = [0.2, 0.4, -9], look_at = [0.1, 0.3, 0], up = [0, 1, 0]");
    assert_color(side, [0.5 / 3.0; 3], "side");
    let base = lit("eye = [0.1, -9, 0.1], look_at = [0.1, 0, 0.05], up = [0, 0, 1]");
    assert_color(base, [0.75; 3], "base");
}
