//! The page of a solution under real clicks, drags, keys and the wheel, in Chromium; skipped aloud where there is none.
#![allow(clippy::print_stdout, reason = "a test tells what it skips")]

#[path = "support/browser.rs"]
mod browser;
mod support;

use std::fs;

use browser::Browser;
use patchlight::output::{Page, Provenance, write_page};
use patchlight::pipeline;
use patchlight::progress::Silent;
use patchlight::solve::{RunOptions, SolveOptions};

fn page() -> Vec<u8> {
    let options = SolveOptions { error: 0.2, lit_mesh: true, ..SolveOptions::default() };
    let evaluator = pipeline::solve(support::small_room(3), &options, &RunOptions::default(), &Silent).unwrap().0;
    let (solution, camera) = (evaluator.solution(), evaluator.default_camera(960, 720));
    let mut written = Vec::new();
    let page =
        Page { title: "room", solution, camera: &camera, report: None, planes: &[], curves: &[], met: &evaluator.surface_rays(64) };
    write_page(&mut written, &page, &Provenance::new(solution.options())).unwrap();
    written
}

#[test]
fn a_page_does_what_a_user_asks_of_it() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("page.html"), page()).unwrap();
    let Some(mut browser) = Browser::open(folder.path(), "page.html") else {
        println!("SKIPPED: there is no Chromium to click in (apt-get install chromium)");
        return;
    };
    let note = |browser: &mut Browser| browser.value("document.getElementById('note').textContent").as_str().unwrap().to_owned();
    let first = browser.picture();

    // A click shows values, a drag does not, and turns the scene; so does the wheel bring it closer.
    browser.click([400.0, 400.0]);
    let clicked = note(&mut browser);
    assert!(clicked.starts_with("wall, face ") && clicked.contains("radiosity ") && clicked.contains(" lx"), "{clicked}");
    let marked = browser.picture();
    assert!(marked != first, "the place that was clicked is not marked");
    browser.drag([400.0, 400.0], [520.0, 430.0]);
    assert_eq!(note(&mut browser), clicked);
    let turned = browser.picture();
    assert!(turned != marked, "a drag does not turn the scene");
    browser.wheel([400.0, 400.0], -240.0);
    assert!(browser.picture() != turned, "the wheel does not bring it closer");
    browser.click_on("reset");
    assert!(browser.picture() == marked, "the first view is another one");

    // Switches, each there and back.
    for id in ["lines", "backs"] {
        browser.click_on(id);
        assert_eq!(browser.value(&format!("document.getElementById('{id}').checked")), true);
        assert!(browser.value("location.hash.slice(1)").as_str().unwrap().contains(&format!("{id}=1")));
        browser.click_on(id);
        assert!(browser.picture() == marked, "{id} leaves something");
    }

    // What is shown, by keys: false colours, then texels, whose size is typed.
    browser.value("document.getElementById('show').focus()");
    browser.key("ArrowDown", 40);
    assert_eq!(browser.value("document.getElementById('show').value"), "lux");
    let lux = browser.picture();
    assert!(lux != marked && browser.value("document.getElementById('legend').hidden") == false);
    browser.key("ArrowDown", 40);
    assert_eq!(browser.value("document.getElementById('show').value"), "errors");
    assert!(browser.picture() != lux && browser.value("document.getElementById('legend').hidden") == false);
    browser.key("ArrowDown", 40);
    assert_eq!(browser.value("document.getElementById('show').value"), "texels");
    let texels = browser.picture();
    assert!(texels != marked && texels != lux && browser.value("document.getElementById('texel-row').hidden") == false);
    browser.click_on("texel");
    browser.key("ArrowUp", 38);
    browser.key("Enter", 13);
    assert!(browser.value("location.hash.slice(1)").as_str().unwrap().contains("texel="));
    assert!(browser.picture() != texels, "texels of another size look alike");
}
