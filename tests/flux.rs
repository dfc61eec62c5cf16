//! Power by face, object, group and material, against furnaces, the report's energy, and what light can do at all.
#![allow(clippy::print_stdout, reason = "a test tells what it measured")]

#[path = "support/kirchhoff.rs"]
mod kirchhoff;
#[path = "support/rooms.rs"]
mod rooms;
#[path = "support/triangles.rs"]
mod triangles;

use std::collections::BTreeMap;
use std::fs;

use kirchhoff::kirchhoff;
use patchlight::output::write_fluxes;
use patchlight::pipeline::Evaluator;
use patchlight::scene::import::{ImportOptions, read_scene};
use patchlight::solve::{Flux, SolveOptions, Solver};
use rooms::{crowded, cube, solve};

fn to(error: f64) -> SolveOptions {
    SolveOptions { error, ..SolveOptions::default() }
}

fn whole(evaluator: &Evaluator) -> Flux {
    let mut whole = Flux::none(evaluator.solution().scene().channels());
    evaluator.solution().fluxes().iter().for_each(|flux| whole.add(flux));
    whole
}

/// Without a mesh what surfaces emit and absorb is, added up, what the report tells, for either solver.
#[test]
fn surfaces_add_up_to_the_energy_of_the_report() {
    for solver in [Solver::Links, Solver::Cells] {
        for scene in [cube(&[0.5], &[1.0]), crowded(8, 3), kirchhoff(4, 2).scene] {
            let (evaluator, report) = solve(scene, &SolveOptions { solver, ..to(0.05) });
            let whole = whole(&evaluator);
            for (found, told) in [(&whole.emitted, report.energy.emitted), (&whole.absorbed, report.energy.absorbed)] {
                let found: f64 = found.iter().sum();
                assert!((found / told - 1.0).abs() < 1e-9, "{solver}: {found} W for {told} W");
            }
            // What is emitted and not absorbed has escaped, or the links do not account for it.
            let (net, energy) = (whole.net().sum::<f64>(), report.energy);
            assert!((net + energy.escaped + energy.unaccounted).abs() < 1e-9 * energy.emitted, "{solver}: {net} W, {energy:?}");
        }
    }
}

/// In a furnace every surface receives the radiosity of the furnace on its open part, and gives away as much as it takes.
#[test]
fn in_a_furnace_every_surface_is_in_balance() {
    let furnace = kirchhoff(5, 2);
    for lit_mesh in [false, true] {
        let (evaluator, _) = solve(furnace.scene.clone(), &SolveOptions { lit_mesh, solver: Solver::Links, ..to(0.02) });
        let fluxes = evaluator.solution().fluxes();
        let (mut worst, mut checked) = (0.0_f64, 0);
        for (surface, flux) in furnace.scene.surfaces().iter().zip(&fluxes) {
            let corners: Vec<[f64; 3]> = surface.polygon.vertices().collect();
            // The floor is partly covered, and what stands on it is open at no point of its underside.
            if corners.iter().all(|corner| corner[2] == 0.0) {
                continue;
            }
            for channel in 0..2 {
                let (incident, b0) = (flux.incident[channel] / flux.area, furnace.b0[channel]);
                let net = flux.net().nth(channel).unwrap() / flux.emitted[channel];
                worst = worst.max((incident / b0 - 1.0).abs()).max(net.abs());
                checked += 1;
            }
        }
        println!("lit mesh {lit_mesh}: surfaces are off by {:.2}% at most", 100.0 * worst);
        // 2% in the root mean square over all surfaces were asked for; a single small one may be off by more.
        assert!(checked > 40 && worst < 0.08, "lit mesh {lit_mesh}: {worst}");
    }
}

/// The mesh's own light adds up in a closed room: all that is emitted is absorbed, within what was asked for.
#[test]
fn of_a_lit_mesh_what_is_emitted_is_absorbed() {
    let (evaluator, report) = solve(crowded(8, 3), &SolveOptions { lit_mesh: true, ..to(0.05) });
    let (whole, emitted) = (whole(&evaluator), report.energy.emitted);
    let (found, absorbed) = (whole.emitted.iter().sum::<f64>(), whole.absorbed.iter().sum::<f64>());
    println!("{emitted} W emitted, {absorbed} W absorbed");
    assert!((found / emitted - 1.0).abs() < 1e-9 && (absorbed / emitted - 1.0).abs() < 0.05, "{absorbed} W of {emitted} W");
}

const ROOM: &str = "\
mtllib room.mtl
v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2
v 0.7 1.99 0.7\nv 1.3 1.99 0.7\nv 1.3 1.99 1.3\nv 0.7 1.99 1.3
usemtl wall
o shell\ng floor all
f 1 5 6 2
g all
f 4 3 7 8\nf 1 2 3 4\nf 5 8 7 6\nf 1 4 8 5\nf 2 6 7 3
f 1 2
o lamp, \"hanging\"\ng
usemtl lamp
f 9 10 11 12
";

/// The rows of the table of a room: numbers by names. Names outlive the file of the solution.
fn rows_of_the_room() -> BTreeMap<String, Vec<f64>> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("room.obj"), ROOM).unwrap();
    fs::write(folder.path().join("room.mtl"), "newmtl wall\nKd 0.6 0.5 0.4\nnewmtl lamp\nKd 0 0 0\nKe 5 5 5\n").unwrap();
    let scene = read_scene(&folder.path().join("room.obj"), &ImportOptions::default()).unwrap().scene;
    let (evaluator, _) = solve(scene, &to(0.1));

    let bytes = postcard::to_stdvec(evaluator.solution()).unwrap();
    let mut text = Vec::new();
    write_fluxes(&mut text, &postcard::from_bytes(&bytes).unwrap()).unwrap();
    let mut reader = csv::Reader::from_reader(text.as_slice());
    let header: Vec<String> = reader.headers().unwrap().iter().map(str::to_owned).collect();
    assert_eq!(
        header.join(","),
        "of,face,material,object,group,area_m2,emitted_r,emitted_g,emitted_b,incident_r,incident_g,incident_b,\
         absorbed_r,absorbed_g,absorbed_b,net_r,net_g,net_b"
    );
    let mut rows = BTreeMap::new();
    for record in reader.records().map(Result::unwrap) {
        let names = record.iter().take(5).collect::<Vec<_>>().join("|");
        let numbers: Vec<f64> = record.iter().skip(5).map(|field| field.parse().unwrap()).collect();
        assert!(rows.insert(names, numbers).is_none());
    }
    rows
}

/// Names and numbers of the input, and sums of faces in all rows above them.
#[test]
fn the_table_names_what_the_input_names() {
    let rows = rows_of_the_room();
    let names: Vec<&str> = rows.keys().map(String::as_str).collect();
    let expected = [
        "face|1|wall|shell|floor all",
        "face|2|wall|shell|all",
        "face|3|wall|shell|all",
        "face|4|wall|shell|all",
        "face|5|wall|shell|all",
        "face|6|wall|shell|all",
        "face|8|lamp|lamp, \"hanging\"|",
        "group||||all",
        "group||||floor all",
        "material||lamp||",
        "material||wall||",
        "object|||lamp, \"hanging\"|",
        "object|||shell|",
        "scene||||",
    ];
    assert_eq!(names, expected);

    // Rows are sums of faces; the scene's is that of all.
    let sum = |of: &[&str]| {
        let rows = of.iter().map(|name| &rows[*name]);
        rows.fold(vec![0.0; 13], |sum: Vec<f64>, row| sum.iter().zip(row).map(|(a, b)| a + b).collect())
    };
    for (name, of) in [
        ("scene||||", &expected[..7]),
        ("material||wall||", &expected[..6]),
        ("object|||shell|", &expected[..6]),
        ("group||||all", &expected[1..6]),
        ("group||||floor all", &expected[..1]),
    ] {
        let sum = sum(of);
        assert!(rows[name].iter().zip(&sum).all(|(a, b)| (a - b).abs() <= 1e-9 * b.abs().max(1.0)), "{name}: {sum:?}");
    }
    assert!((rows["scene||||"][0] - 24.36).abs() < 1e-9);
    assert!((rows["material||lamp||"][1] - 5.0 * std::f64::consts::PI * 0.36).abs() < 1e-9);
}
