"""First code of a guard process: it finds midair's boards without importing midair and NumPy."""

import signal
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType


def start() -> None:
    """Run the guard between the pipes in place of input and output.

    Ctrl-C and a closed terminal are for its owner, which then ends it or stops to beat.
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
