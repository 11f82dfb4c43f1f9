"""Lists: `midair presets`, `solvers`, `boards` and `ports`; each describes one of its entries, too."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from rich import box
from rich.markup import escape
from rich.table import Table

from .. import Array, Board, Solver, SolverInfo, ports, presets, solvers
from .._boards.address import KINDS
from .._midair import preset_name, solver_name
from .._pictures.colours import Figure
from .._support import output
from .._support.text import counted
from .given import Json, check_outputs
from .tables import console, print_columns, print_facts, print_list, print_written, write_image

#: Panels per row of the picture.
COLUMNS = 4

#: Board whose defaults of a solver are shown too, if they differ from the solver's own.
BOARD = "autd3"


def arrays(named: Mapping[str, Array]) -> Figure:
    """Draw each array: flat ones from above, others in perspective; colours show the transducers' order."""
    from .._pictures.figures import new_figure

    columns = min(len(named), COLUMNS)
    rows = -(-len(named) // columns)
    figure = new_figure(3.3 * columns + 0.9, 3.4 * rows + 0.4)
    axes = []
    shades: Any = None
    for k, (name, array) in enumerate(named.items(), 1):
        places = array.positions * 1e3
        flat = bool(np.ptp(places[:, 2]) < 1e-6)
        ax: Any = figure.add_subplot(rows, columns, k, projection=None if flat else "3d")
        order = np.arange(len(places)) / max(len(places) - 1, 1)
        shown = places[:, :2] if flat else places
        size = 3e3 / max(len(places), 60)
        shade = {} if flat else {"depthshade": False}
        shades = ax.scatter(*shown.T, c=order, s=size, cmap="viridis", vmin=0, vmax=1, linewidths=0, **shade)
        ax.set_title(f"{name}\n{len(places)} transducers", fontsize="medium")
        ax.set_aspect("equal")
        ax.tick_params(labelsize="x-small")
        if flat:
            ax.margins(0.06)
        else:
            ax.locator_params(nbins=4)
        axes.append(ax)
    bar = figure.colorbar(shades, ax=axes, ticks=[0, 1], shrink=0.6, pad=0.02)
    bar.set_ticklabels(["first", "last"])
    figure.supxlabel("x, y (and z) in mm", fontsize="small")
    return figure


def solvers_command(name: str | None = None, *, json: Json = False) -> int:
    """List the solvers with their options and defaults.

    Parameters
    ----------
    name
        A solver, to describe it alone.
    """
    known = dict(solvers())
    if name is not None:
        known = {solver_name(name): known[solver_name(name)]}
    if json:
        print(output.to_json({name: _solver_record(info) for name, info in known.items()}))
        return 0
    if name is None:
        columns = {"solver": list(known), "what it does": [info.summary for info in known.values()]}
        print_list("solvers", columns)
        return 0
    for listed, info in known.items():
        _print_options(listed, info)
        _print_uses(listed, info)
    return 0


def _print_options(name: str, info: SolverInfo) -> None:
    """Print a solver's summary and its options; long texts continue on further lines."""
    console.print(f"{name}: {info.summary} ({info.source})", markup=False, highlight=False)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for column in ("option", "default"):
        table.add_column(column, no_wrap=True)
    table.add_column("what it does")
    board = Solver(Array.preset(BOARD), name).options
    for option, about in info.options.items():
        own = "" if board[option] == about.default else f" ({BOARD} {board[option]})"
        table.add_row(option, f"{about.default}{own}", escape(about.doc))
    table.add_row("phases", "used" if info.uses_phases else "not used", "Phases of complex pressures.")
    table.add_row("balance", str(info.balance), "Solve at the balanced level, reduce the drives afterwards.")
    console.print(table)


def _print_uses(name: str, info: SolverInfo) -> None:
    """Print how to give a solver's options in the command line, in a scene file and in Python."""
    key, value = next(((key, about.default) for key, about in info.options.items()), ("balance", True))
    word = f'"{value}"' if isinstance(value, str) else str(value).lower()
    lines = {
        "command line": f"midair solve scene.toml --solver {name} --{key} {value}",
        "scene file": f'[solver] and under it name = "{name}", {key} = {word}',
        "Python": f'midair.solve(scene, "{name}", {key}={value!r})',
    }
    if info.options == {}:
        lines["command line"] = f"midair solve scene.toml --solver {name} --balance"
    print_facts(lines)


def _solver_record(info: SolverInfo) -> dict[str, Any]:
    options = {name: {"default": about.default, "doc": about.doc} for name, about in info.options.items()}
    known = {"summary": info.summary, "source": info.source, "balance": info.balance}
    return {**known, "uses_phases": info.uses_phases, "options": options}


def presets_command(name: str | None = None, *, image: Path | None = None, json: Json = False) -> int:
    """List the arrays known by name.

    Parameters
    ----------
    name
        A preset, to describe it alone.
    image
        Where to write a picture of the transducers and their order: .png, .svg, .pdf or .jpg.
    """
    check_outputs((image, output.IMAGES))
    names = list(presets()) if name is None else [preset_name(name)]
    if json:
        print(output.to_json({name: _record(name) for name in names}))
    elif name is None:
        known = presets()
        columns = {
            "preset": list(known),
            "transducers": [str(info.count) for info in known.values()],
            "what it is": [info.summary for info in known.values()],
        }
        print_list("presets", columns)
    else:
        _print_one(names[0])
    if image is not None:
        write_image(image, arrays({name: Array.preset(name) for name in names}))
        if not json:
            print_written(image)
    return 0


def _print_one(name: str) -> None:
    record = _record(name)
    air = record["medium"]
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
        "air": f"{air['sound_speed']:.1f} m/s, {air['absorption']:.3f} Np/m, {air['density']:.3f} kg/m^3",
        "board": record["board"] or "none that plays drives",
        "phases": str(phases),
        "amplitudes": "any" if amplitudes is None else str(len(amplitudes)),
        "source": record["source"],
        "command line": f"midair solve --preset {name} --at 0,0,0.15",
        "scene file": f'[array] and under it preset = "{name}"',
        "Python": f'midair.Array.preset("{name}")',
    }
    print_facts(lines)


def _record(name: str) -> dict[str, Any]:
    info, array = presets()[name], Array.preset(name)
    names = ("summary", "source", "count", "tiles", "source_pressure", "board")
    known = {name: getattr(info, name) for name in names}
    known |= {"directivity": array.directivity, "medium": array.medium}
    return known | {"extent": np.ptp(array.positions, axis=0)[:2], "quantization": array.quantization}


def ports_command(*, json: Json = False) -> int:
    """List the serial ports, and the boards that their adapters could be. Opens none of them."""
    found = ports()
    if json:
        print(output.to_json([asdict(port) for port in found]))
        return 0
    if not found:
        console.print("no serial port: plug the board's adapter in")
        return 0
    columns = {
        "port": [port.name for port in found],
        "what the system calls it": [port.description for port in found],
        "maker": [port.maker or "-" for port in found],
        "serial number": [port.serial_number or "-" for port in found],
        "could be": [port.could_be or "-" for port in found],
    }
    opened = "none opened: midair play SCENE --on BOARD:PORT plays on one"
    print_columns("ports", columns, f"{counted(len(found), 'serial port')}, {opened}")
    return 0


def boards_command(name: str | None = None, *, json: Json = False) -> int:
    """List the boards that can be played.

    Parameters
    ----------
    name
        A kind of board, or an array of one, to describe it alone.
    """
    names = list(KINDS) if name is None else [name]
    records = {name: _board_record(name) for name in names}
    if json:
        print(output.to_json(records))
    elif name is None:
        known = records.values()
        columns = {
            "board": list(records),
            "channels": [str(record["transducers"]) for record in known],
            "phases": [str(record["phases"]) for record in known],
            "what it is": [record["summary"] for record in known],
        }
        print_list("boards", columns)
    else:
        _print_board(name, records[name])
    return 0


def _print_board(name: str, record: dict[str, Any]) -> None:
    amplitudes = record["amplitudes"]
    shown = ", ".join(f"{amplitude:.3g}" for amplitude in amplitudes[:6])
    line = "no serial line" if record["baud"] is None else f"serial, {record['baud']} baud"
    lines = {
        "board": name,
        "what it is": record["summary"],
        "transducers": str(record["transducers"]),
        "boards": f"{record['boards']} of at most {record['most_boards']}",
        "phases": str(record["phases"]),
        "amplitudes": f"{len(amplitudes)}: {shown}{', ...' if len(amplitudes) > 6 else ''}",
        "line": line,
        "frame": f"{record['frame_bytes']} bytes, {record['frames_per_second']:.4g} a second",
        "source": record["source"],
        "Python": f'midair.Board("{name}")',
    }
    print_facts(lines)


def _board_record(name: str) -> dict[str, Any]:
    board = Board(name)
    kind = KINDS[board.name]
    return {"summary": kind.summary, "source": kind.source, "link": board.link, "baud": board.baud, **board.limits}
