//! Options, cameras and names, as they are typed.

use patchlight::output::Provenance;
use patchlight::picture::{Camera, CameraRequest};
use patchlight::solve::SolveOptions;
use patchlight::visibility::Backend;

/// Sets an option for each line `key=value`. What is refused changes nothing, and what is taken can be typed again as it is shown.
pub fn set_options(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    let mut options = SolveOptions::default();
    for line in text.lines() {
        let Some((key, value)) = line.split_once('=') else { continue };
        let before = options.clone();
        match options.set(key, value) {
            Ok(()) => {
                let entry = SolveOptions::entry(key).expect("it was set");
                let shown = entry.value(&options).expect("it has a value");
                let mut again = before;
                again.set(key, &shown).expect("what is shown can be typed");
                assert_eq!(again, options, "{key}={value} is shown as {shown}");
            }
            Err(error) => {
                assert!(!error.to_string().is_empty());
                assert_eq!(options, before, "{key}={value} is refused");
            }
        }
        aim(value);
        let _ = value.parse::<Backend>().map_err(|error| assert!(!error.to_string().is_empty()));
    }

    // All together, through their own text.
    let is_legal = options.validate().map_err(|error| assert!(!error.to_string().is_empty())).is_ok();
    let mut copy = SolveOptions::default();
    for entry in SolveOptions::entries() {
        if let Some(value) = entry.value(&options) {
            copy.set(entry.key, &value).expect("what is shown can be typed");
        }
    }
    assert_eq!(copy, options);
    assert_eq!(copy.validate().is_ok(), is_legal);
    assert!(!Provenance::new(&options).options().is_empty());
}

/// Takes the text for a camera. One that is taken looks somewhere.
fn aim(text: &str) {
    let default =
        Camera { eye: [0.0; 3], target: [0.0, 0.0, 1.0], up: [0.0, 1.0, 0.0], field_of_view_degrees: 45.0, width: 4, height: 3 };
    match text.parse::<CameraRequest>().and_then(|request| request.apply_to(default)) {
        Ok(camera) => assert_eq!(camera.validate(), Ok(())),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
