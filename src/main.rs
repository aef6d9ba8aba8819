//! The `stickslip` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    match stickslip::cli::run(stickslip::cli::Cli::from_env()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            stickslip::terminal::tell(&error.to_string());
            ExitCode::from(error.exit_code())
        }
    }
}
