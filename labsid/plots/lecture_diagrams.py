"""Block diagrams of the Reading notes, drawn from captions and text: Fig. 1, the five steps, Fig. 2 and Fig. 6."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

from labsid.plots.diagrams import arrow, block, branch, junction, label, show_as_diagram
from labsid.plots.style import new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FIVE_STEPS = (
    "1. Design\nthe experiment",
    "2. Perform it,\ncollect data",
    "3. Choose the\nmodel structure",
    "4. Estimate\nthe parameters",
    "5. Validate\nthe model",
)
"""The five steps of system identification (Reading notes, lecture 1)."""


def figure_dynamical_system() -> Figure:
    """Draw Fig. 1: a system with input u(t), disturbance v(t) and output y(t).

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    Reading notes, Fig. 1.
    """
    figure = new_figure(5.2, 1.9, "A system with the input u(t), the disturbance v(t) and the output y(t).")
    ax = figure.add_subplot()
    show_as_diagram(ax, 8.4, 3.0)
    system = block(ax, (4.2, 0.9), "System", width=2.4, height=1.2)
    arrow(ax, (0.8, 0.9), system.left)
    arrow(ax, system.right, (7.6, 0.9))
    arrow(ax, (4.2, 2.6), system.top)
    label(ax, (1.6, 1.3), "$u(t)$")
    label(ax, (6.8, 1.3), "$y(t)$")
    label(ax, (4.8, 2.3), "$v(t)$")
    return figure


def figure_five_steps() -> Figure:
    """Draw the five steps of system identification and the return paths for another iteration.

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    Reading notes, lecture 1, "How system identification is applied".
    """
    figure = new_figure(
        11.2,
        2.2,
        "Five steps in a row: design the experiment, collect data, choose the structure, estimate, validate. From the "
        "last one lines lead back to the first and to the third: not good enough, repeat.",
    )
    ax = figure.add_subplot()
    show_as_diagram(ax, 18.4, 3.8)
    y = 2.8
    steps = [block(ax, (1.8 + 3.7 * i, y), text, width=3.2, height=1.5) for i, text in enumerate(FIVE_STEPS)]
    for before, after in pairwise(steps):
        arrow(ax, before.right, after.left)
    arrow(ax, steps[-1].bottom, (steps[-1].bottom[0], 0.9), (steps[0].bottom[0], 0.9), steps[0].bottom)
    arrow(ax, (steps[2].bottom[0], 0.9), steps[2].bottom)
    branch(ax, (steps[2].bottom[0], 0.9))
    label(ax, (steps[3].bottom[0], 0.4), "not good enough: repeat")
    return figure


def figure_computer_control() -> Figure:
    """Draw Fig. 2: a computer that controls the process through converters and identifies it from the same samples.

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    Reading notes, Fig. 2; the notes contain only its caption.
    """
    from matplotlib.patches import Rectangle

    figure = new_figure(
        9.0,
        3.4,
        "In the computer, the control turns r(k) and y(k) into u(k), and the identification estimates theta from "
        "u(k) and y(k). A D/A converter leads to the process, an A/D converter back from its output y(t).",
    )
    ax = figure.add_subplot()
    show_as_diagram(ax, 15.6, 6.0)
    ax.add_patch(Rectangle((1.3, 0.2), 7.0, 5.6, facecolor="none", edgecolor="0.5", linestyle="--"))
    label(ax, (2.6, 5.4), "Computer")
    low, back = 2.6, 1.1
    control = block(ax, (3.5, low), "Control", width=2.2)
    identification = block(ax, (5.1, 4.4), "Identification", width=3.0)
    to_plant = block(ax, (9.6, low), "D/A", width=1.4)
    process = block(ax, (12.3, low), "Process", width=2.2)
    from_plant = block(ax, (9.6, back), "A/D", width=1.4, height=0.9)
    arrow(ax, (0.2, low), control.left)
    label(ax, (0.7, low + 0.4), "$r(k)$")
    arrow(ax, control.right, to_plant.left)
    label(ax, (5.4, low + 0.4), "$u(k)$")
    arrow(ax, to_plant.right, process.left)
    arrow(ax, process.right, (15.2, low))
    label(ax, (14.7, low + 0.4), "$y(t)$")
    branch(ax, (14.1, low))
    arrow(ax, (14.1, low), (14.1, back), from_plant.right)
    arrow(ax, from_plant.left, (control.bottom[0], back), control.bottom)
    label(ax, (5.4, back - 0.45), "$y(k)$")
    # u(k) and y(k) enter the identification, and its estimate enters the control.
    branch(ax, (6.2, low))
    arrow(ax, (6.2, low), (6.2, identification.bottom[1]))
    branch(ax, (7.4, back))
    arrow(ax, (7.4, back), (7.4, 4.4), identification.right)
    arrow(ax, identification.left, (2.9, 4.4), (2.9, control.top[1]))
    label(ax, (2.45, 3.7), r"$\hat{\theta}$")
    return figure


def figure_systems_1_and_2() -> Figure:
    """Draw Fig. 6: in System 1 the noise enters inside the loop, in System 2 it is added to the output.

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    Reading notes, Fig. 6, with the equations of Systems 1 and 2 of lecture 3.
    """
    figure = new_figure(
        9.6,
        3.0,
        "Two loops with a delay at the input and 0.8 of the last output fed back. In System 1 the noise e(t) enters "
        "inside of the loop; in System 2 it is added to the output behind the loop.",
    )
    left, right = figure.subplots(1, 2)
    _draw_loop(left, noise_in_the_loop=True)
    left.set_title("System 1")
    _draw_loop(right, noise_in_the_loop=False)
    right.set_title("System 2")
    return figure


def _draw_loop(ax: Axes, noise_in_the_loop: bool) -> None:
    """Draw x(t) = u(t-1) + 0.8 x(t-1) with the noise added inside the loop or to its output."""
    show_as_diagram(ax, 9.6, 4.6)
    y, low, noise = 2.4, 0.6, 4.0
    delay = block(ax, (2.2, y), "$q^{-1}$", width=1.2)
    add = junction(ax, (4.2, y), bottom="$+$", top="$+$" if noise_in_the_loop else "")
    back = block(ax, (5.4, low), r"$0.8\,q^{-1}$", width=1.6)
    arrow(ax, (0.2, y), delay.left)
    label(ax, (0.7, y + 0.4), "$u(t)$")
    arrow(ax, delay.right, add.left)
    corner = (6.6, y)
    branch(ax, corner)
    arrow(ax, corner, (corner[0], low), back.right)
    arrow(ax, back.left, (add.bottom[0], low), add.bottom)
    label(ax, (8.9, y + 0.4), "$y(t)$")
    if noise_in_the_loop:
        entry = add
        arrow(ax, add.right, (9.4, y))
    else:
        entry = junction(ax, (7.7, y), top="$+$")
        arrow(ax, add.right, entry.left)
        arrow(ax, entry.right, (9.4, y))
        label(ax, (5.4, y + 0.4), "$x(t)$")
    arrow(ax, (entry.top[0], noise), entry.top)
    label(ax, (entry.top[0] + 0.6, noise - 0.2), "$e(t)$")
