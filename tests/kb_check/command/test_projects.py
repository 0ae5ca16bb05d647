"""Many files, shared among processes."""

from __future__ import annotations

import json
import subprocess
import sys

from places import REPO

# In a process of its own: it forks, and one of its children is killed.
SCRIPT = """
import json, os, signal
from pathlib import Path
from kb_check.command import project

def check_all(base, groups, numbers):
    for number in numbers:
        if groups[number][0].name == "bad.py":
            os.kill(os.getpid(), signal.SIGKILL)
        yield number, [[]], ""

project._check_all = check_all
names = ["a.py", "bad.py", "c.py", "d.py", "e.py"]
groups = [(project.LoadedFile(name, b"#" * 200_000),) for name in names]
results = project.Project(Path("none"), "", None, jobs=2).check(groups)
print(json.dumps({name: result.failure for name, result in zip(names, results)}))
"""


def test_a_process_that_is_ended_costs_one_group() -> None:
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], cwd=REPO, capture_output=True, text=True, check=True
    )
    failures = json.loads(done.stdout)
    assert failures.pop("bad.py") == "the process that checked it was ended"
    assert set(failures.values()) == {""}
