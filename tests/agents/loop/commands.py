"""``simworlds`` as a process of its own, with small pictures."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import signal

HERE = Path(__file__).resolve().parent
REPO = HERE.parent.parent.parent
PATH = os.pathsep.join(map(str, (REPO, HERE, HERE.parent, HERE.parent.parent)))
_SECONDS = 240.0
# What begins a run starts the server of its documentation itself.
_MAIN = """\
import sys
import pytest
from run_sessions import make_small, share_docs_of
from simworlds.cli import main
from simworlds.settings import home_folder

with pytest.MonkeyPatch.context() as patch:
    make_small(patch)
    if sys.argv[1] == "resume":
        share_docs_of(patch, home_folder())
    main(prog_name="simworlds")
"""


SIMWORLDS = [sys.executable, "-c", _MAIN]
"""Needs PATH as PYTHONPATH."""


class Command:
    """Started when it is made."""

    def __init__(self, home: Path, *words: object, url: str = "") -> None:
        given = {"SIMWORLDS_HOME": str(home), "PYTHONPATH": PATH, "COLUMNS": "120"}
        if url:
            given |= {"ANTHROPIC_API_KEY": "any", "ANTHROPIC_BASE_URL": url}
        kept = {name: value for name, value in os.environ.items() if not name.startswith("ANTHROPIC_")}
        self.process = subprocess.Popen(
            [*SIMWORLDS, *map(str, words)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=kept | given,
            text=True,
        )
        self._errors: list[str] = []
        self._heard = threading.Condition()
        self._listener = threading.Thread(target=self._listen)
        self._listener.start()

    def _listen(self) -> None:
        assert self.process.stderr is not None
        for line in self.process.stderr:
            with self._heard:
                self._errors.append(line)
                self._heard.notify_all()

    def send(self, number: signal.Signals) -> None:
        self.process.send_signal(number)

    def kill(self) -> None:
        """Ends it, unless it has ended."""
        self.process.kill()
        self.process.wait()
        self._listener.join()
        for pipe in (self.process.stdout, self.process.stderr):
            assert pipe is not None
            pipe.close()

    def until(self, said: str) -> None:
        """Waits until it has said these words on stderr."""
        with self._heard:
            assert self._heard.wait_for(lambda: said in "".join(self._errors), _SECONDS), self._errors

    def end(self) -> tuple[int, str, str]:
        """(exit code, stdout, stderr)."""
        assert self.process.stdout is not None
        assert self.process.stderr is not None
        with self.process.stdout as stdout, self.process.stderr:
            out = stdout.read()
            code = self.process.wait(_SECONDS)
            self._listener.join(_SECONDS)
        return code, out, "".join(self._errors)
