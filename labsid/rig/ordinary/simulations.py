"""Records with a simulation that is right, or that lacks the limits of the actuator."""

import json

import numpy as np

from labsid._arrays import FloatArray
from labsid.rig.ordinary.functions import FIRST_ORDER, LIMITED, SECOND_ORDER, TANK, WrittenFunction, draw_numbers
from labsid.rig.ordinary.record_files import (
    NONE,
    Bench,
    OrdinaryRecord,
    TrueNumbers,
    draw_bench,
    noisy,
    record_table,
    table_text,
)
from labsid.rig.ordinary.signals import MANY_LEVELS, SIGNALS, draw_signal
from labsid.rig.ordinary.systems import (
    discretised,
    draw_first_order,
    draw_lead,
    draw_proper_second_order,
    draw_second_order,
    response,
)

_NOISY = 0.5  # share of the records of a simulation beside its own output
_SEEN = 4.0  # rms change of the output by a limit, over the noise
_UNSEEN = 0.1  # error of an interpolation, over the noise


def draw_itself_json(rng: np.random.Generator) -> OrdinaryRecord:
    """A transfer function beside its own output."""
    bench = draw_bench(rng)
    draws = (draw_first_order, draw_second_order, draw_lead, draw_proper_second_order)
    system = draws[rng.choice(4, p=[0.3, 0.4, 0.15, 0.15])](rng)
    num, den = discretised(system)
    v = bench.us * draw_signal(rng, str(rng.choice(SIGNALS)), bench.samples, system.time)
    y = bench.y0 + response(system, v)
    if rng.random() < 0.5:
        num = np.trim_zeros(num, "f")
    model = {"num": num.tolist(), "den": den.tolist(), "dt": bench.Ts, "u0": bench.u0, "y0": bench.y0}
    record = _itself(rng, bench, bench.u0 + v, y)
    return OrdinaryRecord((NONE,), {".csv": record, ".sim.json": json.dumps(model)})


def draw_itself_output(rng: np.random.Generator, other_times: bool) -> OrdinaryRecord | None:
    """The output of a simulation, as a file, beside the same output.

    Parameters
    ----------
    rng : Generator
    other_times : bool
        Whether the file has other times than the record: finer ones, or those of a solver with a variable step.
    """
    bench, function, numbers = _draw_function(rng)
    if not other_times:
        u = _input(rng, bench, function, numbers)
        y = function.run(numbers, bench.t, u)
        files = {".csv": _itself(rng, bench, u, y), ".sim.csv": table_text("t,y", "%.10g", bench.t, y)}
        return OrdinaryRecord((NONE,), files)
    within = int(rng.integers(2, 6))
    u = _input(rng, bench, function, numbers)
    fine = bench.Ts / within * np.arange(bench.samples * within, dtype=np.float64)
    y_fine = function.run(numbers, fine, np.repeat(u, within))
    y = y_fine[::within]
    if rng.random() < 0.5:
        return OrdinaryRecord(
            (NONE,), {".csv": _itself(rng, bench, u, y), ".sim.csv": table_text("t,y", "%.10g", fine, y_fine)}
        )
    y, sd = noisy(rng, y, bench.noise)
    kept = np.flatnonzero(rng.random(fine.size) < rng.uniform(0.4, 0.8))
    kept = np.unique([0, *kept, fine.size - 1])
    error = np.interp(bench.t, fine[kept], y_fine[kept]) - y_fine[::within]
    if np.sqrt(np.mean(error**2)) > _UNSEEN * sd:
        return None
    files = {".csv": record_table(bench, u, y), ".sim.csv": table_text("t,y", "%.10g", fine[kept], y_fine[kept])}
    return OrdinaryRecord((NONE,), files)


def draw_itself_function(rng: np.random.Generator, free: bool) -> OrdinaryRecord:
    """A Python function beside its own output.

    Parameters
    ----------
    rng : Generator
    free : bool
        Whether its numbers, which are right, may be fitted.
    """
    bench, function, numbers = _draw_function(rng, linear=free)
    u = _input(rng, bench, function, numbers)
    files = {".csv": _itself(rng, bench, u, function.run(numbers, bench.t, u)), ".py": function.text(numbers)}
    options = ("--sim", "NAME.py:simulate")
    if not free:
        return OrdinaryRecord((NONE,), files, options=options)
    return OrdinaryRecord((NONE,), files, {}, (*options, "--free", ",".join(numbers)), TrueNumbers(numbers))


def draw_simulated_output(rng: np.random.Generator, limited: bool) -> OrdinaryRecord | None:
    """A measured record and the output of a linear simulation as a file.

    Parameters
    ----------
    rng : Generator
    limited : bool
        Whether the actuator of the rig has limits, which the simulation lacks.
    """
    bench = draw_bench(rng)
    system = (draw_first_order if rng.random() < 0.4 else draw_second_order)(rng)
    signal = str(rng.choice(MANY_LEVELS if limited else SIGNALS))
    u = bench.us * draw_signal(rng, signal, bench.samples, system.time)
    settled = bool(rng.random() < 0.4)
    simulated = response(system, u, settled)
    low, high = np.quantile(u, rng.uniform([0.05, 0.7], [0.3, 0.95]))
    side = str(rng.choice(["both", "low", "high"], p=[0.5, 0.25, 0.25]))
    limits = {"low": float(low), "high": float(high)}
    limits = {name: level for name, level in limits.items() if limited and side in ("both", name)}
    acting = np.clip(u, limits.get("low", -np.inf), limits.get("high", np.inf))
    clean = response(system, acting, settled)
    y, sd = noisy(rng, clean, bench.noise)
    if limited:
        basis = np.column_stack([simulated, np.ones(bench.samples)])  # what another gain and offset would leave
        if np.std(clean - basis @ np.linalg.lstsq(basis, clean)[0]) < _SEEN * sd:
            return None
    files = {".csv": record_table(bench, u, y), ".sim.csv": table_text("t,y", "%.10g", bench.t, simulated)}
    return OrdinaryRecord((("input-saturation",),) if limited else (NONE,), files, {"signal": signal, **limits})


def _draw_function(rng: np.random.Generator, linear: bool = False) -> tuple[Bench, WrittenFunction, dict[str, float]]:
    """A bench, a simulation and its numbers; nonlinear ones are a limited actuator and a tank."""
    bench = draw_bench(rng)
    if linear or rng.random() < 0.6:
        function = FIRST_ORDER if rng.random() < 0.5 else SECOND_ORDER
        return bench, function, draw_numbers(rng, function, bench.Ts)
    if rng.random() < 0.5:
        limit = float(f"{bench.us * rng.uniform(0.4, 0.8):.4g}")
        return bench, LIMITED, {**draw_numbers(rng, LIMITED, bench.Ts), "limit": limit}
    level, time = rng.uniform(0.5, 20.0), bench.Ts * rng.uniform(10.0, 40.0)  # at the mean input, and its time constant
    outlet = np.sqrt(level) / (2.0 * time)
    pump = outlet * np.sqrt(level) / bench.us
    return bench, TANK, {"pump": float(f"{pump:.5g}"), "outlet": float(f"{outlet:.5g}")}


def _input(rng: np.random.Generator, bench: Bench, function: WrittenFunction, numbers: dict[str, float]) -> FloatArray:
    """An input that suits a simulation: about zero, but for a tank, whose pump only runs forward."""
    time = 25.0 if function is TANK else numbers.get("tau", 1.0 / numbers.get("omega", 1.0)) / bench.Ts
    v = draw_signal(rng, str(rng.choice(SIGNALS)), bench.samples, time)
    return bench.us * (1.0 + 0.8 * v if function is TANK else v)


def _itself(rng: np.random.Generator, bench: Bench, u: FloatArray, y: FloatArray) -> str:
    """Text of a record of a simulation's own output, with noise in half of the cases."""
    if rng.random() < _NOISY:
        y, _ = noisy(rng, y, bench.noise)
    return record_table(bench, u, y, "%.10g")
