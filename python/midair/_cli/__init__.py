"""The command line `midair solve | compare | ...`: all commands are listed in app.py."""

from .app import main

__all__ = ["main"]
