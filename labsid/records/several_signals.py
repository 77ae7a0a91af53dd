"""The signals of a record: columns of u and y, and their names."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray


class SeveralSignals:
    """The signals of a record by columns, whether there is one input and one output or more.

    A base of frozen data classes with the fields `name`, `u`, `y`, `units`, `inputs` and `outputs`.
    """

    __slots__ = ()
    name: str
    u: FloatArray
    y: FloatArray
    units: tuple[str, ...]
    labels: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]

    @property
    def several(self) -> bool:
        """Whether there is more than one input or more than one output."""
        return len(self.inputs) + len(self.outputs) > 2

    @property
    def signal_names(self) -> tuple[str, ...]:
        """Names of the inputs, then of the outputs; the order of `units`."""
        return (*self.inputs, *self.outputs)

    @property
    def input_columns(self) -> FloatArray:
        """The inputs, shape (N, nu), also for one."""
        return self.u.reshape(-1, len(self.inputs))

    @property
    def output_columns(self) -> FloatArray:
        """The outputs, shape (N, ny), also for one."""
        return self.y.reshape(-1, len(self.outputs))

    def pair(self, input: int | str, output: int | str) -> Self:
        """The record of one input and one output, without the other signals.

        Parameters
        ----------
        input, output : int or str
            Name of the signal, or its place, from 0.

        Returns
        -------
        Record or RawRecord
            Called ``NAME: input -> output``, with the units of both.

        Raises
        ------
        ValueError
            If there is no such signal.
        """
        j, i = place_of(input, self.inputs, "input"), place_of(output, self.outputs, "output")
        name, of_output = f"{self.inputs[j]} -> {self.outputs[i]}", len(self.inputs) + i
        return replace(  # type: ignore[type-var]
            self,
            u=self.input_columns[:, j],
            y=self.output_columns[:, i],
            name=f"{self.name}: {name}" if self.name else name,
            units=(self.units[j], self.units[of_output]),
            labels=(self.labels[j], self.labels[of_output]),
            inputs=(self.inputs[j],),
            outputs=(self.outputs[i],),
        )


AnySignals = TypeVar("AnySignals", bound=SeveralSignals)


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


def units_of(given: Sequence[str], names: Sequence[str], what: str = "unit") -> tuple[str, ...]:
    """A unit for each signal; all empty if none is given.

    Parameters
    ----------
    given : sequence of str
    names : sequence of str
        Names of the inputs, then of the outputs.
    what : {"unit", "label"}
        What is given, for the error message.

    Raises
    ------
    ValueError
        If there is not one unit for each signal.
    """
    if not any(given):
        return ("",) * len(names)
    if len(given) != len(names):
        raise ValueError(
            f"{what}s must hold one {what} for each of the {len(names)} signals {', '.join(names)}; got {len(given)}: "
            f"{', '.join(map(repr, given))}. Give '' for an unknown one."
        )
    return tuple(given)


def labels_of(given: Sequence[str], names: Sequence[str]) -> tuple[str, ...]:
    """A label for each signal: as given, or its name.

    Parameters
    ----------
    given : sequence of str
        Names of the columns of a file; empty where it names none.
    names : sequence of str
        Names of the inputs, then of the outputs.

    Raises
    ------
    ValueError
        If labels are given, but not one for each signal.
    """
    return tuple(label or name for label, name in zip(units_of(given, names, "label"), names, strict=True))


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


def one_signal_each(record: AnySignals, what: str) -> AnySignals:
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
    if record.several:
        u, y = record.inputs[0], record.outputs[0]
        raise ValueError(
            f"{what} takes one input and one output; {record.name or 'the record'} has the inputs "
            f"{', '.join(record.inputs)} and the outputs {', '.join(record.outputs)}. Choose one of each, such as "
            f"--columns t,{u},{y}, in Python record.pair({u!r}, {y!r})."
        )
    return record
