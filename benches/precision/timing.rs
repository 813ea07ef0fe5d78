//! Time per test of each form, in turns.

use std::{hint::black_box, time::Instant};

use glam::{DVec3, Vec3};
use whitted::{
    accel::{
        Isa,
        study::{Work, run_compiled},
    },
    geometry::Ray,
};

use super::families::{any, towards};
use super::forms::{Cone, Cylinder, Form, Primitive, Quad, Quartet, Sphere, Triangle};
use super::numerics::random::Random;
use super::numerics::subject::Subject;

/// Tests in a row: enough that their outcomes are not learned by heart, few enough to stay in the cache.
const TESTS: usize = 2048;

/// Shapes that they take in turns.
const SHAPES: usize = 64;

/// Rows of each form; the median counts.
const ROUNDS: usize = 200;

/// Nanoseconds per test in each form, in the order of [`Form::ALL`], and the share of hits.
pub(crate) struct Times {
    pub(crate) primitive: Primitive,
    pub(crate) nanoseconds: [f64; 4],
    pub(crate) hits: f64,
}

struct Rays {
    single: Vec<(Vec3, Vec3)>,
    double: Vec<(DVec3, DVec3)>,
    library: Vec<Ray>,
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_unstable_by(f64::total_cmp);
    times[times.len() / 2]
}

/// A row of tests in one form.
struct Row<'a, Q> {
    form: Form,
    shapes: &'a [Q],
    rays: &'a Rays,
}

impl<Q: Quartet> Work for Row<'_, Q> {
    #[inline(always)]
    fn run(self) {
        let Self { form, shapes, rays } = self;
        match form {
            Form::SingleNaive => {
                for (shape, ray) in shapes.iter().cycle().zip(&rays.single) {
                    let (o, d) = black_box(ray);
                    black_box(black_box(shape).single_naive(*o, *d));
                }
            }
            Form::DoubleNaive => {
                for (shape, ray) in shapes.iter().cycle().zip(&rays.double) {
                    let (o, d) = black_box(ray);
                    black_box(black_box(shape).double_naive(*o, *d));
                }
            }
            Form::SingleRobust => {
                for (shape, ray) in shapes.iter().cycle().zip(&rays.single) {
                    let (o, d) = black_box(ray);
                    black_box(black_box(shape).single_robust(*o, *d));
                }
            }
            Form::DoubleRobust => {
                for (shape, ray) in shapes.iter().cycle().zip(&rays.library) {
                    black_box(black_box(shape).double_robust(black_box(ray)));
                }
            }
        }
    }
}

fn time<Q: Quartet>(isa: Isa, row: Row<'_, Q>) -> f64 {
    let started = Instant::now();
    run_compiled(isa, row);
    started.elapsed().as_secs_f64() * 1e9 / TESTS as f64
}

fn time_all<Q: Quartet>(isa: Isa, primitive: Primitive, make: impl Fn(&Subject) -> Q) -> Times {
    let mut random = Random::new(13);
    let subjects: Vec<Subject> = (0..SHAPES).map(|_| any(primitive, &mut random)).collect();
    let shapes: Vec<Q> = subjects.iter().map(make).collect();
    let mut shoot = |subject: &Subject| {
        let ray = towards(subject, random.between(1.0, 4.0), &mut random);
        Ray::new(ray.origin, ray.dir.normalize())
    };
    let library: Vec<Ray> = subjects.iter().cycle().take(TESTS).map(&mut shoot).collect();
    let rays = Rays {
        single: library.iter().map(|r| (r.origin.as_vec3(), r.dir.as_vec3())).collect(),
        double: library.iter().map(|r| (r.origin, r.dir)).collect(),
        library,
    };
    let hit = |(shape, ray): &(&Q, &Ray)| shape.double_robust(ray) > 0.0;
    let hits = shapes.iter().cycle().zip(&rays.library).filter(hit).count() as f64 / TESTS as f64;
    let mut times = [(); 4].map(|()| Vec::with_capacity(ROUNDS));
    for _ in 0..ROUNDS {
        for (form, times) in Form::ALL.iter().zip(&mut times) {
            times.push(time(isa, Row { form: *form, shapes: &shapes, rays: &rays }));
        }
    }
    Times { primitive, nanoseconds: times.map(|mut t| median(&mut t)), hits }
}

fn unexpected() -> ! {
    unreachable!("the primitive asked for")
}

/// Times every primitive, compiled for `isa`.
pub(crate) fn times(isa: Isa) -> Vec<Times> {
    vec![
        time_all(isa, Primitive::Sphere, |s| match *s {
            Subject::Sphere { center, radius } => Sphere::new(center, radius),
            _ => unexpected(),
        }),
        time_all(isa, Primitive::Cylinder, |s| match *s {
            Subject::Cylinder { base, top, radius, .. } => Cylinder::new(base, top, radius),
            _ => unexpected(),
        }),
        time_all(isa, Primitive::Cone, |s| match *s {
            Subject::Cone { base, apex, radius, .. } => Cone::new(base, apex, radius),
            _ => unexpected(),
        }),
        time_all(isa, Primitive::Quad, |s| match *s {
            Subject::Quad { corner, edge1, edge2 } => Quad::new(corner, edge1, edge2),
            _ => unexpected(),
        }),
        time_all(isa, Primitive::Triangle, |s| match *s {
            Subject::Triangle { vertices } => Triangle::new(vertices),
            _ => unexpected(),
        }),
    ]
}
