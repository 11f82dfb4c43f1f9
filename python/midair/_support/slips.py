"""Mistyped arguments: a call with an unknown keyword gets an error of one line with a hint.

`guided` wraps each public name once, when it is loaded. A successful call costs one more Python frame.
Signatures and docstrings do not change.
"""

import functools
import inspect
import sys
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from types import FunctionType, MethodDescriptorType, ModuleType
from typing import Any, cast

from .._midair import SceneError, array_parts, nearest, restated, scene_keys, stated, unknown_name

#: Keywords that the core declares, by the name of the `**` argument that takes them, such as `**parts` of an
#: array.
DECLARED = {"parts": tuple(array_parts()), "keys": (*scene_keys()["medium"], *array_parts())}

#: Parameters of a bead, which are no arguments of a function that takes a bead.
BEAD = scene_keys()["bead"].keys()

#: Kinds of parameters that can be given by keyword.
NAMED = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)


def attach(package: str) -> None:
    """Wrap the functions and classes of a package's `__all__`, which is also what `dir` lists."""
    module = sys.modules[package]
    vars(module)["__dir__"] = lambda: module.__all__
    for key in module.__all__:
        setattr(module, key, guided(getattr(module, key), f"{package}.{key}"))


def guided(value: Any, name: str) -> Any:
    """Return a public function or class with checked keywords; other values are returned unchanged."""
    if isinstance(value, type):
        _class(value, name)
    elif callable(value) and not isinstance(value, ModuleType):
        wrapped = _guided(value, name)
        # The function is replaced in its own module, too, because pickle looks for it there.
        home: Any = sys.modules.get(value.__module__)
        key = name.rpartition(".")[2]
        if getattr(home, key, None) is value:
            setattr(home, key, wrapped)
        return wrapped
    return value


class Later:
    """A method that is a function of another module, which is imported at the first use.

    Parameters
    ----------
    home, name
        The module, relative to midair, and the function's name in it.
    static
        Whether the function is a static method.
    """

    def __init__(self, home: str, name: str, *, static: bool = False) -> None:
        self.home, self.name, self.static = home, name, static
        self.owner: Any = None
        self.key = ""

    def __set_name__(self, owner: type, key: str) -> None:
        self.owner, self.key = owner, key

    def __get__(self, instance: object, owner: type) -> Any:
        function = getattr(import_module(f"midair.{self.home}"), self.name)
        # A public function already checks its keywords under its own name; the method checks them under
        # another one.
        method = getattr(function, "__wrapped__", function)
        if not self.key.startswith("_"):
            method = _guided(method, f"midair.{self.owner.__name__}.{self.key}")
        setattr(self.owner, self.key, staticmethod(method) if self.static else method)
        return getattr(owner if instance is None else instance, self.key)


def _class(owner: type, name: str) -> None:
    """Wrap the methods of a class, and its constructor."""
    for key, value in list(vars(owner).items()):
        if key == "_new":
            # Classes of the extension construct instances by `_new`.
            cast(Any, owner).__new__ = _constructor(value.__func__, owner, name)
        elif key in ("__init__", "__new__"):
            if isinstance(value, FunctionType):
                setattr(owner, key, _guided(value, name))
        elif key.startswith("_"):
            continue
        elif isinstance(value, staticmethod | classmethod):
            setattr(owner, key, type(value)(_guided(value.__func__, f"{name}.{key}")))
        elif isinstance(value, FunctionType | MethodDescriptorType):
            setattr(owner, key, _guided(value, f"{name}.{key}"))


def _guided(function: Callable[..., Any], name: str, signed: Any = None) -> Callable[..., Any]:
    """Return a function whose errors about a keyword suggest the correct one.

    Its signature is that of `signed`, if given.
    """

    @functools.wraps(function)
    def call(*arguments: Any, **keywords: Any) -> Any:
        try:
            return function(*arguments, **keywords)
        except (TypeError, SceneError) as error:
            if slip := _slip(signed or call, name, arguments, keywords, error):
                raise slip from None
            raise
        except UnicodeEncodeError as error:
            # Halves of surrogate pairs, which neither Rust's texts nor names of files can contain.
            raise stated(f"text {ascii(error.object)[:80]}", "is no Unicode", "give one without surrogates") from None

    if _takes_declared(function):
        cast(Any, call).__signature__ = _signature(function)
    return call


def _takes_declared(function: Any) -> bool:
    """Return whether the last argument takes keywords that the core declares."""
    if code := getattr(function, "__code__", None):
        last = code.co_varnames[code.co_argcount + code.co_kwonlyargcount :][:1]
        return bool(code.co_flags & inspect.CO_VARKEYWORDS) and last[:1] and last[0] in DECLARED
    return (function.__text_signature__ or "").rpartition("**")[2][:-1] in DECLARED


def _signature(function: Callable[..., Any]) -> inspect.Signature:
    """Return a function's signature with the core's keywords listed one by one."""
    signature = inspect.signature(function)
    *own, last = signature.parameters.values()
    one = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None) for name in DECLARED[last.name]]
    return signature.replace(parameters=[*own, *one])


def _constructor(make: Callable[..., Any], owner: type, name: str) -> Callable[..., Any]:
    """Return a `__new__` that makes instances by the function `make`."""
    guided = _guided(make, name, owner)

    def new(cls: type, /, *arguments: Any, **keywords: Any) -> Any:
        return guided(*arguments, **keywords)

    signature = _signature(make) if _takes_declared(make) else inspect.signature(make)
    own = inspect.Parameter("cls", inspect.Parameter.POSITIONAL_ONLY)
    cast(Any, new).__signature__ = signature.replace(parameters=[own, *signature.parameters.values()])
    return new


def _slip(
    function: Callable[..., Any], name: str, arguments: Sequence[Any], keywords: Mapping[str, Any], error: Exception
) -> Exception | None:
    """Return a better error if the arguments have caused it: an unknown keyword, a missing one; else None."""
    signature = inspect.signature(function)
    named = [each.name for each in signature.parameters.values() if each.kind in NAMED]
    known = [each for each in named if each != "self" and not each.startswith("_")]
    for keyword in keywords:
        if keyword in named:
            continue
        if keyword in BEAD and "bead" in named:
            return part_of_bead(name, keyword)
        if _unbound(signature, arguments, keywords):
            reported = unknown_name(f"argument of {name}", keyword, known)
            line = str(reported) if known else f'{name} takes no keywords: leave "{keyword}" out'
            # The function that passed the keyword on may know a better name.
            slip = TypeError(line)
            vars(slip)["reported"] = reported
            return slip
        # Other keywords are a solver's options. An unknown one may be a mistyped argument's name.
        cause = vars(error).get("reported", error)
        unknown = isinstance(cause, SceneError) and cause.code == "unknown" and cause.value == keyword
        if unknown and (meant := nearest(keyword, [*known, *DECLARED["keys"]])):
            # The air and the array of a scene are no arguments of what solves it.
            own = meant in known or name != "midair.solve"
            better = restated(cause, meant=meant if own else f"{meant} of a midair.Scene")
            return better if cause is error else TypeError(str(better))
    # Python's own error names the private function.
    reason = isinstance(error, TypeError) and _unbound(signature, arguments, keywords)
    return TypeError(f"{name}: {reason}") if reason else None


def part_of_bead(name: str, keyword: str) -> TypeError:
    """Return the error about a parameter of a bead that is given as an argument of a function."""
    return TypeError(f'{name} takes "{keyword}" as a part of bead: give bead={{"{keyword}": ...}}')


def _unbound(signature: inspect.Signature, arguments: Sequence[Any], keywords: Mapping[str, Any]) -> str:
    """Return why a call does not fit the signature, "" if it does."""
    try:
        signature.bind(*arguments, **keywords)
    except TypeError as error:
        return str(error)
    return ""
