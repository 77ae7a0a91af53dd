"""The names of `labsid.gap` for editors and type checkers; `labsid/gap/__init__.py` imports lazily."""

from labsid.gap.diagnosis import diagnose as diagnose
from labsid.gap.reports.result import Diagnosis as Diagnosis
