"""The studio from Python: its server, `midair studio`, and `midair.view` with a page that is played."""

import http.client
import json
import re
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import midair
from midair import cli
from midair.cli import studio as command
from midair.studio.built import BUILT
from midair.studio.server import POLICY, Server
from midair.studio.told import scene_text, shown_scene
from midair.studio.view import View

ROOT = Path(__file__).parents[2]

#: There so that a hang is a failure and not a hung suite.
HANG = 60

FILES = {
    "index.html": b"<!doctype html><title>midair</title>",
    "assets/index-1.js": b"export {};",
    "assets/index-1.css": b"body{}",
    "midair.wasm": b"\0asm\1\0\0\0",
    "widget.mjs": b"export default { render() {} };",
}

SCENE = """
[medium]
temperature = 20.0

[array]
preset = "autd3"

[[shape]]
kind = "circle"
center = [0.0, 0.0, 0.15]
radius = 0.02
step = 0.01
pressure = 500.0

[solver]
name = "fast"
"""

#: What the page tells Python: studio/src/types.ts.
STATE = {
    "array": {"preset": "autd3", "tiles": [2, 2]},
    "quantization": "board",
    "temperature": 25,
    "points": [[0.01, 0, 0.18], [-0.02, 0.03, 0.15]],
    "pressures": None,
    "methods": ["uniform", "naive"],
    "signature": "",
    "obstacles": [],
    "ear": None,
    "plane": {"z": 0.18, "size": 0.18, "center": [0, 0]},
    "view": "both",
    "slot": 0,
    "map": "viridis",
    "scale": "linear",
    "path": None,
}

Answer = tuple[int, dict[str, str], bytes]


def autd3(**scene) -> midair.Scene:
    return midair.Scene(midair.Array.preset("autd3"), scene.pop("points", [[0, 0, 0.15]]), **scene)


@pytest.fixture
def built(tmp_path: Path) -> Path:
    folder = tmp_path / "built"
    for name, content in FILES.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    (tmp_path / "secret.txt").write_text("secret")
    return folder


@pytest.fixture
def served(built: Path) -> Iterator[Server]:
    with Server('{"array": {}}', folder=built) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def ask(server: Server, path: str, method: str = "GET", **headers: str) -> Answer:
    line = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=HANG)
    try:
        line.putrequest(method, path, skip_host="Host" in headers)
        for name, value in headers.items():
            line.putheader(name, value)
        line.endheaders()
        answer = line.getresponse()
        return answer.status, dict(answer.getheaders()), answer.read()
    finally:
        line.close()


def test_files_are_served_as_what_they_are(served: Server) -> None:
    kinds = {"html": "text/html", "js": "text/javascript", "mjs": "text/javascript", "css": "text/css"}
    for name, content in FILES.items():
        status, headers, body = ask(served, f"/{name}?v=1")
        assert (status, body) == (200, content)
        kind = kinds.get(name.rpartition(".")[2], "application/wasm")
        assert headers["Content-Type"].partition(";")[0] == kind
        status, headers, body = ask(served, f"/{name}", "HEAD")
        assert (status, int(headers["Content-Length"]), body) == (200, len(content), b"")
    assert ask(served, "/")[2] == FILES["index.html"]
    assert ask(served, "/scene.json")[1]["Content-Type"] == "application/json"
    assert served.address == f"http://127.0.0.1:{served.server_port}/?scene"


@pytest.mark.parametrize(
    "path",
    ["/../secret.txt", "/assets/../../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt", "/assets",
     "/assets/", "//secret.txt", "/none.js", "http://127.0.0.1/../secret.txt", "/midair.wasm/", "/built"],
)  # fmt: skip
def test_nothing_else_is_served(served: Server, path: str) -> None:
    status, headers, body = ask(served, path)
    assert status == 404
    assert headers["Content-Security-Policy"] == POLICY
    assert b"secret\n" not in body


def test_only_this_machine_is_answered_and_only_asked_politely(served: Server) -> None:
    for host in ("127.0.0.1", "localhost", "LocalHost:80", f"localhost:{served.server_port}"):
        assert ask(served, "/", Host=host)[0] == 200
    for host in ("example.org", "127.0.0.1.example.org", "localhost.example.org:80", "evil@localhost", ""):
        assert ask(served, "/", Host=host)[0] == 403
    for method in ("POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE"):
        assert ask(served, "/", method)[0] == 501
    assert served.socket.getsockname()[0] == "127.0.0.1"


def test_every_answer_is_strict(served: Server) -> None:
    for answer in (
        ask(served, "/"),
        ask(served, "/none"),
        ask(served, "/", "POST"),
        ask(served, "/", Host="a"),
    ):
        headers = answer[1]
        assert headers["X-Content-Type-Options"] == "nosniff"
        assert headers["Cache-Control"] == "no-store"
        assert "default-src 'none'" in headers["Content-Security-Policy"]
        assert "unsafe-eval'" not in headers["Content-Security-Policy"].replace("'wasm-unsafe-eval'", "")
        assert headers["Server"].strip() == "midair"


def test_a_browser_that_leaves_is_no_news(served: Server, capfd: pytest.CaptureFixture[str]) -> None:
    for request in (b"GET / HTTP/1.1\r\n", b"\0\1\2\r\n\r\n", b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"):
        with socket.create_connection(("127.0.0.1", served.server_port), timeout=HANG) as line:
            # Reset at once, whatever was sent.
            line.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
            line.sendall(request)
    assert ask(served, "/")[0] == 200
    assert capfd.readouterr().err == ""


def test_without_a_scene_there_is_none(built: Path) -> None:
    with Server(folder=built) as server:
        assert "/scene.json" not in server.files
        assert server.address.endswith("/")


def test_ports_that_cannot_be_had(built: Path) -> None:
    with Server(folder=built) as server, pytest.raises(midair.SceneError, match="in use; leave it out"):
        Server(port=server.server_port, folder=built)
    for port in (-1, 65536):
        with pytest.raises(midair.SceneError, match=f"port is {port}: no port"):
            Server(port=port, folder=built)


Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """Runs the command line in this process: status, standard output, standard error."""

    def run(*arguments: object) -> tuple[int, str, str]:
        with pytest.raises(SystemExit) as left:
            cli.main(["studio", "--no-browser", *map(str, arguments)])
        out, err = capsys.readouterr()
        return left.value.code, out, err

    return run


def test_a_page_that_is_not_built_is_one_line(run: Run, monkeypatch, tmp_path: Path) -> None:
    monkeypatch.setattr(command, "Server", partial(Server, folder=tmp_path))
    status, out, err = run()
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
    assert "make studio" in err


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[array]\npreset = 'autd4'", "autd4"),
        (SCENE.replace("20.0", "20.0\nabsorption = 0.15"), "absorption = 0.15"),
        (SCENE.replace("pressure = 500.0", "pressure = 500.0\nweight = 2.0"), "weights"),
    ],
)
def test_a_scene_that_cannot_be_shown_is_one_line(
    run: Run, monkeypatch, tmp_path: Path, built: Path, text: str, words: str
) -> None:
    monkeypatch.setattr(command, "Server", partial(Server, folder=built))
    path = tmp_path / "scene.toml"
    path.write_text(text)
    status, out, err = run(path)
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
    assert words in err
    assert run(tmp_path / "none.toml")[0] == 2


@pytest.mark.skipif(sys.platform == "win32", reason="its Ctrl-C goes to the whole console")
def test_the_command_serves_a_scene_until_ctrl_c(built: Path, tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(SCENE)
    program = (
        "import functools, pathlib, sys; from midair import cli; from midair.cli import studio;"
        "studio.Server = functools.partial(studio.Server, folder=pathlib.Path(sys.argv[1]));"
        "cli.main(['studio', 'scene.toml', '--no-browser'])"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", program, str(built)],
        cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    with process:
        assert process.stdout is not None
        address = process.stdout.readline().strip()
        found = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/\?scene", address)
        assert found, address
        line = http.client.HTTPConnection("127.0.0.1", int(found[1]), timeout=HANG)
        line.request("GET", "/scene.json")
        shown = midair.Scene.parse(line.getresponse().read())
        line.close()
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=HANG)
    assert (process.returncode, out, err) == (130, "", "Ctrl-C ends it\ninterrupted\n")
    asked = midair.Scene.load(tmp_path / "scene.toml")
    assert len(asked.points) > 10
    assert shown == asked


def test_the_browser_is_opened(monkeypatch, built: Path) -> None:
    opened = []
    there = threading.Event()

    class Once(Server):
        def serve_forever(self, poll_interval: float = 0.5) -> None:
            assert there.wait(HANG)

    def browse(address: str) -> None:
        opened.append(address)
        there.set()

    monkeypatch.setattr(command, "Server", partial(Once, folder=built))
    monkeypatch.setattr(command.webbrowser, "open", browse)
    assert command.studio_command() == 0
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/", *opened)


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
        (lambda: autd3(density=1.2), "density = 1.2"),
        (lambda: autd3(weights=[2.0]), "weights"),
        (lambda: autd3(pressures=[1j]), "phases"),
        (lambda: autd3(points=np.linspace([-0.05, 0, 0.1], [0.05, 0, 0.1], 65)), "65 points"),
        (lambda: autd3().replace(plane=midair.Plane(axis="y", at=0, size=0.1)), "upright"),
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
    monkeypatch.delitem(sys.modules, "midair.studio.widget", raising=False)
    with pytest.raises(midair.SceneError, match=re.escape('pip install "midair[notebook]"')):
        midair.view(autd3())


class Page:
    """The page in place of a browser: it takes what Python sends, and tells its own state."""

    def __init__(self, view: View) -> None:
        self.widget = view.widget
        self.seen: list[str] = []
        self.widget.observe(lambda change: self.seen.append(change["new"]), "scene")

    def tell(self, **changes: object) -> None:
        # As a message of the front end arrives.
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


def test_a_view_that_is_not_built_says_so(tmp_path: Path) -> None:
    pytest.importorskip("anywidget", reason="anywidget is missing")
    with pytest.raises(midair.SceneError, match="make studio"):
        View(autd3(), scene_text(autd3()), folder=tmp_path)


def test_the_page_of_the_docs_runs(shown, monkeypatch, built: Path) -> None:
    # Its blocks need anywidget and a built page, and are not among those that test_docs.py runs.
    monkeypatch.setattr(View.__init__, "__defaults__", (built,))
    names: dict[str, object] = {}
    text = (ROOT / "docs" / "studio.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```py\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    for block in blocks:
        exec(compile(block, "docs/studio.md", "exec"), names)
    assert len(blocks) == 2
    assert names["studio"].points.tolist() == [[0.1, 0.07, 0.2]]
    assert names["solution"].metrics.uniformity > 0.99


@pytest.mark.skipif(not (BUILT / "index.html").is_file(), reason="`make studio` has built nothing")
def test_the_built_page_is_whole() -> None:
    for name in ("index.html", "midair.wasm", "widget.mjs"):
        assert (BUILT / name).stat().st_size > 100, name
    with Server() as server:
        page = (BUILT / "index.html").read_text(encoding="utf-8")
        used = re.findall(r'(?:src|href)="\./([^"]+)"', page)
        assert used
        assert {f"/{name}" for name in used} <= set(server.files)
    assert (BUILT / "midair.wasm").read_bytes().startswith(b"\0asm")
