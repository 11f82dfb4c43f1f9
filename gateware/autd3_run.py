"""Sends midair's bytes to the makers' emulators of AUTD3 devices, and records the results in golden/autd3.

python gateware/autd3_run.py

Cargo fetches the makers' crates and builds them in gateware/autd3, in a minute or two.
"""

import json
import subprocess
import sys
from itertools import groupby
from pathlib import Path

HERE = Path(__file__).parent
RECORDS = HERE.parent / "golden" / "autd3"
BOARDS = 2
sys.path.insert(0, str(HERE.parent / "python" / "tests"))


def main() -> None:
    manifest = HERE / "autd3" / "Cargo.toml"
    subprocess.run(["cargo", "build", "--release", "--quiet", "--manifest-path", str(manifest)], check=True)
    RECORDS.mkdir(exist_ok=True)
    for firmware in ("0.12", "0.13"):
        record(firmware)


def record(firmware: str) -> None:
    """Makes the calls of `autd3_fake.acts` to emulated devices of a firmware. After each call, records the
    steps that the devices have received, and their state.
    """
    from autd3_emulators import Built
    from autd3_fake import acts
    from autd3_wire import Wire
    from midair._boards.autd3 import Autd3Transport

    emulator = Built(firmware, BOARDS)
    wire = Wire(emulator.address)
    transport = Autd3Transport(f"autd3:{wire.address}", BOARDS)
    rows, before = [], [0] * BOARDS
    for act in acts(transport):
        act()
        steps = wire.steps()
        new = [[step.hex() for step, _ in groupby(each[count:])] for each, count in zip(steps, before, strict=True)]
        before = [len(each) for each in steps]
        rows.append({"steps": new, "devices": emulator.state()})
    wire.close()
    emulator.close()
    lines = ",\n".join(json.dumps(row) for row in rows)
    (RECORDS / f"{firmware}.json").write_text(f"[\n{lines}\n]\n", "utf-8")
    print(f"firmware {firmware}: {sum(before)} steps of {BOARDS} devices")


if __name__ == "__main__":
    main()
