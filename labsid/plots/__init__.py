"""The figures of the lab. No module imports pyplot; matplotlib is loaded with the first figure."""

from labsid.plots.block_diagrams import figure_2, figure_3, figure_4
from labsid.plots.captions import CAPTIONS
from labsid.plots.lab import figure_1, figure_5, figure_6, figure_offsets, plot_input
from labsid.plots.step_response import figure_a1, figure_a2
from labsid.plots.style import save_png, save_svg
from labsid.plots.verification import (
    figure_7,
    figure_7_initial_state,
    figure_8,
    plot_simulated_on_measured,
)

__all__ = [
    "CAPTIONS",
    "figure_1",
    "figure_2",
    "figure_3",
    "figure_4",
    "figure_5",
    "figure_6",
    "figure_7",
    "figure_7_initial_state",
    "figure_8",
    "figure_a1",
    "figure_a2",
    "figure_offsets",
    "plot_input",
    "plot_simulated_on_measured",
    "save_png",
    "save_svg",
]
