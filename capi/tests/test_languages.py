"""The library from other languages: the examples of examples/ctypes and examples/node."""

import json
import shutil
import sys
from pathlib import Path

import pytest

from conftest import ROOT, need, run

NODE = ROOT / "examples" / "node"
FIRST = "256 transducers: level 1.000, uniformity "


def test_ctypes(prefix: Path) -> None:
    program = ROOT / "examples" / "ctypes" / "solve.py"
    lines = run(sys.executable, program, prefix / "lib" / "libmidair.so").splitlines()
    assert lines[0].startswith(FIRST)
    assert lines[1].startswith("a frame of 258 bytes: 254 ")


@pytest.fixture(scope="module")
def package(prefix: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package as npm installs it: packed, unpacked and built."""
    need("node", "npm", "cc", "pkg-config")
    folder = tmp_path_factory.mktemp("node")
    headers = Path(shutil.which("node") or "").resolve().parents[1] / "include" / "node"
    if not (headers / "node_api.h").exists():
        pytest.skip(f"Node's headers are not installed at {headers}")
    packed = run("npm", "pack", "--offline", "--silent", NODE, cwd=folder).split()[-1]
    run("tar", "xzf", packed, cwd=folder)
    run("node", "build.js", cwd=folder / "package", PKG_CONFIG_PATH=str(prefix / "lib" / "pkgconfig"))
    return folder / "package"


def test_node(package: Path) -> None:
    lines = run("node", "solve.js", cwd=package).splitlines()
    assert lines[0].startswith(FIRST)
    assert lines[1].startswith("a frame of 258 bytes: 254 ")
    assert lines[2] == "refused: points[0].position is [0.0, 0.0, NaN]: give three finite numbers"


@pytest.mark.parametrize(
    ("line", "error"),
    [
        ("new Session('autd4')", 'unknown preset "autd4": did you mean autd3?'),
        ("new Session('autd3', 'fast', { block: -1 })", "block is -1"),
        ("new Session('autd3', 'fast', { block: {} })", "give a number or a text for an option"),
        ("new Session('autd3', 'fast').solve([[0, 0]])", "give a session and points as a Float64Array"),
        ("new Session('autd3', 'fast').solve([[0, 0, 0.1]], [1, 2])", "give pressures as a Float64Array"),
        ("binding.solve({}, new Float64Array(3))", "give a session and points"),
        ("binding.open(new Session('autd3'), 'autd3', 'fast')", "give an object without a session"),
        ("frame('sonicsurface', [1, 2])", "give the name of a board and a drive as a Float32Array"),
        ("frame('nano', new Float32Array(18))", "transducers is 9: nano has 1 to 8 channels"),
    ],
)
def test_node_throws_what_is_refused(package: Path, line: str, error: str) -> None:
    program = f"""
        const {{ Session, frame }} = require('.'), binding = require('./midair.node');
        let said = 'nothing';
        try {{ {line}; }} catch (error) {{ said = error.message; }}
        console.log(JSON.stringify(said));
    """
    assert json.loads(run("node", "-e", program, cwd=package)).startswith(error)


def test_node_frees_its_sessions(package: Path) -> None:
    program = """
        const { Session } = require('.');
        const rest = () => new Promise((resolve) => setImmediate(resolve));
        async function grown(count) {
          const before = process.memoryUsage().rss;
          for (let k = 0; k < count; k++) {
            new Session('paper36', 'fast').solve([[0, 0, 0.1]]);
            if (k % 50 === 0) { gc(); await rest(); }
          }
          return (process.memoryUsage().rss - before) / 1e6;
        }
        grown(100).then(() => grown(2000)).then(console.log);
    """
    # Kept, they would be 272 MB.
    assert float(run("node", "--expose-gc", "-e", program, cwd=package)) < 50
