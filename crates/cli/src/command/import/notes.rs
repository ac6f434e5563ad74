//! What was read, guessed and doubted of a file, as it is told and written down.

use crate::run::Run;
use voronudge_io::{Note, NoteKind};
use voronudge_report::shape_report::NoteRecord;

/// Warns of what is doubtful; the rest as lines for the summary.
pub(super) fn told(run: &mut Run, notes: &[Note]) -> String {
    let of = |kind| notes.iter().filter(move |note| note.kind == kind).map(|note| note.text.as_str());
    for text in of(NoteKind::Doubtful) {
        run.warn(text);
    }
    let mut lines = String::new();
    for kind in [NoteKind::Read, NoteKind::Guessed] {
        let texts: Vec<&str> = of(kind).collect();
        if !texts.is_empty() {
            lines += &format!("{kind}: {}\n", texts.join("; "));
        }
    }
    lines
}

/// All of them, for the report.
pub(crate) fn records(notes: &[Note]) -> Vec<NoteRecord> {
    notes.iter().map(|note| NoteRecord { kind: note.kind.to_string(), text: note.text.clone() }).collect()
}
