"""The hints of the least-squares lecture, in stages: where to look, then what to do."""

from labsid.checks.question import Stages

STAGES = {
    "ls-1-kind": Stages(
        where=(
            "Step 1: the signs of the eigenvalues decide, of the *symmetric part* of M; the fold tells what "
            "happens to a zero."
        ),
        how=(
            "Take the eigenvalues of (M + M')/2 with `eigvalsh`, smallest first. Treat what is below 1e-10 of "
            "the largest as zero. Then decide by the smallest and the largest one, in five cases."
        ),
    ),
    "ls-2-delays": Stages(
        where=(
            "Step 2, the matrix of Example 2-3: its first column is u itself, every next one is one sample "
            "later, with zeros on top."
        ),
        how=(
            "Begin with a matrix of zeros, as many rows as u, n columns; into column i, from row i on, goes u "
            "without its last i samples, `u[: len(u) - i]`."
        ),
    ),
    "ls-3-derivatives": Stages(
        where=(
            "Step 3, examples 2 and 3, and the case by hand: x_k stands in row k and in column k of the double "
            "sum; the cubic is a number times a vector."
        ),
        how=(
            "For the form add the contributions of row and column, A and A'. For the cubic use the product rule: "
            "x'x times the identity, and x times the derivative of x'x as a row."
        ),
    ),
    "ls-4-fits": Stages(
        where=(
            "Step 4: one column for each power, in the order of `powers`; then theta, then the sum of the "
            "squares of y - Phi theta. Which names in your function come from outside?"
        ),
        how=(
            "`np.column_stack([x**p for p in powers])` makes Phi from the arguments; solve for theta; E = y - "
            "Phi @ theta; return theta and E @ E."
        ),
    ),
    "ls-4-figure-5": Stages(
        where=(
            "Step 4, Fig. 5: five circles, two curves evaluated at `grid`, two labels, a legend with three entries."
        ),
        how=(
            '`ax.plot(u_1, y_1, "o", label=...)` for the points; `np.polyval(theta_line, grid)` and the parabola '
            "in the same way for the curves; then labels and legend."
        ),
    ),
    "ls-5-projector": Stages(
        where=(
            "Step 5, the formula under the brace: which shape has each factor? P is N by N, Phi stands on the "
            "outside left."
        ),
        how=(
            "Phi is N by p, the inverse in the middle p by p, Phi' on the right p by N: multiply in this order "
            "with `@`."
        ),
    ),
    "ls-6-all-solutions": Stages(
        where=(
            "Step 6: the shortest solution comes from the pseudo-inverse; the directions are columns of V with a "
            "zero singular value. The fold says what numpy returns."
        ),
        how=(
            "theta = pinv(Phi) @ Y. `np.linalg.svd(Phi)[2]` is V transposed: its rows from the rank on, "
            "transposed, are the columns of N. Return theta first."
        ),
    ),
    "ls-7-known": Stages(
        where=(
            "Step 7, Example 1: the equation for k = 4 is y(4) + a y(2) = u(3) + b u(1). What is known goes to "
            "the left side."
        ),
        how=(
            "With u[0] = u(1), the row for k = 4 is [-y[1], u[0]] and its left side y[3] - u[2]. Each column is "
            "the slice that begins there; all have N - 3 entries."
        ),
    ),
    "ls-8-weighted": Stages(
        where=("Step 8: each equation, both its sides, is divided by its sigma. The fold says how rows are divided."),
        how=("Divide Phi by sigma as a column, `sigma[:, np.newaxis]`, and Y by sigma; then ordinary least squares."),
    ),
    "ls-9-constrained": Stages(
        where=(
            "Step 9, the matrix of matrices: what stands in its four corners, and what on its right side, top "
            "and bottom?"
        ),
        how=(
            "`np.block` of Phi'Phi, A', A and zeros of r by r; the right side is Phi'Y followed by b; solve, and "
            "keep the first p numbers."
        ),
    ),
    "ls-10-confidence": Stages(
        where=(
            "Step 10: sigma^2 = SSE/(N - p); covariance; root of its diagonal; quantile at (1 + level)/2. "
            "Compute the example by hand with your lines, one by one."
        ),
        how=(
            "Example 2-1 must give 0.433, then 0.0439 as the first entry of the inverse, 0.138 as the standard "
            "error, 3.18 as the quantile, 0.44 as the half width. Where does yours differ first?"
        ),
    ),
    "ls-11-cayley-hamilton": Stages(
        where=(
            "Step 11, Cayley-Hamilton: multiply the theorem by the inverse of A. Which power of A remains beside "
            "which coefficient?"
        ),
        how=(
            "A^-1 = -(A^(n-1) + c_1 A^(n-2) + ... + c_(n-1) I)/c_n. `np.poly(A)` gives [1, c_1, ..., c_n]; w[0] "
            "belongs to I. Try the 2 by 2 example."
        ),
    ),
}
