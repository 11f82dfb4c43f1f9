//! Tests the readers of CSV files of positions and of drives: any bytes give an error of one line, or an array or a drive.

use crate::one_line;
use midair::files::{read_array, read_drive, write_drive};

/// Runs the test with these bytes as the content of a CSV file.
pub fn check(bytes: &[u8]) {
    let rows = bytes.split(|&byte| byte == b'\n' || byte == b'\r').count();
    if let Some(array) = one_line(read_array(bytes, "bowl.csv")) {
        assert!(array.len() <= rows, "{} transducers of {rows} rows", array.len());
        assert!(array.positions().iter().flatten().all(|x| x.is_finite()), "{:?}", array.positions());
    }
    if let Some(drive) = one_line(read_drive(bytes, "drive.csv")) {
        assert!(drive.len() <= rows, "{} transducers of {rows} rows", drive.len());
        assert!(drive.iter().all(|q| q.norm() <= 1.0 + 1e-5), "{drive:?}");
        let again = one_line(read_drive(write_drive(None, &drive).as_bytes(), "drive.csv")).expect("a drive");
        let off = drive.iter().zip(&again).map(|(a, b)| (a - b).norm()).fold(0.0, f32::max);
        assert!(drive.len() == again.len() && off < 1e-5, "off by {off}: {drive:?}");
    }
}
