"""Entry point of `python -m midair`."""

from ._cli import main

main()
