"""Answers to the lecture on recursive identification that differ from the model solution, right and wrong ones."""

from variants import Right, Wrong, define, right, wrong

MEAN, INFORMATION, STEP, REGRESSORS = "ri-1-mean", "ri-2-information", "ri-3-step", "ri-4-regressors"
FORGETTING, FIGURES, ONLINE, DRIFT = "ri-5-forgetting", "ri-6-figures", "ri-7-online", "ri-8-drift"
WINDUP, CARELESS = "ri-9-windup", "ri-10-careless"


def mean(result: str) -> str:
    return define("update_mean(theta, n, y)", f"return {result}")


def information(M: str = "M + np.outer(phi, phi)", v: str = "v + phi * y", result: str = "M, v") -> str:
    return define("add_sample(M, v, phi, y)", f"M = {M}\nv = {v}\nreturn {result}")


def step(
    P: str = "P - np.outer(P @ phi, P @ phi) / (1 + phi @ P @ phi)",
    theta: str = "theta + P @ phi * (y - phi @ theta)",
    result: str = "theta, P",
    before: str = "",
) -> str:
    return define("rls_step(theta, P, phi, y)", f"old = P\n{before}P = {P}\ntheta = {theta}\nreturn {result}")


COLUMNS = (
    "phi = phi.reshape(-1, 1)\ntheta = theta.reshape(-1, 1)\n"
    "P = P - (P @ phi @ phi.T @ P) / (1 + phi.T @ P @ phi)\nK = P @ phi\nreturn theta + K * (y - phi.T @ theta), P"
)
GAIN_FIRST = (
    "K = P @ phi / (1 + phi @ P @ phi)\ntheta = theta + K * (y - phi @ theta)\n"
    "return theta, (np.eye(len(phi)) - np.outer(K, phi)) @ P"
)

USE_ROWS = "Phi_61, Y_61 = regressors(u_61, y_61)\n"


def regressors(columns: str = "-y[1:-1], -y[:-2], u[1:-1]", Y: str = "y[2:]", result: str = "Phi, Y") -> str:
    body = f"Phi = np.column_stack([{columns}])\nY = {Y}\nreturn {result}"
    return define("regressors(u, y)", body) + USE_ROWS


ROWS_BY_LOOP = (
    "rows, Y = [], []\nfor t in range(2, len(y)):\n    rows.append([-y[t - 1], -y[t - 2], u[t - 1]])\n"
    "    Y.append(y[t])\nreturn np.array(rows), np.array(Y)"
)
ROWS_FROM_REST = (
    "def late(x, k):\n    return np.r_[np.zeros(k), x[:-k]]\n"
    "return np.column_stack([-late(y, 1), -late(y, 2), late(u, 1)]), y.reshape(-1, 1)"
)

USE_RUNS = "theta_1 = rls(Phi_61, Y_61, 1.0, 1e6)\ntheta_099 = rls(Phi_61, Y_61, 0.99, 1e6)\n"


def runs(
    P: str = "(P - np.outer(P @ phi, P @ phi) / (lam + phi @ P @ phi)) / lam",
    theta: str = "theta + P @ phi * (y - phi @ theta)",
    start: str = "LN * np.eye(p)",
    result: str = "np.array(history)",
    store: str = "theta",
    used: str = USE_RUNS,
) -> str:
    body = (
        f"p = Phi.shape[1]\ntheta, P, history = np.zeros(p), {start}, []\nfor phi, y in zip(Phi, Y):\n"
        f"    old = P\n    P = {P}\n    theta = {theta}\n    history.append({store})\nreturn {result}"
    )
    return define("rls(Phi, Y, lam, LN)", body) + used


IN_PLACE = define(
    "rls(Phi, Y, lam, LN)",
    "p = Phi.shape[1]\ntheta, P, history = np.zeros(p), LN * np.eye(p), []\nfor phi, y in zip(Phi, Y):\n"
    "    P = (P - np.outer(P @ phi, P @ phi) / (lam + phi @ P @ phi)) / lam\n"
    "    theta += P @ phi * (y - phi @ theta)\n    history.append(theta)\nreturn np.array(history)",
)
BY_SUMS = define(
    "rls(Phi, Y, lam, LN)",
    "p = Phi.shape[1]\nM, v, history = np.eye(p) / LN, np.zeros(p), np.zeros_like(Phi)\nfor k in range(len(Y)):\n"
    "    M, v = lam * M + np.outer(Phi[k], Phi[k]), lam * v + Phi[k] * Y[k]\n    history[k] = np.linalg.solve(M, v)\n"
    "return history",
)
COLUMN_HISTORY = define(
    "rls(Phi, Y, lam, LN)",
    "p = Phi.shape[1]\ntheta, P, history = np.zeros((p, 1)), LN * np.eye(p), []\nfor k in range(len(Y)):\n"
    "    phi = Phi[k : k + 1].T\n    K = P @ phi / (lam + phi.T @ P @ phi)\n"
    "    theta = theta + K * (Y[k] - phi.T @ theta)\n    P = (P - K @ phi.T @ P) / lam\n    history.append(theta)\n"
    "return np.array(history)",
)


def figures(
    first: str = "theta_1",
    second: str = "theta_099",
    names: str = "a_1 a_2 b_1",
    truth: str = "ax.plot(theta_true[:, i], 'k--')",
    rest: str = "ax.set_xlabel('t')\n    ax.set_ylabel('estimates')\n    ax.legend()",
    order: str = "0, 1, 2",
) -> str:
    return (
        f"figs = []\nfor history in ({first}, {second}):\n    fig, ax = plt.subplots()\n"
        f"    for i, name in zip(({order}), {names.split()!r}):\n"
        f"        ax.plot(history[:, i], label=f'${{name}}$')\n        {truth}\n"
        f"    {rest}\n    figs.append(fig)\nfig_9, fig_10 = figs\n"
    )


ALL_AT_ONCE = (
    "t = np.arange(2, 1000)\n"
    "fig_9 = plt.figure()\nlines = plt.plot(t, theta_1)\nplt.plot(t, theta_true[2:], ':')\n"
    "plt.legend(lines, [r'$\\hat a_1$', r'$\\hat a_2$', r'$\\hat b_1$'])\nplt.xlabel('t')\nplt.ylabel('theta')\n"
    "fig_10 = plt.figure()\nlines = plt.plot(t, theta_099)\nplt.plot(t, theta_true[2:], ':')\n"
    "plt.legend(lines, ['a1', 'a2', 'b1'])\nplt.xlabel('t')\nplt.ylabel('theta')\n"
)


def online(
    P: str = "(P - np.outer(P @ past, P @ past) / (lam + past @ P @ past)) / lam",
    theta: str = "theta + P @ past * (y - past @ theta)",
    after: str = "[-y, past[0], u]",
    result: str = "theta, P, after",
    before: str = "",
) -> str:
    return define(
        "arx_step(theta, P, past, u, y, lam)",
        f"old = P\n{before}P = {P}\ntheta = {theta}\nafter = np.array({after})\nreturn {result}",
    )


ONLINE_IN_PLACE = define(
    "arx_step(theta, P, past, u, y, lam)",
    "K = P @ past / (lam + past @ P @ past)\ntheta += K * (y - past @ theta)\n"
    "P = (P - np.outer(K, past) @ P) / lam\nP = (P + P.T) / 2\n"
    "past[1] = past[0]\npast[0] = -y\npast[2] = u\nreturn [theta, P, past]",
)


def drift(
    lag: str = "slope * lam / (1 - lam)",
    variance: str = "sigma**2 * (1 - lam) / (1 + lam)",
    mse: str = "lag**2 + variance",
    best: str = "lams[np.argmin([tracking_mse(lam, slope, sigma) for lam in lams])]",
    lams: str = "np.arange(0.5, 0.9995, 0.001)",
) -> str:
    return define("tracking_mse(lam, slope, sigma)", f"lag = {lag}\nvariance = {variance}\nreturn {mse}") + define(
        "best_forgetting(slope, sigma)", f"lams = {lams}\nreturn {best}"
    )


MINIMISED = (
    "from scipy.optimize import minimize_scalar\n"
    + drift().split("def best_forgetting")[0]
    + define(
        "best_forgetting(slope, sigma)",
        "f = lambda lam: tracking_mse(lam, slope, sigma)\n"
        "return minimize_scalar(f, bounds=(0.5, 0.999), method='bounded').x",
    )
)


def bounded(
    now: str = "1.0 if np.trace(P) / lam > bound else lam",
    after: str = "pass",
    traces: str = "np.trace(P)",
    result: str = "np.array(history), np.array(traces)",
    before: str = "pass",
    store: str = "theta",
    update: str = "theta + P @ phi * (y - phi @ theta)",
) -> str:
    return define(
        "rls_bounded(Phi, Y, lam, LN, bound)",
        "p = Phi.shape[1]\ntheta, P, history, traces, paused = np.zeros(p), LN * np.eye(p), [], [], False\n"
        f"for phi, y in zip(Phi, Y):\n    old = P\n    {before}\n    now = {now}\n"
        "    P = (P - np.outer(P @ phi, P @ phi) / (now + phi @ P @ phi)) / now\n"
        f"    theta = {update}\n    {after}\n    history.append({store})\n"
        f"    traces.append({traces})\nreturn {result}",
    )


TRIED_FIRST = define(
    "rls_bounded(Phi, Y, lam, LN, bound)",
    "p = Phi.shape[1]\ntheta, P, history, traces = np.zeros(p), LN * np.eye(p), [], []\nfor phi, y in zip(Phi, Y):\n"
    "    for now in (lam, 1):\n"
    "        new = (P - np.outer(P @ phi, P @ phi) / (now + phi @ P @ phi)) / now\n"
    "        if np.trace(new) <= bound:\n            break\n"
    "    P = new\n    theta = theta + P @ phi * (y - phi @ theta)\n    history.append(theta)\n"
    "    traces.append(P.trace())\nreturn history, traces",
)
SKIPPING = (
    "if np.trace(P) / lam > bound:\n        history.append(theta)\n        traces.append(np.trace(P))\n        continue"
)


def careless(
    K: str = "P_phi / (lam + phi @ P_phi)",
    P: str = "(P - np.outer(K, P_phi)) / lam",
    asymmetry: str = "abs(P - P.T).max() / abs(P).max()",
    theta: str = "theta + K * (y - phi @ theta)",
    result: str = "np.array(history), np.array(asymmetry)",
) -> str:
    return define(
        "rls_careless(Phi, Y, lam, LN)",
        "p = Phi.shape[1]\ntheta, P, history, asymmetry = np.zeros(p), LN * np.eye(p), [], []\n"
        f"for phi, y in zip(Phi, Y):\n    P_phi = P @ phi\n    K = {K}\n    theta = {theta}\n    P = {P}\n"
        f"    history.append(theta)\n    asymmetry.append({asymmetry})\nreturn {result}",
    )


CARELESS_COLUMNS = define(
    "rls_careless(Phi, Y, lam, LN)",
    "n, p = Phi.shape\ntheta, P = np.zeros((p, 1)), LN * np.eye(p)\n"
    "history, asymmetry = np.zeros((n, p)), np.zeros((n, 1))\n"
    "for k in range(n):\n    phi = Phi[k].reshape(p, 1)\n    P_phi = P @ phi\n"
    "    K = P_phi / (lam + (phi.T @ P_phi).item())\n    theta = theta + K * (Y[k] - (phi.T @ theta).item())\n"
    "    P = (P - K @ P_phi.T) / lam\n    history[k] = theta[:, 0]\n"
    "    asymmetry[k] = np.max(P - P.T) / np.max(np.abs(P))\nreturn history, asymmetry",
)

VARIANTS: list[Right | Wrong] = [
    # 1. the running mean
    right(MEAN, "weighted mean of old and new", mean("((n - 1) * theta + y) / n")),
    right(MEAN, "numpy average", mean("np.average([theta, y], weights=[n - 1, 1])")),
    wrong(MEAN, "1/(n+1)", mean("theta + (y - theta) / (n + 1)"), "n counts the old samples", "already counts"),
    wrong(MEAN, "1/(n-1)", mean("theta + (y - theta) / max(n - 1, 1)"), "gain 1/(n - 1)", "counts, too"),
    wrong(MEAN, "sign", mean("theta - (y - theta) / n"), "sign of the error", "away"),
    wrong(MEAN, "half and half", mean("(theta + y) / 2"), "half and half", "n - 1 samples"),
    wrong(MEAN, "y over n", mean("theta + y / n"), "y in place of the error", "error"),
    wrong(MEAN, "no gain", mean("y"), "gain forgotten", "Divide it by n"),
    wrong(
        MEAN, "nothing returned", define("update_mean(theta, n, y)", "theta + (y - theta) / n"), "no return", "return"
    ),
    # 2. the two sums
    right(INFORMATION, "columns", information("M + phi.reshape(-1, 1) @ phi.reshape(1, -1)", result="[M, v]")),
    right(INFORMATION, "broadcast", information("M + phi[:, None] * phi", "v + y * phi")),
    right(INFORMATION, "v as a column", information(result="M, v.reshape(-1, 1)")),
    wrong(INFORMATION, "number", information("M + phi @ phi.T"), "phi'phi for phi phi'", "np.outer"),
    wrong(INFORMATION, "entry by entry", information("M + phi * phi.T"), "entry by entry", "every pair"),
    wrong(INFORMATION, "diagonal", information("M + np.diag(phi * phi)"), "entry by entry", "diagonal"),
    wrong(INFORMATION, "without the old sum", information("np.outer(phi, phi)"), "old sum forgotten", "old sum"),
    wrong(INFORMATION, "y forgotten", information(v="v + phi"), "y forgotten", "phi y"),
    wrong(INFORMATION, "phi forgotten", information(v="v + y"), "phi forgotten", "every entry"),
    wrong(INFORMATION, "v as it was", information(v="v"), "v not updated", "as it was"),
    wrong(INFORMATION, "swapped", information(result="v, M"), "M and v swapped", "before"),
    wrong(INFORMATION, "M alone", information(result="M"), "incomplete result", "M and v"),
    # 3. one step
    right(STEP, "column vectors", define("rls_step(theta, P, phi, y)", COLUMNS)),
    right(STEP, "gain first, (I - K phi')P", define("rls_step(theta, P, phi, y)", GAIN_FIRST)),
    right(
        STEP,
        "gain from the old P, divided",
        step(theta="theta + old @ phi / (1 + phi @ old @ phi) * (y - phi @ theta)"),
    ),
    wrong(STEP, "inverses", step("np.linalg.inv(np.linalg.inv(P) + np.outer(phi, phi))"), "matrix inverted", "divides"),
    wrong(
        STEP,
        "pseudo-inverses",
        step("np.linalg.inv(np.linalg.pinv(P) + np.outer(phi, phi))"),
        "matrix inverted",
        "lemma",
    ),
    wrong(
        STEP,
        "P as it was",
        step("P", "theta + P @ phi / (1 + phi @ P @ phi) * (y - phi @ theta)"),
        "P not updated",
        "smaller",
    ),
    wrong(STEP, "without 1", step("P - np.outer(P @ phi, P @ phi) / (phi @ P @ phi)"), "1 forgotten", "1 is missing"),
    wrong(
        STEP,
        "brackets",
        step("P - np.outer(P @ phi, P @ phi) / 1 + phi @ P @ phi"),
        "denominator forgotten",
        "brackets",
    ),
    wrong(
        STEP, "a number", step("P - (P @ phi) @ (P @ phi) / (1 + phi @ P @ phi)"), "phi'phi for phi phi'", "np.outer"
    ),
    wrong(
        STEP,
        "grows",
        step("P + np.outer(P @ phi, P @ phi) / (1 + phi @ P @ phi)"),
        "sign of the correction",
        "taken away",
    ),
    wrong(STEP, "P once", step("P - np.outer(phi, phi) / (1 + phi @ P @ phi)"), "P only once", "both sides"),
    wrong(STEP, "old gain", step(theta="theta + old @ phi * (y - phi @ theta)"), "gain from the old P", "after it"),
    wrong(
        STEP,
        "divided twice",
        step(theta="theta + P @ phi / (1 + phi @ old @ phi) * (y - phi @ theta)"),
        "divided twice",
        "already",
    ),
    wrong(STEP, "sign", step(theta="theta - P @ phi * (y - phi @ theta)"), "sign of the error", "away"),
    wrong(STEP, "no error", step(theta="theta + P @ phi * y"), "y in place of the error", "error"),
    wrong(STEP, "swapped", step(result="P, theta"), "theta and P swapped", "before"),
    wrong(STEP, "P phi phi' P of flat arrays", step("P - P @ phi @ phi.T @ P / (1 + phi @ P @ phi)"), None, "rls_step"),
    # 4. regressors
    right(REGRESSORS, "loop", define("regressors(u, y)", ROWS_BY_LOOP) + USE_ROWS),
    right(REGRESSORS, "zeros before the record, Y a column", define("regressors(u, y)", ROWS_FROM_REST) + USE_ROWS),
    right(REGRESSORS, "from the fourth sample", regressors("-y[2:-1], -y[1:-2], u[2:-1]", "y[3:]")),
    wrong(REGRESSORS, "the lab's sign", regressors("y[1:-1], y[:-2], u[1:-1]"), "sign of a", "lab"),
    wrong(REGRESSORS, "u first", regressors("u[1:-1], -y[1:-1], -y[:-2]"), "order of the columns", "order"),
    wrong(REGRESSORS, "older y first", regressors("-y[:-2], -y[1:-1], u[1:-1]"), "order of the columns", "a1 belongs"),
    wrong(REGRESSORS, "u(t)", regressors("-y[1:-1], -y[:-2], u[2:]"), "lag off by one", "off by one"),
    wrong(REGRESSORS, "u(t-2)", regressors("-y[1:-1], -y[:-2], u[:-2]"), "lag off by one", "off by one"),
    wrong(REGRESSORS, "y(t)", regressors("-y[2:], -y[1:-1], u[1:-1]"), "lag off by one", "off by one"),
    wrong(
        REGRESSORS,
        "roll",
        regressors("-np.roll(y, 1), -np.roll(y, 2), np.roll(u, 1)", "y"),
        "index wraps around",
        "future",
    ),
    wrong(REGRESSORS, "Y early", regressors(Y="y[1:-1]"), "rows do not start together", "early"),
    wrong(REGRESSORS, "all of y", regressors(Y="y"), "Phi and Y of unequal length", "each row"),
    wrong(REGRESSORS, "rows for columns", regressors(result="Phi.T, Y"), "rows instead of columns", "transpose it"),
    wrong(REGRESSORS, "Y negative", regressors(Y="-y[2:]"), "sign of Y", "minus"),
    # 5. forgetting
    right(FORGETTING, "list of estimates", runs()),
    right(FORGETTING, "the two sums, solved every time", BY_SUMS + USE_RUNS),
    right(FORGETTING, "columns, gain first, (I - K phi')P", COLUMN_HISTORY + USE_RUNS),
    right(FORGETTING, "in place, copies stored", IN_PLACE.replace("append(theta)", "append(theta.copy())") + USE_RUNS),
    wrong(
        FORGETTING,
        "lambda unused",
        runs("P - np.outer(P @ phi, P @ phi) / (1 + phi @ P @ phi)"),
        "lambda not used",
        "whatever",
    ),
    wrong(
        FORGETTING,
        "1 + phi'P phi",
        runs("(P - np.outer(P @ phi, P @ phi) / (1 + phi @ P @ phi)) / lam"),
        "1 in the denominator",
        "becomes lambda",
    ),
    wrong(
        FORGETTING,
        "no division by lambda",
        runs("P - np.outer(P @ phi, P @ phi) / (lam + phi @ P @ phi)"),
        "not divided by lambda",
        "not divided",
    ),
    wrong(
        FORGETTING,
        "times lambda",
        runs("(P - np.outer(P @ phi, P @ phi) / (lam + phi @ P @ phi)) * lam"),
        "multiplied by lambda",
        "Divide",
    ),
    wrong(FORGETTING, "old gain", runs(theta="theta + old @ phi * (y - phi @ theta)"), "gain from the old P", "first"),
    wrong(FORGETTING, "in place", IN_PLACE + USE_RUNS, "one array stored again and again", "copy"),
    wrong(FORGETTING, "last estimate", runs(result="theta"), "only the last estimate", "history"),
    wrong(FORGETTING, "LN unused", runs(start="1e6 * np.eye(p)"), "start not used", "LN"),
    wrong(FORGETTING, "P(0) = I", runs(start="np.eye(p)"), "start not used", "LN"),
    wrong(FORGETTING, "lying down", runs(result="np.array(history).T"), "rows instead of columns", "transpose it"),
    wrong(
        FORGETTING,
        "theta(0) stored too",
        runs(result="np.vstack([np.zeros(p), history])"),
        "history begins with theta(0)",
        "one row too many",
    ),
    wrong(
        FORGETTING,
        "one sample late",
        runs(result="np.vstack([np.zeros(p), history[:-1]])"),
        "history begins with theta(0)",
        "before sample k",
    ),
    wrong(FORGETTING, "sign", runs(theta="theta - P @ phi * (y - phi @ theta)"), "sign of the error", "away"),
    wrong(FORGETTING, "0.99 for both", runs(used=USE_RUNS.replace("1.0", "0.99")), None, "leave the last lines"),
    # 6. Fig. 9 and 10
    right(FIGURES, "default colours, black truth", figures()),
    right(FIGURES, "all columns at once, legend by handles", ALL_AT_ONCE),
    right(
        FIGURES,
        "true values as horizontal lines",
        figures(
            truth="levels = theta_true[[0, -1], i]\n"
            "        ax.hlines(levels, [0, 500], [500, 1000], color='k', linestyle=':')"
        ),
    ),
    wrong(FIGURES, "swapped", figures("theta_099", "theta_1"), "figures swapped", "Fig. 9 is lambda = 1"),
    wrong(FIGURES, "twice the same", figures(second="theta_1"), "figures swapped", "Fig. 10 shows"),
    right(FIGURES, "truth as points", figures(truth="ax.plot(theta_true[:, i], 'k.')")),
    wrong(
        FIGURES,
        "truth drawn alike",
        figures(truth="ax.plot(theta_true[:, i], 'k')"),
        "truth in the same style",
        "line style",
    ),
    wrong(FIGURES, "no truth", figures(truth="pass"), "truth missing", "true"),
    wrong(FIGURES, "legend in another order", figures(names="b_1 a_1 a_2"), "legend entries swapped", "another name"),
    wrong(
        FIGURES, "no legend", figures(rest="ax.set_xlabel('t')\n    ax.set_ylabel('estimates')"), "no legend", "legend"
    ),
    wrong(FIGURES, "no labels", figures(rest="ax.legend()"), "axis without a label", "label"),
    wrong(FIGURES, "one parameter only", figures(order="0,"), "no curve", "a2"),
    # 7. online
    right(ONLINE, "theta and past changed in place, P made symmetric", ONLINE_IN_PLACE),
    right(ONLINE, "new past by roll", online(after="np.r_[-y, past[0], u]")),
    wrong(ONLINE, "past as it was", online(after="past"), "past not updated", "newer"),
    wrong(ONLINE, "sign of y", online(after="[y, past[0], u]"), "sign of the remembered output", "-y"),
    wrong(ONLINE, "oldest kept", online(after="[-y, past[1], u]"), "oldest output kept", "dropped"),
    wrong(
        ONLINE,
        "overwritten",
        ONLINE_IN_PLACE.replace("past[1] = past[0]\n    past[0] = -y", "past[0] = -y\n    past[1] = past[0]"),
        "new output overwritten",
        "overwritten",
    ),
    wrong(ONLINE, "u forgotten", online(after="[-y, past[0], past[2]]"), "u not remembered", "remember u"),
    wrong(
        ONLINE,
        "updated before use",
        online(before="past = np.array([-y, past[0], u])\n", after="past"),
        "past updated too early",
        "predict itself",
    ),
    wrong(
        ONLINE,
        "present input",
        online(before="past = np.array([past[0], past[1], u])\n"),
        "the present input used",
        "use it later",
    ),
    wrong(
        ONLINE,
        "lambda unused",
        online("P - np.outer(P @ past, P @ past) / (1 + past @ P @ past)"),
        "lambda not used",
        "whatever",
    ),
    wrong(ONLINE, "old P returned", online(result="theta, old, after"), "P not updated", "as it was"),
    wrong(ONLINE, "order", online(result="theta, after, P"), "order of what is returned", "another order"),
    wrong(ONLINE, "no past", online(result="theta, P"), "incomplete result", "past"),
    # 8. drift
    right(DRIFT, "scipy's minimiser", MINIMISED),
    right(DRIFT, "a finer grid and a loop", drift(lams="np.linspace(0.5, 0.999, 5000)")),
    right(DRIFT, "ever finer steps", drift(lams="np.r_[0.5:0.9:0.001, 0.9:0.999:0.0001]")),
    wrong(DRIFT, "steps of a hundredth", drift(lams="np.arange(0.5, 1, 0.01)"), "search too coarse", "two decimals"),
    wrong(DRIFT, "lag not squared", drift(mse="lag + variance"), "lag not squared", "square"),
    wrong(DRIFT, "lag before the sample", drift("slope / (1 - lam)"), "lag of the old estimate", "before"),
    wrong(DRIFT, "no lag", drift(mse="variance"), "lag forgotten", "lag"),
    wrong(DRIFT, "no noise", drift(mse="lag**2"), "noise forgotten", "noise"),
    wrong(DRIFT, "sigma", drift(variance="sigma * (1 - lam) / (1 + lam)"), "sigma not squared", "squared"),
    wrong(DRIFT, "one step", drift(variance="sigma**2 * (1 - lam) ** 2"), "variance of one step", "all ages"),
    wrong(
        DRIFT, "sum of weights", drift(variance="sigma**2 * (1 - lam)"), "sum of weights for sum of squares", "squares"
    ),
    wrong(DRIFT, "root", drift(mse="np.sqrt(lag**2 + variance)"), "root of the sum", "root"),
    wrong(
        DRIFT,
        "largest error",
        drift(best="lams[np.argmax([tracking_mse(lam, slope, sigma) for lam in lams])]"),
        "end of the search",
        "least",
    ),
    wrong(
        DRIFT,
        "least error itself",
        drift(best="min(tracking_mse(lam, slope, sigma) for lam in lams)"),
        "the error in place of lambda",
        "lambda",
    ),
    wrong(
        DRIFT,
        "gain",
        drift(best="1 - lams[np.argmin([tracking_mse(lam, slope, sigma) for lam in lams])]"),
        "gain in place of lambda",
        "gain",
    ),
    wrong(DRIFT, "steps of a tenth", drift(lams="np.arange(0.5, 1, 0.1)"), None, "steps of 0.001"),
    # 9. wind-up
    right(WINDUP, "rule as printed, lists", bounded(result="history, traces")),
    right(WINDUP, "step tried with lambda first", TRIED_FIRST),
    right(WINDUP, "P made symmetric", bounded(after="P = (P + P.T) / 2", traces="P[0, 0] + P[1, 1]")),
    wrong(WINDUP, "no bound", bounded("lam"), "no bound", "never pauses"),
    wrong(WINDUP, "never forgets", bounded("1.0"), "forgetting never", "throughout"),
    wrong(
        WINDUP,
        "paused for good",
        bounded("1.0 if paused else lam", before="paused = paused or np.trace(P) / lam > bound"),
        "lambda = 1 for good",
        "anew",
    ),
    wrong(WINDUP, "sample skipped", bounded(before=SKIPPING), "sample skipped", "use it"),
    wrong(
        WINDUP, "no division", bounded("1.0 if np.trace(P) > bound else lam"), "looks too late", "trace\\(P\\)/lambda"
    ),
    wrong(WINDUP, "scaled", bounded("lam", "P = P * min(1, bound / np.trace(P))"), "P scaled down", "pause"),
    wrong(
        WINDUP,
        "reset",
        bounded("lam", "P = LN * np.eye(p) if np.trace(P) > bound else P"),
        "P reset",
        "thrown away",
    ),
    wrong(WINDUP, "trace of the old P", bounded(traces="np.trace(old)"), "trace of the old P", "one sample late"),
    wrong(WINDUP, "theta alone", bounded(result="np.array(history)"), "incomplete result", "trace"),
    # 10. the careless form
    right(CARELESS, "columns, largest of the difference itself", CARELESS_COLUMNS),
    right(
        CARELESS, "gain on the other side", careless(P="(P - np.outer(P_phi, K)) / lam", result="history, asymmetry")
    ),
    wrong(
        CARELESS,
        "step 5",
        careless(P="(P - np.outer(P @ phi, phi @ P) / (lam + phi @ P @ phi)) / lam"),
        "the sound form",
        "sound",
    ),
    wrong(
        CARELESS,
        "symmetrised",
        careless(P="((P - np.outer(K, P_phi)) + (P - np.outer(P_phi, K))) / (2 * lam)"),
        "the sound form",
        "sound",
    ),
    wrong(CARELESS, "(I - K phi')P", careless(P="(P - np.outer(K, phi) @ P) / lam"), "the sound form", "sound"),
    wrong(CARELESS, "absolute", careless(asymmetry="abs(P - P.T).max()"), "not divided by the size of P", "relative"),
    wrong(
        CARELESS,
        "relative to the smallest",
        careless(asymmetry="abs(P - P.T).max() / abs(P).min()"),
        "divided by another measure of P",
        "largest entry",
    ),
    wrong(CARELESS, "brackets", careless(P="P - np.outer(K, P_phi)"), "P not divided by lambda", "brackets"),
    wrong(
        CARELESS,
        "lambda unused",
        careless("P_phi / (1 + phi @ P_phi)", "P - np.outer(K, P_phi)"),
        "lambda not used",
        "lambda = 1",
    ),
    wrong(
        CARELESS,
        "signed corner",
        careless(asymmetry="-abs(P - P.T).max() / abs(P).max()"),
        "sign kept",
        "absolute",
    ),
    wrong(CARELESS, "theta alone", careless(result="np.array(history)"), "incomplete result", "asymmetry"),
]
