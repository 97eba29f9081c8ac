//! JSON Schema (draft 2020-12) of scenario files: keys, types, ranges, defaults and what they mean, from the declarations that
//! the reader itself goes by.

use corpuscle_experiments::{Deed, Experiment, Kind, Parameter, free};
use schemars::generate::SchemaSettings;
use serde_json::{Map, Value, json};

use crate::Registry;
use crate::scenario::DEFAULT_SEED;

const DIALECT: &str = "https://json-schema.org/draft/2020-12/schema";

/// Files of any kind.
pub fn all(registry: Registry) -> Value {
    let mut kinds: Vec<Value> = registry.iter().map(|known| experiment(known)).collect();
    let mut system = free();
    // References start at the root of the document.
    // What a deed is stands among them, and serves the experiments, too.
    let definitions = system.as_object_mut().and_then(|system| system.remove("$defs")).unwrap_or_default();
    kinds.push(system);
    for kind in &mut kinds {
        kind.as_object_mut().map(|kind| (kind.remove("$schema"), kind.remove("$defs")));
    }
    json!({ "$schema": DIALECT, "title": "Scenario of Corpuscle", "oneOf": kinds, "$defs": definitions })
}

/// Files that name this experiment.
pub fn experiment(experiment: &Experiment) -> Value {
    let parameters: Map<String, Value> = experiment.parameters.iter().map(|known| (known.name.into(), parameter(known))).collect();
    json!({
        "$schema": DIALECT,
        "title": experiment.title,
        "description": experiment.summary,
        "type": "object",
        "properties": {
            "experiment": { "const": experiment.name },
            "seed": seed(),
            "duration": { "description": "Physical time to run for.", "type": "number", "exclusiveMinimum": 0 },
            "parameters": { "type": "object", "properties": parameters, "additionalProperties": false },
            "deed": deeds(),
        },
        "required": ["experiment"],
        "additionalProperties": false,
        "$defs": definitions_of_deeds(),
    })
}

/// What is done on the way.
fn deeds() -> Value {
    json!({ "description": "What is done to the system, in the order of time.", "type": "array", "items": { "$ref": "#/$defs/Deed" } })
}

fn definitions_of_deeds() -> Value {
    let generator = SchemaSettings::draft2020_12().into_generator();
    let mut list = generator.into_root_schema_for::<Vec<Deed>>().to_value();
    list.as_object_mut().and_then(|list| list.remove("$defs")).unwrap_or_default()
}

/// Files that describe a system of their own.
pub fn free() -> Value {
    let generator = SchemaSettings::draft2020_12().into_generator();
    let mut schema = generator.into_root_schema_for::<free::System>().to_value();
    // The reader takes the seed out before it looks at the system.
    if let Some(keys) = schema.get_mut("properties").and_then(Value::as_object_mut) {
        keys.insert("seed".into(), seed());
        keys.insert("deed".into(), deeds());
    }
    if let (Some(known), Value::Object(more)) = (schema.get_mut("$defs").and_then(Value::as_object_mut), definitions_of_deeds()) {
        known.extend(more);
    }
    schema
}

fn seed() -> Value {
    json!({
        "description": "Seed of all random numbers.", "type": "integer", "minimum": 0, "maximum": u64::MAX, "default": DEFAULT_SEED,
    })
}

fn parameter(parameter: &Parameter) -> Value {
    let mut schema = match parameter.kind {
        Kind::Real { default, least, most } => json!({ "type": "number", "minimum": least, "maximum": most, "default": default }),
        Kind::Whole { default, least, most } => json!({ "type": "integer", "minimum": least, "maximum": most, "default": default }),
        Kind::Choice { default, .. } | Kind::Situation { default, .. } => {
            json!({ "enum": words_and_numbers(&parameter.words()), "default": default })
        }
        Kind::Flag { default } => json!({ "type": "boolean", "default": default }),
        Kind::List { default, least, most, longest } => json!({
            "type": "array", "items": { "type": "number", "minimum": least, "maximum": most }, "maxItems": longest, "default": default,
        }),
    };
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(" In {}.", parameter.unit) };
    schema["description"] = format!("{}{unit}", parameter.help).into();
    schema
}

/// A choice that looks like a whole number may be written as one.
fn words_and_numbers(options: &[&str]) -> Vec<Value> {
    let number = |word: &str| word.parse::<u64>().ok().map(Value::from);
    options.iter().flat_map(|&word| [Some(word.into()), number(word)]).flatten().collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)] // a test that cannot go on has failed

    use super::*;
    use crate::example::REGISTRY;

    #[test]
    fn a_parameter_keeps_its_range_default_and_unit() {
        let schema = experiment(REGISTRY[0]);
        let frequency = &schema["properties"]["parameters"]["properties"]["frequency"];
        assert_eq!(frequency["maximum"], 10.0);
        assert_eq!(frequency["default"], 1.0);
        assert_eq!(frequency["description"], "Turns a second. In 1/s.");
        assert_eq!(schema["properties"]["parameters"]["properties"]["start"]["enum"], json!(["middle", "side"]));
    }

    /// What the reader knows of a system, the schema knows, and nothing else.
    #[test]
    fn systems_of_ones_own_are_closed_and_documented() {
        let schema = free();
        assert_eq!(schema["additionalProperties"], false);
        assert_eq!(schema["properties"]["box"]["$ref"], "#/$defs/Room");
        assert!(schema["properties"]["duration"]["description"].as_str().unwrap().contains("Physical time"));
        assert_eq!(schema["$defs"]["Room"]["additionalProperties"], false);
        let all = all(REGISTRY);
        assert_eq!(all["oneOf"].as_array().unwrap().len(), 2);
        assert!(all["$defs"]["Room"].is_object() && all["oneOf"][1].get("$defs").is_none());
    }
}
