//! `patchlight bake`.

#[path = "../support/glb.rs"]
mod glb;

use std::fs;

use serde_json::json;

use super::Place;
use glb::Maker;

#[test]
fn a_solution_is_baked_into_all_kinds_of_files() {
    let place = Place::new();
    let line = "bake room.solution --texel 0.1 -o l.exr -o l.png -o l.hdr --rgbm m.png --glb l.glb --json l.json";
    let ran = place.run(line);
    for words in
        ["atlas     7 charts on 1 page of ", "texels    2", "direct light gathered at ", "values    ", "l.glb (exposure EV "]
    {
        assert!(ran.succeeded().stderr.contains(words), "'{words}' is not in: {}", ran.stderr);
    }
    assert_eq!(place.new_files(), ["l.exr", "l.glb", "l.hdr", "l.json", "l.png", "m.png"]);
    let exr = fs::read(place.path("l.exr")).unwrap();
    assert_eq!(exr[..4], [0x76, 0x2f, 0x31, 0x01]);
    let json: serde_json::Value = serde_json::from_str(&place.read("l.json")).unwrap();
    assert_eq!((&json["quantity"], json["faces"].as_array().unwrap().len()), (&"radiosity".into(), 7));

    // The same bytes by another number of threads.
    place.run("bake room.solution --texel 0.1 -o again.exr --threads 2").succeeded();
    assert!(fs::read(place.path("again.exr")).unwrap() == exr);
}

#[test]
fn direct_and_indirect_light_are_layers_or_files_and_add_up() {
    let place = Place::new();
    let ran = place.run("bake room.solution --texel 0.1 --separate -o l.exr -o l.png --rgbm m.png");
    assert!(
        ran.succeeded().stderr.contains("l.exr (radiosity in W/m^2, with layers of direct and indirect light)"),
        "{}",
        ran.stderr
    );
    assert!(ran.stderr.contains("l.direct.png (radiosity in W/m^2, direct light)"), "{}", ran.stderr);
    let names = ["l.direct.png", "l.exr", "l.indirect.png", "l.png", "m.direct.png", "m.indirect.png", "m.png"];
    assert_eq!(place.new_files(), names);

    // The layers of the file, by the names that programs look for.
    let image = exr::prelude::read_first_flat_layer_from_file(place.path("l.exr")).unwrap();
    let channel = |name: &str| {
        let all = &image.layer_data.channel_data.list;
        let found = all.iter().find(|channel| channel.name.eq(name)).unwrap_or_else(|| panic!("no channel {name}"));
        found.sample_data.values_as_f32().collect::<Vec<f32>>()
    };
    for name in ["R", "G", "B"] {
        let [all, direct, indirect] = ["", "direct.", "indirect."].map(|layer| channel(&format!("{layer}{name}")));
        assert!(direct.iter().any(|x| *x > 0.0) && indirect.iter().any(|x| *x > 0.0));
        for ((all, direct), indirect) in all.iter().zip(&direct).zip(&indirect) {
            assert!((all - direct - indirect).abs() <= 2e-6 * all, "{all} is not {direct} + {indirect}");
        }
    }
    place.run("bake room.solution --separate --from mesh -o l.exr").failed(2, &["--separate", "leave out --from mesh"]);
    place.run("bake room.solution --separate -o l.png -o l.direct.png").failed(2, &["two outputs cannot both be l.direct.png"]);
}

#[test]
fn a_bake_takes_from_an_earlier_one_what_has_not_changed() {
    let place = Place::new();
    let bake = "bake room.obj --error 0.1 --texel 0.1";
    let ran = place.run(&format!("{bake} -o a.exr --keep a.bake"));
    assert!(ran.succeeded().stderr.contains("a.bake (for a later bake, --since)"), "{}", ran.stderr);
    let materials = place.read("room.mtl").replace("Kd 0.6 0.5 0.4", "Kd 0.6 0.5 0.35");
    fs::write(place.path("room.mtl"), materials).unwrap();
    let ran = place.run(&format!("{bake} -o b.exr --since a.bake --keep b.bake"));
    assert!(ran.succeeded().stderr.contains("kept      direct light of "), "{}", ran.stderr);
    assert_eq!(place.new_files(), ["a.bake", "a.exr", "b.bake", "b.exr"]);

    // What does not fit is told before anything is computed.
    let finer = "bake room.obj --error 0.1 --texel 0.05 -o c.exr --since a.bake";
    place.run(finer).failed(2, &["nothing can be taken from the earlier bake: its texels are of 0.1 m, these of 0.05 m"]);
    place.run("bake room.obj --error 0.05 --texel 0.1 -o c.exr --since a.bake").failed(2, &["it was made for an error of 0.1"]);
    place.run(&format!("{bake} -o c.exr --since room.solution")).failed(3, &["room.solution: this is nothing that a bake left"]);
    place.run(&format!("{bake} -o c.exr --from mesh --keep c.bake")).failed(2, &["--keep", "leave out --from mesh"]);
    place.run(&format!("{bake} -o c.exr --since a.bake --keep a.bake")).failed(2, &["a.bake"]);
    place.run(&format!("{bake} --per-vertex c.ply --keep c.bake")).failed(2, &["--keep is for lightmaps"]);
}

#[test]
fn a_scene_is_solved_first_and_pages_are_numbered() {
    let place = Place::new();
    let line = ["bake", "room.obj", "--error", "0.2", "--texel", "0.1", "--size", "32", "--only", "material wall", "-o", "l.exr"];
    let ran = place.run_with(&line, "");
    assert!(ran.succeeded().stderr.contains("6 charts on 6 pages of 24x24"), "{}", ran.stderr);
    assert_eq!(place.new_files(), ["l.2.exr", "l.3.exr", "l.4.exr", "l.5.exr", "l.6.exr", "l.exr"]);

    // By the lit mesh, as illuminance.
    let ran = place.run("bake room.obj --error 0.3 --texel 0.2 --from mesh --quantity illuminance -o m.exr");
    assert!(ran.succeeded().stderr.contains("read off the lit mesh"), "{}", ran.stderr);
    assert!(ran.stderr.contains("m.exr (illuminance in lx)"), "{}", ran.stderr);
}

/// A square of OBJ with texture coordinates, under another one that emits.
const WITH_COORDINATES: &str = "mtllib room.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    vt 0.1 0.1\nvt 0.4 0.1\nvt 0.4 0.4\nvt 0.1 0.4\nvt 0.6 0.6\nvt 0.9 0.6\nvt 0.9 0.9\nvt 0.6 0.9\n\
    usemtl wall\nf 1/1 2/2 3/3 4/4\nusemtl lamp\nf 5/5 8/8 7/7 6/6\n";

#[test]
fn coordinates_of_a_file_are_taken_where_that_is_asked_for_or_told_why_not() {
    let place = Place::new();
    fs::write(place.path("squares.obj"), WITH_COORDINATES).unwrap();
    let ran = place.run("bake squares.obj --error 0.2 --uv file --texel 0.05 --json l.json --glb l.glb");
    assert!(ran.succeeded().stderr.contains("on 1 page of 68x68, as the file lays them out"), "{}", ran.stderr);
    let json: serde_json::Value = serde_json::from_str(&place.read("l.json")).unwrap();
    let uv: Vec<[f64; 2]> = serde_json::from_value(json["faces"][0]["uv"].clone()).unwrap();
    // From the top left, as lightmaps are read.
    for (told, exact) in uv.iter().flatten().zip([0.1, 0.9, 0.4, 0.9, 0.4, 0.6]) {
        assert!((told - exact).abs() < 1e-6, "{uv:?}");
    }
    assert_eq!(json["faces"].as_array().unwrap().len(), 4);
    for file in ["l.json", "l.glb"] {
        fs::remove_file(place.path(file)).unwrap();
    }

    // Those of OBJ files are for textures; they may be anything.
    let ran = place.run("bake squares.obj --error 0.2 --texel 0.1 -o l.exr");
    assert!(ran.succeeded().stderr.contains("2 charts") && !ran.stderr.contains("as the file"), "{}", ran.stderr);
    fs::remove_file(place.path("l.exr")).unwrap();
    fs::write(place.path("squares.obj"), WITH_COORDINATES.replace("f 5/5 8/8 7/7 6/6", "f 5/1 8/4 7/3 6/2")).unwrap();
    place.run("bake squares.obj --uv file -o l.exr").failed(2, &["--uv file: ", "faces 1 and 2 overlap"]);
    fs::write(place.path("squares.obj"), WITH_COORDINATES.replace("f 5/5 8/8 7/7 6/6", "f 5 8 7 6")).unwrap();
    place.run("bake squares.obj --uv file -o l.exr").failed(2, &["--uv file: ", "face 2 has none"]);
    place.run("bake room.solution --uv file -o l.exr").failed(2, &["bake the scene"]);
    assert!(place.new_files().iter().all(|file| file == "squares.obj"), "{:?}", place.new_files());
}

#[test]
fn overlapping_coordinates_of_a_file_are_told_and_charts_made_instead() {
    let place = Place::new();
    let mut maker = Maker::new();
    let uv = maker.floats(&[[0.1_f32, 0.1], [0.4, 0.1], [0.4, 0.4], [0.1, 0.4]]);
    let indices = maker.indices(&[0, 1, 2, 0, 2, 3]);
    for z in [0.0_f32, 1.0] {
        let corners = maker.floats(&[[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]]);
        let mesh = maker.mesh(json!({ "attributes": { "POSITION": corners, "TEXCOORD_1": uv }, "indices": indices }));
        maker.node(json!({ "mesh": mesh }));
    }
    fs::write(place.path("two.glb"), maker.glb()).unwrap();
    let bake = "bake two.glb --error 0.2 --texel 0.1 -o l.exr";
    let ran = place.run(bake);
    let told = "the lightmap coordinates of the file are not used, and faces are laid out anew: faces 1 and 3 overlap at ";
    assert!(ran.succeeded().stderr.contains(told) && ran.stderr.contains("2 charts on 1 page"), "{}", ran.stderr);
    let own = fs::read(place.path("l.exr")).unwrap();
    let ran = place.run(&format!("{bake} --uv own"));
    assert!(!ran.succeeded().stderr.contains("coordinates"), "{}", ran.stderr);
    assert!(fs::read(place.path("l.exr")).unwrap() == own);
    place.run(&format!("{bake} --uv file")).failed(2, &["--uv file: ", "faces 1 and 3 overlap"]);
}

#[test]
fn light_at_vertices_is_written_without_a_lightmap_or_beside_one() {
    let place = Place::new();
    let ran = place.run("bake room.solution --per-vertex v.ply --per-vertex v.glb --within 0.2");
    for words in ["vertices  of 7 faces, gathered at ", "v.ply (radiosity in W/m^2 at vertices)", "v.glb"] {
        assert!(ran.succeeded().stderr.contains(words), "'{words}' is not in: {}", ran.stderr);
    }
    assert_eq!((place.new_files(), ran.stderr.contains("atlas")), (vec!["v.glb".to_owned(), "v.ply".to_owned()], false));
    let first = fs::read(place.path("v.ply")).unwrap();
    let beside = "bake room.solution --texel 0.2 -o l.exr --per-vertex v.ply --within 0.2 --threads 2";
    assert!(place.run(beside).succeeded().stderr.contains("atlas"));
    assert!(fs::read(place.path("v.ply")).unwrap() == first);

    let ran = place.run("bake room.obj --time 1e-6 --per-vertex w.ply");
    assert_eq!(ran.code, 4, "{}", ran.stderr);
    assert!(ran.stderr.contains("light at vertices is not written: the time was over"), "{}", ran.stderr);
    place.run("bake room.solution --per-vertex w.exr").failed(2, &["unknown extension"]);
    place.run("bake room.solution --per-vertex w.ply --within 0").failed(2, &["within is '0'"]);
    assert!(!place.new_files().contains(&"w.ply".to_owned()));
}

#[test]
fn time_and_memory_are_limits_of_a_bake_as_well() {
    let place = Place::new();
    for input in ["room.solution", "room.obj"] {
        let ran = place.run(&format!("bake {input} --time 1e-6 --texel 0.05 -o l.exr"));
        assert_eq!(ran.code, 4, "{}", ran.stderr);
        for words in ["the time was over: ", " have the light of the solver's own elements", "l.exr (radiosity in W/m^2)"] {
            assert!(ran.stderr.contains(words), "'{words}' is not in: {}", ran.stderr);
        }
        assert_eq!(place.new_files(), ["l.exr"]);
        fs::remove_file(place.path("l.exr")).unwrap();

        place.run(&format!("bake {input} --memory 0.001 -o l.exr")).failed(5, &["--memory", "GB"]);
        let fine = format!("bake {input} --memory 0.001 --texel 0.0005 --size 32768 -o l.exr");
        place.run(&fine).failed(5, &["--memory: the lightmap takes", "choose larger texels"]);
        assert!(place.new_files().is_empty());
        place.run(&format!("bake {input} --memory 2 --time 600 --texel 0.1 -o l.exr")).succeeded();
        fs::remove_file(place.path("l.exr")).unwrap();
    }
}

#[test]
fn what_cannot_be_baked_is_told_before_the_work() {
    let place = Place::new();
    for (arguments, code, words) in [
        ("bake room.solution", 2, &["say where the lightmap goes", "--glb"][..]),
        ("bake room.solution -o l.exr --texel 0", 2, &["texel is 0", "above 0"]),
        ("bake room.solution -o l.exr --texel NaN", 2, &["texel is NaN"]),
        ("bake room.solution -o l.exr --texel -1", 2, &["texel is -1"]),
        ("bake room.solution -o l.exr --texel small", 2, &["texel is 'small'"]),
        ("bake room.obj -o l.exr --texel 1e-6", 2, &["texels of 0.000001 m make", "choose larger ones"]),
        ("bake room.solution -o l.exr --size 8", 2, &["size is 8", "from 16 to 32768"]),
        ("bake room.solution -o l.exr --size 16", 2, &["the chart of face", "a page of 16 x 16"]),
        ("bake room.solution -o l.exr --padding 999", 2, &["padding is 999"]),
        ("bake room.solution -o l.exr --only floor", 2, &["'floor' names nothing"]),
        ("bake room.solution -o l.exr --quantity width", 2, &["--quantity width is for pictures"]),
        ("bake room.solution -o l.exr --exposure 1", 2, &["--exposure is for .png and .glb"]),
        ("bake room.solution -o l.exr --from mesh", 2, &["no lit mesh"]),
        ("bake room.solution -o l.exr --error 0.1", 2, &["--error is for scenes", "solved already"]),
        ("bake room.solution -o l.exr --set error=0.1", 2, &["--set error=0.1 is for scenes"]),
        ("bake room.solution -o l.tif", 2, &["unknown extension"]),
        ("bake room.solution --rgbm l.exr", 2, &["--rgbm writes .png"]),
        ("bake room.solution --glb l.gltf", 2, &["--glb writes .glb"]),
        ("bake room.solution -o l.exr -o l.exr", 2, &["two outputs cannot both be l.exr"]),
        ("bake room.solution -o room.solution", 2, &["unknown extension"]),
        ("bake P.csv -o l.exr", 3, &["P.csv"]),
        ("bake none.solution -o l.exr", 3, &["none.solution"]),
    ] {
        place.run(arguments).failed(code, words);
    }
    place.run_with(&["bake", "room.solution", "-o", "l.exr", "--only", "material stone"], "").failed(2, &["material 'stone'"]);
    place.run_with(&["bake", "room.solution", "-o", "l.exr", "--only", "object desk"], "").failed(2, &["object 'desk'"]);
    assert!(place.new_files().is_empty(), "{:?}", place.new_files());
}
