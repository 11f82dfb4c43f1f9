"""Data sets: the content of their files, the held-out split, resuming after a stop, judging,
error messages.
"""

import json
import os
import re
import shutil
import warnings
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pyarrow import parquet

import midair
from midair._cli.sweep import drives_of
from midair._sweep import shards

pytest.importorskip("pyarrow")

REQUEST: dict[str, Any] = {
    "array": {"preset": "sonicsurface"},
    "points": {"count": [2, 3], "x": [-0.04, 0.04], "y": [-0.04, 0.04], "z": [0.1, 0.15], "pressure": 900.0},
    "solver": {"name": "fast"},
    "seeds": 40,
}


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shards, "SHARD", 16)


def whole(made: midair.Dataset, split: str, count: int) -> dict[str, Any]:
    """Returns all rows of a split that have this number of points."""
    parts = [part for part in made.read(split) if part["points"].shape[1] == count]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


@pytest.mark.usefixtures("small")
def test_rows_are_those_of_the_same_sweep_and_of_a_solve(tmp_path: Path) -> None:
    made = midair.dataset(REQUEST, tmp_path / "scenes")
    request = {**REQUEST, "solver": {"name": "fast", "seed": 0}}
    table = midair.sweep(request)
    for count in (2, 3):
        parts = {split: whole(made, split, count) for split in ("train", "held_out")}
        assert parts["held_out"]["trial"].tolist() == [9, 19, 29, 39]
        assert sorted([*parts["train"]["trial"], *parts["held_out"]["trial"]]) == list(range(40))
        for part in parts.values():
            chosen = (table["points"] == count) & np.isin(table["trial"], part["trial"])
            assert part["accuracy"].tolist() == table["accuracy"][chosen].tolist()
            assert part["drive"].shape == (len(part["trial"]), 256)
        one = parts["train"]
        scene = midair.Scene(made.array, one["points"][5], one["targets"][5])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", midair.SceneWarning)  # the board has few amplitudes
            solution = midair.solve(scene, "fast", seed=0)
        assert (solution.drive == one["drive"][5]).all()
        assert (solution.pressures == one["pressures"][5]).all()
        assert one["status"][5] == solution.status


@pytest.mark.usefixtures("small")
def test_a_set_that_was_stopped_goes_on_and_ends_alike(tmp_path: Path) -> None:
    first = midair.dataset(REQUEST, tmp_path / "first")

    def stop(done: int, scenes: int) -> None:
        if done >= 32:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        midair.dataset(REQUEST, tmp_path / "second", threads=1, progress=stop)
    kept = {file.name: file.stat().st_mtime_ns for file in (tmp_path / "second").glob("*.parquet")}
    second = midair.dataset(REQUEST, tmp_path / "second")
    names = sorted(path.name for path in first.folder.iterdir())
    assert names == sorted(path.name for path in second.folder.iterdir())
    assert 0 < len(kept) < len(names)
    for name in names:
        assert (first.folder / name).read_bytes() == (second.folder / name).read_bytes(), name
    assert all((tmp_path / "second" / name).stat().st_mtime_ns == then for name, then in kept.items())


def test_drives_are_judged_by_the_scenes_kept_out(tmp_path: Path) -> None:
    made = midair.dataset(REQUEST, tmp_path / "scenes")
    own = np.concatenate([part["drive"] * part["scale"][:, None] for part in made.read("held_out")])
    judged = made.judge(own)
    for name in ("accuracy", "sigma", "level"):
        assert judged[name] == pytest.approx(judged[f"reference_{name}"], abs=1e-4), name
    worse = made.judge(own * 0.5)
    assert worse["level"] == pytest.approx(0.5 * judged["level"], rel=1e-3)
    with pytest.raises(midair.SceneError, match=r"shape \(7, 256\): give \(8, 256\)"):
        made.judge(own[:7])


def test_bounds_are_above_the_levels(tmp_path: Path) -> None:
    request = {**REQUEST, "seeds": 10, "points": {**REQUEST["points"], "count": 2}}
    made = midair.dataset(request, tmp_path / "scenes", bounds=True)
    part = whole(made, "train", 2)
    assert (part["bound"] > part["level"]).all()


REFUSED = [
    ({"solver": [{"name": "fast"}, {"name": "naive"}]}, "2 methods: give one"),
    ({"array": [{"preset": "sonicsurface"}, {"preset": "paper20"}]}, "transducers: give arrays of one size"),
    ({"points": {"positions": [[0, 0, 0.1]]}}, "fixed points: give points.count"),
    ({"seeds": 0}, "seeds is 0"),
]


@pytest.mark.parametrize(("change", "said"), REFUSED)
def test_a_request_that_makes_no_set_is_refused(tmp_path: Path, change: dict[str, Any], said: str) -> None:
    with pytest.raises(midair.SceneError, match=re.escape(said)):
        midair.dataset({**REQUEST, **change}, tmp_path / "scenes")
    assert not (tmp_path / "scenes").exists()


def test_nobodys_files_are_replaced(tmp_path: Path) -> None:
    request = {**REQUEST, "seeds": 10}
    (tmp_path / "notes.txt").write_text("mine", "utf-8")
    with pytest.raises(midair.SceneError, match="holds other files"):
        midair.dataset(request, tmp_path)
    with pytest.raises(midair.SceneError, match="is a file"):
        midair.dataset(request, tmp_path / "notes.txt")
    midair.dataset(request, tmp_path / "scenes")
    with pytest.raises(midair.SceneError, match="holds another data set"):
        midair.dataset({**request, "seeds": 11}, tmp_path / "scenes")
    with pytest.raises(midair.SceneError, match="is no data set"):
        midair.Dataset(tmp_path)
    (tmp_path / "scenes" / "dataset.json").write_text("{", "utf-8")
    with pytest.raises(midair.SceneError, match="is damaged"):
        _ = midair.Dataset(tmp_path / "scenes").array
    assert (tmp_path / "notes.txt").read_text("utf-8") == "mine"


def test_the_manifest_says_what_is_in_it(tmp_path: Path) -> None:
    made = midair.dataset({**REQUEST, "seeds": 20}, tmp_path / "scenes")
    manifest = json.loads((made.folder / "dataset.json").read_text("utf-8"))
    assert manifest["scenes"] == 40
    assert [block["count"] for block in manifest["blocks"]] == [2, 3]
    with pytest.raises(midair.SceneError, match='"test": give "train" or "held_out"'):
        made.files("test")


@pytest.fixture(scope="module")
def few(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return midair.dataset({**REQUEST, "seeds": 20}, tmp_path_factory.mktemp("sets") / "few").folder


@pytest.fixture
def copied(few: Path, tmp_path: Path) -> Path:
    shutil.copytree(few, tmp_path / "set")
    return tmp_path / "set"


FILE = "held_out-0000-00000.parquet"


@pytest.mark.slow
def test_a_changed_bit_of_a_file_is_found_and_the_file_made_anew(copied: Path) -> None:
    file = copied / FILE
    whole, alike = file.read_bytes(), next(midair.Dataset(copied).read("held_out"))
    places = [*range(0, len(whole), 97), *range(len(whole) - 400, len(whole), 7)]
    for place in places:
        file.write_bytes(whole[:place] + bytes([whole[place] ^ 4]) + whole[place + 1 :])
        with suppress(midair.SceneError):
            content = next(midair.Dataset(copied).read("held_out"))
            assert all(np.array_equal(content[name], alike[name]) for name in alike), place
    file.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(midair.SceneError, match=f'{FILE}" is damaged: the call that made'):
        midair.Dataset(copied).judge(np.zeros((4, 256)))
    midair.dataset({**REQUEST, "seeds": 20}, copied)
    assert file.read_bytes() == whole


def test_a_file_of_another_build_is_made_anew(copied: Path) -> None:
    file = copied / FILE
    whole, table = file.read_bytes(), parquet.read_table(file)
    other = {**table.schema.metadata, b"midair": b"another build"}
    parquet.write_table(table.replace_schema_metadata(other), file)
    midair.dataset({**REQUEST, "seeds": 20}, copied)
    assert file.read_bytes() == whole


@pytest.mark.parametrize("name", [FILE, "train-0001-00000.parquet"])
def test_a_file_that_is_missing_is_named_and_made_anew(copied: Path, name: str) -> None:
    whole = (copied / name).read_bytes()
    (copied / name).unlink()
    with pytest.raises(midair.SceneError, match=re.escape(f'{name}" is missing: the call that made')):
        list(midair.Dataset(copied).read(name.partition("-")[0]))
    midair.dataset({**REQUEST, "seeds": 20}, copied)
    assert (copied / name).read_bytes() == whole


def test_a_part_without_scenes_has_empty_arrays(tmp_path: Path) -> None:
    made = midair.dataset({**REQUEST, "seeds": 3}, tmp_path / "scenes")
    assert [part["points"].shape for part in made.read("held_out")] == [(0, 2, 3), (0, 3, 3)]


@pytest.mark.parametrize(
    "text",
    ['{"blocks":[],"scenes":1}', '{"blocks":[{}],"scenes":1}', "[{}]", "5", "[" * 100_000, "{", "\xff"],
)
def test_a_manifest_of_odd_content_is_refused(copied: Path, text: str) -> None:
    (copied / "dataset.json").write_bytes(text.encode("latin-1"))
    opened = midair.Dataset(copied)
    for ask in (lambda: opened.manifest, lambda: opened.array, lambda: list(opened.read())):
        with pytest.raises(midair.SceneError, match="is damaged: make the data set anew"):
            ask()


@pytest.mark.parametrize("drives", [[[1], [2, 3]], None, [], [["a"]], np.zeros((3, 256))])
def test_drives_of_another_form_are_refused(few: Path, drives: Any) -> None:
    with pytest.raises(midair.SceneError, match=r"^drives .*give \(4, 256\), a row for each held-out scene$"):
        midair.Dataset(few).judge(drives)


def test_a_pipe_of_drives_is_refused(few: Path, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(midair.SceneError, match="cannot be read as drives"):
        drives_of(tmp_path / "pipe")
