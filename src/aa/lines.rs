//! Grids whose rows, or whose columns, each met one thing only: what is there runs along them.
//!
//! Where an edge crosses a grid at an angle, each row has it elsewhere between two samples, and what the rows are off by mostly
//! cancels. Where it runs along the columns, every row is off by as much, up to half the distance of two columns, and nothing that
//! samples of the pixel differ by shows how much.

use glam::Vec3;

use super::{
    Sample,
    levels::{levels, squared_distance},
};
use crate::color::Rgb;

/// In so many cases a thing that a single line met is narrower than the distance of two lines. In the others it is up to twice as wide,
/// and off by little.
const NARROW: f32 = 0.6;

/// Samples that differ by less than this part of what is expected of independent ones are of something even.
const EVEN: f32 = 0.1;

/// The columns of a grid of samples, or its rows, each of which met one thing only, but not all the same.
#[derive(Clone, Copy, Debug)]
pub struct Lines<'a> {
    samples: &'a [Sample],
    /// How many there are, and how many samples each has.
    side: usize,
    /// From a line to the next in the list of samples, and from a sample of a line to its next.
    steps: [usize; 2],
}

impl<'a> Lines<'a> {
    /// The lines of a grid of `side` × `side` samples, row by row; `None` if there are none.
    pub fn of(side: usize, samples: &'a [Sample]) -> Option<Self> {
        let first = samples.first()?.signature;
        if samples.iter().all(|sample| sample.signature == first) {
            return None;
        }
        let lines = [[1, side], [side, 1]].map(|steps| Self { samples, side, steps });
        lines.into_iter().find(|lines| {
            (0..side).all(|line| lines.of_line(line).all(|s| s.signature == lines.kind(line)))
        })
    }

    /// The squared error of the mean of all samples, in light: the edge between two lines may be anywhere between them, so each
    /// row is off by the variance of a uniform distribution, and all by the same.
    pub fn variance(&self) -> Rgb {
        let edge = |line: usize| {
            let is_edge = self.kind(line - 1) != self.kind(line);
            if is_edge { self.color(line) - self.color(line - 1) } else { Rgb::ZERO }
        };
        let squares: Rgb = (1..self.side).map(edge).map(|step| step * step).sum();
        squares / (12 * self.side * self.side) as f32
    }

    /// The squared error, in levels, if a single line met something narrow and all others the same: of two lines that of the
    /// first or the second, of more it is twice the same. `None` if there is no such line.
    ///
    /// What is narrower than the distance of two lines is met by one line or by none. Here it is taken for half as wide, so that
    /// one pixel has twice as much of it as it should, and another one, which is counted with it, nothing.
    pub fn lone_errors(&self) -> Option<[f32; 2]> {
        let last = self.side - 1;
        if last == 1 {
            return Some([self.lone_error(0, 1), self.lone_error(1, 0)]);
        }
        let common = if self.kind(0) == self.kind(1) { 0 } else { last };
        let mut others = (0..self.side).filter(|line| self.kind(*line) != self.kind(common));
        match (others.next(), others.next()) {
            (Some(lone), None) => Some([self.lone_error(lone, common); 2]),
            _ => None,
        }
    }

    fn lone_error(&self, lone: usize, common: usize) -> f32 {
        let missed = self.color(common);
        let met = missed + (self.color(lone) - missed) / self.side as f32;
        let [missed, truth, met] = [missed, (missed + met) / 2.0, met].map(levels);
        NARROW * (squared_distance(missed, truth) + squared_distance(truth, met))
    }

    fn of_line(&self, line: usize) -> impl Iterator<Item = &'a Sample> {
        let [next, along] = self.steps;
        self.samples.iter().skip(line * next).step_by(along).take(self.side)
    }

    fn kind(&self, line: usize) -> u32 {
        self.samples[line * self.steps[0]].signature
    }

    fn color(&self, line: usize) -> Rgb {
        self.of_line(line).map(|sample| sample.color).sum::<Rgb>() / self.side as f32
    }
}

/// Whether the samples of a grid of `side` × `side`, in levels, differ along its rows, or along its columns, by much less
/// than pictures would make them that each is off by, which is `detail` on average: what they show runs that way.
pub fn is_even_along_lines(side: usize, levels: &[Vec3], detail: f32) -> bool {
    let differences = |from_line: usize, along: usize| {
        let line = |line: usize| (0..side).map(move |k| levels[line * from_line + k * along]);
        let of_line = |number: usize| {
            let mean = line(number).sum::<Vec3>() / side as f32;
            line(number).map(|sample| squared_distance(sample, mean)).sum::<f32>()
        };
        (0..side).map(of_line).sum::<f32>()
    };
    let expected = detail * (side * (side - 1)) as f32;
    differences(1, side).min(differences(side, 1)) < EVEN * expected
}

/// The squared error, in levels, of a pixel of the colour `here`, whose edge is one between things of this and another colour, with
/// `side` samples from edge to edge: the edge of the things may be up to half the distance of two samples inside or outside.
pub fn border_error(here: Rgb, there: Rgb, side: usize) -> f32 {
    let inside = (there - here) / (2.0 * 3.0_f32.sqrt() * side as f32);
    0.5 * squared_distance(levels(here), levels(here + inside))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples of these things, each of them a grey of its number in tenths.
    fn samples(things: &[u32]) -> Vec<Sample> {
        let color = |thing: u32| Rgb::splat(thing as f32 / 10.0);
        let sample =
            |thing: &u32| Sample { color: color(*thing), signature: *thing, ..Sample::default() };
        things.iter().map(sample).collect()
    }

    #[test]
    fn lines_are_rows_or_columns_of_one_thing_each() {
        let has_lines = |side, things: &[u32]| Lines::of(side, &samples(things)).is_some();
        assert!(has_lines(2, &[1, 2, 1, 2]) && has_lines(2, &[1, 1, 2, 2]));
        assert!(has_lines(3, &[1, 2, 3, 1, 2, 3, 1, 2, 3]));
        assert!(!has_lines(2, &[1; 4]) && !has_lines(2, &[1, 2, 2, 1]) && !has_lines(2, &[]));
        assert!(!has_lines(3, &[1, 2, 2, 1, 2, 2, 1, 1, 2]));
    }

    /// Oracle: the mean squared error of n samples in a row at an edge, by its place in steps of a thousandth. One of n places between
    /// two lines is at the pixel's border, and half of the edges there are in the neighbour.
    #[test]
    fn an_edge_along_the_lines_is_off_by_its_place_between_them() {
        for side in [3_usize, 4, 8] {
            const PLACES: usize = 1000;
            let (mut off, mut said) = (0.0, 0.0);
            for place in 0..PLACES {
                let edge = place as f32 / PLACES as f32;
                let met = |k: usize| u32::from((k as f32 + 0.5) / side as f32 > edge);
                let things: Vec<u32> = (0..side * side).map(|k| met(k % side)).collect();
                let lit = things.iter().sum::<u32>() as f32 / (side * side) as f32;
                off += (lit - (1.0 - edge)).powi(2) / 100.0;
                said += Lines::of(side, &samples(&things)).map_or(0.0, |l| l.variance().x);
            }
            let seen = (side - 1) as f32 / side as f32;
            assert!((said / off / seen - 1.0).abs() < 0.01, "{side}: {said} for {off}");
        }
    }

    /// Oracle: the mean over places of an edge up to half the distance of two samples inside of the pixel, and as many outside.
    #[test]
    fn an_edge_at_the_border_may_be_inside() {
        for (here, there, side) in [(0.0, 1.0, 3), (1.0, 0.0, 3), (0.2, 0.5, 2), (0.6, 0.0, 8)] {
            const PLACES: usize = 1000;
            let [here, there] = [here, there].map(Rgb::splat);
            let inside = |k: usize| (k as f32 + 0.5) / PLACES as f32 / (2 * side) as f32;
            let off = |k| squared_distance(levels(here), levels(here + (there - here) * inside(k)));
            let off = (0..PLACES).map(off).sum::<f32>() / (2 * PLACES) as f32;
            let said = border_error(here, there, side);
            assert!((0.9..1.25).contains(&(said / off)), "{here} {there}: {said} for {off}");
        }
    }

    /// Oracle: what a bar a quarter, a half and three quarters as wide as the distance of two lines is off by at any place, in
    /// steps of a thousandth: between a third and three times of what is said.
    #[test]
    fn a_lone_line_is_off_by_what_it_met_and_what_others_missed() {
        for (side, part) in [2_usize, 3, 4, 8].into_iter().flat_map(|n| [(n, 1), (n, 2), (n, 3)]) {
            const PLACES: usize = 1000;
            let width = part as f32 / 4.0 / side as f32;
            let (mut off, mut said) = (0.0, 0.0);
            for place in 0..PLACES {
                let from = place as f32 / PLACES as f32 * (1.0 - width);
                let met = |k: usize| {
                    let place = (k as f32 + 0.5) / side as f32;
                    u32::from((from..from + width).contains(&place))
                };
                let samples = samples(&(0..side * side).map(|k| met(k % side)).collect::<Vec<_>>());
                let mean = samples.iter().map(|s| s.color).sum::<Rgb>() / (side * side) as f32;
                off += squared_distance(levels(mean), levels(Rgb::splat(0.1 * width)));
                if let Some(lines) = Lines::of(side, &samples) {
                    // Of two lines the second is as likely to be the lone one here.
                    let [first, second] = lines.lone_errors().expect("a lone line");
                    said += if lines.kind(0) == 1 { first } else { second };
                }
            }
            assert!((0.3..3.0).contains(&(said / off)), "{side}, {part}: {said} for {off}");
        }
    }

    #[test]
    fn a_lone_line_is_the_only_one_of_its_kind_among_others_of_one() {
        let lone = |things: &[u32]| {
            let samples = samples(&[things; 4].concat()[..things.len() * things.len()]);
            Lines::of(things.len(), &samples).expect("lines").lone_errors().is_some()
        };
        assert!(lone(&[1, 2]) && lone(&[1, 2, 1]) && lone(&[2, 1, 1]) && lone(&[1, 1, 1, 2]));
        assert!(!lone(&[1, 1, 2, 2]) && !lone(&[1, 2, 3]) && !lone(&[1, 2, 1, 2]));
    }
}
