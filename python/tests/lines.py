"""A model of a SonicSurface board at a pseudo-terminal, which acts on each byte as its firmware does."""

import math
import os
import select
import threading
import time

OFF = 32


class Surface:
    """The board: two banks of codes, which byte 253 exchanges. At power-up all transducers are on."""

    def __init__(self, boards=1):
        self.banks = [[[0] * 256, [0] * 256] for _ in range(boards)]
        self.selected = set(range(boards))
        self.address = 0
        self.clocks = True
        self.played = []  # (time, codes of all boards) at each commit

    def take(self, byte, at):
        if byte == 254:
            self.address = 0
        elif byte == 253:
            for banks in self.banks:
                banks.reverse()
            self.address = 0
            self.played.append((at, [code for banks in self.banks for code in banks[0]]))
        elif byte in (192, 193):
            self.selected = {byte - 192} & set(range(len(self.banks)))
        elif byte in (150, 151):
            self.clocks = byte == 151
        elif self.address < 256:
            for board in self.selected:
                self.banks[board][1][self.address] = byte
            self.address += 1

    @property
    def loud(self):
        return any(code != OFF for banks in self.banks for code in banks[0])

    @property
    def silent(self):
        """Whether all transducers are off in both banks of every board, while the clocks run."""
        codes = {code for banks in self.banks for bank in banks for code in bank}
        return codes == {OFF} and self.clocks


class Line:
    """A pseudo-terminal with a Surface at its far end. `port` is the terminal's name, `times` are the arrival
    times of the bytes.

    `silent_since` is the time since which the surface is silent, infinite while it is not.
    """

    def __init__(self, boards=1):
        # Windows, where other tests import this module, does not have it.
        import tty

        self.master, slave = os.openpty()
        tty.setraw(slave)
        self.port = os.ttyname(slave)
        self.slave = slave
        self.surface = Surface(boards)
        self.taken = bytearray()
        self.times = []
        self.silent_since = math.inf
        self.lock = threading.Lock()
        self.changed = threading.Condition(self.lock)
        self.there = True
        self.reading = threading.Event()
        self.reading.set()
        self.thread = threading.Thread(target=self._read, daemon=True)
        self.thread.start()

    def _read(self):
        while self.there:
            if not (self.reading.wait(0.01) and select.select([self.master], [], [], 0.01)[0]):
                continue
            try:
                more = os.read(self.master, 65536)
            except OSError:
                return
            at = time.monotonic()
            with self.lock:
                self.taken += more
                self.times += [at] * len(more)
                for byte in more:
                    self.surface.take(byte, at)
                self.silent_since = min(self.silent_since, at) if self.surface.silent else math.inf
                self.changed.notify_all()

    def wait(self, condition, seconds=5.0):
        """Waits until a condition of the surface is true, and returns the time."""
        with self.lock:
            assert self.changed.wait_for(lambda: condition(self.surface), seconds), "it never came"
            return time.monotonic()

    def commits(self, since=0.0):
        with self.lock:
            return [(at, codes) for at, codes in self.surface.played if at >= since]

    def unplug(self):
        """Simulates that the cable is unplugged."""
        if self.there:
            self.there = False
            self.thread.join()
            os.close(self.slave)
            os.close(self.master)
