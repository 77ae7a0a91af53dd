"""First tries at the lecture on coloured noise."""

from tries import Try

TAB, BIAS, LIM, COV, ARMAX, RELS, F14, IV, REC, LIK = (
    "ai-1-tables", "ai-2-bias", "ai-3-limit", "ai-4-covariance", "ai-5-armax", "ai-6-rels", "ai-6-figure-14",
    "ai-7-iterated", "ai-8-recursive", "ai-9-likelihood",
)  # fmt: skip


def f(head: str, body: str) -> str:
    return f"def {head}:\n    {body}\n"


def tables(
    fit: str = "np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1]]), y[1:])[0]",
    runs: int = 100,
    c: str = "-0.8",
    inside: str = "",
) -> str:
    return (
        f("fit_arx(u, y)", f"return {fit}")
        + f"\nrng = np.random.default_rng(5)\nestimates_1, estimates_2 = [], []\nfor _ in "
        f"range({runs}):\n    {inside or 'pass'}\n"
        "    estimates_1.append(fit_arx(*make_record(rng, 1000, -0.8, 1.0, 0.0)[:2]))\n"
        f"    estimates_2.append(fit_arx(*make_record(rng, 1000, -0.8, 1.0, {c})[:2]))"
    )


def bias(
    off: str = "np.mean(estimates, axis=0) - truth",
    s: str = "np.std(estimates, axis=0, ddof=1)",
    se: str = "s / np.sqrt(len(estimates))",
) -> str:
    return f("bias_of(estimates, truth)", f"s = {s}\n    return {off}, s, {se}")


def limit(
    var_y: str = "(b**2 * var_u + (1 + c**2 - 2 * a * c) * var_e) / (1 - a**2)", end: str = "[a - c * var_e / var_y, b]"
) -> str:
    return f("limit_of_least_squares(a, b, c, var_u, var_e)", f"var_y = {var_y}\n    return np.array({end})")


def cov(R: str, end: str = "I @ Phi.T @ R @ Phi @ I") -> str:
    return f(
        "covariance(Phi, c, var_e)", f"N = len(Phi)\n    I = np.linalg.inv(Phi.T @ Phi)\n    R = {R}\n    return {end}"
    )


def armax(
    w: str = "y[1:] + a * y[:-1] - b * u[:-1]",
    c: str = "[1, c]",
    third: str = "eps[:-1]",
    move: str = "theta + share * (new - theta)",
) -> str:
    return f(
        "prediction_errors(theta, u, y)",
        f"a, b, c = theta\n    w = np.zeros(len(y))\n    w[1:] = {w}\n    return scipy.signal.lfilter([1], {c}, w)",
    ) + f(
        "pseudo_linear(u, y, share, rounds)",
        "Phi = np.column_stack([-y[:-1], u[:-1]])\n    theta = np.append(np.linalg.lstsq(Phi, "
        "y[1:])[0], 0)\n"
        f"    for _ in range(rounds):\n        eps = prediction_errors(theta, u, y)\n        new = "
        f"np.linalg.lstsq(np.column_stack([Phi, {third}]), y[1:])[0]\n        theta = {move}\n    "
        f"return theta",
    )


def rels(
    P: str = "(P - np.outer(q, q) / (forgetting + phi @ q)) / forgetting",
    phi: str = "-y[n - 1], u[n - 1], eps",
    first: str = "1",
    K: str = "P @ phi",
) -> str:
    return (
        f"def rels(u, y, forgetting, LN):\n    theta, P, eps = np.zeros(3), LN * np.eye(3), 0.0\n  "
        f"  h = np.zeros((len(y), 3))\n    for n in range({first}, len(y)):\n"
        f"        phi = np.array([{phi}])\n        eps = y[n] - phi @ theta\n        q = P @ phi\n "
        f"       P = {P}\n        theta = theta + {K} * eps\n        h[n] = theta\n    return "
        f"h\n\n\n"
        "theta_rels = rels(u_71, y_71, 1.0, 1e6)"
    )


def iv(
    y_M: str = "scipy.signal.lfilter([0, theta[1]], [1, theta[0]], u)",
    solve: str = "np.linalg.solve(Z.T @ Phi, Z.T @ Y)",
) -> str:
    return f(
        "iterated_iv(u, y, rounds)",
        "Phi, Y = np.column_stack([-y[:-1], u[:-1]]), y[1:]\n    theta = np.linalg.lstsq(Phi, "
        "Y)[0]\n    for _ in range(rounds):\n"
        f"        y_M = {y_M}\n        Z = np.column_stack([-y_M[:-1], u[:-1]])\n        theta = "
        f"{solve}\n    return theta",
    )


def recursive(lines: str) -> str:
    return (
        "def recursive_iv(u, y, warm_up):\n    theta, P = np.zeros(2), 1e6 * np.eye(2)\n    "
        "stable = np.zeros(2)\n    phi, z_model = np.zeros(2), np.zeros(2)\n"
        f"    history = np.zeros((len(y), 2))\n    for n in range(len(y)):\n        z = phi if n < "
        f"warm_up else z_model\n        {lines}\n        history[n] = theta\n"
        "        if abs(theta[0]) < 1:\n            stable = theta.copy()\n        y_M = z_model "
        "@ stable\n        phi, z_model = np.array([-y[n], u[n]]), np.array([-y_M, u[n]])\n    "
        "return history\n"
    )


def lik(body: str) -> str:
    return f("log_likelihood(theta, var_e, Phi, Y)", f"E = Y - Phi @ theta\n    N = len(Y)\n    return {body}")


THREE = "var_e * ((1 + c**2) * np.eye(N) + c * (np.eye(N, k=1) + np.eye(N, k=-1)))"

TRIES = (
    Try(TAB, "plus y", tables("np.linalg.lstsq(np.column_stack([y[:-1], u[:-1]]), y[1:])[0]"), "other sign of a"),
    Try(TAB, "few", tables(runs=20), "at least 100"),
    Try(TAB, "generator inside", tables(inside="rng = np.random.default_rng(5)"), "over and over"),
    Try(TAB, "sign of c", tables(c="0.8"), "other sign of c"),
    Try(TAB, "same time", tables("np.linalg.lstsq(np.column_stack([-y[:-1], u[1:]]), y[1:])[0]"), "takes u\\(t\\)"),
    Try(TAB, "whole lstsq", tables("np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1]]), y[1:])"), "`\\[0\\]`"),
    Try(
        BIAS,
        "no axis",
        bias("np.mean(estimates) - truth", "np.std(estimates)"),
        "the spread and the standard error of `bias_of` have one number for all 3",
    ),
    Try(BIAS, "ddof", bias(s="np.std(estimates, axis=0)"), "divide by M - 1"),
    Try(BIAS, "sign", bias("truth - np.mean(estimates, axis=0)"), "other sign"),
    Try(BIAS, "M", bias(se="s / len(estimates)"), "divided by M"),
    Try(BIAS, "rows", bias("np.mean(estimates, axis=1) - 1", "np.std(estimates, axis=1)"), "along the rows"),
    Try(LIM, "sign", limit(end="[a + c * var_e / var_y, b]"), "wrong way"),
    Try(LIM, "no cross", limit("(b**2 * var_u + (1 + c**2) * var_e) / (1 - a**2)"), "are correlated, which"),
    Try(LIM, "no 1 - a^2", limit("b**2 * var_u + (1 + c**2 - 2 * a * c) * var_e"), "a\\^2 times itself"),
    Try(LIM, "bias only", limit(end="[-c * var_e / var_y, 0]"), r"distance of the limit from \[a, b\]"),
    Try(LIM, "caret", limit("(b^2 * var_u) / (1 - a^2)"), r"write `\*\*`"),
    Try(COV, "white", cov("var_e * np.eye(N)"), "for white noise", never="Lemma"),
    Try(
        COV,
        "1 on the diagonal",
        cov("var_e * (np.eye(N) + c * (np.eye(N, k=1) + np.eye(N, k=-1)))"),
        "has var_e on the diagonal",
    ),
    Try(COV, "one side", cov("var_e * ((1 + c**2) * np.eye(N) + c * np.eye(N, k=1))"), "above or below"),
    Try(COV, "R itself", cov(THREE, "R"), "covariance of the noise"),
    Try(COV, "diagonal", cov(THREE, "np.diag(I @ Phi.T @ R @ Phi @ I)"), "covariance is a"),
    Try(COV, "order", cov(THREE, "I @ Phi @ R @ Phi.T @ I"), "columns and the second"),
    Try(ARMAX, "no c", armax(c="[1]"), "leaves c epsilon"),
    Try(ARMAX, "sign of c", armax(c="[1, -c]"), "other sign of c"),
    Try(ARMAX, "sign of a", armax("y[1:] - a * y[:-1] - b * u[:-1]"), "other sign of a"),
    Try(ARMAX, "own error", armax(third="eps[1:]"), "its own sample"),
    Try(ARMAX, "no share", armax(move="new"), "whole way"),
    Try(RELS, "lambda once", rels("P - np.outer(q, q) / (forgetting + phi @ q)"), "not divide P"),
    Try(RELS, "1 below", rels("(P - np.outer(q, q) / (1 + phi @ q)) / forgetting"), "1 \\+ phi'P phi"),
    Try(RELS, "old gain", rels(K="q"), "before the sample"),
    Try(RELS, "plus y", rels(phi="y[n - 1], u[n - 1], eps"), "other sign of a"),
    Try(RELS, "u now", rels(phi="-y[n - 1], u[n], eps"), "takes u\\(n\\)"),
    Try(
        F14, "rows", "fig_14, ax = plt.subplots()\nax.plot(theta_rels[-1])", r"3 points in place of 1000.*first \*row\*"
    ),
    Try(
        F14, "no legend", "fig_14, ax = plt.subplots()\nax.plot(theta_rels)\nax.set_xlabel('n')", "give each a `label`"
    ),
    Try(IV, "predicted", iv("-theta[0] * np.r_[0, y[:-1]] + theta[1] * np.r_[0, u[:-1]]"), "measured output"),
    Try(IV, "Z for all", iv(solve="np.linalg.lstsq(Z, Y)[0]"), "Z instead of Phi"),
    Try(IV, "transposed", iv(solve="np.linalg.solve(Phi.T @ Z, Z.T @ Y)"), "asked for is its transpose, Z'Phi"),
    Try(IV, "inverse shapes", iv(solve="np.linalg.inv(Z @ Phi.T) @ Z @ Y"), "rank 2 at most|no inverse"),
    Try(IV, "lfilter sign", iv("scipy.signal.lfilter([0, theta[1]], [1, -theta[0]], u)"), "other sign of a: y_M"),
    Try(
        REC,
        "z z'",
        recursive(
            "eps = y[n] - phi @ theta\n        P = P - np.outer(P @ z, z @ P) / (1 + z @ P @ z)\n     "
            "   theta = theta + P @ z * eps"
        ),
        "z twice",
    ),
    Try(
        REC,
        "P taken for symmetric",
        recursive(
            "eps = y[n] - phi @ theta\n        P = P - np.outer(P @ z, P @ phi) / (1 + phi @ P @ z)\n     "
            "   theta = theta + P @ z * eps"
        ),
        "phi' P belongs",
    ),
    Try(
        REC,
        "phi only",
        recursive(
            "eps = y[n] - phi @ theta\n        P = P - np.outer(P @ phi, phi @ P) / (1 + phi @ P @ "
            "phi)\n        theta = theta + P @ phi * eps"
        ),
        "never uses z",
    ),
    Try(
        REC,
        "z in the error",
        recursive(
            "eps = y[n] - z @ theta\n        P = P - np.outer(P @ z, phi @ P) / (1 + phi @ P @ z)\n   "
            "     theta = theta + P @ z * eps"
        ),
        "predicts with z",
    ),
    Try(REC, "not updated", recursive("pass"), "never moves"),
    Try(LIK, "half", lik("-N * np.log(2 * np.pi * var_e) - E @ E / (2 * var_e)"), "without the half"),
    Try(LIK, "log10", lik("-N / 2 * np.log10(2 * np.pi * var_e) - E @ E / (2 * var_e)"), "base 10"),
    Try(LIK, "sign", lik("N / 2 * np.log(2 * np.pi * var_e) + E @ E / (2 * var_e)"), "other sign"),
    Try(LIK, "squared", lik("-N / 2 * np.log(2 * np.pi * var_e**2) - E @ E / (2 * var_e**2)"), "squares var_e"),
    Try(LIK, "pi", lik("-N / 2 * np.log(2 * pi * var_e) - E @ E / (2 * var_e)"), r"np\.pi"),
    Try(LIK, "per sample", lik("-0.5 * np.log(2 * np.pi * var_e) - E**2 / (2 * var_e)"), "add them up"),
    Try(
        RELS,
        "begins with n = 0",
        "def rels(u, y, forgetting, LN):\n    theta, P, e = np.zeros(3), LN * np.eye(3), 0.0\n"
        "    history = np.zeros((len(y), 3))\n    for n in range(len(y)):\n"
        "        phi = np.array([-y[n - 1], u[n - 1], e])\n"
        "        e = y[n] - phi @ theta\n        g = P @ phi\n"
        "        P = (P - np.outer(g, g) / (forgetting + phi @ g)) / forgetting\n        theta = theta + P @ phi * e\n"
        "        history[n] = theta\n    return history\n\n\ntheta_rels = rels(u_71, y_71, 1.0, 1e6)\n",
        "last\\* sample of the record",
    ),
    Try(
        REC,
        "product of flat arrays",
        recursive(
            "eps = y[n] - phi @ theta\n        P = P - P @ z @ phi @ P / (1 + phi @ P @ z)\n     "
            "   theta = theta + P @ z * eps"
        ),
        r"np.outer\(P @ z, phi\)",
        never=r"made by `\*`",
    ),
    Try(BIAS, "all entries", bias(se="s / np.sqrt(estimates.size)"), "counts all entries"),
    Try(
        BIAS,
        "about the truth",
        bias(s="np.sqrt(np.sum((estimates - truth)**2, axis=0) / (len(estimates) - 1))"),
        "the bias is in it",
    ),
    Try(BIAS, "axis 1", bias("np.mean(estimates, axis=1) - truth"), "number of each \\*row\\*"),
    Try(
        LIM, "1 - a", limit("(b**2 * var_u + (1 + c**2 - 2 * a * c) * var_e) / (1 - a)"), "a stands without its square"
    ),
    Try(LIM, "b", limit("(b * var_u + (1 + c**2 - 2 * a * c) * var_e) / (1 - a**2)"), "b stands without its square"),
    Try(LIM, "1 + a^2", limit("(b**2 * var_u + (1 + c**2 - 2 * a * c) * var_e) / (1 + a**2)"), "by 1 \\+ a\\^2"),
    Try(LIM, "root", limit(end="[a - c * var_e / np.sqrt(var_y), b]"), "standard deviation of y"),
    Try(COV, "weighted", cov(THREE, "np.linalg.inv(Phi.T @ np.linalg.inv(R) @ Phi)"), "\\*weighted\\* estimate"),
    Try(ARMAX, "share of theta", armax(move="share * new"), "takes a share of the new theta"),
    Try(IV, "not delayed", iv().replace("-y_M[:-1], u[:-1]])\n", "-y_M[1:], u[1:]])\n"), "y_M\\(t\\), u\\(t\\)"),
    Try(
        REC,
        "exchanged throughout",
        recursive(
            "eps = y[n] - phi @ theta\n        P = P - np.outer(P @ phi, z @ P) / (1 + z @ P @ phi)\n"
            "        theta = theta + P @ phi * eps"
        ),
        "in P and in the gain",
    ),
    Try(
        REC,
        "no 1",
        recursive(
            "eps = y[n] - phi @ theta\n        P = P - np.outer(P @ z, phi @ P) / (phi @ P @ z)\n"
            "        theta = theta + P @ z * eps"
        ),
        "denominator is zero, and with its 1 it is not",
    ),
    Try(LIK, "no N/2", lik("-np.log(2 * np.pi * var_e) - E @ E / (2 * var_e)"), "stands there N/2 times"),
    Try(LIK, "no brackets", lik("-N / 2 * np.log(2 * np.pi * var_e) - E @ E / 2 * var_e"), "multiplies by var_e"),
    Try(
        LIK, "plus the errors", lik("-N / 2 * np.log(2 * np.pi * var_e) + E @ E / (2 * var_e)"), "grows with the errors"
    ),
    Try(
        ARMAX,
        "C for 1/C",
        armax().replace("lfilter([1], [1, c], w)", "lfilter([1, c], [1], w)"),
        r"is to be \*solved\*",
    ),
    Try(COV, "one inverse", cov(THREE, "I @ Phi.T @ R @ Phi"), "on one side only"),
    Try(
        LIK,
        "no variance in the logarithm",
        lik("-N / 2 * np.log(2 * np.pi) - E @ E / (2 * var_e)"),
        "has log\\(2 pi\\) alone",
    ),
    Try(COV, "c everywhere", cov("var_e * ((1 + c**2 - c) * np.eye(N) + c * np.ones((N, N)))"), "between all samples"),
    Try(LIM, "variance of System 2", limit(end="[a - c * var_e / 4.704, b]"), "variance of y of System 2"),
    Try(LIM, "b pulled, too", limit(end="[a - c * var_e / var_y, b + c * var_e / var_u]"), "b has no bias"),
    Try(
        COV,
        "1 + c",
        cov("var_e * ((1 + c) * np.eye(N) + c * (np.eye(N, k=1) + np.eye(N, k=-1)))"),
        "\\(1 \\+ c\\) var_e on the diagonal",
    ),
    Try(
        COV,
        "2c beside",
        cov("var_e * ((1 + c**2) * np.eye(N) + 2 * c * (np.eye(N, k=1) + np.eye(N, k=-1)))"),
        "2 c var_e beside",
        never="on the diagonal",
    ),
    Try(ARMAX, "share of theta added", armax(move="theta + share * new"), "adds a share of the new theta"),
    Try(
        ARMAX,
        "share of theta",
        armax(move="share * new"),
        "takes a share of the new theta",
        never="adds a share",
    ),
    Try(
        F14,
        "rows of the history",
        "fig_14, ax = plt.subplots()\nfor row, name in zip(theta_rels, 'abc'):\n    ax.plot(row, label=name)",
        r"3 points in place of 1000.*first \*row\*",
    ),
    Try(LIM, "0 for b", limit(end="[a - c * var_e / var_y, 0]"), "returns 0 for b", never="changes b"),
    Try(BIAS, "root of M - 1", bias(se="s / np.sqrt(len(estimates) - 1)"), "holds the M - 1 already"),
    Try(
        BIAS,
        "spread first",
        f(
            "bias_of(estimates, truth)",
            "s = np.std(estimates, axis=0, ddof=1)\n    "
            "return s, np.mean(estimates, axis=0) - truth, s / np.sqrt(len(estimates))",
        ),
        "returns the spread first",
    ),
    Try(
        BIAS,
        "standard error second",
        f(
            "bias_of(estimates, truth)",
            "s = np.std(estimates, axis=0, ddof=1)\n    "
            "return np.mean(estimates, axis=0) - truth, s / np.sqrt(len(estimates)), s",
        ),
        "standard error before the spread",
    ),
    Try(ARMAX, "b added", armax(w="y[1:] + a * y[:-1] + b * u[:-1]"), r"adds b u\(t-1\)"),
    Try(LIK, "mean", lik("np.mean(-np.log(2 * np.pi * var_e) / 2 - E**2 / (2 * var_e))"), "log densities are added up"),
)
