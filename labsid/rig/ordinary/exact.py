"""Records without noise: what a simulation prints."""

import numpy as np

from labsid.rig.ordinary.record_files import NONE, OrdinaryRecord, draw_bench, record_table
from labsid.rig.ordinary.signals import SIGNALS, draw_signal
from labsid.rig.ordinary.systems import draw_first_order, draw_pure_gain, draw_second_order, response

FORMS = {"exact-17-digits": "%.17g", "exact-6-digits": "%.6g", "exact-4-digits": "%.4g", "exact-float32": "float32"}

_DELAYED, _SHORT = 0.35, 0.3  # share of the records with a delay, and of these with one of a sample
_DELAYS = (0.3, 1.5)  # longer delays over the time constant; after a jump no model of the second order imitates them
_JUMPING = ("levels", "steps", "prbs")
_LEAST_MOTION = 0.1  # standard deviation over the largest value, of input and output


def draw_exact(rng: np.random.Generator, kind: str) -> OrdinaryRecord | None:
    """A static gain, a first or a second order, with or without a delay.

    Parameters
    ----------
    rng : Generator
    kind : str
        One of `FORMS`.

    Returns
    -------
    OrdinaryRecord or None
        With a delay, the answer is the delay; if a linear model of the second order holds the delay, also none. None
        if the printed digits would show little of the motion.
    """
    bench = draw_bench(rng)
    order = int(rng.integers(3))
    system = (draw_pure_gain, draw_first_order, draw_second_order)[order](rng)
    delay, is_short = 0, order < 2 and rng.random() < _SHORT
    if rng.random() < _DELAYED:
        delay = 1 if is_short else max(3, round(rng.uniform(*_DELAYS) * system.time))
    signal = str(rng.choice(_JUMPING if delay else SIGNALS))
    u = bench.u0 + bench.us * draw_signal(rng, signal, bench.samples, system.time)
    y = bench.y0 + response(system, u, settled=bool(rng.random() < 0.5), delay=delay)
    if min(np.std(x) / np.max(np.abs(x)) for x in (u, y)) < _LEAST_MOTION:
        return None
    answers = ((NONE,), (NONE, ("input-delay",)), (("input-delay",),))[min(delay, 2)]
    truth = {"signal": signal, "order": order, "delay": delay * bench.Ts}
    return OrdinaryRecord(answers, {".csv": record_table(bench, u, y, FORMS[kind])}, truth)
