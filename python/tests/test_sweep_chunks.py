"""Stored results of sweeps: a damaged file is either read with the right content, or computed again."""

import io
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair
from midair._support import cache
from midair._sweep import engine, table
from midair._sweep.block import solve_block
from midair._sweep.engine import Job
from midair._sweep.request import read
from sweeps import REQUESTED, equal


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def job(number: int = 0) -> Job:
    block = read(REQUESTED, drives=True).blocks[number]
    return Job(solve_block, block.settings, 0, 5, block)


@pytest.fixture
def kept() -> tuple[Path, dict[str, np.ndarray]]:
    """Returns the path of a stored result, and its arrays."""
    whole = job()
    arrays = solve_block(whole.settings, 0, 5)
    path = Path("kept", whole.path)
    engine.save(path, arrays)
    return path, arrays


def mutations(content: bytes) -> dict[str, bytes]:
    """Returns some hundred damaged versions of a file."""
    random = np.random.default_rng(0)
    found: dict[str, bytes] = {"empty": b"", "doubled": content * 2, "longer": content + b"\0"}
    for place in random.integers(0, len(content), 200).tolist():
        bit = bytes([content[place] ^ 1 << int(random.integers(8))])
        found[f"bit of {place}"] = content[:place] + bit + content[place + 1 :]
    for place in random.integers(0, len(content), 50).tolist():
        found[f"cut at {place}"] = content[:place]
        found[f"without {place} to {place + 9}"] = content[:place] + content[place + 9 :]
        found[f"zeros from {place}"] = content[:place] + bytes(len(content) - place)
        found[f"noise at {place}"] = content[:place] + random.bytes(16) + content[place + 16 :]
    return found


def test_no_damage_passes_or_escapes(kept: tuple[Path, dict[str, np.ndarray]]) -> None:
    path, arrays = kept
    content = path.read_bytes()
    assert equal(engine.load(path, 5) or {}, arrays)
    found = mutations(content)
    assert len(found) > 300
    for name, damaged in found.items():
        path.write_bytes(damaged)
        assert damaged == content or engine.load(path, 5) is None, name
    other = path.with_name("5-10.npz")
    other.write_bytes(content)
    assert engine.load(other, 5) is None, "another job's"
    other.unlink()
    other.mkdir()
    assert engine.load(other, 5) is None, "a folder"
    path.write_bytes(content)
    assert equal(engine.load(path, 5) or {}, arrays)


class Trap:
    """An object that creates a file when it is unpickled."""

    def __reduce__(self) -> tuple[Callable[[str], None], tuple[str]]:
        return Path.touch, (Path("sprung"),)


def header(shape: str, kind: str = "<f8") -> bytes:
    """Returns the header of a .npy file, which claims more data than follows."""
    text = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}}}\n".encode()
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text


def packed(parts: dict[str, bytes], compression: int = zipfile.ZIP_STORED) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", compression) as file:
        for name, part in parts.items():
            file.writestr(name, part)
    return content.getvalue()


def saved(**arrays: Any) -> bytes:
    content = io.BytesIO()
    np.savez(content, **arrays)
    return content.getvalue()


#: Files with a correct checksum that are not results.
FORGED: dict[str, Callable[[dict[str, Any]], bytes]] = {
    "no archive": lambda arrays: b"nothing of the kind",
    "pickle": lambda arrays: saved(**{**arrays, "level": np.array([Trap()] * 5)}),
    "bomb": lambda arrays: packed({"level.npy": bytes(1 << 24)}, zipfile.ZIP_DEFLATED),
    "said to be huge": lambda arrays: packed({"level.npy": header(f"(5, {1 << 60})")}),
    "huge and of no size": lambda arrays: packed({"level.npy": header(f"(5, {1 << 60})", "|V0")}),
    "nested header": lambda arrays: packed({"level.npy": header("(" * 3000 + ")" * 3000)}),
    "plain text": lambda arrays: packed({"level": b"12345"}),
    "fewer rows": lambda arrays: saved(**{name: array[:4] for name, array in arrays.items()}),
    "no rows": lambda arrays: saved(**{**arrays, "level": np.array(1.0)}),
    "an array less": lambda arrays: saved(**{name: arrays[name] for name in arrays if name != "beyond"}),
    "an array more": lambda arrays: saved(**arrays, more=np.zeros(5)),
    "another type": lambda arrays: saved(**{**arrays, "level": arrays["level"].astype(complex)}),
    "another shape": lambda arrays: saved(**{**arrays, "drive": arrays["drive"][:, :-1]}),
    "numbers for words": lambda arrays: saved(**{**arrays, "status": np.zeros(5)}),
}


@pytest.mark.parametrize("name", FORGED)
def test_what_is_forged_is_made_anew(name: str, kept: tuple[Path, dict[str, np.ndarray]]) -> None:
    path, arrays = kept
    content = FORGED[name](arrays)
    path.write_bytes(content + cache.digest(engine.identity(path), content))
    found = engine.load(path, 5)
    assert found is None or not table.fits(job(), found)
    assert not Path("sprung").exists()


def test_a_sweep_over_damaged_chunks_ends_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = midair.sweep(REQUESTED)
    with monkeypatch.context() as patch:
        patch.setattr(engine, "remove", lambda folder: None)
        midair.sweep(REQUESTED, "table.csv")
    paths = sorted(Path().glob(".table.csv.chunks/*/*.npz"))
    assert len(paths) == 12
    content = paths[0].read_bytes()
    paths[0].write_bytes(b"PK\x03\x04 and no more")
    paths[1].write_bytes(content)
    paths[2].write_bytes(paths[2].read_bytes()[:-40])
    paths[3].unlink()
    forged = saved(level=np.zeros(5))
    paths[4].write_bytes(forged + cache.digest(engine.identity(paths[4]), forged))
    # A changed number inside an array, with a checksum that does not match.
    paths[5].write_bytes(content[:300] + b"\x01" + content[301:])
    assert equal(midair.sweep(REQUESTED, "table.csv"), whole)
    assert sorted(path.name for path in Path().iterdir()) == ["table.csv"]


def test_only_what_is_ours_is_removed() -> None:
    midair.sweep(REQUESTED, "table.csv")
    folder, own = Path(".table.csv.chunks"), job().path
    engine.save(folder / own, {"level": np.zeros(5)})
    (folder / own).with_name(".0-5.npz.4000000.part").touch()
    Path("elsewhere").mkdir()
    kept = [folder / "notes.txt", folder / own.parent / "notes.txt", Path("elsewhere", "0-5.npz")]
    for path in kept:
        path.write_text("mine", "utf-8")
    link = folder / ("0" * 20)
    link.symlink_to(Path("elsewhere").resolve(), target_is_directory=True)
    midair.sweep(REQUESTED, "table.csv")
    assert all(path.read_text("utf-8") == "mine" for path in kept)
    assert link.is_symlink()
    assert {path.name for path in folder.rglob("*")} == {"notes.txt", own.parent.name, link.name}


@pytest.mark.parametrize("kind", ["link", "file"])
def test_a_folder_of_chunks_that_is_none_is_refused(kind: str) -> None:
    Path("elsewhere").mkdir()
    Path("elsewhere", "mine.txt").touch()
    folder = Path(".table.csv.chunks")
    if kind == "link":
        folder.symlink_to("elsewhere", target_is_directory=True)
    else:
        folder.touch()
    with pytest.raises(midair.SceneError, match=r"no folder of kept results: remove it"):
        midair.sweep(REQUESTED, "table.csv")
    assert not Path("table.csv").exists()
    assert [path.name for path in Path("elsewhere").iterdir()] == ["mine.txt"]


def test_a_link_among_the_chunks_is_not_written_through() -> None:
    Path("elsewhere").mkdir()
    folder = Path(".table.csv.chunks")
    folder.mkdir()
    (folder / job().path.parent.name).symlink_to(Path("elsewhere").resolve(), target_is_directory=True)
    with pytest.raises(midair.SceneError, match="is a link"):
        midair.sweep(REQUESTED, "table.csv", drives="drives.zarr")
    assert not list(Path("elsewhere").iterdir())
