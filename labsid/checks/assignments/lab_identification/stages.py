"""The hints of the lab, in stages: where to look, then what to do."""

from labsid.checks.question import Stages

STAGES = {
    "lab-1a-extract": Stages(
        where=(
            "Step 1a: the four MATLAB lines, and the table below them. MATLAB counts from 1 and Python from 0, "
            "in the list of signals and in the columns alike."
        ),
        how=(
            'Translate from left to right: `LogData["signals"]` is a list, `[0]` its first entry, `["values"]` '
            "the numbers of that signal, `[:, 1]` their second column. Print the shape of each part."
        ),
    ),
    "lab-1a-sampling-time": Stages(
        where=(
            "Step 1a, after the check of the signals: the time from one sample to the next, in seconds. It "
            "stands in the values of `t`."
        ),
        how=(
            "Print `t[:3]`: how far apart are two neighbouring values? Compute this from `t`, so that it is "
            "right for any record."
        ),
    ),
    "lab-1b-figure-5": Stages(
        where=(
            "Step 1b: which signals belong into which panel, against what, with which labels; the fold below "
            "shows how a figure gets its name."
        ),
        how=(
            "Make the figure and both axes in one line, draw with `ax_a.plot` and `ax_b.step`, give each curve "
            "of (a) a `label`, call `ax_a.legend()`, and set the labels with their units."
        ),
    ),
    "lab-1c-loop": Stages(
        where=(
            "Step 1c, the loop: `u[n]` is the sample after the first n. When may the loop go on, and what does n "
            "count when it stops?"
        ),
        how=(
            "Try it on paper with [2, 2, 2, 1]: begin with n = 1, add one as long as the sample after the first "
            "n is equal to the first, and return n, here 3."
        ),
    ),
    "lab-1c-offsets": Stages(
        where=(
            "Step 1c: the input offset is the level of the first period; the output offset is a mean over "
            "samples before the input first changes, and only over those where the output is constant. See your "
            "Fig. 5(a)."
        ),
        how=(
            "Take the slice of `y_act` that ends at `n_first`, and begins where the output is settled, and its "
            "mean; for the input take its first value. Subtract each from the whole of its own signal."
        ),
    ),
    "lab-1c-figure-6": Stages(
        where="Step 1c, last figure: as Fig. 5, with the offset-free `y` and `u`, each in a panel of its own.",
        how=(
            "Copy the lines of Fig. 5, with the new name of the figure, `y` on top and `u` below, against `t`, "
            "and set the labels again."
        ),
    ),
    "lab-2a-phi": Stages(
        where=(
            "Step 2a, eq. (4) and (6): one row is [y(k-1), y(k-2), u(k-1), u(k-2)], and its entry of Y is y(k). "
            "Which k is your first row, which your last?"
        ),
        how=(
            "Write down the first row for k = 2 with indices, [y[1], y[0], u[1], u[0]], and y[2] beside it; then "
            "each column as a slice that begins there. All four and Y have the same length, and end within the "
            "first half. `np.column_stack([...])` puts flat columns side by side."
        ),
    ),
    "lab-2b-theta": Stages(
        where=(
            "Step 2b, eq. (8), and the table below it: which factor is transposed, and which products are `@`? "
            "Print the shapes of Phi.T @ Phi and of Phi.T @ Y."
        ),
        how=(
            "The matrix Phi'Phi is 4 by 4 and Phi'Y has 4 entries: `np.linalg.solve(matrix, right_side)` solves "
            "for theta. `np.linalg.lstsq(Phi, Y)[0]` does the same without them."
        ),
    ),
    "lab-2b-parameters": Stages(
        where="Eq. (4): what stands in theta, from top to bottom, and with which signs? The indices are 0 to 3.",
        how=(
            "Set each of a1, a2, b1, b2 by one line from an entry of theta_hat; the first two entries hold the a "
            "with a minus."
        ),
    ),
    "lab-2c-transfer-function": Stages(
        where=(
            "Step 2c, eq. (1): numerator and denominator in descending powers of z. What is the coefficient of "
            "the highest power in the denominator?"
        ),
        how=(
            "`ct.tf(num, den, Ts)`: two lists, the numerator with two numbers and the denominator with three, "
            "the first of which is 1. The sampling time is your `Ts`."
        ),
    ),
    "lab-2c-state-space": Stages(
        where=(
            "Step 2c, eq. (2): the four matrices G, H, C, D. In the last row of G and in C, which parameter "
            "comes first?"
        ),
        how=(
            "Copy the matrices of eq. (2) entry by entry as lists of rows; H is a column, so two rows of one "
            "entry each; D is [[0]]. `Ts` comes last."
        ),
    ),
    "lab-3a-second-half": Stages(
        where=(
            "Step 3a: a simulation is handed the input alone, here `u[half:]`, and starts from rest. Which input "
            "does your line hand over, and does any measured output stand in it?"
        ),
        how=(
            "Give the model of step 2c the second half of the input: `ct.forced_response(model, inputs=...)`, "
            "and take `.outputs`. With `lfilter` the numerator begins with a zero."
        ),
    ),
    "lab-3a-all": Stages(
        where="Step 3a, second simulation: one run over the entire input, from rest at its first sample.",
        how=("As before, with all of `u` in one call: two halves put together would start from rest twice."),
    ),
    "lab-3a-mse": Stages(
        where=(
            "Step 3a, the MSE: which two signals are compared, over which samples, and what comes first, the "
            "square or the mean?"
        ),
        how=(
            "Subtract two arrays of equal length, square, then take `np.mean`. For `mse_half` these are the "
            "second half of `y` and `y_sim_half`; print both shapes."
        ),
    ),
    "lab-3a-figure-7": Stages(
        where="Step 3a, Fig. 7: two curves in each panel, the second half against the times of the second half.",
        how=(
            "In (a) draw `y[half:]` and `y_sim_half` against `t[half:]`, in (b) `y` and `y_sim` against `t`; "
            "label all four, both axes, and call `legend` in each panel."
        ),
    ),
    "lab-3b-initial-state": Stages(
        where=(
            "Step 3b, the equation before the exercise: what is left of y when the response from rest is taken "
            "off is linear in x(0). The fold lists the functions."
        ),
        how=(
            "In this order: the response from rest to u; the two columns, responses to [1, 0] and [0, 1] without "
            "input; `lstsq` of these columns on y less the response from rest; a simulation of u from that "
            "state. Return the last."
        ),
    ),
}
