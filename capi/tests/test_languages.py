"""The library in other languages: the examples in examples/ctypes and examples/node."""

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
    """Returns the folder of the package as npm installs it: packed, unpacked and built."""
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


def test_node_solves_batches_and_scenes_as_one_by_one(package: Path) -> None:
    program = """
        const { Session, solveScenes } = require('.');
        const fresh = () => new Session('autd3', 'fast');
        const problems = [[[0, 0, 0.15], [0.02, 0, 0.15]], [[0, 0.01, 0.14], [-0.02, 0, 0.15]]];
        const pressures = [[500, 600], [700, 800]];
        const same = (one, other) => one.drive.join() === other.drive.join() && one.level === other.level;
        const alone = problems.map((points, k) => fresh().solve(points, pressures[k]));
        const batch = fresh().solveBatch(problems, pressures, 2);
        const pa = (k, j) => `pressure = ${pressures[k][j]}.0\\n`;
        const point = (k) => (at, j) => `[[points]]\\nposition = [${at}]\\n${pa(k, j)}`;
        const head = '[array]\\npreset = "autd3"\\n[solver]\\nname = "fast"\\n';
        const text = (k) => head + problems[k].map(point(k)).join('');
        const scenes = solveScenes([text(0), text(1)], 300);
        const rest = scenes.flatMap((one) => [...one.drive.slice(2 * 249)]);
        const own = scenes.map((one) => ({ ...one, drive: one.drive.slice(0, 2 * 249) }));
        const alike = (answers) => answers.length === 2 && answers.every((one, k) => same(one, alone[k]));
        console.log(JSON.stringify([alike(batch), alike(own), rest.length, rest.every((x) => x === 0)]));
    """
    assert json.loads(run("node", "-e", program, cwd=package)) == [True, True, 204, True]


@pytest.mark.parametrize(
    ("line", "error"),
    [
        ("new Session('autd3').solveBatch([[[0, 0]]])", "give a session and problems of as many points"),
        ("new Session('autd3').solveBatch([])", "give a session and problems of as many points"),
        ("new Session('autd3').solveBatch([[[0, 0, 0.1]]], [[1, 2]])", "give pressures as a Float64Array"),
        ("solveScenes([3], 249)", "give the text of each scene"),
        ("solveScenes('x', 249)", "give an array of scenes"),
        ("solveScenes(['[array'], 249)", "scenes[0]"),
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
        const {{ Session, solveScenes, frame }} = require('.'), binding = require('./midair.node');
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
    # If the sessions were not freed, they would need 272 MB.
    assert float(run("node", "--expose-gc", "-e", program, cwd=package)) < 50
