"""Independent calls on several processes give what one gives, and nothing is lost where one of them ends early."""

import os
import signal
from collections.abc import Callable
from pathlib import Path
from time import sleep
from typing import Any

import numpy as np
import pytest
from gap_search import searched

from labsid._cores import available_cores, mapped, on_cores
from labsid.gap.diagnosis import diagnose
from labsid.records.record import load_record

needs_cores = pytest.mark.skipif(available_cores() < 2, reason="one core, or no way to fork")


def with_jobs(jobs: int, function: Callable[[Any], Any], items: list[Any], **more: Any) -> list[Any]:
    with on_cores(jobs):
        return mapped(function, items, **more)


@pytest.mark.parametrize("jobs", [1, 2, 5])
def test_results_stand_in_the_order_of_the_items(jobs: int) -> None:
    assert with_jobs(jobs, lambda n: n * n, list(range(40))) == [n * n for n in range(40)]
    assert with_jobs(jobs, lambda n: n, []) == []


@needs_cores
def test_several_processes_take_part(tmp_path: Path) -> None:
    def who(_: int) -> int:
        (tmp_path / str(os.getpid())).touch()
        for _ in range(6000):  # until the other one has an item, too, however busy the machine is
            if len(list(tmp_path.iterdir())) > 1:
                break
            sleep(0.01)
        return os.getpid()

    assert {os.getpid()} < set(with_jobs(2, who, list(range(60))))


@needs_cores
def test_kept_objects_are_those_of_the_caller() -> None:
    """A result refers to the record and to its item, not to copies of them; what it holds besides is copied."""
    record, items = np.arange(4.0), [np.full(2, float(n)) for n in range(20)]
    found = with_jobs(2, lambda item: (record, item, item + 1.0), items, kept=(record,))
    assert all(one is record and own is item for (one, own, _), item in zip(found, items, strict=True))
    np.testing.assert_array_equal([more for _, _, more in found], np.array(items) + 1.0)


def test_the_first_error_is_raised() -> None:
    def fails(n: int) -> int:
        if n in (7, 30):
            raise ValueError(f"item {n}")
        return n

    for jobs in (1, 2):
        with pytest.raises(ValueError, match="item 7"):
            with_jobs(jobs, fails, list(range(40)))


@needs_cores
def test_what_a_killed_process_owes_is_computed_by_the_caller() -> None:
    caller = os.getpid()

    def dies(n: int) -> int:
        if os.getpid() != caller:
            os.kill(os.getpid(), signal.SIGKILL)
        return n

    assert with_jobs(2, dies, list(range(20))) == list(range(20))


@needs_cores
def test_what_cannot_be_sent_back_is_computed_by_the_caller() -> None:
    found = with_jobs(2, lambda n: lambda: n, list(range(20)))
    assert [one() for one in found] == list(range(20))


@needs_cores
def test_an_interrupt_ends_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C in the caller is not held up by a process that would compute for long, and leaves none behind."""
    caller, fork, forked = os.getpid(), os.fork, []
    monkeypatch.setattr(os, "fork", lambda: forked.append(fork()) or forked[-1])

    def interrupted(n: int) -> None:
        if os.getpid() == caller:
            raise KeyboardInterrupt
        signal.pause()

    with pytest.raises(KeyboardInterrupt):
        with_jobs(2, interrupted, list(range(20)))
    (process,) = forked
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)


def test_only_the_caller_says_that_an_item_begins() -> None:
    said: list[tuple[int, int]] = []
    with_jobs(2, lambda _: sleep(0.05), list(range(10)), begun=lambda i, count: said.append((i, count)))
    numbers, counts = zip(*said, strict=True)
    assert set(counts) == {10}
    assert sorted(set(numbers)) == list(numbers)


@needs_cores
@searched("input-delay", "extra-lag", "sqrt-outflow", "output-nonlinearity", "load-step")
def test_a_report_is_the_same_for_any_number_of_processes() -> None:
    record = load_record("data/SysIdenData_Verification.mat")
    one, two = (diagnose(record, jobs=jobs).report for jobs in (1, 2))
    assert one == two
