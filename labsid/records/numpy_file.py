"""Arrays of numpy: ``.npz`` and ``.npy``. Pickled objects are refused, not loaded."""

import io
import zipfile
from tokenize import TokenError

import numpy as np

from labsid.records.column import Column, Log, is_numeric, log_of, matrix_columns

NUMPY_MAGIC = (b"\x93NUMPY",)
MAX_BYTES = 2**29  # of all arrays of a file, unpacked


def open_numpy(content: bytes) -> Log:
    """Read the arrays of an ``.npz``, by name, or the columns of an ``.npy``.

    Raises
    ------
    ValueError
        If it is damaged, holds objects, or unpacks to more than 512 MB.
    """
    if content.startswith(b"PK"):
        return _open_archive(content)
    array = _load(io.BytesIO(content), len(content))
    if array.dtype.names:
        return log_of([Column(name, array[name]) for name in array.dtype.names if is_numeric(array[name])])
    columns = matrix_columns("", _checked("the array", array))
    if len(columns) < 2:
        raise ValueError(f"it must hold a matrix with one signal a column; got shape {array.shape}.")
    return log_of(columns, has_names=False)


def _open_archive(content: bytes) -> Log:
    columns: list[Column] = []
    left_out, total = [], 0
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            for entry in archive.infolist():
                total += entry.file_size
                if total > MAX_BYTES:
                    raise ValueError(f"its arrays are over {MAX_BYTES // 2**20} MB. Save fewer or shorter ones.")
                name = entry.filename.removesuffix(".npy")
                with archive.open(entry) as part:
                    data = part.read(entry.file_size + 1)
                array = _load(io.BytesIO(data), len(data))
                if not is_numeric(array):
                    left_out.append(name)
                elif array.size > 1:
                    columns += matrix_columns(name, array)
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError, OSError, zipfile.zlib.error) as error:  # type: ignore[attr-defined]
        raise ValueError(f"it is no .npz, or it is cut off or damaged ({error}). Copy or download it again.") from None
    notes = [f"arrays without numbers left out: {', '.join(left_out)}"] if left_out else []
    return log_of(columns, "array", notes)


def _load(file: io.BytesIO, size: int) -> np.ndarray:
    try:
        version = np.lib.format.read_magic(file)
        read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, fortran, dtype = read(file)
    except (ValueError, KeyError, TypeError, SyntaxError, TokenError, EOFError, MemoryError, RecursionError):
        raise ValueError("its header is not that of a .npy, or it is damaged. Save it again with numpy.save.") from None
    if dtype.hasobject:
        raise ValueError("it holds Python objects (a pickle), which are not loaded. Save plain arrays of numbers.")
    count = 1
    for length in shape:
        count *= int(length)
    if min(shape, default=0) < 0 or count * dtype.itemsize > size - file.tell():
        raise ValueError("it ends too early: there are fewer numbers than its header says. Copy it again.")
    array = np.frombuffer(file.getbuffer(), dtype, count, file.tell()) if count else np.empty(0, dtype)
    return array.reshape(shape, order="F" if fortran else "C")


def _checked(name: str, array: np.ndarray) -> np.ndarray:
    if not is_numeric(array):
        raise ValueError(f"{name} must hold real numbers; got {array.dtype}.")
    return array
