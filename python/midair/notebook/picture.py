"""Picture: a field as a small PNG inside the page; matplotlib is loaded when it is drawn."""

from __future__ import annotations

import base64
import io

from .._midair import Field

#: Width and height in inches, and pixels an inch: small enough for a table's side.
SIZE, RESOLUTION = (3.8, 3.0), 72

#: Colours of the image: enough for the map, and a third of what all of them take.
COLOURS = 128


def picture(field: Field) -> str:
    """|p| of a field in a plane, with its points, as an image of some 30 kB."""
    from matplotlib.figure import Figure
    from PIL import Image

    from ..plot.colours import colours
    from ..plot.panel import add_bar, draw

    figure = Figure(figsize=SIZE, layout="constrained")
    ax = figure.subplots()
    paint = colours([field], "pressure")
    add_bar(draw(field, ax, paint), [ax], paint)
    drawn, content = io.BytesIO(), io.BytesIO()
    figure.savefig(drawn, format="png", dpi=RESOLUTION, bbox_inches="tight", pad_inches=0.04)
    Image.open(drawn).convert("RGB").quantize(COLOURS, Image.Quantize.MAXCOVERAGE).save(
        content, "png", optimize=True
    )
    text = base64.b64encode(content.getvalue()).decode()
    return f'<img alt="|p| in the plane" src="data:image/png;base64,{text}">'
