//! The floating-point state of a thread: rounding, flushing of small numbers, traps. Results must not depend on how a host has set it, and
//! the host must find it as it was. Threads inherit it from the thread that starts them.

/// The state that a thread had, which it gets back when this is dropped; until then it has the one that Rust relies on.
pub struct FloatState {
    before: u64,
}

impl FloatState {
    /// Sets the state that Rust relies on: rounding to nearest, nothing flushed, no traps.
    pub fn standard() -> Self {
        let before = control::get();
        if before & control::MASK != control::STANDARD {
            control::set(before & !control::MASK | control::STANDARD);
        }
        Self { before }
    }

    /// Keeps the state as it is, to give it back after somebody else's function.
    pub fn kept() -> Self {
        Self { before: control::get() }
    }
}

impl Drop for FloatState {
    fn drop(&mut self) {
        // With the flags, which tell what happened since somebody cleared them: none of what happened here is the caller's.
        control::set(self.before);
    }
}

#[cfg(target_arch = "x86_64")]
mod control {
    use std::arch::asm;

    /// All but the six flags of MXCSR: traps, rounding, flush to zero, denormals are zero.
    pub(super) const MASK: u64 = 0xffc0;
    /// All traps off, the rest 0 (Intel, Software Developer's Manual 1, section 10.2.3).
    pub(super) const STANDARD: u64 = 0x1f80;

    pub fn get() -> u64 {
        let mut state = 0_u32;
        // SAFETY: stmxcsr writes four bytes to the address that it is given.
        unsafe { asm!("stmxcsr [{}]", in(reg) &mut state, options(nostack, preserves_flags)) };
        u64::from(state)
    }

    pub fn set(state: u64) {
        let state = state as u32;
        // SAFETY: ldmxcsr reads four bytes; they are what stmxcsr gave but for bits of MASK, so no reserved bit is set. The state is the
        // standard one whenever Rust computes.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &state, options(nostack, readonly, preserves_flags)) };
    }
}

#[cfg(target_arch = "aarch64")]
mod control {
    use std::arch::asm;

    /// Traps, rounding, flushing and default NaN of FPCR.
    pub(super) const MASK: u64 = 0x07c0_9f00;
    /// Round to nearest, nothing flushed, no traps (Arm Architecture Reference Manual, FPCR).
    pub(super) const STANDARD: u64 = 0;

    pub fn get() -> u64 {
        let state: u64;
        // SAFETY: Reads a register that every thread may read.
        unsafe { asm!("mrs {}, fpcr", out(reg) state, options(nomem, nostack, preserves_flags)) };
        state
    }

    pub fn set(state: u64) {
        // SAFETY: Writes what was read but for bits of MASK. The state is the standard one whenever Rust computes.
        unsafe { asm!("msr fpcr, {}", in(reg) state, options(nomem, nostack, preserves_flags)) };
    }
}

/// Elsewhere the state is left alone.
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
mod control {
    pub(super) const MASK: u64 = 0;
    pub(super) const STANDARD: u64 = 0;

    pub fn get() -> u64 {
        0
    }

    pub fn set(_state: u64) {}
}
