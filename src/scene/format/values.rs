//! Values of a scene's text: what they are, and how a message shows them.

use toml::de::DeValue;

use super::{
    check::Value,
    keys::{Key, Kind, Range},
    nearest,
};

/// The message about a name that is none of the keys.
pub(super) fn unknown(what: &str, name: &str, keys: &[Key]) -> String {
    let names = || keys.iter().map(|key| key.name);
    match nearest(name, names()) {
        Some(near) => format!("unknown {what} `{name}`; did you mean `{near}`?"),
        None => format!("unknown {what} `{name}`; known: {}", listed(names())),
    }
}

/// Names in a row.
pub(super) fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// A value as a message shows it.
pub(super) fn shown(value: &DeValue) -> String {
    match value {
        DeValue::String(text) if text.len() <= 40 => format!("\"{}\"", text.escape_debug()),
        DeValue::String(_) => "a text".to_owned(),
        DeValue::Integer(_) | DeValue::Float(_) => {
            number(value).map_or("a number".to_owned(), |x| x.to_string())
        }
        DeValue::Boolean(value) => value.to_string(),
        DeValue::Datetime(_) => "a date".to_owned(),
        DeValue::Array(list) => match list.iter().map(|v| number(v.get_ref())).collect() {
            Some::<Vec<f64>>(numbers) if numbers.len() <= 4 => format!("{numbers:?}"),
            _ => format!("a list of {}", list.len()),
        },
        DeValue::Table(_) => "a table".to_owned(),
    }
}

/// What a value of a kind that is judged by itself alone should be, if it is not.
pub(super) fn unmet(value: &DeValue, kind: Kind) -> Option<String> {
    match kind {
        Kind::Number(range) if number(value).is_none_or(|x| !is_in(x, range)) => {
            Some(range_text(range).to_owned())
        }
        Kind::Whole(least) if whole(value).is_none_or(|x| x < least) => {
            Some(format!("a whole number from {least} to {}", u32::MAX))
        }
        Kind::Text if value.as_str().is_none_or(str::is_empty) => {
            Some("text that is not empty".to_owned())
        }
        Kind::Color if !is_vector(value, |x| (0.0..=1.0).contains(&x)) => {
            Some("three channels from 0 to 1, such as [1, 0.5, 0]".to_owned())
        }
        Kind::Vector if !is_vector(value, f64::is_finite) => {
            Some("three finite numbers, such as [1, 2.5, -3]".to_owned())
        }
        Kind::Size if !is_size(value) => {
            Some("two positive whole numbers, such as [640, 480]".to_owned())
        }
        Kind::Choice(choices) => {
            let text = value.as_str();
            if text.is_some_and(|text| choices.contains(&text)) {
                return None;
            }
            let hint = text.and_then(|t| nearest(t, choices.iter().copied()));
            let hint = hint.map_or(String::new(), |h| format!("; did you mean `{h}`?"));
            Some(format!("one of {}{hint}", listed(choices.iter().copied())))
        }
        _ => None, // it is, or its parts are to be judged
    }
}

/// The number that it is.
fn number(value: &DeValue) -> Option<f64> {
    match value {
        DeValue::Float(x) => x.as_str().replace('_', "").parse().ok(),
        DeValue::Integer(x) => i64::from_str_radix(x.as_str(), x.radix()).ok().map(|x| x as f64),
        _ => None,
    }
}

/// The whole number that it is, if that is not negative and not too large.
fn whole(value: &DeValue) -> Option<u32> {
    let integer = value.as_integer()?;
    i64::from_str_radix(integer.as_str(), integer.radix()).ok()?.try_into().ok()
}

/// Whether it is three numbers that are accepted.
fn is_vector(value: &DeValue, accepts: impl Fn(f64) -> bool) -> bool {
    let is_good = |v: &Value| number(v.get_ref()).is_some_and(&accepts);
    value.as_array().is_some_and(|list| list.len() == 3 && list.iter().all(is_good))
}

/// Whether it is two whole numbers from 1 on.
fn is_size(value: &DeValue) -> bool {
    let is_side = |side: &Value| whole(side.get_ref()).is_some_and(|n| n >= 1);
    value.as_array().is_some_and(|sides| sides.len() == 2 && sides.iter().all(is_side))
}

/// Whether a number is in the range; NaN is in none.
fn is_in(x: f64, range: Range) -> bool {
    x.is_finite()
        && match range {
            Range::Any => true,
            Range::Positive => x > 0.0,
            Range::AtLeastZero => x >= 0.0,
            Range::Angle => x > 0.0 && x < 180.0,
        }
}

/// The range in words.
fn range_text(range: Range) -> &'static str {
    match range {
        Range::Any => "a finite number",
        Range::Positive => "a positive finite number",
        Range::AtLeastZero => "zero or a positive finite number",
        Range::Angle => "an angle in degrees, between 0 and 180",
    }
}
