// SPDX-License-Identifier: Apache-2.0
// Stretches of time and their place on the screen.
//
// Times are int64 nanoseconds since 1970. A float64 tells such times apart only to 256 ns, so times
// are BigInt everywhere; only differences within what is on the screen become floats.

/** From `from` (included) to `to` (excluded); `to > from`. */
export interface Span {
  readonly from: bigint;
  readonly to: bigint;
}

/** What zooming in ends at. A pixel is then a few tens of nanoseconds. */
export const kMinSpanNs = 20_000n;

export const lengthOf = (span: Span): bigint => span.to - span.from;

export const clampTime = (time: bigint, span: Span): bigint =>
  time < span.from ? span.from : time > span.to ? span.to : time;

const kMaxTime = 2n ** 63n - 1n;

/** The part of a span that int64 nanoseconds can name; others cannot be asked for. */
export const whatExists = ({ from, to }: Span): Span => ({ from: from < -kMaxTime ? -kMaxTime : from, to: to > kMaxTime ? kMaxTime : to });

/** Where a time lies on a screen `width` pixels wide that shows `span`. */
export function xOf(time: bigint, span: Span, width: number): number {
  return (Number(time - span.from) / Number(span.to - span.from)) * width;
}

/** `length` times a float, to the nearest nanosecond: the product is made in BigInt, so no digit of it is lost. */
function scaled(length: bigint, factor: number): bigint {
  return (length * BigInt(Math.round(factor * 2 ** 40)) + (1n << 39n)) >> 40n;
}

/** The time below pixel `x`; exact at both ends. */
export function timeAt(x: number, span: Span, width: number): bigint {
  return span.from + scaled(span.to - span.from, x / width);
}

/** Zooms by `factor` (below 1: closer) with the time at `x` staying where it is, within `limits`. */
export function zoom(span: Span, x: number, width: number, factor: number, limits: Span): Span {
  const anchor = timeAt(x, span, width);
  let length = scaled(lengthOf(span), factor);
  if (length < kMinSpanNs) length = kMinSpanNs;
  if (length > lengthOf(limits)) return limits;
  const before = scaled(length, x / width);
  return within({ from: anchor - before, to: anchor - before + length }, limits);
}

/** Moves a span by pixels to the left, within `limits`. */
export function pan(span: Span, pixels: number, width: number, limits: Span): Span {
  const shift = scaled(lengthOf(span), pixels / width);
  return within({ from: span.from + shift, to: span.to + shift }, limits);
}

/** Pushes a span into `limits` without changing its length, if it fits. */
export function within(span: Span, limits: Span): Span {
  const length = lengthOf(span);
  if (length >= lengthOf(limits)) return limits;
  if (span.from < limits.from) return { from: limits.from, to: limits.from + length };
  if (span.to > limits.to) return { from: limits.to - length, to: limits.to };
  return span;
}

/** A span of the same length that has `time` in it, not at its edge. */
export function showing(span: Span, time: bigint, limits: Span): Span {
  const margin = lengthOf(span) / 20n;
  if (time >= span.from + margin && time <= span.to - margin) return span;
  if (time >= span.from && time <= span.to && (span.from === limits.from || span.to === limits.to)) return span;
  const half = lengthOf(span) / 2n;
  return within({ from: time - half, to: time - half + lengthOf(span) }, limits);
}

/** What is shown at first: all that was, and of what is to come a fifteenth of that at most. */
export function homeOf(first: bigint, last: bigint, limits: Span): Span {
  const life = last > first ? last - first : 1_000_000_000n;
  return within({ from: limits.from, to: clampTime(last + life / 15n + kMinSpanNs, limits) }, limits);
}

/** The whole of a memory and what is to come after it, with a little air before. */
export function limitsOf(first: bigint, last: bigint, horizonNs: bigint): Span {
  const life = last > first ? last - first : 1_000_000_000n;
  return whatExists({ from: first - life / 100n - kMinSpanNs, to: last + (horizonNs > life / 50n ? horizonNs : life / 50n) + kMinSpanNs });
}
