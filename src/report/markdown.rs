//! The report as a short Markdown text, for the summary page of a pipeline.

use super::baseline_view::ChangeView;
use super::verdict::{Change, Tone};
use super::view::{FigureView, Headline, ReportView, ScenarioView};

/// Most changes in the summary.
const CHANGES: usize = 30;

/// What to know first: the sentence, the gates, the tables of measurements, what deserves attention.
pub fn markdown(view: &ReportView) -> String {
    let mut text = format!("# {}\n\n{}\n", escape(&view.title), escape(&view.summary.sentence));
    if !view.gates.is_empty() {
        text += "\n## Gates\n\n| | scenario | gate | found | demanded |\n|---|---|---|---|---|\n";
        for gate in &view.gates {
            let words = gate.verdict.words();
            let cells = [&gate.scenario, &gate.gate, &gate.found.text, &gate.demanded.text].map(|cell| escape(cell));
            text += &format!("| {} {words} | {} |\n", Tone::of(words).symbol(), cells.join(" | "));
        }
    }
    if let Some(baseline) = &view.baseline {
        text += &format!("\n## Against an earlier run: {}\n\n{}\n", escape(&baseline.path), escape(&baseline.sentence));
        text += &baseline.notes.iter().map(|note| format!("\n- {}", escape(note))).collect::<String>();
        for input in &baseline.inputs {
            let keys =
                if input.keys.is_empty() { String::new() } else { format!(": {}", escape(&input.keys.join("; "))) };
            text += &format!("\n- another input: {}{keys}", escape(&input.id));
        }
        if !baseline.notes.is_empty() || !baseline.inputs.is_empty() {
            text.push('\n');
        }
        let told: Vec<&ChangeView> = baseline.changes.iter().filter(|change| change.verdict != Change::New).collect();
        if !told.is_empty() {
            text += "\n| | where | value | before | now |\n|---|---|---|---|---|\n";
        }
        for c in told.iter().take(CHANGES) {
            let words = c.verdict.words();
            let cells = [&c.subject, &c.what, &c.before.text, &c.after.text].map(|cell| escape(cell));
            text += &format!("| {} {words} | {} |\n", Tone::of(words).symbol(), cells.join(" | "));
        }
    }
    text += &pictures(view);
    if let Some(history) = &view.history {
        text += &format!("\n## History\n\n{}\n", escape(&history.sentence));
    }
    text += &list("Model against measurements", &view.summary.compared);
    text += &list("What deserves attention", &view.summary.headlines);
    let p = &view.provenance;
    text += &format!(
        "\n{} {}, comparison version {}; {}\n",
        escape(&p.program),
        escape(&p.version),
        escape(&p.comparator),
        escape(&p.generated)
    );
    text
}

/// Files of the pictures to look at: the first of every table, and those that changed.
fn pictures(view: &ReportView) -> String {
    let png = |figure: &FigureView| figure.files.iter().find(|file| file.kind == "PNG").map(|file| file.name.clone());
    let first = |scenario: &ScenarioView| {
        let discovery = scenario.discovery.as_ref()?;
        let name = png(discovery.figures.iter().find(|figure| figure.name == "before-after")?)?;
        Some(format!("- {}: {}\n", escape(&scenario.title), escape(&name)))
    };
    let changed = view.baseline.iter().flat_map(|baseline| &baseline.pictures).filter_map(|picture| {
        let now = view.figures().into_iter().find(|figure| figure.anchor == picture.anchor)?;
        let (title, before, now) = (escape(&picture.title), escape(&picture.before), escape(&png(now)?));
        Some(format!("- changed: {title}: before {before}, now {now}\n"))
    });
    let lines: String = view.scenarios.iter().filter_map(first).chain(changed.take(CHANGES)).collect();
    if lines.is_empty() { lines } else { format!("\n## Pictures\n\n{lines}") }
}

fn list(title: &str, lines: &[Headline]) -> String {
    if lines.is_empty() {
        return String::new();
    }
    let line = |h: &Headline| {
        let detail = if h.detail.is_empty() { String::new() } else { format!(" - {}", escape(&h.detail)) };
        format!("- {} **{}**: {}{detail}\n", Tone::of(&h.verdict).symbol(), escape(&h.verdict), escape(&h.subject))
    };
    format!("\n## {title}\n\n{}", lines.iter().map(line).collect::<String>())
}

/// A text that Markdown shows as it is, on one line.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.split_whitespace().collect::<Vec<_>>().join(" ").chars() {
        match c {
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '&' => escaped += "&amp;",
            '\\' | '`' | '*' | '_' | '[' | ']' | '|' | '~' | '#' | '$' => escaped.extend(['\\', c]),
            c if c.is_control() => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_users_are_no_markup() {
        let shown = escape("<img src=x>\n| [a](javascript:b) `c` **d** $e$");
        assert_eq!(shown, "&lt;img src=x&gt; \\| \\[a\\](javascript:b) \\`c\\` \\*\\*d\\*\\* \\$e\\$");
        let provenance = super::super::Provenance::fixed("stickslip");
        let view = ReportView::assemble("# <b>", vec![], vec![], vec![], vec![], &provenance);
        assert!(markdown(&view).starts_with("# \\# &lt;b&gt;\n\nNothing was computed.\n"), "{}", markdown(&view));
    }
}
