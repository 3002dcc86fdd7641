// SPDX-License-Identifier: Apache-2.0
// What has a place in the values of a moment: poses with the size of their thing, and cameras.
import { joinPath } from '../../state/paths';
import { numberAt } from '../values';

export interface Placed {
  /** Path of the pose in the value. */
  readonly path: string;
  readonly position: readonly [number, number, number];
  /** w, x, y, z. */
  readonly orientation: readonly [number, number, number, number];
  /** Edges in m, if the value tells a size. */
  readonly size?: readonly [number, number, number];
  readonly isCamera: boolean;
  /** Of a camera: the half width and half height of what it sees at a distance of 1. */
  readonly half?: readonly [number, number];
}

/** The frame that a path names: that of `pose_world_camera` is `world`. */
export const frameOfPath = (path: string): string => /(?:^|\/)pose_([^_/]+)_/.exec(path)?.[1] ?? '';

/** False for poses in the frame of something that moves, such as `pose_head_camera`. */
export const isInWorld = (placed: Placed): boolean => /^(|world|map|odom|global)$/i.test(frameOfPath(placed.path));

/** The edges of a thing: its size, or the plate of a surface. */
export function sizeIn(tree: unknown): readonly [number, number, number] | undefined {
  const [depth, width] = [numberAt(tree, 'depth'), numberAt(tree, 'width')] as [number, number];
  const size = triple(tree, 'size') ?? (depth > 0 && width > 0 ? ([depth, width, kPlate_m] as const) : undefined);
  return size?.every((edge) => edge > 0 && edge < kMaxEdge_m) ? size : undefined;
}

const kPlate_m = 0.03;
const kMaxEdge_m = 100;

const isDict = (value: unknown): value is Record<string, unknown> => typeof value === 'object' && value !== null && !Array.isArray(value);

function triple(value: unknown, path: string): readonly [number, number, number] | undefined {
  const numbers = [0, 1, 2].map((i) => numberAt(value, `${path}[${i}]`));
  return numbers.every(Number.isFinite) ? (numbers as [number, number, number]) : undefined;
}

/** True for an array of exactly three numbers, which triple() takes from longer ones, too. */
const isFlat = (value: unknown): boolean => isDict(value) && isDict(value.$ndarray) && Array.isArray(value.$ndarray.data) && value.$ndarray.data.length === 3;

/** A pose on the floor: x, y and the heading from x to y. */
function onFloor(numbers: readonly number[], path: string): Placed {
  const [x, y, heading] = numbers as [number, number, number];
  return { path, position: [x, y, 0], orientation: [Math.cos(heading / 2), 0, 0, Math.sin(heading / 2)], isCamera: false };
}

/** All poses of a value, wherever they lie; those that are not finite are left out. */
export function posesIn(tree: unknown): Placed[] {
  const found: Placed[] = [];
  const size = sizeIn(tree);
  const isCamera = isDict(tree) && Object.keys(tree).some((key) => /^(image|calibration|intrinsics|camera_info)$/.test(key));
  const visit = (value: unknown, path: string, depth: number): void => {
    if (!isDict(value) || depth > 6) return;
    const position = triple(value, 'position');
    const turn = [0, 1, 2, 3].map((i) => numberAt(value, `orientation[${i}]`));
    if (position && turn.every(Number.isFinite)) {
      found.push({ path, position, orientation: turn as [number, number, number, number], ...(size ? { size } : {}), isCamera: isCamera && /camera/.test(path) });
      return;
    }
    for (const [key, part] of Object.entries(value)) {
      if (key.startsWith('$')) continue;
      const flat = /^pose_[^_]+_/.test(key) && isFlat(part) ? triple(value, joinPath('', key)) : undefined;
      if (flat) found.push(onFloor(flat, joinPath(path, key)));
      else visit(part, joinPath(path, key), depth + 1);
    }
  };
  visit(tree, '', 0);
  // A platform tells x, y and heading, and no pose.
  const numbers = ['x', 'y', 'heading'].map((key) => numberAt(tree, key));
  if (found.length === 0 && numbers.every(Number.isFinite)) found.push(onFloor(numbers, ''));
  return found;
}
