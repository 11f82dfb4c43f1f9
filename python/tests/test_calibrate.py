"""Calibration, tested on arrays and air whose properties the fit does not know."""

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair
from microphones import BELIEVED, TRUE_SPEED, Rig
from midair._measuring.fit import _inverse_diagonal

#: Enough transducers where only files and bits count.
SMALL = midair.Array.grid(8, 8, 10e-3)


def calibrated(rig: Rig, readings: float, decibels: float, phased: bool = False, **keywords: Any) -> midair.Calibration:
    drives = midair.calibration_drives(rig.array, readings, microphones=rig.microphones, seed=rig.seed)
    received = rig.read(drives, decibels, phased)
    return midair.calibrate(rig.array, drives, received, microphones=rig.places, **keywords)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [11, 12])
@pytest.mark.parametrize(("radius", "decibels", "least"), [(0.0, 40, 0.98), (0.0, 60, 0.99), (4.5e-3, 60, 0.98)])
def test_four_readings_give_the_array(seed: int, radius: float, decibels: float, least: float) -> None:
    rig = Rig(seed, radius=radius)
    assert rig.kept(rig.array, BELIEVED) < 0.95
    found = calibrated(rig, 4, decibels)
    assert rig.kept(found.array, found.sound_speed) > least
    assert found.dead.tolist() == rig.dead.tolist()
    assert abs(found.sound_speed - TRUE_SPEED) < (3 if decibels == 40 else 1)
    assert found.response[found.dead].tolist() == [0] * len(found.dead)


@pytest.mark.slow
def test_fewer_readings_one_microphone_and_phases() -> None:
    rig = Rig(13)
    found = calibrated(rig, 2, 60)
    assert rig.kept(found.array, found.sound_speed) > 0.965
    found = calibrated(rig, 2, 40, phased=True)
    assert rig.kept(found.array, found.sound_speed) > 0.985
    assert abs(found.sound_speed - TRUE_SPEED) < 1
    rig = Rig(13, microphones=1)
    found = calibrated(rig, 4, 60)
    assert rig.kept(found.array, found.sound_speed) > 0.98


@pytest.mark.slow
def test_a_bad_array_is_found_without_a_prior() -> None:
    rig = Rig(14, gain=0.2, phase=40, dead_part=0.05, reversed_part=0.05)
    found = calibrated(rig, 4, 60)
    assert rig.kept(found.array, found.sound_speed) > 0.98
    assert found.dead.tolist() == rig.dead.tolist()
    right = np.intersect1d(found.reversed, rig.reversed)
    assert len(right) >= 0.7 * len(rig.reversed)


@pytest.mark.slow
def test_errors_are_what_they_say() -> None:
    rig = Rig(15, jitter=0.0, dead_part=0.0)
    found = calibrated(rig, 6, 50)
    off = np.vdot(found.response, rig.response)
    ratio = (found.response - rig.response * abs(off) / off) / found.response_error
    assert 0.6 < np.sqrt(np.mean(np.abs(ratio) ** 2) / 2) < 1.6
    assert abs(found.sound_speed - TRUE_SPEED) < 5 * found.sound_speed_error
    expected = rig.level() * 10 ** (-50 / 20)
    assert 0.7 * expected < found.noise < 1.5 * expected
    assert np.sqrt(np.mean(found.residuals**2)) < found.noise


@pytest.mark.slow
def test_microphones_out_of_place_are_found() -> None:
    rig = Rig(16, jitter=0.1e-3)
    true = rig.places.copy()
    drives = midair.calibration_drives(rig.array, 6)
    received = rig.read(drives, 60)
    off = true + np.random.default_rng(1).normal(0, 1e-3, true.shape)
    found = midair.calibrate(rig.array, drives, received, microphones=off, microphones_error=1e-3)
    assert np.abs(found.microphones - true).max() < 0.6 * np.abs(off - true).max()
    assert rig.kept(found.array, found.sound_speed) > 0.985


@pytest.mark.slow
def test_the_pose_of_a_second_board_is_found() -> None:
    rig = Rig(17, jitter=0.05e-3, dead_part=0.0)
    second = slice(128, 256)
    believed = rig.array.positions.copy()
    rig.positions[second] += [0.8e-3, -0.5e-3, 1.2e-3]
    drives = midair.calibration_drives(rig.array, 6)
    found = midair.calibrate(rig.array, drives, rig.read(drives, 60), microphones=rig.places, second_board=second)
    assert np.abs(found.pose[:3] - [0.8e-3, -0.5e-3, 1.2e-3]).max() < 0.4e-3
    assert rig.kept(found.array, found.sound_speed) > 0.98
    assert np.array_equal(found.array.positions[:128], believed[:128])


@pytest.mark.slow
def test_readings_of_another_order_are_reported() -> None:
    rig = Rig(22)
    drives = midair.calibration_drives(rig.array, 4)
    received = rig.read(drives, 60)[::-1]
    with pytest.warns(midair.SceneWarning, match="readings are off the model by"):
        midair.calibrate(rig.array, drives, received, microphones=rig.places)
    with pytest.warns(midair.SceneWarning, match="times as loud as"):
        midair.calibrate(rig.array, drives, 10 * received[::-1], microphones=rig.places)
    off = midair.Array(rig.array.positions, mask=np.zeros(256, bool))
    with pytest.raises(midair.SceneError, match="array has no transducer that was played"):
        midair.calibrate(off, drives, received, microphones=rig.places)


@pytest.mark.slow
def test_same_readings_same_bits() -> None:
    rig = Rig(18, array=SMALL)
    drives = midair.calibration_drives(rig.array, 2)
    received = rig.read(drives, 60)
    first, again = (midair.calibrate(rig.array, drives, received, microphones=rig.places) for _ in range(2))
    assert first.response.tobytes() == again.response.tobytes()


@pytest.mark.slow
def test_files_keep_it(tmp_path: Path) -> None:
    rig = Rig(19, array=SMALL)
    found = calibrated(rig, 2, 60)
    found.save(tmp_path / "found.npz")
    again = midair.Calibration.load(tmp_path / "found.npz")
    assert again.scene == found.scene
    assert again.sound_speed == found.sound_speed
    assert np.array_equal(again.residuals, found.residuals)
    found.save(tmp_path / "found.toml")
    assert midair.Scene.load(tmp_path / "found.toml").array == found.array
    assert len(found.plot().axes) >= 3
    (tmp_path / "half.npz").write_bytes((tmp_path / "found.npz").read_bytes()[:500])
    with pytest.raises(midair.SceneError, match="damaged, or none"):
        midair.Calibration.load(tmp_path / "half.npz")


def test_drives_are_the_boards() -> None:
    array = midair.Array.preset("sonicsurface", mask=[True] * 250 + [False] * 6)
    drives = midair.calibration_drives(array, 2, microphones=2, seed=3)
    assert drives.shape == (250, 256)
    codes = np.angle(drives[:, :250]) * 32 / (2 * np.pi)
    assert np.abs(codes - codes.round()).max() < 1e-4
    assert not drives[:, 250:].any()
    assert np.array_equal(drives, midair.calibration_drives(array, 2, microphones=2, seed=3))


@pytest.mark.slow
def test_transducers_that_did_not_play_keep_their_responses() -> None:
    own, mask = np.exp(1j * np.linspace(0, 1, 64)), np.arange(64) % 8 > 0
    rig = Rig(21, array=midair.Array.grid(8, 8, 10e-3, mask=mask, response=own))
    found = calibrated(rig, 4, 60)
    assert found.array.response is not None
    np.testing.assert_allclose(found.array.response[~mask], own[~mask], rtol=1e-12)
    assert not np.isclose(found.array.response[mask], own[mask], rtol=1e-3).any()


def spoilt(kind: str, received: Any) -> Any:
    received = received.copy()
    if kind == "nan":
        received[3, 1] = np.nan
    elif kind == "shape":
        received = received.T
    elif kind == "clipped":
        received = np.minimum(received, np.quantile(received, 0.9))
    elif kind == "negative":
        received[2, 0] = -1
    elif kind == "deaf":
        received[:, 2] = 0
    return received


@pytest.mark.parametrize(
    ("kind", "reported"),
    [
        ("nan", r"readings\[3, 1\] is nan: give finite numbers"),
        ("shape", r"readings is of shape \(4, 128\): give \|p\| or p \(128, 4\)"),
        ("clipped", r"readings\[:, 0\] are clipped"),
        ("negative", r"readings\[2, 0\] is -1"),
        ("deaf", "microphone 2 hears nothing"),
    ],
)
def test_what_are_no_readings_is_refused(kind: str, reported: str) -> None:
    rig = Rig(20)
    drives = midair.calibration_drives(rig.array, 2)
    received = spoilt(kind, rig.read(drives, 60))
    with pytest.raises(midair.SceneError, match=reported) as refusal:
        midair.calibrate(rig.array, drives, received, microphones=rig.places)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(
    ("keywords", "reported"),
    [
        ({"microphones": None}, "microphones are left out"),
        ({"microphones": [0, 0]}, "microphones is"),
        ({"prior": 0}, "prior is 0: give a number above 0"),
        ({"noise": -1.0}, "noise is -1.0"),
        ({"second_board": slice(0, 256)}, "second_board is"),
        ({"complex": True}, "readings are real, but complex=True"),
        ({"pose_error": 1}, "pose_error is 1"),
    ],
)
def test_arguments_are_refused(keywords: dict[str, Any], reported: str) -> None:
    rig = Rig(20)
    drives = midair.calibration_drives(rig.array, 2)
    with pytest.raises(midair.SceneError, match=reported):
        midair.calibrate(rig.array, drives, rig.read(drives, 60), **({"microphones": rig.places} | keywords))


@pytest.mark.slow
def test_memory_is_requested_before_it_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = Rig(20)
    drives = midair.calibration_drives(rig.array, 2)
    received = rig.read(drives, 60)
    # 6 matrices of 515 x 515 numbers of 8 bytes are 0.013 GB.
    for given, reported in [("12MB", "0.012"), ("1e3", "0.000"), (" 2 kb ", "0.000"), ("0", "0.000")]:
        monkeypatch.setenv("MIDAIR_MEMORY", given)
        with pytest.raises(MemoryError, match=rf"needs 0\.013 GB, the limit is {reported} GB: .*MIDAIR_MEMORY"):
            midair.calibrate(rig.array, drives, received, microphones=rig.places)
    for given in ("lots", "-1", "nan", "1 PB", "MB"):
        monkeypatch.setenv("MIDAIR_MEMORY", given)
        with pytest.raises(midair.SceneError, match=f'^MIDAIR_MEMORY is "{given}": give bytes, such as 2e9'):
            midair.calibrate(rig.array, drives, received, microphones=rig.places)
    for given in ("14MB", ""):
        monkeypatch.setenv("MIDAIR_MEMORY", given)
        midair.calibrate(rig.array, drives, received, microphones=rig.places)


def test_the_diagonal_of_an_inverse() -> None:
    for size in (1, 2, 65, 301):
        rows = np.random.default_rng(size).normal(size=(2 * size, size))
        square = rows.T @ rows + np.eye(size)
        assert np.allclose(_inverse_diagonal(square), np.diag(np.linalg.inv(square)), rtol=1e-12)


@pytest.mark.slow
def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from midair._cli import main

    rig = Rig(21, array=SMALL)
    drives = midair.calibration_drives(rig.array, 2)
    believed = midair.Scene(rig.array, rig.new)
    kept = {
        "drives": drives,
        "readings": rig.read(drives, 60),
        "microphones": rig.places,
        "scene": believed.json(),
    }
    np.savez(tmp_path / "readings.npz", **kept)
    picture = tmp_path / "found.png"
    with pytest.raises(SystemExit) as end:
        main(
            [
                "calibrate",
                str(tmp_path / "readings.npz"),
                "-o",
                str(tmp_path / "array.toml"),
                "--image",
                str(picture),
            ]
        )
    assert end.value.code == 0
    assert "64 transducers" in capsys.readouterr().out
    assert picture.stat().st_size > 10_000
    found = midair.Scene.load(tmp_path / "array.toml")
    assert rig.kept(found.array, found.sound_speed) > 0.96
    del kept["readings"]
    np.savez(tmp_path / "readings.npz", **kept)
    with pytest.raises(SystemExit) as end:
        main(["calibrate", str(tmp_path / "readings.npz"), "-o", str(tmp_path / "array.toml")])
    assert end.value.code == 2
    assert "has no readings: save" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize("phased", [pytest.param(False, marks=pytest.mark.long), True])
def test_few_readings_are_no_worse_than_the_model(phased: bool) -> None:
    for count, least in [(1, 0.95), (32, 1.02 if phased else 0.95)]:
        gains = []
        for seed in (1, 2, 3):
            rig = Rig(seed, dead_part=0)
            drives = midair.calibration_drives(rig.array, 4, seed=seed)[:count]
            readings = rig.read(drives, 40, phased)
            few = readings.size * (1 + phased) < 256
            with pytest.warns(midair.SceneWarning, match="the prior decides") if few else nullcontext():
                found = midair.calibrate(rig.array, drives, readings, microphones=rig.places)
            gains.append(rig.kept(found.array, found.sound_speed) / rig.kept(rig.array, BELIEVED))
            assert len(found.dead) == len(found.reversed) == 0
        assert np.mean(gains) > least


def test_the_prior_share_is_that_of_bayesian_regression() -> None:
    """Compares with the posterior of a linear model with loudness and clock, in closed form."""
    rng = np.random.default_rng(5)
    array = midair.Array.grid(4, 4, 10e-3, directivity="t4010a1")
    places, prior, noise = np.array([[0.01, 0.02, 0.1]]), 0.1, 2.0
    truth = 1 + prior * (rng.normal(size=16) + 1j * rng.normal(size=16))
    drives = midair.calibration_drives(array, 4, microphones=1)[:6]
    each = drives * midair.Scene(array, places).propagation()
    readings = each @ truth + noise / np.sqrt(2) * (rng.normal(size=6) + 1j * rng.normal(size=6))
    with pytest.warns(midair.SceneWarning, match="12 independent numbers for 16 transducers: the prior"):
        found = midair.calibrate(
            array, drives, readings[:, None], microphones=places,
            noise=noise, prior=prior, sound_speed_error=0, microphones_error=0,
        )  # fmt: skip
    p = (each @ found.response)[:, None]
    rows = np.hstack([prior * each, 1j * prior * each, 10 * p, 10j * p])
    rows = np.concatenate([rows.real, rows.imag])
    left = np.diag(np.linalg.inv(rows.T @ rows / found.noise**2 + np.eye(34)))
    assert found.prior_share == pytest.approx((left[:16] + left[16:32]) / 2, abs=0.02)
    assert 0.5 < found.prior_share.mean() < 0.8
    # With few readings, the error of a gain is not 0.
    assert f"gain {found.gain.mean():.3g} +- {found.gain_error.mean():.2g}," in repr(found)
    assert found.gain_error.mean() > 0.01


@pytest.mark.slow
def test_a_wired_array_is_calibrated_by_its_channels() -> None:
    """Checks six channels of four transducers: their response must predict drives that were never played."""
    rng = np.random.default_rng(15)
    rows = np.arange(24) // 4
    response = (1 + 0.1 * rng.standard_normal(24)) * np.exp(0.3j * rng.standard_normal(24))
    believed, real = (midair.Array.grid(4, 6, 10.5e-3, channels=rows, response=own) for own in (None, response))
    places = rng.uniform([-0.03, -0.03, 0.06], [0.03, 0.03, 0.12], (5, 3))
    drives = midair.calibration_drives(believed, 8, microphones=5)
    assert drives.shape == (39, 24)
    assert (drives == drives[:, 4 * rows]).all()

    def received(array: midair.Array, played: Any) -> Any:
        scene = midair.Scene(array, places)
        return np.abs([midair.field(scene, drive, places).pressure for drive in played])

    readings = received(real, drives) * (1 + 2e-3 * rng.standard_normal((39, 5)))
    found = midair.calibrate(believed, drives, readings, microphones=places, sound_speed_error=0, microphones_error=0)
    others = midair.calibration_drives(believed, 8, microphones=5, seed=1)
    truth = received(real, others)
    before, after = (np.sqrt(np.mean((received(array, others) - truth) ** 2)) for array in (believed, found.array))
    assert after < 0.1 * before
    with pytest.warns(midair.SceneWarning, match="readings have 22 independent numbers for 24 transducers"):
        midair.calibrate(believed, drives, readings[:, :2], microphones=places[:2])
