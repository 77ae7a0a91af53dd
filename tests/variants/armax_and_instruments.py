"""Answers to the lecture on ARMAX and instruments that differ from the model solution, right ones and wrong ones."""

from variants import Right, Wrong, define, right, wrong

TABLES, BIAS, LIMIT, COVARIANCE = "ai-1-tables", "ai-2-bias", "ai-3-limit", "ai-4-covariance"
ARMAX, RELS, FIGURE = "ai-5-armax", "ai-6-rels", "ai-6-figure-14"
ITERATED, RECURSIVE, LIKELIHOOD = "ai-7-iterated", "ai-8-recursive", "ai-9-likelihood"


def tables(
    theta: str = "np.linalg.lstsq(Phi, Y)[0]",
    columns: str = "-y[:-1], u[:-1]",
    used: str = "fit_arx(*make_record(rng, 1000, -0.8, 1, c)[:2])",
    before: str = "rng = np.random.default_rng(17)\n",
    runs: int = 120,
    cs: str = "0, -0.8",
    after: str = "",
) -> str:
    body = f"Phi, Y = np.column_stack([{columns}]), y[1:]\nreturn {theta}"
    return (
        define("fit_arx(u, y)", body)
        + before
        + f"estimates_1, estimates_2 = ([{used} for i in range({runs})] for c in ({cs}))\n"
        + "estimates_1, estimates_2 = np.array(estimates_1), np.array(estimates_2)\n"
        + after
    )


PRINTED_LOOP = (
    "phi = np.zeros((len(y), 2))\nfor i in range(1, len(y)):\n    phi[i] = -y[i - 1], u[i - 1]\n"
    "return np.linalg.solve(phi.T @ phi, phi.T @ y)"
)
KEPT_INPUT = (
    "u = np.random.default_rng(3).uniform(-2, 2, 1000)\nestimates_1, estimates_2 = [], []\nfor seed in range(300):\n"
    "    for c, list_ in ((0, estimates_1), (-0.8, estimates_2)):\n"
    "        _, y, _ = make_record(np.random.default_rng(seed), 1000, -0.8, 1, c, u)\n"
    "        list_.append(fit_arx(u, y))\n"
)


def bias(
    bias: str = "estimates.mean(axis=0) - truth",
    spread: str = "estimates.std(axis=0, ddof=1)",
    stderr: str = "spread / len(estimates) ** 0.5",
    result: str = "bias, spread, stderr",
) -> str:
    return define("bias_of(estimates, truth)", f"bias = {bias}\nspread = {spread}\nstderr = {stderr}\nreturn {result}")


def limit(
    var_y: str = "(b**2 * var_u + (1 + c**2 - 2 * a * c) * var_e) / (1 - a**2)",
    result: str = "a - c * var_e / var_y, b",
) -> str:
    return define("limit_of_least_squares(a, b, c, var_u, var_e)", f"var_y = {var_y}\nreturn np.array([{result}])")


LIMIT_BY_IMPULSES = define(
    "limit_of_least_squares(a, b, c, var_u, var_e)",
    "one = np.r_[1.0, np.zeros(2000)]\ng = scipy.signal.lfilter([0, b], [1, a], one)\n"
    "h = scipy.signal.lfilter([1, c], [1, a], one)\n"
    "var_y, next_y = (var_u * g[k:] @ g[: 2001 - k] + var_e * h[k:] @ h[: 2001 - k] for k in (0, 1))\n"
    "return -next_y / var_y, b",
)


def covariance(
    R: str = "(1 + c**2) * np.eye(N) + c * (np.eye(N, k=1) + np.eye(N, k=-1))",
    result: str = "var_e * L @ R @ L.T",
) -> str:
    return define("covariance(Phi, c, var_e)", f"N = len(Phi)\nL = np.linalg.pinv(Phi)\nR = {R}\nreturn {result}")


def armax(
    errors: str = "scipy.signal.lfilter([1], [1, c], np.r_[0, y[1:] + a * y[:-1] - b * u[:-1]])",
    columns: str = "-y[:-1], u[:-1], e[:-1]",
    start: str = "np.r_[np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1]]), y[1:])[0], 0]",
    step: str = "theta + share * (new - theta)",
    rounds: str = "rounds",
    made_with: str = "theta",
    result: str = "theta",
) -> str:
    return define("prediction_errors(theta, u, y)", f"a, b, c = theta\nreturn {errors}") + define(
        "pseudo_linear(u, y, share, rounds)",
        f"first = theta = {start}\nfor i in range({rounds}):\n    e = prediction_errors({made_with}, u, y)\n"
        f"    new = np.linalg.lstsq(np.column_stack([{columns}]), y[1:])[0]\n    theta = {step}\nreturn {result}",
    )


ARMAX_IN_LOOPS = define(
    "prediction_errors(theta, u, y)",
    "a, b, c = theta\ne = [0.0]\nfor t in range(1, len(y)):\n"
    "    e.append(y[t] - (-a * y[t - 1] + b * u[t - 1] + c * e[-1]))\nreturn np.array(e)",
) + define(
    "pseudo_linear(u, y, share, rounds)",
    "rows = range(2, len(y))\nP = np.array([[-y[t - 1], u[t - 1]] for t in rows])\nY = y[2:]\n"
    "theta = np.array([*np.linalg.solve(P.T @ P, P.T @ Y), 0])\nwhile rounds > 0:\n"
    "    e = prediction_errors(theta, u, y)\n    Q = np.array([[-y[t - 1], u[t - 1], e[t - 1]] for t in rows])\n"
    "    theta = (1 - share) * theta + share * np.linalg.inv(Q.T @ Q) @ Q.T @ Y\n    rounds -= 1\n"
    "return theta[:, None]",
)


def rels(
    phi: str = "-y[n - 1], u[n - 1], e",
    P: str = "(P - np.outer(P @ phi, phi @ P) / (forgetting + phi @ P @ phi)) / forgetting",
    start: str = "LN * np.eye(3)",
    before: str = "e = y[n] - phi @ theta",
    K: str = "P @ phi",
    after: str = "pass",
    result: str = "H",
    first: int = 1,
    used: str = "theta_rels = rels(u_71, y_71, 1.0, 1e6)\n",
) -> str:
    return (
        define(
            "rels(u, y, forgetting, LN)",
            f"theta, P, e = np.zeros(3), {start}, 0.0\nH = np.zeros((len(y), 3))\n"
            f"for n in range({first}, len(y)):\n    phi = np.array([{phi}])\n    {before}\n    P = {P}\n"
            f"    theta = theta + {K} * e\n    H[n] = theta\n    {after}\nreturn {result}",
        )
        + used
    )


RELS_WITH_THE_GAIN_FIRST = (
    define(
        "rels(u, y, forgetting, LN)",
        "theta, P = np.zeros((3, 1)), LN * np.eye(3)\nH, past = [theta.ravel()], [0, 0, 0]\nfor n in range(len(y)):\n"
        "    if n > 0:\n        phi = np.array([[-past[0]], [past[1]], [past[2]]])\n"
        "        e = (y[n] - phi.T @ theta).item()\n        K = P @ phi / (forgetting + phi.T @ P @ phi)\n"
        "        theta = theta + K * e\n        P = (P - K @ phi.T @ P) / forgetting\n        H.append(theta.ravel())\n"
        "    past = [y[n], u[n], e if n else 0]\nreturn H",
    )
    + "theta_rels = np.array(rels(u_71, y_71, 1.0, 1e6))\n"
)


def figure(curves: str = "ax.plot(theta_rels)", legend: str = "ax.legend(['a', 'b', 'c'])", rest: str = "") -> str:
    return f"fig_14, ax = plt.subplots()\n{curves}\n{legend}\nax.set_ylim(-2, 2)\n" + (rest or "ax.set_xlabel('n')\n")


def iterated(
    y_M: str = "scipy.signal.lfilter([0, b], [1, a], u)",
    theta: str = "np.linalg.solve(Z.T @ Phi, Z.T @ y[1:])",
    model: str = "theta",
    rounds: str = "rounds",
    result: str = "theta",
) -> str:
    return define(
        "iterated_iv(u, y, rounds)",
        "Phi = np.column_stack([-y[:-1], u[:-1]])\nfirst = theta = np.linalg.lstsq(Phi, y[1:])[0]\n"
        f"for i in range({rounds}):\n    a, b = {model}\n    y_M = {y_M}\n"
        f"    Z = np.column_stack([-y_M[:-1], u[:-1]])\n    theta = {theta}\nreturn {result}",
    )


ITERATED_WITH_SUMS = define(
    "iterated_iv(u, y, rounds)",
    "def solve(x):\n    A, B = np.zeros((2, 2)), np.zeros(2)\n    for t in range(2, len(y)):\n"
    "        z, phi = np.array([-x[t - 1], u[t - 1]]), np.array([-y[t - 1], u[t - 1]])\n"
    "        A, B = A + np.outer(z, phi), B + z * y[t]\n    return np.linalg.inv(A) @ B\ntheta = solve(y)\n"
    "for _ in range(rounds):\n    x = [0.0]\n    for t in range(1, len(y)):\n"
    "        x.append(-theta[0] * x[-1] + theta[1] * u[t - 1])\n    theta = solve(x)\nreturn list(theta)",
)


def recursive(update: str, result: str = "history") -> str:
    return define(
        "recursive_iv(u, y, warm_up)",
        "theta, P = np.zeros(2), 1e6 * np.eye(2)\nstable = np.zeros(2)\nphi, z_model = np.zeros(2), np.zeros(2)\n"
        "history = np.zeros((len(y), 2))\nfor n in range(len(y)):\n    z = phi if n < warm_up else z_model\n"
        + "".join(f"    {line}\n" for line in update.splitlines())
        + "    history[n] = theta\n    if abs(theta[0]) < 1:\n        stable = theta.copy()\n"
        "    y_M = z_model @ stable\n    phi, z_model = np.array([-y[n], u[n]]), np.array([-y_M, u[n]])\n"
        f"return {result}",
    )


def update(
    error: str = "y[n] - phi @ theta",
    P: str = "P - np.outer(P @ z, phi @ P) / (1 + phi @ P @ z)",
    K: str = "P @ z",
    theta: str = "theta + K * e",
) -> str:
    return f"e = {error}\nold = P\nP = {P}\nK = {K}\ntheta = {theta}"


def likelihood(result: str, before: str = "") -> str:
    return define("log_likelihood(theta, var_e, Phi, Y)", f"E = Y - Phi @ theta\nN = len(Y)\n{before}return {result}")


VARIANTS: list[Right | Wrong] = [
    # 1. Tables 2 and 3
    right(TABLES, "the printed loop, from the first row", tables() + define("fit_arx(u, y)", PRINTED_LOOP)),
    right(TABLES, "one input for all, a seed for each, lists", define("fit_arx(u, y)", PRINTED_LOOP) + KEPT_INPUT),
    right(
        TABLES,
        "another first row, theta as a column in between",
        tables("np.linalg.pinv(Phi[1:]) @ Y[1:, None]", used="fit_arx(*make_record(rng, 1000, -0.8, 1, c)[:2])[:, 0]"),
    ),
    wrong(TABLES, "as printed, [-a, b]", tables(columns="y[:-1], u[:-1]"), "sign of a", "other sign"),
    wrong(TABLES, "u(t)", tables(columns="-y[:-1], u[1:]"), "lag off by one", "u\\(t-1\\)"),
    wrong(TABLES, "b before a", tables(columns="u[:-1], -y[:-1]"), "a and b swapped", "before"),
    wrong(TABLES, "no inverse", tables("Phi.T @ Y"), "inverse forgotten", "inverse"),
    wrong(
        TABLES,
        "generator in the loop",
        tables(used="fit_arx(*make_record(np.random.default_rng(5), 1000, -0.8, 1, c)[:2])"),
        "same noise in every record",
        "own noise",
    ),
    wrong(TABLES, "twenty records", tables(runs=20), "too few records", "at least 100"),
    wrong(TABLES, "systems swapped", tables(cs="-0.8, 0"), "systems swapped", "System 1"),
    wrong(TABLES, "c with the other sign", tables(cs="0, 0.8"), "sign of c", "sign of c"),
    wrong(
        TABLES,
        "long records",
        tables(used="fit_arx(*make_record(rng, 4000, -0.8, 1, c)[:2])"),
        "records of another length",
        "1000 samples",
    ),
    wrong(
        TABLES,
        "rows for columns",
        tables(after="estimates_1 = estimates_1.T\n"),
        "rows instead of columns",
        "transpose it",
    ),
    # 2. bias and its standard error
    right(
        BIAS,
        "by hand",
        bias(
            "sum(estimates) / len(estimates) - truth", "np.sqrt(sum((estimates - estimates.mean(0)) ** 2) / (M - 1))"
        ).replace("    bias =", "    M = len(estimates)\n    bias ="),
    ),
    wrong(BIAS, "without ddof", bias(spread="np.std(estimates, axis=0)"), "divided by M", "M - 1"),
    right(
        BIAS,
        "one array of three rows",
        bias(
            stderr="np.std(estimates, axis=0) / np.sqrt(len(estimates) - 1)", result="np.array([bias, spread, stderr])"
        ),
    ),
    wrong(BIAS, "sign", bias("truth - estimates.mean(axis=0)"), "sign of the bias", "mean less truth"),
    wrong(BIAS, "mean alone", bias("estimates.mean(axis=0)"), "truth not subtracted", "truth"),
    wrong(BIAS, "absolute", bias("abs(estimates - truth).mean(axis=0)"), "absolute errors", "cancel"),
    wrong(BIAS, "variance", bias(spread="estimates.var(axis=0, ddof=1)"), "variance for spread", "root"),
    wrong(
        BIAS,
        "about the truth",
        bias(spread="np.sqrt(np.mean((estimates - truth) ** 2, axis=0))"),
        "spread about the truth",
        "about the mean",
    ),
    wrong(BIAS, "no root of M", bias(stderr="spread"), "spread for standard error", "root of M"),
    wrong(BIAS, "divided by M", bias(stderr="spread / len(estimates)"), "divided by M", "Variances add"),
    wrong(
        BIAS, "number of parameters", bias(stderr="spread / len(truth) ** 0.5"), "number of parameters for M", "rows"
    ),
    wrong(BIAS, "over all", bias("np.mean(estimates - truth)"), "mean over everything", "axis=0"),
    wrong(BIAS, "along the rows", bias(spread="estimates.std(axis=1)"), "mean over the wrong axis", "axis=0"),
    wrong(BIAS, "two parts", bias(result="bias, stderr"), "incomplete result", "three vectors"),
    # 3. the limit
    right(LIMIT, "from the autocovariances", LIMIT_BY_IMPULSES),
    right(
        LIMIT,
        "normal equations in expectation",
        limit(result="*np.array([a, b]) + np.linalg.solve(np.diag([var_y, var_u]), [-c * var_e, 0])"),
    ),
    wrong(LIMIT, "wrong way", limit(result="a + c * var_e / var_y, b"), "sign of the pull", "wrong way"),
    wrong(LIMIT, "no bias", limit(result="a, b"), "no bias", "true values"),
    wrong(LIMIT, "the bias alone", limit(result="-c * var_e / var_y, 0"), "bias alone", "Add it"),
    wrong(
        LIMIT, "no cross term", limit("(b**2 * var_u + (1 + c**2) * var_e) / (1 - a**2)"), "cross term", "correlated"
    ),
    wrong(
        LIMIT,
        "sign of the cross term",
        limit("(b**2 * var_u + (1 + c**2 + 2 * a * c) * var_e) / (1 - a**2)"),
        "cross term",
        "-2ac",
    ),
    wrong(LIMIT, "no var_e", limit(result="a - c / var_y, b"), "var_e forgotten", "variance of e"),
    wrong(
        LIMIT,
        "1 - a^2",
        limit("b**2 * var_u + (1 + c**2 - 2 * a * c) * var_e"),
        "1 - a^2 forgotten",
        "contains a\\^2",
    ),
    wrong(LIMIT, "noise-free", limit("b**2 * var_u / (1 - a**2)"), "variance without noise", "noisy one"),
    wrong(LIMIT, "two times c", limit(result="a - 2 * c * var_e / var_y, b"), "c doubled", "twice as far"),
    # 4. covariance in coloured noise
    right(
        COVARIANCE,
        "toeplitz",
        covariance("scipy.linalg.toeplitz(np.r_[1 + c**2, c, np.zeros(N - 2)])").replace(
            "    N =", "    import scipy.linalg\n    N =", 1
        ),
    ),
    right(
        COVARIANCE,
        "through the filter matrix",
        covariance("np.eye(N, N + 1, k=1) + c * np.eye(N, N + 1)", "np.round(var_e * (L @ R) @ (L @ R).T, 12)"),
    ),
    wrong(
        COVARIANCE,
        "as for white noise",
        covariance(result="var_e * np.linalg.inv(Phi.T @ Phi)"),
        "as if white",
        "for white noise",
    ),
    wrong(
        COVARIANCE,
        "Lemma 1 with the variance of v",
        covariance(result="var_e * (1 + c**2) * np.linalg.inv(Phi.T @ Phi)"),
        "as if white",
        "neighbouring",
    ),
    wrong(
        COVARIANCE,
        "1 on the diagonal",
        covariance("np.eye(N) + c * (np.eye(N, k=1) + np.eye(N, k=-1))"),
        "diagonal of white noise",
        "1 \\+ c\\^2",
    ),
    wrong(
        COVARIANCE,
        "above only",
        covariance("(1 + c**2) * np.eye(N) + c * np.eye(N, k=1)"),
        "c on one side only",
        "symmetric",
    ),
    wrong(
        COVARIANCE,
        "c squared",
        covariance("(1 + c**2) * np.eye(N) + c**2 * (np.eye(N, k=1) + np.eye(N, k=-1))"),
        "c squared beside the diagonal",
        "share",
    ),
    wrong(
        COVARIANCE,
        "from rest",
        covariance("(np.eye(N) + c * np.eye(N, k=-1)) @ (np.eye(N) + c * np.eye(N, k=1))"),
        "first sample without a past",
        "like every other",
    ),
    wrong(COVARIANCE, "no var_e", covariance(result="L @ R @ L.T"), "var_e forgotten", "var_e"),
    wrong(COVARIANCE, "squared", covariance(result="var_e**2 * L @ R @ L.T"), "var_e squared", "already"),
    wrong(COVARIANCE, "diagonal", covariance(result="np.diag(var_e * L @ R @ L.T)"), "variances only", "matrix"),
    wrong(COVARIANCE, "of the noise", covariance(result="var_e * R"), "covariance of the noise", "p by p"),
    # 5. pseudo-linear regression
    right(ARMAX, "loops, another first row, a column", ARMAX_IN_LOOPS),
    right(
        ARMAX,
        "a weighted mean of old and new, a list",
        armax(step="(1 - share) * theta + share * new", result="list(theta)"),
    ),
    right(
        ARMAX,
        "errors by the impulse response of 1/C",
        armax("np.convolve(np.r_[0, y[1:] + a * y[:-1] - b * u[:-1]], (-c) ** np.arange(len(y)))[: len(y)]"),
    ),
    wrong(
        ARMAX,
        "c left out",
        armax("np.r_[0, y[1:] + a * y[:-1] - b * u[:-1]]"),
        "noise term left out",
        "ARX",
    ),
    wrong(ARMAX, "sign of c", armax().replace("[1, c]", "[1, -c]"), "sign of c", "sign of c"),
    wrong(ARMAX, "sign of a", armax().replace("+ a * y", "- a * y"), "sign of a", "sign of a"),
    wrong(ARMAX, "u(t)", armax().replace("b * u[:-1]", "b * u[1:]"), "lag off by one", "u\\(t-1\\)"),
    wrong(
        ARMAX,
        "simulated",
        armax("y - scipy.signal.lfilter([0, b], [1, a], u)"),
        "simulation for prediction",
        "measured",
    ),
    wrong(
        ARMAX,
        "one sample short",
        armax().replace("np.r_[0, y[1:]", "(y[1:]").replace("* u[:-1]])", "* u[:-1]))"),
        "first sample left out",
        "one sample less",
    ),
    wrong(
        ARMAX,
        "prediction",
        armax("y - scipy.signal.lfilter([1], [1, c], np.r_[0, y[1:] + a * y[:-1] - b * u[:-1]])"),
        "prediction for its error",
        "Take it off",
    ),
    wrong(ARMAX, "whole step", armax(step="new"), "share not used", "whole way"),
    wrong(ARMAX, "errors kept", armax(made_with="first"), "errors not renewed", "latest theta"),
    wrong(ARMAX, "one round more", armax(rounds="rounds + 1"), "rounds miscounted", "number of rounds"),
    wrong(ARMAX, "a, c, b", armax(result="theta[[0, 2, 1]]"), "order of theta", "another order"),
    wrong(ARMAX, "start of two", armax(result="theta if rounds else theta[:2]"), "start without a third", "c = 0"),
    wrong(ARMAX, "epsilon(t)", armax(columns="-y[:-1], u[:-1], e[1:]"), "lag off by one", "own sample"),
    # 6. RELS
    right(RELS, "the gain first, columns, a list", RELS_WITH_THE_GAIN_FIRST),
    right(RELS, "from sample 0, with zeros before", rels("-y[n - 1] if n else 0, u[n - 1] if n else 0, e", first=0)),
    right(RELS, "information matrix", rels(P="np.linalg.inv(forgetting * np.linalg.inv(P) + np.outer(phi, phi))")),
    wrong(
        RELS,
        "errors after the update",
        rels(after="e = y[n] - phi @ theta"),
        "errors after the update",
        "left after the update",
    ),
    wrong(RELS, "no errors", rels("-y[n - 1], u[n - 1], 0"), "noise term left out", "third place"),
    wrong(
        RELS,
        "no forgetting",
        rels(P="P - np.outer(P @ phi, phi @ P) / (1 + phi @ P @ phi)"),
        "forgetting not used",
        "forget",
    ),
    wrong(RELS, "own LN", rels(start="1e6 * np.eye(3)"), "LN not used", "LN times"),
    wrong(RELS, "sign of a", rels("y[n - 1], u[n - 1], e"), "sign of a", "-y\\(n-1\\)"),
    wrong(RELS, "sign of c", rels("-y[n - 1], u[n - 1], -e"), "sign of c", "sign of c"),
    wrong(RELS, "u(n)", rels("-y[n - 1], u[n], e"), "lag off by one", "u\\(n-1\\)"),
    wrong(RELS, "last estimate", rels(result="theta"), "only the last estimate", "whole history"),
    wrong(RELS, "rows for columns", rels(result="H.T"), "rows instead of columns", "transpose it"),
    wrong(RELS, "from sample 1", rels(result="H[1:]"), "first row left out", "one row less"),
    wrong(
        RELS,
        "not divided by lambda",
        rels(P="P - np.outer(P @ phi, phi @ P) / (forgetting + phi @ P @ phi)"),
        "not divided by lambda",
        "does not divide P by lambda",
    ),
    wrong(
        RELS,
        "1 in the denominator",
        rels(P="(P - np.outer(P @ phi, phi @ P) / (1 + phi @ P @ phi)) / forgetting"),
        "1 in the denominator",
        "the 1 becomes lambda",
    ),
    wrong(
        RELS,
        "gain from the old P",
        rels(before="e = y[n] - phi @ theta\n    old = P", K="old @ phi"),
        "gain from the old P",
        "P before the sample|row",
    ),
    wrong(
        RELS,
        "divided by lambda twice",
        rels(P="(P - np.outer(P @ phi, phi @ P) / (forgetting + phi @ P @ phi)) / forgetting**2"),
        "divided by lambda twice",
        "lambda squared",
    ),
    wrong(RELS, "used on other data", rels(used="theta_rels = rels(u_2, y_2, 1.0, 1e6)\n"), None, "theta_rels"),
    # 6. Fig. 14
    right(
        FIGURE,
        "three calls, against t",
        figure(
            "for i, name in enumerate('abc'):\n    plt.plot(t + 1, theta_rels[:, i], label=f'$\\\\hat{{{name}}}$')\n"
            "    plt.axhline([-0.9, 1, 0.3][i])",
            "plt.legend()",
            "plt.xlabel('t')\n",
        ),
    ),
    right(FIGURE, "one call, names with numbers", figure(legend="ax.legend(['a (-0.9)', 'b (1.0)', 'c (0.3)'])")),
    wrong(FIGURE, "c missing", figure("ax.plot(theta_rels[:, :2])", "ax.legend(['a', 'b'])"), "no curve", "shows c"),
    wrong(FIGURE, "rows", figure("ax.plot(theta_rels.T)"), "rows drawn", "each column is a curve"),
    wrong(FIGURE, "no legend", figure(legend=""), "no legend", "legend"),
    wrong(FIGURE, "no label", figure(rest="pass\n"), "axis without a label", "xlabel"),
    wrong(FIGURE, "names swapped", figure(legend="ax.legend(['b', 'a', 'c'])"), "legend entries swapped", "swapped"),
    wrong(FIGURE, "empty", figure("", ""), "empty axes", "empty"),
    # 7. iterated instrumental variables
    right(ITERATED, "sums over the samples, a list", ITERATED_WITH_SUMS),
    right(ITERATED, "inverse", iterated(theta="np.linalg.inv(Z.T @ Phi) @ (Z.T @ y[1:])", result="theta[:, None]")),
    # y_M(t) in the place of y_M(t-1) is -a y_M(t-1) + b u(t-1): the same instruments in another basis.
    right(ITERATED, "simulated without the delay", iterated("scipy.signal.lfilter([b], [1, a], u)")),
    wrong(ITERATED, "measured output", iterated("y"), "least squares", "least squares again"),
    wrong(
        ITERATED,
        "Phi and Z exchanged",
        iterated(theta="np.linalg.solve(Phi.T @ Z, Phi.T @ y[1:])"),
        "Phi and Z exchanged",
        "has Phi and Z exchanged",
    ),
    wrong(
        ITERATED,
        "older outputs",
        iterated("np.r_[0, y[:-1]]"),
        "instrument of old outputs",
        "older measured output",
    ),
    wrong(
        ITERATED,
        "from zero",
        iterated().replace("first = theta = np.linalg.lstsq(Phi, y[1:])[0]", "first = theta = np.zeros(2)"),
        "start from zero",
        "begins with theta = 0",
    ),
    wrong(
        ITERATED,
        "one-step prediction",
        iterated("np.r_[0, -a * y[:-1] + b * u[:-1]]"),
        "predicted, not simulated",
        "own last output",
    ),
    wrong(ITERATED, "first model", iterated(model="first"), "instrument not renewed", "latest"),
    wrong(
        ITERATED,
        "regressed on Z",
        iterated(theta="np.linalg.lstsq(Z, y[1:])[0]"),
        "regressed on the instrument",
        "instead of Phi",
    ),
    wrong(
        ITERATED,
        "Phi'Z",
        iterated(theta="np.linalg.solve(Phi.T @ Z, Z.T @ y[1:])"),
        "Phi'Z for Z'Phi",
        "transpose",
    ),
    wrong(ITERATED, "sign of a", iterated(result="theta * [-1, 1]"), "sign of a", "sign of a"),
    wrong(ITERATED, "swapped", iterated(result="theta[::-1]"), "a and b swapped", "before"),
    wrong(ITERATED, "one round more", iterated(rounds="rounds + 1"), "rounds miscounted", "1 round in place of 0"),
    # 8. recursive instrumental variables
    right(
        RECURSIVE,
        "the gain first",
        recursive(
            "K = P @ z / (1 + phi @ P @ z)\ntheta = theta + K * (y[n] - phi @ theta)\nP = P - np.outer(K, phi @ P)"
        ),
    ),
    right(
        RECURSIVE,
        "columns and rows",
        recursive(
            "f, w = phi.reshape(2, 1), z.reshape(2, 1)\nP = P - P @ w @ f.T @ P / (1 + f.T @ P @ w)\n"
            "theta = theta + (P @ w * (y[n] - f.T @ theta)).ravel()"
        ),
    ),
    wrong(
        RECURSIVE,
        "z twice",
        recursive(update(P="P - np.outer(P @ z, z @ P) / (1 + z @ P @ z)")),
        "z z' for z phi'",
        "z twice",
    ),
    wrong(RECURSIVE, "gain with phi", recursive(update(K="P @ phi")), "phi for z in the gain", "K = P z"),
    wrong(
        RECURSIVE,
        "RLS",
        recursive(update(P="P - np.outer(P @ phi, phi @ P) / (1 + phi @ P @ phi)", K="P @ phi")),
        "phi throughout",
        "never uses z",
    ),
    wrong(RECURSIVE, "predicted with z", recursive(update("y[n] - z @ theta")), "z for phi in the error", "phi'theta"),
    wrong(
        RECURSIVE,
        "transposed",
        recursive(update(P="P - np.outer(P @ phi, z @ P) / (1 + phi @ P @ z)")),
        "transposed",
        "exchanged",
    ),
    wrong(RECURSIVE, "old P", recursive(update(K="old @ z")), "gain from the P before", "before its update"),
    wrong(
        RECURSIVE,
        "transposed throughout",
        recursive(update(P="P - np.outer(P @ phi, z @ P) / (1 + z @ P @ phi)")),
        "transposed",
        "not symmetric",
    ),
    wrong(RECURSIVE, "P kept", recursive(update(P="P")), "estimate runs away", "grows without limit"),
    wrong(
        RECURSIVE,
        "a warm-up of its own",
        recursive(update()).replace("if n < warm_up", "if n < 20"),
        "warm-up not used",
        "use the argument `warm_up`",
    ),
    wrong(RECURSIVE, "minus", recursive(update(theta="theta - K * e")), "sign of the update", "Add it"),
    wrong(RECURSIVE, "nothing", recursive("pass"), "theta not updated", "never moves"),
    wrong(RECURSIVE, "last estimate", recursive(update(), "theta"), "only the last estimate", "whole history"),
    # 9. likelihood
    right(
        LIKELIHOOD,
        "densities, one by one",
        likelihood("sum(np.log(np.exp(-e**2 / (2 * var_e)) / np.sqrt(2 * np.pi * var_e)) for e in E)"),
    ),
    right(
        LIKELIHOOD,
        "scipy's density",
        likelihood("norm.logpdf(E, scale=np.sqrt(var_e)).sum()", "from scipy.stats import norm\n"),
    ),
    *(
        wrong(LIKELIHOOD, name, likelihood(f"-N / 2 * np.log({inside}) - E @ E / {below}"), slip, says)
        for name, inside, below, slip, says in (
            ("sigma", "2 * np.pi * var_e", "(2 * var_e**0.5)", "sigma for sigma^2", "2 sigma\\."),
            ("sigma^4", "2 * np.pi * var_e", "(2 * var_e**2)", "var_e squared", "2 sigma\\^4"),
        )
    ),
    wrong(
        LIKELIHOOD,
        "log10",
        likelihood("-N / 2 * np.log10(2 * np.pi * var_e) - E @ E / (2 * var_e)"),
        "logarithm to base 10",
        "base 10",
    ),
    wrong(
        LIKELIHOOD,
        "N - p",
        likelihood("-(N - len(theta)) / 2 * np.log(2 * np.pi * var_e) - E @ E / (2 * var_e)"),
        "N - p for N",
        "N - p",
    ),
    wrong(
        LIKELIHOOD,
        "as printed",
        likelihood("-N / 2 * np.log(2 * np.pi * np.sqrt(var_e)) - E @ E / (2 * var_e)"),
        "printed density",
        "outside the root",
    ),
    wrong(LIKELIHOOD, "sign", likelihood("N / 2 * np.log(2 * np.pi * var_e) + E @ E / (2 * var_e)"), "sign", "sign"),
    wrong(
        LIKELIHOOD,
        "no logarithm",
        likelihood("np.prod(np.exp(-E**2 / (2 * var_e)) / np.sqrt(2 * np.pi * var_e))"),
        "likelihood without its logarithm",
        "logarithm",
    ),
    wrong(
        LIKELIHOOD,
        "no half",
        likelihood("-N * np.log(2 * np.pi * var_e) - E @ E / (2 * var_e)"),
        "half forgotten",
        "half",
    ),
    wrong(
        LIKELIHOOD,
        "no half below",
        likelihood("-N / 2 * np.log(2 * np.pi * var_e) - E @ E / var_e"),
        "half forgotten",
        "twice",
    ),
    wrong(LIKELIHOOD, "no constant", likelihood("-E @ E / (2 * var_e)"), "constant left out", "infinite"),
    wrong(LIKELIHOOD, "no 2 pi", likelihood("-N / 2 * np.log(var_e) - E @ E / (2 * var_e)"), "2 pi left out", "2 pi"),
    wrong(
        LIKELIHOOD,
        "var_e taken for sigma",
        likelihood("-N / 2 * np.log(2 * np.pi * var_e**2) - E @ E / (2 * var_e**2)"),
        "var_e squared",
        "already",
    ),
    wrong(
        LIKELIHOOD,
        "constant once",
        likelihood("-1 / 2 * np.log(2 * np.pi * var_e) - E @ E / (2 * var_e)"),
        "one sample's constant",
        "every sample",
    ),
    wrong(
        LIKELIHOOD,
        "one a sample",
        likelihood("-1 / 2 * np.log(2 * np.pi * var_e) - E**2 / (2 * var_e)"),
        "not added up",
        "add",
    ),
]
