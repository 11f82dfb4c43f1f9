"""Builds midair for Windows on Debian, and tests it under Wine.

python3 python/tests/windows.py [PART...]

The parts: wheel, board (at a COM port, MIDAIR_SLOW=1: twenty ends of each kind), c (the C library, its
examples and Unity's functions), core (its tests), quick (the package's tests that are not slow). By name:
package (all tests of the package, file by file; WORDS="..." are other arguments of pytest) and example
(README's first program). PROFILE=release is that of `make release`: it optimises, and installs only the
packages that midair needs.
Debian's mingw links. rustup's compiler gets its target for Windows; if rustup cannot download it, Debian's compiles
the standard library. A Python for Windows (Maven) and its packages (PyPI) are downloaded once into out/windows.
"""

import os
import re
import shlex
import shutil
import statistics
import subprocess
import sys
import threading
import time
import tomllib
import zipfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

from conftest import LINUX
from lines import Line

ROOT = Path(__file__).parents[2]
HOME = ROOT / "out" / "windows"
PYTHON = HOME / "python"
BIN = PYTHON / "bin"
PACKAGES = PYTHON / "lib" / "site-packages"
TARGET = "x86_64-pc-windows-gnu"
TOOLS = "x86_64-w64-mingw32-"
WINE = Path("/usr/lib/wine/wine64")
SERVER = Path("/usr/lib/wine/wineserver64")
#: Wine's own libraries for 64 bits.
DLLS = Path("/usr/lib/x86_64-linux-gnu/wine/x86_64-windows")


def has_target() -> bool:
    """Returns whether rustup's compiler has the target, after an attempt to add it."""
    with suppress(OSError, subprocess.TimeoutExpired):
        return not subprocess.run(["rustup", "target", "add", TARGET], capture_output=True, timeout=120).returncode
    return False


#: Debian's compiler, which builds the standard library: -Zbuild-std needs RUSTC_BOOTSTRAP with a stable compiler.
DEBIAN = {
    "RUSTC_BOOTSTRAP": "1",
    "RUSTC": "/usr/bin/rustc",
    "CARGO": "/usr/bin/cargo",
    "CARGO_UNSTABLE_BUILD_STD": "std,panic_unwind,panic_abort,test",
}
DEBIANS = {
    "/usr/bin/rustc": "rustc-web",
    "/usr/bin/cargo": "cargo-web",
    "/usr/lib/rustlib/src/rust/library/Cargo.lock": "rust-web-src",
}
RUST = {} if has_target() else DEBIAN
CARGO = RUST.get("CARGO", "cargo")
NEEDS = {
    **(DEBIANS if RUST else {}),
    f"/usr/bin/{TOOLS}g++": "g++-mingw-w64-x86-64",
    "/usr/bin/mvn": "maven",
    WINE: "wine64 wine",
}
#: The distribution of CPython for Windows that Maven has, as group, name, version and system.
CPYTHON = ("org.bytedeco", "cpython", "3.11.3-1.5.9", "windows-x86_64")
#: The newest versions that run under Wine 8.
LAST = ("numpy==2.2.6", "scipy<1.16", "matplotlib<3.11")

#: Functions of complex numbers that end the program in Wine 8's ucrtbase.dll.
REAL = ("cabs", "carg", "creal", "cimag")
COMPLEX = (*REAL, "conj", "cexp", "cpow", "csqrt", "clog", "ccos", "ccosh", "csin", "csinh", "ctan", "ctanh")
COMPLEX = (*COMPLEX, "cacos", "casin", "catan", "cacosh", "casinh", "catanh")

UCRT = """
#include <complex.h>
void __mingw_raise_matherr(int t, const char *n, double a, double b, double r) {}
"""

#: ProcessPrng, which Wine 8 lacks and Rust's standard library needs.
RANDOM = """
#include <windows.h>
BOOLEAN NTAPI SystemFunction036(PVOID, ULONG);
__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE p, SIZE_T n) { return SystemFunction036(p, (ULONG)n); }
"""

PYTEST = (WINE, BIN / "python.exe", "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist")
#: Time in s after which a process of tests counts as hanging.
HANGS = 1800
#: The files of the package's tests, and the number of processes for those that are not slow.
FILES = sorted({file.name for file in Path(__file__).parent.glob("test_*.py")} - {*LINUX})
PROCESSES = 8

RELEASE = os.environ.get("PROFILE") == "release"
PROFILE = ("--release",) if RELEASE else ()

#: Examples of the C library: folder, compiler, language, and a part of what they print.
EXAMPLES = (
    ("c", "gcc", "c99", "\n256 transducers: level 1.000"),
    ("cpp", "g++", "c++17", "249 transducers, 1000 frames: at least 0.999 of 2000 Pa"),
)

#: Ends of a program that plays: acts of programs.py. The last three end processes by TerminateProcess.
ENDS = ("forgotten", "exception", "exit", "killed", "guardless", "alone")
TRIALS = 20 if os.environ.get("MIDAIR_SLOW") else 3
#: Longest time in s until the board is off.
ALLOWED = 1.0

ENVIRONMENT = {key: value for key, value in os.environ.items() if key != "RUSTFLAGS"} | {
    "WINEPREFIX": str(HOME / "wine"),
    "WINEDEBUG": "-all",
    # Wine's own programs, which serve all others, find only its own ucrtbase.dll.
    "WINEDLLOVERRIDES": "ucrtbase=n,b;ucrtwine=n,b",
    "WINEPATH": "Z:" + str(BIN).replace("/", "\\"),
    **RUST,
    "CARGO_BUILD_TARGET": TARGET,
    "CARGO_TARGET_DIR": str(HOME / "target"),
    "CARGO_TARGET_X86_64_PC_WINDOWS_GNU_LINKER": f"{TOOLS}gcc",
    "CARGO_TARGET_X86_64_PC_WINDOWS_GNU_RUNNER": str(WINE),
    "CARGO_INCREMENTAL": "0",
    "CARGO_PROFILE_DEV_CODEGEN_UNITS": "16",
    "PYO3_CROSS_LIB_DIR": str(PYTHON / "libs"),
    "PYO3_CROSS_PYTHON_VERSION": "3.11",
}


def run(*command: object, cwd: Path = ROOT, **more: str) -> str:
    """Runs a command that must succeed; prints and returns its output, both streams.

    Input and output are pipes, because under Wine Python fails with files as standard streams.
    """
    words = [str(word) for word in command]
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
    said = []
    with subprocess.Popen(
        words, cwd=cwd, env=ENVIRONMENT | more, encoding="utf-8", errors="replace", **pipes
    ) as program:
        for line in program.stdout:
            said.append(line)
            print(line, end="", flush=True)
    if program.returncode:
        sys.exit(f"windows: failed: {shlex.join(words)}")
    return "".join(said)


def python() -> None:
    """Makes a Python for Windows that runs under Wine, with the packages that the tests need."""
    if (HOME / "ready").exists() or (RELEASE and (HOME / "bare").exists()):
        return
    shutil.rmtree(HOME, ignore_errors=True)
    HOME.mkdir(parents=True)
    group, name, version, system = CPYTHON
    run(
        "mvn",
        "-q",
        "-B",
        "dependency:get",
        f"-Dartifact={group}:{name}:{version}:jar:{system}",
        "-Dtransitive=false",
    )
    jar = Path.home() / ".m2/repository" / group.replace(".", "/") / name / version / f"{name}-{version}-{system}.jar"
    inner = f"{group.replace('.', '/')}/{name}/{system}/"
    with zipfile.ZipFile(jar) as file:
        names = [each for each in file.namelist() if each.startswith(inner) and "/lib/test/" not in each]
        file.extractall(HOME / "jar", names)
    (HOME / "jar" / inner).rename(PYTHON)
    shutil.rmtree(HOME / "jar")
    shutil.copy(PYTHON / "python311.dll", BIN)
    complete()
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    run(
        *(
            sys.executable,
            "-m",
            "pip",
            "download",
            "--quiet",
            "--only-binary=:all:",
            "--dest",
            HOME / "wheels",
        ),
        *(
            "--platform",
            "win_amd64",
            "--platform",
            "any",
            "--python-version",
            "3.11",
            "--implementation",
            "cp",
        ),
        *project["project"]["dependencies"],
        *([] if RELEASE else project["dependency-groups"]["dev"]),
        *[each for each in LAST if not (RELEASE and each.startswith("scipy"))],
    )
    for wheel in (HOME / "wheels").iterdir():
        install(wheel)
    # Its exit status is that of a part for 32 bits, which is not installed.
    subprocess.run([WINE, "wineboot", "-i"], env=ENVIRONMENT, capture_output=True)
    run(WINE, BIN / "python.exe", "-c", "import numpy, sys; print(sys.version, numpy.__version__)")
    (HOME / ("bare" if RELEASE else "ready")).touch()


def install(wheel: Path) -> None:
    """Unpacks a wheel for the Python under Wine."""
    with zipfile.ZipFile(wheel) as file:
        file.extractall(PACKAGES)


def complete() -> None:
    """Adds the libraries that Wine 8 or the distribution of Python lacks."""
    # ucrtbase.dll: Wine's own under another name, with functions of complex numbers.
    shutil.copy(DLLS / "ucrtbase.dll", BIN / "ucrtwine.dll")
    source, exports = [UCRT], []
    named = {name + end: name for name in COMPLEX for end in ("", "f", "l")}
    for name in dict.fromkeys([*exported(BIN / "ucrtwine.dll"), *named]):
        if base := named.get(name):
            kind = "float" if name == f"{base}f" else "double"
            result = kind if base in REAL else f"{kind} complex"
            given, passed = (f", {kind} complex b", ", b") if base == "cpow" else ("", "")
            own = f"{base}{'f' if kind == 'float' else ''}"
            source.append(f"{result} my_{name}({kind} complex a{given}) {{ return {own}(a{passed}); }}")
            exports.append(f"{name} = my_{name}")
        else:
            forward = f'"{name}" = "ucrtwine.{name}"' if set("?@") & set(name) else f"{name} = ucrtwine.{name}"
            exports.append(forward)
    bare = ("-nodefaultlibs", "-nostartfiles", "-e", "0")
    library("ucrtbase", "\n".join(source), exports, *bare, "-lmingwex", "-lmsvcrt", "-lkernel32", "-lgcc")
    library("bcryptprimitives", RANDOM, [], "-ladvapi32")
    # python3.dll, the stable ABI: forwards to python311.dll.
    command = [f"{TOOLS}nm", PYTHON / "libs" / "python3.lib"]
    symbols = subprocess.check_output(command, stderr=subprocess.DEVNULL, encoding="utf-8")
    functions = set(re.findall(r" T (\w+)$", symbols, re.MULTILINE))
    stable = {*re.findall(r"__imp_(\w+)$", symbols, re.MULTILINE)} & {*exported(BIN / "python311.dll")}
    forwards = [f"{name} = python311.{name}{'' if name in functions else ' DATA'}" for name in sorted(stable)]
    library("python3", "int nothing;", forwards, "-nostdlib", "-e", "0")


def exported(dll: Path) -> list[str]:
    """Returns the names that a library exports."""
    text = subprocess.check_output([f"{TOOLS}objdump", "-p", dll], encoding="utf-8")
    table = text[text.index("[Ordinal/Name Pointer] Table") :]
    row = r"^\s+\[\s*\d+\](?:\s+\+base\[\s*\d+\]\s+[0-9a-f]+)?\s+(\S+)$"
    return re.findall(row, table, re.MULTILINE)


def library(name: str, source: str, exports: list[str], *options: str) -> None:
    """Compiles a library for Windows from its source and its list of exports."""
    code, names = HOME / f"{name}.c", HOME / f"{name}.def"
    code.write_text(source, "utf-8")
    names.write_text("\n".join([f"LIBRARY {name}", "EXPORTS", *exports]) + "\n", "utf-8")
    parts = [code, *([names] if exports else [])]
    run(f"{TOOLS}gcc", "-O2", "-shared", "-o", BIN / f"{name}.dll", *parts, *options)


def wheel() -> None:
    """Builds the wheel and installs it for the Python under Wine."""
    shutil.rmtree(HOME / "dist", ignore_errors=True)
    maturin = shutil.which("maturin", path=f"{ROOT}/.venv/bin:{os.environ['PATH']}")
    run(maturin, "build", *PROFILE, "--target", TARGET, "-i", "python3.11", "--out", HOME / "dist")
    shutil.rmtree(PACKAGES / "midair", ignore_errors=True)
    (built,) = (HOME / "dist").glob("midair-*-win_amd64.whl")
    install(built)


def c() -> None:
    """Builds the C library, looks in it for the functions that Unity calls, and runs the examples with it."""
    run(CARGO, "build", *PROFILE, "-p", "midair-capi")
    # Beside ucrtbase.dll, which Wine looks for in the folder of the program.
    dll = shutil.copy(HOME / "target" / TARGET / ("release" if RELEASE else "debug") / "midair.dll", BIN)
    scripts = (ROOT / "unity" / "Runtime" / "MidairLibrary.cs").read_text("utf-8")
    if missing := {*re.findall(r"extern \w+ (midair_\w+)", scripts)} - {*exported(dll)}:
        sys.exit(f"windows: Unity's scripts call what midair.dll lacks: {missing}")
    strict = ("-Wall", "-Wextra", "-Wpedantic", "-Werror", "-static", "-Icapi/include")
    for folder, compiler, standard, wanted in EXAMPLES:
        source, program = ROOT / "examples" / folder / f"solve.{folder}", BIN / f"solve_{folder}.exe"
        run(f"{TOOLS}{compiler}", f"-std={standard}", *strict, source, dll, "-o", program)
        if wanted not in run(WINE, program):
            sys.exit(f"windows: {source.name} prints other numbers than on Linux")


def example() -> None:
    """Runs README's first program and a command with the wheel, in an empty folder."""
    readme = (ROOT / "README.md").read_text("utf-8")
    found = re.search(r"```python\n(.*?)```\n\n```output\n(.*?)```", readme, re.S)
    folder = HOME / "empty"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    (folder / "example.py").write_text(found[1], "utf-8")
    if run(WINE, BIN / "python.exe", "example.py", cwd=folder).splitlines() != found[2].splitlines():
        sys.exit("windows: README's example prints something else")
    words = ("-m", "midair", "solve", "--preset", "autd3", "--at", "0,0,0.15")
    run(WINE, BIN / "python.exe", *words, cwd=folder)


def core() -> None:
    """Runs the core's tests."""
    # With the extension beside it, the core is compiled as for the wheel. With Wine's own ucrtbase.dll: programs in
    # other folders than Python's do not find the one that was made.
    chosen = ("-p", "midair", "-p", "midair-python", "--no-default-features", "--features", "midair/scene-file")
    run(CARGO, "test", "--quiet", *chosen, "--", "--include-ignored", WINEDLLOVERRIDES="ucrtbase=b")


def quick() -> None:
    """Runs the package's tests that are not slow, in processes of some files each."""
    tests([[*FILES[part::PROCESSES], "-m", "not slow"] for part in range(PROCESSES)])


def package() -> None:
    """Runs all tests of the package, a process for each file."""
    words = os.environ.get("WORDS")
    tests([shlex.split(words)] if words else [[file] for file in FILES])


def tests(processes: list[list[str]]) -> None:
    """Runs tests of the package, two processes at a time."""
    with ThreadPoolExecutor(2) as pool:
        total = sum(pool.map(tried, processes), Counter())
    print(", ".join(f"{count} {kind}" for kind, count in total.items()))
    if total["failed"] + total["errors"] + total["error"] + total["ended"]:
        sys.exit("windows: failed: tests of the package")


def tried(words: list[str]) -> Counter[str]:
    """Runs tests; returns their counts, also "ended" for a process that hangs or crashes."""
    begin, command = time.monotonic(), [*map(str, PYTEST), "--tb=short", *words]
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
    with subprocess.Popen(
        command, cwd=ROOT / "python" / "tests", env=ENVIRONMENT, encoding="utf-8", errors="replace", **pipes
    ) as program:
        timer = threading.Timer(HANGS, program.kill)
        timer.start()
        said = program.stdout.read()
        timer.cancel()
    last = said.strip().rpartition("\n")[2]
    found = Counter({kind: int(count) for count, kind in re.findall(r"(\d+) (\w+)(?=,| in )", last)})
    found["ended"] = int(not found)
    print(f"{words[0]}, {time.monotonic() - begin:.0f} s: {last}", flush=True)
    if program.returncode:
        print(said, flush=True)
    return found


def board() -> None:
    """Ends programs that play at a COM port in every way, and checks the time until the board is off."""
    trials = [(act, number) for act in ENDS for number in range(TRIALS)]
    # One at a time: two programs that start Wine together may hang.
    took = [end(act, number) for number, (act, _) in enumerate(trials, 10)]
    print("off after, in ms: median, maximum, trials")
    for act in ENDS:
        times = [1e3 * time for (name, _), time in zip(trials, took, strict=True) if name == act]
        print(f"{statistics.median(times):6.0f}{max(times):6.0f}{len(times):4}  {act}")
    if max(took) > ALLOWED:
        sys.exit(f"windows: a board was not off within {ALLOWED:g} s")


def end(act: str, number: int) -> float:
    """Returns the time in s from the end of a program until its board is off; the board is at COM`number`."""
    line, port = Line(), HOME / "wine" / "dosdevices" / f"com{number}"
    port.unlink(missing_ok=True)
    port.symlink_to(line.port)
    words = [WINE, BIN / "python.exe", ROOT / "python" / "tests" / "programs.py", act, f"COM{number}", "60"]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    try:
        with subprocess.Popen(words, env=ENVIRONMENT, encoding="utf-8", **pipes) as program:
            if program.stdout.readline() != "playing\n":
                sys.exit(f"windows: the program {act} does not play")
            line.wait(lambda surface: surface.loud)
            # Until the watcher runs.
            time.sleep(10 if act == "alone" else 1)
            begin = time.monotonic()
            with suppress(BrokenPipeError):
                program.stdin.write("go\n")
                program.stdin.close()
            line.wait(lambda surface: surface.silent, 10)
            took = line.silent_since - begin
            program.kill()
        return took
    finally:
        line.unplug()
        port.unlink()


#: The last two run by name only.
PARTS = {part.__name__: part for part in (wheel, board, c, core, quick, package, example)}


def lane(*parts: str) -> None:
    """Runs parts, one after the other."""
    for name in parts:
        print(f"== {name}", flush=True)
        begin = time.monotonic()
        PARTS[name]()
        print(f"-- {name}: {time.monotonic() - begin:.0f} s", flush=True)


def main() -> None:
    missing = " ".join(package for place, package in NEEDS.items() if not Path(place).exists())
    if missing:
        sys.exit(f"test-windows: missing: apt install --no-install-recommends {missing}")
    python()
    # Two programs that start Wine together wait for five minutes: its server and its services run from here on.
    subprocess.Popen([SERVER, "-f", "-p"], env=ENVIRONMENT)
    try:
        quiet = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.DEVNULL)
        subprocess.run([WINE, "cmd", "/c", "exit"], env=ENVIRONMENT, **quiet)
        if sys.argv[1:]:
            lane(*sys.argv[1:])
        else:
            lane("wheel")
            # Ends of boards are mostly waiting, and the tests of the package rarely keep two cores busy.
            with ThreadPoolExecutor(2) as pool:
                for each in [pool.submit(lane, "board", "c", "core"), pool.submit(lane, "quick")]:
                    each.result()
    finally:
        subprocess.run([SERVER, "-k"], env=ENVIRONMENT)


if __name__ == "__main__":
    main()
