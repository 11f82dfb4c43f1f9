"""Moving traps, traps for a bead that the scene describes, and a signature for each point."""

import copy
import pickle
from typing import Any

import numpy as np
import pytest

import beads
import midair
import traps


@pytest.mark.slow
@pytest.mark.parametrize(
    ("count", "quantization", "laps"),
    [
        (2, {}, 0.2),
        (4, {}, 0.05),
        (2, {"phases": 128}, 0.05),
        *(pytest.param(*case, 0.4, marks=pytest.mark.long) for case in ((2, {}), (4, {}), (2, {"phases": 128}))),
    ],
)
def test_traps_in_motion_stay_stiff_and_carry_their_beads(count: int, quantization: Any, laps: float) -> None:
    positions, normals = traps.openmpd()
    array = midair.Array(positions, normals, source_pressure=2.3, quantization=quantization)
    points = beads.circle(count, 0.8, 10e3, laps=laps, start=0.02)
    moved = midair.sequence(array, points, rate=10e3, change=np.pi / 16, signature="trap")
    assert moved.metrics.largest_change <= np.pi / 16 * (1 + 1e-5)
    begin = midair.rest(moved.scene(0), moved.drives[0]).place
    assert beads.Air(positions, 2.3).stray(moved.drives, points, begin, 10e3).max() < 0.5e-3
    for t in range(40, len(points), 100):
        scene = midair.Scene(array, points[t], signature="trap")
        alone, bounded = (
            np.linalg.eigvalsh(midair.gorkov(scene, drive).hessian).min()
            for drive in (midair.solve(scene), moved.drives[t])
        )
        assert bounded > (0.7 if count == 2 else 0.6) * alone


@pytest.mark.slow
@pytest.mark.parametrize(
    ("count", "laps", "radius", "rate", "every"),
    [
        (1, 1.2, 0.0036, 5e3, 2),
        *(pytest.param(*case, 0.009, 10e3, 1, marks=pytest.mark.long) for case in ((1, 3), (2, 3))),
    ],
)
def test_laps_of_traps_known_in_advance_close_and_carry_their_beads(
    count: int, laps: float, radius: float, rate: float, every: int
) -> None:
    positions, normals = (each[::every] for each in traps.openmpd())
    array = midair.Array(positions, normals, source_pressure=2.3)
    # In whole frames a lap, .8 m/s at 10 kHz.
    lap = round(2 * np.pi * radius / 0.08e-3)
    ring = midair.path.circle([0, 0, 0], radius, frequency=rate / lap, points=count, normal=(0, 1, 0))
    steps: list[tuple[int, int]] = []
    moved = midair.sequence(
        array, ring, rate=rate, signature="trap", ahead="all", progress=lambda *step: steps.append(step)
    )
    assert moved.closed
    assert steps[-1][0] == steps[-1][1]
    turns = np.angle(moved.drives[:] * np.roll(moved.drives[:], 1, axis=0).conj())
    assert abs(turns).max() <= np.pi / 16 * (1 + 1e-5)
    frames = np.arange(round(laps * lap)) % lap
    points, drives = moved.points[frames], moved.drives[:][frames]
    begin = midair.rest(moved.scene(0), moved.drives[0]).place
    speed = (moved.points[1] - moved.points[-1]) * rate / 2
    air = beads.Air(positions, 2.3)
    assert air.stray(drives[:-1], points, begin, rate, speed).max() < 0.5e-3
    for t in range(0, lap, 101):
        scene = midair.Scene(array, moved.points[t], signature="trap")
        alone, bounded = (
            np.linalg.eigvalsh(midair.gorkov(scene, drive).hessian).min()
            for drive in (midair.solve(scene), moved.drives[t])
        )
        assert bounded > (0.98 if count == 1 else 0.55) * alone


def test_an_open_sequence_of_traps_known_in_advance_is_stiffer_than_foci_and_can_be_stopped() -> None:
    array = midair.Array(*traps.tinylev(), quantization={"phases": 64})
    points = beads.circle(2, 0.2, 2e3)[:40, :, [0, 1, 2]] * 0.2
    keywords: dict[str, Any] = {"rate": 2e3, "change": np.pi / 8, "signature": "trap", "ahead": "all"}
    stiff = midair.sequence(array, points, closed=False, **keywords)
    foci = midair.sequence(array, points, closed=False, pressures=1000.0, aim="max", **keywords)
    for moved in (stiff, foci):
        assert moved.metrics.largest_change <= np.pi / 8 * (1 + 1e-5)
    for t in (0, 13, 26, 39):
        softest = [
            np.linalg.eigvalsh(midair.gorkov(moved.scene(t), moved.drives[t]).hessian).min() for moved in (stiff, foci)
        ]
        assert softest[0] > softest[1]

    def progress(step: int, steps: int) -> None:
        # The sweeps of traps, after the rounds of tracks.
        if steps > 20 and step == 3:
            raise RuntimeError("no more")

    with pytest.raises(RuntimeError, match="no more"):
        midair.sequence(array, points, closed=False, progress=progress, **keywords)


@pytest.mark.slow
@pytest.mark.parametrize("signature", [["trap", None], "factors"])
@pytest.mark.parametrize("ahead", [4, "all"])
def test_a_signature_by_point_holds_in_every_frame_that_is_solved_ahead(ahead: Any, signature: Any) -> None:
    array = midair.Array.preset("openmpd_pair")
    # A trap, which is dark, and a focus, as loud as the array makes it there.
    x = np.linspace(0, 2e-3, 21)
    points = np.stack([np.stack([x, 0 * x, 0 * x], -1), np.stack([0 * x, 0 * x + 0.04, x], -1)], axis=1)
    if signature == "factors":
        side = np.where(array.positions[:, 2] > 0, -1, 1)
        signature = np.stack([side, np.ones_like(side)]).astype(complex)
    moved = midair.sequence(array, points, rate=1e3, signature=signature, ahead=ahead)
    for t in range(0, 21, 5):
        scene = midair.Scene(array, points[t])
        trap, focus = abs(midair.field(scene, moved.drives[t], points[t]).pressure)
        assert trap < 0.1 * focus
        alone = midair.solve(midair.Scene(array, points[t], signature=signature))
        assert focus > 0.9 * abs(alone.pressures[1])


def test_traps_that_stand_still_keep_their_codes() -> None:
    array = midair.Array(*traps.tinylev(), quantization={"phases": 32})
    points = np.broadcast_to([[0.0, 0, 0.002], [0.005, 0, -0.01]], (12, 2, 3))
    moved = midair.sequence(array, points, rate=1e3, signature="trap", change=np.pi / 4)
    assert moved.changes[-3:].max() == 0


def test_the_first_frame_of_a_closed_sequence_carries_its_bead_as_the_others_do() -> None:
    array = midair.Array.preset("openmpd_pair", quantization={})
    # With these numbers, a lap has exactly 625 frames.
    radius, frequency = 0.01, 16
    speed = 2 * np.pi * frequency * radius
    ring = midair.path.circle([0, 0, 0], radius, frequency=frequency)
    moved = midair.sequence(array, ring, rate=10e3, signature="trap", change=np.pi / 4)
    for t in (0, 1, len(moved) // 3, len(moved) - 1):
        place = moved.points[t]
        felt = midair.gorkov(moved.scene(t), moved.drives[t], place)
        scene = moved.scene(t)
        inwards = -place[0] / np.linalg.norm(place[0])
        pulled = speed**2 / radius * scene._mass()
        # A second part of the force overcomes the drag. It acts along the path, at right angles to this part.
        assert felt.net[0] @ inwards == pytest.approx(pulled, rel=0.02)
        along = np.cross([0, 0, 1.0], -inwards)
        drag = np.linalg.norm(scene._needed(np.array([[speed, 0, 0]]), np.zeros((1, 3))))
        assert felt.net[0] @ along == pytest.approx(drag, rel=0.02)


def test_frames_around_a_stretch_do_not_change_foci() -> None:
    array = midair.Array(*traps.tinylev())
    ring = midair.path.circle([0, 0, 0], 0.003, speed=0.2)
    points = ring.frames(4e3)[0][:12]
    plain, around = (midair.Solver(array, "glide", rate=4e3) for _ in range(2))
    assert np.array_equal(plain.follow(points[2:10]), around.follow(points, margin=2))
    with pytest.raises(midair.SceneError, match="margin is 6: give more frames"):
        around.follow(points, margin=6)


def test_a_sequence_of_traps_that_was_cut_off_goes_on_to_the_same_bits() -> None:
    array = midair.Array(*traps.tinylev())
    ring = midair.path.circle([0, 0, 0], 0.003, speed=0.2, points=2)
    points, _ = ring.frames(4e3)[:2]
    keywords: dict[str, Any] = {"signature": "trap", "rate": 4e3, "change": np.pi / 8}
    whole, first = (midair.Solver(array, "glide", **keywords) for _ in range(2))
    drives, begun = whole.follow(points[:12]), first.follow(points[:7])
    kept = first.last()
    assert kept is not None
    other = midair.Solver(array, "glide", **keywords)
    other.restore(*kept)
    assert np.array_equal(drives, np.concatenate([begun, other.follow(points[7:12])]))


def test_each_point_may_have_its_own_signature() -> None:
    positions, normals = traps.openmpd()
    points = np.array([[0.02, 0, 0], [-0.02, 0.01, 0.004], [0, -0.02, -0.01]])
    names = ["trap", None, "vortex"]
    scene = midair.Scene(midair.Array(positions, normals), points, [3000.0, 1500.0, 2000.0], signature=names)
    assert scene.signature == names
    plain = scene.replace(signature=None).propagation()
    for j, name in enumerate(names):
        alone = plain[j] if name is None else scene.replace(signature=name).propagation()[j]
        np.testing.assert_allclose(scene.propagation()[j], alone, atol=1e-3)
    solution = midair.solve(scene)
    np.testing.assert_allclose(abs(solution.pressures), scene.pressures, rtol=1e-3)
    # In the real field, without the signatures' phases, the focus is as loud, and the traps are quiet.
    real = abs(solution.field(points).pressure)
    assert real[1] == pytest.approx(1500, rel=1e-3)
    assert (real[[0, 2]] < 0.5 * scene.pressures[[0, 2]]).all()
    for again in (midair.Scene.parse(scene.json()), pickle.loads(pickle.dumps(scene))):
        assert again == scene
    assert '"focus"' in scene.json()
    # A point of weight 0 is left out, and the other points keep their signatures.
    rest = midair.solve(scene, weights=[1, 0, 1])
    np.testing.assert_allclose(abs(rest.pressures[[0, 2]]), [3000, 2000], rtol=1e-3)
    for bad, refusal in (
        (["trap", "focus"], "2 names"),
        (["trap", "hold", None], "hold"),
        ([None, 3, None], "signature\\[1\\]"),
    ):
        with pytest.raises(midair.SceneError, match=refusal):
            scene.replace(signature=bad)


@pytest.mark.parametrize("copied", [lambda one: pickle.loads(pickle.dumps(one)), copy.copy, copy.deepcopy])
def test_what_rests_can_be_copied(copied: Any) -> None:
    rest = midair.rest(midair.Scene(midair.Array(*traps.tinylev()), [[0, 0, 0]]), np.ones(72))
    again = copied(rest)
    for name in ("place", "held", "stiffness", "axes", "basin", "restoring", "frequencies"):
        np.testing.assert_array_equal(getattr(again, name), getattr(rest, name))


def test_traps_are_made_for_the_bead_of_the_scene() -> None:
    array = midair.Array(*traps.tinylev())
    points = np.array([[0.0, 0, 0.002], [0.005, 0, -0.01]])
    bead = {"radius": 0.8e-3, "density": 150.0, "gravity": [-9.81, 0, 0]}
    scene = midair.Scene(array, points, signature="trap", bead=bead)
    assert scene.bead == midair.Bead(**bead)
    assert scene == scene.replace(bead=midair.Bead(**bead))
    for again in (
        midair.Scene.parse(scene.json()),
        pickle.loads(pickle.dumps(scene)),
        scene.replace(points=points),
    ):
        assert again == scene
        assert again.bead == scene.bead
    resting, other = midair.solve(scene).rest(), midair.solve(scene.replace(bead={}))
    astray = midair.rest(scene, other.drive)
    assert resting.held.all()
    # With 72 transducers, the drive for the default bead lets this bead sag by more than 0.3 mm.
    far, farther = (np.linalg.norm(rest.place - points, axis=1).max() for rest in (resting, astray))
    assert far < 0.15e-3 < 0.5 * farther
    assert not np.array_equal(other.drive, midair.solve(scene).drive)
    felt = midair.gorkov(scene, other.drive)
    reported = midair.gorkov(scene.replace(bead={}), other.drive, bead=bead)
    assert felt == reported
    assert np.array_equal(midair.Solver(array, signature="trap", bead=bead)(points).drive, midair.solve(scene).drive)
    for bad, match in (
        ({"radius": 0}, "bead.radius is 0"),
        ({"weight": 1}, 'key of bead "weight"'),
        ({"gravity": [0, 1]}, "bead.gravity"),
        (3, "bead is 3"),
    ):
        with pytest.raises(midair.SceneError, match=match):
            scene.replace(bead=bad)
