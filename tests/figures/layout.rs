//! What every drawing must be: complete, fit for a page, its texts on the canvas and apart.

use resvg::usvg::{Group, Node, Rect, Tree};
use stickslip::figures::{self, Drawing};

fn texts(group: &Group, found: &mut Vec<(String, Rect)>) {
    for node in group.children() {
        match node {
            Node::Group(group) => texts(group, found),
            Node::Text(text) => {
                let words = text.chunks().iter().map(|chunk| chunk.text()).collect();
                found.push((words, text.abs_bounding_box()));
            }
            _ => {}
        }
    }
}

/// Every text lies on the canvas and none touches another, on a narrow screen too.
pub fn check_layout(drawing: &Drawing) {
    for svg in [&drawing.svg].into_iter().chain(&drawing.narrow) {
        check_texts(drawing, svg);
    }
}

fn check_texts(drawing: &Drawing, svg: &str) {
    let tree = Tree::from_str(svg, &figures::style::options()).unwrap();
    let mut found = Vec::new();
    texts(tree.root(), &mut found);
    assert!(found.len() > 5, "{}: only {} texts", drawing.name, found.len());
    for (i, (text, a)) in found.iter().enumerate() {
        let inside =
            a.left() >= 0.0 && a.top() >= 0.0 && a.right() <= tree.size().width() && a.bottom() <= tree.size().height();
        assert!(inside, "{}: `{text}` leaves the canvas: {a:?}", drawing.name);
        for (other, b) in &found[i + 1..] {
            let apart = a.right() < b.left() + 0.5
                || b.right() < a.left() + 0.5
                || a.bottom() < b.top() + 2.5
                || b.bottom() < a.top() + 2.5;
            assert!(apart, "{}: `{text}` {a:?} overlaps `{other}` {b:?}", drawing.name);
        }
    }
}

/// Caption, notes and reading are there, no coordinate is broken, the size is bounded, and it goes into a page.
pub fn check_drawing(name: &str, drawing: &Drawing) {
    let what = format!("{name}: {}", drawing.name);
    assert!(drawing.caption.len() > 80 && drawing.alt.len() > 40 && !drawing.notes.is_empty(), "{what}");
    assert!(drawing.notes.iter().all(|(_, text)| !text.is_empty()), "{what}");
    assert!(drawing.reading.iter().all(|text| text.len() > 15), "{what}");
    assert!(drawing.svg.contains(r##"fill="#FFFFFF""##), "{what} has no background");
    assert!(!drawing.svg.contains("NaN") && !drawing.svg.contains("inf"), "{what} has a broken coordinate");
    assert!(!drawing.svg.contains("script") && !drawing.svg.contains(" id="), "{what}");
    assert!(drawing.svg.len() < 330_000, "{what}: {} bytes", drawing.svg.len());
    let page = stickslip::report::svg::inline(&drawing.svg, "f-").unwrap_or_else(|| panic!("{what}"));
    let size = ["<svg", "<title>", "<desc>"].map(|tag| page.matches(tag).count());
    assert_eq!(size, [1, 1, 1], "{what}");
    check_layout(drawing);
}

/// The rows of a drawing's table.
pub fn rows(drawing: &Drawing) -> Vec<Vec<String>> {
    let mut reader = csv::Reader::from_reader(drawing.csv.as_bytes());
    reader.records().map(|record| record.unwrap().iter().map(String::from).collect()).collect()
}
