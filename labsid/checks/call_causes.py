"""Causes of Python's errors at calls, attributes and axes: what a module, an array or a number has."""

import ast
import difflib
import re
import sys
from collections.abc import Iterator
from types import ModuleType

import numpy as np

from labsid.checks.key_causes import field_as_attribute
from labsid.checks.matlab_syntax import MATLAB
from labsid.checks.stops import Stop

_MODULES = ("numpy", "scipy", "matplotlib", "control")
_KNOWN = {
    "Generator": "numpy.random", "TransferFunction": "control", "StateSpace": "control", "Record": "labsid.records",
}  # fmt: skip
_OTHER_NAMES = {
    "length": "len", "lenght": "len", "numel": "size", "rank": "matrix_rank", "pinverse": "pinv", "inverse": "inv",
    "transposed": "transpose", "power": "float_power", "columnstack": "column_stack", "randn": "standard_normal",
}  # fmt: skip
"""What some functions are called elsewhere."""
_OF_LISTS = {
    "append": "`np.append({0}, value)` returns a longer one.",
    "insert": "`np.insert({0}, index, value)` returns a longer one.",
    "extend": "`np.concatenate([{0}, other])` returns a longer one.",
    "remove": "`np.delete({0}, index)` returns it without the entries at an index; `list({0})` makes a list of it.",
    "pop": "`np.delete({0}, index)` returns it without the entries at an index; `list({0})` makes a list of it.",
    "index": "The first index at which a condition holds is `np.argmax({0} >= value)`.",
    "count": "`np.sum({0} == value)` counts.",
}
"""What stands for a method of lists."""
_PROPERTIES = ("color", "label", "linestyle", "linewidth", "marker", "where")
_LEAST_ALIKE = 0.8
_LONGEST_NAME = 40
_REDUCTIONS = ("sum", "mean", "std", "var", "max", "min", "cumsum", "prod", "diff")


def unknown_in_a_module(stop: Stop, found: re.Match[str]) -> str | None:
    """A name that a module of numpy, scipy, matplotlib or python-control does not have."""
    module, name = sys.modules.get(found[1]), found[2]
    if found[1].partition(".")[0] not in _MODULES or module is None or len(name) > _LONGEST_NAME:
        return None
    written = _owner_of(stop, name) or found[1]
    if found[1] == "numpy" and name in ("rand", "randn"):
        drawn = "random" if name == "rand" else "standard_normal"
        return f"Random numbers are drawn from a generator: `rng.{drawn}(shape)`."
    if name in MATLAB and name not in _OTHER_NAMES:
        return f"In Python: {MATLAB[name]}."
    other = _OTHER_NAMES.get(name.lower(), name.lower())
    if other == "len":
        return "The length of an array is `len(y)`, its shape `y.shape`."
    if name in ("mse", "rms", "rmse"):
        return "There is no function for it: it is made of `np.mean`, `**` and, for a root, `np.sqrt`."
    for part, path in (
        (module, written),
        (np.linalg, "np.linalg"),
        (np, "np"),
        (sys.modules.get("scipy.linalg"), "scipy.linalg"),
    ):
        if isinstance(part, ModuleType) and other in _public(part):
            return f"It is `{path}.{other}`."
    if found[1] == "matplotlib.pyplot" and name in _public(_drawn("Axes")):
        return f"It is a method of axes: `ax.{name}(...)`."
    near = difflib.get_close_matches(name, _public(module), 1, _LEAST_ALIKE)
    return (
        f"There is `{written}.{near[0]}`, which is spelt nearly alike."
        if near
        else f"`{written}` has nothing of that name."
    )


def unknown_in_an_array(stop: Stop, found: re.Match[str]) -> str | None:
    """A name that arrays do not have."""
    name = found[1][:_LONGEST_NAME]
    owner = _owner_of(stop, name)
    written = owner if 0 < len(owner) < _LONGEST_NAME else "y"
    if name in _OF_LISTS:
        return f"It is a method of lists, and `{written}` is an array. {_OF_LISTS[name].format(written)}"
    if name in _public(_drawn("Axes")) and name not in dir(list):
        return (
            f"It is a method of axes. Is `{written}` the array of axes that `plt.subplots` returns? Then take one, "
            f"`{written}[0]`."
        )
    other = _OTHER_NAMES.get(name.lower(), name)
    if other == "len":
        return f"The length of an array is `len({written})`, its shape `{written}.shape`."
    if name == "t":
        return (
            f"Arrays have no `.t`. The transpose is `{written}.T`, with a capital letter; a column is taken by its "
            f"number, `{written}[:, 0]`."
        )
    if name in _public(np.linalg):
        return f"It is no part of an array, but a function: `np.linalg.{name}({written})`."
    if other in _public(np):
        has_more = re.search(rf"\.{name}\(\s*[^)\s]", stop.line) is not None
        return f"It is no part of an array, but a function: `np.{other}({written}{', ...' if has_more else ''})`."
    near = difflib.get_close_matches(name, _public(np.ndarray), 1, _LEAST_ALIKE)
    return f"Arrays have `.{near[0]}`, which is spelt nearly alike." if near else "Arrays have nothing of that name."


def unknown_in_a_figure(stop: Stop, found: re.Match[str]) -> str | None:
    """A name that axes or figures do not have."""
    if found[1] == "Figure" and found[2] in _public(_drawn("Axes")):
        owner = _owner_of(stop, found[2])
        made = stop.made.get(owner, "")
        by = f", which `{made}` makes with it" if "subplots" in made and "=" in made else ""
        return f"`{owner}` is the figure. Curves, labels and grids belong to its axes{by}: `ax.{found[2]}(...)`."
    near = difflib.get_close_matches(found[2][:_LONGEST_NAME], _public(_drawn(found[1])), 1, _LEAST_ALIKE)
    return f"There is `.{near[0]}`, which is spelt nearly alike." if near else None


def unknown_property(_: Stop, found: re.Match[str]) -> str | None:
    """A keyword that a curve does not have."""
    near = difflib.get_close_matches(found[1][:_LONGEST_NAME], _PROPERTIES, 1, _LEAST_ALIKE)
    return f"The keyword is spelt `{near[0]}`." if near else f"A curve has no `{found[1]}`: {', '.join(_PROPERTIES)}."


def unknown_in_a_number(stop: Stop, found: re.Match[str]) -> str | None:
    """An attribute of arrays, asked of one number."""
    owner = _owner_of(stop, found[1])
    if not owner:
        return "It arises within the function that is called: look at what is handed over to it, and in which order."
    return f"`{owner}` is one number, no array: it has no `.{found[1]}`."


def attribute_of_a_function(stop: Stop, found: re.Match[str]) -> str | None:
    """An attribute of arrays, asked of a function that is not called."""
    owner = _owner_of(stop, found[1])
    if not owner or found[1] not in dir(np.ndarray):
        return None
    thing = stop.things.get(owner)
    handed = ", ".join(thing.keys) if thing is not None else ""
    made = stop.made.get(owner, "")
    by = f", by `{made}`," if "=" in made else ""
    return f"`{owner}` is a function{by} and not what it returns: it is called, `{owner}({handed or '...'})`."


def unknown_elsewhere(stop: Stop, found: re.Match[str]) -> str | None:
    """A name that something else than a module, a number or a plain array does not have."""
    kind, name = found[1], found[2]
    owner = _owner_of(stop, name)
    if stop.things.get(owner) is not None and stop.things[owner].kind == "array":
        return unknown_in_an_array(stop, re.match("(.*)", name))  # type: ignore[arg-type]
    if kind == "TimeResponseData":
        return "Of a response, `.outputs` is the output, `.time` the time and `.states` the states."
    if kind == "Generator" and name in ("rand", "randn"):
        return (
            f"It is `{owner}.{'random' if name == 'rand' else 'standard_normal'}(shape)`, with the shape in brackets."
        )
    module = sys.modules.get(_KNOWN.get(kind, ""))
    near = difflib.get_close_matches(name[:_LONGEST_NAME], _public(getattr(module, kind, None)), 1, _LEAST_ALIKE)
    return f"There is `{owner}.{near[0]}`, which is spelt nearly alike." if near and owner else None


def missing_axis(stop: Stop, found: re.Match[str]) -> str | None:
    """An axis that an array does not have."""
    axes = int(found[2]) if found.re.groups > 1 else None
    for node in _calls(stop):
        if ast.unparse(node.func).rpartition(".")[2] in _REDUCTIONS and len(node.args) > 1:
            called, given = ast.unparse(node.func), ast.unparse(node.args[1])
            if axes is None:
                return f"What comes second in `{called}` is the axis, and here it is `{given}`: it takes one array."
            return (
                f"What comes second in `{called}` is the axis, here `{given}`, and the array has {axes}, counted from "
                f"0. Part of an array is taken by a slice of it, `{ast.unparse(node.args[0])}[...]`."
            )
        if ast.unparse(node.func) == "np.size" and len(node.args) > 1:
            name = ast.unparse(node.args[0])
            return f"MATLAB's `size({name}, 1)` is `{name}.shape[0]`, `size({name}, 2)` is `{name}.shape[1]`."
    if axes is None:
        return None
    has = (
        "one axis, 0" if axes == 1 else "the axes 0, down the rows, and 1, along them" if axes == 2 else f"{axes} axes"
    )
    return f"Axes are counted from 0: an array of dimension {axes} has {has}."


def no_steps(stop: Stop, _: re.Match[str]) -> str | None:
    """A step where a function takes a number of points, or a fraction where it counts."""
    for node in _calls(stop):
        called = ast.unparse(node.func)
        if called.endswith("linspace") and len(node.args) > 2:
            count = ast.unparse(node.args[2])
            inner = list(ast.walk(node.args[2]))
            numbers = [one.value for one in inner if isinstance(one, ast.Constant) and isinstance(one.value, float)]
            if any(isinstance(one, ast.Div) for one in inner) or any(map(float.is_integer, numbers)):
                return (
                    f"What comes third in `linspace` is the number of points, a whole number. `{count}` is a float, as "
                    f"all results of `/` and of numbers such as `1e3` are: `round({count})` is a whole number."
                )
            return (
                f"What comes third in `linspace` is the number of points, here `{count}`. With a "
                "step it is `np.arange(start, stop, step)`."
            )
        if called == "range":
            return "`range` counts in whole numbers; `np.arange(start, stop, step)` takes any step."
    return None


def no_count(stop: Stop, _: re.Match[str]) -> str | None:
    """A list or an array in the place of a count."""
    for node in _calls(stop):
        for part in node.args if ast.unparse(node.func) == "range" else ():
            thing, name = stop.things.get(ast.unparse(part)), ast.unparse(part)
            if thing is not None and (thing.kind == "list" or (thing.kind == "array" and thing.shape)):
                return (
                    f"`range` counts up to one number, and `{name}` {thing.said}. A loop goes through it itself, "
                    f"`for x in {name}`; it has `len({name})` entries."
                )
    return None


def negative_size(stop: Stop, _: re.Match[str]) -> str | None:
    """A diagonal of `np.eye` that stands in the place of the number of columns, or a size below zero."""
    for node in _calls(stop):
        if ast.unparse(node.func) == "np.eye" and len(node.args) > 1:
            n, k = map(ast.unparse, node.args[:2])
            return (
                "What comes second in `np.eye` is the number of columns. A diagonal above or below is chosen by "
                f"its name, `np.eye({n}, k={k})`."
            )
    return "A size is below zero: print it."


def own_function_of_python(stop: Stop, found: re.Match[str]) -> str | None:
    """An argument that numpy's function of the same name takes, and Python's own does not."""
    name = found[1]
    return f"`{name}` is Python's own; numpy's takes it: `np.{name}(...)`." if name in _public(np) else None


def compared_by_python(stop: Stop, _: re.Match[str]) -> str | None:
    """Python's `max` or `min` of arrays."""
    for node in _calls(stop):
        if isinstance(node.func, ast.Name) and node.func.id in ("max", "min") and node.args:
            name = node.func.id
            if len(node.args) == 1:
                return f"`{name}` is Python's own, and compares rows. Of all entries it is `np.{name}(...)`."
            handed = ", ".join(map(ast.unparse, node.args))
            return (
                f"`{name}` is Python's own, and compares arrays as a whole. Entry by entry: `np.{name}imum({handed})`."
            )
    return None


def array_for_an_axis(stop: Stop, _: re.Match[str]) -> str | None:
    """A second array where a function of numpy takes the axis."""
    for node in _calls(stop):
        name = ast.unparse(node.func).rpartition(".")[2]
        if name == "append" and len(node.args) == 3:
            return "`np.append(a, b)` joins two arrays, and what comes third is the axis. More are joined in one list."
        if re.fullmatch("concatenate|[hvc]?(?:olumn_)?stack", name) and len(node.args) > 1 and stop.shape(node.args[1]):
            handed = ", ".join(map(ast.unparse, node.args))
            return f"Arrays that are joined are handed over together, in a list: `np.{name}([{handed}])`."
        if name in _REDUCTIONS and len(node.args) > 1 and stop.shape(node.args[1]):
            return (
                f"What comes second in `np.{name}` is a number, and here it is the array "
                f"`{ast.unparse(node.args[1])}`: `np.{name}` takes one array."
            )
    return None


def text_for_an_index(stop: Stop, _: re.Match[str]) -> str | None:
    """A text in the square brackets of an array."""
    for node in stop.expressions():
        if isinstance(node, ast.Subscript) and stop.shape(node.value) is not None:
            parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
            text = next((one for one in parts if _is_text(one, stop)), None)
            if text is not None:
                return (
                    f"`{ast.unparse(node.value)}` is an array, and takes whole numbers; `{ast.unparse(text)}` is a "
                    "text, which is a key of a dictionary."
                )
    return None


def not_iterable(stop: Stop, _: re.Match[str]) -> str | None:
    """A number in the place of what a loop goes through."""
    head = re.match(r"for\s+\w+\s+in\s+(.+?)\s*:", stop.line)
    if head is not None:
        return f"A loop goes through the parts of something: `range({head[1]})` counts from 0 and leaves out {head[1]}."
    return "It is one number, and what should have parts is a list or an array."


def text_in_a_computation(stop: Stop, _: re.Match[str]) -> str | None:
    """A text between numbers."""
    for node in stop.operations(ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow):
        for side in (node.left, node.right):
            if _is_text(side, stop):
                other = node.right if side is node.left else node.left
                return f"`{ast.unparse(side)}` is a text, and no number{_beside_a_text(stop, node, side, other)}"
    is_text = re.search("'str'|to str|<U", stop.text)
    return "A text stands among numbers, and does not compute." if is_text else None


def _beside_a_text(stop: Stop, node: ast.BinOp, text: ast.expr, other: ast.expr) -> str:
    """What a text in a computation may be: a number in quotes, or one to which a number is joined; else nothing."""
    if isinstance(text, ast.Constant) and _NUMBER.fullmatch(str(text.value).strip()):
        return ": a number stands without quotes."
    thing, name = stop.things.get(ast.unparse(other)), ast.unparse(other)
    if isinstance(node.op, ast.Add) and thing is not None and (thing.kind == "number" or thing.shape == ()):
        return (
            f". `+` joins a text to a text alone: `str({name})` is one. An f-string has both, `f'... {{{name}:.3g}}'`."
        )
    return "."


_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?", re.IGNORECASE)


def number_function(stop: Stop, _: re.Match[str]) -> str | None:
    """A function of Python's `math`, for one number, that is handed an array."""
    for node in stop.expressions():
        if (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Attribute)
            and ast.unparse(node.func.value) == "math"
        ):
            name = node.func.attr
            of_arrays = f"`np.{name}` takes arrays, entry by entry." if hasattr(np, name) else "numpy's take arrays."
            return f"`math.{name}` takes one number; {of_arrays}"
        if (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Name)
            and node.func.id in ("float", "int", "complex")
        ):
            return f"`{node.func.id}(...)` makes one number of one number, and is handed an array of several."
    return None


def without_entries(stop: Stop, _: re.Match[str]) -> str | None:
    """Square brackets after a function or a number."""
    for node in stop.expressions():
        if isinstance(node, ast.Subscript):
            owner, thing = ast.unparse(node.value), stop.things.get(ast.unparse(node.value))
            field = field_as_attribute(stop, node.value)
            if field:
                return field
            if thing is not None and thing.kind == "number":
                return f"`{owner}` is one number: it has no entries, and takes no `[...]`."
            if "method' object" in stop.text or (thing is not None and thing.kind == "function"):
                return f"`{owner}` is a function: it is called by round brackets, `{owner}(...)`."
    return None


def uncalled_function(stop: Stop, _: re.Match[str]) -> str | None:
    """A function, or a name that was given one, in a computation."""
    for node in stop.expressions():
        thing = stop.things.get(node.id) if isinstance(node, ast.Name) else None
        if isinstance(node, ast.Name) and thing is not None and thing.kind == "function" and node.id in stop.made:
            made = stop.made[node.id]
            if re.match(rf"{node.id}\s*=", made) and not made.endswith(")"):
                called = made.partition("=")[2].strip()
                return f"`{node.id}` is a function, by `{made}`: there it is not called, `{called}(...)`."
    return None


def called_attribute(stop: Stop, _: re.Match[str]) -> str | None:
    """Round brackets after the shape or the size of an array."""
    for node in _calls(stop):
        if isinstance(node.func, ast.Attribute) and node.func.attr in ("shape", "size", "ndim", "T", "Ts", "dtype"):
            written = ast.unparse(node.func)
            first = f", and its first number `{written}[0]`" if node.func.attr == "shape" else ""
            if node.func.attr == "size" and node.args:
                owner = ast.unparse(node.func.value)
                first = f" counts all entries. The number of rows is `{owner}.shape[0]`, of columns `{owner}.shape[1]`"
            return f"It is no function, and takes no round brackets: `{written}`{first}."
    return None


def _calls(stop: Stop) -> Iterator[ast.Call]:
    yield from (node for node in stop.expressions() if isinstance(node, ast.Call))


def _owner_of(stop: Stop, name: str) -> str:
    """What stands before the dot and that name; empty if it is not in the line."""
    owners = (ast.unparse(n.value) for n in stop.expressions() if isinstance(n, ast.Attribute) and n.attr == name)
    return next(owners, "")


def _drawn(kind: str) -> object:
    """matplotlib's class of that name, where it has been imported."""
    return getattr(sys.modules.get(f"matplotlib.{kind.lower()}"), kind, None)


def _is_text(node: ast.expr, stop: Stop) -> bool:
    if isinstance(node, ast.Constant):
        return isinstance(node.value, str)
    thing = stop.things.get(ast.unparse(node))
    return thing is not None and thing.kind == "text"


def _public(thing: object) -> list[str]:
    return [name for name in dir(thing) if not name.startswith("_")]
