"""Connections to a Dask scheduler."""

import logging
import re
from concurrent.futures import Future
from threading import Thread
from typing import Any


def check_address(text: str) -> str:
    """Add the scheme to a scheduler's address; raise `ValueError` if the address is invalid."""
    address = text if "://" in text else f"tcp://{text}"
    match = re.fullmatch(r"(?:tcp|tls)://(?:[\w.-]+|\[[0-9a-fA-F:.]+\]):(\d{1,5})", address)
    if match is None or not 0 < int(match[1]) < 65536:
        raise ValueError(f"--scheduler: got {text!r}, expected an address such as tcp://HOST:8786")
    return address


def connect(address: str, seconds: float) -> Any:
    """Connect to a scheduler, in a daemon thread: a foreign server at that address may never answer.

    Parameters
    ----------
    address : str
    seconds : float
        Time limit, in seconds.

    Returns
    -------
    distributed.Client

    Raises
    ------
    ValueError
        If Dask is not installed, or no scheduler answers in time.
    """
    try:
        from distributed import Client
    except ImportError:
        raise ValueError('--scheduler needs Dask. Install it: pip install "labsid[cluster]"') from None
    for name in ("distributed", "distributed.client", "tornado", "tornado.application"):
        for handler in logging.getLogger(name).handlers:
            handler.setLevel(logging.CRITICAL + 1)  # errors are reported here, in one line
    client: Future[Any] = Future()

    class Quiet(Client):
        def start(self, **settings: Any) -> None:
            try:
                super().start(**settings)
            except BaseException:
                self.status = "closed"  # or closing would wait for the failed connection once more
                raise

    def connect() -> None:
        try:
            client.set_result(Quiet(address, timeout=seconds, set_as_default=False))
        except BaseException as error:
            client.set_exception(error)

    Thread(target=connect, daemon=True).start()
    try:
        return client.result(seconds + 0.5)
    except Exception as error:
        reason = str(error) or f"no answer within {seconds:g} s"
        raise ValueError(f"no Dask scheduler answers at {address} ({reason}). Start one: dask scheduler") from None


def wait_for_worker(client: Any, address: str, seconds: float) -> None:
    """Wait for the first worker of a scheduler; `ValueError` if there is none in time."""
    try:
        client.wait_for_workers(1, timeout=seconds)
    except TimeoutError:
        raise ValueError(f"the scheduler at {address} has no worker. Start some: dask worker {address}") from None
