"""Where a value of an enumeration is taken that not everything takes, as data, and in words.

A leaf module: it imports nothing of the project.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

_SAID = {
    "never": "by none that was tried",
    "at times": "where the machine or a setting allows it",
    "before": "before Blender {version}",
}
_NAMED_VALUES = 6
_NAMED_SETTINGS = 3
_NAMED_THINGS = 16  # a condition that is cut off tells nobody whether it holds


class Setting(NamedTuple):
    """A setting that has one of these values: ``media_type``, or ``FFmpegSettings.codec`` of another struct.

    ``also`` tells of a value what a second setting beside must be.
    """

    name: str
    values: tuple[str, ...]
    also: tuple[tuple[str, Setting], ...] = ()

    @classmethod
    def of(cls, row: Sequence[Any]) -> Setting:
        """From what JSON makes of one."""
        name, values, also = row
        return cls(name, tuple(values), tuple((value, cls.of(second)) for value, second in also))

    @property
    def text(self) -> str:
        """``codec='AV1'|'PRORES' (with profile='4444')``."""
        also = dict(self.also)
        shown = [
            repr(value) + (f" (with {also[value].text})" if value in also else "")
            for value in self.values[:_NAMED_VALUES]
        ]
        return f"{self.name}={'|'.join(shown)}" + ("|…" if len(self.values) > _NAMED_VALUES else "")


class Beside(NamedTuple):
    """With a ``mode`` of the own struct a value is taken only if a setting of another struct is as ``needed``."""

    mode: Setting
    needed: Setting

    @classmethod
    def of(cls, row: Sequence[Any]) -> Beside:
        """From what JSON makes of one."""
        mode, needed = row
        return cls(Setting.of(mode), Setting.of(needed))


class Taken(NamedTuple):
    """Where a value is taken: ``only`` with what is named, or with all else (``not``).

    ``never`` is by none that was tried, ``at times`` where the machine which was asked did not have it, and others do;
    ``before`` is in versions before ``version``.

    Named are ``settings``, of which one must be so, or what the ``things`` are called that take it, or the ``places``
    that these are in: classes of node trees; of those there, ``there`` tells which. With both ``things`` and
    ``settings``, these things take it with the settings alone, and all others always.
    ``in_some_modes``: also with the settings only in modes that nothing tells apart.
    """

    how: Literal["only", "not", "never", "at times", "before"]
    settings: tuple[Setting, ...] = ()
    things: tuple[str, ...] = ()
    places: tuple[str, ...] = ()
    there: Taken | None = None
    beside: Beside | None = None
    in_some_modes: bool = False
    version: str = ""

    @classmethod
    def of(cls, row: Sequence[Any]) -> Taken:
        """From what JSON makes of one, or one itself."""
        how, settings, things, places, there, beside, in_some_modes, version = row
        return cls(
            how,
            tuple(map(Setting.of, settings)),
            tuple(things),
            tuple(places),
            cls.of(there) if there else None,
            Beside.of(beside) if beside else None,
            in_some_modes,
            version,
        )

    @property
    def deciding_things(self) -> tuple[str, ...]:
        """The things that alone take it, or do not; none where something else decides."""
        return () if self.settings else self.things

    @property
    def deciding_setting(self) -> Setting | None:
        """The one setting that alone decides, but for what ``beside`` adds."""
        is_one = len(self.settings) == 1 and not self.things and not self.in_some_modes
        return self.settings[0] if is_one else None

    @property
    def wants_a_setting(self) -> bool:
        """Whether it is taken only with some setting, of whatever takes it."""
        return self.how == "only" and not (self.things or self.places or self.in_some_modes)

    @property
    def is_by_setting(self) -> bool:
        """Whether a setting has a say in it."""
        return bool(self.settings or self.beside or (self.there and self.there.is_by_setting))

    @property
    def condition(self) -> Taken:
        """What it depends on, whether it is taken only so or only else."""
        return self._replace(how="only") if self.how == "not" else self

    @property
    def text(self) -> str:
        """What follows the word "taken": ``only with domain_type='LIQUID'``."""
        return self.worded(", ".join)

    def said(self, things: Callable[[Sequence[str]], str] = ", ".join) -> str:
        """The same with that word: ``taken only by mesh object``, ``not taken with type='EMPTY'``.

        ``things`` words what alone takes it, or does not.
        """
        text = self.worded(things)
        return f"not taken {text.removeprefix('not ')}" if text.startswith("not ") else f"taken {text}"

    def worded(self, things: Callable[[Sequence[str]], str]) -> str:
        """The text, in which ``things`` words what alone takes it, or does not."""
        if self.how in _SAID:
            return _SAID[self.how].format(version=self.version)
        if self.beside:
            return self._text_beside(self.beside)
        if self.places:
            there = f", and there {self.there.worded(things)}" if self.there else ""
            return f"{self.how} in {' or '.join(f'a {place}' for place in self.places)}{there}"
        settings = f"with {_settings(self.settings)}"
        if self.things and self.settings:
            return f"by {_things(self.things, ', '.join)} only {settings}"
        if self.things:
            return f"{self.how} by {_things(self.things, things)}"
        return f"{self.how} {'in some modes, and only ' if self.in_some_modes else ''}{settings}"

    def _text_beside(self, beside: Beside) -> str:
        mode, needed = f"with {beside.mode.text}", beside.needed.text
        if self.settings:
            return f"{self.how} with {_settings(self.settings)}; {mode} only if {needed}"
        return f"only {mode} if {needed}" if self.how == "only" else f"{mode} only if {needed}"


NEVER = Taken("never")
AT_TIMES = Taken("at times")


def _settings(settings: Iterable[Setting]) -> str:
    """``system='NONE'|'IMPERIAL'``; several are alternatives."""
    shown = [setting.text for setting in settings]
    return " or ".join(shown[:_NAMED_SETTINGS]) + (", …" if len(shown) > _NAMED_SETTINGS else "")


def _things(things: Sequence[str], words: Callable[[Sequence[str]], str]) -> str:
    return words(things[:_NAMED_THINGS]) + (", …" if len(things) > _NAMED_THINGS else "")
