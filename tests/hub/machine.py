"""A machine for the tests of the hub: users, groups and folders of its own, in a mount namespace that ends with it.

Nothing of it is on the real machine: /etc is a copy, and /home, /opt and /srv are empty.
"""

import contextlib
import os
import shlex
import shutil
import subprocess
import sys
import sysconfig
import textwrap
from collections.abc import Iterator, Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
NEEDED = ("unshare", "nsenter", "mount", "setpriv", "runuser", "useradd", "groupadd", "usermod", "install", "unzip")
_OWN = ("/home", "/opt", "/srv")


def missing() -> str:
    """Why there can be no such machine here; empty if there can."""
    if sys.platform != "linux" or os.geteuid() != 0:
        return "only root on Linux can make the users of a hub"
    absent = [name for name in NEEDED if shutil.which(name) is None]
    if absent:
        return f"these programs are missing: {', '.join(absent)}"
    probe = subprocess.run(
        ["unshare", "--mount", "mount", "-t", "tmpfs", "tmpfs", "/srv"], capture_output=True, text=True, check=False
    )
    return f"this container cannot mount: {probe.stderr.strip()}" if probe.returncode else ""


class Machine:
    """A mount namespace in which commands run as any user."""

    def __init__(self) -> None:
        self._keeper = subprocess.Popen(
            ["unshare", "--mount", "--propagation", "private", "sh", "-c", "echo; exec cat"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        assert self._keeper.stdout is not None
        self._keeper.stdout.read(1)
        self.root(_MAKE)
        for shown in _needed_trees():
            self.root(_show(shown))

    def close(self) -> None:
        """End the namespace, and with it everything that was made in it."""
        self._keeper.kill()
        self._keeper.communicate()

    def root(self, script: str) -> str:
        """Run a script as root; returns what it printed."""
        done = self.run("root", script)
        assert done.returncode == 0, f"{script}\n{done.stdout}{done.stderr}"
        return done.stdout

    def run(
        self, user: str, script: str, seconds: float = 300, **environment: str
    ) -> "subprocess.CompletedProcess[str]":
        """Run a script of sh as a user, in the user's home folder, with nothing of this process's environment."""
        return subprocess.run(
            self.command(user, ["sh", "-ec", script], environment),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=seconds,
            check=False,
        )

    def command(self, user: str, arguments: list[str], environment: Mapping[str, str]) -> list[str]:
        """The command line that runs `arguments` in the namespace, as a user."""
        home = home_of(user)
        kept = {
            "HOME": home,
            "USER": user,
            "PATH": "/opt/bin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin",
            "LANG": "C.UTF-8",
            **environment,
        }
        identity = [] if user == "root" else ["setpriv", f"--reuid={user}", f"--regid={user}", "--init-groups"]
        entered = ["nsenter", f"--mount=/proc/{self._keeper.pid}/ns/mnt"]
        folder = "/" if user == "root" else home
        chdir = ["sh", "-c", f'cd {shlex.quote(folder)} 2>/dev/null || cd /; exec "$@"', "sh"]
        return [
            *entered,
            *identity,
            "env",
            "-i",
            *(f"{key}={value}" for key, value in kept.items()),
            *chdir,
            *arguments,
        ]

    def add_user(self, name: str) -> None:
        """A user with a home folder that nobody else can enter."""
        self.root(f"useradd --create-home --user-group --shell /bin/sh {name} && chmod 700 {home_of(name)}")

    def write(self, path: str, text: str, owner: str = "root", mode: str = "644") -> None:
        """Write a file on the machine."""
        user = "" if owner == "root" else f" && chown {owner}: {path}"
        done = subprocess.run(
            self.command(
                "root", ["sh", "-c", f"mkdir -p $(dirname {path}) && cat > {path} && chmod {mode} {path}{user}"], {}
            ),
            input=text,
            text=True,
            capture_output=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr

    def copy(self, source: Path, target: str, owner: str = "root") -> None:
        """Copy a folder of the real machine."""
        self.root(f"mkdir -p {target} && cp -r {shlex.quote(str(source))}/. {target} && chown -R {owner}: {target}")


def home_of(user: str) -> str:
    """The home folder of a user."""
    return "/root" if user == "root" else f"/home/{user}"


def python_program(statement: str, interpreter: str = sys.executable) -> str:
    """The text of a program that runs a statement, as pip makes one for an entry point."""
    return f'#!/bin/sh\nexec {interpreter} -P -c {shlex.quote(statement)} "$@"\n'


def library_folders() -> list[str]:
    """The folders from which this Python imports packages."""
    found = [path for path in sys.path if Path(path).name in ("site-packages", "dist-packages")]
    return list(dict.fromkeys([*found, sysconfig.get_paths()["purelib"]]))


@contextlib.contextmanager
def open_machine() -> Iterator[Machine]:
    """A machine that is closed at the end."""
    machine = Machine()
    try:
        yield machine
    finally:
        machine.close()


_MAKE = textwrap.dedent("""
    mount -t tmpfs tmpfs /mnt
    cp -a /etc /mnt/etc
    mount --bind /mnt/etc /etc
    for folder in %s; do mount -t tmpfs -o mode=755 tmpfs $folder; done
    mkdir /opt/bin
""") % " ".join(_OWN)


def _needed_trees() -> list[Path]:
    """What every user must reach: the interpreter, its packages and this checkout."""
    trees = {Path(sys.prefix), Path(sys.base_prefix), ROOT, *map(Path, library_folders())}
    return [path for path in sorted(trees) if not any(other in path.parents for other in trees)]


def _show(tree: Path) -> str:
    """A script that makes a folder reachable below folders that others cannot enter, which are hidden then."""
    closed = next((one for one in reversed(tree.parents) if one.exists() and not one.stat().st_mode & 1), None)
    if closed is None:
        return "true"
    place, kept = shlex.quote(str(tree)), f"/mnt/tree-{abs(hash(tree))}"
    return (
        f"mkdir -p {kept} && mount --bind {place} {kept} && "
        f"{{ mountpoint -q {closed} || mount -t tmpfs -o mode=755 tmpfs {closed}; }} && "
        f"mkdir -p {place} && mount --bind {kept} {place}"
    )
