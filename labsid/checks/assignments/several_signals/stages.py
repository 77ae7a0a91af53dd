"""The hints of the assignment on several signals, in stages: where to look, then what to do."""

from labsid.checks.question import Stages

STAGES = {
    "sev-1-read": Stages(
        where="Step 1, the names of the columns: which are powers, which are temperatures? Print `record`.",
        how=(
            '`load_record("TwoHeaters.csv", inputs=..., outputs=...)`, each with two names in one text, separated by a '
            "comma. Then take `u`, `y` and `Ts` of it as they are, without indices."
        ),
    ),
    "sev-2-offsets": Stages(
        where="Step 2, the hint: the rest ends at the first sample at which *any* input differs from its first value.",
        how=(
            "One number n for the whole record. Then `u - u[0]`, and y minus the means of its first n rows, one "
            "for each column: `axis=0`."
        ),
    ),
    "sev-3-phi": Stages(
        where="Step 3, the row of Phi: n columns of y_i, then n of u_1, then n of u_2. Which sample has the first row?",
        how=(
            "List the signals first, `[y[:, i], *u.T]`. For each signal, and for each lag from 1 to n, one column "
            "`x[n - lag : N - lag]`; `np.column_stack` puts them side by side. Y is `y[n:, i]`."
        ),
    ),
    "sev-4-theta": Stages(
        where="Step 4: a loop over the outputs, with `Phi, Y = regressor(u, y, i, n)` in it and one theta from each.",
        how=(
            "Start with an empty list, append `np.linalg.lstsq(Phi, Y)[0]` for each output, and return "
            "`np.array` of the list."
        ),
    ),
    "sev-5-run": Stages(
        where=(
            "Step 5: which entries of theta belong to which input? Those of input j are n + j n to n + (j + 1) n - 1."
        ),
        how=(
            "One `lfilter` for each input, with `np.r_[0, b]` and `np.r_[1, -theta[:n]]`, added up. Or a loop over "
            "k from 0 in which a lag before sample 0 counts as zero."
        ),
    ),
    "sev-6-reference": Stages(
        where="Step 6, the last formula: Phi holds y and u, Z holds r at two lags, and all start at k = 2.",
        how=(
            "With N samples, the column of lag 1 is `x[1:-1]` and that of lag 2 `x[:-2]`; Y is `y[2:]`. Then "
            "`np.linalg.solve(A, B)` with A = Z'Phi and B = Z'Y."
        ),
    ),
}
