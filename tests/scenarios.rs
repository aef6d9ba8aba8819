//! Scenario files: every form that is read, and what is said about those that are broken.
//!
//! Each file of `tests/broken` has its message under `tests/snapshots`, word for word.

use std::path::{Path, PathBuf};

use stickslip::effects::{Effect, Group, ParameterInfo, Zero, find};
use stickslip::error::Error;
use stickslip::scenario::parameters::FIGURES;
use stickslip::scenario::{self, Formulation, LoadOptions, Scenario};

/// An effect that only the tests know.
struct Fake;

impl Effect for Fake {
    fn name(&self) -> &'static str {
        "fake-effect"
    }

    fn parameters(&self) -> &'static [ParameterInfo] {
        const fn info(key: &'static str, unit: &'static str, meaning: &'static str) -> ParameterInfo {
            ParameterInfo::searched((key, "", unit), (0.0, 1.0), (0.1, 1.0), meaning)
        }
        const LIST: &[ParameterInfo] =
            &[info("strength", "1", "strength of nothing"), info("lag", "s", "time until nothing")];
        LIST
    }

    fn title(&self) -> &'static str {
        "Fake"
    }

    fn group(&self) -> Group {
        Group::Interface
    }

    fn equation(&self) -> &'static str {
        ""
    }

    fn meaning(&self) -> &'static str {
        ""
    }

    fn source(&self) -> &'static str {
        ""
    }

    fn fingerprint(&self) -> &'static str {
        ""
    }

    fn zero(&self) -> &'static [Zero] {
        &[]
    }
}

fn load(path: impl AsRef<Path>) -> Result<Scenario, Error> {
    let real = ["lugre", "partial-slip", "sensor-delay"].map(|name| find(name).expect("registered"));
    scenario::load_with(path, &LoadOptions { figure_names: FIGURES, effects: &[&Fake, real[0], real[1], real[2]] })
}

fn message(path: impl AsRef<Path>) -> String {
    let error = load(path).expect_err("the file is broken");
    assert_eq!(error.exit_code(), 2, "{error}");
    error.to_string()
}

/// A folder with one file `scenario.toml`; messages name it without the folder.
fn written(content: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scenario.toml");
    std::fs::write(&path, content).expect("a file");
    (folder, path)
}

fn message_for(content: &[u8]) -> String {
    let (folder, path) = written(content);
    message(&path).replace(&format!("{}/", folder.path().display()), "")
}

const BASE: &str = include_str!("broken/base.toml");
const SWEEP: &str = "[sweep]\nfrequency = 72\nspeed = 0.02\nload = 20\ndrive = 2.5e-6\n";

fn sound(sweep: &str) -> Scenario {
    let (_folder, path) = written(format!("{BASE}\n{sweep}").as_bytes());
    load(&path).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_broken_file_has_its_message() {
    let mut names: Vec<_> = std::fs::read_dir("tests/broken")
        .expect("the folder is there")
        .map(|entry| entry.expect("its entries can be read").path())
        .filter(|path| path.file_stem().is_some_and(|stem| stem != "base"))
        .collect();
    names.sort();
    assert!(names.len() >= 60);
    for path in names {
        let stem = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let text = message(&path);
        assert!(!text.contains('\u{1b}'), "{stem}: colour codes were not asked for");
        insta::assert_snapshot!(stem, text);
    }
}

#[test]
fn files_that_are_not_text_are_refused() {
    insta::assert_snapshot!("binary", message_for(b"title = 'x'\n\x00\xff\xfe\x80"));
    insta::assert_snapshot!("control-character", message_for(b"title = 'x'\n\x00\n"));
    insta::assert_snapshot!("empty", message_for(b""));
    insta::assert_snapshot!("only-a-byte-order-mark", message_for("\u{feff}\r\n".as_bytes()));
    insta::assert_snapshot!("missing", message("tests/broken/no-such-file.toml"));
    insta::assert_snapshot!("folder", message("tests/broken"));
    insta::assert_snapshot!("table-of-measurements", message_for(b"speed_m_s,load_n\n0.1,20\n"));
}

#[test]
fn a_file_of_100_megabytes_is_refused_before_it_is_read() {
    let (folder, path) = written(b"");
    std::fs::OpenOptions::new().write(true).open(&path).and_then(|file| file.set_len(100_000_000)).expect("sparse");
    let text = message(&path).replace(&format!("{}/", folder.path().display()), "");
    insta::assert_snapshot!("too-large", text);
}

#[test]
fn a_hundred_thousand_problems_are_told_shortly() {
    let text: String = (0..100_000).map(|n| format!("k{n}=1\n")).collect();
    let message = message_for(text.as_bytes());
    assert!(message.ends_with("more problems are not shown") && message.len() < 10_000, "{message}");
}

#[cfg(unix)]
#[test]
fn a_link_does_not_lead_out_of_the_folder() {
    let (_outside, target) = written(BASE.as_bytes());
    let (folder, path) = written(format!("extends = 'link.toml'\n{SWEEP}").as_bytes());
    std::os::unix::fs::symlink(target, folder.path().join("link.toml")).expect("a link");
    assert!(message(path).contains("leaves the scenario's folder"));
}

#[test]
fn the_folder_called_scenarios_is_the_root() {
    let folder = tempfile::tempdir().expect("a folder");
    let deep = folder.path().join("scenarios/rubber/soft");
    std::fs::create_dir_all(&deep).expect("folders");
    std::fs::write(folder.path().join("scenarios/base.toml"), BASE).expect("a file");
    std::fs::write(deep.join("a.toml"), format!("extends = '../../base.toml'\n{SWEEP}")).expect("a file");
    assert_eq!(load(deep.join("a.toml")).expect("sound").id, "rubber/soft/a");
    assert_eq!(scenario::discover(folder.path()), vec![deep.join("a.toml")], "the base is not listed");
}

#[test]
fn every_form_of_a_number_is_read() {
    let same = [
        "speed = 0.02\ndrive = 2.5e-6\nload = 20\nfrequency = 72",
        "speed = '20 mm/s'\ndrive = '2.5 um'\nload = '20 N'\nfrequency = '72 Hz'",
        "speed = ['0.02 m/s']\ndrive = '2.5 µm'\nload = '0.02 kN'\nfrequency = '0.072 kHz'",
        "speed = '2 cm/s'\ndrive = '2.5 μm'\nload = 20.0\nfrequency = [72.0]",
    ];
    let first = sound(&format!("[sweep]\n{}", same[0])).sweep;
    for text in same {
        let sweep = sound(&format!("[sweep]\n{text}")).sweep.expect("a sweep");
        let first = first.as_ref().expect("a sweep");
        for (a, b) in [(&sweep.speed, &first.speed), (&sweep.drive, &first.drive), (&sweep.load, &first.load)] {
            assert_eq!(a, b, "{text}");
        }
        assert_eq!(sweep.frequency, [72.0]);
    }
}

#[test]
fn ranges_meet_both_ends() {
    let text = SWEEP
        .replace("0.02", "{ from = '0.001 mm/s', to = '0.3 mm/s', points = 61, spacing = 'log' }")
        .replace("72", "{ from = 50, to = 100, points = 101 }");
    let sweep = sound(&text).sweep.expect("a sweep");
    assert_eq!((sweep.frequency[0], sweep.frequency[1], sweep.frequency[100]), (50.0, 50.5, 100.0));
    assert_eq!((sweep.speed[0], sweep.speed[60], sweep.speed.len()), (1e-6, 3e-4, 61));
    assert!((sweep.speed[30] / (1e-6f64 * 3e-4).sqrt() - 1.0).abs() < 1e-12);
    assert_eq!(sweep.points(), 6161);
}

#[test]
fn optional_axes_fall_back_on_the_scenario() {
    let sweep = sound(SWEEP).sweep.expect("a sweep");
    assert_eq!((sweep.friction, sweep.formulation), (vec![0.5], vec![Formulation::Series]));
    assert_eq!(sweep.euler_steps, [stickslip::scenario::DEFAULT_EULER_STEPS]);
    let text =
        format!("{SWEEP}friction = ['20 %', 0.3]\nformulation = ['series', 'paper']\neuler_steps = [2000, 8000]\n");
    let sweep = sound(&text).sweep.expect("a sweep");
    assert_eq!((sweep.friction.as_slice(), sweep.points()), (&[0.2, 0.3][..], 6));
}

#[test]
fn effects_measurements_and_free_parameters_are_kept_in_order() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("table.csv"), "speed_m_s\n").expect("a file");
    let text = format!(
        "{BASE}\n[[effect]]\nname = 'fake-effect'\nlag = '1 ms'\nstrength = '5 %'\n\
         [measurement]\nfile = 'table.csv'\ncolumns = {{ frequency = 'f [Hz]' }}\n\
         [instrument]\nphase_offset = '10 deg'\n\
         [fit]\nfree = ['effect.fake-effect.lag', 'contact.stiffness', 'instrument.drive_gain']\n"
    );
    let path = folder.path().join("own.toml");
    std::fs::write(&path, text).expect("a file");
    let scenario = load(&path).expect("sound");
    assert_eq!(scenario.effects[0].parameters, [0.05, 0.001]);
    assert_eq!(scenario.free, ["effect.fake-effect.lag", "contact.stiffness", "instrument.drive_gain"]);
    let source = scenario.measurement.expect("a table");
    assert_eq!(source.file, folder.path().join("table.csv"));
    assert_eq!(source.columns, [("frequency".to_string(), "f [Hz]".to_string())]);
    assert!((scenario.instrument.phase_offset - 10f64.to_radians()).abs() < 1e-15);
    assert_eq!((scenario.sweep, scenario.id.as_str()), (None, "own"));
}

#[test]
fn byte_order_marks_and_windows_line_ends_are_tolerated() {
    let text = format!("\u{feff}{BASE}\n{SWEEP}").replace('\n', "\r\n");
    let (_folder, path) = written(text.as_bytes());
    assert_eq!(load(path).expect("sound").title, "A sound base");
}

#[test]
fn a_file_changes_single_keys_of_what_it_extends() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).expect("a file");
    write("base.toml", format!("{BASE}\n{SWEEP}"));
    write("middle.toml", "extends = 'base.toml'\n[contact]\nfriction = 0.9\n[sweep]\nspeed = [0.1, 0.2]\n".into());
    write("top.toml", "extends = './middle.toml'\ntitle = 'Top'\n[sweep]\nspeed = 0.3\n".into());
    let (top, middle) = (load(folder.path().join("top.toml")), load(folder.path().join("middle.toml")));
    let (top, middle) = (top.expect("sound"), middle.expect("sound"));
    assert_eq!(
        (top.contact.unwrap().friction, top.contact.unwrap().stiffness, top.title.as_str()),
        (0.9, 8.9e4, "Top")
    );
    assert_eq!(top.sweep.map(|sweep| sweep.speed), Some(vec![0.3]));
    assert_eq!(middle.sweep.map(|sweep| sweep.speed), Some(vec![0.1, 0.2]));
    write("base.toml", format!("{BASE}\n# a remark\n{SWEEP}"));
    let again = load(folder.path().join("top.toml")).expect("sound");
    assert_ne!(top.hash, again.hash, "the hash covers what is extended");
}

#[test]
fn every_embedded_scenario_is_sound_and_the_same_as_on_disk() {
    let names = scenario::embedded_names();
    assert!(names.contains(&"paper/figure-6".to_string()) && !names.contains(&"paper/rig".to_string()));
    for name in names {
        let embedded = scenario::load_embedded(&name).unwrap_or_else(|error| panic!("{error}"));
        let disk = scenario::load(format!("scenarios/{name}.toml")).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((&embedded.hash, &embedded.id, &embedded.sweep), (&disk.hash, &disk.id, &disk.sweep));
        assert!(!embedded.description.is_empty() && !embedded.provenance.is_empty(), "{name}");
        let tables = [&embedded, &disk].map(|s| stickslip::measurement::load(s).unwrap().map(|table| table.points));
        assert_eq!(tables[0], tables[1], "{name}");
        assert!((embedded.figures.is_some() || tables[0].is_some()) && embedded.rig == scenario::paper().rig, "{name}");
    }
    insta::assert_snapshot!("unknown-embedded", scenario::load_embedded("paper/figure6").expect_err("typo"));
}

#[test]
fn the_published_numbers_are_those_of_the_paper() {
    let paper = scenario::paper();
    assert_eq!(
        (paper.rig.arm().inertia, paper.rig.arm().torsional_stiffness, paper.rig.arm().torsional_damping),
        (5e-3, 990.0, 0.43)
    );
    assert_eq!((paper.rig.arm().spring_stiffness, paper.rig.arm().spring_damping), (1.6e4, 12.0));
    assert_eq!((paper.rig.arm().spring_arm, paper.rig.arm().contact_arm), (0.03, 0.06));
    assert_eq!(
        (paper.contact.unwrap().stiffness, paper.contact.unwrap().damping, paper.contact.unwrap().friction),
        (8.9e4, 26.0, 0.5)
    );
    assert_eq!(paper.sweep, None);
}

#[test]
fn nothing_panics_whatever_the_bytes() {
    let sources = [
        format!("{BASE}\n{SWEEP}"),
        stickslip::scenario::TEMPLATE.to_string(),
        include_str!("broken/several-problems.toml").to_string(),
        include_str!("broken/wide-characters.toml").to_string(),
        include_str!("../scenarios/paper/ridge.toml").replace("rig.toml", "base.toml"),
    ];
    let (folder, path) = written(b"");
    std::fs::write(folder.path().join("base.toml"), BASE).expect("a file");
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below.max(1) as u64) as usize
    };
    const SPLICES: &[&str] =
        &["9e999", "\"", "'''", "[", "{", "}", "=", "\n", "µ", "-0", "nan", "^", "/", "1e18", "\u{feff}", "\r", "🙂"];
    let mut sound = 0;
    for round in 0..4000 {
        let mut bytes = sources[round % sources.len()].clone().into_bytes();
        for _ in 0..=random(4) {
            let at = random(bytes.len());
            match random(4) {
                0 => bytes[at] = random(256) as u8,
                1 => drop(bytes.drain(at..(at + random(40)).min(bytes.len()))),
                2 => drop(bytes.splice(at..at, SPLICES[random(SPLICES.len())].bytes())),
                _ => {
                    let copy = bytes[at..(at + random(60)).min(bytes.len())].to_vec();
                    let to = random(bytes.len());
                    drop(bytes.splice(to..to, copy));
                }
            }
        }
        std::fs::write(&path, &bytes).expect("a file");
        match load(&path) {
            Ok(_) => sound += 1,
            Err(error) => assert_eq!(error.exit_code(), 2, "{error}"),
        }
    }
    assert!(sound > 100, "some mutations leave a sound file: {sound}");
}

#[test]
fn check_tells_the_problems_of_all_files_at_once() {
    let paths = ["tests/broken/unknown-key.toml", "scenarios/paper/figure-6.toml", "tests/broken/nan.toml"];
    let error = stickslip::cli::check::execute(&paths.map(PathBuf::from)).expect_err("two are broken");
    assert_eq!(error.exit_code(), 2);
    let text = error.to_string();
    assert!(text.contains("unknown-key.toml:14:1") && text.contains("nan.toml:6:21"), "{text}");
    assert!(stickslip::cli::check::execute(&["scenarios".into()]).is_ok());
    assert!(stickslip::cli::check::execute(&[]).is_ok());
}

#[test]
fn init_writes_sound_files_and_never_overwrites() {
    let folder = tempfile::tempdir().expect("a folder");
    let dir = folder.path().join("new");
    stickslip::cli::init::execute(&dir).expect("an empty folder");
    let own = dir.join("my-rig.toml");
    assert_eq!(scenario::load(&own).expect("the template is valid as it stands").rig, scenario::paper().rig);
    assert_eq!(scenario::discover(&dir).len(), scenario::embedded_names().len() + 1);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        assert_eq!(std::fs::metadata(&own).expect("there").permissions().mode() & 0o777, 0o644);
    }
    std::fs::remove_file(dir.join("scenarios/paper/rig.toml")).expect("removed");
    std::fs::write(&own, "mine").expect("a file");
    let error = stickslip::cli::init::execute(&dir).expect_err("files exist");
    assert_eq!(error.exit_code(), 2);
    assert!(error.to_string().contains("my-rig.toml"), "{error}");
    assert_eq!(std::fs::read_to_string(&own).expect("there"), "mine");
    assert!(!dir.join("scenarios/paper/rig.toml").exists(), "nothing is written where anything exists");
}
