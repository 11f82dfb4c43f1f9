"""`midair compare`: one scene solved by several solvers, as a table and a page of pictures."""

from pathlib import Path
from typing import Any

from .._judging.compare import Comparison, choices, growing
from .._midair import stated
from .._pictures.colours import Quantity
from .._support import output
from .keywords import Json, OutputFile
from .progress import progress_bar
from .scene import STANDARD, SceneFile
from .tables import beside, print_solutions, print_written, write_image

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
