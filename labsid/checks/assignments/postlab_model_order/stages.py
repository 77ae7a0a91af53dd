"""The hints of the post-lab, in stages: where to look, then what to do."""

from labsid.checks.question import Stages

STAGES = {
    "postlab-1-phi": Stages(
        where=(
            "Step 1, eq. (9): a row is [y(k-1), u(k-1)], and its entry of Y_1 is y(k). Only the first half is used."
        ),
        how=(
            "Write the row for k = 1 down with indices, [y[0], u[0]], and y[1] beside it. Each column is a slice "
            "that begins there and ends one sample before Y_1 does."
        ),
    ),
    "postlab-1-theta": Stages(
        where="Eq. (8) of the lab, with Phi_1 and Y_1: which factor is transposed, and which products are `@`?",
        how=(
            "Phi_1'Phi_1 is 2 by 2 and Phi_1'Y_1 has 2 entries: `np.linalg.solve` of these two, or "
            "`np.linalg.lstsq(Phi_1, Y_1)[0]`."
        ),
    ),
    "postlab-1-transfer-function": Stages(
        where="Step 1, G_1(z) = b1 / (z + a1): what stands in theta_1, and with which sign?",
        how=(
            "`ct.tf(num, den, Ts)` with a numerator of one number, and a denominator that begins with 1; its "
            "second number is a1, and theta_1 begins with -a1."
        ),
    ),
    "postlab-2-fit-order": Stages(
        where=(
            "Step 2, the regression of order n: first the n lags of y, then those of u, lag 1 first; all samples "
            "of the arguments are used. The fold has the slice of one lag."
        ),
        how=(
            "Make a list of n slices of y and one of n slices of u, all for the rows k = n to the end, join them "
            "with `+`, stack, and solve against y[n:]. Try n = 1: it must give your theta_1."
        ),
    ),
    "postlab-2-simulation": Stages(
        where=(
            "Step 2, the last exercise: as 3a of the lab, with the entire input, once for theta_1 and once for "
            "theta_2. Which a and b does each theta hold?"
        ),
        how=(
            "Make a transfer function of each theta, with the signs of a turned, and hand `u` to "
            "`ct.forced_response`; take `.outputs`."
        ),
    ),
    "postlab-3-mse": Stages(
        where=("Step 3: the mean of the squared differences between `y` and each simulation, over the entire record."),
        how=("Subtract, square, then `np.mean`, once with y_sim_1 and once with y_sim_2."),
    ),
    "postlab-3-figure-8": Stages(
        where=(
            "Step 3, Fig. 8: three curves, a legend that tells the orders, and both errors as a text with the "
            "order beside each number."
        ),
        how=(
            'Draw the three against `t`, each with a label; then `ax.text(0.02, 0.97, f"...", '
            'transform=ax.transAxes, va="top")` with both numbers, `{mse_1:.2e}` for three digits.'
        ),
    ),
}
