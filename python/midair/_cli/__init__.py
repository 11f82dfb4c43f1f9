"""The command line: `midair solve | compare | solvers | presets | reproduce | sweep`."""

from .app import main

__all__ = ["main"]
