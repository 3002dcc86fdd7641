# SPDX-License-Identifier: Apache-2.0
"""Whether an answer to a dialogue is right.

A dialogue is a line of engram_make_dialogues, an answer one of `engram ask --json`
(docs/dialogues.md).
"""
import datetime

MAX_TIME_S = 0.5
# Of seconds and metres; a hair more, for what is 0.1 but for its last bit.
MAX_AMOUNT = 0.1 + 1e-9


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


def is_equal(wanted, answer):
    value = answer.get("value") or {"kind": "unknown"}
    kind = wanted["kind"]
    if kind != value.get("kind"):
        return False
    if kind == "unknown":
        return True
    if kind == "reason":
        # Its words may be any, so its links must have what is the reason.
        return bool(set(value.get("links") or []) & set(wanted["links"]))
    if kind == "time":
        return are_near(wanted["value"], value["value"])
    if kind == "span":
        return are_near(wanted["from"], value["from"]) and are_near(wanted["to"], value["to"])
    if kind == "names":
        return {*map(plain_name, wanted["value"])} == {*map(plain_name, value["value"])}
    if kind == "events":
        return set(wanted["value"]) == set(value["value"])
    if kind in ("seconds", "metres"):
        return abs(wanted["value"] - value["value"]) <= MAX_AMOUNT
    return wanted["value"] == value["value"]


def is_refused(answer):
    return (answer.get("value") or {"kind": "unknown"}).get("kind") == "unknown"


def is_right(dialogue, answer):
    """Not to know is right only where nothing can be known, whatever `also` says."""
    if dialogue["answerable"] and is_refused(answer):
        return False
    return any(is_equal(wanted, answer) for wanted in [dialogue["value"], *dialogue["also"]])


def is_shown(dialogue, answer):
    """Whether an answer shows what proves it; None where nothing proves it: nothing happened."""
    if not dialogue["evidence"]:
        return None
    return bool(shown(answer) & set(dialogue["evidence"]))


def is_later(link, now):
    """Whether an instance is of after the question, when nobody could know it."""
    time = link.split("/")[-2]
    return moment(time) > moment(now) + 1e-6
