"""A sweep on a Dask cluster of two real worker processes, one of which is killed: no result changes."""

import json
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import midair

BIN = Path(sys.executable).parent

#: Time limit in s, so that a hang is a failed test and not a hung test suite.
HANG = 60

#: A sweep that takes some seconds, in ten chunks.
SWEEP = """
seeds = 600
[array]
preset = "paper20"
[points]
count = 8
x = [-0.1, 0.1]
y = [-0.1, 0.1]
z = 0.15
[solver]
name = "lm"
"""


def sweep(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "midair", "sweep", "sweep.toml", *arguments]
    return subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8")


class Cluster:
    """A Dask scheduler and two workers of one thread each."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        file = folder / "scheduler.json"
        self.processes = [self.start("scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", file)]
        self.until(lambda: file.is_file() and file.stat().st_size > 0)
        self.address = json.loads(file.read_text("utf-8"))["address"]
        host = ["--host", "127.0.0.1", "--nthreads", "1", "--no-nanny", "--local-directory", folder]
        self.processes += [self.start("worker", self.address, *host) for _ in range(2)]

    def start(self, *arguments: object) -> subprocess.Popen[bytes]:
        command = [BIN / "dask", *map(str, arguments), "--no-dashboard"]
        return subprocess.Popen(command, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def until(self, there: Callable[[], object]) -> None:
        end = time.monotonic() + HANG
        while not there():
            assert time.monotonic() < end
            time.sleep(0.02)

    def close(self) -> None:
        for process in self.processes:
            process.kill()
            process.wait()


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    (tmp_path / "sweep.toml").write_text(SWEEP, "utf-8")
    made = Cluster(tmp_path)
    yield made
    made.close()


@pytest.mark.long
def test_a_killed_worker_changes_no_number(cluster: Cluster, tmp_path: Path) -> None:
    running = sweep(tmp_path, "--output", "far.csv", "--scheduler", cluster.address)
    # The first chunk is stored, so both workers now compute other chunks.
    cluster.until(lambda: running.poll() is not None or list(tmp_path.glob(".far.csv.chunks/*/*.npz")))
    assert running.poll() is None, running.communicate()
    cluster.processes[1].kill()
    out, err = running.communicate(timeout=HANG)
    assert running.returncode == 0, (out, err)
    near = sweep(tmp_path, "--output", "near.csv")
    assert not near.communicate(timeout=HANG)[1]
    assert (tmp_path / "far.csv").read_bytes() == (tmp_path / "near.csv").read_bytes()
    assert len((tmp_path / "far.csv").read_text("utf-8").splitlines()) == 601


@pytest.mark.slow
def test_a_scheduler_that_is_lost_is_one_line_and_keeps_what_is_done(cluster: Cluster, tmp_path: Path) -> None:
    running = sweep(tmp_path, "--output", "far.csv", "--scheduler", cluster.address)
    cluster.until(lambda: running.poll() is not None or list(tmp_path.glob(".far.csv.chunks/*/*.npz")))
    cluster.processes[0].kill()
    out, err = running.communicate(timeout=HANG)
    assert running.returncode == 2, (out, err)
    assert err.count("\n") == 1, err
    assert "lost" in err
    assert list(tmp_path.glob(".far.csv.chunks/*/*.npz"))


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_keeps_what_is_done(cluster: Cluster, tmp_path: Path) -> None:
    running = sweep(tmp_path, "--output", "far.csv", "--scheduler", cluster.address)
    cluster.until(lambda: running.poll() is not None or list(tmp_path.glob(".far.csv.chunks/*/*.npz")))
    running.send_signal(signal.SIGINT)
    out, err = running.communicate(timeout=HANG)
    assert (running.returncode, out, err) == (130, "", "interrupted\n")
    assert list(tmp_path.glob(".far.csv.chunks/*/*.npz"))


@pytest.mark.slow
def test_a_scheduler_that_does_not_answer_is_one_line_within_ten_seconds(tmp_path: Path) -> None:
    (tmp_path / "sweep.toml").write_text(SWEEP, "utf-8")
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        refused = sweep(tmp_path, "--output", "far.csv", "--scheduler", address)
        _, err = refused.communicate(timeout=HANG)
    assert refused.returncode == 2
    assert err.count("\n") == 1
    assert f'scheduler "{address}" does not answer' in err
    assert not list(tmp_path.glob("*.csv"))


@pytest.mark.slow
def test_trials_of_faults_are_the_same_on_the_cluster(cluster: Cluster) -> None:
    array = midair.Array.grid(12, 12, 10e-3)
    scene = midair.Scene(array, [[-0.02, 0, 0.12], [0.03, 0.01, 0.12]])
    requested = {"phase": 20, "tilt": 1, "temperature": 5, "trials": 40}
    near, far = (midair.tolerate(scene, scheduler=address, **requested) for address in (None, cluster.address))
    assert far.status == "done"
    assert near.to_dict() == far.to_dict()


@pytest.mark.slow
def test_a_function_solves_on_the_cluster(cluster: Cluster) -> None:
    # A function that is no module's own, as in a notebook, is sent to the workers as it is.
    def foci(propagation, targets, weights):
        return propagation.conj().sum(axis=0) / abs(propagation).sum(axis=0)

    request = {
        "array": {"preset": "paper20"},
        "points": {"count": 2, "x": [-0.05, 0.05], "y": [-0.05, 0.05], "z": 0.15},
        "solver": {"name": foci},
        "seeds": 70,
    }
    near, far = (midair.sweep(request, scheduler=address) for address in (None, cluster.address))
    assert near.keys() == far.keys()
    assert all((near[name] == far[name]).all() for name in near)
