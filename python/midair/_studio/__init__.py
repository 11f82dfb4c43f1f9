"""Studio: a web page in which points can be dragged and their field is shown; for browsers and notebooks."""

from .view import View, view

__all__ = ["View", "view"]
