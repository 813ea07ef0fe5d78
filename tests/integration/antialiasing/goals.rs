//! Rendering to an error and to a time.

use std::time::{Duration, Instant};

use glam::DVec2;
use whitted::render::Goal;

use super::{Seen, picture_of};

/// Discs of all sizes, well inside of each other.
fn rings(p: DVec2) -> Seen {
    let ring = (p.distance(DVec2::new(20.3, 31.8)) / 3.7) as u32;
    (0.2 + 0.6 * f64::from(ring % 2), ring)
}

#[test]
fn an_error_is_reached_and_not_by_far() {
    let mut last = (f64::INFINITY, 0);
    for wanted in [8.0, 4.0, 2.0, 1.0] {
        let picture = picture_of(&rings, 64, "adaptive:0,1024", Goal::Error(wanted));
        let estimate = picture.estimated_rmse();
        assert!(estimate <= wanted && estimate > wanted / 2.0, "{wanted}: {estimate}");
        assert!(picture.outcome.per_ray.is_some() && picture.outcome.missed_error.is_none());
        let rays: u64 = picture.samples.iter().copied().map(u64::from).sum();
        assert!(estimate < last.0 && rays > last.1, "{wanted}: {estimate}, {rays}");
        last = (estimate, rays);
    }
}

/// The same picture comes from any way down the ladder to the same threshold.
#[test]
fn an_error_that_is_there_already_takes_no_more_rays() {
    let picture = picture_of(&rings, 64, "adaptive:0,1024", Goal::Error(250.0));
    assert!(picture.samples.iter().all(|&rays| rays == 1));
    assert_eq!(picture.outcome.per_ray, None);
}

#[test]
fn an_error_out_of_reach_is_said_to_be() {
    let picture = picture_of(&rings, 64, "adaptive:0,8", Goal::Error(0.1));
    assert_eq!(picture.outcome.missed_error, Some(0.1));
    assert!(picture.estimated_rmse() > 0.1);
    assert!(picture.samples.iter().all(|&rays| rays <= 8));
}

/// What the clock does is not tested, but that the ends are right: no time gives one ray a pixel, plenty gives all.
#[test]
fn a_time_limit_gives_a_picture_however_short() {
    let picture = picture_of(&rings, 64, "adaptive:0,64", Goal::Until(Instant::now()));
    assert!(picture.outcome.late.is_some());
    assert!(picture.samples.iter().all(|&rays| rays == 1));
    let end = Instant::now() + Duration::from_secs(3600);
    let picture = picture_of(&rings, 64, "adaptive:0,64", Goal::Until(end));
    assert!(picture.outcome.cut && picture.outcome.late.is_none());
    assert_eq!(picture.samples.iter().max(), Some(&64));
    let most = picture_of(&rings, 64, "adaptive:0,64", Goal::Mode);
    assert!(picture.estimated_rmse() < 1.5 * most.estimated_rmse());
}
