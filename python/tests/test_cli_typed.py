"""The command line without a scene file, lists with one value, JSON output,
and a template of a scene file.
"""

import csv
import json
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import midair
from scenes import METRICS

AT = ["--at", "0,0,0.15", "--at", "-0.02,0,0.15"]

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_the_line_that_solves_a_new_scene_can_be_typed(run: Run) -> None:
    mark = '"' if os.name == "nt" else "'"
    line = f"wrote mes scènes.toml; solve it with: midair solve {mark}mes scènes.toml{mark}\n"
    assert run("new", "mes scènes.toml")[:2] == (0, line)


def test_a_new_scene_solves_well_and_replaces_nothing(run: Run) -> None:
    assert run("new")[:2] == (0, "wrote scene.toml; solve it with: midair solve scene.toml\n")
    text = Path("scene.toml").read_text("utf-8")
    assert run("new", "-") == (0, text, "")
    status, out, err = run("solve", "scene.toml", "--json")
    assert (status, err) == (0, "")
    assert json.loads(out)["level"] > 0.99
    # The lines of the template that are commented out are valid, too.
    lines = [line.removeprefix("# ").split("  #")[0] for line in text.splitlines()]
    for key in (
        "source_pressure",
        "directivity",
        "aim",
        "temperature",
        "absorption",
        "z = ",
        "grid",
        "[plane]",
    ):
        assert any(line.startswith(key) for line in lines), key
    Path("link.toml").symlink_to("nowhere.toml")
    for name in ("scene.toml", "link.toml", "none/scene.toml", "scene.txt", "."):
        status, out, err = run("new", name)
        assert (status, out, len(err.splitlines())) == (2, "", 1)
    assert Path("scene.toml").read_text("utf-8") == text


def test_a_scene_is_typed_in_one_line(run: Run) -> None:
    array = midair.Array.preset("autd3", (2, 1))
    for tiles, more, pressures in [
        ("2,1", [], None),
        ("2x1", ["--pressure", "800"], 800.0),
        ("2, 1", ["--pressure=900, 500"], [900.0, 500.0]),
    ]:
        scene = midair.Scene(array, [[0, 0, 0.15], [-0.02, 0, 0.15]], pressures)
        status, out, err = run("solve", "--preset", "AUTD-3", "--tiles", tiles, *AT, *more, "--json")
        record = json.loads(out)
        # For so small a pressure, the board's amplitudes are too coarse to meet it within 1 %.
        assert status == 0
        assert not err or err.startswith("warning: the pressures are missed by")
        assert record["points"] == scene.points.tolist()
        assert record["targets"] == midair.solve(scene).targets.tolist()


@pytest.mark.parametrize(
    ("line", "reported"),
    [
        ("", "scene is left out: give a scene file (midair new writes one), or --preset autd3 --at 0,0,0.15"),
        ("--preset autd3", "--at is left out"),
        ("--at 0,0,0.1", "--preset is left out"),
        ("--preset autd4 --at 0,0,0.1", 'unknown preset "autd4": did you mean autd3?'),
        ("--preset autd3 --at 0,0", '--at is "0,0": give three numbers in m, such as --at 0,0,0.15'),
        ("--preset autd3 --at 0,0,up", '--at is "0,0,up"'),
        ("--preset autd3 --at 0,0,nan", '--at is "0,0,nan"'),
        ("--preset autd3 --at", "--at has no value: write one after it. See midair solve --help"),
        ("--preset autd3 --at 0 0 0.15", '"0.15" belongs to no option: leave it out'),
        ("--preset autd3 --at 0,0,0.1 --pressure -5", "points[0].pressure is -5.0"),
        ("--preset autd3 --at 0,0,0.1 --pressure 1,2", '--pressure is "1,2": give one pressure in Pa'),
        ("--preset autd3 --at 0,0,0.1 --pressure loud", '--pressure is "loud"'),
        ("--preset autd3 --at 0,0,0.1 --tiles 2", '--tiles is "2": give boards along x and y'),
        ("--preset autd3 --at 0,0,0.1 --tiles 1.5,1", "--tiles is 1.5,1: give whole numbers"),
        ("--preset autd3 --at 0,0,0.1 --tiles -2,2", "tiles"),
        ("--preset paper20 --at 0,0,0.1 --tiles 2,2", "tiles"),
        ("none.toml --at 0,0,0.1", "go without a scene file"),
        ("--preset autd3 --at 0,0,0.1 --json -o -", "both want standard output"),
        ("--preset autd3 --at 0,0,0.1 --image -", '--image is "-": give a file'),
        ("--preset autd3 --at 0,0,0.1 --solver lm --phases 4", 'option of lm "phases": greedy has it; known'),
        ("--preset autd3 --at 0,0,0.1 --solver greedy --Seed 4 --seed 8", "seed is given twice"),
        ("--preset autd3 --at 0,0,0.1 --solver greedy --phases -16", "phases is -16"),
        ("--preset autd3 --at 0,0,0.1 --aim loud", 'aim is "loud": give "target" or "max"'),
        ("--preset autd3 --at 0,0,0.1 --solver unifrom", 'unknown solver "unifrom": did you mean uniform?'),
    ],
)  # fmt: skip
def test_slips_of_the_pen_are_reported_with_their_cure(run: Run, line: str, reported: str) -> None:
    status, out, err = run("solve", *line.split())
    assert (status, out, len(err.splitlines())) == (2, "", 1)
    assert err.startswith("error: ")
    assert reported in err


def test_names_are_typed_as_one_likes(run: Run) -> None:
    line = ["solve", "--preset", "Autd_3", *AT, "--solver", "GREEDY", "--Objective", "L-1", "--json"]
    record = json.loads(run(*line)[1])
    assert (record["solver"], record["options"]["objective"]) == ("greedy", "l1")
    assert json.loads(run("solve", "--preset", "autd3", *AT, "--aim", "MAX", "--json")[1])["options"]["aim"] == "max"
    assert [*json.loads(run("solvers", "GS-PAT", "--json")[1])] == ["gspat"]


def test_solve_tells_a_program_what_it_tells_people(run: Run) -> None:
    status, out, _ = run("solve", "--preset", "autd3", *AT, "--pressure", "900", "--json", "-o", "drive.json")
    record, written = json.loads(out), json.loads(Path("drive.json").read_text("utf-8"))
    assert status == 0
    assert {key: record[key] for key in record.keys() & written.keys()} == {
        key: written[key] for key in record.keys() & written.keys()
    }
    assert record.keys() & written.keys() >= {*METRICS, "scale", "points", "targets", "pressures"}
    assert (record["solver"], record["status"]) == ("uniform", "done")
    assert record["elapsed"] > 0


def test_lists_and_one_of_them_in_full(run: Run) -> None:
    solvers = json.loads(run("solvers", "--json")[1])
    assert [*solvers] == [*midair.solvers()]
    for name, info in midair.solvers().items():
        reported = {option: (about["default"], about["doc"]) for option, about in solvers[name]["options"].items()}
        assert reported == {option: (about.default, about.doc) for option, about in info.options.items()}
        out = run("solvers", name)[1]
        assert all(f" {option} " in out for option in info.options)
        assert f"midair solve scene.toml --solver {name} --" in out
    presets = json.loads(run("presets", "--json")[1])
    assert [*presets] == [*midair.presets()]
    for name, info in midair.presets().items():
        assert presets[name]["count"] == info.count
        out = run("presets", name)[1]
        assert str(info.count) in out
        assert info.source in out
    for command in ("solvers", "presets"):
        status, out, err = run(command, "nosuch")
        assert (status, out) == (2, "")
        assert "known are" in err


def test_a_comparison_is_a_table_for_programs_too(run: Run) -> None:
    scene = midair.Scene(midair.Array.preset("autd3"), [[0, 0, 0.15], [0.02, 0, 0.15]])
    scene.save("scene.json")
    line = ["compare", "scene.json", "--solvers", "Naive,GS"]
    assert run(*line, "-o", "table.csv")[1].splitlines()[-1] == "wrote table.csv"
    rows = [*csv.DictReader(Path("table.csv").read_text("utf-8").splitlines())]
    assert [row["solver"] for row in rows] == ["naive", "gs"]
    for row in rows:
        assert np.isclose(float(row["accuracy"]), midair.solve(scene, row["solver"]).metrics.accuracy, rtol=1e-12)
    record = json.loads(run(*line, "--json", "-o", "table.json")[1])
    assert [row["solver"] for row in record["solvers"]] == ["naive", "gs"]
    assert record["bound"] == midair.bound(scene)
    assert json.loads(Path("table.json").read_text("utf-8")) == record
    assert run(*line, "-o", "-")[1].startswith("solver,accuracy,")
    for more, reported in [("-o table.txt", ".csv or .json"), ("-o - --json", "both want standard output")]:
        status, _, err = run(*line, *more.split())
        assert (status, reported in err) == (2, True)
