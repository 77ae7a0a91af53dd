"""The lab's whole procedure, against the worked values of the errata."""

import json

import numpy as np
import pytest

from labsid.lab.arx import ArxModel
from labsid.lab.identification import identify, to_json_dict
from labsid.lab.simulation import simulate
from labsid.records.record import Record, load_record

MODEL = ArxModel([1, -1.2, 0.3], [0.1, 0.05], 0.5)


@pytest.fixture(scope="module")
def lab_record(shared_data):
    return load_record(shared_data / "unsw-water-tank" / "SysIdenData_StudentVersion.mat")


def record_from(u, y, Ts=0.5):
    return Record(t=Ts * np.arange(len(u)), u=np.asarray(u, float), y=np.asarray(y, float), Ts=Ts)


def staircase(N=400, hold=40, seed=0):
    return 2 + np.repeat(np.append(0, np.random.default_rng(seed).choice([-0.4, 0.2], N // hold)), hold)[:N]


def clean_record(N=400):
    u = staircase(N)
    return record_from(u, 2.5 + simulate(MODEL, u - 2))


def last_digit(value, printed):
    """Whether `value` rounds to what is printed, such as 1.24894e-3."""
    mantissa, _, exponent = printed.partition("e")
    digits = len(mantissa.partition(".")[2])
    return round(value / 10.0 ** int(exponent or 0), digits) == float(mantissa)


def test_order_2_gives_the_worked_values_to_their_last_digit(lab_record):
    out = to_json_dict(identify(lab_record, order=2, start=2))
    for value, printed in zip(out["theta"], ["1.37746171", "-0.39246554", "-0.00666983", "0.05140205"], strict=True):
        assert last_digit(value, printed)
    assert last_digit(out["y_offset"], "2.32781863")
    assert last_digit(out["condition_number"], "269.75")
    assert last_digit(out["mse"]["all"], "8.9450e-4")
    assert last_digit(out["mse"]["second_half"], "2.31725e-2")
    assert last_digit(out["mse"]["second_half_carried"], "1.24894e-3")
    assert out["u_offset"] == 2.0
    assert out["settled"] == [0, 51]
    assert (out["samples"], out["Ts"], out["order"]) == (903, 0.75, 2)


def test_order_1_gives_the_worked_values_to_their_last_digit(lab_record):
    out = to_json_dict(identify(lab_record, order=1, start=1))
    assert last_digit(out["theta"][0], "0.9775761")
    assert last_digit(out["theta"][1], "0.06811909")
    assert last_digit(out["mse"]["all"], "9.2428e-4")
    assert last_digit(to_json_dict(identify(lab_record, order=1))["mse"]["all"], "9.2421e-4")


def test_the_lab_file_needs_no_warning_and_its_halves_are_451_and_452(lab_record):
    result = identify(lab_record)
    assert result.warnings == ()
    assert result.verification.half == 451
    assert (result.regression.start, result.regression.stop) == (2, 451)
    assert result.regression.Phi.shape == (449, 4)
    assert result.excitation.positive_definite
    # The remedy of 3b: with the state estimated, the run starts where the output is.
    start = lab_record.y[451] - result.offsets.y_offset
    assert result.verification.y_second_half[0] == 0
    assert start > 0.6
    assert result.verification.y_second_half_estimated[0] == pytest.approx(start, abs=0.03)
    assert result.verification.mse_second_half_estimated < result.verification.mse_second_half_carried


@pytest.mark.parametrize("name", ["4", "8"])
def test_records_from_an_empty_tank_go_through_and_say_so(shared_data, name):
    record = load_record(shared_data / "unsw-water-tank" / f"SysIdenData_{name}.mat")
    result = identify(record)
    assert result.offsets.status == "settled"
    assert result.offsets.settled[0] > 100
    assert len(result.warnings) == 1
    assert "does not start at rest: samples 0 to" in result.warnings[0]
    assert result.model.is_stable
    assert result.verification.mse_second_half_carried < 0.01
    assert "take the lags before sample 0 as zero" in identify(record, start=1).warnings[1]


def test_a_known_model_is_found_exactly_in_clean_data():
    result = identify(clean_record())
    np.testing.assert_allclose(result.model.theta, MODEL.theta, rtol=1e-8)
    assert (result.model.u_offset, result.model.Ts) == (2.0, 0.5)
    assert result.model.y_offset == pytest.approx(2.5, abs=1e-12)
    assert result.verification.mse_all < 1e-20
    assert result.warnings == ()


def test_only_the_first_half_is_used_to_fit():
    record = clean_record()
    spoiled = record.y.copy()
    spoiled[200:] += np.random.default_rng(0).standard_normal(200)
    np.testing.assert_allclose(identify(record_from(record.u, spoiled)).model.theta, MODEL.theta, rtol=1e-6)


def test_the_json_has_the_documented_keys_and_only_plain_numbers():
    out = to_json_dict(identify(clean_record()))
    assert list(out) == [
        "Ts", "samples", "u_offset", "y_offset", "settled", "order", "theta", "a", "b", "poles", "mse",
        "condition_number",
    ]  # fmt: skip
    assert list(out["mse"]) == ["all", "second_half", "second_half_carried"]
    assert json.loads(json.dumps(out, allow_nan=False)) == out
    assert out["a"] == pytest.approx([1, -1.2, 0.3])
    assert out["theta"] == pytest.approx([1.2, -0.3, 0.1, 0.05])
    assert np.array(out["poles"]) == pytest.approx(np.array([[0.844948974, 0], [0.355051026, 0]]))


def test_a_complex_pair_of_poles_is_written_as_real_and_imaginary_part():
    u = staircase()
    wavy = ArxModel([1, -1.2, 0.72], [0.1, 0.05], 0.5)
    poles = to_json_dict(identify(record_from(u, simulate(wavy, u - 2))))["poles"]
    assert np.array(poles) == pytest.approx(np.array([[0.6, -0.6], [0.6, 0.6]]))


def test_a_first_period_too_short_or_unsettled_is_a_warning():
    u = staircase()[35:]
    short = identify(record_from(u, simulate(MODEL, u - 2)))
    assert short.warnings == (
        "the input first changes at sample 5, too early to see whether the output was settled; its mean until "
        "then may not be the output offset, which shifts every free run by a constant",
    )
    u = staircase()
    slow = ArxModel([1, -0.99], [0.01], 0.5)
    y = simulate(slow, u - 2, x0=[-100.0])
    unsettled = identify(record_from(u, y), order=1)
    assert unsettled.offsets.status == "not settled"
    assert (
        "does not settle before the first change of the input; its mean over samples 30 to 39"
        in (unsettled.warnings[0])
    )


def test_an_unstable_model_is_a_warning():
    u = staircase()
    result = identify(record_from(u, simulate(ArxModel([1, -1.01], [0.01], 0.5), u - 2)), order=1)
    assert any("the identified model is unstable: its largest pole has magnitude 1.01" in w for w in result.warnings)


def white(N, seed=1):
    return np.random.default_rng(seed).standard_normal(N)


@pytest.mark.parametrize(
    ("record", "settings", "message"),
    [
        (record_from(np.full(50, 2.0), white(50)), {}, "u must change at least once; got the constant 2 over all 50"),
        (
            record_from(np.where(np.arange(50) < 30, 2, 1), white(50)),
            {},
            "must be persistently exciting; got a Phi of rank 2 for 4 unknowns: the input never changes in the first",
        ),
        (
            record_from(white(50), np.full(50, 1.5)),
            {},
            "got a Phi of rank 2 for 4 unknowns: the output never changes in the first half",
        ),
        (
            record_from(np.sin(np.arange(80.0)), np.cos(np.arange(80.0)) - 1),
            {"order": 3},
            "for 6 unknowns: the signals of the first half are too simple for this order",
        ),
        (
            record_from(1e12 * white(50), 1e-12 * white(50, 2)),
            {},
            r"of sizes that one matrix can hold; got outputs up to \d\S+e-12 and inputs up to \d\S+e\+12\. Convert",
        ),
        (record_from(white(10), white(10)), {}, "leave 4 rows in the first half, .*; got start 2 and 5 samples there"),
        (record_from(white(50), white(50)), {"start": -1}, "start must be 0 or more .*; got start -1 and 25"),
        (record_from(white(50), white(50)), {"start": 24}, "got start 24 and 25 samples there"),
        (record_from(white(50), white(50)), {"order": 0}, r"order must be at least 1; got 0\."),
    ],
)
def test_records_that_cannot_be_identified(record, settings, message):
    with pytest.raises(ValueError, match=message):
        identify(record, **settings)


def test_nothing_of_it_needs_matplotlib_or_python_control():
    import subprocess
    import sys

    code = (
        "import sys, labsid.lab.identification, labsid.lab.diagrams, labsid.lab.step_response, labsid.lab.sinusoid; "
        "print([m for m in ('matplotlib', 'control', 'IPython', 'nbgrader') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
