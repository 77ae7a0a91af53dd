"""First tries at the recursive lecture."""

from tries import ACCEPTED, Try

MEAN, INF, STEP, REG, FOR, FIG, ONL, DRI, WIN, CAR = (
    "ri-1-mean", "ri-2-information", "ri-3-step", "ri-4-regressors", "ri-5-forgetting", "ri-6-figures", "ri-7-online",
    "ri-8-drift", "ri-9-windup", "ri-10-careless",
)  # fmt: skip


def f(head: str, body: str) -> str:
    return f"def {head}:\n    {body}\n"


def step(
    P: str = "P - np.outer(q, q) / (1 + phi @ q)",
    K: str = "P @ phi",
    end: str = "theta + K * error, P",
    error: str = "y - phi @ theta",
) -> str:
    return f(
        "rls_step(theta, P, phi, y)", f"error = {error}\n    q = P @ phi\n    P = {P}\n    K = {K}\n    return {end}"
    )


def reg(columns: str = "-y[1:-1], -y[:-2], u[1:-1]", Y: str = "y[2:]") -> str:
    return (
        f("regressors(u, y)", f"return np.column_stack([{columns}]), {Y}") + "\n\nPhi_61, Y_61 = regressors(u_61, y_61)"
    )


def rls(
    P: str = "(P - np.outer(q, q) / (lam + phi @ q)) / lam",
    theta: str = "theta + P @ phi * error",
    start: str = "LN * np.eye(p)",
    store: str = "history[k] = theta",
    end: str = "history",
) -> str:
    return (
        f"def rls(Phi, Y, lam, LN):\n    p = Phi.shape[1]\n    theta, P = np.zeros(p), {start}\n   "
        f" history = np.zeros(Phi.shape)\n"
        f"    for k in range(len(Y)):\n        phi = Phi[k]\n        error = Y[k] - phi @ theta\n  "
        f"      q = P @ phi\n        P = {P}\n"
        f"        theta = {theta}\n        {store}\n    return {end}\n\n\n"
        "theta_1 = rls(Phi_61, Y_61, 1.0, 1e6)\ntheta_099 = rls(Phi_61, Y_61, 0.99, 1e6)"
    )


def online(past: str = "np.array([-y, past[0], u])", P: str = "(P - np.outer(q, q) / (lam + past @ q)) / lam") -> str:
    return f(
        "arx_step(theta, P, past, u, y, lam)",
        f"error = y - past @ theta\n    q = P @ past\n    P = {P}\n    theta = theta + P @ past * "
        f"error\n    return theta, P, {past}",
    )


def drift(
    lag: str = "slope * lam / (1 - lam)",
    mse: str = "lag**2 + sigma**2 * (1 - lam) / (1 + lam)",
    best: str = "lams[np.argmin(tracking_mse(lams, slope, sigma))]",
) -> str:
    return f("tracking_mse(lam, slope, sigma)", f"lag = {lag}\n    return {mse}") + f(
        "best_forgetting(slope, sigma)", f"lams = np.arange(0.5, 0.9995, 0.001)\n    return {best}"
    )


TRIES = (
    Try(MEAN, "n + 1", f("update_mean(theta, n, y)", "return theta + (y - theta) / (n + 1)"), "1/\\(n \\+ 1\\)"),
    Try(MEAN, "middle", f("update_mean(theta, n, y)", "return (theta + y) / 2"), "middle"),
    Try(MEAN, "sum of all", f("update_mean(theta, n, y)", "return (n * theta + y) / n"), "adds y/n"),
    Try(MEAN, "weights", f("update_mean(theta, n, y)", "return (n * theta + y) / (n + 1)"), "1/\\(n \\+ 1\\)"),
    Try(MEAN, "mean of an array", f("update_mean(theta, n, y)", "return np.mean([theta, y])"), "middle"),
    Try(MEAN, "print", f("update_mean(theta, n, y)", "print(theta + (y - theta) / n)"), "returns nothing"),
    Try(INF, "phi @ phi.T", f("add_sample(M, v, phi, y)", "return M + phi @ phi.T, v + phi * y"), "number phi'phi"),
    Try(INF, "phi * phi", f("add_sample(M, v, phi, y)", "return M + phi * phi, v + phi * y"), "entry by entry"),
    Try(INF, "v + y", f("add_sample(M, v, phi, y)", "return M + np.outer(phi, phi), v + y"), "it is phi y"),
    Try(INF, "order", f("add_sample(M, v, phi, y)", "return v + phi * y, M + np.outer(phi, phi)"), "v before M"),
    Try(INF, "M only", f("add_sample(M, v, phi, y)", "return M + np.outer(phi, phi)"), "M and v"),
    Try(
        INF, "phi @ y", f("add_sample(M, v, phi, y)", "return M + np.outer(phi, phi), v + phi @ y"), "`y` is one number"
    ),
    Try(STEP, "brackets", step("P - np.outer(q, q) / 1 + phi @ q"), "brackets"),
    Try(STEP, "q @ q", step("P - q @ q / (1 + phi @ q)"), "a number where the matrix"),
    Try(STEP, "no 1", step("P - np.outer(q, q) / (phi @ q)"), "the 1 is missing"),
    Try(STEP, "old gain", step(K="q"), "P before the sample"),
    Try(STEP, "divided twice", step(K="P @ phi / (1 + phi @ P @ phi)"), "divides the gain"),
    Try(STEP, "sign", step(error="phi @ theta - y"), "moves away"),
    Try(
        STEP,
        "inverted",
        f(
            "rls_step(theta, P, phi, y)",
            "P = np.linalg.inv(np.linalg.inv(P) + np.outer(phi, phi))\n    return theta + P @ phi * "
            "(y - phi @ theta), P",
        ),
        "inverts P",
    ),
    Try(REG, "plus", reg("y[1:-1], y[:-2], u[1:-1]"), "has \\+y"),
    Try(REG, "lengths", reg("-y[1:], -y[:-2], u[1:-1]"), "number of rows"),
    Try(REG, "Y whole", reg(Y="y"), "10 rows of Phi and 12 of Y.*What is wrong is Y"),
    Try(REG, "u now", reg("-y[1:-1], -y[:-2], u[2:]"), r"third column holds u\(t\), and should hold u\(t-1\)"),
    Try(REG, "u too old", reg("-y[1:-1], -y[:-2], u[:-2]"), r"third column holds u\(t-2\)", never="first two"),
    Try(REG, "y now", reg("-y[2:], -y[1:-1], u[1:-1]"), r"first two columns hold -y\(t\)", never="third"),
    Try(REG, "order", reg("u[1:-1], -y[1:-1], -y[:-2]"), "another order"),
    Try(REG, "Y early", reg(Y="y[1:-1]"), "one sample early"),
    Try(FOR, "lambda once", rls("P - np.outer(q, q) / (lam + phi @ q)"), "not divided by lambda"),
    Try(FOR, "1 below", rls("(P - np.outer(q, q) / (1 + phi @ q)) / lam"), "1 \\+ phi'P phi"),
    Try(FOR, "times lambda", rls("(P - np.outer(q, q) / (lam + phi @ q)) * lam"), "multiplies P by lambda"),
    Try(FOR, "last only", rls(end="theta"), "one estimate"),
    Try(
        FOR, "list in place", rls(theta="theta", store="theta += P @ phi * error; history[k] = theta"), "", "acceptable"
    ),
    Try(FOR, "lambda word", rls().replace("lam,", "lambda,"), "call the variable `lam`"),
    Try(FOR, "P = LN", rls(start="LN"), "is one number"),
    Try(
        FOR,
        "before update",
        rls(store="pass").replace("phi = Phi[k]\n", "phi = Phi[k]\n        history[k] = theta\n"),
        "before sample k",
    ),
    Try(
        FIG,
        "rows",
        "fig_9, ax = plt.subplots()\nax.plot(theta_1[0])\nfig_10, ax = plt.subplots()\nax.plot(theta_099[0])",
        r"3 points in place of 998.*first \*row\*",
    ),
    Try(
        FIG,
        "swapped",
        "fig_9, ax = plt.subplots()\nax.plot(theta_099)\nfig_10, ax = plt.subplots()\nax.plot(theta_1)",
        "shows `theta_099`",
    ),
    Try(
        FIG,
        "no truth",
        "fig_9, ax = plt.subplots()\nax.plot(theta_1)\nfig_10, ax = plt.subplots()\nax.plot(theta_099)",
        "no curve of the true a1",
    ),
    Try(ONL, "plus y", online("np.array([y, past[0], u])"), "remembers \\+y"),
    Try(ONL, "past not changed", online("past"), "as it was"),
    Try(
        ONL,
        "in place",
        online("past").replace("return", "past[0] = -y; past[1] = past[0]; past[2] = u\n    return"),
        "both places",
    ),
    Try(ONL, "no lambda", online(P="P - np.outer(q, q) / (1 + past @ q)"), "lambda = 1"),
    Try(ONL, "oldest", online("np.array([-y, past[1], u])"), "oldest output"),
    Try(DRI, "lag", drift("slope / (1 - lam)"), "before the new sample"),
    Try(DRI, "not squared", drift(mse="lag + sigma**2 * (1 - lam) / (1 + lam)"), "lag itself"),
    Try(DRI, "index", drift(best="np.argmin(tracking_mse(lams, slope, sigma))"), "477, an index"),
    Try(DRI, "min", drift(best="np.min(tracking_mse(lams, slope, sigma))"), "least error"),
    Try(DRI, "sigma", drift(mse="lag**2 + sigma * (1 - lam) / (1 + lam)"), "not squared"),
    Try(
        WIN,
        "no pause",
        f(
            "rls_bounded(Phi, Y, lam, LN, bound)",
            "p = Phi.shape[1]\n    th, P, h, t = np.zeros(p), LN * np.eye(p), [], []\n    for phi, y "
            "in zip(Phi, Y):\n        q = P @ phi\n        P = (P - np.outer(q, q) / (lam + phi @ q)) "
            "/ lam\n        th = th + P @ phi * (y - phi @ th)\n        h.append(th); "
            "t.append(np.trace(P))\n    return np.array(h), np.array(t)",
        ),
        "never pauses",
    ),
    Try(
        WIN,
        "late",
        f(
            "rls_bounded(Phi, Y, lam, LN, bound)",
            "p = Phi.shape[1]\n    th, P, h, t = np.zeros(p), LN * np.eye(p), [], []\n    for phi, y "
            "in zip(Phi, Y):\n        l = 1 if np.trace(P) > bound else lam\n        q = P @ phi\n    "
            "    P = (P - np.outer(q, q) / (l + phi @ q)) / l\n        th = th + P @ phi * (y - phi @ "
            "th)\n        h.append(th); t.append(np.trace(P))\n    return np.array(h), np.array(t)",
        ),
        "after the division by lambda it may be above",
    ),
    Try(
        WIN,
        "one result",
        f("rls_bounded(Phi, Y, lam, LN, bound)", "return rls(Phi, Y, lam, LN)"),
        "history of theta and",
    ),
    Try(
        CAR,
        "sound form",
        f(
            "rls_careless(Phi, Y, lam, LN)",
            "p = Phi.shape[1]\n    th, P, h, a = np.zeros(p), LN * np.eye(p), [], []\n    for phi, y "
            "in zip(Phi, Y):\n        q = P @ phi\n        P = (P - np.outer(q, q) / (lam + phi @ q)) "
            "/ lam\n        th = th + P @ phi * (y - phi @ th)\n        h.append(th); "
            "a.append(np.max(abs(P - P.T)) / np.max(abs(P)))\n    return np.array(h), np.array(a)",
        ),
        "sound form",
    ),
    Try(CAR, "one result", f("rls_careless(Phi, Y, lam, LN)", "return rls(Phi, Y, lam, LN)"), "history of theta and"),
    Try(
        STEP,
        "entry by entry in the error",
        "def rls_step(theta, P, phi, y):\n    e = y - phi.T * theta\n"
        "    P = P - np.outer(P @ phi, P @ phi) / (1 + phi @ P @ phi)\n    return theta + P @ phi * e, P\n",
        "is a vector",
    ),
    Try(
        ONL,
        "entry by entry in the error",
        "def arx_step(theta, P, past, u, y, lam):\n    e = y - past * theta\n    g = P @ past\n"
        "    P = (P - np.outer(g, g) / (lam + past @ g)) / lam\n"
        "    return theta + P @ past * e, P, np.array([-y, past[0], u])\n",
        "is a vector",
    ),
    Try(
        ONL,
        "1 in the denominator",
        "def arx_step(theta, P, past, u, y, lam):\n    g = P @ past\n    e = y - past @ theta\n"
        "    P = (P - np.outer(g, g) / (1 + past @ g)) / lam\n"
        "    return theta + P @ past * e, P, np.array([-y, past[0], u])\n",
        "the 1 becomes lambda",
    ),
    Try(
        WIN,
        "scaled before use",
        "def rls_bounded(Phi, Y, lam, LN, bound):\n    p = Phi.shape[1]\n    theta, P = np.zeros(p), LN * np.eye(p)\n"
        "    H, T = np.zeros(Phi.shape), np.zeros(len(Y))\n    for k in range(len(Y)):\n        phi = Phi[k]\n"
        "        g = P @ phi\n        P = (P - np.outer(g, g) / (lam + phi @ g)) / lam\n"
        "        P = P * min(1, bound / np.trace(P))\n        theta = theta + P @ phi * (Y[k] - phi @ theta)\n"
        "        H[k], T[k] = theta, np.trace(P)\n    return H, T\n",
        "scales P down",
    ),
    Try(
        FOR,
        "P in the loop",
        "def rls(Phi, Y, lam, LN):\n    theta, H = np.zeros(Phi.shape[1]), np.zeros(Phi.shape)\n"
        "    for k, phi in enumerate(Phi):\n        P = LN * np.eye(phi.size)\n        g = P @ phi\n"
        "        P = (P - np.outer(g, g) / (lam + phi @ g)) / lam\n"
        "        theta = theta + P @ phi * (Y[k] - phi @ theta)\n        H[k] = theta\n    return H\n\n\n"
        "theta_1 = rls(Phi_61, Y_61, 1.0, 1e6)\ntheta_099 = rls(Phi_61, Y_61, 0.99, 1e6)\n",
        "once, before the loop",
    ),
    Try(MEAN, "no brackets", f("update_mean(theta, n, y)", "return theta + 1 / n * y - theta"), "theta cancel"),
    Try(MEAN, "times n", f("update_mean(theta, n, y)", "return theta + n * (y - theta)"), "multiplies the error by n"),
    Try(
        MEAN,
        "sum over n - 1",
        f("update_mean(theta, n, y)", "return ((n - 1) * theta + y) / (n - 1)"),
        "by n - 1: it holds",
    ),
    Try(FOR, "P full", rls(start="LN * np.ones((p, p))"), "in every entry of P"),
    Try(FOR, "from the second row", rls().replace("range(len(Y))", "range(1, len(Y))"), "row 0 of `rls` is still zero"),
    Try(DRI, "no brackets", drift("slope * lam / 1 - lam"), "lacks brackets in its lag"),
    Try(
        CAR,
        "K @ P_phi.T",
        f(
            "rls_careless(Phi, Y, lam, LN)",
            "p = Phi.shape[1]\n    theta, P = np.zeros(p), LN * np.eye(p)\n"
            "    h, a = np.zeros(Phi.shape), np.zeros(len(Y))\n"
            "    for k, (phi, y) in enumerate(zip(Phi, Y)):\n        q = P @ phi\n        K = q / (lam + phi @ q)\n"
            "        theta = theta + K * (y - phi @ theta)\n        P = (P - K @ q.T) / lam\n        h[k] = theta\n"
            "        a[k] = np.max(np.abs(P - P.T)) / np.max(np.abs(P))\n    return h, a",
        ),
        r"`np\.outer\(K, P_phi\)`",
    ),
    Try(MEAN, "mean for the sum", f("update_mean(theta, n, y)", "return (theta + y) / n"), "theta is a mean already"),
    Try(REG, "u(t-2) as well", reg("-y[1:-1], -y[:-2], u[1:-1], u[:-2]"), r"Column `\[:, 3\]` is one too many"),
    Try(REG, "no y(t-2)", reg("-y[1:-1], u[1:-1]"), r"missing, the one that should be `\[:, 1\]`"),
    Try(
        REG,
        "index below zero",
        f("regressors(u, y)", "return np.array([[-y[t - 1], -y[t - 2], u[t - 1]] for t in range(len(y))]), y")
        + "\n\nPhi_61, Y_61 = regressors(u_61, y_61)",
        "an index below zero",
    ),
    Try(FOR, "P(0) = I/LN", rls(start="np.eye(p) / LN"), "begins with P = I/LN"),
    Try(FOR, "P(0) = I", rls(start="np.eye(p)"), "begins with P = I, whatever", never="I/LN"),
    Try(
        FIG,
        "rows, with the truth",
        "fig_9, ax = plt.subplots()\nax.plot(theta_1[0])\nax.plot(theta_true, '--')\n"
        "fig_10, ax = plt.subplots()\nax.plot(theta_099[0])",
        r"3 points in place of 998.*first \*row\*",
    ),
    Try(
        FIG,
        "truth drawn alike",
        "def draw(h):\n    fig, ax = plt.subplots()\n    ax.plot(h, label=['a1', 'a2', 'b1'])\n"
        "    ax.plot(theta_true)\n    ax.set(xlabel='t', ylabel='theta')\n    ax.legend()\n    return fig\n\n\n"
        "fig_9, fig_10 = draw(theta_1), draw(theta_099)",
        "line style of its estimate",
    ),
    Try(
        FIG,
        "truth in thin lines",
        "def draw(h):\n    fig, ax = plt.subplots()\n    ax.plot(h, label=['a1', 'a2', 'b1'])\n"
        "    ax.plot(theta_true, 'k', linewidth=0.5)\n    ax.set(xlabel='t', ylabel='theta')\n    ax.legend()\n"
        "    return fig\n\n\nfig_9, fig_10 = draw(theta_1), draw(theta_099)",
        "",
        ACCEPTED,
    ),
    Try(DRI, "lag upside down", drift(lag="slope * (1 - lam) / lam"), "is upside down"),
    Try(
        WIN,
        "condition turned round",
        "def rls_bounded(Phi, Y, lam, LN, bound):\n    p = Phi.shape[1]\n    theta, P = np.zeros(p), LN * np.eye(p)\n"
        "    history, traces = np.zeros(Phi.shape), np.zeros(len(Y))\n    for k in range(len(Y)):\n"
        "        phi, now = Phi[k], lam if np.trace(P) / lam > bound else 1.0\n        q = P @ phi\n"
        "        P = (P - np.outer(q, q) / (now + phi @ q)) / now\n"
        "        theta = theta + P @ phi * (Y[k] - phi @ theta)\n"
        "        history[k], traces[k] = theta, np.trace(P)\n    return history, traces\n",
        "lambda = 1 throughout: pause only where",
    ),
    Try(
        CAR,
        "1 in the gain",
        "def rls_careless(Phi, Y, lam, LN):\n    p = Phi.shape[1]\n    theta, P = np.zeros(p), LN * np.eye(p)\n"
        "    history, a = np.zeros(Phi.shape), np.zeros(len(Y))\n    for k in range(len(Y)):\n        phi = Phi[k]\n"
        "        q = P @ phi\n        K = q / (1 + phi @ q)\n        theta = theta + K * (Y[k] - phi @ theta)\n"
        "        P = (P - np.outer(K, q)) / lam\n        history[k] = theta\n"
        "        a[k] = np.max(np.abs(P - P.T)) / np.max(np.abs(P))\n    return history, a\n",
        "1 \\+ phi'P phi under its gain",
    ),
    Try(
        MEAN,
        "n - 1 without brackets",
        f("update_mean(theta, n, y)", "return (n - 1 * theta + y) / n"),
        "put n - 1 in brackets",
    ),
    Try(
        CAR,
        "gain undivided",
        "def rls_careless(Phi, Y, lam, LN):\n    p = Phi.shape[1]\n    theta, P = np.zeros(p), LN * np.eye(p)\n"
        "    history, a = np.zeros(Phi.shape), np.zeros(len(Y))\n    for k in range(len(Y)):\n        phi = Phi[k]\n"
        "        K = P @ phi\n        theta = theta + K * (Y[k] - phi @ theta)\n"
        "        P = (P - np.outer(K, P @ phi)) / lam\n        history[k] = theta\n"
        "        a[k] = np.max(np.abs(P - P.T)) / np.max(np.abs(P))\n    return history, a\n",
        "is P phi, undivided",
    ),
    Try(
        INF,
        "inverse",
        f("add_sample(M, v, phi, y)", "return np.linalg.inv(M + np.outer(phi, phi)), v + phi * y"),
        "inverts M",
    ),
    Try(INF, "taken away", f("add_sample(M, v, phi, y)", "return M - np.outer(phi, phi), v + phi * y"), "away from M"),
    Try(STEP, "sum in place of P", step("np.linalg.inv(P) + np.outer(phi, phi)"), "returns the inverse of P"),
    Try(STEP, "correction alone", step(end="K * error, P"), "correction alone"),
    Try(STEP, "theta as it was", step(end="theta, P"), "hands theta back as it was"),
    Try(
        REG,
        "Y first",
        reg().replace(
            "return np.column_stack([-y[1:-1], -y[:-2], u[1:-1]]), y[2:]",
            "return y[2:], np.column_stack([-y[1:-1], -y[:-2], u[1:-1]])",
        ),
        "returns Y before Phi",
    ),
    Try(REG, "input for the output", reg(Y="u[2:]"), "Phi of `regressors` is right, and Y holds the input"),
    Try(
        FIG,
        "nothing drawn",
        "fig_9, ax_9 = plt.subplots()\nfig_10, ax_10 = plt.subplots()",
        "is empty: draw in its axes",
    ),
    Try(
        CAR,
        "gain after the update",
        "def rls_careless(Phi, Y, lam, LN):\n    p = Phi.shape[1]\n    theta, P = np.zeros(p), LN * np.eye(p)\n"
        "    history, asymmetry = np.zeros(Phi.shape), np.zeros(len(Y))\n    for k in range(len(Y)):\n"
        "        phi = Phi[k]\n        q = P @ phi\n        P = (P - np.outer(q, q) / (lam + phi @ q)) / lam\n"
        "        K = P @ phi / (lam + phi @ q)\n        theta = theta + K * (Y[k] - phi @ theta)\n"
        "        history[k] = theta\n        asymmetry[k] = np.max(np.abs(P - P.T)) / np.max(np.abs(P))\n"
        "    return history, asymmetry\n",
        "takes from the new P",
    ),
)
