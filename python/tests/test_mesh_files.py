"""Files of 3D models as people have them: rounded corners, copies of faces, bytes behind, other axes."""

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair

trimesh = pytest.importorskip("trimesh")

SIDES = np.array([0.01, 0.02, 0.03])


def box(ending: str, **keywords: Any) -> bytes:
    data = trimesh.creation.box(SIDES).export(file_type=ending, **keywords)
    return data if isinstance(data, bytes) else data.encode()


def read(folder: Path, name: str, data: bytes, **keywords: Any) -> midair.Mesh:
    (folder / name).write_bytes(data)
    return midair.Mesh.from_file(folder / name, **keywords)


FORMATS = {
    "stl": ("stl", {}),
    "text stl": ("stl_ascii", {}),
    "obj": ("obj", {}),
    "off": ("off", {}),
    "text ply": ("ply", {"encoding": "ascii"}),
    "glb": ("glb", {}),
}


@pytest.mark.parametrize("behind", [b"\0" * 7, b"\n# hello\n", b"\xff\xfe\x01junk\n"])
@pytest.mark.parametrize("name", FORMATS)
def test_bytes_behind_the_last_face_are_ignored(name: str, behind: bytes, tmp_path: Path) -> None:
    ending, keywords = FORMATS[name]
    mesh = read(tmp_path, f"a.{ending.split('_')[0]}", box(ending, **keywords) + behind)
    assert len(mesh.faces) == 12
    assert mesh.volume == pytest.approx(SIDES.prod(), rel=1e-6)


@pytest.mark.parametrize("size", [1e-7, 1e-6, 1e-5])
@pytest.mark.parametrize("ending", ["stl", "obj"])
def test_corners_that_differ_by_rounding_are_joined(ending: str, size: float, tmp_path: Path) -> None:
    ball = trimesh.creation.icosphere(2, 0.02)
    random = np.random.default_rng(1)
    corners = ball.vertices[ball.faces] + random.uniform(-1, 1, (len(ball.faces), 3, 3)) * 0.02 * size
    soup = trimesh.Trimesh(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3), process=False)
    data = soup.export(file_type=ending, **({"digits": 12} if ending == "obj" else {}))
    mesh = read(tmp_path, f"a.{ending}", data if isinstance(data, bytes) else data.encode())
    assert len(mesh.faces) == len(ball.faces)
    assert mesh.volume == pytest.approx(ball.volume, rel=1e-4)


def test_copies_of_faces_are_left_out_with_a_note(tmp_path: Path) -> None:
    model = trimesh.creation.box(SIDES)
    faces = np.concatenate([model.faces, model.faces[[3, 7]], np.roll(model.faces[:1], 1, axis=1)])
    data = trimesh.Trimesh(model.vertices, faces, process=False).export(file_type="obj")
    with pytest.warns(midair.SceneWarning, match=r'a\.obj": 3 copies of faces are left out'):
        mesh = read(tmp_path, "a.obj", data.encode())
    assert mesh.volume == pytest.approx(SIDES.prod())


def extent(mesh: midair.Mesh) -> Any:
    return np.ptp(mesh.vertices, axis=0)


def test_gltf_has_y_up_and_any_file_may_be_turned(tmp_path: Path) -> None:
    upright = Path(__file__).with_name("upright_box.glb")
    assert extent(midair.Mesh.from_file(upright)) == pytest.approx([0.01, 0.01, 0.03])
    assert extent(midair.Mesh.from_file(upright, up="z")) == pytest.approx([0.01, 0.03, 0.01])
    for up, order in (("x", [1, 2, 0]), ("y", [0, 2, 1]), ("z", [0, 1, 2])):
        mesh = read(tmp_path, "a.stl", box("stl"), up=up)
        assert extent(mesh) == pytest.approx(SIDES[order])
        assert mesh.volume > 0
    for wrong, shown in ((["y"], r"\['y'\]"), (3, "3"), ("w", '"w"')):
        with pytest.raises(midair.SceneError, match=f'up is {shown}: give "x", "y" or "z"'):
            midair.Mesh.from_file(upright, up=wrong)  # type: ignore[arg-type]
    # y becomes z, and z becomes -y.
    data = trimesh.creation.box(SIDES).apply_translation([0, 0.1, 0.2]).export(file_type="stl")
    middle = read(tmp_path, "a.stl", data, up="y").vertices.mean(axis=0)
    assert middle == pytest.approx([0, -0.2, 0.1])
    with pytest.raises(midair.SceneError, match='up is "w": give "x", "y" or "z"'):
        read(tmp_path, "a.stl", box("stl"), up="w")


def test_a_rotation_is_an_axis_a_quaternion_or_a_matrix(tmp_path: Path) -> None:
    angle = np.pi / 3
    axis = np.array([1.0, 2.0, -2.0]) / 3
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    # Rodrigues' formula.
    matrix = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    plain = read(tmp_path, "a.stl", box("stl"), scale=2.0).vertices
    expected = plain @ matrix.T + [0, 0, 0.1]
    quaternion = [np.cos(angle / 2), *np.sin(angle / 2) * axis]
    for rotation in (angle * axis, 3 * np.array(quaternion), matrix):
        mesh = midair.Mesh.from_file(tmp_path / "a.stl", scale=2.0, rotation=rotation, offset=[0, 0, 0.1])
        assert mesh.vertices == pytest.approx(expected, abs=1e-12)
    for wrong, cure in (
        ([0, 0, 0, 0], "give a quaternion of length 1"),
        (np.diag([1, 1, -1]), "give orthonormal rows of determinant 1"),
        (2 * np.eye(3), "give orthonormal rows of determinant 1"),
        ([1, 2], "axis times angle in rad"),
    ):
        with pytest.raises(midair.SceneError, match=f"^rotation is .*{cure}"):
            midair.Mesh.from_file(tmp_path / "a.stl", rotation=wrong)
    text = """
    [array]
    preset = "paper20"
    [[points]]
    position = [0, 0, 0.2]
    [[obstacles]]
    file = "a.stl"
    up = "x"
    rotation = [1.5707963267948966, 0, 0]
    offset = [0.0, 0.1, 0.1]
    """
    mesh = midair.Scene.parse(text, folder=tmp_path).obstacles[0]
    assert extent(mesh) == pytest.approx(SIDES[[1, 0, 2]], abs=1e-9)
    assert mesh.vertices.mean(axis=0) == pytest.approx([0, 0.1, 0.1])


def test_a_sheet_is_told_what_to_use_instead(tmp_path: Path) -> None:
    sheet = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]], process=False)
    stream = io.BytesIO()
    sheet.export(stream, file_type="stl")
    with pytest.raises(midair.SceneError, match="for a sheet give a thin box, or a wall if it is large"):
        read(tmp_path, "a.stl", stream.getvalue())
