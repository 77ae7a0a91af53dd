"""A course built once a session in a folder of its own, a launcher, and a way to grade code without a batch."""

from collections.abc import Iterator

import pytest
from course_work import GradeCode, built_course, shared_folder
from kept_processes import Kept

from autograder.course.layout import Course
from autograder.sandbox.isolation import Limits, ProcessLauncher, open_launcher

LIMITS = Limits(cell_seconds=20, call_seconds=10)


@pytest.fixture(scope="session")
def kept() -> Iterator[Kept]:
    """The processes that a grading run leaves to the next one."""
    processes = Kept()
    yield processes
    processes.end()


@pytest.fixture(scope="module", autouse=True)
def kept_processes(request: pytest.FixtureRequest, kept: Kept) -> Iterator[None]:
    """Runs take over the processes of earlier ones, but where starting and ending them is what is tested."""
    if request.path.parent.name == "sandbox":
        yield
    else:
        with kept.used():
            yield


@pytest.fixture(scope="session")
def course(tmp_path_factory: pytest.TempPathFactory) -> Course:
    """The repository's own course, built apart from it."""
    return built_course(tmp_path_factory.mktemp("course"), shared_folder(tmp_path_factory))


@pytest.fixture(scope="session")
def launcher() -> Iterator[ProcessLauncher]:
    """Starts students' processes, with short limits."""
    with open_launcher(limits=LIMITS) as opened:
        yield opened


@pytest.fixture(scope="session")
def grade_code(course: Course) -> Iterator[GradeCode]:
    """Grade the model solution with some cells replaced: ``grade_code(assignment, {cell id: source}, record=path)``.

    Without isolation: it changes no grade, and to set it up takes a fifth of the time.
    """
    with open_launcher("none", LIMITS) as opened:
        yield GradeCode(course, opened)
