// SPDX-License-Identifier: Apache-2.0
// The robot of a scene: found by its URDF, and put where the memory says it stands and how its
// joints are; a ghost stands where it is predicted.
import { createMemo, createSignal, createEffect, onCleanup, type Accessor } from 'solid-js';
import { createRequest } from '../../state/request';
import { isPredicted } from '../../state/moment';
import { cursor } from '../../state/store';
import { theme } from '../../ui/theme';
import { baseAmong, jointsIn, namesIn } from './joints';
import { posesIn } from './poses';
import type { Robot } from './robot';
import { valueOf, type Found, type Sources } from './sources';
import { urdfIn } from './urdf';

interface Standing {
  readonly robot: Robot;
  readonly ghost: Robot;
}
export interface LinkPlace {
  readonly name: string;
  readonly position: readonly [number, number, number];
  readonly isPredicted: boolean;
}

const atOrBefore = (): string => 'at-or-before';

/** `ahead` is how far to predict from a moment that is recorded; zero: not at all. `show` puts both into the picture. */
export function createStanding(sources: Sources, ahead: Accessor<bigint>, show: (robot: Robot | null, ghost: Robot | null) => void) {
  const parts = createMemo(() => ({ descriptions: sources.idsOf('description'), moving: [...new Set([...sources.idsOf('joints'), ...sources.idsOf('base')])] }));
  const descriptions = createRequest<Found[]>(() => {
    const ids = parts().descriptions;
    return ids.length === 0 ? null : { group: 'descriptions', run: sources.ask(ids, cursor(), atOrBefore) };
  });
  const description = createMemo(() => {
    for (const found of descriptions.data() ?? []) {
      const urdf = urdfIn(valueOf(found));
      if (urdf !== undefined) return { urdf, id: found.id, names: namesIn(valueOf(found)) };
    }
    return null;
  }, null, { equals: (a, b) => a?.urdf === b?.urdf && a?.id === b?.id });
  const loaded = createRequest<Standing>(() => {
    const found = description();
    const colour = theme().predicted;
    if (!found) return null;
    return {
      group: `${found.id} ${found.urdf}`,
      run: async () => {
        const { createRobot } = await import('./robot');
        return { robot: createRobot(found.urdf), ghost: createRobot(found.urdf, colour) };
      },
    };
  });
  const states = createRequest<Found[]>(() => {
    const ids = parts().moving;
    return !description() || ids.length === 0 ? null : { group: 'states', run: sources.ask(ids, cursor(), atOrBefore) };
  });
  const foreseen = createRequest<Found[]>(() => {
    const ids = parts().moving;
    const at = cursor();
    if (!description() || ids.length === 0) return null;
    const isAhead = ids.some((id) => isPredicted(id, at));
    if (!isAhead && ahead() === 0n) return null;
    return { group: `foreseen ${isAhead}`, run: sources.ask(ids, at, () => (isAhead ? 'predict' : `ahead ${ahead()}`)) };
  });

  const [links, setLinks] = createSignal<readonly LinkPlace[]>([]);
  const [told, setTold] = createSignal<{ joints: number; hasBase: boolean }>();
  const pose = (robot: Robot, found: readonly Found[]) => {
    const values = found.map(valueOf);
    const positions = values.map((value) => jointsIn(value, robot.joints, description()?.names ?? [])).reduce((best, one) => (one.size > best.size ? one : best), new Map<string, number>());
    const base = baseAmong(found.filter((one) => sources.idsOf('base').includes(one.id)).flatMap((one) => posesIn(valueOf(one))), robot.root);
    robot.pose(base, positions);
    return { joints: positions.size, hasBase: base !== undefined };
  };
  createEffect(() => {
    const standing = loaded.data();
    const now = states.data();
    const next = foreseen.data();
    if (!standing || !now) { setLinks([]); setTold(undefined); return show(null, null); }
    setTold(pose(standing.robot, now));
    const isForeseen = next !== undefined && next.some((one) => one.moment.source === 'predicted') && pose(standing.ghost, next).joints > 0;
    setLinks([...standing.robot.links().map((link) => ({ ...link, isPredicted: false })), ...(isForeseen ? standing.ghost.links().map((link) => ({ ...link, isPredicted: true })) : [])]);
    show(standing.robot, isForeseen ? standing.ghost : null);
  });
  onCleanup(() => show(null, null));

  /** What a person should know of the picture. */
  const notes = createMemo<string[]>(() => {
    const robot = loaded.data()?.robot;
    const all: string[] = [];
    if (loaded.error()) all.push(`The robot of ${description()?.id ?? ''} is not drawn. ${loaded.error()}`);
    if (!robot) return all;
    if (robot.missing > 0) all.push(`${robot.missing} ${robot.missing === 1 ? 'shape of the robot is' : 'shapes of the robot are'} not drawn: the memory has no meshes.`);
    const known = told();
    if (known && !known.hasBase) all.push('Nothing tells where the robot stands, so it stands at the origin.');
    if (known && known.joints < robot.joints.size) all.push(`${robot.joints.size - known.joints} of ${robot.joints.size} joints are not told, and stay at zero.`);
    return all;
  });
  return { links, notes, isThere: () => loaded.data() !== undefined, isBusy: () => loaded.isBusy() || foreseen.isBusy() };
}
