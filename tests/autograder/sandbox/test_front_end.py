"""What only a front end has does the same in `labsid submit` and while grading."""

from collections.abc import Iterator

import pytest

from autograder.sandbox.isolation import ProcessLauncher, StudentProcess
from labsid.hand_in.kernel import NotebookKernel

CELLS = (
    "get_ipython().kernel.session.send(1)", "get_ipython().kernel._private", "get_ipython().get_parent()",
    "%cd .", "%store x", "%load nothing.py", "%notebook nothing.ipynb", "%pylab inline", "breakpoint()", "exit()",
    "quit()", "get_ipython().nothing", "async def one():\n    return 1\nimport asyncio\nasyncio.run(one())",
    "asyncio.get_event_loop().run_until_complete(one())", "task = asyncio.create_task(one())", "assert await task == 1",
    "assert asyncio.get_event_loop().is_running()", "assert type(get_ipython()).__name__ == 'ZMQInteractiveShell'",
    "from pathlib import Path\nassert _dh == [Path.cwd()]", "3 + 4", "assert _ == 7",
)  # fmt: skip


@pytest.fixture(scope="module")
def kernel(tmp_path_factory: pytest.TempPathFactory) -> Iterator[NotebookKernel]:
    with NotebookKernel(tmp_path_factory.mktemp("work"), as_graded=True) as opened:
        yield opened


@pytest.fixture(scope="module")
def student(launcher: ProcessLauncher, tmp_path_factory: pytest.TempPathFactory) -> Iterator[StudentProcess]:
    process = launcher.start(tmp_path_factory.mktemp("graded"))
    yield process
    process.close()


@pytest.mark.parametrize("cell", CELLS)
def test_submit_and_grading_agree(cell: str, kernel: NotebookKernel, student: StudentProcess) -> None:
    submitted, graded = kernel.run(cell, None, 20), student.run(cell)
    assert not submitted.lost
    assert (submitted.error or None) == (graded.error or {}).get("kind"), submitted.text
