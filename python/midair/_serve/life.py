"""Signs of life: decides from times alone whether the points that play may go on.

A *source* is a client that sends points, or a program that tracks a hand. The *player* is the source whose
points play. This module has neither threads nor a clock: every call states its time in s.
"""

import math
from collections.abc import Hashable

#: Time in s without a sign of life from the player, and without a new place of the hand that its points
#: follow, after which the board is off.
SILENCE, HAND = 0.2, 0.5

#: Number of sources whose last signs are stored; the oldest ones are forgotten.
MOST_SOURCES = 256


class Life:
    """The player, its last sign of life, and the hand that its points follow.

    A player that is silent for SILENCE, has left or was switched off is none any more: only new points start
    again. A hand that is lost and comes back does not need new points.

    Attributes
    ----------
    player
        The source whose points play, None if none do.
    tracked
        Whether the player's points follow a hand.
    """

    def __init__(self) -> None:
        self.player: Hashable | None = None
        self.tracked = False
        self._signs: dict[Hashable, float] = {}
        self._hand: tuple[Hashable, float] | None = None

    def sign(self, source: Hashable, at: float) -> None:
        """Record that a message of a source came at this time."""
        if self.player == source and not self._lives(source, at):
            self.player = None
        self._signs[source] = max(at, self._signs.pop(source, at))
        if len(self._signs) > MOST_SOURCES:
            self._signs.pop(next(each for each in self._signs if each != self.player))

    def hand(self, tracker: Hashable, at: float | None) -> None:
        """Record that a tracker sees a hand, at the time that it states; None: it sees none."""
        if at is not None:
            self._hand = tracker, at
        elif self._hand is not None and self._hand[0] == tracker:
            self._hand = None

    def play(self, source: Hashable, now: float, *, tracked: bool = False) -> bool:
        """Make a source the player, unless its signs are too old. Return whether it is the player now."""
        if not self._lives(source, now):
            return False
        self.player, self.tracked = source, tracked
        return True

    def off(self) -> None:
        """Switch off: no source's points play."""
        self.player = None

    def leave(self, source: Hashable) -> None:
        """Record that a source has gone."""
        self._signs.pop(source, None)
        self.hand(source, None)
        if self.player == source:
            self.player = None

    def left(self, now: float) -> float:
        """Return the time in s for which the points may play without another sign; 0: the board is off."""
        if self.player is None or not self._lives(self.player, now):
            self.player = None
            return 0.0
        until = self._signs[self.player] + SILENCE
        if self.tracked:
            until = min(until, -math.inf if self._hand is None else self._hand[1] + HAND)
        return max(0.0, until - now)

    def _lives(self, source: Hashable, now: float) -> bool:
        return now - self._signs.get(source, -math.inf) < SILENCE
