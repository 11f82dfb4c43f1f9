"""Studio: the page where one touches the field, for a browser of this machine and for notebooks."""

from .view import View, view

__all__ = ["View", "view"]
