//! Problems of a scenario file, shown with file:line:column and the offending line.

use std::ops::Range;
use std::path::PathBuf;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use strsim::osa_distance;

/// One file of a scenario.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    /// Name shown in messages.
    pub name: String,
    /// Where it is; measurement tables are found from its folder.
    pub path: PathBuf,
    /// Its text without a byte order mark.
    pub text: String,
}

/// A place in one of the files that make up a scenario.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Place {
    /// Index into the list of sources.
    pub file: usize,
    /// Byte range in its text.
    pub span: Range<usize>,
}

/// Everything found wrong so far; one file's problems are all told at once.
#[derive(Debug, Default)]
pub(crate) struct Problems {
    messages: Vec<String>,
    untold: usize,
}

/// Nobody reads more problems than this at once.
pub(crate) const MAX_TOLD: usize = 20;

impl Problems {
    /// Adds a problem: what is wrong, where, what stands under the carets, and what to do.
    pub fn push(&mut self, sources: &[Source], place: &Place, title: &str, label: &str, help: &str) {
        if self.messages.len() == MAX_TOLD {
            self.untold += 1;
            return;
        }
        self.messages.push(render(&sources[place.file], place.span.clone(), title, label, help));
    }

    /// Counts problems that are not told.
    pub fn leave_out(&mut self, problems: usize) {
        self.untold += problems;
    }

    /// All messages, or nothing where there were none.
    pub fn into_message(mut self) -> Option<String> {
        if self.untold > 0 {
            self.messages.push(format!("error: {} more problems are not shown", self.untold));
        }
        (!self.messages.is_empty()).then(|| self.messages.join("\n\n"))
    }
}

/// Bytes of the longest line that is shown; of a longer one the place is told.
const MAX_SHOWN: usize = 1 << 16;

/// A message with the line that it is about. Only that line is handed to the renderer, so long files cost nothing.
pub(crate) fn render(source: &Source, span: Range<usize>, title: &str, label: &str, help: &str) -> String {
    let text = source.text.as_str();
    let floor = |mut at: usize| {
        at = at.min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let start = floor(span.start);
    let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
    let line_end = text[start..].find('\n').map_or(text.len(), |at| start + at);
    let line = text[line_start..line_end].trim_end_matches('\r');
    let from = (start - line_start).min(line.len());
    let to = floor(span.end).saturating_sub(line_start).clamp(from, line.len());
    let number = text[..line_start].matches('\n').count() + 1;
    if line.len() > MAX_SHOWN {
        let column = line[..from].chars().count() + 1;
        let place = format!("error: {title}\n --> {}:{number}:{column}: {label}", source.name);
        return if help.is_empty() { place } else { format!("{place}\n  = help: {help}") };
    }
    let snippet = Snippet::source(line)
        .line_start(number)
        .path(&source.name)
        .annotation(AnnotationKind::Primary.span(from..to).label(label));
    let group = Level::ERROR.primary_title(title).element(snippet);
    let group = if help.is_empty() { group } else { group.element(Level::HELP.message(help)) };
    Renderer::plain().term_width(160).render(&[group])
}

/// A message about a file as a whole.
pub fn whole_file(title: &str, help: &str) -> String {
    format!("error: {title}\n  = help: {help}")
}

/// Letters from which on a beginning tells a name.
const BEGINNING: usize = 6;

/// The name nearest to what was written, where one is near enough to be meant.
pub fn nearest<'a>(written: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let written: String = written.chars().take(80).collect::<String>().to_lowercase().replace('-', "_");
    let names: Vec<&str> = names.into_iter().collect();
    // The only one that begins like this, or is the beginning of it.
    let same = |a: &str, b: &str| a.len() >= BEGINNING && b.starts_with(a);
    let begins = |name: &&&str| same(&written, &name.to_lowercase()) || same(&name.to_lowercase(), &written);
    if let [one] = names.iter().filter(begins).collect::<Vec<_>>()[..] {
        return Some(one);
    }
    // A name that is longer by more than the distance allowed cannot be near.
    let letters = written.chars().count();
    names
        .into_iter()
        .filter(|name| name.chars().nth((letters + letters / 2 + 2).max(letters + 2)).is_none())
        .map(|name| (osa_distance(&written, &name.to_lowercase().replace('-', "_")), name))
        .filter(|(distance, name)| *distance <= (name.chars().count() / 3).max(2))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

/// A user's text cut to a length that fits a message.
pub fn quote(text: &str) -> String {
    let short: String = text.chars().take(60).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if text.chars().nth(60).is_some() { format!("`{short}…`") } else { format!("`{short}`") }
}

/// "did you mean" under the carets, or what is needed where nothing is near.
pub(crate) fn suggestion(near: Option<&str>, otherwise: &str) -> String {
    near.map_or_else(|| otherwise.into(), |name| format!("did you mean `{name}`?"))
}
