"""The data of a page that is replayed: titles, sentences and the text of each position of a slider."""

import base64
import json
from typing import Any

import numpy as np
import pytest
from gap_reports import report, with_holdout

from labsid.gap.effects.families import EFFECTS_BY_KEY
from labsid.gap.fits.hypothesis import Hypothesis
from labsid.gap.reports.quantities import with_units
from labsid.gap.reports.replay_page import page_data, page_script

EFFECT = "input-saturation"


def combination(*keys: str, sliders: list[dict[str, Any]] | None = None, simulated: bool = True) -> dict[str, Any]:
    """A fitted combination of effects as the report writes it."""
    hypothesis = Hypothesis(tuple(EFFECTS_BY_KEY[key] for key in keys))
    return {
        "names": sorted(hypothesis.names),
        "effects": list(keys),
        "theta": [one.start for one in hypothesis.parameters],
        "gains": [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        "span": 240,
        "reference": 0.0,
        "constant": None,
        "simulated": simulated,
        "holdout": None,
        "sliders": sliders or [],
    }


def slider(values: list[float], unit: str = "u") -> dict[str, Any]:
    """Positions of an upper limit; the middle one is the fitted value."""
    moves = [float(k - len(values) // 2) for k in range(len(values))]
    own = {"effect": EFFECT, "parameter": "high", "unit": unit, "values": values, "moves": moves}
    return own | {"theta": [[1, 0.5]], "gains": [], "of_one_record": False}


def replayed(*combinations: dict[str, Any], accepted: str = EFFECT) -> dict[str, Any]:
    """A report with these combinations."""
    base = report(EFFECT)
    signals = {name: base["traces"][name] for name in ("u", "y", "before", "after")}
    kinds = {"u": "<f8", "y": "<f4", "before": "<f4", "after": "<f4"}
    packed = {name: base64.b64encode(np.array(one, kinds[name]).tobytes()).decode() for name, one in signals.items()}
    scale = {"centre": 0.0, "unit": 1.0}
    return base | {
        "replay": {
            "u_scale": scale,
            "y_scale": scale,
            "record": packed | {"start": 0.0, "Ts": 0.5, "fitted": [[0, 240]], "scored": [[40, 80]]},
            "holdout": None,
            "accepted": [accepted],
            "combinations": list(combinations),
        }
    }


def content(shown: dict[str, Any]) -> dict[str, Any]:
    """What the script reads."""
    read: dict[str, Any] = json.loads(page_data(shown))
    return read


def test_a_position_has_its_value_in_the_units_of_the_record() -> None:
    shown = replayed(combination(f"{EFFECT}/high", sliders=[slider([-1e-12, 1.25, 2.5])]))
    (own,) = content(shown)["combinations"][0]["sliders"]
    assert own["label"] == "Upper limit"
    assert own["texts"] == ["0 units of u", "1.25000 units of u", "2.50000 units of u"]
    assert own["fitted"] == 1
    (own,) = content(with_units(shown, "V", "mm"))["combinations"][0]["sliders"]
    assert own["texts"][1:] == ["1.25000 V", "2.50000 V"]
    assert content(with_units(shown, "V", "mm"))["unit"] == "mm"


def test_a_simulation_whose_numbers_are_wrong_is_shown_with_the_fitted_ones() -> None:
    """Else the panels show the simulation before twice, as no effect is accepted."""
    shown = replayed(combination(f"{EFFECT}/high"))
    shown["replay"]["accepted"] = []
    shown |= {"effects": report("parameter-mismatch")["effects"]}
    read = content(shown)
    assert read["refitted"] is True
    assert read["plain"] == "Your simulation with its fitted values"
    assert read["parts"]["record"]["after"] == shown["replay"]["record"]["after"]
    read = content(replayed(combination(f"{EFFECT}/high")))
    assert read["refitted"] is False
    assert "after" not in read["parts"]["record"]


def test_an_effect_is_named_where_there_are_several() -> None:
    two = combination(f"{EFFECT}/high", "output-drift/3", sliders=[slider([1.0, 1.25, 2.5])])
    shown = content(replayed(combination(f"{EFFECT}/high"), two))
    assert shown["effects"] == [
        {"name": EFFECT, "label": "Limit of the actuator"},
        {"name": "output-drift", "label": "Drift of the sensor"},
    ]
    assert shown["combinations"][1]["title"] == "Limit of the actuator and drift of the sensor"
    assert shown["combinations"][1]["sliders"][0]["label"] == "Limit of the actuator: upper limit"


def test_the_closed_share_is_that_of_the_report_and_of_the_ranking() -> None:
    shown = content(replayed(combination(f"{EFFECT}/high"), combination("resonance"), combination("end-stop/both")))
    accepted, ranked, unknown = shown["combinations"]
    assert accepted["closed"] == "As fitted, it closes 97 % [94, 100] of the gap on the scored samples."
    assert ranked["closed"] == "As fitted, it closes 38 % of the gap on the fitted samples."
    assert unknown["closed"] == ""
    assert [one["accepted"] for one in shown["combinations"]] == [True, False, False]


def test_what_has_no_slider_is_named() -> None:
    given = combination(simulated=False) | {"names": [EFFECT]}
    plain = combination(f"{EFFECT}/high")
    with_slider = combination(f"{EFFECT}/high", sliders=[slider([1.0, 1.25, 2.5])])
    texts = [one["still"] for one in content(replayed(given, plain, with_slider))["combinations"]]
    sliders_start_apart = (
        "The sliders start at the values of the exported simulation, which is fitted without the scored samples; the "
        "values with ± are fitted to all samples."
    )
    assert texts == [
        "Your simulation cannot run in this page. What acts on its input stays as fitted: limit of the actuator.",
        "Without a slider: limit of the actuator.",
        sliders_start_apart,
    ]


def test_a_report_of_an_earlier_version_shows_its_traces() -> None:
    shown = content(with_holdout(report(EFFECT)))
    assert shown["combinations"] == shown["effects"] == []
    assert set(shown["parts"]) == set(shown["panels"]) == {"record", "holdout"}
    t = np.frombuffer(base64.b64decode(shown["parts"]["holdout"]["t"]), "<f8")
    assert t[[0, -1]] == pytest.approx([500.0, 619.5])


def test_the_data_may_stand_in_a_page() -> None:
    hostile = replayed(combination(f"{EFFECT}/high", sliders=[slider([1.0, 1.25, 2.5], "</script><b>")]))
    assert "<" not in page_data(hostile)
    assert content(hostile)["combinations"][0]["sliders"][0]["texts"][1].endswith("</script><b>")


def test_the_script_has_the_functions_of_its_combinations_only() -> None:
    text = page_script(replayed(combination(f"{EFFECT}/high")), "begin();")
    assert text.startswith('"use strict";')
    assert '"input.Saturation": input_Saturation_apply' in text
    assert "simulate_tanks" not in text
    assert "</" not in text


def test_a_long_record_opens_at_its_worst_stretch_below_a_strip(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = replayed(combination(f"{EFFECT}/high"))
    read = content(shown)
    assert read["long"] == []
    start, end = read["worst"]["record"]
    assert 20.0 <= start < end <= 50.0
    monkeypatch.setattr("labsid.gap.reports.replay_page.LONG", 200)
    longer = content(shown)
    assert longer["long"] == ["record"]
    assert '"name":"strip"' in json.dumps(longer["panels"], separators=(",", ":"))
    assert '"name":"strip"' not in json.dumps(read["panels"], separators=(",", ":"))
    shown["verdict"] = "none"
    assert content(shown)["worst"] == {"record": None}


def test_a_number_at_the_limit_of_its_search_is_said_to_be() -> None:
    ending = slider([1.0, 1.25, 2.5]) | {"moves": [-1.0, -0.5, 0.0]}
    (shown,) = content(replayed(combination(f"{EFFECT}/high", sliders=[ending])))["combinations"]
    assert "Limit of the actuator: upper limit is at the limit of its search." in shown["still"]


def test_a_slider_has_the_digits_of_the_table() -> None:
    base = replayed(combination(f"{EFFECT}/high", sliders=[slider([0.0, 0.0897321, 0.2])]))
    base["effects"][0]["parameters"]["high"]["stderr"] = 0.013
    (own,) = content(base)["combinations"][0]["sliders"]
    assert own["texts"][1] == "0.090 units of u"


def whole(text: str, size: int) -> np.ndarray:
    """Whole numbers of `size` bytes, the lowest bytes of all first."""
    planes = np.frombuffer(base64.b64decode(text), np.uint8).reshape(size, -1).astype(int)
    return np.asarray(sum(plane << (8 * k) for k, plane in enumerate(planes)))


@pytest.mark.parametrize(("noise", "short"), [(0.05, True), (1e-7, False), (0.0, False)])
def test_a_long_record_is_rounded_to_less_than_its_noise(noise: float, short: bool) -> None:
    samples, rng = 6000, np.random.default_rng(0)
    u = rng.standard_normal(samples)
    y = rng.standard_normal(samples).astype("<f4")
    y[[7, 4000]] = np.nan
    before, after = y + np.float32(0.3), np.nan_to_num(y)  # a simulation has samples where the output has none
    signals = {"u": u, "y": y, "before": before, "after": after}
    shown = replayed(combination(f"{EFFECT}/high"))
    shown["gap"] = shown["gap"] | {"noise_floor": noise}
    shown["replay"]["combinations"] = []
    shown["replay"]["record"] |= {name: base64.b64encode(x.tobytes()).decode() for name, x in signals.items()}
    part = content(shown)["parts"]["record"]
    steps = whole(part["u"]["planes"], 3)
    back = part["u"]["low"] + part["u"]["step"] * steps
    np.testing.assert_allclose(back, u, rtol=0, atol=1e-6)  # as precise as in single precision
    if not short:  # a rounded output would have another error
        assert part["y"] == shown["replay"]["record"]["y"]
        return
    found: dict[str, np.ndarray] = {}
    for name in ("y", "before", "after"):
        own, steps = part[name], whole(part[name]["steps"], 2)
        held = np.where(steps == 32768, np.nan, np.where(steps > 32768, steps - 65536, steps))
        found[name] = (found["y"] if own["on_y"] else own["low"]) + own["step"] * held
        assert own["step"] <= 0.1 * noise * (1.0 + 1e-12)
        np.testing.assert_allclose(found[name], signals[name], rtol=0, atol=0.5 * own["step"] + 1e-6, equal_nan=True)
    assert [part[name]["on_y"] for name in ("y", "before", "after")] == [False, True, False]


def test_the_output_after_is_left_out_where_the_page_simulates_it() -> None:
    shown = replayed(combination(f"{EFFECT}/high"))
    shown["replay"]["holdout"] = dict(shown["replay"]["record"])
    shown["holdout_traces"] = shown["traces"]
    (one,) = shown["replay"]["combinations"]
    shown["replay"]["accepted"] = one["names"]
    one["holdout"] = None  # the state in which the holdout starts is not known
    assert ["after" in part for part in content(shown)["parts"].values()] == [False, True]
    one["holdout"] = {"theta": one["theta"], "gains": one["gains"]}
    assert ["after" in part for part in content(shown)["parts"].values()] == [False, False]


def test_a_short_record_is_not_rounded() -> None:
    part = content(replayed(combination(f"{EFFECT}/high")))["parts"]["record"]
    assert isinstance(part["u"], str)
    assert isinstance(part["y"], str)
