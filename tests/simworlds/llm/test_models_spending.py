"""Tokens and dollars are counted where they are spent, and a limit is kept whatever happens."""

from __future__ import annotations

import threading
from concurrent.futures import ThreadPoolExecutor

import pytest
from asks import OPUS, Scripted, ask

from simworlds.llm import tokens
from simworlds.llm.errors import CutShort, Declined, OverBudget, Unreachable
from simworlds.llm.messages import Text, Turn, Usage
from simworlds.llm.prices import PRICES, Price, Prices, read_price
from simworlds.llm.spending import Metered, Spending


def turn(dollars: float | None = 0.10, live: bool = True, **usage: int) -> Turn:
    return Turn((Text("x"),), "end_turn", Usage(**usage), OPUS, cost=dollars, live=live)


def test_calls_are_counted_by_role_and_stage():
    spending = Spending()
    model = Metered(Scripted(*[turn(input=10, output=5)] * 4), spending)
    for role, stage in (("planner", ""), ("coder", "motion"), ("coder", "motion"), ("coder", "light")):
        model.answer(ask(role=role, stage=stage))
    rows = {(row.role, row.stage): row for row in spending.rows()}
    assert list(rows) == [("planner", ""), ("coder", "motion"), ("coder", "light")]
    assert (rows["coder", "motion"].calls, rows["coder", "motion"].usage) == (2, Usage(20, 10))
    total = spending.total()
    assert (total.calls, total.cost, total.usage.prompt) == (4, pytest.approx(0.4), 40)


def test_stopped_turns_are_counted():
    spending = Spending()
    lost = Unreachable("gone")
    lost.lost = Usage(1_000_000, 0)
    answers = [Declined("no", turn(1.0)), CutShort("short", turn(2.0)), lost, Unreachable("nobody")]
    model = Metered(Scripted(*answers), spending)
    for error in answers:
        with pytest.raises(type(error)):
            model.answer(ask())
    (row,) = spending.rows()
    assert (row.calls, row.cost, row.usage) == (2, pytest.approx(1 + 2 + 4), Usage(1_000_000))


def test_models_without_a_price_are_counted_apart():
    spending = Spending()
    Metered(Scripted(turn(None, input=7)), spending).answer(ask(model="mine"))
    total = spending.total()
    assert (total.calls, total.unpriced, total.cost, total.usage.input) == (1, 1, 0.0, 7)


def test_recorded_turns_cost_nothing():
    spending = Spending()
    Metered(Scripted(turn(5.0, live=False, input=10)), spending).answer(ask())
    total = spending.total()
    assert (total.recorded, total.calls, total.cost, total.usage) == (1, 0, 0.0, Usage())


def test_a_run_that_is_taken_up_again_goes_on_counting():
    spending = Spending(max_cost=1.0)
    spending.carry("coder", "motion", turn(0.99, live=False, output=9))
    assert (spending.total().cost, spending.total().usage.output) == (0.99, 9)
    with pytest.raises(OverBudget, match=r"\$0\.99 are spent"):
        Metered(Scripted(turn()), spending).answer(ask())


def test_no_call_is_made_that_could_cost_more_than_is_left():
    worst = Spending().worst(ask())
    assert worst is not None
    assert worst > 1000 * 20 / 1e6  # the longest answer alone
    model = Scripted(turn(worst), turn(worst))
    spending = Spending(max_cost=worst * 1.5)
    metered = Metered(model, spending)
    metered.answer(ask())
    with pytest.raises(OverBudget, match=r"coder's next call could cost"):
        metered.answer(ask())
    assert len(model.asked) == 1
    spending.max_cost = worst * 2
    metered.answer(ask())


def test_a_limit_of_zero_allows_no_call():
    with pytest.raises(OverBudget):
        Metered(Scripted(), Spending(max_cost=0)).answer(ask())


@pytest.mark.parametrize("limit", [-1.0, float("nan")])
def test_an_invalid_limit_is_an_error(limit):
    with pytest.raises(ValueError, match="limit"):
        Spending(max_cost=limit)


def test_a_limit_cannot_be_kept_without_a_price():
    metered = Metered(Scripted(turn()), Spending(max_cost=5))
    with pytest.raises(OverBudget, match="No price is known for the model 'mine'"):
        metered.answer(ask(model="mine"))
    priced = Spending(max_cost=5, prices=Prices({"mine": Price(1, 1)}))
    Metered(Scripted(turn()), priced).answer(ask(model="mine"))


def test_running_calls_reserve_their_worst_case():
    worst = Spending().worst(ask()) or 0.0
    spending = Spending(max_cost=worst * 2.5)
    go, asked = threading.Event(), threading.Barrier(3)

    class Slow:
        def answer(self, ask, on_text=None):
            asked.wait(60)
            go.wait(60)
            return turn(worst)

    metered = Metered(Slow(), spending)
    with ThreadPoolExecutor(2) as pool:
        calls = [pool.submit(metered.answer, ask()) for _ in range(2)]
        asked.wait(60)
        with pytest.raises(OverBudget):
            metered.answer(ask())
        go.set()
        assert [call.result().cost for call in calls] == [worst, worst]
    assert spending.total().cost == pytest.approx(worst * 2)


def test_real_counts_correct_the_estimate():
    spending = Spending()
    before = spending.worst(ask(max_tokens=1)) or 0.0
    request = ask(max_tokens=1)
    spending.count(request, turn(input=tokens.of_ask(request) * 3))
    assert spending.worst(request) == pytest.approx(before / 1.3 * 3.3, rel=0.1)


def test_costs_follow_the_list():
    usage = Usage(input=1_000_000, output=1_000_000, cache_read=1_000_000, cache_write=1_000_000)
    prices = Prices()
    assert prices.cost("claude-opus-5-5", usage) == pytest.approx(4 + 20 + 0.2 + 5)
    assert prices.cost("claude-haiku-4-5-20251001", usage) == pytest.approx(1 + 5 + 0.1 + 1.25)
    assert prices.cost("claude-fable-5-2", usage) == pytest.approx(8 + 40 + 0.2 + 10)
    assert prices.cost("claude-none", usage) is None


def test_long_prompts_cost_more_where_the_list_says_so():
    short, long = Usage(input=90_000, output=1000), Usage(input=90_000, cache_read=20_000, output=1000)
    prices = Prices()
    assert prices.cost("claude-haiku-5-5", short) == pytest.approx((9000 + 500) / 1e6)
    assert prices.cost("claude-haiku-5-5", long) == pytest.approx(5 * (9000 + 200 + 500) / 1e6)


def test_the_worst_case_is_never_less_than_the_cost():
    for price in PRICES.values():
        for usage in (
            Usage(50_000, 900),
            Usage(0, 900, 0, 50_000),
            Usage(0, 900, 150_000, 9),
            Usage(1, 0, 1, 1),
        ):
            assert price.worst(usage.prompt, usage.output) >= price.cost(usage)


def test_prices_can_be_given_in_words():
    assert read_price("4/20") == Price(4, 20)
    for wrong in ("4", "4/20/3", "a/b", "-1/3", "nan/1", "inf/1", ""):
        with pytest.raises(ValueError, match="not a price"):
            read_price(wrong)


def test_summaries_reckon_with_the_same_prices():
    from kb_build.summaries.models import price_of

    for name, price in PRICES.items():
        for model in (name, f"{name}-latest", f"{name}-20261101"):
            known = price_of(model, None)
            assert (known.input_usd, known.output_usd) == (price.input_usd, price.output_usd)
