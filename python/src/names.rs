//! Names of what the library enumerates: those that its report has.

use serde::Serialize;

/// The name of a value of an enumeration, as in "degenerate_face".
pub fn name_of(value: &impl Serialize) -> String {
    match serde_json::to_value(value) {
        Ok(serde_json::Value::String(name)) => name,
        _ => String::new(),
    }
}
