"""Exported simulations of several signals: one fitted hypothesis for each output, as JSON and as a callable."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from labsid._arrays import FloatArray, as_matrix
from labsid.gap.dynamics.plants import Plant
from labsid.gap.effects.base import Effect
from labsid.gap.effects.families import EFFECTS_BY_KEY
from labsid.gap.fits.fitting import Fit
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.model_file import (
    SETTLING_SAMPLES,
    ExportedModel,
    from_json_dict,
    further_from_json,
    further_to_json,
    opened_given,
    with_sources,
)
from labsid.gap.record.data import Scale
from labsid.gap.system_pairs import in_order, pair_simulation
from labsid.records.record import bridge_gaps
from labsid.simulators.process import open_in_process

SYSTEM_SCHEMA = "labsid.system/1"


@dataclass(frozen=True, slots=True, eq=False)
class Actuator:
    """Effects at one input that act on an output which is explained through another input.

    Attributes
    ----------
    input : str
    effects : tuple of Effect
    theta : ndarray
        Delay, parameters of the effects, and those of linear dynamics, which are not used.
    """

    input: str
    effects: tuple[Effect, ...]
    theta: FloatArray

    @classmethod
    def of(cls, name: str, fit: Fit) -> "Actuator":
        """The actuator of a fit, without its dynamics."""
        whole = fit.hypothesis
        alone = Hypothesis(whole.inputs)
        theta = np.zeros(len(alone.parameters))
        for effect in whole.inputs:
            theta[alone.slices[effect.key]] = fit.theta[whole.slices[effect.key]]
        if not whole.delay_is_an_effect:
            theta[0] = fit.theta[0]
        return cls(name, whole.inputs, theta)

    def applied(self, signals: Mapping[str, FloatArray]) -> FloatArray:
        """The scaled input after these effects, shape (N,)."""
        return Hypothesis(self.effects).with_signals(signals).actuator(self.theta, signals[self.input])


@dataclass(frozen=True, slots=True, eq=False)
class ExportedOutput:
    """The simulation of one output.

    Attributes
    ----------
    model : ExportedModel
        Of the output and its main input.
    main : str
    actuators : tuple of Actuator
        At other inputs, in the order in which they act.
    """

    model: ExportedModel
    main: str
    actuators: tuple[Actuator, ...] = ()

    def beside(self, scaled: Mapping[str, FloatArray]) -> ExportedModel:
        """The model with the other inputs of a record, given as scaled signals by name."""
        signals = dict(scaled)
        for one in self.actuators:
            signals[one.input] = one.applied(signals)
        return _with_signals(self.model, signals)


@dataclass(frozen=True, slots=True, eq=False)
class ExportedSystem:
    """A simulation of several signals: written by `--export`, run by `labsid gap simulate`.

    Attributes
    ----------
    inputs : tuple of str
    scales : tuple of Scale
        Of the inputs.
    outputs : dict of ExportedOutput
        By name.
    simulated : tuple of str
        All outputs of a given simulation, in its order.
    """

    inputs: tuple[str, ...]
    scales: tuple[Scale, ...]
    outputs: dict[str, ExportedOutput]
    simulated: tuple[str, ...] = ()

    @property
    def sampling_time(self) -> float:
        """In seconds."""
        return next(iter(self.outputs.values())).model.Ts

    def simulate(self, u: FloatArray, y: FloatArray | None = None) -> FloatArray:
        """Free-run outputs for inputs in the record's units.

        Parameters
        ----------
        u : ndarray, shape (N, nu)
        y : ndarray, shape (N, ny), optional
            Its first samples determine the initial states; without it the simulation starts from rest at the first
            inputs, without loads, sinusoids and drifts.

        Returns
        -------
        ndarray, shape (N, ny)
        """
        u = as_matrix("u", u)
        if u.shape[1] != len(self.inputs):
            raise ValueError(
                f"u must have a column for each of {', '.join(self.inputs)}; got shape {u.shape}. Reorder its columns."
            )
        if y is None:
            return self._from_rest(u)
        y = bridge_gaps(np.asarray(y, np.float64))
        if y.shape != (len(u), len(self.outputs)):
            raise ValueError(
                f"y must have the shape ({len(u)}, {len(self.outputs)}), a column for each of "
                f"{', '.join(self.outputs)}; got {y.shape}."
            )
        scaled = self._scaled(u)
        return np.column_stack(
            [
                output.beside(scaled).simulate(np.ascontiguousarray(u[:, self.inputs.index(output.main)]), own)
                for output, own in zip(self.outputs.values(), y.T, strict=True)
            ]
        )

    def _from_rest(self, u: FloatArray) -> FloatArray:
        ahead = SETTLING_SAMPLES
        whole = np.concatenate([np.repeat(u[:1], ahead, axis=0), u])
        scaled = self._scaled(whole)
        found = [
            one.beside(scaled).settled(np.ascontiguousarray(whole[:, self.inputs.index(one.main)]))[ahead:]
            for one in self.outputs.values()
        ]
        return np.column_stack(found)

    def _scaled(self, u: FloatArray) -> dict[str, FloatArray]:
        columns = zip(self.inputs, self.scales, u.T, strict=True)
        return {name: np.asarray(scale.of(column), np.float64) for name, scale, column in columns}

    def to_json_dict(self) -> dict[str, Any]:
        """Return the JSON object that `--export` writes.

        Raises
        ------
        ValueError
            If it contains a given simulation that is no file.
        """
        return {
            "schema": SYSTEM_SCHEMA,
            "Ts": self.sampling_time,
            "inputs": [
                {"name": name, "centre": scale.centre, "unit": scale.unit}
                for name, scale in zip(self.inputs, self.scales, strict=True)
            ],
            "simulated": list(self.simulated),
            "outputs": [
                {
                    "name": name,
                    "main": output.main,
                    "actuators": [
                        {
                            "input": at.input,
                            "effects": [effect.key for effect in at.effects],
                            "further": further_to_json(at.effects),
                            "theta": at.theta.tolist(),
                        }
                        for at in output.actuators
                    ],
                    "model": output.model.to_json_dict(),
                }
                for name, output in self.outputs.items()
            ],
        }


def system_from_json(content: Mapping[str, Any]) -> ExportedSystem:
    """Read a JSON object written by `ExportedSystem.to_json_dict`.

    Raises
    ------
    ValueError
        If it is not an exported simulation of several signals.
    """
    wrong = "not an exported simulation of several signals: {}. Export it again."
    try:
        inputs = tuple(str(entry["name"]) for entry in content["inputs"])
        scales = tuple(Scale(float(entry["centre"]), float(entry["unit"])) for entry in content["inputs"])
        names = [str(entry["name"]) for entry in content["outputs"]]
        simulated = tuple(str(name) for name in content["simulated"])
        given = _given_reader(inputs, scales, names, simulated)
        outputs = {}
        for j, entry in enumerate(content["outputs"]):
            model = from_json_dict(entry["model"], lambda *about, j=j, main=str(entry["main"]): given(*about, main, j))
            outputs[names[j]] = ExportedOutput(model, str(entry["main"]), tuple(map(_actuator, entry["actuators"])))
    except KeyError as error:
        raise ValueError(wrong.format(f"{error} is missing")) from None
    except (TypeError, AttributeError):
        raise ValueError(wrong.format("a value has the wrong type")) from None
    if not outputs or not inputs or any(output.main not in inputs for output in outputs.values()):
        raise ValueError(wrong.format("it needs inputs and outputs, and each output a main input"))
    return ExportedSystem(inputs, scales, outputs, simulated)


def system_in_folder(content: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """An exported simulation of several signals whose files are named relative to `folder`."""
    return system_with_sources(content, lambda source: str(folder / source))


def system_with_sources(content: Mapping[str, Any], change: Callable[[str], str]) -> dict[str, Any]:
    """An exported simulation of several signals, the source of each given simulation in it changed."""
    outputs = [one | {"model": with_sources(one["model"], change)} for one in content["outputs"]]
    return {**content, "outputs": outputs}


def exported_with_sources(content: dict[str, Any], change: Callable[[str], str]) -> dict[str, Any]:
    """An exported simulation of one or several signals, the source of each given simulation in it changed."""
    return (system_with_sources if content.get("schema") == SYSTEM_SCHEMA else with_sources)(content, change)


def exported_from_json(content: dict[str, Any]) -> ExportedModel | ExportedSystem:
    """Read an exported simulation of one or several signals; see `from_json_dict` and `system_from_json`."""
    return (system_from_json if content.get("schema") == SYSTEM_SCHEMA else from_json_dict)(content)


def _actuator(content: Mapping[str, Any]) -> Actuator:
    table = EFFECTS_BY_KEY | further_from_json(content["further"])
    effects = tuple(table[str(key)] for key in content["effects"])
    theta = np.array(content["theta"], np.float64)
    if theta.shape != (len(Hypothesis(effects).parameters),):
        raise ValueError("not an exported simulation of several signals: theta of an actuator has another length.")
    return Actuator(str(content["input"]), effects, theta)


def _given_reader(
    inputs: tuple[str, ...], scales: Sequence[Scale], names: Sequence[str], simulated: Sequence[str]
) -> Callable[..., Plant]:
    """What opens the given simulation of an output; all outputs share one process."""
    opened: dict[str, Any] = {}

    def read(content: Any, ends: tuple[Scale, Scale], Ts: float, main: str, j: int) -> Plant:
        def open_once(source: str) -> Any:
            if source not in opened:
                opened[source] = in_order(open_in_process(source), inputs, simulated, names)
            return opened[source]

        simulate, rates, units, ranges = opened_given(content, open_once)
        at_rest = np.zeros((1, len(inputs)))
        simulation = pair_simulation(simulate, at_rest, (inputs.index(main), j), inputs, scales, ends[1], Ts, rates)
        return Plant(kind="given", simulation=replace(simulation, units=units, ranges=ranges))

    return read


def _with_signals(model: ExportedModel, signals: Mapping[str, FloatArray]) -> ExportedModel:
    elsewhere = None if model.elsewhere is None else _with_signals(model.elsewhere, signals)
    return replace(model, hypothesis=model.hypothesis.with_signals(signals), elsewhere=elsewhere)
