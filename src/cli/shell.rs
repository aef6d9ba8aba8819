//! `stickslip completions` and `stickslip man`: what shells and manual readers want of the command line.

use super::{Cli, Global, say};
use crate::error::{Error, Result};
use crate::{files, terminal};
use clap::CommandFactory as _;
use clap_complete::Shell;
use std::path::Path;

/// Prints the completions of a shell.
pub fn completions(shell: Shell) -> Result<()> {
    let mut bytes = Vec::new();
    clap_complete::generate(shell, &mut Cli::command(), "stickslip", &mut bytes);
    print(bytes)
}

/// Prints the manual page, or writes that of every command below a folder.
pub fn man(out: Option<&Path>, global: &Global) -> Result<()> {
    let mut command = Cli::command();
    command.build();
    let Some(out) = out else {
        return print(page(&command)?);
    };
    files::prepare(out)?;
    for command in std::iter::once(&command).chain(command.get_subcommands()) {
        let name = command.get_display_name().unwrap_or_else(|| command.get_name());
        let path = out.join(format!("{name}.1"));
        files::replace_own(&path, &page(command)?, |text| text.contains(".TH stickslip"))?;
        say(global, &format!("wrote {}", path.display()))?;
    }
    Ok(())
}

fn print(bytes: Vec<u8>) -> Result<()> {
    terminal::print(&String::from_utf8_lossy(&bytes))
}

fn page(command: &clap::Command) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let man = clap_mangen::Man::new(command.clone());
    man.render(&mut bytes).map_err(|why| Error::Unfinished(format!("the manual page could not be made: {why}")))?;
    Ok(bytes)
}
