"""Simulated lab rigs and the records they produce.

- `labsid.rig.lab`: the coupled tanks of the lab in physical units, and the lab's records, shared or individual.
- `labsid.rig.switchable`: tanks, motors, heaters and masses in normalised units, whose unmodelled effects can be
  switched on at any strength. The sealed check and the assignment ``sim-to-real-gap`` use them.
- `labsid.rig.ordinary`: the files that people bring, most of them without a gap: systems with a direct term, exact
  records, a simulation's own output, commands that do not act as logged, simulations with free numbers.
- `labsid.rig.seeds`: the random numbers of both, derived from a course's secret and a student's ID.
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
