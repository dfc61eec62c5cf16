//! The lit scene as XML PolyData of VTK (`.vtp`), as ParaView opens it: raw binary data behind the XML (VTK File Formats, XML formats).
//!
//! Points are `Float64`, in metres. A lit mesh has `radiosity` and `irradiance` as point data, elements as cell data, both by channel in W/m^2. Cells
//! of a lit mesh have `standard_error`, that of the radiosity, all channels together, in W/m^2, NaN where it is not known; elements, where bounds are
//! proved, `lower` and `upper` radiosity. Cells know their `surface`, `face` (both from 0, `face` of the input), `material`, `object` and `group` (-1 where
//! the input names none). Field data state software, quantity, unit, options, and the names of materials, objects and groups, a line for each.

use std::io::{self, Write};

use super::patches::Patches;
use super::{Provenance, Quantity, origin};

/// An array that is written behind the XML.
struct Array {
    name: &'static str,
    kind: &'static str,
    width: usize,
    bytes: Vec<u8>,
}

impl Array {
    fn floats(name: &'static str, width: usize, values: impl IntoIterator<Item = f32>) -> Self {
        Self { name, kind: "Float32", width, bytes: values.into_iter().flat_map(f32::to_le_bytes).collect() }
    }

    fn doubles(name: &'static str, width: usize, values: impl IntoIterator<Item = f64>) -> Self {
        Self { name, kind: "Float64", width, bytes: values.into_iter().flat_map(f64::to_le_bytes).collect() }
    }

    fn numbers(name: &'static str, values: impl IntoIterator<Item = i64>) -> Self {
        Self { name, kind: "Int64", width: 1, bytes: values.into_iter().flat_map(i64::to_le_bytes).collect() }
    }
}

/// Writes patches, with lower and upper radiosities by patch and channel where these are proved.
pub(super) fn write(
    writer: &mut impl Write,
    patches: &Patches<'_>,
    bounds: Option<[Vec<f32>; 2]>,
    provenance: &Provenance,
) -> io::Result<()> {
    let channels = patches.scene.channels();

    // What points and cells know.
    let light: Vec<(u32, u32)> = if patches.is_flat {
        patches.iter().map(|(surface, corners)| (corners[0], surface)).collect()
    } else {
        let mut surfaces = vec![0; patches.vertices.len()];
        patches.iter().for_each(|(surface, corners)| corners.iter().for_each(|&corner| surfaces[corner as usize] = surface));
        (0..).zip(surfaces).collect()
    };
    let values = vec![
        Array::floats("radiosity", channels, light.iter().flat_map(|&(vertex, _)| patches.radiosity_at(vertex).to_vec())),
        Array::floats("irradiance", channels, light.iter().flat_map(|&(vertex, surface)| patches.irradiance_at(vertex, surface))),
    ];
    let mut of_cells = vec![Array::numbers("surface", patches.iter().map(|(surface, _)| i64::from(surface)))];
    of_cells.extend((0..).zip(origin::NUMBERS).map(|(which, name): (usize, _)| {
        Array::numbers(name, patches.iter().map(|(surface, _)| origin::of_surface(patches.scene, surface)[which]))
    }));
    if !patches.standard_errors.is_empty() {
        of_cells.push(Array::floats("standard_error", 1, patches.standard_errors.iter().copied()));
    }
    if let Some([lower, upper]) = bounds {
        of_cells.extend([Array::floats("lower", channels, lower), Array::floats("upper", channels, upper)]);
    }
    let of_points = if patches.is_flat {
        of_cells.splice(0..0, values);
        Vec::new()
    } else {
        values
    };

    let points = vec![Array::doubles("Points", 3, patches.vertices.iter().flatten().copied())];
    let polygons = vec![
        Array::numbers("connectivity", patches.corners.iter().map(|&corner| i64::from(corner))),
        Array::numbers("offsets", patches.ends.iter().map(|&(end, _)| end as i64)),
    ];
    let groups = [("PointData", of_points), ("CellData", of_cells), ("Points", points), ("Polys", polygons)];
    let counts = (patches.vertices.len(), patches.ends.len());
    write_file(writer, counts, &groups, &statements(patches, provenance))
}

/// What the field data state.
fn statements(patches: &Patches<'_>, provenance: &Provenance) -> Vec<(&'static str, String)> {
    let mut statements = provenance.statements(Quantity::Radiosity);
    statements.extend(origin::names(patches.scene).map(|(list, names)| (list, names.join("\n"))));
    statements
}

/// Writes the XML, which tells where each array starts, and the arrays behind it, each after its length.
fn write_file(
    writer: &mut impl Write,
    (points, cells): (usize, usize),
    groups: &[(&str, Vec<Array>)],
    statements: &[(&str, String)],
) -> io::Result<()> {
    writeln!(writer, "<?xml version=\"1.0\"?>")?;
    writeln!(writer, "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>")?;
    writeln!(writer, "<FieldData>")?;
    for (name, text) in statements {
        // Texts are lists of their bytes, each ended by a 0.
        write!(writer, "<Array type=\"String\" Name=\"{name}\" NumberOfTuples=\"1\" format=\"ascii\">")?;
        text.bytes().filter(|&byte| byte != 0).try_for_each(|byte| write!(writer, "{byte} "))?;
        writeln!(writer, "0</Array>")?;
    }
    writeln!(writer, "</FieldData>")?;
    writeln!(
        writer,
        "<Piece NumberOfPoints=\"{points}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{cells}\">"
    )?;
    let mut offset = 0_u64;
    for (group, arrays) in groups {
        writeln!(writer, "<{group}>")?;
        for Array { name, kind, width, bytes } in arrays {
            let place = format!("NumberOfComponents=\"{width}\" format=\"appended\" offset=\"{offset}\"");
            writeln!(writer, "<DataArray type=\"{kind}\" Name=\"{name}\" {place}/>")?;
            offset += (size_of::<u64>() + bytes.len()) as u64;
        }
        writeln!(writer, "</{group}>")?;
    }
    writeln!(writer, "</Piece>\n</PolyData>")?;

    write!(writer, "<AppendedData encoding=\"raw\">\n_")?;
    for array in groups.iter().flat_map(|(_, arrays)| arrays) {
        writer.write_all(&(array.bytes.len() as u64).to_le_bytes())?;
        writer.write_all(&array.bytes)?;
    }
    writeln!(writer, "\n</AppendedData>\n</VTKFile>")
}
