"""Repairs that are tried before they are proposed, sentences that the values prove, and their neighbours."""

from tries import TAUGHT, Try, edited

TRIES: dict[str, tuple[Try, ...]] = {
    "armax-and-instruments": (
        Try(
            "ai-3-limit",
            "the numbers of System 2 in place of the arguments",
            """\
def limit_of_least_squares(a, b, c, var_u, var_e):
    var_u = 4 / 3
    var_y = (var_u + 1 + c**2 - 2 * a * c) / (1 - a**2)
    return a - c / var_y, b
""",
            "sets its argument `var_u` before it reads it",
            TAUGHT,
            "",
        ),
        Try(
            "ai-4-covariance",
            "sigma^2",
            """\
def covariance(Phi, c, var_e):
    return var_e * (1 + c**2) * np.linalg.inv(Phi.T @ Phi)
""",
            r"\(1 \+ c\^2\) var_e \(Phi'Phi\)\^-1",
            TAUGHT,
            "is the one for white noise",
        ),
        Try(
            "ai-8-recursive",
            "z z' in the numerator",
            edited("ai-8-recursive", ("phi @ P)", "P @ z)")),
            "has P z z'P above",
            TAUGHT,
            "has P phi",
        ),
        Try(
            "ai-8-recursive",
            "right factor P phi instead of phi' P, gain with phi",
            edited("ai-8-recursive", ("phi @ P)", "P @ phi)"), ("P @ z * epsilon", "P @ phi * epsilon")),
            "and for P z in the gain",
            TAUGHT,
            "z z'P",
        ),
        Try(
            "ai-9-likelihood",
            "Phi theta star",
            """\
def log_likelihood(theta, var_e, Phi, Y):
    N = len(Y)
    E = Y - theta * Phi
    return -N / 2 * np.log(2 * np.pi * var_e) - E.T @ E / (2 * var_e)
""",
            "matrix and the vector is `Phi @ theta`",
            TAUGHT,
            "np.newaxis",
        ),
        Try(
            "ai-9-likelihood",
            "a name in two operations",
            """\
def log_likelihood(theta, var_e, Phi, Y):
    E = Y[:-1] - Phi @ theta
    return -len(Y) / 2 * np.log(2 * np.pi * var_e) - E @ E / (2 * var_e)
""",
            "5 entries and `Phi @ theta` has 6",
            TAUGHT,
            "meant",
        ),
    ),
    "least-squares": (
        Try(
            "ls-5-projector",
            "transposes in the wrong order",
            """\
def projector(Phi):
    return Phi.T @ np.linalg.inv(Phi.T @ Phi) @ Phi
""",
            r"Is `Phi @ np.linalg.inv\(Phi.T @ Phi\) @ Phi.T` meant",
            TAUGHT,
            r"Is `np.linalg.inv\(Phi.T @ Phi\) @ Phi.T`",
        ),
        Try(
            "ls-10-confidence",
            "divides by N and takes the quantile at the level itself",
            """\
def confidence(Phi, Y, level):
    N, p = Phi.shape
    theta = np.linalg.lstsq(Phi, Y)[0]
    E = Y - Phi @ theta
    s2 = E @ E / N
    s = np.sqrt(np.diag(s2 * np.linalg.inv(Phi.T @ Phi)))
    q = scipy.stats.t.ppf(level, N - p)
    return theta, theta - q * s, theta + q * s
""",
            "at `level` and the SSE is divided by n",
            TAUGHT,
            "times one factor",
        ),
        Try(
            "ls-10-confidence",
            "stats without scipy.",
            """\
def confidence(Phi, Y, level):
    N, p = Phi.shape
    theta = np.linalg.lstsq(Phi, Y)[0]
    s2 = np.sum((Y - Phi @ theta) ** 2) / (N - p)
    s = np.sqrt(s2 * np.diag(np.linalg.inv(Phi.T @ Phi)))
    q = t.ppf((1 + level) / 2, N - p)
    return theta, theta - q * s, theta + q * s
""",
            "`scipy.stats.t.ppf`",
            TAUGHT,
            "compute it",
        ),
        Try(
            "ls-10-confidence",
            "an unknown t with a mean",
            """\
def confidence(Phi, Y, level):
    theta = t.mean()
    return theta, theta - level, theta + level
""",
            "neither a line before this one nor a cell",
            TAUGHT,
            "scipy.stats",
        ),
    ),
    "model-structures": (
        Try(
            "ms-3-state-space",
            "num shorter than den not padded",
            """\
def state_space(num, den):
    b = np.array(num) / den[0]
    a = np.array(den) / den[0]
    n = len(a) - 1
    A = np.eye(n, k=1)
    A[-1] = -a[:0:-1]
    B = np.zeros((n, 1))
    B[-1] = 1
    C = (b - b[0] * a)[:0:-1].reshape(1, n)
    return A, B, C, np.array([[b[0]]])
""",
            "must be of equal length",
            TAUGHT,
            "same samples|cut",
        ),
        Try(
            "ms-8-order",
            "each order on its own rows, and the sum instead of the mean",
            """\
def losses(u, y, orders):
    V = []
    for n in orders:
        Phi, Y = equations(u, y, n, n, 1)
        theta = np.linalg.lstsq(Phi, Y)[0]
        V.append(np.sum((Y - Phi @ theta) ** 2))
    return np.array(V)


def criteria(V, N, p):
    return N * np.log(V) + 2 * p, N * np.log(V) + p * np.log(N), V * (1 + p / N) / (1 - p / N)
""",
            "returns sums, each over all rows",
            TAUGHT,
            "",
        ),
        Try(
            "ms-10-autocorrelation",
            "each sum divided by its own number of products, and the mean not removed",
            """\
def autocorrelation(e, lags):
    N = len(e)
    r = []
    for k in range(lags + 1):
        r.append(np.mean(e[k:] * e[:N - k]) / np.mean(e**2))
    return np.array(r)
""",
            "mean of the N - k products",
            TAUGHT,
            "",
        ),
    ),
    "nonlinear-least-squares": (
        Try(
            "nl-1-logarithm",
            "log10, and b before a",
            """\
def fit_logarithm(x, y):
    p = np.polyfit(x, np.log10(y), 1)
    return 10 ** p[1], p[0]
""",
            r"returns \[b, a\] in place of",
            TAUGHT,
            "",
        ),
        Try(
            "nl-7-layout",
            "compares the first two slopes; a vertical line divides by zero, too few beacons index out",
            """\
def layout(beacons):
    if len(beacons) == 1:
        return "undetermined"
    m = (beacons[1, 1] - beacons[0, 1]) / (beacons[1, 0] - beacons[0, 0])
    m2 = (beacons[2, 1] - beacons[0, 1]) / (beacons[2, 0] - beacons[0, 0])
    if m == m2:
        return "mirror"
    return "unique"
""",
            "`beacons` is handed over, here with 2 rows",
            TAUGHT,
            r"the last is `\[-1\]`",
        ),
        Try(
            "nl-9-output-error",
            "lfilter's coefficients as separate arguments",
            """\
def fit_output_error(u, y):
    th0 = np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1]]), y[1:])[0]
    def err(th):
        return scipy.signal.lfilter(0, th[1], 1, th[0], u) - y
    return scipy.optimize.least_squares(err, th0).x
""",
            r"here these are `0`, `th\[1\]` and `1`",
            TAUGHT,
            "",
        ),
    ),
    "postlab-model-order": (
        Try(
            "postlab-3-figure-8",
            "adds a float to a text",
            """\
fig_8, ax = plt.subplots(figsize=(8, 4))
ax.plot(t, y, label="y")
ax.plot(t, y_sim_1, label="order 1")
ax.plot(t, y_sim_2, label="order 2")
ax.set_xlabel("Time (s)"); ax.set_ylabel("Output (V)")
ax.legend()
ax.text(0.02, 0.97, "order 1: MSE = " + mse_1 + ", order 2: MSE = " + mse_2, transform=ax.transAxes, va="top")
""",
            r"`str\(mse_1\)` is one",
            TAUGHT,
            "without quotes",
        ),
    ),
    "several-signals": (
        Try(
            "sev-5-run",
            "adds a list and an array",
            """\
def simulate_output(theta, u, n):
    y = 0
    for j in range(u.shape[1]):
        b = theta[n + j * n : n + (j + 1) * n]
        y = y + scipy.signal.lfilter([0] + b, [1] + (-theta[:n]), u[:, j])
    return y
""",
            "adds entry by entry, and joins nothing",
            TAUGHT,
            "",
        ),
        Try(
            "sev-3-phi",
            "row instead of column",
            """\
def regressor(u, y, i, n):
    N, nu = u.shape
    yi = y[i]
    cols = [yi[n - l:N - l] for l in range(1, n + 1)]
    for j in range(nu):
        cols += [u[n - l:N - l, j] for l in range(1, n + 1)]
    return np.column_stack(cols), yi[n:]
""",
            r"`y\[i\]` is a row of `y`, with 2 entries",
            TAUGHT,
            "b - a of them",
        ),
        Try(
            "sev-5-run",
            "double: no delay and sign",
            """\
def simulate_output(theta, u, n):
    out = np.zeros(len(u))
    den = np.concatenate([[1], theta[:n]])
    for j in range(u.shape[1]):
        out += scipy.signal.lfilter(theta[n + j * n:n + j * n + n], den, u[:, j])
    return out
""",
            r"lets u\(k\) move y\(k\), and takes the -a of theta for a",
            TAUGHT,
            "",
        ),
    ),
    "sim-to-real-gap": (
        Try(
            "gap-3-time",
            "sums the error, not its square",
            """\
def time_shares(e, parts):
    s = np.array([np.sum(p) for p in np.split(e, parts)])
    return s / np.sum(e)


share_t = time_shares(e, 16)
i = np.argmax(share_t)
worst = (i * N / 16 * Ts, (i + 1) * N / 16 * Ts)
""",
            "the errors themselves, with their signs",
            TAUGHT,
            "absolute",
        ),
    ),
    "step-response": (
        Try(
            "step-5-function",
            "the level y_end of the hint never computed",
            """\
def read_step(t, y, amplitude):
    y_start = y[0]
    way = (y - y_start) / (y_end - y_start)
    K = (y_end - y_start) / amplitude
    t63 = t[np.argmax(way >= 0.632)]
    t28 = t[np.argmax(way >= 0.283)]
    tau = 1.5 * (t63 - t28)
    td = t63 - tau
    return K, tau, td
""",
            "reads `y_end`, which is no argument",
            TAUGHT,
            "",
        ),
    ),
    "recursive-identification": (
        Try(
            "ri-5-forgetting",
            "eye with LN",
            """\
def rls(Phi, Y, lam, LN):
    n, p = Phi.shape
    theta = np.zeros(p)
    P = np.eye(LN)
    history = np.zeros((n, p))
    for k in range(n):
        phi = Phi[k, :]
        Pp = P @ phi
        P = 1 / lam * (P - np.outer(Pp, Pp) / (lam + phi @ Pp))
        theta = theta + P @ phi * (Y[k] - phi @ theta)
        history[k] = theta
    return history


theta_1 = rls(Phi_61, Y_61, 1.0, 1e6)
theta_099 = rls(Phi_61, Y_61, 0.99, 1e6)
""",
            "`np.eye` takes a size",
            TAUGHT,
            "print what stands",
        ),
    ),
}
