"""Checks of two noisy sinusoids: the sinusoid itself and the statistics of the noise."""

from collections.abc import Callable

import numpy as np

from labsid._arrays import FloatArray
from labsid.checks.verdict import NoAnswer
from labsid.lab.sinusoid import NOISE_BOUND

Wave = Callable[[FloatArray], FloatArray]

# With 1001 samples, right noise fails each limit below in about one run in a million.
BINS = 10
LARGEST_CHI_SQUARE = 45.0
"""Of the counts in `BINS` equal parts of the range: chi-square with 9 degrees of freedom."""
REACHED = 0.95
"""Share of the bound that the largest and the smallest value must reach."""
AT_THE_BOUND = 15
"""Largest number of values that may equal the bound."""
FEW_VALUES = 150
"""Of 1001 samples of continuous noise all values differ; rounded to two digits there are 41 within the bound."""
LEAST_FACTOR = 0.05
"""Smallest value of the sinusoid by which a product is divided again."""
LARGEST_CORRELATION = 0.2
"""Between two noises, or between successive samples of one."""
GAUSSIAN_KURTOSIS = 2.4
"""Lower limit for Gaussian noise, whose kurtosis is 3; that of uniform noise is 1.8."""
STANDARD_ERRORS = 6.0
LARGEST_MEAN = 0.6
"""Of the noise on a wrong sinusoid; this noise may be wrong too."""

_EPSILON = 1e-9
_LISTED = 5

_WRONG_WAVES: tuple[tuple[str, str, Callable[[Wave, FloatArray], FloatArray]], ...] = (
    (
        "period of 50 s",
        "its period is 50 s: there are two periods in 100 s. Check the factor before t",
        lambda wave, t: wave(0.04 * np.pi * t),
    ),
    (
        "period of 200 s",
        "its period is 200 s: only half a period fits into 100 s. The angle is 2 pi t / T",
        lambda wave, t: wave(0.01 * np.pi * t),
    ),
    (
        "degrees instead of radians",
        "the angle is in degrees; np.sin and np.cos take radians, 2 pi for a whole period",
        lambda wave, t: wave(3.6 * t),
    ),
    (
        "degrees instead of radians",
        "the angle was converted as if it were in degrees; it is in radians already",
        lambda wave, t: wave(np.deg2rad(0.02 * np.pi * t)),
    ),
    (
        "pi forgotten",
        "pi is missing in the angle, which is 2 pi t / T",
        lambda wave, t: wave(0.02 * t),
    ),
    (
        "two pi forgotten",
        "2 pi is missing in the angle, which is 2 pi t / T",
        lambda wave, t: wave(t / 100),
    ),
    (
        "period of 2 pi seconds",
        "the angle is t itself, so its period is 2 pi seconds. The angle is 2 pi t / T",
        lambda wave, t: wave(t),
    ),
    (
        "frequency in place of the period",
        "100 s is its period T, not its frequency: the angle is 2 pi t / T",
        lambda wave, t: wave(200 * np.pi * t),
    ),
    (
        "period for the angular frequency",
        "its angle is 100 t: 100 s is the period T, not the factor before t. The angle is 2 pi t / T",
        lambda wave, t: wave(100 * t),
    ),
    (
        "period of 400 s",
        "its period is 400 s: only a quarter of it fits into 100 s. The angle is 2 pi t / T",
        lambda wave, t: wave(0.005 * np.pi * t),
    ),
    (
        "amplitude of a half",
        "its amplitude is 0.5; it should be 1",
        lambda wave, t: 0.5 * wave(0.02 * np.pi * t),
    ),
    (
        "sample number in place of time",
        "its period is 10 s: use the time in seconds, not the sample number",
        lambda wave, t: wave(0.2 * np.pi * t),
    ),
)

_WRONG_SPREADS: tuple[tuple[float, float, str, str], ...] = (
    (0.0, 0.2, "one-sided noise", "is never negative: the bound ±0.2 has two sides"),
    (-0.2, 0.0, "one-sided noise", "is never positive: the bound ±0.2 has two sides"),
    (0.0, 0.4, "noise not centred", "has the right width, but its mean is not zero: shift it"),
    (-0.4, 0.0, "noise not centred", "has the right width, but its mean is not zero: shift it"),
    (-0.1, 0.1, "noise of half the bound", "has a total width of 0.2; within ±0.2 it is 0.4 wide"),
    (-0.4, 0.4, "noise of twice the bound", "extends to twice the bound on both sides"),
    (
        0.0,
        1.0,
        "noise straight from rand",
        "runs from 0 to 1, as the generator draws it: shift and scale it to ±0.2",
    ),
    (-0.5, 0.5, "noise shifted but not scaled", "is 1 wide: scale it to the bound as well"),
    (-1.0, 1.0, "noise shifted but not scaled", "runs from -1 to 1: scale it to the bound as well"),
    (-0.2, 0.8, "noise shifted but not scaled", "is 1 wide: scale it to 0.4 first, then shift it"),
)


def require_real(name: str, t: FloatArray, value: object, wave: Wave) -> None:
    """Refuse the complex exponential; the message says which part of it is the sinusoid."""
    if not isinstance(value, np.ndarray) or value.dtype.kind != "c" or value.size != t.size:
        return
    angle, z = 0.02 * np.pi * t, np.reshape(value, -1)
    residual, size = z - np.exp(1j * angle), np.std(np.exp(1j * angle))
    if np.std(residual.real) < 0.5 * size and np.std(residual.imag) < 0.5 * size:
        of_sine = ("np.sin", "sine", "imaginary", "real")
        function, what, part, other_part = of_sine if wave is np.sin else ("np.cos", "cosine", "real", "imaginary")
        raise NoAnswer(
            f"`{name}` is complex: exp(jx) = cos x + j sin x. The {what} is its {part} part, not the {other_part} one; "
            f"`{function}` gives it directly.",
            "complex exponential",
        )


def require_wave(name: str, t: FloatArray, y: FloatArray, wave: Wave, other: Wave) -> None:
    """Require that `y` is ``wave(2 pi t / 100)`` plus noise; the message names a known wrong wave."""
    right, swapped = wave(0.02 * np.pi * t), other(0.02 * np.pi * t)
    columns = np.column_stack([np.ones(t.size), right, swapped])
    coefficients, *_ = np.linalg.lstsq(columns, y, rcond=None)
    spread = float(np.std(y - columns @ coefficients))
    tolerance = STANDARD_ERRORS * spread * np.sqrt(2 / t.size) + _EPSILON
    if abs(coefficients[1] - 1) <= tolerance and abs(coefficients[2]) <= tolerance:
        return
    if abs(coefficients[2] - 1) <= tolerance and abs(coefficients[1]) <= tolerance:
        raise NoAnswer(f"`{name}`: sine and cosine are swapped. `y1` is the sine.", "sine and cosine swapped")
    require_many_values(name, y - right)
    require_added(name, y, right)
    # a candidate may be constant at the samples, so each is judged by its residual, not by a fit
    rests = [y - made(wave, t) for _, _, made in _WRONG_WAVES]
    nearest = int(np.argmin([np.std(rest) for rest in rests]))
    if np.std(rests[nearest]) < 0.5 * np.std(y - right) and abs(np.median(rests[nearest])) <= LARGEST_MEAN:
        slip, text, _ = _WRONG_WAVES[nearest]
        raise NoAnswer(f"`{name}`: {text}.", slip)
    raise NoAnswer(
        f"`{name}` is not a sinusoid of amplitude 1 and period 100 s about zero, with noise on it: {_seen(t, y)}"
    )


def _seen(t: FloatArray, y: FloatArray) -> str:
    """What a signal looks like: its mean, and the period and the size of its strongest oscillation."""
    spectrum = np.abs(np.fft.rfft(y - y.mean())) * 2 / t.size
    k = int(np.argmax(spectrum))
    if np.ptp(y) < _EPSILON:
        return f"it is constant, {y[0]:.3g}."
    if k == 0 or spectrum[k] < 2 * np.std(y) / np.sqrt(t.size):
        return f"it has the mean {y.mean():.2g} and no clear period."
    period = (t[-1] - t[0]) / k
    return (
        f"its mean is {y.mean():.2g}, its strongest oscillation has a period of {period:.3g} s, "
        f"amplitude {spectrum[k]:.2g}."
    )


def require_added(name: str, product: FloatArray, sinusoid: FloatArray) -> None:
    """Refuse noise that was multiplied by the sinusoid; `product` is what is left of it."""
    far = np.abs(sinusoid) > LEAST_FACTOR
    if _is_uniform(product[far] / sinusoid[far], -NOISE_BOUND, NOISE_BOUND):
        raise NoAnswer(
            f"The noise in `{name}` is multiplied by the sinusoid, so that it vanishes where the sinusoid is zero. Add "
            "it to the sinusoid.",
            "noise multiplied",
        )


def require_uniform(name: str, noise: FloatArray, sinusoid: FloatArray) -> None:
    """Require noise that is uniform within the bound; the message names a known wrong distribution."""
    if np.ptp(noise) < _EPSILON:
        if abs(noise[0]) < _EPSILON:
            raise NoAnswer(f"`{name}` has no noise yet: add it to the sinusoid.", "no noise")
        raise NoAnswer(
            f"All samples of `{name}` have the same random number. Draw one for each sample, with the size `t.shape`.",
            "one random number for all samples",
        )
    require_many_values(name, noise)
    if np.unique(np.round(noise + sinusoid, 9)).size < noise.size / 2:
        raise NoAnswer(
            f"`{name}` takes few different values, as rounded numbers do. Round neither the sinusoid nor the noise.",
            "noise on a grid",
        )
    if np.sum(np.abs(np.abs(noise) - NOISE_BOUND) < _EPSILON) > AT_THE_BOUND:
        raise NoAnswer(
            f"Many values of the noise in `{name}` equal the bound, and the others do not repeat: it was clipped. "
            "Uniform noise needs no clipping.",
            "noise clipped at the bound",
        )
    if _is_uniform(noise, -NOISE_BOUND, NOISE_BOUND):
        return
    for low, high, slip, text in _WRONG_SPREADS:
        if _is_uniform(noise, low, high):
            raise NoAnswer(f"The noise in `{name}` {text}.", slip)
    require_added(name, noise, sinusoid)
    if np.max(np.abs(noise + sinusoid)) <= 1:
        if _is_in_the_angle(noise + sinusoid, sinusoid):
            raise NoAnswer(
                f"`{name}` is a sine or cosine of a noisy angle, and so never leaves -1 to 1: the noise is inside its "
                "brackets. Add it to the sinusoid, not to its angle.",
                "noise in the angle",
            )
        raise NoAnswer(f"`{name}` never leaves -1 to 1. A sinusoid of amplitude 1 with noise added to it does.")
    deviation = noise - noise.mean()
    kurtosis = np.mean(deviation**4) / np.mean(deviation**2) ** 2
    if kurtosis > GAUSSIAN_KURTOSIS:
        raise NoAnswer(
            f"The noise in `{name}` is concentrated at its mean, like Gaussian noise (`randn`, `normal`). Uniform "
            "noise takes every value within its bound equally often, and none outside.",
            "Gaussian noise",
        )
    raise NoAnswer(
        f"The noise in `{name}` should cover ±0.2 evenly; what is left of `{name}` without the sinusoid runs from "
        f"{noise.min():.2g} to {noise.max():.2g}, with the mean {noise.mean():.2g}."
    )


def require_many_values(name: str, noise: FloatArray) -> None:
    """Refuse noise of few different values, which lie in equal steps or come again and again."""
    values = np.unique(np.round(noise, 9) + 0.0)  # -0 becomes 0
    if values.size >= min(FEW_VALUES, noise.size / 2):
        return
    steps = np.diff(values) / np.min(np.diff(values))
    listed = ", ".join(f"{one:.3g}" for one in values[:_LISTED]) + ", ..." * (values.size > _LISTED)
    said = f"The noise in `{name}` takes only {values.size} different values, {listed}"
    if values.size > 1 and np.allclose(steps, np.round(steps), atol=1e-4):
        raise NoAnswer(
            f"{said}: they lie on a grid, as rounded numbers, whole numbers or a choice from a list do. Uniform noise "
            "takes every value within its bound.",
            "noise on a grid",
        )
    raise NoAnswer(f"{said}, which come again: draw a new number for each sample.", "few numbers drawn")


def require_independent(noises: dict[str, FloatArray]) -> None:
    """Require noises that are independent of each other and from sample to sample."""
    (first, first_noise), (second, second_noise) = noises.items()
    together = _correlation(first_noise, second_noise)
    if abs(together) > 1 - _EPSILON:
        raise NoAnswer(
            f"`{first}` and `{second}` contain the same noise. Draw new random numbers for each (and do "
            "not start two generators from the same seed).",
            "the same noise in both",
        )
    if abs(together) > LARGEST_CORRELATION:
        raise NoAnswer(f"The noises in `{first}` and `{second}` are correlated: draw each separately.")
    for name, noise in noises.items():
        if abs(_correlation(noise[1:], noise[:-1])) > LARGEST_CORRELATION:
            raise NoAnswer(
                f"The noise in `{name}` is not random: each value follows from the one before. Draw random numbers.",
                "noise that is not random",
            )


def _is_uniform(noise: FloatArray, low: float, high: float) -> bool:
    middle, half = (low + high) / 2, (high - low) / 2
    scaled = (noise - middle) / half
    if np.max(np.abs(scaled)) > 1 + _EPSILON or min(-scaled.min(), scaled.max()) < REACHED:
        return False
    counts, _ = np.histogram(scaled, bins=BINS, range=(-1, 1))
    expected = noise.size / BINS
    return bool(np.sum((counts - expected) ** 2) / expected <= LARGEST_CHI_SQUARE)


def _correlation(one: FloatArray, two: FloatArray) -> float:
    return float(np.corrcoef(one, two)[0, 1])


def _is_in_the_angle(noisy: FloatArray, sinusoid: FloatArray) -> bool:
    """Whether each sample is the sinusoid of an angle that is at most the bound of the noise away from its own.

    A sine and a cosine have the same distances of angles, but for the side.
    """
    angle, own = np.arccos(np.clip(noisy, -1, 1)), np.arccos(np.clip(sinusoid, -1, 1))
    apart = np.minimum(np.abs(angle - own), np.minimum(angle + own, 2 * np.pi - angle - own))
    return bool(np.all(apart <= NOISE_BOUND * (1 + 1e-6)))
