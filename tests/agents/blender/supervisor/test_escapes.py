"""Ways out of the sandbox, each tried by real code in a real Blender, in every kind of sandbox that works here."""

from __future__ import annotations

import contextlib
import os
import secrets
import shutil
import socket
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from live_session import LiveSession
from places import REPO
from sandboxes import sandbox_of, skip_unless_it_works

from agents.blender.tools.execute import TOOL
from simworlds.sandbox.confinement import confine_self
from simworlds.sandbox.confinement.resource_limits import ResourceLimits
from simworlds.sandbox.errors import Died, LeftBehind, LimitExceeded, Refusal, Untrustworthy

if TYPE_CHECKING:
    from collections.abc import Iterator

    from simworlds.sandbox.confinement.confined_command import Kind

pytestmark = [
    pytest.mark.blender,
    pytest.mark.skipif(
        not confine_self.has_seccomp(), reason="system calls cannot be closed on this machine"
    ),
]

WHOLE = pytest.mark.whole  # tests/attacks tries the same, or the cells differ in nothing but a value
SECRET = "sk-ant-this-is-no-key-but-must-not-be-seen"
MIB = 1 << 20
LIMITS = ResourceLimits(memory=1600 * MIB, file_size=16 * MIB, disk=64 * MIB, files=400, threads=300)
KINDS: tuple[Kind, ...] = ("bubblewrap",)  # tests/attacks tries the same ways with Landlock
DENIED = {"PermissionError", "FileNotFoundError", "OSError", "ProcessLookupError"}


@pytest.fixture(scope="module", params=KINDS)
def _confined(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[LiveSession]:
    kind = skip_unless_it_works(request.param)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ANTHROPIC_API_KEY", SECRET)
        session = LiveSession(tmp_path_factory.mktemp(kind) / "run", sandbox=sandbox_of(kind, LIMITS))
    yield session
    session.blender.close()


@pytest.fixture
def confined(_confined: LiveSession) -> LiveSession:
    """A Blender in a narrow sandbox, with an empty scene and an empty workspace."""
    _confined.empty()
    for path in _confined.blender.folder.workspace.mount.iterdir():
        if path.name == "scene.blend" and path.is_file() and not path.is_symlink():
            continue
        shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
    return _confined


@pytest.fixture(scope="module")
def _channelled(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LiveSession]:
    session = LiveSession(tmp_path_factory.mktemp("channel") / "run")
    yield session
    session.blender.close()


@pytest.fixture
def channelled(_channelled: LiveSession) -> LiveSession:
    """A Blender in whatever sandbox is the best here, with an empty scene: its channel is the same in all of them."""
    _channelled.empty()
    return _channelled


@pytest.fixture
def home() -> Iterator[Path]:
    """A folder below the real home, with a key in it."""
    with tempfile.TemporaryDirectory(prefix=".simworlds-test-", dir=Path.home()) as made:
        folder = Path(made)
        (folder / ".ssh").mkdir()
        (folder / ".ssh" / "id_ed25519").write_text(SECRET)
        yield folder


def tried(session: LiveSession, code: str) -> tuple[str, Any]:
    """(type of the error, None) or ("", value) of code that Blender survives."""
    data = session.use(TOOL, code=code, timeout=20).data
    error = data["error"]
    return (error["type"], None) if error else ("", data["value"])


def assert_denied(session: LiveSession, code: str) -> None:
    kind, value = tried(session, code)
    assert kind in DENIED, f"{code!r} came to {kind or value}"


def keep_an_object(session: LiveSession) -> None:
    session.run("bpy.context.collection.objects.link(bpy.data.objects.new('Kept', None))")
    session.blender.keep("an object")


LIBC = "import ctypes, os\nlibc = ctypes.CDLL(None, use_errno=True)\n"


# Reading


def test_keys_in_the_home_folder_cannot_be_read(confined: LiveSession, home: Path) -> None:
    key = home / ".ssh" / "id_ed25519"
    assert key.read_text() == SECRET
    for code in (f"open({str(key)!r}).read()", f"__import__('os').listdir({str(key.parent)!r})"):
        assert_denied(confined, code)
    assert_denied(confined, f"open('/proc/self/root{key}').read()")
    assert_denied(confined, f"open('/proc/self/cwd/../../../../../../../..{key}').read()")


@pytest.mark.parametrize(
    "path", ["/etc/passwd", "/etc/shadow", str(REPO / "README.md"), "/root", "/home", "/tmp", "/var"]
)
def test_what_blender_does_not_need_cannot_be_read(confined: LiveSession, path: str) -> None:
    if not Path(path).exists():
        pytest.skip(f"there is no {path}")
    code = f"import os\nos.listdir({path!r}) if os.path.isdir({path!r}) else open({path!r}).read()"
    kind, value = tried(confined, code)
    # Behind bubblewrap there are folders on the way to what may be read, with nothing else in them.
    names = {part for folder in confined.blender.launch.folders for part in folder.mount.parts}
    names |= {
        "ssh",
        *Path(os.sys.prefix).parts,
        *Path(os.sys.base_prefix).resolve().parts,
        *REPO.parts,
        "agents",
    }
    assert kind in DENIED or set(eval(value)) <= names  # type: ignore[attr-defined]


def test_the_key_of_the_model_is_in_no_environment(confined: LiveSession) -> None:
    """Neither in its own, nor in that of a process that it can look at; and those that have it cannot be looked at."""
    holder = subprocess.Popen(["sleep", "60"], env={"ANTHROPIC_API_KEY": SECRET})
    try:
        own = f"/proc/{holder.pid}/environ"
        while not Path(own).read_text():  # between fork and exec it has none
            pass
        assert SECRET in Path(own).read_text()
        assert_denied(confined, f"open({own!r}).read()")
        code = f"""
import os, glob
found = [name for name, value in os.environ.items() if 'ANTHROPIC' in name or {SECRET!r} in value]
for path in ['/proc/self/environ', f'/proc/{{os.getppid()}}/environ', *glob.glob('/proc/[0-9]*/environ')]:
    try:
        with open(path) as file: found += [path] if {SECRET!r} in file.read() else []
    except OSError: pass
found
"""
        assert tried(confined, code) == ("", "[]")
    finally:
        holder.kill()
        holder.wait()


def test_memory_of_other_processes_cannot_be_read(confined: LiveSession) -> None:
    own = os.getpid()
    assert_denied(confined, f"open('/proc/{own}/mem', 'rb').read(1)")
    assert_denied(confined, f"open('/proc/{own}/maps').read()")
    code = f"""{LIBC}
buffer = ctypes.create_string_buffer(8)
part = (ctypes.c_void_p * 2)(ctypes.addressof(buffer), 8)
[libc.ptrace(16, pid, 0, 0) for pid in ({own}, os.getppid())] + [
    libc.process_vm_readv(pid, part, 1, part, 1, 0) for pid in ({own}, os.getppid())]
"""
    assert tried(confined, code) == ("", "[-1, -1, -1, -1]")


# Writing


def test_the_repository_cannot_be_written_to(confined: LiveSession) -> None:
    readme = REPO / "README.md"
    before = readme.stat()
    planted = REPO / "agents" / "planted.py"
    for code in (
        f"open({str(planted)!r}, 'w').write('x')",
        f"open({str(readme)!r}, 'a').write('x')",
        f"__import__('os').truncate({str(readme)!r}, 0)",
        f"__import__('os').unlink({str(readme)!r})",
        f"__import__('os').rename({str(readme)!r}, {str(planted)!r})",
        f"__import__('os').mkdir({str(planted)!r})",
        f"__import__('os').symlink('/', {str(planted)!r})",
        f"__import__('os').link({str(readme)!r}, 'hard')",
        f"open({str(REPO / 'agents/blender/inside/worker.py')!r}, 'a').write('x')",
        f"__import__('os').open({str(REPO / 'agents/blender/inside/worker.py')!r}, 0o1000)",  # reading, cut short
    ):
        assert_denied(confined, code)
    # Modes and times: denied, or said to be set and not set.
    for path in (readme, REPO / "agents/blender/inside/worker.py"):
        mode = path.stat()
        tried(confined, f"__import__('os').chmod({str(path)!r}, 0o777)")
        tried(confined, f"__import__('os').utime({str(path)!r}, (1, 1))")
        assert (path.stat().st_mode, path.stat().st_mtime) == (mode.st_mode, mode.st_mtime)
    assert not planted.exists()
    assert (readme.stat().st_size, readme.stat().st_mtime) == (before.st_size, before.st_mtime)


def test_the_run_can_be_written_to_in_its_workspace_alone(confined: LiveSession) -> None:
    root = confined.blender.folder.root
    for code in (
        f"open({str(root / 'planted')!r}, 'w')",
        f"open({str(root / 'checkpoints' / '000001.blend')!r}, 'ab')",
        f"open({str(root / 'checkpoints' / '999999.blend')!r}, 'wb')",
        f"__import__('os').rename({str(root / 'workspace')!r}, {str(root / 'moved')!r})",
        f"__import__('os').rename({str(root / 'private')!r}, {str(root / 'workspace' / 'x')!r})",
        f"__import__('os').unlink({str(root / '.lock')!r})",
        f"open({str(root / 'lent' / 'planted')!r}, 'w')",
    ):
        assert_denied(confined, code)
    names = [".lock", "checkpoints", "lent", "private", "workspace"]
    assert sorted(path.name for path in root.iterdir()) == names
    assert tried(confined, "open('mine', 'w').write('x'); open('mine').read()") == ("", "'x'")
    assert tried(confined, "import shutil; shutil.copy2('mine', 'copy'); open('copy').read()") == ("", "'x'")


@pytest.mark.parametrize("folder", ["/dev/shm", "/tmp", "/var/tmp", "/run", "/", "/usr", "/dev", "/etc"])
def test_shared_places_cannot_be_written_to(confined: LiveSession, folder: str) -> None:
    place = Path(folder) / secrets.token_hex(8)  # where nobody else has a file
    assert_denied(confined, f"open({str(place)!r}, 'w')")
    assert not place.exists()


def test_blender_saves_nothing_outside(confined: LiveSession, home: Path) -> None:
    for path in (home / "x.blend", REPO / "x.blend", confined.blender.folder.root / "x.blend"):
        kind, _ = tried(confined, f"bpy.ops.wm.save_as_mainfile(filepath={str(path)!r})")
        assert kind == "RuntimeError"
        kind, _ = tried(
            confined,
            f"bpy.context.scene.render.filepath = {str(path)!r}\n"
            "image = bpy.data.images.new('i', 4, 4)\nimage.save(filepath=bpy.context.scene.render.filepath)",
        )
        assert kind == "RuntimeError"
        assert not path.exists()
    assert [path.name for path in home.iterdir()] == [".ssh"]


def test_links_lead_neither_code_nor_blender_nor_the_host_out(confined: LiveSession, home: Path) -> None:
    key = home / ".ssh" / "id_ed25519"
    folder = confined.blender.folder
    # Planted by the host, so that they are there whatever the sandbox does about making them.
    (folder.workspace.mount / "link").symlink_to(key)
    (folder.workspace.mount / "folder").symlink_to(home)
    for code in (
        "open('link').read()",
        "open('link', 'w').write('x')",
        "open('folder/planted', 'w').write('x')",
        f"__import__('os').symlink({str(home)!r}, 'own'); open('own/planted', 'w')",
    ):
        assert_denied(confined, code)
    tried(confined, "bpy.ops.wm.save_as_mainfile(filepath=bpy.path.abspath('//folder/planted.blend'))")
    for relative in ("link", "folder/.ssh/id_ed25519"):
        with pytest.raises(Refusal):
            folder.workspace.open(relative)
        with pytest.raises(Refusal):
            folder.workspace.take(relative, folder.root / "taken")
    assert key.read_text() == SECRET
    assert sorted(path.name for path in home.iterdir()) == [".ssh"]


@pytest.mark.parametrize("planted", ["link", pytest.param("folder", marks=WHOLE)])
def test_links_at_the_runs_own_file_are_not_followed(confined: LiveSession, home: Path, planted: str) -> None:
    key = home / ".ssh" / "id_ed25519"
    keep_an_object(confined)
    make = (
        f"os.symlink({str(key)!r}, 'scene.blend')" if planted == "link" else "os.makedirs('scene.blend/deep')"
    )
    confined.run(f"import os\nos.unlink('scene.blend')\n{make}")
    confined.blender.kill()
    assert confined.run("[o.name for o in bpy.data.objects]") == ["Kept"]
    assert key.read_text() == SECRET
    assert (confined.blender.folder.workspace.mount / "scene.blend").is_file()
    assert not (confined.blender.folder.workspace.mount / "scene.blend").is_symlink()


# The network


def test_no_server_is_reached(confined: LiveSession) -> None:
    with (
        socket.create_server(("127.0.0.1", 0)) as tcp,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp,
        socket.socket(socket.AF_UNIX) as unix,
    ):
        udp.bind(("127.0.0.1", 0))
        place = confined.blender.folder.workspace.mount / "s"
        here = os.open(place.parent, os.O_RDONLY)
        unix.bind(f"/proc/self/fd/{here}/s")
        os.close(here)
        unix.listen()
        for server in (tcp, udp, unix):
            server.setblocking(False)
        for code in (
            f"import socket; socket.create_connection(('127.0.0.1', {tcp.getsockname()[1]}), 2)",
            f"import urllib.request; urllib.request.urlopen('http://127.0.0.1:{tcp.getsockname()[1]}', timeout=2)",
            "import socket; socket.socket(socket.AF_INET, socket.SOCK_DGRAM)"
            f".sendto(b'x', ('127.0.0.1', {udp.getsockname()[1]}))",
            "import socket; socket.socket(socket.AF_UNIX).connect('s')",
            "import socket; socket.socket(socket.AF_NETLINK, socket.SOCK_RAW)",
            "import socket; socket.socket(socket.AF_INET6)",
            "import socket; socket.socketpair()[0].connect('s')",
            "import asyncio, socket; socket.socketpair()[0].sendto(b'x', 's')",
        ):
            kind, _ = tried(confined, code)
            assert kind in DENIED | {"URLError"}, code
        assert tried(confined, f"{LIBC}[libc.socket(family, 1, 0) for family in (1, 2, 10, 16, 38)]") == (
            "",
            "[-1, -1, -1, -1, -1]",
        )
        for server in (tcp, unix):
            with pytest.raises(BlockingIOError):
                server.accept()
        with pytest.raises(BlockingIOError):
            udp.recv(10)


def test_io_uring_is_closed(confined: LiveSession) -> None:
    assert tried(
        confined, f"{LIBC}libc.syscall(425, 8, ctypes.create_string_buffer(120)), ctypes.get_errno()"
    ) == (
        "",
        "(-1, 1)",
    )


# Processes


def test_no_process_can_be_started(confined: LiveSession) -> None:
    for code in (
        "while True: __import__('os').fork()",
        "__import__('subprocess').run(['/bin/true'])",
        "__import__('os').posix_spawn('/bin/true', ['true'], {})",
        "import multiprocessing\nmultiprocessing.get_context('fork').Process(target=print).start()",
        "import pty\npty.fork()",
    ):
        assert_denied(confined, code)
    assert tried(confined, "__import__('os').system('touch planted')")[1] != "0"
    calls = "[libc.fork(), libc.vfork(), libc.syscall(56, 17, 0, 0, 0, 0), libc.syscall(435, None, 0)]"
    assert tried(confined, LIBC + calls) == ("", "[-1, -1, -1, -1]")
    assert not (confined.blender.folder.workspace.mount / "planted").exists()


@WHOLE
def test_threads_without_end_are_stopped(confined: LiveSession) -> None:
    code = "import _thread, time\n_thread.stack_size(65536)\nwhile True: _thread.start_new_thread(time.sleep, (60,))"
    with pytest.raises(LimitExceeded, match=r"started [\d,]+ threads; the limit is 300"):
        confined.use(TOOL, code=code, timeout=20)
    assert confined.run("1 + 1") == 2


def test_signals_reach_no_other_process(confined: LiveSession) -> None:
    own = os.getpid()
    started = confined.blender.pid
    for code in (
        "import os; os.kill(os.getppid(), 9)",
        f"import os; os.kill({own}, 0)",
        f"import os; os.kill({started}, 9)"
        if confined.blender.launch.sandbox.kind == "bubblewrap"
        else "open('/x')",
        "import os; os.kill(-1, 9)",
        "import os; os.kill(0, 9)",
        f"import os; os.killpg({os.getpgid(0)}, 9)",
        f"import os, signal; signal.pidfd_send_signal(os.pidfd_open({own}), 9)",
        f"import fcntl, os; fcntl.fcntl(os.pipe()[0], 8, {own})",
        f"import resource; resource.prlimit({own}, resource.RLIMIT_NOFILE, (0, 0))",
        f"import os; os.setpriority(os.PRIO_PROCESS, {own}, 19)",
        f"import os; os.sched_setaffinity({own}, {{0}})",
    ):
        assert_denied(confined, code)
    assert confined.blender.pid == started


# Rights


@WHOLE
def test_limits_can_be_neither_raised_nor_lowered(confined: LiveSession) -> None:
    for which in ("DATA", "FSIZE", "CORE", "NOFILE"):
        code = f"import resource\nresource.getrlimit(resource.RLIMIT_{which})"
        before = tried(confined, code)
        for new in ("(1 << 40, 1 << 40)", "(3, 3)"):
            kind, _ = tried(confined, f"import resource\nresource.setrlimit(resource.RLIMIT_{which}, {new})")
            assert kind in DENIED | {"ValueError"}
        assert tried(confined, code) == before
    assert tried(confined, f"{LIBC}libc.setrlimit(1, (ctypes.c_ulong * 2)(3, 3))") == ("", "-1")


def test_nothing_can_be_mounted_or_made_root(confined: LiveSession) -> None:
    calls = (
        "[libc.mount(b'none', b'.', b'tmpfs', 0, None), libc.chroot(b'.'), libc.unshare(0x10000000),"
        " libc.setns(os.open('/proc/self/ns/mnt', 0), 0), libc.umount2(b'.', 2), libc.setuid(12345),"
        " libc.pivot_root(b'.', b'.'), libc.syscall(428, -100, b'.', 1), libc.prctl(1, 0), libc.prctl(4, 0)]"
    )
    assert tried(confined, LIBC + calls) == ("", str([-1] * 10))


# Amounts


@WHOLE
def test_one_file_grows_to_its_limit_and_no_further(confined: LiveSession) -> None:
    assert tried(confined, "open('big', 'wb').write(bytes(40 << 20))")[0] == "OSError"
    assert (confined.blender.folder.workspace.mount / "big").stat().st_size <= LIMITS.file_size
    kind, _ = tried(
        confined,
        "mesh = bpy.data.meshes.new('large')\nmesh.use_fake_user = True\nmesh.vertices.add(2_000_000)\n"
        "import numpy\nmesh.vertices.foreach_set('co', numpy.random.random(6_000_000))\n"
        "bpy.ops.wm.save_as_mainfile(filepath=bpy.path.abspath('//large.blend'), copy=True)",
    )
    assert kind == "RuntimeError"


@pytest.mark.parametrize(
    ("code", "told"),
    [
        pytest.param(
            "for i in range(10**6): open(f'f{i}', 'w').write('x')", "more than 400 files", marks=WHOLE
        ),
        pytest.param(
            "import os\nfor i in range(10**6): os.mkdir(f'd{i}')", "more than 400 files", marks=WHOLE
        ),
        ("for i in range(60): open(f'b{i}', 'wb').write(bytes(15 << 20))", "the limit is 67 MB"),
        pytest.param(
            "import os\nhome = os.environ['TMPDIR']\n"
            "for i in range(60): open(f'{home}/b{i}', 'wb').write(bytes(15 << 20))",
            "the limit is 67 MB",
            marks=WHOLE,
        ),
        pytest.param(
            "import os\nfor i in range(10**4): os.mkdir('d'); os.chdir('d')", "more than 64 deep", marks=WHOLE
        ),
    ],
    ids=["files", "folders", "bytes", "temporary bytes", "depth"],
)
def test_a_disk_cannot_be_filled(confined: LiveSession, code: str, told: str) -> None:
    """What was written before stays; what the call wrote goes, so that the next one has room."""
    confined.run("open('kept', 'w').write('from before')")
    with pytest.raises(LimitExceeded, match=told):
        confined.use(TOOL, code=f"{code}\nimport time; time.sleep(20)", timeout=30)
    workspace = confined.blender.folder.workspace.mount
    assert {path.name for path in workspace.iterdir()} <= {"kept", "scene.blend"}
    assert (workspace / "kept").read_text() == "from before"
    assert confined.run("import time; time.sleep(0.6); open('kept').read()") == "from before"


@WHOLE
def test_limits_hold_for_short_calls(confined: LiveSession) -> None:
    """Each of them ends before it would be looked at."""

    def write_on() -> None:
        for number in range(40):
            confined.use(TOOL, code=f"open('b{number}', 'wb').write(bytes(12 << 20))")

    with pytest.raises(LimitExceeded, match="the limit is 67 MB"):
        write_on()
    assert confined.run("import time; time.sleep(0.6); 1 + 1") == 2


@WHOLE
def test_memory_limit_holds(confined: LiveSession) -> None:
    assert tried(confined, "bytearray(4 << 30)")[0] == "MemoryError"
    assert tried(confined, "import mmap\nmmap.mmap(-1, 4 << 30, flags=mmap.MAP_PRIVATE)")[0] in {
        "OSError",
        "MemoryError",
    }
    assert tried(confined, "import numpy\nnumpy.ones(10**9)")[0] in {"MemoryError", "_ArrayMemoryError"}
    with pytest.raises(Died, match=r"ran out of memory; the limit is 1\.7 GB"):
        confined.use(TOOL, code="bpy.ops.mesh.primitive_grid_add(x_subdivisions=15000, y_subdivisions=15000)")
    assert confined.run("1 + 1") == 2


@WHOLE
def test_memory_limit_holds_for_shared_memory(confined: LiveSession) -> None:
    # The kernel ends it where there are control groups, else SimWorlds.
    with pytest.raises((Died, LimitExceeded), match=r"memory; the limit is 1\.7 GB"):
        confined.use(
            TOOL,
            code="import mmap, time\nshared = mmap.mmap(-1, 2 << 30)\n"
            "for place in range(0, 2 << 30, 4096): shared[place] = 1\ntime.sleep(20)",
            timeout=30,
        )
    assert confined.run("1 + 1") == 2


# What would outlive the process


@WHOLE
def test_nothing_that_code_leaves_runs_in_the_next_blender(confined: LiveSession) -> None:
    marker = "planted_by_code"
    confined.run(f"""
import os, sys
body = "import builtins; builtins.{marker} = True"
class Planted(bpy.types.Operator):
    bl_idname, bl_label = 'scene.{marker}', 'Planted'
bpy.utils.register_class(Planted)
bpy.app.handlers.load_post.append(lambda *_: exec(body))
bpy.app.handlers.depsgraph_update_post.append(lambda *_: exec(body))
text = bpy.data.texts.new('planted.py')
text.write(body)
text.use_module = True
bpy.types.Scene.{marker} = bpy.props.IntProperty()
bpy.context.preferences.filepaths.use_scripts_auto_execute = True
for save in (bpy.ops.wm.save_userpref, bpy.ops.wm.save_homefile):
    try: save()
    except RuntimeError: pass
home = os.environ['HOME']
version = f'python{{sys.version_info[0]}}.{{sys.version_info[1]}}'
for folder in ('startup', 'scripts/startup', 'addons', f'.local/lib/{{version}}/site-packages', 'modules'):
    os.makedirs(os.path.join(home, folder), exist_ok=True)
    for name in ('{marker}.py', 'usercustomize.py', 'sitecustomize.py'):
        open(os.path.join(home, folder, name), 'w').write(body + '\\ndef register(): pass')
for name in ('sitecustomize.py', 'json.py', 'files.py', 'changes.py'):
    open(name, 'w').write(body)
""")
    confined.blender.kill()
    found = confined.run(f"""
import builtins
bpy.context.view_layer.update()
(hasattr(builtins, '{marker}'), hasattr(bpy.types, 'SCENE_OT_{marker}'), hasattr(bpy.types.Scene, '{marker}'),
 'planted.py' in bpy.data.texts, bpy.context.preferences.filepaths.use_scripts_auto_execute,
 [h for h in bpy.app.handlers.load_post if 'lambda' in str(h)])
""")
    assert found == (False, False, False, True, False, [])


@WHOLE
def test_no_temporary_file_outlives_the_process(confined: LiveSession) -> None:
    private = confined.blender.folder.private.mount
    confined.run("import os\nopen(os.path.join(os.environ['TMPDIR'], 'left'), 'w').write('x')")
    assert (private / "left").exists()
    confined.blender.kill()
    confined.run("1")
    assert not (private / "left").exists()


# The channel

# The worker's end of the channel, as code in its process can find it.
WIRE = """
import sys
frame = sys._getframe()
while 'wire' not in frame.f_locals: frame = frame.f_back
wire, ticket = frame.f_locals['wire'], frame.f_locals['request']['ticket']
"""


def test_unsigned_bytes_on_the_channel_are_rejected(channelled: LiveSession) -> None:
    keep_an_object(channelled)
    code = """
import os
bpy.data.objects.remove(bpy.data.objects['Kept'])
for number in range(100, 400):
    try: os.write(number, b'{"value": 1}' * 9)
    except OSError: pass
"""
    with pytest.raises(Untrustworthy, match="right signature") as caught:
        channelled.use(TOOL, code=code)
    assert "A new Blender was started from checkpoint" in str(caught.value)
    assert channelled.run("[o.name for o in bpy.data.objects]") == ["Kept"]


@pytest.mark.parametrize(
    "answer",
    [
        "{'ticket': ticket}",
        pytest.param("{'ticket': ticket, 'value': 1, 'seconds': 'long', 'left': []}", marks=WHOLE),
        pytest.param("{'ticket': ticket, 'value': 1, 'seconds': 1, 'left': 3}", marks=WHOLE),
        pytest.param("{'ticket': ticket, 'progress': ['a', 'b', 'c']}", marks=WHOLE),
        pytest.param("{'ticket': ticket, 'failed': 'x'}", marks=WHOLE),
        pytest.param("{'nothing': 1}", marks=WHOLE),
    ],
)
def test_signed_but_malformed_replies_are_rejected(channelled: LiveSession, answer: str) -> None:
    with pytest.raises(Untrustworthy, match=r"not a valid reply.*A new Blender was started from checkpoint"):
        channelled.use(TOOL, code=f"{WIRE}wire.send({answer})\nimport time; time.sleep(10)", timeout=15)
    assert channelled.run("1 + 1") == 2


@pytest.mark.parametrize(
    "value",
    [
        "None",
        pytest.param("[]", marks=WHOLE),
        pytest.param("{'value': 'x', 'error': 'y', 'changed': 1}", marks=WHOLE),
    ],
)
def test_malformed_outcomes_are_rejected(channelled: LiveSession, value: str) -> None:
    keep_an_object(channelled)
    code = f"{WIRE}wire.send({{'ticket': ticket, 'value': {value}, 'seconds': 0.1, 'left': []}})"
    with pytest.raises((Untrustworthy, LeftBehind, Died)) as caught:
        channelled.use(TOOL, code=f"{code}\nbpy.data.objects.remove(bpy.data.objects['Kept'])")
    assert "checkpoint" in str(caught.value)
    assert channelled.run("[o.name for o in bpy.data.objects]") == ["Kept"]


@WHOLE
def test_forged_replies_do_not_affect_the_next_call(channelled: LiveSession) -> None:
    """Code that knows the key can answer its own call before it is over; its real answer then comes too late."""
    value = "{'value': 'forged', 'error': None, 'changed': {}, 'mode': 'OBJECT'}"
    code = f"{WIRE}wire.send({{'ticket': ticket, 'value': {value}, 'seconds': 0.1, 'left': []}})"
    with contextlib.suppress(Died):
        channelled.use(TOOL, code=code)
    assert channelled.run("1 + 1") == 2
