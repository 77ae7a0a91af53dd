"""The pre-lab: time vector, two noisy sinusoids, the cut, the matrix and Fig. 1."""

from labsid.checks.assignments.prelab_sinusoids.stages import STAGES
from labsid.checks.assignments.prelab_sinusoids.waveforms import (
    check_cut,
    check_cut_off_data,
    check_function,
    check_matrix,
    check_noise,
    check_original,
    check_time,
    right_cut,
    right_sinusoids,
    right_time,
)
from labsid.checks.question import Assignment, FollowsFrom, Question, nothing_new

ASSIGNMENT = Assignment(
    "prelab-sinusoids",
    (
        Question("prelab-1-time", check_time, gives=right_time, follows_from=FollowsFrom.TEXT, instance=nothing_new),
        Question(
            "prelab-2-noise", check_noise, gives=right_sinusoids, uses=("prelab-1-time",), follows_from=FollowsFrom.TEXT
        ),
        Question(
            "prelab-3-cut",
            check_cut,
            gives=right_cut,
            uses=("prelab-1-time", "prelab-2-noise"),
            follows_from=FollowsFrom.TEXT,
        ),
        Question("prelab-4-matrix", check_matrix, uses=("prelab-3-cut",), follows_from=FollowsFrom.TEXT),
        Question("prelab-4-function", check_function),
        Question(
            "prelab-5-original", check_original, uses=("prelab-1-time", "prelab-2-noise"), follows_from=FollowsFrom.TEXT
        ),
        Question("prelab-6-cut-off", check_cut_off_data, uses=("prelab-3-cut",), follows_from=FollowsFrom.TEXT),
    ),
    stages=STAGES,
)
