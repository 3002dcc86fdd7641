// SPDX-License-Identifier: Apache-2.0
// Points of depth images and of arrays that are clouds.
import { createEffect, createMemo, onCleanup, type Accessor } from 'solid-js';
import { ApiError, getBinary, getImage } from '../../api/client';
import type { Member } from '../../api/types';
import { createRequest } from '../../state/request';
import { membersOf } from '../../state/moment';
import { isMoving } from '../../state/moving';
import { shortName } from '../../state/ids';
import { cursor } from '../../state/store';
import { parsePath } from '../../state/paths';
import { frameOf, kHalfView, type Frame, type Lens, type Picture } from './frame';
import type { Placed } from './poses';
import { valueOf, type Found, type Sources } from './sources';

/** While the cursor moves, fewer points come sooner. */
const kMaxPoints = { rest: 500_000, moving: 40_000 } as const;
/** Clouds of more entities would hide each other. */
const kMaxClouds = 4;

export interface Cloud {
  readonly id: string;
  readonly points: Float32Array;
  readonly total: number;
  readonly pose?: Placed;
  /** RGB of each point, linear, if the camera saw colours. */
  readonly colours?: Uint8Array;
  /** The frame or the lens that nothing told. */
  readonly guessed: readonly ('pose' | 'lens')[];
}

const isDict = (value: unknown): value is Record<string, unknown> => typeof value === 'object' && value !== null && !Array.isArray(value);

function partAt(value: unknown, path: string): unknown {
  return parsePath(path).keys.reduce<unknown>((part, key) => (isDict(part) && Object.hasOwn(part, key) ? part[key] : Array.isArray(part) ? part[Number(key)] : undefined), value);
}

function imageAt(value: unknown, path: string): Record<string, unknown> | undefined {
  const part = partAt(value, path);
  return isDict(part) && isDict(part.$image) ? part.$image : undefined;
}
const imageWidth = (value: unknown, path: string): number => Number(imageAt(value, path)?.width);

/** What the gateway needs to make points of a depth image: in mm where it has integers. */
export function depthQuery(value: unknown, path: string, lens: Lens | undefined): Record<string, number> | undefined {
  const image = imageAt(value, path);
  const [width, height] = [Number(image?.width), Number(image?.height)];
  if (!image || !(width > 0) || !(height > 0)) return undefined;
  const focal = width / 2 / kHalfView;
  return { ...(lens ?? { fx: focal, fy: focal, cx: (width - 1) / 2, cy: (height - 1) / 2 }), unit: image.dtype === 'uint16' ? 0.001 : 1 };
}

/** Screens have brightness as a power of what it is; three.js reckons with what it is. */
const kLinear = Uint8Array.from({ length: 256 }, (_, i) => Math.round(255 * (i <= 10 ? i / 255 / 12.92 : ((i / 255 + 0.055) / 1.055) ** 2.4)));

/** The colour at which each point of a depth image is seen; pixels are RGBA of `width` x `height`, `scale` as large as those of depth. */
export function coloursOf(points: Float32Array, lens: Lens, scale: number, width: number, height: number, pixels: Uint8ClampedArray): Uint8Array {
  const colours = new Uint8Array(points.length);
  for (let i = 0; i < points.length; i += 3) {
    const z = points[i + 2]!;
    const u = Math.round(((lens.fx * points[i]!) / z + lens.cx + 0.5) * scale - 0.5);
    const v = Math.round(((lens.fy * points[i + 1]!) / z + lens.cy + 0.5) * scale - 0.5);
    const at = 4 * (Math.max(0, Math.min(height - 1, v)) * width + Math.max(0, Math.min(width - 1, u)));
    for (let c = 0; c < 3; ++c) colours[i + c] = kLinear[pixels[at + c]!]!;
  }
  return colours;
}

/** The colours of points, or nothing where the image is gone: depth alone is shown then. */
async function seenColours(points: Float32Array, lens: Lens, depthWidth: number, picture: Picture, signal: AbortSignal): Promise<Uint8Array | undefined> {
  try {
    const { bitmap } = await getImage({ id: picture.id, path: picture.path, as: 'jpeg' }, signal);
    const { width, height } = bitmap;
    const context = new OffscreenCanvas(width, height).getContext('2d', { willReadFrequently: true });
    context?.drawImage(bitmap, 0, 0);
    bitmap.close();
    return context ? coloursOf(points, lens, width / depthWidth, width, height, context.getImageData(0, 0, width, height).data) : undefined;
  } catch (error) {
    if (signal.aborted) throw error;
    return undefined;
  }
}

async function cloudOf(found: Found, member: Member, frame: Frame, max: number, signal: AbortSignal): Promise<Cloud | null> {
  const isDepth = member.kind === 'depth';
  const query = isDepth ? depthQuery(valueOf(found), member.path, frame.lens) : {};
  if (!query) return null;
  const { buffer, headers } = await getBinary('cloud', { id: `${found.moment.id}/0`, path: member.path, max, ...query }, signal);
  if (buffer.byteLength % 12 !== 0) throw new ApiError('data loss', `/api/cloud: ${buffer.byteLength} bytes came, a multiple of 12 was needed.`);
  const points = new Float32Array(buffer);
  const total = Number(headers.get('X-Engram-Total') ?? points.length / 3);
  const guessed = [...(frame.pose ? [] : ['pose' as const]), ...(isDepth && !frame.lens ? ['lens' as const] : [])];
  const colours = isDepth && frame.lens && frame.picture ? await seenColours(points, frame.lens, imageWidth(valueOf(found), member.path), frame.picture, signal) : undefined;
  return { id: found.id, points, total, guessed, ...(colours ? { colours } : {}), ...(frame.pose ? { pose: frame.pose } : {}) };
}

/** False where a value has nothing that points could come of, so that its members need not be asked for. */
export function mayHavePoints(value: unknown, depth = 0): boolean {
  if (typeof value !== 'object' || value === null || depth > 6) return false;
  const { $image: image, $array: array, $ndarray: short } = value as Record<string, unknown>;
  if (isDict(image)) return image.channels === 1 && image.dtype !== 'uint8';
  for (const one of [array, short]) if (isDict(one)) return Array.isArray(one.shape) && one.shape.length === 2 && Number(one.shape[1]) >= 3;
  return Object.values(value).some((part) => mayHavePoints(part, depth + 1));
}

export function createClouds(sources: Sources, isOn: Accessor<boolean>, show: (clouds: readonly Cloud[]) => void) {
  const ids = createMemo(() => sources.idsOf('cloud'));
  const moments = createRequest<Found[]>(() => (isOn() && ids().length > 0 ? { group: 'clouds', run: sources.ask(ids(), cursor(), () => 'at-or-before') } : null));
  let kept: { key: string; max: number; clouds: Cloud[] } = { key: '', max: 0, clouds: [] };
  const clouds = createRequest<Cloud[]>(() => {
    const found = moments.data();
    const max = isMoving() ? kMaxPoints.moving : kMaxPoints.rest;
    if (!found) return null;
    return {
      group: 'clouds',
      run: async (signal) => {
        const key = found.map((one) => one.moment.id).join(' ');
        const isWhole = kept.max >= max || kept.clouds.every((cloud) => cloud.points.length === 3 * cloud.total);
        if (key === kept.key && isWhole) return kept.clouds;
        const all: Cloud[] = [];
        for (const one of found.filter((each) => mayHavePoints(valueOf(each)))) {
          const members = (await membersOf(one.id)).filter((member) => member.kind === 'depth' || member.kind === 'cloud');
          if (members.length === 0 || all.length >= kMaxClouds) continue;
          const frame = await frameOf(valueOf(one), sources.follow(signal));
          for (const member of members.slice(0, kMaxClouds - all.length)) {
            const cloud = await cloudOf(one, member, frame, max, signal);
            if (cloud) all.push(cloud);
          }
        }
        kept = { key, max, clouds: all };
        return all;
      },
    };
  });
  createEffect(() => show(clouds.data() ?? []));
  onCleanup(() => show([]));
  const count = (number: number) => number.toLocaleString('en').replaceAll(',', '\u2009');
  const notes = createMemo<string[]>(() => [
    ...(clouds.data() ?? []).flatMap((cloud) => [
      `${shortName(cloud.id)}: ${cloud.points.length / 3 < cloud.total ? `${count(cloud.points.length / 3)} of ${count(cloud.total)}` : count(cloud.total)} points.`,
      ...(cloud.guessed.includes('lens') ? [`Nothing tells how the camera of ${shortName(cloud.id)} sees, so 67 degrees are assumed.`] : []),
      ...(cloud.guessed.includes('pose') ? [`Nothing tells where ${shortName(cloud.id)} is, so it lies at the origin.`] : []),
    ]),
    ...(clouds.error() ? [`Points are not drawn. ${clouds.error()}`] : []),
  ]);
  return { notes, isPossible: () => ids().length > 0, isBusy: () => clouds.isBusy() };
}
