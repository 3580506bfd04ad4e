//! Finds out whether the target has a square root instruction that stable Rust does not announce,
//! whether it computes with floats at all, and whether it multiplies to 64 bits.
//!
//! The RISC-V `f` feature is not in `cfg(target_feature)` on stable; the target's name spells it out.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-check-cfg=cfg(riscv_f, soft_float, narrow_multiply)");
    let target = std::env::var("TARGET").unwrap_or_default();
    let architecture = target.split('-').next().unwrap_or_default();
    let extensions = architecture
        .strip_prefix("riscv32")
        .or_else(|| architecture.strip_prefix("riscv64"))
        .unwrap_or_default();
    // Single letters up to the first multi-letter extension; `g` stands for `imafd`.
    let letters = extensions.split('_').next().unwrap_or_default();
    if letters.contains(['f', 'g']) {
        println!("cargo::rustc-cfg=riscv_f");
    }
    // Each float operation is a call, and code that many places share is worth calling too.
    let arm_without = target.starts_with("thumb") && target.ends_with("-eabi");
    let riscv_without = architecture.starts_with("riscv") && !letters.contains(['f', 'g']);
    if (arm_without || riscv_without) && target.contains("-none-") {
        println!("cargo::rustc-cfg=soft_float");
    }
    // The least of Cortex-M have a 32-bit product and no root.
    if ["thumbv6m", "thumbv8m.base"].contains(&architecture) {
        println!("cargo::rustc-cfg=narrow_multiply");
    }
}
