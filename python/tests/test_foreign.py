"""Files from elsewhere: midair reads known formats with bounded memory and time, rejects others,
and runs no code.
"""

import os
import pickle
import sys
import time
import warnings
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import midair
from midair import shape
from midair._support import text

EPS = """%!PS-Adobe-3.0 EPSF-3.0
%%BoundingBox: 0 0 90 90
%%EndComments
({}) (w) file dup (x) writestring closefile showpage
"""
LOOP = "%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 90 90\n%%EndComments\n{} loop\n"
SVG = '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink">{}</svg>'
LINE = '<path d="M0 0 L9 3"/>'


@pytest.mark.parametrize("name", ["ring.png", "ring.eps", "ring.jpg", "ring"])
def test_a_picture_that_is_a_program_is_not_run(name: str, tmp_path: Path) -> None:
    owned = tmp_path / "owned"
    for content in (EPS.format(owned), LOOP):
        (tmp_path / name).write_text(content, "utf-8")
        with pytest.raises(midair.SceneError, match=r"cannot be read as a picture, give a file of PNG, JPEG"):
            midair.image(tmp_path / name, size=0.05, z=0.15)
    scene = tmp_path / "scene.toml"
    scene.write_text(
        f'[array]\npreset = "ultraino_flat8x8"\n[image]\nfile = "{name}"\nsize = 0.05\nz = 0.15\n',
        encoding="utf-8",
    )
    with pytest.raises(midair.SceneError, match="cannot be read as a picture"):
        midair.Scene.load(scene)
    assert not owned.exists()


def test_a_picture_of_more_pixels_than_memory_allows_is_refused_before_it_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "large.png"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        Image.new("1", (6000, 6000), 1).save(path)
    assert path.stat().st_size < 20_000
    monkeypatch.setenv("MIDAIR_MEMORY", "500MB")
    with pytest.raises(midair.SceneError, match=r"6000 x 6000 pixels need 576 MB of 500 allowed, make it"):
        midair.image(path, size=0.1, z=0.1)
    monkeypatch.setenv("MIDAIR_MEMORY", "10kB")
    with pytest.raises(midair.SceneError):
        midair.image(path, size=0.1, z=0.1)
    monkeypatch.delenv("MIDAIR_MEMORY")
    path.write_bytes(b"P6 60000 60000 255\n")
    with pytest.raises(midair.SceneError, match="more than 178 million pixels, make it smaller"):
        midair.image(path, size=0.1, z=0.1)


def nested(levels: int, width: int) -> str:
    """Returns an SVG of nested references, with width ** levels paths."""
    groups = f'<g id="u0">{LINE}</g>'
    for level in range(levels):
        groups += f'<g id="u{level + 1}">' + f'<use xlink:href="#u{level}"/>' * width + "</g>"
    return SVG.format(f"<defs>{groups}</defs><use href='#u{levels}'/>")


HEAVY = {
    "references": (nested(7, 10), "unfolded, it has more than 100000 elements"),
    "references by a hundred": (nested(60, 2), "unfolded, it has more than 100000 elements"),
    "a chain of references": (nested(60, 1), "or 100 levels"),
    "a loop": (SVG.format(f'<g id="a"><use href="#a"/>{LINE}</g>'), "refers to itself"),
    "a loop of two": (
        SVG.format(f'<g id="a"><use href="#b"/></g><g id="b"><use href="#a"/>{LINE}</g>'),
        "refers to itself",
    ),
    "transforms": (
        SVG.format(f'<g transform="{"translate(" * 50_000}">{LINE}</g>'),
        "transform of more than 2000",
    ),
    "a transform of a gradient": (
        SVG.format(f'<g gradientTransform="{"scale(" * 50_000}">{LINE}</g>'),
        "gradientTransform of more than 2000",
    ),
    "styles": (SVG.format(f'<g style="{"a:b;" * 50_000}">{LINE}</g>'), "style of more than 16000"),
    "a style sheet": (SVG.format(f"<style>{'a{' * 50_000}</style>{LINE}"), "style sheets of more than"),
    "style sheets": (
        SVG.format(f"<style>{'a{' * 5_000}</style>" * 3 + LINE),
        "style sheets of more than",
    ),
    "depth": (SVG.format("<g>" * 20_000 + LINE + "</g>" * 20_000), "or 100 levels"),
    "a long path, often": (
        SVG.format(f'<path id="p" d="M0 0{"L1 2" * 20_000}"/>' + '<use href="#p"/>' * 100),
        "more than 100000 elements, 4 MB",
    ),
}


@pytest.mark.parametrize("name", HEAVY)
def test_a_drawing_of_too_much_work_is_refused_at_once(name: str, tmp_path: Path) -> None:
    content, reported = HEAVY[name]
    (tmp_path / "a.svg").write_text(content, "utf-8")
    for given in (content, tmp_path / "a.svg"):
        begin = time.process_time()
        with pytest.raises(midair.SceneError, match=reported) as error:
            shape.svg(given, size=0.05, z=0.1)
        assert "\n" not in str(error.value)
        # Under Wine, on a busy machine, 6 s.
        assert time.process_time() - begin < (5 if sys.platform == "linux" else 30)


def test_references_within_bounds_are_drawn() -> None:
    once = shape.svg(SVG.format(LINE), size=0.05, z=0.1)
    many = shape.svg(nested(2, 4), size=0.05, z=0.1)
    assert np.array_equal(once, many)


@pytest.mark.parametrize("name", ["hand.dae", "hand.3mf", "hand.svg", "hand.xyz", "hand"])
def test_meshes_come_in_known_formats(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text("v 0 0 0\n", "utf-8")
    with pytest.raises(midair.SceneError, match=r"it is of no known format, export it again, as \.stl"):
        midair.Mesh.from_file(tmp_path / name)


def test_a_mesh_of_more_bytes_than_memory_allows_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "hand.obj").write_text("v 0 0 0\n" * 100_000, "utf-8", newline="\n")
    monkeypatch.setenv("MIDAIR_MEMORY", "2MB")
    with pytest.raises(midair.SceneError, match=r"it needs 12 MB of 1 allowed"):
        midair.Mesh.from_file(tmp_path / "hand.obj")


def test_frames_that_a_table_only_claims_are_refused(tmp_path: Path) -> None:
    (tmp_path / "frames.csv").write_text("frame,point,x,y,z\n0,0,0,0,0.1\n1000000000,0,0,0,0.1\n", "utf-8")
    text_ = '[array]\npreset = "ultraino_flat8x8"\n[motion]\nfile = "{}"\nrate = 100\n'
    scene = tmp_path / "scene.toml"
    scene.write_text(text_.format("frames.csv"), encoding="utf-8")
    from midair._sequence.solve import motion_of

    with pytest.raises(midair.SceneError, match="1000000001 frames of 1 points need"):
        motion_of(scene)
    # An array whose header claims more data than the file has.
    header = b"{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000, 4, 3)}\n"
    (tmp_path / "frames.npy").write_bytes(b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header)
    scene.write_text(text_.format("frames.npy"), encoding="utf-8")
    with pytest.raises(midair.SceneError, match="give points"):
        motion_of(scene)


def test_archives_unpack_to_no_more_than_memory_allows(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "bomb.npz"
    np.savez_compressed(path, **dict.fromkeys(("points", "targets", "drives", "drive"), np.zeros(1 << 21)))
    assert path.stat().st_size < 100_000
    monkeypatch.setenv("MIDAIR_MEMORY", "10MB")
    for read in (midair.Sequence.load, midair.Solution.load, midair.Calibration.load, midair.read):
        with pytest.raises(midair.SceneError) as error:
            read(path)
        assert "raise MIDAIR_MEMORY" in str(error.value) or "is damaged" in str(error.value)
    with pytest.raises(midair.SceneError, match="it unpacks to 64 MB, more than the 9 MB allowed"):
        text.arrays(path)


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX")
@pytest.mark.parametrize("kind", [midair.Sequence, midair.Solution, midair.Calibration])
def test_a_pipe_or_a_device_is_refused_at_once(kind: Any, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.npz")
    (tmp_path / "device.npz").symlink_to("/dev/zero")
    for name in ("pipe.npz", "device.npz"):
        with pytest.raises(midair.SceneError, match=rf'{name}".* a folder, device or pipe: give a file'):
            kind.load(tmp_path / name)


BOARD = midair.Array.grid(10, 10, pitch=0.01)
FRAMES = 2000


def large(path: Path, codes: bool) -> midair.Sequence:
    random = np.random.default_rng(0)
    given: dict[str, Any] = {"drives": np.exp(2j * np.pi * random.random((FRAMES, 100)))}
    if codes:
        given = {"drives": random.integers(0, 16, (FRAMES, 100)), "quantization": {"phases": 16}}
    points = np.broadcast_to([0, 0, 0.1], (FRAMES, 1, 3))
    made = midair.Sequence(BOARD, points, 1.0, rate=100, **given)
    made.save(path)
    return made


@pytest.mark.parametrize("codes", [False, True])
def test_a_large_sequence_that_is_cut_or_changed_while_it_is_used_is_refused(
    codes: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("midair._sequence.files.LARGE", 0)
    path = tmp_path / "q.npz"
    whole = large(path, codes)
    found = midair.Sequence.load(path)
    assert found == whole
    assert pickle.loads(pickle.dumps(found)) == whole
    assert np.array_equal(found.drive(FRAMES - 1), whole.drive(FRAMES - 1))
    assert np.array_equal(found.changes, whole.changes)
    content = path.read_bytes()
    for change in ("cut", "overwritten", "same length, other time"):
        path.write_bytes(content)
        found = midair.Sequence.load(path)
        if change == "cut":
            os.truncate(path, 10_000)
        else:
            time.sleep(0.02)
            with path.open("r+b") as stream:
                stream.seek(60_000)
                stream.write(b"\x3f" * 40)
        with pytest.raises(midair.SceneError, match=r"q.npz. was changed while it was in use: load it again"):
            found.drive(FRAMES - 1)


def test_what_is_above_one_in_a_large_file_is_refused_even_if_its_time_says_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("midair._sequence.files.LARGE", 0)
    path = tmp_path / "q.npz"
    large(path, codes=False)
    found = midair.Sequence.load(path)
    before = path.stat()
    with path.open("r+b") as stream:
        stream.seek(found._drives.kept._start + 800_000)
        stream.write(np.full(100, 5 + 0j, np.complex64).tobytes())
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    with pytest.raises(midair.SceneError, match=r"drives\[\d+, \d+\] is .*: give \|q\| of at most 1"):
        found.drives  # noqa: B018


@pytest.mark.slow
def test_flipped_bits_of_a_sequence_are_damage_and_no_error_of_the_system(tmp_path: Path) -> None:
    path = tmp_path / "q.npz"
    points = np.broadcast_to([0, 0, 0.1], (4, 1, 3))
    midair.Sequence(BOARD, points, 1.0, np.ones((4, 100)) + 0j, rate=100).save(path)
    content = path.read_bytes()
    random = np.random.default_rng(3)
    for place in random.integers(len(content) - 600, len(content), 300).tolist():
        path.write_bytes(content[:place] + bytes([random.integers(256)]) + content[place + 1 :])
        with suppress(midair.SceneError):
            midair.Sequence.load(path)


@pytest.mark.parametrize(
    "read",
    [
        midair.read,
        midair.Array.from_file,
        lambda path: midair.image(path, size=1, z=1),
        lambda path: shape.svg(path, size=1, z=1),
        midair.Sequence.load,
        midair.Calibration.load,
        midair.Mesh.from_file,
    ],
)
def test_a_name_with_a_character_of_code_0_is_refused_in_one_line(read: Any) -> None:
    with pytest.raises(midair.SceneError) as error:
        read("a\0.npz")
    assert "\0" not in str(error.value)


def test_a_picture_needs_pillow_only(monkeypatch: pytest.MonkeyPatch) -> None:
    from midair._points.image import FORMATS

    assert "EPS" not in FORMATS
    assert sys.modules["PIL"]
