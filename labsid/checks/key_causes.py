"""Causes of Python's errors at the keys of dictionaries and the parts of results."""

import ast
import difflib
import re

from labsid.checks.stops import Stop

_LEAST_ALIKE = 0.75


def field_of_a_dictionary(stop: Stop, found: re.Match[str]) -> str | None:
    """A field taken as an attribute."""
    for node in stop.expressions():
        if isinstance(node, ast.Attribute) and node.attr == found[1]:
            said = field_as_attribute(stop, node)
            if said:
                return said
    return f'A dictionary has keys, not attributes: write `["{found[1]}"]` in place of `.{found[1]}`.'


def field_as_attribute(stop: Stop, node: ast.expr) -> str:
    """That an attribute is a field of a dictionary; empty if it is not."""
    if not isinstance(node, ast.Attribute):
        return ""
    owner = ast.unparse(node.value)
    thing = stop.things.get(owner)
    if thing is None or thing.kind != "dictionary" or node.attr not in thing.keys:
        return ""
    return f'`{owner}` is a dictionary: a field is a key of it, `{owner}["{node.attr}"]`.'


def unknown_key(stop: Stop, found: re.Match[str]) -> str | None:
    """A key that a dictionary lacks."""
    for node in stop.expressions():
        if isinstance(node, ast.Subscript):
            thing, owner = stop.things.get(ast.unparse(node.value)), ast.unparse(node.value)
            has_it = thing is not None and found[1].strip("'\"") in thing.keys
            if thing is not None and thing.kind == "dictionary" and thing.keys and not has_it:
                keys = ", ".join(f'"{key}"' for key in thing.keys)
                return " ".join(filter(None, (f"`{owner}` has the keys {keys}.", _meant(owner, found[1], thing.keys))))
    return "The dictionary has no such key: print it with `print(list(name))`."


def _meant(owner: str, written: str, keys: tuple[str, ...]) -> str:
    """What a key that a dictionary lacks stands for; empty if that cannot be told."""
    key = written.strip("'\"")
    levels = [part for part in re.split(r"[\s.,/'\"()\[\]]+", written) if part]
    if len(levels) > 1 and levels[0] in keys:
        further = "".join(f"[{part}]" if part.isdigit() else f'["{part}"]' for part in levels[1:])
        return (
            f'The key names two levels at once. Each has brackets of its own: `{owner}["{levels[0]}"]`, and of that '
            f"`{further}`."
        )
    if re.fullmatch(r"(?:np\.int\d+\()?\d+\)?", key):
        if "cost" in keys:
            return (
                "It is no array: its parts have names. Of what scipy's `least_squares` returns, `.x` is the solution."
            )
        return f"A number is no key here. The key at an index is `list({owner})[index]`."
    near = difflib.get_close_matches(key, keys, 1, _LEAST_ALIKE)
    return f'Is "{near[0]}" meant?' if near else ""


def unknown_part_of_a_result(stop: Stop, found: re.Match[str]) -> str | None:
    """A part that the result of a search does not have."""
    for node in stop.expressions():
        if isinstance(node, ast.Attribute) and node.attr == found[1]:
            thing = stop.things.get(ast.unparse(node.value))
            if thing is not None and thing.kind == "dictionary":
                parts = ", ".join(f"`.{key}`" for key in thing.keys)
                return f"`{ast.unparse(node.value)}` has the parts {parts}."
    return None
