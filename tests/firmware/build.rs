//! Hands the linker the memory map of the board that a target runs on.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

fn main() {
    println!("cargo:rerun-if-changed=boards");
    println!("cargo:rerun-if-env-changed=WHITTED_BOARD");

    let target = env::var("TARGET").expect("cargo sets TARGET");
    println!("cargo:rustc-check-cfg=cfg(native)");
    if env::var("HOST").is_ok_and(|host| host == target) {
        println!("cargo:rustc-cfg=native");
    }
    let has_feature = |name| env::var_os(format!("CARGO_FEATURE_{name}")).is_some();
    if has_feature("PEER") && target.starts_with("thumb") {
        for scene in ["six-spheres", "c-ray", "tiny"] {
            compile_peer(&target, scene);
        }
    }
    if has_feature("LIBGCC") {
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

/// GCC's name of the part, and how it hands floats around.
fn gcc_part(target: &str) -> &'static [&'static str] {
    let flags = env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
    match target {
        "thumbv6m-none-eabi" => &["-mcpu=cortex-m0"],
        "thumbv7m-none-eabi" => &["-mcpu=cortex-m3"],
        "thumbv7em-none-eabihf" if flags.contains("cortex-m7") => {
            &["-mcpu=cortex-m7", "-mfpu=fpv5-sp-d16", "-mfloat-abi=hard"]
        }
        "thumbv7em-none-eabihf" => &["-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"],
        "thumbv8m.main-none-eabihf" => {
            &["-mcpu=cortex-m33", "-mfpu=fpv5-sp-d16", "-mfloat-abi=hard"]
        }
        _ => panic!("arm-none-eabi-gcc does not compile for {target}"),
    }
}

/// Compiles a scene's plain C and links it into its program.
fn compile_peer(target: &str, scene: &str) {
    println!("cargo:rerun-if-changed=peer");
    let out_dir = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let object = out_dir.join(format!("{scene}.o"));
    let status = Command::new("arm-none-eabi-gcc")
        .args(gcc_part(target))
        .args(["-mthumb", "-O3", "-ffp-contract=off", "-fno-math-errno"])
        .args([
            "-std=c11",
            "-ffreestanding",
            "-Wall",
            "-Wextra",
            "-Werror",
            "-c",
            "-o",
        ])
        .arg(&object)
        .arg(format!("peer/{scene}.c"))
        .status()
        .expect("the feature peer needs arm-none-eabi-gcc");
    assert!(status.success(), "peer/{scene}.c");
    println!("cargo:rustc-link-arg-bin={scene}-in-c={}", object.display());
}

/// GCC's soft float is faster than the one in `compiler_builtins`, to the same bits. The linker takes
/// each routine from the library that it meets first, which is this one.
fn link_libgcc(target: &str) {
    let output = Command::new("arm-none-eabi-gcc")
        .args(gcc_part(target))
        .args(["-mthumb", "-print-libgcc-file-name"])
        .output()
        .expect("the feature libgcc needs arm-none-eabi-gcc");
    let library = String::from_utf8(output.stdout).expect("a path in UTF-8");
    let directory = Path::new(library.trim())
        .parent()
        .expect("a path with a directory");
    println!("cargo:rustc-link-search=native={}", directory.display());
    println!("cargo:rustc-link-lib=static:-bundle=gcc");
}
