"""Limits of time."""

import time

import pytest

from labsid.checks.time_limit import OutOfTime, limit_time


def test_a_block_that_takes_too_long_is_ended() -> None:
    with pytest.raises(OutOfTime), limit_time(0.05):
        time.sleep(60.0)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_a_limit_that_ends_during_a_destructor_is_not_lost() -> None:
    """Python drops an exception that is raised in a destructor."""

    class Slow:
        def __del__(self) -> None:
            time.sleep(0.3)

    reached = []

    def run() -> None:
        slow = Slow()
        del slow
        time.sleep(60.0)
        reached.append("the end")

    with pytest.raises(OutOfTime), limit_time(0.1):
        run()
    assert reached == []
