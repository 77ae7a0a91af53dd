"""Simulated records of kinds that people ask about: what is said of each is true, and nothing is invented."""

import json
from pathlib import Path
from typing import NamedTuple

import pytest
from gap_story import disagreements
from representatives import mostly_exhaustive

from labsid.blind.honest import has_right_numbers, is_accepted, wrong_names
from labsid.blind.metrics import CaseOutcome
from labsid.cli.commands import main

pytestmark = pytest.mark.slow

NONE: tuple[str, ...] = ()
SIMULATION = {"itself-json": ".sim.json", "free-far": ".py:simulate", "free-pair": ".py:simulate"} | dict.fromkeys(
    ("itself-output", "simulated-output-limit", "simulated-output-none"), ".sim.csv"
)
"""Ending of the argument of ``--sim``."""

FREE = {
    "free-far": {"determined": {"gain": 1.9172, "tau": 0.7363}, "undetermined": [], "combination": "", "value": 0.0},
    "free-pair": {
        "determined": {"tau": 0.7363},
        "undetermined": ["ka", "kb"],
        "combination": "ka*kb",
        "value": 1.9172,
    },
}
"""The true numbers of ``--free``."""


class Found(NamedTuple):
    """A record of the folder, and its right answers (no effect is ``none``)."""

    name: str
    answers: tuple[tuple[str, ...], ...]


FOUND = (
    Found("direct-gain-multisine", (NONE,)),
    Found("direct-lead-chirp", (NONE,)),
    Found("direct-washout-steps", (NONE,)),
    Found("exact-17-digits", (NONE,)),
    Found("exact-6-digits", (NONE,)),
    Found("exact-static", (NONE,)),
    Found("exact-delay", (NONE, ("input-delay",))),
    Found("itself-json", (NONE,)),
    Found("itself-output", (NONE,)),
    Found("coarse-command", (NONE, ("unknown",), ("input-quantization",))),
    Found("command-off", (("input-off",),)),
    Found("command-off-for-a-while", (("input-off",),)),
    Found("simulated-output-limit", (("input-saturation",),)),
    Found("simulated-output-none", (NONE,)),
    Found("free-far", (("parameter-mismatch",),)),
    Found("free-pair", (("parameter-mismatch",),)),
    Found("clipped-1", (("output-saturation",),)),
    Found("clipped-2", (("output-saturation",),)),
)


ONE_OF_EACH_KIND = (
    "exact-6-digits",
    "itself-output",
    "clipped-2",
)
"""Tested everywhere. For the other kinds there are further tests: a command that is off and free numbers on these very
records, a coarse log, direct terms (`test_direct_term.py`), and simulated outputs (`test_simulated_output.py`)."""


@pytest.fixture
def found_data(shared_data: Path) -> Path:
    folder = shared_data / "found"
    if not folder.is_dir():
        pytest.skip(f"the records of ordinary kinds are not on this machine (looked in {folder})")
    return folder


def outcome(folder: Path, found: Found, written: Path) -> CaseOutcome:
    """What the command answers, beside what is right."""
    words = ["gap", "diagnose", str(folder / f"{found.name}.csv"), "--json", str(written)]
    if found.name in SIMULATION:
        words += ["--sim", str(folder / f"{found.name}{SIMULATION[found.name]}")]
    numbers = FREE.get(found.name)
    if numbers is not None:
        words += ["--free", ",".join([*numbers["undetermined"], *numbers["determined"]])]
    assert main(words) == 0
    label = {"row": "found", "labels": [], "answers": [list(answer) for answer in found.answers], "numbers": numbers}
    return CaseOutcome(label, json.loads(written.read_text(encoding="utf-8")))


@pytest.mark.parametrize("found", mostly_exhaustive(FOUND, ONE_OF_EACH_KIND, lambda found: found.name))
def test_the_answer_is_right_and_names_nothing_else(found: Found, found_data: Path, tmp_path: Path) -> None:
    case = outcome(found_data, found, tmp_path / "report.json")
    assert case.result is not None
    said = {effect["name"]: effect["probability"] for effect in case.result["effects"]}
    assert not wrong_names(case, 0.5), said
    assert is_accepted(case), (case.result["verdict"], said)
    assert has_right_numbers(case), case.result["simulation"]["numbers"]
    assert not disagreements(case.result)
    if found.name == "coarse-command":
        assert any("logged in steps of 0.02" in text for text in case.result["screen"])


def test_every_record_of_the_folder_has_an_answer_here(found_data: Path) -> None:
    records = {path.stem for path in found_data.glob("*.csv") if not path.stem.endswith(".sim")}
    assert records == {found.name for found in FOUND}
