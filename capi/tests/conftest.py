"""The C library as `make install` installs it, and programs compiled with it."""

import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from library import Library

ROOT = Path(__file__).parents[2]
#: Compiler options: every warning is an error, in C and in C++.
STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1", "-g"]


def run(*command: object, cwd: Path = ROOT, given: str = "", **environment: str) -> str:
    """Runs a command that must succeed, and returns its output."""
    words = [str(word) for word in command]
    done = subprocess.run(
        words, cwd=cwd, input=given, capture_output=True, encoding="utf-8", env={**os.environ, **environment}
    )
    assert done.returncode == 0, f"{' '.join(words)}: {done.stdout}{done.stderr}"
    return done.stdout


def need(*programs: str) -> None:
    """Skips the test with a message if a program is not installed."""
    for program in programs:
        if shutil.which(program) is None:
            pytest.skip(f"{program} is not installed")


@pytest.fixture(scope="session")
def prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Returns the folder of the installed library."""
    prefix = tmp_path_factory.mktemp("usr")
    built = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"
    run(ROOT / "capi" / "install.sh", built, prefix)
    return prefix


@pytest.fixture(scope="session")
def library(prefix: Path) -> Library:
    return Library(prefix)


@pytest.fixture(scope="session")
def flags(prefix: Path) -> list[str]:
    """Returns the compiler flags from pkg-config, with the library's folder for when the program runs."""
    need("cc", "c++", "pkg-config")
    folder = str(prefix / "lib" / "pkgconfig")
    said = run("pkg-config", "--cflags", "--libs", "midair", PKG_CONFIG_PATH=folder).split()
    return [*said, f"-Wl,-rpath,{prefix / 'lib'}"]


@pytest.fixture
def compiled(flags: list[str], tmp_path: Path) -> Callable[..., Path]:
    """Returns a function that compiles a file of C99 or C++17 and links it with the library."""

    def build(source: Path, *options: str) -> Path:
        compiler = ["cc", "-std=c99"] if source.suffix == ".c" else ["c++", "-std=c++17"]
        program = tmp_path / source.stem
        run(*compiler, *STRICT, *options, source, *flags, "-lm", "-o", program)
        return program

    return build
