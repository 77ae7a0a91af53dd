"""The hints of the appendix on step responses and least squares, in stages: where to look, then what to do."""

from labsid.checks.question import Stages

STAGES = {
    "step-1-read": Stages(
        where=(
            "Step 1, the two rules: K is the whole change over the amplitude; t_63 and t_28 are the times at "
            "which 63.2 % and 28.3 % of the change are reached. Fig. A1 below marks your values."
        ),
        how=(
            "Find t_28 and t_63 first, as in the fold, then tau = 3/2 (t_63 - t_28) and td = t_63 - tau. Print "
            "all four."
        ),
    ),
    "step-2-response": Stages(
        where=(
            "Step 1, the formula with two cases: what is y before t_d, and which time stands in the exponent after it?"
        ),
        how=(
            "Replace t by the time since the delay, and that by zero where it is negative (`np.maximum`): then "
            "one formula holds for all times. K, tau and amplitude are the arguments."
        ),
    ),
    "step-3-mse": Stages(
        where=(
            "Step 3: the response of *your* model at the times `t_step`, to the step of amplitude 2, and then "
            "the formula of the MSE."
        ),
        how=(
            "Call your function of step 2 with K, tau, td of step 1 and `amplitude`; then subtract, square, and "
            "take the mean."
        ),
    ),
    "step-3-figure": Stages(
        where=(
            "Step 3, the last paragraph: both responses in one figure `fig_a2`, axes labelled with units, a "
            "legend with two names."
        ),
        how=(
            "Draw y_step and y_approx against t_step with `ax.plot(..., label=...)`, set both labels as given in "
            "the step, and call `ax.legend()`."
        ),
    ),
    "step-5-function": Stages(
        where=(
            "Step 5, the list of what differs in real recordings: the start level, the direction, the noise. "
            "Which line of your function assumes a start at zero, or a step up?"
        ),
        how=(
            "Compute the response as a share of its change, (y - y_start) / (y_end - y_start), which runs from 0 "
            "to 1 for every step, up or down; read t_28 and t_63 of it; K is the change over the amplitude, with "
            "the signs of both."
        ),
    ),
    "step-6-cut": Stages(
        where=(
            "Step 6: where does the input change first, where the second time? What is subtracted is a mean of "
            "settled samples before the change."
        ),
        how=(
            "`np.flatnonzero(np.diff(u_act)) + 1` lists the samples with a new value. Cut both signals from the "
            "first to the second; subtract the first time, and the mean of, say, the last 20 outputs before; the "
            "amplitude is the new input minus the old."
        ),
    ),
    "step-6-model": Stages(
        where="Step 6: your `read_step` on the step that you have cut out, and its three results by name.",
        how=(
            "Hand over t_held, y_held and a_held in this order, and unpack the three results. Are they wrong "
            "though `read_step` passes? Then print what you hand over."
        ),
    ),
    "step-7-two": Stages(
        where=(
            "Step 7, (A2): numerators and determinant, entry by entry; u12 is `U[0, 1]`. What if the determinant "
            "is zero?"
        ),
        how=(
            "Write det = u11 u22 - u12 u21 first, return None if it is zero, then both numerators over it, as an "
            "array. Insert your result into (A1)."
        ),
    ),
    "step-8-error": Stages(
        where=(
            "Step 8, (A4): E = Y - Phi theta, where Phi theta is the product of a matrix and a vector. Which "
            "sign does that product have in Python?"
        ),
        how=("`Phi @ theta` has one number for each equation, like Y. Subtract it from Y, not the other way round."),
    ),
    "step-8-loss": Stages(
        where="Step 8, (A5): a half, a sum, and squares, of the errors of (A4).",
        how=("Compute E as in the step before; the sum of its squares is `E @ E`; then the half."),
    ),
    "step-8-gradient": Stages(
        where=(
            "Step 8: V multiplied out has three terms. (A6) differentiates each; mind the 1/2 before the bracket "
            "and the sign of the middle term."
        ),
        how=(
            "Y'Y does not depend on theta; the middle term gives a multiple of Phi'Y, the last one of Phi'Phi "
            "theta; the 1/2 cancels a 2 in both. Compare with differences of `loss`."
        ),
    ),
    "step-9-minimum": Stages(
        where=(
            "Step 9, eq. (8): which factor is transposed, what is inverted, and which products are `@`? Print "
            "the shapes."
        ),
        how=("Phi'Phi is p by p, Phi'Y has p entries: solve the first against the second, `np.linalg.solve(A, b)`."),
    ),
    "step-9-unique": Stages(
        where=(
            "Step 9, last part: unique if no column is a combination of the others. Equations and unknowns need "
            "not be equal in number."
        ),
        how=(
            "Compare the rank of Phi, `np.linalg.matrix_rank(Phi)`, with its number of columns, `Phi.shape[1]`, "
            "and return True or False."
        ),
    ),
}
