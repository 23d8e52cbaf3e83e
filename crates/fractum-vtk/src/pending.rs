//! A file that is neither compressed nor written yet.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use crate::compress::Compression;
use crate::document::Document;

/// A file of which everything is known, but which is neither compressed nor written yet.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PendingFile(Content);

#[derive(Clone, Debug, Serialize, Deserialize)]
enum Content {
    Document(Document<'static>, Compression),
    Text(String),
}

impl PendingFile {
    pub(super) fn of_document(document: Document<'_>, compression: Compression) -> Self {
        PendingFile(Content::Document(document.into_owned(), compression))
    }

    /// A file of text.
    pub fn of_text(text: String) -> Self {
        PendingFile(Content::Text(text))
    }

    /// The bytes of the file.
    pub fn bytes(&self) -> Cow<'_, [u8]> {
        match &self.0 {
            Content::Document(document, compression) => document.to_bytes(*compression).into(),
            Content::Text(text) => text.as_bytes().into(),
        }
    }

    /// Bytes that it occupies until it is written.
    pub fn size(&self) -> usize {
        match &self.0 {
            Content::Document(document, _) => document.size(),
            Content::Text(text) => text.len(),
        }
    }
}
