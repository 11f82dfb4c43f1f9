"""`midair presets`: the list of arrays known by name, or one of them in full; and a picture of them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
from cyclopts import Parameter
from rich import box
from rich.table import Table

from .. import Array, output, presets
from .._midair import preset_name
from ..plot.arrays import arrays
from .images import write_image
from .scene import check_outputs
from .tables import console, print_written


def presets_command(
    name: str | None = None,
    *,
    image: Path | None = None,
    json: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """List the arrays known by name.

    Parameters
    ----------
    name
        A preset, for what is known of it alone.
    image
        Where a picture goes, of the transducers and their order: .png, .svg, .pdf or .jpg.
    json
        Print one JSON document in place of the table.
    """
    check_outputs((image, output.IMAGES))
    names = list(presets()) if name is None else [preset_name(name)]
    if json:
        print(output.to_json({name: _record(name) for name in names}))
    elif name is None:
        _print_list()
    else:
        _print_one(names[0])
    if image is not None:
        write_image(image, arrays({name: Array.preset(name) for name in names}))
        if not json:
            print_written(image)
    return 0


def _print_list() -> None:
    columns = "preset", "transducers", "tiles", "P0 / Pa m", "board", "what it is", "source"
    table = Table(*columns, box=box.SIMPLE_HEAD)
    for name, info in presets().items():
        tiles = "yes" if info.tiles else "no"
        table.add_row(
            f"[bold]{name}[/bold]",
            str(info.count),
            tiles,
            f"{info.source_pressure:g}",
            info.board or "-",
            info.summary,
            info.source,
        )
    console.print(table)


def _print_one(name: str) -> None:
    record = _record(name)
    board = record["quantization"] or {}
    phases, amplitudes = board.get("phases") or "any", board.get("amplitudes")
    width, height = (f"{side * 1e3:.1f}" for side in record["extent"])
    lines = {
        "preset": name,
        "what it is": record["summary"],
        "transducers": f"{record['count']}, {width} x {height} mm from the first to the last",
        "tiles": "yes, as in --tiles 2,2" if record["tiles"] else "no",
        "P0": f"{record['source_pressure']:g} Pa m",
        "directivity": str(record["directivity"]),
        "board": record["board"] or "none that plays drives",
        "phases": str(phases),
        "amplitudes": "any" if amplitudes is None else str(len(amplitudes)),
        "source": record["source"],
        "command line": f"midair solve --preset {name} --at 0,0,0.15",
        "scene file": f'[array] and under it preset = "{name}"',
        "Python": f'midair.Array.preset("{name}")',
    }
    for what, line in lines.items():
        console.print(f"  {what + ':':14}{line}", markup=False, highlight=False, soft_wrap=True)


def _record(name: str) -> dict[str, Any]:
    info, array = presets()[name], Array.preset(name)
    return {
        "summary": info.summary,
        "source": info.source,
        "count": info.count,
        "tiles": info.tiles,
        "source_pressure": info.source_pressure,
        "board": info.board,
        "directivity": array.directivity,
        "extent": np.ptp(array.positions, axis=0)[:2],
        "quantization": array.quantization,
    }
