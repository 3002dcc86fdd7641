// SPDX-License-Identifier: Apache-2.0
// Names and units of joints that a type does not tell: the robot's description lists the one, and how
// its joints move tells the other.
import { getJson } from '../api/client';
import { moment, type Member } from '../api/types';
import { namesIn } from '../panels/scene/joints';
import { urdfIn } from '../panels/scene/urdf';
import { parsePath } from './paths';
import { entities, last } from './store';

export const kJointEntities = /joint|proprioception|encoder/i;
export const kDescriptionEntities = /descri|urdf|robot_?model/i;

export interface JointsOfRobot {
  /** In the order of arrays. */
  readonly names: readonly string[];
  /** Those that slide; all others turn. */
  readonly sliding: ReadonlySet<string>;
}

type Quantity = 'position' | 'velocity' | 'acceleration' | 'effort';
const kQuantities: readonly (readonly [Quantity, RegExp])[] = [
  ['velocity', /vel/i], ['acceleration', /acc/i], ['effort', /torque|effort/i], ['position', /^(q|(joint_?)?(positions?|angles?|values?))$/i],
];
const kUnits: Record<Quantity, readonly [turns: string, slides: string]> = { position: ['rad', 'm'], velocity: ['rad/s', 'm/s'], acceleration: ['rad/s²', 'm/s²'], effort: ['N m', 'N'] };

const quantityOf = (key: string): Quantity | undefined => kQuantities.find(([, pattern]) => pattern.test(key))?.[0];

/** The joints of a description; nothing where it has none. */
export function jointsOfRobot(value: unknown): JointsOfRobot | undefined {
  const names = namesIn(value);
  const urdf = urdfIn(value);
  if (names.length === 0 || urdf === undefined) return undefined;
  const sliding = new Set<string>();
  // A look at the tags suffices, and nothing in a text of a stranger can make it slow.
  for (const [tag] of urdf.matchAll(/<joint\s[^<>]{0,400}>/g)) {
    const name = /\sname\s*=\s*["']([^"']*)["']/.exec(tag)?.[1];
    if (name !== undefined && /\stype\s*=\s*["']prismatic["']/.test(tag)) sliding.add(name);
  }
  return { names, sliding };
}

/** Members with the names and units of their joints, where a type tells none. */
export function withJoints(members: readonly Member[], { names, sliding }: JointsOfRobot): Member[] {
  const lengths = new Map<string, number>();
  const parts = members.map((member) => {
    const { keys, indices } = parsePath(member.path);
    const array = keys.join('/');
    if (indices.length === 1) lengths.set(array, Math.max(lengths.get(array) ?? 0, indices[0]! + 1));
    return { member, keys, indices, array };
  });
  return parts.map(({ member, keys, indices, array }) => {
    if (member.kind !== 'number') return member;
    // An element of an array as long as there are joints, or a number under the name of one.
    const isElement = indices.length === 1 && lengths.get(array) === names.length;
    const isNamed = indices.length === 0 && keys.length > 1 && names.includes(keys.at(-1)!);
    const quantity = isElement ? quantityOf(keys.at(-1) ?? '') : isNamed ? quantityOf(keys.at(-2)!) : undefined;
    const name = isElement ? names[indices[0]!] : keys.at(-1);
    if (quantity === undefined || name === undefined) return member;
    return { ...member, ...(isElement && !member.name ? { name } : {}), unit: member.unit || kUnits[quantity][sliding.has(name) ? 1 : 0] };
  });
}

let described: Promise<JointsOfRobot | undefined> | undefined;

/** The joints of the robot of this memory, asked for once. */
function askJoints(): Promise<JointsOfRobot | undefined> {
  const node = entities().find((one) => kDescriptionEntities.test(one.id) && (one.kinds?.includes('text') ?? true));
  if (!node) return Promise.resolve(undefined);
  described ??= getJson('moment', { entity: node.id, at: last(), which: 'at-or-before' }, moment).then((told) => jointsOfRobot(told.instances[0]?.data));
  described.catch(() => { described = undefined; });
  return described;
}

/** What the gateway tells of an entity's members, with what its robot tells of joints. */
export async function namedMembers(entity: string, members: Member[]): Promise<Member[]> {
  const isTold = members.every((member) => member.kind !== 'number' || (member.unit && member.name));
  if (isTold || !kJointEntities.test(entity)) return members;
  const joints = await askJoints().catch(() => undefined);
  return joints ? withJoints(members, joints) : members;
}
