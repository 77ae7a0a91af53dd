"""The command in this process."""

import pytest

from labsid.cli.commands import main


@pytest.fixture
def labsid(capsys):
    """Run the command in this process: status, standard output, standard error."""

    def run(*arguments):
        status = main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return run
