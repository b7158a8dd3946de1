//! Small payloads: postcard with nothing left over. Decoding is total.

use serde::Serialize;
use serde::de::DeserializeOwned;
use thiserror::Error;

/// Bytes that are not an artefact of the kind.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
#[error("not a valid artefact: {0}")]
pub struct DecodeError(String);

impl DecodeError {
    /// With the reason.
    pub fn new(reason: impl Into<String>) -> Self {
        Self(reason.into())
    }
}

/// The bytes of a value. Equal values give equal bytes; use no maps without an order, and no `usize`.
pub fn encode<T: Serialize>(value: &T) -> Vec<u8> {
    postcard::to_stdvec(value).expect("plain data always has a postcard form")
}

/// The value of these bytes, all of which must be used.
pub fn decode<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, DecodeError> {
    let (value, rest) = postcard::take_from_bytes(bytes).map_err(|e| DecodeError::new(e.to_string()))?;
    if rest.is_empty() { Ok(value) } else { Err(DecodeError::new("bytes are left over")) }
}
