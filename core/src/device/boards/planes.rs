//! Planes: frames with the phases of all N channels of a board, one byte each, followed by their levels.

use crate::device::format::{Code, Reader};
use crate::prelude::*;

/// Writes N phases and then N levels for each board. The bit `begin` is set in the first byte of a board; 0 means no mark.
pub(super) fn write<const N: usize>(boards: usize, begin: u8, code: &dyn Fn(usize) -> Code, frame: &mut [u8]) {
    for (board, bytes) in frame.chunks_exact_mut(2 * N).take(boards).enumerate() {
        for channel in 0..N {
            let Code { phase, level } = code(board * N + channel);
            bytes[channel] = phase as u8;
            bytes[N + channel] = level as u8;
        }
        bytes[0] |= begin;
    }
}

/// Reads a frame that `write` wrote; `most` is the highest level.
pub(super) fn read<const N: usize>(
    boards: usize,
    [begin, most]: [u8; 2],
    frame: &[u8],
    put: &mut dyn FnMut(usize, Code),
) -> Result<()> {
    let mut bytes = Reader::new(frame);
    for board in 0..boards {
        let mut phases = [0; N];
        phases[0] = bytes.byte(|byte| byte & begin == begin, "128 or more where a board's frame begins")?;
        for phase in &mut phases[1..] {
            *phase = bytes.get()?;
        }
        for (channel, phase) in phases.into_iter().enumerate() {
            let level = bytes.byte(|byte| byte <= most, "pulse widths of 0 to 64")?;
            put(board * N + channel, Code { phase: (phase & !begin).into(), level: level.into() });
        }
    }
    bytes.end()
}
