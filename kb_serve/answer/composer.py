"""Composes the answer to a query: within a token budget, in parts."""

from __future__ import annotations

import re
from functools import lru_cache
from itertools import zip_longest
from typing import TYPE_CHECKING, Literal

from kb_build.index.analysis import stems_of
from kb_build.symbols.api_names import TYPES
from kb_serve.answer.asked.members import AskedMembers
from kb_serve.answer.asked.sides import are_told, meant_by, sides_of
from kb_serve.answer.budget import AnswerBlock
from kb_serve.answer.changes import changes_of, version_asked_about
from kb_serve.answer.drafts import Draft, draft_of, paged, with_notes
from kb_serve.answer.facts.asked_values import asked_words
from kb_serve.answer.hit_answers import HitAnswers
from kb_serve.answer.hit_blocks import HitBlocks
from kb_serve.answer.hit_lines import NAMES, PAGES, HitLines
from kb_serve.answer.hits import hits_of
from kb_serve.answer.known.asked_recipe import AskedRecipes, clauses_of
from kb_serve.answer.known.practice import HOW_TO, Practice
from kb_serve.answer.query_text import in_one_line, is_plain
from kb_serve.answer.question_frame import without_frame
from kb_serve.answer.render import MarkdownRenderer
from kb_serve.answer.said_twice import is_said
from kb_serve.answer.topic.overview import STEPS, Topics
from kb_serve.errors import BadQuery
from kb_serve.query_limits import LEAST_TOKENS, LIMIT, MAX_LIMIT
from kb_serve.rank.merging import SURE, QueryRanker, Ranking
from kb_serve.rank.ranked_id import RankedId
from kb_serve.recognise.message_patterns import is_message
from kb_serve.recognise.several import parts_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from kb_serve.answer.docs_answer import DocsAnswer
    from kb_serve.answer.hits import Hit
    from kb_serve.answer.known.asked_recipe import AskedRecipe
    from kb_serve.answer.topic.overview import TopicOverview
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.several import QuestionPart

_BESIDE = {NAMES, PAGES}  # blocks of what was found beside the best hit
_LEAST_PROSE = 2  # words of a question that may ask for a task, if they are the very words for it
_KNOWN_OF = 3  # hits for a description among which what one has to know of them is looked for
_NAMES_OF_A_PART, _PAGES_OF_A_PART, _STEPS_OF_A_PART = 3, 2, 3
_KNOWN_OF_A_PART = 1
_SETTINGS = 2  # of a topic that are hits before its classes
_MUCH, _MUCH_USED = 13.5, 2  # weight of a member that most scripts use, and how many such are told
_LESS = 0.02  # score from one id to the next, where nothing was ranked
_OPERATOR = re.compile(r"bpy\.ops\.\w+\.\w+")


class AnswerComposer:
    """Answers queries from one base."""

    def __init__(self, reader: BaseReader, notes_on_code: Callable[[BaseReader, str], Sequence[str]]) -> None:
        """``notes_on_code`` says what is wrong in the code of a query, if there is any."""
        self._reader = reader
        self._notes_on_code = notes_on_code
        self._ranker = QueryRanker(reader)
        renderer = MarkdownRenderer(reader)
        self._lines = HitLines(reader)
        self._blocks = HitBlocks(reader, renderer, self._lines)
        self._told = HitAnswers(reader, renderer, self._lines, self._blocks)
        self._topics = Topics(reader)
        self._practice = Practice(reader)
        self._recipes = AskedRecipes(reader)
        self._members = AskedMembers(reader)
        self._draft = lru_cache(maxsize=16)(self._draft_with_notes)

    def answer(self, query: str, limit: int, max_tokens: int, part: int, command: str = "") -> DocsAnswer:
        """Answers a query; ``command`` is what it was asked by, if in a shell.

        Raises BadQuery for an empty one, a wrong limit, or a part that does not exist.
        """
        text = in_one_line(query)
        if not text:
            raise BadQuery(
                "The query is empty. Send a name (ClothSettings.quality), or say what you want to do."
            )
        if limit < 1 or part < 1:
            raise BadQuery(f"limit and part must be at least 1 (they are limit={limit}, part={part}).")
        if max_tokens < LEAST_TOKENS:
            raise BadQuery(
                f"max_tokens={max_tokens} is too small for an answer. Set it to {LEAST_TOKENS} or more."
            )
        return paged(text, self._draft(query, min(limit, MAX_LIMIT)), max_tokens, part, command)

    def _draft_with_notes(self, query: str, limit: int) -> Draft:
        told = self._notes_on_code(self._reader, query)
        return with_notes(told, self._make_draft(in_one_line(query), limit, told))

    def _make_draft(self, text: str, limit: int, told: Sequence[str]) -> Draft:
        """The answer to a text of whose code ``told`` is said as well."""
        text = without_frame(text)
        ranking = self._ranker.rank(text, limit)
        ranking.notes = [note for note in ranking.notes if not is_said(note, told)]
        if version := version_asked_about(text, self._reader):
            return self._changes(version, limit)
        is_name = (" " not in text or "[" in text) and self._reader.entry(text)
        topic = "" if is_name or ranking.recognition.removed else self._topics.find(text)
        if topic:
            return self._overview(topic, ranking, limit, self._recipe(text), self._much_used(text))
        names = [match for match in ranking.recognition.matches if match.sure >= SURE]
        is_named = ranking.named or any(match.why != "enum item" for match in names)
        if not is_named and (parts := parts_of(text)):
            return self._answer_each(parts, ranking, limit, self._likely_recipe(text))
        rows = self._listed(ranking, limit)
        hits = hits_of(rows, self._reader)
        known = (
            []
            if ranking.notes or told
            else [*self._known(hits[:1] if ranking.named else hits[:_KNOWN_OF], text, is_named=ranking.named)]
        )
        known, recipe = _one_way(known, self._recipe(text, clauses_of(text)))
        said = (*ranking.notes, *known, ranking.alike, *self._source_notes(ranking, hits))
        notes = tuple(dict.fromkeys(filter(None, said)))
        if not hits:
            text = "Nothing in this knowledge base matches the query. Try other words, or a name as Blender writes it."
            return draft_of("none", (), notes, (AnswerBlock("" if ranking.notes else text),))
        asked = asked_words(text)
        members = self._asked_for(text, asked, rows, ranking.ranked)
        if meant := self._compared(text, (hits[0].id, *members), limit):
            return self._compare(text, meant, rows, limit, notes)
        if not ranking.named:
            kind, blocks = "candidates", self._told.found(hits, rows, asked, members)
        else:
            names = ranking.recognition.arguments.get(hits[0].id, ())
            kind = "page" if hits[0].is_page else "schema"
            blocks = self._told.named(hits, rows, text, names, members)
        is_first = recipe is not None and (recipe.is_said if ranking.named else recipe.is_likely)
        return draft_of(kind, hits, notes, _with_recipe(blocks, recipe, is_first=is_first))

    def _recipe(self, text: str, clauses: Sequence[str] = ()) -> AskedRecipe | None:
        """The few lines that do the task of a question, or of one of its clauses."""
        words = sum(map(str.isalpha, text.split()))
        if is_message(text) or words < _LEAST_PROSE:
            return None
        recipe = self._recipes.find(text, self._ranker.searcher.words.concepts, clauses)
        return recipe if recipe and (recipe.is_said or words > _LEAST_PROSE) else None

    def _likely_recipe(self, text: str) -> AskedRecipe | None:
        recipe = self._recipe(text)
        return recipe if recipe and recipe.is_likely else None

    def _changes(self, version: str, limit: int) -> Draft:
        """What a version changed as a whole."""
        changes = changes_of(version, self._reader)
        hits = hits_of(_in_given_order(changes.ids[:limit], "topic"), self._reader)
        return draft_of("candidates", hits, (), changes.blocks)

    def _asked_for(
        self, text: str, asked: Sequence[str], rows: Sequence[RankedId], found: Sequence[RankedId]
    ) -> list[str]:
        """Paths of the members that a question asks for beside the first of ``rows``. Code says itself whose they are:
        there they are those that were ``found`` of the class that is the first row.
        """
        if is_plain(text):
            return self._members.of(text, asked, [row.id for row in rows])
        own = f"{rows[0].id}."
        return [
            row.id
            for row in found
            if row.id.startswith(own) and stems_of(row.id.removeprefix(own)).issubset(asked)
        ]

    def _known(self, hits: Sequence[Hit], question: str, *, is_named: bool) -> Iterator[str]:
        """What one has to know of the first hits, up to the first name: code needs that, behind pages that tell how."""
        for hit in hits:
            yield from self._practice.of(hit.id, question, is_named=is_named)
            if not hit.is_page:
                return

    def _on_steps(self, overview: TopicOverview) -> list[str]:
        """What one has to know of the operators that a topic's steps run: one that ends Blender where it runs here."""
        steps = next((block.text for block in overview.blocks if block.name == STEPS), "")
        said = (note for path in _OPERATOR.findall(steps) for note in self._practice.of(path, ""))
        return [*dict.fromkeys(said)]

    def _compared(self, text: str, told: Sequence[str], limit: int) -> list[RankedId]:
        """The things that a question compares, where the names that are ``told`` are not all of them."""
        sides = sides_of(text)
        if not sides or are_told(sides, told):
            return []
        return meant_by(sides, lambda asked, about: self._ranker.rank(asked, limit, about), self._reader)

    def _compare(
        self,
        text: str,
        meant: Sequence[RankedId],
        found: Sequence[RankedId],
        limit: int,
        notes: Sequence[str],
    ) -> Draft:
        """The answer to a question that compares what is ``meant``; ``found`` is what else there is."""
        told = {row.id for row in meant}
        rows = [*meant, *(row for row in found if row.id not in told)][:limit]
        hits = hits_of(rows, self._reader)
        asked = asked_words(text)
        members = self._members.of(text, asked, [row.id for row in meant])
        blocks = self._told.compared(hits, rows, asked, members, len(meant))
        return draft_of("candidates", hits, notes, blocks)

    def _answer_each(
        self, parts: Sequence[QuestionPart], ranking: Ranking, limit: int, recipe: AskedRecipe | None
    ) -> Draft:
        """The names and the page for each part of a question, in brief, and the first of what one has to know of it:
        behind the ``recipe`` for all of it, if there is one, or else each behind its own.
        """
        blocks = [*_recipe_block(recipe)]
        found: list[list[RankedId]] = []
        for number, part in enumerate(parts, 1):
            told = {row.id for rows in found for row in rows}
            ranked = self._ranker.rank(part.asked, limit, part.about)
            rows = [row for row in self._listed(ranked, limit) if row.id not in told]
            hits = hits_of(rows, self._reader)
            names = [place for place, hit in enumerate(hits) if not hit.is_page]
            pages = [place for place, hit in enumerate(hits) if hit.is_page]
            chosen = [*names[:_NAMES_OF_A_PART], *pages[:_PAGES_OF_A_PART]]
            lines = [f"- {self._lines.line(hits[place], rows[place])}" for place in chosen]
            first = [hits[place] for place in chosen[:1]]
            known = [*self._known(first, part.asked, is_named=False)][:_KNOWN_OF_A_PART]
            known, own = _one_way(known, None if recipe else self._likely_recipe(part.asked))
            lines = [
                *(block.text for block in _recipe_block(own)),
                *self._topics.first_steps(part.topic, _STEPS_OF_A_PART),
                *known,
                *lines,
            ]
            blocks.append(AnswerBlock("\n".join((f"**{number}. {part.text}**", *lines)), part.text))
            found.append([rows[place] for place in sorted(chosen)])
        # In turns, as each part is one of several answers.
        ids = dict.fromkeys(row.id for rows in zip_longest(*found) for row in rows if row)
        hits = hits_of(_in_given_order([*ids][:limit], "part"), self._reader)
        note = f"The question has {len(parts)} parts, each answered in brief. Ask one alone for all of its answer."
        return draft_of(
            "candidates", hits, (note, *ranking.notes, *self._source_notes(ranking, hits)), blocks
        )

    def _listed(self, ranking: Ranking, limit: int) -> list[RankedId]:
        """The ids that the answer lists. Whoever asks for more than usual wants what is far, too."""
        if limit > LIMIT:
            return ranking.ranked[:limit]
        return ranking.listed(limit, self._reader.manual.is_page)

    def _source_notes(self, ranking: Ranking, hits: Sequence[Hit]) -> Iterator[str]:
        """Notes on the documentation behind the answer: pages of other versions, missing sources."""
        minor = self._reader.meta.get("minor", "")
        pages = [page for hit in hits if hit.is_page and (page := self._reader.manual.page_entry(hit.id))]
        for version in sorted({page.version for page in pages} - {minor, ""}):
            yield f"These pages are from the documentation of Blender {version}, not {minor}."
        if (missing := self._reader.manual.missing_sources) and not ranking.named:
            without = " and the ".join(missing)
            yield f"This base was built without the {without}; `simworlds kb info {minor}` says why."

    def _much_used(self, text: str) -> list[str]:
        """The members that scripts use much and that are called by a word: of ``rotation``, an object's."""
        named = self._reader.names.members_named_after(text.lower()) if text.isidentifier() else []
        return [entry.path for entry in self._reader.usage.heaviest(named, _MUCH)[:_MUCH_USED]]

    def _overview(
        self,
        topic: str,
        ranking: Ranking,
        limit: int,
        recipe: AskedRecipe | None = None,
        members: Sequence[str] = (),
    ) -> Draft:
        """What there is on a topic, with the ``members`` that are called so; a page with the title of a task is told
        behind the recipe for that.
        """
        overview = self._topics.overview(topic)
        lead = (*members[:1], *overview.settings[:_SETTINGS])
        ids = dict.fromkeys((topic, *lead, *overview.members, *(row.id for row in ranking.ranked)))
        hits = hits_of(_in_given_order([*ids][:limit], "topic"), self._reader)
        notes = (*self._source_notes(ranking, hits), *self._on_steps(overview))
        head = _with_members(overview.first, [*self._lines.by_path(members)])
        if not overview.is_single:
            return draft_of("page", hits, notes, (*head, *overview.more))
        told = "".join(block.text for block in head)
        rows = [row for row in self._listed(ranking, limit) if row.id != topic and not _is_told(row.id, told)]
        page = (
            () if overview.says_how else [*self._blocks.excerpt(hits[0], RankedId(topic, 1.0, "topic"))][1:]
        )
        blocks = (
            *_recipe_block(recipe if recipe and recipe.is_said else None),
            *head,
            *page,
            *self._lines.further(hits_of(rows, self._reader), rows),
            *overview.more,
        )
        return draft_of("page", hits, notes, blocks)


def _one_way(known: Sequence[str], recipe: AskedRecipe | None) -> tuple[Sequence[str], AskedRecipe | None]:
    """The same, with one way to do a task: a recipe that is sure to be for it, or else a sentence that does it."""
    if recipe is None or HOW_TO.isdisjoint(known):
        return known, recipe
    return ([text for text in known if text not in HOW_TO], recipe) if recipe.is_sure else (known, None)


def _recipe_block(recipe: AskedRecipe | None) -> list[AnswerBlock]:
    return [AnswerBlock(recipe.text, "recipe")] if recipe else []


def _with_members(blocks: Sequence[AnswerBlock], lines: Sequence[str]) -> list[AnswerBlock]:
    """The blocks on a topic with the lines of members that are called so behind the first, which says what it is."""
    named = [AnswerBlock("\n".join(("**Most used**", *lines)), "members called so")] if lines else []
    return [*blocks[:1], *named, *blocks[1:]]


def _with_recipe(
    blocks: Iterable[AnswerBlock], recipe: AskedRecipe | None, *, is_first: bool
) -> list[AnswerBlock]:
    """An answer behind the recipe that is asked for, or with one that may be of use behind the best hit."""
    others = [*blocks]
    beside = (place for place, block in enumerate(others) if block.name in _BESIDE)
    told = 0 if is_first else next(beside, len(others))
    return [*others[:told], *_recipe_block(recipe), *others[told:]]


def _in_given_order(ids: Iterable[str], why: Literal["part", "topic"]) -> list[RankedId]:
    """Ids that no search has ranked, with scores that fall from one to the next."""
    return [RankedId(identifier, 1.0 - _LESS * place, why) for place, identifier in enumerate(ids)]


def _is_told(path: str, text: str) -> bool:
    """Whether a text has a name: the path, or its last part as code and its owner."""
    owner, _, name = path.removeprefix(TYPES).rpartition(".")
    return path in text or (bool(owner) and f"`{name}`" in text and f"`{owner}`" in text)
