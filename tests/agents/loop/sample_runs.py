"""Journals as the loop writes them, made up for tests: a row for each event, with a clock that goes on."""

from __future__ import annotations

import hashlib
import json
from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING, Any

from PIL import Image, ImageDraw

if TYPE_CHECKING:
    from pathlib import Path

PROMPT = (
    "Twelve wooden dominoes stand in a chain on a table; the first is tipped and the cascade runs to the end"
)
MODEL = "claude-opus-5-5"
STAGES = ("modeling", "uv", "texture", "deformation_setup", "motion", "camera", "light")


class Tape:
    """Rows that follow each other; in a folder, pictures too."""

    def __init__(self, folder: Path | None = None, *, live: bool = True) -> None:
        self.rows: list[dict[str, Any]] = []
        self.folder = folder
        self.live = live
        self.now = datetime(2026, 11, 20, 10, 0, 0, tzinfo=UTC)
        self._numbers: dict[tuple[str, ...], int] = {}

    def add(self, kind: str, wait: float = 0.5, /, **fields: Any) -> dict[str, Any]:
        self.now += timedelta(seconds=wait)
        stamp = self.now.isoformat(timespec="milliseconds")
        self.rows.append({"i": len(self.rows) + 1, "t": stamp, "type": kind, **fields})
        return self.rows[-1]

    def pause(self, seconds: float) -> None:
        self.now += timedelta(seconds=seconds)

    def number(self, *lane: str) -> int:
        self._numbers[lane] = self._numbers.get(lane, 0) + 1
        return self._numbers[lane]

    def began(self, prompt: str = PROMPT, **fields: Any) -> None:
        source = "live" if self.live else "recorded: dominoes"
        model = MODEL if self.live else "hand-written"
        given = {
            "version": "0.1.0",
            "mode": "make",
            "prompt": prompt,
            "models": dict.fromkeys(("planner", "coder", "reviewer", "final_reviewer"), model),
            "blender": "5.1.2",
            "source": source,
            "options": {"max_cost": 5.0},
        }
        self.add("run.began", 0.0, **{**given, **fields})
        self.session()

    def session(self) -> None:
        self.add("sitting.began", 0.0, pid=4242)

    def says(
        self, role: str, stage: str, *blocks: str | dict[str, Any], seconds: float = 6.0, cost: float = 0.031
    ) -> None:
        """A model's turn: words, and tools that it calls."""
        n = self.number(role, stage)
        self.add("model.asked", 0.1, n=n, role=role, stage=stage, model=MODEL, digest="d", parts=[], texts={})
        content = [{"type": "text", "text": one} if isinstance(one, str) else one for one in blocks]
        usage = {"input": 820, "output": 410, "cache_read": 15_200, "cache_write": 1_300}
        turn = {
            "content": content,
            "stop_reason": "tool_use" if any(isinstance(one, dict) for one in blocks) else "end_turn",
            "usage": usage if self.live else dict.fromkeys(usage, 0),
            "model": MODEL if self.live else "hand-written",
            "cost": cost if self.live else 0.0,
            "lost": dict.fromkeys(usage, 0),
            "stop_details": "",
            "live": self.live,
        }
        self.add("model.answered", seconds, n=n, role=role, stage=stage, turn=turn)

    def uses(
        self,
        role: str,
        stage: str,
        attempt: int,
        name: str,
        given: dict[str, Any],
        text: str,
        *,
        pictures: tuple[str, ...] = (),
        failed: bool = False,
        seconds: float = 2.0,
    ) -> None:
        """A tool's call and what came of it."""
        who = {"n": self.number("tool", role, stage), "role": role, "stage": stage, "attempt": attempt}
        self.add("tool.called", 0.1, **who, name=name, input=given)
        content = [{"type": "text", "text": text}, *({"type": "picture", "path": one} for one in pictures)]
        self.add(
            "tool.answered", seconds, **who, name=name, content=content, data={"seconds": seconds},
            failed=failed, seconds=seconds, checkpoint=None if failed else who["n"],
        )  # fmt: skip

    def codes(self, stage: str, attempt: int, words: str, code: str, result: str, **how: Any) -> None:
        """The coder says something and runs code."""
        call = {"type": "tool_use", "id": "t1", "name": "blender_execute", "input": {"code": code}}
        self.says("coder", stage, words, call)
        self.uses("coder", stage, attempt, "blender_execute", {"code": code}, result, **how)

    def looks(self, role: str, stage: str, attempt: int, name: str, title: str) -> None:
        """A role has a preview made."""
        call = {"type": "tool_use", "id": "t2", "name": name, "input": {"system": title}}
        self.says(role, stage, call, seconds=2.0)
        path = self.picture(f"{title}\n{stage} {attempt}")
        self.uses(role, stage, attempt, name, {"system": title}, f"{title}: 4 views", pictures=(path,))

    def picture(self, words: str, size: tuple[int, int] = (768, 432)) -> str:
        """A picture in the run's folder; its path."""
        name = f"pictures/{hashlib.sha256(words.encode()).hexdigest()[:24]}.png"
        if self.folder:
            path = self.folder / name
            path.parent.mkdir(exist_ok=True)
            image = Image.new("RGB", size, (58, 66, 78))
            pen = ImageDraw.Draw(image)
            for place in range(12):
                left = size[0] * (0.1 + place * 0.066)
                lean = size[1] * 0.02 * (len(words) % 7)
                foot, top = size[1] * 0.7, size[1] * 0.45
                right = left + size[0] * 0.018
                pen.polygon(
                    [(left, foot), (right, foot), (right + lean, top), (left + lean, top)], (194, 140, 84)
                )
            pen.text((12, 12), words, (240, 240, 240))
            image.save(path)
        return name

    def tactic(self, stage: str, attempt: int, goal: str) -> None:
        plan = {
            "stage": stage,
            "goal": goal,
            "assets": [{"target": "Table", "task": "A top 1.6 m wide with its surface at 0.75 m."}],
            "relations": [0, 1],
            "acceptance": ["Every domino stands on the table.", "The gaps are 2.5 cm."],
            "questions": ["Do all twelve dominoes stand upright?", "Is the first one's face free?"],
        }
        self.says("planner", stage, json.dumps(plan), cost=0.052)
        self.add("tactic", 0.1, stage=stage, attempt=attempt, plan=plan)

    def judged(
        self,
        stage: str,
        attempt: int,
        taken: str,
        findings: tuple[dict[str, Any], ...] = (),
        *,
        blocking: bool = False,
        wanted: str = "",
        instructions: str = "Move every domino down by its gap.",
    ) -> None:
        """Verifier, reviewer and planner have their say."""
        hard = sum(one["severity"] == "hard" for one in findings)
        self.add(
            "verified", 1.4, stage=stage, attempt=attempt, ok=not hard, hard=hard,
            soft=len(findings) - hard, seconds=1.4, findings=list(findings),
        )  # fmt: skip
        judgements = [
            {"question": "Do all twelve dominoes stand upright?", "holds": not blocking, "evidence": "Front view: "
             "twelve boxes, none tilted." if not blocking else "The side view shows a gap below the dominoes."},
            {"question": "Is the first one's face free?", "holds": True, "evidence": "Nothing left of Domino.01."},
        ]  # fmt: skip
        review = {"judgements": judgements, "blocking": blocking, "summary": "The row is even."}
        self.says("reviewer", stage, json.dumps(review), cost=0.018)
        self.add("reviewed", 0.1, stage=stage, attempt=attempt, review=review)
        if taken == "advance":
            self.add("decided", 0.1, stage=stage, attempt=attempt, taken=taken)
            return
        decision = {"transition": wanted or taken, "reason": "The verifier measured it; the picture agrees."}
        if decision["transition"] == "retry":
            decision["instructions"] = instructions
        self.says("planner", stage, json.dumps(decision), cost=0.04)
        self.add(
            "decided", 0.1, stage=stage, attempt=attempt, decision=decision, taken=taken,
            overruled=bool(wanted), why=f"It is open.{f' There is no {wanted} left.' if wanted else ''}",
        )  # fmt: skip

    def simple_stage(self, stage: str) -> None:
        """A stage that goes through at once."""
        self.add("stage.began", stage=stage)
        self.tactic(stage, 1, f"Make the {stage} as planned.")
        self.add("attempt.began", stage=stage, attempt=1)
        self.codes(
            stage, 1, f"I do the {stage}.", f"import bpy\nprint({stage!r})\n", f"{stage}\n\nNo changes."
        )
        self.add("attempt.ended", stage=stage, attempt=1, report=f"The {stage} is done.", ended="done")
        self.judged(stage, 1, "advance")
        self.closed(stage, 1)

    def closed(self, stage: str, attempts: int) -> None:
        self.add("stage.closed", stage=stage, attempts=attempts, file=f"checkpoints/{stage}.blend")

    def ended(self, outcome: str = "done", why: str = "") -> None:
        done = outcome == "done"
        self.add(
            "run.ended",
            outcome=outcome,
            why=why,
            file="scene.blend" if done else "",
            video="video.mp4" if done else "",
        )


def write(tape: Tape, folder: Path) -> Path:
    """The journal, in the run's folder."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "journal.jsonl"
    path.write_text("".join(json.dumps(row, ensure_ascii=False) + "\n" for row in tape.rows), "utf-8")
    return path
