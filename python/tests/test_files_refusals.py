"""Bad files and arguments: a message of one line names file, line, value and cure;
no file is left, nothing hangs.
"""

import gzip
import json
import time
import zipfile
import zlib
from collections.abc import Callable, Iterable
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
Kept = Callable[..., None]
UNIT = {"origin": [0, 0, 0], "rotation": [1, 0, 0, 0]}


def boards(**changed: Any) -> bytes:
    return json.dumps([UNIT, UNIT | changed]).encode()


def handybeam(*rows: str) -> bytes:
    inside = "".join(f"<Transducer {row}/>" for row in rows)
    return f"<A>\n<System><Transducers>{inside}</Transducers></System></A>".encode()


def zeros(count: int, wbits: int = 31) -> bytes:
    """Returns `count` megabytes of zeros, compressed to a thousandth of their size."""
    packer = zlib.compressobj(9, wbits=wbits)
    return b"".join(packer.compress(bytes(1 << 20)) for _ in range(count)) + packer.flush()


ARRAYS: dict[str, tuple[str, Callable[[], bytes]]] = {
    "empty": ("a.pat", bytes),
    "pictures": ("a.pat", lambda: b"\x89PNG\xff\xfe"),
    "a pat of one line": ("a.pat", lambda: b"7"),
    "no ending": ("a", lambda: b"7"),
    "gzip that ends": ("a.xml.gz", lambda: gzip.compress(JAVA.encode())[:-9]),
    "gzip damaged": ("a.xml.gz", lambda: gzip.compress(b"a" * 999)[:10] + b"\xff" * 30),
    "gzip and more": ("a.xml.gz", lambda: gzip.compress(JAVA.encode()) + b"1"),
    "gzip bomb": ("a.xml.gz", lambda: zeros(80)),
    "XML that ends": ("a.xml", lambda: b"<java>\n<object"),
    "entity bomb": ("a.xml", BOMB.encode),
    "outer entity": (
        "a.xml",
        lambda: b'<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]>\n<java>&x;</java>',
    ),
    "deep": ("a.xml", lambda: b"<a>" * 5000),
    "no words": ("a.xml", lambda: b'<?xml version="1.0" encoding="klingon"?><java/>'),
    "nothing in it": ("a.xml", lambda: JAVA.format("").encode()),
    "another XML": ("a.xml", lambda: b"<svg/>"),
    "a name unknown": ("a.xml", lambda: JAVA.format('<object idref="T"/>').encode()),
    "a name of itself": ("a.xml", lambda: JAVA.format('<object id="T" idref="T"/>').encode()),
    "a number of words": ("a.xml", lambda: JAVA.format("\n<float>one</float>").encode()),
    "not a number": ("a.xml", lambda: JAVA.format("<double>NaN</double>").encode()),
    "no length": (
        "a.xml",
        lambda: JAVA.format(
            '<object class="x.Transducer"><void property="transform"><void property="rot">'
            '<void property="w"><float>0</float></void></void></void></object>'
        ).encode(),
    ),
    "power of words": (
        "a.xml",
        lambda: JAVA.format(
            '<object class="x.Transducer"><void property="power"><string>much</string></void></object>'
        ).encode(),
    ),
    "no index": ("a.xml", lambda: handybeam('Xmm="1" Ymm="2" Zmm="0"')),
    "index beyond": ("a.xml", lambda: handybeam('Index="1" Xmm="1" Ymm="2" Zmm="0"')),
    "index twice": ("a.xml", lambda: handybeam(*['Index="1" Xmm="1" Ymm="2" Zmm="0"'] * 2)),
    "no height": ("a.xml", lambda: handybeam('Index="0" Xmm="1" Ymm="2"')),
    "JSON that ends": ("a.json", lambda: b'[{"origin": [0,\n'),
    "no boards": ("a.json", lambda: b"[]"),
    "many boards": ("a.json", lambda: json.dumps([UNIT] * 129).encode()),
    "a scene": ("a.json", lambda: b'{"array": {}}'),
    "no origin": ("a.json", lambda: b'[{"rotation": [1, 0, 0, 0]}]'),
    "flat origin": ("a.json", lambda: boards(origin=[0, 0])),
    "origin of words": ("a.json", lambda: boards(origin=[0, 0, "1"])),
    "origin beyond": ("a.json", lambda: boards(origin=[0, 0, float("nan")])),
    "huge origin": ("a.json", lambda: b'[{"origin": [0, 0, 1e999], "rotation": [1, 0, 0, 0]}]'),
    "a long number": ("a.json", lambda: boards(origin=[0, 0, 10**400])),
    "a longer number": ("a.json", lambda: b"[" + b"1" * 9999 + b"]"),
    "long rotation": ("a.json", lambda: boards(rotation=[1, 0, 0, 0.1])),
}


def bombs_apart(names: Iterable[str]) -> list[Any]:
    """Returns the names as parameters of a test;
    files that unpack to hundreds of megabytes are marked slow.
    """
    return [pytest.param(name, marks=[pytest.mark.slow] * name.endswith(" bomb")) for name in names]


@pytest.mark.parametrize("name", bombs_apart(ARRAYS))
def test_arrays_that_cannot_be_read(name: str, tmp_path: Path, kept: Kept) -> None:
    file, make = ARRAYS[name]
    path = tmp_path / file
    path.write_bytes(make())
    begin = time.perf_counter()
    with pytest.raises(midair.SceneError) as refused:
        read_array(path)
    assert time.perf_counter() - begin < 5
    kept(refused.value)


def test_a_deep_json(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(b"[" * 100_000)
    # Versions of Python differ in how many nested lists they read.
    with pytest.raises(midair.SceneError, match=r"nest(ed)? too deep|no JSON") as refused:
        read_array(path)
    assert str(path) in str(refused.value)
    assert "\n" not in str(refused.value)


def test_more_elements_than_an_array_has(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(xml, "MOST_ELEMENTS", 20)
    path = tmp_path / "a.xml"
    path.write_text(JAVA.format("<void/>" * 30), encoding="utf-8")
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
        path.write_text(phases, encoding="utf-8")
        if amplitudes is not None:
            path.with_name("a0_Amp.csv").write_text(amplitudes, "utf-8")

    return write


PAIR = "a0_Phase.csv"
TABLE = "index,x,y,z,amplitude,phase\n"
POINTS = "t,x,y,z,intensity\n"
DRIVES: dict[str, tuple[str, Callable[[Path], None]]] = {
    "no ending": ("a.txt", text("1")),
    "empty": ("a.csv", text("")),
    "blank": ("a.csv", text("\n\n# nothing\n")),
    "no text": ("a.csv", bytes_of(b"\xff\xfe\x00")),
    "no table": ("a.csv", text("apples,pears\n")),
    "numbers alone": ("a.csv", text("0.1,0.2,0.3\n")),
    "transducers": ("a.csv", text("x,y,z\n0,0,0\n")),
    "a drive without drives": ("a.csv", text(TABLE)),
    "too loud": ("a.csv", text(TABLE + "0,0,0,0,1.5,0\n")),
    "less than nothing": ("a.csv", text(TABLE + "0,0,0,0,-0.5,0\n")),
    "no phase": ("a.csv", text(TABLE + "0,0,0,0,1\n")),
    "phase beyond": ("a.csv", text(TABLE + "0,0,0,0,1,nan\n")),
    "a row left out": ("a.csv", text(TABLE + "0,0,0,0,1,1\n2,0,0,0,1,1\n")),
    "column twice": ("a.csv", text("phase,amplitude,phase\n0,1,0\n")),
    "a frame less": ("a.csv", text("3,2\n0,1\n0,1\n")),
    "a frame more": ("a.csv", text("1,2\n0,1\n0,1\n")),
    "a phase less": ("a.csv", text("2,2\n0,1\n0\n")),
    "a phase of words": ("a.csv", text("1,2\n0,one\n")),
    "a phase beyond": ("a.csv", text("1,2\n0,inf\n")),
    "many frames": ("a.csv", text("900000000,900000000\n0\n")),
    "a pair of one": (PAIR, paired("0,1\n", None)),
    "a pair of two sizes": (PAIR, paired("0,1\n0,1\n", "0,1\n")),
    "rows of two sizes": (PAIR, paired("0,1\n0\n", "0,1\n")),
    "a pair too loud": (PAIR, paired("0,1\n", "0,2\n")),
    "a pair of words": (PAIR, paired("0,a\n", "0,1\n")),
    "an empty pair": (PAIR, paired("#\n", "0,1\n")),
    "points alone": ("a.csv", text(POINTS)),
    "bright": ("a.csv", text(POINTS + "0,0,0,0.1,2\n")),
    "back in time": ("a.csv", text(POINTS + "1,0,0,0.1,1\n0,0,0,0.1,1\n")),
    "a point less": ("a.csv", text(POINTS + "0,0,0,1,1\n0,1,0,1,1\n1,0,0,1,1\n")),
    "a point beyond": ("a.csv", text(POINTS + "0,0,nan,1,1\n")),
    "no place": ("a.csv", text("t,intensity\n0,1\n")),
    "not packed": ("a.holo", bytes_of(b"hello")),
    "packed and cut": ("a.holo", bytes_of(holo(*[0] * 999, 63)[:-5])),
    "half a number": ("a.holo", bytes_of(zlib.compress(bytes(7)))),
    "nothing packed": ("a.holo", bytes_of(zlib.compress(b""))),
    "no end": ("a.holo", bytes_of(holo(1, 2, 3))),
    "an end alone": ("a.holo", bytes_of(holo(63, 63))),
    "no amplitudes": ("a.holo", bytes_of(holo(1, 2, 63))),
    "few amplitudes": ("a.holo", bytes_of(holo(1, 2, 63, 3, 63, 0))),
    "a large number": ("a.holo", bytes_of(holo(1, 40, 63, 1, 1, 63))),
    "a huge number": ("a.holo", bytes_of(holo(1, 1 << 33, 63, 1, 1, 63))),
    "no board": ("a.bin", bytes_of(bytes(258))),
    "no archive": ("a.npz", bytes_of(b"hello")),
    "no drive": ("a.npz", archive(pressure=np.ones(3))),
    "a drive of objects": ("a.npz", archive(drive=np.array([{}]))),
    "a drive of words": ("a.npz", archive(drive=np.array(["a"]))),
    "a flat drive": ("a.npz", archive(drives=np.ones(3))),
    "drives beyond": ("a.npz", archive(drives=np.array([[0, np.nan]]))),
    "drives too loud": ("a.npz", archive(drive=np.array([0, 2j]))),
    "an archive bomb": ("a.npz", bomb),
    "a damaged solution": ("a.npz", archive(scene="{}", drive=np.ones(3))),
    "a damaged sequence": ("a.npz", archive(setting="{}", drives=np.ones(3))),
}


@pytest.mark.parametrize("name", bombs_apart(DRIVES))
def test_drives_that_cannot_be_read(name: str, tmp_path: Path, kept: Kept) -> None:
    file, make = DRIVES[name]
    make(tmp_path / file)
    with pytest.raises(midair.SceneError) as refused:
        midair.read(tmp_path / file)
    kept(refused.value)


@pytest.mark.slow
def test_what_unpacks_to_more_than_a_file_may(tmp_path: Path) -> None:
    path = tmp_path / "a.holo"
    path.write_bytes(zeros(260, wbits=15))
    with pytest.raises(midair.SceneError, match="it unpacks to more than 256 MB"):
        midair.read(path)


def test_frames_that_are_not_the_boards(tmp_path: Path) -> None:
    path = tmp_path / "a.bin"
    for data, reported in (
        (bytes(300), "300 bytes are no whole number of frames of 258"),
        (bytes(258), "frame 0: "),
    ):
        path.write_bytes(data)
        with pytest.raises(midair.SceneError, match=reported) as refused:
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
REQUESTS: dict[str, tuple[str, Any, dict[str, Any]]] = {
    "ending": ("a.mat", FRAMES, {}),
    "nan": ("a.npz", FRAMES * np.nan, {}),
    "loud": ("a.holo", FRAMES * 2, {}),
    "codes": ("a.npz", np.ones((2, 6), int), {}),
    "words": ("a.npz", "drive", {}),
    "ragged": ("a.npz", [[1.0], [1.0, 2.0]], {}),
    "shape": ("a.npz", np.ones((2, 2, 2)), {}),
    "nothing": ("a.npz", np.ones(0), {}),
    "frames as json": ("a.json", FRAMES, {}),
    "layout": ("a.csv", FRAMES, {"layout": "matlab"}),
    "layout of none": ("a.holo", FRAMES, {"layout": "points"}),
    "rate": ("a.holo", FRAMES, {"rate": 10.0}),
    "modulate": ("a.csv", np.zeros((1, 3)), {"layout": "points", "modulate": -1.0}),
    "points": ("a.csv", np.zeros((2, 5)), {"layout": "points"}),
    "points of words": ("a.csv", "here", {"layout": "points"}),
    "a path as drives": ("a.npz", midair.path.circle((0, 0, 0.2), 0.03, frequency=5.0), {}),
    "no board": ("a.bin", FRAMES, {}),
    "another board": ("a.bin", FRAMES, {"board": "autd3"}),
    "another array": (
        "a.bin",
        midair.Sequence(
            midair.Array.grid(16, 16, 8e-3), np.full((2, 1, 3), 0.1), 1.0, np.ones((2, 256)) + 0j, rate=9.0
        ),
        {"board": "sonicsurface"},
    ),
    "unknown board": ("a.bin", FRAMES, {"board": "stratos"}),
    "name of a pair": ("a.csv", FRAMES, {"layout": "ultraino"}),
}


@pytest.mark.parametrize("name", REQUESTS)
def test_what_cannot_be_written_leaves_nothing(name: str, tmp_path: Path, kept: Kept) -> None:
    file, drives, keywords = REQUESTS[name]
    with pytest.raises(midair.SceneError) as refused:
        midair.write(tmp_path / file, drives, **keywords)
    kept(refused.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.filterwarnings("ignore:AcousTools has boards of 256 transducers")
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


def test_an_error_contains_no_character_that_turns_its_letters_around() -> None:
    text = '[array]\npreset="paper20"\n[[points]]\nposition=[0,0,0.2]\n"\u202ex\u2066"=1\n'
    with pytest.raises(midair.SceneError, match='unknown key of points\\[0\\] "x": known are'):
        midair.Scene.parse(text)
