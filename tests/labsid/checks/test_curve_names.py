"""Legends that give a curve the name of another one."""

import matplotlib.pyplot as plt
import pytest

from labsid.checks.curve_names import NamedCurve, require_own_names
from labsid.checks.verdict import NoAnswer
from labsid.plots.describe import describe_figure


def check(first: str, second: str) -> None:
    """The check of a figure with these two entries."""
    fig, ax = plt.subplots()
    ax.plot([0, 1], [0, 1], label=first)
    ax.plot([0, 1], [1, 0], label=second)
    ax.legend()
    axes = describe_figure(fig).axes[0]
    plt.close(fig)
    one, other = axes.curves
    require_own_names(
        axes, "the figure", NamedCurve(one, "the rig", "rig", "system"), NamedCurve(other, "the fit", "fit", "model")
    )


@pytest.mark.parametrize(
    ("first", "second"), [("fit", "rig"), ("The Fit", "b"), ("a", "rig"), ("model", "system"), ("model", "rig")]
)
def test_the_name_of_the_other_curve_is_refused(first: str, second: str) -> None:
    with pytest.raises(NoAnswer, match="as if it were") as refused:
        check(first, second)
    assert refused.value.slip == "legend entries swapped"


@pytest.mark.parametrize(
    ("first", "second"),
    [("rig", "fit"), ("a", "b"), ("model", "b"), ("model", "fit"), ("system", "fitted system"), ("rig, fitted", "fit")],
)
def test_own_names_and_names_of_neither_are_accepted(first: str, second: str) -> None:
    check(first, second)
