"""Answers to the post-lab that differ from the model solution, right ones and wrong ones."""

from variants import Right, Wrong, right, wrong

PHI, THETA, TF = "postlab-1-phi", "postlab-1-theta", "postlab-1-transfer-function"
FIT, RUNS, MSE, FIGURE = "postlab-2-fit-order", "postlab-2-simulation", "postlab-3-mse", "postlab-3-figure-8"


def phi(y1: str = "y[: half - 1]", u1: str = "u[: half - 1]", Y: str = "y[1:half]") -> str:
    return f"Phi_1 = np.column_stack([{y1}, {u1}])\nY_1 = {Y}\n"


def fit(body: str, last: str = "theta_2 = fit_order(u[:half], y[:half], 2)") -> str:
    lines = "".join(f"    {line}\n" for line in body.splitlines())
    return f"def fit_order(u, y, n):\n{lines}\n\n{last}\n"


def stacked(
    y_lag: str = "y[n - i : N - i]", u_lag: str = "u[n - i : N - i]", result: str = "np.linalg.lstsq(Phi, y[n:])[0]"
) -> str:
    return (
        "N = len(y)\n"
        f"Phi = np.column_stack([{y_lag} for i in range(1, n + 1)] + [{u_lag} for i in range(1, n + 1)])\n"
        f"return {result}"
    )


def runs(first: str = "lfilter([0, theta_1[1]], [1, -theta_1[0]], u)", second: str | None = None) -> str:
    second = second or "lfilter([0, *theta_2[2:]], [1, -theta_2[0], -theta_2[1]], u)"
    return f"from scipy.signal import lfilter\ny_sim_1 = {first}\ny_sim_2 = {second}\n"


def errors(of: str = "np.mean({} ** 2)") -> str:
    return f"mse_1 = {of.format('(y - y_sim_1)')}\nmse_2 = {of.format('(y - y_sim_2)')}\n"


def figure(
    text: str = "ax.text(0.02, 0.9, f'1st order: {mse_1:.2e}, 2nd order: {mse_2:.2e}', transform=ax.transAxes)",
    curves: str = "ax.plot(t, y, label='Actual')\nax.plot(t, y_sim_1, label='First order')\n"
    "ax.plot(t, y_sim_2, label='Second order')",
    labels: str = "ax.set(xlabel='Time (s)', ylabel='y (V)')",
    legend: str = "ax.legend()",
) -> str:
    return f"fig_8, ax = plt.subplots()\n{curves}\n{text}\n{labels}\n{legend}\n"


LOOP = """
def run(a, b):
    s = np.zeros(len(u))
    for k in range(2, len(u)):
        s[k] = sum(-a[i] * s[k - 1 - i] + b[i] * u[k - 1 - i] for i in range(len(a)))
    return s


y_sim_1 = run([-theta_1[0]], [theta_1[1]])
y_sim_2 = run(-theta_2[:2], theta_2[2:])
"""

VARIANTS: list[Right | Wrong] = [
    # 1. Phi
    right(PHI, "loop", "Phi_1 = np.array([[y[k - 1], u[k - 1]] for k in range(1, half)])\nY_1 = y[1:half]"),
    right(PHI, "the same rows as the second-order model", phi("y[1 : half - 1]", "u[1 : half - 1]", "y[2:half]")),
    right(
        PHI,
        "from the very first sample, at rest before",
        phi("np.r_[0, y[: half - 1]]", "np.r_[0, u[: half - 1]]", "y[:half].reshape(-1, 1)"),
        {
            THETA: "theta_1 = (np.linalg.inv(Phi_1.T @ Phi_1) @ Phi_1.T @ Y_1)[:, 0]",
        },
    ),
    right(
        PHI,
        "the offset of the lab brought along",
        "y = y + np.mean(y[n_first // 3 : n_first]) - np.mean(y[n_first // 2 : n_first])\n" + phi(),
    ),
    wrong(PHI, "columns swapped", phi("u[: half - 1]", "y[: half - 1]"), "y and u columns swapped", "y comes first"),
    wrong(PHI, "y(k) among the regressors", phi("y[1:half]", "u[1:half]"), "lag off by one", "begins with y"),
    wrong(PHI, "u(k) in place of u(k-1)", phi(u1="u[1:half]"), "lag off by one", "input columns"),
    wrong(PHI, "minus in Phi", phi("-y[: half - 1]"), "sign of a", "minus sign is in theta"),
    wrong(PHI, "all the data", phi("y[:-1]", "u[:-1]", "y[1:]"), "fit on all the data", "first half"),
    wrong(PHI, "second half", phi("y[half:-1]", "u[half:-1]", "y[half + 1 :]"), "wrong half", "second half"),
    wrong(
        PHI,
        "transposed",
        "Phi_1 = np.vstack([y[: half - 1], u[: half - 1]])\nY_1 = y[1:half]",
        "transposed Phi",
        "transpose it",
    ),
    wrong(
        PHI,
        "offsets left in",
        phi("y_act[: half - 1]", "u_act[: half - 1]", "y_act[1:half]"),
        "offset left in",
        "offset",
    ),
    wrong(
        PHI,
        "np.roll",
        phi("np.roll(y[:half], 1)", "np.roll(u[:half], 1)", "y[:half]"),
        "index wraps around",
        "last",
    ),
    wrong(
        PHI,
        "second order again",
        "Phi_1 = np.column_stack([y[1:half-1], y[:half-2], u[1:half-1], u[:half-2]])\nY_1 = y[2:half]",
        "another order",
        "model of order 2",
    ),
    # 1. theta
    right(THETA, "lstsq", "theta_1 = np.linalg.lstsq(Phi_1, Y_1)[0]"),
    right(THETA, "pseudo-inverse", "theta_1 = np.linalg.pinv(Phi_1) @ Y_1"),
    wrong(THETA, "sign of a", "theta_1 = np.linalg.pinv(Phi_1) @ Y_1 * [-1, 1]", "sign of a", "Keep its signs"),
    wrong(THETA, "all of lstsq", "theta_1 = np.linalg.lstsq(Phi_1, Y_1)", "all that lstsq returns", "\\[0\\]"),
    wrong(
        THETA,
        "fit on all the data",
        "theta_1 = np.linalg.lstsq(np.column_stack([y[:-1], u[:-1]]), y[1:])[0]",
        "fit on all the data",
        "first half",
    ),
    wrong(THETA, "inverse forgotten", "theta_1 = Phi_1.T @ Y_1", "inverse left out", "inverse"),
    wrong(THETA, "order turned", "theta_1 = (np.linalg.pinv(Phi_1) @ Y_1)[::-1]", "order of theta", "wrong order"),
    # 1. the transfer function
    right(TF, "in powers of z to the minus one", "G_1 = ct.tf([0, theta_1[1]], [1, -theta_1[0]], Ts)"),
    right(
        TF,
        "scipy's",
        "G_1 = scipy.signal.TransferFunction([theta_1[1]], [1, -theta_1[0]], dt=Ts)",
        {RUNS: runs()},
    ),
    wrong(TF, "sign of a", "G_1 = ct.tf([theta_1[1]], [1, theta_1[0]], Ts)", "sign of a", "theta contains -a"),
    wrong(TF, "continuous time", "G_1 = ct.tf([theta_1[1]], [1, -theta_1[0]])", "no sampling time", "Ts"),
    wrong(
        TF,
        "one step early",
        "G_1 = ct.tf([theta_1[1], 0], [1, -theta_1[0]], Ts)",
        "numerator one step early",
        "one sample early",
    ),
    wrong(
        TF, "one step late", "G_1 = ct.tf([theta_1[1]], [1, -theta_1[0], 0], Ts)", "numerator one step late", "too high"
    ),
    wrong(TF, "a and b swapped", "G_1 = ct.tf([-theta_1[0]], [1, theta_1[1]], Ts)", "a and b swapped", "swapped"),
    # 2. any order
    right(
        FIT,
        "loop over the rows, inverse as printed",
        fit(
            "rows = [np.r_[y[k - n : k][::-1], u[k - n : k][::-1]] for k in range(n, len(y))]\n"
            "P = np.array(rows)\nreturn np.linalg.inv(P.T @ P) @ P.T @ y[n:]"
        ),
    ),
    right(
        FIT,
        "toeplitz",
        fit(
            "from scipy.linalg import toeplitz\n"
            "P = np.hstack([toeplitz(x[n - 1 : -1], x[n - 1 :: -1]) for x in (y, u)])\n"
            "return np.linalg.pinv(P) @ y[n:]"
        ),
    ),
    right(
        FIT,
        "at rest before the record",
        fit(
            "late = lambda x, i: np.r_[np.zeros(i), x[:-i]]\n"
            "P = np.column_stack([late(y, i + 1) for i in range(n)] + [late(u, i + 1) for i in range(n)])\n"
            "return np.linalg.lstsq(P, y)[0].reshape(-1, 1)",
            "theta_2 = fit_order(u[:half], y[:half], 2).ravel()",
        ),
    ),
    right(
        FIT, "always from k = 5", fit(stacked("y[5 - i : N - i]", "u[5 - i : N - i]", "np.linalg.lstsq(Phi, y[5:])[0]"))
    ),
    wrong(
        FIT,
        "sign of a",
        fit(stacked(result="np.linalg.lstsq(Phi, y[n:])[0] * np.repeat([-1, 1], n)")),
        "sign of a",
        "\\[-a, b\\]",
    ),
    wrong(FIT, "always second order", fit("n = 2\n" + stacked()), "order fixed", "it does not use n"),
    wrong(
        FIT, "columns of u first", fit(stacked("u[n - i : N - i]", "y[n - i : N - i]")), "order of theta", "wrong order"
    ),
    wrong(
        FIT,
        "u and y swapped",
        "def fit_order(y, u, n):\n"
        + "".join(f"    {line}\n" for line in stacked().splitlines())
        + "\ntheta_2 = fit_order(y[:half], u[:half], 2)\n",
        "u and y swapped",
        "input first",
    ),
    wrong(
        FIT,
        "works on the variables outside",
        fit(stacked()).replace("(u, y, n):\n", "(U, V, n):\n"),
        "arguments not used",
        "use the arguments",
    ),
    wrong(
        FIT,
        "lags of y off by one",
        fit(
            "N = len(y)\n"
            + stacked("y[n - i : N - i - 1]", "u[n + 1 - i : N - i]", "np.linalg.lstsq(Phi, y[n + 1 :])[0]")
        ),
        "lag off by one",
        "off by one",
    ),
    wrong(
        FIT,
        "u(k) among the regressors",
        fit(stacked(u_lag="u[n - i + 1 : N - i + 1]")),
        "lag off by one",
        "strictly proper",
    ),
    wrong(
        FIT,
        "all of lstsq",
        fit(stacked(result="np.linalg.lstsq(Phi, y[n:])"), "theta_2 = fit_order(u[:half], y[:half], 2)[0]"),
        "all that lstsq returns",
        "\\[0\\]",
    ),
    wrong(FIT, "nothing returned", fit(stacked().replace("return", "theta =")), "nothing returned", "return"),
    wrong(FIT, "fit on all the data", fit(stacked(), "theta_2 = fit_order(u, y, 2)"), "fit on all the data", "half"),
    wrong(
        FIT,
        "with a constant",
        fit(stacked(result="np.linalg.lstsq(np.c_[Phi, np.ones(N - n)], y[n:])[0][: 2 * n]")),
        "a constant fitted along",
        "column of ones",
    ),
    wrong(
        FIT,
        "the constant returned too",
        fit(stacked(result="np.linalg.lstsq(np.c_[Phi, np.ones(N - n)], y[n:])[0]")),
        "a constant fitted along",
        "one too many",
    ),
    wrong(
        FIT,
        "the global half inside",
        fit("y, u = y[:half], u[:half]\n" + stacked()),
        "arguments not used",
        "first `half` samples",
    ),
    wrong(FIT, "rounded", fit(stacked(result="np.linalg.lstsq(Phi, y[n:])[0].round(3)")), "rounded", "rounds theta"),
    # 2. the simulations
    right(RUNS, "lfilter", runs()),
    right(RUNS, "own loop", LOOP),
    wrong(RUNS, "swapped", runs() + "y_sim_1, y_sim_2 = y_sim_2, y_sim_1\n", "models swapped", "swapped"),
    wrong(
        RUNS,
        "one-step prediction",
        runs("np.r_[0, np.column_stack([y[:-1], u[:-1]]) @ theta_1]"),
        "one-step prediction",
        "measured",
    ),
    wrong(
        RUNS,
        "sign of a",
        runs(second="lfilter([0, *theta_2[2:]], [1, theta_2[0], theta_2[1]], u)"),
        "sign of a",
        "`y_sim_2`",
    ),
    wrong(RUNS, "second half only", runs() + "y_sim_1, y_sim_2 = y_sim_1[half:], y_sim_2[half:]", None, "samples"),
    wrong(
        RUNS,
        "input with its offset",
        runs("lfilter([0, theta_1[1]], [1, -theta_1[0]], u_act)"),
        "input offset left in",
        "u_act",
    ),
    wrong(
        RUNS,
        "zero forgotten",
        runs("lfilter([theta_1[1]], [1, -theta_1[0]], u)"),
        "numerator one step early",
        "too early",
    ),
    # 3. the errors
    right(MSE, "norm", errors("np.linalg.norm({}) ** 2 / len(y)")),
    right(MSE, "sum", errors("sum(e * e for e in {}) / len(y)")),
    wrong(MSE, "root", errors("np.sqrt(np.mean({} ** 2))"), "root of the mean squared error", "root"),
    wrong(MSE, "sum not divided", errors("np.sum({} ** 2)"), "sum in place of the mean", "divide"),
    wrong(MSE, "swapped", errors() + "mse_1, mse_2 = mse_2, mse_1", "errors swapped", "swapped"),
    wrong(MSE, "against the output with its offset", errors().replace("y -", "y_act -"), "offset left in", "`y_act`"),
    wrong(MSE, "one simulation twice", errors().replace("y_sim_2", "y_sim_1"), "models swapped", "`y_sim_1`"),
    wrong(MSE, "not squared", errors("np.mean({})"), "mean of the errors", "square them"),
    wrong(MSE, "over the second half", errors("np.mean({}[half:] ** 2)"), "second half only", "second half"),
    # 3. Fig. 8
    right(
        FIGURE,
        "numbers as MATLAB's sprintf writes them",
        figure("ax.text(0, 1, 'MSE1 = %.5g\\nMSE2 = %.5g' % (mse_1, mse_2))"),
    ),
    right(
        FIGURE,
        "in the legend",
        figure(
            "",
            "ax.plot(t, y, 'k')\nax.plot(t, y_sim_1)\nax.plot(t, y_sim_2)",
            legend="ax.legend(['y', f'Order 1, MSE {1e3 * mse_1:.3f}$\\\\times 10^{{-3}}$', "
            "f'Order 2, MSE {1e3 * mse_2:.3f}×10⁻³'])",
        ),
    ),
    right(
        FIGURE,
        "annotate",
        figure("ax.annotate(f'1st, 2nd: {mse_1:.6f} and {mse_2:.6f} V²', (0.02, 0.9), xycoords='axes fraction')"),
    ),
    right(
        FIGURE,
        "text of the figure",
        figure("fig_8.text(0.1, 0.9, f'MSE of order 1: {mse_1:.3e}')\nfig_8.suptitle(f'n = 2: {mse_2:.4e} $V^2$')"),
    ),
    right(
        FIGURE,
        "title of the legend",
        figure("", legend="ax.legend(title=f'first {mse_1:.3e} V$^2$, second {mse_2:.3e} V$^2$')"),
    ),
    wrong(
        FIGURE,
        "without names",
        figure("ax.text(0.02, 0.9, f'{mse_1:.6f} V², {mse_2:.6f} V²', transform=ax.transAxes)"),
        "errors without names",
        "which mean squared error",
    ),
    wrong(FIGURE, "no text", figure(""), "no errors in the figure", "no text yet"),
    wrong(FIGURE, "one error only", figure("ax.text(0, 1, f'{mse_1:.3e}')"), "no errors in the figure", "second-order"),
    wrong(
        FIGURE,
        "too few digits",
        figure("ax.text(0, 1, f'{mse_1:.0e}, {mse_2:.0e}')"),
        "too few digits",
        "three significant",
    ),
    wrong(
        FIGURE,
        "roots",
        figure("ax.text(0, 1, f'{mse_1**0.5:.3e}, {mse_2**0.5:.3e}')"),
        "root of the mean squared error",
        "root",
    ),
    wrong(
        FIGURE,
        "errors swapped",
        figure("ax.text(0, 1, f'first order: {mse_2:.3e}\\nsecond order: {mse_1:.3e}')"),
        "errors swapped",
        "swapped",
    ),
    wrong(
        FIGURE,
        "first-order model forgotten",
        figure(curves="ax.plot(t, y, label='Actual')\nax.plot(t, y_sim_2, label='Model')"),
        "no curve",
        "no curve shows `y_sim_1`",
    ),
    wrong(FIGURE, "no legend", figure(legend=""), "no legend", "legend"),
    wrong(
        FIGURE,
        "models' names swapped",
        figure(
            "ax.set_title(f'1: {mse_1:.3e} 2: {mse_2:.3e}')",
            "ax.plot(t, y, label='Actual')\nax.plot(t, y_sim_1, label='Second order')\n"
            "ax.plot(t, y_sim_2, label='First order')",
        ),
        "legend entries swapped",
        "swaps the names",
    ),
]
