//! The browser's door of midair: a scene as text, numbers in two buffers, and plain C functions over them.
//!
//! A page makes a [`Studio`], writes a scene file's text where [`studio_text_in`] says, opens it, solves it, and reads
//! the answer where [`studio_numbers`], [`studio_drive`] and [`studio_pressures`] say. Functions that may refuse return 0,
//! or 1 and leave one line in [`studio_text`]. Addresses hold until the next call with the same studio.
#![allow(clippy::missing_safety_doc, reason = "a module of WebAssembly sees no memory but its own")]

mod catalogue;
mod drawn;
mod lattices;
mod opened;
mod play;
mod studio;

pub use studio::Studio;

/// A studio: one scene, its session and the buffers.
#[unsafe(no_mangle)]
pub extern "C" fn studio_new() -> Box<Studio> {
    Box::default()
}

/// Frees a studio.
#[unsafe(no_mangle)]
pub extern "C" fn studio_free(studio: Box<Studio>) {
    drop(studio);
}

/// Room for this many bytes of text.
#[unsafe(no_mangle)]
pub extern "C" fn studio_text_in(studio: &mut Studio, size: usize) -> *mut u8 {
    studio.text_in.resize(size, 0);
    studio.text_in.as_mut_ptr()
}

/// Room for this many numbers.
#[unsafe(no_mangle)]
pub extern "C" fn studio_numbers_in(studio: &mut Studio, count: usize) -> *mut f64 {
    studio.numbers_in.resize(count, 0.0);
    studio.numbers_in.as_mut_ptr()
}

/// The text of the last call: a refusal, warnings a line each, a scene, the catalogue.
#[unsafe(no_mangle)]
pub extern "C" fn studio_text(studio: &Studio) -> *const u8 {
    studio.text.as_ptr()
}

/// Its bytes.
#[unsafe(no_mangle)]
pub extern "C" fn studio_text_size(studio: &Studio) -> usize {
    studio.text.len()
}

/// The numbers of the last call that has any.
#[unsafe(no_mangle)]
pub extern "C" fn studio_numbers(studio: &Studio) -> *const f64 {
    studio.numbers.as_ptr()
}

/// The number of them.
#[unsafe(no_mangle)]
pub extern "C" fn studio_numbers_count(studio: &Studio) -> usize {
    studio.numbers.len()
}

/// The drive (N,), re and im in f32.
#[unsafe(no_mangle)]
pub extern "C" fn studio_drive(studio: &Studio) -> *const f32 {
    studio.drive.as_ptr().cast()
}

/// N, or 0 while there is none.
#[unsafe(no_mangle)]
pub extern "C" fn studio_drive_count(studio: &Studio) -> usize {
    studio.drive.len()
}

/// The complex pressures of the last field, re and im in f32.
#[unsafe(no_mangle)]
pub extern "C" fn studio_pressures(studio: &Studio) -> *const f32 {
    studio.pressures.as_ptr().cast()
}

/// The bytes of the last frame.
#[unsafe(no_mangle)]
pub extern "C" fn studio_bytes(studio: &Studio) -> *const u8 {
    studio.bytes.as_ptr()
}

/// How many they are.
#[unsafe(no_mangle)]
pub extern "C" fn studio_bytes_size(studio: &Studio) -> usize {
    studio.bytes.len()
}

/// Writes version, presets, solvers and boards into the text: a line each, tabs between.
#[unsafe(no_mangle)]
pub extern "C" fn studio_catalogue(studio: &mut Studio) {
    studio.text = catalogue::catalogue();
}

/// Opens the scene of the text, TOML or (0) JSON, with the scalar instructions or (0) the best; warnings are the text.
#[unsafe(no_mangle)]
pub extern "C" fn studio_open(studio: &mut Studio, toml: u32, scalar: u32) -> u32 {
    studio.work(|studio| studio.open(toml != 0, scalar != 0))
}

/// Writes the scene into the text, TOML or (0) JSON, as the command line writes it.
#[unsafe(no_mangle)]
pub extern "C" fn studio_save(studio: &mut Studio, toml: u32) -> u32 {
    studio.work(|studio| studio.save(toml != 0))
}

/// Positions (N, 3) in m and normals (N, 3) of the scene's array, into the numbers.
#[unsafe(no_mangle)]
pub extern "C" fn studio_array(studio: &mut Studio) -> u32 {
    studio.work(Studio::array)
}

/// Reads an array from a CSV, the name of the file in the text's first line: the numbers are as of `studio_array`.
#[unsafe(no_mangle)]
pub extern "C" fn studio_read_array(studio: &mut Studio) -> u32 {
    studio.work(Studio::read_array)
}

/// Takes the drive of a CSV, the name of the file in the text's first line.
#[unsafe(no_mangle)]
pub extern "C" fn studio_read_drive(studio: &mut Studio) -> u32 {
    studio.work(Studio::read_drive)
}

/// Writes the drive as CSV into the text.
#[unsafe(no_mangle)]
pub extern "C" fn studio_write_drive(studio: &mut Studio) -> u32 {
    studio.work(Studio::write_drive)
}

/// Solves the scene by its solver. The numbers are accuracy, sigma, uniformity, level, residual, leak, scale, status (0
/// done, 1 out of steps, 2 stopped), steps, and target, re and im of each point in Pa; warnings are the text.
#[unsafe(no_mangle)]
pub extern "C" fn studio_solve(studio: &mut Studio) -> u32 {
    studio.work(Studio::solve)
}

/// Moves the scene's points, and requests other pressures there: the numbers handed in are M points (M, 3) in m, then M
/// pressures in Pa or none, for those from before. The next solve follows the last.
#[unsafe(no_mangle)]
pub extern "C" fn studio_move(studio: &mut Studio, points: usize) -> u32 {
    studio.work(|studio| studio.set_points(points))
}

/// Judges the drive at the scene's points: the numbers are the six metrics.
#[unsafe(no_mangle)]
pub extern "C" fn studio_judge(studio: &mut Studio) -> u32 {
    studio.work(Studio::judge)
}

/// Takes the drive (N, 2) of the numbers in the buffer, and the factor that supply or modulation must apply.
#[unsafe(no_mangle)]
pub extern "C" fn studio_load(studio: &mut Studio, scale: f32) -> u32 {
    studio.work(|studio| studio.load(scale))
}

/// The field of the drive, its scale counted in, at the places (K, 3) in m handed in, into the pressures.
#[unsafe(no_mangle)]
pub extern "C" fn studio_field(studio: &mut Studio) -> u32 {
    studio.work(Studio::field)
}

/// Like `studio_field`; the numbers of each place are re and im in Pa, the level in dB SPL, the radiation pressure on
/// a wall in Pa.
#[unsafe(no_mangle)]
pub extern "C" fn studio_probe(studio: &mut Studio) -> u32 {
    studio.work(Studio::probe)
}

/// Points (K, 3) in m along contours, at most `most`: of each its number of vertices, then those (V, 3), are handed in.
#[unsafe(no_mangle)]
pub extern "C" fn studio_along(studio: &mut Studio, most: usize) -> u32 {
    studio.work(|studio| studio.along(most))
}

/// The level that no drive exceeds: the first of the numbers.
#[unsafe(no_mangle)]
pub extern "C" fn studio_bound(studio: &mut Studio) -> u32 {
    studio.work(Studio::bound)
}

/// Solves frames (T, M, 3) in m handed in one after another by the scene's solver. The numbers are, of each frame, the
/// largest change of a phase from the one before in rad, the least |p| of its points that are not quiet, and the largest of
/// all, in Pa.
#[unsafe(no_mangle)]
pub extern "C" fn studio_follow(studio: &mut Studio, frames: usize) -> u32 {
    studio.work(|studio| studio.follow(frames))
}

/// Takes the drive of a frame that was followed.
#[unsafe(no_mangle)]
pub extern "C" fn studio_frame(studio: &mut Studio, frame: usize) -> u32 {
    studio.work(|studio| studio.frame(frame))
}

/// Writes the bytes that make the board of the text play the drive; the numbers are its baud rate, or 0.
#[unsafe(no_mangle)]
pub extern "C" fn studio_encode(studio: &mut Studio) -> u32 {
    studio.work(Studio::encode)
}

/// Writes the bytes that silence the board of the text from any state.
#[unsafe(no_mangle)]
pub extern "C" fn studio_silence(studio: &mut Studio) -> u32 {
    studio.work(Studio::silence)
}
