"""The hints of the sim-to-real gap, in stages: where to look, then what to do."""

from labsid.checks.question import Stages

STAGES = {
    "gap-1-rest": Stages(
        where=(
            "Step 1: the rest is the samples before the input first changes. Offsets, mean and standard "
            "deviation are all taken there."
        ),
        how=(
            "Count the samples n up to the first change; u_offset is the first input, y_offset the mean and "
            "noise_sd the standard deviation of y_act[:n]; subtract the offsets from the whole signals."
        ),
    ),
    "gap-2-linear": Stages(
        where=(
            "Step 2: theta_arx is the lab's estimate on the first half; `fit` then searches from it with "
            "`free_run`; y_lin is the run over the whole input."
        ),
        how=(
            "Phi by four slices of the first half, lstsq against y[2:half]; fit(free_run, theta_arx, u[:half], "
            "y[:half]); free_run(theta_hat, u)."
        ),
    ),
    "gap-3-size": Stages(
        where=(
            "Step 3, the RMSE: over the second half only; square, mean, root, in this order. Nothing else is "
            "subtracted."
        ),
        how=("Take `e[half:]`, square it, average, and take the root."),
    ),
    "gap-3-time": Stages(
        where=(
            "Step 3: stretches of neighbouring samples; the sum of squares in each over the sum of all. `worst` "
            "is two times, in seconds."
        ),
        how=(
            "`np.reshape(e, (parts, -1))` has one stretch in each row, for any `parts`; square, add up along the "
            "rows, divide by the total. The largest is stretch i = argmax: it begins at i * N / 16 * Ts."
        ),
    ),
    "gap-4-frequency": Stages(
        where="Step 4: |E|^2 of each frequency in Hz, added up in each band, over the sum of all bands.",
        how=(
            "f = np.fft.rfftfreq(len(e), Ts), weights np.abs(np.fft.rfft(e))**2, then np.histogram(f, edges, "
            "weights=...)[0], divided by its sum."
        ),
    ),
    "gap-5-operating": Stages(
        where=(
            "Step 5: samples are sorted by x, and each counts with its squared error; the sum over all in the "
            "denominator. Which x for share_u, which for share_y?"
        ),
        how=(
            "`np.histogram(x, edges, weights=e**2)[0]` over its sum. Hand over u_act with edges_u, and y_act "
            "with edges_y."
        ),
    ),
    "gap-7-simulation": Stages(
        where=(
            "Step 7, the two rules: all parameters refitted together, judged on the held-out half. The folds: "
            "where the fit may get stuck, and how a delay is tried."
        ),
        how=(
            "One function model(q, u) for each hypothesis that is left, initial values inside the range that is "
            "used, fit on the first half, held_out for each; the best goes into simulate_better, with u_offset "
            "taken off and y_offset put back."
        ),
    ),
    "gap-8-effect": Stages(
        where=(
            "Step 8 and the table at the top: the name as it is written there, in quotes. Your evidence is the "
            "held-out RMSE of each hypothesis."
        ),
        how=(
            "Take the name of the hypothesis whose held-out RMSE is smallest; if two are close, look at where "
            "each still errs."
        ),
    ),
    "gap-8-path": Stages(
        where="The first column of the table at the top: the place of the effect that you named.",
        how=('One of three texts, "input", "dynamics" or "output", for the row of your effect.'),
    ),
    "gap-8-parameters": Stages(
        where="Step 8: names and units of the table; voltages as measured, offset included; a delay in seconds.",
        how=(
            "Your fit has deviations from rest: add u_offset to input levels, y_offset to output levels; times "
            "Ts for a delay in samples; the smaller limit is `low`."
        ),
    ),
    "gap-9-closed": Stages(
        where=(
            "Step 9, the framed formula: mean *squares* of the held-out half, the noise squared taken off both, "
            "then the roots. gap_before is a root."
        ),
        how=(
            "Try the function on the case by hand, squares of 0.05 and 0.013 with 0.012: 0.897. Then hand it the "
            "mean square of simulate_better(u_act) - y_act on the second half, and gap_before squared."
        ),
    ),
}
