"""First tries that Python stops, by kind: one mistake at questions of several assignments."""

from tries import Try, edited


def _tries(*rows: tuple[str, str, str, tuple[tuple[str, str], ...] | str]) -> tuple[Try, ...]:
    """Tries from rows of question, name, what the message says, and the changes of the model solution or the code."""
    return tuple(
        Try(question, name, code if isinstance(code, str) else edited(question, *code), says)
        for question, name, says, code in rows
    )


_WHERE = "an array of all the indices in it. The first index is"
_ONE_BY_ONE = "Its parts are handed over one by one: `"
_SIZE = r"`size\(A, 1\)` is `A.shape\[0\]`"
_ZEROS = r"MATLAB's `zeros\(n\)` is n by n"
_STEP_28, _STEP_63 = (
    f"t_step[np.argmax(y_step >= (1 - np.exp(-1{share})) * y_end)]" for share in (" / 3", "")
)  # fmt: skip

TRIES: dict[str, tuple[Try, ...]] = {
    "prelab-sinusoids": _tries(
        ("prelab-4-matrix", "size(t)", _SIZE, "n = size(t_new)\ndata_new = np.zeros(n, 3)"),
        ("prelab-4-matrix", "zeros(n)", _ZEROS, "data_new = np.zeros(t_new.size)\ndata_new[:, 0] = t_new"),
        (
            "prelab-4-matrix",
            "a column into a column of a table",
            r"`t_new\[:, 0\]` is flat, too",
            "data_new = np.zeros((801, 3))\ndata_new[:, 0] = t_new",
        ),
        (
            "prelab-2-noise",
            "bounds swapped",
            "takes the lower bound first",
            "y1 = np.sin(0.02 * np.pi * t) + rng.uniform(0.2, -0.2, t.shape)",
        ),
        (
            "prelab-4-matrix",
            "shape for a size",
            r"a whole shape, a tuple, by `n = t_new.shape`",
            "n = t_new.shape\ndata_new = np.zeros((n, 3))",
        ),
    ),
    "lab-identification": _tries(
        (
            "lab-1a-extract",
            "a field of a field as attribute",
            r"\[\"values\"\]",
            "y_act = LogData['signals'][0].values[:, 1]",
        ),
        (
            "lab-1a-extract",
            "two levels in one key",
            "names two levels at once",
            "y_act = LogData['signals.values'][:, 1]",
        ),
        (
            "lab-1a-extract",
            "an index in the key",
            "names two levels at once",
            "y_act = LogData['signals', 0]['values']",
        ),
        ("lab-1a-extract", "key misspelt", 'Is "values" meant', "y_act = LogData['signals'][0]['value'][:, 1]"),
        ("lab-2a-phi", "size(y)", _SIZE, "half = size(y, 1) // 2"),
        (
            "lab-2a-phi",
            "zeros(n)",
            _ZEROS,
            "Phi = np.zeros(451)\nfor k in range(2, 451):\n    Phi[k, :] = [y[k-1], y[k-2], 0, 0]",
        ),
        ("lab-2a-phi", "shape halved", r"`y.shape` is a tuple", "half = y.shape // 2"),
        (
            "lab-1c-offsets",
            "all indices in a slice",
            "holds all the indices that are found",
            (("n_first // 2", "np.where(u_act != u_act[0])[0] // 2"),),
        ),
        (
            "lab-2b-theta",
            "both in a tuple",
            f"{_ONE_BY_ONE}np.linalg.solve",
            "theta_hat = np.linalg.solve((Phi.T @ Phi, Phi.T @ Y))",
        ),
        ("lab-2c-state-space", "B as a row", r"is one row.*`\[\[0\], \[1\]\]`", (("[[0], [1]]", "[[0, 1]]"),)),
        ("lab-2c-state-space", "C as a column", r"is one column.*`\[\[b2, b1\]\]`", (("[[b2, b1]]", "[[b2], [b1]]"),)),
        (
            "lab-3a-second-half",
            "num and den of G",
            r"`G.num\[0\]\[0\]`",
            "y_sim_half = scipy.signal.lfilter(G.num, G.den, u[half:])",
        ),
        (
            "lab-3b-initial-state",
            "all of lstsq as state",
            "`x0` is all that `np.linalg.lstsq` returns",
            ((")[:50])[0]", ")[:50])"),),
        ),
    ),
    "postlab-model-order": _tries(
        (
            "postlab-1-theta",
            "factors in the other order",
            r"Is `np.linalg.pinv\(Phi_1\) @ Y_1` meant",
            "theta_1 = Y_1 @ np.linalg.pinv(Phi_1)",
        ),
        ("postlab-1-theta", "np.size for the shape", r"Rows and columns are `Phi_1.shape`", "n, p = np.size(Phi_1)"),
        (
            "postlab-2-fit-order",
            "both signals in a tuple",
            f"{_ONE_BY_ONE}fit_order",
            (("u[:half], y[:half], 2)", "(u[:half], y[:half]), 2)"),),
        ),
        (
            "postlab-2-simulation",
            "a star before a list",
            "without the star",
            (("theta_2[2:], [1", "*theta_2[2:], [1"),),
        ),
        (
            "postlab-2-fit-order",
            "rows appended twice",
            "has 898 rows",
            "def fit_order(u, y, n):\n    Phi = []\n    for k in range(n, len(y)):\n        Phi.append(y[k - n : k])\n"
            "        Phi.append(u[k - n : k])\n    return np.linalg.lstsq(np.array(Phi), y[n:])[0]\n\n\n"
            "theta_2 = fit_order(u[:half], y[:half], 2)",
        ),
        (
            "postlab-1-transfer-function",
            "a text for G",
            "arises within the function that is called",
            "G_1 = ct.tf('b/(z+a)')",
        ),
    ),
    "several-signals": _tries(
        (
            "sev-1-read",
            "the head of the file read",
            "names of its columns",
            "data = np.loadtxt('TwoHeaters.csv', delimiter=',')",
        ),
        (
            "sev-2-offsets",
            "where for the first index",
            r"`n\[0\]\[0\]`",
            (("np.argmax(np.any(u != u[0], axis=1))", "np.where(np.any(u != u[0], axis=1))"),),
        ),
        ("sev-2-offsets", "a column for a row", "is a column of `u`, with", (("u - u[0]", "u - u[:, 0]"),)),
        ("sev-3-phi", "rows for columns", r"its columns are `\*u.T`", (("*u.T", "*u"),)),
        ("sev-3-phi", "no star", r"`\*u.T` puts its rows into the list", (("*u.T", "u.T"),)),
        (
            "sev-4-theta",
            "both results in one name",
            r"by a star, `\*Phi`",
            (("Phi, Y = reg", "Phi = reg"), ("lstsq(Phi, Y)", "lstsq(Phi)")),
        ),
        (
            "sev-4-theta",
            "both results for Phi",
            "is all that `regressor` returns",
            (("Phi, Y = reg", "Phi = reg"), ("lstsq(Phi, Y)", "lstsq(Phi, y)")),
        ),
        (
            "sev-4-theta",
            "np.size by a dimension",
            r"`size\(y, 2\)` is `y.shape\[1\]`",
            (("y.shape[1]", "np.size(y, 2)"),),
        ),
        ("sev-4-theta", "the whole shape", "`y.shape` is a tuple", (("y.shape[1]", "y.shape"),)),
        (
            "sev-4-theta",
            "zeros(ny)",
            _ZEROS,
            "def fit_outputs(u, y, n):\n    Theta = np.zeros(y.shape[1])\n    for i in range(y.shape[1]):\n"
            "        Theta[i] = np.linalg.lstsq(*regressor(u, y, i, n))[0]\n    return Theta",
        ),
        ("sev-5-run", "a row for a column", "is a row of `u`, with 2 entries", (("u[:, j]", "u[j]"),)),
        ("sev-5-run", "size as a method", r"counts all entries.*`u.shape\[1\]`", (("u.shape[1]", "u.size(2)"),)),
    ),
    "step-response": _tries(
        (
            "step-1-read",
            "tuples of where",
            _WHERE,
            ((_STEP_28, "np.where(y_step >= 0.283 * y_end)"), (_STEP_63, "np.where(y_step >= 0.632 * y_end)")),
        ),
        (
            "step-1-read",
            "all entries above the level",
            "one for each index that `np.where` finds",
            (
                (_STEP_28, "t_step[np.where(y_step >= 0.283 * y_end)]"),
                (_STEP_63, "t_step[np.where(y_step >= 0.632 * y_end)]"),
            ),
        ),
        ("step-3-mse", "parameters in a tuple", _ONE_BY_ONE, (("K, tau, td,", "(K, tau, td),"),)),
        (
            "step-6-cut",
            "where without its array",
            _WHERE,
            (("np.flatnonzero(np.diff(u_act)) + 1", "np.where(np.diff(u_act)) + 1"),),
        ),
        (
            "step-6-cut",
            "times for indices",
            "An index counts samples",
            (("changes = np.flatnonzero(np.diff(u_act)) + 1", "changes = t_act[np.flatnonzero(np.diff(u_act)) + 1]"),),
        ),
        ("step-6-model", "a star before a signal", "each of its 205 parts", (("(t_held,", "(*t_held,"),)),
        ("step-6-model", "all in a tuple", _ONE_BY_ONE, (("(t_held, y_held, a_held)", "((t_held, y_held, a_held))"),)),
        ("step-9-unique", "shape from 1", r"`Phi.shape` is counted from 0", (("Phi.shape[1]", "Phi.shape[2]"),)),
    ),
    "least-squares": _tries(
        ("ls-4-fits", "powers one by one", "takes `x`, `y`, `powers`", (("u_1, y_1, [1, 0]", "u_1, y_1, 1, 0"),)),
        ("ls-4-fits", "star before the columns", "without the star", (("column_stack([", "column_stack(*["),)),
        ("ls-4-fits", "range of a list", "goes through it itself", (("for p in powers", "for p in range(powers)"),)),
        (
            "ls-6-all-solutions",
            "four of svd",
            "`np.linalg.svd` returns 3 things",
            (("Vt = np.linalg.svd(Phi)[2]", "U, s, Vt, rest = np.linalg.svd(Phi)"),),
        ),
        (
            "ls-8-weighted",
            "a row of standard deviations",
            r"`sigma\[:, np.newaxis\]`",
            (("sigma[:, np.newaxis]", "sigma[np.newaxis, :]"),),
        ),
        (
            "ls-10-confidence",
            "np.size for the shape",
            r"Rows and columns are `Phi.shape`",
            (("N, p = Phi.shape", "N, p = np.size(Phi)"),),
        ),
    ),
    "model-structures": _tries(
        ("ms-3-state-space", "zeros(n)", _ZEROS, (("np.eye(n, k=1)", "np.zeros(n)"),)),
        (
            "ms-8-order",
            "all samples beside cut rows",
            "Each row needs its own",
            (("np.column_stack(columns), y[start:]", "np.column_stack(columns), y"),),
        ),
        (
            "ms-5-simulate",
            "longer by a convolution",
            r"`np.convolve\(C, e\)\[: len\(e\)\]`",
            (("scipy.signal.lfilter(C, [1], e)", "np.convolve(C, e)"),),
        ),
        (
            "ms-8-order",
            "range of the orders",
            "goes through it itself",
            (("for n in orders:", "for n in range(orders):"),),
        ),
        (
            "ms-9-cancel",
            "the distance for its index",
            r"`np.argmin\(...\)` tells",
            (("of_P.pop(int(np.argmin(distances)))", "of_P.pop(min(distances))"),),
        ),
    ),
    "recursive-identification": _tries(
        (
            "ri-5-forgetting",
            "a column for a row",
            r"`Phi\[:, k\]` is a column of `Phi`, with 998 entries",
            (("phi = Phi[k]", "phi = Phi[:, k]"),),
        ),
        (
            "ri-9-windup",
            "a column for a row",
            r"`Phi\[:, k\]` is a column of `Phi`, with",
            (("phi = Phi[k]", "phi = Phi[:, k]"),),
        ),
        (
            "ri-10-careless",
            "a column for a row",
            r"`Phi\[:, k\]` is a column of `Phi`, with",
            (("phi = Phi[k]", "phi = Phi[:, k]"),),
        ),
        (
            "ri-5-forgetting",
            "the history by columns",
            r"`history\[:, k\]` is a column",
            (("history[k] =", "history[:, k] ="),),
        ),
        (
            "ri-5-forgetting",
            "rows counted for columns",
            r"`len\(Phi\)` is 998, the number of rows",
            (("Phi.shape[1]", "len(Phi)"),),
        ),
        (
            "ri-5-forgetting",
            "through the columns",
            "column by column of `Phi`",
            (("for k in range(len(Y)):\n        phi = Phi[k]", "for k, phi in enumerate(Phi.T):"),),
        ),
        ("ri-5-forgetting", "a row as a table", "a table of one row", (("phi = Phi[k]", "phi = Phi[k : k + 1]"),)),
        (
            "ri-6-figures",
            "a row for a column",
            r"`history\[i\]` is a row of `history`",
            (("history[:, i]", "history[i]"),),
        ),
        ("ri-8-drift", "a value for an index", r"`np.argmin\(...\)` tells", (("lams[np.argmin(", "lams[np.min("),)),
        ("ri-8-drift", "arguments in a tuple", _ONE_BY_ONE, (("(lams, slope, sigma)", "((lams, slope, sigma))"),)),
    ),
    "armax-and-instruments": _tries(
        ("ai-1-tables", "no star", r"by a star: `fit_arx\(\*make_record", (("fit_arx(*make", "fit_arx(make"),)),
        ("ai-1-tables", "a star before all three", r"takes 2 in all.*`\[:2\]`", ((")[:2])", "))"),)),
        (
            "ai-2-bias",
            "the whole shape",
            "a whole shape, a tuple, by `M = estimates.shape`",
            (("len(estimates)", "estimates.shape"),),
        ),
        (
            "ai-4-covariance",
            "a diagonal as a size",
            r"`np.eye\(N, k=-1\)`",
            (("(N, k=1)", "(N, 1)"), ("(N, k=-1)", "(N, -1)")),
        ),
        (
            "ai-5-armax",
            "a star before theta",
            "Without the star, `theta` is one argument",
            (("prediction_errors(theta, u, y)\n        new", "prediction_errors(*theta, u, y)\n        new"),),
        ),
        ("ai-6-rels", "zeros(N)", _ZEROS, (("np.zeros((len(y), 3))", "np.zeros(len(y))"),)),
    ),
    "nonlinear-least-squares": _tries(
        (
            "nl-1-logarithm",
            "all of lstsq taken apart",
            "the solution is its first",
            (("(H, np.log(y))[0]", "(H, np.log(y))"),),
        ),
        (
            "nl-3-gauss-newton",
            "a star before theta",
            "hands the entries of x over one by one",
            (("e = y - g(theta)", "e = y - g(*theta)"),),
        ),
        (
            "nl-5-exponential",
            "parameters one by one",
            "all parameters over in one array",
            (("lambda th: th[1] * np.exp(th[0] * x)", "lambda a, b: b * np.exp(a * x)"),),
        ),
        (
            "nl-8-step",
            "parameters one by one",
            "all parameters over in one array",
            (("def errors(theta):\n        y0, K, tau = theta\n", "def errors(y0, K, tau):\n"),),
        ),
        ("nl-8-step", "a key that is not there", 'has the keys "x"', (("return fit.x", "return fit['x0']"),)),
        ("nl-8-step", "a part that is not there", "has the parts `.x`", (("fit.cost", "fit.sse"),)),
        (
            "nl-7-locate",
            "smallest result",
            "compare one number of it",
            (("min(fits, key=lambda fit: fit.cost)", "min(fits)"),),
        ),
        (
            "nl-7-locate",
            "rows for columns",
            r"`beacons\[0\]` is a row",
            "def locate(beacons, ranges):\n    def errors(p):\n        return np.hypot(beacons[0] - p[0], "
            "beacons[1] - p[1]) - ranges\n\n"
            "    return scipy.optimize.least_squares(errors, [0.0, 0.0]).x",
        ),
    ),
    "sim-to-real-gap": _tries(
        (
            "gap-1-rest",
            "a time for an index",
            "An index counts samples",
            "n = t[np.argmax(u_act != u_act[0])]\ny_offset = np.mean(y_act[:n])",
        ),
        (
            "gap-2-linear",
            "a star before theta",
            "Without the star, `theta_hat`",
            (("free_run(theta_hat, u)", "free_run(*theta_hat, u)"),),
        ),
        (
            "gap-3-time",
            "where for the largest",
            _WHERE,
            (("np.argmax(share_t)", "np.where(share_t == np.max(share_t))"),),
        ),
        (
            "gap-4-frequency",
            "fft with rfftfreq",
            "Here are `fft` and `rfftfreq`",
            (("np.fft.rfft(e)", "np.fft.fft(e)"),),
        ),
        (
            "gap-4-frequency",
            "fft with rfftfreq, by masks",
            "Here are `fft` and `rfftfreq`",
            "def band_shares(e, Ts, edges):\n    f = np.fft.rfftfreq(len(e), Ts)\n    E = np.abs(np.fft.fft(e)) ** 2\n"
            "    return np.array([E[(f >= a) & (f < b)].sum() for a, b in zip(edges[:-1], edges[1:])]) / E.sum()",
        ),
        (
            "gap-4-frequency",
            "frequencies counted",
            "takes the number of samples",
            (("rfftfreq(len(e), Ts)", "rfftfreq(len(np.fft.rfft(e)), Ts)"),),
        ),
        (
            "gap-4-frequency",
            "the error for its length",
            "takes the number of samples first",
            (("rfftfreq(len(e), Ts)", "rfftfreq(e, Ts)"),),
        ),
        (
            "gap-5-operating",
            "cells counted from one",
            "counts its cells from 1",
            "def cell_shares(x, e, edges):\n    i = np.digitize(x, edges)\n    s = np.zeros(len(edges) - 1)\n    "
            "for k in range(len(e)):\n"
            "        s[i[k]] += e[k] ** 2\n    return s / s.sum()\n\n\nshare_u = cell_shares(u_act, e, edges_u)",
        ),
        (
            "gap-9-closed",
            "arguments in a tuple",
            _ONE_BY_ONE,
            (
                (
                    "share_closed(mse_after, gap_before**2, noise_sd)",
                    "share_closed((mse_after, gap_before**2, noise_sd))",
                ),
            ),
        ),
    ),
}
"""By assignment."""
