"""Forge results with markup, and check in a browser that pages made of them run no script."""

from __future__ import annotations

import http.server
import json
import math
import random
import shutil
import tempfile
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from tools.chromium import start_chromium

CANARY = "window.canary = 1; document.title = 'canary'; alert(1)"
KEPT = ("start", "direction", "over")  # texts that have to be what they are, or there is no page
CALM = 0.15  # s that what has been started has for running
READY = "return Boolean(window.explorer)"


def payloads(address: str) -> list[str]:
    """Return hostile texts that run a script or request ``address`` if taken for markup."""
    beacon = f"fetch('{address}')"
    return [
        f"</script><script>{CANARY}</script>",
        f"<script>{CANARY}</script>",
        f'<img src=x onerror="{CANARY.replace(chr(34), chr(39))}">',
        f'<svg onload="{CANARY}"></svg>',
        f"--></style></title></textarea><script>{CANARY}</script>",
        f'" autofocus onfocus="{CANARY}',
        f"' onmouseover='{CANARY}' '",
        f'<iframe srcdoc="<script>parent.{CANARY}</script>"></iframe>',
        f'<iframe src="javascript:parent.{CANARY}"></iframe>',
        f'<script src="{address}"></script>',
        f"<script>{beacon}</script>",
        f'<img src="{address}">',
        f"<style>@import '{address}';</style>",
        f'<link rel=stylesheet href="{address}">',
        f'<meta http-equiv=refresh content="0;url={address}">',
        f'<base href="{address}">',
        f'<object data="{address}"></object>',
        f"<!--<script>{CANARY}",
        f"&lt;/script&gt;&lt;script&gt;{CANARY}&lt;/script&gt;",
        f"\\u003c/script\\u003e\\u003cscript\\u003e{CANARY}\\u003c/script\\u003e",
        f"{{{{ ''.__class__ }}}}{{% print 7 %}}<script>{CANARY}</script>",
        f"`${{{CANARY}}}`",
        f"\u2028{CANARY}\u2029\0<script>{CANARY}</script>",
        f"<scr<script>ipt>{CANARY}</scr</script>ipt>",
    ]


def write_forged_sweep(place: Path, chance: random.Random, good: Any, address: str) -> None:
    """Write a sweep's result in which some or all texts are markup."""
    bad = payloads(address)
    data = good.copy()
    texts = [str(name) for name, value in data.attrs.items() if isinstance(value, str)]
    texts = [name for name in texts if name not in KEPT]
    chosen = texts if chance.random() < 0.3 else chance.sample(texts, chance.randint(1, 4))
    data.attrs.update({name: pick_text(chance, bad) for name in chosen if name != "identity"})
    if "identity" in chosen:
        data.attrs["identity"] = json.dumps({"question": pick_text(chance, bad)})
    for array in data.variables.values():
        array.attrs.update({name: pick_text(chance, bad) for name in array.attrs})
    if chance.random() < 0.5:
        letters = (letter for letter in pick_text(chance, bad) if letter.isprintable())
        data.attrs["x" + "".join(letters).replace("/", "|").strip()[:200]] = "a name that is markup"
    data.to_netcdf(place, engine="netcdf4", encoding={name: {} for name in data.variables})


def write_wrong_number(place: Path, chance: random.Random) -> None:
    """Change an attribute or variable of a forged result to a senseless value."""
    import xarray as xr

    wrong = ("heavy", math.nan, math.inf, -1.0, 0.0, 1e308, 5e-324, [1.0, 2.0], "[nan, 0, 0, 0]")
    data = xr.load_dataset(place, engine="netcdf4")
    if chance.random() < 0.6:
        names = ("m1", "m2", "k1", "d2", "e", "gamma", "bonded", "transient", "samples")
        data.attrs[chance.choice((*names, "tolerance", "start", "direction"))] = chance.choice(
            wrong
        )
    else:
        name = chance.choice(("eta", "frequency", "amplitude", "end_state"))
        value = chance.choice(wrong[:7])
        data = data.assign({name: (data[name].dims, np.full(data[name].shape, value))})
    data.to_netcdf(place, engine="netcdf4", encoding={name: {} for name in data.variables})


def write_forged_branch(place: Path, chance: random.Random, good: Any, address: str) -> None:
    """Write a branch's result whose kinds of bifurcation are markup."""
    bad = payloads(address)
    data = good.copy()
    kinds = data.bifurcation_kind
    words = [pick_text(chance, bad).replace(" ", "\t") for _ in np.atleast_1d(kinds.flag_values)]
    kinds.attrs["flag_meanings"] = " ".join("\xa0".join(word.split()) for word in words)
    data.attrs.update({name: pick_text(chance, bad) for name in ("call", "source", "history")})
    data.to_netcdf(place, engine="netcdf4", encoding={name: {} for name in data.variables})


def pick_text(chance: random.Random, bad: Sequence[str]) -> str:
    """Return one of the hostile texts, alone or inside another text."""
    text = chance.choice(bad).replace("\0", "")
    return chance.choice((text, f"vibroimpact 0.2.0{text}", f"{text}{chance.choice(bad)[:80]}"))


class BrowserWindow:
    """Headless Chromium with a server that no page may request anything from."""

    def __init__(self, driver: Any, address: str, asked: list[str]) -> None:
        """Store the browser's driver and the record of requests."""
        self.driver, self.address, self.asked = driver, address, asked

    def check_page(self, page: Path, fragment: str = "") -> str:
        """Open a page; return what is wrong with it, empty if no script of the file ran."""
        from selenium.common.exceptions import WebDriverException
        from selenium.webdriver.support.ui import WebDriverWait

        self.asked.clear()
        try:
            self.driver.get("about:blank")
            self.driver.get(page.as_uri() + fragment)
            WebDriverWait(self.driver, 30.0, 0.02).until(lambda one: one.execute_script(READY))
            wait = "setTimeout(arguments[1], arguments[0])"
            self.driver.execute_async_script(wait, 1000.0 * CALM)
            canary = "return window.canary || document.title === 'canary'"
            ran = self.driver.execute_script(canary)
        except WebDriverException as error:  # a dialog of the canary, or a page that is broken
            return f"the browser: {(error.msg or type(error).__name__).splitlines()[0]}"
        if ran:
            return "a script of the file ran"
        return f"the page asked {self.asked[0]}" if self.asked else ""


@contextmanager
def open_browser() -> Iterator[BrowserWindow]:
    """Start Chromium and the server for a ``with`` block."""
    program, driver = shutil.which("chromium"), shutil.which("chromedriver")
    assert program and driver
    with (
        tempfile.TemporaryDirectory(prefix="vibroimpact-campaign-") as folder,
        run_server() as asked,
    ):
        browser = start_chromium(program, driver, Path(folder))
        try:
            yield BrowserWindow(browser, *asked)
        finally:
            browser.quit()


@contextmanager
def run_server() -> Iterator[tuple[str, list[str]]]:
    """Start a local server for a ``with`` block; yield its address and the requested paths."""
    asked: list[str] = []

    class Handler(http.server.BaseHTTPRequestHandler):
        """Handler that records each requested path and answers "no content"."""

        def do_GET(self) -> None:
            """Record the requested path and answer."""
            asked.append(self.path)
            self.send_response(204)
            self.end_headers()

        def log_message(self, format: str, *arguments: object) -> None:
            """Print no log messages."""
            pass

    listening = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=listening.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{listening.server_port}/canary", asked
    finally:
        listening.shutdown()
        listening.server_close()


def hostile_fragment(chance: random.Random, address: str) -> str:
    """Return a hostile text for the part of a link after its #."""
    from urllib.parse import quote

    text = quote(chance.choice(payloads(address)))
    name = chance.choice(("direction", "e", "eta", "from", "start", "m1"))
    return chance.choice(("", f"#{text}", f"#eta=1.05&{name}={text}"))


def delete_files(*paths: Path) -> None:
    """Delete the forged files of a trial."""
    for path in paths:
        path.unlink(missing_ok=True)
