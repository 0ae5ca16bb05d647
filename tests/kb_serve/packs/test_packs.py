"""Knowledge packs: their size, and that every name in them is in the base."""

from __future__ import annotations

import re
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from click.testing import CliRunner

from kb_build.index.analysis import key
from kb_serve.errors import BadQuery
from kb_serve.packs.changes import Changes, owner_of
from kb_serve.packs.pack import write_pack
from kb_serve.reader import BaseReader
from simworlds.cli import main

TYPES = "bpy.types."
NAME = re.compile(r"`([^`]+)`")
MADE_BY = re.compile(r" \(made by (?:`[^`]+`(?:, then )?)+\)")
CHANGE = re.compile(r"(?P<old>`[^→;]+?) → (?:`(?P<new>[^`]+)`|nothing) \((?P<gone>\d\.\d+)")
_OWNERS = {"classes": "bpy.types", "modules": ""}


def tokens(text: str) -> int:
    from bpe_openai import get_encoding  # half a second, in every process that collects tests

    return len(get_encoding("o200k_base").encode(text))


def sections(pack: str) -> dict[str, list[str]]:
    """Title → the lines of a list in each section."""
    parts = {part.partition("\n")[0]: part.partition("\n")[2] for part in pack.split("\n## ")[1:]}
    return {
        title: [line[2:] for line in text.split("\n") if line.startswith("- ")]
        for title, text in parts.items()
    }


def exists(reader: BaseReader, path: str) -> bool:
    """Whether this Blender has a symbol, a value of an enumeration (a:B) or an argument (a(b))."""
    if reader.entry(path) is not None:
        return True
    owner, colon, value = path.rpartition(":")
    if colon:
        return any(row[:2] == (owner, value) for row in reader.names.enum_owners(key(value)))
    called, _, argument = path.removesuffix(")").partition("(")
    symbol = reader.symbol(called)
    return symbol is not None and argument in {parameter.name for parameter in symbol.parameters}


def full(name: str, owner: str = "") -> str:
    """The path of a name as a pack writes it."""
    if owner and (name[0] in ":(" or re.fullmatch(r'[a-z_0-9]+(\[".*"\])?', name)):
        return owner + ("" if name[0] in ":(" else ".") + name
    is_module = name[0].islower() and not name.startswith(("bpy_struct", "bpy_prop"))
    return name if is_module else TYPES + name


@pytest.mark.parametrize("budget", [2000, 8000, 32000])
def test_a_pack_keeps_its_size_and_uses_it(reader: BaseReader, budget: int) -> None:
    pack = write_pack(reader, budget)
    assert 0.7 * budget <= tokens(pack) <= budget
    assert f"Blender {reader.meta['blender']}" in pack.partition("\n")[0]


def test_every_old_name_is_gone_and_every_new_one_is_there(reader: BaseReader) -> None:
    lines = sections(write_pack(reader, 32000))["Names that are gone"]
    told = 0
    for line in lines:
        owner, _, rest = line.partition(": ")
        owner = _OWNERS[owner] if owner in _OWNERS else full(owner)
        for change in CHANGE.finditer(rest):
            for name in NAME.findall(change["old"]):
                old = owner + ("" if name[0] in ":(" or not owner else ".") + name
                assert reader.history.removed(old) is not None, line
                assert not exists(reader, old), line
                told += 1
            if change["new"]:
                assert exists(reader, full(change["new"], owner)), line
    assert told > 300


def test_every_class_member_default_and_socket_is_there(reader: BaseReader) -> None:
    parts = sections(write_pack(reader, 32000))
    for line in parts["Most used members"]:
        owner, _, rest = line.partition(": ")
        owner = full(NAME.findall(owner)[0])
        names = [name.partition("(")[0] for name in NAME.findall(MADE_BY.sub("", rest))]
        assert names
        assert all(exists(reader, f"{owner}.{name}") for name in names), line
    for line in parts["Real defaults"]:
        owner, _, rest = line.partition(": ")
        assert all(exists(reader, f"{full(owner)}.{name}") for name in NAME.findall(rest)), line
    for line in parts["Sockets of nodes"]:
        node = full(NAME.findall(line)[0])
        for side in re.findall(r'(inputs|outputs) ((?:"[^"]+"[^";]*)+)', line):
            for socket in re.findall(r'"([^"]+)"', side[1]):
                assert exists(reader, f'{node}.{side[0]}["{socket}"]'), (node, socket)


@pytest.mark.parametrize("budget", [2000, 32000])
def test_every_call_and_class_of_the_steps_is_there(reader: BaseReader, budget: int) -> None:
    steps = write_pack(reader, budget).partition("## How it is done")[2].partition("\n## ")[0]
    calls = set(re.findall(r"`(bpy\.ops\.\w+\.\w+)\(", steps))
    classes = set(re.findall(r"→ `(\w+)`", steps)) | set(re.findall(r"\(`(\w+)`\)", steps))
    assert classes
    assert calls
    assert all(exists(reader, call) for call in calls)
    assert all(exists(reader, TYPES + name) for name in classes)


def test_a_name_that_scripts_often_use_comes_before_one_of_the_interface(reader: BaseReader) -> None:
    ranks = {change.old: rank for rank, change in enumerate(Changes(reader).ranked)}
    for often, rarely in (
        ("Action.fcurves", "SpaceDopeSheetEditor.auto_snap"),
        ("Scene.node_tree", "WorkSpace.active_pose_asset_index"),
        ("Mesh.use_auto_smooth", "Brush.gpencil_tool"),
    ):
        assert ranks[TYPES + often] < ranks[TYPES + rarely], often


def test_a_topic_has_its_own_names_and_no_others(reader: BaseReader) -> None:
    pack = write_pack(reader, 8000, "cloth")
    assert "ClothSettings" in pack
    assert "`modifier = obj.modifiers.new(" in pack
    assert "ShaderNodeBsdfPrincipled" not in pack
    assert tokens(pack) <= 8000


@pytest.mark.parametrize(
    ("budget", "topic", "reason"), [(10, "", "500 to 100,000"), (2000, "gardening", "no topic")]
)
def test_what_cannot_be_packed_is_refused(reader: BaseReader, budget: int, topic: str, reason: str) -> None:
    with pytest.raises(BadQuery, match=reason):
        write_pack(reader, budget, topic)


def test_a_topic_of_a_base_without_the_manual_is_refused_with_what_is_missing(
    base: Path, tmp_path: Path
) -> None:
    bare = Path(shutil.copy(base, tmp_path))
    with closing(sqlite3.connect(bare)) as file, file:
        file.execute("DELETE FROM pages WHERE source = 'manual'")
    with (
        closing(BaseReader(bare)) as reader,
        pytest.raises(BadQuery, match=r"built without the manual.*kb info \d.*kb build \d\.\d --manual PATH"),
    ):
        write_pack(reader, 2000, "rigid body")


def test_the_command_writes_a_file_and_refuses_a_version_without_base(base: Path, tmp_path: Path) -> None:
    environment = {"SIMWORLDS_HOME": str(base.parent.parent)}
    target = tmp_path / "rules.md"
    done = CliRunner().invoke(
        main, ["kb", "pack", "--tokens", "2000", "--output", str(target)], env=environment
    )
    assert done.exit_code == 0, done.output
    assert target.read_text(encoding="utf-8").startswith("# Blender ")
    missing = CliRunner().invoke(main, ["kb", "pack", "2.9"], env=environment)
    assert missing.exit_code == 2
    assert "Error: " in missing.output


@pytest.mark.parametrize(
    ("path", "owner"),
    [
        ("bpy.types.Mesh.calc_normals", "bpy.types.Mesh"),
        ("bpy.types.Mesh", "bpy.types"),
        ('bpy.types.ShaderNodeMix.inputs["A.B"]', "bpy.types.ShaderNodeMix"),
        ("bpy.types.Object.type:GPENCIL", "bpy.types.Object.type"),
        ("bpy.ops.mesh.primitive_cube_add(enter)", "bpy.ops.mesh.primitive_cube_add"),
    ],
)
def test_the_owner_of_a_path(path: str, owner: str) -> None:
    assert owner_of(path) == owner
