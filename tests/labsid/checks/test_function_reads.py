"""What is said of a function that reads the notebook's data."""

import linecache
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from labsid.checks.function_reads import made_without_return, reads_beside

VARIABLES: dict[str, Any] = {"t_step": np.arange(50.0), "theta": np.ones(4), "half": 25, "np": np}


def made(source: str) -> Callable[..., Any]:
    names = dict(VARIABLES)
    exec(source, names)
    function: Callable[..., Any] = names["f"]
    return function


@pytest.mark.parametrize(
    ("source", "said"),
    [
        ("def f(t):\n    return t_step[-1]", "`f` never reads its argument `t`, but `t_step` of the notebook."),
        ("def f(t, y):\n    return theta + t_step", "arguments `t` and `y`, but `theta` and `t_step`"),
        ("def f(t):\n    return max(t[0], t_step[-1])", "`f` reads `t_step` of the notebook."),
        ("def f(t):\n    return [t_step[k] for k in t]", "`f` reads `t_step`"),
        ("def f(t):\n    return t @ theta", ""),  # an estimate of an earlier step
        ("def f(t):\n    return t[:half]", ""),
        ("def f(t):\n    t_step = t\n    return t_step", ""),
        ("def f(t):\n    return 1", ""),  # an argument that is not needed
        ("def f(t, y):\n    return half", "`f` reads none of its arguments, `t` and `y`."),
        ("def f(t, y):\n    return half * t", ""),
        ("f = len", ""),
    ],
)
def test_data_read_beside_the_arguments_are_named(source: str, said: str) -> None:
    told = reads_beside("f", made(source), VARIABLES)
    assert said in told
    assert bool(said) == bool(told)


DRAWS = "def f(y):\n    fig, ax = plt.subplots()\n    ax.plot(y)\n"


@pytest.mark.parametrize(
    ("source", "said"),
    [
        (DRAWS, "`f`, which makes it, returns nothing: end it with `return fig`."),
        ("def f(y):\n    theta = y\n", "`f`, which makes it, returns nothing: end it with `return ...`."),
        ("def f(y):\n    if len(y) > 9:\n        return y\n", ""),  # it returns in some cases
        ("def f(y):\n    return y[:0] or None\n", ""),
    ],
)
def test_a_function_without_return_is_named_where_it_made_nothing(source: str, said: str) -> None:
    name = f"<cell {source}>"
    linecache.cache[name] = (len(source), None, source.splitlines(keepends=True), name)
    variables: dict[str, Any] = {}
    exec(compile(source, name, "exec"), variables)
    made_by = ["import numpy as np", f"{source}\n\nfig_1 = f([1])\nother = f([2])"]
    assert made_without_return("fig_1", made_by, {**variables, "fig_1": None}) == said
    assert made_without_return("fig_1", made_by, {**variables, "fig_1": 3}) == ""
    assert made_without_return("fig_2", made_by, {**variables, "fig_2": None}) == ""
