"""Tries with another formula, unit, name or tolerance than is asked for; each has neighbours with another cause."""

from tries import Try
from tries.rows_of_tries import in_rows

_SOLVE_TWO = (
    "def solve_two(U, Y):\n    d = U[0, 0] * U[1, 1] - U[0, 1] * U[1, 0]\n    if {}:\n        return None\n"
    "    return np.array([U[1, 1] * Y[0] - U[0, 1] * Y[1], U[0, 0] * Y[1] - U[1, 0] * Y[0]]) / d\n"
)
_SHIFTED = (
    "def first_order_response(t, K, tau, td, amplitude):\n    y = K * amplitude * (1 - np.exp(-t / tau))\n    d = {}\n"
    "    return np.r_[np.zeros(d), y[: len(y) - d]]\n"
)
_DESCENT = (
    "def best_theta(Phi, Y):\n    theta = np.zeros(Phi.shape[1])\n    for _ in range({}):\n"
    "        theta = theta - {} * gradient(Phi, Y, theta)\n    return theta\n"
)


def _figure_a2(original: str, model: str) -> str:
    return (
        "fig_a2, ax = plt.subplots()\n"
        f"ax.plot(t_step, y_step, label={original!r})\nax.plot(t_step, y_approx, label={model!r})\n"
        "ax.set(xlabel='Time (s)', ylabel='Output (V)')\nax.legend()\n"
    )


_RUN_WITHOUT_DELAY = (
    "y_approx = ct.forced_response(ct.tf([K], [tau, 1]), t_step, np.full(len(t_step), {})).outputs\n"
    "mse_approx = np.mean((y_step - y_approx) ** 2)\n"
)
_MSE_OVER = (
    "y_approx = first_order_response(t_step, K, tau, td, amplitude)\n"
    "mse_approx = np.sum((y_step - y_approx) ** 2) / ({})\n"
)
_STEP_RESPONSE = in_rows(
    ("step-1-read", "numbers of the process", "numbers of the process", "K, tau, td = 3, 5, 0"),
    ("step-1-read", "sum of both time constants", "numbers of the process", "K, tau, td = 3, 6, 0"),
    ("step-1-read", "no delay, read by eye", r"td is zero, but this response has a delay: it is t_63 - tau\.$",
     "K, tau, td = 3, 5.4, 0"),
    ("step-1-read", "both times as they are", "td is the time to 28.3 %.* Here tau is the whole time to 63.2 %",
     "K = y_step[-1] / amplitude\ntau = t_step[np.argmax(y_step >= 0.632 * y_step[-1])]\n"
     "td = t_step[np.argmax(y_step >= 0.283 * y_step[-1])]\n"),
    ("step-2-response", "shifted by samples of 0.05 s", "samples late for td.* are 0.05 s apart",
     _SHIFTED.format("int(round(td / 0.05))")),
    ("step-2-response", "shifted by samples of 1 s", "uses td as a number of samples",
     _SHIFTED.format("int(round(td))")),
    ("step-2-response", "shifted by samples of t", "", _SHIFTED.format("int(round(td / (t[1] - t[0])))")),
    ("step-3-mse", "N - 3", "divided by N - 3", _MSE_OVER.format("len(y_step) - 3")),
    ("step-3-mse", "N - 1 again", "divided by N - 1", _MSE_OVER.format("len(y_step) - 1")),
    ("step-3-mse", "three samples left out", "over the last 601",
     "y_approx = first_order_response(t_step, K, tau, td, amplitude)\n"
     "mse_approx = np.mean((y_step - y_approx)[200:] ** 2)\n"),
    ("step-3-mse", "no delay", "`y_approx` starts at once, without the delay", _RUN_WITHOUT_DELAY.format("amplitude")),
    ("step-3-mse", "no delay, step of one", "not the response of your model", _RUN_WITHOUT_DELAY.format("1.0")),
    ("step-3-figure", "labels exchanged", "names the curve of the original system .*'First-order model",
     _figure_a2("First-order model with delay", "Original system")),
    ("step-3-figure", "model and process exchanged", "as if it were", _figure_a2("Model", "Process")),
    ("step-3-figure", "names of the variables exchanged", "as if it were", _figure_a2("y_approx", "y_step")),
    ("step-3-figure", "names that name neither", "", _figure_a2("one", "two")),
    ("step-3-figure", "an approximated process", "", _figure_a2("Second-order model", "First-order process")),
    ("step-3-figure", "the model of the text and its approximation", "", _figure_a2("Model", "Approximation")),
    ("step-3-figure", "process and model", "", _figure_a2("Process", "Model")),
    ("step-6-model", "minutes handed over", "in minutes",
     "K_tank, tau_tank, td_tank = read_step(t_held / 60, y_held, a_held)"),
    ("step-6-model", "minutes afterwards", "in minutes",
     "K_tank, tau_tank, td_tank = read_step(t_held, y_held, a_held)\ntau_tank, td_tank = tau_tank / 60, td_tank / 60"),
    ("step-7-two", "tolerance of 0.1", "None for equations whose determinant is", _SOLVE_TWO.format("abs(d) < 0.1")),
    ("step-7-two", "tolerance of isclose", "", _SOLVE_TWO.format("np.isclose(d, 0)")),
    ("step-7-two", "tolerance beside the size of U", "", _SOLVE_TWO.format("abs(d) < 1e-12 * np.max(np.abs(U)) ** 2")),
    ("step-7-two", "tolerance of rounding", "", _SOLVE_TWO.format("abs(d) < 1e-14")),
    ("step-8-gradient", "entries of Y", "subtracts entries of Y",
     "def gradient(Phi, Y, theta):\n    return Phi.T @ (Phi @ theta) - Y[:len(theta)]\n"),
    ("step-8-gradient", "other entries of Y", "not the derivative of V",
     "def gradient(Phi, Y, theta):\n    return Phi.T @ (Phi @ theta) - Y[::-1][:len(theta)]\n"),
    ("step-9-minimum", "100 steps of 0.01", "after its 100 steps against the gradient, of 0.01 times",
     _DESCENT.format(100, 0.01)),
    ("step-9-minimum", "another multiple of the solution", "smallest loss.*gradient is up to",
     "def best_theta(Phi, Y):\n    theta = np.linalg.lstsq(Phi, Y)[0]\n    for _ in range(100):\n"
     "        theta = theta * 0.999\n    return theta\n"),
    ("step-9-minimum", "enough steps", "", _DESCENT.format(20000, 0.01)),
)  # fmt: skip
_REST = "u_offset, y_offset = u_act[0], y_act[:{0}].mean()\nu, y = u_act - u_offset, y_act - y_offset\nnoise_sd = {1}\n"
_SHARE = (
    "def share_closed(mse_after, mse_before, sigma):\n"
    "    share = 1 - np.sqrt(max(mse_after - {0}, 0)) / np.sqrt(mse_before - {0})\n    return {1}\n\n\n"
    "mse_after = np.mean((simulate_better(u_act) - y_act)[half:] ** 2)\n"
    "closed = share_closed(mse_after, gap_before**2, noise_sd)\n"
)
_SIM_TO_REAL_GAP = in_rows(
    ("gap-1-rest", "first 100 samples", "mean of the first 100 samples.* changes at sample 120",
     _REST.format(100, "np.std(y_act[:100])")),
    ("gap-1-rest", "first 140 samples", "mean of the first 140 samples, and the input first changes at sample 120",
     _REST.format(140, "np.std(y_act[:140])")),
    ("gap-1-rest", "rest up to the first change", "",
     "n = np.flatnonzero(np.diff(u_act))[0] + 1\n" + _REST.format("n", "np.std(y_act[:n])")),
    ("gap-9-closed", "clipped to 0 to 1", "returns 0 where the error after is the larger",
     _SHARE.format("sigma**2", "min(max(share, 0), 1)")),
    ("gap-9-closed", "clipped at zero", "returns 0 where the error after is the larger",
     _SHARE.format("sigma**2", "max(share, 0)")),
    ("gap-9-closed", "clipped at one", "", _SHARE.format("sigma**2", "min(share, 1)")),
    ("gap-9-closed", "clipped, and without the square", "sigma is not squared",
     _SHARE.format("sigma", "max(share, 0)")),
)  # fmt: skip
_FIT_ARX = (
    "def fit_arx(u, y):\n    Phi = np.column_stack([-y[:-1], u[:-1]{}])\n"
    "    return np.linalg.lstsq(Phi, y[1:])[0][:2]\n\n"
)
_TABLES = (
    "\nrng = np.random.default_rng(5)\nestimates_1, estimates_2 = [], []\nfor i in range(150):\n"
    "    {0} = make_record(rng, 1000, -0.8, 1.0, 0.0)\n    estimates_1.append(fit_arx(u, y))\n"
    "    {0} = make_record(rng, 1000, -0.8, 1.0, -0.8)\n    estimates_2.append(fit_arx(u, y))\n"
    "estimates_1, estimates_2 = np.array(estimates_1), np.array(estimates_2)\n"
)
_APPENDED = (
    "\nrng = np.random.default_rng(5)\nestimates_1, estimates_2 = np.array([]), np.array([])\nfor i in range(100):\n"
    "    u, y, e = make_record(rng, 1000, -0.8, 1.0, 0.0)\n    estimates_1 = np.append(estimates_1, fit_arx(u, y))\n"
    "    u, y, e = make_record(rng, 1000, -0.8, 1.0, -0.8)\n    estimates_2 = np.append(estimates_2, fit_arx(u, y))\n"
)
_LIMIT = (
    "def limit_of_least_squares(a, b, c, var_u, var_e):\n{}"
    "    y = scipy.signal.lfilter([0, b], [1, a], u) + scipy.signal.lfilter([1, c], [1, a], e)\n"
    "    return np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1]]), y[1:])[0]\n"
)
_COVARIANCE = (
    "def covariance(Phi, c, var_e):\n    N = len(Phi)\n    V = var_e * ({})\n    A = np.linalg.pinv(Phi)\n"
    "    return A @ V @ A.T\n"
)
_PREDICTION_ERRORS = (
    "def prediction_errors(theta, u, y):\n    a, b, c = theta\n    return scipy.signal.lfilter([1], [1, c], {})\n\n\n"
    "def pseudo_linear(u, y, share, rounds):\n"
    "    theta = np.append(np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1]]), y[1:])[0], 0)\n    return theta\n"
)
_RELS = (
    "def rels(u, y, forgetting, LN):\n    theta, P, e = np.zeros(3), np.eye(3) * LN, 0\n    out = [theta.copy()]\n"
    "    for n in range(1, len(y)):\n        phi = np.array([-y[n - 1], u[n - 1], e])\n        e = y[n] - phi @ theta\n"
    "        P = (P - np.outer(P @ phi, phi @ P) / (forgetting + phi @ P @ phi)) / forgetting\n"
    "        theta {} P @ phi * e\n        out.append({})\n    return np.array(out)\n\n\n"
    "theta_rels = rels(u_71, y_71, 1.0, 1e6)\n"
)
_ARMAX = in_rows(
    ("ai-1-tables", "u, e, y unpacked", "order of|in the place of the output y.*returns u, y, e",
     _FIT_ARX.format("") + _TABLES.format("u, e, y")),
    ("ai-1-tables", "e, y, u unpacked", "in the place of the input u.*returns u, y, e",
     _FIT_ARX.format("") + _TABLES.format("u, y, e").replace("fit_arx(u, y))", "fit_arx(e, y))")),
    ("ai-1-tables", "input of another size", "does not gather where .* rows are .* on average",
     _FIT_ARX.format("") + _TABLES.format("u, y, e").replace("fit_arx(u, y))", "fit_arx(2 * u, y))")),
    ("ai-1-tables", "appended without an axis", "`np.append`.*`np.vstack.*as rows",
     _FIT_ARX.format("") + _APPENDED),
    ("ai-1-tables", "a column of ones", "`fit_arx` comes of a fit with a column of ones",
     _FIT_ARX.format(", np.ones(len(y) - 1)") + _TABLES.format("u, y, e")),
    ("ai-1-tables", "a column of times", "`fit_arx` does not return the least-squares",
     _FIT_ARX.format(", np.arange(len(y) - 1)") + _TABLES.format("u, y, e")),
    ("ai-3-limit", "one record", "draws random numbers, with `standard_normal`",
     _LIMIT.format("    rng = np.random.default_rng(0)\n    u = np.sqrt(var_u) * rng.standard_normal(1000)\n"
                   "    e = np.sqrt(var_e) * rng.standard_normal(1000)\n")),
    ("ai-3-limit", "one record of a wave", "another limit of a",
     _LIMIT.format("    u = np.sqrt(2 * var_u) * np.sin(np.arange(1000))\n"
                   "    e = np.sqrt(2 * var_e) * np.cos(1.7 * np.arange(1000))\n")),
    ("ai-4-covariance", "square of the sum", r"one place, `\(1 \+ c\) \*\* 2`",
     _COVARIANCE.format("(1 + c) ** 2 * np.eye(N) + c * np.eye(N, k=1) + c * np.eye(N, k=-1)")),
    ("ai-4-covariance", "powers of c", "correlated at all lags",
     _COVARIANCE.format("(1 + c**2) * scipy.linalg.toeplitz(c ** np.arange(N))")),
    ("ai-4-covariance", "c at two lags", "not that of the estimate",
     _COVARIANCE.format("(1 + c**2) * np.eye(N) + sum(c * (np.eye(N, k=i) + np.eye(N, k=-i)) for i in (1, 2))")),
    ("ai-5-armax", "simulation over C", "a simulated output off, and divides by C",
     _PREDICTION_ERRORS.format("y - scipy.signal.lfilter([0, b], [1, a], u)")),
    ("ai-5-armax", "simulation over C with the other sign", "work the three samples",
     _PREDICTION_ERRORS.format("y + scipy.signal.lfilter([0, b], [1, a], u)")),
    ("ai-6-rels", "one array in every row", r"`theta \+=` changes the array itself", _RELS.format("+=", "theta")),
    ("ai-6-rels", "a copy in every row", "", _RELS.format("+=", "theta.copy()")),
    ("ai-6-rels", "a new array in every row", "", _RELS.format("= theta +", "theta")),
    ("ai-8-recursive", "product of flat arrays", "the table of all products is `np.outer`",
     (("np.outer(P @ z, phi @ P)", "(P @ z) * (phi @ P)"),)),
)  # fmt: skip
_LOOP = (
    "v = u[half:]\ny_sim_half = np.zeros(len(v))\nfor k in range({}, len(v)):\n"
    "    y_sim_half[k] = -a1 * y_sim_half[k - 1] - a2 * y_sim_half[k - 2] + b1 * v[k - 1] + {} * v[k - 2]\n"
)
_SCALED = "theta_hat = np.linalg.lstsq(Phi / {}, Y)[0]\n"
_LAB = in_rows(
    ("lab-1a-extract", "second row for a column", "one row of the table",
     (('LogData["signals"][0]["values"][:, 1]', 'LogData["signals"][0]["values"][1]'),)),
    ("lab-2b-theta", "columns less their means and scaled", "divided by the standard deviations, and belongs",
     "theta_hat = np.linalg.lstsq((Phi - Phi.mean(axis=0)) / Phi.std(axis=0), Y - Y.mean())[0]"),
    ("lab-2b-theta", "columns scaled by their norms", "divided by the norms",
     _SCALED.format("np.linalg.norm(Phi, axis=0)")),
    ("lab-2b-theta", "columns scaled, and scaled back", "",
     _SCALED.format("Phi.std(axis=0)") + "theta_hat = theta_hat / Phi.std(axis=0)\n"),
    ("lab-2b-theta", "one column scaled", "does not solve eq. (8)".replace("(", r"\(").replace(")", r"\)"),
     _SCALED.format("np.array([1.0, 1.0, 1.0, 3.0])")),
    ("lab-2b-parameters", "counted from 1", r"Yours are a1 = -theta_hat\[1\].*counts from 0",
     "a1, a2, b1, b2 = -theta_hat[1], -theta_hat[2], theta_hat[3], theta_hat[0]"),
    ("lab-2b-parameters", "columns taken in turn",
     r"Yours are a1 = -theta_hat\[0\].*b2 = theta_hat\[3\]\. The entries",
     "a1, a2, b1, b2 = -theta_hat[0], theta_hat[2], -theta_hat[1], theta_hat[3]"),
    ("lab-3a-second-half", "loop from k = 2", "", _LOOP.format(2, "b2")),
    ("lab-3a-second-half", "loop from k = 2, another b2", "factor of u.k-2. is .* and not b2",
     _LOOP.format(2, "b2 * b1")),
    ("lab-3a-all", "filtfilt", "filtered twice, forwards and then backwards",
     "y_sim = scipy.signal.filtfilt([0, b1, b2], [1, a1, a2], u)"),
    ("lab-3a-all", "never below zero", "At k = [0-9]+ it is 0, and -a1 y.*is -",
     "y_sim = np.maximum(scipy.signal.lfilter([0, b1, b2], [1, a1, a2], u), 0)"),
    ("lab-3a-all", "smoothed afterwards", "Its first sample is|At k = [0-9]+ it is",
     "y_sim = np.convolve(scipy.signal.lfilter([0, b1, b2], [1, a1, a2], u), np.ones(5) / 5, mode='same')"),
    ("lab-2b-theta", "part of order 3", "holds entries of the theta of order 3",
     "P = np.column_stack([y[2:half-1], y[1:half-2], y[:half-3], u[2:half-1], u[1:half-2], u[:half-3]])\n"
     "theta_hat = np.linalg.lstsq(P, y[3:half])[0][[0, 1, 3, 4]]"),
    ("lab-3a-mse", "parameters taken off", "divided by N - 4",
     "mse_half = np.sum((y[half:] - y_sim_half) ** 2) / (len(y_sim_half) - 4)\n"
     "mse_all = np.sum((y - y_sim) ** 2) / (len(y) - 4)"),
)  # fmt: skip
_TUSTIN = (
    "tau, K = -Ts / np.log(theta_1[0]), theta_1[1] / (1 - theta_1[0])\n"
    "G_1 = ct.c2d(ct.tf([{}], [tau, 1]), Ts, method={!r})\n"
)
_FIT_ORDER = (
    "def fit_order(u, y, n):\n    N = len(y)\n    Phi = np.zeros((N - n, 2 * n))\n    for i in range({}):\n"
    "        Phi[:, i - 1], Phi[:, n + i - 1] = y[n - i:N - i], u[n - i:N - i]\n"
    "    return np.linalg.pinv(Phi) @ y[n:]\n\n\n"
    "theta_2 = fit_order(u[:half], y[:half], 2)\n"
)
_TWO_ORDERS = (
    "def fit_order(u, y, n):\n    if n == 1:\n        Phi = np.column_stack([y[:-1], u[:-1]])\n{}    else:\n"
    "        Phi = np.column_stack([y[1:-1], y[:-2], u[1:-1], u[:-2]])\n"
    "    return np.linalg.lstsq(Phi, y[-len(Phi):])[0]\n\n\ntheta_2 = fit_order(u[:half], y[:half], 2)\n"
)
_MSE_OF_BOTH = "mse_1 = np.sum((y - y_sim_1) ** 2) / (N - {})\nmse_2 = np.sum((y - y_sim_2) ** 2) / (N - {})\n"
_SECOND = (
    "P = np.column_stack([y[1:half-1], y[:half-2], u[1:half-1], u[:half-2]])\n"
    "theta_1 = np.linalg.lstsq(P, y[2:half])[0][{}]\n"
)
_POSTLAB = in_rows(
    ("postlab-1-theta", "part of order 2", "holds entries of the theta of order 2", _SECOND.format("[0, 2]")),
    ("postlab-1-theta", "first two of order 2", "holds entries of the theta of order 2", _SECOND.format(":2")),
    ("postlab-1-theta", "last two of order 2", r"does not solve eq. \(8\)", _SECOND.format("2:")),
    ("postlab-1-transfer-function", "by Tustin's rule", "by Tustin's rule", _TUSTIN.format("K", "tustin")),
    ("postlab-1-transfer-function", "by Tustin's rule, another gain", "does not have the response of",
     _TUSTIN.format("2 * K", "tustin")),
    ("postlab-1-transfer-function", "through a continuous model, held", "", _TUSTIN.format("K", "zoh")),
    ("postlab-2-fit-order", "range without + 1", r"one place, `range\(1, n\)`", _FIT_ORDER.format("1, n")),
    ("postlab-2-fit-order", "range with + 1", "", _FIT_ORDER.format("1, n + 1")),
    ("postlab-2-fit-order", "orders 1 and 2 alone", "right in number for n = 1 and 2", _TWO_ORDERS.format("")),
    ("postlab-3-mse", "N - p", "divided by N - 2", "N = len(y)\n" + _MSE_OF_BOTH.format(2, 4)),
    ("postlab-3-mse", "N - p of the second", "divided by N - 4", "N = len(y)\n" + _MSE_OF_BOTH.format(0, 4)),
)  # fmt: skip
_MEAN = "def update_mean(theta, n, y):\n    return {}\n"
_ROWS = (
    "def regressors(u, y):\n    t = np.arange({})\n"
    "    return np.column_stack([-y[t - 1], -y[t - 2], u[t - 1]]), y[t]\n\n\nPhi_61, Y_61 = regressors(u_61, y_61)\n"
)
_EVOLUTION = (
    "{0}, ax = plt.subplots()\nax.plot({1}, label=['$a_1$', '$a_2$', '$b_1$'])\n{2}ax.plot(theta_true, 'k:')\n"
    "ax.set(xlabel='Sample', ylabel='Estimate', ylim=(-2, 3))\nax.legend()\n"
)
_RECURSIVE = in_rows(
    ("ri-1-mean", "gain of 0.1", "moves by 0.1 of y - theta for n = 5 and for n = 17 alike",
     _MEAN.format("0.1 * y + 0.9 * theta")),
    ("ri-1-mean", "gain by the root of n", "not return the mean", _MEAN.format("theta + (y - theta) / n**0.5")),
    ("ri-1-mean", "whole numbers", "`//` cuts off all digits", _MEAN.format("((n - 1) * theta + y) // n")),
    ("ri-1-mean", "half of it in whole numbers", "Try it by hand.*9 with n = 3. Tried",
     _MEAN.format("((n - 1) * theta + y) // n + 0.5")),
    ("ri-4-regressors", "last row left out", r"ends with the row of y\[10\] where y has 12 samples: the last is",
     _ROWS.format("2, len(y) - 1")),
    ("ri-4-regressors", "from the seventh sample", r"begins with the row of y\[6\]: the row of y\[2\]",
     _ROWS.format("6, len(y)")),
    ("ri-4-regressors", "from the fourth sample", "", _ROWS.format("3, len(y)")),
    ("ri-4-regressors", "last row left out of Phi, first of Y",
     "Phi of `regressors` stops before Y does: its rows belong to earlier samples",
     _ROWS.format("2, len(y) - 1").replace(", y[t]", ", y[t + 1]")),
    ("ri-4-regressors", "from the third sample", "", _ROWS.format("2, len(y)")),
    ("ri-6-figures", "one figure under two names", "are one figure with all curves in it. Two are asked for",
     _EVOLUTION.format("fig_9", "theta_1", "ax.plot(theta_099, '--')\n") + "fig_10 = fig_9\n"),
    ("ri-6-figures", "one figure of one history", "shows `theta_1`: Fig. 9 is",
     _EVOLUTION.format("fig_9", "theta_1", "") + "fig_10 = fig_9\n"),
    ("ri-6-figures", "two figures", "",
     _EVOLUTION.format("fig_9", "theta_1", "") + _EVOLUTION.format("fig_10", "theta_099", "")),
)  # fmt: skip
_KIND = (
    "def kind(M):\n    lam = np.linalg.eigvalsh((M + M.T) / 2)\n    zero = {}\n    if lam[0] > zero:\n"
    "        return 'positive definite'\n    if lam[-1] < -zero:\n        return 'negative definite'\n"
    "    if lam[0] > -zero:\n        return 'positive semidefinite'\n    if lam[-1] < zero:\n"
    "        return 'negative semidefinite'\n    return 'indefinite'\n"
)
_DERIVATIVES = "def gradient_form(A, x):\n    return {}\n\n\ndef jacobian_cubic(x):\n    return {}\n"
_ONE_SIDE = "np.array([((x + d) @ A @ (x + d) - x @ A @ x) / 0.1 for d in 0.1 * np.eye(len(x))])"
_BOTH_SIDES = (
    "np.column_stack([((x + d) @ (x + d) * (x + d) - (x - d) @ (x - d) * (x - d)) / 0.04 "
    "for d in 0.02 * np.eye(len(x))])"
)
_ALL_SOLUTIONS = (
    "def all_solutions(Phi, Y):\n    theta = {}\n    lam, V = np.linalg.eigh(Phi.T @ Phi)\n"
    "    return theta, V[:, lam < 1e-10 * lam[-1]]\n"
)
_CONSTRAINED = (
    "def constrained_fit(Phi, Y, A, b):\n    p = Phi.shape[1]\n    A, b = A[{0}], b[{0}]\n    r = len(b)\n"
    "    M = np.block([[Phi.T @ Phi, A.T], [A, np.zeros((r, r))]])\n"
    "    return np.linalg.solve(M, np.append(Phi.T @ Y, {1}b))[:p]\n"
)
_CONFIDENCE = (
    "def confidence(Phi, Y, level):\n    theta, (N, p) = np.linalg.lstsq(Phi, Y)[0], Phi.shape\n"
    "    e = Y - Phi @ theta\n"
    "    se = np.sqrt(e @ e / (N - p)) / np.sqrt({}) * np.ones(p)\n"
    "    width = scipy.stats.t.ppf((1 + level) / 2, N - p) * se\n    return theta, theta - width, theta + width\n"
)
_LEAST_SQUARES = in_rows(
    ("ls-1-kind", "tolerance of 0.001", "calls a matrix positive semidefinite whose eigenvalues are",
     _KIND.format("1e-3")),
    ("ls-1-kind", "share of 0.001", "calls a matrix positive semidefinite whose eigenvalues are",
     _KIND.format("1e-3 * np.max(np.abs(lam))")),
    ("ls-1-kind", "share of 1e-8", "", _KIND.format("1e-8 * np.max(np.abs(lam))")),
    ("ls-1-kind", "tolerance of 1e-12", "", _KIND.format("1e-12")),
    ("ls-3-derivatives", "diagonal of the Jacobian", "Its diagonal is right, and all beside it is zero",
     _DERIVATIVES.format("A @ x + A.T @ x", "np.diag(x @ x + 2 * x**2)")),
    ("ls-3-derivatives", "large step on one side", "step of 0.1 on one side",
     _DERIVATIVES.format(_ONE_SIDE, "(x @ x) * np.eye(len(x)) + 2 * np.outer(x, x)")),
    ("ls-3-derivatives", "step on both sides", "step of 0.02 on both sides",
     _DERIVATIVES.format("A @ x + A.T @ x", _BOTH_SIDES)),
    ("ls-3-derivatives", "entries of the diagonal added", "`gradient_form` is not the derivative of",
     _DERIVATIVES.format("A @ x + A.T @ x + 0.3 * x", "(x @ x) * np.eye(len(x)) + 2 * np.outer(x, x)")),
    ("ls-6-all-solutions", "multiple of the identity", r"Phi'Phi \+ 0.01 I in the place of Phi'Phi",
     _ALL_SOLUTIONS.format("np.linalg.solve(Phi.T @ Phi + 0.01 * np.eye(Phi.shape[1]), Phi.T @ Y)")),
    ("ls-6-all-solutions", "multiple of the diagonal", "does not solve the normal equations.*`inv` of a singular",
     _ALL_SOLUTIONS.format("np.linalg.solve(Phi.T @ Phi + 0.1 * np.diag(1 + np.arange(Phi.shape[1])), Phi.T @ Y)")),
    ("ls-6-all-solutions", "larger by a tenth", r"does not solve the normal equations\. All of it",
     _ALL_SOLUTIONS.format("1.1 * np.linalg.pinv(Phi) @ Y")),
    ("ls-9-constrained", "first constraint alone", "meets row 0 of A theta = b alone", _CONSTRAINED.format(":1", "")),
    ("ls-9-constrained", "all constraints, of twice the value", "does not satisfy it: A theta differs",
     _CONSTRAINED.format(":", "2 * ")),
    ("ls-9-constrained", "all constraints", "", _CONSTRAINED.format(":", "")),
    ("ls-10-confidence", "standard error of a mean",
     "inverse of Phi'Phi is missing.* and the standard errors are divided by the root of n", _CONFIDENCE.format("N")),
    ("ls-10-confidence", "standard error by the root of N - 2", "Print sigma.2, the diagonal of the inverse",
     _CONFIDENCE.format("N - 2")),
)  # fmt: skip
_CRITERIA = (
    "def losses(u, y, orders):\n    s, V = max(orders), []\n    for n in orders:\n"
    "        Phi, Y = equations(u, y, n, n, 1)\n        Phi, Y = Phi[s - n:], Y[s - n:]\n"
    "        V.append(np.mean((Y - Phi @ np.linalg.lstsq(Phi, Y)[0]) ** 2))\n    return np.array(V)\n\n\n"
    "def criteria(V, N, p):\n    V, p = np.asarray(V), np.asarray(p)\n    aic = N * np.log(V) + 2 * p + {}\n"
    "    return aic, N * np.log(V) + np.log(N) * p, V * (N + p) / (N - p)\n"
)
_APPLY = (
    "def apply(P, x):\n    y = {}\n    for i, p in enumerate(P):\n"
    "        y[i:] = y[i:] + p * x[:len(x) - i]\n    return y\n"
)
_EXAMPLE = (
    "def example_3_1(u, y):\n    Phi, Y = np.column_stack([-y[:-1], u[:-1]]), y[1:]\n    return {}\n\n\n"
    "theta_1, theta_2 = example_3_1(u_1, y_1), example_3_1(u_2, y_2)\n"
)
_MODEL_STRUCTURES = in_rows(
    ("ms-2-shift", "array of whole numbers", "An array of whole numbers cuts off",
     _APPLY.format("np.zeros_like(x, dtype=int)")),
    ("ms-2-shift", "result of whole numbers", "not p0 x",
     _APPLY.format("np.zeros_like(x)").replace("return y\n", "return y.astype(int)\n")),
    ("ms-5-example-3-1", "each alone", "fits each column of Phi alone",
     _EXAMPLE.format("(Phi.T @ Y) / np.sum(Phi**2, axis=0)")),
    ("ms-5-example-3-1", "each alone, of one size", r"\[-y\(t-1\), u\(t-1\)\]",
     _EXAMPLE.format("(Phi.T @ Y) / np.sum(Phi**2)")),
    ("ms-8-order", "correction for small samples", "the correction for small samples",
     _CRITERIA.format("2 * p * (p + 1) / (N - p - 1)")),
    ("ms-8-order", "another correction", "AIC of `criteria` is not right",
     _CRITERIA.format("2 * p * (p + 1) / (N + p)")),
)  # fmt: skip
_GAUSS_NEWTON = (
    "def gauss_newton(g, jacobian, y, theta0, steps):\n    theta = np.array(theta0, float)\n    path = [theta]\n"
    "    for _ in range(steps):\n        J, e = jacobian(theta), y - g(theta)\n        theta = theta + {}\n"
    "        path.append(theta)\n    return np.array(path)\n"
)
_LEVENBERG = (
    "def damped_step(J, e, mu):\n    M = J.T @ J\n"
    "    return np.linalg.solve(M + mu * np.diag(np.diag(M)), J.T @ e)\n\n\n"
    "def levenberg_marquardt(g, jacobian, y, theta0):\n    theta, mu = np.array(theta0, float), 1e-3\n"
    "    sse = np.sum((y - g(theta)) ** 2)\n    for _ in range(500):\n"
    "        s = damped_step(jacobian(theta), y - g(theta), mu)\n        theta = theta + s\n"
    "        new = np.sum((y - g(theta)) ** 2)\n        mu, sse = mu / 10 if new < sse else mu * 10, new\n"
    "    return theta\n"
)
_NONLINEAR = in_rows(
    ("nl-1-logarithm", "weights", "The argument `w` is not asked for",
     "def fit_logarithm(x, y):\n    a, c = np.polyfit(x, np.log(y), 1, w=y)\n    return a, np.exp(c)\n"),
    ("nl-1-logarithm", "weights twice", "does not return the a and b of the line",
     "def fit_logarithm(x, y):\n    a, c = np.polyfit(x, np.log(y), 1, w=y)\n    return a, np.exp(c) + a\n"),
    ("nl-3-gauss-newton", "along the gradient", "takes 0.2 J'e for each step, along the gradient",
     _GAUSS_NEWTON.format("0.2 * J.T @ e")),
    ("nl-3-gauss-newton", "along the gradient of each alone", "leaves the right one",
     _GAUSS_NEWTON.format("J.T @ e / np.sum(J**2, axis=0)")),
    ("nl-4-damping", "every step taken", "`J.T @ J` is a sum of squares, so every entry of `J` is zero", _LEVENBERG),
)  # fmt: skip
TRIES: dict[str, tuple[Try, ...]] = {
    "least-squares": _LEAST_SQUARES,
    "model-structures": _MODEL_STRUCTURES,
    "nonlinear-least-squares": _NONLINEAR,
    "recursive-identification": _RECURSIVE,
    "postlab-model-order": _POSTLAB,
    "lab-identification": _LAB,
    "armax-and-instruments": _ARMAX,
    "sim-to-real-gap": _SIM_TO_REAL_GAP,
    "step-response": _STEP_RESPONSE,
}
