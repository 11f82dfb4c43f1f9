//! Catalogue: the core's version, presets, solvers and boards, as JSON.

use midair::solvers::SOLVERS;
use midair::{Board, presets::PRESETS};
use serde_json::{Value, json};

/// Returns version, presets, solvers and boards, with the names of `Catalogue` in studio/src/solving/door.ts.
pub(crate) fn catalogue() -> Value {
    let presets = PRESETS.iter().map(|preset| {
        let board = preset.board.unwrap_or_default();
        json!({ "name": preset.name, "summary": preset.summary, "count": preset.count, "tiles": preset.tiles, "board": board })
    });
    let solvers = SOLVERS.iter().map(|entry| {
        let info = &entry.info;
        json!({ "name": info.name, "summary": info.summary, "aims": info.uses_aim })
    });
    let boards =
        Board::names().filter_map(|name| Board::new(name, 1).ok().map(|board| (name, board))).map(|(name, board)| {
            let (baud, restarts) = (board.baud().unwrap_or_default(), board.link().restarts());
            let (summary, channels) = (board.summary(), board.channel_count());
            json!({ "name": name, "summary": summary, "channels": channels, "baud": baud, "restarts": restarts })
        });
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "presets": presets.collect::<Value>(),
        "solvers": solvers.collect::<Value>(),
        "boards": boards.collect::<Value>(),
    })
}
