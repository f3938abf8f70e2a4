//! Flushes denormal numbers to zero, as Embree recommends.
#![allow(unsafe_code, reason = "the register is only accessible by assembly")]

/// Flushes denormal numbers to zero on this thread until dropped, which restores the previous mode.
pub(crate) struct FlushToZero(u32);

impl FlushToZero {
    pub(crate) fn enter() -> Self {
        const FLUSH_TO_ZERO: u32 = 1 << 15;
        const DENORMALS_ARE_ZERO: u32 = 1 << 6;
        let before = control::get();
        control::set(before | FLUSH_TO_ZERO | DENORMALS_ARE_ZERO);
        Self(before)
    }
}

impl Drop for FlushToZero {
    fn drop(&mut self) {
        control::set(self.0);
    }
}

/// The register that controls floating-point arithmetic.
#[cfg(target_arch = "x86_64")]
mod control {
    use std::arch::asm;

    pub(super) fn get() -> u32 {
        let mut value = 0_u32;
        // SAFETY: this stores the register and nothing else.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut value, options(nostack)) };
        value
    }

    pub(super) fn set(value: u32) {
        // SAFETY: only the two flush-to-zero modes change. Until they are restored, this thread copies and
        // compares numbers but computes none outside Embree.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const value, options(nostack, readonly)) };
    }
}

#[cfg(not(target_arch = "x86_64"))]
mod control {
    pub(super) fn get() -> u32 {
        0
    }

    pub(super) fn set(_: u32) {}
}
