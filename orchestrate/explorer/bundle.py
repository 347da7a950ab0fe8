"""Join JavaScript modules into one script, in the order of their imports.

Enough for modules that keep to three rules: imports are named and stand at the line's start, what
is exported is declared as ``export function``, ``class`` or ``const``, and no import goes round in
a circle.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

IMPORT = re.compile(r'^import \{([^}]*)\} from "\./([\w]+)\.js";\n', flags=re.M)
EXPORT = re.compile(r"^export ((?:async )?(?:function\*?|class|const|let)) (\w+)", flags=re.M)


def bundle_modules(sources: Mapping[str, str], entry: str) -> str:
    order: list[str] = []
    append_with_imports(sources, entry, order)
    return '"use strict";\n' + "".join(wrap_module(name, sources[name]) for name in order)


def append_with_imports(sources: Mapping[str, str], name: str, order: list[str]) -> None:
    if name in order:
        return
    for match in IMPORT.finditer(sources[name]):
        append_with_imports(sources, match[2], order)
    order.append(name)


def wrap_module(name: str, source: str) -> str:
    exported = ", ".join(match[2] for match in EXPORT.finditer(source))
    body = IMPORT.sub(rewrite_import, source)
    body = EXPORT.sub(r"\1 \2", remove_block_comments(body)).strip()
    return f"const module_{name} = (() => {{\n{body}\nreturn {{ {exported} }};\n}})();\n"


def rewrite_import(match: re.Match[str]) -> str:
    """Return an import statement rewritten as constants from the other module's function."""
    names = " ".join(match[1].split()).rstrip(",")
    return f"const {{ {names} }} = module_{match[2]};\n"


def remove_block_comments(source: str) -> str:
    """Return a source without block comments that fill whole lines."""
    return re.sub(r"^[ \t]*/\*\*(?:(?!\*/).)*\*/[ \t]*\n", "", source, flags=re.M | re.S)
