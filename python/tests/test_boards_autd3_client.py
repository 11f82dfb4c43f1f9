"""The makers' own client sends AUTD3 boards the same bytes as midair."""

import asyncio
from itertools import groupby

import autd3
import numpy as np
import pytest
from autd3.commands import FixedCompletionTime, Modulation, Pattern, PatternStm, PatternStmOption, SetSilencer
from autd3.value import PatternBank, SamplingConfig
from autd3_modulation import ModulationBuffer
from autd3_pattern import IntensityBuffer, PhaseBuffer

from autd3_emulators import Packaged
from autd3_fake import acts, read
from autd3_makers import geometry
from autd3_wire import BOARDS, Wire, described


@pytest.mark.slow
def test_the_makers_client_sends_boards_the_same_bytes() -> None:
    """Compares the steps of midair, for the calls in `autd3_fake.acts`, with the steps of the makers' package
    for firmware 0.12. Step counts are left out.
    """
    emulator = Packaged(BOARDS)
    reported = []
    for speak in (of_midair, of_the_makers):
        wire = Wire(emulator.address)
        speak(wire.address)
        reported.append([[read(step)[1:] for step, _ in groupby(each)] for each in wire.steps()])
        wire.close()
    for ours, theirs in zip(*reported, strict=True):
        # The makers' client reads the firmware version before it clears the boards, and does not silence them
        # at the end.
        assert sorted(ours[:4]) == sorted(theirs[:4])
        assert ours[6:] == theirs[4:]


def of_midair(address: str) -> None:
    for act in acts(described(f"autd3:{address}")):
        act()


def of_the_makers(address: str) -> None:
    tables = [act_codes(k) for k in range(7)]
    silencer = [SetSilencer(FixedCompletionTime(*times, strict_mode=False)) for times in TIMES]
    half = np.floor(127.5 * (1 + np.sin(2 * np.pi * np.arange(80) * 3 / 80)) + 0.5).astype(np.uint8)
    sine, steady = (ModulationBuffer.from_bytes(samples) for samples in (half.tobytes(), b"\xff\xff"))
    several = [[table[k] for table in tables[1:6]] for k in (0, 1)]
    commands = [
        Pattern(*tables[0]),
        silencer[0],
        PatternStm(SamplingConfig(3), *several, PatternStmOption(bank=PatternBank.B1)),
        Modulation(SamplingConfig.FREQ_4K, sine),
        silencer[1],
        Pattern(*tables[6]),
        Modulation(SamplingConfig.FREQ_4K, steady),
    ]

    async def send() -> None:
        devices = geometry([((192.0 * k, 0, 0), (1, 0, 0, 0)) for k in range(BOARDS)])
        patient = autd3.ClientConfig(ack_timeout=autd3.Duration.from_secs(1))
        there = autd3.UdpOption(iface=autd3.Interface.Addr(address))
        client = await autd3.Client.open(devices, there, patient)
        for command in commands:
            await client.send(command)
        await client.silent_stop()
        await client.close()

    asyncio.run(send())


#: Times in us in which intensity and phase change: three ultrasound periods, and the silencer's defaults.
TIMES = [[autd3.Duration.from_micros(us) for us in pair] for pair in ((75, 75), (250, 1000))]


def act_codes(frame: int) -> tuple[PhaseBuffer, IntensityBuffer]:
    codes = np.array([k * k % 251 for k in range(7 * BOARDS * 498)], np.uint8)
    planes = codes.reshape(7, BOARDS, 2, 249)[frame]
    return PhaseBuffer.from_array(planes[:, 0].copy()), IntensityBuffer.from_array(planes[:, 1].copy())
