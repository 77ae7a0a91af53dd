"""Ending, hanging, multiplying, growing: what student code does to its process, and to those around it."""

from attacks import FIRST, FUNCTION, MATRIX, NOISE, SECOND, Attack

_LEFT = "import ctypes\nctypes.CDLL(None).prctl(15, HERE['mark'].encode(), 0, 0, 0)\n"
_DETACH = "import os, time\nif os.fork() == 0:\n    os.setsid()\n    if os.fork() == 0:\n{}    os._exit(0)\n"
_COSTS_ITSELF = "only the question in whose cell the process is lost"

ATTACKS = (
    Attack("exit", _COSTS_ITSELF, {NOISE: "import os\nos._exit(0)"}, loses=(NOISE,), said="ended with exit status 0"),
    Attack("recursion", _COSTS_ITSELF, {NOISE: "def f():\n    f()\nf()"}, loses=(NOISE,), said="RecursionError"),
    Attack(
        "recursion without a limit",
        _COSTS_ITSELF,
        {NOISE: "import sys\nsys.setrecursionlimit(2**31 - 1)\nclass A:\n    def __repr__(self):\n"
                "        return repr([self])\nrepr(A())"},
        loses=(NOISE,),
        said="SIGSEGV|MemoryError|RecursionError",
    ),
    Attack(
        "segmentation fault",
        _COSTS_ITSELF,
        {NOISE: "import ctypes\nctypes.string_at(0)"},
        loses=(NOISE,),
        said="SIGSEGV",
    ),
    Attack("endless loop", _COSTS_ITSELF, {NOISE: "while True:\n    pass"}, loses=(NOISE,), said="took longer than"),
    Attack(
        "endless function",
        "the function's own question",
        {FUNCTION: "import time\ndef cut_off(data, n):\n    time.sleep(999)"},
        loses=(FUNCTION,),
        said="took longer than",
    ),
    Attack(
        "deaf to signals",
        _COSTS_ITSELF,
        {NOISE: "import signal, time\nfor number in set(signal.Signals) - {signal.SIGKILL, signal.SIGSTOP}:\n"
                "    signal.signal(number, signal.SIG_IGN)\ntime.sleep(999)"},
        loses=(NOISE,),
        said="took longer than",
    ),
    Attack(
        "swallows every exception",
        _COSTS_ITSELF,
        {NOISE: "import time\nwhile True:\n    try:\n        time.sleep(999)\n    except BaseException:\n        pass"},
        loses=(NOISE,),
        said="took longer than",
    ),
    Attack(
        "time-outs spread over many cells",
        "all of a notebook has one time limit, so what comes after the sleepers is not run any more",
        extras={MATRIX: ("import time\ntime.sleep(999)",) * 40},
        loses=(MATRIX, FUNCTION, FIRST, SECOND),
        said="took longer than",
    ),
    Attack(
        "a hundred cells",
        "so many are not run, and what comes after them is not answered",
        extras={MATRIX: ("1",) * 100},
        loses=(MATRIX, FUNCTION, FIRST, SECOND),
        said="more than 60 cells",
    ),
    Attack(
        "2 GB of memory",
        "memory of a process is limited",
        {NOISE: "block = bytearray(2 << 30)\ny1 = y2 = t"},
        loses=(NOISE,),
        said="MemoryError",
    ),
    Attack(
        "limits taken off",
        "a hard limit cannot be raised",
        {NOISE: "import resource\nfor kind in (resource.RLIMIT_AS, resource.RLIMIT_NPROC, resource.RLIMIT_CPU):\n"
                "    resource.setrlimit(kind, (resource.RLIM_INFINITY,) * 2)"},
        loses=(NOISE,),
        said="ValueError|PermissionError|OSError",
    ),
    Attack(
        "detached process",
        "the answers are right; what is left running ends with the submission",
        extras={NOISE: (_DETACH.format("".join(f"        {line}\n" for line in _LEFT.splitlines())
                        + "        time.sleep(600)\n"),)},
    ),
    Attack(
        "200 forks",
        "processes are limited",
        {NOISE: "import os, time\nfor _ in range(200):\n    if os.fork() == 0:\n        time.sleep(600)\n"
                "        os._exit(0)\ntime.sleep(600)"},
        loses=(NOISE,),
        said="started more than|BlockingIOError|took longer than",
    ),
    Attack(
        "threads that go on",
        "the answers are right, and the threads end with the process",
        extras={NOISE: ("import threading, time\ndef go_on():\n    while True:\n        time.sleep(0.01)\n"
                        "for _ in range(10):\n    threading.Thread(target=go_on).start()",)},
    ),
    Attack(
        "exit handlers",
        "the answers are right, and the handlers never run",
        extras={SECOND: ("import atexit, time\natexit.register(time.sleep, 600)",)},
    ),
    Attack(
        "signals to parent, grader and everybody",
        _COSTS_ITSELF,
        {NOISE: "import os, signal\nfor pid in (os.getppid(), HERE['grader'], HERE['parent'], -1, 0):\n    try:\n"
                "        if pid > 1 or pid == -1:\n            os.kill(pid, signal.SIGKILL)\n"
                "            os.killpg(pid, signal.SIGKILL)\n"
                "    except OSError:\n        pass\nos._exit(1)"},
        loses=(NOISE,),
        said="did not finish",
    ),
    Attack(
        "traces its parent",
        "neither the system call nor the memory file is to be had",
        {NOISE: "import ctypes, os\nfor pid in (os.getppid(), HERE['grader'], HERE['parent']):\n"
                "    for request in (16, 0x4206):\n        assert ctypes.CDLL(None).ptrace(request, pid, 0, 0) != 0\n"
                "    open(f'/proc/{pid}/mem', 'r+b').close()"},
        loses=(NOISE,),
        said="PermissionError|FileNotFoundError",
    ),
    Attack(
        "takes its folder away",
        "only the question in whose cell it happens: no later step needs the folder",
        {NOISE: "import os, shutil\nhere = os.getcwd()\nfor do in (lambda: shutil.rmtree(here),\n"
                "           lambda: os.rename(here, here + '-gone'), lambda: os.chmod('.', 0)):\n"
                "    try:\n        do()\n    except OSError:\n        pass\nos._exit(1)"},
        loses=(NOISE,),
        said="exit status 1",
    ),
    Attack(
        "a tree too deep to remove",
        "the answers are right; the tree goes with the folder",
        extras={NOISE: ("import os\nhere = os.getcwd()\nfor _ in range(1200):\n    os.mkdir('d')\n    os.chdir('d')\n"
                        "os.chdir(here)",)},
    ),
    Attack(
        "a file of 16 MB",
        "a file has a limit",
        {NOISE: "with open('large', 'wb') as file:\n    file.write(bytes(16 << 20))\ny1 = y2 = t"},
        loses=(NOISE,),
        said="OSError",
    ),
    Attack(
        "environment of the processes to come",
        "nothing of it reaches another process: a crash and the process after it are as ever",
        {NOISE: "import os\nos.environ.update(LD_PRELOAD='/x', PYTHONPATH='/x', PATH='/x', PYTHONSTARTUP='/x',\n"
                "                  HOME='/', TMPDIR='/')\nos.environ.clear()\nos._exit(1)"},
        loses=(NOISE,),
        said="exit status 1",
    ),
    Attack(
        "its answer shadows modules that are imported later",
        "the search path starts in the work folder of this submission alone, and everything is loaded before",
        {NOISE: "for name in ('json', 'struct', 'numpy', 'base64', 'sitecustomize'):\n"
                "    open(f'{name}.py', 'w').write('raise SystemExit')\nimport os\nos._exit(1)"},
        loses=(NOISE,),
        said="exit status 1",
    ),
)  # fmt: skip
