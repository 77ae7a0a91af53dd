"""Students' code for the lecture on model structures, with the places open at which answers differ."""

from variants import define


def shift(body: str) -> str:
    return define("apply(P, x)", body)


LOOP_SHIFT = (
    "out = []\nfor k in range(len(x)):\n    s = 0\n    for i in range(len(P)):\n        if {condition}:\n"
    "            s += P[i] * x[{index}]\n    out.append(s)\nreturn out"
)


def states(
    a: str = "den / den[0]",
    b: str = "np.r_[np.zeros(n + 1 - len(num)), num] / den[0]",
    last: str = "-a[:0:-1]",
    C: str = "(b - b[0] * a)[:0:-1]",
    D: str = "b[0]",
    result: str = "A, B, C.reshape(1, n), np.array([[D]])",
) -> str:
    return define(
        "state_space(num, den)",
        f"num, den = np.array(num, float), np.array(den, float)\nn = len(den) - 1\na = {a}\nb = {b}\n"
        f"A = np.eye(n, k=1)\nA[-1] = {last}\nB = np.eye(n)[:, -1:]\nC = {C}\nD = {D}\nreturn {result}",
    )


def equations(
    k0: str = "max(na, d + nb - 1) if nb else na",
    past: str = "-y[k - i]",
    inputs: str = "u[k - i]",
    lags: str = "range(d, d + nb)",
    y_lags: str = "range(1, na + 1)",
    result: str = "np.column_stack(c1 + c2), y[k0:]",
) -> str:
    return define(
        "equations(u, y, na, nb, d)",
        f"k0 = {k0}\nk = np.arange(k0, len(y))\nc1 = [{past} for i in {y_lags}]\nc2 = [{inputs} for i in {lags}]\n"
        f"return {result}",
    )


def simulate(body: str) -> str:
    return "from scipy.signal import lfilter\n\n\n" + define("simulate(A, B, C, u, e)", body)


LOOP_SIMULATE = (
    "y = np.zeros(len(u))\nfor k in range({first}, len(u)):\n"
    "    for i in range(1, len(A)):\n        if k >= i:\n            y[k] {sign}= A[i] * y[k - i]\n"
    "    for i in range(len(B)):\n        if {inside}:\n            y[k] += B[i] * u[k - i]\n"
    "    for i in range(len(C)):\n        if {inside}:\n            y[k] += C[i] * e[k - i]\nreturn y"
)


def loop_simulate(first: str = "0", sign: str = "-", inside: str = "k >= i") -> str:
    return simulate(LOOP_SIMULATE.format(first=first, sign=sign, inside=inside))


TABLES = "theta_1 = example_3_1(u_1, y_1)\ntheta_2 = example_3_1(u_2, y_2)\n"


def table(
    columns: str = "-y[:-1], u[:-1]", target: str = "y[1:]", after: str = "", used: str = TABLES, body: str = ""
) -> str:
    fit = f"Phi = np.column_stack([{columns}])\nreturn np.linalg.lstsq(Phi, {target})[0]{after}"
    return define("example_3_1(u, y)", body or fit) + used


OUTPUTS = (
    "A_1, B_1 = [1, theta_1[0]], [0, theta_1[1]]\n"
    "y_hat = predict(A_1, B_1, u_1, y_1)\ny_sim = free_run(A_1, B_1, u_1)\n"
)
LAG = "def past(P, x, k):\n    return sum(P[i] * x[k - i] for i in range(len(P)) if k >= i)\n\n\n"


def predict(
    prediction: str = "return lfilter(B, [1], u) - lfilter(A, [1], y) + y",
    run: str = "return lfilter(B, A, u)",
    used: str = OUTPUTS,
) -> str:
    return (
        "from scipy.signal import lfilter\n\n\n"
        + LAG
        + define("predict(A, B, u, y)", prediction)
        + define("free_run(A, B, u)", run)
        + used
    )


def figure(
    measured: str = "ax.plot(t_8, y_1[:100], label='Measured')",
    prediction: str = "ax.plot(t_8, y_hat[:100], label='Prediction')",
    simulation: str = "ax.plot(t_8, y_sim[:100], label='Simulation')",
    rest: str = "ax.legend()\nax.set_xlabel('t')\nax.set_ylabel('y')",
) -> str:
    return f"t_8 = np.arange(100)\nfig_8, ax = plt.subplots()\n{measured}\n{prediction}\n{simulation}\n{rest}\n"


def excitation(
    windows: str = "np.lib.stride_tricks.sliding_window_view(u, n)",
    full: str = "np.linalg.matrix_rank(W) == n",
    result: str = "order",
    first: str = "",
) -> str:
    return define(
        "excitation(u, largest)",
        f"{first}order = 0\nfor n in range(1, largest + 1):\n    W = {windows}\n    if not ({full}):\n        break\n"
        f"    order = n\nreturn {result}",
    )


PADDED = "np.column_stack([np.r_[np.zeros(i), u[: len(u) - i]] for i in range(n)])"

CRITERIA = "return N * np.log(V) + 2 * p, N * np.log(V) + p * np.log(N), V * (1 + p / N) / (1 - p / N)"


def order(
    start: str = "max(orders)",
    loss: str = "np.mean(E**2)",
    n: str = "n",
    before: str = "",
    criteria: str = CRITERIA,
    result: str = "V",
) -> str:
    body = (
        f"{before}V = []\nN = len(y)\nfor n in orders:\n    s, m = {start}, {n}\n"
        "    c = [-y[s - i : N - i] for i in range(1, m + 1)] + [u[s - i : N - i] for i in range(1, m + 1)]\n"
        "    Phi, Y = np.column_stack(c), y[s:]\n    E = Y - Phi @ np.linalg.solve(Phi.T @ Phi, Phi.T @ Y)\n"
        f"    V.append({loss})\nreturn {result}"
    )
    return define("losses(u, y, orders)", body) + define("criteria(V, N, p)", criteria)


OWN_EQUATIONS = (
    "V = []\nfor n in orders:\n    Phi, Y = equations(u, y, n, n, 1)\n    s = max(orders) - n\n"
    "    Phi, Y = Phi[s:], Y[s:]\n"
    "    V += [np.linalg.norm(Y - Phi @ np.linalg.lstsq(Phi, Y)[0]) ** 2 / len(Y)]\nreturn V"
)


def cancel(body: str) -> str:
    return define("cancel(P, Q, within)", body)


PAIRS = (
    "p, q = list(np.roots(P)), list(np.roots(Q))\nfor z in list(q):\n"
    "    close = [x for x in p if abs(x - z) < {within}]\n"
    "    if close:\n        p.remove(close[0])\n        q.remove(z)\n"
)
NEAREST = (
    "p, q = list(np.roots(P)), list(np.roots(Q))\nfor z in list(q):\n"
    "    if p:\n        p.pop(np.argmin([abs(x - z) for x in p]))\n        q.remove(z)\n"
)
BACK = "return np.atleast_1d(np.poly({0})).real, np.atleast_1d(np.poly({1})).real"


def white(body: str) -> str:
    return define("autocorrelation(e, lags)", body)


CENTRED = "e = e - e.mean()\nN = len(e)\n"
SUMS = "np.array([np.sum(e[k:] * e[: N - k]) for k in range(lags + 1)])"
