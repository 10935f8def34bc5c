"""Firefox by WebDriver BiDi, which it speaks by itself (W3C draft): open a page, press keys, move, ask."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import Any

from websockets.sync.client import ClientConnection, connect

FIREFOX = shutil.which("firefox-esr") or shutil.which("firefox")


class Firefox:
    """One window of a headless Firefox; everything that it prints or asks the net for is gathered in ``troubles``."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket, self.numbers, self.troubles = socket, count(1), list[str]()
        self.own = ""
        self.call("session.new", capabilities={})
        self.window = self.call("browsingContext.getTree")["contexts"][0]["context"]
        self.call("session.subscribe", events=["log.entryAdded", "network.beforeRequestSent"])

    def call(self, method: str, **params: Any) -> Any:
        number = next(self.numbers)
        self.socket.send(json.dumps({"id": number, "method": method, "params": params}))
        while True:
            told = json.loads(self.socket.recv(timeout=120))
            if told.get("id") == number:
                assert told["type"] == "success", told
                return told["result"]
            self._note(told)

    def _note(self, told: dict[str, Any]) -> None:
        if told.get("method") == "log.entryAdded":
            self.troubles.append(told["params"]["text"])
        elif told.get("method") == "network.beforeRequestSent":
            url = told["params"]["request"]["url"]
            if url != self.own and not url.startswith(("data:", "blob:", "about:")):
                self.troubles.append(url)

    def open(self, page: Path, width: int, height: int) -> None:
        self.own = page.resolve().as_uri()
        self.call("browsingContext.setViewport", context=self.window, viewport={"width": width, "height": height})
        self.call("browsingContext.navigate", context=self.window, url=self.own, wait="complete")

    def evaluate(self, expression: str) -> Any:
        """What an expression (or a promise) comes to, by way of JSON."""
        told = self.call("script.evaluate", expression=f"Promise.resolve({expression}).then(JSON.stringify)",
                         target={"context": self.window}, awaitPromise=True)  # fmt: skip
        assert told["type"] == "success", told
        return json.loads(told["result"].get("value", "null"))

    def keys(self, *keys: str) -> None:
        presses = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
        self.call("input.performActions", context=self.window,
                  actions=[{"type": "key", "id": "keyboard", "actions": presses}])  # fmt: skip

    def drag(self, begin: tuple[float, float], end: tuple[float, float]) -> None:
        def move(place: tuple[float, float]) -> dict[str, Any]:
            return {"type": "pointerMove", "x": round(place[0]), "y": round(place[1]), "duration": 50}

        middle = (begin[0] + end[0]) / 2, (begin[1] + end[1]) / 2
        down, up = ({"type": kind, "button": 0} for kind in ("pointerDown", "pointerUp"))
        steps = [move(begin), down, move(middle), move(end), up]
        pointer = {"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": steps}
        self.call("input.performActions", context=self.window, actions=[pointer])


@contextmanager
def firefox() -> Iterator[Firefox]:
    """A browser of its own, with a profile that is thrown away."""
    assert FIREFOX is not None
    with tempfile.TemporaryDirectory() as profile:
        command = [FIREFOX, "--headless", "--no-remote", "--profile", profile, "--remote-debugging-port", "0"]
        begun = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True,
                                 env={"HOME": profile, "PATH": "/usr/bin:/bin"})  # fmt: skip
        try:
            assert begun.stderr is not None
            told = (re.search(r"ws://[\d.:]+", line) for line in begun.stderr)
            address = next(found[0] for found in told if found)
            with connect(f"{address}/session", max_size=None, open_timeout=60) as socket:
                yield Firefox(socket)
        finally:
            begun.terminate()
            begun.wait(30)
            begun.stderr.close()  # type: ignore[union-attr]
