"""First tries of an examiner that had been ticked, misled or told too little, and near neighbours of their causes."""

from tries import ACCEPTED, Try

TRIES = {
    "armax-and-instruments": (
        Try(
            "ai-7-iterated",
            "one round too many",
            "def iterated_iv(u, y, rounds):\n"
            "    Phi = np.column_stack([-y[:-1], u[:-1]])\n"
            "    theta = np.linalg.lstsq(Phi, y[1:])[0]\n"
            "    for i in range(rounds + 1):\n"
            "        ym = scipy.signal.lfilter([0, theta[1]], [1, theta[0]], u)\n"
            "        Z = np.column_stack([-ym[:-1], u[:-1]])\n"
            "        theta = np.linalg.solve(Z.T @ Phi, Z.T @ y[1:])\n"
            "    return theta\n",
            "goes 1 round in place of 0",
        ),
        Try(
            "ai-7-iterated",
            "the first model with the other sign in every round",
            "def iterated_iv(u, y, rounds):\n"
            "    Phi = np.column_stack([-y[:-1], u[:-1]])\n"
            "    first = theta = np.linalg.lstsq(Phi, y[1:])[0]\n"
            "    for i in range(rounds):\n"
            "        ym = scipy.signal.lfilter([0, first[1]], [1, -first[0]], u)\n"
            "        Z = np.column_stack([-ym[:-1], u[:-1]])\n"
            "        theta = np.linalg.solve(Z.T @ Phi, Z.T @ y[1:])\n"
            "    return theta\n",
            "other sign of a; it simulates the first model",
        ),
        Try(
            "ai-8-recursive",
            "phi in both places",
            "def recursive_iv(u, y, warm_up):\n"
            "    theta, P, stable = np.zeros(2), 1e6 * np.eye(2), np.zeros(2)\n"
            "    phi, z_model, history = np.zeros(2), np.zeros(2), np.zeros((len(y), 2))\n"
            "    for n in range(len(y)):\n"
            "        z = phi if n < warm_up else z_model\n"
            "        P = P - np.outer(P @ phi, phi @ P) / (1 + phi @ P @ phi)\n"
            "        theta = theta + P @ z * (y[n] - phi @ theta)\n"
            "        history[n] = theta\n"
            "        if abs(theta[0]) < 1:\n"
            "            stable = theta.copy()\n"
            "        phi, z_model = np.array([-y[n], u[n]]), np.array([-z_model @ stable, u[n]])\n"
            "    return history\n",
            "as least squares does",
        ),
        Try(
            "ai-3-limit",
            "b biased as well",
            "def limit_of_least_squares(a, b, c, var_u, var_e):\n"
            "    var_y = (b**2 * var_u + (1 + c**2 - 2 * a * c) * var_e) / (1 - a**2)\n"
            "    R = np.diag([var_y, var_u])\n"
            "    f = np.array([-c * var_e, var_e])\n"
            "    return np.array([a, b]) + np.linalg.solve(R, f)\n",
            "right in a, and returns .* so b has no bias",
        ),
        Try(
            "ai-7-iterated",
            "one round less",
            "def iterated_iv(u, y, rounds):\n"
            "    Phi = np.column_stack([-y[:-1], u[:-1]])\n"
            "    theta = np.linalg.lstsq(Phi, y[1:])[0]\n"
            "    for i in range(1, rounds):\n"
            "        ym = scipy.signal.lfilter([0, theta[1]], [1, theta[0]], u)\n"
            "        Z = np.column_stack([-ym[:-1], u[:-1]])\n"
            "        theta = np.linalg.solve(Z.T @ Phi, Z.T @ y[1:])\n"
            "    return theta\n",
            "goes 2 rounds in place of 3",
        ),
        Try(
            "ai-8-recursive",
            "old P in the gain, phi phi",
            "def recursive_iv(u, y, warm_up):\n"
            "    theta, P = np.zeros(2), 1e6 * np.eye(2)\n"
            "    stable = np.zeros(2)\n"
            "    phi, z_model = np.zeros(2), np.zeros(2)\n"
            "    history = np.zeros((len(y), 2))\n"
            "    for n in range(len(y)):\n"
            "        z = phi if n < warm_up else z_model\n"
            "        eps = y[n] - phi @ theta\n"
            "        K = P @ z\n"
            "        P = P - np.outer(P @ phi, phi @ P) / (1 + phi @ P @ phi)\n"
            "        theta = theta + K * eps\n"
            "        history[n] = theta\n"
            "        if abs(theta[0]) < 1:\n"
            "            stable = theta.copy()\n"
            "        y_M = z_model @ stable\n"
            "        phi, z_model = np.array([-y[n], u[n]]), np.array([-y_M, u[n]])\n"
            "    return history\n",
            "phi in both places.*taken from the P before",
        ),
        Try(
            "ai-9-likelihood",
            "own variance",
            "def log_likelihood(theta, var_e, Phi, Y):\n"
            "    N = len(Y)\n"
            "    e = Y - Phi @ theta\n"
            "    s2 = e @ e / N\n"
            "    return -N / 2 * np.log(2 * np.pi * s2) - N / 2\n",
            "does not use var_e: it takes the SSE over N in",
        ),
        Try(
            "ai-3-limit",
            "variances exchanged",
            "def limit_of_least_squares(a, b, c, var_u, var_e):\n"
            "    var_y = (b**2 * var_e + (1 + c**2 - 2 * a * c) * var_u) / (1 - a**2)\n"
            "    return np.array([a - c * var_u / var_y, b])\n",
            "exchanged throughout",
        ),
        Try(
            "ai-5-armax",
            "output errors",
            "def prediction_errors(theta, u, y):\n"
            "    a, b, c = theta\n"
            "    e, ym = np.zeros(len(y)), np.zeros(len(y))\n"
            "    for t in range(1, len(y)):\n"
            "        ym[t] = -a * ym[t - 1] + b * u[t - 1] + c * e[t - 1]\n"
            "        e[t] = y[t] - ym[t]\n"
            "    return e\n"
            "\n"
            "\n"
            "def pseudo_linear(u, y, share, rounds):\n"
            "    theta = np.r_[np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1]]), y[1:])[0], 0]\n"
            "    for _ in range(rounds):\n"
            "        e = prediction_errors(theta, u, y)\n"
            "        new = np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1], e[:-1]]), y[1:])[0]\n"
            "        theta = theta + share * (new - theta)\n"
            "    return theta\n",
            "feeds back the model's own output",
        ),
        Try(
            "ai-8-recursive",
            "denominator z P phi",
            "def recursive_iv(u, y, warm_up):\n"
            "    theta, P = np.zeros(2), 1e6 * np.eye(2)\n"
            "    stable = np.zeros(2)\n"
            "    phi, z_model = np.zeros(2), np.zeros(2)\n"
            "    history = np.zeros((len(y), 2))\n"
            "    for n in range(len(y)):\n"
            "        z = phi if n < warm_up else z_model\n"
            "        eps = y[n] - phi @ theta\n"
            "        P = P - np.outer(P @ z, phi @ P) / (1 + z @ P @ phi)\n"
            "        theta = theta + P @ z * eps\n"
            "        history[n] = theta\n"
            "        if abs(theta[0]) < 1:\n"
            "            stable = theta.copy()\n"
            "        y_M = z_model @ stable\n"
            "        phi, z_model = np.array([-y[n], u[n]]), np.array([-y_M, u[n]])\n"
            "    return history\n",
            "z' P phi in its denominator",
        ),
        Try(
            "ai-3-limit",
            "b and the variance off",
            "def limit_of_least_squares(a, b, c, var_u, var_e):\n"
            "    var_y = b**2 * var_u + var_e\n"
            "    return np.array([a - c * var_e / var_y, b + var_e / var_u])\n",
            "another limit of a",
            never="right in a",
        ),
        Try(
            "ai-9-likelihood",
            "var_e in the constant alone",
            "def log_likelihood(theta, var_e, Phi, Y):\n"
            "    N = len(Y)\n"
            "    e = Y - Phi @ theta\n"
            "    return -N / 2 * np.log(2 * np.pi * var_e) - N / 2\n",
            "density of one sample by hand",
            never="does not use var_e",
        ),
    ),
    "lab-identification": (
        Try(
            "lab-2b-theta",
            "residual of lstsq",
            "theta_hat = np.linalg.lstsq(Phi, Y)[1]\n",
            r"`lstsq` returns as `\[1\]`",
        ),
        Try(
            "lab-1c-figure-6",
            "minutes",
            'fig_6, axes = plt.subplots(2, 1, layout="constrained")\n'
            "axes[0].plot(t / 60, y)\n"
            'axes[0].set(xlabel="Time (s)", ylabel="Output (V)")\n'
            "axes[1].plot(t / 60, u)\n"
            'axes[1].set(xlabel="Time (s)", ylabel="Input (V)")\n',
            "against the time in minutes",
        ),
        Try(
            "lab-3a-second-half",
            "lfilter, a without 1, no zero",
            "y_sim_half = scipy.signal.lfilter([b1, b2], [a1, a2], u[half:])\n",
            "lacks the zero before b1, b2.*no leading 1",
        ),
        Try(
            "lab-3a-mse",
            "first half and root",
            "mse_half = np.sqrt(np.mean((y[:len(y_sim_half)] - y_sim_half) ** 2))\n"
            "mse_all = np.sqrt(np.mean((y - y_sim) ** 2))\n",
            "first half of `y` is compared.*the root is taken",
        ),
        Try(
            "lab-1c-loop",
            "compares with the one before, from 0",
            "def first_period(u):\n"
            "    n = 0\n"
            "    while u[n] == u[n - 1]:\n"
            "        n += 1\n"
            "    return n\n"
            "\n"
            "\n"
            "n_first = first_period(u_act)\n",
            r"`u\[n - 1\]` is `u\[-1\]`",
        ),
        Try(
            "lab-3b-initial-state",
            "two samples only",
            "def simulate_from_start(u, y):\n"
            "    time = np.arange(len(u)) * Ts\n"
            "    rest = ct.forced_response(G_ss, time, u).outputs\n"
            "    F = np.column_stack([ct.initial_response(G_ss, time, initial_state=x).outputs for "
            "x in ([1, 0], [0, 1])])\n"
            "    x0 = np.linalg.solve(F[:2], (y - rest)[:2])\n"
            "    return ct.forced_response(G_ss, time, u, initial_state=x0).outputs\n",
            "first 2 samples only",
        ),
        Try(
            "lab-3b-initial-state",
            "eight samples",
            "def simulate_from_start(u, y):\n"
            "    time = np.arange(len(u)) * Ts\n"
            "    rest = ct.forced_response(G_ss, time, u).outputs\n"
            "    F = np.column_stack([ct.initial_response(G_ss, time, initial_state=x).outputs for "
            "x in ([1, 0], [0, 1])])\n"
            "    x0 = np.linalg.lstsq(F[:8], (y - rest)[:8])[0]\n"
            "    return ct.forced_response(G_ss, time, u, initial_state=x0).outputs\n",
            "first 8 samples only",
            never="first 2",
        ),
        Try(
            "lab-1c-loop",
            "always zero",
            "def first_period(u):\n"
            "    n = 0\n"
            "    for k in range(len(u)):\n"
            "        if u[k] != u[0]:\n"
            "            break\n"
            "    return n\n"
            "\n"
            "\n"
            "n_first = first_period(u_act)\n",
            "same number for every input",
            never=r"the \*last\* one",
        ),
        Try(
            "lab-1c-figure-6",
            "half the time",
            "fig_6, axes = plt.subplots(2, 1, layout='constrained')\n"
            "axes[0].plot(t / 2, y)\n"
            "axes[0].set(xlabel='Time (s)', ylabel='Output (V)')\n"
            "axes[1].plot(t / 2, u)\n"
            "axes[1].set(xlabel='Time (s)', ylabel='Input (V)')\n",
            "every entry is half the right value",
            never="minutes",
        ),
        Try(
            "lab-3a-mse",
            "first third and root",
            "n = len(y) // 3\n"
            "mse_half = np.sqrt(np.mean((y[:n] - y_sim[:n]) ** 2))\n"
            "mse_all = np.mean((y - y_sim) ** 2)\n",
            "mean of the squared differences between measured",
            never="two mistakes",
        ),
    ),
    "least-squares": (
        Try(
            "ls-11-cayley-hamilton",
            "two by two only",
            "def inverse_weights(A):\n    return np.array([np.trace(A), -1]) / np.linalg.det(A)\n",
            "of a matrix of any size",
            never="coefficient 1",
        ),
        Try(
            "ls-4-fits",
            "sum squared",
            "u_1 = np.array([1.0, 2, 4, 5, 7])\n"
            "y_1 = np.array([1.0, 3, 5, 7, 8])\n"
            "\n"
            "\n"
            "def fit_powers(x, y, powers):\n"
            "    Phi = np.column_stack([x ** p for p in powers])\n"
            "    theta = np.linalg.solve(Phi.T @ Phi, Phi.T @ y)\n"
            "    E = y - Phi @ theta\n"
            "    return theta, np.sum(E) ** 2\n"
            "\n"
            "\n"
            "theta_line, sse_line = fit_powers(u_1, y_1, [1, 0])\n"
            "theta_parabola, sse_parabola = fit_powers(u_1, y_1, [2, 1, 0])\n",
            "square of the sum of the errors",
        ),
        Try(
            "ls-5-projector",
            "columns scaled only",
            "def projector(Phi):\n    Q = Phi / np.linalg.norm(Phi, axis=0)\n    return Q @ Q.T\n",
            "takes them for orthogonal",
        ),
        Try(
            "ls-8-weighted",
            "W only once and not squared",
            "def weighted_fit(Phi, Y, sigma):\n"
            "    W = np.diag(1 / sigma)\n"
            "    return np.linalg.solve(Phi.T @ W @ Phi, Phi.T @ Y)\n",
            r"weight is 1/sigma, and not 1/sigma\^2; before Y.*W is missing",
        ),
        Try(
            "ls-10-confidence",
            "N and p exchanged",
            "def confidence(Phi, Y, level):\n"
            "    theta = np.linalg.lstsq(Phi, Y)[0]\n"
            "    p, N = Phi.shape\n"
            "    e = Y - Phi @ theta\n"
            "    s = np.sqrt(e @ e / (N - p) * np.diag(np.linalg.inv(Phi.T @ Phi)))\n"
            "    half = scipy.stats.t.ppf((1 + level) / 2, N - p) * s\n"
            "    return theta, theta - half, theta + half\n",
            "one place, `Phi.shape`",
        ),
        Try(
            "ls-4-fits",
            "sum of products of neighbours",
            "u_1 = np.array([1.0, 2, 4, 5, 7])\n"
            "y_1 = np.array([1.0, 3, 5, 7, 8])\n"
            "\n"
            "\n"
            "def fit_powers(x, y, powers):\n"
            "    Phi = np.column_stack([x ** p for p in powers])\n"
            "    theta = np.linalg.solve(Phi.T @ Phi, Phi.T @ y)\n"
            "    E = y - Phi @ theta\n"
            "    return theta, np.sum(E[1:] * E[:-1])\n"
            "\n"
            "\n"
            "theta_line, sse_line = fit_powers(u_1, y_1, [1, 0])\n"
            "theta_parabola, sse_parabola = fit_powers(u_1, y_1, [2, 1, 0])\n",
            "is not the sum of the squared errors",
            never="square of the sum",
        ),
        Try(
            "ls-10-confidence",
            "two mistakes in the shape",
            "def confidence(Phi, Y, level):\n"
            "    theta = np.linalg.lstsq(Phi, Y)[0]\n"
            "    p, N = Phi.shape\n"
            "    e = Y - Phi @ theta\n"
            "    s = np.sqrt(e @ e / N * np.diag(np.linalg.inv(Phi.T @ Phi)))\n"
            "    half = scipy.stats.t.ppf(level, N - p) * s\n"
            "    return theta, theta - half, theta + half\n",
            "holds nan|wrong width",
            never="one place",
        ),
    ),
    "model-structures": (
        Try(
            "ms-2-shift",
            "roll and one coefficient less",
            "def apply(P, x):\n"
            "    y = np.zeros(len(x))\n"
            "    for i in range(len(P) - 1):\n"
            "        y = y + P[i] * np.roll(x, i)\n"
            "    return y\n",
            "last coefficient of P is left out; the last samples",
        ),
        Try(
            "ms-5-simulate",
            "C in the denominator, a positive",
            "def simulate(A, B, C, u, e):\n"
            "    A2 = np.r_[1, -np.array(A[1:])]\n"
            "    return scipy.signal.lfilter(B, A2, u) + scipy.signal.lfilter([1], np.convolve(A2, C), e)\n",
            "past outputs are added.*divided by C",
        ),
        Try(
            "ms-5-example-3-1",
            "second order, arguments swapped",
            "def example_3_1(u, y):\n"
            "    Phi, Y = equations(u, y, 2, 0, 1)\n"
            "    return np.linalg.lstsq(Phi, Y)[0]\n"
            "\n"
            "\n"
            "theta_1 = example_3_1(y_1, u_1)\n"
            "theta_2 = example_3_1(y_2, u_2)\n",
            "two past outputs and no input",
        ),
        Try(
            "ms-6-figure-8",
            "names swapped, record 2",
            "t_8 = np.arange(100)\n"
            "fig_8, ax = plt.subplots()\n"
            'ax.plot(t_8, y_2[:100], label="measured")\n'
            'ax.plot(t_8, y_hat[:100], label="simulation")\n'
            'ax.plot(t_8, y_sim[:100], label="one-step prediction")\n'
            'ax.set(xlabel="t (samples)", ylabel="y(t)")\n'
            "ax.legend()\n",
            "shows `y_2`, System 2",
        ),
        Try(
            "ms-7-excitation",
            "loop stops early",
            "def excitation(u, largest):\n"
            "    order = 1\n"
            "    for n in range(1, largest):\n"
            "        M = np.array([u[k - n + 1 : k + 1] for k in range(n - 1, len(u))])\n"
            "        if np.linalg.matrix_rank(M) == n:\n"
            "            order = n\n"
            "    return order\n",
            "never tries n = largest.*order is 0, not 1",
        ),
        Try(
            "ms-8-order",
            "last rows dropped",
            "def losses(u, y, orders):\n"
            "    start = max(orders)\n"
            "    V = []\n"
            "    for n in orders:\n"
            "        Phi, Y = equations(u, y, n, n, 1)\n"
            "        m = len(y) - start\n"
            "        Phi, Y = Phi[:m], Y[:m]\n"
            "        theta = np.linalg.lstsq(Phi, Y)[0]\n"
            "        V.append(np.mean((Y - Phi @ theta) ** 2))\n"
            "    return np.array(V)\n"
            "\n"
            "\n"
            "def criteria(V, N, p):\n"
            "    return N * np.log(V) + 2 * p, N * np.log(V) + p * np.log(N), V * (1 + p / N) / (1 - p / N)\n",
            r"rows at the \*end\*",
        ),
        Try(
            "ms-9-cancel",
            "coefficients compared, reversed roots",
            "def cancel(P, Q, within):\n"
            "    p, q = list(np.roots(P[::-1])), list(np.roots(Q[::-1]))\n"
            "    for r in list(q):\n"
            "        for s in p:\n"
            "            if abs(r - s) < within:\n"
            "                p.remove(s)\n"
            "                q.remove(r)\n"
            "                break\n"
            "    a, b = np.atleast_1d(np.poly(p)).real[::-1], np.atleast_1d(np.poly(q)).real[::-1]\n"
            "    return a / a[0], b / b[0]\n",
            "list turned round",
        ),
        Try(
            "ms-3-state-space",
            "A transposed",
            "def state_space(num, den):\n"
            "    n = len(den) - 1\n"
            "    b = np.r_[np.zeros(n + 1 - len(num)), num] / den[0]\n"
            "    a = np.array(den) / den[0]\n"
            "    A = np.vstack([np.eye(n)[1:], -a[:0:-1]])\n"
            "    B = np.eye(n)[:, -1:]\n"
            "    C = (b[1:] - b[0] * a[1:])[::-1].reshape(1, n)\n"
            "    return A.T, B, C, np.array([[b[0]]])\n",
            r"-a stands in the last \*row\* of A",
        ),
        Try(
            "ms-8-order",
            "orders counted 1, 2, 3",
            "def losses(u, y, orders):\n"
            "    start = max(orders)\n"
            "    V = np.zeros(len(orders))\n"
            "    for j, n in enumerate(range(1, len(orders) + 1)):\n"
            "        cols = [-y[start - i : len(y) - i] for i in range(1, n + 1)] + [u[start - i : "
            "len(u) - i] for i in range(1, n + 1)]\n"
            "        Phi = np.column_stack(cols)\n"
            "        r = y[start:] - Phi @ np.linalg.lstsq(Phi, y[start:])[0]\n"
            "        V[j] = r @ r / len(r)\n"
            "    return V\n"
            "\n"
            "\n"
            "def criteria(V, N, p):\n"
            "    return N * np.log(V) + 2 * p, N * np.log(V) + p * np.log(N), V * (1 + p / N) / (1 - p / N)\n",
            "fits the orders 1, 2, and asked for are 2, 5",
        ),
        Try(
            "ms-9-cancel",
            "only one pair",
            "def cancel(P, Q, within):\n"
            "    p, q = list(np.roots(P)), list(np.roots(Q))\n"
            "    for s in list(p):\n"
            "        for r in list(q):\n"
            "            if abs(s - r) < within:\n"
            "                p.remove(s)\n"
            "                q.remove(r)\n"
            "                return np.atleast_1d(np.real(np.poly(p))), np.atleast_1d(np.real(np.poly(q)))\n"
            "    return np.array(P), np.array(Q)\n",
            "`return` stands in a loop",
        ),
        Try(
            "ms-7-excitation",
            "rows of one sample less",
            "def excitation(u, largest):\n"
            "    for n in range(1, largest + 1):\n"
            "        M = np.array([u[k : k + n] for k in range(0, n)])\n"
            "        if np.linalg.matrix_rank(M) < n:\n"
            "            return n - 1\n"
            "    return largest\n",
            "another order than its own",
            never="never tries",
        ),
        Try(
            "ms-8-order",
            "one row less at the end",
            "def losses(u, y, orders):\n"
            "    u, y = u[:-1], y[:-1]\n"
            "    start = max(orders)\n"
            "    V = []\n"
            "    for n in orders:\n"
            "        cols = [-y[start - i : len(y) - i] for i in range(1, n + 1)] + [u[start - i : "
            "len(u) - i] for i in range(1, n + 1)]\n"
            "        Phi = np.column_stack(cols)\n"
            "        theta = np.linalg.lstsq(Phi, y[start:])[0]\n"
            "        V.append(np.mean((y[start:] - Phi @ theta) ** 2))\n"
            "    return np.array(V)\n",
            "Try one order",
            never=r"rows at the \*end\*",
        ),
        Try(
            "ms-5-simulate",
            "C in the denominator alone",
            "def simulate(A, B, C, u, e):\n"
            "    return scipy.signal.lfilter(B, A, u) + scipy.signal.lfilter([1], np.convolve(A, C), e)\n",
            "divides the noise by A and by C",
            never="two mistakes",
        ),
    ),
    "nonlinear-least-squares": (
        Try(
            "nl-9-output-error",
            "first 50 samples",
            "def fit_output_error(u, y):\n"
            "    u, y = u[:50], y[:50]\n"
            "    start = np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1]]), y[1:])[0]\n"
            "    def errors(q):\n"
            "        return scipy.signal.lfilter([0, q[1]], [1, q[0]], u) - y\n"
            "    return scipy.optimize.least_squares(errors, start).x\n",
            "first 50 of 150 samples: all of them count. *$",
        ),
        Try(
            "nl-1-logarithm",
            "power law",
            "def fit_logarithm(x, y):\n"
            "    a, c = np.polyfit(np.log(np.abs(x)), np.log(y), 1)\n"
            "    return a, np.exp(c)\n",
            "takes the logarithm of x as well",
        ),
        Try(
            "nl-1-logarithm",
            "order of ones first",
            "def fit_logarithm(x, y):\n"
            "    Phi = np.column_stack([np.ones_like(x), x])\n"
            "    a, c = np.linalg.lstsq(Phi, np.log(y))[0]\n"
            "    return a, c\n",
            "returns ln b and a, in this order",
        ),
        Try(
            "nl-7-layout",
            "slopes",
            "def layout(beacons):\n"
            "    d = beacons[1:] - beacons[0]\n"
            "    if len(d) == 0 or np.allclose(d, 0):\n"
            '        return "undetermined"\n'
            "    slopes = d[:, 1] / d[:, 0]\n"
            "    if np.allclose(slopes, slopes[0]):\n"
            '        return "mirror"\n'
            '    return "unique"\n',
            "along the second axis: it says 'unique'",
        ),
        Try(
            "nl-9-output-error",
            "minus a, first 50 samples",
            "def fit_output_error(u, y):\n"
            "    u, y = u[:50], y[:50]\n"
            "    start = np.linalg.lstsq(np.column_stack([y[:-1], u[:-1]]), y[1:])[0]\n"
            "    return scipy.optimize.least_squares(lambda q: scipy.signal.lfilter([0, q[1]], [1, "
            "-q[0]], u) - y, start).x\n",
            "first 50 of 150 samples.*a has the other sign",
        ),
        Try(
            "nl-4-damping",
            "diagonal of J",
            "def damped_step(J, e, mu):\n"
            "    A = J.T @ J\n"
            "    return np.linalg.solve(A + mu * np.diag(np.diag(J)), J.T @ e)\n"
            "\n"
            "\n"
            "def levenberg_marquardt(g, jacobian, y, theta0):\n"
            "    theta, mu = np.array(theta0, float), 1e-3\n"
            "    for _ in range(500):\n"
            "        e = y - g(theta)\n"
            "        s = damped_step(jacobian(theta), e, mu)\n"
            "        trial = y - g(theta + s)\n"
            "        if trial @ trial < e @ e:\n"
            "            theta, mu = theta + s, mu / 10\n"
            "        else:\n"
            "            mu = mu * 10\n"
            "    return theta\n",
            "made of the diagonal of J itself",
        ),
        Try(
            "nl-7-locate",
            "sum of the errors",
            "def locate(beacons, ranges):\n"
            "    c, r = beacons.mean(axis=0), ranges.mean()\n"
            "    fits = [scipy.optimize.least_squares(lambda th: np.sum(np.linalg.norm(beacons - "
            "th, axis=1) - ranges), c + r * np.array([np.cos(w), np.sin(w)])) for w in np.arange(0, 6.28, 0.5)]\n"
            "    return min(fits, key=lambda f: f.cost).x\n",
            "one place, `np.sum",
        ),
        Try(
            "nl-7-layout",
            "ratio of singular values",
            "def layout(beacons):\n"
            "    s = np.linalg.svd(beacons - beacons.mean(axis=0))[1]\n"
            "    s = np.r_[s, 0, 0]\n"
            "    if s[0] < 1e-9:\n"
            '        return "undetermined"\n'
            '    return "mirror" if s[1] < 1 else "unique"\n',
            "second singular value .* is 0.51",
        ),
        Try(
            "nl-7-layout",
            "tolerance of a thousandth",
            "def layout(beacons):\n"
            "    s = np.linalg.svd(beacons - beacons[0])[1]\n"
            "    return ['undetermined', 'mirror', 'unique'][int(np.sum(s > 1e-3))]\n",
            "",
            ACCEPTED,
        ),
        Try(
            "nl-7-layout",
            "areas of triangles",
            "def layout(beacons):\n"
            "    d = beacons - beacons[0]\n"
            "    if np.allclose(d, 0):\n"
            "        return 'undetermined'\n"
            "    areas = d[:, 0] * d[:, 1][:, np.newaxis] - d[:, 1] * d[:, 0][:, np.newaxis]\n"
            "    return 'mirror' if np.allclose(areas, 0) else 'unique'\n",
            "",
            ACCEPTED,
        ),
        Try(
            "nl-7-layout",
            "first three beacons alone",
            "def layout(beacons):\n"
            "    d = beacons[:3] - beacons[0]\n"
            "    return ['undetermined', 'mirror', 'unique'][np.linalg.matrix_rank(d, tol=1e-9)]\n",
            "wrong for 4 beacons that span the plane",
            never="singular value",
        ),
        Try(
            "nl-9-output-error",
            "last hundred samples",
            "def fit_output_error(u, y):\n"
            "    u, y = u[-100:], y[-100:]\n"
            "    start = np.linalg.lstsq(np.column_stack([-y[:-1], u[:-1]]), y[1:])[0]\n"
            "    return scipy.optimize.least_squares(lambda q: scipy.signal.lfilter([0, q[1]], [1, "
            "q[0]], u) - y, start).x\n",
            "SSE of the run with yours",
            never="first .* of 150 samples",
        ),
        Try(
            "nl-1-logarithm",
            "constant for the slope alone",
            "def fit_logarithm(x, y):\n"
            "    a, c = np.linalg.lstsq(np.column_stack([np.ones_like(x), x]), np.log(y))[0]\n"
            "    return a, np.exp(c)\n",
            "takes the constant of the line for its slope",
            never="in this order",
        ),
    ),
    "postlab-model-order": (
        Try(
            "postlab-1-theta",
            "residual of lstsq",
            "theta_1 = np.linalg.lstsq(Phi_1, Y_1)[1]\n",
            r"sum of the squared errors.*`lstsq` returns as `\[1\]`",
        ),
        Try(
            "postlab-1-transfer-function",
            "entries swapped",
            "a1, b1 = -theta_1[1], theta_1[0]\nG_1 = ct.tf([b1], [1, a1], Ts)\n",
            "a and b are swapped.*minus sign belongs",
        ),
        Try(
            "postlab-2-fit-order",
            "starts with lag zero of u and returns a",
            "def fit_order(u, y, n):\n"
            "    N = len(y)\n"
            "    cols = [-y[n - i : N - i] for i in range(1, n + 1)] + [u[n - i : N - i] for i in range(n)]\n"
            "    return np.linalg.lstsq(np.column_stack(cols), y[n:])[0]\n"
            "\n"
            "\n"
            "theta_2 = fit_order(u[:half], y[:half], 2)\n",
            r"inputs with u\(k\), not u\(k-1\); \[a, b\] is returned",
        ),
        Try(
            "postlab-3-mse",
            "between the models",
            "mse_1 = np.mean((y - y_sim_1) ** 2)\nmse_2 = np.mean((y_sim_1 - y_sim_2) ** 2)\n",
            "difference of the two simulations",
        ),
        Try(
            "postlab-3-mse",
            "swapped and sum",
            "mse_1 = np.sum((y - y_sim_2) ** 2)\nmse_2 = np.sum((y - y_sim_1) ** 2)\n",
            "`y_sim_2` is taken for `y_sim_1`; the squares are summed",
        ),
        Try(
            "postlab-3-figure-8",
            "numbers typed",
            'fig_8, ax = plt.subplots(figsize=(9, 4), layout="constrained")\n'
            'ax.plot(t, y, label="y")\n'
            'ax.plot(t, y_sim_1, label="order 1")\n'
            'ax.plot(t, y_sim_2, label="order 2")\n'
            'ax.set(xlabel="Time (s)", ylabel="Output (V)")\n'
            'ax.text(0.02, 0.97, "order 1: MSE 1.00e-03\\norder 2: MSE 6.00e-04", transform=ax.transAxes, va="top")\n'
            "ax.legend()\n",
            "number 1.00e-03 in Fig. 8 is not",
        ),
        Try(
            "postlab-3-figure-8",
            "numbers rounded to one digit",
            'fig_8, ax = plt.subplots(figsize=(9, 4), layout="constrained")\n'
            'ax.plot(t, y, label="y")\n'
            'ax.plot(t, y_sim_1, label="order 1")\n'
            'ax.plot(t, y_sim_2, label="order 2")\n'
            'ax.set(xlabel="Time (s)", ylabel="Output (V)")\n'
            'ax.text(0.02, 0.97, "order 1: MSE " + f"{mse_1:.0e}" + "\\norder 2: MSE " + '
            'f"{mse_2:.0e}", transform=ax.transAxes, va="top")\n'
            "ax.legend()\n",
            "not exact enough",
            never="is not the first-order",
        ),
        Try(
            "postlab-1-theta",
            "one parameter",
            "theta_1 = np.linalg.lstsq(Phi_1[:, :1], Y_1)[0]\n",
            "should have 2 elements",
            never="sum of the squared errors",
        ),
    ),
    "prelab-sinusoids": (
        Try(
            "prelab-1-time",
            "reshape not assigned",
            "t = np.linspace(0, 100, 1001)\nt.reshape(-1, 1)\nprint(t.shape)\n",
            r"`t.reshape\(-1, 1\)` computes a value and keeps it nowhere",
        ),
        Try(
            "prelab-2-noise",
            "sum not assigned",
            "y1 = np.sin(2 * np.pi * t / 100)\n"
            "y2 = np.cos(2 * np.pi * t / 100)\n"
            "n1 = rng.random(t.shape) * 0.4 - 0.2\n"
            "y1 + n1\n"
            "y2 + n1\n",
            r"`y1 \+ n1` computes a value and keeps it nowhere",
        ),
        Try(
            "prelab-4-matrix",
            "concatenate on top",
            "data_new = np.concatenate([t_new, y2_new, y1_new])\n",
            "one below the other",
        ),
        Try(
            "prelab-4-matrix",
            "two on top",
            "data_new = np.concatenate([t_new, y1_new])\n",
            r"array of shape \(1602, 1\)",
            never="one below the other",
        ),
    ),
    "recursive-identification": (
        Try(
            "ri-2-information",
            "estimate returned",
            "def add_sample(M, v, phi, y):\n"
            "    M = M + np.outer(phi, phi)\n"
            "    v = v + phi * y\n"
            "    return np.linalg.pinv(M) @ v, M\n",
            "returns the estimate, M.-1 v, and then M",
            never="v before M",
        ),
        Try(
            "ri-9-windup",
            "trace not divided, last trace",
            "def rls_bounded(Phi, Y, lam, LN, bound):\n"
            "    p = Phi.shape[1]\n"
            "    theta, P = np.zeros(p), LN * np.eye(p)\n"
            "    history, traces = [], []\n"
            "    for phi, y in zip(Phi, Y):\n"
            "        traces.append(np.trace(P))\n"
            "        l = 1.0 if np.trace(P) > bound else lam\n"
            "        Pp = P @ phi\n"
            "        P = (P - np.outer(Pp, Pp) / (l + phi @ Pp)) / l\n"
            "        theta = theta + P @ phi * (y - phi @ theta)\n"
            "        history.append(theta)\n"
            "    return np.array(history), np.array(traces)\n",
            r"Compare trace\(P\)/lambda. And the traces are one sample late",
        ),
        Try(
            "ri-9-windup",
            "tested after the update",
            "def rls_bounded(Phi, Y, lam, LN, bound):\n"
            "    p = Phi.shape[1]\n"
            "    theta, P = np.zeros(p), LN * np.eye(p)\n"
            "    history, traces = np.zeros(Phi.shape), np.zeros(len(Y))\n"
            "    l = lam\n"
            "    for k in range(len(Y)):\n"
            "        phi = Phi[k]\n"
            "        Pp = P @ phi\n"
            "        eps = Y[k] - phi @ theta\n"
            "        P = (P - np.outer(Pp, Pp) / (l + phi @ Pp)) / l\n"
            "        theta = theta + P @ phi * eps\n"
            "        l = 1 if np.trace(P) / lam > bound else lam\n"
            "        history[k], traces[k] = theta, np.trace(P)\n"
            "    return history, traces\n",
            "first sample with lambda whatever the bound is",
        ),
        Try(
            "ri-9-windup",
            "first sample skipped",
            "def rls_bounded(Phi, Y, lam, LN, bound):\n"
            "    p = Phi.shape[1]\n"
            "    theta, P = np.zeros(p), LN * np.eye(p)\n"
            "    history, traces = np.zeros(Phi.shape), np.zeros(len(Y))\n"
            "    l = lam\n"
            "    for k in range(1, len(Y)):\n"
            "        l = 1 if np.trace(P) / lam > bound else lam\n"
            "        phi = Phi[k]\n"
            "        Pp = P @ phi\n"
            "        eps = Y[k] - phi @ theta\n"
            "        P = (P - np.outer(Pp, Pp) / (l + phi @ Pp)) / l\n"
            "        theta = theta + P @ phi * eps\n"
            "        \n"
            "        history[k], traces[k] = theta, np.trace(P)\n"
            "    return history, traces\n",
            "does not follow the rule",
            never="first sample with lambda",
        ),
    ),
    "several-signals": (
        Try(
            "sev-6-reference",
            "least squares with r for u",
            "def fit_with_reference(u, y, r):\n"
            "    Phi = np.column_stack([y[1:-1], r[1:-1]])\n"
            "    return np.linalg.lstsq(Phi, y[2:])[0]\n",
            "reference stands in Phi.*which is least squares",
        ),
        Try(
            "sev-6-reference",
            "past inputs, sign of the other course",
            "def fit_with_reference(u, y, r):\n"
            "    Z = np.column_stack([u[1:-1], u[:-2]])\n"
            "    Phi = np.column_stack([-y[1:-1], u[1:-1]])\n"
            "    return np.linalg.inv(Z.T @ Phi) @ Z.T @ y[2:]\n",
            r"Phi holds -y\(k-1\).*past inputs are the instruments",
        ),
        Try(
            "sev-2-offsets",
            "first 50 samples",
            "def without_offsets(u, y):\n    return u - u[0], y - y[:50].mean(axis=0)\n",
            "means of the first 50 samples",
        ),
        Try(
            "sev-2-offsets",
            "mean of the middle",
            "def without_offsets(u, y):\n    return u - u[0], y - y[3:7].mean(axis=0)\n",
            "is off: for each column",
            never="first .* samples",
        ),
    ),
    "sim-to-real-gap": (
        Try(
            "gap-2-linear",
            "half as long, u_act",
            "Phi = np.column_stack([y[1 : half - 1], y[: half - 2], u_act[1 : half - 1], u_act[: half - 2]])\n"
            "theta_arx = np.linalg.lstsq(Phi, y[2:half])[0]\n"
            "theta_hat = fit(free_run, theta_arx, u_act[:half], y[:half])\n"
            "y_lin = free_run(theta_hat, u_act[:half])\n",
            "fitted with `u_act`",
        ),
        Try(
            "gap-3-size",
            "first half, not rooted",
            "gap_before = np.mean(e[:half] ** 2)\n",
            "half that was fitted is taken.*root is missing",
        ),
        Try(
            "gap-4-frequency",
            "amplitudes, mean",
            "def band_shares(e, Ts, edges):\n"
            "    E = np.abs(np.fft.rfft(e - e.mean()))\n"
            "    f = np.fft.rfftfreq(len(e), Ts)\n"
            "    s = np.histogram(f, edges, weights=E)[0]\n"
            "    return s / np.sum(s)\n",
            r"mean of the error is removed; \|E\| is added up",
        ),
        Try(
            "gap-7-simulation",
            "measured outputs",
            "def simulate_better(u_act):\n"
            "    v = u_act - u_offset\n"
            "    out = np.zeros(len(v))\n"
            "    for k in range(2, len(v)):\n"
            "        out[k] = theta_hat @ np.array([y[k - 1], y[k - 2], v[k - 1], v[k - 2]])\n"
            "    return out + y_offset\n",
            "input rests.*it reads `y`",
        ),
        Try(
            "gap-3-time",
            "largest sample",
            "def time_shares(e, parts):\n"
            "    m = len(e) // parts\n"
            "    return np.array([np.sum(e[i * m : (i + 1) * m] ** 2) for i in range(parts)]) / np.sum(e**2)\n"
            "\n"
            "\n"
            "share_t = time_shares(e, 16)\n"
            "t0 = t[np.argmax(np.abs(e))]\n"
            "worst = (t0, t0 + N / 16 * Ts)\n",
            "begins with the largest single error",
        ),
        Try(
            "gap-4-frequency",
            "spectrum of the square",
            "def band_shares(e, Ts, edges):\n"
            "    w = np.abs(np.fft.rfft(e**2))\n"
            "    f = np.fft.rfftfreq(len(e), Ts)\n"
            "    s = np.histogram(f, edges, weights=w)[0]\n"
            "    return s / s.sum()\n",
            "squares of the error are transformed",
        ),
        Try(
            "gap-5-operating",
            "x and e exchanged",
            "def cell_shares(x, e, edges):\n"
            "    s = np.histogram(e, edges, weights=x**2)[0]\n"
            "    return s / np.sum(x**2)\n"
            "\n"
            "\n"
            "share_u = cell_shares(u_act, e, edges_u)\n"
            "share_y = cell_shares(y_act, e, edges_y)\n",
            r"adds up x\^2",
        ),
        Try(
            "gap-7-simulation",
            "recorded error added",
            "def simulate_better(u_act):\n"
            "    return free_run(theta_hat, u_act - u_offset) + y_offset + 0.9 * e[: len(u_act)]\n",
            "input rests.*it reads `e`",
        ),
        Try(
            "gap-3-time",
            "stretch beside the worst",
            "def time_shares(e, parts):\n"
            "    m = len(e) // parts\n"
            "    return np.array([np.sum(e[i * m : (i + 1) * m] ** 2) for i in range(parts)]) / np.sum(e**2)\n"
            "\n"
            "\n"
            "share_t = time_shares(e, 16)\n"
            "i = (np.argmax(share_t) + 5) % 16\n"
            "worst = (i * N / 16 * Ts, (i + 1) * N / 16 * Ts)\n",
            "has the share",
            never="largest single error",
        ),
        Try(
            "gap-2-linear",
            "neither offset removed",
            "Phi = np.column_stack([y_act[1 : half - 1], y_act[: half - 2], u_act[1 : half - 1], "
            "u_act[: half - 2]])\n"
            "theta_arx = np.linalg.lstsq(Phi, y_act[2:half])[0]\n"
            "theta_hat = fit(free_run, theta_arx, u[:half], y[:half])\n"
            "y_lin = free_run(theta_hat, u)\n",
            "signals with their offsets",
            never="fitted with `u_act`",
        ),
    ),
    "step-response": (
        Try(
            "step-1-read",
            "td as difference",
            "change = y_step[-1]\n"
            "t63 = t_step[np.argmax(y_step >= 0.632 * change)]\n"
            "t28 = t_step[np.argmax(y_step >= 0.283 * change)]\n"
            "K = change / amplitude\n"
            "tau = 1.5 * (t63 - t28)\n"
            "td = t63 - t28\n",
            "td is t_63 - t_28",
        ),
        Try(
            "step-2-response",
            "index td and no amplitude",
            "def first_order_response(t, K, tau, td, amplitude):\n"
            "    y = K * (1 - np.exp(-t / tau))\n"
            "    y = np.concatenate([np.zeros(int(td)), y])[: len(t)]\n"
            "    return y\n",
            "depend on the amplitude; td is taken for a number of samples",
        ),
        Try(
            "step-8-gradient",
            "half forgotten in one term",
            "def gradient(Phi, Y, theta):\n    return 2 * Phi.T @ Phi @ theta - Phi.T @ Y\n",
            "is 2 Phi'Phi theta - Phi'Y",
        ),
    ),
}
