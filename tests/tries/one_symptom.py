"""First tries whose symptom another mistake has, too: the cause is told by what was computed, not by the symptom."""

from tries import TAUGHT, Try, edited


def _noise(drawn: str) -> str:
    """Both sinusoids with that noise."""
    return f"y1 = np.sin(2 * np.pi * t / 100) + {drawn}\ny2 = np.cos(2 * np.pi * t / 100) + {drawn}"


_DRAWN, _SHARED = "rng.uniform(-0.2, 0.2, t.shape)", "first signal, `signals\\[0\\]`"
_LISTS = "with lists, which the notebook hands over as well"

TRIES: dict[str, tuple[Try, ...]] = {
    "prelab-sinusoids": (
        Try("prelab-2-noise", "rounded", _noise(f"np.round({_DRAWN}, 1)"), "on a grid", TAUGHT, "clip"),
        Try("prelab-2-noise", "two digits", _noise(f"np.round({_DRAWN}, 2)"), "only 41 .* on a grid", TAUGHT, "clip"),
        Try(
            "prelab-2-noise", "whole numbers", _noise("rng.integers(-2, 3, t.shape) / 10"), "on a grid", TAUGHT, "clip"
        ),
        Try("prelab-2-noise", "one of two", _noise("rng.choice([-0.2, 0.2], t.shape)"), "only 2 .* -0.2, 0.2", TAUGHT),
        Try(
            "prelab-2-noise",
            "signal rounded",
            f"y1 = np.round(np.sin(2 * np.pi / 100 * t) + {_DRAWN}, 2)\n"
            f"y2 = np.round(np.cos(2 * np.pi / 100 * t) + {_DRAWN}, 2)",
            "`y1` takes few different values, as rounded",
        ),
        Try(
            "prelab-2-noise",
            "each number ten times",
            _noise("np.repeat(rng.uniform(-0.2, 0.2, (101, 1)), 10, axis=0)[:1001]"),
            "only 101 different values|is not random",
            TAUGHT,
            "strongest oscillation",
        ),
        Try(
            "prelab-1-time",
            "a float for the number of points",
            "t = np.linspace(0, 100, 1e3 + 1).reshape(-1, 1)",
            "`1000.0 \\+ 1` is a float",
            TAUGHT,
            "arange",
        ),
        Try(
            "prelab-2-noise",
            "clipped",
            _noise("np.clip(0.2 * rng.standard_normal(t.shape), -0.2, 0.2)"),
            "was clipped",
            TAUGHT,
            "grid",
        ),
        Try(
            "prelab-2-noise",
            "ten numbers repeated",
            _noise("np.resize(rng.uniform(-0.2, 0.2, 10), t.shape)"),
            "only 10 different values.*draw a new number",
            TAUGHT,
            "grid|clip",
        ),
        Try(
            "prelab-4-function",
            "time taken off all columns",
            "def cut_off(data, n):\n    rest = data[n:].copy()\n    return rest - rest[0, 0]\n",
            "from every column",
        ),
        Try(
            "prelab-4-function",
            "first row taken off",
            "def cut_off(data, n):\n    rest = data[n:].copy()\n    return rest - rest[0]\n",
            "starts every column from zero",
            TAUGHT,
            "from every column",
        ),
        Try(
            "prelab-1-time",
            "a quotient for the number of points",
            "t = np.linspace(0, 100, 100 / 0.1 + 1).reshape(-1, 1)",
            r"`round\(100 / 0.1 \+ 1\)` is a whole number",
            TAUGHT,
            "arange",
        ),
        Try(
            "prelab-1-time",
            "the step for the number of points",
            "t = np.linspace(0, 100, 0.1).reshape(-1, 1)",
            r"With a step it is `np.arange",
            TAUGHT,
            "round",
        ),
    ),
    "lab-identification": (
        Try(
            "lab-1a-extract",
            "the input for an output",
            edited("lab-1a-extract", ('["signals"][0]["values"][:, 1]', '["signals"][1]["values"]')),
            r"`y_act` contains `u_act`.*the input, is `signals\[1\]`",
            TAUGHT,
            "column 2",
        ),
        Try(
            "lab-1a-extract",
            "a shape for a signal",
            edited("lab-1a-extract", ('["signals"][1]["values"]', '["signals"][1]["values"].shape[:1]')),
            "which is no sample of this record",
            TAUGHT,
            "one row of the table",
        ),
        Try(
            "lab-1a-extract",
            "the outputs for the input",
            edited(
                "lab-1a-extract", ('u_act = LogData["signals"][1]["values"]', 'u_act = LogData["signals"][0]["values"]')
            ),
            rf"`u_act` contains the two outputs, which are the {_SHARED}",
            TAUGHT,
            "take one",
        ),
    ),
    "postlab-model-order": (
        Try(
            "postlab-2-fit-order",
            "Phi returned beside theta",
            edited("postlab-2-fit-order", ("return np.linalg", "return Phi, np.linalg")).partition("\n\n\n")[0]
            + "\n\n\ntheta_2 = fit_order(u[:half], y[:half], 2)[1]\n",
            "returns 2 things: return theta alone",
            TAUGHT,
            "lstsq",
        ),
        *(
            Try("postlab-2-simulation", name, edited("postlab-2-simulation", change), says, TAUGHT, never)
            for name, change, says, never in (
                (
                    "sign of a2",
                    ("-theta_2[0], -theta_2[1]", "-theta_2[0], theta_2[1]"),
                    "a2 alone of the wrong sign",
                    "a1 alone",
                ),
                (
                    "sign of a1",
                    ("-theta_2[0], -theta_2[1]", "theta_2[0], -theta_2[1]"),
                    "a1 alone of the wrong sign",
                    "a2 alone",
                ),
                ("sign of b2", ("theta_2[2:]", "[theta_2[2], -theta_2[3]]"), "b2 alone of the wrong sign", "a2 alone"),
                (
                    "signs of both a",
                    ("-theta_2[0], -theta_2[1]", "theta_2[0], theta_2[1]"),
                    "wrong sign of a:",
                    "alone",
                ),
                (
                    "a swapped",
                    ("-theta_2[0], -theta_2[1]", "-theta_2[1], -theta_2[0]"),
                    "has a2 in the place of a1",
                    "alone",
                ),
                (
                    "1 last",
                    ("[1, -theta_2[0], -theta_2[1]]", "[-theta_2[0], -theta_2[1], 1]"),
                    "1 stands last",
                    "alone",
                ),
                (
                    "a2 taken twice",
                    ("-theta_2[0], -theta_2[1]", "-theta_2[1], -theta_2[1]"),
                    r"factor of y_sim_2\(k-1\) is -a2 and not -a1",
                    "sign of",
                ),
            )
        ),
    ),
    "step-response": tuple(
        Try(question, name, f"def {head}:\n    return {code}\n", says, TAUGHT, never)
        for question, name, head, code, says, never in (
            (
                "step-9-minimum",
                "one product of three",
                "best_theta(Phi, Y)",
                "np.linalg.inv(Phi.T @ Phi) * Phi.T @ Y",
                "multiplies entry by entry",
                "returned",
            ),
            (
                "step-9-minimum",
                "a minus too many",
                "best_theta(Phi, Y)",
                "np.linalg.inv(Phi.T @ Phi) @ Phi.T @ Y * [1, -1, 1][: Phi.shape[1]]",
                "right but for the sign of",
                "`@`",
            ),
            ("step-8-loss", "the errors", "loss(Phi, Y, theta)", "Y - Phi @ theta", "each equation, the errors", "add"),
        )
    ),
    "recursive-identification": (
        Try(
            "ri-4-regressors",
            "Phi alone, taken apart",
            "def regressors(u, y):\n    Phi = np.column_stack([-y[1:-1], -y[:-2], u[1:-1]])\n    Y = y[2:]\n"
            "    return Phi\n\n\nPhi_61, Y_61 = regressors(u_61, y_61)",
            "`regressors` ends with `return Phi`, which is 1 thing; on the left of `=` stand 2 names",
            TAUGHT,
            "print the right side",
        ),
        Try(
            "ri-4-regressors",
            "three things",
            "def regressors(u, y):\n    Phi = np.column_stack([-y[1:-1], -y[:-2], u[1:-1]])\n    Y = y[2:]\n"
            "    return Phi, Y, 2\n\n\nPhi_61, Y_61 = regressors(u_61, y_61)",
            "`return Phi, Y, 2`, which is 3 things",
        ),
        Try(
            "ri-4-regressors",
            "a call of its own that returns more",
            "def rows(u, y):\n    return np.linalg.lstsq(y[:, None], u)\n\n\nPhi_61, Y_61 = rows(u_61, y_61)",
            "Print what `rows` returns",
            TAUGHT,
            "1 thing",
        ),
    ),
    "model-structures": (
        Try(
            "ms-7-excitation",
            "columns of different lengths",
            "def excitation(u, largest):\n    order = 0\n    for n in range(1, largest + 1):\n"
            "        windows = np.column_stack([u[: len(u) - i] for i in range(n)])\n"
            "        if np.linalg.matrix_rank(windows) < n:\n            break\n        order = n\n    return order",
            "Each column is cut so that this difference is the same\\.",
            TAUGHT,
            "zeros",
        ),
        Try(
            "ms-3-state-space",
            "a list divided",
            edited("ms-3-state-space", ("np.array(den) / den[0]", "list(den) / den[0]")),
            f"{_LISTS}: .*`den` is a list",
        ),
        Try(
            "ms-5-simulate",
            "a list negated",
            "def simulate(A, B, C, u, e):\n    past = -A[1:]\n    x = np.convolve(B, u)[: len(u)] + "
            "np.convolve(C, e)[: len(u)]\n"
            "    return scipy.signal.lfilter([1], np.r_[1, -past], x)\n",
            _LISTS,
        ),
    ),
    "sim-to-real-gap": (
        Try(
            "gap-2-linear",
            "output and input swapped in fit",
            edited("gap-2-linear", ("u[:half], y[:half])", "y[:half], u[:half])")),
            "handed to `fit` in the wrong order",
        ),
        Try(
            "gap-2-linear",
            "fit of the input to itself",
            edited("gap-2-linear", ("u[:half], y[:half])", "u[:half], u[:half])")),
            "not the nearest one",
            TAUGHT,
            "wrong order",
        ),
    ),
    "several-signals": (
        Try(
            "sev-6-reference",
            "lags of different lengths",
            "def fit_with_reference(u, y, r):\n    Phi = np.column_stack([y[1:-1], u[1:-1]])\n"
            "    Z = np.column_stack([r[:-1], r[:-2]])\n    return np.linalg.solve(Z.T @ Phi, Z.T @ y[2:])\n",
            r"lags of 1 and 2 beside `y\[2:\]` are `\[1:-1\]` and",
        ),
    ),
    "nonlinear-least-squares": (
        Try(
            "nl-3-gauss-newton",
            "the last step returned",
            "def gauss_newton(g, jacobian, y, theta0, steps):\n    theta = np.array(theta0, float)\n"
            "    for _ in range(steps):\n        J = jacobian(theta)\n"
            "        step = np.linalg.solve(J.T @ J, J.T @ (y - g(theta)))\n        theta = theta + step\n"
            "    return step\n",
            "one theta, which is not the last",
            TAUGHT,
            "returns the last theta",
        ),
    ),
    "armax-and-instruments": (
        Try(
            "ai-5-armax",
            "last sample cut off",
            edited("ai-5-armax", ("[1, c], w)", "[1, c], w)[:-1]")),
            "the last is missing",
            TAUGHT,
            "begin with",
        ),
        Try(
            "ai-5-armax",
            "first sample cut off",
            edited("ai-5-armax", ("[1, c], w)", "[1, c], w)[1:]")),
            "begin with epsilon",
            TAUGHT,
            "last",
        ),
        Try(
            "ai-6-rels",
            "last row cut off",
            edited("ai-6-rels", ("return history", "return history[:-1]")),
            "the last is missing",
            TAUGHT,
            "row 0",
        ),
    ),
}
