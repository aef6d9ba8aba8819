//! Gates in the report: failures first, and in the first sentence.

use super::verdict::Passed;
use super::view::{GateView, Quantity, ReportView};
use crate::gate::Judged;

impl ReportView {
    /// The report with its gates.
    pub fn with_gates(mut self, judged: &[Judged]) -> Self {
        if judged.is_empty() {
            return self;
        }
        let mut gates: Vec<GateView> = judged.iter().map(|gate| self.gate(gate)).collect();
        gates.sort_by_key(|gate| gate.verdict == Passed::Yes);
        let failed = gates.iter().filter(|gate| gate.verdict == Passed::No).count();
        let said = match failed {
            0 => format!("All {} gates passed", gates.len()),
            _ => format!("{failed} of {} gates failed", gates.len()),
        };
        self.summary.sentence = format!("{said}. {}", self.summary.sentence);
        self.gates = gates;
        self
    }

    fn gate(&self, judged: &Judged) -> GateView {
        let scenario = self.scenarios.iter().find(|scenario| scenario.id == judged.scenario);
        let discovered = ["verdict", "effects"].contains(&judged.gate.as_str());
        let place = scenario.map(|scenario| {
            let comparison = scenario.comparison.as_ref().map(|c| &c.anchor);
            let discovery = scenario.discovery.as_ref().map(|d| &d.anchor).filter(|_| discovered);
            discovery.or(comparison).unwrap_or(&scenario.anchor).clone()
        });
        let anchor = match judged.gate.as_str() {
            "claims" => Some("claims".into()),
            "no_regression" => Some("baseline".into()),
            _ => place,
        };
        GateView {
            scenario: judged.scenario.clone(),
            anchor: anchor.unwrap_or_else(|| "summary".into()),
            gate: judged.gate.clone(),
            found: Quantity { value: judged.value, text: judged.found.clone() },
            demanded: Quantity { value: judged.limit, text: judged.demanded.clone() },
            verdict: if judged.holds { Passed::Yes } else { Passed::No },
        }
    }
}
