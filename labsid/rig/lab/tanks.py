"""The coupled tanks: a pump fills the upper tank, which drains into the lower one, whose level is measured."""

from dataclasses import dataclass, fields
from math import inf, sqrt

from labsid._arrays import FloatArray
from labsid.rig.lab.integration import Rig, State

GRAVITY = 981.0
"""Gravitational acceleration (cm/s^2)."""


@dataclass(frozen=True, slots=True)
class TankParameters:
    """Two tanks, their pump and their level sensor, in centimetres, seconds and volts.

    Parameters
    ----------
    upper_area, lower_area : float
        Cross-section of each tank (cm^2).
    upper_orifice, lower_orifice : float
        Effective area of each drain: its area times its discharge coefficient (cm^2).
    upper_height, lower_height : float
        Height of each tank's brim above its drain (cm).
    pump_gain : float
        Pump flow per volt (cm^3/s/V).
    sensor_gain : float
        Sensor voltage per centimetre of lower level (V/cm).
    sensor_zero : float
        Sensor voltage of an empty tank (V); negative if the sensor is trimmed to 0 V above the bottom.

    Raises
    ------
    ValueError
        If a length, an area or a gain is not positive.
    """

    upper_area: float = 4.0
    lower_area: float = 40.0
    upper_orifice: float = 0.5
    lower_orifice: float = 0.277
    upper_height: float = 20.0
    lower_height: float = 40.0
    pump_gain: float = 27.1
    sensor_gain: float = 0.16
    sensor_zero: float = -0.8

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            lowest, kind = (-inf, "finite") if field.name == "sensor_zero" else (0.0, "positive finite")
            if not lowest < value < inf:
                raise ValueError(f"{field.name} must be a {kind} number; got {value}.")


def zero_level(parameters: TankParameters) -> float:
    """Level of the lower tank at which the sensor reads 0 V (cm)."""
    return max(0.0, -parameters.sensor_zero / parameters.sensor_gain)


def pump_flow(parameters: TankParameters, v: float) -> float:
    """Pump flow (cm^3/s) at the voltage `v`; zero for a negative voltage."""
    return parameters.pump_gain * max(v, 0.0)


def steady_levels(parameters: TankParameters, v: float) -> State:
    """Steady-state levels for a constant pump voltage.

    Parameters
    ----------
    parameters : TankParameters
    v : float
        Pump voltage (V).

    Returns
    -------
    tuple of float
        Upper and lower level (cm), at which both drains pass the pump's flow q, ``q = a sqrt(2 g h)``.
    """
    flow = pump_flow(parameters, v)
    upper = (flow / parameters.upper_orifice) ** 2 / (2 * GRAVITY)
    lower = (flow / parameters.lower_orifice) ** 2 / (2 * GRAVITY)
    return upper, lower


def tank_rig(parameters: TankParameters) -> Rig:
    """Build the rig with an ideal actuator and an ideal sensor; add chains with `dataclasses.replace`.

    Parameters
    ----------
    parameters : TankParameters

    Returns
    -------
    Rig
        States: upper and lower level (cm); drive: pump voltage; output: sensor voltage of the lower level.

    Notes
    -----
    Torricelli: each tank drains with ``a sqrt(2 g h)``, so with the pump's flow ``q``

        A1 dh1/dt = q(v) - a1 sqrt(2 g h1)
        A2 dh2/dt = a1 sqrt(2 g h1) - a2 sqrt(2 g h2)
    """
    p = parameters
    upper_drain = p.upper_orifice * sqrt(2 * GRAVITY)
    lower_drain = p.lower_orifice * sqrt(2 * GRAVITY)

    def derivative(t: float, x: State, v: float) -> State:
        # An intermediate state of the integrator may be negative.
        between = upper_drain * sqrt(max(x[0], 0.0))
        out = lower_drain * sqrt(max(x[1], 0.0))
        return (pump_flow(p, v) - between) / p.upper_area, (between - out) / p.lower_area

    def output(states: FloatArray) -> FloatArray:
        return p.sensor_zero + p.sensor_gain * states[:, 1]

    return Rig(
        derivative=derivative,
        output=output,
        state_names=("the upper level (cm)", "the lower level (cm)"),
        lowest=(0.0, 0.0),
        highest=(p.upper_height, p.lower_height),
    )
