"""Arrays from files of other programs, compared with geometry that is computed here from the formats'
documents.
"""

import gzip
import json
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair
from midair._boards import pat
from midair._files import read_array

HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n<java version="11.0.9" class="java.beans.XMLDecoder">\n'


def openmpd_places() -> np.ndarray[Any, Any]:
    """Returns 16 x 16 positions with a pitch of 10.5 mm:
    x rises slowest from -78.75 mm, y falls from +78.75 mm.
    """
    side = [-0.07875 + 0.0105 * k for k in range(16)]
    return np.array([[x, y, 0.0] for x in side for y in reversed(side)])


def pat_lines(**changed: Any) -> list[str]:
    """Returns the seven lines of an OpenMPD board's file; transducer t has pin 255 - t."""
    places = "".join(f"({x:f}, {y:f}, {z:f})," for x, y, z in openmpd_places())
    pins = "".join(f"{255 - t}," for t in range(256))
    degrees = "".join(f"{(7 * t) % 360 - 179}," for t in range(256))
    gains = "".join(f"{0 if t in (3, 200) else 1:f}," for t in range(256))
    lines = ["FT0TEST", "256", "128", places, pins, degrees, gains]
    for line, text in changed.items():
        lines[int(line.removeprefix("line")) - 1] = text
    return lines


def pat_file(path: Path, **changed: Any) -> Path:
    path.write_text("\n".join(pat_lines(**changed)) + "\n", encoding="utf-8")
    return path


def test_a_board_of_openmpd(tmp_path: Path) -> None:
    path = pat_file(tmp_path / "board_7.pat")
    board = pat.read(path)
    assert (board.serial, board.divisions) == ("FT0TEST", 128)
    np.testing.assert_allclose(board.positions, openmpd_places(), atol=1e-9)
    np.testing.assert_array_equal(board.pins, 255 - np.arange(256))
    np.testing.assert_array_equal(board.corrections, (7 * np.arange(256)) % 360 - 179)
    assert np.flatnonzero(board.gains == 0).tolist() == [3, 200]
    array = midair.Array.from_file(path)
    np.testing.assert_allclose(array.positions, openmpd_places(), atol=1e-9)
    assert (array.normals == [0, 0, 1]).all()
    assert (array.source_pressure, array.directivity) == (3.4, {"piston": 4.5e-3})
    assert array.quantization is not None
    assert array.quantization["phases"] == 128
    drive = midair.solve(midair.Scene(array, [[0, 0, 0.1]]), "naive").drive
    assert np.flatnonzero(drive == 0).tolist() == [3, 200]
    other = read_array(path, source_pressure=1.5, directivity="point", quantization={}, mask=np.arange(256) > 9)
    assert (other.source_pressure, other.directivity, other.quantization) == (1.5, "point", None)
    assert not other.mask[:10].any()
    assert other.mask[10:].all()


@pytest.mark.parametrize("text", ["\n".join(pat_lines()), "\r\n".join(pat_lines()) + "\r\n\r\n"])
def test_line_ends_of_a_board_file_do_not_matter(text: str, tmp_path: Path) -> None:
    path = tmp_path / "a.pat"
    path.write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert pat.read(path).serial == "FT0TEST"


ROW = "".join(f"{t}," for t in range(256))

BROKEN_PAT = {
    "255 transducers": ({"line2": "255"}, "line 2: number of transducers is .255.: give 256"),
    "no count": ({"line2": "many"}, 'line 2: .* is "many"'),
    "one division": ({"line3": "1"}, "line 3: divisions of a period is"),
    "half a division": ({"line3": "12.5"}, "line 3: divisions of a period is"),
    "a position less": ({"line4": pat_lines()[3].split("(", 2)[-1].join(["(", ""])}, "line 4: 255 positions"),
    "flat position": ({"line4": "(0, 0)," * 256}, "line 4: position 0 is .0, 0.: give three"),
    "position of words": ({"line4": "(0, a, 0)," * 256}, 'line 4: y of position 0 is "a"'),
    "position beyond": ({"line4": "(0, 0, nan)," * 256}, 'line 4: z of position 0 is "nan"'),
    "not positions": ({"line4": ROW}, "line 4: .* is no position"),
    "pin twice": (
        {"line5": ROW.replace("255,", "254,")},
        "line 5: pin 254 is there 2 times, pin 255 is missing",
    ),
    "pin too large": ({"line5": ROW.replace("255,", "256,")}, "line 5: pin 256 is none"),
    "pin by halves": ({"line5": ROW.replace("255,", "2.5,")}, "line 5: pin 2.5 is none"),
    "pin left out": ({"line5": ROW.replace("17,", ",", 1)}, 'line 5: pin 17 is ""'),
    "few pins": ({"line5": "0,1,2"}, "line 5: 3 pins: give one for each of 256"),
    "corrections in rows": ({"line6": "1,2,3\n4,5,6"}, "line 6: 3 corrections: give one for each of 256"),
    "correction of words": ({"line6": ROW.replace("255,", "x,")}, 'line 6: correction 255 is "x"'),
    "negative gain": ({"line7": ROW.replace("255,", "-1,")}, "line 7: gain -1 is negative"),
    "gain beyond": ({"line7": ROW.replace("255,", "inf,")}, 'line 7: gain 255 is "inf"'),
    "a line more": ({"line7": ROW + "\n1"}, "line 8: 8 lines: a .pat file has seven"),
    "a line less": ({"line7": ""}, "line 7: the gains are missing"),
    "a hole": ({"line3": ""}, "line 3: the divisions of a period are missing"),
}


@pytest.mark.parametrize("name", BROKEN_PAT)
def test_a_broken_board_file_names_its_line(name: str, tmp_path: Path) -> None:
    changed, reported = BROKEN_PAT[name]
    path = pat_file(tmp_path / "broken.pat", **changed)
    with pytest.raises(midair.SceneError, match=rf'file "{re.escape(str(path))}", {reported}') as refused:
        pat.read(path)
    assert "\n" not in str(refused.value)


def number(property_: str, value: float, kind: str = "float") -> str:
    return f'<void property="{property_}"><{kind}>{value}</{kind}></void>'


def transducer(index: int, place: Any, turn: Any = (1, 0, 0, 0), power: float | None = 2.4) -> str:
    """Returns a transducer's XML as Java writes it:
    fields by getField, properties by setters, without defaults.
    """
    name = 'class="acousticfield3d.math.Vector3f" method="getField"'
    parts = []
    for axis, value in zip("xyz", place, strict=True):
        setting = f'<void method="set"><object idref="V{index}"/><float>{value}</float></void>'
        parts.append(f"<void {name}><string>{axis}</string>{setting}</void>" if value else "")
    rotation = "".join(number(axis, value) for axis, value in zip("wxyz", turn, strict=True))
    rest = f'<void property="rot">{rotation}</void>' if tuple(turn) != (1, 0, 0, 0) else ""
    field = 'class="acousticfield3d.simulation.Transducer" method="getField"'
    setting = f'<void method="set"><object idref="T{index}"/><float>{power}</float></void>'
    strength = "" if power is None else f"<void {field}><string>power</string>{setting}</void>"
    order = number("orderNumber", index, "int") if index else ""
    translation = f'<void id="V{index}" property="translation">{"".join(parts)}</void>'
    inside = f'{strength}{order}<void property="transform">{translation}{rest}</void>'
    return f'<object class="acousticfield3d.simulation.Transducer" id="T{index}">{inside}</object>'


def simulation(transducers: list[str]) -> str:
    added = "".join(f'<void method="add">{one}</void>' for one in transducers)
    getting = f'<void id="L" method="get"><object idref="S"/>{added}</void>'
    field = 'class="acousticfield3d.simulation.Simulation"'
    listed = f'<void {field} method="getField"><string>transducers</string>{getting}</void>'
    return f'{HEAD}<object {field} id="S">{listed}</object></java>'


def test_ultraino_is_turned_upright_and_ordered(tmp_path: Path) -> None:
    places = [(0.01 * k, 0.002 * k, -0.03 * k) for k in range(5)]
    # A rotation about x by 90 degrees moves +y to +z. Files have only seven digits, so the length of a
    # quaternion may differ from 1.
    half = np.sqrt(0.5) * 1.0001
    turns = [(1, 0, 0, 0), (half, half, 0, 0), (0, 1, 0, 0), (half, 0, 0, half), (1, 0, 0, 0)]
    theirs = [(0, 1, 0), (0, 0, 1), (0, -1, 0), (-1, 0, 0), (0, 1, 0)]
    text = simulation([transducer(k, places[k], turns[k]) for k in (3, 1, 0, 4, 2)])
    for name, content in (("a.xml", text.encode()), ("a.xml.gz", gzip.compress(text.encode()))):
        path = tmp_path / name
        path.write_bytes(content)
        array = read_array(path)
        np.testing.assert_allclose(array.positions, [(x, -z, y) for x, y, z in places], atol=1e-12)
        np.testing.assert_allclose(array.normals, [(x, -z, y) for x, y, z in theirs], atol=1e-6)
        assert (array.source_pressure, array.directivity) == (2.4, {"sinc": 9e-3})
        assert array.response is None


def test_ultraino_defaults_and_mixed_powers(tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    path.write_text(simulation([transducer(k, (0.01 * k, 0, 0), power=None) for k in range(3)]), encoding="utf-8")
    assert read_array(path).source_pressure == 2.53
    path.write_text(
        simulation([transducer(k, (0.01 * k, 0, 0), power=2.0 + 2 * (k == 1)) for k in range(3)]),
        encoding="utf-8",
    )
    array = read_array(path)
    assert array.source_pressure == 4.0
    assert array.response is not None
    np.testing.assert_allclose(array.response, [0.5, 1, 0.5])


def test_ultraino_frequency_and_phase_corrections(tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    each = [transducer(k, (0.01 * k, 0, 0)) for k in range(2)]
    low = number("frequency", 25e3)
    path.write_text(simulation([one.replace("</object>", f"{low}</object>") for one in each]), encoding="utf-8")
    assert read_array(path).medium["frequency"] == 25e3
    path.write_text(simulation([each[0].replace("</object>", f"{low}</object>", 1), each[1]]), encoding="utf-8")
    with pytest.raises(midair.SceneError, match="transducers of 25000 and of 40000 Hz are in it"):
        read_array(path)
    turned = number("phaseCorrection", 1.0)
    path.write_text(simulation([each[0], each[1].replace("</object>", f"{turned}</object>")]), encoding="utf-8")
    with pytest.warns(midair.SceneWarning, match="phaseCorrection of 1 transducer of .* is not read"):
        assert len(read_array(path)) == 2


def test_setters_wrapped_around_other_objects(tmp_path: Path) -> None:
    """Checks that midair reads an object that is written inside the call that sets its x:
    Java's XMLEncoder writes an object where it is first used.
    """
    transform = '<void id="M" property="transform"><void id="V" property="translation"/></void>'
    inner = f'<void class="acousticfield3d.simulation.Transducer" id="T">{transform}</void><void idref="M"/>'
    setting = f'<void method="set">{inner}<object idref="V"/><float>0.07</float></void>'
    outer = f'<void class="acousticfield3d.math.Vector3f" method="getField"><string>x</string>{setting}</void>'
    path = tmp_path / "wrapped.xml"
    path.write_text(f"{HEAD}{outer}{transducer(1, (0, 0, 0.01))}</java>", encoding="utf-8")
    np.testing.assert_allclose(read_array(path).positions, [[0.07, 0, 0], [0, -0.01, 0]])


def test_handybeam(tmp_path: Path) -> None:
    rows = [(2, 10.47, 0, 1, "B"), (0, -10.47, 0, 1, "A"), (1, 0, 5.235, 1, "X")]
    inside = "".join(
        f'<Transducer Index="{index}" Xmm="{x}" Ymm="{y}" Zmm="{z}" ABX="{abx}"/>' for index, x, y, z, abx in rows
    )
    path = tmp_path / "system.xml"
    path.write_text(f"<Renderer><System><Transducers>{inside}</Transducers></System></Renderer>", "utf-8")
    array = read_array(path)
    expected = np.array([[-10.47, 0, 1], [0, 5.235, 1], [10.47, 0, 1]]) / 1e3
    np.testing.assert_allclose(array.positions, expected)
    assert array.mask.tolist() == [True, False, True]
    assert (array.directivity, len(array)) == ({"cos": 3.376}, 3)


def test_autd3_boards_with_any_pose(tmp_path: Path) -> None:
    missing = {(1, 1), (2, 1), (16, 1)}
    own = np.array([[10.16 * x, 10.16 * y, 0] for y in range(14) for x in range(18) if (x, y) not in missing])
    turn = np.array([0.7, -0.2, 0.5, 0.1])
    w, x, y, z = turn / np.linalg.norm(turn)
    matrix = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    boards = [
        {"origin": [0, 0, 0], "rotation": [1, 0, 0, 0]},
        {"origin": [192.0, -30.5, 12.25], "rotation": [w, x, y, z]},
    ]
    path = tmp_path / "geometry.json"
    path.write_text(json.dumps(boards), encoding="utf-8")
    array = read_array(path)
    expected = np.concatenate([own, own @ matrix.T + [192.0, -30.5, 12.25]]) / 1e3
    np.testing.assert_allclose(array.positions, expected, atol=1e-9)
    np.testing.assert_allclose(array.normals[[0, 248]], [[0, 0, 1]] * 2, atol=1e-12)
    np.testing.assert_allclose(array.normals[[249, 497]], [matrix[:, 2]] * 2, atol=1e-12)
    assert array.source_pressure == 4.386
    assert array.quantization is not None
    assert array.quantization["phases"] == 256


CSV = {
    "plain": "0,0,0\n0.01,0,0\n",
    "normals": "0,0,0,0,0,1\n0.01,0,0,0,1,1\n",
    "names": "Z;y;other;X\n0.5;0.02;a;0.01\n0.5;0.03;b;0.02\n",
    "comments": "# made by hand\n\n x , y,z,nx,ny,nz\n0,0,0,0,0,2\n\n",
    "tabs": '"x"\t"y"\t"z"\n1e-2\t0\t0\n',
    "mark": "\ufeffx,y,z\n0,0,0\n0.02,0,-0.01\n",
}

WRONG_CSV = {
    "two columns": ("0,0\n", "line 1: 2 columns: give x,y,z or x,y,z,nx,ny,nz in metres"),
    "a word": ("0,0,0\n0,a,0\n", 'line 2: y is "a": give a number'),
    "not finite": ("0,0,nan\n", 'line 1: z is "nan"'),
    "short row": ("0,0,0\n0,0\n", 'line 2: z is ""'),
    "underscore": ("0,0,1_0\n", 'line 1: z is "1_0"'),
    "no z": ("x,y,nx\n0,0,0\n", "line 1: columns are x, y, nx: name them x,y,z or"),
    "half normals": ("x,y,z,nx\n0,0,0,0\n", "line 1: columns are x, y, z, nx: name them x,y,z or"),
    "names alone": ("x,y,z\n", "empty: give rows x,y,z in metres"),
    "no direction": ("0,0,0,0,0,0\n", "normal"),
}


@pytest.mark.parametrize("name", CSV)
def test_csv_is_read_as_scene_files_read_it(name: str, tmp_path: Path) -> None:
    path = tmp_path / "row.csv"
    path.write_text(CSV[name], "utf-8")
    scene = '[array]\npositions = { file = "row.csv" }\n[[points]]\nposition = [0, 0, 1.1]\n'
    assert read_array(path) == midair.Scene.parse(scene, folder=tmp_path).array


#: Unusual CSV files: midair._files and scene files must read them alike, or reject them with the same
#: message.
ODD_CSV = [
    b"",
    b"\n\n",
    b"# nothing\n",
    b"x,y,z\n",
    b"0,0,0",
    b"0,0,0\r0,0,1\r",
    b"0,0,0\r\n0,0,1\r\n",
    b"\r\r0,0,0\ra,0,0",
    b"\xef\xbb\xbfx,y,z\n0,0,0\n",
    b"\xff\xfe0\x00",
    b"\xe4,0,0",
    b"x,x,y,z\n0,1,0,0\n0,2,0,1\n",
    b"X,Y,Z,x\n0,0,0,1\n",
    b"x,y,z,nx,ny,nz,nx\n0,0,0,0,0,1,1\n",
    b"z;y;x\n1;2;3\n",
    b"z\ty\tx\n1\t2\t3\n",
    b"0,0;0,0;0,1\n",
    b"0 0 0\n",
    "\uff11,0,0\n".encode(),
    "0,\u0661,0\n".encode(),
    b"0,\x000,0\n",
    b"0,0,\x1b[31m\n",
    b'"0","0","0"\n',
    b'"0,0",0,0\n',
    b"0,0,0,\n",
    b"0,0\n",
    b"0,0,0,0\n",
    b"0,0,0,0,0,1\n0,0,1,0,0\n",
    b"0,0,0\n0,0,1,5\n",
    b"0,0,0\n0,0\n",
    b"nan,0,0\n",
    b"0,inf,0\n",
    b"0,0,-Infinity\n",
    b"1e400,0,0\n",
    b"0,0,1e-400\n",
    b"-0.0,+1,.5\n",
    b"1_0,0,0\n",
    b"0x1,0,0\n",
    b"x_mm,y_mm,z_mm\n1,2,3\n",
    b"x [m],y [m],z [m]\n1,2,3\n",
    b"x,y\n0,0\n",
    b"x,y,z,nx\n0,0,0,1\n",
    b"name,x,y,z\na,0,0,1\n",
    b"a,b,c\n1,2,3\n",
    b"x,y,z\nx,y,z\n",
    b"0,0,0 # here\n",
    b" # x\n\t0 ,\t0,0\n",
    b"0,,0\n",
    b",,\n",
    b"0;0;0\n0,0,1\n",
    b"x,y,z\x0b0,0,0\n",
    b"0,0,0\x0c0,0,1\n",
    "x,y,z\u20280,0,0\n".encode(),
    b"[0, 0, 0]\n",
    b"0.1.2,0,0\n",
    b"--1,0,0\n",
]


@pytest.mark.parametrize("data", ODD_CSV)
def test_odd_files_are_read_alike_and_refused_in_the_same_words(data: bytes, tmp_path: Path) -> None:
    path = tmp_path / "row.csv"
    path.write_bytes(data)
    scene = '[array]\npositions = { file = "row.csv" }\n[[points]]\nposition = [0, 0, 1.1]\n'

    def outcome(read: Callable[[], midair.Array]) -> tuple[str, object]:
        try:
            array = read()
        except midair.SceneError as refusal:
            return "refused", str(refusal)
        return "read", (array.positions.tolist(), array.normals.tolist())

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", midair.SceneWarning)
        one = outcome(lambda: read_array(path))
        assert one == outcome(lambda: midair.Scene.parse(scene, folder=tmp_path).array)
    assert one[0] == "read" or ("\n" not in str(one[1]) and str(one[1]).isprintable())


@pytest.mark.parametrize("name", WRONG_CSV)
def test_what_scene_files_refuse_is_refused(name: str, tmp_path: Path) -> None:
    text, reported = WRONG_CSV[name]
    path = tmp_path / "row.csv"
    path.write_text(text, "utf-8")
    with pytest.raises(midair.SceneError, match=reported):
        read_array(path)
    scene = '[array]\npositions = { file = "row.csv" }\n[[points]]\nposition = [0, 0, 0.1]\n'
    with pytest.raises(midair.SceneError):
        midair.Scene.parse(scene, folder=tmp_path)


@pytest.mark.parametrize(
    "first",
    [
        '<int id="Integer0">1</int>',
        '<object class="java.lang.Integer" id="Integer0"><int>1</int></object>',
        '<object class="java.lang.Integer" id="Integer0"><string>1</string></object>',
    ],
)
def test_a_number_that_another_one_refers_to(first: str, tmp_path: Path) -> None:
    numbers = first, '<object idref="Integer0"/>', "<int>0</int>"
    made = [
        '<object class="acousticfield3d.simulation.Transducer">'
        f'<void property="orderNumber">{number}</void>'
        f'<void property="power"><float>{power}</float></void></object>'
        for power, number in enumerate(numbers, 1)
    ]
    path = tmp_path / "a.xml"
    path.write_text(f'<java class="java.beans.XMLDecoder">{"".join(made)}</java>', encoding="utf-8")
    response = midair.Array.from_file(path).response
    assert response is not None
    assert np.allclose(3 * np.abs(response), [3, 1, 2])


UNSET = '<void id="Integer0" property="shader"/>'


def ordered(orders: list[str], phase: str = "") -> str:
    """Returns an Ultraino file of transducers in a row, with these order numbers. `shader` is never set."""
    made = "".join(
        '<void method="add"><object class="acousticfield3d.simulation.Transducer">'
        f"{UNSET if index == 0 else ''}"
        f'<void property="orderNumber">{order}</void>{phase.format(index)}<void property="transform">'
        f'<void property="translation">{number("x", 0.01 * index)}</void></void></object></void>'
        for index, order in enumerate(orders)
    )
    listed = f'<void property="transducers">{made}</void>'
    return f'{HEAD}<object class="acousticfield3d.simulation.Simulation">{listed}</object></java>'


@pytest.mark.parametrize("size", [2, 5])
@pytest.mark.parametrize("unset", [0, 1])
def test_an_order_by_reference_to_what_was_never_set_is_the_number_left_out(
    size: int, unset: int, tmp_path: Path
) -> None:
    orders = np.random.default_rng(size).permutation(size)
    texts = [f"<int>{k}</int>" if k != unset else '<object idref="Integer0"/>' for k in orders]
    path = tmp_path / "a.xml"
    path.write_text(ordered(texts), encoding="utf-8")
    assert midair.Array.from_file(path).positions[:, 0] == pytest.approx(0.01 * np.argsort(orders))
    # A reference that the others do not settle is 0, Java's default.
    path.write_text(ordered(["<int>7</int>", '<object idref="Integer0"/>', "<int>9</int>"]), encoding="utf-8")
    assert midair.Array.from_file(path).positions[:, 0] == pytest.approx([0.01, 0, 0.02])


def test_the_phases_of_an_ultraino_file_are_its_drive(tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    orders = [2, 0, 1]
    texts = [f"<int>{k}</int>" for k in orders]
    phase = '<void property="phase"><float>0.{}</float></void>'
    path.write_text(ordered(texts, phase), encoding="utf-8")
    phases = np.pi * np.array([0.1, 0.2, 0.0])
    assert np.allclose(midair.read(path), np.exp(1j * phases), atol=1e-6)
    amplitude = '<void property="amplitude"><float>0.5</float></void>'
    path.write_bytes(gzip.compress(ordered(texts, phase + amplitude).encode()))
    assert np.allclose(midair.read(path), 0.5 * np.exp(1j * phases), atol=1e-6)
    path.write_text(ordered(texts, amplitude.replace("0.5", "1.5")), encoding="utf-8")
    with pytest.raises(midair.SceneError, match=r"line 3: amplitude is 1\.5: give 0 to 1"):
        midair.read(path)
    path.write_text("<Renderer/>", "utf-8")
    with pytest.raises(midair.SceneError, match="no drive is in it"):
        midair.read(path)


def test_the_field_of_a_drive_from_ultraino_is_that_of_its_formula(tmp_path: Path) -> None:
    path = tmp_path / "a.xml"
    path.write_text(
        ordered([f"<int>{k}</int>" for k in range(4)], '<void property="phase"><float>0.{}</float></void>'),
        encoding="utf-8",
    )
    array = midair.Array.from_file(path)
    place = np.array([[0.013, 0.004, 0.11]])
    field = np.asarray(midair.Scene(array, place).propagation()) @ midair.read(path)
    # CalcField.java: power sinc(k a sin(theta) / 2) / r, at k r + pi phase.
    wave = 2 * np.pi * 40e3 / array.medium["sound_speed"]
    apart = place[0] - array.positions
    r = np.linalg.norm(apart, axis=1)
    u = 0.5 * 9e-3 * wave * np.hypot(apart[:, 0], apart[:, 1]) / r
    expected = (2.53 * np.sin(u) / u / r * np.exp(1j * (wave * r + 0.1 * np.pi * np.arange(4)))).sum()
    assert abs(field[0]) == pytest.approx(abs(expected), rel=0.03)


def test_a_table_may_be_in_millimetres(tmp_path: Path) -> None:
    places = midair.Array.grid(3, 3, 0.01).positions
    np.savetxt(tmp_path / "mm.csv", 1e3 * places, delimiter=",")
    np.savetxt(tmp_path / "named.csv", 1e3 * places, delimiter=",", header="x_mm,y_mm,z_mm", comments="")
    np.save(tmp_path / "mm.npy", 1e3 * places)
    (tmp_path / "mm.json").write_text(json.dumps((1e3 * places).tolist()), "utf-8")
    for name in ("mm.csv", "mm.npy", "mm.json", "named.csv"):
        assert midair.Array.from_file(tmp_path / name, unit="mm").positions == pytest.approx(places, abs=1e-15)
        scene = tmp_path / "scene.toml"
        points = 'position = [1, 2, 100]\nunit = "mm"\n'
        scene.write_text(f'[array]\npositions = {{ file = "{name}" }}\nunit = "mm"\n[[points]]\n{points}', "utf-8")
        read = midair.Scene.load(scene)
        assert read.array.positions == pytest.approx(places, abs=1e-15)
        assert read.points == pytest.approx(np.array([[1e-3, 2e-3, 0.1]]), abs=1e-15)
    assert midair.Array(1e3 * places, unit="mm").positions == pytest.approx(places, abs=1e-15)
    for wrong in (
        lambda: midair.Array(places, unit="inch"),
        lambda: midair.Array.from_file(tmp_path / "mm.csv", unit="inch"),
    ):
        with pytest.raises(midair.SceneError, match='unknown unit "inch": known are m, cm, mm, um'):
            wrong()
    with pytest.warns(midair.SceneWarning, match=r'give m \(10 mm are 0.01 m\), or unit="mm"$'):
        midair.Scene(midair.Array(1e3 * places), [[0, 0, 0.1]])
    (tmp_path / "boards.json").write_text('[{"origin": [0, 0, 0], "rotation": [1, 0, 0, 0]}]', "utf-8")
    with pytest.raises(midair.SceneError, match="the file's format states its own"):
        midair.Array.from_file(tmp_path / "boards.json", unit="mm")
