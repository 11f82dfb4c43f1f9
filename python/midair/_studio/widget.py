"""Notebook widget of the studio page, and the values that it exchanges with Python."""

from __future__ import annotations

import anywidget
import traitlets


class Widget(anywidget.AnyWidget):
    """The page's values: Python writes `scene`, the page writes `state` and `metrics`."""

    _esm = traitlets.Unicode().tag(sync=True)
    #: The core, compiled to WebAssembly.
    wasm = traitlets.Bytes().tag(sync=True)
    #: Text of a scene file as JSON. The page shows each change.
    scene = traitlets.Unicode().tag(sync=True)
    #: The page's State (studio/src/state/types.ts) as JSON, after each change; "" until the page has started.
    state = traitlets.Unicode().tag(sync=True)
    #: Metrics by method.
    metrics = traitlets.Dict().tag(sync=True)
