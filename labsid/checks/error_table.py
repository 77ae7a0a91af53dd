"""Python's errors that are explained: which they are, and what explains each."""

from labsid.checks.argument_orders import (
    points_of_interpolation,
    system_first,
    turned_histogram,
    unsorted_edges,
    values_for_a_condition,
)
from labsid.checks.array_errors import ARRAY_ERRORS, Translation
from labsid.checks.call_causes import (
    array_for_an_axis,
    attribute_of_a_function,
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
    uncalled_function,
    unknown_elsewhere,
    unknown_in_a_figure,
    unknown_in_a_module,
    unknown_in_a_number,
    unknown_in_an_array,
    unknown_property,
    without_entries,
)
from labsid.checks.causes import (
    called_array,
    time_and_input,
    truth_of_an_array,
    unpacked,
)
from labsid.checks.column_causes import unequal_columns
from labsid.checks.handed_over import one_list, starred_argument, wrong_arguments
from labsid.checks.key_causes import field_of_a_dictionary, unknown_key
from labsid.checks.library_errors import (
    appended_to_an_array,
    arguments_of_a_filter,
    coefficients,
    function_for_numbers,
    index_of_a_dictionary,
    list_for_a_number,
    number_among_arrays,
    number_beside_a_table,
    shape_of_zeros,
    start_of_a_search,
    unequal_curves,
    unequal_mask,
    unequal_weights,
    uneven_parts,
    unknown_keyword,
)
from labsid.checks.loops import endless
from labsid.checks.points import reshaped
from labsid.checks.tables import entry_of_a_flat_array
from labsid.checks.tuple_causes import (
    no_whole_number,
    several_indices,
    tuple_for_a_part,
    value_for_an_index,
)

_FLAT_BESIDE_COLUMN = (
    "One has rows and columns, as a column (N, 1) has, and one is flat, (N,). Make them alike: `.reshape(-1, 1)` makes "
    "a column, `.ravel()` a flat array. (`np.column_stack` takes both.)"
)

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
        "A list is no array: `np.array(...)` makes one of a list of numbers. Of a list of arrays it makes one with a "
        "row for each of them, and `np.column_stack(...)` one with a column for each.",
    ),
    Translation(
        "AttributeError",
        "'NoneType' object",
        "It is nothing (None): a function without `return` gives that, and so does `append` of a list.",
    ),
    Translation(
        "AttributeError",
        r"module 'numpy' has no attribute '(inv|solve|lstsq|det|eig|eigvals|pinv|norm|svd|matrix_rank)'",
        lambda stop, found: f"It is in numpy's part for linear algebra: `np.linalg.{found[1]}`.",
    ),
    Translation("AttributeError", "'numpy.ndarray' object has no attribute 'append'", appended_to_an_array),
    Translation("AttributeError", r"'numpy.ndarray' object has no attribute '(\w+)'", unknown_in_an_array),
    Translation("AttributeError", r"'(?:int|float|numpy\.\w+)' object has no attribute '(\w+)'", unknown_in_a_number),
    Translation("KeyError", "(.*)", unknown_key),
    Translation(
        "UnknownColumns",
        "no columns t,u,y",
        "The names do not say which columns are inputs and which outputs: "
        '`load_record(file, inputs="...", outputs="...")`.',
    ),
    Translation(
        "UnknownColumns", "there is no column", "The names must be spelt as in the file; it has those listed here."
    ),
    Translation("AttributeError", "module 'numpy' has no attribute 'ln'", "The natural logarithm is `np.log`."),
    Translation("AttributeError", r"module '([\w.]+)' has no attribute '(\w+)'", unknown_in_a_module),
    Translation("AxisError", r"axis (-?\d+) is out of bounds for array of dimension (\d+)", missing_axis),
    Translation("TypeError", "integer argument expected, got", missing_axis),
    Translation("TypeError", r"invalid keyword argument for (\w+)\(\)", own_function_of_python),
    Translation("TypeError", "only integer scalar arrays can be", array_for_an_axis),
    Translation("TypeError", "'(?:int|float|numpy.float64|numpy.bool|bool)' object is not iterable", not_iterable),
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
        "TypeError", "unsupported operand .*'(?:function|builtin_function_or_method|method)'", uncalled_function
    ),
    Translation(
        "TypeError",
        "unsupported operand .*'(?:function|builtin_function_or_method|method)'",
        "A function itself is no number: call it, with its arguments in brackets.",
    ),
    Translation("ValueError", r"cannot reshape array of size (\d+) into shape (.*)", reshaped),
    Translation("ValueError", "must have same first dimension|x and y must be the same size", unequal_curves),
    Translation("ValueError", "weights should have the same shape", turned_histogram),
    Translation("ValueError", "bins must (?:be monotonically|increase)", unsorted_edges),
    Translation("ValueError", "object of too small depth", points_of_interpolation),
    Translation("ValueError", "either both or neither of x and y", values_for_a_condition),
    Translation("TypeError", "Parameter `?sys`?", system_first),
    Translation(
        "ValueError",
        r"Parameter `?X0`?: Wrong shape .*: (\(.*?\))\. Expected: (\(\d+,\))",
        lambda stop, found: (
            f"The initial state has one number for each state of the model, shape {found[2]}: here it has {found[1]}."
        ),
    ),
    Translation("ValueError", "weights should have the same shape", unequal_weights),
    Translation("ValueError", "Parameter `?[TU]`?", time_and_input),
    Translation("ValueError", "x must be at least 1-D", arguments_of_a_filter),
    Translation("ValueError", "same number of dimensions", number_beside_a_table),
    Translation("ValueError", "same number of dimensions", _FLAT_BESIDE_COLUMN),
    Translation("ValueError", "must match exactly", unequal_columns),
    Translation("ValueError", "inhomogeneous", uneven_parts),
    Translation("ValueError", "zero-dimensional arrays cannot be concatenated", number_among_arrays),
    Translation(
        "IndexError",
        r"boolean index did not match .* axis (\d+); size of axis is (\d+) but .* axis is (\d+)",
        unequal_mask,
    ),
    Translation("TypeError", "unhashable type: 'slice'", index_of_a_dictionary),
    Translation("TypeError", "argument must be .*not '(?:function|builtin_function_or_method)'", function_for_numbers),
    Translation("TypeError", "argument must be .*not '(?:list|tuple)'", list_for_a_number),
    Translation(
        "TypeError|ValueError",
        r"numerator has \d+ output|numerator and denominator inputs must be",
        coefficients,
    ),
    Translation("TypeError", "unrecognized keywords", unknown_keyword),
    Translation(
        "TypeError",
        "filter expected",
        "`filter` is Python's own. MATLAB's `filter(b, a, u)` is `scipy.signal.lfilter(b, a, u)`.",
    ),
    Translation(
        "TypeError",
        "arange: scalar arguments expected",
        "`np.arange` takes its numbers one by one, `np.arange(start, stop, step)`, and no list or tuple of them.",
    ),
    Translation(
        "ValueError",
        "output array is not acceptable",
        "`np.dot` multiplies two arrays: what comes third is where the result is put. More factors are joined by `@`.",
    ),
    Translation(
        "IndexError",
        "list assignment index out of range",
        "An entry that a list does not have cannot be set: `append` adds one, or begin with an array, `np.zeros(n)`.",
    ),
    Translation(
        "AttributeError",
        "'TransferFunction' object has no attribute '[ABCD]'",
        "It is a transfer function: the matrices A, B, C and D belong to a state space.",
    ),
    Translation("ValueError", "not finite in the initial point|`x0` must have at most 1", start_of_a_search),
    Translation(
        "ValueError",
        "Invalid format specifier",
        "What stands after the colon, within the braces, says how a number is written: `{x:.3e}` with a power of ten, "
        "`{x:.3f}` with three decimals, `{x:.3g}` with three digits.",
    ),
    Translation(
        "OSError",
        "must provide indices of length 2 for state space",
        "The right side is one system, and is not taken apart: its matrices are `sys.A`, `sys.B`, `sys.C` and `sys.D`.",
    ),
    Translation(
        "ValueError",
        "x not in list",
        "The list does not hold it. Often here: an earlier round of a loop has removed it already? After a `remove`, "
        "leave the inner loop: `break`.",
    ),
    Translation(
        "ValueError",
        "need at least one array",
        "The list of arrays is empty: print its `range`. (`range(1, n)` leaves out n, and with n = 1 it is empty.)",
    ),
    Translation(
        "TypeError|IndexError",
        "(?:slice|list) indices must be integers(?!.*(?:str|tuple)$)|only integer|arrays used as indices",
        several_indices,
    ),
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
    Translation("ValueError", "truth value of an(?: empty)? array", compared_by_python),
    Translation("ValueError", "truth value of an(?: empty)? array", truth_of_an_array),
    Translation("ValueError|TypeError", "values to unpack|cannot unpack", unpacked),
    Translation(
        "TypeError|AttributeError",
        r"'(?:Text|XAxis|YAxis)' object is not callable|'Axes' object has no attribute '(?:xlabel|ylabel|xlim|ylim)'",
        'Axes are set by methods that begin with `set_`: `ax.set_title("...")`, '
        '`ax.set_xlabel("...")`, `ax.set_xlim(0, 1)`.',
    ),
    Translation(
        "AttributeError",
        r"'(?:function|method|builtin_function_or_method|numpy.ufunc)' object has no attribute '(\w+)'",
        attribute_of_a_function,
    ),
    Translation("AttributeError", r"'(?:[\w.]*\.)?(\w+)' object has no attribute '(\w+)'", unknown_elsewhere),
    Translation("TypeError", "object is not callable", called_attribute),
    Translation("TypeError", r"object is not callable", called_array),
    Translation(
        "TypeError|UFuncTypeError|UFuncNoLoopError",
        "bitwise_(and|or)",
        "`&` and `|` come before a comparison: each comparison needs brackets of its own, `(x >= 0) & (x < 1)`.",
    ),
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
        no_whole_number,
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
        shape_of_zeros,
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
        r"can't multiply sequence|concatenate list|bad operand type for unary -: 'list'|"
        r"unsupported operand type\(s\) for .*'list'",
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
        "'Axes' object is not subscriptable",
        "It is one axes already, and no array of them: it takes no `[...]`.",
    ),
    Translation(
        "TypeError",
        "is not subscriptable",
        "It has no entries, so it takes no `[...]`, as one number and a function have none.",
    ),
    Translation("TypeError", r"([\w.<>]+)\(\) (?:missing|takes|got)", wrong_arguments),
    Translation(
        "TypeError",
        r"\(\) (missing|takes|got)",
        "The call hands over other arguments than the function takes: compare them, one by one.",
    ),
    Translation(
        "UnboundLocalError",
        "'(\\w+)'",
        lambda stop, found: (
            f"`{found[1]}` is assigned in this function, so it is the function's own, and it has no "
            f"value yet in this line: give it one first, or hand it over."
        ),
    ),
    Translation("OutOfTime|KeyboardInterrupt", "", endless),
    Translation(
        "ValueError",
        "cannot delete array elements",
        "Entries of an array cannot be deleted: those that stay are a slice, such as `data[n:]`.",
    ),
    Translation(
        "StopIteration",
        "",
        "`next` finds nothing: the condition holds for none of what it goes through. Print both sides.",
    ),
    Translation(
        "AttributeError",
        "'(SVDResult|EigResult)' object has no attribute",
        lambda stop, found: (
            "Its parts are `.U`, `.S` and `.Vh`, or by their number `[0]`, `[1]` and `[2]`: the last is V transposed."
            if found[1] == "SVDResult"
            else "Its parts are `.eigenvalues` and `.eigenvectors`, or by their number `[0]` and `[1]`."
        ),
    ),
    Translation(
        "TypeError",
        "expected 1D vector for x",
        "`np.polyfit(x, y, degree)` fits a polynomial of one flat x, and takes no table.",
    ),
    Translation(
        "ValueError",
        "objective function must return a scalar",
        "`minimize` takes a function that returns one number, such as the sum of the squares. One that returns the "
        "errors themselves belongs to `scipy.optimize.least_squares`.",
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
