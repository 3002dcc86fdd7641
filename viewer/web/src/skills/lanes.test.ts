// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { SvgPen } from '../ui/svg';
import type { Theme } from '../ui/theme';
import { chosenFor, keptWindow, partsOf } from './ask';
import { drawEvents, hitAt, type LanePlace } from './draw';
import { kOutcomes, packed, type Execution } from './executions';
import { entitiesOf, laneOf, markOf, type EventLane } from './lanes';

const theme = Object.fromEntries(['ink', 'dim', 'panel', 'accent', ...kOutcomes].map((name) => [name, `var(${name})`])) as unknown as Theme;
const kDrive = 'Skill/Event/kitchen/drive';
const run = (start: number, end: number | undefined, outcome: Execution['outcome']): Execution => ({ entity: kDrive, start: BigInt(start), outcome, label: `drive ${start}`, reason: 'why', request: '', ...(end === undefined ? {} : { end: BigInt(end) }) });
const place: LanePlace = { span: { from: 0n, to: 1000n }, width: 1000, y: 0, height: 21, last: 900n };
const lane = (executions: Execution[], more: Partial<EventLane> = {}): EventLane => ({ executions, slots: packed(executions, 4), marks: [], dense: [], ...more });
const drawn = (one: EventLane, chosen: { entity: string; start: bigint } | null = null): string => {
  const pen = new SvgPen(1000, 21, 'a lane');
  drawEvents(pen, one, chosen, place, theme);
  return pen.text();
};

describe('rows of the timeline', () => {
  const entity = (id: string) => ({ id, isEntity: true, isOpen: false, node: { id, name: id, level: 'entity' as const, entities: 1 } });
  it('show events of skills and drives, and counts of all else', () => {
    expect(entitiesOf(entity(kDrive) as never)).toEqual([kDrive]);
    expect(entitiesOf(entity('Navigation/Event/robot/drive') as never)).toEqual(['Navigation/Event/robot/drive']);
    for (const id of ['Skill/Executable/kitchen/drive', 'Skills/Actions/robot/pick', 'Navigation/Plan/robot/drive', 'Other/Event/a/b']) expect(entitiesOf(entity(id) as never)).toEqual([]);
  });
  it('show those of a whole provider while it is closed', () => {
    const provider = { id: 'Skill/Event/kitchen', isEntity: false, isOpen: false, node: { id: 'Skill/Event/kitchen', name: 'kitchen', level: 'provider' as const, entities: 2, children: [entity(kDrive).node, entity('Skill/Event/kitchen/pick').node] } };
    expect(entitiesOf(provider as never)).toEqual([kDrive, 'Skill/Event/kitchen/pick']);
    expect(entitiesOf({ ...provider, isOpen: true } as never)).toEqual([]);
  });
});

describe('what is asked for', () => {
  it('is the stretch around the screen, until that leaves it or shows a small part of it', () => {
    const first = keptWindow(undefined, { from: 1000n, to: 2000n });
    expect(first).toEqual({ from: 500n, to: 2500n });
    expect(keptWindow(first, { from: 1400n, to: 2400n })).toBe(first);
    expect(keptWindow(first, { from: 1600n, to: 2600n })).toEqual({ from: 1100n, to: 3100n });
    expect(keptWindow(first, { from: 1000n, to: 1400n })).toEqual({ from: 800n, to: 1600n });
  });
  it('is each event of skills with few of them, and pixels of the others', () => {
    expect([...chosenFor(new Map([['busy', 9000], ['b', 700], ['a', 600], ['c', 400]]), 1500)]).toEqual(['c', 'a']);
    expect([...chosenFor(new Map([['all', 1500]]), 1500)]).toEqual(['all']);
  });
  it('is asked for in parts that fit a question', () => {
    expect(partsOf([1, 2, 3, 4, 5], 2)).toEqual([[1, 2], [3, 4], [5]]);
    expect(partsOf([], 2)).toEqual([]);
  });
});

describe('a lane', () => {
  it('tells outcomes apart by colour and by shape', () => {
    const shapes = kOutcomes.map((outcome) => drawn(lane([run(100, outcome === 'running' ? undefined : 400, outcome)])));
    for (const [i, outcome] of kOutcomes.entries()) expect(shapes[i]).toContain(`var(${outcome})`);
    const plain = shapes.map((text) => text.replaceAll(/var\(\w+\)/g, 'C'));
    expect(new Set(plain).size).toBe(kOutcomes.length);
    const thin = kOutcomes.map((outcome) => drawn(lane([run(100, 103, outcome)])).replaceAll(/var\(\w+\)/g, 'C'));
    expect(new Set(thin).size).toBe(kOutcomes.length);
  });
  it('has a running bar until the last snapshot of the memory, open at its end', () => {
    expect(drawn(lane([run(100, undefined, 'running')]))).toMatch(/M900 3\.7L100\.7 3\.7L100\.7 17\.3L900 17\.3"/);
  });
  it('frames the chosen one, and names those that have room', () => {
    expect(drawn(lane([run(100, 400, 'success')]), { entity: kDrive, start: 100n })).toContain('stroke="var(ink)"');
    expect(drawn(lane([run(100, 400, 'success')]))).toContain('>drive 100<');
    expect(drawn(lane([run(100, 120, 'success')]))).not.toContain('drive 100');
  });
  it('of thousands draws pixels, and what runs between them', () => {
    const outcomes = Array.from({ length: 100 }, (_, i) => (i % 10 === 0 ? (i === 50 ? 'failure' : 'success') : undefined) as Execution['outcome'] | undefined);
    const text = drawn(lane([], { dense: [{ from: 0n, to: 1000n, outcomes, isRunning: outcomes.map((_, i) => i === 40) }] }));
    expect(text.match(/fill="var\(success\)"/g)).toHaveLength(9);
    expect(text).toContain('M410 3h90v15h-90Z" fill="var(failure)" opacity="0.4"');
  });
});

describe('a click', () => {
  const mark = markOf('Skill/Refusal/kitchen/drive/250', { reason: 'no' })!;
  it('hits the bar below it', () => {
    const two = lane([run(100, 400, 'success'), run(200, 300, 'failure')]);
    expect(hitAt(two, 250, 5, place)).toMatchObject({ execution: { start: 100n } });
    expect(hitAt(two, 250, 16, place)).toMatchObject({ execution: { start: 200n } });
    expect(hitAt(two, 500, 5, place)).toBeUndefined();
    expect(hitAt(lane([run(100, 100, 'success')]), 104, 10, place)).toMatchObject({ execution: { start: 100n } });
  });
  it('hits a mark near it, in front of a bar', () => {
    expect(hitAt(lane([run(100, 400, 'success')], { marks: [mark] }), 253, 10, place)).toEqual({ mark });
    expect(hitAt(lane([run(100, 400, 'success')], { marks: [mark] }), 260, 10, place)).toMatchObject({ execution: { start: 100n } });
    const request = { id: 'r', time: 98n, glyph: 'request' as const, what: '' };
    expect(hitAt(lane([run(100, 400, 'success')], { marks: [request] }), 101, 14, place)).toMatchObject({ execution: { start: 100n } });
    expect(hitAt(lane([run(100, 400, 'success')], { marks: [request] }), 101, 3, place)).toEqual({ mark: request });
  });
});

describe('marks', () => {
  it('are what requests, refusals and drives tell', () => {
    expect(markOf('Skill/Refusal/kitchen/pick/5', { reason: 'hand is full' })).toMatchObject({ glyph: 'refusal', what: 'pick refused: hand is full' });
    expect(markOf('Skill/ExecutionRequest/ada/pick/5', { wish: { $int32: 1 }, parameters: '{}' })).toMatchObject({ glyph: 'stop', what: 'pick: asked to stop by ada' });
    const drives = [0, 1, 2, 3, 4, 5, 6, 7].map((kind) => markOf('Navigation/Event/robot/drive/5', { kind: { $int32: kind }, goal: 'table', reason: 'r' }));
    expect(new Set(drives.map((one) => one!.glyph)).size).toBe(8);
    expect(drives[2]).toMatchObject({ glyph: 'blocked', what: 'table: blocked: r' });
    expect(markOf('Navigation/Event/robot/drive/5', { kind: { $int32: 8 } })).toBeUndefined();
    expect(markOf('Navigation/Event/robot/drive', { kind: { $int32: 1 } })).toBeUndefined();
  });
  it('stand where an execution was asked for', () => {
    const one = { ...run(100, 400, 'success'), request: 'Skill/ExecutionRequest/ada/drive/90/0' };
    const told = laneOf([kDrive], new Map(), new Map([[kDrive, [one]]]), new Map());
    expect(told.marks).toEqual([{ id: one.request, time: 90n, glyph: 'request', what: 'drive 100: asked for by ada' }]);
  });
});
