//! Changes to a text that leave every other byte as it is: values replaced, lines and elements of lists put in or taken
//! out, comments at ends of lines.

use std::collections::BTreeMap;
use std::ops::Range;

/// Begins the part of a comment that belongs to this program; a semicolon or the end of the line ends it.
const MARK: &str = "95 %: ";

/// A text and the changes to make.
pub(crate) struct Splice<'a> {
    text: &'a str,
    newline: &'static str,
    edits: Vec<(Range<usize>, String)>,
    /// By end of line: where its values end, and what to say of each.
    notes: BTreeMap<usize, (usize, Vec<(String, String)>)>,
}

impl<'a> Splice<'a> {
    /// No changes yet.
    pub fn new(text: &'a str) -> Self {
        let newline = if text.contains("\r\n") { "\r\n" } else { "\n" };
        Self { text, newline, edits: Vec::new(), notes: BTreeMap::new() }
    }

    /// The text of a range.
    pub fn at(&self, range: &Range<usize>) -> &'a str {
        &self.text[range.clone()]
    }

    /// Puts something in the place of a range.
    pub fn replace(&mut self, range: Range<usize>, with: impl Into<String>) {
        self.edits.push((range, with.into()));
    }

    /// Says something of the value called `name` in the comment at the end of the line on which it ends. Nothing said
    /// of any value takes away what was said before.
    pub fn note(&mut self, end: usize, name: &str, said: Option<&str>) {
        let (from, notes) = self.notes.entry(self.line_end(end)).or_insert((end, Vec::new()));
        *from = end.max(*from);
        notes.extend(said.map(|said| (name.to_string(), said.to_string())));
    }

    /// Puts lines below the one that holds `at`.
    pub fn lines_below(&mut self, at: usize, lines: &[String]) {
        let end = self.line_end(at);
        let text: String = lines.iter().flat_map(|line| [self.newline, line]).collect();
        self.edits.push((end..end, text));
    }

    /// Puts a table at the end of the text, or below the line that holds `below`.
    pub fn section(&mut self, below: Option<usize>, lines: &[String]) {
        let mut all = vec![String::new()];
        all.extend(lines.iter().cloned());
        let ended = self.text.ends_with('\n');
        match below {
            Some(at) => self.lines_below(at, &all),
            None if ended => {
                let text: String = all.iter().flat_map(|line| [line, self.newline]).collect();
                self.edits.push((self.text.len()..self.text.len(), text));
            }
            None => self.lines_below(self.text.len(), &all),
        }
    }

    /// Takes out the lines that hold a range, and one of the empty lines around them.
    pub fn take_lines(&mut self, range: &Range<usize>, with_gap: bool) {
        let mut start = self.line_start(range.start);
        let mut end = self.line_end(range.end);
        end += self.text[end..].find('\n').map_or(0, |at| at + 1);
        let rest = &self.text[end..];
        let empty_after = rest.is_empty() || rest.trim_start_matches([' ', '\t', '\r']).starts_with('\n');
        if with_gap && start > 0 && empty_after {
            let before = self.line_start(start - 1);
            if self.text[before..start].trim().is_empty() {
                start = before;
            }
        }
        if !self.text[..end].ends_with('\n') && start > 0 {
            start -= if self.text[..start].ends_with("\r\n") { 2 } else { 1 };
        }
        self.edits.push((start..end, String::new()));
    }

    /// Puts elements at the end of a list: `list` is its range, `items` those of its elements. Elements that stand on
    /// lines of their own get such lines, with their comments (if any).
    pub fn push(&mut self, list: &Range<usize>, items: &[Range<usize>], new: &[String]) {
        let Some(last) = items.last() else {
            self.edits.push((list.start + 1..list.start + 1, new.join(", ")));
            return;
        };
        if !(self.alone_on_line(last) && self.line_end(last.end) < list.end) {
            self.edits.push((last.end..last.end, new.iter().flat_map(|item| [", ", item]).collect()));
            return;
        }
        let comma = self.comma_after(last.end);
        if comma.is_none() {
            self.edits.push((last.end..last.end, ",".into()));
        }
        let indent = &self.text[self.line_start(last.start)..last.start];
        let mut lines: Vec<String> = new.iter().map(|item| format!("{indent}{item},")).collect();
        if let (None, Some(line)) = (comma, lines.last_mut()) {
            line.pop();
        }
        self.lines_below(comma.unwrap_or(last.end), &lines);
    }

    /// Takes the elements of these indices out of a list, and what is said of them.
    pub fn take(&mut self, items: &[Range<usize>], gone: &[usize]) {
        let [Some(first), Some(last)] = [items.first(), items.last()] else { return };
        let stay: Vec<usize> = (0..items.len()).filter(|i| !gone.contains(i)).collect();
        let own_lines = gone.iter().all(|&i| self.alone_on_line(&items[i]));
        match stay.first() {
            None => {
                self.note(last.end, "", None);
                let end = self.comma_after(last.end).map_or(last.end, |comma| comma + 1);
                self.edits.push((first.start..end, String::new()));
            }
            Some(_) if own_lines => {
                gone.iter().for_each(|&i| self.take_lines(&items[i].clone(), false));
                // Where the last element has no comma, it has none afterwards.
                let new_last = stay.last().map(|&i| items[i].end).filter(|_| self.comma_after(last.end).is_none());
                let comma = new_last.filter(|end| *end < last.start).and_then(|end| self.comma_after(end));
                self.edits.extend(comma.map(|at| (at..at + 1, String::new())));
            }
            Some(&first_left) => {
                if first_left > 0 {
                    self.edits.push((first.start..items[first_left].start, String::new()));
                }
                self.note(last.end, "", None);
                let later = gone.iter().filter(|&&i| i > first_left);
                self.edits.extend(later.map(|&i| (items[i - 1].end..items[i].end, String::new())));
            }
        }
    }

    /// White space at the start of the line that holds `at`.
    pub fn indent(&self, at: usize) -> &'a str {
        let line = &self.text[self.line_start(at)..];
        &line[..line.len() - line.trim_start_matches([' ', '\t']).len()]
    }

    /// The changed text; nothing where changes are in each other's way.
    pub fn finish(mut self) -> Option<String> {
        let mut edits: Vec<_> =
            self.notes.iter().map(|(&end, (from, notes))| self.comment(*from, end, notes)).collect();
        edits.append(&mut self.edits);
        edits.sort_by_key(|(range, _)| range.start);
        let (mut out, mut done) = (String::new(), 0);
        for (range, with) in &edits {
            out += self.text.get(done..range.start)?;
            out += with;
            done = range.end;
        }
        out += self.text.get(done..)?;
        Some(out)
    }

    /// The comment at the end of a line with these notes in it.
    fn comment(&self, from: usize, end: usize, notes: &[(String, String)]) -> (Range<usize>, String) {
        let said: Vec<String> = match notes {
            [(_, one)] if !self.text[from..end].contains(['}', ']']) => vec![one.clone()],
            some => some.iter().map(|(name, said)| format!("{name} {said}")).collect(),
        };
        let new = if said.is_empty() { String::new() } else { format!("{MARK}{}", said.join(", ")) };
        let Some(hash) = self.hash(from, end) else {
            return (end..end, if new.is_empty() { new } else { format!("  # {new}") });
        };
        let comment = &self.text[hash..end];
        let Some(at) = comment.find(MARK) else {
            let end = hash + comment.trim_end().len();
            return (end..end, if new.is_empty() { new } else { format!("; {new}") });
        };
        let stop = comment[at..].find(';').map_or(comment.trim_end().len(), |stop| at + stop);
        if !new.is_empty() {
            return (hash + at..hash + stop, new);
        }
        // Without a note, a comment that was nothing else goes too.
        let before = comment[..at].trim_end_matches([' ', ';']);
        match before {
            "#" if hash + stop == end => (from.max(hash - trailing_space(&self.text[from..hash]))..end, String::new()),
            "#" => (hash + at..hash + stop + 1, String::new()),
            _ => (hash + before.len()..hash + stop, String::new()),
        }
    }

    /// Where the comment of a line begins, looking from the end of a value on.
    fn hash(&self, from: usize, end: usize) -> Option<usize> {
        let mut quote = None;
        for (at, c) in self.text[from..end].char_indices() {
            match (quote, c) {
                (None, '#') => return Some(from + at),
                (None, '"' | '\'') => quote = Some(c),
                (Some(open), c) if open == c => quote = None,
                _ => {}
            }
        }
        None
    }

    /// The comma that follows an element, comments and line ends skipped.
    fn comma_after(&self, end: usize) -> Option<usize> {
        let mut commented = false;
        for (at, c) in self.text[end..].char_indices() {
            match c {
                '\n' => commented = false,
                '#' => commented = true,
                ',' if !commented => return Some(end + at),
                c if !commented && !c.is_whitespace() => return None,
                _ => {}
            }
        }
        None
    }

    /// Whether nothing but a comma and a comment shares the lines of an element.
    fn alone_on_line(&self, item: &Range<usize>) -> bool {
        let before = &self.text[self.line_start(item.start)..item.start];
        let after = self.text[item.end..self.line_end(item.end)].trim_start();
        let after = after.strip_prefix(',').unwrap_or(after).trim_start();
        before.trim().is_empty() && (after.is_empty() || after.starts_with('#'))
    }

    fn line_start(&self, at: usize) -> usize {
        self.text[..at].rfind('\n').map_or(0, |end| end + 1)
    }

    /// The end of the line that holds `at`, before its line break.
    fn line_end(&self, at: usize) -> usize {
        let end = self.text[at..].find('\n').map_or(self.text.len(), |end| at + end);
        if end > at && self.text[..end].ends_with('\r') { end - 1 } else { end }
    }
}

fn trailing_space(text: &str) -> usize {
    text.len() - text.trim_end_matches([' ', '\t']).len()
}
