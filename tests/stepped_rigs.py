"""A pendulum in a position loop as a class that is stepped, and the same one with effects built in, in fine steps."""

import math
from typing import Any

import numpy as np

FINE = 100  # steps of the exact solution for each sample


class Pendulum:
    """An arm of inertia 1 with gravity, damping, and a drive of limited force on the error of its position."""

    def __init__(self, k: float = 200.0, d: float = 10.0, g: float = 60.0, limit: float = 200.0) -> None:
        self.k, self.d, self.g, self.limit = k, d, g, limit

    def reset(self, position: float, speed: float = 0.0) -> float:
        """Begin at a position and a speed."""
        self.q, self.v = position, speed
        return self.q

    def save(self) -> Any:
        """The state."""
        return self.q, self.v

    def restore(self, state: Any) -> None:
        """Go back to a state."""
        self.q, self.v = state

    def motion(self) -> tuple[float, float]:
        """Position and speed."""
        return self.q, self.v

    def step(self, u: float, force: float) -> float:
        """One sample of 5 ms: Heun's method in two steps."""
        h, q, v = 0.0025, self.q, self.v
        for _ in range(2):
            a = self._acceleration(u, q, v) + force
            b = self._acceleration(u, q + h * v, v + h * a) + force
            q, v = q + h * (v + 0.5 * h * a), v + 0.5 * h * (a + b)
        self.q, self.v = q, v
        return q

    def _acceleration(self, u: float, q: float, v: float) -> float:
        return min(max(self.k * (u - q), -self.limit), self.limit) - self.d * v - self.g * math.sin(q)


def command(seed: int, samples: int) -> np.ndarray:
    """Random levels that are held for 30 samples."""
    return np.repeat(np.random.default_rng(seed).uniform(-1.0, 1.0, samples // 30 + 1), 30)[:samples]


def built_in(
    u: np.ndarray, Ts: float = 0.005, k: float = 200.0, d: float = 10.0, limit: float = 200.0, **changes: float
) -> np.ndarray:
    """Position of the pendulum with changes in it, as they are called in `labsid.simulators`, in fine steps."""
    h, q, v, level = Ts / FINE, 0.0, 0.0, float(u[0])
    of = {"stribeck": 1.0, "low": -1e9, "high": 1e9, "frequency": 1.0}
    of = dict.fromkeys(("friction", "peak", "damping", "drag", "stiffness", "cubic", "lag", "load", "onset"), 0.0) | of
    of = dict.fromkeys(("gravity_sin", "gravity_cos", "wave_cos", "wave_sin"), 0.0) | of | changes
    share = 1.0 - math.exp(-h / of["lag"]) if of["lag"] else 1.0
    omega, out = 2.0 * math.pi * of["frequency"], np.empty(u.size)
    for n in range(u.size * FINE):
        if n % FINE == 0:
            out[n // FINE] = q
        t = n * h
        level += share * (u[n // FINE] - level)
        force = min(max(k * (level - q), -limit), limit) - d * v - 60.0 * math.sin(q)
        force -= (of["damping"] + of["drag"] * abs(v)) * v + (of["stiffness"] + of["cubic"] * q * q) * q
        force += of["gravity_sin"] * math.sin(q) + of["gravity_cos"] * math.cos(q)
        force += of["load"] if t >= of["onset"] else 0.0
        force += of["wave_cos"] * math.cos(omega * t) + of["wave_sin"] * math.sin(omega * t)
        held = h * (of["friction"] + of["peak"] * math.exp(-((v / of["stribeck"]) ** 2)))
        v = math.copysign(max(abs(v + h * force) - held, 0.0), v + h * force)
        q += h * v
        if not of["low"] < q < of["high"]:
            v = max(v, 0.0) if q <= of["low"] else min(v, 0.0)
            q = min(max(q, of["low"]), of["high"])
    return out
