//! `stickslip completions` and `stickslip man`: what shells and manual readers want of the command line.

use super::{Cli, Global, say};
use crate::error::{Error, Result};
use crate::files;
use clap::CommandFactory as _;
use clap_complete::Shell;
use std::io::Write as _;
use std::path::Path;

/// Prints the completions of a shell.
pub fn completions(shell: Shell) -> Result<()> {
    let mut bytes = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "stickslip", &mut bytes);
    // A reader that has gone is no error of the command.
    let _ = std::io::stdout().lock().write_all(&bytes);
    Ok(())
}

/// Prints the manual page, or writes that of every command below a folder.
pub fn man(out: Option<&Path>, global: &Global) -> Result<()> {
    let mut command = Cli::command();
    command.build();
    let Some(out) = out else {
        let _ = std::io::stdout().lock().write_all(&page(&command)?);
        return Ok(());
    };
    files::prepare(out)?;
    for command in std::iter::once(&command).chain(command.get_subcommands()) {
        let name = command.get_display_name().unwrap_or_else(|| command.get_name());
        let path = out.join(format!("{name}.1"));
        files::replace(&path, &page(command)?)?;
        say(global, &format!("wrote {}", path.display()));
    }
    Ok(())
}

fn page(command: &clap::Command) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let man = clap_mangen::Man::new(command.clone());
    man.render(&mut bytes).map_err(|why| Error::Unfinished(format!("the manual page could not be made: {why}")))?;
    Ok(bytes)
}
