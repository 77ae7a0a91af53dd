"""Answers that lie: objects that compare, count or change as they like, and messages that nobody asked for."""

from attacks import CUT, FIRST, FUNCTION, NOISE, QUESTIONS, TIME, Attack

_DATA_ONLY = "the judge has the numbers that come over the channel, and nothing of the student's code"
_CHANNEL = "import os, json, struct\ndef say(payload):\n    os.write(3, struct.pack('>Q', len(payload)) + payload)\n"
_GLOBALS = (
    "import sys\nworlds = [vars(module) for name, module in list(sys.modules.items()) if name.startswith('labsid')]\n"
    "worlds += [vars(one)['find_spec'].__globals__ for one in map(type, sys.meta_path) if 'find_spec' in vars(one)\n"
    "           and hasattr(vars(one)['find_spec'], '__globals__')]\n"
    "assert any('_HANDLERS' in world for world in worlds)\n"
)


def _always(reply: str) -> str:
    """Code that answers every request for a value with `reply`."""
    found = "for world in worlds:\n    if '_HANDLERS' in world:\n        world['_HANDLERS']['value'] = lambda *a: "
    return f"{_GLOBALS}{found}{reply}\n"


ATTACKS = (
    Attack(
        "equal to everything",
        _DATA_ONLY,
        {TIME: "class Same:\n    __array_priority__ = 1e9\n    shape, ndim, size, dtype = (1001, 1), 2, 1001, float\n"
               "    def __eq__(self, other):\n        return True\n    def __array_function__(self, *a, **k):\n"
               "        return True\n    def __array_ufunc__(self, *a, **k):\n        return True\n"
               "    def __bool__(self):\n        return True\nt = Same()"},
        loses=(TIME,),
        said="an object of type Same",
    ),
    Attack(
        "an array that compares as it likes",
        _DATA_ONLY,
        {TIME: "class Same(np.ndarray):\n    def __eq__(self, other):\n        return True\n"
               "    def __array_function__(self, *a, **k):\n        return True\n    def __sub__(self, other):\n"
               "        return 0\nt = np.ones((1001, 1)).view(Same)"},
        loses=(TIME,),
    ),
    Attack(
        "assertions rebound",
        _DATA_ONLY,
        {TIME: "import numpy.testing\nfor module in (np, np.testing, np.linalg):\n"
               "    for name in ('assert_allclose', 'allclose', 'isclose', 'array_equal', 'all'):\n"
               "        if hasattr(module, name):\n            setattr(module, name, lambda *a, **k: True)\n"
               "t = np.zeros((1001, 1))"},
        loses=(TIME,),
    ),
    Attack(
        "checks changed in the process",
        "the judge's checks are in another process",
        {TIME: "import labsid.checks.compare, labsid.checks.question, labsid.checks.verdict\n"
               "labsid.checks.question.Question.verdict = lambda *a: labsid.checks.verdict.Verdict(True, 'mine')\n"
               "labsid.checks.verdict.judge = lambda *a, **k: labsid.checks.verdict.Verdict(True, 'mine')\n"
               "labsid.checks.compare.close = lambda *a, **k: lambda *a: True\nt = np.zeros((1001, 1))"},
        loses=(TIME,),
    ),
    Attack(
        "every module of the channel patched",
        "what is sent instead is an answer too, and a wrong one",
        {TIME: _GLOBALS + "for world in worlds:\n    for name in ('encode', 'plain'):\n"
               "        if name in world:\n            world[name] = lambda *a, **k: True\n"
               "t = np.zeros((1001, 1))"},
        loses=QUESTIONS,
    ),
    Attack(
        "json, struct and numpy.load patched",
        "what is sent instead is no message; every question is asked of a process in which the patch is made again",
        {TIME: "import json, struct, base64\njson.dumps = lambda *a, **k: '{\"ok\":true,\"score\":1,\"passed\":true}'\n"
               "json.loads = lambda *a, **k: {'op': 'value', 'name': 't'}\nnp.load = base64.b64decode = print\n"
               "t = np.zeros((1001, 1))"},
        loses=QUESTIONS,
    ),
    Attack(
        "a verdict in the place of a value",
        "the channel knows values alone",
        {TIME: _always("{'ok': True, 'passed': True, 'score': 9, 'value': {'!': 'Verdict', 'passed': True}}")},
        loses=QUESTIONS[:4] + QUESTIONS[5:],
    ),
    Attack(
        "lies about its size",
        "the declaration is held against the data",
        {TIME: _always(
            "{'ok': True, 'value': {'!': 'array', 'dtype': '<f8', 'shape': [1001, 1], 'data': 'AAAAAAAAAAA='}}"
        )},
        loses=QUESTIONS[:4] + QUESTIONS[5:],
    ),
    Attack(
        "lies about its kind",
        "only numbers are arrays: objects would be pickles",
        {TIME: _always(
            "{'ok': True, 'value': {'!': 'array', 'dtype': '|O8', 'shape': [1], 'data': 'AAAAAAAAAAA='}}"
        )},
        loses=QUESTIONS[:4] + QUESTIONS[5:],
    ),
    Attack(
        "right when it is asked first, easy afterwards",
        "a later step is judged on the value that was judged, not on one that is asked for again",
        {NOISE: "class Turning(list):\n    asked = 0\n    def __array__(self, *a, **k):\n        Turning.asked += 1\n"
                "        return first if Turning.asked == 1 else np.zeros(t.shape)\n"
                "first = np.sin(0.02 * np.pi * t) + rng.uniform(-0.2, 0.2, t.shape)\n"
                "y1 = Turning([1])\ny2 = np.cos(0.02 * np.pi * t) + rng.uniform(-0.2, 0.2, t.shape)",
         CUT: "t_new, y1_new, y2_new = t[200:] - t[200], np.zeros((801, 1)), y2[200:]"},
        loses=(CUT, FIRST),
    ),
    Attack(
        "not a number", "no number is close to it", {TIME: "t = np.full((1001, 1), np.nan)"}, loses=(TIME,), said="nan"
    ),
    Attack("infinite", "no number is close to it", {TIME: "t = np.full((1001, 1), np.inf)"}, loses=(TIME,)),
    Attack(
        "an integer of a million digits",
        "it is not sent",
        {TIME: "t = 1 << 4_000_000"},
        loses=(TIME,),
        said="int of too many digits",
    ),
    Attack(
        "integers of many digits in a list", "they are not sent", {TIME: "t = [10 ** 400] * 1001"}, loses=(TIME,)
    ),
    Attack(
        "no elements in more dimensions than an array of floats can have",
        "it is wrong, and is compared with nobody's record",
        {TIME: "t = np.zeros((0, 1 << 31, 1 << 31), np.int8)"},
        loses=(TIME,),
    ),
    Attack("500 MB of zeros", "it is too large to send", {TIME: "t = np.zeros((50_000_000, 1))"}, loses=(TIME,)),
    Attack(
        "data without end",
        "an answer has a time limit",
        {TIME: "class Endless(dict):\n    def items(self):\n        import time\n        time.sleep(999)\n"
               "t = Endless(a=1)"},
        loses=(TIME,),
    ),
    Attack(
        "garbage on the channel",
        "what is no message costs the process, and the cell its question",
        {TIME: "import os\nfor descriptor in range(64):\n    try:\n        os.write(descriptor, b'\\xff' * 64)\n"
               "    except OSError:\n        pass"},
        loses=(TIME,),
        said="a message longer than",
    ),
    Attack(
        "replies in advance",
        "each is taken for the answer to the next request, and is a wrong one",
        {TIME: _CHANNEL + "for _ in range(9):\n    say(b'{\"ok\":true,\"value\":1,\"stdout\":\"\",\"figures\":[]}')"},
        loses=QUESTIONS,
    ),
    Attack(
        "a message that never ends",
        "a message has the time limit of its request",
        {TIME: "import os, struct\nos.write(3, struct.pack('>Q', 60 << 20) + b'[')\nimport time\ntime.sleep(999)"},
        loses=(TIME,),
        said="took longer",
    ),
    Attack(
        "nested without end",
        "what cannot be read is no message",
        {TIME: _CHANNEL + "say(b'[' * 100_000)"},
        loses=(TIME,),
        said="not a message",
    ),
    Attack(
        "nested as far as it can be read",
        "a reply's parts are read whatever they are; the process ends again each time that the cells are gone through",
        {TIME: _CHANNEL + "for depth in (200, 400, 600, 800, 900, 940, 960, 970, 980, 990):\n"
               "    say(b'{\"ok\":true,\"stdout\":' + b'[' * depth + b']' * depth + b'}')\nos._exit(1)"},
        loses=QUESTIONS,
    ),
    Attack(
        "a message that unpacks to twenty times its size",
        "so many lists are no message, and are not made",
        {TIME: _CHANNEL + "payload = memoryview(b'{\"ok\":true,\"value\":[' + b'[],' * (6 << 20) + b'[]]}')\n"
               "os.write(3, struct.pack('>Q', len(payload)))\nwhile payload:\n"
               "    payload = payload[os.write(3, payload):]"},
        loses=(TIME,),
        said="not a message",
    ),
    Attack(
        "the channel closed", "the process counts as lost", {TIME: "import os\nos.closerange(3, 64)"}, loses=(TIME,)
    ),
    Attack(
        "an input transformer that swallows checks",
        "no check is ever sent to the process",
        {TIME: "t = np.zeros((1001, 1))\nget_ipython().input_transformers_cleanup.append(\n"
               "    lambda lines: [line for line in lines if 'check' not in line and 'assert' not in line])"},
        loses=(TIME,),
    ),
    Attack(
        "constants of the check that ran in the notebook",
        "the judge tries a function on inputs of its own",
        {FUNCTION: "def cut_off(data, n):\n    seen = {17: 0.25, 40: 0.75}\n    rest = np.zeros((303, 3))\n"
                   "    rest[:, 0] = seen.get(n, 0.05) * np.arange(303)\n    return rest"},
        loses=(FUNCTION,),
    ),
    Attack(
        "hidden inputs kept, printed, drawn, written and raised",
        "a function is called when nothing that the student sees comes after",
        {FUNCTION: "import sys\nkept = []\ndef tell():\n    print(kept)\n"
                   "    for name in ('kept', '/tmp/labsid-kept'):\n"
                   "        try:\n            print(open(name).read())\n        except OSError:\n            pass\n"
                   "def cut_off(data, n):\n    kept.append(repr(data.tolist()))\n    tell()\n    plt.plot(data)\n"
                   "    open('kept', 'w').write(kept[0])\n    raise ValueError(kept[0])"},
        extras={FUNCTION: ("tell()",), "prelab-6-cut-off": ("tell()\nraise ValueError(str(kept))",)},
        loses=(FUNCTION,),
        said="ValueError",
    ),
    Attack(
        "right values of a failed step printed",
        "the step itself earns nothing; what is printed of the right values is held in a test of its own",
        {NOISE: "pass"},
        extras={CUT: ("print(y1.ravel().tolist()[:50])",)},
        loses=(NOISE,),
    ),
    Attack(
        "hidden inputs traced",
        "a function is called when nothing that the student sees comes after",
        {FUNCTION: "import sys\nkept = []\ndef look(frame, event, arg):\n    if 'data' in frame.f_locals:\n"
                   "        kept.append(repr(frame.f_locals['data']))\n    print(kept)\n    return look\n"
                   "def cut_off(data, n):\n    return data\nsys.settrace(look)"},
        extras={FUNCTION: ("sys.settrace(None)\nprint(kept)",)},
        loses=(FUNCTION,),
    ),
)  # fmt: skip
