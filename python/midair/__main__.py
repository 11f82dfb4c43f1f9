"""The program, as `python -m midair`."""

from .cli import main

main()
