"""The examples: each runs without a warning, writes its picture, and is in the gallery."""

import re
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from sane import sane

ROOT = Path(__file__).parents[2]
EXAMPLES = sorted(path for path in (ROOT / "examples").iterdir() if path.suffix in {".py", ".ipynb"})


@pytest.fixture
def gallery(book: Callable[[str], ModuleType]) -> ModuleType:
    return book("gallery")


@pytest.mark.slow
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.name)
def test_it_runs_and_leaves_its_picture(
    path: Path, book: Callable[[str], ModuleType], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import matplotlib.pyplot as plt

    plt.switch_backend("Agg")
    monkeypatch.chdir(tmp_path)
    names = book("pictures.gallery").run(path)
    plt.close("all")
    assert (tmp_path / f"{path.stem}.png").stat().st_size > 5000
    sane({name: value for name, value in names.items() if not name.startswith("__")}, path.name)


def test_the_gallery_has_every_example_as_it_describes_itself(gallery: ModuleType) -> None:
    listed = [name for names in gallery.ORDER.values() for name in names]
    assert sorted(listed) == [path.name for path in EXAMPLES]
    assert gallery.PAGE.read_text("utf-8") == gallery.page(), "run `make pictures NAMES=gallery`"


def test_the_first_tutorial_as_a_notebook_is_current(gallery: ModuleType) -> None:
    notebook = gallery.LESSON.with_suffix(".ipynb").read_text("utf-8")
    assert notebook == gallery.lesson(gallery.LESSON), "run `make generated`"


def test_its_pictures_are_small() -> None:
    pictures = list((ROOT / "docs" / "gallery").iterdir())
    assert {path.stem for path in pictures} == {path.stem for path in EXAMPLES}
    assert max(path.stat().st_size for path in pictures) < 60_000


def test_the_studios_scenes_have_an_example_each() -> None:
    scenes = {path.name for path in (ROOT / "docs" / "scenes" / "gallery").iterdir()}
    used = re.findall(r"SCENES / \"(\S+)\"", "".join(path.read_text("utf-8") for path in EXAMPLES))
    assert sorted(used) == sorted(scenes)
    page = (ROOT / "studio" / "src" / "state" / "gallery.ts").read_text("utf-8")
    assert set(re.findall(r"docs/scenes/gallery/(\S+)\"", page)) == scenes
