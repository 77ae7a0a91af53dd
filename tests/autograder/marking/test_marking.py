"""Open questions marked in the browser: what is shown, what is written, and who may ask."""

import csv
import http.client
import json
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from decimal import Decimal
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from autograder.batch.executors import LocalExecutor
from autograder.batch.grade import grade_batch
from autograder.batch.selection import find_batch
from autograder.course.layout import Course
from autograder.course.students import Student
from autograder.marking.answers import open_questions
from autograder.marking.server import MAX_BODY, MarkingApp, make_server
from autograder.results import gradebook
from autograder.results.feedback import write_feedback
from autograder.results.formulas import formula_html
from autograder.results.gradebook import Mark
from autograder.results.grades import write_grades
from autograder.results.prose import MAX_CHARACTERS, prose_html
from autograder.results.summary import class_table
from autograder.sandbox.isolation import ProcessLauncher

PRELAB, OPEN = "prelab-sinusoids", "prelab-6-clock"
NOW = datetime(2026, 11, 24, 12, 0, tzinfo=UTC)
TEXTS = {
    "ann": "# Because\n\nThe *clock* starts at $t_0$.\n\n<script>alert(1)</script> [x](javascript:alert(1))",
    "bob": "It does not start from rest.",
    "cat": "",
}


@pytest.fixture(scope="module")
def graded(course: Course, launcher: ProcessLauncher, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Ann and Bob answer the open question, Cat answers only the others."""
    folder = tmp_path_factory.mktemp("class")
    for student, text in TEXTS.items():
        notebook = json.loads((course.source / PRELAB / f"{PRELAB}.ipynb").read_text(encoding="utf-8"))
        (cell,) = (cell for cell in notebook["cells"] if cell["id"] == OPEN)
        cell["source"] = text
        (folder / "in" / student / PRELAB).mkdir(parents=True)
        (folder / "in" / student / PRELAB / f"{PRELAB}.ipynb").write_text(json.dumps(notebook), encoding="utf-8")
    list(grade_batch(course, find_batch(course, folder / "in"), folder / "out", LocalExecutor(launcher, 2)))
    gradebook.enter_students(folder / "out", [Student("ann", "Ann Öz")])
    return folder / "out"


@pytest.fixture
def out(graded: Path, tmp_path: Path) -> Path:
    shutil.copytree(graded, tmp_path / "out")
    return tmp_path / "out"


@dataclass(frozen=True)
class Client:
    """Sends requests to a server of the pages."""

    app: MarkingApp
    port: int
    server: Any = None

    def __call__(
        self, method: str, path: str, body: Any = None, raw: bytes | None = None, **headers: str
    ) -> tuple[int, str, http.client.HTTPMessage]:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        sent = json.dumps(body).encode() if raw is None else raw
        given = {name.replace("_", "-"): value for name, value in headers.items()}
        if method == "POST":
            given = {"Content-Type": "application/json"} | given
        connection.request(method, path, sent if method == "POST" else None, given)
        reply = connection.getresponse()
        text = reply.read().decode()
        connection.close()
        return reply.status, text, reply.headers

    @property
    def question(self) -> str:
        return f"/{self.app.token}/{PRELAB}/{OPEN}"

    def mark(self, student: str, score: Any, comment: str = "") -> tuple[int, dict[str, Any]]:
        status, text, _ = self("POST", self.question, {"student": student, "score": score, "comment": comment})
        return status, json.loads(text)


@pytest.fixture
def client(out: Path, course: Course) -> Iterator[Client]:
    app = MarkingApp(out, open_questions(out, course), "Dr Öz", lambda: NOW)
    server = make_server(app)
    thread = Thread(target=server.serve_forever, args=[0.01], daemon=True)  # seconds until it sees that it ends
    thread.start()
    yield Client(app, server.server_port, server)
    server.shutdown()
    server.server_close()


def grade_in_gradebook(out: Path, student: str) -> tuple[float | None, float, bool, str | None]:
    with gradebook.open_gradebook(gradebook.database_url(out)) as book:
        grade = book.find_grade(OPEN, PRELAB, PRELAB, student)
        comment = book.find_comment(OPEN, PRELAB, PRELAB, student)
        return grade.manual_score, grade.score, grade.needs_manual_grade, comment.comment


def row_of(out: Path, student: str) -> dict[str, str]:
    write_grades(out)
    with (out / "grades.csv").open(encoding="utf-8", newline="") as file:
        return next(row for row in csv.DictReader(file) if (row["student"], row["question"]) == (student, OPEN))


# ---- what is shown


def test_an_unanswered_question_has_no_marks_at_once_and_is_not_shown(out: Path, course: Course) -> None:
    (shown,) = open_questions(out, course)
    assert [answer.student for answer in shown.answers] == ["ann", "bob"]
    assert (shown.waiting, shown.max_score, shown.steps[1]) == (2, Decimal("0.05"), Decimal("0.0125"))
    assert row_of(out, "cat")["score"] == "0"
    assert row_of(out, "cat")["reason"] == "no answer"
    assert grade_in_gradebook(out, "cat")[2] is False  # and formgrader does not ask for it
    assert grade_in_gradebook(out, "ann")[2] is True


def test_task_and_model_answer_stand_beside(out: Path, course: Course) -> None:
    (shown,) = open_questions(out, course, PRELAB, OPEN)
    assert shown.text.task.startswith("In Fig. 1(b) the time starts from zero")
    assert shown.text.model.startswith("The first 200 samples")
    (without,) = open_questions(out, None)
    assert (without.text.task, without.text.model) == ("", "")
    with pytest.raises(ValueError, match=r"holds no answer to an open question nosuch in prelab-sinusoids\."):
        open_questions(out, course, PRELAB, "nosuch")
    with pytest.raises(ValueError, match="holds no results"):
        open_questions(out / "nosuch", course)


def test_the_pages_run_nothing_of_a_student(client: Client) -> None:
    status, page, headers = client("GET", client.question)
    assert status == 200
    assert re.findall(r"<script[^>]*>", page) == [f'<script src="/{client.app.token}/mark.js" defer>']
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page
    assert 'href="javascript' not in page
    assert "style=" not in page
    assert "<p>Because</p>" in page  # a heading of a student is none of the page
    assert "<em>clock</em>" in page
    assert '<h2>Ann Öz <span class="soft">ann</span></h2>' in page
    policy = headers["Content-Security-Policy"]
    assert "default-src 'none'; script-src 'self';" in policy
    assert "unsafe" not in policy
    assert (headers["Referrer-Policy"], headers["X-Content-Type-Options"]) == ("no-referrer", "nosniff")
    status, page, _ = client("GET", f"/{client.app.token}/")
    assert status == 200
    assert f'href="{client.question}"' in page
    for name in ("page.css", "mark.css", "mark.js"):
        assert client("GET", f"/{client.app.token}/{name}")[0] == 200


# ---- what is written


def test_a_mark_is_in_the_gradebook_and_on_every_page(client: Client, out: Path) -> None:
    status, said = client.mark("ann", "0.04", "Which\nclock?")
    assert (status, said) == (
        200,
        {"score": "0.04", "look": "partial", "state": "marked by Dr Öz on 2026-11-24", "ticked": []},
    )
    assert grade_in_gradebook(out, "ann") == (0.04, 0.04, False, "Which\nclock?")
    row = row_of(out, "ann")
    assert (row["score"], row["status"], row["reason"]) == ("0.04", "manual", "marked by Dr Öz on 2026-11-24")
    manual = gradebook.read_manual_grades(out)
    assert manual.marks == {("ann", PRELAB, OPEN): Mark(Decimal("0.04"), "Dr Öz", NOW)}
    list(write_feedback(out))
    page = (out / "feedback" / "ann" / f"{PRELAB}.html").read_text(encoding="utf-8")
    section = page.partition(f'<section id="{OPEN}"')[2].partition("</section>")[0]
    assert section.startswith(' class="partial">')
    assert 'aria-label="partly right">◐' in section
    assert "0.04 / 0.05" in section
    assert "Marked by Dr Öz on 2026-11-24" in section
    assert "Which\nclock?" in section
    assert "<em>clock</em>" in section
    assert "<script" not in page
    assert client("GET", client.question)[1].count('data-score="0.04"') == 1


@pytest.mark.parametrize(("score", "look"), [("0", "wrong"), ("0.05", "right"), ("0,025", "partial"), (0.05, "right")])
def test_the_look_follows_the_points(client: Client, score: object, look: str) -> None:
    assert client.mark("bob", score)[1]["look"] == look


def test_a_mark_is_taken_back_and_a_comment_can_stand_alone(client: Client, out: Path) -> None:
    assert client.mark("bob", "0.05", "Good.")[0] == 200
    assert client.mark("bob", None, "Hm.") == (200, {"score": "", "look": "wait", "state": "not marked", "ticked": []})
    assert grade_in_gradebook(out, "bob") == (None, 0.0, True, "Hm.")
    assert row_of(out, "bob")["score"] == ""
    assert gradebook.read_manual_grades(out).marks == {}


def test_what_formgrader_changes_afterwards_is_not_ascribed_to_anybody(client: Client, out: Path) -> None:
    client.mark("bob", "0.05")
    with gradebook.open_gradebook(gradebook.database_url(out)) as book:
        book.find_grade(OPEN, PRELAB, PRELAB, "bob").manual_score = 0.01
        book.db.commit()
    row = row_of(out, "bob")
    assert (row["score"], row["reason"]) == ("0.01", "graded by hand")


def test_grading_again_keeps_marks_and_who_gave_them(
    client: Client, out: Path, graded: Path, course: Course, launcher: ProcessLauncher
) -> None:
    client.mark("ann", "0.04")
    batch = find_batch(course, graded.parent / "in")
    assert not any(one.fresh for one in grade_batch(course, batch, out, LocalExecutor(launcher)))
    assert row_of(out, "ann")["reason"] == "marked by Dr Öz on 2026-11-24"
    assert "0.05 to grade by hand" in class_table(out)  # Bob


def test_the_lines_of_a_rubric_add_up_and_are_kept(client: Client, out: Path) -> None:
    asked = {"student": "ann", "score": None, "comment": "", "ticked": [2, 0]}
    status, text, _ = client("POST", client.question, asked)
    said = json.loads(text)
    assert (status, said["score"], said["look"], said["ticked"]) == (200, "0.03", "partial", [0, 2])
    assert grade_in_gradebook(out, "ann")[0] == 0.03
    assert gradebook.read_manual_grades(out).marks["ann", PRELAB, OPEN].ticked == (0, 2)
    page = client("GET", client.question)[1]
    assert re.findall(r'data-line="(\d)"( checked)?', page) == [
        ("0", " checked"), ("1", ""), ("2", " checked"), ("0", ""), ("1", ""), ("2", ""),
    ]  # fmt: skip
    assert "With t_new the formula is" in page
    assert client("POST", client.question, asked | {"ticked": []})[0] == 200
    assert grade_in_gradebook(out, "ann")[0] == 0  # nothing of the rubric is there
    client.mark("ann", "0.04")  # other points
    assert gradebook.read_manual_grades(out).marks["ann", PRELAB, OPEN].ticked == ()
    client("POST", client.question, asked | {"ticked": [0, 1, 2]})
    assert grade_in_gradebook(out, "ann")[0] == 0.05
    client.mark("ann", None)
    assert " checked" not in client("GET", client.question)[1]


@pytest.mark.parametrize("ticked", [[3], [-1], [0, 0], ["0"], [True], [0.0], "0", {}, 1])
def test_lines_that_are_not_in_the_rubric_are_refused(client: Client, out: Path, ticked: object) -> None:
    status, text, _ = client("POST", client.question, {"student": "ann", "score": "0", "comment": "", "ticked": ticked})
    assert (status, json.loads(text)["error"]) == (
        400, "ticked must be numbers of lines of the rubric, which has 3.",
    )  # fmt: skip
    assert grade_in_gradebook(out, "ann")[0] is None


def test_names_are_hidden_on_request(out: Path, course: Course) -> None:
    app = MarkingApp(out, open_questions(out, course), "Dr Öz", lambda: NOW, token="t" * 32, hide_names=True)
    path = f"/{app.token}/{PRELAB}/{OPEN}"
    page = app.respond("GET", path).body.decode()
    assert re.findall(r"\b(?:ann|bob)\b", page, re.IGNORECASE) == []
    assert re.findall(r"<h2>(Answer \d)</h2>", page) == ["Answer 1", "Answer 2"]
    first = page.partition('data-student="Answer 1"')[2].partition("</article>")[0]
    student = "ann" if "clock" in first else "bob"
    asked = {"student": "Answer 1", "score": "0.05", "comment": ""}
    assert app.respond("POST", path, json.dumps(asked).encode()).status == 200
    assert grade_in_gradebook(out, student)[0] == 0.05
    assert app.respond("POST", path, json.dumps(asked | {"student": student}).encode()).status == 400


def test_the_right_values_of_each_record_stand_below_the_answer(out: Path, course: Course) -> None:
    (shown,) = open_questions(out, course)
    with_values = replace(shown, text=replace(shown.text, values=("a", "b")))

    def values(student: str, assignment: str) -> dict[str, dict[str, str]]:
        return {"q-1": {"a": f"1 of {student} in {assignment}", "c": "3"}}

    app = MarkingApp(out, [with_values], "Dr Öz", lambda: NOW, values=values)
    page = app.respond("GET", f"/{app.token}/{PRELAB}/{OPEN}").body.decode()
    articles = re.findall(r'data-student="(\w+)".*?Right on this record: (.*?)\.</p>', page, re.DOTALL)
    assert articles == [(who, f"<code>a</code> = 1 of {who} in {PRELAB}") for who in ("ann", "bob")]


@pytest.mark.parametrize("score", ["0.06", "-0.01", "", "much", "NaN", "1e-9", [], {}, True, "0.01 0.01"])
def test_impossible_points_are_refused(client: Client, out: Path, score: object) -> None:
    status, said = client.mark("ann", score)
    assert status == 400
    assert said["error"].startswith("points must be a number from 0 to 0.05, got ")
    assert grade_in_gradebook(out, "ann")[0] is None


@pytest.mark.parametrize(
    "body",
    [b"", b"{", b"[]", b"{}", b'{"student": "ann", "score": "0"}', b'{"student": "cat", "score": "0", "comment": ""}',
     b'{"student": "ann", "score": "0", "comment": 3}', b'{"student": ["ann"], "score": "0", "comment": ""}'],
)  # fmt: skip
def test_requests_that_are_none_are_refused(client: Client, body: bytes) -> None:
    status, text, _ = client("POST", client.question, raw=body)
    assert status == 400
    assert json.loads(text)["error"]


def test_a_gradebook_that_is_locked_is_said_and_the_mark_is_not_lost_silently(
    client: Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    from sqlalchemy.exc import OperationalError

    def locked(*_: object) -> None:
        raise OperationalError("UPDATE", {}, Exception("database is\nlocked"))

    monkeypatch.setattr("autograder.results.gradebook.enter_mark", locked)
    assert client.mark("ann", "0.05") == (500, {"error": "database is locked"})
    monkeypatch.setattr("autograder.results.gradebook.read_manual_grades", locked)
    status, text, _ = client("GET", client.question)
    assert (status, text) == (500, "database is locked\n")


# ---- who may ask


def test_only_the_pages_of_the_right_address_are_answered(client: Client, out: Path) -> None:
    asked = {"student": "ann", "score": "0.05", "comment": ""}
    wrong = client.question.replace(client.app.token, "x" * len(client.app.token))
    assert client("GET", "/")[0] == 404
    assert client("GET", wrong)[0] == 404
    assert client("POST", wrong, asked)[0] == 404
    assert client("POST", client.question, asked, Host="evil.example")[0] == 403
    assert client("GET", client.question, Host=f"evil.example:{client.port}")[0] == 403
    assert client("POST", client.question, asked, Origin="https://evil.example")[0] == 403
    assert client("POST", client.question, asked, Origin="null")[0] == 403
    assert client("POST", client.question, asked, Content_Type="text/plain")[0] == 415
    assert client("POST", client.question, asked, Content_Length=str(MAX_BODY + 1))[0] == 413
    assert client("POST", f"/{client.app.token}/{PRELAB}/prelab-1-time", asked)[0] == 404
    assert client("GET", f"/{client.app.token}/../mark.js")[0] == 404
    assert grade_in_gradebook(out, "ann")[0] is None
    assert client("POST", client.question, asked, Origin=f"http://127.0.0.1:{client.port}")[0] == 200


# ---- the command


PROGRAM = """
import sys
from pathlib import Path
import autograder.course.layout
here = autograder.course.layout.Course(Path(sys.argv.pop(1)))
autograder.course.layout.find_course = lambda: here
from labsid.cli.commands import main
sys.exit(main())
"""


@pytest.mark.skipif(os.name != "posix", reason="a signal is sent")
def test_the_command_serves_on_loopback_and_writes_the_table_when_it_ends(out: Path, course: Course) -> None:
    command = ["course", "mark", "--out", str(out), "--no-open", "--marker", "Eve"]
    with subprocess.Popen(
        [sys.executable, "-c", PROGRAM, str(course.root), *command], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        try:
            line = process.stdout.readline()
            found = re.fullmatch(
                r"2 answers to mark, in 1 questions\. Open http://127\.0\.0\.1:(\d+)/([\w-]{32})/\n", line
            )
            assert found, line
            app = MarkingApp(out, (), "", lambda: NOW, token=found[2])
            assert Client(app, int(found[1])).mark("bob", "0.05")[0] == 200
            process.send_signal(signal.SIGINT)
            rest = process.stdout.read()
        finally:
            process.kill()
    assert rest.splitlines()[-1] == f"1 answers left to mark. Next: labsid course feedback --out {out}"
    assert re.search(
        rf"^bob,{PRELAB},{OPEN},0.05,0.05,manual,marked by Eve on 20", (out / "grades.csv").read_text(), re.M
    )


def test_a_browser_that_goes_away_prints_nothing(client: Client, capsys: pytest.CaptureFixture[str]) -> None:
    for sent in (f"GET {client.question} HTTP/1.1\r\nHost: 127.0.0.1:{client.port}\r\n\r\n", "GET / HT", ""):
        with socket.create_connection(("127.0.0.1", client.port)) as connection:
            connection.sendall(sent.encode())
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # reset, not closed
    assert client("GET", client.question)[0] == 200
    time.sleep(0.5)
    assert capsys.readouterr().err == ""


def test_other_errors_of_a_request_are_printed(client: Client, capsys: pytest.CaptureFixture[str]) -> None:
    for error, is_printed in ((BrokenPipeError(), False), (TimeoutError(), False), (KeyError("x"), True)):
        try:
            raise error
        except Exception:
            client.server.handle_error(None, ("127.0.0.1", 1))
        assert ("Traceback" in capsys.readouterr().err) is is_printed


# ---- students' Markdown


@pytest.mark.parametrize(
    "text",
    [
        "<img src=x onerror=alert(1)>",
        "<details open ontoggle=alert(1)>",
        "[x](javascript:alert(1))",
        "[x](JaVaScRiPt&#58;alert(1))",
        "[x](data:text/html,<script>alert(1)</script>)",
        "![x](https://evil.example/pixel.png)",
        "$<script>alert(1)</script>$",
        "$$\n</div><script>alert(1)</script>\n$$",
        "```html\n<script>alert(1)</script>\n```",
        r"$\text{<script>alert(1)</script>&lt;script>}$",
        r"$\href{javascript:alert(1)}{x} \color{red\"onload=alert(1)}{y} \style{color:red}{z}$",
        '```"onclick=alert(1)\nx\n```',
        '<https://a.example/"onclick=alert(1)>',
        "x" * MAX_CHARACTERS + "<script>",
    ],
)
def test_no_markdown_makes_html_of_its_own(text: str) -> None:
    page = str(prose_html(text))
    assert not re.search(r"<(?!/?(p|a|em|strong|code|pre|ul|ol|li|div|span|math|m[a-z]+)\b)", page)
    for tag in re.findall(r"<[^>]*>", page):
        assert not re.search(r"\bon\w+\s*=(?![^\"]*\"[^\"]*$)", re.sub(r'"[^"]*"', '""', tag))
        assert not re.search(r"(javascript|data):", tag, re.IGNORECASE)


@pytest.mark.parametrize("formula", [r"\frac", "x^", "{" * 900, "x" * 2000, r"\begin{matrix} 1"])
def test_a_formula_that_cannot_be_read_is_shown_as_typed(formula: str) -> None:
    assert formula_html(formula, "inline") == formula


def test_a_formula_keeps_nothing_that_is_not_of_formulas() -> None:
    page = str(formula_html(r"\hspace{999em} \href{https://a.example}{x} \color{red}{y} \quad z", "block"))
    assert "999em" not in page
    assert "a.example" not in page
    assert "red" not in page
    assert '<math display="block">' in page
    assert 'width="1em"' in page


def test_formulas_and_tables_are_shown() -> None:
    page = str(prose_html("$a_1 * b_2 * c < d$\n\n|a|b|\n|-|-|\n|1|2|\n\n[x](https://a.example)"))
    assert '<span class="math inline"><math display="inline"><mrow><msub><mi>a</mi><mn>1</mn></msub><mo>*</mo>' in page
    assert "<mo>&lt;</mo><mi>d</mi>" in page
    assert "<td>1</td>" in page
    assert '<a href="https://a.example" rel="noopener noreferrer nofollow">' in page
