# SPDX-License-Identifier: Apache-2.0
"""Which answers are right, and what share of the full store's right answers a small one gives."""
import collections

import days

MAX_METRES = 0.05
MAX_LATE = {"seen": days.SECOND // 2}  # Else 2 s. Unit: ns.
AGES = [("0-7 days", 0, 7), ("7-30 days", 7, 30), ("30-90 days", 30, 10_000)]
DAY = 86_400 * days.SECOND


def is_right(question, answer):
    """Whether an answer is right. None, that is no answer, never is."""
    truth = question["truth"]
    if answer is None:
        return False
    if question["kind"] == "where":
        return sum((a - b) ** 2 for a, b in zip(answer, truth, strict=True)) <= MAX_METRES**2
    if question["kind"] == "when":
        return abs(answer - truth) <= MAX_LATE.get(question["ask"], 2 * days.SECOND)
    return answer == truth


def rights(questions, answers):
    return [is_right(question, answer)
            for question, answer in zip(questions, answers, strict=True)]


def alike(questions):
    """Lists of the questions of each sort."""
    groups = collections.defaultdict(list)
    for question in questions:
        groups[question["kind"], question["ask"]].append(question)
    return groups.values()


def is_right_like(question, like):
    """Whether the right answer to `like` would be one to `question`: of `when`, the time since."""
    answer = like["truth"]
    if question["kind"] == "when":
        answer = question["time"] - (like["time"] - like["truth"])
    return is_right(question, answer)


def constant_rights(questions):
    """What the best constant answer to each sort of question gets right, chosen with the truth."""
    right = {}
    for group in alike(questions):
        best = max(([is_right_like(one, like) for one in group] for like in group), key=sum)
        right |= {one["number"]: each for one, each in zip(group, best)}
    return [right[one["number"]] for one in questions]


def chance_rights(questions):
    """How probably the right answer to another question of the same sort, drawn evenly, is right.

    Of images it is one of the candidates, drawn evenly.
    """
    right = {}
    for group in alike(questions):
        for one in group:
            others = [like for like in group if like is not one]
            hits = sum(is_right_like(one, like) for like in others)
            right[one["number"]] = 1 / len(one["candidates"]) if "candidates" in one else (
                hits / len(others) if others else 0)
    return [right[one["number"]] for one in questions]


def age_of(question, now):
    """The name of the age of the moment that is asked for."""
    past_days = (now - question["moment"]) / DAY
    return next(name for name, begin, end in AGES if begin <= past_days < end)


def share(full, right):
    """Share, of what is right of the full store, that is right here too; None of nothing."""
    known = [here for there, here in zip(full, right, strict=True) if there]
    return sum(known) / len(known) if known else None


def table_of(questions, full, right, now):
    """Shares by kind and age, with the number of questions that the full store answers rightly."""
    rows = {}
    for kind in ["where", "when", "what", "all"]:
        for age in [name for name, _, _ in AGES] + ["all"]:
            chosen = [i for i, one in enumerate(questions) if kind in ("all", one["kind"])
                      and age in ("all", age_of(one, now))]
            rows[f"{kind}, {age}"] = {
                "full": sum(full[i] for i in chosen),
                "share": share([full[i] for i in chosen], [right[i] for i in chosen])}
    return rows


def by_ask(questions, full, right):
    """Shares of each sort of question."""
    result = {}
    for name in sorted({f"{one['kind']} {one['ask']}" for one in questions}):
        chosen = [i for i, one in enumerate(questions) if f"{one['kind']} {one['ask']}" == name]
        result[name] = {"questions": len(chosen), "full": sum(full[i] for i in chosen),
                        "share": share([full[i] for i in chosen], [right[i] for i in chosen])}
    return result
