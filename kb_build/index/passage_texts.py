"""What the manual says of symbols, word for word, with the names that scripts have for its labels."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from kb_build.pages.definitions import passage_text, with_names

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kb_build.index.label_names import LabelName
    from kb_build.index.passages import Passage
    from kb_build.pages.page import Page


def passage_rows(
    passages: Mapping[str, Passage], pages: Sequence[Page], labels: Iterable[LabelName]
) -> Iterator[tuple[str, str, int, int, str, str]]:
    """(symbol path, its place in the manual, the headings above that, the text there) for each passage."""
    of_page: dict[str, dict[tuple[int, int], str]] = defaultdict(dict)
    for slug, section, line, names in labels:
        of_page[slug].setdefault((section, line), names)
    known = {page.slug: page for page in pages}
    for path, (slug, number, line) in passages.items():
        page = known[slug]
        section = page.sections[number]
        headings = page.title if number == 0 else f"{page.title} › {section.title}"
        text = passage_text(with_names(section.text, number, of_page[slug]), line)
        yield path, slug, number, line, headings, text
