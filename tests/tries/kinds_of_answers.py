"""First tries with a wrong result, by kind, and right answers in an unusual way: at questions of several "
"assignments."""

from tries import ACCEPTED, TAUGHT, Try, edited


def _tries(*rows: tuple[str, str, str, tuple[tuple[str, str], ...] | str]) -> tuple[Try, ...]:
    """Tries from rows of question, name, what the message says, and the changes of the model solution or the code.

    Where nothing is said, the answer is acceptable.
    """
    return tuple(
        Try(
            question,
            name,
            code if isinstance(code, str) else edited(question, *code),
            says,
            TAUGHT if says else ACCEPTED,
        )
        for question, name, says, code in rows
    )


_Y = "is right, with the rows of k = .*What is wrong is"
_END = r"from the \*end\* of the record"
_INPUT = "has the input on the left-hand side"
_OTHER = "The other panel has that"
_ROLLED = (("[-y[:-1], u[:-1]]", "[-np.roll(y, 1), np.roll(u, 1)]"), ("y[1:])[0]", "y)[0]"))

TRIES: dict[str, tuple[Try, ...]] = {
    "prelab-sinusoids": _tries(
        (
            "prelab-3-cut",
            "first samples zero",
            "are set to zero: they should be cut off, so",
            "t_new = t - 20\nt_new[:200] = 0\ny1_new = y1.copy()\ny2_new = y2.copy()",
        ),
        (
            "prelab-3-cut",
            "signal zero at first",
            "are set to zero: they should be cut off, `y1",
            "t_new = t[200:] - t[200]\ny1_new = y1.copy()\ny1_new[:200] = 0\ny2_new = y2[200:]",
        ),
        (
            "prelab-3-cut",
            "rolled",
            "`np.roll` goes round.*`y1",
            "t_new = t[200:] - t[200]\ny1_new = np.roll(y1, -200)\ny2_new = np.roll(y2, -200)",
        ),
        (
            "prelab-3-cut",
            "time rolled",
            "`np.roll` goes round.*`t",
            "t_new = np.roll(t, -200)\ny1_new = y1[200:]\ny2_new = y2[200:]",
        ),
        (
            "prelab-4-function",
            "rows zero",
            "sets the first n rows to zero",
            "def cut_off(data, n):\n    rest = data.copy()\n    rest[:n] = 0\n    return rest",
        ),
        (
            "prelab-4-function",
            "rolled",
            "`np.roll` goes round",
            "def cut_off(data, n):\n    rest = np.roll(data, -n, axis=0)\n    return rest",
        ),
        (
            "prelab-5-original",
            "limits of the lower panel",
            f"runs from .*{_OTHER}.*`ax_a`",
            (("ax_a.set_xlim", "ax_b.set_xlim"), ("ax_a.set_ylim", "ax_b.set_ylim")),
        ),
        (
            "prelab-5-original",
            "plt.xlim",
            f"runs from .*{_OTHER}.*`ax_a`",
            (("ax_a.set_xlim", "plt.xlim"), ("ax_a.set_ylim", "plt.ylim")),
        ),
        ("prelab-5-original", "grid of the lower panel", f"no grid.*{_OTHER}", (("ax_a.grid", "ax_b.grid"),)),
        (
            "prelab-6-cut-off",
            "limits of the upper panel",
            f"runs from .*{_OTHER}.*`ax_b`",
            (("ax_b.set_xlim", "ax_a.set_xlim"), ("ax_b.set_ylim", "ax_a.set_ylim")),
        ),
        (
            "prelab-6-cut-off",
            "legend of the upper panel",
            f"legend should name.*{_OTHER}",
            (("ax_b.legend", "ax_a.legend"),),
        ),
        (
            "prelab-6-cut-off",
            "label of the upper panel",
            f"no label.*{_OTHER}",
            (("ax_b.set_xlabel", "ax_a.set_xlabel"),),
        ),
        (
            "prelab-6-cut-off",
            "the axes made last",
            "",
            (("ax_b.set_xlim", "plt.gca().set_xlim"), ("ax_b.set_ylim", "plt.gca().set_ylim")),
        ),
    ),
    "lab-identification": _tries(
        (
            "lab-1c-loop",
            "all indices",
            r"The first of these indices is the answer",
            "def first_period(u):\n    return np.where(u != u[0])\n\n\nn_first = 10",
        ),
        (
            "lab-1c-loop",
            "a mask",
            "a truth value for each sample",
            "def first_period(u):\n    return u != u[0]\n\n\nn_first = 10",
        ),
        (
            "lab-1c-loop",
            "the new value",
            "the new value of the input",
            "def first_period(u):\n    return u[np.argmax(u != u[0])]\n\n\nn_first = 10",
        ),
        (
            "lab-1c-loop",
            "largest rise",
            "the largest rise",
            "def first_period(u):\n    return np.argmax(np.diff(u))\n\n\nn_first = 10",
        ),
        (
            "lab-2a-phi",
            "Y from the start",
            rf"449 rows and `Y` 451.*{_Y} `Y`.*holds y\[0\] to y\[450\]",
            (("Y = y[2:half]", "Y = y[:half]"),),
        ),
        (
            "lab-2a-phi",
            "Y to the end",
            rf"449 rows and `Y` 901.*{_Y} `Y`.*holds y\[2\] to y\[902\]",
            (("Y = y[2:half]", "Y = y[2:]"),),
        ),
        ("lab-2a-phi", "Y one early", f"{_Y} `Y`: it is 1 sample early", (("Y = y[2:half]", "Y = y[1 : half - 1]"),)),
        ("lab-2a-phi", "Y of the input", f"{_Y} `Y`: it holds the input", (("Y = y[2:half]", "Y = u[2:half]"),)),
        (
            "lab-2a-phi",
            "Y with its offset",
            f"{_Y} `Y`: a constant is added",
            (("Y = y[2:half]", "Y = y_act[2:half]"),),
        ),
        (
            "lab-2a-phi",
            "rows of zeros",
            "Row 1 of `Phi` should not be all zeros",
            "half = len(y) // 2\nPhi = np.zeros((half, 4))\nfor k in range(2, half):\n    Phi[k] = [y[k-1], "
            "y[k-2], u[k-1], u[k-2]]\nY = y[:half]",
        ),
        (
            "lab-2a-phi",
            "zeros before the record",
            "",
            "half = len(y) // 2\nd = lambda x, k: np.r_[np.zeros(k), x[:half - k]]\nPhi = np.column_stack([d(y, "
            "1), d(y, 2), d(u, 1), d(u, 2)])\nY = y[:half]",
        ),
        ("lab-3a-mse", "first half", "the first half only", (("(y - y_sim) ** 2", "(y - y_sim)[:half] ** 2"),)),
        (
            "lab-3a-all",
            "measured half joined",
            "is the measured output in its first half",
            "y_sim = np.concatenate([y[:half], y_sim_half])",
        ),
        ("lab-2b-theta", "transposed throughout", "", "theta_hat = Y.T @ Phi @ np.linalg.inv(Phi.T @ Phi)"),
        (
            "lab-2b-parameters",
            "arrays of one entry",
            "",
            "a1, a2 = -theta_hat[0:1], -theta_hat[1:2]\nb1, b2 = theta_hat[2:3], theta_hat[3:4]",
        ),
    ),
    "postlab-model-order": _tries(
        (
            "postlab-1-phi",
            "Y from the start",
            rf"450 rows and `Y_1` 451.*{_Y} `Y_1`",
            (("Y_1 = y[1:half]", "Y_1 = y[:half]"),),
        ),
        (
            "postlab-1-phi",
            "Y of the input",
            f"{_Y} `Y_1`: it holds the input",
            (("Y_1 = y[1:half]", "Y_1 = u[1:half]"),),
        ),
        (
            "postlab-1-phi",
            "a row of zeros too many",
            "Row 1 of `Phi_1` should not be all zeros",
            "Phi_1 = np.zeros((half, 2))\nPhi_1[2:, 0] = y[1 : half - 1]\nPhi_1[2:, 1] = u[1 : half - 1]\nY_1 = "
            "y[:half]",
        ),
        (
            "postlab-1-phi",
            "one row of zeros",
            "",
            "Phi_1 = np.zeros((half, 2))\nPhi_1[1:, 0] = y[: half - 1]\nPhi_1[1:, 1] = u[: half - 1]\nY_1 = y[:half]",
        ),
        (
            "postlab-1-transfer-function",
            "a quotient of numbers",
            r"Make it with `ct.tf\(",
            "G_1 = theta_1[1] / (1 - theta_1[0])",
        ),
        (
            "postlab-2-fit-order",
            "rolled",
            f"`fit_order` takes samples {_END}",
            "def fit_order(u, y, n):\n    past = [np.roll(x, i) for x in (y, u) for i in range(1, n + 1)]\n"
            "    return np.linalg.lstsq(np.column_stack(past), y)[0]\n\n\ntheta_2 = fit_order(u[:half], y[:half], 2)",
        ),
        ("postlab-2-fit-order", "Y of the input", f"`fit_order` {_INPUT}", (("y[n:])[0]", "u[n:])[0]"),)),
        ("postlab-3-mse", "first half", "the first half only", (("(y - y_sim_1) ** 2", "(y - y_sim_1)[:half] ** 2"),)),
    ),
    "several-signals": _tries(
        ("sev-3-phi", "Y too early", f"{_Y} Y: it is 2 samples early", (("y[n:, i]", "y[: N - n, i]"),)),
        ("sev-3-phi", "Y of the input", f"{_Y} Y: it holds the input", (("y[n:, i]", "u[n:, i]"),)),
        ("sev-3-phi", "rolled and cut", "", (("x[n - lag : N - lag]", "np.roll(x, lag)[n:]"),)),
        (
            "sev-3-phi",
            "zeros before the record",
            "rows for .* samples",
            (("x[n - lag : N - lag]", "np.r_[np.zeros(lag), x[: N - lag]]"), ("y[n:, i]", "y[:, i]")),
        ),
        (
            "sev-5-run",
            "inputs go round",
            "takes the last inputs for those before the first",
            "def simulate_output(theta, u, n):\n    y = np.zeros(len(u))\n    for k in range(len(u)):\n        "
            "for i in range(n):\n"
            "            y[k] += theta[i] * y[k - i - 1] + sum(theta[n + j * n + i] * u[k - i - 1, j] for j in "
            "range(u.shape[1]))\n    return y",
        ),
        (
            "sev-5-run",
            "a counted from one",
            "begins with the second of the n numbers of a",
            (("-theta[:n]", "-theta[1:n]"),),
        ),
        (
            "sev-6-reference",
            "rolled",
            f"takes samples {_END}",
            "def fit_with_reference(u, y, r):\n    Phi = np.column_stack([np.roll(y, 1), np.roll(u, 1)])\n"
            "    Z = np.column_stack([np.roll(r, 1), np.roll(r, 2)])\n    return np.linalg.solve(Z.T @ Phi, Z.T @ y)",
        ),
        ("sev-6-reference", "Y one early", r"Y is not: it holds y\(k-1\)", (("y[2:]", "y[1:-1]"),)),
    ),
    "step-response": _tries(
        ("step-1-read", "outputs for times", r"the \*outputs\* at 28.3 %", (("t_step[np.argmax", "y_step[np.argmax"),)),
        (
            "step-1-read",
            "argmin of the difference",
            "the same instant",
            (
                ("np.argmax(y_step >= (1 - np.exp(-1 / 3)) * y_end)", "np.argmin(y_step - 0.283 * y_end)"),
                ("np.argmax(y_step >= (1 - np.exp(-1)) * y_end)", "np.argmin(y_step - 0.632 * y_end)"),
            ),
        ),
        (
            "step-5-function",
            "shares for times",
            r"the \*outputs\* at 28.3 %",
            (("t[np.argmax(way", "way[np.argmax(way"),),
        ),
        (
            "step-5-function",
            "no argument read",
            "reads none of its arguments, `t`, `y` and `amplitude`",
            "def read_step(t, y, amplitude):\n    return K, tau, td",
        ),
        (
            "step-2-response",
            "bracket too early",
            "divides .* by tau, not its exponent",
            "def first_order_response(t, K, tau, td, amplitude):\n    return K * amplitude * (1 - "
            "np.exp(-np.maximum(t - td, 0)) / tau)",
        ),
        (
            "step-7-two",
            "a row twice",
            "is it zero\\? A row, or a column, of `U` that is taken twice",
            (("U[0, 0] * U[1, 1] - U[0, 1] * U[1, 0]", "U[0, 0] * U[0, 1] - U[0, 1] * U[0, 0]"),),
        ),
        (
            "step-7-two",
            "a row twice, divided",
            "divides by zero .* determinant is",
            "def solve_two(U, Y):\n    (u11, u12), (u21, u22) = U[0], U[0]\n    d = u11 * u22 - u12 * u21\n"
            "    return np.array([u22 * Y[0] - u12 * Y[1], u11 * Y[1] - u21 * Y[0]]) / d",
        ),
        ("step-7-two", "condition turned", "the wrong way round", (("determinant == 0", "determinant != 0"),)),
        (
            "step-7-two",
            "positive determinants only",
            "a negative determinant gives one",
            "def solve_two(U, Y):\n    return np.linalg.solve(U, Y) if np.linalg.det(U) > 1e-9 else None",
        ),
        (
            "step-8-error",
            "an entry for each of Phi",
            "should have 3 elements; it has 9",
            "def error_vector(Phi, Y, theta):\n    E = np.zeros(Phi.size)\n    for i in range(len(Y)):\n        "
            "E[i] = Y[i] - Phi[i] @ theta\n    return E",
        ),
        (
            "step-8-loss",
            "absolute errors",
            "adds absolute errors",
            "def loss(Phi, Y, theta):\n    return 0.5 * np.sum(abs(Y - Phi @ theta))",
        ),
        ("step-9-unique", "the whole shape", r"`Phi.shape` has two numbers", (("Phi.shape[1]", "Phi.shape"),)),
        (
            "step-7-two",
            "by numpy",
            "",
            "def solve_two(U, Y):\n    return None if np.linalg.matrix_rank(U) < 2 else np.linalg.solve(U, Y)",
        ),
    ),
    "least-squares": _tries(
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
    "model-structures": _tries(
        ("ms-4-equations", "Y one early", f"{_Y} Y: it is 1 sample early", (("y[k0:]", "y[k0 - 1 : -1]"),)),
        ("ms-4-equations", "Y with a minus", f"{_Y} Y: all of it has the wrong sign", (("y[k0:]", "-y[k0:]"),)),
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
        ("ms-8-order", "the best order", "Is it an index", (("return np.array(V)", "return np.argmin(V)"),)),
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
    "recursive-identification": _tries(
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
            "is it an index, of `np.argmax`",
            (("np.max(np.abs(P - P.T))", "np.argmax(np.abs(P - P.T))"),),
        ),
        (
            "ri-5-forgetting",
            "row by row",
            "",
            (("phi = Phi[k]", "phi = Phi[k, :]"), ("history[k] =", "history[k, :] =")),
        ),
    ),
    "armax-and-instruments": _tries(
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
    "nonlinear-least-squares": _tries(
        (
            "nl-7-locate",
            "the index of the best",
            "Is it an index",
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
    "sim-to-real-gap": _tries(
        (
            "gap-2-linear",
            "rolled",
            f"`theta_arx` takes samples {_END}",
            (
                (
                    "[y[1 : half - 1], y[: half - 2], u[1 : half - 1], u[: half - 2]]",
                    "[np.roll(x[:half], i) for x in (y, u) for i in (1, 2)]",
                ),
                ("y[2:half]", "y[:half]"),
            ),
        ),
        (
            "gap-2-linear",
            "Y one early",
            r"`theta_arx` has y\(k-1\) on the left-hand side",
            (("y[2:half]", "y[1 : half - 1]"),),
        ),
        (
            "gap-2-linear",
            "Y with its offset",
            "the output with its offset on the left-hand side",
            (("y[2:half]", "y_act[2:half]"),),
        ),
        (
            "gap-3-time",
            "shares",
            "holds shares",
            (("(i * N // 16 * Ts, (i + 1) * N // 16 * Ts)", "share_t[i], share_t[i + 1]"),),
        ),
        (
            "gap-3-time",
            "argmax of the error",
            "take `np.argmax` of the shares",
            (("np.argmax(share_t)", "np.argmax(e)"),),
        ),
        (
            "gap-4-frequency",
            "both whole",
            "",
            (("np.fft.rfft(e)", "np.fft.fft(e)"), ("np.fft.rfftfreq", "np.fft.fftfreq")),
        ),
        ("gap-8-effect", "two effects", "names 2 effects", "effect = 'input-delay and output-saturation'"),
    ),
}
"""By assignment."""
