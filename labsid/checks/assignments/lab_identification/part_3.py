"""Checks of part 3 of the lab: the model simulated and compared with the record."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.answer_code import nothing_returned
from labsid.checks.assignments.lab_identification.lab_data import (
    LabData,
    known_data,
    known_model,
    known_vector,
    units_of,
)
from labsid.checks.assignments.lab_identification.signal_panels import Panel, require_panels
from labsid.checks.assignments.lab_identification.simulated_output import (
    SAME,
    judge_entire_run,
    judge_mse,
    judge_second_half,
    read_output,
)
from labsid.checks.compare import as_number
from labsid.checks.double_mistakes import Edit
from labsid.checks.figures import find_curve
from labsid.checks.question import Ask
from labsid.checks.values import Value
from labsid.checks.verdict import BEYOND_RESULTS, PYTHON_ERROR, NoAnswer, Slip, Verdict, first_failure, judge
from labsid.lab.arx import ArxModel
from labsid.lab.simulation import estimate_initial_state, free_response, predict_one_step, simulate
from labsid.lab.verification import mse
from labsid.plots.figure_values import FigureValue

TRIAL_SAMPLES = 160
TRIAL_NOISE = 0.0056
"""Standard deviation of the noise of trials, as a share of the range of y: 0.01 V on the course's record."""
CALLS = ("actual|measured|record", "simul|model|ident")


def check_second_half(ask: Ask) -> Verdict:
    """Step 3a: the second half."""
    return judge_second_half(ask, "y_sim_half", known_data(ask), known_model(ask))


def right_second_half(ask: Ask) -> dict[str, Value]:
    """Step 3a."""
    data = known_data(ask)
    return {"y_sim_half": simulate(known_model(ask), data.u[data.half :])}


def check_entire(ask: Ask) -> Verdict:
    """Step 3a: the entire record."""
    return judge_entire_run(ask, "y_sim", known_data(ask), known_model(ask))


def right_entire(ask: Ask) -> dict[str, Value]:
    """Step 3a."""
    return {"y_sim": simulate(known_model(ask), known_data(ask).u)}


def check_errors(ask: Ask) -> Verdict:
    """Step 3a: both mean squared errors."""
    y, y_half, y_sim, y_sim_half = _measured_and_simulated(ask)
    got = {name: as_number(name, ask.value(name)) for name in ("mse_half", "mse_all")}
    half = y_half.size
    slips = (
        Slip("errors swapped", "mse_half and mse_all are swapped.", lambda: mse(y, y_sim)),
        Slip(
            "state carried over",
            "`mse_half` uses the second half of `y_sim`; use `y_sim_half`.",
            lambda: mse(y_half, y_sim[-half:]),
        ),
        Slip(
            "wrong half",
            "`mse_half` compares with the first half of `y`; use the second.",
            lambda: mse(y[:half], y_sim_half),
        ),
        *(
            Slip(
                "wrong half",
                "`mse_half` is the error of the first half, of `y` and of `y_sim`; use the second, `y[half:]` and "
                "`y_sim_half`.",
                partial(mse, y[:first], y_sim[:first]),
            )
            for first in (half, y.size - half)
        ),
        *(
            Slip(
                "wrong half",
                "`mse_half` compares the first half of `y` with `y_sim_half`, which is simulated with the "
                "second half: use "
                "`y[half:]`.",
                partial(mse, y[: half - 1], cut),
            )
            for cut in (y_sim_half[: half - 1], y_sim_half[1:])
        ),
        *(
            Slip(
                "one sample left out",
                "`mse_half` leaves a sample out: the second half of `y` has as many samples as `y_sim_half`.",
                partial(mse, y_half[part], y_sim_half[part]),
            )
            for part in (slice(1, None), slice(None, -1))
        ),
    )
    whole = Slip(
        "divided by all samples",
        "`mse_half` is divided by the number of *all* samples: the sum is over the second half.",
        lambda: mse(y_half, y_sim_half) * half / y.size,
    )
    raw = {name: known_vector(ask, name) for name in ("y_act", "y_actm")}

    def unlike(name: str, samples: int, simulated: FloatArray) -> list[Slip[float]]:
        return [
            Slip(
                "offset left in",
                f"`{name}` compares with `{signal}`, which contains the offset: compare with `y`.",
                partial(mse, values[-samples:], simulated),
            )
            for signal, values in raw.items()
        ]

    def others(samples: int, simulated: FloatArray) -> list[Edit]:
        return [
            Edit("e", values[-samples:] - simulated, f"`{signal}`, with the offset, is taken for `y`")
            for signal, values in raw.items()
        ]

    parts = [
        Edit("e", y[:half] - y_sim_half, "the first half of `y` is compared with the simulation of the second"),
        Edit("e", y_half - y_sim[-half:], "`y_sim` is taken for `y_sim_half`"),
        Edit("e", y[:half] - y_sim[:half], "the first half of `y` is compared with that of `y_sim`"),
        Edit("e", y - y_sim, "all samples of `y` are compared with `y_sim`"),
    ]
    verdict = judge_mse(
        "mse_half",
        got["mse_half"],
        y_half,
        y_sim_half,
        [*slips, whole, *unlike("mse_half", half, y_sim_half)],
        [*parts, *others(half, y_sim_half)],
    )
    if not verdict.passed:
        return verdict
    halves = [Edit("e", y_half - y_sim_half, "the second half of `y` is compared with `y_sim_half`")]
    return judge_mse(
        "mse_all", got["mse_all"], y, y_sim, unlike("mse_all", y.size, y_sim), [*halves, *others(y.size, y_sim)]
    )


def right_errors(ask: Ask) -> dict[str, Value]:
    """Step 3a."""
    y, y_half, y_sim, y_sim_half = _measured_and_simulated(ask)
    return {"mse_half": mse(y_half, y_sim_half), "mse_all": mse(y, y_sim)}


def check_figure_7(ask: Ask) -> Verdict:
    """Step 3a: Fig. 7."""
    y, y_half, y_sim, y_sim_half = _measured_and_simulated(ask)
    t = known_vector(ask, "t")
    t_half = t[-y_half.size :]
    unit = units_of(ask.record)[1]
    upper = Panel("the upper panel of Fig. 7", {"y": y_half, "y_sim_half": y_sim_half}, (t_half,), CALLS, unit)
    lower = Panel("the lower panel of Fig. 7", {"y": y, "y_sim": y_sim}, (t,), CALLS, unit)
    fig_7 = ask.value("fig_7")
    if isinstance(fig_7, FigureValue) and fig_7.axes:
        axes = fig_7.axes[0]
        if find_curve(axes, y_half, t[: y_half.size]):
            raise NoAnswer(
                "In the upper panel of Fig. 7 the second half is drawn against the times of the first: use `t[half:]`.",
                "time of the first half",
            )
        if find_curve(axes, y_sim[-y_half.size :]) and not find_curve(axes, y_sim_half):
            raise NoAnswer(
                "In the upper panel of Fig. 7 no curve shows `y_sim_half`, but one shows the second half of `y_sim`.",
                "state carried over",
            )
    require_panels("fig_7", fig_7, (upper, lower))
    return Verdict(True, "Fig. 7 shows both comparisons.")


def _measured_and_simulated(ask: Ask) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    y, y_sim, y_sim_half = (known_vector(ask, name) for name in ("y", "y_sim", "y_sim_half"))
    return y, y[-y_sim_half.size :], y_sim, y_sim_half


def check_initial_state(ask: Ask) -> Verdict:
    """Step 3b: a function that simulates from the estimated state, tried on unseen records.

    It may be written for flat arrays or for columns, whichever the student's signals are.
    """
    is_column = np.ndim(ask.known("y")) == 2  # type: ignore[arg-type]
    verdicts: list[Verdict] = []
    for shape in ((-1, 1), (-1,)) if is_column else ((-1,), (-1, 1)):
        try:
            verdicts.append(_check_shape(ask, shape))
        except NoAnswer as nothing:
            verdicts.append(Verdict(False, str(nothing), nothing.slip))
        if verdicts[-1].passed:
            return verdicts[-1]
    named = (verdict for verdict in verdicts if verdict.slip not in (None, PYTHON_ERROR, BEYOND_RESULTS))
    return next(named, verdicts[0])


@first_failure
def _check_shape(ask: Ask, shape: tuple[int, ...]) -> Iterator[Verdict]:
    """Try the function on signals of one shape.

    Without noise every valid estimate finds the state, so the output is the true one for any state coordinates and any
    number of samples used. With noise the estimates differ, but the output is still a free run, and not one from a few
    samples.
    """
    data, model = known_data(ask), known_model(ask)
    name = "simulate_from_start(u, y)"
    for noise in (0.0, TRIAL_NOISE):
        u, y_true = _trial_record(ask.rng, data, model)
        y = y_true + noise * float(np.ptp(data.y)) * ask.rng.standard_normal(y_true.size)
        value = ask.call("simulate_from_start", u.reshape(shape), y.reshape(shape))
        if value is None:
            raise nothing_returned(ask, "simulate_from_start", "the simulated output", "nothing returned")
        got = read_output(name, value)
        if got.size == model.order:
            raise NoAnswer(
                "`simulate_from_start` returns the state; return the output simulated from it.",
                "state instead of the output",
            )
        if got.size != u.size:
            raise NoAnswer(
                f"`{name}` should return one number for each of its {u.size} samples; it returned {got.size}."
            )
        yield _judge_start(got, u, y, y_true, model) if not noise else _judge_free_run(got, u, y, model)
    yield Verdict(True, "It is a simulation that starts at the measured output, also for unseen records.")


def _trial_record(rng: np.random.Generator, data: LabData, model: ArxModel) -> tuple[FloatArray, FloatArray]:
    """An input, and the response of the model from a state far from rest; amplitudes as in the record."""
    size = float(np.ptp(data.u)) / 2
    u = np.repeat(rng.uniform(-size, size, 4), TRIAL_SAMPLES // 4)
    rest = simulate(model, u)
    x0 = rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 1.0, model.order)
    free = free_response(model, u.size) @ x0
    return u, rest + free * (float(np.ptp(data.y)) / 2 / max(abs(free[0]), 1e-3 * np.max(np.abs(free))))


def _judge_start(got: FloatArray, u: FloatArray, y: FloatArray, y_true: FloatArray, model: ArxModel) -> Verdict:
    rest = simulate(model, u)
    slips = [
        Slip(
            "started from rest",
            "It starts from rest: estimate the initial state from `y`, and pass it to the simulation.",
            lambda: rest,
        ),
        Slip(
            "shifted instead of simulated",
            "The output from rest was shifted up or down. The effect of the initial state decays; a shift does not.",
            lambda: rest + y[0] - rest[0],
        ),
        Slip(
            "one-step prediction",
            "It predicts one step ahead from the measured outputs. Simulate from the initial state instead.",
            lambda: predict_one_step(model, u, y),
        ),
        Slip(
            "response from rest left out",
            "It returns the response to the initial state alone: add the response from rest.",
            lambda: y_true - rest,
        ),
        Slip(
            "response from rest not subtracted",
            "The state was fitted to `y` itself. First subtract the response from rest, then fit the state to the "
            "remainder.",
            lambda: rest + _projection(model, y, y.size),
        ),
        Slip(
            "response from rest not subtracted",
            "The state was fitted to `y` itself. First subtract the response from rest, then fit the state to the "
            "remainder.",
            lambda: rest + _projection(model, y, min(50, y.size)),
        ),
        *(
            Slip(
                "outputs for the state",
                "It takes measured outputs themselves for the state. By eq. (2) the output is C x: estimate the x(0) "
                "whose response fits `y`, by least squares.",
                partial(_from_state, model, u, state),
            )
            for state in (y[:2], y[1::-1], np.array([y[0], 0.0]), np.array([0.0, y[0]]), np.array([y[0], y[0]]))
        ),
    ]
    one_state = (
        "Only {} of the {} states is fitted, and the others are left at zero: fit all of them at once, by least "
        "squares on all columns C A^k.{}"
    )
    slips += [
        Slip(
            "one state alone",
            one_state.format(
                f"state {i + 1}",
                model.order,
                "" if subtracted else " And the response from rest is to be subtracted from `y` before.",
            ),
            partial(_of_one_state, model, u, y, i, subtracted),
        )
        for i in range(model.order)
        for subtracted in (True, False)
        if model.order > 1
    ]
    otherwise = (
        "It does not start at the measured output. For noise-free data from the model itself, it should reproduce "
        "the measured output."
    )
    return judge(got, y_true, _near, "", otherwise, slips)


def _of_one_state(model: ArxModel, u: FloatArray, y: FloatArray, i: int, subtracted: bool) -> FloatArray:
    """Output from a state with one entry, fitted to the output alone or to what the response from rest leaves."""
    rest, column = simulate(model, u), free_response(model, u.size)[:, i]
    wanted = y - rest if subtracted else y
    return np.asarray(rest + column * (column @ wanted) / (column @ column), float)


def _from_state(model: ArxModel, u: FloatArray, state: FloatArray) -> FloatArray:
    """Output of eq. (2) from a state."""
    x, y = np.array(state, float), np.zeros(u.size)
    for k in range(u.size):
        y[k] = model.b[::-1] @ x
        x = np.append(x[1:], u[k] - model.a[:0:-1] @ x)
    return y


def _near(a: FloatArray, b: FloatArray) -> bool:
    """Whether two outputs agree; the tolerance allows for ill-conditioned estimates from few samples."""
    return a.shape == b.shape and bool(np.max(np.abs(a - b)) <= 1e-5 * np.max(np.abs(b)))


def _judge_free_run(got: FloatArray, u: FloatArray, y: FloatArray, model: ArxModel) -> Verdict:
    """With noise, judge by whether the output minus the response from rest is a free response of any state."""
    rest = got - simulate(model, u)
    columns = free_response(model, u.size)
    residual = rest - columns @ np.linalg.lstsq(columns, rest, rcond=None)[0]
    if SAME(got - residual, got):
        return _judge_samples(got, u, y, model)
    if SAME(got, y):
        return Verdict(False, "It returns the measured output. Use `y` for the initial state only.", "measured output")
    if np.allclose(got[2:], predict_one_step(model, u, y)[2:], rtol=0, atol=1e-6):
        hint = "It predicts one step ahead from the measured outputs. Use `y` for the initial state only."
        return Verdict(False, hint, "one-step prediction")
    return Verdict(
        False, "It is not a simulation from an initial state: do not use the measured output after the start."
    )


_FEW_SAMPLES = 1.5
"""Error of the run from a state that some samples give, over that from all samples: of 8 samples of the lab's record
1.57, of 10 samples 1.42, of 50 samples 1.02."""
_MOST_SAMPLES = 15


def _judge_samples(got: FloatArray, u: FloatArray, y: FloatArray, model: ArxModel) -> Verdict:
    """Judge a free run by how many samples have given its state."""
    columns, n = free_response(model, u.size), model.order
    least = _noise_gain(columns, columns)
    for samples in range(n, min(_MOST_SAMPLES, u.size)):
        times = _noise_gain(columns, columns[:samples]) / least
        if times < _FEW_SAMPLES:
            break
        if SAME(got, simulate(model, u, estimate_initial_state(model, u, y, samples))):
            return Verdict(
                False,
                f"It takes the state from the first {samples} samples only, with their noise, by which its output is "
                f"{times:.2g} times as far off, on average, as from the state that fits all of `y` best. Fit the state "
                "by least squares to all samples, or to about the first fifty.",
                "state from a few samples",
            )
    return Verdict(True, "")


def _noise_gain(columns: FloatArray, used: FloatArray) -> float:
    """Root-mean-square error of the response from a state that is fitted to white noise of variance 1."""
    factor = np.linalg.qr(used)[1]
    return float(np.linalg.norm(np.linalg.solve(factor.T, columns.T))) if np.all(np.diag(factor)) else float("inf")


def _projection(model: ArxModel, y: FloatArray, samples: int) -> FloatArray:
    columns = free_response(model, y.size)
    fitted: FloatArray = columns @ np.linalg.lstsq(columns[:samples], y[:samples], rcond=None)[0]
    return fitted
