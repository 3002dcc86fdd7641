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
}

const isDict = (value: unknown): value is Record<string, unknown> => typeof value === 'object' && value !== null && !Array.isArray(value);

function triple(value: unknown, path: string): readonly [number, number, number] | undefined {
  const numbers = [0, 1, 2].map((i) => numberAt(value, `${path}[${i}]`));
  return numbers.every(Number.isFinite) ? (numbers as [number, number, number]) : undefined;
}

/** All poses of a value, wherever they lie; those that are not finite are left out. */
export function posesIn(tree: unknown): Placed[] {
  const found: Placed[] = [];
  const size = triple(tree, 'size');
  const isCamera = isDict(tree) && Object.keys(tree).some((key) => /^(image|calibration|intrinsics|camera_info)$/.test(key));
  const visit = (value: unknown, path: string, depth: number): void => {
    if (!isDict(value) || depth > 6) return;
    const position = triple(value, 'position');
    const turn = [0, 1, 2, 3].map((i) => numberAt(value, `orientation[${i}]`));
    if (position && turn.every(Number.isFinite)) {
      found.push({ path, position, orientation: turn as [number, number, number, number], ...(size ? { size } : {}), isCamera: isCamera && /camera/.test(path) });
      return;
    }
    for (const [key, part] of Object.entries(value)) if (!key.startsWith('$')) visit(part, joinPath(path, key), depth + 1);
  };
  visit(tree, '', 0);
  // A platform tells x, y and heading, and no pose.
  const [x, y, heading] = ['x', 'y', 'heading'].map((key) => numberAt(tree, key)) as [number, number, number];
  if (found.length === 0 && [x, y, heading].every(Number.isFinite))
    found.push({ path: '', position: [x, y, 0], orientation: [Math.cos(heading / 2), 0, 0, Math.sin(heading / 2)], isCamera: false });
  return found;
}
