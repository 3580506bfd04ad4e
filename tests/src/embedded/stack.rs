//! The most stack that a function can take, from the code alone.
//!
//! Every path through every function that can be called is followed, and the depth of the stack
//! pointer carried along; where paths meet, they must agree. Recursion, calls of functions that only
//! the running program knows, and stack pointers that are computed have no such bound: they are errors.

use std::collections::BTreeMap;

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
        let mut waiting = vec![(start, 0)];
        while let Some((address, depth)) = waiting.pop() {
            if !inside.contains(&address) {
                // Called last: its frame takes this one's place.
                walk.call(address, depth);
                continue;
            }
            if let Some(&known) = walk.depths.get(&address) {
                if known != depth {
                    let name = &function.symbol;
                    bail!("{name} has {known} or {depth} bytes on the stack at {address:#x}");
                }
                continue;
            }
            walk.depths.insert(address, depth);
            let instruction = self.decoder.at(address)?;
            let Some(growth) = instruction.stack_growth(self.image.architecture) else {
                bail!(
                    "{} computes its stack pointer: {instruction}",
                    function.symbol
                );
            };
            let Some(after) = depth.checked_add_signed(growth) else {
                bail!(
                    "{} pops more than it pushed: {instruction}",
                    function.symbol
                );
            };
            walk.deepest = walk.deepest.max(after);
            for target in self.follow(&instruction, after, &mut walk)? {
                waiting.push((target, after));
            }
        }
        Ok(walk)
    }

    /// Where an instruction leads within its function, or last.
    fn follow(&self, instruction: &Instruction, depth: u64, walk: &mut Walk) -> Result<Vec<u64>> {
        let next = instruction.place.address + instruction.place.size;
        Ok(match instruction.flow(self.image.architecture) {
            Flow::Next => vec![next],
            Flow::Jump(target) => vec![target],
            Flow::Branch(target) => vec![target, next],
            Flow::Call(target) => {
                walk.call(target, depth);
                vec![next]
            }
            Flow::Table(entry_size) => self.table(next, entry_size),
            Flow::UnknownCall => bail!("a call of an unknown function: {instruction}"),
            Flow::UnknownJump => bail!("a jump to an unknown place: {instruction}"),
            Flow::Return => Vec::new(),
        })
    }

    /// Where the entries of a Thumb jump table lead, which lies right behind its jump.
    fn table(&self, start: u64, entry_size: u64) -> Vec<u64> {
        let entries = (start..)
            .step_by(entry_size as usize)
            .take_while(|&entry| self.image.is_data(entry));
        let targets = entries.map_while(|entry| {
            let bytes = self.image.bytes(entry, entry_size)?;
            let halfwords = bytes
                .iter()
                .rev()
                .fold(0, |value, &byte| value << 8 | u64::from(byte));
            Some(start + 2 * halfwords)
        });
        // A last odd byte is filled up with zero, which leads into the table itself.
        targets
            .filter(|&target| !self.image.is_data(target))
            .collect()
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
