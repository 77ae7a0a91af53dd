"""Answers to the assignment on several signals that differ from the model solution, right ones and wrong ones."""

from variants import Right, Wrong, define, right, wrong

READ, OFFSETS, PHI, THETA, RUN, LOOP = (
    "sev-1-read",
    "sev-2-offsets",
    "sev-3-phi",
    "sev-4-theta",
    "sev-5-run",
    "sev-6-reference",
)


def read(inputs: str = "Q1,Q2", outputs: str = "T1,T2", u: str = "r.u", y: str = "r.y", Ts: str = "r.Ts") -> str:
    return (
        f'r = load_record("TwoHeaters.csv", inputs="{inputs}", outputs="{outputs}")\n'
        f"record = r\nu = {u}\ny = {y}\nTs = {Ts}"
    )


def offsets(
    n: str = "np.argmax(np.any(u != u[0], axis=1))", u: str = "u - u[0]", y: str = "y - y[:n].mean(axis=0)"
) -> str:
    return define("without_offsets(u, y)", f"n = {n}\nreturn {u}, {y}")


def phi(
    signals: str = "[y[:, i], *u.T]", each: str = "x[n - l : N - l]", lags: str = "range(1, n + 1)", Y: str = "y[n:, i]"
) -> str:
    return define(
        "regressor(u, y, i, n)",
        f"N = len(y)\nreturn np.column_stack([{each} for x in {signals} for l in {lags}]), {Y}",
    )


def theta(one: str = "np.linalg.lstsq(Phi, Y)[0]", i: str = "i", result: str = "np.array(T)") -> str:
    return define(
        "fit_outputs(u, y, n)",
        f"T = []\nfor i in range(y.shape[1]):\n    Phi, Y = regressor(u, y, {i}, n)\n    T.append({one})\nreturn "
        f"{result}",
    )


def run(
    a: str = "np.r_[1, -theta[:n]]",
    b: str = "np.r_[0, theta[n + j * n : n + (j + 1) * n]]",
    inputs: str = "range(u.shape[1])",
    result: str = "sum(parts)",
) -> str:
    return define(
        "simulate_output(theta, u, n)",
        f"parts = [scipy.signal.lfilter({b}, {a}, u[:, j]) for j in {inputs}]\nreturn {result}",
    )


LOOP_RUN = define(
    "simulate_output(theta, u, n)",
    "y = np.zeros(len(u))\n"
    "for k in range({first}, len(u)):\n"
    "    for l in range(1, n + 1):\n"
    "        if k >= l:\n"
    "            y[k] += theta[l - 1] * y[k - l]\n"
    "            for j in range(u.shape[1]):\n"
    "                y[k] += theta[n + j * n + l - 1] * u[k - l, j]\n"
    "return y",
)


def loop(
    Z: str = "[r[1:-1], r[:-2]]",
    Phi: str = "[y[1:-1], u[1:-1]]",
    result: str = "np.linalg.solve(Z.T @ Phi, Z.T @ y[2:])",
) -> str:
    return define(
        "fit_with_reference(u, y, r)",
        f"Phi = np.column_stack({Phi})\nZ = np.column_stack({Z})\nreturn {result}",
    )


VARIANTS: list[Right | Wrong] = [
    # 1. read
    right(
        READ,
        "loadtxt",
        'a = np.loadtxt("TwoHeaters.csv", delimiter=",", skiprows=1)\nu, y, Ts = a[:, [1, 3]], a[:, [2, 4]], a[1, 0]',
    ),
    right(READ, "columns by number", read("2,4", "3,5")),
    wrong(READ, "u and y swapped", read("T1,T2", "Q1,Q2"), "u and y swapped", "powers are inputs"),
    wrong(READ, "one input", read("Q1", "T1"), "one signal only", "both columns"),
    wrong(READ, "columns in the order of the log", read("Q1,T1", "Q2,T2"), "columns by number", "alternate"),
    wrong(READ, "order", read("Q2,Q1"), "columns swapped", "wrong order"),
    wrong(READ, "transposed", read(u="r.u.T", y="r.y.T"), "signals in rows", "samples go down"),
    wrong(READ, "samples", read(Ts="1"), "samples for seconds", "seconds"),
    # 2. offsets
    right(OFFSETS, "smallest of the first changes", offsets("min(np.flatnonzero(x != x[0])[0] for x in u.T)")),
    right(
        OFFSETS,
        "loop, and the sample of the step counted in",
        define(
            "without_offsets(u, y)",
            "n = 0\nwhile np.all(u[n] == u[0]):\n    n += 1\nu, y = u.copy(), y.copy()\nfor j in range(y.shape[1]):\n"
            "    y[:, j] = y[:, j] - np.mean(y[: n + 1, j])\nu = u - u[0]\nreturn u, y",
        ),
    ),
    wrong(
        OFFSETS,
        "each output until its own input",
        define(
            "without_offsets(u, y)",
            "y = y.copy()\nfor i in range(y.shape[1]):\n    x = u[:, min(i, u.shape[1] - 1)]\n"
            "    y[:, i] -= y[: np.argmax(x != x[0]), i].mean()\nreturn u - u[0], y",
        ),
        "rest until its own input moves",
        "own input",
    ),
    wrong(OFFSETS, "first input", offsets("np.argmax(u[:, 0] != u[0, 0])"), "rest of one input", "one certain input"),
    wrong(OFFSETS, "no axis", offsets(y="y - y[:n].mean()"), "one offset for all", "axis=0"),
    wrong(OFFSETS, "whole record", offsets(y="y - y.mean(axis=0)"), "mean of the whole record", "rest"),
    wrong(OFFSETS, "first sample", offsets(y="y - y[0]"), "first sample", "noise"),
    wrong(OFFSETS, "input's mean", offsets(u="u - u.mean(axis=0)"), "mean taken off", "first value"),
    # 3. Phi
    right(
        PHI,
        "rows in a loop",
        define(
            "regressor(u, y, i, n)",
            "rows = []\nfor k in range(n, len(y)):\n    row = list(y[k - n : k, i][::-1])\n"
            "    for j in range(u.shape[1]):\n        row += list(u[k - n : k, j][::-1])\n    rows.append(row)\n"
            "return np.array(rows), y[n:, [i]]",
        ),
    ),
    right(
        PHI,
        "hstack of blocks",
        define(
            "regressor(u, y, i, n)",
            "N, k = len(y), np.arange(n, len(y))\nback = k[:, None] - np.arange(1, n + 1)\n"
            "return np.hstack([y[back, i]] + [u[back, j] for j in range(u.shape[1])]), y[k, i]",
        ),
    ),
    wrong(PHI, "all outputs", phi("[*y.T, *u.T]"), "past of all outputs", "block for every output"),
    wrong(PHI, "first input", phi("[y[:, i], u[:, 0]]"), "one input only", "past of one input"),
    wrong(
        PHI,
        "lag by lag",
        define(
            "regressor(u, y, i, n)",
            "N = len(y)\nS = np.column_stack([y[:, i], u])\n"
            "return np.hstack([S[n - l : N - l] for l in range(1, n + 1)]), y[n:, i]",
        ),
        "signals interleaved",
        "signal by signal",
    ),
    wrong(PHI, "inputs first", phi("[*u.T, y[:, i]]"), "inputs before outputs", "comes first"),
    wrong(PHI, "oldest first", phi(lags="range(n, 0, -1)"), "oldest lag first", "newest"),
    wrong(PHI, "lags from zero", phi(lags="range(n)"), "lag off by one", "1 to n"),
    wrong(PHI, "output 0", phi("[y[:, 0], *u.T]"), "wrong output", "argument `i`"),
    wrong(PHI, "Y of output 0", phi(Y="y[n:, 0]"), "wrong output", "from zero"),
    wrong(PHI, "minus", phi("[-y[:, i], *u.T]"), "sign of a", "holds -y"),
    # 4. theta
    right(THETA, "normal equations", theta("np.linalg.solve(Phi.T @ Phi, Phi.T @ Y)", result="T")),
    right(THETA, "pinv and vstack", theta("np.linalg.pinv(Phi) @ Y", result="np.vstack(T)")),
    wrong(THETA, "columns", theta(result="np.array(T).T"), "rows instead of columns", "transpose"),
    wrong(THETA, "always output 0", theta(i="0"), "one output in every row", "index of the loop"),
    wrong(THETA, "last output", theta(result="T[-1]"), "one output only", "row for each"),
    wrong(THETA, "whole result", theta("np.linalg.lstsq(Phi, Y)", result="T"), "all of lstsq", "first element"),
    wrong(
        THETA,
        "signs turned",
        theta("np.linalg.lstsq(Phi, Y)[0] * np.where(np.arange(Phi.shape[1]) < n, -1, 1)"),
        "sign of a",
        "-a, b",
    ),
    wrong(
        THETA,
        "Phi of output 0 for all",
        define(
            "fit_outputs(u, y, n)",
            "Phi, _ = regressor(u, y, 0, n)\nreturn np.linalg.lstsq(Phi, y[n:])[0].T",
        ),
        "one Phi for all outputs",
        "own past",
    ),
    # 5. free run
    right(RUN, "loop over everything", LOOP_RUN.format(first=0)),
    right(
        RUN,
        "inputs filtered, then 1/A",
        define(
            "simulate_output(theta, u, n)",
            "x = sum(np.convolve(u[:, j], np.r_[0, theta[n * (j + 1) :][:n]])[: len(u)] for j in range(u.shape[1]))\n"
            "return scipy.signal.lfilter([1], np.r_[1, -theta[:n]], x).reshape(-1, 1)",
        ),
    ),
    wrong(RUN, "first input", run(inputs="[0]"), "one input only", "moved by all"),
    wrong(RUN, "signs", run(a="np.r_[1, theta[:n]]"), "sign of a", "denominator"),
    wrong(RUN, "no delay", run(b="theta[n + j * n : n + (j + 1) * n]"), "lag off by one", "begins with a zero"),
    wrong(RUN, "same block", run(b="np.r_[0, theta[n : 2 * n]]"), "one block of b", "begins at"),
    wrong(RUN, "lag by lag", run(b="np.r_[0, theta[n + j :: u.shape[1]]]"), "numbers taken lag by lag", "block of n"),
    wrong(RUN, "not added up", run(result="np.column_stack(parts)"), "runs not added up", "sum"),
    wrong(RUN, "from n", LOOP_RUN.format(first="n"), "first samples left at zero", "first n samples"),
    # 6. reference
    right(
        LOOP,
        "inv, and r in the other order",
        loop("[r[:-2], r[1:-1]]", result="np.linalg.inv(Z.T @ Phi) @ Z.T @ y[2:].reshape(-1, 1)"),
    ),
    right(
        LOOP,
        "sums in a loop",
        define(
            "fit_with_reference(u, y, r)",
            "A, b = np.zeros((2, 2)), np.zeros(2)\nfor k in range(2, len(y)):\n    z = np.array([r[k - 1], r[k - 2]])\n"
            "    A += np.outer(z, [y[k - 1], u[k - 1]])\n    b += z * y[k]\nreturn np.linalg.solve(A, b)",
        ),
    ),
    wrong(LOOP, "least squares", loop(result="np.linalg.lstsq(Phi, y[2:])[0]"), "least squares", "biased"),
    wrong(LOOP, "past inputs", loop("[u[1:-1], u[:-2]]"), "past inputs as instruments", "controller's answer"),
    wrong(LOOP, "past outputs", loop("[y[:-2], u[:-2]]"), "past outputs as instruments", "in the loop"),
    wrong(
        LOOP,
        "regressed on Z",
        loop(result="np.linalg.lstsq(Z, y[2:])[0]"),
        "regressed on the instruments",
        "regresses on Z",
    ),
    wrong(LOOP, "r(k)", loop("[r[2:], r[1:-1]]"), "lag off by one", "should hold"),
    wrong(LOOP, "sign", loop(result="np.linalg.solve(Z.T @ Phi, Z.T @ y[2:]) * [-1, 1]"), "sign of a", "theta is"),
]
