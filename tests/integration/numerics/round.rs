//! The oracle of spheres, cylinders and cones: the roots of their equations, in high precision and with
//! their derivatives.
//!
//! A value carries the list `parts` of `wᵢ ∂value/∂xᵢ` over the local inputs xᵢ, wᵢ being the size of xᵢ; their
//! absolute sum tells by how much the value moves if every input moves by its last place.

use super::big::{Big, BigVec, big};
use super::oracle::{Answer, Crossing, UNIT};

/// Local inputs: the ray's start and direction, radius, height.
const INPUTS: usize = 8;

/// A ray in a solid's own frame, with y for the axis.
pub(crate) struct Local {
    pub(crate) f: BigVec,
    pub(crate) d: BigVec,
    /// The sizes of f's and d's components, as local inputs.
    pub(crate) sizes: [f64; 6],
    pub(crate) r: Big,
    pub(crate) h: Big,
}

/// A value and its derivatives.
#[derive(Clone)]
struct Graded {
    value: Big,
    parts: [f64; INPUTS],
}

impl Graded {
    /// By how much the value moves if every input moves by its own size.
    fn spread(&self) -> f64 {
        self.parts.iter().map(|p| p.abs()).sum()
    }

    fn minus(&self, other: &Self) -> Self {
        let parts = std::array::from_fn(|k| self.parts[k] - other.parts[k]);
        Self { value: &self.value - &other.value, parts }
    }

    /// How many units of roundoff the inputs are from a change of sign.
    fn margin(&self) -> f64 {
        let spread = self.spread();
        let size = self.value.f64().abs();
        if spread > 0.0 { size / (UNIT * spread) } else { f64::INFINITY }
    }

    fn crossing(&self, face: u8) -> Crossing {
        Crossing { t: self.value.clone(), spread: self.spread(), faces: vec![face] }
    }
}

/// What must hold for a hit: `met` or not, and how surely.
struct Condition {
    met: bool,
    margin: f64,
}

impl Condition {
    /// `value ≥ 0`.
    fn not_negative(value: &Graded) -> Self {
        Self { met: !value.value.is_negative(), margin: value.margin() }
    }

    fn not_positive(value: &Graded) -> Self {
        Self { met: !value.value.is_positive(), margin: value.margin() }
    }

    /// Whether all hold, and how surely: as the weakest of those that hold, or the strongest of those that do not.
    fn all(conditions: &[Self]) -> Self {
        let met = conditions.iter().all(|c| c.met);
        let margins = conditions.iter().filter(|c| c.met == met).map(|c| c.margin);
        let margin =
            if met { margins.fold(f64::INFINITY, f64::min) } else { margins.fold(0.0, f64::max) };
        Self { met, margin }
    }
}

/// The surface Σ βₖ qₖ² = γ, with the derivatives of its coefficients.
struct Quadric {
    beta: BigVec,
    gamma: Big,
    beta_r: BigVec,
    beta_h: BigVec,
    gamma_r: Big,
}

fn vec3(x: &Big, y: &Big, z: &Big) -> BigVec {
    BigVec([x.clone(), y.clone(), z.clone()])
}

impl Quadric {
    fn around_center(beta: [f64; 3], r: &Big) -> Self {
        let zero = BigVec([0, 1, 2].map(|_| big(0.0)));
        Self {
            beta: BigVec(beta.map(big)),
            gamma: r.square(),
            beta_r: zero.clone(),
            beta_h: zero,
            gamma_r: r.shifted(1),
        }
    }

    fn cone(r: &Big, h: &Big) -> Self {
        let zero = big(0.0);
        Self {
            beta: vec3(&h.square(), &-&r.square(), &h.square()),
            gamma: zero.clone(),
            beta_r: vec3(&zero, &-&r.shifted(1), &zero),
            beta_h: vec3(&h.shifted(1), &zero, &h.shifted(1)),
            gamma_r: zero,
        }
    }

    /// The discriminant b² − a c of a t² + 2 b t + c, and the coefficients.
    fn discriminant(&self, ray: &Local) -> (Graded, [Big; 3]) {
        let Local { f, d, sizes, r, h } = ray;
        let form = |beta: &BigVec| {
            let weighted = beta.times(d);
            (weighted.dot(d), weighted.dot(f), beta.times(f).dot(f))
        };
        let (a, b, c) = form(&self.beta);
        let c = c - &self.gamma;
        let value = b.square() - &a * &c;
        let mut parts = [0.0; INPUTS];
        for k in 0..3 {
            let two_beta = self.beta.0[k].shifted(1);
            let by_f = &two_beta * (&b * &d.0[k] - &a * &f.0[k]);
            let by_d = &two_beta * (&b * &f.0[k] - &c * &d.0[k]);
            parts[k] = sizes[k] * by_f.f64();
            parts[3 + k] = sizes[3 + k] * by_d.f64();
        }
        let by_size = |beta: &BigVec, gamma: &Big| {
            let (a1, b1, c1) = form(beta);
            (&b * &b1.shifted(1) - &a1 * &c - &a * (c1 - gamma)).f64()
        };
        parts[6] = r.f64() * by_size(&self.beta_r, &self.gamma_r);
        parts[7] = h.f64() * by_size(&self.beta_h, &big(0.0));
        (Graded { value, parts }, [a, b, c])
    }

    /// The derivatives of the root `t`.
    fn root(&self, t: Big, ray: &Local) -> Graded {
        let Local { f, d, sizes, r, h } = ray;
        let q = f.plus(&d.scaled(&t));
        let gradient = self.beta.times(&q); // half of it
        let slope = gradient.dot(d);
        if slope.is_zero() {
            return Graded { value: t, parts: [f64::INFINITY; INPUTS] };
        }
        let part = |size: f64, derivative: &Big| size * -(derivative / &slope).f64();
        let mut parts = [0.0; INPUTS];
        for k in 0..3 {
            parts[k] = part(sizes[k], &gradient.0[k]);
            parts[3 + k] = part(sizes[3 + k], &(&gradient.0[k] * &t));
        }
        let squares = q.times(&q);
        parts[6] = part(r.f64(), &(squares.dot(&self.beta_r) - &self.gamma_r).shifted(-1));
        parts[7] = part(h.f64(), &squares.dot(&self.beta_h).shifted(-1));
        Graded { value: t, parts }
    }

    /// Whether the line meets the surface, and where, in ascending order.
    fn roots(&self, ray: &Local) -> (Condition, Vec<Graded>, Big) {
        let (discriminant, [a, b, c]) = self.discriminant(ray);
        let meets = Condition::not_negative(&discriminant);
        if !meets.met {
            return (meets, vec![], a);
        }
        if a.is_zero() {
            let line = if b.is_zero() { vec![] } else { vec![-&(c / b.shifted(1))] };
            return (meets, line.into_iter().map(|t| self.root(t, ray)).collect(), a);
        }
        let root = discriminant.value.sqrt();
        let mut roots = [(-&b - &root) / &a, (&root - &b) / &a];
        roots.sort_by(|s, t| s.partial_cmp(t).expect("ordered"));
        (meets, roots.into_iter().map(|t| self.root(t, ray)).collect(), a)
    }
}

/// The height `f_y + t d_y − level`, `level` being the solid's height times −1, 0 or 1.
fn height_at(t: &Graded, ray: &Local, level: i32) -> Graded {
    let (dy, level) = (&ray.d.0[1], big(level.into()));
    let value = &ray.f.0[1] + &t.value * dy - &ray.h * &level;
    let mut parts = t.parts.map(|p| p * dy.f64());
    parts[1] += ray.sizes[1];
    parts[4] += ray.sizes[4] * t.value.f64();
    parts[7] -= (&ray.h * &level).f64();
    Graded { value, parts }
}

/// Where the ray meets the plane at that height; NaN-free: the ray must not be parallel to it.
fn plane(ray: &Local, level: i32) -> Graded {
    let (dy, level) = (&ray.d.0[1], big(level.into()));
    let value = (&ray.h * &level - &ray.f.0[1]) / dy;
    let mut parts = [0.0; INPUTS];
    parts[1] = -ray.sizes[1] / dy.f64();
    parts[4] = -ray.sizes[4] * (&value / dy).f64();
    parts[7] = (&ray.h * &level / dy).f64();
    Graded { value, parts }
}

/// The height of the start above a level, for a ray parallel to the ends.
fn start_above(ray: &Local, level: i32) -> Graded {
    let zero = Graded { value: big(0.0), parts: [0.0; INPUTS] };
    height_at(&zero, ray, level)
}

pub(crate) fn sphere(ray: &Local) -> Answer {
    let (meets, roots, _) = Quadric::around_center([1.0; 3], &ray.r).roots(ray);
    Answer { margin: meets.margin, crossings: roots.iter().map(|t| t.crossing(0)).collect() }
}

/// The crossings of an open side: of the `roots`, those for which `conditions` hold.
fn open(
    meets: &Condition,
    roots: &[Graded],
    conditions: impl Fn(&Graded) -> Vec<Condition>,
) -> Answer {
    let mut answer = Answer { margin: meets.margin, crossings: vec![] };
    for root in roots {
        let valid = Condition::all(&conditions(root));
        answer.margin = answer.margin.min(valid.margin);
        if valid.met {
            answer.crossings.push(root.crossing(0));
        }
    }
    answer
}

/// The crossings of a solid: all of `enters` must come before all of `exits`.
fn solid(
    mut conditions: Vec<Condition>,
    enters: &[(Graded, u8)],
    exits: &[(Graded, u8)],
) -> Answer {
    for (enter, _) in enters {
        for (exit, _) in exits {
            conditions.push(Condition::not_negative(&exit.minus(enter)));
        }
    }
    let hit = Condition::all(&conditions);
    let ordered = |(s, _): &&(Graded, u8), (t, _): &&(Graded, u8)| {
        s.value.partial_cmp(&t.value).expect("ordered")
    };
    let with_rivals = |winner: &(Graded, u8), all: &[(Graded, u8)]| {
        let mut crossing = winner.0.crossing(winner.1);
        for (rival, face) in all {
            // An edge of the solid: either face may win, and the less certain one excuses more.
            if *face != winner.1 && rival.minus(&winner.0).margin() < Answer::DECIDABLE {
                crossing.faces.push(*face);
                crossing.spread = crossing.spread.max(rival.spread());
            }
        }
        crossing
    };
    let crossings = match (enters.iter().max_by(ordered), exits.iter().min_by(ordered)) {
        (Some(enter), Some(exit)) if hit.met => {
            vec![with_rivals(enter, enters), with_rivals(exit, exits)]
        }
        _ => vec![],
    };
    Answer { margin: hit.margin, crossings }
}

/// Adds the half-space above (`up`) or below `level` to a solid.
fn cut(
    ray: &Local,
    (level, up, face): (i32, bool, u8),
    conditions: &mut Vec<Condition>,
    enters: &mut Vec<(Graded, u8)>,
    exits: &mut Vec<(Graded, u8)>,
) {
    let dy = &ray.d.0[1];
    if dy.is_zero() {
        let height = start_above(ray, level);
        conditions.push(if up {
            Condition::not_negative(&height)
        } else {
            Condition::not_positive(&height)
        });
    } else if dy.is_positive() == up {
        enters.push((plane(ray, level), face));
    } else {
        exits.push((plane(ray, level), face));
    }
}

pub(crate) fn cylinder(ray: &Local, closed: bool) -> Answer {
    let quadric = Quadric::around_center([1.0, 0.0, 1.0], &ray.r);
    let parallel = ray.d.0[0].is_zero() && ray.d.0[2].is_zero();
    let (mut conditions, mut enters, mut exits) = (vec![], vec![], vec![]);
    if parallel {
        // c ≤ 0: within the side. A ray along the axis does not meet an open side.
        if !closed {
            return Answer { margin: f64::INFINITY, crossings: vec![] };
        }
        let (fx, fz) = (&ray.f.0[0], &ray.f.0[2]);
        let value = fx.square() + fz.square() - ray.r.square();
        let mut parts = [0.0; INPUTS];
        parts[0] = 2.0 * ray.sizes[0] * fx.f64();
        parts[2] = 2.0 * ray.sizes[2] * fz.f64();
        parts[6] = -2.0 * ray.r.square().f64();
        conditions.push(Condition::not_positive(&Graded { value, parts }));
    } else {
        let (meets, roots, _) = quadric.roots(ray);
        if !closed {
            return open(&meets, &roots, |t| {
                let (above, below) = (height_at(t, ray, 0), height_at(t, ray, 1));
                vec![Condition::not_negative(&above), Condition::not_positive(&below)]
            });
        }
        conditions.push(meets);
        let mut roots = roots.into_iter();
        enters.extend(roots.next().map(|t| (t, 0)));
        exits.extend(roots.next().map(|t| (t, 0)));
    }
    cut(ray, (0, true, 1), &mut conditions, &mut enters, &mut exits);
    cut(ray, (1, false, 2), &mut conditions, &mut enters, &mut exits);
    solid(conditions, &enters, &exits)
}

pub(crate) fn cone(ray: &Local, closed: bool) -> Answer {
    let (meets, roots, a) = Quadric::cone(&ray.r, &ray.h).roots(ray);
    if roots.is_empty() && meets.met {
        return Answer { margin: 0.0, crossings: vec![] }; // along a generator: undecidable
    }
    if !closed {
        return open(&meets, &roots, |t| {
            let (top, base) = (height_at(t, ray, 0), height_at(t, ray, -1));
            vec![Condition::not_positive(&top), Condition::not_negative(&base)]
        });
    }
    let (mut conditions, mut enters, mut exits) = (vec![], vec![], vec![]);
    let rising = ray.d.0[1].is_positive();
    if a.is_positive() {
        // Both roots are on one nappe, which changes only where both heights do.
        let tops: Vec<_> = roots.iter().map(|t| height_at(t, ray, 0)).collect();
        if let [near, far] = &tops[..] {
            let margin = near.margin().max(far.margin());
            conditions.push(Condition { met: !near.value.is_positive(), margin });
        }
        conditions.push(meets);
        let mut roots = roots.into_iter();
        enters.extend(roots.next().map(|t| (t, 0)));
        exits.extend(roots.next().map(|t| (t, 0)));
    } else {
        // Through both nappes, or (a = 0) parallel to a generator: one root bounds the lower nappe.
        let lower = |t: &&Graded| !height_at(t, ray, 0).value.is_positive();
        let bound = roots.iter().find(lower).cloned();
        if bound.is_none() {
            let margin = height_at(&roots[0], ray, 0).margin();
            conditions.push(Condition { met: false, margin });
        }
        if rising { &mut exits } else { &mut enters }.extend(bound.map(|t| (t, 0)));
    }
    cut(ray, (-1, true, 1), &mut conditions, &mut enters, &mut exits);
    solid(conditions, &enters, &exits)
}
