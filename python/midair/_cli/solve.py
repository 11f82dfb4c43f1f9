"""`midair solve` (a drive for a scene, judged and written) and `midair compare` (by several solvers)."""

import json as json_text
from inspect import signature
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from .. import Scene, Solution, field, solve, solvers
from .._judging.compare import Comparison, choices, growing
from .._midair import nearest, scene_keys, stated
from .._pictures.colours import Quantity
from .._support import output
from .._support.ctrl_c import interruptible
from .given import STANDARD, Json, Numbers, OutputFile, Places, SceneFile, SolverName, check_outputs, typed
from .progress import progress_bar, tell as say
from .tables import beside, print_field, print_solutions, print_written, write_image


def solve_command(
    scene: Path | None = None,
    *,
    preset: str | None = None,
    tiles: Numbers = None,
    at: Places = None,
    pressure: Numbers = None,
    solver: SolverName = None,
    output_file: OutputFile = None,
    image: Path | None = None,
    quantity: Quantity = "pressure",
    balance: bool | None = None,
    aim: str | None = None,
    show: Annotated[bool, Parameter(negative=())] = False,
    json: Json = False,
    **options: Annotated[str, Parameter(allow_leading_hyphen=True)],
) -> int:
    """Find a drive for a scene, judge it, and write the requested files.

    Any option of the solver is an option here (`midair solvers` lists them): --phases 16 --seed 1.

    Without a file: midair solve --preset autd3 --at 0,0,0.15 --at 0.02,0,0.15 --pressure 1000

    Parameters
    ----------
    scene
        Scene file, TOML or JSON, or - for standard input (`midair new` writes one to start with).
    preset
        Instead of a file: the array by its name (`midair presets` lists them).
    tiles
        Boards along x and y, such as 2,2.
    at
        A point x,y,z in m; repeat the option for each point.
    pressure
        Peak pressure in Pa at every point, or one per point, separated by commas. By default as much as
        the array can make.
    output_file
        Where to write the drive: .npz, .csv or .json, or - for JSON on standard output. By default nothing
        is written.
    image
        Where to write a picture of the field, and of targets and pressures: .png, .svg, .pdf or .jpg.
    quantity
        Quantity of the field's picture: |p| in Pa, the radiation pressure, the level in dB or the phase.
    balance
        Solve at the highest level that the array can make, and reduce the drives afterwards.
    aim
        "target" to meet the targets, "max" for as loud as possible; for solvers that have this option.
    show
        Draw |p| in the plane of the points in the terminal, below the table.
    options
        Options of the solver, as --name value.
    """
    words = (preset, tiles, at, pressure)
    if scene is not None and any(words):
        raise stated("", "--preset, --tiles, --at and --pressure go without a scene file", "change the file")
    if json and output_file == STANDARD:
        raise stated("", "--json and -o - both want standard output", "leave one of them out")
    if image == STANDARD:
        raise stated("--image", 'is "-"', "give a file")
    outputs = (output_file, output.DRIVES), (image, output.IMAGES)
    values = _values(options) if aim is None else {**_values(options), "aim": aim}
    if scene is None:
        check_outputs(*outputs)
        request = typed(*words)
    else:
        file = SceneFile(scene)
        file.check_outputs(*outputs)
        request = file.scene()
    with progress_bar("solving") as tell, interruptible() as stop:

        def watch(step: int, steps: int, residual: float) -> bool:
            tell(step, steps)
            return not stop()

        solution = solve(request, solver, balance=balance, progress=watch, **values)
    stopped = solution.status == "stopped"
    try:
        if output_file is not None and output_file != STANDARD:
            output.write_drive(output_file, request, solution)
        if image is not None and not stopped:
            with progress_bar("drawing"):
                write_image(image, solution.plot(quantity=quantity))
    finally:
        # The metrics are printed even if a file cannot be written.
        _print(request, solution, json, document=output_file == STANDARD)
    if show and not json and not stopped:
        print_field(field(solution.scene or request, solution))
    files = output_file, None if stopped else image
    for path in () if json else (path for path in files if path not in (None, STANDARD)):
        print_written(path)
    if stopped:
        say("stopped: what was found so far is above")
    return 128 + stop.number if stopped else 0


def _print(request: Scene, solution: Solution, json: bool, *, document: bool) -> None:
    if json:
        print(output.summary(request, solution))
        return
    with beside(document):
        print_solutions("solve", [solution])
    if document:
        print(output.drive_json(request, solution))


#: Arguments of Python that scene files state, and those that only Python has.
IN_A_FILE = ("pressures", "weights", "start", "progress", "trace", "signature", "bead", "obstacles")


def _values(options: dict[str, str]) -> dict[str, Any]:
    """Return solver options as Python values: 16, true and [1, 0] as in JSON, anything else as text."""
    values: dict[str, Any] = {}
    own = [name.removesuffix("_file") for name in signature(solve_command).parameters]
    methods = {option for method in solvers().values() for option in method.options}
    for name, text in options.items():
        key = name.replace("-", "_")
        if key in {*IN_A_FILE, *scene_keys()["medium"]}:
            cure = "put it into the scene file or use Python"
            raise stated(f"--{name}", "is no option of the command line", cure)
        if key not in methods and (meant := nearest(key, own)):
            words = "is no option of midair solve or of a method"
            raise stated(f"--{name}", words, f"did you mean --{meant}?")
        try:
            value = json_text.loads(text)
        except (ValueError, RecursionError):
            value = None
        # No option accepts null: it is passed as text, so that the solver rejects it.
        values[key] = text if value is None else value
    return values


TABLES = (".csv", ".json")


def compare_command(
    scene: Path,
    *,
    solvers: str = "all",
    output_file: OutputFile = None,
    image: Path | None = None,
    quantity: Quantity = "pressure",
    balance: bool | None = None,
    json: Json = False,
) -> int:
    """Solve a scene file by several methods: a table, and a picture with a panel for each on one scale.

    Parameters
    ----------
    scene
        Scene file, TOML or JSON, or - for standard input. Its solver options apply to its solver.
    solvers
        Names separated by commas, or "all".
    output_file
        Where to write the table: .csv or .json, or - for CSV on standard output.
    image
        Where to write the fields of all methods, as one picture: .png, .svg, .pdf or .jpg.
    quantity
        Quantity in the picture: |p| in Pa, the radiation pressure, the level in dB or the phase.
    balance
        Balance every method, or (--no-balance) none; by default each method's own setting.
    """
    if json and output_file == STANDARD:
        raise stated("", "--json and -o - both want standard output", "leave one of them out")
    file = SceneFile(scene)
    file.check_outputs((output_file, TABLES), (image, output.IMAGES))
    request = file.scene()
    names = None if solvers == "all" else [name.strip() for name in solvers.split(",")]
    count = len(choices(request, names))
    table = None
    try:
        with progress_bar("comparing") as tell:
            for table in growing(request, names, balance=balance):
                tell(len(table), count)
            if image is not None and table is not None:
                write_image(image, table.plot(quantity=quantity))
    finally:
        # After an interruption, the methods that have finished are still printed.
        if table is not None:
            _tell(table, output_file, json)
    if image is not None and not json and output_file != STANDARD:
        print_written(image)
    return 0


def _tell(table: Comparison, output_file: Path | None, json: bool) -> None:
    document = output_file == STANDARD
    if output_file is not None and not document:
        is_json = output_file.suffix.lower() == ".json"
        output.write(output_file, _json(table).encode() if is_json else output.to_csv(_rows(table)))
    if json:
        print(_json(table))
        return
    with beside(document):
        print_solutions("compare", table.solutions, table.names, table.gaps)
    if document:
        print(output.to_csv(_rows(table)).decode(), end="")
    elif output_file is not None:
        print_written(output_file)


def _rows(table: Comparison) -> list[dict[str, Any]]:
    columns = table.to_dict()
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def _json(table: Comparison) -> str:
    return output.to_json({"bound": table.bound, "solvers": _rows(table)})
