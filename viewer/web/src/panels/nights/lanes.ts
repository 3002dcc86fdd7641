// SPDX-License-Identifier: Apache-2.0
// Lanes of a plan of forgetting: of each stretch of time which share stays, fades and goes.
import type { PlannedEntity } from '../../api/nightTypes';

export type Lane = NonNullable<PlannedEntity['lane']>;
export const kLaneHeight = 16;
/** What is there is seen, however little it is. */
const kMinHeight = 2;

interface Share { readonly top: number; readonly bottom: number }
const kNothing: Share = { top: 0, bottom: 0 };

/** Heights of the parts of one stretch, from the top: what goes, fades and stays. */
export function sharesOf(gone: number, fades: number, stays: number): readonly [Share, Share, Share] {
  const total = gone + fades + stays;
  if (total === 0) return [kNothing, kNothing, kNothing];
  const parts = [gone, fades, stays];
  const heights = parts.map((count) => (count === 0 ? 0 : Math.max(kMinHeight, Math.round((count / total) * kLaneHeight))));
  // Rounding and what is made visible is taken from the largest one.
  const largest = parts.indexOf(Math.max(...parts));
  heights[largest]! += kLaneHeight - heights.reduce((sum, height) => sum + height, 0);
  let top = 0;
  return heights.map((height) => { const share = { top, bottom: top + height }; top += height; return share; }) as unknown as readonly [Share, Share, Share];
}

/** Rectangles of one part as the path of an SVG, a unit wide for each stretch; equal neighbours are one. */
function pathOf(shares: readonly Share[]): string {
  let path = '';
  for (let i = 0; i < shares.length;) {
    const { top, bottom } = shares[i]!;
    let end = i + 1;
    while (end < shares.length && shares[end]!.top === top && shares[end]!.bottom === bottom) end += 1;
    if (bottom > top) path += `M${i} ${top}H${end}V${bottom}H${i}Z`;
    i = end;
  }
  return path;
}

export function lanePaths(lane: Lane): { readonly gone: string; readonly fades: string; readonly stays: string } {
  const shares = lane.stays.map((stays, i) => sharesOf(lane.gone[i] ?? 0, lane.fades[i] ?? 0, stays));
  return { gone: pathOf(shares.map(([gone]) => gone)), fades: pathOf(shares.map(([, fades]) => fades)), stays: pathOf(shares.map(([, , stays]) => stays)) };
}

/** All lanes as one. */
export function sumOf(lanes: readonly Lane[], bins: number): Lane {
  const sum = (of: (lane: Lane) => readonly number[]) => Array.from({ length: bins }, (_, i) => lanes.reduce((total, lane) => total + (of(lane)[i] ?? 0), 0));
  return { stays: sum((lane) => lane.stays), fades: sum((lane) => lane.fades), gone: sum((lane) => lane.gone) };
}
