"""Workers of a running Dask cluster."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from concurrent.futures import CancelledError, Executor
from contextlib import contextmanager
from queue import Empty, Queue
from threading import Thread
from typing import TYPE_CHECKING

from .._midair import SceneError

if TYPE_CHECKING:
    from distributed import Client

#: Seconds after which a scheduler that has not answered is given up.
PATIENCE = 6

#: Loggers that Dask gives levels of their own.
_NOISY = ("distributed", "distributed.client", "tornado", "tornado.application")


@contextmanager
def workers(scheduler: str) -> Iterator[tuple[Executor, int]]:
    """The cluster as an executor, and how many jobs it does at once."""
    try:
        from distributed import KilledWorker
    except ImportError as error:
        raise SceneError('a scheduler needs Dask: pip install "midair[cluster]"') from error
    with _quiet(), _connected(scheduler) as client:
        try:
            # A worker lost is no error: its jobs go to another one.
            yield client.get_executor(pure=False), max(sum(client.nthreads().values()), 1)
        except KilledWorker as error:
            raise SceneError(f"worker after worker was lost ({error}): what is done is kept") from error
        except CancelledError as error:
            raise SceneError(f'scheduler "{scheduler}" was lost: what is done is kept') from error


@contextmanager
def _quiet() -> Iterator[None]:
    """Dask's pages of log about a lost connection, while one line of ours says it."""
    loggers = [logging.getLogger(name) for name in _NOISY]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


def _connected(scheduler: str) -> Client:
    """A client, in any case within PATIENCE: Dask itself waits for ever for a server that is silent."""
    from distributed import Client

    answers: Queue[Client | Exception] = Queue()

    def connect() -> None:
        try:
            answers.put(Client(scheduler, timeout=PATIENCE, set_as_default=False))
        except Exception as error:
            answers.put(error)

    Thread(target=connect, daemon=True).start()
    try:
        answer = answers.get(timeout=PATIENCE)
    except Empty:
        answer = TimeoutError()
    if isinstance(answer, Exception):
        raise SceneError(
            f'scheduler "{scheduler}" does not answer: give the address that `dask scheduler` prints,'
            " such as tcp://127.0.0.1:8786"
        ) from answer
    return answer
