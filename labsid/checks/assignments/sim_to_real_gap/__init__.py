"""The sim-to-real gap: where it lies, which effect makes it, how far it shrinks. The judge alone knows the effect."""

from labsid.checks.assignments.sim_to_real_gap.error_shares import frequency, operating, time
from labsid.checks.assignments.sim_to_real_gap.linear_model import linear, right_linear, right_size, size
from labsid.checks.assignments.sim_to_real_gap.named_effect import effect, parameters, path
from labsid.checks.assignments.sim_to_real_gap.offsets_and_noise import rest, right_rest
from labsid.checks.assignments.sim_to_real_gap.simulation_with_effect import closed, simulation
from labsid.checks.question import Assignment, Question
from labsid.rig.switchable.withheld_effects import RECORD_FILE

_REST, _LINEAR, _SIZE = "gap-1-rest", "gap-2-linear", "gap-3-size"

ASSIGNMENT = Assignment(
    "sim-to-real-gap",
    (
        Question(_REST, rest, right_rest),
        Question(_LINEAR, linear, right_linear, (_REST,)),
        Question(_SIZE, size, right_size, (_LINEAR,)),
        Question("gap-3-time", time, uses=(_LINEAR,)),
        Question("gap-4-frequency", frequency),
        Question("gap-5-operating", operating, uses=(_LINEAR,)),
        Question("gap-7-simulation", simulation, uses=(_REST, _LINEAR)),
        Question("gap-8-effect", effect),
        Question("gap-8-path", path),
        Question("gap-8-parameters", parameters),
        Question("gap-9-closed", closed, uses=(_REST, _SIZE)),
    ),
    RECORD_FILE,
)
