"""The lab's steps on two inputs and two outputs, and least squares in a closed loop."""

from labsid.checks.assignments.several_signals.closed_loop import check_reference
from labsid.checks.assignments.several_signals.equations_by_output import check_phi, check_theta
from labsid.checks.assignments.several_signals.free_runs import check_run
from labsid.checks.assignments.several_signals.record_and_offsets import check_offsets, check_read, right_read
from labsid.checks.assignments.several_signals.stages import STAGES
from labsid.checks.question import Assignment, FollowsFrom, Question

_PHI = "sev-3-phi"

ASSIGNMENT = Assignment(
    "several-signals",
    (
        Question("sev-1-read", check_read, right_read, follows_from=FollowsFrom.TEXT),
        Question("sev-2-offsets", check_offsets),
        Question(_PHI, check_phi),
        Question("sev-4-theta", check_theta, uses=(_PHI,)),
        Question("sev-5-run", check_run),
        Question("sev-6-reference", check_reference),
    ),
    stages=STAGES,
)
