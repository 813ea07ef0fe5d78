//! Pictures towards an error that are stopped, kept and gone on with.

use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use whitted::checkpoint::{CheckpointError, Job};
use whitted::render::{Effort, Goal, RenderOptions, Rendering, blocks, render_blocks};
use whitted::scene::{Scene, load_builtin, load_builtin_of};

use super::damage::{label, quiet};
use super::folder;

/// A picture of everything towards a small error; of spheres so many that hits wait for each other a larger one does.
fn options(scene: &Scene) -> RenderOptions {
    let aa = "adaptive:0,1024".parse().expect("a mode");
    let goal = Goal::Error(if scene.name() == "assignment" { 0.3 } else { 9.0 });
    RenderOptions { size: Some([200, 150]), aa, goal, ..RenderOptions::default() }
}

fn job<'a>(scene: &Scene, path: &Path, stop: &'a AtomicBool) -> Job<'a> {
    let options = options(scene);
    let places = blocks(scene, &options).expect("whole");
    let label = label(scene, "max-error=0.3");
    Job::new(label, places, Some(path.to_owned()), stop, &quiet)
}

/// Renders until the end, or until `time` is up; every few milliseconds all of it is to be kept.
fn render(scene: &Scene, job: &Job, stop: &AtomicBool, time: Option<Duration>) -> Effort {
    let has_ended = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut waited = Duration::ZERO;
            while !has_ended.load(Ordering::Relaxed) {
                let moment = Duration::from_millis(2);
                std::thread::sleep(moment);
                waited += moment;
                job.save().expect("written");
                if time.is_some_and(|time| waited >= time) {
                    stop.store(true, Ordering::Relaxed);
                }
            }
        });
        let effort = render_blocks(scene, &options(scene), job.places(), job).expect("rendered");
        has_ended.store(true, Ordering::Relaxed);
        effort
    })
}

fn uninterrupted(scene: &Scene, path: &Path) -> Rendering {
    let never = AtomicBool::new(false);
    let whole = job(scene, path, &never);
    let effort = render_blocks(
        scene,
        &options(scene),
        &blocks(scene, &options(scene)).expect("whole"),
        &whole,
    )
    .expect("rendered");
    whole.into_rendering(&effort)
}

/// What of a rendering does not depend on how long it took.
#[track_caller]
fn assert_same(a: &Rendering, b: &Rendering) {
    assert!(a.film == b.film, "the same pixels");
    assert_eq!((a.rays, a.outcome), (b.rays, b.outcome));
    assert_eq!(a.estimated_rmse, b.estimated_rmse);
}

/// Oracle: the uninterrupted render.
#[test]
fn a_picture_towards_an_error_goes_on_from_wherever_it_was_left() {
    for (name, objects) in [("assignment", None), ("spheres", Some(10_000))] {
        let scene = load_builtin_of(name, objects).expect("built in");
        goes_on_from_wherever_it_was_left(&scene);
    }
}

fn goes_on_from_wherever_it_was_left(scene: &Scene) {
    let folder = folder();
    let path = folder.path().join("a.checkpoint");
    let whole = uninterrupted(scene, &path);
    assert!(!path.exists() && whole.outcome.per_ray.is_some() && !whole.outcome.is_stopped);
    let (mut stops, mut kept, mut last) = (0, 0, f64::INFINITY);
    let again = loop {
        let stop = AtomicBool::new(false);
        let part = job(scene, &path, &stop);
        if path.exists() {
            part.resume().expect("of the same picture");
            assert!(part.has_checkpoint());
            let error = part.estimated_rmse().unwrap_or(f64::INFINITY);
            assert!(error <= last * 1.1, "{error} after {last}");
            (kept, last) = (kept + usize::from(error.is_finite()), error);
        }
        // Longer and longer, so that it ends on any machine.
        let effort = render(scene, &part, &stop, Some(Duration::from_millis(4 + 6 * stops)));
        if part.is_complete() {
            part.remove_checkpoint().expect("deleted");
            break part.into_rendering(&effort);
        }
        stops += 1;
        // Stopped before it began, there is nothing to keep.
        assert!(path.exists() || part.share_done() == 0.0, "stop {stops}");
    };
    assert!(stops >= 3 && kept >= 2, "{stops} stops, {kept} of them after the first rays");
    assert_same(&again, &whole);
    assert!(!path.exists());
}

/// Oracle: the uninterrupted render. What is damaged is never gone on from, and a whole picture behind it does no harm.
#[test]
fn a_damaged_checkpoint_of_such_a_picture_is_as_none() {
    let folder = folder();
    let path = folder.path().join("a.checkpoint");
    let scene = load_builtin("assignment").expect("built in");
    let whole = uninterrupted(&scene, &path);
    let stop = AtomicBool::new(false);
    let mut time = Duration::from_millis(50);
    while !path.exists() {
        stop.store(false, Ordering::Relaxed);
        render(&scene, &job(&scene, &path, &stop), &stop, Some(time));
        time += time;
    }
    let bytes = fs::read(&path).expect("there");
    let never = AtomicBool::new(false);
    for round in 0..24 {
        let mut damaged = bytes.clone();
        // From the head to the last byte.
        let place = (bytes.len() - 1) * round / 23;
        if round % 2 == 0 {
            damaged.truncate(place);
        } else {
            damaged[place] ^= 1 << (round % 8);
        }
        fs::write(&path, damaged).expect("written");
        let resumed = job(&scene, &path, &never);
        match resumed.resume() {
            Err(CheckpointError::Damaged { .. }) => assert!(round < 3, "the head is short"),
            opened => opened.expect("refused or opened"),
        }
        assert_eq!((resumed.estimated_rmse(), resumed.share_done()), (None, 0.0), "round {round}");
        if round == 13 {
            let effort = render(&scene, &resumed, &never, None);
            assert!(resumed.is_complete());
            resumed.save().expect("written behind what was kept");
            let last = job(&scene, &path, &never);
            last.resume().expect("sound again");
            assert!(last.is_complete());
            assert_same(&resumed.into_rendering(&effort), &whole);
        }
    }
}
