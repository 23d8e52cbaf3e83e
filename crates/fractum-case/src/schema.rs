//! The case format as a JSON schema, for editors that complete and check.

use serde_json::{Map, Value, json};

use super::key_kind::KeyKind;
use super::keys::{TIME_FUNCTION, keys};

/// The schema (JSON Schema draft 2020-12) of a case file, made from the list of keys.
pub fn schema() -> Value {
    let mut root = object("", "A fractum case");
    if let Value::Object(root) = &mut root {
        root.insert("$schema".to_string(), json!("https://json-schema.org/draft/2020-12/schema"));
        root.insert("$defs".to_string(), json!({ "time_function": object(TIME_FUNCTION, "A time function") }));
    }
    root
}

/// Schema of a table with the keys below a pattern.
fn object(pattern: &str, doc: &str) -> Value {
    let mut properties = Map::new();
    let mut required = Vec::new();
    let mut others = json!(false);
    for key in keys() {
        let parent = key.path.rsplit_once('.').map_or("", |(parent, _)| parent);
        let name = key.path.rsplit('.').next().unwrap_or_default().trim_end_matches("[]");
        if parent != pattern || name == TIME_FUNCTION {
            continue;
        }
        let schema = value(key.path, key.kind, key.doc, key.default);
        if name == "NAME" {
            others = schema;
            continue;
        }
        if key.default == "required" {
            required.push(name);
        }
        properties.insert(name.to_string(), schema);
    }
    let mut object = json!({ "type": "object", "description": doc, "additionalProperties": others });
    if !properties.is_empty() {
        object["properties"] = Value::Object(properties);
    }
    if !required.is_empty() {
        object["required"] = json!(required);
    }
    object
}

/// Schema of the value of a key.
fn value(path: &str, kind: KeyKind, doc: &str, default: &str) -> Value {
    let mut schema = match kind {
        // Its keys are those of [solver].
        KeyKind::Table if path == "stages[].solver" => return object("solver", doc),
        KeyKind::Table | KeyKind::NamedTables => return object(path, doc),
        KeyKind::Tables => return json!({ "type": "array", "description": doc, "items": object(path, doc) }),
        KeyKind::Text | KeyKind::Unit(_) | KeyKind::Condition | KeyKind::ProbeExpression => json!({ "type": "string" }),
        KeyKind::Names => json!({ "type": "array", "items": { "type": "string" }, "minItems": 1 }),
        KeyKind::AllOrNames => {
            json!({ "anyOf": [{ "type": "boolean" }, { "type": "array", "items": { "type": "string" }, "minItems": 2 }] })
        }
        KeyKind::Flag => json!({ "type": "boolean" }),
        KeyKind::Integer | KeyKind::Quantity(_) | KeyKind::Angle | KeyKind::AnyQuantity | KeyKind::Field(_) => {
            json!({ "type": ["number", "string"] })
        }
        KeyKind::Choice(names) => {
            let names = json!({ "type": "string", "enum": names() });
            let table = object(path, doc);
            if table.get("properties").is_some() { json!({ "anyOf": [names, table] }) } else { names }
        }
        KeyKind::DirectionOrAbout => {
            json!({ "anyOf": [{ "type": "string", "pattern": "^([-+]?[xyz]|radial|tangential)$" }, triple()] })
        }
        KeyKind::Direction => json!({ "anyOf": [{ "type": "string", "pattern": "^[-+]?[xyz]$" }, triple()] }),
        KeyKind::Point(_) => triple(),
        KeyKind::PointOrPlane(_) => {
            json!({ "type": "array", "items": { "type": ["number", "string"] }, "minItems": 2, "maxItems": 3 })
        }
        KeyKind::TimeFunction(_) => {
            json!({ "anyOf": [{ "type": ["number", "string"] }, { "$ref": "#/$defs/time_function" }] })
        }
        KeyKind::Firing => {
            let row = json!({
                "type": "array", "items": { "type": ["number", "string"] }, "minItems": 3, "maxItems": 3
            });
            json!({ "anyOf": [{ "type": "string" }, { "type": "array", "items": row, "minItems": 1 }] })
        }
        KeyKind::JointRows => {
            let row = json!({
                "type": "array", "items": { "type": ["number", "string"] }, "minItems": 4, "maxItems": 6
            });
            json!({ "anyOf": [{ "type": "string" }, { "type": "array", "items": row, "minItems": 1 }] })
        }
        KeyKind::RateCurve => {
            let pair = json!({
                "type": "array", "items": { "type": ["number", "string"] }, "minItems": 2, "maxItems": 2
            });
            json!({ "anyOf": [{ "type": ["number", "string"] }, { "type": "array", "items": pair, "minItems": 1 }] })
        }
        KeyKind::Points | KeyKind::Sieves => {
            let pair = json!({
                "type": "array", "items": { "type": ["number", "string"] }, "minItems": 2, "maxItems": 2
            });
            json!({ "type": "array", "items": pair, "minItems": 1 })
        }
    };
    let default = match default {
        "" | "required" => String::new(),
        _ => format!("; default {default}"),
    };
    schema["description"] = json!(format!("{doc} ({}{default})", kind.label()));
    schema
}

fn triple() -> Value {
    json!({ "type": "array", "items": { "type": ["number", "string"] }, "minItems": 3, "maxItems": 3 })
}
