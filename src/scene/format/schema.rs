//! The JSON schema of the scene format, by which editors complete and check it.

use std::fmt::Write;

use super::keys::{Key, Kind, Range, SCENE};

/// The schema, as indented JSON.
pub fn schema() -> String {
    let mut out = String::from("{\n  \"$schema\": \"http://json-schema.org/draft-07/schema#\",\n");
    out.push_str("  \"title\": \"A scene of whitted\",\n");
    out.push_str("  \"description\": \"Lengths in scene units, axes right-handed with y up, angles in degrees, colours as sRGB display values from 0 to 1 unless color_space says linear\",\n");
    table(&mut out, SCENE, 1, true);
    out.push_str("\n}\n");
    out
}

fn line(out: &mut String, indent: usize, text: &str) {
    let _ = write!(out, "\n{:1$}{text}", "", indent * 2);
}

/// The members of an object schema, without its braces.
fn table(out: &mut String, keys: &[Key], indent: usize, all: bool) {
    if out.ends_with('\n') {
        out.pop();
    }
    line(out, indent, "\"type\": \"object\",");
    line(out, indent, "\"additionalProperties\": false,");
    if all {
        let required: Vec<String> =
            keys.iter().filter(|k| k.required).map(|k| format!("\"{}\"", k.name)).collect();
        line(out, indent, &format!("\"required\": [{}],", required.join(", ")));
    } else {
        line(out, indent, "\"minProperties\": 1,");
        line(out, indent, "\"maxProperties\": 1,");
    }
    line(out, indent, "\"properties\": {");
    for (k, key) in keys.iter().enumerate() {
        line(out, indent + 1, &format!("\"{}\": {{", key.name));
        line(out, indent + 2, &format!("\"description\": {},", quoted(key.about)));
        value(out, key.kind, indent + 2);
        line(out, indent + 1, if k + 1 < keys.len() { "}," } else { "}" });
    }
    line(out, indent, "}");
}

/// The members of a value's schema, without its braces.
fn value(out: &mut String, kind: Kind, indent: usize) {
    let channels = |items: &str, least: usize, most: usize| {
        format!(
            "\"type\": \"array\", \"items\": {{ {items} }}, \"minItems\": {least}, \"maxItems\": {most}"
        )
    };
    let number = "\"type\": \"number\"";
    let text = match kind {
        Kind::Number(Range::Any) => number.to_owned(),
        Kind::Number(Range::Positive) => format!("{number}, \"exclusiveMinimum\": 0"),
        Kind::Number(Range::AtLeastZero) => format!("{number}, \"minimum\": 0"),
        Kind::Number(Range::Angle) => {
            format!("{number}, \"exclusiveMinimum\": 0, \"exclusiveMaximum\": 180")
        }
        Kind::Whole(least) => {
            format!("\"type\": \"integer\", \"minimum\": {least}, \"maximum\": {}", u32::MAX)
        }
        Kind::Text | Kind::File | Kind::Name(_) => {
            "\"type\": \"string\", \"minLength\": 1".to_owned()
        }
        Kind::Color => channels("\"type\": \"number\", \"minimum\": 0, \"maximum\": 1", 3, 3),
        Kind::Vector => channels(number, 3, 3),
        Kind::Size => channels("\"type\": \"integer\", \"minimum\": 1", 2, 2),
        Kind::Vectors { least, most } => channels(&channels(number, 3, 3), least, most),
        Kind::Choice(choices) => {
            let choices: Vec<String> = choices.iter().map(|c| quoted(c)).collect();
            format!("\"enum\": [{}]", choices.join(", "))
        }
        Kind::Table(keys) => return table(out, keys, indent, true),
        Kind::OneOf(keys) => return table(out, keys, indent, false),
        Kind::Named(kind) => return nested(out, "additionalProperties", "object", *kind, indent),
        Kind::List(kind) => return nested(out, "items", "array", *kind, indent),
    };
    line(out, indent, &text);
}

fn nested(out: &mut String, member: &str, of: &str, kind: Kind, indent: usize) {
    line(out, indent, &format!("\"type\": \"{of}\","));
    line(out, indent, &format!("\"{member}\": {{"));
    value(out, kind, indent + 1);
    line(out, indent, "}");
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_schema_is_json_and_knows_the_keys() {
        let schema: serde_json::Value = serde_json::from_str(&schema()).expect("JSON");
        let shapes = &schema["properties"]["object"]["items"]["properties"]["shape"];
        assert_eq!(shapes["properties"]["sphere"]["required"][1], "radius");
        assert_eq!(shapes["maxProperties"], 1);
        assert_eq!(schema["additionalProperties"], false);
    }
}
