//! Denormal numbers as zero, as Embree recommends.
#![allow(unsafe_code, reason = "the register is only reached by assembly")]

/// Denormal numbers count as zero while this lives; then the thread's mode is restored.
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
        // SAFETY: it stores the register and nothing else.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut value, options(nostack)) };
        value
    }

    pub(super) fn set(value: u32) {
        // SAFETY: only modes of rounding to zero are changed, and until they are restored this
        // thread copies and compares numbers but computes none outside Embree.
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
