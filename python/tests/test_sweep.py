"""Sweeps: the same numbers in any order of computation, and one row per problem."""

import csv
import json
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
import zarr

import midair
from midair._sweep import block, engine, work
from midair._sweep.request import read
from scenes import METRICS
from sweeps import REQUESTED, SCENE, changed, equal


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_the_table_has_a_row_for_each_problem_in_order() -> None:
    table = midair.sweep(REQUESTED)
    assert list(table) == [
        *("index", "array", "transducers", "points", "solver", "phases", "balance", "trial"),
        *METRICS,
        "status",
    ]
    assert table["index"].tolist() == list(range(2 * 2 * 3 * 5))
    assert table["transducers"].tolist() == [400] * 30 + [64] * 30
    assert table["points"].tolist() == ([2] * 15 + [5] * 15) * 2
    assert table["phases"].tolist() == ([8] * 5 + [16] * 5 + [None] * 5) * 4
    assert table["trial"].tolist() == list(range(5)) * 12
    assert set(table["status"]) == {"done", "missed"}


def test_a_row_is_what_solve_gives_for_its_scene() -> None:
    drives = Path("drives.zarr")
    table = midair.sweep(REQUESTED, drives=drives)
    group = zarr.open(drives, mode="r")
    for index in (12, 40, 59):
        count, solver = table["points"][index], table["solver"][index]
        array = [midair.Array.preset("paper20"), midair.Array.grid(8, 8, 0.01)][table["array"][index]]
        scene = midair.Scene(array, group["points"][index, :count], group["targets"][index, :count])
        if solver == "greedy":
            # A trial's seed is not in the table, so the accuracy is checked with the stored drive.
            drive = group["drive"][index, : len(array)]
        else:
            solution = midair.solve(scene, "naive", balance=True)
            drive = solution.drive
            assert np.array_equal(drive, group["drive"][index, : len(array)])
            assert solution.metrics.accuracy == table["accuracy"][index]
        # Accuracies in double and single precision agree up to f32 rounding of 400 terms.
        assert midair.judge(scene, drive).accuracy == pytest.approx(table["accuracy"][index], abs=1e-4)
        assert not group["drive"][index, len(array) :].any()
        assert np.isnan(group["points"][index, count:]).all()
        assert not group["targets"][index, count:].any()


def test_every_solver_gets_the_same_points_and_every_trial_its_own() -> None:
    midair.sweep(changed(array={"preset": "paper20"}), drives="drives.zarr")
    points = zarr.open("drives.zarr", mode="r")["points"][:15, :2].reshape(3, 5, 2, 3)
    assert (points[0] == points[1]).all()
    assert (points[0] == points[2]).all()
    assert len(np.unique(points[0].reshape(5, -1), axis=0)) == 5
    assert (np.abs(points[..., :2]) <= 0.04).all()
    assert (points[..., 2] == 0.15).all()


def test_a_longer_axis_changes_no_row_that_was_there() -> None:
    few = midair.sweep(changed(array={"preset": "paper20"}))
    points = {**REQUESTED["points"], "count": [5, 7]}
    many = midair.sweep(changed(array={"preset": "paper20"}, seeds=9, points=points))
    for trial in range(5):
        (a,) = few["accuracy"][(few["points"] == 5) & (few["trial"] == trial) & (few["phases"] == 8)]
        (b,) = many["accuracy"][(many["points"] == 5) & (many["trial"] == trial) & (many["phases"] == 8)]
        assert a == b


def test_seeds_may_be_listed() -> None:
    table = midair.sweep(changed(seeds=[7, 2]))
    assert table["trial"].tolist() == [7, 2] * 12
    assert table["accuracy"][1] == midair.sweep(REQUESTED)["accuracy"][2]


def test_threads_and_chunks_change_no_number() -> None:
    whole = midair.sweep(REQUESTED)
    assert equal(midair.sweep(REQUESTED, threads=1), whole)
    for chunk in (1, 2, 7):
        parts: list[dict[str, list[Any]]] = []
        work(read(REQUESTED), None, None, receive=parts.append, chunk=chunk)
        for name in METRICS:
            assert [value for part in parts for value in part[name]] == whole[name].tolist(), (chunk, name)


@pytest.mark.parametrize("scenes", [False, True], ids=["random", "scenes"])
def test_the_batch_solver_takes_what_shares_a_seed(scenes: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    Path("scene.toml").write_text(SCENE, "utf-8")
    names = [{"name": "greedy"}, {"name": "greedy", "seed": 4}, {"name": "gspat"}]
    solvers = [{**name, "balance": True} for name in names]
    request = {"scenes": ["scene.toml"], "solver": solvers, "seeds": 3} if scenes else changed(solver=solvers)
    batch = midair.solve_batch
    taken: list[str] = []

    def watched(array: midair.Array, points: Any, pressures: Any, solver: str, **options: Any) -> Any:
        taken.extend([solver] if len(points) > 1 else [])
        return batch(array, points, pressures, solver, **options)

    monkeypatch.setattr(block._midair, "solve_batch", watched)
    midair.sweep(request, threads=1)
    settings = [part.settings for part in read(request).blocks]
    fresh = {"solver": "greedy", "options": {"balance": True}}
    assert taken == [setting["solver"] for setting in settings if not fresh.items() <= setting.items()]


@pytest.mark.slow
def test_csv_parquet_and_python_agree() -> None:
    table = midair.sweep(REQUESTED, "table.csv")
    with Path("table.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["sigma"]) for row in rows] == table["sigma"].tolist()
    assert [row["phases"] for row in rows[8:12]] == ["16", "16", "", ""]
    midair.sweep(REQUESTED, "table.parquet")
    stored = pq.read_table("table.parquet")
    for name, values in table.items():
        assert stored[name].to_pylist() == values.tolist(), name
    assert not [path for path in Path().iterdir() if path.name.startswith(".")]


def test_scenes_are_swept_relative_to_the_file() -> None:
    Path("scenes").mkdir()
    Path("scenes/two.toml").write_text(SCENE, "utf-8")
    Path("scenes/sweep.json").write_text(
        json.dumps({"scenes": ["two.toml"], "solver": {"name": "lm", "seed": 4}}), encoding="utf-8"
    )
    table = midair.sweep("scenes/sweep.json")
    assert list(table)[:6] == ["index", "scene", "transducers", "points", "solver", "seed"]
    expected = midair.solve(midair.Scene.load("scenes/two.toml"), "lm", seed=4).metrics
    assert table["residual"].tolist() == [expected.residual]


#: An array in the paper's unit, and pressures that it cannot reach or that are weak for it.
PAPER = {"grid": {"nx": 20, "ny": 20, "pitch": 0.01}, "source_pressure": 1e-3}
SHORT: dict[str, tuple[float, str]] = {
    "beyond": (
        500.0,
        r"^24 of 24 problems request more pressure than the array reaches at a point, and get as",
    ),
    "weak": (
        0.1,
        r"^12 of 24 problems request less than half the balanced level: .*, balance = true cures it$",
    ),
}


@pytest.mark.parametrize("name", SHORT)
def test_too_much_and_too_little_is_reported_once_with_counts(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    pressure, words = SHORT[name]
    # gspat solves problems as a batch, greedy one by one with a seed each. The second run reads stored
    # results.
    solvers = [{"name": "gspat"}, {"name": "greedy"}, {"name": "greedy", "balance": True}]
    points = {**REQUESTED["points"], "count": 3, "pressure": [0.9 * pressure, pressure]}
    request = changed(array=PAPER, points=points, solver=solvers[: 3 if name == "beyond" else 2])
    request["seeds"] = 8 if name == "beyond" else 12
    monkeypatch.setattr(engine, "remove", lambda folder: None)
    for _ in range(2):
        with pytest.warns(midair.SceneWarning) as reported:
            midair.sweep(request, "table.csv")
        assert len(reported) == 1
        assert re.match(words, str(reported[0].message))


def test_balanced_and_even_methods_are_not_weak() -> None:
    solvers = [{"name": "greedy", "balance": True}, {"name": "uniform"}, {"name": "best"}]
    points = {**REQUESTED["points"], "count": 3, "pressure": 0.1}
    midair.sweep(changed(array=PAPER, points=points, solver=solvers))


DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS.joinpath("sweeps.md").read_text("utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def sane(table: dict[str, np.ndarray]) -> bool:
    """Returns whether the metrics are near the targets and every method ran to its end."""
    near = [(table[name] > 0.5) & (table[name] < 1.5) for name in ("accuracy", "level")]
    return bool(np.all(near)) and set(table["status"]) <= {"done", "missed"}


EXAMPLES = [*blocks("toml"), DOCS.joinpath("sweeps", "dataset.toml").read_text("utf-8")]
PROBLEMS = [4 * 3 * 100, 3 * 2 * 2 * 2 * 5, 100_000]


@pytest.mark.parametrize(
    ("text", "problems"), [*zip(EXAMPLES, PROBLEMS, strict=True)], ids=["first", "axes", "dataset"]
)
def test_the_docs_sweeps_have_sane_numbers(text: str, problems: int) -> None:
    request = tomllib.loads(text)
    assert read(request).problems == problems
    request["seeds"] = 4
    # pytest turns warnings into errors.
    assert sane(midair.sweep(request))


@pytest.mark.parametrize("text", [text for text in blocks("python") if "midair.sweep" in text])
def test_the_docs_python_has_sane_numbers(text: str) -> None:
    names: dict[str, Any] = {"midair": midair}
    exec(text, names)
    assert sane(names["table"])
