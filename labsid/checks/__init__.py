"""Checks of a student's answers: what they compare, what they say, and the slips that they know by name.

The same question is asked in two places. In the notebook, `notebook_checks` reads the student's own variables and
answers at once, on public inputs. At grading, the judge of `autograder` asks the student's process for plain values and
calls, on inputs that it keeps to itself. Both walk through the same `Question`.
"""

from labsid.checks.notebook import CheckFailed, notebook_checks
from labsid.checks.question import Ask, Assignment, Question
from labsid.checks.verdict import NoAnswer, Slip, Verdict

__all__ = ["Ask", "Assignment", "CheckFailed", "NoAnswer", "Question", "Slip", "Verdict", "notebook_checks"]
