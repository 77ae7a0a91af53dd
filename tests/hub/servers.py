"""JupyterHub on the test's machine, and what a browser does with it: servers of students, their files and kernels."""

import asyncio
import json
import secrets
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from typing import IO, Any

from tornado.httpclient import HTTPRequest
from tornado.websocket import websocket_connect

from hub.machine import Machine

CONFIG = "/etc/jupyterhub/jupyterhub_config.py"
_START_SECONDS = 120

_OF_THE_TEST = """
c.JupyterHub.bind_url = "http://127.0.0.1:{port}"
c.JupyterHub.hub_bind_url = "http://127.0.0.1:{hub}"
c.ConfigurableHTTPProxy.api_url = "http://127.0.0.1:{proxy}"
c.ConfigurableHTTPProxy.command = {command!r}
c.JupyterHub.db_url = "sqlite:////srv/hub.sqlite"
c.JupyterHub.cookie_secret_file = "/srv/hub-cookie-secret"
c.ConfigurableHTTPProxy.pid_file = "/srv/hub-proxy.pid"
c.JupyterHub.authenticator_class = "shared-password"
c.SharedPasswordAuthenticator.user_password = {password!r}
c.Authenticator.allow_all = True
c.JupyterHub.services = [{{"name": "test", "api_token": {token!r}}}]
c.JupyterHub.load_roles = [
    {{"name": "test", "services": ["test"], "scopes": ["admin:users", "admin:servers", "access:servers"]}}
]
c.Spawner.start_timeout = {seconds}
c.Spawner.http_timeout = {seconds}
"""


class RunningHub:
    """JupyterHub with its proxy, on loopback.

    Parameters
    ----------
    machine : Machine
    config : str
        Lines of its configuration; those of the test, which choose ports and who may log in, are added.
    log : binary file
        Takes what the hub writes.
    """

    def __init__(self, machine: Machine, config: str, log: IO[bytes]) -> None:
        self._token = secrets.token_hex(16)
        port, hub, proxy = _free_ports(3)
        self.url = f"http://127.0.0.1:{port}"
        own = _OF_THE_TEST.format(
            port=port,
            hub=hub,
            proxy=proxy,
            command=[
                sys.executable,
                "-P",
                "-c",
                "import sys; from configurable_http_proxy.cli import main; sys.exit(main())",
            ],
            password=secrets.token_hex(16),
            token=self._token,
            seconds=_START_SECONDS,
        )
        machine.write(CONFIG, f"c = get_config()\n{config}\n{own}", mode="600")
        command = [sys.executable, "-P", "-m", "jupyterhub", "-f", CONFIG]
        self._log = log
        self._process = subprocess.Popen(
            machine.command("root", command, {}), stdin=subprocess.DEVNULL, stdout=self._log, stderr=self._log
        )

    def wait_until_ready(self) -> None:
        """Wait until the hub answers."""
        self._wait(lambda: self._asked("GET", "/hub/api/"), "the hub does not start")

    def close(self) -> None:
        """End the hub, its proxy and the servers of the students."""
        self._process.terminate()
        try:
            self._process.wait(timeout=30)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def log(self) -> str:
        """What the hub wrote."""
        self._log.flush()
        self._log.seek(0)
        return str(self._log.read().decode(errors="replace"))

    def start_server(self, user: str) -> None:
        """Start the server of a student, and wait until it answers."""
        self._asked("POST", f"/hub/api/users/{user}")
        self._asked("POST", f"/hub/api/users/{user}/server")
        self._wait(lambda: self._asked("GET", f"/user/{user}/api/status"), f"the server of {user} does not start")

    def read(self, user: str, path: str) -> Any:
        """A notebook or file in the folder that a student's server shows."""
        return self._asked("GET", f"/user/{user}/api/contents/{path}?content=1")["content"]

    def save(self, user: str, path: str, notebook: Any) -> None:
        """Save a notebook as JupyterLab does."""
        self._asked(
            "PUT", f"/user/{user}/api/contents/{path}", {"type": "notebook", "format": "json", "content": notebook}
        )

    def run_cell(self, user: str, source: str) -> str:
        """Run a cell in a new kernel of the start page; returns what it printed, or its error."""
        wanted = {"path": "start.ipynb", "name": "", "type": "notebook", "kernel": {"name": "python3"}}
        session = self._asked("POST", f"/user/{user}/api/sessions", wanted)
        try:
            return asyncio.run(self._run(user, session["kernel"]["id"], source))
        finally:
            self._asked("DELETE", f"/user/{user}/api/sessions/{session['id']}")

    async def _run(self, user: str, kernel: str, source: str) -> str:
        url = f"{self.url}/user/{user}/api/kernels/{kernel}/channels".replace("http", "ws", 1)
        request = HTTPRequest(url, headers={"Authorization": f"token {self._token}"}, connect_timeout=60)
        channel = await websocket_connect(request)
        number = secrets.token_hex(8)
        header = {"msg_id": number, "msg_type": "execute_request", "session": number, "username": "", "version": "5.3"}
        content = {"code": source, "silent": False, "store_history": False, "allow_stdin": False}
        message = {"header": header, "parent_header": {}, "metadata": {}, "content": content, "channel": "shell"}
        await channel.write_message(json.dumps(message))
        said: list[str] = []
        while True:
            reply = json.loads(await asyncio.wait_for(channel.read_message(), _START_SECONDS) or "null")
            assert reply is not None, "the kernel's channel was closed"
            if reply["parent_header"].get("msg_id") != number:
                continue
            match reply["msg_type"]:
                case "stream":
                    said.append(reply["content"]["text"])
                case "error":
                    said.append(f"{reply['content']['ename']}: {reply['content']['evalue']}")
                case "status" if reply["content"]["execution_state"] == "idle":  # after all that it printed
                    channel.close()
                    while await channel.read_message() is not None:
                        pass
                    return "".join(said)

    def _asked(self, method: str, path: str, body: Any = None) -> Any:
        request = urllib.request.Request(
            self.url + path,
            None if body is None else json.dumps(body).encode(),
            {"Authorization": f"token {self._token}", "Content-Type": "application/json"},
            method=method,
        )
        with urllib.request.urlopen(request, timeout=_START_SECONDS) as reply:
            content = reply.read()
        return json.loads(content) if content else None

    def _wait(self, ask: Any, otherwise: str) -> None:
        deadline = time.monotonic() + _START_SECONDS
        while True:
            try:
                ask()
                return
            except OSError as error:
                if isinstance(error, urllib.error.HTTPError):
                    error.close()
                assert time.monotonic() < deadline, f"{otherwise}\n{self.log()}"
                assert self._process.poll() is None, f"{otherwise}\n{self.log()}"
                time.sleep(0.3)


@contextmanager
def open_hub(machine: Machine, config: str) -> Iterator[RunningHub]:
    """A hub that answers, and is closed at the end."""
    with tempfile.TemporaryFile() as log:
        hub = RunningHub(machine, config, log)
        try:
            hub.wait_until_ready()
            yield hub
        finally:
            hub.close()


def _free_ports(count: int) -> list[int]:
    open_sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [one.getsockname()[1] for one in open_sockets]
    for one in open_sockets:
        one.close()
    return ports
