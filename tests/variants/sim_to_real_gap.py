"""Answers to the sim-to-real gap that differ from the model solution, right ones and wrong ones.

The rig of the course's own record has a dead zone. A student with that one hypothesis fits it alone, and so do these
variants: the model solution tries all eight.
"""

from variants import Right, Wrong, define
from variants import right as right_answer
from variants import wrong as wrong_answer

REST, LINEAR, SIZE, TIME = "gap-1-rest", "gap-2-linear", "gap-3-size", "gap-3-time"
FREQUENCY, OPERATING, SIMULATION = "gap-4-frequency", "gap-5-operating", "gap-7-simulation"
EFFECT, PATH, PARAMETERS, CLOSED = "gap-8-effect", "gap-8-path", "gap-8-parameters", "gap-9-closed"


def simulation(
    model: str = "free_run(q[:4], np.maximum(v - q[5], 0) + np.minimum(v - q[4], 0))",
    start: str = "[*theta_hat, -0.2, 0.2]",
    result: str = "y_offset + dead_zone(q_best, u_act - u_offset)",
    fitted: str = "fit(dead_zone, START, u[:half], y[:half])",
) -> str:
    return (
        define("dead_zone(q, v)", f"return {model}")
        + f"q_best = {fitted.replace('START', start)}\n"
        + define("simulate_better(u_act)", f"return {result}")
    )


FAST = {
    f"{SIMULATION}-answer": simulation(),
    f"{EFFECT}-answer": "effect = 'input-dead-zone'",
    f"{PATH}-answer": "path = 'input'",
    f"{PARAMETERS}-answer": "parameters = {'low': u_offset + q_best[4], 'high': u_offset + q_best[5]}",
}


def right(question: str, name: str, code: str) -> Right:
    plain = right_answer(question, name, code)
    return Right(question, name, FAST | plain.code)


def wrong(question: str, name: str, code: str, slip: str | None, says: str) -> Wrong:
    plain = wrong_answer(question, name, code, slip, says)
    return Wrong(question, name, FAST | plain.code, says, slip)


def rest(
    u_offset: str = "u_act[0]",
    y_offset: str = "np.mean(y_act[:n])",
    noise_sd: str = "np.std(y_act[:n])",
    u: str = "u_act - u_offset",
    y: str = "y_act - y_offset",
) -> str:
    return (
        f"n = np.argmax(u_act != u_act[0])\nu_offset = {u_offset}\ny_offset = {y_offset}\nnoise_sd = {noise_sd}\n"
        f"u = {u}\ny = {y}"
    )


def linear(
    columns: str = "y[1 : h - 1], y[: h - 2], u[1 : h - 1], u[: h - 2]",
    arx: str = "np.linalg.lstsq(Phi, y[2:h])[0]",
    theta: str = "fit(free_run, theta_arx, u[:half], y[:half])",
    run: str = "free_run(theta_hat, u)",
    h: str = "half",
    before: str = "",
) -> str:
    return (
        f"{before}h = {h}\nPhi = np.column_stack([{columns}])\ntheta_arx = {arx}\ntheta_hat = {theta}\ny_lin = {run}\n"
    )


ONE_STEP = (
    "np.concatenate([y[:2], np.column_stack([y[1:-1], y[:-2], u[1:-1], u[:-2]]) @ theta_hat])"  # measured y, every row
)


def time(
    shares: str = "squares / squares.sum()",
    squares: str = "np.sum(np.reshape(e, (parts, -1)) ** 2, axis=1)",
    share_t: str = "time_shares(e, 16)",
    worst: str = "(i * 100 * Ts, (i + 1) * 100 * Ts)",
    i: str = "np.argmax(share_t)",
) -> str:
    return (
        define("time_shares(e, parts)", f"squares = {squares}\nreturn {shares}")
        + f"share_t = {share_t}\ni = {i}\nworst = {worst}\n"
    )


def bands(
    f: str = "np.fft.rfftfreq(len(e), Ts)",
    power: str = "np.abs(np.fft.rfft(e)) ** 2",
    energy: str = "np.histogram(f, edges, weights=power)[0]",
    result: str = "energy / np.sum(energy)",
) -> str:
    return define("band_shares(e, Ts, edges)", f"f = {f}\npower = {power}\nenergy = {energy}\nreturn {result}")


def cells(
    squares: str = "np.histogram(x, edges, weights=e**2)[0]",
    result: str = "squares / np.sum(squares)",
    share_u: str = "cell_shares(u_act, e, edges_u)",
    share_y: str = "cell_shares(y_act, e, edges_y)",
) -> str:
    return (
        define("cell_shares(x, e, edges)", f"squares = {squares}\nreturn {result}")
        + f"share_u = {share_u}\nshare_y = {share_y}\n"
    )


def closed(
    share: str = "1 - np.sqrt(max(mse_after - sigma**2, 0) / (mse_before - sigma**2))",
    after: str = "np.mean((simulate_better(u_act) - y_act)[half:] ** 2)",
    result: str = "share_closed(after, gap_before**2, noise_sd)",
) -> str:
    return (
        define("share_closed(mse_after, mse_before, sigma)", f"return {share}") + f"after = {after}\nclosed = {result}"
    )


CELL_LOOP = define(
    "cell_shares(x, e, edges)",
    "squares = np.zeros(len(edges) - 1)\nfor value, error in zip(x, e):\n"
    "    j = np.searchsorted(edges, value, side='right') - 1\n"
    "    squares[min(max(j, 0), len(squares) - 1)] += error**2\nreturn list(squares / sum(squares))",
)
SHARES_OF_RECORD = "share_u = cell_shares(u_act, e, edges_u)\nshare_y = cell_shares(y_act, e, edges_y)\n"
TIME_LOOP = define(
    "time_shares(e, parts)",
    "n = len(e) // parts\ntotal = sum(e**2)\nreturn [sum(e[i * n : (i + 1) * n] ** 2) / total for i in range(parts)]",
)
BAND_LOOP = define(
    "band_shares(e, Ts, edges)",
    "f, p = scipy.signal.periodogram(e, 1 / Ts, detrend=False)\n"
    "shares = [p[(f >= lo) & (f < hi)].sum() for lo, hi in zip(edges[:-1], edges[1:])]\n"
    "return np.array(shares) / sum(shares)",
)
LOOPED_DEAD_ZONE = (
    define(
        "pump(v, low, high)",
        "out = []\nfor vk in v:\n"
        "    if vk > high:\n        out.append(vk - high)\n    elif vk < low:\n        out.append(vk - low)\n"
        "    else:\n        out.append(0.0)\nreturn np.array(out)",
    )
    + define("errors(q)", "return free_run(q[:4], pump(u[:half], q[4], q[5])) - y[:half]")
    + "q_best = scipy.optimize.least_squares(errors, [*theta_hat, -0.1, 0.1], x_scale=[1, 1, 0.1, 0.1, 0.1, 0.1]).x\n"
    + define(
        "simulate_better(u_act)", "return free_run(q_best[:4], pump(u_act - u_offset, q_best[4], q_best[5])) + y_offset"
    )
)
TANKS_BEHIND_DEAD_ZONE = (
    simulation(
        model="linear_tanks(q[:3], np.maximum(v - q[4], 0) + np.minimum(v - q[3], 0))", start="[*q_tanks, -0.2, 0.2]"
    )
    .replace("\ndef simulate_better", "\nq_best = np.insert(q_best, 0, 0.0)\ndef simulate_better")
    .replace("dead_zone(q_best,", "dead_zone(q_best[1:],")
)

OF_REST = [
    right(REST, "a loop and the sample deviation", rest(noise_sd="np.std(y_act[:n], ddof=1)")),
    right(
        REST,
        "columns, the settled part",
        rest(u="(u_act - u_offset).reshape(-1, 1)[:, 0]", y_offset="np.mean(y_act[10:n])"),
    ),
    right(
        REST, "the median of the input", rest(u_offset="np.median(u_act[:n])", noise_sd="np.sqrt(np.var(y_act[:n]))")
    ),
    wrong(REST, "mean of everything", rest(y_offset="np.mean(y_act)"), "mean over the whole record", "rest only"),
    wrong(REST, "first sample", rest(y_offset="y_act[0]"), "a single sample", "one sample"),
    wrong(
        REST, "middle of the input", rest(u_offset="(u_act.min() + u_act.max()) / 2"), "middle of the range", "first"
    ),
    wrong(REST, "variance", rest(noise_sd="np.var(y_act[:n])"), "variance for standard deviation", "root"),
    wrong(
        REST,
        "spread of all",
        rest(noise_sd="np.std(y_act)"),
        "spread of the whole record",
        "at rest the spread is noise",
    ),
    wrong(REST, "root mean square", rest(noise_sd="np.sqrt(np.mean(y_act[:n] ** 2))"), "mean left in", "mean must"),
    wrong(REST, "differences", rest(noise_sd="np.std(np.diff(y_act[:n]))"), "spread of the differences", "twice"),
    wrong(REST, "offset left in y", rest(y="y_act"), "offset left in", "still in `y`"),
]

OF_LINEAR = [
    right(
        LINEAR,
        "normal equations, own search",
        linear(
            arx="np.linalg.solve(Phi.T @ Phi, Phi.T @ y[2:h])",
            theta="scipy.optimize.least_squares(lambda th: (free_run(th, u) - y)[:half], [1.5, -0.55, 0.02, 0.02], "
            "x_scale=[1, 1, 0.1, 0.1]).x",
        ),
    ),
    right(
        LINEAR,
        "other first row",
        linear(
            columns="y[9 : h - 1], y[8 : h - 2], u[9 : h - 1], u[8 : h - 2]".replace("9", "3").replace("8", "2"),
            arx="np.linalg.pinv(Phi) @ y[4:h]",
        ),
    ),
    right(
        LINEAR,
        "a loop for the run",
        linear(
            run="[0.0, 0.0]\nfor k in range(2, N):\n"
            "    y_lin.append(theta_hat @ [y_lin[k - 1], y_lin[k - 2], u[k - 1], u[k - 2]])",
        ),
    ),
    wrong(LINEAR, "lab's estimate only", linear(theta="theta_arx"), "the one-step fit", "free run"),
    wrong(LINEAR, "all the data", linear(theta="fit(free_run, theta_arx, u, y)"), "fit on all the data", "first half"),
    wrong(LINEAR, "least squares on all", linear(h="N"), "fit on all the data", "theta_arx"),
    right(
        LINEAR,
        "from k = 10",
        linear("y[9 : h - 1], y[8 : h - 2], u[9 : h - 1], u[8 : h - 2]", "np.linalg.lstsq(Phi, y[10:h])[0]"),
    ),
    wrong(
        LINEAR, "second half", linear(theta="fit(free_run, theta_arx, u[half:], y[half:])"), "wrong half", "held out"
    ),
    wrong(
        LINEAR,
        "u before y",
        linear(
            columns="u[1 : h - 1], u[: h - 2], y[1 : h - 1], y[: h - 2]",
            theta="fit(free_run, theta_arx[[2, 3, 0, 1]], u[:half], y[:half])",
        ),
        "y and u columns swapped",
        "b before a",
    ),
    wrong(
        LINEAR,
        "sign of a",
        linear(
            columns="-y[1 : h - 1], -y[: h - 2], u[1 : h - 1], u[: h - 2]",
            theta="fit(free_run, theta_arx * [-1, -1, 1, 1], u[:half], y[:half])",
        ),
        "sign of a",
        "-a1",
    ),
    wrong(
        LINEAR, "one-step prediction", linear(run=ONE_STEP), "one-step prediction passed off as simulation", "free run"
    ),
    wrong(
        LINEAR, "run of the estimate", linear(run="free_run(theta_arx, u)"), "run of the lab's estimate", "theta_hat"
    ),
    wrong(
        LINEAR,
        "a constant",
        linear(arx="np.linalg.lstsq(np.c_[Phi, np.ones(h - 2)], y[2:h])[0][:4]"),
        "a constant fitted along",
        "column of ones",
    ),
    wrong(LINEAR, "half the run", linear(run="free_run(theta_hat, u[:half])"), "half the record", "whole input"),
    wrong(LINEAR, "offset back", linear(run="free_run(theta_hat, u) + y_offset"), "offset put back", "has none"),
    wrong(
        LINEAR,
        "stopped early",
        linear(theta="0.5 * theta_arx + 0.5 * fit(free_run, theta_arx, u[:half], y[:half])"),
        None,
        "nearest",
    ),
]

OF_SIZE = [
    right(SIZE, "norm", "gap_before = np.linalg.norm(e[half:]) / np.sqrt(N - half)"),
    right(SIZE, "from the signals", "gap_before = float(np.mean((y[half:] - y_lin[half:]) ** 2) ** 0.5)"),
    wrong(SIZE, "everything", "gap_before = np.sqrt(np.mean(e**2))", "error over the whole record", "held-out half"),
    wrong(SIZE, "fitted half", "gap_before = np.sqrt(np.mean(e[:half] ** 2))", "error on the fitted half", "other one"),
    wrong(SIZE, "no root", "gap_before = np.mean(e[half:] ** 2)", "no root", "root"),
    wrong(SIZE, "absolute", "gap_before = np.mean(np.abs(e[half:]))", "absolute error", "square"),
    wrong(SIZE, "norm alone", "gap_before = np.linalg.norm(e[half:])", "sum for mean", "length"),
]

OF_TIME = [
    right(
        TIME,
        "loops",
        TIME_LOOP + "share_t = time_shares(e, 16)\nworst = [75 * np.argmax(share_t), 75 * np.argmax(share_t) + 75]",
    ),
    right(
        TIME,
        "split",
        time(
            squares="np.array([np.sum(part**2) for part in np.split(e, parts)])",
            worst="np.array([t[i * 100], t[i * 100 + 99] + Ts])",
        ),
    ),
    wrong(
        TIME,
        "last sample of the stretch",
        time(worst="(i * 100 * Ts, ((i + 1) * 100 - 1) * Ts)"),
        "last sample of the stretch",
        "next one begins",
    ),
    wrong(
        TIME,
        "absolute values",
        time(squares="np.sum(np.abs(np.reshape(e, (parts, -1))), axis=1)"),
        "errors not squared",
        "Squares",
    ),
    wrong(
        TIME,
        "last sample of each stretch",
        time(squares="np.sum(np.reshape(e, (parts, -1))[:, :-1] ** 2, axis=1)"),
        "a sample lost",
        "a slice ends",
    ),
    wrong(TIME, "no division", time(shares="squares"), "not shares", "divide"),
    wrong(
        TIME,
        "interleaved",
        time(squares="np.sum(np.reshape(e, (-1, parts)) ** 2, axis=0)"),
        "every so many samples",
        "neighbours",
    ),
    wrong(TIME, "by the largest", time(shares="squares / squares.max()"), "share of the largest", "sum"),
    wrong(TIME, "of the output", time(share_t="time_shares(y, 16)"), "shares of the output", "error"),
    wrong(TIME, "samples", time(worst="(i * 100, (i + 1) * 100)"), "samples for seconds", "Ts"),
    wrong(TIME, "quietest", time(i="np.argmin(share_t)"), "the quietest stretch", "smallest"),
    wrong(TIME, "eight parts", time(share_t="time_shares(e, 8)", worst="(0, 1)"), None, "elements"),
]

OF_FREQUENCY = [
    right(FREQUENCY, "periodogram and masks", BAND_LOOP),
    right(
        FREQUENCY,
        "sorted by hand",
        define(
            "band_shares(e, Ts, edges)",
            "E = np.fft.fft(e)[: len(e) // 2 + 1]\nf = np.arange(len(E)) / (len(e) * Ts)\n"
            "power = E.real**2 + E.imag**2\nband = np.digitize(f, edges) - 1\n"
            "sums = np.bincount(band, weights=power, minlength=len(edges) - 1)[: len(edges) - 1]\n"
            "return sums / sums.sum()",
        ),
    ),
    wrong(FREQUENCY, "amplitudes", bands(power="np.abs(np.fft.rfft(e))"), "errors not squared", "Squares"),
    wrong(FREQUENCY, "no Ts", bands(f="np.fft.rfftfreq(len(e))"), "frequencies without Ts", "Hz"),
    wrong(FREQUENCY, "rad/s", bands(f="2 * np.pi * np.fft.rfftfreq(len(e), Ts)"), "rad/s for Hz", "rad/s"),
    wrong(
        FREQUENCY,
        "mean removed",
        bands(power="np.abs(np.fft.rfft(e - np.mean(e))) ** 2"),
        "mean taken out",
        "removes the mean",
    ),
    wrong(
        FREQUENCY,
        "divided by all frequencies",
        bands(result="energy / np.sum(power)"),
        "divided by all frequencies",
        "over all bands together",
    ),
    wrong(FREQUENCY, "1/Ts for Ts", bands(f="np.fft.rfftfreq(len(e), 1 / Ts)"), "1/Ts for Ts", "sampling time Ts"),
    wrong(FREQUENCY, "no division", bands(result="energy"), "not shares", "add up to 1"),
    wrong(
        FREQUENCY,
        "mean of the band",
        bands(result="(energy / np.histogram(f, edges)[0]) / np.sum(energy / np.histogram(f, edges)[0])"),
        "mean for sum",
        "Add up",
    ),
    wrong(
        FREQUENCY,
        "all of histogram",
        bands(energy="np.histogram(f, edges, weights=power)", result="energy"),
        "all of histogram",
        r"\[0\]",
    ),
]

OF_OPERATING = [
    right(OPERATING, "a loop", CELL_LOOP + SHARES_OF_RECORD),
    right(
        OPERATING,
        "masks",
        cells(
            squares="np.array([np.sum(e[(x >= lo) & ((x < hi) | (hi == edges[-1]))] ** 2) "
            "for lo, hi in zip(edges[:-1], edges[1:])])"
        ),
    ),
    wrong(OPERATING, "counts", cells(squares="np.histogram(x, edges)[0]"), "shares of the samples", "squared"),
    wrong(
        OPERATING,
        "signed",
        cells(squares="np.histogram(x, edges, weights=e)[0]"),
        "errors not squared",
        "cancel|Square",
    ),
    wrong(
        OPERATING,
        "mean of the cell",
        cells(squares="np.histogram(x, edges, weights=e**2)[0] / np.maximum(np.histogram(x, edges)[0], 1)"),
        "mean for sum",
        "rare cell",
    ),
    wrong(
        OPERATING,
        "sorted by the error",
        cells(squares="np.histogram(e, edges, weights=e**2)[0]"),
        "cells of the error",
        "those of x",
    ),
    wrong(
        OPERATING,
        "last edge lost",
        define(
            "cell_shares(x, e, edges)",
            "squares = np.array([np.sum(e[(x >= a) & (x < b)] ** 2) for a, b in zip(edges[:-1], edges[1:])])\n"
            "return squares / squares.sum()",
        )
        + "share_u = cell_shares(u_act, e, edges_u)\nshare_y = cell_shares(y_act, e, edges_y)\n",
        "last edge lost",
        "last edge",
    ),
    wrong(
        OPERATING,
        "swapped",
        cells(share_u="cell_shares(y_act, e, edges_y)", share_y="cell_shares(u_act, e, edges_u)"),
        "input and output swapped",
        "other signal",
    ),
    wrong(
        OPERATING,
        "offset-free input in cells with offset",
        cells(share_u="cell_shares(u, e, edges_u)"),
        "another signal sorted",
        "share_u",
    ),
]

OF_SIMULATION = [
    right(SIMULATION, "a loop for the pump", LOOPED_DEAD_ZONE),
    right(SIMULATION, "physical tanks behind the dead zone", TANKS_BEHIND_DEAD_ZONE),
    wrong(
        SIMULATION,
        "offset left out",
        simulation(result="dead_zone(q_best, u_act - u_offset)"),
        "output offset left out",
        "y_offset",
    ),
    wrong(
        SIMULATION,
        "input with offset expected off",
        simulation(result="y_offset + dead_zone(q_best, u_act)"),
        "input offset not taken off",
        "u_offset",
    ),
    wrong(
        SIMULATION,
        "linear still",
        simulation(result="y_offset + free_run(theta_hat, u_act - u_offset)"),
        "no effect added",
        "linear model",
    ),
    wrong(
        SIMULATION,
        "one length only",
        simulation(result="y_offset + dead_zone(q_best, u_act - u_offset) + 0.1 * (len(u_act) != N)"),
        "one length only",
        "length of the input",
    ),
    wrong(
        SIMULATION,
        "another effect",
        simulation()
        + define("limits(q, v)", "return free_run(q[:4], np.clip(v, q[4], q[5]))")
        + "q_other = fit(limits, [*theta_hat, -0.4, 0.4], u[:half], y[:half])\n"
        + define("simulate_better(u_act)", "return y_offset + limits(q_other, u_act - u_offset)"),
        None,
        "another effect",
    ),
]

OF_EFFECT = [
    right(EFFECT, "capitals and a line", "effect = 'Input-Dead-Zone'"),
    right(EFFECT, "underscores", "effect = 'input_dead_zone '"),
    wrong(EFFECT, "saturation", "effect = 'input-saturation'", "another effect", "another effect"),
    wrong(EFFECT, "curve", "effect = 'input-nonlinearity'", "another effect", "another effect"),
    wrong(EFFECT, "own words", "effect = 'dead zone'", "not a name of the list", "not in the list"),
    wrong(EFFECT, "a list of guesses", "effect = ['input-dead-zone', 'input-saturation']", "not a text", "in quotes"),
]

OF_PATH = [
    right(PATH, "capitals", "path = 'Input'"),
    right(PATH, "from the name", "path = 'input-dead-zone'.split('-')[0]"),
    wrong(PATH, "where it shows", "path = 'output'", "where it shows for where it arises", "acts before"),
    wrong(PATH, "in the tanks", "path = 'dynamics'", "another path", "another place"),
    wrong(PATH, "own word", "path = 'pump'", "not a path", "one of"),
    wrong(PATH, "the effect", "path = 'input-dead-zone'", "effect for path", "place"),
]

LOW_HIGH = "parameters = {{'low': {}, 'high': {}}}"
OF_PARAMETERS = [
    right(
        PARAMETERS,
        "plain numbers",
        "parameters = dict(low=float(u_offset + q_best[4]), high=float(u_offset + q_best[5]))",
    ),
    right(
        PARAMETERS,
        "rounded",
        LOW_HIGH.format("round(u_offset + q_best[4], 2)", "np.array([round(u_offset + q_best[5], 2)])"),
    ),
    right(
        PARAMETERS,
        "with a note of the unit",
        LOW_HIGH.format("u_offset + q_best[4]", "u_offset + q_best[5]") + "\nparameters['unit'] = 'V'\n",
    ),
    wrong(PARAMETERS, "deviations", LOW_HIGH.format("q_best[4]", "q_best[5]"), "offset left out", "offset back on"),
    wrong(
        PARAMETERS,
        "swapped",
        LOW_HIGH.format("u_offset + q_best[5]", "u_offset + q_best[4]"),
        "low and high swapped",
        "swapped",
    ),
    wrong(
        PARAMETERS,
        "millivolts",
        LOW_HIGH.format("1e3 * (u_offset + q_best[4])", "1e3 * (u_offset + q_best[5])"),
        "millivolts",
        "millivolts",
    ),
    wrong(
        PARAMETERS,
        "offset of the output",
        LOW_HIGH.format("y_offset + 0.1 + q_best[4]", "y_offset + 0.1 + q_best[5]"),
        None,
        "tolerance",
    ),
    wrong(
        PARAMETERS,
        "a list",
        "parameters = [u_offset + q_best[4], u_offset + q_best[5]]",
        "not a dictionary",
        "dictionary",
    ),
    wrong(
        PARAMETERS,
        "other names",
        "parameters = {'lower': u_offset + q_best[4], 'upper': u_offset + q_best[5]}",
        "names of parameters",
        "names",
    ),
]

LEFT = "np.sqrt(max(mse_after - sigma**2, 0) / (mse_before - sigma**2))"
OF_CLOSED = [
    right(CLOSED, "one root", closed()),
    right(
        CLOSED,
        "powers of a half, without the function below",
        closed(
            "1 - max(mse_after - sigma**2, 0) ** 0.5 / (mse_before - sigma**2) ** 0.5",
            result="1 - np.sqrt(max(after - noise_sd**2, 0) / (gap_before**2 - noise_sd**2))",
        ),
    ),
    wrong(CLOSED, "per cent", closed(f"100 * (1 - {LEFT})"), "per cent", "per cent"),
    wrong(CLOSED, "what is left", closed(LEFT), "what is left, not what is closed", "take it from 1"),
    wrong(CLOSED, "with the noise", closed("1 - np.sqrt(mse_after / mse_before)"), "noise left in", "noise"),
    wrong(CLOSED, "mean squares", closed("1 - mse_after / mse_before"), "no root", "take the noise off and the root"),
    wrong(
        CLOSED,
        "without the roots",
        closed("1 - max(mse_after - sigma**2, 0) / (mse_before - sigma**2)"),
        "no root",
        "take the root of both",
    ),
    wrong(
        CLOSED,
        "max forgotten",
        closed("1 - np.sqrt((mse_after - sigma**2) / (mse_before - sigma**2))"),
        "max forgotten",
        "needs `max",
    ),
    wrong(CLOSED, "not measured", closed(result="0.5"), None, "term by term"),
]

VARIANTS: list[Right | Wrong] = [
    *OF_REST,
    *OF_LINEAR,
    *OF_SIZE,
    *OF_TIME,
    *OF_FREQUENCY,
    *OF_OPERATING,
    *OF_SIMULATION,
    *OF_EFFECT,
    *OF_PATH,
    *OF_PARAMETERS,
    *OF_CLOSED,
]
