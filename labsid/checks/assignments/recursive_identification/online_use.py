"""Checks of online use, and of choosing lambda for a parameter that drifts."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.assignments.recursive_identification.reference_runs import Update, reference_step, slips_of_update
from labsid.checks.compare import SAME, as_matrix, as_number, as_vector
from labsid.checks.double_mistakes import Edit, pairs_of
from labsid.checks.question import Ask, returned, returned_parts
from labsid.checks.trials import trial_definite
from labsid.checks.verdict import Slip, Verdict, first_failure, judge

_WITHIN = 0.0015
"""Of lambda: steps of 0.001 come within half of one, and steps of 0.01 not where the best lambda lies between two."""


@first_failure
def check_online(ask: Ask) -> Iterator[Verdict]:
    """`arx_step(theta, P, past, u, y, lam)`: what a controller runs once a sample."""
    for lam in (1.0, 0.9, 0.8):
        drawn = lam if lam == 1 else float(np.round(lam + ask.rng.uniform(-0.05, 0.05), 3))
        yield _one_sample(ask, trial_definite(ask.rng, 3), drawn)


@first_failure
def _one_sample(ask: Ask, P: FloatArray, lam: float) -> Iterator[Verdict]:
    theta, past = ask.rng.uniform(-2, 2, 3), ask.rng.uniform(0.5, 2, 3)
    u, y = ask.rng.uniform(3, 4), ask.rng.uniform(5, 7)
    parts = returned_parts(ask, "arx_step", "theta, P and past", 3, theta, P, past, u, y, lam)
    sizes = [part.size if isinstance(part, np.ndarray) else 1 for part in parts]
    if sorted(sizes) == [3, 3, 9] and sizes[1] != 9:
        yield Verdict(False, "`arx_step` returns theta, P and past in another order.", "order of what is returned")
    got_theta = as_vector("theta of arx_step", parts[0], 3)
    got_P = as_matrix("P of arx_step", parts[1], (3, 3))
    got_past = as_vector("past of arx_step", parts[2], 3)

    after = np.array([-y, past[0], u])
    yield judge(
        got_past,
        after,
        SAME,
        "",
        "past of `arx_step` is not the regressor of the next sample, [-y(t), -y(t-1), u(t)].",
        [
            Slip(
                "past not updated",
                "`arx_step` hands past back as it was: the next sample needs a newer one.",
                lambda: past,
            ),
            Slip(
                "sign of the remembered output",
                "`arx_step` remembers +y: the regressor holds -y.",
                lambda: np.array([y, past[0], u]),
            ),
            Slip(
                "oldest output kept",
                "`arx_step` keeps the oldest output: -y(t-1) moves to the second place, -y(t-2) is dropped.",
                lambda: np.array([-y, past[1], u]),
            ),
            Slip(
                "new output overwritten",
                "`arx_step` puts the new output in both places: past[0] is overwritten before it has moved to past[1].",
                lambda: np.array([-y, -y, u]),
            ),
            Slip(
                "sign of the remembered output",
                "`arx_step` turns the sign of past[0], which holds -y(t-1) already.",
                lambda: np.array([-y, -past[0], u]),
            ),
            Slip("u not remembered", "`arx_step` forgets to remember u.", lambda: np.array([-y, past[0], past[2]])),
        ],
    )
    right_theta, right_P = reference_step(theta, P, past, y, lam)

    compared = (("theta", got_theta, right_theta), ("P", got_P, right_P))
    wrong = " and ".join(name for name, got, right in compared if not SAME(got, right))

    def both(theta: FloatArray, P: FloatArray) -> FloatArray:
        return np.vstack([theta, P])

    last = np.array([past[0], past[1], u])
    yield judge(
        both(got_theta, got_P),
        both(right_theta, right_P),
        lambda a, b: SAME(a[0], b[0]) and SAME(a[1:], b[1:]),
        "theta, P and three numbers: all that an online estimator carries from sample to sample.",
        f"past of `arx_step` is right, {wrong} {'are' if ' ' in wrong else 'is'} not: with lambda = {lam:g} one RLS "
        "step with phi = past gives another value.",
        [
            Slip(
                "past updated too early",
                "`arx_step` updates past before it uses it: y(t) would then predict itself.",
                lambda: both(*reference_step(theta, P, after, y, lam)),
            ),
            Slip(
                "the present input used",
                "`arx_step` puts u(t) into the regressor of y(t). u(t) acts on y(t+1): remember it, use it later.",
                lambda: both(*reference_step(theta, P, last, y, lam)),
            ),
            Slip(
                "lambda not used",
                "`arx_step` runs with lambda = 1, whatever lam is.",
                lambda: both(*reference_step(theta, P, past, y, 1.0)),
            ),
            Slip(
                "P not updated",
                "`arx_step` hands P back as it was.",
                lambda: both(right_theta, P),
            ),
            Slip(
                "not divided by lambda",
                "P of `arx_step` is not divided by lambda.",
                lambda: both(theta + lam * (right_theta - theta), lam * right_P),
            ),
            Slip(
                "gain from the old P",
                "`arx_step` takes the gain from the P before the sample.",
                lambda: both(theta + P @ past * (y - past @ theta), right_P),
            ),
            Slip(
                "1 in the denominator",
                "the denominator of `arx_step` is 1 + phi'P phi; with forgetting the 1 becomes lambda.",
                lambda: both(*_with_one_below(theta, P, past, y, lam)),
            ),
            *slips_of_update("`arx_step`", lambda update: both(*_updated(update, theta, P, past, y, lam))),
            Slip(
                "entry by entry",
                "the error of `arx_step` is a vector: `*` multiplies past and theta entry by entry; phi'theta is one "
                "number, `past @ theta`.",
                lambda: both(theta + right_P @ past * (y - past * theta), right_P),
            ),
        ],
        of=None,  # theta and P are one table here, of rows that the student has not made
    )


def _with_one_below(
    theta: FloatArray, P: FloatArray, past: FloatArray, y: float, lam: float
) -> tuple[FloatArray, FloatArray]:
    """One sample with 1 in place of lambda in the denominator."""
    after = (P - np.outer(P @ past, P @ past) / (1 + past @ P @ past)) / lam
    return theta + after @ past * (y - past @ theta), after


def _updated(
    update: Update, theta: FloatArray, P: FloatArray, past: FloatArray, y: float, lam: float
) -> tuple[FloatArray, FloatArray]:
    """One sample with a wrong update of P."""
    after = update(P, past, lam)[1]
    return theta + after @ past * (y - past @ theta), after


def tracking_mse(lam: float, slope: float, sigma: float) -> float:
    """Lag squared plus variance of an exponentially forgetting mean on ``slope * n`` plus white noise."""
    return float((slope * lam / (1 - lam)) ** 2 + sigma**2 * (1 - lam) / (1 + lam))


@first_failure
def check_drift(ask: Ask) -> Iterator[Verdict]:
    """`tracking_mse(lam, slope, sigma)` and `best_forgetting(slope, sigma)`."""
    for _ in range(2):
        yield _one_error(ask)
    for hundredths in (ask.rng.integers(94, 98), ask.rng.integers(80, 92), ask.rng.integers(55, 75)):
        best = hundredths / 100 + float(ask.rng.uniform(0.003, 0.007))
        sigma = float(ask.rng.uniform(1.5, 3))
        # where the derivative of the mean squared error is zero
        yield _one_choice(ask, best, sigma * float(np.sqrt((1 - best) ** 3 / best) / (1 + best)), sigma)
    yield Verdict(True, "fast enough to follow, slow enough to average: the best lambda lies between.")


def _edits_of_error(lam: float, slope: float, sigma: float) -> tuple[Edit, ...]:
    """Single mistakes in the lag, its power, the standard deviation and the sum of the squared weights."""
    return (
        Edit("power", 1, "the lag is not squared"),
        Edit("lag", slope / (1 - lam), "the lag is that of theta(n-1), before the new sample is used"),
        Edit("lag", slope * (1 - lam) / lam, "the lag is upside down: it grows with lambda"),
        Edit("lag", slope * lam - lam, "the lag lacks brackets: `slope * lam / 1 - lam` divides by 1 alone"),
        Edit("lag", 0.0, "the lag is left out"),
        Edit("lag", slope, "the lag is one slope, whatever lambda is"),
        Edit("variance", sigma, "sigma is not squared"),
        Edit("variance", 0.0, "the noise is left out"),
        Edit("weights", (1 - lam) ** 2, "the noise is that of one step: sum over all ages"),
        Edit("weights", 1 - lam, "the sum of the weights stands for the sum of their squares"),
        Edit("weights", (1 + lam) / (1 - lam), "(1 - lambda)/(1 + lambda) is upside down"),
        Edit("root", 0.5, "a root is taken, and asked for is the mean square"),
    )


def _one_error(ask: Ask) -> Verdict:
    lam, slope, sigma = ask.rng.uniform(0.6, 0.95), ask.rng.uniform(0.1, 0.4), ask.rng.uniform(1.2, 2)
    lag, variance = slope * lam / (1 - lam), sigma**2 * (1 - lam) / (1 + lam)

    def made(
        lag: float = lag,
        power: int = 2,
        variance: float = sigma**2,
        weights: float = (1 - lam) / (1 + lam),
        root: float = 1.0,
    ) -> float:
        return float((lag**power + variance * weights) ** root)

    wrong_variances = (
        ("sigma not squared", "sigma of `tracking_mse` is not squared.", variance / sigma),
        (
            "variance of one step",
            "`tracking_mse` has the noise of one step only: sum over all ages.",
            sigma**2 * (1 - lam) ** 2,
        ),
        (
            "sum of weights for sum of squares",
            "`tracking_mse` sums the weights; the variance takes the sum of their squares.",
            sigma**2 * (1 - lam),
        ),
        ("noise forgotten", "`tracking_mse` leaves the noise out.", 0.0),
    )
    return judge(
        as_number("tracking_mse(lam, slope, sigma)", returned(ask, "tracking_mse", lam, slope, sigma)),
        tracking_mse(lam, slope, sigma),
        SAME,
        "",
        "`tracking_mse` is not the squared lag plus the variance. Print both parts for lambda = 1/2: the lag is one "
        "slope there, and the variance sigma^2/3.",
        [
            Slip(
                "lag not squared",
                "`tracking_mse` adds the lag itself; its square belongs there.",
                lambda: lag + variance,
            ),
            Slip(
                "lag of the old estimate",
                "the lag of `tracking_mse` is that before the new sample is used: for the ramp, the recursion gives "
                "theta(n) and not theta(n-1). For lambda = 1/2 it is one slope; yours is two.",
                lambda: (slope / (1 - lam)) ** 2 + variance,
            ),
            Slip(
                "brackets forgotten",
                "`tracking_mse` lacks brackets in its lag: `slope * lam / 1 - lam` divides by 1 alone.",
                lambda: (slope * lam - lam) ** 2 + variance,
            ),
            Slip(
                "lag upside down",
                "the lag of `tracking_mse` is upside down: yours gets smaller as lambda goes to 1, and the longer the "
                "memory, the larger the lag is. (For lambda = 1/2 both are s.)",
                lambda: (slope * (1 - lam) / lam) ** 2 + variance,
            ),
            Slip("lag forgotten", "`tracking_mse` leaves the lag out.", lambda: variance),
            Slip(
                "root of the sum",
                "`tracking_mse` is a root: asked for is the mean squared error.",
                lambda: float((lag**2 + variance) ** 0.5),
            ),
            *(Slip(name, hint, partial(float, lag**2 + wrong)) for name, hint, wrong in wrong_variances),
            *pairs_of("`tracking_mse`", _edits_of_error(lam, slope, sigma), made),
        ],
    )


def _one_choice(ask: Ask, best: float, slope: float, sigma: float) -> Verdict:
    lam = as_number("best_forgetting(slope, sigma)", returned(ask, "best_forgetting", slope, sigma))
    least = tracking_mse(best, slope, sigma)
    if abs(lam - best) <= _WITHIN:
        return Verdict(True, "")
    if abs(lam - least) < 0.02 * least:
        return Verdict(
            False,
            "`best_forgetting` returns the least error: asked for is the lambda where it is.",
            "the error in place of lambda",
        )
    if lam >= 1 and lam == int(lam):
        return Verdict(
            False,
            f"`best_forgetting` returns {lam:.4g}, an index, as `np.argmin` gives it: asked for is the lambda at that "
            "index.",
            "index in place of lambda",
        )
    if not 0 < lam < 1:
        return Verdict(False, f"`best_forgetting` returns {lam:.4g}: it should be a lambda between 0.5 and 0.999.")
    if abs(1 - lam - best) < 0.01:
        return Verdict(False, "`best_forgetting` returns the gain 1 - lambda.", "gain in place of lambda")
    if abs(lam - best) <= 0.008:
        return Verdict(
            False,
            "`best_forgetting` is right to two decimals only: search in steps of 0.001.",
            "search too coarse",
        )
    at = (
        f"`best_forgetting` returns {lam:.4g}, where the mean squared error is {tracking_mse(lam, slope, sigma):.4g}; "
        "the "
        f"least is {least:.4g}."
    )
    if (lam < best and abs(lam - best) > 0.3) or lam > 0.9985:
        return Verdict(
            False,
            f"{at} That is far from the best lambda: what is sought is the *least* error for lambda between 0.5 and "
            "0.999.",
            "end of the search",
        )
    return Verdict(False, f"{at} Between 0.5 and 0.999, search in steps of 0.001.")
