"""Answers to the nonlinear lecture that differ from the model solution, right ones and wrong ones."""

from variants import Right, Wrong, define, right, wrong

LOGARITHM, JACOBIAN, NEWTON, DAMPING = "nl-1-logarithm", "nl-2-jacobian", "nl-3-gauss-newton", "nl-4-damping"
EXPONENTIAL, FREQUENCY, LOCATE, LAYOUT = "nl-5-exponential", "nl-6-frequency", "nl-7-locate", "nl-7-layout"
STEP, OUTPUT = "nl-8-step", "nl-9-output-error"


def logarithm(result: str = "a, np.exp(c)", line: str = "np.polyfit(x, np.log(y), 1)") -> str:
    return define("fit_logarithm(x, y)", f"a, c = {line}\nreturn {result}")


def derivatives(
    jacobian: str = "np.column_stack([b * x * np.exp(a * x), np.exp(a * x)])", gradient: str = "-2 * J.T @ e"
) -> str:
    return define("exp_jacobian(x, theta)", f"a, b = theta\nreturn {jacobian}") + define(
        "sse_gradient(x, y, theta)",
        "a, b = theta\ne = y - b * np.exp(a * x)\nJ = np.column_stack([b * x * np.exp(a * x), np.exp(a * x)])\n"
        f"return {gradient}",
    )


def newton(
    step: str = "np.linalg.lstsq(J, e)[0]",
    e: str = "y - g(theta)",
    at: str = "theta",
    move: str = "theta = theta + s",
    path: str = "[theta]",
    result: str = "np.array(path)",
    steps: str = "range(steps)",
) -> str:
    return define(
        "gauss_newton(g, jacobian, y, theta0, steps)",
        f"theta = np.array(theta0, float)\npath = {path}\nfor _ in {steps}:\n    e = {e}\n    J = jacobian({at})\n"
        f"    s = {step}\n    {move}\n    path.append(theta)\nreturn {result}",
    )


STEP_OF = "np.linalg.solve(JJ + mu * np.diag(np.diag(JJ)), J.T @ e)"
TAKE_OR_REFUSE = (
    "if np.sum((y - g(theta + s)) ** 2) < e @ e:\n        theta, mu = theta + s, mu / 3\n    else:\n        mu = mu * 2"
)


def damping(
    step: str = STEP_OF,
    decide: str = TAKE_OR_REFUSE,
    trials: str = "3000",
    call: str = "damped_step(jacobian(theta), e, mu)",
    result: str = "theta",
    mu: str = "1.0",
) -> str:
    return define("damped_step(J, e, mu)", f"JJ = J.T @ J\nreturn {step}") + define(
        "levenberg_marquardt(g, jacobian, y, theta0)",
        f"theta, mu = np.array(theta0, float), {mu}\nfor _ in range({trials}):\n    e = y - g(theta)\n    s = {call}\n"
        f"    {decide}\nreturn {result}",
    )


LEVENBERG = "np.linalg.solve(J.T @ J + mu * np.eye(theta.size), J.T @ e)"

POINTS = "ax.plot(x_s, y_s, 'o', label='Data')"
FIRST = "ax.plot(grid, theta_exp[1] * np.exp(theta_exp[0] * grid), label='Nonlinear')"
SECOND = "ax.plot(grid, theta_log[1] * np.exp(theta_log[0] * grid), label='Logarithm')"
REST = "ax.legend()\nax.set_xlabel('x')\nax.set_ylabel('y')"
FIT = "scipy.optimize.least_squares(lambda th: th[1] * np.exp(th[0] * x) - y, [0.0, 1.0]).x"


def exponential(
    result: str = FIT,
    first: str = FIRST,
    second: str = SECOND,
    points: str = POINTS,
    rest: str = REST,
    used: str = "theta_exp = fit_exponential(x_s, y_s)",
    before: str = "",
) -> str:
    return (
        "x_s = np.array([1, 0.5, -2, 3, 2.5])\ny_s = np.array([1.4, 1.2, -3.6, 6.8, 4.5])\n"
        "theta_log = np.polyfit(x_s[y_s > 0], np.log(y_s[y_s > 0]), 1)\ntheta_log[1] = np.exp(theta_log[1])\n"
        "grid = np.linspace(-2.2, 3.2, 109)\n"
        + define("fit_exponential(x, y)", f"{before}return {result}")
        + f"{used}\nfig_exp, ax = plt.subplots()\n{points}\n{first}\n{second}\n{rest}\n"
    )


def frequency(
    grid: str = "np.linspace(low, high, 300)",
    result: str = "refined.x[0]",
    H: str = "[np.sin(w * t), np.cos(w * t)]",
    start: str = "w",
) -> str:
    return define(
        "fit_frequency(t, y, low, high)",
        "def sse(w):\n"
        f"    H = np.column_stack({H})\n"
        "    return np.sum((y - H @ np.linalg.lstsq(H, y)[0]) ** 2)\n"
        f"grid = {grid}\nw = grid[np.argmin([sse(w) for w in grid])]\n"
        "H = np.column_stack([np.sin(w * t), np.cos(w * t)])\nAB = np.linalg.lstsq(H, y)[0]\n"
        "def errors(th):\n    return th[1] * np.sin(th[0] * t) + th[2] * np.cos(th[0] * t) - y\n"
        f"refined = scipy.optimize.least_squares(errors, [{start}, *AB])\nreturn {result}",
    )


def locate(body: str) -> str:
    return define(
        "locate(beacons, ranges)",
        "def errors(theta):\n    return np.linalg.norm(beacons - theta, axis=1) - ranges\n"
        "fit = scipy.optimize.least_squares\ncentre = beacons.mean(axis=0)\n" + body,
    )


LINEAR = (
    "H = np.column_stack([-2 * beacons, np.ones(len(ranges))])\n"
    "linear = np.linalg.lstsq(H, ranges**2 - np.sum(beacons**2, axis=1))[0][:2]\n"
)


def layout(rank: str, before: str = "") -> str:
    return define("layout(beacons)", f"{before}return ['undetermined', 'mirror', 'unique'][{rank}]")


def step(
    theta: str = "fit.x",
    stderr: str = "np.sqrt(np.diag(s2 * np.linalg.inv(fit.jac.T @ fit.jac)))",
    s2: str = "np.sum(fit.fun**2) / (len(y) - 3)",
    model: str = "th[0] + th[1] * amplitude * (1 - np.exp(-t / th[2]))",
    start: str = "[y[0], (y[-1] - y[0]) / amplitude, t[-1] / 4]",
    result: str = "theta, stderr",
) -> str:
    return define(
        "fit_step(t, y, amplitude)",
        f"fit = scipy.optimize.least_squares(lambda th: {model} - y, {start}, xtol=1e-12, ftol=1e-12)\ns2 = {s2}\n"
        f"theta = {theta}\nstderr = {stderr}\nreturn {result}",
    )


def output_error(
    run: str = "scipy.signal.lfilter([0, th[1]], [1, th[0]], u)", result: str = "fit.x", start: str = "[-0.5, 0.5]"
) -> str:
    return define(
        "fit_output_error(u, y)",
        f"fit = scipy.optimize.least_squares(lambda th: {run} - y, {start})\nreturn {result}",
    )


LOOP = define(
    "run(theta, u)",
    "x = np.zeros(len(u))\nfor k in range(1, len(u)):\n    x[k] = -theta[0] * x[k - 1] + theta[1] * u[k - 1]\nreturn x",
)
ARX = "Phi = np.column_stack([-y[:-1], u[:-1]])\nreturn np.linalg.lstsq(Phi, y[1:])[0]"

VARIANTS: list[Right | Wrong] = [
    # 1. through the logarithm
    right(LOGARITHM, "polyfit", logarithm()),
    right(LOGARITHM, "base 10 throughout", logarithm("a * np.log(10), 10**c", "np.polyfit(x, np.log10(y), 1)")),
    right(LOGARITHM, "an array", logarithm("np.array([[a], [np.exp(c)]])")),
    wrong(LOGARITHM, "swapped", logarithm("np.exp(c), a"), "a and b swapped", "before"),
    wrong(LOGARITHM, "c for b", logarithm("a, c"), "b left as a logarithm", "e\\^c"),
    wrong(
        LOGARITHM, "log10 and exp", logarithm(line="np.polyfit(x, np.log10(y), 1)"), "logarithm to base 10", "natural"
    ),
    wrong(
        LOGARITHM,
        "log10 and 10**c",
        logarithm("a, 10**c", "np.polyfit(x, np.log10(y), 1)"),
        "logarithm to base 10",
        "power of ten",
    ),
    wrong(LOGARITHM, "no logarithm", logarithm("a, c", "np.polyfit(x, y, 1)"), "no logarithm taken", "y itself"),
    wrong(
        LOGARITHM,
        "no column of ones",
        logarithm(line="x @ np.log(y) / (x @ x), 0.0"),
        "line through the origin",
        "ones",
    ),
    wrong(
        LOGARITHM,
        "the curve itself",
        define(
            "fit_logarithm(x, y)",
            "start = np.polyfit(x, np.log(y), 1)\n"
            "return scipy.optimize.curve_fit(lambda x, a, b: b * np.exp(a * x), x, y, [start[0], np.exp(start[1])])[0]",
        ),
        "the other method",
        "line to the logarithms",
    ),
    # 2. the Jacobian and the gradient
    right(JACOBIAN, "transposed rows", derivatives("np.array([b * x * np.exp(a * x), np.exp(a * x)]).T")),
    right(
        JACOBIAN,
        "differences",
        derivatives(
            "np.column_stack([(b * np.exp((a + 1e-6) * x) - b * np.exp((a - 1e-6) * x)) / 2e-6, np.exp(a * x)])",
            "[-2 * np.sum(e * b * x * np.exp(a * x)), -2 * np.sum(e * np.exp(a * x))]",
        ),
    ),
    wrong(
        JACOBIAN,
        "columns swapped",
        derivatives("np.column_stack([np.exp(a * x), b * x * np.exp(a * x)])"),
        "columns swapped",
        "first",
    ),
    wrong(
        JACOBIAN,
        "x missing",
        derivatives("np.column_stack([b * np.exp(a * x), np.exp(a * x)])"),
        "factor x missing",
        "brings x",
    ),
    wrong(
        JACOBIAN,
        "b missing",
        derivatives("np.column_stack([x * np.exp(a * x), np.exp(a * x)])"),
        "factor b missing",
        "factor b",
    ),
    wrong(
        JACOBIAN,
        "slope along x",
        derivatives("np.column_stack([a * b * np.exp(a * x), np.exp(a * x)])"),
        "differentiated with respect to x",
        "slope along x",
    ),
    wrong(
        JACOBIAN,
        "b kept",
        derivatives("np.column_stack([b * x * np.exp(a * x), b * np.exp(a * x)])"),
        "b left in its own column",
        "linear in b",
    ),
    wrong(
        JACOBIAN,
        "of the error",
        derivatives("-np.column_stack([b * x * np.exp(a * x), np.exp(a * x)])"),
        "Jacobian of the error",
        "error y - g",
    ),
    wrong(
        JACOBIAN,
        "on its side",
        derivatives("np.array([b * x * np.exp(a * x), np.exp(a * x)])"),
        "rows instead of columns",
        "transpose it",
    ),
    wrong(JACOBIAN, "no 2", derivatives(gradient="-J.T @ e"), "factor 2 missing", "half"),
    wrong(JACOBIAN, "uphill", derivatives(gradient="2 * J.T @ e"), "uphill and downhill swapped", "sign"),
    wrong(JACOBIAN, "mean", derivatives(gradient="-2 * J.T @ e / len(x)"), "a mean in place of the sum", "number"),
    wrong(JACOBIAN, "y for e", derivatives(gradient="-2 * J.T @ y"), "y in place of the error", "by y"),
    wrong(JACOBIAN, "rubbish", derivatives(gradient="J.T @ e * 3"), None, "-2 J'e"),
    # 3. Gauss-Newton
    right(NEWTON, "normal equations", newton("np.linalg.inv(J.T @ J) @ J.T @ e")),
    right(NEWTON, "errors the other way round", newton("-np.linalg.pinv(J) @ e", "g(theta) - y")),
    right(
        NEWTON,
        "rows of an array",
        define(
            "gauss_newton(g, jacobian, y, theta0, steps)",
            "path = np.zeros((steps + 1, len(theta0)))\npath[0] = theta0\nfor i in range(steps):\n"
            "    J = jacobian(path[i])\n"
            "    path[i + 1] = path[i] + np.linalg.solve(J.T @ J, J.T @ (y - g(path[i])))\nreturn path",
        ),
    ),
    wrong(NEWTON, "minus", newton(move="theta = theta - s"), "step in the wrong direction", "wrong way"),
    wrong(NEWTON, "g - y", newton(e="g(theta) - y"), "step in the wrong direction", "wrong way"),
    wrong(NEWTON, "J'e", newton("J.T @ e"), "step down the gradient", "missing"),
    wrong(NEWTON, "frozen Jacobian", newton(at="theta0"), "Jacobian of the start throughout", "anew"),
    wrong(NEWTON, "2", newton("2 * np.linalg.lstsq(J, e)[0]"), "step twice as long", "cancel"),
    wrong(NEWTON, "half", newton("0.5 * np.linalg.lstsq(J, e)[0]"), "step twice too short", "cancel"),
    wrong(NEWTON, "y", newton(e="y"), "y in place of the error", "what is left"),
    wrong(NEWTON, "start missing", newton(path="[]"), "start left out of the path", "theta0"),
    wrong(NEWTON, "last only", newton(result="theta"), "last theta only", "path"),
    wrong(NEWTON, "one too few", newton(steps="range(steps - 1)"), "number of steps", "steps \\+ 1"),
    wrong(NEWTON, "in place", newton(move="theta += s"), "the same array in every row", "already in the list"),
    wrong(NEWTON, "transposed", newton("np.linalg.lstsq(J.T, e)[0]"), None, "stopped with"),
    # 4. damping
    right(DAMPING, "other factors", damping()),
    right(
        DAMPING,
        "rows below J, inner loop",
        define(
            "damped_step(J, e, mu)",
            "D = np.sqrt(mu) * np.diag(np.sqrt(np.sum(J**2, axis=0)))\n"
            "return np.linalg.lstsq(np.vstack([J, D]), np.r_[e, np.zeros(len(D))])[0]",
        )
        + define(
            "levenberg_marquardt(g, jacobian, y, theta0)",
            "theta, mu = np.array(theta0, float), 1e-3\nfor _ in range(100):\n    e = y - g(theta)\n"
            "    J = jacobian(theta)\n"
            "    for _ in range(40):\n        s = damped_step(J, e, mu)\n"
            "        if np.sum((y - g(theta + s)) ** 2) < e @ e:\n            theta = theta + s\n            mu /= 5\n"
            "            break\n        mu *= 5\n    else:\n        break\nreturn theta",
        ),
    ),
    right(
        DAMPING,
        "scipy inside",
        damping(decide="theta = scipy.optimize.least_squares(lambda th: g(th) - y, theta).x", trials="1"),
    ),
    wrong(
        DAMPING,
        "identity",
        damping("np.linalg.solve(JJ + mu * np.eye(len(JJ)), J.T @ e)"),
        "identity in place of D",
        "Marquardt",
    ),
    wrong(DAMPING, "mu not used", damping("np.linalg.solve(JJ, J.T @ e)"), "mu not used", "whole step"),
    wrong(DAMPING, "all of J'J", damping("np.linalg.solve((1 + mu) * JJ, J.T @ e)"), "all of J'J enlarged", "1 \\+ mu"),
    wrong(
        DAMPING,
        "vector",
        damping("np.linalg.solve(JJ + mu * np.diag(JJ), J.T @ e)"),
        "number added to every entry",
        "matrix",
    ),
    wrong(
        DAMPING,
        "uphill",
        damping("-np.linalg.solve(JJ + mu * np.diag(np.diag(JJ)), J.T @ e)"),
        "step in the wrong direction",
        "uphill",
    ),
    wrong(
        DAMPING,
        "every step taken, mu tiny",
        damping(decide="theta = theta + s", mu="1e-9", trials="50"),
        "bad steps taken",
        "must not",
    ),
    wrong(DAMPING, "few trials", damping(trials="2"), "stops too early", "before the minimum"),
    wrong(
        DAMPING,
        "stops at the first bad step",
        damping(decide=TAKE_OR_REFUSE.replace("mu = mu * 2", "break"), mu="1e-3"),
        "ends at the first bad step",
        "mu must rise",
    ),
    wrong(
        DAMPING,
        "damping reversed",
        damping(
            decide=TAKE_OR_REFUSE.replace("mu / 3", "mu * 10").replace("mu * 2", "mu / 10"), mu="1e-3", trials="300"
        ),
        "ends at the first bad step",
        "mu must rise",
    ),
    wrong(DAMPING, "never moves", damping(decide="mu = mu * 2", trials="30"), "no step taken", "stays"),
    wrong(DAMPING, "path", damping(result="np.array([theta, theta])"), "path for theta", "path"),
    wrong(DAMPING, "squared mu", damping(STEP_OF.replace("mu *", "mu**2 *")), "mu squared", "mu D"),
    # 5. the exponential, both ways
    right(
        EXPONENTIAL,
        "curve_fit",
        exponential("scipy.optimize.curve_fit(lambda x, a, b: b * np.exp(a * x), x, y, [0.5, 1])[0]"),
    ),
    right(
        EXPONENTIAL,
        "scan over a, from the best",
        exponential(
            "scipy.optimize.least_squares(lambda th: th[1] * np.exp(th[0] * x) - y, best, method='lm').x",
            before="trials = [(a, np.exp(a * x) @ y / np.sum(np.exp(2 * a * x))) for a in np.linspace(-3, 3, 61)]\n"
            "best = min(trials, key=lambda th: np.sum((y - th[1] * np.exp(th[0] * x)) ** 2))\n",
        ),
    ),
    right(
        EXPONENTIAL,
        "Nelder-Mead, one plot call",
        exponential(
            "scipy.optimize.minimize(lambda th: np.sum((y - th[1] * np.exp(th[0] * x)) ** 2), [0, 1], "
            "method='Nelder-Mead').x",
            "ax.plot(x_s, y_s, 'kx', grid, theta_exp[1] * np.exp(theta_exp[0] * grid), grid, "
            "theta_log[1] * np.exp(theta_log[0] * grid))",
            "",
            "",
            "ax.legend(['points', 'all', 'log'])\nplt.xlabel('x')\nplt.ylabel('y')",
        ),
    ),
    wrong(EXPONENTIAL, "swapped", exponential(f"{FIT}[::-1]"), "a and b swapped", "before"),
    wrong(
        EXPONENTIAL,
        "positive points only",
        exponential(before="x, y = x[y > 0], y[y > 0]\n"),
        "negative points left out",
        "Only the logarithm",
    ),
    wrong(
        EXPONENTIAL,
        "the line again",
        exponential("np.array([a, np.exp(c)])", before="a, c = np.polyfit(x[y > 0], np.log(y[y > 0]), 1)\n"),
        "the logarithm once more",
        "curve itself",
    ),
    wrong(
        EXPONENTIAL,
        "logarithm of all",
        exponential("np.polyfit(x, np.log(y), 1)"),
        "logarithm of a negative number",
        "negative",
    ),
    wrong(EXPONENTIAL, "absolute", exponential(before="y = abs(y)\n"), "absolute values", "absolute"),
    wrong(
        EXPONENTIAL,
        "all of it",
        exponential(FIT[:-2], used="theta_exp = fit_exponential(x_s, y_s).x"),
        "all of the result",
        "\\.x",
    ),
    wrong(
        EXPONENTIAL,
        "a start far away",
        exponential(FIT.replace("[0.0, 1.0]", "[-40.0, 1e-40]")),
        None,
        "no minimum either",
    ),
    wrong(
        EXPONENTIAL,
        "a start from which all points but one are passed by",
        exponential(FIT.replace("[0.0, 1.0]", "[-20.0, 1.0]")),
        "stuck on a plateau",
        "Start elsewhere",
    ),
    wrong(EXPONENTIAL, "no points", exponential(points=""), "points missing", "five points"),
    wrong(EXPONENTIAL, "one curve only", exponential(second=""), "no curve", "theta_log"),
    wrong(
        EXPONENTIAL,
        "at the points",
        exponential(first=FIRST.replace("grid", "x_s")),
        "drawn at few points",
        "corners",
    ),
    wrong(EXPONENTIAL, "no legend", exponential(rest="ax.set_xlabel('x')\nax.set_ylabel('y')"), "no legend", "legend"),
    wrong(EXPONENTIAL, "no labels", exponential(rest="ax.legend()"), "axis without a label", "label"),
    wrong(
        EXPONENTIAL,
        "names swapped",
        exponential(first=FIRST.replace("Nonlinear", "Log"), second=SECOND.replace("Logarithm", "Curve")),
        "legend entries swapped",
        "swapped",
    ),
    # 6. the frequency
    right(FREQUENCY, "scan and refine", frequency()),
    right(FREQUENCY, "a very fine scan", frequency("np.linspace(low, high, 6000)", "w")),
    right(
        FREQUENCY,
        "iterations from many starts",
        define(
            "fit_frequency(t, y, low, high)",
            "def errors(th):\n    return th[1] * np.sin(th[0] * t + th[2]) - y\n"
            "fits = [scipy.optimize.least_squares(errors, [w, 1.5, p]) for w in np.arange(low, high, 0.15) "
            "for p in (0, 2, 4)]\nfits = [fit for fit in fits if low <= abs(fit.x[0]) <= high]\n"
            "return abs(min(fits, key=lambda fit: fit.cost).x[0])",
        ),
    ),
    wrong(FREQUENCY, "one start", frequency(start="(low + high) / 2"), "local minimum", "far away"),
    wrong(FREQUENCY, "coarse scan", frequency("np.linspace(low, high, 60)", "w"), "not refined", "finer"),
    wrong(FREQUENCY, "Hz", frequency(result="refined.x[0] / (2 * np.pi)"), "Hz for rad/s", "rad/s"),
    wrong(FREQUENCY, "all three", frequency(result="refined.x"), "all three parameters", "alone"),
    wrong(FREQUENCY, "below the low end", frequency(result="low / 2"), "outside the range", "outside"),
    *(
        wrong(
            FREQUENCY,
            f"a range of its own, {name}",
            frequency(f"np.linspace({scan}, 900)"),
            "outside the range",
            "between",
        )
        for name, scan in (("both ends", "0.3, 9"), ("low not used", "0.3, high"), ("high not used", "low, 9"))
    ),
    wrong(
        FREQUENCY,
        "ten points",
        frequency("np.linspace(low, high, 10)"),
        "local minimum",
        "many frequencies",
    ),
    wrong(
        FREQUENCY,
        "a scan of the plain sum",
        frequency().replace("H @ np.linalg.lstsq(H, y)[0]) ** 2)", "H.sum(axis=1)) ** 2)"),
        "local minimum",
        "many frequencies",
    ),
    wrong(
        FREQUENCY,
        "sine only",
        frequency("np.linspace(low, high, 6000)", "w", "[np.sin(w * t)]"),
        "phase fixed",
        "phase",
    ),
    # 7. ranges
    right(
        LOCATE,
        "a grid of starts",
        locate(
            "return min((fit(errors, centre + [p, q]) for p in (-4, 0, 4) for q in (-4, 4)), key=lambda r: r.cost).x"
        ),
    ),
    right(
        LOCATE,
        "a scan of the plane, then refined",
        locate(
            "near = [centre + [p, q] for p in np.linspace(-9, 9, 37) for q in np.linspace(-9, 9, 37)]\n"
            "return fit(errors, min(near, key=lambda th: np.sum(errors(th) ** 2))).x"
        ),
    ),
    right(
        LOCATE,
        "from the linear solution and its mirror image",
        locate(
            LINEAR + "across = np.linalg.svd(beacons - centre)[2][1]\n"
            "mirror = linear - 2 * ((linear - centre) @ across) * across\n"
            "return min((fit(errors, s) for s in (linear, mirror)), key=lambda r: r.cost).x"
        ),
    ),
    wrong(LOCATE, "one start", locate("return fit(errors, centre + [0, 3]).x"), "local minimum", "both sides"),
    wrong(
        LOCATE,
        "first beacon subtracted",
        locate(
            "H = -2 * (beacons - beacons[0])[1:]\nsquares = ranges**2 - np.sum(beacons**2, axis=1)\n"
            "return np.linalg.lstsq(H, (squares - squares[0])[1:])[0]"
        ),
        "squared ranges",
        "squared",
    ),
    wrong(
        LOCATE,
        "worst of all",
        locate(
            "starts = [centre + [0, q] for q in (-4, 4)]\n"
            "return max((fit(errors, s) for s in starts), key=lambda r: r.cost).x"
        ),
        "local minimum",
        "wrong side",
    ),
    wrong(LOCATE, "linear equations", locate(LINEAR + "return linear"), "squared ranges", "another criterion"),
    wrong(
        LOCATE,
        "squares fitted",
        locate(
            "near = [centre + [p, q] for p in np.linspace(-9, 9, 19) for q in np.linspace(-9, 9, 19)]\n"
            "start = min(near, key=lambda th: np.sum(errors(th) ** 2))\n"
            "return fit(lambda th: np.sum((beacons - th) ** 2, axis=1) - ranges**2, start).x"
        ),
        "squared ranges",
        "squared",
    ),
    wrong(LOCATE, "centre", locate("return centre"), "no step taken", "centre"),
    wrong(LOCATE, "all of it", locate("return fit(errors, centre + [0, 3])"), "all of the result", "\\.x"),
    wrong(LOCATE, "nearest beacon", locate("return beacons[np.argmin(ranges)]"), None, "is possible"),
    right(LAYOUT, "singular values", layout("int(sum(s > 1e-6))", "s = np.linalg.svd(beacons - beacons.mean(0))[1]\n")),
    right(
        LAYOUT,
        "cross products",
        define(
            "layout(beacons)",
            "d = beacons - beacons[0]\nif np.all(abs(d) < 1e-9):\n    return 'undetermined'\n"
            "far = d[np.argmax(np.sum(d**2, axis=1))]\n"
            "return 'mirror' if np.all(abs(far[0] * d[:, 1] - far[1] * d[:, 0]) < 1e-9) else 'unique'",
        ),
    ),
    wrong(LAYOUT, "counted", layout("min(len(beacons) - 1, 2)"), "beacons counted", "how they lie"),
    wrong(LAYOUT, "not centred", layout("np.linalg.matrix_rank(beacons)"), "not centred", "subtract"),
    wrong(
        LAYOUT,
        "swapped",
        layout("[0, 2, 1][np.linalg.matrix_rank(beacons - beacons[0], tol=1e-9)]"),
        "mirror and unique swapped",
        "swapped",
    ),
    wrong(
        LAYOUT,
        "never undetermined",
        layout("max(1, np.linalg.matrix_rank(beacons - beacons[0], tol=1e-9))"),
        "one place forgotten",
        "one place",
    ),
    wrong(LAYOUT, "along the axes", layout("sum(np.ptp(beacons, axis=0) > 1e-9)"), "along the axes only", "direction"),
    wrong(
        LAYOUT,
        "exact zero",
        define(
            "layout(beacons)",
            "d = beacons - beacons[0]\nfar = d[np.argmax(np.sum(d**2, axis=1))]\nif np.all(d == 0):\n"
            "    return 'undetermined'\n"
            "return 'mirror' if np.all(far[0] * d[:, 1] - far[1] * d[:, 0] == 0) else 'unique'",
        ),
        "zero compared exactly",
        "rounding",
    ),
    wrong(
        LAYOUT,
        "rank without a tolerance",
        layout("np.linalg.matrix_rank(beacons - beacons[0], tol=0)"),
        "zero compared exactly",
        "rounding",
    ),
    wrong(LAYOUT, "another text", define("layout(beacons)", "return 'yes'"), "another text", "one of the texts"),
    # 8. the step response
    right(STEP, "fun and jac", step()),
    right(
        STEP,
        "curve_fit",
        define(
            "fit_step(t, y, amplitude)",
            "f = lambda t, y0, K, tau: y0 + K * amplitude * (1 - np.exp(-t / tau))\n"
            "theta, C = scipy.optimize.curve_fit(f, t, y, [y[0], (y[-1] - y[0]) / amplitude, 10])\n"
            "return theta, np.sqrt(np.diag(C))",
        ),
    ),
    right(
        STEP,
        "by the rate, Jacobian by hand",
        step(
            "np.r_[fit.x[:2], 1 / fit.x[2]]",
            "np.sqrt(s2 * np.diag(np.linalg.pinv(J.T @ J)))",
            "fit.fun @ fit.fun / (len(t) - 3)\ne = np.exp(-t * fit.x[2])\n"
            "J = np.column_stack([np.ones(len(t)), amplitude * (1 - e), -amplitude * fit.x[1] * t * fit.x[2]**2 * e])",
            "th[0] + th[1] * amplitude * (1 - np.exp(-t * th[2]))",
            "[y[0], (y[-1] - y[0]) / amplitude, 5 / t[-1]]",
        ),
    ),
    wrong(
        STEP,
        "twice J'J",
        step("fit.x", "np.sqrt(np.diag(s2 * np.linalg.inv(2 * fit.jac.T @ fit.jac)))"),
        "half the SSE",
        "J'J, which has no factor",
    ),
    wrong(
        STEP,
        "y0 fixed",
        step(
            "np.r_[y[0], fit.x]",
            "np.ones(3)",
            model="y[0] + th[0] * amplitude * (1 - np.exp(-t / th[1]))",
            start="[(y[-1] - y[0]) / amplitude, t[-1] / 4]",
        ),
        "y0 fixed",
        "keeps y0",
    ),
    wrong(
        STEP,
        "amplitude left out",
        step(model="th[0] + th[1] * (1 - np.exp(-t / th[2]))", start="[y[0], y[-1] - y[0], 8.0]"),
        "amplitude not used",
        "size of the step",
    ),
    wrong(
        STEP,
        "rate",
        step(
            model="th[0] + th[1] * amplitude * (1 - np.exp(-t * th[2]))",
            start="[y[0], (y[-1] - y[0]) / amplitude, 0.2]",
        ),
        "rate for time constant",
        "inverse",
    ),
    wrong(STEP, "order", step("fit.x[[1, 2, 0]]"), "order of theta", "order"),
    wrong(
        STEP,
        "level for gain",
        step("np.array([fit.x[0], fit.x[0] + amplitude * fit.x[1], fit.x[2]])"),
        "final level for the gain",
        "change",
    ),
    wrong(STEP, "scipy's cost", step(s2="fit.cost / (len(y) - 3)"), "half the SSE", "half"),
    wrong(STEP, "cost over n", step(s2="fit.cost / len(y)"), "half the SSE", "half"),
    wrong(STEP, "over n", step(s2="np.mean(fit.fun**2)"), "divided by n", "n - 3"),
    wrong(
        STEP,
        "variances",
        step(stderr="np.diag(s2 * np.linalg.inv(fit.jac.T @ fit.jac))"),
        "variance for standard error",
        "roots",
    ),
    wrong(STEP, "no s^2", step(s2="1.0"), "s^2 forgotten", "s\\^2"),
    wrong(STEP, "s", step(s2="np.sqrt(np.sum(fit.fun**2) / (len(y) - 3))"), "s for s^2", "takes s\\^2"),
    wrong(
        STEP,
        "diagonal first",
        step(stderr="np.sqrt(s2 / np.diag(fit.jac.T @ fit.jac))"),
        "diagonal inverted alone",
        "matrix first",
    ),
    wrong(STEP, "theta only", step(result="theta"), "incomplete result", "standard errors"),
    wrong(STEP, "a bad start", step(start="[0.0, 0.0, 1e-3]"), None, "stopped with"),
    # 9. output error
    right(OUTPUT, "lfilter", output_error()),
    right(OUTPUT, "a loop over the samples", LOOP + output_error("run(th, u)")),
    right(
        OUTPUT,
        "Nelder-Mead from the one-step fit",
        LOOP
        + define(
            "fit_output_error(u, y)",
            "a = np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1]]), y[1:])[0]\n"
            "return scipy.optimize.minimize(lambda th: np.sum((y - run(th, u)) ** 2), a, method='Nelder-Mead').x",
        ),
    ),
    wrong(OUTPUT, "one step", define("fit_output_error(u, y)", ARX), "one-step fit", "measured"),
    wrong(
        OUTPUT,
        "one step, iterated",
        output_error("np.r_[0, -th[0] * y[:-1] + th[1] * u[:-1]]"),
        "one-step fit",
        "measured",
    ),
    wrong(OUTPUT, "sign", output_error(result="fit.x * [-1, 1]"), "sign of a", "left side"),
    wrong(OUTPUT, "swapped", output_error(result="fit.x[::-1]"), "a and b swapped", "before"),
    wrong(
        OUTPUT,
        "acts at once",
        output_error("scipy.signal.lfilter([th[1]], [1, th[0]], u)"),
        "lag off by one",
        "at once",
    ),
    wrong(
        OUTPUT,
        "one too late",
        output_error("scipy.signal.lfilter([0, 0, th[1]], [1, th[0]], u)"),
        "lag off by one",
        "too late",
    ),
    wrong(
        OUTPUT,
        "begins at y(0)",
        output_error(
            "scipy.signal.lfilter([0, th[1]], [1, th[0]], u) + y[0] * (-th[0] + 0j).real ** np.arange(len(u))"
        ),
        "run begins at the measured output",
        "rest",
    ),
    wrong(OUTPUT, "all of it", output_error(result="fit"), "all of the result", "\\.x"),
    wrong(OUTPUT, "start returned", output_error(result="[-0.5, 0.5]"), None, "SSE"),
]
