//! Memory of the caller: reads and writes its handles, texts and lists.

use std::ffi::{CStr, c_char};
use std::path::Path;
use std::slice;

use midair::{Complex32, Error, Result};

use crate::outcome::{Message, Outcome, outcome};

/// A complex number, the same in memory as C's `float _Complex` and C++'s `std::complex<float>`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Complex {
    /// Real part.
    pub re: f32,
    /// Imaginary part.
    pub im: f32,
}

// Casts between the two types are only valid if they have the same layout.
const _: () =
    assert!(size_of::<Complex>() == size_of::<Complex32>() && align_of::<Complex>() == align_of::<Complex32>());

/// Returns the object behind a handle, or an error for NULL.
pub(crate) fn handle<'a, T>(item: &str, handle: Option<&'a T>) -> Result<&'a T> {
    handle.ok_or_else(|| Error::invalid(item, "NULL", format!("make one with midair_{item}_new() or the like")))
}

/// Makes a handle and writes its address to `place`, NULL after an error. The message is what `make` returns besides.
///
/// # Safety
/// `place` is NULL or may be written; the rest is as `make` requires.
pub(crate) unsafe fn give<T, S: AsRef<str>>(
    item: &str,
    place: *mut *mut T,
    message: Message,
    make: impl FnOnce() -> Result<(T, S)>,
) -> Outcome {
    outcome(message, || {
        check(item, place, 1)?;
        let (handle, said) = match make() {
            Ok((made, said)) => (Box::into_raw(Box::new(made)), Ok(said)),
            Err(error) => (std::ptr::null_mut(), Err(error)),
        };
        // SAFETY: `place` is not NULL, and the caller guarantees that it may be written.
        unsafe { place.write(handle) };
        said
    })
}

/// Returns a text of the caller as `str`; `item` names it in errors.
///
/// # Safety
/// `text` is NULL, or ends with NUL.
pub(crate) unsafe fn text<'a>(item: &str, text: *const c_char) -> Result<&'a str> {
    if text.is_null() {
        return Err(Error::invalid(item, "NULL", "give text"));
    }
    // SAFETY: it is not NULL, and the caller guarantees that it ends with NUL.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|_| Error::invalid(item, text.to_string_lossy(), "give text in UTF-8"))
}

/// Reads a path, or `None` for NULL.
///
/// # Safety
/// As for [`text`].
pub(crate) unsafe fn path_or_none<'a>(item: &str, path: *const c_char) -> Result<Option<&'a Path>> {
    // SAFETY: the caller's guarantees are passed on.
    if path.is_null() { Ok(None) } else { unsafe { text(item, path) }.map(|path| Some(Path::new(path))) }
}

/// Returns the `count` entries at an address.
///
/// # Safety
/// `start` is NULL, or `count` entries can be read there as long as the result is used.
pub(crate) unsafe fn list<'a, T>(item: &str, start: *const T, count: usize) -> Result<&'a [T]> {
    if count == 0 {
        return Ok(&[]);
    }
    check(item, start, count)?;
    // SAFETY: the address is neither NULL nor misaligned, the list is not longer than any memory, and the caller guarantees the
    // entries.
    Ok(unsafe { slice::from_raw_parts(start, count) })
}

/// Returns a list as [`list`] does, or `None` for NULL.
///
/// # Safety
/// The conditions of [`list`].
pub(crate) unsafe fn list_or_none<'a, T>(item: &str, start: *const T, count: usize) -> Result<Option<&'a [T]>> {
    // SAFETY: the caller's guarantees are passed on.
    if start.is_null() { Ok(None) } else { unsafe { list(item, start, count) }.map(Some) }
}

/// Returns the `count` vectors x, y, z at an address.
///
/// # Safety
/// The conditions of [`list`], with three times as many entries.
pub(crate) unsafe fn vectors<'a>(item: &str, start: *const f64, count: usize) -> Result<&'a [[f64; 3]]> {
    // SAFETY: the caller's guarantees are passed on; an array of three numbers has the layout of three numbers.
    unsafe { list(item, start.cast::<[f64; 3]>(), count) }
}

/// Returns the drive of `count` complex numbers at an address.
///
/// # Safety
/// The conditions of [`list`].
pub(crate) unsafe fn drive<'a>(start: *const Complex, count: usize) -> Result<&'a [Complex32]> {
    // SAFETY: the caller's guarantees are passed on; both types are two consecutive f32.
    unsafe { list("drive", start.cast::<Complex32>(), count) }
}

/// A request of a caller: points (count, 3), and pressures and weights (count,), `None` for NULL.
#[derive(Clone, Copy)]
pub(crate) struct Lists<'a> {
    pub(crate) points: &'a [[f64; 3]],
    pub(crate) pressures: Option<&'a [f64]>,
    pub(crate) weights: Option<&'a [f64]>,
}

impl Lists<'_> {
    /// Reads the lists of a request.
    ///
    /// # Safety
    /// The conditions of [`vectors`] and [`list`].
    pub(crate) unsafe fn read(
        points: *const f64,
        pressures: *const f64,
        weights: *const f64,
        count: usize,
    ) -> Result<Self> {
        // SAFETY: the caller's guarantees are passed on.
        unsafe {
            Ok(Self {
                points: vectors("points", points, count)?,
                pressures: list_or_none("pressures", pressures, count)?,
                weights: list_or_none("weights", weights, count)?,
            })
        }
    }
}

/// Checks that a buffer is valid and has exactly the `needed` length.
pub(crate) fn room<T>(item: &str, start: *mut T, count: usize, needed: usize) -> Result<()> {
    if count != needed {
        return Err(Error::shape(item, format!("room for {count}"), format!("give room for {needed}")));
    }
    check(item, start, count)
}

/// Writes a list to a buffer that [`room`] has checked.
///
/// # Safety
/// The caller guarantees a buffer for this many entries at `start`.
pub(crate) unsafe fn write<T: Copy>(start: *mut T, values: &[T]) {
    // SAFETY: the caller's guarantees are passed on; the core's memory does not overlap with a buffer of the caller.
    unsafe { start.copy_from_nonoverlapping(values.as_ptr(), values.len()) };
}

/// Writes values to a buffer for `count` of them, after a check of its size. Returns an empty message.
///
/// # Safety
/// The buffer is NULL or has room for `count` values.
pub(crate) unsafe fn fill<T: Copy>(item: &str, start: *mut T, count: usize, values: &[T]) -> Result<&'static str> {
    room(item, start, count, values.len())?;
    // SAFETY: `room` was checked, and the caller guarantees the buffer.
    unsafe { write(start, values) };
    Ok("")
}

/// Checks that an address is not NULL and is aligned, and that the list fits into memory.
fn check<T>(item: &str, start: *const T, count: usize) -> Result<()> {
    if start.is_null() {
        return Err(Error::invalid(item, "NULL", "give an address"));
    }
    if !start.is_aligned() {
        let cure = format!("give a multiple of {}, as the compiler's and malloc's are", align_of::<T>());
        return Err(Error::invalid(item, format!("at address {start:p}"), cure));
    }
    if count > isize::MAX as usize / size_of::<T>() {
        return Err(Error::invalid(item, format!("{count} of them"), "no memory holds so many: look at the count"));
    }
    Ok(())
}
