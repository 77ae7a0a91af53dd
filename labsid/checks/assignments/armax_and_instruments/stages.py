"""The hints of the lecture on coloured noise, in stages: where to look, then what to do."""

from labsid.checks.question import Stages

STAGES = {
    "ai-1-tables": Stages(
        where=(
            "Step 1: the row of y(t) is [-y(t-1), u(t-1)]; every record has its own noise, from one generator "
            "made before the loop."
        ),
        how=(
            "Two columns without the last sample against y[1:]. In a loop of 100 or more call `make_record` with "
            "the same rng, c = 0 or -0.8, take its first two results, and collect fit_arx of them as rows."
        ),
    ),
    "ai-2-bias": Stages(
        where=(
            "Step 2: three vectors, one number for each parameter: so every mean and spread goes over the "
            "records, the rows. Work the four numbers of the case by hand."
        ),
        how=(
            "`np.mean(..., axis=0)` less the truth; `np.std(..., axis=0, ddof=1)`; the second over the root of "
            "the number of rows. By hand: 0.1, 0.163, 0.082."
        ),
    ),
    "ai-3-limit": Stages(
        where=(
            "Step 3: the shift is the inverse of E(phi phi') times E(phi v), and phi begins with -y(t-1). The "
            "variance of y is printed above."
        ),
        how=(
            "Solve the last equation for var_y: divide by 1 - a^2. E(phi v) = [-c var_e, 0]; divide by var_y and "
            "add to [a, b]. For System 2 var_y is 4.704."
        ),
    ),
    "ai-4-covariance": Stages(
        where=(
            "Step 4: the first formula, with E(vv') of three diagonals: (1 + c^2) on it, c beside it on both "
            "sides, times var_e."
        ),
        how=(
            "Build the N by N matrix with np.eye(N), np.eye(N, k=1) and np.eye(N, k=-1); then inverse @ Phi' @ R "
            "@ Phi @ inverse. For Phi of three ones and c = 1 it is 10/9."
        ),
    ),
    "ai-5-armax": Stages(
        where=(
            "Step 5: the equation of the prediction error, then the numbered list 1 to 4. Which errors stand in "
            "the regressor, those of the latest theta, one sample earlier?"
        ),
        how=(
            "Errors: filter w(t) = y(t) + a y(t-1) - b u(t-1), w(0) = 0, by 1/(1 + c q^-1). Rounds: new errors "
            "each time, third column epsilon[:-1], theta + share * (new - theta). By hand: 1 and -0.5."
        ),
    ),
    "ai-6-rels": Stages(
        where=(
            "Step 6: the five lines in their order; epsilon(n) is computed with theta(n-1), and it goes into the "
            "next regressor. Row 0 is zero."
        ),
        how=(
            "Loop n from 1: phi = [-y[n-1], u[n-1], epsilon]; epsilon = y[n] - phi @ theta; P with lambda in two "
            "places; theta = theta + P @ phi * epsilon; store row n."
        ),
    ),
    "ai-6-figure-14": Stages(
        where=(
            "Step 6, Fig. 14: the three columns of theta_rels over the samples, a label below, a legend with "
            "three names."
        ),
        how=("`ax.plot(theta_rels[:, i], label=name)` for a, b and c, then `set_xlabel` and `legend`."),
    ),
    "ai-7-iterated": Stages(
        where=(
            "Step 7: z(t) = [-y_M(t-1), u(t-1)], where y_M is simulated with the latest [a, b] from u alone; "
            "then (Z'Phi)^-1 Z'Y."
        ),
        how=(
            "Start with least squares. Each round: y_M = lfilter([0, b], [1, a], u), Z like Phi with y_M for y, "
            "theta = solve(Z.T @ Phi, Z.T @ Y)."
        ),
    ),
    "ai-8-recursive": Stages(
        where=(
            "Step 8, the four lines: z stands on the left of P's correction and in the gain, phi in the error "
            "and on the right. P is not symmetric."
        ),
        how=("epsilon with phi; P - np.outer(P @ z, phi @ P) / (1 + phi @ P @ z); theta + (new P) @ z * epsilon."),
    ),
    "ai-9-likelihood": Stages(
        where=("Step 9, the equation of log L: two terms, one with N and one with the SSE; var_e is sigma^2 already."),
        how=("-N/2 log(2 pi var_e) - SSE/(2 var_e), with np.log. For the two samples worked by hand it is -2.838."),
    ),
}
