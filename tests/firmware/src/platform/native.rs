//! The machine that builds, with an operating system.

use std::io::Write;

/// Writes one byte of the report.
pub fn put(byte: u8) {
    // A report that does not arrive is missed by whoever compares it.
    let _ = std::io::stdout().write_all(&[byte]);
}

/// Makes `$body` the program.
#[macro_export]
macro_rules! entry {
    ($body:block) => {
        #[unsafe(no_mangle)]
        extern "C" fn main() -> i32 {
            $body;
            0
        }
    };
}
