//! Base64 (RFC 4648, section 4).

use std::io::{self, Write};

const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Writes bytes as base64, with padding.
pub(super) fn write_base64(writer: &mut impl Write, bytes: &[u8]) -> io::Result<()> {
    let letters = |chunk: &[u8]| {
        let at = |index: usize| u32::from(chunk.get(index).copied().unwrap_or(0));
        let bits = at(0) << 16 | at(1) << 8 | at(2);
        let mut letters = [18, 12, 6, 0].map(|shift| LETTERS[(bits >> shift & 63) as usize]);
        letters[chunk.len() + 1..].fill(b'=');
        letters
    };
    // Many at once: a writer need not be buffered.
    const AT_ONCE: usize = 3 << 12;
    bytes.chunks(AT_ONCE).try_for_each(|bytes| writer.write_all(&bytes.chunks(3).flat_map(letters).collect::<Vec<u8>>()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test vectors of RFC 4648, section 10.
    #[test]
    fn it_is_that_of_the_rfc() {
        let of = |text: &str| {
            let mut written = Vec::new();
            write_base64(&mut written, text.as_bytes()).unwrap();
            String::from_utf8(written).unwrap()
        };
        let found = ["", "f", "fo", "foo", "foob", "fooba", "foobar"].map(of);
        assert_eq!(found, ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"]);
        assert!(of(&"x".repeat(100_000)).len() == 133_336 && !of(&"x".repeat(100_000))[..133_330].contains('='));
    }
}
