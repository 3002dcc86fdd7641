// SPDX-License-Identifier: Apache-2.0
// What a snapshot links to and what links to it, followed over several links: causes on one side,
// consequences on the other. Of a cause only its causes are followed, because a pose or an image has
// thousands of consequences that are not those of this snapshot.
import { Turns } from '../../api/turns';
import type { Links } from '../../api/types';
import { parseId } from '../../state/ids';
import { messageOf } from '../../state/request';

export const kMaxDepth = 3;
export const kMaxNodes = 24;
/** Links that are followed of one snapshot and in one direction; the first one may have more. */
const kFan = 4;
const kFirstFan = 8;

export interface TraceNode {
  /** Names the snapshot, whichever of its instances a link means. */
  readonly key: string;
  readonly id: string;
  /** Below 0 for causes, above 0 for consequences: how many links away it was found. */
  readonly depth: number;
  /** Why its links are not known, or an empty text. */
  readonly problem: string;
  readonly isFollowed: boolean;
}

/** A link of the consequence to its cause. */
export interface TraceEdge {
  readonly cause: string;
  readonly effect: string;
  /** Members that hold the link; empty where the consequence was not asked. */
  readonly paths: readonly string[];
}

export interface Trace {
  readonly root: string;
  readonly nodes: readonly TraceNode[];
  readonly edges: readonly TraceEdge[];
  /** Links that were found and are not in the graph. */
  readonly omitted: number;
  /** True if nodes at the rim were not asked for links of their own. */
  readonly isCut: boolean;
}

export function keyOfId(id: string): string {
  const { entity, time } = parseId(id);
  return time === undefined ? entity : `${entity}/${time}`;
}

type Answer = Links | { readonly problem: string };

class Growing {
  private readonly nodes = new Map<string, TraceNode>();
  private readonly edges = new Map<string, { cause: string; effect: string; paths: Set<string> }>();
  private readonly omitted = new Set<string>();

  constructor(private readonly rootId: string) {
    this.nodes.set(keyOfId(rootId), { key: keyOfId(rootId), id: rootId, depth: 0, problem: '', isFollowed: false });
  }

  /** Those that were found `depth` links away and that can be asked: a link to an entity has no time. */
  rim(depth: number): TraceNode[] {
    return [...this.nodes.values()].filter((node) => Math.abs(node.depth) === depth && !node.isFollowed && parseId(node.id).time !== undefined);
  }

  take(node: TraceNode, answer: Answer): void {
    const problem = 'problem' in answer ? answer.problem : '';
    this.nodes.set(node.key, { ...node, problem, isFollowed: true });
    if ('problem' in answer) return;
    const to = answer.to.map((link) => ({ id: link.id, path: link.path }));
    if (node.depth <= 0) this.add(node, to.map((link) => link.id), -1);
    if (node.depth >= 0) this.add(node, answer.from, 1);
    for (const link of to) this.connect(keyOfId(link.id), node.key, link.path);
    if (node.depth >= 0) for (const id of answer.from) this.connect(node.key, keyOfId(id));
  }

  private add(node: TraceNode, ids: readonly string[], direction: -1 | 1): void {
    let added = 0;
    for (const id of new Map(ids.map((one) => [keyOfId(one), one])).values()) {
      const key = keyOfId(id);
      if (this.nodes.has(key)) continue;
      if (added >= (node.depth === 0 ? kFirstFan : kFan) || this.nodes.size >= kMaxNodes) {
        this.omitted.add(`${node.key} ${key}`);
        continue;
      }
      added += 1;
      this.nodes.set(key, { key, id, depth: node.depth + direction, problem: '', isFollowed: false });
    }
  }

  private connect(cause: string, effect: string, path?: string): void {
    if (cause === effect || !this.nodes.has(cause) || !this.nodes.has(effect)) return;
    const key = `${cause} ${effect}`;
    const edge = this.edges.get(key) ?? { cause, effect, paths: new Set<string>() };
    if (path !== undefined) edge.paths.add(path);
    this.edges.set(key, edge);
  }

  made(): Trace {
    const nodes = [...this.nodes.values()];
    return {
      root: keyOfId(this.rootId), nodes, edges: [...this.edges.values()].map((edge) => ({ ...edge, paths: [...edge.paths] })), omitted: this.omitted.size,
      isCut: nodes.some((node) => !node.isFollowed && parseId(node.id).time !== undefined),
    };
  }
}

/**
 * Follows links both ways. `show` gets the graph as it grows.
 *
 * Errors: throws what `ask` throws of the first snapshot; another one that fails is a node with a problem.
 */
export async function followLinks(rootId: string, ask: (id: string, signal: AbortSignal) => Promise<Links>, show: (trace: Trace) => void, signal: AbortSignal): Promise<Trace> {
  const turns = new Turns(2);
  const growing = new Growing(rootId);
  for (let depth = 0; depth < kMaxDepth; ++depth) {
    const rim = growing.rim(depth);
    if (rim.length === 0) break;
    const answers = await Promise.all(rim.map((node) => turns.run(() => ask(node.id, signal), signal).catch((error: unknown): Answer => {
      if (depth === 0 || signal.aborted) throw error;
      return { problem: messageOf(error) };
    })));
    rim.forEach((node, i) => growing.take(node, answers[i]!));
    if (depth + 1 < kMaxDepth) show(growing.made());
  }
  return growing.made();
}
