"""Rejected commands: a message of one line, exit status 2, and no file is written."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import midair
from midair import _cli as cli

SCENE = """
[array]
grid = { nx = 6, ny = 5, pitch = 0.01 }

[[points]]
position = [-0.02, 0.0, 0.1]
pressure = 900.0

[[points]]
position = [0.015, 0.01, 0.1]
pressure = 900.0
"""

#: Time limit in s, so that a hang is a failed test and not a hung test suite.
HANG = 60


def changed(old: str, new: str) -> bytes:
    assert old in SCENE
    return SCENE.replace(old, new, 1).encode()


GRID = "grid = { nx = 6, ny = 5, pitch = 0.01 }"

#: Scene files, one for each reason of rejection, besides those that the core's own tests have.
FILES: dict[str, bytes] = {
    "empty": b"",
    "binary": bytes(range(256)) * 8,
    "no toml": b"[array\n",
    "unknown table": SCENE.encode() + b"\n[aray]\n",
    "unknown solver": SCENE.encode() + b'\n[solver]\nname = "gredy"\n',
    "solver without a name": SCENE.encode() + b"\n[solver]\nphases = 4\n",
    "unknown option": SCENE.encode() + b'\n[solver]\nname = "greedy"\nphasse = 4\n',
    "balance of no sense": SCENE.encode() + b'\n[solver]\nname = "greedy"\nbalance = 1\n',
    "tiles of three": changed(GRID, 'preset = "autd3"\ntiles = [1, 1, 1]'),
    "half a count": changed("nx = 6", "nx = 2.5"),
    "a position of four": changed("-0.02, 0.0, 0.1", "-0.02, 0.0, 0.1, 0.1"),
    "a point on a transducer": changed("0.015, 0.01, 0.1", "0.005, 0.01, 0.0"),
    "a pressure that is none": changed("900.0", "nan"),
    "all weights 0": SCENE.replace("900.0", "900.0\nweight = 0").encode(),
    "responses of three numbers": changed("[array]", f"[array]\nresponse = {[[1, 0, 0]] * 30}"),
    "a center of three numbers": SCENE.encode() + b"\n[plane]\ncenter = [0.0, 0.0, 0.0]\n",
    "a line break in a name": SCENE.encode() + b'\n[solver]\nname = "gr\\needy"\n',
    "a line break in an option": SCENE.encode() + b'\n[solver]\nname = "greedy"\nseed = "1\\n2"\n',
}  # fmt: skip

JSON: dict[str, bytes] = {
    "no json": b"{",
    "toml": SCENE.encode(),
    "NaN": b'{"array": {"preset": "paper20"}, "points": [{"position": [NaN, 0, 0.1]}]}',
    "twice the same key": b'{"array": {"preset": "paper20"},\n"array": {"preset": "paper20"}}',
    "a deep nest": b"[" * 100000,
}

ARGUMENTS: dict[str, str] = {
    "no scene": "solve",
    "no scene to compare": "compare",
    "unknown command": "sovle scene.toml",
    "unknown option of compare": "compare scene.toml --nosuch 3",
    "unknown option of solve": "solve scene.toml --nosuch 3 -o out.csv",
    "an option of another solver": "solve scene.toml --limit clamp",
    "one scene too many": "solve scene.toml scene.toml",
    "one word too many": "solvers scene.toml",
    "option without its value": "solve scene.toml --phases",
    "option given twice": "solve scene.toml --phases 4 --phases 8",
    "output without its value": "solve scene.toml -o",
    "unknown solver": "solve scene.toml --solver nosuch -o out.csv",
    "unknown solvers": "compare scene.toml --solvers nosuch --image out.png",
    "no solvers": "compare scene.toml --solvers=",
    "phases 1": "solve scene.toml --phases 1 -o out.csv --image out.png",
    "phases x": "solve scene.toml --phases x -o out.csv",
    "phases true": "solve scene.toml --phases true -o out.csv",
    "phases of a list": "solve scene.toml --phases [16] -o out.csv",
    "order of no sense": "solve scene.toml --order sideways -o out.csv",
    "order of a deep nest": "solve scene.toml -o out.csv --order " + "[" * 100000,
    "balance of no sense": "solve scene.toml --balance maybe",
    "aim of no sense": "solve scene.toml --solver uniform --aim loud -o out.csv",
    "unused aim": "solve scene.toml --solver naive --aim max -o out.csv",
    "pressures": "solve scene.toml --pressures 5 -o out.csv",
    "start": "solve scene.toml --start 5 -o out.csv",
    "option of the command mistyped": "solve scene.toml --out out.csv",
    "file mistyped": "solve scen.toml",
    "no faults": "tolerate scene.toml",
    "unknown ending": "solve scene.toml -o out.mat",
    "no ending": "solve scene.toml -o out",
    "ending alone": "solve scene.toml -o .npz",
    "unknown ending of the image": "solve scene.toml --image out.mat",
    "unknown ending of the sheet": "compare scene.toml --image out.csv",
}

#: Commands that the operating system rejects, and words of its message that are the same on each system.
OF_THE_SYSTEM: dict[str, tuple[str, str]] = {
    "folder for a file": ("solve folder.toml", "folder.toml"),
    "image is a folder": ("solve scene.toml --image folder.png", "folder.png"),
    "output is a folder": ("solve scene.toml -o folder.csv", "folder.csv"),
    "folder that is a file": ("solve scene.toml -o scene.toml/out.csv", "scene.toml"),
    "name too long": (f"solve scene.toml -o {'a' * 300}.csv", "long"),
    "missing file": ("solve none.toml -o out.csv", "none.toml"),
    "folder that is not there": ("solve scene.toml -o none/out.csv", "none"),
    "folder that is not there for the sheet": ("compare scene.toml --image none/out.png", "none"),
}

Kept = Callable[..., None]
Refuse = Callable[..., str]


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("scene.toml").write_text(SCENE, "utf-8")
    for ending in ("toml", "csv", "png"):
        Path(f"folder.{ending}").mkdir()


def check(status: object, out: str, err: str) -> str:
    assert status == 2
    assert out == ""
    assert err.startswith("error: ")
    assert err.endswith("\n")
    assert len(err.splitlines()) == 1, err
    return err


@pytest.fixture
def refuse(capsys: pytest.CaptureFixture[str]) -> Refuse:
    """Returns a function that runs a command in this process, checks that it is rejected,
    and returns the message.
    """

    def refuse(*arguments: str) -> str:
        before = {path: path.stat().st_mtime_ns for path in Path().rglob("*")}
        with pytest.raises(SystemExit) as left:
            cli.main(arguments)
        assert {path: path.stat().st_mtime_ns for path in Path().rglob("*")} == before
        return check(left.value.code, *capsys.readouterr())

    return refuse


@pytest.mark.parametrize("bad", ARGUMENTS)
def test_bad_command_is_refused_in_one_line(refuse: Refuse, kept: Kept, bad: str) -> None:
    kept(refuse(*ARGUMENTS[bad].split(" ")))


@pytest.mark.parametrize("bad", OF_THE_SYSTEM)
def test_bad_place_is_refused_in_one_line(refuse: Refuse, bad: str) -> None:
    command, word = OF_THE_SYSTEM[bad]
    assert word in refuse(*command.split(" "))


@pytest.mark.parametrize("bad", FILES)
def test_bad_file_is_refused_in_one_line(refuse: Refuse, kept: Kept, bad: str) -> None:
    Path("bad.toml").write_bytes(FILES[bad])
    with pytest.raises(midair.SceneError) as caught:
        midair.solve(midair.Scene.load("bad.toml"))
    kept(
        refuse("solve", "bad.toml", "-o", "out.npz", "--image", "out.png"),
        refuse("compare", "bad.toml", "--image", "out.png"),
        str(caught.value),
    )


@pytest.mark.parametrize("bad", JSON)
def test_bad_json_file_is_refused_in_one_line(refuse: Refuse, kept: Kept, bad: str) -> None:
    Path("bad.json").write_bytes(JSON[bad])
    kept(refuse("solve", "bad.json", "-o", "out.npz"))


@pytest.mark.slow
def test_oversized_file_is_refused_unread(refuse: Refuse) -> None:
    with Path("huge.toml").open("wb") as huge:
        huge.truncate(65 << 20)
    assert "64 MB" in refuse("solve", "huge.toml", "-o", "out.npz")
    # A file of the largest allowed size is read, and is then rejected because it is not text.
    with Path("large.toml").open("wb") as large:
        large.truncate(64 << 20)
    assert "64 MB" not in refuse("solve", "large.toml", "-o", "out.npz")


def test_name_with_a_line_break_is_refused_in_one_line(refuse: Refuse) -> None:
    for arguments in (["no\nfile.toml"], ["scene.toml", "-o", "a\nb"], ["scene.toml", "-o", "a\nb/out.csv"]):
        assert refuse("solve", *arguments)
    for arguments in (["--so\nlver", "1"], ["--solver", "gr\needy"], ["--seed", "1\n2"], ["--order", "a\nb"]):
        assert refuse("solve", "scene.toml", *arguments)
    assert refuse("so\nlve")


@pytest.mark.skipif(os.name == "nt", reason="permissions of POSIX")
def test_folder_that_cannot_be_written_to_is_refused(refuse: Refuse, monkeypatch: pytest.MonkeyPatch) -> None:
    # The superuser may write anywhere, so the test replaces the call that finds the folder writable.
    def refused(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "touch", refused)
    assert "Permission denied" in refuse("solve", "scene.toml", "-o", "out.csv")


def test_name_too_long_for_the_file_system_is_refused_before_the_solve(refuse: Refuse) -> None:
    assert "too long" in refuse("solve", "scene.toml", "-o", "x" * 252 + ".csv")


def test_output_is_checked_before_the_solve(refuse: Refuse, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cli.solve, "solve", lambda *_, **__: pytest.fail("solved in vain"))
    for end in (["-o", "none/out.csv"], ["-o", "out.mat"], ["-o", "folder.csv"], ["--image", "none/out.png"]):
        refuse("solve", "scene.toml", *end)


def test_write_that_fails_leaves_nothing_behind(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(path: Path, content: bytes) -> int:
        with path.open("wb") as part:
            part.write(content[: len(content) // 2])
        raise OSError(28, "No space left on device", str(path))

    Path("out.npz").write_text("old", "utf-8")
    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(SystemExit) as left:
        cli.main(["solve", "scene.toml", "-o", "out.npz"])
    _, err = capsys.readouterr()
    assert left.value.code == 2
    *_, last = err.splitlines()
    assert last.startswith("error: No space left on device")
    assert Path("out.npz").read_text("utf-8") == "old"
    assert not list(Path().glob("*.part")) + list(Path().glob(".*"))


@pytest.mark.slow
@pytest.mark.parametrize(
    "command",
    ["solve none.toml", "solve scene.toml --phases 1 -o out.csv", "sovle", "compare scene.toml --nosuch 1"],
)
def test_process_says_the_same(command: str) -> None:
    program = [sys.executable, "-m", "midair", *command.split()]
    ran = subprocess.run(program, capture_output=True, encoding="utf-8", timeout=HANG, check=False)
    check(ran.returncode, ran.stdout, ran.stderr)
    assert not Path("out.csv").exists()
