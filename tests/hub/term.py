"""A course on a machine with a hub: what the page prints is run as printed."""

import json
import re
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from course_work import ROOT, copy_course

from hub.machine import Machine, library_folders, open_machine, python_program

PAGE = ROOT / "notebooks" / "site" / "jupyterhub.md"
PRELAB = "prelab-sinusoids"
STUDENTS = {"ada": "z1", "ben": "z2", "mallory": "z3"}
SHARED = "/srv/labsid/hand-in"
_LABSID = "import sys; from labsid.cli.commands import main; sys.exit(main(sys.argv[1:]))"
_NBGRADER = "import sys; from nbgrader.apps.nbgraderapp import main; sys.exit(main())"
_SINGLE_USER = "import sys; from jupyterhub.singleuser import main; sys.exit(main())"


def blocks(heading: str, language: str) -> list[str]:
    """The blocks of code of a section of the page."""
    section = re.search(rf"(?ms)^## {re.escape(heading)}\n(.*?)(?=^## |\Z)", PAGE.read_text(encoding="utf-8"))
    assert section is not None, f"the page has no section {heading!r}"
    return re.findall(rf"(?ms)^```{language}\n(.*?)^```", section[1])


@dataclass
class Term:
    """A course on the machine, and what its commands printed.

    Attributes
    ----------
    machine : Machine
    solved, released : dict
        The notebook of the pre-lab, with the model solution and as released.
    said : list of str
        What the blocks of the page printed, in order.
    """

    machine: Machine
    solved: dict[str, Any] = field(default_factory=dict)
    released: dict[str, Any] = field(default_factory=dict)
    said: list[str] = field(default_factory=list)

    def run(self, user: str, script: str) -> str:
        """Run a script that must succeed."""
        done = self.machine.run(user, script)
        assert done.returncode == 0, f"{user}: {script}\n{done.stdout}{done.stderr}"
        return done.stdout + done.stderr

    def answered(self, **changes: str) -> dict[str, Any]:
        """The released notebook with the model solution, or something else, in its answers."""
        notebook = json.loads(json.dumps(self.released))
        solution = {cell["id"]: cell["source"] for cell in self.solved["cells"]}
        for cell in notebook["cells"]:
            if cell["metadata"].get("nbgrader", {}).get("solution"):
                cell["source"] = changes.get(cell["id"].replace("-", "_"), solution[cell["id"]])
        return dict(notebook)

    def settings(self, section: str) -> None:
        """Write the `course.toml` of a section of the page, build and release, and install that for the students."""
        (text,) = blocks(section, "toml")
        self.machine.write("/srv/sysid/course/course.toml", text, owner="ines")
        self.said.append(self.run("ines", blocks("The course", "sh")[0]))
        self.install()

    def install(self) -> None:
        """What the page does with pip, without a network: labsid from the wheel, the rest as it is installed here."""
        script = blocks("What students run", "sh")[0]
        unpack, environment, pip = script.strip().splitlines()
        assert pip == (
            '/opt/labsid/bin/pip install "/srv/labsid/release/labsid-0.1.0-py3-none-any.whl[notebooks]" jupyterhub'
        )
        self.machine.root("rm -rf /srv/labsid/release /opt/labsid")
        self.machine.root(unpack)
        self.machine.root(environment.replace("python3", sys.executable) + " --without-pip")
        version = f"python{sys.version_info.major}.{sys.version_info.minor}"
        packages = f"/opt/labsid/lib/{version}/site-packages"
        wheel = re.findall(r"/srv\S+\.whl", pip)[0]
        self.machine.root(f"unzip -q {wheel} -d {packages}")
        self.machine.write(f"{packages}/others.pth", "\n".join(library_folders()) + "\n")
        for name, statement in {"labsid": _LABSID, "jupyterhub-singleuser": _SINGLE_USER}.items():
            self.machine.write(
                f"/opt/labsid/bin/{name}", python_program(statement, "/opt/labsid/bin/python"), mode="755"
            )


@contextmanager
def open_term(folder: Path) -> Iterator[Term]:
    """A machine with a course, an instructor and three students, up to the release."""
    own = copy_course(folder, PRELAB)
    shutil.copyfile(ROOT / "pyproject.toml", own.root / "pyproject.toml")
    rows = "".join(f"{number},{name.title()},{name}\n" for name, number in STUDENTS.items())
    (own.root / "students.csv").write_text(f"id,name,username\n{rows}", encoding="utf-8")
    with open_machine() as machine:
        for user in ("ines", *STUDENTS):
            machine.add_user(user)
        term = Term(machine)
        machine.write("/opt/bin/labsid", python_program(_LABSID), mode="755")
        machine.write("/opt/bin/nbgrader", python_program(_NBGRADER), mode="755")
        machine.root(blocks("Folders", "sh")[0])
        machine.copy(own.root, "/srv/sysid/course", owner="ines")
        term.settings("The course")
        term.solved = json.loads(machine.root(f"cat /srv/sysid/course/autograder/source/{PRELAB}/{PRELAB}.ipynb"))
        term.released = json.loads(machine.root(f"cat /srv/labsid/release/{PRELAB}/{PRELAB}.ipynb"))
        yield term
