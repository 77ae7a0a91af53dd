"""The one door to nbgrader.

nbgrader asks the program ``alembic`` by its bare name for the version of its tables, which takes seconds and fails
outside an activated environment. Behind this door the same library is asked in this process.
"""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

COURSE_ID = "labsid"


def import_nbgrader_api() -> Any:
    """Import ``nbgrader.api``."""
    import nbgrader.api

    nbgrader.api.get_alembic_version = _alembic_version
    return nbgrader.api


def open_gradebook(url: str) -> Any:
    """Open a gradebook, made where it is not there; a context manager.

    Raises
    ------
    ValueError
        If the database cannot be reached, or the package that speaks with it is not installed.
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
        said = " ".join(str(getattr(error, "orig", None) or error).split())
        try:
            where = make_url(url).render_as_string()  # without its password
        except SQLAlchemyError:
            where, said = "that CourseDirectory.db_url names", "it is no address of a database"
        raise ValueError(
            f"the gradebook {where} cannot be opened: {said}. "
            "Is the server running, and CourseDirectory.db_url in nbgrader_config.py right?"
        ) from None


@contextlib.contextmanager
def without_disk_sync() -> Iterator[None]:
    """Let every database that is opened meanwhile not wait for the disk: for one that is new, and holds no grades."""
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
