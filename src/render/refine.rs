//! A picture that is shown while it is rendered: coarse first, then finer, pass by pass.

use std::{
    sync::{Mutex, MutexGuard, PoisonError},
    time::Instant,
};

use super::{Account, Block, RenderError, RenderOptions, Sink, blocks, render_blocks};
use crate::{aa::AntiAliasing, film::Film, scene::Scene};

/// Pixels of the picture for each one of a coarse pass, either way.
const STEPS: [u32; 2] = [8, 3];

/// A pass over the whole picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass {
    /// Width and height in pixels, of which each stands for several of the picture if there are fewer.
    pub size: [u32; 2],
    /// How pixels are sampled.
    pub aa: AntiAliasing,
}

/// The passes of a picture, from the coarsest to the one that is the picture itself.
pub fn passes([width, height]: [u32; 2], aa: AntiAliasing) -> Vec<Pass> {
    let coarse = STEPS.map(|step| [width.div_ceil(step), height.div_ceil(step)]);
    let mut passes: Vec<Pass> =
        coarse.map(|size| Pass { size, aa: AntiAliasing::None }).into_iter().collect();
    if aa != AntiAliasing::None {
        passes.push(Pass { size: [width, height], aa: AntiAliasing::None });
    }
    passes.push(Pass { size: [width, height], aa });
    passes
}

/// What is to be seen of a picture.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Which picture it is: views that came later have higher numbers.
    pub number: u64,
    /// The picture so far.
    pub film: Film,
    /// The pass that is in work or comes next, counted from 1, and how many there are; done if the first is greater.
    pub pass: (usize, usize),
    /// When the render began.
    pub started: Instant,
    /// The time it took, in seconds, once it is done.
    pub seconds: Option<f64>,
    /// The estimated error of the pixels that the last pass has finished: root mean square of all channels, in levels
    /// of 255.
    pub estimated_rmse: Option<f64>,
}

/// A place where pictures are shown, one after the other.
#[derive(Debug)]
pub struct Canvas {
    shown: Mutex<Shown>,
}

impl Canvas {
    /// A black canvas of so many pixels.
    pub fn new([width, height]: [u32; 2]) -> Self {
        let film = Film::new(width, height);
        let shown = Shown {
            number: 0,
            film,
            pass: (1, 1),
            started: Instant::now(),
            seconds: None,
            estimated_rmse: None,
        };
        Self { shown: Mutex::new(shown) }
    }

    /// What is to be seen now.
    pub fn look(&self) -> MutexGuard<'_, Shown> {
        self.shown.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins another picture; what is still rendered of the one before is no longer shown. Returns its number.
    pub fn begin(&self) -> u64 {
        let mut shown = self.look();
        shown.number += 1;
        (shown.pass, shown.started) = ((1, 1), Instant::now());
        (shown.seconds, shown.estimated_rmse) = (None, None);
        shown.number
    }

    /// What is shown, if it is still the picture of that number.
    fn of(&self, number: u64) -> Option<MutexGuard<'_, Shown>> {
        Some(self.look()).filter(|shown| shown.number == number)
    }

    /// Renders the picture `number`, pass by pass, until it is done or another one was begun. `changed` is called from
    /// the worker threads when there is more to see; `goes_on` after each pass, and says whether the next one is
    /// wanted.
    ///
    /// When it is done, the film is that of [`render`](super::render) with the same options.
    ///
    /// # Errors
    /// As [`render`](super::render).
    pub fn render(
        &self,
        number: u64,
        scene: &Scene,
        options: &RenderOptions,
        changed: &(dyn Fn() + Sync),
        goes_on: &dyn Fn() -> bool,
    ) -> Result<(), RenderError> {
        let size = options.size.unwrap_or(scene.resolution());
        let options = RenderOptions { size: Some(size), crop: None, ..*options };
        let passes = passes(size, options.aa);
        for (k, pass) in passes.iter().enumerate() {
            let options = RenderOptions { size: Some(pass.size), aa: pass.aa, ..options };
            let is_last = k + 1 == passes.len();
            let Some(mut shown) = self.of(number) else { return Ok(()) };
            shown.pass = (k + 1, passes.len());
            if [shown.film.width(), shown.film.height()] != size {
                shown.film = shown.film.resampled(size);
            }
            drop(shown);
            let places = blocks(scene, &options)?;
            let coarse = Film::new(pass.size[0], pass.size[1]);
            let own = Mutex::new(Own { coarse, accounts: vec![None; places.len()] });
            let is_fine = pass.size == size;
            render_blocks(
                scene,
                &options,
                &places,
                &Painter { canvas: self, number, own, is_fine, is_last, changed },
            )?;
            let Some(mut shown) = self.of(number) else { return Ok(()) };
            shown.pass.0 = k + 2;
            if is_last {
                shown.seconds = Some(shown.started.elapsed().as_secs_f64());
            }
            drop(shown);
            changed();
            if !is_last && !goes_on() {
                return Ok(());
            }
        }
        Ok(())
    }
}

/// A pass in work.
struct Own {
    /// Its pixels, if they are fewer than the picture's.
    coarse: Film,
    /// Of each block that is finished.
    accounts: Vec<Option<(Account, usize)>>,
}

impl Own {
    /// The estimated error of what is finished, added up in the order of the blocks.
    fn rmse(&self) -> f64 {
        let finished = || self.accounts.iter().flatten();
        let pixels: usize = finished().map(|(_, pixels)| pixels).sum();
        Account::sum(finished().map(|(account, _)| account)).rmse(pixels)
    }
}

/// Puts the blocks of a pass on the canvas.
struct Painter<'a> {
    canvas: &'a Canvas,
    number: u64,
    own: Mutex<Own>,
    is_fine: bool,
    is_last: bool,
    changed: &'a (dyn Fn() + Sync),
}

impl Sink for Painter<'_> {
    fn put(&self, block: Block) {
        let mut own = self.own.lock().unwrap_or_else(PoisonError::into_inner);
        own.accounts[block.number] = Some((block.account, block.colors.len()));
        let is_whole = own.accounts.iter().all(Option::is_some);
        if !self.is_fine {
            own.coarse.blit(&block.place, &block.colors, &block.samples);
            if !is_whole {
                return;
            }
        }
        let Some(mut shown) = self.canvas.of(self.number) else { return };
        if self.is_fine {
            shown.film.blit(&block.place, &block.colors, &block.samples);
        } else {
            shown.film = own.coarse.resampled([shown.film.width(), shown.film.height()]);
        }
        if self.is_last {
            shown.estimated_rmse = Some(own.rmse());
        }
        drop(shown);
        (self.changed)();
    }

    fn is_stopped(&self) -> bool {
        self.canvas.of(self.number).is_none()
    }

    fn is_abandoned(&self) -> bool {
        self.is_stopped()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use crate::{render::render, scene::load_builtin};

    fn options(aa: AntiAliasing) -> RenderOptions {
        RenderOptions { size: Some([61, 43]), aa, ..RenderOptions::default() }
    }

    #[test]
    fn passes_end_with_the_picture_itself() {
        for aa in ["none", "grid:2", "adaptive"].map(|mode| mode.parse().expect(mode)) {
            let passes = passes([61, 43], aa);
            assert_eq!(passes.last(), Some(&Pass { size: [61, 43], aa }));
            assert_eq!(passes[0], Pass { size: [8, 6], aa: AntiAliasing::None });
            let pixels: Vec<u32> = passes.iter().map(|pass| pass.size[0] * pass.size[1]).collect();
            assert!(pixels.is_sorted() && passes.windows(2).all(|pair| pair[0] != pair[1]));
        }
        assert_eq!(passes([1, 1], AntiAliasing::None)[0].size, [1, 1]);
    }

    /// Oracle: the same picture rendered without being looked at.
    #[test]
    fn what_is_shown_in_the_end_is_the_picture() {
        let scene = load_builtin("assignment").expect("a scene");
        for aa in ["none", "grid:2", "adaptive"].map(|mode| mode.parse().expect(mode)) {
            let options = options(aa);
            let canvas = Canvas::new([20, 30]);
            let changes = AtomicUsize::new(0);
            let changed = || {
                changes.fetch_add(1, Ordering::Relaxed);
            };
            canvas.render(canvas.begin(), &scene, &options, &changed, &|| true).expect("rendered");
            let expected = render(&scene, &options, &|_| ()).expect("rendered");
            let shown = canvas.look();
            assert_eq!(shown.film, expected.film);
            let [error, expected] =
                [&shown.estimated_rmse, &expected.estimated_rmse].map(|e| e.expect("an estimate"));
            assert!((error / expected - 1.0).abs() < 1e-9, "{error}");
            assert!(shown.seconds.is_some() && shown.pass.0 == shown.pass.1 + 1);
            assert!(changes.load(Ordering::Relaxed) >= shown.pass.1);
        }
    }

    /// Oracle: a camera moved in the description gives the same picture as one moved by the options.
    #[test]
    fn another_camera_sees_what_the_scene_with_that_camera_shows() {
        use crate::scene::{LoadOptions, Orbit, load};
        let scene = load_builtin("assignment").expect("a scene");
        let mut orbit = Orbit::new(*scene.camera_plan(), Some(80.0));
        orbit.turn(20.0, 10.0);
        let plan = *orbit.plan();
        let load_options = LoadOptions {
            eye: Some(plan.eye),
            look_at: Some(plan.look_at),
            ..LoadOptions::default()
        };
        let other = load("assignment", &load_options).expect("a scene").scene;
        let camera = plan.camera().expect("a camera");
        let options = options(AntiAliasing::None);
        let moved = RenderOptions { camera: Some(camera), ..options };
        let [a, b, c] = [(&scene, moved), (&other, options), (&scene, options)]
            .map(|(scene, options)| render(scene, &options, &|_| ()).expect("rendered").film);
        assert!(a == b && a != c);
        assert_eq!(scene.hash_from(camera), other.hash());
        assert_ne!(scene.hash(), other.hash());
    }

    #[test]
    fn a_picture_that_is_no_longer_wanted_leaves_nothing() {
        let scene = load_builtin("assignment").expect("a scene");
        let canvas = Canvas::new([61, 43]);
        let stale = canvas.begin();
        let fresh = canvas.begin();
        canvas
            .render(stale, &scene, &options(AntiAliasing::None), &|| (), &|| true)
            .expect("nothing to do");
        assert_eq!(canvas.look().film, Film::new(61, 43));
        // One that is not wanted after its first pass stays coarse.
        canvas
            .render(fresh, &scene, &options(AntiAliasing::None), &|| (), &|| false)
            .expect("rendered");
        let shown = canvas.look();
        assert!(shown.seconds.is_none() && shown.film.pixel(3, 2) == shown.film.pixel(4, 3));
        assert_ne!(shown.film, Film::new(61, 43));
    }
}
