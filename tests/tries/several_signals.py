"""First tries at the assignment on several signals."""

from tries import Try

READ, OFF, PHI, THETA, RUN, LOOP = (
    "sev-1-read",
    "sev-2-offsets",
    "sev-3-phi",
    "sev-4-theta",
    "sev-5-run",
    "sev-6-reference",
)


def read(columns: str, end: str = "u, y, Ts = record.u, record.y, record.Ts") -> str:
    return f'record = load_record("TwoHeaters.csv"{columns})\n{end}'


def off(body: str) -> str:
    return f"def without_offsets(u, y):\n    {body}\n"


def phi(body: str) -> str:
    return f"def regressor(u, y, i, n):\n    N = len(y)\n    {body}\n"


def theta(body: str) -> str:
    return f"def fit_outputs(u, y, n):\n    {body}\n"


def run(body: str) -> str:
    return f"def simulate_output(theta, u, n):\n    {body}\n"


def loop(body: str) -> str:
    return f"def fit_with_reference(u, y, r):\n    {body}\n"


PHI_Y = "Phi = np.column_stack([y[1:-1], u[1:-1]]); Z = np.column_stack([r[1:-1], r[:-2]]); "
PAST = "signals = {}\n    return np.column_stack([x[n - lag : N - lag] for x in signals for lag in range(1, n + 1)]), "
FILTERS = "[scipy.signal.lfilter(np.r_[0, theta[n + j * n : n + (j + 1) * n]], np.r_[1, -theta[:n]], u[:, j]) for j in "

TRIES = (
    Try(READ, "no columns named", read(""), "which columns are inputs and which outputs"),
    Try(READ, "one name each", read(', inputs="Q1", outputs="T1"'), "flat.*if both columns were named"),
    Try(READ, "swapped", read(', inputs="T1,T2", outputs="Q1,Q2"'), "powers are inputs"),
    Try(READ, "alternating", read(', inputs="Q1,T1", outputs="Q2,T2"'), "alternate"),
    Try(
        READ,
        "first column of each",
        read(', inputs="Q1,Q2", outputs="T1,T2"', "u, y, Ts = record.u[:, 0], record.y[:, 0], record.Ts"),
        "`record.u` holds both of them",
    ),
    Try(
        READ,
        "transposed",
        read(', inputs="Q1,Q2", outputs="T1,T2"', "u, y, Ts = record.u.T, record.y.T, record.Ts"),
        "row for each signal",
    ),
    Try(
        READ, "Ts forgotten", read(', inputs="Q1,Q2", outputs="T1,T2"', "u, y = record.u, record.y"), "no variable `Ts`"
    ),
    Try(
        OFF,
        "no axis",
        off("n = np.argmax(np.any(u != u[0], axis=1)); return u - u[0], y - np.mean(y[:n])"),
        "without `axis=0` is one number",
    ),
    Try(
        OFF,
        "first input only",
        off("n = np.argmax(u[:, 0] != u[0, 0]); return u - u[0], y - y[:n].mean(axis=0)"),
        "one certain input",
    ),
    Try(OFF, "all over the record", off("return u - u[0], y - y.mean(axis=0)"), "whole record"),
    Try(OFF, "first row", off("return u - u[0], y - y[0]"), "noise"),
    Try(
        OFF,
        "nothing returned",
        off("n = np.argmax(np.any(u != u[0], axis=1)); y - y[:n].mean(axis=0)"),
        "returns nothing",
    ),
    Try(OFF, "y alone", off("n = np.argmax(np.any(u != u[0], axis=1)); return y - y[:n].mean(axis=0)"), "two arrays"),
    Try(
        OFF,
        "means of u",
        off("n = np.argmax(np.any(u != u[0], axis=1)); return u - u.mean(axis=0), y - y[:n].mean(axis=0)"),
        "first value",
    ),
    Try(
        PHI,
        "own input only",
        phi(
            "return np.column_stack([x[n - l : N - l] for x in (y[:, i], u[:, 0]) for l in range(1, n + 1)]), y[n:, i]"
        ),
        "past of one input",
    ),
    Try(
        PHI,
        "all outputs",
        phi("return np.column_stack([x[n - l : N - l] for x in (*y.T, *u.T) for l in range(1, n + 1)]), y[n:, i]"),
        "every output",
    ),
    Try(
        PHI,
        "rows of u",
        phi("return np.column_stack([x[n - l : N - l] for x in (y[:, i], *u) for l in range(1, n + 1)]), y[n:, i]"),
        "same number of rows",
    ),
    Try(
        PHI,
        "2-d blocks",
        phi("return np.column_stack([x[n - l : N - l] for l in range(1, n + 1) for x in (y[:, i], u)]), y[n:, i]"),
        "lag by lag",
    ),
    Try(
        PHI,
        "from zero",
        phi("return np.column_stack([x[n - l : N - l] for x in (y[:, i], *u.T) for l in range(n)]), y[n:, i]"),
        "1 to n",
    ),
    Try(
        PHI,
        "i from one",
        phi(
            "return np.column_stack([x[n - l : N - l] for x in (y[:, i - 1], *u.T) for l in range(1, n + 1)]), "
            "y[n:, i - 1]"
        ),
        "from zero",
    ),
    Try(
        PHI,
        "all of y in Y",
        phi("return np.column_stack([x[n - l : N - l] for x in (y[:, i], *u.T) for l in range(1, n + 1)]), y[n:]"),
        "holds all 2 outputs",
    ),
    Try(
        THETA,
        "first output",
        theta("Phi, Y = regressor(u, y, 0, n); return np.linalg.lstsq(Phi, Y)[0]"),
        "theta of one output: return a row",
    ),
    Try(
        THETA,
        "all of lstsq",
        theta("return [np.linalg.lstsq(*regressor(u, y, i, n)) for i in range(y.shape[1])]"),
        "whole results",
    ),
    Try(
        THETA,
        "columns",
        theta("return np.column_stack([np.linalg.lstsq(*regressor(u, y, i, n))[0] for i in range(y.shape[1])])"),
        "transpose",
    ),
    Try(
        THETA,
        "end to end",
        theta("return np.concatenate([np.linalg.lstsq(*regressor(u, y, i, n))[0] for i in range(y.shape[1])])"),
        "flat|end to end",
    ),
    Try(THETA, "one Phi", theta("Phi, Y = regressor(u, y, 0, n); return np.linalg.lstsq(Phi, y[n:])[0].T"), "own past"),
    Try(
        THETA,
        "inputs counted",
        theta("return np.array([np.linalg.lstsq(*regressor(u, y, 0, n))[0] for i in range(y.shape[1])])"),
        "index of the loop",
    ),
    Try(RUN, "first input", run(f"return {FILTERS} [0]][0]"), "moved by all"),
    Try(RUN, "list of runs", run(f"return np.array({FILTERS} range(u.shape[1])])"), "their sum"),
    Try(RUN, "signs", run(f"return sum({FILTERS} range(u.shape[1])])".replace("-theta", "theta")), "denominator"),
    Try(
        RUN,
        "no zero",
        run(
            f"return sum({FILTERS} range(u.shape[1])])".replace(
                "np.r_[0, theta[n + j * n : n + (j + 1) * n]]", "theta[n + j * n : n + (j + 1) * n]"
            )
        ),
        "begins with a zero",
    ),
    Try(
        RUN,
        "same b",
        run(
            f"return sum({FILTERS} range(u.shape[1])])".replace(
                "theta[n + j * n : n + (j + 1) * n]", "theta[n : 2 * n]"
            )
        ),
        "begins at",
    ),
    Try(
        RUN,
        "whole u",
        run("return scipy.signal.lfilter(np.r_[0, theta[n:]], np.r_[1, -theta[:n]], u)"),
        "from one input to the next",
    ),
    Try(
        RUN,
        "whole u, summed",
        run("return scipy.signal.lfilter(np.r_[0, theta[n:]], np.r_[1, -theta[:n]], u).sum(axis=1)"),
        "from one input to the next",
    ),
    Try(
        RUN,
        "whole u, down the columns",
        run("return scipy.signal.lfilter(np.r_[0, theta[n:]], np.r_[1, -theta[:n]], u, axis=0)"),
        "a run for each of the 2 inputs, each filtered by the b's of all",
        never="from one input to the next",
    ),
    Try(
        RUN,
        "other columns",
        run("return scipy.signal.lfilter(theta[n:], np.r_[1, -theta[:n]], u, axis=0)"),
        r"a run for each of the 2 inputs\.",
        never="from one input to the next|b's of all",
    ),
    Try(LOOP, "least squares", loop(PHI_Y + "return np.linalg.lstsq(Phi, y[2:])[0]"), "biased"),
    Try(LOOP, "on Z", loop(PHI_Y + "return np.linalg.lstsq(Z, y[2:])[0]"), "regresses on Z"),
    Try(LOOP, "elementwise", loop(PHI_Y + "return np.linalg.solve(Z.T * Phi, Z.T @ y[2:])"), "broadcast"),
    Try(
        LOOP,
        "past inputs",
        loop(PHI_Y.replace("r[1:-1], r[:-2]", "u[1:-1], u[:-2]") + "return np.linalg.solve(Z.T @ Phi, Z.T @ y[2:])"),
        "controller's answer",
    ),
    Try(
        LOOP,
        "r now",
        loop(PHI_Y.replace("r[1:-1], r[:-2]", "r[2:], r[1:-1]") + "return np.linalg.solve(Z.T @ Phi, Z.T @ y[2:])"),
        r"hold r\(k\) and r\(k-1\) beside",
    ),
    Try(LOOP, "Y forgotten", loop(PHI_Y + "return np.linalg.inv(Z.T @ Phi)"), "product with Z'Y is missing"),
    Try(
        LOOP,
        "inverse times entry by entry",
        loop(PHI_Y + "return np.linalg.inv(Z.T @ Phi) * (Z.T @ y[2:])"),
        "Z'Phi and Z'Y entry by entry",
        never="is missing",
    ),
    Try(
        LOOP,
        "u now",
        loop(PHI_Y.replace("u[1:-1]", "u[2:]") + "return np.linalg.solve(Z.T @ Phi, Z.T @ y[2:])"),
        "holds u\\(k\\)",
    ),
    Try(
        "sev-6-reference",
        "a row too early",
        "def fit_with_reference(u, y, r):\n    Phi = np.column_stack([y[:-1], u[:-1]])\n"
        "    Z = np.column_stack([r[:-1], np.r_[0, r[:-2]]])\n    return np.linalg.solve(Z.T @ Phi, Z.T @ y[1:])\n",
        "begin with k = 2",
    ),
    Try(
        "sev-1-read", "no names", "record = load_record('TwoHeaters.csv')", "which columns are inputs and which outputs"
    ),
    Try(READ, "lists", read(', inputs=["Q1", "Q2"], outputs=["T1", "T2"]'), "with commas between the names"),
    Try(
        READ,
        "the record itself",
        read(', inputs="Q1,Q2", outputs="T1,T2"', "u, y, Ts = record"),
        "parts of a record have names",
    ),
    Try(
        PHI,
        "inputs by lag",
        phi(
            "c = [y[n - l : N - l, i] for l in range(1, n + 1)] + [u[n - l : N - l] for l in range(1, n + 1)]\n"
            "    return np.column_stack(c), y[n:, i]"
        ),
        "inputs lag by lag",
    ),
    Try(
        THETA,
        "return in the loop",
        theta(
            "T = []\n    for i in range(y.shape[1]):\n        T.append(np.linalg.lstsq(*regressor(u, y, i, n))[0])\n"
            "        return np.array(T)"
        ),
        "Yours is that of output 0",
    ),
    Try(RUN, "two inputs", run(f"return sum({FILTERS}range(2)])"), "uses 2 of its 3 inputs"),
    Try(
        RUN,
        "all of b",
        run("return sum(scipy.signal.lfilter(np.r_[0, theta[n:]], np.r_[1, -theta[:n]], c) for c in u.T)"),
        "by the b's of all",
    ),
    Try(
        RUN,
        "slices not reversed",
        run(
            "y = np.zeros(len(u))\n    for k in range(n, len(u)):\n        y[k] = theta[:n] @ y[k - n : k]\n"
            "        y[k] += sum(theta[n + j * n : n + (j + 1) * n] @ u[k - n : k, j] for j in range(u.shape[1]))\n"
            "    return y"
        ),
        "oldest lag first",
    ),
    Try(
        READ,
        "all times",
        read(', inputs="Q1,Q2", outputs="T1,T2"', "u, y, Ts = record.u, record.y, record.t"),
        "`Ts` holds all times",
    ),
    Try(
        OFF,
        "all have moved",
        off("n = np.argmax(np.all(u != u[0], axis=1))\n    return u - u[0], y - y[:n].mean(axis=0)"),
        "when the last input moves, or one",
    ),
    Try(
        OFF,
        "entries counted",
        off("n = np.argmax(u != u[0])\n    return u - u[0], y - y[:n].mean(axis=0)"),
        "counts entries of the table",
        never="last input",
    ),
    Try(
        PHI,
        "two inputs",
        phi(
            "c = [x[n - l : N - l] for x in (y[:, i], u[:, 0], u[:, 1]) for l in range(1, n + 1)]\n"
            "    return np.column_stack(c), y[n:, i]"
        ),
        "past of 2 of the 3 inputs",
    ),
    Try(
        PHI,
        "all outputs in Y",
        phi(
            "c = [x[n - l : N - l] for x in (y[:, i], *u.T) for l in range(1, n + 1)]\n"
            "    return np.column_stack(c), y[n:]"
        ),
        "holds all 2 outputs",
    ),
    Try(
        RUN,
        "blocks that overlap",
        run(f"return sum({FILTERS.replace('n + j * n : n + (j + 1) * n', 'n + j : 2 * n + j')}range(u.shape[1])])"),
        "begins the b's of input j at n \\+ j;",
    ),
    Try(
        LOOP,
        "regressed on Z, later lag first",
        loop("Z = np.column_stack([r[:-2], r[1:-1]]); return np.linalg.solve(Z.T @ Z, Z.T @ y[2:])"),
        "regresses on Z",
    ),
    Try(
        PHI,
        "two lags always",
        phi("c = [x[n - l : N - l] for x in (y[:, i], *u.T) for l in (1, 2)]\n    return np.column_stack(c), y[n:, i]"),
        "2 for each signal: n is 3",
        never="one input",
    ),
    Try(
        RUN,
        "b from the first number",
        run(f"return sum({FILTERS.replace('n + j * n : n + (j + 1) * n', 'j * n : (j + 1) * n')}range(u.shape[1])])"),
        "the first n numbers of theta are -a",
    ),
    Try(
        READ,
        "first values taken off",
        read(', inputs="Q1,Q2", outputs="T1,T2"', "u, y, Ts = record.u - record.u[0], record.y, record.Ts"),
        "without its offset",
    ),
    Try(
        READ,
        "one input twice",
        read(', inputs="Q1,Q2", outputs="T1,T2"', "u, y, Ts = record.u[:, [0, 0]], record.y, record.Ts"),
        "same signal",
    ),
    Try(
        OFF,
        "u as it is",
        off("n = np.argmax(np.any(u != u[0], axis=1))\n    return u, y - y[:n].mean(axis=0)"),
        "returns u as it is",
    ),
    Try(OFF, "y as it is", off("return u - u[0], y"), "returns y as it is"),
    Try(OFF, "axis 1", off("return u - u[0], y - y.mean(axis=1, keepdims=True)"), "means over the signals"),
    Try(PHI, "inputs backwards", phi(PAST.format("[y[:, i], *u.T[::-1]]") + "y[n:, i]"), "has the last input first"),
    Try(
        PHI,
        "Y one sample early",
        phi(PAST.format("[y[:, i], *u.T]") + "y[n - 1 : -1, i]"),
        "Phi of .* is right.*Y: it is 1 sample early",
    ),
    Try(PHI, "Y too long", phi(PAST.format("[y[:, i], *u.T]") + "y[:, i]"), r"one y\(k\) for each row"),
    Try(
        PHI,
        "rolled",
        phi("return np.column_stack([np.roll(x, lag) for x in [y[:, i], *u.T] for lag in range(1, n + 1)]), y[:, i]"),
        "goes round.*begin with k = n",
    ),
    Try(
        PHI,
        "a row lost",
        phi(
            PAST.format("[y[:, i], *u.T]").replace("return np", "Phi = np").rstrip(", ")
            + "\n    return Phi[1:], y[n + 1:, i]"
        ),
        "rows for .* samples",
    ),
    Try(
        THETA,
        "Phi'Y",
        theta("return np.array([P.T @ Y for P, Y in (regressor(u, y, i, n) for i in range(y.shape[1]))])"),
        "inverse of Phi'Phi is missing",
    ),
    Try(
        THETA,
        "last output first",
        theta("return np.array([np.linalg.lstsq(*regressor(u, y, i, n))[0] for i in range(y.shape[1])])[::-1]"),
        "rows in the wrong order",
    ),
    Try(
        THETA,
        "half of the record",
        theta(
            "h = len(y) // 2\n    return np.array([np.linalg.lstsq(*regressor(u[:h], y[:h], i, n))[0] "
            "for i in range(y.shape[1])])"
        ),
        "fits the first half",
    ),
    Try(
        RUN,
        "inputs backwards",
        run(f"u = u[:, ::-1]\n    return sum({FILTERS}range(u.shape[1])])"),
        "inputs in reverse order",
    ),
    Try(
        RUN,
        "nothing fed back",
        run(f"return sum({FILTERS}range(u.shape[1])])".replace("np.r_[1, -theta[:n]]", "[1.0]")),
        "feeds nothing back",
    ),
    Try(LOOP, "Phi'Z", loop(PHI_Y + "return np.linalg.solve(Phi.T @ Z, Z.T @ y[2:])"), "solves with Phi'Z"),
    Try(LOOP, "exchanged", loop(PHI_Y + "return np.linalg.solve(Phi.T @ Z, Phi.T @ y[2:])"), "Phi and Z exchanged"),
    Try(LOOP, "b first", loop(PHI_Y + "return np.linalg.solve(Z.T @ Phi, Z.T @ y[2:])[::-1]"), "returns b first"),
    Try(LOOP, "Z'Y", loop(PHI_Y + "return Z.T @ y[2:]"), "inverse of Z'Phi is missing"),
)
