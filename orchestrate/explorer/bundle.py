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
COMMENT = re.compile(r"^[ \t]*/\*\*(?:(?!\*/).)*\*/[ \t]*\n", flags=re.M | re.S)  # of whole lines


def bundle_modules(sources: Mapping[str, str], entry: str) -> str:
    bundled: dict[str, str] = {}
    append_with_imports(sources, entry, bundled)
    return '"use strict";\n' + "".join(bundled.values())


def append_with_imports(sources: Mapping[str, str], name: str, bundled: dict[str, str]) -> None:
    if name in bundled:
        return
    source = sources[name]
    for match in IMPORT.finditer(source):
        append_with_imports(sources, match[2], bundled)
    exported = ", ".join(match[2] for match in EXPORT.finditer(source))
    body = IMPORT.sub(r"const {\1} = module_\2;\n", source)
    body = EXPORT.sub(r"\1 \2", COMMENT.sub("", body)).strip()
    bundled[name] = f"const module_{name} = (() => {{\n{body}\nreturn {{ {exported} }};\n}})();\n"
