//! The most stack that a function can take, from the code alone.
//!
//! Every path through every function that can be called is followed, and the depth of the stack
//! pointer carried along; where paths meet, they must agree. Recursion, calls of functions that only
//! the running program knows, and stack pointers that are computed have no such bound: they are errors.

use std::collections::BTreeMap;
use std::ops::Range;

use anyhow::{Result, bail};

use super::image::Image;
use super::instructions::{Decoder, Flow, Instruction};

/// A function's bound.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bound {
    /// Below the stack pointer at the call.
    pub bytes: u64,
    /// The calls that get there: functions, and what each has on the stack by then.
    pub path: Vec<(String, u64)>,
}

/// The most stack that a call of `symbol` takes.
///
/// # Errors
///
/// Where there is no bound that the code shows.
pub fn bound(image: &Image, symbol: &str) -> Result<Bound> {
    let mut search = Search {
        image,
        decoder: Decoder::new(image)?,
        known: BTreeMap::new(),
    };
    search.bound(image.address(symbol)?, &mut Vec::new())
}

struct Search<'a> {
    image: &'a Image,
    decoder: Decoder<'a>,
    known: BTreeMap<u64, Bound>,
}

impl Search<'_> {
    fn bound(&mut self, start: u64, callers: &mut Vec<u64>) -> Result<Bound> {
        if let Some(known) = self.known.get(&start) {
            return Ok(known.clone());
        }
        let name = self.name(start);
        if callers.contains(&start) {
            let names: Vec<String> = callers.iter().map(|&caller| self.name(caller)).collect();
            bail!("recursion: {} > {name}", names.join(" > "));
        }
        callers.push(start);
        let own = self.walk(start)?;
        let mut worst = Bound {
            bytes: own.deepest,
            path: vec![(name.clone(), own.deepest)],
        };
        for (callee, depth) in own.calls {
            let below = self.bound(callee, callers)?;
            if depth + below.bytes > worst.bytes {
                let path = [(name.clone(), depth)]
                    .into_iter()
                    .chain(below.path)
                    .collect();
                worst = Bound {
                    bytes: depth + below.bytes,
                    path,
                };
            }
        }
        callers.pop();
        self.known.insert(start, worst.clone());
        Ok(worst)
    }

    fn name(&self, address: u64) -> String {
        self.image.function_at(address).map_or_else(
            || format!("{address:#x}"),
            |(_, function)| function.symbol.clone(),
        )
    }

    /// One function, its callees left out.
    fn walk(&self, start: u64) -> Result<Walk> {
        let Some((function_start, function)) = self.image.function_at(start) else {
            bail!("no function at {start:#x}");
        };
        let inside = function_start..function_start + function.size;
        let mut walk = Walk::default();
        // With each place, how many instructions from there on are conditional.
        let mut waiting = vec![(start, 0, Values::default(), 0_usize)];
        while let Some((address, depth, mut values, conditional)) = waiting.pop() {
            if !inside.contains(&address) {
                // Called last: its frame takes this one's place.
                walk.call(address, depth);
                continue;
            }
            let name = &function.symbol;
            if let Some(&known) = walk.depths.get(&address) {
                if known != depth {
                    bail!("{name} has {known} or {depth} bytes on the stack at {address:#x}");
                }
                continue;
            }
            walk.depths.insert(address, depth);
            let instruction = self.decoder.at(address)?;
            let after = match instruction.stack_growth(self.image.architecture) {
                Some(growth) => depth.checked_add_signed(growth),
                None => values.stack_after(&instruction, depth),
            };
            let Some(after) = after else {
                bail!("{name} moves its stack pointer in an unknown way: {instruction}");
            };
            walk.deepest = walk.deepest.max(after);
            let flow = values.resolve(&instruction, instruction.flow(self.image.architecture));
            if flow == Flow::Return && after != 0 {
                bail!("{name} returns with {after} bytes on the stack: {instruction}");
            }
            let targets = self.follow(&instruction, flow, after, &inside, &mut walk)?;
            if conditional > 0 && matches!(flow, Flow::Return | Flow::Jump(_)) {
                // Or not.
                let next = instruction.place.address + instruction.place.size;
                waiting.push((next, depth, values.clone(), conditional - 1));
            }
            values.update(&instruction, depth, self.image);
            let conditional = instruction
                .makes_conditional()
                .unwrap_or(conditional.saturating_sub(1));
            waiting.extend(
                targets
                    .into_iter()
                    .map(|target| (target, after, values.clone(), conditional)),
            );
        }
        Ok(walk)
    }

    /// Where an instruction leads within its function, or last.
    fn follow(
        &self,
        instruction: &Instruction,
        flow: Flow,
        depth: u64,
        inside: &Range<u64>,
        walk: &mut Walk,
    ) -> Result<Vec<u64>> {
        let next = instruction.place.address + instruction.place.size;
        Ok(match flow {
            Flow::Next => vec![next],
            Flow::Jump(target) => vec![target],
            Flow::Branch(target) => vec![target, next],
            // On the Cortex-M0 no other instruction jumps far.
            Flow::Call(target) if inside.contains(&target) && target != inside.start => {
                vec![target]
            }
            Flow::Call(target) => {
                walk.call(target, depth);
                vec![next]
            }
            Flow::Table(entry_size) => self.table(instruction.place.address + 4, next, entry_size),
            Flow::UnknownCall => bail!("a call of an unknown function: {instruction}"),
            Flow::UnknownJump => bail!("a jump to an unknown place: {instruction}"),
            Flow::Return | Flow::Stop => Vec::new(),
        })
    }

    /// Where the entries of a Thumb jump table lead, which lies right behind its jump; from `pc` on they
    /// count.
    fn table(&self, pc: u64, start: u64, entry_size: u64) -> Vec<u64> {
        let entries = (start..)
            .step_by(entry_size as usize)
            .take_while(|&entry| self.image.is_data(entry));
        let targets = entries.map_while(|entry| {
            let bytes = self.image.bytes(entry, entry_size)?;
            let halfwords = bytes
                .iter()
                .rev()
                .fold(0, |value, &byte| value << 8 | u64::from(byte));
            Some(pc + 2 * halfwords)
        });
        // A last odd byte is filled up with zero, which leads into the table itself.
        targets
            .filter(|&target| !self.image.is_data(target))
            .collect()
    }
}

/// What is known of registers from which a stack pointer or a called address is computed: large frames
/// of the Cortex-M0, whose instructions have room for small numbers only, and calls on RISC-V, which
/// add up their target in two instructions.
#[derive(Clone, Debug, Default)]
struct Values(BTreeMap<String, Value>);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Value {
    Number(i64),
    /// So many bytes below the stack pointer at the call.
    Depth(i64),
}

impl Values {
    /// The depth after an instruction that computes the stack pointer.
    fn stack_after(&self, instruction: &Instruction, depth: u64) -> Option<u64> {
        let value = |register: &String| self.0.get(register).copied();
        match (instruction.mnemonic.as_str(), &instruction.registers[..]) {
            ("mov", [_, source]) => match value(source)? {
                Value::Depth(depth) => depth.try_into().ok(),
                Value::Number(_) => None,
            },
            ("add", [.., term]) => match value(term)? {
                Value::Number(number) => depth.checked_add_signed(-number),
                Value::Depth(_) => None,
            },
            _ => None,
        }
    }

    /// Makes a known target of an unknown one where its register is known.
    fn resolve(&self, instruction: &Instruction, flow: Flow) -> Flow {
        let base = instruction
            .address
            .as_ref()
            .map(|(base, _)| base)
            .or(instruction.registers.last());
        let Some(Value::Number(base)) = base.and_then(|base| self.0.get(base)) else {
            return flow;
        };
        let target = (base + instruction.immediate.unwrap_or_default()) as u64;
        match flow {
            Flow::UnknownCall => Flow::Call(target),
            Flow::UnknownJump => Flow::Jump(target),
            flow => flow,
        }
    }

    fn update(&mut self, instruction: &Instruction, depth: u64, image: &Image) {
        let Some(target) = instruction.registers.first() else {
            return;
        };
        let source = instruction.registers.get(1).unwrap_or(target);
        let value = if source == "sp" {
            Some(Value::Depth(depth as i64))
        } else {
            self.0.get(source).copied()
        };
        let is_literal = instruction
            .address
            .as_ref()
            .is_some_and(|(base, _)| base == "pc");
        let result = match (instruction.mnemonic.as_str(), instruction.immediate, value) {
            ("ldr", Some(offset), _) if is_literal => {
                let address = ((instruction.place.address + 4) & !3).wrapping_add_signed(offset);
                let bytes = image
                    .bytes(address, 4)
                    .and_then(|bytes| bytes.try_into().ok());
                bytes.map(|bytes| Value::Number(i32::from_le_bytes(bytes).into()))
            }
            ("auipc", Some(pages), _) => {
                let address = instruction.place.address as i64 + (pages << 12);
                Some(Value::Number(i64::from(address as u32)))
            }
            ("mov" | "movs", Some(number), _) => Some(Value::Number(number)),
            ("mov" | "movs", None, value) => value,
            ("lsls", Some(bits), Some(Value::Number(number))) => {
                Some(Value::Number(number << bits))
            }
            ("add" | "adds", Some(term), Some(Value::Number(number))) => {
                Some(Value::Number(number + term))
            }
            ("sub" | "subs", Some(term), Some(Value::Number(number))) => {
                Some(Value::Number(number - term))
            }
            ("add" | "adds", Some(term), Some(Value::Depth(depth))) => {
                Some(Value::Depth(depth - term))
            }
            ("sub" | "subs", Some(term), Some(Value::Depth(depth))) => {
                Some(Value::Depth(depth + term))
            }
            // Storing and comparing leave it as it is.
            ("str" | "strb" | "strh" | "cmp" | "push" | "stm", ..) => return,
            _ => None,
        };
        match result {
            Some(value) => self.0.insert(target.clone(), value),
            None => self.0.remove(target),
        };
        if matches!(instruction.mnemonic.as_str(), "pop" | "ldm") {
            self.0
                .retain(|register, _| !instruction.registers.contains(register));
        }
    }
}

/// What one function does to the stack.
#[derive(Debug, Default)]
struct Walk {
    /// Before each instruction.
    depths: BTreeMap<u64, u64>,
    deepest: u64,
    /// Called functions, and the depth of their deepest call.
    calls: BTreeMap<u64, u64>,
}

impl Walk {
    fn call(&mut self, callee: u64, depth: u64) {
        let deepest = self.calls.entry(callee).or_default();
        *deepest = depth.max(*deepest);
    }
}

#[cfg(test)]
mod tests {
    use object::Architecture;

    use super::*;

    fn bound_of(code: &[u8]) -> Result<u64> {
        Ok(bound(&Image::of_code(Architecture::Arm, code), "code")?.bytes)
    }

    #[test]
    fn depths_add_up_along_the_deepest_path() {
        let code = [
            0xf0, 0xb5, // push {r4-r7, lr}
            0x10, 0xb1, // cbz r0, to the add
            0x84, 0xb0, // sub sp, #16
            0x04, 0xb0, // add sp, #16
            0x00, 0xbf, // nop
            0xf0, 0xbd, // pop {r4-r7, pc}
        ];
        assert_eq!(bound_of(&code).unwrap(), 36);
    }

    #[test]
    fn large_frames_are_computed() {
        let code = [
            0x80, 0xb5, // push {r7, lr}
            0x00, 0xaf, // add r7, sp, #0
            0x01, 0x4e, // ldr r6, [pc, #4]
            0xb5, 0x44, // add sp, r6
            0xbd, 0x46, // mov sp, r7
            0x80, 0xbd, // pop {r7, pc}
            0xc4, 0xfd, 0xff, 0xff, // -572
        ];
        assert_eq!(bound_of(&code).unwrap(), 580);
    }

    #[test]
    fn what_has_no_bound_is_an_error() {
        let cases: [(&str, &[u8], &str); 4] = [
            (
                "bl itself; bx lr",
                &[0xff, 0xf7, 0xfe, 0xff, 0x70, 0x47],
                "recursion",
            ),
            (
                "blx r3; bx lr",
                &[0x98, 0x47, 0x70, 0x47],
                "unknown function",
            ),
            ("sub.w sp, sp, r4", &[0xad, 0xeb, 0x04, 0x0d], "unknown way"),
            (
                "push {r4}; bx lr",
                &[0x10, 0xb4, 0x70, 0x47],
                "returns with 4 bytes",
            ),
        ];
        for (name, code, why) in cases {
            let error = bound_of(code).unwrap_err().to_string();
            assert!(error.contains(why), "{name}: {error}");
        }
    }
}
