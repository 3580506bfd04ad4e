//! Programs as the linker left them: what they take of flash and RAM, and what is where.

use std::collections::BTreeMap;
use std::fs;
use std::hash::Hasher;
use std::ops::Range;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use object::elf::{SHF_ALLOC, SHF_WRITE};
use object::{
    Architecture, Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, SymbolKind,
};

/// A linked program.
#[derive(Clone, Debug)]
pub struct Image {
    /// The file.
    pub path: PathBuf,
    /// Arm or RISC-V.
    pub architecture: Architecture,
    /// Bytes that lie in flash: code, constants, vectors, and what RAM starts with.
    pub flash: u64,
    /// Bytes of RAM taken before any code runs, the stack not counted.
    pub static_ram: u64,
    /// Functions by address.
    pub functions: BTreeMap<u64, Function>,
    sections: Vec<(u64, Vec<u8>)>,
    text: Vec<u8>,
    /// Stretches of data within code.
    data_in_code: Vec<Range<u64>>,
}

/// A function of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Function {
    /// As the linker calls it.
    pub symbol: String,
    /// In bytes.
    pub size: u64,
}

impl Function {
    /// Whether it came from the compiler's support library: arithmetic that the target lacks.
    pub fn is_support(&self) -> bool {
        let symbol = self.symbol.as_str();
        symbol.starts_with("__aeabi_")
            || symbol.contains("17compiler_builtins")
            || [
                "sf2", "sf3", "df2", "df3", "di2", "di3", "si3", "sfsi", "sisf",
            ]
            .iter()
            .any(|ending| symbol.starts_with("__") && symbol.ends_with(ending))
    }
}

impl Image {
    /// Reads an ELF file.
    ///
    /// # Errors
    ///
    /// Where it cannot be read, or has no `.text`.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = fs::read(path).with_context(|| path.display().to_string())?;
        let file = object::File::parse(&*bytes).with_context(|| path.display().to_string())?;
        let (mut flash, mut static_ram) = (0, 0);
        let mut sections = Vec::new();
        for section in file.sections() {
            let SectionFlags::Elf { sh_flags } = section.flags() else {
                bail!("{} is not an ELF file", path.display());
            };
            let name = section.name()?;
            // Room that a linker script sets apart for the stack is no section's content.
            if sh_flags & u64::from(SHF_ALLOC) == 0 || [".stack", ".heap"].contains(&name) {
                continue;
            }
            let is_written = sh_flags & u64::from(SHF_WRITE) != 0;
            if is_written {
                static_ram += section.size();
            }
            if section.kind() != SectionKind::UninitializedData {
                flash += section.size();
                sections.push((section.address(), section.data()?.to_vec()));
            }
        }
        let text = file
            .section_by_name(".text")
            .context("a program without .text")?
            .data()?
            .to_vec();
        let data_in_code = data_ranges(&file);
        let functions = functions(&file);
        Ok(Self {
            path: path.to_owned(),
            architecture: file.architecture(),
            flash,
            static_ram,
            functions,
            sections,
            text,
            data_in_code,
        })
    }

    /// A program of one function, for tests.
    #[cfg(test)]
    pub(super) fn of_code(architecture: Architecture, code: &[u8]) -> Self {
        let function = Function {
            symbol: "code".to_owned(),
            size: code.len() as u64,
        };
        Self {
            path: PathBuf::from("test"),
            architecture,
            flash: code.len() as u64,
            static_ram: 0,
            functions: [(0, function)].into(),
            sections: vec![(0, code.to_vec())],
            text: code.to_vec(),
            data_in_code: Vec::new(),
        }
    }

    /// Address of a function.
    ///
    /// # Errors
    ///
    /// Where there is none of this name.
    pub fn address(&self, symbol: &str) -> Result<u64> {
        let found = self
            .functions
            .iter()
            .find(|(_, function)| function.symbol == symbol);
        let (&address, _) =
            found.with_context(|| format!("{} has no function {symbol}", self.path.display()))?;
        Ok(address)
    }

    /// The function in which an address lies, and where it starts.
    pub fn function_at(&self, address: u64) -> Option<(u64, &Function)> {
        let (&start, function) = self.functions.range(..=address).next_back()?;
        (address < start + function.size).then_some((start, function))
    }

    /// `size` bytes from flash.
    pub fn bytes(&self, address: u64, size: u64) -> Option<&[u8]> {
        self.sections.iter().find_map(|(start, bytes)| {
            let offset = usize::try_from(address.checked_sub(*start)?).ok()?;
            bytes.get(offset..offset + usize::try_from(size).ok()?)
        })
    }

    /// Whether data, not an instruction, lies at an address within code.
    pub fn is_data(&self, address: u64) -> bool {
        self.data_in_code
            .iter()
            .any(|range| range.contains(&address))
    }

    /// Checksum of the code, FNV-1a with 64 bits.
    pub fn text_checksum(&self) -> u64 {
        let mut hasher = fnv::FnvHasher::default();
        hasher.write(&self.text);
        hasher.finish()
    }

    /// Bytes of the compiler's support library.
    pub fn support_bytes(&self) -> u64 {
        self.functions
            .values()
            .filter(|function| function.is_support())
            .map(|function| function.size)
            .sum()
    }
}

fn functions(file: &object::File<'_>) -> BTreeMap<u64, Function> {
    let mut functions = BTreeMap::new();
    for symbol in file.symbols() {
        let is_code = symbol.kind() == SymbolKind::Text && symbol.size() > 0;
        let Ok(name) = symbol.name() else { continue };
        if is_code {
            // Thumb's symbols have the lowest bit set.
            let address = if file.architecture() == Architecture::Arm {
                symbol.address() & !1
            } else {
                symbol.address()
            };
            let function = Function {
                symbol: name.to_owned(),
                size: symbol.size(),
            };
            functions.entry(address).or_insert(function);
        }
    }
    functions
}

/// From Arm's mapping symbols: `$d` starts data, `$t` code.
fn data_ranges(file: &object::File<'_>) -> Vec<Range<u64>> {
    let mut marks: Vec<(u64, bool)> = file
        .symbols()
        .filter_map(|symbol| {
            let name = symbol.name().ok()?;
            let is_data = name == "$d" || name.starts_with("$d.");
            let is_code = name == "$t" || name.starts_with("$t.") || name.starts_with("$x");
            (is_data || is_code).then_some((symbol.address(), is_data))
        })
        .collect();
    marks.sort_unstable();
    let ends = marks.iter().skip(1).map(|mark| mark.0).chain([u64::MAX]);
    let ranges = marks.iter().zip(ends).filter(|((_, is_data), _)| *is_data);
    ranges.map(|(&(start, _), end)| start..end).collect()
}
