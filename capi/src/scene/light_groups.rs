//! How the lights of a scene are grouped, so that they can be weighted after the solve.

use std::ffi::c_char;

use patchlight::scene::{EmitterName, LightGrouping};

use super::patchlight_scene;
use crate::entry::enter;
use crate::handles;
use crate::memory::text;
use crate::status::{Ending, patchlight_status};

/// How lights are grouped. Values may be added.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_light_grouping {
    /// Not at all, as at first.
    PATCHLIGHT_LIGHTS_TOGETHER = 0,
    /// A group for each material that emits, by its name, and for each light that is no surface.
    PATCHLIGHT_LIGHTS_BY_MATERIAL = 1,
    /// A group for each object of a file that has emitters, and for each light that is no surface.
    PATCHLIGHT_LIGHTS_BY_OBJECT = 2,
}

use patchlight_light_grouping::*;

/// Groups the lights of a scene that is not committed yet: `grouping` is a patchlight_light_grouping. patchlight_scene_commit finds the groups, and
/// patchlight_solution_relight weights them after the solve.
#[unsafe(no_mangle)]
pub extern "C" fn patchlight_scene_group_lights(scene: *mut patchlight_scene, grouping: u32) -> patchlight_status {
    enter(|| {
        let scene = handles::get(scene)?;
        let grouping = match grouping {
            _ if grouping == PATCHLIGHT_LIGHTS_TOGETHER as u32 => None,
            _ if grouping == PATCHLIGHT_LIGHTS_BY_MATERIAL as u32 => Some(LightGrouping::Materials),
            _ if grouping == PATCHLIGHT_LIGHTS_BY_OBJECT as u32 => Some(LightGrouping::Objects),
            _ => return Err(Ending::argument(format_args!("grouping is {grouping}, which is no patchlight_light_grouping"))),
        };
        scene.group_lights(|own| *own = grouping)
    })
}

/// Adds lights to the group of a name, which is made with its first ones: `lights` is "material NAME", "object NAME" or "light NAME". Every surface that
/// emits must be in one group then, and every light. Takes the place of what patchlight_scene_group_lights said.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn patchlight_scene_add_to_light_group(
    scene: *mut patchlight_scene,
    group: *const c_char,
    lights: *const c_char,
) -> patchlight_status {
    enter(|| {
        let scene = handles::get(scene)?;
        // SAFETY: The contract of the header.
        let (group, lights) = unsafe { (text(group, "group")?, text(lights, "lights")?) };
        let lights: EmitterName = lights.parse().map_err(|error: String| Ending::argument(error))?;
        scene.group_lights(|own| {
            let mut groups = match own.take() {
                Some(LightGrouping::Named(groups)) => groups,
                _ => Vec::new(),
            };
            match groups.iter_mut().find(|(name, _)| name == group) {
                Some((_, all)) => all.push(lights),
                None => groups.push((group.to_owned(), vec![lights])),
            }
            *own = Some(LightGrouping::Named(groups));
        })
    })
}
