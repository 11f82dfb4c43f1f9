"""SVG drawings as points: what a browser shows is sampled, then transformed (svgelements reads shapes)."""

import re
from collections import Counter
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, fromstring

import numpy as np
from numpy.typing import NDArray

from .._midair import MOST_POINTS, STEP, SceneError, stated
from .._support.arguments import existing, needs, number, refused, shown, warn
from .._support.text import content
from ._figures import Contour, Points, box, placed, points_along, ways

#: Limits with which a drawing is read within seconds. References count as copies of what they name.
MOST_DEPTH = 100
MOST_LETTERS = 4 << 20
MOST_TRANSFORM = 2000
MOST_STYLE = 16_000

#: Attributes that may be long; attributes that are ignored, such as embedded pictures.
LONG, PASSED = ("d", "points"), ("href", "{http://www.w3.org/1999/xlink}href")

#: Shapes and their classes in svgelements.
SHAPES = {name: name.title() for name in ("path", "rect", "circle", "ellipse", "polyline", "polygon")}
SHAPES |= {"line": "SimpleLine"}

#: Lengths of shapes; percentages are of the width (0), the height (1) or the diagonal (2) of the viewport.
LENGTHS = dict.fromkeys(("x", "width", "cx", "rx", "x1", "x2"), 0)
LENGTHS |= dict.fromkeys(("y", "height", "cy", "ry", "y1", "y2"), 1) | {"r": 2}

#: Elements that a browser shows and that have no outline here. All other elements are shown by no browser.
UNDRAWN = ("text", "image", "foreignObject")

#: Properties that children inherit, with their initial values.
INHERITED = {"visibility": "visible", "fill": "black", "stroke": "none"}
INHERITED |= dict.fromkeys(("fill-opacity", "stroke-opacity", "stroke-width"), "1")

#: Paints and sizes of which nothing is seen.
CLEAR = re.compile(r"none|transparent|(rgb|hsl)a?\((([^,]*,){3}|.*/)\s*0*\.?0*%?\s*\)|#([\da-f]{3}|[\da-f]{6}0)0")
NOTHING = re.compile(r"(?=[0.])0*\.?0*(px|%)?")

#: Rules of style sheets for some devices, fonts and the like.
AT_RULE = re.compile(r"@[^{};]*(;|\{([^{}]*\{[^{}]*\})*[^{}]*\})")

#: Functions of a transform that are read; lengths in them.
FUNCTIONS = {"matrix", "rotate", "translate", "translatex", "translatey", "scale", "scalex", "scaley"}
FUNCTIONS |= {"skewx", "skewy"}
LENGTH = re.compile(r"[-+.\de]+(px|mm|cm|in|pt|pc|q)\b", re.IGNORECASE)

#: Properties that change what is seen. The others, such as widths and filters, have no effect.
OBEYED = (*INHERITED, "display", "opacity", "transform", "transform-origin")

SIZES = ("width", "height")
PIXELS_PER_INCH = 96.0

Matrix = NDArray[np.float64]


def svg(path: str | PathLike[str], *, size: float, z: float, step: float = STEP) -> Points:
    """Return points on the paths and basic shapes of an SVG drawing, its middle at (0, 0, z), y up.

    Parameters
    ----------
    path : str or path
        A file, or text that begins with "<".
    size : float
        Longer side of the drawing, in m.
    z : float
        Height of its plane in m.
    step : float, optional
        Distance between neighbours in m.

    Returns
    -------
    (M, 3) ndarray
        Points in m.

    Raises
    ------
    SceneError
        For a missing file or one that draws nothing, sizes not above 0, and for more than 100000 points.

    Notes
    -----
    It draws the outlines of what a browser shows, without clips, masks, markers, pictures and text; a warning
    names these, and outlines outside of the page. Colours and widths have no effect, except that a shape
    without fill and stroke is left out.

    Examples
    --------
    >>> import midair
    >>> drawing = '<svg xmlns="http://www.w3.org/2000/svg"><circle r="5"/></svg>'
    >>> midair.shape.svg(drawing, size=0.04, z=0.15).shape
    (59, 3)
    """
    return points_along(outlines("shape.svg", path, size, z), number("step", step))


def outlines(caller: str, path: str | PathLike[str], size: float, z: float) -> list[Contour]:
    """Return the contours in m of an SVG file or text; errors name the function `caller`."""
    size, z = number("size", size, above=0), number("z", z)
    written = isinstance(path, str) and path.lstrip().startswith("<")
    name = Path("SVG text") if written else existing("path", path, "give an SVG file")
    with needs(f"{caller} needs svgelements", "shapes"):
        import svgelements
    try:
        source = str(path).encode() if written else content(name, empty=True)
        drawing = _Drawing(svgelements, name, fromstring(source))
        found = list(drawing.contours())
    except SceneError:
        raise
    # The parser raises errors of many kinds for a damaged file.
    except Exception as error:
        raise refused("path", name, "it cannot be read as SVG, give another file") from error
    without = ", ".join(f"{count} {thing}" for thing, count in drawing.without.items())
    if not found:
        only = f" (only {without})" if without else ""
        raise refused("path", name, f"nothing is drawn in it{only}, give one with paths or basic shapes")
    if without:
        warn(f"{caller} draws {name} without {without}: convert them to paths, or remove them")
    least, most = box(found)
    longer = float((most - least).max())
    if not 0 < longer < np.inf:
        raise refused("path", name, f"what it draws is {shown(longer)} large, give another file")
    scale = size / longer
    return placed(found, (scale, -scale), z)


def one_outline(path: str | PathLike[str], size: float, z: float) -> Contour:
    """Return the contour in m of an SVG file or text, which a point walks; rejects several contours."""
    contours = outlines("path.svg", path, size, z)
    if len(contours) > 1:
        cure = "leave one in each drawing, and put paths together by & or .then(..., fade=)"
        raise stated("the drawing", f"has {len(contours)} outlines, of which a point walks one", cure)
    return contours[0]


class _Drawing:
    """A drawing as a browser shows it. `without` counts what is shown there and not drawn here."""

    def __init__(self, svgelements: Any, file: Path, root: Element) -> None:
        self.without: Counter[str] = Counter()
        self._svgelements, self._file, self._root = svgelements, file, root
        self._elements = self._letters = self._segments = 0
        # Of several elements with one name, browsers take the first.
        self._named = {element.get("id", ""): element for element in reversed(list(root.iter()))}
        sheet = "".join(element.text or "" for element in root.iter() if _tag(element) == "style")
        if len(sheet) > MOST_STYLE:
            raise self._wrong(f"it has style sheets of more than {MOST_STYLE} letters")
        self._page = np.full(2, np.inf)
        self._rules = self._sheet(re.sub(r"/\*.*?\*/", "", sheet, flags=re.DOTALL))

    def contours(self) -> Iterator[Contour]:
        """Yield the contours in the drawing's units, y down."""
        if _tag(self._root) == "svg":
            # All elements are counted before the first one is sampled.
            for shape in list(self._shapes(self._root, np.eye(3), INHERITED, np.zeros(2), (), {})):
                for vertices, closed in self._sampled(*shape):
                    if ((vertices < 0).all(axis=0) | (vertices > self._page).all(axis=0)).any():
                        self.without["outline outside of the page"] += 1
                    else:
                        yield vertices, closed

    def _wrong(self, what: str) -> SceneError:
        return refused("path", self._file, f"{what}, simplify it")

    def _sheet(self, text: str) -> list[tuple[str, dict[str, str]]]:
        """Return the rules of style sheets by rising specificity: the selector and its declarations."""
        rules = []
        for rule in AT_RULE.finditer(text):
            if any(f"{name}:" in rule[0].replace(" ", "") for name in OBEYED):
                self.without[f'style of "{shown(rule[0].partition("{")[0].strip())[1:-1]}"'] += 1
        text = AT_RULE.sub("", text)
        for selectors, body in re.findall(r"([^{}]+)\{([^{}]*)\}", text):
            declared = _declarations(body)
            for selector in map(str.strip, selectors.split(",")):
                if re.fullmatch(r"\*|[\w-]*([.#][\w-]+)?", selector):
                    rules.append((selector, declared))
                elif set(OBEYED) & set(declared):
                    self.without[f'style of "{shown(selector)[1:-1]}"'] += 1
        return sorted(rules, key=lambda rule: ("#" in rule[0], "." in rule[0], rule[0] not in ("*", "")))

    def _properties(self, element: Element) -> dict[str, str]:
        """Return the attributes of an element; style sheets and its own style replace them."""
        tag = _tag(element)
        own = [f"#{element.get('id')}", *(f".{name}" for name in element.get("class", "").split())]
        selectors = {"*", tag, *own, *(tag + name for name in own)}
        found = dict(element.attrib)
        for selector, declared in self._rules:
            if selector in selectors:
                found |= declared
        return found | _declarations(element.get("style", ""))

    def _shapes(
        self,
        element: Element,
        matrix: Matrix,
        inherited: dict[str, str],
        viewport: Points,
        around: tuple[Element, ...],
        size: dict[str, str],
    ) -> Iterator[tuple[str, dict[str, str], Matrix, Points]]:
        """Yield the shapes that are seen, of an element and of those in it, with their matrix and viewport.

        A matrix maps the units of an element to those of the drawing, a viewport (2,) is the size to which
        percentages refer. `around` are the elements around, `size` has the width and height of a <use>.
        """
        tag = _tag(element)
        self._count(element, len(around))
        own = self._properties(element)
        obeyed = {name: own.get(name, "inherit").strip().lower() for name in inherited}
        inherited = {name: value if obeyed[name] == "inherit" else obeyed[name] for name, value in inherited.items()}
        if own.get("display", "").strip().lower() == "none" or not own.get("opacity", "1").strip("0.%"):
            return
        visible = inherited["visibility"] == "visible"
        if tag in UNDRAWN and visible:
            self.without[tag] += 1
        if tag not in (*SHAPES, "g", "a", "svg", "symbol", "switch", "use"):
            return
        self.without.update(name for name in ("clip-path", "mask") if own.get(name, "none") != "none")
        if "transform" in own:
            matrix = matrix @ self._transform(own, viewport)
        if tag in SHAPES and visible:
            empty = {name for name in ("fill", "stroke") if CLEAR.fullmatch(inherited[name])}
            empty |= {name.split("-")[0] for name in inherited if NOTHING.fullmatch(inherited[name])}
            if empty >= {"fill", "stroke"}:
                self.without["shape without fill and stroke"] += 1
                return
            if any(name.startswith("marker") and own[name] != "none" for name in own):
                self.without["marker"] += 1
            yield tag, own, matrix, viewport
        if tag in ("svg", "symbol"):
            matrix, viewport = self._viewport(own | size, matrix, viewport)
        inner, size = [] if tag in SHAPES else list(element), {}
        if tag == "switch":
            inner = [child for child in inner if "requiredExtensions" not in child.attrib][:1]
        if tag == "use":
            place = [self._length(own.get(axis), viewport[k]) or 0.0 for k, axis in enumerate("xy")]
            matrix = matrix @ _affine(np.eye(2), place) if any(place) else matrix
            inner = self._target(own)
            size = {name: own[name] for name in SIZES if name in own}
        for child in inner:
            if child in around or child is element:
                raise self._wrong("a <use> in it refers to itself")
            if tag == "use" or _tag(child) != "symbol":
                yield from self._shapes(child, matrix, inherited, viewport, (*around, element), size)

    def _count(self, element: Element, depth: int) -> None:
        """Raise SceneError for a drawing that is too large or too deeply nested, with references expanded."""
        for name, value in element.attrib.items():
            most = MOST_TRANSFORM if name.lower().endswith("transform") else MOST_STYLE
            if name not in LONG + PASSED and len(value) > most:
                raise self._wrong(f"it has {name.rpartition('}')[2]} of more than {most} letters")
        self._elements += 1
        self._letters += sum(len(value) for name, value in element.attrib.items() if name not in PASSED)
        if self._elements > MOST_POINTS or self._letters > MOST_LETTERS or depth > MOST_DEPTH:
            raise self._wrong(
                f"unfolded, it has more than {MOST_POINTS} elements, {MOST_LETTERS >> 20} MB or {MOST_DEPTH} levels"
            )

    def _target(self, own: dict[str, str]) -> list[Element]:
        """Return the element to which a <use> refers, if it is in the drawing."""
        name = next((own[key] for key in PASSED if key in own), "")
        if name[:1] == "#" and name[1:] in self._named:
            return [self._named[name[1:]]]
        self.without[f'use of "{shown(name)[1:-1]}"'] += 1
        return []

    def _length(self, text: str | None, relative: float) -> float | None:
        """Return a length in the units of the drawing, None for none; percentages are of `relative`."""
        if text is None or text == "auto":
            return None
        found = self._svgelements.Length(text).value(ppi=PIXELS_PER_INCH, relative_length=relative)
        if not isinstance(found, float):
            raise refused("path", self._file, f"its length {shown(text)} has an unknown unit, give px or mm")
        return found

    def _transform(self, own: dict[str, str], viewport: Points) -> Matrix:
        text = own["transform"]
        if set(re.findall(r"(\w+)\s*\(", text.lower())) - FUNCTIONS or "%" in text:
            raise refused("path", self._file, f"its transform {shown(text)} is not read, give a matrix")
        if own.get("transform-box", "view-box") != "view-box":
            self.without["transform-box"] += 1
        found = self._svgelements.Matrix(LENGTH.sub(lambda one: f"{self._length(one[0], 0.0)}", text))
        linear = np.array([[found.a, found.c], [found.b, found.d]], float)
        words = {"left": "0%", "top": "0%", "center": "50%", "right": "100%", "bottom": "100%"}
        origin = [words.get(word, word) for word in own.get("transform-origin", "0 0").split()]
        places = zip([*origin, "50%"], viewport, strict=False)
        about = np.array([self._length(word, side) for word, side in places])
        return _affine(linear, np.array([found.e, found.f], float) + about - linear @ about)

    def _viewport(self, own: dict[str, str], matrix: Matrix, viewport: Points) -> tuple[Matrix, Points]:
        """Return the matrix inside of an <svg> or <symbol>, and its size (SVG 2, 8.2)."""
        numbers = [float(one) for one in re.split(r"[\s,]+", own.get("viewBox", "").strip()) if one]
        corner, inner = np.array(numbers[:2]), np.array(numbers[2:4])
        outer = viewport if viewport.any() else inner if len(inner) else np.full(2, 100.0)
        lengths = [self._length(own.get(name), side) for name, side in zip(SIZES, outer, strict=True)]
        size = np.array([side if one is None else one for one, side in zip(lengths, outer, strict=True)])
        stated = None not in lengths and not any("%" in own[name] for name in SIZES)
        if not viewport.any() and (len(numbers) == 4 or stated):
            self._page = size
        # The outermost <svg> has no place.
        axes = "xy" if viewport.any() else ("", "")
        place = [self._length(own.get(axis), side) or 0.0 for axis, side in zip(axes, outer, strict=True)]
        if len(numbers) != 4:
            return matrix @ _affine(np.eye(2), place), size
        if not (inner > 0).all():
            return np.zeros((3, 3)), inner
        scale = size / inner
        align = own.get("preserveAspectRatio", "xMidYMid")
        if "none" not in align:
            scale[:] = scale.max() if "slice" in align else scale.min()
        shares = [
            next((share for word, share in (("Min", 0.0), ("Max", 1.0)) if axis + word in align), 0.5) for axis in "xY"
        ]
        spare = (size - inner * scale) * shares
        return matrix @ _affine(np.diag(scale), place - corner * scale + spare), inner

    def _sampled(self, tag: str, own: dict[str, str], matrix: Matrix, viewport: Points) -> Iterator[Contour]:
        """Yield the contours of a shape: sampled in its own units, then transformed."""
        sides = (*viewport, np.hypot(*viewport) / np.sqrt(2))
        sizes = {name: self._length(own.get(name), sides[side]) for name, side in LENGTHS.items()}
        given: dict[str, Any] = {name: size for name, size in sizes.items() if size is not None}
        # Defaults of SVG that svgelements does not have.
        if tag == "ellipse":
            given = {"rx": given.get("ry", 0.0), "ry": given.get("rx", 0.0), **given}
            given.pop("r", None)
        else:
            given = {"width": 0.0, "height": 0.0, "r": 0.0, **given}
        shape = self._svgelements.Path()
        try:
            if tag == "path":
                shape.parse(own.get("d", ""))
            else:
                corners = {"points": own.get("points", "")}
                shape = self._svgelements.Path(getattr(self._svgelements, SHAPES[tag])({**given, **corners}))
        except ValueError:
            # A path is drawn up to its error, as in browsers.
            pass
        for part in shape.as_subpaths():
            segments = list(part)
            self._segments += len(segments)
            if self._segments > MOST_POINTS:
                raise self._wrong(f"it has more than {MOST_POINTS} lines and curves")
            for vertices, closed in _contours(self._svgelements, segments):
                yield vertices @ matrix[:2, :2].T + matrix[:2, 2], closed


def _tag(element: Element) -> str:
    """Return the name of an SVG element, "" for an element of another language."""
    space, _, name = str(element.tag).rpartition("}")
    return name if space in ("", "{http://www.w3.org/2000/svg") else ""


def _declarations(text: str) -> dict[str, str]:
    """Return the properties of CSS declarations."""
    pairs = (one.partition(":") for one in text.split(";"))
    return {name.strip(): value.replace("!important", "").strip() for name, mark, value in pairs if mark}


def _affine(linear: NDArray[np.float64], place: Any) -> Matrix:
    """Return the matrix (3, 3) of x -> linear x + place."""
    found = np.eye(3)
    found[:2, :2], found[:2, 2] = linear, place
    return found


def _contours(svgelements: Any, part: list[Any]) -> Iterator[Contour]:
    """Yield the contour of a part as a polygon in the drawing's units, y down; none for length 0."""
    drawn = [segment for segment in part if not isinstance(segment, svgelements.Move) and segment.end is not None]
    if not drawn:
        return
    pieces = [np.asarray(segment.npoint(ways(not isinstance(segment, svgelements.Curve))), float) for segment in drawn]
    vertices = np.concatenate([pieces[0], *(piece[1:] for piece in pieces[1:])])
    if (vertices != vertices[0]).any():
        yield vertices, any(isinstance(segment, svgelements.Close) for segment in drawn)
