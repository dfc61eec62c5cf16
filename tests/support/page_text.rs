//! What the elements of a page hold (`output/page/mod.rs` has the format).

use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;

/// The text of the element with this id.
pub fn text_of<'a>(page: &'a str, id: &str) -> &'a str {
    let start = page.find(&format!("id=\"{id}\">")).unwrap() + id.len() + 6;
    &page[start..start + page[start..].find("</script>").unwrap()]
}

/// The array of the element with this id: numbers of four bytes.
pub fn array_of(page: &str, id: &str) -> Vec<[u8; 4]> {
    let deflated = STANDARD.decode(text_of(page, id)).unwrap();
    let mut bytes = Vec::new();
    ZlibDecoder::new(deflated.as_slice()).read_to_end(&mut bytes).unwrap();
    let (numbers, rest) = bytes.as_chunks();
    assert!(rest.is_empty(), "{id} has {} bytes", bytes.len());
    numbers.to_vec()
}
