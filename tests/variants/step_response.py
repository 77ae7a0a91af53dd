"""Answers to the appendix that differ from the model solution, right ones and wrong ones."""

from variants import Right, Wrong, define, right, wrong

READ, RESPONSE, MSE, FIGURE = "step-1-read", "step-2-response", "step-3-mse", "step-3-figure"
FUNCTION, CUT, TANK = "step-5-function", "step-6-cut", "step-6-model"
TWO, ERROR, LOSS, GRADIENT = "step-7-two", "step-8-error", "step-8-loss", "step-8-gradient"
MINIMUM, UNIQUE = "step-9-minimum", "step-9-unique"


def reading(K: str = "y_end / amplitude", tau: str = "1.5 * (t_63 - t_28)", td: str = "t_63 - tau") -> str:
    return (
        "y_end = y_step[-1]\n"
        "t_28 = t_step[y_step >= 0.283 * y_end][0]\n"
        "t_63 = t_step[y_step >= 0.632 * y_end][0]\n"
        f"K = {K}\ntau = {tau}\ntd = {td}\n"
    )


def response(body: str) -> str:
    return define("first_order_response(t, K, tau, td, amplitude)", body)


def read_step(
    K: str = "(end - start) / amplitude",
    tau: str = "1.5 * (t_63 - t_28)",
    td: str = "t_63 - tau",
    start: str = "y[0]",
    way: str = "(y - start) / (end - start)",
) -> str:
    return define(
        "read_step(t, y, amplitude)",
        f"start, end = {start}, np.mean(y[-20:])\n"
        f"way = {way}\n"
        "t_28, t_63 = t[np.argmax(way >= 0.283)], t[np.argmax(way >= 0.632)]\n"
        f"K = {K}\ntau = {tau}\ntd = {td}\n"
        "return K, tau, td",
    )


def cut(
    t: str = "t_act[first:second] - t_act[first]",
    y: str = "y_act[first:second] - y_act[:first].mean()",
    a: str = "u_act[first] - u_act[first - 1]",
    changes: str = "np.flatnonzero(np.diff(u_act)) + 1",
) -> str:
    return f"first, second = ({changes})[:2]\nt_held = {t}\ny_held = {y}\na_held = {a}\n"


def solve_two(a1: str = "(u22*y1 - u12*y2) / det", a2: str = "(u11*y2 - u21*y1) / det", check: bool = True) -> str:
    return define(
        "solve_two(U, Y)",
        "(u11, u12), (u21, u22) = U\n"
        "y1, y2 = Y\n"
        "det = u11 * u22 - u12 * u21\n"
        + ("if det == 0:\n    return None\n" if check else "")
        + f"return np.array([{a1}, {a2}])",
    )


def of_theta(name: str, body: str) -> str:
    return define(f"{name}(Phi, Y, theta)", body)


# Where the function of an earlier step is of no use at all, a later step can still be done without it.
MSE_WITHOUT_THE_FUNCTION = (
    "y_approx = 2 * K * (1 - np.exp(-(t_step - td) / tau)) * (t_step > td)\nmse_approx = 0\n"
    "for k in range(801):\n    mse_approx = mse_approx + (y_step[k] - y_approx[k]) ** 2 / 801\n"
)
TANK_WITHOUT_THE_FUNCTION = (
    "end = y_held[-20:].mean()\nK_tank = end / a_held\nway = y_held / end\n"
    "td_tank = t_held[np.argmax(way > 0.04)]\ntau_tank = t_held[np.argmax(way > 0.632)] - td_tank\n"
)

VARIANTS: list[Right | Wrong] = [
    # 1. reading K, tau and td
    right(
        READ,
        "two instants, counted in a loop",
        "K = y_step[-1] / 2\nk = 0\nwhile y_step[k] < 0.283 * y_step[-1]:\n"
        "    k = k + 1\nm = k\nwhile y_step[m] < 0.632 * y_step[-1]:\n    m = m + 1\n"
        "tau = 3 / 2 * (t_step[m] - t_step[k])\ntd = t_step[m] - tau\n",
    ),
    right(READ, "from the picture", "K, tau, td = 3, 5.2, 0.9"),
    right(
        READ,
        "delay where the response shows",
        reading(tau="t_63 - td")
        .replace("K =", "td = t_step[y_step > 0.03 * y_end][0]\nK =")
        .replace("\ntd = t_63 - tau", ""),
    ),
    right(
        READ,
        "curve fitting",
        "from scipy.optimize import curve_fit\n"
        "def model(t, K, tau, td):\n    return 2 * K * (1 - np.exp(-np.maximum(t - td, 0) / tau))\n"
        "(K, tau, td), _ = curve_fit(model, t_step, y_step, p0=[3, 5, 1])\n",
    ),
    wrong(READ, "amplitude left in K", reading(K="y_end"), "amplitude not divided out", "divide it by the amplitude"),
    wrong(READ, "gain inverted", reading(K="amplitude / y_end"), "gain inverted", "output over input"),
    wrong(READ, "tau from the step on", reading(tau="t_63", td="0.94"), "tau measured from the step", "from t_d"),
    wrong(
        READ,
        "50 % from the step",
        reading(tau="t_step[np.argmax(y_step >= 0.5 * y_end)]", td="t_63 - tau"),
        "50 % taken for 63.2 %",
        "50 %",
    ),
    wrong(READ, "no delay", reading(tau="t_63", td="0"), "no delay", "has a delay"),
    wrong(READ, "factor 3/2 forgotten", reading(tau="t_63 - t_28"), "the factor 3/2 forgotten", "two thirds"),
    wrong(
        READ, "delay in samples", reading(td="np.argmax(y_step > 0.03 * y_end)"), "time in samples", "counts samples"
    ),
    wrong(
        READ,
        "settling time",
        reading(tau="t_step[y_step >= 0.95 * y_end][0] - 0.9", td="0.9"),
        "settling time in place of the time constant",
        "95 %",
    ),
    wrong(
        READ,
        "tau to 50 %",
        reading(tau="t_step[y_step >= 0.5 * y_end][0] - 0.9", td="0.9"),
        "50 % taken for 63.2 %",
        "measured to 50 %",
    ),
    wrong(
        READ,
        "tau and td exchanged",
        reading() + "tau, td = td, tau\n",
        "order of K, tau and td",
        "in another order",
    ),
    wrong(READ, "63.2 % for the delay", reading(td="t_63"), "63.2 % taken for the delay", r"t_d \+ tau"),
    wrong(READ, "zeros", "K = tau = td = 0", None, "K is not the change"),
    wrong(READ, "far off", "K, tau, td = 3, 9, 0.9", None, "28.3 % at 3.9 s, too late"),
    # 2. the response
    right(
        RESPONSE,
        "two cases with where",
        response("rising = K * amplitude * (1 - np.exp(-(t - td) / tau))\nreturn np.where(t >= td, rising, 0)"),
    ),
    right(
        RESPONSE,
        "loop over the samples",
        response(
            "y = np.zeros(len(t))\nfor k in range(len(t)):\n    if t[k] > td:\n"
            "        y[k] = K * amplitude * (1 - np.exp(-(t[k] - td) / tau))\nreturn y"
        ),
    ),
    right(
        RESPONSE,
        "python-control, shifted by whole samples",
        response(
            "y = ct.forced_response(ct.tf([K], [tau, 1]), t, np.full(len(t), amplitude)).outputs\n"
            "n = int(round(td / (t[1] - t[0])))\nreturn np.concatenate([np.zeros(n), y[:len(t) - n]])"
        ),
    ),
    wrong(
        RESPONSE,
        "the formula alone",
        response("return K * amplitude * (1 - np.exp(-(t - td) / tau))"),
        "not zero before the delay",
        "not zero before td",
    ),
    wrong(
        RESPONSE,
        "amplitude forgotten",
        response("return K * (1 - np.exp(-np.maximum(t - td, 0) / tau))"),
        "amplitude forgotten",
        "does not depend on the amplitude",
    ),
    wrong(
        RESPONSE, "no delay", response("return K * amplitude * (1 - np.exp(-t / tau))"), "no delay", "starts at once"
    ),
    wrong(
        RESPONSE,
        "cut, not shifted",
        response("return np.where(t >= td, K * amplitude * (1 - np.exp(-t / tau)), 0)"),
        "delay cut but not shifted",
        "jumps",
    ),
    wrong(
        RESPONSE,
        "falling",
        response("return np.where(t >= td, K * amplitude * np.exp(-(t - td) / tau), 0)"),
        "decays",
        "falls",
    ),
    wrong(
        RESPONSE,
        "times tau",
        response("return K * amplitude * (1 - np.exp(-np.maximum(t - td, 0) * tau))"),
        "multiplied by the time constant",
        "divide by it",
    ),
    wrong(
        RESPONSE,
        "always a = 2",
        response("return 2 * K * (1 - np.exp(-np.maximum(t - td, 0) / tau))"),
        "amplitude of 2 assumed",
        "always uses the amplitude 2",
    ),
    Wrong(
        RESPONSE,
        "y_step from above",
        {"step-2-response-answer": response("return y_step"), "step-3-mse-answer": MSE_WITHOUT_THE_FUNCTION},
        says="should have 1.. elements",
    ),
    Wrong(
        RESPONSE,
        "no return",
        {"step-2-response-answer": response("y = K * amplitude"), "step-3-mse-answer": MSE_WITHOUT_THE_FUNCTION},
        says="return",
        slip="no return",
    ),
    # 3. the comparison
    right(
        MSE,
        "with names of its own",
        "model = first_order_response(t_step, K, tau, td, 2)\ny_approx = model\n"
        "e = y_step - model\nmse_approx = e @ e / len(e)\n",
    ),
    right(
        MSE,
        "a loop, without the function",
        MSE_WITHOUT_THE_FUNCTION,
    ),
    right(
        MSE,
        "a delayed step simulated",
        "delayed = np.where(t_step >= td, amplitude, 0)\n"
        "y_approx = ct.forced_response(ct.tf([K], [tau, 1]), t_step, delayed).outputs\n"
        "mse_approx = np.mean((y_step - y_approx) ** 2)\n",
    ),
    wrong(
        MSE,
        "root",
        "y_approx = first_order_response(t_step, K, tau, td, 2)\n"
        "mse_approx = np.sqrt(np.mean((y_step - y_approx) ** 2))",
        "root mean square",
        "root",
    ),
    wrong(
        MSE,
        "sum",
        "y_approx = first_order_response(t_step, K, tau, td, 2)\nmse_approx = np.sum((y_step - y_approx) ** 2)",
        "sum in place of the mean",
        "divide by N",
    ),
    wrong(
        MSE,
        "not squared",
        "y_approx = first_order_response(t_step, K, tau, td, 2)\nmse_approx = np.mean(y_step - y_approx)",
        "not squared",
        "square them first",
    ),
    wrong(
        MSE,
        "step of one",
        "y_approx = first_order_response(t_step, K, tau, td, 1)\nmse_approx = np.mean((y_step - y_approx) ** 2)",
        "amplitude of one",
        "step of amplitude 1",
    ),
    wrong(MSE, "the original itself", "y_approx = y_step\nmse_approx = 0", "the record itself", "`y_step` itself"),
    right(
        FIGURE,
        "pyplot",
        "fig_a2 = plt.figure()\nplt.plot(t_step, y_step, t_step, y_approx)\nplt.xlabel('Time (s)')\n"
        "plt.ylabel('Output (V)')\nplt.legend(['original', 'approximate'])\n",
    ),
    right(
        FIGURE,
        "stairs and units after a slash",
        "fig_a2, ax = plt.subplots()\n"
        "ax.step(t_step, y_step, where='post', label='$y$')\nax.plot(t_step, y_approx, label=r'$\\hat y$')\n"
        "ax.axhline(6, color='0.8')\nax.set(xlabel='$t$ / s', ylabel='$y$ / V')\nax.legend()\n",
    ),
    right(
        FIGURE,
        "two panels, legend of the figure, points",
        "fig_a2, (a, b) = plt.subplots(2, 1)\na.scatter(t_step, y_step, label='original')\n"
        "b.plot(t_step, y_approx, label='model')\na.set_ylabel('y (V)')\nb.set(xlabel='Time (s)', ylabel='y (V)')\n"
        "fig_a2.legend()\n",
    ),
    wrong(
        FIGURE,
        "labels of the axes swapped",
        "fig_a2, ax = plt.subplots()\nax.plot(t_step, y_step, label='y')\nax.plot(t_step, y_approx, label='m')\n"
        "ax.set(xlabel='Output (V)', ylabel='Time (s)')\nax.legend()\n",
        "axis labels swapped",
        "labels of the two axes are swapped",
    ),
    wrong(
        FIGURE,
        "one curve",
        "fig_a2, ax = plt.subplots()\nax.plot(t_step, y_step, label='y')\n"
        "ax.set(xlabel='Time (s)', ylabel='Output (V)')\nax.legend()\n",
        "no curve",
        "no curve shows the response `y_approx`",
    ),
    wrong(
        FIGURE,
        "against samples",
        "fig_a2, ax = plt.subplots()\nax.plot(y_step, label='y')\nax.plot(y_approx, label='m')\n"
        "ax.set(xlabel='Time (s)', ylabel='Output (V)')\nax.legend()\n",
        "drawn against the sample number",
        "drawn against the sample number",
    ),
    wrong(
        FIGURE,
        "no unit",
        "fig_a2, ax = plt.subplots()\nax.plot(t_step, y_step, label='y')\n"
        "ax.plot(t_step, y_approx, label='m')\nax.set(xlabel='Time', ylabel='Output')\nax.legend()\n",
        "no unit",
        "no unit",
    ),
    wrong(
        FIGURE,
        "no legend",
        "fig_a2, ax = plt.subplots()\nax.plot(t_step, y_step)\nax.plot(t_step, y_approx)\n"
        "ax.set(xlabel='Time (s)', ylabel='Output (V)')\n",
        "no legend",
        "legend should name 2",
    ),
    # 5. the function
    right(
        FUNCTION,
        "delay where it leaves 3 % of the way",
        read_step(td="t[np.argmax(way >= 0.03)]", tau="t_63 - td").replace(
            "    tau = t_63 - td\n    td = t[np.argmax(way >= 0.03)]\n",
            "    td = t[np.argmax(way >= 0.03)]\n    tau = t_63 - td\n",
        ),
    ),
    right(
        FUNCTION,
        "instants between the samples",
        read_step().replace(
            "t_28, t_63 = t[np.argmax(way >= 0.283)], t[np.argmax(way >= 0.632)]",
            "t_28, t_63 = np.interp([0.28347, 0.63212], np.maximum.accumulate(way), t)",
        ),
    ),
    right(
        FUNCTION,
        "curve fitting, as a list",
        define(
            "read_step(t, y, amplitude)",
            "from scipy.optimize import curve_fit\n"
            "def model(t, K, tau, td, start):\n"
            "    return start + K * amplitude * (1 - np.exp(-np.maximum(t - td, 0) / tau))\n"
            "guess = [(y[-1] - y[0]) / amplitude, t[-1] / 8, t[-1] / 20, y[0]]\n"
            "found, _ = curve_fit(model, t, y, p0=guess)\n"
            "return list(found[:3])",
        ),
    ),
    right(
        FUNCTION,
        "a logarithm and a straight line",
        read_step()
        .replace(
            "    K =",
            "    use = (way > 0.1) & (way < 0.9)\n"
            "    slope, at_zero = np.polyfit(t[use], np.log(1 - way[use]), 1)\n    K =",
        )
        .replace("tau = 1.5 * (t_63 - t_28)", "tau = -1 / slope")
        .replace("td = t_63 - tau", "td = at_zero * tau"),
    ),
    wrong(
        FUNCTION,
        "td before tau",
        read_step().replace("return K, tau, td", "return K, td, tau"),
        "order of K, tau and td",
        "in another order",
    ),
    wrong(
        FUNCTION,
        "amplitude left in",
        read_step(K="end - start"),
        "amplitude not divided out",
        "divide it by the amplitude",
    ),
    wrong(
        FUNCTION,
        "size of the amplitude",
        read_step(K="(end - start) / abs(amplitude)"),
        "sign of the gain",
        "wrong sign",
    ),
    wrong(
        FUNCTION,
        "level left in the gain",
        read_step(K="end / amplitude"),
        "initial level left in",
        "use the change",
    ),
    wrong(FUNCTION, "level left in everywhere", read_step(start="0"), "initial level left in", "use the change"),
    wrong(FUNCTION, "63.2 % of the end", read_step(way="y / end"), "initial level left in", "use the change"),
    wrong(
        FUNCTION,
        "tau from the step on",
        read_step(tau="t_63", td="t[np.argmax(way >= 0.03)]"),
        "tau measured from the step",
        "from t_d",
    ),
    wrong(FUNCTION, "no delay", read_step(tau="t_63", td="0"), "no delay", "has a delay"),
    wrong(
        FUNCTION,
        "delay in samples",
        read_step(td="np.argmax(way >= 0.03)", tau="t_63 - t[np.argmax(way >= 0.03)]"),
        "time in samples",
        "counts samples",
    ),
    wrong(
        FUNCTION,
        "first change of y",
        read_step(tau="t_63 - t[np.argmax(y != y[0])]", td="t[np.argmax(y != y[0]) - 1]"),
        "no delay",
        "noise changes y at once",
    ),
    wrong(
        FUNCTION,
        "only upwards",
        define(
            "read_step(t, y, amplitude)",
            "start, end = y[0], np.mean(y[-20:])\n"
            "t_28 = t[np.argmax(y >= start + 0.283 * (end - start))]\n"
            "t_63 = t[np.argmax(y >= start + 0.632 * (end - start))]\n"
            "tau = 1.5 * (t_63 - t_28)\n"
            "return (end - start) / amplitude, tau, t_63 - tau",
        ),
        "only steps up",
        "step down",
    ),
    wrong(FUNCTION, "factor 3/2 forgotten", read_step(tau="t_63 - t_28"), "the factor 3/2 forgotten", "two thirds"),
    Wrong(
        FUNCTION,
        "the numbers from above",
        {
            "step-5-function-answer": define("read_step(t, y, amplitude)", "return K, tau, td"),
            "step-6-model-answer": TANK_WITHOUT_THE_FUNCTION,
        },
        says="K is not",
    ),
    Wrong(
        FUNCTION,
        "two of three",
        {
            "step-5-function-answer": read_step().replace("return K, tau, td", "return K, tau"),
            "step-6-model-answer": TANK_WITHOUT_THE_FUNCTION,
        },
        says="should have 3 elements",
    ),
    # 6. the tanks
    right(
        CUT,
        "while loops",
        "k = 1\nwhile u_act[k] == u_act[0]:\n    k = k + 1\nm = k + 1\nwhile u_act[m] == u_act[k]:\n"
        "    m = m + 1\nt_held = t_act[k:m] - t_act[k]\n"
        "y_held = y_act[k:m] - np.mean(y_act[:k])\na_held = u_act[k] - u_act[0]\n",
    ),
    right(
        CUT,
        "mean over the first period, up to and with the second change",
        cut("t_act[first:second + 1] - t_act[first]", "y_act[first:second + 1] - y_act[:first].mean()"),
    ),
    right(CUT, "time made anew", cut("0.75 * np.arange(second - first)")),
    wrong(CUT, "level left in", cut(y="y_act[first:second]"), "initial level left in", "subtract it"),
    wrong(
        CUT,
        "mean over the whole record",
        cut(y="y_act[first:second] - y_act.mean()"),
        "mean over the whole record",
        "mean before the first change",
    ),
    wrong(
        CUT,
        "level of the end",
        cut(y="y_act[first:second] - y_act[second - 10:second].mean()"),
        "level of the end",
        "not the level at its end",
    ),
    wrong(
        CUT,
        "off by one",
        cut(
            changes="np.flatnonzero(np.diff(u_act))",
            y="y_act[first:second] - y_act[:first + 1].mean()",
            a="u_act[first + 1] - u_act[first]",
        ),
        "off by one",
        "one sample too early",
    ),
    wrong(
        CUT,
        "the second step",
        "first, second = (np.flatnonzero(np.diff(u_act)) + 1)[1:3]\nt_held = t_act[first:second] - t_act[first]\n"
        "y_held = y_act[first:second] - y_act[first - 20:first].mean()\na_held = u_act[first] - u_act[first - 1]\n",
        "the second step",
        "after the second change",
    ),
    wrong(CUT, "time not from zero", cut("t_act[first:second]"), "time not set back to zero", "start from zero"),
    wrong(CUT, "time in samples", cut("np.arange(second - first)"), "time in samples", "in seconds"),
    wrong(
        CUT,
        "size of the step",
        cut(a="abs(u_act[first] - u_act[first - 1])"),
        "sign of the step",
        "new input minus the old",
    ),
    wrong(CUT, "level for the step", cut(a="u_act[first]"), "level in place of the change", "should be the change"),
    wrong(
        CUT,
        "not stopped",
        cut("t_act[first:] - t_act[first]", "y_act[first:] - y_act[:first].mean()"),
        "not cut at the second change",
        "stop at the second change",
    ),
    wrong(
        CUT,
        "second step",
        cut("t_act[second:] - t_act[second]", "y_act[second:] - y_act[:first].mean()"),
        None,
        "from the first change",
    ),
    right(
        TANK,
        "curve fitting",
        "from scipy.optimize import curve_fit\n"
        "def model(t, K, tau, td):\n    return a_held * K * (1 - np.exp(-np.maximum(t - td, 0) / tau))\n"
        "(K_tank, tau_tank, td_tank), _ = curve_fit(model, t_held, y_held, p0=[3, 25, 2])\n",
    ),
    right(
        TANK,
        "by hand",
        TANK_WITHOUT_THE_FUNCTION,
    ),
    wrong(
        TANK,
        "amplitude left in",
        "K_tank, tau_tank, td_tank = read_step(t_held, y_held, a_held)\nK_tank *= a_held",
        "amplitude not divided out",
        "divide it by the amplitude",
    ),
    wrong(
        TANK,
        "positive amplitude",
        "K_tank, tau_tank, td_tank = read_step(t_held, y_held, -a_held)",
        "sign of the gain",
        "wrong sign",
    ),
    wrong(
        TANK,
        "gain at 63.2 % of the way",
        "K_tank, tau_tank, td_tank = read_step(t_held, y_held, a_held)\nK_tank *= 0.632",
        "63.2 % taken for the end",
        "read it at the end",
    ),
    wrong(
        TANK,
        "in samples",
        "K_tank, tau_tank, td_tank = read_step(np.arange(len(y_held)), y_held, a_held)",
        "time in samples",
        "in seconds",
    ),
    wrong(
        TANK,
        "tau and td exchanged",
        "K_tank, td_tank, tau_tank = read_step(t_held, y_held, a_held)",
        "order of K, tau and td",
        "in another order",
    ),
    wrong(TANK, "the model of step 1", "K_tank, tau_tank, td_tank = K, tau, td", "model of part A", "values of part A"),
    # 7. two equations
    right(
        TWO,
        "numpy's solver, determinant within rounding",
        define("solve_two(U, Y)", "if abs(np.linalg.det(U)) < 1e-12:\n    return None\nreturn np.linalg.solve(U, Y)"),
    ),
    right(
        TWO,
        "as a list, catching the error",
        define(
            "solve_two(U, Y)",
            "try:\n    return list(np.linalg.inv(U) @ Y)\nexcept np.linalg.LinAlgError:\n    return None",
        ),
    ),
    wrong(TWO, "no condition", solve_two(check=False), "determinant not checked", "check the determinant"),
    wrong(
        TWO,
        "numpy's solver alone",
        define("solve_two(U, Y)", "return np.linalg.solve(U, Y)"),
        "determinant not checked",
        "check the determinant",
    ),
    wrong(
        TWO,
        "columns for rows",
        solve_two().replace("(u11, u12), (u21, u22)", "(u11, u21), (u12, u22)"),
        "transposed",
        "row i of U",
    ),
    wrong(
        TWO,
        "sum in the determinant",
        solve_two().replace("u11 * u22 - u12", "u11 * u22 + u12"),
        "sign of the determinant",
        "subtract them",
    ),
    wrong(
        TWO,
        "numerators alone",
        solve_two("u22*y1 - u12*y2", "u11*y2 - u21*y1"),
        "not divided by the determinant",
        "divide them",
    ),
    wrong(TWO, "sign of a2", solve_two(a2="(u21*y1 - u11*y2) / det"), "sign in a numerator", "wrong sign"),
    wrong(
        TWO,
        "swapped",
        solve_two("(u11*y2 - u21*y1) / det", "(u22*y1 - u12*y2) / det"),
        "a1 and a2 swapped",
        "a2 before a1",
    ),
    wrong(TWO, "always None", define("solve_two(U, Y)", "return None"), "no return", "returns nothing"),
    wrong(
        TWO,
        "always ones",
        define("solve_two(U, Y)", "return np.ones(2)"),
        None,
        "insert its result into the two equations",
    ),
    # 8. error, loss, gradient
    right(
        ERROR,
        "a loop over the equations",
        of_theta(
            "error_vector",
            "E = np.zeros(len(Y))\nfor i in range(len(Y)):\n    E[i] = Y[i] - sum(Phi[i] * theta)\nreturn E",
        ),
    ),
    right(
        ERROR,
        "columns throughout",
        of_theta("error_vector", "return Y.reshape(-1, 1) - np.dot(Phi, theta.reshape(-1, 1))"),
    ),
    wrong(
        ERROR,
        "opposite answer",
        of_theta("error_vector", "return Phi @ theta - Y"),
        "sign of the error",
        "wrong sign",
    ),
    wrong(
        ERROR,
        "only the model",
        of_theta("error_vector", "return Phi @ theta"),
        "model output in place of the error",
        "subtract it from Y",
    ),
    wrong(
        ERROR, "Phi transposed", of_theta("error_vector", "return Y - Phi.T @ theta"), "transposed Phi", "transposed"
    ),
    wrong(
        ERROR,
        "element by element",
        of_theta("error_vector", "return Y - (Phi * theta)[:, 0]"),
        "product entry by entry",
        "entry by entry",
    ),
    right(LOSS, "sum of squares", of_theta("loss", "return sum((Y - Phi @ theta) ** 2) / 2")),
    right(
        LOSS,
        "norm, as an array of one",
        of_theta("loss", "return np.array([[np.linalg.norm(Y - Phi @ theta) ** 2 / 2]])"),
    ),
    wrong(LOSS, "no half", of_theta("loss", "E = Y - Phi @ theta\nreturn E @ E"), "the half forgotten", "factor 1/2"),
    wrong(LOSS, "mean", of_theta("loss", "return np.mean((Y - Phi @ theta) ** 2)"), "mean in place of the sum", "mean"),
    wrong(LOSS, "norm", of_theta("loss", "return np.linalg.norm(Y - Phi @ theta)"), "norm not squared", "root"),
    wrong(
        LOSS, "not squared", of_theta("loss", "return 0.5 * np.sum(Y - Phi @ theta)"), "errors not squared", "cancel"
    ),
    wrong(
        LOSS,
        "Phi transposed",
        of_theta("loss", "E = Y - Phi.T @ theta\nreturn E @ E / 2"),
        "transposed Phi",
        "transposed",
    ),
    wrong(LOSS, "a vector", of_theta("loss", "return 0.5 * (Y - Phi @ theta) ** 2"), "not added up", "add them up"),
    wrong(LOSS, "zero", of_theta("loss", "return 0"), "zeros", "has errors"),
    right(GRADIENT, "through the error", of_theta("gradient", "return -Phi.T @ (Y - Phi @ theta)")),
    right(
        GRADIENT,
        "by differences of the loss",
        of_theta(
            "gradient",
            "def V(p):\n    return 0.5 * np.sum((Y - Phi @ p) ** 2)\n"
            "g = np.zeros(len(theta))\nfor i in range(len(theta)):\n    d = np.zeros(len(theta))\n    d[i] = 0.5\n"
            "    g[i] = V(theta + d) - V(theta - d)\nreturn g",
        ),
    ),
    wrong(
        GRADIENT,
        "downhill",
        of_theta("gradient", "return Phi.T @ (Y - Phi @ theta)"),
        "sign of the gradient",
        "downhill",
    ),
    wrong(
        GRADIENT,
        "no half",
        of_theta("gradient", "return -2 * Phi.T @ (Y - Phi @ theta)"),
        "the half forgotten",
        "twice",
    ),
    wrong(
        GRADIENT,
        "half twice",
        of_theta("gradient", "return -0.5 * Phi.T @ (Y - Phi @ theta)"),
        "the half kept",
        "half the right value",
    ),
    wrong(
        GRADIENT,
        "2 forgotten in one term",
        of_theta("gradient", "return -Phi.T @ Y + 0.5 * Phi.T @ Phi @ theta"),
        "the 2 of (A6) forgotten",
        "one of the two terms",
    ),
    wrong(
        GRADIENT,
        "terms added",
        of_theta("gradient", "return Phi.T @ Y + Phi.T @ Phi @ theta"),
        "sign of the gradient",
        "adds its two terms",
    ),
    wrong(
        GRADIENT,
        "Phi transposed",
        of_theta("gradient", "return Phi @ (Phi @ theta - Y)"),
        "Phi' before the errors forgotten",
        "its transpose",
    ),
    wrong(GRADIENT, "zero everywhere", of_theta("gradient", "return np.zeros(len(theta))"), "zeros", "slope"),
    # 9. minimum, uniqueness
    right(MINIMUM, "solve", define("best_theta(Phi, Y)", "return np.linalg.solve(Phi.T @ Phi, Phi.T @ Y)")),
    right(MINIMUM, "lstsq", define("best_theta(Phi, Y)", "return np.linalg.lstsq(Phi, Y, rcond=None)[0]")),
    right(
        MINIMUM,
        "pinv, as a column",
        define("best_theta(Phi, Y)", "return (np.linalg.pinv(Phi) @ Y)[:, None]").replace(
            "[:, None]", ".reshape(-1, 1)"
        )
        + "theta_column = best_theta\n"
        "def best_theta(Phi, Y):\n    return theta_column(Phi, Y).ravel()\n",
    ),
    wrong(
        MINIMUM,
        "no inverse",
        define("best_theta(Phi, Y)", "return Phi.T @ Phi @ Phi.T @ Y"),
        "inverse forgotten",
        "inverse",
    ),
    wrong(MINIMUM, "only Phi'Y", define("best_theta(Phi, Y)", "return Phi.T @ Y"), "only Phi'Y", "multiply it"),
    wrong(
        MINIMUM,
        "Phi transposed",
        define("best_theta(Phi, Y)", "return np.linalg.inv(Phi @ Phi.T) @ Phi @ Y"),
        "transposed Phi",
        "each other",
    ),
    wrong(
        MINIMUM,
        "the first equations only",
        define("best_theta(Phi, Y)", "p = Phi.shape[1]\nreturn np.linalg.solve(Phi[:p], Y[:p])"),
        "only as many equations as unknowns",
        "uses all of them",
    ),
    wrong(
        MINIMUM,
        "power of -1",
        define("best_theta(Phi, Y)", "return (Phi.T @ Phi) ** -1 @ Phi.T @ Y"),
        "powers element by element",
        "np.linalg.inv",
    ),
    wrong(MINIMUM, "zeros", define("best_theta(Phi, Y)", "return np.zeros(Phi.shape[1])"), "zeros", "smaller loss"),
    right(
        UNIQUE, "determinant within rounding", define("is_unique(Phi)", "return abs(np.linalg.det(Phi.T @ Phi)) > 1e-9")
    ),
    right(
        UNIQUE,
        "condition number, as a number",
        define("is_unique(Phi)", "n, p = Phi.shape\nif n < p:\n    return 0\nreturn int(np.linalg.cond(Phi) < 1e10)"),
    ),
    wrong(
        UNIQUE,
        "equations counted",
        define("is_unique(Phi)", "return Phi.shape[0] >= Phi.shape[1]"),
        "equations counted",
        "two equal columns",
    ),
    wrong(
        UNIQUE,
        "rank of the smaller side",
        define("is_unique(Phi)", "return np.linalg.matrix_rank(Phi) == min(Phi.shape)"),
        "rank of the rows",
        "number of columns",
    ),
    wrong(
        UNIQUE,
        "square only",
        define("is_unique(Phi)", "n, p = Phi.shape\nreturn n == p and np.linalg.matrix_rank(Phi) == p"),
        "square matrices only",
        "are allowed",
    ),
    wrong(
        UNIQUE,
        "determinant not zero",
        define("is_unique(Phi)", "return np.linalg.det(Phi.T @ Phi) != 0"),
        "zero compared exactly",
        "tiny there instead of zero",
    ),
    wrong(
        UNIQUE,
        "calls counted",
        "calls = []\n" + define("is_unique(Phi)", "calls.append(0)\nreturn len(calls) % 4 in (1, 2)"),
        None,
        "says (True|False) for a Phi of .* and rank",
    ),
    wrong(UNIQUE, "always", define("is_unique(Phi)", "return True"), "always unique", "every Phi"),
    wrong(
        UNIQUE,
        "the opposite",
        define("is_unique(Phi)", "return np.linalg.matrix_rank(Phi) < Phi.shape[1]"),
        "opposite answer",
        "opposite",
    ),
    wrong(
        UNIQUE,
        "the rank itself",
        define("is_unique(Phi)", "return np.linalg.matrix_rank(Phi)"),
        "not True or False",
        "True or False",
    ),
]
