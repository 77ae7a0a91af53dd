"""The answer to an explanation, for tests of what is decided from it."""

import numpy as np

from labsid.gap.search.explanation import Explanation
from labsid.gap.simulations.baseline import make_baseline
from labsid.gap.verdict.answer import Answer, answer_from
from labsid.records.record import Record


def answered(explained: Explanation) -> Answer:
    """The answer without a given simulation."""
    data = explained.data
    u, y = (np.asarray(scale.back(x)) for scale, x in ((data.u_scale, data.u), (data.y_scale, data.y)))
    record = Record(np.arange(u.size) * data.Ts, u, y, data.Ts)
    base = make_baseline(data, record.t, None, 2)
    return answer_from(record, explained, base, None, np.random.default_rng(0))
