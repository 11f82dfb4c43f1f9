"""docs/*.schema.json: made from the core's tables of keys, and valid for all scene files and sweeps."""

import importlib
import json
import re
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
SCHEMA = json.loads((ROOT / "docs" / "scene.schema.json").read_text("utf-8"))

sys.path.insert(0, str(ROOT / "book"))
schema = importlib.import_module("schema")
sys.path.pop(0)

TYPES = {
    "boolean": bool,
    "string": str,
    "integer": int,
    "number": (int, float),
    "array": list,
    "object": dict,
}


def faults(value: Any, wanted: dict[str, Any], path: str = "") -> list[str]:
    """Returns the faults of a value, for the keywords of JSON Schema that the schemas use."""
    if "anyOf" in wanted:
        each = [faults(value, one, path) for one in wanted["anyOf"]]
        return [] if [] in each else each[0]
    kind = wanted["type"]
    if not isinstance(value, TYPES[kind]) or (isinstance(value, bool) and kind != "boolean"):
        return [f"{path} is no {kind}"]
    found = []
    if kind == "array":
        if not wanted.get("minItems", 0) <= len(value) <= wanted.get("maxItems", len(value)):
            found.append(f"{path} has {len(value)} items")
        for k, one in enumerate(value):
            found += faults(one, wanted["items"], f"{path}[{k}]")
    if kind == "object":
        for key, one in value.items():
            other = wanted.get("additionalProperties", True)
            rule = wanted.get("properties", {}).get(key, other)
            if rule is False:
                found.append(f"{path}.{key} is unknown")
            elif rule is not True:
                found += faults(one, rule, f"{path}.{key}")
    return found


def documents() -> list[tuple[str, str]]:
    """Returns the scene files of docs/scenes and those in the pages, with their names."""
    found = [(file.name, file.read_text("utf-8")) for file in sorted((ROOT / "docs" / "scenes").glob("*.toml"))]
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]:
        blocks = re.findall(r"^```toml\n(.*?)^```", page.read_text("utf-8"), re.MULTILINE | re.DOTALL)
        scenes = [block for block in blocks if "[array]" in block and "[[solver]]" not in block]
        found += [(f"{page.relative_to(ROOT)}, {k + 1}", block) for k, block in enumerate(scenes)]
    return found


def test_it_is_what_the_cores_table_says() -> None:
    for name, content in schema.WRITTEN.items():
        assert content() == (ROOT / name).read_text("utf-8"), "run `make generated`"


def test_every_key_has_its_meaning_on_one_line() -> None:
    for table, keys in [*schema.tables().items(), *schema.sweep_keys().items()]:
        for key, (_, about) in keys.items():
            assert about.endswith("."), f"{table}.{key}"
            assert "\n" not in about, f"{table}.{key}"


@pytest.mark.parametrize(("name", "text"), documents(), ids=[name for name, _ in documents()])
def test_scene_files_fit(name: str, text: str) -> None:
    assert faults(tomllib.loads(text), SCHEMA) == []


@pytest.mark.parametrize(
    "text",
    [
        "[array]\nquantization = { pulses = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9] }",
        "[[obstacles]]\nfile = 'hand.stl'\nrotation = [1.0, 0.0, 0.0, 0.0]",
        "[[motion.path]]\nkind = 'still'\nam = { samples = [1.0, 0.0], samples_rate = 400 }",
    ],
)
def test_lists_of_another_length_than_their_example_fit(text: str) -> None:
    assert faults(tomllib.loads(text), SCHEMA) == []


def sweeps() -> list[tuple[str, str]]:
    """Returns the sweep files of docs/sweeps and those in the pages, with their names."""
    found = [(file.name, file.read_text("utf-8")) for file in sorted((ROOT / "docs" / "sweeps").glob("*.toml"))]
    for page in sorted((ROOT / "docs").rglob("*.md")):
        blocks = re.findall(r"^```toml\n(.*?)^```", page.read_text("utf-8"), re.MULTILINE | re.DOTALL)
        found += [(f"{page.name}, {k + 1}", block) for k, block in enumerate(blocks) if "[[solver]]" in block]
    return found


@pytest.mark.parametrize(("name", "text"), sweeps(), ids=[name for name, _ in sweeps()])
def test_sweep_files_fit(name: str, text: str) -> None:
    assert faults(tomllib.loads(text), schema.sweep_schema()) == []


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("sedes = 3", ".sedes is unknown"),
        ("seeds = '3'", ".seeds is no integer"),
        ("[points]\ncuont = 3", ".points.cuont is unknown"),
        ("[medium]\ntemperature = ['cold']", ".medium.temperature is no number"),
    ],
)
def test_faults_of_sweep_files_are_found(text: str, fault: str) -> None:
    assert fault in faults(tomllib.loads(text), schema.sweep_schema())


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("[array]\nprest = 'autd3'", ".array.prest is unknown"),
        ("[medium]\nfrequency = '40 kHz'", ".medium.frequency is no number"),
        ("[[points]]\nposition = [0, 0.15]", ".points[0].position has 2 items"),
        ("[array]\ngrid = { nx = 2.5, ny = 2, pitch = 0.01 }", ".array.grid.nx is no integer"),
        ("[array]\nmask = [1, 0]", ".array.mask[0] is no boolean"),
    ],
)
def test_faults_are_found(text: str, fault: str) -> None:
    assert fault in faults(tomllib.loads(text), SCHEMA)
