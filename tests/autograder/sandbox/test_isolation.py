"""The levels of isolation: what each lets student code do, its limits, and what is left behind. Loopback only."""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from kept_processes import Kept

from autograder.sandbox import allowed_paths, bubblewrap, doctor, isolation, process_launchers, workdirs
from autograder.sandbox.bubblewrap import SandboxError
from autograder.sandbox.doctor import LevelReport
from autograder.sandbox.escapes import ESCAPES, OPEN_WITHOUT_FILTER, OPEN_WITHOUT_ISOLATION, open_escapes
from autograder.sandbox.isolation import (
    LEVELS,
    IsolationError,
    Limits,
    ProcessLauncher,
    StudentProcess,
    StudentProcessError,
    open_launcher,
    probe_levels,
)
from autograder.sandbox.process_launchers import ForkingLauncher, SpawningLauncher
from autograder.sandbox.workdirs import remove_stale_workdirs, temporary_workdir
from labsid.checks.permitted import is_reference
from labsid.records.record import load_record

ROOT = Path(__file__).resolve().parents[3]
LIMITS = Limits(
    cell_seconds=20,
    memory_bytes=1 << 30,
    file_bytes=4 << 20,
    disk_bytes=12 << 20,
    processes=12,
    cpu_seconds=20,
)

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")


@pytest.fixture(scope="module", params=LEVELS)
def launcher(request: pytest.FixtureRequest) -> Iterator[ProcessLauncher]:
    """Every level that this machine has; the others are skipped, saying why."""
    try:
        with open_launcher(request.param, LIMITS) as launcher:
            assert launcher.level == request.param
            yield launcher
    except IsolationError as error:
        pytest.skip(str(error))


@pytest.fixture
def student(launcher: ProcessLauncher, tmp_path: Path) -> Iterator[StudentProcess]:
    started = launcher.start(tmp_path)
    yield started
    started.close()


@pytest.fixture
def kept_fork_server(kept: Kept) -> Iterator[None]:
    """The fork server of an earlier test, for what does not depend on its start."""
    with kept.used():
        yield


def value_of(student: StudentProcess, code: str) -> object:
    reply = student.run(code)
    assert reply.ok, reply.error
    return student.value("got").value


# -- the self-test ----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def reports() -> dict[str, LevelReport]:
    return {report.level: report for report in doctor.attempt_escapes()}


def test_the_doctor_tries_every_level(reports: dict[str, LevelReport]) -> None:
    assert tuple(reports) == LEVELS
    names = {escape.name for escape in ESCAPES}
    for report in reports.values():
        assert set(report.blocked) == (set() if report.problem else names)
    text = doctor.reports_text(list(reports.values()))
    assert all(name in text for name in (*names, *LEVELS))


def test_namespaces_block_every_escape(reports: dict[str, LevelReport]) -> None:
    if reports["namespaces"].problem:
        pytest.skip(reports["namespaces"].problem)
    assert {name for name, holds in reports["namespaces"].blocked.items() if not holds} == set()


def test_landlock_blocks_access_to_files(reports: dict[str, LevelReport]) -> None:
    if reports["landlock"].problem:
        pytest.skip(reports["landlock"].problem)
    holds = reports["landlock"].blocked
    about_files = [name for name in holds if name.startswith(("read", "write", "change", "leave", "import"))]
    assert len(about_files) > 7
    assert {name for name in about_files if not holds[name]} == set()


def test_without_isolation_files_are_open_and_limits_hold(reports: dict[str, LevelReport]) -> None:
    """The trials are real: what nothing prevents does succeed."""
    holds = reports["none"].blocked
    for name in ("read the course", "read another submission", "read the reference's sources", "write outside"):
        assert not holds[name], name
    for name in ("allocate 2 GB", "keep a process alive", "find the reference in memory", "write a file of 12 MB"):
        assert holds[name], name


def test_what_is_open_without_isolation_is_what_a_grading_run_names(reports: dict[str, LevelReport]) -> None:
    is_open = {name for name, holds in reports["none"].blocked.items() if not holds}
    assert is_open <= set(open_escapes("none"))
    assert open_escapes("landlock") == open_escapes("namespaces") == ()
    assert set(OPEN_WITHOUT_ISOLATION + OPEN_WITHOUT_FILTER) <= {escape.name for escape in ESCAPES}


@pytest.mark.skipif(os.name != "posix" or os.geteuid() != 0, reason="this test runs as a plain user itself")
@pytest.mark.skipif(shutil.which("unshare") is None, reason="no unshare on this machine")
def test_a_plain_user_gets_the_same_walls() -> None:
    """In a user namespace without privileges, where root's files and processes count as the user's own."""
    code = "from autograder.sandbox import doctor\nprint(doctor.reports_json(list(doctor.attempt_escapes())))"
    plain = ["unshare", "--user", "--map-user=1000", "--map-group=1000"]
    run = subprocess.run([*plain, sys.executable, "-c", code], capture_output=True, text=True, check=False)
    if "unshare failed" in run.stderr:
        pytest.skip(run.stderr.strip())
    levels = json.loads(run.stdout)["rungs"]
    found = {level: {name for name, holds in one["holds"].items() if not holds} for level, one in levels.items()}
    assert found["namespaces"] == set()
    assert found["landlock"] <= {"see other processes"}
    assert found["none"] == set(open_escapes("none"))


# -- the ladder -------------------------------------------------------------------------------------------------------


def no_bubblewrap() -> str:
    raise SandboxError("bubblewrap is not installed")


@pytest.mark.usefixtures("kept_fork_server")
def test_strict_is_refused_where_it_cannot_be_had(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process_launchers, "find_bubblewrap", no_bubblewrap)
    with (
        pytest.raises(IsolationError, match=r"'strict' is unavailable: namespaces: .*not installed.*doctor") as caught,
        open_launcher("strict"),
    ):
        pass
    assert "\n" not in str(caught.value)


@pytest.mark.usefixtures("kept_fork_server")
def test_best_takes_the_next_level_that_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = []

    def refuse(launcher: ForkingLauncher, setup: process_launchers.IsolationSetup) -> str:
        tried.append(setup.level)
        return "" if setup == process_launchers.IsolationSetup("none") else "not today"

    monkeypatch.setattr(isolation, "_probe", refuse)
    with open_launcher("best") as launcher:
        assert launcher.level == "none"
    assert list(dict.fromkeys(tried)) == [name for name in LEVELS if name == "none" or sys.platform == "linux"]


def test_a_machine_that_starts_no_process_is_said() -> None:
    hasty = Limits(start_seconds=0.001)
    said = r"'best' is unavailable: the fork server did not start: [^;]*$"
    with pytest.raises(IsolationError, match=said):
        open_launcher("best", hasty).__enter__()
    assert [level.name for level in probe_levels(hasty) if level.problem] == list(LEVELS)


@pytest.mark.skipif(os.name != "posix", reason="HOME is not the home folder of Windows")
def test_settings_that_cannot_be_kept_are_said_in_one_line(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / ".ipython").mkdir()
    (tmp_path / ".ipython" / "profile_default").touch()
    monkeypatch.setenv("HOME", str(tmp_path))
    said = (
        r"the fork server did not start \(.*profile_default' exists but .*\)\. Set HOME and TMPDIR to folders that can"
    )
    with pytest.raises(IsolationError, match=said):
        open_launcher("best").__enter__()
    assert "Traceback" not in capfd.readouterr().err


@pytest.mark.usefixtures("kept_fork_server")
def test_none_asks_for_no_more_than_that(tmp_path: Path) -> None:
    with open_launcher("none") as launcher:
        assert launcher.level == "none"


def test_an_unknown_isolation_is_refused() -> None:
    with pytest.raises(ValueError, match=r"got 'some', expected strict, best or one of namespaces, landlock, none"):
        open_launcher("some").__enter__()


@pytest.mark.usefixtures("kept_fork_server")
def test_a_level_is_probed_before_it_is_used(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sandbox that shows the files of this machine is not taken for one."""
    leaky = process_launchers.IsolationSetup("no level at all")
    monkeypatch.setattr(isolation, "_setups", lambda name: [leaky])
    with pytest.raises(IsolationError, match="files of this machine stay visible"):
        open_launcher("strict").__enter__()


# -- what exercises use -----------------------------------------------------------------------------------------------


def test_what_exercises_use_works(launcher: ProcessLauncher, tmp_path: Path, shipped_record_path: Path) -> None:
    (tmp_path / "record.mat").write_bytes(shipped_record_path.read_bytes())
    student = launcher.start(tmp_path)
    code = """
import numpy as np, matplotlib.pyplot as plt, scipy.optimize, control
from labsid import plots, rig
from labsid.plots import lecture_diagrams
from labsid.records.record import load_record
from labsid.checks import notebook_checks
notebook_checks("lab-identification", globals())("q")
record = load_record("record.mat")
plots.figure_3()
plots.sketch_rig()
np.savetxt("mine.txt", record.y[:3])
plt.plot(record.t, record.y)
plt.savefig("mine.png")
got = len(record) + np.loadtxt("mine.txt").size
"""
    try:
        assert value_of(student, code) == len(load_record(shipped_record_path)) + 3
    finally:
        student.close()


@pytest.mark.parametrize(
    "name",
    [
        "labsid.lab.arx",
        "labsid.checks.assignments.lab_identification",
        "labsid.plots.verification",
        "labsid.rig.switchable.withheld",
        "autograder.judge.judging",
    ],
)
def test_the_reference_is_refused_and_said_to_be(student: StudentProcess, name: str) -> None:
    reply = student.run(f"import {name}")
    assert reply.error is not None
    assert "is the reference: it cannot be used" in reply.error["text"]
    via_importlib = student.run(f"import importlib\nimportlib.import_module({name!r})")
    assert via_importlib.error is not None
    assert via_importlib.error["kind"] == "ImportError"


def test_nothing_of_the_reference_is_in_the_parent() -> None:
    code = (
        "import sys; from autograder.sandbox.child import open_shell; open_shell()\n"
        "print(*[name for name in sys.modules if name.startswith('labsid.')])"
    )
    named = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert "labsid.records.record" in named
    assert "labsid.plots" in named
    assert [name for name in named if is_reference(name)] == []


def test_nothing_of_this_machine_is_told(student: StudentProcess, tmp_path: Path) -> None:
    told = str(value_of(student, "import os\ngot = repr(dict(os.environ)) + ' '.join(os.listdir('.'))"))
    for secret in (os.path.expanduser("~"), os.environ.get("VIRTUAL_ENV", "/nowhere"), os.environ["PATH"]):
        assert secret not in told


def test_only_the_channel_is_inherited(student: StudentProcess) -> None:
    code = """
import os
got = []
for descriptor in range(3, 200):
    try:
        os.fstat(descriptor)
        got.append(descriptor)
    except OSError:
        pass
"""
    np.testing.assert_array_equal(np.atleast_1d(value_of(student, code)), [3])


def test_each_submission_has_its_own_place(launcher: ProcessLauncher, tmp_path: Path) -> None:
    """One that runs at the same time cannot be found, neither by its files nor by its processes."""
    if launcher.level == "none":
        pytest.skip("without isolation it can")
    folders = [tmp_path / "one", tmp_path / "two"]
    for folder in folders:
        folder.mkdir()
    one, two = (launcher.start(folder) for folder in folders)
    try:
        pid = value_of(one, "import os\nopen('mine', 'w').write('5')\ngot = os.getpid()")
        for path in (str(folders[0] / "mine"), "mine"):
            assert two.run(f"open({path!r})").error is not None
        reply = two.run(f"import os\nif os.getpid() != {pid}:\n    os.kill({pid}, 9)")
        assert reply.error is not None or launcher.level == "namespaces"  # there both may have the same number
        assert one.run("1").ok
    finally:
        one.close()
        two.close()


# -- limits -----------------------------------------------------------------------------------------------------------


def ended(student: StudentProcess, code: str) -> str:
    """How a cell came to its end: what the process died of, else the kind of the error, else nothing."""
    try:
        reply = student.run(code)
    except StudentProcessError as died:
        return str(died)
    return (reply.error or {}).get("kind", "")


LOCKS = """
import ctypes, fcntl, os, struct
import numpy
libc = ctypes.CDLL(None, use_errno=True)
file = open(numpy.__file__)
lock = struct.pack("hhqqi4x", fcntl.F_RDLCK, 0, 0, 0, 0)
ways = {
    "flock": lambda: fcntl.flock(file, fcntl.LOCK_SH),
    "lockf": lambda: fcntl.lockf(file, fcntl.LOCK_SH),
    "who locks": lambda: fcntl.fcntl(file, fcntl.F_GETLK, lock),
    "lock of the open file": lambda: fcntl.fcntl(file, fcntl.F_OFD_SETLK, lock),
    "lease": lambda: fcntl.fcntl(file, fcntl.F_SETLEASE, fcntl.F_RDLCK),
    "its state": lambda: fcntl.fcntl(file, fcntl.F_GETLEASE),
}
possible = []
for name, way in ways.items():
    try:
        way()
        possible.append(name)
    except PermissionError:
        pass
possible += ["inotify"] if libc.inotify_init1(0) >= 0 else []
said = ", ".join(possible) or "none"
flags = fcntl.fcntl(file, fcntl.F_GETFD)  # other commands work
"""


def test_no_lock_or_watch_passes_a_message_to_another_sandbox(student: StudentProcess) -> None:
    """Through a file that all may read."""
    reply = student.run(LOCKS)
    assert reply.ok, reply.error
    assert student.value("said").value == "none"
    assert student.value("flags").value == 1


def test_memory_of_one_process(student: StudentProcess) -> None:
    reply = student.run("block = bytearray(1 << 30)")
    assert reply.error is not None
    assert reply.error["kind"] == "MemoryError"
    assert value_of(student, "got = len(bytearray(1 << 28)) >> 28") == 1


def test_memory_of_several_processes(student: StudentProcess) -> None:
    if not Path("/proc/self/stat").is_file():
        pytest.skip("nothing here tells what processes hold")
    code = """
import os, time
for _ in range(6):
    if os.fork() == 0:
        block = bytearray(b"x") * (300 << 20)
        time.sleep(15)
        os._exit(0)
time.sleep(15)
"""
    assert ended(student, code) == "its processes took more than 1 GB together"


def test_number_of_processes(student: StudentProcess) -> None:
    code = """
import os, time
got = 0
try:
    for _ in range(100):
        if os.fork() == 0:
            time.sleep(6)
            os._exit(0)
        got += 1
    time.sleep(6)
except OSError:
    pass
"""
    assert ended(student, code) in ("", "it started more than 12 processes")
    if not student.lost:
        assert 0 < student.value("got").value < 100  # type: ignore[operator]


def test_size_of_a_file(student: StudentProcess) -> None:
    reply = student.run("open('large', 'wb').write(bytes(5 << 20))")
    assert reply.error is not None
    assert reply.error["kind"] == "OSError"


def test_size_of_all_files(student: StudentProcess) -> None:
    code = """
import time
for i in range(8):
    with open(str(i), "wb") as file:
        file.write(bytes(3 << 20))
    time.sleep(0.3)
"""
    assert ended(student, code) in ("OSError", "its files took more than 12 MB together")


def test_what_a_submission_leaves_running_ends_with_it(launcher: ProcessLauncher, tmp_path: Path) -> None:
    if not Path("/proc/self/comm").is_file():
        pytest.skip("nothing here shows it")
    name = f"left{os.getpid()}"
    code = f"""
import ctypes, os, time
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        ctypes.CDLL(None).prctl(15, b"{name}", 0, 0, 0)
        time.sleep(60)
    os._exit(0)
time.sleep(0.3)
"""
    student = launcher.start(tmp_path)
    assert student.run(code).ok
    student.close()
    until = time.monotonic() + 10
    while named(name) and time.monotonic() < until:
        time.sleep(0.05)
    assert named(name) == []


def named(name: str) -> list[int]:
    """The processes of that name."""
    found = []
    for comm in Path("/proc").glob("[0-9]*/comm"):
        try:
            if comm.read_text(encoding="utf-8").strip() == name:
                found.append(int(comm.parent.name))
        except OSError:
            pass
    return found


# -- work folders -----------------------------------------------------------------------------------------------------

SPOILS = (
    "os.remove('record')",
    "open('record', 'w').write('changed')",
    "os.chmod('.', 0)",
    "os.rename(here, here + '-gone')",
    "shutil.rmtree(here)",
    "shutil.rmtree(here)\nopen(here, 'w').close()",
    "shutil.rmtree(here)\nos.symlink('/', here)",
)


@pytest.mark.parametrize("spoil", SPOILS)
def test_every_process_starts_from_what_was_given(launcher: ProcessLauncher, tmp_path: Path, spoil: str) -> None:
    """Whatever the one before it did to its folder."""
    (tmp_path / "record").write_text("5", encoding="utf-8")
    before = workdirs_now()
    first = launcher.start(tmp_path)
    first.run(f"import os, shutil\nhere = os.getcwd()\n{spoil}")
    first.close()
    student = launcher.start(tmp_path)
    try:
        assert value_of(student, "open('mine', 'w').close()\ngot = open('record').read()") == "5"
    finally:
        student.close()
    assert [path.name for path in tmp_path.iterdir()] == ["record"]
    left = workdirs_now() - before
    for name in left:
        workdirs.remove_folder(Path(tempfile.gettempdir(), name))
    assert all(
        name.endswith("-gone") and launcher.level == "none" for name in left
    )  # there a folder can be carried off


def workdirs_now() -> set[str]:
    return {path.name for path in Path(tempfile.gettempdir()).glob(f"labsid-workdir-{os.getpid()}-*")}


def test_where_nothing_forks_there_are_folders_and_limits_all_the_same(tmp_path: Path) -> None:
    (tmp_path / "record").write_text("5", encoding="utf-8")
    before = workdirs_now()
    student = SpawningLauncher(LIMITS).start(tmp_path)
    try:
        reply = student.run("block = bytearray(1 << 30)")
        assert reply.error is not None
        assert reply.error["kind"] == "MemoryError"
        assert value_of(student, "got = open('record').read()\nopen('record', 'w').close()") == "5"
    finally:
        student.close()
    assert (tmp_path / "record").read_text(encoding="utf-8") == "5"
    assert workdirs_now() == before


# -- what is left behind ----------------------------------------------------------------------------------------------

GRADER = """
import ctypes, sys
from autograder.sandbox.isolation import Limits, temporary_workdir, open_launcher
with open_launcher(sys.argv[1]) as launcher, temporary_workdir() as folder:
    student = launcher.start(folder)
    student.run("import ctypes; ctypes.CDLL(None).prctl(15, b'" + sys.argv[2] + "', 0, 0, 0)")
    print(folder, launcher.fork_server_pid, flush=True)
    student.run("import time; time.sleep(60)")
"""


def test_a_grader_that_is_killed_leaves_nothing(launcher: ProcessLauncher) -> None:
    if not Path("/proc/self/comm").is_file():
        pytest.skip("nothing here shows it")
    name = f"killed{os.getpid()}"
    grader = subprocess.Popen([sys.executable, "-c", GRADER, launcher.level, name], stdout=subprocess.PIPE, text=True)
    assert grader.stdout is not None
    with grader:
        folder, parent = grader.stdout.readline().split()
        assert named(name)
        grader.send_signal(signal.SIGKILL)
    until = time.monotonic() + 20
    while (named(name) or Path(f"/proc/{parent}").exists()) and time.monotonic() < until:
        time.sleep(0.05)
    assert named(name) == []
    assert not Path(f"/proc/{parent}").exists()
    remove_stale_workdirs()
    assert not Path(folder).exists()


def test_the_workdir_of_a_running_grader_is_kept() -> None:
    with temporary_workdir() as folder:
        (folder / "kept").touch()
        remove_stale_workdirs()
        assert (folder / "kept").is_file()
    assert not folder.exists()


def test_a_workdir_is_removed_whatever_was_done_to_it(tmp_path: Path) -> None:
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "kept").touch()
    with temporary_workdir() as folder:
        (folder / "deep").mkdir()
        (folder / "deep" / "file").touch()
        (folder / "link").symlink_to(outside)
        (folder / "deep").chmod(0)
    assert not folder.exists()
    assert (outside / "kept").is_file()


def test_the_size_of_a_folder_is_that_of_its_files(tmp_path: Path) -> None:
    (tmp_path / "deep").mkdir()
    (tmp_path / "a").write_bytes(bytes(10))
    (tmp_path / "deep" / "b").write_bytes(bytes(5))
    assert workdirs.folder_bytes(tmp_path) == 15


# -- where labsid is installed among the other packages ---------------------------------------------------------------


@pytest.mark.usefixtures("kept_fork_server")
def test_the_reference_is_masked_where_it_lies_among_the_libraries(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    paths = [*allowed_paths.interpreter_paths(), ROOT / "labsid", ROOT / "autograder"]
    monkeypatch.setattr(allowed_paths, "interpreter_paths", lambda: paths)
    monkeypatch.setattr(allowed_paths, "hidden_folders", lambda: [ROOT / "autograder" / "judge", ROOT / "labsid"])
    try:
        with open_launcher("namespaces", LIMITS) as launcher:
            student = launcher.start(tmp_path)
            for shown in ("autograder/cli.py", "labsid/records/record.py"):
                assert value_of(student, f"got = len(open({str(ROOT / shown)!r}).read())")
            for hidden in ("checks/assignments/lab_identification/__init__.py", "gap/diagnosis.py", "lab/arx.py"):
                assert (ROOT / "labsid" / hidden).is_file()
                reply = student.run(f"open({str(ROOT / 'labsid' / hidden)!r})")
                assert reply.error is not None
                assert reply.error["kind"] == "FileNotFoundError"
            student.close()
    except IsolationError as error:
        pytest.skip(str(error))


def test_excluded_paths_are_left_out(tmp_path: Path) -> None:
    for path in ("a/x", "a/shut/y", "b/z"):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).touch()
    found = allowed_paths.exclude_paths(tmp_path, [tmp_path / "a" / "shut"])
    assert [str(path.relative_to(tmp_path)) for path in found] == ["a/x", "b"]
    assert list(allowed_paths.exclude_paths(tmp_path / "a", [tmp_path / "a"])) == []
    assert list(allowed_paths.exclude_paths(tmp_path / "b", [tmp_path / "a"])) == [tmp_path / "b"]


@pytest.fixture
def other_copy(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Trees of two interpreters with a copy of labsid among their packages; the first one's packages are in use."""
    monkeypatch.setattr(allowed_paths, "_SYSTEM", (str(tmp_path / "lib"), str(tmp_path / "link")))
    for name in ("python3.8/site-packages", "python3/dist-packages"):
        (tmp_path / "lib" / name / "labsid" / "lab").mkdir(parents=True)
        (tmp_path / "lib" / name / "numpy").mkdir()
    (tmp_path / "link").symlink_to("lib")
    monkeypatch.setattr(sys, "path", [*sys.path, str(tmp_path / "lib/python3.8/site-packages")])
    return tmp_path / "lib"


def test_other_copies_of_labsid_are_hidden_wherever_they_are_mounted(other_copy: Path) -> None:
    hidden = set(allowed_paths.hidden_folders())
    assert {other_copy / "python3.8/site-packages/labsid", other_copy / "python3/dist-packages"} <= hidden
    assert other_copy / "python3.8/site-packages" not in hidden
    command = bubblewrap.sandbox_command("bwrap", {}, 4096, own_user_namespace=True)
    masks = {command[at + 1] for at, word in enumerate(command) if word == "--tmpfs"}
    for tree in (other_copy, other_copy.parent / "link"):
        assert {f"{tree}/python3.8/site-packages/labsid", f"{tree}/python3/dist-packages"} <= masks


def test_packages_that_are_not_in_use_are_not_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    """As those of the grader's user, unless Python itself uses them."""
    before = allowed_paths.interpreter_paths()
    monkeypatch.setattr("site.getusersitepackages", lambda: str(ROOT / "tests"))
    assert allowed_paths.interpreter_paths() == before


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux has this level")
def test_labsid_is_one_mount_with_what_graded_code_may_import_and_nothing_else(tmp_path: Path) -> None:
    """A mount for each file takes 11 ms of processor time for each sandbox, most of what opening it takes."""
    allowed = allowed_paths.allowed_labsid_paths()
    shown = bubblewrap.copy_as_one_folder(allowed, tmp_path)
    assert shown == {ROOT / "labsid": tmp_path}
    copied = {path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file()}
    files = {file for path in allowed for file in (path.rglob("*") if path.is_dir() else [path]) if file.is_file()}
    assert copied == {file.relative_to(ROOT / "labsid") for file in files if file.suffix != ".pyc"}
    assert all(path.stat().st_mode & 0o777 == (0o755 if path.is_dir() else 0o644) for path in tmp_path.rglob("*"))
    command = bubblewrap.sandbox_command("bwrap", shown, 4096, own_user_namespace=True)
    assert [word for word in command if word.startswith(f"{ROOT / 'labsid'}{os.sep}")] == []


# -- where the interpreter or the checkout lies below the place that is for the submission ----------------------------


@pytest.fixture
def below_tmp(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A tree of the interpreter below /tmp, with a file that is not of it beside."""
    root = Path(tempfile.mkdtemp(dir="/tmp"))
    tree = root / "env" / "lib"
    tree.mkdir(parents=True)
    (tree / "module_below_tmp.py").write_text("kept = 5", encoding="utf-8")
    (root / "beside").write_text("not for students", encoding="utf-8")
    root.chmod(0o755)
    paths = [*allowed_paths.interpreter_paths(), tree]
    monkeypatch.setattr(allowed_paths, "interpreter_paths", lambda: paths)
    yield tree
    shutil.rmtree(root)


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux has this level")
def test_interpreter_paths_below_tmp_are_mounted_into_the_writable_folder(below_tmp: Path) -> None:
    module = ROOT / "labsid" / "records" / "record.py"
    command = bubblewrap.sandbox_command("bwrap", {module: module}, 4096, own_user_namespace=True)
    words = " ".join(command)
    place = words.index("--perms 1777 --size 4096 --tmpfs /tmp ")
    assert place < words.index(f"--dir {bubblewrap.WORK} ") < words.index(f"--ro-bind {below_tmp} {below_tmp} ")
    assert words.count("--size") == 1
    assert "--symlink" not in command
    binds = {Path(command[at + 2]) for at, word in enumerate(command) if word in ("--bind", "--ro-bind")}
    assert below_tmp in binds
    assert not binds & {*below_tmp.parents}


def test_the_interpreter_may_lie_below_tmp(below_tmp: Path, tmp_path: Path) -> None:
    code = f"""
import os, sys
sys.path.insert(0, {str(below_tmp)!r})
import module_below_tmp
got = str(module_below_tmp.kept)
open("mine", "w").write("5")
for path in ({str(below_tmp.parent.parent / "beside")!r}, {str(below_tmp / "module_below_tmp.py")!r}):
    try:
        open(path, "r+").close()
        got += path
    except OSError:
        pass
got += " ".join(os.listdir("."))
"""
    paths = [
        *allowed_paths.interpreter_paths(),
        *allowed_paths.allowed_labsid_paths(),
        *allowed_paths.hidden_folders(),
    ]
    below = {path.parts[2] for path in paths if path.parts[1] == "tmp"}
    try:
        with open_launcher("namespaces", LIMITS) as launcher:
            student = launcher.start(tmp_path)
            try:
                assert value_of(student, code) == "5mine"
                seen = value_of(student, "open('/tmp/more', 'w').close()\ngot = ' '.join(os.listdir('/tmp'))")
                assert set(str(seen).split()) == {"more", "submission", *below}
            finally:
                student.close()
    except IsolationError as error:
        pytest.skip(str(error))


@pytest.mark.parametrize(
    ("module", "refused"),
    [
        ("labsid", False),
        ("labsid.records.record", False),
        ("labsid.plots", False),
        ("labsid.plots.block_diagrams", False),
        ("labsid.plots.rig_sketch", False),
        ("labsid.plots.lab", True),
        ("labsid.plots.verification", True),
        ("labsid.rig.switchable", True),
        ("labsid.rig.switchable.withheld", True),
        ("labsid.rig.laboratory", True),
        ("labsid.rig.lab.tanks", False),
        ("labsid.checks", False),
        ("labsid.checks.values", False),
        ("labsid.lab.arx", True),
        ("labsid.gap.search.explanation", True),
        ("labsid.checks.assignments", True),
        ("labsid.checks.assignments.prelab_sinusoids", True),
        ("autograder", True),
        ("autograder.judge.judging", True),
        ("labsidious", False),
        ("numpy", False),
    ],
)
def test_what_is_the_reference(module: str, refused: bool) -> None:
    assert is_reference(module) is refused


# -- machines that hold less ------------------------------------------------------------------------------------------

LOCKED_DOWN = """
import errno, sys
import seccompy
from autograder.sandbox.isolation import IsolationError, open_launcher, probe_levels
refusing = seccompy.Filter(seccompy.Action.ALLOW)
for name in ("unshare", "mount", "setns", "pivot_root", "umount2"):
    refusing.errno(name, errno.EPERM)
for flag in (0x10000000, 0x20000, 0x20000000):
    refusing.errno("clone", errno.EPERM, args=[(0, seccompy.CmpOp.MASKED_EQ, flag, flag)])
refusing.errno("clone3", errno.ENOSYS)
for number in (444, 445, 446) if sys.argv[1] == "bare" else ():
    refusing.errno(number, errno.ENOSYS)
refusing.load()
with open_launcher("best") as launcher:
    print(launcher.level)
try:
    open_launcher("strict").__enter__()
except IsolationError as error:
    print(error)
"""


@pytest.mark.parametrize(("kind", "expected_level"), [("container", "landlock"), ("bare", "none")])
def test_a_machine_that_refuses_namespaces_gets_the_next_level(kind: str, expected_level: str) -> None:
    """As in a container whose filter forbids them, for root too."""
    pytest.importorskip("seccompy")
    if expected_level == "landlock" and {level.name: level.problem for level in probe_levels()}["landlock"]:
        pytest.skip("this machine has no Landlock")
    run = subprocess.run([sys.executable, "-c", LOCKED_DOWN, kind], capture_output=True, text=True, check=True)
    best, strict = run.stdout.splitlines()
    assert best == expected_level
    assert strict.startswith("isolation 'strict' is unavailable: namespaces: ")
    assert ".." not in strict
