"""The figures of the lab. No module imports pyplot; matplotlib is loaded with the first figure.

The modules are imported when a figure of theirs is first used: while an exercise is graded, those that draw its results
are not there.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from labsid.plots.captions import CAPTIONS
from labsid.plots.style import save_png, save_svg

if TYPE_CHECKING:
    from labsid.plots.block_diagrams import figure_2, figure_3, figure_4
    from labsid.plots.lab import figure_1, figure_5, figure_6, figure_offsets, plot_input
    from labsid.plots.rig_sketch import sketch_rig
    from labsid.plots.step_response import figure_a1, figure_a2
    from labsid.plots.verification import figure_7, figure_7_initial_state, figure_8, plot_simulated_on_measured

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
    "sketch_rig",
]

_MODULES = {
    "block_diagrams": ("figure_2", "figure_3", "figure_4"),
    "lab": ("figure_1", "figure_5", "figure_6", "figure_offsets", "plot_input"),
    "rig_sketch": ("sketch_rig",),
    "step_response": ("figure_a1", "figure_a2"),
    "verification": ("figure_7", "figure_7_initial_state", "figure_8", "plot_simulated_on_measured"),
}
_MODULE_OF = {name: module for module, names in _MODULES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _MODULE_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_MODULE_OF[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
