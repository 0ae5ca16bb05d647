"""Ways to start what outlives a call: processes, programs, threads, timers."""

from __future__ import annotations

from way import Way, way

_CHILD = "libc.prctl(15, target.mark.encode(), 0, 0, 0)\n    time.sleep(30)\n    os._exit(0)"


def _call(name: str, attacks: str, code: str, **more: object) -> Way:
    return way(name, attacks, code, machine="x86_64", **more)


# Machine code that makes a system call by its old or its short number, where the filter may not look.
_MACHINE = """
import mmap
def run(code):
    page = mmap.mmap(-1, 4096, prot=7)
    page.write(code)
    function = ctypes.CFUNCTYPE(ctypes.c_int)(ctypes.addressof(ctypes.c_char.from_buffer(page)))
    return function()
"""

WAYS = (
    way("fork", "processes", f"if os.fork() == 0:\n    {_CHILD}\nTrue"),
    way("fork-a-terminal", "processes", f"import pty\nif pty.fork()[0] == 0:\n    {_CHILD}\nTrue"),
    way("fork-by-the-c-library", "processes", f"if c('fork') == 0:\n    {_CHILD}\nTrue"),
    _call("fork-by-number", "processes", f"if syscall(57) == 0:\n    {_CHILD}\nTrue"),
    _call("clone", "processes", f"if syscall(56, 17, 0, 0, 0, 0) == 0:\n    {_CHILD}\nTrue"),
    _call(
        "clone3",
        "processes",
        f"if syscall(435, struct.pack('8Q', 0, 0, 0, 0, 17, 0, 0, 0), 64) == 0:\n    {_CHILD}\nTrue",
    ),
    _call(
        "fork-as-a-32-bit-program",
        "processes",
        f"{_MACHINE}run(bytes.fromhex('b802000000cd80c3')) > 0",
        denied=("Died",),
    ),
    _call("fork-by-the-x32-number", "processes", f"{_MACHINE}run(bytes.fromhex('b8390000400f05c3')) > 0"),
    way("spawn", "processes", "os.posix_spawn('/bin/sleep', [target.mark, '30'], {})"),
    way(
        "start-a-program",
        "processes",
        "import subprocess\nsubprocess.Popen([target.mark, '30'], executable='/bin/sleep').pid",
    ),
    way("start-a-shell", "processes", "os.system('sleep 30') == 0", timeout=60.0),
    way("start-by-popen", "processes", "libc.popen.restype = ctypes.c_void_p\nlibc.popen(b'sleep 30', b'r')"),
    way(
        "start-by-multiprocessing",
        "processes",
        "import multiprocessing\n"
        "multiprocessing.get_context('fork').Process(target=time.sleep, args=(30,)).start()\nTrue",
    ),
    way(
        "open-a-page",
        "processes",
        "import webbrowser\n"
        "webbrowser.register('x', None, webbrowser.GenericBrowser(['/bin/true', '%s']))\n"
        "webbrowser.get('x').open('http://127.0.0.1')",
    ),
    way("become-another-program", "processes", "os.execv('/bin/sleep', [target.mark, '30'])"),
    way(
        "become-a-nameless-program",
        "processes memfd",
        "number = os.memfd_create('program')\nos.write(number, read('/bin/sleep', 1 << 20))\n"
        "os.execve(number, [target.mark, '30'], {})",
    ),
    _call(
        "become-another-program-by-execveat",
        "processes",
        "words = (ctypes.c_char_p * 3)(target.mark.encode(), b'30', None)\n"
        "syscall(322, -100, b'/bin/sleep', words, (ctypes.c_char_p * 1)(None), 0)",
    ),
    way(
        "become-a-program-of-its-own",
        "processes files",
        "number = os.open('own', os.O_CREAT | os.O_WRONLY, 0o755)\n"
        "os.write(number, read('/bin/sleep', 1 << 20))\nos.close(number)\n"
        "os.execv('./own', [target.mark, '30'])",
    ),
    # Threads. What is left of them is seen in the process after the call.
    way(
        "leave-a-thread",
        "ground",
        "threading.Thread(target=lambda: (name_thread(), time.sleep(60))).start()\nNone",
        spoils=True,
        once=True,
    ),
    way(
        "leave-a-daemon-thread",
        "ground",
        "in_background(lambda: time.sleep(60))\nNone",
        spoils=True,
        once=True,
    ),
    way(
        "leave-a-thread-uncounted",
        "ground",
        "blind()\nin_background(lambda: time.sleep(60))\nNone",
        spoils=True,
        once=True,
    ),
    way(
        "leave-a-thread-without-python",
        "ground",
        "number = ctypes.c_ulong()\nbefore = set(os.listdir('/proc/self/task'))\n"
        "libc.pthread_create(ctypes.byref(number), None, ctypes.cast(libc.pause, ctypes.c_void_p), None)\n"
        "for task in set(os.listdir('/proc/self/task')) - before: "
        "open(f'/proc/self/task/{task}/comm', 'w').write(target.mark)\nNone",
        spoils=True,
        once=True,
    ),
    way(
        "leave-a-thread-without-python-uncounted",
        "ground",
        "blind()\nnumber = ctypes.c_ulong()\nbefore = set(os.listdir('/proc/self/task'))\n"
        "libc.pthread_create(ctypes.byref(number), None, ctypes.cast(libc.pause, ctypes.c_void_p), None)\n"
        "for task in set(os.listdir('/proc/self/task')) - before: "
        "open(f'/proc/self/task/{task}/comm', 'w').write(target.mark)\nNone",
        spoils=True,
        once=True,
    ),
    way(
        "leave-a-thread-of-low-priority",
        "ground",
        "def run():\n    name_thread()\n"
        "    os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), 19)\n    time.sleep(60)\n"
        "blind()\nthreading.Thread(target=run, daemon=True).start()\ntime.sleep(0.1)\nNone",
        spoils=True,
        once=True,
    ),
    way(
        "leave-a-thread-that-starts-late",
        "ground",
        "import weakref, gc\nclass Late:\n    def __del__(self): in_background(lambda: time.sleep(60))\n"
        "blind()\nbpy.late = Late()\ndel bpy.late\nNone",
        spoils=True,
        once=True,
    ),
    way(
        "leave-a-timer-that-notifies-by-a-thread",
        "ground",
        "called = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(lambda _: (name_thread(), time.sleep(60)))\n"
        "bpy.kept_by_attack = called\n"
        "event = struct.pack('QiiQQ', 0, 0, 2, ctypes.cast(called, ctypes.c_void_p).value, 0) + "
        "bytes(40)\n"
        "number = ctypes.c_void_p()\nlibc.timer_create(1, event, ctypes.byref(number))\n"
        "libc.timer_settime(number, 0, struct.pack('qqqq', 0, 100_000_000, 0, 100_000_000), None)\n"
        "time.sleep(0.3)\nNone",
        spoils=True,
        once=True,
    ),
)
