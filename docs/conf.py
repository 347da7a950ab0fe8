"""How the manual is built: ``python -m sphinx -W docs site/html`` makes it, without network.

Pages are MyST Markdown; those with code cells are run when the manual is built. The reference comes
from the docstrings. Formulas become MathML, which browsers show without any script.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from sphinx.util.typing import OptionSpec

import orchestrate

project = "vibroimpact"
author = "the vibroimpact developers"
project_copyright = author
version = release = orchestrate.__version__

extensions = ["myst_nb", "sphinx.ext.autodoc", "numpydoc", "sphinx_copybutton"]
nitpicky = True
nitpick_ignore_regex = [  # of others, whose manuals are on the network; modules that are not public
    (r"py:.*", r"(?:xarray|matplotlib|numpy)\..*"),
    (r"py:.*", r"orchestrate\.[a-z_]+\.\w.*"),
]

html_theme = "furo"
html_title = f"vibroimpact {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sourcelink = True
html_math_renderer = "mathml"
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#1f5f99", "color-brand-content": "#1f5f99"},
    "dark_css_variables": {"color-brand-primary": "#7db7ea", "color-brand-content": "#7db7ea"},
}

myst_enable_extensions = ["dollarmath", "colon_fence", "deflist", "attrs_inline"]
myst_heading_anchors = 3
nb_execution_timeout = 300
nb_execution_raise_on_error = True
nb_merge_streams = True
nb_ipywidgets_js: dict[str, Any] = {}  # there are no widgets, and their scripts are others'
nb_output_stderr = "remove"  # progress bars

autodoc_default_options = {"members": True, "show-inheritance": True}
autodoc_typehints = "none"  # numpydoc's sections have the types
autodoc_member_order = "bysource"
python_maximum_signature_line_length = 80
numpydoc_show_class_members = False
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True


WORDS_A_MINUTE = 200  # of a text that is read to be understood
NOT_READ = (  # word by word: settings of a page, code and what it prints, formulas, comments
    re.compile(r"\A---\n.*?^---\n", re.S | re.M),
    re.compile(r"^(?P<fence>```+|~~~+)[^\n]*\n.*?^(?P=fence) *$", re.S | re.M),
    re.compile(r"^\$\$.*?^\$\$[^\n]*$", re.S | re.M),
    re.compile(r"<!--.*?-->", re.S),
)


def count_words(text: str) -> int:
    """Return the number of words that are read on a page of Markdown."""
    for part in NOT_READ:
        text = part.sub("", text)
    return sum(any(map(str.isalnum, word)) for word in text.split())


def add_reading_time(app: Sphinx, tree: nodes.document) -> None:
    """Write below a page's title how long it takes to read."""
    source = Path(app.env.doc2path(app.env.docname))
    title = next(iter(tree.findall(nodes.title)), None)
    if source.suffix == ".md" and title is not None:
        minutes = max(1, round(count_words(source.read_text(encoding="utf-8")) / WORDS_A_MINUTE))
        text = f"Reading time: {minutes} minute{'s' * (minutes > 1)}"
        title.parent.insert(1, nodes.paragraph("", text, classes=["reading-time"]))


def as_mathml(translator: Any, node: nodes.Element) -> None:
    """A formula in the text."""
    translator.body.append(tex2mathml(node.astext()))
    raise nodes.SkipNode


def as_mathml_block(translator: Any, node: nodes.Element) -> None:
    """A formula on a line of its own, with its number if it has one."""
    number = f'<span class="eqno">({node["number"]})</span>' if node.get("number") else ""
    formula = tex2mathml(node.astext(), as_block=True)
    anchor = node["ids"][0] if node.get("ids") else ""
    translator.body.append(f'<div class="math" id="{anchor}"><div>{formula}</div>{number}</div>')
    raise nodes.SkipNode


class Public(SphinxDirective):
    """``.. public:: PLACE``: all that the public face has from there, so that none is left out."""

    required_arguments = 1
    option_spec: ClassVar[OptionSpec] = {"inherited": directives.flag}  # with bases' members

    def run(self) -> list[nodes.Node]:
        """Describe each name by its docstring."""
        more = "\n   :inherited-members:" if "inherited" in self.options else ""
        found = {name: getattr(orchestrate, name) for name in orchestrate.__all__}
        place = f"orchestrate.{self.arguments[0]}"
        names = [name for name, what in found.items() if is_from(what, place)]
        text = "\n\n".join(f".. auto{kind_of(found[name])}:: {name}{more}" for name in names)
        return self.parse_text_to_nodes(f".. currentmodule:: orchestrate\n\n{text}\n")


def is_from(what: Any, place: str) -> bool:
    """Whether something public comes from a module or a package."""
    return f"{getattr(what, '__module__', '')}.".startswith(f"{place}.")


def kind_of(what: Any) -> str:
    """What autodoc calls it."""
    if not isinstance(what, type):
        return "function"
    return "exception" if issubclass(what, BaseException) else "class"


def add_explorer(app: Sphinx, failure: Exception | None) -> None:
    """The explorer as a page of the site."""
    if failure is None and app.builder.format == "html":
        from orchestrate.explorer.page import explore

        explore(output=Path(app.outdir) / "explore.html")


def add_empty_icon(app: Sphinx, page: str, template: str, context: dict[str, Any], _: Any) -> None:
    """Say that there is no icon: else browsers ask for a file that is not there."""
    context["metatags"] = context.get("metatags", "") + '<link rel="icon" href="data:,">'


def setup(app: Sphinx) -> None:
    """Tell Sphinx about the formulas, the public face and the reading time."""
    app.add_directive("public", Public)
    app.connect("doctree-read", add_reading_time)
    app.connect("html-page-context", add_empty_icon)
    app.connect("build-finished", add_explorer)
    app.add_html_math_renderer("mathml", (as_mathml, None), (as_mathml_block, None))
