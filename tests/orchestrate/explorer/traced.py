"""A page whose main thread is traced: its tasks by the time of the processor that they took."""

import itertools
import json
import subprocess
import time

from tools.chromium import WORDS

from .firefox import address

CATEGORIES = ("toplevel", "blink.user_timing")
TASK = "ThreadControllerImpl::RunTask"


class Traced:
    """Headless Chromium by its own protocol: WebDriver has no traces."""

    def __init__(self, program, profile):
        from websocket import create_connection

        words = (*WORDS, "autoplay-policy=no-user-gesture-required", "window-size=1440,900")
        more = ("remote-debugging-port=0", "remote-allow-origins=*", f"user-data-dir={profile}")
        command = [program, *(f"--{word}" for word in (*words, *more)), "about:blank"]
        told = profile.with_suffix(".stderr")
        with told.open("w") as file:
            self.process = subprocess.Popen(command, stderr=file, text=True)
        self.socket = create_connection(address(told), timeout=120, skip_utf8_validation=True)
        self.numbers, self.events = itertools.count(1), []
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self.session = {
            "sessionId": self.ask("Target.attachToTarget", targetId=target, flatten=True)[
                "sessionId"
            ]
        }

    def ask(self, method, session=None, **parameters):
        """A command's result."""
        number = next(self.numbers)
        asked = {"id": number, "method": method, "params": parameters, **(session or {})}
        self.socket.send(json.dumps(asked))
        while (told := self.receive()).get("id") != number:
            pass
        return told["result"]

    def receive(self):
        told = json.loads(self.socket.recv())
        if told.get("method") == "Tracing.dataCollected":
            self.events += told["params"]["value"]
        return told

    def run(self, expression):
        asked = {"expression": expression, "returnByValue": True}
        return self.ask("Runtime.evaluate", self.session, **asked)["result"].get("value")

    def until(self, expression, seconds=120):
        end = time.monotonic() + seconds
        while not self.run(f"Boolean({expression})"):
            assert time.monotonic() < end, f"never: {expression}"
            time.sleep(0.05)

    def start(self, url):
        """Open a page, traced from its first task on."""
        config = {"includedCategories": list(CATEGORIES)}
        self.ask("Tracing.start", transferMode="ReportEvents", traceConfig=config)
        self.ask("Page.navigate", self.session, url=url)

    def do(self, name, script, until):
        """What is done under a name, and what the page draws for it."""
        self.run(f"performance.mark('do {name}'); {script}")
        self.until(until)
        time.sleep(0.3)

    def longest(self):
        """The longest task that began after each thing that was done, ms of the processor."""
        self.ask("Tracing.end")
        while self.receive().get("method") != "Tracing.tracingComplete":
            pass
        marks = [event for event in self.events if event["name"].startswith("do ")]
        thread = (marks[0]["pid"], marks[0]["tid"])
        tasks = [
            (event["ts"], event["tdur"] / 1e3)
            for event in self.events
            if (event["pid"], event["tid"]) == thread and event["name"] == TASK and "tdur" in event
        ]
        starts = [0, *(mark["ts"] for mark in marks)]
        names = ["opening", *(mark["name"][3:] for mark in marks)]
        return {
            name: max(took for begun, took in tasks if first <= begun < last)
            for name, first, last in zip(names, starts, [*starts[1:], float("inf")], strict=True)
        }

    def quit(self):
        self.socket.close()
        self.process.terminate()
        self.process.wait(30)
