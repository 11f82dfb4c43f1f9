"""A replacement for the studio's built page, of a few bytes, and a scene that the page sends to Python."""

from pathlib import Path

import midair

FILES = {
    "index.html": b"<!doctype html><title>midair</title>",
    "assets/index-1.js": b"export {};",
    "assets/index-1.css": b"body{}",
    "midair.wasm": b"\0asm\1\0\0\0",
    "widget.mjs": b"export default { render() {} };",
}

#: A scene as the page sends it to Python (`sceneOf` of studio/src/state/scene_file.ts).
SHOWN = {
    "medium": {"temperature": 25},
    "array": {"preset": "autd3", "tiles": [2, 2]},
    "points": [{"position": [0.01, 0, 0.18]}, {"position": [-0.02, 0.03, 0.15]}],
    "solver": {"name": "uniform"},
    "plane": {"z": 0.18, "size": 0.18, "center": [0, 0]},
}


def autd3(**scene) -> midair.Scene:
    return midair.Scene(midair.Array.preset("autd3"), scene.pop("points", [[0, 0, 0.15]]), **scene)


def build(folder: Path) -> Path:
    """Writes the files of a page into a folder."""
    for name, content in FILES.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return folder
