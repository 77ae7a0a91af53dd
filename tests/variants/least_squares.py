"""Answers to the least-squares lecture that differ from the model solution, right ones and wrong ones."""

from variants import Right, Wrong, define, right, wrong

KIND, DELAYS, DERIVATIVES, FITS, FIGURE = "ls-1-kind", "ls-2-delays", "ls-3-derivatives", "ls-4-fits", "ls-4-figure-5"
PROJECTOR, SOLUTIONS, KNOWN, WEIGHTED = "ls-5-projector", "ls-6-all-solutions", "ls-7-known", "ls-8-weighted"
CONSTRAINED, CONFIDENCE, CAYLEY = "ls-9-constrained", "ls-10-confidence", "ls-11-cayley-hamilton"


def kind(
    numbers: str = "np.linalg.eigvalsh(M + M.T)", zero: str = "1e-10 * max(abs(L))", names: str = "positive negative"
) -> str:
    plus, minus = names.split()
    return define(
        "kind(M)",
        f"L = {numbers}\nzero = {zero}\nplus, minus, flat = any(L > zero), any(L < -zero), any(abs(L) <= zero)\n"
        "if plus and minus:\n    return 'indefinite'\n"
        f"return ('{plus}' if plus else '{minus}') + (' semidefinite' if flat else ' definite')",
    )


SAMPLING = (
    "rng = np.random.default_rng(0)\nX = rng.standard_normal((4000, len(M)))\nS = (M + M.T) / 2\n"
    "X = np.vstack([X, np.linalg.svd(S)[2]])\nf = np.array([x @ M @ x for x in X])\nf[abs(f) < 1e-9] = 0\n"
    "if f.min() < 0 < f.max():\n    return 'Indefinite'\n"
    "return f\"{'positive' if f.max() > 0 else 'negative'} {'semi' if 0 in f else ''}definite\""
)
DETERMINANT = (
    "d = np.linalg.det(M + M.T)\nif abs(d) < 1e-9:\n    return 'positive semidefinite'\n"
    "return 'positive definite' if d > 0 else 'negative definite'"
)


def delays(body: str) -> str:
    return define("delayed_inputs(u, n)", body)


def derivatives(
    gradient: str = "(A + A.T) @ x", jacobian: str = "(x @ x) * np.eye(len(x)) + 2 * np.outer(x, x)"
) -> str:
    return define("gradient_form(A, x)", f"return {gradient}") + define("jacobian_cubic(x)", f"return {jacobian}")


DIFFERENCES = define(
    "slopes(f, x)", "d = 1e-4 * np.eye(len(x))\nreturn np.array([(f(x + e) - f(x - e)) / 2e-4 for e in d]).T"
)

TABLE = "u_1 = np.array([1.0, 2, 4, 5, 7])\ny_1 = np.array([1.0, 3, 5, 7, 8])\n"
USED = (
    "theta_line, sse_line = fit_powers(u_1, y_1, [1, 0])\n"
    "theta_parabola, sse_parabola = fit_powers(u_1, y_1, [2, 1, 0])\n"
)


def fits(
    theta: str = "np.linalg.lstsq(Phi, y)[0]",
    sse: str = "np.sum((y - Phi @ theta) ** 2)",
    powers: str = "powers",
    result: str = "theta, sse",
    used: str = USED,
) -> str:
    body = f"Phi = np.column_stack([x**p for p in {powers}])\ntheta = {theta}\nsse = {sse}\nreturn {result}"
    return TABLE + define("fit_powers(x, y, powers)", body) + used


def figure(
    points: str = "ax.plot(u_1, y_1, 'o', label='Data')",
    line: str = "ax.plot(grid, np.polyval(theta_line, grid), label='Line')",
    parabola: str = "ax.plot(grid, np.polyval(theta_parabola, grid), label='Parabola')",
    rest: str = "ax.legend()\nax.set_xlabel('u')\nax.set_ylabel('y')",
) -> str:
    return f"grid = np.linspace(0, 8, 81)\nfig_5, ax = plt.subplots()\n{points}\n{line}\n{parabola}\n{rest}\n"


def projector(result: str) -> str:
    return define("projector(Phi)", f"return {result}")


def solutions(
    theta: str = "np.linalg.pinv(Phi) @ Y", N: str = "np.linalg.svd(Phi)[2][rank:].T", before: str = ""
) -> str:
    return define(
        "all_solutions(Phi, Y)",
        f"rank, p = np.linalg.matrix_rank(Phi), Phi.shape[1]\n{before}theta = {theta}\nN = {N}\nreturn theta, N",
    )


# A solution in which as many parameters as possible are zero, as MATLAB's backslash gives it.
BASIC = (
    "from scipy.linalg import qr\nQ, R, order = qr(Phi, mode='economic', pivoting=True)\nbasic = np.zeros(p)\n"
    "basic[order[:rank]] = np.linalg.solve(R[:rank, :rank], (Q.T @ Y)[:rank])\n"
)


def known(columns: str = "-y[1:-2], u[:-3]", target: str = "y[3:] - u[2:-1]", after: str = "") -> str:
    return define("example_1(u, y)", f"H = np.column_stack([{columns}])\nreturn np.linalg.lstsq(H, {target})[0]{after}")


def weighted(result: str) -> str:
    return define("weighted_fit(Phi, Y, sigma)", f"return {result}")


def constrained(body: str) -> str:
    return define("constrained_fit(Phi, Y, A, b)", body)


KKT = (
    "r = len(b)\nK = np.block([[Phi.T @ Phi, A.T], [A, np.zeros((r, r))]])\n"
    "both = np.linalg.solve(K, np.r_[Phi.T @ Y, b])\nreturn both"
)
FREE = "free = np.linalg.lstsq(Phi, Y)[0]\n"


def confidence(
    quantile: str = "scipy.stats.t.ppf((1 + level) / 2, n - p)",
    sigma2: str = "E @ E / (n - p)",
    spread: str = "np.sqrt(np.diag(C))",
    result: str = "theta, theta - q * s, theta + q * s",
) -> str:
    return define(
        "confidence(Phi, Y, level)",
        "n, p = Phi.shape\ntheta = np.linalg.lstsq(Phi, Y)[0]\nE = Y - Phi @ theta\n"
        f"C = {sigma2} * np.linalg.inv(Phi.T @ Phi)\nq = {quantile}\ns = {spread}\nreturn {result}",
    )


def cayley(result: str, before: str = "c = np.poly(A)\n") -> str:
    return define("inverse_weights(A)", f"{before}return {result}")


VARIANTS: list[Right | Wrong] = [
    # 1. the kind of a form
    right(KIND, "signs of the eigenvalues, any and all", kind()),
    right(KIND, "values of the form at many points", define("kind(M)", SAMPLING)),
    right(KIND, "rounded eigenvalues", kind("np.round(np.linalg.eigvals((M + M.T) / 2).real, 8)", "0")),
    wrong(KIND, "eigenvalues of M", kind("np.linalg.eigvals(M).real"), "eigenvalues of M itself", "symmetric"),
    wrong(KIND, "lower triangle", kind("np.linalg.eigvalsh(M)"), "eigenvalues of M itself", "triangle"),
    wrong(KIND, "zero compared exactly", kind(zero="0"), "zero compared exactly", "rounding"),
    wrong(
        KIND,
        "semidefinite unknown",
        kind().replace("' semidefinite' if flat else ' definite'", "' definite'"),
        "semidefinite forgotten",
        "trough",
    ),
    wrong(KIND, "swapped", kind(names="negative positive"), "positive and negative swapped", "bowl"),
    wrong(KIND, "diagonal", kind("np.diag(M)"), "diagonal entries only", "diagonal"),
    wrong(KIND, "determinant", define("kind(M)", DETERMINANT), "determinant only", "product"),
    wrong(
        KIND,
        "no branch for the ridge",
        kind().replace("    return (", "    if minus and flat:\n        return 'indefinite'\n    return ("),
        "branch missing",
        "does not recognise a negative semidefinite matrix",
    ),
    wrong(
        KIND,
        "calls counted",
        "calls = []\n"
        + define(
            "kind(M)",
            "calls.append(0)\n"
            "return (['positive definite'] * 2 + ['negative definite'] + ['indefinite'] * 4)[len(calls) % 7]",
        ),
        None,
        "is wrong for",
    ),
    wrong(KIND, "another text", define("kind(M)", "return 'a bowl'"), "another text", "one of: positive definite"),
    # 2. Example 2-3
    right(
        DELAYS,
        "concatenated",
        delays("return np.column_stack([np.r_[np.zeros(i), u[: len(u) - i]] for i in range(n)])"),
    ),
    right(
        DELAYS,
        "toeplitz",
        delays("from scipy.linalg import toeplitz\nreturn toeplitz(u, np.r_[u[0], np.zeros(n - 1)])"),
    ),
    right(
        DELAYS,
        "loop over all entries",
        delays(
            "rows = []\nfor t in range(len(u)):\n    rows.append([u[t - i] if t >= i else 0 for i in range(n)])\n"
            "return rows"
        ),
    ),
    wrong(
        DELAYS,
        "np.roll",
        delays("return np.column_stack([np.roll(u, i) for i in range(n)])"),
        "index wraps around",
        "zero",
    ),
    wrong(
        DELAYS,
        "begins with u(t-1)",
        delays("return np.column_stack([np.r_[np.zeros(i + 1), u[: -i - 1]] for i in range(n)])"),
        "lag off by one",
        "the first column",
    ),
    wrong(
        DELAYS,
        "rows without zeros only",
        delays("return np.column_stack([u[n - 1 - i : len(u) - i] for i in range(n)])"),
        "first rows left out",
        "row for every",
    ),
    wrong(
        DELAYS,
        "reversed",
        delays("return np.column_stack([np.r_[np.zeros(i), u[: len(u) - i]] for i in range(n)][::-1])"),
        "columns in reverse order",
        "oldest",
    ),
    wrong(
        DELAYS,
        "rows instead of columns",
        delays("return np.array([np.r_[np.zeros(i), u[: len(u) - i]] for i in range(n)])"),
        "rows instead of columns",
        "transpose it",
    ),
    wrong(
        DELAYS,
        "always three",
        delays("return np.column_stack([np.r_[np.zeros(i), u[: len(u) - i]] for i in range(3)])"),
        "n not used",
        "use the argument n",
    ),
    wrong(
        DELAYS,
        "first sample repeated",
        delays("return np.column_stack([np.r_[np.full(i, u[0]), u[: len(u) - i]] for i in range(n)])"),
        "first sample repeated",
        "zeros",
    ),
    # 3. derivatives
    right(
        DERIVATIVES,
        "two terms, by outer and diag",
        derivatives("A @ x + x @ A", "np.diag([x @ x] * len(x)) + 2 * x[:, None] * x"),
    ),
    right(
        DERIVATIVES,
        "by differences",
        DIFFERENCES
        + define("gradient_form(A, x)", "return slopes(lambda z: z @ A @ z, x).round(9)")
        + define(
            "jacobian_cubic(x)",
            "n = len(x)\nJ = np.empty((n, n))\nfor i in range(n):\n    for j in range(n):\n"
            "        J[i, j] = 2 * x[i] * x[j] + (sum(x**2) if i == j else 0)\nreturn J",
        ),
    ),
    wrong(DERIVATIVES, "2Ax", derivatives("2 * A @ x"), "A taken for symmetric", "only for symmetric A"),
    wrong(DERIVATIVES, "Ax", derivatives("A @ x"), "one of the two terms", "row k"),
    wrong(DERIVATIVES, "half", derivatives("(A + A.T) / 2 @ x"), "half of the gradient", "half"),
    wrong(
        DERIVATIVES, "first factor constant", derivatives(jacobian="(x @ x) * np.eye(len(x))"), "product rule", "term"
    ),
    wrong(
        DERIVATIVES,
        "2 forgotten",
        derivatives(jacobian="(x @ x) * np.eye(len(x)) + np.outer(x, x)"),
        "the 2 forgotten",
        "2x'",
    ),
    wrong(
        DERIVATIVES,
        "as for numbers",
        derivatives(jacobian="3 * (x @ x) * np.eye(len(x))"),
        "3 x'x as for a number",
        "a number",
    ),
    wrong(DERIVATIVES, "vector", derivatives(jacobian="3 * x**2"), "vector instead of a Jacobian", "matrix"),
    wrong(
        DERIVATIVES,
        "eye forgotten",
        derivatives(jacobian="x @ x + 2 * np.outer(x, x)"),
        "x'x added to every entry",
        "diagonal",
    ),
    wrong(DERIVATIVES, "sign", derivatives("A @ x - A.T @ x"), "sign of one term", "plus"),
    # 4. sums of powers
    right(FITS, "normal equations", fits("np.linalg.inv(Phi.T @ Phi) @ Phi.T @ y", "y @ y - y @ Phi @ theta")),
    right(FITS, "list of both, pinv", fits("np.linalg.pinv(Phi) @ y", result="[theta, sse]")),
    right(FITS, "theta as a column", fits("(np.linalg.pinv(Phi) @ y)[:, None]", "sum((y - Phi @ theta[:, 0]) ** 2)")),
    wrong(FITS, "always a line", fits(powers="[1, 0]"), "powers not used", "use `powers`"),
    wrong(FITS, "highest first, whatever was asked", fits(powers="sorted(powers)[::-1]"), "order of theta", "order"),
    wrong(FITS, "half the sum", fits(sse="0.5 * np.sum((y - Phi @ theta) ** 2)"), "half the sum", "half"),
    wrong(FITS, "mean", fits(sse="np.mean((y - Phi @ theta) ** 2)"), "mean in place of the sum", "sum"),
    wrong(FITS, "norm", fits(sse="np.linalg.norm(y - Phi @ theta)"), "root of the sum", "root"),
    wrong(FITS, "not squared", fits(sse="np.sum(y - Phi @ theta)"), "errors not squared", "cancel"),
    wrong(FITS, "inverse forgotten", fits("Phi.T @ y"), "inverse forgotten", "inverse"),
    wrong(FITS, "swapped", fits(result="sse, theta"), "theta and SSE swapped", "before"),
    wrong(
        FITS,
        "theta as a row",
        fits("np.linalg.lstsq(Phi, y)[0].reshape(1, -1)", "np.sum((y - Phi @ theta[0]) ** 2)"),
        "a row instead of a column",
        "transpose it with",
    ),
    wrong(
        FITS,
        "theta alone",
        fits(result="theta", used="theta_line = fit_powers(u_1, y_1, [1, 0])\n"),
        "incomplete result",
        "theta and the SSE",
    ),
    wrong(FITS, "all of lstsq", fits("np.linalg.lstsq(Phi, y)", "0.0"), "all of lstsq", "\\[0\\]"),
    wrong(
        FITS,
        "used on other points",
        fits(
            used=USED.replace(
                "theta_line, sse_line = fit_powers(u_1, y_1", "theta_line, sse_line = fit_powers(y_1, u_1"
            )
        ),
        None,
        "theta_line",
    ),
    # 4. Fig. 5
    right(FIGURE, "written out", figure(line="ax.plot(grid, theta_line[0] * grid + theta_line[1], label='ax+b')")),
    right(
        FIGURE,
        "one plot call, names in the legend",
        figure(
            "one = grid**0\nline, curve = theta_line @ [grid, one], theta_parabola @ [grid**2, grid, one]\n"
            "ax.plot(u_1, y_1, 'kx', grid, line, grid, curve)",
            "",
            "",
            "ax.legend(['points', 'first model', 'second model'])\nplt.xlabel('u(t)')\nplt.ylabel('y(t)')",
        ),
    ),
    right(
        FIGURE,
        "points with scatter, legend of the figure",
        figure(
            "ax.scatter(u_1, y_1, label='Data')", rest="fig_5.legend()\nax.set_xlabel('$u(t)$')\nax.set_ylabel('y')"
        ),
    ),
    right(
        FIGURE,
        "two panels",
        "grid = np.linspace(0, 8, 81)\nfig_5, axes = plt.subplots(2, 1)\n"
        "for ax, name, theta in zip(axes, ('line', 'parabola'), (theta_line, theta_parabola)):\n"
        "    ax.plot(u_1, y_1, 'o', label='data')\n    ax.plot(grid, np.polyval(theta, grid), label=name)\n"
        "    ax.set(xlabel='u(t)', ylabel='y(t)')\n    ax.legend()\n",
    ),
    wrong(
        FIGURE,
        "labels of the axes swapped",
        figure(rest="ax.legend()\nax.set_xlabel('$y(t)$')\nax.set_ylabel('$u(t)$')"),
        "axis labels swapped",
        "swapped",
    ),
    wrong(FIGURE, "no points", figure(points=""), "points missing", "points"),
    wrong(
        FIGURE,
        "parabola at the data points",
        figure(parabola="ax.plot(u_1, np.polyval(theta_parabola, u_1), label='Parabola')"),
        "drawn at the data points only",
        "grid",
    ),
    wrong(
        FIGURE,
        "reverse order",
        figure(parabola="ax.plot(grid, np.polyval(theta_parabola[::-1], grid), label='Parabola')"),
        "order of theta",
        "reverse",
    ),
    wrong(FIGURE, "no parabola", figure(parabola=""), "no curve", "parabola"),
    wrong(FIGURE, "no legend", figure(rest="ax.set_xlabel('u')\nax.set_ylabel('y')"), "no legend", "legend"),
    wrong(FIGURE, "no labels", figure(rest="ax.legend()"), "axis without a label", "label"),
    wrong(
        FIGURE,
        "names swapped",
        figure().replace("'Line'", "'x'").replace("'Parabola'", "'Line'").replace("'x'", "'Parabola'"),
        "legend entries swapped",
        "swapped",
    ),
    # 5. the projection
    right(PROJECTOR, "pseudo-inverse", projector("Phi @ np.linalg.pinv(Phi)")),
    right(PROJECTOR, "QR", define("projector(Phi)", "Q = np.linalg.qr(Phi)[0]\nreturn Q @ Q.T")),
    wrong(
        PROJECTOR,
        "pseudo-inverse alone",
        projector("np.linalg.pinv(Phi)"),
        "pseudo-inverse instead of the projector",
        "left",
    ),
    wrong(PROJECTOR, "no inverse", projector("Phi @ Phi.T"), "inverse left out", "middle"),
    wrong(
        PROJECTOR,
        "onto the residual",
        projector("np.eye(len(Phi)) - Phi @ np.linalg.pinv(Phi)"),
        "projects onto the residual",
        "residual",
    ),
    wrong(
        PROJECTOR,
        "not inverted",
        projector("Phi @ (Phi.T @ Phi) @ Phi.T"),
        "inverse forgotten",
        "instead of its inverse",
    ),
    wrong(
        PROJECTOR,
        "p by p matrix",
        projector("np.linalg.inv(Phi.T @ Phi)"),
        "p by p matrix instead of the projector",
        "2 by 2",
    ),
    wrong(
        PROJECTOR,
        "normalised",
        projector("Phi @ Phi.T / np.linalg.norm(Phi) ** 2"),
        "divided by a norm",
        "in the middle",
    ),
    # 6. all solutions
    right(
        SOLUTIONS,
        "by the SVD",
        solutions(
            "Vt[:rank].T @ ((U.T @ Y)[:rank] / s[:rank])",
            "-2 * Vt.T[:, rank:]",
            "U, s, Vt = np.linalg.svd(Phi)\n",
        ),
    ),
    right(
        SOLUTIONS,
        "lstsq and null_space",
        solutions("np.linalg.lstsq(Phi, Y)[0]", "null_space(Phi)", "from scipy.linalg import null_space\n"),
    ),
    right(
        SOLUTIONS,
        "by the eigenvectors",
        solutions("np.linalg.pinv(Phi.T @ Phi) @ (Phi.T @ Y)", "np.linalg.eigh(Phi.T @ Phi)[1][:, : p - rank]"),
    ),
    wrong(SOLUTIONS, "as MATLAB's backslash", solutions("basic", before=BASIC), "not the shortest", "shortest"),
    wrong(
        SOLUTIONS,
        "V and not V'",
        solutions(N="np.linalg.svd(Phi)[2][:, rank:]"),
        "V and V transposed confused",
        "columns of V'",
    ),
    wrong(
        SOLUTIONS, "N on its side", solutions(N="np.linalg.svd(Phi)[2][rank:]"), "rows instead of columns", "as rows"
    ),
    wrong(
        SOLUTIONS,
        "the first rows",
        solutions(N="np.linalg.svd(Phi)[2][:rank].T"),
        "directions outside the null space",
        "null space",
    ),
    wrong(
        SOLUTIONS,
        "one direction only",
        solutions(N="np.linalg.svd(Phi)[2][-1:].T"),
        "directions missing",
        "independent",
    ),
    wrong(SOLUTIONS, "inverse left out", solutions("Phi.T @ Y"), "inverse left out", "Phi'Y"),
    wrong(
        SOLUTIONS,
        "inverse of a singular matrix",
        solutions("np.linalg.inv(Phi.T @ Phi) @ Phi.T @ Y", before="np.linalg.cholesky(-np.eye(2))\n"),
        None,
        "LinAlgError",
    ),
    # 7. known parameters
    right(
        KNOWN,
        "loop and normal equations",
        define(
            "example_1(u, y)",
            "H, Z = [], []\nfor k in range(4, len(u) + 1):\n    H.append([-y[k - 3], u[k - 4]])\n"
            "    Z.append(y[k - 1] - u[k - 2])\nH = np.array(H)\nreturn np.linalg.inv(H.T @ H) @ H.T @ np.array(Z)",
        ),
    ),
    right(KNOWN, "as a column", known(after=".reshape(-1, 1)")),
    wrong(KNOWN, "sign of a", known("y[1:-2], u[:-3]"), "sign of a", "-y\\(k-2\\)"),
    wrong(KNOWN, "three parameters", known("-y[1:-2], u[2:-1], u[:-3]", "y[3:]"), "known parameter estimated", "known"),
    wrong(
        KNOWN,
        "three parameters, the middle one dropped",
        known("-y[1:-2], u[2:-1], u[:-3]", "y[3:]", "[[0, 2]]"),
        "known parameter estimated",
        "known",
    ),
    wrong(KNOWN, "known term forgotten", known(target="y[3:]"), "known term left out", "Subtract it"),
    wrong(KNOWN, "added", known(target="y[3:] + u[2:-1]"), "known term with the wrong sign", "Subtract it"),
    wrong(KNOWN, "lag of y", known("-y[2:-1], u[:-3]"), "lag off by one", "k = 4"),
    wrong(KNOWN, "lag of u", known("-y[1:-2], u[1:-2]"), "lag off by one", "k = 4"),
    wrong(KNOWN, "u(k) taken off", known(target="y[3:] - u[3:]"), "lag off by one", "k = 4"),
    wrong(
        KNOWN,
        "from the first sample, at rest",
        known("-np.r_[0, 0, y[:-2]], np.r_[0, 0, 0, u[:-3]]", "y - np.r_[0, u[:-1]]"),
        "rows before k0",
        "begin",
    ),
    wrong(KNOWN, "b before a", known("u[:-3], -y[1:-2]"), "a and b swapped", "before"),
    # 8. weights
    right(
        WEIGHTED,
        "the formula",
        weighted("np.linalg.inv(Phi.T @ np.diag(sigma**-2) @ Phi) @ Phi.T @ np.diag(sigma**-2) @ Y"),
    ),
    right(
        WEIGHTED,
        "solve, with a loop",
        define(
            "weighted_fit(Phi, Y, sigma)",
            "A, b = 0, 0\nfor phi, y, s in zip(Phi, Y, sigma):\n    A = A + np.outer(phi, phi) / s**2\n"
            "    b = b + phi * y / s**2\nreturn np.linalg.solve(A, b)",
        ),
    ),
    wrong(WEIGHTED, "no weights", weighted("np.linalg.pinv(Phi) @ Y"), "weights not used", "does not use"),
    wrong(
        WEIGHTED,
        "1/sigma",
        weighted("np.linalg.solve(Phi.T @ np.diag(1 / sigma) @ Phi, Phi.T @ (Y / sigma))"),
        "standard deviation for variance",
        "1/sigma\\^2",
    ),
    wrong(
        WEIGHTED,
        "rows by the variance",
        weighted("np.linalg.lstsq(Phi / sigma[:, None] ** 2, Y / sigma**2)[0]"),
        "weights squared",
        "twice",
    ),
    wrong(
        WEIGHTED,
        "inverted",
        weighted("np.linalg.lstsq(Phi * sigma[:, None], Y * sigma)[0]"),
        "weights inverted",
        "worst",
    ),
    wrong(
        WEIGHTED,
        "Y forgotten",
        weighted("np.linalg.lstsq(Phi / sigma[:, None], Y)[0]"),
        "only one side weighted",
        "not Y",
    ),
    wrong(
        WEIGHTED,
        "uses W once",
        weighted("np.linalg.inv(Phi.T @ Phi) @ Phi.T @ (Y / sigma**2)"),
        "only one side weighted",
        "twice",
    ),
    wrong(WEIGHTED, "columns divided", weighted("np.linalg.lstsq(Phi / sigma, Y / sigma)[0]"), None, "stopped"),
    # 9. constraints
    right(
        CONSTRAINED,
        "by the null space",
        constrained(
            "from scipy.linalg import null_space\nstart, Z = np.linalg.pinv(A) @ b, null_space(A)\n"
            "return start + Z @ np.linalg.lstsq(Phi @ Z, Y - Phi @ start)[0]"
        ),
    ),
    right(
        CONSTRAINED,
        "corrected along (Phi'Phi)^-1 A'",
        constrained(
            FREE + "C = np.linalg.inv(Phi.T @ Phi) @ A.T\nreturn free + C @ np.linalg.solve(A @ C, b - A @ free)"
        ),
    ),
    wrong(CONSTRAINED, "free", constrained(FREE + "return free"), "constraint not used", "ignores the constraint"),
    wrong(
        CONSTRAINED,
        "as further rows",
        constrained("return np.linalg.lstsq(np.vstack([Phi, A]), np.r_[Y, b])[0]"),
        "constraint as additional data",
        "exactly",
    ),
    wrong(
        CONSTRAINED,
        "nearest point",
        constrained(FREE + "return free + np.linalg.pinv(A) @ (b - A @ free)"),
        "free solution projected onto the constraint",
        "smallest error",
    ),
    wrong(CONSTRAINED, "multipliers too", constrained(KKT), "multipliers returned too", "first p"),
    wrong(CONSTRAINED, "constraint alone", constrained("return np.linalg.pinv(A) @ b"), "data not used", "data"),
    wrong(
        CONSTRAINED,
        "sign of b",
        constrained(KKT.replace("Y, b]", "Y, -b]") + "[: Phi.shape[1]]"),
        "sign of b",
        "= -b",
    ),
    # 10. confidence
    right(
        CONFIDENCE,
        "scipy's interval",
        confidence(result="np.array([theta, *scipy.stats.t.interval(level, n - p, theta, s)])"),
    ),
    right(
        CONFIDENCE, "survival function", confidence("scipy.stats.t.isf((1 - level) / 2, n - p)", "sum(E**2) / (n - p)")
    ),
    wrong(CONFIDENCE, "one-sided", confidence("scipy.stats.t.ppf(level, n - p)"), "one-sided quantile", "two"),
    wrong(CONFIDENCE, "normal", confidence("scipy.stats.norm.ppf((1 + level) / 2)"), "normal quantile", "Student"),
    wrong(CONFIDENCE, "SSE over n", confidence(sigma2="E @ E / n"), "divided by n", "n - p"),
    wrong(CONFIDENCE, "variance", confidence(spread="np.diag(C)"), "variance for standard error", "roots"),
    wrong(CONFIDENCE, "no quantile", confidence("1.0"), "quantile forgotten", "quantile"),
    wrong(CONFIDENCE, "always 95 %", confidence("scipy.stats.t.ppf(0.975, n - p)"), "level not used", "level"),
    wrong(CONFIDENCE, "no sigma", confidence(sigma2="1"), "sigma^2 forgotten", "sigma"),
    wrong(
        CONFIDENCE,
        "n degrees of freedom",
        confidence("scipy.stats.t.ppf((1 + level) / 2, n)"),
        "degrees of freedom",
        "n - p",
    ),
    wrong(CONFIDENCE, "half width", confidence(result="theta, -q * s, q * s"), "half width returned", "minus and plus"),
    wrong(CONFIDENCE, "swapped", confidence(result="theta, theta + q * s, theta - q * s"), "bounds swapped", "before"),
    wrong(
        CONFIDENCE,
        "bounds alone",
        confidence(result="theta - q * s, theta + q * s"),
        "incomplete result",
        "theta",
    ),
    # 11. Cayley-Hamilton
    right(
        CAYLEY,
        "from the eigenvalues",
        cayley("[-x / c[-1] for x in reversed(c[:-1])]", "c = np.poly(np.linalg.eigvals(A)).real\n"),
    ),
    right(
        CAYLEY,
        "solved for the weights",
        cayley(
            "np.linalg.lstsq(np.array(P).T, np.linalg.inv(A).ravel())[0]",
            "P = [np.linalg.matrix_power(A, i).ravel() for i in range(len(A))]\n",
        ),
    ),
    wrong(CAYLEY, "highest power first", cayley("-c[:-1] / c[-1]"), "highest power first", "w\\[0\\]"),
    wrong(CAYLEY, "sign", cayley("c[:-1][::-1] / c[-1]"), "sign of the weights", "sign"),
    wrong(CAYLEY, "not divided", cayley("-c[:-1][::-1]"), "not divided by c_n", "division by c_n"),
    wrong(CAYLEY, "off by one", cayley("-c[1:][::-1] / c[-1]"), "powers off by one", "lowers each power by one"),
    wrong(CAYLEY, "the polynomial", cayley("c"), "coefficients of the polynomial", "n \\+ 1"),
    wrong(CAYLEY, "the inverse", cayley("np.linalg.inv(A)"), "matrix returned", "weights"),
]
