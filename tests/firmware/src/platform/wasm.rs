//! WebAssembly, whose host calls `run` and hands in where the report goes.

/// Writes one byte of the report.
pub fn put(byte: u8) {
    #[link(wasm_import_module = "host")]
    unsafe extern "C" {
        #[link_name = "put"]
        safe fn host_put(byte: u32);
    }
    host_put(byte.into());
}

/// Exports `$body` as `run`.
#[macro_export]
macro_rules! entry {
    ($body:block) => {
        /// Draws the frame and reports.
        #[unsafe(no_mangle)]
        pub extern "C" fn run() {
            $body;
        }
    };
}
