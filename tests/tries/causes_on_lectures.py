"""First tries whose message names one cause, neighbours, and right answers like them: the lectures."""

from tries import Try
from tries.rows_of_tries import in_rows

_RLS = "P = (P - np.outer(P_phi, P_phi) / (lam + phi @ P_phi)) / lam"
_INSIDE = "P = P - np.outer(P_phi, P_phi) / (lam + phi @ P_phi) / lam"
_NO_P = r"phi'phi in it, without P"
_BRACKET = "only the correction by lambda"
_FIT = "th[1] * np.exp(th[0] * x) - y, [0.0, 1.0]"
_AGAIN = "        phi = np.array([-y[n - 1], u[n - 1], epsilon])\n"
_EPSILON = "        epsilon = y[n] - phi @ theta\n"

TRIES: dict[str, tuple[Try, ...]] = {
    "least-squares": in_rows(
        (
            "ls-10-confidence",
            "sigma^2 before the root",
            r"sigma\^2 stands before the root, and belongs under it",
            (("np.sqrt(sigma2 * np.diag(", "sigma2 * np.sqrt(np.diag("),),
        ),
    ),
    "armax-and-instruments": in_rows(
        ("ai-6-rels", "error of the sample", r"has epsilon\(n\) in the regressor", ((_EPSILON, _EPSILON + _AGAIN),)),
        (
            "ai-6-rels",
            "error of the sample, twice",
            r"has epsilon\(n\) in the regressor",
            ((_EPSILON, _EPSILON + _AGAIN + _EPSILON),),
        ),
        (
            "ai-2-bias",
            "mean of the truth",
            "takes the mean of the truth off",
            (("estimates, axis=0) - truth", "estimates, axis=0) - np.mean(truth)"),),
        ),
        (
            "ai-2-bias",
            "one mean of the estimates",
            "takes one mean of all estimates",
            (("np.mean(estimates, axis=0) - truth", "np.mean(estimates) - truth"),),
        ),
    ),
    "model-structures": in_rows(
        (
            "ms-10-autocorrelation",
            "divided by N, too",
            "divides once too often",
            (("/ (e @ e)", "/ (e @ e) / N"),),
        ),
        (
            "ms-10-autocorrelation",
            "divided by the variance, too",
            "divides once too often",
            (("/ (e @ e)", "/ (e @ e) / np.var(e)"),),
        ),
        ("ms-10-autocorrelation", "divided by r(0)", "", (("/ (e @ e)", "/ N / np.var(e)"),)),
        (
            "ms-7-excitation",
            "largest left out",
            "stops one order too early",
            (("range(1, largest + 1)", "range(1, largest)"),),
        ),
        ("ms-7-excitation", "one too low", "is one too low", (("return order", "return max(order - 1, 0)"),)),
        (
            "ms-8-order",
            "inputs from u(k)",
            r"begins the inputs with u\(k\)",
            (("u[start - i : N - i] for i in range(1, n + 1)", "u[start - i : N - i] for i in range(n)"),),
        ),
        (
            "ms-8-order",
            "outputs from y(k)",
            r"rows hold y\(k\) itself",
            (("-y[start - i : N - i] for i in range(1, n + 1)", "-y[start - i : N - i] for i in range(n)"),),
        ),
        ("ms-9-cancel", "Q twice", "what is left of Q twice", (("np.poly(of_P)", "np.poly(of_Q)"),)),
        (
            "ms-9-cancel",
            "P twice",
            "what is left of P twice",
            (("np.atleast_1d(np.poly(of_Q))", "np.atleast_1d(np.poly(of_P))"),),
        ),
    ),
    "recursive-identification": in_rows(
        ("ri-3-step", "phi'phi below", f"{_NO_P}: it is 1", (("1 + phi @ P_phi", "1 + phi @ phi"),)),
        (
            "ri-3-step",
            "sign of the error",
            "moves away",
            (("y - phi @ theta", "phi @ theta - y"),),
        ),
        (
            "ri-5-forgetting",
            "1 below",
            "1 \\+ phi'P phi",
            (("lam + phi @ P_phi", "1 + phi @ P_phi"),),
        ),
        ("ri-5-forgetting", "lambda in the bracket", _BRACKET, ((_RLS, _INSIDE),)),
        (
            "ri-5-forgetting",
            "sign of the error",
            "the sign of the error is turned",
            (("Y[k] - phi @ theta", "phi @ theta - Y[k]"),),
        ),
        (
            "ri-9-windup",
            "trace over lambda stored",
            "are divided by lambda: store",
            (("theta, np.trace(P)", "theta, np.trace(P) / lam"),),
        ),
        (
            "ri-10-careless",
            "lambda in the bracket",
            _BRACKET,
            (("(P - np.outer(K, P_phi)) / lam", "P - np.outer(K, P_phi) / lam"),),
        ),
        ("ri-10-careless", "phi'phi below", _NO_P, (("lam + phi @ P_phi", "lam + phi @ phi"),)),
    ),
    "nonlinear-least-squares": in_rows(
        (
            "nl-3-gauss-newton",
            "the step for theta",
            "takes the step for the new theta",
            (("theta = theta + s", "theta = s"),),
        ),
        (
            "nl-5-exponential",
            "sum from another start",
            "stops at an SSE of .* is possible: in the right valley",
            ((_FIT, "np.sum((th[1] * np.exp(th[0] * x) - y) ** 2), [0.3, 0.7]"),),
        ),
        (
            "nl-5-exponential",
            "minimize of the sum",
            "",
            (
                (
                    f"least_squares(lambda th: {_FIT})",
                    "minimize(lambda th: np.sum((th[1] * np.exp(th[0] * x) - y) ** 2), [0.0, 1.0])",
                ),
            ),
        ),
        (
            "nl-5-exponential",
            "fmin of the sum",
            "",
            (
                (
                    f"least_squares(lambda th: {_FIT}).x",
                    "fmin(lambda th: np.sum((th[1] * np.exp(th[0] * x) - y) ** 2), [0.0, 1.0], disp=0)",
                ),
            ),
        ),
    ),
}
"""By assignment."""
