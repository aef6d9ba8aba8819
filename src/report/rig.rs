//! What a section says of a rig that is not the paper's: what drives it and what is read of it, its equations, their
//! symbols.

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

fn symbol(id: &str, symbol: &str, unit: &str, meaning: &str) -> SymbolView {
    SymbolView {
        anchor: format!("symbol-{}", super::anchor::slug(id)),
        symbol: symbol.into(),
        unit: crate::units::printed(unit),
        meaning: meaning.into(),
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

    /// A unit of this oscillator, by what its coordinate is.
    fn unit(&self, linear: &'static str, angular: &'static str) -> &'static str {
        if self.angle() { angular } else { linear }
    }

    fn symbols(&self, signals: &Signals) -> Vec<SymbolView> {
        let mut list = self.of_motion();
        list.extend(self.of_excitation());
        list.extend(self.of_drive(&signals.drive));
        list.extend(self.of_reading(&signals.reading));
        if self.contact {
            list.extend(self.of_contact());
        }
        list.extend(of_everything());
        list
    }

    /// Coordinate, mass, damping and stiffness of the mode.
    fn of_motion(&self) -> Vec<SymbolView> {
        let (o, angle) = (self.oscillator, self.angle());
        let moves = match (o.excitation, angle) {
            (Excitation::Base, false) => "displacement from the base",
            (Excitation::Base, true) => "rotation from the base",
            (_, false) => "displacement",
            (_, true) => "angle",
        };
        let mass = match (o.mass_stated, angle) {
            (true, false) => "modal mass",
            (true, true) => "moment of inertia of the mode",
            (false, _) => "mass, not stated: 1, the drive being known up to a factor",
        };
        let mut list = vec![
            symbol("coordinate", self.x(), self.unit("m", "rad"), moves),
            symbol("mass", "M", self.unit("kg", "kg m²"), mass),
            symbol("damping-C", "C", self.unit("N s/m", "N m s/rad"), "damping of the mode"),
            symbol("stiffness-K", "K", self.unit("N/m", "N m/rad"), "stiffness of the mode"),
        ];
        if o.elasticity_form == Elasticity::NaturalFrequency {
            list.push(symbol("natural-frequency", "f₀", "Hz", "natural frequency without damping"));
        }
        list.extend(match o.dissipation_form {
            Dissipation::Damping => None,
            Dissipation::QualityFactor => Some(symbol("quality-factor", "Q", "", "quality factor of the resonance")),
            Dissipation::DampingRatio => {
                Some(symbol("damping-ratio", "ζ", "", "damping over the critical damping, 1/(2Q)"))
            }
        });
        list
    }

    /// The motion by which the oscillator is driven, where it is not a force.
    fn of_excitation(&self) -> Vec<SymbolView> {
        let (stiffness, damping) = (self.unit("N/m", "N m/rad"), self.unit("N s/m", "N m s/rad"));
        match self.oscillator.excitation {
            Excitation::Force => Vec::new(),
            Excitation::Base => vec![symbol("base", "y", self.unit("m", "rad"), "motion of the base")],
            Excitation::Spring => vec![
                symbol("end", "u", self.unit("m", "rad"), "motion of the end of the driving spring"),
                symbol("driving-stiffness", "k_s", stiffness, "stiffness of the driving spring, part of K"),
                symbol("driving-damping", "c_s", damping, "damping of the driving spring, part of C"),
            ],
        }
    }

    /// Amplitude and frequency of the drive.
    fn of_drive(&self, drive: &Signal) -> Vec<SymbolView> {
        let (excitation, angle) = (self.oscillator.excitation, self.angle());
        let what = match (drive.unit, excitation) {
            ("V", _) => "voltage that stands for the drive",
            (_, Excitation::Force) if angle => "amplitude of the torque",
            (_, Excitation::Force) => "amplitude of the force",
            ("m/s^2" | "rad/s^2", _) => "amplitude of the acceleration of the base",
            (_, Excitation::Base) => "amplitude of the motion of the base",
            (_, Excitation::Spring) => "amplitude of the motion of the spring's end",
        };
        let of =
            |own: &Signal, what: &str| symbol(&format!("drive-{}", own.drive_column()), own.symbol, own.unit, what);
        let mut list = vec![of(drive, what)];
        if excitation == Excitation::Force && drive.unit == "V" {
            let own = if angle { Signal::TORQUE } else { Signal::FORCE };
            list.push(of(&own, &format!("amplitude of the {}, known by its voltage", own.name)));
        }
        list.push(symbol("frequency-f", "f", "Hz", "drive frequency"));
        list.push(symbol("omega", "ω", "rad/s", "angular drive frequency, 2πf"));
        list
    }

    /// Amplitude and phase of what is read.
    fn of_reading(&self, reading: &Signal) -> Vec<SymbolView> {
        let whose = if self.oscillator.absolute { " in space" } else { "" };
        let id = format!("reading-{}", reading.reading_column());
        let what = format!("amplitude of the {}{whose} at the drive frequency", reading.name);
        let mut list = vec![symbol(&id, reading.symbol, reading.unit, &what)];
        if reading.unit == "V" {
            list.push(symbol("sensitivity", "S", "", "voltage read per motion"));
        }
        let what = format!("phase of the {}, relative to the drive", reading.name);
        list.push(symbol("phase", "φ", "rad", &what));
        if self.oscillator.absolute {
            let meaning = "participation: motion of the place that is read over that of a mass on a spring, both relative to the base";
            list.push(symbol("participation", "Γ", "", meaning));
        }
        list
    }

    fn of_contact(&self) -> [SymbolView; 7] {
        [
            symbol("factor", "q", self.unit("", "m/rad"), "motion at the contact per unit of the coordinate"),
            symbol("contact-kc", "k_c", "N/m", "stiffness of the bristles of the contact"),
            symbol("contact-cc", "c_c", "N s/m", "damping of the bristles of the contact"),
            symbol("mu", "μ", "", "coefficient of friction"),
            symbol("load-W", "W", "N", "normal load; 0 means no contact"),
            symbol("speed-V", "V", "m/s", "speed of the surface that slides on the rig"),
            symbol("force-F", "F", "N", "tangential force of that surface on the rig"),
        ]
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
