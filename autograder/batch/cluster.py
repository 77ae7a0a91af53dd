"""A executor on other machines: the workers of a Dask scheduler.

The scheduler passes calls on as bytes that it does not read: it needs no labsid, and neither its log nor a worker's
holds the course's secret. What goes over the wire is pickled, as client, scheduler and workers trust each other. A
student's process reaches none of them; its values cross the typed channel into the worker, as on one machine.
"""

import contextlib
import logging
import pickle
import re
import time
import uuid
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future, ProcessPoolExecutor
from multiprocessing import get_context
from threading import Event, Lock, Thread
from typing import Any

from autograder.batch.cluster_worker import Demand, Failed, demand, greet, work
from autograder.batch.executors import Task
from autograder.intake.submission import quarantined
from autograder.judge.outcome import SubmissionResult, not_judged
from autograder.results.result_files import one_line
from autograder.sandbox.isolation import LEVELS, Limits, is_weaker

CONNECT_SECONDS = 10.0
"""Time for the scheduler to answer, and again for it to have a worker."""

GREETING_SECONDS = 60.0
"""Time for workers to open their launchers."""

ALONE_SECONDS = 30.0
"""Time without any worker after which the cluster is given up; one that ended may be about to be started again."""

_LOOK_EVERY = 2.0
_REPLY_SECONDS = 60.0
_AT_ONCE = (16, 256)  # with fewer, workers that join later would have nothing to do; more is of no use


@contextlib.contextmanager
def open_cluster(
    address: str, isolation: str, tell: Callable[[str], None], limits: Limits | None = None
) -> Iterator["Cluster"]:
    """Connect to a scheduler, and greet its workers.

    Parameters
    ----------
    address : str
        ``tcp://HOST:PORT``, ``tls://HOST:PORT`` or ``HOST:PORT``.
    isolation : str
        What every worker must hold, as `open_launcher` takes it.
    tell : callable
        Takes a line for the instructor: a worker that is refused, a submission that ended its workers.
    limits : Limits, optional
        What one submission may use.

    Raises
    ------
    ValueError
        If the address is none, nobody answers there in time, or no worker can be used.
    """
    address = check_address(address)
    demanded = demand(isolation, limits or Limits())
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", module="distributed")
        cluster = Cluster(_connect(address), address, demanded, tell)
        try:
            cluster.start()
            yield cluster
        finally:
            cluster.close()


def check_address(text: str) -> str:
    """A scheduler's address with its scheme; `ValueError` where it is none."""
    address = text if "://" in text else f"tcp://{text}"
    match = re.fullmatch(r"(?:tcp|tls)://(?:[\w.-]+|\[[0-9a-fA-F:.]+\]):(\d{1,5})", address)
    if match is None or not 0 < int(match[1]) < 65536:
        raise ValueError(f"--scheduler: got {text!r}, expected an address such as tcp://HOST:8786")
    return address


class Cluster:
    """Executes and judges on the workers of a scheduler."""

    def __init__(self, client: Any, address: str, demanded: Demand, tell: Callable[[str], None]) -> None:
        self._client = client
        self._address = address
        self._demand = demanded
        self._tell = tell
        self._levels: dict[str, str] = {}  # of the workers that were greeted
        self._refused: dict[str, str] = {}  # the others, and why
        self._greeting, self._looking, self._at_home = Lock(), Lock(), Lock()
        self._there: frozenset[str] = frozenset()
        self._looked = self._alone_since = 0.0
        self.level = LEVELS[-1]
        self.at_once = _AT_ONCE[0]

    def start(self) -> None:
        """Greet the workers there are; `ValueError` where none can be used."""
        with self._speaking():
            try:
                self._client.wait_for_workers(1, timeout=CONNECT_SECONDS)
            except TimeoutError:
                raise ValueError(
                    f"the scheduler at {self._address} has no worker. Start some: dask worker {self._address}"
                ) from None
            self._greet_new()
            threads = sum(self._threads().values())
        if not self._levels:
            why = [f"{worker} is refused: {why}" for worker, why in self._refused.items()]
            silent = f"none answered within {GREETING_SECONDS:g} s"
            raise ValueError(f"no worker of {self._address} can be used; {why[0] if why else silent}")
        self.level = max(self._levels.values(), key=LEVELS.index)
        self.at_once = sorted((*_AT_ONCE, 2 * threads))[1]

    def judge(self, task: Task) -> SubmissionResult:
        """Execute and judge on a worker; on this machine, where the workers cannot."""
        with self._speaking():
            while True:
                refused = len(self._refused)
                answer = self._judge_there(task)
                if isinstance(answer, SubmissionResult):
                    return answer
                if answer is not None:
                    self._greet_new()  # was it one that joined after the others, and is none of us?
                    if len(self._refused) == refused:
                        return self._judge_here(task, answer.why)

    def close(self) -> None:
        """Let go of the workers; what they have begun they finish for nobody."""
        self._client.close()

    def _judge_there(self, task: Task) -> SubmissionResult | Failed | None:
        """What a worker makes of a task; None where those that were asked are gone and others have come."""
        from distributed import KilledWorker

        asked = self._whom()
        call, done = self._call(work, task, workers=asked), Event()
        call.add_done_callback(lambda _: done.set())
        while not done.wait(_LOOK_EVERY):
            there = self._workers()
            if asked is not None and there and there.isdisjoint(asked):
                call.cancel()
                return None
        try:
            answer: SubmissionResult | Failed = call.result(timeout=_REPLY_SECONDS)
            return answer
        except KilledWorker as killed:
            return Failed(f"it ended {killed.allowed_failures + 1} workers")
        except Exception as error:
            if call.status == "error":
                return Failed(str(error))
            raise

    def _judge_here(self, task: Task, why: str) -> SubmissionResult:
        """Judge in a process of its own what workers do not bring back; what it was beside may be to blame."""
        name = f"{task.submission.assignment} of {task.submission.student}"
        try:
            with self._at_home, ProcessPoolExecutor(1, get_context("spawn")) as home:
                self._must_be_connected()
                level = home.submit(greet, self._demand).result()
                if isinstance(level, str) and is_weaker(level, self.level):
                    level = Failed(f"it isolates less than the workers ({level})")
                answer = level if isinstance(level, Failed) else home.submit(work, self._demand, task).result()
        except CancelledError:
            raise
        except Exception as error:
            answer = Failed(str(error))
        if isinstance(answer, SubmissionResult):
            self._tell(f"{name}: graded on this machine, as on the cluster {one_line(why)}")
            return answer
        self._tell(
            f"{name}: quarantined, as on the cluster {one_line(why)}, and on this machine {one_line(answer.why)}"
        )
        refused = quarantined(task.submission.student, task.submission.assignment, "it could not be graded")
        return not_judged(refused, task.assets.template, self.level)

    def _greet_new(self) -> None:
        """Greet the workers that are not known yet: accept or refuse them."""
        with self._greeting:
            new = self._threads().keys() - self._levels.keys() - self._refused.keys()
            calls = {worker: self._call(greet, workers=[worker], priority=1) for worker in sorted(new)}
            until = time.monotonic() + GREETING_SECONDS
            refused = {}
            for worker, call in calls.items():
                try:
                    answer = call.result(timeout=max(until - time.monotonic(), 0.1))
                except Exception as error:
                    if call.status != "error":
                        if isinstance(error, TimeoutError):  # busy, or gone: neither accepted nor refused
                            continue
                        raise
                    answer = Failed(f"it has not the labsid that this machine has ({error})")
                if isinstance(answer, Failed):
                    refused[worker] = one_line(answer.why)
                else:
                    self._levels[worker] = answer
            self._refused |= refused
            for worker, why in refused.items() if self._levels else ():
                self._tell(f"worker {worker} is refused: {why}")

    def _whom(self) -> list[str] | None:
        """Whom to ask: anybody, until one was refused."""
        while self._refused:
            if there := self._workers():
                return sorted(there)
            time.sleep(_LOOK_EVERY)
        return None

    def _workers(self) -> frozenset[str]:
        """The workers there are and that were not refused; `ValueError` where there has long been none."""
        with self._looking:
            now = time.monotonic()
            if now - self._looked >= _LOOK_EVERY:
                self._there, self._looked = frozenset(self._threads()), now
            there = self._there - self._refused.keys()
            self._alone_since = 0.0 if there else self._alone_since or now
            if not there and now - self._alone_since > ALONE_SECONDS:
                raise ValueError(f"no worker that can be used is left at {self._address}. {_GO_ON}")
            return there

    def _call(self, function: Callable[..., Any], *arguments: Any, **settings: Any) -> Any:
        """Have a worker call a function; the future of what it returns."""
        self._must_be_connected()  # or it would wait, and be lost as those before it
        call = pickle.dumps(_Call(function, self._demand, *arguments))
        return self._client.submit(pickle.loads, call, key=f"labsid-{uuid.uuid4().hex}", pure=False, **settings)

    def _threads(self) -> dict[str, int]:
        """The workers there are, with how many threads each has."""
        self._must_be_connected()
        found: dict[str, int] = self._client.nthreads(callback_timeout=_REPLY_SECONDS)
        return found

    def _must_be_connected(self) -> None:
        if self._client.status != "running":
            raise CancelledError

    @contextlib.contextmanager
    def _speaking(self) -> Iterator[None]:
        """Whatever is raised because the scheduler is gone, said in one line."""
        try:
            yield
        except Exception as error:
            if isinstance(error, CancelledError | TimeoutError) or self._client.status != "running":
                raise ValueError(f"the scheduler at {self._address} is gone. {_GO_ON}") from None
            raise


_GO_ON = "What is graded is kept; run the same command again for the rest."


class _Call:
    """A call that is made by unpickling it, so that the scheduler needs to know nothing but `pickle.loads`."""

    def __init__(self, function: Callable[..., Any], *arguments: Any) -> None:
        self._call = function, arguments

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        return self._call


def _connect(address: str) -> Any:
    """Connect to a scheduler; in a thread that is left behind, as something else at that address may never answer."""
    try:
        from distributed import Client
    except ImportError:
        raise ValueError('--scheduler needs Dask. Install it: pip install "labsid[cluster]"') from None
    for name in ("distributed", "distributed.client", "tornado", "tornado.application"):
        for handler in logging.getLogger(name).handlers:
            handler.setLevel(logging.CRITICAL + 1)  # what goes wrong is said here, in a line
    found: Future[Any] = Future()

    class Quiet(Client):
        def start(self, **settings: Any) -> None:
            try:
                super().start(**settings)
            except BaseException:
                self.status = "closed"  # or its end would wait once more for what has failed
                raise

    def connect() -> None:
        try:
            found.set_result(Quiet(address, timeout=CONNECT_SECONDS, set_as_default=False))
        except BaseException as error:
            found.set_exception(error)

    Thread(target=connect, daemon=True).start()
    try:
        return found.result(CONNECT_SECONDS + 0.5)
    except Exception as error:
        why = str(error) or f"no answer within {CONNECT_SECONDS:g} s"
        raise ValueError(f"no Dask scheduler answers at {address} ({why}). Start one: dask scheduler") from None
