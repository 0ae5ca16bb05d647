"""What stands around a question and asks nothing: greetings, thanks, who asks, that it is to be done in Python."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.index.analysis import STOP_WORDS, tokens
from kb_serve.rank.asked_words import SCRIPT_WORDS

if TYPE_CHECKING:
    from collections.abc import Set

# Not behind the dot of ``from . import``.
_SENTENCES = re.compile(r"(?<=[\w)\"'!?][.!?])\s+|(?<=[.!?][\"')])\s+")
_TILL_COLON = re.compile(r"^([^.!?:]{1,80}):\s+")
_ABBREVIATIONS = re.compile(r"\b(?:e\.\s?g|i\.\s?e)\b\.?[,:]?", re.IGNORECASE)
_GREETING = re.compile(
    r"^(?:hello|hi|hey|greetings|good (?:morning|day|evening))\b[^.!?:,\d]{0,30}[,!.:]\s*", re.IGNORECASE
)
_THANKS = re.compile(
    r"[,.]?\s*\b(?:(?:many |big )?(?:thanks|thank you|thx|cheers)"
    r"(?: (?:a lot|so much|very much|in advance|everyone|guys|for (?:any |the |your )?help))*|please|pls|plz)[\s.!]*$",
    re.IGNORECASE,
)
_ORDER = re.compile(
    r"^(?:please |can you |could you )*(?:give|show|send|tell|write|provide|generate)(?: me| us)?(?: an?| the| some)?"
    r"(?: (?:short|small|simple|working|blender|bpy|python))*"
    r" (?:code|scripts?|snippet)(?: (?:that (?:can|will)|to|for|which|that)\b|\s*:)\s*",
    re.IGNORECASE,
)
# Words that ask for help, whatever it is for.
_WORDS = frozenset(
    """advance answer anybody anyone anything appreciate appreciated beginner beginners best cheers coding correct
    correctly easiest easy everybody everyone everything exact exactly example examples explain fail failed fails
    folks greetings guide guys hello help hey hi hint idea ideas kind know language learn learning little minimal
    new newbie nobody noob nothing please pls plz possible problem programming question questions quick quickly
    recommended right scripting scripts simple simplest solution somebody someone something stuck suggestion
    suggestions sure tell thank thanks think thx today tried tries try trying tutorial understand unsure use using
    ve version welcome wondering work working works write writing wrong
    """.split()  # noqa: SIM905 - so many words read best as a paragraph
)
_ASIDE = re.compile(r"\s+\(([^()]*)\)")
_OF_BLENDER = frozenset({"blender", "bpy", "python"})
_IN_PYTHON = "in Python"
_LETTERS = re.compile(r"[^\W\d]")


def without_frame(text: str) -> str:
    """A text without the sentences that ask nothing; as it is where no other is left, and where it is one name."""
    if " " not in text:
        return text
    asked = " ".join(_ABBREVIATIONS.sub("", text).split())
    for pattern in (_GREETING, _THANKS):
        asked = pattern.sub("", asked) or asked
    asked = _ASIDE.sub(lambda aside: "" if _asks_nothing(aside[1], _OF_BLENDER) else aside[0], asked)
    if (head := _TILL_COLON.match(asked)) and _asks_nothing(head[1]):
        asked = asked[head.end() :]
    sentences = [sentence for sentence in _SENTENCES.split(asked) if not _asks_nothing(sentence)]
    told = _ORDER.sub("", " ".join(sentences)).strip()
    if not _LETTERS.search(told):
        return text
    # Who wants a script gets names before pages: that it is for one is not lost.
    is_lost = _for_script(text) and not _for_script(told)
    return f"{told} {_IN_PYTHON}" if is_lost else told


def _for_script(text: str) -> bool:
    return not SCRIPT_WORDS.isdisjoint(tokens(text.lower()))


def _asks_nothing(sentence: str, some: Set[str] = STOP_WORDS | _WORDS) -> bool:
    """Whether a sentence has words that frame a question, ``some`` among them, and no others."""
    said = {word.lower() for word in tokens(sentence) if len(word) > 1 and not word[0].isdigit()}
    return "(" not in sentence and not some.isdisjoint(said) and said <= (STOP_WORDS | _WORDS)
