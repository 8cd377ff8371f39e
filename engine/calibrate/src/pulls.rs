//! placeholder
#![allow(missing_docs)]
#[derive(Debug, Clone)]
pub struct Pull {
    pub label: String,
    pub angle_deg: Vec<f64>,
    pub force_n: Vec<f64>,
}
#[derive(Debug, Clone)]
pub struct Door {
    pub name: String,
    pub class: Option<String>,
    pub pulls: Vec<Pull>,
}
