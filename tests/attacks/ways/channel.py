"""Ways to speak in the worker's place from within Blender: replies, frames, bytes on its socket."""

from __future__ import annotations

from way import Tool, Way, way

# The worker's end of the channel, as code in its process can find it.
_WIRE = """
frame = sys._getframe()
while 'wire' not in frame.f_locals: frame = frame.f_back
wire, ticket = frame.f_locals['wire'], frame.f_locals['request']['ticket']
"""
_AFTER = "1 + 1 != 2"


def _send(name: str, code: str, **more: object) -> Way:
    """A way that writes to the channel, and then waits for what comes of it; a further call must be answered truly."""
    return way(name, "channel", f"{_WIRE}{code}", _AFTER, **{"timeout": 5.0, "once": True, **more})


WAYS = (
    way(
        "write-to-every-descriptor",
        "channel",
        "for number in range(3, 400):\n    try: os.write(number, b'{\"value\": 1}' * 9)\n"
        "    except OSError: pass",
        _AFTER,
        timeout=5.0,
    ),
    way("close-every-descriptor", "channel", "os.closerange(3, 400)", _AFTER, timeout=5.0, denied=("Died",)),
    way(
        "lead-the-channel-elsewhere",
        "channel",
        "null = os.open('/dev/null', os.O_RDWR)\nfor number in range(200, 400):\n"
        "    try: os.dup2(null, number)\n    except OSError: pass",
        _AFTER,
        timeout=5.0,
        denied=("Died",),
    ),
    way(
        "lead-the-output-to-the-channel",
        "channel",
        f"{_WIRE}os.dup2(wire._fd, 1)\nos.dup2(wire._fd, 2)\nprint('x' * 9999, flush=True)\nos.system('')",
        _AFTER,
        timeout=5.0,
    ),
    _send("reply-without-a-value", "wire.send({'ticket': ticket})\ntime.sleep(10)"),
    _send(
        "reply-with-a-text-for-a-number",
        "wire.send({'ticket': ticket, 'value': None, 'seconds': 'long', 'left': []})\ntime.sleep(10)",
    ),
    _send(
        "reply-with-no-number",
        "wire.send({'ticket': ticket, 'value': None, 'seconds': float('nan'), 'left': []})\ntime.sleep(10)",
    ),
    _send(
        "reply-with-an-endless-number",
        "wire.send({'ticket': ticket, 'value': None, 'seconds': 10 ** 400, 'left': []})\ntime.sleep(10)",
    ),
    _send(
        "reply-with-a-false-progress",
        "wire.send({'ticket': ticket, 'progress': ['a', 'b', 'c']})\ntime.sleep(10)",
    ),
    _send(
        "reply-to-the-next-call",
        "forged = {'value': \"'forged'\", 'error': None, 'changed': {}, 'mode': 'OBJECT'}\n"
        "honest = {**forged, 'value': None}\n"
        "for value in (honest, forged, forged): wire.send({'ticket': ticket, 'value': value, "
        "'seconds': 0.1, 'left': []})\nNone",
    ),
    _send(
        "reply-in-the-supervisors-place",
        "from simworlds.sandbox.inside import channel\n"
        "wire._encode._sender = channel.SUPERVISOR\nwire.send({'ticket': ticket})\ntime.sleep(10)",
    ),
    _send(
        "reply-with-half-a-frame",
        "os.write(wire._fd, wire._encode({'ticket': ticket, 'value': None})[:60])\ntime.sleep(10)",
        timeout=0.7,
    ),
    _send(
        "reply-with-a-frame-of-four-gigabytes",
        "import hmac, hashlib\nlength = struct.pack('>I', (1 << 32) - 1)\nencode = wire._encode\n"
        "key = b'/'.join((encode._sender, b'head', encode._number.to_bytes(8, 'big'), b''))\n"
        "tag = hmac.new(encode._key, key + length, hashlib.sha256).digest()[:16]\n"
        "os.write(wire._fd, length + tag + bytes(32))\n"
        "for _ in range(3000): os.write(wire._fd, bytes(1 << 20))",
    ),
    _send(
        "reply-with-a-deep-frame",
        "import json\ndumps = json.dumps\n"
        "json.dumps = lambda *a, **k: '{\"ticket\":' + '[' * 100_000 + ']' * 100_000 + '}'\n"
        "try: wire.send({})\nfinally: json.dumps = dumps\ntime.sleep(10)",
    ),
    _send(
        "reply-with-millions-of-values",
        "wire.send({'ticket': ticket, 'value': [[]] * 4_000_000, 'seconds': 0, 'left': []})\ntime.sleep(10)",
        denied=("TooLarge",),
    ),
    _send(
        "reply-with-progress-without-end",
        "while True: wire.send({'ticket': ticket, 'progress': [0, None, 'x' * 9999]})",
        timeout=0.7,
    ),
    _send(
        "reply-with-progress-to-nowhere",
        "wire.send({'ticket': ticket, 'progress': [float('inf'), -1, '\\x1b[2J']})\ntime.sleep(10)",
    ),
    _send(
        "reply-with-an-old-number", "wire._encode._number -= 1\nwire.send({'ticket': ticket})\ntime.sleep(10)"
    ),
    _send(
        "read-the-next-request",
        "import fcntl\nfcntl.fcntl(wire._fd, fcntl.F_SETFL, os.O_NONBLOCK)\nNone",
        denied=("Died",),
    ),
    way(
        "stop-answering",
        "channel deadline",
        f"{_WIRE}type(wire).send.__code__ = (lambda self, message: None).__code__\nNone",
        "None",
        timeout=0.7,
        spoils=True,
        once=True,
    ),
    way(
        "answer-only-with-progress",
        "channel deadline",
        f"{_WIRE}send = wire.send\n"
        f"wire.send = lambda message: [time.sleep(0.01) or send({{'ticket': message['ticket'], "
        f"'progress': [0, 1, '']}}) for _ in iter(int, 1)]\nNone",
        timeout=0.7,
        spoils=True,
        once=True,
    ),
)

_TOOL = Tool("blender_scene_state")


def _tool(name: str, code: str, tool: Tool = _TOOL, **more: object) -> Way:
    """A way that changes the interpreter; then a tool must answer, truly."""
    return way(name, "interpreter", code, tool, spoils=True, once=True, **more)


_NAMES = (
    "('tag', 'video', 'stage', 'rooms', 'changes', 'worker', 'execute', 'readout', 'state', "
    "'blend', 'json', 'simworlds', 'simworlds_worker')"
)

INTERPRETER = (
    _tool(
        "name-a-file-as-a-module-of-the-worker",
        f"for name in {_NAMES}: write(name + '.py', b'raise ValueError(1)')\n"
        "sys.path.insert(0, os.getcwd())\nimport importlib\nimportlib.invalidate_caches()\n"
        "for name in ('tag', 'video', 'stage', 'rooms'):\n    try: __import__(name)\n"
        "    except ValueError: pass\nNone",
    ),
    _tool(
        "name-a-module-as-one-of-the-worker",
        f"import types\nfor name in {_NAMES}: sys.modules[name] = types.ModuleType(name)\nNone",
    ),
    _tool(
        "replace-the-workers-modules",
        "import types\nfor name in list(sys.modules):\n"
        "    if 'worker.' in name and not name.endswith(('worker', 'execute', "
        "'interpreter_state')): sys.modules[name] = types.ModuleType(name)\nNone",
    ),
    _tool(
        "replace-a-function-of-a-tool",
        "import importlib\n"
        "module = importlib.import_module(worker('worker').__package__ + '.state.readout')\n"
        "module.scene_state = lambda arguments, report: {'scene': {'name': target.mark}}\nNone",
    ),
    _tool(
        "replace-the-code-of-a-tool",
        "replies_of('state.readout', 'scene_state', \"from simworlds.sandbox.inside.refusal "
        'import Refused\\nraise Refused(target.mark)")\nNone',
    ),
    _tool(
        "replace-the-code-of-what-finds-tools",
        "from simworlds.sandbox.inside import service, refusal\nrefusal.mark = target.mark\n"
        "def find(self, name):\n    import sys\n"
        "    refusal = sys.modules['simworlds.sandbox.inside.refusal']\n"
        "    def forged(arguments, report): raise refusal.Refused(refusal.mark)\n"
        "    return forged if name == 'scene_state' else "
        "getattr(__import__('importlib').import_module(self._package + '.' + "
        "self._table[name][0]), self._table[name][1])\n"
        "service.Tools.find.__code__ = find.__code__\nNone",
    ),
    _tool("replace-the-table-of-tools", "worker('worker').TOOLS['scene_state'] = ('tag', 'tag')\nNone"),
    _tool(
        "replace-builtins",
        "import builtins\n"
        "for name in ('len', 'sorted', 'print', 'open', 'dict'): setattr(builtins, name, None)\n"
        "None",
    ),
    _tool(
        "replace-what-writes-json",
        "import json\njson.dumps = json.loads = None\njson.JSONEncoder.encode = None\nNone",
    ),
    _tool(
        "replace-what-finds-modules",
        "sys.meta_path.clear()\nsys.path.clear()\nsys.path_hooks.clear()\n"
        "sys.modules.pop('simworlds_worker.tag', None)\nNone",
    ),
    _tool(
        "replace-types-of-blender",
        "for name in ('objects', 'frame_current', 'collection', 'name', 'render'):\n"
        "    setattr(bpy.types.Scene, name, property(lambda self: 1 / 0))\nNone",
    ),
    _tool(
        "trace-all-that-follows",
        "def trace(*_): raise ValueError\nsys.settrace(trace)\nsys.setprofile(trace)\nNone",
        denied=("ValueError",),
    ),
    _tool(
        "ring-an-alarm-later",
        "import signal\nsignal.signal(signal.SIGALRM, lambda *_: 1 / 0)\n"
        "signal.setitimer(signal.ITIMER_REAL, 0.05, 0.05)\nNone",
    ),
    _tool("forbid-recursion", "sys.setrecursionlimit(60)\nNone"),
    _tool(
        "leave-an-audit-hook",
        "def hook(event, _):\n    if event in ('open', 'import'): raise ValueError(event)\n"
        "sys.addaudithook(hook)\nNone",
    ),
    _tool("leave-another-folder", "os.mkdir('gone')\nos.chdir('gone')\nos.rmdir('../gone')\nNone"),
    _tool("close-the-output", "sys.stdout.close()\nsys.stderr.close()\nos.close(1)\nos.close(2)\nNone"),
    way(
        "leave-what-runs-in-the-next-blender",
        "interpreter",
        "body = 'import builtins; builtins.planted_by_attack = True'\n"
        "bpy.app.handlers.load_post.append(lambda *_: exec(body))\n"
        "text = bpy.data.texts.new('planted.py')\ntext.write(body)\ntext.use_module = True\n"
        "bpy.context.preferences.filepaths.use_scripts_auto_execute = True\n"
        "for save in (bpy.ops.wm.save_userpref, bpy.ops.wm.save_homefile):\n    try: save()\n"
        "    except RuntimeError: pass\n"
        "home, version = os.environ['HOME'], f'python{sys.version_info[0]}.{sys.version_info[1]}'\n"
        "for folder in ('startup', 'scripts/startup', 'addons', "
        "f'.local/lib/{version}/site-packages', 'modules', '.'):\n"
        "    for place in (home, os.getcwd()):\n"
        "        os.makedirs(os.path.join(place, folder), exist_ok=True)\n"
        "        for name in ('planted.py', 'usercustomize.py', 'sitecustomize.py', 'json.py', "
        "'ctypes.py', 'os.py', 'changes.py', 'boot.py'):\n"
        "            open(os.path.join(place, folder, name), 'w').write(body + '\\ndef "
        "register(): pass')\nNone",
        "os._exit(0)",
        "import builtins\nhasattr(builtins, 'planted_by_attack')",
        denied=("Died",),
        spoils=True,
        once=True,
    ),
    way(
        "leave-a-temporary-file-for-the-next-blender",
        "interpreter",
        "write(os.path.join(os.environ['TMPDIR'], 'left'))\nNone",
        "os._exit(0)",
        "os.path.exists(os.path.join(os.environ['TMPDIR'], 'left'))",
        denied=("Died",),
        once=True,
    ),
)
