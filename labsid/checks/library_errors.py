"""Causes of errors in the functions of numpy, scipy, python-control and matplotlib, by what they are given."""

import ast
import re
from collections.abc import Iterator

from labsid.checks.argument_orders import turned_polynomial
from labsid.checks.line_values import parsed_line
from labsid.checks.operands import shapes_in
from labsid.checks.stops import Stop

WITHIN = "It arises within the function that is called: look at what is handed over to it, and in which order."
"""Where the line does not tell more."""


def appended_to_an_array(stop: Stop, _: re.Match[str]) -> str:
    """The method of lists on an array: rows or numbers are to be added."""
    tree = parsed_line(stop.line)  # the part that failed is the method without its argument
    for node in [] if tree is None else ast.walk(tree):
        method = node.func if isinstance(node, ast.Call) else None
        if isinstance(method, ast.Attribute) and method.attr == "append" and len(node.args) == 1:  # type: ignore[attr-defined]
            owner, added = ast.unparse(method.value), ast.unparse(node.args[0])  # type: ignore[attr-defined]
            shape = stop.shape(method.value)
            as_list = (
                f"Begin with a list, `{owner} = []`, append to it, and make an array of it behind the loop, "
                f"`{owner} = np.array({owner})`."
            )
            if shape is not None and len(shape) == 2:
                return (
                    f"{as_list} (Or set each row below: `{owner} = np.vstack([{owner}, {added}])`. `np.append` without "
                    "`axis=0` would make it flat.)"
                )
            return f"{as_list} (Or `{owner} = np.append({owner}, {added})`, which makes a new array each time.)"
    return "Begin with a list, `[]`, append to it, and make an array of it behind the loop with `np.array`."


def uneven_parts(stop: Stop, _: re.Match[str]) -> str | None:
    """A list whose parts have different lengths, where it is to become an array."""
    for node in stop.expressions():
        if not isinstance(node, ast.List | ast.Tuple) or len(node.elts) < 2:
            continue
        written = ast.unparse(node)
        if all(isinstance(row, ast.List) for row in node.elts):
            lengths = [len(row.elts) for row in node.elts if isinstance(row, ast.List)]
            if len(set(lengths)) > 1:
                return f"The rows of `{written}` have {_listed(lengths)} entries: these must be equal."
            blocks = _matrices_in(stop, node)
            if blocks:
                return (
                    f"{blocks}, and `np.array` puts no matrices together: `np.block({written})` does. (All in one row "
                    "need as many rows, and all in one column as many columns.)"
                )
        shapes = [_shape(stop, part) for part in node.elts]
        known = [(part, shape) for part, shape in zip(node.elts, shapes, strict=True) if shape is not None]
        arrays = [(part, shape) for part, shape in known if shape]
        if arrays and any(shape == () for _, shape in known):
            part, shape = arrays[0]
            name = ast.unparse(part)
            return (
                f"In `{written}`, `{name}` is an array of shape {shape} among numbers. `*{name}` puts each of its "
                "entries into the list."
            )
        if len(arrays) == len(node.elts) and len({shape for _, shape in arrays}) > 1:
            lengths = [shape[0] for _, shape in arrays]
            if len({*lengths}) == 1 or any(len(shape) > 1 for _, shape in arrays):
                have = " and ".join(str(shape) for _, shape in arrays)
                return (
                    f"The parts of `{written}` have the shapes {have}, and to be parts of one array they must be "
                    "equal: `np.hstack` puts matrices side by side, `np.vstack` one below the other."
                )
            return (
                f"The parts of `{written}` have {_listed(lengths)} entries: as rows of one array they must be equal. "
                "(`np.concatenate` puts them end to end.)"
            )
    return "What is to become one array has parts of different lengths: print the shape of each part."


def _matrices_in(stop: Stop, rows: ast.List | ast.Tuple) -> str:
    """Which parts of a list of lists are matrices; empty if none is."""
    parts = (part for row in rows.elts if isinstance(row, ast.List) for part in row.elts)
    found = [(ast.unparse(part), shape) for part in parts if len(shape := _shape(stop, part) or ()) == 2]
    if not found:
        return ""
    named = " and ".join(f"`{part}`" for part, _ in found[:2])
    return f"{named} {'are matrices' if len(found) > 1 else 'is a matrix'}"


def _shape(stop: Stop, part: ast.expr) -> tuple[int, ...] | None:
    if isinstance(part, ast.Constant) and type(part.value) in (int, float):
        return ()
    if isinstance(part, ast.UnaryOp):
        return _shape(stop, part.operand)
    thing = stop.things.get(ast.unparse(part))
    return () if thing is not None and thing.kind == "number" else stop.shape(part)


def _listed(numbers: list[int]) -> str:
    return f"{', '.join(map(str, numbers[:-1]))} and {numbers[-1]}"


def unequal_curves(stop: Stop, _: re.Match[str]) -> str | None:
    """A curve whose two vectors differ in length, or a table that is drawn column by column."""
    call = next((node for node in stop.expressions() if isinstance(node, ast.Call) and len(node.args) > 1), None)
    shapes = shapes_in(stop.text)
    names = [ast.unparse(part) for part in call.args[:2]] if call is not None else ["x", "y"]
    if len(shapes) == 2 and len(shapes[1]) == 2 and shapes[1][1] == shapes[0][0] != shapes[1][0]:
        return (
            f"`{names[1]}` has {shapes[1][0]} rows, and a table is drawn column by column. Draw each row as a curve of "
            "its own, or hand over its transpose."
        )
    if len(shapes) == 2:
        turned = "" if call is None else turned_polynomial(stop, call.args[1], shapes[0])
        return turned or (
            f"The two vectors of a curve need the same length: `{names[0]}` has {shapes[0][0]} entries and "
            f"`{names[1]}` has {shapes[1][0]}."
        )
    return "The two vectors of a curve need the same length."


def unequal_weights(stop: Stop, _: re.Match[str]) -> str | None:
    """Another number of weights than of values."""
    for node in _calls(stop):
        weights = next((one.value for one in node.keywords if one.arg == "weights"), None)
        shapes = [stop.shape(part) for part in (*node.args[:1], *([] if weights is None else [weights]))]
        if weights is not None and len(shapes) == 2 and all(shapes) and node.args:
            (n, m), (x, w) = shapes, map(ast.unparse, (node.args[0], weights))
            return f"Each value needs one weight: `{x}` has shape {n} and `{w}` {m}."
    if re.search(r"\bfft\.", " ".join((stop.line, *stop.made.values()))):
        return (
            "Each frequency needs one weight. `np.fft.rfft(e)` has len(e) // 2 + 1 values, as many as "
            "`np.fft.rfftfreq(len(e), Ts)`."
        )
    return "Each value needs one weight: print the shapes of both."


def unequal_mask(stop: Stop, found: re.Match[str]) -> str | None:
    """A mask that is longer or shorter than the axis from which it chooses."""
    axis, size, given = map(int, found.groups())
    for node in stop.expressions():
        if not isinstance(node, ast.Subscript):
            continue
        parts = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        shape = stop.shape(node.value)
        if shape is not None and len(shape) > axis and shape[axis] == size and axis < len(parts):
            mask = ast.unparse(parts[axis])
            made = f", by `{stop.made[mask]}`" if mask in stop.made else ""
            return (
                f"A mask holds one True or False for each entry along its axis: axis {axis} of "
                f"`{ast.unparse(node.value)}` has {size}, and `{mask}` has {given}{made}."
            )
    return f"A mask holds one True or False for each entry along its axis: here {size} entries and {given} in the mask."


def number_beside_a_table(stop: Stop, _: re.Match[str]) -> str | None:
    """A number in a list with tables that are to be joined."""
    for node in stop.expressions():
        parts = node.elts if isinstance(node, ast.List | ast.Tuple) else []
        number = next((part for part in parts if _shape(stop, part) == () or isinstance(part, ast.Constant)), None)
        if number is not None and any(len(_shape(stop, part) or ()) == 2 for part in parts):
            name = ast.unparse(number)
            return (
                f"`{name}` is one number, and stands beside a table: as a table of one row and one column it is "
                f"`[[{name}]]`."
            )
    return None


def number_among_arrays(stop: Stop, _: re.Match[str]) -> str | None:
    """A number in a list of arrays that are to be joined."""
    for node in stop.expressions():
        for part in node.elts if isinstance(node, ast.List | ast.Tuple) else ():
            if _shape(stop, part) == ():
                name = ast.unparse(part)
                return f"`{name}` is one number, and arrays are joined: an array of one entry is `[{name}]`."
    return "One of the parts is a number, and arrays are joined: an array of one entry is `[x]`."


def index_of_a_dictionary(stop: Stop, _: re.Match[str]) -> str | None:
    """A slice in the brackets of a dictionary."""
    for node in stop.expressions():
        thing = stop.things.get(ast.unparse(node.value)) if isinstance(node, ast.Subscript) else None
        if isinstance(node, ast.Subscript) and thing is not None and thing.kind == "dictionary":
            keys = ", ".join(f'"{key}"' for key in thing.keys)
            return (
                f"`{ast.unparse(node.value)}` is a dictionary, with the keys {keys}: take one of them before you slice."
            )
    return "A dictionary takes a key in its brackets, and no slice."


def function_for_numbers(stop: Stop, _: re.Match[str]) -> str | None:
    """A function, a list or a dictionary where numbers are read."""
    for node in _calls(stop):
        for part in node.args:
            thing = stop.things.get(ast.unparse(part))
            if thing is not None and thing.kind == "function":
                name = ast.unparse(part)
                handed = " It was handed over: look at the order of the arguments." if name in stop.arguments else ""
                return f"`{name}` is a function, and numbers are asked for.{handed}"
    return None


def list_for_a_number(stop: Stop, _: re.Match[str]) -> str | None:
    """A list where a function takes one number."""
    for node in _calls(stop):
        for part in node.args:
            thing = stop.things.get(ast.unparse(part))
            if isinstance(part, ast.List) or (thing is not None and thing.kind in ("list", "tuple")):
                name, called = ast.unparse(part), ast.unparse(node.func)
                return (
                    f"`{called}` takes one number there, and `{name}` is a list. `help({called})` tells its arguments."
                )
    return WITHIN


def coefficients(stop: Stop, _: re.Match[str]) -> str | None:
    """Coefficients of a transfer function that are no flat lists of numbers."""
    for node in _calls(stop):
        for part in node.args[:2] if ast.unparse(node.func).endswith(("tf", "TransferFunction")) else ():
            inner = part.elts if isinstance(part, ast.List) else []
            nested = next((one for one in inner if isinstance(one, ast.List) or stop.shape(one)), None)
            if nested is not None:
                written, one = ast.unparse(part), ast.unparse(nested)
                if isinstance(nested, ast.List):
                    return (
                        f"In `{written}`, `{one}` is a list within a list, which stands for one of several outputs. "
                        "The coefficients of one polynomial are one flat list, `[1, 2]`."
                    )
                return (
                    f"In `{written}`, `{one}` is an array, of shape {stop.shape(nested)}, among numbers. The "
                    "coefficients of a polynomial are one flat list of numbers."
                )
    return "`ct.tf(num, den, Ts)` takes two flat lists of coefficients, `[1, 2]`, and the sampling time."


def unknown_keyword(stop: Stop, _: re.Match[str]) -> str | None:
    """A keyword that a function of python-control does not have."""
    call = next((node for node in _calls(stop) if node.keywords), None)
    if call is None:
        return None
    called, given = ast.unparse(call.func), ", ".join(f"`{one.arg}`" for one in call.keywords)
    if called.endswith(("tf", "ss", "TransferFunction", "StateSpace")):
        return f"`{called}` has no keyword {given}: the sampling time is its last argument, or the keyword `dt`."
    return f"`{called}` has no keyword {given}: `help({called})` lists its arguments."


def start_of_a_search(stop: Stop, _: re.Match[str]) -> str | None:
    """A start from which a search cannot begin."""
    for node in _calls(stop):
        if len(node.args) > 1 and ast.unparse(node.func).rpartition(".")[2] in ("least_squares", "minimize"):
            start = ast.unparse(node.args[1])
            shape = stop.shape(node.args[1])
            if "dimension" in stop.text and shape is not None:
                return (
                    f"The search begins from one flat array of numbers, one for each parameter; `{start}` has shape "
                    f"{shape}."
                )
            if "dimension" in stop.text:
                return f"The search begins from one flat list of numbers, `[a, b]`: `{start}` is none."
            if "finite" in stop.text:
                return (
                    f"At the start, `{start}`, the model gives nan or inf, as a division by zero or the logarithm of a "
                    "number that is not positive does: print it there, and begin elsewhere."
                )
    return "The search cannot begin there: print the start, and what the model gives at it."


def arguments_of_a_filter(stop: Stop, _: re.Match[str]) -> str | None:
    """One number where `lfilter` takes the signal, by the order in which its arguments are handed over."""
    for node in _calls(stop):
        if ast.unparse(node.func).rpartition(".")[2] in ("lfilter", "filtfilt") and len(node.args) > 2:
            b, a, x = map(ast.unparse, node.args[:3])
            return (
                "`lfilter(b, a, x)` takes all coefficients of the numerator first, in one list, then all of the "
                f"denominator, and third the signal: here these are `{b}`, `{a}` and `{x}`."
            )
    return None


def _calls(stop: Stop) -> Iterator[ast.Call]:
    yield from (node for node in stop.expressions() if isinstance(node, ast.Call))


def shape_of_zeros(stop: Stop, _: re.Match[str]) -> str | None:
    """The sizes of an array of zeros, handed over one by one."""
    tree = parsed_line(stop.part or stop.line)
    for node in [] if tree is None else ast.walk(tree):
        if isinstance(node, ast.Call) and len(node.args) > 1:
            name = ast.unparse(node.func)
            if name.rpartition(".")[2] in ("zeros", "ones", "empty", "random", "standard_normal"):
                handed = ", ".join(map(ast.unparse, node.args))
                return f"The shape is one argument, in brackets of its own: `{name}(({handed}))`."
    return None
