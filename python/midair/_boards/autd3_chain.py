"""Chain of AUTD3 boards: finds the boards by UDP, numbers and synchronises them, and exchanges datagrams.

The boards are connected in one line to a network interface and receive IPv6 multicast ("all nodes of the
link"). A board that was reset does not forward datagrams to the boards behind it. So the boards are
discovered, numbered and opened one after another. The first board's clock is the reference for all. The order
of these steps and the times are those of the makers' autd3-rs 0.13.0.
"""

import re
import select
import socket
import struct
import time
from collections.abc import Iterator, Mapping
from contextlib import suppress
from enum import IntEnum
from itertools import islice
from typing import Any, NamedTuple

from .autd3_commands import PROTOCOLS, counted
from .errors import BoardError, BoardNotFound

PORT = 44336
#: IPv6 multicast address of all nodes on a link.
ALL = "ff02::1"

#: Time in s to wait for the answer to a request, and the number of attempts.
RESPONSE = 0.2
ATTEMPTS = 3
#: Time in s after which boards that were reset no longer forward datagrams to the boards behind them, and the
#: time to wait for a second, unwanted discovery answer.
SETTLE = 0.1
LINGER = 0.01
#: Longest times in s of the search for boards and of the synchronisation of their clocks; the pause between
#: two checks.
ENUMERATION = 10.0
IN_STEP = 30.0
PAUSE = 0.05

#: Flags of a board: it has a number; its clock runs and follows the first board's; it has muted itself.
ASSIGNED, IN_TIME, MUTED = 0x01, 0x18, 0x40

_HEADER = struct.Struct("<BBH")  # protocol version, kind of the datagram, its number
_INFO = struct.Struct("<BBB")  # status, board number, flags
#: Where the firmware's version is in the information of protocols before 5.
_FIRMWARE = slice(5, 8)

_Place = tuple[Any, ...]


class Kind(IntEnum):
    """Kind of a datagram."""

    STEP = 0
    INFO = 1
    RESET = 2
    DISCOVER = 3
    NUMBER = 4
    OPEN_PORT = 5
    SET_CLOCK = 6
    BEAT = 7


class Info(NamedTuple):
    """Information that a board sends about itself: its network address, its number, its flags."""

    place: _Place
    unit: int
    flags: int


class Chain:
    """A chain of AUTD3 boards, found, numbered from 0 on and synchronised.

    Parameters
    ----------
    address
        "autd3" (searches every network interface), "autd3:eth0" (one interface) or "autd3:[IPv6]:PORT".
    boards
        The number of boards that the chain must have.

    Raises
    ------
    BoardNotFound
        If no board answers, or fewer or more boards than `boards`.
    BoardError
        If a board's firmware has another protocol.
    """

    def __init__(self, address: str, boards: int) -> None:
        self._address, self._boards = address, boards
        self._number = 0
        self._version = next(iter(PROTOCOLS))
        self._socket, self._group = self._search()
        try:
            if self._version not in PROTOCOLS:
                raise self._other_firmware()
            self._places = self._enumerate()
            self._units = {place[:2]: unit for unit, place in enumerate(self._places)}
            self._synchronize()
        except BaseException:
            self.close()
            raise
        self.protocol = PROTOCOLS[self._version]

    def send(self, kind: Kind, contents: Mapping[int, bytes]) -> None:
        """Send each board its content, given by board number. The last board in the chain is served first."""
        self._next()
        for unit in sorted(contents, reverse=True):
            self._write(self._places[unit], kind, contents[unit])

    def replies(self, kind: Kind, seconds: float) -> Iterator[tuple[int, bytes]]:
        """Yield (board number, reply) of the replies that arrive within `seconds` after the datagrams."""
        for place, body in self._answers(kind, seconds):
            if place[:2] in self._units:
                yield self._units[place[:2]], body

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()

    def _search(self) -> tuple[socket.socket, _Place]:
        """Search the networks for boards; return a socket to the first with an answer, and its address."""
        groups = {}
        for group in self._groups():
            # An interface without IPv6 cannot be used.
            with suppress(OSError):
                groups[_socket(group)] = group
        asking = _HEADER.pack(self._version, Kind.INFO, self._number)
        try:
            for _ in range(ATTEMPTS if groups else 0):
                for each, group in groups.items():
                    with suppress(OSError):
                        each.sendto(asking, group)
                for each in select.select(list(groups), [], [], RESPONSE)[0]:
                    with suppress(OSError):
                        answer = each.recv(2048)
                        if len(answer) > _HEADER.size and answer[1] == Kind.INFO:
                            self._version = answer[0]
                            return each, groups.pop(each)
        finally:
            for each in groups:
                each.close()
        raise self._not_found("no AUTD3 board answers")

    def _groups(self) -> list[_Place]:
        """Return the multicast address of each network to search."""
        _, colon, where = self._address.partition(":")
        interfaces: dict[str, int] = {}
        # A system without a network may raise an error.
        with suppress(OSError):
            interfaces = {name: index for index, name in socket.if_nameindex()}
        if not colon:
            return [(ALL, PORT, 0, index) for index in interfaces.values()]
        if where in interfaces:
            return [(ALL, PORT, 0, interfaces[where])]
        if found := re.fullmatch(r"\[([^]]+)\]:(\d{1,5})|([^[]*:.*)", where):
            host, port = found[1] or found[3], int(found[2] or PORT)
            with suppress(OSError):
                place = socket.getaddrinfo(host, port, socket.AF_INET6, flags=socket.AI_NUMERICHOST)[0][4]
                # Some systems reduce a port number modulo 65536 without an error.
                if place[1] == port:
                    return [place]
        given = " or ".join([", ".join(interfaces)] * bool(interfaces) + ["an IPv6 address and port"])
        cure = f"give {given}, as autd3:[fe80::1%eth0]:{PORT}"
        raise BoardError(f"{self._address}: {where!r} is no network interface: {cure}")

    def _enumerate(self) -> list[_Place]:
        """Give all boards numbers, in their order in the chain; return the network address of each."""
        self._request(self._group, Kind.RESET)
        time.sleep(SETTLE)
        places: list[_Place] = []
        until = time.monotonic() + ENUMERATION
        while True:
            place, late = self._discover(), time.monotonic() > until
            if place is None:
                if not late and self._release(places):
                    continue
                if len(places) == self._boards:
                    return places
                if late:
                    raise self._not_found(f"only {counted(len(places), 'AUTD3 board')} answered")
                time.sleep(PAUSE)
                continue
            if len(places) == self._boards:
                raise self._not_found(f"more than {counted(len(places), 'AUTD3 board')} answered")
            unit = len(places)
            places.append(self._assign(place, unit))
            opened = self._ask(unit, places[unit], Kind.OPEN_PORT)
            if not any(opened[1:]) and len(places) == self._boards:
                return places

    def _discover(self) -> _Place | None:
        """Return the address of the next board without a number, None if there is none."""
        for place, _ in self._request(self._group, Kind.DISCOVER, most=1):
            if list(self._answers(Kind.DISCOVER, LINGER)):
                raise self._not_found("two AUTD3 boards answer at once, which are not in one line")
            return place
        return None

    def _release(self, known: list[_Place]) -> bool:
        """Reset boards that still have a number from an earlier connection; return whether there were any."""
        old = [info.place for info in self._infos() if info.flags & ASSIGNED and info.place not in known]
        for place in old:
            self._request(place, Kind.RESET, most=1)
        if old:
            time.sleep(SETTLE)
        return bool(old)

    def _assign(self, place: _Place, unit: int) -> _Place:
        """Give a board its number, and make board 0 the reference clock; return the board's new address."""
        for _ in range(ATTEMPTS):
            for answer, body in self._request(place, Kind.NUMBER, bytes([unit, unit == 0]), most=1):
                self._check(unit, Kind.NUMBER, body)
                return answer
            # The board may have taken its number although its answer was lost.
            for info in self._infos():
                if info.flags & ASSIGNED and info.unit == unit:
                    return info.place
        raise self._not_found(f"board {unit} does not take its number")

    def _synchronize(self) -> None:
        """Set the first board's clock, and wait until the clocks of all boards follow it."""
        self._ask(0, self._places[0], Kind.SET_CLOCK, bytes(8))
        until = time.monotonic() + IN_STEP
        while True:
            infos = self._infos(most=self._boards)
            if any(self._units.get(info.place[:2]) != info.unit for info in infos):
                raise self._not_found("another AUTD3 board answers, too")
            ready = {info.unit for info in infos if info.flags & IN_TIME == IN_TIME}
            if len(ready) == self._boards:
                return
            if time.monotonic() > until:
                late = min(set(range(self._boards)) - ready)
                raise self._not_found(f"the clock of board {late} is not in step after {IN_STEP:g} s")
            time.sleep(PAUSE)

    def _infos(self, most: int | None = None) -> list[Info]:
        """Request and return the information of all boards."""
        found = self._request(self._group, Kind.INFO, most=most)
        return [Info(place, *_INFO.unpack_from(body)[1:]) for place, body in found if len(body) >= _INFO.size]

    def _ask(self, unit: int, place: _Place, kind: Kind, content: bytes = b"") -> bytes:
        """Return a board's answer to a request, with retries."""
        for _ in range(ATTEMPTS):
            for _, body in self._request(place, kind, content, most=1):
                self._check(unit, kind, body)
                return body
        raise self._not_found(f"board {unit} does not answer")

    def _check(self, unit: int, kind: Kind, body: bytes) -> None:
        if body[0]:
            raise BoardError(f"{self._address}: board {unit} refuses {kind.name}: status {body[0]}; try again")

    def _request(
        self, place: _Place, kind: Kind, content: bytes = b"", most: int | None = None
    ) -> list[tuple[_Place, bytes]]:
        """Send a request; return at most `most` answers as pairs (address of the sender, content)."""
        self._next()
        self._write(place, kind, content)
        return list(islice(self._answers(kind, RESPONSE), most))

    def _next(self) -> None:
        self._number = (self._number + 1) % 0x10000

    def _write(self, place: _Place, kind: Kind, content: bytes) -> None:
        # A datagram that the system cannot send counts as lost; the caller repeats it.
        with suppress(OSError):
            self._socket.sendto(_HEADER.pack(self._version, kind, self._number) + content, place)

    def _answers(self, kind: Kind, seconds: float) -> Iterator[tuple[_Place, bytes]]:
        """Yield (sender's address, content) of the answers to the last datagram within `seconds`."""
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0:
            self._socket.settimeout(left)
            try:
                found, place = self._socket.recvfrom(2048)
            # Either no answer came in time, or the system reports that an earlier datagram did not arrive.
            except OSError:
                continue
            if len(found) <= _HEADER.size or _HEADER.unpack_from(found)[1:] != (kind, self._number):
                continue
            if found[0] != self._version:
                raise BoardError(
                    f"{self._address}: a board speaks UDP protocol {found[0]}, another {self._version}: put "
                    "the same firmware on all with their makers' tool"
                )
            yield place, found[_HEADER.size :]

    def _other_firmware(self) -> BoardError:
        """Return the error for boards whose firmware has another protocol."""
        firmware = ""
        if self._version < min(PROTOCOLS):
            for _, body in self._request(self._group, Kind.INFO, most=1):
                firmware = f" (firmware {version(body[_FIRMWARE])})"
        known = " and ".join(f"{each.number} (firmware {each.firmware})" for each in PROTOCOLS.values())
        return BoardError(
            f"{self._address}: a board speaks UDP protocol {self._version}{firmware}, midair {known}: put "
            "one of these on it with its makers' tool"
        )

    def _not_found(self, what: str) -> BoardNotFound:
        return BoardNotFound(
            f"{self._address}: {what}; the array stands for {counted(self._boards, 'board')}: check power, "
            f"cables and firewall (UDP {PORT}), name the network of several, as autd3:eth0; firmware 0.9 and "
            "older, and 12.1, speaks EtherCAT, which midair does not"
        )


def version(numbers: bytes) -> str:
    """Return version numbers as text, such as "0.13.0"."""
    return ".".join(map(str, numbers))


def _socket(group: _Place) -> socket.socket:
    """Open a socket to one network; its datagrams are not routed to others."""
    made = socket.socket(socket.AF_INET6, socket.SOCK_DGRAM)
    made.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_MULTICAST_HOPS, 1)
    if group[3]:
        made.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_MULTICAST_IF, group[3])
    made.bind(("::", 0))
    return made
