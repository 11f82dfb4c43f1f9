"""Simulates the makers' own gateware with midair's bytes, compares the output of its pins with the drive that
midair reports, and records bytes and output.

python gateware/run.py [FOLDER]

FOLDER contains the makers' repositories, by default gateware/makers. The records are in golden/gateware.
This needs Debian's packages ghdl, simavr, libsimavr-dev and gcc.
"""

import json
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import midair

HERE = Path(__file__).parent
RECORDS = HERE.parent / "golden" / "gateware"
GHDL = ["--std=08", "-fsynopsys"]

#: Repositories of the makers, with the commits that were simulated.
MAKERS = {
    "SonicSurface": ("https://github.com/upnalab/SonicSurface", "666c2dd53a0e3cecfac1c6a8a305a23f026fe9b2"),
    "OpenMPD_Hardware": (
        "https://github.com/RMResearch/OpenMPD_Hardware",
        "82c9885bc8f1c34170d89b6007fc7e68b145969d",
    ),
    "Ultraino": ("https://github.com/asiermarzo/Ultraino", "3d5a02a6e16bacf5d64d86a89ebd723af4d62fc4"),
}

Pins = NDArray[np.complex128]
#: A function that plays the frame in a file and returns the drive of each channel, (channels,), up to a
#: common phase.
Play = Callable[[Path], Pins]


@dataclass(frozen=True)
class Case:
    """A kind of board, and the function that prepares the gateware of its makers in a folder."""

    board: str
    ready: Callable[[Path, Path], Play]


def harmonic(times: NDArray[np.float64], levels: NDArray[np.int64], period: float) -> Pins:
    """Returns the first harmonic of levels (K, pins) that change at times (K + 1,).

    It is c = pi / T times the integral of level(t) exp(2 pi j t / T) over a period T. A pulse of half a
    period has |c| = 1, and a later pulse has a larger phase.
    """
    edges = np.exp(2j * np.pi * times / period)
    return np.asarray((edges[1:] - edges[:-1]) @ levels / 2j)


def ghdl(folder: Path, *words: str) -> str:
    run = subprocess.run(["ghdl", *words], cwd=folder, capture_output=True, encoding="utf-8")
    if run.returncode:
        raise SystemExit(f"ghdl {' '.join(words)}:\n{run.stdout[-2000:]}{run.stderr[-2000:]}")
    return run.stdout + run.stderr


def simulated(folder: Path, frame: Path, *generics: str) -> Pins:
    """Returns the drive of the pins of both boards of a test bench, in the last period that it prints."""
    rows: list[list[tuple[int, str]]] = [[], []]
    for line in ghdl(folder, "-r", *GHDL, "bench", f"-gbytes={frame}", *generics).splitlines():
        words = line.split()
        if len(words) == 3 and words[0] in ("0", "1"):
            rows[int(words[0])].append((int(words[1]), words[2]))
    period, pins = 25e6, []
    for board in rows:
        times = np.array([time for time, _ in board], float)
        bits = np.array([[int(bit) for bit in reversed(f"{int(word, 16):0256b}")] for _, word in board])
        if len(times) < 2:  # the pins never change
            pins.append(np.zeros(256, complex))
            continue
        last = (times >= times[-1] - period - 1) & (times < times[-1] - 1)
        pins.append(harmonic(np.append(times[last], times[-1]), bits[last], period))
    return np.concatenate(pins)


#: The makers' VHDL files, in order of dependency.
SONICSURFACE = ["RSSFilter_1", "Counter", "UARTReader", "Distribute", "PulseExpander", "LatchBuffer"]
SONICSURFACE += ["PhaseLine", "Mux8", "AllChannels"]
OPENMPD = ["RSSFilter", "Counter", "CommandReader", "PhaseCalibration", "PinMapping", "CalibrationAndMapping"]
OPENMPD += ["MuxPhase", "PulseWidthModulator", "AllChannels"]


def sources(folder: Path, blocks: list[str]) -> list[str]:
    return [str(folder / f"{block}.vhd") for block in blocks]


def sonicsurface(makers: Path, folder: Path) -> Play:
    """Compiles a test bench of both boards, in which COUNT[7] of the primary resets the secondary.
    The filters' lengths are those of the makers' diagrams.
    """
    for library in ("primary", "secondary"):
        source = makers / "SonicSurface" / "Firmware" / f"FPGA {library}" / "src"
        files = [*sources(source, SONICSURFACE), str(HERE / "sonicsurface.vhd")]
        ghdl(folder, "-a", *GHDL, f"--work={library}", *files)
    ghdl(folder, "-a", *GHDL, str(HERE / "sonicsurface_bench.vhd"))
    ghdl(folder, "-e", *GHDL, "bench")
    return lambda frame: simulated(folder, frame, "-gprimary_taps=8", "-gsecondary_taps=5")


def openmpd(makers: Path, folder: Path) -> Play:
    source = makers / "OpenMPD_Hardware" / "FPGA_3.4.2" / "src"
    memory, board, bench = (str(HERE / f"openmpd{part}.vhd") for part in ("_memory", "", "_bench"))
    ghdl(folder, "-a", *GHDL, memory, *sources(source, OPENMPD), board, bench)
    ghdl(folder, "-e", *GHDL, "bench")
    return lambda frame: simulated(folder, frame)


def mega64(makers: Path, folder: Path) -> Play:
    binary = makers / "Ultraino/DriverBoards/ArduinoMega64/firmware/DriverMEGA/DriverMEGA.ino.mega.hex"
    java = makers / "Ultraino/AcousticFieldSim/src/acousticfield3d/protocols/ArduinoMEGA64.java"
    table = re.search(r"PORT_MAPPING = \{([\d, ]+)\}", java.read_text("utf-8"))
    assert table, "the makers' pin of each channel"
    mapping = [int(pin) for pin in table[1].split(",")]
    program = folder / "mega64"
    compiler = ["gcc", "-O2", "-I/usr/include/simavr", str(HERE / "mega64.c"), "-o", str(program), "-lsimavr"]
    subprocess.run(compiler, check=True)

    def play(frame: Path) -> Pins:
        printed = subprocess.check_output([str(program), str(binary), str(frame)], encoding="utf-8")
        words = [line.split() for line in printed.splitlines()]
        pins = []
        for port in "ACLBKFHDGJ":
            writes = [(int(time), int(value)) for name, time, value in words if name == port]
            pins.append(period_of(writes))
        return np.concatenate(pins)[mapping]

    return play


def period_of(writes: list[tuple[int, int]]) -> Pins:
    """Returns the drive of a port's eight pins, in the period of 396 cycles before its last write."""
    if not writes:
        return np.zeros(8, complex)
    times, values = np.array(writes).T
    last = (times >= times[-1] - 396) & (times < times[-1])
    bits = values[last, None] >> np.arange(8) & 1
    return harmonic(np.append(times[last], times[-1]), bits, 396)


#: A byte that sets the step of the tactile firmware's modulation, and the number of simulated periods of 40
#: kHz.
STEP, PERIODS = 165, 440


def tactile(makers: Path, folder: Path) -> None:
    """Runs SonicSurface's tactile firmware with midair's bytes: prints its modulation and the errors of its
    phases.

    This firmware has its own table of polarities, and its 16 phases are codes without their last bit. Both
    are corrected for.
    """
    source = makers / "SonicSurface" / "Firmware" / "FPGA tactile modulation" / "src"
    files = [*sources(source, [*SONICSURFACE, "AmpModulator"]), str(HERE / "tactile.vhd")]
    ghdl(folder, "-a", *GHDL, *files)
    ghdl(folder, "-e", *GHDL, "tactile")
    frame = midair.Board("sonicsurface").encode(drives(midair.Board("sonicsurface"))["focus"])
    (folder / "frame").write_bytes(bytes([STEP]) + frame)
    printed = ghdl(folder, "-r", *GHDL, "tactile", "-gbytes=frame", f"-gperiods={PERIODS}").split()
    rows = [[int(bit) for bit in reversed(f"{int(word, 16):0256b}")] for word in printed if len(word) == 64]
    bits = np.array(rows)[: len(rows) // 16 * 16].reshape(-1, 16, 256)
    on = bits.any(axis=1).sum(axis=1)
    table = re.search(r":= \(([\d,]+)\)", (source / "Distribute.vhd").read_text("utf-8"))
    assert table, "the makers' table of polarities"
    codes = np.frombuffer(frame, np.uint8)[1:257] + np.array(table[1].split(","), int)
    ticks = np.arange(17.0)
    # For each channel, take the middle one of the periods in which its pulse has the most common length.
    length = np.median(bits.sum(axis=1)[bits.any(axis=1)])
    whole = [np.flatnonzero(sums == length) for sums in bits.sum(axis=1).T]
    pins = np.array([harmonic(ticks, bits[k[len(k) // 2], :, [c]].T, 16)[0] for c, k in enumerate(whole)])
    apart = np.angle(pins * np.exp(-2j * np.pi * (codes % 32 // 2) / 16))
    late = np.angle(np.exp(1j * (apart - np.median(apart))))
    slow = np.flatnonzero(np.abs(late) > 0.1)
    risings = np.flatnonzero(np.diff((on > on.mean()).astype(int)) == 1)
    hertz = 40e3 / np.diff(risings).mean()
    print(f"tactile firmware, byte {STEP}: {hertz:.0f} Hz, {on.min()} to {on.max()} of 256 channels on")
    print(
        f"  amplitude {np.abs(pins).mean():.3f}; late by {late[slow].mean():.3f} rad: {len(slow)} channels, ",
        end="",
    )
    print(f"{np.unique(slow % 8).tolist()} mod 8")


CASES = [
    Case("sonicsurface", sonicsurface),
    Case("sonicsurface_pair", sonicsurface),
    Case("openmpd", openmpd),
]
CASES += [Case("openmpd_pair", openmpd), Case("mega64", mega64)]


def drives(board: midair.Board) -> dict[str, NDArray[np.complex64]]:
    """Returns a drive of random phases and amplitudes, a focus, and a focus with quiet points beside it."""
    rng = np.random.default_rng(38)
    count = len(board.array)
    free = rng.uniform(0.2, 1, count) * np.exp(2j * np.pi * rng.uniform(size=count))
    focus = midair.Scene(board.array, POINTS[:1])
    quiet = midair.Scene(board.array, POINTS, [1, 0, 0, 0])
    solved = [midair.solve(scene, aim="max").drive for scene in (focus, quiet)]
    return {"any": free.astype(np.complex64), "focus": solved[0], "quiet": solved[1]}


#: A focus and three quiet points beside it.
POINTS = [[0, 0, 0.06], [0.03, 0, 0.06], [0.03, 0.01, 0.06], [0.03, -0.01, 0.06]]


def main() -> int:
    makers = Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "makers"
    missing = [name for name in MAKERS if not (makers / name).is_dir()]
    if missing or not shutil.which("ghdl"):
        print("Install Debian's ghdl, simavr, libsimavr-dev and gcc, and fetch the makers' sources:")
        for name in missing:
            address, commit = MAKERS[name]
            print(f"  git clone {address} {makers / name} && git -C {makers / name} checkout -q {commit}")
        return 1
    RECORDS.mkdir(exist_ok=True)
    print(f"{'board':18} {'drive':6} {'phases: rms':>12} {'most':>7} {'amplitudes':>11}")
    for case in CASES:
        with tempfile.TemporaryDirectory() as folder:
            record(case, case.ready(makers, Path(folder)), Path(folder))
    with tempfile.TemporaryDirectory() as folder:
        tactile(makers, Path(folder))
    return 0


def record(case: Case, play: Play, folder: Path) -> None:
    """Plays the board's drives, prints the difference between the pins' output and the drive that midair
    reports, and records bytes and output.
    """
    board = midair.Board(case.board)
    frames = []
    for name, drive in drives(board).items():
        file = folder / "frame"
        file.write_bytes(board.encode(drive))
        pins = play(file)[board.channels]
        response = board.array.response
        reported = board.decode(file.read_bytes()) * (1 if response is None else response)
        on = reported != 0
        pins = pins * np.exp(-1j * np.angle(np.vdot(reported, pins)))
        apart = np.angle(pins[on] / reported[on])
        louder = np.abs(pins[on]) / np.abs(reported[on]) - 1
        figures = [np.sqrt(np.mean(apart**2)), np.abs(apart).max(), np.abs(louder).max()]
        row = f"{case.board:18} {name:6} {figures[0]:12.4f} {figures[1]:7.4f} {figures[2]:11.4f}"
        print(row if np.allclose(pins[~on], 0) else f"{row}  pins that are off move")
        rounded = [[round(float(pin.real), 5), round(float(pin.imag), 5)] for pin in pins]
        frames.append({"drive": name, "bytes": file.read_bytes().hex(), "pins": rounded})
    (RECORDS / f"{case.board}.json").write_text(
        json.dumps({"board": case.board, "frames": frames}) + "\n", encoding="utf-8"
    )


if __name__ == "__main__":
    sys.exit(main())
