"""The commands on logs of several signals."""

import json

import numpy as np
import pytest
from scipy.signal import lfilter

from labsid.records.record import load_record

N = 400
RNG = np.random.default_rng(1)
U = np.column_stack([np.repeat(RNG.choice([-1.0, 1.0], 20), 20), np.repeat(RNG.choice([-2.0, 2.0], 40), 10)])
U[:20] = 0
Y = np.column_stack([lfilter([0, 0.3], [1, -0.9], U @ (1, 0.3)), lfilter([0, 0.2], [1, -0.8], U @ (0.1, 1))])
Y = np.round(Y + 0.01 * RNG.standard_normal(Y.shape), 5)
COLUMNS = ("--inputs", "Q1,Q2", "--outputs", "T1,T2")


@pytest.fixture
def log(write_text):
    rows = [",".join(map(repr, row)) for row in np.column_stack([0.5 * np.arange(N), U, Y, U[:, 0]]).tolist()]
    return write_text("Time [s],Q1 [%],Q2 [%],T1 [K],T2,r\n" + "\n".join(rows) + "\n", "heaters.csv")


def test_check(labsid, log):
    status, out, err = labsid("check", log, *COLUMNS)
    assert (status, err) == (0, "")
    for said in ("Q1: 3 levels", "T2: between", "T1: cond(Phi)", "usable for the lab: yes"):
        assert said in " ".join(out.split())
    out = labsid("check", log, *COLUMNS, "--reference", "r")[1]
    assert "closed-loop record" in out


@pytest.mark.parametrize("options", [(), ("--coupled",)])
def test_identify(labsid, log, tmp_path, options):
    status, out, err = labsid(
        "identify", log, *COLUMNS, "--order", 1, "--start", 1, "--json", tmp_path / "a.json", *options
    )
    assert (status, err) == (0, "")
    content = json.loads((tmp_path / "a.json").read_text())
    assert content["coupled"] == bool(options)
    assert f"{content['theta']['T2'][0]:.3f}" in out
    assert f"± {content['stderr']['T2'][0]:.2g}" in out
    for said in (
        "theta of T1, ± one standard error; Phi: rows k = 1 to 199",
        "Input 2 to output 1",
        "by output",
        "without Q2",
        "It is stable",
    ):
        assert said in out, said
    assert ("-a1 of T2" in out.partition("theta of T1")[2].partition("theta of T2")[0]) == bool(options)


def test_check_without_columns_says_what_to_type_for_all_signals(labsid, log):
    status, out, err = labsid("check", log)
    assert status == 2
    assert f"or, with all signals: labsid check {log} --inputs Q1,Q2,r --outputs T1,T2" in out
    assert "no columns t,u,y" in err


def test_a_record_that_is_written_is_read_with_the_options_that_it_names(labsid, log, tmp_path):
    out = tmp_path / "record.csv"
    status, said, _ = labsid("record", log, *COLUMNS, "--out", out)
    assert status == 0
    assert "note: read it with --inputs Q1,Q2 --outputs T1,T2" in said
    assert "\nt [s],Q1 [%],Q2 [%],T1 [K],T2\n" in out.read_text()
    first, again = load_record(log, inputs="Q1,Q2", outputs="T1,T2"), load_record(out, inputs="Q1,Q2", outputs="T1,T2")
    np.testing.assert_array_equal(again.u, first.u)
    np.testing.assert_array_equal(again.y, first.y)
    assert (again.units, again.Ts) == (first.units, first.Ts)


def test_a_header_of_numbered_signals_needs_no_option(labsid, log, write_text):
    numbered = write_text(log.read_text().replace("Time [s],Q1 [%],Q2 [%],T1 [K],T2", "t,u1,u2,y1,y2"), "plain.csv")
    for command in ("check", "identify"):
        assert labsid(command, numbered)[0] == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("identify", "--model", "m.json"), "--model takes one input and one output; heaters has the inputs Q1, Q2"),
        (("check", "--inputs", "Q1,Q1"), "inputs must name different columns; got 'Q1' twice"),
        (("check", "--outputs", "T1,Q1"), "'Q1' is named as an input and as an output"),
        (("identify", "--outputs", "T1,r"), "the output r is the input Q1. Leave it out"),
        (("identify", "--columns", "t,u,y"), "columns must name the times alone where inputs or outputs are named"),
    ],
)
def test_errors_are_one_line(labsid, log, arguments, message):
    command, *options = arguments
    status, _, err = labsid(command, log, *COLUMNS, *options)
    assert status == 2
    assert err.count("\n") == 1
    assert message in err


def test_what_takes_one_signal_each_says_so(labsid, log, write_text):
    numbered = write_text(log.read_text().replace("Time [s],Q1 [%],Q2 [%],T1 [K],T2", "t,u1,u2,y1,y2"), "plain.csv")
    status, _, err = labsid("gap", "limits", numbered)
    assert status == 2
    assert "takes one input and one output; plain has the inputs u1, u2 and the outputs y1, y2" in err
