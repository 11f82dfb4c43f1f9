"""Pictures as points: positions of pixels, their targets, and rejected arguments."""

import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import midair
from scenes import small, usable


def saved(path: Path, pixels: object, mode: str = "L") -> Path:
    """Writes a picture whose rows are given from top to bottom, and returns its path."""
    Image.fromarray(np.array(pixels, np.uint8), mode=None if mode == "L" else mode).save(path)
    return path


def test_pixels_lie_on_a_grid_with_y_up_and_ask_for_their_brightness(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.png", [[255, 102, 51], [0, 0, 204]])
    picture = midair.image(path, size=0.06, z=0.15, pixels=3, pressure=2000)
    expected = {(-0.02, 0.01): 2000, (0, 0.01): 800, (0.02, 0.01): 400, (0.02, -0.01): 1600}
    found = {(round(x, 9), round(y, 9)): p for (x, y, _), p in zip(picture.points, picture.pressures, strict=True)}
    assert found == pytest.approx(expected)
    assert (picture.points[:, 2] == 0.15).all()
    assert (picture.weights == 1).all()
    assert picture.points.shape == (4, 3)


def test_dark_pixels_are_left_out_or_quiet(tmp_path: Path) -> None:
    # Pixels below 5 % of white, 12.75, are dark.
    path = saved(tmp_path / "a.png", [[255, 12, 13, 0]])
    assert midair.image(path, size=0.04, z=0.1, pixels=4).pressures == pytest.approx([1000, 1000 * 13 / 255])
    quiet = midair.image(path, size=0.04, z=0.1, pixels=4, quiet=True)
    assert quiet.pressures == pytest.approx([1000, 0, 1000 * 13 / 255, 0])
    assert quiet.points[:, 0] == pytest.approx([-0.015, -0.005, 0.005, 0.015])


def test_a_pixel_is_the_mean_over_its_square(tmp_path: Path) -> None:
    source = np.random.default_rng(3).integers(60, 256, (30, 60))
    path = saved(tmp_path / "a.png", source)
    picture = midair.image(path, size=0.06, z=0.1, pixels=6, pressure=255)
    blocks = source.reshape(3, 10, 6, 10).mean(axis=(1, 3))
    # Resampling rounds to whole grey levels along x, then along y.
    assert picture.pressures == pytest.approx(blocks.ravel(), abs=1.01)
    assert np.ptp(picture.points, axis=0) == pytest.approx([0.05, 0.02, 0])
    tall = saved(tmp_path / "b.png", source.T)
    assert midair.image(tall, size=0.06, z=0.1, pixels=6, pressure=255).pressures == pytest.approx(
        blocks.T.ravel(), abs=1.01
    )


def test_pixels_left_out_are_half_a_wavelength_apart(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.png", [[255]])
    for size, pixels in [(0.0425, 10), (0.0467, 10), (0.06, 14), (0.001, 1)]:
        picture = midair.image(path, size=size, z=0.1)
        assert len(picture.points) == pixels**2
        assert np.ptp(picture.points[:, 0]) == pytest.approx(size * (pixels - 1) / pixels)


def test_colours_transparency_sixteen_bits_and_turned_photographs(tmp_path: Path) -> None:
    rgba = [[[255, 255, 255, 255], [255, 255, 255, 128], [255, 0, 0, 255], [255, 255, 255, 0]]]
    picture = midair.image(saved(tmp_path / "a.png", rgba, "RGBA"), size=0.04, z=0.1, pixels=4, pressure=1, quiet=True)
    # Rec. 601: red is 0.299 as bright as white.
    assert picture.pressures == pytest.approx([1, 128 / 255, 0.299, 0], abs=0.004)
    deep = tmp_path / "deep.png"
    Image.fromarray(np.array([[65535, 32768]], np.uint16)).save(deep)
    assert midair.image(deep, size=0.04, z=0.1, pixels=2, pressure=1).pressures == pytest.approx([1, 0.5], abs=0.004)
    turned = tmp_path / "turned.png"
    picture_on_its_side = Image.fromarray(np.array([[255, 100]], np.uint8))
    exif = Image.Exif()
    exif[0x0112] = 6  # a viewer rotates it clockwise by a quarter turn
    picture_on_its_side.save(turned, exif=exif)
    upright = midair.image(turned, size=0.04, z=0.1, pixels=2, pressure=255)
    assert upright.points[:, :2] == pytest.approx(np.array([[0, 0.01], [0, -0.01]]))
    assert upright.pressures == pytest.approx([255, 100])


def test_a_picture_is_a_scene(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.png", [[255, 0, 128], [0, 0, 0], [64, 0, 255]])
    picture = midair.image(path, size=0.045, z=0.1, pixels=3, pressure=100)
    assert {**picture}.keys() == {"points", "pressures", "weights"}
    with pytest.raises(KeyError):
        picture["drive"]
    scene = midair.Scene(midair.Array.grid(8, 8, 0.01), **picture)
    assert (scene.points == picture.points).all()
    assert (scene.pressures == picture.pressures).all()
    solution = midair.solve(small(**picture), "greedy", balance=True)
    assert usable(solution)
    assert 0.5 < solution.metrics.accuracy < 1.5


def test_what_is_no_picture_is_refused_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = saved(tmp_path / "a.png", [[255, 0], [0, 255]])
    black = saved(tmp_path / "black.png", [[0, 12], [0, 0]])
    text = tmp_path / "text.png"
    text.write_text("no picture", "utf-8")
    cut = tmp_path / "cut.png"
    cut.write_bytes(
        saved(tmp_path / "noise.png", np.random.default_rng(1).integers(0, 256, (40, 40))).read_bytes()[:600]
    )
    real = tmp_path / "real.tiff"
    Image.fromarray(np.ones((2, 2), np.float32)).save(real)
    good = {"size": 0.1, "z": 0.1, "pixels": 2}
    for file, change, reported in [
        (path, {"size": 0}, "size is 0: give a number above 0"),
        (path, {"z": np.nan}, "z is nan: give a finite number"),
        (path, {"pixels": 0}, "pixels is 0: give a whole number of at least 1"),
        (path, {"pixels": 2.0}, "pixels is 2.0: give a whole number"),
        (path, {"pixels": 400}, "pixels is 400: more than 100000 points"),
        (path, {"pressure": -1}, "pressure is -1: give a number above 0"),
        (path, {"quiet": 1}, "quiet is 1: give true or false"),
        (black, {}, "it is dark everywhere"),
        (text, {}, "it cannot be read as a picture"),
        (cut, {}, "it cannot be read as a picture"),
        (real, {}, "its pixels are fractions"),
        (tmp_path / "none.png", {}, "there is no such file"),
        (tmp_path, {}, "there is no such file"),
        (3, {}, "path is 3: give a picture"),
    ]:
        with pytest.raises(midair.SceneError) as error:
            midair.image(file, **{**good, **change})
        assert reported in str(error.value)
        assert "\n" not in str(error.value)
    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(midair.SceneError, match=r'Pillow: pip install "midair\[shapes\]"'):
        midair.image(path, **good)
