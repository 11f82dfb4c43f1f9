"""Guided fuzzing of a function of bytes: Atheris over the package and its extension."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable

import atheris

with atheris.instrument_imports(include=["midair", "zipfile", "numpy.lib"]):
    import midair
    import midair._sweep

Data = atheris.FuzzedDataProvider

#: What a bad argument may raise: the package's error, or Python's for arguments of another number or name.
REFUSALS = (midair.SceneError, TypeError)


def refused(error: Exception) -> None:
    """A refusal is one line that says something."""
    text = str(error)
    assert text.strip(), repr(error)
    assert "\n" not in text, text
    assert len(text) < 2000, text


def fuzz(test: Callable[[bytes], None]) -> None:
    """Run libFuzzer by the command line's options."""
    warnings.simplefilter("ignore")
    atheris.Setup(sys.argv, test)
    atheris.Fuzz()
