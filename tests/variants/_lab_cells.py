"""How the variants of the lab are written down."""


def extracted(
    t: str = 'LogData["time"]',
    y_act: str = 'LogData["signals"][0]["values"][:, 1]',
    y_actm: str = 'LogData["signals"][0]["values"][:, 0]',
    u_act: str = 'LogData["signals"][1]["values"]',
) -> str:
    return f"t = {t}\ny_act = {y_act}\ny_actm = {y_actm}\nu_act = {u_act}\n"


def panels(
    name: str,
    upper: str,
    lower: str,
    upper_labels: str = "a.set(xlabel='Time (s)', ylabel='Output (V)')",
    lower_labels: str = "b.set(xlabel='Time (s)', ylabel='Input (V)')",
    legend: str = "a.legend()",
) -> str:
    return f"{name}, (a, b) = plt.subplots(2, 1)\n{upper}\n{lower}\n{upper_labels}\n{lower_labels}\n{legend}\n"


def offsets(
    y_offset: str = "np.mean(y_act[:n_first])",
    u_offset: str = "u_act[0]",
    y: str = "y_act - y_offset",
    u: str = "u_act - u_offset",
) -> str:
    return f"y_offset = {y_offset}\nu_offset = {u_offset}\ny = {y}\nu = {u}\n"
