"""Hand-in on a hub, as the student's command does it; `tests/hub` has users of their own, and the hub."""

import json
import os
import stat
import sys
from datetime import UTC, datetime
from pathlib import Path

import pytest

from labsid.cli.commands import main
from labsid.hand_in.hub import Hub, fetch_from_folder, folder_names, put_into_folder, read_hub, user_name
from labsid.hand_in.start_page import start_notebook

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="hubs run on Linux")
NOW = datetime(2026, 3, 2, 9, 0, tzinfo=UTC)


@pytest.fixture
def shared(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A shared folder, and a user who is called ada."""
    monkeypatch.setattr("getpass.getuser", lambda: "ada")
    folder = tmp_path / "shared"
    folder.mkdir()
    return folder


def mode_of(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode) & 0o777


def test_a_hand_in_is_private_whatever_the_umask(shared: Path) -> None:
    before = os.umask(0)
    try:
        written = [put_into_folder(shared, content, NOW) for content in (b"one", b"two")]
        assert os.umask(0) == 0
    finally:
        os.umask(before)
    assert [path.read_bytes() for path in written] == [b"one", b"two"]
    assert {path.parent for path in written} == {shared / "ada"}
    assert all(path.name.startswith("2026-03-02-090000-") for path in written)
    assert (mode_of(shared / "ada"), mode_of(written[0])) == (0o770, 0o640)
    assert len(list((shared / "ada").iterdir())) == 2


def test_a_folder_that_others_can_enter_or_a_link_is_not_used(shared: Path, tmp_path: Path) -> None:
    (shared / "ada").mkdir()
    (shared / "ada").chmod(0o775)
    (shared / "ada-2").symlink_to(tmp_path)
    (shared / "ada-3").touch()
    assert put_into_folder(shared, b"one", NOW).parent == shared / "ada-4"
    for name in folder_names("ada")[3:]:
        (shared / name).mkdir(exist_ok=True)
        (shared / name).chmod(0o707)
    with pytest.raises(ValueError, match=r"the folders ada to ada-9 in .* are not yours, or others can enter them"):
        put_into_folder(shared, b"one", NOW)


def test_what_is_missing_is_said(shared: Path) -> None:
    with pytest.raises(ValueError, match=r"is not on this machine\. Run labsid submit on the hub"):
        put_into_folder(shared / "nowhere", b"one", NOW)


def test_feedback_is_copied_beside_the_notebook_once(shared: Path, tmp_path: Path) -> None:
    folder = put_into_folder(shared, b"one", NOW).parent
    assert fetch_from_folder(shared, tmp_path / "work") == []
    (folder / "feedback-lab.html").write_text("page", encoding="utf-8")
    target = tmp_path / "work" / "lab" / "feedback.html"
    assert fetch_from_folder(shared, tmp_path / "work") == [target]
    assert target.read_text(encoding="utf-8") == "page"
    assert fetch_from_folder(shared, tmp_path / "work") == []


def test_in_a_container_the_name_is_that_of_the_hub(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("JUPYTERHUB_USER", "ben")
    monkeypatch.setattr("getpass.getuser", lambda: "jovyan")
    assert user_name() == "ben"
    monkeypatch.setattr("getpass.getuser", lambda: "ada")
    assert user_name() == "ada"


@pytest.mark.parametrize("hub", [Hub(hand_in=Path("/srv/x")), Hub(exchange=Path("/srv/e"), course="sysid")])
def test_the_release_says_where_to_hand_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, hub: Hub) -> None:
    monkeypatch.setattr("labsid.hand_in.hub.release_folder", lambda: tmp_path)
    assert read_hub() is None
    (tmp_path / "hub.json").write_bytes(hub.to_json())
    assert read_hub() == hub


def test_only_a_release_for_a_hub_has_cells_that_hand_in() -> None:
    pages = {on_hub: json.loads(start_notebook([], {}, "", on_hub=on_hub)) for on_hub in (True, False)}
    code = {key: [cell["id"] for cell in page["cells"] if cell["cell_type"] == "code"] for key, page in pages.items()}
    assert code == {True: ["how-far", "submit", "fetch"], False: ["how-far"]}


def test_without_a_hub_there_is_no_feedback_to_fetch(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("labsid.hand_in.hub.release_folder", lambda: None)
    assert main(["feedback", "--folder", str(tmp_path)]) == 2
    assert "this release says of no hub from which feedback comes" in capsys.readouterr().err
