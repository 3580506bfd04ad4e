//! Cycles on a Cortex-M4F, estimated from counted instructions.
//!
//! A model, not hardware: Arm, "Cortex-M4 Technical Reference Manual" (DDI 0439), tables of
//! instruction set cycles in chapters 3 and 7 and "Load/store timings", with memory that answers at
//! once. What the manual gives as a range is one number here: [`REFILL`] and [`DIVIDE`]. What it says
//! might happen (a fetch that collides with a load of a literal, an IT folded into the instruction
//! before it) does not. An instruction whose condition is false costs what it costs when it is true.

use std::collections::BTreeMap;

use anyhow::Result;

use super::image::Image;
use super::instructions::{Decoder, Instruction};
use super::profile::{Place, Profile};

/// Cycles to refill the pipeline after a taken branch; the manual says 1 to 3.
pub const REFILL: u64 = 2;
/// Cycles of an integer division; the manual says 2 to 12.
pub const DIVIDE: u64 = 7;

/// What a profile's cycles went into. All are sums over the profile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cycles {
    /// Instructions by themselves.
    pub issue: u64,
    /// Refilled pipelines.
    pub refill: u64,
    /// Waiting for a float result that the next instruction needs.
    pub float_wait: u64,
    /// Waiting for an address that the instruction before computed.
    pub address_wait: u64,
    /// Cycles that a load or store saves by coming right after a load.
    pub saved: u64,
}

impl Cycles {
    /// Of all kinds together.
    pub fn total(&self) -> u64 {
        self.issue + self.refill + self.float_wait + self.address_wait - self.saved
    }
}

impl std::ops::AddAssign for Cycles {
    fn add_assign(&mut self, other: Self) {
        self.issue += other.issue;
        self.refill += other.refill;
        self.float_wait += other.float_wait;
        self.address_wait += other.address_wait;
        self.saved += other.saved;
    }
}

/// Prices each instruction of a profile; waits count for the instruction that waits, a refill for the
/// branch that caused it.
///
/// # Errors
///
/// Where the profile is not of the image.
pub fn price(image: &Image, profile: &Profile) -> Result<BTreeMap<Place, Cycles>> {
    let decoder = Decoder::new(image)?;
    let mut timings = BTreeMap::new();
    let mut prices: BTreeMap<Place, Cycles> = BTreeMap::new();
    for (&place, &times) in &profile.instructions {
        let timing = Timing::of(&decoder.at(place.address)?);
        prices.entry(place).or_default().issue += times * timing.cycles;
        timings.insert(place, timing);
    }
    for (&(first, second), &times) in &profile.steps {
        if first.address + first.size != second.address {
            prices.entry(first).or_default().refill += times * REFILL;
            continue;
        }
        // The last step of a profile leads out of it.
        if let (Some(first), Some(next)) = (timings.get(&first), timings.get(&second)) {
            let price = prices.entry(second).or_default();
            price.float_wait += times * u64::from(first.float_result & next.float_operands != 0);
            price.address_wait += times * u64::from(first.integer_result & next.address != 0);
            let waits_for_load = first.loaded & next.address != 0;
            let pipelined = first.is_load && next.is_single && next.cycles > 1 && !waits_for_load;
            price.saved += times * u64::from(pipelined);
        }
    }
    Ok(prices)
}

/// Sum over a profile.
///
/// # Errors
///
/// As [`price`].
pub fn total(image: &Image, profile: &Profile) -> Result<Cycles> {
    let mut total = Cycles::default();
    for cycles in price(image, profile)?.into_values() {
        total += cycles;
    }
    Ok(total)
}

/// Sets of registers: bits 0 to 15 for r0 to r15, 16 to 47 for s0 to s31.
type Registers = u64;

/// An instruction's cycles, and what its neighbours' depend on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Timing {
    cycles: u64,
    /// Loads one register: a load or store right after it can overlap with it.
    is_load: bool,
    /// Loads or stores one register.
    is_single: bool,
    loaded: Registers,
    /// Registers that data processing writes.
    integer_result: Registers,
    /// Registers from which an address is computed.
    address: Registers,
    float_result: Registers,
    /// Float registers that are needed at once; an accumulator is needed a cycle later.
    float_operands: Registers,
}

impl Timing {
    fn of(instruction: &Instruction) -> Self {
        let registers: Vec<Registers> =
            instruction.registers.iter().map(|name| set(name)).collect();
        let list = registers
            .iter()
            .map(|register| u64::from(register.count_ones()))
            .sum::<u64>();
        let destination = registers.first().copied().unwrap_or_default();
        let sources = registers
            .iter()
            .skip(1)
            .fold(0, |all, register| all | register);
        let (base, index) = instruction
            .address
            .as_ref()
            .map_or((0, None), |(base, index)| {
                (
                    set(base),
                    index.as_deref().map(set).filter(|&index| index != 0),
                )
            });
        let address = base | index.unwrap_or_default();
        let plain = Self {
            cycles: 1,
            ..Self::default()
        };
        let arithmetic = Self {
            float_result: destination,
            float_operands: sources,
            ..plain
        };
        let single = Self {
            is_single: true,
            address,
            ..plain
        };
        match instruction.mnemonic.as_str() {
            "ldr" | "ldrb" | "ldrh" | "ldrsb" | "ldrsh" => Self {
                cycles: 2,
                is_load: true,
                loaded: destination,
                ..single
            },
            // The store itself overlaps with what follows.
            "str" | "strb" | "strh" if index.is_none() => single,
            "str" | "strb" | "strh" => Self {
                cycles: 2,
                ..single
            },
            "ldrd" | "strd" => Self {
                cycles: 3,
                address,
                ..plain
            },
            "push" | "pop" => Self {
                cycles: 1 + list,
                ..plain
            },
            // The base is the first register.
            "ldm" | "stm" | "ldmdb" | "stmdb" => Self {
                cycles: list,
                address: destination,
                ..plain
            },
            "mla" | "mls" => Self {
                cycles: 2,
                integer_result: destination,
                ..plain
            },
            "sdiv" | "udiv" => Self {
                cycles: DIVIDE,
                integer_result: destination,
                ..plain
            },
            "tbb" | "tbh" => Self { cycles: 2, ..plain },
            "vldr" => Self {
                cycles: 1 + u64::from(destination.count_ones()),
                is_load: true,
                ..single
            },
            "vstr" => Self {
                cycles: 1 + u64::from(destination.count_ones()),
                float_operands: destination,
                ..single
            },
            "vpush" | "vpop" => Self {
                cycles: 1 + list,
                ..plain
            },
            "vldmia" | "vstmia" | "vldmdb" | "vstmdb" => Self {
                cycles: list,
                address: destination,
                ..plain
            },
            "vdiv" | "vsqrt" => Self {
                cycles: 14,
                ..arithmetic
            },
            // All but the accumulator is needed at once.
            "vmla" | "vmls" | "vnmla" | "vnmls" | "vfma" | "vfms" | "vfnma" | "vfnms" => Self {
                cycles: 3,
                ..arithmetic
            },
            "vadd" | "vsub" | "vmul" | "vnmul" | "vcvt" | "vcvtr" => arithmetic,
            "vcmp" | "vcmpe" => Self {
                float_operands: destination | sources,
                ..plain
            },
            // Between two pairs of registers it takes a cycle each.
            "vmov" => Self {
                cycles: if registers.len() > 2 { 2 } else { 1 },
                float_operands: sources,
                ..plain
            },
            "vabs" | "vneg" => Self {
                float_operands: sources,
                ..plain
            },
            mnemonic if mnemonic.starts_with(['b', 'c']) && is_control(mnemonic) => plain,
            _ => Self {
                integer_result: destination,
                ..plain
            },
        }
    }
}

/// Branches and comparisons, whose first register is no result.
fn is_control(mnemonic: &str) -> bool {
    !matches!(mnemonic, "bic" | "bics" | "bfi" | "bfc" | "clz")
}

fn set(name: &str) -> Registers {
    let numbered = |prefix| name.strip_prefix(prefix)?.parse::<u32>().ok();
    if let Some(number) = numbered('r') {
        return 1 << number;
    }
    if let Some(number) = numbered('s') {
        return 1 << (16 + number);
    }
    if let Some(number) = numbered('d') {
        return 0b11 << (16 + 2 * number);
    }
    match name {
        "sb" => 1 << 9,
        "sl" => 1 << 10,
        "fp" => 1 << 11,
        "ip" => 1 << 12,
        "sp" => 1 << 13,
        "lr" => 1 << 14,
        "pc" => 1 << 15,
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use object::Architecture;

    use super::*;

    /// Straight code that ran once.
    fn cycles_of(code: &[u8]) -> Cycles {
        let image = Image::of_code(Architecture::Arm, code);
        let decoder = Decoder::new(&image).unwrap();
        let (mut profile, mut address, mut previous) = (Profile::default(), 0, None);
        while address < code.len() as u64 {
            let place = decoder.at(address).unwrap().place;
            profile.instructions.insert(place, 1);
            if let Some(previous) = previous.replace(place) {
                profile.steps.insert((previous, place), 1);
            }
            address += place.size;
        }
        total(&image, &profile).unwrap()
    }

    const ADD_S0: [u8; 4] = [0x30, 0xee, 0x81, 0x0a]; // vadd.f32 s0, s1, s2
    const MULTIPLY_S0: [u8; 4] = [0x60, 0xee, 0x00, 0x1a]; // vmul.f32 s3, s0, s0
    const ACCUMULATE_S0: [u8; 4] = [0x00, 0xee, 0xa2, 0x0a]; // vmla.f32 s0, s1, s5
    const LOAD_R0: [u8; 2] = [0x08, 0x68]; // ldr r0, [r1]
    const LOAD_R2: [u8; 2] = [0x4a, 0x68]; // ldr r2, [r1, #4]
    const LOAD_BY_R0: [u8; 2] = [0x02, 0x68]; // ldr r2, [r0]
    const STORE_R2: [u8; 2] = [0x8a, 0x60]; // str r2, [r1, #8]
    const ADVANCE_R1: [u8; 2] = [0x04, 0x31]; // adds r1, #4

    #[test]
    fn single_instructions_cost_what_the_manual_says() {
        let cases: [(&str, &[u8], u64); 15] = [
            ("vadd.f32 s0, s1, s2", &ADD_S0, 1),
            ("vmla.f32 s0, s1, s5", &ACCUMULATE_S0, 3),
            ("vdiv.f32 s5, s3, s4", &[0xc1, 0xee, 0x82, 0x2a], 14),
            ("vsqrt.f32 s0, s0", &[0xb1, 0xee, 0xc0, 0x0a], 14),
            ("ldr r0, [r1]", &LOAD_R0, 2),
            ("str r2, [r1, #8]", &STORE_R2, 1),
            ("str r0, [r1, r2]", &[0x88, 0x50], 2),
            ("push {r4-r7, lr}", &[0xf0, 0xb5], 6),
            ("vpush {d8-d10}", &[0x2d, 0xed, 0x06, 0x8b], 7),
            ("vldmia r0!, {s0-s3}", &[0xb0, 0xec, 0x04, 0x0a], 5),
            ("vldr s0, [r0]", &[0x90, 0xed, 0x00, 0x0a], 2),
            ("vmov r0, r1, d0", &[0x51, 0xec, 0x10, 0x0b], 2),
            ("mla r0, r1, r2, r3", &[0x01, 0xfb, 0x02, 0x30], 2),
            ("umull r0, r1, r2, r3", &[0xa2, 0xfb, 0x03, 0x01], 1),
            ("adds r1, #4", &ADVANCE_R1, 1),
        ];
        for (name, code, cycles) in cases {
            assert_eq!(cycles_of(code).total(), cycles, "{name}");
        }
    }

    #[test]
    fn neighbours_wait_for_each_other_and_overlap() {
        let cases: [(&str, Vec<u8>, u64); 8] = [
            ("a result that is needed", [ADD_S0, MULTIPLY_S0].concat(), 3),
            (
                "a result that is overwritten",
                [MULTIPLY_S0, ADD_S0].concat(),
                2,
            ),
            (
                "a result that is added to",
                [ADD_S0, ACCUMULATE_S0].concat(),
                4,
            ),
            ("two loads", [LOAD_R0, LOAD_R2].concat(), 3),
            (
                "a load whose address was loaded",
                [LOAD_R0, LOAD_BY_R0].concat(),
                4,
            ),
            ("a load and a store", [LOAD_R0, STORE_R2].concat(), 3),
            (
                "a load whose address was computed",
                [ADVANCE_R1, LOAD_R0].concat(),
                4,
            ),
            ("three loads", [LOAD_R0, LOAD_R2, LOAD_R2].concat(), 4),
        ];
        for (name, code, cycles) in cases {
            assert_eq!(cycles_of(&code).total(), cycles, "{name}");
        }
    }

    #[test]
    fn taken_branches_refill_the_pipeline() {
        let image = Image::of_code(Architecture::Arm, &[0xfe, 0xe7]); // b to itself
        let place = Place {
            address: 0,
            size: 2,
        };
        let profile = Profile {
            calls: 1,
            instructions: [(place, 10)].into(),
            steps: [((place, place), 10)].into(),
        };
        assert_eq!(total(&image, &profile).unwrap().total(), 10 + 10 * REFILL);
    }
}
