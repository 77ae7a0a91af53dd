"""Checks of students' answers: comparisons, messages and known mistakes.

Each question is checked in two places. In the notebook, `notebook_checks` reads the student's variables and answers at
once, on public inputs. At grading, the judge of `autograder` asks the student's process for plain values and function
results, on secret inputs. Both use the same `Question`.
"""

from labsid.checks.notebook import CheckFailed, notebook_checks
from labsid.checks.question import Ask, Assignment, Question
from labsid.checks.verdict import NoAnswer, Slip, Verdict

__all__ = ["Ask", "Assignment", "CheckFailed", "NoAnswer", "Question", "Slip", "Verdict", "notebook_checks"]
