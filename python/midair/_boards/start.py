"""First code of a guard, on Windows of a watcher: imports midair's board modules without NumPy."""

import signal
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType


def start(*words: str) -> None:
    """Run the guard, with words the watcher; standard input and output are its pipes.

    The guard ignores Ctrl-C and the closing of the terminal: its owner reacts to them, and then closes the
    guard or stops sending beats.
    """
    for name in ("SIGINT", "SIGHUP", "SIGPIPE"):
        if name in signal.Signals.__members__:
            signal.signal(signal.Signals[name], signal.SIG_IGN)
    boards = Path(__file__).resolve().parent
    for name, folder in (("midair", boards.parent), ("midair._boards", boards)):
        package = ModuleType(name)
        package.__path__ = [str(folder)]
        sys.modules[name] = package
    if words:
        import_module("midair._boards.watcher").main(*words)
    else:
        import_module("midair._boards.guard").main()


if __name__ == "__main__":
    start(*sys.argv[1:])
