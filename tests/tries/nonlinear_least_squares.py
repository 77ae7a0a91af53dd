"""First tries at the nonlinear lecture."""

from tries import ACCEPTED, Try

LOG, JAC, GN, LM, EXP, FREQ, LOC, LAY, STEP, OE = (
    "nl-1-logarithm", "nl-2-jacobian", "nl-3-gauss-newton", "nl-4-damping", "nl-5-exponential", "nl-6-frequency",
    "nl-7-locate", "nl-7-layout", "nl-8-step", "nl-9-output-error",
)  # fmt: skip


def f(head: str, body: str) -> str:
    return f"def {head}:\n    {body}\n"


def logarithm(y: str = "np.log(y)", end: str = "a, np.exp(c)", H: str = "x, np.ones(len(x))") -> str:
    return f("fit_logarithm(x, y)", f"a, c = np.linalg.lstsq(np.column_stack([{H}]), {y})[0]\n    return {end}")


def jac(J: str = "[b * x * g, g]", grad: str = "-2 * J.T @ e") -> str:
    return f("exp_jacobian(x, theta)", f"a, b = theta\n    g = np.exp(a * x)\n    return np.column_stack({J})") + f(
        "sse_gradient(x, y, theta)",
        f"a, b = theta\n    g = np.exp(a * x)\n    J = np.column_stack([b * x * g, g])\n    e = y "
        f"- b * g\n    return {grad}",
    )


def gn(
    step: str = "np.linalg.lstsq(J, e)[0]",
    move: str = "theta = theta + s",
    e: str = "y - g(theta)",
    end: str = "np.array(path)",
) -> str:
    return f(
        "gauss_newton(g, jacobian, y, theta0, steps)",
        f"theta = np.array(theta0, float)\n    path = [theta]\n    for _ in range(steps):\n        "
        f"e = {e}\n        J = jacobian(theta)\n        s = {step}\n        {move}\n        "
        f"path.append(theta)\n    return {end}",
    )


def lm(left: str = "JJ + mu * np.diag(np.diag(JJ))", test: str = "t @ t < e @ e", after: str = "mu = mu * 10") -> str:
    return f("damped_step(J, e, mu)", f"JJ = J.T @ J\n    return np.linalg.solve({left}, J.T @ e)") + f(
        "levenberg_marquardt(g, jacobian, y, theta0)",
        "theta, mu = np.array(theta0, float), 1e-3\n    for _ in range(500):\n        e = y - "
        "g(theta)\n"
        f"        s = damped_step(jacobian(theta), e, mu)\n        t = y - g(theta + s)\n        "
        f"if {test}:\n            theta, mu = theta + s, mu / 10\n        else:\n            "
        f"{after}\n"
        "        if np.max(np.abs(s)) < 1e-12 * (1 + np.max(np.abs(theta))):\n            break\n    return theta",
    )


GIVEN = (
    "x_s = np.array([1, 0.5, -2, 3, 2.5])\ny_s = np.array([1.4, 1.2, -3.6, 6.8, "
    "4.5])\ntheta_log = np.polyfit(x_s[y_s > 0], np.log(y_s[y_s > 0]), 1)\n"
    "theta_log[1] = np.exp(theta_log[1])\ngrid = np.linspace(-2.2, 3.2, 109)\n"
)


def exp(body: str, points: str = "'o'") -> str:
    return (
        GIVEN
        + f("fit_exponential(x, y)", body)
        + "\ntheta_exp = fit_exponential(x_s, y_s)\nfig_exp, ax = plt.subplots()\n"
        f"ax.plot(x_s, y_s, {points}, label='data')\nax.plot(grid, theta_exp[1] * "
        f"np.exp(theta_exp[0] * grid), label='fit')\n"
        "ax.plot(grid, theta_log[1] * np.exp(theta_log[0] * grid), "
        "label='log')\nax.set(xlabel='x', ylabel='y')\nax.legend()"
    )


FIT = "return scipy.optimize.least_squares(lambda th: th[1] * np.exp(th[0] * x) - y, [0.0, 1.0])"


def step(
    s2: str = "2 * fit.cost / (len(y) - 3)",
    cov: str = "np.sqrt(np.diag(s2 * np.linalg.inv(fit.jac.T @ fit.jac)))",
    model: str = "th[0] + th[1] * amplitude * (1 - np.exp(-t / th[2]))",
    end: str = "fit.x, sd",
) -> str:
    return f(
        "fit_step(t, y, amplitude)",
        f"fit = scipy.optimize.least_squares(lambda th: {model} - y, [y[0], (y[-1] - y[0]) / "
        f"amplitude, t[-1] / 5])\n    s2 = {s2}\n    sd = {cov}\n    return {end}",
    )


TRIES = (
    Try(LOG, "log10", logarithm("np.log10(y)"), "mixes bases"),
    Try(LOG, "c", logarithm(end="a, c"), "still a logarithm"),
    Try(LOG, "no logarithm", logarithm("y"), "logarithm of y first"),
    Try(LOG, "order", logarithm(end="np.exp(c), a"), "b before a"),
    Try(
        LOG,
        "no ones",
        f("fit_logarithm(x, y)", "a = np.linalg.lstsq(x.reshape(-1, 1), np.log(y))[0]\n    return a, 1.0"),
        "no column of ones",
    ),
    Try(LOG, "ln", logarithm("np.ln(y)"), "natural logarithm is"),
    Try(JAC, "no x", jac("[b * g, g]"), "lacks the factor x"),
    Try(JAC, "no b", jac("[x * g, g]"), "lacks the factor b"),
    Try(JAC, "order", jac("[g, b * x * g]"), "b's column first"),
    Try(JAC, "wrt x", jac("[a * b * g, g]"), "slope along x"),
    Try(JAC, "sign", jac(grad="2 * J.T @ e"), "other sign"),
    Try(JAC, "no 2", jac(grad="-J.T @ e"), "half the gradient"),
    Try(JAC, "J @ e", jac(grad="-2 * J @ e"), "columns and the second"),
    Try(GN, "sign", gn(e="g(theta) - y"), "wrong way"),
    Try(GN, "gradient", gn("J.T @ e"), "\\(J'J\\)\\^-1 is missing"),
    Try(GN, "in place", gn(move="theta += s"), "theta = theta \\+ step"),
    Try(GN, "last", gn(end="theta"), "last theta only"),
    Try(GN, "g not called", gn(e="y - g"), "call it"),
    Try(GN, "jacobian of the start", gn().replace("jacobian(theta)", "jacobian(theta0)"), "Jacobian of the start"),
    Try(LM, "identity", lm("JJ + mu * np.eye(len(JJ))"), "Levenberg's way"),
    Try(LM, "np.diag once", lm("JJ + mu * np.diag(JJ)"), "zeros off its diagonal"),
    Try(LM, "mu added", lm("JJ + mu"), "every entry"),
    Try(LM, "no mu", lm("JJ"), "does not use mu"),
    Try(
        LM,
        "always taken",
        lm(test="True"),
        "single number, and it is zero|larger must not be taken|ends higher|range of numbers|stops before",
    ),
    Try(LM, "break at a bad step", lm(after="break"), "first bad|stays at theta0|stops before"),
    Try(EXP, "all of it", exp(FIT), "`.x` is the solution"),
    Try(
        EXP,
        "logarithm",
        exp("c = np.polyfit(x, np.log(y), 1)\n    return np.array([c[0], np.exp(c[1])])"),
        "nan where one y is negative, and numbers where that y is 0.1: it takes a logarithm",
    ),
    Try(
        EXP,
        "positive only",
        exp("k = y > 0\n    " + FIT.replace("* x)", "* x[k])").replace("- y,", "- y[k],") + ".x"),
        "negative y",
    ),
    Try(EXP, "order", exp(FIT + ".x[::-1]"), "b before a"),
    Try(EXP, "joined points", exp(FIT + ".x", "'-o'"), "circles alone"),
    Try(
        FREQ,
        "all three",
        f(
            "fit_frequency(t, y, low, high)",
            "e = lambda th: th[1] * np.sin(th[0] * t) + th[2] * np.cos(th[0] * t) - y\n    return "
            "scipy.optimize.least_squares(e, [(low + high) / 2, 1, 1]).x",
        ),
        "frequency alone",
    ),
    Try(
        FREQ,
        "one start",
        f(
            "fit_frequency(t, y, low, high)",
            "e = lambda th: th[1] * np.sin(th[0] * t) + th[2] * np.cos(th[0] * t) - y\n    return "
            "scipy.optimize.least_squares(e, [(low + high) / 2, 1, 1]).x[0]",
        ),
        "local minimum",
    ),
    Try(
        FREQ,
        "fft in Hz",
        f(
            "fit_frequency(t, y, low, high)",
            "f = np.fft.rfftfreq(len(t), t[1] - t[0])\n    return f[np.argmax(abs(np.fft.rfft(y)))]",
        ),
        "returns Hz",
    ),
    Try(
        LOC,
        "squares",
        f(
            "locate(beacons, ranges)",
            "A = np.column_stack([-2 * beacons, np.ones(len(ranges))])\n    return np.linalg.lstsq(A, "
            "ranges**2 - np.sum(beacons**2, axis=1))[0][:2]",
        ),
        "\\*squared\\* ranges.*good start for `scipy",
    ),
    Try(
        LOC,
        "one start",
        f(
            "locate(beacons, ranges)",
            "e = lambda th: np.linalg.norm(beacons - th, axis=1) - ranges\n    return "
            "scipy.optimize.least_squares(e, beacons.mean(axis=0) + [0, 1]).x",
        ),
        "wrong side of the line along which the beacons lie",
    ),
    Try(
        LOC,
        "no axis",
        f(
            "locate(beacons, ranges)",
            "e = lambda th: np.linalg.norm(beacons - th) - ranges\n    return "
            "scipy.optimize.least_squares(e, beacons.mean(axis=0)).x",
        ),
        "one error, for each beacon",
    ),
    Try(
        LOC,
        "whole result",
        f(
            "locate(beacons, ranges)",
            "e = lambda th: np.linalg.norm(beacons - th, axis=1) - ranges\n    return "
            "scipy.optimize.least_squares(e, beacons.mean(axis=0))",
        ),
        "`.x`",
    ),
    Try(
        LAY,
        "counted",
        f("layout(beacons)", "return ['undetermined', 'mirror', 'unique'][min(len(beacons) - 1, 2)]"),
        "counts the beacons",
    ),
    Try(
        LAY,
        "not centred",
        f("layout(beacons)", "return ['undetermined', 'mirror', 'unique'][np.linalg.matrix_rank(beacons, tol=1e-9)]"),
        "subtract one beacon",
    ),
    Try(LAY, "number", f("layout(beacons)", "return np.linalg.matrix_rank(beacons - beacons[0])"), "one of the texts"),
    Try(STEP, "cost", step("fit.cost / (len(y) - 3)"), "half\\* the SSE"),
    Try(STEP, "n", step("2 * fit.cost / len(y)"), "by n"),
    Try(STEP, "variances", step(cov="np.diag(s2 * np.linalg.inv(fit.jac.T @ fit.jac))"), "take their roots"),
    Try(STEP, "no amplitude", step(model="th[0] + th[1] * (1 - np.exp(-t / th[2]))"), "amplitude out"),
    Try(STEP, "theta only", step(end="fit.x"), "theta and its standard errors"),
    Try(STEP, "rate", step(model="th[0] + th[1] * amplitude * (1 - np.exp(-t * th[2]))"), "is a rate|smallest SSE"),
    Try(
        OE,
        "one step",
        f("fit_output_error(u, y)", "return np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1]]), y[1:])[0]"),
        "one-step fit",
    ),
    Try(
        OE,
        "sign",
        f(
            "fit_output_error(u, y)",
            "e = lambda th: scipy.signal.lfilter([0, th[1]], [1, -th[0]], u) - y\n    return "
            "scipy.optimize.least_squares(e, [0.5, 1]).x",
        ),
        "other sign of a",
    ),
    Try(
        OE,
        "at once",
        f(
            "fit_output_error(u, y)",
            "e = lambda th: scipy.signal.lfilter([th[1]], [1, th[0]], u) - y\n    return "
            "scipy.optimize.least_squares(e, [-0.5, 1]).x",
        ),
        "act at once",
    ),
    Try(
        OE,
        "squares handed over",
        f(
            "fit_output_error(u, y)",
            "e = lambda th: np.sum((scipy.signal.lfilter([0, th[1]], [1, th[0]], u) - y)**2)\n    "
            "return scipy.optimize.least_squares(e, [-0.5, 1]).x",
        ),
        "nearest to y|SSE",
    ),
    Try(
        OE,
        "all of it",
        f(
            "fit_output_error(u, y)",
            "e = lambda th: scipy.signal.lfilter([0, th[1]], [1, th[0]], u) - y\n    return "
            "scipy.optimize.least_squares(e, [-0.5, 1])",
        ),
        "`.x`",
    ),
    Try(
        LOG, "log of x", f("fit_logarithm(x, y)", "return np.polyfit(np.log(x), np.log(y), 1)"), "a nan or an inf in it"
    ),
    Try(LOG, "e^a", logarithm(end="np.exp(a), np.exp(c)"), "a of `fit_logarithm` is e\\^a"),
    Try(LOG, "x over ln y", logarithm("x", H="np.log(y), np.ones(len(y))"), "fits x to ln y"),
    Try(JAC, "b, a", jac().replace("a, b = theta", "b, a = theta"), "in the order b, a"),
    Try(JAC, "SSE for its gradient", jac(grad="e @ e"), "the SSE itself"),
    Try(
        EXP,
        "squares handed over",
        exp(FIT.replace("th[1] * np.exp(th[0] * x) - y", "np.sum((th[1] * np.exp(th[0] * x) - y)**2)") + ".x"),
        r"the \*sum\* of the squared errors",
        never=r"the \*squared\* errors",
    ),
    Try(
        FREQ,
        "index",
        f("fit_frequency(t, y, low, high)", "return np.argmin(np.abs(np.linspace(low, high, 5000) - 2.7)) + 50"),
        "\\*index\\* of the smallest",
    ),
    Try(
        LOC,
        "one norm for all",
        f(
            "locate(beacons, ranges)",
            "e = lambda p: np.linalg.norm(beacons - p) - ranges\n"
            "    return scipy.optimize.least_squares(e, beacons.mean(axis=0)).x",
        ),
        "one error, for each beacon",
    ),
    Try(STEP, "covariance", step(cov="s2 * np.linalg.inv(fit.jac.T @ fit.jac)"), "returns the covariance"),
    Try(STEP, "1.96", step(cov="1.96 * np.sqrt(np.diag(s2 * np.linalg.inv(fit.jac.T @ fit.jac)))"), "half widths"),
    Try(
        EXP,
        "squares handed over",
        exp("return scipy.optimize.least_squares(lambda th: (th[1] * np.exp(th[0] * x) - y) ** 2, [0.0, 1.0]).x"),
        r"the \*squared\* errors",
    ),
    Try(
        EXP,
        "absolute errors handed over",
        exp("return scipy.optimize.least_squares(lambda th: abs(th[1] * np.exp(th[0] * x) - y), [0.0, 1.0]).x"),
        "",
        ACCEPTED,
    ),
    Try(
        STEP,
        "y0 left out",
        f(
            "fit_step(t, y, amplitude)",
            "fit = scipy.optimize.least_squares(lambda th: th[0] * amplitude * (1 - np.exp(-t / th[1])) - y, "
            "[y[-1] / amplitude, t[-1] / 5])\n"
            "    return fit.x, np.sqrt(np.diag(2 * fit.cost / len(y) * np.linalg.inv(fit.jac.T @ fit.jac)))",
        ),
        "when it lacks one",
    ),
    Try(
        STEP,
        "J J'",
        step(cov="np.sqrt(np.diag(s2 * np.linalg.inv(fit.jac @ fit.jac.T)))"),
        "holds nan",
        never="lack one",
    ),
    Try(
        LOG,
        "parabola",
        f("fit_logarithm(x, y)", "c = np.polyfit(x, np.log(y), 2)\n    return c[0], np.exp(c[1])"),
        "fits a parabola",
    ),
    Try(
        LOC,
        "squares handed over",
        f(
            "locate(beacons, ranges)",
            "c, r = beacons.mean(axis=0), ranges.mean()\n"
            "    starts = [c + r * np.array([np.cos(v), np.sin(v)]) for v in np.arange(8)]\n"
            "    e = lambda th: (np.linalg.norm(beacons - th, axis=1) - ranges) ** 2\n"
            "    fits = [scipy.optimize.least_squares(e, s, xtol=1e-12, ftol=1e-12, gtol=1e-12) for s in starts]\n"
            "    return min(fits, key=lambda fit: fit.cost).x",
        ),
        r"the \*squared\* errors",
    ),
    Try(
        EXP,
        "a and b swapped in the figure",
        exp(FIT + ".x").replace("theta_exp[1] * np.exp(theta_exp[0] *", "theta_exp[0] * np.exp(theta_exp[1] *"),
        "`theta_exp` has a and b swapped",
    ),
    Try(LM, "mu D alone", lm("mu * np.diag(np.diag(JJ))"), "leaves J'J itself out"),
    Try(GN, "path not returned", gn().replace("return np", "np"), "a function without `return` gives that"),
    Try(LM, "theta not returned", lm().replace("    return theta", "    theta"), "returns nothing"),
    Try(GN, "a start of its own", gn().replace("np.array(theta0, float)", "np.ones(len(theta0))"), "is not theta0"),
    Try(
        LOC,
        "second coordinate first",
        f(
            "locate(beacons, ranges)",
            "c, r = beacons.mean(axis=0), ranges.mean()\n"
            "    fits = [scipy.optimize.least_squares(lambda th: np.linalg.norm(beacons - th, axis=1) - ranges,\n"
            "            c + r * np.array([np.cos(v), np.sin(v)])) for v in np.arange(8) * np.pi / 4]\n"
            "    return min(fits, key=lambda fit: fit.cost).x[::-1]",
        ),
        "second coordinate first",
    ),
    Try(STEP, "per theta", step(end="fit.x, sd / fit.x"), "relative errors"),
    Try(STEP, "per size of theta", step(end="fit.x, sd / abs(fit.x)"), "relative errors"),
)
