//! Arrays: made from a preset, a grid or positions; they never change.

use std::ffi::c_char;

use crate::memory::{give, handle, list, list_or_none, room, text, vectors, write};
use crate::outcome::{Message, Outcome, outcome};

/// An array of transducers. It never changes: any number of threads may use it at the same time.
pub struct Array(pub(crate) midair::Array);

/// Makes the array of a preset, such as "autd3" or "paper20", of tiles_x by tiles_y boards (1 by 1 for a single one).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_array_preset(
    name: *const c_char,
    tiles_x: usize,
    tiles_y: usize,
    array: *mut *mut Array,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    let preset = |name| midair::Array::preset(name, [tiles_x, tiles_y]);
    let message = Message { text: message, size: message_size };
    // SAFETY: the caller guarantees name and array.
    unsafe { give("array", array, message, || Ok((Array(preset(text("preset", name)?)?), ""))) }
}

/// Makes the array of a kind of board, such as "nano16": its preset, or a grid if each owner wires this kind differently.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_array_board(
    kind: *const c_char,
    array: *mut *mut Array,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    let message = Message { text: message, size: message_size };
    // SAFETY: the caller guarantees kind and array.
    unsafe { give("array", array, message, || Ok((Array(midair::Array::of_board(text("board", kind)?, [1, 1])?), ""))) }
}

/// Makes a flat grid of nx by ny transducers that radiate to +z, with a pitch in m. It lies in the plane z = 0, centred on the
/// origin; x varies fastest.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_array_grid(
    nx: usize,
    ny: usize,
    pitch: f64,
    array: *mut *mut Array,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    let message = Message { text: message, size: message_size };
    // SAFETY: the caller guarantees array.
    unsafe { give("array", array, message, || Ok((Array(midair::Array::grid(nx, ny, pitch)?), ""))) }
}

/// Makes an array of count transducers at positions (count, 3) in m. They face along normals (count, 3), or along +z if normals
/// is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_array_new(
    positions: *const f64,
    normals: *const f64,
    count: usize,
    array: *mut *mut Array,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    // SAFETY: the caller guarantees the lists and array.
    unsafe {
        give("array", array, Message { text: message, size: message_size }, || {
            let positions = vectors("positions", positions, count)?;
            let normals = list_or_none("normals", normals.cast::<[f64; 3]>(), count)?;
            Ok((Array(midair::Array::new(positions.to_vec(), normals.map(<[_]>::to_vec))?), ""))
        })
    }
}

/// Makes a copy of an array that is rotated about the origin, then translated by x, y, z in m. The rotation has numbers: 3 of
/// an axis times the angle in rad, 4 of a quaternion w, x, y, z, or 9 of a matrix, row by row; NULL and 0 for none. translation
/// may be NULL. Air, lobe, responses and board stay.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_array_moved(
    from: Option<&Array>,
    rotation: *const f64,
    numbers: usize,
    translation: *const f64,
    array: *mut *mut Array,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    // SAFETY: the caller guarantees the lists and array.
    unsafe {
        give("array", array, Message { text: message, size: message_size }, || {
            let from = &handle("from", from)?.0;
            let rotation = list_or_none("rotation", rotation, numbers)?.unwrap_or_default();
            let translation =
                list_or_none("translation", translation.cast::<[f64; 3]>(), 1)?.map_or([0.0; 3], |list| list[0]);
            Ok((Array(from.moved(&midair::Pose::new(rotation, translation)?)?), ""))
        })
    }
}

/// Makes one array of the transducers of count arrays, in their order. They must have the same frequency, transducers and
/// phases and amplitudes. The arrays may be freed afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_array_join(
    arrays: *const Option<&Array>,
    count: usize,
    array: *mut *mut Array,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    // SAFETY: the caller guarantees the list and array.
    unsafe {
        give("array", array, Message { text: message, size: message_size }, || {
            let parts = list("arrays", arrays, count)?.iter().map(|part| Ok(handle("arrays", *part)?.0.clone()));
            Ok((Array(midair::Array::join(&parts.collect::<Result<Vec<_>, midair::Error>>()?)?), ""))
        })
    }
}

/// Returns the number of transducers N; 0 for NULL.
#[unsafe(no_mangle)]
pub extern "C" fn midair_array_count(array: Option<&Array>) -> usize {
    array.map_or(0, |array| array.0.len())
}

/// Writes positions (count, 3) in m and unit normals (count, 3), where count is N. Either may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn midair_array_positions(
    array: Option<&Array>,
    positions: *mut f64,
    normals: *mut f64,
    count: usize,
    message: *mut c_char,
    message_size: usize,
) -> Outcome {
    outcome(Message { text: message, size: message_size }, || {
        let array = &handle("array", array)?.0;
        let lists = [("positions", positions, array.positions()), ("normals", normals, array.normals())];
        let requested = || lists.iter().filter(|(_, start, _)| !start.is_null());
        for &(item, start, values) in requested() {
            room(item, start.cast::<[f64; 3]>(), count, values.len())?;
        }
        for &(_, start, values) in requested() {
            // SAFETY: `room` was checked, and the caller guarantees the buffer.
            unsafe { write(start.cast(), values) };
        }
        Ok("")
    })
}

/// Frees an array. Sessions made from it can still be used. NULL is allowed.
#[unsafe(no_mangle)]
pub extern "C" fn midair_array_free(array: Option<Box<Array>>) {
    drop(array);
}
