"""A worker that lies: whatever it replies, the server survives, and touches nothing outside."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from columns import host_for, said
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from way import Tool, way
from whole import IS_WHOLE

if TYPE_CHECKING:
    from attack import Attackers
    from way import Way

pytestmark = pytest.mark.blender

_EXAMPLES = 12 if IS_WHOLE else 2  # of each tool; a reply that ends the worker costs a start
_SAVE = Tool("blender_save", {"name": "kept", "verify": False})
_VERIFY = Tool("blender_verify", {"image": True})
_FILM = Tool("blender_render", {"kind": "animation"})
# Tool of the worker → tools of the server that call it.
_CALLS: dict[str, tuple[Tool, ...]] = {
    "execute": (Tool("blender_execute", {"code": "1"}),),
    "preview": (Tool("blender_scene_layout_preview"),),
    "material_sheet": (Tool("blender_material_preview", {"show": "scene", "width": 64}),),
    "uv_sheet": (Tool("blender_uv_preview"),),
    "motion_sheet": (Tool("blender_motion_sheet_preview", {"actors": ["Cube"]}),),
    "scene_state": (Tool("blender_scene_state"),),
    "render_plan": (_FILM,),
    "render_step": (Tool("blender_render", {"frame": 5}),),
    "render_frame": (_FILM,),
    "render_video": (_FILM,),
    "subject_mask": (Tool("blender_render", {"width": 64, "samples": 1}),),
    "render_put_back": (_FILM,),
    "save": (_SAVE,),
    "inspect": (Tool("blender_save", {"name": "kept"}),),
    "write": (Tool("blender_execute", {"code": "1"}), Tool("blender_save")),
    "open": (Tool("blender_load", {"checkpoint": 1}),),
    "load": (_SAVE, Tool("blender_load", {"path": "kept.blend"})),
    "exchange_formats": (Tool("blender_import"),),
    "export_file": (Tool("blender_export", {"name": "kept.stl", "verify": False}),),
    "import_file": (
        Tool("blender_export", {"name": "kept.stl", "verify": False}),
        Tool("blender_import", {"path": "kept.stl"}),
    ),
    "kept_caches": (Tool("blender_load", {"checkpoint": 1}),),
    "bake": (Tool("blender_bake"),),
    "free_bake": (Tool("blender_bake", {"free": True}),),
    "trial": (Tool("blender_trial", {"frames": 2}),),
    "tag": (Tool("blender_tag_object", {"objects": [{"name": "Cube", "is_object_root": True}]}),),
    "go_to_frame": (_VERIFY,),
    "scene_facts": (_VERIFY,),
    "measure": (_VERIFY,),
    "findings_image": (_VERIFY,),
}
_VALUES = st.sampled_from(
    [
        *(None, True, -1, 0, 7, 2**31, -(2**63), 10**30, 0.5, -1e308, 5e-324, float("inf"), float("nan")),
        *("", ".", "..", "../../x", "/etc/passwd", "a/b", "\0", "\x1b[2J", "\ud800", "x" * 30_000),
        *([], {}, [[]], [[[[[[[[[]]]]]]]]], {"x": 1}, [None] * 2000, ["x" * 900] * 900),
    ]
)
_NUMBERS = st.lists(st.integers(0, 40), max_size=7)
_CHANGES = st.lists(
    st.one_of(
        st.tuples(_NUMBERS, st.just("replace"), _VALUES),
        st.tuples(_NUMBERS, st.just("remove"), st.none()),
        st.tuples(_NUMBERS, st.just("wrap"), st.none()),
        st.tuples(_NUMBERS, st.just("repeat"), st.sampled_from([0, 2, 300, 20_000])),
    ),
    min_size=1,
    max_size=3,
)
_ENVELOPE = """
frame = sys._getframe()
while 'wire' not in frame.f_locals: frame = frame.f_back
wire, ticket = frame.f_locals['wire'], frame.f_locals['request']['ticket']
message = {{'ticket': ticket, 'value': truth(), 'seconds': 0.1, 'left': []}}
if {progress}: message = {{'ticket': ticket, 'progress': [0, 1, 'x']}}
try: wire.send(changed(message, {changes!r}))
except Exception: pass
return truth()
"""
_SIMULATED = (
    "value = truth()\n"
    "value['unbaked'] = [{'kind': 'cloth', 'object': 'c', 'label': 'c', 'start': 1}]\n"
    "return value"
)


def _lying(tool: str, lie: str) -> Way:
    lies = {tool: f"inf, nan = float('inf'), float('nan')\n{lie}"}
    if tool == "render_step":
        lies["render_plan"] = _SIMULATED
    return way(f"lies about {tool}", "replies", *_CALLS[tool], lies=lies, seconds=60.0)


def _explored(check: Any, examples: int, **drawn: Any) -> None:
    explore = settings(
        max_examples=examples,
        derandomize=True,
        deadline=None,
        database=None,
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
    )
    explore(given(**drawn)(check))()


@pytest.mark.parametrize("tool", _CALLS)
def test_an_honest_reply_is_believed(tool: str, attackers: Attackers) -> None:
    """Else it would prove nothing that lies are not."""
    honest = _lying(tool, "return truth()")
    outcome = attackers.carry_out(honest, host_for(attackers, honest, "bubblewrap", "user"))
    assert not outcome.flaws
    assert not outcome.evidence, said(outcome)
    assert not [answer for answer in outcome.answers if "error" in answer], said(outcome)


@pytest.mark.parametrize("tool", _CALLS)
def test_the_server_survives_any_reply(tool: str, attackers: Attackers) -> None:
    def check(changes: list[Any]) -> None:
        lying = _lying(tool, f"return changed(truth(), {changes!r})")
        outcome = attackers.carry_out(lying, host_for(attackers, lying, "bubblewrap", "user"))
        assert not outcome.flaws
        assert not outcome.evidence, said(outcome)

    _explored(check, _EXAMPLES, changes=_CHANGES)


def test_the_server_survives_any_message(attackers: Attackers) -> None:
    def check(changes: list[Any], progress: bool) -> None:
        lying = _lying("preview", _ENVELOPE.format(changes=changes, progress=progress))
        outcome = attackers.carry_out(lying, host_for(attackers, lying, "bubblewrap", "user"))
        assert not outcome.flaws
        assert not outcome.evidence, said(outcome)

    _explored(check, 4 * _EXAMPLES, changes=_CHANGES, progress=st.booleans())


@pytest.mark.parametrize(
    ("lie", "told"),
    [
        ("while True: time.sleep(9)", "deadline"),
        ("while True: report(0, None, 'x' * 9999)", "deadline"),
        ("os._exit(0)", "exit code 0"),
        ("os.close(200); time.sleep(9)", "channel|deadline|ended"),
        ("return {**truth(), 'views': 'none'}", "not a valid reply"),
    ],
    ids=["silence", "a flood of progress", "its end", "a closed channel", "a false reply"],
)
def test_the_server_says_what_the_worker_did(lie: str, told: str, attackers: Attackers) -> None:
    tool = Tool("blender_scene_layout_preview", {"timeout": 1})
    lying = way("lies", "replies", tool, lies={"preview": lie}, seconds=60.0)
    outcome = attackers.carry_out(lying, host_for(attackers, lying, "bubblewrap", "user"))
    assert not outcome.evidence, said(outcome)
    assert "A new Blender was started" in outcome.answers[0]["message"]
    assert any(word in outcome.answers[0]["message"] for word in told.split("|"))
