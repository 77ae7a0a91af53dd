"""Corrected simulations as Python modules."""

import json
import os
from pathlib import Path
from typing import Any

from labsid._files import write_file
from labsid.gap.dynamics.record_start import LEAST_START
from labsid.gap.model_file import with_sources
from labsid.simulators.sources import source_file

_MODULE = '''\
"""Corrected simulation, written by `labsid gap diagnose --export`. It needs labsid{needs}.

`simulate(t, u)` starts from rest; with the measured output `y`, its first samples determine the initial state: two of
the slowest time constants, at least {least} and at most a quarter of them; all where these say too little.
"""

import json
from pathlib import Path

from labsid.gap.model_file import from_json_dict, in_folder

_CONTENT = json.loads(r"""
{content}
""")
_MODEL = from_json_dict(in_folder(_CONTENT, Path(__file__).resolve().parent))


def simulate(t, u, y=None):
    """Output of the corrected simulation; the times `t` must have the sampling time of the record, {Ts:g} s."""
    return _MODEL.simulate(u, y)
'''


def write_python_module(path: Path, content: dict[str, Any]) -> None:
    """Write an exported simulation as a Python module with a function ``simulate(t, u, y=None)``.

    Parameters
    ----------
    path : Path
    content : dict
        From `ExportedModel.to_json_dict`. The file of a given simulation is named relative to `path`.
    """

    def near(source: str) -> str:
        file = source_file(Path(source))
        return source.replace(str(file), os.path.relpath(file.resolve(), path.resolve().parent), 1)

    content = with_sources(content, near)
    needs = f" and {source_file(Path(content['simulator']['source']))}" if "simulator" in content else ""
    text = _MODULE.format(content=json.dumps(content, indent=1), needs=needs, least=LEAST_START, Ts=content["Ts"])
    write_file(path, text.encode())
