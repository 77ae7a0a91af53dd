"""Block diagrams in python-control: offset compensation (Fig. 3) and the optional Simulink run."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from labsid._arrays import FloatArray, as_signal, freeze
from labsid.lab.arx import ArxModel, canonical_form, to_ss

if TYPE_CHECKING:
    import control

# python-control imports matplotlib, so it is imported inside functions only.

Process = Callable[[float], float]


@dataclass(frozen=True, slots=True, eq=False)
class PIController:
    """A discrete-time PI controller, ``u(k) = Kp e(k) + I(k)`` with ``I(k+1) = I(k) + Ki Ts e(k)``.

    Attributes
    ----------
    Kp : float
        Proportional gain.
    Ki : float
        Integral gain, per second.
    Ts : float
        Sampling time in seconds.
    """

    Kp: float
    Ki: float
    Ts: float


@dataclass(frozen=True, slots=True, eq=False)
class LoopRun:
    """The signals of Fig. 3.

    Attributes
    ----------
    t : ndarray, shape (N,)
        Time in seconds.
    reference : ndarray, shape (N,)
        Offset-free set point.
    y_m : ndarray, shape (N,)
        Measured output, offset included.
    y : ndarray, shape (N,)
        Offset-free output that the controller sees, ``y_m - y_offset``.
    u : ndarray, shape (N,)
        Control input that the controller computes.
    u_in : ndarray, shape (N,)
        Actual process input, ``u + u_offset``.
    """

    t: FloatArray
    reference: FloatArray
    y_m: FloatArray
    y: FloatArray
    u: FloatArray
    u_in: FloatArray

    def __post_init__(self) -> None:
        freeze(self, t=self.t, reference=self.reference, y_m=self.y_m, y=self.y, u=self.u, u_in=self.u_in)


def pi_by_cancellation(model: ArxModel, closed_loop_tau: float) -> PIController:
    """Design a PI controller whose zero cancels the slowest pole of the model.

    Parameters
    ----------
    model : ArxModel
        Its slowest pole must be real and between 0 and 1, and its gain nonzero.
    closed_loop_tau : float
        Desired time constant of the closed loop in seconds.

    Returns
    -------
    PIController

    Raises
    ------
    ValueError
        If the model does not meet these conditions or the time constant is not positive.

    Notes
    -----
    With the pole's time constant tau and the gain G(1), ``Kp = tau / (G(1) closed_loop_tau)`` and
    ``Ki = Kp / tau``. The lab does not specify the controller of Fig. 3.
    """
    if not (np.isfinite(closed_loop_tau) and closed_loop_tau > 0):
        raise ValueError(f"closed_loop_tau must be a positive number of seconds; got {closed_loop_tau}.")
    pole, gain = model.poles[0], model.static_gain
    if pole.imag != 0 or not 0 < pole.real < 1 or gain == 0:
        raise ValueError(
            f"model must have a real slowest pole between 0 and 1 and a gain; got pole {pole:.4g} and gain "
            f"{gain:.4g}. Choose the controller's gains by hand."
        )
    tau = -model.Ts / np.log(pole.real)
    Kp = float(tau / (gain * closed_loop_tau))
    return PIController(Kp, float(Kp / tau), model.Ts)


def offset_compensated_diagram(model: ArxModel, controller: PIController) -> "control.InputOutputSystem":
    """Build Fig. 3 in python-control: controller, offsets, and the model as process.

    Parameters
    ----------
    model : ArxModel
    controller : PIController

    Returns
    -------
    control.InputOutputSystem
        Inputs ``reference, u_offset, y_offset, process_u0, process_y0``; outputs ``y_m, y, u, u_in``.

    Raises
    ------
    ValueError
        If the sampling times differ.

    Notes
    -----
    UNSW lab, Fig. 3. ``process_u0`` and ``process_y0`` are the operating point of the process; ``u_offset`` and
    ``y_offset`` compensate it.
    """
    import control

    if controller.Ts != model.Ts:
        raise ValueError(
            f"controller and model must have one sampling time; got {controller.Ts:g} s and {model.Ts:g} s."
        )
    pi = control.ss(
        [[1.0]], [[controller.Ki * controller.Ts]], [[1.0]], [[controller.Kp]], controller.Ts,
        inputs="e", outputs="u", name="controller",
    )  # fmt: skip
    blocks = [
        control.summing_junction(["reference", "-y"], "e", name="comparison"),
        pi,
        control.summing_junction(["u", "u_offset"], "u_in", name="add_u_offset"),
        *_process_blocks(model),
        control.summing_junction(["y_m", "-y_offset"], "y", name="remove_y_offset"),
    ]
    return control.interconnect(
        blocks,
        inputs=["reference", "u_offset", "y_offset", "process_u0", "process_y0"],
        outputs=["y_m", "y", "u", "u_in"],
        name="offset_compensation",
    )


def offset_compensated_loop(model: ArxModel, controller: PIController, reference: ArrayLike) -> LoopRun:
    """Simulate Fig. 3 with the identified model as process, from its operating point.

    Parameters
    ----------
    model : ArxModel
    controller : PIController
    reference : array_like, shape (N,)
        Offset-free set point.

    Returns
    -------
    LoopRun

    Raises
    ------
    ValueError
        If the sampling times differ or there are fewer than 2 samples.

    Notes
    -----
    UNSW lab, "DC Offset Compensation" and Fig. 3.
    """
    reference = as_signal("reference", reference, at_least=2)
    diagram = offset_compensated_diagram(model, controller)
    constants = [model.u_offset, model.y_offset, model.u_offset, model.y_offset]
    t, outputs = _run(diagram, reference, constants, model.Ts)
    y_m, y, u, u_in = outputs
    return LoopRun(t, reference, y_m, y, u, u_in)


def run_on_process(
    process: Process,
    y_m_first: float,
    controller: PIController,
    reference: ArrayLike,
    u_offset: float,
    y_offset: float,
) -> LoopRun:
    """Run Fig. 3 sample by sample on a process: the rig or a simulator of it.

    Parameters
    ----------
    process : callable
        ``process(u_in)`` holds the input for one sampling interval and returns the output at its end.
    y_m_first : float
        Output measured before the first interval.
    controller : PIController
    reference : array_like, shape (N,)
        Offset-free set point.
    u_offset, y_offset : float
        Offsets of the identified model.

    Returns
    -------
    LoopRun

    Notes
    -----
    UNSW lab, "DC Offset Compensation" and Fig. 3.
    """
    reference = as_signal("reference", reference)
    N = reference.size
    y_m, u = np.empty(N), np.empty(N)
    y_m[0] = y_m_first
    integral = 0.0
    for k in range(N):
        error = reference[k] - (y_m[k] - y_offset)
        u[k] = controller.Kp * error + integral
        integral += controller.Ki * controller.Ts * error
        if k + 1 < N:
            y_m[k + 1] = process(u[k] + u_offset)
    return LoopRun(controller.Ts * np.arange(N, dtype=np.float64), reference, y_m, y_m - y_offset, u, u + u_offset)


def model_as_process(model: ArxModel) -> Process:
    """Return a process that behaves like the identified model, initially at rest at its operating point.

    Parameters
    ----------
    model : ArxModel

    Returns
    -------
    callable
        For `run_on_process`; it keeps its state between calls.
    """
    G, H, C, _ = canonical_form(model)
    x = np.zeros((model.order, 1))

    def process(u_in: float) -> float:
        nonlocal x
        x = G @ x + H * (u_in - model.u_offset)
        return float((C @ x).item()) + model.y_offset

    return process


def simulation_diagram(model: ArxModel) -> "control.InputOutputSystem":
    """Build the simulation of the model as in Simulink: source, sum, G(z), sum, scope.

    Parameters
    ----------
    model : ArxModel

    Returns
    -------
    control.InputOutputSystem
        Inputs ``u_in, process_u0, process_y0`` (the recorded input and the two offsets), output ``y_m``.

    Notes
    -----
    UNSW lab, the optional Simulink run of exercise 3a.
    """
    import control

    return control.interconnect(
        _process_blocks(model),
        inputs=["u_in", "process_u0", "process_y0"],
        outputs=["y_m"],
        name="simulation",
    )


def simulate_diagram(model: ArxModel, u_act: ArrayLike) -> FloatArray:
    """Simulate the block diagram for a recorded input, offset included.

    Parameters
    ----------
    model : ArxModel
    u_act : array_like, shape (N,)
        Input as recorded.

    Returns
    -------
    y_act : ndarray, shape (N,)
        Simulated output with its offset: ``simulate(model, u_act - u_offset) + y_offset``.

    Raises
    ------
    ValueError
        If there are fewer than 2 samples.

    Notes
    -----
    UNSW lab, the optional Simulink run of exercise 3a.
    """
    u_act = as_signal("u_act", u_act, at_least=2)
    _, outputs = _run(simulation_diagram(model), u_act, [model.u_offset, model.y_offset], model.Ts)
    y_act: FloatArray = outputs[0]
    return y_act


def _process_blocks(model: ArxModel) -> list["control.InputOutputSystem"]:
    """The process about its operating point: input u_in, output y_m."""
    import control

    dynamics = control.ss(to_ss(model), inputs="process_u", outputs="process_y", name="G")
    return [
        control.summing_junction(["u_in", "-process_u0"], "process_u", name="about_u0"),
        dynamics,
        control.summing_junction(["process_y", "process_y0"], "y_m", name="about_y0"),
    ]


def _run(
    diagram: "control.InputOutputSystem", signal: FloatArray, constants: list[float], Ts: float
) -> tuple[FloatArray, FloatArray]:
    import control

    t = Ts * np.arange(signal.size, dtype=np.float64)
    inputs = np.vstack([signal, *(np.full(signal.size, value) for value in constants)])
    response = control.input_output_response(diagram, t, inputs, squeeze=False)
    return t, response.outputs.reshape(diagram.noutputs, -1)
