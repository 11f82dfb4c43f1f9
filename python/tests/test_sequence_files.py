"""Sequences as values, files, tables and pictures."""

import copy
import os
import pickle
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import rc_context
from matplotlib.animation import FFMpegWriter
from matplotlib.figure import Figure
from PIL import Image

import midair
from scenes import same_bits

FRAMES = 24
ARRAY = midair.Array.grid(5, 5, pitch=0.01, mask=np.arange(25) != 3)


def points() -> np.ndarray[Any, Any]:
    angle = 2 * np.pi * (np.arange(FRAMES)[:, None] / FRAMES + np.arange(2) / 2)
    return np.stack([0.01 * np.cos(angle), 0.01 * np.sin(angle), np.full(angle.shape, 0.1)], axis=-1)


def made(**given: Any) -> midair.Sequence:
    """Returns two foci on a circle with 16 phases; the second is off for some frames, and both at the end."""
    targets = np.full((FRAMES, 2), 300.0)
    targets[8:12, 1], targets[-1] = 0, 0
    codes = np.random.default_rng(2).integers(0, 16, (FRAMES, 25))
    setting = {"drives": codes, "quantization": {"phases": 16, "amplitudes": [0, 1]}} | given
    names = {"rate": 2e3, "closed": True, "change": 0.4, "solver": "glide", "temperature": 25.0}
    return midair.Sequence(ARRAY, points(), targets, **(names | setting))


def plain() -> midair.Sequence:
    return made(drives=made().drives, quantization=None, closed=False, change=None)


@pytest.mark.parametrize("make", [made, plain])
def test_sequences_are_values_and_come_back_from_files_to_the_last_bit(make: Any, tmp_path: Path) -> None:
    sequence, path = make(), tmp_path / "motion.npz"
    sequence.save(path)
    assert [file.name for file in tmp_path.iterdir()] == ["motion.npz"]
    others = [midair.Sequence.load(path), pickle.loads(pickle.dumps(sequence)), copy.deepcopy(sequence)]
    for other in others:
        assert other == sequence
        for name in ("points", "targets", "drives", "pressures", "changes"):
            assert same_bits(getattr(other, name), getattr(sequence, name)), name
            assert not getattr(other, name)[:0].flags.writeable or name == "drives"
        assert repr(other) == repr(sequence)
        assert other.metrics == sequence.metrics
        assert other.array == ARRAY
    assert sequence != make(rate=1e3) if make is made else True
    assert sequence != (plain() if make is made else made())
    assert sequence != 3


def test_values_differ_by_any_part() -> None:
    drives = made().codes.copy()
    drives[3, 4] ^= 1
    for other in (
        {"rate": 1e3},
        {"closed": False},
        {"change": None},
        {"solver": ""},
        {"temperature": 20},
        {"drives": drives},
        {"quantization": {"phases": 32}},
    ):
        assert made(**other) != made(), other


def test_what_is_read_cannot_be_written_to_and_what_was_given_does_not_matter() -> None:
    drives = np.ones((FRAMES, 25), complex)
    sequence = made(drives=drives)
    before = sequence.drives.copy()
    drives[:] = 0
    assert same_bits(sequence.drives, before)
    for name in ("points", "targets", "drives", "pressures", "changes"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(sequence, name)[0] = 0


def test_a_damaged_file_is_refused_and_files_are_whole_or_not_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "motion.npz"
    made().save(path)
    whole = path.read_bytes()
    with np.load(path) as file:
        arrays = dict(file)
    for content in (b"", b"PK", whole[:200], whole[: len(whole) // 2], b"x" * 500):
        path.write_bytes(content)
        with pytest.raises(midair.SceneError, match="is damaged, or none"):
            midair.Sequence.load(path)
    np.savez(path, **arrays | {"setting": "{}"})
    with pytest.raises(midair.SceneError, match="is damaged, or none"):
        midair.Sequence.load(path)
    np.savez(path, **arrays | {"points": arrays["points"][:5]})
    with pytest.raises(midair.SceneError, match=r'file ".*motion.npz": '):
        midair.Sequence.load(path)
    with pytest.raises(FileNotFoundError):
        midair.Sequence.load(tmp_path / "none.npz")

    def broken(*_: Any, **__: Any) -> None:
        raise OSError(28, "No space left on device")

    path.write_bytes(whole)
    monkeypatch.setattr(np, "savez", broken)
    with pytest.raises(midair.SceneError, match="No space left"):
        made(rate=5.0).save(path)
    assert path.read_bytes() == whole
    assert [file.name for file in tmp_path.iterdir()] == ["motion.npz"]


def test_drives_are_a_table_of_frames(tmp_path: Path) -> None:
    sequence = made()
    sequence.save(tmp_path / "a.csv")
    midair.write(tmp_path / "b.csv", sequence)
    text = (tmp_path / "a.csv").read_text("utf-8")
    assert text == (tmp_path / "b.csv").read_text("utf-8")
    head, first, *rows = text.splitlines()
    assert head == "frame,index,x,y,z,amplitude,phase"
    assert first.startswith("0,0,-0.02,-0.02,0.0,")
    assert len(rows) == 25 * FRAMES - 1
    assert midair.read(tmp_path / "a.csv") == pytest.approx(sequence.drives, abs=1e-6)
    (tmp_path / "short.csv").write_text("\n".join(text.splitlines()[:-1]), "utf-8")
    with pytest.raises(midair.SceneError, match="rows are not all transducers"):
        midair.read(tmp_path / "short.csv")


def test_outputs_that_cannot_be_are_refused(tmp_path: Path) -> None:
    (tmp_path / "folder.npz").mkdir()
    for name, reported in (
        ("a.png", "no known ending"),
        ("folder.npz", "is a folder"),
        ("no/a.npz", "not there"),
    ):
        with pytest.raises(midair.SceneError, match=reported):
            made().save(tmp_path / name)
    with pytest.raises(midair.SceneError, match=r"no known ending: give .gif, .webp or .mp4"):
        made().animate(tmp_path / "a.png")
    with pytest.raises(midair.SceneError, match="frames is 0"):
        made().animate(tmp_path / "a.gif", frames=0)


@pytest.mark.slow
def test_to_xarray_names_dimensions_and_units() -> None:
    for sequence, name in ((made(), "codes"), (plain(), "drives")):
        table = sequence.to_xarray()
        assert table.sizes == {"time": FRAMES, "point": 2, "axis": 3, "transducer": 25}
        assert table[name].dims == ("time", "transducer")
        assert np.array_equal(table[name], getattr(sequence, name))
        assert np.array_equal(table.pressures, sequence.pressures)
        assert table.time.values == pytest.approx(np.arange(FRAMES) / 2e3)
        assert (table.pressures.units, table.time.units, table.points.units) == ("Pa", "s", "m")
        assert table.attrs["rate"] == 2e3
    assert made().to_xarray().codes.phases == 16


def test_without_xarray_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(midair.SceneError, match=r'to_xarray needs xarray: pip install "midair\[motion\]"'):
        made().to_xarray()


def test_plot_shows_pressures_changes_and_a_spectrum() -> None:
    sequence = made()
    figure = midair.plot(sequence)
    assert isinstance(figure, Figure)
    upper, middle, lower = figure.axes[:3]
    part = 100 * np.where(sequence.targets > 0, sequence.pressures / 300, np.nan)
    band = np.concatenate([path.vertices for path in upper.collections[0].get_paths()])
    times = 0.5 * (np.arange(FRAMES) + 0.5)
    for time, least, most in zip(times, np.fmin.reduce(part, axis=1), np.fmax.reduce(part, axis=1), strict=True):
        there = band[np.isclose(band[:, 0], time), 1]
        ends = [there.min(), there.max()] if len(there) else [np.nan] * 2
        assert ends == pytest.approx([least, most], nan_ok=True)
    changes = middle.lines[0].get_ydata()
    assert changes[1:] == pytest.approx(sequence.each_change(1, FRAMES).max(axis=1))
    assert "bound 0.4 rad" in [text.get_text() for text in middle.texts]
    assert upper.get_title(loc="left") == "all 2 points lie within the band"
    values = np.mean(sequence.radiation, axis=1)
    values[8:12], values[-1] = sequence.radiation[8:12, 0], 0
    frequencies, lines = np.asarray(lower.lines[0].get_data())
    assert frequencies == pytest.approx(np.arange(1, 13) * 2e3 / 24)
    assert lines[0] == pytest.approx(2 / 24 * abs(np.exp(2j * np.pi * np.arange(24) / 24) @ values))
    labels = [text for ax in figure.axes for text in (ax.get_xlabel(), ax.get_ylabel())]
    for label in ("time / ms", "frequency / Hz", "radiation pressure / Pa", "|p| / target, %"):
        assert label in labels
    assert "largest phase\nchange / rad" in labels
    for word in (
        "24 frames at 2000 Hz, 2 points, glide",
        "level",
        "from the last frame to the first",
        "noise",
    ):
        assert word in figure.get_suptitle()
    with pytest.raises(midair.SceneError, match="no vmax"):
        midair.plot(sequence, vmax=3.0)  # type: ignore[call-overload]


def test_a_picture_of_many_frames_shows_the_worst_of_each_group() -> None:
    frames, array = 2500, midair.Array.grid(20, 20, pitch=0.01)
    drives = np.ones((frames, 400), complex)
    drives[1234, 250] = -1
    place = np.broadcast_to([0, 0, 0.1], (frames, 1, 3))
    targets = np.full((frames, 1), 1.0)
    targets[777] = 2.0
    figure = midair.plot(midair.Sequence(array, place, targets, drives, rate=1e4))
    upper, middle = figure.axes[:2]
    band, change = upper.collections[0].get_paths()[0].vertices, middle.lines[0].get_ydata()
    assert len(change) == 1000
    assert band[np.argmin(band[:, 1]), 0] == pytest.approx(77.75, abs=0.2)
    assert np.nanmax(change) == pytest.approx(np.pi)
    assert np.nanargmax(change) == pytest.approx(1234 / 2.5, abs=1)


@pytest.mark.slow
def test_a_still_sequence_of_one_frame_has_a_picture(tmp_path: Path) -> None:
    one = midair.Sequence(ARRAY, [[[0, 0, 0.1]]], 1.0, np.ones((1, 25)) + 0j, rate=1.0)
    assert one.metrics.largest_change == 0
    one.plot().savefig(tmp_path / "one.png")


@pytest.mark.slow
def test_an_animation_has_the_frames_requested(tmp_path: Path) -> None:
    reported: list[tuple[int, int]] = []
    path = tmp_path / "motion.gif"
    made().animate(path, frames=6, fps=10, progress=lambda *done: reported.append(done))
    with Image.open(path) as image:
        assert image.n_frames == 6
        assert image.info["duration"] == 100
    assert reported == [(k, 6) for k in range(1, 7)]
    made().animate(path, plane=midair.Plane(axis="y", at=0.0, size=0.05, center=(0, 0.1), pixels=20), frames=2)
    with Image.open(path) as image:
        assert image.n_frames == 2
    assert [file.name for file in tmp_path.iterdir()] == ["motion.gif"]


@pytest.mark.slow
def test_an_animation_is_a_webp_of_what_the_frames_are(tmp_path: Path) -> None:
    sequence, path = made(), tmp_path / "motion.webp"
    sequence.animate(path, frames=4, fps=20)
    with Image.open(path) as film:
        assert film.n_frames == 4
        pictures = []
        for frame in range(4):
            film.seek(frame)
            assert film.info.get("duration", 50) == 50
            pictures.append(np.asarray(film.convert("L"), dtype=float))
    # The margins of the pictures stay the same, and the field moves.
    assert np.abs(pictures[0] - pictures[2])[:, :40].max() < 30
    assert np.abs(pictures[0] - pictures[2])[:, 100:300].max() > 100


#: Scripts in place of ffmpeg: one stores its pictures, one fails.
KEEPS = '#!/bin/sh\nfor last; do :; done\ncat > "$last"\n'
FAILS = "#!/bin/sh\necho no such codec >&2\nexit 3\n"


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="a script of the shell")
def test_a_film_is_given_to_ffmpeg(tmp_path: Path) -> None:
    program, path = tmp_path / "ffmpeg", tmp_path / "motion.mp4"
    with rc_context({"animation.ffmpeg_path": str(program)}):
        for text in (KEEPS, FAILS):
            program.write_text(text, "utf-8")
            program.chmod(0o755)
            if text == KEEPS:
                made().animate(path, frames=3)
                assert path.stat().st_size == 3 * 520 * 460 * 3
            else:
                with pytest.raises(midair.SceneError, match=r"ffmpeg ended with: no such codec; give"):
                    made().animate(path, frames=3)
    assert {file.name for file in tmp_path.iterdir()} == {"ffmpeg", "motion.mp4"}


@pytest.mark.slow
@pytest.mark.parametrize("at", [1, 3])
def test_an_interrupted_animation_leaves_nothing(at: int, tmp_path: Path) -> None:
    def interrupt(done: int, _: int) -> None:
        if done == at:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        made().animate(tmp_path / "motion.gif", frames=5, progress=interrupt)
    assert list(tmp_path.iterdir()) == []


def test_without_ffmpeg_a_film_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(FFMpegWriter, "isAvailable", classmethod(lambda _: False))
    with pytest.raises(midair.SceneError, match=r"output \.mp4 needs ffmpeg"):
        made().animate(tmp_path / "motion.mp4")
    assert list(tmp_path.iterdir()) == []


def test_a_frame_is_a_scene_with_a_field() -> None:
    sequence = made()
    scene = sequence.scene(9)
    assert scene.points == pytest.approx(points()[9, :1])
    assert scene.pressures == pytest.approx([300])
    assert scene.sound_speed == pytest.approx(331.3 * np.sqrt(1 + 25 / 273.15))
    assert len(sequence.scene(FRAMES - 1).points) == 2
    field = sequence.field(9, midair.Plane(0.1, 0.04, pixels=5))
    assert same_bits(field.pressure, midair.field(scene, sequence.drives[9], field.plane).pressure)
    judged = midair.judge(sequence.scene(0), sequence.drive(0))
    assert judged.level == pytest.approx(np.mean(sequence.pressures[0] / 300), rel=1e-4)


def test_tables_tell_what_it_is() -> None:
    html = made()._repr_html_()
    for word in ("24 frames at 2000 Hz, closed", "16", "0.4 rad a frame", "glide"):
        assert word in html
    assert "<td>uniformity</td>" in made().metrics._repr_html_()
    assert repr(made()) == ("<midair.Sequence of 24 frames at 2000 Hz, 2 points, 25 transducers: closed, by glide>")
    felt = made().felt([0, 0, 0.1], bands=[(50, 500)], area=1e-4)
    assert "rms 50 to 500 Hz" in repr(felt)
    assert "mN" in felt._repr_html_()


def test_sequences_of_traps_report_their_foci(tmp_path: Any) -> None:
    boards = midair.Array.preset("openmpd_pair")
    ring = midair.path.circle([0, 0, 0], 0.01, speed=0.8)
    for ahead in (0, "all"):
        moved = midair.sequence(boards, ring, rate=1000, signature="trap", change=np.pi / 4, ahead=ahead)
        assert 0.98 < moved.metrics.level <= 1.001
        assert moved.scene(5).signature == "trap"
        bead = midair.rest(moved.scene(40), moved.drives[40])
        # The trap accounts for the bead's motion: a bead at rest lies where the force is m v^2/r.
        inward = bead.mass * 0.8**2 / 0.01 / bead.stiffness.min()
        at = moved.points[40] * (1 - inward / 0.01)
        assert np.linalg.norm(bead.place - at) < 5e-5
        # The skin at a trap's node feels the real field, which is nearly 0 there.
        assert moved.felt(moved.points[40, 0]).values[40] < 0.01 * moved.radiation[40, 0]
        moved.save(tmp_path / "moved.npz")
        assert midair.Sequence.load(tmp_path / "moved.npz") == pickle.loads(pickle.dumps(moved)) == moved
