"""Builds the firmware, runs it on an emulated board, and computes the same frames on this machine.

Debian's compiler builds it together with the source of its standard library, so no target is downloaded.
Nothing is installed.
"""

import os
import shutil
import struct
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
TARGET = "thumbv7em-none-eabihf"
METHODS = ("fast", "greedy", "naive", "uniform")
#: With -icount shift=0 an instruction takes 1 ns of emulated time, and a tick of the 25 MHz clock 40 ns.
INSTRUCTIONS_A_TICK = 40
NEEDS = {
    "/usr/bin/rustc": "rustc-web",
    "/usr/bin/cargo": "cargo-web",
    "/usr/lib/rustlib/src/rust/library/Cargo.lock": "rust-web-src",
    "/usr/bin/qemu-system-arm": "qemu-system-arm",
}
LINKERS = ("ld.lld", "ld.lld-19", "ld.lld-14")


@dataclass(frozen=True)
class Run:
    """Output of a program: numbers by name, the bits of each frame's drive,
    all bytes sent on its serial line.
    """

    numbers: dict[str, int]
    drives: list[str]
    line: bytes

    def instructions(self, name: str) -> int:
        return self.numbers[name] * INSTRUCTIONS_A_TICK


def build() -> Path:
    """Builds a program for each method for the board, and the same player for this machine;
    returns the folder of the programs.
    """
    missing = [package for place, package in NEEDS.items() if not Path(place).exists()]
    linker = next((found for name in LINKERS if (found := shutil.which(name))), None)
    if missing or linker is None:
        names = " ".join(missing + ["lld"] * (linker is None))
        sys.exit(f"firmware: missing: apt install --no-install-recommends {names}")
    target = Path(os.environ.get("CARGO_TARGET_DIR", HERE / "target"))
    # -Zbuild-std needs these variables with a stable compiler; a rustup toolchain must not be used instead.
    own = {
        "RUSTC_BOOTSTRAP": "1",
        "RUSTC": "/usr/bin/rustc",
        "CARGO_TARGET_DIR": str(target),
        "CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER": linker,
    }
    env = {key: value for key, value in os.environ.items() if key != "RUSTFLAGS"} | own
    cargo = ["/usr/bin/cargo", "build", "--quiet", "--release"]
    small = ["-Zbuild-std=core,alloc", "-Zbuild-std-features=optimize_for_size"]
    subprocess.run([*cargo, "--bins", "--target", TARGET, *small], cwd=HERE, env=env, check=True)
    subprocess.run([*cargo, "--example", "pc"], cwd=HERE, env=env, check=True)
    subprocess.run(["/usr/bin/cargo", "test", "--quiet", "--lib"], cwd=HERE, env=env, check=True)
    return target


def emulated(target: Path, method: str, array: str, board: str, points: int) -> Run:
    """Runs a method's program on the emulated board."""
    program = target / TARGET / "release" / method
    words = [f"arg={word}" for word in (method, array, board, points)]
    with tempfile.TemporaryDirectory() as folder:
        line = Path(folder, "line")
        machine = ["qemu-system-arm", "-M", "mps2-an386", "-icount", "shift=0"]
        quiet = ["-display", "none", "-monitor", "none"]
        semihosting = ",".join(["enable=on", "target=native", *words])
        ends = ["-serial", f"file:{line}", "-semihosting-config", semihosting, "-kernel", str(program)]
        reported = subprocess.run([*machine, *quiet, *ends], capture_output=True, encoding="utf-8", timeout=300)
        if reported.returncode != 0:
            raise RuntimeError(f"{method} {array} {board} {points}: {reported.stdout[-500:]}{reported.stderr[-500:]}")
        pairs = [text.split() for text in reported.stdout.splitlines()]
        numbers = {name: int(value) for name, value in pairs if name != "drive"}
        return Run(numbers, [value for name, value in pairs if name == "drive"], line.read_bytes())


def here(target: Path, method: str, array: str, board: str, points: int) -> Run:
    """Computes the frames of `emulated` on this machine, with the scalar instruction set."""
    program = target / "release" / "examples" / "pc"
    words = [str(program), method, array, board, str(points)]
    reported = subprocess.run(words, capture_output=True, encoding="utf-8", check=True)
    pairs = [text.split() for text in reported.stdout.splitlines()]
    line = b"".join(bytes.fromhex(value) for name, value in pairs if name == "frame")
    return Run({}, [value for name, value in pairs if name == "drive"], line)


def flash(target: Path, method: str) -> int:
    """Returns the number of bytes that a program takes in flash: those that its ELF file loads."""
    elf = (target / TARGET / "release" / method).read_bytes()
    offset, count = struct.unpack_from("<I", elf, 28)[0], struct.unpack_from("<H", elf, 44)[0]
    headers = [struct.unpack_from("<8I", elf, offset + 32 * k) for k in range(count)]
    return sum(size for kind, _, _, _, size, *_ in headers if kind == 1)
