"""Bad files and requests: one line that names file, line, value and cure; nothing is left, nothing hangs."""

import gzip
import json
import time
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair
from midair._files import read_array, xml

JAVA = '<java class="java.beans.XMLDecoder">{}</java>'
BOMB = """<?xml version="1.0"?>
<!DOCTYPE a [<!ENTITY a "aaaaaaaaaa">{}]>
<java>&z;</java>""".format(
    "".join(f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdefghij", "bcdefghijz", strict=True))
)
UNIT = {"origin": [0, 0, 0], "rotation": [1, 0, 0, 0]}


def boards(**changed: Any) -> bytes:
    return json.dumps([UNIT, UNIT | changed]).encode()


def handybeam(*rows: str) -> bytes:
    inside = "".join(f"<Transducer {row}/>" for row in rows)
    return f"<A>\n<System><Transducers>{inside}</Transducers></System></A>".encode()


def zeros(count: int, wbits: int = 31) -> bytes:
    """Megabytes of packed zeros, a thousandth of their size."""
    packer = zlib.compressobj(9, wbits=wbits)
    return b"".join(packer.compress(bytes(1 << 20)) for _ in range(count)) + packer.flush()


ARRAYS: dict[str, tuple[str, Callable[[], bytes], str]] = {
    "empty": ("a.pat", bytes, "it is empty"),
    "pictures": ("a.pat", lambda: b"\x89PNG\xff\xfe", "it is no text"),
    "a pat of one line": ("a.pat", lambda: b"7", "line 2: the number of transducers are missing"),
    "no ending": ("a", lambda: b"7", "it has no known ending: give .pat .OpenMPD., .xml.gz"),
    "gzip that ends": ("a.xml.gz", lambda: gzip.compress(JAVA.encode())[:-9], "gzip data end too soon"),
    "gzip damaged": (
        "a.xml.gz",
        lambda: gzip.compress(b"a" * 999)[:10] + b"\xff" * 30,
        "gzip data are damaged",
    ),
    "gzip and more": ("a.xml.gz", lambda: gzip.compress(JAVA.encode()) + b"1", "follows its gzip data"),
    "gzip bomb": ("a.xml.gz", lambda: zeros(80), "it unpacks to more than 64 MB"),
    "XML that ends": ("a.xml", lambda: b"<java>\n<object", "line 2: it is no XML"),
    "entity bomb": ("a.xml", BOMB.encode, "line 2: a document type is declared"),
    "outer entity": (
        "a.xml",
        lambda: b'<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]>\n<java>&x;</java>',
        "a document type is declared",
    ),
    "deep": ("a.xml", lambda: b"<a>" * 5000, "elements more than 100 deep"),
    "no words": ("a.xml", lambda: b'<?xml version="1.0" encoding="klingon"?><java/>', "unknown"),
    "nothing in it": ("a.xml", lambda: JAVA.format("").encode(), "no Transducer is in it"),
    "another XML": ("a.xml", lambda: b"<svg/>", "no System/Transducers/Transducer is in it"),
    "a name unknown": ("a.xml", lambda: JAVA.format('<object idref="T"/>').encode(), '"T" is used before'),
    "a name of itself": (
        "a.xml",
        lambda: JAVA.format('<object id="T" idref="T"/>').encode(),
        "no Transducer",
    ),
    "a number of words": (
        "a.xml",
        lambda: JAVA.format("\n<float>one</float>").encode(),
        'line 2: <float> is "one"',
    ),
    "not a number": ("a.xml", lambda: JAVA.format("<double>NaN</double>").encode(), '<double> is "NaN"'),
    "no length": (
        "a.xml",
        lambda: JAVA.format(
            '<object class="x.Transducer"><void property="transform"><void property="rot">'
            '<void property="w"><float>0</float></void></void></void></object>'
        ).encode(),
        "rot is .0.0, 0.0, 0.0, 0.0.: give a quaternion",
    ),
    "power of words": (
        "a.xml",
        lambda: JAVA.format(
            '<object class="x.Transducer"><void property="power"><string>much</string></void></object>'
        ).encode(),
        "power is 'much': give a number",
    ),
    "no index": (
        "a.xml",
        lambda: handybeam('Xmm="1" Ymm="2" Zmm="0"'),
        'line 2: Index is "": give each of 0 to 0',
    ),
    "index beyond": ("a.xml", lambda: handybeam('Index="1" Xmm="1" Ymm="2" Zmm="0"'), 'Index is "1"'),
    "index twice": (
        "a.xml",
        lambda: handybeam(*['Index="1" Xmm="1" Ymm="2" Zmm="0"'] * 2),
        "Index 1 is there twice",
    ),
    "no height": ("a.xml", lambda: handybeam('Index="0" Xmm="1" Ymm="2"'), 'Zmm is "": give a finite number'),
    "JSON that ends": ("a.json", lambda: b'[{"origin": [0,\n', "line 2: it is no JSON"),
    "a deep JSON": ("a.json", lambda: b"[" * 100_000, "nest too deep|no JSON"),
    "no boards": ("a.json", lambda: b"[]", "0 boards: give 1 to 128"),
    "many boards": ("a.json", lambda: json.dumps([UNIT] * 129).encode(), "129 boards"),
    "a scene": ("a.json", lambda: b'{"array": {}}', "scene file, read it by midair.Scene.load"),
    "no origin": ("a.json", lambda: b'[{"rotation": [1, 0, 0, 0]}]', "origin of board 0 is null"),
    "flat origin": (
        "a.json",
        lambda: boards(origin=[0, 0]),
        "origin of board 1 is .0.0, 0.0.: give .x, y, z., in mm",
    ),
    "origin of words": ("a.json", lambda: boards(origin=[0, 0, "1"]), "origin of board 1"),
    "origin beyond": (
        "a.json",
        lambda: boards(origin=[0, 0, float("nan")]),
        "origin of board 1 is .0.0, 0.0, NaN.",
    ),
    "huge origin": ("a.json", lambda: b'[{"origin": [0, 0, 1e999], "rotation": [1, 0, 0, 0]}]', "Infinity"),
    "a long number": (
        "a.json",
        lambda: boards(origin=[0, 0, 10**400]),
        "origin of board 1 is .0.0, 0.0, Infinity",
    ),
    "a longer number": ("a.json", lambda: b"[" + b"1" * 9999 + b"]", "origin of board 0 is null"),
    "long rotation": (
        "a.json",
        lambda: boards(rotation=[1, 0, 0, 0.1]),
        "rotation of board 1 has length 1.00",
    ),
}


@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_that_cannot_be_read(name: str, tmp_path: Path) -> None:
    file, make, told = ARRAYS[name]
    path = tmp_path / file
    path.write_bytes(make())
    begin = time.perf_counter()
    with pytest.raises(midair.SceneError, match=told) as refused:
        read_array(path)
    assert time.perf_counter() - begin < 5
    assert str(refused.value).startswith(f'file "{path}"')
    assert "\n" not in str(refused.value)


def test_more_elements_than_an_array_has(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(xml, "MOST_ELEMENTS", 20)
    path = tmp_path / "a.xml"
    path.write_text(JAVA.format("<void/>" * 30))
    with pytest.raises(midair.SceneError, match="more than 20 elements"):
        read_array(path)


def whole_numbers(*numbers: int) -> bytes:
    return b"".join(number.to_bytes(5, "big") for number in numbers)


def holo(*numbers: int) -> bytes:
    return zlib.compress(whole_numbers(*numbers))


def archive(**arrays: Any) -> Callable[[Path], None]:
    return lambda path: np.savez(path, **arrays)


def bomb(path: Path) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file, file.open("drives.npy", "w") as stream:
        for _ in range(300):
            stream.write(bytes(1 << 20))


def bytes_of(data: bytes) -> Callable[[Path], None]:
    return lambda path: (path.write_bytes(data), None)[1]


def text(data: str) -> Callable[[Path], None]:
    return bytes_of(data.encode())


def paired(phases: str, amplitudes: str | None) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        path.write_text(phases)
        if amplitudes is not None:
            path.with_name("a0_Amp.csv").write_text(amplitudes)

    return write


PAIR = "a0_Phase.csv"
TABLE = "index,x,y,z,amplitude,phase\n"
POINTS = "t,x,y,z,intensity\n"
DRIVES: dict[str, tuple[str, Callable[[Path], None], str]] = {
    "no ending": ("a.txt", text("1"), "it has no known ending"),
    "empty": ("a.csv", text(""), "it is empty"),
    "blank": ("a.csv", text("\n\n# nothing\n"), "no row is in it"),
    "no text": ("a.csv", bytes_of(b"\xff\xfe\x00"), "it is no text"),
    "no table": ("a.csv", text("apples,pears\n"), 'line 1: "apples,pears" begins no table'),
    "numbers alone": ("a.csv", text("0.1,0.2,0.3\n"), "line 1: .* begins no table"),
    "transducers": ("a.csv", text("x,y,z\n0,0,0\n"), "read them by midair._files.read_array"),
    "a drive without drives": ("a.csv", text(TABLE), "no drive is in it"),
    "too loud": ("a.csv", text(TABLE + "0,0,0,0,1.5,0\n"), "line 2: amplitude is 1.5: give 0 to 1"),
    "less than nothing": ("a.csv", text(TABLE + "0,0,0,0,-0.5,0\n"), "line 2: amplitude is -0.5"),
    "no phase": ("a.csv", text(TABLE + "0,0,0,0,1\n"), 'line 2: phase is "": give a finite number'),
    "phase beyond": ("a.csv", text(TABLE + "0,0,0,0,1,nan\n"), 'line 2: phase is "nan"'),
    "a row left out": ("a.csv", text(TABLE + "0,0,0,0,1,1\n2,0,0,0,1,1\n"), "line 3: index is 2: give 1"),
    "column twice": ("a.csv", text("phase,amplitude,phase\n0,1,0\n"), 'column "phase" is there twice'),
    "a frame less": ("a.csv", text("3,2\n0,1\n0,1\n"), "line 3: 3 frames are told and 2 are there"),
    "a frame more": ("a.csv", text("1,2\n0,1\n0,1\n"), "line 3: 1 frames are told and more are there"),
    "a phase less": ("a.csv", text("2,2\n0,1\n0\n"), "line 3: 1 phases: give one for each of 2"),
    "a phase of words": ("a.csv", text("1,2\n0,one\n"), 'line 2: column 2 is "one"'),
    "a phase beyond": ("a.csv", text("1,2\n0,inf\n"), 'line 2: column 2 is "inf"'),
    "many frames": (
        "a.csv",
        text("900000000,900000000\n0\n"),
        "line 1: 900000000 frames of 900000000 transducers are told, more than",
    ),
    "a pair of one": (PAIR, paired("0,1\n", None), '"a0_Amp.csv", are not beside it'),
    "a pair of two sizes": (
        PAIR,
        paired("0,1\n0,1\n", "0,1\n"),
        "1 x 2 amplitudes: give as many as phases, 2 x 2",
    ),
    "rows of two sizes": (PAIR, paired("0,1\n0\n", "0,1\n"), "line 2: 1 columns: give 2"),
    "a pair too loud": (PAIR, paired("0,1\n", "0,2\n"), "amplitude 2 in frame 0, column 2: give 0 to 1"),
    "a pair of words": (PAIR, paired("0,a\n", "0,1\n"), 'line 1: column 2 is "a"'),
    "an empty pair": (PAIR, paired("#\n", "0,1\n"), "no row is in it"),
    "points alone": ("a.csv", text(POINTS), "no point is in it"),
    "bright": ("a.csv", text(POINTS + "0,0,0,0.1,2\n"), "line 2: intensity is 2: give 0 to 1"),
    "back in time": ("a.csv", text(POINTS + "1,0,0,0.1,1\n0,0,0,0.1,1\n"), "line 3: t goes back"),
    "a point less": (
        "a.csv",
        text(POINTS + "0,0,0,1,1\n0,1,0,1,1\n1,0,0,1,1\n"),
        "line 4: 1 points at t = 1",
    ),
    "a point beyond": ("a.csv", text(POINTS + "0,0,nan,1,1\n"), 'line 2: y is "nan"'),
    "no place": ("a.csv", text("t,intensity\n0,1\n"), 'there is no column "x"'),
    "not packed": ("a.holo", bytes_of(b"hello"), "zlib data are damaged"),
    "packed and cut": ("a.holo", bytes_of(holo(*[0] * 999, 63)[:-5]), "zlib data end too soon"),
    "half a number": ("a.holo", bytes_of(zlib.compress(bytes(7))), "7 bytes are in it"),
    "nothing packed": ("a.holo", bytes_of(zlib.compress(b"")), "0 bytes are in it"),
    "no end": ("a.holo", bytes_of(holo(1, 2, 3)), "no list of phases is in it"),
    "an end alone": ("a.holo", bytes_of(holo(63, 63)), "no list of phases is in it"),
    "no amplitudes": ("a.holo", bytes_of(holo(1, 2, 63)), "1 lists are in it"),
    "few amplitudes": ("a.holo", bytes_of(holo(1, 2, 63, 3, 63, 0)), "not all of 2 numbers"),
    "a large number": ("a.holo", bytes_of(holo(1, 40, 63, 1, 1, 63)), "number 1 is 40: give 0 to 32"),
    "a huge number": ("a.holo", bytes_of(holo(1, 1 << 33, 63, 1, 1, 63)), "number 1 is 8589934592"),
    "no board": ("a.bin", bytes_of(bytes(258)), 'board is left out: give board=, such as "sonicsurface"'),
    "no archive": ("a.npz", bytes_of(b"hello"), "it is damaged, or no .npz"),
    "no drive": ("a.npz", archive(pressure=np.ones(3)), "there is no drive in it"),
    "a drive of objects": ("a.npz", archive(drive=np.array([{}])), "drive is damaged, or no numbers"),
    "a drive of words": ("a.npz", archive(drive=np.array(["a"])), "drive is <U1 of shape"),
    "a flat drive": ("a.npz", archive(drives=np.ones(3)), r"drives is float64 of shape \(3,\)"),
    "drives beyond": (
        "a.npz",
        archive(drives=np.array([[0, np.nan]])),
        r"drives\[0, 1\] is nan: give finite",
    ),
    "drives too loud": ("a.npz", archive(drive=np.array([0, 2j])), r"drive\[1\] is 2j: give finite"),
    "an archive bomb": ("a.npz", bomb, "drives unpacks to more than 256 MB"),
    "a damaged solution": ("a.npz", archive(scene="{}", drive=np.ones(3)), "damaged, or none"),
    "a damaged sequence": ("a.npz", archive(setting="{}", drives=np.ones(3)), "damaged, or none"),
}


@pytest.mark.parametrize("name", DRIVES)
def test_drives_that_cannot_be_read(name: str, tmp_path: Path) -> None:
    file, make, told = DRIVES[name]
    path = tmp_path / file
    make(path)
    with pytest.raises(midair.SceneError, match=told) as refused:
        midair.read(path)
    assert "\n" not in str(refused.value)
    assert str(path.parent) in str(refused.value)


@pytest.mark.slow
def test_what_unpacks_to_more_than_a_file_may(tmp_path: Path) -> None:
    path = tmp_path / "a.holo"
    path.write_bytes(zeros(260, wbits=15))
    with pytest.raises(midair.SceneError, match="it unpacks to more than 256 MB"):
        midair.read(path)


def test_frames_that_are_not_the_boards(tmp_path: Path) -> None:
    path = tmp_path / "a.bin"
    for data, told in (
        (bytes(300), "300 bytes are no whole number of frames of 258"),
        (bytes(258), "frame 0: "),
    ):
        path.write_bytes(data)
        with pytest.raises(midair.SceneError, match=told) as refused:
            midair.read(path, board="sonicsurface")
        assert str(refused.value).startswith(f'file "{path}"')


def test_files_that_are_none(tmp_path: Path) -> None:
    for name in ("gone.npz", "gone.csv", "gone.holo", "gone.json"):
        with pytest.raises(midair.SceneError, match=r"cannot be read \(No such file"):
            midair.read(tmp_path / name)
    (tmp_path / "folder.csv").mkdir()
    for read in (midair.read, read_array):
        with pytest.raises(midair.SceneError, match="it is a folder, device or pipe"):
            read(tmp_path / "folder.csv")


FRAMES = np.ones((2, 6), np.complex64)
REQUESTS: dict[str, tuple[str, Any, dict[str, Any], str]] = {
    "ending": ("a.mat", FRAMES, {}, "has no known ending: give .npz, .csv, .json, .holo or .bin"),
    "nan": ("a.npz", FRAMES * np.nan, {}, r"drives\[0, 0\] is .*nan.*: give finite numbers"),
    "loud": ("a.holo", FRAMES * 2, {}, r"drives\[0, 0\] is .2.0.*at most 1 in modulus"),
    "codes": ("a.npz", np.ones((2, 6), int), {}, "of whole numbers, which may be codes of a board"),
    "words": ("a.npz", "drive", {}, "give a Solution, a Sequence, or complex drives"),
    "ragged": ("a.npz", [[1.0], [1.0, 2.0]], {}, "give a Solution, a Sequence, or complex drives"),
    "shape": ("a.npz", np.ones((2, 2, 2)), {}, r"drives has shape \(2, 2, 2\)"),
    "nothing": ("a.npz", np.ones(0), {}, r"drives has shape \(0,\)"),
    "frames as a table": (
        "a.csv",
        FRAMES,
        {},
        '2 frames: this .csv holds one drive, give layout="acoustools"',
    ),
    "frames as json": ("a.json", FRAMES, {}, ".json holds a Solution of a scene"),
    "layout": (
        "a.csv",
        FRAMES,
        {"layout": "matlab"},
        'layout is "matlab": give drive, acoustools, ultraino or points',
    ),
    "layout of none": ("a.holo", FRAMES, {"layout": "points"}, "a .holo file has but one, leave it out"),
    "rate": ("a.holo", FRAMES, {"rate": 10.0}, "rate is 10.0: it is of control points"),
    "modulate": ("a.csv", np.zeros((1, 3)), {"layout": "points", "modulate": -1.0}, "modulate is -1.0"),
    "points": ("a.csv", np.zeros((2, 5)), {"layout": "points"}, r"points has shape \(1, 2, 5\)"),
    "points of words": ("a.csv", "here", {"layout": "points"}, 'points is "here"'),
    "a path as drives": (
        "a.npz",
        midair.path.circle((0, 0, 0.2), 0.03, frequency=5.0),
        {},
        "drives is .*Path",
    ),
    "no board": ("a.bin", FRAMES, {}, "board is left out, and .bin holds the frames of one"),
    "another board": ("a.bin", FRAMES, {"board": "autd3"}, "drives of 6 transducers, board of 249"),
    "another array": (
        "a.bin",
        midair.Sequence(
            midair.Array.grid(16, 16, 8e-3), np.full((2, 1, 3), 0.1), 1.0, np.ones((2, 256)) + 0j, rate=9.0
        ),
        {"board": "sonicsurface"},
        "the drives' transducer 0 lies .* mm from the board's: solve for the board's array",
    ),
    "unknown board": ("a.bin", FRAMES, {"board": "stratos"}, "board is"),
    "name of a pair": (
        "a.csv",
        FRAMES,
        {"layout": "ultraino"},
        'put 0_Phase into the name, as in "a0_Phase.csv"',
    ),
}


@pytest.mark.parametrize("name", REQUESTS)
def test_what_cannot_be_written_leaves_nothing(name: str, tmp_path: Path) -> None:
    file, drives, keywords, told = REQUESTS[name]
    with pytest.raises(midair.SceneError, match=told) as refused:
        midair.write(tmp_path / file, drives, **keywords)
    assert "\n" not in str(refused.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["a.bin", "a.holo", "a.csv", "a0_Phase.csv", "a.npz"])
def test_a_write_that_is_interrupted_leaves_the_file_as_it_was(
    name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    path, taken = tmp_path / name, []

    def drive(self: midair.Sequence, frame: int) -> Any:
        taken.append(frame)
        raise KeyboardInterrupt

    path.write_bytes(b"before")
    array = midair.Board("mega64").array
    sequence = midair.Sequence(array, np.full((3, 1, 3), 0.1), 1.0, np.ones((3, 64), np.complex64), rate=10.0)
    monkeypatch.setattr(midair.Sequence, "drive", drive)
    monkeypatch.setattr(midair.Sequence, "save", lambda self, path: drive(self, 0))
    layout = "acoustools" if name == "a.csv" else None
    with pytest.raises(KeyboardInterrupt):
        midair.write(path, sequence, board="mega64", layout=layout)
    assert taken
    assert path.read_bytes() == b"before"
    assert [file.name for file in tmp_path.iterdir()] == [name]
