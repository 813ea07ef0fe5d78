//! What mouse and keys mean.

use glam::DVec2;
use winit::event::{MouseButton, MouseScrollDelta};
use winit::keyboard::{Key, NamedKey};

/// How far an arrow key turns, in degrees.
const KEY_TURN: f64 = 10.0;
/// How far a mouse turns that goes over the height of the window, in degrees.
const MOUSE_TURN: f64 = 180.0;
/// What a step of the wheel, or + and -, make of the distance.
const STEP: f64 = 0.85;
/// Pixels of smooth scrolling that are as much as a step of a wheel.
const PIXELS_PER_STEP: f64 = 40.0;

/// What the user wants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Action {
    /// Turn aside and upwards, in degrees.
    Turn(f64, f64),
    /// Move what is seen, in heights of the window, to the right and up.
    Pan(DVec2),
    /// Multiply the distance.
    Zoom(f64),
    NextAa,
    Deeper,
    Shallower,
    Save,
    Reset,
    /// More text, or less.
    Text,
    End,
}

/// What a key means.
pub(super) fn of_key(key: &Key) -> Option<Action> {
    match key {
        Key::Named(NamedKey::ArrowLeft) => Some(Action::Turn(-KEY_TURN, 0.0)),
        Key::Named(NamedKey::ArrowRight) => Some(Action::Turn(KEY_TURN, 0.0)),
        Key::Named(NamedKey::ArrowUp) => Some(Action::Turn(0.0, KEY_TURN)),
        Key::Named(NamedKey::ArrowDown) => Some(Action::Turn(0.0, -KEY_TURN)),
        Key::Named(NamedKey::Escape) => Some(Action::End),
        Key::Character(letter) => match letter.as_str() {
            "+" | "=" => Some(Action::Zoom(STEP)),
            "-" => Some(Action::Zoom(1.0 / STEP)),
            "a" | "A" => Some(Action::NextAa),
            "d" => Some(Action::Shallower),
            "D" => Some(Action::Deeper),
            "s" | "S" => Some(Action::Save),
            "r" | "R" => Some(Action::Reset),
            "h" | "H" | "?" => Some(Action::Text),
            "q" | "Q" => Some(Action::End),
            _ => None,
        },
        _ => None,
    }
}

/// What a turn of the wheel means.
pub(super) fn of_wheel(delta: &MouseScrollDelta) -> Action {
    let steps = match delta {
        MouseScrollDelta::LineDelta(_, lines) => f64::from(*lines),
        MouseScrollDelta::PixelDelta(pixels) => pixels.y / PIXELS_PER_STEP,
    };
    Action::Zoom(STEP.powf(steps.clamp(-20.0, 20.0)))
}

/// Where the mouse is, and which button is down.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mouse {
    at: Option<DVec2>,
    button: Option<MouseButton>,
}

impl Mouse {
    /// A button goes down or up.
    pub(super) fn press(&mut self, button: MouseButton, is_down: bool) {
        self.button = is_down.then_some(button);
    }

    /// The mouse goes to a place, in pixels from the upper left, of a window of so many rows.
    pub(super) fn go(&mut self, to: DVec2, height: f64) -> Option<Action> {
        let by = (to - self.at.replace(to)?) / height.max(1.0);
        match self.button? {
            // What is seen follows the mouse, so the camera goes the other way.
            MouseButton::Left => Some(Action::Turn(-MOUSE_TURN * by.x, MOUSE_TURN * by.y)),
            MouseButton::Right | MouseButton::Middle => Some(Action::Pan(DVec2::new(by.x, -by.y))),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::CONTROLS;

    /// Oracle: the help text, whose every key must do something, and each something else.
    #[test]
    fn keys_are_those_of_the_help_text() {
        let key = |text: &str| of_key(&Key::Character(text.into()));
        let mut actions = Vec::new();
        for line in CONTROLS.lines() {
            let name = line.split_whitespace().next().expect("a name");
            let letter = name.trim_end_matches(',');
            if letter.len() == 1 {
                let action = key(letter).unwrap_or_else(|| panic!("{line}"));
                assert!(!actions.contains(&action), "{line}");
                actions.push(action);
            }
        }
        assert_eq!(actions.len(), 6);
        assert_eq!((key("D"), key("d")), (Some(Action::Deeper), Some(Action::Shallower)));
        assert_eq!(of_key(&Key::Named(NamedKey::Escape)), Some(Action::End));
        assert_eq!(key("x"), None);
    }

    #[test]
    fn the_mouse_drags_only_with_a_button_down() {
        let mut mouse = Mouse::default();
        assert_eq!(mouse.go(DVec2::new(10.0, 10.0), 100.0), None);
        assert_eq!(mouse.go(DVec2::new(20.0, 10.0), 100.0), None);
        mouse.press(MouseButton::Left, true);
        assert_eq!(mouse.go(DVec2::new(30.0, 60.0), 100.0), Some(Action::Turn(-18.0, 90.0)));
        mouse.press(MouseButton::Right, true);
        let pan = Action::Pan(DVec2::new(0.25, 0.5));
        assert_eq!(mouse.go(DVec2::new(55.0, 10.0), 100.0), Some(pan));
        mouse.press(MouseButton::Right, false);
        assert_eq!(mouse.go(DVec2::new(0.0, 0.0), 100.0), None);
    }

    #[test]
    fn the_wheel_nears_upwards() {
        let Action::Zoom(up) = of_wheel(&MouseScrollDelta::LineDelta(0.0, 1.0)) else { panic!() };
        let Action::Zoom(down) = of_wheel(&MouseScrollDelta::LineDelta(0.0, -1.0)) else {
            panic!()
        };
        assert!(up < 1.0 && (up * down - 1.0).abs() < 1e-12);
    }
}
