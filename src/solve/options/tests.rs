use std::collections::BTreeSet;

use super::*;

fn all(set: &[(&str, &str)]) -> SolveOptions {
    let mut options = SolveOptions::default();
    set.iter().for_each(|(key, value)| options.set(key, value).unwrap());
    options
}

fn refused(key: &str, value: &str) -> String {
    let mut options = SolveOptions::default();
    let message = options.set(key, value).unwrap_err().to_string();
    assert_eq!(options, SolveOptions::default(), "{key} = {value} is refused, and changes nothing");
    message
}

#[test]
fn keys_name_one_option_each_and_defaults_are_legal() {
    let keys: BTreeSet<_> = SolveOptions::entries().map(|entry| entry.key).collect();
    assert_eq!(keys.len(), SolveOptions::entries().count());
    SolveOptions::default().validate().unwrap();
    for entry in SolveOptions::entries() {
        assert!(!entry.help.is_empty() && !entry.help.contains("  ") && !entry.range().is_empty(), "{entry:?}");
    }
}

#[test]
fn what_is_shown_is_what_is_read() {
    let mut values = vec![
        ("strategy", "lazy94+reduction"),
        ("solver", "cells"),
        ("norm", "energy"),
        ("bounds", "guaranteed"),
        ("sweep", "in-place"),
        ("importance", "material floor"),
        ("skips", "behind+rays"),
        ("skips", "none"),
        ("ambient", "false"),
        ("lit_mesh", "true"),
        ("keep_transport", "true"),
        ("positions", "4096"),
        ("position_rays", "16"),
        ("leaf_rays", "0"),
        ("bottom_area", "0.5"),
        ("seed", "18446744073709551615"),
    ];
    let defaults: Vec<_> = SolveOptions::entries().map(|entry| (entry.key, entry.value(&SolveOptions::default()))).collect();
    values.extend(defaults.iter().filter_map(|(key, value)| Some((*key, value.as_deref()?))));
    for (key, value) in values {
        let shown = SolveOptions::entry(key).unwrap().value(&all(&[(key, value)]));
        assert_eq!(shown.as_deref(), Some(value), "{key}");
    }
    let not_given = defaults.iter().filter(|(_, value)| value.is_none()).map(|(key, _)| *key);
    let expected = [
        "bounds_work",
        "max_links",
        "point_rays",
        "expected_values",
        "tolerance",
        "leaf_rays",
        "discontinuity_tolerance",
        "positions",
        "position_rays",
        "element_area",
    ];
    assert!(not_given.eq(expected));
}

#[test]
fn each_option_is_stored_in_its_own_field() {
    // The report nests options by group, under the keys that are typed.
    let before = serde_json::to_value(SolveOptions::default()).unwrap();
    for group in SolveOptions::GROUPS {
        for entry in group.options {
            let other = match entry.key {
                "strategy" => "uniform",
                "solver" => "links",
                "norm" => "energy",
                "bounds" => "guaranteed",
                "importance" => "material floor",
                "sweep" => "in-place",
                "subdivision" => "discontinuities",
                "skips" => "none",
                "ambient" => "false",
                "lit_mesh" | "keep_transport" => "true",
                "positions" => "512",
                _ if entry.range().starts_with("a number") => "0.75",
                _ => "3",
            };
            let after = serde_json::to_value(all(&[(entry.key, other)])).unwrap();
            let path = if group.name == "general" { format!("/{}", entry.key) } else { format!("/{}/{}", group.name, entry.key) };
            let mut expected = before.clone();
            *expected.pointer_mut(&path).unwrap() = after.pointer(&path).unwrap().clone();
            assert!(after != before && after == expected, "{path}: {after}");
        }
    }
}

#[test]
fn values_out_of_range_are_refused_at_once() {
    for (key, value, range) in [
        ("error", "0", "a number above 0 and below 1"),
        ("error", "1", "a number above 0 and below 1"),
        ("error", "NaN", "a number above 0 and below 1"),
        ("error", "much", "a number above 0 and below 1"),
        ("tolerance", "inf", "a number above 0"),
        ("element_area", "-1", "a number above 0"),
        ("max_links", "0", "a whole number from 1 on"),
        ("point_rays", "1048577", "a whole number from 1 to 1048576"),
        ("leaf_rays", "1048577", "a whole number from 0 to 1048576"),
        ("rays_per_link", "0", "a whole number from 1 to 1024"),
        ("rays_per_light_link", "4294967296", "a whole number from 1 to 1024"),
        ("bounds_work", "18446744073709551615", "a whole number from 0 to 16777216"),
        ("seed", "-1", "a whole number"),
        ("seed", "1.5", "a whole number"),
        ("positions", "255", "a whole number from 256 to 16777216"),
        ("positions", "16777217", "a whole number from 256 to 16777216"),
        ("position_rays", "0", "a whole number from 1 to 1024"),
        ("position_rays", "1025", "a whole number from 1 to 1024"),
        ("min_element", "1.01", "a number from 0 to 1"),
        ("form_factor_tolerance", "0", "a number above 0, at most 1"),
        ("bottom_area", "0.0009", "a number from 0.0009765625 to 1"),
        ("bottom_samples", "9", "a whole number from 1 to 8"),
        ("solver", "hemisphere", "auto, links or cells"),
        ("norm", "rms", "local or energy"),
        ("bounds", "none", "estimate or guaranteed"),
        ("sweep", "up", "jacobi or in-place"),
        ("subdivision", "fine", "regular or discontinuities"),
        ("ambient", "yes", "true or false"),
        ("lit_mesh", "1", "true or false"),
        ("keep_transport", "on", "true or false"),
        ("skips", "light", "all, none, or behind, black, dark, within, rays, clear, clusters, channels, joined by +"),
        ("importance", "everything", Interest::RANGE),
    ] {
        assert_eq!(refused(key, value), format!("{key} is {value}, it must be {range}"));
    }
    assert_eq!(
        refused("strategy", "best"),
        format!("strategy is best, it must be {}", SolveOptions::entry("strategy").unwrap().range())
    );
    assert!(SolveOptions::entry("strategy").unwrap().range().ends_with("error-driven or multiresolution96"));
    let unknown = refused("gather", "links");
    assert!(unknown.starts_with("unknown option 'gather'; choose one of error, norm, strategy, solver,"), "{unknown}");
    assert_eq!("best".parse::<Strategy>().unwrap_err().to_string(), refused("strategy", "best"));
}

#[test]
fn fields_out_of_range_are_refused_by_validation() {
    let links = |links| SolveOptions { links, ..SolveOptions::default() };
    for (options, message) in [
        (SolveOptions { error: f64::NAN, ..SolveOptions::default() }, "error is NaN, it must be a number above 0 and below 1"),
        (SolveOptions { max_links: Some(0), ..SolveOptions::default() }, "max_links is 0, it must be a whole number from 1 on"),
        (
            links(LinkOptions { tolerance: Some(f64::INFINITY), ..LinkOptions::default() }),
            "tolerance is inf, it must be a number above 0",
        ),
        (links(LinkOptions { min_element: -1.0, ..LinkOptions::default() }), "min_element is -1, it must be a number from 0 to 1"),
    ] {
        assert_eq!(options.validate().unwrap_err().to_string(), message);
    }
}

#[test]
fn the_order_of_settings_does_not_matter_and_the_last_value_wins() {
    for [first, second] in [
        [("importance", "view"), ("strategy", "error-driven")],
        [("strategy", "error-driven"), ("importance", "view")],
        // What contradicts the other may be taken back.
        [("bounds", "guaranteed"), ("strategy", "uniform")],
    ] {
        let options = all(&[first, second]);
        assert_eq!((options.validate(), &options), (Ok(()), &all(&[second, first])));
    }
    let back = all(&[("strategy", "lazy94"), ("bounds", "guaranteed"), ("strategy", "default")]);
    assert_eq!((back.validate(), back.strategy), (Ok(()), Strategy::Default));
}

#[test]
fn options_that_contradict_each_other_are_refused_in_either_order() {
    for (pair, message) in [
        (
            [("bounds", "guaranteed"), ("strategy", "lazy94")],
            "bounds is guaranteed, it must be estimate for the strategies of 1994",
        ),
        (
            [("importance", "view"), ("strategy", "uniform")],
            "importance is view, it must be total, unless strategy is error-driven",
        ),
        (
            [("subdivision", "discontinuities"), ("strategy", "bottom-up98")],
            "subdivision is discontinuities, it must be regular for the strategies of 1998",
        ),
    ] {
        for [first, second] in [pair, [pair[1], pair[0]]] {
            let found = all(&[first, second]).validate().unwrap_err().to_string();
            assert!(found.starts_with(message), "{found}");
        }
    }
}
