"""Causes of Python's errors that follow from the shapes of what stands in the line that stopped."""

import ast
import re

from labsid.checks.line_values import parsed_line
from labsid.checks.points import points_made
from labsid.checks.stops import Stop
from labsid.checks.tables import zeros_of_one_size

_FINDS = ("where", "nonzero", "flatnonzero", "argwhere")
_PARTS = {"svd": 3, "eig": 2, "eigh": 2, "qr": 2, "slogdet": 2}
"""How many things functions of `np.linalg` return."""


def beyond_the_end(stop: Stop, found: re.Match[str]) -> str | None:
    """An index that is the number of entries, or larger."""
    index, axis, size = int(found[1]), int(found[2]), int(found[3])
    taken = _taken(stop, axis, size)
    at = ast.unparse(taken[1]) if taken else ""
    behind = [stop.made.get(node.id, "") for node in ast.walk(taken[1]) if isinstance(node, ast.Name)] if taken else []
    counted = next((line for line in (at, *behind) if "digitize(" in line), "")
    if counted:
        beyond = " A value at the last edge, or above it, is counted beyond the last cell." if index > size else ""
        return (
            f"`np.digitize` counts its cells from 1, in `{counted}`, and Python its entries from 0: take 1 off.{beyond}"
        )
    if size == 0:
        condition = _never_met(stop)
        if condition:
            return condition
        return f"It is empty along that axis{_made_by(stop, taken)}: print its shape."
    if taken is None or isinstance(taken[1], ast.Constant):
        handed = "" if taken is None else _handed_over(stop, taken[0], index, axis, size)
        if handed:
            return handed
        if index == size:
            return f"Python counts from 0: {size} entries have the indices 0 to {size - 1}, the last is `[-1]`."
        return f"There are {size} entries, with the indices 0 to {size - 1}."
    shape = stop.shape(taken[0]) or (size,)
    what = ("rows", "columns")[axis] if len(shape) == 2 and axis < 2 else "entries"
    other = f" (and {shape[1 - axis]} {('columns', 'rows')[axis]})" if len(shape) == 2 and axis < 2 else ""
    return (
        f"`{ast.unparse(taken[0])}` has {size} {what if size > 1 else what[:-1].replace('ie', 'y')}{other}"
        f"{_made_by(stop, taken)}, with the indices 0 to {size - 1}. Here `{at}` is {index}."
    )


def _handed_over(stop: Stop, owner: ast.expr, index: int, axis: int, size: int) -> str:
    """That a written index is beyond an array which the function was handed; empty if it is another array."""
    name, shape = ast.unparse(owner), stop.shape(owner) or ()
    if name not in stop.arguments or name in stop.made:
        return ""
    what = ("rows", "columns")[axis] if len(shape) == 2 else "entries"
    return (
        f"`{name}` is handed over, here with {size} {what}. Python counts from 0: they have the indices 0 to "
        f"{size - 1}. How many there are says `{name}.shape[{axis}]`."
    )


def _never_met(stop: Stop) -> str:
    """The condition in the line, or behind it, that no entry meets; empty if nothing is looked for."""
    for line in (stop.part or stop.line, *stop.made.values()):
        tree = parsed_line(line)
        for node in [] if tree is None else ast.walk(tree):
            finds = isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] in _FINDS
            if isinstance(node, ast.Call) and finds and node.args and isinstance(node.args[0], ast.Compare):
                condition = node.args[0]
                equal = " (Numbers of many digits are hardly ever equal, `==`.)"
                is_equal = isinstance(condition.ops[0], ast.Eq)
                return f"No entry meets the condition `{ast.unparse(condition)}`.{equal if is_equal else ''}"
    return ""


def beyond_a_list(stop: Stop, _: re.Match[str]) -> str | None:
    """An index beyond the end of a list."""
    for node in stop.expressions():
        if not isinstance(node, ast.Subscript):
            continue
        thing, at = stop.things.get(ast.unparse(node.value)), ast.unparse(node.slice)
        is_list = isinstance(node.value, ast.List)
        count = len(node.value.elts) if isinstance(node.value, ast.List) else None
        if not is_list and thing is not None and thing.kind == "list" and thing.shape:
            count = thing.shape[0]
        if count is None:
            continue
        what = "The list" if is_list else f"`{ast.unparse(node.value)}`"
        if not count:
            return f"{what} is empty."
        index = stop.things.get(at)
        here = f" Here `{at}` is {index.value}." if index is not None and index.value is not None else ""
        return f"{what} has {count} entries: Python counts from 0, so the last is `[{count - 1}]`.{here}"
    return "Python counts from 0: a list of n entries has `[0]` to `[n - 1]`."


def _taken(stop: Stop, axis: int, size: int) -> tuple[ast.expr, ast.expr] | None:
    """The array and the index of the one place in a line where an axis of that size is indexed; None if unknown."""
    places = []
    for node in stop.expressions():
        shape = stop.shape(node.value) if isinstance(node, ast.Subscript) else None
        if not isinstance(node, ast.Subscript) or shape is None or len(shape) <= axis or shape[axis] != size:
            continue
        indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        if axis < len(indices) and not isinstance(indices[axis], ast.Slice):
            places.append((node.value, indices[axis]))
    return places[0] if len({ast.unparse(index) for _, index in places}) == 1 else None


def _made_by(stop: Stop, taken: tuple[ast.expr, ast.expr] | None) -> str:
    """The line that made an array; empty if it is not known."""
    line = "" if taken is None else stop.made.get(ast.unparse(taken[0]), "")
    return f", by `{line}`" if line and not line.startswith("for ") else ""


def too_many_indices(stop: Stop, found: re.Match[str]) -> str | None:
    """More indices than axes."""
    for node in stop.expressions():
        if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Tuple):
            shape = stop.shape(node.value)
            if shape is not None and len(shape) < len(node.slice.elts):
                owner, said = ast.unparse(node.value), f"`{ast.unparse(node.value)}` has shape {shape}"
                counted = re.search(r"\[(\d+)\](?!.*\[\d+\])", owner)
                asked = _from_zero(counted[1]) if counted else ""
                zeros = zeros_of_one_size(stop, owner)
                if len(shape) > 1:
                    return f"{said}: it takes {len(shape)} indices, not {len(node.slice.elts)}."
                row = _made_by_one_index(stop, owner)
                if row:
                    return f"{said}: {row}"
                takes = f"{said}: it is flat, and takes one index, not {len(node.slice.elts)}."
                return f"{takes}{asked or ' ' * bool(zeros) + zeros}"
    return "The array has fewer axes than indices in the brackets: look at its `.shape`."


def _made_by_one_index(stop: Stop, name: str) -> str:
    """That a flat array is one row of a table, as `data[n]` is; empty where its line does not show that."""
    tree = parsed_line(stop.made.get(name, ""))
    for node in [] if tree is None else ast.walk(tree):
        if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Name | ast.Constant):
            shape = stop.shape(node.value)
            if shape is not None and len(shape) == 2 and stop.shape(ast.Name(name)) == shape[1:]:
                table, index = ast.unparse(node.value), ast.unparse(node.slice)
                return (
                    f"`{table}[{index}]`, of which it is made, is row {index} alone. `{table}[{index}:]` is all rows "
                    f"from row {index} on."
                )
    return ""


def _from_zero(index: str) -> str:
    return f" (Python counts from 0: `[{index}]` is entry number {int(index) + 1}. Is that the one meant?)"


def called_array(stop: Stop, _: re.Match[str]) -> str | None:
    """Round brackets after an array."""
    for node in stop.expressions():
        if isinstance(node, ast.Call):
            thing = stop.things.get(ast.unparse(node.func))
            if isinstance(node.func, ast.BinOp) and (thing is None or thing.kind in ("number", "array")):
                name = ast.unparse(node.func)
                return f"A bracket right behind `({name})` calls it: a product needs its `*`."
            if thing is not None and thing.kind == "object":
                name = ast.unparse(node.func)
                return f"`{name}` is no function. What it can do are its methods, such as `{name}.name(...)`."
            if thing is not None and thing.kind in ("array", "list", "tuple", "number", "text", "dictionary"):
                name = ast.unparse(node.func)
                if thing.kind == "dictionary":
                    key = ast.unparse(node.args[0]) if node.args else '"key"'
                    return f"`{name}` is a dictionary: a key stands in square brackets, `{name}[{key}]`."
                if thing.kind == "number" and len(node.args) != 1:
                    return f"`{name}` is a number and no function: it takes no round brackets."
                if thing.kind == "number":
                    return _called_number(stop, node)
                if len(node.args) == 1 and _is_condition(stop, node.args[0]):
                    mask = ast.unparse(node.args[0])
                    return (
                        f"`{name}` is no function: round brackets call. The entries of `{name}` where a condition "
                        f"holds are taken with square brackets, `{name}[{mask}]`."
                    )
                if not all(_can_be_an_index(stop, one) for one in node.args):
                    return (
                        f"`{name}` {thing.said}, and is no function. Where it was handed over or assigned, hand over "
                        "the function by its name alone, `f`, and not what a call of it returns, `f(...)`."
                    )
                said = f"`{name}` is no function: round brackets call, square ones take entries, "
                entry = _entry_from_one(node)
                if entry:
                    as_written = f"{name}[{', '.join(map(ast.unparse, node.args))}]"
                    return (
                        f"{said}`{as_written}`, counted from 0. (MATLAB's `{ast.unparse(node)}` is `{name}[{entry}]`.)"
                    )
                return f"{said}`{name}[...]`, counted from 0."
    for node in stop.expressions():
        handed = node.args[:1] if isinstance(node, ast.Call) else []
        if handed and isinstance(handed[0], ast.Call) and isinstance(handed[0].func, ast.Name):
            return (
                f"`{ast.unparse(handed[0])}` is what that call returns. Where a function is asked for, hand over its "
                f"name alone, `{handed[0].func.id}`."
            )
    return "Round brackets call a function; entries are taken with square ones, `y[0]`."


def _called_number(stop: Stop, call: ast.Call) -> str:
    """Round brackets after a number: a product, or the index of a formula."""
    name, written = ast.unparse(call.func), ast.unparse(call)
    said = f"`{name}` is a number, and a bracket after it calls it:"
    index = ast.unparse(call.args[0])
    thing = stop.things.get(index)
    is_step = re.fullmatch(r"\w+( [-+] \d+)?", index) is not None and (thing is None or thing.is_whole)
    if is_step and re.match(r"[A-Za-z_]", index):
        holds = "the argument holds that value already" if name in stop.arguments else "the name alone is that value"
        return (
            f"{said} the value itself is `{name}`, a product is `{name} * (...)`. (`{written}` in a formula is the "
            f"value at that index: {holds}.)"
        )
    return f"{said} the value itself is `{name}`, and a product is `{name} * (...)`."


def _can_be_an_index(stop: Stop, part: ast.expr) -> bool:
    """Whether an expression can be an index: no array, text or fraction."""
    thing = stop.things.get(ast.unparse(part))
    is_number = thing is None or thing.is_whole
    return is_number and not (isinstance(part, ast.Constant) and isinstance(part.value, float | str))


def _is_condition(stop: Stop, part: ast.expr) -> bool:
    """Whether an expression is a comparison, several of them joined, or has the name of such a one."""
    tree = parsed_line(stop.made.get(part.id, "")) if isinstance(part, ast.Name) else None
    made = next((one.value for one in ast.walk(tree) if isinstance(one, ast.Assign)), part) if tree else part
    while isinstance(made, ast.BinOp) and isinstance(made.op, ast.BitAnd | ast.BitOr):
        made = made.left
    return isinstance(made, ast.Compare)


def _entry_from_one(call: ast.Call) -> str:
    """The indices in the brackets of a call, counted from 0 in place of 1; empty if they are no whole numbers."""
    indices = [one.value for one in call.args if isinstance(one, ast.Constant)]
    whole = [index for index in indices if type(index) is int and index > 0]
    return ", ".join(str(index - 1) for index in whole) if whole and len(whole) == len(call.args) else ""


def time_and_input(stop: Stop, _: re.Match[str]) -> str | None:
    """A time and an input of different lengths, handed to a function that simulates, or the input as the time."""
    for node in stop.expressions():
        if not (isinstance(node, ast.Call) and ast.unparse(node.func).endswith("response")):
            continue
        named = {one.arg: one.value for one in node.keywords}
        time = named.get("T", named.get("timepts", node.args[1] if len(node.args) > 1 else None))
        given = named.get("U", named.get("inputs", node.args[2] if len(node.args) > 2 else None))
        if time is not None and given is None:
            return (
                f"What comes second in `{ast.unparse(node.func)}(system, ...)` is the time, not the input. Name the "
                "input: `ct.forced_response(G, inputs=u)`."
            )
        shapes = [None if one is None else stop.shape(one) for one in (time, given)]
        if time is not None and given is not None and shapes[0] and shapes[1] and shapes[0][-1] != shapes[1][-1]:
            name, steps = ast.unparse(given), points_made(stop, time)
            return (
                f"The time `{ast.unparse(time)}` has {shapes[0][-1]} instants and the input `{name}` has "
                f"{shapes[1][-1]} samples: both must cover the same samples. {steps}{' ' * bool(steps)}(The time from "
                f"zero is `np.arange(len({name})) * Ts`.)"
            )
    return "The second argument is the time, evenly spaced, and the third the input: print the first values of each."


def truth_of_an_array(stop: Stop, _: re.Match[str]) -> str | None:
    """`if`, `while`, `and` or a chain of comparisons on arrays, or an array in the place of a number in a call."""
    tested = [(node, one) for node in _nodes(stop.line) for one in _tested(node)]
    for node, one in tested:
        if isinstance(node, ast.BoolOp) or (isinstance(node, ast.Compare) and len(node.ops) > 1):
            parts = node.values if isinstance(node, ast.BoolOp) else _chain(node)
            sign = "|" if isinstance(node, ast.BoolOp) and isinstance(node.op, ast.Or) else "&"
            word = "`or`" if sign == "|" else "`and`" if isinstance(node, ast.BoolOp) else "A chain of comparisons"
            whole = f" {sign} ".join(f"({ast.unparse(part)})" for part in parts)
            return (
                f"{word} asks for one True or False of each part, and a comparison of an array gives one for each "
                f"entry. Entry by entry it is `{whole}`."
            )
        chosen = ast.unparse(one) if isinstance(one, ast.Compare) else "condition"
        return (
            f"`if`, `while`, `and` and `or` need one True or False, and `{ast.unparse(one)}` gives one for each entry. "
            f"To choose entry by entry: `np.where({chosen}, a, b)`. One True or False of all: `np.any(...)`, "
            "`np.all(...)`, or the comparison of one entry."
        )
    if not any(isinstance(node, ast.Call) for node in stop.expressions()):
        return None
    return (
        "It arises within the function that is called: an array stands where that function takes one number or one "
        "True or False. Compare what is handed over with the arguments that it has, in their order (`help(...)`)."
    )


def _tested(node: ast.AST) -> list[ast.expr]:
    """What a statement or an expression asks to be True or False."""
    if isinstance(node, ast.BoolOp):
        return node.values
    if isinstance(node, ast.Compare):
        return [node] if len(node.ops) > 1 else []
    if isinstance(node, ast.If | ast.While | ast.IfExp | ast.Assert):
        return [] if isinstance(node.test, ast.BoolOp | ast.Compare) and _tested(node.test) else [node.test]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        return [node.operand]
    return node.ifs if isinstance(node, ast.comprehension) else []


def _chain(node: ast.Compare) -> list[ast.expr]:
    """The single comparisons of a chain."""
    sides = [node.left, *node.comparators]
    return [ast.Compare(one, [op], [other]) for one, op, other in zip(sides, node.ops, sides[1:], strict=False)]


def _nodes(line: str) -> list[ast.AST]:
    tree = parsed_line(line)
    return [] if tree is None else list(ast.walk(tree))


def unpacked(stop: Stop, found: re.Match[str]) -> str | None:
    """More or fewer names than parts."""
    if "Record" in stop.text:
        return "The parts of a record have names: `record.t`, `record.u`, `record.y`, `record.Ts`."
    if "NoneType" in stop.text:
        return "The right side is nothing (None): a function without `return` gives that."
    if "subplots" in stop.line:
        return (
            "`plt.subplots(2, 1)` returns two things, the figure and its axes: `fig, (ax_a, ax_b) = "
            "plt.subplots(2, 1)`."
        )
    for tree in filter(None, [parsed_line(stop.line)]):
        for node in ast.walk(tree):
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Tuple | ast.List):
                count, right = len(node.targets[0].elts), ast.unparse(node.value)
                shape = stop.shape(node.value)
                if shape and len(shape) == 2 and shape[1] == count != shape[0]:
                    return (
                        f"`{right}` is taken apart row by row, and has {shape[0]} rows: its {count} columns are "
                        f"`{right}[:, 0]` and so on, or the rows of `{right}.T`."
                    )
                if shape and shape[0] != count:
                    return f"`{right}` has {shape[0]} parts, and on the left of `=` stand {count} names."
                if isinstance(node.value, ast.Call):
                    said = _unpacked_call(stop, node.value, count)
                    if said:
                        return said
                thing = stop.things.get(right)
                if thing is not None and thing.kind in ("tuple", "list") and thing.shape and thing.shape[0] != count:
                    made = f", by `{stop.made[right]}`" if right in stop.made else ""
                    return f"`{right}` has {thing.shape[0]} parts{made}, and on the left of `=` stand {count} names."
    if not _takes_apart(stop):
        return "It arises within the function that is called: look at what is handed over to it."
    return "On the left of `=` there must be as many names as the right side has parts: print the right side first."


def _takes_apart(stop: Stop) -> bool:
    """Whether a line gives several names the parts of something."""
    head = re.match(r"\s*(?:for\s+)?[^=()]*,[^=()]*(?:=(?!=)|\bin\b)", stop.line)
    return head is not None or " for " in stop.line or "(" in stop.line.partition("=")[0]


def _unpacked_call(stop: Stop, call: ast.Call, count: int) -> str:
    """What a call returns that is taken apart; empty if that is not known."""
    called, handed = ast.unparse(call.func), ast.unparse(call.args[0]) if call.args else ""
    if called in ("np.size", "len") and handed:
        counted = "all entries" if called == "np.size" else "the rows"
        return f"`{called}({handed})` is one number, that of {counted}. Rows and columns are `{handed}.shape`."
    if called.endswith("lstsq"):
        return "`lstsq` returns four things: the solution is its first, `[0]`."
    got = re.search(r"got (\d+)", stop.text)
    made = stop.made.get(called, "")
    if made.startswith("return"):
        given = parsed_line(made)
        value = next((one.value for one in ast.walk(given) if isinstance(one, ast.Return)), None) if given else None
        number = len(value.elts) if isinstance(value, ast.Tuple) else 1
        if isinstance(value, ast.Call | ast.Starred) or number == count:
            return f"Print what `{called}` returns: it ends with `{made}`, and on the left of `=` stand {count} names."
        return (
            f"`{called}` ends with `{made}`, which is {number} thing{'s' * (number > 1)}; on the left of `=` stand "
            f"{count} names: as many must stand on both sides."
        )
    number = int(got[1]) if got else _PARTS.get(called.removeprefix("np.linalg."), 0)
    return f"`{called}` returns {number} things, and on the left of `=` stand {count} names." if number else ""


def unequal_spectra(stop: Stop, _: re.Match[str]) -> str | None:
    """Half of a spectrum beside the whole of one, or frequencies that are counted from the spectrum."""
    lines = " ".join((stop.line, *stop.made.values()))
    kinds = {name for name in ("fft", "rfft", "fftfreq", "rfftfreq") if re.search(rf"\b{name}\(", lines)}
    if kinds in ({"fft", "rfftfreq"}, {"rfft", "fftfreq"}):
        return (
            "`fft` and `fftfreq` have as many entries as there are samples, n; `rfft` and `rfftfreq` have those from "
            f"frequency zero up, n // 2 + 1. Here are {' and '.join(f'`{one}`' for one in sorted(kinds))}: take both "
            "with r, or both without."
        )
    if re.search(r"fftfreq\(\s*len\([^)]*fft\(", lines):
        return "`rfftfreq(n, Ts)` takes the number of samples, `len(e)`, and not that of the frequencies."
    return None
