//! The argument `quantization`: conversion from Python and back.

use midair::Quantization;

use crate::prelude::*;

const KEYS: [&str; 3] = ["phases", "amplitudes", "pulses"];

/// Reads a table such as `{"phases": 256, "amplitudes": [0, 0.5, 1]}`; a key that is missing or None is continuous.
pub(crate) fn read_quantization(value: &Bound<'_, PyAny>) -> PyResult<Quantization> {
    let Ok(table) = value.cast::<PyDict>() else {
        let cure = "give a dictionary such as {\"phases\": 256, \"amplitudes\": [0, 0.5, 1]}";
        return Err(invalid("quantization", &quoted(value), cure));
    };
    let (mut phases, mut amplitudes, mut ticks) = (None, None, None);
    for (key, value) in table {
        match key.extract::<String>().as_deref() {
            Ok("phases" | "amplitudes" | "pulses") if value.is_none() => {}
            Ok("phases") => {
                let count = read::count("array.quantization.phases", &value)?;
                phases = Some(u32::try_from(count).unwrap_or(u32::MAX));
            }
            Ok("amplitudes") => amplitudes = Some(read::reals("array.quantization.amplitudes", &value)?),
            Ok("pulses") => ticks = Some(read::reals("array.quantization.pulses", &value)?),
            _ => {
                let name = key.extract().unwrap_or_else(|_| quoted(&key));
                return Err(refused(midair::Error::unknown("key of quantization", name, KEYS)));
            }
        }
    }
    match ticks {
        None => Quantization::new(phases, amplitudes),
        Some(ticks) => Quantization::of_pulses(&ticks).and_then(|board| board.agreeing(phases, amplitudes.as_deref())),
    }
    .map_err(refused)
}

/// Returns a quantization as a dict.
pub(crate) fn object<'py>(py: Python<'py>, quantization: &Quantization) -> PyResult<Bound<'py, PyDict>> {
    let table = PyDict::new(py);
    table.set_item("phases", quantization.phases())?;
    table.set_item("amplitudes", quantization.amplitudes().map(|table| give::list(py, table.to_vec())))?;
    if let Some(ticks) = quantization.ticks() {
        table.set_item("pulses", give::list(py, ticks.to_vec()))?;
    }
    Ok(table)
}
