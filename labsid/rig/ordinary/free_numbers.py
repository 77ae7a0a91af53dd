"""Simulations whose numbers are wrong and may be fitted; a record need not determine all of them."""

from collections.abc import Sequence

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.ordinary.functions import (
    FIRST_ORDER,
    LIMITED,
    PRODUCT,
    RATIO,
    SECOND_ORDER,
    WrittenFunction,
    draw_numbers,
)
from labsid.rig.ordinary.record_files import Bench, OrdinaryRecord, TrueNumbers, draw_bench, noisy, record_table
from labsid.rig.ordinary.signals import SIGNALS, draw_signal

_DETERMINED = 0.0125  # largest standard error of a number over its value: a quarter of the 5 % that are asked for
_CLEAR = 6.0  # rms error of the nominal simulation over the noise


def draw_free_far(rng: np.random.Generator) -> OrdinaryRecord | None:
    """Nominal values 3 to 40 times too large or too small, and sometimes a gain of the other sign."""
    bench = draw_bench(rng)
    function = FIRST_ORDER if rng.random() < 0.6 else SECOND_ORDER
    true = draw_numbers(rng, function, bench.Ts)
    nominal = _away(rng, true, (3.0, 40.0))
    if rng.random() < 0.2:
        nominal["gain"] *= -1.0
    return _record(rng, bench, function, true, nominal, tuple(true))


def draw_free_pair(rng: np.random.Generator) -> OrdinaryRecord | None:
    """Two numbers of which only the product, or only the ratio, acts."""
    bench = draw_bench(rng)
    function, (one, two), sign = [(PRODUCT, ("ka", "kb"), "*"), (RATIO, ("force", "stiffness"), "/")][rng.integers(2)]
    gain, tau = draw_numbers(rng, FIRST_ORDER, bench.Ts).values()
    first = float(f"{np.exp(rng.uniform(-1.5, 1.5)):.5g}")
    true = {one: first, two: gain / first if sign == "*" else first / gain, "tau": tau}
    made = _record(rng, bench, function, true, _away(rng, true, (1.3, 4.0)), ("tau",))
    return None if made is None else _undetermined(made, (one, two), f"{one}{sign}{two}", gain)


def draw_free_idle(rng: np.random.Generator) -> OrdinaryRecord | None:
    """A limit that the input never reaches, beside numbers that act."""
    bench = draw_bench(rng)
    true = draw_numbers(rng, FIRST_ORDER, bench.Ts)
    limit = float(f"{bench.us * rng.uniform(2.0, 20.0):.3g}")
    nominal = {**_away(rng, true, (1.3, 6.0)), "limit": limit}
    made = _record(rng, bench, LIMITED, {**true, "limit": limit}, nominal, tuple(true))
    return None if made is None else _undetermined(made, ("limit",))


def _record(
    rng: np.random.Generator,
    bench: Bench,
    function: WrittenFunction,
    true: dict[str, float],
    nominal: dict[str, float],
    determined: Sequence[str],
) -> OrdinaryRecord | None:
    """A noisy record of the true simulation beside the nominal one; None if it leaves a number open."""
    time = true.get("tau", 1.0 / true.get("omega", 1.0)) / bench.Ts
    signal = str(rng.choice(SIGNALS))
    u = bench.us * draw_signal(rng, signal, bench.samples, time)
    clean = function.run(true, bench.t, u)
    y, sd = noisy(rng, clean, bench.noise)
    if np.std(clean - function.run(nominal, bench.t, u)) < _CLEAR * sd:
        return None
    if np.max(_relative_errors(function, true, determined, bench.t, u, sd)) > _DETERMINED:
        return None
    return OrdinaryRecord(
        answers=(("parameter-mismatch",),),
        files={".csv": record_table(bench, u, y), ".py": function.text(nominal)},
        truth={"signal": signal, "nominal": nominal},
        options=("--sim", "NAME.py:simulate", "--free", ",".join(true)),
        numbers=TrueNumbers({name: true[name] for name in determined}),
    )


def _undetermined(
    made: OrdinaryRecord, names: tuple[str, ...], combination: str = "", value: float = 0.0
) -> OrdinaryRecord:
    assert made.numbers is not None
    numbers = TrueNumbers(made.numbers.determined, names, combination, value)
    return OrdinaryRecord(made.answers, made.files, made.truth, made.options, numbers)


def _away(rng: np.random.Generator, true: dict[str, float], factors: tuple[float, float]) -> dict[str, float]:
    """Nominal values that are wrong by factors in a range, each up or down."""
    low, high = np.log(factors)
    return {
        name: float(f"{value * np.exp(rng.uniform(low, high) * rng.choice([-1.0, 1.0])):.5g}")
        for name, value in true.items()
    }


def _relative_errors(
    function: WrittenFunction, true: dict[str, float], names: Sequence[str], t: FloatArray, u: FloatArray, sd: float
) -> FloatArray:
    """Standard errors of the numbers over their values, by linear propagation beside a free offset."""
    slopes = [np.ones(t.size)]
    for name in names:
        ends = [function.run({**true, name: true[name] * (1.0 + step)}, t, u) for step in (-1e-4, 1e-4)]
        slopes.append((ends[1] - ends[0]) / 2e-4)
    R = np.linalg.qr(np.column_stack(slopes), mode="r")
    if np.linalg.cond(R / np.linalg.norm(R, axis=0)) > 1e6:
        return np.full(len(names), np.inf)
    inverse = np.linalg.inv(R)
    return np.asarray(sd * np.linalg.norm(inverse, axis=1)[1:])
