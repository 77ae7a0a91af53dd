"""Tries with two mistakes at once, and with one symptom of several causes; each has neighbours with another cause."""

from tries import Try
from tries.rows_of_tries import in_rows

_LOOP = (
    "def first_period(u):\n    n = 1\n    while u[n] == u[0]:\n        n += 1\n{}\n\nn_first = first_period(u_act)\n"
)
_CURVES = (
    "fig_5, (ax_a, ax_b) = plt.subplots(2, 1, layout='constrained')\nax_a.plot(t, y_actm{})\nax_a.plot(t, y_act{})\n"
    "ax_a.legend({})\nax_a.set(xlabel='Time (s)', ylabel='Output (V)')\nax_b.step(t, u_act, where='post')\n"
    "ax_b.set(xlabel='Time (s)', ylabel='Input (V)')"
)
_RUN = "y_sim = np.zeros(len(u))\nfor k in range({}, len(u)):\n    y_sim[k] = {}\n"
_START = (
    "def simulate_from_start(u, y):\n    A, B, C, D = G_ss.A, G_ss.B, G_ss.C, G_ss.D\n    T = np.arange(len(u)) * Ts\n"
    "    r = ct.forced_response(G_ss, T, u).outputs\n    O = np.array([(C @ np.linalg.matrix_power(A, k))[0] for k in "
    "range(len(u))])\n{}\n"
)
_LEVELS = (
    "def read_step(t, y, amplitude):\n    y_a = np.mean(y[:20])\n    y_b = y[-1]\n    way = (y - y_a) / (y_b - y_a)\n"
    "    t63 = t[np.argmax(way >= 0.632)]\n    t28 = t[np.argmax(way >= {})]\n    tau = {} * (t63 - t28)\n"
    "    return (y_b - y_a) / amplitude, tau, t63 - tau\n"
)
_FREQUENCY = (
    "def fit_frequency(t, y, low, high):\n    scan = np.linspace(low, high, 2000)\n    found = []\n    for w in scan:\n"
    "        H = np.column_stack([np.sin(w * t), np.cos(w * t)])\n        e = y - H @ np.linalg.lstsq(H, y)[0]\n"
    "        found.append(e @ e)\n    return scan[{}(found)]{}\n"
)
_LAYOUT = (
    "def layout(beacons):\n    dx, dy = np.ptp(beacons, axis=0)\n    if dx < {0} and dy < {0}:\n"
    "        return 'undetermined'\n    return 'mirror' if dx < {0} or dy < {0} or len(beacons) == 2 else 'unique'\n"
)
_READ = "K = max(y_step) / 2\nt63 = t_step[np.{}]\nt28 = t_step[np.{}]\ntau = 1.5 * (t63 - t28)\ntd = t63 - tau"


def _legend(first: str, second: str, texts: str) -> str:
    return _CURVES.format(first, second, texts)


def _loss(value: str) -> str:
    return f"def loss(Phi, Y, theta):\n    e = error_vector(Phi, Y, theta)\n    return {value}\n"


def _gradient(step: str) -> str:
    return (
        "def gradient(Phi, Y, theta):\n    g = np.zeros(len(theta))\n    for i in range(len(theta)):\n"
        f"        d = np.zeros(len(theta))\n        d[i] = {step}\n"
        f"        g[i] = (loss(Phi, Y, theta + d) - loss(Phi, Y, theta)) / ({step})\n    return g\n"
    )


def _best(result: str) -> str:
    return f"def best_theta(Phi, Y):\n    theta = np.linalg.solve(Phi.T @ Phi, Phi.T @ Y)\n    return {result}\n"


def _response(formula: str) -> str:
    return f"def first_order_response(t, K, tau, td, amplitude):\n    s = np.maximum(t - td, 0)\n    return {formula}\n"


def _derivatives(gradient: str, jacobian: str = "(x @ x) * np.eye(len(x)) + 2 * np.outer(x, x)") -> str:
    return f"def gradient_form(A, x):\n    return {gradient}\n\n\ndef jacobian_cubic(x):\n    return {jacobian}\n"


def _step(numerator: str, denominator: str = "(1 + phi @ P @ phi)", sign: str = "-") -> str:
    return (
        f"def rls_step(theta, P, phi, y):\n    P = P {sign} {numerator} / {denominator}\n"
        "    return theta + P @ phi * (y - phi @ theta), P\n"
    )


def _drift(value: str) -> str:
    return (
        f"def tracking_mse(lam, slope, sigma):\n    return {value}\n\n\ndef best_forgetting(slope, sigma):\n"
        "    lams = np.arange(0.5, 0.9995, 0.001)\n"
        "    return lams[np.argmin([tracking_mse(x, slope, sigma) for x in lams])]\n"
    )


def _limit(variance: str, pull: str = "a - c * var_e / vy") -> str:
    return (
        f"def limit_of_least_squares(a, b, c, var_u, var_e):\n    vy = {variance}\n    return np.array([{pull}, b])\n"
    )


def _likelihood(value: str, before: str = "N = len(Y)") -> str:
    return f"def log_likelihood(theta, var_e, Phi, Y):\n    E = Y - Phi @ theta\n    {before}\n    return {value}\n"


def _closed(value: str) -> str:
    return (
        f"def share_closed(mse_after, mse_before, sigma):\n    return {value}\n\n\n"
        "closed = share_closed(np.mean((simulate_better(u_act) - y_act)[half:] ** 2), gap_before**2, noise_sd)\n"
    )


def _simulate(terms: str) -> str:
    return (
        "def simulate(A, B, C, u, e):\n    def at(x, k):\n        return x[k] if k >= 0 else 0.0\n\n"
        f"    y = np.zeros(len(u))\n    for k in range(len(u)):\n        y[k] = {terms}\n    return y\n"
    )


_PAST_Y = "sum(a * at(y, k - i - 1) for i, a in enumerate(A[1:]))"
_OF_U = "sum(b * at(u, k - i) for i, b in enumerate(B))"
_OF_E = "sum(c * at(e, k - i) for i, c in enumerate(C))"
_VARIANCE = "(b**2 * var_u + (1 + c**2 - 2 * a * c) * var_e) / (1 - a**2)"
_POWERS = (
    "def inverse_weights(A):\n    n = len(A)\n    cols = [({}).ravel() for k in range(n)]\n"
    "    return np.linalg.lstsq(np.column_stack(cols), np.linalg.inv(A).ravel())[0]{}\n"
)
_OUTPUT_ERROR = (
    "def fit_output_error(u, y):\n    start = np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1]]), y[1:])[0]\n"
    "    def err(q):\n        return scipy.signal.lfilter({}, {}, u) - y\n"
    "    return scipy.optimize.least_squares(err, start).x{}\n"
)
_RUNS = (
    "def simulate_output(theta, u, n):\n    a = np.r_[1, -theta[:n]]\n    out = np.zeros(len(u))\n"
    "    for j in range(u.shape[1]):\n        b = {}\n        out = out + {}\n    return out\n"
)
_RESTS = "def without_offsets(u, y):\n    n = np.argmax({})\n    return u - u[0], y - y[:n].mean(axis=0)\n"
_FIG_14 = "fig_14, ax = plt.subplots()\nax.plot(theta_rels, label={})\nax.set(xlabel='Sample')\nax.legend()\n"
_ERRORS = (
    "fig_8, ax = plt.subplots(layout='constrained')\nax.plot(t, y, label='Measured')\nax.plot(t, y_sim_1, label="
    "'Order 1')\nax.plot(t, y_sim_2, label='Order 2')\nax.set(xlabel='Time (s)', ylabel='Output (V)')\nax.legend()\n"
    "ax.text(0.02, 0.9, f'order 1: {{mse_1:{0}}}, order 2: {{mse_2:{0}}}', transform=ax.transAxes)"
)
_SHARES = (
    "def band_shares(e, Ts, edges):\n    f, p = {}\n    s = np.histogram(f, edges, weights=p)[0]\n"
    "    return s / s.sum()\n"
)
_HALF = "half = len(y) // 2\n"


TRIES: dict[str, tuple[Try, ...]] = {
    "prelab-sinusoids": in_rows(
        ("prelab-1-time", "range in brackets", "`0:0.1:100` is MATLAB's range", "t = (0:0.1:100).reshape(-1, 1)"),
        (
            "prelab-4-function",
            "rows deleted in a loop",
            "index grows: after row 0 is gone",
            "def cut_off(data, n):\n    new = data.copy()\n    for i in range(n):\n"
            "        new = np.delete(new, i, axis=0)\n    new[:, 0] -= new[0, 0]\n    return new\n",
        ),
        (
            "prelab-4-function",
            "first row deleted n times",
            "",
            "def cut_off(data, n):\n    new = data.copy()\n    for i in range(n):\n"
            "        new = np.delete(new, 0, axis=0)\n    new[:, 0] -= new[0, 0]\n    return new\n",
        ),
        (
            "prelab-4-function",
            "one row for a table",
            r"is row n alone\. `data\[n:\]` is all rows",
            "def cut_off(data, n):\n    new = data[n].copy()\n    new[:, 0] -= new[0, 0]\n    return new\n",
        ),
        (
            "prelab-4-function",
            "print handed back",
            "hands back what `print` returns",
            "def cut_off(data, n):\n    new = data[n:].copy()\n    new[:, 0] -= new[0, 0]\n    return print(new)\n",
        ),
    ),
    "lab-identification": in_rows(
        (
            "lab-1c-loop",
            "return in the loop",
            "`return n` stands inside the loop `while",
            _LOOP.format("        return n"),
        ),
        (
            "lab-1c-loop",
            "return in the loop and behind it",
            "The `return` stands inside the loop `while .*first pass",
            _LOOP.format("        return n\n    return n"),
        ),
        (
            "lab-1c-loop",
            "return in a branch",
            "inside a condition or a loop, and was not reached",
            "def first_period(u):\n    for k in range(1, len(u)):\n        if u[k] > 1.3 * u[0]:\n"
            "            return k\n\n"
            "n_first = first_period(u_act)\n",
        ),
        (
            "lab-1c-loop",
            "return in a branch that is reached",
            "",
            "def first_period(u):\n    for k in range(1, len(u)):\n        if u[k] != u[0]:\n            return k\n\n"
            "n_first = first_period(u_act)\n",
        ),
        (
            "lab-1b-figure-5",
            "one text for two curves",
            "was given one text, for the",
            _legend("", "", "['Measured output']"),
        ),
        (
            "lab-1b-figure-5",
            "one text beside labels",
            "was given one text, for the",
            _legend(", label='a'", ", label='b'", "['Measured output']"),
        ),
        (
            "lab-1b-figure-5",
            "a text in place of a list",
            "letters name the curves",
            _legend("", "", "'Measured output'"),
        ),
        (
            "lab-1b-figure-5",
            "one name for both",
            "2 of its entries are 'Output'",
            _legend(", label='Output'", ", label='Output'", ""),
        ),
        ("lab-1b-figure-5", "one label", "each curve needs a `label`", _legend(", label='Measured'", "", "")),
        ("lab-1b-figure-5", "two texts", "", _legend("", "", "['Measured', 'Noise-reduced']")),
        (
            "lab-2a-phi",
            "interleaved, and minus",
            r"are -y\(k-1\), u\(k-1\), -y\(k-2\), u\(k-2\).*minus signs.*another order",
            _HALF + "Phi = np.column_stack([-y[1 : half - 1], u[1 : half - 1], -y[0 : half - 2], u[0 : half - 2]])\n"
            "Y = y[2:half]\n",
        ),
        (
            "lab-2a-phi",
            "lags exchanged, and Y late",
            "one sample too late for these rows of `Phi`; the columns are in another order",
            _HALF + "rows = range(2, half - 1)\n"
            "Phi = np.array([[y[k - 2], y[k - 1], u[k - 2], u[k - 1]] for k in rows])\n"
            "Y = np.array([y[k + 1] for k in rows])\n",
        ),
        (
            "lab-2a-phi",
            "inputs one sample late, and the first rows from the end",
            r"are y\(k-1\), y\(k-2\), u\(k\), u\(k-1\); asked for .* u\(k-2\) is missing",
            _HALF + "Phi = np.array([[y[k - 1], y[k - 2], u[k], u[k - 1]] for k in range(half)])\nY = y[:half]\n",
        ),
        (
            "lab-2a-phi",
            "append to a table",
            r"Begin with a list, `Phi = \[\]`.*np.vstack",
            _HALF + "Phi = np.zeros((0, 4))\nfor k in range(2, half):\n"
            "    Phi.append([y[k - 1], y[k - 2], u[k - 1], u[k - 2]])\nY = y[2:half]\n",
        ),
        (
            "lab-2a-phi",
            "append to a vector",
            r"Begin with a list, `Y = \[\]`.*`Y = np.append\(Y, y\[k\]\)`",
            _HALF + "Phi, Y = [], np.array([])\nfor k in range(2, half):\n"
            "    Phi.append([y[k - 1], y[k - 2], u[k - 1], u[k - 2]])\n    Y.append(y[k])\nPhi = np.array(Phi)\n",
        ),
        (
            "lab-2c-transfer-function",
            "formula in z",
            r"`z` is no variable of its own.*ct.tf.*not `\^`",
            "G = (b1 * z + b2) / (z^2 + a1 * z + a2)",
        ),
        (
            "lab-3a-all",
            "inputs of the end",
            r"takes `u\[-1\]` and `u\[-2\]`, the \*last\* samples",
            _RUN.format(0, "-a1 * y_sim[k - 1] - a2 * y_sim[k - 2] + b1 * u[k - 1] + b2 * u[k - 2]"),
        ),
        (
            "lab-3a-all",
            "a exchanged, u present",
            "a1 and a2 are exchanged; u is one sample early",
            _RUN.format(2, "-a2 * y_sim[k - 1] - a1 * y_sim[k - 2] + b1 * u[k] + b2 * u[k - 1]"),
        ),
        (
            "lab-3a-all",
            "b exchanged, a with plus",
            "sign of a1 and a2 is the other one; b1 and b2 are exchanged",
            _RUN.format(2, "a1 * y_sim[k - 1] + a2 * y_sim[k - 2] + b2 * u[k - 1] + b1 * u[k - 2]"),
        ),
        (
            "lab-3a-all",
            "measured outputs, u present",
            r"\*measured\* ones, `y`.*u is one sample early",
            _RUN.format(2, "-a1 * y[k - 1] - a2 * y[k - 2] + b1 * u[k] + b2 * u[k - 1]"),
        ),
        (
            "lab-3b-initial-state",
            "one state, nothing subtracted",
            "Only state 1 of the 2 states is fitted.*subtracted",
            _START.format("    x = O[:, 0] @ y / (O[:, 0] @ O[:, 0])\n    return r + O[:, 0] * x"),
        ),
        (
            "lab-3b-initial-state",
            "one state",
            "Only state 1 of the 2 states is fitted(?!.*subtracted)",
            _START.format("    x = O[:, 0] @ (y - r) / (O[:, 0] @ O[:, 0])\n    return r + O[:, 0] * x"),
        ),
        (
            "lab-3b-initial-state",
            "both states",
            "",
            _START.format("    return r + O @ np.linalg.lstsq(O, y - r)[0]"),
        ),
    ),
    "postlab-model-order": in_rows(
        (
            "postlab-1-phi",
            "minus, and late",
            r"are -y\(k-2\), u\(k-2\).*minus signs belong to theta; `Y_1` is one sample too late",
            "Phi_1 = np.column_stack([-y[0 : half - 2], u[0 : half - 2]])\nY_1 = y[2:half]\n",
        ),
        (
            "postlab-2-fit-order",
            "wraps, oldest lag first",
            r"`fit_order` takes samples from the \*end\* of the record.*k = n, here 1",
            "def fit_order(u, y, n):\n    lags = range(n, 0, -1)\n"
            "    rows = [[y[k - i] for i in lags] + [u[k - i] for i in lags] for k in range(len(y))]\n"
            "    return np.linalg.lstsq(np.array(rows), y)[0]\n\n\ntheta_2 = fit_order(u[:half], y[:half], 2)\n",
        ),
        (
            "postlab-2-simulation",
            "prediction from k = 2",
            r"y_sim_1\(k\) = .*\*measured\* ones",
            "y_sim_1, y_sim_2 = np.zeros(len(u)), np.zeros(len(u))\nfor k in range(2, len(u)):\n"
            "    y_sim_1[k] = theta_1 @ [y[k - 1], u[k - 1]]\n"
            "    y_sim_2[k] = theta_2 @ [y[k - 1], y[k - 2], u[k - 1], u[k - 2]]\n",
        ),
        ("postlab-3-figure-8", "two decimals", "stands as 0.00", _ERRORS.format(".2f")),
        ("postlab-3-figure-8", "three digits", "", _ERRORS.format(".3g")),
    ),
    "step-response": in_rows(
        (
            "step-1-read",
            "levels in per cent",
            "No sample is at 63.2 times the final value",
            _READ.format("argmax(y_step >= 63.2 * max(y_step))", "argmax(y_step >= 28.3 * max(y_step))"),
        ),
        ("step-5-function", "50 % for 28.3 %", "from 50 % to 63.2 %", _LEVELS.format("0.5", "1.5")),
        ("step-5-function", "2/3 for 3/2", "tau is 2/3 of t_63 - t_28", _LEVELS.format("0.283", "2 / 3")),
        (
            "step-2-response",
            "amplitude, and sign",
            "amplitude; the exponent has no minus",
            _response("K * (1 - np.exp(s / tau))"),
        ),
        (
            "step-2-response",
            "falls, without K",
            "does not depend on K; it falls",
            _response("amplitude * np.exp(-s / tau)"),
        ),
        ("step-8-loss", "sum squared", r"squares the \*sum\* of the errors", _loss("sum(e) ** 2 / 2")),
        ("step-8-loss", "sum of squares", "", _loss("sum(e**2) / 2")),
        ("step-8-gradient", "differences with step 1", "with a step of 1, so that the bend", _gradient("1.0")),
        ("step-8-gradient", "differences with step 0.01", "with a step of 0.01, so that the bend", _gradient("0.01")),
        ("step-9-minimum", "model output", "returns Phi theta, the model output", _best("Phi @ theta")),
        ("step-9-minimum", "errors", "returns Y - Phi theta, the errors", _best("Y - Phi @ theta")),
    ),
    "least-squares": in_rows(
        ("ls-3-derivatives", "one term twice", "is A x \\+ 2 A'x; asked for", _derivatives("A @ x + 2 * x @ A")),
        (
            "ls-3-derivatives",
            "no identity, outer once",
            "is x x' \\+ x'x in every entry; asked for",
            _derivatives("A @ x + x @ A", "x @ x + np.outer(x, x)"),
        ),
        (
            "ls-9-constrained",
            "array of matrices",
            "puts no matrices together: `np.block",
            "def constrained_fit(Phi, Y, A, b):\n    p = Phi.shape[1]\n"
            "    K = np.array([[Phi.T @ Phi, A.T], [A, np.zeros((len(b), len(b)))]])\n"
            "    return np.linalg.solve(K, np.concatenate([Phi.T @ Y, b]))[:p]\n",
        ),
        (
            "ls-9-constrained",
            "array of vectors",
            r"3 and 1 entries.*np.concatenate",
            "def constrained_fit(Phi, Y, A, b):\n    p = Phi.shape[1]\n"
            "    K = np.block([[Phi.T @ Phi, A.T], [A, np.zeros((len(b), len(b)))]])\n"
            "    return np.linalg.solve(K, np.array([Phi.T @ Y, b]))[:p]\n",
        ),
        ("ls-11-cayley-hamilton", "A**k", r"`A\*\*k`, which raises each \*entry\*", _POWERS.format("A**k", "")),
        (
            "ls-11-cayley-hamilton",
            "powers of the matrix",
            "",
            _POWERS.format("np.linalg.matrix_power(A, k)", ""),
        ),
    ),
    "model-structures": in_rows(
        (
            "ms-5-simulate",
            "plus a, C not used",
            r"sign of A\[1\] and A\[2\] is the other one; e\(k-1\) and e\(k-2\) are missing",
            _simulate(f"{_PAST_Y} + {_OF_U} + e[k]"),
        ),
        (
            "ms-5-simulate",
            "minus C, u late",
            "u is one sample late; the sign of C",
            _simulate(f"-{_PAST_Y} + {_OF_U.replace('k - i', 'k - i - 1')} - {_OF_E}"),
        ),
        ("ms-5-simulate", "all terms", "", _simulate(f"-{_PAST_Y} + {_OF_U} + {_OF_E}")),
        (
            "ms-9-cancel",
            "rounded and compared",
            "rounds the roots to 2 digits",
            "def cancel(P, Q, within):\n    p, q = set(np.round(np.roots(P), 2)), set(np.round(np.roots(Q), 2))\n"
            "    both = p & q\n    return np.poly(list(p - both)), np.poly(list(q - both))\n",
        ),
        (
            "ms-10-autocorrelation",
            "from lag 1",
            "begins with lag 1",
            "def autocorrelation(e, lags):\n    e = e - e.mean()\n    c = np.correlate(e, e, 'full')[len(e) :]\n"
            "    return c[: lags + 1] / c[0]\n",
        ),
        (
            "ms-10-autocorrelation",
            "beginning of correlate, mean left in",
            "lag 0 is in its middle; and the mean is left in; and they are divided by the first",
            "def autocorrelation(e, lags):\n    c = np.correlate(e, e, mode='full')\n    return c[: lags + 1] / c[0]\n",
        ),
    ),
    "recursive-identification": in_rows(
        ("ri-3-step", "phi phi'P", "numerator in `rls_step` is phi phi'P, with one P", _step("np.outer(phi, phi) @ P")),
        (
            "ri-3-step",
            "products entry by entry",
            r"made with `\*`, `P \* phi \* phi.T \* P`",
            _step("(P * phi * phi.T * P)"),
        ),
        (
            "ri-3-step",
            "products from the left",
            r"made with `\*`, `P @ phi \* phi.T @ P`",
            _step("(P @ phi * phi @ P)"),
        ),
        (
            "ri-3-step",
            "no P, and plus",
            "phi phi', without P on both sides; the correction is added",
            _step("np.outer(phi, phi)", sign="+"),
        ),
        (
            "ri-3-step",
            "one P, 1 missing",
            "the numerator is phi phi'P, with one P; the 1 of the denominator",
            _step("np.outer(phi, phi) @ P", "(phi @ P @ phi)"),
        ),
        (
            "ri-8-drift",
            "no squares",
            "the lag is not squared; sigma is not squared",
            _drift("lam * slope / (1 - lam) + sigma * (1 - lam) / (1 + lam)"),
        ),
        (
            "ri-8-drift",
            "lag of the old estimate, sigma",
            r"the lag is that of theta\(n-1\).*; sigma is not squared",
            _drift("(slope / (1 - lam)) ** 2 + sigma * (1 - lam) / (1 + lam)"),
        ),
    ),
    "armax-and-instruments": in_rows(
        (
            "ai-3-limit",
            "a^2 added",
            "adds a\\^2 to the variance of y",
            _limit("a**2 + b**2 * var_u + (1 + c**2 - 2 * a * c) * var_e"),
        ),
        (
            "ai-3-limit",
            "not divided, other sign",
            "pulled the wrong way.*not divided by 1 - a\\^2",
            _limit("b**2 * var_u + (1 + c**2 - 2 * a * c) * var_e", "a + c * var_e / vy"),
        ),
        ("ai-3-limit", "right", "", _limit(_VARIANCE)),
        ("ai-6-figure-14", "one name for a table", "3 of its entries are 'estimates'", _FIG_14.format("'estimates'")),
        ("ai-6-figure-14", "a list of names", "", _FIG_14.format("['a', 'b', 'c']")),
        (
            "ai-9-likelihood",
            "columns, base 10",
            "number of columns of Phi.*; the logarithm is that to base 10",
            _likelihood("-N / 2 * np.log10(2 * np.pi * var_e) - E @ E / (2 * var_e)", "N = Phi.shape[1]"),
        ),
        (
            "ai-9-likelihood",
            "logarithm of a product",
            "for 1200 it returns -inf",
            _likelihood("np.log(np.prod(np.exp(-(E**2) / 2 / var_e) / np.sqrt(2 * np.pi * var_e)))"),
        ),
        (
            "ai-9-likelihood",
            "sum of logarithms",
            "",
            _likelihood("np.sum(np.log(np.exp(-(E**2) / 2 / var_e) / np.sqrt(2 * np.pi * var_e)))"),
        ),
    ),
    "nonlinear-least-squares": in_rows(
        (
            "nl-6-frequency",
            "largest SSE, in hertz",
            r"outside low = .* Times 2 pi it lies between them: is it in Hz\?",
            _FREQUENCY.format("np.argmax", " / (2 * np.pi)"),
        ),
        ("nl-6-frequency", "smallest SSE, in hertz", "returns Hz", _FREQUENCY.format("np.argmin", " / (2 * np.pi)")),
        (
            "nl-7-layout",
            "lines along an axis, with a tolerance",
            "only sees lines along an axis",
            _LAYOUT.format("1e-9"),
        ),
        (
            "nl-7-layout",
            "compared exactly",
            "misses beacons on a slanting line: through rounding",
            "def layout(beacons):\n    d = beacons - beacons[0]\n    if not d.any():\n        return 'undetermined'\n"
            "    far = d[np.argmax((d ** 2).sum(axis=1))]\n    off = d[:, 0] * far[1] - d[:, 1] * far[0]\n"
            "    return 'unique' if np.any(off != 0) else 'mirror'\n",
        ),
        (
            "nl-9-output-error",
            "no delay, other sign",
            "u acts at once.*; a has the other sign",
            _OUTPUT_ERROR.format("[q[1]]", "[1, -q[0]]", ""),
        ),
        (
            "nl-9-output-error",
            "other sign, turned round",
            "a has the other sign; b is returned before a",
            _OUTPUT_ERROR.format("[0, q[1]]", "[1, q[0]]", "[::-1] * [1, -1]"),
        ),
    ),
    "sim-to-real-gap": in_rows(
        (
            "gap-4-frequency",
            "welch",
            "uses `welch`",
            _SHARES.format("scipy.signal.welch(e, 1 / Ts, nperseg=128)"),
        ),
        (
            "gap-4-frequency",
            "numbers of the bands",
            "counts the frequencies",
            _SHARES.format("np.fft.rfftfreq(len(e), Ts), np.ones(len(e) // 2 + 1)"),
        ),
        (
            "gap-9-closed",
            "no roots, per cent",
            "in per cent.*; mean squares are compared",
            _closed("100 * (1 - max(mse_after - sigma**2, 0) / (mse_before - sigma**2))"),
        ),
        (
            "gap-9-closed",
            "what is left, sigma",
            "sigma is subtracted without its square; it is the share that is left",
            _closed("np.sqrt(max(mse_after - sigma, 0) / abs(mse_before - sigma))"),
        ),
    ),
    "several-signals": in_rows(
        ("sev-2-offsets", "any of the table", "`np.any` of the whole table", _RESTS.format("np.any(u != u[0])")),
        (
            "sev-2-offsets",
            "no sample of rest",
            "mean of \\*no\\* sample is taken off. Print",
            _RESTS.format("u[:, 0] == u[0, 0]"),
        ),
        ("sev-2-offsets", "any of each row", "", _RESTS.format("np.any(u != u[0], axis=1)")),
        (
            "sev-5-run",
            "overlapping, and early",
            r"theta\[3\] u_2\(k\) \+ theta\[4\] u_2\(k-1\): u_1 is one sample early",
            _RUNS.format("theta[n + j : 2 * n + j]", "scipy.signal.lfilter(b, a, u[:, j])"),
        ),
        (
            "sev-5-run",
            "whole table, across",
            "hands `lfilter` the whole table `u` for each input",
            _RUNS.format("np.r_[0, theta[n + j * n : n + (j + 1) * n]]", "scipy.signal.lfilter(b, a, u).sum(axis=1)"),
        ),
        (
            "sev-5-run",
            "whole table, down",
            "filters the whole table `u` by the b's of each input",
            _RUNS.format(
                "np.r_[0, theta[n + j * n : n + (j + 1) * n]]", "scipy.signal.lfilter(b, a, u, axis=0).sum(axis=1)"
            ),
        ),
    ),
}
