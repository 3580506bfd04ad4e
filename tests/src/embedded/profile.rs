//! What was executed within the calls of a function, as the counting plugin reports it.

use std::collections::BTreeMap;

use anyhow::{Context, Result, bail};

/// A place in a program: an instruction's address and size.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// Where it starts.
    pub address: u64,
    /// In bytes.
    pub size: u64,
}

/// How often each instruction ran, and how often one came right after another.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Profile {
    /// Calls of the function.
    pub calls: u64,
    /// How often each instruction ran.
    pub instructions: BTreeMap<Place, u64>,
    /// How often the second came after the first. The last of a call is the return out of it.
    pub steps: BTreeMap<(Place, Place), u64>,
}

impl Profile {
    /// Reads the plugin's output for `functions` functions.
    ///
    /// # Errors
    ///
    /// Where it is not such output.
    pub fn parse(text: &str, functions: usize) -> Result<Vec<Self>> {
        let mut profiles = vec![Self::default(); functions];
        let mut blocks = BTreeMap::new();
        let lines = || text.lines().map(|line| line.split(' ').collect::<Vec<_>>());
        for line in lines() {
            if let ["block", id, address, sizes] = line[..] {
                blocks.insert(id, parse_block(address, sizes)?);
            }
        }
        let block = |id| blocks.get(id).with_context(|| format!("no block {id}"));
        for line in lines() {
            match line[..] {
                ["block", ..] => {}
                ["call", function, times] => {
                    let profile = profiles.get_mut(function.parse::<usize>()?);
                    profile.context("no such function")?.calls = times.parse()?;
                }
                ["count", function, id, times] => {
                    let profile = profiles.get_mut(function.parse::<usize>()?);
                    profile
                        .context("no such function")?
                        .add_block(block(id)?, times.parse()?);
                }
                ["step", function, from, to, times] => {
                    let profile = profiles.get_mut(function.parse::<usize>()?);
                    let (Some(&from), Some(&to)) = (block(from)?.last(), block(to)?.first()) else {
                        bail!("an empty block");
                    };
                    let steps = &mut profile.context("no such function")?.steps;
                    *steps.entry((from, to)).or_default() += times.parse::<u64>()?;
                }
                _ => bail!("not the plugin's output: {line:?}"),
            }
        }
        Ok(profiles)
    }

    fn add_block(&mut self, block: &[Place], times: u64) {
        for &place in block {
            *self.instructions.entry(place).or_default() += times;
        }
        for pair in block.windows(2) {
            *self.steps.entry((pair[0], pair[1])).or_default() += times;
        }
    }

    /// Instructions in all calls together.
    pub fn total(&self) -> u64 {
        self.instructions.values().sum()
    }
}

fn parse_block(address: &str, sizes: &str) -> Result<Vec<Place>> {
    let mut address = u64::from_str_radix(address, 16)?;
    sizes
        .split(',')
        .map(|size| {
            let place = Place {
                address,
                size: size.parse()?,
            };
            address += place.size;
            Ok(place)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_of_blocks_become_counts_of_instructions_and_of_steps() {
        // Two blocks that share their last instruction, as when a loop jumps into straight code.
        let text = "call 0 1\nblock 0 100 2,4\ncount 0 0 1\nstep 0 0 1 1\nblock 1 102 4\ncount 0 1 9\n\
                    step 0 1 1 8\nstep 0 1 2 1\nblock 2 200 2\n";
        let profiles = Profile::parse(text, 1).unwrap();
        let [first, second, outside] =
            [(0x100, 2), (0x102, 4), (0x200, 2)].map(|(address, size)| Place { address, size });
        assert_eq!(profiles[0].calls, 1);
        assert_eq!(profiles[0].total(), 11);
        assert_eq!(profiles[0].instructions, [(first, 1), (second, 10)].into());
        let steps = [
            ((first, second), 1),
            ((second, second), 9),
            ((second, outside), 1),
        ];
        assert_eq!(profiles[0].steps, steps.into());
    }

    #[test]
    fn other_text_is_refused() {
        for text in ["count 0 0 1\n", "call 1 1\n", "hello\n"] {
            assert!(Profile::parse(text, 1).is_err(), "{text}");
        }
    }
}
