//! A scenario in the notation of its file.

use super::draft::{Draft, Kind, digits};
use crate::scenario::Coordinate;
use crate::statistics::wrap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// A scenario in the making.
#[derive(Default)]
struct Written {
    /// The file as far as it is written.
    text: String,
    /// Lines of the table `[instrument]`.
    instrument: String,
    /// Keys of `[fit] free`.
    free: Vec<&'static str>,
}

impl Draft<'_> {
    /// Reading per drive at resonance of a rig of mass one without gains.
    fn expected_peak(&self, base: bool) -> f64 {
        let (drive, reading) = self.signals();
        let w = TAU * self.resonance.frequency;
        let per_force = self.resonance.quality / (w * w) * w.powi(reading.order.into());
        match (base, drive.order) {
            (true, 0) => per_force * w * w,
            _ => per_force,
        }
    }

    /// The scenario in the notation of its file.
    pub fn scenario(&self, target: &Path, kind: Kind) -> String {
        let number = |value: f64| digits(value, 5);
        let r = &self.resonance;
        let mut written = Written { text: self.heading(kind), ..Written::default() };
        written.free.extend(["rig.natural_frequency", "rig.quality_factor"]);
        let ratio = r.peak / self.expected_peak(kind.base);
        self.write_size(&mut written, ratio, kind);
        if let Some(offset) = self.phase_offset().map(|offset| wrap(offset - FRAC_PI_2 * f64::from(kind.order))) {
            let inverted = offset.abs() > FRAC_PI_2;
            let remark = if inverted { "    # the reading has the opposite sign" } else { "" };
            let offset = number(if inverted { PI } else { 0.0 });
            let _ = writeln!(written.instrument, "phase_offset = \"{offset} rad\"{remark}");
            written.free.push("instrument.phase_offset");
        }
        let Written { mut text, instrument, mut free } = written;
        let (frequency, quality) = (digits(r.frequency, 7), number(r.quality));
        let _ = writeln!(text, "natural_frequency = \"{frequency} Hz\"\nquality_factor = {quality}");
        if self.rolls {
            self.write_contact(&mut text, if kind.base { 1.0 } else { 1.0 / ratio });
            free.extend(["contact.stiffness", "contact.damping", "contact.friction"]);
        }
        if !instrument.is_empty() {
            let _ = write!(text, "\n[instrument]\n{instrument}");
        }
        let _ = write!(text, "\n[measurement]\nfile = \"{}\"\n", path_from(target, self.table));
        if let Some(record) = self.seen.record {
            let _ = writeln!(text, "record = {record}");
        }
        if let Some((from, to)) = self.band {
            let _ = writeln!(
                text,
                "frequency = {{ from = \"{from} Hz\", to = \"{to} Hz\" }}    # the readings that are used"
            );
        }
        if !self.seen.mapping.is_empty() {
            let pairs: Vec<String> =
                self.seen.mapping.iter().map(|(key, header)| format!("{key} = {header:?}")).collect();
            let _ = writeln!(text, "columns = {{ {} }}", pairs.join(", "));
        }
        let free: Vec<String> = free.iter().map(|key| format!("\"{key}\"")).collect();
        let _ = write!(text, "\n[fit]\nfree = [{}]\n", free.join(", "));
        text
    }

    /// What stands before the numbers: title, origin, and how the rig is driven and read.
    fn heading(&self, kind: Kind) -> String {
        let plain = |name: &std::ffi::OsStr| name.to_string_lossy().replace(['"', '\\'], "'");
        let stem = self.table.file_stem().map_or("table".into(), plain);
        let mut text = format!(
            "# Written by `stickslip new` from what the readings show; every number may be corrected.\ntitle = \"Resonance of {stem}\"\n\
             provenance = \"not stated: readings of {file}; starting values estimated from them\"    # where they come from\n\n\
             [rig]\nkind = \"oscillator\"\n",
            file = self.table.file_name().map_or(stem.clone(), plain)
        );
        if self.coordinate == Coordinate::Angle {
            text += "coordinate = \"angle\"\n";
        }
        if kind.base {
            text += "drive = \"base\"                 # or \"spring\", with spring_stiffness\n";
            text += if kind.absolute {
                "reading = \"absolute\"           # or \"relative\" to the base\n"
            } else {
                "reading = \"relative\"           # to the base; or \"absolute\"\n"
            };
        } else {
            text += "drive = \"force\"                # or \"base\"; \"spring\"\n";
        }
        text
    }

    /// What the size of the readings tells: the mass, or a sensitivity where drive or reading is a voltage. `ratio` is
    /// the peak over that of a single mass.
    fn write_size(&self, Written { text, instrument, free }: &mut Written, ratio: f64, kind: Kind) {
        let (drive, reading) = self.signals();
        let volts = (drive.unit == "V", reading.unit == "V");
        let number = |value: f64| digits(value, 5);
        let angle = self.coordinate == Coordinate::Angle;
        let (motion, force) = if angle { ("rad", "V/(N m)") } else { ("m", "V/N") };
        match (kind.base, volts) {
            (false, (false, false)) => {
                let (key, unit) = if angle { ("inertia", "kg m^2") } else { ("mass", "kg") };
                let _ = writeln!(text, "{key} = \"{} {unit}\"", number(1.0 / ratio));
                free.insert(0, if angle { "rig.inertia" } else { "rig.mass" });
            }
            (_, (_, true)) => {
                *text += "# the mass is not known: it is 1, and the drive is known up to a factor\n";
                let order = usize::from(kind.order.min(2));
                let unit = ["V", "V s", "V s^2"][order];
                let of = ["displacement", "velocity", "acceleration"][order];
                let value = number(ratio / (TAU * self.resonance.frequency).powi(order as i32));
                let _ = writeln!(instrument, "sensitivity = \"{value} {unit}/{motion}\"    # reading per {of}");
                free.push("instrument.sensitivity");
            }
            (base, (true, false)) => {
                let (unit, of) = if base {
                    (if angle { "V/rad" } else { "V/m" }, "motion of the base")
                } else {
                    *text += "# the mass is not known: it is 1, and the drive is known up to a factor\n";
                    (force, "force")
                };
                let value = number(1.0 / ratio);
                let _ = writeln!(instrument, "drive_sensitivity = \"{value} {unit}\"    # reading per {of}");
                free.push("instrument.drive_sensitivity");
            }
            (true, _) if kind.absolute => {
                let value = number(ratio);
                let _ = writeln!(
                    text,
                    "participation = {value:?}    # motion of the place that is read over that of a single mass"
                );
                free.insert(0, "rig.participation");
            }
            (true, _) => {
                // With an exponent, or a point: a huge one is no integer.
                let value = number(ratio);
                let _ =
                    writeln!(instrument, "amplitude_gain = {value:?}    # reading over the motion of a single mass");
                free.push("instrument.amplitude_gain");
            }
        }
        if volts == (true, true) {
            let _ = writeln!(instrument, "drive_sensitivity = \"1 {force}\"    # not known: it sets the unit of force");
        }
    }

    /// A contact that does to the resonance what the one of the table does.
    fn write_contact(&self, text: &mut String, mass: f64) {
        let mass = if self.signals().1.unit == "V" { 1.0 } else { mass };
        let w0 = TAU * self.resonance.frequency;
        let stuck = self.stuck.unwrap_or(self.resonance);
        let w1 = TAU * stuck.frequency;
        let stiffness = (mass * (w1 * w1 - w0 * w0)).max(0.1 * mass * w0 * w0);
        let damping = (mass * (w1 / stuck.quality - w0 / self.resonance.quality)).max(0.01 * stiffness / w1);
        let _ = write!(
            text,
            "\n[contact]                        # from what it does to the resonance\nstiffness = \"{} N/m\"\n\
             damping = \"{} N s/m\"\nfriction = 0.5\n",
            digits(stiffness, 3),
            digits(damping, 3)
        );
    }
}

/// The path of the table as a scenario at `target` has to state it.
fn path_from(target: &Path, table: &Path) -> String {
    let folder =
        |path: &Path| path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")).canonicalize();
    let plain = |path: &Path| path.to_string_lossy().replace('\\', "\\\\").replace('"', "\\\"");
    let name = table.file_name().map(PathBuf::from).unwrap_or_default();
    match (folder(target), folder(table)) {
        (Ok(here), Ok(there)) => match there.strip_prefix(&here) {
            Ok(below) => plain(&below.join(name)),
            Err(_) => plain(&there.join(name)),
        },
        _ => plain(table),
    }
}
