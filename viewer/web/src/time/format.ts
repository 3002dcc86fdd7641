// SPDX-License-Identifier: Apache-2.0
// How times and durations are written: UTC, with as many digits as the zoom can tell apart.

const pad = (value: number, digits = 2): string => String(value).padStart(digits, '0');

const floorDiv = (a: bigint, b: bigint): bigint => (a >= 0n ? a / b : -((-a + b - 1n) / b));

function split(time: bigint): { date: Date; ns: number } {
  const seconds = floorDiv(time, 1_000_000_000n);
  return { date: new Date(Number(seconds) * 1000), ns: Number(time - seconds * 1_000_000_000n) };
}

export function formatDate(time: bigint): string {
  const { date } = split(time);
  if (Number.isNaN(date.getTime())) return `${time} ns`;
  return `${date.getUTCFullYear()}-${pad(date.getUTCMonth() + 1)}-${pad(date.getUTCDate())}`;
}

/** Time of day with `digits` of a second's fraction (0 to 9). */
export function formatClock(time: bigint, digits = 3): string {
  const { date, ns } = split(time);
  if (Number.isNaN(date.getTime())) return `${time} ns`;
  const clock = `${pad(date.getUTCHours())}:${pad(date.getUTCMinutes())}:${pad(date.getUTCSeconds())}`;
  return digits === 0 ? clock : `${clock}.${pad(ns, 9).slice(0, digits)}`;
}

/** As Engram prints times: at least microseconds, nine digits where the time has so many. */
export function formatTime(time: bigint): string {
  const digits = time % 1000n === 0n ? 6 : 9;
  return `${formatDate(time)} ${formatClock(time, digits)}`;
}

/** A duration of nanoseconds in the unit that reads best: `400 ms`, `2.5 s`, `3 min 20 s`. */
export function formatDuration(ns: bigint | number): string {
  const value = Number(ns);
  const size = Math.abs(value);
  const short = (x: number) => String(Number(x.toPrecision(3)));
  if (size < 1e3) return `${short(value)} ns`;
  if (size < 1e6) return `${short(value / 1e3)} µs`;
  if (size < 1e9) return `${short(value / 1e6)} ms`;
  if (size < 60e9) return `${short(value / 1e9)} s`;
  const sign = value < 0 ? '-' : '';
  const seconds = Math.round(size / 1e9);
  if (seconds < 3600) return `${sign}${Math.floor(seconds / 60)} min${seconds % 60 ? ` ${seconds % 60} s` : ''}`;
  if (seconds < 86400) return `${sign}${Math.floor(seconds / 3600)} h ${Math.floor((seconds % 3600) / 60)} min`;
  return `${sign}${Math.floor(seconds / 86400)} d ${Math.floor((seconds % 86400) / 3600)} h`;
}

export function formatBytes(bytes: number): string {
  if (bytes < 1000) return `${bytes} B`;
  const units = ['kB', 'MB', 'GB', 'TB'];
  let value = bytes / 1000;
  let unit = 0;
  while (value >= 1000 && unit < units.length - 1) { value /= 1000; unit += 1; }
  return `${Number(value.toPrecision(3))} ${units[unit]}`;
}

export const formatCount = (count: number): string => count.toLocaleString('en-US').replace(/,/g, ' ');

/** A number with as many digits as help: no exponent where it can be avoided, no trailing zeros. */
export function formatNumber(value: number): string {
  if (!Number.isFinite(value)) return String(value);
  const size = Math.abs(value);
  if (value !== 0 && (size >= 1e7 || size < 1e-4)) return value.toExponential(3);
  return String(Number(value.toPrecision(6)));
}

/**
 * Reads a time that a person typed: as Engram prints it, RFC 3339, a clock on the day of `near`,
 * or an integer of nanoseconds. undefined where it is none.
 */
export function parseTime(text: string, near: bigint): bigint | undefined {
  const trimmed = text.trim();
  if (/^-?\d{5,19}$/.test(trimmed)) return BigInt(trimmed);
  const match = /^(?:(\d{4}-\d\d-\d\d)[ T])?(\d\d?):(\d\d)(?::(\d\d)(?:\.(\d{1,9}))?)?Z?$/.exec(trimmed);
  if (!match) return undefined;
  const [, date = formatDate(near), hours = '0', minutes = '0', seconds = '0', fraction = ''] = match;
  const ms = Date.parse(`${date}T${hours.padStart(2, '0')}:${minutes}:${seconds}Z`);
  return Number.isNaN(ms) ? undefined : BigInt(ms) * 1_000_000n + BigInt(fraction.padEnd(9, '0'));
}
