//! Scores rays against the oracle and keeps the tally of a family.

use std::fmt::Write;

use glam::DVec3;
use whitted::geometry::{Ray, Shape, Similarity};

use super::oracle::Answer;
use super::random::{Random, rays};
use super::subject::{Subject, vector};
use super::surface;

/// The bars of K: the largest, and that of all but one in a hundred.
pub(crate) const K_MAX: f64 = 16.0;
const K_99: f64 = 4.0;

/// What one ray showed.
pub(crate) enum Verdict {
    /// Inputs within their rounding have different answers.
    Undecidable,
    Right {
        ks: Vec<f64>,
    },
    Wrong(String),
}

/// All crossings of the line with the shape, whatever their scale.
fn crossings(shape: &Shape, ray: &Ray) -> Vec<(f64, u8)> {
    let reach = shape.bounds().largest_coordinate().max(ray.origin.abs().max_element());
    let map = Similarity::scaling(reach);
    let (image, scale) = map.ray(ray);
    let found = shape.mapped(&map).crossings(&image);
    found.iter().filter(|c| !c.t.is_nan()).map(|c| (scale.apply(c.t), c.face)).collect()
}

/// Compares every answer about `ray` and `subject` with the oracle's.
pub(crate) fn judge(subject: &Subject, shape: &Shape, ray: &Ray) -> Verdict {
    let (answer, question) = subject.answer(ray);
    if !answer.is_decidable() {
        return Verdict::Undecidable;
    }
    let found = crossings(shape, ray);
    if found.len() != answer.crossings.len() {
        let (found, right) = (found.len(), answer.crossings.len());
        return Verdict::Wrong(format!(
            "{found} crossings for {right}, margin {:.3e}",
            answer.margin
        ));
    }
    let mut ks = vec![];
    for ((t, face), right) in found.iter().zip(&answer.crossings) {
        if !t.is_finite() {
            return Verdict::Wrong(format!("t = {t:e} for {:e}", right.t.f64()));
        }
        let k = right.k(&question.parameter(*t));
        if k > K_MAX {
            return Verdict::Wrong(format!("t = {t:e}, K = {k:.3e}"));
        }
        if !right.faces.contains(face) {
            return Verdict::Wrong(format!("face {face} for {:?}", right.faces));
        }
        ks.push(k);
    }
    let sure = |c: &super::oracle::Crossing| c.margin() >= Answer::DECIDABLE;
    if answer.crossings.iter().all(sure) {
        let first = answer.crossings.iter().find(|c| c.t.is_positive());
        match (first, shape.first_hit(7, ray)) {
            (None, None) => {}
            (Some(right), Some((hit, at))) => {
                let k = right.k(&question.parameter(hit.t));
                if k > K_MAX || !right.faces.contains(&hit.face) || hit.primitive != 7 {
                    return Verdict::Wrong(format!("first hit {hit:?}, K = {k:.3e}"));
                }
                if let Err(why) = surface::check(subject, &question, right, &hit, &at) {
                    return Verdict::Wrong(format!("{why}: {at:?}"));
                }
            }
            (right, hit) => {
                let right = right.map(|c| c.t.f64());
                return Verdict::Wrong(format!("first hit {hit:?} for {right:?}"));
            }
        }
    }
    Verdict::Right { ks }
}

/// One severity of a family.
struct Row {
    name: String,
    rays: usize,
    scored: usize,
    crossed: usize,
    wrong: usize,
    /// Counts of K in steps of 1/16.
    ks: Vec<usize>,
    k_max: f64,
}

impl Row {
    fn k_99(&self) -> f64 {
        let total: usize = self.ks.iter().sum();
        let mut below = 0;
        for (bucket, count) in self.ks.iter().enumerate() {
            below += count;
            if below * 100 >= total * 99 {
                return (bucket + 1) as f64 / 16.0;
            }
        }
        f64::INFINITY
    }
}

/// The tally of a family.
pub(crate) struct Tally {
    family: &'static str,
    rows: Vec<Row>,
    failures: Vec<String>,
}

impl Tally {
    fn new(family: &'static str) -> Self {
        Self { family, rows: vec![], failures: vec![] }
    }

    /// Starts the row of a severity.
    fn severity(&mut self, name: &dyn ToString) {
        self.rows.push(Row {
            name: name.to_string(),
            rays: 0,
            scored: 0,
            crossed: 0,
            wrong: 0,
            ks: vec![0; 16 * 16 + 1],
            k_max: 0.0,
        });
    }

    /// Scores one ray against a fresh shape.
    pub(crate) fn score(&mut self, subject: &Subject, ray: Ray) {
        self.score_shape(subject, &subject.shape(), ray);
    }

    /// Scores one ray.
    pub(crate) fn score_shape(&mut self, subject: &Subject, shape: &Shape, ray: Ray) {
        let verdict = judge(subject, shape, &ray);
        self.record(verdict, || regression(subject, &ray));
    }

    /// Takes down a verdict; `code` is the test that repeats it.
    pub(crate) fn record(&mut self, verdict: Verdict, code: impl FnOnce() -> String) {
        let row = self.rows.last_mut().expect("a severity");
        row.rays += 1;
        match verdict {
            Verdict::Undecidable => {}
            Verdict::Right { ks } => {
                row.scored += 1;
                row.crossed += usize::from(!ks.is_empty());
                for k in ks {
                    let last = row.ks.len() - 1;
                    row.ks[((k * 16.0) as usize).min(last)] += 1;
                    row.k_max = row.k_max.max(k);
                }
            }
            Verdict::Wrong(why) => {
                row.scored += 1;
                row.wrong += 1;
                if row.wrong == 1 {
                    self.failures.push(format!("severity {}: {why}\n{}", row.name, code()));
                }
            }
        }
    }

    /// Prints the table and fails on a wrong answer, on a bar of K, or if too little was scored to tell.
    fn finish(self) {
        let mut table = String::new();
        let (mut rays, mut scored, mut crossed, mut wrong, mut k_99, mut k_max) =
            (0, 0, 0, 0, 0.0_f64, 0.0_f64);
        for row in &self.rows {
            let share = 100 * row.scored / row.rays.max(1);
            writeln!(
                table,
                "  {:>10}: {:>8} rays, {share:>3} % scored, {:>8} hits, {:>5} wrong, K 99 % {:.2}, max {:.2}",
                row.name,
                row.rays,
                row.crossed,
                row.wrong,
                row.k_99(),
                row.k_max
            )
            .expect("a string");
            (rays, scored) = (rays + row.rays, scored + row.scored);
            (crossed, wrong) = (crossed + row.crossed, wrong + row.wrong);
            k_max = k_max.max(row.k_max);
            if row.ks.iter().sum::<usize>() >= 100 {
                k_99 = k_99.max(row.k_99());
            }
        }
        println!(
            "{:<44} | {rays:>8} | {scored:>8} | {crossed:>8} | {wrong:>5} | {k_99:.2} | {k_max:.2}\n{table}",
            self.family
        );
        assert!(
            self.failures.is_empty(),
            "{}: {wrong} of {scored} wrong\n{}",
            self.family,
            self.failures.join("\n")
        );
        assert!(k_99 <= K_99, "{}: K of 99 % is {k_99}\n{table}", self.family);
        assert!(scored * 10 >= rays, "{}: only {scored} of {rays} scored\n{table}", self.family);
    }
}

/// The tally of a family: `count` rays for each severity, which `once` makes and scores.
pub(crate) fn sweep<S: Copy + ToString>(
    family: &'static str,
    seed: u64,
    severities: impl IntoIterator<Item = S>,
    count: usize,
    mut once: impl FnMut(S, &mut Random, &mut Tally),
) {
    let mut tally = Tally::new(family);
    let mut random = Random::new(seed);
    for severity in severities {
        tally.severity(&severity);
        for _ in 0..rays(count) {
            once(severity, &mut random, &mut tally);
        }
    }
    tally.finish();
}

/// A failing ray as a test.
fn regression(subject: &Subject, ray: &Ray) -> String {
    let (origin, dir) = (vector(ray.origin), vector(ray.dir));
    format!(
        "#[test]\nfn repeats_a_wrong_answer() {{\n    assert_right(\n        &{subject},\n        &Ray::new({origin}, {dir}),\n    );\n}}\n"
    )
}

/// Fails unless every answer about this ray is right; for rays that once were answered wrongly.
#[track_caller]
pub(crate) fn assert_right(subject: &Subject, ray: &Ray) {
    match judge(subject, &subject.shape(), ray) {
        Verdict::Right { .. } => {}
        Verdict::Undecidable => panic!("undecidable"),
        Verdict::Wrong(why) => panic!("{why}"),
    }
}

/// A printed failure names the ray to the last bit.
#[test]
fn a_failing_ray_prints_as_code() {
    let subject = Subject::Sphere { center: DVec3::new(0.1, -0.0, 1e-300), radius: 5e-324 };
    let code = regression(&subject, &Ray::new(DVec3::ONE / 3.0, DVec3::new(f64::NAN, 1.0, 0.0)));
    assert!(code.contains("DVec3::new(0.1, -0.0, 1e-300), radius: 5e-324"), "{code}");
    assert!(code.contains("DVec3::new(0.3333333333333333,"), "{code}");
    assert!(code.contains("f64::from_bits(0x7ff8000000000000)"), "{code}");
}
