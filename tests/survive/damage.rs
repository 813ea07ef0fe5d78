//! Checkpoints that are damaged, of other pictures, or missing.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use whitted::Rgb;
use whitted::checkpoint::{Checkpoint, CheckpointError, Job, Record};
use whitted::film::{Film, Label};
use whitted::render::{Account, Effort, Progress, RenderOptions, Rendering, blocks, render_blocks};
use whitted::scene::{Scene, load_builtin};

use super::{folder, run};

fn options() -> RenderOptions {
    let aa = "adaptive:2,4096".parse().expect("a mode");
    RenderOptions { size: Some([200, 150]), aa, ..RenderOptions::default() }
}

/// A block of any picture.
pub(crate) fn first() -> Record {
    let (colors, samples) = (vec![Rgb::ONE; 64 * 64], vec![1; 64 * 64]);
    Record { number: 0, colors, samples, account: Account::default() }
}

pub(crate) fn label(scene: &Scene, text: &str) -> Label {
    Label {
        software: Label::this_software(),
        scene: scene.hash(),
        size: [200, 150],
        options: text.to_owned(),
        part: None,
        share: None,
        missing: 0,
        warning: None,
    }
}

pub(crate) fn quiet(_: Progress) {}

fn job<'a>(
    scene: &Scene,
    path: &Path,
    stop: &'a AtomicBool,
    progress: &'a (dyn Fn(Progress) + Sync),
) -> Job<'a> {
    let places = blocks(scene, &options()).expect("in the picture");
    assert!(places.len() >= 12);
    let label = label(scene, "aa=adaptive:2,4096");
    Job::new(label, places, Some(path.to_owned()), stop, progress)
}

fn finished(job: Job, effort: &Effort) -> (Film, Rendering) {
    assert!(job.is_complete());
    let rendering = job.into_rendering(effort);
    (rendering.film.clone(), rendering)
}

/// Oracle: the uninterrupted render. Cut off at any byte, or with any byte changed, a checkpoint is refused or gives the same
/// picture, and what is before the damage is not lost.
#[test]
fn a_damaged_checkpoint_costs_time_but_never_a_pixel() {
    let folder = folder();
    let path = folder.path().join("a.checkpoint");
    let scene = load_builtin("assignment").expect("built in");
    let never = AtomicBool::new(false);
    let whole = job(&scene, &path, &never, &quiet);
    let effort =
        render_blocks(&scene, &options(), &blocks(&scene, &options()).expect("whole"), &whole)
            .expect("rendered");
    let (film, rendering) = finished(whole, &effort);

    let stop = AtomicBool::new(false);
    let reports = AtomicU32::new(0);
    let halfway = |progress: Progress| {
        reports.fetch_add(1, Ordering::Relaxed);
        stop.fetch_or(progress.done * 2 > progress.total, Ordering::Relaxed);
    };
    let half = job(&scene, &path, &stop, &halfway);
    render_blocks(&scene, &options(), half.places(), &half).expect("rendered");
    assert!(!half.is_complete() && half.share_done() > 0.2 && reports.load(Ordering::Relaxed) > 10);
    half.save().expect("written");
    let bytes = fs::read(&path).expect("there");

    let mut random = 12345_u64;
    let mut next = |below: usize| {
        random =
            random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) as usize % below
    };
    let (mut refused, mut kept) = (0, 0);
    for round in 0..40 {
        let mut damaged = bytes.clone();
        let place = if round < 6 { next(300) } else { next(bytes.len()) };
        if round % 2 == 0 {
            damaged.truncate(place);
        } else {
            damaged[place] ^= 1 << next(8);
        }
        fs::write(&path, damaged).expect("written");
        let resumed = job(&scene, &path, &never, &quiet);
        if let Err(error) = resumed.resume() {
            assert!(matches!(error, CheckpointError::Damaged { .. }), "{error}");
            refused += 1;
            continue;
        }
        kept += usize::from(resumed.share_done() > 0.0);
        if round % 8 == 1 {
            let effort =
                render_blocks(&scene, &options(), resumed.places(), &resumed).expect("rendered");
            resumed.save().expect("written");
            let (again, rendering_again) = finished(resumed, &effort);
            assert!(again == film, "round {round}, byte {place}");
            assert_eq!(rendering_again.rays, rendering.rays, "round {round}");
            assert_eq!(rendering_again.estimated_rmse, rendering.estimated_rmse);
            // The damage is gone, and all the blocks are there.
            let last = job(&scene, &path, &never, &quiet);
            last.resume().expect("sound again");
            assert!(last.is_complete());
        }
    }
    assert!(refused >= 3 && kept >= 20, "{refused} refused, {kept} kept");
}

#[test]
fn a_checkpoint_of_another_picture_is_refused_with_what_differs() {
    let folder = folder();
    let path = folder.path().join("a.checkpoint");
    let scene = load_builtin("assignment").expect("built in");
    let own = label(&scene, "aa=none depth=6");
    Checkpoint::create(&path, &own, &first()).expect("written");
    Checkpoint::check(&path, &own).expect("its own");
    let places = blocks(&scene, &options()).expect("whole");
    let open = |label: Label| {
        let refused = Checkpoint::open(&path, &label, &places, |_| ()).expect_err("another");
        let checked = Checkpoint::check(&path, &label).expect_err("another");
        assert_eq!(refused.to_string(), checked.to_string());
        let CheckpointError::Differs { what, .. } = refused else { panic!("{refused}") };
        what
    };
    assert_eq!(open(label(&scene, "aa=grid:2 depth=6")), "aa: grid:2 here, none there");
    let other = Label { software: "whitted 99".to_owned(), ..label(&scene, "aa=none depth=6") };
    assert!(open(other).starts_with("version: whitted 99 here, whitted "));
    let spheres = load_builtin("spheres").expect("built in");
    assert!(open(label(&spheres, "aa=none depth=6")).starts_with("scene: "));
    let tile = whitted::film::Tile { x0: 0, y0: 0, x1: 200, y1: 10 };
    let part = Label { part: Some(tile), ..label(&scene, "aa=none depth=6") };
    assert_eq!(open(part), "part: 0,0,200,10 here, 0,0,200,150 there");
    fs::write(&path, "something else").expect("written");
    let refused = Checkpoint::open(&path, &label(&scene, "aa=none"), &places, |_| ());
    assert!(matches!(refused, Err(CheckpointError::Damaged { .. })), "{refused:?}");
}

#[test]
fn resuming_without_a_checkpoint_starts_anew_or_finds_the_picture_finished() {
    let folder = folder();
    let at = folder.path();
    let small = ["render", "--size", "40x30", "--resume", "-o", "a.png"];
    let first = run(at, &small);
    super::done(&first);
    assert!(super::said(&first).contains("starting from the beginning"), "{}", super::said(&first));
    let second = run(at, &small);
    super::done(&second);
    assert_eq!(super::said(&second), "a.png is finished already\n");
    let other = run(at, &[&small[..], &["--depth", "1"]].concat());
    super::done(&other);
    assert!(super::said(&other).contains("wrote a.png"), "{}", super::said(&other));
}
