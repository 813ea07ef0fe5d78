//! Any bits whatever: no panic, no NaN out, and a message that says what is wrong with a shape.

use glam::{DVec2, DVec3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use whitted::accel::{Accel, brute};
use whitted::camera::Camera;
use whitted::geometry::{
    Bounds, Cone, Cylinder, Ends, Polygon, Quad, Ray, Shape, ShapeError, Similarity, Sphere,
    Surface, Triangle, reflect, refract, tetrahedron::tetrahedron,
};
use whitted::math::{self, Frame, Roots, scale};

use super::random::rays;

/// Numbers that break things, among ordinary ones and arbitrary bits.
fn number() -> BoxedStrategy<f64> {
    prop_oneof![
        4 => -10.0..10.0_f64,
        2 => any::<u64>().prop_map(f64::from_bits),
        1 => (-4_i32..5).prop_map(f64::from),
        1 => prop::sample::select(vec![
            0.0, -0.0, 1.0, -1.0, 5e-324, f64::MIN_POSITIVE, f64::MAX, f64::MIN, f64::INFINITY,
            f64::NEG_INFINITY, f64::NAN, 1e-160, 1e160, f64::EPSILON,
        ]),
    ]
    .boxed() // the trees of values are too large for a stack
}

fn vector() -> BoxedStrategy<DVec3> {
    prop_oneof![
        3 => [-4.0..4.0_f64, -4.0..4.0_f64, -4.0..4.0_f64].prop_map(DVec3::from_array),
        2 => [number(), number(), number()].prop_map(DVec3::from_array),
        1 => [-1..2_i32, -1..2_i32, -1..2_i32].prop_map(|v| DVec3::from_array(v.map(f64::from))),
    ]
    .boxed()
}

fn shape() -> BoxedStrategy<Result<Shape, ShapeError>> {
    let ends = || prop::sample::select(vec![Ends::Open, Ends::Closed]);
    prop_oneof![
        (vector(), number()).prop_map(|(c, r)| Sphere::try_new(c, r).map(Into::into)),
        (vector(), vector(), number(), ends())
            .prop_map(|(p, q, r, e)| Cylinder::try_new(p, q, r, e).map(Into::into)),
        (vector(), vector(), number(), ends())
            .prop_map(|(p, q, r, e)| Cone::try_new(p, q, r, e).map(Into::into)),
        (vector(), vector(), vector()).prop_map(|(p, q, r)| Quad::try_new(p, q, r).map(Into::into)),
        [vector(), vector(), vector()].prop_map(|v| Triangle::try_new(v).map(Into::into)),
        prop::collection::vec(vector(), 0..6).prop_map(|v| Polygon::try_new(v).map(Into::into)),
    ]
    .boxed()
}

fn ray() -> impl Strategy<Value = Ray> {
    (vector(), vector()).prop_map(|(origin, dir)| Ray::new(origin, dir))
}

/// Runs `cases` with a fixed seed.
fn run<T: Strategy>(
    cases: usize,
    strategy: &T,
    test: impl Fn(T::Value) -> Result<(), TestCaseError>,
) {
    let cases = u32::try_from(rays(cases)).expect("fewer than 2^32 cases");
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[7; 32]);
    if let Err(error) = TestRunner::new_with_rng(config, rng).run(strategy, test) {
        panic!("{error}");
    }
}

/// What a surface must be whatever it was found from.
fn check_surface(surface: &Surface) -> Result<(), TestCaseError> {
    prop_assert!(surface.point.is_finite() && surface.local.is_finite(), "{surface:?}");
    prop_assert!((surface.normal.length() - 1.0).abs() < 1e-15, "{surface:?}");
    prop_assert!(surface.error >= 0.0 && surface.error.is_finite(), "{surface:?}");
    prop_assert!(surface.uv.is_finite() && surface.point_rest.is_finite(), "{surface:?}");
    Ok(())
}

/// Whether all that goes in is within the range of scales that squares of squares survive.
fn is_ordinary(shape: &Shape, ray: &Ray) -> bool {
    let within = |x: f64| x == 0.0 || (1e-150..1e150).contains(&x.abs());
    let bounds = shape.bounds();
    let sizes = [bounds.min, bounds.max, bounds.extent(), ray.origin, ray.dir];
    sizes.iter().all(|v| v.to_array().into_iter().all(within)) && ray.dir != DVec3::ZERO
}

#[test]
fn first_hit_is_never_nan() {
    run(60_000, &(shape(), ray(), vector(), any::<bool>()), |(shape, ray, dir, inward)| {
        let Ok(shape) = shape else { return Ok(()) };
        let Some((hit, surface)) = shape.first_hit(0, &ray) else { return Ok(()) };
        prop_assert!(hit.t > 0.0 && hit.face <= 2, "{hit:?}");
        if !is_ordinary(&shape, &ray) {
            return Ok(());
        }
        check_surface(&surface)?;
        let next = surface.leave(&hit, dir, inward);
        prop_assert!(next.origin.is_finite());
        if let Some((hit, surface)) = shape.first_hit(0, &next)
            && is_ordinary(&shape, &next)
        {
            prop_assert!(hit.t > 0.0 && inward, "{hit:?}");
            check_surface(&surface)?;
        }
        Ok(())
    });
}

/// The accelerator's and the shapes' own entry points, without the care of [`Shape::first_hit`] for scale.
#[test]
fn raw_entry_points_do_not_panic() {
    run(40_000, &([shape(), shape(), shape()], ray(), number()), |(shapes, ray, end)| {
        let shapes: Vec<Shape> = shapes.into_iter().flatten().collect();
        let bounds = shapes.iter().fold(Bounds::EMPTY, |b, s| b.union(s.bounds()));
        for shape in &shapes {
            let found = shape.crossings(&ray);
            prop_assert!(found.iter().all(|c| c.face <= 2), "{found:?}");
            prop_assert!(!(found[0].t > found[1].t), "{found:?}");
        }
        let hit = brute::nearest(&shapes, &ray, end);
        prop_assert!(hit.is_none_or(|hit| hit.t > 0.0 && hit.t < end), "{hit:?}");
        let corners = [bounds.min, bounds.max];
        let map = Similarity::normalizing(&bounds, corners.into_iter());
        let images: Vec<Shape> = shapes.iter().map(|s| s.mapped(&map)).collect();
        let (image, scale) = map.ray(&ray);
        let accel = Accel::build(images);
        if let Some(hit) = accel.nearest(&image, f64::INFINITY) {
            prop_assert!(hit.t > 0.0 && !scale.apply(hit.t).is_nan(), "{hit:?}");
            accel.shape(hit.primitive).surface(&image, &hit);
        }
        Ok(())
    });
}

/// A shape that could be made has a box that holds something, with numbers in it.
#[test]
fn made_shapes_are_finite_inside() {
    run(40_000, &shape(), |shape| {
        match shape {
            Ok(shape) => {
                let bounds = shape.bounds();
                prop_assert!(!bounds.is_empty(), "{shape:?}: {bounds:?}");
                prop_assert!(!format!("{shape:?}").contains("NaN"), "{shape:?}");
            }
            Err(error) => prop_assert!(error.to_string().len() > 20, "{error}"),
        }
        Ok(())
    });
}

#[test]
fn numbers_and_directions_do_not_panic() {
    run(40_000, &([vector(), vector(), vector()], number(), number()), |([u, v, w], x, y)| {
        let finite = |v: DVec3| v.is_finite() && v.abs().max_element() < 1e100;
        math::cross(u, v);
        math::dot(u, w);
        let (s, t) = Roots::new(x, y, u.x, v.x).sorted();
        prop_assert!(!(s > t));
        scale::normalized(w);
        scale::scaled(w, y as i32);
        if let Some(unit) = u.try_normalize() {
            let frame = Frame::around(unit);
            prop_assert!(frame.axis() == unit);
            if finite(v) {
                prop_assert!(frame.to_world(frame.to_local(v)).is_finite());
                prop_assert!(reflect(v, unit).is_finite());
            }
            if let (Some(normal), true) = (v.try_normalize(), (0.5..4.0).contains(&x.abs())) {
                let bent = refract(unit, normal, x.abs(), 1.0);
                prop_assert!(bent.is_none_or(|d| (d.length() - 1.0).abs() < 1e-15), "{bent:?}");
            }
        }
        refract(u, v, x, y);
        reflect(u, v);
        let planes = tetrahedron(u, x, y);
        prop_assert!(planes.is_err() || (u.is_finite() && x > 0.0 && y.is_finite()));
        Ok(())
    });
}

/// Each kind of wrong input with the message that names it.
#[test]
fn degenerate_shapes_are_refused_by_name() {
    let (zero, one, nan) = (DVec3::ZERO, DVec3::ONE, DVec3::new(0.0, f64::NAN, 0.0));
    let (open, closed) = (Ends::Open, Ends::Closed);
    let text = |error: Option<ShapeError>| error.map_or("accepted".into(), |e| e.to_string());
    let line = [zero, one, one * 2.0];
    let bent = vec![zero, DVec3::X, DVec3::new(1.0, 1.0, 0.1), DVec3::Y];
    let dart = vec![zero, DVec3::new(0.2, 0.2, 0.0), DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
    let point =
        |k: u32| DVec2::from_angle(f64::from(2 * k) * std::f64::consts::TAU / 5.0).extend(0.0);
    let star = (0..5).map(point).collect();
    let cases = [
        (text(Sphere::try_new(zero, 0.0).err()), "`radius` is 0"),
        (text(Sphere::try_new(zero, -1.0).err()), "`radius` is -1"),
        (text(Sphere::try_new(zero, f64::NAN).err()), "`radius` is NaN"),
        (text(Sphere::try_new(nan, 1.0).err()), "`center` is ([0, NaN, 0])"),
        (text(Cylinder::try_new(zero, one, f64::INFINITY, open).err()), "`radius` is inf"),
        (text(Cylinder::try_new(one, one, 1.0, closed).err()), "`base` and `top` are both"),
        (text(Cone::try_new(one, one, 1.0, closed).err()), "`base` and `apex` are both"),
        (text(Cone::try_new(zero, nan, 1.0, open).err()), "`apex` is ([0, NaN, 0])"),
        (text(Quad::try_new(zero, one, one * 2.0).err()), "on one line"),
        (text(Quad::try_new(zero, zero, one).err()), "on one line"),
        (text(Quad::try_new(nan, DVec3::X, DVec3::Y).err()), "`corner` is ([0, NaN, 0])"),
        (text(Triangle::try_new(line).err()), "on one line"),
        (text(Triangle::try_new([zero, zero, zero]).err()), "on one line"),
        (text(Polygon::try_new(line[..2].to_vec()).err()), "has 2 corners"),
        (text(Polygon::try_new(bent).err()), "off the plane"),
        (text(Polygon::try_new(dart).err()), "not convex at corner"),
        (text(Polygon::try_new(star).err()), "goes round more than once"),
        (text(tetrahedron(zero, 0.0, 0.0).err()), "`edge` is 0"),
    ];
    for (message, part) in cases {
        assert!(message.contains(part), "{message:?} for {part:?}");
    }
}

/// Products of three lengths leave the range of numbers long before lengths do.
#[test]
fn polygons_and_lines_of_sight_may_have_any_length() {
    for size in [1e-300, 1e-100, 1.0, 1e100, 1e160, 1e300] {
        let pentagon = (0..5).map(|k| {
            DVec2::from_angle(f64::from(k) * std::f64::consts::TAU / 5.0).extend(0.0) * size
        });
        Polygon::try_new(pentagon.collect()).expect("convex");
        let dart = [[0.0, 0.0], [0.2, 0.2], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let dart = dart.map(|[x, y]| DVec3::new(x, y, 0.0) * size);
        let refused = Polygon::try_new(dart.to_vec()).expect_err("not convex");
        assert!(matches!(refused, ShapeError::NotConvex { index: 1 }), "{size}: {refused}");
    }
    let far = DVec3::X * f64::MAX;
    let camera = Camera::try_new(-far, far, DVec3::Y, 40.0).expect("apart");
    assert_eq!(camera.view(2, 2).direction(DVec2::ONE).normalize(), DVec3::X);
}

/// A surface that holds coordinates holds them in the unit square.
#[test]
fn surface_coordinates_are_in_the_unit_square() {
    run(20_000, &(shape(), ray()), |(shape, ray)| {
        if let Ok(shape) = shape
            && is_ordinary(&shape, &ray)
            && let Some((_, surface)) = shape.first_hit(0, &ray)
        {
            let uv = surface.uv.clamp(DVec2::splat(-1e-3), DVec2::splat(1.0 + 1e-3));
            prop_assert!(surface.uv == uv, "{shape:?}: {surface:?}");
        }
        Ok(())
    });
}
