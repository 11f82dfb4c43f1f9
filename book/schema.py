"""Makes JSON Schemas and fuzzing dictionaries of scene files and sweeps from the core's keys:
`make generated`.
"""

import json
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from marked import table
from midair._cli.app import TABLES
from midair._midair import directivities, scene_keys, sweep_keys

ROOT = Path(__file__).parents[1]

#: The directivities that have a name, each with its formula.
DIRECTIVITIES = {name: about for name, (_, _, about) in directivities().items()}
#: Values for the fuzzing dictionary: names, extreme numbers, booleans, null.
VALUES = ['"autd3"', '"paper20"', "[1, 2]", '"max"', '"full"', '"all"', "true", "null"]
VALUES += ["inf", "nan", "-0.0", "1e308", "9223372036854775808"]
HEAD = {"$schema": "http://json-schema.org/draft-07/schema#"}
#: Ends of the paths of lists of any length, although their example has a few numbers.
FREE = ("array.channels", "array.pins", ".amplitudes", ".pulses", ".samples")
#: Keys that take a number or a list of numbers.
NUMBER_OR_LIST = {"motion.path[].pressures", "motion.path[].size"}
#: Tables that may occur once or several times.
REPEATED = {"shape", "image", "motion.path"}


def tables() -> dict[str, dict[str, tuple[Any, str]]]:
    """Returns the core's keys: by the path of a table, its keys with an example and the meaning of each."""
    found = {
        table: {key: (json.loads(example), about) for key, (example, about) in keys.items()}
        for table, keys in scene_keys().items()
    }
    example, about = found["array"]["directivity"]
    laws = "".join(f" {name}: {formula}." for name, formula in DIRECTIVITIES.items())
    found["array"]["directivity"] = (example, about + laws)
    return found


def of_value(example: Any, free: bool) -> dict[str, Any]:
    """Returns the type of a value like the example; lists of numbers have its length, unless `free`."""
    if isinstance(example, bool):
        return {"type": "boolean"}
    if isinstance(example, str):
        return {"type": "string"}
    if isinstance(example, int | float):
        return {"type": "integer" if isinstance(example, int) else "number"}
    inner = of_value(example[0], free)
    if free or inner["type"] not in ("number", "integer"):
        return {"type": "array", "items": inner}
    return {"type": "array", "items": inner, "minItems": len(example), "maxItems": len(example)}


def of_key(path: str, example: Any, of_table: Callable[[str], dict[str, Any] | None]) -> dict[str, Any]:
    """Returns the schema of a key, whose value may be a table, a list of tables, or a plain value."""
    if path == "motion.ahead":
        return {"anyOf": [{"type": "integer"}, {"type": "string"}]}
    if path in NUMBER_OR_LIST:
        return {"anyOf": [{"type": "number"}, {"type": "array", "items": {"type": "number"}}]}
    if path == "array.directivity":
        parameter = {"type": "object", "additionalProperties": {"type": "number"}, "maxProperties": 1}
        return {"anyOf": [{"type": "string"}, parameter]}
    if path in ("array.rotation", "obstacles[].rotation"):
        return several({"type": "array", "items": {"type": "number"}})
    if path == "array.part":
        return {"type": "array", "items": {"type": "object"}}
    if path == "signature":
        return several({"type": "string"})
    one, many = of_table(path), of_table(f"{path}[]")
    if many:
        listed = {"type": "array", "items": many}
        return {"anyOf": [many, listed]} if path in REPEATED else listed
    if one and not isinstance(example, dict):
        return {"anyOf": [of_value(example, False), one]}
    return one or of_value(example, path.endswith(FREE))


def schema() -> dict[str, Any]:
    """Returns the schema of scene files."""
    known = tables()

    def of_table(table: str) -> dict[str, Any] | None:
        if table not in known:
            return None
        properties = {}
        for key, (example, about) in known[table].items():
            path = f"{table}.{key}" if table else key
            properties[key] = {"description": about, **of_key(path, example, of_table)}
        # Each solver has options of its own.
        return {"type": "object", "properties": properties, "additionalProperties": table == "solver"}

    root = of_table("")
    assert root is not None
    return HEAD | {"title": "Scene file of midair"} | root


def several(rule: dict[str, Any]) -> dict[str, Any]:
    """Returns the schema of a value or a list of such values."""
    return {"anyOf": [rule, {"type": "array", "items": rule}]}


def axes(table: dict[str, Any]) -> dict[str, Any]:
    """Returns the schema of a table in a sweep file, where a list of values is an axis of the sweep."""
    axis = {}
    for key, rule in table["properties"].items():
        one = {name: part for name, part in rule.items() if name != "description"}
        axis[key] = {"description": rule["description"], **several(one)}
    return {"type": "object", "properties": axis, "additionalProperties": False}


def sweep_schema() -> dict[str, Any]:
    """Returns the schema of sweep files: arrays, medium, points and solvers as in a scene file,
    or lists of them.
    """
    scene, number = schema()["properties"], {"type": "number"}
    range_ = {"anyOf": [number, {"type": "array", "items": number, "minItems": 2, "maxItems": 2}]}
    own: dict[str, dict[str, Any]] = {
        "seed": {"type": "integer"},
        "seeds": several({"type": "integer"}),
        "scenes": {"type": "array", "items": {"type": "string"}},
        "array": several(axes(scene["array"])),
        "medium": axes(scene["medium"]),
        "axes": {"type": "object"},
        "solver": several({"type": "object", "properties": {"name": {"type": "string"}}}),
        "count": several({"type": "integer"}),
        "positions": {"type": "array", "items": of_value([0.0, 0.0, 0.0], False)},
        "pressures": of_value([0.0], True),
        "weights": of_value([0.0], True),
        "shift": of_value([0.0, 0.0, 0.0], False),
    } | dict.fromkeys(("x", "y", "z", "pressure"), range_)

    def of_table(table: str) -> dict[str, Any]:
        keys = sweep_keys()[table].items()
        rules = {key: {"description": about, **own[key]} for key, (_, about) in keys}
        return {"type": "object", "properties": rules, "additionalProperties": False}

    own["points"] = {"anyOf": [of_table("points"), scene["points"]]}
    return HEAD | {"title": "Sweep file of midair"} | of_table("")


def text(schema: dict[str, Any]) -> str:
    """Returns a schema as JSON text."""
    return json.dumps(schema, indent=2, ensure_ascii=False) + "\n"


def words(known: dict[str, dict[str, Any]]) -> str:
    """Returns the fuzzing dictionary: tables and keys in TOML and JSON, and values."""
    paths = [path.removesuffix("[]") for path in known if path]
    keys = dict.fromkeys(key for table in known.values() for key in table)
    found = [f"[{path}]" for path in paths] + [f"[[{path}]]" for path in paths]
    found += [f"{key} = " for key in keys] + [f'"{key}":' for key in keys]
    found += VALUES + [f'"{name}"' for name in DIRECTIVITIES]
    return "# Words of scene files.\n" + "".join(f"{json.dumps(word)}\n" for word in found)


def page() -> str:
    """Returns the reference page: a list of keys for each table of a scene file."""
    lines = [
        "# Scene file\n",
        "Every key of a scene file, TOML or JSON, as the core knows them.",
        "[Files](../files.md#scene-files) has a file to begin with and the rules;",
        "[an editor](../editors.md) checks and completes keys by",
        "[scene.schema.json](../scene.schema.json).\n",
    ]
    for path, keys in tables().items():
        rows = (
            (f"`{key}`", about, f"`{json.dumps(example, ensure_ascii=False)}`")
            for key, (example, about) in keys.items()
        )
        lines += [f"## {f'`{path}`' if path else 'The file'}\n", table(("key", "what", "example"), rows)]
    return "\n".join(lines)


SOURCE = ROOT / "python" / "midair" / "_support" / "columns.toml"

COLUMNS = """\
# Columns of tables

This page explains each column of the tables that commands print. `midair solve --help` prints the lines of
`midair solve`, and so for each command. [Metrics](conventions.md#how-good-an-answer-is) has the formulas.
[Sweeps](sweeps.md#the-table) has the columns of a sweep's file.
"""


def anchor(table: str, head: str) -> str:
    """Returns the anchor of a column, such as solutions-complex-error."""
    return re.sub(r"\W+", "-", f"{table} {head}").strip("-").lower()


def columns() -> str:
    """Returns the page of all columns of printed tables: a section for each table, a row for each column."""
    found = tomllib.loads(SOURCE.read_text("utf-8"))
    sections = [COLUMNS]
    for name, meanings in found.items():
        commands = [f"`midair {command}`" for command, of in TABLES.items() if of == name]
        rows = [(f'<a id="{anchor(name, head)}"></a>`{head}`', about) for head, about in meanings.items()]
        sections.append(f"## {' and '.join(commands)}\n\n{table(('column', 'meaning'), rows)}")
    return "\n".join(sections)


#: Functions that make the files of `make generated`, by path.
WRITTEN = {
    "docs/scene.schema.json": lambda: text(schema()),
    "docs/columns.md": columns,
    "docs/sweep.schema.json": lambda: text(sweep_schema()),
    "fuzz/scene.dict": lambda: words(tables()),
    "fuzz/sweep.dict": lambda: words({**tables(), **sweep_keys()}),
}

if __name__ == "__main__":
    for name, content in WRITTEN.items():
        (ROOT / name).write_text(content(), encoding="utf-8")
