"""Names in every spelling: whoever types one gets exactly that symbol first.

The cases are samples of what the base holds, not hand-picked queries.
"""

from __future__ import annotations

import random
from collections import Counter, defaultdict
from typing import TYPE_CHECKING

import pytest
from asking import (
    SEED,
    TYPES,
    camel,
    classes,
    first_id,
    misspelt,
    of_data,
    owner_and_name,
    paths,
    spaced,
    wrong,
)
from whole import examples

from kb_build.index.analysis import key
from kb_build.schema import FORM_SHORT
from kb_build.symbols.lines import written as as_written
from kb_build.symbols.paths import as_code, plain_path

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader

KINDS = ("module", "class", "property", "function", "operator", "socket", "data", "context", "enum")


@pytest.mark.parametrize("kind", KINDS)
def test_a_full_path_is_that_symbol_and_its_whole_answer(
    kb: KnowledgeBase, reader: BaseReader, kind: str
) -> None:
    sample = paths(reader, kind)
    assert len(sample) > examples(100)
    for path in sample:
        answer = kb.query(path)
        assert (answer.kind, answer.hits[0].id, answer.hits[0].kind) == ("schema", path, kind)
        symbol = reader.symbol(path)
        assert symbol is not None
        assert f"`{as_written(symbol)}`" in answer.text


@pytest.mark.parametrize("around", ["`{}`", "'{}'", '"{}"', " {} ", "{}?", "{}.", "{}:", "{},", "\n{}\n"])
def test_punctuation_around_a_name_does_not_matter(
    kb: KnowledgeBase, reader: BaseReader, around: str
) -> None:
    sample = of_data(reader, "property", examples(60)) + paths(reader, "operator", examples(60))
    assert wrong(kb, [(around.format(path), path) for path in sample]) == []


@pytest.mark.parametrize(
    "arguments", ["()", "(a, b=1)", '(type="X", size=(1, 2))', "('INVOKE_DEFAULT')", "(f(x), [1])"]
)
def test_a_call_is_the_function_or_operator_called(
    kb: KnowledgeBase, reader: BaseReader, arguments: str
) -> None:
    sample = of_data(reader, "function", examples(100)) + paths(reader, "operator", examples(100))
    sample += paths(reader, "function", examples(100), "path NOT LIKE 'bpy.%'")
    assert wrong(kb, [(path + arguments, path) for path in sample]) == []


def only(reader: BaseReader, spelled: str) -> bool:
    """Whether nothing else has these letters: ``Annotation layers`` may be AnnotationLayers too."""
    return (
        len({identifier for form, identifier in reader.names.by_key(key(spelled)) if form <= FORM_SHORT}) == 1
    )


DOTTED = {
    "without prefix",
    "types. only",
    "class in words",
    "name in words",
    "camel case",
    "arrow",
    "double colon",
}
SPELLINGS = {
    "without prefix": lambda owner, name: f"{owner}.{name}",
    "types. only": lambda owner, name: f"types.{owner}.{name}",
    "class in words": lambda owner, name: f"{spaced(owner)}.{name}",
    "name in words": lambda owner, name: f"{owner}.{name.replace('_', ' ')}",
    "camel case": lambda owner, name: f"{owner}.{camel(name)}",
    "small letters": lambda owner, name: f"bpy.types.{owner}.{name}".lower(),
    "capitals": lambda owner, name: f"{owner}.{name}".upper(),
    "side by side": lambda owner, name: f"{owner} {name}",
    "arrow": lambda owner, name: f"{owner}->{name}",
    "double colon": lambda owner, name: f"{owner}::{name}",
    "hash": lambda owner, name: f"{owner}#{name}",
}


@pytest.mark.parametrize("spelling", SPELLINGS)
@pytest.mark.parametrize("kind", ["property", "function"])
def test_a_member_is_found_in_every_usual_spelling(
    kb: KnowledgeBase, reader: BaseReader, kind: str, spelling: str
) -> None:
    cases = [(SPELLINGS[spelling](*owner_and_name(path)), path) for path in of_data(reader, kind)]
    clear = [
        case for case in cases if only(reader, case[0]) or (spelling in DOTTED and not case[0].isupper())
    ]
    assert len(clear) > examples(250)
    assert wrong(kb, clear) == []


@pytest.mark.parametrize(
    "spell",
    [
        lambda name: name,
        lambda name: f"types.{name}",
        spaced,
        str.upper,
        lambda name: f"bpy.types.{name}".lower(),
    ],
    ids=["without prefix", "types. only", "in words", "capitals", "small letters"],
)
def test_a_class_is_found_in_every_usual_spelling(
    kb: KnowledgeBase, reader: BaseReader, spell: object
) -> None:
    assert callable(spell)
    modules = {path.rpartition(".")[2] for path in paths(reader, "module", 1_000)}
    cases = [(spell(path.removeprefix(TYPES)), path) for path in classes(reader)]
    # ``SCENE`` may be the module of operators too.
    assert (
        wrong(kb, [case for case in cases if case[0].lower() not in modules or case[0][1:2].islower()]) == []
    )


@pytest.mark.parametrize("group", ["ui"])
def test_a_panel_or_menu_is_found_by_its_name(kb: KnowledgeBase, reader: BaseReader, group: str) -> None:
    assert wrong(kb, [(path.removeprefix(TYPES), path) for path in classes(reader, group)]) == []


OPERATOR_SPELLINGS = {
    "without prefix": lambda path, target: path.removeprefix("bpy.ops."),
    "ops. only": lambda path, target: path.removeprefix("bpy."),
    "class": lambda path, target: target,
    "class with prefix": lambda path, target: f"bpy.types.{target}",
    "class in small letters": lambda path, target: target.lower(),
    "asked for its poll": lambda path, target: f"{path}.poll()",
    "assigned": lambda path, target: f"result = {path}(x=1)",
    "in a sentence": lambda path, target: f"Please run {path} with the right arguments",
}


@pytest.mark.parametrize("spelling", OPERATOR_SPELLINGS)
def test_an_operator_is_found_by_its_call_and_by_its_class(
    kb: KnowledgeBase, reader: BaseReader, spelling: str
) -> None:
    registered = set(classes(reader, "operator", 1_000))
    cases: list[tuple[str, str]] = []
    for path in paths(reader, "operator"):
        entry = reader.entry(path)
        assert entry is not None
        query = OPERATOR_SPELLINGS[spelling](path, entry.target)
        module, _, name = query.partition(".")
        if query not in registered and not reader.entry(f"{TYPES}{module.title()}.{name}"):
            cases.append((query, path))
    assert len(cases) > examples(200)
    assert wrong(kb, cases) == []


@pytest.mark.parametrize("form", ["{}", "{}.default_value", "{}.default_value = 0.5", "node.{}"])
def test_a_socket_is_found_by_class_and_name(kb: KnowledgeBase, reader: BaseReader, form: str) -> None:
    cases: list[tuple[str, str]] = []
    for path in paths(reader, "socket", examples(150)):
        entry = reader.entry(path)
        assert entry is not None
        valued = reader.entry(f"{TYPES}{entry.target}.default_value") is not None
        if form == "{}":
            cases += [(path.removeprefix(TYPES), path), (path.replace('"', "'"), path)]
        elif form.startswith("{}") and valued:
            cases.append((form.format(path.removeprefix(TYPES)), path))
    assert wrong(kb, cases) == []


def test_context_and_data_are_abbreviated_as_in_blenders_console(
    kb: KnowledgeBase, reader: BaseReader
) -> None:
    cases: list[tuple[str, str]] = []
    for path in paths(reader, "context", where="owner = 'bpy.context'"):
        name = path.rpartition(".")[2]
        cases += [(f"C.{name}", path), (f"context.{name}", path), (path, path)]
    for entry in reader.members("bpy.types.BlendData").values():
        if entry.kind == "property":
            cases += [(f"D.{entry.name}", entry.path), (f"bpy.data.{entry.name}", entry.path)]
    assert len(cases) > examples(400)
    assert wrong(kb, cases) == []


def test_inherited_members_resolve_to_their_own_class(kb: KnowledgeBase, reader: BaseReader) -> None:
    chance = random.Random(SEED)
    cases: list[tuple[str, str]] = []
    for path in classes(reader, count=examples(400)):
        own = reader.members(path)
        inherited: dict[str, str] = {}
        for ancestor in [entry.path for entry in reader.lineage(path)][1:-1]:
            for name, member in reader.members(ancestor).items():
                if name not in own and member.kind in {"property", "function"}:
                    inherited.setdefault(name, member.path)
        if inherited:
            name = chance.choice(sorted(inherited))
            cases += [
                (f"{path}.{name}", inherited[name]),
                (f"{path.removeprefix(TYPES)}.{name}", inherited[name]),
            ]
    assert len(cases) > examples(300)
    assert wrong(kb, cases) == []


def test_names_with_one_key_are_told_apart_by_spelling(kb: KnowledgeBase) -> None:
    for name, path in (
        ("BlendDataMovieClips", "bpy.types.BlendDataMovieClips"),
        ("BlendData.movieclips", "bpy.types.BlendData.movieclips"),
        ("blf.rotation(1)", "blf.rotation"),
        ("blf.ROTATION", "blf.ROTATION"),
        ("view_layers", "bpy.types.Scene.view_layers"),
        ("ViewLayers", "bpy.types.ViewLayers"),
        ("mathutils.Matrix.identity()", "mathutils.Matrix.identity"),
        ("mathutils.Matrix.Identity(4)", "mathutils.Matrix.Identity"),
    ):
        assert kb.query(name).hits[0].id == path


@pytest.mark.parametrize(
    ("query", "first"),
    [
        ("ShaderNodeTexNoise noise_dimensions default", "bpy.types.ShaderNodeTexNoise.noise_dimensions"),
        ("SoftBodySettings goal_default range", "bpy.types.SoftBodySettings.goal_default"),
        ("how the mass of a RigidBodyObject is set", "bpy.types.RigidBodyObject"),
    ],
)
def test_a_member_beside_its_class_comes_first_unless_it_may_be_a_word(
    kb: KnowledgeBase, query: str, first: str
) -> None:
    assert first_id(kb.query(query)) == first


def test_a_value_that_people_write_so_too_is_one_where_its_property_is_named(kb: KnowledgeBase) -> None:
    target = "bpy.types.ShaderNodeOutputMaterial.target"
    assert first_id(kb.query("EEVEE material")) != target
    assert first_id(kb.query("target EEVEE of the material output")) == target
    assert first_id(kb.query("render_type HALO particles")) == "bpy.types.ParticleSettings.render_type"


# A name without its owner


def unique_names(reader: BaseReader) -> list[tuple[str, str]]:
    """(name, path) of members whose name, of several words, nothing else has."""
    counts = Counter(row[0] for row in reader.rows("SELECT name FROM symbols"))
    found = [(path.rpartition(".")[2], path) for path in of_data(reader, "property", 5_000)]
    return [(name, path) for name, path in found if counts[name] == 1 and "_" in name][: examples(200)]


@pytest.mark.parametrize("sentence", ["{}", "what does {} do?", "the `{}` setting", "x.{} = 1"])
def test_a_name_that_only_one_symbol_has_is_that_symbol(
    kb: KnowledgeBase, reader: BaseReader, sentence: str
) -> None:
    assert wrong(kb, [(sentence.format(name), path) for name, path in unique_names(reader)]) == []


def test_a_label_that_only_one_symbol_has_leads_there(kb: KnowledgeBase, reader: BaseReader) -> None:
    counts = Counter(row[0].lower() for row in reader.rows("SELECT label FROM symbols"))
    cases: list[tuple[str, str]] = []
    for path in of_data(reader, "property", 3_000) + paths(reader, "operator", 2_500):
        entry = reader.entry(path)
        if (
            entry
            and entry.label.replace(" ", "").isalpha()
            and " " in entry.label
            and counts[entry.label.lower()] == 1
        ):
            cases.append((entry.label, path))
    cases = cases[:: 3000 // examples(300)]
    assert len(cases) > examples(100)
    assert len(wrong(kb, cases, within=5)) <= 0.02 * len(cases)


# Misspellings


@pytest.mark.parametrize("prefix", [TYPES, ""])
def test_a_misspelt_member_is_corrected_with_a_note(
    kb: KnowledgeBase, reader: BaseReader, prefix: str
) -> None:
    chance = random.Random(SEED)
    checked = 0
    for path in of_data(reader, "property"):
        owner, name = owner_and_name(path)
        if len(name) >= 10:
            written = misspelt(name, chance)
            answer = kb.query(f"{prefix}{owner}.{written}")
            assert answer.hits[0].id == path, written
            # A slip may give another word, which is not read as the name, but told to be close to it.
            told = (f"`{written}` does not exist; read as `{name}`", f"Closest: `{path}`")
            said = any(part in note for note in answer.notes for part in told)
            assert said or key(written) == key(name)  # another spelling is no mistake
            checked += 1
    assert checked > examples(100)


def test_a_misspelt_class_is_corrected(kb: KnowledgeBase, reader: BaseReader) -> None:
    chance = random.Random(SEED)
    cases = [
        (f"{misspelt(owner, chance)}.{name}", path)
        for path in of_data(reader, "property", examples(400))
        for owner, name in [owner_and_name(path)]
        if len(owner) >= 12 and not owner.startswith(("NodeTreeInterface", "NodeSocket", "FunctionNode"))
    ]
    assert len(cases) > examples(150)
    assert len(wrong(kb, cases)) <= 0.03 * len(cases)


def test_a_misspelt_operator_is_corrected(kb: KnowledgeBase, reader: BaseReader) -> None:
    chance = random.Random(SEED)
    cases: list[tuple[str, str]] = []
    for path in paths(reader, "operator"):
        module, _, name = path.rpartition(".")
        if len(name) >= 10:
            cases.append((f"{module}.{misspelt(name, chance)}()", path))
    assert len(cases) > examples(150)
    assert len(wrong(kb, cases)) <= 0.01 * len(cases)


def test_a_misspelt_lone_name_is_corrected(kb: KnowledgeBase, reader: BaseReader) -> None:
    chance = random.Random(SEED)
    cases = [(misspelt(name, chance), path) for name, path in unique_names(reader) if len(name) >= 12]
    assert len(cases) > examples(50)
    assert len(wrong(kb, cases)) <= 0.04 * len(cases)  # some slips make another word: ``swap`` of ``snap``


def test_a_lone_name_is_said_to_be_none_only_if_it_is_none(kb: KnowledgeBase, reader: BaseReader) -> None:
    rows = reader.rows("SELECT DISTINCT name FROM symbols WHERE name LIKE '%\\_%' ESCAPE '\\'")
    names = [name for (name,) in rows if name.isidentifier() and not name.isupper()]
    for name in random.Random(SEED).sample(names, examples(100)):
        turned = "_".join(reversed(name.split("_"))).strip("_")
        is_none = not reader.names.by_key(key(turned)) and not turned.isupper() and "_" in turned
        # What is none, or a part of another name, is read as words, not as a name.
        is_none = is_none and turned.isidentifier() and not reader.names.is_written(turned)
        for written, expected in ((name, False), (turned, is_none)):
            answer = kb.query(written, max_tokens=200)
            said = any(note.startswith(f"Nothing is called `{written}`") for note in answer.notes)
            assert said <= expected, (written, answer.notes)
            assert said or not expected or answer.notes, written


@pytest.mark.parametrize(
    ("query", "path"),
    [
        ("2d_pack_box", "mathutils.geometry.box_pack_2d"),
        ("2d_circle_draw", "gpu_extras.presets.draw_circle_2d"),
        ("75_undistorted_build", "bpy.types.MovieClipProxy.build_undistorted_75"),
    ],
)
def test_what_can_be_no_name_is_found_by_its_words(kb: KnowledgeBase, query: str, path: str) -> None:
    answer = kb.query(query)
    assert path in [hit.id for hit in answer.hits[:3]]
    assert answer.notes == ()


def test_a_right_name_is_not_corrected(kb: KnowledgeBase, reader: BaseReader) -> None:
    for path in (
        of_data(reader, "property", examples(200))
        + paths(reader, "operator", examples(100))
        + paths(reader, "class", examples(100))
    ):
        assert kb.query(path).notes == ()


# Enumerations


def enum_items(reader: BaseReader) -> list[tuple[str, str]]:
    """(item, owner) of items that only one enumeration has."""
    owners: dict[str, set[str]] = defaultdict(set)
    for owner, item in reader.rows("SELECT owner, identifier FROM enum_items ORDER BY owner"):
        owners[item].add(owner.partition("(")[0])
    named = {row[0].upper() for row in reader.rows("SELECT name FROM symbols")}
    found = [
        (item, next(iter(of)))
        for item, of in owners.items()
        if len(of) == 1 and len(item) > 6 and "_" in item and item.isupper() and item not in named
    ]
    found = [
        (item, owner)
        for item, owner in found
        if (entry := reader.entry(owner)) and not _of_ui(reader, entry.owner)
    ]
    return random.Random(SEED).sample(found, examples(250))


def _of_ui(reader: BaseReader, owner: str) -> bool:
    entry = reader.entry(owner)
    return entry is not None and entry.group in {"ui", "operator"}


@pytest.mark.parametrize("form", ["{}", "'{}'", '"{}"', "{}?"])
def test_an_enum_item_leads_to_its_property(kb: KnowledgeBase, reader: BaseReader, form: str) -> None:
    assert wrong(kb, [(form.format(item), owner) for item, owner in enum_items(reader)]) == []


def test_an_item_assigned_leads_to_the_property_assigned(kb: KnowledgeBase, reader: BaseReader) -> None:
    cases: list[tuple[str, str]] = []
    for item, owner in enum_items(reader):
        entry = reader.entry(owner)
        if entry and entry.kind == "property":
            cases.append((f"{owner.removeprefix(TYPES)} = '{item}'", owner))
    assert len(cases) > examples(50)
    assert wrong(kb, cases) == []


# Error messages


def test_an_attribute_error_leads_to_the_attribute_that_was_meant(
    kb: KnowledgeBase, reader: BaseReader
) -> None:
    chance = random.Random(SEED)
    cases: list[tuple[str, str]] = []
    for path in of_data(reader, "property"):
        owner, name = owner_and_name(path)
        if len(name) >= 10:
            written = misspelt(name, chance)
            if written not in reader.members(TYPES + owner):
                cases.append((f"AttributeError: '{owner}' object has no attribute '{written}'", path))
    assert len(cases) > examples(100)
    assert wrong(kb, cases, within=5) == []


def test_an_enum_error_leads_to_the_property_with_those_items(kb: KnowledgeBase, reader: BaseReader) -> None:
    checked: list[tuple[str, str]] = []
    for item, owner in enum_items(reader):
        symbol = reader.symbol(owner)
        if symbol and symbol.kind == "property" and len(symbol.enum_items) > 2:
            items = ", ".join(f"'{one.identifier}'" for one in symbol.enum_items)
            text = f'TypeError: bpy_struct: item.attr = val: enum "X{item}" not found in ({items})'
            checked.append((text, owner))
    assert len(checked) > examples(50)
    assert wrong(kb, checked, within=2) == []


def test_a_failed_poll_leads_to_the_operator(kb: KnowledgeBase, reader: BaseReader) -> None:
    message = "RuntimeError: Operator {}.poll() failed, context is incorrect"
    assert (
        wrong(kb, [(message.format(path), path) for path in paths(reader, "operator", examples(100))]) == []
    )


def test_an_unknown_keyword_leads_to_the_operator_called(kb: KnowledgeBase, reader: BaseReader) -> None:
    message = 'TypeError: Converting py args to operator properties: : keyword "foo" unrecognized\n{}(foo=1)'
    assert (
        wrong(kb, [(message.format(path), path) for path in paths(reader, "operator", examples(100))]) == []
    )


# Other versions


def former(reader: BaseReader, where: str, count: int = examples(250)) -> list[str]:
    rows = reader.rows(f"SELECT path FROM removed WHERE {where} ORDER BY path")
    return random.Random(SEED).sample([row[0] for row in rows], count)


MEMBERS = "path LIKE 'bpy.types.%.%' AND path NOT LIKE '%:%' AND path NOT LIKE '%[%' AND path NOT LIKE '%(%'"


def says_gone(kb: KnowledgeBase, query: str, path: str) -> bool:
    return any(f"`{as_code(path)}` does not exist in Blender" in note for note in kb.query(query).notes)


@pytest.mark.parametrize("prefix", [True, False])
def test_removed_symbols_are_noted_with_their_versions(
    kb: KnowledgeBase, reader: BaseReader, prefix: bool
) -> None:
    for path in former(reader, "path LIKE 'bpy.types.%' AND path NOT LIKE '%:%' AND path NOT LIKE '%(%'"):
        answer = kb.query(path if prefix else path.removeprefix(TYPES))
        if any("still works here" in note for note in answer.notes):
            continue
        first, _, gone = reader.history.removed(path) or ("", "", "")
        note = next((note for note in answer.notes if f"`{path}` does not exist" in note), "")
        if not note:  # what a base of its class has, it has too
            assert answer.hits[0].id.rpartition(".")[2] == path.rpartition(".")[2], path
            continue
        assert (gone or f"new in {first}") in note, note


@pytest.mark.parametrize("query", ["{}", "bpy.types.{}", 'nodes.new("{}")', "n = tree.nodes.new(type='{}')"])
def test_a_class_that_is_still_taken_by_its_former_name_is_told(
    kb: KnowledgeBase, reader: BaseReader, query: str
) -> None:
    rows = reader.rows("SELECT path, taken_as FROM still_works WHERE path NOT LIKE '%[%'")
    assert rows
    for path, taken_as in rows:
        answer = kb.query(query.format(path.removeprefix(TYPES)))
        assert any("still works here" in note and taken_as in note for note in answer.notes), path
        assert not says_gone(kb, query, path)
        assert taken_as in [hit.id for hit in answer.hits][:2]


@pytest.mark.parametrize("form", ["{}()", "{}(a=1)", "x = {}('EXEC_DEFAULT')"])
def test_a_removed_operator_is_noted_when_called(kb: KnowledgeBase, reader: BaseReader, form: str) -> None:
    for path in former(reader, "path GLOB 'bpy.ops.*.*' AND path NOT GLOB '*[(:]*'", examples(60)):
        assert says_gone(kb, form.format(path), path), path
        message = f'AttributeError: Calling operator "{path}" error, could not be found'
        assert says_gone(kb, message, path), path


def test_what_takes_a_removed_symbols_place_comes_first(kb: KnowledgeBase, reader: BaseReader) -> None:
    rows = reader.rows(
        f"SELECT DISTINCT path FROM successors JOIN removed USING (path) WHERE target != '' AND {MEMBERS} ORDER BY path"
    )
    assert len(rows) > 100
    for (path,) in random.Random(SEED).sample(rows, examples(100)):
        targets = {plain_path(successor.target) for successor in reader.history.successors(path)}
        assert first_id(kb.query(path)) in targets, path


def test_nothing_stands_in_for_what_has_no_successor(kb: KnowledgeBase, reader: BaseReader) -> None:
    rows = reader.rows(
        f"SELECT path FROM successors JOIN removed USING (path) WHERE target = '' AND {MEMBERS}"
    )
    assert len(rows) > 20
    for (path,) in rows[: examples(60)]:
        answer = kb.query(path)
        assert any("Nothing takes its place." in note for note in answer.notes), path
        name = path.rpartition(".")[2]  # which a class below may have still
        assert {hit.id for hit in answer.hits if not hit.id.endswith(f".{name}")} <= {
            path.rpartition(".")[0]
        }, path


def test_a_former_item_or_argument_is_known_too(kb: KnowledgeBase, reader: BaseReader) -> None:
    for path in former(reader, "path LIKE '%:%'", examples(150)):
        assert says_gone(kb, path, path), path


@pytest.mark.parametrize(
    "question", ["render engine {}", "how do I use {} in a script", "is {} still there?"]
)
def test_a_former_item_is_known_among_other_words(kb: KnowledgeBase, question: str) -> None:
    answer = kb.query(question.format("BLENDER_EEVEE_NEXT"))
    assert "`bpy.types.RenderSettings.engine = 'BLENDER_EEVEE_NEXT'` does not exist" in answer.text
    assert answer.hits[0].id == "bpy.types.RenderSettings.engine"
    assert "does not exist" not in kb.query(question.format("BLENDER_WORKBENCH")).text


def test_an_attribute_error_of_a_former_member_says_so(kb: KnowledgeBase, reader: BaseReader) -> None:
    silent = [
        path
        for path in former(reader, MEMBERS)
        for owner, name in [owner_and_name(path)]
        if not says_gone(kb, f"AttributeError: '{owner}' object has no attribute '{name}'", path)
    ]
    # Some classes inherit the name by now, or are called after what they were called before.
    assert len(silent) <= 12, silent


def test_what_works_is_not_called_gone(kb: KnowledgeBase, reader: BaseReader) -> None:
    lines = [
        f"{owner}.{name}" for owner, name in map(owner_and_name, of_data(reader, "property", examples(400)))
    ]
    lines += [f"{path}()" for path in paths(reader, "operator", examples(200))]
    lines += [f"ob.{entry.name} = x" for entry in reader.members(f"{TYPES}Object").values()]
    lines += [f"cam.{entry.name} = x" for entry in reader.members(f"{TYPES}Object").values()]
    lines += [f"mat.{entry.name}" for entry in reader.members(f"{TYPES}Material").values()]
    assert [line for line in lines if any("does not exist" in note for note in kb.query(line).notes)] == []


@pytest.mark.parametrize(
    "query", ["blender -b file.blend -a", "render scene.blend to out.png from the shell"]
)
def test_names_of_files_are_not_taken_for_code(kb: KnowledgeBase, query: str) -> None:
    answer = kb.query(query)
    assert answer.notes == ()
    assert "bpy.types.CacheFile" not in [hit.id for hit in answer.hits[:1]]


def test_an_attribute_that_is_called_as_an_ending_is_known(kb: KnowledgeBase) -> None:
    assert kb.query("brush.blend").hits[0].id == "bpy.types.Brush.blend"


@pytest.mark.parametrize("query", ["'CLOTH'", '"CLOTH"'])
def test_a_value_in_quotes_is_not_the_page_of_that_name(kb: KnowledgeBase, query: str) -> None:
    assert kb.query("cloth").kind == "page"
    answer = kb.query(query)
    symbol = kb.symbol(answer.hits[0].id)
    assert symbol is not None
    enumerations = [symbol.enum_items, *(parameter.enum_items for parameter in symbol.parameters)]
    assert "CLOTH" in {item.identifier for items in enumerations for item in items}


@pytest.mark.parametrize(("word", "path"), [("handlers", "bpy.app.handlers"), ("timers", "bpy.app.timers")])
def test_a_bare_word_may_be_a_module_that_nothing_else_is_called_as(
    kb: KnowledgeBase, word: str, path: str
) -> None:
    assert kb.query(word).hits[0].id == path


@pytest.mark.parametrize(
    ("question", "told"),
    [
        ("sky texture world", ["bpy.types.ShaderNodeTexSky"]),
        (
            "noise texture color ramp material",
            ["bpy.types.ShaderNodeTexNoise", "bpy.types.ShaderNodeValToRGB"],
        ),
    ],
)
def test_what_a_part_of_a_question_is_called_is_told(
    kb: KnowledgeBase, question: str, told: list[str]
) -> None:
    assert set(told) <= {hit.id for hit in kb.query(question).hits}


@pytest.mark.parametrize(
    ("question", "first"),
    [
        ("noise texture", ["bpy.types.ShaderNodeTexNoise", "bpy.types.NoiseTexture"]),
        ("Image Texture", ["bpy.types.ShaderNodeTexImage", "bpy.types.ImageTexture"]),
        ("magic texture", ["bpy.types.MagicTexture", "bpy.types.ShaderNodeTexMagic"]),
        ("NoiseTexture", ["bpy.types.NoiseTexture"]),
        ("color balance", ["bpy.types.CompositorNodeColorBalance"]),
    ],
)
def test_words_that_are_a_name_and_a_label_mean_what_is_used_more(
    kb: KnowledgeBase, question: str, first: list[str]
) -> None:
    assert [hit.id for hit in kb.query(question).hits][: len(first)] == first


def test_icons_are_told_only_of_who_asks_for_icons(kb: KnowledgeBase) -> None:
    assert "bl_icon" not in kb.query("push action to NLA strip").text
    assert "bpy.types.Node.bl_icon" in {hit.id for hit in kb.query("icon NLA of a node").hits}


@pytest.mark.parametrize(
    ("code", "operator"),
    [
        ("props.mode = 'CREASES'", "bpy.ops.sculpt.face_sets_init"),
        ("op.filter_type = 'CONTRAST_INCREASE'", "bpy.ops.sculpt.mask_filter"),
    ],
)
def test_a_value_that_operators_alone_take_is_one_of_their_properties(
    kb: KnowledgeBase, code: str, operator: str
) -> None:
    answer = kb.query(code)
    assert answer.hits[0].id == operator
    assert "is not a value of" not in "\n".join(answer.notes)


def test_a_value_of_what_a_variable_is_always_called_after_is_refused(kb: KnowledgeBase) -> None:
    answer = kb.query("obj.type = 'BACK'")
    assert answer.hits[0].id == "bpy.types.Object.type"
    assert "is read-only" in answer.notes[0]
    assert kb.query("con.type = 'HINGE'").hits[0].id == "bpy.types.RigidBodyConstraint.type"


def test_a_part_of_a_macro_has_the_properties_of_its_operator(kb: KnowledgeBase) -> None:
    layout = "props = layout.operator('mesh.rip_move')\nprops.MESH_OT_rip."
    assert kb.query(f"{layout}use_fill = True").notes == ()
    assert "takes no `use_filly`; closest: `use_fill`." in kb.query(f"{layout}use_filly = True").notes[0]
