"""Pictures as files."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

from .. import output

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def write_image(path: Path, figure: Figure) -> None:
    """Write a figure in the format of the path's ending."""
    content = io.BytesIO()
    figure.savefig(content, format=path.suffix[1:].lower(), dpi=150)
    output.write(path, content.getvalue())
