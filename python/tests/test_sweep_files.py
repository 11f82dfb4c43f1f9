"""Files of sweeps: complete or absent, stored results reused or made again, no foreign file replaced."""

import errno
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr

import midair
from midair._support import output as output
from midair._sweep import block
from midair._sweep.block import solve_block
from midair._sweep.engine import Job
from midair._sweep.request import read
from sweeps import HANG, REQUESTED, SCENE, TOML, changed, equal

#: The package `midair._sweep`, which the function `midair.sweep` comes from.
sweep_module = sys.modules["midair._sweep"]


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_stopped_sweep_goes_on_and_ends_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = midair.sweep(REQUESTED)
    written: list[Path] = []
    real = output.write

    def full(path: Path, content: bytes) -> None:
        if len(written) == 5:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written.append(path)
        real(path, content)

    monkeypatch.setattr(output, "write", full)
    with pytest.raises(midair.SceneError, match=r"No space left on device.*what is done is kept$"):
        midair.sweep(REQUESTED, "table.csv", threads=1)
    assert not Path("table.csv").exists()
    assert len(list(Path().glob(".table.csv.chunks/*/*.npz"))) == 5

    monkeypatch.setattr(output, "write", lambda path, content: (written.append(path), real(path, content)))
    assert equal(midair.sweep(REQUESTED, "table.csv"), whole)
    assert len(written) == 12, "a chunk a block, none done twice"
    assert sorted(path.name for path in Path().iterdir()) == ["table.csv"]


def test_another_setting_seed_or_build_is_another_chunk(monkeypatch: pytest.MonkeyPatch) -> None:
    from midair._sweep import engine

    def path(**tables: Any) -> Path:
        return Job(solve_block, read(changed(**tables)).blocks[0].settings, 0, 5).path

    other = {**REQUESTED["points"], "pressure": 1.5}
    paths = [path(), path(seed=4), path(points=other), path(medium={"temperature": 25.0}), path(seeds=[1])]
    monkeypatch.setattr(engine, "build", lambda: "another")
    paths.append(path())
    assert len(set(paths)) == len(paths)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [{}, {"seed": 1}], ids=["one by one", "batch"])
def test_a_stopped_sweep_leaves_its_chunks_in_their_midst(
    seed: dict[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    whole: list[int] = []
    real = block._arrays

    def finished(found: list[midair.Batch]) -> Any:
        whole.append(len(found))
        return real(found)

    def stop(done: int, problems: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(block, "_arrays", finished)
    # With these options, a chunk takes some seconds.
    solver = {"name": "lm", "eps": 0.0, "steps": 1000, **seed}
    points = {**REQUESTED["points"], "count": 8}
    with pytest.raises(KeyboardInterrupt):
        midair.sweep(changed(seeds=128, points=points, solver=solver), threads=1, progress=stop)
    assert len(whole) == 1, "the first chunk, and the second left"


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize(
    ("number", "words"), [(signal.SIGINT, "interrupted\n"), (signal.SIGTERM, "terminated\n")], ids=str
)
def test_a_signal_keeps_what_is_done_and_says_so_in_one_line(number: int, words: str) -> None:
    Path("sweep.toml").write_text(
        TOML.replace('"greedy"', '"lm"').replace("seeds = 3", "seeds = 100000"), encoding="utf-8"
    )
    command = [sys.executable, "-m", "midair", "sweep", "sweep.toml", "--output", "table.csv"]
    child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8")
    try:
        end = time.monotonic() + HANG
        while not list(Path().glob(".table.csv.chunks/*/*.npz")):
            assert child.poll() is None
            assert time.monotonic() < end
            time.sleep(0.02)
        child.send_signal(number)
        out, err = child.communicate(timeout=HANG)
    finally:
        child.kill()
        child.wait()
    assert (child.returncode, out, err) == (128 + number, "", words)
    assert list(Path().glob(".table.csv.chunks/*/*.npz"))
    assert not Path("table.csv").exists()
    assert not list(Path().rglob("*.part"))


def tree(folder: Path) -> dict[str, bytes]:
    """Returns the content of every file below a folder."""
    return {str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def group(path: Path, **attributes: Any) -> None:
    zarr.open_group(path, mode="w", attributes=attributes).create_array("data", data=np.arange(3))


#: Folders that no sweep made, or that contain something else besides.
FOREIGN: dict[str, Callable[[Path], None]] = {
    "somebody's group": group,
    "a group of another program": lambda path: group(path, midair="calibration"),
    "a group within ours": lambda path: (midair.sweep(REQUESTED, drives=path), group(path / "mine")),
    "a file within ours": lambda path: (midair.sweep(REQUESTED, drives=path), (path / "notes.txt").touch()),
    "ours without its mark": lambda path: (
        midair.sweep(REQUESTED, drives=path),
        (path / "zarr.json").write_text("[]", "utf-8"),
    ),
    "a plain folder": lambda path: (path.mkdir(), (path / "notes.txt").touch()),
    "an empty folder": Path.mkdir,
    "a file": Path.touch,
    "no JSON": lambda path: (path.mkdir(), (path / "zarr.json").write_text("{" * 9, "utf-8")),
}


@pytest.mark.parametrize("linked", [False, True], ids=["itself", "link"])
@pytest.mark.parametrize("name", FOREIGN)
def test_drives_of_somebody_else_are_not_replaced(name: str, linked: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    Path("there").mkdir()
    FOREIGN[name](Path("there", "mine.zarr"))
    before = tree(Path())
    drives = Path("link.zarr" if linked else "there/mine.zarr")
    if linked:
        drives.symlink_to(Path("there", "mine.zarr"), target_is_directory=True)
        before = tree(Path())
    monkeypatch.setattr(sweep_module, "run", lambda *_, **__: pytest.fail("work was done"))
    with pytest.raises(midair.SceneError, match=r"by no sweep|which no sweep made"):
        midair.sweep(REQUESTED, drives=drives)
    assert tree(Path()) == before


@pytest.mark.slow
def test_drives_of_a_former_sweep_are_replaced_where_links_lead() -> None:
    midair.sweep(REQUESTED, drives="real.zarr")
    Path("link.zarr").symlink_to("real.zarr", target_is_directory=True)
    midair.sweep(changed(seeds=3), drives="link.zarr")
    assert Path("link.zarr").is_symlink()
    assert zarr.open("real.zarr", mode="r")["drive"].shape == (36, 400)
    assert (zarr.open("real.zarr", mode="r")["scale"][:] == 1).all()
    assert sorted(path.name for path in Path().iterdir()) == ["link.zarr", "real.zarr"]


def test_drives_that_came_meanwhile_are_not_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweep_module.engine, "remove", lambda folder: None)
    real = sweep_module.run

    def slow(*arguments: Any, **keywords: Any) -> None:
        real(*arguments, **keywords)
        group(Path("drives.zarr"))

    monkeypatch.setattr(sweep_module, "run", slow)
    with pytest.raises(midair.SceneError, match="by no sweep"):
        midair.sweep(REQUESTED, drives="drives.zarr")
    assert (zarr.open("drives.zarr", mode="r")["data"][:] == np.arange(3)).all()
    assert not list(Path().glob(".*.part"))


@pytest.mark.parametrize("way", ["itself", "link", "hard link", "link in a folder"])
@pytest.mark.parametrize("file", ["sweep.csv", "scene.csv"])
def test_what_is_read_is_not_written_over(file: str, way: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # Every file is read as TOML unless it ends in .json.
    Path("scene.csv").write_text(SCENE, "utf-8")
    Path("sweep.csv").write_text('scenes = ["scene.csv"]\nsolver = { name = "naive" }\n', "utf-8")
    output = Path("table.csv")
    if way == "itself":
        output = Path(file)
    elif way == "link":
        output.symlink_to(file)
    elif way == "hard link":
        output.hardlink_to(file)
    else:
        Path("folder").symlink_to(".", target_is_directory=True)
        output = Path("folder", file)
    before = tree(Path())
    monkeypatch.setattr(sweep_module, "run", lambda *_, **__: pytest.fail("work was done"))
    with pytest.raises(midair.SceneError, match="itself: give another name"):
        midair.sweep("sweep.csv", output)
    assert tree(Path()) == before


def test_a_sweep_file_within_the_drives_is_not_removed() -> None:
    midair.sweep(REQUESTED, drives="drives.zarr")
    Path("drives.zarr", "sweep.toml").write_text(TOML, "utf-8")
    with pytest.raises(midair.SceneError, match=r"sweep\.toml"):
        midair.sweep("drives.zarr/sweep.toml", drives="drives.zarr")
    assert Path("drives.zarr", "sweep.toml").exists()


def test_another_table_is_replaced() -> None:
    Path("table.csv").write_text("an older one", "utf-8")
    midair.sweep(REQUESTED, "table.csv")
    assert len(Path("table.csv").read_text("utf-8").splitlines()) == 61


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_what_dead_processes_left_is_removed() -> None:
    gone = subprocess.Popen([sys.executable, "-c", ""])
    gone.wait()
    stale = [Path(f".table.csv.{gone.pid}.part"), Path(f".drives.zarr.{gone.pid}.part")]
    live = [Path(f".table.csv.{os.getppid()}.part"), Path(".table.csv.mine.part")]
    for path in (stale[0], *live):
        path.touch()
    group(stale[1])
    midair.sweep(REQUESTED, "table.csv", drives="drives.zarr")
    assert not any(path.exists() for path in stale)
    assert all(path.exists() for path in live)


@pytest.mark.parametrize(
    ("name", "text", "reported"),
    [
        (
            "a.json",
            '{"seeds": 2, "seeds": 1}',
            'line 1, column 14: the key "seeds" is written twice: keep one',
        ),
        ("a.toml", "seeds = 2\nseeds = 1", 'line 2, column 1: the key "seeds" is written twice'),
        ("a.json", "[" * 100000, "nested too deep"),
        ("a.toml", "seeds = 3\nsedes = 4", 'line 2, column 1: unknown key "sedes": did you mean seeds?'),
        ("a.toml", TOML.replace("preset", "prest"), 'unknown key of array "prest": did you mean preset?'),
        ("a.toml", TOML.replace("count", "cuont"), 'unknown key of points "cuont": did you mean count?'),
        (
            "a.toml",
            "seed = 1\nseeds = 2020-01-01",
            "line 2, column 9: seeds is '2020-01-01': give a whole number",
        ),
        ("a.toml", "[[solver]]\nname = 3", "solver.name is 3: give one of"),
        ("a.toml", "[points]\nz = inf", "line 2, column 5: points.z is inf: give a finite number"),
        ("a.toml", "[points]\nx = [0.0, nan]", "line 2, column 11: points.x[1] is nan: give a finite number"),
        ("a.toml", "seed = ", "line 1, column 8: no TOML here"),
        ("a.json", "[]", "line 1, column 1: the document is []: give a table"),
        ("a.toml", "", "empty"),
    ],
)
def test_a_mistake_in_a_sweep_file_is_reported_in_its_line(name: str, text: str, reported: str) -> None:
    Path(name).write_text(text, "utf-8")
    with pytest.raises(midair.SceneError) as error:
        midair.sweep(name)
    assert reported in str(error.value)
    assert ", line " not in reported or str(error.value).startswith(f"{name}, {reported}")
    assert "\n" not in str(error.value)


def test_whole_numbers_of_a_sweep_file_stay_whole() -> None:
    Path("a.toml").write_text(TOML.replace("seeds = 3", "seeds = [9223372036854775807, 1]"), encoding="utf-8")
    assert read("a.toml").blocks[0].settings["seeds"] == [9223372036854775807, 1]
