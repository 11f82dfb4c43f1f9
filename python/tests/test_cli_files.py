"""The command line's files and streams: no file is lost or left behind, and any stream may be missing."""

import io
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import midair
import midair._cli.solve
from midair import _cli as cli
from midair._support import output as output
from scenes import same_bits

SCENE = """
[array]
positions = { file = "row.csv" }

[[points]]
position = [0.0, 0.0, 0.1]
pressure = 100.0
"""

ROW = "x,y,z\n" + "".join(f"{0.01 * k},0,0\n" for k in range(12))

#: Time limit in s, so that a hang is a failed test and not a hung test suite.
HANG = 60

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("row.csv").write_text(ROW, "utf-8")
    Path("scene.toml").write_text(SCENE, "utf-8")
    Path("scene.json").write_text(midair.Scene.load("scene.toml").json(), encoding="utf-8")


def give(monkeypatch: pytest.MonkeyPatch, text: bytes) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text), encoding="utf-8"))


def test_an_output_is_never_what_the_scene_is_read_from(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cli.solve, "solve", lambda *_, **__: pytest.fail("solved in vain"))
    Path("folder").mkdir()
    Path("link.json").symlink_to("scene.json")
    Path("hard.json").hardlink_to("scene.json")
    Path("far.png").symlink_to("scene.json")
    Path("one.csv").symlink_to("two.png")
    before = {path.name: path.read_bytes() for path in Path().glob("*.*") if path.is_file()}
    for arguments in (
        "scene.json -o scene.json",
        "scene.json -o folder/../scene.json",
        "folder/../scene.json -o link.json",
        "link.json -o scene.json",
        "scene.json -o hard.json",
        "scene.json --image far.png",
        f"scene.json -o {Path('scene.json').absolute()}",
        # A file that the scene names must not be overwritten either.
        "scene.toml -o row.csv",
        "scene.toml -o ./row.csv",
        "scene.json -o one.csv --image two.png",
    ):
        status, out, err = run("solve", *arguments.split())
        assert (status, out) == (2, ""), arguments
        assert " itself: give another name" in err, err
    give(monkeypatch, SCENE.encode())
    assert " itself: give another name" in run("solve", "-", "-o", "row.csv")[2]
    for arguments in ("scene.json -o scene.json", "scene.toml -o row.csv", "scene.json --image far.png"):
        assert " itself: give another name" in run("compare", *arguments.split())[2]
    assert {path.name: path.read_bytes() for path in Path().glob("*.*") if path.is_file()} == before


@pytest.mark.skipif(os.name == "nt", reason="files of POSIX")
def test_an_output_keeps_its_link_and_mode_and_no_device_is_replaced(run: Run) -> None:
    Path("real.csv").write_text("old", "utf-8")
    Path("real.csv").chmod(0o600)
    Path("link.csv").symlink_to("real.csv")
    assert run("solve", "scene.toml", "-o", "link.csv")[0] == 0
    assert Path("link.csv").is_symlink()
    assert Path("real.csv").read_text("utf-8").startswith("index,")
    assert Path("real.csv").stat().st_mode & 0o777 == 0o600
    os.mkfifo("pipe.csv")
    Path("null.csv").symlink_to("/dev/null")
    for name in ("pipe.csv", "null.csv"):
        status, _, err = run("solve", "scene.toml", "-o", name)
        assert (status, "is a device or pipe: give a file" in err) == (2, True), err


def test_names_as_long_as_the_file_system_takes(run: Run) -> None:
    for name in ("x" * 240 + ".csv", "µ" * 120 + ".json"):
        assert run("solve", "scene.toml", "-o", name)[0] == 0
        assert Path(name).is_file()
    midair.Scene.load("scene.toml").save("y" * 240 + ".toml")
    assert not list(Path().glob("*.part")) + list(Path().glob(".*"))


@pytest.mark.skipif(os.name == "nt", reason="processes of POSIX")
def test_parts_of_the_dead_go_and_those_of_the_living_stay(run: Run) -> None:
    child = subprocess.Popen([sys.executable, "-c", ""])
    child.wait()
    long = "x" * 240 + ".csv"
    begin = output._begin(Path(long))
    dead = [
        f".drive.csv.{child.pid}.part",
        ".drive.csv.99999999999999999999.part",
        f"{begin}{child.pid}.part",
    ]
    others = [
        f".drive.csv.{os.getppid()}.part",
        ".drive.csv.x.part",
        f".own.csv.{child.pid}.part",
        "drive.csv.1",
    ]
    for name in dead + others:
        Path(name).write_text("half", "utf-8")
    assert run("solve", "scene.toml", "-o", "drive.csv")[0] == run("solve", "scene.toml", "-o", long)[0] == 0
    assert not [name for name in dead if Path(name).exists()]
    assert [Path(name).read_text("utf-8") for name in others] == ["half"] * len(others)


def test_a_scene_may_come_from_standard_input(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    drive = midair.solve(midair.Scene.load("scene.toml")).drive
    for text in (
        SCENE.encode(),
        b"\xef\xbb\xbf" + SCENE.replace("\n", "\r\n").encode(),
        Path("scene.json").read_bytes(),
    ):
        give(monkeypatch, text)
        status, out, err = run("solve", "-", "-o", "-")
        record = json.loads(out)
        assert (status, "uniform" in err) == (0, True)
        assert [complex(*q) for q in record["drive"]] == [complex(q) for q in drive]
    give(monkeypatch, SCENE.encode())
    status, out, _ = run("compare", "-", "--solvers", "naive,gs", "-o", "-")
    assert [line.split(",")[0] for line in out.splitlines()] == ["solver", "naive", "gs"]
    give(monkeypatch, SCENE.replace("position", "positoin").encode())
    status, out, err = run("solve", "-")
    assert (status, out) == (2, "")
    assert err.startswith("error: standard input, line 6, column 1: unknown key of points[0]")


def test_a_scene_that_names_a_file_finds_it_beside_itself(run: Run, tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    os.chdir("elsewhere")
    scene = midair.Scene.load("../scene.toml")
    assert scene.array.positions.tolist() == [[0.01 * k, 0, 0] for k in range(12)]
    assert run("solve", "../scene.toml")[0] == 0
    # A saved scene contains the positions themselves.
    scene.save("own.toml")
    assert midair.Scene.load("own.toml").array.positions.tolist() == scene.array.positions.tolist()
    (tmp_path / "row.csv").write_text(ROW + "1,two,3\n", "utf-8")
    status, _, err = run("solve", "../scene.toml")
    assert (status, err.startswith(f'error: {Path("../row.csv")}, line 14: y is "two": give a number')) == (
        2,
        True,
    ), err


def test_text_is_a_scene_too() -> None:
    scene = midair.Scene.load("scene.json")
    text = Path("scene.json").read_text("utf-8")
    for given in (text, text.encode()):
        assert same_bits(midair.Scene.parse(given).array.positions, scene.array.positions)
    assert len(midair.Scene.parse(SCENE, folder=".").array) == 12
    for given, name, reported in [
        (
            SCENE,
            "scene",
            'scene, line 3, column 22: array.positions.file is "row.csv": this document has no folder',
        ),
        ("[array]", "mine", "mine, line 1, column 1: array is described 0 times"),
        (3, "scene", "text is 3: give TOML or JSON"),
        ("\ud800", "scene", "text is no Unicode"),
    ]:
        with pytest.raises(midair.SceneError) as refused:
            midair.Scene.parse(given, name=name)
        assert str(refused.value).startswith(reported)


def program(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "midair", *arguments]
    return subprocess.run(command, capture_output=True, encoding="utf-8", timeout=HANG, check=False, **options)


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="a shell of POSIX")
@pytest.mark.parametrize(
    ("line", "status"),
    [
        ("solvers | true", 141),
        ("solve scene.toml -o drive.csv | true", 141),
        ("solvers >&-", 0),
        ("solve scene.toml -o drive.csv >&- 2>&- <&-", 0),
        ("solve - <&-", 2),
        ("solvers >/dev/full", 2),
        ("solve none.toml 2>&-", 2),
    ],
)
def test_streams_may_be_closed_or_full(line: str, status: int) -> None:
    script = f'set -o pipefail; "{sys.executable}" -m midair {line}'
    ran = subprocess.run(["bash", "-c", script], capture_output=True, encoding="utf-8", timeout=HANG, check=False)
    assert ran.returncode == status
    assert len(ran.stderr.splitlines()) == (1 if "no" not in line and status == 2 else 0), ran.stderr
    if "drive.csv" in line:
        assert len(Path("drive.csv").read_text("utf-8").splitlines()) == 13


@pytest.mark.slow
@pytest.mark.parametrize(
    "environment",
    [
        {"LC_ALL": "C", "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
        dict.fromkeys(["MIDAIR_SIMD", "COLUMNS", "LINES", "TERM", "HOME", "LANG", "NO_COLOR", "FORCE_COLOR"], ""),
        {"TERM": "dumb", "MPLCONFIGDIR": __file__},
        None,
    ],
)
def test_any_environment_will_do(environment: dict[str, str] | None) -> None:
    around = {} if environment is None else {**os.environ, **environment}
    ran = program("solve", "scene.toml", "-o", "µ😀.csv", "--image", "µ.png", env=around)
    assert (ran.returncode, ran.stderr) == (0, "")
    assert "uniform" in ran.stdout
    assert Path("µ😀.csv").exists()
    assert Path("µ.png").exists()


@pytest.mark.slow
def test_paths_may_have_spaces_and_umlauts() -> None:
    tables = Path("mes scènes ü", "sous dossier")
    tables.mkdir(parents=True)
    Path("row.csv").rename(tables / "row.csv")
    scene, drive = tables.parent / "scène.toml", tables / "drive ß.npz"
    # A backslash on Windows; in single quotes TOML keeps it.
    scene.write_text(SCENE.replace('"row.csv"', f"'{Path(tables.name, 'row.csv')}'"), "utf-8")
    ran = program("solve", str(scene), "-o", str(drive), "--image", str(tables / "µ.png"))
    assert (ran.returncode, ran.stderr) == (0, "")
    assert drive.name in ran.stdout
    assert len(list(tables.iterdir())) == 3
    ran = program("solve", str(tables / "rien.toml"))
    assert ran.stderr == f"error: No such file or directory: {tables / 'rien.toml'}\n"


def test_what_no_one_foresaw_is_one_line(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(error: BaseException) -> Callable[..., None]:
        def fail(*_: object, **__: object) -> None:
            raise error

        return fail

    for error, status, reported in [
        (
            ZeroDivisionError("no\nway"),
            70,
            "please report this line with your command and files: ZeroDivisionError: no way",
        ),
        (MemoryError(), 2, "memory ran out"),
        (MemoryError("9 GB for N = 3"), 2, "error: 9 GB for N = 3"),
        (RecursionError("deep"), 70, "RecursionError: deep (test_cli_files.py:"),
    ]:
        monkeypatch.setattr(cli.solve, "solve", failing(error))
        left, out, err = run("solve", "scene.toml", "-o", "drive.csv")
        assert (left, out, len(err.splitlines())) == (status, "", 1)
        assert reported in err, err


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
def test_sigterm_ends_and_tidies_where_nothing_can_be_kept() -> None:
    code = """
import sys, time
from midair import _cli as cli
from midair._support import output as output
write = output.write
def slow(path, content):
    part = output.part_of(path)
    part.write_text("half")
    try:
        print("ready", flush=True)
        time.sleep(60)
    finally:
        part.unlink()
output.write = slow
cli.main(["solve", "scene.toml", "-o", "drive.csv"])
"""
    child = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8"
    )
    try:
        assert child.stdout.readline() == "ready\n"
        child.send_signal(signal.SIGTERM)
        _, err = child.communicate(timeout=HANG)
    finally:
        child.kill()
        child.wait()
    assert (child.returncode, err) == (143, "terminated\n")
    assert not list(Path().glob(".*"))
    assert not Path("drive.csv").exists()
