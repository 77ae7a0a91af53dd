"""First tries whose message names one cause, neighbours, and right answers like them: the lab, the steps, the gap."""

from tries import Try
from tries.rows_of_tries import in_rows

_LISTS = "half = len(y) // 2\nPhi = []\nY = []\nfor k in range(2, half):\n    "
_STACK = "half = len(y) // 2\nPhi = np.column_stack("
_LATER = "come later than y"
_OTHER = "The other panel has that"

TRIES: dict[str, tuple[Try, ...]] = {
    "prelab-sinusoids": in_rows(
        (
            "prelab-6-cut-off",
            "title over the upper panel",
            f"The title of .*{_OTHER}.*`ax_b`",
            (("ax_b.set_title", "ax_a.set_title"),),
        ),
    ),
    "lab-identification": in_rows(
        (
            "lab-1b-figure-5",
            "label of the upper panel",
            f"no label.*{_OTHER}.*`ax_b`",
            (('ax_b.set_ylabel("Input', 'ax_a.set_ylabel("Input'),),
        ),
        (
            "lab-1c-figure-6",
            "label of the lower panel",
            f"no label.*{_OTHER}.*`ax_a`",
            (("ax_a.set_ylabel", "ax_b.set_ylabel"),),
        ),
        ("lab-1c-figure-6", "the axes as a list", "", (("ax_a.set_ylabel", "fig_6.axes[0].set_ylabel"),)),
        (
            "lab-2a-phi",
            "a row in round brackets",
            r"a whole row is `A\[k, :\]`",
            "half = len(y) // 2\nPhi = np.zeros((half, 4))\nfor k in range(2, half):\n    Phi(k,:) = [y[k-1], y[k-2], "
            "u[k-1], u[k-2]]",
        ),
        (
            "lab-2a-phi",
            "a column in round brackets",
            r"a whole column is `A\[:, k\]`",
            "half = len(y) // 2\nPhi = np.zeros((half, 4))\nPhi(:, j) = y[:half]",
        ),
        (
            "lab-2a-phi",
            "samples to come",
            rf"has y\(k\+1\) and u\(k\+1\), which {_LATER}",
            f"{_STACK}[y[3:half+1], y[4:half+2], u[3:half+1], u[4:half+2]])\nY = y[2:half]",
        ),
        (
            "lab-2a-phi",
            "inputs to come",
            rf"has u\(k\+1\), which {_LATER}",
            f"{_STACK}[y[1:half-1], y[:half-2], u[3:half+1], u[4:half+2]])\nY = y[2:half]",
        ),
        ("lab-2a-phi", "lists", "", f"{_LISTS}Phi.append([y[k-1], y[k-2], u[k-1], u[k-2]])\n    Y.append(y[k])"),
        (
            "lab-3a-all",
            "predictions behind zeros",
            r"`Phi @ theta_hat` behind 2 other samples: one-step predictions",
            "y_sim = np.append([0, 0], Phi @ theta_hat)",
        ),
        (
            "lab-3a-all",
            "a list",
            "",
            "y_sim = [0.0, 0.0]\nfor k in range(2, len(u)):\n    y_sim.append(-a1*y_sim[k-1] - a2*y_sim[k-2] + "
            "b1*u[k-1] + b2*u[k-2])",
        ),
        (
            "lab-3a-mse",
            "1 taken off the mean",
            "is the mean less 1",
            (("np.mean((y[half:] - y_sim_half) ** 2)", "np.sum((y[half:] - y_sim_half) ** 2) / len(y_sim_half) - 1"),),
        ),
        (
            "lab-3a-mse",
            "N - 1 for N",
            "is divided by N - 1",
            (
                (
                    "np.mean((y[half:] - y_sim_half) ** 2)",
                    "np.sum((y[half:] - y_sim_half) ** 2) / (len(y_sim_half) - 1)",
                ),
            ),
        ),
        (
            "lab-2c-transfer-function",
            "b in the denominator",
            "denominator holds b where a belongs",
            (("[1, a1, a2]", "[1, b1, b2]"),),
        ),
        (
            "lab-2c-transfer-function",
            "a in the numerator",
            "numerator holds a where b belongs",
            (("[b1, b2]", "[a1, a2]"),),
        ),
    ),
    "postlab-model-order": in_rows(
        (
            "postlab-1-transfer-function",
            "b1 for a1",
            "denominator holds b1 where a1 belongs",
            (("-theta_1[0]", "-theta_1[1]"),),
        ),
        (
            "postlab-1-phi",
            "lists",
            "",
            "Phi_1 = []\nY_1 = []\nfor k in range(1, half):\n    Phi_1.append((y[k-1], u[k-1]))\n    Y_1.append(y[k])",
        ),
        (
            "postlab-2-fit-order",
            "length from outside",
            "uses `half` of the notebook, 451, and was called with data of another length, 60",
            (("N = len(y)", "N = half"), ("y[n:])[0]", "y[n:N])[0]")),
        ),
        (
            "postlab-2-fit-order",
            "a row too many on the left",
            "Each row needs its own",
            (("y[n:])[0]", "y)[0]"),),
        ),
    ),
    "step-response": in_rows(
        (
            "step-7-two",
            "no return",
            "must end with a `return` of the result",
            (("    return np.array([a1, a2])\n", ""),),
        ),
        (
            "step-3-mse",
            "1 taken off the mean",
            "is the mean less 1",
            (("np.mean((y_step - y_approx) ** 2)", "np.sum((y_step - y_approx) ** 2) / len(y_step) - 1"),),
        ),
        (
            "step-5-function",
            "t_28 for t_63",
            "it is t_63 - tau, and yours",
            (("max(t_63 - tau, 0.0)", "t_28 - tau"),),
        ),
        (
            "step-5-function",
            "half a tau too early",
            "too early.*When does the response",
            (("max(t_63 - tau, 0.0)", "t_63 - 1.5 * tau"),),
        ),
    ),
    "sim-to-real-gap": in_rows(
        (
            "gap-2-linear",
            "inputs from u(k)",
            r"input columns are one step later than y\(k\) requires",
            (("u[1 : half - 1], u[: half - 2]", "u[2:half], u[1 : half - 1]"),),
        ),
        (
            "gap-2-linear",
            "inputs from u(k-2)",
            r"input columns are one step earlier than y\(k\) requires",
            (
                (
                    "y[1 : half - 1], y[: half - 2], u[1 : half - 1], u[: half - 2]",
                    "y[2 : half - 1], y[1 : half - 2], u[1 : half - 2], u[: half - 3]",
                ),
                ("y[2:half]", "y[3:half]"),
            ),
        ),
        (
            "gap-3-time",
            "max for argmax",
            r"the largest share itself, .* `np.argmax` the index",
            (("np.argmax(share_t)", "np.max(share_t)"),),
        ),
        (
            "gap-9-closed",
            "noise left out of the call",
            "leaves the noise in both errors",
            (("gap_before**2, noise_sd)", "gap_before**2, 0.0)"),),
        ),
    ),
}
"""By assignment."""
