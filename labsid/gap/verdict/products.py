"""Whether a product explains a record better than effects do: of input and output, or of input and a wave.

A bilinear rig, or one whose gain oscillates, is none of the effects, and two of them can imitate it.
"""

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.effects.base import Fitted, InputEffect
from labsid.gap.effects.families import names_where
from labsid.gap.effects.further_inputs import LAST
from labsid.gap.fits.fitting import Fit, fit_from, refit
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.record.data import Data
from labsid.gap.search.beam_search import BIC_MARGIN
from labsid.gap.search.explanation import Explanation
from labsid.gap.search.forms import transfer_theta

MOST_PRODUCT = 20.0  # relative change of the gain by a unit of the other factor; numerics
PRODUCT_STARTS = (0.3, -0.3)  # of the same; numerics
PRODUCT_ITERATIONS = 30  # of the fit with the product; numerics


@dataclass(frozen=True, slots=True)
class _Product(InputEffect):
    """The command, about `zero`, times one plus a combination of `factors`, shape (N, n)."""

    name: ClassVar[str] = "product"
    position: ClassVar[int] = LAST
    zero: float = 0.0
    factors: FloatArray = field(default_factory=lambda: np.zeros((1, 1)), compare=False, repr=False)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Relative change of the gain by a unit of each factor."""
        return tuple(Parameter(f"product{i}", -MOST_PRODUCT, MOST_PRODUCT) for i in range(self.factors.shape[1]))

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Change the gain with the factors."""
        return np.asarray(w + (w - self.zero) * (self.factors[: w.size] @ own))


def fit_of_product(data: Data, linear: Fit, factors: FloatArray, zero: float = 0.0) -> Fit | None:
    """The linear model whose input, about `zero`, is multiplied by one plus a combination of factors.

    Parameters
    ----------
    data : Data
    linear : Fit
    factors : ndarray, shape (N, n)
    zero : float
        Scaled. A product with the output leaves the poles nearly as they are if it is about the mean.

    Returns
    -------
    Fit or None
        None if it cannot be simulated.
    """
    old = linear.hypothesis
    product = _Product("", zero, factors)
    hypothesis = Hypothesis((*old.effects, product), old.n_given, old.given)
    theta, fits = transfer_theta(linear, hypothesis), []
    for start in PRODUCT_STARTS:
        theta[hypothesis.slices[product.key]] = start
        fits.append(fit_from(data, hypothesis, theta, iterations=PRODUCT_ITERATIONS))
    return min((fit for fit in fits if fit is not None), key=lambda fit: fit.bic, default=None)


def product_instead(explanation: Explanation) -> str:
    """What the input is rather multiplied by, "output" or "wave"; empty if the effects explain more with few numbers.

    Of a bilinear rig x' = -a x + b u + n u x, linear dynamics whose input is u (b + n x): one smooth law or two can
    imitate it, however many numbers they have. A gain that oscillates looks like a periodic disturbance while the
    input rests.
    """
    best, linear = explanation.best, explanation.path[0]
    names, data = set(best.hypothesis.names), explanation.data
    if not names or data.pieces or linear.hypothesis.given is not None or linear.hypothesis.feedback is not None:
        return ""
    if names <= names_where("smooth_law"):
        kind, numbers, fit = "output", 0, fit_of_product(data, linear, _around(data, best.output))
    elif "periodic-disturbance" in names:
        kind, numbers, fit = "wave", 1, fit_of_product(data, linear, _wave(data, best), data.zero_command)
    else:
        return ""
    if fit is None:
        return ""
    if fit.noise.rows != best.noise.rows:  # the effects were found on a part of the record
        best = refit(data, best)
    return kind if fit.bic + numbers * np.log(fit.noise.rows) < best.bic - BIC_MARGIN else ""


def _around(data: Data, output: FloatArray) -> FloatArray:
    """The output of a fit within each sample, about its mean and over its spread, shape (N, 1)."""
    spread = float(output[data.rows].std())
    around = (output - output[data.rows].mean()) / (spread or 1.0)
    return 0.5 * (around + np.append(around[1:], around[-1]))[:, None]


def _wave(data: Data, fit: Fit) -> FloatArray:
    """Cosine and sine of the frequency of the periodic disturbance, shape (N, 2)."""
    phase = 2.0 * np.pi * Fitted.of(fit, data).value("cycles") / data.samples * (np.arange(data.samples) + 0.5)
    return np.column_stack([np.cos(phase), np.sin(phase)])
