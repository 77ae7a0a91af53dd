"""Causes of Python's errors that follow from the shapes of what stands in the line that stopped."""

import ast
import re

from labsid.checks.line_values import parsed_line
from labsid.checks.stops import Stop


def rows_by_a_vector(stop: Stop, _: re.Match[str]) -> str | None:
    """A number for each row, in a flat array."""
    for node in stop.operations(ast.Mult, ast.Div, ast.Add, ast.Sub):
        one, other = stop.shape(node.left), stop.shape(node.right)
        if one and other and len(one) == 2 and len(other) == 1 and one[0] == other[0]:
            name = ast.unparse(node.right)
            return (
                f"numpy matches shapes from the last axis: a flat array stands for one *row* of {one[1]}. "
                f"For one number "
                f"to each of the {one[0]} rows make it a column: `{name}[:, np.newaxis]`."
            )
    return None


def unequal_lengths(stop: Stop, _: re.Match[str]) -> str | None:
    """Two signals of different lengths, zeros that are added in place of joined, or a mean over the wrong axis."""
    if re.search(r"(zeros|ones)\([^()]*\) \+|\+ np\.(zeros|ones)\(", stop.line):
        return "`+` adds entry by entry. To put one array behind the other, join them: `np.concatenate([a, b])`."
    if "axis=1" in stop.line:
        return "`axis=1` makes one number of each *row*, `axis=0` one of each column: which are asked for?"
    for node in stop.operations(ast.Add, ast.Sub, ast.Mult, ast.Div):
        one, other = stop.shape(node.left), stop.shape(node.right)
        if one and other and len(one) == len(other) == 1:
            left, right = ast.unparse(node.left), ast.unparse(node.right)
            if 2 * min(one[0], other[0]) < max(one[0], other[0]):
                return (
                    f"`{left}` has {one[0]} entries and `{right}` has {other[0]}: entry by entry they do not pair up."
                )
            return (
                f"`{left}` has {one[0]} samples and `{right}` has {other[0]}. Both must cover the same samples: cut "
                "with the same slice."
            )
    return "Entry by entry, both need the same shape (an axis of length 1 fits any)."


def beyond_the_end(_: Stop, found: re.Match[str]) -> str | None:
    """An index that is the number of entries, or larger."""
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
                asked = (
                    f" Often here: is `[{counted[1]}]` counted from 1, as in MATLAB? The first is `[0]`."
                    if counted
                    else ""
                )
                return f"{said}: it is flat, and takes one index, not {len(node.slice.elts)}.{asked}"
    return "The array has fewer axes than indices in the brackets: look at its `.shape`."


def field_of_a_dictionary(stop: Stop, found: re.Match[str]) -> str | None:
    """A field taken as an attribute."""
    for node in stop.expressions():
        if isinstance(node, ast.Attribute) and node.attr == found[1]:
            owner = ast.unparse(node.value)
            thing = stop.things.get(owner)
            if thing is not None and found[1] in thing.keys:
                return f'`{owner}` is a dictionary: a field is a key of it, `{owner}["{found[1]}"]`.'
    return f'A dictionary has keys, not attributes: write `["{found[1]}"]` in place of `.{found[1]}`.'


def unknown_key(stop: Stop, found: re.Match[str]) -> str | None:
    """A key that a dictionary lacks."""
    for node in stop.expressions():
        if isinstance(node, ast.Subscript):
            thing = stop.things.get(ast.unparse(node.value))
            if thing is not None and thing.kind == "dictionary" and thing.keys:
                keys = ", ".join(f'"{key}"' for key in thing.keys)
                return f"`{ast.unparse(node.value)}` has the keys {keys}."
    return "The dictionary has no such key: print it with `print(list(name))`."


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
                    return f"`{name}` is a number: is a `*` missing before the bracket?"
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
    return "Round brackets call a function; entries are taken with square ones, `y[0]`. (Or has a variable its name?)"


def _entry_from_one(call: ast.Call) -> str:
    """The indices in the brackets of a call, counted from 0 in place of 1; empty if they are no whole numbers."""
    indices = [one.value for one in call.args if isinstance(one, ast.Constant)]
    whole = [index for index in indices if type(index) is int and index > 0]
    return ", ".join(str(index - 1) for index in whole) if whole and len(whole) == len(call.args) else ""


def several_indices(stop: Stop, _: re.Match[str]) -> str | None:
    """A list, a tuple or an array where an index is one number."""
    for node in stop.expressions():
        if isinstance(node, ast.Subscript):
            for part in ast.walk(node.slice):
                thing = stop.things.get(ast.unparse(part)) if isinstance(part, ast.Name) else None
                if thing is not None and (thing.kind in ("list", "tuple") or (thing.kind == "array" and thing.shape)):
                    name = ast.unparse(part)
                    entry = f"{name}[0][0]" if thing.lengths else f"{name}[0]"
                    return f"`{name}` {thing.said}, and an index is one number: take an entry, such as `{entry}`."
    return None


def reshaped(stop: Stop, found: re.Match[str]) -> str | None:
    """A shape that the entries do not fill, or a number in place of an argument."""
    fixed = [number for number in re.findall(r"\b\d+\b", found[2]) if re.search(rf"\b{number}\b", stop.line)]
    unused = [name for name in stop.arguments if not re.search(rf"\b{name}\b", stop.line)]
    if fixed and unused:
        names = " or ".join(f"`{name}`" for name in unused)
        return (
            f"The line has the number {fixed[0]} in it, whatever is handed over. Often here: should it "
            f"be the argument {names}?"
        )
    return f"{found[1]} entries do not fill that shape: the product of its sides must be {found[1]}."


def unequal_columns(stop: Stop, _: re.Match[str]) -> str | None:
    """Columns of different lengths side by side."""
    said = "Side by side, all need the same number of rows."
    if "block(" in stop.line:
        return (
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
            f"{said} One is empty. Often here: does its slice `x[a:b]` begin below zero? A negative a counts from the "
            "end: print it."
        )
    if ":" not in stop.line:
        return said
    return (
        f"{said} `y[a:b]` has b - a of them. Often here: does a slice drop samples at one end, and "
        f"no zeros and no other cut "
        "make up for them?"
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
        "one entry, `u[n] != u[0]`, or ask `np.any(...)` or `np.all(...)`."
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
    return "On the left of `=` there must be as many names as the right side has parts: print the right side first."
