"""First tries at the lecture on model structures."""

from tries import ACCEPTED, Try

SHIFT, SS, EQ, SIM, EX, PRED, F8, EXC, ORD, CAN, AUTO = (
    "ms-2-shift", "ms-3-state-space", "ms-4-equations", "ms-5-simulate", "ms-5-example-3-1", "ms-6-predict",
    "ms-6-figure-8", "ms-7-excitation", "ms-8-order", "ms-9-cancel", "ms-10-autocorrelation",
)  # fmt: skip


def f(head: str, body: str) -> str:
    return f"def {head}:\n    {body}\n"


def space(last: str = "-a[:0:-1]", C: str = "(b - b[0] * a)[:0:-1].reshape(1, n)", D: str = "[[b[0]]]",
          pad: str = "[np.zeros(n + 1 - len(num)), num]") -> str:  # fmt: skip
    return f(
        "state_space(num, den)",
        f"n = len(den) - 1\n    a = np.array(den) / den[0]\n    b = np.concatenate({pad}) / "
        f"den[0]\n    A = np.eye(n, k=1)\n"
        f"    A[-1] = {last}\n    B = np.zeros((n, 1))\n    B[-1, 0] = 1\n    return A, B, {C}, np.array({D})",
    )


def eq(
    ys: str = "[-y[k0 - i : N - i] for i in range(1, na + 1)]",
    us: str = "[u[k0 - i : N - i] for i in range(d, d + nb)]",
    k0: str = "max(na, d + nb - 1) if nb else na",
    end: str = "np.column_stack(ys + us), y[k0:]",
) -> str:
    return f("equations(u, y, na, nb, d)", f"N = len(y)\n    k0 = {k0}\n    ys = {ys}\n    us = {us}\n    return {end}")


def ex(body: str) -> str:
    return f("example_3_1(u, y)", body) + "\n\ntheta_1 = example_3_1(u_1, y_1)\ntheta_2 = example_3_1(u_2, y_2)"


def pred(predict: str, run: str = "scipy.signal.lfilter(B, A, u)") -> str:
    return (
        f("predict(A, B, u, y)", f"return {predict}")
        + "\n"
        + f("free_run(A, B, u)", f"return {run}")
        + "\nA_1, B_1 = [1, theta_1[0]], [0, theta_1[1]]\ny_hat = predict(A_1, B_1, u_1, "
        "y_1)\ny_sim = free_run(A_1, B_1, u_1)"
    )


def order(
    V: str = "np.mean(E**2)",
    start: str = "max(orders)",
    crit: str = "N * np.log(V) + 2 * p, N * np.log(V) + p * np.log(N), V * (1 + p / N) / (1 - p / N)",
) -> str:
    return (
        f"def losses(u, y, orders):\n    N, V = len(y), []\n    for n in orders:\n        start = {start}\n"
        "        c = [-y[start - i : N - i] for i in range(1, n + 1)] + [u[start - i : N - i] for "
        "i in range(1, n + 1)]\n"
        "        Phi, Y = np.column_stack(c), y[start:]\n        E = Y - Phi @ np.linalg.lstsq(Phi, Y)[0]\n"
        f"        V.append({V})\n    return np.array(V)\n\n\ndef criteria(V, N, p):\n    return {crit}\n"
    )


def cancelled(P: str = "P", Q: str = "Q", test: str = "abs(r - s) < within", copy: str = "list(q)",
              end: str = "break", real: str = ".real") -> str:  # fmt: skip
    return f(
        "cancel(P, Q, within)",
        f"p, q = list(np.roots({P})), list(np.roots({Q}))\n    for s in {copy}:\n        for r in list(p):\n"
        f"            if {test}:\n                p.remove(r)\n                q.remove(s)\n                {end}\n"
        f"    return np.atleast_1d(np.poly(p)){real}, np.atleast_1d(np.poly(q)){real}",
    )


LF = "scipy.signal.lfilter"
RANK = "np.linalg.matrix_rank(np.column_stack([u[largest - 1 - i : len(u) - i] for i in range(largest)]))"
SPECTRUM = "U = np.abs(np.fft.rfft(u))\n    return min(largest, int(np.sum(U > 1e-6 * U.max())))"
CRITERIA = "N * np.log(V) + 2 * p, N * np.log(V) + p * np.log(N), {}"
AUTOCORRELATION = f("autocorrelation(e, lags)", "N, d = len(e), e - np.mean(e)\n    return {}")

TRIES = (
    Try(SHIFT, "full convolution", f("apply(P, x)", "return np.convolve(P, x)"), "more samples"),
    Try(SHIFT, "product", f("apply(P, x)", "return P * x"), "do not pair up"),
    Try(SHIFT, "lfilter wrong way", f("apply(P, x)", "return scipy.signal.lfilter([1], P, x)"), "divides by P"),
    Try(SHIFT, "roll", f("apply(P, x)", "return sum(P[i] * np.roll(x, i) for i in range(len(P)))"), "go round"),
    Try(SHIFT, "unequal", f("apply(P, x)", "return P[0] * x + P[1] * x[:-1]"), "cover the same samples"),
    Try(
        SHIFT,
        "two only",
        f("apply(P, x)", "return P[0] * x + P[1] * np.r_[0, x[:-1]]"),
        "lowest|column|wrong|coefficient|sample by sample",
    ),
    Try(SS, "signs", space("a[:0:-1]"), "other sign of a"),
    Try(SS, "order of the row", space("-a[1:]"), "last row of A is in reverse"),
    Try(SS, "C of b", space(C="b[:0:-1].reshape(1, n)"), "b_i - b0 a_i"),
    Try(SS, "D zero", space(D="[[0]]"), "D = 0"),
    Try(SS, "padded behind", space(pad="[num, np.zeros(n + 1 - len(num))]"), "at its end"),
    Try(SS, "three", space().replace(", np.array([[b[0]]])", ""), "four matrices"),
    Try(EQ, "plus", eq("[y[k0 - i : N - i] for i in range(1, na + 1)]"), "has \\+y"),
    Try(
        EQ,
        "d + nb",
        eq(us="[u[k0 - i : N - i] for i in range(d, d + nb + 1)]", k0="max(na, d + nb)"),
        "column too many",
    ),
    Try(EQ, "lag 1", eq(us="[u[k0 - i : N - i] for i in range(1, nb + 1)]"), "wrong lags"),
    Try(EQ, "from 0", eq("[-y[k0 - i : N - i] for i in range(na)]"), "y\\(k\\) in the row"),
    Try(EQ, "Y whole", eq(end="np.column_stack(ys + us), y"), "one y\\(k\\) for each row.*What is wrong is Y"),
    Try(EQ, "no case nb = 0", eq(k0="d + nb - 1"), "One is empty"),
    Try(
        SIM,
        "plus a",
        f(
            "simulate(A, B, C, u, e)",
            "return scipy.signal.lfilter(B, np.r_[1, -np.array(A[1:])], u) + scipy.signal.lfilter(C, "
            "np.r_[1, -np.array(A[1:])], e)",
        ),
        "adds the past outputs",
    ),
    Try(
        SIM,
        "noise at the output",
        f("simulate(A, B, C, u, e)", "return scipy.signal.lfilter(B, A, u) + e"),
        "behind the plant",
    ),
    Try(
        SIM,
        "C not used",
        f("simulate(A, B, C, u, e)", "return scipy.signal.lfilter(B, A, u) + scipy.signal.lfilter([1], A, e)"),
        "takes e for C e",
    ),
    Try(
        SIM,
        "list slice sign",
        f("simulate(A, B, C, u, e)", "return scipy.signal.lfilter(B, -A, u) + scipy.signal.lfilter(C, -A, e)"),
        "right but for its sign",
    ),
    Try(EX, "plus y", ex("return np.linalg.lstsq(np.column_stack([y[:-1], u[:-1]]), y[1:])[0]"), "returns -a first"),
    Try(
        EX,
        "sign turned twice",
        ex("a, b = np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1]]), y[1:])[0]\n    return np.array([-a, b])"),
        "returns -a first",
    ),
    Try(EX, "same time", ex("return np.linalg.lstsq(np.column_stack([-y[:-1], u[1:]]), y[1:])[0]"), "lag wrong"),
    Try(EX, "lengths", ex("return np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1]]), y)[0]"), "same number of rows"),
    Try(
        EX,
        "u_1 inside",
        ex("return np.linalg.lstsq(np.column_stack([-y_1[:-1], u_1[:-1]]), y_1[1:])[0]"),
        "whatever is handed in",
    ),
    Try(PRED, "free run", pred("scipy.signal.lfilter(B, A, u)"), "feeds on its own outputs"),
    Try(
        PRED,
        "no + y",
        pred("scipy.signal.lfilter(B, [1], u) - scipy.signal.lfilter(A, [1], y)"),
        "without y\\(k\\)|prediction error",
    ),
    Try(
        PRED,
        "sign",
        pred("scipy.signal.lfilter(B, [1], u) + scipy.signal.lfilter(A, [1], y) - y"),
        "adds the past outputs",
    ),
    Try(
        PRED,
        "A and B",
        pred("scipy.signal.lfilter(B, [1], u) - scipy.signal.lfilter(A, [1], y) + y", "scipy.signal.lfilter(A, B, u)"),
        "Here it begins with zero, as a numerator",
    ),
    Try(
        F8,
        "all samples",
        "t_8 = np.arange(100)\nfig_8, ax = plt.subplots()\nax.plot(y_1)\nax.plot(y_hat)\nax.plot(y_sim)",
        "so many samples",
    ),
    Try(F8, "lengths", "t_8 = np.arange(100)\nfig_8, ax = plt.subplots()\nax.plot(t_8, y_1)", "same length"),
    Try(
        EXC,
        "zeros before",
        f(
            "excitation(u, largest)",
            "for n in range(1, largest + 1):\n        M = np.column_stack([np.r_[np.zeros(i), "
            "u[:len(u) - i]] for i in range(n)])\n        if np.linalg.matrix_rank(M) < n:\n          "
            "  return n - 1\n    return largest",
        ),
        "it fills zeros in before the first sample",
        never="rounding",
    ),
    Try(
        EXC,
        "rounding taken for rank",
        f(
            "excitation(u, largest)",
            "for n in range(1, largest + 1):\n        M = np.column_stack([u[n - 1 - i : len(u) - i] for i in "
            "range(n)])\n        if np.linalg.matrix_rank(M, tol=0) < n:\n            return n - 1\n    return largest",
        ),
        "rounding errors of about 1e-16 for rank",
        never="fills zeros",
    ),
    Try(
        EXC,
        "first failing",
        f(
            "excitation(u, largest)",
            "for n in range(1, largest + 1):\n        M = np.lib.stride_tricks.sliding_window_view(u, "
            "n)\n        if np.linalg.matrix_rank(M) < n:\n            return n\n    return largest",
        ),
        "one too high",
    ),
    Try(
        EXC,
        "distinct values",
        f("excitation(u, largest)", "return min(len(set(np.round(u, 9))), largest)"),
        "different values",
    ),
    Try(ORD, "own rows", order(start="n"), "rows of its own"),
    Try(ORD, "sum", order("np.sum(E**2)"), "sums"),
    Try(
        ORD,
        "log10",
        order(crit="N * np.log10(V) + 2 * p, N * np.log10(V) + p * np.log10(N), V * (1 + p / N) / (1 - p / N)"),
        "base 10",
    ),
    Try(
        ORD,
        "AIC price",
        order(crit="N * np.log(V) + p, N * np.log(V) + p * np.log(N), V * (1 + p / N) / (1 - p / N)"),
        "AIC is p:",
    ),
    Try(
        ORD,
        "FPE upside down",
        order(crit="N * np.log(V) + 2 * p, N * np.log(V) + p * np.log(N), V * (1 - p / N) / (1 + p / N)"),
        r"above and \(1",
    ),
    Try(CAN, "nothing", f("cancel(P, Q, within)", "return P, Q"), "nearer than `within`"),
    Try(
        CAN,
        "roots",
        f(
            "cancel(P, Q, within)",
            "p, q = list(np.roots(P)), []\n    for r in np.roots(Q):\n        n = [x for x in p if "
            "abs(x - r) < within]\n        if n: p.remove(n[0])\n        else: q.append(r)\n    "
            "return p, q",
        ),
        "returns roots",
    ),
    Try(
        CAN,
        "in and equal",
        f(
            "cancel(P, Q, within)",
            "p, q = list(np.roots(P)), list(np.roots(Q))\n    for r in list(q):\n        if r in p:\n "
            "           p.remove(r); q.remove(r)\n    return np.poly(p), np.poly(q)",
        ),
        "nearer than `within`",
    ),
    Try(
        AUTO,
        "mean left in",
        f(
            "autocorrelation(e, lags)",
            "N = len(e)\n    return np.array([e[k:] @ e[:N - k] for k in range(lags + 1)]) / (e @ e)",
        ),
        "mean in",
    ),
    Try(
        AUTO,
        "lags",
        f(
            "autocorrelation(e, lags)",
            "e = e - e.mean(); N = len(e)\n    return np.array([e[k:] @ e[:N - k] for k in range(lags)]) / (e @ e)",
        ),
        "one value too few",
    ),
    Try(
        AUTO,
        "e[:-k]",
        f(
            "autocorrelation(e, lags)",
            "e = e - e.mean()\n    return np.array([e[k:] @ e[:-k] for k in range(lags + 1)]) / (e @ e)",
        ),
        "takes nothing",
    ),
    Try(
        AUTO,
        "covariances",
        f(
            "autocorrelation(e, lags)",
            "e = e - e.mean(); N = len(e)\n    return np.array([e[k:] @ e[:N - k] for k in range(lags + 1)]) / N",
        ),
        "covariances",
    ),
    Try(
        AUTO,
        "corrcoef",
        f(
            "autocorrelation(e, lags)",
            "N = len(e)\n    return np.array([np.corrcoef(e[k:], e[:N - k])[0, 1] for k in range(lags + 1)])",
        ),
        "own mean",
    ),
    Try(
        EQ,
        "range ends early",
        "def equations(u, y, na, nb, d):\n    k0 = max(na, d + nb - 1) if nb else na\n"
        "    rows = [[-y[k - i] for i in range(1, na)] + [u[k - d - i] for i in range(nb)]"
        " for k in range(k0, len(y))]\n"
        "    return np.array(rows), y[k0:]\n",
        "one too few",
    ),
    Try(
        EXC,
        "one for nothing",
        "def excitation(u, largest):\n    for n in range(largest, 0, -1):\n"
        "        M = np.column_stack([u[n - 1 - i : len(u) - i] for i in range(n)])\n"
        "        if np.linalg.matrix_rank(M) == n:\n            return n\n    return 1\n",
        "zero throughout",
        never="rounding",
    ),
    Try(SS, "not reversed", space("-a[1:]", "(b - b[0] * a)[1:].reshape(1, n)"), "both the last row of A and C"),
    Try(SS, "B", space().replace("B[-1, 0]", "B[0, 0]"), "B of .* first row"),
    Try(EQ, "delay not used", eq(us="[u[k0 - i : N - i] for i in range(1, nb + 1)]", k0="max(na, nb)"), "wrong lags"),
    Try(EQ, "rows too early", eq(k0="max(na, nb)"), "One is empty.*below zero", never="wrong lags"),
    Try(
        SIM,
        "times A",
        f("simulate(A, B, C, u, e)", f"return {LF}(A, [1], {LF}(B, [1], u) + {LF}(C, [1], e))"),
        "divide by A",
    ),
    Try(SIM, "u + e", f("simulate(A, B, C, u, e)", f"return {LF}(B, A, u + e)"), "e through B"),
    Try(SIM, "C for both", f("simulate(A, B, C, u, e)", f"return {LF}(C, A, {LF}(B, [1], u) + e)"), "input through C"),
    Try(
        EX, "same samples", ex("return np.linalg.lstsq(np.column_stack([-y, u]), y)[0]"), "explains y\\(t\\) by itself"
    ),
    Try(EXC, "true or false", f("excitation(u, largest)", f"return {RANK} == largest"), "True or False"),
    Try(
        EXC,
        "lines of the spectrum",
        f("excitation(u, largest)", SPECTRUM),
        "as if it went round.*frequencies are counted",
        never="filled in",
    ),
    Try(ORD, "no brackets", order(crit=CRITERIA.format("V*1 + p/N/1 - p/N")), "FPE lacks brackets"),
    Try(ORD, "brackets above", order(crit=CRITERIA.format("V * (1 + p/N) / 1 - p/N")), "FPE lacks brackets"),
    Try(ORD, "half", order(crit=CRITERIA.format("V * (1 + p/N)")), "two factors", never="brackets"),
    Try(CAN, "turned round", cancelled("P[::-1]", "Q[::-1]"), "list turned round"),
    Try(CAN, "no abs", cancelled(test="r - s < within"), "`abs\\(p - q\\)`"),
    Try(CAN, "no copy", cancelled(copy="q"), "one is left"),
    Try(CAN, "no break", cancelled(end="pass"), "leave the inner loop"),
    Try(CAN, "no .real", cancelled(real=""), "", ACCEPTED),
    Try(
        AUTO,
        "std",
        AUTOCORRELATION.format("np.array([d[k:] @ d[: N - k] for k in range(lags + 1)]) / N / np.std(e)"),
        "deviation",
    ),
    Try(AUTO, "correlate", AUTOCORRELATION.format("np.correlate(d, d, 'full')[: lags + 1] / (d @ d)"), "in its middle"),
    Try(
        EXC,
        "beyond largest",
        f(
            "excitation(u, largest)",
            f"n = 0\n    while {RANK.replace('largest', '(n + 1)')} == n + 1: n += 1\n    return n",
        ),
        "goes on beyond `largest`",
    ),
    Try(SHIFT, "polyval", f("apply(P, x)", "return np.polyval(P, x)"), "as `np.polyval` does"),
    Try(EQ, "lags of no inputs", eq(k0="max(na, d + nb - 1)"), "With nb = 0 there are no inputs"),
    Try(
        EQ,
        "begins late without inputs",
        eq(k0="max(na, d + nb - 1) if nb else na + 1"),
        "later than it has to",
        never="nb = 0",
    ),
    Try(EQ, "delay not in k0", eq(k0="max(na, nb)"), "One is empty.*below zero"),
    Try(
        SIM,
        "divided by C",
        f("simulate(A, B, C, u, e)", "return scipy.signal.lfilter(B, A, u) + scipy.signal.lfilter([1], C, e)"),
        "divides the noise by C",
    ),
    Try(
        SIM,
        "C at the output",
        f("simulate(A, B, C, u, e)", "return scipy.signal.lfilter(B, A, u) + scipy.signal.lfilter(C, [1], e)"),
        "behind the plant",
        never="divides the noise",
    ),
    Try(PRED, "simulation plus y", pred("scipy.signal.lfilter(B, A, u) + y"), r"adds the measured y\(k\)"),
    Try(PRED, "A[1] and B[1]", pred("np.r_[0, -A[1] * y[:-1] + B[1] * u[:-1]]"), "only the first two coefficients"),
    Try(
        PRED,
        "run of A[1] and B[1]",
        pred(
            "scipy.signal.lfilter(B, [1], u) - scipy.signal.lfilter(A, [1], y) + y",
            "scipy.signal.lfilter(B[:2], A[:2], u)",
        ),
        "`free_run` uses only the first two",
    ),
    Try(
        PRED,
        "u(k) early",
        pred("scipy.signal.lfilter(B[1:], [1], u) - scipy.signal.lfilter(A, [1], y) + y"),
        "one sample early",
        never="coefficients",
    ),
    Try(
        EXC,
        "two for each frequency",
        f(
            "excitation(u, largest)",
            "U = np.abs(np.fft.rfft(u))\n    return min(largest, 2 * int(np.sum(U > 1e-6 * U.max())))",
        ),
        "counts the frequencies",
    ),
    Try(ORD, "rows left out twice", order(start="n + max(orders)"), r"begins at sample n already"),
    Try(
        ORD,
        "AIC of p",
        order(crit="N * np.log(V) + p, N * np.log(V) + p * np.log(N), V * (1 + p / N) / (1 - p / N)"),
        "AIC is p:",
    ),
    Try(
        ORD,
        "BIC of N ln p",
        order(crit="N * np.log(V) + 2 * p, N * np.log(V) + N * np.log(p), V * (1 + p / N) / (1 - p / N)"),
        "BIC is N ln p:",
        never="is p:",
    ),
    Try(
        SIM,
        "first order only",
        "def simulate(A, B, C, u, e):\n    y = np.zeros(len(u))\n    for k in range(1, len(u)):\n"
        "        y[k] = -A[1] * y[k - 1] + B[1] * u[k - 1] + e[k]\n    return y\n",
        r"only A\[1\] and B\[1\]",
    ),
    Try(EQ, "from the end", eq(k0="N"), "returns no rows"),
    Try(
        EQ,
        "minus before the inputs",
        eq(us="[-u[k0 - i : N - i] for i in range(d, d + nb)]"),
        "minus before the inputs",
    ),
    Try(
        SS,
        "all of den in the last row",
        f(
            "state_space(num, den)",
            "n = len(den)\n    A = np.eye(n, k=1)\n    A[-1] = -np.array(den[::-1])\n    B = np.zeros((n, 1))\n"
            "    B[-1, 0] = 1\n    C = np.r_[num[::-1], np.zeros(n - len(num))].reshape(1, n)\n"
            "    return A, B, C, np.zeros((1, 1))",
        ),
        "makes 3 states",
    ),
    Try(
        ORD,
        "V in place of its logarithm",
        order(crit="N * V + 2 * p, N * V + p * np.log(N), V * (1 + p / N) / (1 - p / N)"),
        "takes V itself",
    ),
    Try(ORD, "outputs squared", order("np.mean(Y**2)"), "mean square of y"),
    Try(
        SHIFT,
        "first sample held",
        f(
            "apply(P, x)",
            "n = len(P)\n    before = np.r_[np.full(n, x[0]), x]\n"
            "    return sum(P[i] * before[n - i : n - i + len(x)] for i in range(n))",
        ),
        "repeats the first sample",
    ),
    Try(SIM, "noise alone", f("simulate(A, B, C, u, e)", f"return {LF}(C, A, e)"), "leaves the input out"),
    Try(
        SIM,
        "input not through 1/A",
        f("simulate(A, B, C, u, e)", f"return {LF}(B, [1], u) + {LF}(C, A, e)"),
        "noise alone run through",
    ),
    Try(
        CAN,
        "what they share",
        f(
            "cancel(P, Q, within)",
            "p, q = np.roots(P), np.roots(Q)\n"
            "    pairs = (p, q), (q, p)\n    return [np.atleast_1d(np.poly([r for r in one\n"
            "        if np.min(abs(other - r), initial=1e9) < within])).real for one, other in pairs]",
        ),
        "what they have in common",
    ),
)
