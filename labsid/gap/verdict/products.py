"""Whether a product of input and output explains a record better than curves do: a bilinear rig, which no effect is."""

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.effects.base import InputEffect
from labsid.gap.effects.families import names_where
from labsid.gap.effects.further_inputs import LAST, extended
from labsid.gap.fits.fitting import Fit, fit_from
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.record.data import Data
from labsid.gap.search.beam_search import BIC_MARGIN
from labsid.gap.search.explanation import Explanation
from labsid.gap.search.forms import transfer_theta

MOST_PRODUCT = 20.0  # relative change of the gain by one standard deviation of the output; numerics
PRODUCT_STARTS = (0.3, -0.3)  # of the same; numerics
PRODUCT_ITERATIONS = 30  # of the fit with the product; numerics


@dataclass(frozen=True, slots=True)
class _Product(InputEffect):
    """The command times one plus a share of `signal`: the output of another fit, about its mean, over its spread."""

    name: ClassVar[str] = "product"
    position: ClassVar[int] = LAST
    signal: FloatArray = field(default_factory=lambda: np.zeros(1), compare=False, repr=False)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Relative change of the gain by one standard deviation of the output."""
        return (Parameter("product", -MOST_PRODUCT, MOST_PRODUCT),)

    def apply(self, w: FloatArray, own: FloatArray, span: int) -> FloatArray:
        """Change the gain with the signal."""
        return np.asarray(w * (1.0 + own[0] * extended(self.signal, w.size)))


def fit_of_product(data: Data, linear: Fit, output: FloatArray) -> Fit | None:
    """The linear model whose input is multiplied by a function of first degree of the output.

    Of a bilinear rig x' = -a x + b u + n u x, linear dynamics whose input is u (b + n x). The product is that
    within each sample, from the output of a fit that leaves nothing but noise.

    Parameters
    ----------
    data : Data
    linear : Fit
    output : ndarray, shape (N,)
        Without noise.

    Returns
    -------
    Fit or None
        None if it cannot be simulated.
    """
    spread = float(output[data.rows].std())
    if spread == 0.0:
        return None
    around = (output - output[data.rows].mean()) / spread
    around = 0.5 * (around + np.append(around[1:], around[-1]))
    old = linear.hypothesis
    product = _Product("", around)
    hypothesis = Hypothesis((*old.effects, product), old.n_given, old.given)
    theta, fits = transfer_theta(linear, hypothesis), []
    for start in PRODUCT_STARTS:
        theta[hypothesis.slices[product.key]] = start
        fits.append(fit_from(data, hypothesis, theta, iterations=PRODUCT_ITERATIONS))
    return min((fit for fit in fits if fit is not None), key=lambda fit: fit.bic, default=None)


def is_rather_a_product(explanation: Explanation) -> bool:
    """Whether a product of input and output explains more than smooth laws, or as much with fewer numbers.

    One smooth law or two can imitate it, however many numbers they have.
    """
    best, linear = explanation.best, explanation.path[0]
    names = set(best.hypothesis.names)
    if not names or not names <= names_where("smooth_law") or explanation.data.pieces:
        return False
    if linear.hypothesis.given is not None or linear.hypothesis.feedback is not None:
        return False
    fit = fit_of_product(explanation.data, linear, best.output)
    return fit is not None and fit.bic < best.bic - BIC_MARGIN
