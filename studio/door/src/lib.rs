//! midair's binding for browsers: a scene as text, numbers in two buffers, and plain C functions on them.
//!
//! A page makes a [`Studio`] and writes the text of a scene file to the address that [`studio_text_in`] returns. It
//! opens and solves the scene, and reads the results at [`studio_numbers`], [`studio_drive`] and [`studio_pressures`].
//! Functions that can fail return 0 if they succeed, else 1, with a message of one line in [`studio_text`]. Addresses
//! are valid until the next call with the same studio.
#![allow(clippy::missing_safety_doc, reason = "a module of WebAssembly sees no memory but its own")]

mod beads;
mod catalogue;
mod drawn;
mod lattices;
mod opened;
mod play;
mod studio;
mod touch;

pub use studio::Studio;

/// Makes a studio: one scene, its session and the buffers.
#[unsafe(no_mangle)]
pub extern "C" fn studio_new() -> Box<Studio> {
    Box::default()
}

/// Frees a studio.
#[unsafe(no_mangle)]
pub extern "C" fn studio_free(studio: Box<Studio>) {
    drop(studio);
}

/// Returns the address of a buffer for this many bytes of text.
#[unsafe(no_mangle)]
pub extern "C" fn studio_text_in(studio: &mut Studio, size: usize) -> *mut u8 {
    studio.text_in.resize(size, 0);
    studio.text_in.as_mut_ptr()
}

/// Returns the address of a buffer for this many numbers.
#[unsafe(no_mangle)]
pub extern "C" fn studio_numbers_in(studio: &mut Studio, count: usize) -> *mut f64 {
    studio.numbers_in.resize(count, 0.0);
    studio.numbers_in.as_mut_ptr()
}

/// Returns the address of the text that the last call wrote: an error message, warnings (one per line), a scene or the
/// catalogue.
#[unsafe(no_mangle)]
pub extern "C" fn studio_text(studio: &Studio) -> *const u8 {
    studio.text.as_ptr()
}

/// Returns the length in bytes of the text at [`studio_text`].
#[unsafe(no_mangle)]
pub extern "C" fn studio_text_size(studio: &Studio) -> usize {
    studio.text.len()
}

/// Returns the address of the numbers that the last call wrote.
#[unsafe(no_mangle)]
pub extern "C" fn studio_numbers(studio: &Studio) -> *const f64 {
    studio.numbers.as_ptr()
}

/// Returns how many numbers are at [`studio_numbers`].
#[unsafe(no_mangle)]
pub extern "C" fn studio_numbers_count(studio: &Studio) -> usize {
    studio.numbers.len()
}

/// Returns the address of the drive (N,), re and im in f32.
#[unsafe(no_mangle)]
pub extern "C" fn studio_drive(studio: &Studio) -> *const f32 {
    studio.drive.as_ptr().cast()
}

/// Returns the number of transducers N of the drive, or 0 if there is no drive.
#[unsafe(no_mangle)]
pub extern "C" fn studio_drive_count(studio: &Studio) -> usize {
    studio.drive.len()
}

/// Returns the address of the complex pressures of the last field, re and im in f32.
#[unsafe(no_mangle)]
pub extern "C" fn studio_pressures(studio: &Studio) -> *const f32 {
    studio.pressures.as_ptr().cast()
}

/// Returns the address of the bytes of the last frame.
#[unsafe(no_mangle)]
pub extern "C" fn studio_bytes(studio: &Studio) -> *const u8 {
    studio.bytes.as_ptr()
}

/// Returns how many bytes are at [`studio_bytes`].
#[unsafe(no_mangle)]
pub extern "C" fn studio_bytes_size(studio: &Studio) -> usize {
    studio.bytes.len()
}

/// Writes version, presets, solvers and boards to the text: one line each, with tabs between the entries.
#[unsafe(no_mangle)]
pub extern "C" fn studio_catalogue(studio: &mut Studio) {
    studio.text = catalogue::catalogue();
}

/// Opens the scene in the text buffer: TOML, or JSON if `toml` is 0; with scalar instructions, or the best ones if
/// `scalar` is 0. Writes the scene's warnings to the text.
#[unsafe(no_mangle)]
pub extern "C" fn studio_open(studio: &mut Studio, toml: u32, scalar: u32) -> u32 {
    studio.work(|studio| studio.open(toml != 0, scalar != 0))
}

/// Writes the scene to the text as the command line does: TOML, or JSON if `toml` is 0.
#[unsafe(no_mangle)]
pub extern "C" fn studio_save(studio: &mut Studio, toml: u32) -> u32 {
    studio.work(|studio| studio.save(toml != 0))
}

/// Writes positions (N, 3) in m and normals (N, 3) of the scene's array to the numbers.
#[unsafe(no_mangle)]
pub extern "C" fn studio_array(studio: &mut Studio) -> u32 {
    studio.work(Studio::array)
}

/// Reads an array from CSV in the text buffer, whose first line is the file's name. Writes the same numbers as
/// `studio_array`.
#[unsafe(no_mangle)]
pub extern "C" fn studio_read_array(studio: &mut Studio) -> u32 {
    studio.work(Studio::read_array)
}

/// Sets the drive from CSV in the text buffer, whose first line is the file's name.
#[unsafe(no_mangle)]
pub extern "C" fn studio_read_drive(studio: &mut Studio) -> u32 {
    studio.work(Studio::read_drive)
}

/// Writes the drive as CSV to the text.
#[unsafe(no_mangle)]
pub extern "C" fn studio_write_drive(studio: &mut Studio) -> u32 {
    studio.work(Studio::write_drive)
}

/// Solves the scene with its solver. The numbers are accuracy, sigma, uniformity, level, residual, leak, scale, status
/// (0 done, 1 out of steps, 2 stopped, 3 missed), steps, and target, re and im of each point in Pa. Writes warnings to
/// the text.
#[unsafe(no_mangle)]
pub extern "C" fn studio_solve(studio: &mut Studio) -> u32 {
    studio.work(Studio::solve)
}

/// Moves the scene's points. The number buffer has M points (M, 3) in m, then M pressures in Pa, or no pressures to keep
/// the old ones. The next solve starts from the last drive.
#[unsafe(no_mangle)]
pub extern "C" fn studio_move(studio: &mut Studio, points: usize) -> u32 {
    studio.work(|studio| studio.set_points(points))
}

/// Computes the six metrics of the drive at the scene's points, and writes them to the numbers.
#[unsafe(no_mangle)]
pub extern "C" fn studio_judge(studio: &mut Studio) -> u32 {
    studio.work(Studio::judge)
}

/// Sets the drive (N, 2) from the number buffer, and the factor that the supply voltage or modulation must apply.
#[unsafe(no_mangle)]
pub extern "C" fn studio_load(studio: &mut Studio, scale: f32) -> u32 {
    studio.work(|studio| studio.load(scale))
}

/// Computes the field of the drive, with its scale applied, at the places (K, 3) in m of the number buffer; writes the
/// pressures.
#[unsafe(no_mangle)]
pub extern "C" fn studio_field(studio: &mut Studio) -> u32 {
    studio.work(Studio::field)
}

/// Computes the field like `studio_field`. The numbers of each place are re and im in Pa, the level in dB SPL, and the
/// radiation pressure on a rigid wall in Pa.
#[unsafe(no_mangle)]
pub extern "C" fn studio_probe(studio: &mut Studio) -> u32 {
    studio.work(Studio::probe)
}

/// Writes at most `most` points (K, 3) in m along contours. The number buffer has, for each contour, its number of
/// vertices V and then the vertices (V, 3).
#[unsafe(no_mangle)]
pub extern "C" fn studio_along(studio: &mut Studio, most: usize) -> u32 {
    studio.work(|studio| studio.along(most))
}

/// Computes the level that no drive exceeds, and writes it to the numbers.
#[unsafe(no_mangle)]
pub extern "C" fn studio_bound(studio: &mut Studio) -> u32 {
    studio.work(Studio::bound)
}

/// Solves the frames (T, M, 3) in m of the number buffer one after the other. The numbers of each frame are the largest
/// phase change from the frame before in rad, the least |p| of its points that are not quiet, and the largest |p| of
/// all points, in Pa.
#[unsafe(no_mangle)]
pub extern "C" fn studio_follow(studio: &mut Studio, frames: usize) -> u32 {
    studio.work(|studio| studio.follow(frames))
}

/// Sets the drive to that of a frame of `studio_follow`.
#[unsafe(no_mangle)]
pub extern "C" fn studio_frame(studio: &mut Studio, frame: usize) -> u32 {
    studio.work(|studio| studio.frame(frame))
}

/// Predicts the motion of a skin at the places (K, 3) in m in the numbers buffer, a square lattice. The frames that
/// `studio_follow` has solved repeat for ever at `rate` frames per second. The numbers are the felt width in m, the largest
/// displacement in m, and the felt strength at each place; 1 is the threshold.
#[unsafe(no_mangle)]
pub extern "C" fn studio_skin(studio: &mut Studio, rate: f64) -> u32 {
    studio.work(|studio| studio.skin(rate))
}

/// Writes the displacement of the skin in m at each place, at the start of a frame, into the numbers.
#[unsafe(no_mangle)]
pub extern "C" fn studio_moved(studio: &mut Studio, frame: usize) -> u32 {
    studio.work(|studio| studio.moved(frame))
}

/// Simulates the bead in the trap of a point while the frames of `studio_follow` repeat at `rate` frames/s. The numbers are the
/// time in s at which it was lost or NaN, its largest distance from the path in m until then, and its places (F, 3) in m
/// at the frames of all laps.
#[unsafe(no_mangle)]
pub extern "C" fn studio_fly(studio: &mut Studio, point: usize, rate: f64) -> u32 {
    studio.work(|studio| studio.fly(point, rate))
}

/// Writes the bytes with which the board named in the text buffer plays the drive. The only number is the board's baud rate, or
/// 0 if it has none.
#[unsafe(no_mangle)]
pub extern "C" fn studio_encode(studio: &mut Studio) -> u32 {
    studio.work(Studio::encode)
}

/// Writes the bytes that silence the board named in the text buffer, from any state.
#[unsafe(no_mangle)]
pub extern "C" fn studio_silence(studio: &mut Studio) -> u32 {
    studio.work(Studio::silence)
}
