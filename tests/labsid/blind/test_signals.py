"""The rows of several signals: what is drawn, what a record holds, and what its label says."""

import json
from pathlib import Path

import numpy as np
import pytest

from labsid.blind.experiment import OrdinaryCase
from labsid.blind.record_folders import main
from labsid.blind.runner import diagnose_words
from labsid.blind.signals import NONE_KINDS, draw_signals_clear
from labsid.blind.strength import CLEAR_RATIOS, HARD_RATIOS
from labsid.blind.suite import label_dict
from labsid.rig.switchable.coupled.effects import EFFECTS

COUNTS = {"signals": 4, "signals-hard": 2, "signals-none": len(NONE_KINDS)}
BETWEEN = {"signals": CLEAR_RATIOS, "signals-hard": HARD_RATIOS}


def table(case: OrdinaryCase) -> tuple[list[str], np.ndarray]:
    header, *lines = case.made.files[".csv"].splitlines()
    return header.split(","), np.array([line.split(",") for line in lines], dtype=float)


@pytest.fixture(scope="module")
def some(dev_cases) -> dict[str, list[OrdinaryCase]]:
    return {row: dev_cases(row, count) for row, count in COUNTS.items()}


def test_the_effects_take_turns_and_are_as_large_as_their_row_asks(some) -> None:
    for row, (low, high) in BETWEEN.items():
        labels = [label_dict(case) for case in some[row]]
        assert [label["labels"] for label in labels] == [[name] for name in EFFECTS[: COUNTS[row]]]
        for label in labels:
            truth = label["truth"]
            assert 0.9 * low < truth["ratio"] < 1.1 * high
            assert truth["ratio"] == max(truth["ratios"].values())
            (effect,) = truth["effects"]
            assert effect["signal"] in (None, *truth["inputs"], *truth["outputs"])
            assert set(effect["visible"]) <= set(effect["outputs"]) <= set(truth["outputs"])
            assert effect["visible"]


def test_a_record_has_moving_signals_and_noise_as_stated(some) -> None:
    for case in [case for cases in some.values() for case in cases]:
        names, numbers = table(case)
        truth = case.made.truth
        assert names == ["t", *truth["inputs"], *truth["outputs"]]
        assert np.isfinite(numbers).all()
        assert 600 <= numbers.shape[0] == truth["samples"] <= 2500
        assert np.allclose(np.diff(numbers[:, 0]), truth["Ts"])
        assert np.all(np.ptp(numbers[:, 1:], axis=0) > 0.0)
        for name, sd in truth["noise"].items():
            assert 0.0 < sd < 0.06 * np.std(numbers[:, names.index(name)])


def test_named_columns_have_options_and_the_others_need_none(some) -> None:
    cases = [case for cases in some.values() for case in cases]
    for case in cases:
        inputs, outputs = (",".join(case.made.truth[key]) for key in ("inputs", "outputs"))
        named = not inputs.startswith("u1")
        words = ["--inputs", inputs, "--outputs", outputs] if named else []
        assert list(case.options) == words
        assert diagnose_words(case) == ["gap", "diagnose", f"{case.name}.csv", *words]
        assert case.made.files.get(".options", "").split() == words
    assert {bool(case.options) for case in cases} == {True, False}


def test_without_an_effect_the_linear_model_leaves_less_than_a_tenth_of_the_noise(some) -> None:
    cases = some["signals-none"]
    assert [case.made.truth["case"] for case in cases] == list(NONE_KINDS)
    for case in cases:
        assert case.made.answers == ((),)
        assert case.made.truth["effects"] == []
        assert case.made.truth["ratio"] <= 0.1 or case.made.truth["case"] == "part of a sample"


def test_a_draw_is_repeated_by_its_seed() -> None:
    one, two = (draw_signals_clear(np.random.default_rng([7, 2, 0]), 2, "x") for _ in range(2))
    assert one is not None
    assert two is not None
    assert one.made.files == two.made.files
    assert label_dict(one) == label_dict(two)


@pytest.mark.usefixtures("drawn_once")
def test_records_are_written_with_their_labels_apart(some, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    main([str(tmp_path), "--row", "signals", "--per-row", str(COUNTS["signals"])])
    assert capsys.readouterr().out.split() == [str(tmp_path / "signals" / "labels.json")]
    labels = json.loads((tmp_path / "signals" / "labels.json").read_text(encoding="utf-8"))
    files = list((tmp_path / "signals" / "records").iterdir())
    assert set(labels) == {file.stem for file in files} == {case.name for case in some["signals"]}
    text = "".join(file.read_text(encoding="utf-8") for file in files)
    assert not any(effect in text for effect in EFFECTS)
