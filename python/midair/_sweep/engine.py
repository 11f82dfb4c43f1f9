"""Runs many independent jobs on threads or a Dask cluster; stores results, and returns them in order."""

import functools
import hashlib
import json
import logging
import os
import re
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from .. import _midair
from .._midair import SceneError, stated
from .._support import cache
from .._support.arguments import needs, without_warnings
from .._support.cache import Arrays
from .._support.ctrl_c import interruptible

if TYPE_CHECKING:
    from distributed import Client

#: Time in s to wait for a scheduler's first answer.
PATIENCE = 6

#: Loggers whose levels Dask changes.
_NOISY = ("distributed", "distributed.client", "tornado", "tornado.application")


@contextmanager
def workers(scheduler: str) -> Iterator[tuple[Executor, int]]:
    """Yield the cluster as an executor, and how many jobs it runs at the same time."""
    with needs("a scheduler needs Dask", "cluster"):
        from distributed import KilledWorker
    with _quiet(), _connected(scheduler) as client:
        try:
            # If a worker is lost, Dask gives its jobs to another one.
            yield client.get_executor(pure=False), max(sum(client.nthreads().values()), 1)
        except KilledWorker as error:
            raise stated("worker after worker", f"was lost ({error})", "what is done is kept") from error
        except CancelledError as error:
            raise stated(f'scheduler "{scheduler}"', "was lost", "what is done is kept") from error


@contextmanager
def _quiet() -> Iterator[None]:
    """Suppress Dask's long messages about a lost connection; an error of one line replaces them."""
    levels = {logger: logger.level for logger in map(logging.getLogger, _NOISY)}
    for logger in levels:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in levels.items():
            logger.setLevel(level)


def _connected(scheduler: str) -> "Client":
    """Return a client within PATIENCE s.

    Dask itself would wait without end for a server that does not answer.
    """
    from distributed import Client

    answer: Future[Client] = Future()

    def connect() -> None:
        try:
            answer.set_result(Client(scheduler, timeout=PATIENCE, set_as_default=False))
        except Exception as error:
            answer.set_exception(error)

    Thread(target=connect, daemon=True).start()
    try:
        return answer.result(PATIENCE)
    except Exception as error:
        cure = "give the address that `dask scheduler` prints, such as tcp://127.0.0.1:8786"
        raise stated(f'scheduler "{scheduler}"', "does not answer", cure) from error


Settings = Mapping[str, Any]
Function = Callable[[Settings, int, int], Arrays]

#: Jobs per worker that are submitted in advance: workers must not wait, and results must not fill the memory.
AHEAD = 4


#: Name of this run of the program.
RUN = uuid4().hex

#: Time in s between two checks for Ctrl-C.
INTERVAL = 0.2


@dataclass(frozen=True)
class Job:
    """A call function(settings, start, stop), for items start to stop. Its result depends on nothing else.

    The function is defined at the top level of a module, and the settings are JSON.
    """

    function: Function
    settings: Settings
    start: int
    stop: int
    #: The caller's object for this job; it is not sent to workers.
    owner: Any = None

    @property
    def path(self) -> Path:
        """Path of the stored result, relative to a folder of chunks."""
        named = [self.function.__module__, self.function.__qualname__, build(), self.settings]
        # A caller's function may have changed since another run, whose results are not used again.
        text = json.dumps(named, sort_keys=True, default=lambda function: f"{function!r} {RUN}")
        key = hashlib.sha256(text.encode()).hexdigest()
        return Path(key[:20], f"{self.start}-{self.stop}.npz")


def pieces(function: Function, settings: Settings, count: int, size: int, owner: Any = None) -> Iterator[Job]:
    """Yield the jobs for `count` items, at most `size` items each."""
    for start in range(0, count, size):
        yield Job(function, settings, start, min(start + size, count), owner)


def counted(progress: Callable[[int, int], object] | None, items: int) -> Callable[[int], None]:
    """Return a function of the number of items just done, which calls `progress` with (items done, items)."""
    done = 0

    def tell(more: int) -> None:
        nonlocal done
        done += more
        if progress is not None:
            progress(done, items)

    return tell


@functools.cache
def build() -> str:
    """Return version and hash of the compiled core, so that results of different builds are not mixed."""
    core = Path(str(_midair.__file__)).read_bytes()
    return f"{version('midair')}-{hashlib.sha256(core).hexdigest()[:16]}"


def run(
    jobs: Iterable[Job],
    receive: Callable[[Job, Arrays], None],
    *,
    chunks: Path | None = None,
    scheduler: str | None = None,
    threads: int | None = None,
    keep: Callable[[Job, Arrays], None] | None = None,
    tell: Callable[[int], None] = lambda items: None,
    fits: Callable[[Job, Arrays], bool] = lambda job, arrays: True,
) -> None:
    """Run the jobs and pass each result to `receive`, in the order of the jobs.

    Parameters
    ----------
    chunks
        Folder in which each result is stored at once. A job whose result is there is not run again.
    scheduler
        Address of a Dask scheduler; by default threads of this process work.
    threads
        Most threads; by default one per processor.
    keep
        Called with each new result at once, in any order.
    tell
        Called with the number of items of each job that is done.
    fits
        Returns whether a stored result can be the job's; otherwise the job is run again.
    """
    stop = threading.Event()
    with (
        # Thousands of equal warnings would not help; the column `level` shows the same.
        without_warnings(),
        _workers(scheduler, threads, stop) as (executor, workers),
        interruptible() as interrupted,
    ):
        waiting: deque[tuple[Job, Future[Arrays]]] = deque()
        unsaved: dict[Future[Arrays], Job] = {}

        def put(job: Job, arrays: Arrays) -> None:
            if chunks is not None:
                save(chunks / job.path, arrays)
            if keep is not None:
                keep(job, arrays)

        def collect() -> None:
            done, _ = wait(unsaved, INTERVAL, FIRST_COMPLETED)
            if interrupted():
                raise interrupted.error()
            for future in done:
                job = unsaved.pop(future)
                put(job, future.result())
                tell(job.stop - job.start)

        def hand_over(most: int) -> None:
            while len(waiting) > most:
                while waiting and waiting[0][1] not in unsaved:
                    job, future = waiting.popleft()
                    receive(job, future.result())
                if len(waiting) > most:
                    collect()

        try:
            for job in jobs:
                kept = None if chunks is None else load(chunks / job.path, job.stop - job.start)
                if kept is None or not fits(job, kept):
                    given = job.function, job.settings, job.start, job.stop
                    future = executor.submit(_work, version("midair"), *given)
                    unsaved[future] = job
                else:
                    future = Future()
                    future.set_result(kept)
                    tell(job.stop - job.start)
                waiting.append((job, future))
                hand_over(AHEAD * workers)
            hand_over(0)
        except BaseException:
            stop.set()
            for future in unsaved:
                future.cancel()
            executor.shutdown(wait=scheduler is None)
            _put_finished(unsaved, put)
            raise


def _work(requested: str, function: Function, settings: Settings, start: int, stop: int) -> Arrays:
    """Run one job, in a thread of this process or on another machine."""
    here = version("midair")
    if here != requested:
        raise stated("a worker", f"has midair {here}, the run midair {requested}", "install the same on all")
    return function(settings, start, stop)


#: Thread-local event that stops the run for which a thread works.
_own = threading.local()


class Stopped(Exception):
    """Raised in a job if its run is being stopped."""


def go_on() -> bool:
    """Return whether the run of this thread continues. Long jobs check it repeatedly."""
    stop: threading.Event | None = getattr(_own, "stop", None)
    return stop is None or not stop.is_set()


@contextmanager
def _workers(scheduler: str | None, threads: int | None, stop: threading.Event) -> Iterator[tuple[Executor, int]]:
    """Yield an executor, and how many jobs it runs at the same time."""
    if scheduler is None:
        # More threads than processors would not be faster.
        processors = os.cpu_count() or 1
        count = min(threads or processors, processors)
        with ThreadPoolExecutor(count, initializer=setattr, initargs=(_own, "stop", stop)) as pool:
            yield pool, count
    else:
        with workers(scheduler) as found:
            yield found


def _put_finished(unsaved: Mapping[Future[Arrays], Job], put: Callable[[Job, Arrays], None]) -> None:
    """Store the results that finished while the run was being stopped, until storing fails."""
    for future, job in unsaved.items():
        if future.done() and not future.cancelled() and future.exception() is None:
            try:
                put(job, future.result())
            except SceneError:
                return


#: Names of folders and files of stored results.
_FOLDER = re.compile(r"[0-9a-f]{20}")
_FILE = re.compile(r"\d+-\d+\.npz")


def load(path: Path, rows: int) -> Arrays | None:
    """Load the arrays of a stored result, each with `rows` rows; None if it is missing or damaged."""
    found = cache.load(path, identity(path))
    if found is None or not all(array.ndim and len(array) == rows for array in found.values()):
        return None
    return found


def save(path: Path, arrays: Arrays) -> None:
    """Store a result. Raises SceneError if that is not possible."""
    cache.save(path, identity(path), arrays)


def identity(path: Path) -> str:
    """Return the text that identifies the job of a file."""
    return f"{path.parent.name}/{path.name}"


def remove(folder: Path) -> None:
    """Remove all stored results in a folder, and each subfolder with nothing else in it.

    Does not follow links.
    """
    for part in cache.inside(folder):
        if _FOLDER.fullmatch(part.name):
            cache.remove(part, _FILE)
