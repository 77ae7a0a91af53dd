"""Checks of the forms of a model: state space from a transfer function, and the equations of an ARX model."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import as_array, as_matrix, as_vector, close
from labsid.checks.compare_systems import same_response
from labsid.checks.question import Ask, parts_of, returned, returned_parts, with_lists
from labsid.checks.regressions import LEFT_SIDE, WRAPS, beside_right_rows, wrapped
from labsid.checks.values import StateSpaceValue, Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, first_failure, judge
from labsid.model_structures.realisation import controllable_form
from labsid.model_structures.structures import Structure, build_equations

_SAME_SYSTEM = same_response(1e-6)
_EXACT = close(1e-9)


@first_failure
def check_state_space(ask: Ask) -> Iterator[Verdict]:
    """`state_space(num, den)`: without and with a direct path, num shorter than den, den[0] not 1."""
    for n, degree, lead in ((2, 1, 1.0), (3, 2, 1.0), (3, 1, 1.0), (2, 2, 1.0), (3, 2, 2.5), (1, 1, 1.0)):
        # the sum of |a| stays below one: stable, also with the other sign
        den = lead * np.r_[1, ask.rng.choice([-1.0, 1.0], n) * ask.rng.uniform(0.1, 0.3, n)]
        num = ask.rng.uniform(0.5, 2, degree + 1) * np.r_[ask.rng.choice([-1.0, 1.0], degree), 1]
        yield _judge_state_space(ask, num, den)
    yield with_lists(ask, lambda given: _judge_state_space(given, num, den), 0, 1)


def _judge_state_space(ask: Ask, num: FloatArray, den: FloatArray) -> Verdict:
    n = den.size - 1
    got = _as_state_space(ask, num, den)
    if got.A.shape[0] != n:
        return Verdict(
            False,
            f"`state_space` makes {got.A.shape[0]} states of a denominator of degree {n}: there are as many as that.",
            "wrong number of states",
        )
    a = den / den[0]
    b = np.r_[np.zeros(n + 1 - num.size), num] / den[0]
    ahead = np.r_[num, np.zeros(n + 1 - num.size)] / den[0]
    c = b[1:] - b[0] * a[1:]

    def form(a_: FloatArray, c_: FloatArray, d: float, into: int = -1) -> StateSpaceValue:
        """The canonical form with a1 .. an and with the entries of C, that of x_n first; u goes `into` a state."""
        A = np.eye(n, k=1)
        A[-1] = -a_[::-1]
        return StateSpaceValue(A, np.eye(n)[:, [into]], c_[np.newaxis, ::-1], np.full((1, 1), d), 1.0)

    direct = float(b[0])
    divide = "`state_space` expects den[0] to be 1. If it is not, divide num *and* den by it."
    G, H, C, D = controllable_form(num, den)
    return judge(
        got,
        StateSpaceValue(G, H, C, D, 1.0),
        _SAME_SYSTEM,
        "it has the transfer function that went in.",
        "`state_space` has another transfer function than num / den. Try it on the example by hand.",
        [
            Slip(
                "sign of a",
                "`state_space` has the other sign of a in its last row: y(k) + a1 y(k-1) ... = ..., so there stands "
                "-a.",
                lambda: form(-a[1:], c, direct),
            ),
            Slip(
                "direct path not taken out",
                "C of `state_space` holds b_i. With a direct path it is b_i - b0 a_i: what goes straight to y must not "
                "go through the states again.",
                lambda: form(a[1:], b[1:], direct),
            ),
            Slip(
                "direct path left out",
                "`state_space` has D = 0 although num is as long as den: there is a direct path, D = b0.",
                lambda: form(a[1:], b[1:], 0),
            ),
            Slip(
                "direct path left out",
                "`state_space` has D = 0 although num is as long as den: there is a direct path, D = b0.",
                lambda: form(a[1:], c, 0),
            ),
            Slip("not divided by den[0]", divide, lambda: form(den[1:], c * den[0], direct * den[0])),
            Slip("not divided by den[0]", divide, lambda: form(a[1:], c * den[0], direct * den[0])),
            Slip("not divided by den[0]", divide, lambda: form(den[1:], c, direct)),
            Slip(
                "num padded on the wrong side",
                "`state_space` pads a short num at its end, which multiplies it by z. The zeros belong in front, with "
                "the high powers.",
                lambda: form(a[1:], ahead[1:] - ahead[0] * a[1:], float(ahead[0])),
            ),
            Slip(
                "num padded on the wrong side",
                "`state_space` pads a short num at its end: the zeros belong in front, with the high powers.",
                lambda: form(a[1:], np.r_[num / den[0], np.zeros(n)][:n], 0),
            ),
            Slip(
                "A transposed",
                f"{'A' if np.allclose(got.A, G.T) else 'the transpose of A'} of `state_space` is that of the form in "
                "which B and C change places: with u going into the last state, -a stands in the last *row* of A."
                if not np.allclose(got.A, G)
                else "B and C of `state_space` have changed places: with this A, u goes into the last state alone.",
                lambda: StateSpaceValue(G.T, H, C, D, 1.0),
            ),
            Slip(
                "B in reverse order",
                "B of `state_space` has its 1 in the first row: u goes into the last state.",
                lambda: form(a[1:], c, direct, into=0),
            ),
            Slip(
                "order of C and of the last row",
                "both the last row of A and C are in reverse order: they begin with -a_n and b_n.",
                lambda: form(a[:0:-1], c[::-1], direct),
            ),
            Slip(
                "order of C",
                "C of `state_space` is in reverse order: its first entry belongs to b_n, its last to b_1.",
                lambda: form(a[1:], c[::-1], direct),
            ),
            Slip(
                "order of the last row",
                "the last row of A is in reverse order: it begins with -a_n and ends with -a_1.",
                lambda: form(a[:0:-1], c, direct),
            ),
        ],
    )


def _as_state_space(ask: Ask, num: FloatArray, den: FloatArray) -> StateSpaceValue:
    """The four matrices as a system; a system of python-control counts, and flat B, C and a plain D do."""
    value = returned(ask, "state_space", num, den)
    if isinstance(value, StateSpaceValue):
        return StateSpaceValue(value.A, value.B, value.C, value.D, 1.0)
    parts = parts_of(value, "state_space", "four matrices", 4)
    A = as_matrix("A of state_space(num, den)", _square(parts[0]), (None, None))
    n = A.shape[0]
    if A.shape != (n, n):
        raise NoAnswer(f"A of `state_space` should be square; it has shape {A.shape}.")
    B, C, D = (as_array(f"{name} of state_space(num, den)", part) for name, part in zip("BCD", parts[1:], strict=True))
    for name, array, shape in (("B", B, (n, 1)), ("C", C, (1, n)), ("D", D, (1, 1))):
        if array.size != n and name != "D":
            raise NoAnswer(f"{name} of `state_space` should have shape {shape}; it has {array.shape}.")
        if array.ndim == 2 and array.shape != shape:
            slip = "rows instead of columns" if array.T.shape == shape else None
            raise NoAnswer(f"{name} of `state_space` should have shape {shape}; it has {array.shape}.", slip)
    if D.size != 1:
        raise NoAnswer(f"D of `state_space` should be one number; it has shape {D.shape}.")
    return StateSpaceValue(A, B.reshape(n, 1), C.reshape(1, n), D.reshape(1, 1), 1.0)


def _square(value: Value) -> Value:
    """A number for the A of one state is as good as a matrix."""
    return np.reshape(value, (1, 1)) if isinstance(value, (int, float)) or np.size(value) == 1 else value  # type: ignore[arg-type]


def check_equations(ask: Ask) -> Verdict:
    """`equations(u, y, na, nb, d)`, for ARX of several delays, AR and FIR."""
    verdict = Verdict(False, "")
    sizes = (
        (1, 1, 1),
        (2, 2, 1),
        (2, 1, 3),
        (1, 3, 0),
        (3, 2, 2),
        (3, 1, 1),
        (0, 3, 0),
        (2, 0, 1),
        (2, 0, 4),
        (0, 1, 2),
    )
    for na, nb, d in sizes:
        u, y = ask.rng.uniform(1, 3, (2, int(ask.rng.integers(12, 18))))
        verdict = _judge_equations(ask, u, y, Structure(na, nb, 0, d))
        if not verdict.passed:
            break
    return verdict


def _judge_equations(ask: Ask, u: FloatArray, y: FloatArray, structure: Structure) -> Verdict:
    na, nb, d, N = structure.na, structure.nb, structure.delay, y.size
    call = f"equations(u, y, {na}, {nb}, {d})"
    parts = returned_parts(ask, "equations", "two things, Phi and Y", 2, u, y, na, nb, d)
    columns = np.shape(as_array(f"Phi of {call}", parts[0]))[1:]
    beside = np.shape(as_array(f"Y of {call}", parts[1]))[1:]
    if columns in ((), (1,)) and beside not in ((), (1,)):
        return Verdict(False, "`equations` returns Y before Phi.", "Phi and Y swapped")
    if columns == (na + nb + 1,) and nb:
        return Verdict(
            False,
            f"Phi of `{call}` has a column too many: `nb` is the *number* of inputs in a row, not the largest lag.",
            "nb taken for the largest lag",
        )
    if columns == (na + nb - 1,):
        return Verdict(
            False,
            f"Phi of `{call}` has {na + nb - 1} column{'s' * (na + nb > 2)}, one too few: na = {na} outputs and nb = "
            f"{nb} inputs make {na + nb}. (`range(1, na)` ends before na.)",
            "one lag too few",
        )
    Phi = as_matrix(f"Phi of {call}", parts[0], (None, na + nb))
    Y = as_vector(f"Y of {call}", parts[1])
    if not Y.size:
        return Verdict(False, f"`{call}` returns no rows: count from k0 to the last sample.", "no rows")
    k0 = max(na, d + nb - 1) if nb else na
    is_right = Phi.shape[0] == N - k0 and _EXACT(Phi, build_equations(structure, u, y, start=k0).Phi)
    held = beside_right_rows((f"Phi of `{call}`", "Y"), Y, y, u, range(k0, N)) if is_right else ""
    if Y.size != Phi.shape[0]:
        unequal = f"`{call}` has {Phi.shape[0]} rows in Phi and {Y.size} in Y: one y(k) for each row. {held}"
        return Verdict(False, unequal.rstrip(), "unequal rows")
    start = N - Y.size
    lagged = [(-y, lag) for lag in range(1, na + 1)] + [(u, lag) for lag in range(d, d + nb)]
    if start == 0 < k0 and _EXACT(Phi, wrapped(lagged)):
        return Verdict(
            False,
            f"Phi of `{call}` goes round: `np.roll` brings the last samples before the first. Leave these rows "
            "out, and begin at k0 = max(na, d + nb - 1).",
            WRAPS,
        )
    if nb == 0 and start == d - 1 > k0:
        return Verdict(
            False,
            f"`{call}` begins at k = {start}, as if u(k-d) were in its rows. With nb = 0 there are no inputs: k0 = na.",
            "lags of inputs that are not there",
        )
    lag = f"the inputs of `{call}` have the wrong lags: the first is u(k-d), and d is {d} here."
    for delay in range(d if nb else 0):
        model = Structure(na, nb, 0, delay)
        if start >= max(na, delay + nb - 1) and _EXACT(Phi, build_equations(model, u, y, start=start).Phi):
            return Verdict(False, lag, "delay not used")
    if start < k0:
        return Verdict(
            False,
            f"`{call}` has {Y.size} rows, and in the first of them there are lags that nobody recorded. Begin at "
            "k0 = max(na, d + nb - 1).",
            "rows before k0",
        )
    if start > k0 and nb and _EXACT(Phi, build_equations(Structure(na, nb, 0, d + 1), u, y, start=start).Phi):
        return Verdict(
            False, f"the inputs of `{call}` have the wrong lags: the first is u(k-d), not u(k-d-1).", "lag off by one"
        )
    if start > k0:
        return Verdict(
            False,
            f"`{call}` has {Y.size} rows, and begins later than it has to: from k0 = "
            f"{'max(na, d + nb - 1)' if nb else 'na'} on all lags are there.",
            "first rows left out",
        )
    if not _EXACT(Y, y[start:]):
        reason = held or f"Y of `{call}` should be the outputs y(k) of its rows, k0 to the end."
        return Verdict(False, reason, LEFT_SIDE)

    def rows(model: Structure, of_u: FloatArray = u, of_y: FloatArray = y) -> FloatArray:
        return build_equations(model, of_u, of_y, start=start).Phi

    right = rows(structure)
    past, inputs = right[:, :na], right[:, na:]
    return judge(
        Phi,
        right,
        _EXACT,
        "one function for ARX with any delay, AR and FIR.",
        f"Phi of `{call}` is not right: write the row of k = k0 down by hand.",
        [
            Slip(
                "sign of a",
                "`equations` has +y in Phi, as the lab has. In the lectures' convention it is -y(k-1), so that theta "
                "holds the a's themselves.",
                lambda: np.column_stack([-past, inputs]),
            ),
            Slip(
                "u and y swapped",
                "`equations` has u and y swapped: outputs first, with a minus, then the inputs.",
                lambda: rows(structure, y, u),
            ),
            Slip(
                "inputs before outputs",
                "`equations` has the inputs before the outputs: theta = [a1, ..., b1, ...].",
                lambda: np.column_stack([inputs, past]),
            ),
            Slip(
                "oldest lag first",
                "`equations` has the oldest lag first; the newest comes first.",
                lambda: np.column_stack([past[:, ::-1], inputs[:, ::-1]]),
            ),
            Slip(
                "sign of u",
                "`equations` has a minus before the inputs as well: B stands on the right-hand side already.",
                lambda: np.column_stack([past, -inputs]),
            ),
            *(
                Slip("lag off by one", lag, partial(rows, Structure(na, nb, 0, delay)))
                for delay in sorted({d + 1, 1} - {d})
                if nb
            ),
            Slip(
                "lag off by one",
                "`equations` has y(k) in the row of y(k), which it is to explain: begin with y(k-1).",
                lambda: np.column_stack([rows(Structure(na + 1, 0), u, np.r_[y[1:], 0])[:, :na], inputs]),
            ),
        ],
    )
