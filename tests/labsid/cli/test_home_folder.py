"""A home folder that cannot be written: what the libraries are given instead."""

import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from labsid.cli.commands import main
from labsid.cli.home_folder import provide_home

pytestmark = pytest.mark.skipif(os.name != "posix", reason="home folders of Windows are elsewhere")


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of temporary files, in the place of this machine's."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    for name in ("XDG_CONFIG_HOME", "IPYTHONDIR", "MPLCONFIGDIR"):
        monkeypatch.delenv(name, raising=False)
    return folder


def test_a_home_folder_that_can_be_written_stays(temporary: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    home, settings = temporary / "home", temporary / "settings" / "not made yet"
    home.mkdir()
    monkeypatch.setenv("HOME", str(home))
    monkeypatch.setenv("MPLCONFIGDIR", str(settings))
    provide_home()
    assert os.environ["HOME"] == str(home)
    assert os.environ["MPLCONFIGDIR"] == str(settings)
    assert [path.name for path in temporary.iterdir()] == ["home"]


@pytest.mark.parametrize("home", ["missing", "a file", "no user"])
def test_without_one_there_is_a_private_folder_which_the_next_run_has_too(
    temporary: Path, monkeypatch: pytest.MonkeyPatch, home: str
) -> None:
    (temporary / "a file").touch()
    monkeypatch.setenv("HOME", str(temporary / home))
    monkeypatch.setenv("IPYTHONDIR", str(temporary / "a file" / "ipython"))
    if home == "no user":
        monkeypatch.setattr(Path, "home", _no_home)
    provide_home()
    found = Path(os.environ["HOME"])
    assert found == temporary / f"labsid-home-{os.getuid()}"
    assert stat.S_IMODE(found.stat().st_mode) == 0o700
    assert "IPYTHONDIR" not in os.environ
    monkeypatch.setenv("HOME", str(temporary / home))
    provide_home()
    assert os.environ["HOME"] == str(found)


def _no_home() -> Path:
    raise RuntimeError("Could not determine home directory.")


@pytest.mark.parametrize("planted", ["link", "open folder", "file"])
def test_what_somebody_else_may_have_put_there_is_not_used(
    temporary: Path, monkeypatch: pytest.MonkeyPatch, planted: str
) -> None:
    place = temporary / f"labsid-home-{os.getuid()}"
    if planted == "link":
        (temporary / "theirs").mkdir(mode=0o700)
        place.symlink_to(temporary / "theirs")
    elif planted == "file":
        place.touch()
    else:
        place.mkdir()
        place.chmod(0o777)
    monkeypatch.setenv("HOME", str(temporary / "missing"))
    provide_home()
    found = Path(os.environ["HOME"])
    assert found != place
    assert found.parent == temporary
    assert stat.S_IMODE(found.stat().st_mode) == 0o700


def test_if_nothing_can_be_written_one_line_says_what_to_set(
    temporary: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("HOME", str(temporary / "missing"))
    monkeypatch.setattr("tempfile.tempdir", str(temporary / "missing"))
    assert main(["--version"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("labsid: error: neither the home folder nor a folder for temporary files can be written")
    assert said.endswith("Set HOME or TMPDIR to a folder that can.\n")
    assert said.count("\n") == 1


def test_jupyter_and_ipython_are_imported_without_a_warning(temporary: Path) -> None:
    statement = (
        "from labsid.cli.home_folder import provide_home; provide_home(); import matplotlib.pyplot, jupyter_core.paths;"
        "jupyter_core.paths.jupyter_data_dir(); from IPython.core.interactiveshell import InteractiveShell as shell;"
        "shell.instance()"
    )
    environment = {"PATH": os.environ["PATH"], "HOME": str(temporary / "missing"), "TMPDIR": str(temporary)}
    done = subprocess.run(
        [sys.executable, "-W", "error::UserWarning", "-c", statement],
        env=environment,
        cwd=Path(__file__).resolve().parents[3],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
