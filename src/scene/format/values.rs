//! Values of a scene's text: what they are, and how a message shows them.

use toml::de::DeValue;

use super::{
    check::Value,
    keys::{Key, Range},
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

/// The number that it is.
pub(super) fn number(value: &DeValue) -> Option<f64> {
    match value {
        DeValue::Float(x) => x.as_str().replace('_', "").parse().ok(),
        DeValue::Integer(x) => i64::from_str_radix(x.as_str(), x.radix()).ok().map(|x| x as f64),
        _ => None,
    }
}

/// The whole number that it is, if that is not negative and not too large.
pub(super) fn whole(value: &DeValue) -> Option<u32> {
    let integer = value.as_integer()?;
    i64::from_str_radix(integer.as_str(), integer.radix()).ok()?.try_into().ok()
}

/// Whether it is three numbers that are accepted.
pub(super) fn vector(value: &Value, accepts: impl Fn(f64) -> bool) -> Option<()> {
    let list = value.get_ref().as_array()?;
    let is_good = |v: &Value| number(v.get_ref()).is_some_and(&accepts);
    (list.len() == 3 && list.iter().all(is_good)).then_some(())
}

/// Whether a number is in the range; NaN is in none.
pub(super) fn is_in(x: f64, range: Range) -> bool {
    x.is_finite()
        && match range {
            Range::Any => true,
            Range::Positive => x > 0.0,
            Range::AtLeastZero => x >= 0.0,
            Range::Angle => x > 0.0 && x < 180.0,
        }
}

/// The range in words.
pub(super) fn range_text(range: Range) -> &'static str {
    match range {
        Range::Any => "a finite number",
        Range::Positive => "a positive number",
        Range::AtLeastZero => "zero or a positive number",
        Range::Angle => "an angle in degrees, between 0 and 180",
    }
}
