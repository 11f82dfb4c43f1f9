"""Translates midair's steps to AUTD3 boards into commands of the makers' package 0.12, for their emulator.

The module reads the fields of a step from its bytes, by the layouts of protocol 3.
"""

import struct
from collections.abc import Sequence
from typing import Any

import autd3
import numpy as np
from autd3.commands import (
    ActivateModulationBank,
    ActivatePatternBank,
    ConfigModulation,
    ConfigPattern,
    FixedCompletionTime,
    Pattern,
    SetSilencer,
    WriteModulationBuffer,
    WritePatternBuffer,
)
from autd3.geometry import Autd3, Geometry
from autd3.value import LoopBehavior, ModulationBank, PatternBank, SamplingConfig, TransitionMode
from autd3_emulator import Recorder
from autd3_modulation import ModulationBuffer
from autd3_pattern import IntensityBuffer, PhaseBuffer

from midair._boards.autd3_commands import PROTOCOLS, Command, Step

OLDER = PROTOCOLS[3]
PATTERN_BANKS = (PatternBank.B0, PatternBank.B1)
MODULATION_BANKS = (ModulationBank.B0, ModulationBank.B1)
AT_ONCE, ENDLESS = 255, 65535


def geometry(poses: Sequence[tuple[Sequence[float], Any]]) -> Geometry:
    """Returns the makers' geometry of boards, each at (origin in mm, quaternion (w, x, y, z))."""
    return Geometry([Autd3(origin=list(origin), rotation=list(rotation)) for origin, rotation in poses])


def do(recorder: Recorder, *steps: Step) -> None:
    """Sends steps to the boards of a recorder."""
    for step in steps:
        for command in commands(step, recorder.num_devices()):
            recorder.send(command)


def commands(step: Step, boards: int) -> list[Any]:
    """Returns the makers' commands for a step."""
    payloads = list(step.payloads) * (boards if len(step.payloads) == 1 else 1)
    assert len(payloads) == boards
    return READ[step.command](payloads)


def buffers(parts: list[bytes]) -> tuple[PhaseBuffer, IntensityBuffer]:
    codes = np.array([np.frombuffer(part, np.uint8) for part in parts]).reshape(-1, 2, 249)
    return PhaseBuffer.from_array(codes[:, 0].copy()), IntensityBuffer.from_array(codes[:, 1].copy())


def one(form: str, payloads: list[bytes]) -> tuple[Any, ...]:
    """Returns the fields of a payload that is the same for all boards."""
    assert len(set(payloads)) == 1
    return struct.unpack(form, payloads[0])


def pattern(payloads: list[bytes]) -> list[Any]:
    bank, when, value = struct.unpack_from("<BBQ", payloads[0])
    assert (when, value) == (AT_ONCE, 0)
    return [Pattern(*buffers([payload[10:] for payload in payloads]), PATTERN_BANKS[bank])]


def patterns(payloads: list[bytes]) -> list[Any]:
    bank, count, first = struct.unpack_from("<BBH", payloads[0])
    parts = [[payload[at : at + 498] for payload in payloads] for at in range(4, len(payloads[0]), 498)]
    assert len(parts) == count
    return [WritePatternBuffer(PATTERN_BANKS[bank], first + k, *buffers(part)) for k, part in enumerate(parts)]


def config_patterns(payloads: list[bytes]) -> list[Any]:
    bank, raw, divider, count, *foci, repeat = one("<BBHIBBHH", payloads)
    assert (raw, foci, repeat) == (1, [0, 0, 0], ENDLESS)
    return [ConfigPattern(PATTERN_BANKS[bank], SamplingConfig(divider), count, LoopBehavior.Infinite)]


def play_patterns(payloads: list[bytes]) -> list[Any]:
    bank, when, value = one("<BBQ", payloads)
    assert (when, value) == (AT_ONCE, 0)
    return [ActivatePatternBank(PATTERN_BANKS[bank], TransitionMode.Immediate)]


def samples(payloads: list[bytes]) -> list[Any]:
    bank, zero, first = struct.unpack_from("<BBI", payloads[0])
    assert zero == 0
    return [WriteModulationBuffer(MODULATION_BANKS[bank], first, ModulationBuffer.from_bytes(payloads[0][6:]))]


def config_samples(payloads: list[bytes]) -> list[Any]:
    bank, zero, divider, count, repeat = one("<BBHIH", payloads)
    assert (zero, repeat) == (0, ENDLESS)
    return [ConfigModulation(MODULATION_BANKS[bank], SamplingConfig(divider), count, LoopBehavior.Infinite)]


def play_samples(payloads: list[bytes]) -> list[Any]:
    bank, when, value = one("<BBQ", payloads)
    assert (when, value) == (AT_ONCE, 0)
    return [ActivateModulationBank(MODULATION_BANKS[bank], TransitionMode.Immediate)]


def silencer(payloads: list[bytes]) -> list[Any]:
    flags, zero, *rates, intensity, phase = one("<BBHHHH", payloads)
    assert (flags, zero, rates) == (0, 0, [256, 256])
    times = (autd3.Duration.from_micros(25 * steps) for steps in (intensity, phase))
    return [SetSilencer(FixedCompletionTime(*times, strict_mode=False))]


READ = {
    Command.PATTERN: pattern,
    Command.WRITE_PATTERNS: patterns,
    Command.CONFIG_PATTERNS: config_patterns,
    Command.PLAY_PATTERNS: play_patterns,
    Command.WRITE_SAMPLES: samples,
    Command.CONFIG_SAMPLES: config_samples,
    Command.PLAY_SAMPLES: play_samples,
    Command.SILENCER: silencer,
}
