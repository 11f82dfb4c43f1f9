//! Version of the library and number of its binary interface.

use std::ffi::{CStr, c_char};

use crate::abi::MIDAIR_ABI;

const VERSION: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
    Ok(version) => version,
    Err(_) => panic!("a version without NUL"),
};

/// Returns the version of the library, such as "0.2.0". The text is valid as long as the library is loaded.
#[unsafe(no_mangle)]
pub extern "C" fn midair_version() -> *const c_char {
    VERSION.as_ptr()
}

/// Returns the number of the library's binary interface, to compare with MIDAIR_ABI.
#[unsafe(no_mangle)]
pub extern "C" fn midair_abi() -> u32 {
    MIDAIR_ABI
}
