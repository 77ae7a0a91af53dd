"""Python's errors, explained: what stands in the line that stopped, and what usually causes such an error here.

A cause is stated where the shapes or the text of the line prove it, else it is asked. The notebook's check, the clean
run of ``labsid submit`` and the feedback page all say what `explain` returns.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass

from labsid.checks.causes import (
    beyond_the_end,
    called_array,
    field_of_a_dictionary,
    reshaped,
    rows_by_a_vector,
    several_indices,
    time_and_input,
    too_many_indices,
    truth_of_an_array,
    unequal_columns,
    unequal_lengths,
    unknown_key,
    unpacked,
)
from labsid.checks.matlab_syntax import cause_of_syntax, cause_of_unknown_name
from labsid.checks.matrix_causes import (
    entry_by_entry,
    flat_matrix,
    flat_state_space,
    not_square,
    number_in_a_product,
    product_without_inverse,
    unfit_product,
    unfit_right_side,
)
from labsid.checks.stops import Stop

Cause = Callable[[Stop, re.Match[str]], str | None]
_MOST_NAMES = 5


@dataclass(frozen=True, slots=True)
class Translation:
    """A kind of error.

    Attributes
    ----------
    kind, text : str
        Patterns of its kind and of its message.
    cause : str or callable
        What causes it; a function may return None, and the next translation is tried.
    """

    kind: str
    text: str
    cause: str | Cause


def told(stop: Stop, where: str, made_by: Callable[[str], str] | None = None) -> str:
    """The whole message: Python's own line, where it stopped, what stands there, and the cause.

    Parameters
    ----------
    stop : Stop
    where : str
        What stopped, such as "the answer cell" or "`fit`".
    made_by : callable, optional
        For a name that is not defined, ``made_by(name)`` says which cells define it.
    """
    line = f", in line {stop.number}" if stop.number else ""
    quoted = f": `{stop.line}`" if stop.line else ""
    first = f"{where} stopped with {f'{stop.kind}: {stop.text}'.rstrip('.: ')}{line}{quoted}."
    return f"{first} {details(stop, made_by)}".rstrip()


def details(stop: Stop, made_by: Callable[[str], str] | None = None) -> str:
    """What stands in the line, and the cause; empty if nothing is known."""
    present = ", ".join(f"`{name}` {thing}" for name, thing in _present(stop))
    return " ".join(filter(None, (f"There {present}." if present else "", explain(stop, made_by))))


def explain(stop: Stop, made_by: Callable[[str], str] | None = None) -> str:
    """The usual cause of an error; empty if none is known."""
    if stop.kind in ("SyntaxError", "IndentationError", "TabError"):
        return cause_of_syntax(stop)
    if stop.kind == "NameError":
        found = re.search(r"name '(\w+)' is not defined", stop.text)
        return "" if found is None else cause_of_unknown_name(found[1], stop, made_by)
    for one in TABLE:
        found = re.search(one.text, stop.text) if re.fullmatch(one.kind, stop.kind) else None
        if found is not None:
            cause = one.cause if isinstance(one.cause, str) else one.cause(stop, found)
            if cause is not None:
                return cause
    return ""


def _present(stop: Stop) -> list[tuple[str, str]]:
    """The variables of the line with what they are, in the order in which they stand there."""
    names = dict.fromkeys(re.findall(r"(?<![\w.\"'])[A-Za-z_]\w*", stop.line))
    shown = [
        (name, stop.things[name].said + (" (the notebook's own, no argument)" if name in stop.outside else ""))
        for name in names
        if name in stop.things and stop.things[name].kind not in ("function", "module", "object")
    ]
    return shown[:_MOST_NAMES]


_FLAT_BESIDE_COLUMN = (
    "One is a column, (N, 1), and one is flat, (N,). Make them alike: `.reshape(-1, 1)` makes "
    "a column, `.ravel()` a flat "
    "array. (`np.column_stack` takes both.)"
)
_WHOLE = "An index, a size or a count must be a whole number: `/` always gives a float, `//` a whole number."

TABLE: tuple[Translation, ...] = (
    Translation("ValueError", "could not be broadcast together", entry_by_entry),
    Translation("ValueError", "could not be broadcast together", rows_by_a_vector),
    Translation("ValueError", "could not be broadcast together", unequal_lengths),
    Translation("ValueError", r"solve1?: .*mismatch in its core dimension", unfit_right_side),
    Translation("ValueError", "does not have enough dimensions", number_in_a_product),
    Translation(
        "ValueError",
        r"filter coefficient a\[0\]",
        "`lfilter(b, a, x)` has the numerator first; the denominator begins with a number other "
        "than zero. Are they swapped?",
    ),
    Translation("ValueError", r"mismatch in its core dimension|not aligned", unfit_product),
    Translation("LinAlgError", "[Ss]ingular matrix", product_without_inverse),
    Translation("LinAlgError", "must be square", not_square),
    Translation("LinAlgError", "must be (at least )?two-dimensional", flat_matrix),
    Translation(
        "LinAlgError",
        "did not converge",
        "There is a nan or an inf in it: print `np.isfinite(...)` of each part. (The logarithm and the root of a "
        "negative number are nan.)",
    ),
    Translation("ControlDimension", r"state-space matrix|dimensions of [ABCD] matrix", flat_state_space),
    Translation("LinAlgError", "Incompatible dimensions", "`lstsq(A, b)`: A and b must have the same number of rows."),
    Translation("IndexError", r"index (\d+) is out of bounds for axis \d+ with size (\d+)", beyond_the_end),
    Translation("IndexError", "too many indices", too_many_indices),
    Translation(
        "IndexError", "list index out of range", "Python counts from 0: a list of 2 has the entries `[0]` and `[1]`."
    ),
    Translation("AttributeError", r"'dict' object has no attribute '(\w+)'", field_of_a_dictionary),
    Translation(
        "AttributeError",
        "'list' object has no attribute 'split'",
        'It takes one text, with commas between the names, such as "x1,x2", and no list.',
    ),
    Translation(
        "ValueError",
        "not a valid value for color",
        'A colour is a name in quotes, "red" or "tab:blue", or three numbers from 0 to 1: divide 0 to 255 by 255.',
    ),
    Translation(
        "AttributeError", "'list' object has no attribute", "A list is no array: make one of it with `np.array(...)`."
    ),
    Translation("AttributeError", "'NoneType' object", "It is nothing (None): a function without `return` gives that."),
    Translation(
        "AttributeError",
        r"module 'numpy' has no attribute '(inv|solve|lstsq|det|eig|eigvals|pinv|norm|svd|matrix_rank)'",
        lambda stop, found: f"It is in numpy's part for linear algebra: `np.linalg.{found[1]}`.",
    ),
    Translation(
        "AttributeError", "'numpy.ndarray' object has no attribute 'append'", "Use `np.append(y, value)`, or a list."
    ),
    Translation(
        "KeyError",
        r"^\d+$",
        "It is no array: its parts have names. Of what scipy's `least_squares` returns, `.x` is the solution.",
    ),
    Translation("KeyError", "(.*)", unknown_key),
    Translation(
        "UnknownColumns",
        "no columns t,u,y",
        "The names do not say which columns are inputs and which outputs: "
        '`load_record(file, inputs="...", outputs="...")`.',
    ),
    Translation("AttributeError", "module 'numpy' has no attribute 'ln'", "The natural logarithm is `np.log`."),
    Translation(
        "TypeError",
        "unsupported operand .*'(?:function|builtin_function_or_method|method)'",
        "A function itself is no number: call it, with its arguments in brackets.",
    ),
    Translation("ValueError", r"cannot reshape array of size (\d+) into shape (.*)", reshaped),
    Translation(
        "ValueError",
        "must have same first dimension",
        "The two vectors of a curve need the same length: cut both alike.",
    ),
    Translation(
        "ValueError",
        "x and y must be the same size",
        "The two vectors of a curve need the same length: cut both alike.",
    ),
    Translation(
        "ValueError",
        "weights should have the same shape",
        "Each frequency or sample needs one weight. `np.fft.rfft(e)` has len(e) // 2 + 1 values, as many as "
        "`np.fft.rfftfreq(len(e), Ts)`.",
    ),
    Translation("ValueError", "Parameter `?[TU]`?", time_and_input),
    Translation(
        "ValueError",
        "Parameter `?[TU]`?",
        "What comes second in `ct.forced_response(system, ...)` is the time, not the input. Name the input: "
        "`ct.forced_response(G, inputs=u)`.",
    ),
    Translation("ValueError", "same number of dimensions", _FLAT_BESIDE_COLUMN),
    Translation("ValueError", "must match exactly", unequal_columns),
    Translation(
        "ValueError",
        "inhomogeneous",
        "What should be numbers is a list or tuple of parts of different lengths. Often here: is it all that a "
        "function returns, such as `np.linalg.lstsq` or `np.histogram`, of which `[0]` is meant?",
    ),
    Translation(
        "ValueError",
        "x not in list",
        "It has been removed already. After a `remove`, leave the inner loop: `break`.",
    ),
    Translation(
        "ValueError",
        "need at least one array",
        "The list of arrays is empty. Often here: does its `range` end too early? `range(1, n)` leaves out n.",
    ),
    Translation("TypeError|IndexError", "slice indices must be integers|only integer", several_indices),
    Translation(
        "ValueError",
        "setting an array element with a sequence",
        "One entry is set to a whole array: take one number, `[k]`.",
    ),
    Translation("ValueError", "truth value of an array", truth_of_an_array),
    Translation("ValueError|TypeError", "values to unpack|cannot unpack", unpacked),
    Translation(
        "TypeError|AttributeError",
        r"'(?:Text|XAxis|YAxis)' object is not callable|'Axes' object has no attribute '(?:xlabel|ylabel|xlim|ylim)'",
        'Axes are set by methods that begin with `set_`: `ax.set_title("...")`, '
        '`ax.set_xlabel("...")`, `ax.set_xlim(0, 1)`.',
    ),
    Translation("TypeError", r"object is not callable", called_array),
    Translation("TypeError", r"bitwise_xor|for \^", "`^` is no power in Python: write `**`, as in `e**2`."),
    Translation(
        "TypeError",
        "indices must be integers or slices, not str",
        "It is a list, so it takes a number first: `[0]` is its first entry.",
    ),
    Translation(
        "TypeError",
        "list indices must be integers or slices, not tuple",
        "A list takes one index. For `[:, 1]` make an array of it: `np.array(...)`.",
    ),
    Translation(
        "TypeError|IndexError",
        r"cannot be interpreted as an integer|must be integers|only integer|arrays used as indices|"
        r"a single integer, got '-?\d+\.",
        _WHOLE,
    ),
    Translation(
        "TypeError",
        "not supported between instances of '(?:EigResult|SVDResult|tuple|list)'",
        "It holds several results: take one of them, such as `[0]`, before you compare.",
    ),
    Translation(
        "TypeError",
        "Cannot interpret '.*' as a data type",
        "The shape is one argument, in brackets of its own: `np.zeros((3, 4))`.",
    ),
    Translation(
        "TypeError",
        r"(?:(?:column_|[hv])?stack|concatenate)\(\) (?:takes .* positional|got)|_dispatcher\(\) takes .* positional",
        "Hand the arrays over together, in a list: `np.column_stack([a, b])`.",
    ),
    Translation(
        "TypeError",
        "only .*length-1 arrays|only 0-dimensional arrays",
        "The function takes one number; numpy's, `np.sin` for example, takes arrays.",
    ),
    Translation(
        "TypeError",
        r"can't multiply sequence|unsupported operand type\(s\) for .*'list'",
        "A list does not compute: make an array of it, `np.array(...)`.",
    ),
    Translation(
        "TypeError",
        "unsupported operand .*NoneType|'NoneType' object is not",
        "Something is nothing (None): a function without `return` gives that.",
    ),
    Translation(
        "TypeError",
        "is not subscriptable",
        ("It has no entries, so it takes no `[...]`: is it one number, or a function without its `(...)`?"),
    ),
    Translation(
        "TypeError",
        r"(\w+)\(\) (missing|takes|got)",
        "The call and the first line of the function differ: compare their arguments, one by one.",
    ),
    Translation(
        "UnboundLocalError",
        "'(\\w+)'",
        lambda stop, found: (
            f"`{found[1]}` is assigned in this function, so it is the function's own, and it has no "
            f"value yet in this line: give it one first, or hand it over."
        ),
    ),
    Translation("ZeroDivisionError", "", "Something is divided by zero: print the denominator."),
    Translation("ModuleNotFoundError", "", "Use the packages that the first cell imports; grading has no others."),
    Translation("RecursionError", "", "A function calls itself without end."),
    Translation(
        "MemoryError",
        "",
        ("An array is far too large. Often here: a column (N, 1) and a flat array (N,) make a table of N by N."),
    ),
)
"""In order: the first that matches and knows a cause."""
