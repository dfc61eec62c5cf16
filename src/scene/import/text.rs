//! From a file to its text, and which files a scene may name.

use std::borrow::Cow;
use std::path::Path;

/// The bytes of a file; what is no regular file might never end. The error is what the system says.
pub(super) fn read_regular_file(path: &Path) -> Result<Vec<u8>, String> {
    let metadata = std::fs::metadata(path).map_err(|error| error.to_string())?;
    if metadata.is_dir() {
        return Err("it is a directory".to_owned());
    }
    if !metadata.is_file() {
        return Err("it is not a regular file".to_owned());
    }
    std::fs::read(path).map_err(|error| error.to_string())
}

/// Whether a file that a scene names lies in the folder of the scene or below it, wherever links lead. What does not exist lies nowhere else.
pub(super) fn lies_below(library: &Path, scene: &Path) -> bool {
    let folder = match scene.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    match (library.canonicalize(), folder.canonicalize()) {
        (Ok(library), Ok(folder)) => library.starts_with(folder),
        _ => !library.exists(),
    }
}

/// A file's bytes as text: UTF-8 with or without a byte order mark, else Latin-1. The flag says that it was not UTF-8.
pub(super) fn decode(bytes: &[u8]) -> (Cow<'_, str>, bool) {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    match std::str::from_utf8(bytes) {
        Ok(text) => (Cow::Borrowed(text), false),
        // Latin-1 maps every byte to the character of the same number, so different names stay different.
        Err(_) => (Cow::Owned(bytes.iter().map(|&byte| char::from(byte)).collect()), true),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_that_are_not_utf8_become_latin1() {
        assert_eq!(decode(b"\xef\xbb\xbfv 1"), (Cow::Borrowed("v 1"), false));
        assert_eq!(decode(b"usemtl W\xe4nde"), (Cow::Owned("usemtl W\u{e4}nde".to_owned()), true));
    }
}
