//! The parts that firmware is built for, and what runs it.

/// A part, and the machine that stands in for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Target {
    /// What the tables call it.
    pub name: &'static str,
    /// rustc's name of what it is compiled for.
    pub triple: &'static str,
    /// Compiler flags beyond those in the firmware's `.cargo/config.toml`.
    pub rustflags: &'static [&'static str],
    /// Where its programs run.
    pub machine: Machine,
}

/// What runs a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Machine {
    /// A board in QEMU: the emulator's name and its arguments.
    Qemu(&'static str, &'static [&'static str]),
    /// A WebAssembly module in Node.
    Node,
    /// This machine, by itself.
    Native,
}

const ARM: &str = "qemu-system-arm";
const RISCV: &str = "qemu-system-riscv32";

/// The Cortex-M4F, for which cycles are estimated.
pub const CORTEX_M4F: Target = Target {
    name: "Cortex-M4F",
    triple: "thumbv7em-none-eabihf",
    rustflags: &[],
    machine: Machine::Qemu(ARM, &["-machine", "mps2-an386"]),
};

/// The Cortex-M0: no FPU, and the smallest instruction set.
pub const CORTEX_M0: Target = Target {
    name: "Cortex-M0",
    triple: "thumbv6m-none-eabi",
    rustflags: &[],
    machine: Machine::Qemu(ARM, &["-machine", "microbit"]),
};

/// The Cortex-M3: no FPU.
pub const CORTEX_M3: Target = Target {
    name: "Cortex-M3",
    triple: "thumbv7m-none-eabi",
    rustflags: &[],
    machine: Machine::Qemu(ARM, &["-machine", "mps2-an385"]),
};

/// The machine that builds; unlike the tests that run on it, optimised.
pub const HOST: Target = Target {
    name: "host",
    triple: "host",
    rustflags: &[],
    machine: Machine::Native,
};

/// All parts.
pub const TARGETS: [Target; 8] = [
    CORTEX_M0,
    CORTEX_M3,
    CORTEX_M4F,
    Target {
        name: "Cortex-M7",
        triple: "thumbv7em-none-eabihf",
        rustflags: &["-Ctarget-cpu=cortex-m7"],
        machine: Machine::Qemu(ARM, &["-machine", "mps2-an500", "-cpu", "cortex-m7"]),
    },
    Target {
        name: "Cortex-M33",
        triple: "thumbv8m.main-none-eabihf",
        rustflags: &[],
        machine: Machine::Qemu(ARM, &["-machine", "mps2-an505"]),
    },
    Target {
        name: "RV32IMAC",
        triple: "riscv32imac-unknown-none-elf",
        rustflags: &[],
        machine: Machine::Qemu(RISCV, &["-machine", "virt", "-bios", "none"]),
    },
    Target {
        name: "RV32IMAFC",
        triple: "riscv32imafc-unknown-none-elf",
        rustflags: &[],
        machine: Machine::Qemu(RISCV, &["-machine", "virt", "-bios", "none"]),
    },
    Target {
        name: "wasm32",
        triple: "wasm32-unknown-unknown",
        rustflags: &[],
        machine: Machine::Node,
    },
];

impl Target {
    /// The one of this name.
    pub fn named(name: &str) -> Option<Self> {
        TARGETS
            .into_iter()
            .find(|target| target.name.eq_ignore_ascii_case(name))
    }

    /// Whether single-precision arithmetic is done by instructions.
    pub fn has_fpu(&self) -> bool {
        self.triple.ends_with("hf")
            || self.triple.contains("imaf")
            || self.triple.starts_with("wasm")
    }
}
