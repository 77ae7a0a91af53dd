"""Reaching for what is not the student's: the reference, the solution, other students, the gradebook, the network."""

from attacks import FIRST, FUNCTION, SECOND, TIME, Attack

_FILES = "without isolation every file of this machine can be read that the grader's user can read"
_USE = (
    "def cut_off(data, n):\n    made = found(Sinusoids(data[:, :1], data[:, 1:2], data[:, 2:]), n)\n"
    "    return np.hstack([made.t_new, made.y1_new, made.y2_new])\n"
)
_REFUSED = "is the reference|No module named|has no attribute|cannot import|stopped"

ATTACKS = (
    Attack(
        "imports the reference",
        "it is refused, and said to be the reference",
        {FUNCTION: "from labsid.lab.sinusoid import Sinusoids, cut_off as found\n" + _USE},
        loses=(FUNCTION,),
        said="labsid.lab is the reference: it cannot be used",
    ),
    Attack(
        "imports the reference by its name as text",
        "it is refused, and said to be the reference",
        {FUNCTION: "import importlib\nmodule = importlib.import_module('labsid.lab.sinusoid')\n"
                   "Sinusoids, found = module.Sinusoids, module.cut_off\n" + _USE},
        loses=(FUNCTION,),
        said="labsid.lab is the reference: it cannot be used",
    ),
    Attack(
        "takes the reference from sys.modules",
        "it was never loaded here",
        {FUNCTION: "import sys, labsid\nmodule = sys.modules.get('labsid.lab.sinusoid') or labsid.lab.sinusoid\n"
                   "Sinusoids, found = module.Sinusoids, module.cut_off\n" + _USE},
        loses=(FUNCTION,),
        said=_REFUSED,
    ),
    Attack(
        "takes the guard off the import system",
        "the file is not in its sight",
        {FUNCTION: "import sys, importlib\nsys.meta_path[:] = [one for one in sys.meta_path if isinstance(one, type)]\n"
                   "module = importlib.import_module('labsid.lab.sinusoid')\n"
                   "Sinusoids, found = module.Sinusoids, module.cut_off\n" + _USE},
        loses=(FUNCTION,),
        said=_REFUSED,
        open_on_none=_FILES,
    ),
    Attack(
        "runs the source of the reference",
        "the file is not in its sight",
        {FUNCTION: "import os, labsid\nnames = {}\n"
                   "exec(open(os.path.join(labsid.__path__[0], 'lab', 'sinusoid.py')).read(), names)\n"
                   "Sinusoids, found = names['Sinusoids'], names['cut_off']\n" + _USE},
        loses=(FUNCTION,),
        said="FileNotFoundError|PermissionError",
        open_on_none=_FILES,
    ),
    Attack(
        "looks for the reference in frames and in the garbage collector",
        "the process and its parent never held it",
        {FUNCTION: "import gc, sys, inspect\nseen = []\nframe = sys._getframe()\nwhile frame:\n"
                   "    seen += [*frame.f_globals.values(), *frame.f_locals.values()]\n    frame = frame.f_back\n"
                   "seen += gc.get_objects()\n"
                   "named = [it for it in seen if inspect.isfunction(it) and it.__name__ == 'cut_off'\n"
                   "         and it.__module__.startswith('labsid')]\n"
                   "kinds = [it for it in seen if inspect.isclass(it) and it.__name__ == 'Sinusoids']\n"
                   "found, Sinusoids = named[0], kinds[0]\n" + _USE},
        loses=(FUNCTION,),
        said="IndexError",
    ),
    Attack(
        "looks for the judge's secret and verdicts in memory",
        "the process and its parent never held them",
        {TIME: "import gc\nfor it in gc.get_objects():\n    kind = type(it).__name__\n"
               "    if kind in ('Assets', 'Question', 'Verdict') or type(it) is dict and it is not HERE and any(\n"
               "        one in (HERE['secret'], HERE['secret'].encode()) for one in it.values()\n"
               "        if isinstance(one, (str, bytes))\n    ):\n"
               "        t = np.linspace(0, 100, 1001).reshape(-1, 1)"},
        loses=(TIME,),
        said="There is no variable `t`",
    ),
    Attack(
        "draws the figure with the reference",
        "it is refused, and said to be the reference",
        {FIRST: "from labsid import plots\nfig_1 = plots.figure_1(None)"},
        loses=(FIRST, SECOND),
        said="labsid.plots.lab is the reference: it cannot be used",
    ),
    Attack(
        "imports the rig with what is withheld of it",
        "it is refused, and said to be the reference",
        {TIME: "from labsid.rig.switchable import withheld\nt = np.linspace(0, 100, 1001).reshape(-1, 1)"},
        loses=(TIME,),
        said="is the reference: it cannot be used",
    ),
    Attack(
        "reads the rig with what is withheld of it",
        "the file is not in its sight",
        {TIME: "import os, labsid\nopen(os.path.join(labsid.__path__[0], 'rig', 'switchable', 'withheld.py')).read()\n"
               "t = np.linspace(0, 100, 1001).reshape(-1, 1)"},
        loses=(TIME,),
        said="FileNotFoundError|PermissionError",
        open_on_none=_FILES,
    ),
    Attack(
        "reads the solution",
        "the course is not in its sight",
        {TIME: "import json\nfor cell in json.load(open(HERE['solution']))['cells']:\n"
               "    if cell.get('id') == 'prelab-1-time-answer':\n        exec(''.join(cell['source']))"},
        loses=(TIME,),
        said="FileNotFoundError|PermissionError",
        open_on_none=_FILES,
    ),
    Attack(
        "reads another submission",
        "other hand-ins are not in its sight",
        {TIME: "import json\nfor cell in json.load(open(HERE['other']))['cells']:\n"
               "    if cell.get('id') == 'prelab-1-time-answer':\n        exec(''.join(cell['source']))"},
        loses=(TIME,),
        said="FileNotFoundError|PermissionError",
        open_on_none=_FILES,
    ),
    Attack(
        "writes to the gradebook",
        "it is not in its sight",
        {TIME: "import sqlite3\nbook = sqlite3.connect(HERE['gradebook'])\n"
               "book.execute('UPDATE grade SET score = 12')\nbook.commit()\n"
               "t = np.linspace(0, 100, 1001).reshape(-1, 1)"},
        loses=(TIME,),
        said="OperationalError",
        spares="gradebook",
        open_on_none=_FILES,
    ),
    Attack(
        "leaves a file for the next submission",
        "there is no place that two submissions share",
        {TIME: "open(HERE['shared'], 'w').write('5')\n"
               "t = np.linspace(0, 100, 1001).reshape(-1, 1)"},
        loses=(TIME,),
        said="FileNotFoundError|PermissionError|OSError",
        spares="left",
        open_on_none=_FILES,
    ),
    Attack(
        "links out of its folder",
        "a link leads where the process could not go either",
        {TIME: "import os\nos.symlink(HERE['gradebook'], 'book')\nopen('book', 'a').write('5')\n"
               "t = np.linspace(0, 100, 1001).reshape(-1, 1)"},
        loses=(TIME,),
        said="FileNotFoundError|PermissionError|OSError",
        spares="gradebook",
        open_on_none=_FILES,
    ),
    Attack(
        "asks over the network (TCP on loopback)",
        "there is none",
        {TIME: "import socket\nsocket.create_connection(('127.0.0.1', HERE['port']), 2).close()\n"
               "t = np.linspace(0, 100, 1001).reshape(-1, 1)"},
        loses=(TIME,),
        said="PermissionError|OSError|ConnectionRefusedError",
        spares="listener",
    ),
    Attack(
        "tells over the network (UDP on loopback)",
        "there is none",
        {TIME: "import socket\nsocket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(b'x', ('127.0.0.1', "
               "HERE['port']))\nt = np.linspace(0, 100, 1001).reshape(-1, 1)"},
        loses=(TIME,),
        said="PermissionError|OSError",
    ),
    Attack(
        "runs another program",
        "it cannot become another program",
        {TIME: "import subprocess, sys\n"
               "subprocess.run([sys.executable, '-c', 'import labsid.lab.sinusoid'], check=True)\n"
               "t = np.linspace(0, 100, 1001).reshape(-1, 1)"},
        loses=(TIME,),
        said="Error",
    ),
)  # fmt: skip
