"""The ordinary records are what their labels say, read from their files alone."""

import io
import json
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
from scipy.linalg import toeplitz

from labsid.blind.output_error import fit_linear
from labsid.rig.ordinary.kinds import KINDS
from labsid.rig.ordinary.measured import DIRECT
from labsid.rig.ordinary.record_files import OrdinaryRecord

DRAWS = 5
ITSELF = [kind for kind in KINDS if kind.startswith("itself")]


@cache
def drawn(kind: str) -> tuple[OrdinaryRecord, ...]:
    """The first records of a kind."""
    found = []
    for number in range(DRAWS):
        rngs = (np.random.default_rng([7, list(KINDS).index(kind), number, attempt]) for attempt in range(100))
        found.append(next(made for made in map(KINDS[kind], rngs) if made is not None))
    return tuple(found)


def columns(text: str) -> dict[str, np.ndarray]:
    header, rest = text.split("\n", 1)
    return dict(zip(header.split(","), np.loadtxt(io.StringIO(rest), delimiter=",").T, strict=True))


def record(made: OrdinaryRecord) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    read = columns(made.files[".csv"])
    return read["t"], read["u"], read["y"]


def left_by_second_order(u: np.ndarray, y: np.ndarray) -> float:
    """One-step error of a difference equation of the second order with a direct term, over the motion of y."""
    Phi = np.column_stack([y[1:-1], y[:-2], u[2:], u[1:-1], u[:-2], np.ones(y.size - 2)])
    scale = np.max(np.abs(Phi), axis=0)
    Phi = Phi / np.where(scale > 0, scale, 1.0)
    return float(np.sqrt(np.mean((y[2:] - Phi @ np.linalg.lstsq(Phi, y[2:])[0]) ** 2)) / np.std(y))


def left_by_impulse_response(u: np.ndarray, y: np.ndarray, taps: int = 250) -> float:
    """Error of a moving average of the input, which starts at rest, on the later half of it."""
    v = u - u[0]
    Phi = np.column_stack([toeplitz(v, np.zeros(taps)), np.ones(v.size)])
    weak = 1e-4 * np.linalg.norm(Phi, 2) * np.eye(taps + 1)[:-1]
    fitted = np.linalg.lstsq(np.vstack([Phi, weak]), np.concatenate([y, np.zeros(taps)]))[0]
    return float(np.sqrt(np.mean((y - Phi @ fitted) ** 2)))


@pytest.mark.parametrize("kind", KINDS)
def test_records_repeat_from_their_seed_and_differ(kind: str) -> None:
    first = drawn(kind)
    drawn.cache_clear()
    again = drawn(kind)
    assert [made.files for made in first] == [made.files for made in again]
    assert len({made.files[".csv"] for made in first}) == DRAWS


@pytest.mark.parametrize("kind", KINDS)
def test_files_are_those_of_the_command_line(kind: str) -> None:
    for made in drawn(kind):
        t, u, y = record(made)
        assert 700 <= t.size <= 2000
        np.testing.assert_allclose(np.diff(t), t[1] - t[0], rtol=2e-3)
        assert np.std(u) > 0
        assert np.std(y) > 0
        assert set(made.files) - {".csv"} <= {".sim.json", ".sim.csv", ".py"}
        assert (".py" in made.files) == (made.options[:2] == ("--sim", "NAME.py:simulate"))
        assert made.answers
        assert ("--free" in made.options) == (made.numbers is not None)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind.startswith("exact")])
def test_exact_records_are_linear_to_their_last_digit(kind: str) -> None:
    digits = {"exact-17-digits": 1e-8, "exact-6-digits": 1e-3, "exact-4-digits": 0.05, "exact-float32": 1e-4}[kind]
    for made in drawn(kind):
        _, u, y = record(made)
        late = round(made.truth["delay"] / float(np.diff(record(made)[0]).mean()))
        assert left_by_second_order(u[: u.size - late], y[late:]) < digits
        if late > 1:
            assert made.answers == (("input-delay",),)
            ahead = np.append(u[1:], u[-1])  # so that the first tap is a direct term
            best = fit_linear(ahead, y, [0.95, 0.7], taps=3).rmse
            assert best > 3e-3 * np.ptp(y)
        else:
            assert made.answers == ((), ("input-delay",))[: 1 + late]


@pytest.mark.parametrize("kind", DIRECT)
def test_the_output_of_a_system_with_a_direct_term_moves_in_the_same_sample(kind: str) -> None:
    steps = [made for made in drawn(kind) if made.truth["signal"] in ("steps", "prbs")]
    for made in steps:
        _, u, y = record(made)
        jumps = np.flatnonzero(np.diff(u)[2:-2]) + 2
        noise = np.std(np.diff(y)[np.abs(np.diff(u)) == 0])
        assert np.median(np.abs(np.diff(y)[jumps])) > noise


@pytest.mark.parametrize("kind", ITSELF)
def test_a_simulation_beside_its_own_output_leaves_noise_alone(kind: str) -> None:
    for made in drawn(kind):
        t, u, y = record(made)
        assert made.answers == ((),)
        if ".sim.json" in made.files:
            model = json.loads(made.files[".sim.json"])
            from control import forced_response, tf

            system = tf(model["num"], model["den"], model["dt"])
            run = model["y0"] + forced_response(system, U=u - model["u0"]).outputs
        elif ".sim.csv" in made.files:
            simulated = columns(made.files[".sim.csv"])
            run = np.interp(t, simulated["t"], simulated["y"])
        else:
            module: dict[str, Callable[..., np.ndarray]] = {}
            exec(made.files[".py"], module)
            run = module["simulate"](t, u)
        e = y - run
        assert np.std(e) < 0.03 * np.std(y)
        exact = np.max(np.abs(e)) < 1e-6 * np.max(np.abs(y))
        assert exact or np.abs(np.corrcoef(e[1:], e[:-1])[0, 1]) < 0.15


def test_other_times_are_other_times() -> None:
    for made in drawn("itself-output-other-times"):
        t, simulated = record(made)[0], columns(made.files[".sim.csv"])["t"]
        assert simulated.size != t.size
        assert simulated[0] == t[0]
        assert simulated[-1] >= t[-1]


@pytest.mark.parametrize("kind", ["command-off", "command-off-for-a-while", "coarse-command"])
def test_what_acts_is_not_what_the_log_has(kind: str) -> None:
    for made in drawn(kind):
        t, u, y = record(made)
        acting = u.copy()
        if "step" in made.truth:
            step = made.truth["step"]
            near, below = step * np.rint(u / step), step * np.floor(u / step)
            rests = [left_by_impulse_response(x, y) for x in (near, below)]
            assert min(rests) < 0.6 * left_by_impulse_response(u, y)
            assert made.answers == (("input-quantization",),)
            continue
        end = np.inf if made.truth["end"] is None else made.truth["end"]
        off = (t > made.truth["onset"] - 0.5 * t[1]) & (t < end - 0.5 * t[1])
        acting[off] = made.truth["level"]
        assert left_by_impulse_response(acting, y) < 0.5 * left_by_impulse_response(u, y)
        assert made.answers == (("input-off",),)
        assert (made.truth["end"] is None) == (kind == "command-off")


def test_a_coarse_log_has_few_levels_and_leaves_less_than_its_steps() -> None:
    for made in drawn("coarse-log"):
        _, u, _ = record(made)
        ratio = u / made.truth["step"]
        np.testing.assert_allclose(ratio, np.rint(ratio), atol=1e-5)
        assert ("input-quantization",) in made.answers
        assert () in made.answers


@pytest.mark.parametrize("kind", ["clipped-one-side", "clipped-both-sides"])
def test_a_clipped_output_stands_at_its_limits(kind: str) -> None:
    for made in drawn(kind):
        y = record(made)[2]
        limits = [made.truth[side] for side in ("low", "high") if side in made.truth]
        assert len(limits) == (1 if kind == "clipped-one-side" else 2)
        for limit in limits:
            assert np.mean(np.abs(y - limit) < 0.1 * np.std(y)) > 0.03
        assert made.answers == (("output-saturation",),)


def test_a_simulated_output_lacks_only_the_limits() -> None:
    for kind in ("simulated-output-limit", "simulated-output-none"):
        for made in drawn(kind):
            t, u, y = record(made)
            simulated = columns(made.files[".sim.csv"])
            np.testing.assert_allclose(simulated["t"], t)
            left = np.std(y - simulated["y"]) / np.std(y)
            limits = {side: made.truth[side] for side in ("low", "high") if side in made.truth}
            assert bool(limits) == (kind == "simulated-output-limit") == (left > 0.026)
            if limits:
                clipped = np.clip(u, limits.get("low"), limits.get("high"))
                assert 0.04 < np.mean(clipped != u) < 0.65


def test_slow_noise_may_have_a_name_only_where_it_is_slow_for_the_rig() -> None:
    some = [made for n in range(12) if (made := KINDS["slow-noise"](np.random.default_rng([8, n]))) is not None]
    assert {made.answers for made in some} == {((),), ((), ("coloured-noise",))}
    for made in some:
        t = record(made)[0]
        if len(made.answers) > 1:
            assert made.truth["correlation_time"] > 5.0 * (t[1] - t[0])


def test_an_integrator_does_not_come_back() -> None:
    for made in drawn("integrating"):
        _, u, y = record(made)
        assert abs(np.mean(u)) < 1e-6 * np.ptp(u)
        assert np.ptp(y) > 4.0 * np.std(np.diff(y))
