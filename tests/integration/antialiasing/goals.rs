//! Rendering to an error and to a time.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use glam::DVec2;
use whitted::Rgb;
use whitted::aa::AntiAliasing;
use whitted::film::Tile;
use whitted::render::{
    Block, Goal, RenderError, RenderOptions, Sink, Unfinished, blocks, render, render_blocks,
};
use whitted::scene::{LoadOptions, load, load_builtin};

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

/// One ray in each pixel is less than 250 levels off.
#[test]
fn an_error_that_is_there_already_takes_no_more_rays() {
    let picture = picture_of(&rings, 64, "adaptive:0,1024", Goal::Error(250.0));
    assert!(picture.samples.iter().all(|&rays| rays == 1));
    assert_eq!(picture.outcome.per_ray, None);
}

/// Keeps a picture towards an error before every other step, to go on from, and its end.
#[derive(Default)]
struct Kept {
    is_shown_again: AtomicBool,
    wants: AtomicBool,
    /// The rays through each pixel when it was shown.
    looks: Mutex<Vec<Vec<u32>>>,
    unfinished: Mutex<Option<Vec<u8>>>,
    end: Mutex<Option<Block>>,
}

impl Sink for Kept {
    fn put(&self, block: Block) {
        *self.end.lock().expect("no panic") = Some(block);
    }

    fn show(&self, _: &Tile, _: &[Rgb], samples: &[u32]) {
        self.looks.lock().expect("no panic").push(samples.to_vec());
        // What was interrupted to be kept is shown again, and then takes its step.
        self.wants.store(!self.is_shown_again.fetch_not(Ordering::Relaxed), Ordering::Relaxed);
    }

    fn wants_unfinished(&self) -> bool {
        self.wants.load(Ordering::Relaxed)
    }

    fn keep(&self, unfinished: &Unfinished) {
        let bytes = postcard::to_stdvec(unfinished).expect("in memory");
        *self.unfinished.lock().expect("no panic") = Some(bytes);
        self.wants.store(false, Ordering::Relaxed);
    }

    fn unfinished(&self) -> Option<Unfinished> {
        let kept = self.unfinished.lock().expect("no panic");
        kept.as_ref().map(|bytes| postcard::from_bytes(bytes).expect("what was kept"))
    }
}

/// Oracle: the picture that goes to its error at once. The other one aims at larger errors on its way, and so takes other steps.
#[test]
fn any_way_to_the_same_threshold_gives_the_same_picture() {
    let scene = load_builtin("assignment").expect("a scene");
    let render_to = |goals: &[f64]| {
        let sink = Kept::default();
        for wanted in goals {
            let options = RenderOptions {
                size: Some([60, 40]),
                aa: "adaptive:0,1024".parse().expect("a mode"),
                goal: Goal::Error(*wanted),
                ..RenderOptions::default()
            };
            render_blocks(&scene, &options, &blocks(&scene, &options).expect("whole"), &sink)
                .expect("rendered");
        }
        let end = sink.end.into_inner().expect("no panic").expect("a picture");
        (sink.looks.into_inner().expect("no panic"), end)
    };
    for steps in [&[16.0, 8.0, 4.0][..], &[8.0, 4.0, 2.0, 1.0], &[4.0, 2.0, 1.0, 0.5]] {
        let (direct, at_once) = render_to(&steps[steps.len() - 1..]);
        let (looks, by_steps) = render_to(steps);
        assert!(looks.iter().any(|look| !direct.contains(look)), "{steps:?}: another way");
        assert!(at_once.outcome.per_ray.is_some(), "{steps:?}");
        assert_eq!(by_steps.outcome, at_once.outcome, "{steps:?}");
        assert_eq!(by_steps.account, at_once.account, "{steps:?}");
        assert!(by_steps.samples == at_once.samples, "{steps:?}");
        assert!(by_steps.colors == at_once.colors, "{steps:?}");
    }
}

/// Wants a picture to be kept after so many questions whether it does, once.
struct Paused {
    after: usize,
    questions: AtomicUsize,
    is_kept: AtomicBool,
    end: Mutex<Option<Block>>,
}

impl Sink for Paused {
    fn put(&self, block: Block) {
        *self.end.lock().expect("no panic") = Some(block);
    }

    fn wants_unfinished(&self) -> bool {
        let questions = self.questions.fetch_add(1, Ordering::Relaxed);
        questions >= self.after && !self.is_kept.load(Ordering::Relaxed)
    }

    fn keep(&self, _: &Unfinished) {
        self.is_kept.store(true, Ordering::Relaxed);
    }
}

/// Oracle: the picture that is not interrupted. Before a plain sky, what is not traced yet looks like an edge.
#[test]
fn a_pause_before_all_centres_are_traced_changes_nothing() {
    let options = LoadOptions { objects: Some(1), ..LoadOptions::default() };
    let scene = load("spheres", &options).expect("a scene").scene;
    let render_to = |goal: Goal, after: usize| {
        let (questions, is_kept) = (AtomicUsize::new(0), AtomicBool::new(false));
        let sink = Paused { after, questions, is_kept, end: Mutex::new(None) };
        let options = RenderOptions {
            size: Some([320, 320]),
            aa: "adaptive:0,64".parse().expect("a mode"),
            goal,
            ..RenderOptions::default()
        };
        render_blocks(&scene, &options, &blocks(&scene, &options).expect("whole"), &sink)
            .expect("rendered");
        (sink.is_kept.into_inner(), sink.end.into_inner().expect("no panic").expect("a picture"))
    };
    let (_, expected) = render_to(Goal::Error(0.2), usize::MAX);
    for after in [1, 5, 10, 20, 40] {
        let (is_kept, paused) = render_to(Goal::Error(0.2), after);
        assert!(is_kept && paused.samples == expected.samples, "{after}");
        assert!(paused.colors == expected.colors && paused.account == expected.account, "{after}");
    }
    let plenty = || Goal::Until(Instant::now() + Duration::from_secs(3600));
    let (_, expected) = render_to(plenty(), usize::MAX);
    let (is_kept, paused) = render_to(plenty(), 20);
    assert!(is_kept && expected.outcome.is_used_up && paused.outcome.is_used_up);
    assert!(paused.samples == expected.samples);
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
    assert!(picture.outcome.is_used_up);
    assert_eq!(picture.samples.iter().max(), Some(&64));
    let most = picture_of(&rings, 64, "adaptive:0,64", Goal::Mode);
    assert!(picture.estimated_rmse() < 1.5 * most.estimated_rmse());
}

/// The edge is too faint for an 8-bit picture long before its pixels have all the rays that they may get.
#[test]
fn time_is_left_where_rays_are_worth_nothing_any_more() {
    let faint = |p: DVec2| if p.x < 3.3 { (0.5, 1) } else { (0.50001, 2) };
    let end = Instant::now() + Duration::from_secs(3600);
    let picture = picture_of(&faint, 8, "adaptive:0,1048576", Goal::Until(end));
    assert!(picture.outcome.is_used_up && picture.outcome.cut);
    assert!(picture.samples.iter().all(|&rays| rays < 1_048_576));
    assert!(picture.estimated_rmse() > 0.0);
}

/// Keeps every look at a picture on its way, and its end.
#[derive(Default)]
struct Looks {
    seen: Mutex<Vec<(Vec<Rgb>, Vec<u32>)>>,
    end: Mutex<Vec<Rgb>>,
    /// After how many looks it is stopped.
    most: usize,
}

impl Sink for Looks {
    fn put(&self, block: Block) {
        *self.end.lock().expect("no panic") = block.colors;
    }

    fn show(&self, _: &Tile, colors: &[Rgb], samples: &[u32]) {
        self.seen.lock().expect("no panic").push((colors.to_vec(), samples.to_vec()));
    }

    fn is_stopped(&self) -> bool {
        self.seen.lock().expect("no panic").len() >= self.most
    }
}

/// Oracle: a picture with many rays in each pixel, which every look is nearer to than the one before.
#[test]
fn a_picture_is_shown_on_its_way_to_an_error_nearer_and_nearer() {
    let scene = load_builtin("assignment").expect("a scene");
    let with = |aa: &str, goal| RenderOptions {
        size: Some([60, 40]),
        aa: aa.parse().expect(aa),
        goal,
        ..RenderOptions::default()
    };
    let truth = render(&scene, &with("grid:16", Goal::Mode), &|_| ()).expect("rendered").film;
    let off = |colors: &[Rgb]| -> f32 {
        colors.iter().zip(truth.pixels()).map(|(a, b)| (*a - *b).length_squared()).sum()
    };
    let options = with("adaptive:0,1024", Goal::Error(0.5));
    let to_its_end = Looks { most: usize::MAX, ..Looks::default() };
    render_blocks(&scene, &options, &blocks(&scene, &options).expect("whole"), &to_its_end)
        .expect("rendered");
    let looks = to_its_end.seen.into_inner().expect("no panic");
    assert!(looks.len() >= 3 && looks[0].1.iter().all(|&rays| rays == 1), "{}", looks.len());
    let mut errors: Vec<f32> = looks.iter().map(|(colors, _)| off(colors)).collect();
    errors.push(off(&to_its_end.end.into_inner().expect("no panic")));
    assert!(errors.is_sorted_by(|a, b| b <= &(a * 1.02)), "{errors:?}");
    assert!(errors[errors.len() - 1] < 0.1 * errors[0], "{errors:?}");
    // Stopped, it is what was shown last, or somewhat better.
    let stopped = Looks { most: 2, ..Looks::default() };
    render_blocks(&scene, &options, &blocks(&scene, &options).expect("whole"), &stopped)
        .expect("rendered");
    let looks = stopped.seen.into_inner().expect("no panic");
    assert_eq!(looks.len(), 2);
    assert!(off(&stopped.end.into_inner().expect("no panic")) <= off(&looks[1].0));
}

#[test]
fn a_goal_needs_the_adaptive_mode() {
    let scene = load_builtin("assignment").expect("a scene");
    for (aa, goal) in [("none", Goal::Error(1.0)), ("grid:2", Goal::Until(Instant::now()))] {
        let options = RenderOptions {
            size: Some([8, 8]),
            aa: aa.parse().expect(aa),
            goal,
            ..RenderOptions::default()
        };
        let error = render(&scene, &options, &|_| ()).expect_err(aa).to_string();
        assert!(error.contains(&format!("`adaptive`, not `{aa}`")), "{error}");
    }
}

/// A library's user may make modes that no text gives.
#[test]
fn a_mode_with_numbers_out_of_range_is_an_error() {
    let scene = load_builtin("assignment").expect("a scene");
    for aa in [
        AntiAliasing::Grid { side: 0 },
        AntiAliasing::Grid { side: 1 << 16 },
        AntiAliasing::Sequence { count: 0 },
        AntiAliasing::Adaptive { error: f32::NAN, most: 4 },
        AntiAliasing::Adaptive { error: 1.0, most: 0 },
    ] {
        let options = RenderOptions { size: Some([8, 8]), aa, ..RenderOptions::default() };
        let error = render(&scene, &options, &|_| ()).expect_err("out of range");
        assert!(matches!(error, RenderError::Mode(_)), "{aa:?}: {error}");
    }
}
