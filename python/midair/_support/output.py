"""Result files: drives as .npz, .csv and .json. Every file is written completely or not at all."""

import csv
import io
import json
import os
import shutil
import stat
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from .._midair import Scene, Solution, drive_to_csv, stated

DRIVES = (".npz", ".csv", ".json")
METRICS = ("accuracy", "sigma", "uniformity", "level", "residual", "leak")
IMAGES = (".png", ".svg", ".pdf", ".jpg")


#: Longest name to which the suffix of a temporary file is appended; file systems allow 255 bytes.
LONG = 100


def check(path: Path, endings: tuple[str, ...], others: Iterable[Path] = ()) -> None:
    """Reject a path that cannot be written, before any work is done for it.

    `others` are files that the path must not name, even by a link: the input files and the other outputs.
    """
    if path.suffix.lower() not in endings:
        cure = f"give {' or '.join(', '.join(endings).rsplit(', ', 1))}"
        raise stated(f'output "{path}"', "has no known ending", cure, code="unwritable")
    with refusing(f'output "{path}"', "choose another name or folder"):
        target = real(path)
        if len(target.name) > 255:
            # Windows would tell only when it is written.
            raise OSError(36, "File name too long")
        if target.is_dir():
            raise stated(f'output "{path}"', "is a folder", "give a file", code="unwritable")
        if target.exists() and not target.is_file():
            raise stated(f'output "{path}"', "is a device or pipe", "give a file", code="unwritable")
        if not target.parent.is_dir():
            raise stated(f'output folder "{path.parent}"', "is not there", "make it first", code="unwritable")
        for other in others:
            if _same(target, other):
                cure = "give another name"
                raise stated(f'output "{path}"', f'is the file "{other}" itself', cure, code="unwritable")
        if target.exists() and not os.access(target, os.W_OK):
            raise PermissionError(13, "write-protected")
        tidy(target)
        part = part_of(target)
        part.touch()
        part.unlink()


@contextmanager
def refusing(item: str, cure: str = "make room or choose another folder; what is done is kept") -> Iterator[None]:
    """Convert the system's errors about an output to a SceneError of one line."""
    try:
        yield
    except (OSError, UnicodeEncodeError) as error:
        reason = getattr(error, "strerror", "no file can have this name") or str(error)
        raise stated(item, f"cannot be written ({reason})", cure, code="unwritable") from error


def real(path: Path) -> Path:
    """Return the file that a path names, with links resolved."""
    return Path(os.path.realpath(path))


def _same(path: Path, other: Path) -> bool:
    """Return whether two names mean the same file, because of links, dots, or upper and lower case."""
    if os.path.normcase(os.path.realpath(path)) == os.path.normcase(os.path.realpath(other)):
        return True
    return path.exists() and other.exists() and path.samefile(other)


def part_of(path: Path) -> Path:
    """Return the name of the temporary file beside a path."""
    return path.with_name(f"{_begin(path)}{os.getpid()}.part")


def _begin(path: Path) -> str:
    """Return the beginning of a path's temporary names; the number of the process follows."""
    name = os.fsencode(path.name)
    return f".{path.name if len(name) <= LONG else sha256(name).hexdigest()[:32]}."


def tidy(path: Path) -> None:
    """Remove temporary files of a path whose processes have ended."""
    begin = _begin(path)
    for part in path.parent.iterdir():
        number = part.name.removeprefix(begin).removesuffix(".part")
        if part.name == f"{begin}{number}.part" and number.isdecimal() and not _lives(int(number)):
            with suppress(OSError):
                shutil.rmtree(part) if part.is_dir() else part.unlink()


def _lives(process: int) -> bool:
    """Return whether a process with this number exists; always True on Windows, which cannot check it."""
    if os.name == "nt":
        return True
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except PermissionError:
        return True
    return True


def write(path: Path, content: bytes) -> None:
    """Write a temporary file and rename it, so that no program reads an incomplete file."""
    target = real(path)
    part = part_of(target)
    try:
        part.write_bytes(content)
        put(part, target)
    except OSError as error:
        # The error names the user's file instead of the temporary one.
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        with suppress(OSError):
            part.unlink(missing_ok=True)


def put(part: Path, target: Path) -> None:
    """Rename a finished temporary file.

    Its content is written to the disk first, so a crash cannot leave an empty file.
    """
    if target.exists():
        part.chmod(stat.S_IMODE(target.stat().st_mode))
    _sync(part, os.O_RDWR)
    part.replace(target)
    # Windows cannot open folders, and some file systems cannot write them to the disk.
    with suppress(OSError):
        _sync(target.parent, os.O_RDONLY)


def _sync(path: Path, flags: int) -> None:
    handle = os.open(path, flags)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def write_drive(path: Path, scene: Scene, solution: Solution) -> None:
    """Write a drive as .npz, .csv or .json, by the path's ending (docs/files.md lists the keys)."""
    ending = path.suffix.lower()
    if ending == ".csv":
        content = drive_to_csv(solution.drive, scene.array.positions).encode()
    elif ending == ".json":
        content = drive_json(scene, solution).encode()
    else:
        buffer = io.BytesIO()
        np.savez(buffer, **_record(scene, solution))
        content = buffer.getvalue()
    write(path, content)


def drive_json(scene: Scene, solution: Solution) -> str:
    """Return the text of a .json file of a drive."""
    return to_json(_record(scene, solution))


def summary(scene: Scene, solution: Solution) -> str:
    """Return the settings of a solve and its metrics and pressures as JSON, without the drive."""
    record = _record(scene, solution)
    own = {name: getattr(solution, name) for name in ("solver", "options", "status")}
    kept = ("steps", "elapsed", "scale", *METRICS, "complex_error", "points", "targets", "pressures")
    return to_json(own | {name: record[name] for name in kept if name in record})


def to_csv(rows: Sequence[Mapping[str, object]], fields: Iterable[str] | None = None) -> bytes:
    """Return a CSV file of rows by the names of their columns, by default those of the first row."""
    text = io.StringIO()
    out = csv.DictWriter(text, [*(fields or rows[0])], lineterminator="\n")
    out.writeheader()
    out.writerows(rows)
    return text.getvalue().encode()


def to_json(record: Any) -> str:
    """Return JSON text: arrays as lists, complex numbers as [re, im], infinite numbers and NaN as null."""
    return json.dumps(_plain(record), allow_nan=False)


def _record(scene: Scene, solution: Solution) -> dict[str, Any]:
    metrics = solution.metrics
    return {
        **{name: getattr(solution, name) for name in ("drive", "amplitudes", "phases")},
        "positions": scene.array.positions,
        "points": scene.points,
        **{name: getattr(solution, name) for name in ("targets", "pressures", "scale")},
        **{name: getattr(metrics, name) for name in METRICS},
        **({} if solution.complex_error is None else {"complex_error": solution.complex_error}),
        "steps": solution.steps,
        "elapsed": solution.elapsed,
        **({} if solution.trace is None else {"trace": solution.trace}),
        "scene": scene.json(solution),
        **({} if scene.solver is None else {"scene_solver": json.dumps(scene.solver)}),
    }


def _plain(value: Any) -> Any:
    """Return a value as JSON's types, as `to_json` describes."""
    if isinstance(value, dict):
        return {key: _plain(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(part) for part in value]
    if value is None or isinstance(value, str | bool | int):
        return value
    array = np.asarray(value)
    if np.iscomplexobj(array):
        array = np.stack([array.real, array.imag], axis=-1)
    finite = np.isfinite(array)
    if not finite.all():
        array = array.astype(object)
        array[~finite] = None
    return array.tolist()
