"""Ways to lead the server astray by what a reply says: sizes, numbers, names, amounts, steps. A liar answers."""

from __future__ import annotations

from way import Tool, Way, way

_RENDER = Tool("blender_render")
_FILM = Tool("blender_render", {"kind": "animation"})
_FAR = Tool("blender_render", {"frame": 200})
_PREVIEW = Tool("blender_scene_layout_preview")
_MOTION = Tool("blender_motion_sheet_preview", {"actors": ["Cube"]})
_SAVE = Tool("blender_save", {"name": "kept", "verify": False})
_LOAD = Tool("blender_load", {"path": "kept.blend"})
_RUN = Tool("blender_execute", {"code": "1"})
_BAKE = Tool("blender_bake")
_STATE = Tool("blender_scene_state")
_TAG = Tool("blender_tag_object", {"objects": [{"name": "Cube", "is_object_root": True}]})
_VERIFY = Tool("blender_verify", {"image": True})


def _lie(name: str, tool: str, change: str, *calls: Tool, **more: object) -> Way:
    """A way that changes the true ``value`` of a tool."""
    return way(
        name, "replies", *calls, lies={tool: f"value = truth()\n{change}\nreturn value"}, once=True, **more
    )


def _view(name: str, change: str, **more: object) -> Way:
    return _lie(f"a-view-with-{name}", "preview", f"view = value['views'][0]\n{change}", _PREVIEW, **more)


def _plan(name: str, change: str, *calls: Tool, **more: object) -> Way:
    return _lie(f"a-plan-with-{name}", "render_plan", change, *(calls or (_RENDER,)), **more)


_UNBAKED = "value['unbaked'] = [{'kind': 'cloth', 'object': 'Cube', 'label': 'cloth', 'start': 1}]"


def _step(name: str, step: str, **more: object) -> Way:
    lies = {"render_plan": f"value = truth()\n{_UNBAKED}\nreturn value", "render_step": step}
    return way(f"steps-that-{name}", "replies deadline", _FAR, lies=lies, once=True, **more)


WAYS = (
    _view("a-huge-size", "view['size'] = [30_000, 30_000]", must_fail=True),
    _view("no-size", "view['size'] = [0, 0]", must_fail=True),
    _view("a-negative-size", "view['size'] = [-5, 384]", must_fail=True),
    _view("an-endless-size", "view['size'] = [1e308, 1e308]", must_fail=True),
    _view("one-long-side", "view['size'] = [1_000_000, 1]", must_fail=True),
    _view("no-number-for-a-ground", "view['ground'] = float('nan')", must_fail=True),
    _view("an-endless-ground", "view['ground'] = float('inf')", must_fail=True),
    _view("a-tiny-scale", "view['metres_per_pixel'] = 5e-324"),
    _view("a-huge-scale", "view['metres_per_pixel'] = 1e308"),
    _view("no-number-for-a-scale", "view['metres_per_pixel'] = float('nan')", must_fail=True),
    _view("a-negative-scale", "view['metres_per_pixel'] = -1.0", must_fail=True),
    _view("labels-far-away", "view['labels'] = [['Cube', 1e15, -1e15]]"),
    _view("endless-labels", "view['labels'] = [['Cube', float('inf'), float('nan')]]", must_fail=True),
    _view("many-labels", "view['labels'] = [['Cube', 1.0, 1.0]] * 100_000", must_fail=True),
    _view("a-long-label", "view['labels'] = [['x' * 5_000_000, 1.0, 1.0]]", must_fail=True),
    _view("a-name-of-escapes", "view['name'] = '\\x1b]0;x\\x07' * 20\nview['cut_away'] = ['\\x1b[2J']"),
    _view("many-pieces-cut-away", "view['cut_away'] = ['x' * 1000] * 9000"),
    _view("axes-that-point-nowhere", "view['axes'] = [['X', 1e300, 1e300, 1e300]]", must_fail=True),
    _view("many-axes", "view['axes'] *= 100_000", must_fail=True),
    _lie("a-preview-without-views", "preview", "value['views'] = []", _PREVIEW, must_fail=True),
    _lie("a-preview-with-many-views", "preview", "value['views'] *= 5000", _PREVIEW, must_fail=True),
    _lie(
        "a-preview-of-endless-extent",
        "preview",
        "value['low'] = [-1e308] * 3\nvalue['high'] = [1e308] * 3",
        _PREVIEW,
    ),
    _lie(
        "a-preview-turned-inside-out",
        "preview",
        "value['low'], value['high'] = value['high'], value['low']",
        _PREVIEW,
    ),
    _lie(
        "a-preview-with-a-title-for-a-path",
        "preview",
        "value['title'] = '../../' + target.mark + '/x'",
        _PREVIEW,
    ),
    _lie(
        "a-preview-with-a-frame-for-a-path",
        "preview",
        "value['frame'] = '../../' + target.mark",
        _PREVIEW,
        must_fail=True,
    ),
    _lie("a-preview-with-a-huge-frame", "preview", "value['frame'] = 10 ** 4000", _PREVIEW, must_fail=True),
    _lie("a-preview-with-many-notes", "preview", "value['notes'] = ['x' * 9000] * 900", _PREVIEW),
    _lie(
        "a-preview-with-a-note-of-surrogates",
        "preview",
        "value['notes'] = ['\\ud800', '\\0', '\\u202e']",
        _PREVIEW,
    ),
    _lie("a-preview-that-is-a-list", "preview", "value = [value]", _PREVIEW, must_fail=True),
    _lie("a-preview-that-is-nothing", "preview", "value = None", _PREVIEW, must_fail=True),
    # Rendering.
    _plan("a-huge-width", "value['shot']['width'] = 10 ** 9", must_fail=True),
    _plan("no-height", "value['shot']['height'] = 0", must_fail=True),
    _plan("a-negative-rate", "value['fps'] = -24", _FILM, must_fail=True),
    _plan("no-rate", "value['fps'], value['fps_base'] = 0, 0.0", _FILM, must_fail=True),
    _plan("frames-without-end", "value['frame_end'] = 10 ** 12", _FILM, must_fail=True),
    _plan(
        "fifty-thousand-frames",
        "value['frame_end'] = 49_000",
        Tool("blender_render", {"kind": "animation", "time_budget": 2}),
        seconds=120.0,
    ),
    _plan("frames-backwards", "value['frame_start'], value['frame_end'] = 5, 1", _FILM, must_fail=True),
    _plan("a-frame-that-is-a-text", "value['current'] = '../../x'", must_fail=True),
    _plan("no-number-for-a-part-of-a-frame", "value['subframe'] = float('nan')", must_fail=True),
    _plan("a-start-long-ago", f"{_UNBAKED}\nvalue['unbaked'][0]['start'] = -10 ** 12", must_fail=True),
    _plan("very-many-simulations", f"{_UNBAKED}\nvalue['unbaked'] *= 100_000", must_fail=True),
    _plan("very-many-digests", "value['scene'] = {str(n): 'x' for n in range(300_000)}", must_fail=True),
    _plan("digests-for-paths", "value['scene'] = {'../../' + target.mark: '/etc/passwd'}", _FILM),
    _plan("digests-that-change", "value['scene'] = {'Scene': os.urandom(9).hex()}", _FILM, _FILM),
    _plan("a-camera-of-escapes", "value['shot']['camera'] = '\\x1b]0;x\\x07' * 50"),
    _plan(
        "samples-without-end",
        "value['shot']['samples'] = 10 ** 18",
        Tool("blender_render", {"time_budget": 2}),
        must_fail=True,
    ),
    _plan(
        "no-samples",
        "value['shot']['samples'] = 0",
        Tool("blender_render", {"time_budget": 2}),
        must_fail=True,
    ),
    _step("never-advance", "return arguments['first'] - 1", seconds=45.0, must_fail=True),
    _step("go-back", "return -10 ** 9", seconds=45.0, must_fail=True),
    _step("leap", "return 10 ** 12", must_fail=True),
    _step("are-not-whole", "return arguments['first'] + 0.5", must_fail=True),
    _step("are-no-number", "return float('nan')", must_fail=True),
    _step("are-a-truth", "return True", must_fail=True),
    _step("advance-by-one", "return arguments['first']", seconds=90.0),
    _lie("a-film-with-other-frames", "render_video", "value['frames'] = 10 ** 15", _FILM),
    _lie("a-film-with-no-rate", "render_video", "value['fps'] = 0.0", _FILM),
    _lie("a-film-without-an-end", "render_video", "value['seconds'] = float('inf')", _FILM),
    _lie("a-frame-that-takes-forever", "render_frame", "value = 1e308", _FILM),
    _lie("a-frame-that-is-not-there", "render_frame", "os.unlink(arguments['path'])", _FILM),
    # Motion.
    _lie(
        "a-motion-of-huge-tiles",
        "motion_sheet",
        "value['actors'][0]['views'][0]['pictures'][0]['view']['size'] = [2048, 2048]",
        _MOTION,
    ),
    _lie(
        "a-motion-of-very-huge-tiles",
        "motion_sheet",
        "value['actors'][0]['views'][0]['pictures'][0]['view']['size'] = [60_000, 60_000]",
        _MOTION,
        must_fail=True,
    ),
    _lie("a-motion-of-many-actors", "motion_sheet", "value['actors'] *= 5000", _MOTION, must_fail=True),
    _lie(
        "a-motion-of-many-frames",
        "motion_sheet",
        "value['actors'][0]['frames'] = list(range(1_000_000))",
        _MOTION,
        must_fail=True,
    ),
    _lie(
        "a-motion-that-disagrees-with-itself",
        "motion_sheet",
        "value['actors'][0]['centres'] = []\nvalue['actors'][0]['speeds'] = []",
        _MOTION,
    ),
    _lie(
        "a-motion-of-endless-range",
        "motion_sheet",
        "value['actors'][0]['displacements'] = [1e308, -1e308]\n"
        "value['actors'][0]['speeds'] = [1e308, 5e-324]",
        _MOTION,
    ),
    _lie(
        "a-motion-backwards", "motion_sheet", "value['start'], value['end'] = 1_000_000, -1_000_000", _MOTION
    ),
    _lie(
        "a-motion-of-many-frames-between",
        "motion_sheet",
        "value['start'], value['end'] = -1_000_000, 1_000_000",
        _MOTION,
    ),
    _lie(
        "a-motion-of-many-phases",
        "motion_sheet",
        "value['actors'][0]['phases'] *= 100_000",
        _MOTION,
        must_fail=True,
    ),
    _lie(
        "a-motion-of-many-contacts",
        "motion_sheet",
        "value['actors'][0]['phases'][0]['contacts'] = [{'with': 'x' * 900, 'frames': [[1, 2]] * "
        "50, 'gap': 0.0}] * 1900",
        _MOTION,
    ),
    _lie(
        "a-motion-with-a-kind-for-a-path",
        "motion_sheet",
        "value['actors'][0]['views'][0]['kind'] = '../../x'",
        _MOTION,
        must_fail=True,
    ),
    _lie(
        "a-motion-with-a-frame-for-a-path",
        "motion_sheet",
        "value['actors'][0]['views'][0]['pictures'][0]['frame'] = '../../x'",
        _MOTION,
        must_fail=True,
    ),
    _lie(
        "a-motion-with-a-flat-view",
        "motion_sheet",
        "value['actors'][0]['views'][0]['pictures'][0]['view']['axes'] = [[0.0] * 3] * 3",
        _MOTION,
    ),
    _lie(
        "a-motion-with-a-tiny-scale",
        "motion_sheet",
        "value['actors'][0]['views'][0]['pictures'][0]['view']['metres_per_pixel'] = 5e-324",
        _MOTION,
    ),
    # Saving and loading.
    _lie("a-save-with-many-files", "save", "value['files'] = [['a', 'b']] * 700_000", _SAVE, must_fail=True),
    _lie("a-save-of-negative-size", "save", "value['bytes'] = -1", _SAVE, must_fail=True),
    _lie("a-save-with-escapes", "save", "value['packed'] = ['\\x1b[2J'] * 20", _SAVE),
    _lie(
        "a-save-with-a-cache-of-endless-range",
        "save",
        "value['caches'] = [{'label': 'c', 'baked': True, 'outdated': False, 'range': [-10 ** "
        "30, 10 ** 30], 'where': 'disk', 'frames': 10 ** 30, 'missing': 0}]",
        _SAVE,
    ),
    _lie("a-load-with-a-long-version", "load", "value['version'] = '5.' * 3_000_000", _SAVE, _LOAD),
    _lie(
        "a-load-with-many-files",
        "load",
        "value['external'] = [{'what': 'x' * 900, 'path': 'y' * 4000, 'missing': True}] * 3000",
        _SAVE,
        _LOAD,
    ),
    _lie("a-checkpoint-that-took-forever", "write", "value['seconds'] = 1e308", _RUN, _RUN),
    _lie("a-checkpoint-that-took-less-than-nothing", "write", "value['seconds'] = -1e308", _RUN, _RUN),
    _lie("a-checkpoint-that-says-nothing", "write", "value = None", _RUN),
    _lie("an-opened-file-that-says-nothing", "open", "value = [[[]]]", _RUN),
    # The rest.
    _lie(
        "an-execution-with-many-changes",
        "execute",
        "value['changed'] = {str(n): {'added': ['x'] * 9} for n in range(90_000)}",
        _RUN,
    ),
    _lie("an-execution-with-a-long-value", "execute", "value['value'] = 'x' * 15_000_000", _RUN),
    _lie(
        "an-execution-with-a-long-query",
        "execute",
        "value['error'] = {'type': 'E', 'message': 'm', 'line': 10 ** 300, 'source': '', "
        "'traceback': '', 'ask': 'a.' * 9000, 'there': ['x' * 9000] * 90}",
        _RUN,
    ),
    _lie("a-state-of-many-objects", "scene_state", "value['objects'] *= 60_000", _STATE, seconds=120.0),
    _lie(
        "a-state-of-other-shapes",
        "scene_state",
        "value['objects'] = {'a': 1}\nvalue['collections'] = 7",
        _STATE,
    ),
    _lie(
        "a-state-of-deep-collections",
        "scene_state",
        "value['collections'] = [{**value['collections'][0], 'depth': n} for n in range(20_000)]",
        _STATE,
        seconds=120.0,
    ),
    _lie(
        "a-state-of-endless-numbers",
        "scene_state",
        "value['objects'][0]['location'] = [float('inf'), float('nan'), 10 ** 400]",
        _STATE,
    ),
    _lie(
        "a-state-of-nested-lists",
        "scene_state",
        "deep = []\nfor _ in range(900): deep = [deep]\nvalue['notes'] = deep",
        _STATE,
    ),
    _lie(
        "tags-of-other-shapes",
        "tag",
        "value = {'collections': 3, 'objects': [], 'scene': None, 'warnings': {}}",
        _TAG,
    ),
    _lie(
        "a-bake-of-other-shapes",
        "bake",
        "value = {'caches': [{}], 'range': [1], 'seconds': 'x', 'notes': 3}",
        _BAKE,
    ),
    _lie(
        "a-bake-of-many-caches",
        "bake",
        "value['caches'] = [{'label': 'x' * 200, 'fault': 'y' * 200}] * 60_000",
        _BAKE,
        seconds=120.0,
    ),
    _lie(
        "facts-of-many-objects",
        "scene_facts",
        "value['objects'] = [{'name': f'o{n}', 'type': 'EMPTY', 'data': None, 'collections': "
        "['Scene Collection'], 'parent': None, 'is_root': False, 'contact_with': [],"
        " 'modifiers': [], 'constraints': [], 'rigid_body': None, 'keys': {}, "
        "'animated_shape_keys': False, 'drivers': 0, 'driven': [], 'evaluated': True, "
        "'rendered': True,"
        " 'scale': [1.0] * 3, 'matrix': [1.0] * 16, 'polygons': 0, 'surface': False} for n in range(9000)]",
        _VERIFY,
        seconds=150.0,
    ),
    _lie(
        "facts-of-a-family-without-end",
        "scene_facts",
        "value['objects'] = [{'name': f'o{n}', 'type': 'EMPTY', 'data': None, 'collections': "
        "['Scene Collection'], 'parent': f'o{(n + 1) % 50}', 'is_root': False, 'contact_with': [],"
        " 'modifiers': [], 'constraints': [], 'rigid_body': None, 'keys': {}, "
        "'animated_shape_keys': False, 'drivers': 0, 'driven': [], 'evaluated': True, "
        "'rendered': True,"
        " 'scale': [1.0] * 3, 'matrix': [1.0] * 16, 'polygons': 0, 'surface': False} for n in range(50)]",
        _VERIFY,
    ),
    _lie(
        "findings-with-marks-far-away",
        "findings_image",
        "value['views'][0]['marks'] = [[1e15, -1e15]] * 200",
        _VERIFY,
    ),
    _lie(
        "a-place-in-time-that-is-none",
        "go_to_frame",
        "value = {'scene': 'x' * 9_000_000, 'frame': float('inf')}",
        _VERIFY,
    ),
)
