"""A record as text, and read again."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labsid.records.record import Record, load_record
from labsid.records.record_file import names_note, record_text


@given(st.integers(1, 3), st.integers(1, 3), st.booleans(), st.data())
def test_what_is_written_is_read_again(tmp_path_factory, nu, ny, has_reference, data):
    finite = st.floats(-1e9, 1e9)
    columns = np.array([data.draw(st.lists(finite, min_size=6, max_size=6)) for _ in range(nu + ny)])
    columns[nu:][data.draw(st.integers(0, ny - 1)), 2:4] = np.nan
    record = Record(
        0.5 * np.arange(6),
        columns[:nu].T,
        columns[nu:].T,
        0.5,
        reference=np.arange(6.0) if has_reference and nu + ny > 2 else None,
        inputs=tuple(f"Q{j}" for j in range(nu)),
        outputs=tuple(f"T{i}" for i in range(ny)),
        units=("%",) * nu + ("K",) * ny,
    )
    path = tmp_path_factory.mktemp("records") / "record.csv"
    path.write_text(record_text(record, "log"))
    (note,) = names_note(record)
    words = note.removeprefix("read it with ").split()
    options = dict(zip((word.strip("-") for word in words[::2]), words[1::2], strict=True))
    again = load_record(path, **options)
    for name in ("t", "u", "y", "reference"):
        np.testing.assert_array_equal(getattr(again, name), getattr(record, name))
    assert (again.units, again.signal_names, again.Ts) == (record.units, record.signal_names, record.Ts)


@pytest.mark.parametrize(("nu", "ny"), [(1, 1), (2, 3)])
def test_names_by_default_need_no_option(write_text, nu, ny):
    rng = np.random.default_rng(1)
    record = Record(np.arange(9.0), rng.random((9, nu)), rng.random((9, ny)), 1.0)
    text = record_text(record, "log")
    assert names_note(record) == ()
    again = load_record(write_text(text))
    np.testing.assert_array_equal(again.u, record.u)
    assert (again.signal_names, text.count("#")) == (record.signal_names, 1)
