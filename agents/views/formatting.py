"""How values look to a reader: lengths of time, money, tokens, colours."""

from __future__ import annotations

from typing import TYPE_CHECKING

from simworlds.counting import counted
from simworlds.terminal.text import plain

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agents.loop.record.events import FilmFitted, Verified
    from agents.loop.record.run_state import Attempt, RunState
    from simworlds.llm.messages import Usage
    from simworlds.llm.spending import SpendingRow


def format_time(seconds: float | None) -> str:
    """``0.4 s``, ``42 s``, ``3 min 5 s``, ``2 h 11 min``; "" for none."""
    if seconds is None:
        return ""
    if seconds < 9.95:
        return f"{seconds:.1f} s"
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s" if whole % 60 else f"{whole // 60} min"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


def format_clock(seconds: float) -> str:
    """``03:05``, ``2:11:40``."""
    whole = int(seconds)
    hours, minutes = divmod(whole // 60, 60)
    return f"{hours}:{minutes:02}:{whole % 60:02}" if hours else f"{minutes:02}:{whole % 60:02}"


def format_money(dollars: float) -> str:
    """``$0.42``; ``$0.003`` where cents are too coarse."""
    return f"${dollars:,.2f}" if dollars >= 0.1 or not dollars else f"${dollars:.3f}"


def format_count(number: int) -> str:
    """``812``, ``15.2k``, ``1.30M``."""
    if number < 10_000:
        return f"{number:,}"
    return f"{number / 1000:.1f}k" if number < 999_950 else f"{number / 1e6:.2f}M"


def format_tokens(usage: Usage) -> str:
    """``17.3k in, 410 out``."""
    return f"{format_count(usage.prompt)} in, {format_count(usage.output)} out"


def format_cost(row: SpendingRow) -> str:
    """What was paid, and whether that is all: recorded turns cost nothing, some have no known price."""
    if not row.calls and not row.unpriced and not row.cost:
        return "nothing"
    return format_money(row.cost) + (f" and {row.unpriced} of unknown price" if row.unpriced else "")


def swatch(linear: Sequence[float]) -> str:
    """A linear RGB colour (Rec. 709, from 0 to 1) as CSS has it (sRGB, IEC 61966-2-1)."""
    return "#" + "".join(f"{round(_encoded(value) * 255):02x}" for value in linear[:3])


def _encoded(value: float) -> float:
    value = min(1.0, max(0.0, value))
    return value * 12.92 if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055


# Runs


def describe_source(run_state: RunState) -> str:
    """Where the answers came from, in a sentence that nobody can misread; "" for a live run."""
    source = plain(run_state.source)
    calls = run_state.total.calls
    recorded = run_state.total.recorded
    match run_state.answers or ("" if source in ("", "live") else "recorded"):
        case "hand-written":
            return (
                f"No model was asked in this run: its answers were written beforehand ({source}). Blender, the "
                "physics, the verifier and the pictures are real."
            )
        case "recorded":
            return (
                f"No model was asked in this run: its answers were played back from a record ({source}). Blender, "
                "the physics, the verifier and the pictures are real."
            )
        case "mixed":
            return f"{counted(calls, 'answer')} came live from a model; {recorded:,} were played back from a record."
        case _:
            return ""


STAGE_TITLES = {
    "modeling": "Modeling",
    "uv": "UV",
    "texture": "Texture",
    "deformation_setup": "Deformation setup",
    "motion": "Motion",
    "camera": "Camera",
    "light": "Light",
    "render": "Render",
}


def stage_title(name: str) -> str:
    """The stage's name as a heading."""
    return STAGE_TITLES.get(name) or plain(name)


def describe_film(film: FilmFitted) -> str:
    """How a film is rendered, how long that takes, and what was lowered for it."""
    size = f"{counted(film.frames, 'frame')}, {film.width}×{film.height}, {counted(film.samples, 'sample')}"
    time = f"about {format_time(film.seconds)} of the {film.minutes:g} min that it may take"
    return f"Film: {size}, {time}{f'; lowered: {plain(film.lowered)}' if film.lowered else ''}"


def describe_frames(rendered: int, film: FilmFitted | None) -> str:
    """How many frames a film has, and how many of them were rendered in its time."""
    if film is None or rendered >= film.frames:
        return counted(rendered, "frame")
    return f"{counted(film.frames, 'frame')}, {rendered} of them rendered and the others repeated"


def format_hard(verified: Verified) -> list[str]:
    """How many hard findings there are, and how many hard rules could not be decided; nothing of what there is none."""
    unsure = sum(one.severity == "hard" and one.outcome != "broken" for one in verified.findings)
    broken = max(0, verified.hard - unsure)
    told = [counted(broken, "hard finding")] if broken else []
    return [*told, *([f"{counted(unsure, 'hard rule')} undecided"] if unsure else [])]


def describe_attempt(attempt: Attempt) -> str:
    """What came of an attempt, in a few words."""
    found = attempt.verification
    taken = attempt.choice.taken if attempt.choice else ""
    words = {
        "advance": "closed the stage",
        "retry": "sent back",
        "replan": "planned anew",
        "abort": "given up",
    }
    told = words.get(taken) or (plain(attempt.ended) if attempt.ended not in ("", "done") else "")
    faults = format_hard(found) if found else []
    faults += ["the reviewer blocks"] if attempt.review and attempt.review.blocks else []
    return ": ".join(filter(None, [told, ", ".join(faults)]))
