//! Catalogue: the core's version, presets, solvers and boards, as text.

use std::fmt::Write;

use midair::solvers::SOLVERS;
use midair::{Board, presets::PRESETS};

/// Returns version, presets, solvers and boards: one line each, with tabs between the entries.
pub(crate) fn catalogue() -> String {
    let mut text = format!("version\t{}\n", env!("CARGO_PKG_VERSION"));
    for preset in PRESETS {
        let (tiles, board) = (u8::from(preset.tiles), preset.board.unwrap_or_default());
        let _ = writeln!(text, "preset\t{}\t{}\t{}\t{tiles}\t{board}", preset.name, preset.summary, preset.count);
    }
    for entry in SOLVERS {
        let aims = u8::from(entry.info.uses_aim);
        let _ = writeln!(text, "solver\t{}\t{}\t{aims}", entry.info.name, entry.info.summary);
    }
    for name in Board::names() {
        if let Ok(board) = Board::new(name, 1) {
            let (summary, channels) = (board.summary(), board.channel_count());
            let (baud, restarts) = (board.baud().unwrap_or_default(), u8::from(board.link().restarts()));
            let _ = writeln!(text, "board\t{name}\t{summary}\t{channels}\t{baud}\t{restarts}");
        }
    }
    text
}
