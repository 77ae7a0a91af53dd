"""The built notebooks run top to bottom in a real kernel, every check passes, and figures are drawn."""

from pathlib import Path

import pytest
from course_work import execute_solution
from representatives import mostly_exhaustive

from autograder.course.layout import Course
from labsid.checks.notebook import assignment_names, load_assignment


@pytest.mark.parametrize("name", mostly_exhaustive(assignment_names(), ["prelab-sinusoids"]))
def test_the_solution_runs_top_to_bottom(name: str, course: Course, tmp_path: Path) -> None:
    """Without a kernel, `test_variants.py` runs those of every assignment."""
    notebook = execute_solution(course, name, tmp_path)
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    found = [output.metadata.labsid for output in outputs if "labsid" in output.get("metadata", {})]
    states = {one.question: one.state for one in found if one}
    noted = {"gap-8-effect", "gap-8-path", "gap-8-parameters"}  # only grading can tell
    ids = [question.id for question in load_assignment(name).questions]
    assert states == {one: "noted" if one in noted else "right" for one in ids}
    assert any("image/png" in output.get("data", {}) for output in outputs)
