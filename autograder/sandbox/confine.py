"""Confinement of a forked process before it runs student code: sandbox, limits, privileges and system calls.

bubblewrap provides the namespaces, Landlock the file rules and seccomp the filter of system calls, the last two through
packaged bindings. This module applies them in the right order and closes the gaps between them.
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

from autograder.sandbox import allowed_paths
from autograder.sandbox.bubblewrap import TMP

_PR_SET_DUMPABLE, _PR_CAPBSET_DROP, _PR_SET_NO_NEW_PRIVS = 4, 24, 38
_PR_SET_CHILD_SUBREAPER, _PR_CAP_AMBIENT, _PR_CAP_AMBIENT_CLEAR_ALL = 36, 47, 4
_CAPABILITY_VERSION_3 = 0x20080522
_CLONE_NEWUSER = 0x10000000
_CLONE_NEWNS, _CLONE_NEWUTS, _CLONE_NEWIPC, _CLONE_NEWPID, _CLONE_NEWNET = (
    0x20000, 0x4000000, 0x8000000, 0x20000000, 0x40000000,
)  # fmt: skip
_NAMESPACES = _CLONE_NEWNS | _CLONE_NEWUTS | _CLONE_NEWIPC | _CLONE_NEWPID | _CLONE_NEWNET
_MS_NOSUID, _MS_NODEV, _MS_REMOUNT = 2, 4, 32
_MAX_FILES = 10_000
_SIGNAL_ABI = 6  # version of Landlock
_X32 = 0x40000000  # offset of the x32 ABI, which repeats every call on x86-64 kernels

_FORBIDDEN_CALLS = (
    # other namespaces, other file systems
    "unshare", "setns", "mount", "umount2", "pivot_root", "chroot", "open_tree", "move_mount", "fsopen", "fsconfig",
    "fsmount", "fspick", "mount_setattr", "open_by_handle_at", "name_to_handle_at", "quotactl", "swapon", "swapoff",
    # other processes
    "ptrace", "process_vm_readv", "process_vm_writev", "process_madvise", "kcmp", "pidfd_open", "pidfd_getfd",
    "pidfd_send_signal", "rt_sigqueueinfo", "rt_tgsigqueueinfo",
    # other programs: a new Python interpreter would run without the import hook that blocks the reference
    "execve", "execveat",
    # locks and watches on files that several sandboxes read: they pass messages between two that run at a time
    "flock", "inotify_init", "inotify_init1", "inotify_add_watch",
    # memory that no limit counts and that may outlive its process
    "memfd_create", "memfd_secret", "shmget", "msgget", "semget", "mq_open", "add_key", "keyctl", "request_key",
    # rarely used parts of the kernel
    "bpf", "perf_event_open", "userfaultfd", "io_uring_setup", "io_uring_enter", "io_uring_register", "init_module",
    "finit_module", "delete_module", "kexec_load", "kexec_file_load", "reboot", "syslog", "acct", "personality",
    "fanotify_init", "settimeofday", "clock_settime", "adjtimex", "sethostname", "setdomainname",
)  # fmt: skip

_MODE_CALLS = ("chmod", "fchmod", "fchmodat", "fchmodat2", "utime", "utimes", "utimensat", "futimesat")
"""Calls that change the mode or time of a file: without effect outside a sandbox, because Landlock does not restrict
them. They appear to succeed, since `shutil.copy` and others use them on the student's own files."""

_OWNER_CALLS = (
    "chown", "fchown", "lchown", "fchownat", "setxattr", "lsetxattr", "fsetxattr", "setxattrat", "removexattr",
    "lremovexattr", "fremovexattr", "removexattrat", "file_setattr",
)  # fmt: skip
"""Calls that change the owner or attributes of a file: refused outside a sandbox."""

_LOCKING_COMMANDS = (5, 6, 7, 36, 37, 38, 1024, 1025, 1026)
"""Commands of fcntl: get and set locks (5 to 7, those of open files 36 to 38) and leases (1024, 1025), watch (1026)."""

_FS_IOC_SETFLAGS, _FS_IOC_FSSETXATTR = 0x40086602, 0x401C5820


@dataclass(frozen=True, slots=True)
class ProcessSettings:
    """Settings of a student process.

    Attributes
    ----------
    level : str
        Isolation level.
    input_folder : str
        The files to copy into the work folder.
    workdir : str
        The work folder, new and empty for each process.
    rlimits : mapping
        Limits of the operating system, by name.
    processes, memory_bytes, disk_bytes : int
        Limits of the whole process group and its files, enforced by the fork server.
    sandbox_pid : int
        Init process of the sandbox to enter; 0 without a sandbox.
    own_user_namespace : bool
        Whether the sandbox has a user namespace.
    user_id : int
        User to switch to; 0 to keep the user.
    """

    level: str
    input_folder: str
    workdir: str
    rlimits: Mapping[str, int]
    processes: int
    memory_bytes: int
    disk_bytes: int
    sandbox_pid: int = 0
    own_user_namespace: bool = False
    user_id: int = 0


def hide_memory() -> None:
    """Close this process's memory to others of the same user, such as student processes without isolation."""
    if sys.platform == "linux":
        _prctl(_PR_SET_DUMPABLE, 0)


def prepare_fork_server() -> None:
    """Hide the fork server's memory from its children, adopt their orphans, and cache what every child needs."""
    hide_memory()
    if sys.platform != "linux":
        return
    _prctl(_PR_SET_CHILD_SUBREAPER, 1)
    with contextlib.suppress(ImportError, OSError):
        import landlockpy

        landlockpy.abi_version()
        _readable_paths()


def confine_process(settings: ProcessSettings, syscall_filter: Any) -> None:
    """Confine this process: enter the sandbox and work folder, close every descriptor above 3, and drop privileges.

    With a sandbox, the calling process never returns: its child continues in the sandbox, and the caller exits with the
    child's status.
    """
    os.setsid()
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    null = os.open(os.devnull, os.O_RDWR)
    for descriptor in (0, 1, 2):
        os.dup2(null, descriptor)
    files = _read_files(Path(settings.input_folder))
    if settings.sandbox_pid:
        _enter_sandbox(settings.sandbox_pid, settings.own_user_namespace)
    os.closerange(4, _max_descriptors())
    if settings.own_user_namespace:
        _remount(TMP, f"nr_inodes={_MAX_FILES}")
    if settings.user_id:
        _switch_user(settings.user_id, None if settings.sandbox_pid else settings.workdir)
    if sys.platform == "linux":
        _drop_capabilities()
        _prctl(_PR_SET_NO_NEW_PRIVS, 1)
    os.chdir(settings.workdir)
    for name, content in files.items():
        Path(name).write_bytes(content)
    _reset_environment(settings.workdir)
    set_rlimits(settings.rlimits)
    if settings.level == "landlock":
        _confine_files(settings.workdir)
    elif not settings.sandbox_pid:
        _confine_signals()
    if syscall_filter is not None:
        syscall_filter.load()


def make_syscall_filter(protected: tuple[int, ...]) -> Any:
    """The filter of system calls, ready to be loaded; None if seccomp is unavailable.

    Parameters
    ----------
    protected : tuple of int
        Processes to protect from signals: the fork server and the grader, if they are visible. Files outside the work
        folder are visible then, too, and their modes, times and attributes are protected.
    """
    if sys.platform != "linux":
        return None
    try:
        import seccompy
    except ImportError:
        return None
    if not seccompy.supported():
        return None
    rules = seccompy.Filter(seccompy.Action.ALLOW)
    x32 = _X32 if seccompy.arch() == "x86_64" else 0

    def refuse(name: str, error: int = errno.EPERM, args: Any = None) -> None:
        try:
            number = seccompy.syscall_nr(name)
        except (KeyError, ValueError, OSError):  # not available on this architecture
            return
        rules.errno(number, error, args=args)
        if x32:
            rules.errno(number | x32, error, args=args)

    for name in _FORBIDDEN_CALLS:
        refuse(name)
    masked, different = seccompy.CmpOp.MASKED_EQ, seccompy.CmpOp.NE
    refuse("socket", errno.EACCES)  # socketpair stays allowed: it reaches no other process
    refuse("clone3", errno.ENOSYS)  # a filter cannot read its flags; callers fall back on clone
    for flag in (_CLONE_NEWUSER, _CLONE_NEWNS, _CLONE_NEWUTS, _CLONE_NEWIPC, _CLONE_NEWPID, _CLONE_NEWNET, 0x2000000):
        refuse("clone", args=[(0, masked, flag, flag)])
    for command in _LOCKING_COMMANDS:
        refuse("fcntl", args=[(1, masked, command, 0xFFFFFFFF)])
    refuse("prlimit64", args=[(0, different, 0)])
    for process in protected:
        for target in (process, -process):
            low = target & 0xFFFFFFFF
            refuse("kill", args=[(0, masked, low, 0xFFFFFFFF)])
            refuse("tkill", args=[(0, masked, low, 0xFFFFFFFF)])
            refuse("tgkill", args=[(0, masked, low, 0xFFFFFFFF)])
    if protected:
        for name in _MODE_CALLS:
            refuse(name, 0)
        for name in _OWNER_CALLS:
            refuse(name)
        for request in (_FS_IOC_SETFLAGS, _FS_IOC_FSSETXATTR):
            refuse("ioctl", args=[(1, masked, request, 0xFFFFFFFF)])
        refuse("kill", args=[(0, masked, 0xFFFFFFFF, 0xFFFFFFFF)])  # -1: every process
    _ = rules.program  # assembled once, before forking
    return rules


def _enter_sandbox(sandbox_pid: int, own_user_namespace: bool) -> None:
    """Enter the namespaces of a sandbox and continue in a child; the caller exits with the child's status."""
    descriptor = os.pidfd_open(sandbox_pid)
    namespaces = _NAMESPACES | (_CLONE_NEWUSER if own_user_namespace else 0)
    if _libc().setns(descriptor, namespaces) != 0:
        raise OSError(ctypes.get_errno(), "the sandbox cannot be entered")
    os.close(descriptor)
    child = os.fork()
    if child == 0:
        os.setsid()
        return
    os.closerange(3, _max_descriptors())
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if status < 0:
        set_rlimits({"RLIMIT_CORE": 0})
        with contextlib.suppress(OSError, ValueError):
            signal.signal(-status, signal.SIG_DFL)
        os.kill(os.getpid(), -status)
    os._exit(max(status, 0))


def _read_files(folder: Path) -> dict[str, bytes]:
    """The regular files of a folder: the student's data files."""
    return {path.name: path.read_bytes() for path in folder.iterdir() if stat.S_ISREG(path.lstat().st_mode)}


def _switch_user(user: int, folder: str | None) -> None:
    """Switch to a user of this process alone, and give it the empty work folder."""
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


def _reset_environment(folder: str) -> None:
    """Remove this machine's environment variables, and start the module search path in the work folder."""
    threads = {name: value for name, value in os.environ.items() if name.endswith("_NUM_THREADS")}
    os.environ.clear()
    folders = dict.fromkeys(("HOME", "TMPDIR", "MPLCONFIGDIR", "IPYTHONDIR"), folder)
    user = dict.fromkeys(("USER", "LOGNAME"), "student")  # getpass.getuser() cannot read the list of users
    os.environ.update(threads | folders | user | {"MPLBACKEND": "Agg", "LANG": "C.UTF-8", "PATH": ""})
    sys.path.insert(0, folder)


def set_rlimits(limits: Mapping[str, int]) -> None:
    """Set the limits that this operating system supports."""
    try:
        import resource
    except ImportError:
        return
    for name, value in limits.items():
        kind = getattr(resource, name, None)
        if kind is None:
            continue
        maximum = resource.getrlimit(kind)[1]
        soft = value if maximum == resource.RLIM_INFINITY else min(value, maximum)
        # a hard limit one second later: the soft limit raises SIGXCPU, the hard one SIGKILL, which says nothing
        hard = soft + 1 if name == "RLIMIT_CPU" and soft != maximum else soft
        with contextlib.suppress(ValueError, OSError):  # not every system supports every limit
            resource.setrlimit(kind, (soft, hard))


def _confine_files(folder: str) -> None:
    """Landlock rules: read the interpreter and its libraries, write the work folder, signal no process outside."""
    from landlockpy import AccessFS, Ruleset, Scope

    read, names = AccessFS.READ_FILE, AccessFS.READ_DIR
    with Ruleset(scoped=Scope.SIGNAL | Scope.ABSTRACT_UNIX_SOCKET) as rules:
        for path, access in _readable_paths():
            rules.allow_path(path, {"file": read, "names": names, "folder": read | names}[access])
        for device in ("null", "zero", "random", "urandom"):
            rules.allow_path(f"/dev/{device}", read | AccessFS.WRITE_FILE)
        rules.allow_path(folder, ~(AccessFS.EXECUTE | AccessFS.MAKE_SOCK | AccessFS.MAKE_CHAR | AccessFS.MAKE_BLOCK))
        rules.restrict()


def can_confine_signals() -> bool:
    """Whether this kernel can keep a process from signalling others: Landlock since Linux 6.12."""
    try:
        import landlockpy

        return bool(landlockpy.abi_version() >= _SIGNAL_ABI)
    except (ImportError, OSError):
        return False


def _confine_signals() -> None:
    """Signal no process outside, if the kernel can prevent it."""
    if can_confine_signals():
        from landlockpy import AccessFS, Ruleset, Scope

        with Ruleset(handled_fs=AccessFS.NONE, scoped=Scope.SIGNAL | Scope.ABSTRACT_UNIX_SOCKET) as rules:
            rules.restrict()


@functools.cache
def _readable_paths() -> tuple[tuple[str, str], ...]:
    """The readable paths, each as a "file", a "folder", or a folder of which only the "names" may be listed."""
    found: list[tuple[str, str]] = []
    excluded = allowed_paths.hidden_folders()
    for path in allowed_paths.interpreter_paths():
        parts = list(allowed_paths.exclude_paths(path, excluded))
        if parts != [path]:
            found.append((str(path), "names"))  # the import system lists a folder before it opens its files
        found += [(str(part), "folder" if part.is_dir() else "file") for part in parts]
    found += [(str(path), "folder" if path.is_dir() else "file") for path in allowed_paths.allowed_labsid_paths()]
    return tuple(found)


def _remount(folder: str, options: str) -> None:
    """Set an option of the sandbox's writable file system."""
    flags = _MS_REMOUNT | _MS_NOSUID | _MS_NODEV
    _libc().mount(None, folder.encode(), None, ctypes.c_ulong(flags), options.encode())


def _max_descriptors() -> int:
    import resource

    maximum = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
    return 1 << 20 if maximum == resource.RLIM_INFINITY else maximum


def _prctl(option: int, value: int) -> None:
    if _libc().prctl(option, value, 0, 0, 0) != 0:
        raise OSError(ctypes.get_errno(), f"prctl {option}")


@functools.cache
def _libc() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)
