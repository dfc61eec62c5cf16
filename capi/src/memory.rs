//! Memory of the caller's: what is read, and what is written.
//!
//! What cannot be checked is the caller's promise, and stands at the head of the header: a pointer is NULL or valid for what its function
//! says, and nobody else changes what is there during the call.

use std::ffi::{CStr, c_char};
use std::ptr;

use crate::status::{Ending, Outcome, PATCHLIGHT_BUFFER_TOO_SMALL};

fn check<T>(pointer: *const T, what: &str) -> Outcome {
    if pointer.is_null() {
        return Err(Ending::argument(format_args!("{what} is NULL")));
    }
    if !pointer.is_aligned() {
        return Err(Ending::argument(format_args!("{what} is not aligned for its type")));
    }
    Ok(())
}

/// Text that ends in a zero.
///
/// # Safety
/// NULL, or valid up to a zero and unchanged for `'a`.
pub unsafe fn text<'a>(text: *const c_char, what: &str) -> Outcome<&'a str> {
    check(text, what)?;
    // SAFETY: The caller's promise.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|_| Ending::argument(format_args!("{what} is not UTF-8")))
}

/// A place where one value is written.
pub struct Out<T>(*mut T);

impl<T> Out<T> {
    /// # Safety
    /// NULL, or valid for writes for as long as this lives.
    pub unsafe fn new(place: *mut T, what: &str) -> Outcome<Self> {
        check(place, what)?;
        Ok(Self(place))
    }

    /// Writes it.
    pub fn set(self, value: T) -> Outcome {
        // SAFETY: Not NULL, aligned, and valid by the promise made to `new`. What was there needs no drop: it came from C.
        unsafe { self.0.write(value) };
        Ok(())
    }
}

/// A struct that begins with its own size, as the caller knows it: fields may be added at its end.
///
/// # Safety
/// `repr(C)`, begins with a `usize`, and all zeros are a value of it.
pub unsafe trait SizedStruct: Copy {
    /// What it is called.
    const NAME: &'static str;
}

/// Reads a struct. Fields that the caller does not know are zero; those that only the caller knows must be.
///
/// # Safety
/// NULL, or valid for the `size` at its beginning.
pub unsafe fn read_sized<T: SizedStruct>(place: *const T) -> Outcome<T> {
    check(place, T::NAME)?;
    // SAFETY: A size at least is there, by the caller's promise.
    let size = unsafe { place.cast::<usize>().read() };
    let known = size_of::<T>();
    if size < size_of::<usize>() || size > 1 << 16 {
        return Err(Ending::argument(format_args!("size of {} is {size}: set it to sizeof({})", T::NAME, T::NAME)));
    }
    // SAFETY: `size` bytes are there, by the caller's promise.
    let rest = unsafe { std::slice::from_raw_parts(place.cast::<u8>().add(known.min(size)), size.saturating_sub(known)) };
    if rest.iter().any(|&byte| byte != 0) {
        let message = format!("{} has fields that this version of the library does not know: leave them zero", T::NAME);
        return Err(Ending::argument(message));
    }
    // SAFETY: All zeros are a value of `T`, by its trait; at most as many bytes are copied as either has.
    unsafe {
        let mut value = std::mem::zeroed::<T>();
        ptr::copy_nonoverlapping(place.cast::<u8>(), (&raw mut value).cast::<u8>(), known.min(size));
        Ok(value)
    }
}

/// Writes a struct, as far as the caller knows it, and leaves its size as it is.
///
/// # Safety
/// NULL, or valid for reads and writes for the `size` at its beginning.
pub unsafe fn write_sized<T: SizedStruct>(place: *mut T, value: &T) -> Outcome {
    // SAFETY: The caller's promise.
    unsafe { read_sized::<T>(place)? };
    let head = size_of::<usize>();
    // SAFETY: `size` bytes may be written, by the caller's promise; `read_sized` found it to be at least `head`.
    unsafe {
        let size = place.cast::<usize>().read().min(size_of::<T>());
        ptr::copy_nonoverlapping((&raw const *value).cast::<u8>().add(head), place.cast::<u8>().add(head), size - head);
    }
    Ok(())
}

/// A buffer of the caller's, of so many items, and a place for how many there are. Without the buffer only that is asked for.
pub struct Buffer<T> {
    data: *mut T,
    capacity: usize,
    count: *mut usize,
}

impl<T: Copy> Buffer<T> {
    /// # Safety
    /// `data` is NULL or valid for writes of `capacity` items, `count` is NULL or valid for a write, for as long as this lives.
    pub unsafe fn new(data: *mut T, capacity: usize, count: *mut usize) -> Outcome<Self> {
        if data.is_null() && count.is_null() {
            return Err(Ending::argument("both the buffer and the count are NULL"));
        }
        if data.is_null() && capacity > 0 {
            return Err(Ending::argument(format_args!("the buffer is NULL, but its capacity is {capacity}")));
        }
        if !data.is_aligned() || !count.is_aligned() {
            return Err(Ending::argument("the buffer or the count is not aligned for its type"));
        }
        Ok(Self { data, capacity, count })
    }

    /// Tells how many items there are. `false` if that is all that was asked for.
    ///
    /// # Errors
    /// If the buffer has no room for them.
    pub fn begin(&self, items: usize) -> Outcome<bool> {
        if !self.count.is_null() {
            // SAFETY: Aligned and valid by the promise made to `new`.
            unsafe { self.count.write(items) };
        }
        if !self.data.is_null() && self.capacity < items {
            let message = format!("the buffer has room for {} of {items} items", self.capacity);
            return Err(Ending::new(PATCHLIGHT_BUFFER_TOO_SMALL, message));
        }
        Ok(!self.data.is_null())
    }

    /// Writes all items, of which there are so many.
    pub fn fill(self, items: usize, values: impl IntoIterator<Item = T>) -> Outcome {
        if !self.begin(items)? {
            return Ok(());
        }
        let mut written = 0;
        for value in values.into_iter().take(items) {
            // SAFETY: Fewer than `items`, for which there is room.
            unsafe { self.data.add(written).write(value) };
            written += 1;
        }
        if written == items { Ok(()) } else { unreachable!("{written} of {items} items were written") }
    }

    /// Writes all items.
    pub fn copy(self, values: &[T]) -> Outcome {
        self.fill(values.len(), values.iter().copied())
    }
}

impl Buffer<c_char> {
    /// Writes text and the zero behind it, which counts.
    pub fn write_text(self, text: &str) -> Outcome {
        self.fill(text.len() + 1, text.bytes().chain([0]).map(|byte| byte as c_char))
    }
}
