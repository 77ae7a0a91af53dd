"""Checks of recursive extended least squares, and of Fig. 14."""

from collections.abc import Iterator
from functools import cache, partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import as_array, as_figure, as_history, close
from labsid.checks.figures import find_curve, legend_text, no_curve, plain_text, require_label, require_legend
from labsid.checks.question import Ask, returned
from labsid.checks.trials import ARMAX, ARX, trial_record
from labsid.checks.values import Value
from labsid.checks.verdict import RUNS_AWAY, NoAnswer, Slip, Verdict, first_failure, judge
from labsid.estimation.recursion import RecursiveState
from labsid.estimation.recursive import recursive_armax, recursive_least_squares
from labsid.model_structures.lecture_systems import example_7_1

_SAME = close(1e-5)
_OF_A_LONG_RECORD = close(1e-4)
SEED = 71
"""Of the record of Example 7-1 in the notebook."""


@first_failure
def check_rels(ask: Ask) -> Iterator[Verdict]:
    """`rels(u, y, forgetting, LN)`, then the history of Example 7-1."""
    drawn = float(np.round(ask.rng.uniform(0.9, 0.95), 3)), float(ask.rng.integers(4, 9))
    for forgetting, LN in ((1.0, float(ask.rng.integers(15, 25))), drawn):
        samples = int(ask.rng.integers(35, 45))
        yield _judge_history(ask, *trial_record(ask.rng, samples, ask.rng.uniform(0.3, 0.6)), forgetting, LN)
    right = as_array("theta_rels", right_history(ask)["theta_rels"])
    if not _OF_A_LONG_RECORD(as_history("theta_rels", ask.value("theta_rels"), *right.shape), right):
        yield Verdict(False, "`rels` is right, `theta_rels` is not: leave the last line as it was given.")
    yield Verdict(True, "the whole history, with the errors before the update in the regressor.")


def right_history(_: Ask) -> dict[str, Value]:
    """Step 6."""
    return {"theta_rels": _lecture_history()}


@cache
def _lecture_history() -> FloatArray:
    record = example_7_1(np.random.default_rng(SEED))
    return _history(record.u, record.y, 1.0, 1e6)


def _start(p: int, LN: float) -> RecursiveState:
    return RecursiveState(np.zeros(p), LN * np.eye(p), np.inf, np.empty(0))


def _history(u: FloatArray, y: FloatArray, forgetting: float, LN: float) -> FloatArray:
    # The reference forgets at sample 0, too, before there is a regressor; the notes begin with sample 1.
    return recursive_armax(ARMAX, u, y, forgetting, _start(3, LN * forgetting)).theta


def _errors_after_the_update(u: FloatArray, y: FloatArray, forgetting: float, LN: float) -> FloatArray:
    state, e, history = _start(3, LN), 0.0, np.zeros((y.size, 3))
    for n in range(1, y.size):
        phi = np.array([-y[n - 1], u[n - 1], e])
        state = recursive_least_squares(phi[np.newaxis], y[n : n + 1], forgetting, state).state
        history[n] = state.theta
        e = float(y[n] - phi @ state.theta)
    return history


@np.errstate(all="ignore")
def _errors_of_the_sample(u: FloatArray, y: FloatArray, forgetting: float, LN: float, again: bool) -> FloatArray:
    """History of a loop whose regressor holds the error of its own sample; with it, the error is taken `again`."""
    theta, P, e, history = np.zeros(3), LN * np.eye(3), 0.0, np.zeros((y.size, 3))
    for n in range(1, y.size):
        e = float(y[n] - np.array([-y[n - 1], u[n - 1], e]) @ theta)
        phi = np.array([-y[n - 1], u[n - 1], e])
        P_phi = P @ phi
        P = (P - np.outer(P_phi, P_phi) / (forgetting + phi @ P_phi)) / forgetting
        e = float(y[n] - phi @ theta) if again else e
        theta = theta + P @ phi * e
        history[n] = theta
    return history


_FAULTS = {
    "1 in the denominator": ("has 1 + phi'P phi in the denominator of P.", "With forgetting the 1 becomes lambda."),
    "not divided by lambda": ("does not divide P by lambda: without that, nothing is forgotten.", ""),
    "divided by lambda twice": ("divides P by lambda squared.", "It is divided by lambda once."),
    "multiplied by lambda": ("multiplies P by lambda.", "Divide."),
    "gain from the old P": ("takes the gain from the P before the sample.", "K(n) = P(n) phi(n), with the new one."),
}


_ROUNDING_SHOWS = 1e50
"""Size of an estimate that squares itself at each sample, from which on equal formulas may differ in every digit."""


@np.errstate(all="ignore")  # some of them run away
def _faulty(u: FloatArray, y: FloatArray, forgetting: float, LN: float, fault: str) -> FloatArray:
    """History of the notebook's loop with one of the faults in it; rounding is that of the loop."""
    theta, P, e, history = np.zeros(3), LN * np.eye(3), 0.0, np.zeros((y.size, 3))
    in_denominator = 1.0 if fault == "1 in the denominator" else forgetting
    powers = {"not divided by lambda": 0, "multiplied by lambda": 1, "divided by lambda twice": -2}
    factor = forgetting ** powers.get(fault, -1)
    for n in range(1, y.size):
        phi = np.array([-y[n - 1], u[n - 1], e])
        e = float(y[n] - phi @ theta)
        P_phi = P @ phi
        P = (P - np.outer(P_phi, P_phi) / (in_denominator + phi @ P_phi)) * factor
        theta = theta + (P_phi if fault == "gain from the old P" else P @ phi) * e
        history[n] = theta
    return history


def _require_finite(call: str, got: FloatArray, u: FloatArray, y: FloatArray, forgetting: float, LN: float) -> None:
    """Name the fault of a history that grew beyond all numbers, by the samples before rounding grew with them."""
    if np.all(np.isfinite(got)):
        return
    last, sound = (int(np.argmax(~np.all(np.abs(got) < most, axis=1))) for most in (np.inf, _ROUNDING_SHOWS))
    for name, (what, _) in _FAULTS.items():
        if sound > 2 and np.allclose(got[:sound], _faulty(u, y, forgetting, LN, name)[:sound], rtol=1e-3):
            raise NoAnswer(f"`{call}` {what} The estimate then grows without limit.", name)
    raise NoAnswer(
        f"the estimate of `{call}` grows without limit, and is no number from sample {last} on: compare your lines "
        "with those of step 6.",
        RUNS_AWAY,
    )


def _judge_history(ask: Ask, u: FloatArray, y: FloatArray, forgetting: float, LN: float) -> Verdict:
    call = f"rels(u, y, {forgetting}, {LN:g})"
    value = returned(ask, "rels", u, y, forgetting, LN)
    shape = value.shape if isinstance(value, np.ndarray) else ()
    if shape == (y.size - 1, 3):
        less = f"`{call}` has one row less than there are samples"
        if _SAME(as_array(call, value), _history(u, y, forgetting, LN)[:-1]):
            return Verdict(False, f"{less}: the last is missing.", "last row left out")
        return Verdict(False, f"{less}: row 0 is zero, before anything was learnt.", "first row left out")
    if shape == (y.size, 2):
        return Verdict(False, f"`{call}` estimates a and b only: c is the third.", "noise term left out")
    if shape == (y.size, 3) and isinstance(value, np.ndarray) and value.dtype.kind == "f":
        _require_finite(call, np.asarray(value, float), u, y, forgetting, LN)
    got = as_history(call, value, y.size, 3)
    rights = [_history(u, y, forgetting, LN), _history(u, y, forgetting, LN / forgetting)]
    right = next((right for right in rights if _SAME(got, right)), rights[0])
    theta_of_arx = recursive_armax(ARX, u, y, forgetting, _start(2, LN * forgetting)).theta
    return judge(
        got,
        right,
        _SAME,
        "",
        f"`{call}` is off: compare its second row with the case worked by hand in step 6."
        if forgetting == 1
        else f"`{call}` is off, though with forgetting = 1 it is right: look at the two places of lambda in P(n).",
        [
            *(
                Slip(name, f"`{call}` {what}", partial(_faulty, u, y, forgetting, LN, name), mend)
                for name, (what, mend) in _FAULTS.items()
            ),
            Slip(
                "errors after the update",
                f"`{call}` puts the error that is left after the update into the next regressor: it is "
                "epsilon(n) = y(n) - phi'(n) theta(n-1), computed with the estimate before the update.",
                lambda: _errors_after_the_update(u, y, forgetting, LN),
            ),
            *(
                Slip(
                    "error of the same sample",
                    f"`{call}` has epsilon(n) in the regressor of y(n), which is the error of that very sample: it is "
                    "epsilon(n-1), the one before.",
                    partial(_errors_of_the_sample, u, y, forgetting, LN, again),
                )
                for again in (False, True)
            ),
            Slip(
                "index wraps around",
                f"`{call}` begins with n = 0, where `y[n - 1]` is the *last* sample of the record: begin with n = 1.",
                lambda: _faulty(np.append(u[-1], u), np.append(y[-1], y), forgetting, LN, "")[1:],
            ),
            Slip(
                "noise term left out",
                f"`{call}` never fills the third place of the regressor with epsilon(n-1).",
                lambda: np.column_stack([theta_of_arx, np.zeros(y.size)]),
            ),
            Slip("forgetting not used", f"`{call}` does not forget: use lambda.", lambda: _history(u, y, 1.0, LN)),
            Slip(
                "LN not used",
                f"`{call}` starts from another P(0): it is LN times the unit matrix.",
                lambda: _faulty(u, y, forgetting, 1e6, ""),
            ),
            Slip(
                "LN not used",
                f"`{call}` starts from another P(0): it is LN times the unit matrix.",
                lambda: _faulty(u, y, forgetting, 1.0, ""),
            ),
            Slip(
                "sign of a",
                f"`{call}` has the other sign of a: the regressor holds -y(n-1).",
                lambda: right * [-1, 1, 1],
            ),
            Slip(
                "sign of c",
                f"`{call}` has the other sign of c: the regressor holds +epsilon(n-1).",
                lambda: right * [1, 1, -1],
            ),
            Slip(
                "lag off by one",
                f"`{call}` takes u(n) where the regressor has u(n-1).",
                lambda: _history(np.append(u[1:], 0.0), y, forgetting, LN),
            ),
        ],
    )


def new_history(ask: Ask) -> dict[str, Value]:
    """A history to practise with, of a record of its own."""
    u, y = trial_record(ask.rng, 300, float(ask.rng.uniform(0.2, 0.6)))
    return {"theta_rels": _history(u, y, 1.0, 1e3)}


def check_figure_14(ask: Ask) -> Verdict:
    """Fig. 14: the three parameters over the samples."""
    axes = as_figure("fig_14", ask.value("fig_14"), axes=1).axes[0]
    history = as_array("theta_rels", ask.known("theta_rels"))
    if not axes.curves:
        raise NoAnswer("`fig_14` is empty: draw in its axes, with `plot`.", "empty axes")
    curves = [find_curve(axes, column) for column in history.T]
    missing = [name for name, curve in zip("abc", curves, strict=True) if curve is None]
    if missing:
        what = f"{' or '.join(missing)}, of the columns of `theta_rels`"
        raise no_curve(axes, "Fig. 14", what, history[:, "abc".index(missing[0])], "Draw them over all samples.")
    require_label(axes, "Fig. 14", "x", "")
    require_legend(axes, "Fig. 14", 3)
    names = [_letter(legend_text(axes, curve)) for curve in curves if curve is not None]
    if sorted(names) == ["a", "b", "c"] and names != ["a", "b", "c"]:
        return Verdict(False, "In Fig. 14 the names in the legend are swapped.", "legend entries swapped")
    return Verdict(True, "three histories, and what they settle on.")


def _letter(text: str) -> str:
    return plain_text(text.replace("hat", "")).replace("\\", "")
