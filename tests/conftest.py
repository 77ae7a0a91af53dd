"""What every test may ask for: the shipped stand-in record and, where they are, the real records."""

import os
import signal
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent

# Tests run side by side: one thread each, before numpy loads. More only wait for each other.
for _threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"):
    os.environ.setdefault(_threads, "1")

# A run in the background starts with interrupts ignored, and hands that down to the commands that tests interrupt.
if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


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
