"""Block diagrams of the lab: Fig. 2, 3 and 4."""

from __future__ import annotations

from typing import TYPE_CHECKING

from labsid.plots.diagrams import arrow, block, branch, junction, label, show_as_diagram
from labsid.plots.style import new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def figure_2() -> Figure:
    """Draw Fig. 2: the computer excites the process, and N samples of u and y give N equations for theta.

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    UNSW lab, Fig. 2, with the regression model of eq. (4) and the N equations of eq. (5)-(7).
    """
    figure = new_figure(
        7.4,
        3.2,
        "The computer sends u(k) to the process, every Ts. Both u(k) and the output y(k) go to the regression model: N "
        "equations, from which theta is estimated.",
    )
    ax = figure.add_subplot()
    show_as_diagram(ax, 11.1, 4.8)
    upper = 4.0
    computer = block(ax, (1.5, upper), "Computer\n(every $T_s$)", width=2.6, height=1.3)
    process = block(ax, (6.2, upper), "Process", width=2.4, height=1.3)
    regression = block(
        ax,
        (6.2, 1.25),
        "Regression model\n"
        "$y(k) = \\varphi^T(k)\\,\\theta, \\quad k = 1, \\ldots, N$\n"
        "$N$ equations:  $Y = \\Phi\\,\\theta$",
        width=6.0,
        height=2.2,
    )
    u_taken, y_taken = (3.9, upper), (8.5, upper)
    arrow(ax, computer.right, process.left)
    arrow(ax, process.right, (10.6, upper))
    for taken in (u_taken, y_taken):
        branch(ax, taken)
        arrow(ax, taken, (taken[0], regression.top[1]))
    label(ax, (u_taken[0], upper + 0.4), "$u(k)$")
    label(ax, (y_taken[0], upper + 0.4), "$y(k)$")
    arrow(ax, regression.right, (10.2, 1.25))
    label(ax, (10.6, 1.25), r"$\hat{\theta}$")
    return figure


def figure_3() -> Figure:
    """Draw Fig. 3: offset compensation between controller and process.

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    UNSW lab, Fig. 3 and the text above it: y(k) = y_m(k) - y_offset goes to the controller, and the process
    receives u_in(k) = u(k) + u_offset.
    """
    figure = new_figure(
        7.4,
        2.6,
        "A loop: r(k), controller, u(k); u_offset is added and the process gets u_in(k); from its output y_m(k) "
        "y_offset is subtracted, and y(k) goes back to the controller.",
    )
    ax = figure.add_subplot()
    show_as_diagram(ax, 12.6, 4.4)
    y = 2.3
    controller = block(ax, (2.4, y), "Controller", width=2.3, height=1.1)
    add = junction(ax, (5.2, y), left="$+$", top="$+$")
    process = block(ax, (7.8, y), "Process", width=2.1, height=1.1)
    subtract = junction(ax, (10.5, y), left="$+$", top="$-$")
    arrow(ax, (0.2, y), controller.left)
    label(ax, (0.65, y + 0.4), "$r(k)$")
    arrow(ax, controller.right, add.left)
    label(ax, (4.15, y + 0.4), "$u(k)$")
    arrow(ax, add.right, process.left)
    label(ax, (6.05, y + 0.4), "$u_{\\mathrm{in}}(k)$")
    arrow(ax, process.right, subtract.left)
    label(ax, (9.4, y + 0.4), "$y_m(k)$")
    for part, name in ((add, "$u_{\\mathrm{offset}}$"), (subtract, "$y_{\\mathrm{offset}}$")):
        arrow(ax, (part.top[0], y + 1.4), part.top)
        label(ax, (part.top[0], y + 1.7), name)
    corner = 11.7
    arrow(ax, subtract.right, (12.4, y))
    label(ax, (corner, y + 0.4), "$y(k)$")
    branch(ax, (corner, y))
    arrow(ax, (corner, y), (corner, 0.5), (controller.bottom[0], 0.5), controller.bottom)
    return figure


def figure_4() -> Figure:
    """Draw Fig. 4: process and model with the same input, and the error between their outputs.

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    UNSW lab, Fig. 4 and the text above it.
    """
    figure = new_figure(
        7.4,
        2.8,
        "The input u(k) goes to the process and to the identified model; the error e(k) is the output of the process "
        "less that of the model.",
    )
    ax = figure.add_subplot()
    show_as_diagram(ax, 10.6, 4.0)
    upper, lower = 3.2, 0.9
    process = block(ax, (4.2, upper), "Process", width=2.6, height=1.1)
    model = block(ax, (4.2, lower), "Identified model", width=2.6, height=1.1)
    compare = junction(ax, (7.4, (upper + lower) / 2), top="$+$", bottom="$-$")
    middle = compare.left[1]
    arrow(ax, (0.4, middle), (1.7, middle), (1.7, upper), process.left)
    arrow(ax, (1.7, middle), (1.7, lower), model.left)
    branch(ax, (1.7, middle))
    label(ax, (0.85, middle + 0.4), "$u(k)$")
    arrow(ax, process.right, (7.4, upper), compare.top)
    label(ax, (6.4, upper + 0.4), "$y(k)$")
    arrow(ax, model.right, (7.4, lower), compare.bottom)
    label(ax, (6.4, lower + 0.4), r"$\hat{y}(k)$")
    arrow(ax, compare.right, (9.9, middle))
    label(ax, (8.9, middle + 0.4), r"$e(k) = y(k) - \hat{y}(k)$")
    return figure
