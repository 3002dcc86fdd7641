// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { eventOf, executionsOf, integerOf, labelOf, packed, parametersOf, type Execution, type SkillEvent } from './executions';

const kEntity = 'Skill/Event/kitchen/drive';
const data = (stage: number, outcome: number, started: number, more: object = {}) =>
  ({ skill: 'kitchen/drive', stage: { $int32: stage }, outcome: { $int32: outcome }, reason: `r${stage}`, started: { $int64: String(started) }, request: 'Skill/ExecutionRequest/ada/drive/5/0', parameters: '{"to":"counter","speed":0.2}', running: [], ...more });
const event = (time: number, stage: number, outcome: number, started: number, more: object = {}): SkillEvent => eventOf(`${kEntity}/${time}`, data(stage, outcome, started, more))!;
const run = (start: number, end?: number): Execution => ({ entity: kEntity, start: BigInt(start), outcome: 'success', label: '', reason: '', request: '', ...(end === undefined ? {} : { end: BigInt(end) }) });

describe('events of skills', () => {
  it('are read as queries and as moments tell them', () => {
    expect(event(1_000, 0, 0, 1_000)).toMatchObject({ time: 1_000n, stage: 'started', outcome: 'running', started: 1_000n, request: 'Skill/ExecutionRequest/ada/drive/5/0' });
    const linked = eventOf(`${kEntity}/2026-01-01 00:00:01.000000005`, { ...data(2, 3, 7), started: null, execution: { $link: `${kEntity}/900/0` }, request: { $link: 'Skill/ExecutionRequest/ada/drive/5/0' }, running: [{ $int64: '12' }, 13, 'x'] });
    expect(linked).toMatchObject({ time: 1767225601000000005n, stage: 'ended', outcome: 'stopped', started: 900n, running: [12n, 13n], request: 'Skill/ExecutionRequest/ada/drive/5/0' });
  });
  it('of another version, or that are none, are left out', () => {
    for (const odd of [null, 'text', {}, data(3, 0, 1), data(0, 5, 1), { ...data(0, 0, 1), stage: 'STARTED' }]) expect(eventOf(`${kEntity}/1`, odd)).toBeUndefined();
    expect(eventOf(kEntity, data(0, 0, 1))).toBeUndefined();
    expect([integerOf(1.5), integerOf('1e3'), integerOf({ $int64: '9223372036854775807' })]).toEqual([undefined, undefined, 9223372036854775807n]);
  });
});

describe('executions', () => {
  it('are made of their starts, reports and ends, whatever the order', () => {
    const found = executionsOf(kEntity, [event(90, 2, 2, 40), event(10, 0, 0, 10), event(40, 0, 0, 40), event(50, 1, 0, 40), event(30, 2, 1, 10)], 0n);
    expect(found.map(({ start, end, outcome, reason }) => [start, end, outcome, reason])).toEqual([[10n, 30n, 'success', 'r2'], [40n, 90n, 'failure', 'r2']]);
    expect(found[0]!.label).toBe('drive counter');
  });
  it('that began or ended outside of what was asked for are told as far as they are known', () => {
    // The event before the screen ended one execution, and tells that two more run.
    const before = event(100, 2, 1, 20, { running: [{ $int64: '50' }, { $int64: '60' }] });
    const found = executionsOf(kEntity, [before, event(200, 2, 4, 60)], 150n);
    expect(found.map(({ start, end, outcome }) => [start, end, outcome])).toEqual([[50n, undefined, 'running'], [60n, 200n, 'lost']]);
  });
  it('have a label of what they were given, without numbers and words', () => {
    const given = { object: 'Objects/Instances/kitchen/salt_1/2026-01-01 00:00:00.000000/0', command: 'Speech/Commands/human/text/5/0', hand: 'right', n: 2 };
    expect(labelOf('Skill/Event/kitchen/pick', JSON.stringify(given))).toBe('pick salt_1 right');
    expect(labelOf('Skill/Event/kitchen/pick', '{broken')).toBe('pick');
    expect(parametersOf('[1]')).toEqual([]);
  });
});

describe('packing', () => {
  const places = (all: Execution[], max = 4) => packed(all, max).map(({ row, of }) => `${row}/${of}`);
  it('gives those that overlap rows of their own, and all others the whole lane', () => {
    expect(places([run(0, 10), run(10, 20), run(20, 40), run(25, 30), run(30, 35), run(40, 50)])).toEqual(['0/1', '0/1', '0/2', '1/2', '1/2', '0/1']);
  });
  it('keeps what runs in its row, and has no more rows than fit', () => {
    expect(places([run(0), run(1, 2), run(5, 6)])).toEqual(['0/2', '1/2', '1/2']);
    expect(places([run(0, 9), run(1, 9), run(2, 9), run(3, 4), run(5, 6)], 2)).toEqual(['0/2', '1/2', '1/2', '1/2', '1/2']);
    expect(places([])).toEqual([]);
  });
  it('takes thousands at once', () => {
    const many = Array.from({ length: 5000 }, (_, i) => run(i * 10, i * 10 + 5));
    expect(new Set(places(many))).toEqual(new Set(['0/1']));
  });
});
