"""First tries with a wrong result, and right answers in an unusual way: step responses, several signals, the gap."""

from tries import Try
from tries.rows_of_tries import TO_Y, in_rows

_END = r"from the \*end\* of the record"

TRIES: dict[str, tuple[Try, ...]] = {
    "several-signals": in_rows(
        ("sev-3-phi", "Y too early", f"{TO_Y} Y: it is 2 samples early", (("y[n:, i]", "y[: N - n, i]"),)),
        ("sev-3-phi", "Y of the input", f"{TO_Y} Y: it holds the input", (("y[n:, i]", "u[n:, i]"),)),
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
    "step-response": in_rows(
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
            r"not zero\. Print the determinant .* taken twice",
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
            "should have 5 elements; it has 10",
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
    "sim-to-real-gap": in_rows(
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
