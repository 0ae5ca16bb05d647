"""Takes a question of several parts apart: ``make a cube fall, bake it and render a film``."""

from __future__ import annotations

import re
from typing import NamedTuple

from kb_serve.recognise.message_patterns import is_message

_CODE = re.compile(r"[`()=\[\]{}_/\\<>\"]|\w\.\w|[a-z][A-Z]|::")
_BETWEEN = re.compile(
    r"\s*[,;.?!]\s+(?:(?:and|then|also|finally|afterwards)\s+)*|\s+(?:and|then)\s+(?:(?:then|also|finally)\s+)*",
    re.I,
)
# What frames a request, before its verb.
_FRAME = re.compile(
    r"(?:(?:how|do|can|should|would|i|you|we|want|need|like|to|please|first|next|then|now)\s+)*", re.I
)
# Verbs that nothing in Blender is called by.
_VERBS = frozenset(
    """add append apply assign attach build calculate change choose compute convert create delete disable duplicate
    emit enable evaluate find freeze generate get give hide insert install list load make merge move open parent put
    randomize read remove rename replace retarget reset rotate run save select send separate set shoot show
    simulate spawn store swap throw triangulate turn unlink unwrap update use write""".split()  # noqa: SIM905
)
# Those that may be names as well ("render and bake settings"): after "and" alone, one of the words below must follow.
_ALSO_NAMES = frozenset(
    """animate bake bend blend bring color connect copy cut drive drop export extrude fill flip fracture group import
    instance join keyframe light limit link lock loop measure mirror mix model output paint pin place play point pose
    print record render repeat rig scale scatter sculpt shade shrink smooth snap split start stick stop subdivide switch
    texture track transfer weight weld""".split()  # noqa: SIM905
)
# Verbs of a topic that each kind of thing has its own way of, and of one whose steps are of nothing in particular.
_BY_KIND = frozenset({"bake", "extrude"})
_OF_ALL = frozenset({"animate"})
_OBJECTS = frozenset(
    "a an all another both each every everything him it its my one our that the their them these this those two".split()  # noqa: SIM905
)
# Who does a thing and its opposite to one object asks how it changes.
_OPPOSITES = (
    frozenset({"hide", "show"}),
    frozenset({"enable", "disable"}),
    frozenset({"link", "unlink"}),
    frozenset({"start", "stop"}),
)
_PRONOUNS = frozenset("him it that them these this those".split())  # noqa: SIM905
_BEFORE_VERBS = frozenset({"for", "of", "with", "without"})  # what stands before verbs that name buttons
_MOST = 5
_LONGEST_NAME = 4  # words of a thing
_PEOPLE = frozenset({"i", "my", "we", "you"})


def _unframed(text: str) -> str:
    """A request from its verb on."""
    return _FRAME.sub("", text, count=1)


class QuestionPart(NamedTuple):
    """A part as it is written, and the object of the first part, which it may be about."""

    text: str
    about: str = ""

    @property
    def asked(self) -> str:
        """What is asked, with what a pronoun stands for where that decides: ``bake smoke`` of ``simulate smoke and bake
        it``.
        """
        verb, _, rest = _unframed(self.text).partition(" ")
        pronoun, _, behind = rest.partition(" ")
        is_left_open = self.about and verb.lower() in _BY_KIND and pronoun.lower() in _PRONOUNS
        return f"{verb} {self.about} {behind}".rstrip() if is_left_open else self.text

    @property
    def topic(self) -> str:
        """What may be a topic of its own; empty for a verb of what the first part is about: assign it."""
        verb, _, rest = _unframed(self.text).lower().partition(" ")
        is_of_all = verb in _VERBS or verb in _OF_ALL
        return "" if self.about and is_of_all and rest in _PRONOUNS else self.asked


def parts_of(query: str) -> tuple[QuestionPart, ...]:
    """The parts of a question that asks for several actions, in order; none where it may ask for one."""
    text = query.strip(" .?!")
    ends = [(found.start(), found.end()) for found in _BETWEEN.finditer(text)]
    if not ends or _CODE.search(query) or is_message(query):
        return ()
    # What does not begin with a verb says more of what is before it.
    starts = [
        0,
        *(
            end
            for start, end in ends
            if _is_request(text[end:], sure=_is_sure(text[start:end]))
            and not _undoes(text[end:], text)
            and not _shares_object(text[:start])
        ),
    ]
    stops = [*(start for start, end in ends if end in starts), len(text)]
    first, *others = [text[start:stop] for start, stop in zip(starts, stops, strict=True)]
    is_request = _is_request(text, sure=False)
    if not 1 < len(starts) <= _MOST or not (
        is_request or (_is_thing(first) and all(map(_is_of_thing, others)))
    ):
        return ()
    _, _, about = _unframed(first).partition(" ") if is_request else ("", "", first)
    return (QuestionPart(first), *(QuestionPart(clause, about) for clause in others))


def _is_thing(clause: str) -> bool:
    """Whether a clause only names a thing, ``voxel remesh modifier``."""
    said = clause.lower().split()
    return len(said) <= _LONGEST_NAME and (_VERBS | _ALSO_NAMES | _PEOPLE).isdisjoint(said)


def _is_of_thing(clause: str) -> bool:
    """Whether a clause says what is to be done with what is named before: ``and apply it`` of a modifier."""
    return not _PRONOUNS.isdisjoint(_unframed(clause).lower().split()[1:2])


def _is_sure(between: str) -> bool:
    """Whether what stands between two clauses joins no names."""
    return between.strip().lower() != "and"


def _undoes(clause: str, first: str) -> bool:
    """Whether a clause does the opposite of the first one to the same object: ``and show it at frame 40``."""
    verb, *objects = _unframed(clause).lower().split(maxsplit=2)
    before, _, _ = _unframed(first).lower().partition(" ")
    return frozenset({verb, before}) in _OPPOSITES and not _PRONOUNS.isdisjoint(objects[:1])


def _shares_object(before: str) -> bool:
    """Whether what is before a verb is another one of the same object: ``add and remove``, ``with add and remove``."""
    *others, last = _unframed(before).lower().split() or [""]
    return last in _VERBS | _ALSO_NAMES and (not others or others[-1] in _BEFORE_VERBS)


def _is_request(text: str, *, sure: bool) -> bool:
    """Whether a text begins with what is to be done, and says to what."""
    verb, _, rest = _unframed(text).lower().partition(" ")
    is_verb = verb in _VERBS or (verb in _ALSO_NAMES and (sure or rest.partition(" ")[0] in _OBJECTS))
    return is_verb and bool(rest)
