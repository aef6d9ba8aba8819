//! What the free form says, in words that the terminal and the report share.

use super::judge::{Judged, MOST};
use super::variable::Variable;
use super::{Dependence, FreeForm, Standing};

/// Shapes named on a terminal.
const SHAPES: usize = 4;
/// All of the misfit \[%\]: an effect that leaves it has not the shape.
const WHOLE: f64 = 100.0;

impl Dependence {
    /// The variables in words.
    pub fn name(&self) -> String {
        match self.variables.as_slice() {
            [] => "constant".into(),
            some => some.iter().map(|v| v.words()).collect::<Vec<_>>().join(" and "),
        }
    }

    fn with_share(&self) -> String {
        format!("the {} ({} %)", self.name(), share(self.explained_percent))
    }
}

/// A share as whole per cent; all but everything is not everything.
fn share(percent: f64) -> String {
    if percent > 99.0 && percent < 100.0 { format!("{:.1}", percent.min(99.9)) } else { format!("{percent:.0}") }
}

/// What follows from the classes.
pub fn statement(found: &FreeForm, judged: &Judged<'_>) -> String {
    let untestable: Vec<&Dependence> =
        found.classes.iter().filter(|class| class.standing == Standing::Untestable).collect();
    if !judged.testable {
        return "on which variable anything missing depends cannot be told: the series have too few neighbouring readings".into();
    }
    if !judged.structured {
        return "no dependence is claimed: no structure is seen in what recalibration cannot explain".into();
    }
    let Some(leading) = found.leading() else {
        let most = found.classes.iter().filter(|c| c.standing == Standing::Undecided);
        let most = most.max_by(|a, b| a.explained_percent.total_cmp(&b.explained_percent));
        let most = most.map_or(String::new(), |class| {
            format!(": the most that one of them could explain by chance or not is {}", class.with_share())
        });
        return format!("something is left, but these readings tell no variable on which it depends{most}");
    };
    // What leaves structure is no evidence against a variable that could not be tested and leaves less.
    let hidden = |class: &&&Dependence| judged.unfinished && class.left_rms_percent < leading.left_rms_percent;
    let open: Vec<&Dependence> = untestable.iter().filter(hidden).copied().collect();
    let untestable: Vec<String> = untestable.iter().map(|class| format!("the {}", class.name())).collect();
    let mut text = claim(leading, &found.tied().collect::<Vec<_>>(), &open);
    let excluded = |most: bool| -> Vec<String> {
        let all = found.classes.iter().filter(|class| class.standing == Standing::Excluded);
        all.filter(|class| (class.explained_percent >= MOST) == most).map(Dependence::with_share).collect()
    };
    if !excluded(false).is_empty() {
        text += &format!(", not on {}", excluded(false).join(", nor on "));
    }
    if !excluded(true).is_empty() {
        text += &format!("; less than that is explained by {}", excluded(true).join(", by "));
    }
    let further = list(found, Standing::Further, |class| {
        format!("{} together explain {} %", class.name(), share(class.explained_percent))
    });
    if !further.is_empty() {
        text += &format!("; {}", further.join(", "));
    }
    if open.is_empty() && !untestable.is_empty() {
        text += &format!("; not to be told of {}", untestable.join(", "));
    }
    text
}

/// What is said of the leading class, those that are tied with it, and those that may be what the leading one follows
/// in part.
fn claim(leading: &Dependence, tied: &[&Dependence], open: &[&Dependence]) -> String {
    let amount = share(leading.explained_percent);
    if !open.is_empty() {
        let names: Vec<String> = open.iter().map(|class| format!("the {}", class.name())).collect();
        return format!(
            "what is missing may depend on {}, which leaves structure, or on {}: these readings do not tell them apart, another \
             sweep at a third or three times the drive would",
            leading.with_share(),
            names.join(" or on ")
        );
    }
    if leading.explained_percent < MOST {
        let others: Vec<String> = tied.iter().map(|class| class.with_share()).collect();
        let tied = if others.is_empty() { String::new() } else { format!(", tied with {}", others.join(", ")) };
        return format!(
            "most of what is missing depends on none of these variables: {} explains most{tied}",
            leading.with_share()
        );
    }
    if !tied.is_empty() {
        let names: Vec<String> = [leading].iter().chain(tied).map(|class| class.with_share()).collect();
        return format!(
            "what is missing depends on {} (of the misfit at most), which these readings do not tell apart",
            names.join(" or on ")
        );
    }
    if leading.variables == [Variable::Drift] {
        return format!(
            "what is missing changes from series to series (that can explain at most {amount} % of the misfit): drift, or a law of what was \
             set for each of them"
        );
    }
    format!("what is missing depends on the {} (it can explain at most {amount} % of the misfit)", leading.name())
}

fn list(found: &FreeForm, standing: Standing, words: impl Fn(&Dependence) -> String) -> Vec<String> {
    found.classes.iter().filter(|class| class.standing == standing).map(words).collect()
}

/// The free form in lines of a terminal: what it comes to, and `with_table` what each class leaves and its notes.
pub fn lines(found: &FreeForm, with_table: bool) -> Vec<String> {
    let mut lines = vec![format!("free form: {}", found.statement)];
    if with_table && !found.classes.is_empty() {
        lines.push("  left by smooth k and c of:           rms   explains  left-out".into());
    }
    for class in found.classes.iter().filter(|_| with_table) {
        let predicted = class.predicted_rms_percent.map_or("-".into(), |percent| format!("{percent:.1} %"));
        let standing = match class.standing {
            Standing::Leading => "  <- the least",
            Standing::Tied => "  tied",
            Standing::Untestable => "  cannot be told",
            Standing::Further => "  less yet",
            _ => "",
        };
        let (name, left) = (class.name(), class.left_rms_percent);
        let explained = format!("{} %", share(class.explained_percent));
        lines.push(format!("  {name:<30} {left:>8.1} % {explained:>9} {predicted:>9}{standing}"));
    }
    if !found.shapes.is_empty() {
        let named = found.shapes.iter().take(SHAPES).filter(|s| s.left_rms_percent < WHOLE);
        let named = named.map(|s| format!("{} (leaves {:.1} %)", s.effect, s.left_rms_percent));
        let named: Vec<String> = named.collect();
        let none = || "none of the catalogue".into();
        lines.push(format!("  nearest in shape: {}", if named.is_empty() { none() } else { named.join(", ") }));
    }
    if with_table {
        lines.extend(found.notes.iter().map(|note| format!("  note: {note}")));
    } else if !found.classes.is_empty() {
        lines.push("  each class, and what to heed: --free-form".into());
    }
    lines
}
