"""`midair.multiplex`: drives that play in turn, whose mean radiation pressure is the target."""

from typing import Any

import numpy as np

from .._midair import Scene, solve_batch, stated
from .._support.arguments import frame_rate, refused, warn, whole, without_warnings
from .frames import air_of
from .sequence import Sequence

#: Largest relative error of the mean that gives no warning, as for solvers.
MISSED = 0.01
#: Most rounds: more would run for hours, and the error stands still after some tens.
MOST_ROUNDS = 10_000


def multiplex(
    scene: Scene,
    frames: int,
    solver: str = "descent",
    *,
    rate: float,
    rounds: int = 10,
    **options: Any,
) -> Sequence:
    """Solve for several drives that play in turn, so that their mean |p|^2 is what the scene requests.

    Parameters
    ----------
    scene : midair.Scene
        M points and their pressures in Pa.
    frames : int
        Number of drives T, at least 2.
    solver : str, optional
        Solver of each drive; "descent" and "lm" go on from a drive and meet unequal targets.
    rate : float
        Frames per second.
    rounds : int, optional
        Number of times that the targets of the drives are divided anew, at most 10,000.
    **options
        Options of the solver.

    Returns
    -------
    midair.Sequence
        T frames, closed; `rms` (M,) is what the scene requests. `targets` are those of each frame.

    Raises
    ------
    SceneError
        For a scene without pressures or with a signature, and for wrong options.

    Warns
    -----
    SceneWarning
        If the mean misses the pressures by more than 1 %.

    See Also
    --------
    midair.solve : one drive.

    Notes
    -----
    At first each point belongs to one frame, with the target sqrt(T) t_j. In each round, frame k gets the
    targets t_j |p_jk| / sqrt(mean_k |p_jk|^2), the nearest ones with the right mean, and is solved from its
    last drive: alternating projections. The round of least error is returned.

    Examples
    --------
    >>> import midair
    >>> points = [[0.008 * x, 0.008 * y, 0.1] for x in range(-2, 3) for y in range(-2, 3)]
    >>> board = midair.Array.preset("openmpd_board", quantization={})
    >>> scene = midair.Scene(board, points, pressures=300)
    >>> pattern = midair.multiplex(scene, 3, rate=1e3)
    >>> bool(abs(pattern.rms / 300 - 1).max() < 1e-4)
    True
    """
    count, rounds = whole("frames", frames, least=2), whole("rounds", rounds, least=1, most=MOST_ROUNDS)
    rate = frame_rate(rate)
    if not isinstance(scene, Scene) or scene.pressures is None:
        raise refused("scene", scene, "give a midair.Scene with pressures=")
    if scene.signature is not None:
        raise stated("scene.signature", "is given", "a mean is of foci, leave it out", code="conflict")
    wanted, each = scene.pressures, np.ones(len(scene.points)) if scene.weights is None else scene.weights
    # Only ratios of weights count; in sums over points the largest is 1, so that none overflows.
    share = each / max(each.max(), np.finfo(float).tiny)
    # Frame k begins with the points k, k + T, k + 2 T and so on.
    turns = min(count, len(wanted) + 1)
    own = np.arange(len(wanted)) % turns == np.arange(turns)[:, None]
    if not ((share > 0) & (wanted > 0) & own).any(axis=1).all():
        raise refused("frames", frames, "each needs a point of a pressure and a weight above 0: give fewer")
    places = np.broadcast_to(scene.points, (count, *scene.points.shape))
    targets, weights, start = np.sqrt(count) * wanted * own, each * own, None
    gains, least = scene.propagation().T, np.inf
    for _ in range(1 + rounds):
        with without_warnings():
            batch = solve_batch(scene, places, targets, solver, weights=weights, start=start, **options)
        pressures = np.abs(batch.drives @ gains)
        mean = np.sqrt((pressures**2).mean(axis=0))
        missed = (share * (mean - wanted) ** 2).sum() / (share * wanted**2).sum()
        if missed < least:
            least, best = missed, (targets, batch.drives)
        targets = pressures * np.divide(wanted, mean, out=np.zeros(len(wanted)), where=mean > 0)
        weights, start = each, batch.drives
    if least > MISSED**2:
        warn(
            f"the mean of {count} frames misses the pressures by {100 * np.sqrt(least):.2g} %:"
            " give more frames, or fewer points or lower pressures"
        )
    return Sequence(scene.array, places, *best, rate=rate, closed=True, solver=solver, **air_of(scene))
