// SPDX-License-Identifier: Apache-2.0
// Where a camera is and how it sees: told by a value itself, or by what it links to.
import { numberAt } from '../values';
import { posesIn, type Placed } from './poses';

export interface Lens {
  readonly fx: number;
  readonly fy: number;
  readonly cx: number;
  readonly cy: number;
}
export interface Frame {
  readonly pose?: Placed;
  readonly lens?: Lens;
  /** What the same camera saw in colours. */
  readonly picture?: Picture;
}
export interface Picture {
  readonly id: string;
  readonly path: string;
}

/** Half of what a camera sees at a distance of 1, where nothing tells how it sees: 67 degrees. */
export const kHalfView = 0.66;
const kMaxLinks = 6;
const kLeads = /^(view|of|image|colou?r|camera|calibration|intrinsics|camera_info)$/i;

const isDict = (value: unknown): value is Record<string, unknown> => typeof value === 'object' && value !== null && !Array.isArray(value);

/** Focal lengths and centre, as a calibration or as the matrix of ROS tells them. */
export function lensIn(value: unknown): Lens | undefined {
  const plain = ['fx', 'fy', 'cx', 'cy'].map((key) => numberAt(value, key));
  const matrix = [0, 4, 2, 5].flatMap((i) => [numberAt(value, `k[${i}]`), numberAt(value, `K[${i}]`)].filter(Number.isFinite).slice(0, 1));
  const [fx, fy, cx, cy] = plain.every(Number.isFinite) ? plain : matrix;
  return fx! > 0 && fy! > 0 && [cx, cy].every(Number.isFinite) ? { fx: fx!, fy: fy!, cx: cx!, cy: cy! } : undefined;
}

/** A member of a value that is an image in colours. */
export function colourPath(value: unknown): string | undefined {
  return (isDict(value) ? Object.keys(value) : []).find((key) => { const part = (value as Record<string, unknown>)[key]; return isDict(part) && isDict(part.$image) && part.$image.channels === 3; });
}

/** Follows the links of a value that lead to its camera, two links far. `load` gives the value of an ID. */
export async function frameOf(value: unknown, load: (id: string) => Promise<unknown>): Promise<Frame> {
  let pose: Placed | undefined;
  let lens: Lens | undefined;
  let picture: Picture | undefined;
  let left = kMaxLinks;
  let level: { id?: string; value: unknown }[] = [{ value }];
  for (let depth = 0; depth <= 2 && level.length > 0; ++depth) {
    for (const { id, value: one } of level) {
      const path = colourPath(one);
      if (id !== undefined && path !== undefined) picture ??= { id, path };
      pose ??= posesIn(one).find((placed) => /(^|\/)pose_[^/]*$/.test(placed.path));
      lens ??= lensIn(one) ?? (isDict(one) ? ['calibration', 'intrinsics', 'camera_info'].map((key) => lensIn(one[key])).find((found) => found) : undefined);
    }
    if (pose && lens) break;
    const ids = level.flatMap(({ value: one }) => (isDict(one) ? Object.entries(one) : []).flatMap(([key, part]) => (kLeads.test(key) && isDict(part) && typeof part.$link === 'string' ? [part.$link] : [])));
    const asked = ids.slice(0, Math.max(0, left));
    left -= asked.length;
    // A link may lead to what was forgotten.
    level = (await Promise.all(asked.map(async (id) => ({ id, value: await load(id).catch(() => null) })))).filter((one) => one.value !== null);
  }
  return { ...(pose ? { pose } : {}), ...(lens ? { lens } : {}), ...(picture ? { picture } : {}) };
}
