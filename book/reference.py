"""The reference pages that are written at build time: the package, the command line, the scene file."""

from __future__ import annotations

from collections.abc import Iterator

import midair
import schema
from midair.cli.app import app

#: Every public name of the package, a page a theme: file, title, what it is about, names.
PYTHON = [
    (
        "scenes",
        "Arrays and scenes",
        "What is asked for: transducers, points, the air, and what stands in it.",
        "Array presets PresetInfo Scene Reach Plane Wall Sphere Mesh Propagation SceneError SceneWarning",
    ),
    (
        "solving",
        "Solving",
        "From a scene to a drive, once, in batches, or again and again.",
        "solve Solution solve_batch Batch Solver solvers SolverInfo OptionInfo compare Comparison bound",
    ),
    (
        "judging",
        "Judging and pictures",
        "What a drive does: metrics, fields, forces, loudness elsewhere, faults.",
        "judge Metrics BatchMetrics field Field plot gorkov Gorkov ear Ear exposure Exposure Exposed "
        "streaming Streaming tolerate Tolerance Kept",
    ),
    (
        "drawing",
        "Shapes and paths",
        "Points of what people draw, at rest and in motion.",
        "shape image Picture path",
    ),
    (
        "motion",
        "Motion",
        "Points that move: frame after frame.",
        "sequence Sequence SequenceMetrics stream Felt",
    ),
    (
        "measuring",
        "Measuring",
        "Arrays as they are, found from readings.",
        "calibrate Calibration calibration_drives tune Tuning",
    ),
    (
        "boards",
        "Boards and files",
        "What is solved, played and exchanged.",
        "connect Connection Board ports Port BoardError BoardBusy BoardLost BoardNotFound BoardPermission "
        "BoardTimeout read write",
    ),
    ("sweeps", "Sweeps", "Many problems, one table.", "sweep"),
    ("notebooks", "Notebooks", "The studio in a cell.", "view View"),
]


def entry(name: str) -> str:
    """A public name, looked up where it is defined: `midair.compare` is also the name of a file."""
    thing = getattr(midair, name)
    home = getattr(thing, "__module__", "midair._")
    path = f"midair.{name}" if home.startswith("midair._") else f"{home}.{thing.__qualname__}"
    return f"::: {path}\n    options:\n      heading: midair.{name}\n      toc_label: {name}"


def python() -> Iterator[tuple[str, str]]:
    """A page a theme. A public name that is on none of them, or on two, is an error."""
    listed = [name for *_, names in PYTHON for name in names.split()]
    if sorted(listed) != sorted(midair.__all__):
        wrong = set(listed) ^ set(midair.__all__)
        raise ValueError(
            f"book/reference.py and midair.__all__ differ in {sorted(wrong) or 'names given twice'}"
        )
    for file, title, about, names in PYTHON:
        blocks = [f"# {title}\n\n{about} Units and shapes: [conventions](../../conventions.md)."]
        blocks += [entry(name) for name in names.split()]
        yield f"reference/python/{file}.md", "\n\n".join(blocks) + "\n"


def command_line() -> str:
    """Every command with every option, from what `--help` is made of; the contents are the site's own."""
    text = app.generate_docs(output_format="markdown")
    before, rest = text.split("## Table of Contents", 1)
    _, commands = rest.split("**Commands**", 1)
    return before.replace("# midair", "# Command line", 1) + "**Commands**" + commands


def pages() -> Iterator[tuple[str, str]]:
    """All of them: where they are in the site, and their Markdown."""
    yield from python()
    yield "reference/command-line.md", command_line()
    yield "reference/scene-file.md", schema.page()
