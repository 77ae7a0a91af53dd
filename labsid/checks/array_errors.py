"""Python's errors of arrays that are explained: shapes that do not fit, singular matrices, indices out of range."""

import re
from collections.abc import Callable
from dataclasses import dataclass

from labsid.checks.call_causes import (
    negative_size,
)
from labsid.checks.causes import (
    beyond_a_list,
    beyond_the_end,
    too_many_indices,
    unequal_spectra,
)
from labsid.checks.key_causes import unknown_part_of_a_result
from labsid.checks.loops import beyond_by_a_loop
from labsid.checks.matrix_causes import (
    flat_matrix,
    flat_state_space,
    number_in_a_product,
    unfit_product,
    unfit_right_side,
    unfit_rows,
)
from labsid.checks.operands import entry_by_entry, rows_by_a_vector, unequal_shapes, vector_by_columns
from labsid.checks.singular_matrices import not_square, product_without_inverse
from labsid.checks.stops import Stop
from labsid.checks.tables import row_or_column, unfit_target
from labsid.checks.tuple_causes import (
    all_that_is_found,
    tuple_for_a_part,
    unknown_part,
)

Cause = Callable[[Stop, re.Match[str]], str | None]


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


ARRAY_ERRORS: tuple[Translation, ...] = (
    Translation("ValueError|IndexError", "broadcast together|same shape as a|boolean index did not", unequal_spectra),
    Translation("ValueError", "broadcast together|core dimension|must match exactly|first dimension", row_or_column),
    Translation("ValueError", r"broadcast input array from shape (\(.*?\)) into shape (\(.*?\))", row_or_column),
    Translation("ValueError", r"broadcast input array from shape (\(.*?\)) into shape (\(.*?\))", unfit_target),
    Translation("ValueError", "broadcast together|inhomogeneous", tuple_for_a_part),
    Translation("ValueError", "broadcast together", all_that_is_found),
    Translation(
        "ValueError",
        r"Parameter [ab] is not a non-empty 1d array",
        "`lfilter(b, a, x)` takes flat lists of coefficients. Of a transfer function of `ct` they are "
        "`G.num[0][0]` and `G.den[0][0]`: it has a list for each output and input.",
    ),
    Translation(
        "ValueError",
        "could not convert string",
        "A text stands where a number is read. (In a file it may be the first line, with the names of its columns: "
        "`load_record` reads these.)",
    ),
    Translation("ValueError", "negative dimensions", negative_size),
    Translation("ValueError", "high - low < 0", "`rng.uniform(low, high, shape)` takes the lower bound first."),
    Translation("ValueError", "n should be an integer", "It takes the number of samples first, `len(e)`, and then Ts."),
    Translation("ValueError", "could not be broadcast together", entry_by_entry),
    Translation("ValueError", "could not be broadcast together", vector_by_columns),
    Translation("ValueError", "could not be broadcast together", rows_by_a_vector),
    Translation("ValueError", "could not be broadcast together", unequal_shapes),
    Translation("ValueError", r"solve1?: .*mismatch in its core dimension", unfit_right_side),
    Translation("ValueError", "does not have enough dimensions", number_in_a_product),
    Translation(
        "ValueError",
        r"filter coefficient a\[0\]",
        "`lfilter(b, a, x)` has the numerator first; the denominator begins with a number other "
        "than zero. Here it begins with zero, as a numerator with a delay does.",
    ),
    Translation("ValueError", r"mismatch in its core dimension|not aligned", unfit_product),
    Translation("LinAlgError", "[Ss]ingular matrix", product_without_inverse),
    Translation("LinAlgError", "must be square", not_square),
    Translation("LinAlgError", "must be (at least )?two-dimensional", flat_matrix),
    Translation(
        "LinAlgError",
        "did not converge",
        "Often here: there is a nan or an inf in it? Print `np.isfinite(...)` of each part. (The logarithm and the "
        "root of a negative number are nan.)",
    ),
    Translation("ControlDimension", r"state-space matrix|dimensions of [ABCD] matrix", flat_state_space),
    Translation("LinAlgError", "Incompatible dimensions", unfit_rows),
    Translation("IndexError", r"index (-?\d+) is out of bounds for axis (\d+) with size (\d+)", beyond_by_a_loop),
    Translation("IndexError", r"index (-?\d+) is out of bounds for axis (\d+) with size (\d+)", beyond_the_end),
    Translation("IndexError", "too many indices", too_many_indices),
    Translation("IndexError", "list index out of range", beyond_a_list),
    Translation("IndexError", "tuple index out of range", unknown_part),
    Translation(
        "IndexError",
        "invalid index to scalar",
        "It is one number, and has no entries. (A call `f(*x)` hands the entries of x over one by one, `f(x)` all of "
        "them together.)",
    ),
    Translation("AttributeError", r"^(\w+)$", unknown_part_of_a_result),
)
"""In order: the first that matches and knows a cause. The others stand in `error_table`."""
