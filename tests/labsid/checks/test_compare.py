"""Reading values as what they should be, in words that help; and comparing in the right sense."""

import re
from typing import Any

import control
import numpy as np
import pytest
import scipy.signal

from labsid.checks.compare import (
    as_array,
    as_column,
    as_figure,
    as_history,
    as_matrix,
    as_number,
    as_theta,
    as_vector,
    close,
    kind_of,
)
from labsid.checks.compare_systems import MAX_ORDER, as_system, frequency_response, same_response
from labsid.checks.values import StateSpaceValue, TransferFunctionValue, Unreadable, plain
from labsid.checks.verdict import NoAnswer
from labsid.plots.figure_values import FigureValue

TS = 0.75
NUM, DEN = [0.2, 0.1], [1.0, -1.2, 0.4]
TF = TransferFunctionValue(NUM, DEN, TS)
SS = StateSpaceValue([[1.2, -0.4], [1, 0]], [[1], [0]], [[0.2, 0.1]], [[0]], TS)
NAN = float("nan")
NO_ROUNDING = (
    "Its imaginary part is no rounding, it goes up to {}. Asked for are real numbers: `np.abs` is the size, `np.real` "
    "the real part."
)
NOT_FOUR, RANGE = (
    "`Phi` should have shape (any, 4); it is an array of shape",
    "(A `range` leaves out its end.)",
)
DOUBLE = "and the comparison needs more. Compute in double precision, numpy's own `float`: leave the type out."


MADE = "Make it with `ct.tf(...)` or `ct.ss(...)`."
BEFORE_NAN = (
    "check the computation before it. (0/0 gives nan, and so does the root or the logarithm of a negative number.)"
)
BEFORE_INF = (
    "check the computation before it. (A division by zero gives inf, and so does a number that grows beyond all "
    "bounds.)"
)
TABLE = "`y` should be one column of numbers; it is a table of"
OF_MATRICES = (
    "`*` and `/` between matrices. (Their product is `@`, and a system of equations is solved by `np.linalg.solve`.) "
    "Print the shapes of its parts."
)
OF_A_COLUMN = "A column (N, 1) and a flat array (N,) in one sum or difference make such a table, and so do"


def refused(said: str, slip: str | None = None) -> Any:
    """Expect `NoAnswer` with this very text, and the slip."""

    class Refused:
        def __enter__(self) -> None: ...

        def __exit__(self, kind: Any, error: Any, trace: Any) -> bool:
            assert kind is NoAnswer, f"expected NoAnswer, got {error!r}"
            assert str(error) == said
            assert error.slip == slip
            return True

    return Refused()


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (None, "nothing (None)"),
        (3, "a number"),
        (True, "a number"),
        (0.5, "a number"),
        (np.array(2.0), "a number"),
        (2j, "a complex number"),
        ("x", "text"),
        (np.zeros((3, 1)), "an array of shape (3, 1)"),
        ((1, "a"), "a list or tuple of 2 items"),
        (("a",), "a list or tuple of 1 item"),
        ({"a": 1}, "a dictionary"),
        (TF, "a transfer function"),
        (SS, "a state space"),
        (FigureValue(()), "a figure"),
        (Unreadable("Axes"), "an object of type Axes"),
    ],
)
def test_values_are_called_by_their_names(value: Any, words: str) -> None:
    assert kind_of(value) == words


@pytest.mark.parametrize("value", [3, 3.0, True + 2, np.array(3), np.array([3.0]), np.array([[3.0]]), 3 + 0j])
def test_a_number_may_come_in_an_array(value: Any) -> None:
    got = as_number("a", plain(value))
    assert got == 3
    assert type(got) is float


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (None, "`a` should be one number; it is nothing (None)."),
        ("3", "`a` should be one number; it is text."),
        (
            [1, 2],
            "`a` should be one number; it is an array of shape (2,).",
        ),
        (
            [],
            "`a` should be one number; it is an array of shape (0,). It is empty, as `x[condition]` is where no entry "
            "meets the condition. (Numbers of many digits are hardly ever equal, `==`.)",
        ),
        (10**400, "`a` should be one number; it is an object of type int of too many digits."),
        (TF, "`a` should be one number; it is a transfer function."),
        (len, "`a` should be one number; it is an object of type builtin_function_or_method."),
        (NAN, f"`a` holds nan: {BEFORE_NAN}"),
        (np.array(-np.inf), f"`a` holds -inf: {BEFORE_INF}"),
        ([NAN], f"`a` holds nan (at [0]): {BEFORE_NAN}"),
    ],
)
def test_what_is_no_number_is_said(value: Any, said: str) -> None:
    with refused(said):
        as_number("a", plain(value) if not isinstance(value, TransferFunctionValue) else value)


@pytest.mark.parametrize(
    ("value", "said", "slip"),
    [
        (3j, f"`a` should be one number; it is a complex number. {NO_ROUNDING.format(3)}", "imaginary part"),
        (
            np.array([3j]),
            f"`a` should be one number; it is a complex array of shape (1,). {NO_ROUNDING.format(3)}",
            "imaginary part",
        ),
        (np.float32(3), f"`a` has the type float32, which keeps only 7 digits, {DOUBLE}", "single precision"),
        (np.float16(3), f"`a` has the type float16, which keeps only 4 digits, {DOUBLE}", "single precision"),
    ],
)
def test_numbers_of_another_kind_are_refused_with_a_way_out(value: Any, said: str, slip: str) -> None:
    with refused(said, slip):
        as_number("a", plain(value))


@pytest.mark.parametrize("value", [[1, 2, 3], (1, 2, 3), range(1, 4), np.array([[1], [2], [3]]), np.arange(1, 4) + 0j])
def test_a_vector_may_be_flat_or_a_column(value: Any) -> None:
    got = as_vector("y", plain(value), 3)
    assert got.dtype == np.float64
    np.testing.assert_array_equal(got, [1, 2, 3])


def test_a_column_of_one_is_a_vector() -> None:
    assert as_vector("y", np.array([[5.0]])).tolist() == [5]


@pytest.mark.parametrize(
    ("value", "said", "slip"),
    [
        (
            np.zeros((1, 3)),
            "`y` is a row, shape (1, 3). Make it a column: `y.T`.",
            "a row instead of a column",
        ),
        (np.zeros((3, 2)), "`y` should be one column of numbers; it is an array of shape (3, 2).", None),
        (
            np.zeros((3, 3)),
            f"{TABLE} 3 by 3. {OF_A_COLUMN} {OF_MATRICES}",
            "a table in place of a vector",
        ),
        (np.zeros((1, 1, 3)), "`y` should be one column of numbers; it is an array of shape (1, 1, 3).", None),
        (np.zeros(4), "`y` should have 3 elements; it has 4.", None),
        (np.zeros((2, 1)), "`y` should have 3 elements; it has 2.", None),
        (np.zeros(0), "`y` should have 3 elements; it has 0.", None),
        (5.0, "`y` should hold 3 numbers; it is one number.", "one number in place of a vector"),
        (..., "`y` should be a vector; it is still `...`.", None),
        (
            np.zeros((3, 9)),
            f"{TABLE} 3 by 9. One way to such a table are {OF_MATRICES}",
            "a table in place of a vector",
        ),
        (("a", 1), "`y` should be a vector; it is a list or tuple of 2 items.", None),
        (np.array([1, NAN, NAN]), f"`y` holds nan (at [1]): {BEFORE_NAN}", None),
        (np.array([[1], [np.inf]]), f"`y` holds inf (at [1, 0]): {BEFORE_INF}", None),
        (
            np.array([1j, 1, 1]),
            f"`y` should be a vector; it is a complex array of shape (3,). {NO_ROUNDING.format(1)}",
            "imaginary part",
        ),
        (np.ones(3, np.float32), f"`y` has the type float32, which keeps only 7 digits, {DOUBLE}", "single precision"),
        (
            np.ones(3, np.complex64),
            f"`y` has the type float32, which keeps only 7 digits, {DOUBLE}",
            "single precision",
        ),
    ],
)
def test_what_is_no_vector_is_said(value: Any, said: str, slip: str | None) -> None:
    with refused(said, slip):
        as_vector("y", plain(value), 3)


def test_a_flat_vector_is_no_column() -> None:
    assert as_column("t", np.array([[1.0], [2.0]]), 2).tolist() == [1, 2]
    with refused(
        "`t` has shape (2,): it is one-dimensional. A column vector has shape (2, 1): use `np.reshape(t, (-1, 1))`.",
        "flat instead of a column",
    ):
        as_column("t", np.array([1.0, 2.0]), 2)
    with refused("`t` is a row, shape (1, 2). Make it a column: `t.T`.", "a row instead of a column"):
        as_column("t", np.array([[1.0, 2.0]]), 2)
    with refused("`t` should be one column of numbers; it is a number."):
        as_column("t", 3.0, 1)
    with refused("`t` should be a vector; it is nothing (None)."):
        as_column("t", None, 1)


def test_a_matrix_is_read_with_open_sizes() -> None:
    assert as_matrix("Phi", np.ones((5, 4), int), (None, 4)).dtype == np.float64
    assert as_matrix("Phi", plain([[1, 2], [3, 4]]), (2, 2)).tolist() == [[1, 2], [3, 4]]
    assert as_matrix("Phi", np.ones((4, 4)), (None, 4)).shape == (4, 4)


@pytest.mark.parametrize(
    ("value", "shape", "said", "slip"),
    [
        (
            np.zeros((4, 449)), (None, 4),
            "`Phi` has shape (4, 449); it should have shape (any, 4): transpose it.",
            "rows instead of columns",
        ),
        (
            np.zeros((3, 801)), (801, 3),
            "`Phi` has shape (3, 801); it should have shape (801, 3): transpose it.",
            "rows instead of columns",
        ),
        (np.zeros((449, 3)), (None, 4), f"{NOT_FOUR} (449, 3). One column too few. {RANGE}", None),
        (np.zeros((449, 5)), (None, 4), f"{NOT_FOUR} (449, 5). One column too many. {RANGE}", None),
        (np.zeros((449, 6)), (None, 4), f"{NOT_FOUR} (449, 6).", None),
        (np.zeros(4), (None, 4), "`Phi` should have shape (any, 4); it is an array of shape (4,).", None),
        (3, (None, 4), "`Phi` should have shape (any, 4); it is a number.", None),
        ("x", (None, 4), "`Phi` should be a matrix; it is text.", None),
        (np.array([[1, NAN]]), (1, 2), f"`Phi` holds nan (at [0, 1]): {BEFORE_NAN}", None),
    ],
)  # fmt: skip
def test_what_is_no_such_matrix_is_said(value: Any, shape: tuple, said: str, slip: str | None) -> None:
    with refused(said, slip):
        as_matrix("Phi", value, shape)


def test_a_parameter_vector_is_told_from_all_that_lstsq_returns() -> None:
    assert as_theta("fit(u, y)", np.array([[1.0], [2.0]]), 2).tolist() == [1, 2]
    with refused("`fit(u, y)` returns the whole result of `lstsq`: return its first element, `[0]`.", "all of lstsq"):
        as_theta("fit(u, y)", plain(np.linalg.lstsq(np.eye(2), np.ones(2), rcond=None)), 2)
    with refused("`fit(u, y)` should have 2 elements; it has 3."):
        as_theta("fit(u, y)", np.ones(3), 2)


def test_a_history_may_be_one_of_columns() -> None:
    assert as_history("rls(Phi, Y)", np.ones((5, 2, 1)), 5, 2).shape == (5, 2)
    assert as_history("rls(Phi, Y)", plain([np.zeros(2)] * 5), 5, 2).shape == (5, 2)


@pytest.mark.parametrize(
    ("value", "said", "slip"),
    [
        (
            np.ones(2),
            "`rls(Phi, Y)` returns one estimate; return the whole history, one row for every sample.",
            "only the last estimate",
        ),
        (
            np.ones((6, 2)),
            "`rls(Phi, Y)` has one row too many: leave out the start value theta(0).",
            "history begins with theta(0)",
        ),
        (
            np.ones((2, 5)),
            "`rls(Phi, Y)` has shape (2, 5); it should have shape (5, 2): transpose it.",
            "rows instead of columns",
        ),
        (None, "`rls(Phi, Y)` should be a matrix; it is nothing (None).", None),
    ],
)
def test_what_is_no_history_is_said(value: Any, said: str, slip: str | None) -> None:
    with refused(said, slip):
        as_history("rls(Phi, Y)", value, 5, 2)


def test_an_array_of_any_shape_is_read() -> None:
    assert as_array("x", np.ones((2, 3, 4))).shape == (2, 3, 4)
    assert as_array("x", True).shape == ()
    with refused("`x` should be numbers; it is text."):
        as_array("x", "y")


def test_a_figure_is_read_with_its_number_of_axes() -> None:
    figure = FigureValue(())
    assert as_figure("fig_1", figure, 0) is figure
    with refused("`fig_1` should have 2 subplots; it has 0.", "number of panels"):
        as_figure("fig_1", figure, 2)
    said = "`fig_1` should be a figure; it is nothing (None), as the result of a function without `return` is."
    with refused(said, "not the figure"):
        as_figure("fig_1", None)
    said = "`fig_1` should be the figure itself, the first that `plt.subplots()` returns; it is an object of type Axes."
    with refused(said, "not the figure"):
        as_figure("fig_1", Unreadable("Axes"), 2)


# ---- numbers


def test_closeness_is_measured_on_the_largest_element() -> None:
    same = close(1e-6)
    assert same([1000, 1e-3], [1000, 1.9e-3])
    assert not same([1000, 0], [1000, 1e-2])
    assert same(1.0, 1.0 + 1e-7)
    assert not same(1.0, 1.0 + 1e-5)
    assert not same(0.0, 1e-300)
    assert close(0, absolute=0.1)(0.0, 0.09)


def test_closeness_wants_equal_shapes_and_something_to_compare() -> None:
    same = close(1e-6)
    assert not same(np.ones(3), np.ones((3, 1)))
    assert not same(np.ones(3), 1.0)
    assert not same([], [])
    assert not same([NAN], [NAN])


# ---- systems


def test_a_system_is_read() -> None:
    assert as_system("G", TF) is TF
    assert as_system("G", SS) is SS
    with refused(f"`G` should be a transfer function or a state space; it is an array of shape (2,). {MADE}"):
        as_system("G", np.zeros(2))
    two = StateSpaceValue(np.eye(2), np.ones((2, 1)), np.eye(2), np.zeros((2, 1)), TS)
    with refused("`G` should have one input and one output; it has 1 and 2."):
        as_system("G", two)
    two = StateSpaceValue(np.eye(2), np.eye(2), np.ones((1, 2)), np.zeros((1, 2)), TS)
    with refused("`G` should have one input and one output; it has 2 and 1."):
        as_system("G", two)
    for huge in (
        TransferFunctionValue(np.ones(1), np.ones(MAX_ORDER + 2), TS),
        TransferFunctionValue(np.ones(MAX_ORDER + 2), np.ones(1), TS),
        StateSpaceValue(
            np.eye(MAX_ORDER + 1), np.ones((MAX_ORDER + 1, 1)), np.ones((1, MAX_ORDER + 1)), np.zeros((1, 1)), TS
        ),
    ):
        with refused(f"`G` has order {MAX_ORDER + 1}, far above the order of this plant."):
            as_system("G", huge)


@pytest.mark.parametrize("value", [TF, SS])
def test_the_response_is_that_of_python_control(value: TransferFunctionValue | StateSpaceValue) -> None:
    ours = frequency_response(value, 20)
    omega = np.pi * np.logspace(-3, 0, 20) / TS
    np.testing.assert_allclose(ours, control.tf(NUM, DEN, TS)(np.exp(1j * omega * TS)), rtol=1e-9)


def test_the_response_of_a_continuous_system_is_that_of_scipy() -> None:
    value = plain(control.tf([2.0], [3.0, 4.0, 1.0]))
    omega = np.logspace(-4, 4, 64)
    _, theirs = scipy.signal.freqresp(scipy.signal.lti([2.0], [3.0, 4.0, 1.0]), omega)
    np.testing.assert_allclose(frequency_response(value), theirs, rtol=1e-9)


def the_same_system() -> dict[str, Any]:
    tf = control.tf(NUM, DEN, TS)
    A, B, C, D = control.ssdata(control.ss(tf))
    T = np.array([[2.0, 1.0], [0.5, 3.0]])
    return {
        "python-control's transfer function": tf,
        "its state space": control.ss(tf),
        "the canonical form of eq. (2)": control.ss([[1.2, 1], [-0.4, 0]], [[0.2], [0.1]], [[1, 0]], 0, TS),
        "a state space in other coordinates": control.ss(np.linalg.inv(T) @ A @ T, np.linalg.inv(T) @ B, C @ T, D, TS),
        "scipy's dlti": scipy.signal.dlti(NUM, DEN, dt=TS),
        "scipy's state space": scipy.signal.dlti(NUM, DEN, dt=TS).to_ss(),
        "all coefficients doubled": control.tf([0.4, 0.2], [2.0, -2.4, 0.8], TS),
        "leading zeros": control.tf([0, 0, 0.2, 0.1], [0, 1.0, -1.2, 0.4], TS),
        "in powers of z^-1": scipy.signal.dlti([0.2, 0.1, 0.0], [1.0, -1.2, 0.4, 0.0], dt=TS),
        "a pole and a zero that cancel": control.tf(np.polymul(NUM, [1, -0.3]), np.polymul(DEN, [1, -0.3]), TS),
        "its coefficients to ten digits": control.tf([0.2 + 1e-11, 0.1], [1.0, -1.2, 0.4], TS),
    }


@pytest.mark.parametrize("name", the_same_system())
def test_a_system_is_the_same_however_it_is_written(name: str) -> None:
    assert same_response()(as_system("G", plain(the_same_system()[name])), TF)
    assert same_response()(TF, as_system("G", plain(the_same_system()[name])))


@pytest.mark.parametrize(
    "other",
    [
        pytest.param(control.tf(NUM, DEN, 0.7), id="another sampling time"),
        pytest.param(control.tf(NUM, DEN, True), id="no sampling time"),
        pytest.param(control.tf(NUM, DEN), id="continuous time"),
        pytest.param(control.tf(NUM, np.polymul(DEN, [1, 0]), TS), id="a delay too many"),
        pytest.param(control.tf(np.polymul(NUM, [1, 0]), DEN, TS), id="a delay too few"),
        pytest.param(control.tf(NUM, [1.0, 1.2, -0.4], TS), id="the sign of a"),
        pytest.param(control.tf(NUM[::-1], DEN, TS), id="b the other way round"),
        pytest.param(control.tf(DEN, NUM, TS), id="upside down"),
        pytest.param(control.tf([0.2001, 0.1], DEN, TS), id="a gain that is nearly right"),
        pytest.param(control.tf([0.2, -0.1], DEN, TS), id="the sign of b2"),
        pytest.param(control.tf([0.0], [1.0], TS), id="nothing"),
        pytest.param(control.ss([[1.2, 1], [-0.4, 0]], [[0.2], [0.1]], [[1, 0]], 1, TS), id="a D too many"),
    ],
)
def test_another_system_is_not_the_same(other: Any) -> None:
    assert not same_response()(plain(other), TF)
    assert not same_response()(TF, plain(other))


@pytest.mark.parametrize(
    "broken",
    [
        TransferFunctionValue([1.0], [0.0], TS),
        TransferFunctionValue([], [], TS),
        TransferFunctionValue([NAN], DEN, TS),
        TransferFunctionValue(NUM, DEN, NAN),
        StateSpaceValue(np.eye(2), np.ones((3, 1)), np.ones((1, 2)), [[0]], TS),
        StateSpaceValue(np.ones((2, 3)), np.ones((2, 1)), np.ones((1, 2)), [[0]], TS),
        StateSpaceValue(np.full((2, 2), NAN), np.ones((2, 1)), np.ones((1, 2)), [[0]], TS),
    ],
)
def test_what_is_no_system_is_the_same_as_nothing(broken: Any) -> None:
    assert not same_response()(broken, TF)
    assert not same_response()(broken, broken)


@pytest.mark.parametrize("value", [None, "x", np.zeros((1, 3)), np.zeros((2, 2)), np.zeros((1, 1, 1)) * NAN])
@pytest.mark.parametrize("read", [as_number, as_vector, as_column, as_system])
def test_messages_name_the_variable_as_code(read: Any, value: Any) -> None:
    """Feedback shows what stands in backticks as code; it must come in pairs."""
    with pytest.raises(NoAnswer) as refusal:
        read("theta_hat", value)
    assert re.match(r"`theta_hat` \w+", str(refusal.value))
    assert str(refusal.value).count("`") % 2 == 0
