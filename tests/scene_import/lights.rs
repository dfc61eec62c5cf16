//! Lights that are no surfaces, from a TOML file: what they are, and what is said about bad ones.

use std::f64::consts::PI;

use patchlight::scene::import::{DiagnosticKind, ImportError, ImportOptions, ImportedLights, read_lights, read_scene};
use patchlight::scene::{Distribution, LUMENS_PER_WATT, Light, LightShape, SceneSummary, SkyLight};

use super::{Folder, SQUARE};

/// 100 cd in all directions below the horizon: 200 pi lm.
const IES: &str = "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 2 1 1 2 0.2 0.3 0\n1 1 30\n0 90\n0\n100 100\n";

fn lights(text: &str, channels: usize) -> Result<ImportedLights, String> {
    let folder = Folder::with(&[("l.toml", text.as_bytes()), ("a.ies", IES.as_bytes())]);
    let read = read_lights(&folder.path("l.toml"), channels, false);
    read.map_err(|error| {
        error.to_string().replace(&format!("{}/", folder.path("").display().to_string().trim_end_matches('/')), "")
    })
}

fn light(text: &str) -> Light {
    lights(text, 3).unwrap().lights.remove(0)
}

fn near(found: &[f64], expected: [f64; 3]) {
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-12 * b.abs().max(1.0)), "{found:?} {expected:?}");
}

#[test]
fn strengths_are_in_watts_or_what_an_eye_sees() {
    let point = |strength: &str| light(&format!("[[point]]\nposition = [0, 0, 0]\n{strength}"));
    near(&point("intensity = 2").strength, [2.0; 3]);
    near(&point("intensity = [1, 2_0, 3.5e0]").strength, [1.0, 20.0, 3.5]);
    near(&point("power = [1, 2, 3]").flux().unwrap(), [1.0, 2.0, 3.0]);
    near(&point("candela = 179").strength, [1.0; 3]);
    near(&point("lumens = 1790").flux().unwrap(), [10.0; 3]);

    // Of a colour, it is as many lumens.
    for colour in ["colour = [1, 0.5, 0]", "colour = [0, 0, 7]", "kelvin = 2700", "kelvin = 9000"] {
        let flux = point(&format!("lumens = 800\n{colour}")).flux().unwrap();
        let seen = LUMENS_PER_WATT * (0.2126 * flux[0] + 0.7152 * flux[1] + 0.0722 * flux[2]);
        assert!((seen - 800.0).abs() < 1e-9, "{colour}: {flux:?}");
    }
    let warm = point("lumens = 800\nkelvin = 2700").strength;
    assert!(warm[0] > warm[1] && warm[1] > warm[2]);

    // Other numbers of channels.
    let grey = lights("[[point]]\nposition = [0, 0, 0]\ncandela = 179\nkelvin = 3000", 1).unwrap();
    assert_eq!(grey.lights[0].strength, [1.0]);
    let bands = lights("[[point]]\nposition = [0, 0, 0]\nintensity = [1, 2, 3, 4, 5]", 5).unwrap();
    assert_eq!(bands.lights[0].strength, [1.0, 2.0, 3.0, 4.0, 5.0]);
    let unseen = lights("[[point]]\nposition = [0, 0, 0]\ncandela = 5", 5).unwrap_err();
    assert!(unseen.starts_with("l.toml:1: of 5 channels it is not known what an eye sees"), "{unseen}");
}

#[test]
fn spots_have_cones_about_where_they_look() {
    // Even within its cone: 2 pi (1 - cos 60 degrees) = pi.
    let even = light("[[spot]]\nposition = [1, 2, 3]\ndirection = [0, 0, -5]\ninner = 60\nouter = 60\nlumens = 179");
    near(&even.strength, [1.0 / PI; 3]);
    let aimed = light("[[spot]]\nposition = [1, 2, 3]\ntowards = [1, 2, 0]\ninner = 60\nouter = 60\nlumens = 179");
    assert_eq!(even.shape, aimed.shape);
    let LightShape::Point(spot) = &even.shape else { panic!() };
    assert!(spot.position() == [1.0, 2.0, 3.0] && matches!(spot.distribution(), Distribution::Spot(_)));
    assert_eq!((even.name.as_str(), even.kind()), ("spot 1", "spot"));
}

#[test]
fn luminaires_have_the_candelas_or_the_flux_that_is_asked_for() {
    let ies = |more: &str| lights(&format!("[[ies]]\nfile = 'a.ies'\nposition = [0, 2, 0]\n{more}"), 3).unwrap();
    let read = ies("");
    near(&read.lights[0].strength, [100.0 / 179.0; 3]);
    near(&read.lights[0].flux().unwrap(), [200.0 * PI / 179.0; 3]);
    let notes: Vec<&str> = read.diagnostics.items.iter().map(|item| item.text.as_str()).collect();
    assert_eq!(
        notes,
        [
            "1 of 1 lights are given by what an eye sees: 179 lm are a watt",
            "its luminous opening, 0.200 x 0.300 x 0.000 m, is taken as a point"
        ]
    );
    assert_eq!(read.files.len(), 2);
    near(&ies("factor = 0.5").lights[0].strength, [50.0 / 179.0; 3]);
    near(&ies("lumens = 358").lights[0].flux().unwrap(), [2.0; 3]);
    near(&ies("power = [1, 2, 3]\ndirection = [1, 0, 0]\nfront = [0, 1, 0]").lights[0].flux().unwrap(), [1.0, 2.0, 3.0]);
}

#[test]
fn suns_and_skies_stand_over_the_axes_of_the_file() {
    let sun = |text: &str| match light(text).shape {
        LightShape::Sun(sun) => (sun.towards(), sun.diameter().to_degrees()),
        other => panic!("{other:?}"),
    };
    // To the south, 45 degrees high: with y up north is -z, and east is x.
    let strong = "irradiance = 1";
    let (towards, diameter) = sun(&format!("[[sun]]\nazimuth = 180\nelevation = 45\n{strong}"));
    near(&towards, [0.0, 0.5_f64.sqrt(), 0.5_f64.sqrt()]);
    assert!((diameter - 0.533).abs() < 1e-12);
    near(&sun(&format!("[[sun]]\ndirection = [0, -2, -2]\n{strong}")).0, towards);
    near(&sun(&format!("up = 'z'\n[[sun]]\nazimuth = 90\nelevation = 0\n{strong}")).0, [1.0, 0.0, 0.0]);
    near(&sun(&format!("up = 'x'\n[[sun]]\nazimuth = 0\nelevation = 90\n{strong}")).0, [1.0, 0.0, 0.0]);
    let (towards, diameter) =
        sun(&format!("up = [0, 0, 5]\nnorth = [-1, 0, 1]\n[[sun]]\nazimuth = 90\nelevation = 0\ndiameter = 0\n{strong}"));
    near(&towards, [0.0, 1.0, 0.0]);
    assert_eq!(diameter, 0.0);

    near(&light("[[sun]]\nazimuth = 0\nelevation = 45\nlux = 358").strength, [2.0; 3]);
    let sky = light("[[sky]]\nkind = 'clear'\nazimuth = 10\nelevation = 45\nlux = 179\nground = 0.2");
    near(&sky.strength, [1.0; 3]);
    let LightShape::Sky(of) = &sky.shape else { panic!() };
    assert!(matches!(of.light(), SkyLight::Clear { .. }) && of.ground() == 0.2 && sky.kind() == "clear sky");
}

#[test]
fn a_scene_is_read_with_its_lights() {
    let obj = format!("{SQUARE}f 1 2 3 4\n");
    let text = "[[point]]\nname = 'lamp'\nposition = [0.5, 0.5, 1]\nlumens = 179\n[[sky]]\nkind = 'uniform'\nlux = 358\n";
    let folder = Folder::with(&[("a.obj", obj.as_bytes()), ("l.toml", text.as_bytes())]);
    let options = ImportOptions { lights: Some(folder.path("l.toml")), ..ImportOptions::default() };
    let imported = read_scene(&folder.path("a.obj"), &options).unwrap();
    assert_eq!(imported.diagnostics.count(DiagnosticKind::NoLight), 0);
    assert_eq!(imported.libraries, [folder.path("l.toml")]);
    let told = SceneSummary::new(&imported.scene, &imported.diagnostics).to_string();
    assert!(told.contains("light        'lamp', point: 1.0000 1.0000 1.0000 W, 179.0 lm\n"), "{told}");
    assert!(told.contains("light        'sky 2', uniform sky: 2.0000 2.0000 2.0000 W/m^2, 358.0 lx\n"), "{told}");
    let missing = ImportOptions { lights: Some(folder.path("no.toml")), ..ImportOptions::default() };
    assert!(matches!(read_scene(&folder.path("a.obj"), &missing), Err(ImportError::Unreadable { .. })));
    // Without a light, all is dark.
    assert_eq!(read_scene(&folder.path("a.obj"), &ImportOptions::default()).unwrap().diagnostics.count(DiagnosticKind::NoLight), 1);
}

#[test]
fn photometric_files_lie_beside_the_file_unless_any_path_is_allowed() {
    let elsewhere = Folder::with(&[("a.ies", IES.as_bytes())]);
    let text = format!("[[ies]]\nposition = [0, 0, 0]\nfile = '{}'\n", elsewhere.path("a.ies").display());
    let folder = Folder::with(&[("l.toml", text.as_bytes())]);
    let error = read_lights(&folder.path("l.toml"), 3, false).unwrap_err().to_string();
    assert!(error.contains("l.toml:3: ") && error.contains("--allow-any-path"), "{error}");
    assert!(read_lights(&folder.path("l.toml"), 3, true).is_ok());
}

#[test]
fn what_is_wrong_is_told_with_file_and_line() {
    let point = "[[point]]\nposition = [1, 2, 3]\n";
    for (text, words) in [
        (String::new(), "l.toml:1: it has no light"),
        ("[[point]\n".to_owned(), "l.toml:1: it is no TOML"),
        ("up = 'w'\n".to_owned() + point, "l.toml:1: 'up' is 'w'"),
        ("up = 'y'\nnorth = [0, 1, 0]\n".to_owned() + point, "l.toml:2: 'north' must point aside"),
        ("upp = 'y'\n".to_owned() + point, "l.toml:1: there is no key 'upp' here, it must be one of up, north, point"),
        ("[point]\nposition = [1, 2, 3]\n".to_owned(), "l.toml:1: write [[point]], with two brackets"),
        (point.to_owned(), "l.toml:1: say how strong the light is, by one of intensity, power, candela, lumens"),
        ("[[point]]\ncandela = 1\n".to_owned(), "l.toml:1: 'position' is missing"),
        (format!("{point}candela = 1\nlumens = 2\n"), "l.toml:4: 'candela' and 'lumens' say the same thing"),
        (format!("{point}candela = 'much'\n"), "l.toml:3: 'candela' must be a decimal number"),
        (format!("{point}candela = inf\n"), "l.toml:3: 'candela' is inf, not a number below 1e30"),
        (format!("{point}candela = nan\n"), "l.toml:3: 'candela' is nan"),
        (format!("{point}candela = -1\n"), "l.toml:3: 'candela' is -1, it must be from 0"),
        (format!("{point}intensity = [1, 2]\n"), "l.toml:3: 'intensity' has 2 numbers, the scene 3 channels"),
        (format!("{point}intensity = [1, -2, 3]\n"), "l.toml:3: 'intensity' is -2"),
        (format!("{point}intensity = 1\nkelvin = 3000\n"), "l.toml:4: 'intensity' is in watts, which have no colour"),
        (format!("{point}candela = 1\nkelvin = 100\n"), "l.toml:4: 'kelvin' is 100, it must be from 1667 to 25000"),
        (format!("{point}candela = 1\ncolour = [0, 0, 0]\n"), "l.toml:1: its colour is black"),
        (format!("{point}candela = 1\nradius = 1\n"), "l.toml:4: there is no key 'radius' here"),
        (format!("{point}candela = 1\nname = ''\n"), "l.toml:1: it has no name"),
        (format!("{point}candela = 1\nname = 'a'\n{point}candela = 1\nname = 'a'\n"), "l.toml:5: another light is named 'a'"),
        ("[[point]]\nposition = [1, 2]\ncandela = 1\n".to_owned(), "l.toml:2: 'position' must be three numbers"),
        ("[[spot]]\nposition = [1, 2, 3]\nouter = 30\n".to_owned(), "l.toml:1: say where the spot looks"),
        ("[[spot]]\nposition = [1, 2, 3]\ntowards = [1, 2, 3]\nouter = 30\n".to_owned(), "l.toml:3: 'towards' leaves no direction"),
        (
            "[[spot]]\nposition = [1, 2, 3]\ndirection = [0, 0, 1]\nouter = 100\n".to_owned(),
            "l.toml:4: 'outer' is 100, it must be from 0 to 90",
        ),
        (
            "[[spot]]\nposition = [1, 2, 3]\ndirection = [0, 0, 1]\ninner = 40\nouter = 30\n".to_owned(),
            "l.toml:1: its cones are not 0 <= inner <= outer <= 90 degrees",
        ),
        ("[[ies]]\nposition = [1, 2, 3]\nfile = 'b.ies'\n".to_owned(), "l.toml:3: b.ies cannot be read"),
        ("[[ies]]\nposition = [1, 2, 3]\nfile = 'l.toml'\n".to_owned(), "l.toml: it has no line TILT="),
        ("[[sun]]\nlux = 1\nazimuth = 3\n".to_owned(), "l.toml:1: say where the sun stands"),
        ("[[sky]]\nlux = 1\n".to_owned(), "l.toml:1: 'kind' is missing"),
        ("[[sky]]\nlux = 1\nkind = 'blue'\n".to_owned(), "l.toml:3: 'kind' is 'blue'"),
        ("[[sky]]\nlux = 1\nkind = 'clear'\nazimuth = 0\nelevation = -5\n".to_owned(), "l.toml:1: its sun is below the horizon"),
        ("[[sky]]\nlux = 1\nkind = 'uniform'\nground = 1\n".to_owned(), "l.toml:4: 'ground' is 1, it must be from 0 to 0.99"),
    ] {
        let message = lights(&text, 3).map(|_| ()).unwrap_err();
        assert!(message.starts_with(words), "{text}: {message}");
    }
    let folder = Folder::with(&[("l.toml", b"[[point]]\nname = '\xff'\n")]);
    let error = read_lights(&folder.path("l.toml"), 3, false).unwrap_err().to_string();
    assert!(error.contains("l.toml:2: it is not UTF-8"), "{error}");
}
