"""Answers to the lecture on model structures that differ from the model solution, right ones and wrong ones."""

from variants import Right, Wrong, right, wrong
from variants._model_structures_cells import (
    BACK,
    CENTRED,
    CRITERIA,
    LOOP_SHIFT,
    NEAREST,
    OUTPUTS,
    OWN_EQUATIONS,
    PADDED,
    PAIRS,
    SUMS,
    cancel,
    define,
    equations,
    excitation,
    figure,
    loop_simulate,
    order,
    predict,
    shift,
    simulate,
    states,
    table,
    white,
)

SHIFT, STATES, EQUATIONS, SIMULATE = "ms-2-shift", "ms-3-state-space", "ms-4-equations", "ms-5-simulate"
TABLE, PREDICT, FIGURE, EXCITATION = "ms-5-example-3-1", "ms-6-predict", "ms-6-figure-8", "ms-7-excitation"
ORDER, CANCEL, WHITE = "ms-8-order", "ms-9-cancel", "ms-10-autocorrelation"


VARIANTS: list[Right | Wrong] = [
    # 2. the shift operator
    right(SHIFT, "beginning of the convolution", shift("return np.convolve(P, x)[: len(x)]")),
    right(SHIFT, "lfilter, as a column", shift("return scipy.signal.lfilter(P, [1], x).reshape(-1, 1)")),
    right(SHIFT, "two loops and a list", shift(LOOP_SHIFT.format(condition="k >= i", index="k - i"))),
    wrong(SHIFT, "whole convolution", shift("return np.convolve(P, x)"), "tail not cut off", "first len"),
    wrong(SHIFT, "valid part", shift("return np.convolve(P, x, 'valid')"), "first samples left out", "zero"),
    wrong(SHIFT, "same part", shift("return np.convolve(P, x, 'same')"), "middle of the convolution", "same"),
    wrong(
        SHIFT,
        "roll",
        shift("return sum(P[i] * np.roll(x, i) for i in range(len(P)))"),
        "index wraps around",
        "np.roll",
    ),
    wrong(
        SHIFT,
        "negative index",
        shift(LOOP_SHIFT.format(condition="True", index="k - i")),
        "index wraps around",
        "negative",
    ),
    wrong(
        SHIFT,
        "forward shift",
        shift(LOOP_SHIFT.format(condition="k + i < len(x)", index="k + i")),
        "shifted the wrong way",
        "before",
    ),
    wrong(SHIFT, "reversed", shift("return np.convolve(P[::-1], x)[: len(x)]"), "coefficients in reverse order", "P.0"),
    wrong(
        SHIFT,
        "one lag too many",
        shift(LOOP_SHIFT.format(condition="k >= i + 1", index="k - i - 1")),
        "lag off by one",
        "x.k. itself",
    ),
    wrong(SHIFT, "denominator", shift("return scipy.signal.lfilter([1], P, x)"), "output fed back", "numerator"),
    wrong(
        SHIFT,
        "loop from the longest lag",
        shift("y = np.convolve(P, x)[: len(x)]\ny[: len(P) - 1] = 0\nreturn y"),
        "first samples left at zero",
        "before",
    ),
    wrong(SHIFT, "first coefficient only", shift("return P[0] * x"), "first coefficient only", "each coefficient"),
    wrong(SHIFT, "no return", shift("np.convolve(P, x)"), "no return", "return"),
    # 3. state space
    right(STATES, "scipy's tf2ss", define("state_space(num, den)", "return scipy.signal.tf2ss(num, den)")),
    right(STATES, "a system of python-control", states(result="ct.ss(A, B, C, D, 1)")),
    right(
        STATES,
        "observable form",
        states(result="A.T, C.reshape(n, 1), B.T, np.array([[D]])"),
    ),
    right(STATES, "flat B and C, a number for D", states(result="A, B.ravel(), C, D")),
    wrong(STATES, "+a in the last row", states(last="a[:0:-1]"), "sign of a", "other sign"),
    wrong(STATES, "C not corrected", states(C="b[:0:-1]"), "direct path not taken out", "b0 a_i"),
    wrong(STATES, "D zero", states(D="0.0"), "direct path left out", "D = b0"),
    wrong(STATES, "D zero, C plain", states(C="b[:0:-1]", D="0.0"), "direct path left out", "D = b0"),
    wrong(
        STATES,
        "neither divided",
        states(a="np.r_[1, den[1:]]", b="np.r_[np.zeros(n + 1 - len(num)), num]"),
        "not divided by den[0]",
        "divide num",
    ),
    wrong(
        STATES,
        "num not divided",
        states(b="np.r_[np.zeros(n + 1 - len(num)), num]"),
        "not divided by den[0]",
        "divide num",
    ),
    wrong(
        STATES,
        "num padded behind",
        states(b="np.r_[num, np.zeros(n + 1 - len(num))] / den[0]"),
        "num padded on the wrong side",
        "in front",
    ),
    wrong(STATES, "C backwards", states(C="(b - b[0] * a)[1:]"), "order of C", "reverse"),
    wrong(STATES, "last row backwards", states(last="-a[1:]"), "order of the last row", "reverse"),
    wrong(
        STATES,
        "three matrices",
        states(result="A, B, C.reshape(1, n)"),
        "incomplete result",
        "four matrices",
    ),
    wrong(STATES, "C as a column", states(result="A, B, C.reshape(n, 1), D"), "rows instead of columns", "shape"),
    # 4. equations
    right(EQUATIONS, "an index array", equations()),
    right(EQUATIONS, "no input lags without inputs", equations(k0="max([na] + list(range(d, d + nb)))")),
    wrong(
        EQUATIONS,
        "input lags without inputs",
        equations(k0="max(na, d + nb - 1)"),
        "lags of inputs that are not there",
        "no inputs",
    ),
    wrong(EQUATIONS, "one row short", equations(k0="max(na, d + nb)"), "first rows left out", "begins later"),
    right(
        EQUATIONS,
        "row by row, Y a column",
        define(
            "equations(u, y, na, nb, d)",
            "k0 = max(na, d + nb - 1) if nb else na\nrows = [[-y[k - i] for i in range(1, na + 1)]\n"
            "        + [u[k - d - i] for i in range(nb)] for k in range(k0, len(y))]\n"
            "return np.array(rows), y[k0:].reshape(-1, 1)",
        ),
    ),
    wrong(EQUATIONS, "the lab's sign", equations(past="y[k - i]"), "sign of a", "lab"),
    wrong(EQUATIONS, "u and y swapped", equations(past="-u[k - i]", inputs="y[k - i]"), "u and y swapped", "swapped"),
    wrong(
        EQUATIONS,
        "inputs first",
        equations(result="np.column_stack(c2 + c1), y[k0:]"),
        "inputs before outputs",
        "theta",
    ),
    wrong(EQUATIONS, "delay one always", equations(lags="range(1, nb + 1)"), "delay not used", "first is u.k-d"),
    wrong(
        EQUATIONS,
        "delay from d + 1",
        equations(lags="range(d + 1, d + nb + 1)", k0="max(na, d + nb)"),
        "lag off by one",
        "first is u.k-d",
    ),
    wrong(EQUATIONS, "y(k) in its own row", equations(y_lags="range(na)"), "lag off by one", "y.k. in the row"),
    wrong(EQUATIONS, "rows before k0", equations(k0="max(na, nb)"), "rows before k0", "nobody recorded"),
    wrong(EQUATIONS, "all rows", equations(k0="0"), "index wraps around", "goes round"),
    wrong(
        EQUATIONS,
        "SUSTech's q",
        equations(lags="(range(d, d + nb + 1) if nb else [])"),
        "nb taken for the largest lag",
        "column too many",
    ),
    wrong(
        EQUATIONS,
        "rows lie down",
        equations(result="np.array(c1 + c2), y[k0:]"),
        "rows instead of columns",
        "transpose it",
    ),
    wrong(
        EQUATIONS, "Y has all samples", equations(result="np.column_stack(c1 + c2), y"), "unequal rows", "one y.k. for"
    ),
    wrong(
        EQUATIONS,
        "Y one sample early",
        equations(result="np.column_stack(c1 + c2), y[k0 - 1 : -1]"),
        "Y is not y(k)",
        "is right.*1 sample early",
    ),
    wrong(
        EQUATIONS,
        "Y first",
        equations(result="y[k0:].reshape(-1, 1), np.column_stack(c1 + c2)"),
        "Phi and Y swapped",
        "before",
    ),
    wrong(
        EQUATIONS,
        "oldest first",
        equations(y_lags="range(na, 0, -1)", lags="range(d + nb - 1, d - 1, -1)"),
        "oldest lag first",
        "newest",
    ),
    # 5. simulate
    right(SIMULATE, "loops", loop_simulate()),
    right(SIMULATE, "both through 1/A", simulate("return lfilter(B, A, u) + lfilter(C, A, e)")),
    right(
        SIMULATE,
        "apply and a loop",
        simulate(
            "y = np.zeros(len(u))\nw = np.convolve(B, u)[: len(u)] + np.convolve(C, e)[: len(u)]\n"
            "for k in range(len(u)):\n"
            "    y[k] = w[k] - sum(A[i] * y[k - i] for i in range(1, min(len(A), k + 1)))\nreturn list(y)"
        ),
    ),
    wrong(SIMULATE, "+a", loop_simulate(sign="+"), "sign of a", "minus"),
    wrong(SIMULATE, "noise behind", simulate("return lfilter(B, A, u) + e"), "noise added at the output", "1/A"),
    wrong(
        SIMULATE,
        "coloured noise behind",
        simulate("return lfilter(B, A, u) + lfilter(C, [1], e)"),
        "noise added at the output",
        "1/A",
    ),
    wrong(SIMULATE, "C not used", simulate("return lfilter(B, A, u) + lfilter([1], A, e)"), "C not used", "coloured"),
    wrong(SIMULATE, "no noise", simulate("return lfilter(B, A, u)"), "noise left out", "noise"),
    wrong(
        SIMULATE,
        "no past outputs",
        simulate("return lfilter(B, [1], u) + lfilter(C, [1], e)"),
        "A not used",
        "past outputs",
    ),
    wrong(
        SIMULATE,
        "late start",
        loop_simulate(first="max(len(A), len(B), len(C)) - 1"),
        "first samples left at zero",
        "at once",
    ),
    wrong(SIMULATE, "negative index", loop_simulate(inside="True"), "index wraps around", "end of the record"),
    wrong(
        SIMULATE,
        "delay twice",
        simulate("return lfilter(np.r_[0, B], A, u) + lfilter(C, A, e)"),
        "direct path lost",
        "delay is in B",
    ),
    wrong(
        SIMULATE,
        "noise without e(k)",
        simulate("c = np.array(C, float)\nc[0] = 0\nreturn lfilter(B, A, u) + lfilter(c, A, e)"),
        "C without its 1",
        "begins with 1",
    ),
    # 5. Example 3-1
    right(
        TABLE,
        "normal equations, all samples as in the notes",
        table(
            body="Phi = np.zeros((len(y), 2))\nfor i in range(1, len(y)):\n    Phi[i] = [-y[i - 1], u[i - 1]]\n"
            "return np.linalg.inv(Phi.T @ Phi) @ Phi.T @ y"
        ),
    ),
    right(TABLE, "from the third sample", table("-y[1:-1], u[1:-1]", "y[2:]")),
    right(
        TABLE,
        "the lab's sign turned round",
        table("y[:-1], u[:-1]", after="", body="").replace(
            "return np.linalg.lstsq(Phi, y[1:])[0]", "t = np.linalg.pinv(Phi) @ y[1:]\n    return -t[0], t[1]"
        ),
    ),
    wrong(TABLE, "the program of the notes", table("y[:-1], u[:-1]"), "sign of a", "Table 1"),
    wrong(TABLE, "b before a", table("u[:-1], -y[:-1]"), "order of theta", "b before a"),
    wrong(TABLE, "u and y swapped", table("-u[:-1], y[:-1]", "u[1:]"), "u and y swapped", "input comes first"),
    wrong(TABLE, "u(t)", table("-y[:-1], u[1:]"), "lag off by one", "u.t-1"),
    wrong(TABLE, "two samples back", table("-y[:-2], u[:-2]", "y[2:]"), "lag off by one", "y.t-1"),
    wrong(
        TABLE,
        "a constant as well",
        table("-y[:-1], u[:-1], np.ones(len(y) - 1)", after="[:2]"),
        "a constant fitted along",
        "constant",
    ),
    wrong(TABLE, "the variables outside", table("-y_1[:-1], u_1[:-1]", "y_1[1:]"), "arguments not used", "handed in"),
    wrong(
        TABLE,
        "all of lstsq",
        table(body="return np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1]]), y[1:])"),
        "all of lstsq",
        "its first element",
    ),
    wrong(
        TABLE,
        "no inverse",
        table(body="Phi = np.column_stack([-y[:-1], u[:-1]])\nreturn Phi.T @ y[1:]"),
        "inverse forgotten",
        "inverse",
    ),
    wrong(TABLE, "numbers of the notes", table(body="return [-0.8142, 1.0413]"), None, "least-squares"),
    wrong(
        TABLE,
        "one record for both",
        table(used="theta_1 = example_3_1(u_1, y_1)\ntheta_2 = example_3_1(u_1, y_1)\n"),
        None,
        "theta_2",
    ),
    # 6. prediction and simulation
    right(
        PREDICT,
        "loops",
        predict(
            "return np.array([past(B, u, k) - past(A, y, k) + y[k] for k in range(len(u))])",
            "y = np.zeros(len(u))\nfor k in range(len(u)):\n    y[k] = past(B, u, k) - past(A, y, k)\nreturn y",
        ),
    ),
    right(
        PREDICT,
        "filters, as columns",
        predict(
            "past_A = -np.array(A, float)\npast_A[0] = 0\n"
            "return (lfilter(B, [1], u) + lfilter(past_A, [1], y)).reshape(-1, 1)",
            "return lfilter([1], A, lfilter(B, [1], u)).reshape(-1, 1)",
            OUTPUTS.replace("u_1, y_1)", "u_1, y_1).ravel()").replace("B_1, u_1)", "B_1, u_1).ravel()"),
        ),
    ),
    wrong(
        PREDICT,
        "y(k) in place of y(k-1)",
        predict("return lfilter(B, [1], u) - lfilter(A[1:], [1], y)"),
        "lag off by one",
        r"takes y\(k\) for y\(k-1\)",
    ),
    wrong(
        PREDICT,
        "A in place of A - 1",
        predict("return lfilter(B, [1], u) - lfilter(A, [1], y)"),
        "the prediction error",
        "without y",
    ),
    wrong(
        PREDICT, "free run for both", predict("return lfilter(B, A, u)"), "simulation passed off as prediction", "meas"
    ),
    wrong(
        PREDICT,
        "variables swapped",
        predict(used=OUTPUTS.replace("y_hat", "y_tmp").replace("y_sim", "y_hat").replace("y_tmp", "y_sim")),
        "prediction passed off as simulation",
        "y_hat is the prediction",
    ),
    wrong(
        PREDICT,
        "prediction for both",
        predict(used=OUTPUTS.replace("free_run(A_1, B_1, u_1)", "y_hat")),
        "prediction passed off as simulation",
        "y_sim the free run",
    ),
    wrong(
        PREDICT,
        "+a in the predictor",
        predict("return lfilter(B, [1], u) + lfilter(A, [1], y) - y"),
        "sign of a",
        "minus",
    ),
    wrong(
        PREDICT,
        "+a in the free run",
        predict(run="return lfilter(B, np.r_[1, -np.array(A[1:])], u)"),
        "sign of a",
        "other sign",
    ),
    wrong(
        PREDICT,
        "the error",
        predict("return lfilter(A, [1], y) - lfilter(B, [1], u)"),
        "the prediction error",
        "prediction error",
    ),
    wrong(
        PREDICT,
        "A with its 1",
        predict("return lfilter(B, [1], u) - lfilter(A, [1], y) - y"),
        "output to be predicted used",
        "y.k. to predict",
    ),
    wrong(
        PREDICT,
        "late start",
        predict(
            "y_p = np.zeros(len(u))\nfor k in range(max(len(A), len(B)) - 1, len(u)):\n"
            "    y_p[k] = past(B, u, k) - past(A, y, k) + y[k]\nreturn y_p"
        ),
        "first samples left at zero",
        "before the record",
    ),
    wrong(
        PREDICT,
        "no memory in the free run",
        predict(run="return lfilter(B, [1], u)"),
        "past outputs left out",
        "memory",
    ),
    wrong(
        PREDICT,
        "extra delay in the free run",
        predict(run="return lfilter(np.r_[0, B], A, u)"),
        "lag off by one",
        "extra delay",
    ),
    # 6. Fig. 8
    right(FIGURE, "pyplot", figure().replace("fig_8, ax = plt.subplots()", "fig_8 = plt.figure()\nax = plt.gca()")),
    right(
        FIGURE,
        "names given to the legend, counted from 1",
        figure(
            "ax.plot(t_8 + 1, y_1[:100], 'k')",
            "ax.plot(t_8 + 1, y_hat[:100], '-.')",
            "ax.plot(t_8 + 1, y_sim[:100], '--')",
            "ax.legend(['y', 'one-step', 'simulated'])\nax.set(xlabel='t', ylabel='y(t)')",
        ),
    ),
    right(
        FIGURE,
        "two panels and points",
        "t_8 = np.arange(100)\nfig_8, axes = plt.subplots(2, 1)\n"
        "for ax, signal, name in zip(axes, (y_hat, y_sim), ('prediction', 'simulation')):\n"
        "    ax.scatter(t_8, y_1[:100], label='measured')\n    ax.plot(t_8, signal[:100], label=name)\n"
        "    ax.set_ylabel('y(t)')\n    ax.legend()\nax.set_xlabel('t')\n",
    ),
    wrong(FIGURE, "no simulation", figure(simulation=""), "no curve", "the simulation"),
    wrong(
        FIGURE,
        "prediction drawn twice",
        figure(simulation="ax.plot(t_8, y_hat[:100], label='Simulation')"),
        "no curve",
        "the simulation",
    ),
    wrong(
        FIGURE,
        "labels swapped",
        figure(
            prediction="ax.plot(t_8, y_hat[:100], label='Simulation')",
            simulation="ax.plot(t_8, y_sim[:100], label='Prediction')",
        ),
        "legend entries swapped",
        "swapped",
    ),
    wrong(FIGURE, "no legend", figure(rest="ax.set(xlabel='t', ylabel='y')"), "no legend", "legend"),
    wrong(FIGURE, "no labels", figure(rest="ax.legend()"), "axis without a label", "x-axis"),
    wrong(
        FIGURE,
        "all samples",
        figure(
            "ax.plot(y_1, label='y')",
            "ax.plot(y_hat, label='Prediction')",
            "ax.plot(y_sim, label='Simulation')",
        ),
        "too many samples",
        "first 100",
    ),
    # 7. excitation
    right(EXCITATION, "windows", excitation()),
    right(
        EXCITATION,
        "rank of the widest matrix",
        define(
            "excitation(u, largest)",
            "return np.linalg.matrix_rank(np.array([u[k : k + largest] for k in range(len(u) - largest + 1)]))",
        ),
    ),
    right(
        EXCITATION,
        "smallest eigenvalue with a tolerance",
        excitation(full="np.linalg.eigvalsh(W.T @ W)[0] > 1e-9 * max(1, np.linalg.norm(W) ** 2)"),
    ),
    wrong(EXCITATION, "zeros filled in", excitation(PADDED), "full rank where there is none", "jump"),
    wrong(EXCITATION, "one too high", excitation(result="order + 1"), "order one too high", "last"),
    wrong(
        EXCITATION,
        "first without full rank",
        define(
            "excitation(u, largest)",
            "n = 1\nwhile n < largest and np.linalg.matrix_rank(np.lib.stride_tricks.sliding_window_view(u, n)) == n:\n"
            "    n += 1\nreturn n",
        ),
        "order one too high",
        "last",
    ),
    wrong(EXCITATION, "one too low", excitation(result="max(order - 1, 0)"), "order one too low", "order n"),
    wrong(EXCITATION, "mean taken off", excitation(first="u = u - u.mean()\n"), "mean taken off", "constant"),
    wrong(
        EXCITATION,
        "determinant not zero",
        excitation(full="np.linalg.cond(W.T @ W) < np.inf"),
        "full rank where there is none",
        "tolerance",
    ),
    wrong(
        EXCITATION,
        "different values",
        define("excitation(u, largest)", "return min(len(set(np.round(u, 9))), largest)"),
        "values counted",
        "columns",
    ),
    wrong(
        EXCITATION,
        "largest not used",
        excitation().replace("range(1, largest + 1)", "range(1, 9)"),
        "largest not used",
        "stop",
    ),
    wrong(EXCITATION, "always two", define("excitation(u, largest)", "return 2"), None, "another order than its own"),
    wrong(
        EXCITATION,
        "calls counted",
        "calls = []\n"
        + define("excitation(u, largest)", "calls.append(0)\nreturn [0, 1, 2, 3, 1, 4, 4, 6, 8][len(calls) % 9 - 1]"),
        None,
        "another order than its own",
    ),
    # 8. order
    right(ORDER, "normal equations and a list", order()),
    right(
        ORDER,
        "own equations cut to the same rows",
        define("losses(u, y, orders)", OWN_EQUATIONS) + define("criteria(V, N, p)", CRITERIA),
    ),
    right(
        ORDER,
        "criteria as a list, with log1p",
        order(criteria="L = N * np.log(V)\nreturn [L + 2 * p, L + p * np.log(N), V * (N + p) / (N - p)]"),
    ),
    wrong(ORDER, "rows of its own", order(start="n"), "rows of its own for each order", "different outputs"),
    wrong(
        ORDER,
        "a constant",
        order().replace("Phi, Y = ", "c.append(np.ones(N - s)); Phi, Y = "),
        "a constant fitted along",
        "column of ones",
    ),
    wrong(ORDER, "sum", order(loss="E @ E"), "sum in place of the mean", "1/N"),
    wrong(ORDER, "half", order(loss="np.mean(E**2) / 2"), "half the loss", "half"),
    wrong(ORDER, "all samples", order(loss="E @ E / len(y)"), "divided by all samples", "rows"),
    wrong(ORDER, "N - p", order(loss="E @ E / (len(Y) - 2 * n)"), "divided by the degrees of freedom", "N - p"),
    wrong(ORDER, "root", order(loss="np.sqrt(np.mean(E**2))"), "root of the loss", "root"),
    wrong(ORDER, "largest order each time", order(n="max(orders)"), "one order for all", "same order"),
    wrong(ORDER, "u and y swapped", order(before="u, y = y, u\n"), "u and y swapped", "swapped"),
    wrong(
        ORDER,
        "log10",
        order(criteria=CRITERIA.replace("np.log", "np.log10")),
        "logarithm to base 10",
        "np.log",
    ),
    wrong(ORDER, "ln V alone", order(criteria=CRITERIA.replace("N * np.log(V)", "np.log(V)")), "N forgotten", "N ln V"),
    wrong(
        ORDER,
        "BIC first",
        order(criteria="return N * np.log(V) + p * np.log(N), N * np.log(V) + 2 * p, V * (1 + p / N) / (1 - p / N)"),
        "AIC and BIC swapped",
        "before",
    ),
    wrong(
        ORDER, "price taken off", order(criteria=CRITERIA.replace("+ 2", "- 2")), "price with the wrong sign", "added"
    ),
    wrong(ORDER, "p for 2p", order(criteria=CRITERIA.replace("2 * p", "p")), "price of a parameter", "AIC"),
    wrong(
        ORDER,
        "FPE upside down",
        order(criteria=CRITERIA.replace("(1 + p / N) / (1 - p / N)", "(1 - p / N) / (1 + p / N)")),
        "FPE upside down",
        "above",
    ),
    wrong(ORDER, "half of FPE", order(criteria=CRITERIA.replace(" / (1 - p / N)", "")), "half of FPE", "two factors"),
    wrong(
        ORDER,
        "no FPE",
        order(criteria="return N * np.log(V) + 2 * p, N * np.log(V) + p * np.log(N)"),
        "incomplete result",
        "AIC, BIC and FPE",
    ),
    # 9. cancel
    right(CANCEL, "remove from lists", cancel(PAIRS.format(within="within") + BACK.format("p", "q"))),
    right(
        CANCEL,
        "divide by the factors",
        cancel(
            "P, Q = np.array(P, complex), np.array(Q, complex)\nfor z in np.roots(Q):\n    p = np.roots(P)\n"
            "    if len(p) and np.min(abs(p - z)) < within:\n"
            "        P = np.polydiv(P, [1, -p[np.argmin(abs(p - z))]])[0]\n        Q = np.polydiv(Q, [1, -z])[0]\n"
            "return P, Q"
        ),
    ),
    right(
        CANCEL,
        "a number for a polynomial of no roots",
        cancel(PAIRS.format(within="within") + "return np.real(np.poly(p)), np.real(np.poly(q))"),
    ),
    wrong(
        CANCEL,
        "exactly equal",
        cancel(PAIRS.format(within="1e-12") + BACK.format("p", "q")),
        "nothing cancelled",
        "nearer than",
    ),
    wrong(
        CANCEL,
        "at any distance",
        cancel(NEAREST + BACK.format("p", "q")),
        "distance not used",
        "farther apart",
    ),
    wrong(
        CANCEL, "Q first", cancel(PAIRS.format(within="within") + BACK.format("q", "p")), "P and Q swapped", "Q first"
    ),
    wrong(
        CANCEL,
        "all of a double root",
        cancel(
            "p, q = np.roots(P), np.roots(Q)\nnear = abs(p[:, None] - q) < within\n"
            + BACK.format("p[~near.any(axis=1)]", "q[~near.any(axis=0)]")
        ),
        "all of a multiple root cancelled",
        "double root",
    ),
    wrong(
        CANCEL,
        "the roots",
        cancel(PAIRS.format(within="within") + "return np.real(p), np.real(q)"),
        "roots for polynomials",
        "np.poly",
    ),
    wrong(
        CANCEL,
        "P alone",
        cancel(PAIRS.format(within="within") + "return np.atleast_1d(np.poly(p)).real, Q"),
        "only one of them divided",
        "one polynomial only",
    ),
    wrong(
        CANCEL,
        "backwards",
        cancel(PAIRS.format(within="within") + "return np.poly(p).real[::-1], np.atleast_1d(np.poly(q)).real[::-1]"),
        "highest delay first",
        "backwards",
    ),
    wrong(
        CANCEL,
        "real parts",
        cancel(PAIRS.format(within="within").replace("abs(x - z)", "abs(x.real - z.real)") + BACK.format("p", "q")),
        "real parts compared",
        "distance of complex roots",
    ),
    wrong(
        CANCEL,
        "a limit of its own",
        cancel(PAIRS.format(within="0.01") + BACK.format("p", "q")),
        "within not used",
        "another limit",
    ),
    wrong(CANCEL, "constants", cancel("return np.ones(1), np.ones(1)"), "distance not used", "farther"),
    wrong(CANCEL, "one thing", cancel("return P"), "incomplete result", "two polynomials"),
    # 10. autocorrelation
    right(WHITE, "np.correlate", white(CENTRED + "return np.correlate(e, e, 'full')[N - 1 : N + lags] / (e @ e)")),
    right(
        WHITE,
        "loops and a list",
        white(
            "m = sum(e) / len(e)\nd = sum((x - m) ** 2 for x in e)\n"
            "return [sum((e[t] - m) * (e[t - k] - m) for t in range(k, len(e))) / d for k in range(lags + 1)]"
        ),
    ),
    right(WHITE, "covariances over the variance", white(CENTRED + f"return {SUMS} / N / np.var(e)")),
    wrong(WHITE, "mean left in", white(f"N = len(e)\nreturn {SUMS} / (e @ e)"), "mean left in", "mean"),
    wrong(WHITE, "covariances", white(CENTRED + f"return {SUMS} / N"), "not divided by the sum of squares", "r.0. = 1"),
    wrong(WHITE, "sums", white(CENTRED + f"return {SUMS}"), "not divided by the sum of squares", "r.0. = 1"),
    wrong(
        WHITE,
        "roll",
        white(CENTRED + "return np.array([e @ np.roll(e, k) for k in range(lags + 1)]) / (e @ e)"),
        "index wraps around",
        "go round",
    ),
    wrong(
        WHITE,
        "means of the products",
        white(CENTRED + "return np.array([np.mean(e[k:] * e[: N - k]) for k in range(lags + 1)]) / np.var(e)"),
        "divided by the number of products",
        "same denominator",
    ),
    wrong(
        WHITE,
        "corrcoef",
        white("return [np.corrcoef(e[k:], e[: len(e) - k])[0, 1] for k in range(lags + 1)]"),
        "a mean for each part",
        "one mean",
    ),
    wrong(WHITE, "one too few", white(CENTRED + f"return ({SUMS} / (e @ e))[:-1]"), "one lag too few", "too few"),
    wrong(
        WHITE,
        "all lags",
        white(CENTRED + "return np.correlate(e, e, 'full') / (e @ e)"),
        "lags not cut out",
        "cut them out",
    ),
]
