"""First tries at the sim-to-real gap."""

from tries import Try

REST, LIN, SIZE, TIME, FREQ, OPER = (
    "gap-1-rest", "gap-2-linear", "gap-3-size", "gap-3-time", "gap-4-frequency", "gap-5-operating",
)  # fmt: skip
SIM, EFF, PATH, PARS, CLOSED = "gap-7-simulation", "gap-8-effect", "gap-8-path", "gap-8-parameters", "gap-9-closed"


def rest(y: str = "np.mean(y_act[:n])", sd: str = "np.std(y_act[:n])", u: str = "u_act[0]", more: str = "") -> str:
    return (
        f"n = int(np.argmax(u_act != u_act[0]))\nu_offset = {u}\ny_offset = {y}\nnoise_sd = {sd}\n"
        f"u = u_act - u_offset\ny = y_act - y_offset\n{more}"
    )


def linear(Phi: str = "y[1:half-1], y[:half-2], u[1:half-1], u[:half-2]", run: str = "free_run(theta_hat, u)",
           fit: str = "fit(free_run, theta_arx, u[:half], y[:half])", Y: str = "y[2:half]") -> str:  # fmt: skip
    return f"theta_arx = np.linalg.lstsq(np.column_stack([{Phi}]), {Y})[0]\ntheta_hat = {fit}\ny_lin = {run}"


def time(
    body: str, share: str = "time_shares(e, 16)", worst: str = "(i * N // 16 * Ts, (i + 1) * N // 16 * Ts)"
) -> str:
    return f"def time_shares(e, parts):\n    {body}\n\n\nshare_t = {share}\ni = np.argmax(share_t)\nworst = {worst}"


RIGHT = "s = np.sum(np.reshape(e, (parts, -1))**2, axis=1)\n    return s / np.sum(s)"


def band(weights: str, f: str = "np.fft.rfftfreq(len(e), Ts)", end: str = "h / np.sum(h)") -> str:
    return (
        f"def band_shares(e, Ts, edges):\n    f = {f}\n    E = np.fft.rfft(e)\n"
        f"    h = np.histogram(f, edges, weights={weights})[0]\n    return {end}\n"
    )


def cells(body: str = "h = np.histogram(x, edges, weights=e**2)[0]\n    return h / np.sum(h)",
          u: str = "u_act, e, edges_u", y: str = "y_act, e, edges_y") -> str:  # fmt: skip
    return f"def cell_shares(x, e, edges):\n    {body}\n\n\nshare_u = cell_shares({u})\nshare_y = cell_shares({y})"


IMPERFECT = (
    "its = simulate_better\n\n\ndef simulate_better(u_act):\n"
    "    return its(u_act) + 0.015 * np.sin(np.arange(len(u_act)))\n\n\n"
)
"""So that some of the gap stays open: with all of it closed, a wrong formula gives 1 as well."""


def closed(
    after: str = "np.mean((simulate_better(u_act) - y_act)[half:]**2)", before: str = "gap_before**2",
    body: str = "1 - np.sqrt(max(mse_after - sigma**2, 0)) / np.sqrt(mse_before - sigma**2)", end: str = "",
) -> str:  # fmt: skip
    return (
        f"{IMPERFECT}def share_closed(mse_after, mse_before, sigma):\n    return {body}\n\n\n"
        f"closed = share_closed({after}, {before}, noise_sd){end}"
    )


def named(effect: str, parameters: str) -> str:
    return f"effect = '{effect}'\nparameters = {parameters}"


NAMED = "effect = 'input-saturation'\n"
Y_NAMED = "effect = 'output-saturation'\n"

TRIES = (
    Try(REST, "mean of all", rest("np.mean(y_act)"), "mean over the whole record"),
    Try(REST, "first sample", rest("y_act[0]"), "value of one sample"),
    Try(REST, "variance", rest(sd="np.var(y_act[:n])"), "take its root"),
    Try(REST, "spread of all", rest(sd="np.std(y_act)"), "whole record"),
    Try(REST, "mean input", rest(u="np.mean(u_act)"), "first value of the input, the level of rest", never="middle"),
    Try(REST, "loop on array", "n = 1\nwhile u_act == u_act[0]:\n    n += 1", "True or False"),
    Try(REST, "added", rest(more="y = y_act + y_offset"), "take it off"),
    Try(LIN, "all the data", linear("y[1:-1], y[:-2], u[1:-1], u[:-2]", Y="y[2:]"), "whole record"),
    Try(LIN, "minus", linear("-y[1:half-1], -y[:half-2], u[1:half-1], u[:half-2]"), "other sign of a"),
    Try(LIN, "not refitted", linear(fit="theta_arx"), "still the lab's estimate"),
    Try(LIN, "fit on all", linear(fit="fit(free_run, theta_arx, u, y)"), "whole record"),
    Try(LIN, "run of half", linear(run="free_run(theta_hat, u[:half])"), "half the record"),
    Try(LIN, "lengths", linear("y[1:half], y[:half-1], u[1:half], u[:half-1]"), "same number of rows|Incompatible"),
    Try(
        LIN,
        "prediction",
        linear(
            run="theta_hat[0] * np.roll(y, 1) + theta_hat[1] * np.roll(y, 2) + theta_hat[2] * "
            "np.roll(u, 1) + theta_hat[3] * np.roll(u, 2)"
        ),
        "one-step prediction",
    ),
    Try(SIZE, "minus noise", "gap_before = np.sqrt(np.mean(e[half:]**2) - noise_sd**2)", "noise subtracted"),
    Try(SIZE, "minus noise, plainly", "gap_before = np.sqrt(np.mean(e[half:]**2)) - noise_sd", "noise subtracted"),
    Try(SIZE, "all", "gap_before = np.sqrt(np.mean(e**2))", "whole record"),
    Try(SIZE, "std", "gap_before = np.std(e[half:])", "standard deviation"),
    Try(SIZE, "no root", "gap_before = np.mean(e[half:]**2)", "take its root"),
    Try(SIZE, "absolute", "gap_before = np.mean(abs(e[half:]))", "mean absolute error"),
    Try(SIZE, "first half", "gap_before = np.sqrt(np.mean(e[:half]**2))", "half that was fitted"),
    Try(
        TIME,
        "16 fixed",
        time("s = np.sum(e.reshape(16, -1)**2, axis=1)\n    return s / np.sum(s)"),
        "does not use the argument `parts`",
    ),
    Try(
        TIME,
        "16 rows by slices",
        time(
            "n = len(e) // 16\n    s = np.array([np.sum(e[i*n:(i+1)*n]**2) for i in range(16)])\n"
            "    return s / np.sum(s)"
        ),
        "use the argument `parts`",
    ),
    Try(
        TIME,
        "interleaved",
        time("s = np.sum(e.reshape(-1, parts)**2, axis=0)\n    return s / np.sum(s)"),
        "every n-th sample",
    ),
    Try(TIME, "not shares", time("return np.sum(e.reshape(parts, -1)**2, axis=1)"), "adds up to .* divide by the sum"),
    Try(
        TIME,
        "float",
        time("n = len(e) / parts\n    return np.array([np.sum(e[i*n:(i+1)*n]**2) for i in range(parts)])"),
        "`//` a whole number",
    ),
    Try(TIME, "of y", time(RIGHT, "time_shares(y, 16)"), "shares of the output"),
    Try(TIME, "samples", time(RIGHT, worst="(i * N // 16, (i + 1) * N // 16)"), "times `Ts`"),
    Try(TIME, "numbers", time(RIGHT, worst="(i, i + 1)"), "counts parts"),
    Try(FREQ, "complex not abs", band("E**2"), "np.abs"),
    Try(FREQ, "real part", band("np.real(E**2)"), "np.abs"),
    Try(FREQ, "square of the real part", band("E.real**2"), "np.abs"),
    Try(FREQ, "not squared", band("np.abs(E)"), "Squares are asked for"),
    Try(FREQ, "no Ts", band("np.abs(E)**2", "np.fft.rfftfreq(len(e))"), "leaves Ts out"),
    Try(FREQ, "1/Ts", band("np.abs(E)**2", "np.fft.rfftfreq(len(e), 1 / Ts)"), "sampling time Ts"),
    Try(FREQ, "fftfreq", band("np.abs(E)**2", "np.fft.fftfreq(len(e), Ts)"), "Here are `fftfreq` and `rfft`"),
    Try(FREQ, "all of histogram", band("np.abs(E)**2").replace("[0]", ""), "all that `np.histogram` returns"),
    Try(
        OPER,
        "mean",
        cells(
            "k = np.digitize(x, edges[1:-1])\n    return np.array([np.mean(e[k == j]**2) for j in "
            "range(len(edges) - 1)])"
        ),
        "mean squared error of each cell",
    ),
    Try(
        OPER,
        "mean, normed",
        cells(
            "k = np.digitize(x, edges[1:-1])\n    m = np.array([np.mean(e[k == j]**2) for j in "
            "range(len(edges) - 1)])\n    return m / m.sum()"
        ),
        "averages within each cell",
    ),
    Try(OPER, "y_lin as x", cells(y="y_lin, e, edges_y"), "handed over first"),
    Try(OPER, "y_lin with offset as x", cells(y="y_lin + y_offset, e, edges_y"), "output of the linear model"),
    Try(OPER, "offset-free", cells(u="u, e, edges_u"), "with its offset"),
    Try(OPER, "swapped", cells(u="y_act, e, edges_y", y="u_act, e, edges_u"), "shares of the other signal"),
    Try(
        OPER,
        "squares as the range",
        cells("h = np.histogram(x, edges, e**2)[0]\n    return h / np.sum(h)"),
        "counts samples.*third in `np.histogram` is the range",
    ),
    Try(
        OPER,
        "counts",
        cells("h = np.histogram(x, edges)[0]\n    return h / np.sum(h)"),
        "counts samples.*third in `np.histogram` is the range",
    ),
    Try(OPER, "order of arguments", cells(u="e, u_act, edges_u"), "handed over first"),
    Try(
        SIM,
        "interp of record (replay y)",
        "def simulate_better(u_act):\n    return y_act.copy()\n",
        "argument is ignored",
    ),
    Try(
        SIM,
        "no argument used",
        "def simulate_better(u_act):\n    return y_offset + y_lin\n",
        "output of the linear model on your record, whatever it is handed: its argument is ignored",
    ),
    Try(
        SIM,
        "deviations",
        "def simulate_better(u_act):\n    return free_run(theta_hat, u_act - u_offset)\n",
        "deviations from rest, of the linear model",
    ),
    Try(
        SIM,
        "no offset off",
        "def simulate_better(u_act):\n    return y_offset + free_run(theta_hat, u_act)\n",
        "take `u_offset` off",
    ),
    Try(
        SIM,
        "no return",
        "def simulate_better(u_act):\n    y = free_run(theta_hat, u_act - u_offset)\n",
        "returns nothing",
    ),
    Try(
        SIM,
        "column",
        "def simulate_better(u_act):\n    return (y_offset + free_run(theta_hat, u_act - u_offset)).reshape(-1, 1)\n",
        "column",
    ),
    Try(EFF, "not in the list", "effect = 'saturation'", "not in the list"),
    Try(EFF, "not quoted", "effect = input-delay", 'stands in quotes: `"input-delay"`'),
    Try(EFF, "not quoted, with a blank", "effect = input delay", 'stands in quotes: `"input-delay"`'),
    Try(EFF, "one word, not quoted", "effect = overflow", 'stands in quotes: `"overflow"`'),
    Try(EFF, "another name", "effect = my_effect", "No cell that has been run", never="quotes"),
    Try(PATH, "path not quoted", "path = dynamics", 'stands in quotes: `"dynamics"`'),
    Try(PARS, "keys not quoted", "parameters = {low: 1.2, high: 3.4}", r'stands in quotes, `\{"low": \.\.\.\}`'),
    Try(EFF, "wrong", "effect = 'input-delay'", "is noted"),
    Try(EFF, "number", "effect = 1", "text in quotes"),
    Try(PATH, "effect for path", "path = 'input-delay'", "name of an effect"),
    Try(PATH, "other word", "path = 'pump'", "one of dynamics, input, output"),
    Try(
        PARS,
        "deviations not volts",
        "parameters = {'low': -0.2, 'high': 0.2}",
        "deviation from rest",
        more=(("gap-8-effect-answer", NAMED),),
    ),
    Try(
        PARS,
        "limits swapped",
        "parameters = {'low': u_act.max() - 0.1, 'high': u_act.min() + 0.1}",
        "swapped",
        more=(("gap-8-effect-answer", NAMED),),
    ),
    Try(
        PARS,
        "millivolts",
        "parameters = {'low': 1000 * u_act.min(), 'high': 1000 * u_act.max()}",
        "both are outside",
        more=(("gap-8-effect-answer", NAMED),),
    ),
    Try(
        PARS,
        "deviations of the output",
        "parameters = {'low': -0.3, 'high': 0.3}",
        "deviation from rest",
        more=(("gap-8-effect-answer", Y_NAMED),),
    ),
    Try(
        PARS,
        "possible limits",
        "parameters = {'low': u_act.min() + 0.05, 'high': u_act.max() - 0.05}",
        "noted",
        never="deviation|swapped",
        more=(("gap-8-effect-answer", NAMED),),
    ),
    Try(
        PARS,
        "distance of the empty tank",
        "parameters = {'empty': y_act.min() + 0.1}",
        "less than that",
        more=(("gap-8-effect-answer", "effect = 'sqrt-outflow'"),),
    ),
    Try(
        PARS,
        "negative delay",
        "parameters = {'delay': -3.0}",
        "answers later",
        more=(("gap-8-effect-answer", "effect = 'input-delay'"),),
    ),
    Try(PARS, "names", "parameters = {'min': 1.2, 'max': 3.4}", "keys", more=(("gap-8-effect-answer", NAMED),)),
    Try(CLOSED, "gap_before not squared", closed(before="gap_before"), "`gap_before` itself, a root"),
    Try(CLOSED, "whole record", closed("np.mean((simulate_better(u_act) - y_act)**2)"), "whole record"),
    Try(
        CLOSED,
        "roots",
        closed("np.sqrt(np.mean((simulate_better(u_act) - y_act)[half:]**2))", "gap_before"),
        "roots of both|a root",
    ),
    Try(CLOSED, "per cent", closed(end=" * 100"), "per cent"),
    Try(CLOSED, "left", closed(end="\nclosed = 1 - closed"), "share that is \\*left\\*"),
    Try(
        CLOSED,
        "sigma",
        closed(body="1 - np.sqrt(max(mse_after - sigma, 0)) / np.sqrt(abs(mse_before - sigma))"),
        "subtracts sigma; subtract",
    ),
    Try(
        CLOSED,
        "no max",
        closed(body="1 - np.sqrt(mse_after - sigma**2) / np.sqrt(mse_before - sigma**2)"),
        "needs `max",
    ),
    Try(CLOSED, "no root", closed(body="1 - max(mse_after - sigma**2, 0) / (mse_before - sigma**2)"), "take the root"),
    Try(SIM, "record cut", "def simulate_better(u_act):\n    return y_act[: len(u_act)]\n", "argument is ignored"),
    Try(
        SIM,
        "volts clipped as deviations",
        "def simulate_better(u):\n    return free_run(theta_hat, np.clip(u, -0.3, 0.3))\n",
        "take `u_offset` off inside",
        never="whatever it is handed",
    ),
    Try(
        LIN,
        "signals with offsets",
        linear(fit="fit(free_run, theta_arx, u_act[:half], y_act[:half])"),
        "with their offsets",
    ),
    Try(
        LIN,
        "result for a function",
        linear(fit="fit(free_run(theta_arx, u), theta_arx, u[:half], y[:half])"),
        "its name alone, `free_run`",
    ),
    Try(SIZE, "with the offset", "gap_before = np.sqrt(np.mean((y_act - y_lin)[half:]**2))", "compares `y_act`"),
    Try(SIZE, "over N", "gap_before = np.sqrt(np.sum(e[half:]**2) / N)", "divides by N"),
    Try(TIME, "means", time("return np.mean(e.reshape(parts, -1)**2, axis=1)"), "adds up to"),
    Try(TIME, "a number", time(RIGHT, worst="np.argmax(share_t)"), "should hold 2 numbers.*the whole number"),
    Try(
        TIME, "largest error", time(RIGHT, worst="t[np.argmax(np.abs(e))] + np.array([0, Ts])"), "largest single error"
    ),
    Try(TIME, "held-out half", time(RIGHT, "time_shares(e[half:], 16)"), "held-out half of the error"),
    Try(
        TIME,
        "overlapping",
        time(
            "n = len(e) // parts\n    return np.array([np.sum(e[i : i + n]**2) for i in range(parts)]) / np.sum(e**2)"
        ),
        "begins each stretch one sample",
    ),
    Try(FREQ, "counted", band("np.ones(len(f))"), "counts the frequencies"),
    Try(FREQ, "decibels", band("20 * np.log10(np.abs(E))"), "adds up decibels"),
    Try(FREQ, "all of histogram", band("np.abs(E)**2").replace("[0]", ""), "all that `np.histogram` returns"),
    Try(
        OPER,
        "np.digitize",
        cells(
            "i = np.digitize(x, edges)\n"
            "    return np.array([np.sum(e[i == j]**2) for j in range(len(edges) - 1)]) / np.sum(e**2)"
        ),
        "numbers the cells from 1",
    ),
    Try(OPER, "edges of u", cells(y="y_act, e, edges_u"), "cells of the other signal"),
    Try(
        OPER,
        "edges of u, over all",
        cells("return np.histogram(x, edges, weights=e**2)[0] / np.sum(e**2)", y="y_act, e, edges_u"),
        "cells of the other signal",
    ),
    Try(
        OPER,
        "swapped",
        cells("return np.histogram(x, edges, weights=e**2)[0] / np.sum(e**2)", u="e, u_act, edges_u"),
        "nothing in any cell",
    ),
    Try(
        SIM,
        "volts into deviations",
        "def simulate_better(u_act):\n    return free_run(theta_hat, u_act)",
        "at rest the sensor shows",
    ),
    Try(EFF, "two", "effect = ['input-delay', 'overflow']", 'one text in quotes, such as "input-delay"'),
    Try(
        CLOSED,
        "sigma",
        closed(body="1 - np.sqrt(max(mse_after - sigma, 0)) / np.sqrt(mse_before - sigma)"),
        "sigma is not squared",
    ),
    Try(
        CLOSED,
        "no max",
        closed(body="1 - np.sqrt(mse_after - sigma**2) / np.sqrt(mse_before - sigma**2)"),
        "needs `max",
        never="sigma is not squared",
    ),
    Try(REST, "half", rest(sd="np.std(y_act[:half])"), "whole record, or of half"),
    Try(REST, "last sample", rest("y_act[n - 1]"), "value of one sample"),
    Try(
        SIM,
        "mean for the offset",
        "def simulate_better(u_act):\n    return free_run(theta_hat, u_act - np.mean(u_act)) + y_offset",
        "takes off the mean",
        never="whatever it is handed",
    ),
    Try(TIME, "part for a sample", time(RIGHT, worst="(t[i], t[i + 1])"), "number of a part for that of a sample"),
    Try(LIN, "u_act", linear(run="free_run(theta_hat, u_act)"), "is run on `u_act`"),
    Try(REST, "mean of the first half", rest("np.mean(y_act[:half])"), "mean over the first half"),
    Try(
        PARS,
        "other names",
        named("input-saturation", "{'lower': 1.2, 'upper': 3.4}"),
        'keys "lower", "upper"; the list gives "low", "high"',
    ),
    Try(
        REST,
        "mean of two rests",
        rest("np.mean(y_act[: 2 * n])"),
        "mean of the first .* samples, and the input",
        never="one sample",
    ),
    Try(
        PARS,
        "units in the text",
        named("input-saturation", "{'low': '1.2 V', 'high': '3.4 V'}"),
        "is text: give the number",
    ),
    Try(OPER, "shares of the output", cells(u="u_act, y, edges_u"), "made of the output in place of the error"),
    Try(OPER, "output over the edges of u", cells(u="y_act, e, edges_u"), "sorts by the other signal"),
    Try(
        OPER,
        "right edges",
        cells(
            "k = np.digitize(x, edges, right=True)\n"
            "    h = np.array([np.sum(e[k == j + 1]**2) for j in range(len(edges) - 1)])\n    return h / np.sum(h)"
        ),
        "lie on the first edge",
    ),
    Try(
        OPER,
        "roots",
        cells("h = np.sqrt(np.histogram(x, edges, weights=e**2)[0])\n    return h / np.sum(h)"),
        "takes roots",
    ),
    Try(
        TIME,
        "counted from 1",
        time(RIGHT, worst="((i + 1) * N // 16 * Ts, (i + 2) * N // 16 * Ts)"),
        "one stretch late",
    ),
    Try(
        TIME,
        "sums squared",
        time("s = np.sum(np.reshape(e, (parts, -1)), axis=1)**2\n    return s / np.sum(s)"),
        "squares the sum",
    ),
    Try(SIZE, "largest", "gap_before = np.max(abs(e[half:]))", "is the largest error"),
    Try(SIZE, "mean", "gap_before = np.mean(e[half:])", "mean of the errors"),
    Try(LIN, "measured output", linear(run="y"), "measured output itself"),
    Try(REST, "peak to peak", rest(sd="np.ptp(y_act[:n])"), "peak to peak"),
    Try(
        SIM,
        "half the input",
        "def simulate_better(u_act):\n    return y_offset + free_run(theta_hat, u_act[: len(u_act) // 2] - u_offset)\n",
        "half of them",
    ),
    Try(
        CLOSED,
        "swapped",
        closed(body="1 - np.sqrt(max(mse_before - sigma**2, 0)) / np.sqrt(mse_after - sigma**2)"),
        "before and after swapped",
    ),
    Try(
        CLOSED,
        "noise off one error",
        closed(body="1 - np.sqrt(max(mse_after - sigma**2, 0)) / np.sqrt(mse_before)"),
        "one of the errors only",
    ),
    Try(
        CLOSED,
        "noise off the roots",
        closed(body="1 - max(np.sqrt(mse_after) - sigma, 0) / (np.sqrt(mse_before) - sigma)"),
        "sigma from the roots",
    ),
    Try(
        REST,
        "changed in place, run twice",
        2 * rest(more="u_act -= u_offset\ny_act -= y_offset\nu, y = u_act, y_act\n"),
        "itself has changed",
    ),
    Try(REST, "y from y", rest(more="y = y - y_offset"), "`y_offset` is taken off `y` twice"),
    Try(REST, "all that where returns", "n = np.where(np.diff(u_act))\ny_offset = y_act[:n].mean()", r"`n\[0\]\[0\]`"),
    Try(PARS, "equals in a dictionary", "parameters = {delay=3.2}", "a colon stands between key and value"),
    Try(PARS, "no braces", "parameters = delay: 3.2", "stands in braces", never="MATLAB's range"),
    Try(EFF, "compared", "effect == 'input-delay'", "`effect` gets its value by `=`"),
)
