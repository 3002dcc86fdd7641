// SPDX-License-Identifier: Apache-2.0
// The picture of a memory map: where its moments lie, in which colour and shape.
import type { MemoryMap } from '../../api/types';
import { kFont, type Pen } from '../../ui/svg';
import type { Theme } from '../../ui/theme';

export type ColourBy = 'time' | 'recording';

export interface Point {
  readonly x: number;
  readonly y: number;
}

const kMargin = 16;

/** How large points are: smaller where many share a small picture. A map fills a long picture in its middle alone. */
export function radiusFor(count: number, width: number, height: number): number {
  const area = Math.min(width, 1.5 * height) * Math.min(height, 1.5 * width);
  return Math.max(1.5, Math.min(3.2, 0.33 * Math.sqrt(area / Math.max(1, count))));
}

/** Pixels of the moments: one scale for both directions, because distances are what a map tells. */
export function placesOf(map: MemoryMap, width: number, height: number): Point[] {
  const range = (values: readonly number[]) => values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)] as [number, number], [Infinity, -Infinity] as [number, number]);
  const [x0, x1] = range(map.x);
  const [y0, y1] = range(map.y);
  const scale = Math.min((width - 2 * kMargin) / (x1 - x0), (height - 2 * kMargin) / (y1 - y0));
  const used = Number.isFinite(scale) && scale > 0 ? scale : 0;
  return map.x.map((x, i) => ({ x: width / 2 + (x - (x0 + x1) / 2) * used, y: height / 2 - (map.y[i]! - (y0 + y1) / 2) * used }));
}

/** The moment nearest to a pixel, if one is near. */
export function nearestTo(places: readonly Point[], at: Point, reach = 14): number | undefined {
  let best: number | undefined;
  let distance = reach;
  places.forEach((place, i) => {
    const here = Math.hypot(place.x - at.x, place.y - at.y);
    if (here < distance) { best = i; distance = here; }
  });
  return best;
}

/** The last moment at or before a time, or undefined. */
export function indexAt(times: readonly bigint[], time: bigint): number | undefined {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle]! <= time) low = middle + 1;
    else high = middle;
  }
  return low === 0 ? undefined : low - 1;
}

/** From old to new: lightness goes one way, so that order shows without colours, too. */
const kLight = [[217, 138, 0], [194, 59, 109], [45, 15, 138]] as const;
const kDark = [[122, 98, 224], [232, 110, 160], [255, 222, 90]] as const;

/** The colour of a share between the first moment (0) and the last (1). */
export function timeColour(share: number, isDark: boolean): string {
  const stops = isDark ? kDark : kLight;
  const at = Math.max(0, Math.min(1, share)) * (stops.length - 1);
  const i = Math.min(stops.length - 2, Math.floor(at));
  const mixed = stops[i]!.map((from, c) => Math.round(from + (stops[i + 1]![c]! - from) * (at - i)));
  return `rgb(${mixed.join(',')})`;
}

export const recordingColour = (recording: number, theme: Theme): string => theme.series[((recording % 8) + 8) % 8]!;

/** Recordings differ in shape as well, so that nobody needs to tell colours apart. */
export function shapeOf(c: Pen, which: number, { x, y }: Point, radius: number): void {
  const r = radius * 1.15;
  switch (((which % 4) + 4) % 4) {
    case 0: c.moveTo(x + radius, y); c.arc(x, y, radius, 0, 7); return;
    case 1: c.rect(x - radius, y - radius, 2 * radius, 2 * radius); return;
    case 2: c.moveTo(x, y - r); c.lineTo(x + r, y + radius); c.lineTo(x - r, y + radius); c.closePath(); return;
    default: c.moveTo(x, y - r); c.lineTo(x + r, y); c.lineTo(x, y + r); c.lineTo(x - r, y); c.closePath();
  }
}

export interface MapView {
  readonly map: MemoryMap;
  readonly places: readonly Point[];
  readonly radius: number;
  readonly colourBy: ColourBy;
  readonly isDark: boolean;
  /** The moment at the cursor, and the one below the pointer or the keys. */
  readonly pinned: number | undefined;
  readonly hovered: number | undefined;
}

const kBuckets = 24;

function ring(c: Pen, { x, y }: Point, radius: number, colour: string, theme: Theme): void {
  for (const [width, stroke] of [[5, theme.panel], [2.2, colour]] as const) {
    c.lineWidth = width;
    c.strokeStyle = stroke;
    c.beginPath();
    c.moveTo(x + radius, y);
    c.arc(x, y, radius, 0, 7);
    c.stroke();
  }
}

/** Draws on what is empty; points of one colour are one path. */
export function drawMap(c: Pen, view: MapView, theme: Theme): void {
  const { map, places, colourBy } = view;
  const first = map.times[0] ?? 0n;
  const life = Number((map.times.at(-1) ?? first) - first) || 1;
  const groups = new Map<string, number[]>();
  map.times.forEach((time, i) => {
    const recording = map.recordings[i] ?? 0;
    const colour = colourBy === 'recording' ? recordingColour(recording, theme) : timeColour(Math.round((Number(time - first) / life) * (kBuckets - 1)) / (kBuckets - 1), view.isDark);
    const list = groups.get(colour);
    if (list) list.push(i);
    else groups.set(colour, [i]);
  });
  c.globalAlpha = 0.82;
  for (const [colour, list] of groups) {
    c.fillStyle = colour;
    c.beginPath();
    for (const i of list) shapeOf(c, colourBy === 'recording' ? map.recordings[i] ?? 0 : 0, places[i]!, view.radius);
    c.fill();
  }
  c.globalAlpha = 1;
  if (view.hovered !== undefined && places[view.hovered]) ring(c, places[view.hovered]!, 6, theme.hover, theme);
  if (view.pinned !== undefined && places[view.pinned]) ring(c, places[view.pinned]!, 7.5, theme.accent, theme);
}

export interface LegendEntry {
  readonly label: string;
  readonly colour: string;
  readonly which: number;
}

/** A legend in a line at the foot of a saved picture. */
export function drawLegend(c: Pen, entries: readonly LegendEntry[], isShaped: boolean, x: number, y: number, theme: Theme): void {
  c.font = kFont;
  c.textBaseline = 'middle';
  let at = x;
  for (const entry of entries) {
    c.fillStyle = entry.colour;
    c.beginPath();
    shapeOf(c, isShaped ? entry.which : 0, { x: at + 4, y }, 4);
    c.fill();
    c.fillStyle = theme.ink;
    if (entry.label !== '') c.fillText(entry.label, at + 12, y);
    at += entry.label === '' ? 9 : c.measureText(entry.label).width + 26;
  }
}
