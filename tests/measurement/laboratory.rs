//! Tables as laboratories' programs write them: separators, decimal commas, headers and units of all kinds.

use super::oscillators::load;
use super::{SWEEP, read};
use stickslip::measurement::survey_bytes;

#[test]
fn headers_of_many_kinds_are_one_table() {
    let cases = [
        ("frequency_hz,force_n,amplitude_m,phase_rad", "80,0.5,0.002,-1"),
        ("f / Hz;F / N;x / mm;phi / rad", "80;0,5;2;-1"),
        ("f/Hz;F/N;x/mm;phi/rad", "80;0,5;2;-1"),
        ("f (Hz)\tForce (mN)\tDisplacement (µm)\tPhase (rad)", "80\t500\t2000\t-1"),
        ("f [kHz]\tForce [mN]\tDisplacement [um]\tPhase [rad]", "0,08\t500\t2000\t-1"),
        ("\"Frequency [Hz]\",\"Force [N]\",\"Displacement [mm]\",\"Phase [rad]\"", "\"80\",\"0.5\",\"2\",\"-1\""),
        ("\"Frequenz in Hz\";\"Kraft in N\";\"Auslenkung in mm\";\"Phasenwinkel in rad\"", "80;0,5;2;-1"),
        ("freq_hz,force_amplitude_n,displacement_amplitude_mm,phi", "80,0.5,2,-1"),
        ("Freq. [Hz],Force [N],Ampl [mm],φ [rad]", "80,0.5,2,-1"),
        ("Frequency\tForce\tDisplacement\tPhase", "Hz\tmN\t[µm]\t(rad)\n80\t500\t2000\t-1"),
        ("FREQUENCY_HZ,FORCE_N,AMPLITUDE_MM,PHASE_RAD", "80,0.5,2,-1"),
        ("Drive frequency (Hz),Shaker force (mN),Tip displacement (mm),Phase of tip (rad)", "80,500,2,-1"),
        ("Frequency (Hertz),Force (millinewton),Displacement (Millimeters),Phase (Radians)", "80,500,2,-1"),
        ("f [Hz],F [N],x [mm],Phase (Grad)", "80,0.5,2,-57.29577951308232"),
        ("Frequenz f / Hz;Erregerkraft F / N;Auslenkung der Spitze / mm;Phase φ / rad", "80;0,5;2;-1"),
    ];
    for (header, cells) in cases {
        let separator = ['\t', ';', ','].into_iter().find(|c| header.contains(*c)).expect("a separator");
        let cells = cells.replace("(rad)\n", "(rad)\t%\trad\n");
        let text = format!(
            "{header}{separator}amplitude_sd_percent{separator}phase_sd_rad\n{cells}{separator}1{separator}1\n"
        );
        let more = if header.starts_with("Freq.") { "columns = { frequency = 'Freq. [Hz]' }" } else { "" };
        for mark in ["", "\u{feff}"] {
            let table =
                load("t.csv", format!("{mark}{text}").as_bytes(), "", more).unwrap_or_else(|error| panic!("{error}"));
            let point = &table.points[0];
            assert_eq!(
                (point.frequency, point.drive, point.amplitude, point.phase),
                (80.0, 0.5, 2e-3, Some(-1.0)),
                "{header}"
            );
        }
        let wide: Vec<u8> = std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
        let table = load("t.txt", &wide, "", more).unwrap_or_else(|error| panic!("{error}"));
        assert!(table.points[0].amplitude == 2e-3 && table.notes[0] == "the file is UTF-16 text", "{header}");
    }
    let accelerations = ["Acceleration [g]", "accel (g)", "a / g", "acc_g", "acceleration in g", "Beschleunigung [g]"];
    for header in accelerations {
        let text = format!("f [Hz];F [N];{header};amplitude_sd_percent\n80;0,5;2;1\n");
        let table = load("t.csv", text.as_bytes(), "", "").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((table.signals.reading.unit, table.points[0].amplitude), ("m/s^2", 2.0 * 9.80665), "{header}");
    }
}

#[test]
fn deviations_are_known_by_the_names_of_what_they_are_of() {
    let of = |header: &str, cells: &str| {
        let table = load("t.csv", format!("{header}\n{cells}\n").as_bytes(), "", "");
        let mut table = table.unwrap_or_else(|error| panic!("{header}: {error}"));
        let point = table.points.swap_remove(0);
        [point.amplitude_sd / point.amplitude, point.phase_sd.unwrap_or(0.0).to_degrees()]
    };
    for (header, cells) in [
        ("frequency_hz,force_n,amplitude_mm,amplitude_sd,phase_deg,phase_sd", "80,0.5,2,0.02,-90,0.5"),
        ("f [Hz],F [N],A [mm],dA,φ [°],Δφ [°]", "80,0.5,2,0.02,-90,0.5"),
        ("freq_hz,force_n,amp_mm,amp_err,phase_deg,phase_err", "80,0.5,2,0.02,-90,0.5"),
        ("freq_hz,force_n,amp_mm,amp_err_percent,phase_deg,phase_err_rad", "80,0.5,2,1,-90,0.0087266"),
        ("Freq. [Hz],Force [N],AMPLITUDE [MM],AMPLITUDE ERROR,PHASE LAG [deg],PHASE ERROR", "80,0.5,2,0.02,90,0.5"),
        ("F Hz,force_n,Amp.mittel [mm],Amp.std,Phi-mittel [°],Phi-std", "80,0.5,2,0.02,-90,0.5"),
        ("F Hz,force_n,Amplitude [mmpp],Amplitude std,Phi [°],Phi std", "80,0.5,4,0.04,-90,0.5"),
        ("F Hz,force_n,Amplitude [mmpp],Amplitude err [mm],Phi [°],Phi std", "80,0.5,4,0.04,-90,0.5"),
        ("F Hz,force_n,peak-to-peak voltage (volt),unc voltage (volt),Phi [°],Phi std", "80,0.5,4,0.04,-90,0.5"),
    ] {
        let [amplitude, phase] = of(header, cells);
        assert!((amplitude - 0.01).abs() < 1e-12 && (phase - 0.5).abs() < 1e-4, "{header}: {amplitude} {phase}");
    }
    // A level deviates by a factor, and what states a unit of another kind is another thing.
    for header in ["f [Hz],F [N],amplitude [dB re 1 mm],damplitude,n", "f [Hz],F [N],A [mm],dA [Hz],n"] {
        let table = load("t.csv", format!("{header}\n80,0.5,2,0.02,1\n").as_bytes(), "", "");
        let notes = table.map_or_else(|error| error.to_string(), |table| table.notes.join("\n"));
        assert!(notes.contains("states no noise of the amplitude"), "{header}: {notes}");
    }
}

#[test]
fn an_element_of_a_scattering_matrix_is_amplitude_or_phase_by_its_unit() {
    for (level, turn) in [("S34(DB)", "S34(DEG)"), ("S21 [dB]", "S21 [deg]"), ("s11 (dB)", "s11 (rad)")] {
        let rows: String = (0..8).map(|n| format!("{}e9,1.5,-2{n}\n", 5 + n)).collect();
        let text = format!("Freq(Hz),{turn},{level}\n{rows}");
        let seen = survey_bytes("t.csv", text.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
        let keys: Vec<_> = seen.columns.iter().map(|column| column.key).collect();
        assert_eq!(keys, [Some("frequency"), Some("phase"), Some("amplitude")], "{level}");
    }
}

#[test]
fn phases_that_point_anywhere_are_left_out_of_any_kind_of_table() {
    let text = |header: &str, cells: fn(f64, f64) -> String, turns: f64| {
        let row = |n: u32| {
            let r = 0.9 + 0.004 * f64::from(n);
            let size = (1.0 - r * r).hypot(r / 20.0).recip() * if n.is_multiple_of(2) { 1.01 } else { 0.99 };
            // Not evenly spread, as the points of a sequence are.
            let share = ((12.9898 * f64::from(n)).sin() * 43_758.545_3).rem_euclid(1.0);
            let phase = std::f64::consts::TAU * turns * share - 1.5;
            format!("{},0.5,{}\n", 100.0 * r, cells(size, phase))
        };
        format!("{header}\n{}", (0..50).map(row).collect::<String>())
    };
    let polar: fn(f64, f64) -> String = |size, phase| format!("{size},{phase}");
    let parts: fn(f64, f64) -> String = |size, phase| format!("{},{}", size * phase.cos(), size * phase.sin());
    let complex: fn(f64, f64) -> String = |size, phase| format!("({}{:+}j)", size * phase.cos(), size * phase.sin());
    for (header, cells) in [
        ("f [Hz],F [N],x [mm],phi [rad]", polar),
        ("f [Hz],F [N],re x [mm],im x [mm]", parts),
        ("f [Hz],F [N],x [mm]", complex),
    ] {
        let of = |turns: f64| {
            survey_bytes("t.csv", text(header, cells, turns).as_bytes()).unwrap_or_else(|error| panic!("{error}"))
        };
        let (seen, narrow) = (of(1.0), of(0.5));
        assert!(narrow.table.points.iter().all(|p| p.phase.is_some()), "{header}");
        assert!(seen.table.points.iter().all(|p| p.phase.is_none()), "{header}");
        assert_eq!(seen.mapping, [("phase".to_string(), String::new())], "{header}");
        let again = load("t.csv", text(header, cells, 0.5).as_bytes(), "", "columns = { phase = '' }");
        let again = again.unwrap_or_else(|error| panic!("{error}"));
        assert!(again.points.iter().all(|p| p.phase.is_none() && p.amplitude > 0.0), "{header}");
    }
}

#[test]
fn a_velocity_beside_a_load_and_a_reading_is_the_rollers() {
    let rows: String = (0..16)
        .map(|n| {
            format!("{},0.3,{},4,{},{}\n", 34.0 + f64::from(n), if n < 8 { 5 } else { 20 }, 14 + n % 8, -12 - n % 8)
        })
        .collect();
    for header in [
        "V [mm/s],W [N]",
        "velocity [mm/s],load [N]",
        "sliding velocity (mm/s),W (N)",
        "belt speed [mm/s],normal force [N]",
    ] {
        let text = format!("f [Hz],F [N],{header},x [µm],phase [deg]\n{rows}");
        let seen = survey_bytes("t.csv", text.as_bytes()).unwrap_or_else(|error| panic!("{header}: {error}"));
        let settings: Vec<(f64, f64)> = seen.table.series.iter().map(|one| (one.speed, one.load)).collect();
        assert_eq!(settings, [(5e-3, 4.0), (0.02, 4.0)], "{header}");
        assert_eq!(seen.table.signals.reading.unit, "m", "{header}");
    }
    // A normal force without a speed is none of a sliding contact.
    for header in ["W [N],n", "Normalkraft [N],n", "normal_force_n,n"] {
        let text = format!("f [Hz],F [N],{header},x [µm],phase [deg]\n{rows}");
        let seen = survey_bytes("t.csv", text.as_bytes()).unwrap_or_else(|error| panic!("{header}: {error}"));
        assert!(seen.table.series.iter().all(|one| one.load == 0.0), "{header}: {:?}", seen.table.series);
    }
    // Without a load it is none of a contact.
    let text = format!("f [Hz],F [N],v [mm/s],n,x [µm],phase [deg]\n{rows}");
    let seen = survey_bytes("t.csv", text.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
    assert!(seen.table.series.iter().all(|one| one.speed == 0.0), "{:?}", seen.table.series);
}

#[test]
fn rows_with_empty_cells_for_a_reading_are_left_out_and_counted() {
    let rows: String = (0..12).map(|n| format!("{},{},{}\n", 80 + n, 1 + n % 6, -10 * n)).collect();
    let text = format!("f [Hz],x [mm],phase [deg]\n79,,\n{rows}92, ,\n");
    let seen = survey_bytes("t.csv", text.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(seen.table.points.len(), 12);
    assert!(seen.table.notes.iter().any(|note| note.starts_with("2 rows with empty cells")), "{:?}", seen.table.notes);
    // A phase without an amplitude is a slip.
    let text = format!("f [Hz],x [mm],phase [deg]\n79,,-5\n{rows}");
    assert!(survey_bytes("t.csv", text.as_bytes()).expect_err("no amplitude").to_string().contains("t.csv:2:"));
    // Nothing but such rows is no table.
    let refused = survey_bytes("t.csv", b"f [Hz],x [mm]\n79,\n80,\n").expect_err("no readings").to_string();
    assert!(refused.contains("no readings") && refused.contains("2 rows with empty cells"), "{refused}");
}

/// As an analyser of vibrations exports frequency response functions: the axis has no name, and its unit stands above.
#[test]
fn a_spectrum_whose_axis_is_named_in_the_preamble_is_read() {
    let rows: String = (0..12).map(|n| format!("{},5E+00;{}E-01;-{n}E-01;1;2\n", 70 + n, 1 + n % 5)).collect();
    let units = "';(m/s^2)/N;(m/s^2)/N;(m/s^2)/N;(m/s^2)/N";
    let text = format!(
        "Format;Spectrum\nAxisUnit;Hz\nSignals;2\n\nName;Signal 2;Signal 3\nUnit;(m/s^2)/N;(m/s^2)/N\n\n\
         ';Signal 2 (Real);Signal 2 (Imag.);Signal 3 (Real);Signal 3 (Imag.)\n{units}\n{rows}"
    );
    let seen = survey_bytes("t.csv", text.as_bytes()).unwrap_or_else(|error| panic!("{error}"));
    let points = &seen.table.points;
    assert_eq!((points.len(), points[0].frequency), (12, 70.5));
    assert!((points[3].amplitude - 0.5).abs() < 1e-9 && points[3].phase.is_some(), "{:?}", points[3]);
    // Of another axis it is no frequency.
    let refused = survey_bytes("t.csv", text.replace("AxisUnit;Hz", "AxisUnit;s").as_bytes());
    assert!(refused.expect_err("no axis").to_string().contains("frequency"));
}

#[test]
fn what_was_made_of_the_headers_is_said() {
    let text = "\u{feff}f / Hz;F / mN;a / (m/s²);phi / °;Temperatur / °C\n80;0,5;2;-90;21\n81;0,5;2;-90;21\n";
    let text = format!("{text}{}", (0..6).map(|n| format!("{};0,5;2,{n};-9{n};21\n", 82 + n)).collect::<String>());
    insta::assert_snapshot!(
        "laboratory-notes",
        load("t.csv", text.as_bytes(), "", "").expect("sound").notes[..6].join("\n")
    );
}

#[test]
fn names_that_could_mean_several_things_are_asked_about() {
    let fails = |header: &str| {
        let cells = vec!["1"; header.matches(',').count() + 1].join(",");
        load("t.csv", format!("{header}\n{cells}\n").as_bytes(), "", "").expect_err("refused")
    };
    insta::assert_snapshot!("two-aliases", fails("f [Hz],Force [N],Displacement [mm],Velocity [mm/s]"));
    // Without a unit, neither a force nor a frequency is told.
    insta::assert_snapshot!("capital-f", fails("F,force_n,amplitude_m"));
    insta::assert_snapshot!("capitals-milli-or-mega", fails("FREQUENCY_HZ,FORCE_MN,AMPLITUDE_MM"));
    // Beside a contact, a velocity may be the roller's.
    let contact = "[contact]\nstiffness = 1e5\ndamping = 0\nfriction = 0.5";
    let text = "f [Hz],Force [N],Velocity [mm/s],Load [N]\n80,1,1,20\n";
    insta::assert_snapshot!(
        "velocity-of-the-roller",
        load("t.csv", text.as_bytes(), "", contact).expect_err("ambiguous")
    );
}

#[test]
fn a_mapped_column_is_read_in_the_unit_that_its_name_states() {
    let table = |header: &str, key: &str| {
        let text = format!("frequency_hz,force_n,{header},amplitude_sd_percent\n80,1,2,1\n");
        load("t.csv", text.as_bytes(), "", &format!("columns = {{ {key} = '{header}' }}"))
    };
    for (header, unit, value) in [
        ("tip_mm", "m", 2e-3),
        ("tip mm", "m", 2e-3),
        ("tip [mm]", "m", 2e-3),
        ("tip / mm", "m", 2e-3),
        ("accel_g", "m/s^2", 2.0 * 9.80665),
        ("sensor 1 [g]", "m/s^2", 2.0 * 9.80665),
        ("laser_um_s", "m/s", 2e-6),
        ("tip velocity", "m/s", 2.0),
        ("head_acceleration", "m/s^2", 2.0),
        ("vibrometer_mv", "V", 2e-3),
        ("channel_3", "m", 2.0),
        ("tip", "m", 2.0),
    ] {
        let table = table(header, "amplitude").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((table.signals.reading.unit, table.points[0].amplitude), (unit, value), "{header}");
        assert!(table.notes[0].contains("is read as amplitude in"), "{:?}", table.notes);
    }
    for (name, header, key) in [
        ("mapped-force-as-amplitude", "load_cell_N", "amplitude"),
        ("mapped-force-by-name", "tip_force", "amplitude"),
        ("mapped-angle-as-amplitude", "arm_deg", "amplitude"),
        ("mapped-length-as-frequency", "wave_mm", "frequency"),
        ("mapped-acceleration-as-force", "shaker_m_s2", "force"),
        ("mapped-acceleration-as-drive", "shaker_g", "drive"),
        ("mapped-time-as-phase", "lag_s", "phase"),
        ("mapped-strain-as-amplitude", "strain", "amplitude"),
    ] {
        insta::assert_snapshot!(name, table(header, key).expect_err(name));
    }
    // The paper's arm is read as an angle and driven by a displacement.
    let arm = |header: &str, key: &str| {
        let text = format!("frequency_hz,amplitude_rad,{header}\n80,1,2\n");
        read("t.csv", text.as_bytes(), &format!("columns = {{ {key} = '{header}' }}\n{SWEEP}")).expect_err(header)
    };
    insta::assert_snapshot!("mapped-length-as-angle", arm("tip_mm", "amplitude"));
    insta::assert_snapshot!("mapped-force-of-the-arm", arm("shaker_n", "force"));
}

#[test]
fn a_mapped_column_that_is_no_amplitude_is_noted() {
    for (header, key, told) in [
        ("tip_pp_mm", "amplitude", "peak to peak: where it is, state amplitude_gain = 2"),
        ("Tip RMS [mm]", "amplitude", "an effective value: where it is, state amplitude_gain = 0.707107"),
        ("force_pp_n", "force", "peak to peak: where it is, state drive_gain = 0.5"),
        ("shaker rms [N]", "drive", "an effective value: where it is, state drive_gain = 1.414214"),
    ] {
        let other = if key == "amplitude" { "force_n" } else { "amplitude_m" };
        let text = format!("frequency_hz,{other},{header},amplitude_sd_percent\n80,1,2,1\n");
        let table = load("t.csv", text.as_bytes(), "", &format!("columns = {{ {key} = '{header}' }}")).expect("sound");
        assert!(table.notes[1].contains(told), "{:?}", table.notes);
        assert!(load("t.csv", text.as_bytes(), "", "").is_err(), "{header} is not guessed to be one");
    }
}

#[test]
fn series_and_sweep_are_mapped_too() {
    let text = "frequency_hz,force_n,amplitude_m,amplitude_sd_percent,run,dir\n80,1,2,1,a,up\n80,1,2,1,a,Down\n80,1,3,1,b,UP\n";
    let table = load("t.csv", text.as_bytes(), "", "columns = { series = 'run', sweep = 'dir' }").expect("sound");
    assert_eq!((table.points.len(), table.series.len()), (3, 3));
    assert_eq!(table.notes, ["`run` is read as series", "`dir` is read as sweep"]);
    let missing =
        load("t.csv", text.as_bytes(), "", "columns = { series = 'runs', torque = 'M' }").expect_err("no such");
    insta::assert_snapshot!("mapping-series-without-column", missing);
}

#[test]
fn equal_problems_are_one_message() {
    let rows: String = (0..30).map(|n| format!("{},1,{}\n", 60 + n, if n % 3 == 0 { "-" } else { "1e-6" })).collect();
    let phased: String = rows.replace('\n', ",-1\n");
    insta::assert_snapshot!(
        "one-message-for-one-cause",
        load(
            "t.csv",
            format!("frequency_hz,force_n,amplitude_m\n{rows}80,1,\n81,1,,\n82,1\n83,1\n").as_bytes(),
            "",
            ""
        )
        .expect_err("refused")
    );
    insta::assert_snapshot!(
        "one-message-for-cells",
        load("t.csv", format!("frequency_hz,force_n,amplitude_m,phase_rad\n{phased}80,1,,-1\n").as_bytes(), "", "")
            .expect_err("refused")
    );
}

#[test]
fn a_row_that_repeats_another_is_used_once() {
    let header = "frequency_hz,force_n,amplitude_m,amplitude_sd_percent,run\n";
    let of = |rows: &str| load("t.csv", format!("{header}{rows}").as_bytes(), "", "").expect("sound");
    let table = of("80,1,2,1,\n81,1,3,1,\n80.0,1,2,1,\n80,1,2,1,\n");
    assert_eq!(table.points.iter().map(|p| (p.row, p.replicates)).collect::<Vec<_>>(), [(1, 1), (2, 1)]);
    let note = &table.notes[1];
    assert!(
        note.starts_with("line 4 repeats line 2, number by number, and 1 more lines others: each is used once"),
        "{note}"
    );
    assert_eq!(of("80,1,2,1,first\n80,1,2,1,second\n").points[0].replicates, 2);
}

#[test]
fn samples_in_time_are_recognised() {
    let rows = |step: f64, count: usize| {
        (0..count)
            .map(|n| format!("{:.4}\t{:.3}\t0,1\n", step * n as f64, (0.3 * n as f64).sin()).replace('.', ","))
            .collect::<String>()
    };
    for (name, header, step) in
        [("samples", "t / s\tF / N\ta / g", 1e-4), ("samples-ms", "Time [ms]\tCH1 [V]\tCH2 [V]", 0.5)]
    {
        let text = format!("{header}\n{}", rows(step, 300));
        insta::assert_snapshot!(name, load("t.txt", text.as_bytes(), "", "").expect_err("samples"));
        insta::assert_snapshot!(format!("{name}-of-the-arm"), read("t.txt", text.as_bytes(), "").expect_err("samples"));
    }
    // A column of times beside a frequency is no recording, and neither are a few odd times.
    let text = "time,frequency_hz,force_n,amplitude_m,amplitude_sd_percent\n".to_string()
        + &(0..12).map(|n| format!("{n},{},1,1e-6,1\n", 80 + n)).collect::<String>();
    assert_eq!(load("t.csv", text.as_bytes(), "", "").expect("sound").points.len(), 12);
    let odd: String = [0, 1, 5, 6, 20, 21, 22, 50, 90].iter().map(|t| format!("{t},1,1\n")).collect();
    let message =
        load("t.csv", format!("time,force_n,amplitude_m\n{odd}").as_bytes(), "", "").expect_err("no frequency");
    assert!(message.contains("no column for frequency"), "{message}");
    // Nor is a sweep that has a phase and calls its frequency something else.
    let swept: String = (0..12).map(|n| format!("{};{};2,1;0,5;-30\n", 2000 * n, 100 * n)).collect();
    let text = format!("Zeit t / ms;f2 f2;Spannung U_2 / V;Strom I / A;Phasenverschiebung / °\n{swept}");
    let message = load("t.csv", text.as_bytes(), "", "").expect_err("no frequency");
    assert!(message.contains("no column for") && message.contains("frequency"), "{message}");
    // A program that writes a frequency and an amplitude once in a while beside the samples.
    let now_and_then = |n: usize| if n.is_multiple_of(40) { "1.25,0.3" } else { "," };
    let sparse: String =
        (0..200).map(|n| format!("{:.2},{:.3},{}\n", 0.02 * n as f64, -0.1, now_and_then(n))).collect();
    let text = format!("Time (s),Angle (rad),Driving Frequency (Hz),Amplitude (rad)\n{sparse}");
    let message = load("t.csv", text.as_bytes(), "", "").expect_err("samples");
    assert!(message.contains("the table holds samples in time") && message.matches("error:").count() == 1, "{message}");
}

/// A resonance as students write it down: frequency, amplitude in cm, its deviation and a phase in degrees, in the rows
/// of `header`.
fn written(header: &str, sign: f64) -> String {
    driven(header, sign, 0.2)
}

fn driven(header: &str, sign: f64, drive: f64) -> String {
    let row = |n: i32| {
        let f = 0.5 + 0.02 * f64::from(n);
        let (x, y) = (0.7 * 0.7 - f * f, 0.7 * f / 8.0);
        let noise = 1.0 + 0.004 * f64::from(n * n % 5);
        let (size, phase) = (drive * noise / x.hypot(y), sign * f64::atan2(-y, x).to_degrees());
        let cells = [format!("{f:.4}"), format!("{size:.4}"), format!("{:.4}", 0.01 * size), format!("{phase:.2}")];
        cells[..if header.is_empty() { 4 } else { header.split(',').count() }].join(",")
    };
    format!("{header}\n{}\n", (0..24).map(row).collect::<Vec<_>>().join("\n"))
}

#[test]
fn a_table_without_a_drive_is_of_one_setting() {
    let text = written("f [Hz],A [cm],dA [cm],phi", 1.0);
    let table = survey_bytes("t.csv", text.as_bytes()).unwrap_or_else(|error| panic!("{error}")).table;
    let (point, signals) = (&table.points[0], table.signals);
    assert_eq!((signals.drive.unit, signals.reading.unit, point.drive), ("V", "m", 1.0));
    assert!((point.amplitude_sd / point.amplitude - 0.01).abs() < 1e-4, "{point:?}");
    assert!(point.phase.is_some_and(|phase| phase < 0.0 && phase > -1.0), "degrees by their size: {point:?}");
    let told = |note: &str| assert!(table.notes.iter().any(|told| told.contains(note)), "{note}: {:?}", table.notes);
    told("no drive is stated");
    told("`A [cm]` is read as amplitude in cm");
    told("`dA [cm]` is read as amplitude_sd in cm");
    told("`phi` is read as phase in deg, no unit being stated");
    // Two sweeps may have had two drives, and a column in volts may be it.
    let larger = driven("", 1.0, 0.9);
    let twice = text.clone() + larger.trim_start();
    let refused = |text: &str| survey_bytes("t.csv", text.as_bytes()).expect_err("refused").to_string();
    insta::assert_snapshot!("no-drive-in-two-sweeps", refused(&twice));
    insta::assert_snapshot!("no-drive-beside-volts", refused(&written("f [Hz],amplitude [cm],U [V]", 1.0)));
    let stated = load("t.csv", text.as_bytes(), "", "[sweep]\nfrequency = 0.7\ndrive = '3 N'").expect("sound");
    assert_eq!((stated.signals.drive.unit, stated.points[0].drive), ("N", 3.0), "of the sweep");
}

/// An impedance, an admittance in parts, a current that a voltage drives: signals that go with the motion of what is
/// driven electrically.
#[test]
fn electrical_signals_are_readings() {
    let row = |cells: fn(f64) -> String| (0..24).map(|n| cells(0.5 + 0.02 * f64::from(n))).collect::<String>();
    let size = |f: f64| 0.2 / (0.49 - f * f).hypot(0.7 * f / 8.0);
    let phase = |f: f64| f64::atan2(-0.7 * f / 8.0, 0.49 - f * f);
    let read = |header: &str, rows: String| {
        let text = format!("{header}\n{rows}");
        survey_bytes("t.csv", text.as_bytes()).unwrap_or_else(|error| panic!("{header}: {error}")).table
    };
    let polar: fn(f64) -> String = |f| {
        let (x, y) = (0.49 - f * f, 0.7 * f / 8.0);
        format!("{f},{},{}\n", 0.2 / x.hypot(y), f64::atan2(-y, x).to_degrees())
    };
    let parts: fn(f64) -> String = |f| {
        let (x, y) = (0.49 - f * f, 0.7 * f / 8.0);
        format!("{f},{},{}\n", 0.2 * x / (x * x + y * y), -0.2 * y / (x * x + y * y))
    };
    let driven: fn(f64) -> String = |f| format!("{f},0.25,{}\n", 0.05 / (0.49 - f * f).hypot(0.7 * f / 8.0));
    for (header, rows, drive, factor) in [
        ("f [Hz],|Z| / kΩ,arg Z / °", row(polar), 1.0, 1e3),
        ("f (Hz),G (mS),B (mS)", row(parts), 1.0, 1e-3),
        ("f [Hz],U [V],I [mA]", row(driven), 0.25, 0.25e-3),
    ] {
        let table = read(header, rows);
        let point = &table.points[9];
        let f = point.frequency;
        assert_eq!((table.signals.drive.unit, table.signals.reading.unit, point.drive), ("V", "V", drive), "{header}");
        assert!((point.amplitude / (factor * size(f)) - 1.0).abs() < 1e-9, "{header}: {point:?}");
        assert!(point.phase.is_none_or(|own| (own - phase(f)).abs() < 1e-9), "{header}: {point:?}");
        assert_eq!(point.phase.is_some(), !header.contains('U'), "{header}");
    }
}

/// The voltage of a generator beside what it shakes, in the words and units of laboratories: what each row reads at 0.7
/// Hz.
#[test]
fn a_voltage_beside_a_reading_drives_it() {
    let row = |order: [usize; 4], n: i32| {
        let f = 0.5 + 0.02 * f64::from(n);
        let (x, y) = (0.49 - f * f, 0.7 * f / 8.0);
        let cells = [f, 0.25, 0.05 / x.hypot(y), f64::atan2(-y, x).to_degrees()];
        order.map(|at| cells[at].to_string()).join(",") + "\n"
    };
    // Amplitude over the number that stands there, drive over 0.25.
    for (header, order, reading, drive, signal) in [
        ("f / Hz,U / V,a / m/s^2,phase / deg", [0, 1, 2, 3], 1.0, 1.0, "m/s^2"),
        ("freq_Hz,amp_V,accel_g,phase_deg", [0, 1, 2, 3], 9.80665, 1.0, "m/s^2"),
        (
            "Frequency [Hz],Generator [Vpp],Displacement [mm rms],Phase [deg]",
            [0, 1, 2, 3],
            2f64.sqrt() * 1e-3,
            0.5,
            "m",
        ),
        ("f (Hz),velocity (mm/s pk),U exc (V),Phase (deg)", [0, 2, 1, 3], 1e-3, 1.0, "m/s"),
        ("Hz,V in,V out,deg", [0, 1, 2, 3], 1.0, 1.0, "V"),
        ("Frequency,Input,Output,Phase", [0, 1, 2, 3], 1.0, 1.0, "V"),
    ] {
        let text: String = (0..24).map(|n| row(order, n)).collect();
        let read = |text: &str| {
            let survey = survey_bytes("t.csv", format!("{header}\n{text}").as_bytes());
            survey.unwrap_or_else(|error| panic!("{header}: {error}")).table
        };
        let table = read(&text);
        // At several levels, whatever the order of the rows.
        let larger = |line: &str, times: f64| {
            let mut cells: Vec<String> = line.split(',').map(String::from).collect();
            for at in [1, 2] {
                cells[at] = (times * cells[at].parse::<f64>().expect("a number")).to_string();
            }
            cells.join(",") + "\n"
        };
        let of = |times: f64| text.lines().map(|line| larger(line, times)).collect::<Vec<_>>();
        let levels = [of(1.0), of(2.0), of(4.0)];
        let by_frequency: String = (0..24).flat_map(|n| levels.iter().map(move |rows| rows[n].as_str())).collect();
        for rows in [levels.concat().concat(), by_frequency] {
            assert_eq!(read(&rows).series.len(), 3, "{header}");
        }
        let point = &table.points[10];
        assert_eq!((table.signals.reading.unit, point.drive), (signal, 0.25 * drive), "{header}");
        let (size, phase) = (0.05 * 8.0 / 0.49 * reading, -std::f64::consts::FRAC_PI_2);
        assert!((point.amplitude / size - 1.0).abs() < 1e-9, "{header}: {point:?}");
        assert!(point.phase.is_some_and(|own| (own - phase).abs() < 1e-9), "{header}: {point:?}");
    }
    // Load and speed of a rig that has neither.
    let zeros: String = (0..24).map(|n| row([0, 1, 2, 3], n).replacen(",0.25,", ",0,0,", 1)).collect();
    let survey = survey_bytes("t.csv", format!("f (Hz),V / mm/s,W / N,U / V,phase (deg)\n{zeros}").as_bytes());
    let table = survey.unwrap_or_else(|error| panic!("{error}")).table;
    assert_eq!((table.signals.reading.unit, table.points[10].drive), ("V", 1.0));
}

/// What the numbers tell where the headers do not: levels, two channels of one frequency, a name before a unit.
#[test]
fn numbers_and_names_tell_what_units_do_not() {
    let rows = |cells: &dyn Fn(f64, f64) -> String| {
        let row = |n: i32| {
            let f = 0.5 + 0.02 * f64::from(n);
            cells(f, 0.2 / (0.49 - f * f).hypot(0.7 * f / 8.0)) + "\n"
        };
        (0..24).map(row).collect::<String>()
    };
    let read = |header: &str, cells: &dyn Fn(f64, f64) -> String| {
        let survey = survey_bytes("t.csv", format!("{header}\n{}", rows(cells)).as_bytes());
        survey.unwrap_or_else(|error| panic!("{header}: {error}")).table
    };
    let at_peak = 0.2 * 8.0 / 0.49;
    let table = read("freq,mag", &|f, size| format!("{f},{}", 20.0 * (1e-3 * size).log10()));
    assert!((table.points[10].amplitude / (1e-3 * at_peak) - 1.0).abs() < 1e-9, "{:?}", table.points[10]);
    let channels = &|f: f64, size: f64| format!("{f},0.5,{},{size}", f * 1.0001);
    let table = read("CH1 freq [Hz],drive [V],CH2 freq [Hz],response [V]", channels);
    assert_eq!((table.points[10].frequency, table.points[10].drive), (0.7, 0.5));
    let table = read("U_V,amplitude,Period (s)", &|f, size| format!("{},{size},{}", 3.0 * f, 1.0 / f));
    assert!((table.points[10].amplitude / at_peak - 1.0).abs() < 1e-9, "{:?}", table.points[10]);
    // The first of the channels of an analyser.
    let two = "f [Hz],S 2 (Real),S 2 (Imag.),S 3 (Real),S 3 (Imag.)";
    let table = read(two, &|f, size| format!("{f},{},{},1,2", 0.6 * size, -0.8 * size));
    assert!((table.points[10].amplitude / at_peak - 1.0).abs() < 1e-9, "{:?}", table.points[10]);
    for header in ["U_V,A,Schwingungsdauer / s", "U_V,A (a.u.),período (s)"] {
        let survey = survey_bytes(
            "t.csv",
            format!("{header}\n{}", rows(&|f, size| format!("{},{size},{}", 3.0 * f, 1.0 / f))).as_bytes(),
        );
        let survey = survey.unwrap_or_else(|error| panic!("{header}: {error}"));
        // What is written into a scenario is what was looked at.
        assert!((survey.table.points[10].amplitude / at_peak - 1.0).abs() < 1e-9, "{:?}", survey.table.points[10]);
        let column = header.split(',').nth(1).expect("a column").to_string();
        assert_eq!(survey.mapping, [("amplitude".to_string(), column)], "{header}");
    }
    let table = read("\"freq (Hz) Run #16\",\"Angle (rad) Run #16\"", &|f, size| format!("{f},{}", 1e-3 * size));
    assert_eq!(table.signals.reading.unit, "rad");
}

/// Up and down again, or on after a step back: where such sweeps agree one drive is taken for all, where they do not it
/// has to be stated.
#[test]
fn sweeps_that_agree_are_of_one_drive() {
    let row = |f: f64, drive: f64| format!("{f:.4},{:.5}\n", drive / (0.49 - f * f).hypot(0.7 * f / 8.0));
    let sweep = |from: i32, to: i32, drive: f64| {
        let f = |n: i32| 0.5 + 0.02 * f64::from(n);
        (from..to).map(|n| row(f(n), drive)).collect::<String>()
    };
    let back = |drive: f64| sweep(0, 24, drive).lines().rev().fold(String::new(), |all, line| all + line + "\n");
    let read = |text: String| survey_bytes("t.csv", format!("f [Hz],A [cm]\n{text}").as_bytes());
    for text in [sweep(0, 24, 0.2) + &back(0.201), sweep(5, 24, 0.2) + &sweep(0, 5, 0.2)] {
        let table = read(text).unwrap_or_else(|error| panic!("{error}")).table;
        assert!(table.notes.iter().any(|note| note.contains("2 sweeps: where they meet")), "{:?}", table.notes);
    }
    for text in [sweep(0, 24, 0.2) + &back(0.3), sweep(5, 24, 0.2) + &sweep(0, 5, 0.3)] {
        let refused = read(text).expect_err("two drives").to_string();
        assert!(refused.contains("holds 2 sweeps"), "{refused}");
    }
    // Rows in no order are one sweep where they are one curve.
    let mut order: Vec<i32> = (0..61).collect();
    order.sort_by_key(|n| (n * n * 25_214 + n * 31) % 65_537);
    let shuffled = |other: f64| {
        let drive = |n: i32| if n % 2 == 0 { 0.2 } else { other };
        read(order.iter().map(|n| row(0.5 + 0.008 * f64::from(*n), drive(*n))).collect())
    };
    let table = shuffled(0.2).unwrap_or_else(|error| panic!("{error}")).table;
    assert_eq!((table.series.len(), table.points.len()), (1, 61));
    let refused = shuffled(0.4).expect_err("two drives").to_string();
    assert!(refused.contains("holds 8 sweeps"), "{refused}");
}

#[test]
fn an_angular_frequency_is_a_frequency() {
    for name in ["omega [rad/s]", "ω / rad/s", "w (rad/s)", "Kreisfrequenz [rad/s]", "angular frequency (rad/s)"] {
        let text = written(&format!("{name},A [cm]"), 1.0);
        let table = survey_bytes("t.csv", text.as_bytes()).unwrap_or_else(|error| panic!("{name}: {error}")).table;
        assert!((table.points[0].frequency - 0.5 / std::f64::consts::TAU).abs() < 1e-12, "{name}");
    }
}

#[test]
fn lags_are_phases_of_the_other_sign() {
    let first = |header: &str, sign: f64| {
        let survey = survey_bytes("t.csv", written(header, sign).as_bytes()).unwrap_or_else(|error| panic!("{error}"));
        (survey.table.points[0].phase.expect("a phase"), survey.mapping)
    };
    let (plain, mapping) = first("f [Hz],A [cm],dA [cm],phase [deg]", 1.0);
    assert!(plain < 0.0 && mapping.is_empty());
    assert_eq!(first("f [Hz],A [cm],dA [cm],phase lag [deg]", -1.0), (plain, vec![]));
    // What the numbers say counts for more than what the column is called.
    let of = |key: &str, header: &str| vec![(key.to_string(), header.to_string())];
    for (header, sign, key) in [("phase [deg]", -1.0, "phase_lag"), ("phase lag [deg]", 1.0, "phase")] {
        let (phase, mapping) = first(&format!("f [Hz],A [cm],dA [cm],{header}"), sign);
        assert_eq!((phase, mapping), (plain, of(key, header)), "{header}");
    }
}

#[test]
fn what_stands_before_the_numbers_does_not_matter() {
    let plain = written("f [Hz],A [cm]", 1.0);
    let rows = plain.split_once('\n').expect("rows").1;
    let points = |text: &str| {
        let table = survey_bytes("t.csv", text.as_bytes()).unwrap_or_else(|error| panic!("{text}: {error}")).table;
        (table.points.iter().map(|p| (p.frequency, p.amplitude)).collect::<Vec<_>>(), table.notes)
    };
    let (expected, notes) = points(&plain);
    assert!(!notes.iter().any(|note| note.contains("header") || note.contains("blanks")), "{notes:?}");
    let cases = [
        (format!("# June\n# {plain}"), "the names of the columns stand in the remark above the numbers"),
        (
            format!("--- Setup ---\nStart (Hz): 1\nDate: 13-10-2016, 10:47\n{plain}"),
            "3 lines before the header are not read",
        ),
        (format!("f [Hz] A [cm]\n{}", rows.replace(',', "  ")), "blanks separate the cells"),
        (format!("CH1: f [Hz],TR1: A [cm]\n{rows}"), "`CH1: f [Hz]` is read as frequency in Hz"),
    ];
    for (text, note) in cases {
        let (found, notes) = points(&text);
        assert!(found == expected && notes.iter().any(|told| told == note), "{text} {notes:?}");
    }
    for separator in [",", " "] {
        let error = survey_bytes("t.csv", rows.replace(',', separator).as_bytes()).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains("the table has no header"), "{error}");
    }
    let (whole, notes) = points(&format!("f [Hz],App [cm]\n{rows}"));
    assert!(whole.iter().zip(&expected).all(|(w, e)| w.1 == 0.5 * e.1), "{notes:?}");
    assert!(
        notes.iter().any(|note| note == "`App [cm]` is read as amplitude in cm, half of what stands there"),
        "{notes:?}"
    );
}

/// A second column that holds times is no reading, whatever else the table lacks.
#[test]
fn a_column_of_times_is_no_reading() {
    let rows: String = (0..8).map(|n| format!("{}\t{}\n", 15 + n, 1.2 + 0.1 * f64::from(n))).collect();
    let read = |header: &str| survey_bytes("t.txt", format!("{header}\n{rows}").as_bytes());
    for header in ["Frequenz in kHz\tdelta t in mu_Sekunden", "f [kHz]\tdelay", "f [kHz]\tZeitdifferenz"] {
        assert!(read(header).is_err(), "{header}");
    }
    assert!(read("Frequenz in kHz\tAusschlag").is_ok());
}

/// 9.9e37 is what an instrument writes that has no reading.
#[test]
fn rows_of_an_overflow_are_not_readings() {
    let rows: String = (0..8).map(|n| format!("{},{},0.{}\n", 80 + n, 0.5, n + 1)).collect();
    let text = format!("f [Hz],F [N],x [mm]\n79,0.5,9.9e+37\n{rows}88,9.91E+37,1\n");
    let table = load("t.csv", text.as_bytes(), "", "").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(table.points.len(), 8);
    let note = "2 rows with a number of 9.9e37, which an instrument writes that has no reading, not used";
    assert!(table.notes.iter().any(|one| one == note), "{:?}", table.notes);
}

/// Names that blanks part above numbers that tabs do, and names and units in a remark each.
#[test]
fn a_header_may_be_parted_otherwise_than_the_numbers_and_stand_in_two_remarks() {
    let row = |n: i32| (2.0 + 0.1 * f64::from(n), 1.0 + 0.1 * f64::from(n * n % 7));
    let rows = |between: &str| (0..12).map(row).map(|(f, a)| format!("{f:.1}{between}{a:.1}\n")).collect::<String>();
    for (header, between) in [("Frequenz Amplitude", "\t"), ("# f U\n# kHz V", " "), ("# f\tU\n# kHz\tV", "\t")] {
        let text = format!("{header}\n{}", rows(between));
        let table = survey_bytes("t.csv", text.as_bytes()).unwrap_or_else(|error| panic!("{error}")).table;
        let unit = if header.contains("kHz") { 1e3 } else { 1.0 };
        assert_eq!((table.points[0].frequency, table.points.len()), (2.0 * unit, 12), "{header}");
    }
}

/// A resonance, and the coil of a loudspeaker far above it: the sign of the phases is that at the resonance.
#[test]
fn lags_are_told_at_the_resonance() {
    let row = |n: i32, sign: f64| {
        let f = 20.0 * 1.06f64.powi(n);
        let d = 2.0 * 2.0 * (f / 48.0 - 48.0 / f);
        let (re, im) = (4.0 + 14.0 / (1.0 + d * d), -14.0 * d / (1.0 + d * d) + 0.003 * f);
        format!("{f:.3},{:.4},{:.3}\n", re.hypot(im), sign * im.atan2(re).to_degrees())
    };
    for (sign, lags) in [(1.0, false), (-1.0, true)] {
        let text: String = (0..100).map(|n| row(n, sign)).collect();
        let seen = survey_bytes("t.csv", format!("f [Hz],Z [V],phase [deg]\n{text}").as_bytes()).expect("sound");
        assert_eq!(seen.mapping.iter().any(|(key, _)| key == "phase_lag"), lags, "{:?}", seen.table.notes);
    }
}
