"""Build manual and explorer as one static site, and check its links.

``python -m tools.site site/html`` builds it and checks it: no page may point to what is not there,
nor take a script, a style, a font or a picture from another host. Serve the folder by any web
server, such as ``python -m http.server --directory site/html``, or open its ``index.html``; the
explorer is ``explore.html``, one file that can be mailed by itself. Without a server the search
shows only titles: browsers do not let a page read its neighbours.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from dataclasses import dataclass, field
from functools import cached_property
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag, urlsplit

DOCS = Path(__file__).resolve().parents[1] / "docs"
RESOURCE_ATTRIBUTES = {
    **dict.fromkeys(("script", "img", "iframe", "source"), "src"),
    "link": "href",
}


@dataclass
class Page(HTMLParser):
    """HTML parser that collects a page's links, resources and anchors."""

    path: Path
    links: list[str] = field(default_factory=list)
    resources: list[str] = field(default_factory=list)
    anchors: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        super().__init__()
        self.feed(self.path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        self.anchors |= {values[name] for name in ("id", "name") if name in values}
        if tag == "a" and "href" in values:
            self.links.append(values["href"])
        elif RESOURCE_ATTRIBUTES.get(tag) in values and values.get("rel") != "canonical":
            self.resources.append(values[RESOURCE_ATTRIBUTES[tag]])


@dataclass
class Site:
    """A folder of HTML pages."""

    folder: Path

    @cached_property
    def pages(self) -> dict[Path, Page]:
        return {path: Page(path) for path in sorted(self.folder.resolve().rglob("*.html"))}

    def external_resources(self) -> list[str]:
        every = [(path, address) for path, page in self.pages.items() for address in page.resources]
        begins = ("http:", "https:", "//")
        return [f"{path.name}: {one}" for path, one in every if one.lower().startswith(begins)]

    def broken_links(self) -> list[str]:
        each = ((p, (*page.links, *page.resources)) for p, page in self.pages.items())
        every = ((p, one) for p, addresses in each for one in addresses)
        return [f"{p.name}: {one}" for p, one in every if not self.target_exists(p, one)]

    def target_exists(self, path: Path, address: str) -> bool:
        if urlsplit(address).scheme or address.startswith("//"):
            return True
        file, anchor = urldefrag(address)
        target = (path.parent / unquote(urlsplit(file).path)).resolve() if file else path
        if target not in self.pages:
            return target.is_file()
        is_free = not anchor or target.name == "explore.html"
        return is_free or unquote(anchor) in self.pages[target].anchors


def build_site(folder: Path) -> None:
    kept = folder.parent / "doctrees"  # what Sphinx remembers, which nobody is to be served
    options = ["-q", "-W", "-n", "--keep-going", "-d", kept]
    command = [sys.executable, "-m", "sphinx", *options, DOCS, folder]
    subprocess.run(list(map(str, command)), check=True)
    (folder / ".nojekyll").touch()  # or GitHub's pages would leave _static out


def main() -> None:
    parser = argparse.ArgumentParser(description="Build manual and explorer as one static site.")
    parser.add_argument("folder", nargs="?", type=Path, default=Path("site/html"))
    folder = parser.parse_args().folder
    begin = time.monotonic()
    site = Site(folder)
    build_site(site.folder)
    wrong = [*site.broken_links(), *site.external_resources()]
    if wrong:
        raise SystemExit("\n".join(["not to be found, or from other hosts:", *wrong]))
    files = [path for path in site.folder.rglob("*") if path.is_file()]
    size = sum(path.stat().st_size for path in files) / 1e6
    print(f"{folder}: {len(site.pages)} pages, {size:.1f} MB, {time.monotonic() - begin:.0f} s")


if __name__ == "__main__":
    main()
