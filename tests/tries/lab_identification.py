"""First tries at the lab."""

from tries import Try

EX, TS, F5, LOOP, OFF, F6 = (
    "lab-1a-extract", "lab-1a-sampling-time", "lab-1b-figure-5", "lab-1c-loop", "lab-1c-offsets", "lab-1c-figure-6",
)  # fmt: skip
PHI, THETA, PAR, TF, SS = (
    "lab-2a-phi", "lab-2b-theta", "lab-2b-parameters", "lab-2c-transfer-function", "lab-2c-state-space",
)  # fmt: skip
HALF, ALL, MSE, F7, START = (
    "lab-3a-second-half", "lab-3a-all", "lab-3a-mse", "lab-3a-figure-7", "lab-3b-initial-state",
)  # fmt: skip


def extract(
    t: str = 'LogData["time"]',
    y: str = 'LogData["signals"][0]["values"][:, 1]',
    m: str = 'LogData["signals"][0]["values"][:, 0]',
    u: str = 'LogData["signals"][1]["values"]',
) -> str:
    return f"t = {t}\ny_act = {y}\ny_actm = {m}\nu_act = {u}"


def offsets(y: str = "np.mean(y_act[:n_first])", u: str = "u_act[0]", rest: str = "") -> str:
    return f"y_offset = {y}\nu_offset = {u}\ny = y_act - y_offset\nu = u_act - u_offset\n{rest}"


def loop(body: str) -> str:
    return f"def first_period(u):\n    {body}\n\n\nn_first = first_period(u_act)"


def start(body: str) -> str:
    return (
        "def simulate_from_start(u, y):\n    time = np.arange(len(u)) * Ts\n"
        "    rest = ct.forced_response(G_ss, time, u).outputs\n"
        "    c = [ct.initial_response(G_ss, time, initial_state=x).outputs for x in ([1, 0], [0, 1])]\n"
        f"    Phi = np.column_stack(c)\n    {body}\n"
    )


IN_PLACE = "y_offset = np.mean(y_act[:n_first])\nu_offset = u_act[0]\n{}\n"
PHI_HEAD = "half = len(y) // 2\n"

TRIES = (
    Try(
        EX,
        "signals[1] matlab index",
        extract(y='LogData["signals"][1]["values"][:, 1]'),
        r"flat.*`.1.` is entry number 2. Is that the one meant",
    ),
    Try(EX, "attribute access", extract(t="LogData.time"), r'dictionary.*LogData\["time"\]'),
    Try(EX, "round brackets", extract(y='LogData["signals"](1)["values"][:, 1]'), "round brackets call|square ones"),
    Try(EX, "column 2", extract(y='LogData["signals"][0]["values"][:, 2]'), "indices 0 to 1"),
    Try(EX, "columns swapped", extract(y='LogData["signals"][0]["values"][:, 0]'), "counts from 0"),
    Try(EX, "no number", extract(u='LogData["signals"]["values"]'), "takes a number first"),
    Try(EX, "key misspelt", extract(t='LogData["Time"]'), 'has the keys "time"'),
    Try(EX, "both columns", extract(y='LogData["signals"][0]["values"]'), "both columns"),
    Try(EX, "MATLAB slice", extract(y='LogData["signals"][0]["values"](:, 2)'), "square ones"),
    Try(EX, "a structure", extract(u='LogData["signals"][1]'), "still a structure"),
    Try(TS, "min", "Ts = (t[1] - t[0]) / 60", "minutes"),
    Try(TS, "number", "Ts = len(t)", r"is the number of samples\."),
    Try(TS, "frequency", "Ts = 1 / (t[1] - t[0])", "sampling frequency"),
    Try(TS, "smallest time", "Ts = np.min(t)", "time of the first sample"),
    Try(TS, "duration over N", "Ts = (t[-1] - t[0]) / len(t)", "one interval fewer"),
    Try(TS, "all differences", "Ts = np.diff(t)", "all intervals"),
    Try(TS, "t(2) - t(1)", "Ts = t(2) - t(1)", "square ones"),
    Try(TS, "rounded", "Ts = round(t[1] - t[0], 1)", "0.75|rounded to 1|neighbours"),
    Try(TS, "reversed", "Ts = t[0] - t[1]", "wrong sign"),
    Try(F5, "one plot", "fig_5 = plt.figure()\nplt.plot(t, y_act)", "2 subplots"),
    Try(F5, "axes kept", "fig_5 = plt.plot(t, y_act)", "figure itself"),
    Try(
        F5,
        "no time",
        "fig_5, (a, b) = plt.subplots(2, 1)\na.plot(y_actm, label='measured')\n"
        "a.plot(y_act, label='reduced')\na.legend()\nb.plot(u_act)",
        "sample number",
    ),
    Try(
        F5,
        "no units",
        "fig_5, (a, b) = plt.subplots(2, 1)\na.plot(t, y_actm, label='measured')\n"
        "a.plot(t, y_act, label='reduced')\na.legend()\na.set_ylabel('Output')\nb.plot(t, u_act)",
        "no unit",
    ),
    Try(F5, "xlabel attribute", "fig_5, (a, b) = plt.subplots(2, 1)\na.xlabel('Time (s)')", "begin with `set_`"),
    Try(LOOP, "n = 0", loop("n = 0\n    while u[n + 1] == u[0]:\n        n += 1\n    return n"), "One too few"),
    Try(LOOP, "if on an array", loop("n = 1\n    while u == u[0]:\n        n += 1\n    return n"), "True or False"),
    Try(LOOP, "single =", loop("n = 1\n    while u[n] = u[0]:\n        n += 1\n    return n"), "`==` compares"),
    Try(LOOP, "no return", loop("n = 1\n    while u[n] == u[0]:\n        n += 1"), "returns nothing"),
    Try(LOOP, "count all", loop("return int(np.sum(u == u[0]))"), "all samples at the first level"),
    Try(
        LOOP,
        "u_act inside",
        loop("n = 1\n    while u_act[n] == u_act[0]:\n        n += 1\n    return n"),
        "same number for every input",
    ),
    Try(
        LOOP,
        "falls only",
        loop("n = 1\n    while u[n] >= u[0]:\n        n += 1\n    return n"),
        "upwards",
    ),
    Try(
        LOOP, "missing colon", loop("n = 1\n    while u[n] == u[0]\n        n += 1\n    return n"), "ends with a colon"
    ),
    Try(OFF, "min", offsets("np.min(y_act)"), "smallest value of the whole output"),
    Try(OFF, "min of the period", offsets("np.min(y_act[:n_first])"), "smallest value of the first period"),
    Try(OFF, "mean of all", offsets("np.mean(y_act)"), "whole record"),
    Try(OFF, "median", offsets("np.median(y_act)"), "median of the whole output"),
    Try(OFF, "first sample", offsets("y_act[0]"), "value of one sample"),
    Try(OFF, "n_first + 1", offsets("np.mean(y_act[: n_first + 1])"), "one sample too many"),
    Try(OFF, "measured", offsets("np.mean(y_actm[:n_first])"), "measured output"),
    Try(OFF, "typed 2.0", offsets("2.5"), "lies (above|below) all"),
    Try(OFF, "input mean", offsets(u="np.mean(u_act)"), "mean over the whole record"),
    Try(OFF, "mean of the input range", offsets(u="(u_act.max() + u_act.min()) / 2"), "middle of the input range"),
    Try(OFF, "from the wrong samples", offsets("np.mean(y_act[n_first : 2 * n_first])"), "lies (above|below) all"),
    Try(OFF, "cut", offsets(rest="y = y_act[:n_first] - y_offset"), "entire signal"),
    Try(OFF, "added", offsets(rest="y = y_act + y_offset"), "was added"),
    Try(
        F6,
        "old signals",
        "fig_6, (a, b) = plt.subplots(2, 1)\na.plot(t, y_act)\nb.plot(t, u_act)",
        "constant added. Such a constant is an offset",
    ),
    Try(F6, "swapped", "fig_6, (a, b) = plt.subplots(2, 1)\na.plot(t, u)\nb.plot(t, y)", "swapped"),
    Try(F6, "name", "fig_7, (a, b) = plt.subplots(2, 1)\na.plot(t, y)", "no variable `fig_6`"),
    Try(
        PHI,
        "hstack flat",
        PHI_HEAD + "Phi = np.hstack([y[1:half-1], y[0:half-2], u[1:half-1], u[0:half-2]])\nY = y[2:half]",
        "end to end",
    ),
    Try(
        PHI,
        "unequal slices",
        PHI_HEAD + "Phi = np.column_stack([y[1:half], y[0:half-1], u[1:half-1], u[0:half-2]])\nY = y[2:half]",
        "number of rows",
    ),
    Try(
        PHI,
        "no list",
        PHI_HEAD + "Phi = np.column_stack(y[1:half-1], y[0:half-2], u[1:half-1], u[0:half-2])\nY = y[2:half]",
        "in a list",
    ),
    Try(
        PHI,
        "minus y",
        PHI_HEAD + "Phi = np.column_stack([-y[1:half-1], -y[0:half-2], u[1:half-1], u[0:half-2]])\nY = y[2:half]",
        "contains -y",
    ),
    Try(
        PHI,
        "all the data",
        "half = len(y) // 2\nPhi = np.column_stack([y[1:-1], y[:-2], u[1:-1], u[:-2]])\nY = y[2:]",
        "entire record",
    ),
    Try(
        PHI,
        "lags swapped",
        PHI_HEAD + "Phi = np.column_stack([y[0:half-2], y[1:half-1], u[0:half-2], u[1:half-1]])\nY = y[2:half]",
        "swapped",
    ),
    Try(
        PHI,
        "rows",
        PHI_HEAD + "Phi = np.array([y[1:half-1], y[0:half-2], u[1:half-1], u[0:half-2]])\nY = y[2:half]",
        "transpose it",
    ),
    Try(
        PHI,
        "loop wraps",
        PHI_HEAD + "Phi = np.array([[y[k-1], y[k-2], u[k-1], u[k-2]] for k in range(half)])\nY = y[:half]",
        "from the \\*end\\*",
    ),
    Try(
        PHI,
        "same time",
        PHI_HEAD + "Phi = np.column_stack([y[2:half], y[1:half-1], u[2:half], u[1:half-1]])\nY = y[2:half]",
        "one step later",
    ),
    Try(
        PHI,
        "raw signals",
        PHI_HEAD + "Phi = np.column_stack([y_act[1:half-1], y_act[0:half-2], u_act[1:half-1], "
        "u_act[0:half-2]])\nY = y_act[2:half]",
        "offsets are not removed",
    ),
    Try(PHI, "half a float", "half = len(y) / 2\nPhi = np.column_stack([y[1:half-1], y[0:half-2]])", "whole number"),
    Try(PHI, "end", PHI_HEAD + "Y = y[2:end]", "no `end`"),
    Try(
        THETA,
        "elementwise *",
        "theta_hat = np.linalg.inv(Phi.T * Phi) * Phi.T * Y",
        r"`Phi\.T @ Phi`, which fits.*each of the 3 `\*`",
    ),
    Try(
        THETA,
        "one of three elementwise",
        "theta_hat = np.linalg.inv(Phi.T * Phi) @ Phi.T @ Y",
        r"`Phi\.T @ Phi`, which fits\.$",
    ),
    Try(
        THETA,
        "Phi Phi^T",
        "theta_hat = np.linalg.solve(Phi @ Phi.T, Phi @ Y)",
        r"rank 4 at most|columns and the second",
    ),
    Try(THETA, "inverse of Phi Phi^T", "theta_hat = np.linalg.inv(Phi @ Phi.T) @ Phi @ Y", "rank 4 at most"),
    Try(THETA, "solve w/o Phi.T Y", "theta_hat = np.linalg.solve(Phi.T @ Phi, Y)", r"multiplied, too: `Phi\.T @ Y`"),
    Try(THETA, "inverse of Phi", "theta_hat = np.linalg.inv(Phi) @ Y", "only a square matrix"),
    Try(THETA, "MATLAB", "theta_hat = inv(Phi'*Phi)*Phi'*Y", r"transpose is `\.T`"),
    Try(THETA, "backslash", "theta_hat = Phi \\ Y", r"np\.linalg\.lstsq"),
    Try(THETA, "all of lstsq", "theta_hat = np.linalg.lstsq(Phi, Y)", "whole result of `lstsq`"),
    Try(THETA, "inverse forgotten", "theta_hat = Phi.T @ Y", "multiply it by the inverse"),
    Try(THETA, "power -1", "theta_hat = (Phi.T @ Phi)**-1 @ Phi.T @ Y", "one by one"),
    Try(
        PAR, "1-based", "a1 = -theta_hat[1]\na2 = -theta_hat[2]\nb1 = theta_hat[3]\nb2 = theta_hat[4]", "indices 0 to 3"
    ),
    Try(PAR, "round brackets", "a1 = -theta_hat(1)", "square ones"),
    Try(PAR, "no signs", "a1, a2, b1, b2 = theta_hat", "change the signs"),
    Try(PAR, "a and b", "b1, b2, a1, a2 = theta_hat", "a and b are swapped"),
    Try(PAR, "rounded", "a1, a2, b1, b2 = np.round(theta_hat, 2) * [-1, -1, 1, 1]", "rounded"),
    Try(PAR, "three names", "a1, a2, b1 = theta_hat", "`theta_hat` has 4 parts, .* names"),
    Try(TF, "dt True", "G = ct.tf([b1, b2], [1, a1, a2], True)", "or, with `True`"),
    Try(TF, "no dt", "G = ct.tf([b1, b2], [1, a1, a2])", "no sampling time"),
    Try(TF, "signs", "G = ct.tf([b1, b2], [1, -a1, -a2], Ts)", "signs of theta"),
    Try(TF, "lfilter order", "G = ct.tf([0, b1, b2], [1, a1, a2], Ts)", "", "acceptable"),
    Try(TF, "no leading 1", "G = ct.tf([b1, b2], [a1, a2], Ts)", "leading 1"),
    Try(TF, "trailing zero", "G = ct.tf([b1, b2, 0], [1, a1, a2], Ts)", "one sample early"),
    Try(TF, "control.tf", "G = tf([b1, b2], [1, a1, a2], Ts)", r"`ct\.tf`"),
    Try(SS, "signs", "G_ss = ct.ss([[0, 1], [a2, a1]], [[0], [1]], [[b2, b1]], [[0]], Ts)", "wrong signs"),
    Try(SS, "order", "G_ss = ct.ss([[0, 1], [-a1, -a2]], [[0], [1]], [[b2, b1]], [[0]], Ts)", "a1 and a2 are swapped"),
    Try(SS, "C order", "G_ss = ct.ss([[0, 1], [-a2, -a1]], [[0], [1]], [[b1, b2]], [[0]], Ts)", "swapped in C"),
    Try(SS, "H a row", "G_ss = ct.ss([[0, 1], [-a2, -a1]], [0, 1], [b2, b1], 0, Ts)", "", "acceptable"),
    Try(SS, "no Ts", "G_ss = ct.ss([[0, 1], [-a2, -a1]], [[0], [1]], [[b2, b1]], [[0]])", "no sampling time"),
    Try(HALF, "one step", "y_sim_half = Phi @ theta_hat", "one-step predictions of the \\*first\\* half"),
    Try(HALF, "all", "y_sim_half = ct.forced_response(G, inputs=u).outputs", "covers the entire input"),
    Try(HALF, "cut", "y_sim_half = ct.forced_response(G, inputs=u).outputs[half:]", "by itself"),
    Try(HALF, "response", "y_sim_half = ct.forced_response(G, inputs=u[half:])", "take its `.outputs`"),
    Try(HALF, "first half", "y_sim_half = ct.forced_response(G, inputs=u[:half]).outputs", "first half"),
    Try(HALF, "lfilter", "y_sim_half = scipy.signal.lfilter([b1, b2], [1, a1, a2], u[half:])", "one sample too early"),
    Try(HALF, "u_act", "y_sim_half = ct.forced_response(G, inputs=u_act[half:]).outputs", "`u_act`"),
    Try(
        HALF, "signs of a", "y_sim_half = scipy.signal.lfilter([0, b1, b2], [1, -a1, -a2], u[half:])", "wrong sign of a"
    ),
    Try(
        ALL,
        "concat halves",
        "y_sim = np.concatenate([ct.forced_response(G, inputs=u[:half]).outputs, y_sim_half])",
        "two runs put together",
    ),
    Try(ALL, "half", "y_sim = ct.forced_response(G, inputs=u[half:]).outputs", "second half only"),
    Try(ALL, "offset back", "y_sim = ct.forced_response(G, inputs=u).outputs + y_offset", "output offset"),
    Try(
        ALL,
        "measured",
        "y_sim = -a1 * np.roll(y, 1) - a2 * np.roll(y, 2) + b1 * np.roll(u, 1) + b2 * np.roll(u, 2)",
        "predicts one step",
    ),
    Try(ALL, "y as input", "y_sim = ct.forced_response(G, inputs=y).outputs", "`y` as the input"),
    Try(
        MSE,
        "first half y",
        "mse_half = np.mean((y[:half] - y_sim[:half])**2)\nmse_all = np.mean((y - y_sim)**2)",
        "error of the first half",
    ),
    Try(
        MSE,
        "first half y, cut",
        "mse_half = np.mean((y[:half] - y_sim_half[:half])**2)\nmse_all = np.mean((y - y_sim)**2)",
        "first half of `y`",
    ),
    Try(MSE, "lengths", "mse_half = np.mean((y - y_sim_half)**2)\nmse_all = 1", "same slice|same samples"),
    Try(MSE, "caret", "mse_half = np.mean((y[half:] - y_sim_half)^2)", r"write `\*\*`"),
    Try(
        MSE,
        "square of the mean",
        "mse_half = np.mean(y[half:] - y_sim_half)**2\nmse_all = np.mean(y - y_sim)**2",
        "square of the mean error",
    ),
    Try(MSE, "sum", "mse_half = np.sum((y[half:] - y_sim_half)**2)\nmse_all = np.sum((y - y_sim)**2)", "is the sum of"),
    Try(MSE, "root", "mse_half = np.sqrt(np.mean((y[half:] - y_sim_half)**2))\nmse_all = 1", "is the root of"),
    Try(
        F7,
        "first times",
        "fig_7, (a, b) = plt.subplots(2, 1)\na.plot(t[:len(y[half:])], y[half:])\n"
        "a.plot(t[:len(y[half:])], y_sim_half)",
        "times of the first",
    ),
    Try(F7, "unequal", "fig_7, (a, b) = plt.subplots(2, 1)\na.plot(t, y_sim_half)", "same length"),
    Try(
        F7,
        "no legend",
        "fig_7, (a, b) = plt.subplots(2, 1)\na.plot(t[half:], y[half:])\na.plot(t[half:], y_sim_half)\n"
        "a.set_ylabel('y (V)')\nb.plot(t, y)\nb.plot(t, y_sim)",
        "legend",
    ),
    Try(START, "from rest", start("return rest"), "starts from rest"),
    Try(
        START,
        "rest not subtracted",
        start(
            "x0 = np.linalg.lstsq(Phi, y)[0]\n    return ct.forced_response(G_ss, time, u, initial_state=x0).outputs"
        ),
        "First subtract the response from rest",
    ),
    Try(START, "state", start("return np.linalg.lstsq(Phi, y - rest)[0]"), "returns the state"),
    Try(
        START,
        "all of lstsq",
        start(
            "x0 = np.linalg.lstsq(Phi, y - rest)\n    "
            "return ct.forced_response(G_ss, time, u, initial_state=x0).outputs"
        ),
        "stopped with",
    ),
    Try(START, "shifted", start("return rest + y[0] - rest[0]"), "shifted"),
    Try(START, "free response", start("return Phi @ np.linalg.lstsq(Phi, y - rest)[0]"), "alone"),
    Try(EX, "rows for columns", extract(y='LogData["signals"][0]["values"][1]'), "one row of the table"),
    Try(TS, "samples over duration", "Ts = len(t) / t[-1]", "difference of two successive entries"),
    Try(TS, "duration over samples", "Ts = t[-1] / len(t)", "one interval fewer", never="per second"),
    Try(
        F6,
        "offsets left in",
        "fig_6, (a, b) = plt.subplots(2, 1)\na.plot(t, y_act)\nb.plot(t, u_act)",
        "constant added. Such a constant is an offset",
    ),
    Try(
        F6,
        "twice the output",
        "fig_6, (a, b) = plt.subplots(2, 1)\na.plot(t, 2 * y)\nb.plot(t, u)",
        "twice the right",
        never="offset",
    ),
    Try(SS, "flat lists", "G_ss = ct.ss([0, 1, -a2, -a1], [0, 1], [b2, b1], 0, Ts)", "A, here .* is a flat list"),
    Try(
        SS,
        "B as a row",
        "G_ss = ct.ss([[0, 1], [-a2, -a1]], [[0, 1]], [[b2, b1]], [[0]], Ts)",
        "it is a column, n by 1",
        never="flat list",
    ),
    Try(
        START,
        "outputs as the state",
        "def simulate_from_start(u, y):\n    time = np.arange(len(u)) * Ts\n"
        "    return ct.forced_response(G_ss, time, u, initial_state=[y[0], y[1]]).outputs\n",
        "outputs themselves for the state",
        never="Wrong shape",
    ),
    Try(
        PHI,
        "one lag twice",
        f"{PHI_HEAD}Phi = np.column_stack([y[1 : half - 1], y[1 : half - 1], u[1 : half - 1], u[: half - 2]])\n"
        "Y = y[2:half]",
        r"are y\(k-1\), y\(k-1\).*y\(k-2\) is missing",
    ),
    Try(
        THETA,
        "divided by a matrix",
        "theta_hat = Phi.T @ Y / (Phi.T @ Phi)",
        "`/` between matrices",
    ),
    Try(HALF, "input second", "y_sim_half = ct.forced_response(G, u[half:]).outputs", "second .* is the time"),
    Try(LOOP, "list of one", loop("return [int(np.argmax(u != u[0]))]"), "list of 1, .* leave the brackets out"),
    Try(LOOP, "list of the indices", loop("return [k for k in range(np.argmax(u != u[0]))]"), "how many there are"),
    Try(LOOP, "while they differ", loop("n = 1\n    while u[n] != u[0]: n += 1\n    return n"), r"\*differs\* from"),
    Try(LOOP, "if", loop("n = 1\n    if u[n] == u[0]: n += 1\n    return n"), "`if` asks once"),
    Try(OFF, "one sample of the period", offsets("np.mean(y_act[n_first // 2])"), "value of one sample"),
    Try(TS, "whole number", "Ts = int(t[1] - t[0])", "do not round it"),
    Try(THETA, "inverse alone", "theta_hat = np.linalg.inv(Phi.T @ Phi)", "the inverse of Phi'Phi alone"),
    Try(
        THETA,
        "* Y",
        "theta_hat = np.linalg.inv(Phi.T @ Phi) @ Phi.T * Y",
        "table of 4 by 449.*between matrices",
        never="flat array|product with Y",
    ),
    Try(
        THETA,
        "Y left out",
        "theta_hat = np.linalg.inv(Phi.T @ Phi) @ Phi.T",
        "inverse of Phi'Phi times Phi' alone: the product with Y",
        never="between matrices",
    ),
    Try(
        THETA,
        "each column alone",
        "theta_hat = np.array([Phi[:, i] @ Y / (Phi[:, i] @ Phi[:, i]) for i in range(4)])",
        "each column of Phi alone",
        never=r"`\*`",
    ),
    Try(PHI, "first order", PHI_HEAD + "Phi = np.column_stack([y[:half-1], u[:half-1]])\nY = y[1:half]", "of order 1"),
    Try(TF, "ascending", "G = ct.tf([b2, b1], [a2, a1, 1], Ts)", "highest power of z comes first", never="swapped"),
    Try(TF, "no ct.tf", "G = ([b1, b2], [1, a1, a2], Ts)", r"Make it with `ct\.tf"),
    Try(HALF, "no 1", "y_sim_half = scipy.signal.lfilter([0, b1, b2], [a1, a2], u[half:])", "without its leading 1"),
    Try(ALL, "Phi theta", "y_sim = Phi @ theta_hat", "is `Phi @ theta_hat`.*whole record"),
    Try(THETA, "second Phi", "theta_hat = np.linalg.inv(Phi.T @ Phi) @ Phi @ Y", "Is `Phi.T` in place of `Phi` meant"),
    Try(
        LOOP,
        "level of the record",
        loop("n = 1\n    while u[n] == u_act[0]:\n        n = n + 1\n    return n"),
        "and wrong for others: compare with `u\\[0\\]`",
    ),
    Try(
        LOOP,
        "only downwards",
        loop("n = 1\n    while u[n] >= u[0]:\n        n = n + 1\n    return n"),
        "upwards",
        never="inputs that begin with",
    ),
    Try(
        SS,
        "another form's A",
        "G_ss = ct.ss([[-a1, -a2], [1, 0]], [[0], [1]], [[b2, b1]], [[0]], Ts)",
        "another canonical",
    ),
    Try(
        SS,
        "A transposed",
        "G_ss = ct.ss([[0, -a2], [1, -a1]], [[0], [1]], [[b2, b1]], [[0]], Ts)",
        "transposed",
        never="another",
    ),
    Try(
        HALF,
        "states",
        "y_sim_half = ct.forced_response(G, inputs=u[half:]).states",
        "as `.states`",
        never="contains time",
    ),
    Try(
        HALF,
        "time and output",
        "r = ct.forced_response(G, inputs=u[half:])\ny_sim_half = np.vstack([r.time, r.outputs])",
        "time and output",
        never="states",
    ),
    Try(ALL, "step response", "y_sim = ct.step_response(G, len(u)).outputs", "response to a unit step"),
    Try(
        MSE,
        "divided by all samples",
        "mse_half = np.sum((y[half:] - y_sim_half) ** 2) / len(y)\nmse_all = np.mean((y - y_sim) ** 2)",
        r"number of \*all\* samples",
    ),
    Try(
        MSE,
        "norm over N",
        "mse_half = np.linalg.norm(y[half:] - y_sim_half) / len(y_sim_half)\nmse_all = np.mean((y - y_sim) ** 2)",
        "norm of the error over N",
    ),
    Try(
        F7,
        "cut from the entire simulation",
        "fig_7, (ax_a, ax_b) = plt.subplots(2, 1)\nax_a.plot(t[half:], y[half:], label='actual')\n"
        "ax_a.plot(t[half:], y_sim[half:], label='simulated')\nax_b.plot(t, y)\nax_b.plot(t, y_sim)",
        "one shows the second half of `y_sim`",
    ),
    Try(
        F7,
        "zeros for the simulation",
        "fig_7, (ax_a, ax_b) = plt.subplots(2, 1)\nax_a.plot(t[half:], y[half:], label='actual')\n"
        "ax_a.plot(t[half:], 0 * y_sim_half, label='simulated')\nax_b.plot(t, y)\nax_b.plot(t, y_sim)",
        "All of it is zero",
        never="second half of `y_sim`",
    ),
    Try(
        START,
        "time of the notebook",
        "def simulate_from_start(u, y):\n    return ct.forced_response(G_ss, t[half:] - t[half], u).outputs",
        "instants and the input .* has 160 samples",
        never="comes second",
    ),
    Try(HALF, "step response", "y_sim_half = ct.step_response(G, len(u[half:])).outputs", "unit step"),
    Try(
        MSE,
        "difference of squares",
        "mse_half = np.mean(y[half:] ** 2 - y_sim_half ** 2)\nmse_all = np.mean((y - y_sim) ** 2)",
        "take the difference first",
    ),
    Try(
        LOOP,
        "tolerance",
        loop("n = 1\n    while abs(u[n] - u[0]) < 0.15:\n        n = n + 1\n    return n"),
        "does not see a small change",
    ),
    Try(TS, "mean of the times", "Ts = np.mean(t)", "mean of the times"),
    Try(TS, "two apart", "Ts = t[2] - t[0]", "twice the sampling time"),
    Try(
        OFF,
        "up to the second change",
        offsets("np.mean(y_act[: n_first + np.argmax(u_act[n_first:] != u_act[n_first])])"),
        "more than the first period",
    ),
    Try(OFF, "output offset zero", offsets("0"), "`y_offset` is zero"),
    Try(OFF, "input offset zero", offsets(u="0"), "`u_offset` is zero"),
    Try(OFF, "last value", offsets("y_act[-1]"), "last value of the output"),
    Try(OFF, "mean of half", offsets("np.mean(y_act[: len(y_act) // 2])"), "first half of the record"),
    Try(OFF, "input after the change", offsets(u="u_act[n_first]"), "level after the first change"),
    Try(OFF, "offset of the output", offsets(u="y_offset"), "offset of the output"),
    Try(OFF, "divided", offsets(rest="y = y_act / y_offset"), "divided by the offset"),
    Try(SS, "first order", "G_ss = ct.ss([[-a1]], [[1]], [[b1]], [[0]], Ts)", "1 states"),
    Try(
        PAR,
        "read backwards",
        "b1, b2 = theta_hat[3], theta_hat[2]\na1, a2 = -theta_hat[1], -theta_hat[0]",
        "reverse order",
    ),
    Try(
        MSE,
        "one sample less",
        "mse_half = np.mean((y[half + 1:] - y_sim_half[1:])**2)\nmse_all = np.mean((y - y_sim)**2)",
        "leaves a sample out",
    ),
    Try(THETA, "turned round", "theta_hat = np.linalg.solve(Phi.T @ Phi, Phi.T @ Y)[::-1]", "wrong order"),
    Try(THETA, "minus", "theta_hat = -np.linalg.solve(Phi.T @ Phi, Phi.T @ Y)", "All signs"),
    Try(
        PHI,
        "two rows",
        "Phi = np.column_stack([y[1:3], y[0:2], u[1:3], u[0:2]])\nY = y[2:4]",
        "fewer than the 4 unknowns",
    ),
    Try(TF, "denominator backwards", "G = ct.tf([b1, b2], [a2, a1, 1], Ts)", "denominator is in reverse order"),
    Try(TF, "a zero too many", "G = ct.tf([b1, b2], [1, a1, a2, 0], Ts)", "ends with a zero, which makes it one power"),
    Try(
        PHI,
        "minus Y",
        PHI_HEAD + "Phi = np.column_stack([y[1:half-1], y[:half-2], u[1:half-1], u[:half-2]])\nY = -y[2:half]",
        "wrong is `Y`: all of it has the wrong sign",
    ),
    Try(
        PHI,
        "by lags",
        PHI_HEAD + "Phi = np.column_stack([y[1:half-1], u[1:half-1], y[:half-2], u[:half-2]])\nY = y[2:half]",
        "columns of y and u alternate",
    ),
    Try(
        MSE, "loss", "mse_half = np.sum((y[half:] - y_sim_half)**2) / 2\nmse_all = np.sum((y - y_sim)**2) / 2", "loss V"
    ),
    Try(
        MSE,
        "half of it",
        "mse_half = np.mean((y[half:] - y_sim_half)**2) / 2\nmse_all = np.mean((y - y_sim)**2) / 2",
        "leave out the factor 1/2",
    ),
    Try(MSE, "errors", "mse_half = np.mean(y[half:] - y_sim_half)\nmse_all = np.mean(y - y_sim)", "mean of the errors"),
    Try(
        MSE,
        "half for all",
        "mse_half = np.mean((y[half:] - y_sim_half)**2)\nmse_all = np.mean((y[half:] - y_sim[half:])**2)",
        "use the entire record",
    ),
    Try(
        OFF,
        "changed in place, run twice",
        2 * IN_PLACE.format("u_act -= u_offset; y_act -= y_offset; u, y = u_act, y_act"),
        "`y_act` itself has changed",
    ),
    Try(
        OFF,
        "a second name, run twice",
        2 * IN_PLACE.format("u, y = u_act, y_act; y -= y_offset; u -= u_offset"),
        "`y_act` itself has changed",
    ),
    Try(OFF, "u from u", offsets(rest="u = u - u_offset"), "`u_offset` is taken off `u` twice"),
    Try(OFF, "y from y", offsets(rest="y = y - y_offset"), "`y_offset` is taken off `y` twice"),
    Try(TS, "a name that numpy lacks", "Ts = np.diffs(t)[0]", "There is `np.diff`"),
    Try("lab-1a-extract", "key without quotes", "t = LogData[time]", r'stands in quotes, `LogData\["time"\]`'),
    Try("lab-1a-extract", "round brackets", "t = LogData('time')", r"in square brackets, `LogData\['time'\]`"),
    Try(THETA, "power -1", "theta_hat = (Phi.T @ Phi)^-1 @ Phi.T @ Y", r"`\^` is no power", never="a multiple is made"),
    Try(
        THETA,
        "inverse of an array",
        "theta_hat = (Phi.T @ Phi).inv() @ Phi.T @ Y",
        r"`np\.linalg\.inv\(Phi\.T @ Phi\)`",
    ),
    Try("lab-2b-parameters", "two of four", "a1, a2 = theta_hat", "`theta_hat` has 4 parts, .* names"),
)
