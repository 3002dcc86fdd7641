// SPDX-License-Identifier: Apache-2.0
// Where the nodes of a trace lie: a column for each step from cause to consequence, so that every
// arrow points to the right.
import { parseId } from '../../state/ids';
import type { Trace, TraceNode } from './follow';

export const kNodeWidth = 132;
export const kNodeHeight = 34;
const kColumnPitch = 168;
const kRowPitch = 42;
const kMargin = 6;
/** Where long arrows pass, beside a node. */
const kGap = (kRowPitch - kNodeHeight) / 2;

export interface PlacedNode extends TraceNode {
  readonly column: number;
  readonly x: number;
  readonly y: number;
}

export interface PlacedTrace {
  readonly nodes: readonly PlacedNode[];
  readonly width: number;
  readonly height: number;
}

/** The longest way to the root along links, for each node on that side; links in a circle count once. */
function columnsOf(trace: Trace): Map<string, number> {
  const columns = new Map<string, number>([[trace.root, 0]]);
  for (const side of [-1, 1] as const) {
    const own = new Set(trace.nodes.filter((node) => Math.sign(node.depth) === side).map((node) => node.key));
    const onWay = new Set<string>();
    const visit = (key: string): number => {
      const known = columns.get(key);
      if (known !== undefined) return known * side;
      onWay.add(key);
      let longest = 1;
      for (const edge of trace.edges) {
        const [from, next] = side < 0 ? [edge.cause, edge.effect] : [edge.effect, edge.cause];
        if (from === key && own.has(next) && !onWay.has(next)) longest = Math.max(longest, visit(next) + 1);
      }
      onWay.delete(key);
      columns.set(key, longest * side);
      return longest;
    };
    own.forEach(visit);
  }
  return columns;
}

function byTime(a: string, b: string): number {
  const [x, y] = [parseId(a).time ?? 0n, parseId(b).time ?? 0n];
  return x === y ? a.localeCompare(b) : x < y ? -1 : 1;
}

export function placeTrace(trace: Trace): PlacedTrace {
  const columns = columnsOf(trace);
  const first = Math.min(...columns.values());
  const last = Math.max(...columns.values());
  const places = new Map<string, number>();
  const lists = new Map<number, TraceNode[]>();
  // From the root outwards: each column in the order of what it is linked with, so that few arrows cross.
  const order = Array.from({ length: last - first + 1 }, (_, i) => i + first).sort((a, b) => Math.abs(a) - Math.abs(b));
  for (const column of order) {
    const centre = (node: TraceNode): number => {
      const near = trace.edges.flatMap((edge) => (edge.cause === node.key ? [edge.effect] : edge.effect === node.key ? [edge.cause] : [])).flatMap((key) => places.get(key) ?? []);
      return near.length === 0 ? 0 : near.reduce((sum, place) => sum + place, 0) / near.length;
    };
    const list = trace.nodes.filter((node) => columns.get(node.key) === column).map((node) => ({ node, centre: centre(node) })).sort((a, b) => a.centre - b.centre || byTime(a.node.id, b.node.id)).map(({ node }) => node);
    list.forEach((node, i) => places.set(node.key, i - (list.length - 1) / 2));
    lists.set(column, list);
  }
  const rows = Math.max(...[...lists.values()].map((list) => list.length));
  const height = 2 * kMargin + (rows - 1) * kRowPitch + kNodeHeight;
  const nodes = [...lists].sort(([a], [b]) => a - b).flatMap(([column, list]) => list.map((node) => ({
    ...node, column, x: kMargin + (column - first) * kColumnPitch, y: (height - kNodeHeight) / 2 + places.get(node.key)! * kRowPitch,
  })));
  return { nodes, width: 2 * kMargin + (last - first) * kColumnPitch + kNodeWidth, height };
}

/** From the right edge of the cause to the left edge of the consequence; between the nodes of columns on its way. */
export function arrowPath(placed: PlacedTrace, cause: PlacedNode, effect: PlacedNode): string {
  const middle = kNodeHeight / 2;
  const end = { x: effect.x - 7, y: effect.y + middle };
  let path = `M${cause.x + kNodeWidth} ${cause.y + middle}`;
  let here = { x: cause.x + kNodeWidth, y: cause.y + middle };
  const to = (x: number, y: number) => {
    const bow = Math.max(12, Math.abs(x - here.x) / 2);
    path += `C${here.x + bow} ${here.y} ${x - bow} ${y} ${x} ${y}`;
    here = { x, y };
  };
  for (let column = cause.column + 1; column < effect.column; ++column) {
    const inWay = placed.nodes.filter((node) => node.column === column);
    const wanted = here.y + (end.y - here.y) / (effect.column - column + 1);
    const gaps = inWay.flatMap((node) => [node.y - kGap, node.y + kNodeHeight + kGap]);
    const y = gaps.reduce((best, gap) => (Math.abs(gap - wanted) < Math.abs(best - wanted) ? gap : best), gaps[0] ?? wanted);
    to(inWay[0]?.x ?? here.x, y);
    path += `H${here.x + kNodeWidth}`;
    here = { x: here.x + kNodeWidth, y };
  }
  to(end.x, end.y);
  return path;
}

/** The node that an arrow key leads to: above or below in its column, or the nearest of the next column that is linked. */
export function neighbourOf(placed: PlacedTrace, trace: Trace, key: string, arrow: string): PlacedNode | undefined {
  const here = placed.nodes.find((node) => node.key === key);
  if (!here) return undefined;
  const near = (list: readonly PlacedNode[]) => [...list].sort((a, b) => Math.abs(a.column - here.column) - Math.abs(b.column - here.column) || Math.abs(a.y - here.y) - Math.abs(b.y - here.y))[0];
  if (arrow === 'ArrowUp' || arrow === 'ArrowDown') return near(placed.nodes.filter((node) => node.column === here.column && (arrow === 'ArrowUp' ? node.y < here.y : node.y > here.y)));
  const side = arrow === 'ArrowLeft' ? -1 : arrow === 'ArrowRight' ? 1 : 0;
  if (side === 0) return undefined;
  const linked = new Set(trace.edges.flatMap((edge) => (edge.cause === key ? [edge.effect] : edge.effect === key ? [edge.cause] : [])));
  const beyond = placed.nodes.filter((node) => Math.sign(node.column - here.column) === side);
  return near(beyond.filter((node) => linked.has(node.key))) ?? near(beyond);
}
