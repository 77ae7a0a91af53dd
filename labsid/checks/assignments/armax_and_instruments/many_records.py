"""Checks of the lecture's start: Tables 2 and 3 by many records, and bias with its standard error."""

from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.compare import SAME, as_array, as_matrix, as_theta, as_vector
from labsid.checks.question import Ask, returned, returned_parts
from labsid.checks.regressions import slips_of_fit
from labsid.checks.trials import ARX, STARTS, trial_record
from labsid.checks.values import Value
from labsid.checks.verdict import Slip, Verdict, first_failure, judge
from labsid.estimation.monte_carlo import MonteCarlo, run_monte_carlo
from labsid.least_squares.solve import solve_least_squares
from labsid.model_structures.lecture_systems import LectureRecord, system_1, system_2
from labsid.model_structures.structures import build_equations, fit_structure

TRUTH = np.array([-0.8, 1.0])
FEWEST = 100
_FEW_RECORDS = 40  # for means that are told apart from others, and not judged
WRONG_SIGN_OF_C = np.array([-0.868, 1.0])
"""Where least squares goes on System 2 with c = +0.8."""


@first_failure
def check_tables(ask: Ask) -> Iterator[Verdict]:
    """`fit_arx(u, y)`, then the estimates over many records of both systems."""
    for samples in (30, int(ask.rng.integers(40, 80))):
        yield _judge_fit(ask, *trial_record(ask.rng, samples, ask.rng.uniform(-0.6, 0.6)))
    first, second = (_reference(system) for system in (system_1, system_2))
    for name, reference, other in (("estimates_1", first, second), ("estimates_2", second, first)):
        yield _judge_estimates(name, as_matrix(name, ask.value(name), (None, 2)), reference, other)
    yield Verdict(True, "both clouds are where they should be, and as wide.")


def right_tables(_: Ask) -> dict[str, Value]:
    """Step 1."""
    return {"estimates_1": _reference(system_1).estimates, "estimates_2": _reference(system_2).estimates}


@cache
def _reference(system: Callable[[np.random.Generator], LectureRecord]) -> MonteCarlo:
    def estimate(rng: np.random.Generator) -> FloatArray:
        r = system(rng)
        return fit_structure(ARX, r.u, r.y).model.theta

    return run_monte_carlo(estimate, TRUTH, 200, seed=62)


def _judge_fit(ask: Ask, u: FloatArray, y: FloatArray) -> Verdict:
    got = as_theta("fit_arx(u, y)", returned(ask, "fit_arx", u, y), 2)

    def fit(start: int) -> FloatArray:
        return fit_structure(ARX, u, y, start=start).model.theta

    rights = [fit(start) for start in STARTS]
    right = next((right for right in rights if SAME(got, right)), rights[0])
    k = np.arange(1, u.size)
    same_time = solve_least_squares(np.column_stack([-y[k - 1], u[k]]), y[k]).theta
    lag = "`fit_arx` takes u(t) where the equation has u(t-1)."
    sign = (
        "`fit_arx` has the other sign of a. The regressor holds -y(t-1), so that a itself is in theta (-0.8, not 0.8)."
    )
    return judge(
        got,
        right,
        SAME,
        "",
        "`fit_arx` does not return the least-squares [a, b]: write the first two equations down by hand.",
        [
            *(Slip("sign of a", sign, partial(np.multiply, theta, [-1, 1])) for theta in rights),
            *(Slip("a and b swapped", "`fit_arx` returns b before a.", theta[::-1].copy) for theta in rights),
            Slip("lag off by one", lag, lambda: same_time),
            Slip("lag off by one", lag, lambda: same_time * [-1, 1]),
            Slip(
                "inverse forgotten",
                "`fit_arx` returns Phi'y: the inverse of Phi'Phi is missing.",
                lambda: build_equations(ARX, u, y).Phi.T @ y[1:],
            ),
            *slips_of_fit("`fit_arx`", [(-y, 1), (u, 1)], y, u),
        ],
    )


@np.errstate(over="ignore", invalid="ignore")
def _judge_estimates(name: str, got: FloatArray, reference: MonteCarlo, other_method: MonteCarlo) -> Verdict:
    runs = len(got)
    if runs < FEWEST:
        return Verdict(
            False, f"`{name}` has {runs} rows: it takes at least {FEWEST} records, one row each.", "too few records"
        )
    if len(np.unique(got[:, 0])) < 0.9 * runs:
        return Verdict(
            False,
            f"`{name}` holds the same estimate over and over, {len(np.unique(got[:, 0]))} different of {runs}. Every "
            "record needs its own noise: make the generator once, before the loop. And every row needs its own fit: "
            "print two of them.",
            "same noise in every record",
        )
    system, c = name[-1], {"1": "0", "2": "-0.8"}[name[-1]]
    mean, slack = got.mean(axis=0), _slack(reference, runs)
    if np.all(np.abs(mean - reference.mean) < slack):
        ratio = np.std(got, axis=0, ddof=1) / reference.spread
        if np.all((ratio > 0.7) & (ratio < 1.4)):
            return Verdict(True, "")
        return Verdict(
            False,
            f"`{name}` has the right mean but not the right spread for records of 1000 samples with unit noise: "
            "a shorter record scatters more, a longer one less.",
            "records of another length",
        )
    hints = (
        (
            "systems swapped",
            other_method.mean,
            f"`{name}` is not of System {system}: c is {c} there.",
        ),
        ("sign of a", reference.mean * [-1, 1], f"`{name}` has the other sign of a."),
        ("a and b swapped", reference.mean[::-1], f"`{name}` has b before a."),
        ("sign of c", WRONG_SIGN_OF_C, f"`{name}` is of a system with the other sign of c."),
    )
    for slip, wrong, hint in hints:
        if np.all(np.abs(mean - wrong) < slack):
            return Verdict(False, hint, slip)
    for what, wrong in _of_other_signals(system_1 if system == "1" else system_2):
        if np.all(np.abs(mean - wrong) < slack):
            return Verdict(
                False,
                f"`{name}` is about {(np.round(mean, 2) + 0.0).tolist()} on average, as where {what}: `make_record` "
                "returns u, y, e, in this order.",
                "order of u, y and e",
            )
    return Verdict(
        False,
        f"`{name}` does not gather where least squares goes on System {system}: its rows are [{mean[0]:.3g}, "
        f"{mean[1]:.3g}] on average. Each is `fit_arx(u, y)` of a new record of that system.",
    )


@cache
def _of_other_signals(system: Callable[[np.random.Generator], LectureRecord]) -> tuple[tuple[str, FloatArray], ...]:
    """What else may have been handed to `fit_arx` as u and y, with the mean estimate that it gives."""
    records = [system(np.random.default_rng(seed)) for seed in range(_FEW_RECORDS)]

    def mean_of(input_name: str, output_name: str) -> FloatArray:
        signals = [(getattr(one, input_name), getattr(one, output_name)) for one in records]
        return np.mean([fit_structure(ARX, u, y).model.theta for u, y in signals], axis=0)

    return (
        ("the noise e stands in the place of the input u", mean_of("e", "y")),
        ("the noise e, or the input u, stands in the place of the output y", mean_of("u", "e")),
    )


def _slack(reference: MonteCarlo, runs: int) -> FloatArray:
    # The constant is for one input kept for all records: its own sample variance shifts the mean a little.
    return 0.01 + 5 * np.sqrt(reference.spread**2 / runs + reference.bias_stderr**2)


@first_failure
def check_bias(ask: Ask) -> Iterator[Verdict]:
    """`bias_of(estimates, truth)`."""
    for runs, p in ((9, 3), (int(ask.rng.integers(11, 20)), 2)):
        truth = ask.rng.uniform(-2, 2, p)
        estimates = truth + ask.rng.uniform(0.3, 1, p) + ask.rng.uniform(0.2, 2, p) * ask.rng.standard_normal((runs, p))
        yield _judge_bias(ask, estimates, truth)


def _those(names: Sequence[str], sizes: Sequence[int], size: int) -> str:
    """The parts of `bias_of` that have so many numbers, and a verb."""
    found = [name for name, its in zip(names, sizes, strict=True) if its == size]
    return f"{' and '.join(found)} of `bias_of` {'have' if len(found) > 1 else 'has'}"


def _others(names: Sequence[str], sizes: Sequence[int], p: int) -> str:
    """The parts of `bias_of` that have one number for each parameter."""
    found = [name for name, its in zip(names, sizes, strict=True) if its == p]
    return f" One for each parameter is in {' and '.join(found)}, whose values are compared later." if found else ""


@first_failure
def _judge_bias(ask: Ask, estimates: FloatArray, truth: FloatArray) -> Iterator[Verdict]:
    runs, p = estimates.shape
    parts = returned_parts(ask, "bias_of", "three vectors: bias, spread and standard error", 3, estimates, truth)
    names = ("the bias", "the spread", "the standard error")
    sizes = [as_array(f"{name} of bias_of", part).size for name, part in zip(names, parts, strict=True)]
    if runs in sizes:
        yield Verdict(
            False,
            f"{_those(names, sizes, runs)} one number for each of the {runs} records, where one for each of the {p} "
            f"parameters is asked for: taken along the rows.{_others(names, sizes, p)}",
            "mean over the wrong axis",
            mend="Means and spreads go over the records, `axis=0`.",
        )
    if 1 in sizes:
        yield Verdict(
            False,
            f"{_those(names, sizes, 1)} one number for all {p} parameters together.{_others(names, sizes, p)}",
            "mean over everything",
            mend="Give `np.mean` and `np.std` the `axis=0`.",
        )
    got = [as_vector(f"{name} of bias_of", part, p) for name, part in zip(names, parts, strict=True)]
    off = estimates.mean(axis=0) - truth
    yield judge(
        got[0],
        off,
        SAME,
        "",
        "the first part of `bias_of` is not the mean less the truth.",
        [
            Slip("sign of the bias", "`bias_of` has the other sign: bias is mean less truth.", lambda: -off),
            Slip(
                "truth not subtracted",
                "the first part of `bias_of` is the mean: take the truth off.",
                lambda: estimates.mean(axis=0),
            ),
            Slip(
                "absolute errors",
                "`bias_of` averages absolute errors: errors of both signs must cancel, or scatter looks like bias.",
                lambda: np.abs(estimates - truth).mean(axis=0),
            ),
            Slip(
                "one mean for all parameters",
                "`bias_of` takes the mean of the truth off: each parameter has a true value of its own.",
                lambda: estimates.mean(axis=0) - np.mean(truth),
            ),
            Slip(
                "one mean for all parameters",
                "`bias_of` takes one mean of all estimates: each parameter has its own, along `axis=0`.",
                lambda: np.mean(estimates) - truth,
            ),
            Slip("spread before bias", "`bias_of` returns the spread first.", lambda: estimates.std(axis=0, ddof=1)),
        ],
    )
    spread = estimates.std(axis=0, ddof=1)
    stderr = spread / np.sqrt(runs)
    ddof = (
        "divided by M",
        "the spread of `bias_of` divides the sum of squares by M. The mean is taken from the same estimates, so divide "
        "by M - 1, as in the example by hand: `np.std` does with `ddof=1`.",
    )
    yield judge(
        got[1],
        spread,
        SAME,
        "",
        "the second part of `bias_of` is not the standard deviation of the estimates.",
        [
            Slip(*ddof, lambda: estimates.std(axis=0)),
            *(
                Slip(
                    "variance for spread",
                    "the second part of `bias_of` is the variance: the spread is its root.",
                    partial(np.var, estimates, axis=0, ddof=ddof),
                )
                for ddof in (1, 0)
            ),
            *(
                Slip(
                    "spread about the truth",
                    "the spread of `bias_of` is taken about the truth, so that the bias is in it: take it about the "
                    "mean.",
                    partial(np.sqrt, np.sum((estimates - truth) ** 2, axis=0) / divisor),
                )
                for divisor in (runs, runs - 1)
            ),
            Slip(
                "standard error before spread",
                "`bias_of` returns the standard error before the spread.",
                stderr.copy,
            ),
        ],
    )
    yield judge(
        got[2],
        stderr,
        SAME,
        "a bias is worth as much as its standard error says.",
        "the third part of `bias_of` is not the standard error of a mean over so many records.",
        [
            Slip(
                "spread for standard error",
                "the third part of `bias_of` is the spread again.",
                spread.copy,
                mend="A mean of M is better by the root of M.",
            ),
            Slip(
                "divided by M",
                "the standard error of `bias_of` is divided by M.",
                partial(np.divide, spread, runs),
                mend="Variances add up, so it is the root of M.",
            ),
            Slip(
                "number of parameters for M",
                "the standard error of `bias_of` uses the number of parameters: M is the number of records, rows.",
                partial(np.divide, spread, np.sqrt(p)),
            ),
            Slip(
                "all entries counted",
                "the standard error of `bias_of` counts all entries of `estimates`: M is the number of records, rows.",
                partial(np.divide, spread, np.sqrt(estimates.size)),
            ),
            Slip(
                "M - 1 twice",
                "the standard error of `bias_of` is divided by the root of M - 1: the spread holds the M - 1 already.",
                partial(np.divide, spread, np.sqrt(runs - 1)),
            ),
        ],
    )
