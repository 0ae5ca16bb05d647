"""Calls that cost Blender its life, or try to: each is answered in time and in words, and the next one works."""

from __future__ import annotations

import asyncio
import contextlib
import os
import re
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from live_session import LiveSession, no_docs
from places import REPO
from processes import becomes, has_ended, of_run
from sandboxes import skip_unless_it_works
from whole import IS_WHOLE

from agents.blender.blender_sessions import BlenderSession, SessionSetup
from agents.blender.files.run_folder import RunFolder
from agents.blender.launch import make_launch
from agents.blender.supervisor import Supervisor
from agents.blender.tools.base import Call, Knowledge
from agents.blender.tools.execute import TOOL
from agents.blender.tools.motion_sheet import TOOL as MOTION_SHEET
from agents.blender.tools.previews import SCENE_LAYOUT
from simworlds.sandbox.errors import CannotStart, Died, Interrupted, LeftBehind, Lost, Refusal, TookTooLong
from simworlds.sandbox.hostile_ground import HostileGround
from simworlds.sandbox.launch import HALF_WRITTEN, PRIVATE
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.blender

WHOLE = pytest.mark.whole  # tests/attacks ends Blender in these ways, too
DEBIANS = Path("/usr/bin/blender")
NAMES = "sorted(o.name for o in bpy.data.objects)"
RESTARTED = (
    r"A new Blender was started from checkpoint \d+ \([^\n]*, \d\d:\d\d:\d\d\), "
    r"which is the scene as it was before\."
)


def adding(name: str) -> str:
    return f"bpy.context.collection.objects.link(bpy.data.objects.new({name!r}, None))"


@pytest.fixture(scope="module")
def _hardy(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LiveSession]:
    session = LiveSession(tmp_path_factory.mktemp("hardy") / "run")
    yield session
    session.blender.close()


@pytest.fixture
def hardy(_hardy: LiveSession) -> LiveSession:
    """A Blender with one object, which is kept; shared by tests that end it."""
    _hardy.empty()
    _hardy.run(adding("Kept"))
    _hardy.blender.keep("an object")
    return _hardy


def lost(session: LiveSession, code: str, timeout: float = 20.0) -> Lost:
    """The error of code that Blender does not survive; nothing of the scene may be lost by it."""
    with pytest.raises(Lost) as caught:
        session.use(TOOL, code=f"{adding('Undone')}\n{code}", timeout=timeout)
    assert re.search(RESTARTED, str(caught.value)), str(caught.value)
    assert session.run(NAMES) == ["Kept"]
    return caught.value


# Code that ends Blender


@pytest.mark.parametrize(
    ("code", "told"),
    [
        ("import ctypes; ctypes.string_at(0)", r"it crashed \(SIGSEGV\)"),
        pytest.param("import os; os.abort()", r"it crashed \(SIGABRT\)", marks=WHOLE),
        pytest.param(
            "import os; os.kill(os.getpid(), 9)",
            r"it was killed \(SIGKILL\), by the system because memory ran out",
            marks=WHOLE,
        ),
        pytest.param("import os; os._exit(3)", "it was ended from inside, with exit code 3", marks=WHOLE),
        ("import os; os._exit(0)", "exit code 0, as after bpy.ops.wm.quit_blender or os._exit"),
        ("import os; os.closerange(3, 65536)", "its channel was closed from inside"),
    ],
)
def test_undoes_code_that_ends_blender(hardy: LiveSession, code: str, told: str) -> None:
    error = lost(hardy, code)
    assert isinstance(error, Died)
    assert re.search(
        rf"^Blender ended \d+\.\d s into the code '{re.escape(adding('Undone')[:40])} …': .*{told}",
        str(error),
    )


def test_quitting_blender_loses_at_most_the_call(hardy: LiveSession) -> None:
    with contextlib.suppress(Died):
        hardy.use(TOOL, code="bpy.ops.wm.quit_blender()")
    assert hardy.run(NAMES) == ["Kept"]


@pytest.mark.parametrize(
    ("code", "told"),
    [
        pytest.param(
            "import threading, time\nthreading.Thread(target=time.sleep, args=(600,)).start()",
            "1 thread of its own",
            marks=WHOLE,
        ),
        (
            "import _thread\ndef on():\n    while True: pass\nfor _ in range(3): _thread.start_new_thread(on, ())",
            "3 threads of its own",
        ),
        ("import sys\nsys.addaudithook(lambda *_: None)", "an audit hook, which Python cannot remove"),
        pytest.param(
            "import sys\ndef hook(*_): raise ValueError('spoilt')\nsys.addaudithook(hook)",
            "spoilt",
            marks=WHOLE,
        ),
    ],
)
def test_stops_blender_when_code_leaves_threads_or_hooks(hardy: LiveSession, code: str, told: str) -> None:
    error = lost(hardy, code)
    assert isinstance(error, LeftBehind)
    assert told in str(error)


def test_allows_threads_that_end_with_their_call(hardy: LiveSession) -> None:
    code = "import threading\nt = threading.Thread(target=print, args=('from a thread',))\nt.start()"
    assert hardy.use(TOOL, code=code).data["stdout"] == "from a thread\n"


@pytest.mark.parametrize(
    "code",
    [
        "import os; os.close(0); os.close(1); os.close(2)",
        "import os; os.closerange(0, 3); os.open('/dev/null', 0)",
        "import sys; sys.stdout.close(); sys.stderr.close()",
        "import sys; sys.exit(3)",
        "raise SystemExit",
        "raise KeyboardInterrupt",
        "import signal; signal.raise_signal(signal.SIGINT)",
        "import signal; signal.setitimer(signal.ITIMER_REAL, 0.01, 0.01)",
        "import signal; signal.signal(14, lambda *_: 1 / 0); signal.setitimer(signal.ITIMER_REAL, 0.001, 0.001)",
        "import signal; signal.setitimer(signal.ITIMER_PROF, 0.001)",
        "import faulthandler; faulthandler.dump_traceback_later(0.2, exit=True)",
        "import sys; sys.modules.clear()",
        "bpy.ops = bpy.context = bpy.data = bpy.types = None",
        "import json, os, time; json.dumps = json.loads = os.write = os.read = time.perf_counter = None",
        "import sys; sys.setprofile(lambda *_: 1 / 0)",
        "import sys; sys.meta_path.clear(); sys.path_hooks = []",
        "import sys, types; sys.modules['simworlds_worker.changes'] = types.ModuleType('changes')",
        "import warnings; warnings.simplefilter('error')",
        "import numpy; numpy.seterr(all='raise')",
        "import locale; locale.setlocale(locale.LC_ALL, '')",
        "import os; os.umask(0o777)",
    ],
)
def test_blender_survives(hardy: LiveSession, code: str) -> None:
    """The same process goes on, and what it is asked next works as ever."""
    blender = hardy.blender.inner_pid
    hardy.use(TOOL, code=code)
    found = hardy.use(
        TOOL,
        code="import json, os, numpy, warnings\nwarnings.warn('w')\n"
        "print(json.dumps(numpy.float64(1) / numpy.zeros(1)[0]))\n"
        "open('written', 'w').write(str(1.5))\nopen('written').read()",
    )
    assert (found.data["error"], found.data["stdout"], found.data["value"]) == (None, "Infinity\n", "'1.5'")
    assert hardy.blender.keep("afterwards").path.stat().st_size > 1000
    assert hardy.blender.inner_pid == blender


# Deadlines


@pytest.mark.parametrize(
    "code",
    [
        pytest.param("while True: pass", marks=WHOLE),
        pytest.param("import time; time.sleep(600)", marks=WHOLE),
        pytest.param("sum(range(10**13))", marks=WHOLE),
        "scene = bpy.context.scene\nscene.render.engine = 'CYCLES'\nscene.cycles.samples = 10**7\n"
        "scene.render.resolution_x = scene.render.resolution_y = 64\n"
        "scene.camera = bpy.data.objects.new('C', bpy.data.cameras.new('C'))\n"
        "scene.collection.objects.link(scene.camera)\nscene.cycles.use_adaptive_sampling = False\n"
        "bpy.ops.render.render()",
        pytest.param(
            "while True:\n    try:\n        while True: pass\n    except BaseException: pass", marks=WHOLE
        ),
        pytest.param("while True: print('x' * 10000)", marks=WHOLE),
        "import signal\nfor n in (1, 2, 3, 10, 12, 14, 15): signal.signal(n, signal.SIG_IGN)\nwhile True: pass",
    ],
    ids=["python", "sleep", "c", "render", "catches all", "output", "ignores signals"],
)
def test_keeps_the_deadline_whatever_runs(hardy: LiveSession, code: str) -> None:
    error = lost(hardy, code, timeout=0.7)
    assert isinstance(error, TookTooLong)
    assert "ran past its deadline of 0.7 s, and Blender was stopped. A new Blender was started from" in str(
        error
    )
    assert len(error.printed) <= 2000


def test_describes_a_lost_blender_in_full_sentences(hardy: LiveSession) -> None:
    hardy.run("tower = 1")
    hardy.blender.keep("a tower")
    with pytest.raises(TookTooLong) as caught:
        hardy.use(TOOL, code="while True: pass", timeout=0.3)
    kept = hardy.blender.checkpoints.last
    assert kept is not None
    assert str(caught.value) == (
        "The code 'while True: pass' ran past its deadline of 0.3 s, and Blender was stopped. A new Blender was "
        f"started from {kept}, which is the scene as it was before."
    )


def test_undoes_a_crash_with_on_error_restore(hardy: LiveSession) -> None:
    hardy.blender.checkpoints.changed(0.0)
    with pytest.raises(Died):
        hardy.use(TOOL, code=f"{adding('Half')}\nimport os\nos.abort()", on_error="restore")
    assert hardy.run(NAMES) == ["Kept"]


def test_stops_a_cancelled_call(hardy: LiveSession) -> None:
    call = Call()
    threading.Timer(0.2, call.cancelled.set).start()
    with pytest.raises(Interrupted, match=r"was cancelled after \d\.\d s, and Blender was stopped"):
        hardy.use(TOOL, call, code="while True: pass", timeout=100)
    assert hardy.run(NAMES) == ["Kept"]


def test_ctrl_c_ends_the_call_but_not_the_run(hardy: LiveSession) -> None:
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        hardy.use(TOOL, code="while True: pass", timeout=100)
    assert hardy.run(NAMES) == ["Kept"]


def test_refuses_too_large_arguments_before_sending(hardy: LiveSession) -> None:
    blender = hardy.blender.inner_pid
    with pytest.raises(Refusal, match=r"arguments of execute are too large: .*the limit is"):
        hardy.blender.call("execute", {"code": "#" * (17 << 20)}, unread, timeout=20)
    assert hardy.blender.inner_pid == blender


SMALL_ANSWERS = """
import gc
from simworlds.sandbox.inside.channel import Encoder
next(item for item in gc.get_objects() if isinstance(item, Encoder))._largest = 1000
"""


def test_refuses_a_too_large_reply(hardy: LiveSession) -> None:
    with pytest.raises(Refusal, match=r"The reply cannot be sent: .*the limit is"):
        hardy.use(TOOL, code=f"{SMALL_ANSWERS}\n'x' * 3000")
    hardy.blender.kill()  # what it may answer stays as small


# Between calls


@pytest.mark.parametrize("which", ["outer", pytest.param("inner", marks=WHOLE)])
def test_restarts_a_blender_that_ended_between_calls(hardy: LiveSession, which: str) -> None:
    number = hardy.blender.pid if which == "outer" else hardy.blender.inner_pid
    assert number is not None
    inner_pid = hardy.blender.inner_pid
    os.kill(number, signal.SIGKILL)
    assert becomes(lambda: has_ended(inner_pid))
    found = hardy.use(TOOL, code=NAMES)
    assert found.data["value"] == "['Kept']"
    assert re.search(RESTARTED, found.text), found.text


def test_reports_changes_lost_between_calls(hardy: LiveSession) -> None:
    """A scene that is slow to write is not written after every call."""
    hardy.blender.checkpoints.changed(0.0)
    hardy.blender.checkpoints.changed(0.0)
    hardy.blender.kill()
    found = hardy.use(TOOL, code="1")
    assert "Blender had ended" in found.text
    assert "the changes of the last 2 calls before it are lost too" in found.text
    assert "lost" not in hardy.use(TOOL, code="1").text


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere nothing is stopped")
def test_blender_stands_still_between_calls(hardy: LiveSession) -> None:
    hardy.run("1")
    tasks = Path(f"/proc/{hardy.blender.inner_pid}/task")
    assert becomes(lambda: {(task / "stat").read_text().split()[2] for task in tasks.iterdir()} == {"T"})
    assert hardy.run("1 + 1") == 2


@WHOLE
@pytest.mark.skipif(sys.platform != "linux", reason="threads are counted by /proc")
def test_a_thread_that_python_does_not_know_of_is_found(hardy: LiveSession) -> None:
    code = (
        "import ctypes\nlibc = ctypes.CDLL(None)\n"
        "libc.pthread_create(ctypes.byref(ctypes.c_ulong()), None, libc.pause, 0)"
    )
    with pytest.raises(LeftBehind, match="1 thread of its own still running"):
        hardy.use(TOOL, code=code)
    assert hardy.run(NAMES) == ["Kept"]


@pytest.mark.parametrize(
    "change",
    [
        "from simworlds_worker import execute\nexecute._run.__code__ = (lambda code: 'forged').__code__",
        "from simworlds_worker import execute\nexecute._run = lambda code: 'forged'",
        "from simworlds_worker import execute\nexecute.execute.__defaults__ = (None,)",
        "import json\njson.dumps.__code__ = (lambda *_, **__: '{}').__code__",
        "import json\njson.JSONEncoder.encode.__code__ = (lambda *_: '{}').__code__",
    ],
    ids=["what a function does", "a name", "defaults", "a module's function", "a method"],
)
def test_what_code_changes_in_the_tools_is_restored(hardy: LiveSession, change: str) -> None:
    hardy.use(TOOL, code=change)
    assert hardy.run("1 + 1") == 2
    assert "restarted" not in hardy.use(TOOL, code="1").text


def test_blender_outlives_the_thread_that_started_it(hardy: LiveSession) -> None:
    blender = hardy.blender
    first = blender.inner_pid
    starter = threading.Thread(target=lambda: (blender.kill(), hardy.run("1")))
    starter.start()
    starter.join()
    second = blender.inner_pid
    assert second != first
    assert hardy.run("1 + 1") == 2
    assert blender.inner_pid == second


def test_answers_calls_of_many_threads(hardy: LiveSession) -> None:
    answers: dict[int, object] = {}

    def ask(number: int) -> None:
        reply = hardy.blender.call("execute", {"code": f"print({number})\n{number} ** 2"}, unread, timeout=60)
        answers[number] = (reply.value["value"], reply.stdout)

    threads = [threading.Thread(target=ask, args=(number,)) for number in range(12)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert answers == {number: (str(number**2), f"{number}\n") for number in range(12)}


def test_two_runs_are_independent(hardy: LiveSession, own_session: LiveSession) -> None:
    one, two = hardy, own_session
    two.run(adding("Two"))
    one.blender.kill()
    assert (one.run(NAMES), two.run(NAMES)) == (["Kept"], ["Two"])
    outside = two.use(TOOL, code=f"open({str(one.blender.folder.workspace.mount / 'scene.blend')!r})")
    assert outside.data["error"]["type"] in {"PermissionError", "FileNotFoundError"}


# Starting and ending


@pytest.mark.usefixtures("hardy")  # what a first Blender opens for good is open
def test_closing_leaves_no_process_and_no_private_folder_and_the_run_goes_on_where_it_was_left(
    tmp_path: Path,
) -> None:
    def open_files() -> int:
        return len(list(Path("/proc/self/fd").iterdir()))

    before = open_files()
    session = LiveSession(tmp_path / "run")
    session.run("open(bpy.app.tempdir + 'left', 'w').write('x')")
    session.run(adding("Kept"))
    session.blender.call("execute", {"code": adding("Not yet written")}, unread, timeout=20)
    session.blender.checkpoints.changed(0.0)
    assert of_run(tmp_path / "run")
    session.blender.close()
    session.blender.close()
    assert of_run(tmp_path / "run") == []
    assert open_files() == before
    assert sorted(path.name for path in (tmp_path / "run").iterdir()) == [".lock", "checkpoints", "workspace"]
    with pytest.raises(CannotStart, match="ended"):
        session.run("1")
    again = LiveSession(tmp_path / "run")
    with again.blender:
        assert again.run(NAMES) == ["Kept", "Not yet written"]


def test_refuses_a_second_supervisor_for_a_run(hardy: LiveSession) -> None:
    folder = hardy.blender.folder
    with pytest.raises(Refusal, match="in use by another"):
        Supervisor(make_launch(folder.workspace), folder)


def test_a_session_that_is_refused_a_run_takes_nothing_from_the_one_that_has_it(hardy: LiveSession) -> None:
    hardy.blender.take_note()  # of the tests before
    folder = hardy.blender.folder
    (folder.root / PRIVATE / "temporary").touch()
    half = folder.root / "workspace" / f"tower{HALF_WRITTEN}"
    half.touch()
    other = BlenderSession(SessionSetup(hardy.blender.launch.sandbox, run=folder.root))
    with pytest.raises(Refusal, match="in use by another"):
        asyncio.run(other.use(TOOL, {"code": "1"}, Call(), lambda _version: Knowledge(no_docs)))
    other.close()
    assert (folder.root / PRIVATE / "temporary").exists()
    assert half.exists()
    half.unlink()
    hardy.run("bpy.context.scene['goes on'] = True")
    assert hardy.blender.take_note() == ""
    assert hardy.blender.checkpoints.unkept == 0


def test_rejects_a_wrong_executable_before_starting_it(tmp_path: Path) -> None:
    for path, told in (
        (Path("/bin/true"), "is not Blender"),
        (tmp_path, "no Blender executable"),
    ):
        with pytest.raises(CannotStart, match=told):
            make_launch(HostileGround(tmp_path / "run" / "workspace"), blender_exe=path)


def test_reports_why_blender_does_not_start(tmp_path: Path) -> None:
    fake = tmp_path / "fake" / "blender"
    fake.parent.mkdir()
    fake.write_text(
        '#!/bin/sh\n[ "$1" = --version ] && echo "Blender 5.9.9" && exit\necho "no libX.so" >&2\nexit 7\n'
    )
    fake.chmod(0o755)
    with pytest.raises(CannotStart, match=r"(?s)did not start.*exit code 7.*no libX\.so"):
        LiveSession(tmp_path / "run", blender_exe=fake)
    assert of_run(tmp_path / "run") == []


def test_starts_no_blender_while_ending(own_session: LiveSession) -> None:
    own_session.blender.end()
    with pytest.raises(TookTooLong, match="A new Blender could not be started: this session is being ended"):
        own_session.use(TOOL, code="while True: pass", timeout=0.2)


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere it ends when it next looks at its channel")
@pytest.mark.parametrize("kind", ["bubblewrap", "landlock", pytest.param("none", marks=WHOLE)])
def test_blender_ends_with_its_supervisor_whatever_it_is_doing(tmp_path: Path, kind: str) -> None:
    if kind != "none":
        skip_unless_it_works(kind)
    script = f"""
import sys
sys.path[:0] = [{str(REPO / "tests" / "agents")!r}, {str(REPO / "tests")!r}]
from pathlib import Path
from live_session import LiveSession
from sandboxes import sandbox_of
from simworlds.sandbox.replies import unread
session = LiveSession(Path({str(tmp_path / "run")!r}), sandbox=sandbox_of({kind!r}))
print("ready", flush=True)
session.blender.call("execute", {{"code": "open('begun', 'w').close()\\nsum(range(10**13))"}}, unread, timeout=600)
"""
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        assert becomes((tmp_path / "run" / "workspace" / "begun").exists)
        assert len(of_run(tmp_path / "run")) >= 1
    finally:
        process.kill()
        process.communicate()
    assert becomes(lambda: of_run(tmp_path / "run") == [])
    folder = RunFolder.make(tmp_path / "run")
    Supervisor(make_launch(folder.workspace), folder).close()  # nothing holds the run's folder


# A disk that is nearly full

_TINY_DISK = """
import sys
sys.path[:0] = [{tests!r}]
from pathlib import Path
from live_session import LiveSession
from simworlds.sandbox.confinement.confined_command import best_sandbox
from simworlds.sandbox.errors import LimitExceeded
from agents.blender.tools.execute import TOOL
from agents.blender.tools.motion_sheet import TOOL as MOTION_SHEET
from agents.blender.tools.previews import SCENE_LAYOUT
session = LiveSession(Path({place!r}) / "run", sandbox=best_sandbox("landlock", without=frozenset({{"uid"}})))
try:
    session.use(TOOL, code=(
        "import os, time\\nfile = os.open('hidden', os.O_CREAT | os.O_RDWR)\\nos.unlink('hidden')\\n"
        "while True: os.write(file, bytes(1 << 20)); time.sleep(0.02)"), timeout=60)
except LimitExceeded as error:
    print(error)
print(session.run("time = __import__('time'); time.sleep(0.6); 1 + 1"))
session.blender.close()
"""


def test_stops_before_the_disk_is_full(tmp_path: Path) -> None:
    """Also what is written to a file without a name, which no list of files shows, is written to the disk."""
    skip_unless_it_works("landlock")
    place = tmp_path / "disk"
    place.mkdir()
    mount = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c"]
    probe = [*mount, f"mount -t tmpfs -o size=1m tmpfs {place}"]
    if subprocess.run(probe, capture_output=True, check=False).returncode:
        pytest.skip("a disk of the test's own cannot be mounted here")
    script = _TINY_DISK.format(tests=str(REPO / "tests" / "agents"), place=str(place))
    words = [*mount, f'mount -t tmpfs -o size=64m tmpfs {place} && exec "$0" -c "$1"', sys.executable, script]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120, check=False)
    assert re.search(r"left \d+ MB free on the disk; \d+ MB must stay free", done.stdout), (
        done.stdout + done.stderr
    )
    assert done.stdout.splitlines()[-1] == "2"


# A Blender that is a program of its own


@pytest.fixture(scope="module")
def debians(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LiveSession]:
    if not DEBIANS.exists():
        pytest.skip(f"there is no {DEBIANS}")
    session = LiveSession(tmp_path_factory.mktemp("debian") / "run", blender_exe=DEBIANS)
    yield session
    session.blender.close()


def test_an_installed_blender_works_the_same_way(debians: LiveSession) -> None:
    assert debians.run("bpy.app.background, bpy.app.version >= (2, 83)") == (True, True)
    found = debians.use(TOOL, code="print('heard')\nbpy.ops.mesh.primitive_cube_add()\nlen(bpy.data.objects)")
    assert (found.data["stdout"], found.data["value"]) == ("heard\n", "1")
    assert found.data["changed"]["objects"] == {"added": ["Cube"]}
    failed = debians.use(TOOL, code="bpy.data.objects['Nobody']")
    assert failed.data["error"]["type"] == "KeyError"
    ends: list[tuple[str, type[Lost]]] = [
        ("import os; os.abort()", Died),
        ("while True: pass", TookTooLong),
        ("import threading, time; threading.Thread(target=time.sleep, args=(600,)).start()", LeftBehind),
    ]
    for code, error in ends if IS_WHOLE else ends[-1:]:
        with pytest.raises(error, match=r"started from checkpoint \d+ .*as it was before"):
            debians.use(
                TOOL,
                code=f"bpy.ops.mesh.primitive_cube_add()\n{code}",
                timeout=0.5 if error is TookTooLong else 10,
            )
        assert debians.run(NAMES) == ["Cube"]


def test_previews_work_without_numpy_and_name_missing_modules(
    debians: LiveSession,
) -> None:
    if debians.run("__import__('importlib.util').util.find_spec('numpy') is not None"):
        pytest.skip("this one has it")
    debians.empty()
    debians.run(
        "for name, place, size in (('Shell', (0, 0, 1), 4), ('Chest', (0, 0, 0), .5)):\n"
        "    bpy.ops.mesh.primitive_cube_add(size=size, location=place)\n"
        "    bpy.context.object.name = name"
    )
    assert "Rooms are shown with all their walls" in debians.use(SCENE_LAYOUT).text
    with pytest.raises(Refusal, match="python3-numpy"):
        debians.use(MOTION_SHEET, actors=["Chest"])


def test_an_installed_blender_is_confined_too(debians: LiveSession) -> None:
    for code in ("import socket; socket.socket()", "import os; os.fork()", "open('/etc/passwd').read()"):
        assert debians.use(TOOL, code=code).data["error"]["type"] in {"PermissionError", "FileNotFoundError"}
    assert not (RunFolder(debians.blender.folder.root).root / "planted").exists()
