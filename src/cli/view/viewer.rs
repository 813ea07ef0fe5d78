//! What is looked at, without the window: the camera, the options, the picture as far as it is.

use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec2;
use whitted::aa::AntiAliasing;
use whitted::camera::Camera;
use whitted::film::{Label, OutputFile};
use whitted::render::RenderOptions;
use whitted::render::refine::{Canvas, Shown};
use whitted::scene::{Orbit, Scene};

use super::super::args::{CONTROLS, ViewArgs};
use super::super::failure::Failure;
use super::super::{options, streams};
use super::camera_text::{camera_text, given_flags};
use super::controls::Action;
use super::work::Work;

/// Rays, either way, by which what is seen is measured.
const PROBES: u32 = 9;

/// How much text stands in the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Text {
    Status,
    Help,
    None,
}

pub(super) struct Viewer {
    scene: Arc<Scene>,
    canvas: Arc<Canvas>,
    orbit: Orbit,
    options: RenderOptions,
    modes: Vec<AntiAliasing>,
    text: Text,
    /// The flags on the camera that the user gave, to be printed with the others.
    given: String,
    quiet: bool,
    /// Whether what is shown is not what is wanted.
    is_stale: bool,
}

impl Viewer {
    pub(super) fn new(scene: Scene, args: &ViewArgs) -> Self {
        let size = args.size.unwrap_or(scene.resolution());
        let aa = args.aa.or(scene.aa()).unwrap_or_default();
        let mut modes =
            vec![AntiAliasing::None, AntiAliasing::Grid { side: 2 }, AntiAliasing::default()];
        if !modes.contains(&aa) {
            modes.push(aa);
        }
        let options = RenderOptions {
            size: Some(size),
            aa,
            depth: Some(args.depth.unwrap_or(scene.depth())),
            threads: args.threads,
            ..RenderOptions::default()
        };
        let orbit = Orbit::new(*scene.camera_plan(), distance(&scene));
        let canvas = Arc::new(Canvas::new(size));
        let quiet = args.quiet;
        let scene = Arc::new(scene);
        Self {
            scene,
            canvas,
            orbit,
            options,
            modes,
            text: Text::Status,
            given: given_flags(&args.seen),
            quiet,
            is_stale: true,
        }
    }

    /// Width and height in pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        self.options.size.unwrap_or(self.scene.resolution())
    }

    pub(super) fn canvas(&self) -> &Canvas {
        &self.canvas
    }

    /// The window has another size now.
    pub(super) fn resize(&mut self, size: [u32; 2]) {
        if size != self.size() && size.iter().all(|side| *side > 0) {
            self.options.size = Some(size);
            self.is_stale = true;
        }
    }

    /// Does what the user wants; false if that is the end.
    pub(super) fn act(&mut self, action: Action) -> Result<bool, Failure> {
        let before = (self.options, *self.orbit.plan());
        let depth = self.options.depth.unwrap_or(self.scene.depth());
        match action {
            Action::Turn(aside, upwards) => self.orbit.turn(aside, upwards),
            Action::Pan(by) => self.orbit.pan(by),
            Action::Zoom(factor) => self.orbit.zoom(factor),
            Action::Reset => self.orbit.reset(),
            Action::Deeper => self.options.depth = Some(depth.saturating_add(1)),
            Action::Shallower => self.options.depth = Some((depth - 1).max(1)),
            Action::NextAa => {
                let place = self.modes.iter().position(|mode| *mode == self.options.aa);
                self.options.aa = self.modes[place.map_or(0, |k| (k + 1) % self.modes.len())];
            }
            Action::Text => {
                self.text = match self.text {
                    Text::Status => Text::Help,
                    Text::Help => Text::None,
                    Text::None => Text::Status,
                }
            }
            Action::Save => self.save()?,
            Action::End => return Ok(false),
        }
        self.is_stale |= before != (self.options, *self.orbit.plan());
        Ok(true)
    }

    /// The camera, if it is not the scene's.
    fn camera(&self) -> Option<Camera> {
        let plan = self.orbit.plan();
        (plan != self.scene.camera_plan()).then(|| plan.camera().ok()).flatten()
    }

    /// What is to be rendered, in a thread of its own, if that is not in work already. A picture whose first pass is
    /// not yet shown is not given up, or there would be nothing to see while the mouse moves.
    pub(super) fn take_work(&mut self) -> Option<Work> {
        let is_first_shown = {
            let shown = self.canvas.look();
            shown.number == 0 || shown.pass.0 > 1
        };
        if !self.is_stale || !is_first_shown {
            return None;
        }
        self.is_stale = false;
        let options = RenderOptions { camera: self.camera(), ..self.options };
        let (scene, canvas) = (Arc::clone(&self.scene), Arc::clone(&self.canvas));
        Some(Work::begin(scene, canvas, options))
    }

    /// The line that tells how far the picture is and how good.
    pub(super) fn status(&self, shown: &Shown) -> String {
        let depth = self.options.depth.unwrap_or(self.scene.depth());
        let time = match shown.seconds {
            Some(seconds) => format!("{seconds:.2} s"),
            None => format!("pass {} of {}", shown.pass.0, shown.pass.1),
        };
        let error = match shown.estimated_rmse {
            Some(rmse) => format!(", off by about {rmse:.2} of 255"),
            None => String::new(),
        };
        format!("{}, depth {depth}, {time}{error}", self.options.aa)
    }

    /// The text in the window.
    pub(super) fn lines(&self, shown: &Shown) -> Vec<String> {
        let status = || self.status(shown);
        match self.text {
            Text::None => Vec::new(),
            Text::Status => vec![status(), "h: help, s: save, q: quit".to_owned()],
            Text::Help => {
                let help = CONTROLS.lines().map(|line| line.trim().to_owned());
                help.chain([status()]).collect()
            }
        }
    }

    /// Writes what is shown to a file with a name that is free, and prints the camera.
    fn save(&self) -> Result<(), Failure> {
        let (film, is_done) = {
            let shown = self.canvas.look();
            (shown.film.clone(), shown.seconds.is_some() && !self.is_stale)
        };
        let path = free_name(self.scene.name());
        let label = is_done.then(|| self.label());
        let named = path.display().to_string();
        OutputFile::prepare(path)?.commit(&film, label.as_ref())?;
        if !self.quiet {
            let state = if is_done { "" } else { ", which is not finished" };
            streams::note(&format!("wrote {named}{state}: {}", self.status(&self.canvas.look())));
        }
        streams::print(camera_text(self.orbit.plan(), &self.given).as_bytes())
    }

    /// As the file of `whitted render` has it, so that the same picture is the same file.
    fn label(&self) -> Label {
        let hash = match self.camera() {
            Some(camera) => self.scene.hash_from(camera),
            None => self.scene.hash(),
        };
        Label {
            software: Label::this_software(),
            scene: hash,
            size: self.size(),
            options: options::words(&self.options, &self.scene),
            part: None,
            share: None,
            missing: 0,
            warning: None,
        }
    }
}

/// How far the point is about which the camera turns: where the scene's camera looks at, unless that is but a
/// direction, nearer than anything to be seen; then as far as the nearer things are.
fn distance(scene: &Scene) -> Option<f64> {
    let plan = scene.camera_plan();
    let view = plan.camera().ok()?.view(PROBES, PROBES);
    let places = (0..PROBES).flat_map(|y| (0..PROBES).map(move |x| (x, y)));
    let rays = places.map(|(x, y)| view.ray(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)));
    let mut seen: Vec<f64> =
        rays.filter_map(|ray| scene.nearest(&ray).map(|(hit, _)| hit.t)).collect();
    seen.sort_unstable_by(f64::total_cmp);
    let own = (plan.look_at - plan.eye).length();
    let is_point = seen.first().is_none_or(|nearest| own >= *nearest);
    if is_point { None } else { seen.get(seen.len() / 4).copied() }
}

/// `scene-view-1.png`, or with the first number that no file has.
fn free_name(scene: &str) -> PathBuf {
    let name = |number: u32| PathBuf::from(format!("{scene}-view-{number}.png"));
    (1..u32::MAX).map(name).find(|path| !path.exists()).unwrap_or_else(|| name(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::{Args, Command};
    use clap::Parser;

    fn viewer(flags: &[&str]) -> Viewer {
        let args = Args::try_parse_from([&["whitted", "view"], flags].concat()).expect("flags");
        let Command::View(args) = args.command else { panic!("view") };
        Viewer::new(args.seen.load(None).expect("a scene").scene, &args)
    }

    #[test]
    fn only_what_changes_the_picture_is_rendered_anew() {
        let mut viewer = viewer(&["--size", "20x10", "--aa", "grid:3"]);
        let work = viewer.take_work().expect("the first picture");
        assert!(viewer.take_work().is_none() && viewer.camera().is_none());
        work.run(&|| ()).expect("rendered");
        assert!(viewer.status(&viewer.canvas.look()).starts_with("grid:3, depth 6, 0."));
        assert!(viewer.act(Action::Text).expect("shown") && viewer.take_work().is_none());
        for action in [Action::Turn(5.0, 0.0), Action::NextAa, Action::Shallower, Action::Reset] {
            assert!(viewer.act(action).expect("done"));
            let work = viewer.take_work().unwrap_or_else(|| panic!("{action:?}"));
            work.run(&|| ()).expect("rendered");
        }
        assert_eq!((viewer.options.aa, viewer.options.depth), (AntiAliasing::None, Some(5)));
        assert!(!viewer.act(Action::End).expect("the end"));
    }

    /// Oracle: the spheres of the assignment stand between 60 and 100 in front of the camera, which looks at a point at
    /// 1; the camera of a model looks at its middle.
    #[test]
    fn the_camera_turns_about_what_is_seen() {
        let moved = |flags: &[&str]| {
            let mut viewer = viewer(flags);
            let before = *viewer.orbit.plan();
            viewer.act(Action::Turn(1.0, 0.0)).expect("turned");
            (before, *viewer.orbit.plan())
        };
        let (_, plan) = moved(&[]);
        assert!((-110.0..-50.0).contains(&plan.look_at.z), "{plan:?}");
        let model = concat!(env!("CARGO_MANIFEST_DIR"), "/models/crate/crate.obj");
        let (before, plan) = moved(&[model]);
        assert!((plan.look_at - before.look_at).length() < 1e-9 * before.eye.length());
    }

    /// The mouse moves faster than pictures are made.
    #[test]
    fn a_picture_is_not_given_up_before_anything_of_it_was_shown() {
        let mut viewer = viewer(&["--size", "20x10"]);
        let work = viewer.take_work().expect("the first picture");
        viewer.act(Action::Turn(5.0, 0.0)).expect("turned");
        assert!(viewer.take_work().is_none());
        work.run(&|| ()).expect("rendered");
        assert!(viewer.take_work().is_some());
    }
}
