//! Arrays of the caller's that are read: of several types, with any stride.

use std::ffi::c_void;

use crate::memory::{SizedStruct, read_sized};
use crate::status::{Ending, Outcome, PATCHLIGHT_OUT_OF_RESOURCES};

/// What the numbers of an array are. Values may be added.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum patchlight_format {
    /// `float`
    PATCHLIGHT_FLOAT = 1,
    /// `double`
    PATCHLIGHT_DOUBLE = 2,
    /// `uint32_t`
    PATCHLIGHT_UINT32 = 3,
    /// `uint64_t`
    PATCHLIGHT_UINT64 = 4,
}

/// An array that is read: items with a number of components each, which lie one behind the other.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct patchlight_array {
    /// `sizeof(patchlight_array)`
    pub size: usize,
    /// What the components are: a patchlight_format.
    pub format: u32,
    /// The first item. Need not be aligned.
    pub data: *const c_void,
    /// How many items there are.
    pub count: usize,
    /// Bytes from one item to the next; 0 if they lie one behind the other.
    pub stride: usize,
}

// SAFETY: repr(C), its size first, and numbers and a pointer may be zero.
unsafe impl SizedStruct for patchlight_array {
    const NAME: &'static str = "patchlight_array";
}

/// The bytes of an array, checked as far as they can be.
struct Items {
    data: *const u8,
    count: usize,
    stride: usize,
}

impl patchlight_array {
    /// The items of an array with `components` numbers of so many bytes each.
    fn items(&self, components: usize, bytes: usize, what: &str) -> Outcome<Items> {
        let packed = components.checked_mul(bytes).ok_or_else(|| Ending::argument(format_args!("{what}: too many components")))?;
        let stride = if self.stride == 0 { packed } else { self.stride };
        if stride < packed {
            return Err(Ending::argument(format_args!("{what}: a stride of {stride} bytes is less than an item of {packed}")));
        }
        if self.data.is_null() && self.count > 0 {
            return Err(Ending::argument(format_args!("{what}: data is NULL, but count is {}", self.count)));
        }
        if self.count.checked_mul(stride).is_none_or(|all| all > isize::MAX as usize) {
            return Err(Ending::argument(format_args!("{what}: {} items are more than memory holds", self.count)));
        }
        Ok(Items { data: self.data.cast(), count: self.count, stride })
    }
}

/// Room for so many numbers, or a status.
fn room<T>(count: usize, components: usize, what: &str) -> Outcome<Vec<T>> {
    let mut numbers = Vec::new();
    match count.checked_mul(components).map(|all| numbers.try_reserve_exact(all)) {
        Some(Ok(())) => Ok(numbers),
        _ => Err(Ending::new(PATCHLIGHT_OUT_OF_RESOURCES, format_args!("{what}: there is no memory for {count} items"))),
    }
}

/// All components of all items, each read by `read` from its first byte.
///
/// # Safety
/// The items are valid for reads.
unsafe fn read_all<T, U>(items: &Items, components: usize, what: &str, convert: impl Fn(T) -> U) -> Outcome<Vec<U>> {
    let mut numbers = room(items.count, components, what)?;
    for item in 0..items.count {
        for component in 0..components {
            let offset = item * items.stride + component * size_of::<T>();
            // SAFETY: Below count * stride, which does not overflow; the bytes are there by the caller's promise.
            numbers.push(convert(unsafe { items.data.add(offset).cast::<T>().read_unaligned() }));
        }
    }
    Ok(numbers)
}

/// Real numbers, item after item. They may be anything.
///
/// # Safety
/// As the text at the head of the header demands.
pub unsafe fn reals(array: *const patchlight_array, components: usize, what: &str) -> Outcome<Vec<f64>> {
    // SAFETY: The caller's promise.
    let array =
        unsafe { read_sized(array) }.map_err(|ending| Ending { message: format!("{what}: {}", ending.message), ..ending })?;
    if array.format == patchlight_format::PATCHLIGHT_FLOAT as u32 {
        let items = array.items(components, size_of::<f32>(), what)?;
        // SAFETY: The caller's promise.
        return unsafe { read_all(&items, components, what, |x: f32| f64::from(x)) };
    }
    if array.format == patchlight_format::PATCHLIGHT_DOUBLE as u32 {
        let items = array.items(components, size_of::<f64>(), what)?;
        // SAFETY: The caller's promise.
        return unsafe { read_all(&items, components, what, |x: f64| x) };
    }
    Err(Ending::argument(format_args!("{what}: its format is {}, it must be PATCHLIGHT_FLOAT or PATCHLIGHT_DOUBLE", array.format)))
}

/// Whole numbers, one an item.
///
/// # Safety
/// As the text at the head of the header demands.
pub unsafe fn wholes(array: *const patchlight_array, what: &str) -> Outcome<Vec<u64>> {
    // SAFETY: The caller's promise.
    let array =
        unsafe { read_sized(array) }.map_err(|ending| Ending { message: format!("{what}: {}", ending.message), ..ending })?;
    if array.format == patchlight_format::PATCHLIGHT_UINT32 as u32 {
        let items = array.items(1, size_of::<u32>(), what)?;
        // SAFETY: The caller's promise.
        return unsafe { read_all(&items, 1, what, |x: u32| u64::from(x)) };
    }
    if array.format == patchlight_format::PATCHLIGHT_UINT64 as u32 {
        let items = array.items(1, size_of::<u64>(), what)?;
        // SAFETY: The caller's promise.
        return unsafe { read_all(&items, 1, what, |x: u64| x) };
    }
    Err(Ending::argument(format_args!("{what}: its format is {}, it must be PATCHLIGHT_UINT32 or PATCHLIGHT_UINT64", array.format)))
}

/// Points or vectors in space.
///
/// # Safety
/// As the text at the head of the header demands.
pub unsafe fn vectors(array: *const patchlight_array, what: &str) -> Outcome<Vec<[f64; 3]>> {
    // SAFETY: The caller's promise.
    let numbers = unsafe { reals(array, 3, what)? };
    Ok(numbers.chunks_exact(3).map(|vector| [vector[0], vector[1], vector[2]]).collect())
}
