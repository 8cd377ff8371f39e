//! The three sums that make a damaged file known.

use std::collections::BTreeMap;

use crate::contract::{PREFIX, check_version};
use crate::hash::sha256_hex;
use crate::onnx::{self, Model};
use crate::{Contract, Fault, Network};

/// Over the weights: what `doctor` and logs name a policy by.
const WEIGHTS: &str = "pubs.sha256";
/// Over every byte but the metadata.
const MODEL: &str = "pubs.model_sha256";
/// Over the metadata of ours, this entry left out.
const CONTRACT: &str = "pubs.contract_sha256";

/// The bytes of a policy file. `network` and `contract` must have passed their checks.
pub fn encode(network: &Network, contract: &Contract) -> Result<Vec<u8>, String> {
    let mut bytes = onnx::write::model(network);
    let model = Model::read(&bytes)?;
    let mut entries = contract.to_metadata()?;
    entries.insert(WEIGHTS.into(), json_text(&model.weights_sha256));
    entries.insert(MODEL.into(), json_text(&model.model_sha256));
    entries.insert(CONTRACT.into(), json_text(&contract_sum(&entries)));
    bytes.extend(onnx::write::metadata(&entries));
    Ok(bytes)
}

/// Reads the contract, after checking that nothing in the file has changed since it was written.
pub fn open(model: &Model) -> Result<Contract, Fault> {
    let ours = model
        .metadata
        .iter()
        .filter(|(key, _)| key.starts_with(PREFIX));
    let mut entries: BTreeMap<&str, &str> = ours
        .map(|(key, value)| (&key[PREFIX.len()..], value.as_str()))
        .collect();
    check_version(&entries)?;
    let sums = [
        ("weights", WEIGHTS, &model.weights_sha256),
        ("network", MODEL, &model.model_sha256),
        ("contract", CONTRACT, &contract_sum(&model.metadata)),
    ];
    for (part, key, found) in sums {
        let stated = entries
            .remove(&key[PREFIX.len()..])
            .ok_or(Fault::NoSum { key })?;
        if stated != json_text(found) {
            return Err(Fault::Sum {
                part,
                stated: start_of(stated.trim_matches('"')),
                found: start_of(found),
            });
        }
    }
    Contract::from_metadata(&entries)
}

fn contract_sum(entries: &BTreeMap<String, String>) -> String {
    let ours = entries
        .iter()
        .filter(|(key, _)| key.starts_with(PREFIX) && *key != CONTRACT);
    // Lengths keep a value from running into the next key.
    let text: String = ours
        .map(|(key, value)| format!("{} {key} {} {value}\n", key.len(), value.len()))
        .collect();
    sha256_hex(text)
}

fn json_text(sum: &str) -> String {
    format!("\"{sum}\"")
}

/// Enough of a sum to tell two apart.
fn start_of(sum: &str) -> String {
    let start: String = sum.chars().take(12).collect();
    format!("{start}…")
}
