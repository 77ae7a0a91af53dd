"""First tries at the pre-lab."""

from tries import Try

T, N, C, M, F, A, B = (
    "prelab-1-time", "prelab-2-noise", "prelab-3-cut", "prelab-4-matrix", "prelab-4-function", "prelab-5-original",
    "prelab-6-cut-off",
)  # fmt: skip

NOISE = "rng.uniform(-0.2, 0.2, t.shape)"


def waves(sine: str, noise: str = NOISE) -> str:
    return f"y1 = {sine} + {noise}\ny2 = np.cos(2 * np.pi * t / 100) + {NOISE}"


def cut(body: str) -> str:
    return f"def cut_off(data, n):\n    {body}\n"


TRIES = (
    Try(T, "MATLAB colon", "t = 0:0.1:100", r"MATLAB's range.*np\.arange.*where a column vector is asked for"),
    Try(T, "MATLAB colon, transposed", "t = (0:0.1:100)'", r"transpose of a flat array.*reshape", never=r"`\.T`"),
    Try(T, "MATLAB colon in brackets", "t = [0:0.1:100]", r"MATLAB's range.*column vector is asked for"),
    Try(T, "flat", "t = np.linspace(0, 100, 1001)", "one-dimensional"),
    Try(T, "transposed flat", "t = np.linspace(0, 100, 1001).T", "one-dimensional"),
    Try(T, "arange without end", "t = np.arange(0, 100, 0.1).reshape(-1, 1)", "excludes its end"),
    Try(T, "1000 points", "t = np.linspace(0, 100, 1000).reshape(-1, 1)", "1000 points"),
    Try(T, "a row", "t = np.linspace(0, 100, 1001).reshape(1, -1)", "is a row"),
    Try(T, "half the spacing", "t = np.linspace(0, 100, 2001).reshape(-1, 1)", "2001 points", "taught"),
    Try(T, "no np", "t = linspace(0, 100, 1001)", r"part of numpy: `np\.linspace`"),
    Try(N, "sin(100 t)", waves("np.sin(100 * t)"), "100 s is the period T, not the factor"),
    Try(N, "angle t/T", waves("np.sin(t / 100)"), "2 pi is missing"),
    Try(N, "degrees", waves("np.sin(3.6 * t)"), "degrees"),
    Try(N, "period of 400 s", waves("np.sin(0.005 * np.pi * t)"), "400 s"),
    Try(N, "period of 30 s", waves("np.sin(2 * np.pi * t / 30)"), "period of 3"),
    Try(N, "amplitude 3", waves("3 * np.sin(2 * np.pi * t / 100)"), "amplitude 3"),
    Try(N, "lifted by 1", waves("1 + np.sin(2 * np.pi * t / 100)"), "mean 1"),
    Try(N, "flat noise", waves("np.sin(2 * np.pi * t / 100)", "rng.uniform(-0.2, 0.2, 1001)"), "flat noise"),
    Try(N, "one number", waves("np.sin(2 * np.pi * t / 100)", "rng.uniform(-0.2, 0.2)"), "same random number"),
    Try(N, "normal", waves("np.sin(2 * np.pi * t / 100)", "0.2 * rng.standard_normal(t.shape)"), "Gaussian"),
    Try(N, "rand alone", waves("np.sin(2 * np.pi * t / 100)", "rng.random(t.shape)"), "0 to 1"),
    Try(N, "random() / 5", waves("np.sin(2 * np.pi * t / 100)", "rng.random(t.shape) / 5"), "never negative"),
    Try(N, "no noise", waves("np.sin(2 * np.pi * t / 100)", "0"), "no noise yet"),
    Try(N, "MATLAB rand", waves("np.sin(2 * np.pi * t / 100)", "rand(1001, 1)"), r"from 0 to 1; .*rng\.uniform"),
    Try(
        N,
        "MATLAB randn",
        waves("np.sin(2 * np.pi * t / 100)", "randn(1001, 1)"),
        "standard_normal",
        never="from 0 to 1",
    ),
    Try(N, "pi alone", waves("np.sin(2 * pi * t / 100)"), r"np\.pi"),
    Try(C, "MATLAB index", "t_new = t(201:end)\ny1_new = y1[200:]\ny2_new = y2[200:]", "square ones|no `end`"),
    Try(C, "201", "t_new = t[201:] - t[201]\ny1_new = y1[201:]\ny2_new = y2[201:]", "one sample too few"),
    Try(C, "time not reset", "t_new = t[200:]\ny1_new = y1[200:]\ny2_new = y2[200:]", "subtract its first time"),
    Try(C, "last cut", "t_new = t[:-200]\ny1_new = y1[:-200]\ny2_new = y2[:-200]", "last 200"),
    Try(C, "20 rows", "t_new = t[20:] - t[20]\ny1_new = y1[20:]\ny2_new = y2[20:]", "20 s are 200 samples"),
    Try(C, "in place", "t_new = t[200:]\nt_new -= 20\ny1_new = y1[200:]\ny2_new = y2[200:]", "changed, by 20 s"),
    Try(C, "columns", "t_new = t[:, 200:]\ny1_new = y1[:, 200:]\ny2_new = y2[:, 200:]", "A slice took nothing"),
    Try(C, "from 20 s", "t_new = t[t >= 20]\ny1_new = y1[200:]\ny2_new = y2[200:]", "subtract its first time"),
    Try(M, "vstack", "data_new = np.vstack([t_new, y1_new, y2_new])", "one below the other"),
    Try(M, "no list", "data_new = np.hstack(t_new, y1_new, y2_new)", r"`np.hstack\(\[t_new, y1_new, y2_new\]\)`"),
    Try(M, "array", "data_new = np.array([t_new, y1_new, y2_new])", r"along a new one\."),
    Try(M, "MATLAB brackets", "data_new = [t_new y1_new y2_new]", "separated by commas"),
    Try(M, "uncut", "data_new = np.hstack([t, y1, y2])", "original data"),
    Try(M, "order", "data_new = np.hstack([y1_new, y2_new, t_new])", "order"),
    Try(F, "subtract n", cut("r = data[n:].copy(); r[:, 0] = r[:, 0] - n; return r"), "subtracts n"),
    Try(F, "time untouched", cut("return data[n:]"), "time unchanged"),
    Try(F, "no return", cut("data = data[n:]"), "returns nothing"),
    Try(
        F,
        "names from above",
        cut("return data_new"),
        "never reads its arguments `data` and `n`, but `data_new` of the notebook",
    ),
    Try(
        F, "subtract first of all", cut("r = data[n:].copy(); r[:, 0] -= data[0, 0]; return r"), "first time of `data`"
    ),
    Try(F, "200 fixed", cut("r = data[200:].copy(); r[:, 0] -= r[0, 0]; return r"), "200|returned 0|out of bounds"),
    Try(F, "columns cut", cut("r = data[:, n:].copy(); r[:, 0] -= r[0, 0]; return r"), "shape|returned|columns|out of"),
    Try(F, "sum for the first", cut("r = data[n:].copy(); r[:, 0] -= r[:, 0].mean(); return r"), "first column begins"),
    Try(F, "print", cut("r = data[n:].copy(); r[:, 0] -= r[0, 0]; print(r)"), "returns nothing"),
    Try(
        A,
        "plt draws below",
        "fig_1, (ax_a, ax_b) = plt.subplots(2, 1)\nplt.plot(t, y1, color='r', "
        "label=r'$\\sin(0.02\\pi t)$')\nplt.step(t, y2)",
        r"lower panel.*ax_a\.plot",
    ),
    Try(A, "unpacking", "fig_1, ax_a, ax_b = plt.subplots(2, 1)\nax_a.plot(t, y1)", r"fig, \(ax_a, ax_b\)"),
    Try(
        A,
        "plot for stairs",
        "fig_1, (ax_a, ax_b) = plt.subplots(2, 1)\nax_a.plot(t, y1, 'r')\nax_a.plot(t, y2, color=(0.6, 0.7, 0.8))",
        "straight lines join the cosine",
    ),
    Try(A, "MATLAB title", "fig_1, (ax_a, ax_b) = plt.subplots(2, 1)\nax_a.title('(a)')", "brackets|not callable"),
    Try(
        B,
        "old curves",
        "ax_b.plot(t, y1)\nax_b.step(t, y2, where='post')\nax_b.plot(t_new, y1_new)\n"
        "ax_b.step(t_new, y2_new, where='post', color=(0.6, 0.7, 0.8))",
        "earlier run",
    ),
    Try(B, "original", "ax_b.plot(t, y1)\nax_b.step(t, y2, where='post')", "original data again", never="earlier run"),
    Try(B, "against uncut time", "ax_b.plot(t[200:], y1_new)\nax_b.step(t[200:], y2_new)", "old time"),
    Try(B, "unequal lengths", "ax_b.plot(t, y1_new)", "same length|same first dimension"),
    Try(B, "in (a)", "ax_a.plot(t_new, y1_new)\nax_a.step(t_new, y2_new)", "cut-off data are in Fig. 1\\(a\\)"),
    Try(
        "prelab-6-cut-off",
        "x and y swapped",
        "ax_b.plot(y1_new, t_new, 'r')\nax_b.step(y2_new, t_new, where='post', color=(0.6, 0.7, 0.8))",
        "horizontal axis",
    ),
    Try(
        "prelab-6-cut-off",
        "absolute values",
        "ax_b.plot(t_new, abs(y1_new), 'r')\nax_b.step(t_new, y2_new, where='post', color=(0.6, 0.7, 0.8))",
        "One curve is related to it: it is the absolute value",
        never="horizontal axis|offset",
    ),
    Try(
        "prelab-6-cut-off",
        "one signal twice",
        "ax_b.plot(t_new, y2_new, 'r')\nax_b.step(t_new, y2_new, where='post', color=(0.6, 0.7, 0.8))",
        "no curve shows `y1_new`, and two show `y2_new`",
    ),
    Try(
        "prelab-6-cut-off",
        "one signal alone",
        "ax_b.step(t_new, y2_new, where='post', color=(0.6, 0.7, 0.8))",
        r"no curve shows `y1_new`\.",
        never="two show",
    ),
    Try(
        N,
        "noise in the angle",
        "y1 = np.sin(2 * np.pi * t / 100 + rng.uniform(-0.2, 0.2, t.shape))\n"
        "y2 = np.cos(2 * np.pi * t / 100 + rng.uniform(-0.2, 0.2, t.shape))",
        "the noise is inside its brackets",
        never="Gaussian",
    ),
    Try(T, "list", "t = [0.1 * i for i in range(1001)]", "one-dimensional"),
    Try(T, "capital", "T = np.linspace(0, 100, 1001).reshape(-1, 1)", "There is `T`"),
    Try(T, "another name", "time = np.linspace(0, 100, 1001)", "no variable `t`", never="is that meant"),
    Try(T, "dots", "t = ...", r"still `\.\.\.`"),
    Try(
        C,
        "end named",
        "t_new = t[200:1000] - t[200]\ny1_new = y1[200:1000]\ny2_new = y2[200:1000]",
        "one sample too few",
    ),
    Try(F, "misspelt", "def cut_of(data, n):\n    return data[n:]", "There is `cut_of`: is that meant"),
    Try(
        A,
        "colour of 255",
        "fig_1, (ax_a, ax_b) = plt.subplots(2, 1)\nax_a.plot(t, y1, color=(153, 178, 204))",
        "divide 0 to 255 by 255",
    ),
    Try(
        F,
        "row for column",
        cut("r = data[n:].copy(); r[0] = r[0] - r[0, 0]; return r"),
        r"the first column is `data\[:, 0\]`",
    ),
    Try(N, "1000 flat numbers", waves("np.sin(2 * np.pi * t / 100)", "rng.uniform(-0.2, 0.2, 1000)"), "flat noise"),
    Try(M, "columns in an array, transposed", "data_new = np.array([t_new, y1_new, y2_new]).T", "turns all three"),
    Try(
        M,
        "columns in an array",
        "data_new = np.array([t_new, y1_new, y2_new])",
        r"along a new one\.",
        never="turns all",
    ),
    Try(T, "single precision", "t = np.linspace(0, 100, 1001, dtype=np.float32).reshape(-1, 1)", "float32.*digits"),
    Try(
        N, "complex exponential", waves("np.exp(0.02j * np.pi * t)"), "The sine is its imaginary part", never="rounding"
    ),
    Try(
        N,
        "complex exponential for the cosine",
        "y1 = np.sin(2 * np.pi * t / 100) + rng.uniform(-0.2, 0.2, t.shape)\n"
        "y2 = np.exp(0.02j * np.pi * t) + rng.uniform(-0.2, 0.2, t.shape)",
        "The cosine is its real part",
        never="The sine|rounding",
    ),
    Try(
        N,
        "root of a complex number",
        waves("np.sqrt(np.sin(2 * np.pi * t / 100) + 0j)"),
        "no rounding, it goes up to",
        never="exponential|exp\\(jx\\)",
    ),
    Try(
        N,
        "complex by rounding",
        waves("np.fft.ifft(np.fft.fft(np.sin(2 * np.pi * t / 100), axis=0) * np.exp(1e-17j), axis=0) * (1 + 1e-17j)"),
        r"only rounding: take the real part with `np\.real`",
        never="exp\\(jx\\)|no rounding",
    ),
    Try(
        C,
        "set back by the sample before",
        "t_new = t[200:] - t[199]\ny1_new = y1[200:]\ny2_new = y2[200:]",
        "own first",
    ),
    Try(C, "whole time set back", "t -= 20\nt_new = t[200:]\ny1_new = y1[200:]\ny2_new = y2[200:]", "`t` has changed"),
    Try(
        A,
        "plt.step draws below",
        "fig_1, (ax_a, ax_b) = plt.subplots(2, 1)\nax_a.plot(t, y1, 'r')\nplt.step(t, y2, where='post')",
        r"lower panel.*ax_a\.plot",
    ),
    Try(
        A,
        "plt.title below",
        "fig_1, (ax_a, ax_b) = plt.subplots(2, 1)\nax_a.plot(t, y1, 'r', label='sin')\n"
        "ax_a.step(t, y2, where='post', color=(0.6, 0.7, 0.8), label='cos')\n"
        "plt.xlim(0, 140)\nplt.ylim(-1.5, 1.5)\nplt.title('(a) Original data')\nplt.legend()\nplt.grid(True)",
        r"`plt\.title`, .* act on the axes made last",
    ),
    Try(
        N,
        "both of 100 t",
        "y1, y2 = (wave(100 * t) + rng.uniform(-0.2, 0.2, t.shape) for wave in (np.sin, np.cos))",
        "100 s is the period T, not the factor",
    ),
    Try(A, "a curve for the figure", "fig_1 = plt.plot(t, y1)", "should be the figure itself"),
    Try(
        A,
        "names of the variables",
        "fig_1, (ax_a, ax_b) = plt.subplots(2, 1)\nax_a.plot(t, y1, 'r', label='y1')\n"
        "ax_a.step(t, y2, where='post', color=(0.6, 0.7, 0.8), label='y2')\n"
        "ax_a.set(xlim=(0, 140), ylim=(-1.5, 1.5), title='(a) Original data', xlabel='Time (s)', ylabel='Amplitude')\n"
        "ax_a.legend()\nax_a.grid(True)",
        "no entry sin",
    ),
    Try(
        B,
        "a figure of its own",
        "fig_1, ax_b = plt.subplots()\nax_b.plot(t_new, y1_new, 'r')\nax_b.step(t_new, y2_new, where='post')",
        "should have two panels",
    ),
    Try(
        B,
        "another figure",
        "fig_2, ax = plt.subplots()\nax.plot(t_new, y1_new, 'r')\nax.step(t_new, y2_new, where='post')",
        r"the axes `ax_b` of `fig_1`.*begin another figure",
        never="two panels|ax_a",
    ),
    Try(
        A,
        "a figure after the axes",
        "fig_1, (ax_a, ax_b) = plt.subplots(2, 1)\nplt.figure()\nplt.plot(t, y1, 'r')\nplt.step(t, y2)",
        r"the axes `ax_a` of `fig_1`.*begin another figure",
        never="lower panel|ax_b",
    ),
    Try(T, "counted from 1", "t = 0.1 * np.arange(1, 1001).reshape(-1, 1)", "should start at 0"),
    Try(T, "a hundredth", "t = np.linspace(0, 100, 10001).reshape(-1, 1)", "steps of 0.01 s"),
    Try(T, "100 points", "t = np.linspace(0, 100, 100).reshape(-1, 1)", "has 100 points"),
    Try(F, "rows numbered", cut("r = data[n:].copy(); r[:, 0] = np.arange(len(r)); return r"), "numbers the rows"),
    Try(F, "times set to zero", cut("r = data[n:].copy(); r[:, 0] = 0; return r"), "whole first column to zero"),
    Try(
        C,
        "in place, run twice",
        2 * "t_new = t[200:]\nt_new -= 20\ny1_new = y1[200:]\ny2_new = y2[200:]\n",
        "has changed, by 40 s",
    ),
    Try(
        C,
        "own names, run twice",
        2 * "t = t[200:] - t[200]\ny1 = y1[200:]\ny2 = y2[200:]\n" + "t_new, y1_new, y2_new = t, y1, y2",
        "`t` itself has changed: it has 601",
    ),
    Try(
        C,
        "its own start before it has one",
        "t_new = t[200:] - t_new[0]\ny1_new = y1[200:]\ny2_new = y2[200:]",
        "`t_new` stands on the right of `=`, too",
        never="run the cells above",
    ),
    Try(M, "matrix of three", "data_new = np.array(t_new, y1_new)", r"in a list: `np\.column_stack"),
    Try(F, "one argument", "def cut_off(data):\n    return data[200:]", "with the arguments of the question"),
    Try(F, "taken apart by rows", cut("t, y1, y2 = data; return t[n:]"), r"its 3 columns are `data\[:, 0\]`"),
    Try(A, "axes in an array", "fig_1, axs = plt.subplots(2, 1)\naxs.plot(t, y1)", r"take one, `axs\[0\]`"),
    Try(A, "colour", "fig_1, (ax_a, ax_b) = plt.subplots(2, 1)\nax_a.plot(t, y1, colour='r')", "spelt `color`"),
    Try(A, "subplot", "fig_1, (ax_a, ax_b) = plt.subplot(2, 1)", "with an s at the end", never="two things"),
)
