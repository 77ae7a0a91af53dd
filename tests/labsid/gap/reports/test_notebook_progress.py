"""A diagnosis in the kernel of a notebook: a bar while it works, then its page."""

from collections.abc import Iterator
from typing import Any

import pytest

pytest.importorskip("jupyter_client")
from jupyter_client.manager import start_new_kernel

DIAGNOSIS = """
import numpy as np
from labsid import Record
from labsid.gap import diagnose
from labsid.gap.reports import notebook_progress
from labsid.gap.search import beam_search
beam_search.CANDIDATES = beam_search.CANDIDATES[:3]
notebook_progress.DELAY, notebook_progress.INTERVAL = 0.0, 0.0
rng = np.random.default_rng(1)
u = np.repeat(rng.uniform(-1.0, 1.0, 30), 10)
y = np.zeros(300)
for k in range(1, 300):
    y[k] = 0.9 * y[k - 1] + 0.1 * u[k - 1]
diagnose(Record(np.arange(300.0), u, y + 0.01 * rng.standard_normal(300), 1.0))
"""


@pytest.fixture(scope="module")
def messages() -> Iterator[list[dict[str, Any]]]:
    """What the kernel shows for the cell."""
    manager, client = start_new_kernel()
    try:
        found: list[dict[str, Any]] = []
        reply = client.execute_interactive(DIAGNOSIS, timeout=120, output_hook=found.append)
        assert reply["content"]["status"] == "ok"
        yield found
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)


def shown(messages: list[dict[str, Any]], kind: str) -> list[str]:
    return [m["content"]["data"]["text/html"] for m in messages if m["msg_type"] == kind]


def test_a_bar_is_shown_and_removed(messages: list[dict[str, Any]]) -> None:
    (first,) = shown(messages, "display_data")
    assert '<progress max="1" value="0.' in first
    *bars, last = shown(messages, "update_display_data")
    assert all("<progress" in bar for bar in bars)
    assert any("one effect" in bar for bar in bars)
    assert last == ""


def test_the_result_is_the_page(messages: list[dict[str, Any]]) -> None:
    (page,) = shown(messages, "execute_result")
    assert page.startswith("<iframe srcdoc=")
    assert "No gap" in page or "no gap" in page
