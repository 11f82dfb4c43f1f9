"""`midair export`: conversion of a file into another format on the command line."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import midair
from midair import _cli as cli

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    board = midair.Board("sonicsurface")
    midair.solve(midair.Scene(board.array, [[0, 0, 0.15]]), "naive").save("drive.npz")


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """Returns a function that runs the command line in this process:
    exit status, standard output, standard error.
    """

    def run(line: str) -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as left:
            cli.main(line.split())
        out, err = capsys.readouterr()
        assert "Traceback" not in out + err
        return left.value.code, out, err

    return run


def test_a_solution_goes_into_every_format_and_back(run: Run) -> None:
    drive = midair.Solution.load("drive.npz").drive
    for name, option, near in (
        ("out.holo", "", PI_32 := np.pi / 32 + 1e-3),
        ("out.bin", "--board sonicsurface", 1e-6),
        ("out.csv", "", 1e-6),
        ("a0_Phase.csv", "", 1e-6),
        ("phases.csv", "--layout acoustools", 1e-6),
        ("other.npz", "", 0.0),
    ):
        assert run(f"export drive.npz {name} {option}") == (0, f"wrote {name}\n", "")
        found = midair.read(name, board="sonicsurface")
        found = found.drive if isinstance(found, midair.Solution) else found
        assert isinstance(found, np.ndarray)
        assert np.abs(found - drive).max() <= near, name
        if name != "other.npz":
            options = "--board sonicsurface" if name.endswith(".bin") else ""
            assert run(f"export {name} again.holo {options}")[0] == 0
            again = midair.read("again.holo")
            assert isinstance(again, np.ndarray)
            assert np.abs(again - drive).max() <= 2 * PI_32


def test_points_of_a_sequence(run: Run) -> None:
    points = np.tile([0, 0, 0.1], (3, 1, 1)) + np.arange(3)[:, None, None] * [1e-3, 0, 0]
    array = midair.Array.grid(4, 4, pitch=0.01)
    midair.Sequence(array, points, 100.0, np.ones((3, 16), np.complex64), rate=50.0).save("motion.npz")
    assert run("export motion.npz points.csv --layout points --modulate 200")[0] == 0
    rows = Path("points.csv").read_text("utf-8").splitlines()
    assert rows[0] == "t,x,y,z,intensity,frequency"
    assert [float(cell) for cell in rows[2].split(",")] == pytest.approx([0.02, 1e-3, 0, 0.1, 1, 200])
    assert run("export points.csv copy.csv")[0] == 0
    assert Path("copy.csv").read_text("utf-8") == Path("points.csv").read_text("utf-8")


def test_what_is_refused(run: Run) -> None:
    Path("bad.csv").write_text("index,amplitude,phase\n0,2,0\n", "utf-8")
    before = sorted(file.name for file in Path().iterdir())
    for line, reported in (
        ("export drive.npz drive.npz", 'error: output "drive.npz" is the file "drive.npz" itself'),
        ("export drive.npz out.mat", "has no known ending: give .npz, .csv, .json, .holo or .bin"),
        ("export gone.npz out.holo", 'error: file "gone.npz": it cannot be read (No such file'),
        ("export bad.csv out.holo", 'error: file "bad.csv", line 2: amplitude is 2: give 0 to 1'),
        ("export drive.npz out.bin", 'give board=, such as "sonicsurface"'),
        ("export drive.npz out.bin --board autd3", "drives of 256 transducers, board of 249"),
        ("export drive.npz out.csv --layout matlab", 'layout is "matlab"'),
        ("export drive.npz out.holo --modulate 200", "modulate is 200.0: it is of control points"),
    ):
        status, out, err = run(line)
        assert (status, out) == (2, ""), line
        assert reported in err
        assert err.count("\n") == 1
        assert sorted(file.name for file in Path().iterdir()) == before
