"""The sim-to-real gap: where it lies, which effect causes it, how much of it is closed; only grading has the effect."""

from labsid.checks.assignments.sim_to_real_gap.error_shares import check_frequency, check_operating, check_time
from labsid.checks.assignments.sim_to_real_gap.linear_model import check_linear, check_size, right_linear, right_size
from labsid.checks.assignments.sim_to_real_gap.named_effect import check_effect, check_parameters, check_path
from labsid.checks.assignments.sim_to_real_gap.offsets_and_noise import check_rest, right_rest
from labsid.checks.assignments.sim_to_real_gap.simulation_with_effect import (
    check_closed,
    check_one_run,
    check_simulation,
)
from labsid.checks.assignments.sim_to_real_gap.stages import STAGES
from labsid.checks.practice_records import gap_facts, gap_origin, gap_record, signals_of
from labsid.checks.question import Assignment, FollowsFrom, Question
from labsid.rig.switchable.withheld_effects import RECORD_FILE

_REST, _LINEAR, _SIZE = "gap-1-rest", "gap-2-linear", "gap-3-size"

ASSIGNMENT = Assignment(
    "sim-to-real-gap",
    (
        Question(_REST, check_rest, right_rest),
        Question(_LINEAR, check_linear, right_linear, (_REST,)),
        Question(_SIZE, check_size, right_size, (_LINEAR,)),
        Question("gap-3-time", check_time, uses=(_LINEAR,)),
        Question("gap-4-frequency", check_frequency),
        Question("gap-5-operating", check_operating, uses=(_LINEAR,)),
        Question(
            "gap-7-simulation",
            check_simulation,
            uses=(_REST, _LINEAR),
            judge_first=check_one_run,
            follows_from=FollowsFrom.OWN_RIG,
        ),
        Question("gap-8-effect", check_effect, follows_from=FollowsFrom.EYE),
        Question("gap-8-path", check_path, follows_from=FollowsFrom.EYE),
        Question("gap-8-parameters", check_parameters, follows_from=FollowsFrom.EYE),
        Question(
            "gap-9-closed",
            check_closed,
            uses=(_REST, _SIZE),
            follows_from=FollowsFrom.OWN_RIG,
        ),
    ),
    RECORD_FILE,
    STAGES,
    gap_record,
    signals_of,
    gap_origin,
    gap_facts,
)
