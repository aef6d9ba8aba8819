//! Tables that ask for more memory or time than they are worth.

use std::process::Command;

use super::{BASE, HEADER, csv, refused};

/// What `check` says of a table with so many MB of memory.
fn checked_within(megabytes: usize, name: &str, bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join(name), bytes).expect("a file");
    let scenario = folder.path().join("scenario.toml");
    std::fs::write(&scenario, format!("{BASE}\n[measurement]\nfile = '{name}'\n")).expect("a file");
    let limited = format!("ulimit -v {}; exec \"$0\" check \"$1\"", megabytes << 10);
    let mut command = Command::new("sh");
    command.args(["-c", &limited, env!("CARGO_BIN_EXE_stickslip")]).arg(&scenario).env("RAYON_NUM_THREADS", "1");
    let told = command.output().expect("a shell");
    let words = String::from_utf8_lossy(&told.stderr).into_owned();
    assert_eq!(told.status.code(), Some(2), "{words}");
    words
}

#[test]
#[cfg(target_os = "linux")]
fn a_table_takes_memory_in_proportion_to_its_file() {
    let commas = ",".repeat(66 << 20 >> 10 << 10).into_bytes();
    let words = checked_within(700, "commas.csv", &commas[..60 << 20]);
    assert!(words.contains("at most 16384 are read"), "{words}");
    let wide = format!("{}\n", ",".repeat(16_000)).repeat(4000);
    let words = checked_within(700, "blank.csv", wide.as_bytes());
    assert!(words.contains("nothing but remarks"), "{words}");
    let wide = format!("{HEADER}\n{}", format!("1{}\n", ",".repeat(16_000)).repeat(4000));
    let words = checked_within(700, "empty-cells.csv", wide.as_bytes());
    assert!(words.contains("the cell is empty"), "{words}");
}

#[test]
#[cfg(target_os = "linux")]
fn bad_rows_are_counted_and_not_kept() {
    let rows = "x,x,x,x,x,x,x,x\n".repeat(1_000_000);
    let words = checked_within(700, "bad.csv", format!("{HEADER}\n{rows}").as_bytes());
    assert!(words.contains("and 999999 more rows"), "{words}");
    assert_eq!(words.matches("error:").count(), 8, "{words}");
    let words = checked_within(700, "long.csv", format!("{HEADER}\n{}", "x,y\n".repeat(4_000_000)).as_bytes());
    assert!(words.contains("more than 1048576 rows"), "{words}");
}

#[test]
fn of_many_kinds_of_problems_the_first_are_told_and_the_rest_counted() {
    let rows: String = (9..60).map(|cells| format!("{}1\n", "1,".repeat(cells))).collect();
    let words = refused(&format!("{HEADER}\n{rows}{rows}"));
    assert!(
        words.matches("and 1 more row, line").count() == 20 && words.ends_with("error: 31 more problems are not shown")
    );
}

#[test]
fn many_readings_of_one_point_are_told_from_copies_in_a_moment() {
    let rows: String = (0..200_000).map(|run| format!("0.02,20,2.5e-6,60,1.5e-6,1.5e-8,-0.1,0.01,{run}\n")).collect();
    let table = csv(&format!("{HEADER},run\n{rows}"));
    assert_eq!((table.points.len(), table.points[0].replicates), (1, 200_000));
}

#[test]
fn the_place_in_a_line_that_is_too_long_to_be_shown_is_told() {
    let words = refused(&format!("{HEADER},{}\n0.02,20,2.5e-6,61,n/a,1.5e-8,-0.1,0.01,{}\n", "a", "b".repeat(100_000)));
    assert!(words.contains("table.csv:2:19:") && words.len() < 1000, "{words}");
}

#[test]
fn readings_beyond_all_numbers_are_refused() {
    // Found by fuzzing: one of them makes the estimated deviation infinite.
    let rows = "50,1.0,0.002702702702702703,0\n51,1.1,0.0038461538461538464,-10\n52,1.2,0.00588235294117641e308,-80\n\
                59,1.0,0.01,-90\n60,1.1,0.0058823529411764705,-100\n61,1.2,0.0038461538461538464,-110\n";
    let text = format!("f / Hz,Force [N],Acceleration [g],Phase (deg)\n{rows}");
    let words = stickslip::measurement::survey_bytes("t.csv", text.as_bytes()).expect_err("infinite").to_string();
    assert!(words.contains("beyond all numbers"), "{words}");
    // Repeated readings whose mean overflows.
    let rows =
        format!("{HEADER}\n{}", "0.02,20,2.5e-6,60,1.5e308,1e300,0,0.01\n0.02,20,2.5e-6,60,1.6e308,1e300,0,0.01\n");
    assert!(refused(&rows).contains("beyond all numbers"));
}

#[test]
fn a_deviation_below_the_rounding_of_its_reading_is_refused() {
    for (row, column) in [
        ("0.02,20,2.5e-6,60,1.5e-6,1.5e-8,-0.1,1e-30", "`phase_sd_rad`"),
        ("0.02,20,2.5e-6,60,1.5e-6,1e-30,-0.1,0.01", "`amplitude_sd_rad`"),
    ] {
        let words = refused(&format!("{HEADER}\n0.02,20,2.5e-6,59,1.5e-6,1.5e-8,-0.1,0.01\n{row}\n"));
        assert!(words.contains(column) && words.contains("less than the rounding"), "{words}");
    }
    csv(&format!("{HEADER}\n0.02,20,2.5e-6,60,1.5e-6,1e-20,-0.1,1e-14\n"));
}
