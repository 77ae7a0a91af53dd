"""The pages of ``labsid course mark``, served on this machine's own address only.

The address contains a random token; requests to another host name, with another origin or without the token are
refused. The pages run one script, which comes from here; text of students is Markdown rendered without their HTML.
"""

import hashlib
import hmac
import json
import secrets
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from decimal import Decimal, InvalidOperation
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Lock
from typing import Any
from urllib.parse import quote, unquote, urlsplit

from autograder.course.plain_text import plain_decimal
from autograder.course.questions import Criterion
from autograder.marking.answers import OpenAnswer, OpenQuestion, find_question, with_marks
from autograder.results import gradebook
from autograder.results.feedback import load_template, look_of, printable, values_of
from autograder.results.gradebook import Mark
from autograder.results.prose import keep_slow_texts, prose_html

HOST = "127.0.0.1"
MAX_BODY = 100_000  # bytes
MAX_COMMENT = 10_000  # characters
_FILES = Path(__file__).parent
_STATIC = {"mark.css": "text/css; charset=utf-8", "mark.js": "text/javascript; charset=utf-8"}
_HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cache-Control": "no-store",
}


@dataclass(frozen=True, slots=True)
class Response:
    """An answer to a request.

    Attributes
    ----------
    status : HTTPStatus
    kind : str
        Its media type.
    body : bytes
    """

    status: HTTPStatus
    kind: str
    body: bytes


@dataclass(frozen=True, slots=True)
class MarkingApp:
    """What the pages show and write.

    Attributes
    ----------
    out : Path
        A folder that ``labsid course grade`` wrote.
    questions : sequence of OpenQuestion
        As read when the command started; marks are read from the gradebook each time.
    marker : str
        Name of who marks.
    now : callable
        Returns the time, with a time zone.
    token : str
        First part of every path.
    hide_names : bool
        Whether answers have numbers instead of names and IDs, in an order that is another one for each question.
    values : callable
        ``values(student, assignment)``: the right values on the student's own record, as text by name, by question.
    """

    out: Path
    questions: Sequence[OpenQuestion]
    marker: str
    now: Callable[[], datetime]
    token: str = field(default_factory=lambda: secrets.token_urlsafe(24))
    hide_names: bool = False
    values: Callable[[str, str], Mapping[str, Mapping[str, str]]] = lambda student, assignment: {}
    _lock: Any = field(default_factory=Lock)

    def __post_init__(self) -> None:
        keep_slow_texts(self.out)

    def respond(self, method: str, path: str, body: bytes = b"") -> Response:
        """Respond to a request that came to the right host from the right origin."""
        token, *parts = urlsplit(path).path.removeprefix("/").split("/")
        if not secrets.compare_digest(token.encode(), self.token.encode()):
            return _text(HTTPStatus.NOT_FOUND, "Open the address that the command printed.")
        names = [unquote(part) for part in parts]
        if method == "GET" and len(names) == 1 and names[0] in _STATIC:
            return Response(HTTPStatus.OK, _STATIC[names[0]], (_FILES / names[0]).read_bytes())
        if method == "GET" and names in ([], [""]):
            page = self._index(with_marks(self.out, self.questions))
            return _html(load_template("questions.html.j2", _FILES).render(page=page))
        shown = find_question(self.questions, *names) if len(names) == 2 else None
        if shown is None:
            return _text(HTTPStatus.NOT_FOUND, "There is no such question.")
        if method == "GET":
            return _html(load_template("question.html.j2", _FILES).render(page=self._page(shown)))
        try:
            return _json(HTTPStatus.OK, self._mark(shown, body))
        except ValueError as error:
            return _json(HTTPStatus.BAD_REQUEST, {"error": str(error)})

    def _index(self, questions: list[OpenQuestion]) -> dict[str, Any]:
        rows = [
            {
                "address": f"{quote(question.assignment)}/{quote(question.question)}",
                "heading": printable(question.heading),
                "assignment": question.assignment,
                "id": question.question,
                "points": plain_decimal(question.max_score),
                "answers": len(question.answers),
                "waiting": question.waiting,
            }
            for question in questions
        ]
        return {"base": f"/{self.token}/", "marker": self.marker, "questions": rows}

    def _page(self, question: OpenQuestion) -> dict[str, Any]:
        place = self.questions.index(question)
        before, after = self.questions[:place], self.questions[place + 1 :]
        neighbours = {"previous": before[-1:], "next": after[:1]}
        (shown,) = with_marks(self.out, [question])
        answers = []
        for key, answer in self._by_key(shown).items():
            name = "" if self.hide_names else answer.name
            right = self.values(answer.student, shown.assignment) if shown.text.values else {}
            answers.append(
                {
                    "key": key,
                    "shown": printable(key if self.hide_names else name or answer.student),
                    "id": printable(answer.student) if name else "",
                    "prose": prose_html(printable(answer.text)),
                    "values": values_of(shown.question, shown.text, right),
                    "score": "" if answer.score is None else plain_decimal(answer.score),
                    "look": "wait" if answer.needs_review else look_of(answer.score, shown.max_score),
                    "comment": printable(answer.comment),
                    "state": "changed since it was marked" if answer.needs_review else answer.marked_by,
                    "ticked": answer.ticked,
                }
            )
        return {
            "base": f"/{self.token}/",
            "marker": self.marker,
            "title": printable(shown.title),
            "heading": printable(shown.heading),
            "assignment": shown.assignment,
            "id": shown.question,
            "points": plain_decimal(shown.max_score),
            "steps": [plain_decimal(step) for step in shown.steps],
            "task": prose_html(shown.text.task) if shown.text.task else "",
            "model": prose_html(shown.text.model) if shown.text.model else "",
            "criteria": [
                {"text": prose_html(criterion.text), "points": plain_decimal(criterion.points)}
                for criterion in shown.text.rubric
            ],
            "answers": answers,
            "waiting": shown.waiting,
            **{
                side: f"{quote(neighbour[0].assignment)}/{quote(neighbour[0].question)}" if neighbour else ""
                for side, neighbour in neighbours.items()
            },
        }

    def _mark(self, shown: OpenQuestion, body: bytes) -> dict[str, Any]:
        """Enter one mark; `ValueError` if the request is not valid."""
        try:
            asked = json.loads(body)
            key, score, comment, ticked = asked["student"], asked["score"], asked["comment"], asked.get("ticked")
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            raise ValueError("expected a JSON object with student, score and comment.") from None
        answer = self._by_key(shown).get(key) if isinstance(key, str) else None
        if answer is None:
            raise ValueError(f"there is no answer of {key!r}.")
        if not isinstance(comment, str) or len(comment) > MAX_COMMENT:
            raise ValueError(f"the comment must be text of at most {MAX_COMMENT} characters.")
        mark = None
        if ticked is not None:
            mark = self._ticked_mark(ticked, shown.text.rubric)
        elif score is not None:
            mark = Mark(_points(score, shown.max_score), self.marker, self.now())
        with self._lock:
            gradebook.enter_mark(self.out, (answer.student, shown.assignment, shown.question), mark, printable(comment))
        if mark is None:
            return {"score": "", "look": "wait", "state": "not marked", "ticked": []}
        look = look_of(mark.score, shown.max_score)
        return {"score": plain_decimal(mark.score), "look": look, "state": mark.text, "ticked": list(mark.ticked)}

    def _ticked_mark(self, ticked: Any, rubric: Sequence[Criterion]) -> Mark:
        """The mark that the ticked lines of a rubric add up; `ValueError` if they are not lines of it."""
        valid = isinstance(ticked, list) and all(type(one) is int and 0 <= one < len(rubric) for one in ticked)
        if not valid or len(set(ticked)) != len(ticked):
            raise ValueError(f"ticked must be numbers of lines of the rubric, which has {len(rubric)}.")
        score = sum((rubric[one].points for one in ticked), Decimal(0))
        return Mark(score, self.marker, self.now(), tuple(sorted(ticked)))

    def _by_key(self, shown: OpenQuestion) -> dict[str, OpenAnswer]:
        """The answers by the key with which the page asks for them: the ID, or a number if names are hidden."""
        if not self.hide_names:
            return {answer.student: answer for answer in shown.answers}
        mixed = sorted(shown.answers, key=lambda answer: self._digest(shown, answer.student))
        return {f"Answer {number}": answer for number, answer in enumerate(mixed, 1)}

    def _digest(self, shown: OpenQuestion, student: str) -> str:
        text = f"{shown.assignment}\0{shown.question}\0{student}"
        return hmac.new(self.token.encode(), text.encode(errors="surrogatepass"), hashlib.sha256).hexdigest()


def _points(text: Any, most: Decimal) -> Decimal:
    try:
        score = Decimal(str(text).strip().replace(",", "."))
    except InvalidOperation:
        score = Decimal(-1)
    if not score.is_finite() or not 0 <= score <= most or score != score.quantize(Decimal("0.0001")):
        raise ValueError(f"points must be a number from 0 to {plain_decimal(most)}, got {str(text)[:20]!r}.")
    return score


def make_server(app: MarkingApp, port: int = 0) -> ThreadingHTTPServer:
    """A server on the loopback address; port 0 takes any free one."""
    from sqlalchemy.exc import SQLAlchemyError

    class Handler(BaseHTTPRequestHandler):
        """Passes requests to the app."""

        timeout = 30  # seconds

        def do_GET(self) -> None:
            self._answer("GET", b"")

        def do_POST(self) -> None:
            length = self.headers.get("Content-Length", "")
            if not (length.isascii() and length.isdigit() and int(length) <= MAX_BODY):
                self._send(_text(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"Send at most {MAX_BODY} bytes."))
                return
            self._answer("POST", self.rfile.read(int(length)))

        def _answer(self, method: str, body: bytes) -> None:
            refused = refusal(method, dict(self.headers.items()), server.server_port)
            if refused is not None:
                self._send(refused)
                return
            try:
                self._send(app.respond(method, self.path, body))
            except (
                ValueError,
                OSError,
                SQLAlchemyError,
            ) as error:  # such as a gradebook that another program has locked
                problem = " ".join(str(getattr(error, "orig", None) or error).split())
                status = HTTPStatus.INTERNAL_SERVER_ERROR
                self._send(_json(status, {"error": problem}) if method == "POST" else _text(status, problem))

        def _send(self, response: Response) -> None:
            self.send_response(response.status)
            for name, value in {**_HEADERS, "Content-Type": response.kind}.items():
                self.send_header(name, value)
            self.send_header("Content-Length", str(len(response.body)))
            self.end_headers()
            self.wfile.write(response.body)

        def log_message(self, format: str, *values: object) -> None:
            """Write nothing: the address contains the token."""

    class Server(ThreadingHTTPServer):
        """Says nothing of connections that a browser closes before it has its answer."""

        def handle_error(self, request: Any, client_address: Any) -> None:
            if not isinstance(sys.exception(), ConnectionError | TimeoutError):
                super().handle_error(request, client_address)

    server = Server((HOST, port), Handler)
    server.daemon_threads = True
    return server


def refusal(method: str, headers: Mapping[str, str], port: int) -> Response | None:
    """The refusal of a request that another page or host name sends; None if it is not one."""
    hosts = {f"{HOST}:{port}", f"localhost:{port}"}
    if headers.get("Host") not in hosts:
        return _text(HTTPStatus.FORBIDDEN, "Open the address that the command printed.")
    origin = headers.get("Origin")
    if origin is not None and origin not in {f"http://{host}" for host in hosts}:
        return _text(HTTPStatus.FORBIDDEN, "This request comes from another page.")
    if method == "POST" and headers.get("Content-Type") != "application/json":
        return _text(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "Send JSON.")
    return None


def _html(text: str) -> Response:
    return Response(HTTPStatus.OK, "text/html; charset=utf-8", text.encode(errors="replace"))


def _text(status: HTTPStatus, text: str) -> Response:
    return Response(status, "text/plain; charset=utf-8", f"{text}\n".encode(errors="replace"))


def _json(status: HTTPStatus, content: Mapping[str, Any]) -> Response:
    return Response(status, "application/json", json.dumps(content).encode())
