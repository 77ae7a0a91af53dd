"""Checks of steps 1, 3 and 5 of the appendix: step-response modelling (Fig. A1, A2)."""

from collections.abc import Iterator
from functools import partial
from itertools import permutations

import numpy as np
from scipy.signal import lsim

from labsid._arrays import FloatArray
from labsid.checks.answer_code import code_of
from labsid.checks.assignments.lab_identification.simulated_output import wrong_means
from labsid.checks.assignments.step_response.formula import response_slips
from labsid.checks.assignments.step_response.readings import Step, judge_reading, own_answer
from labsid.checks.compare import as_number, as_vector, close
from labsid.checks.curve_names import NamedCurve, require_own_names
from labsid.checks.figures import one_figure, require_curve, require_labels, require_legend
from labsid.checks.question import Ask, returned
from labsid.checks.values import Value
from labsid.checks.verdict import Slip, Verdict, first_failure, judge
from labsid.lab.step_comparison import second_order_example, second_order_response
from labsid.lab.step_response import (
    FirstOrderDelay,
    first_order_response,
    fit_step_response,
)
from labsid.lab.verification import mse

AMPLITUDE = 2.0
PARAMETERS = ("K", "tau", "td")

_same = close(1e-6)

PROCESS_NUMBERS = "numbers of the process"
_GAIN, _TIME_CONSTANTS = 3.0, (5.0, 1.0)  # of the process in the text
_NAMES_OF_THE_SYSTEM = (
    r"original|second|2nd|process|plant|\btrue\b|exact|\by ?step\b",
    r"system|measured|record|\bdata\b|\brig\b",
)
_NAMES_OF_THE_MODEL = (
    r"approx|first[ -]?order|1st|delay|fopdt|simplif|reduced|\bfit",
    r"model|estimate|identified|simulat",
)


def _recorded() -> tuple[FloatArray, FloatArray]:
    """`t_step` and `y_step` of the notebook."""
    t = np.linspace(0, 40, 801)
    return t, second_order_response(second_order_example(), t, AMPLITUDE)


def _response(t: FloatArray, K: float, tau: float, td: float, amplitude: float) -> FloatArray:
    return first_order_response(FirstOrderDelay(K, tau, td), t, amplitude)


def check_read(ask: Ask) -> Verdict:
    """Step 1: K, tau and td of the recorded response."""
    got = np.array([as_number(name, ask.value(name)) for name in PARAMETERS])
    t, y = _recorded()
    verdict = judge_reading(
        got, Step(t, y, AMPLITUDE, 0.02), "", "gain, time constant and delay fit the response.", code_of(ask)
    )
    if not verdict.passed and got[0] == _GAIN and got[1] in (*_TIME_CONSTANTS, sum(_TIME_CONSTANTS)):
        K, tau, td = (f"{number:g}" for number in got)
        return Verdict(
            False,
            f"K = {K} and tau = {tau} are numbers of the process, 3/((5s + 1)(s + 1)), which has two time constants. "
            f"A first-order model with tau = {tau} and td = {td} does not reach 28.3 % and 63.2 % when `y_step` does: "
            "read both times from the response.",
            PROCESS_NUMBERS,
        )
    return verdict


def check_approximation(ask: Ask) -> Verdict:
    """Step 3: y_approx and its mean squared error."""
    t, y = _recorded()
    K, tau, td = (as_number(name, ask.known(name)) for name in PARAMETERS)
    got = as_vector("y_approx", ask.value("y_approx"), t.size)
    right = _response(t, K, tau, td, AMPLITUDE)
    if not _same(got, right):
        carried = own_answer(ask, "first_order_response", t, K, tau, td, AMPLITUDE)
        simulated = next((run for run in _delayed_steps(t, K, tau, td) if _same(got, run)), None)
        carried = carried if simulated is None else simulated
        if carried is None or not _same(got, carried) or np.ptp(carried) == 0:
            return judge(
                got,
                right,
                _same,
                "",
                "`y_approx` is not the response of your model to the step of amplitude 2 at the times `t_step`.",
                [
                    Slip(
                        "amplitude of one",
                        "`y_approx` is the response to a step of amplitude 1; the recorded step has amplitude 2.",
                        lambda: right / AMPLITUDE,
                    ),
                    *(
                        Slip(
                            "arguments in another order",
                            "`y_approx`: the arguments are handed over in another order than that of "
                            "`first_order_response(t, K, tau, td, amplitude)`.",
                            partial(_response, t, *order),
                        )
                        for order in list(permutations((K, tau, td, AMPLITUDE)))[1:]
                    ),
                    Slip(
                        PROCESS_NUMBERS,
                        "`y_approx` is made with the numbers of the process, 3, 5 and 1. Your model has K, tau and td.",
                        partial(_response, t, 3.0, 5.0, 1.0, AMPLITUDE),
                    ),
                    Slip(
                        "the record itself",
                        "`y_approx` is `y_step` itself: compute the response of your model, with its K, tau and td.",
                        lambda: y,
                    ),
                    *response_slips("`y_approx`", t, FirstOrderDelay(K, tau, td), AMPLITUDE),
                ],
            )
        right = carried
    error = y - right
    not_squared = "`mse_approx` is the mean of the errors, or of |error|: square them first."
    return judge(
        as_number("mse_approx", ask.value("mse_approx")),
        mse(y, right),
        _same,
        "the mean squared error measures how close the approximation is.",
        "`mse_approx` is not the mean of the squared differences of `y_step` and `y_approx`.",
        [
            Slip(
                "root mean square",
                "`mse_approx` is the root of the mean squared error: leave the root out.",
                lambda: float(np.sqrt(np.mean(error**2))),
            ),
            Slip(
                "sum in place of the mean",
                "`mse_approx` is the sum: divide by N.",
                lambda: float(np.sum(error**2)),
            ),
            Slip(
                "norm of the error",
                "`mse_approx` is the norm of the error: square it and divide by N.",
                lambda: float(np.linalg.norm(error)),
            ),
            Slip(
                "norm of the error",
                "`mse_approx` is the norm of the error over N: the norm is a root. Square it before you divide.",
                lambda: float(np.linalg.norm(error)) / error.size,
            ),
            Slip(
                "divided by the root of N",
                "`mse_approx` is the sum of the squares over the root of N: divide by N.",
                lambda: float(np.sum(error**2) / np.sqrt(error.size)),
            ),
            *wrong_means("mse_approx", as_number("mse_approx", ask.value("mse_approx")), error**2),
            # the same where the model is above or below the data throughout
            Slip("not squared", not_squared, lambda: float(np.mean(error))),
            Slip("not squared", not_squared, lambda: float(np.mean(abs(error)))),
            Slip(
                "mean squared",
                "`mse_approx` is the square of the mean error: square first, then average.",
                lambda: float(np.mean(error)) ** 2,
            ),
            Slip(
                "half the mean",
                "`mse_approx` has a factor 1/2; the MSE has none.",
                lambda: float(np.mean(error**2)) / 2,
            ),
        ],
    )


def _delayed_steps(t: FloatArray, K: float, tau: float, td: float) -> Iterator[FloatArray]:
    """The responses that a simulation gives to a step that is delayed to a sample, as in the cell of step 4."""
    for late in (t >= td, t > td):
        for interpolate in (True, False):
            with np.errstate(all="ignore"):
                yield np.asarray(lsim(([K], [tau, 1.0]), AMPLITUDE * late, t, interp=interpolate)[1], float)


def new_approximation(ask: Ask) -> dict[str, Value]:
    """The response of another model beside the step of the text, to practise with."""
    t, y = _recorded()
    model = FirstOrderDelay(ask.rng.uniform(2.5, 3.5), ask.rng.uniform(3, 8), ask.rng.uniform(0.5, 2))
    return {"t_step": t, "y_step": y, "y_approx": first_order_response(model, t, AMPLITUDE)}


def check_comparison(ask: Ask) -> Verdict:
    """Step 3: the figure with both responses."""
    t, y = _recorded()
    axes = one_figure("fig_a2", ask.value("fig_a2"))
    y_approx = np.asarray(ask.known("y_approx"))
    original = require_curve(axes, "`fig_a2`", "the response `y_step` of the original system", y, t)
    model = require_curve(axes, "`fig_a2`", "the response `y_approx` of your model", y_approx, t)
    require_labels(axes, "`fig_a2`", ("s", "V"))
    require_legend(axes, "`fig_a2`", 2)
    require_own_names(
        axes,
        "`fig_a2`",
        NamedCurve(original, "the original system (`y_step`)", *_NAMES_OF_THE_SYSTEM),
        NamedCurve(model, "your first-order model (`y_approx`)", *_NAMES_OF_THE_MODEL),
    )
    return Verdict(True, "both responses in one figure.")


@first_failure
def check_function(ask: Ask) -> Iterator[Verdict]:
    """Step 5: read_step on other processes, levels and amplitudes, with noise."""
    for step in _trial_steps(ask.rng):
        value = returned(ask, "read_step", step.t, step.y, step.amplitude)
        got = as_vector("read_step(...)", value, 3)
        yield judge_reading(
            got,
            step,
            "`read_step`: ",
            "it also reads other processes, steps up and down, and noisy records.",
            code_of(ask, "read_step"),
        )


def _trial_steps(rng: np.random.Generator) -> list[Step]:
    """Steps from zero, from another level, downwards, with noise, without a delay, and of a process that falls."""
    steps = []
    for level, sign, noise, delays, gain in (
        (0.0, 1, 0.0, 1, 1), (1.0, 1, 0.0, 1, 1), (1.0, -1, 0.0, 1, 1), (1.0, -1, 0.003, 1, 1), (1.0, 1, 0.0, 0, 1),
        (1.0, 1, 0.003, 1, -1),
    ):  # fmt: skip
        # gains well above 1 and many samples per second: each mistake then gives a value of its own
        tau = float(rng.uniform(2, 7))
        model = FirstOrderDelay(gain * float(rng.uniform(1.6, 4)), tau, delays * tau * float(rng.uniform(0.25, 0.6)))
        amplitude = sign * float(rng.uniform(1.3, 5))
        change = model.K * amplitude
        t: FloatArray = tau / 40 * np.arange(rng.integers(340, 420), dtype=np.float64)
        y = level * abs(change) * float(rng.uniform(2.3, 3.5)) + first_order_response(model, t, amplitude)
        y += noise * abs(change) * rng.standard_normal(t.size)
        steps.append(Step(t, y, amplitude, 0.015))
    return steps


def right_reading(ask: Ask) -> dict[str, Value]:
    """Gain, time constant and delay, read from the example step."""
    model = fit_step_response(*_recorded(), AMPLITUDE).reading
    return {"K": model.K, "tau": model.tau, "td": model.td}


def right_approximation(ask: Ask) -> dict[str, Value]:
    """The first-order approximation and its error."""
    model = FirstOrderDelay(*(as_number(name, ask.known(name)) for name in PARAMETERS))
    t, y = _recorded()
    approximate = first_order_response(model, t, AMPLITUDE)
    return {"y_approx": approximate, "mse_approx": mse(y, approximate)}
