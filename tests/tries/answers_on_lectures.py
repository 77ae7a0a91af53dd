"""First tries with a wrong result, and right answers in an unusual way: the lectures."""

from tries import Try
from tries.rows_of_tries import TO_Y, in_rows

_END = r"from the \*end\* of the record"
_INPUT = "has the input on the left-hand side"
_ROLLED = (("[-y[:-1], u[:-1]]", "[-np.roll(y, 1), np.roll(u, 1)]"), ("y[1:])[0]", "y)[0]"))

TRIES: dict[str, tuple[Try, ...]] = {
    "least-squares": in_rows(
        (
            "ls-2-delays",
            "rows of zeros",
            r"Rows 0 to 1 .* are zero, and should not be",
            "def delayed_inputs(u, n):\n    P = np.zeros((len(u), n))\n    for t in range(n - 1, len(u)):\n"
            "        for i in range(n):\n            P[t, i] = u[t - i]\n    return P",
        ),
        (
            "ls-2-delays",
            "toeplitz",
            "above its diagonal",
            "def delayed_inputs(u, n):\n    return np.array([[u[abs(t - i)] for i in range(n)] for t in "
            "range(len(u))])",
        ),
        (
            "ls-7-known",
            "rolled",
            f"`example_1` takes samples {_END}",
            "def example_1(u, y):\n    Phi = np.column_stack([-np.roll(y, 2), np.roll(u, 3)])\n    return "
            "np.linalg.lstsq(Phi, y - np.roll(u, 1))[0]",
        ),
        (
            "ls-2-delays",
            "rolled and set to zero",
            "",
            "def delayed_inputs(u, n):\n    P = np.column_stack([np.roll(u, i) for i in range(n)])\n    return P "
            "* (np.arange(len(u))[:, None] >= np.arange(n))",
        ),
    ),
    "model-structures": in_rows(
        ("ms-4-equations", "Y one early", f"{TO_Y} Y: it is 1 sample early", (("y[k0:]", "y[k0 - 1 : -1]"),)),
        ("ms-4-equations", "Y with a minus", f"{TO_Y} Y: all of it has the wrong sign", (("y[k0:]", "-y[k0:]"),)),
        (
            "ms-4-equations",
            "rolled",
            "`np.roll` brings the last samples before the first",
            "def equations(u, y, na, nb, d):\n    past = [-np.roll(y, i) for i in range(1, na + 1)] + "
            "[np.roll(u, i) for i in range(d, d + nb)]\n"
            "    return np.column_stack(past), y",
        ),
        ("ms-5-example-3-1", "rolled", f"`example_3_1` takes samples {_END}", _ROLLED),
        ("ms-5-example-3-1", "Y of the input", f"`example_3_1` {_INPUT}", (("y[1:])[0]", "u[1:])[0]"),)),
        (
            "ms-5-example-3-1",
            "a row of zeros",
            "",
            (
                ("np.column_stack([-y[:-1], u[:-1]])", "np.vstack([[0, 0], np.column_stack([-y[:-1], u[:-1]])])"),
                ("y[1:]", "y"),
            ),
        ),
        (
            "ms-6-predict",
            "rolled",
            "`predict` takes the last samples",
            (
                (
                    "scipy.signal.lfilter(B, [1], u) - scipy.signal.lfilter(A, [1], y) + y",
                    "sum(b * np.roll(u, i) for i, b in enumerate(B)) - sum(A[i] * np.roll(y, i) for i in "
                    "range(1, len(A)))",
                ),
            ),
        ),
        (
            "ms-6-predict",
            "inputs go round",
            "`free_run` takes the last inputs",
            (
                (
                    "return scipy.signal.lfilter(B, A, u)",
                    "return scipy.signal.lfilter([1], A, sum(b * np.roll(u, i) for i, b in enumerate(B)))",
                ),
            ),
        ),
        (
            "ms-7-excitation",
            "rolled",
            "as if it went round.*frequencies are counted",
            (("u[n - 1 - i : len(u) - i]", "np.roll(u, i)"),),
        ),
        ("ms-3-state-space", "C flat", "", ((".reshape(1, n)", ""),)),
        (
            "ms-7-excitation",
            "rank of the input",
            "as the rank of a flat array is",
            "def excitation(u, largest):\n    return np.linalg.matrix_rank(u)",
        ),
        (
            "ms-8-order",
            "the best order",
            "one number, the whole number",
            (("return np.array(V)", "return np.argmin(V)"),),
        ),
        (
            "ms-8-order",
            "rolled",
            f"`losses` takes samples {_END}",
            (
                ("-y[start - i : N - i]", "-np.roll(y, i)"),
                ("u[start - i : N - i]", "np.roll(u, i)"),
                ("y[start:]", "y"),
            ),
        ),
        (
            "ms-8-order",
            "Y too early",
            r"has y\(k-4\) on the left-hand side",
            (("columns), y[start:]", "columns), y[:-start]"),),
        ),
    ),
    "recursive-identification": in_rows(
        (
            "ri-4-regressors",
            "rows of zeros",
            r"Row 1 \(counted from 0\) is zero, and should not be",
            "def regressors(u, y):\n    Phi = np.zeros((len(y), 3))\n    for t in range(2, len(y)):\n        "
            "Phi[t] = [-y[t-1], -y[t-2], u[t-1]]\n"
            "    return Phi, y\n\n\nPhi_61, Y_61 = regressors(u_61, y_61)",
        ),
        (
            "ri-10-careless",
            "an index for the asymmetry",
            "divided by max.P., both of the same P",
            (("np.max(np.abs(P - P.T))", "np.argmax(np.abs(P - P.T))"),),
        ),
        (
            "ri-5-forgetting",
            "row by row",
            "",
            (("phi = Phi[k]", "phi = Phi[k, :]"), ("history[k] =", "history[k, :] =")),
        ),
    ),
    "armax-and-instruments": in_rows(
        ("ai-1-tables", "rolled", f"`fit_arx` takes samples {_END}", _ROLLED),
        ("ai-1-tables", "Y one early", r"`fit_arx` has y\(k-1\) on the left-hand side", (("y[1:])[0]", "y[:-1])[0]"),)),
        ("ai-1-tables", "Y of the input", f"`fit_arx` {_INPUT}", (("y[1:])[0]", "u[1:])[0]"),)),
        (
            "ai-5-armax",
            "rolled",
            rf"takes y\(-1\) and u\(-1\) {_END}",
            (
                (
                    "w = np.zeros(len(y))\n    w[1:] = y[1:] + a * y[:-1] - b * u[:-1]",
                    "w = y + a * np.roll(y, 1) - b * np.roll(u, 1)",
                ),
            ),
        ),
        (
            "ai-5-armax",
            "begins with the third sample",
            r"leaves epsilon\(1\) at zero",
            (("w[1:] = y[1:] + a * y[:-1] - b * u[:-1]", "w[2:] = y[2:] + a * y[1:-1] - b * u[1:-1]"),),
        ),
        (
            "ai-7-iterated",
            "Y one early",
            r"has y\(k-1\) on the left-hand side",
            (("u[:-1]]), y[1:]", "u[:-1]]), y[:-1]"),),
        ),
        (
            "ai-7-iterated",
            "rolled",
            f"takes samples {_END}",
            (
                ("[-y[:-1], u[:-1]]), y[1:]", "[-np.roll(y, 1), np.roll(u, 1)]), y"),
                ("-y_M[:-1], u[:-1]", "-np.roll(y_M, 1), np.roll(u, 1)"),
            ),
        ),
        ("ai-5-armax", "errors rolled and cut", "", (("[Phi, epsilon[:-1]]", "[Phi, np.roll(epsilon, 1)[1:]]"),)),
    ),
    "nonlinear-least-squares": in_rows(
        (
            "nl-7-locate",
            "the index of the best",
            "one number, the whole number",
            (("min(fits, key=lambda fit: fit.cost).x", "np.argmin([fit.cost for fit in fits])"),),
        ),
        (
            "nl-9-output-error",
            "the run goes round",
            "takes the last input for the one before the first",
            "def fit_output_error(u, y):\n    def errors(th):\n        x = np.zeros(len(u))\n        for k in "
            "range(len(u)):\n"
            "            x[k] = -th[0] * x[k - 1] + th[1] * u[k - 1]\n        return x - y\n\n"
            "    return scipy.optimize.least_squares(errors, [-0.5, 0.5]).x",
        ),
        ("nl-9-output-error", "another start", "", (("y[1:])[0]", "y[:-1])[0]"),)),
    ),
}
"""By assignment."""
