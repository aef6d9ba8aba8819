//! Texts of a drawing: all on the canvas, none touching another.

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

/// Every text lies on the canvas and none touches another.
pub fn check_layout(drawing: &Drawing) {
    let tree = Tree::from_str(&drawing.svg, &figures::style::options()).unwrap();
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
