//! Rewriting scenario files: only what was asked for changes, whatever style the file is written in.

use std::path::{Path, PathBuf};
use stickslip::scenario::edit::{Changes, Editable, Estimate};
use stickslip::scenario::load_text;

const RIG: &str = r#"# A rig.
title = "Rig"  # of mine

[rig]
inertia = "5.0e-3 kg m^2"
torsional_stiffness = "990 N m/rad"
torsional_damping = 0.43
spring_stiffness = "1.6e4 N/m"
spring_damping = "12 N s/m"
spring_arm = "30 mm"
contact_arm = "60 mm"     # b
"#;
const CONTACT: &str = "
[contact]   # the rubber
stiffness = \"8.9e4 N/m\"              # kc; from the maker
damping = 26
# mu is a guess
friction = 0.5
";
const SWEEP: &str = "
[sweep]
frequency = \"72 Hz\"
speed = 0
load = 20
drive = \"2.5 um\"
";
const FIT: &str = "
[fit]
free = [\"contact.stiffness\", 'contact.damping']
# The end.
";

fn estimate(key: &str, value: f64, unit: &'static str) -> Estimate {
    Estimate {
        key: key.into(),
        value,
        unit,
        low: Some(0.99 * value),
        high: Some(1.01 * value),
        detectable_change: f64::INFINITY,
        contradicted: false,
    }
}

fn values() -> Vec<Estimate> {
    vec![
        estimate("contact.stiffness", 88_843.0, "N/m"),
        estimate("contact.damping", 25.917, "N s/m"),
        estimate("effect.rate-strengthening.beta", 0.150_58, "1"),
        estimate("effect.rate-strengthening.v_0", 2.1e-4, "m/s"),
    ]
}

const BASE: [&str; 2] = ["contact.stiffness", "contact.damping"];

fn free(effect: &[&str]) -> Vec<String> {
    BASE.iter().chain(effect).map(|key| (*key).to_string()).collect()
}

const NEW: [&str; 2] = ["effect.rate-strengthening.beta", "effect.rate-strengthening.v_0"];

struct Files(tempfile::TempDir);

impl Files {
    fn new(files: &[(&str, &str)]) -> Self {
        let dir = tempfile::tempdir().unwrap();
        for (name, text) in files {
            std::fs::write(dir.path().join(name), text).unwrap();
        }
        Self(dir)
    }
    fn path(&self) -> PathBuf {
        self.0.path().join("mine.toml")
    }
    fn apply(&self, changes: &Changes) -> String {
        let file = Editable::open(&self.path()).unwrap_or_else(|error| panic!("{error}"));
        file.apply(changes).unwrap_or_else(|error| panic!("{error}"))
    }
    fn added(&self) -> String {
        let add = vec!["rate-strengthening".into()];
        self.apply(&Changes { values: values(), add, free: free(&NEW), ..Changes::default() })
    }
    fn removed(&self) -> String {
        let remove = Some("rate-strengthening".into());
        self.apply(&Changes { values: values()[..2].to_vec(), remove, free: free(&[]), ..Changes::default() })
    }
}

/// Adds an effect, checks what the text says, takes it out again; both texts.
fn round(parents: &[(&str, &str)], text: &str) -> (String, String) {
    let mut files = parents.to_vec();
    files.push(("mine.toml", text));
    let files = Files::new(&files);
    let added = files.added();
    check(&files.path(), &added, true);
    std::fs::write(files.path(), &added).unwrap();
    let removed = files.removed();
    check(&files.path(), &removed, false);
    (added, removed)
}

fn check(path: &Path, text: &str, with: bool) {
    let scenario = load_text(path, text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert!((scenario.contact.unwrap().stiffness / 88_843.0 - 1.0).abs() < 1e-3, "{text}");
    assert!((scenario.contact.unwrap().damping / 25.917 - 1.0).abs() < 2e-3, "{text}");
    assert_eq!(scenario.contact.unwrap().friction, 0.5);
    let mine = scenario.effects.iter().find(|e| e.name() == "rate-strengthening");
    assert_eq!(mine.is_some(), with, "{text}");
    if let Some(mine) = mine {
        assert!((mine.parameters[0] / 0.150_58 - 1.0).abs() < 1e-3, "{text}");
        assert!((mine.parameters[1] / 2.1e-4 - 1.0).abs() < 1e-3, "{text}");
    }
    assert_eq!(scenario.free, free(if with { &NEW } else { &[] }), "{text}");
}

/// The text without the two numbers and what is said of them.
fn numberless(text: &str) -> String {
    let mut text = text.to_string();
    for number in ["8.9e4", "8.884e4", "25.92", "26"] {
        text = text.replace(number, "_");
    }
    let marks = text.split_inclusive('\n').map(|line| match line.find("95 %: ") {
        Some(at) => {
            let stop = line[at..].find(['\r', '\n', ';']).map_or(line.len(), |stop| at + stop);
            format!("{}{}", line[..at].trim_end_matches([' ', '#', ';']), &line[stop..])
        }
        None => line.to_string(),
    });
    marks.collect()
}

#[test]
fn comments_stay_and_the_numbers_say_how_well_they_are_known() {
    let text = [RIG, CONTACT, SWEEP, FIT].concat();
    let (added, removed) = round(&[], &text);
    let line = "stiffness = \"8.884e4 N/m\"              # kc; from the maker; 95 %: 8.795e4 to 8.973e4 N/m\n";
    assert!(added.contains(line), "{added}");
    assert!(added.contains("damping = 25.92  # 95 %: 25.66 to 26.18\n"), "{added}");
    assert!(added.contains("free = [\"contact.stiffness\", 'contact.damping', \"effect.rate-strengthening.beta\""));
    let effect = "# The end.\n\n[[effect]]\nname = \"rate-strengthening\"\nbeta = 0.1506  # 95 %: 0.1491 to 0.1521\n\
                  v_0 = \"0.2100 mm/s\"  # 95 %: 0.2079 to 0.2121 mm/s\n";
    assert!(added.ends_with(effect), "{added}");
    let rest = |text: &str| text.replace("8.884e4 N/m", "8.9e4 N/m").replace("; 95 %: 8.795e4 to 8.973e4 N/m", "");
    let rest = |text: &str| rest(text).replace("damping = 25.92  # 95 %: 25.66 to 26.18", "damping = 26");
    assert_eq!(rest(&removed), text);
    assert_eq!(
        rest(&added)
            .replace(&effect[11..], "")
            .replace(", \"effect.rate-strengthening.beta\", \"effect.rate-strengthening.v_0\"", ""),
        text
    );
}

#[test]
fn a_second_fit_replaces_what_the_first_said() {
    let text = [RIG, CONTACT, SWEEP, FIT].concat();
    let files = Files::new(&[("mine.toml", &text)]);
    let first = files.added();
    std::fs::write(files.path(), &first).unwrap();
    let again = files.apply(&Changes { values: values(), free: free(&NEW), ..Changes::default() });
    assert_eq!(first, again);
    let kept = first.replace("95 %: 25.66 to 26.18", "95 %: 1 to 2; by me");
    std::fs::write(files.path(), &kept).unwrap();
    let again = files.apply(&Changes { values: values(), free: free(&NEW), ..Changes::default() });
    assert!(again.contains("damping = 25.92  # 95 %: 25.66 to 26.18; by me\n"), "{again}");
}

#[test]
fn every_style_comes_back_as_it_was() {
    let inline = "contact = { stiffness = \"8.9e4 N/m\", damping = 26, friction = 0.5 } # rubber\n";
    let dotted = "contact.stiffness = \"8.9e4 N/m\" # kc\ncontact.damping = 26\ncontact.friction = 0.5\n";
    let head = |line: &str| RIG.replacen("title", &format!("{line}title"), 1);
    let fit = |list: &str| format!("\n[fit]\nfree = {list}\n");
    let other = "\n[[effect]] # one\nname = \"sensor-delay\"\ndelay = \"0.3 ms\" # tau\n";
    let delay = "{ name = \"sensor-delay\", delay = \"0.3 ms\" }";
    let key = stickslip::effects::find("sensor-delay").unwrap().parameters()[0].key;
    let (other, delay) = (other.replace("delay =", &format!("{key} =")), delay.replace("delay =", &format!("{key} =")));
    let styles = [
        [&head(inline), SWEEP, FIT].concat(),
        [&head(dotted), SWEEP, FIT].concat(),
        [RIG, CONTACT, SWEEP, FIT.trim_end()].concat(),
        [RIG, CONTACT, SWEEP, &fit("[\n    \"contact.stiffness\", # kc\n    \"contact.damping\" # cc\n]")].concat(),
        [RIG, CONTACT, SWEEP, &fit("[\n    \"contact.stiffness\", # kc\n    \"contact.damping\", # cc\n]")].concat(),
        [RIG, CONTACT, SWEEP, &fit("[ \"contact.stiffness\", \"contact.damping\", ]")].concat(),
        [RIG, CONTACT, SWEEP, &fit("[\"contact.stiffness\",\n        \"contact.damping\"]")].concat(),
        [&head("fit = { free = [\"contact.stiffness\", \"contact.damping\"] }\n"), CONTACT, SWEEP].concat(),
        [&head("fit.free = [\"contact.stiffness\", \"contact.damping\"]\n"), CONTACT, SWEEP].concat(),
        [RIG, CONTACT, &other, SWEEP, FIT].concat(),
        [RIG, CONTACT, SWEEP, FIT, &other].concat(),
        [RIG, CONTACT, SWEEP, FIT, other.trim_end()].concat(),
        [&head(&format!("effect = [{delay}] # effects\n")), CONTACT, SWEEP, FIT].concat(),
        [&head(&format!("effect = [\n  {delay}, # one\n]\n")), CONTACT, SWEEP, FIT].concat(),
        [&head(&format!("effect = [\n  {delay} # one\n]\n")), CONTACT, SWEEP, FIT].concat(),
        [&head("effect = []\n"), CONTACT, SWEEP, FIT].concat(),
    ];
    for text in styles {
        for text in [text.clone(), text.replace('\n', "\r\n")] {
            let (added, removed) = round(&[], &text);
            assert_eq!(numberless(&removed), numberless(&text), "{added}");
            assert_eq!(text.contains('\r'), added.contains('\r'));
            let bare = |text: &str| text.replace("\r\n", "").contains('\n');
            assert_eq!(text.contains('\r'), !bare(&added), "{added:?}");
        }
    }
}

#[test]
fn what_a_parent_states_is_overridden_here() {
    let parent = [RIG, CONTACT, FIT].concat();
    let child = format!("extends = \"rig.toml\"\ntitle = \"Child\"\n{SWEEP}");
    let (added, removed) = round(&[("rig.toml", &parent)], &child);
    assert!(added.starts_with(&child) && removed.starts_with(&child));
    let contact = "\n[contact]\nstiffness = \"8.884e4 N/m\"  # 95 %: 8.795e4 to 8.973e4 N/m\ndamping = 25.92  # 95 %: 25.66 to 26.18\n";
    assert!(added.contains(contact), "{added}");
    for (own, new) in [
        ("\n[contact]\n  friction = 0.5 # mu\n", "  friction = 0.5 # mu\n  stiffness = \"8.884e4 N/m\"  # 95 %"),
        ("\n[contact] # none\n", "[contact] # none\nstiffness = \"8.884e4 N/m\"  # 95 %"),
    ] {
        let (added, _) = round(&[("rig.toml", &parent)], &format!("{child}{own}"));
        assert!(added.contains(new), "{added}");
    }
    for (own, new) in [
        (
            "contact = { friction = 0.5 } # mu\n",
            "contact = { friction = 0.5, stiffness = \"8.884e4 N/m\", damping = 25.92 } # mu; 95 %: stiffness 8.795e4",
        ),
        ("contact = {}\n", "contact = { stiffness = \"8.884e4 N/m\", damping = 25.92 }  # 95 %: stiffness 8.795e4"),
        ("contact.friction = 0.5 # mu\n", "contact.friction = 0.5 # mu\ncontact.stiffness = \"8.884e4 N/m\"  # 95 %"),
    ] {
        let (added, _) = round(&[("rig.toml", &parent)], &format!("{own}{child}"));
        assert!(added.contains(new), "{added}");
    }
}

/// Two effects put in together are written as one after the other.
#[test]
fn two_effects_together_are_one_after_the_other() {
    let own = "\n[[effect]] # one\nname = \"sensor-delay\"\ntau = \"0.3 ms\"\n";
    let inline = |list: &str| [&format!("effect = {list}\n"), RIG, CONTACT, SWEEP, FIT].concat();
    let delay = "{ name = \"sensor-delay\", tau = \"0.3 ms\" }";
    let lag = estimate("effect.actuator-lag.tau", 1e-4, "s");
    let both: Vec<&str> = NEW.into_iter().chain(["effect.actuator-lag.tau"]).collect();
    for text in [
        [RIG, CONTACT, SWEEP, FIT].concat(),
        [RIG, CONTACT, own, SWEEP, FIT].concat(),
        [RIG, CONTACT, SWEEP, FIT, own].concat(),
        inline(&format!("[{delay}] # effects")),
        inline(&format!("[\n  {delay}, # one\n]")),
        inline("[]"),
    ] {
        let files = Files::new(&[("mine.toml", &text)]);
        let values: Vec<Estimate> = values().into_iter().chain([lag.clone()]).collect();
        let add = vec!["rate-strengthening".into(), "actuator-lag".into()];
        let together = files.apply(&Changes { values: values.clone(), add, free: free(&both), ..Changes::default() });
        std::fs::write(files.path(), files.added()).unwrap();
        let add = vec!["actuator-lag".into()];
        let apart = files.apply(&Changes { values, add, free: free(&both), ..Changes::default() });
        // An element of its own line has none to comment on before it stands.
        let bare = |text: &str| {
            text.lines().map(|line| line.split("  # 95 %").next()).map(|l| l.map(String::from)).collect::<Vec<_>>()
        };
        assert_eq!(bare(&together), bare(&apart));
        std::fs::write(files.path(), &together).unwrap();
        let scenario = stickslip::scenario::load(files.path()).unwrap_or_else(|error| panic!("{error}"));
        assert!(scenario.effects.len() >= 2 && scenario.free == free(&both), "{together}");
    }
}

#[test]
fn paths_are_replaced_where_they_stand() {
    let text = ["extends = 'rig.toml' # the rig\ntitle = \"x\"\n", SWEEP].concat();
    let files = Files::new(&[("rig.toml", &[RIG, CONTACT, FIT].concat()), ("mine.toml", &text)]);
    let changes = Changes { extends: Some("../a \"b\"/rig.toml".into()), free: free(&[]), ..Changes::default() };
    let new = files.apply(&changes);
    assert!(new.starts_with("extends = '../a \"b\"/rig.toml' # the rig\n"), "{new}");
    assert_eq!(new.lines().skip(1).collect::<Vec<_>>(), text.lines().skip(1).collect::<Vec<_>>());
}
