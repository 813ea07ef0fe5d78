//! The window of `render --preview`.

use std::time::{Duration, Instant};

use whitted::checkpoint::Job;
use winit::application::ApplicationHandler;
use winit::event::{ElementState, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::platform::run_on_demand::EventLoopExtRunOnDemand;
use winit::window::WindowId;

use super::super::failure::Failure;
use super::super::warnings::Warnings;
use super::super::watch::Course;
use super::controls::{self, Action};
use super::pane::Pane;

/// How often it is looked whether the render has ended.
const LOOK: Duration = Duration::from_millis(50);
/// How often the picture is drawn.
const DRAW: Duration = Duration::from_millis(200);

/// A window that shows a picture while it is rendered, and the next one after it.
pub(crate) struct PreviewWindow {
    events: EventLoop<()>,
    /// Whether the user wants no window.
    is_closed: bool,
}

impl PreviewWindow {
    /// Finds the display; none if there is none.
    pub(crate) fn open() -> Option<Self> {
        Some(Self { events: EventLoop::new().ok()?, is_closed: false })
    }

    /// Shows the picture until its render has ended, or the user closes the window; the render goes on without it. To
    /// be called from the thread that the program began with.
    pub(crate) fn show(&mut self, job: &Job, course: &Course, warnings: &Warnings) {
        if self.is_closed {
            return;
        }
        let mut shown = Shown {
            job,
            course,
            pane: None,
            drawn: Instant::now(),
            is_closed: false,
            failure: None,
        };
        let done = self.events.run_app_on_demand(&mut shown);
        let failure = shown.failure.map(|failure| failure.to_string());
        if let Some(reason) = failure.or(done.err().map(|error| error.to_string())) {
            warnings.add(format!("--preview: {reason}; rendering without it"));
            self.is_closed = true;
        }
        self.is_closed |= shown.is_closed;
    }
}

struct Shown<'a> {
    job: &'a Job<'a>,
    course: &'a Course,
    pane: Option<Pane>,
    /// When it was drawn last.
    drawn: Instant,
    is_closed: bool,
    failure: Option<Failure>,
}

impl Shown<'_> {
    fn open(&self, events: &ActiveEventLoop) -> Result<Pane, Failure> {
        let picture = self.job.with_film(|film| [film.width(), film.height()]);
        let screen = events.available_monitors().next().map(|screen| screen.size());
        Pane::open(events, screen.map_or(picture, |room| fitting(picture, room.into())))
    }

    fn draw(&mut self) -> Result<(), Failure> {
        let Some(pane) = &mut self.pane else { return Ok(()) };
        let bytes = self.job.with_film(|film| pane.bytes_of(film));
        let done = format!("{} %", self.course.percent());
        let lines = [format!("{done}  q: close")];
        self.drawn = Instant::now();
        pane.draw(&bytes, &lines, &done)
    }

    /// Ends if that failed.
    fn done(&mut self, events: &ActiveEventLoop, result: Result<(), Failure>) {
        if let Err(failure) = result {
            self.failure = Some(failure);
            events.exit();
        }
    }

    fn close(&mut self, events: &ActiveEventLoop) {
        self.is_closed = true;
        events.exit();
    }
}

impl ApplicationHandler for Shown<'_> {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.pane.is_none() {
            let opened = self.open(events).map(|pane| self.pane = Some(pane));
            self.done(events, opened);
        }
    }

    fn about_to_wait(&mut self, events: &ActiveEventLoop) {
        if self.course.has_ended() {
            events.exit();
            return;
        }
        if self.drawn.elapsed() >= DRAW
            && let Some(pane) = &self.pane
        {
            pane.request_redraw();
        }
        events.set_control_flow(ControlFlow::WaitUntil(Instant::now() + LOOK));
    }

    /// While there are still events: the window is gone when they are sent.
    fn exiting(&mut self, _: &ActiveEventLoop) {
        self.pane = None;
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => self.close(events),
            WindowEvent::RedrawRequested => {
                let drawn = self.draw();
                self.done(events, drawn);
            }
            WindowEvent::KeyboardInput { event, .. }
                if event.state == ElementState::Pressed
                    && controls::of_key(&event.logical_key) == Some(Action::End) =>
            {
                self.close(events);
            }
            _ => {}
        }
    }
}

/// The size of a window that shows the whole picture in the room there is, with some of it left.
fn fitting([width, height]: [u32; 2], [columns, rows]: [u32; 2]) -> [u32; 2] {
    const SHARE: f64 = 0.9;
    let fill = |side: u32, room: u32| SHARE * f64::from(room) / f64::from(side.max(1));
    let scale = fill(width, columns).min(fill(height, rows)).min(1.0);
    [width, height].map(|side| ((f64::from(side) * scale).round() as u32).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_fit_on_the_screen_and_keep_their_form() {
        assert_eq!(fitting([640, 480], [1920, 1080]), [640, 480]);
        assert_eq!(fitting([8192, 8192], [1000, 2000]), [900, 900]);
        assert_eq!(fitting([100_000, 10], [1000, 1000]), [900, 1]);
    }
}
