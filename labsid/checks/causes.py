"""Causes of Python's errors that follow from the shapes of what stands in the line that stopped."""

import ast
import re

from labsid.checks.line_values import parsed_line
from labsid.checks.matrix_causes import unfit_blocks
from labsid.checks.stops import Stop
from labsid.checks.tables import zeros_of_one_size


def rows_by_a_vector(stop: Stop, _: re.Match[str]) -> str | None:
    """A number for each row, in a flat array."""
    for node in stop.operations(ast.Mult, ast.Div, ast.Add, ast.Sub):
        matrix_shape, vector_shape = stop.shape(node.left), stop.shape(node.right)
        if (
            matrix_shape
            and vector_shape
            and len(matrix_shape) == 2
            and len(vector_shape) == 1
            and matrix_shape[0] == vector_shape[0]
        ):
            name = ast.unparse(node.right)
            return (
                f"numpy matches shapes from the last axis: a flat array stands for one *row* of {matrix_shape[1]}. "
                f"For one number to each of the {matrix_shape[0]} rows make it a column: `{name}[:, np.newaxis]`."
            )
    turned = re.search(r"(\w+)\[(np\.newaxis|None),\s*:\]", stop.line)
    if turned is not None:
        return (
            f"`{turned[0]}` is one row. For one number to each row make a column of it: `{turned[1]}[:, {turned[2]}]`."
        )
    return None


def unequal_lengths(stop: Stop, _: re.Match[str]) -> str | None:
    """Two signals of different lengths, zeros that are added in place of joined, or a mean over the wrong axis."""
    if re.search(r"(zeros|ones)\([^()]*\) \+|\+ np\.(zeros|ones)\(", stop.line):
        return "`+` adds entry by entry. To put one array behind the other, join them: `np.concatenate([a, b])`."
    if "axis=0" in stop.line:
        return "`axis=0` makes one number of each column, `axis=1` one of each row."
    if "axis=1" in stop.line:
        return "`axis=1` makes one number of each *row*, `axis=0` one of each column."
    joined = re.search(r"np\.convolve\((\w+), (\w+)\)", " ".join((stop.line, *stop.made.values())))
    if joined is not None:
        a, b = joined.groups()
        return f"`{joined[0]}` has len({a}) + len({b}) - 1 entries: keep the first, `{joined[0]}[: len({b})]`."
    for node in stop.operations(ast.Add, ast.Sub, ast.Mult, ast.Div):
        left_shape, right_shape = stop.shape(node.left), stop.shape(node.right)
        if left_shape and right_shape and len(left_shape) == len(right_shape) == 1:
            left, right = ast.unparse(node.left), ast.unparse(node.right)
            (n_left,), (n_right,) = left_shape, right_shape
            if 2 * min(n_left, n_right) < max(n_left, n_right):
                return f"`{left}` has {n_left} entries and `{right}` has {n_right}: entry by entry they do not pair up."
            return (
                f"`{left}` has {n_left} samples and `{right}` has {n_right}. Both must cover the same samples: cut "
                "with the same slice."
            )
    return "Entry by entry, both need the same shape (an axis of length 1 fits any)."


def beyond_the_end(stop: Stop, found: re.Match[str]) -> str | None:
    """An index that is the number of entries, or larger."""
    counted = next((made for made in (stop.line, *stop.made.values()) if "digitize(" in made), "")
    if counted:
        return f"`np.digitize` counts its cells from 1, in `{counted}`, and Python its entries from 0: take 1 off."
    index, size = int(found[1]), int(found[2])
    if size == 0:
        return "It is empty along that axis: a slice before it took nothing. Print its shape."
    if index == size:
        return f"Python counts from 0: {size} entries have the indices 0 to {size - 1}, the last is `[-1]`."
    return f"There are {size} entries, with the indices 0 to {size - 1}."


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
                takes = f"{said}: it is flat, and takes one index, not {len(node.slice.elts)}."
                return f"{takes}{asked or ' ' * bool(zeros) + zeros}"
    return "The array has fewer axes than indices in the brackets: look at its `.shape`."


def _from_zero(index: str) -> str:
    return f" (Python counts from 0: `[{index}]` is entry number {int(index) + 1}, and the first is `[0]`.)"


def called_array(stop: Stop, _: re.Match[str]) -> str | None:
    """Round brackets after an array."""
    for node in stop.expressions():
        if isinstance(node, ast.Call):
            thing = stop.things.get(ast.unparse(node.func))
            if thing is not None and thing.kind in ("array", "list", "tuple", "number", "text", "dictionary"):
                name = ast.unparse(node.func)
                if thing.kind == "dictionary":
                    key = ast.unparse(node.args[0]) if node.args else '"key"'
                    return f"`{name}` is a dictionary: a key stands in square brackets, `{name}[{key}]`."
                if thing.kind == "number":
                    return f"`{name}` is a number, and a bracket after it calls it: a product is `{name} * (...)`."
                said = f"`{name}` is no function: round brackets call, square ones take entries, "
                entry = _entry_from_one(node)
                if entry:
                    return f"{said}counted from 0. MATLAB's `{ast.unparse(node)}` is `{name}[{entry}]`."
                return f"{said}`{name}[...]`, counted from 0."
    for node in stop.expressions():
        handed = node.args[:1] if isinstance(node, ast.Call) else []
        if handed and isinstance(handed[0], ast.Call) and isinstance(handed[0].func, ast.Name):
            return (
                f"`{ast.unparse(handed[0])}` is what that call returns. Where a function is asked for, hand over its "
                f"name alone, `{handed[0].func.id}`."
            )
    return "Round brackets call a function; entries are taken with square ones, `y[0]`."


def _entry_from_one(call: ast.Call) -> str:
    """The indices in the brackets of a call, counted from 0 in place of 1; empty if they are no whole numbers."""
    indices = [one.value for one in call.args if isinstance(one, ast.Constant)]
    whole = [index for index in indices if type(index) is int and index > 0]
    return ", ".join(str(index - 1) for index in whole) if whole and len(whole) == len(call.args) else ""


def reshaped(stop: Stop, found: re.Match[str]) -> str | None:
    """A shape that the entries do not fill, or a number in place of an argument."""
    fixed = [number for number in re.findall(r"\b\d+\b", found[2]) if re.search(rf"\b{number}\b", stop.line)]
    unused = [name for name in stop.arguments if not re.search(rf"\b{name}\b", stop.line)]
    if fixed and unused:
        names = " or ".join(f"`{name}`" for name in unused)
        return (
            f"The line has the number {fixed[0]} in it, whatever is handed over, and does not use the argument {names}."
        )
    return f"{found[1]} entries do not fill that shape: the product of its sides must be {found[1]}."


def unequal_columns(stop: Stop, _: re.Match[str]) -> str | None:
    """Columns of different lengths side by side."""
    said = "Side by side, all need the same number of rows."
    if "block(" in stop.line:
        return unfit_blocks(stop) or (
            f"{said} In `np.block` a number is a block of 1 by 1, which fits only beside blocks of one row: an empty "
            "corner is `np.zeros((rows, columns))`."
        )
    lengths = [length for thing in stop.things.values() for length in thing.lengths or ()]
    if len(set(lengths)) > 1:
        said += f" Here these are {', '.join(map(str, lengths))}."
    to_minus = re.search(r"\[:\s*-\s*(\w+)\]", stop.line)
    if to_minus is not None and "has size 0" in stop.text:
        k = to_minus[1]
        return (
            f"{said} One is empty: with {k} = 0, `{to_minus[0]}` takes nothing. `[: len(x) - {k}]` is right there, too."
        )
    if 0 in lengths:
        return (
            f"{said} One is empty, as a slice `x[a:b]` can be whose a is below zero: it counts from the end. Print a."
        )
    if ":" not in stop.line:
        return said
    return (
        f"{said} `y[a:b]` has b - a of them. Each column is cut so that this difference is the same, or begins with as "
        "many zeros as its slice drops samples."
    )


def time_and_input(stop: Stop, _: re.Match[str]) -> str | None:
    """A time and an input of different lengths, handed to a function that simulates."""
    for node in stop.expressions():
        if isinstance(node, ast.Call) and len(node.args) > 2:
            time, given = (stop.shape(part) for part in node.args[1:3])
            if time and given and time[-1] != given[-1]:
                name = ast.unparse(node.args[2])
                return (
                    f"The time has {time[-1]} instants and the input {given[-1]} samples: each sample needs its own, "
                    f"such as `np.arange(len({name})) * Ts`."
                )
    return None


def truth_of_an_array(stop: Stop, _: re.Match[str]) -> str | None:
    """`if` or `while` on an array."""
    return (
        "`if`, `while`, `and` and `or` need one True or False, and a comparison of an array gives "
        "one for each entry. Compare "
        "one entry, `u[n] != u[0]`, or ask `np.any(...)` or `np.all(...)`. (To choose entry by "
        "entry: `np.where(condition, a, b)`.)"
    )


def unpacked(stop: Stop, found: re.Match[str]) -> str | None:
    """More or fewer names than parts."""
    if "Record" in stop.text:
        return "The parts of a record have names: `record.t`, `record.u`, `record.y`, `record.Ts`."
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
    return "" if got is None else f"`{called}` returns {got[1]} things, and on the left of `=` stand {count} names."


def unequal_spectra(stop: Stop, _: re.Match[str]) -> str | None:
    """Half of a spectrum beside the whole of one, or frequencies that are counted from the spectrum."""
    lines = " ".join((stop.line, *stop.made.values()))
    kinds = {name for name in ("fft", "rfft", "fftfreq", "rfftfreq") if re.search(rf"\b{name}\(", lines)}
    if kinds in ({"fft", "rfftfreq"}, {"rfft", "fftfreq"}):
        return (
            "`fft` and `fftfreq` have as many entries as there are samples, n; `rfft` and `rfftfreq` have those from "
            f"frequency zero up, n // 2 + 1. Here are {' and '.join(f'`{kind}`' for kind in sorted(kinds))}: take both "
            "with r, or both without."
        )
    if re.search(r"fftfreq\(\s*len\([^)]*fft\(", lines):
        return "`rfftfreq(n, Ts)` takes the number of samples, `len(e)`, and not that of the frequencies."
    return None
