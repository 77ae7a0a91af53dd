"""The hints of the pre-lab, in stages: where to look, then what to do."""

from labsid.checks.question import Stages

STAGES = {
    "prelab-1-time": Stages(
        where=(
            "Step 1: the number of points is the number of intervals and one more, and the table of shapes says "
            "how a flat array becomes a column."
        ),
        how=(
            "Count the intervals, 100 s / 0.1 s, add one, make the points with `np.linspace(first, last, "
            "number)`, and end with `.reshape(-1, 1)`. Print `t.shape`, `t[0]` and `t[-1]`."
        ),
    ),
    "prelab-2-noise": Stages(
        where=(
            "Step 2: the angle is 2 pi t / T with T = 100 s, in radians; the noise is a separate array that is "
            "added. Look at both parts one by one."
        ),
        how=(
            "Print `y1 - np.sin(2 * np.pi * t / 100)`: what is left must be the noise alone, of shape `t.shape`, "
            "between -0.2 and 0.2. `rng.uniform(low, high, shape)` draws it; draw anew for `y2`."
        ),
    ),
    "prelab-3-cut": Stages(
        where=(
            "Step 3: rows are counted from 0, so the first 200 samples are the rows 0 to 199. What goes from `t` "
            "goes from `y1` and `y2` as well."
        ),
        how=(
            "An open slice, `A[first:]`, keeps everything from a row on. From the times that are left subtract "
            "the first of them, as a new array: `t_new = ... - ...`, not `t_new -= ...`."
        ),
    ),
    "prelab-4-matrix": Stages(
        where=(
            "Step 4, the equation for data_new: three columns side by side, in the order t_new, y1_new, y2_new. "
            "The table at the top has MATLAB's `[a b c]`."
        ),
        how=(
            "Hand the three columns over together, in a list: `np.hstack([...])`. Print the shape: as many rows "
            "as `t_new`, and three columns."
        ),
    ),
    "prelab-4-function": Stages(
        where=(
            "Step 4, the function: it must work for any `data` and any `n`, so only these two names may stand in "
            "it. Go through its lines: which rows stay, and what happens to the first column?"
        ),
        how=(
            "Try it by hand on `data = np.array([[5., 1.], [6., 2.], [7., 3.]])` with `n = 1`: two rows stay, "
            "and their times must become 0 and 1. Copy the rows that stay, then subtract from their first column "
            "its own first entry."
        ),
    ),
    "prelab-5-original": Stages(
        where=(
            "Step 5, the list of what Fig. 1(a) has: the axes `ax_a`, the kind of each curve, limits, title, "
            "grid, labels, legend. Check your lines against it from the top."
        ),
        how=(
            'Draw with the methods of `ax_a`: `ax_a.plot` for the sine, `ax_a.step(..., where="post")` for the '
            "cosine, each with `label=`, then the `set_` methods, `grid` and `legend`. Run the line that makes "
            "the figure again before you draw again."
        ),
    ),
    "prelab-6-cut-off": Stages(
        where=(
            "Step 6: the same list as for Fig. 1(a), in `ax_b`, with t_new, y1_new and y2_new. Old curves stay "
            "in the axes until the cell of step 5 makes a new figure."
        ),
        how=(
            "Copy your lines of step 5, replace `ax_a` by `ax_b`, each signal by its `_new` one and the title. "
            "Then run the cell of step 5 and this one, once each."
        ),
    ),
}
