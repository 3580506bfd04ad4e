//! The `whitted` program.

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;
use whitted_cli::args::Arguments;
use whitted_cli::{commands, output};

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    output::clean_up_when_interrupted();
    match commands::run(&arguments.command) {
        Ok(outcome) => outcome.into(),
        Err(error) => {
            // Standard error may be closed; the exit code still tells.
            let _ = writeln!(io::stderr(), "error: {error:#}");
            ExitCode::from(2)
        }
    }
}
