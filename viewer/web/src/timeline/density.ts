// SPDX-License-Identifier: Apache-2.0
// Counts of snapshots per pixel, for the lanes on the screen.
import { createMemo } from 'solid-js';
import { decodeDensity, type Density } from '../api/binary';
import { getBinary } from '../api/client';
import { createRequest, type Request } from '../state/request';
import { liveLast } from '../state/store';
import { lengthOf, whatExists, type Span } from '../time/span';

export interface Densities {
  readonly span: Span;
  readonly pixels: number;
  readonly lanes: ReadonlyMap<string, Density>;
}

/** Half a screen more to both sides, so that panning shows something before the answer is there. */
export function wider(span: Span): Span {
  const half = lengthOf(span) / 2n;
  return whatExists({ from: span.from - half, to: span.to + half });
}

export async function askDensity(ids: readonly string[], span: Span, pixels: number, signal?: AbortSignal): Promise<Densities> {
  const { buffer } = await getBinary('density', { entity: ids, from: span.from, to: span.to, pixels }, signal);
  const lanes = decodeDensity(buffer, ids.length, pixels);
  return { span, pixels, lanes: new Map(ids.map((id, i) => [id, lanes[i]!])) };
}

/** Asks again whenever what is shown changes, and where a memory grows, every `growth` of it. */
export function createDensity(ids: () => readonly string[], span: () => Span, pixels: () => number, growth: bigint): Request<Densities> {
  const grown = createMemo(() => (liveLast() ?? 0n) / growth);
  return createRequest(() => {
    grown();
    const asked = ids();
    const width = Math.min(4000, Math.round(pixels()));
    const here = span();
    if (asked.length === 0 || width < 2) return null;
    return { group: 'density', run: (signal) => askDensity(asked, here, width, signal) };
  });
}
