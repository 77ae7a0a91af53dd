"""What every test may ask for: the shipped stand-in record and, where they are, the real records."""

import gc
import os
import signal
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import autograder  # noqa: F401  before nbformat, whose import it makes a second shorter

ROOT = Path(__file__).resolve().parent.parent

gc.disable()  # until all tests are collected: their modules and all that they import are kept anyway

# Tests run side by side: one thread each, before numpy loads. More only wait for each other.
for _threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"):
    os.environ.setdefault(_threads, "1")

# `make check` leaves out the tests in these files, and those that ask for these fixtures.
SLOW_FILES = {
    "attacks": "*",
    "autograder": "test_*.py",
    "autograder/batch": "*",
    "autograder/course": "test_build.py",
    "autograder/export": "*",
    "autograder/judge": "test_[ej]*.py test_own_tests.py",
    "autograder/sandbox": "*",
    "browser": "*",
    "hub": "*",
    "labsid/blind": "*",
    "labsid/cli": "test_commands.py",
    "labsid/checks": "test_*_checks.py test_s*.py test_lab_identification.py",
    "labsid/estimation": "test_likelihood.py test_monte_carlo.py test_recursive.py",
    "labsid/gap": "test_diagnosis.py test_gap_cli.py test_invariance.py test_real_rigs.py",
    "labsid/gap/batches": "test_b*.py test_scheduler_batch.py",
    "labsid/gap/dynamics": "test_given_simulation.py test_reaction_forces.py test_states.py test_varying.py",
    "labsid/gap/effects": "test_new_families.py",
    "labsid/gap/fits": "test_residual_tests.py test_undriven_poles.py",
    "labsid/gap/record": "test_c*.py test_record_findings.py",
    "labsid/gap/reports": "test_html*.py test_location.py test_re[ps]*.py",
    "labsid/gap/search": "test_[bcfrl]*.py test_explanation.py",
    "labsid/gap/simulations": "test_[bfls]*.py",
    "labsid/gap/verdict": "test_[bs]*.py",
    "labsid/nonlinear": "test_ranges.py",
    "labsid/rig/lab": "*",
    "labsid/rig/switchable": "*",
}
SLOW_FIXTURES = {"banded", "course", "plain"}

# A run in the background starts with interrupts ignored, and hands that down to the commands that tests interrupt.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers(config: pytest.Config) -> int | None:
    """One more than there are cores, but for `make check`: many slow tests wait for the processes that they start."""
    if "PYTEST_XDIST_AUTO_NUM_WORKERS" in os.environ or config.getoption("markexpr") == "not slow":
        return None
    return 1 + (len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Each module on one worker, and those in the browser on the same, so that what they share is made once.

    Whatever `--dist` says; they begin in the order in which they are collected.
    """
    from xdist.scheduler import LoadScopeScheduling

    class ByModule(LoadScopeScheduling):
        def _split_scope(self, nodeid: str) -> str:
            module = nodeid.split("::", 1)[0]
            return "tests/browser" if module.startswith("tests/browser/") else module

    config.option.loadscopereorder = False
    return ByModule(config, log)


@cache
def in_slow_file(path: Path) -> bool:
    folder = path.parent.relative_to(ROOT / "tests").as_posix()
    return any(path.match(pattern) for pattern in SLOW_FILES.get(folder, "").split())


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Do not even import the slow files where slow tests are left out."""
    quick = config.getoption("markexpr") == "not slow"
    return True if quick and collection_path.suffix == ".py" and in_slow_file(collection_path) else None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the slow tests, and begin with those in the browser: they take longest, and share what one worker starts."""
    items.sort(key=lambda item: "browser" not in item.path.parts)
    for item in items:
        exhaustive = item.get_closest_marker("exhaustive") is not None
        if exhaustive or in_slow_file(item.path) or SLOW_FIXTURES & set(getattr(item, "fixturenames", ())):
            item.add_marker(pytest.mark.slow)


_TRACER = sys.gettrace()  # of `make coverage`; None otherwise


def pytest_runtest_setup() -> None:
    """Trace again where a test has ended that, as an error in a trace function does."""
    if _TRACER is not None and sys.gettrace() is None:
        sys.settrace(_TRACER)


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop() -> None:
    """Leave thousands of collected tests and all imported modules out of every later collection of garbage."""
    gc.freeze()
    gc.enable()


@pytest.fixture(scope="session")
def shipped_record_path() -> Path:
    """The stand-in record in the lab's own layout, as it ships."""
    return ROOT / "data" / "SysIdenData_StudentVersion.mat"


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of real records; tests that want one are skipped, saying so, where it is not there."""
    folder = Path(os.environ.get("LABSID_REAL_RECORDS", ROOT.parent / "shared" / "data"))
    if not folder.is_dir():
        pytest.skip(f"the real records are not on this machine (looked in {folder})")
    return folder
