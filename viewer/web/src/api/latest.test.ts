// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import { Latest } from './latest';
import { Turns } from './turns';

function deferred<T>() {
  let resolve!: (value: T) => void;
  let reject!: (error: unknown) => void;
  const promise = new Promise<T>((yes, no) => { resolve = yes; reject = no; });
  return { promise, resolve, reject };
}
const settle = () => new Promise((done) => setTimeout(done));

function setup() {
  const results: number[] = [];
  const errors: unknown[] = [];
  const started: number[] = [];
  const signals: AbortSignal[] = [];
  const tasks = Array.from({ length: 5 }, () => deferred<number>());
  const latest = new Latest<number>((result) => results.push(result), (error) => errors.push(error));
  const run = (i: number, group = 'g') => latest.run(group, (signal) => { started.push(i); signals[i] = signal; return tasks[i]!.promise; });
  return { results, errors, started, signals, tasks, latest, run };
}

describe('requests of a panel', () => {
  it('run one at a time, and the latest wins', async () => {
    const { results, started, tasks, run } = setup();
    run(0); run(1); run(2); run(3);
    expect(started).toEqual([0]);
    tasks[0]!.resolve(0);
    await settle();
    expect(started).toEqual([0, 3]);
    tasks[3]!.resolve(3);
    await settle();
    expect(results).toEqual([0, 3]);
  });
  it('of another group abort the one under way at once', async () => {
    const { results, started, signals, tasks, run } = setup();
    run(0, 'a'); run(1, 'b');
    expect(started).toEqual([0, 1]);
    expect(signals[0]!.aborted).toBe(true);
    tasks[0]!.resolve(0);
    tasks[1]!.resolve(1);
    await settle();
    expect(results).toEqual([1]);
  });
  it('report an error only if nothing newer waits', async () => {
    const { results, errors, tasks, run } = setup();
    run(0); run(1);
    tasks[0]!.reject(new Error('old'));
    await settle();
    expect(errors).toEqual([]);
    tasks[1]!.reject(new Error('new'));
    await settle();
    expect(errors).toHaveLength(1);
    expect(results).toEqual([]);
  });
  it('end silently when the panel closes', async () => {
    const { results, errors, signals, tasks, latest, run } = setup();
    run(0); run(1);
    latest.close();
    expect(signals[0]!.aborted).toBe(true);
    tasks[0]!.resolve(0);
    run(2);
    await settle();
    expect([results, errors]).toEqual([[], []]);
  });
});

describe('turns', () => {
  it('let a few run, and skip what was aborted while it waited', async () => {
    const turns = new Turns(2);
    const tasks = Array.from({ length: 4 }, () => deferred<number>());
    const started: number[] = [];
    const aborts = tasks.map(() => new AbortController());
    const all = tasks.map((task, i) => turns.run(() => { started.push(i); return task.promise; }, aborts[i]!.signal).catch(() => -1));
    await settle();
    expect(started).toEqual([0, 1]);
    aborts[2]!.abort();
    tasks[0]!.resolve(0);
    await settle();
    expect(started).toEqual([0, 1, 3]);
    tasks[1]!.resolve(1);
    tasks[3]!.resolve(3);
    expect(await Promise.all(all)).toEqual([0, 1, -1, 3]);
  });
});
