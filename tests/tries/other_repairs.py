"""First tries whose message proposed another repair than the one that mends them, or none."""

from tries import TAUGHT, Try
from tries.rows_of_tries import in_rows

_LOOP = "def first_period(u):\n    {}\n    return n\n\n\nn_first = first_period(u_act)\n"
_SAME = "is the same slice for any other value"
_SUMS = "np.array([e[k:] @ e[: N - k] for k in range(lags + 1)]) / (e @ e)"
_ALL = "`autocorrelation` sums the same N - lags products"


def _weighted(weights: str, last: str) -> str:
    return f"def weighted_fit(Phi, Y, sigma):\n    W = {weights}\n    return {last}\n"


def _correlated(changed: str) -> tuple[tuple[str, str], ...]:
    return ((_SUMS, changed),)


TRIES: dict[str, tuple[Try, ...]] = {
    "prelab-sinusoids": in_rows(
        ("prelab-1-time", "no step", "start and stop, and the step is 1. .* 1001 are asked",
         "t = np.arange(0, 100).reshape(1001, 1)"),
        ("prelab-1-time", "stop left out", "the stop, `100`, is left out. 1001 are asked for",
         "t = np.arange(0, 100, 0.1).reshape(1001, 1)"),
        ("prelab-1-time", "no number", "without a third number it makes 50",
         "t = np.linspace(0, 100).reshape(1001, 1)"),
        ("prelab-1-time", "colons in a call", "between the arguments of a function stand commas",
         "t = np.arange(0:0.1:100)"),
        ("prelab-2-noise", "the generator is called", "`rng` is no function",
         "y1 = np.sin(0.02 * np.pi * t) + rng(-0.2, 0.2, t.shape)"),
        ("prelab-4-function", "a field of a table", r"a column is taken by its number, `rest\[:, 0\]`",
         "def cut_off(data, n):\n    rest = data[n:]\n    rest.t = rest.t - rest.t[0]\n    return rest\n"),
        ("prelab-5-original", "drawn by the figure", "`fig_1` is the figure. .* belong to its axes",
         (("ax_a.plot", "fig_1.plot"),)),
    ),
    "lab-identification": (
        *in_rows(
            ("lab-2b-theta", "solve with N by N", "`Phi @ Phi.T` is|never has an inverse",
             "theta_hat = np.linalg.solve(Phi @ Phi.T, Phi.T @ Y)"),
            ("lab-2b-theta", "N by N in a variable", "`R`, made by `R = Phi @ Phi.T`, is 449 by 449",
             "R = Phi @ Phi.T\ntheta_hat = np.linalg.inv(R) @ Phi.T @ Y"),
            ("lab-1c-loop", "compared with itself", r"`u\[n\]` with itself, and is always true",
             _LOOP.format("n = 1\n    while u[n] == u[n]:\n        n = n + 1")),
            ("lab-1c-loop", "part of the record", r"held for all of them. `u` is handed over by the call .*u_act\[:5\]",
             _LOOP.format("n = 1\n    while u[n] == u[0]:\n        n = n + 1").replace("u_act", "u_act[:5]")),
            ("lab-1c-offsets", "a function for an index", r"`first_period` is a function",
             (("u_act[0]", "u_act[first_period]"),)),
            ("lab-3b-initial-state", "three states", "one number for each state",
             "def simulate_from_start(u, y):\n"
             "    return ct.forced_response(G_ss, inputs=u, initial_state=[y[0], y[1], 0]).outputs\n"),
            ("lab-3a-all", "input first", "takes the system first",
             (("ct.forced_response(G, inputs=u)", "ct.forced_response(u, G)"),)),
        ),
        Try(
            "lab-2b-theta",
            "right side of N by N",
            "theta_hat = np.linalg.solve(Phi @ Phi.T, Phi.T @ Y)",
            "`Phi @ Phi.T` is|never has an inverse",
            TAUGHT,
            "right-hand side of the normal equations",
        ),
    ),
    "postlab-model-order": in_rows(
        ("postlab-2-fit-order", "a row of arrays", "`Phi\\[k\\]` is one row of 4 numbers",
         "def fit_order(u, y, n):\n    Phi = np.zeros((len(y), 2 * n))\n    for k in range(n, len(y)):\n"
         "        Phi[k] = [y[k - n : k], u[k - n : k]]\n    return np.linalg.lstsq(Phi, y)[0]\n\n\n"
         "theta_2 = fit_order(u[:half], y[:half], 2)\n"),
    ),
    "step-response": in_rows(
        ("step-1-read", "interpolated the other way", "made of outputs, read at times",
         "y_end = y_step[-1]\nK = y_end / amplitude\nt_28 = np.interp(0.283 * y_end, t_step, y_step)\n"
         "t_63 = np.interp(0.632 * y_end, t_step, y_step)\ntau = 1.5 * (t_63 - t_28)\ntd = t_63 - tau"),
        ("step-1-read", "a number among the points", "takes first where a value is asked for",
         "y_end = y_step[-1]\nt_63 = np.interp(t_step, y_step, 0.632 * y_end)\nK, tau, td = 1.0, t_63, 0.0"),
        ("step-1-read", "no entry is equal", "No entry meets the condition .* hardly ever equal",
         "t_63 = t_step[np.where(y_step == 0.632 * y_step[-1])[0][0]]\nK, tau, td = 1.0, t_63, 0.0"),
        ("step-2-response", "math", "not needed: numpy has `np.exp`",
         (("np.exp", "math.exp"),)),
        ("step-5-function", "called with lists", r"`y` is handed over by the call `read_step\(\[0, 1\]",
         "def read_step(t, y, amplitude):\n    way = (y - y[0]) / (y[-1] - y[0])\n    return way[0], 1.0, 0.0\n\n\n"
         "read_step([0, 1], [0, 1], 1.0)\n"),
    ),
    "least-squares": in_rows(
        ("ls-5-projector", "a name for the transpose", "`PT @ Phi` is 2 by 2",
         "def projector(Phi):\n    PT = Phi.T\n    G = np.linalg.inv(Phi @ PT)\n    return Phi @ G @ PT\n"),
        ("ls-8-weighted", "weights of p", r"Between `Phi.T` and `Phi` a square matrix is 9 by 9",
         _weighted("np.eye(Phi.shape[1])", "np.linalg.solve(Phi.T @ W @ Phi, Phi.T @ Y)")),
        ("ls-8-weighted", "weights on the other side", "`W` is made by .* and between `Phi.T` and `Phi` 9 by 9",
         _weighted("np.diag(1 / sigma**2)", "np.linalg.inv(Phi @ W @ Phi.T) @ Phi.T @ W @ Y")),
        ("ls-9-constrained", "A not transposed", "Is `G @ A.T` meant",
         "def constrained_fit(Phi, Y, A, b):\n    G = np.linalg.inv(Phi.T @ Phi)\n    theta = G @ Phi.T @ Y\n"
         "    lam = np.linalg.inv(A @ G @ A.T) @ (A @ theta - b)\n    return theta - G @ A @ lam\n"),
        ("ls-9-constrained", "flat arrays below each other", "same number of columns: .* counts as one row",
         "def constrained_fit(Phi, Y, A, b):\n"
         "    return np.linalg.lstsq(np.vstack([Phi, A]), np.vstack([Y, b]))[0]\n"),
        ("ls-2-delays", "empty at the first", f"With i = 0, .* {_SAME}", (("u[: N - i]", "u[:-i]"),)),
        ("ls-4-figure-5", "points first", "takes the coefficients first",
         (("np.polyval(theta_parabola, grid)", "np.polyval(grid, theta_parabola)"),)),
        ("ls-6-all-solutions", "null", "scipy.linalg.null_space",
         (("Vt[rank:].T", "null(Phi)"),)),
    ),
    "model-structures": in_rows(
        ("ms-9-cancel", "no break", "The list does not hold it. .* leave the inner loop: `break`",
         "def cancel(P, Q, within):\n    p, q = list(np.roots(P)), list(np.roots(Q))\n    for rp in list(p):\n"
         "        for rq in list(q):\n            if abs(rp - rq) < within:\n                p.remove(rp)\n"
         "                q.remove(rq)\n    return np.poly(p).real, np.poly(q).real\n"),
        ("ms-2-shift", "empty at the first", f"With i = 0, .* {_SAME}",
         "def apply(P, x):\n    y = np.zeros(len(x))\n    for i in range(len(P)):\n"
         "        y[i:] += P[i] * x[:-i]\n    return y\n"),
        ("ms-3-state-space", "order", r"`n = len\(den\)`. .*order len\(den\) - 1", (("len(den) - 1", "len(den)"),)),
        ("ms-3-state-space", "order of the numerator", r"made it, with `n = len\(num\)`\.$",
         (("len(den) - 1", "len(num)"),)),
        ("ms-5-simulate", "begins below zero", "is -2, and an index below zero counts from the end",
         "def simulate(A, B, C, u, e):\n    y = np.zeros(len(u))\n    for k in range(len(u)):\n"
         "        y[k] = B @ u[k - len(B) + 1 : k + 1][::-1] + C @ e[k - len(C) + 1 : k + 1][::-1]\n    return y\n"),
        ("ms-8-order", "ln", "`np.log\\(x\\)`, the natural logarithm", (("np.log(V)", "ln(V)"),)),
        ("ms-10-autocorrelation", "first products", _ALL,
         _correlated("np.array([e[k : N - lags + k] @ e[: N - lags] for k in range(lags + 1)]) / (e @ e)")),
        ("ms-10-autocorrelation", "first products over theirs", _ALL,
         _correlated("np.array([e[k : N - lags + k] @ e[: N - lags] for k in range(lags + 1)]) / "
                     "(e[: N - lags] @ e[: N - lags])")),
        ("ms-10-autocorrelation", "last products", _ALL,
         _correlated("np.array([e[lags:] @ e[lags - k : N - k] for k in range(lags + 1)]) / (e[lags:] @ e[lags:])")),
        ("ms-10-autocorrelation", "one product less", "leaves out the last product",
         _correlated("np.array([sum(e[i] * e[i + k] for i in range(N - k - 1)) for k in range(lags + 1)]) / (e @ e)")),
        ("ms-10-autocorrelation", "own squares", "squares of its own N - k samples",
         _correlated("np.array([e[k:] @ e[: N - k] / np.sqrt((e[k:] @ e[k:]) * (e[: N - k] @ e[: N - k])) "
                     "for k in range(lags + 1)])")),
        ("ms-10-autocorrelation", "N - 1", "once by N - 1 and once by N",
         _correlated("np.array([e[k:] @ e[: N - k] for k in range(lags + 1)]) / (N - 1) / np.var(e)")),
        ("ms-10-autocorrelation", "ddof", "once by N - 1 and once by N",
         _correlated("np.array([e[k:] @ e[: N - k] for k in range(lags + 1)]) / N / np.var(e, ddof=1)")),
    ),
    "armax-and-instruments": in_rows(
        ("ai-4-covariance", "R of p", "`R` is made by .* Between `Phi.T` and `Phi` a square matrix is 7 by 7",
         (("N = len(Phi)", "N = Phi.shape[1]"),)),
        ("ai-4-covariance", "inverse of N by N", "of rank 2 at most", (("inv(Phi.T @ Phi)", "inv(Phi @ Phi.T)"),)),
        ("ai-7-iterated", "N by N", "`Z.T @ Phi` is 2 by 2", (("Z.T @ Phi", "Z @ Phi.T"),)),
        ("ai-3-limit", "product missing", "calls it: a product needs its",
         "def limit_of_least_squares(a, b, c, var_u, var_e):\n    return (1 + c**2 - 2 * a * c)(var_e), b\n"),
    ),
    "nonlinear-least-squares": in_rows(
        ("nl-1-logarithm", "math.log", "`np.log`, the natural logarithm", (("np.log(y)", "math.log(y)"),)),
        ("nl-4-damping", "N by N", "`JJ` is made by `JJ = J @ J.T`", (("J.T @ J\n", "J @ J.T\n"),)),
        ("nl-6-frequency", "errors for minimize", "returns one number, such as the sum of the squares",
         "def fit_frequency(t, y, low, high):\n"
         "    return scipy.optimize.minimize(lambda th: np.sin(th[0] * t) - y, [low]).x[0]\n"),
    ),
    "sim-to-real-gap": in_rows(
        ("gap-1-rest", "compared with itself", "with itself, and is always true",
         (("u_act[n_rest] == u_act[0]", "u_act[n_rest] == u_act[n_rest]"),)),
        ("gap-4-frequency", "edges first", "takes the values first, .* and then the edges",
         (("np.histogram(f, edges,", "np.histogram(edges, f,"),)),
        ("gap-4-frequency", "mask in round brackets", r"`P\[m\]`",
         "def band_shares(e, Ts, edges):\n    f = np.fft.rfftfreq(len(e), Ts)\n    P = np.abs(np.fft.rfft(e)) ** 2\n"
         "    m = (f >= edges[0]) & (f < edges[1])\n    return P(m).sum() / P.sum()\n"),
        ("gap-5-operating", "no brackets round a comparison", "each comparison needs brackets of its own",
         "share_u = share_y = e[u_act >= 1.0 & u_act < 2.0]"),
        ("gap-9-closed", "beside deviations", "in volts, beside `y`", (("- y_act)", "- y)"),)),
        ("gap-9-closed", "root handed over", "handed over as the error before is .*`gap_before\\*\\*2`",
         (("gap_before**2", "gap_before"),)),
        ("gap-9-closed", "mean square by another way", "",
         (("gap_before**2", "gap_before * gap_before"),)),
    ),
    "several-signals": in_rows(
        ("sev-3-phi", "empty at the last lag", "With n - lag = 0",
         "def regressor(u, y, i, n):\n"
         "    cols = [s[n - lag : -(n - lag)] for s in (y[:, i], *u.T) for lag in range(1, n + 1)]\n"
         "    return np.column_stack(cols), y[n:, i]\n"),
        ("sev-6-reference", "instruments of another length", "`Z` is made by",
         (("np.column_stack([r[1:-1], r[:-2]])", "np.column_stack([r[1:], r[:-1]])"),)),
    ),
}  # fmt: skip
