"""YAML read safely, with errors that name the line."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.place import Place, Way, short, shown

_LARGEST_KEY = 10**18  # of a whole number; one of thousands of digits cannot be printed in an error
_SIZE_LIMIT = 4_000_000  # bytes; a hand-written file is a thousand times smaller
_DEEPEST = 40  # levels; a parser takes for each word a time that grows with how deep it stands, and files need six


_QUESTION = re.compile(r"^([^#]*:\s*TODO\s*(?:[,}][^#]*)?)(?:#(.*))?$")


class _Loader(yaml.SafeLoader):
    """SafeLoader that refuses a key given twice, aliases (which let small files grow exponentially) and deep nests."""

    depth = 0

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        if self.check_event(yaml.AliasEvent):
            mark = self.peek_event().start_mark  # type: ignore[no-untyped-call]
            raise yaml.MarkedYAMLError(problem="aliases (*name) are not accepted", problem_mark=mark)
        if self.depth == _DEEPEST:
            mark = self.peek_event().start_mark  # type: ignore[no-untyped-call]
            raise yaml.MarkedYAMLError(problem=f"nests deeper than {_DEEPEST} levels", problem_mark=mark)
        self.depth += 1
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: set[Any] = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, str | int | float | bool) or (isinstance(key, int) and abs(key) > _LARGEST_KEY):
                raise yaml.MarkedYAMLError(problem="a key must be a plain word", problem_mark=key_node.start_mark)
            if key in seen:
                raise yaml.MarkedYAMLError(problem=f"key {key!r} stands twice", problem_mark=key_node.start_mark)
            seen.add(key)
        return super().construct_mapping(node, deep)


# 1e6 is a number here: YAML 1.1 wants 1.0e+6, which nobody writes.
_Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^[-+]?([0-9][0-9_]*)(\.[0-9_]*)?([eE][-+]?[0-9]+)$|^[-+]?\.[0-9]+([eE][-+]?[0-9]+)?$"),
    list("-+0123456789."),
)


def load_mapping(path: Path) -> dict[str, Any]:
    """The mapping that a YAML file holds; see ``load_with_lines``."""
    return load_with_lines(path)[1]


def load_with_lines(path: Path) -> tuple[Place, dict[str, Any]]:
    """Read a YAML file that holds a mapping.

    Returns
    -------
    place : Place
        Of the file, which knows the line of every key.
    content : dict

    Raises
    ------
    InputError
        The file is absent, too large, not YAML, not a mapping, or a line still says TODO.
    """
    if not path.is_file():
        raise InputError(str(path), "no such file", "Give the path of an existing YAML file")
    if path.stat().st_size > _SIZE_LIMIT:
        raise InputError(str(path), f"{path.stat().st_size} bytes is too large for a parameter or session file")
    try:
        text = path.read_text(encoding="utf-8-sig")
        _refuse_questions(path, text)
        loader = _Loader(text)
        try:
            node = loader.get_single_node()
            content = loader.construct_document(node) if node is not None else None
        finally:
            loader.dispose()
    except UnicodeDecodeError as error:
        raise InputError(str(path), "is not UTF-8 text", "Save it as UTF-8") from error
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f"{path}:{mark.line + 1}" if mark else str(path)
        raise InputError(place, f"is not valid YAML: {error.problem}", "Mend this line") from error
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        raise InputError(f"{path}:{line}", f"holds the letter U+{error.character:04X}", "Take it out") from error
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise InputError(str(path), f"is not valid YAML: {error}") from error
    if node is None or not isinstance(content, dict):
        raise InputError(str(path), f"holds a {type(content).__name__}, expected a mapping of keys")
    return Place(str(path), lines=dict(_lines(node, ()))), content


def expect_schema(place: Place, content: Mapping[str, Any], schema: str) -> None:
    """Refuse a file of another kind before its keys are looked at.

    Raises
    ------
    InputError
        The key ``schema`` is missing or names something else.
    """
    found = content.get("schema")
    if found != schema:
        got = "is missing" if found is None else f"is {shown(found)}"
        raise place.at("schema").error(
            f"{got}, expected {schema}", f"Write schema: {schema}, if this is the right file"
        )


def _lines(node: yaml.Node, way: Way) -> Iterator[tuple[Way, int]]:
    """Each key's way and its line, those of list items by their number."""
    if isinstance(node, yaml.MappingNode):
        for key, value in node.value:
            yield (*way, str(key.value)), key.start_mark.line + 1
            yield from _lines(value, (*way, str(key.value)))
    elif isinstance(node, yaml.SequenceNode):
        for index, value in enumerate(node.value):
            yield (*way, index), value.start_mark.line + 1
            yield from _lines(value, (*way, index))


def _refuse_questions(path: Path, text: str) -> None:
    """A value that says TODO is a question which `ident new` left; the comment behind it is the question."""
    for number, line in enumerate(text.splitlines(), start=1):
        asked = _QUESTION.match(line)
        if asked:
            raise InputError(
                f"{path}:{number}",
                f"still says TODO: {short(line.partition('#')[0].strip(' -'), 160)}",
                f"Fill in: {short(asked[2].strip(), 300)}" if asked[2] else "Fill this line in",
            )
