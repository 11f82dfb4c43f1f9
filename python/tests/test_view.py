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
from midair._studio.view import KEYS, View, misfits, scene_text
from pages import FILES, SHOWN, autd3, build

ROOT = Path(__file__).parents[2]
POINTS = [point["position"] for point in SHOWN["points"]]


@pytest.fixture
def built(tmp_path: Path) -> Path:
    return build(tmp_path / "built")


def test_scenes_survive_the_page() -> None:
    scene = midair.Scene.parse(json.dumps(SHOWN))
    assert scene.array == midair.Array.preset("autd3", (2, 2))
    assert scene.plane.z == 0.18
    assert midair.Scene.parse(scene_text(scene)) == scene


@pytest.mark.parametrize(
    "scene",
    [
        lambda: autd3(bead={"radius": 1.2e-3, "density": 900.0}, signature="trap"),
        lambda: autd3(source_pressure=2.0),
        lambda: midair.Scene(midair.Array.preset("autd3", mask=[False] + [True] * 248), [[0, 0, 0.1]]),
        lambda: midair.Scene(
            midair.Array.grid(3, 3, 0.01, directivity={"piston": 4.5e-3}, quantization={"phases": 8}),
            [[0, 0, 0.1]],
        ),
        lambda: autd3(weights=[1.0], pressures=[500 + 0j]),
    ],
)
def test_the_page_gets_what_it_keeps(scene: Callable[[], midair.Scene]) -> None:
    assert midair.Scene.parse(scene_text(scene())) == scene()


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        (lambda: autd3(frequency=41e3), "medium.frequency is 41000.0: the page has 40000"),
        (lambda: autd3(weights=[2.0]), "points[0].weight is 2.0: the page has 1"),
        (lambda: autd3(pressures=[1j]), "points[0].phase is 1.57"),
        (
            lambda: autd3(points=np.linspace([-0.05, 0, 0.1], [0.05, 0, 0.1], 65)),
            "points is 65: the page has at most 64",
        ),
        (
            lambda: autd3(
                obstacles=[
                    midair.Mesh(
                        np.array([[0, 0, 0.2], [0.01, 0, 0.2], [0, 0.01, 0.2], [0, 0, 0.21]]),
                        [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
                    )
                ]
            ),
            "obstacles[0].vertices is [[0.0",
        ),
    ],
)
def test_what_the_page_does_not_know_is_refused(scene: Callable[[], midair.Scene], words: str) -> None:
    with pytest.raises(midair.SceneError, match=re.escape(words)) as refused:
        midair.view(scene())
    assert "\n" not in str(refused.value)


def test_anything_that_the_page_does_not_have_is_found() -> None:
    assert list(misfits(SHOWN, KEYS)) == []
    line = 'motion is {"rate": 1}: the page has no place for it'
    assert list(misfits(SHOWN | {"motion": {"rate": 1}}, KEYS)) == [line]
    line = "medium.wind is 3: the page has no place for it"
    assert list(misfits(SHOWN | {"medium": {"wind": 3}}, KEYS)) == [line]


@pytest.mark.parametrize("name", midair.solvers())
def test_solvers_are_method_a_with_their_options(name: str) -> None:
    solution = midair.solve(autd3(), name)
    shown = midair.Scene.parse(scene_text(solution)).solver
    assert shown[0] == name
    assert midair.Solver(solution.scene.array, name, **shown[1]).options == solution.options


def test_a_solver_that_the_page_does_not_have() -> None:
    scene = autd3(pressures=5000.0)
    assert json.loads(scene_text(midair.solve(scene, "greedy", seed=3)))["solver"]["seed"] == 3
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
        state = json.dumps(SHOWN | changes)
        metrics = {"naive": {"accuracy": 0.9}}
        self.widget.set_state({"state": state, "methods": ["uniform", "naive"], "metrics": metrics})


@pytest.fixture
def shown(built: Path) -> Callable[[midair.Scene | midair.Solution], tuple[View, Page]]:
    pytest.importorskip("anywidget", reason="anywidget is missing")

    def shown(what: midair.Scene | midair.Solution) -> tuple[View, Page]:
        view = View(scene_text(what), folder=built)
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
    assert solution.scene.solver[0] == "fast"
    assert repr(view) == "<midair.View of 1 points>"


def test_what_is_dragged_arrives(shown) -> None:
    view, page = shown(autd3())
    page.tell()
    assert view.points.tolist() == POINTS
    assert view.pressures is None
    assert view.methods == ("uniform", "naive")
    assert view.metrics == {"naive": {"accuracy": 0.9}}
    assert view.scene == midair.Scene.parse(json.dumps(SHOWN))
    page.tell(points=[point | {"pressure": 100 * (k + 1)} for k, point in enumerate(SHOWN["points"])])
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
    assert sent.points.tolist() == POINTS
    view.scene = scene
    page.tell()
    view.scene = scene
    assert len(page.seen) == 4, "the same scene again, because points were dragged since"
    assert view.scene == midair.Scene.parse(page.seen[-1]) == scene
    with pytest.raises(midair.SceneError, match="pressures"):
        view.points = [[0, 0, 0.1], [0.02, 0, 0.1]]
    with pytest.raises(midair.SceneError, match="weight is 3"):
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
        View(scene_text(autd3()), folder=tmp_path)


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
