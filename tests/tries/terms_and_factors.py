"""Tries with a factor, a term, a level or an axis that stands for another, and neighbours with another cause."""

from tries import Try
from tries.rows_of_tries import in_rows

_LEVELS = (
    "y_end = y_step[-1]\nK = y_end / amplitude\nt_28 = t_step[np.argmax(y_step >= {})]\n"
    "t_63 = t_step[np.argmax(y_step >= {})]\ntau = 1.5 * (t_63 - t_28)\ntd = t_63 - tau"
)
_GRADIENT = "-Phi.T @ Y + Phi.T @ Phi @ theta"
_BIAS, _SPREAD = "np.mean(estimates, axis=0) - truth", "np.std(estimates, axis=0, ddof=1)"
_KNOWN = "y[3:] - u[2:-1]"
_ROWS_OF_B = "u[:-3]"
_MSE = "np.mean((y[half:] - y_sim_half) ** 2)"
_NOW = "now = 1.0 if np.trace(P) / lam > bound else lam"
_SS = "ct.ss([[0, 1], [-a2, -a1]], [[0], [1]], [[b2, b1]], [[0]], Ts)"
_EXPONENTIAL = "scipy.optimize.least_squares(lambda th: th[1] * np.exp(th[0] * x) - y, [0.0, 1.0]).x"
_DISTANCE = "np.linalg.norm(beacons - theta, axis=1) - ranges"
_SQUARES = "np.sum((beacons - theta) ** 2, axis=1) - ranges**2"
_RIDGE = "np.linalg.solve(Phi.T @ Phi + {} * np.eye(4), Phi.T @ Y)"

_WORSE = (
    "one = simulate_better\n\ndef simulate_better(u_act):\n    return y_offset + 0.95 * (one(u_act) - y_offset)\n\n"
)

TRIES: dict[str, tuple[Try, ...]] = {
    "prelab-sinusoids": in_rows(
        (
            "prelab-4-matrix",
            "y1 twice",
            r"`\[:, 2\]` holds y1_new, where y2_new belongs",
            (("t_new, y1_new, y2_new]", "t_new, y1_new, y1_new]"),),
        ),
        ("prelab-5-original", "sin alone", "names a curve 'sin'", ((r"$\sin(0.02\pi t)$", "sin"),)),
        (
            "prelab-5-original",
            "pi spelt out",
            "spells the Greek letter out",
            ((r"$\sin(0.02\pi t)$", "sin(0.02pi t)"),),
        ),
    ),
    "lab-identification": in_rows(
        (
            "lab-2c-state-space",
            "B and C exchanged",
            "B and C are exchanged",
            ((_SS, "ct.ss([[0, 1], [-a2, -a1]], [[b2], [b1]], [[0, 1]], [[0]], Ts)"),),
        ),
        (
            "lab-2c-state-space",
            "observable form, signs of a",
            "other signs of a1 and a2",
            ((_SS, "ct.ss([[a1, 1], [a2, 0]], [[b1], [b2]], [[1, 0]], [[0]], Ts)"),),
        ),
        (
            "lab-2c-state-space",
            "observable form, b swapped",
            "model with b1 and b2 swapped",
            ((_SS, "ct.ss([[-a1, 1], [-a2, 0]], [[b2], [b1]], [[1, 0]], [[0]], Ts)"),),
        ),
        (
            "lab-2c-state-space",
            "observable form",
            "",
            ((_SS, "ct.ss([[-a1, 1], [-a2, 0]], [[b1], [b2]], [[1, 0]], [[0]], Ts)"),),
        ),
        ("lab-2b-theta", "ridge", r"solution with Phi'Phi \+ 0.001 I", "theta_hat = " + _RIDGE.format("1e-3")),
        ("lab-2b-theta", "hardly a ridge", "", "theta_hat = " + _RIDGE.format("1e-12")),
        (
            "lab-3a-mse",
            "without the first samples",
            "averaged over the last",
            (("mse_all = np.mean((y - y_sim) ** 2)", "mse_all = np.mean((y - y_sim)[5:] ** 2)"),),
        ),
        ("lab-3a-mse", "over the variance", "divided by the variance of y", ((_MSE, f"{_MSE} / np.var(y[half:])"),)),
        ("lab-3a-mse", "over the power", r"divided by the mean of y\^2", ((_MSE, f"{_MSE} / np.mean(y[half:] ** 2)"),)),
        ("lab-3a-mse", "a fit", "a measure of fit", ((_MSE, f"1 - {_MSE} / np.var(y[half:])"),)),
    ),
    "step-response": in_rows(
        (
            "step-8-error",
            "two unknowns",
            "leaves out column 2 of Phi",
            "def error_vector(Phi, Y, theta):\n    return Y - (Phi[:, 0] * theta[0] + Phi[:, 1] * theta[1])",
        ),
        (
            "step-3-mse",
            "after the delay",
            "averaged over the last .* samples of 801",
            (("(y_step - y_approx)", "(y_step - y_approx)[t_step >= td]"),),
        ),
        (
            "step-3-mse",
            "without the last",
            "averaged over the first 800 samples of 801",
            (("(y_step - y_approx)", "(y_step - y_approx)[:-1]"),),
        ),
        (
            "step-9-minimum",
            "ridge",
            r"solution with Phi'Phi \+ 0.1 I",
            (("np.linalg.inv(Phi.T @ Phi)", "np.linalg.inv(Phi.T @ Phi + 0.1 * np.eye(Phi.shape[1]))"),),
        ),
        (
            "step-1-read",
            "shares of the amplitude",
            r"of 2, the step of the \*input\*",
            _LEVELS.format("0.283 * amplitude", "0.632 * amplitude"),
        ),
        ("step-1-read", "shares of one", "0.283 and 0.632 themselves", _LEVELS.format("0.283", "0.632")),
        ("step-1-read", "one over e", "28.3 % and 36.8 %", _LEVELS.format("0.283 * y_end", "0.368 * y_end")),
        ("step-1-read", "10 to 90 %", "10 % and 90 %", _LEVELS.format("0.1 * y_end", "0.9 * y_end")),
        (
            "step-8-gradient",
            "mean of half the squares",
            "right one divided by 8, as many as there are equations",
            ((_GRADIENT, f"({_GRADIENT}) / len(Y)"),),
        ),
        (
            "step-8-gradient",
            "over the unknowns",
            "right one divided by 3, as many as there are unknowns",
            ((_GRADIENT, f"({_GRADIENT}) / len(theta)"),),
        ),
        (
            "step-8-gradient",
            "mean of the squares",
            "twice the right one divided by 8",
            ((_GRADIENT, f"2 * ({_GRADIENT}) / len(Y)"),),
        ),
        (
            "step-8-gradient",
            "of the norm",
            "derivative of the norm",
            ((_GRADIENT, f"({_GRADIENT}) / np.linalg.norm(Y - Phi @ theta)"),),
        ),
        (
            "step-9-unique",
            "condition number",
            "or a condition number",
            (("np.linalg.matrix_rank(Phi) == Phi.shape[1]", "np.linalg.cond(Phi) < 1e8"),),
        ),
    ),
    "least-squares": in_rows(
        (
            "ls-4-fits",
            "powers as factors",
            r"columns p \* x",
            "def fit_powers(x, y, powers):\n    Phi = np.array([[p * xi for p in powers] for xi in x])\n"
            "    theta = np.linalg.lstsq(Phi, y)[0]\n    e = y - Phi @ theta\n    return theta, e @ e",
        ),
        (
            "ls-1-kind",
            "determinant and trace",
            "the determinant and the trace.* of .M",
            'def kind(M):\n    d, tr = np.linalg.det(M), np.trace(M)\n    sign = "positive" if tr > 0 else "negative"\n'
            '    if abs(d) < 1e-9:\n        return f"{sign} semidefinite"\n'
            '    return f"{sign} definite" if d > 0 else "indefinite"',
        ),
        (
            "ls-7-known",
            "known term one step late",
            r"u\(k-2\) is taken off y\(k\) in place of the known",
            ((_KNOWN, "y[3:] - u[1:-2]"),),
        ),
        (
            "ls-7-known",
            "known term of the same step",
            r"u\(k\) is taken off y\(k\) in place of the known",
            ((_KNOWN, "y[3:] - u[3:]"),),
        ),
        ("ls-7-known", "b one step early", r"column of b holds u\(k-2\) in place", ((_ROWS_OF_B, "u[1:-2]"),)),
        ("ls-7-known", "known term twice", r"takes 2 u\(k-1\) off", ((_KNOWN, "y[3:] - 2 * u[2:-1]"),)),
        ("ls-7-known", "half of the known term", r"takes 0.5 u\(k-1\) off", ((_KNOWN, "y[3:] - u[2:-1] / 2"),)),
        (
            "ls-10-confidence",
            "error of a mean",
            "divided by the root of n",
            (
                (
                    "np.sqrt(sigma2 * np.diag(np.linalg.inv(Phi.T @ Phi)))",
                    "np.sqrt(sigma2 * np.diag(np.linalg.inv(Phi.T @ Phi)) / N)",
                ),
            ),
        ),
    ),
    "recursive-identification": in_rows(
        (
            "ri-9-windup",
            "afresh before the sample",
            "P afresh at the bound",
            ((_NOW, "now = lam\n        if np.trace(P) / lam > bound:\n            P = LN * np.eye(p)"),),
        ),
        (
            "ri-9-windup",
            "norm",
            "compares the norm of P",
            (("np.trace(P) / lam > bound", "np.linalg.norm(P) / lam > bound"),),
        ),
        (
            "ri-9-windup",
            "largest",
            "compares the largest entry of P",
            (("np.trace(P) / lam > bound", "np.max(P) / lam > bound"),),
        ),
        (
            "ri-9-windup",
            "times lambda",
            "compares lambda times the trace",
            (("np.trace(P) / lam > bound", "np.trace(P) * lam > bound"),),
        ),
    ),
    "armax-and-instruments": in_rows(
        ("ai-3-limit", "the other variance above", "needs var_e", (("c * var_e / var_y", "c * var_u / var_y"),)),
        (
            "ai-3-limit",
            "variances exchanged",
            "exchanged in the variance",
            (("b**2 * var_u", "b**2 * var_e"), ("a * c) * var_e", "a * c) * var_u")),
        ),
        (
            "ai-4-covariance",
            "over the rows",
            "the number of rows: the sums",
            (("return inverse @ Phi.T @ R @ Phi @ inverse", "return inverse @ Phi.T @ R @ Phi @ inverse / N"),),
        ),
        (
            "ai-9-likelihood",
            "mean of the squares",
            r"has the \*mean\* of the squared errors",
            (("E @ E / (2", "np.mean(E**2) / (2"),),
        ),
        ("ai-3-limit", "variance of u", "divides by var_u", (("c * var_e / var_y", "c * var_e / var_u"),)),
        (
            "ai-2-bias",
            "spread along the rows",
            "the spread and the standard error of `bias_of` have one number for each of the 9 records.*in the bias, "
            "whose values are compared later",
            ((_SPREAD, "np.std(estimates, axis=1, ddof=1)"),),
        ),
        (
            "ai-2-bias",
            "mean along the rows",
            "the bias of `bias_of` has one number for each of the 9 records.*in the spread and the standard error",
            ((_BIAS, "np.mean(estimates, axis=1) - truth[0]"),),
        ),
    ),
    "nonlinear-least-squares": in_rows(
        (
            "nl-1-logarithm",
            "constant for the slope",
            "takes the constant of the line for its slope",
            (("a, c = ", "c, a = "),),
        ),
        (
            "nl-5-exponential",
            "logarithms of absolute values",
            "line through the logarithms of .y.",
            ((_EXPONENTIAL, "(lambda c: np.array([c[0], np.exp(c[1])]))(np.polyfit(x, np.log(np.abs(y)), 1))"),),
        ),
        ("nl-8-step", "n - 1", "SSE by n - 1 for", (("(len(y) - 3)", "(len(y) - 1)"),)),
        ("nl-8-step", "n - 2", "SSE by n - 2 for", (("(len(y) - 3)", "(len(y) - 2)"),)),
        ("nl-7-locate", "errors of squares", "hands over errors of the .squared. ranges", ((_DISTANCE, _SQUARES),)),
    ),
    "several-signals": in_rows(
        (
            "sev-6-reference",
            "reference in Phi",
            r"holds r\(k-1\) where u\(k-1\) belongs",
            "def fit_with_reference(u, y, r):\n    Phi = np.column_stack([y[1:-1], r[1:-1]])\n"
            "    Z = np.column_stack([r[1:-1], r[:-2]])\n    return np.linalg.solve(Z.T @ Phi, Z.T @ y[2:])",
        ),
        (
            "sev-6-reference",
            "Y left out",
            "inverse of Z'Phi times Z' alone: the product with Y",
            "def fit_with_reference(u, y, r):\n    Phi = np.column_stack([y[1:-1], u[1:-1]])\n"
            "    Z = np.column_stack([r[1:-1], r[:-2]])\n    return np.linalg.inv(Z.T @ Phi) @ Z.T",
        ),
    ),
    "postlab-model-order": in_rows(
        (
            "postlab-2-simulation",
            "no zero ahead of b1",
            r"begins with a zero, `\[0, b1\]`",
            "y_sim_1 = scipy.signal.lfilter([theta_1[1]], [1, -theta_1[0]], u)\n"
            "y_sim_2 = scipy.signal.lfilter(theta_2[2:], [1, *-theta_2[:2]], u)",
        ),
    ),
    "sim-to-real-gap": in_rows(
        ("gap-3-time", "the other axis", "adds up over the 4 stretches", (("axis=1", "axis=0"),)),
        *(
            (
                "gap-9-closed",
                name,
                f"square of the {name}",
                (("mse_after = ", _WORSE + "mse_after = "), (old, new)),
            )
            for name, old, new in (
                ("mean error", "[half:] ** 2)", "[half:]) ** 2"),
                (
                    "mean absolute error",
                    "np.mean((simulate_better(u_act) - y_act)[half:] ** 2)",
                    "np.mean(np.abs((simulate_better(u_act) - y_act)[half:])) ** 2",
                ),
            )
        ),
    ),
}
"""By assignment."""
