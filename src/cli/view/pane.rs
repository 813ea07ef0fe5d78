//! A window with a picture and text in it.

use std::num::NonZeroU32;
use std::rc::Rc;

use anyhow::{Context as _, anyhow};
use softbuffer::{Context, Surface};
use whitted::film::{Film, encode::to_srgb8};
use winit::dpi::PhysicalSize;
use winit::event_loop::{ActiveEventLoop, OwnedDisplayHandle};
use winit::window::Window;

use super::super::failure::Failure;
use super::text::Pixels;

/// Windows at least so high have letters of double size.
const HIGH: usize = 900;

pub(super) struct Pane {
    window: Rc<Window>,
    surface: Surface<OwnedDisplayHandle, Rc<Window>>,
}

fn failed(error: &softbuffer::SoftBufferError) -> anyhow::Error {
    anyhow!("the window cannot be drawn: {error}")
}

impl Pane {
    /// Opens a window of so many pixels.
    pub(super) fn open(
        events: &ActiveEventLoop,
        [width, height]: [u32; 2],
    ) -> Result<Self, Failure> {
        let attributes = Window::default_attributes()
            .with_title("whitted")
            .with_inner_size(PhysicalSize::new(width, height));
        let window =
            Rc::new(events.create_window(attributes).context("the window cannot be opened")?);
        let context =
            Context::new(events.owned_display_handle()).map_err(|error| failed(&error))?;
        let surface = Surface::new(&context, Rc::clone(&window)).map_err(|error| failed(&error))?;
        Ok(Self { window, surface })
    }

    pub(super) fn request_redraw(&self) {
        self.window.request_redraw();
    }

    /// The pixels of the window that show the film, three bytes each.
    pub(super) fn bytes_of(&self, film: &Film) -> Vec<u8> {
        let PhysicalSize { width, height } = self.window.inner_size();
        if [film.width(), film.height()] == [width, height] {
            to_srgb8(film)
        } else {
            to_srgb8(&film.resampled([width, height]))
        }
    }

    /// Shows what [`Pane::bytes_of`] gave, with lines of text over it.
    pub(super) fn draw(
        &mut self,
        bytes: &[u8],
        lines: &[String],
        title: &str,
    ) -> Result<(), Failure> {
        let PhysicalSize { width, height } = self.window.inner_size();
        let (Some(columns), Some(rows)) = (NonZeroU32::new(width), NonZeroU32::new(height)) else {
            return Ok(());
        };
        self.surface.resize(columns, rows).map_err(|error| failed(&error))?;
        let mut buffer = self.surface.buffer_mut().map_err(|error| failed(&error))?;
        for (pixel, rgb) in buffer.iter_mut().zip(bytes.chunks_exact(3)) {
            *pixel = u32::from_be_bytes([0, rgb[0], rgb[1], rgb[2]]);
        }
        let (width, height) = (width as usize, height as usize);
        let dot = if height >= HIGH { 2 } else { 1 };
        Pixels { width, height, values: &mut buffer }.write(lines, dot);
        self.window.set_title(&format!("whitted: {title}"));
        self.window.pre_present_notify();
        buffer.present().map_err(|error| failed(&error))?;
        Ok(())
    }
}
