"""The procedure of the lab on several signals: truth, the lab's own case, real records, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import lfilter

from labsid.estimation.subspace import fit_subspace
from labsid.lab.arx import fit_arx
from labsid.lab.arx_system import fit_arx_system
from labsid.lab.identification import identify
from labsid.lab.record_verification import verify_system_on_record
from labsid.lab.system_identification import identify_system, to_json_dict
from labsid.lab.system_verification import verify_system
from labsid.lab.verification import verify
from labsid.records.record import Record, load_record

N = 600
RNG = np.random.default_rng(1)
T = 0.5 * np.arange(N)
U = np.column_stack(
    [np.repeat(RNG.choice([-1.0, 1.0], 30), 20), np.repeat(RNG.choice([-2.0, 2.0], 60), 10)]
) + np.array([3, 5])
U[:30] = [3, 5]
NAMES = {"inputs": ("Q1", "Q2"), "outputs": ("T1", "T2"), "units": ("%", "%", "K", "")}


def make_record(noise=0.0, **changes):
    gains = [(0.3, 0.05, 0.9), (0.1, 0.4, 0.8)]
    y = np.column_stack([lfilter([0, 1], [1, -a], (U - [3, 5]) @ (q1, q2)) for q1, q2, a in gains]) + np.array([20, -7])
    y += noise * RNG.standard_normal(y.shape)
    return Record(**({"t": T, "u": U, "y": y, "Ts": 0.5, "name": "rig", **NAMES} | changes))


@pytest.mark.parametrize("coupled", [False, True])
def test_a_known_rig_is_found_with_its_offsets(coupled):
    found = identify_system(make_record(), order=1, start=1, coupled=coupled)
    np.testing.assert_allclose(found.model.u_offset, [3, 5])
    np.testing.assert_allclose(found.model.y_offset, [20, -7])
    np.testing.assert_allclose(found.model.b[:, :, 0], [[0.3, 0.05], [0.1, 0.4]], atol=1e-9)
    np.testing.assert_allclose(found.model.a[:, :, 1], [[-0.9, 0.0], [0.0, -0.8]], atol=1e-9)
    np.testing.assert_allclose(found.model.static_gain, [[3.0, 0.5], [0.5, 2.0]], rtol=1e-8)
    runs = found.verification
    assert max(runs.mse_all.max(), runs.mse_second_half_carried.max(), runs.mse_second_half_estimated.max()) < 1e-15
    assert runs.mse_second_half.min() > 1e-3  # the rig is not at rest in the middle
    assert found.warnings == ()


def test_the_error_without_an_input_is_what_it_contributes():
    found = identify_system(make_record(), order=1, start=1)
    for j in range(2):
        alone = (U - [3, 5])[:, j]
        for i, (b, a) in enumerate([((0.3, 0.05), 0.9), ((0.1, 0.4), 0.8)]):
            share = lfilter([0, b[j]], [1, -a], alone)[N // 2 :]
            assert found.verification.mse_without[i, j] == pytest.approx(np.mean(share**2), rel=1e-6)


def test_errors_are_those_of_the_lab_where_there_is_one_signal_each(staircase):
    u, y = staircase["u"] - 2.0, staircase["y"] - 2.3
    model = fit_arx(u, y, 0.75, stop=300).model
    lab = verify(model, u, y)
    one = Record(staircase["t"], staircase["u"], staircase["y"], 0.75)
    found, expected = identify_system(one), identify(one)
    np.testing.assert_array_equal(found.equations[0].fit.theta, expected.fit.theta)
    assert found.model.y_offset[0] == expected.offsets.y_offset
    for name in ("all", "second_half", "second_half_carried", "second_half_estimated"):
        several = getattr(found.verification, f"mse_{name}")[0]
        assert several == pytest.approx(getattr(expected.verification, f"mse_{name}"), rel=1e-6)
        assert several == pytest.approx(getattr(lab, f"mse_{name}"), rel=0.3)


def test_outputs_that_are_missing_are_neither_fitted_nor_scored():
    whole = make_record(0.02)
    y = whole.y.copy()
    y[40:45, 0] = y[400:450, 1] = np.nan
    y[:3] = y[-2:] = np.nan
    found = identify_system(replace(whole, y=y), order=1)
    assert len(found.record) == N - 5
    assert found.equations[0].regression.Y.size < found.equations[1].regression.Y.size
    assert np.isnan(found.y[:, 1]).sum() == 50
    np.testing.assert_allclose(found.model.static_gain, [[3.0, 0.5], [0.5, 2.0]], rtol=0.1)
    assert np.sqrt(found.verification.mse_second_half_carried).max() < 0.2


def test_inputs_without_rest_have_means_as_offsets():
    u = RNG.standard_normal((N, 2)) + 10
    y = np.column_stack([lfilter([0, 0.5], [1, -0.5], u[:, 0]), lfilter([0, 0.5], [1, -0.7], u[:, 1])])
    found = identify_system(Record(T, u, y, 0.5))
    np.testing.assert_allclose(found.model.u_offset, u[:300].mean(axis=0))
    assert found.warnings[0].startswith("the inputs move from the first samples on")


def test_json_has_names():
    content = to_json_dict(identify_system(make_record(0.02)))
    assert content["signals"]["inputs"] == [
        {"name": "Q1", "unit": "%", "offset": 3.0},
        {"name": "Q2", "unit": "%", "offset": 5.0},
    ]
    assert (len(content["theta"]["T1"]), len(content["stderr"]["T2"]), content["coupled"]) == (6, 6, False)
    assert set(content["mse"]["without_input"]["T2"]) == {"Q1", "Q2"}
    assert content["static_gain"]["T1"]["Q1"] == pytest.approx(3.0, rel=0.1)


@pytest.mark.parametrize(
    ("changes", "options", "message"),
    [
        ({"u": U * [1, 0]}, {}, r"the input Q2 is constant \(0\)\. It excites nothing: leave it out"),
        ({"u": U[:, [0, 0]] * [1, 3]}, {}, r"the input Q2 is 3 times Q1, but for a constant"),
        ({"y": U[:, [1, 0]] + [0.1, 0]}, {}, r"the output T2 is the input Q1"),
        ({}, {"order": 100}, r"leave 300 rows in the first half, one for each unknown of T1: order 100 of 3 signals"),
        ({}, {"order": 0}, r"order must be at least 1; got 0"),
        ({"u": np.where(T[:, None] < 200, [3, 5], U)}, {}, r"persistently exciting; .* of T1: Q1, Q2 never change in"),
    ],
)
def test_what_is_refused_names_the_column(changes, options, message):
    with pytest.raises(ValueError, match=message):
        identify_system(make_record(0.02, **changes), **options)


@given(st.lists(st.floats(0.01, 100), min_size=4, max_size=4), st.lists(st.floats(-1e3, 1e3), min_size=4, max_size=4))
def test_units_and_zero_points_of_the_signals_do_not_matter(scale, shift):
    scale, shift = np.array(scale), np.array(shift)
    plain = identify_system(make_record(0.0), order=1)
    record = make_record(0.0)
    moved = replace(record, u=record.u * scale[:2] + shift[:2], y=record.y * scale[2:] + shift[2:])
    found = identify_system(moved, order=1)
    expected = plain.model.b * (scale[2:, np.newaxis] / scale[:2])[:, :, np.newaxis]
    np.testing.assert_allclose(found.model.b / expected, 1.0, rtol=1e-3)
    np.testing.assert_allclose(found.model.y_offset, plain.model.y_offset * scale[2:] + shift[2:], rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(found.model.poles, plain.model.poles, atol=1e-6)


# The records of `shared/data/several-signals` -------------------------------------------------------------


def pairwise_errors(found, record, order):
    """The least error, for each output, of models of that output and one input."""
    half, errors = len(record) // 2, []
    for y in np.nan_to_num(found.y).T:
        runs = [verify(fit_arx(u, y, record.Ts, order, order, half).model, u, y) for u in found.u.T]
        errors.append(min(run.mse_second_half_carried for run in runs))
    return np.sqrt(errors)


@pytest.mark.parametrize(
    ("name", "inputs", "outputs", "Ts", "order", "bound"),
    [
        ("winding", "1,2,3,4,5", "tension_1,tension_3", 0.1, 3, (0.36, 0.60)),
        ("evaporator", "1,2,3", "dry_matter,flow,temperature", 1.0, 2, (0.95, 0.95, 0.97)),
    ],
)
def test_all_inputs_follow_the_second_half_better_than_the_best_one(
    shared_data, name, inputs, outputs, Ts, order, bound
):
    path = shared_data / "several-signals" / f"{name}.csv"
    record = load_record(path, inputs=inputs, outputs=outputs, Ts=Ts)
    found = identify_system(record, order, order)
    errors = np.sqrt(found.verification.mse_second_half_carried)
    deviation = found.y[found.verification.half :].std(axis=0)
    assert np.all(errors < 1.002 * pairwise_errors(found, record, order))
    assert np.all(errors / deviation < bound)


def test_a_subspace_model_of_the_winding_follows_the_second_half_better(shared_data):
    path = shared_data / "several-signals" / "winding.csv"
    found = identify_system(load_record(path, inputs="1,2,3,4,5", outputs="6,7", Ts=0.1), 3, 3)
    model = fit_subspace(found.u[:1250], found.y[:1250], 0.1, 6).model
    errors = verify_system(model, found.u, found.y).mse_second_half_carried
    assert np.all(errors < found.verification.mse_second_half_carried)


def test_heaters_that_never_change_are_named(shared_data):
    folder = shared_data / "several-signals"
    with pytest.raises(ValueError, match=r"the input Q1 is constant \(50\)"):
        identify_system(load_record(folder / "tclab-two-heaters.csv", inputs="Q1,Q2", outputs="T1,T2"))
    step = load_record(folder / "tclab-step.csv", inputs="Q1", outputs="T1,T2", repeated="first")
    alone, coupled = (identify_system(step, order=1, start=1, coupled=coupled) for coupled in (False, True))
    assert coupled.model.static_gain[:, 0] == pytest.approx([0.68, 0.2], abs=0.02)  # 34.8 and 10.3 degrees from 50 %
    errors = [np.sqrt(found.verification.mse_second_half_carried) for found in (alone, coupled)]
    assert np.all(errors[1] < [0.6, 0.5])
    assert np.all(errors[1] < 0.25 * errors[0])  # the heat reaches the second sensor by way of the first


@pytest.fixture(scope="module")
def arms(shared_data):
    names = [",".join(f"{what}_{joint}" for joint in range(1, 7)) for what in ("torque", "angle")]
    folder = shared_data / "several-signals"
    return [load_record(folder / f"arm-{run}.csv", inputs=names[0], outputs=names[1]) for run in (1, 2)]


def test_coupled_joints_follow_a_second_run_better_than_joint_by_joint(arms):
    """Five joints: the sixth hardly moves, and no linear model follows it."""
    first, second = arms

    def errors(one, other, coupled):
        """Fit to all of one run, free run of the other."""
        u_offset, y_offset = one.input_columns.mean(axis=0), one.output_columns.mean(axis=0)
        u, y = one.input_columns - u_offset, one.output_columns - y_offset
        model = fit_arx_system(u, y, one.Ts, 2, coupled=coupled, inputs=one.inputs, outputs=one.outputs).model
        return np.sqrt(verify_system_on_record(replace(model, u_offset=u_offset, y_offset=y_offset), other).mse)

    coupled = errors(first, second, coupled=True)
    alone = np.array([errors(first.pair(k, k), second.pair(k, k), coupled=False)[0] for k in range(6)])
    assert np.all(coupled[:5] < 0.7 * alone[:5])
    assert np.all(coupled[:5] < 0.31 * second.y[50:].std(axis=0)[:5])
