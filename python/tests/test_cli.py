"""The command line: what it prints and the files it writes."""

import csv
import json
import os
import signal
import struct
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import midair
from midair._cli import progress, solve
from scenes import METRICS, numbers, same_bits

SOLVERS = sorted(midair.solvers())

#: Time limit in s, so that a hang is a failed test and not a hung test suite.
HANG = 60

SCENE = """
[array]
grid = { nx = 8, ny = 6, pitch = 0.01 }

[[points]]
position = [-0.02, 0.0, 0.1]
pressure = 1900.0

[[points]]
position = [0.015, 0.01, 0.1]
pressure = 1700.0

[solver]
name = "greedy"
phases = 8
amplitudes = 2
seed = 5
"""

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("scene.toml").write_text(SCENE, "utf-8")


def midair_process(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Runs the command line in a process of its own."""
    command = [sys.executable, "-m", "midair", *arguments]
    return subprocess.run(command, capture_output=True, encoding="utf-8", timeout=HANG, check=False)


def files() -> set[str]:
    return {path.name for path in Path().iterdir()}


def expected() -> tuple[midair.Scene, midair.Solution]:
    scene = midair.Scene.load("scene.toml")
    return scene, midair.solve(scene)


@pytest.mark.slow
def test_module_and_script_are_the_same_program() -> None:
    script = Path(sys.executable).with_name("midair")
    ran = midair_process("solve", "scene.toml")
    assert (ran.returncode, ran.stderr) == (0, "")
    assert "greedy" in ran.stdout
    version = subprocess.run([script, "--version"], capture_output=True, encoding="utf-8", timeout=HANG, check=True)
    assert version.stdout == midair_process("--version").stdout == midair.__version__ + "\n"
    assert files() == {"scene.toml"}


@pytest.mark.parametrize("command", ["", "new", "solve", "compare", "solvers", "presets"])
def test_help_names_every_option(run: Run, command: str) -> None:
    status, out, err = run(*command.split(), "--help")
    words = {
        "": ["solve", "compare", "solvers", "presets"],
        "solve": ["--solver", "--output", "-o", "--image", "--quantity", "--balance", "--aim"],
        "compare": ["--solvers", "--image", "--quantity", "--balance"],
    }
    assert (status, err) == (0, "")
    for word in ["Usage", *words.get(command, [])]:
        assert word in out


def test_solvers_are_listed_with_options_and_defaults(run: Run) -> None:
    status, out, _ = run("solvers")
    assert status == 0
    for name, info in midair.solvers().items():
        assert any(line.split()[:1] == [name] for line in out.splitlines())
        own = run("solvers", name)[1]
        for option, about in info.options.items():
            assert any(line.split()[:2] == [option, str(about.default)] for line in own.splitlines())
    # Beside an option's default, the table shows the value that AUTD3's quantization gives.
    rows = [line.split()[:5] for line in run("solvers", "greedy")[1].splitlines()]
    assert ["phases", "16", "(autd3", "256)"] in [row[:4] for row in rows]
    assert ["amplitudes", "1", "(autd3", "16)"] in [row[:4] for row in rows]


def test_presets_are_listed_with_their_counts(run: Run) -> None:
    status, out, _ = run("presets")
    assert status == 0
    for name, info in midair.presets().items():
        assert any(line.split()[:2] == [name, str(info.count)] for line in out.splitlines())


def test_solve_prints_the_metrics_and_writes_nothing_unasked(run: Run) -> None:
    status, out, err = run("solve", "scene.toml")
    assert (status, err, files()) == (0, "", {"scene.toml"})
    sentence, _, header, _, row, _, _ = out.strip().splitlines()
    _, solution = expected()
    points = int(np.count_nonzero(solution.targets))
    assert sentence.startswith(f"{points} points at ")
    assert f"with {np.count_nonzero(solution.drive)} transducers, within " in sentence
    assert row.split()[:6] == ["greedy", *(f"{numbers(solution.metrics)[name]:.4f}" for name in METRICS[:5])]
    assert header.split()[:6] == ["solver", *METRICS[:5]]
    assert row.split()[-1] == "missed"


def test_options_on_the_command_line_win_over_the_file(run: Run) -> None:
    run("solve", "scene.toml", "-o", "a.npz", "--phases", "4", "--objective", "l1", "--balance")
    drive = midair.solve(midair.Scene.load("scene.toml"), phases=4, objective="l1", balance=True).drive
    assert same_bits(np.load("a.npz")["drive"], drive)
    run("solve", "scene.toml", "-o", "b.npz", "--solver", "naive", "--limit", "full")
    drive = midair.solve(midair.Scene.load("scene.toml"), "naive", limit="full").drive
    assert same_bits(np.load("b.npz")["drive"], drive)


def test_order_may_be_a_permutation(run: Run) -> None:
    order = [*range(47, -1, -1)]
    status, _, err = run("solve", "scene.toml", "-o", "a.npz", "--order", str(order))
    assert (status, err) == (0, "")
    assert same_bits(np.load("a.npz")["drive"], midair.solve(midair.Scene.load("scene.toml"), order=order).drive)
    Path("two.toml").write_text(
        SCENE.replace("nx = 8, ny = 6", "nx = 2, ny = 1").replace("900", "90"), encoding="utf-8"
    )
    assert run("solve", "two.toml", "--order", "[1,0]")[0] == 0


def replayed(text: str) -> midair.Solution:
    Path("replay.json").write_text(text, "utf-8")
    return midair.solve(midair.Scene.load("replay.json"))


def check_record(text: str, scene: midair.Scene, solution: midair.Solution) -> None:
    """Checks that a record names its solver and options, and that its scene gives the same bits again."""
    record = json.loads(text)
    assert (record["version"], record["status"]) == (midair.__version__, "missed")
    assert record["solver"] == {"name": "greedy", **solution.options}
    assert record["solver"]["seed"] == 5
    again = replayed(text)
    assert same_bits(again.drive, solution.drive)
    assert same_bits(again.pressures, solution.pressures)
    assert midair.Scene.load("replay.json").points.tolist() == scene.points.tolist()


def test_npz_holds_the_drive_and_what_it_does(run: Run) -> None:
    status, out, _ = run("solve", "scene.toml", "-o", "drive.npz")
    assert (status, files()) == (0, {"scene.toml", "drive.npz"})
    assert "wrote drive.npz" in out
    scene, solution = expected()
    arrays = {
        "drive": solution.drive,
        "amplitudes": solution.amplitudes,
        "phases": solution.phases,
        "positions": scene.array.positions,
        "points": scene.points,
        "targets": solution.targets,
        "pressures": solution.pressures,
    }
    with np.load("drive.npz", allow_pickle=False) as record:
        assert set(record) == {*arrays, *METRICS, "scale", "steps", "elapsed", "scene", "scene_solver"}
        for name, array in arrays.items():
            assert same_bits(record[name], array)
        assert {name: float(record[name]) for name in METRICS} == numbers(solution.metrics)
        check_record(str(record["scene"]), scene, solution)


def test_json_holds_the_same_as_plain_numbers(run: Run) -> None:
    assert run("solve", "scene.toml", "--output", "drive.json")[0] == 0
    assert files() == {"scene.toml", "drive.json"}
    scene, solution = expected()
    record = json.loads(Path("drive.json").read_text("utf-8"))
    reals = ["amplitudes", "phases", "positions", "points", "targets"]
    others = {"scale", "steps", "elapsed", "scene", "scene_solver"}
    assert set(record) == {"drive", "pressures", *reals, *METRICS, *others}
    for name in ("drive", "pressures"):
        pairs = np.array(record[name])
        assert pairs.shape == (len(getattr(solution, name)), 2)
        assert same_bits((pairs[:, 0] + 1j * pairs[:, 1]).astype(np.complex64), getattr(solution, name))
    for name in reals:
        source = {"positions": scene.array, "points": scene}.get(name, solution)
        assert same_bits(np.array(record[name]), getattr(source, name))
    assert {name: record[name] for name in METRICS} == numbers(solution.metrics)
    assert isinstance(record["scene"], str)
    check_record(record["scene"], scene, solution)


def test_csv_has_a_row_for_each_transducer(run: Run) -> None:
    assert run("solve", "scene.toml", "-o", "DRIVE.CSV")[0] == 0
    scene, solution = expected()
    text = Path("DRIVE.CSV").read_text("utf-8")
    assert text.startswith("index,x,y,z,amplitude,phase\n0,")
    header, *rows = csv.reader(text.splitlines())
    assert header == ["index", "x", "y", "z", "amplitude", "phase"]
    values = np.array(rows, dtype=float)
    assert [row[0] for row in rows] == [str(i) for i in range(48)]
    assert same_bits(values[:, 1:4].copy(), scene.array.positions)
    assert same_bits(values[:, 4].copy(), solution.amplitudes)
    assert same_bits(values[:, 5].copy(), solution.phases)


def test_a_file_that_was_there_is_replaced_whole(run: Run) -> None:
    Path("drive.csv").write_text("old\n" * 10000, "utf-8")
    assert run("solve", "scene.toml", "-o", "drive.csv")[0] == 0
    assert len(Path("drive.csv").read_text("utf-8").splitlines()) == 49
    assert files() == {"scene.toml", "drive.csv"}


def test_names_are_reported_as_they_are(run: Run) -> None:
    for name in ("a[bold].csv", "b[red].csv", "µ 1 :smile:.json"):
        status, out, err = run("solve", "scene.toml", "-o", name)
        assert (status, err) == (0, "")
        assert out.splitlines()[-1] == f"wrote {name}"
        assert name in files()


def png_size(path: str) -> tuple[int, int]:
    content = Path(path).read_bytes()
    assert content.startswith(b"\x89PNG\r\n\x1a\n")
    assert content.rstrip().endswith(b"IEND\xaeB`\x82")
    return struct.unpack(">II", content[16:24])


@pytest.mark.slow
def test_image_is_a_picture_of_sane_size(run: Run) -> None:
    status, _, err = run("solve", "scene.toml", "--image", "field.png")
    assert (status, err, files()) == (0, "", {"scene.toml", "field.png"})
    width, height = png_size("field.png")
    assert 600 < height < width < 4000
    run("solve", "scene.toml", "--image", "field.svg")
    assert "<svg" in Path("field.svg").read_text("utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("quantity", ["pressure", "radiation", "spl", "phase"])
def test_images_count_the_scale_in_and_show_the_quantity_requested(
    run: Run, monkeypatch: pytest.MonkeyPatch, quantity: str
) -> None:
    board = "grid = { nx = 8, ny = 6, pitch = 0.01 }\nquantization = { phases = 32, amplitudes = [0, 1] }"
    text = SCENE.replace("grid = { nx = 8, ny = 6, pitch = 0.01 }", board).replace("00.0", ".0")
    Path("weak.toml").write_text(text.replace("amplitudes = 2\n", "balance = true\n"), encoding="utf-8")
    figures = []
    monkeypatch.setattr(solve, "write_image", lambda path, figure: figures.append(figure))
    assert run("solve", "weak.toml", "--image", "a.png", "--quantity", quantity)[0] == 0
    assert run("compare", "weak.toml", "--solvers", "greedy", "--image", "a.png", "--quantity", quantity)[0] == 0
    with pytest.warns(midair.SceneWarning, match="scale"):
        solution = midair.solve(midair.Scene.load("weak.toml"))
    field = midair.field(solution.scene, solution)
    assert np.abs(field.pressure).max() < 100
    for figure in figures:
        image, *others = (image for ax in figure.axes for image in ax.images)
        values = np.asarray(image.get_array())
        if quantity == "pressure":
            assert values == pytest.approx(np.abs(field.pressure), rel=1e-6)
        elif quantity == "radiation":
            assert values == pytest.approx(field.radiation * 1e3, rel=1e-6)
        else:
            # All panels of a figure have one scale.
            most = max(np.max(each.get_array()) for each in (image, *others))
            assert image.get_clim()[0] == pytest.approx(-np.pi if quantity == "phase" else most - 60)
    assert run("solve", "weak.toml", "--image", "a.png", "--quantity", "loudness")[0] == 2


@pytest.mark.slow
def test_compare_has_a_line_and_a_panel_for_each_solver(run: Run) -> None:
    status, out, err = run("compare", "scene.toml", "--image", "sheet.png")
    assert (status, files()) == (0, {"scene.toml", "sheet.png"})
    # So few transducers cannot reach the targets: methods that aim at the targets report a miss.
    assert err
    assert all("missed by" in line for line in err.splitlines())
    rows = out.strip().splitlines()[4:-3]
    assert [row.split()[0] for row in rows] == list(midair.solvers())
    width, height = png_size("sheet.png")
    assert 400 < height < 8000
    assert 600 < width < 8000
    # The options in the scene file apply only to its own solver.
    scene = midair.Scene.load("scene.toml")
    for row in rows:
        assert row.split()[1] == f"{midair.solve(scene, row.split()[0]).metrics.accuracy:.4f}"


def test_compare_takes_some_solvers_in_the_order_given(run: Run) -> None:
    status, out, _ = run("compare", "scene.toml", "--solvers", "naive, greedy")
    assert (status, files()) == (0, {"scene.toml"})
    assert [row.split()[0] for row in out.strip().splitlines()[4:-2]] == ["naive", "greedy"]


@pytest.mark.parametrize(("channels", "kept"), [("", 0), (f"channels = {[*range(72)]}\n", 4)])
def test_solve_prints_how_many_beads_the_traps_hold(run: Run, channels: str, kept: int) -> None:
    places = ([0.01, 0, 0], [-0.01, 0, 0], [0, 0.01, 0], [0, -0.01, 0])
    points = "".join(f"[[points]]\nposition = {place}\n" for place in places)
    scene = f'signature = "trap"\n[array]\npreset = "tinylev"\n{channels}{points}'
    Path("traps.toml").write_text(scene, encoding="utf-8")
    assert f"traps hold {kept} of 4 beads of 2 mm and 29 kg/m3\n" in run("solve", "traps.toml")[1]
    Path("foci.toml").write_text(scene.replace("trap", "focus").replace("signature", "#"), encoding="utf-8")
    assert "beads" not in run("solve", "foci.toml")[1]


def test_leak_is_reported_where_there_are_quiet_points(run: Run) -> None:
    Path("quiet.toml").write_text(SCENE.replace("pressure = 1700.0", "pressure = 0"), encoding="utf-8")
    leak = midair.solve(midair.Scene.load("quiet.toml")).metrics.leak
    out = run("solve", "quiet.toml")[1]
    assert "leak" in out
    assert f"{leak:.4f}" in out
    assert "leak" not in run("solve", "scene.toml")[1]


def test_weak_targets_are_warned_of_in_one_line(run: Run) -> None:
    Path("weak.toml").write_text(SCENE.replace("00.0", ".0"), encoding="utf-8")
    for _ in range(2):
        status, out, err = run("solve", "weak.toml", "-o", "drive.csv")
        assert status == 0
        assert err.startswith("warning: ")
        assert len(err.splitlines()) == 1
        assert "greedy" in out
    assert run("solve", "weak.toml", "--balance")[2] == ""
    assert run("solve", "weak.toml", "--no-balance")[2] != ""
    assert "drive.csv" in files()


def test_progress_is_shown_only_of_what_takes_over_a_second(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = []
    monkeypatch.setattr(progress.Progress, "start", lambda self: drawn.append(self))
    assert run("solve", "scene.toml")[0] == 0
    assert not drawn
    clock = iter(range(10**6))
    monkeypatch.setattr(progress.time, "monotonic", lambda: float(next(clock)))
    status, out, _ = run("solve", "scene.toml")
    assert (status, "greedy" in out) == (0, True)
    assert drawn
    assert drawn[0].console.stderr


LONG = """
from midair._cli import main, solve as module
solve = module.solve
def reported(*arguments, **options):
    print("ready", flush=True)
    return solve(*arguments, **options)
module.solve = reported
main({arguments!r})
"""


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_and_sigterm_write_the_whole_file_of_what_was_found(number: signal.Signals) -> None:
    # 40,000 steps of some milliseconds: a program that ends within HANG was stopped between steps.
    Path("long.toml").write_text(
        SCENE.replace("nx = 8, ny = 6, pitch = 0.01", "nx = 200, ny = 200, pitch = 0.005"), encoding="utf-8"
    )
    arguments = ["solve", "long.toml", "--phases", "4096", "--amplitudes", "256", "-o", "drive.json"]
    arguments += ["--image", "field.png"]
    command = [sys.executable, "-c", LONG.format(arguments=arguments)]
    child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8")
    try:
        assert child.stdout.readline() == "ready\n"
        child.send_signal(number)
        out, err = child.communicate(timeout=HANG)
    finally:
        child.kill()
        child.wait()
    assert child.returncode == 128 + number
    assert "Traceback" not in err
    assert "stopped" in out
    record = json.loads(Path("drive.json").read_text("utf-8"))
    assert json.loads(record["scene"])["status"] == "stopped"
    drive = np.array(record["drive"])
    assert drive.shape == (40000, 2)
    assert 0 < np.count_nonzero(np.abs(drive).sum(axis=1)) < 40000
    assert not [name for name in files() if name.endswith(".part")]
