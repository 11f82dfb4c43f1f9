"""The web server of the studio's page, and the command `midair studio`."""

import http.client
import re
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pytest

import midair
from midair import _cli as cli
from midair._cli import serve as command
from midair._studio.server import POLICY, Server
from midair._studio.view import BUILT
from pages import FILES, build

#: Time limit in s, so that a hang is a failed test and not a hung test suite.
HANG = 60

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

Answer = tuple[int, dict[str, str], bytes]


@pytest.fixture
def built(tmp_path: Path) -> Path:
    (tmp_path / "secret.txt").write_text("secret", "utf-8")
    return build(tmp_path / "built")


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


def test_only_this_machine_is_answered_and_only_requested_politely(served: Server) -> None:
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
        assert headers["Cross-Origin-Opener-Policy"] == "same-origin"
        assert headers["Cross-Origin-Resource-Policy"] == "same-origin"
        assert headers["Permissions-Policy"] == "serial=(self)"
        assert "default-src 'none'" in headers["Content-Security-Policy"]
        assert "unsafe-eval'" not in headers["Content-Security-Policy"].replace("'wasm-unsafe-eval'", "")
        assert headers["Server"].strip() == "midair"


def test_a_browser_that_leaves_is_no_news(served: Server, capfd: pytest.CaptureFixture[str]) -> None:
    for request in (b"GET / HTTP/1.1\r\n", b"\0\1\2\r\n\r\n", b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"):
        with socket.create_connection(("127.0.0.1", served.server_port), timeout=HANG) as line:
            # Linger 0: the connection is reset at once, whatever was sent.
            line.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, b"\1\0\0\0\0\0\0\0")
            line.sendall(request)
    assert ask(served, "/")[0] == 200
    assert capfd.readouterr().err == ""


def test_without_a_scene_there_is_none(built: Path) -> None:
    with Server(folder=built) as server:
        assert "/scene.json" not in server.files
        assert server.address.endswith("/")


def test_ports_that_cannot_be_had(built: Path) -> None:
    refused = r"(in use|denied|forbidden)[^;]*; leave it out"
    with Server(folder=built) as server, pytest.raises(midair.SceneError, match=refused):
        Server(port=server.server_port, folder=built)
    for port in (-1, 65536):
        with pytest.raises(midair.SceneError, match=f"port is {port}: no port"):
            Server(port=port, folder=built)


Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """Returns a function that runs `midair studio` in this process:
    exit status, standard output, standard error.
    """

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
        (SCENE.replace("20.0", "20.0\nfrequency = 25e3"), "medium.frequency is 25000"),
        (SCENE.replace("pressure = 500.0", "pressure = 500.0\nweight = 2.0"), "points[0].weight is 2.0"),
    ],
)
def test_a_scene_that_cannot_be_shown_is_one_line(
    run: Run, monkeypatch, tmp_path: Path, built: Path, text: str, words: str
) -> None:
    monkeypatch.setattr(command, "Server", partial(Server, folder=built))
    path = tmp_path / "scene.toml"
    path.write_text(text, "utf-8")
    status, out, err = run(path)
    assert (status, out) == (2, "")
    assert err.count("\n") == 1
    assert words in err
    assert run(tmp_path / "none.toml")[0] == 2


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="its Ctrl-C goes to the whole console")
def test_the_command_serves_a_scene_until_ctrl_c(built: Path, tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(SCENE, "utf-8")
    program = (
        "import functools, pathlib, sys; from midair import _cli as cli; from midair._cli import serve;"
        "serve.Server = functools.partial(serve.Server, folder=pathlib.Path(sys.argv[1]));"
        "cli.main(['studio', 'scene.toml', '--no-browser'])"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", program, str(built)],
        cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8",
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
    requested = midair.Scene.load(tmp_path / "scene.toml")
    assert len(requested.points) > 10
    assert shown == requested


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


@pytest.mark.skipif(not (BUILT / "index.html").is_file(), reason="`make studio` has built nothing")
def test_the_built_page_is_whole() -> None:
    for name in ("index.html", "midair.wasm", "widget.mjs"):
        assert (BUILT / name).stat().st_size > 100, name
    with Server() as server:
        page = (BUILT / "index.html").read_text("utf-8")
        used = re.findall(r'(?:src|href)="\./([^"]+)"', page)
        assert used
        assert {f"/{name}" for name in used} <= set(server.files)
    assert (BUILT / "midair.wasm").read_bytes().startswith(b"\0asm")
