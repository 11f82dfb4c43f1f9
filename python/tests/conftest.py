"""Settings of the test run: one BLAS thread, and a limit of CPU time for tests that are not marked slow."""

import ctypes
import importlib
import inspect
import json
import os
import re
import signal
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from types import FunctionType, ModuleType

import pytest

from lines import Line

if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    # A shell that starts pytest by `&` makes it and its children ignore Ctrl-C; tests of Ctrl-C would hang.
    signal.signal(signal.SIGINT, signal.default_int_handler)

# Idle BLAS threads wait actively, which slows a busy machine down.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# Figures open no windows.
os.environ.setdefault("MPLBACKEND", "agg")

#: Seconds of CPU time, child processes included, above which a test that is not marked slow fails `make
#: check` on Linux. Mark tests slow from 0.2 s: the factor of five leaves room for a loaded machine and for
#: first imports.
LIMIT = 1.0

OVER: list[str] = []

#: Times in ms until boards were silent, by the name of the test, which says how their program ended.
DARK: dict[str, list[float]] = {}

#: Folder of the expected error messages, each of one line, by test file and test.
REFUSALS = Path(__file__).with_name("refusals")


def pytest_xdist_auto_num_workers() -> int:
    """Returns one worker more than there are cores: a fifth of the time, a test waits for a child or a port."""
    return (os.cpu_count() or 1) + 1


@pytest.fixture(autouse=True)
def no_figure_stays() -> Iterator[None]:
    """Closes each test's figures: `midair.plot` draws into an open figure, if there is one."""
    yield
    if pyplot := sys.modules.get("matplotlib.pyplot"):
        pyplot.close("all")


@pytest.fixture
def book(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], ModuleType]:
    """Returns a function that imports a module of the folder book."""
    monkeypatch.syspath_prepend(str(Path(__file__).parents[2] / "book"))
    return importlib.import_module


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    """Returns a function that runs the command line in this process:
    exit status, standard output, standard error.
    """
    from midair import _cli as cli

    def run(*arguments: object) -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as left:
            cli.main([str(argument) for argument in arguments])
        out, err = capsys.readouterr()
        assert "Traceback" not in out + err
        return left.value.code, out, err

    return run


@pytest.fixture
def kept(request: pytest.FixtureRequest, tmp_path: Path) -> Callable[..., None]:
    """Returns a function that compares a test's errors with refusals/ (MIDAIR_REFUSALS=write stores them).
    Of an exception, its code is compared, too.
    """
    file = REFUSALS / f"{request.path.stem}.json"
    every = json.loads(file.read_text("utf-8")) if file.exists() else {}

    def check(*errors: str | Exception) -> None:
        texts = [f"[{error.code}] {error}" if hasattr(error, "code") else str(error) for error in errors]
        assert all(len(text.splitlines()) == 1 for text in texts), texts
        lines = [text.strip().replace(f"{tmp_path}{os.sep}", "TMP/") for text in texts]
        if os.environ.get("MIDAIR_REFUSALS") == "write":
            every[request.node.name] = lines
            file.write_text(json.dumps(every, ensure_ascii=False, indent=1, sort_keys=True) + "\n", "utf-8")
        assert lines == every.get(request.node.name)

    return check


def quick(config: pytest.Config) -> bool:
    """Returns whether this run leaves out slow tests, as `make check` does."""
    return config.option.markexpr == "not slow"


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    begin = sum(os.times()[:4])
    result = yield
    used = sum(os.times()[:4]) - begin
    if quick(item.config) and used > LIMIT and sys.platform == "linux":
        OVER.append(f"{item.nodeid} takes {used:.1f} s of CPU: mark it @pytest.mark.slow")
    return result


#: Files for Linux alone: each test ends processes by signals, or reads /proc.
LINUX = ["test_boards_guard.py", "test_boards_owner.py", "test_boards_watcher.py", "test_serve_strangers.py"]
collect_ignore = [] if sys.platform == "linux" else LINUX

#: What a system lacks: Windows parts of POSIX, also links, which it forbids its users; macOS parts of Linux.
LACKS = {
    "win32": re.compile(
        r"\bos\.(fork|kill|mkfifo|openpty|waitpid)\b|\b(hard|sym)link_to\b|\bimport resource\b|\bchmod\b"
        r"|send_signal|\bSIG(CONT|HUP|KILL|STOP|TSTP)\b|\bLine\b(?=\()|/proc/|/dev/(full|null|zero)|#!/bin/"
        r'|"bash"'
    ),
    "darwin": re.compile(r"/proc/|/dev/full|\bSIG(CONT|STOP|TSTP)\b"),
}
if sys.platform == "win32" and hasattr(ctypes.WinDLL("ntdll"), "wine_get_version"):
    # Wine 8 lacks functions that list serial ports. There a wheel is unpacked, without program and sources, and
    # there is no cargo.
    LACKS["win32"] = re.compile(
        rf"{LACKS['win32'].pattern}|\blist_ports\b|with_name\(\"midair\"\)|reference\.index\(\)|third_party\(\)"
    )


def lacking(item: pytest.Function) -> str:
    """Returns what this system lacks of what the source of a test names, "" if nothing; also of its fixtures,
    and of functions and texts of its module.
    """
    fixtures = [found[-1].func for found in item._fixtureinfo.name2fixturedefs.values()]
    left, seen = [item.function, *fixtures], []
    while left:
        part = left.pop()
        if part in seen:
            continue
        seen.append(part)
        if found := LACKS[sys.platform].search(part if isinstance(part, str) else inspect.getsource(part)):
            return found[0]
        if isinstance(part, FunctionType):
            named = [part.__globals__.get(name) for name in part.__code__.co_names]
            left += [each for each in named if isinstance(each, str) or _is_own(each, part)]
    return ""


def _is_own(value: object, function: FunctionType) -> bool:
    return isinstance(value, FunctionType) and value.__globals__ is function.__globals__


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    if sys.platform in LACKS:
        for item in items:
            if isinstance(item, pytest.Function) and (part := lacking(item)):
                item.add_marker(pytest.mark.skip(reason=f"{sys.platform} lacks {part}"))
    if os.environ.get("MIDAIR_SLOW") != "1":
        for item in items:
            if item.get_closest_marker("long"):
                item.add_marker(pytest.mark.skip(reason="takes long: `make test-long` runs it"))


def pytest_sessionfinish(session: pytest.Session) -> None:
    if OVER and session.exitstatus == 0:
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    for line in OVER:
        terminalreporter.write_line(line, red=True)
    if DARK:
        terminalreporter.write_line("off after, in ms: median, maximum, trials")
    for act, took in DARK.items():
        terminalreporter.write_line(f"{statistics.median(took):6.0f}{max(took):6.0f}{len(took):4}  {act}")


@pytest.fixture
def dark(request: pytest.FixtureRequest) -> Callable[..., AbstractContextManager[None]]:
    """Returns a context manager: it checks that a board is silent within a time in s after the start of its
    block. The times are printed at the end of the test run.
    """

    @contextmanager
    def within(line: Line, allowed: float) -> Iterator[None]:
        begin = time.monotonic()
        yield
        line.wait(lambda surface: surface.silent, 10)
        took = line.silent_since - begin
        # Remove the last parameter, the number of the trial, so that all trials of a test are collected
        # together.
        act = re.sub(r"-?\d+\]$", "]", request.node.name).removesuffix("[]")
        DARK.setdefault(act, []).append(1e3 * took)
        assert took < allowed

    return within


@pytest.fixture
def cache(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Sets the cache folder of solved meshes to a folder of this test run, and returns its path."""
    folder = tmp_path_factory.getbasetemp() / "cache"
    monkeypatch.setenv("LOCALAPPDATA" if os.name == "nt" else "XDG_CACHE_HOME", str(folder))
    return folder
