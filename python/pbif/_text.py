"""Sweep files as text: what is given in Python, written as TOML. What is wrong with it is told by the library."""
from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any


def value(given: Any) -> str:
    """A value as TOML on one line."""
    if isinstance(given, bool):
        return "true" if given else "false"
    if isinstance(given, str):
        return json.dumps(given, ensure_ascii=False)
    if isinstance(given, Mapping):
        return "{ " + ", ".join(f"{key(name)} = {value(one)}" for name, one in given.items()) + " }"
    if hasattr(given, "__index__"):
        return str(int(given))
    if hasattr(given, "__float__"):
        return repr(float(given))
    return "[" + ", ".join(value(one) for one in given) + "]"


def key(name: str) -> str:
    """A key, in quotes where it needs them."""
    bare = name and all(c.isascii() and (c.isalnum() or c in "_-") for c in name)
    return name if bare else json.dumps(name, ensure_ascii=False)


def document(sections: Mapping[str, Any]) -> str:
    """A document: plain values first, then a table a section, the tables in it on one line each but for `system`."""
    plain = [f"{key(name)} = {value(one)}" for name, one in sections.items() if not isinstance(one, Mapping)]
    lines = list(plain)
    for name, section in sections.items():
        if not isinstance(section, Mapping):
            continue
        lines += ["", f"[{key(name)}]"]
        below = {one: of for one, of in section.items() if name == "system" and isinstance(of, Mapping)}
        lines += [f"{key(one)} = {value(of)}" for one, of in section.items() if one not in below]
        for one, of in below.items():
            lines += ["", f"[{key(name)}.{key(one)}]"]
            lines += [f"{key(n)} = {value(v)}" for n, v in of.items()]
    return "\n".join(lines) + "\n"


def settings(given: Mapping[str, Any] | Iterable[str]) -> list[str]:
    """Settings as `KEY=VALUE`: keys of a sweep file with points, or mappings of them."""
    if not isinstance(given, Mapping):
        return list(given)
    found: list[str] = []
    for name, one in given.items():
        if isinstance(one, Mapping):
            found += [f"{key(name)}.{rest}" for rest in settings(one)]
        else:
            found.append(f"{name}={value(one)}")
    return found
