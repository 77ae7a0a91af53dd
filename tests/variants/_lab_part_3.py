"""Part 3 of the lab: the simulations, their errors, the initial state."""

from variants import Right, Wrong, right, wrong
from variants._lab_cells import panels

HALF, ALL, MSE = "lab-3a-second-half", "lab-3a-all", "lab-3a-mse"
FIGURE_7, STATE = "lab-3a-figure-7", "lab-3b-initial-state"

FIG_7A = "a.plot(t[half:], y[half:], label='Actual output')\na.plot(t[half:], y_sim_half, label='Simulated output')"
FIG_7B = "b.plot(t, y, label='Actual output')\nb.plot(t, y_sim, label='Simulated output')"
FIG_7_LEGENDS = "a.legend()\nb.legend()"
PIECES = """time = np.arange(len(u)) * Ts
from_rest = ct.forced_response(G_ss, time, u).outputs
O = np.column_stack([ct.initial_response(G_ss, time, initial_state=s).outputs for s in ([1, 0], [0, 1])])
"""


def function(body: str) -> str:
    return "def simulate_from_start(u, y):\n" + "".join(f"    {line}\n" for line in body.splitlines())


VARIANTS: list[Right | Wrong] = [
    # 3a. the second half
    right(HALF, "lfilter", "y_sim_half = scipy.signal.lfilter([0, b1, b2], [1, a1, a2], u[half:])"),
    right(HALF, "from the state space", "y_sim_half = ct.forced_response(G_ss, inputs=u[half:]).outputs"),
    right(
        HALF,
        "dlsim, a column",
        "_, y_sim_half, _ = scipy.signal.dlsim((G_ss.A, G_ss.B, G_ss.C, G_ss.D, Ts), u[half:])",
        {
            MSE: "y_sim_half = y_sim_half.ravel()\n"
            "mse_half, mse_all = np.mean((y[half:] - y_sim_half) ** 2), np.mean((y - y_sim) ** 2)"
        },
    ),
    right(
        HALF,
        "own loop, the first two at zero",
        "uh = u[half:]\ny_sim_half = np.zeros(len(uh))\nfor k in range(2, len(uh)):\n"
        "    y_sim_half[k] = -a1 * y_sim_half[k - 1] - a2 * y_sim_half[k - 2] + b1 * uh[k - 1] + b2 * uh[k - 2]",
    ),
    wrong(
        HALF,
        "one-step prediction",
        "y_sim_half = np.zeros(len(u) - half)\nfor i, k in enumerate(range(half, len(u))):\n"
        "    y_sim_half[i] = -a1 * y[k-1] - a2 * y[k-2] + b1 * u[k-1] + b2 * u[k-2]",
        "one-step prediction",
        "measured",
    ),
    wrong(
        HALF, "first half", "y_sim_half = ct.forced_response(G, inputs=u[:half]).outputs", "wrong half", "first half"
    ),
    wrong(
        HALF,
        "cut from the entire run",
        "y_sim_half = ct.forced_response(G, inputs=u).outputs[half:]",
        "state carried over",
        "cut from the simulation of the entire input",
    ),
    wrong(HALF, "entire input", "y_sim_half = ct.forced_response(G, inputs=u).outputs", "entire input", "u\\[half:\\]"),
    wrong(
        HALF,
        "input with its offset",
        "y_sim_half = ct.forced_response(G, inputs=u_act[half:]).outputs",
        "input offset left in",
        "u_act",
    ),
    wrong(
        HALF,
        "sign of a",
        "y_sim_half = scipy.signal.lfilter([0, b1, b2], [1, -a1, -a2], u[half:])",
        "sign of a",
        "denominator",
    ),
    wrong(
        HALF,
        "zero forgotten",
        "y_sim_half = scipy.signal.lfilter([b1, b2], [1, a1, a2], u[half:])",
        "numerator one step early",
        "begins with a zero",
    ),
    wrong(
        HALF,
        "two samples short",
        "y_sim_half = ct.forced_response(G, inputs=u[half + 2:]).outputs",
        "off by one",
        "exactly the second half",
    ),
    wrong(
        HALF,
        "one sample too many",
        "y_sim_half = ct.forced_response(G, inputs=u[half - 1:]).outputs",
        "off by one",
        "exactly the second half",
    ),
    wrong(
        HALF,
        "b in reverse",
        "y_sim_half = scipy.signal.lfilter([0, b2, b1], [1, a1, a2], u[half:])",
        "order of b",
        "b1 and b2 swapped",
    ),
    wrong(
        HALF,
        "along the rows of a column",
        "y_sim_half = scipy.signal.lfilter([0, b1, b2], [1, a1, a2], u[half:].reshape(-1, 1))",
        "filtered along the wrong axis",
        "axis=0",
    ),
    wrong(HALF, "nothing", "y_sim_half = np.zeros(len(u[half:]))", "zero output", "is zero at every sample"),
    wrong(
        HALF,
        "offset added back",
        "y_sim_half = ct.forced_response(G, inputs=u[half:]).outputs + y_offset",
        "offset added back",
        "offset-free",
    ),
    wrong(
        HALF,
        "whole response",
        "y_sim_half = ct.forced_response(G, inputs=u[half:])",
        "response instead of its output",
        "outputs",
    ),
    wrong(
        HALF,
        "output as the input",
        "y_sim_half = ct.forced_response(G, inputs=y[half:]).outputs",
        "output used as input",
        "input is `u`",
    ),
    wrong(
        HALF,
        "started from measured samples",
        "yh, uh = y[half:], u[half:]\ny_sim_half = yh.copy()\nfor k in range(2, len(uh)):\n"
        "    y_sim_half[k] = -a1 * y_sim_half[k - 1] - a2 * y_sim_half[k - 2] + b1 * uh[k - 1] + b2 * uh[k - 2]",
        "started from measured samples",
        "from rest",
    ),
    # 3a. the entire record
    right(ALL, "lfilter", "y_sim = scipy.signal.lfilter([0, b1, b2], [1, a1, a2], u)"),
    right(
        ALL,
        "own loop from the first two measured samples",
        "y_sim = np.array(y)\nfor k in range(2, len(u)):\n"
        "    y_sim[k] = -a1 * y_sim[k - 1] - a2 * y_sim[k - 2] + b1 * u[k - 1] + b2 * u[k - 2]",
    ),
    right(
        ALL,
        "own loop over the states",
        "x = np.zeros((2, 1))\ny_sim = np.zeros(len(u))\nfor k in range(len(u)):\n"
        "    y_sim[k] = (G_ss.C @ x)[0, 0]\n    x = G_ss.A @ x + G_ss.B * u[k]",
    ),
    wrong(
        ALL,
        "one-step prediction",
        "y_sim = np.array(y)\ny_sim[2:] = np.column_stack([y[1:-1], y[:-2], u[1:-1], u[:-2]]) @ theta_hat",
        "one-step prediction",
        "measured",
    ),
    wrong(ALL, "second half only", "y_sim = y_sim_half", "wrong half", "second half only"),
    wrong(
        ALL,
        "input with its offset",
        "y_sim = ct.forced_response(G, inputs=u_act).outputs",
        "input offset left in",
        "u_act",
    ),
    wrong(
        ALL,
        "offset added back",
        "y_sim = ct.forced_response(G, inputs=u).outputs + y_offset",
        "offset added back",
        "offset-free",
    ),
    wrong(ALL, "the measured output", "y_sim = y", "measured output", "measured output itself"),
    wrong(
        ALL,
        "time and output",
        "r = ct.forced_response(G, inputs=u)\ny_sim = (r.time, r.outputs)",
        "response instead of its output",
        "take only the output",
    ),
    wrong(
        ALL,
        "zero forgotten",
        "y_sim = scipy.signal.lfilter([b1, b2], [1, a1, a2], u)",
        "numerator one step early",
        "too early",
    ),
    wrong(
        ALL,
        "a model in continuous time",
        "y_sim = scipy.signal.lsim(([b1, b2], [1, a1, a2]), u, t)[1]",
        None,
        "not the free run",
    ),
    # 3a. the mean squared errors
    right(
        MSE,
        "sums",
        "e = y - y_sim\nmse_all = e @ e / len(e)\nmse_half = sum((y[half:] - y_sim_half) ** 2) / (len(y) - half)",
    ),
    right(
        MSE,
        "norms",
        "mse_all = np.linalg.norm(y - y_sim) ** 2 / y.size\nmse_half = np.square(y[half:] - y_sim_half).mean()",
    ),
    wrong(
        MSE,
        "root",
        "mse_half, mse_all = np.sqrt(np.mean((y[half:] - y_sim_half) ** 2)), np.sqrt(np.mean((y - y_sim) ** 2))",
        "root of the mean squared error",
        "root",
    ),
    wrong(
        MSE,
        "sum",
        "mse_half, mse_all = np.sum((y[half:] - y_sim_half) ** 2), np.sum((y - y_sim) ** 2)",
        "sum in place of the mean",
        "divide",
    ),
    wrong(
        MSE,
        "against the output with its offset",
        "mse_half, mse_all = np.mean((y_act[half:] - y_sim_half) ** 2), np.mean((y_act - y_sim) ** 2)",
        "offset left in",
        "`y_act`",
    ),
    wrong(
        MSE,
        "absolute",
        "mse_half, mse_all = np.mean(abs(y[half:] - y_sim_half)), np.mean(abs(y - y_sim))",
        "mean absolute error",
        "square",
    ),
    wrong(
        MSE,
        "mean squared afterwards",
        "mse_half, mse_all = np.mean(y[half:] - y_sim_half) ** 2, np.mean(y - y_sim) ** 2",
        "square of the mean error",
        "square first",
    ),
    wrong(
        MSE,
        "swapped",
        "mse_all, mse_half = np.mean((y[half:] - y_sim_half) ** 2), np.mean((y - y_sim) ** 2)",
        "errors swapped",
        "swapped",
    ),
    wrong(
        MSE,
        "carried over",
        "mse_half, mse_all = np.mean((y[half:] - y_sim[half:]) ** 2), np.mean((y - y_sim) ** 2)",
        "state carried over",
        "y_sim_half",
    ),
    wrong(
        MSE,
        "column minus flat",
        "mse_half = np.mean((y[half:, None] - y_sim_half) ** 2)\nmse_all = np.mean((y - y_sim) ** 2)",
        "column minus flat",
        "N-by-N",
    ),
    wrong(
        MSE,
        "variance",
        "mse_half, mse_all = np.var(y[half:] - y_sim_half), np.var(y - y_sim)",
        "variance of the error",
        "variance",
    ),
    # 3a. Fig. 7
    right(
        FIGURE_7,
        "legend with names",
        "fig_7 = plt.figure()\nplt.subplot(211)\n"
        "plt.plot(t[half:], y[half:], t[half:], y_sim_half)\n"
        "plt.legend(['y', 'model'])\nplt.ylabel('V (V)')\nplt.subplot(212)\n"
        "plt.plot(t, y_sim, 'r', label='simulated')\nplt.plot(t, y, 'k', label='measured')\n"
        "plt.legend()\nplt.xlabel('t (s)')\nplt.ylabel('y (V)')",
    ),
    right(
        FIGURE_7,
        "steps",
        panels(
            "fig_7",
            FIG_7A.replace("plot", "step"),
            FIG_7B.replace("plot", "step"),
            lower_labels="b.set(xlabel='Time (s)', ylabel='y (V)')",
            legend=FIG_7_LEGENDS,
        ),
    ),
    wrong(
        FIGURE_7,
        "times of the first half",
        panels("fig_7", FIG_7A.replace("t[half:]", "t[: len(t) - half]"), FIG_7B, legend=FIG_7_LEGENDS),
        "time of the first half",
        "times of the first",
    ),
    wrong(
        FIGURE_7,
        "simulation of the half cut from the whole",
        panels("fig_7", FIG_7A.replace("y_sim_half", "y_sim[half:]"), FIG_7B, legend=FIG_7_LEGENDS),
        "state carried over",
        "no curve shows `y_sim_half`",
    ),
    wrong(
        FIGURE_7,
        "panels swapped",
        panels("fig_7", FIG_7B.replace("b.", "a."), FIG_7A.replace("a.", "b."), legend=FIG_7_LEGENDS),
        "panels swapped",
        "swapped",
    ),
    wrong(FIGURE_7, "no legend below", panels("fig_7", FIG_7A, FIG_7B), "no legend", "lower panel"),
    wrong(
        FIGURE_7,
        "names swapped",
        panels(
            "fig_7",
            FIG_7A,
            FIG_7B.replace("Actual", "X").replace("Simulated", "Actual").replace("X", "Simulated"),
            legend=FIG_7_LEGENDS,
        ),
        "legend entries swapped",
        "lower panel",
    ),
    wrong(
        FIGURE_7,
        "against the sample number",
        panels("fig_7", FIG_7A.replace("t[half:], ", ""), FIG_7B, legend=FIG_7_LEGENDS),
        "drawn against the sample number",
        "upper panel",
    ),
    # 3b. the initial state
    right(
        STATE, "all samples", function(PIECES + "x0 = np.linalg.lstsq(O, y - from_rest)[0]\nreturn from_rest + O @ x0")
    ),
    wrong(
        STATE,
        "two samples, solved",
        function(PIECES + "return from_rest + O @ np.linalg.solve(O[:2], (y - from_rest)[:2])"),
        "state from a few samples",
        "first 2 samples only",
    ),
    right(
        STATE,
        "the first twenty samples",
        function(PIECES + "return from_rest + O @ np.linalg.lstsq(O[:20], (y - from_rest)[:20])[0]"),
    ),
    right(
        STATE,
        "another realisation, powers of the matrix",
        function(
            "A, B, C = np.array([[-a1, 1], [-a2, 0]]), np.array([[b1], [b2]]), np.array([[1, 0]])\n"
            "rows = [C @ np.linalg.matrix_power(A, k) for k in range(40)]\n"
            "rest = scipy.signal.lfilter([0, b1, b2], [1, a1, a2], u)\n"
            "x = np.linalg.pinv(np.vstack(rows)) @ (y - rest)[:40].reshape(-1, 1)\n"
            "out = []\nfor value in u:\n    out.append((C @ x)[0, 0])\n    x = A @ x + B * value\nreturn out"
        ),
    ),
    wrong(
        STATE,
        "the first two samples in the difference equation",
        function(
            "s = np.array(y)\nfor k in range(2, len(u)):\n"
            "    s[k] = -a1 * s[k-1] - a2 * s[k-2] + b1 * u[k-1] + b2 * u[k-2]\nreturn s"
        ),
        "state from a few samples",
        "first 2 samples only",
    ),
    right(
        STATE,
        "for columns only",
        function(
            "assert u.ndim == 2\n"
            + PIECES.replace("time, u)", "time, u.ravel())")
            + "x0 = np.linalg.lstsq(O, y - from_rest.reshape(-1, 1))[0]\nreturn from_rest.reshape(-1, 1) + O @ x0"
        ),
    ),
    wrong(
        STATE,
        "still from rest",
        function("return ct.forced_response(G, inputs=u).outputs"),
        "started from rest",
        "from rest",
    ),
    wrong(
        STATE,
        "shifted",
        function("s = ct.forced_response(G, inputs=u).outputs\nreturn s + y[0] - s[0]"),
        "shifted instead of simulated",
        "a shift does not",
    ),
    wrong(STATE, "measured output handed back", function("return y"), "measured output", "returns the measured output"),
    wrong(
        STATE,
        "one-step prediction",
        function("s = np.array(y)\ns[2:] = -a1 * y[1:-1] - a2 * y[:-2] + b1 * u[1:-1] + b2 * u[:-2]\nreturn s"),
        "one-step prediction",
        "initial state only",
    ),
    wrong(
        STATE,
        "rest not subtracted",
        function(PIECES + "return from_rest + O @ np.linalg.lstsq(O, y)[0]"),
        "response from rest not subtracted",
        "First subtract",
    ),
    wrong(
        STATE,
        "rest not added",
        function(PIECES + "return O @ np.linalg.lstsq(O, y - from_rest)[0]"),
        "response from rest left out",
        "add the response",
    ),
    wrong(
        STATE,
        "the state",
        function(PIECES + "return np.linalg.lstsq(O, y - from_rest)[0]"),
        "state instead of the output",
        "return the output",
    ),
    wrong(STATE, "works on the second half only", function("return y_sim_half"), None, "one number for each"),
]
