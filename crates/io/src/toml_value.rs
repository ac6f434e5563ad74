//! Values of a TOML file and what they are.

use toml::de::DeValue;

use crate::error::TomlFault;

pub(crate) fn text<'a>(key: &'static str, value: &'a DeValue<'_>) -> Result<&'a str, TomlFault> {
    match value {
        DeValue::String(text) => Ok(text),
        other => Err(TomlFault::WrongType { key, found: kind(other), expected: "a text in quotation marks" }),
    }
}

pub(crate) fn truth(key: &'static str, value: &DeValue<'_>) -> Result<bool, TomlFault> {
    match value {
        DeValue::Boolean(truth) => Ok(*truth),
        other => Err(TomlFault::WrongType { key, found: kind(other), expected: "true or false" }),
    }
}

pub(crate) fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) => {
            i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|whole| whole as f64)
        }
        _ => None,
    }
}

pub(crate) fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "an array",
        DeValue::Table(_) => "a table",
    }
}
