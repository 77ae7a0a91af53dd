"""The lab: a second-order model identified from a record, in three parts."""

from labsid.checks.assignments.lab_identification import offset_step as step_1c
from labsid.checks.assignments.lab_identification import part_1, part_2, part_3
from labsid.checks.assignments.lab_identification.stages import STAGES
from labsid.checks.practice_records import signals_of, tank_record
from labsid.checks.question import Assignment, FollowsFrom, Question
from labsid.lab.offset import first_period_length

_EXTRACT, _TIME, _OFFSETS = "lab-1a-extract", "lab-1a-sampling-time", "lab-1c-offsets"
_PHI, _THETA, _PARAMETERS = "lab-2a-phi", "lab-2b-theta", "lab-2b-parameters"
_HALF, _ALL = "lab-3a-second-half", "lab-3a-all"

_DATA = (_EXTRACT, _TIME, _OFFSETS)
_MODEL = (*_DATA, _PARAMETERS)
_RUNS = (_EXTRACT, _OFFSETS, _HALF, _ALL)

ASSIGNMENT = Assignment(
    "lab-identification",
    (
        Question(_EXTRACT, part_1.check_extract, part_1.right_signals, instance=part_1.log_data),
        Question(
            _TIME, part_1.check_sampling_time, part_1.right_sampling_time, (_EXTRACT,), follows_from=FollowsFrom.TEXT
        ),
        Question("lab-1b-figure-5", part_1.check_figure_5, uses=(_EXTRACT,)),
        Question(
            "lab-1c-loop",
            part_1.check_first_period,
            part_1.right_first_period,
            (_EXTRACT,),
            reference=first_period_length,
        ),
        Question(_OFFSETS, step_1c.check_offsets, step_1c.right_offsets, (_EXTRACT,)),
        Question("lab-1c-figure-6", part_1.check_figure_6, uses=(_EXTRACT, _OFFSETS)),
        Question(_PHI, part_2.check_phi, part_2.right_phi, _DATA),
        Question(_THETA, part_2.check_theta, part_2.right_theta, (*_DATA, _PHI)),
        Question(_PARAMETERS, part_2.check_parameters, part_2.right_parameters, (_THETA,)),
        Question(
            "lab-2c-transfer-function",
            part_2.check_transfer_function,
            part_2.right_transfer_function,
            (_TIME, _PARAMETERS),
        ),
        Question("lab-2c-state-space", part_2.check_state_space, part_2.right_state_space, (_TIME, _PARAMETERS)),
        Question(_HALF, part_3.check_second_half, part_3.right_second_half, _MODEL),
        Question(_ALL, part_3.check_entire, part_3.right_entire, _MODEL),
        Question("lab-3a-mse", part_3.check_errors, part_3.right_errors, _RUNS),
        Question("lab-3a-figure-7", part_3.check_figure_7, uses=_RUNS),
        Question("lab-3b-initial-state", part_3.check_initial_state, uses=_MODEL),
    ),
    record_file="SysIdenData_StudentVersion.mat",
    stages=STAGES,
    practice_record=tank_record,
    practice_given=signals_of,
)
