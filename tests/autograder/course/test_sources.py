"""Which source files a result depends on, and where the gradebook is."""

from pathlib import Path

import pytest

from autograder.batch.fingerprint import JUDGING
from autograder.course import sources
from autograder.course.sources import imported_modules, source_path, sources_hash
from autograder.results import gradebook
from autograder.sandbox.isolation import LEVELS, is_weaker

LAB = "labsid.checks.assignments.lab_identification"


def test_an_assignment_depends_on_its_checks_and_the_reference_and_not_on_another() -> None:
    found = imported_modules((LAB, *JUDGING))
    assert {
        "labsid.checks.assignments.lab_identification.offset_step",
        "labsid.least_squares.solve",
        "labsid.rig",
        "autograder.judge.judging",
    } <= found
    assert "labsid.checks.assignments.prelab_sinusoids" not in found
    assert not any(name.startswith(("labsid.gap", "autograder.results.report", "autograder.cli")) for name in found)


def test_a_changed_file_changes_the_hash_of_what_imports_it_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    prelab = "labsid.checks.assignments.prelab_sinusoids"
    before = sources_hash(LAB), sources_hash(prelab)
    offsets = source_path("labsid.checks.assignments.lab_identification.offset_step")
    assert offsets is not None
    (tmp_path / "edited.py").write_bytes(offsets.read_bytes() + b"\n# edited\n")

    def edited(name: str) -> Path | None:
        return (
            tmp_path / "edited.py"
            if name == "labsid.checks.assignments.lab_identification.offset_step"
            else source_path(name)
        )

    monkeypatch.setattr(sources, "source_path", edited)
    sources_hash.cache_clear()
    try:
        assert sources_hash(LAB) != before[0]
        assert sources_hash(prelab) == before[1]
    finally:
        sources_hash.cache_clear()


@pytest.mark.parametrize("name", ["numpy.linalg", "labsid.nosuch", "labsid.records.record.Record", "os"])
def test_what_is_no_module_of_ours_has_no_source(name: str) -> None:
    assert source_path(name) is None


def test_a_result_of_less_isolation_than_there_is_nowis_weaker() -> None:
    assert LEVELS[-1] == "none"
    for level in LEVELS[:-1]:
        assert is_weaker("none", level)
        assert not is_weaker(level, "none")
    assert not is_weaker("none", "none")
    assert not is_weaker("of another version", LEVELS[0])


def test_the_gradebook_is_where_nbgraders_own_setting_says(tmp_path: Path) -> None:
    assert gradebook.database_url(tmp_path) == f"sqlite:///{tmp_path / 'gradebook.db'}"
    config = tmp_path / "nbgrader_config.py"
    config.write_text('c = get_config()\nc.CourseDirectory.db_url = "postgresql://localhost/class"\n', encoding="utf-8")
    assert gradebook.database_url(tmp_path) == "postgresql://localhost/class"
    config.write_text("c = get_config()\n", encoding="utf-8")
    assert gradebook.database_url(tmp_path) == f"sqlite:///{tmp_path / 'gradebook.db'}"
    config.write_text("raise RuntimeError('no')\n", encoding="utf-8")
    with pytest.raises(ValueError, match="cannot be read: RuntimeError: no"):
        gradebook.database_url(tmp_path)
