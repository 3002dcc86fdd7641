// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { memoryMap } from '../../api/types';
import { SvgPen } from '../../ui/svg';
import type { Theme } from '../../ui/theme';
import { drawMap, indexAt, nearestTo, placesOf, timeColour } from './draw';

const answer = { entity: 'A/B/C/D', space: 's', coded_by: 'images', times: ['30', '10', '20'], x: [3, 1, 2], y: [0, 0, 1], recordings: [1, 0, 0], explained: 0.4 };
const map = memoryMap(answer, '');

/** How light a colour looks (ITU-R BT.709), between 0 and 1. */
function lightness(colour: string): number {
  const [r, g, b] = colour.match(/\d+/g)!.map((c) => { const s = Number(c) / 255; return s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4; }) as [number, number, number];
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

describe('the answer of a map', () => {
  it('is put in the order of time', () => {
    expect(map).toMatchObject({ times: [10n, 20n, 30n], x: [1, 2, 3], y: [0, 1, 0], recordings: [0, 0, 1] });
  });
  it('with lists of several lengths is refused', () => {
    expect(() => memoryMap({ ...answer, x: [1] }, '')).toThrow(/as many numbers as there are times \(3\)/);
    expect(() => memoryMap({ ...answer, recordings: [1] }, '')).toThrow(/as many numbers/);
  });
});

describe('places on a map', () => {
  it('have one scale for both directions, and lie inside', () => {
    const places = placesOf(map, 400, 200);
    expect(places[2]!.x - places[1]!.x).toBeCloseTo(places[0]!.y - places[1]!.y);
    for (const { x, y } of places) expect(x >= 0 && x <= 400 && y >= 0 && y <= 200).toBe(true);
  });
  it('exist where all moments are one', () => {
    expect(placesOf({ ...map, x: [5, 5, 5], y: [2, 2, 2] }, 100, 60)).toEqual([{ x: 50, y: 30 }, { x: 50, y: 30 }, { x: 50, y: 30 }]);
  });
  it('are found by pixel and by time', () => {
    const places = placesOf(map, 400, 200);
    expect(nearestTo(places, { x: places[1]!.x + 3, y: places[1]!.y - 2 })).toBe(1);
    expect(nearestTo(places, { x: -50, y: -50 })).toBeUndefined();
    expect([9n, 10n, 19n, 20n, 99n].map((time) => indexAt(map.times, time))).toEqual([undefined, 0, 0, 1, 2]);
  });
});

describe('colours of time', () => {
  it.each([['light', false], ['dark', true]] as const)('go one way in lightness, and stand out: %s', (_, isDark) => {
    const all = Array.from({ length: 12 }, (__, i) => lightness(timeColour(i / 11, isDark)));
    const sorted = [...all].sort((a, b) => (isDark ? a - b : b - a));
    expect(all).toEqual(sorted);
    const back = isDark ? lightness('rgb(22,27,31)') : 1;
    for (const one of all) expect((Math.max(one, back) + 0.05) / (Math.min(one, back) + 0.05)).toBeGreaterThan(2.6);
  });
});

describe('a map as SVG', () => {
  it('has a shape for every moment and rings for what is pointed at', () => {
    const theme = { series: ['#1', '#2', '#3', '#4', '#5', '#6', '#7', '#8'], panel: '#fff', accent: '#00f', hover: '#888' } as unknown as Theme;
    const pen = new SvgPen(400, 200, 'map');
    drawMap(pen, { map, places: placesOf(map, 400, 200), radius: 3, colourBy: 'recording', isDark: false, pinned: 0, hovered: 2 }, theme);
    const text = pen.text();
    expect(text.match(/fill="#[12]"/g)).toEqual(['fill="#1"', 'fill="#2"']);
    expect(text.match(/stroke="#(00f|888)"/g)).toEqual(['stroke="#888"', 'stroke="#00f"']);
  });
});
