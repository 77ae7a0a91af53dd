"""Numbers and formulas that the notebooks state in their text, and no check of theirs computes: computed here."""

import re
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.signal import lfilter, max_len_seq

from labsid.estimation.instrumental import fit_instrumental, instrumental_variables
from labsid.lab.excitation import excitation_order
from labsid.least_squares.curve_fit import fit_powers
from labsid.least_squares.projection import project
from labsid.model_structures.structures import Structure, build_equations

NOTEBOOKS = Path(__file__).resolve().parent.parent / "notebooks"

Signal = NDArray[np.float64]


def stated(name: str, sentence: str) -> None:
    """Hold the notebook to a sentence, wherever its lines break."""
    text = " ".join((NOTEBOOKS / name / f"{name}.md").read_text(encoding="utf-8").split())
    assert sentence in text


def test_the_orders_of_the_three_recommended_inputs() -> None:
    k = np.arange(120)
    prbs = np.where(np.resize(max_len_seq(4)[0], k.size) == 1, 1.0, -1.0)
    square = np.where(k % 10 < 5, 1.0, -1.0)
    sinusoids = np.sum([np.sin(2 * np.pi * k / period) for period in (8, 15, 40)], axis=0)
    assert [excitation_order(u, 30) for u in (prbs, square, sinusoids)] == [15, 5, 6]
    assert np.flatnonzero(np.abs(np.fft.rfft(square)) > 1e-9).tolist() == [12, 36, 60]
    stated("model-structures", "The order of a PRBS is its period, here 15.")
    stated("model-structures", "$1/10$, $3/10$ and $5/10$ of a cycle per sample")


def test_the_power_of_inputs_within_the_same_limits() -> None:
    uniform = np.random.default_rng(0).uniform(-1, 1, 100_000)
    assert np.mean(uniform**2) == pytest.approx(1 / 3, rel=0.02)
    stated("model-structures", "numbers need the same range for a third of the power")


def test_a_step_at_sample_100_of_200_has_order_100() -> None:
    step = np.where(np.arange(200) < 100, 0.0, 1.0)
    assert excitation_order(step, 200) == 100
    stated("model-structures", "a step at sample 100 of 200 has order 100")


def test_the_line_whose_slope_is_too_large() -> None:
    x, y = np.array([1.0, 2, 4, 5, 7]), np.array([1.0, 3, 5, 7, 8])
    line = fit_powers(x, y, [1, 0]).theta
    error = y - (line[0] + 0.5) * x - line[1]
    assert error @ error == pytest.approx(25.05, abs=0.005)
    stated("least-squares", r"\mathrm{SSE} = 1.298 + 0.5^2 \cdot 95 = 25.05")


def test_the_example_with_one_known_coefficient() -> None:
    u, y = np.array([1.0, 0, 0]), np.array([1.0, 3, 2])
    left = y[1:] - 2 * u[:-1]
    np.testing.assert_array_equal(left, [1, 2])
    assert y[:-1] @ left / (y[:-1] @ y[:-1]) == pytest.approx(0.7)
    stated("least-squares", r"\dfrac{1 \cdot 1 + 3 \cdot 2}{1^2 + 3^2} = 0.7")


def test_a_right_hand_side_in_the_column_space_leaves_no_error() -> None:
    Phi = np.random.default_rng(1).standard_normal((6, 2))
    assert np.max(np.abs(project(Phi, Phi @ [2.0, -1.0]).residual)) < 1e-12
    stated("least-squares", "it is its own projection: some $\\theta$ satisfies all equations")


def test_the_eigenvalues_of_the_two_by_two_form() -> None:
    np.testing.assert_allclose(np.linalg.eigvalsh([[1, -1], [-1, 1]]), [0, 2], atol=1e-12)
    stated("least-squares", r"= \lambda(\lambda - 2)$: the eigenvalues are 2 and 0")


@pytest.mark.parametrize("beside", [0.0, 1.0, 30.0])
def test_a_relative_error_is_magnified_by_at_most_the_condition_number_over_the_cosine(beside: float) -> None:
    U, s, Vt = np.linalg.svd(np.random.default_rng(4).standard_normal((6, 3)))
    Phi = U[:, :3] * s @ Vt
    Y = U[:, 0] + beside * U[:, 5]  # theta is as short as it can be for this Y; the error goes along the smallest value
    theta, changed = np.linalg.lstsq(Phi, np.column_stack([Y, Y + 0.01 * U[:, 2]]))[0].T
    magnified = np.linalg.norm(changed - theta) / np.linalg.norm(theta) / (0.01 / np.linalg.norm(Y))
    assert magnified == pytest.approx(np.linalg.cond(Phi) * np.linalg.norm(Y))  # cos(alpha) = 1 / |Y|
    stated("least-squares", r"magnified in $\hat\theta$ by up to $\kappa/\cos\alpha$")
    stated("least-squares", r"by up to $\kappa$ if the fit is good")


def test_the_inverse_by_the_lemma() -> None:
    np.testing.assert_allclose(np.linalg.inv([[2, 1], [1, 2]]), np.array([[2, -1], [-1, 2]]) / 3)
    stated("least-squares", r"I - \frac13\,\phi\,\phi^T = \frac13\begin{bmatrix} 2 & -1 \\ -1 & 2 \end{bmatrix}")


def test_the_second_order_model_that_the_lab_starts_by_hand() -> None:
    y = lfilter([0, 1, 0.5], [1, -1.5, 0.7], [1.0, 1, 1])
    np.testing.assert_allclose(y, [0, 1, 3])
    stated("lab-identification", r"$y(2) = 1.5\,y(1) - 0.7\,y(0) + 1\,u(1) + 0.5\,u(0) = 3$")
    stated("model-structures", r"$y(k) - 1.5\,y(k-1) + 0.7\,y(k-2) = u(k-1) + 0.5\,u(k-2)$")


def test_the_difference_equation_of_a_transfer_function() -> None:
    z = 1.3 + 0.4j
    assert (2 / z + 1 / z**2) / (1 - 0.5 / z) == pytest.approx((2 * z + 1) / (z**2 - 0.5 * z))
    stated("model-structures", r"$y(k) - 0.5\,y(k-1) = 2\,u(k-1) + u(k-2)$")


def test_the_first_order_step_responses_by_hand() -> None:
    K, tau, td, amplitude = 2.5, 6.0, 1.0, 4.0
    reached = [K * amplitude * (1 - np.exp(-(t - td) / tau)) for t in (3.0, 7.0)]
    np.testing.assert_allclose(reached, [2.83, 6.32], atol=0.005)
    stated("step-response", r"$K = 10/4 = 2.5$, $\tau = 1.5\,(7 - 3) = 6$ s, $t_d = 7 - 6 = 1$ s")
    assert 2 * (1 - np.exp(-(8 - 3) / 5)) == pytest.approx(1.26, abs=0.005)
    stated("step-response", "At 8 s it has reached 63 % of it, 1.26")


def test_the_rows_of_higher_order_armax_and_their_start() -> None:
    rng = np.random.default_rng(2)
    u, y, e = rng.standard_normal((3, 12))
    first = build_equations(Structure(2, 3, 1), u, y, e)
    np.testing.assert_array_equal(first.Phi[0], [-y[2], -y[1], u[2], u[1], u[0], e[2]])
    assert first.Y[0] == y[3]
    stated("armax-and-instruments", r"[-y(2),\ -y(1),\ u(2),\ u(1),\ u(0),\ \varepsilon(2)]^T")
    instruments = build_equations(Structure(2, 3), u, y)
    np.testing.assert_array_equal(instruments.Phi[1], [-y[3], -y[2], u[3], u[2], u[1]])
    assert instruments.Y[0] == y[3]
    stated("armax-and-instruments", r"[-y_M(3),\ -y_M(2),\ u(3),\ u(2),\ u(1)]^T$; the sums begin at $t = 3$")


def noise_with_a_mean(rng: np.random.Generator, samples: int) -> tuple[Signal, Signal]:
    """A record of System 2 whose noise has the mean 1 and whose input has the mean 2."""
    u, e = 2 + rng.uniform(-2, 2, samples), rng.standard_normal(samples)
    v = 1 + lfilter([1, -0.8], [1.0], e)
    return u, lfilter([0, 1], [1, -0.8], u) + lfilter([1.0], [1, -0.8], v)


def test_instruments_need_noise_of_mean_zero() -> None:
    rng = np.random.default_rng(3)
    records = [noise_with_a_mean(rng, 100_000) for _ in range(6)]
    biased = np.mean([fit_instrumental(Structure(1, 1), u, y).model.theta for u, y in records], axis=0)
    np.testing.assert_allclose(biased, [-0.862, 1.030], atol=0.004)
    stated("armax-and-instruments", "tends to $a = -0.862$, $b = 1.030$")

    means_removed = [fit_instrumental(Structure(1, 1), u - u.mean(), y - y.mean()).model.theta for u, y in records]
    np.testing.assert_allclose(np.mean(means_removed, axis=0), [-0.8, 1.0], atol=0.004)

    with_ones = []
    for u, y in records:
        y_M, ones = lfilter([0, 1], [1, -0.7], u), np.ones(u.size - 1)
        Phi, Z = (np.column_stack([-x[:-1], u[:-1], ones]) for x in (y, y_M))
        with_ones.append(instrumental_variables(Z, Phi, y[1:]).theta)
    np.testing.assert_allclose(np.mean(with_ones, axis=0), [-0.8, 1.0, 1.0], atol=0.02)


@pytest.mark.parametrize(
    "name", sorted(path.stem for path in NOTEBOOKS.glob("*/*.md") if path.stem == path.parent.name)
)
def test_folds_are_closed(name: str) -> None:
    text = (NOTEBOOKS / name / f"{name}.md").read_text(encoding="utf-8")
    assert len(re.findall("<details>", text)) == len(re.findall("</details>", text))
