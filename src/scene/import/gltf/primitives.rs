//! Triangles of a mesh primitive (glTF 2.0 Specification, section 3.7.2).

use glam::DVec3;

use super::accessors::Accessors;
use super::json::{Primitive, Root};

/// The triangles of a primitive, in its own frame.
pub(super) struct Triangles {
    pub positions: Vec<DVec3>,
    /// Indices of positions, counter-clockwise from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Linear colours by vertex, where it has them.
    pub colours: Option<Vec<[f64; 3]>>,
    /// Coordinates for lightmaps by vertex, where it has them and they are kept.
    pub uv: Option<Vec<[f64; 2]>>,
}

/// What a primitive consists of.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Shape {
    Triangles,
    Strip,
    Fan,
    /// Points and lines, which reflect nothing.
    Nothing,
}

impl Shape {
    pub fn of(primitive: &Primitive) -> Result<Self, String> {
        match primitive.mode {
            0..=3 => Ok(Self::Nothing),
            4 => Ok(Self::Triangles),
            5 => Ok(Self::Strip),
            6 => Ok(Self::Fan),
            other => Err(format!("mode {other} is none of points, lines and triangles")),
        }
    }
}

/// The accessor of an attribute.
pub(super) fn attribute(primitive: &Primitive, name: &str) -> Result<Option<usize>, String> {
    let of_json = |value: &serde_json::Value| value.as_u64().and_then(|number| usize::try_from(number).ok());
    match primitive.attributes.get(name) {
        None => Ok(None),
        Some(value) => of_json(value).map(Some).ok_or_else(|| format!("its {name} is {value}, which is no accessor")),
    }
}

/// How many triangles a primitive has at most, by what it says of its accessors: no more are read.
pub(super) fn count(primitive: &Primitive, root: &Root) -> usize {
    let positions = attribute(primitive, "POSITION").ok().flatten();
    let count = primitive.indices.or(positions).and_then(|number| root.accessors.get(number)).map_or(0, |accessor| accessor.count);
    match Shape::of(primitive) {
        Ok(Shape::Triangles) => count / 3,
        Ok(Shape::Strip | Shape::Fan) => count,
        Ok(Shape::Nothing) | Err(_) => 0,
    }
}

/// Reads the triangles of a primitive of a shape.
pub(super) fn read(primitive: &Primitive, shape: Shape, keep_uv: bool, accessors: &Accessors<'_>) -> Result<Triangles, String> {
    let positions = attribute(primitive, "POSITION")?.ok_or("it has no POSITION")?;
    let positions: Vec<DVec3> = accessors.vectors::<3>(positions)?.into_iter().map(DVec3::from).collect();
    let count = u32::try_from(positions.len()).map_err(|_| "it has more than 2^32 vertices")?;
    let indices = match primitive.indices {
        Some(indices) => accessors.indices(indices)?,
        None => (0..count).collect(),
    };
    if let Some(bad) = indices.iter().find(|&&index| index >= count) {
        return Err(format!("it has an index {bad}, but {count} vertices, numbered from 0"));
    }
    let colours = match attribute(primitive, "COLOR_0")? {
        Some(colours) => Some(accessors.vectors::<3>(colours)?),
        None => None,
    };
    if colours.as_ref().is_some_and(|colours| colours.len() != positions.len()) {
        return Err("it has more or fewer colours than vertices".to_owned());
    }
    let uv = match attribute(primitive, "TEXCOORD_1")?.filter(|_| keep_uv) {
        Some(uv) => Some(accessors.vectors::<2>(uv)?),
        None => None,
    };
    if uv.as_ref().is_some_and(|uv| uv.len() != positions.len()) {
        return Err("it has more or fewer TEXCOORD_1 than vertices".to_owned());
    }
    Ok(Triangles { positions, triangles: triangles(&indices, shape), colours, uv })
}

/// The triangles that indices mean; every second one of a strip is turned. A strip goes on through triangles of two equal corners.
fn triangles(indices: &[u32], shape: Shape) -> Vec<[u32; 3]> {
    let all: Vec<[u32; 3]> = match shape {
        Shape::Nothing => return Vec::new(),
        Shape::Triangles => return indices.chunks_exact(3).map(|three| [three[0], three[1], three[2]]).collect(),
        Shape::Strip => {
            let turned = |(k, three): (usize, &[u32])| [three[0], three[1 + k % 2], three[2 - k % 2]];
            indices.windows(3).enumerate().map(turned).collect()
        }
        Shape::Fan => indices.windows(2).skip(1).map(|two| [two[0], two[1], indices[0]]).collect(),
    };
    all.into_iter().filter(|[a, b, c]| a != b && b != c && c != a).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_winding() {
        assert_eq!(triangles(&[0, 1, 2, 3, 4], Shape::Strip), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(triangles(&[0, 1, 2, 3], Shape::Fan), [[1, 2, 0], [2, 3, 0]]);
        assert_eq!(triangles(&[0, 1, 2, 2, 3, 4], Shape::Strip), [[0, 1, 2], [2, 4, 3]]);
        assert_eq!(triangles(&[0, 1, 2, 3], Shape::Triangles), [[0, 1, 2]]);
        assert_eq!(triangles(&[0, 1], Shape::Strip), Vec::<[u32; 3]>::new());
    }
}
