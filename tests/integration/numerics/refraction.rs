//! Bent and mirrored directions, at the critical angle and with nearly equal indices.
//!
//! Oracle: Snell's law for the exact angle between the given vectors, in 640 bits. As for distances, an error is counted
//! in what a last place of the inputs explains, 1/cos of the new angle being how much the law amplifies.

use glam::DVec3;
use whitted::geometry::{reflect, refract};

use super::big::{Big, BigVec, big, big_vec};
use super::oracle::{Answer, UNIT};
use super::random::{Random, rays, tenth};
use super::score::{K_MAX, Verdict, sweep};
use super::subject::{number, vector};

struct Case {
    dir: DVec3,
    normal: DVec3,
    from: f64,
    to: f64,
}

impl Case {
    /// The exact direction, of unit length, or `None` for total reflection, and the margin of that.
    fn right(&self) -> (Option<BigVec>, f64, f64) {
        let unit = |v: DVec3| {
            let v = big_vec(v);
            v.scaled(&(big(1.0) / v.length()))
        };
        let (d, n) = (unit(self.dir), unit(self.normal));
        let (from, to) = (big(self.from), big(self.to));
        let turn = n.cross(&d);
        let sine = &from * turn.length();
        let gap = &to - &sine;
        // The sine moves by a roundoff or two of each input.
        let margin = gap.f64().abs()
            / (UNIT * (self.to + 2.0 * self.from * turn.length().f64() + self.from));
        if gap.is_negative() {
            return (None, margin, 0.0);
        }
        let eta: Big = from / &to;
        let cosine = (gap * (&to + &sine)).sqrt() / to;
        let bent = turn.cross(&n).scaled(&eta).minus(&n.scaled(&cosine));
        (Some(bent), margin, cosine.f64())
    }

    fn judge(&self) -> Verdict {
        let (right, margin, cosine) = self.right();
        if margin < Answer::DECIDABLE {
            return Verdict::Undecidable;
        }
        match (right, refract(self.dir, self.normal, self.from, self.to)) {
            (None, None) => Verdict::Right { ks: vec![] },
            (Some(right), Some(bent)) => {
                let apart = right.minus(&big_vec(bent)).length().f64();
                let k = apart / (UNIT * (2.0 + 2.0 / cosine));
                if k > K_MAX || (bent.length() - 1.0).abs() > 4.0 * UNIT {
                    return Verdict::Wrong(format!("{bent}, K = {k}"));
                }
                Verdict::Right { ks: vec![k] }
            }
            (right, bent) => Verdict::Wrong(format!("{bent:?} for {:?}", right.map(|v| v.f64()))),
        }
    }

    fn code(&self) -> String {
        let (dir, normal) = (vector(self.dir), vector(self.normal));
        let (from, to) = (number(self.from), number(self.to));
        format!("refract({dir}, {normal}, {from}, {to})")
    }
}

/// A unit direction onto a surface at the angle whose sine is given, and the normal.
fn at_sine(sine: f64, random: &mut Random) -> (DVec3, DVec3) {
    let normal = random.direction();
    let along = random.across(normal);
    let dir = along * sine - normal * ((1.0 - sine) * (1.0 + sine)).max(0.0).sqrt();
    (dir.normalize(), normal)
}

/// Judges the cases that `make` makes, ever harder.
fn cases(family: &'static str, to: i32, mut make: impl FnMut(f64, &mut Random) -> Case) {
    sweep(family, 22, 1..=to, 1000, |k, random, tally| {
        let case = make(tenth(k), random);
        tally.record(case.judge(), || case.code());
    });
}

#[test]
fn critical_angle() {
    cases("refraction: critical angle ± 10^-k", 14, |off, random| {
        let (from, to) = (random.between(1.1, 2.5), 1.0);
        let angle = (to / from).asin() + random.sign() * off;
        let normal = random.direction();
        let dir = (random.across(normal) * angle.sin() - normal * angle.cos()).normalize();
        Case { dir, normal, from, to }
    });
}

#[test]
fn nearly_equal_indices() {
    cases("refraction: index 1 ± 10^-k", 15, |off, random| {
        let sine = random.pick(&[0.0, 0.5, 0.9, 0.999, 0.999_999]);
        let (dir, normal) = at_sine(sine, random);
        Case { dir, normal, from: 1.0, to: 1.0 + random.sign() * off }
    });
}

#[test]
fn grazing() {
    cases("refraction: grazing at 10^-k", 14, |angle, random| {
        let normal = random.direction();
        let dir = (random.across(normal) - normal * angle).normalize();
        let (from, to) = random.pick(&[(1.0, 1.5), (1.5, 1.0), (1.0, 1.000_001), (2.4, 2.4001)]);
        Case { dir, normal, from, to }
    });
}

#[test]
fn normal_incidence() {
    cases("refraction: 10^-k rad off the normal", 14, |angle, random| {
        let (dir, normal) = at_sine(angle.sin(), random);
        let (from, to) = random.pick(&[(1.0, 1.5), (1.5, 1.0), (1.0, 1.000_001), (2.4, 2.4001)]);
        Case { dir, normal, from, to }
    });
}

/// Equal indices are no surface at all, bit for bit.
#[test]
fn equal_indices_change_nothing() {
    let mut random = Random::new(23);
    for _ in 0..rays(10_000) {
        let (dir, normal) = at_sine(random.unit(), &mut random);
        let eta = random.between(1.0, 3.0);
        assert_eq!(refract(dir, normal, eta, eta), Some(dir), "{eta}");
    }
}

/// Oracle: the mirror image in 640 bits, each component of which may be rounded once.
#[test]
fn mirror_images() {
    let mut random = Random::new(24);
    let mut worst = 0.0_f64;
    for _ in 0..rays(20_000) {
        let normal = random.direction();
        let angle = 10.0_f64.powf(random.between(-14.0, 0.2));
        let dir = random.across(normal) * angle.cos() + normal * angle.sin();
        let (d, n) = (big_vec(dir), big_vec(normal));
        let right = d.minus(&n.scaled(&(d.dot(&n).shifted(1) / n.dot(&n))));
        let error = right.minus(&big_vec(reflect(dir, normal))).f64().abs();
        let allowed = right.f64().abs() * (UNIT * 1.01);
        assert!(error.cmple(allowed + 1e-30).all(), "reflect({}, {})", vector(dir), vector(normal));
        worst = worst.max((error / allowed).max_element());
    }
    assert!(worst > 0.5, "worth a bound: {worst}");
}
