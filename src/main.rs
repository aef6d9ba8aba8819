//! The `stickslip` command.

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    match stickslip::cli::run(stickslip::cli::Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(error.exit_code())
        }
    }
}
