//! JSON Schema (draft 07) of input files, made from the model's keys.
//!
//! Editors with a TOML server show ranges, options, units and meanings from it and mark unknown keys.

use cvtcycle_model::files::{HEAD, HeadKeys};
use cvtcycle_model::keys::{Bound, Choice, Key, Kind, Presence, Quantity, Repeat, Table};
use serde_json::{Map, Value, json};

use crate::reader::origin::{COLUMNS, STATUSES};

/// The schema of a kind of file: its name in the title, and its keys.
///
/// ```
/// use cvtcycle_config::schema;
/// use cvtcycle_model::files::VEHICLE;
/// let vehicle = schema::json_schema("vehicle", &VEHICLE);
/// let belt = &vehicle["properties"]["transmission"]["anyOf"][2]["properties"]["cvt"]["properties"]["belt"];
/// assert_eq!(belt["properties"]["band_offset_mm"]["anyOf"][0]["maximum"], 20.0);
/// ```
#[must_use]
pub fn json_schema(file: &str, keys: &Table) -> Value {
    let is_head = |table: &&Table| table.name == HeadKeys::TABLE.name;
    let head = keys.tables.iter().find(is_head);
    let mut schema = table(keys, head.is_none());
    if let Some(head) = head {
        // Required keys may be inherited.
        let like = open(json!({ "required": [HEAD.like.name] }));
        schema["if"] = open(json!({ "required": [head.name], "properties": { head.name: like } }));
        schema["else"] = requirements(keys);
    }
    schema["$schema"] = json!("http://json-schema.org/draft-07/schema#");
    schema["title"] = json!(format!("cvtcycle {file} file"));
    schema
}

/// A table with all its keys; `complete` if those that are required have to be there.
fn table(table: &Table, complete: bool) -> Value {
    let mut properties = Map::new();
    let mut required = Vec::new();
    for key in table.keys {
        properties.insert(key.name.to_owned(), entry(key, complete));
        if matches!(key.presence, Presence::Required) {
            required.push(key.name);
        }
    }
    for inner in table.tables {
        let mut schema = self::table(inner, complete);
        if inner.name.is_empty() {
            // Keys of one of several forms of this table: of equal names each form is allowed.
            for (name, entry) in schema["properties"].as_object_mut().into_iter().flatten() {
                let other = properties.remove(name);
                let forms = other.map(|other| json!({ "anyOf": [other, entry] }));
                properties.insert(name.clone(), forms.unwrap_or_else(|| entry.take()));
            }
            continue;
        }
        let schema = match inner.repeat {
            Repeat::Once | Repeat::Optional => schema,
            Repeat::List => json!({ "type": "array", "items": schema }),
            Repeat::Named => json!({ "type": "object", "additionalProperties": schema }),
        };
        properties.insert(inner.name.to_owned(), schema);
        if is_required(inner) {
            required.push(inner.name);
        }
    }
    let mut schema = json!({
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
    });
    if complete && !required.is_empty() {
        schema["required"] = json!(required);
    }
    schema
}

/// Only what is required in a table and below it.
fn requirements(table: &Table) -> Value {
    let mut properties = Map::new();
    let mut required = Vec::new();
    for key in table.keys {
        if matches!(key.presence, Presence::Required) {
            required.push(key.name);
        }
        if let Kind::Options(choices) = key.kind {
            let options = choices.iter();
            let options = options.map(|one| (one.name.to_owned(), requirements(&one.table)));
            let options: Map<_, _> = options.collect();
            properties.insert(key.name.to_owned(), open(json!({ "properties": options })));
        }
    }
    for inner in table.tables.iter().filter(|inner| is_required(inner)) {
        required.push(inner.name);
        properties.insert(inner.name.to_owned(), requirements(inner));
    }
    open(json!({ "required": required, "properties": properties }))
}

/// A table that may have other entries as well. JSON Schema lets it have them anyway; some editors ask for it in words.
fn open(mut table: Value) -> Value {
    table["additionalProperties"] = json!(true);
    table
}

/// True if a table has a key that is always required.
fn is_required(table: &Table) -> bool {
    let required = |key: &&Key<'_>| matches!(key.presence, Presence::Required);
    table.repeat == Repeat::Once
        && (table.keys.iter().any(required) || table.tables.iter().any(is_required))
}

/// A key: its bare value, or the value with its origin; an option also as a table.
fn entry(key: &Key<'_>, complete: bool) -> Value {
    let bare = value(&key.kind);
    let text = json!({ "type": "string" });
    let mut forms = vec![
        bare.clone(),
        json!({
            "type": "object",
            "properties": {
                "value": bare,
                "range": { "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 },
                "status": { "enum": STATUSES },
                "source": text,
                "note": text.clone(),
            },
            "required": ["value"],
            "additionalProperties": false,
        }),
    ];
    if matches!(key.kind, Kind::Csv) {
        forms[1]["properties"][COLUMNS] = text;
    }
    if let Kind::Options(choices) = key.kind {
        forms.push(options(choices, complete));
    }
    let mut schema = json!({ "description": description(key), "anyOf": forms });
    match key.presence {
        Presence::Number(default) => schema["default"] = json!(default),
        Presence::Integer(default) => schema["default"] = json!(default),
        Presence::Flag(default) => schema["default"] = json!(default),
        Presence::Word(default) => schema["default"] = json!(default),
        _ => {}
    }
    schema
}

fn options(choices: &[Choice], complete: bool) -> Value {
    let tables = choices.iter().map(|choice| {
        let mut schema = table(&choice.table, complete);
        schema["description"] = json!(choice.doc);
        (choice.name.to_owned(), schema)
    });
    json!({
        "type": "object",
        "properties": tables.collect::<Map<_, _>>(),
        "additionalProperties": false,
        "maxProperties": 1,
    })
}

/// Meaning, unit and allowed values.
fn description(key: &Key<'_>) -> String {
    let mut text = format!("{}\n\nAllowed: {}", key.meaning(), key.allowed());
    if let Kind::Words(choices) | Kind::Options(choices) = key.kind {
        for choice in choices {
            text += &format!("\n- {}: {}", choice.name, choice.doc);
        }
    }
    match key.presence {
        Presence::RequiredIf(condition) => text += &format!("\n\nRequired {condition}"),
        Presence::Computed(words) => text += &format!("\n\nDefault: {words}"),
        Presence::Required | Presence::Optional => {}
        Presence::Number(default) => {
            text += &format!("\n\nDefault: {default} {}", key.quantity.unit());
        }
        Presence::Integer(_) | Presence::Flag(_) | Presence::Word(_) => {}
    }
    text
}

/// The bare value of a key.
fn value(kind: &Kind<'_>) -> Value {
    match kind {
        Kind::Number(range) => number(range),
        Kind::Integer(low, i64::MAX) => json!({ "type": "integer", "minimum": low }),
        Kind::Integer(low, high) => json!({ "type": "integer", "minimum": low, "maximum": high }),
        Kind::Flag => json!({ "type": "boolean" }),
        Kind::Text | Kind::Csv | Kind::Name(_) => json!({ "type": "string" }),
        Kind::Words(choices) | Kind::Options(choices) => {
            json!({ "enum": choices.iter().map(|choice| choice.name).collect::<Vec<_>>() })
        }
        Kind::Numbers(range, least, most) => {
            json!({ "type": "array", "items": number(range), "minItems": least, "maxItems": most })
        }
        Kind::Grid(range) => {
            let list = json!({ "type": "array", "items": number(range) });
            json!({ "anyOf": [number(range), list, { "type": "string", "pattern": r"\.\..*:" }] })
        }
        Kind::Texts => json!({ "type": "array", "items": { "type": "string" } }),
        Kind::Rows(columns) => {
            let cell = |(name, range): &(&str, Bound)| {
                let mut schema = number(range);
                schema["description"] =
                    json!(format!("{name} [{}]", Quantity::from_key(name).unit()));
                schema
            };
            let cells: Vec<Value> = columns.iter().map(cell).collect();
            let count = cells.len();
            let row =
                json!({ "type": "array", "items": cells, "minItems": count, "maxItems": count });
            json!({ "type": "array", "items": row })
        }
        Kind::List(item, _) => json!({ "type": "array", "items": value(item) }),
        Kind::Either(kinds) => json!({ "anyOf": kinds.iter().map(value).collect::<Vec<_>>() }),
        Kind::Other(_) => json!({}),
    }
}

fn number(range: &Bound) -> Value {
    let mut schema = json!({ "type": "number" });
    if range.low().is_finite() {
        let low = if range.includes_low() {
            "minimum"
        } else {
            "exclusiveMinimum"
        };
        schema[low] = json!(range.low());
    }
    if range.high().is_finite() {
        schema["maximum"] = json!(range.high());
    }
    schema
}
