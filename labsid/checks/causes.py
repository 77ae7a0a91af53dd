"""Causes of Python's errors that follow from the shapes of what stands in the line that stopped."""

import ast
import re
from collections.abc import Iterator

from labsid.checks.stops import Stop


def _operations(stop: Stop, *kinds: type[ast.operator]) -> Iterator[ast.BinOp]:
    for node in stop.expressions():
        if isinstance(node, ast.BinOp) and isinstance(node.op, kinds):
            yield node


def entry_by_entry(stop: Stop, _: re.Match[str]) -> str | None:
    """`*` where the shapes fit a matrix product."""
    for node in _operations(stop, ast.Mult):
        one, other = stop.shape(node.left), stop.shape(node.right)
        if one and other and one != other and one[-1] == other[0]:
            left, right = ast.unparse(node.left), ast.unparse(node.right)
            return f"`*` multiplies entry by entry. The product of the matrices is `{left} @ {right}`, which fits."
    return None


def rows_by_a_vector(stop: Stop, _: re.Match[str]) -> str | None:
    """A number for each row, in a flat array."""
    for node in _operations(stop, ast.Mult, ast.Div, ast.Add, ast.Sub):
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
    """Two signals of different lengths."""
    for node in _operations(stop, ast.Add, ast.Sub, ast.Mult, ast.Div):
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


def number_in_a_product(stop: Stop, _: re.Match[str]) -> str | None:
    """`@` with a number on one side."""
    for node in _operations(stop, ast.MatMult):
        for side in (node.left, node.right):
            thing = stop.things.get(ast.unparse(side))
            alone = thing is not None and (thing.kind == "number" or thing.shape == ())
            if alone or isinstance(side, ast.Constant):
                return (
                    f"`@` is the product of arrays, and `{ast.unparse(side)}` is one number: a multiple is made by `*`."
                )
    return "`@` is the product of arrays; one of the two is a number. A multiple is made by `*`."


def unfit_product(stop: Stop, _: re.Match[str]) -> str | None:
    """`@` between shapes that do not fit."""
    for node in _operations(stop, ast.MatMult):
        one, other = stop.shape(node.left), stop.shape(node.right)
        if not one or not other or one[-1] == other[0]:
            continue
        left, right = ast.unparse(node.left), ast.unparse(node.right)
        empty = next((text for text, shape in ((left, one), (right, other)) if 0 in shape), "")
        if ":-" in empty.replace(" ", ""):
            return f"`{empty}` is empty: `[:-0]` takes nothing. `[: len(x) - k]` is right for k = 0, too."
        said = (
            f"In `{left} @ {right}` the first has {one[-1]} columns and the second {other[0]} rows: "
            f"these must be equal."
        )
        if "inv(" in left:
            return " ".join(filter(None, (said, _without_inverse(stop))))
        if one[0] == other[0] and re.fullmatch(r"\w+(\.T)?", left):
            turned = left[:-2] if left.endswith(".T") else f"{left}.T"
            return f"{said} Is `{turned} @ {right}` meant?"
        return said
    return "In `A @ B` the columns of A must be as many as the rows of B. Is a transpose, `.T`, missing or too many?"


def unfit_right_side(stop: Stop, _: re.Match[str]) -> str | None:
    """`solve` with a right-hand side of another length."""
    for node in stop.expressions():
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("solve") and len(node.args) == 2:
            left, right = (stop.shape(part) for part in node.args)
            if left and right and left[0] != right[0]:
                A, b = map(ast.unparse, node.args)
                said = (
                    f"`solve(A, b)` solves A x = b: A, here `{A}`, has {left[0]} rows, and b, here `{b}`, has "
                    f"{right[0]}."
                )
                inner = node.args[0]
                if isinstance(inner, ast.BinOp) and isinstance(inner.op, ast.MatMult):
                    first = stop.shape(inner.left)
                    if first and len(first) == 2 and first[1] == right[0]:
                        said += (
                            f" The right-hand side of the normal equations is multiplied, too: "
                            f"`{ast.unparse(inner.left)} @ {b}`."
                        )
                return said
    return "`solve(A, b)` needs as many entries in b as A has rows: is the right-hand side of the equations complete?"


def _without_inverse(stop: Stop) -> str:
    """A product in the line that cannot have an inverse, by its shapes; empty if there is none."""
    for node in _operations(stop, ast.MatMult):
        one, other = stop.shape(node.left), stop.shape(node.right)
        if one and other and len(one) == len(other) == 2 and one[0] == other[1] > one[1]:
            left, right = ast.unparse(node.left), ast.unparse(node.right)
            return (
                f"`{left} @ {right}` is {one[0]} by {one[0]}, but of rank {one[1]} at most: it never has an inverse. "
                f"`{right} @ {left}` is {one[1]} by {one[1]}."
            )
    return ""


def product_without_inverse(stop: Stop, _: re.Match[str]) -> str | None:
    """A product that is singular by its shapes, or dependent columns."""
    return _without_inverse(stop) or (
        "The matrix has no inverse: its columns are dependent. Often here: is a column of Phi "
        "zero, or there twice, or is "
        "the wrong factor transposed?"
    )


def not_square(stop: Stop, _: re.Match[str]) -> str | None:
    """The inverse of a tall matrix."""
    for node in stop.expressions():
        if isinstance(node, ast.Call) and node.args and ast.unparse(node.func).endswith(("inv", "solve", "det")):
            shape, name = stop.shape(node.args[0]), ast.unparse(node.args[0])
            if shape and len(shape) == 2 and shape[0] != shape[1]:
                return (
                    f"`{name}` is {shape[0]} by {shape[1]}; only a square matrix has an inverse. Least squares inverts "
                    f"`{name}.T @ {name}`, or use `np.linalg.lstsq({name}, ...)[0]`."
                )
    return "Only a square matrix has an inverse: least squares inverts Phi'Phi, not Phi."


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
                said = (
                    f"`{name}` is no function: round brackets call, square ones take entries, `{name}[...]`, "
                    f"counted from 0."
                )
                return said if thing.kind != "number" else f"`{name}` is a number: is a `*` missing before the bracket?"
    return "Round brackets call a function; entries are taken with square ones, `y[0]`. (Or has a variable its name?)"


def several_indices(stop: Stop, _: re.Match[str]) -> str | None:
    """A list, a tuple or an array where an index is one number."""
    for node in stop.expressions():
        if isinstance(node, ast.Subscript):
            for part in ast.walk(node.slice):
                thing = stop.things.get(ast.unparse(part)) if isinstance(part, ast.Name) else None
                if thing is not None and (thing.kind in ("list", "tuple") or (thing.kind == "array" and thing.shape)):
                    name = ast.unparse(part)
                    return f"`{name}` {thing.said}, and an index is one number: take an entry, such as `{name}[0]`."
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
    for thing in stop.things.values():
        if thing.lengths and len(set(thing.lengths)) > 1:
            said += f" Here these are {', '.join(map(str, thing.lengths))}."
            break
    return (
        f"{said} `y[a:b]` has b - a of them. Often here: does a slice drop samples at one end, and "
        f"no zeros and no other cut "
        "make up for them?"
    )


def truth_of_an_array(stop: Stop, _: re.Match[str]) -> str | None:
    """`if` or `while` on an array."""
    return (
        "`if`, `while`, `and` and `or` need one True or False, and a comparison of an array gives "
        "one for each entry. Compare "
        "one entry, `u[n] != u[0]`, or ask `np.any(...)` or `np.all(...)`."
    )


def unpacked(stop: Stop, found: re.Match[str]) -> str | None:
    """More or fewer names than parts."""
    if "subplots" in stop.line:
        return (
            "`plt.subplots(2, 1)` returns two things, the figure and its axes: `fig, (ax_a, ax_b) = "
            "plt.subplots(2, 1)`."
        )
    return "On the left of `=` there must be as many names as the right side has parts: print the right side first."
