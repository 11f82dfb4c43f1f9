"""Measures the delay of `midair serve` from a client's message to the changed frame, beside a busy program.

`python bench/serve.py [BUSY PROGRAMS] [MESSAGES] [CONNECTIONS]` starts the server on a simulated board, which
writes its frames into a pipe, 1,000 per second as for AUTD3. The script also starts programs that compute all
the time, and one that opens connections without the token and sends damaged datagrams. It reads the clock
before each message and when the first changed frame arrives.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from websockets.sync.client import connect

import midair
from midair._boards.transport import before_what_computes

sys.path.append(str(Path(__file__).resolve().parents[1] / "python" / "tests"))
import tactons

#: Number of messages of each kind, and range of the time between two messages in s.
MESSAGES, APART = 400, (0.02, 0.04)

BUSY = "while True: pass"

#: A program that opens many connections, sends half a request by some, and damaged datagrams.
STRANGERS = """
import socket, sys, time
port, osc, count = map(int, sys.argv[1:])
udp, open_ones = socket.socket(socket.AF_INET, socket.SOCK_DGRAM), []
for k in range(count):
    open_ones.append(socket.create_connection(("127.0.0.1", port)))
    open_ones[-1].sendall(b"GET / HTTP/1.1\\r\\n" * (k % 2))
    udp.sendto(b"#bundle\\0" + bytes(8) + b"\\xff\\xff\\xff\\xfcaaaa", ("127.0.0.1", osc))
    if len(open_ones) > 100:
        open_ones.pop(0).close()
    time.sleep(1e-3)
print(f"{count} connections without the token")
"""

Frame = tuple[float, bytes]


class Frames:
    """Frames read from a pipe, each with its time of arrival."""

    def __init__(self, pipe: Path) -> None:
        self.length = len(midair.Board("autd3").off_frame)
        self.came: list[Frame] = []
        self._news = threading.Condition()
        self._pipe = pipe
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        before_what_computes()
        with self._pipe.open("rb", buffering=0) as stream:
            data = b""
            while read := stream.read(self.length - len(data)):
                data += read
                if len(data) == self.length:
                    with self._news:
                        self.came.append((time.monotonic(), data))
                        self._news.notify()
                    data = b""

    def first(self, after: int, fits: Callable[[bytes], bool]) -> float:
        """Waits for a frame for which `fits` is true, after the first `after` frames; returns its time."""
        with self._news:
            while True:
                for came, frame in self.came[after:]:
                    if fits(frame):
                        return came
                if not self._news.wait(5):
                    raise TimeoutError("no frame came")


def points(address: str, frames: Frames, messages: int) -> list[float]:
    """Returns times from sending a point in a binary message to the first frame that differs."""
    found, random = [], np.random.default_rng(0)
    with connect(address, max_queue=None) as client:
        client.recv()
        for k in range(messages):
            at = [0.01 * (k % 2), 0.002 * (k % 7), 0.15, 0.0]
            seen = len(frames.came)
            before = frames.came[-1][1]
            begin = time.monotonic()
            client.send(np.array(at, "<f4").tobytes())
            found.append(frames.first(seen, lambda frame, before=before: frame != before) - begin)
            rest(random, lambda: client.send('{"keep": true}'))
    return found


def parameters(address: str, frames: Frames, messages: int) -> list[float]:
    """Returns times in s from a change of an Adaptics tacton's intensity to a frame that is off or on.

    It must be off if the intensity has become 0, and on otherwise.
    """
    off = midair.Board("autd3").off_frame
    shown = tactons.keyframe(0, (0, 0, 0), ("circle", {"radius": 10, "am_freq": 0}), "on")
    pattern = tactons.pattern([shown], {"on": (1, 0, 1)}, shift=(0, 0, 150))
    found, random = [], np.random.default_rng(0)
    with connect(address, max_queue=None) as client:
        threading.Thread(target=lambda: [None for _ in client], daemon=True).start()

        def send(command: str, **data: Any) -> None:
            client.send(json.dumps({"cmd": command, "data": data}))

        send("update_pattern", pattern_json=json.dumps(pattern))
        send("update_playstart", playstart=1, playstart_offset=0)
        time.sleep(0.5)
        unmoved = np.eye(4).tolist()
        for k in range(messages):
            given = {"time": 0, "user_parameters": {"on": k % 2}, "geometric_transform": unmoved}
            seen = len(frames.came)
            begin = time.monotonic()
            send("update_parameters", evaluator_params=given)
            found.append(frames.first(seen, lambda frame, on=k % 2: (frame != off) == bool(on)) - begin)
            rest(random, lambda: None)
    return found


def rest(random: np.random.Generator, live: Callable[[], None]) -> None:
    """Waits for a random time, and calls `live` halfway, so that the board keeps playing."""
    pause = random.uniform(*APART) / 2
    time.sleep(pause)
    live()
    time.sleep(pause)


def main(programs: int = 1, messages: int = MESSAGES, connections: int = 0) -> None:
    busy = [subprocess.Popen([sys.executable, "-c", BUSY]) for _ in range(programs)]
    try:
        with tempfile.TemporaryDirectory() as folder:
            measure(Path(folder) / "frames.bin", messages, connections)
    finally:
        for each in busy:
            each.kill()


def measure(pipe: Path, messages: int, connections: int) -> None:
    """Prints the quantiles of the delay for each kind of message."""
    os.mkfifo(pipe)
    frames = Frames(pipe)
    command = [sys.executable, "-m", "midair", "serve", "--on", f"file:{pipe}"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, encoding="utf-8") as server:
        assert server.stdout is not None
        # The client gets a higher priority than the busy programs, because its own delay must not count.
        before_what_computes()
        address, osc, adaptics = (server.stdout.readline().split()[0] for _ in range(3))
        while not frames.came:
            time.sleep(0.01)
        ports = (re.findall(r":(\d+)", each)[0] for each in (address, osc))
        others = subprocess.Popen([sys.executable, "-c", STRANGERS, *ports, str(connections)])
        for name, measured in (
            ("a point at rest", points(address, frames, messages)),
            ("a parameter of a tacton in motion", parameters(adaptics, frames, messages)),
        ):
            took = 1e3 * np.sort(measured)
            shown = ", ".join(
                f"{label} {np.quantile(took, share):.2f}"
                for label, share in (("median", 0.5), ("p90", 0.9), ("p99", 0.99), ("most", 1.0))
            )
            print(f"{name}: {len(took)} messages, {shown} ms")
        others.wait()
        server.terminate()


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
