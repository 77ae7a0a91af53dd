"""The figure of several records."""

import numpy as np
import pytest
from gap_reports import report

from labsid.plots.gap_records import figure_records

NAMES = ("run-1", "a & $b$ <i>")


@pytest.fixture
def shown():
    """A report of two records, whose first 10 of 40 samples are not scored and have a large error."""
    base = report("input-delay")
    base["record"]["Ts"] = 0.5
    base["records"] = [{"name": name, "unscored": 10} for name in NAMES]
    t = 0.5 * np.arange(40)
    counts = (t >= 5.0).astype(float)
    trace = {
        "t": t,
        "u": t,
        "y": np.sin(t),
        "before": np.where(counts > 0, 0.0, 80.0),
        "after": np.sin(t),
        "counts": counts,
    }
    return base | {"record_traces": [trace, trace | {"y": np.cos(t)}]}


@pytest.mark.parametrize("narrow", [False, True])
def test_each_record_has_a_row_with_its_name_and_the_scored_samples_set_the_axes(shown, narrow, covered):
    figure = figure_records(shown, narrow)
    outputs, errors = figure.axes[::2], figure.axes[1::2]
    assert [ax.get_title().replace("\\$", "$") for ax in outputs] == list(NAMES)
    for ax in (*outputs, *errors):
        assert max(map(abs, ax.get_ylim())) < 2.0
        assert ax.get_xlim() == pytest.approx((0.0, 19.5))
    np.testing.assert_allclose(outputs[1].lines[0].get_ydata(), shown["record_traces"][1]["y"])
    assert covered(figure) == []
