//! At which severity of a family does each form begin to fail?

use std::fmt::{self, Display, Formatter};

use glam::DVec3;
use rayon::prelude::*;
use whitted::geometry::{Ray, Shape};

use super::families::{Family, Input, any};
use super::forms::{Form, Primitive, answer, rounded, rounded_subject};
use super::numerics::oracle::Answer;
use super::numerics::random::Random;
use super::numerics::subject::Subject;

/// Rays scored for each severity.
const RAYS: usize = 1000;

/// The largest K that counts as precise: what the inputs' own rounding explains, and a little more.
const K_MAX: f64 = 16.0;

/// Rays tried for them; where fewer can be decided, the inputs say too little.
const TRIES: usize = 4 * RAYS;

/// A rounding of single precision in those of double precision.
const COARSER: f64 = f32::EPSILON as f64 / f64::EPSILON;

/// How far a form gets in a family.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reach {
    /// Fails from this severity on.
    To(i32),
    /// Right up to this severity, from which on the form's inputs are too coarse for an answer.
    Limit(i32),
    /// Right at every severity.
    All,
}

impl Display for Reach {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::To(k) => write!(out, "{k}"),
            Self::Limit(k) => write!(out, "({k})"),
            Self::All => write!(out, "-"),
        }
    }
}

/// What a form showed in a family.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Score {
    /// Where more than 0.1 % of the rays are wrong: hit for miss, miss for hit, or `t` off by more than 1 % though the
    /// inputs determine it better.
    pub(crate) wrong: Reach,
    /// Where the 99th percentile of K is above 16; not asked of a user's scene in single precision.
    pub(crate) imprecise: Reach,
    /// The largest K while all is right.
    pub(crate) k_max: f64,
}

/// The scores of a family, in the order of [`Form::ALL`].
pub(crate) struct Row {
    pub(crate) primitive: Primitive,
    pub(crate) name: &'static str,
    pub(crate) scores: [Score; 4],
}

/// A tally of one form.
struct Tally {
    form: Form,
    wrong: Option<Reach>,
    imprecise: Option<Reach>,
    k_max: f64,
    count: usize,
    ks: Vec<f64>,
}

impl Tally {
    fn new(form: Form) -> Self {
        Self { form, wrong: None, imprecise: None, k_max: 0.0, count: 0, ks: vec![] }
    }

    fn is_open(&self) -> bool {
        self.wrong.is_none()
    }

    /// Scores one ray against the truth: the exact first `t`, and the K of a computed one.
    fn judge(&mut self, t: f64, truth: Option<f64>, k: impl Fn(f64) -> f64) {
        let Some(right) = truth else {
            self.count += usize::from(!t.is_nan());
            return;
        };
        let k = if t.is_finite() { k(t) } else { f64::INFINITY };
        let off = !((t - right).abs() <= 0.01 * right) && k > K_MAX;
        self.count += usize::from(off);
        self.ks.push(k);
    }

    fn end_severity(&mut self, severity: i32, scored: usize) {
        if self.is_open() {
            if scored < RAYS {
                self.wrong = Some(Reach::Limit(severity));
                self.imprecise.get_or_insert(Reach::Limit(severity));
            } else {
                if self.count * 1000 > scored {
                    self.wrong = Some(Reach::To(severity));
                }
                self.ks.sort_unstable_by(f64::total_cmp);
                let k_99 = self.ks.get(self.ks.len() * 99 / 100).copied().unwrap_or(0.0);
                if k_99 > K_MAX {
                    self.imprecise.get_or_insert(Reach::To(severity));
                }
                if self.is_open() {
                    self.k_max = self.ks.iter().copied().fold(self.k_max, f64::max);
                }
            }
        }
        self.ks.clear();
        self.count = 0;
    }

    fn score(self) -> Score {
        Score {
            wrong: self.wrong.unwrap_or(Reach::All),
            imprecise: self.imprecise.unwrap_or(Reach::All),
            k_max: self.k_max,
        }
    }
}

/// Asks the oracle about a ray and each form about the same, if the ray can be decided.
fn ask(
    tallies: &mut [Tally],
    subject: &Subject,
    ray: &Ray,
    asked: &(Subject, Ray),
    unit: f64,
) -> bool {
    let (right, question) = subject.answer(ray);
    let sure = |margin: f64| margin >= Answer::DECIDABLE * unit;
    if !sure(right.margin) || !right.crossings.iter().all(|c| sure(c.margin())) {
        return false;
    }
    let first = right.crossings.iter().find(|c| c.t.is_positive());
    let one = question.parameter(1.0).f64();
    let truth = first.map(|c| c.t.f64() / one);
    let shape: Shape = asked.0.shape();
    for tally in tallies.iter_mut().filter(|t| t.is_open()) {
        let t = answer(tally.form, &asked.0, &shape, &asked.1);
        tally.judge(t, truth, |t| first.map_or(0.0, |c| c.k(&question.parameter(t)) / unit));
    }
    true
}

/// Scores all forms of one precision.
fn sweep(family: &Family, forms: [Form; 2], seed: u64) -> [Score; 2] {
    let single = forms[0].is_single();
    let mut tallies = forms.map(Tally::new);
    let mut random = Random::new(seed);
    for severity in &family.severities {
        let mut scored = 0;
        for _ in 0..TRIES {
            if scored == RAYS || !tallies.iter().any(Tally::is_open) {
                break;
            }
            let (subject, ray) = (family.make)(family.primitive, *severity, &mut random);
            if !single {
                let asked = (subject.clone(), ray);
                scored += usize::from(ask(&mut tallies, &subject, &ray, &asked, 1.0));
                continue;
            }
            let near = Ray::new(rounded(ray.origin), rounded(ray.dir));
            let usable = near.origin.is_finite() && near.dir.is_finite() && near.dir != DVec3::ZERO;
            let Some(near_subject) = rounded_subject(&subject).filter(|_| usable) else {
                continue; // beyond single precision
            };
            let asked = (near_subject, near);
            scored += usize::from(match family.input {
                Input::Rounded => ask(&mut tallies, &asked.0, &asked.1, &asked, COARSER),
                Input::User => ask(&mut tallies, &subject, &ray, &asked, 1.0),
            });
        }
        for tally in &mut tallies {
            tally.end_severity(*severity, scored);
        }
    }
    tallies.map(|tally| {
        let mut score = tally.score();
        if single && family.input == Input::User {
            score.imprecise = score.wrong;
            score.k_max = f64::NAN;
        }
        score
    })
}

/// The scores of families, which run side by side.
pub(crate) fn score(families: &[Family]) -> Vec<Row> {
    families
        .par_iter()
        .enumerate()
        .map(|(index, family)| {
            let seed = 0x0acc_0ac1 + index as u64;
            let [a, c] = sweep(family, [Form::SingleNaive, Form::SingleRobust], seed);
            let [b, d] = sweep(family, [Form::DoubleNaive, Form::DoubleRobust], seed);
            Row { primitive: family.primitive, name: family.name, scores: [a, b, c, d] }
        })
        .collect()
}

/// The angles that are asked of single precision: beyond, the rounded direction is itself off by a per cent.
const SINGLE_ANGLES: i32 = 5;

/// Rays that leave a sphere at 10⁻ᵏ rad: outward nothing may be met, inward the chord must be right to 1 %.
///
/// The textbook ignores what is nearer than a fixed 1e-3 (single precision) or 1e-6 (double precision).
pub(crate) fn leaving() -> Row {
    let sweep = |form: Form| {
        let mut tally = Tally::new(form);
        let mut random = Random::new(12);
        let last = if form.is_single() { SINGLE_ANGLES } else { 12 };
        for k in 1..=last {
            for _ in 0..RAYS {
                let subject = any(Primitive::Sphere, &mut random);
                let (t, truth) = leave(form, &subject, k, &mut random);
                tally.judge(t, truth, |_| f64::INFINITY);
            }
            tally.end_severity(k, RAYS);
        }
        if form.is_single() && tally.is_open() {
            tally.wrong = Some(Reach::Limit(last + 1));
        }
        let mut score = tally.score();
        (score.imprecise, score.k_max) = (score.wrong, f64::NAN);
        score
    };
    let name = "leaving at 10^-k rad: acne, or t off by 1 %";
    Row { primitive: Primitive::Sphere, name, scores: Form::ALL.map(sweep) }
}

/// Meets a sphere and leaves it at an angle of 10⁻ᵏ: the next `t` as `form` finds it, and the right one.
fn leave(form: Form, subject: &Subject, k: i32, random: &mut Random) -> (f64, Option<f64>) {
    let &Subject::Sphere { center, radius } = subject else { unreachable!("a sphere") };
    let shape = subject.shape();
    let toward = random.direction();
    let aim = center + random.across(toward) * (radius * 0.9 * random.unit());
    let ray = Ray::new(rounded(aim - toward * 4.0), rounded(toward));
    let (inward, angle) = (random.flip(), 10.0_f64.powi(-k));
    let turn = if inward { -angle } else { angle };
    let chord = |q: DVec3, d: DVec3| inward.then(|| -2.0 * q.dot(d) / d.dot(d));
    match form {
        Form::DoubleRobust => {
            let (hit, surface) = shape.first_hit(0, &ray).expect("aimed at it");
            let dir = random.across(surface.normal) + surface.normal * turn;
            let t = shape.first_hit(0, &surface.leave(&hit, dir, inward));
            (t.map_or(f64::NAN, |(hit, _)| hit.t), chord(surface.local, dir))
        }
        Form::DoubleNaive => {
            let point = ray.origin + ray.dir * answer(form, subject, &shape, &ray);
            let normal = (point - center) / radius;
            let dir = random.across(normal) + normal * turn;
            let start = point + dir * 1e-6;
            let t = answer(form, subject, &shape, &Ray::new(start, dir));
            (t + 1e-6, chord(point - center, dir))
        }
        Form::SingleNaive => {
            let t = answer(form, subject, &shape, &ray) as f32;
            let point = ray.origin.as_vec3() + ray.dir.as_vec3() * t;
            let normal = ((point - center.as_vec3()) / radius as f32).as_dvec3();
            let dir = rounded(random.across(normal) + normal * turn);
            let start = (point + dir.as_vec3() * 1e-3).as_dvec3();
            let t = answer(form, subject, &shape, &Ray::new(start, dir));
            (t + 1e-3, chord(point.as_dvec3() - center, dir))
        }
        Form::SingleRobust => {
            // The library's rule: outward never, inward −2 q·d/d·d from the local point.
            let t = answer(form, subject, &shape, &ray) as f32;
            let q = ray.origin.as_vec3() - center.as_vec3() + ray.dir.as_vec3() * t;
            let q = q.normalize() * radius as f32;
            let normal = q.as_dvec3().normalize();
            let dir = rounded(random.across(normal) + normal * turn);
            let d = dir.as_vec3();
            let t = if inward { -2.0 * q.dot(d) / d.length_squared() } else { f32::NAN };
            (f64::from(t), chord(q.as_dvec3(), dir))
        }
    }
}
