# SPDX-License-Identifier: Apache-2.0
"""Kinds of faults. Each changes a kitchen at one place and says what has to be found there, or
returns None where the kitchen has no such place."""
import dataclasses

import numpy as np
from kitchens import CAMERA, JOINTS, PLATFORM, Snap

SECOND = 10**9


@dataclasses.dataclass
class Fault:
    kind: str
    entity: str
    first: int
    last: int
    #: Kinds of findings of which any counts.
    wanted: tuple


class Places:
    """Where faults are already: no two of one entity within five seconds."""

    def __init__(self):
        self.taken = []

    def is_free(self, entity, first, last):
        margin = 5 * SECOND
        return all(other != entity or last + margin < begin or end + margin < first
                   for other, begin, end in self.taken)

    def take(self, entity, first, last):
        self.taken.append((entity, first, last))


def span_of(kitchen, places, rng, entity, low_s, high_s, begin_s=2.0, end_s=2.0):
    """A free span of an entity, away from begin and end of the recording."""
    for _ in range(60):
        length = int(rng.uniform(low_s, high_s) * SECOND)
        first_time, last_time = kitchen.entities[entity][0].time, kitchen.entities[entity][-1].time
        room = last_time - first_time - length - int((begin_s + end_s) * SECOND)
        if room <= 0:
            return None
        first = first_time + int(begin_s * SECOND) + int(rng.uniform(0, room))
        found = kitchen.between(entity, first, first + length)
        if len(found) >= 3 and places.is_free(entity, first, first + length):
            return found
    return None


def fault_of(kitchen, places, kind, entity, indices, wanted):
    snaps = kitchen.entities[entity]
    fault = Fault(kind, entity, snaps[indices[0]].time, snaps[indices[-1]].time, wanted)
    places.take(entity, fault.first, fault.last)
    return fault


def periodic(kitchen, rng, with_objects=True):
    names = [JOINTS, PLATFORM, CAMERA] + (kitchen.objects() if with_objects else [])
    return names[rng.integers(len(names))]


def position(entity, value):
    """The array of a value that says where something is."""
    if entity == JOINTS:
        return value["positions"]
    if entity == PLATFORM:
        return value["pose_world_platform"]
    return value["pose_world_camera" if entity == CAMERA else "pose_world_object"]["position"]


def moves(kitchen, entity, indices, element=None, min_way=0.05):
    """Whether it moves all the time of a span, at min_way by so much in all."""
    values = np.array([position(entity, kitchen.entities[entity][i].values[0]) for i in indices], float)
    steps = np.abs(np.diff(values, axis=0))
    steps = steps[:, element] if element is not None else steps.max(axis=1)
    return len(steps) > 2 and steps.sum() > min_way and (steps > 0.1 * steps.mean()).mean() > 0.8


def moving_span(kitchen, places, rng, entity, low_s, high_s, min_way=0.05):
    for _ in range(80):
        found = span_of(kitchen, places, rng, entity, low_s, high_s)
        if found and moves(kitchen, entity, found, min_way=min_way):
            return found
    return None


def moving_joint(kitchen, places, rng, low_s, high_s, min_way=0.03):
    """A span and a joint that moves in it."""
    for _ in range(200):
        found = span_of(kitchen, places, rng, JOINTS, low_s, high_s)
        element = int(rng.integers(43))
        if found and moves(kitchen, JOINTS, found, element, min_way):
            return found, element
    return None, None


def used_joint(kitchen, rng):
    """A joint that moves at some time: those of an arm that is never used say nothing."""
    values = np.array([snap.values[0]["positions"] for snap in kitchen.entities[JOINTS]], float)
    used = np.nonzero(np.ptp(values, axis=0) > 0.1)[0]
    return int(used[rng.integers(len(used))])


def dropped_span(kitchen, places, rng):
    entity = periodic(kitchen, rng)
    min_way = 1.0 if entity in kitchen.objects() else 0.2
    found = span_of(kitchen, places, rng, entity, min_way, 3.0)
    if not found:
        return None
    fault = fault_of(kitchen, places, "dropped span", entity, found, ("gap",))
    del kitchen.entities[entity][found[0]:found[-1] + 1]
    return fault


def halved_rate(kitchen, places, rng):
    entity = periodic(kitchen, rng, with_objects=False)
    found = span_of(kitchen, places, rng, entity, 2.0, 6.0)
    if not found:
        return None
    fault = fault_of(kitchen, places, "halved rate", entity, found, ("rate",))
    for i in reversed(found[1::2]):
        del kitchen.entities[entity][i]
    return fault


def stuck_sensor(kitchen, places, rng):
    entity = (JOINTS, PLATFORM, CAMERA)[rng.integers(3)]
    found = moving_span(kitchen, places, rng, entity, 0.4, 1.5)
    if not found:
        return None
    fault = fault_of(kitchen, places, "stuck sensor", entity, found, ("frozen",))
    snaps = kitchen.entities[entity]
    for i in found[1:]:
        stuck = snaps[found[0]].copy(snaps[i].time)
        for old, new in zip(snaps[i].values, stuck.values):
            new.update({key: part for key, part in old.items() if isinstance(part, str)})
        snaps[i] = stuck
    return fault


def stuck_joint(kitchen, places, rng):
    found, element = moving_joint(kitchen, places, rng, 0.4, 1.5)
    if not found:
        return None
    snaps = kitchen.entities[JOINTS]
    held = snaps[found[0]].values[0]["positions"][element]
    for i in found:
        snaps[i].values[0]["positions"][element] = held
    return fault_of(kitchen, places, "stuck joint", JOINTS, found, ("frozen",))


def frozen_image(kitchen, places, rng):
    found = moving_span(kitchen, places, rng, CAMERA, 0.5, 2.0)
    if not found:
        return None
    snaps = kitchen.entities[CAMERA]
    for i in found[1:]:
        for old, new in zip(snaps[found[0]].values, snaps[i].values):
            new["image"] = old["image"]
    return fault_of(kitchen, places, "frozen image", CAMERA, found, ("frozen",))


def spike(kitchen, places, rng):
    entity = (JOINTS, PLATFORM, CAMERA)[rng.integers(3)]
    found = span_of(kitchen, places, rng, entity, 0.2, 0.3)
    if not found:
        return None
    middle = found[len(found) // 2]
    where = position(entity, kitchen.entities[entity][middle].values[0])
    element = used_joint(kitchen, rng) if entity == JOINTS else int(rng.integers(2))
    where[element] += rng.choice([-1, 1]) * rng.uniform(0.2, 1.0)
    return fault_of(kitchen, places, "spike", entity, [middle], ("spike",))


def velocity_spike(kitchen, places, rng):
    found, element = moving_joint(kitchen, places, rng, 0.2, 0.4, 0.005)
    if not found:
        return None
    middle = found[len(found) // 2]
    fast = max(abs(float(snap.values[0]["velocities"][element])) for snap in kitchen.entities[JOINTS])
    kitchen.entities[JOINTS][middle].values[0]["velocities"][element] = 3 * max(fast, 0.5)
    return fault_of(kitchen, places, "velocity spike", JOINTS, [middle], ("spike",))


def out_of_bounds(kitchen, places, rng):
    found = span_of(kitchen, places, rng, JOINTS, 0.05, 0.5)
    if not found:
        return None
    body = kitchen.entities["RobotState/Description/robot/body"][0].values[0]
    element = used_joint(kitchen, rng)
    beyond = rng.uniform(0.05, 0.3) * (body["upper"][element] - body["lower"][element])
    value = body["upper"][element] + beyond if rng.integers(2) else body["lower"][element] - beyond
    for i in found:
        kitchen.entities[JOINTS][i].values[0]["positions"][element] = value
    return fault_of(kitchen, places, "out of bounds", JOINTS, found, ("out-of-bounds",))


def not_a_number(kitchen, places, rng):
    entity = periodic(kitchen, rng)
    found = span_of(kitchen, places, rng, entity, 0.05 if entity == JOINTS else 0.7, 0.9)
    if not found:
        return None
    found = found[:int(rng.integers(1, 4))]
    for i in found:
        where = position(entity, kitchen.entities[entity][i].values[0])
        where[int(rng.integers(len(where)))] = rng.choice([np.nan, np.inf])
    return fault_of(kitchen, places, "not a number", entity, found, ("not-finite",))


def duplicate(kitchen, places, rng):
    entity = (JOINTS, PLATFORM, CAMERA)[rng.integers(3)]
    found = moving_span(kitchen, places, rng, entity, 0.3, 0.5, 0.001)
    if not found:
        return None
    snaps = kitchen.entities[entity]
    at = found[len(found) // 2]
    step = snaps[at + 1].time - snaps[at].time
    snaps.insert(at + 1, snaps[at].copy(snaps[at].time + int(step * rng.uniform(0.2, 0.6))))
    return fault_of(kitchen, places, "duplicate", entity, [at, at + 1], ("duplicate",))


def replay(kitchen, places, rng):
    """A piece that was recorded before comes in place of what was there."""
    found = moving_span(kitchen, places, rng, JOINTS, 0.3, 1.0)
    if not found:
        return None
    snaps = kitchen.entities[JOINTS]
    earlier = found[0] - int(rng.integers(300, 1000))
    if earlier < 50:
        return None
    for k, i in enumerate(found):
        snaps[i] = snaps[earlier + k].copy(snaps[i].time)
    return fault_of(kitchen, places, "replay", JOINTS, found, ("duplicate",))


def linking(kitchen, rng):
    """An entity with links, and their members."""
    names = kitchen.objects() + [CAMERA]
    entity = names[rng.integers(len(names))]
    return entity, ("joints", "platform") if entity == CAMERA else ("image", "joints", "platform")


def with_time(link, time):
    name, _, index = link.rsplit("/", 2)
    text = str(np.datetime64(time, "ns")).replace("T", " ")
    return f"{name}/{text}/{index}"


def dead_link(kitchen, places, rng):
    entity, members = linking(kitchen, rng)
    found = span_of(kitchen, places, rng, entity, 0.7, 1.0)
    if not found:
        return None
    at, member = found[0], members[rng.integers(len(members))]
    value = kitchen.entities[entity][at].values[0]
    if rng.integers(2):
        value[member] = value[member].replace(value[member].split("/")[3], "none")
    else:
        value[member] = with_time(value[member], kitchen.entities[entity][at].time + 3_141_593)
    return fault_of(kitchen, places, "dead link", entity, [at], ("dead-link",))


def deleted_target(kitchen, places, rng):
    """An image goes that an object links to."""
    entity = kitchen.objects()[rng.integers(len(kitchen.objects()))]
    found = span_of(kitchen, places, rng, entity, 0.7, 1.0)
    if not found:
        return None
    time = kitchen.entities[entity][found[0]].time
    if not places.is_free(CAMERA, time, time):
        return None
    left = [snap for snap in kitchen.entities[CAMERA] if snap.time != time]
    if len(left) == len(kitchen.entities[CAMERA]):
        return None
    kitchen.entities[CAMERA] = left
    places.take(CAMERA, time, time)
    return fault_of(kitchen, places, "deleted target", entity, [found[0]], ("dead-link",))


def wrong_link_time(kitchen, places, rng):
    entity, members = linking(kitchen, rng)
    found = span_of(kitchen, places, rng, entity, 0.7, 1.5, begin_s=6)
    if not found:
        return None
    member = members[rng.integers(len(members))]
    back = int(rng.integers(3, 25)) * 200_000_000
    for i in found[:int(rng.integers(1, 4))]:
        snap = kitchen.entities[entity][i]
        time = (snap.time - back - kitchen.first) // 200_000_000 * 200_000_000 + kitchen.first
        snap.values[0][member] = with_time(snap.values[0][member], time)
    return fault_of(kitchen, places, "wrong link time", entity, found[:1], ("link-time",))


def shifted_clock(kitchen, places, rng):
    """The clock of a sensor is off, in its times and in the links to them."""
    entity = (CAMERA, PLATFORM, JOINTS)[rng.integers(3)]
    if not places.is_free(entity, kitchen.first, kitchen.last):
        return None
    shift = int(rng.choice([-1, 1])) * int(rng.integers(20, 51)) * 10_000_000
    for other, snaps in kitchen.entities.items():
        for i, snap in enumerate(snaps):
            for value in snap.values:
                for key, part in value.items():
                    if isinstance(part, str) and part.startswith(entity + "/"):
                        time = np.datetime64(part.rsplit("/", 2)[1].replace(" ", "T"), "ns")
                        value[key] = with_time(part, int(time.astype("int64")) + shift)
            if other == entity:
                snaps[i] = Snap(snap.time + shift, snap.values)
    return fault_of(kitchen, places, "shifted clock", entity, [0, -1], ("time-shift",))


def drifting_joint(kitchen, places, rng):
    found = span_of(kitchen, places, rng, JOINTS, 8.0, 20.0)
    if not found:
        return None
    element = used_joint(kitchen, rng)
    values = np.array([snap.values[0]["positions"][element] for snap in kitchen.entities[JOINTS]], float)
    ramp = rng.choice([-1, 1]) * max(0.05, rng.uniform(0.1, 0.4) * np.ptp(values))
    snaps = kitchen.entities[JOINTS]
    for k, i in enumerate(found):
        snaps[i].values[0]["positions"][element] += ramp * k / (len(found) - 1)
    for snap in snaps[found[-1] + 1:]:
        snap.values[0]["positions"][element] += ramp
    return fault_of(kitchen, places, "drifting joint", JOINTS, found, ("drift",))


def creeping_object(kitchen, places, rng):
    entity = kitchen.objects()[rng.integers(len(kitchen.objects()))]
    found = span_of(kitchen, places, rng, entity, 7.0, 15.0)
    if not found or moves(kitchen, entity, found, min_way=0.001):
        return None
    snaps = kitchen.entities[entity]
    values = np.array([position(entity, snaps[i].values[0]) for i in found])
    if np.ptp(values, axis=0).max() > 1e-4:
        return None
    element, length = int(rng.integers(3)), rng.uniform(0.02, 0.08)
    for k, i in enumerate(found):
        position(entity, snaps[i].values[0])[element] += length * k / (len(found) - 1)
    for snap in snaps[found[-1] + 1:]:
        position(entity, snap.values[0])[element] += length
    return fault_of(kitchen, places, "creeping object", entity, found, ("drift",))


def teleport(kitchen, places, rng):
    entity = kitchen.objects()[rng.integers(len(kitchen.objects()))]
    found = span_of(kitchen, places, rng, entity, 1.5, 4.0)
    if not found:
        return None
    element, far = int(rng.integers(2)), rng.choice([-1, 1]) * rng.uniform(0.7, 2.0)
    for i in found:
        position(entity, kitchen.entities[entity][i].values[0])[element] += far
    return fault_of(kitchen, places, "teleport", entity, found, ("jump", "spike"))


def wrong_unit(kitchen, places, rng):
    entity = kitchen.objects()[rng.integers(len(kitchen.objects()))]
    found = span_of(kitchen, places, rng, entity, 0.8, 1.2)
    if not found:
        return None
    position(entity, kitchen.entities[entity][found[1]].values[0])[:] *= 1000
    return fault_of(kitchen, places, "wrong unit", entity, found[1:2], ("jump", "spike"))


def joint_offset(kitchen, places, rng):
    found = span_of(kitchen, places, rng, JOINTS, 0.5, 2.0)
    if not found:
        return None
    element, offset = used_joint(kitchen, rng), rng.choice([-1, 1]) * rng.uniform(0.1, 0.4)
    for i in found:
        kitchen.entities[JOINTS][i].values[0]["positions"][element] += offset
    return fault_of(kitchen, places, "joint offset", JOINTS, found, ("jump",))


def action_rows(kitchen, rng, wants_end):
    """An action that is not the last: the entity, and the index of its begin or end."""
    last = max(snap.values[0]["number"] for name in kitchen.actions() for snap in kitchen.entities[name])
    rows = [(name, i) for name in kitchen.actions() for i, snap in enumerate(kitchen.entities[name])
            if (snap.values[0]["outcome"] != 0) == wants_end and snap.values[0]["number"] < last]
    return rows[rng.integers(len(rows))] if rows else (None, None)


def broken_action(kitchen, places, rng, kind, wants_end):
    entity, at = action_rows(kitchen, rng, wants_end)
    if entity is None:
        return None
    snap = kitchen.entities[entity][at]
    first, last = snap.values[0]["started"], snap.values[0]["ended"] or snap.time
    if not places.is_free(entity, first, last):
        return None
    del kitchen.entities[entity][at]
    places.take(entity, first, last)
    return Fault(kind, entity, int(first), int(last), ("broken-action",))


def action_without_end(kitchen, places, rng):
    return broken_action(kitchen, places, rng, "action without end", True)


def action_without_begin(kitchen, places, rng):
    return broken_action(kitchen, places, rng, "action without begin", False)


def action_twice(kitchen, places, rng):
    entity, at = action_rows(kitchen, rng, True)
    if entity is None:
        return None
    snaps = kitchen.entities[entity]
    time = snaps[at].time + int(rng.uniform(0.02, 0.3) * SECOND)
    if not places.is_free(entity, snaps[at].time, time):
        return None
    snaps.insert(at + 1, snaps[at].copy(time))
    return fault_of(kitchen, places, "action twice", entity, [at, at + 1], ("duplicate",))


#: A shifted clock comes first, because it needs all of an entity.
KINDS = [
    shifted_clock, dropped_span, halved_rate, stuck_sensor, stuck_joint, frozen_image, spike,
    velocity_spike, out_of_bounds, not_a_number, duplicate, replay, dead_link, deleted_target,
    wrong_link_time, drifting_joint, creeping_object, teleport, wrong_unit, joint_offset,
    action_without_end, action_without_begin, action_twice,
]
