//! Instructions, as far as cycles and stacks depend on them.

use std::fmt;

use anyhow::{Context, Result, bail};
use capstone::arch::arm::{ArchMode as ArmMode, ArmOperandType};
use capstone::arch::riscv::{ArchMode as RiscvMode, RiscVOperand};
use capstone::prelude::*;
use object::Architecture;

use super::image::Image;
use super::profile::Place;

/// An instruction of Thumb or RISC-V.
#[derive(Clone, Debug, PartialEq)]
pub struct Instruction {
    /// Where it is.
    pub place: Place,
    /// Without the suffixes for width and type: `ldr`, `vadd`.
    pub mnemonic: String,
    /// As assemblers have them.
    pub operands: String,
    /// In order.
    pub registers: Vec<Register>,
    /// A memory operand's base and index.
    pub address: Option<(Register, Option<Register>)>,
    /// The last number among the operands; of branches, where they lead.
    pub immediate: Option<i64>,
}

/// A register, by its assembler name.
pub type Register = String;

/// What runs after an instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flow {
    /// What follows.
    Next,
    /// Only what is there.
    Jump(u64),
    /// What is there, or what follows.
    Branch(u64),
    /// A function there, then what follows.
    Call(u64),
    /// A function that only the running program knows, then what follows.
    UnknownCall,
    /// A place in the jump table that lies behind the instruction, with entries of so many bytes.
    Table(u64),
    /// A place that only the running program knows.
    UnknownJump,
    /// The caller.
    Return,
    /// Nothing.
    Stop,
}

impl fmt::Display for Instruction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:8x}  {} {}",
            self.place.address, self.mnemonic, self.operands
        )
    }
}

/// Reads instructions of an [`Image`].
pub struct Decoder<'a> {
    image: &'a Image,
    capstone: Capstone,
}

impl<'a> Decoder<'a> {
    /// For the instruction set of the image.
    ///
    /// # Errors
    ///
    /// Where that is neither Arm's Thumb nor 32-bit RISC-V.
    pub fn new(image: &'a Image) -> Result<Self> {
        let capstone = match image.architecture {
            Architecture::Arm => Capstone::new()
                .arm()
                .mode(ArmMode::Thumb)
                .extra_mode([arch::arm::ArchExtraMode::MClass].into_iter())
                .detail(true)
                .build(),
            Architecture::Riscv32 => Capstone::new()
                .riscv()
                .mode(RiscvMode::RiscV32)
                .extra_mode([arch::riscv::ArchExtraMode::RiscVC].into_iter())
                .detail(true)
                .build(),
            other => bail!("cannot read instructions of {other:?}"),
        };
        Ok(Self {
            image,
            capstone: capstone.map_err(|error| anyhow::anyhow!("capstone: {error}"))?,
        })
    }

    /// The instruction at an address.
    ///
    /// # Errors
    ///
    /// Where there is none.
    pub fn at(&self, address: u64) -> Result<Instruction> {
        let bytes = self
            .image
            .bytes(address, 4)
            .or_else(|| self.image.bytes(address, 2));
        let bytes = bytes.with_context(|| format!("no code at {address:#x}"))?;
        self.decode(bytes, address)
            .with_context(|| format!("no instruction at {address:#x}"))
    }

    fn decode(&self, bytes: &[u8], address: u64) -> Option<Instruction> {
        let decoded = self.capstone.disasm_count(bytes, address, 1).ok()?;
        let decoded = decoded.iter().next()?;
        let detail = self.capstone.insn_detail(decoded).ok()?;
        let mnemonic = decoded.mnemonic()?;
        // `add.w`, `vcvt.f32.u32`, `c.addi`.
        let mnemonic = mnemonic.strip_prefix("c.").unwrap_or(mnemonic);
        let mnemonic = mnemonic.split('.').next()?.to_owned();
        let place = Place {
            address,
            size: decoded.bytes().len() as u64,
        };
        let operands = decoded.op_str()?.to_owned();
        let mut instruction = Instruction {
            place,
            mnemonic,
            operands,
            registers: vec![],
            address: None,
            immediate: None,
        };
        let name = |register| self.capstone.reg_name(register);
        let detail = detail.arch_detail();
        if let Some(arm) = detail.arm() {
            for operand in arm.operands() {
                match operand.op_type {
                    ArmOperandType::Reg(register) => instruction.registers.extend(name(register)),
                    ArmOperandType::Imm(value) => instruction.immediate = Some(value.into()),
                    ArmOperandType::Mem(memory) => {
                        instruction.address = Some((name(memory.base())?, name(memory.index())));
                        instruction.immediate.get_or_insert(memory.disp().into());
                    }
                    _ => {}
                }
            }
        }
        if let Some(riscv) = detail.riscv() {
            for operand in riscv.operands() {
                match operand {
                    RiscVOperand::Reg(register) => instruction.registers.extend(name(register)),
                    RiscVOperand::Imm(value) => instruction.immediate = Some(value),
                    RiscVOperand::Mem(memory) => {
                        instruction.address = Some((name(memory.base())?, None));
                        instruction.immediate = Some(memory.disp());
                    }
                    RiscVOperand::Invalid => {}
                }
            }
        }
        Some(instruction)
    }
}

impl Instruction {
    /// What runs next.
    pub fn flow(&self, architecture: Architecture) -> Flow {
        if architecture == Architecture::Arm {
            self.arm_flow()
        } else {
            self.riscv_flow()
        }
    }

    fn arm_flow(&self) -> Flow {
        let target = self.immediate.map(|target| target as u64 & 0xffff_fffe);
        let returns = self
            .registers
            .last()
            .is_some_and(|register| register == "pc");
        match (self.mnemonic.as_str(), target) {
            ("bl" | "blx", Some(target)) => Flow::Call(target),
            ("blx", None) => Flow::UnknownCall,
            ("b", Some(target)) => Flow::Jump(target),
            ("bx", _) if self.registers == ["lr"] => Flow::Return,
            ("bx", _) => Flow::UnknownJump,
            ("tbb", _) => Flow::Table(1),
            ("tbh", _) => Flow::Table(2),
            ("pop" | "ldm", _) if returns => Flow::Return,
            // As LLVM writes `tbb` for the Cortex-M0, which has none.
            ("add", _) if self.registers.first().is_some_and(|to| to == "pc") => Flow::Table(1),
            ("ldr" | "mov", _) if self.registers.first().is_some_and(|to| to == "pc") => {
                Flow::UnknownJump
            }
            ("udf" | "trap", _) => Flow::Stop,
            ("cbz" | "cbnz", Some(target)) => Flow::Branch(target),
            (mnemonic, Some(target)) if is_arm_branch(mnemonic) => Flow::Branch(target),
            _ => Flow::Next,
        }
    }

    fn riscv_flow(&self) -> Flow {
        // Targets are relative.
        let target = self
            .immediate
            .map(|offset| self.place.address.wrapping_add_signed(offset));
        let links = |register: &str| register == "ra" || register == "t0";
        let first = self.registers.first().map_or("", String::as_str);
        match (self.mnemonic.as_str(), target) {
            ("jal", Some(target)) if first.is_empty() || links(first) => Flow::Call(target),
            ("j" | "jal", Some(target)) => Flow::Jump(target),
            ("ret" | "mret", _) => Flow::Return,
            ("unimp", _) => Flow::Stop,
            ("jr", _) if first == "ra" => Flow::Return,
            ("jr", _) => Flow::UnknownJump,
            ("jalr", _) if self.registers.len() == 1 || links(first) => Flow::UnknownCall,
            ("jalr", _) => Flow::UnknownJump,
            (mnemonic, Some(target)) if mnemonic.starts_with('b') => Flow::Branch(target),
            _ => Flow::Next,
        }
    }

    /// How many of the next instructions depend on a condition, if it is Thumb's that says so: `it`, and a
    /// letter for each but the first. Decoded alone, those do not show it.
    pub fn makes_conditional(&self) -> Option<usize> {
        let rest = self.mnemonic.strip_prefix("it")?;
        let is_it = rest.bytes().all(|letter| matches!(letter, b't' | b'e'));
        is_it.then_some(1 + rest.len())
    }

    /// How many bytes it moves the stack pointer down; negative: up. `None` where that cannot be told.
    pub fn stack_growth(&self, architecture: Architecture) -> Option<i64> {
        if architecture == Architecture::Arm {
            self.arm_stack_growth()
        } else {
            self.riscv_stack_growth()
        }
    }

    fn arm_stack_growth(&self) -> Option<i64> {
        let bytes = self
            .registers
            .iter()
            .map(|register| if register.starts_with('d') { 8 } else { 4 });
        let list: i64 = bytes.sum();
        let first_is_sp = self
            .registers
            .first()
            .is_some_and(|register| register == "sp");
        match self.mnemonic.as_str() {
            "push" | "vpush" => Some(list),
            "pop" | "vpop" => Some(-list),
            // With writeback the base is the first register.
            "stmdb" | "vstmdb" if first_is_sp => Some(list - 4),
            "ldm" | "vldmia" if first_is_sp && self.operands.contains('!') => Some(4 - list),
            "ldm" | "stm" | "vldmia" | "vstmia" if !self.operands.contains('!') => Some(0),
            "sub" | "subw" if first_is_sp && self.moves_sp_by_immediate() => self.immediate,
            "add" | "addw" if first_is_sp && self.moves_sp_by_immediate() => Some(-self.immediate?),
            _ if self.address.as_ref().is_some_and(|(base, _)| base == "sp") => {
                let writes_back = self.operands.ends_with('!');
                let moves_after = self.operands.contains("], #");
                if writes_back || moves_after {
                    Some(-self.immediate?)
                } else {
                    Some(0)
                }
            }
            // Comparing and storing name it first without moving it.
            "cmp" | "cmn" | "tst" | "str" | "strb" | "strh" | "strd" => Some(0),
            _ if first_is_sp => None,
            _ => Some(0),
        }
    }

    fn moves_sp_by_immediate(&self) -> bool {
        self.immediate.is_some() && self.registers.iter().all(|register| register == "sp")
    }

    fn riscv_stack_growth(&self) -> Option<i64> {
        let first_is_sp = self
            .registers
            .first()
            .is_some_and(|register| register == "sp");
        match self.mnemonic.as_str() {
            "addi" | "addi16sp" if first_is_sp && self.moves_sp_by_immediate() => {
                Some(-self.immediate?)
            }
            "sw" | "sb" | "sh" | "fsw" | "swsp" | "fswsp" | "beq" | "bne" | "blt" | "bge"
            | "bltu" | "bgeu" => Some(0),
            _ if first_is_sp => None,
            _ => Some(0),
        }
    }
}

/// A conditional branch: `beq` and its like.
fn is_arm_branch(mnemonic: &str) -> bool {
    const CONDITIONS: [&str; 16] = [
        "eq", "ne", "hs", "lo", "cs", "cc", "mi", "pl", "vs", "vc", "hi", "ls", "ge", "lt", "gt",
        "le",
    ];
    mnemonic
        .strip_prefix('b')
        .is_some_and(|condition| CONDITIONS.contains(&condition))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decode(architecture: Architecture, code: &[u8]) -> Instruction {
        let image = Image::of_code(architecture, code);
        Decoder::new(&image).unwrap().at(0).unwrap()
    }

    #[test]
    fn thumb_moves_the_stack_pointer() {
        let cases: [(&str, &[u8], Option<i64>); 14] = [
            ("push {r4-r7, lr}", &[0xf0, 0xb5], Some(20)),
            ("pop {r4-r7, pc}", &[0xf0, 0xbd], Some(-20)),
            ("vpush {d8-d10}", &[0x2d, 0xed, 0x06, 0x8b], Some(24)),
            ("vpop {d8-d10}", &[0xbd, 0xec, 0x06, 0x8b], Some(-24)),
            (
                "strd r0, r1, [sp, #-16]!",
                &[0x6d, 0xe9, 0x04, 0x01],
                Some(16),
            ),
            ("str r0, [sp, #-8]!", &[0x4d, 0xf8, 0x08, 0x0d], Some(8)),
            ("ldr r0, [sp], #8", &[0x5d, 0xf8, 0x08, 0x0b], Some(-8)),
            ("sub sp, #16", &[0x84, 0xb0], Some(16)),
            ("sub.w sp, sp, #1024", &[0xad, 0xf5, 0x80, 0x6d], Some(1024)),
            ("addw sp, sp, #4", &[0x0d, 0xf2, 0x04, 0x0d], Some(-4)),
            ("stmdb sp!, {r4, r5}", &[0x2d, 0xe9, 0x30, 0x00], Some(8)),
            ("str r2, [r1, #8]", &[0x8a, 0x60], Some(0)),
            ("mov sp, r7", &[0xbd, 0x46], None),
            ("sub.w sp, sp, r4", &[0xad, 0xeb, 0x04, 0x0d], None),
        ];
        for (name, code, growth) in cases {
            let instruction = decode(Architecture::Arm, code);
            assert_eq!(
                instruction.stack_growth(Architecture::Arm),
                growth,
                "{name}: {instruction:?}"
            );
        }
    }

    #[test]
    fn thumb_flows() {
        let cases: [(&str, &[u8], Flow); 10] = [
            ("bl -84", &[0xff, 0xf7, 0xd4, 0xff], Flow::Call(0xffff_ffac)),
            ("beq -88", &[0xd2, 0xd0], Flow::Branch(0xffff_ffa8)),
            ("b +4", &[0x00, 0xe0], Flow::Jump(4)),
            ("cbz r0, +8", &[0x10, 0xb1], Flow::Branch(8)),
            ("blx r3", &[0x98, 0x47], Flow::UnknownCall),
            ("bx lr", &[0x70, 0x47], Flow::Return),
            ("pop {r4-r7, pc}", &[0xf0, 0xbd], Flow::Return),
            ("tbb [pc, r0]", &[0xdf, 0xe8, 0x00, 0xf0], Flow::Table(1)),
            ("add pc, r5", &[0xaf, 0x44], Flow::Table(1)),
            ("bics r0, r1", &[0x88, 0x43], Flow::Next),
        ];
        for (name, code, flow) in cases {
            let instruction = decode(Architecture::Arm, code);
            assert_eq!(
                instruction.flow(Architecture::Arm),
                flow,
                "{name}: {instruction:?}"
            );
        }
    }

    #[test]
    fn thumb_conditions_reach_as_far_as_their_letters() {
        let conditional = |code| decode(Architecture::Arm, code).makes_conditional();
        assert_eq!(conditional(&[0x08, 0xbf]), Some(1), "it eq");
        assert_eq!(conditional(&[0x02, 0xbf]), Some(3), "ittt eq");
        assert_eq!(conditional(&[0x70, 0x47]), None, "bx lr");
    }

    #[test]
    fn riscv_moves_the_stack_pointer_and_flows() {
        let riscv = Architecture::Riscv32;
        let cases: [(&str, &[u8], Option<i64>, Flow); 10] = [
            (
                "addi sp, sp, -16",
                &[0x13, 0x01, 0x01, 0xff],
                Some(16),
                Flow::Next,
            ),
            ("c.addi sp, -16", &[0x41, 0x11], Some(16), Flow::Next),
            ("c.addi16sp sp, 64", &[0x21, 0x61], Some(-64), Flow::Next),
            ("c.swsp ra, 12(sp)", &[0x06, 0xc6], Some(0), Flow::Next),
            (
                "addi sp, s0, -16",
                &[0x13, 0x01, 0x04, 0xff],
                None,
                Flow::Next,
            ),
            ("c.jal +240", &[0xc5, 0x28], Some(0), Flow::Call(240)),
            ("ret", &[0x82, 0x80], Some(0), Flow::Return),
            ("c.jr t1", &[0x02, 0x83], Some(0), Flow::UnknownJump),
            ("c.jalr t1", &[0x02, 0x93], Some(0), Flow::UnknownCall),
            (
                "beq a0, a1, -26",
                &[0xe3, 0x03, 0xb5, 0xfe],
                Some(0),
                Flow::Branch(0xffff_ffff_ffff_ffe6),
            ),
        ];
        for (name, code, growth, flow) in cases {
            let instruction = decode(riscv, code);
            assert_eq!(
                instruction.stack_growth(riscv),
                growth,
                "{name}: {instruction:?}"
            );
            assert_eq!(instruction.flow(riscv), flow, "{name}: {instruction:?}");
        }
    }
}
