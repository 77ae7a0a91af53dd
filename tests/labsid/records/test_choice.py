"""Which columns become inputs and outputs: by option, by number, by header; and what is refused."""

import numpy as np
import pytest

from labsid.records.choice import UnknownColumns
from labsid.records.formats import read_raw
from labsid.records.reading import Reading
from labsid.records.record import load_record

ROWS = np.column_stack([0.5 * np.arange(30), np.random.default_rng(1).integers(0, 9, (30, 5))])


@pytest.fixture
def write(write_text):
    def rows(header, values=ROWS):
        lines = [",".join(map(str, row)) for row in values.tolist()]
        return write_text("\n".join([header, *lines] if header else lines) + "\n")

    return rows


@pytest.mark.parametrize(
    ("header", "inputs", "outputs", "places"),
    [
        ("t,u1,u2,y1,y2,r", ("u1", "u2"), ("y1", "y2"), (1, 2, 3, 4)),
        ("t,u_2,u_1,y,a,b", ("u_1", "u_2"), ("y",), (2, 1, 3)),
        ("t,u,y1,y2,y3,a", ("u",), ("y1", "y2", "y3"), (1, 2, 3, 4)),
        ("Time [ms],rig.u[0],rig.u[1],rig.y[0],a,b", ("rig.u[0]", "rig.u[1]"), ("rig.y[0]",), (1, 2, 3)),
        ("t,Input 1,input2,output1,a,b", ("input2",), ("output1",), (2, 3)),
    ],
)
def test_a_header_of_numbered_signals_needs_no_option(write, header, inputs, outputs, places):
    loaded = load_record(write(header))
    assert (loaded.inputs, loaded.outputs) == (inputs, outputs)
    columns = np.column_stack([loaded.input_columns, loaded.output_columns])
    np.testing.assert_array_equal(columns, ROWS[:, places])


def test_one_of_each_stays_as_it_is(write):
    loaded = load_record(write("t,u,y,u1,u2,y1"))
    assert (loaded.inputs, loaded.outputs, loaded.several) == (("u",), ("y",), False)
    np.testing.assert_array_equal(loaded.y, ROWS[:, 2])


@pytest.mark.parametrize(
    ("options", "names", "places"),
    [
        ({"inputs": "Q1,Q2", "outputs": "T1,T2"}, "Q1 Q2 T1 T2", (1, 2, 3, 4)),
        ({"inputs": " q2 ", "outputs": "4,5"}, "Q2 T1 T2", (2, 3, 4)),
        ({"inputs": "Q1", "outputs": "T1"}, "Q1 T1", (1, 3)),
        ({"inputs": "Q1", "outputs": "T1", "columns": "Time"}, "Q1 T1", (1, 3)),
    ],
)
def test_columns_by_name_or_number(write, options, names, places):
    loaded = load_record(write("Time,Q1 [%],Q2,T1 [K],T2,r"), **options)
    assert loaded.signal_names == tuple(names.split())
    columns = np.column_stack([loaded.input_columns, loaded.output_columns])
    np.testing.assert_array_equal(columns, ROWS[:, places])
    assert loaded.Ts == 0.5
    assert dict(zip(loaded.signal_names, loaded.units, strict=True))["T1"] == "K"


def test_a_reference_with_any_columns(write):
    path = write("t,u,y,a,b,r")
    np.testing.assert_array_equal(load_record(path, reference="r").reference, ROWS[:, 5])
    loaded = load_record(path, inputs="a", outputs="y,b", reference="6")
    np.testing.assert_array_equal(loaded.reference, ROWS[:, 5])
    assert loaded.pair("a", "b").reference is not None


def test_without_header_the_first_column_is_the_time_unless_there_is_a_sampling_time(write):
    path = write("")
    timed = load_record(path, inputs="2,3", outputs="4")
    assert (timed.Ts, timed.notes) == (0.5, ("no header: column 1 taken as t",))
    assert load_record(path, inputs="1,2", outputs="4", Ts=0.1).Ts == 0.1


def test_a_matrix_stands_for_its_columns(tmp_path):
    path = tmp_path / "log.npz"
    np.savez(path, t=ROWS[:, 0], u=ROWS[:, 1:3], y=ROWS[:, 3:5])
    for options in ({}, {"inputs": "u", "outputs": "y"}):
        loaded = load_record(path, **options)
        assert (loaded.inputs, loaded.outputs) == (("u.1", "u.2"), ("y.1", "y.2"))
        np.testing.assert_array_equal(loaded.u, ROWS[:, 1:3])


def test_columns_of_one_name_are_told_apart_by_their_numbers(write):
    path = write("t,a,a,b,c,d")
    with pytest.raises(UnknownColumns, match=r"2 columns are called 'a'\. Give the number of one: 2, 3"):
        load_record(path, inputs="a", outputs="b")
    assert load_record(path, inputs="2,3", outputs="b").inputs == ("a (2)", "a (3)")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"inputs": "Q1,1", "outputs": "T1"}, r"there is no time column\. Give the sampling time with Ts"),
        ({"inputs": "Q1,2", "outputs": "T1"}, r"inputs must name different columns; got 'Q1' twice\. Leave out one"),
        ({"inputs": "Q1,T1", "outputs": "T1,T2"}, r"'T1' is named as an input and as an output\. Leave it out"),
        ({"inputs": "Q1,,Q2", "outputs": "T1"}, r"inputs must name columns, with commas between them; got 'Q1,,Q2'"),
        ({"inputs": "Q1", "outputs": "T9"}, r"there is no column 'T9'; the columns are Time, Q1"),
        ({"inputs": "Q1"}, r"no outputs; the columns are Time, .*\. Name them, by name or number \(--outputs c,d\)"),
        ({"outputs": "T1"}, r"no inputs; the columns are .* \(--inputs a,b\)"),
        ({"inputs": "Q1", "outputs": "T1", "reference": "T1"}, r"'T1' is named as the reference and as another signal"),
        ({"inputs": "Q1", "outputs": "T1", "columns": "t,u,y"}, r"columns must name the times alone where inputs"),
    ],
)
def test_what_is_refused_names_the_column(write, options, message):
    with pytest.raises(ValueError, match=message):
        load_record(write("Time,Q1,Q2,T1,T2,r"), **options)


def test_signals_of_different_lengths(tmp_path):
    path = tmp_path / "log.npz"
    np.savez(path, t=np.arange(20.0), u1=np.arange(20.0), u2=np.arange(19.0), y=np.arange(20.0))
    with pytest.raises(ValueError, match=r"log.npz: columns must have equal length; u1 has 20, u2 has 19\. Cut them"):
        read_raw(path, Reading())
