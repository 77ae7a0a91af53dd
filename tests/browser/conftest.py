"""One built course, one release, one browser and one JupyterLab for all tests of this folder; they end with them."""

import io
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from html import unescape
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from course_work import ROOT, copy_course

from autograder.course.build import build_course
from autograder.course.layout import Course
from autograder.course.release import release_files
from browser.processes import served, wait_until_reachable

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext

PRELAB, LAB = "prelab-sinusoids", "lab-identification"
_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
_FLAGS = [
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync"),
    *("--disable-background-networking", "--disable-component-update"),
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",  # pages may ask this machine only
]
_WAIT = 60_000  # milliseconds; only a broken page takes as long
_INSTRUCTOR = """
import sys
from pathlib import Path
import autograder.course.layout
here = autograder.course.layout.Course(Path(sys.argv.pop(1)))
autograder.course.layout.find_course = lambda: here
from labsid.cli.commands import main
sys.exit(main())
"""
_STUDENT = """
import sys
sys.modules["autograder"] = sys.modules["nbgrader"] = None
from labsid.cli.commands import main
sys.exit(main())
"""


@dataclass(frozen=True)
class Student:
    """A student with the release's labsid, and nothing of the checkout.

    Attributes
    ----------
    home : Path
        Where the commands are run.
    environment : mapping
        Its environment variables; Jupyter's own files are in a folder of their own.
    """

    home: Path
    environment: dict[str, str]

    @property
    def command(self) -> list[str]:
        """The beginning of each command."""
        return [sys.executable, "-c", _STUDENT]

    def labsid(self, *arguments: str) -> str:
        """Run a command; what it printed."""
        done = subprocess.run(
            [*self.command, *arguments], cwd=self.home, env=self.environment, capture_output=True, encoding="utf-8"
        )
        return done.stdout + done.stderr


@pytest.fixture(scope="package")
def browser() -> "Iterator[Browser]":
    """The system's Chromium. Without one the test is skipped; in CI, where it could be installed, it fails."""
    program = next(filter(None, map(shutil.which, _NAMES)), None)
    if program is None or find_spec("playwright") is None or find_spec("axe_playwright_python") is None:
        missing = (
            "the packages playwright and axe-playwright-python" if program else f"Chromium ({' or '.join(_NAMES)})"
        )
        if os.environ.get("CI") == "true" and shutil.which("apt-get"):
            pytest.fail(f"this machine lacks {missing}, which .ci/run installs")
        pytest.skip(f"this machine lacks {missing}")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as started:
        opened = started.chromium.launch(executable_path=program, args=_FLAGS)
        yield opened
        opened.close()


@pytest.fixture(scope="package")
def context(browser: "Browser") -> "Iterator[BrowserContext]":
    """A browser window."""
    from playwright.sync_api import expect

    opened = browser.new_context(viewport={"width": 1280, "height": 900})
    opened.set_default_timeout(_WAIT)
    expect.set_options(timeout=_WAIT)
    yield opened
    opened.close()


@pytest.fixture(scope="package")
def checkout(tmp_path_factory: pytest.TempPathFactory) -> Course:
    """A course of two assignments as an instructor has it, built."""
    course = copy_course(tmp_path_factory.mktemp("checkout"), PRELAB, LAB)
    shutil.copyfile(ROOT / "pyproject.toml", course.root / "pyproject.toml")
    list(build_course(course))
    return course


@pytest.fixture(scope="package")
def jupyter_folders(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Environment variables with which Jupyter uses folders of its own, a free port, and no network."""
    root = tmp_path_factory.mktemp("jupyter")
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        port = found.getsockname()[1]
    write_json(
        root / "config" / "jupyter_server_config.json",
        {"ServerApp": {"ip": "127.0.0.1", "port": port, "allow_root": True, "open_browser": False}},
    )
    settings = root / "settings" / "@jupyterlab" / "apputils-extension" / "notification.jupyterlab-settings"
    write_json(settings, {"fetchNews": "false", "checkForUpdates": False})
    names = {
        "JUPYTER_CONFIG_DIR": "config",
        "JUPYTER_DATA_DIR": "data",
        "JUPYTER_RUNTIME_DIR": "runtime",
        "JUPYTERLAB_SETTINGS_DIR": "settings",
        "JUPYTERLAB_WORKSPACES_DIR": "workspaces",
        "IPYTHONDIR": "ipython",
    }
    return {**os.environ, **{name: str(root / folder) for name, folder in names.items()}}


def write_json(path: Path, content: Any) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content), encoding="utf-8")


@pytest.fixture(scope="package")
def student(checkout: Course, jupyter_folders: dict[str, str], tmp_path_factory: pytest.TempPathFactory) -> Student:
    """A student who has installed the wheel of the release."""
    files = release_files(checkout)
    (wheel,) = (content for name, content in files.items() if name.endswith(".whl"))
    site = tmp_path_factory.mktemp("site")
    with zipfile.ZipFile(io.BytesIO(wheel)) as archive:
        archive.extractall(site)
    return Student(tmp_path_factory.mktemp("home"), {**jupyter_folders, "PYTHONPATH": str(site)})


@pytest.fixture(scope="package")
def jupyterlab(student: Student) -> Iterator[str]:
    """The address of JupyterLab on the student's work folder, as `labsid lab` opens it."""
    command = [*student.command, "lab"]
    with served(command, student.home, student.environment, r"file://\S+-open\.html"):
        runtime = Path(student.environment["JUPYTER_RUNTIME_DIR"])
        (page,) = runtime.glob("jpserver-file-to-run-*-open.html")  # what Jupyter opens in the browser
        found = re.search(r'href="([^"]+)"', page.read_text(encoding="utf-8"))
        assert found is not None
        yield wait_until_reachable(unescape(found[1]))


@dataclass(frozen=True)
class Instructor:
    """An instructor with a checkout of the course.

    Attributes
    ----------
    course : Course
    home : Path
        Where the commands are run.
    environment : mapping
        As of `Student`.
    """

    course: Course
    home: Path
    environment: dict[str, str]

    @property
    def command(self) -> list[str]:
        """The beginning of each command."""
        return [sys.executable, "-c", _INSTRUCTOR, str(self.course.root)]

    def labsid(self, *arguments: str) -> str:
        """Run a command that succeeds; what it printed."""
        done = subprocess.run(
            [*self.command, *arguments], cwd=self.home, env=self.environment, capture_output=True, encoding="utf-8"
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout


@pytest.fixture(scope="package")
def instructor(
    checkout: Course, jupyter_folders: dict[str, str], tmp_path_factory: pytest.TempPathFactory
) -> Instructor:
    """The instructor, in an empty folder."""
    return Instructor(checkout, tmp_path_factory.mktemp("instructor"), jupyter_folders)
