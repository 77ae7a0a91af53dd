"""Checks of the lecture's first part: the recursive mean, the growing sums, and one step of RLS."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.assignments.recursive_identification.reference_runs import reference_step, slips_of_update
from labsid.checks.compare import SAME, as_array, as_matrix, as_number, as_vector
from labsid.checks.double_mistakes import Edit, pairs_of
from labsid.checks.question import Ask, returned, returned_parts
from labsid.checks.trials import trial_definite
from labsid.checks.values import Value
from labsid.checks.verdict import NoAnswer, Slip, Verdict, are_named, first_failure, judge, told_if_singular

_MORE_SAMPLES = 7  # of a second call, beside which a gain that depends on n is another one
_SAME_GAIN = 1e-9


@first_failure
def check_mean(ask: Ask) -> Iterator[Verdict]:
    """`update_mean(theta, n, y)`: Example 3-2."""
    for n in (5, 2, int(ask.rng.integers(8, 20)), 1):
        theta, y = ask.rng.uniform(1, 3), ask.rng.uniform(4, 8)
        yield _one_mean(ask, theta, n, y)


def _one_mean(ask: Ask, theta: float, n: int, y: float) -> Verdict:
    error = y - theta
    got = as_number("update_mean(theta, n, y)", returned(ask, "update_mean", theta, n, y))
    verdict = judge(
        got,
        theta + error / n,
        SAME,
        "the old mean, the new sample and its number are all it takes.",
        "`update_mean` does not return the mean of all n samples. Try it by hand: the mean of 2 and 4 is 3; "
        "then comes y = 9 with n = 3.",
        [
            Slip(
                "n counts the old samples",
                "the gain of `update_mean` is 1/(n + 1): n already counts the new sample.",
                lambda: theta + error / (n + 1),
            ),
            Slip(
                "gain 1/(n - 1)",
                "the gain of `update_mean` is 1/(n - 1), the number of the old samples; the new one counts, too.",
                lambda: theta + error / (n - 1) if n > 1 else y,
            ),
            Slip(
                "sign of the error",
                "`update_mean` moves away from the new sample.",
                lambda: theta - error / n,
                mend="The error is y - theta.",
            ),
            Slip(
                "half and half",
                "`update_mean` takes the middle of the old mean and the new sample. The old mean stands for n - 1 "
                "samples, the new one for a single one.",
                lambda: (theta + y) / 2,
            ),
            Slip(
                "y in place of the error",
                "`update_mean` adds y/n to the old mean.",
                lambda: theta + y / n,
                mend="What is added is the error y - theta, divided by n.",
            ),
            Slip(
                "n - 1 for n",
                "`update_mean` divides the new sum by n - 1: it holds n samples.",
                lambda: ((n - 1) * theta + y) / (n - 1) if n > 1 else y,
            ),
            *(
                Slip(
                    "brackets forgotten",
                    "`update_mean` takes 1 * theta off n: put n - 1 in brackets, as `*` comes first.",
                    partial(float, wrong),
                )
                for wrong in (n - theta + y / n, (n - theta + y) / n)
            ),
            Slip(
                "old mean for the old sum",
                "`update_mean` divides theta + y by n: theta is a mean already, and n - 1 samples stand behind it.",
                lambda: (theta + y) / n,
            ),
            Slip(
                "multiplied by n",
                "`update_mean` multiplies the error by n: the more samples, the less a new one counts.",
                lambda: theta + n * error,
            ),
            Slip(
                "brackets forgotten",
                "`update_mean` returns y/n: the two theta cancel, as only y is divided. Put y - theta in brackets.",
                lambda: y / n,
            ),
            Slip(
                "gain forgotten", "`update_mean` adds the whole error.", lambda: theta + error, mend="Divide it by n."
            ),
        ],
    )
    if verdict.passed or verdict.slip is not None or not are_named():
        return verdict
    later = 2 * n + _MORE_SAMPLES
    try:
        other = as_number("update_mean(theta, n, y)", ask.call("update_mean", theta / 2, later, 2 * y))
        ask.call("update_mean", theta, n, y)  # the call that is told with the message
    except NoAnswer:
        return verdict
    gains = (got - theta) / error, (other - theta / 2) / (2 * y - theta / 2)
    if abs(gains[0] - gains[1]) > _SAME_GAIN * abs(gains[0]) or not gains[0]:
        return verdict
    text = (
        f"`update_mean` moves by {gains[0]:.3g} of y - theta for n = {n} and for n = {later} alike. With a fixed "
        "gain old samples fade, as in exponential smoothing; in the mean all n samples weigh alike, and the gain falls "
        "with n."
    )
    return Verdict(False, text, "fixed gain")


@first_failure
def check_information(ask: Ask) -> Iterator[Verdict]:
    """`add_sample(M, v, phi, y)`: eq. (7) and (8)."""
    for p in (3, 2):
        M, v, phi = trial_definite(ask.rng, p), ask.rng.uniform(-3, 3, p), ask.rng.uniform(0.5, 2, p)
        yield _one_sum(ask, M, v, phi, ask.rng.uniform(2, 4))


@first_failure
def _one_sum(ask: Ask, M: FloatArray, v: FloatArray, phi: FloatArray, y: float) -> Iterator[Verdict]:
    p = phi.size
    got_M, got_v = returned_parts(ask, "add_sample", "M and v", 2, M, v, phi, y)
    if _size(got_M) == p < _size(got_v) == p * p:
        first = np.ravel(as_array("the first part of add_sample", got_M))
        theta = np.linalg.lstsq(M + np.outer(phi, phi), v + phi * y, rcond=None)[0]
        if SAME(first, theta):
            yield Verdict(
                False,
                "`add_sample` returns the estimate, M^-1 v, and then M: asked for is M, and then the sum v.",
                "estimate in place of the sum",
            )
        yield Verdict(False, "`add_sample` returns v before M.", "M and v swapped")
    yield judge(
        as_matrix("M of add_sample(M, v, phi, y)", got_M, (p, p)),
        M + np.outer(phi, phi),
        SAME,
        "",
        "M of `add_sample` is not eq. (7): one more sample adds the matrix phi phi'.",
        [
            Slip(
                "phi'phi for phi phi'",
                "`add_sample` adds the number phi'phi to every entry of M.",
                lambda: M + phi @ phi,
                mend=(
                    "Asked for is the matrix phi phi', `np.outer(phi, phi)`: for one-dimensional "
                    "arrays `phi @ phi.T` is the number."
                ),
            ),
            Slip(
                "entry by entry",
                "`add_sample` multiplies phi entry by entry (`*`): phi phi' has the product of every pair.",
                lambda: M + phi * phi,
            ),
            Slip(
                "entry by entry",
                "`add_sample` adds to the diagonal only: phi phi' has the product of every pair.",
                lambda: M + np.diag(phi**2),
            ),
            Slip("old sum forgotten", "M of `add_sample` has lost the old sum.", lambda: np.outer(phi, phi)),
            Slip("sign of the sum", "`add_sample` takes phi phi' away from M.", lambda: M - np.outer(phi, phi)),
            Slip(
                "inverse taken",
                "`add_sample` inverts M: it keeps the sum Phi'Phi itself, which is the inverse of P.",
                lambda: np.asarray(np.linalg.inv(M + np.outer(phi, phi)), float),
            ),
        ],
    )
    yield judge(
        as_vector("v of add_sample(M, v, phi, y)", got_v, p),
        v + phi * y,
        SAME,
        "two sums of fixed size hold all that least squares needs of the past.",
        "v of `add_sample` is not eq. (8): one more sample adds phi y.",
        [
            Slip("y forgotten", "v of `add_sample` grows by phi; it should grow by phi y.", lambda: v + phi),
            Slip("phi forgotten", "v of `add_sample` grows by y in every entry; it is phi y.", lambda: v + y),
            Slip("old sum forgotten", "v of `add_sample` has lost the old sum.", lambda: phi * y),
            Slip("v not updated", "v of `add_sample` comes back as it was.", lambda: v),
        ],
    )


def check_step(ask: Ask) -> Verdict:
    """`rls_step(theta, P, phi, y)`: one sample of RLS, also where P has no inverse."""
    verdict = Verdict(False, "")
    for p in (3, 2):
        verdict = _one_step(ask, 3 * trial_definite(ask.rng, p))
        if not verdict.passed:
            return verdict
    P = np.diag([ask.rng.uniform(2, 4), 0.0])
    inverts = (
        "`rls_step` inverts P. This is what the lemma saves: it divides by a number, and it works where P has no "
        "inverse, too (a parameter that is known for certain has a zero in P)."
    )
    with told_if_singular(inverts, "matrix inverted"):
        verdict = _one_step(ask, P)
    return verdict if verdict.passed else Verdict(False, inverts, "matrix inverted")


def _one_step(ask: Ask, P: FloatArray) -> Verdict:
    p = len(P)
    y = ask.rng.uniform(4, 6)
    theta, phi = ask.rng.uniform(-2, 2, p), ask.rng.uniform(0.5, 1.5, p)
    got_theta, got_P = returned_parts(ask, "rls_step", "theta and P", 2, theta, P, phi, y)
    if _size(got_P) == p < _size(got_theta) == p * p:
        return Verdict(False, "`rls_step` returns P before theta.", "theta and P swapped")
    verdict = _judge_covariance(got_P, P, phi)
    return verdict if not verdict.passed else _judge_theta(got_theta, theta, P, phi, y)


def _edits_of_covariance(P: FloatArray, phi: FloatArray) -> tuple[Edit, ...]:
    """Single mistakes in the lemma: in its numerator, its denominator and its sign."""
    P_phi = P @ phi
    q = float(phi @ P_phi)
    return (
        Edit("numerator", np.outer(phi, phi), "the numerator is phi phi', without P on both sides"),
        Edit("numerator", np.outer(phi, P_phi), "the numerator is phi phi'P, with one P"),
        Edit("numerator", np.outer(P_phi, phi), "the numerator is P phi phi', with one P"),
        Edit("numerator", P_phi @ P_phi * np.ones_like(P), "a number stands where the matrix P phi phi'P belongs"),
        Edit("numerator", P * phi * phi * P, "the numerator is made entry by entry, with `*`"),
        Edit("numerator", np.ones_like(P) * P_phi * P_phi, "the numerator is made entry by entry, with `*`"),
        Edit("numerator", np.ones_like(P) * ((P_phi * phi) @ P), "the numerator is made entry by entry, with `*`"),
        Edit("denominator", q, "the 1 of the denominator is missing"),
        Edit("denominator", 1.0, "nothing is divided by 1 + phi'P phi"),
        Edit("denominator", 1 + float(phi @ phi), "the denominator is 1 + phi'phi, without P"),
        Edit("sign", 1.0, "the correction is added, and not taken away"),
        Edit("first", 0.0, "the old P is left out"),
    )


def _judge_covariance(got: Value, P: FloatArray, phi: FloatArray) -> Verdict:
    P_phi = P @ phi
    q = float(phi @ P_phi)
    outer = np.outer(P_phi, P_phi)
    both = "P phi phi'P is a matrix, `np.outer(P @ phi, P @ phi)`."

    def made(
        numerator: FloatArray = outer, denominator: float = 1 + q, sign: float = -1.0, first: float = 1.0
    ) -> FloatArray:
        return first * P + sign * numerator / denominator

    return judge(
        as_matrix("P of rls_step(theta, P, phi, y)", got, P.shape),
        reference_step(np.zeros(phi.size), P, phi, 0.0)[1],
        SAME,
        "",
        "P of `rls_step` is not the one of the lemma. Hold yours against Example 5-2.",
        [
            Slip("P not updated", "`rls_step` hands P back as it was: a sample makes it smaller.", lambda: P),
            Slip(
                "1 forgotten",
                "the denominator of P in `rls_step` is phi'P phi: the 1 is missing.",
                lambda: P - outer / q,
            ),
            Slip(
                "denominator forgotten",
                "P of `rls_step` is not divided by 1 + phi'P phi (mind the brackets).",
                lambda: P - outer,
            ),
            Slip(
                "denominator forgotten",
                "P of `rls_step` is divided by 1, then phi'P phi is added: put the denominator in brackets.",
                lambda: P - outer + q,
            ),
            Slip(
                "sign of the correction",
                "P of `rls_step` grows: the correction is taken away.",
                lambda: P + outer / (1 + q),
            ),
            Slip(
                "phi'phi for phi phi'",
                "`rls_step` has a number where the matrix P phi phi'P belongs.",
                lambda: P - P_phi @ P_phi / (1 + q),
                mend="In numpy it is `np.outer(P @ phi, P @ phi)`.",
            ),
            Slip(
                "entry by entry",
                "`rls_step` multiplies vectors entry by entry (`*`) where the matrix P phi phi'P belongs.",
                lambda: P - P_phi * P_phi / (1 + q),
            ),
            *slips_of_update("`rls_step`", lambda update: update(P, phi, 1.0)[1], "1"),
            *(
                Slip(
                    "P only once",
                    f"the numerator in `rls_step` is {what}, with one P. {both}",
                    partial(np.subtract, P, one),
                )
                for what, one in (
                    ("phi phi'P", np.outer(phi, P_phi) / (1 + q)),
                    ("P phi phi'", np.outer(P_phi, phi) / (1 + q)),
                )
            ),
            *(
                Slip(
                    "entry by entry",
                    f"the numerator in `rls_step` is made with `*`, `{what}`, which multiplies entry by entry: {both}",
                    partial(np.subtract, P, one / (1 + q)),
                )
                for what, one in (
                    ("P * phi * phi.T * P", P * phi * phi * P),
                    ("P * phi * phi.T @ P", P * phi * phi @ P),
                    ("P @ phi * phi.T @ P", (P_phi * phi) @ P),
                    ("P @ phi * phi.T * P", P_phi * phi * P),
                    ("P @ (phi * phi) * P", P @ (phi * phi) * P),
                )
            ),
            *pairs_of("P of `rls_step`", _edits_of_covariance(P, phi), made),
            Slip(
                "P only once",
                "the numerator in `rls_step` is phi phi'.",
                lambda: P - np.outer(phi, phi) / (1 + q),
                mend="It is P phi phi'P, with P on both sides.",
            ),
            Slip(
                "inverse of P handed back",
                "`rls_step` returns the inverse of P, which is the sum of step 2.",
                lambda: np.asarray(np.linalg.inv(P) + np.outer(phi, phi), float),
            ),
        ],
    )


def _judge_theta(got: Value, theta: FloatArray, P: FloatArray, phi: FloatArray, y: float) -> Verdict:
    after, new_P = reference_step(theta, P, phi, y)
    error, q = y - phi @ theta, phi @ P @ phi
    return judge(
        as_vector("theta of rls_step(theta, P, phi, y)", got, phi.size),
        after,
        SAME,
        "old estimate plus gain times prediction error, without a matrix inverse.",
        "P of `rls_step` is right, theta is not: look at the gain and at the error that it multiplies.",
        [
            Slip(
                "gain from the old P",
                "`rls_step` takes the gain from the P before the sample.",
                lambda: theta + P @ phi * error,
                mend="K = P phi takes the P after it.",
            ),
            Slip(
                "divided twice",
                "`rls_step` divides the gain once more by 1 + phi'P phi. The new P holds that division already.",
                lambda: theta + new_P @ phi * error / (1 + q),
            ),
            Slip(
                "divided twice",
                "`rls_step` divides the gain by 1 + phi'P phi, with the new P in it.",
                lambda: theta + new_P @ phi * error / (1 + phi @ new_P @ phi),
                mend="The new P needs no division.",
            ),
            Slip(
                "sign of the error",
                "`rls_step` moves away from the sample: the sign of the error is turned round, or the correction is "
                "taken off.",
                lambda: theta - new_P @ phi * error,
                mend="The error is y - phi'theta, and K times it is added.",
            ),
            Slip(
                "y in place of the error",
                "`rls_step` corrects by K y.",
                lambda: theta + new_P @ phi * y,
                mend="It is the error y - phi'theta that corrects.",
            ),
            Slip("old estimate forgotten", "`rls_step` returns the correction alone.", lambda: after - theta),
            Slip(
                "entry by entry",
                "the error of `rls_step` is a vector: `*` multiplies phi and theta entry by entry.",
                lambda: theta + new_P @ phi * (y - phi * theta),
                mend="phi'theta is one number, `phi @ theta`.",
            ),
            Slip("theta not updated", "`rls_step` hands theta back as it was.", lambda: theta),
        ],
    )


def _size(value: Value) -> int:
    return as_array("", value).size if isinstance(value, np.ndarray) and value.dtype.kind in "biuf" else 1
