"""The wheel, installed in an environment with only NumPy."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BIN = Path(sys.executable).parent
STUDIO = ROOT / "python" / "midair" / "_studio" / "built"

PROGRAM = """
import sys, numpy as np, midair
scene = midair.Scene(midair.Array.preset("autd3"), [[0, 0, 0.15], [0.03, 0, 0.15]], pressures=900.0)
solution = midair.solve(scene, "greedy", seed=3)
assert midair.judge(scene, solution.drive).accuracy > 0.8
assert np.isfinite(midair.field(scene, solution.drive, midair.Plane(0.15, 0.1, 20)).pressure).all()
scene.save("scene.toml")
again = midair.solve(midair.Scene.load("scene.toml"), "greedy", seed=3)
assert again.drive.tobytes() == solution.drive.tobytes()
loaded = {name.partition(".")[0] for name in sys.modules}
assert not loaded & {"matplotlib", "rich", "cyclopts"}, loaded
"""


def run(*command: object, cwd: Path) -> None:
    done = subprocess.run([str(part) for part in command], cwd=cwd, capture_output=True, encoding="utf-8")
    assert done.returncode == 0, done.stderr


# One test in one process, because maturin builds in one folder.
@pytest.mark.slow
@pytest.mark.long
def test_the_wheel_holds_the_package_and_works_with_nothing_but_numpy(tmp_path: Path) -> None:
    run(BIN / "maturin", "build", "--quiet", "--release", "--out", tmp_path, cwd=ROOT)
    (wheel,) = tmp_path.glob("midair-*.whl")
    assert "abi3" in wheel.name
    names = set(zipfile.ZipFile(wheel).namelist())
    inner = (
        "__init__.py",
        "_cli/app.py",
        "_cli/starter.toml",
        "_pictures/colours.json",
        "py.typed",
        "_midair.pyi",
    )
    assert names >= {f"midair/{name}" for name in inner}
    assert not [name for name in names if "test" in name or "oracle" in name or name.startswith("python/")]
    # `make studio` writes these files, if it was run.
    studio = [path for path in STUDIO.rglob("*") if path.is_file()]
    assert {f"midair/_studio/built/{path.relative_to(STUDIO).as_posix()}" for path in studio} <= names

    uv, bare = BIN / "uv", tmp_path / "bare"
    run(uv, "venv", "--quiet", "--python", sys.executable, bare, cwd=tmp_path)
    python = bare / ("Scripts" if sys.platform == "win32" else "bin") / "python"
    constraints = ROOT / "constraints.txt"
    run(uv, "pip", "install", "--quiet", "--python", python, "-c", constraints, "numpy", cwd=tmp_path)
    run(uv, "pip", "install", "--quiet", "--python", python, "--no-deps", wheel, cwd=tmp_path)
    run(python, "-I", "-c", PROGRAM, cwd=tmp_path)
