"""Responses of an identified model: those of python-control, with the errors of many records."""

import control
import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.lab.arx import ArxModel, fit_arx, to_tf
from labsid.lab.model_responses import responses_of_model

A, B, TS = np.poly([0.9, 0.6]), np.array([0.05, 0.1]), 0.5
MODEL = ArxModel(A, B, TS)


def test_the_responses_are_those_of_python_control():
    found = responses_of_model(MODEL, np.zeros((4, 4)))
    system = to_tf(MODEL)
    np.testing.assert_allclose(found.gain, system(np.exp(2j * np.pi * found.frequency * TS)), rtol=1e-9)
    np.testing.assert_allclose(found.step, control.step_response(system, found.time).outputs, atol=1e-9)
    assert found.frequency[-1] == pytest.approx(0.5 / TS)
    assert found.step[-1] == pytest.approx(MODEL.static_gain, rel=0.01)
    assert [pole.value for pole in found.poles] == pytest.approx([0.9, 0.6])
    assert [zero.value for zero in found.zeros] == pytest.approx([-2.0])


def test_the_errors_are_those_of_many_records():
    rng, gains, steps, phases, poles = np.random.default_rng(0), [], [], [], []
    u = np.repeat(rng.standard_normal(400), 3)
    clean = responses_of_model(MODEL, np.zeros((4, 4)))
    for _ in range(60):
        y = lfilter([0.0, *B], A, u) + lfilter([1.0], A, 0.01 * rng.standard_normal(u.size))
        fit = fit_arx(u, y, TS)
        found = responses_of_model(fit.model, fit.fit.covariance)
        at = np.searchsorted(found.frequency, [0.02, 0.1, 0.5])
        true = to_tf(MODEL)(np.exp(2j * np.pi * found.frequency[at] * TS))
        off = found.gain[at] / true
        gains.append(np.abs(np.abs(off) - 1.0) < found.gain_error[at])
        phases.append(np.abs(np.angle(off)) < found.phase_error[at])
        places = [5, 20, 40]
        steps.append(
            np.abs(found.step - np.interp(found.time, clean.time, clean.step))[places] < found.step_error[places]
        )
        poles.append(
            [
                abs(p.value - q) < 1.96 * np.sqrt(p.covariance[0, 0])
                for p, q in zip(found.poles, (0.9, 0.6), strict=True)
            ]
        )
    for inside in (gains, phases, steps, poles):
        assert 0.86 <= np.mean(inside) <= 1.0


@pytest.mark.parametrize("a", [[1.0, -1.0], [1.0, -1.2], [1.0, 0.0]])
def test_a_model_that_does_not_settle_has_responses_of_limited_length(a):
    found = responses_of_model(ArxModel(np.array(a), np.array([1.0]), TS), np.zeros((2, 2)))
    assert found.time.size <= 2001
    assert np.isfinite(found.gain[np.isfinite(found.gain)]).all()
    assert np.isfinite(found.step).all()
