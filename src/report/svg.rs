//! Drawings inside the page: ids made unique, and nothing let through but drawing.

/// Elements that draw, hold or describe.
const ELEMENTS: &[&str] = &[
    "svg",
    "g",
    "defs",
    "symbol",
    "use",
    "title",
    "desc",
    "path",
    "rect",
    "circle",
    "ellipse",
    "line",
    "polyline",
    "polygon",
    "text",
    "tspan",
    "textPath",
    "clipPath",
    "mask",
    "pattern",
    "marker",
    "linearGradient",
    "radialGradient",
    "stop",
    "image",
];

/// Attributes that hold a list of ids.
const REFERENCES: &[&str] = &["aria-labelledby", "aria-describedby"];

/// The `<svg>` element with every id and every reference to one prefixed, ready to stand in an HTML page beside others.
///
/// Declaration, document type and comments are dropped, and roles, for the page states what a drawing is. `None` where
/// the text is no SVG or holds anything that could run or load something: unknown elements, event handlers, links that
/// lead out of the drawing.
pub fn inline(svg: &str, prefix: &str) -> Option<String> {
    let start = svg.find("<svg")?;
    let end = svg.rfind("</svg>")? + "</svg>".len();
    let mut rest = svg.get(start..end)?;
    let mut page = String::with_capacity(rest.len() + rest.len() / 16);
    while let Some(open) = rest.find('<') {
        page.push_str(&rest[..open]);
        rest = &rest[open..];
        if let Some(comment) = rest.strip_prefix("<!--") {
            rest = &comment[comment.find("-->")? + 3..];
            continue;
        }
        let length = tag_length(rest)?;
        tag(&rest[..length], prefix, &mut page)?;
        rest = &rest[length..];
    }
    Some(page)
}

/// Bytes from `<` to the `>` that closes the tag, quotes respected.
fn tag_length(text: &str) -> Option<usize> {
    let mut quote = None;
    for (index, byte) in text.bytes().enumerate() {
        match (quote, byte) {
            (None, b'"' | b'\'') => quote = Some(byte),
            (None, b'>') => return Some(index + 1),
            (Some(open), _) if open == byte => quote = None,
            _ => {}
        }
    }
    None
}

/// Copies one tag, its attributes checked and prefixed.
fn tag(tag: &str, prefix: &str, page: &mut String) -> Option<()> {
    let inner = tag.strip_prefix('<')?.strip_suffix('>')?;
    if let Some(name) = inner.strip_prefix('/') {
        page.push_str(tag);
        return ELEMENTS.contains(&name.trim_end()).then_some(());
    }
    let (inner, close) = inner.strip_suffix('/').map_or((inner, ">"), |inner| (inner, "/>"));
    let name = inner.split(|c: char| c.is_ascii_whitespace()).next()?;
    if !ELEMENTS.contains(&name) {
        return None;
    }
    page.push('<');
    page.push_str(name);
    let mut rest = inner[name.len()..].trim_start();
    while !rest.is_empty() {
        let (key, value) = rest.split_once('=')?;
        let key = key.trim_end();
        let value = value.trim_start();
        let quote = value.chars().next().filter(|c| matches!(c, '"' | '\''))?;
        let (value, after) = value[1..].split_once(quote)?;
        if key != "role" {
            page.push_str(&format!(" {key}={quote}{}{quote}", attribute(key, value, prefix)?));
        }
        rest = after.trim_start();
    }
    page.push_str(close);
    Some(())
}

/// The value of one attribute with its ids prefixed; `None` where it could run or load something.
fn attribute(key: &str, value: &str, prefix: &str) -> Option<String> {
    let lower = key.to_ascii_lowercase();
    if lower.starts_with("on") || !key.bytes().all(|b| b.is_ascii_alphanumeric() || b"-_:.".contains(&b)) {
        return None;
    }
    if lower == "id" {
        return Some(format!("{prefix}{value}"));
    }
    if REFERENCES.contains(&lower.as_str()) {
        let ids: Vec<String> = value.split_ascii_whitespace().map(|id| format!("{prefix}{id}")).collect();
        return Some(ids.join(" "));
    }
    if lower == "href" || lower.ends_with(":href") {
        return match value.strip_prefix('#') {
            Some(id) => Some(format!("#{prefix}{id}")),
            None => value.starts_with("data:image/png;base64,").then(|| value.to_owned()),
        };
    }
    paint(value, prefix)
}

/// Prefixes every `url(#id)`; `None` for a `url(` that leads elsewhere.
fn paint(value: &str, prefix: &str) -> Option<String> {
    let mut page = String::with_capacity(value.len());
    let mut rest = value;
    while let Some(at) = rest.find("url(") {
        let (before, after) = rest.split_at(at + "url(".len());
        page.push_str(before);
        let id = after.trim_start_matches(['\'', '"', ' ']);
        page.push_str(&after[..after.len() - id.len()]);
        page.push_str(&format!("#{prefix}"));
        rest = id.strip_prefix('#')?;
    }
    page.push_str(rest);
    Some(page)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_and_their_uses_are_prefixed() {
        let svg = r##"<?xml version="1.0"?><!DOCTYPE svg><svg viewBox="0 0 1 1" role="img" aria-labelledby="t d"><!-- a > b -->
            <title id="t">a id="t" url(#c)</title><clipPath id='c'><rect width="1"/></clipPath>
            <g clip-path="url(#c)" style="fill:url('#c')"><use xlink:href="#c" /></g></svg> "##;
        let page = inline(svg, "f1-").unwrap();
        assert!(page.starts_with(r#"<svg viewBox="0 0 1 1" aria-labelledby="f1-t f1-d">"#), "{page}");
        assert!(page.contains(r#"<title id="f1-t">a id="t" url(#c)</title><clipPath id='f1-c'>"#), "{page}");
        assert!(
            page.contains(r##"<g clip-path="url(#f1-c)" style="fill:url('#f1-c')"><use xlink:href="#f1-c"/></g>"##)
        );
        assert!(page.ends_with("</svg>") && !page.contains("a > b"));
    }

    #[test]
    fn what_could_run_or_load_is_refused() {
        for inside in [
            "<script>alert(1)</script>",
            "<style>@import url(x)</style>",
            "<foreignObject/>",
            "<rect onclick=\"x\"/>",
            "<rect ONLOAD='x'/>",
            "<use href=\"https://example.org/#a\"/>",
            "<image href=\"javascript:alert(1)\"/>",
            "<rect fill=\"url(https://example.org/)\"/>",
            "<![CDATA[<script>]]>",
            "<rect fill=red/>",
            "<rect fill=\"red",
            "<!-- open",
            "</style>",
        ] {
            assert_eq!(inline(&format!("<svg>{inside}</svg>"), "a-"), None, "{inside}");
        }
        assert_eq!(inline("no drawing", "a-"), None);
    }
}
