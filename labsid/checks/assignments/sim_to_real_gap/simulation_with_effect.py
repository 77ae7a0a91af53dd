"""Steps 7 and 9 of the gap: the simulation with the effect in it, and how much of the gap it closes.

In the notebook it is played on the student's own record, of which the second half counts; the judge, who can make
the rig again, plays it on a run of which the student has seen nothing.
"""

from dataclasses import dataclass
from functools import partial

import numpy as np

from labsid._arrays import FloatArray, freeze
from labsid.checks.answer_code import code_of, nothing_returned
from labsid.checks.assignments.lab_identification.lab_data import known_vector
from labsid.checks.compare import as_number, as_vector, close
from labsid.checks.double_mistakes import Edit, pairs_of
from labsid.checks.question import Ask, returned
from labsid.checks.verdict import BEYOND_RESULTS, NoAnswer, Slip, Verdict, judge
from labsid.lab.arx import arx_from_theta
from labsid.lab.simulation import simulate

ENOUGH = 0.85
"""Share of the gap that the right effect closes with a simple integrator too (0.91 and more), and a wrong one does not
(0.70 at most), measured over the rigs of the course."""

_CLOSED = "your simulation does what the rig does."


@dataclass(frozen=True, slots=True, eq=False)
class _Run:
    """A run of the student's rig on which simulations are scored: from sample `first` on, above the noise."""

    u: FloatArray
    y: FloatArray
    linear: FloatArray
    first: int
    noise: float

    def __post_init__(self) -> None:
        freeze(self, u=self.u, y=self.y, linear=self.linear)

    def closed(self, y_sim: FloatArray) -> float:
        """Share of the linear model's gap that `y_sim` closes."""
        return closed_share(self._mse(y_sim), self._mse(self.linear), self.noise)

    def _mse(self, y_sim: FloatArray) -> float:
        return float(np.mean((y_sim - self.y)[self.first :] ** 2))


def closed_share(mse_after: float, mse_before: float, noise: float) -> float:
    """The formula of step 9."""
    left = max(mse_after - noise**2, 0.0) / max(mse_before - noise**2, 1e-30)
    return float(1 - np.sqrt(left))


_NO_EFFECT = "no effect added"


def check_simulation(ask: Ask) -> Verdict:
    """Step 7: `simulate_better(u_act)` on a run of the rig."""
    run = _run(ask)
    y_sim = _played(ask, run.u)
    verdict = _judge_run(ask, run, y_sim)
    if verdict.passed:
        return _other_inputs(ask, run, y_sim)
    if verdict.slip == _NO_EFFECT and np.allclose(y_sim, _played(ask, run.u[::-1])):
        return Verdict(
            False,
            "`simulate_better` returns the output of the linear model on your record, whatever it is handed: its "
            "argument is ignored. Let it simulate its argument, with the effect.",
            "argument not used",
        )
    slip = _slip_of_more_runs(ask, run, y_sim) if verdict.slip is None else None
    return verdict if slip is None else Verdict(False, *slip)


def check_one_run(ask: Ask) -> Verdict:
    """Step 7 from one result of `simulate_better(u_act)`."""
    run = _run(ask)
    return _judge_run(ask, run, _played(ask, run.u))


def _judge_run(ask: Ask, run: _Run, y_sim: FloatArray) -> Verdict:
    if run.closed(y_sim) >= ENOUGH:
        return Verdict(True, _CLOSED)
    slip = _slip_of_one_run(ask, run, y_sim)
    if slip is not None:
        return Verdict(False, *slip)
    return Verdict(
        False,
        f"`simulate_better` closes less than {100 * ENOUGH:.0f} % of the gap. If the linear part was refitted with the "
        "effect and the fit started inside the range that is used, then it is another effect.",
    )


def _other_inputs(ask: Ask, run: _Run, y_sim: FloatArray) -> Verdict:
    """Whether the output follows from the input: another one for another, and its beginning for the beginning."""
    if np.allclose(y_sim, _played(ask, run.u[::-1])):
        return Verdict(
            False,
            "`simulate_better` returns the same for another input, the pump voltages in reverse order: its argument is "
            "ignored. It is handed other inputs, and simulates them.",
            "argument not used",
        )
    samples = int(run.u.size * ask.rng.uniform(0.4, 0.8))
    short = _played(ask, run.u[:samples])
    if np.max(np.abs(short - y_sim[:samples])) > 0.01 * np.ptp(y_sim):
        return Verdict(
            False,
            f"`simulate_better` returns other values for the first {samples} samples alone than for the same samples "
            "of the whole input: an output cannot depend on what comes later, nor on the length of the input.",
            "one length only",
        )
    return _at_rest(ask, run, y_sim)


_MOVES_AT_REST = 0.02
"""Of the range of the output: a model whose rest is not exactly at `u_offset` has settled in half of a record."""


def _at_rest(ask: Ask, run: _Run, y_sim: FloatArray) -> Verdict:
    """Whether nothing moves while the input rests, beyond the length of the record, too."""
    rest = np.full(run.u.size, ask.record.u[0])
    moves = float(np.ptp(_played(ask, rest)[run.u.size // 2 :]))
    if moves > _MOVES_AT_REST * np.ptp(y_sim):
        return Verdict(
            False,
            f"`simulate_better` moves by {moves:.3g} V in the second half of a run in which the input rests at "
            f"`u_offset` throughout. A rig at rest stays there: the output follows from `u_act` alone, and not from "
            f"signals of the record{_signals_read(ask)}.",
            "uses the record",
        )
    longer = np.concatenate([run.u, rest[: rest.size // 4]])
    if np.max(np.abs(_played(ask, longer)[: run.u.size] - y_sim)) > 0.01 * np.ptp(y_sim):
        return Verdict(
            False,
            f"`simulate_better` returns other values for the same {run.u.size} samples when the input is longer than "
            "the record: an output cannot depend on what comes later.",
            "one length only",
        )
    return Verdict(True, _CLOSED)


def _signals_read(ask: Ask) -> str:
    """Which signals of the record the function reads; examples where its code is not known or names none."""
    code = code_of(ask, "simulate_better")
    read = [f"`{name}`" for name in ("y", "y_act", "y_lin", "e") if code is not None and code.reads(name)]
    return f": it reads {' and '.join(read)}" if read else ", such as `y` or `e`"


def _slip_of_one_run(ask: Ask, run: _Run, y_sim: FloatArray) -> tuple[str, str] | None:
    """What is wrong, and the name of the slip."""
    y_offset = as_number("y_offset", ask.known("y_offset"))
    if run.closed(y_sim + y_offset) >= ENOUGH:
        return "`simulate_better` returns deviations from rest: put `y_offset` back on.", "output offset left out"
    if _is_near(y_sim, run.linear, run):
        return (
            "`simulate_better` does what the linear model does: there is no effect in it, or its fit has put it out of "
            "the range that is used.",
            _NO_EFFECT,
        )
    if _is_near(y_sim + y_offset, run.linear, run):
        return (
            "`simulate_better` returns deviations from rest, of the linear model: put `y_offset` back "
            "on, and the effect in.",
            "output offset left out",
        )
    for moved, text in ((y_sim[1:], "late"), (y_sim[:-1], "early")):
        there = slice(None, -1) if text == "late" else slice(1, None)
        shifted = _Run(run.u[there], run.y[there], run.linear[there], run.first, run.noise)
        if shifted.closed(moved) >= ENOUGH:
            return f"`simulate_better` is one sample {text}.", "lag off by one"
    return None


def _slip_of_more_runs(ask: Ask, run: _Run, y_sim: FloatArray) -> tuple[str, str] | None:
    """What is wrong where the outputs to other inputs tell, and the name of the slip."""
    y_offset = as_number("y_offset", ask.known("y_offset"))
    linear_run = _played(ask, run.u - ask.record.u[0])
    if run.closed(linear_run) >= ENOUGH or _is_near(linear_run, run.linear, run):
        return (
            "`simulate_better` expects an input without its offset. It is handed the pump voltage: take `u_offset` off "
            "inside.",
            "input offset not taken off",
        )
    if np.allclose(y_sim, linear_run) and not np.allclose(y_sim, _played(ask, 2 * run.u)):
        return (
            "`simulate_better` takes off the mean of what it is handed, or another of its values, in place of "
            "`u_offset`: an output then depends on the whole input.",
            "mean for the offset",
        )
    if np.allclose(y_sim, linear_run):
        return (
            "`simulate_better` returns the same whatever it is handed: let it use its argument.",
            "argument not used",
        )
    if np.allclose(y_sim, _played(ask, run.u[::-1])):
        return (
            "`simulate_better` returns the same for these voltages in any order, and another output for their "
            "deviations from rest: take `u_offset` off inside, before anything else is done to the input.",
            "input offset not taken off",
        )
    if abs(y_sim[0] - y_offset) > 0.1 * np.ptp(run.y):
        return (
            f"`simulate_better` begins with {y_sim[0]:.3g} V, and at rest the sensor shows {y_offset:.3g} V. A model "
            "of deviations is handed `u_act - u_offset`, and `y_offset` is added to what it returns.",
            "output offset left out",
        )
    return None


def _is_near(y_sim: FloatArray, other: FloatArray, run: _Run) -> bool:
    """Whether two outputs differ by much less than the linear model does from the run."""
    return bool(np.sqrt(np.mean((y_sim - other) ** 2)) < 0.1 * np.sqrt(np.mean((run.linear - run.y) ** 2)))


_WITHIN_NOISE = (
    " (What is left is no larger than the noise. Then `closed` is 1 whatever was handed over for the error before: it "
    "is the mean square, `gap_before**2`.)"
)


def check_closed(ask: Ask) -> Verdict:
    """Step 9: the function, and the share closed on the held-out half, which must also hold on the judge's run."""
    for sigma, error_before, after in (
        (0.01, 0.05, 0.02),
        (0.02, 0.09, 0.06),
        (0.01, 0.05, 0.009),
        (0.015, 0.04, 0.06),
    ):
        scale = float(ask.rng.uniform(0.8, 1.2))
        verdict = _judge_formula(ask, (scale * after) ** 2, (scale * error_before) ** 2, scale * sigma)
        if not verdict.passed:
            return verdict
    got = as_number("closed", ask.value("closed"))
    noise, error_before, offset = (as_number(name, ask.known(name)) for name in ("noise_sd", "gap_before", "y_offset"))
    record = ask.record
    half = record.y.size // 2
    errors = _played(ask, record.u) - record.y
    squares = errors**2
    after = float(np.mean(squares[half:]))
    right = closed_share(after, error_before**2, noise)
    verdict = judge(
        got,
        right,
        close(0.01, 0.005),
        f"{100 * right:.0f} % of the gap on your held-out half is closed.{'' if after > noise**2 else _WITHIN_NOISE}",
        "`closed` is not the share of the gap that `simulate_better` closes on the held-out half: go through the "
        "formula term by term.",
        [
            Slip("per cent", "`closed` is in per cent; give a number between 0 and 1.", lambda: 100 * right),
            Slip(
                "what is left, not what is closed",
                "`closed` is the share that is *left*: take it from 1.",
                lambda: 1 - right,
            ),
            Slip(
                "noise left in",
                "`closed` leaves the noise in both errors: subtract its square from both mean squared errors.",
                lambda: closed_share(after, error_before**2, 0.0),
            ),
            Slip(
                "no root",
                "`closed` compares mean squares: take the root of both.",
                lambda: 1 - (1 - right) ** 2,
            ),
            Slip(
                "no root",
                "`closed` compares mean squares, with the noise in them: take the noise off and the root of both.",
                lambda: 1 - after / error_before**2,
            ),
            Slip(
                "roots for mean squares",
                "`closed` is made of `gap_before` itself, a root: the formula takes its square, the *mean "
                "square* before.",
                lambda: closed_share(after, error_before, noise),
            ),
            Slip(
                "roots for mean squares",
                "`closed` is made of the roots of both mean squares: the formula takes the mean squares themselves.",
                lambda: closed_share(float(np.sqrt(after)), error_before, noise),
            ),
            Slip(
                "roots for mean squares",
                "`closed` is made of the root of the mean square after: the formula takes the mean square itself.",
                lambda: closed_share(float(np.sqrt(after)), error_before**2, noise),
            ),
            *(
                Slip(
                    "square of the mean error",
                    f"`closed` is made of the square of {what}: square the errors first, then take the mean.",
                    partial(closed_share, float(candidate) ** 2, error_before**2, noise),
                )
                for what, candidate in (
                    ("the mean error", np.mean(errors[half:])),
                    ("the mean absolute error", np.mean(np.abs(errors[half:]))),
                )
            ),
            Slip(
                "deviations beside volts",
                "`closed` takes the simulation, in volts, beside `y`, a deviation from rest: the output in volts is "
                "`y_act`.",
                lambda: closed_share(float(np.mean((errors + offset)[half:] ** 2)), error_before**2, noise),
            ),
            Slip(
                "error over the whole record",
                "`closed` takes the error after over the whole record. Only the held-out half counts.",
                lambda: closed_share(float(np.mean(squares)), error_before**2, noise),
            ),
            Slip(
                "error on the fitted half",
                "`closed` takes the error after over the half that was fitted.",
                lambda: closed_share(float(np.mean(squares[:half])), error_before**2, noise),
            ),
        ],
        exactly=close(1e-7, 1e-9),
    )
    if verdict.passed and after <= noise**2:
        handed = _handed_before(ask)
        if handed is not None and abs(handed - error_before**2) > 0.01 * error_before**2:
            return Verdict(
                False,
                "`closed` is 1, as what is left is no larger than the noise. But what is handed over as the error "
                f"before is {handed:.3g}, and the mean square is `gap_before**2`, {error_before**2:.3g}.",
                "another error before",
            )
    if not verdict.passed or ask.origin is None:
        return verdict
    run = _run(ask)
    open_share, fresh = 1 - got, 1 - run.closed(_played(ask, run.u))
    if abs(open_share - fresh) > 0.15 + 0.35 * max(open_share, fresh):
        return Verdict(
            False,
            "On the run that the judge holds back your simulation closes another share than the one you report. What "
            "counts is what holds on fresh data.",
            "does not hold on fresh data",
        )
    return verdict


def _handed_before(ask: Ask) -> float | None:
    """What the notebook hands over to `share_closed` as the error before; None where that is not known."""
    handed = getattr(ask, "numbers_handed", None)  # only the notebook's variables tell
    numbers: tuple[float | None, ...] = handed("share_closed", "closed") if callable(handed) else ()
    return numbers[1] if len(numbers) == 3 else None


def _edits_of_share(sigma: float) -> tuple[Edit, ...]:
    """Single mistakes in the share that is closed."""
    return (
        Edit("scale", 100.0, "it is in per cent, and asked for is a number"),
        Edit("power", 1.0, "mean squares are compared, without their roots"),
        Edit("noise", (0.0, 0.0), "the noise is left in both errors"),
        Edit("noise", (sigma, sigma), "sigma is subtracted without its square"),
        Edit("noise", (sigma**2, 0.0), "the noise is taken from the error after alone"),
        Edit("noise", (0.0, sigma**2), "the noise is taken from the error before alone"),
        Edit("left", True, "it is the share that is left: take it from 1"),
        Edit("swapped", True, "the errors before and after are swapped"),
    )


def _judge_formula(ask: Ask, after: float, error_before: float, sigma: float) -> Verdict:
    right = closed_share(after, error_before, sigma)

    def made(
        scale: float = 1.0,
        power: float = 0.5,
        noise: tuple[float, float] = (sigma**2, sigma**2),
        left: bool = False,
        swapped: bool = False,
    ) -> float:
        one, other = (error_before, after) if swapped else (after, error_before)
        share = np.float64(max(one - noise[0], 0.0) / (other - noise[1])) ** power  # nan, and no complex root
        return float(scale * (share if left else 1 - share))

    value = ask.call("share_closed", after, error_before, sigma)
    if value is None:
        raise nothing_returned(ask, "share_closed", "the share")
    if isinstance(value, float) and np.isnan(value):
        if after > sigma**2:
            raise NoAnswer(
                "`share_closed` returns nan, the root of a negative number. Both mean squared errors are larger here "
                "than "
                "the variance of the noise, sigma^2."
                + (
                    " Less sigma itself one is negative: sigma is not squared."
                    if min(after, error_before) < sigma
                    else ""
                ),
                "sigma not squared" if min(after, error_before) < sigma else None,
            )
        raise NoAnswer(
            "`share_closed` returns nan: where the error after is below the noise, the root needs `max(..., 0)`. "
            "(Of `np.max` the second argument is an axis.)",
            "max forgotten",
        )
    got = as_number("share_closed(mse_after, mse_before, sigma)", value)
    if got == 0.0 and right < 0 and _is_zero_for(ask, 4 * after + sigma, error_before, sigma):
        return Verdict(
            False,
            "`share_closed` returns 0 where the error after is the larger one. The share is negative there, as the "
            "simulation got worse: `max(..., 0)` belongs to the difference below the root alone.",
            "share kept at zero",
        )
    return judge(
        got,
        right,
        close(1e-6, 1e-9),
        "",
        "`share_closed` is not the formula above. Try it by hand: `share_closed(0.5, 1, 0)` is 1 less the root of 1/2.",
        [
            Slip("per cent", "`share_closed` is in per cent; return a number.", lambda: 100 * right),
            Slip(
                "what is left, not what is closed",
                "`share_closed` is the share that is *left*: take it from 1.",
                lambda: 1 - right,
            ),
            Slip(
                "noise left in",
                "`share_closed` leaves the noise in both errors: subtract its square from both mean squared errors.",
                lambda: closed_share(after, error_before, 0.0),
            ),
            Slip(
                "no root", "`share_closed` compares mean squares: take the root of both.", lambda: 1 - (1 - right) ** 2
            ),
            Slip(
                "no root",
                "`share_closed` compares mean squares, with the noise in them: take the noise off and the root of "
                "both.",
                lambda: 1 - after / error_before,
            ),
            Slip(
                "sigma not squared",
                "`share_closed` subtracts sigma; subtract its square.",
                lambda: 1 - float(np.sqrt(max(after - sigma, 0) / abs(error_before - sigma))),
            ),
            Slip(
                "before and after swapped",
                "`share_closed` has the errors before and after swapped.",
                lambda: closed_share(error_before, after, sigma),
            ),
            Slip(
                "noise taken from one error only",
                "`share_closed` subtracts the noise from one of the errors only.",
                lambda: 1 - float(np.sqrt(max(after - sigma**2, 0) / error_before)),
            ),
            Slip(
                "root taken before the noise",
                "`share_closed` subtracts sigma from the roots; subtract its square from the mean squares.",
                lambda: 1 - float(max(np.sqrt(after) - sigma, 0) / (np.sqrt(error_before) - sigma)),
            ),
            *pairs_of("`share_closed`", _edits_of_share(sigma), made),
        ],
    )


def _is_zero_for(ask: Ask, after: float, error_before: float, sigma: float) -> bool:
    """Whether the student's share is zero for other errors, too; also where it cannot be asked again."""
    try:
        return ask.call("share_closed", after, error_before, sigma) == 0.0
    except NoAnswer as stopped:
        return stopped.slip == BEYOND_RESULTS


def _run(ask: Ask) -> _Run:
    """The judge's own run where it can make the rig again, else the record."""
    record = ask.record
    u, y, first, noise = record.u, record.y, record.y.size // 2, as_number("noise_sd", ask.known("noise_sd"))
    if ask.origin is not None:
        from labsid.rig.switchable.withheld import withheld_rig, withheld_validation_data

        u, y = withheld_validation_data(withheld_rig(ask.origin.student, ask.origin.secret))
        first, noise = 0, 0.0
    model = arx_from_theta(known_vector(ask, "theta_hat"), record.Ts)
    linear = as_number("y_offset", ask.known("y_offset")) + simulate(model, u - record.u[0])
    return _Run(u, y, linear, first, noise)


def _other_length(ask: Ask, y_sim: FloatArray, wanted: int) -> str:
    """Why the output has another length than the input."""
    if y_sim.size == ask.record.y.size:
        if np.ptp(y_sim - ask.record.y) < 1e-9:
            return "They are your record itself: its argument is ignored. It is handed other inputs, of any length."
        return (
            "That is as many as your record has: what is simulated is `u_act`, the argument, of any length, and no "
            "signal of the notebook."
        )
    if y_sim.size in (wanted // 2, wanted - wanted // 2):
        return "That is half of them: simulate the whole input."
    return "There is one output for each sample of the input: compute all lengths from `len(u_act)`."


def _played(ask: Ask, u: FloatArray) -> FloatArray:
    """What the student's simulation makes of an input."""
    value = returned(ask, "simulate_better", u)
    if isinstance(value, np.ndarray) and value.ndim == 2 and value.shape[1] == 1:
        raise NoAnswer(
            f"`simulate_better` returns a column, shape {value.shape}. The record is one-dimensional, and numpy makes "
            "a whole table of their difference: return shape (N,).",
            "a column beside a flat array",
        )
    y_sim = as_vector("simulate_better(u_act)", value)
    if y_sim.size != u.size:
        raise NoAnswer(
            f"`simulate_better` was handed {u.size} samples and returned {y_sim.size}. "
            f"{_other_length(ask, y_sim, u.size)}",
            "another length",
        )
    return y_sim
