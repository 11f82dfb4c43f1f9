"""Arguments from Python: unusual values give an error of one line, unusual memory layouts change nothing."""

from typing import Any

import numpy as np

from guided import REFUSALS, Data, fuzz, laid_out, midair, numbers, odd, refused

#: Options and arguments whose cost in time or memory grows with their value, each with its largest value.
COSTS = {"steps": 20, "starts": 4, "sweeps": 4, "phases": 300}
COSTS |= {"pixels": 30, "threads": 4, "nx": 20, "ny": 20, "tiles": 2}

ARRAY = midair.Array.grid(4, 3, 0.01)
POINTS = np.array([[0.0, 0.0, 0.125], [0.015625, 0.0, 0.125], [0.0, 0.03125, 0.25]])
SCENE = midair.Scene(ARRAY, POINTS)
MATRIX = midair.Propagation(np.arange(1.0, 13.0).reshape(3, 4) + 1j)
DRIVE = np.ones(12, np.complex64)
#: The offset of the points above the array, in m.
ABOVE = np.array([0.0, 0.0, 0.25])


def cheap(name: str, value: Any) -> Any:
    """Returns the value, or the limit in COSTS if the value is larger."""
    most = COSTS.get(name)
    if most is None:
        return value
    try:
        return value if int(np.max(value)) <= most else most
    except Exception:
        return value


def keywords(data: Data, *names: str) -> dict[str, Any]:
    """Returns some of these arguments, each with an arbitrary value."""
    chosen = [name for name in names if data.ConsumeIntInRange(0, 3) == 3]
    return {name: cheap(name, odd(data)) for name in chosen}


MEDIUM = tuple(midair._midair.scene_keys()["medium"])
TRANSDUCER = ("source_pressure", "directivity", "response", "mask", "quantization")


def points(data: Data) -> Any:
    """Returns points, mostly valid ones."""
    if data.ConsumeIntInRange(0, 3) == 0:
        return odd(data)
    return laid_out(data, numbers(data, data.ConsumeIntInRange(1, 4), 3) + ABOVE)


def method(data: Data) -> tuple[Any, dict[str, Any]]:
    """Returns a solver and some of its options."""
    if data.ConsumeIntInRange(0, 7) == 0:
        return odd(data), keywords(data, "steps", "phases", "order", "limit")
    name = data.PickValueInList(list(midair.solvers()))
    return name, keywords(data, *midair.solvers()[name].options, "balance", "aim")


def scene(data: Data) -> midair.Scene:
    array = ARRAY
    way = data.ConsumeIntInRange(0, 5)
    if way == 1:
        where = laid_out(data, numbers(data, 5, 3)) if data.ConsumeBool() else odd(data)
        array = midair.Array(where, **keywords(data, "normals", *TRANSDUCER))
    elif way == 2:
        chosen = {"nx": 3, "ny": 2, "pitch": 0.01, **keywords(data, "nx", "ny", "pitch", *TRANSDUCER)}
        array = midair.Array.grid(**chosen)
    elif way == 3:
        array = midair.Array.preset(odd(data), **keywords(data, "tiles"))
    return midair.Scene(array, points(data), **keywords(data, "pressures", "weights", *MEDIUM))


def solve(data: Data) -> None:
    name, options = method(data)
    subject = MATRIX if data.ConsumeBool() else scene(data)
    more = keywords(data, "pressures", "weights", "quantization", "mask", "positions", "start")
    solution = midair.solve(subject, name, **options, **more)
    assert np.isfinite(solution.pressures).all()
    assert np.abs(solution.drive).max() <= 1 + 1e-6


def solver(data: Data) -> None:
    name, options = method(data)
    follow = midair.Solver(ARRAY, name, **options, **keywords(data, "points", *MEDIUM))
    for _ in range(data.ConsumeIntInRange(1, 3)):
        follow(points(data), **keywords(data, "pressures", "weights", "start", "out"))


def batch(data: Data) -> None:
    name, options = method(data)
    where = numbers(data, 2, data.ConsumeIntInRange(1, 3), 3) + ABOVE
    where = odd(data) if data.ConsumeIntInRange(0, 3) == 0 else laid_out(data, where)
    more = keywords(data, "pressures", "weights", "start", "out", "threads", *MEDIUM)
    midair.solve_batch(ARRAY, where, solver=name, **options, **more)


def look(data: Data) -> None:
    drive = odd(data) if data.ConsumeBool() else laid_out(data, DRIVE)
    plane = odd(data)
    if data.ConsumeBool():
        plane = midair.Plane(**{"z": 0.1, "pixels": 5, **keywords(data, "z", "size", "pixels", "center")})
    field = midair.field(SCENE, drive, plane)
    assert np.isfinite(field.pressure).all()
    midair.judge(SCENE, drive)


def matrix(data: Data) -> None:
    midair.Propagation(odd(data))


def layouts(data: Data) -> None:
    """Checks that results do not depend on how points, pressures and weights are stored in memory."""
    where, requested = numbers(data, 3, 3) + ABOVE, abs(numbers(data, 3)) + 1.0
    plain = midair.solve(midair.Scene(ARRAY, where, requested, weights=requested), "fast")
    lying = [laid_out(data, array) for array in (where, requested, requested)]
    found = midair.solve(midair.Scene(ARRAY, lying[0], lying[1], weights=lying[2]), "fast")
    assert np.array_equal(plain.drive, found.drive), lying
    follow = midair.Solver(ARRAY, "fast")(lying[0], lying[1], weights=lying[2])
    assert np.array_equal(plain.drive, follow.drive), lying
    several = laid_out(data, np.stack([where, where]))
    both = midair.solve_batch(ARRAY, several, lying[1], "fast", weights=lying[2])
    assert np.array_equal(plain.drive, both.drives[1]), lying
    out = laid_out(data, np.zeros(12, np.complex64))
    if isinstance(out, np.ndarray):
        midair.Solver(ARRAY, "fast")(where, requested, weights=requested, out=out)
        assert np.array_equal(plain.drive, out), out


DOORS = [solve, solver, batch, look, matrix, layouts]


def test(content: bytes) -> None:
    data = Data(content)
    try:
        data.PickValueInList(DOORS)(data)
    except REFUSALS as error:
        refused(error)


fuzz(test)
