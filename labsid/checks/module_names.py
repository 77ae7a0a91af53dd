"""In which module a function is that stands without the name of its module."""

import re
from importlib import import_module

import numpy as np

_MODULES = (
    ("np", "numpy"), ("np.linalg", "numpy.linalg"), ("ct", "control"),
    ("scipy.linalg", "scipy.linalg"), ("scipy.signal", "scipy.signal"), ("scipy.optimize", "scipy.optimize"),
    ("math", "math"),
)  # fmt: skip
"""Where a function may be that is called by its name alone: as a notebook writes the module, and the module."""
_SUBMODULES = {
    "linalg": ("np.linalg", "scipy.linalg"), "fft": ("np.fft",), "random": ("np.random",), "stats": ("scipy.stats",),
    "signal": ("scipy.signal",), "optimize": ("scipy.optimize",), "interpolate": ("scipy.interpolate",),
    "integrate": ("scipy.integrate",), "ticker": ("matplotlib.ticker",), "patches": ("matplotlib.patches",),
    "la": ("np.linalg", "scipy.linalg"), "LA": ("np.linalg", "scipy.linalg"), "nl": ("np.linalg",),
    "sig": ("scipy.signal",), "opt": ("scipy.optimize",), "sp": ("scipy",),
}  # fmt: skip
"""Parts of modules, by the name that may stand alone, or by which they are often imported elsewhere."""
_DISTRIBUTIONS = ("t", "norm", "chi2", "f", "uniform", "expon")
"""Of `scipy.stats`, those whose name may stand alone."""

_IN_NUMPY = {"pow": "power", "ln": "log", "asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": "arctan2"}
"""What functions of Python's `math`, or what is taken for one, are called in numpy."""


def in_place_of_math(line: str) -> str:
    """What stands for a part of Python's `math`, which is not imported."""
    taken = re.search(r"(?<![\w.])math\.(\w+)", line)
    name = "" if taken is None else _IN_NUMPY.get(taken[1], taken[1])
    thing = getattr(import_module("numpy"), name, None) if name else None
    if taken is None or thing is None:
        return "Python's `math` is not imported here: its functions are there after `import math`."
    natural = ", the natural logarithm" if name == "log" else ""
    of_arrays = ", which takes one number or an array" if callable(thing) else ""
    return f"Python's `math` is not imported here, and not needed: numpy has `np.{name}`{natural}{of_arrays}."


def module_of(name: str, line: str, is_called: bool) -> str:
    """In which module a name is: of a function that is called, or of a part of which something is taken; or nothing.

    That the module has what is taken of it was looked up.
    """
    if is_called:
        for written, module in _MODULES:
            found = getattr(import_module(module), name, None)
            if callable(found) and not isinstance(found, type):
                imported = ", after `import math`" if module == "math" else ""
                return f"It is a function of {module.partition('.')[0]}: `{written}.{name}`{imported}."
    taken = re.search(rf"(?<![\w.]){name}\.(\w+)", line)
    for path in _SUBMODULES.get(name, ()) if taken is not None else ():
        module = re.sub(r"^np\b", "numpy", path)
        if taken is not None and hasattr(import_module(module), taken[1]):
            return f"It is a part of {module.partition('.')[0]}: `{path}.{taken[1]}`."
    # an array has a mean, too: what arrays have does not tell that the name is a distribution
    is_one = taken is not None and name in _DISTRIBUTIONS and not hasattr(np.ndarray, taken[1])
    if is_one and taken is not None and hasattr(getattr(import_module("scipy.stats"), name), taken[1]):
        return f"It is a distribution of scipy: `scipy.stats.{name}.{taken[1]}`."
    return ""
