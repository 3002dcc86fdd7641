// SPDX-License-Identifier: Apache-2.0
// Cost maps (docs/navigation.md), in the colours in which RViz shows those of Nav2.
import { arrayOf } from '../../api/arrays';
import { numberAt } from '../values';
import { planarIn, type Planar } from './plans';

export interface CostMap {
  readonly rows: number;
  readonly columns: number;
  /** The side of a cell in m. */
  readonly resolution: number;
  /** The corner of cell [0, 0]. */
  readonly corner: Planar;
  readonly costs: ArrayLike<number>;
  readonly leftOut: readonly string[];
}

/** Graphics processors have textures of at most so many cells to a side. */
export const kMaxSide = 4096;

const isDict = (value: unknown): value is Record<string, unknown> => typeof value === 'object' && value !== null && !Array.isArray(value);

/** A map with all of its costs; a text says why it cannot be drawn. */
export function costMapIn(data: unknown): CostMap | string {
  const costs = isDict(data) ? arrayOf(data.costs) : undefined;
  const corner = planarIn(data, 'pose_world_map');
  const resolution = numberAt(data, 'resolution');
  if (!isDict(data) || !costs || costs.shape.length !== 2) return 'it has no costs in rows and columns';
  const [rows, columns] = costs.shape as [number, number];
  if (!(rows > 0 && columns > 0)) return 'it has no cells';
  if (rows > kMaxSide || columns > kMaxSide) return `it has ${rows} x ${columns} cells, and at most ${kMaxSide} x ${kMaxSide} can be drawn`;
  if (!corner || !(resolution > 0)) return 'it does not tell where it is, or how large its cells are';
  const leftOut = (Array.isArray(data.left_out) ? data.left_out : []).map((one) => (isDict(one) && typeof one.reason === 'string' ? one.reason : '')).filter((reason) => reason !== '');
  return { rows, columns, resolution, corner, costs: costs.data, leftOut };
}

export const kFree = 0;
const kInscribed = 253;
const kObstacle = 254;
const kUnknown = 255;

/** RGBA of one cost: free ones are clear; from blue to red the nearer, then cyan, magenta and grey. */
export function colourOfCost(cost: number): readonly [number, number, number, number] {
  if (cost === kFree) return [0, 0, 0, 0];
  if (cost === kInscribed) return [0, 255, 255, 200];
  if (cost === kObstacle) return [255, 0, 255, 220];
  if (cost === kUnknown) return [112, 137, 134, 150];
  const red = Math.round((255 * (cost - 1)) / 251);
  return [red, 0, 255 - red, 140];
}

export function coloursOfCosts(costs: ArrayLike<number>): Uint8Array {
  const table = Array.from({ length: 256 }, (_, cost) => colourOfCost(cost));
  const colours = new Uint8Array(4 * costs.length);
  for (let i = 0; i < costs.length; ++i) colours.set(table[costs[i]! & 255]!, 4 * i);
  return colours;
}
