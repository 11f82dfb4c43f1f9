"""Tables of transducers and points, as NumPy, MATLAB, pandas, Excel and hands write them."""

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import midair

PLACES = np.array([[0.01, 0.02, 0.0], [0.02, 0.02, 0.0]])
SCENE = '[array]\npositions = {{ file = "{}" }}\n[[points]]\nposition = [0, 0, 0.1]\n'


def saved(function: Any, *arguments: Any, **keywords: Any) -> bytes:
    stream = io.BytesIO()
    function(stream, *arguments, **keywords)
    return stream.getvalue()


def matlab(**names: Any) -> bytes:
    loadmat = pytest.importorskip("scipy.io")
    return saved(loadmat.savemat, names)


TABLES = {
    "savetxt": ("a.csv", saved(np.savetxt, PLACES, fmt="%.2e")),
    "savetxt with a header": ("a.txt", saved(np.savetxt, PLACES, header="x y z")),
    "units in brackets": ("a.csv", b"x (m),y (m),z (m)\n0.01,0.02,0\n0.02,0.02,0\n"),
    "millimetres": ("a.csv", b"x [mm];y [mm];z [mm]\n10;20;0\n20;20;0\n"),
    "millimetres in another order": ("a.csv", b"z_mm,y_mm,x_mm\n0,20,10\n0,20,20\n"),
    "mixed units": ("a.csv", b"x in cm,y/mm,z\n1,20,0\n2,20,0\n"),
    "units between spaces": ("a.txt", b"x (mm)  y (mm)  z (mm)\n10 20 0\n20 20 0\n"),
    "decimal commas": ("a.csv", b"x;y;z\n0,01;0,02;0\n0,02;0,02;0\n"),
    "decimal commas of a semicolon at the end": ("a.csv", b"0,01;0,02;0;\r\n0,02;0,02;0;\r\n;;;\r\n"),
    "decimal commas between tabs": ("a.tsv", b"0,01\t0,02\t0,0\n0,02\t0,02\t0,0\n"),
    "decimal commas between spaces": ("a.dat", b"0,01 0,02 0,00\n0,02 0,02 0,00\n"),
    "commas and spaces": ("a.csv", b"0.01, 0.02, 0\n 0.02 , 0.02 , 0\n"),
    "spaces before commas": ("a.csv", b"x (mm) ,y (mm) ,z (mm)\n10 ,20 ,0\n20 ,20 ,0\n"),
    "commas at the end": ("a.csv", b"0.01,0.02,0,\n0.02,0.02,0,,\n"),
    "comments of MATLAB": ("a.txt", b"% x y z\n// m\n  0.01  0.02  0\n  0.02  0.02  0\n"),
    "a line of Excel that names the separator": (
        "a.csv",
        b"sep=;\r\nx;y;z\r\n0,01;0,02;0\r\n0,02;0,02;0\r\n",
    ),
    "text in Unicode of Excel": (
        "a.txt",
        "\ufeffx\ty\tz\r\n0,01\t0,02\t0\r\n0,02\t0,02\t0\r\n".encode("utf-16-le"),
    ),
    "UTF-16 of a Mac": ("a.csv", "\ufeffx,y,z\n0.01,0.02,0\n0.02,0.02,0".encode("utf-16-be")),
    "errors beside the places": ("a.csv", b"x,x_error,y,y_error,z\n0.01,1,0.02,1,0\n0.02,1,0.02,1,0\n"),
    "records of pandas": (
        "a.json",
        b'[{"name":"A","x":0.01,"y":0.02,"z":0},{"name":"B","z":0,"y":0.02,"x":0.02}]',
    ),
    "records with units": ("a.json", b'[{"x_mm":10,"y_mm":20,"z_mm":0},{"x_mm":20,"y_mm":20,"z_mm":0}]'),
    "an index of pandas": ("a.csv", b",x,y,z\n0,0.01,0.02,0\n1,0.02,0.02,0\n"),
    "a JSON list": ("a.json", json.dumps(PLACES.tolist()).encode()),
    "a JSON list of whole numbers": ("a.json", b" [ [0.01, 0.02, 0],\n[0.02, 0.02, 0] ]"),
    "npy": ("a.npy", saved(np.save, PLACES)),
    "npy in another order": ("a.npy", saved(np.save, np.asfortranarray(PLACES.astype(">f4")))),
    "npz": ("a.npz", saved(np.savez, PLACES)),
    "npz of names": ("a.npz", saved(np.savez, positions=PLACES, other=np.zeros(3))),
    "npz of coordinates": ("a.npz", saved(np.savez, x=PLACES[:, 0], y=PLACES[:, 1], z=PLACES[:, 2])),
    "mat": ("a.mat", matlab(p=PLACES)),
    "mat of coordinates": ("a.mat", matlab(x=PLACES[:, :1], y=PLACES[:, 1:2], z=PLACES[:, 2:])),
}


@pytest.mark.parametrize("name", TABLES)
def test_a_table_has_the_places_that_it_states(name: str, tmp_path: Path) -> None:
    file, data = TABLES[name]
    (tmp_path / file).write_bytes(data)
    array = midair.Array.from_file(tmp_path / file)
    assert array.positions == pytest.approx(PLACES, abs=1e-9)
    if name == "npy in another order":
        # The core reads .npy in C order alone, and says how to save it.
        with pytest.raises(midair.SceneError, match=r"of another type or order: save numpy\.ascontiguousarray"):
            midair.Scene.parse(SCENE.format(file), folder=tmp_path)
        return
    again = midair.Scene.parse(SCENE.format(file), folder=tmp_path).array
    assert np.array_equal(again.positions, array.positions)


WRONG = {
    "a unit": (
        "a.csv",
        b"x (ft),y (ft),z (ft)\n1,2,3\n",
        r'line 1: column is "x\(ft\)", whose unit is unknown: give m, cm',
    ),
    "a unit behind a line": (
        "a.csv",
        b"x_ft,y_ft,z_ft\n1,2,3\n",
        'column is "x_ft", whose unit is unknown: give m',
    ),
    "row names of R": ("a.txt", b"x y z\n1 0.01 0.02 0\n", "line 2: 4 cells under 3 names: name each column"),
    "a record without x": ("a.json", b'[{"x":1,"y":2,"z":3},{"y":2,"z":3}]', "x of row 1 is no number"),
    "complex npy": ("a.npy", saved(np.save, 1j * PLACES), "its numbers are complex: give real numbers in m"),
    "a word": ("a.csv", b"0.01 0.02 0\n0.02 oops 0\n", 'line 2: y is "oops": give a number'),
    "two columns": ("a.csv", b"0.01 0.02\n", "line 1: 2 columns: give x,y,z"),
    "thousands": ("a.csv", b"1.000,5;0;0\n", "line 1: columns are 1.000,5"),
    "a hole": ("a.csv", b"0.01,,0\n", 'line 1: y is "": give a number'),
    "a JSON row": ("a.json", b"[[0.01, 0.02, 0], [1, 2]]", "row 1 is"),
    "a JSON word": ("a.json", b'[[0.01, 0.02, "a"]]', "no list of rows of numbers"),
    "a flat list": ("a.json", b"[0.01, 0.02, 0]", "no list of rows"),
    "a transposed array": ("a.npy", saved(np.save, np.zeros((3, 8))), "8 columns: give x,y,z"),
    "words in npy": ("a.npy", saved(np.save, np.array([["a"]])), "its numbers cannot be read"),
    "two arrays": ("a.npz", saved(np.savez, a=PLACES, b=PLACES), "its arrays are a, b: give one array"),
    "no mat": ("a.mat", b"nothing at all", "a.mat"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_table_that_is_not_plain_is_refused_with_its_reason(name: str, tmp_path: Path) -> None:
    file, data, reported = WRONG[name]
    (tmp_path / file).write_bytes(data)
    with pytest.raises(midair.SceneError, match=reported) as error:
        midair.Array.from_file(tmp_path / file)
    assert "\n" not in str(error.value)


POINTS = {
    "no header": (b"0.01,0,0.1\n0.02,0,0.1\n", [7.0, 7.0], [1.0, 1.0]),
    "pressures without a header": (b"0.01 0 0.1 500\n0.02 0 0.1 600\n", [500.0, 600.0], [1.0, 1.0]),
    "a header": (
        b"weight;pressure (kPa);x_mm;y_mm;z_mm\n2;0,5;10;0;100\n3;0,6;20;0;100\n",
        [500.0, 600.0],
        [2.0, 3.0],
    ),
}


@pytest.mark.parametrize("name", POINTS)
def test_points_of_a_scene_file_come_from_a_table(name: str, tmp_path: Path) -> None:
    data, pressures, weights = POINTS[name]
    (tmp_path / "path.csv").write_bytes(data)
    text = '[array]\npreset = "paper20"\n[[points]]\nposition = [0, 0, 0.1]\npressure = 1.0\n'
    text += '[[points]]\nfile = "path.csv"\npressure = 7.0\n'
    scene = midair.Scene.parse(text, folder=tmp_path)
    assert scene.points == pytest.approx(np.array([[0, 0, 0.1], [0.01, 0, 0.1], [0.02, 0, 0.1]]))
    assert np.asarray(scene.pressures).tolist() == pytest.approx([1.0, *pressures])
    given = [1.0, 1.0, 1.0] if scene.weights is None else np.asarray(scene.weights).tolist()
    assert given == pytest.approx([1.0, *weights])
    with pytest.raises(midair.SceneError, match="a position is given, too"):
        midair.Scene.parse(text + "position = [0, 0, 0.1]\n", folder=tmp_path)
    with pytest.raises(midair.SceneError, match="no folder to find files in"):
        midair.Scene.parse(text)


@pytest.mark.parametrize(
    ("name", "data", "reported"),
    [
        (
            "a.csv",
            b"0,0.01,0.02,0.1\n1,0.02,0.02,0.1\n",
            "a table whose first column counts the rows: name the columns",
        ),
        (
            "a.csv",
            b"1 0.01 0.02 0.1 500\n2 0.02 0.02 0.1 500\n",
            "a table whose first column counts the rows",
        ),
        ("a.npy", saved(np.save, np.c_[np.arange(2), PLACES]), "a table whose first column counts the rows"),
        (
            "a.csv",
            b"x,y,z,pressure_dB\n0,0,0.1,160\n",
            'column is "pressure_dB", whose unit is unknown: give pa, kpa',
        ),
        ("a.csv", b"x,y,z,phase (turns)\n0,0,0.1,1\n", 'column is "phase\\(turns\\)", whose unit is unknown'),
        ("a.npy", saved(np.save, 1j * PLACES), "its numbers are of another type or order"),
    ],
)
def test_a_table_of_points_that_means_something_else_is_refused(
    name: str, data: bytes, reported: str, tmp_path: Path
) -> None:
    (tmp_path / name).write_bytes(data)
    text = f'[array]\npreset = "paper20"\n[[points]]\nfile = "{name}"\n'
    for unit in ("", 'unit = "mm"\n'):
        with pytest.raises(midair.SceneError, match=reported):
            midair.Scene.parse(text + unit, folder=tmp_path)


def test_a_scene_file_names_an_array_of_another_program(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text(json.dumps([{"origin": [0, 0, 0], "rotation": [1, 0, 0, 0]}]), encoding="utf-8")
    scene = midair.Scene.parse(SCENE.format("a.json"), folder=tmp_path)
    assert len(scene.array) == 249
    assert scene.array == midair.Array.from_file(tmp_path / "a.json")
    assert scene.sound_speed == pytest.approx(midair.Array.preset("autd3").medium["sound_speed"])


@pytest.mark.parametrize(
    "data",
    [
        b"% a drive\namplitude;phase (deg)\n1;90\n0,5;0\n",
        b"sep=;\r\nAmplitude;Phase_rad\r\n1;1,5707963\r\n0,5;0\r\n",
        "\ufeffindex\tamplitude\tphase [rad]\r\n0\t1\t1,5707963\r\n1\t0,5\t0\r\n".encode("utf-16-le"),
        b"amplitude phase\n1 1.5707963\n0.5 0\n",
    ],
)
def test_a_drive_is_read_by_the_rules_of_tables(data: bytes, tmp_path: Path) -> None:
    (tmp_path / "drive.csv").write_bytes(data)
    assert midair.read(tmp_path / "drive.csv") == pytest.approx([1j, 0.5], abs=1e-6)


def test_places_are_no_drive(tmp_path: Path) -> None:
    for data in (b"x (mm),y (mm),z (mm)\n1,2,3\n", b"0.1,0.2,0.3\n"):
        (tmp_path / "a.csv").write_bytes(data)
        with pytest.raises(midair.SceneError, match="it holds transducers: read them by"):
            midair.read(tmp_path / "a.csv")
