"""The makers' emulators of AUTD3 devices over UDP:
the programs of gateware/autd3, and the Python package 0.12.
"""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import autd3

#: The program that `make gateware` and `make test-boards` build from the makers' crates.
BUILT = Path(__file__).parents[2] / "gateware" / "autd3" / "target" / "release" / "autd3-emulators"


class Built:
    """Emulated devices of one firmware, in a process of their own; `address` is "[::1]:PORT"."""

    def __init__(self, firmware: str, devices: int) -> None:
        command = [str(BUILT), firmware, str(devices)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, encoding="utf-8")
        assert self._process.stdin
        assert self._process.stdout
        self._stdin, self._stdout = self._process.stdin, self._process.stdout
        self.address = self._stdout.readline().strip()

    def state(self) -> list[dict[str, Any]]:
        """Returns the content of each device's banks and tables."""
        self._say("state")
        found: list[dict[str, Any]] = json.loads(self._stdout.readline())
        return found

    def reboot(self, device: int) -> None:
        self._say(str(device))

    def close(self) -> None:
        self._stdin.close()
        self._process.wait(5)
        self._stdout.close()

    def _say(self, line: str) -> None:
        self._stdin.write(line + "\n")
        self._stdin.flush()


class Packaged:
    """Emulated devices of firmware 0.12 in this process; their state cannot be read."""

    def __init__(self, devices: int) -> None:
        self._emulator = autd3.UdpEmulator(devices)
        self.address = repr(self._emulator.option().iface).split('"')[1]
        self.reboot = self._emulator.reboot

    def close(self) -> None:
        """Does nothing: the emulator ends with this process."""
