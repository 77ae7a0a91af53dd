"""Part 1 of the lab: the signals, the loop, the offsets."""

from variants import Right, Wrong, right, wrong
from variants._lab_cells import extracted, offsets, panels

EXTRACT, TIME, FIGURE_5 = "lab-1a-extract", "lab-1a-sampling-time", "lab-1b-figure-5"
LOOP, OFFSETS, FIGURE_6 = "lab-1c-loop", "lab-1c-offsets", "lab-1c-figure-6"

OUTPUTS = "a.plot(t, y_actm, label='Measured output')\na.plot(t, y_act, label='Noise-reduced output')"
INPUT = "b.step(t, u_act, where='post')"
FIG_6 = ("a.plot(t, y)", "b.step(t, u, where='post')")


def loop(body: str) -> str:
    lines = "".join(f"    {line}\n" for line in body.splitlines())
    return f"def first_period(u):\n{lines}\n\nn_first = first_period(u_act)\n"


VARIANTS: list[Right | Wrong] = [
    # 1a. the four signals
    right(
        EXTRACT,
        "signals taken apart one after the other",
        "outputs, inputs = LogData['signals']\nt = LogData['time']\ny_actm, y_act = outputs['values'].T\n"
        "u_act = inputs['values']",
    ),
    right(
        EXTRACT,
        "columns instead of flat arrays",
        "t, u_act = LogData['time'][:, None], LogData['signals'][1]['values'][:, None]\n"
        "values = LogData['signals'][0]['values']\ny_act, y_actm = values[:, [1]], values[:, [0]]",
        {
            # what follows is written for flat arrays, so the offset-free signals are flattened
            TIME: "Ts = float(t[1, 0] - t[0, 0])",
            OFFSETS: offsets(
                "np.mean(y_act[:n_first])", "u_act[0, 0]", "(y_act - y_offset)[:, 0]", "(u_act - u_offset).ravel()"
            ),
        },
    ),
    right(
        EXTRACT,
        "load_record",
        "from labsid.records.record import load_record\nrecord = load_record('SysIdenData_StudentVersion.mat')\n"
        + extracted("record.t", "record.y_noise_reduced", "record.y_measured", "record.u"),
    ),
    wrong(
        EXTRACT,
        "MATLAB's column numbers",
        extracted(y_act='LogData["signals"][0]["values"][:, 0]', y_actm='LogData["signals"][0]["values"][:, 1]'),
        "y_act and y_actm swapped",
        "counts from 0",
    ),
    wrong(
        EXTRACT,
        "one output twice",
        extracted(y_act='LogData["signals"][0]["values"][:, 0]'),
        "y_act and y_actm swapped",
        "`y_act` contains `y_actm`",
    ),
    wrong(
        EXTRACT, "both columns", extracted(y_act='LogData["signals"][0]["values"]'), "both columns taken", "take one"
    ),
    wrong(
        EXTRACT,
        "the structure",
        extracted(u_act='LogData["signals"][1]'),
        "structure instead of its field",
        "take the field",
    ),
    wrong(
        EXTRACT,
        "time and input swapped",
        extracted('LogData["signals"][1]["values"]', u_act='LogData["time"]'),
        "another signal taken",
        "`t` contains",
    ),
    wrong(
        EXTRACT,
        "samples counted",
        extracted(t='np.arange(len(LogData["time"]))'),
        "sample number in place of time",
        "in seconds",
    ),
    wrong(EXTRACT, "MATLAB's indices", extracted(u_act='LogData["signals"][2]["values"]'), None, "IndexError"),
    # 1a. the sampling time
    right(TIME, "mean interval", "Ts = np.mean(np.diff(t))"),
    right(TIME, "length over intervals", "Ts = (t[-1] - t[0]) / (len(t) - 1)"),
    wrong(TIME, "frequency", "Ts = 1 / (t[1] - t[0])", "frequency in place of time", "frequency"),
    wrong(TIME, "length over samples", "Ts = t[-1] / len(t)", "divided by the number of samples", "one interval fewer"),
    wrong(TIME, "length of the record", "Ts = t[-1]", "length of the record", "duration"),
    wrong(TIME, "milliseconds", "Ts = 1000 * (t[1] - t[0])", "milliseconds in place of seconds", "in milliseconds"),
    wrong(TIME, "all intervals", "Ts = np.diff(t)", "all intervals", "one number"),
    wrong(TIME, "wrong name", "h = t[1] - t[0]", None, "no variable `Ts`"),
    # 1b. Fig. 5
    right(
        FIGURE_5,
        "as in MATLAB, with subplot",
        "fig_5 = plt.figure()\nplt.subplot(2, 1, 1)\nplt.plot(t, y_act, 'b', t, y_actm, 'r')\n"
        "plt.legend(['Noise-reduced', 'Measured'])\n"
        "plt.xlabel('Time [sec]')\nplt.ylabel('Output [V]')\nplt.grid()\nplt.subplot(2, 1, 2)\nplt.plot(t, u_act)\n"
        "plt.xlabel('Time [sec]')\nplt.ylabel('Input [V]')",
    ),
    right(
        FIGURE_5,
        "shared time axis, input with stairs",
        "fig_5, (a, b) = plt.subplots(2, 1, sharex=True)\n" + OUTPUTS + "\na.legend()\na.set_ylabel('Voltage (V)')\n"
        "b.stairs(u_act[:-1], t)\nb.set(xlabel='t / s', ylabel='u / V')",
    ),
    wrong(
        FIGURE_5,
        "the axes in place of the figure",
        panels("fig_5", OUTPUTS, INPUT) + "fig_5 = a\n",
        "not the figure",
        "the figure itself",
    ),
    wrong(FIGURE_5, "one panel", "fig_5, a = plt.subplots()\n" + OUTPUTS, "number of panels", "2 subplots; it has 1"),
    wrong(
        FIGURE_5,
        "measured output forgotten",
        panels("fig_5", "a.plot(t, y_act, label='y')", INPUT),
        "no curve",
        "no curve shows `y_actm`",
    ),
    wrong(
        FIGURE_5,
        "against the sample number",
        panels("fig_5", OUTPUTS.replace("t, ", ""), INPUT),
        "drawn against the sample number",
        "is drawn against the sample number",
    ),
    wrong(
        FIGURE_5,
        "panels swapped",
        panels("fig_5", OUTPUTS.replace("a.", "b."), INPUT.replace("b.", "a."), legend="b.legend()"),
        "panels swapped",
        "swapped",
    ),
    wrong(FIGURE_5, "no legend", panels("fig_5", OUTPUTS, INPUT, legend=""), "no legend", "legend"),
    wrong(
        FIGURE_5,
        "legend entries swapped",
        panels(
            "fig_5",
            "a.plot(t, y_actm, t, y_act)",
            INPUT,
            legend="a.legend(['Noise-reduced output', 'Measured output'])",
        ),
        "legend entries swapped",
        "swaps the names",
    ),
    wrong(
        FIGURE_5,
        "no unit",
        panels("fig_5", OUTPUTS, INPUT, upper_labels="a.set(xlabel='Time', ylabel='Output')"),
        "no unit",
        "unit",
    ),
    wrong(
        FIGURE_5, "no axis label", panels("fig_5", OUTPUTS, INPUT, lower_labels=""), "axis without a label", "no label"
    ),
    # 1c. the loop
    right(LOOP, "numpy instead of the loop", loop("return int(np.flatnonzero(np.diff(np.ravel(u)))[0]) + 1")),
    right(LOOP, "for loop", loop("n = 0\nfor value in u:\n    if value != u[0]:\n        break\n    n += 1\nreturn n")),
    right(LOOP, "argmax, counted from zero", loop("return np.argmax(u != u[0])")),
    right(
        LOOP,
        "with a tolerance",
        loop("n = 0\nwhile n < len(u) and abs(u[n] - u[0]) < 1e-6:\n    n += 1\nreturn n"),
    ),
    wrong(
        LOOP,
        "index of the last sample",
        loop("n = 0\nwhile u[n + 1] == u[0]:\n    n += 1\nreturn n"),
        "off by one",
        "One too few",
    ),
    wrong(LOOP, "diff without the one", loop("return np.flatnonzero(np.diff(u))[0]"), "off by one", "One too few"),
    wrong(
        LOOP, "one too many", loop("n = 1\nwhile u[n - 1] == u[0]:\n    n += 1\nreturn n"), "off by one", "One too many"
    ),
    wrong(LOOP, "counted by eye", loop("return 51"), "the same number for every input", "every input"),
    wrong(
        LOOP,
        "works on u_act",
        loop("n = 1\nwhile u_act[n] == u_act[0]:\n    n += 1\nreturn n"),
        "the same number for every input",
        "the argument `u`",
    ),
    wrong(
        LOOP,
        "counts all at that level",
        loop("return np.sum(u == u[0])"),
        "all samples at the first level",
        "including later ones",
    ),
    wrong(
        LOOP,
        "last change",
        loop("return np.flatnonzero(np.diff(u))[-1] + 1"),
        "last change instead of the first",
        "last change",
    ),
    wrong(
        LOOP,
        "downwards only",
        loop("n = 1\nwhile u[n] >= u[0]:\n    n += 1\nreturn n"),
        "changes in one direction only",
        "upwards",
    ),
    wrong(
        LOOP,
        "number of changes",
        loop("return np.count_nonzero(np.diff(u))"),
        "number of changes",
        "counts the changes",
    ),
    wrong(LOOP, "length of the input", loop("return len(u)"), "length of the input", "length of the input"),
    wrong(
        LOOP,
        "a time",
        loop("n = 1\nwhile u[n] == u[0]:\n    n += 1\nreturn n * Ts"),
        "time instead of a number of samples",
        "a time",
    ),
    wrong(
        LOOP,
        "prints instead of returning",
        loop("n = 1\nwhile u[n] == u[0]:\n    n += 1\nprint(n)"),
        "nothing returned",
        "return",
    ),
    # 1c. the offsets
    right(OFFSETS, "mean over the whole first period", offsets()),
    right(OFFSETS, "only the last third of the period", offsets("y_act[n_first - n_first // 3 : n_first].mean()")),
    right(
        OFFSETS,
        "sum over number, input averaged",
        offsets("sum(y_act[:n_first]) / n_first", "np.mean(u_act[:n_first])"),
    ),
    right(OFFSETS, "rounded", offsets("round(float(np.mean(y_act[:n_first])), 3)")),
    wrong(
        OFFSETS,
        "mean over the whole record",
        offsets("np.mean(y_act)"),
        "mean over the whole record",
        "first period only",
    ),
    wrong(
        OFFSETS,
        "mean of the measured output",
        offsets("np.mean(y_actm[:n_first])"),
        "measured output used",
        "`y_actm`",
    ),
    wrong(OFFSETS, "one sample too many", offsets("np.mean(y_act[:n_first + 1])"), "off by one", "one sample too many"),
    wrong(OFFSETS, "first sample", offsets("y_act[0]"), "a single sample", "noise"),
    wrong(
        OFFSETS,
        "middle of the input range",
        offsets(u_offset="(u_act.max() + u_act.min()) / 2"),
        "middle of the input range",
        "first",
    ),
    wrong(OFFSETS, "mean of the input", offsets(u_offset="u_act.mean()"), "mean over the whole record", "first value"),
    wrong(
        OFFSETS,
        "middle of the output range",
        offsets("(y_act.max() + y_act.min()) / 2"),
        "middle of the range",
        "middle of the range",
    ),
    wrong(
        OFFSETS, "after the first period", offsets("np.mean(y_act[n_first:])"), "mean after the first period", "n_first"
    ),
    wrong(
        OFFSETS,
        "offsets of the other signal",
        offsets("u_act[0]", "np.mean(y_act[:n_first])"),
        "input in place of the output",
        "input",
    ),
    wrong(OFFSETS, "not subtracted", offsets(y="y_act", u="u_act"), "offset not removed", "subtract"),
    wrong(OFFSETS, "input left as it was", offsets(u="u_act"), "offset not removed", "`u` is still"),
    wrong(OFFSETS, "added", offsets(y="y_act + y_offset"), "offset added", "subtract it"),
    wrong(OFFSETS, "wrong sign", offsets(y="y_offset - y_act"), "sign of the signal", "wrong sign"),
    wrong(OFFSETS, "measured output", offsets(y="y_actm - y_offset"), "another signal taken", "not computed from"),
    wrong(OFFSETS, "cut to the first period", offsets(y="y_act[:n_first] - y_offset"), "signal cut", "entire signal"),
    # 1c. Fig. 6
    right(
        FIGURE_6,
        "with subplot and plot",
        "fig_6 = plt.figure()\nfor i, x in ((1, y), (2, u)):\n    plt.subplot(2, 1, i)\n    plt.plot(t, x)\n"
        "    plt.xlabel('Time (s)')\n    plt.ylabel('Voltage (V)')",
    ),
    right(
        FIGURE_6,
        "shared time axis",
        "fig_6, ax = plt.subplots(2, sharex=True)\nax[0].plot(t, y)\nax[1].stairs(u[:-1], t)\n"
        "ax[0].set_ylabel('y (V)')\nax[1].set(xlabel='t (s)', ylabel='u (V)')",
    ),
    wrong(
        FIGURE_6,
        "with the offsets",
        panels("fig_6", "a.plot(t, y_act)", "b.plot(t, u_act)", legend=""),
        "no curve",
        "no curve shows `y`",
    ),
    wrong(
        FIGURE_6,
        "panels swapped",
        panels("fig_6", "a.plot(t, u)", "b.plot(t, y)", legend=""),
        "panels swapped",
        "swapped",
    ),
    wrong(
        FIGURE_6,
        "against the sample number",
        panels("fig_6", "a.plot(y)", "b.plot(u)", legend=""),
        "drawn against the sample number",
        "time",
    ),
    wrong(
        FIGURE_6,
        "no unit",
        panels("fig_6", *FIG_6, lower_labels="b.set(xlabel='Time (s)', ylabel='Input')", legend=""),
        "no unit",
        "unit",
    ),
    wrong(FIGURE_6, "empty", "fig_6 = plt.subplots(2, 1)[0]", "empty axes", "empty"),
]
