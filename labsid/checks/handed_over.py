"""Causes of Python's errors at a call: too few or too many arguments, parts that belong together or apart."""

import ast
import re
from collections.abc import Iterable

from labsid.checks.line_values import parsed_line
from labsid.checks.stops import Stop

_MISSING = re.compile(r"missing \d+ required positional arguments?: (.+)")
_ONE_ARRAY = ("least_squares", "minimize", "fsolve", "root", "leastsq")
"""Searches that hand all parameters to the function in one array."""


def wrong_arguments(stop: Stop, found: re.Match[str]) -> str | None:
    """A call with other arguments than the function takes: of a library's function, or by the check."""
    name = found[1].rpartition(".")[2]
    if name == "subplot":
        return "A figure with two axes is made by `plt.subplots(2, 1)`, with an s at the end."
    if not stop.line:
        return (
            "The call and the first line of the function differ. The check calls it with the arguments of the "
            "question, in their order."
        )
    call = _call_of(stop, name)
    if call is None:
        return _called_by_a_search(stop, name) or _called_within(stop, name)
    written = ast.unparse(call.func)
    if written == "np.array":
        handed = ", ".join(map(ast.unparse, call.args))
        return f"The numbers of an array are handed over together, in a list: `np.array([{handed}])`."
    said = handed_together(stop, call) if " missing " in stop.text else handed_apart(stop, call)
    if said:
        return said
    if written.endswith(".append") and len(call.args) > 1:
        handed = ", ".join(map(ast.unparse, call.args))
        return f"`append` adds one item. Several numbers together are a list: `{written}([{handed}])`."
    if written.endswith((".uniform", ".standard_normal", ".random", ".normal")) and " given" in stop.text:
        return "The shape is one argument, in brackets of its own, `(rows, columns)`."
    if written == "len" and len(call.args) == 2:
        table = ast.unparse(call.args[0])
        return f"`len({table})` is the number of rows; rows and columns are `{table}.shape[0]` and `{table}.shape[1]`."
    thing = stop.things.get(written)
    if isinstance(call.func, ast.Attribute) or thing is None or not thing.keys:
        return _told_by_help(stop, call)
    takes = f" It takes {_and(f'`{key}`' for key in thing.keys)}." if len(thing.keys) > 1 else ""
    return f"{missing}{takes}" if (missing := _missing(stop, name)) else _listed(stop, call)


def starred_argument(stop: Stop, _: re.Match[str]) -> str | None:
    """A star before a list that should be handed over as a whole."""
    starred = next((node for node in _nodes(stop.line) if isinstance(node, ast.Starred)), None)
    if starred is None:
        return None
    inner = ast.unparse(starred.value)
    return f"`*{inner}` hands over its entries one by one: the whole of it is `{inner}`, without the star."


def one_list(stop: Stop, found: re.Match[str]) -> str | None:
    """Arrays that are to be joined, handed over one by one."""
    starred = starred_argument(stop, found)
    call = _call_of(stop, found[1])
    if starred or call is None:
        return starred
    called, handed = ast.unparse(call.func), list(map(ast.unparse, call.args))
    things = [stop.things.get(name) for name in handed]
    if all(thing is not None and thing.lengths for thing in things):
        rows = {length for thing in things if thing is not None for length in thing.lengths}
        if len(rows) > 1:
            return f"It takes one list of arrays. The lists here hold arrays with {_and(map(str, sorted(rows)))} rows."
        return f"It takes one list of arrays: the lists are joined by `+`, `{called}({' + '.join(handed)})`."
    if any(thing is not None and thing.kind == "list" for thing in things):
        return f"`{called}` takes one list of arrays: two lists are joined by `+`, two arrays stand in one, `[a, b]`."
    shapes = [stop.shape(part) for part in call.args]
    if found[1] == "column_stack" and all(shapes) and len({shape[0] for shape in shapes if shape}) > 1:
        return f"It takes one list of arrays, and these have {_and(str(shape[0]) for shape in shapes if shape)} rows."
    return f"Hand the arrays over together, in a list: `{called}([{', '.join(handed)}])`."


def _and(words: Iterable[str]) -> str:
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def handed_together(stop: Stop, call: ast.Call) -> str:
    """That one argument holds several, where a call hands over too few; empty if none does."""
    lacking = re.search(r"missing (\d+) ", stop.text)
    completes = 1 + int(lacking[1]) if lacking else 0  # so many parts, in the place of one argument, are enough
    for i, part in enumerate(call.args):
        name, thing = ast.unparse(part), stop.things.get(ast.unparse(part))
        is_alone = len(call.args) == 1
        if (isinstance(part, ast.Tuple) or (isinstance(part, ast.List) and is_alone)) and len(part.elts) == completes:
            handed = ", ".join(map(ast.unparse, [*call.args[:i], *part.elts, *call.args[i + 1 :]]))
            kind = "tuple" if isinstance(part, ast.Tuple) else "list"
            return (
                f"`{name}` is one argument, a {kind}. Its parts are handed over one by one: "
                f"`{ast.unparse(call.func)}({handed})`."
            )
        if thing is not None and thing.kind == "tuple" and thing.shape == (completes,):
            return (
                f"`{name}` is one argument, a tuple of {completes}. Its parts are handed over one "
                f"by one by a star, `*{name}`."
            )
        if is_alone and isinstance(part, ast.Call | ast.Subscript) and thing is None:
            return (
                f"`{name}` is one argument, whatever it holds. The parts of a tuple are handed over one by one by a "
                f"star: `{ast.unparse(call.func)}(*{name})`."
            )
    return ""


def handed_apart(stop: Stop, call: ast.Call) -> str:
    """That a star hands over the entries of an argument, where a call hands over too many; empty without one."""
    counted = re.search(r"takes (?:from \d+ to )?(\d+) positional arguments? but (\d+) (?:was|were) given", stop.text)
    starred = next((part for part in call.args if isinstance(part, ast.Starred)), None)
    if starred is None or counted is None:
        return ""
    takes, given = int(counted[1]), int(counted[2])
    inner, others = ast.unparse(starred.value), len(call.args) - 1
    said = f"`*{inner}` hands over each of its {given - others} parts as an argument of its own"
    if others + 1 == takes:
        return f"{said}. Without the star, `{inner}` is one argument."
    return f"{said}, and `{ast.unparse(call.func)}` takes {takes} in all: take those that it asks for, `[:{takes}]`."


def _called_by_a_search(stop: Stop, name: str) -> str:
    """How a search calls the function that it is given; empty if the line has none."""
    calls = [node for node in _nodes(stop.line) if isinstance(node, ast.Call)]
    called = {ast.unparse(node.func).rpartition(".")[2] for node in calls}
    if called & set(_ONE_ARRAY) and " missing " in stop.text:
        search = next(iter(sorted(called & set(_ONE_ARRAY))))
        shown = "the function" if name == "<lambda>" else f"`{name}`"
        return (
            f"`{search}` hands all parameters over in one array: {shown} takes one argument, such as `theta`, and "
            "takes it apart, `a, b = theta`."
        )
    if "curve_fit" in called:
        return "`curve_fit` hands x over and then the parameters one by one: `lambda x, a, b: ...`."
    return ""


def _called_within(stop: Stop, name: str) -> str:
    """The call in the line within which a function is called with other arguments than it takes."""
    call = next((node for node in stop.expressions() if isinstance(node, ast.Call)), None)
    if call is None or not name.startswith("_"):
        return _missing(stop, name) or f"`{name}` is called with other arguments than its first line has."
    return _told_by_help(stop, call)


def _told_by_help(stop: Stop, call: ast.Call) -> str:
    written, missing = ast.unparse(call.func), _MISSING.search(stop.text)
    lacks = "" if missing is None else f"`{written}` needs {re.sub(chr(39), '`', missing[1])}, too. "
    return f"{lacks}Which arguments it takes, and in which order, `help({written})` tells."


def _missing(stop: Stop, name: str) -> str:
    missing = _MISSING.search(stop.text)
    if missing is None:
        return ""
    names = re.sub("'", "`", missing[1])
    return f"The first line of `{name}` has {names}, too: hand over as many as it has, in its order."


def _listed(stop: Stop, call: ast.Call) -> str | None:
    """The arguments of a function that is handed too many."""
    thing = stop.things.get(ast.unparse(call.func))
    if thing is None or thing.kind != "function" or not thing.keys or any(call.keywords):
        return None
    names = ", ".join(f"`{name}`" for name in thing.keys)
    return (
        f"`{ast.unparse(call.func)}` takes {names}, and the call hands over {len(call.args)} arguments. Several "
        "numbers for one of them stand in a list, `[1, 0]`."
    )


def _call_of(stop: Stop, name: str) -> ast.Call | None:
    """The call of a function of that name in the line."""
    calls = (node for node in stop.expressions() if isinstance(node, ast.Call))
    return next((node for node in calls if ast.unparse(node.func).rpartition(".")[2] == name), None)


def _nodes(line: str) -> list[ast.AST]:
    tree = parsed_line(line)
    return [] if tree is None else list(ast.walk(tree))
