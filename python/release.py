"""Rehearses a release: builds it into out/release, tests each part in an empty environment, and prints the
commands for the upload.

It needs all that `make wheels` and `make npm` need. It makes an environment, without Rust, for each
interpreter from Python 3.11 on that uv finds.
"""

import hashlib
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import tomllib
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
OUT = ROOT / "out" / "release"
BIN = Path(sys.executable).parent
VERSION = tomllib.loads((ROOT / "Cargo.toml").read_text("utf-8"))["workspace"]["package"]["version"]
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
THIRD_PARTY = ROOT / "python" / "THIRD-PARTY.md"
#: Licences of crates in a wheel that are allowed: none requires more than a copy of its text.
ALLOWED = {"MIT", "Apache-2.0", "Apache-2.0 WITH LLVM-exception", "BSD-2-Clause", "BSD-3-Clause", "ISC"}
ALLOWED |= {"Zlib", "Unicode-3.0", "Unlicense", "CC0-1.0", "BSL-1.0"}
#: A scene file: a board's array and one point.
BOARD = 'array.preset = "sonicsurface"\n[[points]]\nposition = [0, 0, 0.15]\n'
#: The largest allowed size of a wheel, in bytes.
MOST = 6_000_000


def say(text: str) -> None:
    print(f"== {text}", flush=True)


def run(*command: object, cwd: Path = ROOT, env: dict[str, str] | None = None) -> str:
    done = subprocess.run(
        [str(word) for word in command], cwd=cwd, env=env, capture_output=True, encoding="utf-8"
    )
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
    rows = [
        (one["name"], one["version"], one["license"] or "none") for one in map(packages.get, found) if one
    ]
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
    rows = "\n".join(f"| {name} | {version} | {licence} |" for name, version, licence in bundled())
    return (
        "# Bundled software\n\nCrates that are compiled into midair's wheels, and their licences."
        f" `make release` writes this list.\n\n| crate | version | licence |\n|---|---|---|\n{rows}\n"
    )


def build() -> None:
    """Builds the source distribution, the wheels, the crate and the package for Node."""
    shutil.rmtree(OUT, ignore_errors=True)
    OUT.mkdir(parents=True)
    say("licences of what is bundled")
    THIRD_PARTY.write_text(third_party(), encoding="utf-8")
    say("source distribution")
    run(BIN / "maturin", "sdist", "--out", OUT)
    say("wheels (10 min)")
    shutil.rmtree(ROOT / "dist", ignore_errors=True)
    run("python/wheels.sh")
    for wheel in (ROOT / "dist").glob("*.whl"):
        shutil.move(wheel, OUT / wheel.name)
        size = (OUT / wheel.name).stat().st_size
        if size > MOST:
            raise SystemExit(f"{wheel.name} has {size} bytes: at most {MOST}")
    say("crate")
    run("cargo", "package", "--quiet", "--no-verify", "--allow-dirty", "--package", "midair")
    shutil.copy(ROOT / "target" / "package" / f"midair-{VERSION}.crate", OUT)
    say("package for Node")
    run("npm", "pack", "./npm", "--pack-destination", OUT)


@contextmanager
def empty(python: str) -> Iterator[tuple[Path, dict[str, str]]]:
    """Makes a temporary environment: one version of Python with the wheel, no Rust, an empty work folder."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run(BIN / "uv", "venv", "--quiet", "--python", python, folder / "env")
        (wheel,) = OUT.glob("*manylinux*x86_64*.whl")
        run(BIN / "uv", "pip", "install", "--quiet", "--python", folder / "env" / "bin" / "python", wheel)
        env = {"PATH": f"{folder}/env/bin:/usr/bin:/bin", "HOME": name, "MPLBACKEND": "Agg"}
        if shutil.which("cargo", path=env["PATH"]) or shutil.which("rustc", path=env["PATH"]):
            say("note: /usr/bin has a Rust compiler; nothing here calls it")
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
        with subprocess.Popen(
            command, cwd=folder, env=env, stdout=subprocess.PIPE, encoding="utf-8"
        ) as served:
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
        body = found[1].replace("# Ok::<(), midair::Error>(())", "Ok(())")
        uses, _, rest = body.partition("\n\n")
        (program / "src" / "main.rs").write_text(
            f"{uses}\n\nfn main() -> Result<(), midair::Error> {{\n{rest}}}\n", encoding="utf-8"
        )
        run(
            "cargo",
            "run",
            "--quiet",
            cwd=program,
            env={**os.environ, "CARGO_TARGET_DIR": str(folder / "target")},
        )


def main() -> None:
    build()
    for python in PYTHONS:
        try:
            run(BIN / "uv", "python", "find", python)
        except SystemExit:
            say(f"Python {python} is not on this machine: not tried")
            continue
        say(f"wheel on Python {python}: example, command line, board, studio")
        try_wheel(python)
    say("package for Node: example")
    try_node()
    say("crate: a program that uses it (2 min)")
    try_crate()
    say("upload in this order")
    print(f"1. cargo publish -p midair                  midair-{VERSION}.crate, which cannot be taken back")
    print("2. twine upload out/release/*.whl out/release/*.tar.gz")
    print(f"3. npm publish out/release/midair-{VERSION}.tgz")
    print(f"4. git tag v{VERSION}; the workflow wheels adds macOS and Windows")
    (source,) = OUT.glob("*.tar.gz")
    digest = hashlib.sha256(source.read_bytes()).hexdigest()
    print(f"5. python/conda/recipe.yaml to conda-forge/staged-recipes, with sha256 {digest}")
    for file in sorted(OUT.iterdir()):
        print(f"   {file.stat().st_size:>10,} {file.name}")


if __name__ == "__main__":
    main()
