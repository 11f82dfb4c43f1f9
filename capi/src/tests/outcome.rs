//! Tests of outcomes: panics, codes and messages.

use midair::Error;

use super::*;

/// Returns the outcome, and the text in a buffer of `size` bytes.
fn reported(size: usize, work: impl FnOnce() -> Result<&'static str, Error>) -> (Outcome, String) {
    let mut buffer = vec![b'?'; size];
    let outcome = outcome(Message { text: buffer.as_mut_ptr().cast(), size }, work);
    let end = buffer.iter().position(|&byte| byte == 0).expect("a NUL");
    (outcome, String::from_utf8(buffer[..end].to_vec()).expect("whole characters"))
}

#[test]
fn a_panic_is_an_outcome() {
    let text = "a fault of midair's own, please report it: two is 3".to_string();
    let number = 3;
    assert_eq!(reported(80, || panic!("two is {number}")), (Outcome::Fault, text.clone()));
    assert_eq!(reported(80, || panic!("two is 3")), (Outcome::Fault, text));
}

#[test]
fn the_code_of_the_last_call_is_a_text() {
    let last = || {
        // SAFETY: the text ends with NUL, and is never changed.
        unsafe { std::ffi::CStr::from_ptr(midair_last_code()) }.to_str().expect("ASCII")
    };
    assert_eq!((reported(80, || Err(Error::missing("a", "b", "c"))).0, last()), (Outcome::Invalid, "missing"));
    assert_eq!((reported(80, || panic!("two is 3")).0, last()), (Outcome::Fault, "fault"));
    assert_eq!((reported(80, || Ok("")).0, last()), (Outcome::Ok, ""));
    for (code, name, _) in ErrorCode::ALL {
        reported(80, || Err(Error::new(*code, "a", "b", "c")));
        assert_eq!((last(), ErrorCode::of(last())), (*name, Some(*code)));
    }
}

#[test]
fn a_message_is_cut_after_a_whole_character() {
    let refused = || Err(Error::invalid("ä", "ö", "ü"));
    assert_eq!(reported(80, refused), (Outcome::Invalid, "ä is ö: ü".to_string()));
    for (size, part) in [(13, "ä is ö: ü"), (12, "ä is ö: "), (9, "ä is ö"), (8, "ä is "), (2, ""), (1, "")] {
        assert_eq!(reported(size, refused).1, part, "{size} bytes");
    }
    let nowhere = Message { text: std::ptr::null_mut(), size: 80 };
    assert_eq!(outcome(nowhere, || Ok("")), Outcome::Ok);
}
