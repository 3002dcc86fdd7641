// SPDX-License-Identifier: Apache-2.0
import { formatClock, formatDate } from './format';
import { lengthOf, type Span } from './span';

export interface Tick {
  readonly time: bigint;
  readonly label: string;
  /** True where a new minute, hour or day begins: written bolder. */
  readonly isMajor: boolean;
}

const kSecond = 1_000_000_000n;
/** Steps that people count in. */
const kSteps: readonly bigint[] = [
  ...[1n, 10n, 100n, 1_000n, 10_000n, 100_000n, 1_000_000n, 10_000_000n, 100_000_000n].flatMap((unit) => [unit, 2n * unit, 5n * unit]),
  ...[1n, 2n, 5n, 10n, 15n, 30n, 60n, 120n, 300n, 600n, 900n, 1800n, 3600n, 7200n, 10800n, 21600n, 43200n].map((s) => s * kSecond),
  ...[1n, 2n, 7n, 14n, 30n, 91n, 182n, 365n, 730n, 1825n, 3650n].map((days) => days * 86400n * kSecond),
];

export function stepFor(span: Span, width: number, minPixels: number): bigint {
  const least = (lengthOf(span) * BigInt(Math.round(minPixels))) / BigInt(Math.max(1, Math.round(width)));
  return kSteps.find((step) => step >= least) ?? kSteps[kSteps.length - 1]!;
}

function labelOf(time: bigint, step: bigint): { label: string; isMajor: boolean } {
  const day = 86400n * kSecond;
  if (step >= day || time % day === 0n) return { label: formatDate(time), isMajor: time % day === 0n && step < day };
  if (step >= 60n * kSecond) return { label: formatClock(time, 0).slice(0, 5), isMajor: time % (3600n * kSecond) === 0n };
  if (step >= kSecond) return { label: formatClock(time, 0), isMajor: time % (60n * kSecond) === 0n };
  if (time % kSecond === 0n) return { label: formatClock(time, 0), isMajor: true };
  // Below a second only the fraction is written; the whole time stands at the full seconds and the cursor.
  const digits = step >= 1_000_000n ? 3 : step >= 1_000n ? 6 : 9;
  return { label: formatClock(time, digits).slice(8), isMajor: false };
}

/** Ticks at round times, at least `minPixels` apart. */
export function ticksOf(span: Span, width: number, minPixels = 92): Tick[] {
  const step = stepFor(span, width, minPixels);
  const ticks: Tick[] = [];
  const first = ((span.from + step - 1n) / step) * step;
  for (let time = first; time < span.to && ticks.length < 200; time += step) ticks.push({ time, ...labelOf(time, step) });
  return ticks;
}
