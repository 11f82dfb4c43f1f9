"""Widget: the page in a notebook, and its messages to and from Python."""

from __future__ import annotations

import anywidget
import traitlets


class Widget(anywidget.AnyWidget):
    """The page's traits: Python writes `scene`, the page writes `state` and `metrics`."""

    _esm = traitlets.Unicode().tag(sync=True)
    #: The core, built for WebAssembly.
    wasm = traitlets.Bytes().tag(sync=True)
    #: A scene file as JSON text; each change is shown.
    scene = traitlets.Unicode().tag(sync=True)
    #: The page's State (studio/src/types.ts) as JSON text, after each change; "" before the page is up.
    state = traitlets.Unicode().tag(sync=True)
    #: Metrics by method.
    metrics = traitlets.Dict().tag(sync=True)
