"""Description of a rig of several signals: plant, actuators, load and sensors with their effects, off by default."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from labsid._arrays import FloatArray
from labsid.rig.switchable.setup import Actuator, Load, Sensor


@dataclass(frozen=True, slots=True, eq=False)
class Plant:
    """Equations of motion ``dx/dt = A x + flow g(x) + cubic x^3 + B v + load - friction``, ``y = C x``.

    Time is in samples, states and signals are deviations from the operating point.

    Attributes
    ----------
    A : ndarray, shape (n, n)
    flow : ndarray, shape (n, n)
        Share of the outflow of each tank that fills or empties another one. The outflow g(x) of a tank is its level,
        or the root of it.
    B : ndarray, shape (n, nu)
    C : ndarray, shape (ny, n)
    curvature : ndarray, shape (n,)
        Of the outflow of each tank; zero where it is linear.
    brim : ndarray, shape (n,)
        Level at which a tank overflows.
    cubic : ndarray, shape (n, n)
        Effect of the third power of each state on the others.
    friction : ndarray, shape (n,)
        Dry friction against each speed, as an acceleration.
    stop_low, stop_high : ndarray, shape (n,)
        End stops of each position.
    speed_of : ndarray of int, shape (n,)
        Index of the speed of a position, -1 for other states.
    """

    A: FloatArray
    flow: FloatArray
    B: FloatArray
    C: FloatArray
    curvature: FloatArray
    brim: FloatArray
    cubic: FloatArray
    friction: FloatArray
    stop_low: FloatArray
    stop_high: FloatArray
    speed_of: NDArray[np.int64]

    @property
    def inputs(self) -> int:
        """Number of inputs."""
        return int(self.B.shape[1])

    @property
    def outputs(self) -> int:
        """Number of outputs."""
        return int(self.C.shape[0])


@dataclass(frozen=True, slots=True, eq=False)
class CoupledSetup:
    """Description of one rig with its effects.

    Attributes
    ----------
    rig : str
        Name of the rig.
    inputs, outputs : tuple of str
        Names of the signals.
    plant : Plant
    actuators : tuple of Actuator
        One for each input.
    load : Load
        Additive; `leak` and `pole_change` are not used.
    load_gain : ndarray, shape (n,)
        Effect of the load on each state.
    sensors : tuple of Sensor
        One for each output.
    plays : tuple of float
        Width of the backlash between the plant and each sensor.
    """

    rig: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    plant: Plant
    actuators: tuple[Actuator, ...]
    load: Load
    load_gain: FloatArray
    sensors: tuple[Sensor, ...]
    plays: tuple[float, ...] = field(default=(0.0, 0.0))


def linear_plant(
    A: FloatArray,
    B: FloatArray,
    C: FloatArray,
    flow: FloatArray | None = None,
    speed_of: NDArray[np.int64] | None = None,
) -> Plant:
    """Plant without effects.

    Parameters
    ----------
    A : ndarray, shape (n, n)
    B : ndarray, shape (n, nu)
    C : ndarray, shape (ny, n)
    flow : ndarray, shape (n, n), optional
        By default zero: no tanks.
    speed_of : ndarray of int, shape (n,), optional
        By default -1: no positions.

    Returns
    -------
    Plant
    """
    n = A.shape[0]
    far = np.full(n, np.inf)
    return Plant(
        A=A,
        flow=np.zeros((n, n)) if flow is None else flow,
        B=B,
        C=C,
        curvature=np.zeros(n),
        brim=far,
        cubic=np.zeros((n, n)),
        friction=np.zeros(n),
        stop_low=-far,
        stop_high=far,
        speed_of=np.full(n, -1) if speed_of is None else speed_of,
    )


def plain_setup(rig: str, inputs: tuple[str, ...], outputs: tuple[str, ...], plant: Plant) -> CoupledSetup:
    """Rig without effects.

    Parameters
    ----------
    rig : str
    inputs, outputs : tuple of str
    plant : Plant

    Returns
    -------
    CoupledSetup
    """
    return CoupledSetup(
        rig=rig,
        inputs=inputs,
        outputs=outputs,
        plant=plant,
        actuators=(Actuator(),) * len(inputs),
        load=Load(),
        load_gain=np.zeros(plant.A.shape[0]),
        sensors=(Sensor(),) * len(outputs),
        plays=(0.0,) * len(outputs),
    )


def linearised(plant: Plant) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Linear state space at the operating point, in continuous time with a sample as the unit.

    Parameters
    ----------
    plant : Plant

    Returns
    -------
    tuple of ndarray
        A, B and C.
    """
    return plant.A + plant.flow, plant.B, plant.C


def within_limits(plant: Plant, x: FloatArray) -> FloatArray:
    """The states, limited to those between the end stops, below the brims and above the bottoms of the tanks.

    Parameters
    ----------
    plant : Plant
    x : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (n,)
    """
    bottom = np.full(x.size, -np.inf)
    bent = plant.curvature > 0.0
    bottom[bent] = -1.0 / plant.curvature[bent]
    return np.clip(x, np.maximum(plant.stop_low, bottom), np.minimum(plant.stop_high, plant.brim))


def with_states(setup: CoupledSetup, count: int) -> CoupledSetup:
    """Append states that nothing acts on.

    Parameters
    ----------
    setup : CoupledSetup
    count : int

    Returns
    -------
    CoupledSetup
    """
    p = setup.plant
    square, row = ((0, count), (0, count)), (0, count)
    plant = Plant(
        A=np.pad(p.A, square),
        flow=np.pad(p.flow, square),
        B=np.pad(p.B, ((0, count), (0, 0))),
        C=np.pad(p.C, ((0, 0), (0, count))),
        curvature=np.pad(p.curvature, row),
        brim=np.pad(p.brim, row, constant_values=np.inf),
        cubic=np.pad(p.cubic, square),
        friction=np.pad(p.friction, row),
        stop_low=np.pad(p.stop_low, row, constant_values=-np.inf),
        stop_high=np.pad(p.stop_high, row, constant_values=np.inf),
        speed_of=np.pad(p.speed_of, row, constant_values=-1),
    )
    return replace(setup, plant=plant, load_gain=np.pad(setup.load_gain, row))
