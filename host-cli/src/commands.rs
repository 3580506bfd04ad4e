//! What each command does.

use std::process::ExitCode;

use crate::args::Command;

mod bake;
mod cast;
mod compare;
mod inspect;
mod render;

/// How a command that did its work ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// As hoped: 0.
    Success,
    /// Two pictures are further apart than was allowed: 1.
    Different,
    /// Some of the input was bad, and said to be: 2.
    BadInput,
}

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Success => Self::SUCCESS,
            Outcome::Different => Self::from(1),
            Outcome::BadInput => Self::from(2),
        }
    }
}

/// Runs a command.
///
/// # Errors
///
/// What to tell the user; the exit code is then 2.
pub fn run(command: &Command) -> anyhow::Result<Outcome> {
    let result = match command {
        Command::Render(args) => render::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Cast(args) => cast::run(args),
        Command::Inspect(args) => inspect::run(args),
        Command::Bake(args) => bake::run(args),
    };
    match result {
        // Whoever reads has had enough.
        Err(error) if is_closed_pipe(&error) => Ok(Outcome::Success),
        other => other,
    }
}

fn is_closed_pipe(error: &anyhow::Error) -> bool {
    error
        .chain()
        .filter_map(|it| it.downcast_ref::<std::io::Error>())
        .any(|it| it.kind() == std::io::ErrorKind::BrokenPipe)
}
