//! The function that is asked whether a solve may take more memory.

#[path = "support/calls.rs"]
mod support;

use std::ffi::c_void;
use std::ptr::null_mut;

use patchlight_capi::patchlight_items::*;
use patchlight_capi::patchlight_real::*;
use patchlight_capi::patchlight_status::*;
use patchlight_capi::*;
use support::*;

/// What a solve may take, and what it has asked for.
struct Purse {
    most: u64,
    asked: Vec<u64>,
}

unsafe extern "C" fn refuse(user: *mut c_void, bytes: u64) -> i32 {
    // SAFETY: A purse that the test below lends; the solve asks on one thread at a time, and the test waits for it.
    let purse = unsafe { &mut *user.cast::<Purse>() };
    purse.asked.push(bytes);
    i32::from(bytes > purse.most)
}

#[test]
fn who_is_asked_for_memory_may_refuse_it() {
    let context = context(1);
    let (scene, options) = (closed_box(context), options(&[("error", "0.02"), ("solver", "links"), ("backend", "obvhs")]));
    let solve = |most| {
        let (mut purse, mut solution, mut taken) = (Purse { most, asked: Vec::new() }, null_mut(), 0.0);
        let info = patchlight_solve_info { memory: Some(refuse), memory_user: (&raw mut purse).cast(), ..info(options) };
        // SAFETY: A struct with its size, places for a handle and a number, and a purse that outlives the solve.
        let status = done(unsafe { patchlight_solve(context, scene, &info, &mut solution) });
        let links = reals(solution, PATCHLIGHT_LINKS, PATCHLIGHT_FORM_FACTOR).len();
        // SAFETY: A place for a number.
        done(unsafe { patchlight_solution_get_figure(solution, patchlight_figure::PATCHLIGHT_MEMORY_BYTES as u32, &mut taken) });
        done(patchlight_solution_release(solution));
        (status, purse.asked, links, taken)
    };
    let (status, asked, all_links, taken) = solve(u64::MAX);
    let most = *asked.iter().max().unwrap();
    assert!(status == PATCHLIGHT_OK && most as f64 > taken, "{status:?}, {most} asked for, {taken} kept");

    // Less than what it would have taken ends it earlier; nothing at all leaves what is needed to begin.
    let (status, asked, links, _) = solve(most - 1);
    assert!(status == PATCHLIGHT_MEMORY_LIMIT && asked.iter().any(|&bytes| bytes >= most) && links <= all_links, "{status:?}");
    let (status, _, links, _) = solve(0);
    assert!(status == PATCHLIGHT_MEMORY_LIMIT && links < all_links, "{status:?}, {links} of {all_links} links");
    done(patchlight_options_release(options));
    done(patchlight_scene_release(scene));
    done(patchlight_context_release(context));
}
