"""The page of every effect agrees with what the diagnosis reports."""

import pytest
from gap_reports import PARAMETERS, path_of

from labsid.cli.commands import main
from labsid.gap.effects.families import DESCRIPTIONS
from labsid.gap.reports.effect_guide import effect_page


def test_every_effect_has_a_page_with_its_parameters_and_units() -> None:
    assert set(DESCRIPTIONS) == set(PARAMETERS)
    for name, guide in DESCRIPTIONS.items():
        reported = {parameter: entry["unit"] for parameter, entry in PARAMETERS[name].items()}
        assert reported.items() <= {parameter: one.unit for parameter, one in guide.parameters.items()}.items()
        assert guide.path == path_of(name)
        assert name not in guide.confused_with
        assert set(guide.confused_with) <= set(DESCRIPTIONS)


def test_the_command_lists_all_and_explains_one(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["gap", "effects"]) == 0
    listed = capsys.readouterr().out
    assert all(name in listed for name in DESCRIPTIONS)
    assert main(["gap", "effects", "input-dead-zone"]) == 0
    said = capsys.readouterr().out
    assert "confused with  dry friction (coulomb-friction)" in said
    assert "low: lower edge of the band (units of u)" in said
    assert max(map(len, said.splitlines())) <= 96
    assert main(["gap", "effects", "gremlins"]) == 2
    assert "there is no effect 'gremlins'; there are input-delay" in capsys.readouterr().err
    with pytest.raises(ValueError, match="there is no effect"):
        effect_page("")
