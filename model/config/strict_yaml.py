"""YAML as this project reads and writes it: a strict, harmless subset.

Reading gives mappings, lists, text and None only; whether a text is a number is for the parameter table to
say. So `6e7` is a number, duplicate keys are errors, and tags, anchors and aliases (alias bombs) are refused.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Sequence
from typing import Any

import yaml

LONG = 2000  # characters of a text that is folded at its commas: PyYAML takes seconds for a long profile
PIECES = 6  # between two folds
DEPTH_LIMIT = 20  # of nested mappings and lists
NODE_LIMIT = 2000  # keys, values and lists in all; a full configuration has some 150


def parse_yaml(text: str) -> Any:
    """The value that a YAML text describes: dict, list, str or None, nested.

    Raises yaml.YAMLError with line and column for anything outside the subset.
    """
    loader = _Loader(text)
    try:
        return loader.get_single_data()
    except (ValueError, OverflowError):  # how PyYAML meets "\U00110000", "%YAML 1.999…" with thousands of digits
        problem = "a character or a number that does not exist"
        raise yaml.MarkedYAMLError(problem=problem, problem_mark=loader.get_mark()) from None
    finally:
        loader.dispose()


def key_lines(text: str, paths: Sequence[str]) -> list[int]:
    """The lines, from 1, on which a YAML text that can be parsed has dotted keys, such as road.parts[0].height.

    Of a key that is not there: the line of the section that it would be in. 0: not even that is there.
    """
    loader = _Loader(text)
    try:
        root = loader.get_single_node()
    finally:
        loader.dispose()
    return [_line(root, path) for path in paths]


def _line(node: yaml.Node | None, path: str) -> int:
    line = 0
    for key, number in re.findall(r"([^.\[\]]+)|\[(\d+)\]", path):
        if key and isinstance(node, yaml.MappingNode):
            found = [(name, value) for name, value in node.value if name.value == key]
        elif number and isinstance(node, yaml.SequenceNode):
            found = [(item, item) for item in node.value[int(number) : int(number) + 1]]
        else:
            found = []
        if not found:
            break
        place, node = found[0]
        line = place.start_mark.line + 1
    return line


def dump_yaml(value: dict[str, Any]) -> str:
    """A mapping of plain values as YAML: sections in blocks, leaves of a section in one flow mapping.

    Texts of more than LONG characters hold no quotes and no line breaks.
    """
    long: list[str] = []
    text = yaml.dump(
        _shortened(value, long), Dumper=_Dumper, sort_keys=False, default_flow_style=None, allow_unicode=True, width=160
    )
    for number, whole in enumerate(long):
        text = text.replace(_stand_in(number), "'" + _FOLD.sub(r"\1\n    ", whole) + "'")
    return text


_FOLD = re.compile(rf"((?:[^,]*,){{{PIECES}}}) ")


def _stand_in(number: int) -> str:
    return f"long-text-{number}-{'x' * 8}"


def _shortened(value: Any, long: list[str]) -> Any:
    """The value with stand-ins for long texts, which go to the list."""
    if isinstance(value, dict):
        return {key: _shortened(inner, long) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_shortened(inner, long) for inner in value]
    if isinstance(value, str) and len(value) > LONG:
        long.append(value)
        return _stand_in(len(long) - 1)
    return value


class _Loader(yaml.SafeLoader):
    yaml_implicit_resolvers: dict[str, Any] = {}  # noqa: RUF012 (PyYAML's own way)

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.depth = self.nodes = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        event = self.peek_event()
        if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None) is not None:
            raise _refused("anchors and aliases are not used here", event)
        if getattr(event, "tag", None) is not None:
            raise _refused("tags are not used here", event)
        if self.depth >= DEPTH_LIMIT:
            raise _refused(f"nested deeper than {DEPTH_LIMIT} levels", event)
        if self.nodes >= NODE_LIMIT:
            raise _refused(f"more than {NODE_LIMIT} keys and values", event)
        self.nodes += 1
        self.depth += 1
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:
        mapping: dict[Hashable, Any] = {}
        for key_node, value_node in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                raise _refused("a key must be a plain word", key_node)
            if key_node.value in mapping:
                raise _refused(f"the key {key_node.value[:60]!r} is given twice", key_node)
            mapping[key_node.value] = self.construct_object(value_node, deep=True)
        return mapping


_Loader.add_implicit_resolver("tag:yaml.org,2002:null", re.compile(r"^(?:~|null|Null|NULL|)$"), ["~", "n", "N", ""])


def _refused(problem: str, where: Any) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=problem, problem_mark=where.start_mark)


class _Dumper(yaml.SafeDumper):
    pass


def _represent_float(dumper: _Dumper, value: float) -> yaml.ScalarNode:
    """The shortest text that reads back as the same number here and in any YAML reader: 5125, 0.7, 6.0e+7."""
    text = f"{value:g}" if float(f"{value:g}") == value else repr(value)
    mantissa, e, exponent = text.partition("e")
    if e:
        text = f"{mantissa if '.' in mantissa else mantissa + '.0'}e{int(exponent):+d}"
    kind = "float" if "." in text else "int"
    return dumper.represent_scalar(f"tag:yaml.org,2002:{kind}", text)


_Dumper.add_representer(float, _represent_float)
