"""`midair.doctor` names the faults that a simulated array has, and no others."""

import json
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import midair
from microphones import Complex, Real
from midair._cli import main
from midair._measuring.doctor import _named

Named = list[tuple[str, tuple[int, ...]]]


class Air:
    """A pair of boards of point sources that face each other, with faults, in float64: eq. (5)."""

    def __init__(self, side: int, seed: int, *, faults: bool = True, speed: float = 346.13) -> None:
        self.rng = rng = np.random.default_rng(seed)
        grid = (np.arange(side) - (side - 1) / 2) * 10e-3
        x, y = (each.ravel() for each in np.meshgrid(grid, grid))
        below, above = (np.c_[x, y, np.full(len(x), z)] for z in (-0.08, 0.08))
        self.positions = np.concatenate([below, above])
        up = np.tile([0.0, 0.0, 1.0], (len(x), 1))
        self.array = midair.Array(self.positions, np.concatenate([up, -up]))
        self.places = np.array([[0.021, 0.012, 0.01], [-0.017, 0.024, -0.012], [0.011, -0.023, 0.019]])
        n, self.believed = len(self.positions), 346.13
        self.response = (1 + 0.05 * rng.normal(size=n)) * np.exp(0.1j * rng.normal(size=n))
        self.order, self.speed = np.arange(n), speed
        self.named: Named = []
        if faults:
            self._break(rng.permutation(n).tolist())

    def _break(self, drawn: list[int]) -> None:
        """Adds twelve faults, and lists them in `named`."""
        dead, weak, turned = drawn[:3], drawn[3:5], drawn[5:7]
        pairs = [tuple(sorted(drawn[7:9])), tuple(sorted(drawn[9:11]))]
        self.response[dead] = 0
        self.response[weak] *= 0.5
        self.response[turned] *= -1
        for i, j in pairs:
            self.order[[i, j]] = self.order[[j, i]]
        self.response[len(self.response) // 2 :] *= np.exp(1.3j)
        self.response *= 0.8
        self.speed = 350.0
        kinds = (("dead", dead), ("weak", weak), ("reversed", turned))
        self.named = [(kind, (i,)) for kind, which in kinds for i in which]
        self.named += [("swapped", pair) for pair in pairs]
        self.named += [("delay", (1,)), ("level", ()), ("sound speed", ())]

    def matrix(self) -> Complex:
        """Returns the pressures (M, N) in Pa of each transducer at full drive."""
        r = np.linalg.norm(self.places[:, None] - self.positions, axis=2)
        p = self.array.source_pressure / r * np.exp(2j * np.pi * 40e3 / self.speed * r)
        return np.asarray(p[:, self.order] * self.response)

    def reader(self, noise: float, phased: bool) -> Any:
        matrix = self.matrix()
        usual = noise * np.sqrt(np.mean(np.sum(np.abs(matrix) ** 2, axis=1)))

        def read(drive: Complex) -> Complex | Real:
            p, off = matrix @ drive, usual * self.rng.normal(size=(2, len(matrix)))
            return p + (off[0] + 1j * off[1]) / np.sqrt(2) if phased else np.abs(np.abs(p) + off[0])

        return read

    def report(self, noise: float = 0.01, phased: bool = False) -> midair.Report:
        reported = self.places + 0.1e-3 * self.rng.normal(size=self.places.shape)
        read = self.reader(noise, phased)
        return midair.doctor(self.array, read, microphones=reported, boards=2, sound_speed=self.believed)


def named(report: midair.Report) -> Named:
    return sorted((fault.kind, fault.where) for fault in report.faults)


@pytest.mark.slow
@pytest.mark.parametrize("phased", [False, True])
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_twelve_faults_are_named_and_no_other(seed: int, phased: bool) -> None:
    air = Air(10, seed)
    report = air.report(phased=phased)
    assert len(air.named) == 12
    assert named(report) == sorted(air.named)
    assert report.seconds <= 60
    sizes = {fault.kind: fault.size for fault in report.faults}
    assert sizes["sound speed"] == pytest.approx(350, abs=1)
    assert sizes["level"] == pytest.approx(0.8, abs=0.04)
    assert sizes["delay"] == pytest.approx(np.degrees(1.3), abs=5)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_no_fault_is_invented(seed: int) -> None:
    report = Air(8, seed, faults=False).report(noise=0.03)
    assert named(report) == []
    assert "no fault" in report.table


@pytest.mark.slow
def test_a_board_that_is_mirrored_and_one_that_is_silent_are_named() -> None:
    air = Air(8, 5, faults=False)
    air.order = np.arange(128).reshape(2, 8, 8)[:, :, ::-1].ravel()
    report = air.report()
    assert [fault.kind for fault in report.faults] == ["order"]
    assert np.array_equal(report.order, air.order)
    air = Air(8, 6, faults=False)
    air.response[64:] = 0
    assert named(air.report()) == [("board dead", (1,))]


@pytest.mark.slow
def test_a_report_is_of_what_a_board_plays_and_is_written_whole(tmp_path: Path) -> None:
    places = [[0.01, 0.02, 0.1], [-0.02, 0.01, 0.09]]
    with midair.connect("nano16:loop") as board:
        pressures = midair.Scene(board.board.array, places).propagation().copy()
        pressures[:, 3] = 0
        begin = time.monotonic()
        read = lambda _: np.abs(pressures @ board.emitting)  # noqa: E731
        report = midair.doctor(board, read, microphones=places, seconds=5)
        assert time.monotonic() - begin > 0.5 * report.seconds
        assert board.state == "off"
    assert named(report) == [("dead", (3,))]
    report.write(tmp_path / "report.json")
    record = json.loads((tmp_path / "report.json").read_text("utf-8"))
    assert record["faults"][0]["text"] == "transducer 3 is silent"
    assert len(record["response"]) == 16
    report.write(tmp_path / "report.txt")
    assert (tmp_path / "report.txt").read_text("utf-8").startswith(report.table)


#: Values to both sides of a limit that docs/measuring.md states or that the source explains: the fault of the
#: second value, which no diagnosis of the first value has.
LIMITS: dict[str, tuple[str, Any, Any]] = {
    "gain": ("weak", 0.76, 0.74),
    "no gain": ("dead", 0.16, 0.14),
    "unsure gain": ("weak", (0.66, 0.1), (0.54, 0.1)),
    "phase": ("phase", np.exp(np.radians(49) * 1j), np.exp(np.radians(-51) * 1j)),
    "turn": ("reversed", np.exp(np.radians(129) * 1j), np.exp(np.radians(131) * 1j)),
    "delay": ("delay", np.exp(np.radians(19) * 1j), np.exp(np.radians(-21) * 1j)),
    "level": ("level", 1.09, 1.12),
    "speed": ("sound speed", 1.4, -1.6),
    "unsure speed": ("sound speed", (3.9, 1.0), (4.1, 1.0)),
    "board": ("board dead", 8, 10),
    "misfit": ("unexplained", 0.34, 0.36),
}


@pytest.mark.parametrize("name", LIMITS)
def test_the_limits_are_those_of_the_documentation(name: str) -> None:
    kind, *values = LIMITS[name]
    boards, scene = np.arange(20) // 10, midair.Scene(midair.Array.grid(5, 4, 10e-3), [[0, 0, 0.1]])

    def kinds(value: Any) -> set[str]:
        value, error = value if isinstance(value, tuple) else (value, 0.0)
        relative, middle = np.ones(20, complex), np.ones(2, complex)
        relative[3] = value if name in ("gain", "no gain", "unsure gain", "phase", "turn") else 1
        middle[1] = value if name in ("delay", "level") else 1
        calibration = SimpleNamespace(
            scene=scene, microphones=scene.points, microphones_error=np.zeros((1, 3)), outlying=(),
            dead=list(range(10, 10 + value)) if name == "board" else [],
            sound_speed=scene.sound_speed + (value if kind == "sound speed" else 0), sound_speed_error=error,
        )  # fmt: skip
        found: Any = SimpleNamespace(
            relative=relative, middle=middle, error=np.full(20, error), spread=0.0, cycles=(), base="",
            calibration=calibration, unexplained=value if name == "misfit" else 0.0,
        )  # fmt: skip
        return {fault.kind for fault in _named(found, boards, np.ones(20, bool), scene, True)[0]}

    below, above = (kinds(value) for value in values)
    assert kind not in below
    assert kind in above


def test_what_cannot_be_is_refused_by_a_line(tmp_path: Path) -> None:
    array, places = midair.Array.grid(8, 8, 10e-3), [[0.01, 0.02, 0.1]]
    with pytest.raises(midair.SceneError, match=r"seconds is 1\.0: 64 transducers need 2 s, or more"):
        midair.doctor(array, lambda drive: [1.0], microphones=places, seconds=1.0)
    with pytest.raises(midair.SceneError, match="read is 3: give a function"):
        midair.doctor(array, 3, microphones=places)  # type: ignore[arg-type]
    with pytest.raises(midair.SceneError, match="boards is 3: give how many equal parts"):
        midair.doctor(array, lambda drive: [1.0], microphones=places, boards=3)


@pytest.mark.slow
def test_the_command_reads_files_and_simulates(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    places = [["--microphone", each] for each in ("0.01,0.02,0.1", "-0.02,0.01,0.09")]
    options = ["doctor", "nano16:loop", *places[0], *places[1]]
    with pytest.raises(SystemExit) as left:
        main([*options, "--plan", str(tmp_path / "plan.npz")])
    assert left.value.code == 0
    with np.load(tmp_path / "plan.npz") as plan:
        pressures = midair.Scene(midair.Board("nano16").array, plan["microphones"]).propagation().copy()
        pressures[:, 5] *= -1
        np.savetxt(tmp_path / "read.csv", np.abs(plan["drives"] @ pressures.T), delimiter=",")
    with pytest.raises(SystemExit) as left:
        main([*options, "--readings", str(tmp_path / "read.csv"), "-o", str(tmp_path / "report.txt")])
    assert left.value.code == 0
    assert "transducer 5 is connected the wrong way round" in (tmp_path / "report.txt").read_text("utf-8")
    with pytest.raises(SystemExit) as left:
        main([*options, "--simulate", "dead 3, swapped 1"])
    assert left.value.code == 2
    assert 'simulate is "swapped 1": give some of' in capsys.readouterr().err
