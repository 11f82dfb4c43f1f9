"""The program, as `python -m midair`."""

from ._cli import main

main()
