"""Memory: no growth over 100,000 calls, no allocation in a second solve; valgrind, address sanitizer."""

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from conftest import ROOT, need, run

Build = Callable[..., Path]
MANY = ROOT / "capi" / "tests" / "many_calls.c"
PROGRAMS = [MANY, *sorted((ROOT / "examples").glob("c*/solve.c*"))]
LEAKS = ["--leak-check=full", "--show-leak-kinds=all", "--errors-for-leak-kinds=all"]
VALGRIND = ["valgrind", *LEAKS, "--error-exitcode=9"]
#: A program that never frees a handle.
FORGETFUL = """
#include <midair.h>
int main(void)
{
    midair_array *array;
    return (int)midair_array_grid(4, 4, 0.01, &array, NULL, 0) + (array = NULL, 0);
}
"""


def arguments(program: Path) -> list[str]:
    """Returns arguments for few calls, because these tools make a call about thirty times slower."""
    return ["all", "20"] if program.stem == MANY.stem else []


# A round of "all" has about thirty calls.
@pytest.mark.parametrize(("mode", "rounds"), [("solves", 100_000), ("all", 4_000)])
def test_many_calls_take_no_more_memory(compiled: Build, mode: str, rounds: int) -> None:
    # The bytes in use stay exactly the same, except for the stacks of threads that have ended.
    run(compiled(MANY), mode, rounds, GLIBC_TUNABLES="glibc.malloc.tcache_count=0:glibc.malloc.arena_max=1")


def test_a_second_solve_allocates_nothing(compiled: Build) -> None:
    need("valgrind")
    program = compiled(MANY)

    def allocations(calls: int) -> int:
        done = subprocess.run([*VALGRIND, program, "solves", str(calls)], capture_output=True, encoding="utf-8")
        assert done.returncode == 0, done.stderr
        (found,) = re.findall(r"total heap usage: ([\d,]+) allocs", done.stderr)
        return int(found.replace(",", ""))

    # A method may exchange its buffers, so that all of them are allocated only after two calls.
    assert allocations(2) == allocations(40) > 10


@pytest.mark.parametrize("source", PROGRAMS, ids=lambda path: path.name)
def test_valgrind_finds_nothing(compiled: Build, source: Path) -> None:
    need("valgrind")
    run(*VALGRIND, "--quiet", compiled(source), *arguments(source))


@pytest.mark.parametrize("source", PROGRAMS, ids=lambda path: path.name)
def test_the_address_sanitizer_finds_nothing(compiled: Build, source: Path) -> None:
    run(compiled(source, "-fsanitize=address"), *arguments(source), ASAN_OPTIONS="detect_leaks=1")


def test_a_forgotten_handle_would_be_found(compiled: Build, tmp_path: Path) -> None:
    need("valgrind")
    source = tmp_path / "forgetful.c"
    source.write_text(FORGETFUL, "utf-8")
    assert subprocess.run([*VALGRIND, compiled(source)], capture_output=True).returncode == 9
    assert subprocess.run([compiled(source, "-fsanitize=address")], capture_output=True).returncode != 0
