"""How much each signal of the search counts; see :mod:`kb_serve.rank.signals`.

Chosen by hand, near what ``python -m measurements.fit_weights`` finds; ``make bench`` shows what each of them brings.
"""

WEIGHTS: dict[str, float] = {
    "text": 1.0,
    "asked": 0.6,
    "counts": 0.1,
    "code": 0.3,
    "called": 1.0,
    "unasked node": -0.4,
    "unasked area": -0.25,
    "unasked removal": -0.3,
    "rarely asked": -0.35,
    "index": -1.0,
    "chapter": 0.1,
}
