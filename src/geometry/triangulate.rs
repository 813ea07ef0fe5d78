//! Polygons into triangles, concave ones too, with nothing lost at their edges.
//!
//! Convex polygons are fans; the others are cut by ear clipping (the crate `earcut`, a port of Mapbox's). Ear clipping
//! leaves out corners that lie on the line between their neighbours, which would leave cracks where another face uses
//! them, so these are put back.

use glam::{DVec2, DVec3};

/// Cuts polygons; keeps its memory from one to the next.
#[derive(Default)]
pub struct Triangulator {
    clipper: earcut::Earcut<f64>,
    flat: Vec<DVec2>,
    clipped: Vec<u32>,
    /// The triangles of the last polygon, as places among its corners.
    triangles: Vec<[u32; 3]>,
    used: Vec<bool>,
}

impl std::fmt::Debug for Triangulator {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Triangulator").finish_non_exhaustive()
    }
}

/// The vector area of a polygon: half the sum of the cross products of successive corners, seen from the first.
pub fn vector_area(corners: &[DVec3]) -> DVec3 {
    let spoke = |v: DVec3| v - corners[0];
    corners[1..].windows(2).map(|w| spoke(w[0]).cross(spoke(w[1]))).sum::<DVec3>() * 0.5
}

impl Triangulator {
    /// The triangles of the polygon of three or more `corners`, with the same orientation, as places among them.
    pub fn cut(&mut self, corners: &[DVec3]) -> &[[u32; 3]] {
        self.triangles.clear();
        match corners.len() {
            0..=2 => {}
            3 => self.triangles.push([0, 1, 2]),
            4 => self.cut_quad(corners),
            count => {
                self.project(corners);
                // Coordinates so far apart that their differences overflow have no better cut either.
                if is_convex(&self.flat)
                    || !self.flat.iter().all(|p| p.is_finite())
                    || goes_round_again(&self.flat)
                {
                    self.triangles.extend((1..count as u32 - 1).map(|k| [0, k, k + 1]));
                } else {
                    self.clip();
                }
            }
        }
        &self.triangles
    }

    /// By the diagonal that lies inside.
    fn cut_quad(&mut self, corners: &[DVec3]) {
        let area = vector_area(corners);
        let faces_front = |a: usize, b: usize, c: usize| {
            (corners[b] - corners[a]).cross(corners[c] - corners[a]).dot(area) > 0.0
        };
        let first = faces_front(0, 1, 2) && faces_front(0, 2, 3);
        let other = faces_front(0, 1, 3) && faces_front(1, 2, 3);
        self.triangles.extend(if first || !other {
            [[0, 1, 2], [0, 2, 3]]
        } else {
            [[0, 1, 3], [1, 2, 3]]
        });
    }

    /// The corners in the coordinate plane that shows most of the polygon, counterclockwise.
    fn project(&mut self, corners: &[DVec3]) {
        let area = vector_area(corners);
        let size = area.abs();
        let seen = |v: DVec3| {
            let v = v - corners[0];
            if size.x > size.y && size.x > size.z {
                DVec2::new(v.y, v.z * area.x.signum())
            } else if size.y > size.z {
                DVec2::new(v.z, v.x * area.y.signum())
            } else {
                DVec2::new(v.x, v.y * area.z.signum())
            }
        };
        self.flat.clear();
        self.flat.extend(corners.iter().map(|v| seen(*v)));
    }

    fn clip(&mut self) {
        let points = self.flat.iter().map(glam::DVec2::to_array);
        self.clipper.earcut(points, &[], &mut self.clipped);
        for triangle in self.clipped.chunks_exact(3) {
            let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
            let [p, q, r] = [a, b, c].map(|k| self.flat[k as usize]);
            let forward = (q - p).perp_dot(r - p) >= 0.0;
            self.triangles.push(if forward { [a, b, c] } else { [a, c, b] });
        }
        if self.triangles.is_empty() {
            // An outline that crosses itself so that clipping finds no ear.
            self.triangles.extend((1..self.flat.len() as u32 - 1).map(|k| [0, k, k + 1]));
            return;
        }
        self.put_back();
    }

    /// Splits triangles at the corners that clipping left out, each on the edge between those used before and after it.
    fn put_back(&mut self) {
        let count = self.flat.len();
        self.used.clear();
        self.used.resize(count, false);
        for corner in self.triangles.iter().flatten() {
            self.used[*corner as usize] = true;
        }
        let Some(start) = self.used.iter().position(|used| *used) else {
            return; // no area at all
        };
        let mut k = 0;
        while k < count {
            let from = (start + k) % count;
            let mut run = 1;
            while !self.used[(from + run) % count] {
                run += 1;
            }
            if run > 1 {
                self.split_edge(from, run);
            }
            k += run;
        }
    }

    /// Replaces the triangle at the edge from corner `from` to the one `run` further by a fan over the corners between.
    fn split_edge(&mut self, from: usize, run: usize) {
        let count = self.flat.len();
        let (a, b) = (from as u32, ((from + run) % count) as u32);
        let edge = |t: &[u32; 3]| (0..3).find(|&k| t[k] == a && t[(k + 1) % 3] == b);
        let Some((place, side)) =
            self.triangles.iter().enumerate().find_map(|(i, t)| edge(t).map(|side| (i, side)))
        else {
            return; // the outline crosses itself
        };
        let tip = self.triangles.swap_remove(place)[(side + 2) % 3];
        let corner = |k: usize| ((from + k) % count) as u32;
        self.triangles.extend((0..run).map(|k| [corner(k), corner(k + 1), tip]));
    }
}

/// Whether an outline of many corners goes over the same places more than twice, once being enough to reach a hole and
/// come back: it crosses itself everywhere, and clipping it takes cubic time.
fn goes_round_again(outline: &[DVec2]) -> bool {
    const MANY: usize = 64;
    if outline.len() < MANY {
        return false;
    }
    let mut places: Vec<[u64; 2]> =
        outline.iter().map(|p| (*p + 0.0).to_array().map(f64::to_bits)).collect();
    places.sort_unstable();
    places.dedup();
    outline.len() > 2 * places.len()
}

/// Whether a counterclockwise outline turns left at every corner, and once in all.
fn is_convex(outline: &[DVec2]) -> bool {
    let count = outline.len();
    let edge = |k: usize| outline[(k + 1) % count] - outline[k % count];
    // It turns once if its edges change from leftward to rightward, or back, twice.
    let (mut changes, mut leftward) = (0, edge(count - 1).x < 0.0);
    for k in 0..count {
        if !(edge(k).perp_dot(edge(k + 1)) > 0.0) {
            return false;
        }
        let next = edge(k).x < 0.0;
        changes += u32::from(next != leftward);
        leftward = next;
    }
    changes <= 2
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area_of(corners: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
        let area = |t: &[u32; 3]| vector_area(&t.map(|k| corners[k as usize])).length();
        triangles.iter().map(area).sum()
    }

    /// Oracle: triangles that overlap nowhere and leave nothing out have the area of the polygon; and every edge of the
    /// outline belongs to one triangle, the right way round.
    fn check(corners: &[DVec3]) {
        let mut triangulator = Triangulator::default();
        let triangles = triangulator.cut(corners).to_vec();
        let (whole, parts) = (vector_area(corners).length(), area_of(corners, &triangles));
        assert!((whole - parts).abs() <= 1e-12 * whole, "{whole} cut into {parts}");
        let count = corners.len() as u32;
        for k in 0..count {
            let next = (k + 1) % count;
            let has = |t: &&[u32; 3]| (0..3).any(|i| t[i] == k && t[(i + 1) % 3] == next);
            assert_eq!(triangles.iter().filter(has).count(), 1, "edge {k} of {count}");
        }
        assert_eq!(triangles.len(), corners.len() - 2);
    }

    fn star(points: u32, inner: f64, tilt: DVec3) -> Vec<DVec3> {
        let corner = |k: u32| {
            let (angle, r) = (
                f64::from(k) * std::f64::consts::PI / f64::from(points),
                if k.is_multiple_of(2) { 1.0 } else { inner },
            );
            let (x, y) = (r * angle.cos(), r * angle.sin());
            DVec3::new(x, y, tilt.x * x + tilt.y * y)
        };
        (0..2 * points).map(corner).collect()
    }

    #[test]
    fn concave_polygons_keep_their_area_and_edges() {
        for points in [3, 5, 24, 72, 150] {
            for inner in [0.02, 0.3, 0.9] {
                for tilt in [DVec3::ZERO, DVec3::new(3.0, -5.0, 0.0), DVec3::new(-40.0, 1.0, 0.0)] {
                    let corners = star(points, inner, tilt);
                    check(&corners);
                    let turned: Vec<_> =
                        corners.iter().rev().map(|v| DVec3::new(v.z, v.x, v.y)).collect();
                    check(&turned);
                }
            }
        }
    }

    #[test]
    fn concave_quads_are_cut_inside() {
        let arrow =
            [[0.0, 0.0], [2.0, -1.0], [0.5, 0.0], [2.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 1.0));
        for turn in 0..4 {
            let mut corners = arrow;
            corners.rotate_left(turn);
            check(&corners);
        }
    }

    #[test]
    fn corners_on_a_straight_edge_are_kept() {
        let points = [
            [0.0, 0.0],
            [1.0, 0.0],
            [2.0, 0.0],
            [3.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [2.0, 1.0],
            [1.0, 2.5],
            [0.0, 4.0],
            [0.0, 3.0],
            [0.0, 1.0],
        ];
        check(&points.map(|[x, y]| DVec3::new(x, 0.0, -y)));
    }

    #[test]
    fn outlines_without_area_are_no_trouble() {
        let mut triangulator = Triangulator::default();
        let line: Vec<_> = (0..9).map(|k| DVec3::X * f64::from(k)).collect();
        for triangle in triangulator.cut(&line) {
            assert!(triangle.iter().all(|k| (*k as usize) < line.len()));
        }
        assert!(triangulator.cut(&line[..2]).is_empty());
    }

    /// Clipped, these would take minutes. Oracle: a hole that is reached and left the same way is none of them.
    #[test]
    fn outlines_that_go_round_again_and_again_are_not_clipped() {
        let once = star(50, 0.5, DVec3::Z);
        let again: Vec<DVec3> = once.iter().cycle().take(9_000).copied().collect();
        assert_eq!(Triangulator::default().cut(&again).len(), 8_998);
        let square = |side: f64, turns: [usize; 5]| {
            let corners = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]];
            turns.map(|k| DVec3::new(corners[k][0], corners[k][1], 0.0) - DVec3::splat(side / 2.0))
        };
        let flat = |v: DVec3| DVec3::new(v.x, v.y, 0.0);
        let keyhole = [square(4.0, [0, 1, 2, 3, 0]), square(2.0, [0, 3, 2, 1, 0])].concat();
        let keyhole: Vec<DVec3> = keyhole.into_iter().map(flat).collect();
        let triangles = Triangulator::default().cut(&keyhole).to_vec();
        assert!((area_of(&keyhole, &triangles) - 12.0).abs() < 1e-12);
        let visits = |times: usize| -> Vec<DVec2> {
            (0..100 * times).map(|k| DVec2::new((k % 100) as f64, 0.0)).collect()
        };
        assert!(!goes_round_again(&visits(2)) && goes_round_again(&visits(3)));
    }
}
