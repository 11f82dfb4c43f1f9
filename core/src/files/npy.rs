//! Files .npy of NumPy: an array of f64 or f32 in C order, little-endian.

use crate::prelude::*;

/// The numbers of a file and their shape.
pub(super) struct Npy {
    pub(super) shape: Vec<usize>,
    pub(super) numbers: Vec<f64>,
}

/// Reads a file as `numpy.save` writes it; `None` for other files, the cure for one that cannot be read.
pub(super) fn read(bytes: &[u8]) -> Option<Result<Npy, String>> {
    let rest = bytes.strip_prefix(b"\x93NUMPY")?;
    let split = || {
        let (size, start) = match rest.first()? {
            1 => (u16::from_le_bytes(*rest.get(2..)?.first_chunk()?).into(), 4),
            _ => (u32::from_le_bytes(*rest.get(2..)?.first_chunk()?) as usize, 6),
        };
        let (header, values) = rest.get(start..)?.split_at_checked(size)?;
        Some((core::str::from_utf8(header).ok()?, values))
    };
    Some(
        split()
            .ok_or_else(|| "its header is damaged: save it again".into())
            .and_then(|(header, values)| array(header, values)),
    )
}

fn array(header: &str, values: &[u8]) -> Result<Npy, String> {
    let of = |key: &str, end: char| Some(header.split_once(key)?.1.trim_start().split_once(end)?.0);
    let text = of("'shape':", ')').unwrap_or_default().trim_start_matches('(');
    let shape: Vec<usize> = text.split(',').filter_map(|size| size.trim().parse().ok()).collect();
    let numbers: Vec<f64> = match (of("'descr':", ','), of("'fortran_order':", ',')) {
        (Some("'<f8'"), Some("False")) => values.as_chunks().0.iter().map(|&x| f64::from_le_bytes(x)).collect(),
        (Some("'<f4'"), Some("False")) => values.as_chunks().0.iter().map(|&x| f32::from_le_bytes(x).into()).collect(),
        _ => {
            return Err(
                "its numbers are of another type or order: save numpy.ascontiguousarray(points, \"<f8\")".into()
            );
        }
    };
    if shape.iter().try_fold(1, |product: usize, &size| product.checked_mul(size)) != Some(numbers.len()) {
        return Err(alloc::format!(
            "its shape is ({text}), but it has {} numbers: give points as numpy.save writes them",
            numbers.len()
        ));
    }
    Ok(Npy { shape, numbers })
}
