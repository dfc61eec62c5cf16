//! The header of a PLY file: which elements follow, with which properties.

/// How values are written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Format {
    Text,
    LittleEndian,
    BigEndian,
}

/// The type of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// A property of an element.
#[derive(Debug)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
    /// The type of its length, if it is a list.
    pub list: Option<Kind>,
}

/// Items of one kind.
#[derive(Debug)]
pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

/// What a file says about itself.
#[derive(Debug)]
pub(super) struct Header {
    pub format: Format,
    pub elements: Vec<Element>,
}

impl Kind {
    fn of(name: &str) -> Result<Self, String> {
        Ok(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return Err(format!("its header names an unknown type '{name}'")),
        })
    }

    pub fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The number that [`Kind::bytes`] bytes are.
    pub fn number(self, bytes: &[u8], is_big_endian: bool) -> f64 {
        let mut raw = [0; 8];
        raw[..bytes.len()].copy_from_slice(bytes);
        if is_big_endian {
            raw[..bytes.len()].reverse();
        }
        let whole = u64::from_le_bytes(raw);
        match self {
            Self::I8 => f64::from(whole as i8),
            Self::U8 => f64::from(whole as u8),
            Self::I16 => f64::from(whole as i16),
            Self::U16 => f64::from(whole as u16),
            Self::I32 => f64::from(whole as i32),
            Self::U32 => f64::from(whole as u32),
            Self::F32 => f64::from(f32::from_bits(whole as u32)),
            Self::F64 => f64::from_bits(whole),
        }
    }
}

impl Header {
    /// The header, and what stands behind it.
    pub fn read(bytes: &[u8]) -> Result<(Self, &[u8]), String> {
        if !bytes.starts_with(b"ply") {
            return Err("it is no PLY file: it does not start with 'ply'".to_owned());
        }
        let (mut format, mut elements, mut rest): (_, Vec<Element>, _) = (None, Vec::new(), bytes);
        loop {
            let end = rest.iter().position(|&byte| byte == b'\n').ok_or("its header does not end in 'end_header'")?;
            let line = String::from_utf8_lossy(&rest[..end]).into_owned();
            rest = &rest[end + 1..];
            let words: Vec<&str> = line.split_whitespace().collect();
            match words[..] {
                ["end_header"] => break,
                ["format", "ascii", ..] => format = Some(Format::Text),
                ["format", "binary_little_endian", ..] => format = Some(Format::LittleEndian),
                ["format", "binary_big_endian", ..] => format = Some(Format::BigEndian),
                ["element", name, count] => {
                    let count = count.parse().map_err(|_| format!("its header has '{count}' items of '{name}'"))?;
                    elements.push(Element { name: name.to_owned(), count, properties: Vec::new() });
                }
                ["property", "list", length, kind, name] => {
                    let property = Property { name: name.to_owned(), kind: Kind::of(kind)?, list: Some(Kind::of(length)?) };
                    elements.last_mut().ok_or("its header has a property of no element")?.properties.push(property);
                }
                ["property", kind, name] => {
                    let property = Property { name: name.to_owned(), kind: Kind::of(kind)?, list: None };
                    elements.last_mut().ok_or("its header has a property of no element")?.properties.push(property);
                }
                _ => {}
            }
        }
        // An element without properties takes no bytes, and could have any number of items.
        elements.retain(|element| !element.properties.is_empty());
        Ok((Self { format: format.ok_or("its header names no format")?, elements }, rest))
    }
}
