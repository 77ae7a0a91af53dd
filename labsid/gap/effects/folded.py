"""Sensors that show an absolute value: the linear dynamics run through zero and their sign is lost."""

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.dynamics.plant_form import Parameter
from labsid.gap.effects.base import Fitted, OutputEffect, Value
from labsid.gap.effects.context import Context

FREQUENCIES = np.geomspace(0.02, 1.2, 8)  # radians per sample: natural frequencies of the trial dynamics; numerics
DAMPING_RATIOS = 0.15, 0.5, 1.5  # of the trial dynamics; numerics
SCREENED_ROWS = 200  # samples of the record on which the trial dynamics are compared; numerics
MAX_SCREENED_COST = 0.9  # of such dynamics behind the sensor, over that of the parent; set by hand
LOW_QUANTILE = 0.005  # of the readings, near the fold; set by hand
SIGN_PASSES = 12  # alternations between the signs and the gains; numerics
INDEPENDENT = 1e-8  # singular value of the columns over the largest, above which a direction counts; numerics


class Absolute(OutputEffect):
    """A sensor that shows the absolute value: readings below the fold are reflected to above it."""

    name = "output-nonlinearity"
    variants = ("absolute",)
    position = 1
    has_corner = True

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The fold in the scaled output."""
        return (Parameter("fold", -8.0, 8.0, leap=0.05),)

    def applies(self, context: Context) -> bool:
        """Whether some linear dynamics behind such a sensor come closer to the record than the parent."""
        plant = context.parent.hypothesis.plant
        if plant.kind != "linear":
            return False
        rows = np.flatnonzero(context.data.rows)[:: max(int(context.data.rows.sum()) // SCREENED_ROWS, 1)]
        e = context.residual[rows]
        most = MAX_SCREENED_COST * float(e @ e)
        y, w = context.data.y[rows], context.actuator
        own = context.parent.plant_theta.copy()
        fold = float(self.starts(context)[0][0])
        for c, k in self.rates(context):
            own[:2] = np.log((c, k))
            columns = np.column_stack([plant.columns(own, w, w.size)[rows], np.ones(rows.size)])
            if unfolded(columns, y - fold)[1] < most:
                return True
        return False

    def rates(self, context: Context) -> list[tuple[float, float]]:
        """The linear parent follows the reflected swings, which are twice as fast: try all dynamics."""
        return [(2.0 * damped * w, w * w) for w in FREQUENCIES for damped in DAMPING_RATIOS]

    def starts(self, context: Context) -> list[FloatArray]:
        """The lowest readings, and slightly below them."""
        y = context.data.y[context.data.rows]
        low = float(np.quantile(y, LOW_QUANTILE))
        return [np.array([low]), np.array([low - 0.03 * float(np.ptp(y))])]

    def apply(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """Reflect at the fold."""
        return own[0] + np.abs(z - own[0])

    def slope(self, z: FloatArray, own: FloatArray) -> FloatArray:
        """One above the fold, minus one below it."""
        return np.where(z >= own[0], 1.0, -1.0)

    def undone(self, y: FloatArray, own: FloatArray, columns: FloatArray, rows: np.ndarray) -> FloatArray:
        """Readings with the signs of the dynamics that `columns` fit best."""
        signs = np.where(columns @ unfolded(columns[rows], y[rows] - own[0])[0] >= 0.0, 1.0, -1.0)
        return own[0] + signs * np.abs(y - own[0])

    def values(self, fit: Fitted) -> dict[str, Value]:
        """`fold`, the lowest reading."""
        return {"fold": Value(fit.y(float(fit.theta_of(self)[0])), "y")}


def unfolded(columns: FloatArray, height: FloatArray) -> tuple[FloatArray, float]:
    """Gains with which |columns @ gains| is near `height`, and the sum of squares of the difference.

    The square of a linear combination is linear in the products of its gains: regress height^2 on the products of the
    columns, take the largest eigenvector of the matrix of products, and alternate between signs and gains.
    """
    basis, size, back = np.linalg.svd(columns, full_matrices=False)
    kept = size > INDEPENDENT * size[0]
    basis = basis[:, kept]
    upper = np.triu_indices(basis.shape[1])
    pairs = basis[:, upper[0]] * basis[:, upper[1]]
    products = np.zeros((basis.shape[1], basis.shape[1]))
    products[upper] = np.linalg.lstsq(pairs, height**2, rcond=None)[0]
    powers, vectors = np.linalg.eigh(0.5 * (products + products.T))
    z = basis @ vectors[:, -1] * np.sqrt(max(powers[-1], 0.0))
    gains, cost = basis.T @ z, np.inf
    for _ in range(SIGN_PASSES):
        new = basis.T @ np.where(z >= 0.0, height, -height)
        z = basis @ new
        residual = float(np.sum((np.abs(z) - height) ** 2))
        if residual >= cost:
            break
        gains, cost = new, residual
    return np.asarray(back[kept].T @ (gains / size[kept])), cost
