//! One stored tensor: checked, and hashed without copying it.

use sha2::{Digest, Sha256};

use super::number::{element, tensor};
use super::wire::Fields;

/// What is known of a tensor after reading it.
#[derive(Debug)]
pub struct Tensor<'a> {
    name: &'a str,
    dims: Vec<u64>,
    data_type: u64,
    /// Values as bytes, little-endian, where they are stored so.
    raw: Option<&'a [u8]>,
    /// Values stored as numbered fields instead, widened.
    listed: Vec<f64>,
}

impl<'a> Tensor<'a> {
    /// Reads a `TensorProto`.
    pub fn read(bytes: &'a [u8]) -> Result<Self, String> {
        let mut read = Self {
            name: "",
            dims: Vec::new(),
            data_type: 0,
            raw: None,
            listed: Vec::new(),
        };
        for field in Fields::new(bytes, "tensor") {
            let field = field?;
            match field.number {
                tensor::DIMS => field.numbers(&mut read.dims)?,
                tensor::DATA_TYPE => read.data_type = field.number()?,
                tensor::NAME => read.name = field.text()?,
                tensor::RAW_DATA if read.raw.is_some() => {
                    return Err("a tensor has two values".into());
                }
                tensor::RAW_DATA => read.raw = Some(field.bytes()?),
                tensor::FLOAT_DATA => {
                    read.list(field.bytes()?, |b: [u8; 4]| f32::from_le_bytes(b).into())?
                }
                tensor::DOUBLE_DATA => read.list(field.bytes()?, f64::from_le_bytes)?,
                tensor::DATA_LOCATION if field.number()? != 0 => return Err(read.elsewhere()),
                _ => {}
            }
        }
        read.check_length()?;
        Ok(read)
    }

    /// Adds name, shape, type and values to a running sum.
    pub fn hash(&self, hasher: &mut Sha256) {
        hasher.update((self.name.len() as u64).to_le_bytes());
        hasher.update(self.name);
        hasher.update((self.dims.len() as u64).to_le_bytes());
        self.dims
            .iter()
            .for_each(|size| hasher.update(size.to_le_bytes()));
        hasher.update(self.data_type.to_le_bytes());
        hasher.update(self.raw.unwrap_or_default());
        self.listed
            .iter()
            .for_each(|value| hasher.update(value.to_le_bytes()));
    }

    /// The first number that is NaN or infinite, with the tensor's name and its place.
    pub fn not_finite(&self) -> Option<String> {
        let raw = self.raw.unwrap_or_default();
        let (at, value) = match self.data_type {
            element::FLOAT => {
                first_not_finite(raw, |bytes: [u8; 4]| f32::from_le_bytes(bytes).into())
            }
            element::DOUBLE => first_not_finite(raw, f64::from_le_bytes),
            _ => None,
        }
        .or_else(|| {
            self.listed
                .iter()
                .copied()
                .enumerate()
                .find(|(_, value)| !value.is_finite())
        })?;
        Some(format!(
            "number {at} of its tensor {:?} is {value}",
            self.name
        ))
    }

    fn list<const N: usize>(
        &mut self,
        bytes: &[u8],
        value: impl Fn([u8; N]) -> f64,
    ) -> Result<(), String> {
        let (chunks, rest) = bytes.as_chunks::<N>();
        if !rest.is_empty() {
            return Err(format!(
                "tensor {:?} ends in the middle of a number",
                self.name
            ));
        }
        self.listed.extend(chunks.iter().map(|chunk| value(*chunk)));
        Ok(())
    }

    /// A runtime that trusts the shape reads beyond the values, so the two must agree.
    fn check_length(&self) -> Result<(), String> {
        let width = match self.data_type {
            element::FLOAT | element::INT32 => 4,
            element::DOUBLE | element::INT64 => 8,
            element::BOOL => 1,
            kind => {
                return Err(format!(
                    "tensor {:?} holds element type {kind}; use float32",
                    self.name
                ));
            }
        };
        let found = match (self.raw, self.data_type) {
            (Some(raw), _) if self.listed.is_empty() => raw.len() as u64,
            (None, element::FLOAT | element::DOUBLE) => self.listed.len() as u64 * width,
            // Whole numbers stored as fields are shapes and axes; their runtime counts them.
            (None, _) if self.listed.is_empty() => return Ok(()),
            _ => {
                return Err(format!(
                    "tensor {:?} has its values in two places",
                    self.name
                ));
            }
        };
        let wanted = self
            .dims
            .iter()
            .try_fold(width, |product, size| product.checked_mul(*size));
        if wanted == Some(found) {
            return Ok(());
        }
        Err(format!(
            "tensor {:?} of shape {:?} has {found} bytes of values",
            self.name, self.dims
        ))
    }

    fn elsewhere(&self) -> String {
        format!(
            "the values of tensor {:?} are in another file; export the model as one file",
            self.name
        )
    }
}

fn first_not_finite<const N: usize>(
    raw: &[u8],
    value: impl Fn([u8; N]) -> f64,
) -> Option<(usize, f64)> {
    let chunks = raw.as_chunks::<N>().0.iter();
    chunks
        .map(|chunk| value(*chunk))
        .enumerate()
        .find(|(_, value)| !value.is_finite())
}
