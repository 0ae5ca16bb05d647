"""Text becomes the same terms whoever writes it, and in whatever spelling."""

from __future__ import annotations

import random
import string

import pytest

from kb_build.index.analysis import STOP_WORDS, distinct_words, key, stem, terms, words


@pytest.mark.parametrize(
    "spellings",
    [
        (
            "quality_steps",
            "qualitySteps",
            "quality steps",
            "Quality Steps",
            "QUALITY-STEPS",
            " quality.steps ",
        ),
        ("bpy.types.ClothSettings", "bpy types cloth settings", "BPY.TYPES.CLOTH_SETTINGS"),
        ('inputs["Specular IOR Level"]', "inputs['specular ior level']", "inputsSpecularIorLevel"),
        ("OBJECT_OT_modifier_add", "object ot modifier add"),
        ("Größe", "GRÖßE", "größe"),
    ],
)
def test_spellings_of_one_name_have_one_key(spellings: tuple[str, ...]) -> None:
    assert len({key(spelling) for spelling in spellings}) == 1
    assert key(spellings[0])


@pytest.mark.parametrize(
    "spellings",
    [
        ("quality_steps", "qualitySteps", "QualitySteps", "quality steps"),
        ("use_self_collision", "useSelfCollision"),
    ],
)
def test_spellings_of_one_name_have_the_same_terms(spellings: tuple[str, ...]) -> None:
    assert len({tuple(terms(spelling)) for spelling in spellings}) == 1


def test_distinct_words_are_the_words() -> None:
    names = ["use_self_collision", "UVProjectModifier", "view_3d", "3D", "image_10d_x", "UVs", "GRÖßE", "5.1"]
    assert distinct_words("\n".join(names)) == {word for name in names for word in words(name)}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("ClothSettings.quality", ["cloth", "settings", "quality"]),
        ("use_self_collision", ["use", "self", "collision"]),
        ("ShaderNodeBsdfPrincipled", ["shader", "node", "bsdf", "principled"]),
        ("UVProjectModifier", ["uv", "project", "modifier"]),
        ("SceneEEVEE", ["scene", "eevee"]),
        ("Specular IOR Level", ["specular", "ior", "level"]),
        ("version 5.1", ["version", "5.1"]),
        ("", []),
        ("!?*\"'()[]{}\x00", []),
    ],
)
def test_identifiers_are_split_into_words(text: str, expected: list[str]) -> None:
    assert words(text) == expected


def test_splitting_loses_no_letter() -> None:
    random.seed(11)
    for _ in range(500):
        text = "".join(random.choices(string.ascii_letters + string.digits + "_ .-[]\"'", k=30))
        letters = "".join(char for char in text.lower() if char.isalpha())
        assert "".join(char for word in words(text) for char in word if char.isalpha()) == letters


@pytest.mark.parametrize(
    ("one", "other"),
    [("collisions", "collision"), ("baking", "bake"), ("simulated", "simulate"), ("modifiers", "modifier"),
     ("particles", "particle")],
)  # fmt: skip
def test_forms_of_a_word_have_one_stem(one: str, other: str) -> None:
    assert stem(one) == stem(other)


def test_stop_words_are_left_out() -> None:
    assert terms("How do I make the cloth with its own collisions?") == terms("cloth collisions")
    assert terms(" ".join(sorted(STOP_WORDS))) == []


def test_terms_of_any_text_are_lower_case() -> None:
    random.seed(3)
    for _ in range(300):
        text = "".join(
            chr(random.choice((random.randrange(0x300), random.randrange(0x11000)))) for _ in range(40)
        )
        assert all(term == term.lower() for term in terms(text) if term.isascii())
        assert " " not in key(text)
