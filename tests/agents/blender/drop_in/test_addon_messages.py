"""How messages on the socket are told apart, wherever the network cuts them."""

from __future__ import annotations

import json
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from agents.blender.drop_in.messages import LONGEST, MessageSplitter, NotMessages, parse
from agents.blender.tools.execute import LONGEST_CODE

if TYPE_CHECKING:
    from collections.abc import Iterable

TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
VALUES = st.recursive(
    st.none() | st.integers(-9, 9) | TEXTS,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(TEXTS, inner, max_size=3),
    max_leaves=8,
)
OBJECTS = st.dictionaries(TEXTS, VALUES, max_size=3)


def split(pieces: Iterable[bytes]) -> list[dict[str, Any]]:
    splitter = MessageSplitter()
    found = [parse(message) for piece in pieces for message in splitter.feed(piece)]
    assert not splitter.has_begun
    return found


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(OBJECTS, max_size=4), st.booleans(), st.sampled_from(["", " ", "\r\n"]), st.data())
def test_messages_are_found_whatever_the_pieces(
    objects: list[dict[str, Any]], escaped: bool, between: str, data: st.DataObject
) -> None:
    texts = [json.dumps(one, ensure_ascii=escaped) for one in objects]
    stream = "".join(f"{text}{between}" for text in texts).encode()
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=12)))
    ends = [0, *cuts, len(stream)]
    assert split(stream[a:b] for a, b in pairwise(ends)) == objects
    assert split(stream[at : at + 1] for at in range(len(stream))) == objects


@pytest.mark.parametrize(
    "data",
    [b"GET / HTTP/1.1\r\n\r\n{}", b"[]", b'"text"', b"null", b"\x00", b"\xff\xfe{\x00}\x00", b"}", b"{} x"],
)
def test_what_begins_as_no_object_ends_the_connection(data: bytes) -> None:
    with pytest.raises(NotMessages, match="begins with"):
        split([data])


def test_the_longest_code_fits_in_a_message_however_it_is_escaped() -> None:
    code = "\U0001f9ff" * LONGEST_CODE
    assert split([json.dumps({"type": "execute_code", "params": {"code": code}}).encode()])


@pytest.mark.parametrize("end", [b"", b'"}'])
def test_too_long_messages_are_refused_with_or_without_their_end(end: bytes) -> None:
    with pytest.raises(NotMessages, match="longer than"):
        split([b'{"code": "', b"x" * LONGEST + end])


def test_deep_nesting_is_refused() -> None:
    with pytest.raises(NotMessages, match="nests"):
        split([b'{"a":' * 100_000])
    with pytest.raises(ValueError, match="nested"):
        parse(b'{"a":' + b"[" * 1_000_000 + b"]" * 1_000_000 + b"}")


@pytest.mark.parametrize(
    ("data", "word"),
    [(b"{'type': 'ping'}", "not valid JSON"), (b'{"a": "\xff"}', "not UTF-8"), (b"{,}", "not valid JSON")],
)
def test_what_is_wrong_with_a_message_is_told(data: bytes, word: str) -> None:
    with pytest.raises(ValueError, match=word):
        split([data])
