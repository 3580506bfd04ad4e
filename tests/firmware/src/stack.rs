//! How deep the stack has been, found by painting it.

/// Bytes below the painter that are watched: more than any program here uses.
const WATCHED: usize = 8 * 1024;
const PAINT: u32 = 0x5AA5_C33C;

/// A painted stretch of stack.
pub struct Paint {
    top: *mut u32,
}

impl Paint {
    /// Paints all that lies below the caller's frame.
    #[inline(always)]
    pub fn below_here() -> Self {
        let top = stack_pointer();
        for word in 1..=WATCHED / 4 {
            // SAFETY: RAM below the stack pointer that nothing owns; every board has more free.
            unsafe { top.sub(word).write_volatile(PAINT) };
        }
        Self { top }
    }

    /// Bytes from the caller's stack pointer, when it painted, to the lowest word written since.
    #[inline(always)]
    pub fn depth(&self) -> usize {
        let mut bytes = WATCHED;
        // SAFETY: as above.
        while bytes > 0 && unsafe { self.top.sub(bytes / 4).read_volatile() } == PAINT {
            bytes -= 4;
        }
        bytes
    }
}

#[inline(always)]
fn stack_pointer() -> *mut u32 {
    let pointer;
    // SAFETY: reads a register.
    unsafe {
        #[cfg(target_arch = "arm")]
        core::arch::asm!("mov {}, sp", out(reg) pointer, options(nomem, nostack, preserves_flags));
        #[cfg(target_arch = "riscv32")]
        core::arch::asm!("mv {}, sp", out(reg) pointer, options(nomem, nostack, preserves_flags));
    }
    pointer
}
