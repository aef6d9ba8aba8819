//! The command line: one file per command, each an `execute` that reads as a table of contents.

pub mod accept;
pub mod add;
mod baseline;
mod bounds;
mod browser;
mod caching;
mod changed_scenario;
pub mod check;
pub mod compare;
mod destination;
pub mod discover;
pub mod effects;
mod exports;
mod figure_output;
mod folder;
mod gates;
pub mod init;
mod json;
mod ledger;
mod new;
mod page;
mod plot;
mod progress;
pub mod prony;
mod question;
mod record;
pub mod report;
mod rerender;
pub mod run;
mod schema;
mod sections;
mod select;
mod shell;
mod simulate;
pub mod trial;

use crate::error::{Error, Result};
use crate::{interrupt, terminal};
use clap::{Args, Parser, Subcommand};
use json::{Json, Stamped};
use std::ffi::OsString;
use std::path::PathBuf;

/// Finds what the model of a driven resonator lacks: simulates, compares with measurements, names the missing effect.
#[derive(Debug, Parser)]
#[command(version, about, long_about = None, after_help = EXIT_STATUS, disable_help_subcommand = true)]
pub struct Cli {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    global: Global,
}

/// Most threads that are started.
const MOST_THREADS: u16 = 1024;
const EXIT_STATUS: &str = "Without a command: report. Exit status: 0 done; 1 done and a gate failed; \
    2 bad usage or input; 3 could not finish, or interrupted.";

/// SearchOptions of every command.
#[derive(Debug, Clone, Copy, Args)]
pub struct Global {
    /// Print nothing but errors
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Tell every few seconds how far a search is where no terminal shows it
    #[arg(long, short, global = true, conflicts_with = "quiet")]
    pub verbose: bool,
    /// Number of threads [default: one per core]
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_THREADS)))]
    pub threads: Option<u16>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Simulate everything, compare with measurements, draw, write report.html and report.json
    Report(report::Arguments),
    /// Simulate one scenario, compare it with its measurements if it names any, draw; curves as CSV
    Run {
        /// Scenario file
        scenario: PathBuf,
        /// Folder of the results
        #[arg(long, default_value = "output", value_name = "DIR")]
        out: PathBuf,
        #[command(flatten)]
        drawn: figure_output::FigureOutput,
    },
    /// Compare the model with measurements, and tell where it fails
    Compare {
        /// Scenario file with a table [measurement]
        scenario: PathBuf,
        /// Write the comparison as JSON; - for standard output
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
        /// Write a page of it (report.html) and its figures below this folder
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        #[command(flatten)]
        drawn: figure_output::FigureOutput,
        #[command(flatten)]
        plot: plot::Plot,
        /// Seed of the quasi-random starts of the fit
        #[arg(long, value_name = "N", default_value_t = 0)]
        seed: u32,
        #[command(flatten)]
        gates: gates::GateLimits,
    },
    /// Look at a measured table, and write a scenario that fits it
    New {
        /// The table: one row per steady state, with the frequency, the drive and the amplitude
        table: PathBuf,
        /// Write the scenario here instead of beside the table
        #[arg(long, short, value_name = "FILE")]
        output: Option<PathBuf>,
    },
    /// Find out which effect is missing in the model of some measurements
    #[command(after_help = discover::TERMS)]
    Discover {
        /// Scenario file with a table [measurement]
        scenario: PathBuf,
        /// Write the discovery as JSON; - for standard output
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
        /// Write a page of it (report.html) and its figures below this folder
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Write the scenario as explained here: effects put in, fitted numbers, comments kept
        #[arg(long, short, value_name = "FILE")]
        output: Option<PathBuf>,
        #[command(flatten)]
        drawn: figure_output::FigureOutput,
        #[command(flatten)]
        plot: plot::Plot,
        /// Most effects in one explanation
        #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(0..=6))]
        max_effects: u8,
        /// Seed of the Sobol sequence of starting points
        #[arg(long, value_name = "N", default_value_t = 0)]
        seed: u32,
        /// Search otherwise than by default: NAME=VALUE, as docs/search.md lists them
        #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',')]
        search: Vec<String>,
        /// Effects to ask for: names, or all [default: all]
        #[arg(long, value_name = "LIST", value_delimiter = ',')]
        candidates: Vec<String>,
        /// Tell on which variable what is missing depends also where the catalogue explains it
        #[arg(long)]
        free_form: bool,
        #[command(flatten)]
        gates: gates::GateLimits,
        #[command(flatten)]
        verdict: gates::Verdicts,
        #[command(flatten)]
        limits: bounds::Limits,
    },
    /// Fit an effect to the measurements, and write the scenario extended by it, comments kept
    Add {
        /// Name of the effect (`stickslip effects` lists them)
        effect: String,
        /// Scenario file with a table [measurement]; replaced by the extended one
        scenario: PathBuf,
        /// Write the extended scenario here instead
        #[arg(long, short, value_name = "FILE")]
        output: Option<PathBuf>,
        /// Show what would change, and write nothing
        #[arg(long)]
        dry_run: bool,
        /// Take the effect out, and fit what is left
        #[arg(long)]
        remove: bool,
        /// Seed of the quasi-random samples
        #[arg(long, value_name = "N", default_value_t = 0)]
        seed: u32,
        #[command(flatten)]
        plot: plot::Plot,
    },
    /// Make a report the baseline of later ones, after saying what differs
    Accept(accept::Arguments),
    /// Plant causes, hide the answers, search, score: the program examines itself
    Trial(trial::Arguments),
    /// Fit a table of moduli (DMA master curve, relaxation, creep) by a series of relaxations and a spring-pot, for a
    /// contact
    #[command(after_help = prony::TERMS)]
    Prony(prony::Arguments),
    /// Read and validate only
    Check {
        /// Scenario files or folders [default: scenarios/, or the built-in ones]
        scenarios: Vec<PathBuf>,
    },
    /// The catalogue of effects, or one of them in full
    Effects {
        /// Name of an effect
        name: Option<String>,
        /// Scenario whose formulas are listed with them
        #[arg(long, value_name = "SCENARIO")]
        of: Option<PathBuf>,
    },
    /// Write the built-in scenarios and a commented template; never overwrites
    Init {
        /// Folder to write to
        #[arg(default_value = ".")]
        dir: PathBuf,
    },
    /// Print the JSON Schema of what a command writes
    Schema {
        /// Whose
        name: schema::Name,
    },
    /// Print the completions of a shell
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page
    Man {
        /// Write the page of every command below this folder instead
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
}

impl Cli {
    /// The command line of this process; ends the process with help or an error where that is what it asks for.
    pub fn from_env() -> Self {
        let arguments = with_command(std::env::args_os().collect());
        let why = match Self::try_parse_from(&arguments) {
            Ok(cli) => return cli,
            Err(why) => why,
        };
        // What is wrong may be quoted; clap's colours are kept where nothing in it could be taken for one.
        let plain = arguments.iter().all(|word| !word.to_string_lossy().chars().any(terminal::obeyed));
        std::process::exit(told(&why, plain))
    }
}

/// Says what there is to say in place of a command, help or an error; the exit status.
fn told(why: &clap::Error, plain: bool) -> i32 {
    if why.use_stderr() {
        match plain {
            true => why.print().unwrap_or_default(),
            false => terminal::tell(why.render().to_string().trim_end()),
        }
    } else if let Err(error) = terminal::written(why.print()) {
        terminal::tell(&error.to_string());
        return error.exit_code().into();
    }
    why.exit_code()
}

/// The arguments with the word `report` where they name no command: options of every command may stand before it.
fn with_command(mut arguments: Vec<OsString>) -> Vec<OsString> {
    let mut at = 1;
    while let Some(word) = arguments.get(at).and_then(|word| word.to_str()) {
        match word {
            "-q" | "--quiet" | "-v" | "--verbose" => at += 1,
            "--threads" => at += 2,
            _ if word.starts_with("--threads=") => at += 1,
            _ => break,
        }
    }
    let next = arguments.get(at).map(|word| word.to_string_lossy());
    let help = ["-h", "--help", "-V", "--version"];
    if next.is_none_or(|word| word.starts_with('-') && !help.contains(&word.as_ref())) {
        arguments.insert(arguments.len().min(1), "report".into());
    }
    arguments
}

/// Runs the command that the arguments name.
///
/// # Errors
/// Whatever the command reports; [`Error::exit_code`] is the exit status.
pub fn run(cli: Cli) -> Result<()> {
    let global = cli.global;
    interrupt::watch(|message| {
        terminal::end_line();
        terminal::tell(message);
    });
    start_threads(&global)?;
    match cli.command {
        Command::Report(arguments) => report::execute(&arguments, &global),
        Command::Run { scenario, out, drawn } => run::execute(&scenario, (&out, &drawn), &global),
        Command::Compare { scenario, json, out, drawn, plot, seed, gates } => {
            let json = json.map(Json::from);
            let (json, out) = (json.as_ref(), out.as_deref().map(|out| (out, &drawn)));
            compare::execute(&compare::Job { path: &scenario, json, out, seed, limits: &gates, plot }, &global)
        }
        Command::New { table, output } => new::execute(&table, output.as_deref(), &global),
        Command::Discover {
            scenario,
            json,
            out,
            output,
            drawn,
            plot,
            max_effects,
            seed,
            search,
            candidates,
            free_form,
            gates,
            verdict,
            limits,
        } => {
            let own = if candidates.is_empty() { Vec::new() } else { effects::formulas(&scenario)? };
            let options = trial::searched((&search, &candidates), &own, max_effects, seed)?;
            let json = json.map(Json::from);
            let out = out.as_deref().map(|out| (out, &drawn));
            let output = output.as_deref();
            let job = discover::Job { path: &scenario, json: json.as_ref(), out, output, free_form, plot };
            discover::execute(&job, (&options, &limits), (&gates, &verdict), &global)
        }
        Command::Add { effect, scenario, output, dry_run, remove, seed, plot } => {
            let output = output.as_deref();
            let job = add::Job { effect: &effect, path: &scenario, output, dry_run, remove, seed, plot };
            add::execute(&job, &global)
        }
        Command::Accept(arguments) => accept::execute(&arguments, &global),
        Command::Trial(arguments) => trial::execute(&arguments, &global),
        Command::Prony(arguments) => prony::execute(&arguments, &global),
        Command::Check { scenarios } => check::execute(&scenarios),
        Command::Effects { name, of } => effects::execute(name.as_deref(), of.as_deref()),
        Command::Init { dir } => init::execute(&dir),
        Command::Schema { name } => schema::execute(name),
        Command::Completions { shell } => shell::completions(shell),
        Command::Man { out } => shell::man(out.as_deref(), &global),
    }
}

/// Starts as many threads as `--threads` says, or RAYON_NUM_THREADS, or as there are cores.
fn start_threads(global: &Global) -> Result<()> {
    let of_environment = std::env::var("RAYON_NUM_THREADS").ok().filter(|text| !text.is_empty() && text != "0");
    let number = match (global.threads, of_environment) {
        (Some(number), _) => number,
        (None, Some(text)) => {
            text.parse().ok().filter(|number| (1..=MOST_THREADS).contains(number)).ok_or_else(|| {
                let help = format!("a number from 1 to {MOST_THREADS}, or unset it");
                Error::Input(format!("error: RAYON_NUM_THREADS is `{text}`\n  = help: {help}"))
            })?
        }
        (None, None) => {
            std::thread::available_parallelism().map_or(1, |number| number.get().min(MOST_THREADS.into()) as u16)
        }
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(number.into());
    pool.build_global().map_err(|why| {
        Error::Unfinished(format!("{number} threads could not be started: {why}\n  = help: fewer, with --threads"))
    })
}

/// Prints a line on standard output, where lines are wanted.
fn say(global: &Global, line: &str) -> Result<()> {
    if global.quiet { Ok(()) } else { terminal::print(&format!("{line}\n")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_definition_of_the_command_line_is_sound() {
        <Cli as clap::CommandFactory>::command().debug_assert();
    }

    #[test]
    fn without_a_command_it_is_report() {
        let of = |line: &str| {
            let words = with_command(line.split(' ').map(OsString::from).collect());
            words.iter().map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(of("stickslip"), "stickslip report");
        assert_eq!(of("stickslip --out run"), "stickslip report --out run");
        assert_eq!(of("stickslip -q --threads 2 --out x"), "stickslip report -q --threads 2 --out x");
        for line in
            ["stickslip --help", "stickslip -V", "stickslip run a", "stickslip --quiet run a", "stickslip x.toml"]
        {
            assert_eq!(of(line), line);
        }
        assert_eq!(with_command(Vec::new()), ["report"]);
    }
}
