//! A picture to render, for a thread of its own.

use std::sync::Arc;
use std::time::Duration;

use whitted::render::RenderOptions;
use whitted::render::refine::Canvas;
use whitted::scene::Scene;

/// How long the camera must rest before a pass other than the first is begun.
const REST: Duration = Duration::from_millis(80);

/// A picture to render.
pub(super) struct Work {
    scene: Arc<Scene>,
    canvas: Arc<Canvas>,
    number: u64,
    options: RenderOptions,
}

impl Work {
    /// A picture that takes the place of whatever else is rendered to the canvas.
    pub(super) fn begin(scene: Arc<Scene>, canvas: Arc<Canvas>, options: RenderOptions) -> Self {
        let number = canvas.begin();
        Self { scene, canvas, number, options }
    }

    /// Renders until the picture is done or no longer wanted; what went wrong otherwise.
    pub(super) fn run(&self, changed: &(dyn Fn() + Sync)) -> Result<(), String> {
        let is_wanted = || self.canvas.look().number == self.number;
        let goes_on = || {
            let left = REST.saturating_sub(self.canvas.look().started.elapsed());
            std::thread::sleep(left);
            is_wanted()
        };
        self.canvas
            .render(self.number, &self.scene, &self.options, changed, &goes_on)
            .map_err(|error| error.to_string())
    }
}
