//! What a section says of a rig that is not the paper's: what drives it and what is read of it, its equations, their symbols.

use super::glossary::of_everything;
use super::view::{EquationView, RigView, SignalView, SignalsView, SymbolView};
use crate::scenario::{Coordinate, Dissipation, Elasticity, Excitation, Oscillator, Rig, Scenario, Signal, Signals};

/// Signals where they are not those of the paper's rig.
pub fn signals(signals: &Signals) -> Option<SignalsView> {
    let view = |signal: &Signal| SignalView {
        name: signal.name.into(),
        symbol: signal.symbol.into(),
        unit: signal.unit.into(),
    };
    (!signals.of_arm()).then(|| SignalsView { drive: view(&signals.drive), reading: view(&signals.reading) })
}

/// The rig of a scenario where it is not the paper's.
pub fn rig(scenario: &Scenario) -> Option<RigView> {
    let Rig::Oscillator(oscillator) = &scenario.rig else { return None };
    let signals = signals(&scenario.signals)?;
    let contact = scenario.contact.is_some();
    let of = Of { oscillator, signals: &scenario.signals, contact };
    Some(RigView { signals, contact, equations: of.equations(), symbols: of.symbols(&scenario.signals) })
}

impl RigView {
    /// With the symbols of other signals of the same rig: those of a table.
    pub fn with(mut self, scenario: &Scenario) -> Self {
        let Rig::Oscillator(oscillator) = &scenario.rig else { return self };
        let of = Of { oscillator, signals: &scenario.signals, contact: self.contact };
        for symbol in of.symbols(&scenario.signals) {
            if !self.symbols.iter().any(|known| known.anchor == symbol.anchor) {
                self.symbols.push(symbol);
            }
        }
        self
    }
}

/// An oscillator as it is spoken of.
struct Of<'a> {
    oscillator: &'a Oscillator,
    signals: &'a Signals,
    contact: bool,
}

impl Of<'_> {
    fn angle(&self) -> bool {
        self.oscillator.coordinate == Coordinate::Angle
    }

    /// The coordinate.
    fn x(&self) -> &'static str {
        if self.angle() { "θ" } else { "x" }
    }

    fn equations(&self) -> Vec<EquationView> {
        let (o, x) = (self.oscillator, self.x());
        let force = if self.contact { " + qF" } else { "" };
        let (of, right) = match o.excitation {
            Excitation::Force if self.angle() => ("the oscillator, driven by a torque", "T₀ sin(ωt)".to_string()),
            Excitation::Force => ("the oscillator, driven by a force", "F₀ sin(ωt)".into()),
            Excitation::Base => (
                "the oscillator, driven by the motion y of its base, x from that",
                if o.absolute { "−ΓMy″" } else { "−My″" }.into(),
            ),
            Excitation::Spring => ("the oscillator, driven through a spring whose end moves by u", "kₛu + cₛu′".into()),
        };
        let mut list =
            vec![(of.replace(", x from", &format!(", {x} from")), format!("M{x}″ + C{x}′ + K{x} = {right}{force}"))];
        let stiffness = (o.elasticity_form == Elasticity::NaturalFrequency).then_some("K = M(2πf₀)²");
        let damping = match o.dissipation_form {
            Dissipation::Damping => None,
            Dissipation::QualityFactor => Some("C = √(KM)/Q"),
            Dissipation::DampingRatio => Some("C = 2ζ√(KM)"),
        };
        let stated: Vec<&str> = stiffness.into_iter().chain(damping).collect();
        if !stated.is_empty() {
            let name = match stated.len() {
                2 => "its stiffness and damping",
                _ if stiffness.is_some() => "its stiffness",
                _ => "its damping",
            };
            list.push((name.into(), stated.join(", ")));
        }
        list.push(self.reading());
        if self.contact {
            list.extend(
                [
                    (
                        "bristles of stretch z in series with a slider of slip rate s",
                        "z′ = V − q{x}′ − s, F = kc z + cc z′",
                    ),
                    (
                        "the slider rests below the Coulomb limit, and slips at it",
                        "s = 0 while |F| < μW, else |F| = μW",
                    ),
                ]
                .map(|(of, equation)| (of.to_string(), equation.replace("{x}", x))),
            );
        }
        list.into_iter().map(|(of, equation)| EquationView { of, equation }).collect()
    }

    /// What is read.
    fn reading(&self) -> (String, String) {
        let (reading, x) = (&self.signals.reading, self.x());
        let motion = if self.oscillator.absolute { format!("({x} + y)") } else { x.to_string() };
        let primes = ["", "′", "″"][usize::from(reading.order.min(2))];
        let motion = format!("{motion}{primes}");
        let motion = if reading.unit == "V" { format!("S{motion}") } else { motion };
        let of = format!("what is read at the frequency of the drive: {}", reading.name);
        (of, format!("{motion} → {} sin(ωt + φ)", reading.symbol))
    }

    fn symbols(&self, signals: &Signals) -> Vec<SymbolView> {
        let (o, angle) = (self.oscillator, self.angle());
        let unit = |linear: &'static str, angular: &'static str| if angle { angular } else { linear };
        let (drive, reading) = (&signals.drive, &signals.reading);
        let mut list: Vec<(String, &str, &str, String)> = Vec::new();
        let mut add = |id: &str, symbol: &'static str, unit: &'static str, meaning: &str| {
            list.push((id.into(), symbol, unit, meaning.into()));
        };
        let moves = match (o.excitation, angle) {
            (Excitation::Base, false) => "displacement from the base",
            (Excitation::Base, true) => "rotation from the base",
            (_, false) => "displacement",
            (_, true) => "angle",
        };
        add("coordinate", self.x(), unit("m", "rad"), moves);
        let mass = match (o.mass_stated, angle) {
            (true, false) => "modal mass",
            (true, true) => "moment of inertia of the mode",
            (false, _) => "mass, not stated: 1, the drive being known up to a factor",
        };
        add("mass", "M", unit("kg", "kg m²"), mass);
        add("damping-C", "C", unit("N s/m", "N m s/rad"), "damping of the mode");
        add("stiffness-K", "K", unit("N/m", "N m/rad"), "stiffness of the mode");
        if o.elasticity_form == Elasticity::NaturalFrequency {
            add("natural-frequency", "f₀", "Hz", "natural frequency without damping");
        }
        match o.dissipation_form {
            Dissipation::Damping => {}
            Dissipation::QualityFactor => add("quality-factor", "Q", "", "quality factor of the resonance"),
            Dissipation::DampingRatio => add("damping-ratio", "ζ", "", "damping over the critical damping, 1/(2Q)"),
        }
        match o.excitation {
            Excitation::Force => {}
            Excitation::Base => add("base", "y", unit("m", "rad"), "motion of the base"),
            Excitation::Spring => {
                add("end", "u", unit("m", "rad"), "motion of the end of the driving spring");
                add("driving-stiffness", "k_s", unit("N/m", "N m/rad"), "stiffness of the driving spring, part of K");
                add("driving-damping", "c_s", unit("N s/m", "N m s/rad"), "damping of the driving spring, part of C");
            }
        }
        let what = match (drive.unit, o.excitation) {
            ("V", _) => "voltage that stands for the drive",
            (_, Excitation::Force) if angle => "amplitude of the torque",
            (_, Excitation::Force) => "amplitude of the force",
            ("m/s^2" | "rad/s^2", _) => "amplitude of the acceleration of the base",
            (_, Excitation::Base) => "amplitude of the motion of the base",
            (_, Excitation::Spring) => "amplitude of the motion of the spring's end",
        };
        list.push((format!("drive-{}", drive.drive_column()), drive.symbol, drive.unit, what.into()));
        if o.excitation == Excitation::Force && drive.unit == "V" {
            let own = if angle { Signal::TORQUE } else { Signal::FORCE };
            let what = format!("amplitude of the {}, known by its voltage", own.name);
            list.push((format!("drive-{}", own.drive_column()), own.symbol, own.unit, what));
        }
        list.push(("frequency-f".into(), "f", "Hz", "drive frequency".into()));
        list.push(("omega".into(), "ω", "rad/s", "angular drive frequency, 2πf".into()));
        let whose = if o.absolute { " in space" } else { "" };
        let what = format!("amplitude of the {}{whose} at the drive frequency", reading.name);
        list.push((format!("reading-{}", reading.reading_column()), reading.symbol, reading.unit, what));
        if reading.unit == "V" {
            list.push(("sensitivity".into(), "S", "", "voltage read per motion".into()));
        }
        list.push(("phase".into(), "φ", "rad", format!("phase of the {}, relative to the drive", reading.name)));
        if o.absolute {
            let meaning = "participation: motion of the place that is read over that of a mass on a spring, both relative to the base";
            list.push(("participation".into(), "Γ", "", meaning.into()));
        }
        if self.contact {
            let contact = [
                ("factor", "q", unit("", "m/rad"), "motion at the contact per unit of the coordinate"),
                ("contact-kc", "k_c", "N/m", "stiffness of the bristles of the contact"),
                ("contact-cc", "c_c", "N s/m", "damping of the bristles of the contact"),
                ("mu", "μ", "", "coefficient of friction"),
                ("load-W", "W", "N", "normal load; 0 means no contact"),
                ("speed-V", "V", "m/s", "speed of the surface that slides on the rig"),
                ("force-F", "F", "N", "tangential force of that surface on the rig"),
            ];
            list.extend(contact.map(|(id, symbol, unit, meaning)| (id.into(), symbol, unit, meaning.into())));
        }
        let view = |(id, symbol, unit, meaning): (String, &str, &str, String)| SymbolView {
            anchor: format!("symbol-{}", super::anchor::slug(&id)),
            symbol: symbol.into(),
            unit: crate::units::printed(unit),
            meaning,
        };
        list.into_iter().map(view).chain(of_everything()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::mathml;
    use super::*;

    #[test]
    fn every_rig_has_its_equation_and_every_symbol_its_own_place() {
        for coordinate in [Coordinate::Displacement, Coordinate::Angle] {
            for excitation in [Excitation::Force, Excitation::Base, Excitation::Spring] {
                for contact in [false, true] {
                    let oscillator = Oscillator {
                        coordinate,
                        excitation,
                        absolute: excitation == Excitation::Base,
                        mass: 1.0,
                        mass_stated: contact,
                        elasticity: 10.0,
                        elasticity_form: Elasticity::NaturalFrequency,
                        dissipation: 100.0,
                        dissipation_form: Dissipation::QualityFactor,
                        spring_stiffness: 1.0,
                        spring_damping: 0.0,
                        contact_factor: 1.0,
                        participation: 1.0,
                    };
                    let signals = Rig::Oscillator(oscillator).signals();
                    let of = Of { oscillator: &oscillator, signals: &signals, contact };
                    let equations = of.equations();
                    assert!(equations[0].equation.starts_with(if of.angle() { "Mθ″" } else { "Mx″" }));
                    assert!(equations.iter().all(|e| mathml::block(&e.equation).starts_with("<math")));
                    let mut anchors: Vec<String> = of.symbols(&signals).into_iter().map(|s| s.anchor).collect();
                    let count = anchors.len();
                    anchors.sort();
                    anchors.dedup();
                    assert_eq!(anchors.len(), count);
                    let told = serde_json::to_string(&(of.equations(), of.symbols(&signals))).unwrap_or_default();
                    assert_eq!(told.contains("μW"), contact, "{told}");
                    assert!(!told.contains("roller") && !told.contains("the arm"), "{told}");
                }
            }
        }
    }
}
