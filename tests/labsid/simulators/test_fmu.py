"""Co-simulation FMUs, built here: the same output as the equations in them, and what is said of others."""

import gc
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmu_rigs import build_tank
from scipy.signal import lfilter

from labsid.simulators.process import open_in_process
from labsid.simulators.simulator import one_of_each

pytest.importorskip("fmpy", reason="pip install 'labsid[fmu]'")
pytest.importorskip("pythonfmu", reason="builds the FMU")

T = 0.75 * np.arange(301)
U = np.repeat(np.random.default_rng(1).uniform(-1, 1, 31), 10)[:301]


@pytest.fixture(scope="module")
def tank(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_tank(tmp_path_factory.mktemp("fmu") / "tank")


def test_an_fmu_simulates_with_the_numbers_that_are_asked_for(tank: Path) -> None:
    simulate = open_in_process(str(tank))
    assert simulate.nominal == {"gain": 2.0, "pole": 0.9}
    np.testing.assert_allclose(simulate(T, U), lfilter([0, 0.2], [1, -0.9], U), atol=1e-12)
    np.testing.assert_allclose(simulate(T, U, {"gain": 3.0}), lfilter([0, 0.3], [1, -0.9], U), atol=1e-12)
    np.testing.assert_allclose(simulate(T, U), lfilter([0, 0.2], [1, -0.9], U), atol=1e-12)  # nothing is kept


def test_nothing_is_left_of_an_fmu_that_is_not_used_any_more(
    tank: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    simulate = open_in_process(str(tank))
    assert simulate(T, U).size == T.size
    assert list(tmp_path.iterdir()) != []  # it is unpacked there
    del simulate
    gc.collect()
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_played_is_said_in_one_line(tank: Path, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"no.fmu does not exist"):
        open_in_process(str(tmp_path / "no.fmu"))
    cut = tmp_path / "cut.fmu"
    cut.write_bytes(tank.read_bytes()[:1000])
    with pytest.raises(ValueError, match=r"cut.fmu is not an FMU that can be read"):
        open_in_process(str(cut))
    with zipfile.ZipFile(tmp_path / "empty.fmu", "w"):
        pass
    with pytest.raises(ValueError, match=r"empty.fmu is not an FMU that can be read"):
        open_in_process(str(tmp_path / "empty.fmu"))
    more = '        self.second = 0.0\n        self.register_variable(Real("second", causality=Fmi2Causality.input))\n'
    with pytest.raises(ValueError, match=r"Tank.fmu has 2 \(inflow, second\) as real input, expected one"):
        one_of_each(open_in_process(str(build_tank(tmp_path / "two", more))))
