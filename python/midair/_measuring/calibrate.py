"""`midair.calibrate`: responses of an array from readings of microphones."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._midair import Array, Scene, memory_limit, numbers, stated
from .._support.arguments import SMALLEST, callback, number, refused, sized, warn, whole
from .fit import LOUDNESS, Complex, Fitted, Model, Priors, Real, fit, robust
from .result import Calibration

#: Readings are rejected as clipped if at least 4 readings of a microphone, and 1 % of all, equal its maximum.
CLIPPED, CLIPPED_PART = 4, 0.01


def drives_of(value: Any, transducers: int) -> Complex:
    """Return drives (K, N) as complex128; rejects |q| > 1."""
    cure = f"give drives (K, {transducers}), as midair.calibration_drives makes them"
    found = numbers("drives", value, [(-1, transducers)], cure, kinds="iufc", most=1 + 1e-5)
    if not found.any():
        raise stated("drives", "are all 0", "nothing was played, give what was")
    return found.astype(np.complex128)


def readings_of(value: Any, drives: int, microphones: int, phased: bool | None) -> Real | Complex:
    """Check readings (K, M) in Pa: moduli, or complex if `phased`; None decides by their type."""
    shapes = [(drives, microphones), (drives,)][: 2 if microphones == 1 else 1]
    cure = f"give |p| or p ({drives}, {microphones}), a row for each drive and a column for each microphone"
    found = sized("readings", numbers("readings", value, shapes, cure, kinds="iufc")).reshape(drives, microphones)
    if phased and not np.iscomplexobj(found):
        cure = "give complex ones, or leave complex out"
        raise stated("readings", "are real, but complex=True", cure, code="conflict")
    if phased is False:
        found = np.abs(found)
    if not np.iscomplexobj(found) and found.min() < 0:
        k, at = np.unravel_index(int(found.argmin()), found.shape)
        cure = "|p| is never negative, give moduli or complex ones"
        raise stated(f"readings[{k}, {at}]", f"is {found[k, at]:.4g}", cure)
    for m, received in enumerate(found.T):
        if np.abs(received).max() < SMALLEST:
            cure = f"microphone {m} hears nothing, mend it or leave it out"
            raise stated(f"readings[:, {m}]", "are all 0", cure)
        _not_clipped(received, m)
    return found


def _not_clipped(received: NDArray[Any], m: int) -> None:
    parts = (received.real, received.imag) if np.iscomplexobj(received) else (received,)
    for part in parts:
        top = np.abs(part).max()
        many = int(np.sum(np.abs(part) > top * (1 - 1e-6)))
        if many >= max(CLIPPED, CLIPPED_PART * len(part)):
            reason = f"{many} of {len(part)} are {top:.4g} Pa, the largest value"
            cure = f"{reason}; measure at a lower intensity or farther away"
            raise stated(f"readings[:, {m}]", "are clipped", cure)


def indices_of(value: Any, transducers: int) -> NDArray[np.intp]:
    """Check the second board's transducers (a slice, indices or a mask); return their indices."""
    if value is None:
        return np.zeros(0, np.intp)
    cure = f"give a slice, indices below {transducers} or a mask ({transducers},) of some of the transducers"
    try:
        if not isinstance(value, slice):
            value = numbers("second_board", value, [(-1,)], cure, kinds="iub", copy=False)
        found = np.arange(transducers)[value]
    except (IndexError, TypeError):
        raise refused("second_board", value, cure) from None
    found = np.unique(found)
    if not 3 <= len(found) < transducers:
        raise refused("second_board", value, cure)
    return found


#: Number of phases of calibration drives for an array without quantized phases.
PHASES = 256
#: Largest number of values in calibration drives: more would take too long.
MOST = 100_000_000


def calibration_drives(
    array: Array | Scene, readings_per_transducer: float = 4.0, *, microphones: int = 4, seed: int = 0
) -> NDArray[np.complex64]:
    """Make drives for `midair.calibrate`: full drive, random phases of the board for each channel.

    Parameters
    ----------
    array : midair.Array or midair.Scene
        N transducers; masked ones stay off.
    readings_per_transducer : float, optional
        Number of readings for each transducer; 4 of |p|, or 2 complex ones, are enough.
    microphones : int, optional
        Number of microphones.
    seed : int, optional
        Seed of the phases.

    Returns
    -------
    (K, N) ndarray of complex64
        The drives. All transducers play in each, which gives sqrt(N) times more information on each than
        one at a time with the same noise.

    Raises
    ------
    SceneError
        For numbers that are not above 0 and an array whose transducers are all masked.

    Examples
    --------
    >>> import midair
    >>> midair.calibration_drives(midair.Array.grid(16, 16, 10e-3)).shape
    (256, 256)
    """
    array = array.array if isinstance(array, Scene) else array
    if not isinstance(array, Array):
        raise refused("array", array, "give a midair.Array or a midair.Scene")
    wanted = number("readings_per_transducer", readings_per_transducer, above=0)
    listening, seed = whole("microphones", microphones, least=1), whole("seed", seed, least=0)
    played = np.flatnonzero(array.mask)
    if not len(played):
        raise stated("array", "is masked as a whole", "unmask the transducers to be measured")
    count = int(np.ceil(wanted * len(played) / listening))
    if count * len(array) > MOST:
        cure = f"that makes {count} drives of {len(array)} transducers, give less"
        raise refused("readings_per_transducer", readings_per_transducer, cure)
    quantization = array.quantization or {}
    phases = int(quantization.get("phases") or PHASES)
    channels = played if array.channels is None else array.channels[played]
    driven, members = np.unique(channels, return_inverse=True)
    codes = np.random.default_rng(seed).integers(0, phases, (count, len(driven)))
    drives = np.zeros((count, len(array)), np.complex64)
    drives[:, played] = np.exp(2j * np.pi * codes / phases)[:, members]
    return drives


#: A transducer is reported as dead if its probability of being dead exceeds DEAD_CHANCE. It is also reported
#: if it is more probably dead than alive, and its gain is SURELY standard deviations below QUIET times the
#: median.
DEAD_CHANCE, QUIET, SURELY = 0.99, 0.5, 4
#: A transducer whose phase is off by more than this, in rad, counts as connected with reversed polarity.
REVERSED = np.radians(115)
#: Readings that differ from the model by more than this factor are probably not in Pa.
FACTOR = 2.0
#: Readings whose residual exceeds this fraction of their rms are probably of another array.
UNEXPLAINED = 0.35
#: Largest standard deviation of the prior, relative to the mean modulus. Such a prior already contains no
#: information; a wider one only increases rounding errors.
MOST_PRIOR = 10
#: Largest number of outlying readings that a warning names.
NAMED = 3
#: Memory of the fit, in multiples of one normal matrix: that matrix and those derived from it.
COPIES = 6


def calibrate(
    scene_or_array: Scene | Array,
    drives: ArrayLike,
    readings: ArrayLike,
    *,
    microphones: ArrayLike | None = None,
    complex: bool | None = None,
    noise: float | None = None,
    prior: float | None = None,
    sound_speed_error: float = 10.0,
    microphones_error: float | None = None,
    second_board: Any = None,
    pose_error: tuple[float, float] = (2e-3, 0.03),
    progress: Callable[[int, int], object] | None = None,
) -> Calibration:
    """Fit the responses of the transducers and the sound speed to readings of known drives.

    Parameters
    ----------
    scene_or_array : midair.Scene or midair.Array
        N transducers with their nominal values; the points of a scene are the microphones.
    drives : (K, N) array_like
        The played drives: `midair.calibration_drives`.
    readings : (K, M) array_like
        Peak pressures in Pa: |p|, or complex ones (e^{-jwt}, a clock shared with the array).
    microphones : (M, 3) array_like, optional
        Places in m; by default the scene's points.
    complex : bool, optional
        True requires complex readings, False takes moduli; by default the type of the readings decides.
    noise : float, optional
        Standard deviation of a reading in Pa, as a lower bound; the fit finds the noise.
    prior : float, optional
        Spread of re and im of a living response about the array's, relative to their mean modulus; by
        default it is fitted.
    sound_speed_error : float, optional
        Error of the sound speed in m/s; 0 fixes it.
    microphones_error : float, optional
        Error of each coordinate of a microphone in m; by default it is fitted, from 1 mm on; 0 fixes it.
    second_board : slice, indices or mask, optional
        The transducers of a board with an unknown pose.
    pose_error : (float, float), optional
        Error of that pose, in m and rad.
    progress : callable, optional
        Called with (step, steps).

    Returns
    -------
    midair.Calibration
        Responses, sound speed and places, with their errors, and the corrected scene.

    Raises
    ------
    SceneError
        For impossible readings and other wrong arguments.

    See Also
    --------
    midair.calibration_drives : drives to play.

    midair.doctor : faults of a board.

    Notes
    -----
    Least squares by Levenberg-Marquardt from the array's values. All errors are standard deviations. The
    readings first have an assumed error of 30 % of their root mean square; each step reduces it by .6, down
    to their noise (docs/measuring.md). The fit drops readings off the model by more than six times the
    scatter of all; a warning and `outlying` name them. The directivity's one number is fitted, too: an
    exponent of the cosine for "point" and "cos", the size of a piston or strip. Any number of readings is
    enough: the fewer they are, the more the prior decides, as `prior_share` reports.

    Examples
    --------
    >>> import midair
    >>> array = midair.Array.grid(4, 4, 10e-3)
    >>> scene = midair.Scene(array, [[0, 0, 0.1], [0.02, 0.03, 0.12]])
    >>> pressures = scene.propagation().copy()
    >>> pressures[:, 5] *= 0.5
    >>> drives = midair.calibration_drives(array, 8, microphones=2)
    >>> found = midair.calibrate(scene, drives, abs(drives @ pressures.T))
    >>> round(float(found.gain[5]), 3)
    0.5
    """
    given = scene_or_array
    if not isinstance(given, Array | Scene):
        raise refused("scene_or_array", given, "give a midair.Scene or a midair.Array")
    callback(progress, "step, steps")
    scene = _scene(given, microphones)
    array = scene.array
    places = scene.points if microphones is None else places_of(microphones)
    played = drives_of(drives, len(array))
    received = readings_of(readings, len(played), len(places), complex)
    least = number("noise", noise, least=0) if noise is not None else 0.0
    spread = number("prior", prior, above=0) if prior is not None else None
    if spread is not None and spread > MOST_PRIOR:
        raise refused("prior", prior, f"give at most {MOST_PRIOR}, or leave it out to have it learnt")
    second = indices_of(second_board, len(array))
    speed_error = number("sound_speed_error", sound_speed_error, least=0)
    if microphones_error is not None:
        microphones_error = number("microphones_error", microphones_error, least=0)
    priors = Priors(speed_error, microphones_error, _pose(pose_error))
    model = Model(scene, places, second, priors, np.iscomplexobj(received))
    _room(len(array), len(model.free), received.size)
    own = np.ones(len(array)) if array.response is None else np.abs(array.response)
    believed = np.asarray(own * array.mask, np.float64)
    if not believed[np.any(played, axis=0)].any():
        cure = "its mask or responses of 0 hold them all off"
        raise stated("array", "has no transducer that was played", cure)
    played = played * array.mask
    found = robust(partial(fit, model, played, received, believed, spread, least, progress or (lambda *_: 0)), received)
    return _result(scene, model, found, believed, played, received)


def _scene(given: Scene | Array, microphones: ArrayLike | None) -> Scene:
    if isinstance(given, Scene):
        return given
    if microphones is None:
        cure = "give their places (M, 3) in m, or a scene whose points they are"
        raise stated("microphones", "are left out", cure, code="missing")
    return Scene(given, places_of(microphones))


def places_of(value: ArrayLike) -> NDArray[np.float64]:
    """Check the places of microphones; return them as (M, 3) in m."""
    return numbers("microphones", value, [(3,), (-1, 3)], "give their places (M, 3) in m").reshape(-1, 3)


def _pose(value: Any) -> tuple[float, float]:
    try:
        shift, turn = value
    except (TypeError, ValueError):
        raise refused("pose_error", value, "give two standard deviations, in m and rad") from None
    return number("pose_error[0]", shift, least=0), number("pose_error[1]", turn, least=0)


def _independent(received: Any, played: Complex, array: Array) -> int:
    """Return the number of independent real numbers in the readings.

    If an array has C channels, a microphone gives at most C complex pressures, whatever the drives; |p| does
    not contain their common phase.
    """
    real = 2 if np.iscomplexobj(received) else 1
    if array.channels is None:
        return int(received.size * real)
    driven = len(np.unique(array.channels[np.any(played, axis=0)]))
    return int(min(received.size * real, (2 * driven + real - 2) * received.shape[1]))


def _room(transducers: int, others: int, readings: int) -> None:
    size, most = 8 * (2 * transducers + others) ** 2 * COPIES, memory_limit()
    if size > most:
        raise MemoryError(
            f"a fit of {transducers} transducers to {readings} readings needs {size * 1e-9:.3f} GB, "
            f"the limit is {most * 1e-9:.3f} GB: calibrate each board as an array of its own, "
            "or give a higher limit (MIDAIR_MEMORY in the environment)"
        )


def _result(scene: Scene, model: Model, found: Fitted, believed: Real, played: Complex, received: Any) -> Calibration:
    # A common phase of all responses cannot be determined; it is chosen to agree with the array's own
    # responses.
    common, scale = np.sum(believed * found.responses), float(np.exp(found.state[LOUDNESS]))
    response = found.responses * (scale * np.conj(common) / abs(common)) * model.phases
    sounding = np.any(played, axis=0)
    loudness = float(np.abs(response[sounding]).mean() / max(believed[sounding].mean(), 1e-30))
    if not 1 / FACTOR < loudness < FACTOR:
        warn(
            f"readings are {loudness:.3g} times as loud as the array's source_pressure says: "
            "give peak pressures in Pa, or the responses mean only ratios"
        )
    outlying = np.argwhere(~found.used)
    if len(outlying):
        named = ", ".join(f"drive {k} at microphone {m}" for k, m in outlying[:NAMED].tolist())
        more = ", ..." if len(outlying) > NAMED else ""
        warn(f"{len(outlying)} of {found.used.size} readings lie far off the model and are left out: {named}{more}")
    loud = float(np.sqrt(np.mean(np.abs(received[found.used]) ** 2)))
    if found.noise > UNEXPLAINED * loud:
        warn(
            f"readings are off the model by {found.noise / loud:.0%} of their root mean square: "
            "check the places of the microphones, and that drives and readings are in one order"
        )
    numbers = _independent(received, played, scene.array)
    if numbers < sounding.sum():
        share = found.prior_share[sounding].mean()
        warn(
            f"readings have {numbers} independent numbers for {sounding.sum()} transducers: the prior decides"
            f" {share:.0%} of the responses; give more drives, or more places where channels are shared"
        )
    gain, error = np.abs(response), found.responses_error * scale
    quiet = (found.chances[1] > 0.5) & (gain + SURELY * error < QUIET * np.median(gain[sounding]))
    dead = np.flatnonzero(sounding & (quiet | (found.chances[1] > DEAD_CHANCE)))
    off = np.abs(np.angle(response * np.conj(model.phases)))
    # With few readings the estimates are uncertain by more than their prior says.
    turned = (off > REVERSED) & (found.chances[2] > 0.5) & (found.prior_share < 0.5)
    reversed_ = np.setdiff1d(np.flatnonzero(sounding & turned), dead)
    response[dead] = 0
    # Transducers that did not play keep the responses that the array has.
    response = np.where(sounding, response, 1.0 if scene.array.response is None else scene.array.response)
    array = model.array(found.state, response)
    state, errors = found.state, found.state_error
    return Calibration(
        response=response,
        response_error=error,
        prior_share=found.prior_share,
        dead=dead,
        reversed=reversed_,
        sound_speed=float(state[0]),
        sound_speed_error=float(errors[0]),
        microphones=model.microphones(state),
        microphones_error=model.microphones(errors),
        pose=state[-6:],
        pose_error=errors[-6:],
        noise=found.noise,
        residuals=found.residuals,
        outlying=outlying,
        scene=scene.replace(array=array, sound_speed=float(state[0])),
    )
