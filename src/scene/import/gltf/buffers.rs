//! The bytes of a glTF file: its binary chunk, data URIs, and files beside it or below.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

use base64::Engine as _;
use base64::alphabet;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};

use super::super::text::{lies_below, read_regular_file};
use super::container::shown;
use super::json::Root;

/// Whether padding stands at the end is of no importance.
const BASE64: GeneralPurpose =
    GeneralPurpose::new(&alphabet::STANDARD, GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent));

/// Where other files are looked for.
pub(super) struct Place<'a> {
    /// The glTF file.
    pub file: &'a Path,
    /// Whether they may lie anywhere.
    pub allow_any_path: bool,
}

/// All buffers of a file.
pub(super) struct Buffers<'a> {
    root: &'a Root,
    /// By buffer, into `bytes`: buffers of one URI are one.
    slots: Vec<usize>,
    bytes: Vec<Cow<'a, [u8]>>,
}

impl<'a> Buffers<'a> {
    /// Reads them; files that were read are added to `files`. The error says which one cannot be read.
    pub fn read(root: &'a Root, binary: Option<&'a [u8]>, place: &Place<'_>, files: &mut Vec<PathBuf>) -> Result<Self, String> {
        let (mut slots, mut bytes) = (Vec::new(), Vec::new());
        let mut by_uri: HashMap<Option<&str>, usize> = HashMap::new();
        for (number, buffer) in root.buffers.iter().enumerate() {
            let uri = buffer.uri.as_deref();
            let slot = match by_uri.get(&uri) {
                Some(&slot) => slot,
                None => {
                    let of_buffer = match uri {
                        Some(uri) => place.bytes_of(uri, files).map(Cow::Owned),
                        None if number > 0 => Err("it has no uri, which only the first buffer of a .glb may lack".to_owned()),
                        None => binary.map(Cow::Borrowed).ok_or_else(|| "the file has no binary chunk".to_owned()),
                    };
                    bytes.push(of_buffer.map_err(|reason| format!("buffer {number} cannot be read: {reason}"))?);
                    by_uri.insert(uri, bytes.len() - 1);
                    bytes.len() - 1
                }
            };
            let have = bytes[slot].len();
            if have < buffer.byte_length {
                return Err(format!(
                    "buffer {number} should have {} bytes and has {have}: it is cut off; copy or export it again",
                    buffer.byte_length
                ));
            }
            slots.push(slot);
        }
        Ok(Self { root, slots, bytes })
    }

    /// The bytes of a buffer view, and the distance of its items where that is given.
    pub fn view(&self, number: usize) -> Result<(&[u8], Option<usize>), String> {
        let view = self.root.buffer_views.get(number).ok_or_else(|| {
            format!("bufferView {number} does not exist: there are {}, numbered from 0", self.root.buffer_views.len())
        })?;
        let slot = self
            .slots
            .get(view.buffer)
            .ok_or_else(|| format!("bufferView {number} is of buffer {}, which does not exist", view.buffer))?;
        let buffer = &self.bytes[*slot];
        let end = view.byte_offset.checked_add(view.byte_length);
        let bytes = end.and_then(|end| buffer.get(view.byte_offset..end)).ok_or_else(|| {
            format!(
                "bufferView {number} has {} bytes from byte {} on, but buffer {} has {} in all",
                view.byte_length,
                view.byte_offset,
                view.buffer,
                buffer.len()
            )
        })?;
        Ok((bytes, view.byte_stride))
    }
}

impl Place<'_> {
    /// The bytes that a URI stands for: those of a data URI (RFC 2397), or of a file.
    pub fn bytes_of(&self, uri: &str, files: &mut Vec<PathBuf>) -> Result<Vec<u8>, String> {
        if let Some(data) = uri.strip_prefix("data:") {
            let (head, body) = data.split_once(',').ok_or("its data URI has no comma")?;
            let body: Vec<u8> = percent_encoding::percent_decode_str(body).collect();
            return match head.ends_with(";base64") {
                true => BASE64.decode(&body).map_err(|error| format!("its data URI is no base64: {error}")),
                false => Ok(body),
            };
        }
        if uri.contains("://") {
            return Err(format!("'{}' lies on no disk; put the file beside the scene", shown(uri)));
        }
        let name = percent_encoding::percent_decode_str(uri)
            .decode_utf8()
            .map_err(|_| format!("'{}' is no name of a file", shown(uri)))?;
        let path = self.file.parent().unwrap_or(Path::new("")).join(&*name);
        if !self.allow_any_path && !lies_below(&path, self.file) {
            let text = shown(&name);
            return Err(format!("{text} lies outside of the folder of the scene; allow that by --allow-any-path"));
        }
        let bytes =
            read_regular_file(&path).map_err(|reason| format!("{}: {reason}; put the file beside the scene", shown(&name)))?;
        files.push(path);
        Ok(bytes)
    }
}
