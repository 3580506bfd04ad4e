//! Hands the linker the memory map of the board that a target runs on.

use std::path::PathBuf;
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=boards");
    println!("cargo:rerun-if-env-changed=WHITTED_BOARD");

    let target = env::var("TARGET").expect("cargo sets TARGET");
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
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
}
