"""Rehearses a release: builds it into out/release, and tests each part in an empty folder.

It needs all that `make wheels`, `make npm` and `make test-windows` need; parts for Windows and Unity are left
out if their tools are missing. It makes an environment, without Rust, for each interpreter from Python 3.11
on that uv finds. docs/publishing.md says what to do with the files.
"""

import hashlib
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import tarfile
import tempfile
import threading
import time
import tomllib
import urllib.request
import zipfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
OUT = ROOT / "out" / "release"
BIN = Path(sys.executable).parent
VERSION = tomllib.loads((ROOT / "Cargo.toml").read_text("utf-8"))["workspace"]["package"]["version"]
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
#: Where Rust compiles. Each part has a folder of its own, because a folder serves one build at a time.
BUILT = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).absolute()
WINDOWS = ROOT / "out" / "windows"
LINUX = "x86_64-unknown-linux-gnu"
THIRD_PARTY = ROOT / "python" / "THIRD-PARTY.md"
#: Licences of crates in a wheel that are allowed: none requires more than a copy of its text.
ALLOWED = {"MIT", "Apache-2.0", "Apache-2.0 WITH LLVM-exception", "BSD-2-Clause", "BSD-3-Clause", "ISC"}
ALLOWED |= {"Zlib", "Unicode-3.0", "Unlicense", "CC0-1.0", "BSL-1.0"}
#: A scene file: a board's array and one point.
BOARD = 'array.preset = "sonicsurface"\n[[points]]\nposition = [0, 0, 0.15]\n'
#: The largest allowed size of a wheel, in bytes.
MOST = 6_000_000


BEGIN = time.monotonic()


def say(text: str) -> None:
    print(f"== {time.monotonic() - BEGIN:4.0f} s  {text}", flush=True)


def run(*command: object, cwd: Path = ROOT, env: dict[str, str] | None = None) -> str:
    done = subprocess.run([str(word) for word in command], cwd=cwd, env=env, capture_output=True, encoding="utf-8")
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))}:\n{done.stdout}{done.stderr}")
    return done.stdout


def bundled() -> list[tuple[str, str, str]]:
    """Returns name, version and licence of each crate that is compiled into a wheel."""
    metadata: dict[str, Any] = json.loads(run("cargo", "metadata", "--format-version", "1", "--locked"))
    needs = {node["id"]: node["deps"] for node in metadata["resolve"]["nodes"]}
    packages = {package["id"]: package for package in metadata["packages"]}
    waiting = [id for id, package in packages.items() if package["name"] == "midair-python"]
    found: set[str] = set()
    while waiting:
        id = waiting.pop()
        if id not in found:
            found.add(id)
            compiled = [need for need in needs[id] if any(kind["kind"] is None for kind in need["dep_kinds"])]
            waiting += [need["pkg"] for need in compiled]
    rows = [(one["name"], one["version"], one["license"] or "none") for one in map(packages.get, found) if one]
    return sorted(row for row in rows if not row[0].startswith("midair"))


def is_allowed(licence: str) -> bool:
    """Returns whether a licence expression can be met with allowed licences alone."""
    parts = [part.strip(" ()") for part in licence.split(" AND ")]
    return all(any(one in ALLOWED for one in re.split(" OR |/", part)) for part in parts)


def third_party() -> str:
    """Returns the list of the crates in a wheel, as Markdown."""
    for name, _, licence in bundled():
        if not is_allowed(licence):
            raise SystemExit(f"{name} has the licence {licence}: read it, then add it to ALLOWED")
    found: dict[str, list[str]] = {}
    for name, version, licence in bundled():
        found.setdefault(licence, []).append(f"{name} {version}")
    rows = "".join(f"- {licence}: {', '.join(names)}\n" for licence, names in sorted(found.items()))
    return (
        "# Bundled software\n\nCrates that are compiled into midair's wheels, by licence."
        f" `make release` writes this list.\n\n{rows}"
    )


def built_in(name: str) -> dict[str, str]:
    """Returns the environment in which Rust compiles into a folder of its own."""
    return {**os.environ, "CARGO_TARGET_DIR": str(BUILT / name)}


def beside(*lanes: Callable[[], object]) -> None:
    """Runs lanes side by side: most of a compilation keeps one core busy."""
    with ThreadPoolExecutor(len(lanes)) as pool:
        for lane in [pool.submit(lane) for lane in lanes]:
            lane.result()


def build() -> None:
    """Builds all files of the release into an empty folder, and tests each."""
    shutil.rmtree(OUT, ignore_errors=True)
    OUT.mkdir(parents=True)
    say("licences of what is bundled, sources")
    THIRD_PARTY.write_text(third_party(), encoding="utf-8")
    run(BIN / "uv", "pip", "install", "--quiet", "--python", sys.executable, "--group", "wheels")
    name = f"midair-{VERSION}"
    run("git", "archive", f"--prefix={name}/", "--output", OUT / f"{name}-source.zip", "HEAD")
    paged = threading.Event()
    beside(*[partial(lane, paged) for lane in (web_lane, source_lane, windows_lane)])
    unity()
    try_unity()


def web_lane(paged: threading.Event) -> None:
    """Builds the studio, the package for Node, the wheel for x86-64 and the site, and tries them."""
    try:
        say("studio and package for Node (5 min)")
        run("studio/door/build.sh", env=built_in("studio"))
        run("node", "build.mjs", cwd=ROOT / "studio")
        run("npm/build.sh")
        run("npm", "pack", "./npm", "--pack-destination", OUT)
    finally:
        paged.set()
    wheel(LINUX)
    say("site: the book with the studio")
    (linux,) = OUT.glob("*manylinux*x86_64*.whl")
    with tempfile.TemporaryDirectory() as name:
        zipfile.ZipFile(linux).extractall(name)
        run("make", "site", env={**os.environ, "PYTHONPATH": name})
    shutil.make_archive(str(OUT / f"midair-{VERSION}-site"), "zip", ROOT / "out" / "site")
    try_wheels()


def source_lane(paged: threading.Event) -> None:
    """Builds the C library, the crate, the source distribution and the wheel for ARM, and tries the sources."""
    say("C library, crate, source distribution")
    # In the folder of the wheel, which has the same core.
    library = ("cargo", "build", "--release", "--package", "midair-capi", "--target", LINUX)
    run("python/zig.sh", LINUX, *library, env=built_in(LINUX))
    package = ("cargo", "package", "--quiet", "--no-verify", "--allow-dirty", "--package", "midair")
    run(*package, env=built_in("capi"))
    shutil.copy(BUILT / "capi" / "package" / f"midair-{VERSION}.crate", OUT)
    run(BIN / "maturin", "sdist", "--out", OUT)
    try_crate()
    paged.wait()
    wheel("aarch64-unknown-linux-gnu")
    # Last, because it keeps two cores busy.
    try_source()


def windows_lane(paged: threading.Event) -> None:
    """Builds the C library and the wheel for Windows, and tries them."""
    lacks = windows("c")
    paged.wait()
    lacks = lacks or windows("wheel", "example")
    if lacks:
        say(f"no files for Windows: {lacks}")
    else:
        for made in (WINDOWS / "dist").glob("*.whl"):
            shutil.copy(made, OUT)


def windows(*parts: str) -> str:
    """Builds parts for Windows and tries them under Wine; returns what is missing for it."""
    say(f"for Windows: {' '.join(parts)}")
    command = [sys.executable, "python/tests/windows.py", *parts]
    release = {**os.environ, "PROFILE": "release"}
    done = subprocess.run(command, cwd=ROOT, env=release, capture_output=True, encoding="utf-8")
    if done.returncode and "missing: " not in done.stderr:
        raise SystemExit(f"{' '.join(command)}:\n{done.stdout}{done.stderr}")
    return done.stderr.partition("missing: ")[2].strip() if done.returncode else ""


def wheel(target: str) -> None:
    """Builds a wheel for Linux."""
    say(f"wheel for {target} (3 min)")
    run("python/wheels.sh", OUT, target, env=built_in(target))
    for made in OUT.glob("*.whl"):
        if (size := made.stat().st_size) > MOST:
            raise SystemExit(f"{made.name} has {size} bytes: at most {MOST}")


def unity() -> None:
    """Packs Unity's package with the C libraries, and an identity for each file, which tarballs need."""
    files = run("git", "ls-files", "unity/package.json", "unity/Runtime/*.*s*", "unity/Samples~").split()
    contents = {each.removeprefix("unity/"): ROOT / each for each in files} | {
        "LICENSE.md": ROOT / "LICENSE",
        "Runtime/Plugins/Linux/x86_64/libmidair.so": BUILT / LINUX / LINUX / "release" / "libmidair.so",
        "Runtime/Plugins/Windows/x86_64/midair.dll": WINDOWS / "python" / "bin" / "midair.dll",
    }
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for path, source in contents.items():
            if source.exists():
                (folder / path).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(source, folder / path)
        for path in [each for each in folder.rglob("*") if "~" not in str(each.relative_to(folder))]:
            digest = hashlib.md5(path.relative_to(folder).as_posix().encode()).hexdigest()
            kind = "folderAsset: yes\n" if path.is_dir() else ""
            meta = f"fileFormatVersion: 2\nguid: {digest}\n{kind}"
            path.with_name(f"{path.name}.meta").write_text(meta, "utf-8")
        with tarfile.open(OUT / f"com.midair-{VERSION}.tgz", "w:gz") as packed:
            packed.add(folder, "package")


@contextmanager
def empty(python: str) -> Iterator[tuple[Path, dict[str, str]]]:
    """Makes a temporary environment: one version of Python with the wheel, no Rust, an empty work folder."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run(BIN / "uv", "venv", "--quiet", "--python", python, folder / "env")
        (wheel,) = OUT.glob("*manylinux*x86_64*.whl")
        run(BIN / "uv", "pip", "install", "--quiet", "--python", folder / "env" / "bin" / "python", wheel)
        env = {"PATH": f"{folder}/env/bin:/usr/bin:/bin", "HOME": name, "MPLBACKEND": "Agg"}
        (folder / "work").mkdir()
        yield folder / "work", env


def example() -> str:
    """Returns the first Python program of the README."""
    found = re.search(r"```python\n(.*?)```", (ROOT / "README.md").read_text("utf-8"), re.DOTALL)
    assert found
    return found[1]


def try_wheel(python: str) -> None:
    """Tests README's example, the command line, the studio's page and a simulated board,
    with the installed wheel.
    """
    with empty(python) as (folder, env):
        (folder / "board.toml").write_text(BOARD, "utf-8")
        for command in (
            ("python", "-c", example()),
            ("midair", "new", "scene.toml"),
            ("midair", "solve", "scene.toml", "--output", "drive.npz", "--image", "field.png"),
            ("midair", "play", "board.toml", "--on", "sonicsurface:loop", "--for", "500ms"),
        ):
            run(*command, cwd=folder, env=env)
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        command = ["midair", "studio", "--no-browser", "--port", str(port)]
        with subprocess.Popen(command, cwd=folder, env=env, stdout=subprocess.PIPE, encoding="utf-8") as served:
            try:
                module = fetched(f"http://127.0.0.1:{port}/midair.wasm")
            finally:
                served.terminate()
        if not module.startswith(b"\0asm"):
            raise SystemExit(f"midair studio serves no module: {module[:80]!r}")


def fetched(address: str) -> bytes:
    """Returns a file from a server that may still be starting: retries for ten seconds."""
    for _ in range(100):
        try:
            with urllib.request.urlopen(address, timeout=5) as answer:
                return bytes(answer.read())
        except OSError:
            time.sleep(0.1)
    raise SystemExit(f"{address} does not answer")


def try_node() -> None:
    """Tests the example of the package for Node in an empty folder."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "package.json").write_text('{"name": "empty", "private": true, "type": "module"}', "utf-8")
        run("npm", "install", "--silent", "--no-audit", "--no-fund", *OUT.glob("midair-*.tgz"), cwd=folder)
        run("node", "node_modules/midair/example.mjs", cwd=folder)


def try_crate() -> None:
    """Tests a program that depends on the packed crate."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run("tar", "xzf", OUT / f"midair-{VERSION}.crate", cwd=folder)
        run("cargo", "init", "--quiet", "--vcs", "none", "--name", "first", "first", cwd=folder)
        program = folder / "first"
        run("cargo", "add", "--quiet", "midair", "--path", f"../midair-{VERSION}", cwd=program)
        text = (ROOT / "docs" / "rust.md").read_text("utf-8")
        found = re.search(r"```rust\n(.*?)```", text, re.DOTALL)
        assert found
        uses, _, rest = found[1].partition("\n\n")
        main = f"{uses}\n\nfn main() -> Result<(), midair::Error> {{\n{rest}}}\n"
        (program / "src" / "main.rs").write_text(main, "utf-8")
        built = {"CARGO_TARGET_DIR": str(folder / "target"), "CARGO_PROFILE_DEV_DEBUG": "false"}
        run("cargo", "run", "--quiet", cwd=program, env=os.environ | built)


def try_source() -> None:
    """Compiles the source distribution, not optimised because that takes a third of the time, and tests README's
    example with it.
    """
    values = {"OPT_LEVEL": "0", "CODEGEN_UNITS": "16", "LTO": "off"}
    fast = {f"CARGO_PROFILE_RELEASE_{key}": value for key, value in values.items()}
    with tempfile.TemporaryDirectory() as name:
        run(BIN / "uv", "venv", "--quiet", Path(name) / "env")
        python = Path(name) / "env" / "bin" / "python"
        (source,) = OUT.glob("*.tar.gz")
        run(BIN / "uv", "pip", "install", "--quiet", "--python", python, source, env=built_in("source") | fast)
        run(python, "-c", example(), cwd=Path(name), env={**os.environ, "MPLBACKEND": "Agg"})


def try_notebook() -> None:
    """Runs the first tutorial in Jupyter; its first cell installs midair, here from the wheel."""
    with empty(sys.executable) as (folder, env):
        tools = ("pip", "ipykernel", "nbconvert")
        run(BIN / "uv", "pip", "install", "--quiet", "--python", folder.parent / "env/bin/python", *tools)
        run(BIN / "uv", "pip", "uninstall", "--quiet", "--python", folder.parent / "env/bin/python", "midair")
        shutil.copy(ROOT / "docs" / "tutorials" / "first-focus.ipynb", folder)
        env |= {"PIP_FIND_LINKS": str(OUT), "PIP_NO_INDEX": "1"}
        run("jupyter", "nbconvert", "--execute", "--to", "notebook", "first-focus.ipynb", cwd=folder, env=env)


def try_site() -> None:
    """Serves the site from an empty folder, and fetches pages, the studio and its module."""
    with tempfile.TemporaryDirectory() as name:
        zipfile.ZipFile(OUT / f"midair-{VERSION}-site.zip").extractall(name)
        handler = type("Quiet", (SimpleHTTPRequestHandler,), {"log_message": lambda *_: None})
        with ThreadingHTTPServer(("127.0.0.1", 0), partial(handler, directory=name)) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            home = f"http://127.0.0.1:{server.server_port}"
            page = b"<!doctype html>"
            for path, begins in {"index.html": page, "studio/index.html": page, "studio/midair.wasm": b"\0asm"}.items():
                if not fetched(f"{home}/{path}").lower().lstrip().startswith(begins):
                    raise SystemExit(f"the site's {path} is no {begins!r}")
            server.shutdown()


def try_unity() -> None:
    """Compiles the package for Unity with substitutes for Unity's types, and solves with its library."""
    if not shutil.which("mcs") or not shutil.which("mono"):
        say("no Mono on this machine (Debian: mono-mcs mono-runtime): the package for Unity is not tried")
        return
    with tempfile.TemporaryDirectory() as name:
        package = Path(name) / "package"
        with tarfile.open(OUT / f"com.midair-{VERSION}.tgz") as packed:
            packed.extractall(name, filter="data")
        sources = [*package.rglob("*.cs"), *(ROOT / "unity" / "Tests~").glob("*.cs")]
        run("mcs", "-r:System.dll", "-r:System.Core.dll", f"-out:{name}/scripts.exe", *sources)
        library = str(package / "Runtime" / "Plugins" / "Linux" / "x86_64")
        if "points" not in run("mono", f"{name}/scripts.exe", "solve", env={**os.environ, "LD_LIBRARY_PATH": library}):
            raise SystemExit("the package for Unity does not solve")


def try_archive() -> None:
    """Unpacks the sources, checks how to cite them, and that Cargo finds every crate of them."""
    with tempfile.TemporaryDirectory() as name:
        zipfile.ZipFile(OUT / f"midair-{VERSION}-source.zip").extractall(name)
        folder = Path(name) / f"midair-{VERSION}"
        if f"\nversion: {VERSION}\n" not in (folder / "CITATION.cff").read_text("utf-8"):
            raise SystemExit(f"CITATION.cff does not state version {VERSION}")
        run("cargo", "metadata", "--locked", "--format-version", "1", cwd=folder)


def try_wheels() -> None:
    """Tests the wheel for this computer with each interpreter, and the notebook."""
    for python in PYTHONS:
        try:
            run(BIN / "uv", "python", "find", python)
        except SystemExit:
            say(f"Python {python} is not on this machine: not tried")
            continue
        say(f"wheel on Python {python}: example, command line, board, studio")
        try_wheel(python)
    try_notebook()
    for part in (try_node, try_site, try_archive):
        part()


def main() -> None:
    build()
    sums = [f"{hashlib.sha256(file.read_bytes()).hexdigest()}  {file.name}\n" for file in sorted(OUT.iterdir())]
    (OUT / "SHA256SUMS").write_text("".join(sums), "utf-8")
    say("done: docs/publishing.md says what to upload, in which order")
    for file in sorted(OUT.iterdir()):
        print(f"   {file.stat().st_size:>10,} {file.name}")


if __name__ == "__main__":
    main()
