"""Checks of part 2 of the lab: Phi, theta, and the model as transfer function and state space."""

from collections.abc import Iterable

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.assignments.lab_identification.lab_data import known_data, known_model, known_vector
from labsid.checks.assignments.lab_identification.phi_and_theta import (
    judge_equations,
    judge_theta,
    right_equations,
    rounded,
)
from labsid.checks.compare import as_number, close
from labsid.checks.compare_systems import SystemValue, as_system, same_response
from labsid.checks.question import Ask
from labsid.checks.values import StateSpaceValue, TransferFunctionValue, Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, judge
from labsid.lab.arx import ArxModel, arx_from_theta, canonical_form
from labsid.least_squares.solve import solve_least_squares

NAMES = ("Phi", "Y")


def check_phi(ask: Ask) -> Verdict:
    """Step 2a: Phi and Y."""
    return judge_equations(ask, NAMES, known_data(ask), 2)


def right_phi(ask: Ask) -> dict[str, Value]:
    """Step 2a."""
    data = known_data(ask)
    return right_equations(NAMES, data, 2) | {"half": data.half}


def check_theta(ask: Ask) -> Verdict:
    """Step 2b: theta."""
    return judge_theta(ask, "theta_hat", *_known_equations(ask), known_data(ask), 2)


def right_theta(ask: Ask) -> dict[str, Value]:
    """Step 2b."""
    return {"theta_hat": solve_least_squares(*_known_equations(ask)).theta}


def check_parameters(ask: Ask) -> Verdict:
    """Step 2b: a1, a2, b1, b2 read off theta."""
    right = _read_off(known_vector(ask, "theta_hat"))
    got = np.array([as_number(name, ask.value(name)) for name in right])
    a1, a2, b1, b2 = values = np.array(list(right.values()))
    slips = [
        Slip(
            "sign of a",
            "theta contains -a1 and -a2: change the signs of the first two.",
            lambda: np.array([-a1, -a2, b1, b2]),
        ),
        Slip("sign of a", "a1 has the wrong sign: theta contains -a1.", lambda: np.array([-a1, a2, b1, b2])),
        Slip("sign of a", "a2 has the wrong sign: theta contains -a2.", lambda: np.array([a1, -a2, b1, b2])),
        Slip(
            "sign of b",
            "b1 and b2 keep their signs: only a is negative in theta.",
            lambda: np.array([a1, a2, -b1, -b2]),
        ),
        Slip(
            "sign of b",
            "All signs are wrong: theta contains -a1 and -a2, but +b1 and +b2.",
            lambda: np.array([-a1, -a2, -b1, -b2]),
        ),
        Slip(
            "a and b swapped",
            "a and b are swapped.",
            lambda: np.array([-b1, -b2, -a1, -a2]),
            mend="theta = [-a1, -a2, b1, b2].",
        ),
        Slip(
            "a and b swapped",
            "a and b are swapped.",
            lambda: np.array([b1, b2, a1, a2]),
            mend="theta = [-a1, -a2, b1, b2].",
        ),
        Slip(
            "a and b swapped",
            "a and b are swapped.",
            lambda: np.array([b1, b2, -a1, -a2]),
            mend="theta = [-a1, -a2, b1, b2].",
        ),
        Slip(
            "a1 and a2 swapped",
            "a1 and a2 are swapped.",
            lambda: np.array([a2, a1, b1, b2]),
            mend="theta = [-a1, -a2, b1, b2].",
        ),
        Slip(
            "b1 and b2 swapped",
            "b1 and b2 are swapped.",
            lambda: np.array([a1, a2, b2, b1]),
            mend="theta = [-a1, -a2, b1, b2].",
        ),
        Slip(
            "order of theta",
            "The parameters are in reverse order.",
            lambda: np.array([a2, a1, b2, b1]),
            mend="theta = [-a1, -a2, b1, b2].",
        ),
        *rounded(values, "The parameters are rounded: keep all the digits of theta_hat."),
    ]
    otherwise = (
        "a1, a2, b1, b2 do not agree with theta_hat: theta = [-a1, -a2, b1, b2]."
        f"{_taken(got, known_vector(ask, 'theta_hat'))}"
    )
    return judge(got, values, close(1e-9), "The parameters have the right signs.", otherwise, slips)


def _taken(got: FloatArray, theta: FloatArray) -> str:
    """Which entries of theta the parameters are, where each is one up to its sign; and if they are counted from 1."""
    same = np.isclose(np.abs(got[:, np.newaxis]), np.abs(theta), rtol=1e-9, atol=0.0)
    if not np.all(np.sum(same, axis=1) == 1):
        return ""
    index = np.argmax(same, axis=1)
    said = [
        f"{name} = {'-' if got[i] * theta[k] < 0 else ''}theta_hat[{k}]"
        for i, (name, k) in enumerate(zip(("a1", "a2", "b1", "b2"), index, strict=True))
    ]
    from_1 = " Python counts from 0: -a1 is theta_hat[0]." if np.array_equal(index[:3], [1, 2, 3]) else ""
    return f" Yours are {', '.join(said)}.{from_1}"


def right_parameters(ask: Ask) -> dict[str, Value]:
    """Step 2b."""
    return dict(_read_off(known_vector(ask, "theta_hat")))


def check_transfer_function(ask: Ask) -> Verdict:
    """Step 2c: G."""
    return judge_transfer_function("G", ask.value("G"), known_model(ask), "eq. (1)")


def judge_transfer_function(
    name: str, value: Value, model: ArxModel, equation: str, more: Iterable[Slip[SystemValue]] = ()
) -> Verdict:
    """Judge a transfer function by its frequency response.

    `equation` is where the notebook has its formula, and `more` are further known mistakes.
    """
    got = as_system(name, value)
    if isinstance(got, StateSpaceValue):
        raise NoAnswer(
            f"`{name}` is a state space; make the transfer function with `ct.tf`.",
            "state space instead of transfer function",
        )
    require_sampling_time(name, got, model.Ts)
    a, b, Ts = model.a, model.b, model.Ts
    other_sign = np.concatenate([[1.0], -a[1:]])

    def slip(short: str, hint: str, num: FloatArray, den: FloatArray) -> Slip[SystemValue]:
        return Slip(short, hint, lambda: TransferFunctionValue(num, den, Ts))

    zero, index = np.zeros(1), "1" if b.size == 1 else ""
    slips = [
        slip(
            "sign of a",
            "The denominator has the signs of theta: it should be 1, +a1, ..., whereas theta contains -a.",
            b,
            other_sign,
        ),
        slip("theta in place of the denominator", "The denominator lacks its leading 1.", b, a[1:]),
        slip("numerator and denominator swapped", "Numerator and denominator are swapped.", a, b),
        slip("order of b", "The numerator is in reverse order: b1 belongs to the higher power of z.", b[::-1], a),
        slip(
            "order of a",
            "The denominator is in reverse order: it begins with the highest power of z, whose coefficient is 1.",
            b,
            a[::-1],
        ),
        slip("sign of b", "The numerator has the wrong sign.", -b, a),
        *more,
        slip(
            "numerator one step early",
            "The numerator has the same order as the denominator, so that the output is one sample early: remove "
            "the trailing zero.",
            np.concatenate([b, zero]),
            a,
        ),
        slip(
            "numerator one step late",
            "The denominator ends with a zero, which makes it one power of z too high: leave that zero out."
            if isinstance(got, TransferFunctionValue) and got.den.size > a.size and got.den[-1] == 0
            else "The numerator is one power of z too low: b1 multiplies the power below the highest.",
            b,
            np.concatenate([a, zero]),
        ),
        slip(
            "ascending powers",
            "Numerator and denominator are in reverse order: the highest power of z comes first.",
            b[::-1],
            a[::-1],
        ),
        *(
            slip(
                "b in the denominator",
                f"The denominator holds b{index} where a{index} belongs: theta begins with -a, and b comes after it.",
                b,
                np.concatenate([[1.0], sign * b]),
            )
            for sign in (1, -1)
        ),
        *(
            slip(
                "a in the numerator",
                f"The numerator holds a{index} where b{index} belongs: theta begins with -a, and b comes after it.",
                sign * a[1:],
                a,
            )
            for sign in (1, -1)
        ),
        slip("a and b swapped", "a and b are swapped.", a[1:], np.concatenate([[1.0], b])),
        *(
            slip(
                "a and b swapped",
                "a and b are swapped: theta begins with -a, and b comes after it."
                f"{' The minus sign belongs to the entries that hold -a.' if sign < 0 else ''}",
                turn * a[1:],
                np.concatenate([[1.0], sign * b]),
            )
            for turn, sign in ((-1, 1), (-1, -1), (1, -1))
        ),
    ]
    otherwise = f"`{name}` does not have the response of {equation} with your parameters. Compare it with {equation}."
    right = TransferFunctionValue(b, a, Ts)
    return judge(got, right, same_response(1e-6), f"It has the response of {equation}.", otherwise, slips)


def right_transfer_function(ask: Ask) -> dict[str, Value]:
    """Step 2c."""
    model = known_model(ask)
    return {"G": TransferFunctionValue(model.b, model.a, model.Ts)}


def check_state_space(ask: Ask) -> Verdict:
    """Step 2c: G_ss, in any state coordinates."""
    model = known_model(ask)
    got = as_system("G_ss", ask.value("G_ss"))
    if isinstance(got, TransferFunctionValue):
        raise NoAnswer(
            "`G_ss` is a transfer function; make the state space with `ct.ss`.",
            "transfer function instead of state space",
        )
    require_sampling_time("G_ss", got, model.Ts)
    if got.A.shape != (2, 2):
        raise NoAnswer(f"`G_ss` has {got.A.shape[0]} states; a second-order model has 2.", "number of states")
    G, H, C, D = canonical_form(model)

    def are(*matrices: FloatArray) -> bool:
        own = (got.A, got.B, got.C, got.D)
        pairs = zip(own, matrices, strict=True)
        return all(m.shape == w.shape and np.allclose(m, w, atol=1e-9) for m, w in pairs)

    def slip(
        short: str, hint: str, A: FloatArray, B: FloatArray, C: FloatArray, D: FloatArray, elsewhere: str = ""
    ) -> Slip[SystemValue]:
        """A slip; `elsewhere` is what is said where the response is the same, and the matrices are others."""
        said = hint if are(A, B, C, D) or not elsewhere else f"In the state coordinates of your matrices, {elsewhere}"
        return Slip(short, said, lambda: StateSpaceValue(A, B, C, D, model.Ts))

    model_with = "the response is that of a model with"
    sign = np.array([[1.0], [-1.0]])
    slips = [
        slip(
            "sign of a",
            "The last row of the matrix G has the wrong signs: compare it with eq. (2).",
            sign * G,
            H,
            C,
            D,
            f"{model_with} the other signs of a1 and a2.",
        ),
        slip(
            "a1 and a2 swapped",
            "a1 and a2 are swapped in the last row of the matrix G: compare it with eq. (2).",
            np.vstack([G[0], G[1, ::-1]]),
            H,
            C,
            D,
            f"{model_with} a1 and a2 swapped.",
        ),
        slip("B and C exchanged", "The matrices B and C are exchanged: B is H, a column of 0 and 1.", G, C.T, H.T, D)
        if got.A.shape == G.shape and np.allclose(got.A, G, atol=1e-9)
        else slip(
            "transposed matrix",
            "The matrix G is transposed: in yours the last column holds the parameters, and in eq. (2) the last *row* "
            "does.",
            G.T,
            H,
            C,
            D,
        ),
        slip(
            "b1 and b2 swapped",
            "b1 and b2 are swapped in C: compare it with eq. (2).",
            G,
            H,
            C[:, ::-1],
            D,
            f"{model_with} b1 and b2 swapped.",
        ),
        slip(
            "H reversed",
            "H is reversed: in yours the input drives the first state, and in eq. (2) the second.",
            G,
            H[::-1],
            C,
            D,
        ),
        slip(
            "rows of another form",
            "The matrix G is of another canonical form, with -a1, -a2 in its first row: H and C belong to eq. (2).",
            G[::-1, ::-1],
            H,
            C,
            D,
        ),
        slip("feed-through", "D should be 0: u(k) does not act on y(k) in the same sample.", G, H, C, D + 1),
        slip("sign of b", "C has the wrong sign.", G, H, -C, D, f"{model_with} the other signs of b1 and b2."),
    ]
    otherwise = "`G_ss` does not have the response of eq. (2) with your parameters. Compare its matrices with eq. (2)."
    praise = (
        "It has the form of eq. (2)."
        if are(G, H, C, D)
        else "It has the response of eq. (2), in other state coordinates."
    )
    right = StateSpaceValue(G, H, C, D, model.Ts)
    return judge(got, right, same_response(1e-6), praise, otherwise, slips)


def right_state_space(ask: Ask) -> dict[str, Value]:
    """Step 2c."""
    model = known_model(ask)
    return {"G_ss": StateSpaceValue(*canonical_form(model), model.Ts)}


def require_sampling_time(name: str, system: SystemValue, Ts: float) -> None:
    """Require a model in discrete time with the sampling time of the record."""
    if system.dt is None:
        raise NoAnswer(
            f"`{name}` has no sampling time: python-control takes it for a model in continuous time, "
            f"or, with `True`, for "
            "one in discrete time with an unknown sampling time. Give `Ts` as the last argument.",
            "no sampling time",
        )
    if abs(system.dt - Ts) > 1e-6 * Ts:
        raise NoAnswer(
            f"The sampling time of `{name}` is {system.dt:g} s; it should be that of the record.", "wrong sampling time"
        )


def _known_equations(ask: Ask) -> tuple[FloatArray, FloatArray]:
    return np.asarray(ask.known("Phi"), float).reshape(-1, 4), known_vector(ask, "Y")


def _read_off(theta_hat: FloatArray) -> dict[str, float]:
    model = arx_from_theta(theta_hat, 1.0)
    return {"a1": float(model.a[1]), "a2": float(model.a[2]), "b1": float(model.b[0]), "b2": float(model.b[1])}
