//! Structure of the figures, on synthetic outcomes: everything draws, nothing overlaps, the numbers are right.

#[path = "figures/synthetic.rs"]
mod synthetic;

use stickslip::figures;
use synthetic::suited;

/// Writes every figure as PNG to `$STICKSLIP_FIGURES`, for looking at; does nothing where that is not set.
#[test]
fn gallery() {
    let Some(folder) = std::env::var_os("STICKSLIP_FIGURES") else { return };
    let folder = std::path::PathBuf::from(folder);
    std::fs::create_dir_all(&folder).unwrap();
    for figure in figures::REGISTRY {
        match figure.draw(&suited(figure.name())) {
            Ok(drawing) => {
                std::fs::write(folder.join(format!("{}.png", drawing.name)), figures::png(&drawing.svg, 1.0).unwrap())
                    .unwrap()
            }
            Err(error) => panic!("{}: {error}", figure.name()),
        }
    }
}
