"""Places of the constants of a joint in the arrays of the compiled loop, and what a constraint of MuJoCo is made of."""

FREE = 1e30  # of a limit that is none
MIN_IMPEDANCE, MAX_IMPEDANCE = 1e-4, 0.9999
(
    INERTIA,
    DAMPING,
    DRAG,
    STIFFNESS,
    SPRINGREF,
    CUBIC,
    SIN,
    COS,
    CONSTANT,
    FRICTION,
    TRANSMITTED,
    PEAK,
    STRIBECK,
    FRICTION_B,
    FRICTION_IMPEDANCE,
    LOW,
    HIGH,
    MARGIN,
    LIMIT_B,
    LIMIT_K,
    D0,
    D1,
    WIDTH,
    MID,
    POWER,
    GEAR,
    GAIN0,
    GAIN1,
    GAIN2,
    BIAS0,
    BIAS1,
    BIAS2,
    DYNAMICS,
    TIME_CONSTANT,
    CTRL_LOW,
    CTRL_HIGH,
    FORCE_LOW,
    FORCE_HIGH,
    ACT_LOW,
    ACT_HIGH,
    JOINT_LOW,
    JOINT_HIGH,
    LOAD,
    ONSET,
    WAVE_COS,
    WAVE_SIN,
    OMEGA,
    IMPLICIT,
) = range(48)
COUNT = 48


def stiffness_of(solref: tuple[float, ...], solimp: tuple[float, ...], timestep: float) -> tuple[float, float]:
    """Damping b and stiffness k of a constraint's reference acceleration."""
    most = min(max(solimp[1], MIN_IMPEDANCE), MAX_IMPEDANCE)
    if solref[0] <= 0.0:
        return -solref[1] / most, -solref[0] / most**2
    time_constant = max(solref[0], 2.0 * timestep)
    return 2.0 / (most * time_constant), 1.0 / (most * time_constant * solref[1]) ** 2
