//! Numbers of vertices: accessors over buffers, of any type of component, sparse ones too (glTF 2.0 Specification, section 3.6.2).
//!
//! What an accessor takes of memory is bounded by the bytes that it reads.

use super::buffers::Buffers;
use super::json::{Accessor, Root, SparsePart};

/// Sparse accessors that stand on no bytes, but on zeros, have no more items than this, which take 24 MiB.
const MOST_ZEROS: usize = 1 << 20;

/// Reads accessors of a file.
pub(super) struct Accessors<'a> {
    pub root: &'a Root,
    pub buffers: Buffers<'a>,
}

/// A type of component, by its number in OpenGL.
#[derive(Clone, Copy, PartialEq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(number: u32) -> Option<Self> {
        Some(match number {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The number that stands at the start of `bytes`, of which there are enough; normalised ones are fractions of the largest (section 3.11).
    fn number(self, bytes: &[u8], normalized: bool) -> f64 {
        let (value, largest) = match self {
            Self::I8 => (f64::from(bytes[0] as i8), 127.0),
            Self::U8 => (f64::from(bytes[0]), 255.0),
            Self::I16 => (f64::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0),
            Self::U16 => (f64::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0),
            Self::U32 => (f64::from(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])), 4294967295.0),
            Self::F32 => return f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
        };
        if normalized { (value / largest).max(-1.0) } else { value }
    }
}

/// Numbers in a row of bytes.
struct Layout<'b> {
    bytes: &'b [u8],
    component: Component,
    /// From one item to the next.
    stride: usize,
    normalized: bool,
}

impl Layout<'_> {
    fn item<const N: usize>(&self, item: usize) -> [f64; N] {
        let start = item * self.stride;
        std::array::from_fn(|k| self.component.number(&self.bytes[start + k * self.component.bytes()..], self.normalized))
    }
}

impl Accessors<'_> {
    /// The vectors of an accessor: the first `N` components of each.
    pub fn vectors<const N: usize>(&self, number: usize) -> Result<Vec<[f64; N]>, String> {
        let accessor = self.accessor(number)?;
        let components = match accessor.kind.as_str() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 0,
        };
        if components < N {
            return Err(format!(
                "accessor {number} has the type '{}', where vectors of {N} are needed",
                super::container::shown(&accessor.kind)
            ));
        }
        let mut vectors = match (accessor.buffer_view, &accessor.sparse) {
            (None, Some(_)) if accessor.count <= MOST_ZEROS => vec![[0.0; N]; accessor.count],
            _ => {
                let layout = self.layout(number, accessor, components)?;
                (0..accessor.count).map(|item| layout.item(item)).collect()
            }
        };
        self.replace(number, accessor, &mut vectors, components)?;
        Ok(vectors)
    }

    /// The whole numbers of an accessor.
    pub fn indices(&self, number: usize) -> Result<Vec<u32>, String> {
        let accessor = self.accessor(number)?;
        if Component::of(accessor.component_type) == Some(Component::F32) || accessor.kind != "SCALAR" {
            return Err(format!("accessor {number} has no whole numbers, but is used for indices"));
        }
        Ok(self.vectors::<1>(number)?.into_iter().map(|[index]| index as u32).collect())
    }

    fn accessor(&self, number: usize) -> Result<&Accessor, String> {
        let all = &self.root.accessors;
        all.get(number).ok_or_else(|| format!("accessor {number} does not exist: there are {}, numbered from 0", all.len()))
    }

    fn component(&self, number: usize, accessor: &Accessor) -> Result<Component, String> {
        let unknown = || format!("accessor {number} has the unknown componentType {}", accessor.component_type);
        Component::of(accessor.component_type).ok_or_else(unknown)
    }

    /// Where the items of an accessor stand: all of them within its buffer view.
    fn layout(&self, number: usize, accessor: &Accessor, components: usize) -> Result<Layout<'_>, String> {
        let component = self.component(number, accessor)?;
        let view = accessor.buffer_view.ok_or_else(|| format!("accessor {number} has no bufferView, so no data"))?;
        let (bytes, stride) = self.buffers.view(view)?;
        let size = components * component.bytes();
        let stride = stride.unwrap_or(size);
        if stride < size {
            return Err(format!("bufferView {view} has a byteStride of {stride}, but items of {size} bytes"));
        }
        let last = accessor.count.checked_sub(1).and_then(|last| last.checked_mul(stride));
        let end = last.and_then(|last| last.checked_add(size)?.checked_add(accessor.byte_offset));
        if accessor.count > 0 && end.is_none_or(|end| end > bytes.len()) {
            return Err(format!(
                "accessor {number} has {} items of {size} bytes, more than the {} bytes of bufferView {view} hold",
                accessor.count,
                bytes.len()
            ));
        }
        let bytes = bytes.get(accessor.byte_offset..).unwrap_or_default();
        Ok(Layout { bytes, component, stride, normalized: accessor.normalized })
    }

    /// Puts the items of a sparse accessor in their places.
    fn replace<const N: usize>(
        &self,
        number: usize,
        accessor: &Accessor,
        vectors: &mut [[f64; N]],
        components: usize,
    ) -> Result<(), String> {
        let Some(sparse) = &accessor.sparse else { return Ok(()) };
        let part = |part: &SparsePart, component: Component, components: usize| {
            let (bytes, _) = self.buffers.view(part.buffer_view)?;
            let stride = components * component.bytes();
            let fits = sparse.count.checked_mul(stride).and_then(|size| size.checked_add(part.byte_offset));
            if fits.is_none_or(|end| end > bytes.len()) {
                return Err(format!("accessor {number} has more sparse items than bufferView {} holds", part.buffer_view));
            }
            Ok(Layout { bytes: &bytes[part.byte_offset..], component, stride, normalized: accessor.normalized })
        };
        let component = sparse.indices.component_type.and_then(Component::of).filter(|&component| component != Component::F32);
        let component = component.ok_or_else(|| format!("accessor {number} has sparse indices of an unknown componentType"))?;
        let places = Layout { normalized: false, ..part(&sparse.indices, component, 1)? };
        let values = part(&sparse.values, self.component(number, accessor)?, components)?;
        for item in 0..sparse.count {
            let [place] = places.item::<1>(item);
            let count = vectors.len();
            let vector = vectors
                .get_mut(place as usize)
                .ok_or_else(|| format!("accessor {number} has {count} items, but a sparse one for item {place}"))?;
            *vector = values.item(item);
        }
        Ok(())
    }
}
