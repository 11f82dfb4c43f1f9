//! midair's binding for browsers: a scene as text, numbers in two buffers, and plain C functions on them.
//!
//! A page makes a [`Studio`] and writes the text of a scene file to the address that [`studio_text_in`] returns. It
//! opens and solves the scene, and reads the results at [`studio_result`]. Functions that can fail return 0 if they
//! succeed, else 1, with the error as JSON in the text. Addresses are valid until the next call with the same
//! studio.
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

/// Returns the address of a result of the last call: 0 the text (an error or warnings as JSON, a scene or the
/// catalogue), 1 the numbers, 2 the drive (N,), 3 the pressures of the field, both re and im in f32, or 4 the bytes.
#[unsafe(no_mangle)]
pub extern "C" fn studio_result(studio: &Studio, kind: u32) -> *const u8 {
    studio.result(kind).0
}

/// Returns how many bytes, numbers or complex numbers are at [`studio_result`].
#[unsafe(no_mangle)]
pub extern "C" fn studio_count(studio: &Studio, kind: u32) -> usize {
    studio.result(kind).1
}

/// Writes version, presets, solvers and boards to the text, as JSON.
#[unsafe(no_mangle)]
pub extern "C" fn studio_catalogue(studio: &mut Studio) {
    studio.text = catalogue::catalogue().to_string();
}

/// Declares functions that call a method of a [`Studio`]. They return 0 if it succeeds, else 1.
macro_rules! jobs {
    ($($(#[$doc:meta])* $name:ident($($argument:ident: $kind:ty),*) = $method:ident;)*) => {
        $(
            $(#[$doc])*
            #[unsafe(no_mangle)]
            pub extern "C" fn $name(studio: &mut Studio $(, $argument: $kind)*) -> u32 {
                studio.work(|studio| studio.$method($($argument),*))
            }
        )*
    };
}

jobs! {
    /// Opens the scene in the text buffer: TOML or JSON. Writes the scene's warnings to the text.
    studio_open(toml: bool) = open;

    /// Writes the scene to the text as the command line does: TOML or JSON.
    studio_save(toml: bool) = save;

    /// Writes positions (N, 3) in m and normals (N, 3) of the scene's array to the numbers.
    studio_array() = array;

    /// Reads an array from CSV in the text buffer, whose first line is the file's name. Writes the same numbers as
    /// `studio_array`.
    studio_read_array() = read_array;

    /// Sets the drive from CSV in the text buffer, whose first line is the file's name.
    studio_read_drive() = read_drive;

    /// Writes the drive as CSV to the text.
    studio_write_drive() = write_drive;

    /// Solves the scene with its solver. The numbers are accuracy, sigma, uniformity, level, residual, leak, scale, steps,
    /// and target, re and im of each point in Pa. Writes the status and the warnings to the text,
    /// as JSON.
    studio_solve() = solve;

    /// Writes how many traps of the solution hold their bead, and the number of traps, to the numbers; nothing without traps.
    studio_beads() = count_beads;

    /// Moves the scene's points. The number buffer has M points (M, 3) in m, then M pressures in Pa, or no pressures to keep
    /// the old ones. The next solve starts from the last drive.
    studio_move(points: usize) = set_points;

    /// Computes the six metrics of the drive at the scene's points, and writes them to the numbers.
    studio_judge() = judge;

    /// Sets the drive (N, 2) from the number buffer, and the factor that the supply voltage or modulation must apply.
    studio_load(scale: f32) = load;

    /// Computes the field of the drive, with its scale applied, at the places (K, 3) in m of the number buffer; writes the
    /// pressures.
    studio_field() = field;

    /// Computes the field like `studio_field`. The numbers of each place are re and im in Pa, the level in dB SPL, and the
    /// radiation pressure on a rigid wall in Pa.
    studio_probe() = probe;

    /// Writes at most `most` points (K, 3) in m along contours. The number buffer has, for each contour, its number of
    /// vertices V and then the vertices (V, 3).
    studio_along(most: usize) = along;

    /// Computes the level that no drive exceeds, and writes it to the numbers.
    studio_bound() = bound;

    /// Writes the motion of the scene to the numbers: rate in frames per second, 1 if the last frame continues to the first,
    /// else 0, and the number of points M; then the points (T, M, 3) in m and the targets (T, M) in Pa of all frames. Fails for
    /// a scene without `[motion]`.
    studio_motion() = motion;

    /// Solves the frames (T, M, 3) in m of the number buffer one after the other; with 0 frames, those of the scene's motion.
    /// The numbers of each frame are the largest phase change from the frame before in rad, the least |p| of its points that
    /// are not quiet, and the largest |p| of all points, in Pa.
    studio_follow(frames: usize) = follow;

    /// Sets the drive to that of a frame of `studio_follow`.
    studio_frame(frame: usize) = frame;

    /// Predicts the motion of a skin at the places (K, 3) in m in the numbers buffer, a square lattice. The frames that
    /// `studio_follow` has solved repeat for ever at `rate` frames per second. The numbers are the felt width in m, the largest
    /// displacement in m, the force in N of a contact that is felt alike, and then at each place the felt strength, 1 at the
    /// threshold; and at each place the pressure in Pa that is felt as a push.
    studio_skin(rate: f64) = skin;

    /// Writes the displacement of the skin in m at each place, at the start of a frame, into the numbers.
    studio_moved(frame: usize) = moved;

    /// Simulates the bead in the trap of a point while the frames of `studio_follow` repeat at `rate` frames/s. The numbers are the
    /// time in s at which it was lost or NaN, its largest distance from its point in m until then, and its places (F, 3) in m
    /// at the frames of all laps until then.
    studio_fly(point: usize, rate: f64) = fly;

    /// Writes the bytes with which the board named in the text buffer plays the drive. The only number is the board's baud rate, or
    /// 0 if it has none.
    studio_encode() = encode;

    /// Writes the bytes that silence the board named in the text buffer, from any state.
    studio_silence() = silence;
}
