"""The data that predictions are tried on: records of the lab, and that of Example 6-1."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from labsid.predictions.prediction import Sources
from labsid.records.record import load_record
from labsid.rig import lab_record_bytes, make_lab_record

SECRET = b"a secret of the tests"


def example_6_1() -> dict[str, object]:
    """The variables of the notebook's cell `ri-4-record`."""
    rng = np.random.default_rng(69)
    u, e = rng.uniform(-2, 2, 1000), rng.standard_normal(1000)
    true = np.where(np.arange(1000)[:, np.newaxis] < 500, [-0.8, 0, 1], [-1.1, 0.3, 2])
    y = np.zeros(1000)
    for t in range(1, 1000):
        a1, a2, b1 = true[t]
        y[t] = -a1 * y[t - 1] - a2 * (y[t - 2] if t > 1 else 0) + b1 * u[t - 1] + e[t]
    return {"u_61": u, "y_61": y, "theta_true": true}


@pytest.fixture(scope="session")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str | None], Sources]:
    """The data of a student; None for the course's own record."""
    folder: Path = tmp_path_factory.mktemp("records")

    def made(student: str | None = None) -> Sources:
        path = folder / f"{student or 'course'}.mat"
        log = make_lab_record() if student is None else make_lab_record(student, SECRET)
        path.write_bytes(lab_record_bytes(log))
        return Sources(load_record(path), example_6_1())

    return made
