//! The window, and what happens in it.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::{Context as _, anyhow};
use glam::DVec2;
use winit::application::ApplicationHandler;
use winit::event::{ElementState, WindowEvent};
use winit::event_loop::{ActiveEventLoop, EventLoop, EventLoopProxy};
use winit::window::WindowId;

use super::super::failure::Failure;
use super::controls::{self, Action, Mouse};
use super::pane::Pane;
use super::viewer::Viewer;

/// What the render has to say to the window.
#[derive(Debug)]
pub(super) enum Event {
    /// There is more to see.
    Changed,
    /// It failed, and why.
    Failed(String),
}

/// The display, which must be there before anything else is done.
pub(super) fn open_display() -> Result<EventLoop<Event>, Failure> {
    let events = EventLoop::with_user_event().build().map_err(|error| {
        // It begins with a place in the source of winit.
        let text = error.to_string();
        let reason = text.rsplit(": ").next().unwrap_or_default().trim_end_matches('.');
        anyhow!("there is no display for a window ({reason}); `whitted render --preview` shows a picture in a terminal")
    })?;
    Ok(events)
}

/// Shows the window until it is closed.
pub(super) fn run(events: EventLoop<Event>, viewer: Viewer) -> Result<(), Failure> {
    let proxy = events.create_proxy();
    let is_told = Arc::new(AtomicBool::new(false));
    let mut app =
        App { viewer, proxy, is_told, mouse: Mouse::default(), pane: None, failure: None };
    events.run_app(&mut app).context("the window failed")?;
    app.failure.map_or(Ok(()), Err)
}

struct App {
    viewer: Viewer,
    proxy: EventLoopProxy<Event>,
    /// Whether a [`Event::Changed`] is on its way, which then is enough.
    is_told: Arc<AtomicBool>,
    mouse: Mouse,
    pane: Option<Pane>,
    failure: Option<Failure>,
}

impl App {
    /// Ends if that failed.
    fn done(&mut self, events: &ActiveEventLoop, result: Result<(), Failure>) {
        if let Err(failure) = result {
            self.failure = Some(failure);
            events.exit();
        }
    }

    fn act(&mut self, events: &ActiveEventLoop, action: Action) {
        match self.viewer.act(action) {
            Ok(true) => self.redraw(),
            Ok(false) => events.exit(),
            Err(failure) => self.done(events, Err(failure)),
        }
    }

    fn redraw(&self) {
        if let Some(pane) = &self.pane {
            pane.request_redraw();
        }
    }

    /// Begins the next picture, if one is wanted.
    fn work(&mut self, events: &ActiveEventLoop) {
        let Some(work) = self.viewer.take_work() else { return };
        let (proxy, is_told) = (self.proxy.clone(), Arc::clone(&self.is_told));
        let spawned = std::thread::Builder::new().name("view".to_owned()).spawn(move || {
            // An error here is a window that is closed already.
            let changed = || {
                if !is_told.swap(true, Ordering::SeqCst) {
                    let _ = proxy.send_event(Event::Changed);
                }
            };
            if let Err(error) = work.run(&changed) {
                let _ = proxy.send_event(Event::Failed(error));
            }
        });
        let spawned = spawned.map(|_| ()).context("a thread cannot be started");
        self.done(events, spawned.map_err(Failure::from));
    }

    fn draw(&mut self) -> Result<(), Failure> {
        let Some(pane) = &mut self.pane else { return Ok(()) };
        let shown = self.viewer.canvas().look();
        let bytes = pane.bytes_of(&shown.film);
        let (lines, title) = (self.viewer.lines(&shown), self.viewer.status(&shown));
        drop(shown);
        pane.draw(&bytes, &lines, &title)
    }
}

impl ApplicationHandler<Event> for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.pane.is_none() {
            let opened = Pane::open(events, self.viewer.size()).map(|pane| self.pane = Some(pane));
            self.done(events, opened);
        }
        self.work(events);
    }

    fn user_event(&mut self, events: &ActiveEventLoop, event: Event) {
        match event {
            Event::Changed => {
                self.is_told.store(false, Ordering::SeqCst);
                self.redraw();
                self.work(events);
            }
            Event::Failed(error) => self.done(events, Err(anyhow!(error).into())),
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => events.exit(),
            WindowEvent::RedrawRequested => {
                let drawn = self.draw();
                self.done(events, drawn);
            }
            WindowEvent::Resized(size) => self.viewer.resize([size.width, size.height]),
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                if let Some(action) = controls::of_key(&event.logical_key) {
                    self.act(events, action);
                }
            }
            WindowEvent::MouseInput { state, button, .. } => {
                self.mouse.press(button, state == ElementState::Pressed);
            }
            WindowEvent::MouseWheel { delta, .. } => self.act(events, controls::of_wheel(&delta)),
            WindowEvent::CursorMoved { position, .. } => {
                let height = f64::from(self.viewer.size()[1]);
                if let Some(action) = self.mouse.go(DVec2::new(position.x, position.y), height) {
                    self.act(events, action);
                }
            }
            _ => {}
        }
        self.work(events);
    }
}
