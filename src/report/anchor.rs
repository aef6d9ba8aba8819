//! Stable ids of the page and safe links, from whatever users call their things.

use std::collections::BTreeSet;

/// Lower-case ASCII letters, digits and single hyphens; never empty.
pub fn slug(text: &str) -> String {
    let mut slug = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_ascii_alphanumeric() {
            slug.push(c.to_ascii_lowercase());
        } else if !slug.is_empty() && !slug.ends_with('-') {
            slug.push('-');
        }
    }
    let slug = slug.trim_end_matches('-');
    if slug.is_empty() { "x".into() } else { slug.into() }
}

/// Anchor of a scenario's section.
pub fn scenario(id: &str) -> String {
    format!("scenario-{}", slug(id))
}

/// Anchor of a figure of a scenario.
pub fn figure(scenario_id: &str, name: &str) -> String {
    format!("figure-{}-{}", slug(scenario_id), slug(name))
}

/// Anchor of the comparison of a scenario with its measurements.
pub fn comparison(id: &str) -> String {
    format!("comparison-{}", slug(id))
}

/// Anchor of the discovery of a scenario.
pub fn discovery(id: &str) -> String {
    format!("discovery-{}", slug(id))
}

/// Anchor of the free form of a scenario.
pub fn free_form(id: &str) -> String {
    format!("free-form-{}", slug(id))
}

/// Anchor of the question of a scenario.
pub fn question(id: &str) -> String {
    format!("question-{}", slug(id))
}

/// Anchor of an effect of the atlas.
pub fn effect(name: &str) -> String {
    format!("effect-{}", slug(name))
}

/// Anchor of a claim.
pub fn claim(id: &str) -> String {
    format!("claim-{}", slug(id))
}

/// What anchors of the checks of the solvers begin with.
const CHECK: &str = "check-";

/// Anchor of a check of the solvers.
pub fn check(name: &str) -> String {
    format!("{CHECK}{}", slug(name))
}

/// Link from the main page to an anchor: checks have a page of their own.
pub fn place(anchor: &str) -> String {
    let page = if anchor.starts_with(CHECK) || anchor == "verification" { "checks.html" } else { "" };
    format!("{page}#{anchor}")
}

/// Gives out every id once: a second `a` becomes `a-2`.
#[derive(Debug, Default)]
pub struct Anchors(BTreeSet<String>);

impl Anchors {
    /// The wanted id, or the first free one after it.
    pub fn claim(&mut self, wanted: &str) -> String {
        let mut anchor = wanted.to_owned();
        let mut number = 2;
        while !self.0.insert(anchor.clone()) {
            anchor = format!("{wanted}-{number}");
            number += 1;
        }
        anchor
    }

    /// Whether the id was given out.
    pub fn has(&self, anchor: &str) -> bool {
        self.0.contains(anchor)
    }
}

/// A path beside the report as a link that can only lead there: percent-encoded, without scheme, host or absolute path.
pub fn href(path: &str) -> String {
    let relative = path.trim_start_matches(['/', '\\']);
    let mut href = String::with_capacity(relative.len() + 2);
    for byte in relative.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => href.push(char::from(byte)),
            b'\\' => href.push('/'),
            _ => href.push_str(&format!("%{byte:02X}")),
        }
    }
    href
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slugs_are_ids_whatever_the_text() {
        assert_eq!(slug("paper/figure-6"), "paper-figure-6");
        assert_eq!(slug("<script>alert(1)</script>"), "script-alert-1-script");
        assert_eq!(slug("µ Ω 漢字"), "x");
        assert_eq!(slug(""), "x");
        assert_eq!(figure("paper/figure-6", "Transition"), "figure-paper-figure-6-transition");
    }

    #[test]
    fn a_second_claim_of_the_same_id_gets_a_number() {
        let mut anchors = Anchors::default();
        assert_eq!(anchors.claim("a"), "a");
        assert_eq!(anchors.claim("a"), "a-2");
        assert_eq!(anchors.claim("a"), "a-3");
        assert!(anchors.has("a-2") && !anchors.has("b"));
    }

    #[test]
    fn links_stay_beside_the_report() {
        assert_eq!(href("paper/a b.svg"), "paper/a%20b.svg");
        assert_eq!(href("javascript:alert(1)"), "javascript%3Aalert%281%29");
        assert_eq!(href("//evil.example/x"), "evil.example/x");
        assert_eq!(href("\"><script>"), "%22%3E%3Cscript%3E");
        assert_eq!(href("µ.csv"), "%C2%B5.csv");
    }
}
