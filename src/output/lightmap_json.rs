//! Where faces lie on a lightmap, as JSON: for pipelines that bring the lightmap to a scene of their own.

use std::io::{self, Write};

use serde_json::{Value, json};

use super::{Provenance, Quantity};
use crate::bake::Lightmap;
use crate::scene::Scene;

/// Writes pages, and for each face its number in the input from 1, the names of object, group and material, chart and page, its vertices in metres, and their coordinates on the page: parts of its width
/// and height from the top left.
///
/// # Errors
/// What the writer says.
pub fn write_lightmap_json(
    writer: &mut dyn Write,
    scene: &Scene,
    lightmap: &Lightmap,
    quantity: Quantity,
    provenance: &Provenance,
) -> io::Result<()> {
    let statements: serde_json::Map<String, Value> =
        provenance.statements(quantity).into_iter().map(|(key, text)| (key.to_owned(), json!(text))).collect();
    let atlas = &lightmap.atlas;
    let mut head = Value::Object(statements);
    head["texel"] = json!(atlas.options().texel);
    head["padding"] = json!(atlas.options().padding);
    head["pages"] = atlas.pages().iter().map(|[width, height]| json!({ "width": width, "height": height })).collect();
    head["charts"] = json!(atlas.charts());
    head["report"] = json!(lightmap.report);

    // A face a line, so that large files can be read line by line.
    let head = head.to_string();
    writeln!(writer, "{},\"faces\":[", &head[..head.len() - 1])?;
    let mut separator = "";
    for face in atlas.faces(scene) {
        let surface = &scene.surfaces()[face.surface as usize];
        let line = json!({
            "face": u64::from(surface.face) + 1, "surface": face.surface, "object": scene.objects().name_of(surface.face),
            "group": scene.groups().name_of(surface.face),
            "material": scene.materials()[surface.material as usize].name, "chart": face.chart, "page": face.page,
            "vertices": face.vertices, "uv": face.uv,
        });
        write!(writer, "{separator}{line}")?;
        separator = ",\n";
    }
    writeln!(writer, "\n]}}")
}
