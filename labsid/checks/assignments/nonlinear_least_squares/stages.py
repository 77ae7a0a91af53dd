"""The hints of the nonlinear lecture, in stages: where to look, then what to do."""

from labsid.checks.question import Stages

STAGES = {
    "nl-1-logarithm": Stages(
        where=(
            "Step 1: ln y = a x + c is a line; its constant is ln b. Which logarithm, and what remains to be "
            "done with c?"
        ),
        how=(
            "Fit a line with the columns x and ones to np.log(y); return its slope, and e to the power of its "
            "constant. The case by hand gives 0.693 and 1.587."
        ),
    ),
    "nl-2-jacobian": Stages(
        where=(
            "Step 2: column 1 is the derivative for a, column 2 for b; the gradient is -2 J'e with e = y - g(theta)."
        ),
        how=(
            "d/da of b e^(ax) brings x down and keeps b; d/db leaves e^(ax). Stack both as columns. Compare each "
            "with (g(theta + h) - g(theta)) / h."
        ),
    ),
    "nl-3-gauss-newton": Stages(
        where=(
            "Step 3, the framed line: e and J at the present theta, s from linear least squares, theta + s; the "
            "path begins with theta0."
        ),
        how=(
            "In each step compute e = y - g(theta) and J = jacobian(theta) anew, s = lstsq(J, e)[0], theta = "
            "theta + s (not +=), append. The table by hand: 1, 1.4, 1.3674."
        ),
    ),
    "nl-4-damping": Stages(
        where=(
            'Step 4, the framed equation, then "Accept or reject": D is a diagonal matrix; a step counts only if '
            "the SSE gets smaller."
        ),
        how=(
            "Solve J'J + mu * np.diag(np.diag(J'J)) against J'e. In the loop: trial = theta + s; smaller SSE: "
            "take it, mu/10; else keep theta, mu*10; go on until the step is tiny."
        ),
    ),
    "nl-5-exponential": Stages(
        where=(
            "Step 5: `least_squares` is handed the errors, not their squares, and an initial value; no "
            "logarithm. Then the figure: circles, two curves at `grid`, labels, legend."
        ),
        how=(
            "The errors are theta[1] * np.exp(theta[0] * x) - y; start at [0, 1]; take `.x`. Draw b e^(a x) for "
            "both thetas at `grid`."
        ),
    ),
    "nl-6-frequency": Stages(
        where=(
            "Step 6: for each frequency A and B follow by linear least squares; the SSE over the frequency has "
            "many valleys. Scan first, then refine."
        ),
        how=(
            "Several hundred frequencies from low to high, for each the SSE with columns sin and cos, the best "
            "by argmin; then `least_squares` for [w, A, B] from there; return w."
        ),
    ),
    "nl-7-locate": Stages(
        where=(
            "Step 7: the errors are distance minus range; there may be two valleys, one on each side of the beacons."
        ),
        how=(
            "Distances by `np.linalg.norm(beacons - theta, axis=1)`. Start from several places around the "
            "beacons, at about the mean range, and keep the result with the smallest `cost`."
        ),
    ),
    "nl-7-layout": Stages(
        where=(
            "Step 7, last part: what matters is what the *differences* of the beacons span: a plane, a line or nothing."
        ),
        how=(
            "Subtract one beacon from all; `np.linalg.matrix_rank(..., tol=1e-9)` is 2, 1 or 0; return the text "
            "that belongs to it."
        ),
    ),
    "nl-8-step": Stages(
        where=(
            "Step 8: three parameters [y0, K, tau], the model printed there; then s^2 = SSE/(n - p), the inverse "
            "of J'J, its diagonal, the root."
        ),
        how=(
            "Start from y[0], (y[-1] - y[0])/amplitude and a fifth of the time. scipy's `cost` is half the SSE. "
            "stderr = sqrt(diag(s2 * inv(J'J)))."
        ),
    ),
    "nl-9-output-error": Stages(
        where="Step 9: the errors are y less a *simulation* on u alone; no measured output stands in it.",
        how=(
            "Simulate with lfilter([0, b], [1, a], u), hand its difference to y to `least_squares`, and start "
            "from the one-step estimate."
        ),
    ),
}
