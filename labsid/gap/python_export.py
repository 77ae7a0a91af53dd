"""Corrected simulations as Python modules."""

import json
import os
from pathlib import Path
from typing import Any

from labsid._files import write_file
from labsid.simulators.sources import source_file

_MODULE = '''\
"""Corrected simulation, written by `labsid gap diagnose --export`. It needs labsid{needs}.

`simulate(t, u)` starts from rest; with the measured output `y`, its first 50 samples determine the initial state.
"""

import json
from pathlib import Path

from labsid.gap.model_file import from_json_dict

_CONTENT = json.loads(r"""
{content}
""")
{place}_MODEL = from_json_dict(_CONTENT)


def simulate(t, u, y=None):
    """Output of the corrected simulation; the times `t` must have the sampling time of the record, {Ts:g} s."""
    return _MODEL.simulate(u, y)
'''
_PLACE = '_CONTENT["simulator"]["source"] = str(Path(__file__).resolve().parent / _CONTENT["simulator"]["source"])\n'


def write_python_module(path: Path, content: dict[str, Any]) -> None:
    """Write an exported simulation as a Python module with a function ``simulate(t, u, y=None)``.

    Parameters
    ----------
    path : Path
    content : dict
        From `ExportedModel.to_json_dict`. The file of a given simulation is named relative to `path`.
    """
    needs = place = ""
    if "simulator" in content:
        source = content["simulator"]["source"]
        file = source_file(Path(source))
        near = os.path.relpath(file.resolve(), path.resolve().parent)
        content = content | {"simulator": content["simulator"] | {"source": source.replace(str(file), near, 1)}}
        needs, place = f" and {near}", _PLACE
    text = _MODULE.format(content=json.dumps(content, indent=1), needs=needs, place=place, Ts=content["Ts"])
    write_file(path, text.encode())
