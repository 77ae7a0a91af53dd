"""A physics simulator of lab rigs: it makes the lab's records, for everybody or for one student.

`bench` is what every rig stands on: a rig is a derivative, an actuator chain and a sensor chain, and `run`
plays an input on one. `tanks` is the coupled-tank rig of the lab; another rig is another module of its size.
`instruments` holds blocks for the chains, `log` the file in the lab's layout, `individual` what differs from
student to student, `lab_record` the records themselves.

The rigs with switchable effects are faster, run in units of their own, and stand beside that: `setup` says what one
is made of, `plants` and `inputs` draw them, `effects` (of the table) and `outside` (of it) enter one at any strength,
`play` runs it, and `truth` says what was put in. `withheld` makes every student's own rig with one of the `suspects`.
"""

from labsid.rig.lab.lab_record import make_empty_start_record, make_lab_record, make_verification_record
from labsid.rig.lab.log import LabLog, lab_record_bytes, log_to_record, write_lab_record
from labsid.rig.lab.plan import student_plan
from labsid.rig.seeds import read_secret

__all__ = [
    "LabLog",
    "lab_record_bytes",
    "log_to_record",
    "make_empty_start_record",
    "make_lab_record",
    "make_verification_record",
    "read_secret",
    "student_plan",
    "write_lab_record",
]
