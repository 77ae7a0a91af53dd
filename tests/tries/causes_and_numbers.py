"""First tries whose cause is computed from the answer, with neighbours that must not get it, but their numbers."""

from tries import Try, edited

_WAVES = "[np.sin(w * t), np.cos(w * t)]"
_HERTZ = (
    (_WAVES, "[np.sin(2 * np.pi * w * t), np.cos(2 * np.pi * w * t)]"),
    ("A * np.sin(w * t) + B * np.cos(w * t) - y", "A * np.sin(2 * np.pi * w * t) + B * np.cos(2 * np.pi * w * t) - y"),
)
_SEARCHED = "the best f for waves sin and cos of 2 pi f t, in hertz"
_OUTER = "2 * np.outer(x, x)"
_FLAT = "`x \\* x` multiplies entry by entry"
_FIT = "scipy.optimize.least_squares(lambda th: th[1] * np.exp(th[0] * x) - y, [0.0, 1.0]).x"
_LEGEND = "ax_b.legend()\n"
_ONES = "with a column of ones"
_COLUMNS = "[y[n - i : N - i] for i in lags] + [u[n - i : N - i] for i in lags]"
_CARELESS, _STEP = "np.outer(K, P_phi)", "np.outer(P_phi, P_phi)"
_NOISY = "np.sin(0.02 * np.pi * t) + rng.uniform(-0.2, 0.2, t.shape)"
_SIMULATION = "def simulate_better(u_act):\n    return "
_INVERSE = "return Phi @ np.linalg.inv(Phi.T @ Phi) @ Phi.T"
_THETA = "np.linalg.solve(Phi.T @ Phi, Phi.T @ Y)"
_MEAN = "np.mean(y_act[k_settled:n_first])"


TRIES: dict[str, tuple[Try, ...]] = {
    "nonlinear-least-squares": (
        Try("nl-6-frequency", "searched in hertz", edited("nl-6-frequency", *_HERTZ), _SEARCHED, never="far larger"),
        Try(
            "nl-6-frequency",
            "A and B are 1",
            edited(
                "nl-6-frequency",
                ("np.linalg.lstsq(H, y)[0]", "np.ones(2)"),
                ("return scipy.optimize.least_squares(errors, best[1]).x[0]", "return best[1][0] + 0.2"),
            ),
            r"returns .* rad/s, where the SSE is far larger.*with the best A and B it is .* of ",
            never="hertz",
        ),
        Try(
            "nl-5-exponential",
            "nan whatever y is",
            edited("nl-5-exponential", (_FIT, "np.array([np.nan, 1.0])")),
            "returns nan. Print a, b and the SSE",
            never="logarithm",
        ),
        Try(
            "nl-5-exponential",
            "no minimum",
            edited("nl-5-exponential", (_FIT, "np.array([0.4, 3.0])")),
            "no minimum either: J'e, which is zero there, is not",
            never="start|level|SSE is far",
        ),
        Try(
            "nl-2-jacobian",
            "math.exp",
            "import math\n" + edited("nl-2-jacobian", ("growth = np.exp", "growth = math.exp")),
            r"`math\.exp` takes one number; `np\.exp` takes arrays",
            never="sin",
        ),
        Try(
            "nl-2-jacobian",
            "one number of an array",
            edited("nl-2-jacobian", ("growth = np.exp(a * x)", "growth = np.exp(float(a * x))")),
            r"`float\(\.\.\.\)` makes one number",
            never="math",
        ),
    ),
    "least-squares": (
        Try("ls-3-derivatives", "x * x.T", edited("ls-3-derivatives", (_OUTER, "2 * x * x.T")), f"2 x_j.2.*{_FLAT}"),
        Try("ls-3-derivatives", "x * x", edited("ls-3-derivatives", (_OUTER, "x * x")), f"adds x_j.2.*{_FLAT}"),
        Try(
            "ls-3-derivatives",
            "three times",
            edited("ls-3-derivatives", (_OUTER, "3 * np.outer(x, x)")),
            r"is x'x I \+ 3 x x'; asked for",
            never="entry by entry",
        ),
        Try(
            "ls-1-kind",
            "no semidefinite",
            "def kind(M):\n    w = np.linalg.eigvalsh((M + M.T) / 2)\n    w = np.where(abs(w) < 1e-9, 0.0, w)\n"
            "    if np.all(w > 0):\n        return 'positive definite'\n"
            "    if np.all(w <= 0):\n"
            "        return 'negative semidefinite' if np.any(w == 0) else 'negative definite'\n"
            "    return 'indefinite'\n",
            "which it calls indefinite. Of all .* tried it returns `positive semidefinite` for none",
            never="negative",
        ),
        Try(
            "ls-5-projector",
            "half",
            edited("ls-5-projector", (_INVERSE, f"{_INVERSE} / 2")),
            "yours does not have P P = P, nor P Phi = Phi",
            never="P' = P\\.|nor P' = P",
        ),
    ),
    "step-response": (
        Try(
            "step-9-minimum",
            "a table of another kind",
            edited(
                "step-9-minimum", ("return ", "theta = "), ("Phi.T @ Y", "Phi.T @ Y\n    return np.outer(theta, theta)")
            ),
            "Print the shape of each of its products",
            never="It comes of",
        ),
    ),
    "armax-and-instruments": (
        Try(
            "ai-8-recursive",
            "first row never set",
            edited("ai-8-recursive", ("        history[n] = theta", "        history[n] = theta if n else np.nan")),
            "row 0 of .* nan, and later rows are numbers",
            never="denominator",
        ),
    ),
    "recursive-identification": (
        Try(
            "ri-10-careless",
            "product of flat arrays",
            edited("ri-10-careless", (_CARELESS, "K * P_phi")),
            "two flat arrays entry by entry",
        ),
        Try(
            "ri-5-forgetting",
            "product of flat arrays",
            edited("ri-5-forgetting", (_STEP, "P_phi * P_phi")),
            "two flat arrays entry by entry",
        ),
        Try(
            "ri-5-forgetting",
            "product of phi",
            edited("ri-5-forgetting", (_STEP, "np.outer(P_phi, phi)")),
            "does not give the estimates of RLS, with lambda = 1",
            never="entry by entry",
        ),
    ),
    "postlab-model-order": (
        Try(
            "postlab-2-fit-order",
            "one more number",
            edited(
                "postlab-2-fit-order",
                ("return np.linalg.lstsq(Phi, y[n:])[0]", "return np.append(np.linalg.lstsq(Phi, y[n:])[0], 1.0)"),
            ),
            "one for each of 1 past y and 1 past u",
            never="constant|use n",
        ),
        Try(
            "postlab-2-fit-order",
            "past inputs of another sign",
            edited("postlab-2-fit-order", (_COLUMNS, "[u[n - i : N - i] for i in lags]")),
            "one for each of 1 past y and 1 past u",
            never="are added",
        ),
    ),
    "lab-identification": (
        Try(
            "lab-2b-theta",
            "one more number",
            edited("lab-2b-theta", (_THETA, f"np.append({_THETA}, 0.0)")),
            "should have 4 elements",
            never=_ONES,
        ),
        Try(
            "lab-1c-offsets",
            "some samples",
            edited("lab-1c-offsets", (_MEAN, "np.mean(y_act[150:260])")),
            r"It is the mean of `y_act\[150:260\]`",
        ),
        Try(
            "lab-1c-offsets",
            "a mean of no samples in a row",
            edited("lab-1c-offsets", (_MEAN, f"{_MEAN} + 0.2345")),
            "lies above all that the output does there",
            never="is the mean of `y_act",
        ),
    ),
    "prelab-sinusoids": (
        Try(
            "prelab-2-noise",
            "cut to the amplitude",
            edited("prelab-2-noise", (_NOISY, f"np.clip(1.6 * ({_NOISY}), -1, 1)")),
            "strongest oscillation has a period of 100 s, amplitude 1.2",
            never="brackets|angle",
        ),
        Try(
            "prelab-6-cut-off",
            "no legend called",
            edited("prelab-6-cut-off", (_LEGEND, "")),
            "legend should name.*The other panel has that",
            never="give each|each curve needs",
        ),
        Try(
            "prelab-6-cut-off",
            "one label",
            edited("prelab-6-cut-off", (', label=r"$\\sin(0.02\\pi t)$"', "")),
            "name 2 curves, and it names 1: each curve needs a `label`",
            never="call",
        ),
        Try(
            "prelab-6-cut-off",
            "no labels and no legend",
            edited(
                "prelab-6-cut-off",
                (_LEGEND, ""),
                (', label=r"$\\sin(0.02\\pi t)$"', ""),
                (', label=r"$\\cos(0.02\\pi t)$"', ""),
            ),
            "give each a `label` and call `legend`",
            never="have a",
        ),
    ),
    "sim-to-real-gap": (
        Try(
            "gap-7-simulation",
            "output of the record",
            f"{_SIMULATION}y_lin + y_offset",
            "output of the linear model on your record, whatever it is handed: its argument is ignored",
            never="out of the range",
        ),
        Try(
            "gap-7-simulation",
            "the linear model",
            f"{_SIMULATION}free_run(theta_hat, u_act - u_offset) + y_offset",
            "does what the linear model does: there is no effect in it",
            never="ignored",
        ),
    ),
}
"""By assignment."""
