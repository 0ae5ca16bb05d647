"""Ways to take more than is allowed: memory, disk, files, threads, time, output. Each succeeds at its end."""

from __future__ import annotations

from way import Way, way

_OWN = """
import resource
which = resource.RLIMIT_{}
"""


def _raise(name: str) -> Way:
    return way(
        f"raise-the-limit-of-{name.lower()}",
        "limits",
        f"{_OWN.format(name)}resource.setrlimit(which, (resource.RLIM_INFINITY, "
        f"resource.RLIM_INFINITY)) or True",
        denied=("ValueError",),
    )


def _lower(name: str) -> Way:
    return way(
        f"lower-the-limit-of-{name.lower()}",
        "limits",
        f"{_OWN.format(name)}resource.setrlimit(which, (3, 3)) or True",
        denied=("ValueError",),
    )


def _disk(name: str, *steps: str, **more: object) -> Way:
    """A way to fill the disk. The limit is 64 MB and 400 files; at most 200 MB may pass beyond it."""
    return way(name, "disk", *steps, **{"timeout": 30.0, "once": True, **more})


_MIB = "1 << 20"

WAYS = (
    *map(_raise, ("DATA", "FSIZE", "CORE", "NOFILE", "AS", "MEMLOCK", "NPROC")),
    *map(_lower, ("DATA", "FSIZE", "NOFILE")),
    way(
        "raise-a-limit-by-number",
        "limits",
        "syscall(160, 1, struct.pack('QQ', 1 << 40, 1 << 40)) == 0",
        machine="x86_64",
    ),
    way(
        "raise-a-limit-by-prlimit",
        "limits",
        "syscall(302, 0, 1, struct.pack('QQ', 1 << 40, 1 << 40), 0) == 0",
        machine="x86_64",
    ),
    way(
        "raise-a-limit-of-its-number",
        "limits",
        "syscall(302, os.getpid(), 1, struct.pack('QQ', 1 << 40, 1 << 40), 0) == 0",
        machine="x86_64",
    ),
    # Memory: 1.6 GB are allowed.
    way("take-memory", "memory limits", "len(bytearray(4 << 30))"),
    way(
        "take-private-memory",
        "memory limits",
        "import mmap\nlen(mmap.mmap(-1, 4 << 30, flags=mmap.MAP_PRIVATE))",
    ),
    way("take-memory-as-numbers", "memory limits", "import numpy\nlen(numpy.ones(4 << 27))"),
    way(
        "take-memory-as-a-mesh",
        "memory limits",
        "bpy.ops.mesh.primitive_grid_add(x_subdivisions=15000, y_subdivisions=15000)\nTrue",
        denied=("Died",),
        spoils=True,
        once=True,
    ),
    way(
        "take-shared-memory",
        "memory",
        "import mmap\nshared = mmap.mmap(-1, 3 << 30)\n"
        "for at in range(0, 3 << 30, 4096): shared[at] = 1\ntime.sleep(2)\nTrue",
        timeout=40.0,
        once=True,
    ),
    way(
        "take-memory-as-a-file",
        "memory memfd",
        "number = os.memfd_create('x')\nfor _ in range(3 << 10): os.write(number, bytes(1 << 20))\n"
        "time.sleep(2)\nTrue",
        timeout=40.0,
    ),
    way(
        "take-memory-as-files",
        "memory memfd",
        "numbers = [os.memfd_create('x') for _ in range(48)]\n"
        "for number in numbers:\n    for _ in range(64): os.write(number, bytes(1 << 20))\n"
        "time.sleep(2)\nTrue",
        timeout=40.0,
        once=True,
    ),
    way(
        "take-memory-as-a-shared-file",
        "memory files",
        "number = os.open('/dev/shm/' + target.mark, os.O_CREAT | os.O_RDWR)\n"
        "os.write(number, bytes(1 << 20))",
    ),
    way(
        "take-memory-as-pipes",
        "memory",
        "import fcntl\npipes = [os.pipe() for _ in range(400)]\nfor _, end in pipes:\n"
        "    worked(fcntl.fcntl, end, 1031, 1 << 20)\n"
        "    os.set_blocking(end, False)\n    while worked(os.write, end, bytes(1 << 16)): pass\n"
        "sum(fcntl.fcntl(end, 1032) for _, end in pipes) > 600 << 20",
        timeout=40.0,
        denied=("11",),
    ),
    way("lock-memory", "memory limits", "c('mlockall', 3) == 0"),
    way(
        "be-the-last-to-be-killed",
        "proc files memory",
        "worked(lambda: open('/proc/self/oom_score_adj', 'w').write('-1000'))\n"
        "int(open('/proc/self/oom_score_adj').read()) < 1000",
    ),
    # Disk.
    _disk("one-large-file", "open('big', 'wb').write(bytes(300 << 20))"),
    _disk(
        "one-large-file-by-reservation",
        "number = os.open('big', os.O_CREAT | os.O_WRONLY)\nos.posix_fallocate(number, 0, 1 << 30) or True",
    ),
    _disk("many-files", "for number in range(4_000): open(f'f{number}', 'w').write('x')\nTrue"),
    _disk("many-empty-files", "for number in range(4_000): open(f'f{number}', 'w').close()\nTrue"),
    _disk("many-folders", "for number in range(4_000): os.mkdir(f'd{number}')\nTrue"),
    _disk("many-links", "for number in range(4_000): os.symlink('x' * 200, f'l{number}')\nTrue"),
    _disk(
        "many-names-of-one-file",
        "write('f')\nfor number in range(4_000): os.link('f', f'{number:0200}')\nTrue",
    ),
    _disk(
        "many-files-in-folders-in-folders",
        "os.makedirs('/'.join('d' * 60))\n"
        "for number in range(4_000): open('/'.join('d' * 60) + f'/{number}', 'w').close()\nTrue",
    ),
    _disk("folders-without-end", "for number in range(3_000): os.mkdir('d'); os.chdir('d')\nTrue"),
    _disk("many-bytes", "for number in range(30): open(f'b{number}', 'wb').write(bytes(10 << 20))\nTrue"),
    _disk(
        "many-bytes-in-the-temporary-folder",
        "for number in range(30): open(os.environ['TMPDIR'] + f'/b{number}', "
        "'wb').write(bytes(10 << 20))\nTrue",
    ),
    _disk(
        "many-bytes-in-nameless-files",
        "kept = []\nfor number in range(30):\n    kept.append(open('b', 'wb', 0))\n"
        "    kept[-1].write(bytes(10 << 20))\n    os.unlink('b')\ntime.sleep(3)\nTrue",
    ),
    _disk(
        "many-bytes-in-files-without-any-name",
        "kept = [os.open('.', os.O_TMPFILE | os.O_RDWR) for _ in range(30)]\n"
        "for number in kept: os.write(number, bytes(10 << 20))\ntime.sleep(3)\nTrue",
    ),
    _disk(
        "many-bytes-in-a-file-that-is-only-mapped",
        "import mmap\nkept = []\nfor number in range(6):\n    file = open('b', 'w+b', 0)\n"
        "    file.truncate(100 << 20)\n"
        "    kept.append(mmap.mmap(file.fileno(), 100 << 20))\n"
        "    kept[-1].write(bytes(range(256)) * (100 << 12))\n    file.close()\n"
        "    os.unlink('b')\ntime.sleep(3)\nTrue",
    ),
    _disk(
        "many-bytes-behind-many-files",
        "for number in range(390): open(f'f{number}', 'w').close()\n"
        "for number in range(30): open('f1' + str(number % 9), 'ab').write(bytes(10 << 20))\nTrue",
    ),
    _disk(
        "many-bytes-by-reservation",
        "for number in range(9): os.posix_fallocate(os.open(f'b{number}', os.O_CREAT | "
        "os.O_WRONLY), 0, 100 << 20)\ntime.sleep(3)\nTrue",
    ),
    _disk(
        "many-bytes-in-attributes",
        "for number in range(390):\n    write(f'f{number}', b'')\n    for part in range(900):\n"
        "        if not worked(os.setxattr, f'f{number}', f'user.a{part}', bytes(4000)): break\n"
        "sum(len(os.listxattr(f'f{number}')) for number in range(390)) * 4000 > 264 << 20",
    ),
    _disk(
        "bytes-after-a-change-of-mode",
        "os.mkdir('d')\n"
        "for number in range(30): open(f'd/b{number}', 'wb').write(bytes(10 << 20)) if number "
        "else os.chmod('d', 0o300)\nTrue",
    ),
    _disk(
        "many-bytes-in-many-calls",
        *(f"open('b{number}', 'wb').write(bytes(60 << 20)) and None" for number in range(5)),
        "sum(os.path.getsize(name) for name in os.listdir()) > 264 << 20",
    ),
    _disk(
        "one-large-file-of-blender",
        "import numpy\nmesh = bpy.data.meshes.new('large')\nmesh.use_fake_user = True\n"
        "mesh.vertices.add(14_000_000)\n"
        "mesh.vertices.foreach_set('co', numpy.ones(42_000_000, 'float32'))\n"
        "try: bpy.ops.wm.save_as_mainfile(filepath=bpy.path.abspath('//large.blend'), copy=True)\n"
        "finally: bpy.data.meshes.remove(mesh)  # else it is kept as a checkpoint\nTrue",
        spoils=True,
    ),
    way("a-core-dump", "limits", "os.abort()", denied=("Died",), spoils=True),
    # Threads and time.
    way(
        "many-threads",
        "limits processes",
        "threading.stack_size(65536)\n"
        "for _ in range(2000): threading.Thread(target=time.sleep, args=(9,), "
        "daemon=True).start()\nTrue",
        spoils=True,
        timeout=30.0,
        once=True,
    ),
    way("no-end", "deadline", "while True: pass", timeout=0.7),
    way(
        "no-end-without-the-interpreter",
        "deadline",
        "import re\nre.match('(a+)+$', 'a' * 40 + 'b')",
        timeout=0.7,
    ),
    way(
        "no-end-with-all-signals-blocked",
        "deadline",
        "import signal\nsignal.pthread_sigmask(signal.SIG_BLOCK, range(1, 64))\nwhile True: time.sleep(9)",
        timeout=0.7,
    ),
    way("stop-itself", "deadline", "import signal\nos.kill(os.getpid(), signal.SIGSTOP)", timeout=0.7),
    way("wait-for-a-file-that-never-comes", "deadline", "os.mkfifo('f')\nopen('f')", timeout=0.7),
    way("end-with-a-lie", "deadline", "os._exit(0)", denied=("Died",)),
    way("end-by-a-bad-pointer", "deadline", "ctypes.string_at(0)", denied=("Died",)),
    way("print-without-end", "deadline", "while True: os.write(1, bytes(1 << 16))", timeout=0.7),
    way("print-without-end-on-stderr", "deadline", "while True: os.write(2, b'x' * 65536)", timeout=0.7),
    way("print-half-a-character", "deadline", "os.write(1, b'\\xf0\\x9f' * 50000)\nNone"),
    way("reply-with-a-huge-value", "replies", "['x' * (1 << 20)] * 400\nNone"),
    way(
        "reply-with-an-endless-value",
        "deadline",
        "class Endless:\n    def __repr__(self):\n        while True: pass\nEndless()",
        timeout=0.7,
    ),
    way("reply-with-a-huge-error", "replies", "raise ValueError('x' * (1 << 28))", denied=("ValueError",)),
    way(
        "reply-with-a-deep-error",
        "replies",
        "def deep(n): return deep(n + 1)\ndeep(0)",
        denied=("RecursionError",),
    ),
)
