"""What a guard process runs first: it finds midair's boards without importing midair, NumPy and all."""

import signal
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType


def start() -> None:
    """Run the guard between the pipes that stand in for input and output.

    Ctrl-C and a closed terminal are for its owner, who then ends it, or is missed by it.
    """
    for name in ("SIGINT", "SIGHUP", "SIGPIPE"):
        if name in signal.Signals.__members__:
            signal.signal(signal.Signals[name], signal.SIG_IGN)
    boards = Path(__file__).resolve().parent
    for name, folder in (("midair", boards.parent), ("midair._boards", boards)):
        package = ModuleType(name)
        package.__path__ = [str(folder)]
        sys.modules[name] = package
    import_module("midair._boards.guard").main()


if __name__ == "__main__":
    start()
