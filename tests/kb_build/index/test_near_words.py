"""The table of near words, as it comes with the package and as a base keeps it."""

from __future__ import annotations

from kb_build.index.analysis import stem
from kb_build.index.synonyms import load_near_words, near_stems


def rows(table: dict[str, tuple[tuple[str, int], ...]], stems: set[str]) -> dict[str, str]:
    return dict(near_stems(table, stems))


def test_only_stems_that_the_corpus_has_are_kept() -> None:
    found = rows({"fabric": (("cloth", 80), ("textile", 70))}, {"cloth"})
    assert found == {"fabric": "cloth 80"}


def test_forms_of_one_stem_count_once_by_the_nearest() -> None:
    near = (("collisions", 80), ("collision", 75), ("colliding", 50))
    assert rows({"bump": near}, {stem("collision"), stem("colliding")}) == {
        "bump": f"{stem('collision')} 80"
        + (f" {stem('colliding')} 50" if stem("colliding") != stem("collision") else "")
    }


def test_a_word_is_not_near_to_itself() -> None:
    assert rows({"cloths": (("cloth", 90),)}, {"cloth"}) == {"cloths": ""}


def test_a_word_near_to_nothing_is_known_all_the_same() -> None:
    assert rows({"zymurgy": ()}, {"cloth"}) == {"zymurgy": ""}


def test_the_table_that_comes_along_is_sorted_and_sound() -> None:
    table = load_near_words()
    assert len(table) > 10_000
    for word, near in table.items():
        assert word == word.lower()
        assert [similarity for _, similarity in near] == sorted((s for _, s in near), reverse=True), word
        assert all(0 < similarity <= 100 for _, similarity in near), word
        assert word not in {other for other, _ in near}
