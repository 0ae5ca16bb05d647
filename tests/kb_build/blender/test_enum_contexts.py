"""Where the items of an enumeration are taken, told in as few words as decide it."""

from __future__ import annotations

from typing import Any

import pytest

from kb_build.blender.enum_contexts import items_in_contexts
from kb_build.symbols.taken import NEVER


def context(items: str, *made: tuple[str, str], **states: str) -> dict[str, Any]:
    """A row: one letter an item, the contexts, and the values that the other enumerations had."""
    found = {name: list(values) for name, values in states.items()}
    return {"items": list(items), "made": list(made), "states": found}


def texts(rows: list[dict[str, Any]]) -> dict[str, str]:
    return {row["identifier"]: row["where"].text if row["where"] else "" for row in rows}


def where(listed: str, *contexts: dict[str, Any]) -> dict[str, str]:
    rows = items_in_contexts([{"identifier": item} for item in listed], contexts, {})
    return texts(rows)


def test_what_is_taken_everywhere_needs_no_words() -> None:
    assert where("AB", context("AB", ("lamp", ""))) == {"A": "", "B": ""}


def test_another_enumeration_decides() -> None:
    metric = context("AB", ("scene", ""), ("scene", "other='Y'"), system="M", other="XY")
    imperial = context("AC", ("scene", "system='I'"), system="I", other="X")
    found = where("ABC", metric, imperial)
    assert found == {"A": "", "B": "only with system='M'", "C": "only with system='I'"}


def test_the_shorter_side_of_what_decides_is_told() -> None:
    many = context("AB", ("image", ""), kind="PQR")
    one = context("A", ("image", "kind='S'"), kind="S")
    assert where("AB", many, one)["B"] == "not with kind='S'"


@pytest.mark.parametrize(
    ("contexts", "expected"),
    [
        ((context("AB", ("mesh", "")), context("A", ("lamp", ""))), "only by mesh"),
        (
            (context("AB", ("mesh", ""), ("curve", "")), context("A", ("lamp", ""))),
            "not by lamp",
        ),
        ((context("AB", ("mesh", "m='X'")), context("A", ("mesh", ""))), "only with m='X'"),
        (
            (context("AB", ("mesh", "")), context("A", ("mesh", "m='X'"), ("mesh", "m='Y'"))),
            "not with m='X'|'Y'",
        ),
        (
            (context("AB", ("int in a G", "")), context("A", ("int in a S", ""), ("int in a T", ""))),
            "only in a G",
        ),
        (
            (context("AB", ("int in a G", ""), ("int in a S", "")), context("A", ("int in a T", ""))),
            "not in a T",
        ),
        (
            (
                context("AB", ("int in a G", "")),
                context("A", ("int in a S", ""), ("float in a S", ""), ("float in a G", "")),
            ),
            "only in a G, and there only by int",
        ),
        (
            (context("AB", ("mesh", ""), ("lamp", "m='X'")), context("A", ("lamp", ""), ("lamp", "m='Y'"))),
            "by lamp only with m='X'",
        ),
    ],
)
def test_else_what_was_made_or_its_mode(contexts: tuple[dict[str, Any], ...], expected: str) -> None:
    assert where("AB", *contexts)["B"] == expected


def test_what_every_instance_refuses_is_kept_but_said() -> None:
    assert where("AB", context("A", ("lamp", ""))) == {"A": "", "B": NEVER.text}


def test_a_lone_placeholder_goes() -> None:
    assert where("N", context("AB", ("flow", ""))) == {"A": "", "B": ""}
    assert where("N", context("NA", ("flow", ""))) == {"N": "", "A": ""}


def test_items_of_instances_bring_their_texts() -> None:
    rows = items_in_contexts([], [context("A", ("lamp", ""))], {"A": ("Name", "Words")})
    assert rows == [{"identifier": "A", "name": "Name", "description": "Words", "where": None}]


def beside(tried: dict[str, str], start: str, **states: str) -> dict[str, Any]:
    """A row of what was tried with a neighbour's ``codec``: value → items, one letter each."""
    own = {name: list(values) for name, values in states.items()}
    rows = [[[value], list(items)] for value, items in tried.items()]
    return {"states": own, "setting": "Video.codec", "start": start, "tried": rows}


def where_beside(contexts: list[dict[str, Any]], tried: str, *rows: dict[str, Any]) -> dict[str, str]:
    """Where items are taken; ``tried`` are the formats in which the neighbour was tried."""
    neighbours = {"rows": rows, "states": {"format": list(tried)}}
    listed = [{"identifier": item} for item in "AB"]
    return texts(items_in_contexts(listed, contexts, {}, neighbours))


def test_a_neighbour_decides_in_one_mode_and_the_own_setting_in_the_others() -> None:
    contexts = [context("AB", ("scene", ""), format="PQ"), context("A", ("scene", "format='V'"), format="VR")]
    found = where_beside(contexts, "PQRV", beside({"x": "A", "y": "AB"}, "x", format="V"))
    assert found == {"A": "", "B": "not with format='R'; with format='V' only if Video.codec='y'"}
    contexts[1]["states"]["format"] += "ST"
    found = where_beside(contexts, "PQRSTV", beside({"x": "A", "y": "AB"}, "x", format="V"))
    assert found["B"] == "only with format='P'|'Q'; with format='V' only if Video.codec='y'"


def test_a_neighbour_alone_decides_in_all_modes() -> None:
    contexts = [context("AB", ("scene", ""), format="PQ")]
    found = where_beside(contexts, "PQ", beside({"x": "AB", "y": "AC"}, "x", format="PQ"))
    assert found == {"A": "", "B": "only with Video.codec='x'", "C": "only with Video.codec='y'"}


def test_what_only_a_neighbour_allows_in_a_mode() -> None:
    contexts = [context("A", ("scene", ""), format="PV")]
    found = where_beside(contexts, "PV", beside({"x": "A", "y": "AB"}, "x", format="V"))
    assert found["B"] == "only with format='V' if Video.codec='y'"


def test_a_mode_that_some_states_contradict_decides_nothing() -> None:
    contexts = [context("AB", ("scene", ""), format="P"), context("A", ("scene", "format='V'"), format="V")]
    rows = beside({"x": "A", "y": "AB"}, "x", format="P"), beside({"x": "A", "y": "AB"}, "x", format="V")
    assert where_beside(contexts, "PV", *rows)["B"] == "only with Video.codec='y'"
