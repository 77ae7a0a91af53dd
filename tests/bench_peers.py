"""labsid beside its peers, in one run on one machine: least squares and recursive least squares, four parameters.

`make bench` runs it with all of them, in an environment of its own. It needs none of the peers to run; those that are
not installed are left out and named.

Every figure is the best of several runs, from the signals u and y (the time to build Phi included) unless it says "Phi
given". Online, every sample is a call, and only the last estimate is kept; statsmodels and sysidentpy have no such
call, and their figure is a sample of a whole record. "off by" is the largest difference from the batch estimate on the
same samples; from u and y, labsid's recursion also uses the first two rows, with the plant at rest before them.
"""

import argparse
import time
import warnings
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from scipy.signal import lfilter

from labsid.estimation.online import RecursiveArmax, RecursiveLeastSquares
from labsid.estimation.recursive import recursive_armax, recursive_least_squares
from labsid.lab.long_arx import fit_long_arx
from labsid.lab.regressor import build_phi
from labsid.model_structures.structures import Structure

Array = NDArray[np.float64]
Estimator = Callable[[Array, Array], Array]

PEERS = ("numpy", "llsi", "statsmodels", "sysidentpy", "padasip")


def peer(module: str) -> Any:
    """Import a peer's module where it is used: it need not be there, and the project does not depend on it."""
    return import_module(module)


def record(samples: int) -> tuple[Array, Array]:
    """An ARX system of order 2, driven by noise: theta = [1.5, -0.7, 1, 0.5]."""
    u, e = np.random.default_rng(0).standard_normal((2, samples))
    return u, lfilter([0, 1, 0.5], [1, -1.5, 0.7], u) + lfilter([0.3], [1, -1.5, 0.7], e)


def build(u: Array, y: Array) -> tuple[Array, Array]:
    """Phi and Y as quickly as numpy does it."""
    return np.column_stack([y[1:-1], y[:-2], u[1:-1], u[:-2]]), y[2:]


# Batch least squares: u, y -> [-a1, -a2, b1, b2]


def labsid_gram(u: Array, y: Array) -> Array:
    return fit_long_arx(u, y, 1.0).model.theta


def numpy_lstsq(u: Array, y: Array) -> Array:
    return np.linalg.lstsq(*build(u, y), rcond=None)[0]


def llsi_arx(u: Array, y: Array) -> Array:
    data = peer("llsi.sysiddata").SysIdData(Ts=1.0, u=u, y=y)
    model = peer("llsi.arx").ARX(data, ["y"], ["u"]).ident((2, 2, 1))
    a, b = np.ravel(model.a), np.ravel(model.b)
    return np.concatenate([-a[-2:], b[-2:]])


def statsmodels_ols(u: Array, y: Array) -> Array:
    Phi, Y = build(u, y)
    return np.asarray(peer("statsmodels.api").OLS(Y, Phi).fit().params)


def sysidentpy_frols(u: Array, y: Array) -> Array:
    model = peer("sysidentpy.model_structure_selection").FROLS(
        order_selection=False,
        n_terms=4,
        ylag=2,
        xlag=2,
        estimator=peer("sysidentpy.parameter_estimation").LeastSquares(),
        basis_function=peer("sysidentpy.basis_function").Polynomial(degree=1),
    )
    model.fit(X=u[:, None], y=y[:, None])
    found = dict(zip((int(code[0]) for code in model.final_model), np.ravel(model.theta), strict=True))
    return np.array([found.get(code, np.nan) for code in (1001, 1002, 2001, 2002)])


# Recursive least squares: u, y -> the last [-a1, -a2, b1, b2]; the whole history is made


def labsid_rls(Phi: Array, Y: Array) -> Array:
    return recursive_least_squares(Phi, Y).theta[-1]


def labsid_from_signals(u: Array, y: Array) -> Array:
    return recursive_armax(Structure(2, 2), u, y).theta[-1] * [-1, -1, 1, 1]


def padasip_rls(Phi: Array, Y: Array) -> Array:
    return np.asarray(peer("padasip.filters").FilterRLS(4, mu=1.0, eps=1e-6, w="zeros").run(Y, Phi)[2][-1])


def statsmodels_rls(Phi: Array, Y: Array) -> Array:
    found = peer("statsmodels.regression.recursive_ls").RecursiveLS(Y, Phi).fit()
    return np.asarray(found.recursive_coefficients.filtered[:, -1])


def sysidentpy_rls(Phi: Array, Y: Array) -> Array:
    filtered = peer("sysidentpy.parameter_estimation").RecursiveLeastSquares(lam=1.0, delta=1e-6)
    return np.ravel(filtered.optimize(Phi, Y[:, None]))[-4:]


# Online: one call a sample


def labsid_online(Phi: Array, Y: Array) -> Array:
    estimator = RecursiveLeastSquares(4)
    for phi, y in zip(Phi, Y, strict=True):
        estimator.update(phi, y)
    return estimator.theta


def labsid_online_from_signals(u: Array, y: Array) -> Array:
    estimator = RecursiveArmax(Structure(2, 2))
    for sample in zip(u, y, strict=True):
        estimator.update(*sample)
    return estimator.theta * [-1, -1, 1, 1]


def padasip_online(Phi: Array, Y: Array) -> Array:
    filtered = peer("padasip.filters").FilterRLS(4, mu=1.0, eps=1e-6, w="zeros")
    for phi, y in zip(Phi, Y, strict=True):
        filtered.adapt(y, phi)
    return np.asarray(filtered.w)


def measure(estimate: Estimator, first: Array, second: Array, runs: int) -> tuple[float, Array]:
    """Best time in seconds, and the estimate; the first run, which may compile, does not count."""
    theta = estimate(first, second)
    times = []
    for _ in range(runs):
        began = time.perf_counter()
        estimate(first, second)
        times.append(time.perf_counter() - began)
    return min(times), theta


def compare(
    title: str, unit: str, rows: list[tuple[str, Estimator, Array, Array, int]], per_sample: bool, console: Console
) -> None:
    """Print one table. The first row is labsid's and the one that the others are held against."""
    table = Table("", "samples", unit, "times labsid", "off by", title=title, title_justify="left")
    reference: float | None = None
    for name, estimate, first, second, runs in rows:
        samples = second.size
        try:
            seconds, theta = measure(estimate, first, second, runs)
        except ImportError as missing:
            table.add_row(name, f"{samples:,}", "not installed", "", str(missing.name))
            continue
        except Exception as failure:  # a peer that fails on this record is a result, not the end of the table
            table.add_row(name, f"{samples:,}", "failed", "", f"{type(failure).__name__}: {failure}"[:60])
            continue
        figure = seconds / samples * 1e9 if per_sample else seconds * 1e3
        cost = seconds / samples
        reference = cost if reference is None else reference
        same = labsid_gram(first, second) if first.ndim == 1 else np.linalg.lstsq(first, second, rcond=None)[0]
        off = float(np.max(np.abs(theta - same)))
        table.add_row(name, f"{samples:,}", f"{figure:,.2f}", f"{cost / reference:,.1f}", f"{off:.0e}")
    console.print(table)


def main() -> None:
    parser = argparse.ArgumentParser(description="labsid beside its peers")
    parser.add_argument("--samples", type=int, default=10**6, help="length of the record")
    parser.add_argument("--runs", type=int, default=15, help="runs of each of labsid's own; the best one counts")
    options = parser.parse_args()
    warnings.simplefilter("ignore")  # those of the peers
    console = Console()
    u, y = record(options.samples)
    regression = build_phi(u, y)
    Phi, Y = regression.Phi, regression.Y
    n, few = options.samples, max(options.runs // 5, 1)

    console.print("  ".join(f"{name} {installed(name)}" for name in PEERS))
    batch: list[tuple[str, Estimator, Array, Array, int]] = [
        ("labsid fit_long_arx", labsid_gram, u, y, options.runs),
        ("labsid, a tenth of it", labsid_gram, u[: n // 10], y[: n // 10], options.runs),
        ("numpy lstsq", numpy_lstsq, u, y, few),
        ("llsi ARX", llsi_arx, u, y, few),
        ("statsmodels OLS", statsmodels_ols, u, y, few),
        ("sysidentpy FROLS", sysidentpy_frols, u, y, 1),
    ]
    compare("ARX by least squares, four parameters", "ms", batch, False, console)
    recursive: list[tuple[str, Estimator, Array, Array, int]] = [
        ("labsid, Phi given", labsid_rls, Phi, Y, options.runs),
        ("labsid, a tenth of it", labsid_rls, Phi[: n // 10], Y[: n // 10], options.runs),
        ("labsid, from u and y", labsid_from_signals, u, y, options.runs),
        ("padasip FilterRLS", padasip_rls, Phi[:20_000], Y[:20_000], few),
        ("sysidentpy RLS", sysidentpy_rls, Phi[:20_000], Y[:20_000], few),
        ("statsmodels RecursiveLS", statsmodels_rls, Phi[:5000], Y[:5000], few),
    ]
    compare("Recursive least squares, four parameters, history stored", "ns a sample", recursive, True, console)
    online: list[tuple[str, Estimator, Array, Array, int]] = [
        ("labsid RecursiveLeastSquares", labsid_online, Phi[:20_000], Y[:20_000], options.runs),
        ("labsid RecursiveArmax", labsid_online_from_signals, u[:20_000], y[:20_000], options.runs),
        ("padasip FilterRLS.adapt", padasip_online, Phi[:20_000], Y[:20_000], few),
        ("statsmodels RecursiveLS", statsmodels_rls, Phi[:5000], Y[:5000], few),
        ("sysidentpy RLS", sysidentpy_rls, Phi[:20_000], Y[:20_000], few),
    ]
    compare("Recursive least squares online, four parameters, one call a sample", "ns a sample", online, True, console)


def installed(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "(not installed)"


if __name__ == "__main__":
    main()
