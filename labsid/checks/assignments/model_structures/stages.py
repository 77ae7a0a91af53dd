"""The hints of the lecture on model structures, in stages: where to look, then what to do."""

from labsid.checks.question import Stages

STAGES = {
    "ms-2-shift": Stages(
        where=("Step 2, the table by hand: the delayed signal begins with a zero, and the result is as long as x."),
        how=(
            "Add to an array of zeros, from sample i on, P[i] times x without its last i samples. With [1, -0.8] "
            "and [5, 4, 6, 0] you must get [5, 0, 2.8, -4.8]."
        ),
    ),
    "ms-3-state-space": Stages(
        where=(
            "Step 3, the canonical form: pad num in front, divide both by den[0], then the last row of A (from "
            "-a_n to -a_1), C with b_i - b0 a_i, D = b0."
        ),
        how=(
            "Make a and b of equal length n + 1 first. `np.eye(n, k=1)`, then its last row; C and the last row "
            "both run backwards, without the entry 0. Try (z - 1)/(z - 0.9)."
        ),
    ),
    "ms-4-equations": Stages(
        where=(
            "Step 4: the row is [-y(k-1), ..., u(k-d), ..., u(k-d-nb+1)], from k0 = max(na, d + nb - 1) on, or "
            "na where nb = 0."
        ),
        how=(
            "The column of lag i is `x[k0 - i : len(x) - i]`: with a minus for y and i = 1 to na, then for u and "
            "i = d to d + nb - 1. Y is `y[k0:]`. Write the row of k0 by hand for na = nb = d = 1."
        ),
    ),
    "ms-5-simulate": Stages(
        where=(
            "Step 5: y(k) = B u(k) + C e(k) - a1 y(k-1) - ...: the noise goes through 1/A, too. What does the "
            "first sample get?"
        ),
        how=(
            "Filter u by B and e by C, add, and filter the sum by 1/A: `lfilter([1], A, ...)`. Or loop from k = "
            "0, with nothing for indices below zero."
        ),
    ),
    "ms-5-example-3-1": Stages(
        where="Step 5, Example 3-1: the row of y(t) is [-y(t-1), u(t-1)], the answer [a, b].",
        how=("Two columns without the last sample, -y[:-1] and u[:-1], against y[1:]; use the arguments u and y."),
    ),
    "ms-6-predict": Stages(
        where=(
            "Step 6, the two equations: which outputs stand on the right side, the measured or the model's own? "
            "Work the case by hand with both functions."
        ),
        how=(
            "Prediction: B u - A y + y, all by `lfilter` with the denominator [1]. Free run: `lfilter(B, A, u)`. "
            "For u = 1, 1, 0 and y = 0, 2, 3 sample 2 is 2.6 and 1.8."
        ),
    ),
    "ms-6-figure-8": Stages(
        where=(
            "Step 6, Fig. 8: the first 100 samples of three signals, against `t_8`, with labels and a legend "
            "that names them."
        ),
        how=("Three calls of `ax.plot(t_8, signal[:100], label=...)`, the two `set_` labels, and `ax.legend()`."),
    ),
    "ms-7-excitation": Stages(
        where=(
            "Step 7: the order is the last n for which the matrix with n columns of recorded samples has full "
            "column rank. No zeros are filled in."
        ),
        how=(
            "For n = 1, 2, ... make the n columns `u[n - 1 - i : len(u) - i]`; stop at the first whose "
            "`matrix_rank` is below n, and return the n before. A constant gives 1, a sinusoid 2."
        ),
    ),
    "ms-8-order": Stages(
        where=(
            "Step 8: all models on the same outputs, those from max(orders) on; the loss is a mean. AIC, BIC and "
            "FPE as printed, with the natural logarithm."
        ),
        how=(
            "With start = max(orders), lag i is `x[start - i : len(x) - i]` for every n. Check the criteria with "
            "the numbers worked by hand: N = 100, V = 0.97, p = 6 gives 8.95, 24.6 and 1.094."
        ),
    ),
    "ms-9-cancel": Stages(
        where=(
            "Step 9: roots of both, pairs nearer than `within` cancel one for one, and the rest becomes a "
            "polynomial again. Work the case by hand with your lines."
        ),
        how=(
            "Take a list of the roots of P; for each root of Q look for the nearest in that list, by `abs`; "
            "remove it if it is near enough, else keep the root of Q. `np.poly` of both lists, real parts."
        ),
    ),
    "ms-10-autocorrelation": Stages(
        where=(
            "Step 10, the formula: the mean is removed once, the numerator has N - k products, the denominator "
            "is the same for all k."
        ),
        how=(
            "Centre e, then for each k the product of `e[k:]` and `e[: N - k]`, all divided by e @ e. For 1, 2, "
            "0, -3 you must get 1, 0.143, -0.429."
        ),
    ),
}
