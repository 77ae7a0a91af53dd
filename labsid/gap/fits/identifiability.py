"""Which free numbers of a given simulation a record determines, and of the others, which combination of them.

The derivatives of the whitened output by the relative changes of the numbers, less what the other parameters of the
fit explain, have singular values of zero for changes of the numbers that leave the output as it is. Such a change is
followed over a factor of two, to tell a product or a ratio from a sum.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from labsid._arrays import FloatArray
from labsid.gap.fits.fitting import Fit, Point, Problem
from labsid.gap.record.data import Data

COLLINEAR = 1e-2  # smallest singular value, of unit columns, of a change that leaves the output as it is; set by hand
NO_INFLUENCE = 1e-7  # change of the output by twice the number, over the output; numerics
SHARE = 0.1  # of a change of unit length: smaller parts of it are rounding; numerics
FACTOR = 2.0  # over which a change is followed; set by hand
LARGEST_POWER = 3  # of a number in a combination that is reported; set by hand
NEARLY_WHOLE = 0.05  # distance of the powers of a combination from whole ones, over the largest; set by hand
SAME = 1e-3  # change of the output over that by one number alone, where the combination stays; set by hand


@dataclass(frozen=True, slots=True)
class Determined:
    """What a record says of one free number.

    Attributes
    ----------
    determined : bool
    combination : str
        Of a number that is not determined by itself: what is, as "ka kb", "k/m" or "a + b"; empty if nothing is, or if
        it is none of these.
    group : tuple of str
        The numbers of which only the combination is determined.
    stderr : float
        Standard error of a determined number; infinite otherwise.
    """

    determined: bool
    combination: str = ""
    group: tuple[str, ...] = ()
    stderr: float = np.inf


def determined_numbers(data: Data, fit: Fit) -> dict[str, Determined]:
    """What the record says of each free number of a fit, by name."""
    problem = Problem(data, fit.hypothesis, fit.noise.ar)
    at = problem.point(fit.theta, fit.gains)
    return {} if at is None else assess(problem, at, float(np.sqrt(fit.noise.sigma2)))


def assess(problem: Problem, at: Point, sigma: float = 0.0) -> dict[str, Determined]:
    """What the record says of each free number at a point, with errors of standard deviation `sigma`."""
    free = problem.hypothesis.plant.free
    local = _Local.at(problem, at)
    if local is None or not free:
        return {}
    size = np.linalg.norm(local.columns, axis=0)
    whole = float(np.linalg.norm(problem.y)) or 1.0
    acts = size > np.maximum(NO_INFLUENCE * whole, sigma)
    names = [one.given_name for one in free]
    found = {name: Determined(False) for name in names}
    inside = np.flatnonzero(acts)
    if not inside.size:
        return found
    _, values, directions = np.linalg.svd(local.columns[:, inside] / size[inside], full_matrices=False)
    changes = np.zeros((values.size, len(free)))
    changes[:, inside] = directions / size[inside]  # relative changes of the numbers, of unit effect before cancelling
    error = sigma * changes / np.maximum(values, 1e-12)[:, None]
    loose = (values < COLLINEAR) | (np.abs(error).max(axis=1) > 1.0)
    relative = np.abs(changes[:, inside])  # a number of small effect, which a common factor moves as much as the others
    unsure = ((np.abs(directions) > SHARE) | (relative > SHARE * relative.max(axis=1)[:, None]))[loose].any(axis=0)
    for i, sure in zip(inside, ~unsure, strict=True):
        if sure:
            spread = float(np.sqrt(np.sum(error[~loose, i] ** 2)))
            found[names[i]] = Determined(True, stderr=spread * float(local.sizes[i]))
    if loose.any():
        found |= _combinations(local, inside[unsure], changes[loose][:, inside[unsure]], sigma)
    return found


@dataclass(frozen=True, slots=True, eq=False)
class _Local:
    """A point, and what small changes of the free numbers do to the output there.

    Attributes
    ----------
    problem : Problem
    point : Point
    place : ndarray
        Indices of the numbers in theta.
    numbers, sizes : ndarray, shape (n,)
        Their values, and the sizes to which changes are relative.
    others : ndarray, shape (N, m)
        Orthonormal basis of what the other parameters do.
    columns : ndarray, shape (N, n)
        Derivatives by the relative changes, less that.
    """

    problem: Problem
    point: Point
    place: np.ndarray
    numbers: FloatArray
    sizes: FloatArray
    others: FloatArray
    columns: FloatArray

    @classmethod
    def at(cls, problem: Problem, point: Point) -> "_Local | None":
        """At a point; None where its neighbours cannot be simulated."""
        free = problem.hypothesis.plant.free
        place = problem.hypothesis.slices["plant"].start + np.arange(len(free))
        J = problem.jacobian(point)
        if J is None:
            return None
        rest = np.delete(J, place, axis=1)
        lengths = np.linalg.norm(rest, axis=0)
        rest = rest[:, lengths > 0.0] / lengths[lengths > 0.0]
        others = np.linalg.svd(rest, full_matrices=False)[0] if rest.size else rest
        theta = point.theta[place].tolist()
        numbers = np.array([one.number(value) for one, value in zip(free, theta, strict=True)])
        nominal = np.array([max(abs(one.nominal), one.unit) for one in free])
        sizes = np.maximum(np.abs(numbers), nominal)
        scales = np.array([one.scale(value) for one, value in zip(free, theta, strict=True)])
        local = cls(problem, point, place, numbers, sizes, others, J[:, :0])
        columns = []
        for i, one in enumerate(free):
            ends = [local.shifted({i: sign * one.step}) for sign in (1.0, -1.0)]
            if any(end is None for end in ends):
                return None
            columns.append((ends[0] - ends[1]) / (2.0 * one.step) * sizes[i] / scales[i])  # type: ignore[operator]
        return replace(local, columns=np.column_stack(columns))

    def shifted(self, steps: dict[int, float]) -> FloatArray | None:
        """Change of the whitened output by steps in theta, less what the other parameters do; None if it fails."""
        theta = self.point.theta.copy()
        for i, step in steps.items():
            theta[self.place[i]] += step
        moved = self.problem.point(theta, self.point.gains)
        if moved is None or not np.isfinite(moved.error).all():
            return None
        change = self.point.error - moved.error
        return np.asarray(change - self.others @ (self.others.T @ change))

    def change(self, numbers: dict[int, float]) -> float:
        """Size of the change of the output by other values of some numbers; infinite where it fails."""
        free = self.problem.hypothesis.plant.free
        moved = self.shifted(
            {i: free[i].theta(value) - self.point.theta[self.place[i]] for i, value in numbers.items()}
        )
        return np.inf if moved is None else float(np.linalg.norm(moved))


def _combinations(local: _Local, members: np.ndarray, changes: FloatArray, sigma: float) -> dict[str, Determined]:
    """The determined combinations of numbers that are not determined by themselves.

    `changes`, shape (k, n), are independent relative changes of the members that leave the output as it is.
    """
    free = local.problem.hypothesis.plant.free
    names = [free[i].given_name for i in members]
    found: dict[str, Determined] = {}
    for group, own in _separate(changes):
        words, indices = [names[i] for i in group], [int(members[i]) for i in group]
        text = _product(local, indices, words, own, sigma) or _sum(local, indices, words, own, sigma)
        found |= {name: Determined(False, text, tuple(words)) for name in words}
    return found


def _separate(changes: FloatArray) -> list[tuple[list[int], FloatArray]]:
    """Groups of numbers that change together, each with the changes of it."""
    reduced = _echelon(changes)
    groups: list[tuple[set[int], list[int]]] = []
    for row, values in enumerate(reduced):
        own = set(np.flatnonzero(np.abs(values) > SHARE * np.abs(values).max()).tolist())
        rows = [row]
        for other in [one for one in groups if one[0] & own]:
            groups.remove(other)
            own, rows = own | other[0], rows + other[1]
        groups.append((own, rows))
    return [(sorted(own), reduced[np.ix_(rows, sorted(own))]) for own, rows in groups]


def _echelon(rows: FloatArray) -> FloatArray:
    """Reduced row echelon form, with pivots of 1 at the largest elements."""
    rows = rows.copy()
    for k in range(len(rows)):
        i = int(np.argmax(np.abs(rows[k])))
        rows[k] /= rows[k, i]
        for other in range(len(rows)):
            if other != k:
                rows[other] -= rows[other, i] * rows[k]
    return rows


def _kept(changes: FloatArray) -> list[list[int]] | None:
    """Whole-numbered weights of sums that the changes leave as they are; None if they are no small whole numbers."""
    _, values, rows = np.linalg.svd(changes)
    rest = rows[int(np.sum(values > 1e-6 * values.max())) :]
    if not len(rest):
        return []
    weights = []
    for row in _echelon(rest):
        row = row / np.abs(row[np.abs(row) > SHARE]).min()
        whole = np.round(row)
        if np.abs(row - whole).max() > NEARLY_WHOLE * np.abs(whole).max() or np.abs(whole).max() > LARGEST_POWER:
            return None
        weights.append([int(x) for x in (whole if whole[np.flatnonzero(whole)[0]] > 0 else -whole)])
    return sorted(weights, reverse=True)


def _product(local: _Local, indices: list[int], names: Sequence[str], changes: FloatArray, sigma: float) -> str:
    """Products and ratios of numbers that are determined; empty if they are not."""
    if not np.all(local.numbers[indices]):
        return ""
    changes = changes * local.sizes[indices] / local.numbers[indices]  # of the logarithms
    powers = _kept(changes)
    if not powers:
        return ""

    def moved(own: FloatArray, way: float) -> dict[int, float]:
        factors = FACTOR ** (way * own / np.abs(own).max())
        return {i: float(local.numbers[i] * factor) for i, factor in zip(indices, factors, strict=True)}

    if not _stays(local, changes, moved, sigma):
        return ""
    return ", ".join(_monomial(names, row) for row in powers)


def _sum(local: _Local, indices: list[int], names: Sequence[str], changes: FloatArray, sigma: float) -> str:
    """Sums and differences of numbers that are determined; empty if they are not."""
    steps = changes * local.sizes[indices]
    weights = _kept(steps)
    if not weights:
        return ""
    size = float(local.sizes[indices].min())

    def moved(own: FloatArray, way: float) -> dict[int, float]:
        shifts = way * (FACTOR - 1.0) * size * own / np.abs(own).max()
        return {i: float(local.numbers[i] + shift) for i, shift in zip(indices, shifts, strict=True)}

    if not _stays(local, steps, moved, sigma):
        return ""
    return ", ".join(_linear(names, row) for row in weights)


def _stays(
    local: _Local, changes: FloatArray, moved: Callable[[FloatArray, float], dict[int, float]], sigma: float
) -> bool:
    """Whether the output stays as it is while the numbers move together, compared with a move of one of them alone."""
    for own in changes:
        for way in (1.0, -1.0):
            together = moved(own, way)
            alone = max(local.change({i: value}) for i, value in together.items())
            if not local.change(together) <= max(SAME * alone, sigma):
                return False
    return True


def _monomial(names: Sequence[str], powers: Sequence[int]) -> str:
    above, below = (
        " ".join(name if power == 1 else f"{name}^{power}" for name, power in part)
        for part in (
            [(name, power) for name, power in zip(names, powers, strict=True) if power > 0],
            [(name, -power) for name, power in zip(names, powers, strict=True) if power < 0],
        )
    )
    if not below:
        return above
    return f"{above}/({below})" if " " in below else f"{above}/{below}"


def _linear(names: Sequence[str], weights: Sequence[int]) -> str:
    text = ""
    for name, weight in zip(names, weights, strict=True):
        if weight:
            term = name if abs(weight) == 1 else f"{abs(weight)} {name}"
            text += f" {'+' if weight > 0 else '-'} {term}" if text else term
    return text
