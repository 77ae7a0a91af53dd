"""The rig imports neither the identification nor the diagnosis."""

import ast
from pathlib import Path

import labsid.rig

ALLOWED = ("labsid._arrays", "labsid.records.record", "labsid.rig")


def test_the_rig_imports_no_identification_and_no_diagnosis():
    sources = sorted(Path(labsid.rig.__file__).parent.rglob("*.py"))
    assert len(sources) > 5
    for source in sources:
        for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom):
                assert node.level == 0
                if node.module == "labsid._compiled":  # its decorator, and none of the loops of the identification
                    assert [alias.name for alias in node.names] == ["compiled"], source
                    continue
                names = [node.module]
            elif isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            else:
                continue
            for name in names:
                assert not name.startswith(("labsid", "autograder", "matplotlib")) or name.startswith(ALLOWED), source
