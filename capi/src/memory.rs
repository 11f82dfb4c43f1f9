//! Memory of the caller: its handles, texts and lists, read and written.

use std::ffi::{CStr, c_char};
use std::slice;

use midair::{Complex32, Error};

/// A complex number, the same in memory as C's `float _Complex` and C++'s `std::complex<float>`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Complex {
    /// Real part.
    pub re: f32,
    /// Imaginary part.
    pub im: f32,
}

// `complex` and `write` assume that both types have the same layout.
const _: () =
    assert!(size_of::<Complex>() == size_of::<Complex32>() && align_of::<Complex>() == align_of::<Complex32>());

/// The object behind a handle.
pub(crate) fn handle<'a, T>(item: &str, handle: Option<&'a T>) -> Result<&'a T, Error> {
    handle.ok_or_else(|| Error::invalid(item, "NULL", format!("make one with midair_{item}_new() or the like")))
}

/// Hands a new handle over; NULL in place of one that could not be made.
///
/// # Safety
/// `place` is NULL or an aligned address that may be written.
pub(crate) unsafe fn give<T>(item: &str, place: *mut *mut T, made: Result<T, Error>) -> Result<(), Error> {
    check(item, place, 1)?;
    let (handle, result) = match made {
        Ok(made) => (Box::into_raw(Box::new(made)), Ok(())),
        Err(error) => (std::ptr::null_mut(), Err(error)),
    };
    // SAFETY: it is not NULL, and may be written as the caller guarantees.
    unsafe { place.write(handle) };
    result
}

/// A text.
///
/// # Safety
/// `text` is NULL or ends with a NUL.
pub(crate) unsafe fn text<'a>(item: &str, text: *const c_char) -> Result<&'a str, Error> {
    if text.is_null() {
        return Err(Error::invalid(item, "NULL", "give text"));
    }
    // SAFETY: it is not NULL, and ends as the caller guarantees.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|_| Error::invalid(item, text.to_string_lossy(), "give text in UTF-8"))
}

/// `count` entries from an address on.
///
/// # Safety
/// `start` is NULL or this many entries can be read there while the answer is in use.
pub(crate) unsafe fn list<'a, T>(item: &str, start: *const T, count: usize) -> Result<&'a [T], Error> {
    if count == 0 {
        return Ok(&[]);
    }
    check(item, start, count)?;
    // SAFETY: neither NULL nor misaligned nor longer than any memory; the entries are there as the caller guarantees.
    Ok(unsafe { slice::from_raw_parts(start, count) })
}

/// Like [`list`], where NULL stands for a missing list.
///
/// # Safety
/// That of [`list`].
pub(crate) unsafe fn list_or_none<'a, T>(item: &str, start: *const T, count: usize) -> Result<Option<&'a [T]>, Error> {
    // SAFETY: as the caller's.
    if start.is_null() { Ok(None) } else { unsafe { list(item, start, count) }.map(Some) }
}

/// `count` vectors x, y, z from an address on.
///
/// # Safety
/// That of [`list`], for three times as many entries.
pub(crate) unsafe fn vectors<'a>(item: &str, start: *const f64, count: usize) -> Result<&'a [[f64; 3]], Error> {
    // SAFETY: as the caller's; an array of three is three in a row.
    unsafe { list(item, start.cast::<[f64; 3]>(), count) }
}

/// A drive.
///
/// # Safety
/// That of [`list`].
pub(crate) unsafe fn drive<'a>(start: *const Complex, count: usize) -> Result<&'a [Complex32], Error> {
    // SAFETY: as the caller's; both types are two f32 in a row.
    unsafe { list("drive", start.cast::<Complex32>(), count) }
}

/// A request as a caller writes it: points (count, 3), and pressures and weights (count,), which may be NULL.
#[derive(Clone, Copy)]
pub(crate) struct Lists<'a> {
    pub(crate) points: &'a [[f64; 3]],
    pub(crate) pressures: Option<&'a [f64]>,
    pub(crate) weights: Option<&'a [f64]>,
}

impl Lists<'_> {
    /// # Safety
    /// That of [`vectors`] and [`list`].
    pub(crate) unsafe fn read(
        points: *const f64,
        pressures: *const f64,
        weights: *const f64,
        count: usize,
    ) -> Result<Self, Error> {
        // SAFETY: as the caller's.
        unsafe {
            Ok(Self {
                points: vectors("points", points, count)?,
                pressures: list_or_none("pressures", pressures, count)?,
                weights: list_or_none("weights", weights, count)?,
            })
        }
    }
}

/// Rejects a buffer whose length differs from that of the content.
pub(crate) fn room<T>(item: &str, start: *mut T, count: usize, needed: usize) -> Result<(), Error> {
    if count != needed {
        return Err(Error::invalid(item, format!("room for {count}"), format!("give room for {needed}")));
    }
    check(item, start, count)
}

/// Writes a list to where there is [`room`] for it.
///
/// # Safety
/// This many entries may be written from `start` on, which [`room`] did not refuse.
pub(crate) unsafe fn write<T: Copy>(start: *mut T, values: &[T]) {
    // SAFETY: as the caller's; memory that the core works in does not lie in a buffer of the caller's.
    unsafe { start.copy_from_nonoverlapping(values.as_ptr(), values.len()) };
}

/// Refuses an address where no entry can be.
fn check<T>(item: &str, start: *const T, count: usize) -> Result<(), Error> {
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
