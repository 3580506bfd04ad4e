//! Cortex-M and RISC-V boards, which talk to QEMU (or a debug probe) by semihosting.

use semihosting::sys::arm_compat;

#[cfg(target_arch = "arm")]
pub use cortex_m_rt as runtime;
#[cfg(target_arch = "riscv32")]
pub use riscv_rt as runtime;

/// Writes one byte of the report.
pub fn put(byte: u8) {
    arm_compat::sys_writec(byte);
}

/// Ends the program with success.
pub fn exit() -> ! {
    semihosting::process::exit(0)
}

/// Makes `$body` what the board runs after reset.
#[macro_export]
macro_rules! entry {
    ($body:block) => {
        #[$crate::platform::runtime::entry]
        fn main() -> ! {
            $body;
            $crate::platform::exit()
        }
    };
}
