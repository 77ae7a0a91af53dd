"""First tries with a wrong result, and right answers in an unusual way: pre-lab, lab and post-lab."""

from tries import Try
from tries.rows_of_tries import TO_Y, in_rows

_END = r"from the \*end\* of the record"
_INPUT = "has the input on the left-hand side"
_OTHER = "The other panel has that"

TRIES: dict[str, tuple[Try, ...]] = {
    "prelab-sinusoids": in_rows(
        (
            "prelab-3-cut",
            "first samples zero",
            "are set to zero: they should be cut off, so",
            "t_new = t - 20\nt_new[:200] = 0\ny1_new = y1.copy()\ny2_new = y2.copy()",
        ),
        (
            "prelab-3-cut",
            "signal zero at first",
            "are set to zero: they should be cut off, `y1",
            "t_new = t[200:] - t[200]\ny1_new = y1.copy()\ny1_new[:200] = 0\ny2_new = y2[200:]",
        ),
        (
            "prelab-3-cut",
            "rolled",
            "`np.roll` goes round.*`y1",
            "t_new = t[200:] - t[200]\ny1_new = np.roll(y1, -200)\ny2_new = np.roll(y2, -200)",
        ),
        (
            "prelab-3-cut",
            "time rolled",
            "`np.roll` goes round.*`t",
            "t_new = np.roll(t, -200)\ny1_new = y1[200:]\ny2_new = y2[200:]",
        ),
        (
            "prelab-4-function",
            "rows zero",
            "sets the first n rows to zero",
            "def cut_off(data, n):\n    rest = data.copy()\n    rest[:n] = 0\n    return rest",
        ),
        (
            "prelab-4-function",
            "rolled",
            "`np.roll` goes round",
            "def cut_off(data, n):\n    rest = np.roll(data, -n, axis=0)\n    return rest",
        ),
        (
            "prelab-5-original",
            "limits of the lower panel",
            f"runs from .*{_OTHER}.*`ax_a`",
            (("ax_a.set_xlim", "ax_b.set_xlim"), ("ax_a.set_ylim", "ax_b.set_ylim")),
        ),
        (
            "prelab-5-original",
            "plt.xlim",
            f"runs from .*{_OTHER}.*`ax_a`",
            (("ax_a.set_xlim", "plt.xlim"), ("ax_a.set_ylim", "plt.ylim")),
        ),
        ("prelab-5-original", "grid of the lower panel", f"no grid.*{_OTHER}", (("ax_a.grid", "ax_b.grid"),)),
        (
            "prelab-6-cut-off",
            "limits of the upper panel",
            f"runs from .*{_OTHER}.*`ax_b`",
            (("ax_b.set_xlim", "ax_a.set_xlim"), ("ax_b.set_ylim", "ax_a.set_ylim")),
        ),
        (
            "prelab-6-cut-off",
            "legend of the upper panel",
            f"legend should name.*{_OTHER}",
            (("ax_b.legend", "ax_a.legend"),),
        ),
        (
            "prelab-6-cut-off",
            "label of the upper panel",
            f"no label.*{_OTHER}",
            (("ax_b.set_xlabel", "ax_a.set_xlabel"),),
        ),
        (
            "prelab-6-cut-off",
            "the axes made last",
            "",
            (("ax_b.set_xlim", "plt.gca().set_xlim"), ("ax_b.set_ylim", "plt.gca().set_ylim")),
        ),
    ),
    "lab-identification": in_rows(
        (
            "lab-1c-loop",
            "all indices",
            r"The first of these indices is the answer",
            "def first_period(u):\n    return np.where(u != u[0])\n\n\nn_first = 10",
        ),
        (
            "lab-1c-loop",
            "a mask",
            "a truth value for each sample",
            "def first_period(u):\n    return u != u[0]\n\n\nn_first = 10",
        ),
        (
            "lab-1c-loop",
            "the new value",
            "the new value of the input",
            "def first_period(u):\n    return u[np.argmax(u != u[0])]\n\n\nn_first = 10",
        ),
        (
            "lab-1c-loop",
            "largest rise",
            "the largest rise",
            "def first_period(u):\n    return np.argmax(np.diff(u))\n\n\nn_first = 10",
        ),
        (
            "lab-2a-phi",
            "Y from the start",
            rf"449 rows and `Y` 451.*{TO_Y} `Y`.*holds y\[0\] to y\[450\]",
            (("Y = y[2:half]", "Y = y[:half]"),),
        ),
        (
            "lab-2a-phi",
            "Y to the end",
            rf"449 rows and `Y` 901.*{TO_Y} `Y`.*holds y\[2\] to y\[902\]",
            (("Y = y[2:half]", "Y = y[2:]"),),
        ),
        ("lab-2a-phi", "Y one early", f"{TO_Y} `Y`: it is 1 sample early", (("Y = y[2:half]", "Y = y[1 : half - 1]"),)),
        ("lab-2a-phi", "Y of the input", f"{TO_Y} `Y`: it holds the input", (("Y = y[2:half]", "Y = u[2:half]"),)),
        (
            "lab-2a-phi",
            "Y with its offset",
            f"{TO_Y} `Y`: a constant is added",
            (("Y = y[2:half]", "Y = y_act[2:half]"),),
        ),
        (
            "lab-2a-phi",
            "rows of zeros",
            "Row 1 of `Phi` should not be all zeros",
            "half = len(y) // 2\nPhi = np.zeros((half, 4))\nfor k in range(2, half):\n    Phi[k] = [y[k-1], "
            "y[k-2], u[k-1], u[k-2]]\nY = y[:half]",
        ),
        (
            "lab-2a-phi",
            "zeros before the record",
            "",
            "half = len(y) // 2\nd = lambda x, k: np.r_[np.zeros(k), x[:half - k]]\nPhi = np.column_stack([d(y, "
            "1), d(y, 2), d(u, 1), d(u, 2)])\nY = y[:half]",
        ),
        ("lab-3a-mse", "first half", "the first half only", (("(y - y_sim) ** 2", "(y - y_sim)[:half] ** 2"),)),
        (
            "lab-3a-all",
            "measured half joined",
            "is the measured output in its first half",
            "y_sim = np.concatenate([y[:half], y_sim_half])",
        ),
        ("lab-2b-theta", "transposed throughout", "", "theta_hat = Y.T @ Phi @ np.linalg.inv(Phi.T @ Phi)"),
        (
            "lab-2b-parameters",
            "arrays of one entry",
            "",
            "a1, a2 = -theta_hat[0:1], -theta_hat[1:2]\nb1, b2 = theta_hat[2:3], theta_hat[3:4]",
        ),
    ),
    "postlab-model-order": in_rows(
        (
            "postlab-1-phi",
            "Y from the start",
            rf"450 rows and `Y_1` 451.*{TO_Y} `Y_1`",
            (("Y_1 = y[1:half]", "Y_1 = y[:half]"),),
        ),
        (
            "postlab-1-phi",
            "Y of the input",
            f"{TO_Y} `Y_1`: it holds the input",
            (("Y_1 = y[1:half]", "Y_1 = u[1:half]"),),
        ),
        (
            "postlab-1-phi",
            "a row of zeros too many",
            "Row 1 of `Phi_1` should not be all zeros",
            "Phi_1 = np.zeros((half, 2))\nPhi_1[2:, 0] = y[1 : half - 1]\nPhi_1[2:, 1] = u[1 : half - 1]\nY_1 = "
            "y[:half]",
        ),
        (
            "postlab-1-phi",
            "one row of zeros",
            "",
            "Phi_1 = np.zeros((half, 2))\nPhi_1[1:, 0] = y[: half - 1]\nPhi_1[1:, 1] = u[: half - 1]\nY_1 = y[:half]",
        ),
        (
            "postlab-1-transfer-function",
            "a quotient of numbers",
            r"Make it with `ct.tf\(",
            "G_1 = theta_1[1] / (1 - theta_1[0])",
        ),
        (
            "postlab-2-fit-order",
            "rolled",
            f"`fit_order` takes samples {_END}.*k = n, here 1",
            "def fit_order(u, y, n):\n    past = [np.roll(x, i) for x in (y, u) for i in range(1, n + 1)]\n"
            "    return np.linalg.lstsq(np.column_stack(past), y)[0]\n\n\ntheta_2 = fit_order(u[:half], y[:half], 2)",
        ),
        ("postlab-2-fit-order", "Y of the input", f"`fit_order` {_INPUT}", (("y[n:])[0]", "u[n:])[0]"),)),
        ("postlab-3-mse", "first half", "the first half only", (("(y - y_sim_1) ** 2", "(y - y_sim_1)[:half] ** 2"),)),
    ),
}
"""By assignment."""
