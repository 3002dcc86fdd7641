// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Moment } from '../../api/types';
import { KeptMoments, type Wanted } from './kept';

const moment = (time: bigint, next?: bigint, source = 'recorded'): Moment => ({ id: `A/B/C/D/${time}`, time, source, instances: [], members: [], ...(next === undefined ? {} : { next }) }) as unknown as Moment;

function counted(answer: (wanted: Wanted) => Moment | null) {
  const asked: bigint[] = [];
  let time = 0;
  const kept = new KeptMoments(async (wanted) => { asked.push(wanted.at); return answer(wanted); }, () => time);
  const ask = (at: bigint, news = '', which = 'at-or-before') => kept.ask({ entity: 'A/B/C/D', at, which, news }, 1000, new AbortController().signal);
  return { asked, ask, wait: (ms: number) => { time += ms; } };
}

describe('kept moments', () => {
  it('hold until the next snapshot', async () => {
    const { asked, ask } = counted(() => moment(10n, 20n));
    for (const at of [10n, 19n, 15n, 12n]) expect((await ask(at))!.time).toBe(10n);
    expect(asked).toEqual([10n]);
    await ask(20n);
    await ask(9n);
    expect(asked).toEqual([10n, 20n, 9n]);
  });
  it('hold at the end until a commit is told', async () => {
    const { asked, ask } = counted(() => moment(10n));
    await ask(10n, '1');
    await ask(5000n, '1');
    expect(asked).toEqual([10n]);
    await ask(5000n, '2');
    expect(asked).toEqual([10n, 5000n]);
  });
  it('are not asked for twice at once', async () => {
    const { asked, ask } = counted(() => moment(10n, 20n));
    await Promise.all([ask(12n), ask(12n)]);
    expect(asked).toEqual([12n]);
  });
  it('are asked for again when they are old, or failed', async () => {
    let fails = true;
    const { asked, ask, wait } = counted(() => { if (fails) throw new Error('lost'); return moment(10n, 20n); });
    await expect(ask(12n)).rejects.toThrow('lost');
    fails = false;
    await ask(12n);
    wait(1001);
    await ask(12n);
    expect(asked).toEqual([12n, 12n, 12n]);
  });
  it('tell that there was nothing yet, until something comes', async () => {
    const { asked, ask } = counted(() => null);
    expect(await ask(12n)).toBeNull();
    expect(await ask(11n)).toBeNull();
    expect(asked).toEqual([12n]);
    await ask(13n);
    await ask(13n, '1');
    expect(asked).toEqual([12n, 13n, 13n]);
  });
  it('of the future hold at one time alone', async () => {
    const { asked, ask } = counted(({ at }) => moment(at, undefined, 'predicted'));
    await ask(30n, '1', 'predict');
    await ask(30n, '1', 'predict');
    await ask(31n, '1', 'predict');
    await ask(31n, '2', 'predict');
    expect(asked).toEqual([30n, 31n, 31n]);
  });
});
