// SPDX-License-Identifier: Apache-2.0
// Bars of a distribution of PSNR, and which snapshot each of them leads to.
import type { Quality } from '../../api/types';

export interface Bar {
  /** From `low` (included) to `high` (excluded), in dB. */
  readonly low: number;
  readonly high: number;
  readonly count: number;
  /** The worst snapshot in it, as far as the answer names it; else the worst of all. */
  readonly goal: { readonly id: string; readonly psnr: number } | undefined;
  readonly isOwn: boolean;
}

export function barsOf(quality: Quality): Bar[] {
  const worst = [...quality.worst].sort((a, b) => a.psnr - b.psnr);
  const last = quality.counts.length - 1;
  const binOf = (psnr: number) => Math.max(0, Math.min(last, Math.floor((psnr - quality.low) / quality.step)));
  return quality.counts.map((count, i) => {
    const own = worst.find((one) => binOf(one.psnr) === i);
    return { low: quality.low + i * quality.step, high: quality.low + (i + 1) * quality.step, count, goal: own ?? worst[0], isOwn: own !== undefined };
  });
}

/** The bar that an arrow key leads to: the next one that has snapshots. */
export function nextBar(bars: readonly Bar[], from: number, by: 1 | -1): number {
  for (let i = from + by; i >= 0 && i < bars.length; i += by) if (bars[i]!.count > 0) return i;
  return from;
}
