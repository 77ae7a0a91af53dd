"""The hints of the recursive lecture, in stages: where to look, then what to do."""

from labsid.checks.question import Stages

STAGES = {
    "ri-1-mean": Stages(
        where=(
            "Step 1, the last equation: old mean plus gain times prediction error. What does n count, and what "
            "is the error?"
        ),
        how=(
            "theta is the old mean; the error is y - theta; the gain is 1/n with the new sample counted. For 1, "
            "2, 6 the means are 1, 1.5, 3."
        ),
    ),
    "ri-2-information": Stages(
        where=(
            "Step 2, (7) and (8): one sample adds a matrix to M and a vector to v. For flat arrays `phi @ phi.T` "
            "is a number."
        ),
        how=(
            "M grows by `np.outer(phi, phi)`, v by phi times the number y. The two samples worked by hand must "
            "give [[5, 3], [3, 2]] and [7, 4]."
        ),
    ),
    "ri-3-step": Stages(
        where=(
            "Step 3, (15) to (18), in this order: error, P, gain, theta. The gain takes the P *after* the "
            "sample. Example 5-2 has every number."
        ),
        how=(
            "Compute P_phi = P @ phi; subtract np.outer(P_phi, P_phi) / (1 + phi @ P_phi), with brackets; then K "
            "= new P @ phi; theta + K * error. For Example 5-2: 521 below, K = [1.1516, 0.7678]."
        ),
    ),
    "ri-4-regressors": Stages(
        where=(
            "Step 4: the row of y(t) is [-y(t-1), -y(t-2), u(t-1)], from the third sample on. Which slice is one "
            "sample older than y[2:], which two?"
        ),
        how=(
            "y[2:] is Y; one sample older is `y[1:-1]`, two samples older `y[:-2]`, for u likewise. Both y "
            "columns have a minus."
        ),
    ),
    "ri-5-forgetting": Stages(
        where="Step 5: lambda stands in two places of P, and the history has the estimate *after* each row.",
        how=(
            "Per row: error, P_phi, P = (P - outer / (lam + phi @ P_phi)) / lam, theta = theta + P @ phi * error "
            "(a new array), then store. Start from zeros and LN * np.eye(p)."
        ),
    ),
    "ri-6-figures": Stages(
        where=(
            "Step 6: three columns of theta_1 in Fig. 9, of theta_099 in Fig. 10, and the columns of theta_true "
            "in another style; labels and a legend."
        ),
        how=(
            "In a loop over i = 0, 1, 2 draw `history[:, i]` with a label and `theta_true[:, i]` dashed; then "
            "labels, `legend`, for each figure in axes of its own."
        ),
    ),
    "ri-7-online": Stages(
        where=(
            "Step 7: `past` is the regressor of *this* sample; u(t) is needed for the next one only. What must "
            "the next past contain?"
        ),
        how=(
            "First the step of RLS with phi = past and lam in both places, then return np.array([-y, past[0], "
            "u]) as the new past."
        ),
    ),
    "ri-8-drift": Stages(
        where=(
            "Step 8: insert s n - L into the recursion and solve for L; the mean squared error is L^2 plus the "
            "variance given there."
        ),
        how=(
            "L = lambda L + lambda s, so L (1 - lambda) = lambda s. Then compute the error on a grid of lambda "
            "in steps of 0.001, and return the lambda with the smallest, not its index."
        ),
    ),
    "ri-9-windup": Stages(
        where=(
            "Step 9, the rule in the middle: before each sample trace(P)/lam is compared with the bound; over it "
            "this sample is used with lambda = 1."
        ),
        how=(
            "In the loop of `rls`: `now = 1.0 if np.trace(P) / lam > bound else lam`, and `now` in both places "
            "of lambda. Store theta and the trace of the P after the update."
        ),
    ),
    "ri-10-careless": Stages(
        where=(
            "Step 10, the printed form: K from the old P, then theta, then P = (P - K (P phi)')/lambda, with "
            "nothing made symmetric."
        ),
        how=(
            "P_phi once; K = P_phi / (lam + phi @ P_phi); np.outer(K, P_phi) in the update; the asymmetry is the "
            "largest |P - P'| over the largest |P|, after it."
        ),
    ),
}
