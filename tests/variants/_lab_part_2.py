"""Part 2 of the lab: Phi, theta, the models."""

from variants import Right, Wrong, right, wrong
from variants._lab_cells import extracted

PHI, THETA, PARAMETERS = "lab-2a-phi", "lab-2b-theta", "lab-2b-parameters"
TF, SS = "lab-2c-transfer-function", "lab-2c-state-space"
EXTRACT = "lab-1a-extract"
HALF, ALL, MSE = "lab-3a-second-half", "lab-3a-all", "lab-3a-mse"


def phi(
    y1: str = "y[1 : half - 1]",
    y2: str = "y[0 : half - 2]",
    u1: str = "u[1 : half - 1]",
    u2: str = "u[0 : half - 2]",
    Y: str = "y[2:half]",
) -> str:
    return f"half = len(y) // 2\nPhi = np.column_stack([{y1}, {y2}, {u1}, {u2}])\nY = {Y}\n"


VARIANTS: list[Right | Wrong] = [
    # 2a. Phi
    right(
        PHI,
        "loop over the rows",
        "half = len(y) // 2\nrows, targets = [], []\nfor k in range(2, half):\n"
        "    rows.append([y[k - 1], y[k - 2], u[k - 1], u[k - 2]])\n    targets.append(y[k])\n"
        "Phi, Y = np.array(rows), np.array(targets)",
    ),
    right(
        PHI,
        "toeplitz",
        "from scipy.linalg import toeplitz\nhalf = len(y) // 2\nk = slice(1, half - 1)\n"
        "Phi = np.hstack([toeplitz(x[k], x[[1, 0]]) for x in (y, u)])\nY = y[2:half]",
    ),
    right(
        PHI,
        "from k = 1, at rest before",
        "half = len(y) // 2\nyy, uu = np.r_[0, y], np.r_[0, u]\n"
        "Phi = np.column_stack([yy[1:half], yy[: half - 1], uu[1:half], uu[: half - 1]])\nY = y[1:half]",
    ),
    right(
        PHI,
        "from k = 10",
        "half = len(y) // 2\nPhi = np.array([[y[k-1], y[k-2], u[k-1], u[k-2]] for k in range(10, half)])\n"
        "Y = y[10:half]",
    ),
    right(
        PHI,
        "the first sample held before the record",
        "half = len(y) // 2\nyy, uu = np.r_[y[0], y], np.r_[u[0], u]\n"
        "Phi = np.array([[yy[k], yy[k-1], uu[k], uu[k-1]] for k in range(1, half)])\nY = y[1:half]",
    ),
    right(
        PHI,
        "column vectors",
        "half = len(y) // 2 + 1\nyc, uc = y[:half].reshape(-1, 1), u[:half].reshape(-1, 1)\n"
        "Phi = np.hstack([yc[1:-1], yc[:-2], uc[1:-1], uc[:-2]])\nY = yc[2:]",
        {
            THETA: "theta_hat = np.linalg.inv(Phi.T @ Phi) @ Phi.T @ Y",
            PARAMETERS: "a1, a2 = -theta_hat[:2, 0]\nb1, b2 = theta_hat[2:, 0]",
        },
    ),
    wrong(
        PHI,
        "columns of u first",
        phi("u[1 : half - 1]", "u[0 : half - 2]", "y[1 : half - 1]", "y[0 : half - 2]"),
        "y and u columns swapped",
        "y comes first",
    ),
    wrong(
        PHI,
        "lags swapped",
        phi("y[0 : half - 2]", "y[1 : half - 1]", "u[0 : half - 2]", "u[1 : half - 1]"),
        "lags swapped",
        "k-1 comes before",
    ),
    wrong(
        PHI,
        "lags of y swapped",
        phi("y[0 : half - 2]", "y[1 : half - 1]"),
        "lags swapped",
        "columns of y are swapped",
    ),
    wrong(
        PHI,
        "lags of u swapped",
        phi(u1="u[0 : half - 2]", u2="u[1 : half - 1]"),
        "lags swapped",
        "columns of u are swapped",
    ),
    wrong(
        PHI,
        "a column of ones",
        phi().replace("half - 2]])", "half - 2], np.ones(half - 2)])"),
        "a constant fitted along",
        "column of ones",
    ),
    wrong(
        PHI,
        "y(k) among the regressors",
        phi("y[2:half]", "y[1 : half - 1]", "u[2:half]", "u[1 : half - 1]"),
        "lag off by one",
        "begins with y\\(k-1\\)",
    ),
    wrong(PHI, "u(k) among the regressors", phi(u1="u[2:half]", u2="u[1 : half - 1]"), "lag off by one", "u\\(k-1\\)"),
    wrong(PHI, "a lag too many", phi(Y="y[3 : half + 1]"), "Y is not y(k)", "`Phi` is right.*1 sample late"),
    wrong(PHI, "target one early", phi(Y="y[1 : half - 1]"), "Y is not y(k)", "`Phi` is right.*1 sample early"),
    wrong(PHI, "minus in Phi", phi("-y[1 : half - 1]", "-y[0 : half - 2]"), "sign of a", "minus sign is in theta"),
    wrong(
        PHI,
        "offsets left in",
        phi("y_act[1:half-1]", "y_act[:half-2]", "u_act[1:half-1]", "u_act[:half-2]", "y_act[2:half]"),
        "offset left in",
        "offset-free",
    ),
    wrong(
        PHI,
        "input offset left in",
        phi(u1="u_act[1:half-1]", u2="u_act[:half-2]"),
        "input offset left in",
        "offset-free",
    ),
    wrong(
        PHI,
        "measured output",
        "y_m = y_actm - y_offset\n" + phi("y_m[1:half-1]", "y_m[:half-2]", Y="y_m[2:half]"),
        "measured output used",
        "`y_actm`",
    ),
    wrong(
        PHI, "all the data", phi("y[1:-1]", "y[:-2]", "u[1:-1]", "u[:-2]", "y[2:]"), "fit on all the data", "first half"
    ),
    wrong(
        PHI,
        "second half",
        phi("y[half+1:-1]", "y[half:-2]", "u[half+1:-1]", "u[half:-2]", "y[half+2:]"),
        "wrong half",
        "second half",
    ),
    wrong(PHI, "transposed", phi().replace("Y =", "Phi = Phi.T\nY ="), "transposed Phi", "transpose it"),
    wrong(PHI, "rows stacked", phi().replace("column_stack", "vstack"), "transposed Phi", "transpose it"),
    wrong(
        PHI,
        "np.roll",
        "half = len(y) // 2\nyh, uh = y[:half], u[:half]\n"
        "Phi = np.column_stack([np.roll(yh, 1), np.roll(yh, 2), np.roll(uh, 1), np.roll(uh, 2)])\nY = yh",
        "index wraps around",
        "last sample",
    ),
    wrong(
        PHI,
        "y[-1] before the record",
        "half = len(y) // 2\nPhi = np.array([[y[k-1], y[k-2], u[k-1], u[k-2]] for k in range(1, half)])\nY = y[1:half]",
        "index wraps around",
        "last sample",
    ),
    wrong(PHI, "lengths differ", phi(Y="y[:half]"), "Phi and Y of different lengths", "rows"),
    wrong(
        PHI,
        "only the last rows",
        "half = len(y) // 2\nPhi = np.array([[y[k-1], y[k-2], u[k-1], u[k-2]] for k in range(400, half)])\n"
        "Y = y[400:half]",
        "late start",
        "omits",
    ),
    # 2b. theta
    right(THETA, "inverse, as printed", "theta_hat = np.linalg.inv(Phi.T @ Phi) @ Phi.T @ Y"),
    right(THETA, "lstsq", "theta_hat = np.linalg.lstsq(Phi, Y, rcond=None)[0]"),
    right(THETA, "pseudo-inverse", "theta_hat = np.linalg.pinv(Phi) @ Y"),
    right(
        THETA,
        "QR",
        "Q, R = np.linalg.qr(Phi)\ntheta_hat = scipy.linalg.solve_triangular(R, Q.T @ Y)",
        {EXTRACT: "import scipy.linalg\n" + extracted()},
    ),
    right(
        THETA,
        "a column",
        "theta_hat = np.linalg.solve(Phi.T @ Phi, Phi.T @ Y.reshape(-1, 1))",
        {PARAMETERS: "a1, a2, b1, b2 = (np.array([-1, -1, 1, 1]) * theta_hat.ravel()).tolist()"},
    ),
    wrong(THETA, "All signs", "theta_hat = np.linalg.lstsq(Phi, Y)[0] * [-1, -1, 1, 1]", "sign of a", "Keep its signs"),
    wrong(THETA, "all of lstsq", "theta_hat = np.linalg.lstsq(Phi, Y)", "all that lstsq returns", "\\[0\\]"),
    wrong(
        THETA,
        "fit on all the data",
        "P = np.column_stack([y[1:-1], y[:-2], u[1:-1], u[:-2]])\ntheta_hat = np.linalg.lstsq(P, y[2:])[0]",
        "fit on all the data",
        "first half",
    ),
    wrong(
        THETA,
        "offset left in",
        "ya, ua = y_act[:half], u_act[:half]\nP = np.column_stack([ya[1:-1], ya[:-2], ua[1:-1], ua[:-2]])\n"
        "theta_hat = np.linalg.lstsq(P, ya[2:])[0]",
        "offset left in",
        "offset-free",
    ),
    wrong(
        THETA,
        "arguments of lstsq swapped",
        "theta_hat = np.linalg.lstsq(Y[:, None], Phi)[0]",
        "arguments of lstsq swapped",
        "Phi comes first",
    ),
    wrong(THETA, "rounded", "theta_hat = np.linalg.lstsq(Phi, Y)[0].round(2)", "rounded", "keep all its digits"),
    wrong(
        THETA,
        "a constant",
        "theta_hat = np.linalg.lstsq(np.c_[Phi, np.ones(len(Y))], Y)[0]",
        "a constant fitted along",
        "no constant",
    ),
    wrong(
        THETA,
        "a constant, left out of the result",
        "theta_hat = np.linalg.lstsq(np.c_[Phi, np.ones(len(Y))], Y)[0][:4]",
        "a constant fitted along",
        "column of ones beside Phi",
    ),
    wrong(THETA, "inverse forgotten", "theta_hat = Phi.T @ Y", "inverse left out", "inverse"),
    wrong(THETA, "inverse not taken", "theta_hat = (Phi.T @ Phi) @ Phi.T @ Y", "inverse left out", "should be"),
    wrong(
        THETA, "a row", "theta_hat = np.linalg.lstsq(Phi, Y)[0].reshape(1, -1)", "a row instead of a column", "is a row"
    ),
    wrong(THETA, "wrong transposed", "theta_hat = np.linalg.inv(Phi @ Phi.T) @ Phi @ Y", None, "stopped"),
    # 2b. the parameters
    right(PARAMETERS, "taken apart at once", "a1, a2, b1, b2 = np.array([-1, -1, 1, 1]) * theta_hat"),
    right(
        PARAMETERS,
        "as plain numbers",
        "a1, a2 = [-float(x) for x in theta_hat[:2]]\nb1, b2 = map(float, theta_hat[2:])",
    ),
    wrong(PARAMETERS, "sign of a", "a1, a2, b1, b2 = theta_hat", "sign of a", "-a1 and -a2"),
    wrong(
        PARAMETERS, "rounded", "a1, a2, b1, b2 = np.round(theta_hat * [-1, -1, 1, 1], 3)", "rounded", "all the digits"
    ),
    wrong(PARAMETERS, "all All signs", "a1, a2, b1, b2 = -theta_hat", "sign of b", "keep their signs"),
    wrong(PARAMETERS, "sign of a2", "a1, a2, b1, b2 = theta_hat * [-1, 1, 1, 1]", "sign of a", "a2"),
    wrong(PARAMETERS, "b first", "b1, b2, a1, a2 = theta_hat * [1, 1, -1, -1]", "a and b swapped", "swapped"),
    wrong(
        PARAMETERS, "b1 and b2 swapped", "a1, a2, b2, b1 = theta_hat * [-1, -1, 1, 1]", "b1 and b2 swapped", "b1 and b2"
    ),
    wrong(
        PARAMETERS,
        "MATLAB's indices",
        "a1 = -theta_hat[1]\na2 = -theta_hat[2]\nb1 = theta_hat[3]\nb2 = theta_hat[4]",
        None,
        "IndexError",
    ),
    # 2c. the transfer function
    right(TF, "with the zero written", "G = ct.tf([0, b1, b2], [1, a1, a2], Ts)"),
    right(
        TF,
        "scipy's",
        "G = scipy.signal.TransferFunction([b1, b2], [1, a1, a2], dt=Ts)",
        {
            HALF: "y_sim_half = scipy.signal.lfilter([0, b1, b2], [1, a1, a2], u[half:])",
            ALL: "y_sim = scipy.signal.dlsim(G, u)[1]",
            MSE: "y_sim = y_sim.ravel()\n"
            "mse_half, mse_all = np.mean((y[half:] - y_sim_half) ** 2), np.mean((y - y_sim) ** 2)",
        },
    ),
    right(TF, "from the state space", "G = ct.ss2tf([[0, 1], [-a2, -a1]], [[0], [1]], [[b2, b1]], [[0]], Ts)"),
    right(TF, "with z as a variable", "z = ct.tf([1, 0], [1], Ts)\nG = (b1 * z + b2) / (z**2 + a1 * z + a2)"),
    wrong(TF, "sign of a", "G = ct.tf([b1, b2], [1, -a1, -a2], Ts)", "sign of a", "signs of theta"),
    wrong(TF, "continuous time", "G = ct.tf([b1, b2], [1, a1, a2])", "no sampling time", "`Ts` as the last"),
    wrong(TF, "sampling time of one", "G = ct.tf([b1, b2], [1, a1, a2], 1)", "wrong sampling time", "sampling time"),
    wrong(
        TF, "not strictly proper", "G = ct.tf([b1, b2, 0], [1, a1, a2], Ts)", "numerator one step early", "same order"
    ),
    wrong(
        TF,
        "leading one forgotten",
        "G = ct.tf([b1, b2], [a1, a2], Ts)",
        "theta in place of the denominator",
        "leading 1",
    ),
    wrong(TF, "inverted", "G = ct.tf([1, a1, a2], [b1, b2], Ts)", "numerator and denominator swapped", "swapped"),
    wrong(TF, "b in reverse", "G = ct.tf([b2, b1], [1, a1, a2], Ts)", "order of b", "reverse"),
    wrong(
        TF,
        "a state space",
        "G = ct.ss([[0, 1], [-a2, -a1]], [[0], [1]], [[b2, b1]], [[0]], Ts)",
        "state space instead of transfer function",
        "ct.tf",
    ),
    # 2c. the state space
    right(SS, "from the transfer function", "G_ss = ct.ss(G)"),
    right(SS, "observable form", "G_ss = ct.ss([[-a1, 1], [-a2, 0]], [[b1], [b2]], [[1, 0]], 0, Ts)"),
    wrong(
        SS,
        "sign of a",
        "G_ss = ct.ss([[0, 1], [a2, a1]], [[0], [1]], [[b2, b1]], [[0]], Ts)",
        "sign of a",
        "wrong signs",
    ),
    wrong(
        SS,
        "a1 and a2 swapped",
        "G_ss = ct.ss([[0, 1], [-a1, -a2]], [[0], [1]], [[b2, b1]], [[0]], Ts)",
        "a1 and a2 swapped",
        "a1 and a2 are swapped",
    ),
    wrong(
        SS,
        "b1 and b2 swapped",
        "G_ss = ct.ss([[0, 1], [-a2, -a1]], [[0], [1]], [[b1, b2]], [[0]], Ts)",
        "b1 and b2 swapped",
        "swapped in C",
    ),
    wrong(
        SS,
        "H reversed",
        "G_ss = ct.ss([[0, 1], [-a2, -a1]], [[1], [0]], [[b2, b1]], [[0]], Ts)",
        "H reversed",
        "in eq. .2. the second",
    ),
    wrong(
        SS,
        "continuous time",
        "G_ss = ct.ss([[0, 1], [-a2, -a1]], [[0], [1]], [[b2, b1]], [[0]])",
        "no sampling time",
        "sampling time",
    ),
    wrong(
        SS,
        "feed-through",
        "G_ss = ct.ss([[0, 1], [-a2, -a1]], [[0], [1]], [[b2, b1]], [[1]], Ts)",
        "feed-through",
        "D should be 0",
    ),
    wrong(SS, "the transfer function again", "G_ss = G", "transfer function instead of state space", "ct.ss"),
]
