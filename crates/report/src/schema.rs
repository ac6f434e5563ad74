//! JSON Schemas of reports, made from the types that are written.

use schemars::generate::SchemaSettings;
use schemars::transform::{Transform, transform_subschemas};
use schemars::{JsonSchema, Schema};
use serde_json::{Value, json};

/// JSON Schema (draft 2020-12) of the JSON that a type is written as. Descriptions are the documentation of its fields. Every number may be
/// `null`, which is how one that is not finite is written.
///
/// ```
/// use voronudge_report::{Units, schema_of};
/// let schema = schema_of::<Units>();
/// assert_eq!(schema.get("required").unwrap(), &serde_json::json!(["length", "time"]));
/// assert!(schema.get("properties").unwrap()["length"]["description"].is_string());
/// ```
#[must_use]
pub fn schema_of<R: JsonSchema>() -> Schema {
    SchemaSettings::draft2020_12()
        .for_serialize()
        .with_transform(AsWritten)
        .into_generator()
        .into_root_schema_for::<R>()
}

/// What types do not say: numbers that are not finite are `null`, and there are no fields but those described.
#[derive(Debug, Clone)]
struct AsWritten;

impl Transform for AsWritten {
    fn transform(&mut self, schema: &mut Schema) {
        schema.remove("format");
        if schema.get("type").is_some_and(|own| own == "number") {
            schema.insert("type".into(), json!(["number", "null"]));
        }
        if schema.get("properties").is_some() && schema.get("additionalProperties").is_none() {
            schema.insert("additionalProperties".into(), Value::Bool(false));
        }
        transform_subschemas(self, schema);
    }
}
