//! Hands the linker the memory map of the board that a target runs on.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=boards");
    println!("cargo:rerun-if-env-changed=WHITTED_BOARD");

    let target = env::var("TARGET").expect("cargo sets TARGET");
    if env::var_os("CARGO_FEATURE_LIBGCC").is_some() {
        link_libgcc(&target);
    }
    let usual_board = match target.as_str() {
        "thumbv6m-none-eabi" => "microbit",
        "thumbv8m.main-none-eabihf" => "an505",
        _ if target.starts_with("thumb") => "mps2",
        _ if target.starts_with("riscv32") => "virt",
        // wasm has no memory map.
        _ => return,
    };
    let board = env::var("WHITTED_BOARD").unwrap_or_else(|_| usual_board.into());

    let out_dir = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let map = format!("boards/{board}.x");
    fs::copy(&map, out_dir.join("memory.x")).unwrap_or_else(|error| panic!("{map}: {error}"));
    println!("cargo:rustc-link-search={}", out_dir.display());
    // Sections in flash need no alignment to pages.
    println!("cargo:rustc-link-arg=--nmagic");
    println!("cargo:rustc-link-arg=-Tlink.x");
}

/// GCC's soft float is faster than the one in `compiler_builtins`, to the same bits. The linker takes
/// each routine from the library that it meets first, which is this one.
fn link_libgcc(target: &str) {
    let cpu = match target {
        "thumbv6m-none-eabi" => "cortex-m0",
        "thumbv7m-none-eabi" => "cortex-m3",
        _ => panic!("the feature libgcc is for Arm without FPU, not for {target}"),
    };
    let output = Command::new("arm-none-eabi-gcc")
        .args([
            &format!("-mcpu={cpu}"),
            "-mthumb",
            "-print-libgcc-file-name",
        ])
        .output()
        .expect("the feature libgcc needs arm-none-eabi-gcc");
    let library = String::from_utf8(output.stdout).expect("a path in UTF-8");
    let directory = Path::new(library.trim())
        .parent()
        .expect("a path with a directory");
    println!("cargo:rustc-link-search=native={}", directory.display());
    println!("cargo:rustc-link-lib=static:-bundle=gcc");
}
