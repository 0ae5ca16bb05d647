"""Summaries from a page's own sentences.

Which sentences: only prose counts. Headings, notes and other quotes, lists, definition and field lists,
tables, code, captions, bare references (``See …``), statements that something is missing and sentences that
announce what follows (``…:``) are left out. Candidates are the first ``_CANDIDATES`` sentences of the page's
lead, which is the text below its title; where it has none, of the whole page.

Chosen how: every candidate gets a score, the sum of
- centrality: the mean weight of its content words, where a word weighs the logarithm of how often the page's
  prose and section titles use it;
- half the share of the title's words that it holds;
- its place: 1 for the first sentence, 1/2 for the second, 1/3 for the third, …

The best one is taken, and its successor in the same paragraph where both fit into ``MAX_CHARS``. A sentence
longer than that is cut between words. The same page always gives the same summary.

A page without a lead (an index page, a bare list of settings) is summarised by what it contains: the titles
of its children, else of its sections, else the terms that it defines; then by the sentence, where there is
one and room for it. A script template is summarised by the text at its head. A page without any of these is
told apart by the titles of the pages above it.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from typing import TYPE_CHECKING

from kb_build.summaries.types import PageSummary, summary_key

if TYPE_CHECKING:
    from collections.abc import Container, Iterator, Mapping, Sequence

    from kb_build.pages.page import Page, Section

EXTRACTIVE_VERSION = "extractive-1"
MODEL = "extractive"
MAX_CHARS = 240
_CANDIDATES = 10
_PROSE_CHARS = 6000

_FENCE = re.compile(
    r"^ {0,3}(`{3,}|~{3,})[^\n]*\n(.*?)(?:^ {0,3}\1[`~]*[ \t]*$|\Z)", re.MULTILINE | re.DOTALL
)
_NOT_PROSE = re.compile(
    r"\s*(?:#|>|\||:|!\[|<|\$\$|[-*+•]\s|\d+[.)]\s|[-=_*~]{3,}\s*$|\[\^|\.\. )"
    r"|\s*\*+[^*]+\*+\s*:?\s*$"
    r"|[ \t]{2,}\S"
)
_FIELD = re.compile(r"\s*\*{0,2}[A-Z][\w /-]{0,30}:\*{0,2}\s")
_TERM = re.compile(r"^\*\*([^*\n]+?):?\*\*", re.MULTILINE)
_LINK = re.compile(r"!?\[([^\]]*)\]\([^)]*\)")
_MARKUP = re.compile(r"\*\*|`+|(?<![\w*])\*(?=\S)|(?<=\S)\*(?![\w*])")
_SENTENCE_END = re.compile(r"(?:(?<=[.!?])|(?<=[.!?][\"')\]]))\s+(?=[\"'(\[]?[A-Z0-9])")
_ABBREVIATION = re.compile(
    r"(?:\b(?:e\.g|i\.e|etc|vs|cf|approx|resp|fig|no|Dr|St)\.|\b[A-Z]\.)$", re.IGNORECASE
)
_EMPTY = re.compile(
    r"(?:See|Refer to|Main article|Todo)\b"
    r"|(?:This|The) [\w -]{1,40} (?:has no|have no|does not have any) \w+\.",
    re.IGNORECASE,
)
_WORD = re.compile(r"[^\W\d_]{3,}")
_STOP_WORDS = frozenset(
    """
    the and for are was but not you your can will with this that these those from into its has have
    all any each when where which who how what why than then there here also only other same such
    more most some use used using useful page section may might should would could does done been
    being both one two see
    """.split()  # noqa: SIM905 - sixty lines otherwise
)


def extractive_summaries(pages: Sequence[Page], besides: Container[str] = ()) -> dict[str, PageSummary]:
    """A summary for every page but those ``besides``, by slug; at most ``MAX_CHARS`` characters of plain text, never
    empty.
    """
    titles = {page.slug: page.title for page in pages}
    return {page.slug: extractive_summary(page, titles) for page in pages if page.slug not in besides}


def extractive_summary(page: Page, titles: Mapping[str, str]) -> PageSummary:
    """The summary of one page; ``titles`` (by slug) names its children where it has no prose of its own."""
    lead = _best(page, page.sections[:1])
    if lead:
        text = lead
    else:
        contents = _from_script(page) or _from_contents(page, titles)
        rest = _best(page, page.sections[1:])
        both = f"{contents} {rest}".strip()
        text = both if len(both) <= MAX_CHARS or not contents else contents
    key = summary_key(page.content_hash, EXTRACTIVE_VERSION, MODEL)
    text = _plain(text) or _plain(_place(page)) or page.content_hash[:12]
    return PageSummary(key, _cut(text), "extractive", MODEL, EXTRACTIVE_VERSION)


def _best(page: Page, sections: Sequence[Section]) -> str:
    """The best sentence of these sections, perhaps with its successor; nothing where they have none."""
    paragraphs: list[list[str]] = []
    length = 0
    for section in sections:
        for paragraph in _paragraphs(section.text[:_PROSE_CHARS]):
            sentences = _sentences(paragraph)
            if sentences:
                paragraphs.append(sentences)
            length += len(paragraph)
        if length > _PROSE_CHARS:
            break
    candidates = [
        (row, column)
        for row, sentences in enumerate(paragraphs)
        for column, sentence in enumerate(sentences)
        if not sentence.endswith(":") and not _EMPTY.match(sentence)
    ][:_CANDIDATES]
    if not candidates:
        return ""
    weights = _weights(paragraphs, page)
    title = set(_words(page.title))

    def score(place: int) -> float:
        row, column = candidates[place]
        words = _words(paragraphs[row][column])
        centrality = sum(weights[word] for word in words) / len(words) if words else 0.0
        overlap = len(title.intersection(words)) / len(title) if title else 0.0
        return centrality + overlap / 2 + 1 / (place + 1)

    row, column = candidates[max(range(len(candidates)), key=score)]
    chosen, *following = paragraphs[row][column:]
    if following and (row, column + 1) in candidates and len(chosen) + 1 + len(following[0]) <= MAX_CHARS:
        chosen = f"{chosen} {following[0]}"
    return chosen


def _paragraphs(markdown: str) -> Iterator[str]:
    """The paragraphs of running text, each on one line, without Markdown's marks."""
    for block in re.split(r"\n\s*\n", _FENCE.sub("\n", markdown)):
        lines = block.strip("\n").split("\n")
        if not lines[0].strip() or _NOT_PROSE.match(lines[0]) or _FIELD.match(lines[0]):
            continue
        if len(lines) > 1 and lines[1].startswith((" ", ":", "|")):
            continue  # a definition list's term, or a table without outer bars
        yield _plain(" ".join(lines))


def _plain(markdown: str) -> str:
    text = " ".join(_MARKUP.sub("", _LINK.sub(r"\1", markdown)).split())
    return text if text.isprintable() else "".join(filter(str.isprintable, text))


def _sentences(paragraph: str) -> list[str]:
    """The paragraph's sentences; text that does not end like one (a caption, a label) gives none."""
    sentences: list[str] = []
    for part in _SENTENCE_END.split(paragraph):
        if sentences and _ABBREVIATION.search(sentences[-1][-12:]):
            sentences[-1] = f"{sentences[-1]} {part}"
        else:
            sentences.append(part)
    if sentences and not sentences[-1].rstrip("\"')]").endswith((".", "!", "?", ":")):
        sentences.pop()
    return [sentence for sentence in sentences if len(sentence) > 20]


def _weights(paragraphs: list[list[str]], page: Page) -> dict[str, float]:
    counts = Counter(word for sentences in paragraphs for sentence in sentences for word in _words(sentence))
    counts.update(word for section in page.sections for word in _words(section.title))
    top = math.log1p(max(counts.values(), default=1))
    return {word: math.log1p(count) / top for word, count in counts.items()}


def _words(text: str) -> list[str]:
    return [word for word in _WORD.findall(text.lower()) if word not in _STOP_WORDS]


def _from_script(page: Page) -> str:
    """What a script says of itself: its docstring, else the comment at its head."""
    if page.source != "template":
        return ""
    code = next((match[2] for section in page.sections for match in _FENCE.finditer(section.text)), "")
    docstring = re.match(r"(?:\s*#[^\n]*\n)*\s*(\"\"\"|''')(.*?)\1", code, re.DOTALL)
    comment = re.match(r"(?:\s*#(?!!)[^\n]*\n)+", code)
    head = docstring[2] if docstring else comment[0].replace("#", " ") if comment else ""
    first = re.split(r"\n\s*\n", head.strip())[0]
    return f"{page.title}: {_plain(first)}" if first else ""


def _from_contents(page: Page, titles: Mapping[str, str]) -> str:
    parts = [titles[slug] for slug in page.children if slug in titles]
    parts = parts or [section.title for section in page.sections[1:] if section.title]
    parts = parts or [term for section in page.sections for term in _TERM.findall(section.text)]
    return f"{page.title}. Contents: {', '.join(dict.fromkeys(parts))}." if parts else ""


def _place(page: Page) -> str:
    title = page.title or page.slug
    return f"{title} ({' > '.join(page.breadcrumbs)})" if page.breadcrumbs else title


def _cut(text: str) -> str:
    if len(text) <= MAX_CHARS:
        return text
    return text[: MAX_CHARS - 1].rpartition(" ")[0].rstrip(" ,;:–—(") + "…"
