"""What a forked process does to itself before it runs student code: enter its sandbox, take limits, give up rights.

The namespaces are bubblewrap's, the file rules the kernel's Landlock, the filter of system calls the kernel's seccomp,
the last two through packaged bindings. What is here calls them in the right order, and closes what they leave open.
"""

import contextlib
import ctypes
import errno
import functools
import os
import signal
import stat
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from autograder.sandbox.bubblewrap import TMP, allowed_paths

_PR_SET_DUMPABLE, _PR_CAPBSET_DROP, _PR_SET_NO_NEW_PRIVS = 4, 24, 38
_PR_SET_CHILD_SUBREAPER, _PR_CAP_AMBIENT, _PR_CAP_AMBIENT_CLEAR_ALL = 36, 47, 4
_CAPABILITY_VERSION_3 = 0x20080522
_CLONE_NEWUSER = 0x10000000
_CLONE_NEWNS, _CLONE_NEWUTS, _CLONE_NEWIPC, _CLONE_NEWPID, _CLONE_NEWNET = (
    0x20000, 0x4000000, 0x8000000, 0x20000000, 0x40000000,
)  # fmt: skip
_NAMESPACES = _CLONE_NEWNS | _CLONE_NEWUTS | _CLONE_NEWIPC | _CLONE_NEWPID | _CLONE_NEWNET
_MS_NOSUID, _MS_NODEV, _MS_REMOUNT = 2, 4, 32
_MOST_FILES = 10_000
_X32 = 0x40000000  # the same calls again under other numbers, where a kernel of x86 has them

_NO_CALLS = (
    # other namespaces, other file systems
    "unshare", "setns", "mount", "umount2", "pivot_root", "chroot", "open_tree", "move_mount", "fsopen", "fsconfig",
    "fsmount", "fspick", "mount_setattr", "open_by_handle_at", "name_to_handle_at", "quotactl", "swapon", "swapoff",
    # other processes
    "ptrace", "process_vm_readv", "process_vm_writev", "process_madvise", "kcmp", "pidfd_open", "pidfd_getfd",
    "pidfd_send_signal", "rt_sigqueueinfo", "rt_tgsigqueueinfo",
    # other programs: the one that is in sight, Python, would have this module's guards against the reference no more
    "execve", "execveat",
    # memory that no limit counts, and that may outlive its process
    "memfd_create", "memfd_secret", "shmget", "msgget", "semget", "mq_open", "add_key", "keyctl", "request_key",
    # the kernel's less trodden ways
    "bpf", "perf_event_open", "userfaultfd", "io_uring_setup", "io_uring_enter", "io_uring_register", "init_module",
    "finit_module", "delete_module", "kexec_load", "kexec_file_load", "reboot", "syslog", "acct", "personality",
    "fanotify_init", "settimeofday", "clock_settime", "adjtimex", "sethostname", "setdomainname",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Terms:
    """On what terms a student's process runs.

    Attributes
    ----------
    level : str
    given : str
        Folder of the files that it starts with.
    folder : str
        The work folder, its own and empty: whatever it does there, the next process starts as this one did.
    limits : mapping
        Of the operating system, by name.
    processes, memory_bytes, disk_bytes : int
        What its processes, and its files in the folder, may come to together, where nothing else holds them to it.
    first : int
        First process of the sandbox to step into; 0 where there is none.
    own_user_namespace : bool
        Whether the sandbox has one.
    user : int
        User to become; 0 to stay who one is.
    """

    level: str
    given: str
    folder: str
    limits: Mapping[str, int]
    processes: int
    memory_bytes: int
    disk_bytes: int
    first: int = 0
    own_user_namespace: bool = False
    user: int = 0


def shield() -> None:
    """Keep the parent's memory from its children, take in their orphans, and do once what every child needs."""
    if sys.platform != "linux":
        return
    _prctl(_PR_SET_DUMPABLE, 0)
    _prctl(_PR_SET_CHILD_SUBREAPER, 1)
    with contextlib.suppress(ImportError, OSError):
        import landlockpy

        landlockpy.abi_version()
        _files_in_reach()


def settle_in(terms: Terms, call_filter: Any) -> None:
    """Become a student's process: in its sandbox, in its folder, with nothing inherited but descriptor 3.

    Where there is a sandbox, the caller stays behind as the messenger of how the process ended, and never returns.
    """
    os.setsid()
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    null = os.open(os.devnull, os.O_RDWR)
    for descriptor in (0, 1, 2):
        os.dup2(null, descriptor)
    files = _read_files(Path(terms.given))
    if terms.first:
        _step_inside(terms.first, terms.own_user_namespace)
    os.closerange(4, _most_descriptors())
    if terms.own_user_namespace:
        _mount(TMP, f"nr_inodes={_MOST_FILES}")
    if terms.user:
        _become(terms.user, None if terms.first else terms.folder)
    if sys.platform == "linux":
        _drop_capabilities()
        _prctl(_PR_SET_NO_NEW_PRIVS, 1)
    os.chdir(terms.folder)
    for name, content in files.items():
        Path(name).write_bytes(content)
    _forget_where_we_are(terms.folder)
    take_limits(terms.limits)
    if terms.level == "landlock":
        _confine_files(terms.folder)
    if call_filter is not None:
        call_filter.load()


def make_call_filter(protected: tuple[int, ...]) -> Any:
    """The filter of system calls, ready to be loaded; None where there is no binding or no support for it.

    Parameters
    ----------
    protected : tuple of int
        Processes that must not get signals: the parent and the grader, where they can be seen.
    """
    if sys.platform != "linux":
        return None
    try:
        import seccompy
    except ImportError:
        return None
    if not seccompy.supported():
        return None
    chosen = seccompy.Filter(seccompy.Action.ALLOW)
    wide = _X32 if seccompy.arch() == "x86_64" else 0

    def refuse(name: str, error: int = errno.EPERM, args: Any = None) -> None:
        try:
            number = seccompy.syscall_nr(name)
        except (KeyError, ValueError, OSError):  # not on this architecture
            return
        chosen.errno(number, error, args=args)
        if wide:
            chosen.errno(number | wide, error, args=args)

    for name in _NO_CALLS:
        refuse(name)
    masked, different = seccompy.CmpOp.MASKED_EQ, seccompy.CmpOp.NE
    refuse("socket", errno.EACCES)  # pairs of sockets stay: they lead nowhere else
    refuse("clone3", errno.ENOSYS)  # its flags are out of a filter's sight; callers fall back on clone
    for flag in (_CLONE_NEWUSER, _CLONE_NEWNS, _CLONE_NEWUTS, _CLONE_NEWIPC, _CLONE_NEWPID, _CLONE_NEWNET, 0x2000000):
        refuse("clone", args=[(0, masked, flag, flag)])
    refuse("prlimit64", args=[(0, different, 0)])
    for process in protected:
        for target in (process, -process):
            low = target & 0xFFFFFFFF
            refuse("kill", args=[(0, masked, low, 0xFFFFFFFF)])
            refuse("tkill", args=[(0, masked, low, 0xFFFFFFFF)])
            refuse("tgkill", args=[(0, masked, low, 0xFFFFFFFF)])
    if protected:
        refuse("kill", args=[(0, masked, 0xFFFFFFFF, 0xFFFFFFFF)])  # -1: everybody
    _ = chosen.program  # assembled once, before the forks
    return chosen


def _step_inside(first: int, own_user_namespace: bool) -> None:
    """Enter the namespaces of a sandbox; what goes on is a child of the caller, who tells how it ended."""
    descriptor = os.pidfd_open(first)
    wanted = _NAMESPACES | (_CLONE_NEWUSER if own_user_namespace else 0)
    if _libc().setns(descriptor, wanted) != 0:
        raise OSError(ctypes.get_errno(), "the sandbox cannot be entered")
    os.close(descriptor)
    child = os.fork()
    if child == 0:
        os.setsid()
        return
    os.closerange(3, _most_descriptors())
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if status < 0:
        take_limits({"RLIMIT_CORE": 0})
        with contextlib.suppress(OSError, ValueError):
            signal.signal(-status, signal.SIG_DFL)
        os.kill(os.getpid(), -status)
    os._exit(max(status, 0))


def _read_files(folder: Path) -> dict[str, bytes]:
    """The files that lie ready for a process: the record."""
    return {path.name: path.read_bytes() for path in folder.iterdir() if stat.S_ISREG(path.lstat().st_mode)}


def _become(user: int, folder: str | None) -> None:
    """Become a user that nobody else is; the work folder, empty yet, comes along."""
    if folder is not None:
        os.chown(folder, user, user)
    os.setgroups([])
    os.setresgid(user, user, user)
    os.setresuid(user, user, user)


def _drop_capabilities() -> None:
    capability = 0
    while _libc().prctl(_PR_CAPBSET_DROP, capability, 0, 0, 0) == 0:
        capability += 1
    _libc().prctl(_PR_CAP_AMBIENT, _PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0)
    header = (ctypes.c_uint32 * 2)(_CAPABILITY_VERSION_3, 0)
    if _libc().capset(header, (ctypes.c_uint32 * 6)()) != 0:
        raise OSError(ctypes.get_errno(), "capabilities cannot be given up")


def _forget_where_we_are(folder: str) -> None:
    """An environment that says nothing of this machine, and a search path that starts in the work folder."""
    threads = {name: value for name, value in os.environ.items() if name.endswith("_NUM_THREADS")}
    os.environ.clear()
    places = dict.fromkeys(("HOME", "TMPDIR", "MPLCONFIGDIR", "IPYTHONDIR"), folder)
    os.environ.update(threads | places | {"MPLBACKEND": "Agg", "LANG": "C.UTF-8", "PATH": ""})
    sys.path.insert(0, folder)


def take_limits(limits: Mapping[str, int]) -> None:
    """Take on limits of the operating system, as far as it keeps them."""
    try:
        import resource
    except ImportError:
        return
    for name, value in limits.items():
        kind = getattr(resource, name, None)
        if kind is None:
            continue
        most = resource.getrlimit(kind)[1]
        wanted = value if most == resource.RLIM_INFINITY else min(value, most)
        # a second above it: at the lower limit of time the process is told apart from one that was killed
        above = wanted + 1 if name == "RLIMIT_CPU" and wanted != most else wanted
        with contextlib.suppress(ValueError, OSError):  # not every system keeps every limit
            resource.setrlimit(kind, (wanted, above))


def _confine_files(folder: str) -> None:
    """Landlock: read the interpreter and its libraries, write the work folder, signal nobody outside."""
    from landlockpy import AccessFS, Ruleset, Scope

    read, names = AccessFS.READ_FILE, AccessFS.READ_DIR
    with Ruleset(scoped=Scope.SIGNAL | Scope.ABSTRACT_UNIX_SOCKET) as rules:
        for path, access in _files_in_reach():
            rules.allow_path(path, {"file": read, "names": names, "folder": read | names}[access])
        for device in ("null", "zero", "random", "urandom"):
            rules.allow_path(f"/dev/{device}", read | AccessFS.WRITE_FILE)
        rules.allow_path(folder, ~(AccessFS.EXECUTE | AccessFS.MAKE_SOCK | AccessFS.MAKE_CHAR | AccessFS.MAKE_BLOCK))
        rules.restrict()


@functools.cache
def _files_in_reach() -> tuple[tuple[str, str], ...]:
    """What may be read, and whether it is a file, a folder, or the names in a folder."""
    found: list[tuple[str, str]] = []
    shut = allowed_paths.own_packages()
    for tree in allowed_paths.trees():
        parts = list(allowed_paths.without(tree, shut))
        if parts != [tree]:
            found.append((str(tree), "names"))  # the import system lists a folder before it opens what is in it
        found += [(str(part), "folder" if part.is_dir() else "file") for part in parts]
    found += [(str(path), "folder" if path.is_dir() else "file") for path in allowed_paths.allowed_of_labsid()]
    return tuple(found)


def _mount(folder: str, options: str) -> None:
    """Set an option of the file system that the sandbox writes to."""
    flags = _MS_REMOUNT | _MS_NOSUID | _MS_NODEV
    _libc().mount(None, folder.encode(), None, ctypes.c_ulong(flags), options.encode())


def _most_descriptors() -> int:
    import resource

    most = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    return 1 << 20 if most == resource.RLIM_INFINITY else most


def _prctl(option: int, value: int) -> None:
    if _libc().prctl(option, value, 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), f"prctl {option}")


@functools.cache
def _libc() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)
