"""Access to nbgrader and its gradebook.

nbgrader runs the program ``alembic`` to find the version of its tables, which takes seconds and fails outside an
activated environment. Here, the alembic library is called instead.
"""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

COURSE_ID = "labsid"


def import_nbgrader_api() -> Any:
    """Import ``nbgrader.api`` with the alembic program replaced by the library."""
    import nbgrader.api

    nbgrader.api.get_alembic_version = _alembic_version
    return nbgrader.api


def open_gradebook(url: str) -> Any:
    """Open a gradebook as a context manager; creates it if it does not exist.

    Raises
    ------
    ValueError
        If the database cannot be opened, or its driver is not installed.
    """
    api = import_nbgrader_api()
    from sqlalchemy.engine import make_url
    from sqlalchemy.exc import SQLAlchemyError

    try:
        return api.Gradebook(url, COURSE_ID)
    except ModuleNotFoundError as error:
        package = {"psycopg": "labsid[postgres]"}.get(str(error.name), error.name)
        raise ValueError(
            f"the gradebook is a database that needs the package {error.name}. Install it: pip install '{package}'"
        ) from None
    except SQLAlchemyError as error:
        problem = " ".join(str(getattr(error, "orig", None) or error).split())
        try:
            address = make_url(url).render_as_string()  # hides the password
        except SQLAlchemyError:
            address, problem = "of CourseDirectory.db_url", "it is not a database URL"
        raise ValueError(
            f"the gradebook {address} cannot be opened: {problem}. "
            "Check that the server runs and that CourseDirectory.db_url in nbgrader_config.py is right."
        ) from None


@contextlib.contextmanager
def without_disk_sync() -> Iterator[None]:
    """Open SQLite databases without waiting for the disk: new gradebooks, and databases that are thrown away."""
    from sqlalchemy import event
    from sqlalchemy.engine import Engine

    def connected(connection: Any, _: Any) -> None:
        if type(connection).__module__.startswith("sqlite3"):
            connection.execute("PRAGMA synchronous=OFF")

    event.listen(Engine, "connect", connected)
    try:
        yield
    finally:
        event.remove(Engine, "connect", connected)


def _alembic_version() -> str:
    import nbgrader
    from alembic.config import Config
    from alembic.script import ScriptDirectory

    config = Config()
    config.set_main_option("script_location", str(Path(nbgrader.__file__).parent / "alembic"))
    return str(ScriptDirectory.from_config(config).get_current_head())
