"""The signals of a record: columns of u and y, and their names."""

from collections.abc import Sequence
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike


class _Named(Protocol):
    """A record, as far as its names go."""

    @property
    def name(self) -> str: ...
    @property
    def inputs(self) -> tuple[str, ...]: ...
    @property
    def outputs(self) -> tuple[str, ...]: ...


AnyNamed = TypeVar("AnyNamed", bound=_Named)


def signal_columns(values: ArrayLike) -> tuple[ArrayLike, ...]:
    """Split values of shape (N, n) into n columns; one signal, in any of its shapes, is one column as it is.

    Parameters
    ----------
    values : array_like
    """
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        return (values,)  # refused by name, with the other faults of one signal
    return tuple(array.T) if array.ndim == 2 and min(array.shape) > 1 else (values,)


def joined(columns: Sequence[ArrayLike]) -> ArrayLike:
    """One column as shape (N,), several as shape (N, n): the inverse of `signal_columns`."""
    return columns[0] if len(columns) == 1 else np.column_stack(columns)


def names_of(symbol: str, given: Sequence[str], count: int) -> tuple[str, ...]:
    """Names of the columns of u or y: as given, or ``u`` for one and ``u1, u2, ...`` for several.

    Parameters
    ----------
    symbol : {"u", "y"}
    given : sequence of str
        Empty for the default names.
    count : int
        Number of columns.

    Raises
    ------
    ValueError
        If there is not one name for each column.
    """
    if not given:
        return (symbol,) if count == 1 else tuple(f"{symbol}{k + 1}" for k in range(count))
    if isinstance(given, str) or len(given) != count:
        got = repr(given) if isinstance(given, str) else f"{len(given)}: {', '.join(map(str, given))}"
        field = {"u": "inputs", "y": "outputs"}[symbol]
        raise ValueError(
            f"{field} must hold one name for each of the {count} column{'s' * (count > 1)} of {symbol}; got {got}. "
            "Give a tuple of as many names as columns."
        )
    return tuple(map(str, given))


def check_names(inputs: Sequence[str], outputs: Sequence[str]) -> None:
    """Refuse names that do not tell the signals apart.

    Parameters
    ----------
    inputs, outputs : sequence of str

    Raises
    ------
    ValueError
        If a name is empty, occurs twice, or is that of an input and of an output.
    """
    for field, names in (("inputs", inputs), ("outputs", outputs)):
        if not all(name.strip() for name in names):
            raise ValueError(f"{field} must name every column; got {', '.join(map(repr, names))}. Name the empty one.")
        twice = [name for k, name in enumerate(names) if name in names[:k]]
        if twice:
            raise ValueError(f"{field} must name different columns; got {twice[0]!r} twice. Leave one of them out.")
    both = [name for name in inputs if name in outputs]
    if both:
        raise ValueError(f"{both[0]!r} is named as an input and as an output. Leave it out of one of them.")


def place_of(signal: int | str, names: Sequence[str], kind: str) -> int:
    """Place of a signal that is given by its name or by its place, from 0.

    Parameters
    ----------
    signal : int or str
    names : sequence of str
    kind : {"input", "output"}

    Raises
    ------
    ValueError
        If there is no such signal.
    """
    if signal in names:
        return names.index(str(signal))
    if not isinstance(signal, str) and 0 <= signal < len(names):
        return int(signal)
    raise ValueError(
        f"there is no {kind} {signal!r}; the {kind}s are {', '.join(names)}. Name one, or give its place, from 0."
    )


def one_signal_each(record: AnyNamed, what: str) -> AnyNamed:
    """Refuse a record of several inputs or outputs, for what is defined for one of each.

    Parameters
    ----------
    record : Record
    what : str
        What needs one input and one output.

    Raises
    ------
    ValueError
        If the record holds several inputs or outputs.
    """
    if len(record.inputs) + len(record.outputs) > 2:
        u, y = record.inputs[0], record.outputs[0]
        raise ValueError(
            f"{what} takes one input and one output; {record.name or 'the record'} has the inputs "
            f"{', '.join(record.inputs)} and the outputs {', '.join(record.outputs)}. Choose one of each, such as "
            f"--columns t,{u},{y}, in Python record.pair({u!r}, {y!r})."
        )
    return record
