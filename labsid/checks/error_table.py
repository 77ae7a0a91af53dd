"""Python's errors that are explained: which they are, and what explains each."""

from labsid.checks.array_errors import ARRAY_ERRORS, Translation
from labsid.checks.call_causes import (
    array_for_an_axis,
    called_attribute,
    compared_by_python,
    missing_axis,
    no_count,
    no_steps,
    not_iterable,
    number_function,
    own_function_of_python,
    text_for_an_index,
    text_in_a_computation,
    unknown_in_a_figure,
    unknown_in_a_module,
    unknown_in_a_number,
    unknown_in_an_array,
    unknown_property,
    without_entries,
)
from labsid.checks.causes import (
    called_array,
    reshaped,
    time_and_input,
    truth_of_an_array,
    unequal_columns,
    unpacked,
)
from labsid.checks.handed_over import one_list, starred_argument, wrong_arguments
from labsid.checks.key_causes import field_of_a_dictionary, unknown_key
from labsid.checks.tables import entry_of_a_flat_array
from labsid.checks.tuple_causes import (
    several_indices,
    tuple_for_a_part,
    value_for_an_index,
)

_FLAT_BESIDE_COLUMN = (
    "One is a column, (N, 1), and one is flat, (N,). Make them alike: `.reshape(-1, 1)` makes "
    "a column, `.ravel()` a flat "
    "array. (`np.column_stack` takes both.)"
)
_WHOLE = "An index, a size or a count must be a whole number: `/` always gives a float, `//` a whole number."

TABLE: tuple[Translation, ...] = (
    *ARRAY_ERRORS,
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
        "AttributeError",
        "'list' object has no attribute",
        "A list is no array. Of a list of arrays, `np.array(...)` makes one with a row for each of them, and "
        "`np.column_stack(...)` one with a column for each.",
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
    Translation("AttributeError", r"'numpy.ndarray' object has no attribute '(\w+)'", unknown_in_an_array),
    Translation("AttributeError", r"'(?:int|float|numpy\.\w+)' object has no attribute '(\w+)'", unknown_in_a_number),
    Translation("KeyError", "(.*)", unknown_key),
    Translation(
        "UnknownColumns",
        "no columns t,u,y",
        "The names do not say which columns are inputs and which outputs: "
        '`load_record(file, inputs="...", outputs="...")`.',
    ),
    Translation("AttributeError", "module 'numpy' has no attribute 'ln'", "The natural logarithm is `np.log`."),
    Translation("AttributeError", r"module '([\w.]+)' has no attribute '(\w+)'", unknown_in_a_module),
    Translation("AxisError", r"axis (-?\d+) is out of bounds for array of dimension (\d+)", missing_axis),
    Translation("TypeError", r"invalid keyword argument for (\w+)\(\)", own_function_of_python),
    Translation("TypeError", "only integer scalar arrays can be", array_for_an_axis),
    Translation("TypeError", "'(?:int|float|numpy.float64)' object is not iterable", not_iterable),
    Translation(
        "TypeError",
        r"object of type '(?:int|float|numpy\.\w+)' has no len\(\)|len\(\) of unsized object",
        "It is one number, which has no length.",
    ),
    Translation(
        "TypeError",
        "__round__ method",
        "`round` is Python's own, for one number; of an array it is `np.round(...)`.",
    ),
    Translation(
        "TypeError|UFuncTypeError|UFuncNoLoopError",
        r"unsupported operand .*'str'|concatenate str|not supported for the input types|dtype\('<U",
        text_in_a_computation,
    ),
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
        "What should be numbers has parts of different lengths, such as all that `np.linalg.lstsq` returns "
        "(`[0]` is its solution), or an array among numbers, `[1, x]` (`[1, *x]` has each of its entries).",
    ),
    Translation(
        "ValueError",
        "x not in list",
        "It has been removed already. After a `remove`, leave the inner loop: `break`.",
    ),
    Translation(
        "ValueError",
        "need at least one array",
        "The list of arrays is empty: print its `range`. (`range(1, n)` leaves out n, and with n = 1 it is empty.)",
    ),
    Translation("TypeError|IndexError", "slice indices must be integers|only integer", several_indices),
    Translation("TypeError", "'tuple' (and|object cannot)|and 'tuple'|concatenate tuple", tuple_for_a_part),
    Translation(
        "TypeError",
        "not supported between instances of 'OptimizeResult'",
        "Each is a whole result: compare one number of it, `min(fits, key=lambda fit: fit.cost)`.",
    ),
    Translation("ValueError", "setting an array element with a sequence", entry_of_a_flat_array),
    Translation(
        "ValueError",
        "setting an array element with a sequence",
        "One entry is set to a whole array: take one number, `[k]`.",
    ),
    Translation("ValueError", "truth value of an array", compared_by_python),
    Translation("ValueError", "truth value of an array", truth_of_an_array),
    Translation("ValueError|TypeError", "values to unpack|cannot unpack", unpacked),
    Translation(
        "TypeError|AttributeError",
        r"'(?:Text|XAxis|YAxis)' object is not callable|'Axes' object has no attribute '(?:xlabel|ylabel|xlim|ylim)'",
        'Axes are set by methods that begin with `set_`: `ax.set_title("...")`, '
        '`ax.set_xlabel("...")`, `ax.set_xlim(0, 1)`.',
    ),
    Translation("TypeError", "object is not callable", called_attribute),
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
    Translation("IndexError", "only integer", text_for_an_index),
    Translation("TypeError", "cannot be interpreted as an integer", value_for_an_index),
    Translation("TypeError", "'list' object cannot be|only integer scalar arrays", no_count),
    Translation("TypeError", "cannot be interpreted as an integer", no_steps),
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
        "construct a dtype from an array",
        "Hand the arrays over together, in a list: `np.column_stack([a, b])`.",
    ),
    Translation(
        "ValueError",
        'Size mismatch between "values" and "edges"',
        'MATLAB\'s `stairs` is `ax.step(t, y, where="post")`; `ax.stairs` takes the edges of the steps.',
    ),
    Translation("ValueError", "Needs 1, 2, or 3 arguments; received", starred_argument),
    Translation(
        "ValueError",
        "Needs 1, 2, or 3 arguments; received",
        "`ct.tf(num, den, Ts)` takes two lists of coefficients, `[1, 2]`, and the sampling time.",
    ),
    Translation("AttributeError", r"'(Axes|Figure)' object has no attribute '(\w+)'", unknown_in_a_figure),
    Translation("AttributeError", r"set\(\) got an unexpected keyword argument '(\w+)'", unknown_property),
    Translation(
        "TypeError",
        "Cannot interpret '.*' as a data type",
        "The shape is one argument, in brackets of its own: `np.zeros((3, 4))`.",
    ),
    Translation("TypeError", r"((?:column_|[hv])?stack|concatenate)\(\) takes", one_list),
    Translation(
        "TypeError",
        r"(?:(?:column_|[hv])?stack|concatenate)\(\) (?:takes .* positional|got)|_dispatcher\(\) takes .* positional",
        "Hand the arrays over together, in a list: `np.column_stack([a, b])`.",
    ),
    Translation(
        "TypeError",
        "only .*length-1 arrays|only 0-dimensional arrays",
        number_function,
    ),
    Translation(
        "TypeError",
        "only .*length-1 arrays|only 0-dimensional arrays",
        "One number is needed where an array stands; numpy's functions take arrays.",
    ),
    Translation(
        "TypeError",
        r"can't multiply sequence|concatenate list|unsupported operand type\(s\) for .*'list'",
        "A list does not compute: make an array of it, `np.array(...)`.",
    ),
    Translation(
        "TypeError",
        "unsupported operand .*NoneType|'NoneType' object is not",
        "Something is nothing (None): a function without `return` gives that.",
    ),
    Translation("TypeError", "is not subscriptable", without_entries),
    Translation(
        "TypeError",
        "is not subscriptable",
        "It has no entries, so it takes no `[...]`, as one number and a function have none.",
    ),
    Translation("TypeError", r"([\w.<>]+)\(\) (?:missing|takes|got)", wrong_arguments),
    Translation(
        "TypeError",
        r"\(\) (missing|takes|got)",
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
        "An array is far too large. A column (N, 1) and a flat array (N,), for one, make a table of N by N.",
    ),
)
"""In order: the first that matches and knows a cause."""
