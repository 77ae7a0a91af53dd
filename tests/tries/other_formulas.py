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
    ("step-7-two", "tolerance of isclose", "None for equations whose determinant is",
     _SOLVE_TWO.format("np.isclose(d, 0)")),
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
TRIES: dict[str, tuple[Try, ...]] = {"sim-to-real-gap": _SIM_TO_REAL_GAP, "step-response": _STEP_RESPONSE}
