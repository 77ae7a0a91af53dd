"""First tries at the post-lab."""

from tries import Try

PHI, THETA, TF, FIT, RUN, MSE, F8 = (
    "postlab-1-phi", "postlab-1-theta", "postlab-1-transfer-function", "postlab-2-fit-order", "postlab-2-simulation",
    "postlab-3-mse", "postlab-3-figure-8",
)  # fmt: skip


def fit(columns: str, target: str = "y[n:]", end: str = "return np.linalg.lstsq(Phi, Y)[0]") -> str:
    return (
        f"def fit_order(u, y, n):\n    N = len(y)\n    Phi = np.column_stack({columns})\n    Y = "
        f"{target}\n    {end}\n\n\n"
        "theta_2 = fit_order(u[:half], y[:half], 2)"
    )


Y_LAGS = "[y[n - i : N - i] for i in range(1, n + 1)]"
U_LAGS = "[u[n - i : N - i] for i in range(1, n + 1)]"

TRIES = (
    Try(PHI, "hstack", "Phi_1 = np.hstack([y[:half-1], u[:half-1]])\nY_1 = y[1:half]", "end to end"),
    Try(
        PHI,
        "four columns",
        "Phi_1 = np.column_stack([y[1:half-1], y[:half-2], u[1:half-1], u[:half-2]])\nY_1 = y[2:half]",
        "model of order 2",
    ),
    Try(PHI, "all", "Phi_1 = np.column_stack([y[:-1], u[:-1]])\nY_1 = y[1:]", "entire record"),
    Try(PHI, "same time", "Phi_1 = np.column_stack([y[1:half], u[1:half]])\nY_1 = y[1:half]", "one step later"),
    Try(PHI, "unequal", "Phi_1 = np.column_stack([y[:half], u[:half]])\nY_1 = y[1:half]", "one row and"),
    Try(PHI, "minus", "Phi_1 = np.column_stack([-y[:half-1], u[:half-1]])\nY_1 = y[1:half]", "contains -y"),
    Try(THETA, "elementwise", "theta_1 = np.linalg.inv(Phi_1.T * Phi_1) @ Phi_1.T @ Y_1", "which fits"),
    Try(THETA, "all of lstsq", "theta_1 = np.linalg.lstsq(Phi_1, Y_1)", "whole result"),
    Try(
        THETA, "name", "theta_1 = np.linalg.solve(Phi.T @ Phi, Phi.T @ Y)", "There is `Phi_1`|not defined|run the cells"
    ),
    Try(THETA, "swapped", "theta_1 = np.linalg.lstsq(Y_1.reshape(-1, 1), Phi_1)[0]", "swapped"),
    Try(THETA, "inverse forgotten", "theta_1 = Phi_1.T @ Y_1", "inverse"),
    Try(TF, "signs", "G_1 = ct.tf([theta_1[1]], [1, theta_1[0]], Ts)", "signs of theta"),
    Try(TF, "number", "G_1 = ct.tf(theta_1[1], [1, -theta_1[0]], Ts)", "", "acceptable"),
    Try(TF, "no dt", "G_1 = ct.tf([theta_1[1]], [1, -theta_1[0]])", "no sampling time"),
    Try(TF, "1-based", "G_1 = ct.tf([theta_1[2]], [1, -theta_1[1]], Ts)", "indices 0 to 1"),
    Try(TF, "no leading 1", "G_1 = ct.tf([theta_1[1]], [-theta_1[0]], Ts)", "leading 1"),
    Try(
        FIT,
        "lags from 0",
        fit("[y[n - i : N - i] for i in range(n)] + [u[n - i : N - i] for i in range(n)]"),
        "holds y\\(k\\) itself",
    ),
    Try(
        FIT,
        "range(1, n)",
        fit("[y[n - i : N - i] for i in range(1, n)] + [u[n - i : N - i] for i in range(1, n)]"),
        "leaves out n",
    ),
    Try(FIT, "fixed order", fit("[y[1 : N - 1], y[: N - 2], u[1 : N - 1], u[: N - 2]]", "y[2:]"), "it does not use n"),
    Try(FIT, "lists multiplied", fit(f"{Y_LAGS} + {U_LAGS}", "y[n:]", "return np.linalg.lstsq(Phi, Y)"), r"`\[0\]`"),
    Try(FIT, "u first", fit(f"{U_LAGS} + {Y_LAGS}"), "wrong order"),
    Try(
        FIT,
        "half inside",
        fit(f"{Y_LAGS} + {U_LAGS}").replace("N = len(y)", "y, u = y[:half], u[:half]; N = len(y)"),
        "only the first `half`",
    ),
    Try(FIT, "minus", fit("[-y[n - i : N - i] for i in range(1, n + 1)] + " + U_LAGS), "returns \\[a, b\\]"),
    Try(FIT, "constant", fit(f"{Y_LAGS} + {U_LAGS} + [np.ones(N - n)]"), "constant"),
    Try(
        RUN,
        "swapped",
        "y_sim_1 = ct.forced_response(ct.tf(theta_2[2:], [1, -theta_2[0], -theta_2[1]], Ts), inputs=u)"
        ".outputs\ny_sim_2 = ct.forced_response(G_1, inputs=u).outputs",
        "swapped",
    ),
    Try(
        RUN, "half", "y_sim_1 = ct.forced_response(G_1, inputs=u[half:]).outputs\ny_sim_2 = y_sim_1", "second half only"
    ),
    Try(
        RUN,
        "prediction",
        "y_sim_1 = np.r_[0, theta_1[0] * y[:-1] + theta_1[1] * u[:-1]]\ny_sim_2 = y_sim_1",
        "one step ahead",
    ),
    Try(
        RUN,
        "signs",
        "y_sim_1 = scipy.signal.lfilter([0, theta_1[1]], [1, theta_1[0]], u)\ny_sim_2 = y_sim_1",
        "wrong sign of a",
    ),
    Try(RUN, "response", "y_sim_1 = ct.forced_response(G_1, inputs=u)\ny_sim_2 = y_sim_1", "`.outputs`"),
    Try(
        MSE,
        "root",
        "mse_1 = np.sqrt(np.mean((y - y_sim_1)**2))\nmse_2 = np.sqrt(np.mean((y - y_sim_2)**2))",
        "is the root of",
    ),
    Try(MSE, "y_act", "mse_1 = np.mean((y_act - y_sim_1)**2)\nmse_2 = np.mean((y_act - y_sim_2)**2)", "offset"),
    Try(MSE, "swapped", "mse_2 = np.mean((y - y_sim_1)**2)\nmse_1 = np.mean((y - y_sim_2)**2)", "swapped"),
    Try(MSE, "half", "mse_1 = np.mean((y[half:] - y_sim_1[half:])**2)\nmse_2 = 1", "second half only"),
    Try(MSE, "times N", "mse_1 = np.sum((y - y_sim_1)**2)\nmse_2 = 1", "sum"),
    Try(
        F8,
        "no text",
        "fig_8, ax = plt.subplots()\nax.plot(t, y, label='actual')\nax.plot(t, y_sim_1, label='first')\n"
        "ax.plot(t, y_sim_2, label='second')\nax.legend()\nax.set(xlabel='t (s)', ylabel='y (V)')",
        "no text yet",
    ),
    Try(
        F8, "two panels", "fig_8, (a, b) = plt.subplots(2, 1)\na.plot(t, y)\nb.plot(t, y_sim_1)", "1 subplots|1 subplot"
    ),
    Try(
        F8,
        "sample numbers",
        "fig_8, ax = plt.subplots()\nax.plot(y)\nax.plot(y_sim_1)\nax.plot(y_sim_2)",
        "sample number",
    ),
    Try(
        "postlab-1-theta",
        "arguments of solve swapped",
        "theta_1 = np.linalg.solve(Phi_1.T @ Y_1, Phi_1.T @ Phi_1)",
        "the two are swapped",
    ),
    Try("postlab-1-theta", "inverse of a vector", "theta_1 = np.linalg.inv(Phi_1.T @ Y_1)", "is flat", never="swapped"),
    Try(
        "postlab-2-fit-order",
        "half of the notebook",
        "def fit_order(u, y, n):\n"
        "    Phi = np.column_stack([x[n - i : half - i] for x in (y, u) for i in range(1, n + 1)])\n"
        "    return np.linalg.lstsq(Phi, y[n:half])[0]\n",
        r"`half` is 451 \(the notebook's own",
    ),
    Try(
        "postlab-2-fit-order",
        "unequal rows of its own",
        "def fit_order(u, y, n):\n    N = len(y)\n"
        "    Phi = np.column_stack([x[n - i : N - i] for x in (y, u) for i in range(1, n + 1)])\n"
        "    return np.linalg.lstsq(Phi, y)[0]\n",
        "has 59 rows and `y` has 60 entries",
        never="notebook's own",
    ),
    Try(THETA, "swapped", "theta_1 = np.linalg.lstsq(Y_1, Phi_1)[0]", r"`lstsq\(A, b\)` takes the matrix first"),
    Try(TF, "a and b swapped", "G_1 = ct.tf([theta_1[0]], [1, theta_1[1]], Ts)", "a and b are swapped"),
    Try(FIT, "columns added", fit(f"np.array({Y_LAGS}) + np.array({U_LAGS})"), "adds two arrays entry by entry"),
    Try(
        F8,
        "no f",
        "fig_8, ax = plt.subplots()\nax.plot(t, y, label='y')\nax.plot(t, y_sim_1, label='order 1')\n"
        "ax.plot(t, y_sim_2, label='order 2')\nax.set(xlabel='Time (s)', ylabel='Output (V)')\nax.legend()\n"
        "ax.text(0, 0, 'order 1: {mse_1:.3e}, order 2: {mse_2:.3e}')",
        "an `f` before the quotes",
    ),
    Try(THETA, "no transpose", "theta_1 = np.linalg.inv(Phi_1.T @ Phi_1) @ Y_1", "Is `Phi_1.T @` before `Y_1` meant"),
    Try(
        FIT,
        "half of the half",
        "def fit_order(u, y, n):\n    N = len(y) // 2\n"
        f"    Phi = np.column_stack({Y_LAGS} + {U_LAGS})\n    return np.linalg.lstsq(Phi, y[n:N])[0]\n\n\n"
        "theta_2 = fit_order(u[:half], y[:half], 2)",
        "only the first half of what it is given",
    ),
    Try(
        FIT,
        "half of the record",
        "def fit_order(u, y, n):\n    N = min(len(y), half)\n"
        f"    Phi = np.column_stack({Y_LAGS} + {U_LAGS})\n    return np.linalg.lstsq(Phi, y[n:N])[0]\n\n\n"
        "theta_2 = fit_order(u[:half], y[:half], 2)",
        "only the first `half`",
        never="first half of what",
    ),
    Try(
        RUN,
        "first order twice",
        "y_sim_1 = y_sim_2 = ct.forced_response(G_1, inputs=u).outputs",
        "`y_sim_1` again",
    ),
    Try(
        RUN,
        "theta_2 pair by pair",
        "y_sim_1 = ct.forced_response(G_1, inputs=u).outputs\n"
        "y_sim_2 = scipy.signal.lfilter([0, theta_2[1], theta_2[3]], [1, -theta_2[0], -theta_2[2]], u)",
        "for -a1, b1, -a2, b2",
    ),
    Try(
        RUN,
        "b before a",
        "y_sim_1 = ct.forced_response(G_1, inputs=u).outputs\n"
        "y_sim_2 = scipy.signal.lfilter([0, theta_2[0], theta_2[1]], [1, -theta_2[2], -theta_2[3]], u)",
        "for b1, b2, -a1, -a2",
        never="b1, -a2",
    ),
    Try(
        MSE,
        "norm over N",
        "mse_1, mse_2 = (np.linalg.norm(y - s) / len(y) for s in (y_sim_1, y_sim_2))",
        "norm of the error over N",
    ),
    Try(
        F8,
        "numbers of the course's record",
        "fig_8, ax = plt.subplots()\nax.plot(t, y, label='actual')\nax.plot(t, y_sim_1, label='first')\n"
        "ax.plot(t, y_sim_2, label='second')\nax.set(xlabel='Time (s)', ylabel='Output (V)')\nax.legend()\n"
        "ax.text(0, 0, f'order 1: {1.07 * mse_1:.2e}, order 2: {1.07 * mse_2:.2e}')",
        "let the code write the value",
        never="not exact enough",
    ),
    Try(
        F8,
        "two digits",
        "fig_8, ax = plt.subplots()\nax.plot(t, y, label='actual')\nax.plot(t, y_sim_1, label='first')\n"
        "ax.plot(t, y_sim_2, label='second')\nax.set(xlabel='Time (s)', ylabel='Output (V)')\nax.legend()\n"
        "ax.text(0, 0, f'order 1: {mse_1:.0e}, order 2: {mse_2:.0e}')",
        "not exact enough",
        never="let the code",
    ),
    Try(FIT, "past outputs alone", fit(Y_LAGS), "uses past outputs alone"),
    Try(
        RUN,
        "second order twice",
        "G_2 = ct.tf(theta_2[2:], [1, -theta_2[0], -theta_2[1]], Ts)\n"
        "y_sim_1 = y_sim_2 = ct.forced_response(G_2, inputs=u).outputs",
        "run of the second-order model",
    ),
)
