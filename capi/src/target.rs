//! Arrays of the caller's that are written: of several types, with any stride.

use std::ffi::c_void;

use crate::array::patchlight_format::{self, *};
use crate::memory::{Out, SizedStruct, read_sized};
use crate::status::{Ending, Outcome, PATCHLIGHT_BUFFER_TOO_SMALL};

/// An array that is written: items with a number of components each, which lie one behind the other.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct patchlight_buffer {
    /// `sizeof(patchlight_buffer)`
    pub size: usize,
    /// What the components become: a patchlight_format.
    pub format: u32,
    /// The first item. Need not be aligned.
    pub data: *mut c_void,
    /// How many items there is room for.
    pub capacity: usize,
    /// Bytes from one item to the next; 0 if they lie one behind the other. What lies between items is left as it is.
    pub stride: usize,
}

// SAFETY: repr(C), its size first, and numbers and a pointer may be zero.
unsafe impl SizedStruct for patchlight_buffer {
    const NAME: &'static str = "patchlight_buffer";
}

/// Where items of so many components are written, checked as far as it can be.
pub struct Target {
    data: *mut u8,
    capacity: usize,
    stride: usize,
    components: usize,
    format: u32,
}

/// What the components of an item are, and which formats they may become.
#[derive(Clone, Copy)]
pub enum Components {
    Reals(usize),
    Wholes(usize),
}

impl Components {
    fn count(self) -> usize {
        match self {
            Self::Reals(count) | Self::Wholes(count) => count,
        }
    }

    /// Bytes that one of them takes in a format.
    fn bytes_in(self, format: u32) -> Outcome<usize> {
        let is = |one: patchlight_format| format == one as u32;
        let needed = match self {
            Self::Reals(_) if is(PATCHLIGHT_FLOAT) => return Ok(size_of::<f32>()),
            Self::Reals(_) if is(PATCHLIGHT_DOUBLE) => return Ok(size_of::<f64>()),
            Self::Wholes(_) if is(PATCHLIGHT_UINT32) => return Ok(size_of::<u32>()),
            Self::Wholes(_) if is(PATCHLIGHT_UINT64) => return Ok(size_of::<u64>()),
            Self::Reals(_) => "PATCHLIGHT_FLOAT or PATCHLIGHT_DOUBLE",
            Self::Wholes(_) => "PATCHLIGHT_UINT32 or PATCHLIGHT_UINT64",
        };
        Err(Ending::argument(format_args!("the buffer's format is {format}, it must be {needed}")))
    }
}

impl Target {
    /// Where so many items are to be written, and tells their number. `None` if that is all that was asked for.
    ///
    /// # Errors
    /// If both are NULL, the buffer cannot be, or has no room for the items.
    ///
    /// # Safety
    /// `buffer` and `count` are NULL or valid as the head of the header demands, what `buffer` describes for as long as the result lives.
    pub unsafe fn new(
        buffer: *const patchlight_buffer,
        count: *mut usize,
        items: usize,
        components: Components,
    ) -> Outcome<Option<Self>> {
        if buffer.is_null() && count.is_null() {
            return Err(Ending::argument("both the buffer and the count are NULL"));
        }
        // SAFETY: The caller's promise.
        let target = if buffer.is_null() { None } else { Some(Self::checked(&unsafe { read_sized(buffer)? }, components)?) };
        if !count.is_null() {
            // SAFETY: The caller's promise.
            unsafe { Out::new(count, "count")? }.set(items)?;
        }
        match &target {
            Some(target) if target.capacity < items => {
                let message = format!("the buffer has room for {} of {items} items", target.capacity);
                Err(Ending::new(PATCHLIGHT_BUFFER_TOO_SMALL, message))
            }
            _ => Ok(target),
        }
    }

    fn checked(buffer: &patchlight_buffer, components: Components) -> Outcome<Self> {
        let patchlight_buffer { format, data, capacity, stride, .. } = *buffer;
        let packed = components.count() * components.bytes_in(format)?;
        let stride = if stride == 0 { packed } else { stride };
        if stride < packed {
            return Err(Ending::argument(format_args!("the buffer's stride of {stride} bytes is less than an item of {packed}")));
        }
        if data.is_null() {
            return Err(Ending::argument("the buffer's data is NULL"));
        }
        if capacity.checked_mul(stride).is_none_or(|all| all > isize::MAX as usize) {
            return Err(Ending::argument(format_args!("the buffer's {capacity} items are more than memory holds")));
        }
        Ok(Self { data: data.cast(), capacity, stride, components: components.count(), format })
    }

    /// Writes the components of all items.
    pub fn write_reals(self, numbers: impl Iterator<Item = f64>) {
        if self.format == PATCHLIGHT_FLOAT as u32 { self.write(numbers.map(|x| x as f32)) } else { self.write(numbers) }
    }

    /// Writes the components of all items.
    pub fn write_wholes(self, numbers: impl Iterator<Item = u32>) {
        if self.format == PATCHLIGHT_UINT32 as u32 { self.write(numbers) } else { self.write(numbers.map(u64::from)) }
    }

    /// Writes numbers of the buffer's format, no more than there is room for.
    fn write<T>(self, numbers: impl Iterator<Item = T>) {
        for (place, number) in numbers.take(self.capacity * self.components).enumerate() {
            let offset = place / self.components * self.stride + place % self.components * size_of::<T>();
            // SAFETY: Within the first `capacity` items, whose bytes are there by the promise made to `new`.
            unsafe { self.data.add(offset).cast::<T>().write_unaligned(number) };
        }
    }
}
