"""Files for resuming: a damaged file is made again, only one process uses a folder, other files are safe."""

import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair
import midair._sequence.solve as motion
from midair._points import boundary
from midair._support import cache, output
from sweeps import REQUESTED

BOARD = midair.Array.grid(8, 8, 10e-3, quantization=midair.Array.preset("sonicsurface").quantization)
ANGLE = np.arange(80)[:, None] / 40
RING = np.stack([0.01 * np.cos(ANGLE), 0.01 * np.sin(ANGLE), np.full(ANGLE.shape, 0.12)], axis=-1)

#: A process that solves a sequence with `resume`, and waits after each block of frames while a file exists;
#: `most` limits the size of its files.
SCRIPT = """
import sys, time
from pathlib import Path
sys.path.insert(0, {tests!r})
import test_cache
test_cache.motion.BLOCK = 16
if {most}:
    import resource, signal
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, ({most}, resource.RLIM_INFINITY))
def wait(*_):
    while Path({path!r}).with_suffix(".wait").exists():
        time.sleep(0.01)
try:
    test_cache.solved(Path({path!r}), progress=wait)
except test_cache.midair.SceneError as error:
    sys.exit(str(error))
"""


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(motion, "BLOCK", 16)


def solved(path: Path, **more: Any) -> midair.Sequence:
    return midair.sequence(BOARD, RING, rate=500, resume=path, **more)


class Enough(Exception):
    pass


@pytest.fixture
def whole() -> midair.Sequence:
    return midair.sequence(BOARD, RING, rate=500)


@pytest.fixture
def stopped(tmp_path: Path) -> Path:
    """Returns an incomplete file: all blocks of frames except the last are stored."""
    path = tmp_path / "x.npz"

    def stop(done: int, total: int) -> None:
        if done >= total - 16:
            raise Enough

    with pytest.raises(Enough):
        solved(path, progress=stop)
    assert len(pieces(path)) == 4
    return path


def pieces(path: Path) -> list[Path]:
    return sorted(path.with_name("x.npz.resume").glob("*.npz"))


def zeros(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2 :] = bytes(len(content) - len(content) // 2)
    path.write_bytes(content)


SPOILT = {
    "half zeros": lambda found: zeros(found[1]),
    "exchanged": lambda found: found[1].write_bytes(found[2].read_bytes()),
    "cut": lambda found: found[2].write_bytes(found[2].read_bytes()[:-1]),
    "empty": lambda found: found[0].write_bytes(b""),
    "missing": lambda found: found[1].unlink(),
    "a folder": lambda found: (found[3].unlink(), found[3].mkdir()),
    "request cut": lambda found: (found[0].parent / "request").write_bytes(b"12"),
    "request no text": lambda found: (found[0].parent / "request").write_bytes(b"\xff\xfe"),
    "request gone": lambda found: (found[0].parent / "request").unlink(),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SPOILT)
def test_a_spoilt_piece_is_solved_anew(name: str, stopped: Path, whole: midair.Sequence) -> None:
    SPOILT[name](pieces(stopped))
    if name == "a folder":
        with pytest.raises(midair.SceneError, match=r"000000000048\.npz"):
            solved(stopped)
        return
    assert solved(stopped) == whole
    assert [file.name for file in stopped.parent.iterdir()] == ["x.npz"]


def test_what_is_of_others_in_the_folder_stays(stopped: Path, whole: midair.Sequence) -> None:
    folder = pieces(stopped)[0].parent
    (folder / "precious.txt").write_text("mine", "utf-8")
    (folder / ".000000000000.npz.4000000.part").touch()
    assert solved(stopped) == whole
    assert [file.name for file in folder.iterdir()] == ["precious.txt"]


def test_a_folder_that_is_a_link_is_refused(tmp_path: Path) -> None:
    (tmp_path / "other").mkdir()
    (tmp_path / "x.npz.resume").symlink_to(tmp_path / "other", target_is_directory=True)
    with pytest.raises(midair.SceneError, match="no folder of kept results"):
        solved(tmp_path / "x.npz")
    assert not list((tmp_path / "other").iterdir())


def start(path: Path, most: int = 0) -> "subprocess.Popen[str]":
    """Starts a process of SCRIPT. Its files may have at most `most` bytes; 0 stands for no limit."""
    script = SCRIPT.format(tests=str(Path(__file__).parent), path=str(path), most=most)
    return subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8"
    )


@pytest.mark.slow
def test_a_second_run_on_one_folder_gets_one_line(tmp_path: Path, whole: midair.Sequence) -> None:
    path = tmp_path / "x.npz"
    hold = path.with_suffix(".wait")
    hold.touch()
    first = start(path)
    while not pieces(path):
        assert first.poll() is None
        time.sleep(0.02)
    second = start(path)
    reported = second.communicate(timeout=60)[1]
    hold.unlink()
    assert second.returncode == 1
    assert reported.count("\n") == 1
    assert "is in use by another run of the same work: wait until that ends" in reported
    assert first.communicate(timeout=60) == ("", "")
    assert first.returncode == 0
    assert midair.Sequence.load(path) == whole
    assert [file.name for file in tmp_path.iterdir()] == ["x.npz"]


@pytest.mark.slow
def test_a_killed_run_frees_its_folder(tmp_path: Path, whole: midair.Sequence) -> None:
    path = tmp_path / "x.npz"
    hold = path.with_suffix(".wait")
    hold.touch()
    first = start(path)
    while not pieces(path):
        time.sleep(0.02)
    first.kill()
    first.communicate()
    hold.unlink()
    assert solved(path) == whole
    assert [file.name for file in tmp_path.iterdir()] == ["x.npz"]


def test_two_sweeps_of_one_output_do_not_meet(tmp_path: Path) -> None:
    with (
        cache.locked(tmp_path / ".table.csv.chunks"),
        pytest.raises(midair.SceneError, match="in use by another run"),
    ):
        midair.sweep(REQUESTED, tmp_path / "table.csv")
    assert not list(tmp_path.iterdir())


def test_a_lock_is_free_again_and_leaves_nothing(tmp_path: Path) -> None:
    for _ in range(2):
        with cache.locked(tmp_path / "a" / "b"):
            assert (tmp_path / "a" / "b" / cache.LOCK).exists()
    assert not list((tmp_path / "a").iterdir())


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="POSIX")
def test_a_full_disk_is_reported_in_one_line(tmp_path: Path) -> None:
    run = start(tmp_path / "x.npz", most=1500)
    reported = run.communicate(timeout=60)[1]
    assert run.returncode == 1
    assert reported.count("\n") == 1
    assert '000000000000.npz" cannot be written (File too large): make room' in reported
    assert not list(tmp_path.rglob("*.part"))


def test_kept_sound_of_a_mesh_with_a_flipped_bit_is_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(boundary, "folder", lambda: tmp_path)
    sound = np.full((40, 30), 1 + 2j, np.complex64)
    boundary.store(b"content", sound)
    file = boundary.path(b"content")[0]
    content = file.read_bytes()
    found = boundary.load(b"content", (40, 30))
    assert found is not None
    assert np.array_equal(found, sound)
    for spoilt in (
        content[:400] + bytes([content[400] ^ 1]) + content[401:],
        content[: len(content) // 2] + bytes(len(content) // 2),
        bytes(len(content)),
        content.replace(b"(40, 30)", b"(40, 3\n)"),
        b"\x93NUMPY\x01\x00F\x00{'descr': '<c8', 'fortran_order': False, 'shape': (99999999999999, 9)}\n",
    ):
        file.write_bytes(spoilt)
        assert boundary.load(b"content", (40, 30)) is None
    # A file with the content for one mesh is not read for another mesh.
    boundary.path(b"other")[0].write_bytes(content)
    assert boundary.load(b"other", (40, 30)) is None
    (tmp_path / "notes.npz").write_text("mine", "utf-8")
    monkeypatch.setattr(boundary, "MOST", 0)
    boundary.prune(tmp_path)
    assert [file.name for file in tmp_path.iterdir()] == ["notes.npz"]


@pytest.mark.parametrize("name", ["a\0.npz", Path("a\0.npz")])
def test_a_name_that_no_file_can_have_is_refused(name: Any) -> None:
    with pytest.raises(midair.SceneError, match=r'resume is "a\\0.npz": give the name of a file'):
        solved(name)


def test_what_is_written_reaches_the_disk_before_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[str] = []
    monkeypatch.setattr(output.os, "fsync", lambda handle: seen.append(Path(f"/proc/self/fd/{handle}").resolve().name))
    cache.save(tmp_path / "a.npz", "a", {"x": np.zeros(3)})
    assert [name.endswith(".part") for name in seen] == [True, False]
    assert seen[1] == tmp_path.name


def test_a_file_with_another_content_is_never_replaced(tmp_path: Path, whole: midair.Sequence) -> None:
    finished, sequence, text, solution = (tmp_path / f"{name}.npz" for name in "abcd")
    assert solved(finished) == whole
    whole.save(sequence)
    text.write_text("notes", "utf-8")
    midair.solve(midair.Scene(BOARD, [[0, 0, 0.1]])).save(solution)
    contents = {file: file.read_bytes() for file in tmp_path.iterdir()}
    for file, more in ((finished, {"change": 0.1}), (sequence, {}), (text, {}), (solution, {})):
        with pytest.raises(midair.SceneError, match=r"resume is .*: it does not contain the result of this"):
            solved(file, **more)
    # The same call reads the finished file.
    assert solved(finished, progress=lambda *_: pytest.fail("solved again")) == whole
    assert {file: file.read_bytes() for file in tmp_path.iterdir()} == contents
