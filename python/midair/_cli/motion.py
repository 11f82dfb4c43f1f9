"""`midair motion`: solves moving points frame by frame; writes a table, a file, a picture, an animation."""

import json as json_text
from pathlib import Path

from .. import Sequence
from .._midair import Motion, solver_name, stated
from .._sequence.picture import ENDINGS
from .._sequence.solve import motion_of, solve_motion, solver_of
from .._sequence.store import Output
from .._support import output
from .._support.text import counted
from .given import Json, OutputFile, check_outputs
from .progress import progress_bar
from .tables import best_of, print_columns, print_written, write_image

#: Metrics of a sequence and their number formats.
COLUMNS = dict.fromkeys(("level", "uniformity", "largest_change", "seam"), "{:.4f}")
COLUMNS |= {"dip": "{:.3f}", "noise": "{:.1f}"}


def motion_command(
    scene: Path,
    *,
    output_file: OutputFile = None,
    image: Path | None = None,
    animate: Path | None = None,
    solvers: str | None = None,
    json: Json = False,
) -> int:
    """Solve the frames of a scene file with a table [motion], and judge them.

    Parameters
    ----------
    scene
        Scene file, TOML or JSON, with [motion]: docs/motion.md.
    output_file
        Where to write the sequence: .npz. Frames are written as they are found, unless ahead is "all": if
        you stop the command and start it again, it continues.
    image
        Where to write a picture of pressures and phase changes over time: .png, .svg, .pdf or .jpg.
    animate
        Where to write an animation of the field: .webp, .gif, or .mp4 by ffmpeg.
    solvers
        Names separated by commas, for a comparison; by default the scene file's, else glide.
    """
    names = [solver_name(name.strip()) for name in solvers.split(",")] if solvers else []
    if len(names) > 1 and (output_file is not None or image is not None or animate is not None):
        raise stated("--solvers", f"is {solvers}", "a file is of one sequence, give one solver")
    outputs = (output_file, (".npz",)), (image, output.IMAGES), (animate, ENDINGS)
    check_outputs(*outputs, taken=[scene])
    requested = motion_of(scene)
    if requested is None:
        raise stated(f'scene file "{scene}"', "has no [motion]", "add this table, as docs/motion.md shows")
    found = {name: _solved(requested, name, output_file) for name in names or [solver_of(requested)]}
    if json:
        print(json_text.dumps({name: one.metrics.asdict() for name, one in found.items()}))
    else:
        _print(found)
    for one in found.values():
        if image is not None:
            with progress_bar("drawing"):
                write_image(image, one.plot())
        if animate is not None:
            with progress_bar("animating") as tell:
                one.animate(animate, progress=tell)
    for path in (output_file, image, animate):
        if path is not None and not json:
            print_written(path)
    return 0


def _solved(requested: Motion, name: str, file: Path | None) -> Sequence:
    # With ahead="all" all frames are found together, so the file is written at the end.
    together = requested.settings.get("ahead") == "all"
    pieces = None if together or file is None else Output(file)
    with progress_bar(f"solving by {name}") as tell:
        found = solve_motion(requested, solver=name, progress=tell, resume=pieces)
    if together and file is not None:
        found.save(file)
    return found


def _print(found: dict[str, Sequence]) -> None:
    columns = {"solver": list(found)}
    for key, form in COLUMNS.items():
        values = [one.metrics.asdict()[key] for one in found.values()]
        columns[key.replace("_", " ")] = ["-" if value is None else form.format(value) for value in values]
    name, best = max(found.items(), key=lambda each: each[1].metrics.uniformity)
    metrics, (frames, count) = best.metrics, best.targets.shape
    by, driven = f"{name}: " if len(found) > 1 else "", counted(len(best.array), "transducer")
    even = f", even to {1 - metrics.uniformity:.1%} in each frame" if count > 1 else ""
    print_columns(
        "motion",
        columns if len(found) == 1 else best_of(columns),
        f"{by}{counted(frames, 'frame')} of {counted(count, 'point')} at {best.rate:g} Hz with {driven}, "
        f"at {metrics.level:.1%} of the targets{even}",
    )
