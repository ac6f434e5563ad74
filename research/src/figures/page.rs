//! The page of the gallery.

use super::{Figure, Record};
use std::fmt::Write;

/// `docs/gallery.md`
pub(super) fn render(figures: &[Figure], record: &Record) -> String {
    let mut page = String::from(
        "# Gallery\n\nThe figures of *Chirality across scales in tissue dynamics* that can be computed, made anew by \
         `cargo xtask figures NAME`, with what the paper states beside what came out. Panels that show experiments or \
         sketches are not here. The paper's measured data are not public: slices of the loss, which it draws for them, are drawn here for a \
         simulated tissue with noise (M0H). This page is written by that command; `--quick` makes small ones in `target/figures`.\n",
    );
    for figure in figures {
        let Some(entry) = record.get(figure.name) else { continue };
        // Writing to a string cannot fail.
        let _ = write!(
            page,
            "\n## {}: {}\n\n`cargo xtask figures {}`: {}\n\n**The paper:** {}\n\n**Here:** {}\n",
            figure.name.to_uppercase(),
            figure.title,
            figure.name,
            entry.settings,
            figure.stated,
            entry.found.join(" ")
        );
        for [file, caption] in &entry.panels {
            let _ = write!(page, "\n![{caption}](figures/gallery/{file})\n\n*{caption}*\n");
        }
    }
    page
}
