//! Any bytes are read or refused, and no scene that comes of them is inconsistent.

use proptest::prelude::*;

use super::{Folder, ImportOptions, SQUARE, SceneSummary, Sides, read_scene};

/// Reads the two texts as a scene; whatever comes out must be consistent.
fn check(obj: &[u8], mtl: &[u8]) -> Result<(), TestCaseError> {
    let folder = Folder::with(&[("a.obj", obj), ("a.mtl", mtl)]);
    for sides in [Sides::Front, Sides::Both] {
        match read_scene(&folder.path("a.obj"), &ImportOptions { sides, ..ImportOptions::default() }) {
            Ok(imported) => {
                let scene = &imported.scene;
                for (index, surface) in scene.surfaces().iter().enumerate() {
                    prop_assert!((surface.face as usize) < imported.lines.len());
                    prop_assert!(surface.polygon.area() > 0.0 && surface.polygon.area().is_finite());
                    if let Some(twin) = surface.twin() {
                        prop_assert_eq!(scene.surface(twin).twin().map(|t| t.index()), Some(index));
                        prop_assert_eq!(scene.surface(twin).plane(), surface.plane());
                    }
                }
                prop_assert!(!SceneSummary::new(scene, &imported.diagnostics).to_string().is_empty());
            }
            Err(error) => prop_assert!(error.to_string().contains("a.obj") || error.to_string().contains("a.mtl"), "{}", error),
        }
    }
    Ok(())
}

/// Words that files are made of, the odd ones among them.
fn word() -> impl Strategy<Value = String> {
    prop_oneof![
        4 => prop::sample::select(vec!["v", "f", "usemtl", "mtllib", "l", "g", "vn", "vt", "newmtl", "Kd", "Ke", "map_Kd"]),
        4 => prop::sample::select(vec!["0", "1", "-1", "2", "3", "4", "-2", "0.5", "1e-9", "1e12", "-7", "1/2/3", "2//1"]),
        1 => prop::sample::select(vec!["nan", "inf", "1e400", "#", "\\", "\\\n", "\r", "\u{0}", "\u{e4}", "a.mtl", "99999999999999999999"]),
        3 => Just("\n"),
    ]
    .prop_map(|word| word.to_owned() + " ")
}

fn words() -> impl Strategy<Value = String> {
    prop::collection::vec(word(), 0..80).prop_map(|words| words.concat())
}

/// A valid scene with a few of its bytes changed, dropped or doubled.
fn mutated(text: &'static str) -> impl Strategy<Value = Vec<u8>> {
    prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4_u8), 0..6).prop_map(move |changes| {
        let mut bytes = text.as_bytes().to_vec();
        for (at, byte, change) in changes {
            let at = at.index(bytes.len());
            match change {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                2 if bytes.len() > 1 => drop(bytes.remove(at)),
                _ => bytes.insert(at, b"0123456789.-# \n\\/ef"[byte as usize % 19]),
            }
        }
        bytes
    })
}

const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0.25\nv 0 1 0\nv 0.5 0.5 2\nusemtl a\nf 1 2 3 4\nf -1 -2 -3\n\
                   usemtl b\nf 1/1 2/2 5/3\nf 4 3 2 1\ng x\nf 1 2 5 3 4\n";
const MTL: &str = "newmtl a\nKd 0.5 0.5 0.5\nKe 1 2 3\n\nnewmtl b # c\nKd .9\nKs 0 0 0\nillum 2\n";

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn random_bytes(obj in prop::collection::vec(any::<u8>(), 0..300), mtl in prop::collection::vec(any::<u8>(), 0..100)) {
        check(&obj, &mtl)?;
    }

    #[test]
    fn random_words(obj in words(), mtl in words()) {
        check(format!("mtllib a.mtl\n{SQUARE}{obj}").as_bytes(), format!("newmtl a\n{mtl}").as_bytes())?;
    }

    #[test]
    fn mutations(obj in mutated(OBJ), mtl in mutated(MTL)) {
        check(&obj, &mtl)?;
    }

    #[test]
    fn random_polygons(corners in prop::collection::vec((-3..4_i32, -3..4_i32, 0..2_i32), 3..12), scale in -12..12_i32) {
        let scale = 10.0_f64.powi(scale);
        let mut text: String = corners
            .iter()
            .map(|&(x, y, z)| format!("v {} {} {}\n", f64::from(x) * scale, f64::from(y) * scale, f64::from(z) * 0.1 * scale))
            .collect();
        for order in [1, -1] {
            text += "f";
            for k in 1..=corners.len() {
                text += &format!(" {}", if order > 0 { k } else { corners.len() + 1 - k });
            }
            text += "\n";
        }
        check(text.as_bytes(), b"")?;
    }
}
