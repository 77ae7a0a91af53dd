"""First tries at the step response."""

from tries import ACCEPTED, VAGUE, Try

READ, RESP, MSE, FIG, FUN, CUT, MODEL = (
    "step-1-read", "step-2-response", "step-3-mse", "step-3-figure", "step-5-function", "step-6-cut", "step-6-model",
)  # fmt: skip
TWO, ERR, LOSS, GRAD, MIN, UNI = (
    "step-7-two", "step-8-error", "step-8-loss", "step-8-gradient", "step-9-minimum", "step-9-unique",
)  # fmt: skip


def read(K: str = "y_end / amplitude", tau: str = "1.5 * (t_63 - t_28)", td: str = "t_63 - tau") -> str:
    return (
        "y_end = y_step[-1]\nt_28 = t_step[np.argmax(y_step >= 0.283 * y_end)]\n"
        f"t_63 = t_step[np.argmax(y_step >= 0.632 * y_end)]\nK = {K}\ntau = {tau}\ntd = {td}"
    )


def response(body: str) -> str:
    return f"def first_order_response(t, K, tau, td, amplitude):\n    return {body}\n"


def reader(K: str = "(y_end - y_start) / amplitude", start: str = "y[0]", tau: str = "1.5 * (t_63 - t_28)") -> str:
    return (
        f"def read_step(t, y, amplitude):\n    y_start = {start}\n    y_end = np.mean(y[-20:])\n"
        "    way = (y - y_start) / (y_end - y_start)\n    t_28 = t[np.argmax(way >= 0.283)]\n"
        f"    t_63 = t[np.argmax(way >= 0.632)]\n    tau = {tau}\n    return {K}, tau, max(t_63 - tau, 0)\n"
    )


def cut(
    level: str = "np.mean(y_act[first - 20 : first])", a: str = "u_act[first] - u_act[first - 1]", s: str = ""
) -> str:
    return (
        "c = np.flatnonzero(np.diff(u_act)) + 1\nfirst, second = c[0], c[1]\n"
        f"t_held = t_act[first:second] - t_act[first]\ny_held = y_act[first:second] - {level}\na_held = {a}\n{s}"
    )


def mse(value: str) -> str:
    return f"y_approx = first_order_response(t_step, K, tau, td, amplitude)\nmse_approx = {value}"


def fun(name: str, args: str, body: str) -> str:
    return f"def {name}({args}):\n    {body}\n"


A = "Phi, Y, theta"

TRIES = (
    Try(READ, "td=t28", read(td="t_28"), "td is the time to 28.3 %"),
    Try(READ, "tau = t63", read(tau="t_63", td="0"), "td is zero.*the delay is in it"),
    Try(READ, "factor", read(tau="t_63 - t_28"), "two thirds"),
    Try(READ, "gain not divided", read(K="y_end"), "divide it by the amplitude"),
    Try(READ, "level of 63", read(K="0.632 * y_end / amplitude"), "63.2 % of the change"),
    Try(READ, "samples", read(td="np.argmax(y_step >= 0.05)"), "28.3 % at", VAGUE),
    Try(READ, "MATLAB find", "t_63 = t_step(find(y_step >= 3.8, 1))", "find|square ones|np.flatnonzero"),
    Try(READ, "by eye", "K, tau, td = 3, 4, 2", "28.3 % at .* 63.2 % at"),
    Try(RESP, "impulse", response("np.where(t >= td, K * amplitude / tau * np.exp(-(t - td) / tau), 0)"), "impulse"),
    Try(RESP, "no zero before", response("K * amplitude * (1 - np.exp(-(t - td) / tau))"), "not zero before td"),
    Try(RESP, "no amplitude", response("K * (1 - np.exp(-np.maximum(t - td, 0) / tau))"), "depend on the amplitude"),
    Try(
        RESP,
        "if on array",
        "def first_order_response(t, K, tau, td, amplitude):\n    if t < td:\n        return 0\n"
        "    return K * amplitude * (1 - np.exp(-(t - td) / tau))",
        r"True or False.*`np.where\(t < .*, a, b\)`",
    ),
    Try(RESP, "e^", response("K * amplitude * (1 - e^(-(t - td) / tau))"), r"np\.exp"),
    Try(
        RESP, "math.exp", "import math\n" + response("K * amplitude * (1 - math.exp(-(t - td) / tau))"), "takes arrays"
    ),
    Try(RESP, "product missing", response("K amplitude (1 - np.exp(-(t - td) / tau))"), "two names stand side by side"),
    Try(RESP, "straight", response("K * amplitude * np.minimum(np.maximum(t - td, 0) / tau, 1)"), "straight line"),
    Try(RESP, "cosine rise", response("K * amplitude * np.tanh(np.maximum(t - td, 0) / tau)"), "in between it is not"),
    Try(
        MSE,
        "amplitude 1",
        "y_approx = first_order_response(t_step, K, tau, td, 1)\nmse_approx = np.mean((y_step - y_approx)**2)",
        "amplitude 1",
    ),
    Try(
        MSE,
        "order of arguments",
        "y_approx = first_order_response(t_step, K, td, tau, amplitude)\nmse_approx = 0",
        "in another order than",
    ),
    Try(MSE, "few arguments", "y_approx = first_order_response(t_step, K, tau, td)", "has `amplitude`, too"),
    Try(
        MSE,
        "norm",
        "y_approx = first_order_response(t_step, K, tau, td, amplitude)\n"
        "mse_approx = np.linalg.norm(y_step - y_approx)",
        "norm of the error",
    ),
    Try(
        MSE,
        "sum",
        "y_approx = first_order_response(t_step, K, tau, td, amplitude)\nmse_approx = np.sum((y_step - y_approx)**2)",
        "is the sum: divide by N",
    ),
    Try(FIG, "not the figure", "plt.plot(t_step, y_step)\nfig_a2 = plt.gca()", "figure itself"),
    Try(
        FIG,
        "no legend",
        "fig_a2, ax = plt.subplots()\nax.plot(t_step, y_step)\nax.plot(t_step, y_approx)\n"
        "ax.set(xlabel='Time (s)', ylabel='Output (V)')",
        "legend should name",
    ),
    Try(
        FIG,
        "labels swapped",
        "fig_a2, ax = plt.subplots()\nax.plot(t_step, y_step)\nax.plot(t_step, y_approx)\n"
        "ax.set(xlabel='Output (V)', ylabel='Time (s)')",
        "swapped",
    ),
    Try(FUN, "abs for down", reader(K="abs((y_end - y_start) / amplitude)"), "absolute value"),
    Try(FUN, "uses amplitude var 2", reader(K="(y_end - y_start) / 2"), "change over 2"),
    Try(FUN, "start zero", reader(start="0"), "level before the step"),
    Try(FUN, "no amplitude", reader(K="y_end - y_start"), "divide it by the amplitude"),
    Try(FUN, "factor", reader(tau="t_63 - t_28"), "two thirds"),
    Try(FUN, "no return", reader().replace("return", "result ="), "returns nothing"),
    Try(FUN, "two results", reader().replace(", max(t_63 - tau, 0)", ""), "3 elements"),
    Try(
        FUN,
        "y_step inside",
        reader().replace("np.mean(y[-20:])", "y_step[-1]"),
        "`read_step` reads `y_step` of the notebook",
    ),
    Try(CUT, "y0 at step only", cut("y_act[first]"), "one sample, number"),
    Try(CUT, "one before", cut("y_act[first - 1]"), "one sample, number"),
    Try(CUT, "level left in", cut("0"), "still includes the level"),
    Try(CUT, "mean of all", cut("np.mean(y_act)"), "mean over the whole record"),
    Try(CUT, "time", cut(s="t_held = t_act[first:second]"), "start from zero"),
    Try(CUT, "level for step", cut(a="u_act[first]"), "new level"),
    Try(CUT, "sign", cut(a="u_act[first - 1] - u_act[first]"), "wrong sign"),
    Try(
        CUT,
        "off by one",
        "c = np.flatnonzero(np.diff(u_act))\nfirst, second = c[0], c[1]\n"
        "t_held = t_act[first:second] - t_act[first]\ny_held = y_act[first:second] - np.mean(y_act[:first])\n"
        "a_held = u_act[first + 1] - u_act[first]",
        "one sample too early",
    ),
    Try(CUT, "where", "first = np.where(np.diff(u_act) != 0)\ny_held = y_act[first:]", "an index is one number"),
    Try(MODEL, "unpack", "K_tank, tau_tank = read_step(t_held, y_held, a_held)", "as many names"),
    Try(MODEL, "order", "tau_tank, K_tank, td_tank = read_step(t_held, y_held, a_held)", "another order"),
    Try(MODEL, "whole record", "K_tank, tau_tank, td_tank = read_step(t_act, y_act, a_held)", "of the whole record"),
    Try(MODEL, "old values", "K_tank, tau_tank, td_tank = K, tau, td", "are the values of part A"),
    Try(TWO, "1-based", fun("solve_two", "U, Y", "return np.array([U[1, 1], U[2, 2]])"), "indices 0 to 1"),
    Try(TWO, "inv", fun("solve_two", "U, Y", "return np.linalg.inv(U) * Y"), "the inverse of U and Y entry by entry"),
    Try(
        TWO,
        "inverse of U",
        fun("solve_two", "U, Y", "return np.linalg.inv(U)"),
        "the inverse of U alone",
        never="entry by entry",
    ),
    Try(TWO, "U itself", fun("solve_two", "U, Y", "return U"), "is U alone", never="inverse of U"),
    Try(TWO, "first unknown", fun("solve_two", "U, Y", "return np.linalg.solve(U, Y)[0]"), "both unknowns"),
    Try(TWO, "no None", fun("solve_two", "U, Y", "return np.linalg.solve(U, Y)"), "does not return `None`"),
    Try(
        TWO,
        "sign",
        fun(
            "solve_two",
            "U, Y",
            "d = U[0, 0]*U[1, 1] + U[0, 1]*U[1, 0]\n    return np.array([U[1, 1]*Y[0] - "
            "U[0, 1]*Y[1], U[0, 0]*Y[1] - U[1, 0]*Y[0]]) / d",
        ),
        "adds the two products",
    ),
    Try(TWO, "transposed", fun("solve_two", "U, Y", "return np.linalg.solve(U.T, Y)"), "confuses u12"),
    Try(TWO, "MATLAB index", fun("solve_two", "U, Y", "return U(1, 1)"), r"MATLAB's `U\(1, 1\)` is `U\[0, 0\]`"),
    Try(ERR, "*", fun("error_vector", A, "return Y - Phi * theta"), r"comes of `Phi \* theta`"),
    Try(ERR, "reversed", fun("error_vector", A, "return Phi @ theta - Y"), "wrong sign"),
    Try(
        ERR, "transposed", fun("error_vector", A, "return Y - Phi.T @ theta"), "theta by the transpose.*not transposed"
    ),
    Try(ERR, "theta first", fun("error_vector", A, "return Y - theta @ Phi"), "theta by the transpose.*not transposed"),
    Try(ERR, "squares", fun("error_vector", A, "return (Y - Phi @ theta)**2"), "do not square"),
    Try(ERR, "output", fun("error_vector", A, "return Phi @ theta"), "subtract it from Y"),
    Try(LOSS, "no half", fun("loss", A, "E = Y - Phi @ theta\n    return E @ E"), "factor 1/2"),
    Try(LOSS, "mean", fun("loss", A, "return np.mean((Y - Phi @ theta)**2)"), "mean of the squared"),
    Try(LOSS, "not summed", fun("loss", A, "return 0.5 * (Y - Phi @ theta)**2"), "add them up"),
    Try(LOSS, "norm", fun("loss", A, "return 0.5 * np.linalg.norm(Y - Phi @ theta)"), "contains a root"),
    Try(LOSS, "E undefined", fun("loss", A, "return 0.5 * E @ E"), "run the cells|define|There is"),
    Try(LOSS, "quarter", fun("loss", A, "E = Y - Phi @ theta\n    return 0.5 * (0.5 * E @ E)"), "half the right value"),
    Try(GRAD, "sign", fun("gradient", A, "return Phi.T @ (Y - Phi @ theta)"), "wrong sign"),
    Try(GRAD, "twice", fun("gradient", A, "return -2 * Phi.T @ (Y - Phi @ theta)"), "twice too large"),
    Try(
        GRAD,
        "no transpose",
        fun("gradient", A, "return -Phi @ (Y - Phi @ theta)"),
        "by Phi itself.*should be multiplied by its transpose",
    ),
    Try(
        GRAD,
        "transpose in the errors",
        fun("gradient", A, "return -Phi @ (Y - Phi.T @ theta)"),
        "it returns Phi \\(Phi' theta - Y\\)",
        never="by Phi itself",
    ),
    Try(GRAD, "number", fun("gradient", A, "return np.sum(-Phi.T @ (Y - Phi @ theta))"), "should hold 3 numbers"),
    Try(GRAD, "one term", fun("gradient", A, "return -Phi.T @ Y"), "lacks the term"),
    Try(
        MIN,
        "Phi Phi^T",
        fun("best_theta", "Phi, Y", "return np.linalg.inv(Phi @ Phi.T) @ Phi.T @ Y"),
        "inverts Phi Phi'",
    ),
    Try(
        MIN,
        "elementwise",
        fun("best_theta", "Phi, Y", "return np.linalg.inv(Phi.T * Phi) * Phi.T * Y"),
        "It comes of eq. .8. with `.` between its parts",
    ),
    Try(
        MIN,
        "inverse alone",
        fun("best_theta", "Phi, Y", "return np.linalg.inv(Phi.T @ Phi)"),
        "the inverse of Phi'Phi alone: the product with Phi'Y is missing",
    ),
    Try(
        MIN,
        "last product entry by entry",
        fun("best_theta", "Phi, Y", "return np.linalg.inv(Phi.T @ Phi) * (Phi.T @ Y)"),
        "the inverse of Phi'Phi and Phi'Y entry by entry",
        never="alone",
    ),
    Try(MIN, "solve Phi", fun("best_theta", "Phi, Y", "return np.linalg.solve(Phi, Y)"), "square"),
    Try(MIN, "all of lstsq", fun("best_theta", "Phi, Y", "return np.linalg.lstsq(Phi, Y)"), "whole result of `lstsq`"),
    Try(
        MIN,
        "order of factors",
        fun("best_theta", "Phi, Y", "return Phi.T @ Y @ np.linalg.inv(Phi.T @ Phi)"),
        "",
        "acceptable",
    ),
    Try(MIN, "power", fun("best_theta", "Phi, Y", "return (Phi.T @ Phi)**-1 @ Phi.T @ Y"), "one by one"),
    Try(UNI, "square", fun("is_unique", "Phi", "return Phi.shape[0] == Phi.shape[1]"), "for every square Phi"),
    Try(UNI, "determinant", fun("is_unique", "Phi", "return np.linalg.det(Phi.T @ Phi) != 0"), "By rounding"),
    Try(
        UNI,
        "rank of rows",
        fun("is_unique", "Phi", "return np.linalg.matrix_rank(Phi) == Phi.shape[0]"),
        "number of columns",
    ),
    Try(UNI, "counted", fun("is_unique", "Phi", "return len(Phi) >= Phi.shape[1]"), "compares only the numbers"),
    Try(UNI, "rank itself", fun("is_unique", "Phi", "return np.linalg.matrix_rank(Phi)"), "True or False"),
    Try(
        UNI,
        "det of Phi",
        fun("is_unique", "Phi", "return np.linalg.det(Phi) != 0"),
        r"only a square matrix has a determinant.*matrix_rank",
        never="Least squares inverts",
    ),
    Try(FUN, "t_step for t", reader().replace(" t[", " t_step["), "never reads its argument `t`, but `t_step`"),
    Try(FUN, "half of tau", reader(tau="0.75 * (t_63 - t_28)"), "too (early|late)", never="never reads"),
    Try(
        FUN,
        "np.interp",
        "def read_step(t, y, amplitude):\n    d = y[-1] - y[0]\n    t_28 = np.interp(0.283 * d + y[0], y, t)\n"
        "    t_63 = np.interp(0.632 * d + y[0], y, t)\n    tau = 1.5 * (t_63 - t_28)\n"
        "    return d / amplitude, tau, t_63 - tau\n",
        "np.interp` needs values that rise",
    ),
    Try(READ, "shares of K", read().replace("* y_end", "* y_end / amplitude"), "28.3 % of K, and the response goes"),
    Try(READ, "2/3", read(tau="2 / 3 * (t_63 - t_28)"), "2/3 of t_63 - t_28; by the text"),
    Try(READ, "t_28 - t_63", read(tau="1.5 * (t_28 - t_63)"), "tau is negative"),
    Try(MSE, "numbers of the process", "y_approx = first_order_response(t_step, 3, 5, 1, amplitude)", "3, 5 and 1"),
    Try(FUN, "largest value", reader().replace("np.mean(y[-20:])", "np.max(y)"), "largest y is not the end"),
    Try(FUN, "a third for 28.3 %", reader().replace("0.283", "1 / 3"), "from 33.3 % to 63.2 %"),
    Try(FUN, "exact shares", reader().replace("0.283", "1 - np.exp(-1 / 3)"), "", ACCEPTED),
    Try(
        MODEL,
        "amplitude of part A",
        "K_tank, tau_tank, td_tank = read_step(t_held, y_held, amplitude)",
        "K is the change over 2, and this step has the amplitude",
    ),
    Try(LOSS, "1//2", fun("loss", A, "return 1 // 2 * (Y - Phi @ theta) @ (Y - Phi @ theta)"), "`1//2` is 0"),
    Try(
        TWO,
        "text",
        fun("solve_two", "U, Y", "return np.linalg.solve(U, Y) if np.linalg.det(U) else 'None'"),
        "no quotes",
    ),
    Try(
        READ,
        "==",
        read().replace("t_step[np.argmax(y_step >= 0.632 * y_end)]", "t_step[y_step == 0.632 * y_end]"),
        "where no entry meets",
    ),
    Try(READ, "tau = t63, delay from it", read(tau="t_63"), "td is zero.*the delay is in it"),
    Try(
        READ,
        "no delay",
        "K, td = y_step[-1] / amplitude, 0\ntau = t_step[np.argmax(y_step >= 0.5 * y_step[-1])]",
        "measured to 50 %",
        never="the delay is in it",
    ),
    Try(
        MSE,
        "norm over N",
        "y_approx = first_order_response(t_step, K, tau, td, amplitude)\n"
        "mse_approx = np.linalg.norm(y_step - y_approx) / len(y_step)",
        "norm of the error over N",
    ),
    Try(
        MSE,
        "over the root of N",
        "y_approx = first_order_response(t_step, K, tau, td, amplitude)\n"
        "mse_approx = np.sum((y_step - y_approx) ** 2) / np.sqrt(len(y_step))",
        "over the root of N",
    ),
    Try(
        LOSS,
        "E E'",
        fun("loss", A, "E = (Y - Phi @ theta).reshape(-1, 1)\n    return 0.5 * E @ E.T"),
        "the table 1/2 E E'",
    ),
    Try(GRAD, "Phi Y", fun("gradient", A, "return Phi.T @ Phi @ theta - Phi @ Y"), "multiplies Y by Phi;"),
    Try(
        GRAD,
        "Phi E",
        fun("gradient", A, "return Phi @ (Phi @ theta - Y)"),
        "by Phi itself.*should be multiplied by its transpose",
        never="multiplies Y by Phi;",
    ),
    Try(MIN, "Y without Phi'", fun("best_theta", "Phi, Y", "return np.linalg.inv(Phi.T @ Phi) @ Y"), "by Y itself"),
    Try(
        MIN,
        "Phi for Phi'",
        fun("best_theta", "Phi, Y", "return np.linalg.inv(Phi.T @ Phi) @ Phi @ Y"),
        "multiplies Y by Phi;",
        never="by Y itself",
    ),
    Try(
        FUN,
        "half for 63.2 %",
        reader().replace("way >= 0.632", "way >= 0.5"),
        "at the right time, and 63.2 % .* too early",
        VAGUE,
        never="33.3 %",
    ),
    Try(GRAD, "Phi Phi'", fun("gradient", A, "return Phi @ Phi.T @ theta - Phi.T @ Y"), "Phi Phi', N by N"),
    Try(MSE, "absolute", mse("np.mean(abs(y_step - y_approx))"), r"mean of the errors, or of \|error\|"),
    Try(MSE, "square of the mean", mse("np.mean(y_step - y_approx)**2"), "square of the mean error"),
    Try(MSE, "half", mse("np.mean((y_step - y_approx)**2) / 2"), "factor 1/2"),
    Try(CUT, "mean of the step", cut("np.mean(y_act[first:second])"), "not the mean over the step", never="t_held"),
    Try(
        CUT,
        "up to the end, against the numbers of the samples",
        cut("np.mean(y_act[:first])")
        .replace("first:second", "first:")
        .replace("t_act[first:] - t_act[first]", "np.arange(len(t_act) - first)"),
        "extends to the end of the record",
        never="same wrong cut",
    ),
    Try(
        CUT,
        "from the start",
        cut()
        .replace("y_act[first:second] -", "y_act[:second] -")
        .replace("t_act[first:second] - t_act[first]", "t_act[:second]"),
        "start at the first change",
    ),
    Try(
        CUT,
        "the period before",
        cut("np.mean(y_act[:first])")
        .replace("y_act[first:second] -", "y_act[:first] -")
        .replace("t_act[first:second] - t_act[first]", "t_act[:first]"),
        r"the step comes after it\. `t_held` has the same wrong cut",
    ),
    Try(
        CUT,
        "up to the end",
        cut("np.mean(y_act[:first])").replace("first:second", "first:"),
        r"extends to the end of the record.*`t_held` has the same wrong cut",
    ),
    Try(ERR, "absolute", fun("error_vector", A, "return np.abs(Y - Phi @ theta)"), "keep their signs"),
    Try(MIN, "minus", fun("best_theta", "Phi, Y", "return -np.linalg.solve(Phi.T @ Phi, Phi.T @ Y)"), "wrong sign"),
    Try(RESP, "no K", response("amplitude * (1 - np.exp(-np.maximum(t - td, 0) / tau))"), "does not depend on K"),
    Try(RESP, "grows", response("K * amplitude * (1 - np.exp(np.maximum(t - td, 0) / tau))"), "exponent is negative"),
    Try(RESP, "tau + td", response("K * amplitude * (1 - np.exp(-t / (tau + td)))"), r"tau \+ td in the exponent"),
    Try(RESP, "no tau", response("K * amplitude * (1 - np.exp(-np.maximum(t - td, 0)))"), "does not use tau"),
    Try(RESP, "a step", response("np.where(t >= td, K * amplitude, 0)"), "jumps to its end"),
    Try(
        RESP,
        "sample td",
        response("K * amplitude * (1 - np.exp(-np.maximum(t - t[round(td)], 0) / tau))"),
        "uses td as a number of samples",
    ),
    Try(RESP, "t + td", response("K * amplitude * (1 - np.exp(-(t + td) / tau))"), "starts before the step"),
    Try(UNI, "MATLAB rank", fun("is_unique", "Phi", "return np.rank(Phi) == Phi.shape[1]"), "linalg.matrix_rank"),
    Try(
        UNI, "shape called", fun("is_unique", "Phi", "return Phi.shape(1) == 2"), "takes no round brackets: `Phi.shape`"
    ),
)
