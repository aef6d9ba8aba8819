//! The table `[sweep]`: axes given as a scalar, a list or a range, whose product is counted before it is built.

use super::diagnostic::{Place, nearest, quote, suggestion};
use super::parameters::{MAX_POINTS, SWEEP};
use super::reader::{Reader, Table};
use super::types::{Contact, Formulation, Sweep};
use super::written::{Entry, Node, Value};
use crate::parameter::ParameterInfo;

/// Steps per cycle of the Euler procedure where a scenario gives none.
pub const DEFAULT_EULER_STEPS: usize = 20_000;

/// An axis as it was written; ranges are not expanded before the product is known to be small enough.
enum Axis {
    List(Vec<f64>),
    Range { from: f64, to: f64, points: u64, logarithmic: bool },
}

impl Axis {
    fn len(&self) -> u128 {
        match self {
            Self::List(values) => values.len() as u128,
            Self::Range { points, .. } => u128::from(*points),
        }
    }

    /// The values; both ends are met exactly.
    fn values(self) -> Vec<f64> {
        let (from, to, points, logarithmic) = match self {
            Self::List(values) => return values,
            Self::Range { from, to, points, logarithmic } => (from, to, points, logarithmic),
        };
        let last = (points - 1) as f64;
        let at = |index: u64| match index {
            0 => from,
            index if index == points - 1 => to,
            index if logarithmic => from * (to / from).powf(index as f64 / last),
            index => from + (to - from) * (index as f64 / last),
        };
        (0..points).map(at).collect()
    }
}

impl Sweep {
    /// Number of steady states: the product of the axes, where the Euler steps multiply the published procedure only.
    pub fn points(&self) -> usize {
        let axes = [&self.frequency, &self.speed, &self.load, &self.drive, &self.friction];
        let cases: usize = axes.iter().map(|axis| axis.len()).product();
        cases
            * self
                .formulation
                .iter()
                .map(|f| if *f == Formulation::Paper { self.euler_steps.len() } else { 1 })
                .sum::<usize>()
    }
}

/// Reads `[sweep]`.
///
/// Without a contact there is neither speed nor load. `contact` is `None` where its table is not sound; `drive` is the
/// unit of what drives the rig.
pub(crate) fn sweep(
    reader: &mut Reader<'_>,
    table: &Table<'_>,
    drive: &'static str,
    contact: Option<Option<Contact>>,
) -> Option<Sweep> {
    let alone = matches!(contact, Some(None));
    let contact = contact.map(|contact| contact.unwrap_or(Contact::NONE));
    let infos: Vec<ParameterInfo> = SWEEP
        .iter()
        .map(|info| ParameterInfo { unit: if info.key == "drive" { drive } else { info.unit }, ..*info })
        .collect();
    let of_contact = |info: &&ParameterInfo| !["frequency", "drive"].contains(&info.key);
    let needed: Vec<_> =
        infos[..4].iter().filter(|info| !alone || !of_contact(info)).map(|info| (info.key, info.unit)).collect();
    let optional: Vec<_> = infos[4..].iter().map(|info| info.key).chain(["formulation"]).filter(|_| !alone).collect();
    reader.keys(table, &needed, &optional);

    let mut read = |key: &str| -> Option<Option<Axis>> {
        let info = infos.iter().find(|info| info.key == key)?;
        if alone && of_contact(&info) {
            return Some((info.key != "friction" && info.key != "euler_steps").then(|| Axis::List(vec![0.0])));
        }
        table.get(key).map_or(Some(None), |node| axis(reader, node, info).map(Some))
    };
    let (frequency, speed, load) = (read("frequency"), read("speed"), read("load"));
    let (drive, friction, steps) = (read("drive"), read("friction"), read("euler_steps"));
    let formulation = match table.get("formulation") {
        Some(node) => formulations(reader, node)?,
        None => vec![contact?.formulation],
    };
    let friction = friction?.unwrap_or(Axis::List(vec![contact?.friction]));
    let steps = steps?.unwrap_or(Axis::List(vec![DEFAULT_EULER_STEPS as f64]));
    let axes = [frequency??, speed??, load??, drive??, friction, steps];

    // Euler steps multiply the published procedure only.
    let each = |one: &Formulation| if *one == Formulation::Paper { axes[5].len() } else { 1 };
    let methods = formulation.iter().map(each).sum();
    let mut counts: Vec<_> = SWEEP[..5].iter().map(|info| info.key).zip(axes[..5].iter().map(Axis::len)).collect();
    counts.push(("formulation and euler_steps", methods));
    let total = counts.iter().try_fold(1u128, |product, (_, n)| product.checked_mul(*n));
    if total.is_none_or(|total| total > MAX_POINTS) {
        let count = total.map_or("more than 10^38".into(), |total| total.to_string());
        let factors: Vec<_> = counts.iter().filter(|(_, n)| *n > 1).map(|(name, n)| format!("{n} of {name}")).collect();
        let title = format!("[sweep] asks for {count} points, at most {MAX_POINTS} are solved");
        let help = "shorten a list or lower `points`; the axes are multiplied with each other";
        reader.fail(&table.place, &title, &factors.join(" × "), help);
        return None;
    }
    let [frequency, speed, load, drive, friction, steps] = axes.map(Axis::values);
    let euler_steps = steps.into_iter().map(|n| n as usize).collect();
    Some(Sweep { frequency, speed, load, drive, friction, formulation, euler_steps })
}

fn axis(reader: &mut Reader<'_>, node: &Node, info: &ParameterInfo) -> Option<Axis> {
    match &node.value {
        Value::Table(entries) => range(reader, node, entries, info),
        Value::List(items) => {
            if items.is_empty() {
                let help = "give at least one value, or leave the key out where it is optional";
                reader.fail(&node.place, &format!("`{}` is an empty list", info.key), "no value", help);
                return None;
            }
            let values: Vec<_> = items.iter().map(|item| value(reader, item, info)).collect();
            let values: Vec<f64> = values.into_iter().collect::<Option<_>>()?;
            in_order(reader, items, &values, info).then_some(Axis::List(values))
        }
        _ => value(reader, node, info).map(|value| Axis::List(vec![value])),
    }
}

/// One value of an axis; Euler steps are whole numbers.
fn value(reader: &mut Reader<'_>, node: &Node, info: &ParameterInfo) -> Option<f64> {
    let value = reader.quantity(node, info)?;
    if info.key == "euler_steps" && value.fract() != 0.0 {
        reader.fail(&node.place, "`euler_steps` needs whole numbers", "not a whole number", "write e.g. 20000");
        return None;
    }
    Some(value)
}

/// No value twice, and frequencies ascending, because curves are drawn along them.
fn in_order(reader: &mut Reader<'_>, items: &[Node], values: &[f64], info: &ParameterInfo) -> bool {
    let mut sorted: Vec<usize> = (0..values.len()).collect();
    sorted.sort_by(|a, b| values[*a].total_cmp(&values[*b]).then(a.cmp(b)));
    if let Some(pair) = sorted.windows(2).find(|pair| values[pair[0]] == values[pair[1]]) {
        let title = format!("`{}` has the same value twice", info.key);
        reader.fail(&items[pair[1]].place, &title, "appeared before", "remove one of the two");
        return false;
    }
    if info.key == "frequency"
        && let Some(at) = (1..values.len()).find(|at| values[at - 1] > values[*at])
    {
        let help = "list the frequencies from the lowest to the highest";
        reader.fail(&items[at].place, "`frequency` needs to ascend", "lower than the one before", help);
        return false;
    }
    true
}

/// `{ from, to, points, spacing }`.
fn range(reader: &mut Reader<'_>, node: &Node, entries: &[Entry], info: &ParameterInfo) -> Option<Axis> {
    let name = format!("the range of `{}`", info.key);
    let table = Table { name: name.clone(), place: node.place.clone(), entries };
    reader.keys(&table, &[("from", info.unit), ("to", info.unit), ("points", "count")], &["spacing"]);
    let logarithmic = match table.get("spacing") {
        None => false,
        Some(node) => match reader.text("spacing", node)?.as_str() {
            "linear" => false,
            "log" => true,
            other => {
                let label = suggestion(nearest(other, ["linear", "log"]), "neither of the two");
                let title = format!("unknown spacing {}", quote(other));
                reader.fail(&node.place, &title, &label, "spacing is \"linear\" (the default) or \"log\"");
                return None;
            }
        },
    };
    let (from_node, to_node, points_node) = (table.get("from")?, table.get("to")?, table.get("points")?);
    let (from, to) = (value(reader, from_node, info), value(reader, to_node, info));
    let points = points(reader, points_node);
    let (from, to, points) = (from?, to?, points?);
    let mut fail = |place: &Place, title: String, label: &str, help: &str| {
        reader.fail(place, &title, label, help);
        None
    };
    if from >= to {
        let title = format!("{name} ends where it starts or below");
        return fail(&to_node.place, title, "not above `from`", "swap `from` and `to`, or give a single value");
    }
    if logarithmic && from <= 0.0 {
        let title = format!("{name} cannot be spaced logarithmically from 0");
        return fail(&from_node.place, title, "needs to be above 0", "start above 0, or use spacing = \"linear\"");
    }
    if info.key == "euler_steps" {
        let title = format!("`{}` needs a list of whole numbers", info.key);
        return fail(&node.place, title, "a range may miss whole numbers", "write e.g. [2000, 8000, 32000]");
    }
    Some(Axis::Range { from, to, points, logarithmic })
}

fn points(reader: &mut Reader<'_>, node: &Node) -> Option<u64> {
    match node.value {
        Value::Number(n) if n.fract() == 0.0 && (2.0..=9e15).contains(&n) => Some(n as u64),
        _ => {
            let help = "`points` counts both ends; write e.g. points = 101";
            reader.fail(&node.place, "`points` needs a whole number of at least 2", "not such a number", help);
            None
        }
    }
}

fn formulations(reader: &mut Reader<'_>, node: &Node) -> Option<Vec<Formulation>> {
    let items = match &node.value {
        Value::List(items) if items.is_empty() => {
            reader.fail(
                &node.place,
                "`formulation` is an empty list",
                "no value",
                "write \"series\", \"paper\" or both",
            );
            return None;
        }
        Value::List(items) => items.as_slice(),
        _ => std::slice::from_ref(node),
    };
    let mut list = Vec::new();
    for item in items {
        let one = formulation(reader, item)?;
        if list.contains(&one) {
            reader.fail(
                &item.place,
                "`formulation` names the same one twice",
                "appeared before",
                "remove one of the two",
            );
            return None;
        }
        list.push(one);
    }
    Some(list)
}

/// `"series"` or `"paper"`.
pub(crate) fn formulation(reader: &mut Reader<'_>, node: &Node) -> Option<Formulation> {
    match reader.text("formulation", node)?.as_str() {
        "series" => Some(Formulation::Series),
        "paper" => Some(Formulation::Paper),
        other => {
            let label = suggestion(nearest(other, ["series", "paper"]), "neither of the two");
            let help = "formulation is \"series\" (bristles in series with a slip interface, the default) \
                        or \"paper\" (the published Euler procedure)";
            reader.fail(&node.place, &format!("unknown formulation {}", quote(other)), &label, help);
            None
        }
    }
}
