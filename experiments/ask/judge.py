# SPDX-License-Identifier: Apache-2.0
"""Whether an answer to a dialogue is right.

A dialogue is a line of engram_make_dialogues, an answer one of `engram ask --json`
(docs/dialogues.md).
"""
import datetime

MAX_TIME_S = 0.5
MAX_SHARE = 0.1
MAX_METRES = 0.05


def moment(text):
    text = text.replace("T", " ").rstrip("Z")
    whole, _, fraction = text.partition(".")
    seconds = datetime.datetime.strptime(whole, "%Y-%m-%d %H:%M:%S").replace(
        tzinfo=datetime.timezone.utc).timestamp()
    return seconds + (float("0." + fraction) if fraction else 0.0)


def are_near(one, other):
    return abs(moment(one) - moment(other)) <= MAX_TIME_S


def plain_name(name):
    """As it is compared: "the right hand" is "right"."""
    name = " ".join(name.casefold().split())
    return name.removeprefix("the ").removesuffix(" hand")


def shown(answer):
    """The IDs that an answer shows as its evidence."""
    ids = [one["id"] for one in answer.get("evidence") or []]
    return set(ids) | set((answer.get("value") or {}).get("links") or [])


def is_equal(wanted, dialogue, answer):
    value = answer.get("value") or {"kind": "unknown"}
    kind = wanted["kind"]
    if kind != value.get("kind"):
        return False
    if kind == "unknown":
        return True
    if kind == "reason":
        return bool(shown(answer) & (set(dialogue["evidence"]) or set(wanted["links"])))
    if kind == "time":
        return are_near(wanted["value"], value["value"])
    if kind == "span":
        return are_near(wanted["from"], value["from"]) and are_near(wanted["to"], value["to"])
    if kind == "names":
        return {*map(plain_name, wanted["value"])} == {*map(plain_name, value["value"])}
    if kind == "events":
        return set(wanted["value"]) == set(value["value"])
    if kind in ("seconds", "metres"):
        slack = MAX_SHARE * abs(wanted["value"])
        return abs(wanted["value"] - value["value"]) <= max(
            slack, MAX_METRES if kind == "metres" else 0)
    return wanted["value"] == value["value"]


def is_right(dialogue, answer):
    return any(is_equal(wanted, dialogue, answer)
               for wanted in [dialogue["value"], *dialogue["also"]])


def is_refused(answer):
    return (answer.get("value") or {"kind": "unknown"}).get("kind") == "unknown"


def is_shown(dialogue, answer):
    """Whether the evidence of an answer has what shows it; nothing shows that nothing happened."""
    return not dialogue["evidence"] or bool(shown(answer) & set(dialogue["evidence"]))
