"""Ways to lead the server itself astray in folders that the worker writes to: links, pipes, races. A liar stands in for
Blender, so that everything happens while the server works on a call, whatever threads are left between calls."""

from __future__ import annotations

from typing import TYPE_CHECKING

from way import Tool, Way, way

if TYPE_CHECKING:
    from collections.abc import Mapping

_RENDER = Tool("blender_render")
_FILM = Tool("blender_render", {"kind": "animation"})
_PREVIEW = Tool("blender_scene_layout_preview")
_MOTION = Tool("blender_motion_sheet_preview", {"actors": ["Cube"]})
_SAVE = Tool("blender_save", {"name": "kept"})
_SAVE_QUICKLY = Tool("blender_save", {"name": "kept", "verify": False})
_LOAD = Tool("blender_load", {"path": "kept.blend"})
_RUN = Tool("blender_execute", {"code": "1"})
_CHECKPOINT = Tool("blender_save")
_VERIFY = Tool("blender_verify", {"image": True})

# A thread that replaces what has a name, again and again, by a link: what the server opens, it opens through that.
_RACE = """
def race(names, place=None, seconds=8):
    until = time.monotonic() + seconds
    def run():
        while time.monotonic() < until:
            for name in names() if callable(names) else names:
                try:
                    inside = place and os.path.isdir(place)
                    link = place + '/' + os.path.basename(name) if inside else place or target.victim
                    os.symlink(link, name + '.swap')
                    os.rename(name + '.swap', name)
                except OSError:
                    try: os.unlink(name + '.swap')
                    except OSError: pass
    threading.Thread(target=run, daemon=True).start()
def exchange(name, other, seconds=8):
    until = time.monotonic() + seconds
    def run():
        while time.monotonic() < until:
            libc.syscall(*raw(316, -100, name.encode(), -100, other.encode(), 2))
    threading.Thread(target=run, daemon=True).start()
"""


def _lie(name: str, lies: Mapping[str, str], *tools: Tool, attacks: str = "ground", **more: object) -> Way:
    return way(
        name, attacks, *tools, lies={tool: f"{_RACE}{code}" for tool, code in lies.items()}, once=True, **more
    )


def _instead(tool: str, path: str, make: str) -> Mapping[str, str]:
    """The truth, with something else in the place of the file that it is about."""
    return {tool: f"value = truth()\npath = {path}\nos.unlink(path)\n{make}\nreturn value"}


_KINDS = {
    "a-link": "os.symlink(target.file, path)",
    "a-link-to-a-picture": "os.symlink(target.picture, path)",
    "a-pipe": "os.mkfifo(path)",
    "a-folder": "os.mkdir(path)",
    "a-link-to-itself": "os.symlink(path, path)",
    "a-link-to-a-device": "os.symlink('/dev/zero', path)",
    "a-huge-sparse-file": "with open(path, 'wb') as file: worked(file.truncate, 100 << 30)",
}
# What is taken: (tool of the worker, path of the file, tools that make the server take it).
_TAKEN = {
    "a-frame": ("render_frame", "arguments['path']", (_RENDER,)),
    "a-film": ("render_video", "arguments['path']", (_FILM,)),
    "a-view": ("preview", "os.path.join(arguments['folder'], value['views'][0]['file'])", (_PREVIEW,)),
    "a-tile": ("motion_sheet", "os.path.join(arguments['folder'], '0-path-1.png')", (_MOTION,)),
    "a-saved-file": ("save", "arguments['path']", (_SAVE_QUICKLY,)),
    "a-checkpoint": ("write", "arguments['path']", (_RUN, _CHECKPOINT)),
}

TAKING = tuple(
    _lie(f"{kind}-for-{what}", _instead(tool, path, make), *tools, seconds=90.0)
    for what, (tool, path, tools) in _TAKEN.items()
    for kind, make in _KINDS.items()
    if not (what == "a-view" and kind == "a-folder")
)

WAYS = (
    *TAKING,
    # Links that are planted while the server writes.
    _lie(
        "links-where-a-file-is-lent",
        {
            "execute": "worked(os.makedirs, '.loading/x') if not os.path.lexists('.loading') else None\n"
            "race(['.loading/kept.blend', '.loading', 'kept.blend'], target.folder)\nreturn truth()",
            "kept_caches": "return truth()",
            "save": "race(['.loading'], target.folder)\nreturn truth()",
        },
        _SAVE_QUICKLY,
        _RUN,
        _LOAD,
    ),
    _lie(
        "a-link-where-a-file-is-lent-at-once",
        {
            "write": "def run():\n    until = time.monotonic() + 3\n    while time.monotonic() < until:\n"
            "        try: os.symlink(target.victim, '.loading/kept.blend')\n        except OSError: pass\n"
            "threading.Thread(target=run, daemon=True).start()\nreturn truth()",
        },
        _SAVE_QUICKLY,
        _RUN,
        _LOAD,
    ),
    _lie(
        "links-where-a-film-is-made",
        {
            "render_frame": "value = truth()\nimport glob\nos.makedirs('.film', exist_ok=True)\n"
            "race(lambda: [name + '/' + frame for name in glob.glob('.film*') for frame in "
            "('0001.png', '0002.png', '0003.png')], target.victim, 4)\nreturn value",
            "render_video": "time.sleep(0.5)\nreturn truth()",
        },
        _FILM,
    ),
    _lie(
        "a-folder-of-a-film-exchanged-for-a-link",
        {
            "render_frame": "value = truth()\nimport glob\n"
            "os.symlink(target.folder, '.l') if not os.path.islink('.l') else None\n"
            "def run():\n    until = time.monotonic() + 4\n    while time.monotonic() < until:\n"
            "        for name in glob.glob('.film-*'): libc.syscall(*raw(316, -100, name.encode(), "
            "-100, b'.l', 2))\n"
            "threading.Thread(target=run, daemon=True).start()\nreturn value"
        },
        _FILM,
    ),
    _lie(
        "the-runs-own-file-as-a-link",
        {
            "execute": "os.unlink('scene.blend') if os.path.exists('scene.blend') else None\n"
            "os.symlink(target.victim, 'scene.blend')\nos._exit(0)"
        },
        _RUN,
        _RUN,
    ),
    _lie(
        "the-runs-own-file-as-a-folder",
        {
            "execute": "os.unlink('scene.blend') if os.path.isfile('scene.blend') else None\n"
            "os.makedirs('scene.blend/deep/er', exist_ok=True)\nos._exit(0)"
        },
        _RUN,
        _RUN,
    ),
    _lie(
        "the-runs-own-file-as-a-folder-of-links",
        {
            "execute": "os.unlink('scene.blend') if os.path.isfile('scene.blend') else None\n"
            "os.makedirs('scene.blend', exist_ok=True)\n"
            "worked(os.symlink, target.folder, 'scene.blend/link')\nos._exit(0)"
        },
        _RUN,
        _RUN,
    ),
    _lie(
        "a-link-that-is-half-written",
        {
            "execute": "worked(os.symlink, target.victim, 'x.blend@')\n"
            "worked(os.symlink, target.folder, 'y.blend@')\nos._exit(0)"
        },
        _RUN,
    ),
    _lie(
        "a-view-in-a-folder-that-becomes-a-link",
        {
            "preview": "value = truth()\nos.makedirs('d', exist_ok=True)\nos.symlink(target.folder, 'e')\n"
            "with open('d/victim', 'wb') as file: file.write(png(32, 32))\nexchange('d', 'e')\n"
            "value['views'][0]['file'] = 'd/victim'\nreturn value"
        },
        _PREVIEW,
    ),
    _lie(
        "a-view-outside",
        {"preview": "value = truth()\nvalue['views'][0]['file'] = target.victim\nreturn value"},
        _PREVIEW,
        must_fail=True,
    ),
    _lie(
        "a-view-above",
        {
            "preview": "value = truth()\nvalue['views'][0]['file'] = '../checkpoints/000001.blend'\nreturn value"
        },
        _PREVIEW,
        must_fail=True,
    ),
    _lie(
        "a-view-that-is-the-scene",
        {"preview": "value = truth()\nvalue['views'][0]['file'] = 'scene.blend'\nreturn value"},
        _PREVIEW,
        must_fail=True,
    ),
    _lie(
        "the-folder-of-tiles-as-a-link",
        {
            "motion_sheet": "value = truth()\nfolder = arguments['folder']\nos.rename(folder, folder + '2')\n"
            "os.symlink(target.folder, folder)\nreturn value"
        },
        _MOTION,
    ),
    _lie(
        "the-folder-of-tiles-exchanged-for-a-link",
        {
            "motion_sheet": "value = truth()\nos.symlink(target.folder, 'e')\nexchange(arguments['folder'], 'e')\n"
            "return value"
        },
        _MOTION,
    ),
    _lie(
        "tiles-in-folders-without-end",
        {
            "motion_sheet": "value = truth()\nhere = os.getcwd()\nos.chdir(arguments['folder'])\n"
            "for _ in range(50): os.mkdir('d'); os.chdir('d')\nos.chdir(here)\nreturn value"
        },
        _MOTION,
    ),
    _lie(
        "folders-that-nobody-may-enter",
        {
            "motion_sheet": "value = truth()\nos.makedirs(arguments['folder'] + '/a/b')\n"
            "os.chmod(arguments['folder'] + '/a', 0)\nreturn value"
        },
        _MOTION,
    ),
    _lie(
        "modes-of-folders-that-become-links",
        {
            # Once the first of many folders is gone, all are known to be folders: the rest become links.
            "motion_sheet": "value = truth()\ntop = arguments['folder'] + '/a/'\n"
            "for n in range(300): os.makedirs(f'{top}f{n}/g')\n"
            "def run():\n    until = time.monotonic() + 8\n"
            "    while len(os.listdir(top)) == 300 and time.monotonic() < until: pass\n"
            "    for n in range(300):\n"
            "        for name in (f'{top}f{n}', f'{top}f{299 - n}'):\n"
            "            try:\n                os.rename(name, f'gone{n}-{time.monotonic_ns()}')\n"
            "                os.symlink(target.folder, name)\n"
            "            except OSError: pass\n"
            "threading.Thread(target=run, daemon=True).start()\nreturn value"
        },
        _MOTION,
    ),
    _lie(
        "a-saved-file-exchanged-for-a-link",
        {
            "save": "value = truth()\nos.symlink(target.file, 'e')\nexchange(arguments['path'], 'e')\n"
            "return value"
        },
        _SAVE_QUICKLY,
        _LOAD,
    ),
    _lie(
        "a-checkpoint-exchanged-for-a-link",
        {
            "write": "value = truth()\nworked(os.unlink, 'e')\nworked(os.symlink, target.file, 'e')\n"
            "exchange(arguments['path'], 'e', 2)\nreturn value"
        },
        _RUN,
        _CHECKPOINT,
    ),
    _lie(
        "a-frame-exchanged-for-a-link",
        {
            "render_frame": "value = truth()\nworked(os.unlink, 'e')\nos.symlink(target.picture, 'e')\n"
            "exchange(arguments['path'], 'e', 2)\nreturn value"
        },
        _RENDER,
    ),
    _lie(
        "a-frame-that-grows",
        {
            "render_frame": "value = truth()\npath = arguments['path']\ndef run():\n"
            "    with open(path, 'ab') as file:\n"
            "        for _ in range(100): worked(file.write, bytes(1 << 20))\n"
            "threading.Thread(target=run, daemon=True).start()\nreturn value"
        },
        _RENDER,
    ),
    _lie(
        "a-frame-that-shrinks",
        {
            "render_frame": "value = truth()\npath = arguments['path']\ndef run():\n"
            "    for n in range(3000): worked(os.truncate, path, n % 99)\n"
            "threading.Thread(target=run, daemon=True).start()\nreturn value"
        },
        _RENDER,
    ),
    # Caches: files that a save names.
    _lie(
        "a-cache-outside",
        {"save": "return {**truth(), 'files': [[target.file, 'x.bphys']]}"},
        _SAVE_QUICKLY,
        must_fail=True,
    ),
    _lie(
        "a-cache-above",
        {"save": "return {**truth(), 'files': [['../checkpoints/000001.blend', 'x.bphys']]}"},
        _SAVE_QUICKLY,
        must_fail=True,
    ),
    _lie(
        "a-cache-to-outside",
        {"save": "write('x')\nreturn {**truth(), 'files': [['x', '../../' + target.mark]]}"},
        _SAVE_QUICKLY,
        must_fail=True,
    ),
    _lie(
        "a-cache-to-anywhere",
        {"save": "write('x')\nreturn {**truth(), 'files': [['x', target.folder + '/planted']]}"},
        _SAVE_QUICKLY,
        must_fail=True,
    ),
    _lie(
        "a-cache-with-a-zero-in-its-name",
        {"save": "write('x')\nreturn {**truth(), 'files': [['x', 'a\\0b']]}"},
        _SAVE_QUICKLY,
        must_fail=True,
    ),
    _lie(
        "a-cache-with-an-endless-name",
        {"save": "write('x')\nreturn {**truth(), 'files': [['x', 'a' * 5000]]}"},
        _SAVE_QUICKLY,
        must_fail=True,
    ),
    _lie(
        "a-cache-through-a-link",
        {"save": "os.symlink(target.folder, 'l')\nreturn {**truth(), 'files': [['l/file', 'x.bphys']]}"},
        _SAVE_QUICKLY,
        must_fail=True,
    ),
    _lie(
        "a-cache-that-is-a-pipe",
        {"save": "os.mkfifo('f')\nreturn {**truth(), 'files': [['f', 'x.bphys']]}"},
        _SAVE_QUICKLY,
        must_fail=True,
    ),
    _lie(
        "a-cache-that-is-a-folder-and-a-file",
        {"save": "write('x')\nreturn {**truth(), 'files': [['x', 'a'], ['x', 'a/b']]}"},
        _SAVE_QUICKLY,
        must_fail=True,
    ),
    _lie(
        "one-cache-many-times",
        {
            "save": "with open('x', 'wb') as file: file.write(bytes(60 << 20))\n"
            "return {**truth(), 'files': [['x', f'{n}.bphys'] for n in range(10)]}"
        },
        _SAVE_QUICKLY,
        seconds=120.0,
        must_fail=True,
    ),
    _lie(
        "a-cache-in-a-folder-that-becomes-a-link",
        {
            "save": "os.mkdir('d')\nwrite('d/file')\nos.symlink(target.folder, 'e')\nexchange('d', 'e')\n"
            "return {**truth(), 'files': [['d/file', f'{n}.bphys'] for n in range(300)]}"
        },
        _SAVE_QUICKLY,
    ),
    # Saved files that are not what they seem.
    _lie(
        "a-saved-file-that-is-no-scene",
        {"save": "value = truth()\nwrite(arguments['path'], b'#!/bin/sh')\nreturn value"},
        _SAVE_QUICKLY,
        _LOAD,
    ),
    _lie(
        "a-scene-that-is-listed-but-is-a-link",
        {
            "execute": "worked(os.symlink, target.file, 'x.blend')\nworked(os.mkdir, 'd.blend')\n"
            "worked(os.symlink, '..', 'up')\nreturn truth()"
        },
        _RUN,
        Tool("blender_load"),
    ),
    _lie(
        "load-a-link",
        {"execute": "worked(os.symlink, target.file, 'x.blend')\nreturn truth()"},
        _RUN,
        Tool("blender_load", {"path": "workspace/x.blend"}),
        must_fail=True,
    ),
    _lie(
        "load-through-a-link",
        {"execute": "worked(os.symlink, target.folder, 'l')\nreturn truth()"},
        _RUN,
        Tool("blender_load", {"path": "workspace/l/file.blend"}),
        must_fail=True,
    ),
    _lie(
        "load-a-pipe",
        {"execute": "worked(os.mkfifo, 'x.blend')\nreturn truth()"},
        _RUN,
        Tool("blender_load", {"path": "workspace/x.blend"}),
        must_fail=True,
    ),
    _lie(
        "load-a-scene-that-is-exchanged-for-a-link",
        {
            "execute": "write('x.blend', b'BLENDER-v501RENDH')\nworked(os.symlink, target.file, 'e')\n"
            "exchange('x.blend', 'e', 3)\nreturn truth()"
        },
        _RUN,
        Tool("blender_load", {"path": "workspace/x.blend"}),
    ),
    _lie(
        "load-caches-through-a-link",
        {
            "execute": "write('x.blend', b'BLENDER-v501RENDH')\n"
            "worked(os.symlink, target.folder, 'blendcache_x')\nreturn truth()"
        },
        _RUN,
        Tool("blender_load", {"path": "workspace/x.blend"}),
    ),
    _lie(
        "load-caches-with-links-and-pipes",
        {
            "execute": "write('x.blend', b'BLENDER-v501RENDH')\nos.makedirs('blendcache_x', exist_ok=True)\n"
            "worked(os.symlink, target.file, 'blendcache_x/a')\nworked(os.mkfifo, 'blendcache_x/b')\n"
            "return truth()"
        },
        _RUN,
        Tool("blender_load", {"path": "workspace/x.blend"}),
    ),
    _lie(
        "a-checkpoint-in-the-place-of-a-log",
        {
            "write": "value = truth()\nos.symlink('/proc/self/environ', arguments['path'] + '1')\n"
            "os.rename(arguments['path'] + '1', arguments['path'])\nreturn value"
        },
        _RUN,
        _CHECKPOINT,
    ),
    # With a real Blender: threads of one call that go on in the next.
    *(
        way(
            f"threads-left-behind-while-{what}",
            "ground",
            f"{_RACE}bpy.ops.mesh.primitive_cube_add()\nblind()\nimport glob\n"
            f"worked(os.makedirs, '.loading/x') if not os.path.lexists('.loading') else None\n"
            "race(lambda: [*glob.glob('.*'), *glob.glob('.*/*'), 'kept.blend', '.saved.blend', "
            "'.loading/kept.blend', '.loading'], target.victim, 4)\nNone",
            *tools,
            spoils=True,
            once=True,
        )
        for what, tools in {
            "saving": (_SAVE,),
            "saving-and-loading": (_SAVE_QUICKLY, _LOAD),
            "previewing": (_PREVIEW,),
            "sheets-are-drawn": (_MOTION,),
            "rendering": (
                Tool("blender_render", {"width": 16, "height": 16, "engine": "cycles", "samples": 1}),
            ),
        }.items()
    ),
)
