//! `patchlight relight`, and `solve --light-groups` before it.

use std::fs;

use super::Place;

/// Solves the room with its lamp and a second one as groups.
fn solve_with_groups(place: &Place) {
    let lamps = "usemtl second\nv 0.1 1.9 0.1\nv 0.3 1.9 0.1\nv 0.3 1.9 0.3\nv 0.1 1.9 0.3\nf -4 -3 -2 -1\n";
    fs::write(place.path("two.obj"), place.read("room.obj").replace("room.mtl", "two.mtl") + lamps).unwrap();
    fs::write(place.path("two.mtl"), place.read("room.mtl") + "newmtl second\nKd 0.1 0.1 0.1\nKe 1 2 3\n").unwrap();
    let ran = place.run(
        "solve two.obj --light-groups material --error 0.1 --lit-mesh -o g.solution --report r.json --image a.png --size 16x12",
    );
    ran.succeeded();
    for word in ["group ", "second: weight 1; alone", "all together", "of the lit mesh"] {
        assert!(ran.stderr.contains(word), "'{word}' is not in: {}", ran.stderr);
    }
}

#[test]
fn groups_are_weighted_and_written_as_anything() {
    let place = Place::new();
    solve_with_groups(&place);
    let report: serde_json::Value = serde_json::from_str(&place.read("r.json")).unwrap();
    let groups = report["light_groups"]["groups"].as_array().unwrap();
    let names: Vec<&str> = groups.iter().map(|group| group["name"].as_str().unwrap()).collect();
    assert!(names.len() == 2 && names.contains(&"second"), "{names:?}");
    assert!(groups.iter().all(|group| group["error"]["estimate"].as_f64().is_some_and(|error| error > 0.0 && error < 1.0)));

    // All that there is, with the weights that were solved: what it was.
    let all = "-o b.solution --image b.png --size 16x12 --points P.csv --values V.csv --mesh b.ply --flux F.csv --html b.html --report b.json";
    place.run(&format!("relight g.solution {all}")).succeeded();
    let bytes = |name: &str| fs::read(place.path(name)).unwrap();
    assert!(bytes("a.png") == bytes("b.png") && bytes("g.solution") == bytes("b.solution"));
    place.run("sample g.solution P.csv -o W.csv").succeeded();
    assert_eq!(place.read("V.csv"), place.read("W.csv"));

    // With others, by a solution that is relit, or at once.
    let first = names.iter().find(|name| **name != "second").unwrap();
    place.run(&format!("relight g.solution --set {first}=0 -o c.solution")).succeeded();
    place
        .run("relight c.solution --set second=0,2,1 -o d.solution --points P.csv --values c.csv --from mesh --report -")
        .succeeded();
    place
        .run(&format!("relight g.solution --set second=0,2,1 --set {first}=0 --points P.csv --values d.csv --from mesh"))
        .succeeded();
    assert_eq!(place.read("c.csv"), place.read("d.csv"));
    let red: Vec<f64> = place.read("c.csv").lines().skip(1).map(|line| line.split(',').nth(6).unwrap().parse().unwrap()).collect();
    assert!(!red.is_empty() && red.iter().all(|&b| b == 0.0), "{red:?}");
    place.run("info d.solution").succeeded();
    let told = place.run("info d.solution");
    assert!(told.stdout.contains("light groups") && told.stdout.contains("second=0,2,1"), "{}", told.stdout);
}

#[test]
fn other_materials_are_solved_again_with_an_error_of_their_own() {
    let place = Place::new();
    place.run("solve room.obj --error 0.2 --keep-transport -o k.solution --report k.json").succeeded();
    let report: serde_json::Value = serde_json::from_str(&place.read("k.json")).unwrap();
    assert!(report["transport"]["terms"].as_u64().is_some_and(|terms| terms > 0), "{}", report["transport"]);
    let material = place.read("room.mtl").split_whitespace().skip_while(|word| *word != "newmtl").nth(1).unwrap().to_owned();
    let ran =
        place.run(&format!("relight k.solution --reflectance {material}=0.4,0.5,0.6 --error 0.9 -o a.solution --report a.json"));
    ran.succeeded();
    assert!(ran.stderr.contains("90.00% asked for: reached"), "{}", ran.stderr);
    let error: serde_json::Value = serde_json::from_str(&place.read("a.json")).unwrap();
    assert!(error["estimate"].as_f64().is_some_and(|claimed| claimed > 0.0 && claimed < 0.9), "{error}");
    place.run("sample a.solution P.csv -o a.csv").succeeded();

    // Results are written where more is claimed than was asked for; numbers are those that are given, whatever was relit before.
    let same =
        place.run(&format!("relight a.solution --reflectance {material}=0.4,0.5,0.6 --error 0.0001 -o b.solution --report b.json"));
    assert_eq!(same.code, 4, "{}", same.stderr);
    assert!(same.stderr.contains("not reached"), "{}", same.stderr);
    let again: serde_json::Value = serde_json::from_str(&place.read("b.json")).unwrap();
    assert!((again["estimate"].as_f64().unwrap() / error["estimate"].as_f64().unwrap() - 1.0).abs() < 1e-3, "{again} {error}");

    for (arguments, words) in [
        ("relight k.solution --reflectance nothing=0.5 -o x.solution", &["--reflectance nothing=0.5", "no such material"][..]),
        ("relight k.solution --reflectance wall -o x.solution", &["MATERIAL=X"]),
        ("relight k.solution --error 0.1 -o x.solution", &["--error needs --reflectance"]),
        ("relight k.solution --reflectance a=1 --set b=1 -o x.solution", &["cannot be used with"]),
        ("solve room.obj --keep-transport --lit-mesh -o x.solution", &["keep_transport"]),
    ] {
        let ran = place.run(arguments);
        assert_eq!(ran.code, 2, "{arguments}: {}", ran.stderr);
        assert!(words.iter().all(|word| ran.stderr.contains(word)), "{arguments}: {}", ran.stderr);
    }
}

#[test]
fn what_cannot_be_grouped_or_weighted_is_said() {
    let place = Place::new();
    solve_with_groups(&place);
    fs::write(place.path("bad.toml"), "one = [\"material second\"]\n").unwrap();
    fs::write(place.path("worse.toml"), "a = [\"material second\"]\nb = [\"lamp\"]\n").unwrap();
    fs::write(place.path("worst.toml"), "a = [\n").unwrap();
    for (arguments, exit, words) in [
        ("relight g.solution", 2, &["say what to write"][..]),
        ("relight g.solution --set second -o x.solution", 2, &["--set second", "lamp=0.5"]),
        ("relight g.solution --set second=much -o x.solution", 2, &["second=much"]),
        ("relight g.solution --set second=-1 -o x.solution", 2, &["-1", "from 0 on"]),
        ("relight g.solution --set second=nan -o x.solution", 2, &["from 0 on"]),
        ("relight g.solution --set second=1,2 -o x.solution", 2, &["2 weights", "or 3"]),
        ("relight g.solution --set sun=1 -o x.solution", 2, &["no group 'sun'", "second"]),
        ("relight room.solution --set sun=1 -o x.solution", 2, &["without any", "--light-groups"]),
        ("relight g.solution --size 8x6 -o x.solution", 2, &["need --image"]),
        ("relight g.solution -o g.solution", 2, &["is read by this command"]),
        ("relight room.obj -o x.solution", 3, &["no solution"]),
        ("solve two.obj --light-groups object --strategy hanrahan91 -o x.solution", 2, &["light groups"]),
        ("solve two.obj --light-groups material --bounds guaranteed -o x.solution", 2, &["no bounds"]),
        ("solve two.obj --light-groups bad.toml -o x.solution", 3, &["bad.toml", "in no group"]),
        ("solve two.obj --light-groups worse.toml -o x.solution", 3, &["worse.toml:2", "'lamp' names no lights"]),
        ("solve two.obj --light-groups worst.toml -o x.solution", 3, &["worst.toml:"]),
        ("solve two.obj --light-groups none.toml -o x.solution", 3, &["none.toml", "material, object or a file"]),
    ] {
        place.run(arguments).failed(exit, words);
    }
    assert!(!place.path("x.solution").exists());
}
