//! Handles are numbers in the shape of pointers: a table says what they stand for, and no number is given out twice. So a handle that was
//! released, or never was one, is told apart from one that lives, and is never followed.

use std::any::Any;
use std::collections::BTreeMap;
use std::ptr;
use std::sync::{Arc, PoisonError, RwLock};

use crate::status::{Ending, Outcome, PATCHLIGHT_INVALID_HANDLE};

/// A kind of handle.
pub trait Handle: Sized {
    /// What it stands for.
    type Target: Any + Send + Sync;
    /// What it is called.
    const NAME: &'static str;
}

struct Entry {
    target: Arc<dyn Any + Send + Sync>,
    /// What its kind of handle is called.
    name: &'static str,
    /// How often it must be released.
    count: u64,
}

struct Table {
    entries: BTreeMap<usize, Entry>,
    last: usize,
}

static TABLE: RwLock<Table> = RwLock::new(Table { entries: BTreeMap::new(), last: 0 });

/// Numbers are multiples of this, so that they look like pointers to anything.
const STEP: usize = 16;

/// A new handle, to be released once.
pub fn create<H: Handle>(target: Arc<H::Target>) -> *mut H {
    let mut table = TABLE.write().unwrap_or_else(PoisonError::into_inner);
    table.last += STEP;
    let number = table.last;
    table.entries.insert(number, Entry { target, name: H::NAME, count: 1 });
    ptr::without_provenance_mut(number)
}

/// What a handle stands for.
pub fn get<H: Handle>(handle: *const H) -> Outcome<Arc<H::Target>> {
    let table = TABLE.read().unwrap_or_else(PoisonError::into_inner);
    let entry = table.entries.get(&handle.addr());
    let target = entry.and_then(|entry| entry.target.clone().downcast().ok());
    target.ok_or_else(|| refused(handle, entry))
}

/// One more release is needed.
pub fn retain<H: Handle>(handle: *mut H) -> Outcome {
    let mut table = TABLE.write().unwrap_or_else(PoisonError::into_inner);
    match table.entries.get_mut(&handle.addr()) {
        Some(entry) if entry.target.is::<H::Target>() => {
            entry.count += 1;
            Ok(())
        }
        entry => Err(refused(handle, entry.map(|entry| &*entry))),
    }
}

/// With the last release the handle ends; what it stands for ends when nobody uses it any more. NULL is let go by.
pub fn release<H: Handle>(handle: *mut H) -> Outcome {
    if handle.is_null() {
        return Ok(());
    }
    let mut table = TABLE.write().unwrap_or_else(PoisonError::into_inner);
    let ended = match table.entries.get_mut(&handle.addr()) {
        Some(entry) if entry.target.is::<H::Target>() => {
            entry.count -= 1;
            if entry.count == 0 { table.entries.remove(&handle.addr()) } else { None }
        }
        entry => return Err(refused(handle, entry.map(|entry| &*entry))),
    };
    // To end a solution may call a function of the caller's, which may want the table.
    drop(table);
    drop(ended);
    Ok(())
}

fn refused<H: Handle>(handle: *const H, found: Option<&Entry>) -> Ending {
    let name = H::NAME;
    let message = match found {
        Some(entry) => format!("a handle of another kind, {}, stands where a {name} is needed", entry.name),
        None if handle.is_null() => format!("the {name} is NULL"),
        None => format!("the {name} is no handle, or was released"),
    };
    Ending::new(PATCHLIGHT_INVALID_HANDLE, message)
}
