//! Reading a plugin's own parameters.

use serde_json::Value;

use crate::PluginError;

/// A number of a `params` table, or its default where the object file leaves it out.
///
/// # Errors
/// Where it is there and no number.
pub fn number_or(params: &Value, name: &str, default: f32) -> Result<f32, PluginError> {
    match &params[name] {
        Value::Null => Ok(default),
        value => match value.as_f64() {
            Some(number) => Ok(number as f32),
            None => Err(PluginError::new(format!(
                "params: {name} = {value}, which is not a number"
            ))),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_out_has_its_default_and_what_is_no_number_is_named() {
        let params = serde_json::json!({ "light": 3.5, "floor": "low" });
        assert_eq!(number_or(&params, "light", 10.0), Ok(3.5));
        assert_eq!(number_or(&params, "slope", 1.0), Ok(1.0));
        assert_eq!(number_or(&Value::Null, "slope", 1.0), Ok(1.0));
        let fault = number_or(&params, "floor", 0.0).map_err(|error| error.to_string());
        let said = "params: floor = \"low\", which is not a number".to_owned();
        assert_eq!(fault, Err(said));
    }
}
