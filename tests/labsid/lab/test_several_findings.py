"""What is said of a record of several signals, and why a model of it is refused: each sentence names the column."""

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.lab.record_check import check_record
from labsid.lab.several_findings import signal_faults
from labsid.records.formats import RawRecord

N = 400
RNG = np.random.default_rng(1)
T = 0.5 * np.arange(N)
U = np.column_stack([np.repeat(RNG.choice([-1.0, 1.0], 20), 20), np.repeat(RNG.choice([-1.0, 1.0], 40), 10)])
U[:20] = U[0]
Y = np.column_stack([lfilter([0, 0.2], [1, -0.8], U @ gains) for gains in ([1.0, 0.3], [0.2, 2.0])])
Y += 0.01 * RNG.standard_normal(Y.shape)
NAMES = {"inputs": ("Q1", "Q2"), "outputs": ("T1", "T2"), "name": "rig"}


def raw(**changes):
    return RawRecord(**({"t": T, "u": U, "y": Y} | NAMES | changes))


def texts(record, level):
    return [finding.text for finding in check_record(record).findings if finding.level == level]


def test_each_signal_is_described_by_its_name():
    checked = check_record(raw())
    assert checked.usable
    assert checked.samples == N
    ok = texts(raw(), "ok")
    for beginning in ("Q1: 2 levels", "Q2: 2 levels", "T1: between", "T2: sd 0.0", "T1: cond(Phi)", "T2: cond(Phi)"):
        assert any(text.startswith(beginning) for text in ok), beginning


def test_missing_outputs_by_name():
    y = Y.copy()
    y[50:52, 1] = np.nan
    assert any(text.startswith("T2 is missing in 2 of 400") for text in texts(raw(y=y), "note"))


def test_inputs_that_move_from_the_start_have_no_rest():
    record = raw(u=RNG.standard_normal(U.shape))
    assert any("there is no period at rest" in text for text in texts(record, "note"))
    assert check_record(record).verdict.startswith("usable for the lab: yes")
    assert "at rest" not in check_record(record).verdict


@pytest.mark.parametrize(
    ("changes", "beginning"),
    [
        ({"u": U * [1, 0]}, "the input Q2 is constant (0). It excites nothing: leave it out of the inputs (--inputs)"),
        ({"y": Y * [0, 1] + 3}, "the output T1 is constant (3). There is nothing to model"),
        ({"u": U[:, [0, 0]] * [1, 2]}, "the input Q2 is 2 times Q1, but for a constant, so that their effects cannot"),
        ({"y": Y[:, [0, 0]] * [1, -0.5] + 7}, "the output T2 is -0.5 times T1, but for a constant, so that it holds"),
        ({"y": np.column_stack([Y[:, 0], U[:, 1]])}, "the output T2 is the input Q2. Leave it out of the outputs"),
        ({"t": T[:7], "u": U[16:23], "y": Y[16:23]}, "the first half has 3 samples, too few for the 3 unknowns"),
    ],
)
def test_what_makes_a_model_impossible_is_refused_with_the_column(changes, beginning):
    record = raw(**changes)
    assert any(text.startswith(beginning) for _, text in signal_faults(record))
    assert any(text.startswith(beginning) for text in texts(record, "refused"))
    assert not check_record(record).usable


def test_a_sound_record_has_no_faults():
    assert signal_faults(raw()) == []
    assert signal_faults(raw(y=np.column_stack([U[:, 0] * 2, Y[:, 1]]))) == []  # a static gain is a model


def test_a_reference_is_a_closed_loop():
    assert any(text.startswith("it is a closed-loop record") for text in texts(raw(reference=T), "refused"))


def test_feedback_is_said_of_the_pair():
    u = np.column_stack([U[:, 0], np.append(0.0, -3 * Y[:-1, 1]) + 0.01 * RNG.standard_normal(N)])
    assert any(text.startswith("Q2, T2: the output up to the same sample") for text in texts(raw(u=u), "warning"))
