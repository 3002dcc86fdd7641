// SPDX-License-Identifier: Apache-2.0
// Plans of drives, whether they hold at a time, and named places (docs/navigation.md).
import { arrayOf } from '../../api/arrays';
import { parseId } from '../../state/ids';
import { chosenOf, linkOf, textIn } from '../../skills/executions';
import { numberAt } from '../values';

/** x, y and heading in the world. */
export type Planar = readonly [number, number, number];

export interface Plan {
  readonly id: string;
  readonly time: bigint;
  readonly robot: string;
  readonly goal: string;
  readonly isRefused: boolean;
  readonly reason: string;
  readonly length: number;
  /** From start to goal; of a plan that was refused, these two as far as they are known. */
  readonly path: readonly Planar[];
}

export interface DriveEvent {
  readonly id: string;
  readonly time: bigint;
  readonly kind: (typeof kKinds)[number];
  readonly reason: string;
}

const kKinds = ['started', 'replanned', 'blocked', 'arrived', 'refused', 'trapped', 'stopped', 'failed'] as const;
const kEnds: readonly string[] = ['arrived', 'trapped', 'stopped', 'failed'];
const kMaxPoints = 20_000;

/** Three numbers of an array; undefined where they are not there or not finite. */
export function planarIn(data: unknown, key: string): Planar | undefined {
  const numbers = [0, 1, 2].map((i) => numberAt(data, `${key}[${i}]`));
  return numbers.every(Number.isFinite) ? (numbers as unknown as Planar) : undefined;
}

/** True where a moment told the summary of a path alone, because it is long. */
export const isPathMissing = (data: unknown): boolean => typeof (data as { path?: { $array?: unknown } } | null)?.path?.$array === 'object';

export function planIn(id: string, data: unknown): Plan | undefined {
  const { time } = parseId(id);
  const dict = data as Record<string, unknown> | null;
  const state = typeof dict === 'object' ? chosenOf(dict?.state, ['planned', 'refused'] as const) : undefined;
  if (time === undefined || state === undefined) return undefined;
  const array = arrayOf(dict!.path);
  const isPath = array !== undefined && array.shape.length === 2 && array.shape[1] === 3 && array.shape[0]! <= kMaxPoints;
  const points = isPath ? Array.from({ length: array.shape[0]! }, (_, i) => [0, 1, 2].map((c) => array.data[3 * i + c]!) as unknown as Planar).filter((point) => point.every(Number.isFinite)) : [];
  const ends = [planarIn(data, 'pose_world_start'), planarIn(data, 'pose_world_goal')].filter((one) => one !== undefined);
  return {
    id, time, robot: textIn(data, 'robot'), goal: textIn(data, 'goal'), isRefused: state === 'refused', reason: textIn(data, 'reason'), length: numberAt(data, 'length'),
    path: points.length > 1 ? points : state === 'refused' ? ends : [],
  };
}

export function driveEventIn(id: string, data: unknown): DriveEvent | undefined {
  const { time } = parseId(id);
  const kind = chosenOf((data as Record<string, unknown> | null)?.kind, kKinds);
  return time === undefined || kind === undefined ? undefined : { id, time, kind, reason: textIn(data, 'reason') };
}

/** The event that ended the drive of a plan, if it did until then; `newest` is the last event of its robot. */
export const endOf = (plan: Plan, newest: DriveEvent | undefined): DriveEvent | undefined => (!plan.isRefused && newest && newest.time >= plan.time && kEnds.includes(newest.kind) ? newest : undefined);

export interface Place {
  readonly name: string;
  readonly pose?: Planar;
  /** What it moves with, and where the robot stands there. */
  readonly object: string;
  readonly poseInObject?: Planar;
}

export function placeIn(data: unknown): Place | undefined {
  const [pose, poseInObject, object] = [planarIn(data, 'pose_world_location'), planarIn(data, 'pose_object_location'), parseId(linkOf((data as Record<string, unknown> | null)?.object)).entity];
  if (!pose && !(poseInObject && object !== '')) return undefined;
  return { name: textIn(data, 'name'), object, ...(pose ? { pose } : {}), ...(poseInObject ? { poseInObject } : {}) };
}

/** A pose in the frame of another one. */
export function composed([x, y, heading]: Planar, [dx, dy, turn]: Planar): Planar {
  const [c, s] = [Math.cos(heading), Math.sin(heading)];
  return [x + c * dx - s * dy, y + s * dx + c * dy, heading + turn];
}

/** The heading of an orientation, w, x, y, z. */
export const headingOf = ([w, x, y, z]: readonly [number, number, number, number]): number => Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
