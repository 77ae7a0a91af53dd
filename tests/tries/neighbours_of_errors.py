"""First tries that stop with an error that another mistake has, too: the cause of the other must not be said."""

from tries import TAUGHT, Try, edited

TRIES: dict[str, tuple[Try, ...]] = {
    "lab-identification": (
        Try(
            "lab-3a-all",
            "denominator left out",
            "y_sim = scipy.signal.lfilter([0, b1, b2], u)",
            "`scipy.signal.lfilter` needs `x`, too",
            TAUGHT,
            "one by one",
        ),
        Try(
            "lab-1c-offsets",
            "a number called",
            "y_offset = np.mean(y_act[:n_first()])",
            "it takes no round brackets",
            TAUGHT,
            "a product is",
        ),
        Try(
            "lab-1b-figure-5",
            "two signals in one list",
            edited("lab-1b-figure-5", ("ax_a.plot(t, y_act, ", "ax_a.plot(t, [y_act, y_actm], ")),
            "a table is drawn column by column",
            TAUGHT,
            "same length",
        ),
    ),
    "step-response": (
        Try(
            "step-6-cut",
            "a tuple of the changes",
            "changes = np.where(np.diff(u_act)) + 1",
            r"the array of all of them `np.where\(np.diff\(u_act\)\)\[0\]`",
            TAUGHT,
            "argmax",
        ),
    ),
    "least-squares": (
        Try(
            "ls-9-constrained",
            "A not transposed",
            edited("ls-9-constrained", ("A.T]", "A]")),
            "is `A.T` meant",
            TAUGHT,
            "empty corner",
        ),
        Try(
            "ls-10-confidence",
            "degrees of freedom left out",
            edited("ls-10-confidence", (" / 2, N - p)", " / 2)")),
            "`scipy.stats.t.ppf` needs `df`, too",
            TAUGHT,
            "first line of",
        ),
        Try(
            "ls-3-derivatives",
            "a vector as a size",
            edited("ls-3-derivatives", ("np.eye(len(x))", "np.eye(x)")),
            r"its length is `len\(x\)`",
            TAUGHT,
            "float",
        ),
    ),
    "model-structures": (
        Try(
            "ms-9-cancel",
            "remove of an array",
            'def cancel(P, Q, within):\n    """C."""\n    p = np.roots(P)\n    p.remove(p[0])\n    return p, p',
            "a method of lists",
            TAUGHT,
            "axes",
        ),
        Try(
            "ms-5-simulate",
            "polynomials taken whole",
            'def simulate(A, B, C, u, e):\n    """O."""\n    y = np.zeros(len(u))\n    for t in range(len(u)):\n'
            "        y[t] = B * u[t - 1] + C * e[t] - A * y[t - 1]\n    return y",
            "something on the right is taken whole",
        ),
    ),
    "recursive-identification": (
        Try(
            "ri-5-forgetting",
            "P of N by N",
            edited(
                "ri-5-forgetting",
                ("LN * np.eye(p)", "LN * np.eye(len(Y))"),
                ("theta, P =", "theta = np.zeros(p)\n    _, P ="),
            ),
            "the first has 998 columns and the second 3 rows",
            TAUGHT,
            "is a row of",
        ),
        Try(
            "ri-3-step",
            "an inverse of a number",
            edited("ri-3-step", ("/ (1 + phi @ P_phi)", "@ np.linalg.inv(1 + phi @ P_phi)")),
            "The inverse of a number x is `1 / x`",
            TAUGHT,
            "flat array",
        ),
    ),
    "nonlinear-least-squares": (
        Try(
            "nl-9-output-error",
            "one sample short in the search",
            edited("nl-9-output-error", ("[1, th[0]], u) - y", "[1, th[0]], u[:-1]) - y")),
            "149 entries and `y` has 150",
            TAUGHT,
            "the notebook's own",
        ),
        Try(
            "nl-5-exponential",
            "data in place of the start",
            edited("nl-5-exponential", ("[0.0, 1.0]).x", "x, y).x")),
            "arises within the function that is called",
            TAUGHT,
            "`if`, `while`",
        ),
    ),
    "several-signals": (
        Try(
            "sev-2-offsets",
            "mean along the rows",
            edited("sev-2-offsets", ("y[:n].mean(axis=0)", "y[:n].mean(axis=1)")),
            "`axis=0` makes one of each column, 2 in all",
            TAUGHT,
            "is a row of",
        ),
    ),
}
