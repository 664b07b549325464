//! Options as JavaScript gives them: plain objects, named as in the library but in camel case.

use fieldtrace::Options;
use fieldtrace::options::Preset;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use wasm_bindgen::JsError;

/// The options of a trace, over those of a preset where one is named.
pub fn trace_options(json: &str) -> Result<Options, JsError> {
    let mut given = members(json)?;
    let preset = match given.remove("preset") {
        None => Options::default(),
        Some(name) => Options::preset(match name.as_str() {
            Some("sketch") => Preset::Sketch,
            Some("plan") => Preset::Plan,
            Some("icon") => Preset::Icon,
            _ => return Err(JsError::new(&format!("preset: {name} is none of sketch, plan, icon"))),
        }),
    };
    over(&preset, given)
}

/// Other options, over their defaults.
pub fn options<T: Default + Serialize + DeserializeOwned>(json: &str) -> Result<T, JsError> {
    over(&T::default(), members(json)?)
}

fn members(json: &str) -> Result<Map<String, Value>, JsError> {
    serde_json::from_str(json).map_err(|e| JsError::new(&format!("options: {e}")))
}

/// Some options with others in their place. What is null is as if not given.
fn over<T: Serialize + DeserializeOwned>(base: &T, given: Map<String, Value>) -> Result<T, JsError> {
    let mut all = serde_json::to_value(base).map_err(|e| JsError::new(&e.to_string()))?;
    for (name, value) in given.into_iter().filter(|(_, value)| !value.is_null()) {
        let Some(place) = all.get_mut(kebab(&name)) else {
            return Err(JsError::new(&format!("{name}: there is no such option")));
        };
        let old = std::mem::replace(place, value);
        // One at a time, so that the message names the option.
        if let Err(reason) = serde_json::from_value::<T>(all.clone()) {
            return Err(JsError::new(&format!("{name}: {reason}, where {old} is usual")));
        }
    }
    serde_json::from_value(all).map_err(|e| JsError::new(&e.to_string()))
}

/// `maxWidth` as `max-width`.
fn kebab(name: &str) -> String {
    let letter = |c: char| if c.is_uppercase() { format!("-{}", c.to_lowercase()) } else { c.into() };
    name.chars().map(letter).collect()
}
