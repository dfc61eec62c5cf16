//! The page of a solution: what is in it, and that a browser draws it: loads without a network, says nothing in its console, and shows light.
//!
//! Pictures are taken by Chromium (Debian's `chromium`); where there is none, that test says that it is skipped.
#![allow(clippy::print_stdout, reason = "a test tells what it skips")]

#[path = "support/page_text.rs"]
mod page_text;
#[path = "support/rooms.rs"]
mod rooms;
mod support;
#[path = "support/triangles.rs"]
mod triangles;

use std::collections::HashSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use page_text::{array_of, text_of};
use patchlight::output::{Page, Provenance, write_page};
use patchlight::pipeline::{self, Evaluator};
use patchlight::progress::Silent;
use patchlight::scene::{LightGrouping, LightWeight};
use patchlight::solve::{RunOptions, Solution, SolveOptions};
use rooms::Room;

fn solved(channels: usize, lit_mesh: bool) -> Evaluator {
    let options = SolveOptions { error: 0.2, lit_mesh, ..SolveOptions::default() };
    pipeline::solve(support::small_room(channels), &options, &RunOptions::default(), &Silent).unwrap().0
}

fn page_of(evaluator: &Evaluator, title: &str) -> String {
    let camera = evaluator.default_camera(960, 720);
    let solution = evaluator.solution();
    let page = Page { title, solution, camera: &camera, report: None, planes: &[], curves: &[], met: &evaluator.surface_rays(64) };
    let mut written = Vec::new();
    write_page(&mut written, &page, &Provenance::new(solution.options())).unwrap();
    String::from_utf8(written).unwrap()
}

fn floats(page: &str, id: &str) -> Vec<f32> {
    array_of(page, id).into_iter().map(f32::from_le_bytes).collect()
}

fn numbers(page: &str, id: &str) -> Vec<u32> {
    array_of(page, id).into_iter().map(u32::from_le_bytes).collect()
}

#[test]
fn a_page_holds_the_mesh_to_the_bit() {
    let evaluator = solved(3, true);
    let (page, solution) = (page_of(&evaluator, "room"), evaluator.solution());
    let (positions, radiosity) = (floats(&page, "positions"), floats(&page, "radiosity"));
    let (elements, runs) = (numbers(&page, "elements"), numbers(&page, "element-runs"));
    let of_runs: Vec<u32> = runs.chunks(2).flat_map(|run| vec![run[0]; run[1] as usize]).collect();
    let mut element = 0;
    solution.mesh().unwrap().for_each_element(solution.scene(), |surface, nodes, of_nodes| {
        assert_eq!(of_runs[element], surface);
        for k in 0..6 {
            let node = elements[6 * element + k] as usize;
            assert_eq!(positions[3 * node..][..3], nodes[k].map(|x| x as f32));
            assert_eq!(radiosity[3 * node..][..3], of_nodes[3 * k..][..3]);
        }
        element += 1;
    });
    assert_eq!((elements.len(), of_runs.len()), (6 * element, element));
}

/// Without a mesh the elements of the solver are shown, and of bands the mean.
#[test]
fn a_page_without_a_mesh_holds_the_elements() {
    let evaluator = solved(2, false);
    let page = page_of(&evaluator, "room");
    let (triangles, runs) = (numbers(&page, "triangles"), numbers(&page, "triangle-runs"));
    let radiosity = floats(&page, "radiosity");
    let (mut count, mut means) = (0, Vec::new());
    evaluator.solution().for_each_leaf(|vertices, _, radiosity| {
        count += vertices.len() - 2;
        means.extend(vec![(radiosity[0] + radiosity[1]) / 2.0; vertices.len()]);
    });
    assert_eq!(triangles.len(), 3 * count);
    assert_eq!(runs.chunks(2).map(|run| run[1] as usize).sum::<usize>(), count);
    assert_eq!(radiosity, means);
    let facts: serde_json::Value = serde_json::from_str(text_of(&page, "facts-data")).unwrap();
    assert_eq!((&facts["unit"], &facts["shown_channels"]), (&"W/m^2".into(), &1.into()));
}

#[test]
fn a_page_loads_nothing_and_names_do_no_harm() {
    let evaluator = solved(3, true);
    let page = page_of(&evaluator, "</script><b>{{three}}");
    assert!(page.contains("default-src 'none'") && !page.contains("src=\"") && page.matches("href=").count() == 1);
    let facts: serde_json::Value = serde_json::from_str(text_of(&page, "facts-data")).unwrap();
    assert_eq!(facts["title"], "</script><b>{{three}}");
    assert_eq!(facts["command"], "patchlight solve SCENE.obj --set error=0.2 --set lit_mesh=true --html page.html");
    assert_eq!(page_of(&evaluator, "a"), page_of(&evaluator, "a"));
}

/// A room with lamps of two colours, a light group each, solved with a mesh.
fn solved_in_groups() -> Solution {
    let scene = Room::with_lamps().0.scene().with_light_groups(&LightGrouping::Materials).unwrap();
    let options = SolveOptions { error: 0.2, lit_mesh: true, ..SolveOptions::default() };
    pipeline::solve(scene, &options, &RunOptions::default(), &Silent).unwrap().0.solution().clone()
}

fn evaluator(solution: Solution) -> Evaluator {
    Evaluator::new(solution, &RunOptions::default()).unwrap()
}

fn relit(solution: &Solution, lamp: f64, tube: f64) -> Solution {
    let weight = |group: &str, weight: f64| LightWeight { group: group.into(), by_band: vec![weight; 3] };
    solution.relit(&[weight("lamp", lamp), weight("tube", tube)]).unwrap()
}

/// Groups stand in the page each alone, so that their sum is the light shown; one that is off as if it were on.
#[test]
fn groups_of_a_page_add_up() {
    let solution = solved_in_groups();
    for (weights, factors) in [([1.0, 1.0], [1.0, 1.0]), ([0.5, 3.0], [1.0, 1.0]), ([2.0, 0.0], [1.0, 0.0])] {
        let page = page_of(&evaluator(relit(&solution, weights[0], weights[1])), "room");
        let facts: serde_json::Value = serde_json::from_str(text_of(&page, "facts-data")).unwrap();
        let (radiosity, apart) = (floats(&page, "radiosity"), floats(&page, "group-radiosity"));
        assert_eq!(apart.len(), 2 * radiosity.len());
        for (group, factor) in factors.into_iter().enumerate() {
            assert_eq!(facts["light_groups"]["groups"][group]["factor"], factor as u64);
        }
        let brightest = radiosity.iter().fold(0.0_f32, |most, b| most.max(*b));
        for (k, b) in radiosity.iter().enumerate() {
            let sum = factors[0] * f64::from(apart[k]) + factors[1] * f64::from(apart[radiosity.len() + k]);
            assert!((sum - f64::from(*b)).abs() < 1e-5 * f64::from(brightest), "{k}: {sum} for {b}");
        }
        let off: f32 = apart[radiosity.len()..].iter().sum();
        assert!(off > 0.0);
    }
    assert!(array_of(&page_of(&solved(3, true), "room"), "group-radiosity").is_empty());
}

/// The numbers of a line of text.
fn numbers_in(line: &str) -> Vec<f64> {
    line.split([' ', ',']).filter_map(|word| word.parse().ok()).collect()
}

/// What weights in the address show at a click, and claim, is what the library finds for them.
#[test]
fn weights_of_a_page_are_those_of_the_library() {
    let folder = tempfile::tempdir().unwrap();
    let solution = solved_in_groups();
    let of_library = relit(&solution, 0.25, 0.5);
    fs::write(folder.path().join("page.html"), page_of(&evaluator(solution), "room")).unwrap();
    let note = |address: &str| {
        let (dom, said) = browse(folder.path(), address, &["--window-size=1280,800", "--dump-dom"])?;
        assert!(said.is_empty(), "{address}: {said:?}");
        Some(dom)
    };
    let Some(dom) = note("page.html#weights=0.25,0.5&pick=400,400") else {
        println!("SKIPPED: there is no Chromium to draw pages with (apt-get install chromium)");
        return;
    };
    let claim = 100.0 * of_library.light_groups_report().unwrap().lit_mesh.unwrap().estimate;
    let said = format!("error {claim:.2} % claimed by energy; patchlight relight FILE.solution --set lamp=0.25 --set tube=0.5");
    assert!(dom.contains(&said), "'{said}' is not in the page");

    fs::write(folder.path().join("relit.html"), page_of(&evaluator(of_library), "room")).unwrap();
    let line = |dom: &str| dom.lines().find(|line| line.starts_with("radiosity ")).map(numbers_in).unwrap();
    let (weighted, relit) = (line(&dom), line(&note("relit.html#pick=400,400").unwrap()));
    let plain = line(&note("page.html#pick=400,400").unwrap());
    assert_eq!(relit.len(), 3);
    for ((weighted, relit), plain) in weighted.iter().zip(&relit).zip(&plain) {
        assert!((weighted - relit).abs() <= 1e-3 * relit && (plain - relit).abs() > 0.05 * relit, "{weighted} {relit} {plain}");
    }
}

/// Runs Chromium on a page without a network; what it writes to stdout, and what the page says in its console. `None` if there is no Chromium.
fn browse(folder: &Path, file: &str, flags: &[&str]) -> Option<(String, Vec<String>)> {
    let profile = format!("--user-data-dir={}", folder.join("profile").display());
    let common = [
        "--headless=new",
        "--no-sandbox",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
        "--hide-scrollbars",
        "--host-resolver-rules=MAP * ~NOTFOUND",
        "--enable-logging=stderr",
        "--virtual-time-budget=10000",
        "--allow-file-access-from-files",
    ];
    let address = format!("file://{}/{file}", folder.display());
    let ran = Command::new("chromium").args(common).arg(profile).args(flags).arg(address).output().ok()?;
    let said = String::from_utf8_lossy(&ran.stderr).lines().filter(|line| line.contains("CONSOLE")).map(str::to_owned).collect();
    Some((String::from_utf8_lossy(&ran.stdout).into_owned(), said))
}

/// Width, and the RGB pixels of a picture.
fn pixels(file: &Path) -> (usize, Vec<[u8; 3]>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(fs::read(file).unwrap())).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let samples = info.color_type.samples();
    (info.width as usize, bytes[..info.buffer_size()].chunks_exact(samples).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect())
}

#[test]
fn a_browser_draws_the_page_and_says_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("page.html"), page_of(&solved(3, true), "room")).unwrap();
    let phone = "<style>body{margin:0}iframe{width:390px;height:844px;border:0}</style><iframe src='page.html#show=lux'></iframe>";
    fs::write(folder.path().join("phone.html"), phone).unwrap();

    // Part of the stage, from the left and from above: the walls of the room, not the panels over it.
    let shown = |name: &str, page: &str, size: &str, stage: [usize; 2]| {
        let picture = folder.path().join(name);
        let flags = [format!("--window-size={size}"), format!("--screenshot={}", picture.display())];
        let (_, said) = browse(folder.path(), page, &[&flags[0], &flags[1]])?;
        assert!(said.is_empty(), "{page}: {said:?}");
        let (width, pixels) = pixels(&picture);
        Some((80..stage[1]).flat_map(|y| (10..stage[0]).map(move |x| y * width + x)).map(|at| pixels[at]).collect::<Vec<_>>())
    };
    let Some(light) = shown("light.png", "page.html", "1280,800", [800, 600]) else {
        println!("SKIPPED: there is no Chromium to draw pages with (apt-get install chromium)");
        return;
    };
    let lux = shown("lux.png", "page.html#show=lux", "1280,800", [800, 600]).unwrap();
    let lines = shown("lines.png", "page.html#show=lux&lines=1", "1280,800", [800, 600]).unwrap();
    let isolines = shown("isolines.png", "page.html#show=lux&isolines=1", "1280,800", [800, 600]).unwrap();
    let errors = shown("errors.png", "page.html#show=errors", "1280,800", [800, 600]).unwrap();
    let phone = shown("phone.png", "phone.html", "500,900", [280, 350]).unwrap();

    // Light has many shades, and the room fills the stage; false colours are others, lines are orange.
    for (name, picture) in [("light", &light), ("lux", &lux), ("errors", &errors), ("phone", &phone)] {
        let shades: HashSet<&[u8; 3]> = picture.iter().collect();
        let empty = picture.iter().filter(|pixel| **pixel == [0x10, 0x12, 0x14]).count();
        assert!(
            shades.len() > 50 && empty < picture.len() / 10,
            "{name}: {} shades, {empty} of {} are empty",
            shades.len(),
            picture.len()
        );
    }
    let differ = light.iter().zip(&lux).filter(|(a, b)| a != b).count();
    assert!(differ > light.len() / 2, "{differ} of {}", light.len());
    let differ = errors.iter().zip(&lux).filter(|(a, b)| a != b).count();
    assert!(differ > lux.len() / 2, "{differ} of {}", lux.len());
    // Lines of equal light are black or white, which false colours are not, and thin.
    let greys = |picture: &[[u8; 3]]| picture.iter().filter(|[r, g, b]| r == g && g == b && (*r < 10 || *r > 245)).count();
    let drawn = greys(&isolines) - greys(&lux);
    assert!((300..isolines.len() / 20).contains(&drawn), "{drawn} of {}", isolines.len());
    let orange = |picture: &[[u8; 3]]| picture.iter().filter(|[r, _, b]| *r > 120 && *b < 90).count();
    assert!(orange(&lines) > 500 + 2 * orange(&lux), "{} {}", orange(&lines), orange(&lux));

    // A click shows values, and tables tell what is known.
    let (dom, said) = browse(folder.path(), "page.html#pick=400,400", &["--window-size=1280,800", "--dump-dom"]).unwrap();
    assert!(said.is_empty(), "{said:?}");
    for words in
        ["data-drawn=\"yes\"", "wall, face ", "radiosity ", " W/m²", "illuminance ", " ± ", " lx", "20.00 %", "surfaces</th><td>7"]
    {
        assert!(dom.contains(words), "'{words}' is not in the page");
    }
}
