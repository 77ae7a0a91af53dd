"""Text as loggers write it: delimiters, decimal marks, headers, units, numbers, and stamps of every kind."""

import re
from datetime import datetime, timedelta

import numpy as np
import pytest

from labsid.records.contents import suggested_options, summarize
from labsid.records.fields import kind_of
from labsid.records.record import load_record, reading_notes
from labsid.records.text_file import open_text
from labsid.records.units import is_time_name, is_unit, split_unit, split_units, unit_in_time_name

N = 60
T = np.arange(N) * 0.1
U = np.repeat([0.0, 1.0, 2.5], N // 3)
Y = np.round(np.sin(np.arange(N) / 9), 4)


def table(header="t,u,y", t=None, u=None, y=None, delimiter=","):
    """Rows of text; each column is given as text or taken from the record."""
    columns = [
        [f"{x:.1f}" for x in T] if t is None else t,
        [f"{x:.1f}" for x in U] if u is None else u,
        [f"{x:.4f}" for x in Y] if y is None else y,
    ]
    rows = [delimiter.join(row) for row in zip(*columns, strict=True)]
    return "\n".join([*([header] if header else []), *rows]) + "\n"


def commas(values, form):
    return [form.format(x).replace(",", " ").replace(".", ",").replace(" ", ".") for x in values]


def assert_read(record, u=U, y=Y, t=T):
    np.testing.assert_allclose(record.t, t, atol=1e-9)
    np.testing.assert_array_equal(record.u, u)
    np.testing.assert_allclose(record.y, y, rtol=0, atol=1e-12)
    assert record.Ts == pytest.approx(0.1, rel=1e-12)


@pytest.mark.parametrize("delimiter", [",", ";", "\t", "|", "  "])
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_delimiters_and_encodings(write_text, delimiter, encoding):
    header = delimiter.join(["t", "u", "y"])
    text = "# Füllstand\n" + table(header, delimiter=delimiter)
    assert_read(load_record(write_text(text, encoding=encoding)))


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r", "\r\r\n"])
def test_ends_of_lines(write_text, end):
    assert_read(load_record(write_text(table().replace("\n", end))))


@pytest.mark.parametrize(
    ("text", "units", "note"),
    [
        (table("t [s];u [V];y [cm]", delimiter=";"), ("V", "cm"), ""),
        (table("Time (s)\tInput (V)\tOutput (cm)", delimiter="\t"), ("V", "cm"), ""),
        (table("Time (s)   Input (V)   Output (cm)", delimiter="   "), ("V", "cm"), ""),
        (table("t,u,y\n[s],[V],[cm]"), ("V", "cm"), "the row under the header read as units: s, V, cm"),
        ("Device: DAQ-1\nDate: 2026-01-01\nChannels,3\n\n" + table(), ("", ""), "3 lines before the table skipped"),
        (table("t,u,y,").replace(",\n", "\n").replace("\n", ",\n"), ("", ""), ""),
        (table('"t","u","y"').replace("0.1,", '"0.1",'), ("", ""), ""),
        (table(""), ("", ""), "no header: columns taken as t,u,y"),
        (table("TIME,U,Y"), ("", ""), ""),
    ],
)
def test_headers_units_and_lines_before_the_table(write_text, text, units, note):
    record = load_record(write_text(text))
    assert_read(record)
    assert record.units == units
    assert note in "; ".join(record.notes)


def test_decimal_commas_and_marks_of_thousands(write_text):
    t, y = commas(T, "{:.1f}"), commas(Y, "{:.4f}")
    german = table("t;u;y", t, commas(1000 * U + 1000, "{:,.1f}"), y, ";")
    record = load_record(write_text(german))
    assert_read(record, u=1000 * U + 1000)
    assert record.notes == ("decimal commas read as decimal points", "'.' read as a mark of thousands")
    english = load_record(write_text(table("t;u;y", u=[f"{1000 * x + 1000:,.1f}" for x in U], delimiter=";")))
    assert_read(english, u=1000 * U + 1000)
    for mark in ("'", "’", "\N{NO-BREAK SPACE}"):  # of Switzerland, and of France with decimal commas
        u = [f"{1000 * x + 1000:,.1f}".replace(",", mark) for x in U]
        assert_read(load_record(write_text(table("t;u;y", u=u, delimiter=";"))), u=1000 * U + 1000)
        decimal = [x.replace(".", ",") for x in u]
        record = load_record(write_text(table("t;u;y", t, decimal, commas(Y, "{:.4f}"), ";")))
        assert_read(record, u=1000 * U + 1000)
        assert record.notes[-1] == f"{mark!r} read as a mark of thousands"
    counted = table("t;u;y", [f"{1000 * k:,}".replace(",", "'") for k in range(N)], delimiter=";").replace("t;", "ms;")
    assert load_record(write_text(counted)).Ts == 1.0
    blanks = load_record(write_text(table("t u y", t, commas(U, "{:.1f}"), y, " ")))
    assert_read(blanks)


def test_a_file_that_mixes_the_marks_is_refused_with_its_line(write_text):
    mixed = table("t;u;y", u=["1,5", *["1.5"] * (N - 1)], delimiter=";")
    with pytest.raises(ValueError, match=r"line 2, column 2: '1,5' is not a number"):
        load_record(write_text(mixed))


def test_numbers_of_fortran(write_text):
    y = [f"{x:.4f}D+00" for x in Y]
    y[3], y[5] = "1.0-114", "-2.5d-3"
    record = load_record(write_text(table("", y=y, delimiter="  ")))
    assert (record.y[3], record.y[5]) == (1e-114, -2.5e-3)
    assert len(record) == N  # a first row with such a number is no header
    assert load_record(write_text(table("", [f"{x:.1f}D+00" for x in T], y=y, delimiter="  "))).t[0] == 0.0


def test_switches_are_one_and_zero_and_it_is_said(write_text):
    for on, off in (("ON", "OFF"), ("true", "false"), ("High", "Low")):
        record = load_record(write_text(table(u=[on if x else off for x in U])))
        assert_read(record, u=U > 0)
        assert record.notes == ("u: on read as 1, off as 0",)
    with pytest.raises(ValueError, match=r"line 62, column 2: 'maybe' is not a switch"):
        load_record(write_text(table(u=["ON"] * N) + "6.0,maybe,1\n"))


@pytest.mark.parametrize("word", ["", "NaN", "NA", "null", "-", "#N/A", "ovf", "-1.#IND", "#DIV/0!"])
def test_missing_outputs_are_nan_and_counted(write_text, word):
    y = [f"{x:.4f}" for x in Y]
    y[7] = y[8] = y[20] = word
    record = load_record(write_text(table(y=y)))
    assert np.flatnonzero(record.missing).tolist() == [7, 8, 20]
    assert reading_notes(record) == (
        "y is missing in 3 of 60 samples (7 to 8, 20); these are neither fitted nor scored",
    )


def test_a_held_input_is_held_through_gaps_and_a_moving_one_is_refused(write_text):
    u = [f"{x:.1f}" for x in U]
    u[5] = u[19] = u[20] = ""
    record = load_record(write_text(table(u=u)))
    assert_read(record, u=np.where(np.arange(N) == 20, 0.0, U))
    assert record.notes == (
        "u held at its last value in 3 samples without one; after 1 of these gaps it differs, so that the change may "
        "have been earlier",
    )
    moving = [f"{x:.4f}" for x in Y]
    moving[5] = ""
    with pytest.raises(ValueError, match="u must be finite; got nan at sample 5"):
        load_record(write_text(table(u=moving)))


def iso(zone="", digits=3, mark="T"):
    start = datetime(2026, 3, 1, 23, 59, 58)
    stamps = [(start + timedelta(seconds=0.1 * k)).isoformat(mark, "milliseconds") for k in range(N)]
    return [stamp[: len(stamp) - 3 + digits] + zone for stamp in stamps]


@pytest.mark.parametrize("stamps", [iso(), iso(mark=" "), iso(digits=1), iso("Z"), iso("+01:00"), iso("-0330")])
def test_dates(write_text, stamps):
    record = load_record(write_text(table("timestamp,u,y", stamps)))
    assert_read(record)
    assert record.notes[0].startswith("times count from 2026-03-0")


def written(form):
    """Stamps every 0.1 s from 3 s before midnight on 2 March 2026."""
    start = datetime(2026, 3, 2, 23, 59, 57)
    return [(start + timedelta(seconds=0.1 * k)).strftime(form)[:-3] for k in range(N)]


@pytest.mark.parametrize(
    ("stamps", "says"),
    [
        (written("%d.%m.%Y %H:%M:%S,%f"), ""),
        (written("%d.%m.%y %H:%M:%S.%f"), ""),
        (written("%Y/%m/%d %H:%M:%S.%f"), ""),
        (written("%d-%b-%Y %H:%M:%S.%f"), ""),
        (written("%m/%d/%Y %H:%M:%S.%f"), "month before day"),
        (written("%d/%m/%Y %H:%M:%S.%f"), "day before month"),
        ([f"{one} {'PM' if k < 30 else 'AM'}" for k, one in enumerate(written("%m/%d/%Y %I:%M:%S.%f"))], "month"),
        (written("%d/%m/%Y %H:%M:%S:%f"), "day before month"),
    ],
)
def test_dates_that_are_not_iso(write_text, stamps, says):
    record = load_record(write_text(table("timestamp;u;y", stamps, delimiter=";")))
    assert_read(record)
    assert says in record.notes[0]
    assert record.notes[-1] == "times count from 2026-03-02 23:59:57, the first stamp"


def test_clocks_of_twelve_hours(write_text):
    stamps = [f"{one} {'PM' if k < 30 else 'a.m.'}" for k, one in enumerate(written("%I:%M:%S.%f"))]
    record = load_record(write_text(table("time,u,y", stamps)))
    assert_read(record, t=86397 + T)
    assert record.notes == ("times of day pass midnight once; a day added there",)
    for wrong in ("13:00:00 PM", "10:61:00", "32.01.2026", "13/13/2026", "01-Foo-2026 10:00:00", "2026-03-01 25:00:00"):
        with pytest.raises(ValueError, match=f"line 62, column 1: '{wrong}' is not a (time|date)"):
            load_record(write_text(table("time,u,y", stamps if ":" in wrong[:3] else iso()) + f"{wrong},1,1\n"))


def test_times_of_day_pass_midnight(write_text):
    stamps = [f"{(86395 + k // 10) // 3600 % 24:02d}:{(86395 + k // 10) // 60 % 60:02d}:" for k in range(N)]
    stamps = [f"{stamp}{(55 + k // 10) % 60:02d}.{k % 10}" for k, stamp in enumerate(stamps)]
    record = load_record(write_text(table("time,u,y", stamps)))
    assert record.Ts == pytest.approx(0.1, rel=1e-9)
    assert record.notes == ("times of day pass midnight once; a day added there",)
    prefixed = "".join(f"{stamp} -> {u},{y}\n" for stamp, u, y in zip(stamps, U, Y, strict=True))
    np.testing.assert_array_equal(load_record(write_text(prefixed), columns="1,2,3").u, U)


@pytest.mark.parametrize(
    ("name", "stamps", "options", "says"),
    [
        ("time_ms", [5000 + 100 * k for k in range(N)], {}, "time_ms read as milliseconds (by its name)"),
        ("millis", [5000 + 100 * k for k in range(N)], {}, "milliseconds (by its name)"),
        ("t [ms]", [100 * k for k in range(N)], {}, "t read as milliseconds (by its name)"),
        ("t/ms", [100.0 * k for k in range(N)], {"columns": "1,u,y"}, "t/ms read as milliseconds (by its name)"),
        ("timeMs", [100.0 * k for k in range(N)], {}, "timeMs read as milliseconds (by its name)"),
        ("Time (in msec.)", [100.0 * k for k in range(N)], {}, "Time read as milliseconds (by its name)"),
        ("us", [2**32 - 1_000_000 + 100_000 * k for k in range(N)], {}, ""),
        ("us", [(2**32 - 1_000_000 + 100_000 * k) % 2**32 for k in range(N)], {}, "us wraps once; unwrapped"),
        ("time", [5000 + 100 * k for k in range(N)], {"time_unit": "ms"}, "time read as milliseconds (as given)"),
        ("time", [1764000000000 + 100 * k for k in range(N)], {}, "2025-11-24 16:00:00 UTC"),
        ("time", [1764000000000000000 + 100000000 * k for k in range(N)], {}, "2025-11-24 16:00:00 UTC"),
        ("timestamp", [f"{1764000000 + k / 10:.3f}" for k in range(N)], {}, "2025-11-24 16:00:00 UTC"),
        ("datenum", [repr(739946.0 + k / 864000) for k in range(N)], {}, "2025-11-25, the first stamp"),
        ("t", [repr(739946.0 + k / 864000) for k in range(N)], {"time_unit": "days"}, "read as days (as given)"),
        ("t", [f"{k / 600:.12f}" for k in range(N)], {"time_unit": "min"}, "read as minutes (as given)"),
    ],
)
def test_units_of_time(write_text, name, stamps, options, says):
    record = load_record(write_text(table(f"{name},u,y", [str(x) for x in stamps])), **options)
    np.testing.assert_array_equal(record.u, U)
    assert record.Ts == pytest.approx(0.1, rel=1e-9)
    assert says.removesuffix("2025-11-25, the first stamp") in "; ".join(record.notes)


def test_epochs_keep_the_digits_of_the_sampling_time(write_text):
    stamps = [f"{1764000000 + k / 1000:.6f}" for k in range(N)]
    assert load_record(write_text(table("timestamp,u,y", stamps))).Ts == 0.001


@pytest.mark.parametrize(
    ("stamps", "says"),
    [
        ([str(100 * k) for k in range(N)], r"time counts in whole numbers, 100 apart, .*--time-unit ms"),
        ([str(100.0 * k) for k in range(N)], r"time counts in whole numbers, 100 apart, .*--time-unit ms"),
        ([repr(739946.0 + k / 864000) for k in range(N)], r"seconds or days \(MATLAB's datenum\).*--time-unit days"),
        ([repr(45413.4 + k / 86400) for k in range(N)], r"seconds or days \(of a spreadsheet\).*--time-unit days"),
    ],
)
def test_stamps_that_can_be_read_in_two_ways_name_the_option(write_text, stamps, says):
    with pytest.raises(ValueError, match=says):
        load_record(write_text(table("time,u,y", stamps)))


@pytest.mark.parametrize("step", [1, 10, 3600])
def test_the_times_of_the_format_t_u_y_are_seconds(write_text, step):
    assert load_record(write_text(table(t=[str(step * k) for k in range(N)]))).Ts == step


def rows(form):
    return "".join(form.format(t=f"{t:.1f}", u=u, y=y) + "\n" for t, u, y in zip(T, U, Y, strict=True))


@pytest.mark.parametrize(
    ("text", "units"),
    [
        (rows("t:{t},u:{u},y:{y}"), ("", "")),  # of a serial plotter
        (rows("t: {t}\tu: {u}\ty: {y}"), ("", "")),
        (rows("t={t} u={u} y={y}"), ("", "")),
        (rows("y:{y},t:{t},u:{u}").replace("y:0.0,t:0.0,u:0.0\n", "u:0.0,t:0.0,y:0.0\n"), ("", "")),
        ("t,u,y\n" + rows("{t} s,{u} V,{y}°C"), ("V", "°C")),
        ("t,u,y\n" + rows("{t},{u}%,{y}"), ("%", "")),
        ("| t | u | y |\n|---|---|---|\n" + rows("| {t} | {u} | {y} |"), ("", "")),
        ("t   u   y\n--- --- ---\n" + rows("{t} {u} {y}"), ("", "")),
        ("t,u,y,Start\nSequence,Volt,Volt,0.5\n" + rows("{t},{u},{y},"), ("Volt", "Volt")),  # of a scope
        ("Samples\t60\t60\nDelta_X\t0.1\t0.1\nX_Value\tu\ty\n" + rows("{t}\t{u}\t{y}"), ("", "")),  # of LabVIEW
        (
            ",".join(['"t"', '"u"', '"y"']) + "\n" + rows('"{t}";"{u}";"{y}"').replace(".", ",").replace(";", ","),
            ("", ""),
        ),
        ("t,u,y\n" + rows("{t},{u},{y}").replace("-", "−"), ("", "")),
        ("t,u,y\n" + rows("{t},{u},{y}") + "\0" * 512, ("", "")),
        ("time,u,y\n" + rows("00:0{t},{u},{y}"), ("", "")),
    ],
)
def test_how_devices_lay_out_their_rows(write_text, text, units):
    record = load_record(write_text(text))
    assert_read(record)
    assert record.units == units


@pytest.mark.parametrize(
    ("text", "note"),
    [
        (table() + "6.0,1", "the last line is no sample; left out"),
        (table() + "\nEnd of log\nAverage,1.2,3.4\n", "the last 2 lines are no samples; left out"),
        (table().replace("3.0,", "t,u,y\n3.0,"), "the header stands 1 more time between the rows"),
    ],
)
def test_lines_that_are_no_samples_are_left_out_and_said(write_text, text, note):
    record = load_record(write_text(text))
    assert_read(record)
    assert record.notes == (note,)
    counted = re.sub(r"^(\d)\.(\d)", r"\1\g<2>00", text.replace("t,u,y", "time,u,y"), flags=re.MULTILINE)
    with pytest.raises(ValueError, match="time counts in whole numbers, 100 apart"):  # which they do not hide
        load_record(write_text(counted))


def test_a_row_that_is_cut_within_the_table_or_names_another_unit_is_refused(write_text):
    with pytest.raises(ValueError, match="line 2 begins with 'x1' and holds numbers: it is neither"):
        load_record(write_text("t,u,y\nx1,1.0,2.0\n" + table("")), columns="1,2,3")
    with pytest.raises(ValueError, match="line 62 has 2 fields, but column 3 is needed"):
        load_record(write_text(table() + "6.0,1\n"))
    with pytest.raises(ValueError, match=r"line 5, column 2: '0.0 mV' is not a number"):
        load_record(write_text("t,u,y\n" + rows("{t},{u} V,{y}").replace("0.3,0.0 V", "0.3,0.0 mV")))
    with pytest.raises(ValueError, match=r"line 5, column 2: '45' is not a number"):  # bytes in hexadecimal digits
        load_record(write_text("t,u,y\n" + rows("{t},3A,{y}").replace("0.3,3A", "0.3,45")))


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("<html><table>", "a page of HTML or XML. Save the table in it as text"),
        (b"\x1f\x8b\x08\x00", "a packed archive. Unpack it"),
        ("# Created by Octave 8.4\n# name: t\n", "the text format of Octave. Save it again with save -v7"),
    ],
)
def test_what_is_no_table_is_told_by_its_name(tmp_path, content, says):
    path = tmp_path / "a.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(ValueError, match=says):
        load_record(path)


@pytest.mark.parametrize("part", ['"a",', "a [ "])
def test_a_line_that_is_too_long_is_refused_at_once(write_text, part):
    rows = table()
    for text, line in ((part * (10**6 // len(part)) + "\n" + rows, 1), (rows + part * (10**6 // len(part)), N + 2)):
        with pytest.raises(ValueError, match=f"line {line} has over 131071 characters: .*on a line of its own"):
            load_record(write_text(text))
    with pytest.raises(
        ValueError, match=r"fields|no data"
    ) as caught:  # a tenth of a second; what is quadratic takes minutes
        load_record(write_text((part * (130_000 // len(part)) + "\n") * 3))
    assert len(str(caught.value)) < 4000


def test_names_that_differ_in_case_only_are_told_apart(write_text):
    text = table("t,heater,T")
    assert_read(load_record(write_text(text), columns="t,heater,T"))
    with pytest.raises(ValueError, match="no columns t,u,y; the columns are t, heater, T"):
        load_record(write_text(text))


def test_a_time_in_two_columns_is_not_chosen_between(write_text):
    text = "time,timestamp,u,y\n" + "".join(f"{k / 10},{k / 5},{k % 2},{k}\n" for k in range(N))
    assert load_record(write_text(text)).Ts == 0.1  # time by its exact name
    text = text.replace("time,timestamp", "stamp,timestamp")
    with pytest.raises(ValueError, match="no columns t,u,y"):
        load_record(write_text(text))


def test_numbers_with_a_large_offset_keep_their_digits(write_text):
    record = load_record(write_text(table(u=[f"{1e8 + x:.1f}" for x in U], y=[f"{101325 + x:.4f}" for x in Y])))
    np.testing.assert_array_equal(record.u - 1e8, U)
    np.testing.assert_allclose(record.y - 101325, Y, atol=1e-10)


@pytest.mark.parametrize(
    ("field", "kind"),
    [
        ("1.5", "number"), ("-1,5", "number"), ("1.234,5", "number"), ("1D+3", "number"), ("2.0-101", "number"),
        ("inf", "number"), ("", "missing"), ("n/a", "missing"), ("ON", "switch"), ("2026-03-01", "date"),
        ("2026-03-01 09:00:00,5", "date"), ("9:00:00", "clock"), ("V", "text"), ("1_000", "text"), ("0x1F", "text"),
        ("5-", "text"), ("2.5 kPa", "number"), ("9:00:00 AM", "clock"), ("1'234.5", "number"), ("1/3/26 9:00", "date"),
    ],
)  # fmt: skip
def test_what_a_field_is(field, kind):
    assert kind_of(field) == kind


def test_names_and_units():
    assert split_unit("Level [cm]") == ("Level", "cm")
    assert split_unit("Time (s)") == ("Time", "s")
    assert split_unit("position[elbow]") == ("position[elbow]", "")
    assert split_unit("q[1]") == ("q[1]", "")
    assert [is_unit(text) for text in ("V", "[cm]", "(ms)", "speed", "u")] == [True, True, True, False, False]
    assert [is_time_name(name) for name in ("t", "time_ms", "Zeit", "T1", "temperature")] == [True] * 3 + [False] * 2
    assert [unit_in_time_name(name) for name in ("time_ms", "us", "t", "time")] == ["ms", "us", None, None]
    assert [unit_in_time_name(name) for name in ("ms_since_start", "elapsedMicros", "time_of_day")] == [
        "ms",
        "us",
        None,
    ]
    assert [is_time_name(name) for name in ("t/ms", "timeMs", "atoms", "items")] == [True, True, False, False]
    assert split_units(["V(in)", "V(out)", "I [A]"]) == (["V(in)", "V(out)", "I"], ["", "", "A"])


@pytest.mark.parametrize(
    ("header", "form", "odd", "says"),
    [
        ("t,u,y", "{t},{u},{y}", "0.5,1,234.5,2", "line 7 has 4 fields, but the table has 3 columns"),
        ("t,u,y", "{t},{u},{y}", "0.5,1,2,0.6,1,2", "line 7 has 6 fields, but the table has 3 columns"),
        ("t,u,y,z", "{t},{u},{y},7", "0.5,1,234.5,2,7", "line 7 has 5 fields, but the table has 4 columns"),
        ("t u y z", "{t} {u} {y} 7", "0.5   2.5 7", "line 7 has 3 fields, but the table has 4 columns"),
        ("t u y z", "{t} {u} {y} 7", "0.5 1 2 2.5 7", "line 7 has 5 fields, but the table has 4 columns"),
        ("t,u,y", "{t},{u},{y}", "0.5,1_0,2", "line 7, column 2: '1_0' is not a number"),
    ],
)
@pytest.mark.parametrize("comment", ["", "# by a logger\n"])
def test_a_row_whose_fields_may_stand_in_other_columns_is_refused(write_text, header, form, odd, says, comment):
    lines = rows(form).splitlines()
    lines[5] = odd
    says = says.replace("line 7", f"line {7 + bool(comment)}")
    with pytest.raises(ValueError, match=says):
        load_record(write_text(comment + "\n".join([header, *lines, ""])))


def test_a_name_that_two_columns_have_is_not_chosen_between(write_text):
    path = write_text(rows("{t},{u},0,{y}").join(["t,u,level,level\n", ""]))
    with pytest.raises(ValueError, match=r"2 columns are called 'level'. Give the number of one: 3, 4"):
        load_record(path, columns="t,u,level")
    assert_read(load_record(path, columns="t,u,4"))
    assert_read(load_record(write_text("time\tV(in)\tV(out)\n" + rows("{t}\t{u}\t{y}")), columns="time,V(in),V(out)"))


def test_names_of_several_words_between_blanks_name_no_columns(write_text):
    path = write_text("Time Pump Voltage Level\n" + rows("{t} {u} {y}"))
    with pytest.raises(ValueError, match="there is no column 'Time'; the columns are 1, 2, 3"):
        load_record(path, columns="Time,Pump,Voltage")
    record = load_record(path, columns="1,2,3")
    assert_read(record)
    assert record.notes == ("the header has 4 words for 3 columns: they are called by numbers",)


def test_samples_that_are_counted_are_no_times(write_text):
    text = "X,CH1,CH2,Start,Increment\nSequence,Volt,Volt,-6.0e-01,1.0e-01\n"
    text += "".join(f"{k},{u},{y},,\n" for k, (u, y) in enumerate(zip(U, Y, strict=True)))
    with pytest.raises(ValueError, match=r"X counts samples \(Sequence\), not time"):
        load_record(write_text(text), columns="X,CH1,CH2")
    np.testing.assert_array_equal(load_record(write_text(text), columns="CH1,CH2", Ts=0.1).u, U)


def test_durations_of_pandas(write_text):
    stamps = [f"{(86395 + t) // 86400:.0f} days {np.datetime64(0, 'ms') + round((86395 + t) * 1000)}" for t in T]
    stamps = [stamp.replace("1970-01-01T", "").replace("1970-01-02T", "") for stamp in stamps]
    assert_read(load_record(write_text(table(",u,y", stamps)), columns="1,u,y"), t=86395 + T)


def test_a_row_of_units_with_words_among_them(write_text):
    text = "Number,Date&Time,ms,CH1,CH2\nNO.,Time,ms,V,V\n"
    text += "".join(f"{k},2026/03/01 09:00:0{k // 10},{k % 10}00,{U[k]},{Y[k]}\n" for k in range(N))
    record = load_record(write_text(text), columns="Date&Time,CH1,CH2")
    np.testing.assert_array_equal(record.u, U)
    assert (record.Ts, record.units) == (0.1, ("V", "V"))


def test_labview_without_times(write_text):
    text = "LabVIEW Measurement\t\n***End_of_Header***\t\nChannels\t2\t\t\nSamples\t60\t60\t\nDelta_X\t0.1\t0.1\t\n"
    text += "X_Value\tu\ty\tComment\n" + rows("\t{u}\t{y}\t")
    assert_read(load_record(write_text(text), columns="u,y", Ts=0.1))


@pytest.mark.parametrize("since", [0, 1764000000])
@pytest.mark.parametrize("names", ["secs,nsecs", "stamp.sec,stamp.nanosec"])
def test_whole_seconds_have_their_nanoseconds_beside_them(write_text, names, since):
    stamps = [f"{since + k // 10},{k % 10 * 10**8 + 7}" for k in range(N)]
    record = load_record(write_text(table(f"{names},u,y", stamps)))
    assert record.Ts == pytest.approx(0.1, rel=1e-9)
    np.testing.assert_array_equal(record.u, U)
    assert f"times are {names.replace(',', ' and ')} together" in record.notes


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (table(u=[f"[{u}]" for u in U], y=[f"[{y}]" for y in Y]), r"but line 2 is no sample: '0\.0,\[0\.0\],\[0\.0\]'"),
        ("ans =\n\n   1.0e+03 *\n\n" + rows("   {t}   {u}   {y}"), "what MATLAB shows, with a factor"),
    ],
)
def test_tables_as_programs_print_them_are_refused(write_text, text, says):
    with pytest.raises(ValueError, match=says):
        load_record(write_text(text))


def test_the_table_of_columns_does_not_take_counted_samples_for_times(write_text):
    text = "X,CH1,CH2\nSequence,Volt,Volt\n" + "".join(f"{k},{U[k]},{Y[k]}\n" for k in range(N))
    found = summarize(open_text(write_text(text).read_bytes()))
    assert suggested_options(found) == ["--columns", "CH1,CH2", "--Ts", "SECONDS"]


@pytest.mark.parametrize("remark", [",pump on, by hand", ",,", ",# at 3 pm, 7"])
def test_a_remark_at_the_end_of_a_row_does_not_count(write_text, remark):
    lines = table().splitlines()
    lines[9] += remark
    assert_read(load_record(write_text("\n".join([*lines, ""]))))


@pytest.mark.parametrize("between", ["_", "-"])
def test_what_stands_between_date_and_time(write_text, between):
    assert load_record(write_text(table("time,u,y", [f"2026-03-01{between}09:00:0{t:.1f}" for t in T]))).Ts == 0.1
    with pytest.raises(ValueError, match="line 2, column 1: 'T#0ms' is not a number, date or time that is known here"):
        load_record(write_text(table("time,u,y", [f"T#{t * 1000:.0f}ms" for t in T])))
