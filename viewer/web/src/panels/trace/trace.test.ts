// SPDX-License-Identifier: Apache-2.0
import { describe, expect, it } from 'vitest';
import type { Links } from '../../api/types';
import { followLinks, kMaxNodes, keyOfId } from './follow';
import { kNodeWidth, neighbourOf, placeTrace } from './layout';

const id = (name: string, time: number, instance = ''): string => `A/B/C/${name}/${time}${instance}`;
const never = new AbortController().signal;

/** Answers from a list of links: of whom, by which member, to whom. */
function answering(list: readonly (readonly [string, string, string])[]) {
  const asked: string[] = [];
  const ask = async (of: string): Promise<Links> => {
    asked.push(of);
    return {
      to: list.filter(([from]) => keyOfId(from) === keyOfId(of)).map(([, path, to]) => ({ path, id: to })),
      from: [...new Set(list.filter(([, , to]) => keyOfId(to) === keyOfId(of)).map(([from]) => from))],
    };
  };
  return { asked, ask };
}

// image <- pose <- grasp <- failure, and the grasp has the image itself, too.
const kChain = [
  [id('pose', 2), 'image', id('image', 1, '/0')],
  [id('grasp', 3), 'pose', id('pose', 2)],
  [id('grasp', 3), 'view/image', id('image', 1, '/1')],
  [id('failure', 4), 'of', id('grasp', 3)],
] as const;

describe('a trace', () => {
  it('follows causes and consequences, and names members', async () => {
    const { ask, asked } = answering(kChain);
    const grown: number[] = [];
    const trace = await followLinks(id('pose', 2), ask, (part) => grown.push(part.nodes.length), never);
    expect(trace.nodes.map((node) => [node.key, node.depth])).toEqual([[id('pose', 2), 0], [id('image', 1), -1], [id('grasp', 3), 1], [id('failure', 4), 2]]);
    expect(trace.edges).toContainEqual({ cause: id('image', 1), effect: id('grasp', 3), paths: ['view/image'] });
    expect(trace.edges).toContainEqual({ cause: id('grasp', 3), effect: id('failure', 4), paths: ['of'] });
    expect(trace).toMatchObject({ omitted: 0, isCut: false });
    expect(asked.length).toBe(4);
    expect(grown).toEqual([3, 4]);
  });

  it('does not follow the consequences of causes', async () => {
    const { ask } = answering([...kChain, [id('other', 9), 'image', id('image', 1)]]);
    const trace = await followLinks(id('failure', 4), ask, () => {}, never);
    expect(trace.nodes.some((node) => node.key === id('other', 9))).toBe(false);
  });

  it('ends at 24 snapshots and says how many links it left out', async () => {
    const wide = Array.from({ length: 40 }, (_, i) => [id('many', 10 + i), 'of', id('one', 1)] as const);
    const deep = wide.flatMap(([from], i) => Array.from({ length: 9 }, (_, j) => [id(`deep${i}`, 100 + j), 'of', from] as const));
    const trace = await followLinks(id('one', 1), answering([...wide, ...deep]).ask, () => {}, never);
    expect(trace.nodes.length).toBe(kMaxNodes);
    expect(trace.omitted).toBeGreaterThan(31);
    for (const edge of trace.edges) for (const key of [edge.cause, edge.effect]) expect(trace.nodes.some((node) => node.key === key)).toBe(true);
  });

  it('ends three links away', async () => {
    const chain = [1, 2, 3, 4, 5].map((i) => [id('n', i + 1), 'before', id('n', i)] as const);
    const trace = await followLinks(id('n', 6), answering(chain).ask, () => {}, never);
    expect(trace.nodes.map((node) => node.id)).toEqual([6, 5, 4, 3].map((i) => id('n', i)));
    expect(trace).toMatchObject({ omitted: 0, isCut: true });
  });

  it('keeps what it has where one snapshot fails, and fails with the first one', async () => {
    const { ask } = answering(kChain);
    const failing = (which: string) => (one: string) => (keyOfId(one) === which ? Promise.reject(new Error('it is damaged')) : ask(one));
    const trace = await followLinks(id('pose', 2), failing(id('grasp', 3)), () => {}, never);
    expect(trace.nodes.find((node) => node.key === id('grasp', 3))?.problem).toBe('it is damaged');
    await expect(followLinks(id('pose', 2), failing(id('pose', 2)), () => {}, never)).rejects.toThrow('it is damaged');
  });

  it('stops asking when it is cancelled', async () => {
    const { ask, asked } = answering(kChain);
    const stop = new AbortController();
    await expect(followLinks(id('pose', 2), (one) => { stop.abort(); return ask(one); }, () => {}, stop.signal)).rejects.toThrow(/abort/i);
    expect(asked.length).toBe(1);
  });

  it('survives circles and links to entities', async () => {
    const circle = [[id('a', 1), 'x', id('b', 2)], [id('b', 2), 'x', id('a', 1)], [id('a', 1), 'class', 'A/B/C/mug'], [id('a', 1), 'self', id('a', 1)]] as const;
    const { ask, asked } = answering(circle);
    const trace = await followLinks(id('a', 1), ask, () => {}, never);
    expect(asked).toEqual([id('a', 1), id('b', 2)]);
    expect(placeTrace(trace).nodes.length).toBe(3);
  });
});

describe('the graph of a trace', () => {
  it('has every cause to the left of its consequence, and no node on another', async () => {
    const trace = await followLinks(id('grasp', 3), answering(kChain).ask, () => {}, never);
    const { nodes, width, height } = placeTrace(trace);
    const x = (key: string) => nodes.find((node) => node.key === key)!.x;
    for (const edge of trace.edges) expect(x(edge.cause) + kNodeWidth).toBeLessThan(x(edge.effect));
    expect(new Set(nodes.map((node) => `${node.x} ${node.y}`)).size).toBe(nodes.length);
    for (const node of nodes) expect(node.x >= 0 && node.y >= 0 && node.x < width && node.y < height).toBe(true);
  });

  it('is walked by arrow keys', async () => {
    const trace = await followLinks(id('grasp', 3), answering(kChain).ask, () => {}, never);
    const placed = placeTrace(trace);
    expect(neighbourOf(placed, trace, id('grasp', 3), 'ArrowRight')?.key).toBe(id('failure', 4));
    expect(neighbourOf(placed, trace, id('grasp', 3), 'ArrowLeft')?.key).toBe(id('pose', 2));
    expect(neighbourOf(placed, trace, id('failure', 4), 'ArrowRight')).toBeUndefined();
    expect(neighbourOf(placed, trace, id('failure', 4), 'Enter')).toBeUndefined();
  });
});
