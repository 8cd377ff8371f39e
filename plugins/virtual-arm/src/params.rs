//! `[driver] params` of an object file.

use pubs_plugin::PluginError;
use serde::Deserialize;
use serde_json::Value;

use crate::trouble::Trouble;
use crate::world::{World, WorldError};

/// JSON Schema of [`Params`].
pub(crate) const SCHEMA: &str = r#"{
  "type": "object",
  "additionalProperties": false,
  "required": ["world"],
  "properties": {
    "world": { "type": "string", "pattern": "^(door1|door2|drawer1|drawer2|fridge|.*[.]toml)$", "description": "what is true of the object: a built-in world (door1, door2, drawer1, drawer2, fridge) or the path of a world file (.toml); relative paths begin where the program is started" },
    "start": { "type": "number", "minimum": 0, "maximum": 1, "description": "joint state at first, as a fraction of the range; drawn from the seed where left out" },
    "friction_scale": { "type": "number", "minimum": 0, "maximum": 10, "description": "dry and viscous friction times this" },
    "catch_scale": { "type": "number", "minimum": 0, "maximum": 10, "description": "force of catch and seal times this" },
    "sensor_offset_n": { "type": "array", "items": { "type": "number", "minimum": -100, "maximum": 100 }, "minItems": 3, "maxItems": 3, "description": "what the force sensor has drifted by since the object was calibrated, tool axes, N; a tare does not see it" },
    "trouble": {
      "type": "object",
      "additionalProperties": false,
      "description": "what befalls object and grasp; times count from the first command, s",
      "properties": {
        "slips_at_s": { "type": "number", "minimum": 0, "description": "the handle slips out of the fingers" },
        "jams_at_s": { "type": "number", "minimum": 0, "description": "the object gets stuck where it is" },
        "push": {
          "type": "object",
          "additionalProperties": false,
          "required": ["at_s", "for_s", "force_n"],
          "description": "somebody pulls the object by hand",
          "properties": {
            "at_s": { "type": "number", "minimum": 0 },
            "for_s": { "type": "number", "minimum": 0 },
            "force_n": { "type": "number", "minimum": -500, "maximum": 500, "description": "along the way of the handle, positive towards open" }
          }
        }
      }
    }
  }
}"#;

/// Greatest factor of a `_scale`.
const GREATEST_SCALE: f64 = 10.0;

/// Greatest component of the sensor's offset, N.
const GREATEST_OFFSET_N: f64 = 100.0;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Params {
    pub world: String,
    pub start: Option<f64>,
    #[serde(default = "one")]
    pub friction_scale: f64,
    #[serde(default = "one")]
    pub catch_scale: f64,
    #[serde(default)]
    pub sensor_offset_n: [f64; 3],
    #[serde(default)]
    pub trouble: Trouble,
}

fn one() -> f64 {
    1.0
}

impl Params {
    /// Reads the whole `[driver]` table.
    pub(crate) fn from_driver_table(table: &Value) -> Result<Self, PluginError> {
        let params = table
            .get("params")
            .cloned()
            .unwrap_or_else(|| serde_json::json!({}));
        let params: Self = serde_json::from_value(params)
            .map_err(|error| PluginError::new(format!("params: {error}")))?;
        params.in_range("start", params.start.unwrap_or(0.0), 1.0)?;
        params.in_range("friction_scale", params.friction_scale, GREATEST_SCALE)?;
        params.in_range("catch_scale", params.catch_scale, GREATEST_SCALE)?;
        for offset_n in params.sensor_offset_n {
            params.in_range("|sensor_offset_n|", offset_n.abs(), GREATEST_OFFSET_N)?;
        }
        Ok(params)
    }

    fn in_range(&self, name: &str, value: f64, greatest: f64) -> Result<(), PluginError> {
        if (0.0..=greatest).contains(&value) {
            return Ok(());
        }
        Err(PluginError::new(format!(
            "params: {name} = {value}, but it must lie in 0 to {greatest}"
        )))
    }

    /// The world, scaled.
    pub(crate) fn world(&self) -> Result<World, WorldError> {
        let mut world = World::load(&self.world)?;
        world.resistance.scale_friction(self.friction_scale);
        world.resistance.scale_catch(self.catch_scale);
        world.sensor.offset_n = self.sensor_offset_n.into();
        Ok(world)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_schema_knows_every_built_in_world() {
        let schema: Value = serde_json::from_str(SCHEMA).unwrap();
        let world = &schema["properties"]["world"];
        let names: Vec<&str> = World::built_in().collect();
        let pattern = format!("^({}|.*[.]toml)$", names.join("|"));
        assert_eq!(world["pattern"], pattern.as_str());
        let described = world["description"].as_str().unwrap();
        assert!(described.contains(&names.join(", ")), "{described}");
    }
}
