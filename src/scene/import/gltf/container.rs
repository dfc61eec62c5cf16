//! The two containers of glTF: JSON alone, or a GLB file of chunks (glTF 2.0 Specification, section 4.4).

use super::json::Root;

/// Extensions that a file may require: what they mean is read. Materials become diffuse whatever they are.
const UNDERSTOOD: [&str; 4] = ["KHR_mesh_quantization", "KHR_texture_transform", "EXT_mesh_gpu_instancing", "KHR_lights_punctual"];

/// The JSON of a file, and its binary chunk where it has one. The error says what is wrong.
pub(super) fn open(bytes: &[u8]) -> Result<(Root, Option<&[u8]>), String> {
    let (json, binary) = if bytes.starts_with(b"glTF") { chunks(bytes)? } else { (bytes, None) };
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    let root: Root = serde_json::from_slice(json).map_err(|error| format!("the JSON is no glTF 2.0: {error}"))?;
    if !root.asset.version.starts_with("2.") {
        return Err(format!("it is of glTF version '{}'; export it as glTF 2.0", shown(&root.asset.version)));
    }
    let is_known = |name: &&String| UNDERSTOOD.contains(&name.as_str()) || name.starts_with("KHR_materials_");
    if let Some(name) = root.extensions_required.iter().find(|name| !is_known(name)) {
        return Err(format!("it requires the extension {}, which is not supported; export it without", shown(name)));
    }
    Ok((root, binary))
}

/// The JSON chunk and the binary chunk behind it; further chunks are for extensions.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    let number = |at: usize| bytes.get(at..at + 4).map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]]));
    let (Some(version), Some(length)) = (number(4), number(8)) else {
        return Err("the file is cut off in its header; copy or export it again".to_owned());
    };
    if version != 2 {
        return Err(format!("it is GLB version {version}; export it as glTF 2.0"));
    }
    let length = length as usize;
    if length > bytes.len() {
        return Err(format!("the file is cut off: it should have {length} bytes and has {}; copy or export it again", bytes.len()));
    }

    let mut at = 12;
    let mut chunk = |kind: &[u8]| {
        let size = number(at).filter(|_| at + 8 <= length)? as usize;
        let body = (bytes[at + 4..at + 8] == *kind).then(|| bytes[..length].get(at + 8..(at + 8).saturating_add(size)))?;
        at = (at + 8).saturating_add(size);
        body
    };
    let json = chunk(b"JSON").ok_or("its first chunk is no JSON, or longer than the file; export it again")?;
    let has_more = 12 + 8 + json.len() < length;
    let binary = chunk(b"BIN\0");
    if has_more && binary.is_none() && number(20 + json.len() + 4) == Some(u32::from_le_bytes(*b"BIN\0")) {
        return Err("its binary chunk is longer than the file; copy or export it again".to_owned());
    }
    Ok((json, binary))
}

/// A name by somebody else, fit for a message.
pub(super) fn shown(name: &str) -> String {
    const MOST: usize = 64;
    name.chars().take(MOST).map(|c| if c.is_control() { '?' } else { c }).collect()
}
