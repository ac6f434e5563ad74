//! The fields of a JSON Schema as rows of a table.

use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// The rows of a table as they are found.
pub(super) struct Table<'a> {
    pub definitions: &'a Value,
    /// Definitions that are described, and where.
    pub shown: BTreeMap<String, String>,
    rows: Vec<String>,
}

/// The type of a field in words.
struct Kind {
    /// Of one, and of several.
    one: String,
    many: String,
    /// What is said of single values.
    values: Vec<String>,
    may_be_null: bool,
    /// An object with rows of its own, and what is appended to the path for it.
    below: Option<(String, Value)>,
}

impl Kind {
    fn new(one: impl Into<String>, many: impl Into<String>) -> Self {
        Self { one: one.into(), many: many.into(), values: Vec::new(), may_be_null: false, below: None }
    }
}

impl<'a> Table<'a> {
    pub fn new(schema: &'a Value) -> Self {
        Self { definitions: &schema["$defs"], shown: BTreeMap::new(), rows: Vec::new() }
    }

    /// The table of the fields of a schema, of which these are the definitions.
    pub fn written(&mut self, schema: &Value) -> String {
        self.fields("", schema);
        let rows = std::mem::take(&mut self.rows);
        format!("| field | type | meaning |\n|---|---|---|\n{}", rows.concat())
    }

    /// The fields of an object, in the order of their declaration, those that may be missing last.
    fn fields(&mut self, path: &str, schema: &Value) {
        let (none, empty) = (Vec::new(), Map::new());
        let all = schema["properties"].as_object().unwrap_or(&empty);
        let required: Vec<&str> =
            schema["required"].as_array().unwrap_or(&none).iter().filter_map(Value::as_str).collect();
        let optional = all.keys().map(String::as_str).filter(|name| !required.contains(name));
        for (name, may_be_missing) in
            required.iter().map(|name| (*name, false)).chain(optional.map(|name| (name, true)))
        {
            if let Some(field) = all.get(name) {
                let path = if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
                self.row(&path, field, may_be_missing);
            }
        }
    }

    fn row(&mut self, path: &str, field: &Value, may_be_missing: bool) {
        let Kind { one, values, may_be_null, below, .. } = self.kind(path, field);
        let null = if may_be_null { " or `null`" } else { "" };
        let missing = if may_be_missing { ", may be missing" } else { "" };
        let told = [described(field)].into_iter().filter(|text| !text.is_empty());
        let words = told.chain(values).collect::<Vec<_>>().join(" ");
        self.rows.push(format!("| `{path}` | {one}{null}{missing} | {} |\n", words.replace('|', "\\|")));
        if let Some((after, schema)) = below {
            self.fields(&format!("{path}{after}"), &schema);
        }
    }

    fn kind(&mut self, path: &str, schema: &Value) -> Kind {
        if let Some(name) = schema["$ref"].as_str().and_then(|path| path.rsplit('/').next()) {
            return self.definition(path, name);
        }
        if let Some(choices) = schema["anyOf"].as_array().or(schema["oneOf"].as_array()) {
            return self.choice(path, choices);
        }
        let (mut names, none) = (schema["type"].clone(), Vec::new());
        if let Some(all) = schema["type"].as_array() {
            names = all.iter().find(|name| **name != "null").cloned().unwrap_or_default();
        }
        let listed = schema["enum"].as_array().unwrap_or(&none).iter().chain(schema.get("const"));
        let listed: Vec<String> = listed.filter(|value| !value.is_null()).map(quoted).collect();
        let mut kind = match names.as_str() {
            _ if listed.len() == 1 => Kind::new(listed.concat(), listed.concat()),
            _ if !listed.is_empty() => {
                let listed = listed.join(", ");
                Kind::new(format!("one of {listed}"), listed)
            }
            Some("number") => Kind::new("number", "numbers"),
            Some("integer") => Kind::new("whole number", "whole numbers"),
            Some("string") => Kind::new("text", "texts"),
            Some("boolean") => Kind::new("`true` or `false`", "`true` or `false`"),
            Some("array") => self.list(path, schema),
            _ => self.object(path, schema),
        };
        // Any number may be null, if it is not finite.
        let has_null = |names: &Value| names.as_array().is_some_and(|names| names.contains(&json!("null")));
        kind.may_be_null |= has_null(&schema["type"]) && names != "number";
        kind
    }

    /// What has a name of its own is described where it is met first.
    fn definition(&mut self, path: &str, name: &str) -> Kind {
        let schema = self.definitions[name].clone();
        let is_object = schema["properties"].is_object();
        if let Some(place) = self.shown.get(name) {
            let (one, many) = if is_object { ("object", "objects") } else { ("text", "texts") };
            return Kind::new(format!("{one} as {place}"), format!("{many} as {place}"));
        }
        let choices = schema["oneOf"].as_array();
        if is_object || choices.is_some_and(|all| all.iter().all(|choice| choice["const"].is_string())) {
            self.shown.insert(name.to_owned(), format!("`{path}`"));
        }
        self.kind(path, &schema)
    }

    fn list(&mut self, path: &str, schema: &Value) -> Kind {
        let fixed = schema["minItems"].as_u64().filter(|least| schema["maxItems"] == *least);
        let entry = if schema["items"].is_object() { &schema["items"] } else { &schema["prefixItems"][0] };
        let Kind { many, values, may_be_null, below, .. } = self.kind(path, entry);
        let many = if may_be_null { format!("{many} or `null`") } else { many };
        let is_counted = many.starts_with(|first: char| first.is_ascii_digit());
        let (one, many) = match fixed {
            Some(count) if is_counted => (format!("{count} × {many}"), format!("{count} × {many}")),
            Some(count) => (format!("{count} {many}"), format!("{count} {many}")),
            None if is_counted => (format!("list of {many} each"), format!("lists of {many} each")),
            None => (format!("list of {many}"), format!("lists of {many}")),
        };
        let below = below.map(|(after, schema)| (format!("[]{after}"), schema));
        Kind { values, below, ..Kind::new(one, many) }
    }

    fn object(&mut self, path: &str, schema: &Value) -> Kind {
        if schema["additionalProperties"].is_object() {
            let Kind { many, values, may_be_null, below, .. } =
                self.kind(path, &schema["additionalProperties"]);
            let many = if may_be_null { format!("{many} or `null`") } else { many };
            let below = below.map(|(after, schema)| (format!(".NAME{after}"), schema));
            let names = schema["propertyNames"]["enum"].as_array();
            let listed = |names: &Vec<Value>| names.iter().map(quoted).collect::<Vec<_>>().join(", ");
            let by = names.map_or("by name".to_owned(), |names| format!("by name ({})", listed(names)));
            let one = format!("{many} {by}");
            return Kind { values, below, ..Kind::new(one.clone(), one) };
        }
        let below = schema["properties"].is_object().then(|| (String::new(), schema.clone()));
        Kind { below, ..Kind::new("object", "objects") }
    }

    /// One of several: of texts with a meaning each, of objects, of anything and null.
    fn choice(&mut self, path: &str, choices: &[Value]) -> Kind {
        let (nulls, choices): (Vec<&Value>, Vec<&Value>) =
            choices.iter().partition(|choice| choice["type"] == "null");
        let (objects, rest): (Vec<&Value>, Vec<&Value>) =
            choices.iter().partition(|choice| choice["properties"].is_object());
        let mut kind = match rest.as_slice() {
            [] => Kind::new("object", "objects"),
            [only] if objects.is_empty() => self.kind(path, only),
            _ => {
                let values =
                    rest.iter().map(|value| format!("{}: {}", quoted(&value["const"]), described(value)));
                Kind { values: values.collect(), ..Kind::new("text", "texts") }
            }
        };
        if !objects.is_empty() {
            if !rest.is_empty() {
                kind.one += " or object";
                kind.many += " or objects";
            }
            kind.below = Some((String::new(), joined(&objects, rest.is_empty())));
        }
        kind.may_be_null |= !nulls.is_empty();
        kind
    }
}

/// The fields of objects of which there is one, always or now and then.
fn joined(objects: &[&Value], always: bool) -> Value {
    let mut fields = Map::new();
    for object in objects {
        let own = object["properties"].as_object();
        for (name, field) in own.into_iter().flatten() {
            let mut field = field.clone();
            if field["description"].is_null() {
                field["description"] = object["description"].clone();
            }
            match fields.get_mut(name) {
                None => drop(fields.insert(name.clone(), field)),
                Some(known) if known.get("oneOf").is_some() => {
                    known["oneOf"].as_array_mut().into_iter().for_each(|choices| choices.push(field.clone()));
                }
                Some(known) if field.get("const").is_some() => {
                    *known = json!({ "oneOf": [known.take(), field] })
                }
                Some(_) => {}
            }
        }
    }
    let in_all =
        |name: &&String| always && objects.iter().all(|object| object["properties"].get(name).is_some());
    let required: Vec<&String> = fields.keys().filter(in_all).collect();
    json!({ "required": required, "properties": fields })
}

/// The first paragraph of what is said of a field.
fn described(field: &Value) -> String {
    let text = field["description"].as_str().unwrap_or_default();
    text.split("\n\n").next().unwrap_or_default().replace('\n', " ")
}

fn quoted(value: &Value) -> String {
    format!("`{}`", value.as_str().map_or_else(|| value.to_string(), str::to_owned))
}
