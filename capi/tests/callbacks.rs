//! Functions of the caller's: one that is asked for memory and refuses it, and visibility functions that fail or lie.

#[path = "support/calls.rs"]
mod support;

use std::ffi::c_void;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicUsize, Ordering};

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

/// How visibility functions misbehave.
struct Liar {
    kind: u32,
    released: AtomicUsize,
}

unsafe extern "C" fn lie(user: *mut c_void, _: *const patchlight_segment, count: usize, occluded: *mut u8) -> i32 {
    // SAFETY: A `Liar` that the test below lends, and room for as many answers.
    unsafe {
        let liar = &*user.cast::<Liar>();
        (0..count).for_each(|k| *occluded.add(k) = if liar.kind == 0 { 2 } else { 0 });
        i32::from(liar.kind == 1)
    }
}

unsafe extern "C" fn lie_of_hits(user: *mut c_void, _: *const patchlight_ray, count: usize, hits: *mut patchlight_hit) -> i32 {
    // SAFETY: As above.
    unsafe {
        let (surface, distance) = match (*user.cast::<Liar>()).kind {
            2 => (1000, 1.0),
            3 => (0, f64::NAN),
            _ => (0, -1.0),
        };
        (0..count).for_each(|k| *hits.add(k) = patchlight_hit { distance, surface, reserved: 0 });
    }
    0
}

unsafe extern "C" fn let_go(user: *mut c_void) {
    // SAFETY: As above.
    unsafe { (*user.cast::<Liar>()).released.fetch_add(1, Ordering::SeqCst) };
}

#[test]
fn visibility_functions_that_fail_or_lie_end_the_solve() {
    let context = context(2);
    let (scene, options) = (closed_box(context), options(&[("error", "0.2")]));
    for kind in 0..5 {
        let (liar, mut solution) = (Liar { kind, released: AtomicUsize::new(0) }, null_mut());
        let visibility = patchlight_visibility {
            size: size_of::<patchlight_visibility>(),
            user: (&raw const liar).cast_mut().cast(),
            occluded: Some(lie),
            first_hits: Some(lie_of_hits),
            release: Some(let_go),
        };
        let info = patchlight_solve_info { visibility: &visibility, ..info(options) };
        // SAFETY: Structs with their sizes, a liar that outlives the solve, and a place for a handle.
        assert_eq!(told(unsafe { patchlight_solve(context, scene, &info, &mut solution) }), PATCHLIGHT_CALLBACK_ERROR, "{kind}");
        assert!(solution.is_null() && liar.released.load(Ordering::SeqCst) == 1);

        let missing = patchlight_visibility { first_hits: None, ..visibility };
        let info = patchlight_solve_info { visibility: &missing, ..info };
        // SAFETY: As above.
        assert_eq!(told(unsafe { patchlight_solve(context, scene, &info, &mut solution) }), PATCHLIGHT_INVALID_ARGUMENT);
    }
    done(patchlight_options_release(options));
    done(patchlight_scene_release(scene));
    done(patchlight_context_release(context));
}
