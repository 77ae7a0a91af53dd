"""Answers to the pre-lab that differ from the model solution, right ones and wrong ones."""

from variants import Right, Wrong, right, wrong

TIME, NOISE, CUT = "prelab-1-time", "prelab-2-noise", "prelab-3-cut"
MATRIX, FUNCTION = "prelab-4-matrix", "prelab-4-function"
FIGURE_A, FIGURE_B = "prelab-5-original", "prelab-6-cut-off"


def sinusoids(
    y1: str = "np.sin(0.02 * np.pi * t)",
    y2: str = "np.cos(0.02 * np.pi * t)",
    noise: str = "rng.uniform(-0.2, 0.2, t.shape)",
) -> str:
    return f"y1 = {y1} + {noise}\ny2 = {y2} + {noise}\n"


def cut(t: str = "t[200:] - t[200]", y1: str = "y1[200:]", y2: str = "y2[200:]") -> str:
    return f"t_new = {t}\ny1_new = {y1}\ny2_new = {y2}\n"


def function(body: str) -> str:
    return "def cut_off(data, n):\n" + "".join(f"    {line}\n" for line in body.splitlines())


NEW_FIGURE = "fig_1, (ax_a, ax_b) = plt.subplots(2, 1)\n"
GREY_BLUE = "(0.6, 0.7, 0.8)"


def panel(
    ax: str,
    *,
    sine: str = "",
    cosine: str = "",
    limits: str = "",
    title: str = "",
    labels: str = "",
    grid: str = "",
    legend: str = "",
) -> str:
    """One panel of Fig. 1, drawn rightly but for what is replaced."""
    new = "_new" if ax == "ax_b" else ""
    t, y1, y2 = f"t{new}", f"y1{new}", f"y2{new}"
    heading = "(b) Cut-off data" if new else "(a) Original data"
    lines = (
        sine or f"{ax}.plot({t}, {y1}, color='red', label='sin(0.02πt)')",
        cosine or f"{ax}.step({t}, {y2}, where='post', color={GREY_BLUE}, label='cos(0.02πt)')",
        limits or f"{ax}.set(xlim=(0, 140), ylim=(-1.5, 1.5))",
        title or f"{ax}.set_title({heading!r})",
        labels or f"{ax}.set(xlabel='Time (s)', ylabel='Output')",
        grid or f"{ax}.grid()",
        legend or f"{ax}.legend()",
    )
    return (NEW_FIGURE if not new else "") + "\n".join(lines) + "\n"


VARIANTS: list[Right | Wrong] = [
    # 1. time
    right(TIME, "arange over whole numbers", "t = np.arange(1001)[:, None] * 0.1"),
    right(TIME, "row transposed as in MATLAB", "t = np.linspace(0, 100, 1001)[np.newaxis, :].T"),
    right(TIME, "np.c_ with an end behind 100", "t = np.c_[np.arange(0, 100.05, 0.1)]"),
    wrong(TIME, "left flat", "t = np.linspace(0, 100, 1001)", "flat instead of a column", "reshape"),
    wrong(
        TIME, "flat one transposed", "t = np.linspace(0, 100, 1001).T", "flat instead of a column", "one-dimensional"
    ),
    wrong(
        TIME,
        "a row",
        "t = np.linspace(0, 100, 1001).reshape(1, -1)",
        "a row instead of a column",
        "is a row",
    ),
    wrong(
        TIME,
        "arange stops early",
        "t = np.arange(0, 100, 0.1).reshape(-1, 1)",
        "end left out",
        "stops before 100 s",
    ),
    wrong(
        TIME,
        "a thousand points",
        "t = np.linspace(0, 100, 1000).reshape(-1, 1)",
        "1000 points",
        "count again",
    ),
    wrong(
        TIME,
        "sample numbers",
        "t = np.arange(1001).reshape(-1, 1)",
        "sample number in place of time",
        "counts the samples",
    ),
    wrong(TIME, "spacing of 1 s", "t = np.c_[0:101]", "spacing of 1 s", "steps of 1 s"),
    wrong(TIME, "zeros", "t = np.zeros((1001, 1))", None, "All of it is zero"),
    wrong(TIME, "not numbers", "t = 'np.linspace(0, 100, 1001)'", None, "it is text"),
    # 2. noise
    right(NOISE, "rand shifted and stretched", sinusoids(noise="(rng.random(t.shape) - 0.5) * 0.4")),
    right(NOISE, "the old generator", sinusoids(noise="(2 * np.random.rand(1001, 1) - 1) * 0.2")),
    right(
        NOISE,
        "a loop over samples",
        "import random\n"
        "import math\n"
        "y1, y2 = np.zeros((1001, 1)), np.zeros((1001, 1))\n"
        "for k in range(len(t)):\n"
        "    angle = 2 * math.pi / 100 * float(t[k, 0])\n"
        "    y1[k] = math.sin(angle) + random.uniform(-0.2, 0.2)\n"
        "    y2[k] = math.cos(angle) + random.uniform(-0.2, 0.2)\n",
    ),
    right(NOISE, "cosine as a shifted sine", sinusoids(y2="np.sin(2 * np.pi * t / 100 + np.pi / 2)")),
    right(
        NOISE,
        "flat signals",
        "y1, y2 = (f(0.02 * np.pi * t[:, 0]) + rng.uniform(-0.2, 0.2, len(t)) for f in (np.sin, np.cos))\n",
        {MATRIX: "data_new = np.column_stack([t_new, y1_new, y2_new])"},
    ),
    wrong(
        NOISE,
        "multiplied and added",
        "y1 = np.sin(0.02 * np.pi * t) * (1 + rng.uniform(-0.2, 0.2, t.shape))\n"
        "y2 = np.cos(0.02 * np.pi * t) * (1 + rng.uniform(-0.2, 0.2, t.shape))\n",
        "noise multiplied",
        "multiplied by the sinusoid",
    ),
    wrong(
        NOISE,
        "multiplied",
        "y1 = np.sin(0.02 * np.pi * t) * rng.uniform(-0.2, 0.2, t.shape)\n"
        "y2 = np.cos(0.02 * np.pi * t) * rng.uniform(-0.2, 0.2, t.shape)\n",
        "noise multiplied",
        "multiplied by the sinusoid",
    ),
    wrong(NOISE, "one-sided", sinusoids(noise="0.2 * rng.random(t.shape)"), "one-sided noise", "never negative"),
    wrong(
        NOISE,
        "not centred",
        sinusoids(noise="0.4 * rng.random(t.shape)"),
        "noise not centred",
        "mean is not zero",
    ),
    wrong(
        NOISE,
        "0.2 in all",
        sinusoids(noise="0.2 * (rng.random(t.shape) - 0.5)"),
        "noise of half the bound",
        "0.4 wide",
    ),
    wrong(
        NOISE,
        "bound 0.4",
        sinusoids(noise="rng.uniform(-0.4, 0.4, t.shape)"),
        "noise of twice the bound",
        "twice the bound",
    ),
    wrong(
        NOISE,
        "rand as it comes",
        sinusoids(noise="rng.random(t.shape)"),
        "noise straight from rand",
        "runs from 0 to 1",
    ),
    wrong(
        NOISE,
        "shifted only",
        sinusoids(noise="rng.random(t.shape) - 0.5"),
        "noise shifted but not scaled",
        "scale it",
    ),
    wrong(NOISE, "randn", sinusoids(noise="0.2 * rng.standard_normal(t.shape)"), "Gaussian noise", "Gaussian"),
    wrong(
        NOISE,
        "narrow Gaussian, clipped",
        sinusoids(noise="np.clip(rng.normal(0, 0.1, t.shape), -0.2, 0.2)"),
        "noise clipped at the bound",
        "clipped",
    ),
    wrong(
        NOISE,
        "the same noise in both",
        "noise = rng.uniform(-0.2, 0.2, t.shape)\n" + sinusoids(noise="noise"),
        "the same noise in both",
        "same noise",
    ),
    wrong(
        NOISE,
        "two generators of one seed",
        sinusoids(noise="np.random.default_rng(1).uniform(-0.2, 0.2, t.shape)"),
        "the same noise in both",
        "same seed",
    ),
    wrong(NOISE, "no noise", sinusoids(noise="0"), "no noise", "no noise yet"),
    wrong(
        NOISE,
        "one number for all",
        sinusoids(noise="rng.uniform(-0.2, 0.2)"),
        "one random number for all samples",
        "same random number",
    ),
    wrong(
        NOISE,
        "three values only",
        sinusoids(noise="rng.choice([-0.19, 0, 0.19], t.shape)"),
        "noise on a grid",
        "only 3 different values",
    ),
    wrong(
        NOISE,
        "a saw-tooth in place of noise",
        "y1 = np.sin(0.02 * np.pi * t) + 0.4 * (0.37 * t % 1) - 0.2\n"
        "y2 = np.cos(0.02 * np.pi * t) + rng.uniform(-0.2, 0.2, t.shape)\n",
        "noise that is not random",
        "follows from the one before",
    ),
    wrong(
        NOISE,
        "flat noise on a column",
        sinusoids(noise="rng.uniform(-0.2, 0.2, 1001)"),
        "flat noise added to a column",
        "t.shape",
    ),
    wrong(
        NOISE,
        "swapped",
        sinusoids(y1="np.cos(0.02 * np.pi * t)", y2="np.sin(0.02 * np.pi * t)"),
        "sine and cosine swapped",
        "swapped",
    ),
    wrong(
        NOISE,
        "period of 50 s",
        sinusoids(y1="np.sin(0.04 * np.pi * t)", y2="np.cos(0.04 * np.pi * t)"),
        "period of 50 s",
        "two periods",
    ),
    wrong(
        NOISE,
        "degrees",
        sinusoids(y1="np.sin(360 / 100 * t)", y2="np.cos(360 / 100 * t)"),
        "degrees instead of radians",
        "radians",
    ),
    wrong(
        NOISE,
        "frequency of 100",
        sinusoids(y1="np.sin(2 * np.pi * 100 * t)", y2="np.cos(2 * np.pi * 100 * t)"),
        "frequency in place of the period",
        "not its frequency",
    ),
    wrong(
        NOISE,
        "pi forgotten",
        sinusoids(y1="np.sin(0.02 * t)", y2="np.cos(0.02 * t)"),
        "pi forgotten",
        "pi is missing",
    ),
    wrong(
        NOISE,
        "half the amplitude",
        sinusoids(y1="0.5 * np.sin(0.02 * np.pi * t)"),
        "amplitude of a half",
        "amplitude is 0.5",
    ),
    wrong(
        NOISE,
        "wrong in y2 alone",
        sinusoids(y2="np.cos(0.04 * np.pi * t)"),
        "period of 50 s",
        "`y2`: its period",
    ),
    # 3. cut
    right(
        CUT,
        "as in MATLAB, with all columns",
        "n = 200\n" + cut("t[n:t.shape[0], :] - t[n, :]", "y1[n:1001, :]", "y2[n:1001, :]"),
    ),
    right(CUT, "np.delete", cut("t[:-200]", "np.delete(y1, range(200), axis=0)", "np.split(y2, [200])[1]")),
    right(CUT, "20 s taken off", cut("t[200:] - 20")),
    wrong(CUT, "time not shifted", cut("t[200:]"), "time not set back to zero", "starts at 20 s"),
    wrong(
        CUT,
        "last 200 cut",
        cut("t[:-200]", "y1[:-200]", "y2[:-200]"),
        "the last samples cut off",
        "the first 200 should go",
    ),
    wrong(
        CUT,
        "a view shifted in place",
        "t_new = t[200:]\nt_new -= 20\ny1_new = y1[200:]\ny2_new = y2[200:]\n",
        "a view changed",
        "`t` itself has changed",
    ),
    wrong(CUT, "the 200 kept", cut("t[:200]", "y1[:200]", "y2[:200]"), "the wrong part kept", "should be removed"),
    wrong(
        CUT,
        "counted from 1",
        cut("t[201:] - t[201]", "y1[201:]", "y2[201:]"),
        "off by one",
        "one sample too few",
    ),
    wrong(
        CUT,
        "one too few",
        cut("t[199:] - t[199]", "y1[199:]", "y2[199:]"),
        "off by one",
        "the rows 0 to 199",
    ),
    wrong(CUT, "y not cut", cut(y1="y1", y2="y2"), "not cut", "still the whole of `y1`"),
    wrong(CUT, "y2 from y1", cut(y2="y1[200:]"), "y1 and y2 swapped", "the other signal"),
    wrong(
        CUT,
        "set back by samples",
        cut("t[200:] - 200"),
        "samples taken for seconds",
        "number of samples",
    ),
    wrong(
        CUT,
        "signals set back too",
        cut(y1="y1[200:] - y1[200]", y2="y2[200:] - y2[200]"),
        "values set back to zero",
        "keeps its values",
    ),
    wrong(
        CUT,
        "cut at 20 samples",
        cut("t[20:] - t[20]", "y1[20:]", "y2[20:]"),
        "20 samples cut off",
        "20 s are 200 samples",
    ),
    # 4. matrix
    right(MATRIX, "concatenate", "data_new = np.concatenate([t_new, y1_new, y2_new], axis=1)"),
    right(MATRIX, "column_stack of flat ones", "data_new = np.column_stack([t_new.ravel(), y1_new, y2_new])"),
    right(
        MATRIX,
        "filled column by column",
        "data_new = np.zeros((len(t_new), 3))\n"
        "data_new[:, [0]] = t_new\n"
        "data_new[:, [1]] = y1_new\n"
        "data_new[:, [2]] = y2_new\n",
    ),
    wrong(
        MATRIX,
        "three rows",
        "data_new = np.vstack([t_new.T, y1_new.T, y2_new.T])",
        "rows instead of columns",
        "three rows",
    ),
    wrong(
        MATRIX,
        "end to end",
        "data_new = np.vstack([t_new, y1_new, y2_new])",
        "stacked end to end",
        "one below the other",
    ),
    wrong(
        MATRIX,
        "np.array",
        "data_new = np.array([t_new, y1_new, y2_new])",
        "stacked along a new axis",
        "3 dimensions",
    ),
    wrong(
        MATRIX,
        "time last",
        "data_new = np.hstack([y1_new, y2_new, t_new])",
        "columns in another order",
        "wrong order",
    ),
    wrong(MATRIX, "original data", "data_new = np.hstack([t, y1, y2])", "not cut", "original data"),
    wrong(
        MATRIX,
        "the old time",
        "data_new = np.hstack([t[200:], y1_new, y2_new])",
        "time not set back to zero",
        "first column starts at 20 s",
    ),
    wrong(MATRIX, "two columns", "data_new = np.hstack([y1_new, y2_new])", None, "should have shape"),
    wrong(MATRIX, "a list", "data_new = ['t_new', 'y1_new', 'y2_new']", None, "should be numbers"),
    # 4, as a function
    right(
        FUNCTION,
        "hstack",
        function("return np.hstack([data[n:, :1] - data[n, 0], data[n:, 1:]])"),
    ),
    right(
        FUNCTION,
        "shifted first, through a loop",
        function(
            "rows = []\n"
            "for k in range(n, data.shape[0]):\n"
            "    rows.append([data[k, 0] - data[n, 0], *data[k, 1:]])\n"
            "return np.array(rows)"
        ),
    ),
    right(FUNCTION, "a copy under its name", function("data = data[n:].copy()\ndata[:, 0] -= data[0, 0]\nreturn data")),
    wrong(
        FUNCTION,
        "in place",
        function("data = data[n:]\ndata[:, 0] -= data[0, 0]\nreturn data"),
        "changes its argument",
        "changes the matrix `data` that it is given",
    ),
    wrong(
        FUNCTION,
        "time not shifted",
        function("return data[n:]"),
        "time not set back to zero",
        "leaves the time unchanged",
    ),
    wrong(
        FUNCTION,
        "last rows cut",
        function("rest = data[:-n].copy()\nrest[:, 0] -= rest[0, 0]\nreturn rest"),
        "the last samples cut off",
        "should remove the first n",
    ),
    wrong(
        FUNCTION,
        "counted from 1",
        function("rest = data[n + 1:].copy()\nrest[:, 0] -= rest[0, 0]\nreturn rest"),
        "off by one",
        "one row too many",
    ),
    wrong(
        FUNCTION,
        "always 200",
        function("rest = data[200:].copy()\nrest[:, 0] -= rest[0, 0]\nreturn rest"),
        "always 200 samples",
        "use the argument n",
    ),
    wrong(
        FUNCTION,
        "always 20 s",
        function("rest = data[n:].copy()\nrest[:, 0] -= 20\nreturn rest"),
        "time set back by a fixed 20 s",
        "always subtracts 20 s",
    ),
    wrong(
        FUNCTION,
        "start from a sampling time of 0.1 s",
        function("rest = data[n:].copy()\nrest[:, 0] -= n * 0.1\nreturn rest"),
        "sampling time of 0.1 s assumed",
        "subtracts n times 0.1 s",
    ),
    wrong(
        FUNCTION,
        "the time from above",
        function("return np.column_stack([t_new[:len(data) - n], data[n:, 1:]])"),
        "a variable from above used",
        "time of `t_new`",
    ),
    wrong(
        FUNCTION,
        "three columns only",
        function("rest = data[n:].copy()\nreturn np.c_[rest[:, 0] - rest[0, 0], rest[:, 1], rest[:, 2]]"),
        "always three columns",
        "`data` had|keep all columns",
    ),
    wrong(
        FUNCTION,
        "every column shifted",
        function("return data[n:] - data[n]"),
        "all columns set back",
        "only the time should",
    ),
    wrong(FUNCTION, "no return", function("rest = data[n:]\nrest[:, 0] -= rest[0, 0]"), "no return", "return"),
    wrong(FUNCTION, "the matrix from above", function("return data_new"), None, "without its first `n` rows"),
    wrong(
        FUNCTION,
        "returned transpose it",
        function("return np.vstack([data[n:, 0] - data[n, 0], data[n:, 1], data[n:, 2]])"),
        "rows instead of columns",
        "transpose it",
    ),
    wrong(FUNCTION, "stops", function("return data.cut(n)"), None, "stopped with AttributeError"),
    # 5. Fig. 1(a)
    right(
        FIGURE_A,
        "figure and add_subplot, LaTeX, legend with the names",
        "fig_1 = plt.figure()\nax_a = fig_1.add_subplot(2, 1, 1)\nax_b = fig_1.add_subplot(2, 1, 2)\n"
        "ax_a.plot(t, y1, 'r')\nax_a.step(t, y2, where='post', color=[0.6, 0.7, 0.8])\n"
        "ax_a.legend([r'$\\sin(0.02\\pi t)$', r'$\\cos(0.02\\pi t)$'])\n"
        "ax_a.set(xlim=(0, 140), ylim=(-1.5, 1.5), title='Original data', xlabel='$t$ [s]', ylabel='$y$')\n"
        "ax_a.grid(True)\n",
    ),
    right(
        FIGURE_A,
        "pyplot as in MATLAB, one panel after the other",
        "fig_1 = plt.figure()\nplt.subplot(2, 1, 1)\n"
        "plt.plot(t, y1, color='k', label='sin(0.02πt)')\n"
        "plt.step(t, y2, where='post', color='#99b3cc', label='cos(0.02πt)')\n"
        "plt.xlim(0, 140)\nplt.ylim(-1.5, 1.5)\nplt.title('(a) Original data')\nplt.grid()\n"
        "plt.xlabel('Time (s)')\nplt.ylabel('y')\nplt.legend()\nax_b = fig_1.add_subplot(2, 1, 2)\n",
    ),
    right(
        FIGURE_A,
        "stairs, cosine first",
        panel(
            "ax_a",
            sine=f"ax_a.stairs(y2[:-1, 0], t[:, 0], baseline=None, color={GREY_BLUE}, label='cos(0.02πt)')",
            cosine="ax_a.plot(t, y1, color=(0.8, 0.1, 0.1), label='sin(0.02πt)')",
        ),
    ),
    right(
        FIGURE_A,
        "legend of the figure",
        panel("ax_a", legend="fig_1.legend(loc='outside lower center')"),
    ),
    wrong(
        FIGURE_A,
        "no time vector",
        panel("ax_a", sine="ax_a.plot(y1, color='red', label='sin(0.02πt)')"),
        "drawn against the sample number",
        "`y1` is drawn against the sample number",
    ),
    wrong(
        FIGURE_A,
        "y2 as the abscissa",
        panel("ax_a", sine="ax_a.plot(y2, y1, color='red', label='sin(0.02πt)')"),
        "drawn against another vector",
        "against another vector, and not against time",
    ),
    wrong(
        FIGURE_A,
        "step before the sample",
        panel("ax_a", cosine=f"ax_a.step(t, y2, color={GREY_BLUE}, label='cos(0.02πt)')"),
        "step before the sample",
        'where="post"',
    ),
    wrong(
        FIGURE_A,
        "y-axis not limited",
        panel("ax_a", limits="ax_a.set_xlim(0, 140)"),
        "axis limits",
        "the y-axis runs from",
    ),
    wrong(
        FIGURE_A,
        "Greek letter spelt out",
        panel("ax_a", sine="ax_a.plot(t, y1, color='red', label='sin(0.02*pi*t)')"),
        "Greek letter spelt out",
        "spells the Greek letter out",
    ),
    wrong(
        FIGURE_A,
        "default colours",
        panel("ax_a", cosine="ax_a.step(t, y2, where='post', label='cos(0.02πt)')"),
        "colour",
        "RGB code",
    ),
    wrong(
        FIGURE_A,
        "colours swapped",
        panel(
            "ax_a",
            sine=f"ax_a.plot(t, y1, color={GREY_BLUE}, label='sin(0.02πt)')",
            cosine="ax_a.step(t, y2, where='post', color='red', label='cos(0.02πt)')",
        ),
        "colours swapped",
        "this colour to the cosine",
    ),
    wrong(
        FIGURE_A,
        "both with plot",
        panel("ax_a", cosine=f"ax_a.plot(t, y2, color={GREY_BLUE}, label='cos(0.02πt)')"),
        "plot in place of stairs",
        "stairs",
    ),
    wrong(
        FIGURE_A,
        "names swapped",
        panel(
            "ax_a",
            sine="ax_a.plot(t, y1, color='red', label='cos(0.02πt)')",
            cosine=f"ax_a.step(t, y2, where='post', color={GREY_BLUE}, label='sin(0.02πt)')",
        ),
        "legend entries swapped",
        "swap the labels",
    ),
    wrong(FIGURE_A, "no legend", panel("ax_a", legend="pass"), "no legend", "legend"),
    wrong(FIGURE_A, "no grid", panel("ax_a", grid="pass"), "no grid", "no grid"),
    wrong(FIGURE_A, "no title", panel("ax_a", title="pass"), "title", "title"),
    wrong(
        FIGURE_A,
        "no unit",
        panel("ax_a", labels="ax_a.set(xlabel='Time', ylabel='Output')"),
        "no unit",
        "no unit",
    ),
    wrong(
        FIGURE_A,
        "the sine without its noise",
        panel("ax_a", sine="ax_a.plot(t, np.sin(0.02 * np.pi * t), color='red', label='sin(0.02πt)')"),
        "no curve",
        "no curve shows `y1`",
    ),
    # 6. Fig. 1(b)
    right(FIGURE_B, "set in one go", panel("ax_b")),
    right(
        FIGURE_B,
        "found again through the figure, columns of the matrix",
        "lower = fig_1.axes[1]\n"
        "lower.plot(data_new[:, 0], data_new[:, 1], 'r', label=r'$\\sin(0.02\\pi t)$')\n"
        "lower.step(data_new[:, 0], data_new[:, 2], where='post', color=(0.6, 0.7, 0.8),\n"
        "           label=r'$\\cos(0.02\\,\\pi\\,t)$')\n"
        "lower.set(xlim=(0, 140), ylim=(-1.5, 1.5), title='Cut-off data', xlabel='t / s', ylabel='y')\n"
        "lower.grid()\nlower.legend(loc='upper right')\n",
    ),
    wrong(
        FIGURE_B,
        "the original data again",
        panel(
            "ax_b",
            sine="ax_b.plot(t, y1, color='red', label='sin(0.02πt)')",
            cosine=f"ax_b.step(t, y2, where='post', color={GREY_BLUE}, label='cos(0.02πt)')",
        ),
        "original data in (b)",
        "original data again",
    ),
    wrong(
        FIGURE_B,
        "the old time",
        panel("ax_b", sine="ax_b.plot(t[200:], y1_new, color='red', label='sin(0.02πt)')"),
        "old time in (b)",
        "old time",
    ),
    wrong(
        FIGURE_B,
        "limits forgotten",
        panel("ax_b", limits="pass"),
        "axis limits",
        "the x-axis runs from",
    ),
    wrong(
        FIGURE_B,
        "drawn in a figure of its own",
        "fig_2, ax_b = plt.subplots()\n" + panel("ax_b"),
        "empty axes",
        "no curve in Fig. 1\\(b\\) yet",
    ),
    wrong(
        FIGURE_B,
        "one curve only",
        panel("ax_b", cosine="pass"),
        "no curve",
        "no curve shows `y2_new`",
    ),
]
