"""`midair.view` with a simulated page, and the scenes that Python and the page send to each other."""

import inspect
import json
import re
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import midair
from midair._studio.page import scene_text, shown_scene
from midair._studio.view import View
from pages import FILES, STATE, autd3, build

ROOT = Path(__file__).parents[2]


@pytest.fixture
def built(tmp_path: Path) -> Path:
    return build(tmp_path / "built")


def test_scenes_survive_the_page() -> None:
    scene = shown_scene(STATE)
    assert scene.array == midair.Array.preset("autd3", (2, 2))
    assert scene.points.tolist() == STATE["points"]
    assert scene.pressures is None
    assert scene.solver == ("uniform", {})
    assert scene.sound_speed == pytest.approx(346.13, abs=0.01)
    assert scene.plane.z == 0.18
    assert midair.Scene.parse(scene_text(scene)) == scene
    wall = {"point": [0.5, 0, 0], "normal": [-1, 0, 0], "kind": "rigid"}
    other = shown_scene(
        STATE
        | {"array": {"name": "own", "positions": [[0, 0, 0], [0.01, 0, 0]], "normals": [[0, 0, 1]] * 2}}
        | {"pressures": [100, 0], "signature": "twin", "obstacles": [wall]}
    )
    assert other.pressures.tolist() == [100, 0]
    assert other.signature == "twin"
    assert other.obstacles == [midair.Wall([0.5, 0, 0], [-1, 0, 0])]
    assert len(other.array) == 2
    free = shown_scene(STATE | {"quantization": "none"})
    assert free.array.quantization is None
    assert midair.Scene.parse(scene_text(free)).array.quantization is None


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        (lambda: autd3(frequency=41e3), "frequency = 41000 (its own is 40000)"),
        (lambda: autd3(weights=[2.0]), "weights"),
        (lambda: autd3(pressures=[1j]), "phases"),
        (lambda: autd3(points=np.linspace([-0.05, 0, 0.1], [0.05, 0, 0.1], 65)), "65 points"),
        (
            lambda: midair.Scene(midair.Array.preset("autd3", mask=[False] + [True] * 248), [[0, 0, 0.1]]),
            "mask",
        ),
        (
            lambda: midair.Scene(
                midair.Array.grid(3, 3, 0.01, directivity={"piston": 4.5e-3}), [[0, 0, 0.1]]
            ),
            "directivity",
        ),
        (lambda: autd3(source_pressure=2.0), "source_pressure 2.0 (its own is 4.386)"),
        (
            lambda: midair.Scene(midair.Array.grid(3, 3, 0.01, quantization={"phases": 8}), [[0, 0, 0.1]]),
            "quantization",
        ),
    ],
)
def test_what_the_page_does_not_know_is_refused(scene: Callable[[], midair.Scene], words: str) -> None:
    with pytest.raises(midair.SceneError, match=re.escape(words)) as refused:
        midair.view(scene())
    assert "\n" not in str(refused.value)


def test_solvers_are_method_a() -> None:
    scene = autd3(pressures=5000.0)
    for name in ("uniform", "greedy"):
        assert json.loads(scene_text(midair.solve(scene, name)))["solver"] == {"name": name}
    with pytest.warns(midair.SceneWarning, match="options of greedy"):
        scene_text(midair.solve(scene, "greedy", seed=3))
    with pytest.warns(midair.SceneWarning, match="the solver own"):
        assert "solver" not in json.loads(scene_text(midair.solve(scene, own)))
    with pytest.raises(midair.SceneError, match="of a matrix"):
        scene_text(midair.solve(midair.Propagation([[1.0]]), "naive"))
    with pytest.raises(TypeError, match="not list"):
        midair.view([scene])


def own(propagation, targets, weights):
    return propagation[0].conj() / np.abs(propagation[0]).max()


def test_without_anywidget_it_says_what_to_install(monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, "anywidget", None)
    monkeypatch.delitem(sys.modules, "midair._studio.widget", raising=False)
    with pytest.raises(midair.SceneError, match=re.escape('pip install "midair[notebook]"')):
        midair.view(autd3())


class Page:
    """A simulated page in place of a browser: it stores what Python sends, and sends its own state."""

    def __init__(self, view: View) -> None:
        self.widget = view.widget
        self.seen: list[str] = []
        self.widget.observe(lambda change: self.seen.append(change["new"]), "scene")

    def tell(self, **changes: object) -> None:
        # A message arrives in this form from a front end.
        self.widget.set_state({"state": json.dumps(STATE | changes), "metrics": {"naive": {"accuracy": 0.9}}})


@pytest.fixture
def shown(built: Path) -> Callable[[midair.Scene | midair.Solution], tuple[View, Page]]:
    pytest.importorskip("anywidget", reason="anywidget is missing")

    def shown(what: midair.Scene | midair.Solution) -> tuple[View, Page]:
        view = View(what, scene_text(what), folder=built)
        return view, Page(view)

    return shown


def test_a_view_begins_with_its_scene(shown) -> None:
    scene = autd3(pressures=900.0)
    view, page = shown(scene)
    assert view.scene == scene
    assert midair.Scene.parse(page.widget.scene) == scene
    assert page.widget.wasm == FILES["midair.wasm"]
    assert page.widget._esm == FILES["widget.mjs"].decode()
    assert (view.methods, view.metrics) == ((), {})
    data = view._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in data[0]
    assert {"scene", "state", "metrics", "wasm"} <= set(page.widget.keys)
    solution, _ = shown(midair.solve(scene, "fast"))
    assert solution.scene.solver == ("fast", {})
    assert repr(view) == "<midair.View of 1 points>"


def test_what_is_dragged_arrives(shown) -> None:
    view, page = shown(autd3())
    page.tell()
    assert view.points.tolist() == STATE["points"]
    assert view.pressures is None
    assert view.methods == ("uniform", "naive")
    assert view.metrics == {"naive": {"accuracy": 0.9}}
    assert view.scene == shown_scene(STATE)
    page.tell(points=[], pressures=[])
    assert view.points.shape == (0, 3)
    page.tell(pressures=[100, 200])
    assert view.pressures.tolist() == [100, 200]
    assert midair.judge(view.scene, np.zeros(996)).level == 0


def test_what_is_set_is_shown(shown) -> None:
    scene = autd3(pressures=900.0)
    view, page = shown(scene)
    view.points = [[0.02, 0, 0.2]]
    assert view.points.tolist() == [[0.02, 0, 0.2]]
    assert midair.Scene.parse(page.seen[-1]).points.tolist() == [[0.02, 0, 0.2]]
    page.tell()
    view.pressures = [300, 400]
    sent = midair.Scene.parse(page.seen[-1])
    assert sent.pressures.tolist() == [300, 400]
    assert sent.points.tolist() == STATE["points"]
    view.scene = scene
    page.tell()
    view.scene = scene
    assert len(page.seen) == 4, "the same scene again, because points were dragged since"
    assert view.scene == midair.Scene.parse(page.seen[-1]) == scene
    with pytest.raises(midair.SceneError, match="pressures"):
        view.points = [[0, 0, 0.1], [0.02, 0, 0.1]]
    with pytest.raises(midair.SceneError, match="weights"):
        view.scene = autd3(weights=3)
    assert view.scene == scene


def test_the_slice_goes_along_with_points_that_are_set(shown) -> None:
    view, page = shown(autd3())
    page.tell()
    view.points = [[0, 0, 0.18], [0, 0.02, 0.1]]
    assert view.scene.plane.z == 0.18, "a point is still on it"
    view.points = [[0, 0, 0.12], [0, 0.02, 0.1]]
    sent = midair.Scene.parse(page.seen[-1]).plane
    assert (sent.z, sent.size, sent.center) == (0.12, 0.18, (0, 0))
    view.scene = view.scene.replace(plane=midair.Plane(0.3, 0.1))
    view.points = [[0, 0, 0.15]]
    assert view.scene.plane.z == 0.3, "it went through no point"


def test_a_view_that_is_not_built_says_so(tmp_path: Path) -> None:
    pytest.importorskip("anywidget", reason="anywidget is missing")
    with pytest.raises(midair.SceneError, match="make studio"):
        View(autd3(), scene_text(autd3()), folder=tmp_path)


def test_the_page_of_the_docs_runs(shown, monkeypatch, built: Path) -> None:
    # These blocks need anywidget and a built page, so test_docs.py does not run them.
    monkeypatch.setattr(inspect.unwrap(View.__init__), "__defaults__", (built,))
    names: dict[str, object] = {}
    text = (ROOT / "docs" / "studio.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```py\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    for block in blocks:
        exec(compile(block, "docs/studio.md", "exec"), names)
    assert len(blocks) == 2
    assert names["studio"].points.tolist() == [[0.0, 0.02, 0.2]]
    assert names["solution"].metrics.uniformity > 0.99
