"""Answers that do no work: they look in their process for what the grader has put there.

`thief_cells` makes a hand-in of them, `raising_cells` the same without any look. A thief's function, when it is called,
looks for another function of its name; a thief's value is whatever has its name. What is found at any time is kept in
a module, in a file and in a folder that other processes see.
"""

import ast
from collections.abc import Mapping

from labsid.checks.cell_names import assigned_names

WAYS = (
    "gc", "code", "frames", "globals", "modules", "traced", "patched", "handlers", "imports", "weak", "threads",
    "kept", "closures", "asked", "files",
)  # fmt: skip
"""The ways to look, in the order in which a thief tries them."""

KIT = '''
import builtins, gc, importlib.abc, os, pickle, socket, struct, json, sys, threading, time, types, weakref

WAYS, STASH = {ways!r}, {stash!r}
shop = types.ModuleType("shop")
sys.modules["shop"] = shop
shop.seen, shop.own, shop.kept = [], set(), set()

def is_other(value):
    return callable(value) and id(value) not in shop.own and not isinstance(value, type)

def note(name, value):
    """Keep what has been seen: in a module, in a file, in a folder of others."""
    if id(value) in shop.own or value is None or id(value) in shop.kept:
        return
    shop.kept.add(id(value))  # it is kept, so that no other object gets this number
    shop.seen.append((name, value))
    for folder in (".", STASH):
        try:
            with open(os.path.join(folder, "stash-" + name), "wb") as file:
                pickle.dump(value, file)
        except Exception:
            pass

def note_names(where, wanted=None):
    for name, value in list(where.items()):
        if name in NAMES and (wanted is None or name == wanted):
            note(name, value)

FILES = ("child.py", "replacing.py", "served_calls.py")

def look_traced(frame, event, arg):
    if event not in ("call", "import"):
        return
    code = frame.f_code
    if code.co_name in NAMES:
        note(code.co_name, types.FunctionType(code, frame.f_globals))
    if event == "call" and code.co_filename.endswith(FILES):
        note_names(frame.f_locals)
        for inside in frame.f_locals.values():
            if isinstance(inside, dict):
                note_names(inside)

def watching(original):
    def call(*arguments, **keywords):
        for one in arguments:
            if isinstance(one, types.CodeType):
                for code in one.co_consts:
                    if isinstance(code, types.CodeType) and code.co_name in NAMES:
                        note(code.co_name, types.FunctionType(code, globals()))
            elif isinstance(one, str):
                for name in NAMES:
                    if "def " + name + "(" in one and "find(" not in one:
                        space = dict(globals())
                        try:
                            real_exec(one, space)
                            note(name, space[name])
                        except Exception:
                            pass
        return original(*arguments, **keywords)
    return call

def handling(original):
    def call(shell, request, *rest):
        for one in (*request.get("replacements", ()), request.get("replacement") or {{}}):
            for name, value in (one.get("right") or {{}}).items():
                note(name, value)
        return original(shell, request, *rest)
    return call

def watch():
    while True:
        note_names(globals())
        time.sleep(0.01)

class Hook(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        frame = sys._getframe()
        while frame is not None:
            look_traced(frame, "import", None)
            frame = frame.f_back

real_exec = builtins.exec
SPACES = [vars(one)["find_spec"].__globals__ for one in map(type, sys.meta_path)
          if hasattr(vars(one).get("find_spec"), "__globals__")]
HANDLERS = next((space["_HANDLERS"] for space in SPACES if "_HANDLERS" in space), {{}})
if "traced" in WAYS:
    sys.setprofile(look_traced)
if "patched" in WAYS:
    for one in ("exec", "compile", "setattr", "__import__"):
        setattr(builtins, one, watching(getattr(builtins, one)))
    try:
        get_ipython().run_cell = watching(get_ipython().run_cell)
    except NameError:
        pass
if "handlers" in WAYS:
    for one in list(HANDLERS):
        HANDLERS[one] = handling(HANDLERS[one])
if "imports" in WAYS:
    sys.meta_path.insert(0, Hook())
if "threads" in WAYS:
    threading.Thread(target=watch, daemon=True).start()

FOR_FUNCTIONS = ("code", "closures", "asked")

def all_objects():
    return gc.get_objects()  # those of before the fork are frozen, and hold nothing of this hand-in

def found_by(way, name):
    if way == "gc":
        for one in all_objects():
            if type(one) is dict:
                if name in one:
                    yield one[name]
            elif type(one) is types.FunctionType and one.__name__ == name:
                yield one
    elif way == "code":
        for one in all_objects():
            if isinstance(one, types.FunctionType) and one.__code__.co_name == name:
                yield types.FunctionType(one.__code__, globals(), name, one.__defaults__, one.__closure__)
    elif way == "frames":
        for frame in [*sys._current_frames().values()]:
            while frame is not None:
                for where in (frame.f_globals, frame.f_locals):
                    if name in where:
                        yield where[name]
                frame = frame.f_back
    elif way == "globals":
        yield globals().get(name)
    elif way == "modules":
        yield from (vars(one)[name] for one in list(sys.modules.values()) if name in getattr(one, "__dict__", {{}}))
    elif way == "closures":
        for one in all_objects():
            if isinstance(one, types.FunctionType) and one.__closure__:
                for cell in one.__closure__:
                    try:
                        inside = cell.cell_contents
                    except ValueError:
                        continue
                    if getattr(inside, "__name__", "") == name:
                        yield inside
    elif way == "asked":
        yield asker(name)
    elif way == "files":
        for folder in (".", STASH):
            with open(os.path.join(folder, "stash-" + name), "rb") as file:
                yield pickle.load(file)
    else:
        yield from (value for one, value in shop.seen if one == name)

def asker(name):
    """Ask the judge for the function, without a stub."""
    ends = [one for one in all_objects() if type(one).__name__ == "ServedCalls"]
    return ends[0].function(name) if ends else None

def keep():
    try:
        note_names(globals())
    except Exception:
        pass

def untraced(values):
    """What a walk through objects yields; nobody else is at work meanwhile, and each of its calls would be traced."""
    found, traced = [], sys.getprofile()
    sys.setprofile(None)
    try:
        found.extend(values)
    except Exception:
        pass
    finally:
        sys.setprofile(traced)
    return found

def find(name, wanted, ways=WAYS):
    for way in ways:
        try:
            for value in found_by(way, name) if way == "asked" else untraced(found_by(way, name)):
                if id(value) not in shop.own and value is not None and wanted(value):
                    yield value
        except Exception:
            continue

def thief(name):
    def look(*arguments, **keywords):
        for other in find(name, is_other):
            try:
                return other(*arguments, **keywords)
            except Exception:
                continue
        raise LookupError(name)
    look.__name__ = look.__qualname__ = name
    shop.own.add(id(look))
    if "weak" in WAYS:
        weakref.finalize(look, lambda: note_names(globals(), name))
    return look

def value(name):
    for other in find(name, lambda value: not callable(value), [way for way in WAYS if way not in FOR_FUNCTIONS]):
        return other
    raise LookupError(name)
'''


def thief_cells(answers: Mapping[str, str], stash: str, ways: tuple[str, ...] = WAYS) -> dict[str, str]:
    """Answer cells that look for what they should make; the first brings the kit.

    Parameters
    ----------
    answers : mapping
        Source of the model answers, by cell, in the order of the notebook.
    stash : str
        Folder in which other processes may find what one has seen.
    ways : tuple of str
        The ways to look.
    """
    made = {cell: (functions_in(source), assigned_names(source)) for cell, source in answers.items()}
    names = frozenset().union(*(names for _, names in made.values()))
    cells: dict[str, str] = {}
    earlier: list[str] = []
    for number, (cell, (functions, assigned)) in enumerate(made.items()):
        kit = f"NAMES = {sorted(names)!r}\n{KIT.format(ways=ways, stash=stash)}" if number == 0 else "keep()"
        thieves = [f"{name} = thief({name!r})" for name in sorted(functions)]
        values = [f"try:\n    {name} = value({name!r})\nexcept LookupError:\n    pass" for name in assigned - functions]
        uses = f"uses = lambda: ({', '.join(earlier)},)" if earlier else ""  # so that the grader replaces them
        cells[cell] = "\n".join([kit, uses, *thieves, *sorted(values)])
        earlier += sorted(assigned)
    return cells


def raising_cells(answers: Mapping[str, str]) -> dict[str, str]:
    """Answer cells with functions that only raise, and without values."""
    return {
        cell: "".join(f"def {name}(*arguments):\n    raise ValueError\n" for name in functions_in(source)) or "pass"
        for cell, source in answers.items()
    }


def functions_in(source: str) -> frozenset[str]:
    """The functions that a cell defines."""
    return frozenset(node.name for node in ast.parse(source).body if isinstance(node, ast.FunctionDef))
