"""Notebook widget of the studio page, and the values that it exchanges with Python."""

from typing import Any

import anywidget
import traitlets


class Widget(anywidget.AnyWidget):
    """The page's values: Python writes `scene`, the page writes the others."""

    _esm = traitlets.Unicode().tag(sync=True)
    #: The core, compiled to WebAssembly.
    wasm = traitlets.Bytes().tag(sync=True)
    #: Text of a scene file as JSON. The page shows each change.
    scene = traitlets.Unicode().tag(sync=True)
    #: Scene that the page shows, with method A, as JSON, after each change; "" until the page has started.
    state = traitlets.Unicode().tag(sync=True)
    #: Methods A and B.
    methods: Any = traitlets.List().tag(sync=True)
    #: Metrics by method.
    metrics = traitlets.Dict().tag(sync=True)
