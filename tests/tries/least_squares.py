"""First tries at the least-squares lecture."""

from tries import ACCEPTED, Try

KIND, DEL, DER, FITS, F5, PROJ = (
    "ls-1-kind", "ls-2-delays", "ls-3-derivatives", "ls-4-fits", "ls-4-figure-5", "ls-5-projector",
)  # fmt: skip
SOL, KNOWN, WEI, CON, CONF, CAY = (
    "ls-6-all-solutions", "ls-7-known", "ls-8-weighted", "ls-9-constrained", "ls-10-confidence",
    "ls-11-cayley-hamilton",
)  # fmt: skip


def kind(values: str, rest: str = "") -> str:
    return (
        f"def kind(M):\n    L = {values}\n    if np.all(L > 0): return 'positive definite'\n"
        "    if np.all(L < 0): return 'negative definite'\n    if np.all(L >= 0): return 'positive semidefinite'\n"
        f"    if np.all(L <= 0): return 'negative semidefinite'\n    return 'indefinite'\n{rest}"
    )


def f(head: str, body: str) -> str:
    return f"def {head}:\n    {body}\n"


def der(gradient: str = "A @ x + A.T @ x", jacobian: str = "(x @ x) * np.eye(len(x)) + 2 * np.outer(x, x)") -> str:
    return f("gradient_form(A, x)", f"return {gradient}") + f("jacobian_cubic(x)", f"return {jacobian}")


def fits(columns: str = "[x**p for p in powers]", result: str = "theta, E @ E", E: str = "y - Phi @ theta") -> str:
    return (
        "u_1 = np.array([1.0, 2, 4, 5, 7])\ny_1 = np.array([1.0, 3, 5, 7, 8])\n\n\ndef fit_powers(x, y, powers):\n"
        f"    Phi = np.column_stack({columns})\n    theta = np.linalg.lstsq(Phi, y)[0]\n    E = "
        f"{E}\n    return {result}\n\n\n"
        "theta_line, sse_line = fit_powers(u_1, y_1, [1, 0])\ntheta_parabola, sse_parabola = "
        "fit_powers(u_1, y_1, [2, 1, 0])"
    )


def known(columns: str = "-y[1:-2], u[:-3]", target: str = "y[3:] - u[2:-1]") -> str:
    return f("example_1(u, y)", f"return np.linalg.lstsq(np.column_stack([{columns}]), {target})[0]")


def kkt(right: str = "np.concatenate([Phi.T @ Y, b])", end: str = "[:p]", corner: str = "np.zeros((r, r))") -> str:
    return f(
        "constrained_fit(Phi, Y, A, b)",
        f"p, r = Phi.shape[1], len(b)\n    left = np.block([[Phi.T @ Phi, A.T], [A, {corner}]])\n"
        f"    return np.linalg.solve(left, {right}){end}",
    )


def conf(
    s2: str = "E @ E / (N - p)", q: str = "scipy.stats.t.ppf((1 + level) / 2, N - p)",
    cov: str = "np.linalg.inv(Phi.T @ Phi)", root: str = "np.sqrt", end: str = "theta, theta - half, theta + half",
) -> str:  # fmt: skip
    return f(
        "confidence(Phi, Y, level)",
        "N, p = Phi.shape\n    theta = np.linalg.lstsq(Phi, Y)[0]\n    E = Y - Phi @ theta\n"
        f"    s2 = {s2}\n    half = {q} * {root}(s2 * np.diag({cov}))\n    return {end}",
    )


def lags(column: str, end: str) -> str:
    return f"return np.column_stack([{column} for i in range({end})])"


WEIGHTED = "np.linalg.solve(Phi.T @ W @ Phi, Phi.T @ W @ Y)"

TRIES = (
    Try(KIND, "eigenvalues of M", kind("np.linalg.eigvals(M).real"), "eigenvalues of M, and compares"),
    Try(KIND, "exact zero", kind("np.linalg.eigvalsh((M + M.T) / 2)"), "tolerance"),
    Try(
        KIND, "printed", kind("np.linalg.eigvalsh((M + M.T) / 2)").replace("return", "print"), "handed back by `return`"
    ),
    Try(
        KIND,
        "if on eigenvalues",
        f("kind(M)", "L = np.linalg.eigvalsh(M + M.T)\n    if L > 0:\n        return 'positive definite'"),
        "True or False",
    ),
    Try(KIND, "other words", f("kind(M)", "return 'bowl'"), "should return one of"),
    Try(KIND, "eig unpacked", kind("np.linalg.eig((M + M.T) / 2)"), "several results"),
    Try(
        KIND,
        "determinants",
        f("kind(M)", "return 'positive definite' if np.linalg.det(M) > 0 else 'indefinite'"),
        "is wrong for",
    ),
    Try(
        DEL,
        "u[:-i]",
        f("delayed_inputs(u, n)", "return np.column_stack([u] + [u[:-i] for i in range(1, n)])"),
        r"Side by side.*that of u\(t-i\) begins with i zeros and leaves out the last i samples",
        never="Often here|takes nothing|inhomogeneous",
    ),
    Try(
        DEL,
        "roll",
        f("delayed_inputs(u, n)", "return np.column_stack([np.roll(u, i) for i in range(n)])"),
        "wrap around",
    ),
    Try(
        DEL,
        "valid rows",
        f("delayed_inputs(u, n)", "return np.column_stack([u[n-1-i:len(u)-i] for i in range(n)])"),
        "omits the first rows",
    ),
    Try(
        DEL,
        "up",
        f("delayed_inputs(u, n)", "return np.column_stack([np.r_[u[i:], np.zeros(i)] for i in range(n)])"),
        "down, not up",
    ),
    Try(
        DEL,
        "from lag 1",
        f("delayed_inputs(u, n)", "return np.column_stack([np.r_[np.zeros(i), u[:-i]] for i in range(1, n + 1)])"),
        "begins with u\\(t-1\\)",
    ),
    Try(
        DEL,
        "rows",
        f("delayed_inputs(u, n)", "return np.array([np.r_[np.zeros(i), u[:len(u) - i]] for i in range(n)])"),
        "transpose it",
    ),
    Try(DEL, "zeros shape", f("delayed_inputs(u, n)", "return np.zeros(len(u), n)"), "brackets of its own"),
    Try(
        DEL,
        "index",
        f(
            "delayed_inputs(u, n)",
            "P = np.zeros((len(u), n))\n    for t in range(len(u)):\n        for i in range(n):\n     "
            "       P[t, i] = u[t + i]\n    return P",
        ),
        "indices 0 to",
    ),
    Try(DER, "2Ax", der("2 * A @ x"), "only for symmetric A"),
    Try(DER, "Ax", der("A @ x"), "only one of the two terms"),
    Try(DER, "*", der("A * x + A.T * x"), "table"),
    Try(DER, "transpose of x", der("x.T @ A @ x"), "should hold 3 numbers"),
    Try(DER, "3x^2", der(jacobian="3 * x**2"), "should return a matrix"),
    Try(DER, "caret", der(jacobian="3 * x^2"), r"write `\*\*`"),
    Try(DER, "x x' once", der(jacobian="(x @ x) * np.eye(len(x)) + np.outer(x, x)"), "once: both factors of x'x are x"),
    Try(DER, "x @ x.T", der(jacobian="(x @ x) * np.eye(len(x)) + 2 * x @ x.T"), "is a number"),
    Try(FITS, "ascending range", fits("[x**i for i in range(len(powers))]"), r"fits the powers \[0, 1, 2\]"),
    Try(
        FITS,
        "uses u_1 y_1",
        fits("[u_1**p for p in powers]").replace("lstsq(Phi, y)", "lstsq(Phi, y_1)").replace("E = y -", "E = y_1 -"),
        "table `u_1`",
    ),
    Try(FITS, "u_1 in Phi", fits("[u_1**p for p in powers]"), "has 5 rows|same number of rows|Incompatible|lstsq"),
    Try(FITS, "sorted", fits("[x**p for p in sorted(powers)]"), "not in the order of `powers`"),
    Try(FITS, "array of powers", fits("x**powers"), "shape|Entry by entry|samples"),
    Try(FITS, "mean", fits(result="theta, np.mean(E**2)"), "mean of the squared errors"),
    Try(FITS, "E", fits(result="theta, E"), "errors themselves"),
    Try(FITS, "only theta", fits(result="theta"), "should return theta and the SSE|which is 1 thing"),
    Try(
        F5,
        "joined",
        "grid = np.linspace(0, 8, 81)\nfig_5, ax = plt.subplots()\nax.plot(u_1, y_1, label='Data')\n"
        "ax.plot(grid, np.polyval(theta_line, grid))\nax.plot(grid, np.polyval(theta_parabola, "
        "grid))",
        "circles alone",
    ),
    Try(
        F5,
        "joined circles",
        "grid = np.linspace(0, 8, 81)\nfig_5, ax = plt.subplots()\nax.plot(u_1, y_1, '-o')\n"
        "ax.plot(grid, np.polyval(theta_line, grid))\nax.plot(grid, np.polyval(theta_parabola, "
        "grid))",
        "circles alone",
    ),
    Try(
        F5,
        "few points",
        "grid = np.linspace(0, 8, 81)\nfig_5, ax = plt.subplots()\nax.plot(u_1, y_1, 'o')\n"
        "ax.plot(u_1, np.polyval(theta_line, u_1))\nax.plot(u_1, np.polyval(theta_parabola, u_1))",
        "too few points",
    ),
    Try(
        F5,
        "reversed",
        "grid = np.linspace(0, 8, 81)\nfig_5, ax = plt.subplots()\nax.plot(u_1, y_1, 'o')\n"
        "ax.plot(grid, theta_line[0] + theta_line[1] * grid)",
        "reverse order",
    ),
    Try(
        PROJ,
        "inv(Phi Phi^T)",
        f("projector(Phi)", "return Phi.T @ np.linalg.pinv(Phi @ Phi.T) @ Phi"),
        "stands on the outside left.*inverted between them is 2 by 2",
    ),
    Try(PROJ, "pinv", f("projector(Phi)", "return np.linalg.inv(Phi.T @ Phi) @ Phi.T"), "this is the pseudo-inverse"),
    Try(PROJ, "Phi'Phi", f("projector(Phi)", "return Phi.T @ Phi"), "this is Phi'Phi\\."),
    Try(PROJ, "inverse", f("projector(Phi)", "return np.linalg.inv(Phi.T @ Phi)"), "this is the inverse of Phi'Phi"),
    Try(PROJ, "no inverse", f("projector(Phi)", "return Phi @ Phi.T"), "P P is not P"),
    Try(
        PROJ,
        "singular",
        f("projector(Phi)", "return Phi @ np.linalg.inv(Phi @ Phi.T) @ Phi.T"),
        "rank 2 at most|columns",
    ),
    Try(
        PROJ,
        "I - P",
        f("projector(Phi)", "return np.eye(len(Phi)) - Phi @ np.linalg.inv(Phi.T @ Phi) @ Phi.T"),
        "I - P",
    ),
    Try(
        SOL,
        "U",
        f(
            "all_solutions(Phi, Y)",
            "U, s, Vt = np.linalg.svd(Phi)\n    r = np.linalg.matrix_rank(Phi)\n    return "
            "np.linalg.pinv(Phi) @ Y, U[:, r:]",
        ),
        "columns of U",
    ),
    Try(
        SOL,
        "swapped return",
        f(
            "all_solutions(Phi, Y)",
            "Vt = np.linalg.svd(Phi)[2]\n    r = np.linalg.matrix_rank(Phi)\n    return Vt[r:].T, "
            "np.linalg.pinv(Phi) @ Y",
        ),
        "N before theta",
    ),
    Try(
        SOL,
        "V not transposed",
        f(
            "all_solutions(Phi, Y)",
            "V = np.linalg.svd(Phi)[2]\n    r = np.linalg.matrix_rank(Phi)\n    return "
            "np.linalg.pinv(Phi) @ Y, V[:, r:]",
        ),
        "What numpy's `svd` returns is V'",
    ),
    Try(
        SOL,
        "rows",
        f(
            "all_solutions(Phi, Y)",
            "V = np.linalg.svd(Phi)[2]\n    r = np.linalg.matrix_rank(Phi)\n    return np.linalg.pinv(Phi) @ Y, V[r:]",
        ),
        "as rows",
    ),
    Try(
        SOL,
        "inv",
        f("all_solutions(Phi, Y)", "return np.linalg.inv(Phi.T @ Phi) @ Phi.T @ Y, np.eye(3)"),
        "Phi'Phi has no inverse",
    ),
    Try(SOL, "theta only", f("all_solutions(Phi, Y)", "return np.linalg.pinv(Phi) @ Y"), "theta and the matrix N"),
    Try(
        KNOWN, "SUSTech slide: rows off", known("-y[:-3], u[:-3]", "y[2:-1] - u[1:-2]"), r"rows \[-y\(k-2\), u\(k-2\)\]"
    ),
    Try(KNOWN, "same time", known("-y[3:], u[3:]", "y[3:] - u[2:-1]"), r"\[-y\(k\), u\(k\)\]"),
    Try(KNOWN, "lag 1 for y", known("-y[2:-1], u[:-3]"), r"column of a holds y\(k-1\) in place of y\(k-2\)"),
    Try(KNOWN, "sign", known("y[1:-2], u[:-3]"), "wrong sign of a"),
    Try(KNOWN, "known estimated", known("-y[1:-2], u[2:-1], u[:-3]", "y[3:]"), "estimates three"),
    Try(KNOWN, "known forgotten", known(target="y[3:]"), "omits u\\(k-1\\)"),
    Try(KNOWN, "lengths", known("-y[1:-2], u[:-2]"), "number of rows"),
    Try(KNOWN, "last row lost", known("-y[1:-3], u[:-4]", "y[3:-1] - u[2:-2]"), "k = 4 to 19"),
    Try(
        WEI,
        "columns divided",
        f("weighted_fit(Phi, Y, sigma)", "return np.linalg.lstsq(Phi / sigma, Y / sigma)[0]"),
        "np.newaxis",
    ),
    Try(
        WEI,
        "sigma^2",
        f("weighted_fit(Phi, Y, sigma)", "w = sigma[:, None]**2\n    return np.linalg.lstsq(Phi / w, Y / sigma**2)[0]"),
        "weights twice",
    ),
    Try(
        WEI, "Phi only", f("weighted_fit(Phi, Y, sigma)", "return np.linalg.lstsq(Phi / sigma[:, None], Y)[0]"), "not Y"
    ),
    Try(
        WEI,
        "W vector",
        f(
            "weighted_fit(Phi, Y, sigma)",
            "W = 1 / sigma**2\n    return np.linalg.solve(Phi.T @ W @ Phi, Phi.T @ W @ Y)",
        ),
        r"`np\.diag\(W\)`",
    ),
    Try(
        WEI,
        "W of sigma",
        f(
            "weighted_fit(Phi, Y, sigma)",
            "W = np.diag(sigma)\n    return np.linalg.solve(Phi.T @ W @ Phi, Phi.T @ W @ Y)",
        ),
        "largest weights",
    ),
    Try(WEI, "unweighted", f("weighted_fit(Phi, Y, sigma)", "return np.linalg.lstsq(Phi, Y)[0]"), "does not use sigma"),
    Try(CON, "Y not Phi.T Y", kkt("np.concatenate([Y, b])"), "solves A x = b"),
    Try(CON, "last p", kkt(end="[-p:]"), "\\*last\\* p"),
    Try(CON, "multipliers", kkt(end=""), "multipliers together"),
    Try(
        CON,
        "no constraint",
        f("constrained_fit(Phi, Y, A, b)", "return np.linalg.lstsq(Phi, Y)[0]"),
        "ignores the constraint",
    ),
    Try(
        CON,
        "as rows",
        f("constrained_fit(Phi, Y, A, b)", "return np.linalg.lstsq(np.vstack([Phi, A]), np.r_[Y, b])[0]"),
        "further rows",
    ),
    Try(
        CON,
        "as heavy rows",
        f("constrained_fit(Phi, Y, A, b)", "return np.linalg.lstsq(np.vstack([Phi, 1e4 * A]), np.r_[Y, 1e4 * b])[0]"),
        "meets the constraint only nearly",
    ),
    Try(CON, "corner", kkt(corner="0"), "same number of dimensions|dimensions|shape|stopped"),
    Try(CON, "minus b", kkt("np.concatenate([Phi.T @ Y, -b])"), "-b"),
    Try(CON, "identity corner", kkt(corner="np.eye(r)"), "does not satisfy it"),
    Try(CONF, "no inverse", conf(cov="Phi.T @ Phi"), "Phi'Phi is not inverted"),
    Try(CONF, "N-1", conf("E @ E / (N - 1)"), "divided by n - 1"),
    Try(CONF, "level", conf(q="scipy.stats.t.ppf(level, N - p)"), "quantile at `level`"),
    Try(CONF, "normal", conf(q="scipy.stats.norm.ppf((1 + level) / 2)"), "normal distribution"),
    Try(
        CONF,
        "two at once",
        conf("E @ E / N", "scipy.stats.norm.ppf((1 + level) / 2)"),
        "normal one and the SSE is divided by n",
    ),
    Try(CONF, "no root", conf(root=""), "variances"),
    Try(CONF, "half only", conf(end="theta, -half, half"), "half width"),
    Try(CONF, "sum of squares", conf("E @ E"), "SSE is not divided"),
    Try(CAY, "order", f("inverse_weights(A)", "c = np.poly(A)\n    return -c[:-1] / c[-1]"), "highest power"),
    Try(CAY, "sign", f("inverse_weights(A)", "c = np.poly(A)\n    return c[:-1][::-1] / c[-1]"), "has the wrong sign"),
    Try(CAY, "all", f("inverse_weights(A)", "return np.poly(A)"), "n \\+ 1 numbers"),
    Try(CAY, "inverse", f("inverse_weights(A)", "return np.linalg.inv(A)"), "returns a matrix"),
    Try(CAY, "no division", f("inverse_weights(A)", "c = np.poly(A)\n    return -c[:-1][::-1]"), "division by c_n"),
    Try(
        CAY,
        "other end",
        f("inverse_weights(A)", "c = np.poly(A)\n    return -c[1:][::-1] / c[-1]"),
        "c_n as the weight of I",
    ),
    Try(
        KIND,
        "determinant and corner",
        "def kind(M):\n    S = (M + M.T) / 2\n    d = np.linalg.det(S)\n    if abs(d) < 1e-9:\n"
        "        return 'positive semidefinite' if S[0, 0] >= 0 else 'negative semidefinite'\n"
        "    if d < 0:\n        return 'indefinite'\n"
        "    return 'positive definite' if S[0, 0] > 0 else 'negative definite'\n",
        "enough for two by two alone",
    ),
    Try(
        KIND,
        "semidefinite asked first",
        "def kind(M):\n    w = np.linalg.eigvalsh((M + M.T) / 2)\n    if np.all(w >= -1e-10):\n"
        "        return 'positive semidefinite'\n    if np.all(w <= 1e-10):\n        return 'negative semidefinite'\n"
        "    if np.all(w > 0):\n        return 'positive definite'\n    return 'indefinite'\n",
        "only where it is not definite",
    ),
    Try(
        KIND,
        "definite only if large",
        "def kind(M):\n    w = np.linalg.eigvalsh((M + M.T) / 2)\n    if np.all(w > 1):\n"
        "        return 'positive definite'\n"
        "    return 'positive semidefinite' if np.all(w >= -1e-9) else 'indefinite'\n",
        "is wrong for",
        never="ask first|two by two",
    ),
    Try(
        DER,
        "3 x^2 on the diagonal",
        "def gradient_form(A, x):\n    return A @ x + A.T @ x\n\n\n"
        "def jacobian_cubic(x):\n    return np.diag(3 * x**2)\n",
        "zero off its diagonal",
    ),
    Try(
        CONF,
        "1.96 for every level",
        "def confidence(Phi, Y, level):\n    N, p = Phi.shape\n    theta = np.linalg.lstsq(Phi, Y)[0]\n"
        "    E = Y - Phi @ theta\n    s = np.sqrt(E @ E / (N - p) * np.diag(np.linalg.inv(Phi.T @ Phi)))\n"
        "    return theta, theta - 1.96 * s, theta + 1.96 * s\n",
        "1.96, whatever `level`",
    ),
    Try(
        CON,
        "number for a corner",
        "def constrained_fit(Phi, Y, A, b):\n    K = np.block([[Phi.T @ Phi, A.T], [A, 0]])\n"
        "    return np.linalg.solve(K, np.concatenate([Phi.T @ Y, b]))[: Phi.shape[1]]\n",
        "corner `0` has shape \\(1, 1\\).*shape \\(2, 2\\)",
        never="slice",
    ),
    Try(
        CON,
        "corner as large as A",
        kkt(corner="np.zeros(A.shape)"),
        "row 0 of blocks is 3 . 1 = 4 wide, row 1 of blocks is 3 . 3 = 6 wide.*as many columns as `A.T`: shape .1, 1",
    ),
    Try(
        CON,
        "corner of too many rows",
        kkt(corner="np.zeros((p, r))"),
        "row 1 of blocks .counted from 0. has blocks of 1 and 3 rows.*shape .1, 1",
        never="wide",
    ),
    Try(
        SOL,
        "solve",
        "def all_solutions(Phi, Y):\n    theta = np.linalg.solve(Phi.T @ Phi, Phi.T @ Y)\n"
        "    return theta, np.linalg.svd(Phi)[2][np.linalg.matrix_rank(Phi) :].T\n",
        "Phi'Phi has no inverse",
        never="wrong factor",
    ),
    Try(DEL, "zeros +", f("delayed_inputs(u, n)", lags("np.zeros(i) + u[: len(u) - i]", "n")), "join them"),
    Try(
        DEL,
        "u[:-i] in an array",
        f("delayed_inputs(u, n)", "return np.array([u[:len(u) - i] for i in range(n)]).T"),
        r"inhomogeneous.*that of u\(t-i\) begins with i zeros",
        never="Side by side",
    ),
    Try(
        DEL,
        "zeros and u[:-i]",
        f("delayed_inputs(u, n)", "return np.column_stack([np.r_[np.zeros(i), u[:-i]] for i in range(n)])"),
        "with i = 0, `.*` takes nothing",
        never="begin below zero",
    ),
    Try(
        DEL,
        "n + 1",
        f("delayed_inputs(u, n)", lags("np.r_[np.zeros(i), u[: len(u) - i]]", "n + 1")),
        "one too many",
    ),
    Try(FITS, "p to the x", fits("[float(p)**x for p in powers]"), r"columns p\*\*x"),
    Try(
        SOL,
        "s > 0",
        f(
            "all_solutions(Phi, Y)",
            "V = np.linalg.svd(Phi)\n    return np.linalg.pinv(Phi) @ Y, V[2][np.sum(V[1] > 0) :].T",
        ),
        "computed as about 1e-16",
    ),
    Try(
        WEI, "flat W", f("weighted_fit(Phi, Y, sigma)", f"W = 1 / sigma**2\n    return {WEIGHTED}"), r"`np\.diag\(W\)`"
    ),
    Try(
        WEI,
        "diagonal W",
        f("weighted_fit(Phi, Y, sigma)", f"W = np.diag(1 / sigma**2)\n    return {WEIGHTED}"),
        "",
        ACCEPTED,
    ),
    Try(CONF, "np.var", conf("np.var(E)"), r"`np\.var` takes the mean off"),
    Try(CONF, "cdf", conf(q="scipy.stats.t.cdf((1 + level) / 2, N - p)"), "`cdf` stands where `ppf`"),
    Try(CONF, "np.var, ddof=1", conf("np.var(E, ddof=1)"), "divides by n - 1"),
    Try(
        DEL,
        "not shifted",
        f("delayed_inputs(u, n)", lags("np.r_[np.zeros(i), u[i:]]", "n")),
        "u\\(t\\) itself with its first i entries zero",
    ),
    Try(
        KIND,
        "leading minors",
        kind("np.array([np.linalg.det(((M + M.T) / 2)[:i, :i]) for i in range(1, len(M) + 1)])"),
        "leading minors. Of a negative definite",
    ),
    Try(
        KIND,
        "leading minors, alternating",
        "def kind(M):\n    S, n = (M + M.T) / 2, len(M)\n"
        "    d = np.array([np.linalg.det(S[:i, :i]) for i in range(1, n + 1)])\n"
        "    e = d * (-1.0) ** np.arange(1, n + 1)\n"
        "    if np.all(d > 0): return 'positive definite'\n    if np.all(e > 0): return 'negative definite'\n"
        "    if np.all(d >= 0): return 'positive semidefinite'\n"
        "    if np.all(e >= 0): return 'negative semidefinite'\n    return 'indefinite'\n",
        "leading minors. If one",
    ),
    Try(
        DEL,
        "a column of lag n",
        f("delayed_inputs(u, n)", lags("np.r_[np.zeros(i), u[: len(u) - i]]", "n + 1")),
        "one too many",
    ),
    Try(
        DEL,
        "a column of lag -1",
        f(
            "delayed_inputs(u, n)",
            "return np.column_stack([np.r_[u[1:], 0]] + [np.r_[np.zeros(i), u[: len(u) - i]] for i in range(n)])",
        ),
        r"Column `\[:, 0\]` is one too many",
    ),
    Try(
        DEL,
        "other columns, and too many",
        f("delayed_inputs(u, n)", "return np.column_stack([u * i for i in range(n + 1)])"),
        "One column too many",
        never="without it",
    ),
    Try(
        KNOWN,
        "twenty samples",
        f("example_1(u, y)", "u, y = u[:20], y[:20]\n    " + known()[known().index("return") :].strip()),
        "first 20 of the 35 samples",
    ),
    Try(
        CAY,
        "determinant",
        f("inverse_weights(A)", "c = np.poly(A)\n    return -c[:-1][::-1] / np.linalg.det(A)"),
        "right for 2 by 2.*determinant",
    ),
    Try(
        CAY,
        "sign",
        f("inverse_weights(A)", "c = np.poly(A)\n    return c[:-1][::-1] / c[-1]"),
        "has the wrong sign",
        never="determinant",
    ),
    Try(CAY, "c_1 to c_n", f("inverse_weights(A)", "c = np.poly(A)\n    return -c[1:] / c[-1]"), "begins with c_1"),
    Try(CAY, "eigenvalues", f("inverse_weights(A)", "return 1 / np.linalg.eigvals(A)"), "eigenvalues of the inverse"),
    Try(
        KIND,
        "determinant alone",
        "def kind(M):\n    d = np.linalg.det(M)\n    if d > 0: return 'positive definite'\n"
        "    return 'indefinite' if d < 0 else 'positive semidefinite'\n",
        "uses the determinant, the product",
    ),
    Try(
        CAY,
        "one weight short",
        f("inverse_weights(A)", "c = np.poly(A)\n    return -c[1:-1][::-1] / c[-1]"),
        "returns 1 number for 2 powers",
    ),
    Try(CONF, "sigma", conf(s2="np.sqrt(E @ E / (N - p))"), "inverse of Phi'Phi by sigma"),
    Try(
        CAY,
        "first coefficient",
        f("inverse_weights(A)", "c = np.poly(A)\n    return -c[1:][::-1] / c[0]"),
        "which is 1",
    ),
    Try(FITS, "y'y", fits(result="theta, y @ y"), "is y'y"),
    Try(
        FITS,
        "x explained by y",
        fits("[y**p for p in powers]", E="x - Phi @ theta").replace("(Phi, y)", "(Phi, x)"),
        "fits x to y",
    ),
    Try(
        F5,
        "grid between the points",
        "grid = np.linspace(2, 6, 41)\nfig_5, ax = plt.subplots()\nax.plot(u_1, y_1, 'o', label='data')\n"
        "ax.plot(grid, np.polyval(theta_line, grid), label='line')\n"
        "ax.plot(grid, np.polyval(theta_parabola, grid), label='parabola')\nax.set(xlabel='u', ylabel='y')\n"
        "ax.legend()",
        "does not cover all points",
    ),
)
