"""`read_variables` against scipy's reader and writer, real files, and damage of every kind."""

import io
import struct
import zlib

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.io import loadmat, savemat

from labsid.records.mat5 import read_variables

NAMES = st.from_regex("[a-zA-Z][a-zA-Z0-9_]{0,20}", fullmatch=True)
MATRICES = hnp.arrays(
    st.sampled_from(["f8", "f4", "i1", "u1", "i2", "u2", "i4", "u4", "c16"]),
    hnp.array_shapes(min_dims=2, max_dims=3, min_side=0, max_side=4),
)


def cell(values):
    array = np.empty((1, len(values)), dtype=object)
    for k, value in enumerate(values):
        array[0, k] = value
    return array


VALUES = st.recursive(
    MATRICES,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3).map(cell), st.dictionaries(NAMES, inner, min_size=1, max_size=3)
    ),
    max_leaves=6,
)


def written(variables, **options):
    buffer = io.BytesIO()
    savemat(buffer, variables, **options)
    return buffer.getvalue()


def assert_same(ours, theirs):
    """Our plain values against what loadmat makes of the same file."""
    if theirs.dtype.names:
        assert [list(one) for one in ours] == [list(theirs.dtype.names)] * theirs.size
        for one, other in zip(ours, theirs.ravel(order="F"), strict=True):
            for name in theirs.dtype.names:
                assert_same(one[name], other[name])
    elif theirs.dtype == object:
        for one, other in zip(ours, theirs.ravel(order="F"), strict=True):
            assert_same(one, other)
    elif theirs.dtype.kind == "c":
        assert ours == "complex numbers"
    else:
        np.testing.assert_array_equal(ours, theirs)
        assert ours.shape == theirs.shape


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.dictionaries(NAMES, VALUES, min_size=1, max_size=3), st.booleans())
def test_whatever_scipy_writes_is_read_as_scipy_reads_it(variables, compress):
    content = written(variables, do_compression=compress)
    ours = read_variables(content)
    theirs = loadmat(io.BytesIO(content))
    assert set(ours) == set(variables)
    for name in variables:
        assert_same(ours[name], theirs[name])


def test_a_structure_array_and_other_things():
    array = np.empty((2, 2), dtype=[("a", object), ("b", object)])
    for k in range(4):
        array[k % 2, k // 2] = (float(k), "text")
    ours = read_variables(written({"s": array, "word": "pump", "none": np.empty((0, 0)), "flag": np.array([[True]])}))
    assert [one["a"].item() for one in ours["s"]] == [0, 1, 2, 3]
    assert ours["s"][0]["b"] == ours["word"] == "text"
    assert ours["none"].shape == (0, 0)
    assert ours["flag"].tolist() == [[1.0]]


def test_a_file_from_a_machine_with_the_other_byte_order():
    def element(kind, payload):
        return struct.pack(">II", kind, len(payload)) + payload + bytes(-len(payload) % 8)

    flags, shape = struct.pack(">II", 6, 0), struct.pack(">ii", 2, 1)
    small_name = struct.pack(">HH", 1, 1) + b"u\0\0\0"
    body = element(6, flags) + element(5, shape) + small_name + element(3, struct.pack(">hh", 7, -2))
    content = b"MATLAB 5.0 MAT-file".ljust(124) + b"\x01\x00MI" + element(14, body)
    assert read_variables(content)["u"].tolist() == [[7.0], [-2.0]]
    np.testing.assert_array_equal(loadmat(io.BytesIO(content))["u"], [[7], [-2]])


SMALL = {"LogData": {"time": np.arange(3.0), "signals": cell([{"values": np.eye(3)}, {"values": np.ones(3)}])}, "c": 1j}


@pytest.mark.parametrize("compress", [False, True])
def test_any_damaged_byte_is_an_error_or_another_value_but_never_a_crash(compress):
    content = written(SMALL, do_compression=compress)
    rng = np.random.default_rng(0)
    errors = 0
    for place in range(116, len(content)):
        for value in {0, 1, 2, 3, 4, 5, 6, 14, 15, 127, 255, *rng.integers(0, 256, 3).tolist()}:
            damaged = content[:place] + bytes([value]) + content[place + 1 :]
            try:
                read_variables(damaged)
            except ValueError:
                errors += 1
    assert errors > len(content)


@pytest.mark.parametrize("compress", [False, True])
def test_any_cut_is_an_error_but_between_variables(compress):
    content = written(SMALL, do_compression=compress)
    whole = []
    for size in range(len(content)):
        try:
            whole.append(len(read_variables(content[:size])))
        except ValueError:
            continue
    assert set(whole) <= {0, 1, 2}
    assert len(whole) <= 2 + 8


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "its header is not that of version 5 or 7"),
        (b"t,u,y\n" * 100, "its header is not that of version 5 or 7"),
        (b" " * 124 + b"\x00\x01IM" + bytes(4), "it ends too early"),
        (b" " * 124 + b"\x00\x01IM" + struct.pack("<II", 14, 999), "it ends too early"),
        (b" " * 124 + b"\x00\x01IM" + struct.pack("<II", 9, 0), "something else where a variable should be"),
        (b" " * 124 + b"\x00\x01IM" + struct.pack("<II", 15, 4) + b"abcd", "a compressed part does not unpack"),
        (b" " * 124 + b"\x00\x01IM" + struct.pack("<HHI", 14, 9, 0), "a part has an impossible size"),
    ],
)
def test_what_is_no_mat_file(content, message):
    with pytest.raises(ValueError, match=message):
        read_variables(content)


def test_a_compressed_part_that_would_fill_the_memory(monkeypatch):
    packed = zlib.compress(struct.pack("<II", 14, 10**6) + bytes(10**6))
    monkeypatch.setattr("labsid.records.mat5._MAX_BYTES", 10**5)
    with pytest.raises(ValueError, match="incomplete, or all parts are over"):
        read_variables(b" " * 124 + b"\x00\x01IM" + struct.pack("<II", 15, len(packed)) + packed)


def test_cells_in_cells_in_cells():
    value = np.ones((1, 1))
    for _ in range(30):
        value = cell([value])
    ours = read_variables(written({"deep": value}))["deep"]
    for _ in range(30):
        (ours,) = ours
    assert ours.item() == 1.0
    matrix = b""
    head = struct.pack("<IIII", 6, 8, 1, 0) + struct.pack("<IIii", 5, 8, 1, 1) + struct.pack("<II", 1, 0)
    for _ in range(3000):
        matrix = (
            struct.pack("<II", 14, len(head) + len(matrix)) + head + matrix if matrix else struct.pack("<II", 14, 0)
        )
    with pytest.raises(ValueError, match="it is nested too deeply"):
        read_variables(b" " * 124 + b"\x00\x01IM" + matrix)


def test_what_matlab_wrote(shared_data):
    """Compressed, numbers in their shortest types, a title and a block name beside the values."""
    for path in sorted((shared_data / "unsw-water-tank").glob("*.mat")):
        ours = read_variables(path.read_bytes())
        ((name, (log,)),) = ours.items()
        theirs = loadmat(path, struct_as_record=False, squeeze_me=True)[name]
        np.testing.assert_array_equal(log["time"][:, 0], theirs.time)
        np.testing.assert_array_equal(log["signals"][0]["values"], theirs.signals[0].values)
        np.testing.assert_array_equal(log["signals"][1]["values"][:, 0], theirs.signals[1].values)
        assert log["blockName"] == "text"
