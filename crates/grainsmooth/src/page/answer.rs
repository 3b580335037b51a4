//! What the server says to a request.

use hyper::StatusCode;
use serde::Serialize;

/// An answer, before what all answers carry.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Answer {
    pub(super) status: StatusCode,
    /// The media type.
    pub(super) kind: &'static str,
    pub(super) body: Vec<u8>,
    /// The cookie that it sets.
    pub(super) cookie: Option<String>,
}

/// Why a request is refused, as JSON tells it.
#[derive(Serialize)]
struct Refused<'a> {
    refused: &'a str,
}

impl Answer {
    /// Bytes of a media type.
    pub(super) fn new(kind: &'static str, body: impl Into<Vec<u8>>) -> Self {
        Self { status: StatusCode::OK, kind, body: body.into(), cookie: None }
    }

    /// Numbers and arrays, as `Packed` has them.
    pub(super) fn packed(body: Vec<u8>) -> Self {
        Self::new("application/octet-stream", body)
    }

    /// JSON.
    pub(super) fn json(content: &impl Serialize) -> Self {
        match serde_json::to_vec(content) {
            Ok(body) => Self::new("application/json", body),
            Err(error) => Self::refused(StatusCode::INTERNAL_SERVER_ERROR, &error.to_string()),
        }
    }

    /// A refusal with its reason, which the page shows.
    pub(super) fn refused(status: StatusCode, why: &str) -> Self {
        let body = serde_json::to_vec(&Refused { refused: why }).unwrap_or_default();
        Self { status, ..Self::new("application/json", body) }
    }
}
