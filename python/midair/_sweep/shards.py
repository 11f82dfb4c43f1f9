"""Data sets: random scenes with their drives in Parquet files, every tenth scene held out."""

import json
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .._midair import Array, Scene, bound, judge, numbers, solvers, stated
from .._support import output
from .._support.arguments import callback, needs, path_of, refused, warn
from .._support.cache import Arrays, locked
from .._support.output import METRICS
from .block import array_and_medium, solve_block, trial_seed
from .engine import Job, counted, go_on, pieces, run
from .problems import whole
from .request import Block, Request, read
from .table import Shortfall, temporary

if TYPE_CHECKING:
    import pyarrow as pa

#: Number of trials in a training file and its held-out file together: seconds of work, megabytes of drives.
SHARD = 4096

#: One of this many trials is held out for testing, whatever the size of the set.
EVERY = 10

#: The file that describes a data set, and the names of its two parts.
MANIFEST, SPLITS = "dataset.json", ("train", "held_out")

#: The cure for a missing or damaged file.
AGAIN = "the call that made the data set makes this file anew"


@dataclass(frozen=True)
class Dataset:
    """Data set that `midair.dataset` made; `Dataset("folder")` opens one.

    Parameters
    ----------
    folder : str or path
        Folder of the data set's files.

    Attributes
    ----------
    folder : path
        Folder of the data set's files.

    Raises
    ------
    SceneError
        For a folder without a data set.

    Notes
    -----
    Files of both parts, "train" and "held_out", have a row for each scene: trial; points (M, 3) in m; targets
    (M,) in Pa where the request has pressures; pressures (M,) and drive (N,), complex numbers as re and im in
    turn; scale; the metrics; status; the bound, if requested.

    Examples
    --------
    >>> import midair, tempfile
    >>> folder = tempfile.mkdtemp()
    >>> made = midair.dataset({
    ...     "array": {"preset": "paper20"}, "solver": {"name": "fast"}, "seeds": 20,
    ...     "points": {"count": 4, "x": [-0.05, 0.05], "y": [-0.05, 0.05], "z": 0.15},
    ... }, folder)
    >>> for part in midair.Dataset(folder).read("held_out"):
    ...     print(part["points"].shape, part["drive"].shape)
    (2, 4, 3) (2, 400)
    """

    folder: Path

    def __post_init__(self) -> None:
        folder = path_of("folder", self.folder)
        object.__setattr__(self, "folder", folder)
        if not (folder / MANIFEST).is_file():
            raise stated(f'"{folder}"', f"is no data set, it has no {MANIFEST}", "`midair dataset` makes one")

    @cached_property
    def manifest(self) -> dict[str, Any]:
        """Blocks of the request, the version, and the number of scenes."""
        return self._described[0]

    @property
    def array(self) -> Array:
        """Array of all scenes."""
        return self._described[1]

    @cached_property
    def _described(self) -> tuple[dict[str, Any], Array, list[str]]:
        """The manifest, the array, and the ends of the files' names in order."""
        try:
            manifest = json.loads((self.folder / MANIFEST).read_text(encoding="utf-8"))
            array, _ = array_and_medium(manifest["blocks"][0])
            count, step = len(manifest["blocks"]), manifest["trials of a file"]
            starts = range(0, manifest["scenes"] // count, step)
            ends = [_end(number, start // step) for number in range(count) for start in starts]
        except (OSError, ValueError, LookupError, TypeError, ArithmeticError, RecursionError) as error:
            cure = "make the data set anew"
            raise stated(f'"{self.folder / MANIFEST}"', "is damaged", cure, code="unreadable") from error
        return manifest, array, ends

    def files(self, split: str = "train") -> list[Path]:
        """Return the Parquet files of a part, in order.

        Parameters
        ----------
        split : {"train", "held_out"}, optional
            The part.

        Returns
        -------
        list of path
            The files.

        Raises
        ------
        SceneError
            If `split` is neither "train" nor "held_out", and if a file is missing.
        """
        if split not in SPLITS:
            raise refused("split", split, 'give "train" or "held_out"')
        files = [self.folder / f"{split}{end}" for end in self._described[2]]
        missing = next((file for file in files if not file.is_file()), None)
        if missing is not None:
            raise stated(f'"{missing}"', "is missing", AGAIN, code="missing")
        return files

    def read(self, split: str = "train") -> Iterator[dict[str, NDArray[Any]]]:
        """Yield one file after another as arrays of B rows.

        Parameters
        ----------
        split : {"train", "held_out"}, optional
            The part.

        Yields
        ------
        dict of str to ndarray
            points (B, M, 3), drive (B, N) and so on.

        Raises
        ------
        SceneError
            If `split` is neither "train" nor "held_out", and if a file is missing or damaged.
        """
        for file in self.files(split):
            content = _arrays(file)
            if content is None:
                raise stated(f'"{file}"', "is damaged", AGAIN, code="unreadable")
            yield content[0]

    def judge(self, drives: Any) -> dict[str, NDArray[np.float64]]:
        """Compute the metrics of other drives for the B held-out scenes, in their order.

        Parameters
        ----------
        drives : (B, N) array_like
            Complex drives. Targets are the request's; without pressures a scene's targets are equal.

        Returns
        -------
        dict of str to (B,) ndarray
            Metrics by name; "reference_accuracy" and so on are those of the data set's own drives.

        Raises
        ------
        SceneError
            For drives of another shape.
        """
        count = sum(part["trial"].size for part in self.read("held_out"))
        cure = f"give ({count}, {len(self.array)}), a row for each held-out scene"
        given = numbers("drives", drives, [(count, len(self.array))], cure, kinds="iufc", copy=False)
        found: list[list[NDArray[np.float64]]] = []
        first = 0
        for part in self.read("held_out"):
            rows = given[first : first + part["trial"].size]
            first += len(rows)
            own = judge(self.array, rows, points=part["points"], pressures=part.get("targets"))
            found.append([*(np.asarray(getattr(own, name)) for name in METRICS), *(part[name] for name in METRICS)])
        names = [*METRICS, *(f"reference_{name}" for name in METRICS)]
        return dict(zip(names, map(np.concatenate, zip(*found, strict=True)), strict=True))


def dataset(
    request: str | PathLike[str] | Mapping[str, Any],
    folder: str | PathLike[str],
    *,
    bounds: bool = False,
    scheduler: str | None = None,
    threads: int | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Dataset:
    """Make a data set of random scenes and their drives. After a stop, the same call continues the work.

    Parameters
    ----------
    request : str, path or mapping
        As for `midair.sweep`, with arrays of one size and one solver; all scenes share the solver's seed.
    folder : str or path
        Folder of the Parquet files and dataset.json; a part of the same set that it has is completed.
    bounds : bool, optional
        Whether each scene's bound, which no drive exceeds, is computed too.
    scheduler, threads, progress
        As for `midair.sweep`.

    Returns
    -------
    midair.Dataset
        The set. Every tenth trial is held out, in files of its own. The numbers depend on the request alone.

    Raises
    ------
    SceneError
        For a wrong request or a folder with other contents.

    Warns
    -----
    SceneWarning
        As for `midair.sweep`.

    See Also
    --------
    midair.sweep : a table of metrics.

    Examples
    --------
    >>> import midair, tempfile
    >>> made = midair.dataset({
    ...     "array": {"preset": "paper20"}, "solver": {"name": "fast"}, "seeds": 50,
    ...     "points": {"count": 4, "x": [-0.05, 0.05], "y": [-0.05, 0.05], "z": 0.15},
    ... }, tempfile.mkdtemp())
    >>> [next(made.read(split))["drive"].shape for split in ("train", "held_out")]
    [(45, 400), (5, 400)]
    """
    with needs("a data set needs pyarrow", "sweep"):
        from pyarrow import parquet
    if threads is not None:
        whole(threads, "threads", least=1)
    callback(progress, "scenes done, scenes")
    place = path_of("folder", folder)
    blocks = _blocks(read(request, drives=True), bounds)
    scenes = sum(block.trials for block in blocks)
    manifest = {
        "made by": "midair dataset",
        "scenes": scenes,
        "held out": f"every {EVERY}th trial",
        "trials of a file": SHARD,
        "blocks": [dict(block.settings) for block in blocks],
    }
    _claim(place, manifest)
    shortfall, tell = Shortfall(), counted(progress, scenes)

    def keep(job: Job, arrays: Arrays) -> None:
        shortfall.add(arrays)
        seeds = np.array([trial_seed(job.settings, index) for index in range(job.start, job.stop)])
        out = np.arange(job.start, job.stop) % EVERY == EVERY - 1
        for split, rows in zip(SPLITS, (~out, out), strict=True):
            with temporary(_file(place, split, job)) as part:
                found = _table({"trial": seeds} | arrays, rows, _identity(job))
                parquet.write_table(found, part, compression="none", use_dictionary=False)

    with locked(place / ".lock"):
        missing = []
        for job in _jobs(blocks):
            contents = [_arrays(_file(place, split, job)) for split in SPLITS]
            complete = all(content and content[1] == _identity(job) for content in contents)
            tell(job.stop - job.start) if complete else missing.append(job)
        run(missing, lambda job, arrays: None, keep=keep, scheduler=scheduler, threads=threads, tell=tell)
    if text := shortfall.text():
        warn(text)
    return Dataset(place)


def solve_scenes(settings: Mapping[str, Any], start: int, stop: int) -> Arrays:
    """Return the arrays of a sweep's block, with each scene's bound if requested."""
    arrays = solve_block(settings, start, stop)
    if settings["bounds"]:
        array, medium = array_and_medium(settings)
        targets = arrays.get("targets", np.ones(arrays["points"].shape[:2]))
        scenes = (Scene(array, *one, **medium) for one in zip(arrays["points"], targets, strict=True))
        arrays["bound"] = np.array([bound(scene) if go_on() else np.nan for scene in scenes])
    return arrays


def _blocks(requested: Request, bounds: bool) -> list[Block]:
    """Return the blocks of a request for a data set, with one seed for all scenes; rejects mixed ones."""
    given = [block.settings for block in requested.blocks]
    if any(callable(each["solver"]) for each in given):
        raise stated("solver.name", "is a function", "give a method by its name, so that the set can be made again")
    methods = {json.dumps([each["solver"], each["options"]]) for each in given}
    sizes = {block.columns["transducers"] for block in requested.blocks}
    if len(methods) > 1:
        raise stated("the data set", f"has {len(methods)} methods", "give one [solver] without lists")
    if len(sizes) > 1:
        raise stated("the data set", f"has arrays of {sorted(sizes)} transducers", "give arrays of one size")
    if any(block.settings.get("region") is None for block in requested.blocks):
        raise stated("the data set", "has fixed points", "give points.count and the ranges x, y and z")
    made = []
    for block in requested.blocks:
        options = dict(block.settings["options"])
        if "seed" in solvers()[block.settings["solver"]].options:
            options.setdefault("seed", block.settings["seed"])
        settings = {**block.settings, "options": options, "bounds": bounds}
        made.append(Block(settings, block.columns, block.trials))
    return made


def _jobs(blocks: list[Block]) -> Iterator[Job]:
    for number, block in enumerate(blocks):
        yield from pieces(solve_scenes, block.settings, block.trials, SHARD, number)


def _file(folder: Path, split: str, job: Job) -> Path:
    return folder / f"{split}{_end(job.owner, job.start // SHARD)}"


def _end(block: int, number: int) -> str:
    """Return the end of a file's name: its block, and its number within the block."""
    return f"-{block:04}-{number:05}.parquet"


def _identity(job: Job) -> str:
    """Return a text that identifies a job's settings, build and trials.

    A file with another text is replaced.
    """
    return job.path.with_suffix("").as_posix()


def _claim(folder: Path, manifest: dict[str, Any]) -> None:
    """Make the folder; rejects an existing one unless it has the same data set."""
    if folder.exists() and not folder.is_dir():
        raise stated(f'"{folder}"', "is a file", "give the name of a folder")
    text = json.dumps(manifest, indent=1)
    if folder.is_dir() and any(folder.iterdir()):
        file = folder / MANIFEST
        if not file.is_file():
            raise stated(f'"{folder}"', "holds other files", "give an empty folder, or a new name")
        if file.read_text(encoding="utf-8") != text:
            raise stated(f'"{folder}"', "holds another data set", "give its request again, or a new name")
        return
    with output.refusing(f'"{folder}"'):
        folder.mkdir(parents=True, exist_ok=True)
        output.write(folder / MANIFEST, text.encode())


def _table(arrays: Arrays, rows: NDArray[np.bool_], identity: str) -> "pa.Table":
    """Return rows of arrays as a Parquet table: arrays as lists of fixed length, complex as (re, im)."""
    import pyarrow as pa

    columns: dict[str, Any] = {}
    for name, values in arrays.items():
        if name in ("beyond", "weak"):
            continue
        own = np.ascontiguousarray(values[rows])
        if own.ndim == 1:
            columns[name] = pa.array(own)
            continue
        flat = own.reshape(len(own), math.prod(own.shape[1:]))
        flat = flat.view(np.float32) if np.iscomplexobj(flat) else flat
        columns[name] = pa.FixedSizeListArray.from_arrays(pa.array(flat.ravel()), flat.shape[1])
    table = pa.table(columns)
    return table.replace_schema_metadata({"midair": identity, "sha256": _digest(_decoded(table))})


def _arrays(path: Path) -> tuple[dict[str, NDArray[Any]], str] | None:
    """Return the arrays and the identity of a file; None if the file is damaged or missing."""
    from pyarrow import ArrowException, parquet

    try:
        table = parquet.read_table(path)
        arrays, metadata = _decoded(table), table.schema.metadata
        if metadata[b"sha256"].decode() != _digest(arrays):
            return None
        return arrays, metadata[b"midair"].decode()
    except (OSError, ArrowException, ValueError, KeyError, TypeError):
        return None


def _decoded(table: "pa.Table") -> dict[str, NDArray[Any]]:
    """Return the arrays of a table that `_table` made."""
    arrays: dict[str, NDArray[Any]] = {}
    for name, column in zip(table.column_names, table.columns, strict=True):
        cells = column.combine_chunks()
        if not hasattr(cells.type, "list_size"):
            arrays[name] = cells.to_numpy(zero_copy_only=False)
            continue
        values = cells.flatten().to_numpy().reshape(len(cells), cells.type.list_size)
        arrays[name] = values.view(np.complex64) if name in ("drive", "pressures") else values
    points = arrays["points"]
    arrays["points"] = points.reshape(len(points), points.shape[1] // 3, 3)
    return arrays


def _digest(arrays: Arrays) -> str:
    """Return the SHA-256 of names, types and values."""
    digest = sha256()
    for name, values in arrays.items():
        digest.update(f"{name} {values.dtype.str} {values.shape} ".encode())
        digest.update(repr(values.tolist()).encode() if values.dtype == object else values.tobytes())
    return digest.hexdigest()
