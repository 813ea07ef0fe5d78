//! `--preview`: the picture while it is rendered, in a window or in the terminal.

mod terminal;

pub(crate) use terminal::Terminal;

use super::args::RenderArgs;
use super::view::PreviewWindow;
use super::warnings::Warnings;

/// Where the picture is shown while it is rendered.
pub(crate) enum Preview {
    /// Nowhere.
    None,
    /// In a terminal.
    Terminal(Terminal),
    /// In a window.
    Window(Box<PreviewWindow>),
}

impl Preview {
    /// A window if there is a display for it, else the terminal if it can show pictures, if a preview is wanted.
    pub(crate) fn open(args: &RenderArgs, warnings: &Warnings) -> Self {
        if !args.preview {
            return Self::None;
        }
        if let Some(window) = PreviewWindow::open() {
            return Self::Window(Box::new(window));
        }
        if let Some(terminal) = Terminal::on_stderr() {
            return Self::Terminal(terminal);
        }
        let place = if cfg!(feature = "view") { "no display, and " } else { "" };
        warnings.add(format!(
            "--preview: there is {place}no terminal on standard error that shows pictures; rendering without it"
        ));
        Self::None
    }
}
