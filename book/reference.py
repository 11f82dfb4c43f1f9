"""Generates the reference pages at build time: package, methods, presets, command line, scene file.

Run as a program, it writes docs/api.md, the page of all names, and the first tutorial as a notebook.
"""

import inspect
import re
from collections.abc import Iterator
from pathlib import Path

import gallery
import midair
import schema
from marked import table
from midair._cli.app import COMMANDS, app, explain

ROOT = Path(__file__).parents[1]

#: All public names of the package, by page: file, title, subject, names.
PYTHON = [
    (
        "scenes",
        "Arrays and scenes",
        "A request: transducers, points, the air, and obstacles in it.",
        f"Array presets PresetInfo Scene Bead Reach Plane {' '.join(midair._midair.bodies())} Mesh "
        "Propagation SceneError SceneWarning",
    ),
    (
        "solving",
        "Solving",
        "Methods compute a drive for a scene, for many scenes at once, or repeatedly.",
        "solve Solution solve_batch Batch Solver solvers SolverInfo OptionInfo compare Comparison bound beam multiplex",
    ),
    (
        "judging",
        "Judging and pictures",
        "The quality of a drive, its field, forces, levels at other places, and the effect of faults.",
        "judge Metrics BatchMetrics field Field plot style gorkov Gorkov rest Rest ear Ear exposure Exposure "
        "Exposed streaming Streaming tolerate Tolerance Kept",
    ),
    ("gradients", "Gradients", "Derivatives of the field, for optimisation and learning.", "grad torch jax"),
    (
        "drawing",
        "Shapes and paths",
        "Points on shapes and drawings, at rest or moving.",
        "shape image Picture path",
    ),
    (
        "motion",
        "Motion",
        "Drives for points that move, frame after frame, and their effect on beads and skin.",
        "sequence Sequence SequenceMetrics stream fly Flight weigh Felt skin Skin haptic Haptic recipes",
    ),
    (
        "measuring",
        "Measuring",
        "Measurement of a real array by readings of microphones.",
        "calibrate Calibration calibration_drives doctor Fault Report tune Tuning",
    ),
    (
        "boards",
        "Boards and files",
        "Boards that play drives, and files for exchange.",
        "connect Connection Board ports Port BoardError BoardBusy BoardLost BoardNotFound BoardPermission "
        "BoardTimeout read write",
    ),
    (
        "sweeps",
        "Sweeps and data sets",
        "Many problems in one table, and data sets of drives for machine learning.",
        "sweep dataset Dataset",
    ),
    ("notebooks", "Notebooks", "The studio in a notebook's cell.", "view View"),
]

INDEX = """\
# Public names of the Python package

This page lists the public names of the Python package, for programmers. Each link leads to the source file
of the name. `help(midair.solve)` prints the docstring of a name: parameters with shapes and units, results,
errors and an example. `make docs` builds a page for each function and class, with types.
"""

METHODS = """\
# Methods and their options

This page lists the options of each method. `midair solvers` prints the same lists. You write an option as
`--steps 8` on the command line, as `steps = 8` under `[solver]` in a scene file, and as `steps=8` in Python.
[How to choose](../how-to-choose.md) compares the methods.
[Requests](../requests.md#options-of-all-methods) explains `start`, `aim`, `limit` and `tolerance`.
"""

PRESETS = """\
# Presets

Arrays by name, as `midair presets` lists them: `midair.Array.preset("autd3", tiles=(2, 2))`. P0 is the
pressure of a transducer on its axis times the distance. [Boards](../boards.md) tells how they are played.

"""


def entry(name: str) -> str:
    """Returns the mkdocstrings directive for a public name. It names the place of the definition, because a
    name such as `midair.skin` is also that of a module.
    """
    thing = inspect.unwrap(getattr(midair, name))
    home = getattr(thing, "__module__", None) or "midair"
    path = f"midair.{name}" if home in ("midair", "midair._midair") else f"{home}.{thing.__qualname__}"
    return f"::: {path}\n    options:\n      heading: midair.{name}\n      toc_label: {name}"


def python() -> Iterator[tuple[str, str]]:
    """Yields a page for each subject; raises ValueError if a public name is on no page or on two."""
    listed = [name for *_, names in PYTHON for name in names.split()]
    if sorted(listed) != sorted(midair.__all__):
        wrong = set(listed) ^ set(midair.__all__)
        raise ValueError(f"book/reference.py and midair.__all__ differ in {sorted(wrong) or 'names given twice'}")
    for file, title, about, names in PYTHON:
        blocks = [f"# {title}\n\n{about} Units and shapes: [conventions](../../conventions.md)."]
        blocks += [entry(name) for name in names.split()]
        yield f"reference/python/{file}.md", "\n\n".join(blocks) + "\n"


def source(name: str) -> str:
    """Returns the file of the repository with the definition and docstring of a public name."""
    thing = getattr(midair, name)
    if thing is not getattr(midair._midair, name, None):
        return Path(inspect.getfile(inspect.unwrap(thing))).relative_to(ROOT).as_posix()
    written = re.compile(
        rf"^pub\(crate\) fn {name}\b|^ *pub\(crate\) struct {name}\b|^    {name}( \{{|,)$", re.MULTILINE
    )
    files = [path for path in ROOT.glob("python/src/*.rs") if written.search(path.read_text("utf-8"))]
    assert len(files) == 1, f"{name} is written in {files}"
    return files[0].relative_to(ROOT).as_posix()


def index() -> str:
    """Returns the page of all names, docs/api.md."""
    text = INDEX
    for _, title, about, names in PYTHON:
        summaries = {name: inspect.getdoc(getattr(midair, name)) or "" for name in names.split()}
        rows = [(f"[`{name}`](../{source(name)})", text.partition("\n")[0]) for name, text in summaries.items()]
        text += f"\n## {title}\n\n{about}\n\n{table(('name', 'summary'), rows)}"
    return text


def methods() -> str:
    """Returns the page of all methods with their options."""
    text = METHODS
    for name, about in midair.solvers().items():
        uses = {
            "a start": about.uses_start,
            "an aim": about.uses_aim,
            "phases at the points": about.uses_phases,
        }
        taken = ["pressures", *(what for what, used in uses.items() if used)]
        habit = "balanced" if about.balance else "not balanced"
        text += f"\n## {name}\n\n{about.summary[0].upper()}{about.summary[1:]}. Source: {about.source}.\n\n"
        text += f"Takes {', '.join(taken)}; {habit} by default.\n\n"
        options = [(f"`{name}`", f"`{known.default}`", known.doc) for name, known in about.options.items()]
        text += table(("option", "default", "what it does"), options)
    return text


def presets() -> str:
    """Returns the page of all presets."""
    head = ("preset", "N", "tiles", "P0 / Pa m", "board", "what it is", "source")
    rows = [
        (
            f"`{name}`",
            about.count,
            "yes" if about.tiles else "no",
            f"{about.source_pressure:g}",
            about.board or "-",
            about.summary,
            about.source,
        )
        for name, about in midair.presets().items()
    ]
    return PRESETS + table(head, rows)


def command_line() -> str:
    """Returns the page of all commands with their options, as in `--help`,
    without its own table of contents.
    """
    explain(*COMMANDS)
    text = app.generate_docs(output_format="markdown")
    before, rest = text.split("## Table of Contents", 1)
    _, commands = rest.split("**Commands**", 1)
    return before.replace("# midair", "# Command line", 1) + "**Commands**" + commands


def pages() -> Iterator[tuple[str, str]]:
    """Yields all pages: path on the website, and Markdown."""
    yield from python()
    yield "reference/methods.md", methods()
    yield "reference/presets.md", presets()
    yield "reference/command-line.md", command_line()
    yield "reference/scene-file.md", schema.page()


if __name__ == "__main__":
    ROOT.joinpath("docs", "api.md").write_text(index(), encoding="utf-8")
    gallery.LESSON.with_suffix(".ipynb").write_text(gallery.lesson(gallery.LESSON), encoding="utf-8")
