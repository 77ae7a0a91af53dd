"""A term on JupyterHub with the lines of the page: released, worked on, handed in, graded, returned; and attacked.

The hub, its proxy, the servers, the kernels and the users are real ones. Without JupyterHub the same is done in
terminals, and what needs it is skipped.
"""

import csv
import io
import json
import re
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import partial
from importlib.util import find_spec

import pytest

from hub.attempts import AFTER, BEFORE, PRIVATE
from hub.machine import home_of, missing
from hub.servers import RunningHub, open_hub
from hub.term import PRELAB, SHARED, Term, blocks, open_term

NO_HUB = find_spec("jupyterhub") is None or find_spec("configurable_http_proxy") is None
MISTAKE = {"prelab_1_time_answer": "t = np.linspace(0, 100, 1000).reshape(-1, 1)"}
CLOCK = "It starts at 0.95, because 20 s are cut off. With t_new the formula is sin(0.02 pi t_new + 0.4 pi)."
NOTEBOOK = f"{PRELAB}/{PRELAB}.ipynb"


@dataclass
class HandedIn:
    """What was handed in, by whom, and what was said.

    Attributes
    ----------
    term : Term
    hub : RunningHub or None
    said : dict
        What students and instructor were told, by who and what.
    """

    term: Term
    hub: RunningHub | None
    said: dict[str, str]

    def as_student(self, user: str, source: str) -> str:
        """Run Python as a student: in a kernel of the student's server, or in a terminal."""
        if self.hub is not None and user == "mallory":
            return self.hub.run_cell(user, source)
        self.term.machine.write(f"{home_of(user)}/cell.py", source, owner=user)
        return self.term.run(user, f"cd sysid && /opt/labsid/bin/python -P {home_of(user)}/cell.py")


@pytest.fixture(scope="module")
def term(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Term]:
    why = missing()
    if why:
        pytest.skip(why)
    with open_term(tmp_path_factory.mktemp("course")) as opened:
        yield opened


@pytest.fixture(scope="module")
def handed_in(term: Term) -> Iterator[HandedIn]:
    """Mallory prepares; ada hands in from her server's start page, ben twice from a terminal."""
    with nullcontext() if NO_HUB else open_hub(term.machine, blocks("What students run", "python")[0]) as hub:
        done = HandedIn(term, hub, {})
        for user in ("mallory", "ben") if hub is not None else ("mallory", "ben", "ada"):
            term.run(user, "/opt/labsid/bin/labsid lab --no-open --folder sysid")
        if hub is not None:
            hub.start_server("mallory")
        term.machine.write(
            f"{home_of('mallory')}/sysid/{NOTEBOOK}", json.dumps(term.answered(**MISTAKE)), owner="mallory"
        )
        before = BEFORE.format(shared=SHARED, notebook=f"{home_of('mallory')}/sysid/{NOTEBOOK}", assignment=PRELAB)
        assert done.as_student("mallory", before).strip() == "prepared"
        for number, answers in enumerate((MISTAKE, {"prelab_6_clock": CLOCK}), 1):
            term.machine.write(f"{home_of('ben')}/sysid/{NOTEBOOK}", json.dumps(term.answered(**answers)), owner="ben")
            done.said[f"ben {number}"] = term.run("ben", "/opt/labsid/bin/labsid submit --yes --folder sysid")
        if hub is not None:
            hub.start_server("ada")
            done.said["start page"] = json.dumps(hub.read("ada", "start.ipynb"))
            assert hub.read("ada", NOTEBOOK)["cells"][0] == term.released["cells"][0] | {
                "source": "".join(term.released["cells"][0]["source"])
            }
            hub.save("ada", NOTEBOOK, term.answered(prelab_6_clock=CLOCK))
            done.said["ada"] = hub.run_cell("ada", _cell(done.said["start page"], "submit"))
        else:
            term.machine.write(f"{home_of('ada')}/sysid/{NOTEBOOK}", json.dumps(term.answered()), owner="ada")
            done.said["ada"] = done.as_student("ada", "from labsid.hand_in import submit\nsubmit()")
        yield done


@pytest.fixture(scope="module")
def returned(handed_in: HandedIn) -> HandedIn:
    """The instructor collects, grades and returns, and students fetch their feedback, with the lines of the page."""
    script = blocks("Collect, grade, return", "sh")[0]
    handed_in.said["ines"] = handed_in.term.run("ines", script)
    fetch = "from labsid.hand_in import fetch_feedback\nfetch_feedback()"
    for user in ("ada", "ben"):
        handed_in.said[f"{user} fetched"] = handed_in.as_student(user, fetch)
    return handed_in


def _cell(notebook: str, name: str) -> str:
    return next("".join(cell["source"]) for cell in json.loads(notebook)["cells"] if cell["id"] == name)


def _marks(term: Term, out: str) -> dict[str, str]:
    rows = csv.DictReader(io.StringIO(term.machine.root(f"cat {out}/grades.csv")))
    return {row["student"] + " " + row["question"]: row["score"] for row in rows}


@pytest.mark.skipif(NO_HUB, reason="JupyterHub or its proxy is not installed: pip install 'labsid[hub]'")
def test_the_server_opens_on_the_release_and_its_cells_hand_in_and_fetch(returned: HandedIn) -> None:
    assert "fetch_feedback()" in _cell(returned.said["start page"], "fetch")
    assert f"Handed in: {PRELAB}, as {SHARED}/ada-2/" in returned.said["ada"]
    assert returned.hub is not None
    page = returned.hub.read("ada", f"{PRELAB}/feedback.html")
    assert "Ada" in page


def test_a_hand_in_has_its_owner_the_group_of_the_instructors_and_no_rights_for_others(handed_in: HandedIn) -> None:
    listed = handed_in.term.machine.root(f"cd {SHARED} && stat -c '%U %G %a %n' ben ben/*.zip ada-2 ada-2/*.zip")
    rights = [line.split()[:3] for line in listed.splitlines()]
    folder, file = ["sysid-staff", "2770"], ["sysid-staff", "640"]
    assert rights == [["ben", *folder], ["ben", *file], ["ben", *file], ["ada", *folder], ["ada", *file]]
    assert "You may do so again" in handed_in.said["ben 1"]


def test_the_last_hand_in_counts_with_the_time_of_the_file_system(returned: HandedIn) -> None:
    marks = _marks(returned.term, "/srv/sysid/graded")
    assert marks["z2 prelab-1-time"] == marks["z1 prelab-1-time"] == "0.1"
    assert marks["z3 prelab-1-time"] == "0"
    for student in ("z1", "z2", "z3"):
        text = returned.term.machine.root(f"cat /srv/sysid/submitted/{student}/{PRELAB}/timestamp.txt")
        when = datetime.strptime(text.strip(), "%Y-%m-%d %H:%M:%S UTC").replace(tzinfo=UTC)
        assert datetime.now(UTC) - when < timedelta(hours=1), f"{student} handed in at {text}"


def test_what_is_forged_belongs_to_its_owner_and_links_are_not_followed(returned: HandedIn) -> None:
    said = returned.said["ines"]
    assert re.search(rf"(?m)^z3 \(mallory\): {PRELAB}", said)
    assert "belongs to nobody, or cannot be read: pipe.zip (neither a file nor a folder), zoe" in said
    collected = returned.term.machine.root("ls /srv/sysid/submitted").split()
    assert collected == ["students.csv", "z1", "z2", "z3"]
    students = returned.term.machine.root("cat /srv/sysid/course/students.csv")
    assert students.startswith("id,name,username\nz1,Ada,ada\n")


def test_each_student_gets_the_own_feedback_and_nobody_else_can_read_it(returned: HandedIn) -> None:
    machine = returned.term.machine
    for user, name, folder in (("ada", "Ada", "ada-2"), ("ben", "Ben", "ben")):
        assert f"Feedback: {PRELAB}/feedback.html" in returned.said[f"{user} fetched"]
        page = f"{SHARED}/{folder}/feedback-{PRELAB}.html"
        assert name in returned.term.run(user, f"cat {page}")
        others = [other for other in ("ada", "ben", "mallory") if other != user]
        assert all(machine.run(other, f"cat {page}").returncode for other in others)
    page = f"{SHARED}/mallory/feedback-{PRELAB}.html"
    assert "Mallory" in machine.root(f"test ! -L {page} && cat {page}")
    assert machine.run("mallory", f"cat {SHARED}/ada/feedback-{PRELAB}.html").returncode
    assert "Returned 3 pages to 3 students" in returned.said["ines"]


def test_a_student_reaches_nothing_of_others_and_nothing_of_the_course(returned: HandedIn) -> None:
    machine = returned.term.machine
    file = machine.root(f"ls {SHARED}/ben/*.zip").split()[0]
    owner = machine.root("id -u ada").strip()
    source = AFTER.format(shared=SHARED, file=file, assignment=PRELAB, uid=owner, private=PRIVATE, home=home_of("ben"))
    lines = returned.as_student("mallory", source).splitlines()
    assert lines.pop() == "end"
    assert len(lines) == 14 + len(PRIVATE)
    assert [line for line in lines if not line.startswith("refused")] == []
    for path in (file, f"{SHARED}/ben/feedback-{PRELAB}.html", *PRIVATE):  # they are there
        machine.root(f"test -s '{path}'")


def test_a_folder_that_others_can_enter_gets_no_feedback(returned: HandedIn) -> None:
    machine = returned.term.machine
    machine.run("ben", f"chmod 777 {SHARED}/ben")
    try:
        said = returned.term.run("ines", "cd /srv/sysid/course && labsid course return --out /srv/sysid/graded")
        assert f"z2: nothing returned: others can enter {SHARED}/ben" in said
        assert "Returned 2 pages to 2 students" in said
        again = returned.term.run("ben", "/opt/labsid/bin/labsid submit --yes --folder sysid")
        assert f"as {SHARED}/ben-2/" in again
    finally:
        machine.root(f"chmod 2770 {SHARED}/ben")


def test_containers_in_which_everybody_is_one_user_are_told_apart_by_the_names_of_their_folders(
    returned: HandedIn,
) -> None:
    machine, staff = returned.term.machine, "/srv/containers/hand-in"
    machine.root(
        f"install -d -o ines -g sysid-staff -m 2770 {staff} {staff}/ben {staff}/ada && "
        f"runuser -u ines -- cp $(ls {SHARED}/ben/*.zip | tail -1) {staff}/ben/"
    )
    command = f"cd /srv/sysid/course && labsid course collect {staff} --out /srv/sysid/from-containers"
    said = returned.term.run("ines", command)
    assert re.search(rf"(?m)^z2 \(ben\): {PRELAB}$", said)
    assert "z1" not in said


@pytest.fixture(scope="module")
def exchanged(returned: HandedIn) -> HandedIn:
    """The same with nbgrader's exchange, with the lines of the page."""
    term, heading = returned.term, "With nbgrader's exchange"
    folders, release = blocks(heading, "sh")
    term.machine.root(folders)
    term.machine.write("/etc/jupyter/nbgrader_config.py", blocks(heading, "python")[0])
    term.settings(heading)
    run = partial(term.run, "ines")
    run(release)
    returned.said["exchange ben"] = term.run("ben", "/opt/labsid/bin/labsid submit --yes --folder sysid")
    script = blocks("Collect, grade, return", "sh")[0].replace(SHARED, "/srv/nbgrader/exchange/sysid/inbound")
    script = script.replace("/srv/sysid/submitted", "/srv/sysid/exchanged").replace(
        "/srv/sysid/graded", "/srv/sysid/out"
    )
    returned.said["exchange ines"] = run(script)
    returned.said["exchange feedback"] = term.run("ben", "/opt/labsid/bin/labsid feedback --folder sysid")
    return returned


@pytest.mark.exhaustive
def test_with_the_exchange_of_nbgrader_the_same_commands_do(exchanged: HandedIn) -> None:
    term = exchanged.term
    assert f"Handed in with nbgrader: {PRELAB}" in exchanged.said["exchange ben"]
    assert re.search(rf"(?m)^z2 \(ben\): {PRELAB}$", exchanged.said["exchange ines"])
    assert "Returned 1 pages to 1 students" in exchanged.said["exchange ines"]
    assert _marks(term, "/srv/sysid/out")["z2 prelab-1-time"] == "0.1"
    (page,) = re.findall(r"Feedback: (\S.*\.html)", exchanged.said["exchange feedback"])
    assert "Ben" in term.run("ben", f"cat '{page}'")


def test_in_the_exchange_nobody_lists_hand_ins_or_feedback_or_hands_in_for_another(exchanged: HandedIn) -> None:
    term, root = exchanged.term, "/srv/nbgrader/exchange/sysid"
    for folder in ("inbound", "feedback"):
        assert term.machine.run("mallory", f"ls {root}/{folder}").returncode
    forged = f"'{root}/inbound/ben+{PRELAB}+2020-01-01 00:00:00 UTC+x'"
    term.run("mallory", f"mkdir -m 777 {forged} && cp sysid/{NOTEBOOK} {forged}")
    command = f"cd /srv/sysid/course && labsid course collect {root}/inbound --out /srv/sysid/exchanged-2"
    said = term.run("ines", command)
    assert re.search(rf"(?m)^z2 \(ben\): {PRELAB}$", said)
    assert re.search(rf"(?m)^z3 \(mallory\): {PRELAB}$", said)
    assert "2020" not in term.machine.root(f"cat /srv/sysid/exchanged-2/z3/{PRELAB}/timestamp.txt")


def test_individual_data_reach_their_student_alone(term: Term) -> None:
    machine = term.machine
    machine.root(
        "mkdir -p /srv/sysid/release-packages && cd /srv/sysid/release-packages && echo own > data.txt && "
        f"{_ZIP} ada.zip data.txt && {_ZIP} ben.zip data.txt"
    )
    machine.root(blocks("What students run", "sh")[1])
    for user, other in (("ada", "ben"), ("ben", "ada")):
        assert term.run(user, "cat sysid/data.txt") == "own\n"
        assert machine.run(other, f"cat {home_of(user)}/sysid/data.txt").returncode


_ZIP = "python3 -m zipfile -c"
